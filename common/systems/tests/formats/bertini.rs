//! Bertini-classic: what the notation means, checked by exact values.

use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::exact;
use cognate_systems::formats::{self, PrecisionHint, Problem};

fn read(text: &str) -> Problem {
    match formats::read("test", text.as_bytes()) {
        Ok(problem) => problem,
        Err(e) => panic!("{e}"),
    }
}

/// The values of the equations at a point of real rational coordinates.
fn values(problem: &Problem, point: &[(i64, u64)], parameters: &[i64]) -> Vec<ComplexRational> {
    let point: Vec<_> = point
        .iter()
        .map(|&p| ComplexRational::real(Rational::from(p)))
        .collect();
    let parameters: Vec<_> = parameters
        .iter()
        .map(|&p| ComplexRational::real(p))
        .collect();
    let s = &problem.system;
    exact::values(&s.expressions, &s.equations, &point, &parameters)
        .into_iter()
        .map(|v| v.expect("rational"))
        .collect()
}

/// The value of one expression in x at x = `at`.
fn value(expression: &str, at: (i64, u64)) -> ComplexRational {
    let text = format!("variable_group x; function f; f = {expression} + 0*x + x - x + x; END;");
    let sum = values(&read(&text), &[at], &[]).remove(0);
    sum.subtract(&ComplexRational::real(Rational::from(at)))
}

fn rational(numerator: i64, denominator: i64) -> ComplexRational {
    ComplexRational::real(Rational::from((numerator, denominator)))
}

#[test]
fn precedence_is_that_of_bertini() {
    assert_eq!(value("-x^2", (3, 1)), rational(-9, 1));
    assert_eq!(value("(-x)^2", (3, 1)), rational(9, 1));
    assert_eq!(value("2^3^2", (1, 1)), rational(512, 1));
    assert_eq!(value("2^-3*x", (4, 1)), rational(1, 2));
    assert_eq!(value("2*-x^2", (3, 1)), rational(-18, 1));
    assert_eq!(value("12/2/3*x", (1, 1)), rational(2, 1));
    assert_eq!(value("1 - 2 - 3*x - -x", (1, 1)), rational(-3, 1));
    assert_eq!(value("+x - +x**2", (2, 1)), rational(-2, 1));
    assert_eq!(value("-2*x/4", (2, 1)), rational(-1, 1));
    assert_eq!(value("x^0", (7, 1)), rational(1, 1));
    assert_eq!(
        value("4^(1/2)*x + 8^(-2/3) + sqrt(9/4)", (1, 1)),
        rational(15, 4)
    );
    assert_eq!(value("(-4)^(1/2)*x", (1, 1)), ComplexRational::new(0, 2));
    assert_eq!(
        value("I^7*x + (1+I)*(1-I)", (1, 1)),
        ComplexRational::new(2, -1)
    );
    assert_eq!(value("I^-99997*x", (1, 1)), ComplexRational::new(0, -1));
}

#[test]
fn numbers_are_exact() {
    assert_eq!(value("1.5e-3*x", (1, 1)), rational(3, 2000));
    assert_eq!(value(".1 + 0.2 + x*2.E+2", (1, 1)), rational(2003, 10));
    assert_eq!(value("(x/3)*0.25E0", (1, 1)), rational(1, 12));
}

#[test]
fn names_that_begin_alike_or_with_e_are_different() {
    let text = "variable_group x, x1, e, E2, x12; function f;
        f = x + 10*x1 + 100*e + 1000*E2 + 2e4*x12; END;";
    let point = [(1, 1), (2, 1), (3, 1), (4, 1), (5, 1)];
    assert_eq!(values(&read(text), &point, &[]), [rational(104_321, 1)]);
}

#[test]
fn definitions_may_stand_in_any_order() {
    let text = "% comment\nINPUT\nf1 = g2 - c; % use before definition
        function f2, f1;\nconstant c;\ng2 = g1^2; g1 = x + y;\nc = d/2; f2 = f1*x;
        constant d; d = 6;\nvariable_group x; hom_variable_group y; END; the rest";
    let problem = read(text);
    assert_eq!(problem.system.variables, ["x", "y"]);
    assert_eq!(problem.system.equation_names, ["f2", "f1"]);
    let groups: Vec<bool> = problem
        .system
        .groups
        .iter()
        .map(|g| g.homogeneous)
        .collect();
    assert_eq!(groups, [false, true]);
    assert_eq!(
        values(&problem, &[(1, 1), (2, 1)], &[]),
        [rational(6, 1), rational(6, 1)]
    );
    assert_eq!(problem.warnings.len(), 1);
}

