//! Equations of all configurations of a mechanism: the position of the file solves them, exactly, and numbers stay exact.

use cognate_kinematics::compile::motion::{DegreeIn, Motion, Placed, TracedPoint, motion};
use cognate_kinematics::mechanism::exact::Number;
use cognate_kinematics::mechanism::{ReadOptions, read};
use cognate_systems::evaluation;
use num_complex::Complex64;

const SARRUS: &str = r#"{"name": "sarrus", "space": "spatial",
    "links": ["ground", "p1", "p2", "platform", "r2", "r1"], "joints": [
    {"name": "a1", "type": "R", "links": ["ground", "p1"], "point": [0, "4/5", 0], "axis": [1, 0, 0]},
    {"name": "a2", "type": "R", "links": ["p1", "p2"], "point": [0, "17/10", "3/5"], "axis": [1, 0, 0]},
    {"name": "a3", "type": "R", "links": ["p2", "platform"], "point": [0, "7/5", "3/2"], "axis": [1, 0, 0]},
    {"name": "b3", "type": "R", "links": ["platform", "r2"], "point": ["13/10", 0, "8/5"], "axis": [0, 1, 0]},
    {"name": "b2", "type": "R", "links": ["r2", "r1"], "point": ["11/5", 0, "7/10"], "axis": [0, 1, 0]},
    {"name": "b1", "type": "R", "links": ["r1", "ground"], "point": ["11/10", 0, "1/10"], "axis": [0, 1, 0]}]}"#;

const SKEW: &str = r#"{"name": "skew", "space": "spatial", "links": ["ground", "a", "b", "c"], "joints": [
    {"name": "q1", "type": "R", "links": ["ground", "a"], "point": [0, 1, "sqrt(2)"], "axis": [1, 1, 0]},
    {"name": "q2", "type": "P", "links": ["b", "a"], "point": [1, 1, 0], "axis": [1, 2, 2]},
    {"name": "q3", "type": "C", "links": ["b", "c"], "point": [1, 0, 3], "axis": ["sqrt(2)", 0, 1]},
    {"name": "q4", "type": "R", "links": ["c", "ground"], "point": [2, 0, 3], "axis": ["3/5", 0, "4/5"]}]}"#;

const SLIDER: &str = r#"{"name": "slider", "space": "planar", "links": ["ground", "crank", "rod", "slider"],
    "joints": [
    {"name": "O", "type": "R", "links": ["ground", "crank"], "point": [0, 0]},
    {"name": "A", "type": "R", "links": ["crank", "rod"], "point": ["1/2", "sqrt(3)/2"]},
    {"name": "B", "type": "R", "links": ["rod", "slider"], "point": [2, "1/3"]},
    {"name": "s", "type": "P", "links": ["slider", "ground"], "point": [2, "1/3"], "direction": [1, 2]}]}"#;

const BENNETT: &str = r#"{"name": "bennett", "space": "spatial", "angles": "rad", "loop": {"convention": "standard",
    "joints": [{"name": "q1", "type": "R", "d": 0, "a": 1.56, "alpha": 0.6435011087932844},
    {"name": "q2", "type": "R", "d": 0, "a": 1, "alpha": 0.3947911196997615},
    {"name": "q3", "type": "R", "d": 0, "a": 1.56, "alpha": 0.6435011087932844},
    {"name": "q4", "type": "R", "d": 0, "a": 1, "alpha": 0.3947911196997615}]}}"#;

fn motion_of(text: &str, traced: Option<&TracedPoint>) -> Motion {
    let mechanism = read("m.json", text.as_bytes(), &ReadOptions::default());
    let mechanism = mechanism.unwrap_or_else(|e| panic!("{e}"));
    motion(&mechanism, traced).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn home_solves_the_equations_and_no_joint_is_turned_there() {
    for (text, degree_in) in [
        (SARRUS, DegreeIn::Joints),
        (SKEW, DegreeIn::Joints),
        (SLIDER, DegreeIn::Links),
    ] {
        let motion = motion_of(text, None);
        assert_eq!(motion.degree_in, degree_in);
        assert!(motion.warnings.is_empty(), "{:?}", motion.warnings);
        let system = motion.equations.system("m.json").expect("a system");
        let home = motion.home.clone().expect("a home");
        let home: Vec<Complex64> = home.into_iter().map(Complex64::from).collect();
        assert_eq!(system.variables.len(), home.len());
        let residuals = evaluation::values(&system.expressions, &system.equations, &home, &[]);
        for residual in residuals {
            assert!(residual.norm_sqr() < 1e-28, "{text}: {residual}");
        }
        let Some(Placed::Joints(values)) = motion.placed(&home) else {
            panic!("{text}: no configuration");
        };
        assert!(values.iter().all(|(_, value)| value.real().abs() < 1e-14));
    }
}

#[test]
fn points_of_links_are_where_the_file_has_them_at_home() {
    let point = ["3/2", "1/4", "5"].map(|x| Number::read(x).expect("a number"));
    for (text, link, plane) in [
        (SARRUS, "p2", false),
        (SKEW, "b", false),
        (SLIDER, "rod", true),
    ] {
        let traced = TracedPoint {
            link: link.into(),
            point: point.clone(),
        };
        let motion = motion_of(text, Some(&traced));
        let path = motion.path.clone().expect("a path");
        let mut equations = motion.equations.clone();
        // An expression without an unknown would not count as an equation.
        let first = equations.variables()[0].clone();
        let coordinates = path.coordinates.iter();
        equations.equations = coordinates.map(|x| format!("{x}+7*{first}")).collect();
        let system = equations.system("m.json").expect("a system");
        let home = motion.home.clone().expect("a home");
        let home: Vec<Complex64> = home.into_iter().map(Complex64::from).collect();
        let values = evaluation::values(&system.expressions, &system.equations, &home, &[]);
        let expected = match plane {
            true => vec![Complex64::new(1.5, 0.25), Complex64::new(1.5, -0.25)],
            false => [1.5, 0.25, 5.0].map(Complex64::from).to_vec(),
        };
        for (value, expected) in values.iter().zip(&expected) {
            let value = value - 7.0 * home[0];
            assert!((value - expected).norm_sqr() < 1e-28, "{text}: {values:?}");
        }
    }
}

#[test]
fn short_numbers_of_chains_are_exact_again() {
    let motion = motion_of(BENNETT, None);
    assert!(motion.warnings.is_empty());
    let text = motion.equations.json();
    assert!(text.contains("39/25") && text.contains("12/13") && text.contains("4/5"));
    let odd = BENNETT.replace("1.56", "1.5612345678901");
    assert_eq!(motion_of(&odd, None).warnings.len(), 1);
}

#[test]
fn a_link_that_is_not_there_is_named() {
    let mechanism = read("m.json", SLIDER.as_bytes(), &ReadOptions::default());
    let traced = TracedPoint {
        link: "lever".into(),
        point: [0, 0, 0].map(Number::integer),
    };
    let refused = motion(&mechanism.expect("a mechanism"), Some(&traced));
    let message = refused.err().expect("an error").to_string();
    assert!(message.contains("lever") && message.contains("crank, rod, slider"));
}
