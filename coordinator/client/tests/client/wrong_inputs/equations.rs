//! Wrong equations and files of equations. Each is one mistake, with words of its refusal.

use super::mistake::Mistake;

pub const MISTAKES: &[Mistake] = &[
    (
        r#"cognate solve -e "2 x = 1""#,
        &["-e:1:3", "`*x`"],
        "cognate solve -e \"2*x = 1\"",
    ),
    (
        r#"cognate solve -e "x = 3√2""#,
        &["-e:1:6", "`3*sqrt(...)`", "`cbrt(...)`"],
        "cognate solve -e",
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
    (
        r#"cognate solve -e "x=cos(60 deg)""#,
        &["-e:1:10", "`*pi/180`"],
        r#"cognate solve -e "x=cos(60*pi/180)""#,
    ),
    (
        r#"cognate solve -e "x=cos(60deg)""#,
        &["-e:1:9", "`*pi/180`"],
        r#"cognate solve -e "x=cos(60*pi/180)""#,
    ),
    (
        r#"cognate solve -e "cos(60°)=x""#,
        &["-e:1:7", "`*pi/180`"],
        r#"cognate solve -e "cos(60*pi/180)=x""#,
    ),
    (
        r#"cognate solve -e "sind(x)=1/2""#,
        &["-e:1:5", "`sin(x*pi/180)`"],
        r#"cognate solve -e "sin(x*pi/180)=1/2""#,
    ),
    (
        r#"cognate solve -e "cosd(x)=1/2""#,
        &["-e:1:5", "`cos(x*pi/180)`"],
        r#"cognate solve -e "cos(x*pi/180)=1/2""#,
    ),
    (
        r#"cognate solve -e "tand(x)=1""#,
        &["-e:1:5", "`tan(x*pi/180)`"],
        r#"cognate solve -e "tan(x*pi/180)=1""#,
    ),
    (
        r#"cognate solve -e "sin^2(x)=1/4""#,
        &["-e:1:6", "`sin(...)^`"],
        r#"cognate solve -e "sin(x)^2=1/4""#,
    ),
    (
        r#"cognate solve -e "f(x)=1""#,
        &["-e:1:2", "no function"],
        r#"cognate solve -e"#,
    ),
    (
        r#"cognate solve -e "f(x)=x^2-1""#,
        &["-e:1:2", "no function"],
        r#"cognate solve -e "x^2-1 = 0""#,
    ),
    (
        r#"cognate solve -e "x=2 // c""#,
        &["-e:1:6"],
        r#"cognate solve -e "x=2 # c""#,
    ),
    (
        r#"cognate solve -e "x=2 % c""#,
        &["-e:1:5", "`%`"],
        r#"cognate solve -e "x=2 # c""#,
    ),
    (
        r#"cognate solve -e "|x|=2""#,
        &["-e:1:1", "`abs(...)`"],
        r#"cognate solve -e "abs(x)=2""#,
    ),
    (
        r#"cognate solve -e "x = 1,5""#,
        &["-e:1:6", "`1.5`"],
        r#"cognate solve -e "x = 1.5""#,
    ),
    (
        r#"cognate solve -e "x^=2""#,
        &["-e:1:3", "an exponent"],
        r#"cognate solve -e"#,
    ),
    (
        r#"cognate solve -e "2^x=8""#,
        &["-e:1:3", "exponent"],
        r#"cognate solve -e "x = log(8)/log(2)""#,
    ),
    (
        r#"cognate solve -e "log(x)=2""#,
        &["-e:1:5", "`log`"],
        r#"cognate solve -e "x = exp(2)""#,
    ),
    (
        r#"cognate solve -e "ln(x)=2""#,
        &["-e:1:4", "`log`"],
        r#"cognate solve -e "x = exp(2)""#,
    ),
    (
        r#"cognate solve -e "x -> 2""#,
        &["-e:1:3", "`->`"],
        r#"cognate solve -e "x = 2""#,
    ),
    (
        r#"cognate solve -e "x! = 6""#,
        &["-e:1:2", "factorial"],
        r#"cognate solve -e"#,
    ),
    (
        r#"cognate solve -e "x := 2""#,
        &["at least one equation"],
        r#"cognate solve -e "x = 2""#,
    ),
    (
        r#"cognate solve -e "x = ±2""#,
        &["-e:1:5", "`±`"],
        r#"cognate solve -e "x^2 = 2^2""#,
    ),
    (
        r#"cognate solve -e "x^{2} = 4""#,
        &["-e:1:3", "`{`"],
        r#"cognate solve -e "x^2 = 4""#,
    ),
    (
        r#"cognate solve -e "x .^ 2 = 2""#,
        &["-e:1:3", "`.`"],
        r#"cognate solve -e "x ^ 2 = 2""#,
    ),
    (
        r#"cognate solve -e "tg(x) = 1""#,
        &["-e:1:3"],
        r#"cognate solve -e "tan(x) = 1""#,
    ),
    (
        r#"cognate solve -e "pow(x, 2) = 4""#,
        &["-e:1:4"],
        r#"cognate solve -e "(x)^(2) = 4""#,
    ),
    (
        r#"cognate solve -e "Eq(x**2, 4)""#,
        &["-e:1:3"],
        r#"cognate solve -e "x**2 = 4""#,
    ),
    (
        r#"cognate solve -e "x = 1 000""#,
        &["-e:1:7", "`000`"],
        r#"cognate solve -e"#,
    ),
    (
        r#"cognate solve -e "x^2 = 4 and x > 0""#,
        &["conditions alone"],
        r#"cognate solve -e "x^2 = 4, x > 0""#,
    ),
    (
        r#"cognate solve -e "x^2 = 4 && x > 0""#,
        &["-e:1:9", "`&`"],
        r#"cognate solve -e "x^2 = 4, x > 0""#,
    ),
    (
        r#"cognate solve -e "sin(x) = 0.5 rad""#,
        &["-e:1:14"],
        r#"cognate solve -e "sin(x) = 0.5""#,
    ),
    (
        r"cognate solve -e '\frac{x}{2} = 1'",
        &["-e:1:1", r"`\`"],
        r#"cognate solve -e "((x)/(2)) = 1""#,
    ),
    (
        r#"cognate solve -e "x + y = 1" --format json"#,
        &["1 equation for 2 unknowns"],
        r#"cognate decompose -e "x + y = 1" --format json"#,
    ),
    (
        r#"cognate solve -e "x + y = 1" --real"#,
        &["1 equation for 2 unknowns"],
        r#"cognate decompose -e "x + y = 1""#,
    ),
    (
        r#"cognate solve -e "sin(a)*y = 0""#,
        &["2 equations for 3 unknowns"],
        r#"cognate solve -e "sin(a)*y = 0" -e "y = 1""#,
    ),
    (
        r#"cognate decompose -e "sqrt(x)*y = 0""#,
        &["functions of unknowns", "`s^2 = x`"],
        r#"cognate solve -e "sqrt(x)*y = 0" -e "y = 1""#,
    ),
    (
        r#"cognate decompose -e "sin(a) = 1/2""#,
        &["functions of unknowns", "`c^2 + s^2 = 1`"],
        r#"cognate solve -e "sin(a) = 1/2""#,
    ),
    (
        r#"printf 'x^2 = 4 // two\n' > bad.txt; cognate solve bad.txt"#,
        &["bad.txt:1:10"],
        "line 1 of bad.txt: x^2 = 4 # two",
    ),
    (
        r#"printf 'x^2 = 4 // two\n' | cognate solve -"#,
        &["standard input:1:10"],
        "line 1 of standard input: x^2 = 4 # two",
    ),
    (
        r#"printf '{x^2 + y^2 - 5, x*y - 2}\n' > list.txt; cognate solve list.txt"#,
        &["list.txt:1:1"],
        "line 1 of list.txt: x^2 + y^2 - 5, x*y - 2",
    ),
    (
        r#"cognate solve -e "x = sin 30°""#,
        &["expected `(` after the function `sin`"],
        r#"cognate solve -e "x = sin(30*pi/180)""#,
    ),
    (
        r#"cognate solve -e "2xy = 6" -e "x + y = 5""#,
        &["`xy` is one name", "2 equations for 3 unknowns"],
        r#"cognate solve -e "2x*y = 6" -e "x + y = 5""#,
    ),
];
