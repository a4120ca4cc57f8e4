//! What people really type wrong: every refusal has exit code 2, one message that names the place, and a line to type at its end.

use super::program::text;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// What is typed in a folder with [`FILES`] and the components of a circle, words of the refusal that name the place, and words
/// of the line to type.
type Mistake = (&'static str, &'static [&'static str], &'static str);

/// Files that are right.
const FILES: &[(&str, &str)] = &[
    ("system.txt", "x^2 + y^2 = 5\nx*y = 2\n"),
    ("family.txt", "parameters: p\nx^2 = p\n"),
    ("points.csv", "x,y\n1,2\n2,3\n"),
    ("poses.csv", "x,y,z,qw,qx,qy,qz\n-0.4,-0.15,0.35,0,1,0,0\n"),
    (
        "arm.csv",
        "# angles: deg\nname,theta,d,a,alpha\npan,0,0.1625,0,90\nlift,0,0,-0.425,0\nelbow,0,0,-0.3922,0\n\
         wrist1,0,0.1333,0,90\nwrist2,0,0.0997,0,-90\nwrist3,0,0.0996,0,0\n",
    ),
    (
        "arm.urdf",
        "<robot name=\"a\"><link name=\"base\"/><link name=\"tip\"/><joint name=\"swing\" type=\"continuous\">\
         <parent link=\"base\"/><child link=\"tip\"/><axis xyz=\"0 0 1\"/></joint></robot>\n",
    ),
    (
        "four_bar.json",
        "{\"name\": \"four-bar\", \"space\": \"planar\", \"links\": [\"ground\", \"crank\", \"coupler\", \"rocker\"],\n\
         \"joints\": [{\"name\": \"A0\", \"type\": \"R\", \"links\": [\"ground\", \"crank\"], \"point\": [0, 0]},\n\
         {\"name\": \"A\", \"type\": \"R\", \"links\": [\"crank\", \"coupler\"], \"point\": [0, 1]},\n\
         {\"name\": \"B\", \"type\": \"R\", \"links\": [\"coupler\", \"rocker\"], \"point\": [3, 2]},\n\
         {\"name\": \"B0\", \"type\": \"R\", \"links\": [\"rocker\", \"ground\"], \"point\": [4, 0]}],\n\
         \"inputs\": [\"A0\"], \"output\": {\"link\": \"coupler\", \"point\": [1.5, 3]}}\n",
    ),
];

const EQUATIONS: &[Mistake] = &[
    (
        r#"cognate solve -e "2 x = 1""#,
        &["-e:1:3", "`*x`"],
        "cognate solve -e \"2*x = 1\"",
    ),
    (
        r#"cognate solve -e "x = √2""#,
        &["-e:1:5", "`sqrt(...)`"],
        "cognate solve -e \"x = sqrt(2)\"",
    ),
    (
        r#"cognate solve -e "x^2 = -1*i""#,
        &["-e:1:10", "`I`"],
        "cognate solve -e \"x^2 = -1*I\"",
    ),
    (
        r#"cognate solve -e "x + = 3""#,
        &["-e:1:5"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "(x + 1 = 2""#,
        &["-e:1:8", "`)`"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "x ^^ 2 = 1""#,
        &["-e:1:4"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "x^2 + y^2 = 1 and x = y""#,
        &["-e:1:15", "`and`"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e """#,
        &["-e:1:1", "at least one equation"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "3 = 3""#,
        &["-e:1:6", "at least one variable"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "x + y = 1""#,
        &["1 equation for 2 unknowns"],
        r#"cognate decompose -e "x + y = 1""#,
    ),
    (
        r#"cognate solve -e "log(x) = 1""#,
        &["-e:1:5", "`log`"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "sin(x) = x""#,
        &["-e:1:1", "angle `x`"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "x^y = 2" -e "y = 1""#,
        &["-e:1:3", "exponent"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "x/0 = 1""#,
        &["-e:1:3", "denominator"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve -e "sqrt(x = 2""#,
        &["-e:1:8", "`)`"],
        "cognate solve -e",
    ),
    (
        r#"cognate solve "x^2 = 4""#,
        &["x^2 = 4"],
        r#"cognate solve -e "x^2 = 4""#,
    ),
    (
        "cognate solve sytem.txt",
        &["sytem.txt"],
        "cognate solve system.txt",
    ),
    (
        "cognate solve missing_file",
        &["missing_file"],
        "cognate solve",
    ),
    ("cognate solve .", &["cannot read ."], "cognate solve"),
    (
        ": > empty.txt; cognate solve empty.txt",
        &["empty.txt:1:1", "an empty file"],
        "cognate solve -e",
    ),
    (
        r#"printf 'a\0b' > binary.txt; cognate solve binary.txt"#,
        &["binary.txt:1:2", "0x00"],
        "cognate solve -e",
    ),
    (
        r#"printf 'x + y = 1\nx - = 3\n' > bad.txt; cognate solve bad.txt"#,
        &["bad.txt:2:5"],
        "cognate solve -e",
    ),
    (
        r#"printf 'unkowns: x\nx^2 = 1\n' > bad.txt; cognate solve bad.txt"#,
        &["bad.txt:1:1", "perhaps `unknowns`"],
        "cognate solve -e",
    ),
    (
        r#"printf 'x^2 = 1\n  + y\n' > bad.txt; cognate solve bad.txt"#,
        &["bad.txt:2:3"],
        "cognate solve -e",
    ),
    (
        r#"printf 'variable_group theta; function f;\nf = theta^2 + thta;\nEND;\n' > bad.bertini; cognate solve bad.bertini"#,
        &["bad.bertini:2:15", "perhaps `theta`"],
        "cognate solve -e",
    ),
    (
        r#"printf 'variable_group x; function f;\nf = (x^2 - 2;\nEND;\n' > bad.bertini; cognate solve bad.bertini"#,
        &["bad.bertini:2:13", "`)`"],
        "line 2 of bad.bertini: f = (x^2 - 2);",
    ),
    (
        r#"printf 'variable_group x; function f, g;\nf = x^2 - 2;\nEND;\n' > bad.bertini; cognate solve bad.bertini"#,
        &["bad.bertini:1:31", "`g = ...`"],
        "cognate solve -e",
    ),
    (
        r#"printf 'varible_group x; function f;\nf = x^2 - 2;\nEND;\n' > bad.bertini; cognate solve bad.bertini"#,
        &["bad.bertini:1:1", "perhaps `variable_group`"],
        "cognate solve -e",
    ),
    (
        r#"printf 'CONFIG\nFinalTolerance: 1e-5;\nEND;\nINPUT\nvariable_group x; function f; f = x^2 - 2; END;\n' > bad.bertini; cognate solve bad.bertini"#,
        &["bad.bertini:2:1", "perhaps `finaltol`"],
        "cognate solve -e",
    ),
    (
        r#"printf 'CONFIG\nTrackType: 1;\nEND;\nINPUT\nvariable_group x; function f; f = x^2 - 2; END;\n' > bad.bertini; cognate solve bad.bertini"#,
        &["bad.bertini:2:12", "`cognate decompose`"],
        "cognate solve",
    ),
    (
        r#"printf '{"varables": ["x"],\n "equations": ["x^2 - 1"]}\n' > bad.json; cognate solve bad.json"#,
        &["bad.json:1:3", "perhaps variables"],
        "cognate solve -e",
    ),
    (
        r#"printf '{"variables": ["x"],\n "equations": ["x^2 - 1",]}\n' > bad.json; cognate solve bad.json"#,
        &["bad.json:2:26"],
        "cognate solve -e",
    ),
    (
        r#"printf '{"variables": ["x"],\n "equations": ["x^2 - y"]}\n' > bad.json; cognate solve bad.json"#,
        &["bad.json:2:23", "equations[0], column 7"],
        "cognate solve -e",
    ),
    (
        r#"printf '{"variables": ["x"],\n "equations": "x^2 - 1"}\n' > bad.json; cognate solve bad.json"#,
        &["bad.json:2:15", "equations"],
        "cognate solve -e",
    ),
    (
        r#"printf '2\n x^2 - 1;\n' > bad.phc; cognate solve bad.phc"#,
        &["bad.phc:3:1", "polynomial 2 of 2"],
        "cognate solve -e",
    ),
    (
        r#"printf 'using HomotopyContinuation\n@var x\nf = System([x^2 - 1])\n' > model.jl; cognate solve model.jl"#,
        &["model.jl", "HomotopyContinuation.jl"],
        r#"from_homotopy_continuation(open("model.jl")"#,
    ),
    (
        r#"printf 'import sympy\nx = sympy.symbols("x")\n' > model.py; cognate solve model.py"#,
        &["model.py:1:1"],
        "cognate solve -e",
    ),
    (
        r#"printf '{"variables":{"x":[1.0,0.0]},"multiplicity":1}\n' > solutions.jsonl; cognate solve solutions.jsonl"#,
        &["solutions.jsonl", "holds solutions"],
        "--start-solutions solutions.jsonl",
    ),
    (
        "cognate solve points.csv",
        &["points.csv", "points of a path"],
        "cognate synthesize nine-point points.csv",
    ),
    (
        "cognate solve poses.csv",
        &["poses.csv", "poses of a tool"],
        "cognate mechanism inverse arm.json --poses poses.csv",
    ),
    (
        "cognate solve arm.csv",
        &["arm.csv", "a mechanism"],
        "cognate mechanism inverse arm.csv --pose",
    ),
    (
        "cognate solve four_bar.json",
        &["four_bar.json", "a mechanism"],
        "cognate mechanism motion four_bar.json",
    ),
    (
        "cognate decompose arm.urdf",
        &["arm.urdf", "a mechanism"],
        "cognate mechanism inverse arm.urdf --pose",
    ),
    (
        "cognate info four_bar.json",
        &["four_bar.json", "a mechanism"],
        "cognate mechanism motion four_bar.json",
    ),
    (
        "cognate solve family.txt",
        &["family.txt", "parameters (p)", "--targets"],
        r#"cognate solve family.txt --targets "p=1""#,
    ),
];

const OPTIONS: &[Mistake] = &[
    (
        "cognate slove system.txt",
        &["'slove'"],
        "cognate solve system.txt",
    ),
    (
        "cognate inverse arm.csv --poses poses.csv",
        &["'inverse'"],
        "cognate mechanism inverse arm.csv --poses poses.csv",
    ),
    ("cognate solve", &["FILE"], "cognate solve"),
    (
        r#"cognate solve system.txt -e "x = 1""#,
        &["--equation"],
        "cognate solve",
    ),
    (
        "cognate solve system.txt --formt json",
        &["'--formt'"],
        "cognate solve system.txt --format json",
    ),
    (
        "cognate solve system.txt --format jsn",
        &["--format", "'jsn'"],
        "cognate solve system.txt --format json",
    ),
    (
        "cognate solve system.txt --start total",
        &["--start", "'total'", "total-degree"],
        "cognate solve",
    ),
    (
        "cognate solve system.txt --precision quad",
        &["--precision", "'quad'"],
        "cognate solve FILE --precision adaptive|double|BITS",
    ),
    (
        "cognate solve system.txt --digits 0",
        &["--digits", "1..=1000"],
        "cognate solve FILE --digits N",
    ),
    (
        "cognate solve system.txt --digits fifty",
        &["--digits", "'fifty'"],
        "cognate solve FILE --digits N",
    ),
    (
        "cognate solve system.txt --workers 0",
        &["--workers", "1..=256"],
        "--workers 4",
    ),
    (
        "cognate solve system.txt --preset carefull",
        &["--preset", "'carefull'"],
        "cognate solve system.txt --preset careful",
    ),
    (
        "cognate solve system.txt --confidence 2",
        &["--confidence", "0.999"],
        "--confidence PROBABILITY",
    ),
    (
        "cognate solve system.txt --seed -1",
        &["'-1'"],
        "cognate solve",
    ),
    (
        r#"cognate solve system.txt --groups "x;w""#,
        &["--groups:1:3", "`w`"],
        "--groups",
    ),
    (
        r#"cognate solve system.txt --conjugates "x,y""#,
        &["--conjugates:1:2", "`~`"],
        r#"--conjugates "p~P"#,
    ),
    (
        r#"cognate solve system.txt --conjugates "x~q""#,
        &["--conjugates:1:3", "`q`"],
        r#"--conjugates "p~P"#,
    ),
    (
        "cognate solve system.txt --symmetry none.json",
        &["none.json"],
        "--symmetry FILE",
    ),
    (
        r#"printf '[{"permutation": {"x": "z"}}]' > s.json; cognate solve system.txt --symmetry s.json"#,
        &["s.json:1:24", "[0].permutation"],
        "--symmetry FILE",
    ),
    (
        r#"printf '{"a": 3}' > d.json; cognate solve system.txt --degenerate d.json"#,
        &["d.json:1:7", "nonzero"],
        "--degenerate FILE",
    ),
    (
        r#"printf '[[["x"]]]' > sets.json; cognate solve system.txt --start linear-product --sets sets.json"#,
        &["sets.json:1:1", "each of the 2 equations"],
        "--sets FILE",
    ),
    (
        "cognate solve system.txt --start given",
        &["--start given", "--start-solutions FILE"],
        "--start-solutions solutions.jsonl",
    ),
    (
        "cognate solve system.txt --idle-loops 3",
        &["--idle-loops", "--start monodromy"],
        "cognate solve system.txt --idle-loops 3 --start monodromy",
    ),
    (
        r#"cognate solve system.txt --where "z > 0""#,
        &["--where:1:1", "`z`"],
        r#"--where "x > 0"#,
    ),
    (
        r#"cognate solve system.txt --where "x >""#,
        &["--where:1:4"],
        r#"--where "x > 0"#,
    ),
    (
        r#"cognate solve system.txt --sort "w""#,
        &["--sort:1:1", "`w`"],
        "--sort EXPRESSION",
    ),
    (
        r#"cognate solve system.txt --minimize "q""#,
        &["--minimize:1:1", "`q`"],
        r#"--minimize ""#,
    ),
    (
        r#"cognate solve system.txt --targets "p=1""#,
        &["--targets", "no parameters"],
        r#"--targets "omega="#,
    ),
    (
        r#"cognate solve family.txt --targets "q=1""#,
        &["--targets:1:1", "(p)"],
        r#"--targets "omega="#,
    ),
    (
        r#"cognate solve family.txt --targets "p=""#,
        &["--targets:1:3", "linspace"],
        r#"--targets "omega="#,
    ),
    (
        r#"cognate solve family.txt --targets "p=linspace(0,1)""#,
        &["--targets:1:15", "linspace(0, 1, 100)"],
        r#"--targets "omega="#,
    ),
    (
        "cognate solve family.txt --targets missing.csv",
        &["missing.csv"],
        r#"--targets "omega="#,
    ),
    (
        r#"printf 'q\n1\n' > t.csv; cognate solve family.txt --targets t.csv"#,
        &["t.csv:1:1", "(p)"],
        r#"--targets "omega="#,
    ),
    (
        r#"cognate solve family.txt --show some --targets "p=1""#,
        &["--show", "'some'"],
        "--show N|all",
    ),
    (
        "cognate convert system.txt",
        &["--to"],
        "cognate convert system.bertini --to json",
    ),
    (
        "cognate convert system.txt --to matlab",
        &["--to", "'matlab'"],
        "cognate convert",
    ),
    (
        "cognate path system.txt",
        &["--index"],
        "cognate path system.bertini --index 17",
    ),
    (
        "cognate path system.txt --index 99",
        &["--index", "0 to 3"],
        "cognate path system.bertini --index 17",
    ),
    (
        "cognate decompose system.txt --dimension 2..1",
        &["--dimension", "0..2"],
        "--dimension 1..2",
    ),
    (
        "cognate decompose --resume set",
        &["--add"],
        "cognate decompose --resume here --add more.bertini",
    ),
    (
        "cognate completions bahs",
        &["'bahs'"],
        "cognate completions bash",
    ),
];

const COMPONENTS: &[Mistake] = &[
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
        "cognate decompose system.txt --output set",
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
        "cognate intersect here plane.bertini",
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

const MECHANISMS: &[Mistake] = &[
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
        "cognate mechanism inverse am.csv --poses poses.csv",
        &["am.csv"],
        "cognate mechanism inverse arm.csv --poses poses.csv",
    ),
    (
        "cognate mechanism inverse arm.csv",
        &["--poses"],
        "cognate mechanism inverse arm.urdf --poses poses.json",
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
        "--inputs inputs.json",
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
        "cognate mechanism mobility linkage.json --at home",
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
        "--to dh.csv",
    ),
    (
        r#"printf 'name,theta,d,a,alpha\nq,0,0,zero,0\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:2", r#""zero""#],
        "--to dh.csv",
    ),
    (
        r#"printf 'name,theta,d,a,alpha\nq,0,0,1,1.5707963\n' > a.csv; cognate mechanism info a.csv"#,
        &["a.csv:2", "alpha", "# angles: rad"],
        "--to dh.csv",
    ),
    (
        r#"printf '<robot name="a"><link name="b"/></robot>' > a.urdf; cognate mechanism info a.urdf"#,
        &["a.urdf:1", "no joint"],
        "cognate mechanism schema",
    ),
    (
        r#"printf '<robot name="a"><link name="b">' > a.urdf; cognate mechanism info a.urdf"#,
        &["a.urdf:1", "never closed"],
        "cognate mechanism schema",
    ),
    (
        "cognate mechanism info arm.urdf --tip hand",
        &["--tip hand", "base, tip"],
        "cognate mechanism info FILE --tip LINK",
    ),
    (
        "cognate mechanism follow arm.csv",
        &["--poses"],
        "cognate mechanism follow arm.urdf --poses path.csv",
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
];

const SERVICE: &[Mistake] = &[
    (
        "cognate submit system.txt --coordinator nowhere",
        &["--coordinator", "`nowhere`", "http://host:port"],
        "--coordinator URL",
    ),
    (
        "cognate worker --coordinator h:1 --lane-width 3",
        &["--lane-width", "1, 8 or 16"],
        "--lane-width W",
    ),
    (
        "cognate worker",
        &["--coordinator"],
        "cognate worker --coordinator http://head:7654",
    ),
    (
        "cognate coordinator --ledger redis:x",
        &["--ledger", "`redis:x`", "sqlite:PATH"],
        "cognate coordinator",
    ),
    (
        "cognate coordinator --listen 0.0.0.0:0",
        &["--listen", "--token-file", "--insecure"],
        "cognate coordinator",
    ),
    (
        "cognate jobs --token-file missing",
        &["missing"],
        "cognate jobs --token-file FILE",
    ),
    (
        "cognate submit system.txt --loops 3",
        &["--loops", "--decompose"],
        "cognate submit",
    ),
    (
        "cognate submit system.txt --minimize x",
        &["'--minimize'"],
        "cognate submit",
    ),
    ("cognate watch", &["<JOB>"], "cognate watch JOB"),
    (
        "cognate fsck --ledger sqlite:none.db",
        &["--ledger", "none.db"],
        "--ledger sqlite:jobs.db",
    ),
    (
        "cognate backup set",
        &["--ledger", "cognate-data/ledger.db"],
        "--ledger sqlite:jobs.db",
    ),
];

/// Runs a line in a folder, as a shell does.
fn shell(line: &str, folder: &Path) -> Output {
    let program = PathBuf::from(env!("CARGO_BIN_EXE_cognate"));
    let programs = program.parent().expect("a folder").display().to_string();
    let path = std::env::var("PATH").unwrap_or_default();
    let mut command = Command::new("sh");
    command.arg("-c").arg(line).current_dir(folder);
    command.env("PATH", format!("{programs}:{path}"));
    command.output().expect("there is a shell")
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a new folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("an entry");
        let there = to.join(entry.file_name());
        match entry.path().is_dir() {
            true => copy(&entry.path(), &there),
            false => drop(std::fs::copy(entry.path(), there).expect("it is readable")),
        }
    }
}

/// What is wrong with the refusal of a mistake.
fn faults((typed, place, line): &Mistake, folder: &Path) -> Option<String> {
    let output = shell(typed, folder);
    let said = text(&output.stderr);
    let last = said.trim_end().lines().last().unwrap_or_default();
    let to_type = last.split_once("try: ").map(|(_, line)| line);
    let named = place.iter().all(|word| said.contains(word));
    let lines = said.lines().count();
    let is_right = output.status.code() == Some(2)
        && output.stdout.is_empty()
        && named
        && lines <= 14
        && !said.contains("panicked")
        && (to_type.is_some() || last.contains("`cognate "))
        && last.contains(line)
        && to_type.is_none_or(|line| is_understood(line, folder));
    (!is_right).then(|| format!("$ {typed}\n{} {place:?} {line:?}\n{said}\n", output.status))
}

/// Whether the program understands a line that it gave: with `--help` no such line is refused.
fn is_understood(line: &str, folder: &Path) -> bool {
    let is_ours = line.starts_with("cognate ") && !line.contains(['|', '&', '>', '<']);
    // Words in capitals stand for values.
    let is_value = |word: &str| {
        word.chars()
            .all(|c| c.is_ascii_uppercase() || "|,=".contains(c))
    };
    let is_form = line.ends_with("--help") || line.split(' ').any(is_value);
    !is_ours || is_form || shell(&format!("{line} --help"), folder).status.success()
}

fn check(mistakes: &[Mistake]) {
    let right = tempfile::tempdir().expect("a temporary folder");
    for (name, content) in FILES {
        std::fs::write(right.path().join(name), content).expect("it is writable");
    }
    let circle = "cognate decompose -e 'x^2 + y^2 = 1' --output set";
    assert!(shell(circle, right.path()).status.success());
    let fault = |mistake: &Mistake| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        copy(right.path(), folder.path());
        faults(mistake, folder.path())
    };
    let faults: Vec<String> = mistakes.iter().filter_map(fault).collect();
    assert!(
        faults.is_empty(),
        "{} of {}:\n{}",
        faults.len(),
        mistakes.len(),
        faults.join("\n")
    );
}

#[test]
fn equations_and_files_that_are_wrong() {
    check(EQUATIONS);
}

#[test]
fn commands_and_options_that_are_wrong() {
    check(OPTIONS);
}

#[test]
fn questions_to_components_that_are_wrong() {
    check(COMPONENTS);
}

#[test]
fn mechanisms_that_are_wrong() {
    check(MECHANISMS);
}

#[test]
fn words_to_the_service_that_are_wrong() {
    check(SERVICE);
}

#[test]
fn the_program_alone_shows_five_things_to_type() {
    let output = Command::new(env!("CARGO_BIN_EXE_cognate")).output();
    let output = output.expect("the program starts");
    let said = text(&output.stderr);
    let lines = said.lines().filter(|line| line.starts_with("  cognate "));
    assert_eq!(
        (output.status.code(), lines.count()),
        (Some(2), 5),
        "{said}"
    );
}
