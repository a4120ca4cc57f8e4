//! Components of some equations that others cut: the answer is that of all equations together.

use super::*;
use crate::restarts::with_restarts;
use crate::run_locally::drive;
use crate::{AnySolve, PathAlgorithm};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_systems::formats;
use std::collections::HashMap;

fn system(text: &str) -> System {
    let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
    formats::read("test", text.as_bytes()).unwrap().system
}

/// A system of equations that are separated by commas.
fn equations(variables: &str, list: &[&str]) -> System {
    let list: Vec<&str> = list.iter().flat_map(|part| part.split(", ")).collect();
    let names: Vec<String> = (0..list.len()).map(|k| format!("f{k}")).collect();
    let pairs = names.iter().zip(&list);
    let lines: String = pairs.map(|(name, f)| format!("{name} = {f}; ")).collect();
    system(&format!(
        "{variables}; function {}; {lines}",
        names.join(", ")
    ))
}

fn options(seed: u64) -> DecompositionOptions {
    DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    }
}

fn decomposed(system: &System, options: &DecompositionOptions) -> Decomposition {
    run_locally(DecompositionSolve::new(system, options).unwrap(), 8).unwrap()
}

/// Options with the components of the first equations.
fn resuming(variables: &str, first: &str, seed: u64) -> DecompositionOptions {
    let system = equations(variables, &[first]);
    let decomposition = decomposed(&system, &options(seed));
    assert!(decomposition.settled(), "{first}: {decomposition:#?}");
    DecompositionOptions {
        known: Some(KnownComponents {
            equations: system.equations.len() as u32,
            components: decomposition.components,
            parameters: Vec::new(),
        }),
        ..options(seed)
    }
}

/// Dimension, degree and multiplicity of each component.
fn listed(decomposition: &Decomposition) -> Vec<(u32, u64, Option<u64>)> {
    let each = decomposition.components.iter();
    each.map(|set| (set.dimension(), set.degree, set.multiplicity.scheme))
        .collect()
}

/// Equations, further ones, and the components of all of them.
type Case<'a> = (&'a str, &'a str, &'a str, &'a [(u32, u64, Option<u64>)]);

const PLANE: &str = "variable_group x, y";
const SPACE: &str = "variable_group x, y, z";

