//! Wrong mechanisms and wrong questions about them. Each is one mistake, with words of its refusal.

use super::mistake::Mistake;

pub const MISTAKES: &[Mistake] = &[
    (
        "cognate mechanism invrse arm.csv --poses poses.csv",
        &["'invrse'"],
        "cognate mechanism inverse arm.csv --poses poses.csv",
    ),
    (
        "cognate mechanism inverse system.txt --poses poses.csv",
        &["system.txt", "a system of equations"],
        "cognate solve system.txt",
    ),
    (
        r#"printf '{"loop": {"joints": [{"name": "q1", "d": "?"}, {"name": "q2", "a": "?"}]}}' > o.json; cognate mechanism motion o.json"#,
        &["o.json: values are open", "q1.d, q2.a"],
        "cognate mechanism exceptional o.json",
    ),
    (
        "cognate mechanism inverse am.csv --poses poses.csv",
        &["am.csv"],
        "cognate mechanism inverse arm.csv --poses poses.csv",
    ),
    (
        "cognate mechanism inverse arm.csv",
        &["--poses"],
        "cognate mechanism inverse arm.csv --poses",
    ),
    (
        r#"cognate mechanism inverse arm.csv --pose "1 2 3 4 5""#,
        &["--pose", "found 5"],
        r#"--pose ""#,
    ),
    (
        r#"cognate mechanism inverse arm.csv --pose "1 2 c 1 0 0 0""#,
        &["--pose:1", "z"],
        r#"--pose ""#,
    ),
    (
        r#"cognate mechanism inverse arm.csv --pose "1 2 3 0 0 0 0""#,
        &["--pose:1", "qw"],
        r#"--pose ""#,
    ),
    (
        r#"printf 'x,y,z,a,b,c\n1,2,3,0,0,0\n' > p.csv; cognate mechanism inverse arm.csv --poses p.csv"#,
        &["p.csv:1", r#""a""#],
        "--poses",
    ),
    (
        r#"printf 'x,y,z,qw,qx,qy,qz\n1,2,3\n' > p.csv; cognate mechanism inverse arm.csv --poses p.csv"#,
        &["p.csv:2", "expected 7 values"],
        "--poses",
    ),
    (
        r#"printf 'x,y,z,a,b,c\n1,2,3,0,0,0\n' > p.csv; cognate mechanism inverse arm.csv --poses=p.csv"#,
        &["p.csv:1", r#""a""#],
        "--poses",
    ),
    (
        r#"printf '[{"postion": [1, 2, 3]}]' > p.json; cognate mechanism inverse arm.csv --poses p.json"#,
        &["p.json:1", "perhaps position"],
        "--poses",
    ),
    (
        "cognate mechanism inverse arm.csv --poses poses.csv --lock elbow",
        &["--lock", "JOINT=VALUE"],
        "--lock joint_3=0.3",
    ),
    (
        "cognate mechanism inverse arm.csv --poses poses.csv --lock elbw=3",
        &["--lock", "elbow"],
        "--lock joint_3=0.3",
    ),
    (
        r#"cognate mechanism inverse arm.csv --poses poses.csv --near "1 2 3""#,
        &["--near", "found 3"],
        "--near VALUES",
    ),
    (
        "cognate mechanism inverse arm.csv --poses poses.csv --task poze",
        &["--task", "position"],
        "--task position",
    ),
    (
        "cognate mechanism inverse arm.csv --poses poses.csv --angles degrees",
        &["--angles", "'degrees'"],
        "--angles deg",
    ),
    (
        r#"cognate mechanism inverse four_bar.json --pose "1 2 30""#,
        &["four_bar.json"],
        "cognate mechanism",
    ),
    (
        "cognate mechanism forward arm.csv",
        &["--inputs", "pan, lift"],
        "cognate mechanism forward arm.csv --set pan=0 --set lift=0",
    ),
    (
        "cognate mechanism forward arm.csv --set pan=a",
        &["--set", "pan"],
        "cognate mechanism forward arm.csv --set pan=0",
    ),
    (
        "cognate mechanism forward arm.csv --set pna=1",
        &["--set", "pna", "pan"],
        "cognate mechanism forward arm.csv --set pan=0",
    ),
    (
        "cognate mechanism forward arm.csv --set pan=1",
        &["--set", "lift has no value"],
        "cognate mechanism forward arm.csv --set pan=0",
    ),
    (
        r#"printf 'pan,lift\n1,2\n' > i.csv; cognate mechanism forward arm.csv --inputs i.csv"#,
        &["i.csv:1", r#""elbow""#],
        "cognate mechanism forward arm.csv --inputs",
    ),
    (
        "cognate mechanism motion arm.csv",
        &["arm.csv", "open chain"],
        "cognate mechanism",
    ),
    (
        "cognate mechanism workspace arm.csv --points points.csv",
        &["points.csv:1", r#""z""#],
        "--points points.json",
    ),
    (
        "printf '[[1, 2, 3]]' > w.json; cognate mechanism workspace arm.csv --points w.json",
        &["arm.csv", "6 joints"],
        "cognate mechanism inverse arm.csv --poses poses.csv",
    ),
    (
        "cognate mechanism singularities four_bar.json",
        &["--inputs|--outputs"],
        "cognate mechanism singularities four_bar.json --inputs",
    ),
    (
        "cognate mechanism mobility four_bar.json",
        &["--at"],
        "cognate mechanism mobility four_bar.json --at home",
    ),
    (
        r#"printf '{"joints": {"A0": 0}}' > at.json; cognate mechanism mobility four_bar.json --at at.json"#,
        &["at.json:1", "joints", r#""A""#],
        "--at home",
    ),
    (
        r#"printf '{"serail": []}' > a.json; cognate mechanism info a.json"#,
        &["a.json:1", "no body"],
        "cognate mechanism schema",
    ),
    (
        r#"printf '{"serial": [{"d": "long"}]}' > a.json; cognate mechanism info a.json"#,
        &["a.json:1", "serial"],
        "cognate mechanism schema",
    ),
    (
        r#"printf '{"space": "flat", "joints": []}' > a.json; cognate mechanism info a.json"#,
        &["a.json:1", "space", "planar"],
        "cognate mechanism schema",
    ),
    (
        r#"printf '# angles: deg\nname,thta,d,a,alpha\nq,0,0,0,0\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:1", r#""thta""#],
        "name,theta,d,a,alpha",
    ),
    (
        r#"printf 'name,theta,d,a,alpha\nq,0,0,zero,0\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:2", r#""zero""#],
        "name,theta,d,a,alpha",
    ),
    (
        r#"printf 'name,theta,d,a,alpha\nq,0,0,1,1.5707963\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:2", "alpha", "# angles: rad"],
        "name,theta,d,a,alpha",
    ),
    (
        r#"printf 'theta,d,a,alpha\nq1,d1,0,90\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:2", "d1 has no value", "column type with P"],
        "name,theta,d,a,alpha",
    ),
    (
        r#"printf 'theta,d,a,alpha\nq2,0,1,0\nq1,0,1,0\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:3", "q1 stands below q2"],
        "name,theta,d,a,alpha",
    ),
    (
        r#"printf '# modified in May\ntheta,d,a,alpha\nq1,0,1,0\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:1", "# convention: modified"],
        "name,theta,d,a,alpha",
    ),
    (
        "cognate mechanism inverse arm.csv --poses poses.csv --sweep pan --lock pan=2",
        &["--sweep", "pan is held by --lock"],
        "cognate mechanism inverse",
    ),
    (
        r#"printf '<robot name="a"><link name="b"/></robot>' > a.urdf; cognate mechanism info a.urdf"#,
        &["a.urdf:1", "no joint"],
        "</joint></robot>' | cognate mechanism info -",
    ),
    (
        r#"printf '<robot name="a"><link name="b">' > a.urdf; cognate mechanism info a.urdf"#,
        &["a.urdf:1", "never closed"],
        "</joint></robot>' | cognate mechanism info -",
    ),
    (
        "cognate mechanism info arm.urdf --tip hand",
        &["--tip hand", "base, tip"],
        "cognate mechanism info FILE --tip LINK",
    ),
    (
        "cognate mechanism follow arm.csv",
        &["--poses"],
        "cognate mechanism follow arm.csv --poses path.csv",
    ),
    (
        "cognate mechanism equations arm.csv",
        &["--problem"],
        "--problem forward",
    ),
    (
        r#"printf 'x,y\n1,2\n' > p.csv; cognate synthesize nine-point p.csv"#,
        &["p.csv", "nine points"],
        "cognate synthesize nine-point",
    ),
    (
        r#"printf 'x,y\n1,two\n' > p.csv; cognate synthesize nine-point p.csv"#,
        &["p.csv:2", "`two`"],
        "cognate synthesize nine-point",
    ),
    (
        r#"printf 'a,b\n1,2\n' > p.csv; cognate synthesize nine-point p.csv"#,
        &["p.csv:1", "header x,y"],
        "cognate synthesize nine-point",
    ),
    (
        r#"printf 'x,y,angle\n1,2,3\n' > p.csv; cognate synthesize body-guidance p.csv"#,
        &["p.csv", "five poses"],
        "cognate synthesize body-guidance",
    ),
    (
        "cognate synthesize five-bar points.csv",
        &["'five-bar'"],
        "cognate synthesize --help",
    ),
    (
        r#"printf 'name theta d a alpha\nq 0 0 1 0\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:1", "headings between commas"],
        "name,theta,d,a,alpha",
    ),
    (
        r#"printf 'name,theta,d,a,alpha\nq,0,0,1\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:2", "5 values"],
        "name,theta,d,a,alpha",
    ),
    (
        r#"cognate mechanism inverse arm.csv --target "0.4 0.1 0.5 1 0 0 0""#,
        &["'--target'"],
        r#"cognate mechanism inverse arm.csv --pose "0.4 0.1 0.5 1 0 0 0""#,
    ),
    (
        "cognate ik arm.csv --poses poses.csv",
        &["'ik'"],
        "cognate mechanism inverse arm.csv --poses poses.csv",
    ),
    (
        r#"cognate mechanism fk arm.csv --inputs "1 2 3 4 5 6""#,
        &["'fk'"],
        r#"cognate mechanism forward arm.csv --inputs "1 2 3 4 5 6""#,
    ),
    (
        "cognate mechanism arm.csv",
        &["'arm.csv'"],
        "cognate mechanism info arm.csv",
    ),
    (
        r#"cognate mechanism inverse arm.csv --poses "0.4 0.1 0.3 1 0 0 0""#,
        &["0.4 0.1 0.3 1 0 0 0"],
        r#"cognate mechanism inverse arm.csv --pose "0.4 0.1 0.3 1 0 0 0""#,
    ),
];
