//! Solutions that are wanted: `--real`, `--positive`, `--where` and conditions of a file, the order, rows of CSV and
//! lines of JSON.

use super::program::{cognate, text};
use serde_json::Value;

/// x^2 + y^2 = 25 and x y = 12 have the solutions (3, 4), (4, 3) and their negatives.
const TWO: [&str; 4] = ["-e", "x^2 + y^2 = 25", "-e", "x*y = 12"];

/// Output of a solve of these equations.
fn printed(equations: &[&str], options: &[&str]) -> String {
    let output = cognate(&[&["solve"], equations, options].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

#[test]
fn rows_hold_what_is_selected_in_the_order_that_is_asked() {
    let csv = printed(&TWO, &["--sort", "-y", "--format", "csv"]);
    let expected = "x,y,multiplicity,real,singular\n3.0,4.0,1,true,false\n4.0,3.0,1,true,false\n\
                    -4.0,-3.0,1,true,false\n-3.0,-4.0,1,true,false\n";
    assert_eq!(csv, expected);
    let csv = printed(&TWO, &["--positive", "--where", "x > y", "--format", "csv"]);
    let expected = "x,y,multiplicity,real,singular,on_border\n4.0,3.0,1,true,false,false\n";
    assert_eq!(csv, expected);
    let csv = printed(&["-e", "x^2 = -1"], &["--sort", "-I*x", "--format", "csv"]);
    let expected =
        "x_re,x_im,multiplicity,real,singular\n0.0,-1.0,1,false,false\n0.0,1.0,1,false,false\n";
    assert_eq!(csv, expected);
    // Nothing is selected: the names of the columns alone.
    let csv = printed(&["-e", "x^2 = -1"], &["--real", "--format", "csv"]);
    assert_eq!(csv, "x,multiplicity,real,singular,on_border\n");
}

#[test]
fn conditions_have_functions_of_unknowns() {
    for (equations, condition, rows) in [
        (
            &TWO[..],
            "abs(x) < abs(y) and sqrt(x) > 1",
            "3.0,4.0,1,true,false,false\n",
        ),
        (
            &["-e", "x^3 = 8"],
            "log(x) > 0 and sin(x) > 0",
            "2.0,1,true,false,false\n",
        ),
        (
            &["-e", "x^2 = x"],
            "x = abs(x) and sqrt(x) <= 0",
            "0.0,1,true,false,false\n",
        ),
    ] {
        let csv = printed(equations, &["--where", condition, "--format", "csv"]);
        assert_eq!(
            csv.split_once('\n').map(|(_, rows)| rows),
            Some(rows),
            "{condition}"
        );
    }
    let angle = ["-e", "sin(a) = 1/2"];
    let csv = printed(&angle, &["--where", "cos(a) < 0", "--format", "csv"]);
    assert!(csv.contains("\n2.617993877991494"), "{csv}");
}

#[test]
fn counts_stay_those_of_all_solutions() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("two.txt");
    let typed = "x^2 + y^2 = 25, x*y = 12\nwhere: 3 <= x, y > 0\n";
    std::fs::write(&file, typed).expect("it is writable");
    let file = file.display().to_string();
    let out = folder.path().join("out").display().to_string();
    let json = printed(&[&file], &["--format", "json", "--output", &out]);
    let summary: Value = serde_json::from_str(&json).expect("one JSON object");
    assert_eq!(summary["solutions"]["distinct"], 4);
    // (3, 4) meets 3 <= x with equality, and 3 is its exact coordinate.
    let selected = &summary["selected"];
    assert_eq!(selected["condition"], "3 <= x and y > 0");
    let counts = ["count", "on_border", "undecided"].map(|name| selected[name].as_u64());
    assert_eq!(counts, [Some(2), Some(0), Some(0)]);
    let read = |name: &str| std::fs::read_to_string(format!("{out}/{name}")).expect("it is there");
    assert_eq!(read("solutions.jsonl").lines().count(), 2);
    assert!(read("summary.json").contains("\"selected\""));
    assert!(read("real_finite_solutions").starts_with("4 "));
    let lines = printed(&[&file], &["--format", "jsonl"]);
    assert_eq!(lines, read("solutions.jsonl"));
    // The square root of 2 is no rational number, and its digits do not tell.
    let root = ["-e", "x^2 = 2"];
    let lines = printed(&root, &["--where", "x^2 >= 2", "--format", "jsonl"]);
    assert_eq!(lines.matches("\"on_border\":true").count(), 2);
    let table = printed(&[&file], &["--show", "1"]);
    assert!(
        table.contains("4 solutions, all real, 2 selected"),
        "{table}"
    );
    assert!(table.contains("and 1 more (--show all)"), "{table}");
}

/// Multiple solutions on the border of a condition have rational coordinates: each is selected or not, with every seed.
#[test]
fn multiple_solutions_on_a_border_are_decided_exactly() {
    for seed in ["1", "2", "4"] {
        let counts = |equations: &[&str], options: &[&str]| {
            let options = [options, &["--format", "json", "--seed", seed]].concat();
            let json = printed(equations, &options);
            let summary: Value = serde_json::from_str(&json).expect("one JSON object");
            let selected = &summary["selected"];
            ["count", "on_border", "undecided"].map(|name| selected[name].as_u64())
        };
        let pair = ["-e", "x >= 0", "-e", "y >= 0"];
        for (equations, options, expected) in [
            (["x^2 = y", "x*y = 0"], &pair[..], 1),
            (["y^2 = x", "x*y = 0"], &["--where", "x > 0"], 0),
            (["x^2 = y^2", "x*y = 0"], &["--positive"], 0),
            (["y = x^2 - x", "x*y = 0"], &pair, 2),
            (["(x - 1)^2*(x - 3) = 0", "y^2 = x"], &["-e", "x >= 1"], 4),
        ] {
            let [first, second] = equations;
            let equations = ["-e", first, "-e", second];
            let expected = [Some(expected), Some(0), Some(0)];
            assert_eq!(counts(&equations, options), expected, "{equations:?}");
        }
    }
}

#[test]
fn games_are_one_file() {
    // Nash equilibria of the battle of the sexes (3, 2), (2, 3): two pure ones, one mixed at (3/5, 2/5). p and q are
    // the probabilities of the first choice; u and v are the losses by each choice.
    let game = r#"{"variables": ["p", "q", "a", "b"],
        "equations": [],
        "complementary": [["p", "a - 3*q"], ["1 - p", "a - 2*(1 - q)"], ["q", "b - 2*p"], ["1 - q", "b - 3*(1 - p)"]]}"#;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("game.json");
    std::fs::write(&file, game).expect("it is writable");
    let csv = printed(
        &[&file.display().to_string()],
        &["--sort", "p", "--format", "csv"],
    );
    let rows: Vec<&str> = csv.lines().skip(1).collect();
    assert_eq!(rows.len(), 3, "{csv}");
    assert!(rows[0].starts_with("0.0,0.0,2.0,3.0,"), "{csv}");
    assert!(rows[1].starts_with("0.6,0.4,1.2,1.2,"), "{csv}");
    assert!(rows[2].starts_with("1.0,1.0,3.0,2.0,"), "{csv}");
}

