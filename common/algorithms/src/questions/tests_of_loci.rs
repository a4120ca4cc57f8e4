//! Intersections, singular loci and real points whose answers are known.

use super::tests::{components, system};
use super::*;
use cognate_solutions::witness::Decomposition;
use cognate_solutions::witness::answer::RealPoints as Found;
use cognate_solutions::witness::question::SecondSet;
use num_complex::Complex64;

/// Dimension and degree of each component, and whether all is settled.
type Listed = (Vec<(u32, u64)>, bool);

fn listed(decomposition: &Decomposition) -> Listed {
    let components = decomposition.components.iter();
    let list = components
        .map(|set| (set.dimension(), set.degree))
        .collect();
    (list, decomposition.settled() && decomposition.adds_up())
}

fn locus(system: &System, sets: &[WitnessSet], seed: u64, question: &Question) -> Decomposition {
    let options = DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    };
    let solve = QuestionSolve::new(system, &options, sets, question).unwrap();
    match run_locally(solve, 8).unwrap() {
        (Answer::Components(decomposition), _) => *decomposition,
        (other, _) => panic!("{other:?}"),
    }
}

fn singular(text: &str, seed: u64) -> Decomposition {
    let system = system(text);
    let decomposition = components(&system, seed);
    locus(
        &system,
        &decomposition.components,
        seed,
        &Question::SingularLocus,
    )
}

#[test]
fn singular_loci() {
    let cases: [(&str, &[(u32, u64)]); 9] = [
        // Whitney's umbrella: its handle is the z axis.
        (
            "variable_group x, y, z; function f; f = x^2 - y^2*z;",
            &[(1, 1)],
        ),
        // Cayley's cubic, with four nodes.
        (
            "variable_group x, y, z; function f; w = 1 - x - y - z; f = y*z*w + x*z*w + x*y*w + x*y*z;",
            &[(0, 1), (0, 1), (0, 1), (0, 1)],
        ),
        (
            "variable_group x, y; function f; f = y^2 - x^2*(x + 1);",
            &[(0, 1)],
        ),
        ("variable_group x, y; function f; f = y^2 - x^3;", &[(0, 1)]),
        (
            "variable_group x, y, z; function f; f = x^2 + y^2 + z^2 - 1;",
            &[],
        ),
        // The tangent surface of a twisted cubic is singular along the cubic.
        (
            "variable_group x, y, z; function f; \
             f = 3*x^2*y^2 - 4*x^3*z - 4*y^3 + 6*x*y*z - z^2;",
            &[(1, 3)],
        ),
        // Two planes meet in a line, in which each is smooth: the equation is singular there.
        (
            "variable_group x, y, z; function f; f = (x + y - 1)*(x - z + 2);",
            &[(1, 1)],
        ),
        // A multiple component is singular everywhere, and holds the points where it meets another.
        (
            "variable_group x, y, z; function f; f = z^2*(x + y - 1);",
            &[(2, 1)],
        ),
        (
            "variable_group x, y, z; function f, g; f = (y - x^2)^2; g = (z - 1)*(x^2 + z^2 - 5);",
            &[(1, 4), (1, 2)],
        ),
    ];
    for (number, (text, expected)) in cases.into_iter().enumerate() {
        for seed in 1..=2 {
            let decomposition = singular(text, seed + 10 * number as u64);
            assert_eq!(
                listed(&decomposition),
                (expected.to_vec(), true),
                "{text}, {seed}: {decomposition:#?}"
            );
        }
    }
}

#[test]
fn a_locus_is_a_set_that_can_be_asked() {
    let text = "variable_group x, y, z; function f; f = x^2 - y^2*z;";
    let decomposition = singular(text, 5);
    let system = system(text);
    for question in [Question::Check, Question::Project { onto: vec![2] }] {
        let solve = QuestionSolve::new(
            &system,
            &DecompositionOptions::default(),
            &decomposition.components,
            &question,
        );
        let (answer, doubts) = run_locally(solve.unwrap(), 8).unwrap();
        assert!(doubts.is_empty(), "{doubts:?}");
        if let Answer::Project(images) = answer {
            assert_eq!((images[0].dimension, images[0].degree), (Some(1), Some(1)));
        }
    }
    // A point that was moved off the handle is found.
    let mut wrong = decomposition.components.clone();
    wrong[0].points[0][0] += 1e-3;
    let refused = QuestionSolve::new(
        &system,
        &DecompositionOptions::default(),
        &wrong,
        &Question::Check,
    );
    assert!(matches!(
        refused,
        Err(QuestionError::Operand(OperandError::NotThere { .. }))
    ));
}

