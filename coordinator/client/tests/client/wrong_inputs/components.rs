//! Wrong questions to components. Each is one mistake, with words of its refusal.

use super::mistake::Mistake;

pub const MISTAKES: &[Mistake] = &[
    (
        "cognate member nofolder --points points.csv",
        &["nofolder", "no such folder"],
        "cognate decompose FILE --output nofolder",
    ),
    (
        "cognate member . --points points.csv",
        &["decomposition.json"],
        "cognate decompose FILE --output .",
    ),
    (
        "cognate mobility system.txt --at points.csv",
        &["system.txt", "holds equations"],
        "cognate decompose system.txt --output FOLDER",
    ),
    (
        "cognate sample set",
        &["--count"],
        "cognate sample here --component 1.1 --count",
    ),
    (
        "cognate sample set --count many",
        &["--count", "'many'"],
        "--count",
    ),
    (
        "cognate sample set --count 3 --box 1..0",
        &["--box", "-1..1"],
        "--box '0..1",
    ),
    (
        "cognate sample set --count 3 --box 0..1,0..1,0..1",
        &["--box", "3 ranges", "x, y"],
        "--box '0..1",
    ),
    (
        "cognate sample set --count 3 --component 9.9",
        &["--component", "9.9", "1.1"],
        "--component 1.1",
    ),
    (
        r#"printf 'a,b\n1,2\n' > p.csv; cognate member set --points p.csv"#,
        &["p.csv", "line 1", "x,y"],
        "cognate member here --points",
    ),
    (
        r#"printf 'x,y\n1,two\n' > p.csv; cognate member set --points p.csv"#,
        &["p.csv:2", "field y"],
        "cognate member here --points",
    ),
    (
        "cognate member set --points missing.csv",
        &["missing.csv"],
        "--points",
    ),
    (
        "cognate project set --onto q",
        &["--onto", "`q`", "x, y"],
        "cognate project here --onto x,y",
    ),
    (
        "cognate real-curve set --axes x",
        &["--axes", "1 variable;"],
        "--axes X,Y",
    ),
    (
        "cognate real-curve set --projection q",
        &["--projection", "`q`"],
        "--projection X",
    ),
    (
        "cognate intersect set",
        &["SET|FILE"],
        "cognate intersect here",
    ),
    (
        "cognate intersect set missing.txt",
        &["missing.txt"],
        "cognate intersect",
    ),
    (
        "cognate exceptional system.txt --fibre-dimension 1",
        &["system.txt", "no parameters"],
        "cognate exceptional",
    ),
];