const CASES: [Case; 23] = [
    (
        SPACE,
        "x^2 + y^2 + z^2 - 1",
        "x + 2*y - z",
        &[(1, 2, Some(1))],
    ),
    // A tangent plane.
    (
        SPACE,
        "x^2 + y^2 + z^2 - 1",
        "z - 1",
        &[(1, 1, Some(1)), (1, 1, Some(1))],
    ),
    // Of the components some lie in the hypersurface, and what is cut out of others lies in these.
    (
        SPACE,
        "x*y*(x^2 + y^2 + z^2 - 1)",
        "x*(z - 2*y)",
        &[(2, 1, Some(1)), (1, 2, Some(1)), (1, 1, Some(1))],
    ),
    // Cubic, three lines, sphere and a point, from the first of three equations (Bertini's nid example).
    (
        SPACE,
        "(y - x^2)*(x^2 + y^2 + z^2 - 1)*(x - 1/2)",
        "(z - x^3)*(x^2 + y^2 + z^2 - 1)*(y - 1/2), (y - x^2)*(z - x^3)*(x^2 + y^2 + z^2 - 1)*(z - 1/2)",
        &[
            (2, 2, Some(1)),
            (1, 3, Some(1)),
            (1, 1, Some(1)),
            (1, 1, Some(1)),
            (1, 1, Some(1)),
            (0, 1, Some(1)),
        ],
    ),
    // Nothing is cut: an equation of the same ideal, and one that is 0.
    (PLANE, "x*y", "x^2*y", &[(1, 1, Some(1)), (1, 1, Some(1))]),
    (
        PLANE,
        "x*y",
        "(x + y)^2 - x^2 - 2*x*y - y^2",
        &[(1, 1, Some(1)), (1, 1, Some(1))],
    ),
    // A double plane that is cut.
    (
        SPACE,
        "x^2*(y - 1)",
        "z - x",
        &[(1, 1, Some(2)), (1, 1, Some(1))],
    ),
    // A double plane that becomes single.
    (SPACE, "x^2*(y - 1)", "x", &[(2, 1, Some(1))]),
    // A double plane that lies in a hypersurface and stays double.
    (
        SPACE,
        "x^2*(y - 1)",
        "x^3*(z - 2)",
        &[(2, 1, Some(2)), (1, 1, Some(1))],
    ),
    // A curve is cut in points, of which one is double.
    (
        SPACE,
        "y - x^2, z - x*y",
        "(x - 1)*(y + z)",
        &[(0, 1, Some(2)), (0, 1, Some(1)), (0, 1, Some(1))],
    ),
    (SPACE, "x^2 + y^2 - 1, z", "z - 1", &[]),
    // A point stays, or leaves.
    (
        PLANE,
        "x*(x - 1), x*y",
        "y",
        &[(0, 1, Some(1)), (0, 1, Some(1))],
    ),
    (PLANE, "x*(x - 1), x*y", "y - 1", &[(0, 1, Some(1))]),
    // Lines of the projective plane.
    (
        "hom_variable_group x, y, z",
        "x*y",
        "x*z",
        &[(1, 1, Some(1)), (0, 1, Some(1))],
    ),
    // Rank one: the quadric, then two more minors.
    (
        "variable_group a, b, c, d, e, f",
        "a*e - b*d",
        "a*f - c*d, b*f - c*e",
        &[(4, 3, Some(1))],
    ),
    // Written out, so that nothing tells that it is a square: a conic, a curve of degree 10, none.
    (SPACE, "z^2", "x^2 + y^2 + z^2 - 1", &[(1, 2, Some(2))]),
    (
        SPACE,
        "x^2 - 2*x*y^2 + y^4",
        "z^5 - x*y - 1",
        &[(1, 10, Some(2))],
    ),
    (SPACE, "z^2", "z - 1", &[]),
    // A parabola with its first neighbourhood, cut by a plane; by its own plane.
    (
        SPACE,
        "(y - x^2)^2, (y - x^2)*(z - 1), (z - 1)^2",
        "y + z - 2",
        &[(0, 1, Some(3)), (0, 1, Some(3))],
    ),
    (
        SPACE,
        "(y - x^2)^2, (y - x^2)*(z - 1), (z - 1)^2",
        "z - 1",
        &[(1, 2, Some(2))],
    ),
    // A double plane and a sphere that leave the same circle, and two double lines.
    (
        SPACE,
        "(z^2 - 2*z + 1)*(x^2 + y^2 + z^2 - 2)",
        "z - 1",
        &[(2, 1, Some(1))],
    ),
    // Two equations after the multiple set, and one whose factors cut it apart.
    (
        SPACE,
        "x^2 - 2*x*y^2 + y^4",
        "z^2 - x - 1, y*z - 1",
        &[(0, 1, Some(2)); 4],
    ),
    (
        SPACE,
        "x^3 + 3*x^2 + 3*x + 1",
        "(y - z)^2*(y + z - 3)",
        &[(1, 1, Some(6)), (1, 1, Some(3))],
    ),
];

#[test]
fn the_answer_is_that_of_all_equations() {
    for (number, (variables, first, added, expected)) in CASES.into_iter().enumerate() {
        for seed in 1..=3 {
            let seed = seed + 100 * number as u64;
            let options = resuming(variables, first, seed);
            let whole = equations(variables, &[first, added]);
            let decomposition = decomposed(&whole, &options);
            assert_eq!(
                listed(&decomposition),
                expected,
                "{first}; {added}; {seed}: {decomposition:#?}"
            );
            assert!(
                decomposition.settled() && decomposition.adds_up(),
                "{first}; {added}; {seed}: {decomposition:#?}"
            );
        }
    }
}

#[test]
fn another_way_agrees() {
    for (variables, first, added, expected) in [CASES[2], CASES[3], CASES[9], CASES[16]] {
        let options = DecompositionOptions {
            verify: true,
            certify: true,
            ..resuming(variables, first, 7)
        };
        let decomposition = decomposed(&equations(variables, &[first, added]), &options);
        assert_eq!(listed(&decomposition), expected);
        let verified = decomposition
            .verification
            .as_ref()
            .expect("two ways were gone");
        assert!(
            verified.agrees && decomposition.settled(),
            "{decomposition:#?}"
        );
    }
}

/// Equation by equation, each time from what is there.
#[test]
fn one_equation_after_the_other() {
    let minors = ["a*e - b*d", "b*f - c*e", "c*g - d*f"];
    let variables = "variable_group a, b, c, d, e, f, g";
    let mut options = resuming(variables, minors[0], 3);
    for count in 2..=3 {
        let whole = equations(variables, &minors[..count]);
        let decomposition = decomposed(&whole, &options);
        assert!(decomposition.settled(), "{decomposition:#?}");
        assert_eq!(
            listed(&decomposition),
            listed(&decomposed(&whole, &self::options(40)))
        );
        options.known = Some(KnownComponents {
            equations: count as u32,
            components: decomposition.components,
            parameters: Vec::new(),
        });
    }
}

