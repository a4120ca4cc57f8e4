//! Start solutions and parameters in each of their notations.

use cognate_systems::formats::FormatError;
use cognate_systems::formats::points::{Point, read_parameters, read_solutions};
use num_complex::Complex64;

fn names() -> Vec<String> {
    vec!["x".into(), "e1".into()]
}

fn solutions(text: &str) -> Result<Vec<Point>, FormatError> {
    read_solutions("start", text.as_bytes(), &names())
}

fn parameters(text: &str) -> Result<Vec<Point>, FormatError> {
    read_parameters("targets", text.as_bytes(), &names())
}

fn expected() -> Vec<Point> {
    vec![
        vec![Complex64::new(1.5, -2.0), Complex64::new(3e-3, 0.0)],
        vec![Complex64::new(0.1, 0.25), Complex64::new(-7.0, 1e10)],
    ]
}

fn first_line<T>(result: Result<T, FormatError>) -> String {
    match result {
        Ok(_) => "accepted".into(),
        Err(e) => e.to_string().lines().next().unwrap_or_default().into(),
    }
}

const PHCPACK: &str = "\
2
x - x + e1 - e1 + x^2; x*e1;

THE SOLUTIONS :
2 2
===========================================================
solution 1 :
t :  1.00000000000000E+00   0.00000000000000E+00
m : 1
the solution for t :
 e1 :  3.00000000000000E-03   0.00000000000000E+00
 x :  1.50000000000000E+00  -2.00000000000000E+00
== err :  1.3E-15 = rco :  2.0E-01 = res :  2.2E-16 =
solution 2 :
t :  1.00000000000000E+00   0.00000000000000E+00
m : 1
the solution for t :
 x :  1.00000000000000E-01   2.50000000000000E-01
 e1 : -7.00000000000000E+00   1.00000000000000E+10
== err :  1.3E-15 = rco :  2.0E-01 = res :  2.2E-16 ==
";

#[test]
fn solutions_are_read_from_three_notations() {
    let bertini = "2\n\n1.5e0 -2.0;\n3e-3 0;\n\n0.1 2.5E-1\n-7 +1e10\n";
    assert_eq!(solutions(bertini).expect("Bertini"), expected());
    assert_eq!(solutions(PHCPACK).expect("PHCpack"), expected());
    let ours = "{\"variables\": {\"x\": [1.5, \"-2.0000000000000000000\"], \"e1\": [3e-3, 0]}, \
        \"multiplicity\": 1}\n\n{\"paths\": [3], \"variables\": {\"e1\": [-7, 1e10], \
        \"x\": [0.1, 0.25]}}\n";
    assert_eq!(solutions(ours).expect("ours"), expected());
}

#[test]
fn parameters_are_read_from_two_notations() {
    let bertini = "2\n\n1.5 -2;\n0.003 0;\n";
    assert_eq!(parameters(bertini).expect("Bertini"), expected()[..1]);
    let one = r#"{"e1": 3e-3, "x": [1.5, -2]}"#;
    assert_eq!(parameters(one).expect("one target"), expected()[..1]);
    let many = r#"[{"e1": [3e-3, 0], "x": [1.5, -2]}, {"x": [0.1, 0.25], "e1": [-7, 1e10]}]"#;
    assert_eq!(parameters(many).expect("many targets"), expected());
}

#[test]
fn what_is_wrong_with_points_is_said_with_its_place() {
    let cases = [
        (
            solutions(""),
            "start:1:1: expected the number of points, found an empty file",
        ),
        (
            solutions("x"),
            "start:1:1: expected the number of points, found `x`",
        ),
        (
            solutions("1\n1 2\n3\n"),
            "start:4:1: expected the imaginary part of coordinate 2 of \
          point 1 of 1, found the end of the text",
        ),
        (
            solutions("1\n1 2\n3 4 5\n"),
            "start:3:5: expected the end of the file after 1 point, found `5`",
        ),
        (
            solutions("1\n1 2\n3 1e999\n"),
            "start:3:3: expected the imaginary part of coordinate 2 \
          of point 1 of 1, found `1e999`",
        ),
        (
            solutions("99999999999\n1 nan"),
            "start:2:3: expected the imaginary part of coordinate 1 \
          of point 1 of 99999999999, found `nan`",
        ),
        (
            solutions(&PHCPACK.replace(" e1 : -7", " y : -7")),
            "start:19:2: expected a declared name, found the unknown name `y`",
        ),
        (
            solutions(&PHCPACK.replace("2 2\n", "3 2\n")),
            "start:5:1: expected the number of solutions that follow, 2, found 3",
        ),
        (
            solutions(&PHCPACK.replace(" x :  1.50000000000000E+00", " x :  a1.5")),
            "start:12:2: expected a \
          coordinate `name : real part  imaginary part`, found `x :  a1.5  -2.00000000000000E+00`",
        ),
        (
            solutions("{\"variables\": {\"x\": [1, 2]}}"),
            "start:1:15: variables: expected a value for `e1`, found none",
        ),
        (
            solutions("{\"variables\": {\"x\": [1]}}"),
            "start:1:21: variables.x: expected [re, im], found a list of 1",
        ),
        (
            solutions("{\"x\": 1}"),
            "start:1:1: expected the field \"variables\", found an object \
          without it",
        ),
        (
            parameters("3\n1 2\n"),
            "targets:1:1: expected 2 parameters, as the system has, found 3",
        ),
        (
            parameters("[]"),
            "targets:1:1: expected values of parameters, found an empty list",
        ),
        (
            parameters("{\"x\": 1, \"y\": 2, \"e1\": 0}"),
            "targets:1:11: expected a declared name, found the unknown name `y`",
        ),
        (
            parameters("[{\"x\": true, \"e1\": 0}]"),
            "targets:1:8: [0].x: expected [re, im] or a number, found true",
        ),
    ];
    for (result, message) in cases {
        assert_eq!(first_line(result), message);
    }
}

/// A line of `solutions.jsonl` that says of its point that it may not be isolated is no start solution.
#[test]
fn undecided_points_are_no_start_solutions() {
    let line = |x: u32, undecided: &str| {
        format!(
            "{{\"variables\": {{\"x\": [{x}, 0], \"e1\": [0, 0]}}, \"undecided\": {undecided}}}\n"
        )
    };
    let text = [line(1, "false"), line(2, "true"), line(3, "false")].concat();
    let points = solutions(&text).expect("three lines");
    let x: Vec<f64> = points.iter().map(|point| point[0].re).collect();
    assert_eq!(x, [1.0, 3.0]);
}