/// Common points of the components of the first equations and the solutions of the others, by the equations and by the
/// pairs of components.
fn both_ways(first: &str, second: &str, variables: &str, seed: u64) -> [Decomposition; 2] {
    let names = |prefix: &str, list: &str| -> Vec<String> {
        (0..list.split(", ").count())
            .map(|k| format!("{prefix}{k}"))
            .collect()
    };
    let written = |parts: &[(&str, &str)]| {
        let (mut function_names, mut lines) = (Vec::new(), String::new());
        for (prefix, list) in parts {
            let names_of_part = names(prefix, list);
            for (name, equation) in names_of_part.iter().zip(list.split(", ")) {
                lines.push_str(&format!("{name} = {equation}; "));
            }
            function_names.extend(names_of_part);
        }
        system(&format!(
            "variable_group {variables}; function {}; {lines}",
            function_names.join(", ")
        ))
    };
    let one = components(&written(&[("f", first)]), seed);
    let two = components(&written(&[("g", second)]), seed + 1);
    let whole = written(&[("f", first), ("g", second)]);
    let equation_count = first.split(", ").count() as u32;
    [Vec::new(), two.components].map(|components| {
        let second = SecondSet {
            own: equation_count,
            from: equation_count,
            components,
        };
        locus(
            &whole,
            &one.components,
            seed + 2,
            &Question::Intersect(second),
        )
    })
}

/// Equations of both sides, and dimension and degree of what they have in common.
type Case<'a> = (&'a str, &'a str, &'a [(u32, u64)]);

/// Both ways find what is expected of each case, the first with this seed, and settle it; `more` is asked of what is
/// found.
fn check_both_ways(cases: &[Case], seed: u64, more: impl Fn(&Decomposition, &str)) {
    for ((first, second, expected), seed) in cases.iter().zip(seed..) {
        let ways = both_ways(first, second, "x, y, z", seed);
        for (way, decomposition) in ways.into_iter().enumerate() {
            let text = format!("{first} and {second}, way {way}");
            assert_eq!(
                listed(&decomposition),
                (expected.to_vec(), true),
                "{text}: {decomposition:#?}"
            );
            more(&decomposition, &text);
        }
    }
}

#[test]
fn intersections_by_equations_and_by_pairs() {
    let cases: [Case; 6] = [
        // Twisted cubics of the types (1, 2) and (2, 1) on a quadric meet in five points (Hartshorne, V.1.9).
        (
            "y - x^2, z - x*y",
            "x*(y^2 + 3*y + 1) - 2*y^2 + y - 5, z - x*y",
            &[(0, 1); 5],
        ),
        // Twisted cubics of one type on a quadric meet in four points.
        (
            "y - x^2, z - x*y",
            "y*(x^2 + x - 3) - 4*x^2 + 1, z - x*y",
            &[(0, 1); 4],
        ),
        ("x^2 + y^2 + z^2 - 1", "x + 2*y - z", &[(1, 2)]),
        // A tangent plane: two lines.
        ("x^2 + y^2 + z^2 - 1", "z - 1", &[(1, 1), (1, 1)]),
        // A line that lies in the surface stays whole.
        ("x, y - 1", "x*z + y^2 - 1", &[(1, 1)]),
        ("x^2 + y^2 - 1, z", "x^2 + y^2 - 1, z - 1", &[]),
    ];
    check_both_ways(&cases, 3, |_, _| ());
}

/// Multiple components with others, by the equations and by the pairs of components: no multiplicity is said of what
/// is not regular.
#[test]
fn multiple_components_are_cut() {
    const FAT: &str = "(y - x^2)^2, (y - x^2)*(z - 1), (z - 1)^2";
    const CONICS: &str = "(x^2 + y^2 - z)^2*(x - 2*y + 1), (z - 1)*(x - 2*y + 1)*(z + x - 3)";
    let cases: [Case; 9] = [
        ("z^2", "x - 1, y - 2", &[(0, 1)]),
        ("z^2", "x^2 + y^2 + z^2 - 1", &[(1, 2)]),
        // A sphere that touches.
        ("z^2", "x^2 + y^2 + z^2 - 2*z", &[(1, 1), (1, 1)]),
        ("z^2", "z - 1", &[]),
        // The fat parabola and a line of its plane.
        (FAT, "z - 1, y - 4", &[(0, 1), (0, 1)]),
        // Two double conics and a plane, with a plane: two points of each conic; they have none in common here.
        (
            CONICS,
            "x + 3*y - z + 7",
            &[(1, 1), (0, 1), (0, 1), (0, 1), (0, 1)],
        ),
        // Two multiple sets with one another.
        (
            "z^2",
            "x^4 + 2*x^2*y^2 + y^4 - 2*x^2 - 2*y^2 + 1",
            &[(1, 2)],
        ),
        (FAT, "x^2 - 2*x + 1", &[(0, 1)]),
        // A double surface holds the other side.
        ("x^2 - 2*x*y^2 + y^4", "x - y^2, z - y", &[(1, 2)]),
    ];
    check_both_ways(&cases, 30, |decomposition, text| {
        for set in &decomposition.components {
            let scheme = set.deflation.is_empty().then_some(1);
            assert_eq!(set.multiplicity.scheme, scheme, "{text}");
        }
    });
}