/// Both sides of a pair are 0 at the only solution, which is listed and counted, as decided or not.
#[test]
fn a_pair_that_is_zero_is_listed() {
    let problem =
        r#"{"variables": ["x", "y"], "equations": ["x = y"], "complementary": [["x", "y"]]}"#;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("pair.json");
    std::fs::write(&file, problem).expect("it is writable");
    let file = file.display().to_string();
    let output = cognate(&["solve", &file, "--format", "jsonl"]);
    let lines = text(&output.stdout);
    let expected = match output.status.code() {
        Some(0) => "\"on_border\":true",
        _ => "\"on_border\":null",
    };
    assert!(
        lines.lines().count() == 1 && lines.contains(expected),
        "{lines}"
    );
}

/// At 0 the condition has no value: a doubt that the exit code, the counts and each form of the answer show.
#[test]
fn points_that_may_meet_the_conditions_are_a_doubt() {
    let asked = ["solve", "-e", "x^2 = x", "--where", "1/x > 0", "--format"];
    let answer = |format: &str| {
        let output = cognate(&[&asked[..], &[format]].concat());
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        [text(&output.stdout), text(&output.stderr)]
    };
    let [json, _] = answer("json");
    let summary: Value = serde_json::from_str(&json).expect("one JSON object");
    assert_eq!(summary["settled"], false);
    assert_eq!(
        [
            &summary["selected"]["count"],
            &summary["selected"]["undecided"]
        ],
        [1, 1]
    );
    let [lines, said] = answer("jsonl");
    assert!(said.contains("1 point of which it is not known"), "{said}");
    assert_eq!(lines.matches("\"on_border\":null").count(), 1, "{lines}");
    assert_eq!(lines.matches("\"on_border\":false").count(), 1, "{lines}");
    let [rows, _] = answer("csv");
    assert!(rows.contains("0.0,1,true,false,\n"), "{rows}");
    let [table, _] = answer("table");
    assert!(table.contains("real not decided"), "{table}");
}

#[test]
fn mistakes_in_conditions_are_named() {
    for (condition, expected) in [
        (
            "x >> 4",
            "--where:1:4: expected an expression, found the character `>`",
        ),
        (
            "x > z",
            "--where:1:5: expected a declared name, found the unknown name `z`",
        ),
        (
            "x > 1 or y",
            "--where:1:11: expected one of `<`, `<=`, `>`, `>=`, `=`, `!=`",
        ),
        ("x", "expected one of `<`"),
        ("(x > 1", "expected `)`"),
        ("x > 1 y < 2", "--where:1:7: expected an operator"),
        ("x > 1 & y < 2", "--where:1:7: expected an operator"),
    ] {
        let output = cognate(&[&["solve"], &TWO[..], &["--where", condition]].concat());
        assert_eq!(output.status.code(), Some(2), "{condition}");
        let said = text(&output.stderr);
        assert!(said.contains(expected), "{condition}: {said}");
    }
}
