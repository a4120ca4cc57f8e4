//! `--minimize`, `--maximize`, `--critical`: values that are known by hand, kinds, and when a value is not known to be the
//! least.

use super::program::{cognate, text};
use serde_json::Value;

/// The field `critical` of a solve's summary.
fn critical(arguments: &[&str]) -> Value {
    let output = cognate(&[&["solve", "--format", "json"], arguments].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    summary["critical"].clone()
}

/// Checks the extreme value of this name, to 1e-12, and at how many points it is taken.
fn check_extreme(arguments: &[&str], name: &str, value: f64, points: u64) {
    let critical = critical(arguments);
    let extreme = &critical[name];
    let difference = extreme["value"].as_f64().map(|given| (given - value).abs());
    assert!(
        difference.is_some_and(|d| d < 1e-12),
        "{arguments:?}: {critical}"
    );
    assert_eq!(extreme["points"], points, "{arguments:?}: {critical}");
}

/// Quotients, sums of products of positive unknowns, and graphs: the points with values as good are a bounded set.
#[test]
fn extremes_whose_sublevel_sets_are_bounded() {
    let check = |text: &str, name: &str, value: f64| {
        let words: Vec<&str> = text.split('|').collect();
        check_extreme(&words, name, value, 1);
    };
    check("--maximize|1/(x^2 + 1)", "maximum", 1.0);
    check("--minimize|x/(x^2 + 1)", "minimum", -0.5);
    check(
        "--maximize|(x + y)/(x^2 + y^2 + 1)",
        "maximum",
        0.5f64.sqrt(),
    );
    check("--minimize|x + 1/x|--where|x > 0", "minimum", 2.0);
    check(
        "--minimize|x + y + 1/(x*y)|--where|x > 0, y > 0",
        "minimum",
        3.0,
    );
    check("-e|x*y = 1|--minimize|x + y|--where|x > 0", "minimum", 2.0);
    check("-e|z = x^2 + y^2|--minimize|z - x", "minimum", -0.25);
    check("--minimize|1/x|--where|x >= 1, x <= 2", "minimum", 0.5);
    check("--maximize|1/x|--where|x >= 1, x <= 2", "maximum", 1.0);
    for open in [
        &["--minimize", "1/(x^2 + 1)"][..],
        &["--minimize", "x + 1/x"],
        &["--maximize", "1/x", "--where", "x > 0, x <= 2"],
        &["-e", "x*y = 1", "--minimize", "x + y"],
        &["--minimize", "(x*y - 1)^2 + x^2"],
    ] {
        let critical = critical(open);
        assert!(
            critical["minimum"].is_null() && critical["maximum"].is_null(),
            "{critical}"
        );
    }
}

#[test]
fn extreme_values_that_are_known_by_hand() {
    let rosenbrock = "minimize: (1 - x)^2 + 100*(y - x^2)^2";
    for (arguments, name, value, points) in [
        // The point of an ellipse nearest to (2, 0).
        (
            &["-e", "x^2 + 3*y^2 = 1", "--minimize", "(x - 2)^2 + y^2"][..],
            "minimum",
            1.0,
            1,
        ),
        // y = x/2 and x^2 = 9/8.
        (
            &["-e", "minimize: (x^2 - 1)^2 + y^2 - x*y"],
            "minimum",
            -0.265_625,
            2,
        ),
        (
            &["-e", "x*y = 1", "--minimize", "x^2 + 4*y^2"],
            "minimum",
            4.0,
            2,
        ),
        // The largest product of three numbers on a sphere.
        (
            &["-e", "x^2 + y^2 + z^2 = 3", "--maximize", "x*y*z"],
            "maximum",
            1.0,
            4,
        ),
        // A parabola, with nothing else typed.
        (&["--minimize", "(x - 3)^2 + 2"], "minimum", 2.0, 1),
        // Rosenbrock's function (1960), 0 at (1, 1).
        (&["-e", rosenbrock], "minimum", 0.0, 1),
        // Himmelblau's function (1972) is 0 at four points.
        (
            &["-e", "minimize: (x^2 + y - 11)^2 + (x + y^2 - 7)^2"],
            "minimum",
            0.0,
            4,
        ),
        // Stewart, Calculus: on x^2 + y^2 = 136, 5 x - 3 y is at most 68.
        (
            &["-e", "x^2 + y^2 = 136", "--maximize", "5*x - 3*y"],
            "maximum",
            68.0,
            1,
        ),
        // The largest eigenvalue of ((2, 1), (1, 2)).
        (
            &["-e", "x^2 + y^2 = 1", "--maximize", "2*x^2 + 2*x*y + 2*y^2"],
            "maximum",
            3.0,
            2,
        ),
    ] {
        check_extreme(arguments, name, value, points);
    }
}

/// The gradients of such conditions depend on each other where they hold with equality.
#[test]
fn conditions_that_say_the_same_are_one() {
    let check = |text: &str, value: f64| {
        let words: Vec<&str> = text.split('|').collect();
        check_extreme(&words, "minimum", value, 1);
    };
    check("--minimize|x^2 + y^2|--where|y >= 0|--where|0 <= y", 0.0);
    check(
        "--minimize|(x - 1)^2 + (y + 1)^2|--where|y >= 0 and 2*y >= 0",
        1.0,
    );
    let border = "x >= 0 and x > 0";
    let open = critical(&["--minimize", "(x + 1)^2 + y^2", "--where", border]);
    assert!(open["minimum"].is_null(), "{open}");
}

/// A value that is taken on a curve or an edge only, of which no point is isolated.
#[test]
fn extreme_values_on_sets() {
    let check = |text: &str, name: &str, value: f64| {
        let words: Vec<&str> = text.split('|').collect();
        check_extreme(&words, name, value, 0);
    };
    let square = "0 <= x, x <= 1, 0 <= y, y <= 1";
    check(&format!("--maximize=-x|--where|{square}"), "maximum", 0.0);
    let triangle = "x + y >= 1, x >= 0, y >= 0, x <= 5, y <= 5";
    check(
        &format!("--minimize|x + y|--where|{triangle}"),
        "minimum",
        1.0,
    );
    // Paths end at complex points of the side x = 1.
    check(
        &format!("--minimize|x^2 - x*y + y - 2*x|--where|{square}"),
        "minimum",
        -1.0,
    );
    check("--minimize|(x^2 + y^2 - 1)^2", "minimum", 0.0);
    check("--minimize|(x^2 + y^2 - 3)^2*(x^2 + 1)", "minimum", 0.0);
    check("--minimize|(x*y - 1)^2", "minimum", 0.0);
    check("-e|x^2 + y^2 + z^2 = 1|--minimize|z^2", "minimum", 0.0);
    // The edge is excluded.
    let open = critical(&["--minimize", "x", "--where", "x > 0, 0 <= y, y <= 1"]);
    assert!(open["minimum"].is_null(), "{open}");
    // On the line y = x + 3, outside of the square, y is larger.
    let above = format!("--maximize|y|--where|{square}, y - x <= 3");
    check(&above, "maximum", 1.0);
    // The value 0 is that of a circle on which the conditions do not hold: known where they bound all unknowns.
    let outside = ["--minimize", "(x^2 + y^2 - 1)^2", "--where"];
    let open = critical(&[&outside[..], &["x >= 2"]].concat());
    assert!(open["minimum"].is_null(), "{open}");
    let disc = [&outside[..], &["(x - 3)^2 + y^2 <= 1"]].concat();
    check_extreme(&disc, "minimum", 9.0, 1);
    // On false branches the sum is -1, below what absolute values can be.
    check("--minimize|abs(x - 1) + abs(x - 2)", "minimum", 1.0);
}

/// The gradients of such equations depend on each other at all their solutions.
#[test]
fn equations_that_say_nothing_new_are_left_out() {
    let check = |text: &str, value: f64| {
        let words: Vec<&str> = text.split('|').collect();
        check_extreme(&words, "minimum", value, 1);
    };
    check("-e|x^2 + y^2 = 1|-e|2*x^2 + 2*y^2 = 2|--minimize|x", -1.0);
    check("-e|(x^2 + y^2 - 1)^2 = 0|--minimize|x", -1.0);
    check("-e|x^2*y^2 = 0|--minimize|(x - 1)^2 + (y - 2)^2", 1.0);
    check(
        "-e|x^2 + y^2 = 1|-e|(x^2 + y^2 - 1)*(x^2 + 1) = 0|--minimize|x",
        -1.0,
    );
    check(
        "-e|x + y + z = 1|-e|x = y|-e|2*x + z = 1|--minimize|x^2 + y^2 + z^2",
        1.0 / 3.0,
    );
}

/// The function of Goldstein and Price (1971), 3 at (0, -1): its leading terms do not say that it grows. The others are not
/// bounded below, or come as near to a value as one likes.
#[test]
fn extremes_by_values_on_large_spheres() {
    let goldstein_price = "(1 + (x + y + 1)^2*(19 - 14*x + 3*x^2 - 14*y + 6*x*y + 3*y^2))*(30 + (2*x - 3*y)^2*\
                           (18 - 32*x + 12*x^2 + 48*y - 36*x*y + 27*y^2))";
    check_extreme(&["--minimize", goldstein_price], "minimum", 3.0, 1);
    for open in [
        "x^3 + y^3 - 3*x*y",
        "x^2*y^2 + x^2 + y",
        "x^2*y^2 + x^2 + 2*x*y",
    ] {
        let critical = critical(&["--minimize", open]);
        assert!(critical["minimum"].is_null(), "{open}: {critical}");
    }
    // Odd powers grow where their unknowns are not negative.
    let folium = [
        "--minimize",
        "x^3 + y^3 - 3*x*y",
        "--where",
        "x >= 0, y >= 0",
    ];
    check_extreme(&folium, "minimum", -1.0, 1);
}

/// Values of a quotient lie between 1/3 and 3, at 1 and -1; near the zeros of a denominator there may be others.
#[test]
fn objectives_may_be_quotients() {
    let quotient = critical(&["--critical", "(x^2 - x + 1)/(x^2 + x + 1)"]);
    assert_eq!([&quotient["minima"], &quotient["maxima"]], [1, 1]);
    let arguments = ["-e", "-1 <= x <= 1", "--minimize", "1/x"];
    let pole = critical(&arguments);
    assert!(pole["minimum"].is_null(), "{pole}");
    let reason = pole["reason"].as_str().unwrap_or_default();
    assert!(reason.contains("zeros of a denominator"), "{reason}");
    // Excluded values: 0 < x <= 1.
    let open = critical(&[
        "--minimize",
        "x",
        "--where",
        "1/x >= 1",
        "--where",
        "0 <= x <= 2",
    ]);
    assert!(open["minimum"].is_null(), "{open}");
}

#[test]
fn a_value_is_the_least_only_where_that_is_known() {
    // x + 1/x has a minimum at 1 and a maximum at -1, and no least value.
    let hyperbola = critical(&["-e", "x*y = 1", "--minimize", "x + y"]);
    assert!(hyperbola["minimum"].is_null(), "{hyperbola}");
    assert_eq!([&hyperbola["minima"], &hyperbola["maxima"]], [1, 1]);
    let reason = hyperbola["reason"].as_str().unwrap_or_default();
    assert!(reason.contains("towards infinity"), "{reason}");
    // A saddle and two minima; critical points alone are asked.
    let asked = critical(&["-e", "critical: x^4 - 2*x^2 - y^2"]);
    assert_eq!(
        [&asked["minima"], &asked["maxima"], &asked["saddles"]],
        [0, 1, 2]
    );
    assert!(asked["minimum"].is_null() && asked["maximum"].is_null());
    // No real solution.
    let empty = critical(&["-e", "x^2 + y^2 = -1", "--minimize", "x"]);
    assert!(empty["minimum"].is_null(), "{empty}");
    // A fourth power and a cusp: second derivatives do not tell.
    let flat = critical(&["-e", "minimize: x^4 + y^2"]);
    assert_eq!(flat["degenerate"], 1, "{flat}");
    let is_zero = |value: &Value| value.as_f64().is_some_and(|value| value.abs() < 1e-12);
    assert!(is_zero(&flat["minimum"]["value"]), "{flat}");
    let cusp = critical(&["-e", "y^2 = x^3", "--minimize", "x^2 + y^2 + 2*x"]);
    assert_eq!(cusp["degenerate"], 1, "{cusp}");
    assert!(is_zero(&cusp["minimum"]["value"]), "{cusp}");
}

#[test]
fn lines_have_values_and_kinds_and_no_multipliers() {
    let arguments = [
        "solve",
        "-e",
        "x*y = 1",
        "--minimize",
        "x^2 + 4*y^2",
        "--format",
    ];
    let output = cognate(&[&arguments[..], &["jsonl"]].concat());
    let lines = text(&output.stdout);
    assert_eq!(lines.matches("\"kind\":\"minimum\"").count(), 2, "{lines}");
    assert_eq!(lines.matches("\"objective\":").count(), 4, "{lines}");
    assert!(!lines.contains("multiplier"), "{lines}");
    for (arguments, expected) in [
        (
            &["-e", "x^2 = 1", "--where", "x = 1", "--minimize", "x"][..],
            "an equality is typed as an equation",
        ),
        (
            &[
                "-e",
                "x^2 = 1",
                "--where",
                "x > 0 or x < 0",
                "--minimize",
                "x",
            ],
            "that hold together beside an objective",
        ),
        (&["-e", "x*y = 1", "--minimize", "z"], "unknown name `z`"),
        (
            &["-e", "sin(a) = 1", "--minimize", "a"],
            "functions of the angle `a`",
        ),
        (
            &["-e", "x*y = 1", "--minimize", "x", "--where", "abs(y) < 1"],
            "try: cognate solve -e \"r = sqrt(x)\"",
        ),
        (
            &["-e", "x = 1", "--minimize", "x", "--maximize", "x"],
            "cannot be used with",
        ),
        (
            &["-e", "minimize: x^2", "-e", "maximize: x"],
            "one objective",
        ),
    ] {
        let output = cognate(&[&["solve"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = text(&output.stderr);
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
    for command in [&["submit"][..], &["decompose"], &["path", "--index", "0"]] {
        let output = cognate(&[command, &["-e", "minimize: x^2 + 1"]].concat());
        assert_eq!(output.status.code(), Some(2), "{command:?}");
        let said = text(&output.stderr);
        assert!(said.contains("is answered by `cognate solve`"), "{said}");
    }
}

#[test]
fn conditions_are_active_or_not() {
    for (arguments, name, value, points) in [
        // The nearest point of a half plane.
        (
            &["-e", "x + y >= 2", "--minimize", "x^2 + y^2"][..],
            "minimum",
            2.0,
            1,
        ),
        // Bazaraa, Sherali, Shetty, Nonlinear Programming (1993), example 4.2.10: (2, 1).
        (
            &[
                "-e",
                "x^2 + y^2 <= 5, x + 2*y <= 4, x >= 0, y >= 0",
                "--minimize",
                "(x - 3)^2 + (y - 2)^2",
            ],
            "minimum",
            2.0,
            1,
        ),
        // The minimum of a distance on the border, where the condition holds with equality and has no part.
        (
            &["-e", "y >= 0", "--minimize", "(x - 1)^2 + y^2"],
            "minimum",
            0.0,
            1,
        ),
        // Linear programs: a corner; an unknown that only a condition names.
        (
            &["-e", "minimize: x + 2*y", "-e", "x >= 1, y >= -2"],
            "minimum",
            -3.0,
            1,
        ),
        (
            &["--minimize", "y", "--where", "x^2 + y^2 <= 25"],
            "minimum",
            -5.0,
            1,
        ),
        (
            &["-e", "maximize: x", "-e", "x^2 + y^2 <= 4, y >= 1"],
            "maximum",
            1.732_050_807_568_877_2,
            1,
        ),
        // Objectives that are constant on a side: whole sets of critical points.
        (
            &["-e", "x >= 0, y >= 0, x + 2*y <= 4", "--maximize", "x*y"],
            "maximum",
            2.0,
            1,
        ),
        // This objective with a start that is named, which is none of the decomposition.
        (
            &[
                "-e",
                "x >= 0, y >= 0, x + 2*y <= 4",
                "--maximize",
                "x*y",
                "--start",
                "multihomogeneous",
            ],
            "maximum",
            2.0,
            1,
        ),
        (
            &["-e", "x + y + z = 6", "--positive", "--maximize", "x*y*z"],
            "maximum",
            8.0,
            1,
        ),
        // Equation and condition: (1/2, sqrt(3)/2) of a circle.
        (
            &[
                "-e",
                "x^2 + y^2 = 1",
                "--where",
                "x <= 1/2",
                "--maximize",
                "x + y",
            ],
            "maximum",
            1.366_025_403_784_438_6,
            1,
        ),
        // By the means of two positive numbers.
        (
            &["-e", "x > 0, y > 0, x*y >= 1", "--minimize", "x + y"],
            "minimum",
            2.0,
            1,
        ),
    ] {
        check_extreme(arguments, name, value, points);
    }
}

/// Optima at multiple solutions of the critical equations: a corner that a condition only touches (by Cauchy and
/// Schwarz), a cusp, and a minimum of order four on the border.
#[test]
fn extreme_values_at_multiple_solutions() {
    let disc = "x^2 + y^2 <= 841, x <= 21, y >= 0";
    let cusp = "(y - 4)^2 = (x - 3)^3";
    let strip = "x + y >= 31, x - y >= -17";
    for seed in ["1", "2", "3"] {
        let seeded = |arguments: &[&'static str]| [arguments, &["--seed"]].concat();
        let check = |arguments: &[&'static str], name: &str, value: f64| {
            let critical = critical(&[&seeded(arguments)[..], &[seed]].concat());
            let extreme = critical[name]["value"].as_f64();
            let difference = extreme.map(|extreme| (extreme - value).abs());
            // Multipliers are irrational there, so that the digits are those of a multiple endpoint.
            assert!(difference.is_some_and(|d| d < 1e-9), "{critical}");
        };
        check(
            &["--maximize", "21*x + 20*y", "--where", disc],
            "maximum",
            841.0,
        );
        check(
            &["-e", cusp, "--minimize", "x", "--where", "y >= 4, x <= 8"],
            "minimum",
            3.0,
        );
        check(
            &["--minimize", "(x - 7)^4 + (y - 24)^4", "--where", strip],
            "minimum",
            0.0,
        );
    }
}

/// Corners where three conditions hold with equality in the plane: multipliers there are a whole line, and the point is in no
/// count of solutions.
#[test]
fn extreme_values_where_conditions_depend_on_each_other() {
    for (arguments, name, value) in [
        (
            [
                "--maximize",
                "x + y",
                "--where",
                "x^2 + y^2 <= 2, x <= 1, y <= 1",
            ],
            "maximum",
            2.0,
        ),
        (
            [
                "--minimize",
                "(x - 3)^2 + (y - 3)^2",
                "--where",
                "x <= 1, y <= 1, x + y <= 2, x >= 0",
            ],
            "minimum",
            8.0,
        ),
    ] {
        let critical = critical(&arguments);
        let extreme = critical[name]["value"].as_f64();
        let difference = extreme.map(|extreme| (extreme - value).abs());
        assert!(difference.is_some_and(|d| d < 1e-9), "{critical}");
        assert_eq!(critical[name]["points"], 1, "{critical}");
        assert_eq!(critical["with_sets_of_multipliers"], 1, "{critical}");
        let output = cognate(&[&["solve", "--format", "csv"], &arguments[..]].concat());
        let rows = text(&output.stdout);
        let is_listed = rows.lines().any(|row| row.contains("degenerate"));
        assert!(is_listed, "{rows}");
    }
}

/// Objectives with roots and angles: Heron's path by a mirror, with the length of the straight one, 5; Fermat's point of the
/// triangle with sides 3, 4 and 5, where the sum of distances is the root of 25 + 12 sqrt(3); a root at the end of where it is
/// defined; a kink; points of a circle.
#[test]
fn objectives_may_have_roots_and_angles() {
    let heron = "sqrt(x^2 + 1) + sqrt((x - 4)^2 + 4)";
    check_extreme(&["--minimize", heron], "minimum", 5.0, 1);
    let fermat = "sqrt(x^2 + y^2) + sqrt((x - 4)^2 + y^2) + sqrt(x^2 + (y - 3)^2)";
    let sum = (25.0 + 12.0 * 3.0_f64.sqrt()).sqrt();
    check_extreme(&["--minimize", fermat], "minimum", sum, 1);
    let root = ["--minimize", "sqrt(x) - x/4", "--where", "x <= 9"];
    check_extreme(&root, "minimum", 0.0, 1);
    let root = ["--maximize", "sqrt(x) - x/4", "--where", "x <= 9"];
    check_extreme(&root, "maximum", 1.0, 1);
    check_extreme(&["--minimize", "abs(x - 1) + x^2"], "minimum", 0.75, 1);
    let five = 5.0_f64.sqrt();
    check_extreme(&["--minimize", "cos(a) + 2*sin(a)"], "minimum", -five, 1);
    let wrist = "cos(a) + cos(a + b)/2";
    check_extreme(&["--maximize", wrist], "maximum", 1.5, 1);
    let nearest = ["-e", "y = sqrt(x)", "--minimize", "(x - 3)^2 + y^2"];
    check_extreme(&nearest, "minimum", 2.75, 1);
    // Angles are given back as angles.
    let output = cognate(&["solve", "--format", "csv", "--maximize", wrist]);
    let rows = text(&output.stdout);
    assert!(rows.starts_with("a,b,multiplicity"), "{rows}");
    let output = cognate(&["solve", "--minimize", "cos(a)", "--where", "a > 1"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("no condition on the angle `a`"),
        "{message}"
    );
}

/// A region without equations, in a file: the least x^2 + y^2 with x y >= 1 is 2, at (1, 1) and (-1, -1).
#[test]
fn a_file_of_conditions_alone_is_a_region() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("region.txt");
    std::fs::write(&file, "x*y >= 1\n-3 <= x <= 3\n-3 <= y <= 3\n").expect("a file");
    let file = file.to_str().expect("a name");
    check_extreme(&[file, "--minimize", "x^2 + y^2"], "minimum", 2.0, 2);
    check_extreme(&[file, "--maximize", "x^2 + y^2"], "maximum", 18.0, 2);
}

/// A point that a condition excludes is no limit of allowed points where the solutions are isolated, and their sets are
/// those of multipliers.
#[test]
fn excluded_points_of_finite_sets_are_no_limits() {
    let cubic = [
        "-e",
        "x^3 - 3*x^2 + 2*x = 0",
        "--minimize",
        "x",
        "--positive",
    ];
    check_extreme(&cubic, "minimum", 1.0, 1);
    let pair = ["-e", "x^2 = 4", "--maximize", "x", "--where", "x < 2"];
    check_extreme(&pair, "maximum", -2.0, 1);
    let hyperbola = [
        "-e",
        "x*y = 1",
        "-e",
        "x = y",
        "--minimize",
        "x",
        "--where",
        "x > -1",
    ];
    check_extreme(&hyperbola, "minimum", 1.0, 1);
    let output = cognate(&[&["solve"], &cubic[..]].concat());
    let shown = text(&output.stdout);
    assert!(!shown.contains("a positive-dimensional"), "{shown}");
}

/// Values near that of an excluded point are taken where that is shown: an isolated point of the region has none near it.
/// Better values towards infinity are named.
#[test]
fn excluded_points_are_limits_where_that_is_shown() {
    let check = |arguments: &[&str], expected: [&str; 2]| {
        let critical = critical(arguments);
        let reason = critical["reason"].as_str().unwrap_or_default();
        let is_so = expected.iter().all(|part| reason.contains(part));
        assert!(is_so, "{arguments:?}: {critical}");
        assert!(critical["minimum"].is_null() && critical["maximum"].is_null());
    };
    let doubt = "it is not excluded that values come";
    let node = [
        "-e",
        "y^2 = x^2*(x - 1)",
        "--minimize",
        "x",
        "--where",
        "x > 0",
    ];
    check(&node, [doubt, "near as one likes to 0"]);
    let region = "x^2*(x - 2) >= y^2 and x > 0";
    let region = ["--minimize", "(x - 1/2)^2 + y^2", "--where", region];
    check(&region, [doubt, "near as one likes to 0.25"]);
    let none = "there is none: values come as near as one likes to";
    let open = "larger value towards infinity";
    check(
        &["--maximize", "x^4 + y^4", "--where", "x > 0"],
        [none, open],
    );
    check(
        &["--maximize", "-1/(x^2 + 1)", "--where", "x > 0"],
        [none, open],
    );
    let disk = ["--maximize", "(x + 3)^2 + (y + 3)^2", "--where", "y < 3"];
    check(&disk, [none, open]);
    // Conditions of which the gradients depend on each other or are 0 along the solutions.
    let corner = [
        "--minimize",
        "x + 2*y",
        "--where",
        "x > 0, y > 0, x + y > 0",
    ];
    check(
        &corner,
        [none, "likes to 0, at a point that the conditions exclude"],
    );
    let circle = [
        "-e",
        "x^2 + y^2 = 1",
        "--minimize",
        "x",
        "--where",
        "x > -1",
    ];
    check(
        &circle,
        [none, "likes to -1, at a point that the conditions exclude"],
    );
}

#[test]
fn conditions_may_leave_no_value_or_a_doubt() {
    let reason = |arguments: &[&str]| {
        let critical = critical(arguments);
        assert!(critical["minimum"].is_null(), "{critical}");
        critical["reason"].as_str().unwrap_or_default().to_owned()
    };
    // 1 at (1, 0) and (0, 1), which are excluded.
    let excluded = reason(&["-e", "x^2 + y^2 = 1", "--positive", "--minimize", "x + y"]);
    assert!(excluded.contains("as near as one likes to 1"), "{excluded}");
    let unbounded = reason(&["-e", "minimize: x - y", "-e", "x >= 0, y >= 0"]);
    assert!(unbounded.contains("towards infinity"), "{unbounded}");
    // No point is critical: a derivative is a constant, also once its terms or its denominator are gone, or of no multiple
    // of a condition's.
    for arguments in [
        &["--minimize", "x + y"][..],
        &["--minimize", "x + y", "--where", "x >= 0"],
        &["--minimize", "(x + 1)^2 - x^2"],
        &["--minimize", "1/x"],
    ] {
        let unbounded = reason(arguments);
        let expected = "all critical points are known; a lower value towards infinity";
        assert!(
            unbounded.starts_with(expected),
            "{arguments:?}: {unbounded}"
        );
    }
    // The solutions that are shown meet the conditions.
    let output = cognate(&[
        "solve",
        "-e",
        "minimize: (x^2 - 1)^2",
        "-e",
        "x >= 1/2",
        "--format",
        "csv",
    ]);
    let rows = text(&output.stdout);
    assert!(rows.starts_with("x,multiplicity"), "{rows}");
    assert_eq!(rows.lines().count(), 3, "{rows}");
    assert!(
        rows.contains(",0.0,minimum") && rows.contains(",0.5625,maximum"),
        "{rows}"
    );
}

/// Where two branches of a curve meet, and the objective has its least value there, all gradients are 0: every multiplier
/// is one of the point.
#[test]
fn least_values_at_singular_points() {
    for curve in [
        "x*y = 0",
        "y^2 = x^3",
        "y^2 = x^2*(x + 1)",
        "y^2 = x^2*(x - 1)",
        "(x^2 + y^2)^2 = x^2 - y^2",
    ] {
        check_extreme(&["-e", curve, "--minimize", "x^2 + y^2"], "minimum", 0.0, 1);
    }
}