#[test]
fn a_state_that_was_read_back_goes_on() {
    // The second is a multiple set that is cut.
    for (variables, first, added, _) in [CASES[3], CASES[16]] {
        let options = resuming(variables, first, 5);
        let whole = equations(variables, &[first, added]);
        let lived = decomposed(&whole, &options);
        let solve = DecompositionSolve::new(&whole, &options).unwrap();
        let solve = with_restarts(
            AnySolve::Decomposition(Box::new(solve)),
            &whole,
            &mut |_| {},
        );
        let Some(Answer::Decomposition(restarted)) = solve.answer(&whole) else {
            panic!("a decomposition ends with one");
        };
        assert_eq!(*restarted, lived);
    }
}

/// A double plane with a surface that touches it: a line of multiplicity 4, or a multiplicity that is not known.
#[test]
fn a_multiplicity_that_is_not_known_is_said() {
    for seed in 1..=3 {
        let options = resuming(SPACE, "z^2", seed);
        let decomposition = decomposed(&equations(SPACE, &["z^2", "x^2 + z"]), &options);
        let [line] = decomposition.components.as_slice() else {
            panic!("one line, not {decomposition:#?}")
        };
        assert_eq!((line.dimension(), line.degree), (1, 1));
        match line.multiplicity.scheme {
            Some(multiplicity) => assert_eq!(multiplicity, 4),
            None => assert!(!decomposition.settled(), "{decomposition:#?}"),
        }
    }
}

#[test]
fn what_is_no_component_is_refused() {
    let (variables, first, added, _) = CASES[0];
    let good = resuming(variables, first, 5);
    let whole = equations(variables, &[first, added]);
    let refused = |spoil: &dyn Fn(&mut KnownComponents)| {
        let mut options = good.clone();
        spoil(options.known.as_mut().unwrap());
        let refused = DecompositionSolve::new(&whole, &options).map(|_| ());
        assert!(
            matches!(refused, Err(ProblemError::Known(_))),
            "{refused:?}"
        );
    };
    refused(&|known_components| known_components.equations = 0);
    refused(&|known_components| known_components.equations = 3);
    refused(&|known_components| known_components.components[0].points[0][1] += 1e-3);
    refused(&|known_components| {
        Arc::make_mut(&mut known_components.components[0].slice).truncate(1)
    });
    refused(&|known_components| known_components.components[0].points.truncate(1));
    refused(&|known_components| {
        known_components
            .components
            .push(known_components.components[0].clone())
    });
    // A sphere is not among the solutions of the second equation.
    refused(&|known_components| known_components.components[0].deflation = vec![0]);
}

/// A path that is lost between two slices, or where a multiple set is cut, is a doubt, where no other way follows.
#[test]
fn a_lost_witness_point_is_a_doubt() {
    // The second is a multiple set: its slice slides to five in the second stage, and is cut in the third.
    for (case, stage) in [(0, 1), (16, 1), (16, 2), (16, 3)] {
        lose_the_first_path(CASES[case], stage);
    }
}

/// Loses the first path of this stage, from 1.
fn lose_the_first_path((variables, first, added, _): Case, stage: usize) {
    let options = DecompositionOptions {
        max_retries: 0,
        method: Some(Method::Equations),
        ..resuming(variables, first, 5)
    };
    let whole = equations(variables, &[first, added]);
    let mut root = Root::new(DecompositionSolve::new(&whole, &options).unwrap());
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    let mut stages = 0;
    let done: Result<(), PrepareError> = drive(&mut root, &mut |opening| {
        let made = opening.objects.iter();
        objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
        let find = |digest: Digest| objects.get(&digest).cloned();
        let system = opening.system.as_deref().unwrap_or(&whole);
        let prepared = PreparedWork::new(system, &opening.stage, &find)?;
        let mut results = prepared.run(0..prepared.items(), 8);
        stages += 1;
        if let (true, Some(ItemResult::Track(path))) = (stages == stage, results.first_mut()) {
            path.outcome = PathOutcome::Failed(Failure::TooManySteps);
        }
        Ok(results)
    });
    assert_eq!(done, Ok(()));
    let decomposition = root.solve.decomposition().unwrap();
    assert!(!decomposition.settled(), "{decomposition:#?}");
    let lost = Doubt::FailedPaths { paths: 1 };
    assert!(
        decomposition
            .dimensions
            .iter()
            .any(|d| d.doubts.contains(&lost)),
        "{decomposition:#?}"
    );
}