#[test]
fn settings_are_kept_or_warned_about() {
    let text = "CONFIG\nRandomSeed: 17;\nMPTYPE: 1; Precision: 128;\nFinalTol: 1e-11;
        tracktype: 0; % isolated\nOdePredictor: 5;\nParameterHomotopy: 2;\nEND;
        INPUT\nvariable_group x; parameter p; function f; f = x^2 - p; END;";
    let problem = read(text);
    assert_eq!(problem.settings.seed, Some(17));
    assert_eq!(problem.settings.precision, Some(PrecisionHint::Bits(128)));
    assert_eq!(problem.settings.final_tolerance, Some(1e-11));
    assert_eq!(problem.settings.parameter_homotopy, Some(2));
    assert!(!problem.settings.user_homotopy);
    assert_eq!(problem.system.parameters, ["p"]);
    let warnings: Vec<String> = problem.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        warnings,
        ["test:6: the setting OdePredictor has no meaning here and is ignored"]
    );
}

/// Settings without a meaning here are named once, and other kinds of runs with the command that does them.
#[test]
fn what_is_not_followed_is_named_once() {
    let text = "CONFIG\nTrackType: -3;\nMaxNorm: 1e5;\nOdePredictor: 5;\nEND;
        INPUT\nvariable_group x; function f; f = x^2 - 2; END;";
    let problem = read(text);
    let warnings: Vec<String> = problem.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        warnings,
        ["test:3: the settings MaxNorm, OdePredictor have no meaning here and are ignored"]
    );
    let other = problem.settings.other_run.expect("another run");
    assert_eq!(other.track_type, -3);
    let refusal = other.refusal.to_string();
    let expected = "test:2:13: not in this version: TrackType: -3; points are not evaluated alone; `cognate solve` refines";
    assert!(refusal.starts_with(expected), "{refusal}");
    let plain =
        read("CONFIG\nTrackType: 0;\nEND;\nINPUT\nvariable_group x; function f; f = x^2 - 2; END;");
    assert_eq!((plain.settings.other_run, plain.warnings), (None, vec![]));
}

#[test]
fn a_user_homotopy_has_a_path_variable() {
    let text = "CONFIG UserHomotopy: 1; END; INPUT variable x, y; function f, g;
        pathvariable t; parameter s; s = t^2; constant gamma; gamma = 3/5 + 4/5*I;
        f = (x^2 - 4)*(1 - s) + gamma*s*(x^2 - 1); g = y - t*x; END;";
    let problem = read(text);
    assert_eq!(problem.system.parameters, ["t"]);
    assert_eq!(problem.system.path_variable, Some(0));
    assert_eq!(problem.system.groups.len(), 1);
    assert!(problem.settings.user_homotopy);
    assert_eq!(
        values(&problem, &[(3, 1), (5, 1)], &[0]),
        [rational(5, 1), rational(5, 1)]
    );
    let at_one = values(&problem, &[(3, 1), (5, 1)], &[1]);
    assert_eq!(at_one[0], ComplexRational::new((24, 5), (32, 5)));
}

#[test]
fn deep_inputs_are_limited_not_fatal() {
    let deep = |n: usize| {
        let text = format!(
            "variable_group x; function f; f = {}x{}; END;",
            "(".repeat(n),
            ")".repeat(n)
        );
        formats::read("deep", text.as_bytes())
            .map(|_| ())
            .map_err(|e| e.problem.to_string())
    };
    assert_eq!(deep(9_000), Ok(()));
    assert_eq!(
        deep(200_000),
        Err("expected at most 10000 levels of nesting, found 10001 \
             (not in this version: limit NESTING)"
            .into())
    );
    // A chain of definitions, written backwards, is as deep as it is long.
    let mut text = String::from("variable_group x; function f; f = a0; ");
    for i in 0..50_000 {
        text += &format!("a{i} = a{} + 1; ", i + 1);
    }
    text += "a50000 = x; END;";
    let problem = read(&text);
    assert_eq!(values(&problem, &[(0, 1)], &[]), [rational(50_000, 1)]);
}