#[test]
fn components_of_one_system_meet() {
    // A sphere and a plane that are one equation, and a line that is another component.
    let text = "variable_group x, y, z; function f, g; s = (x^2 + y^2 + z^2 - 1)*(x + y - 1); \
                f = s*(x - 2*y); g = s*(z - y);";
    let system = system(text);
    let decomposition = components(&system, 4);
    let components_with = |dimension: u32, degree: u64| -> Vec<WitnessSet> {
        let witness_sets = decomposition.components.iter();
        witness_sets
            .filter(|set| (set.dimension(), set.degree) == (dimension, degree))
            .cloned()
            .collect()
    };
    let meets = |a: &[WitnessSet], b: &[WitnessSet]| {
        let second = SecondSet {
            own: 2,
            from: 0,
            components: b.to_vec(),
        };
        listed(&locus(&system, a, 9, &Question::Intersect(second)))
    };
    let (sphere, plane, line) = (
        components_with(2, 2),
        components_with(2, 1),
        components_with(1, 1),
    );
    assert_eq!(meets(&sphere, &plane), (vec![(1, 2)], true));
    assert_eq!(meets(&sphere, &line), (vec![(0, 1), (0, 1)], true));
    assert_eq!(meets(&line, &plane), (vec![(0, 1)], true));
}

#[test]
fn what_the_equations_do_not_show_is_in_doubt() {
    // The axis x = 0 and y = 0 have the origin in common; the equations x*y and y have a line.
    let axes = system("variable_group x, y; function f; f = x*y;");
    let decomposition = components(&axes, 1);
    let vertical: Vec<WitnessSet> = decomposition
        .components
        .iter()
        .filter(|set| set.points[0][0].norm_sqr() < 1e-20)
        .cloned()
        .collect();
    let whole = system("variable_group x, y; function f, g; f = x*y; g = y;");
    let second = SecondSet {
        own: 1,
        from: 1,
        components: Vec::new(),
    };
    let cut = locus(&whole, &vertical, 3, &Question::Intersect(second));
    assert!(!cut.settled(), "{cut:#?}");
}

#[test]
fn second_sets_that_are_none_are_refused() {
    let system = system("variable_group x, y; function f, g; f = x*y; g = y;");
    for (component_equations, from) in [(0, 0), (3, 1), (1, 2), (2, 2)] {
        let second = SecondSet {
            own: component_equations,
            from,
            components: Vec::new(),
        };
        let question = Question::Intersect(second);
        let options = DecompositionOptions::default();
        let refused = QuestionSolve::new(&system, &options, &[], &question);
        assert!(
            matches!(
                refused,
                Err(QuestionError::Wish {
                    field: "intersect",
                    ..
                })
            ),
            "{component_equations} {from}"
        );
    }
}

fn real_points(text: &str, seed: u64) -> Vec<Found> {
    let system = system(text);
    let decomposition = components(&system, seed);
    let options = DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    };
    let question = Question::RealPoints;
    let solve =
        QuestionSolve::new(&system, &options, &decomposition.components, &question).unwrap();
    match run_locally(solve, 8).unwrap() {
        (Answer::RealPoints(real_points), _) => real_points,
        (other, _) => panic!("{other:?}"),
    }
}

/// A part of the real points.
type Part = fn(&[Complex64]) -> bool;

