//! More digits than doubles hold, from the command line to the files.

use cognate_tests::processes::cognate;
use serde_json::{Value, json};
use std::process::Command;

/// A line touches a circle in (3, 4), another crosses it in (4, 3) and (-3, -4).
const TOUCHING: &str = "CONFIG\nSharpenDigits: 40;\nEND;\nINPUT\nvariable_group x, y;\n\
    function f, g;\nf = x^2 + y^2 - 25;\ng = (3*x + 4*y - 25)*(x - y - 1);\nEND;\n";

#[test]
fn solutions_have_the_digits_that_are_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let problem = folder.path().join("touching.bertini");
    std::fs::write(&problem, TOUCHING).expect("written");
    let out = folder.path().join("out");
    let solve = |options: &[&str]| {
        let output = Command::new(cognate())
            .args(["solve", "--seed", "5", "--workers", "1", "--threads", "1"])
            .args(options)
            .arg("--output")
            .arg(&out)
            .arg(&problem)
            .output()
            .expect("cognate can be started");
        let shown = String::from_utf8_lossy(&output.stdout).into_owned();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{shown}\n{errors}");
        shown
    };
    let read = |name: &str| std::fs::read_to_string(out.join(name)).expect("a file");
    let of_touching = || {
        let lines = read("solutions.jsonl");
        let lines = lines
            .lines()
            .map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
        let lines: Vec<Value> = lines.collect();
        let touching = lines.iter().find(|line| line["singular"] == true);
        (touching.expect("the singular solution").clone(), lines)
    };
    let whole = |integer: &str, digits: usize| format!("{integer}.{}", "0".repeat(digits - 1));

    // The file asks for 40 digits; the singular solution has those of its path.
    let table = solve(&[]);
    assert!(table.contains("2  of 3 brought to 40 digits"), "{table}");
    let (touching, lines) = of_touching();
    assert!(touching["variables"]["x"][0].is_f64(), "{touching}");
    assert_eq!(touching["deflations"], Value::Null);
    let regular = lines.iter().find(|line| line["singular"] == false);
    let x = &regular.expect("a regular solution")["variables"]["x"];
    assert!(
        [json!([whole("4", 40), "0"]), json!([whole("-3", 40), "0"])].contains(x),
        "{x}"
    );

    // The command line goes first, and deflation is for the singular one.
    let table = solve(&["--digits", "30", "--deflate"]);
    assert!(
        table.contains("3  of 3 brought to 30 digits, 1 by deflation"),
        "{table}"
    );
    let (touching, _) = of_touching();
    assert_eq!(touching["variables"]["x"], json!([whole("3", 30), "0"]));
    assert_eq!(touching["variables"]["y"], json!([whole("4", 30), "0"]));
    assert_eq!(touching["deflations"], 1);
    assert_eq!(touching["multiplicity"], 2);
    assert!(touching["accuracy"].as_f64().expect("a number") < 1e-29);
    let bertini = read("singular_solutions");
    let lines: Vec<&str> = bertini
        .lines()
        .map(str::trim)
        .filter(|l| !l.is_empty())
        .collect();
    let expected = ["3", "4"].map(|n| format!("{} 0", whole(n, 30)));
    assert_eq!(lines[1..], expected);
    let summary: Value = serde_json::from_str(&read("summary.json")).expect("JSON");
    assert_eq!(
        summary["solutions"]["sharpened"],
        json!({"digits": 30, "solutions": 3, "by_deflation": 1})
    );

    // Digits follow from the precision of the paths.
    solve(&["--precision", "212", "--digits", "16"]);
    assert!(
        of_touching()
            .1
            .iter()
            .all(|line| line["variables"]["x"][0].is_f64())
    );
    std::fs::write(&problem, TOUCHING.replace("SharpenDigits: 40;", "")).expect("written");
    let table = solve(&["--precision", "212"]);
    assert!(table.contains("2  of 3 brought to 63 digits"), "{table}");

    let refused = Command::new(cognate())
        .args(["solve", "--digits", "1001"])
        .arg(&problem)
        .output()
        .expect("cognate can be started");
    assert_eq!(refused.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&refused.stderr);
    assert!(errors.contains("1..=1000"), "{errors}");
}
