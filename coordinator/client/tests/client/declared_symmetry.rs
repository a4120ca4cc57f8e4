//! Symmetries that a file declares: a map that is none makes the answer unsettled, by name.

use super::program::{cognate, text};
use serde_json::Value;

/// The exit code, and the field `classes` of the summary.
fn classes(equations: &str, symmetry: &str) -> (Option<i32>, Value) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("system.json");
    let problem =
        format!(r#"{{"variables": ["x", "y"], "equations": {equations}, "symmetry": {symmetry}}}"#);
    std::fs::write(&file, problem).expect("a file");
    let output = cognate(&["solve", "--format", "json", file.to_str().expect("a path")]);
    let summary: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("one object: {}", text(&output.stderr)));
    assert_eq!(summary["settled"], output.status.code() == Some(0));
    (output.status.code(), summary["classes"].clone())
}

const CIRCLE: &str = r#"["x^2 + y^2 = 5", "x*y = 2"]"#;

#[test]
fn maps_that_are_no_symmetry_are_named() {
    for map in [r#"{"x": "2*x", "y": "y/2"}"#, r#"{"x": "y"}"#] {
        let (exit, classes) = classes(CIRCLE, &format!(r#"[{{"map": {map}}}]"#));
        assert_eq!(exit, Some(1), "{map}");
        let doubt = "symmetry generator 1 does not take solutions to solutions";
        assert_eq!(classes["doubt"], doubt, "{map}");
        assert_eq!(
            (&classes["count"], &classes["group_order"]),
            (&Value::Null, &Value::Null)
        );
    }
    let second = r#"[{"permutation": {"x": "y", "y": "x"}}, {"map": {"x": "-x"}}]"#;
    let (exit, classes) = classes(CIRCLE, second);
    assert_eq!(exit, Some(1));
    let doubt = classes["doubt"].as_str().expect("a doubt");
    assert!(doubt.starts_with("symmetry generator 2 "), "{doubt}");
}

/// All solutions are fixed by some element, so that they show only a part of the group.
#[test]
fn the_order_is_that_of_the_group() {
    let exchange = r#"{"permutation": {"x": "y", "y": "x"}}"#;
    let signs = format!(r#"[{exchange}, {{"map": {{"x": "-x", "y": "y"}}}}]"#);
    let order = |equations: &str, symmetry: &str| {
        let (exit, classes) = classes(equations, symmetry);
        assert_eq!(
            (exit, &classes["doubt"]),
            (Some(0), &Value::Null),
            "{classes}"
        );
        let number = |name: &str| classes[name].as_u64();
        (number("group_order"), number("count"), number("complete"))
    };
    assert_eq!(
        order(r#"["x^2 = 1", "y^2 = 1"]"#, &signs),
        (Some(8), Some(1), Some(1))
    );
    let point = order(r#"["x + y = 2", "x*y = 1"]"#, &format!("[{exchange}]"));
    assert_eq!(point, (Some(2), Some(1), Some(1)));
    let circle = format!(r#"[{exchange}, {{"map": {{"x": "-x", "y": "-y"}}}}]"#);
    assert_eq!(order(CIRCLE, &circle), (Some(4), Some(1), Some(1)));
}