#[test]
fn the_examples_are_read() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../deploy/examples");
    let shape = |name: &str| {
        let path = format!("{folder}/{name}.bertini");
        let problem = match formats::read(&path, &std::fs::read(&path).expect("an example")) {
            Ok(problem) => problem,
            Err(e) => panic!("{e}"),
        };
        let s = &problem.system;
        (
            s.variable_count(),
            s.equation_count(),
            s.groups.len(),
            s.dimension(),
        )
    };
    assert_eq!(shape("stewart_gough_dietmaier"), (8, 7, 1, 7));
    assert_eq!(shape("three_rpr"), (10, 10, 2, 10));
    assert_eq!(shape("six_revolute_manseur_doty"), (8, 8, 2, 8));
    assert_eq!(shape("four_bar"), (8, 8, 2, 8));
    assert_eq!(shape("katsura_10"), (11, 11, 1, 11));
    assert_eq!(shape("cyclic_5"), (5, 5, 1, 5));
    assert_eq!(shape("noon_5"), (5, 5, 1, 5));
    assert_eq!(shape("six_revolute_loop"), (12, 18, 1, 12));
}

#[test]
fn random_constants_are_those_of_the_seed() {
    let text = |seed: u64| {
        format!(
            "CONFIG RandomSeed: {seed}; END; INPUT variable_group x; random a, b; random_real c;
             function f; f = a*x^2 + b*x + c; END;"
        )
    };
    let values_of_seed = |seed| values(&read(&text(seed)), &[(3, 1)], &[]);
    assert_eq!(values_of_seed(5), values_of_seed(5));
    assert_ne!(values_of_seed(5), values_of_seed(6));
    let problem = read(&text(5));
    let warning = "test:1: random constants are those of RandomSeed 5, whatever seed the solve has";
    assert_eq!(problem.warnings[0].to_string(), warning);
    let only = |name: &str| {
        let text =
            format!("variable_group x; random a; random_real c; function f; f = x + {name}; END;");
        values(&read(&text), &[(0, 1)], &[]).remove(0)
    };
    let (a, c) = (only("a"), only("c"));
    let square = Rational::from(&a.re * &a.re) + Rational::from(&a.im * &a.im);
    assert!((square.to_f64() - 1.0).abs() < 1e-11 && !a.is_real());
    assert!(c.is_real() && c.re.to_f64().abs() <= 1.0 && !c.is_zero());
}

#[test]
fn files_are_read_as_people_write_them() {
    let body = "variable_group x; function f; f = x^2 - 2;";
    for end in ["END", "END\n", "END;", "END\n\n% the end"] {
        let problem = read(&format!("CONFIG\nMPType: 0;\nEND\nINPUT\n{body}\n{end}"));
        assert_eq!(
            problem.settings.precision,
            Some(PrecisionHint::Double),
            "{end}"
        );
    }
    let before = "7 bars, by A. Uthor\n{a draft}\n";
    let problem = read(&format!(
        "{before}CONFIG\nMPType: 1;\nEND;\nINPUT\n{body}\nEND;"
    ));
    assert_eq!(problem.settings.precision, Some(PrecisionHint::Bits(96)));
    let warnings: Vec<String> = problem.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["test:1: what stands before `CONFIG` is ignored"]);
}

#[test]
fn comments_may_be_in_latin_1() {
    let text = b"% M\xfcller, 2013\nvariable_group x; function f; % caf\xe9\nf = x^2 - y; END;";
    let error = formats::read("test", text)
        .expect_err("y is unknown")
        .to_string();
    assert!(error.starts_with("test:3:11: "), "{error}");
    let outside = b"variable_group x; function f; f = x^2 - \xe9; END;";
    let error = formats::read("test", outside)
        .expect_err("no UTF-8")
        .to_string();
    assert!(
        error.starts_with("test:1:41: expected text in UTF-8, found the byte 0xe9"),
        "{error}"
    );
}

#[test]
fn quotients_are_multiplied_out() {
    let problem = read("variable_group x, y; function f; f = y + x/(1 + y) - (x + 1)^-1; END;");
    assert_eq!(
        values(&problem, &[(3, 1), (1, 1)], &[]),
        [rational(8 + 12 - 2, 1)]
    );
    let warning = problem.warnings[0].to_string();
    assert!(warning.contains("where a sum is 0"), "{warning}");
    assert!(problem.system.degenerate.contains_key("a denominator is 0"));
}

/// Report 003: the last `END;` was deleted by accident.
#[test]
fn the_end_of_the_file_ends_the_input() {
    let text = "CONFIG\nMPType: 2;\nEND;\nINPUT\nvariable_group x, y;\nfunction f;\nf = x^2 - y;\n";
    let problem = read(text);
    assert_eq!(problem.system, read(&format!("{text}END;\n")).system);
    let warnings: Vec<String> = problem.warnings.iter().map(ToString::to_string).collect();
    let expected = "test:8: the `END;` of the input is missing: it ends with the file";
    assert_eq!(warnings, [expected]);
}