#[test]
fn real_points_are_on_every_part() {
    let plane = "variable_group x, y; function f; f = ";
    let space = "variable_group x, y, z; function f; f = ";
    let everywhere: Part = |_| true;
    let cases: [(&str, &str, &[Part]); 11] = [
        (plane, "x^2 + y^2 - 1", &[everywhere]),
        // An oval and an arc.
        (
            plane,
            "y^2 - x^3 + x",
            &[|p| p[0].re < 0.5, |p| p[0].re > 0.5],
        ),
        // An isolated point and an arc.
        (
            plane,
            "y^2 - x^2*(x - 1)",
            &[|p| p[0].norm_sqr() < 1e-8, |p| p[0].re > 0.9],
        ),
        // A cusp.
        (plane, "y^2 - x^3", &[everywhere]),
        (plane, "x^2 + y^2 + 1", &[]),
        (space, "x^2 + y^2 + z^2 - 1", &[everywhere]),
        (
            space,
            "z^2 - x^2 - y^2 - 1",
            &[|p| p[2].re > 0.5, |p| p[2].re < -0.5],
        ),
        (space, "x^2 + y^2 + z^2 + 3", &[]),
        // A torus with radii 2 and 1.
        (
            space,
            "(x^2 + y^2 + z^2 + 3)^2 - 16*(x^2 + y^2)",
            &[everywhere],
        ),
        // Whitney's umbrella and its handle, which leaves it.
        (
            space,
            "x^2 - y^2*z",
            &[|p| p[1].norm_sqr() < 1e-8, everywhere],
        ),
        // Two planes that only their line is real of.
        (
            space,
            "x^2 + 2*y^2",
            &[|p| p[0].norm_sqr() + p[1].norm_sqr() < 1e-12],
        ),
    ];
    for (number, (head, equation, parts)) in cases.into_iter().enumerate() {
        for seed in 1..=2 {
            let text = format!("{head}{equation};");
            let real_components = real_points(&text, seed + 100 * number as u64);
            let doubts: Vec<&String> = real_components.iter().flat_map(|c| &c.doubts).collect();
            assert!(doubts.is_empty(), "{equation}, {seed}: {doubts:?}");
            let points: Vec<_> = real_components.iter().flat_map(|c| &c.points).collect();
            assert_eq!(
                points.is_empty(),
                parts.is_empty(),
                "{equation}: {points:?}"
            );
            for (k, part) in parts.iter().enumerate() {
                let met = points.iter().any(|p| part(&p.point));
                assert!(met, "{equation}, {seed}: part {k} of {points:?}");
            }
            for point in points {
                assert!(point.point.iter().all(|z| z.im == 0.0), "{point:?}");
            }
        }
    }
}

#[test]
fn real_points_that_are_not_searched_are_named() {
    // The circle is double; its real points are not followed by the deflated equations.
    let real_components = real_points("variable_group x, y; function f; f = (x^2 + y^2 - 1)^2;", 3);
    assert!(
        real_components[0].doubts[0].contains("multiple"),
        "{real_components:?}"
    );
    // The tangent surface of a twisted cubic is singular along the cubic, whose real points have to be there.
    let tangents = "variable_group x, y, z; function f; \
                    f = 3*x^2*y^2 - 4*x^3*z - 4*y^3 + 6*x*y*z - z^2;";
    let real_components = real_points(tangents, 3);
    assert!(
        real_components[0].doubts[0].contains("dimension 1 and degree 3"),
        "{real_components:?}"
    );
}

/// Asks with a state that is written down and read back before each stage.
fn with_restarts(system: &System, solve: QuestionSolve) -> Answer {
    use crate::PathAlgorithm;
    let solve = crate::AnySolve::Question(Box::new(solve));
    let solve = crate::restarts::with_restarts(solve, system, &mut |_| {});
    match solve.answer(system) {
        Some(crate::Answer::Question(asked)) => asked.answer,
        Some(crate::Answer::Decomposition(decomposition)) => {
            Answer::Components(Box::new((*decomposition).clone()))
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_state_that_was_read_back_goes_on_as_the_one_that_lived() {
    let umbrella = system("variable_group x, y, z; function f; f = (x^2 - y^2*z)*(x + y - z + 1);");
    let decomposition = components(&umbrella, 6);
    let (surface, plane): (Vec<WitnessSet>, Vec<WitnessSet>) = decomposition
        .components
        .into_iter()
        .partition(|set| set.degree == 3);
    let pair = SecondSet {
        own: 1,
        from: 0,
        components: plane,
    };
    for question in [
        Question::SingularLocus,
        Question::RealPoints,
        Question::Intersect(pair),
    ] {
        let options = DecompositionOptions::default();
        let solve = QuestionSolve::new(&umbrella, &options, &surface, &question).unwrap();
        let (lived, _) = run_locally(solve.clone(), 8).unwrap();
        assert_eq!(with_restarts(&umbrella, solve), lived, "{question:?}");
    }
    // A double surface, cut by the equations.
    let double = system("variable_group x, y, z; function f; f = x^2 - 2*x*y^2 + y^4;");
    let decomposition = components(&double, 6);
    let whole =
        system("variable_group x, y, z; function f, g; f = x^2 - 2*x*y^2 + y^4; g = x*z - y - 1;");
    let question = Question::Intersect(SecondSet {
        own: 1,
        from: 1,
        components: Vec::new(),
    });
    let options = DecompositionOptions::default();
    let solve = QuestionSolve::new(&whole, &options, &decomposition.components, &question).unwrap();
    let (lived, _) = run_locally(solve.clone(), 8).unwrap();
    assert_eq!(with_restarts(&whole, solve), lived);
}
