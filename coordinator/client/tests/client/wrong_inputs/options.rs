//! Wrong commands and options. Each is one mistake, with words of its refusal.

use super::mistake::Mistake;

pub const MISTAKES: &[Mistake] = &[
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
        "cognate solve system.txt --sort x",
    ),
    (
        r#"cognate solve system.txt --minimize "q""#,
        &["--minimize:1:1", "`q`"],
        "cognate solve system.txt --minimize x",
    ),
    (
        r#"cognate solve system.txt --targets "p=1""#,
        &["--targets", "no parameters"],
        "cognate solve system.txt",
    ),
    (
        r#"cognate solve family.txt --targets "q=1""#,
        &["--targets:1:1", "(p)"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"cognate solve family.txt --targets "p=""#,
        &["--targets:1:3", "linspace"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"cognate solve family.txt --targets "p=linspace(0,1)""#,
        &["--targets:1:15", "linspace(0, 1, 100)"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        "cognate solve family.txt --targets missing.csv",
        &["missing.csv"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"printf 'q\n1\n' > t.csv; cognate solve family.txt --targets t.csv"#,
        &["t.csv:1:1", "(p)"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"cognate solve family.txt --show some --targets "p=1""#,
        &["--show", "'some'"],
        "--show N|all",
    ),
    (
        "cognate convert system.txt",
        &["--to"],
        "cognate convert system.txt --to json",
    ),
    (
        "cognate convert system.txt --to matlab",
        &["--to", "'matlab'"],
        "cognate convert",
    ),
    (
        "cognate path system.txt",
        &["--index"],
        "cognate path system.txt --index 17",
    ),
    (
        "cognate path system.txt --index 99",
        &["--index", "0 to 3"],
        "cognate path system.txt --index 17",
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
    (
        r#"cognate solve -e "x^2 = 2" --json"#,
        &["'--json'"],
        r#"cognate solve -e "x^2 = 2" --format json"#,
    ),
    (
        "cognate solve system.txt --csv",
        &["'--csv'"],
        "cognate solve system.txt --format csv",
    ),
    (
        "cognate solve system.txt -f json",
        &["'-f'"],
        "cognate solve system.txt --format json",
    ),
    (
        "cognate solve system.txt -o set2",
        &["'-o'"],
        "cognate solve system.txt --output set2",
    ),
    (
        "cognate solve system.txt -j 4",
        &["'-j'"],
        "cognate solve system.txt --threads 4",
    ),
    (
        "cognate solve system.txt --verbose",
        &["'--verbose'"],
        "cognate solve system.txt",
    ),
    (
        "cognate solve system.txt --tol 1e-10",
        &["'--tol'"],
        "cognate solve",
    ),
    (
        "cognate solve family.txt --parameters p=1",
        &["'--parameters'"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        "cognate solve family.txt --set p=1",
        &["'--set'"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"cognate decompose -e "x*y = 0" --real"#,
        &["'--real'"],
        "cognate decompose",
    ),
    (
        "cognate solve -e x^2 = 4",
        &["unexpected argument"],
        r#"cognate solve -e "x^2 = 4""#,
    ),
    (
        "cognate solve -e x^2=4 y=2 --real",
        &["--equation"],
        r#"cognate solve -e "x^2=4" -e y=2 --real"#,
    ),
    (
        r#"cognate solve "x^2 = 4" y=1"#,
        &["'y=1'"],
        r#"cognate solve -e "x^2 = 4" -e y=1"#,
    ),
    (
        r#"cognate -e "x^2 = 2""#,
        &["'-e'"],
        r#"cognate solve -e "x^2 = 2""#,
    ),
    (
        r#"cognate "x^2 = 2""#,
        &["'x^2 = 2'"],
        r#"cognate solve -e "x^2 = 2""#,
    ),
    (
        "cognate system.txt",
        &["'system.txt'"],
        "cognate solve system.txt",
    ),
    (
        "cognate arm.csv",
        &["'arm.csv'"],
        "cognate mechanism info arm.csv",
    ),
    (
        r#"cognate solve -e "x^2 = 2" --where "x => 0""#,
        &["--where:1:4"],
        r#"cognate solve -e "x^2 = 2" --where "x >= 0""#,
    ),
    (
        r#"cognate solve system.txt --where "x>0 && y<3""#,
        &["--where:1:5", "`&`"],
        r#"cognate solve system.txt --where "x>0 and y<3""#,
    ),
    (
        r#"cognate solve system.txt --where "x in [0,2]""#,
        &["--where:1:3", "`in`"],
        r#"cognate solve system.txt --where "x > 0""#,
    ),
    (
        "cognate solve family.txt --targets p=1..5",
        &["--targets:1:3"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"cognate solve family.txt --targets "p=[1,2]""#,
        &["--targets:1:3"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"cognate solve family.txt --targets "p:1""#,
        &["cannot read p:1"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"cognate solve family.txt --targets "p=1, q=2""#,
        &["--targets:1:5", "(p)"],
        "cognate solve family.txt --targets p=1",
    ),
    (
        r#"printf 'parameters: a, b\nx^2 = a + b\n' > f.txt; cognate solve f.txt --targets "a=1""#,
        &["--targets:1:1", "`b`"],
        r#"cognate solve f.txt --targets "a=1, b=1""#,
    ),
    (
        r#"printf 'parameters: a, b\nx^2 = a + b\n' > f.txt; cognate solve f.txt --targets "a=1,2,b=3""#,
        &["--targets:1:5", "one value of each parameter"],
        r#"cognate solve f.txt --targets "a=1, b=1""#,
    ),
    (
        r#"printf 'parameters: a, b\nx^2 = a + b\n' > f.txt; printf '1,2\n' > t.csv; cognate solve f.txt --targets t.csv"#,
        &["t.csv:1:1", "(a, b)"],
        r#"cognate solve f.txt --targets "a=1, b=1""#,
    ),
];
