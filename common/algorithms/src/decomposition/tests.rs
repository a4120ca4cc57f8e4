//! Decompositions of small systems: all methods, paths that are lost or spoilt, and states that are read back.

use super::*;
use crate::restarts;
use crate::run_locally::drive;
use crate::{AnyAlgorithm, AnySolve, PathAlgorithm};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::{Coordinates, PathResult};
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_solutions::completeness::Completeness;
use cognate_systems::formats;
use std::collections::HashMap;

/// Decomposes with a tracker that spoils the results of stages.
fn decompose(
    text: &str,
    (method, seed): (Method, u64),
    spoil: impl Fn(&HomotopyKind, &mut PathResult),
) -> Decomposition {
    let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
    let system = formats::read("test", text.as_bytes()).unwrap().system;
    let options = DecompositionOptions {
        // Without repetitions, a spoilt path stays spoilt.
        max_retries: 0,
        method: Some(method),
        seed,
        ..DecompositionOptions::default()
    };
    let mut root = Root::new(DecompositionSolve::new(&system, &options).unwrap());
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    let done: Result<(), PrepareError> = drive(&mut root, &mut |opening| {
        let made = opening.objects.iter();
        objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
        let find = |digest: Digest| objects.get(&digest).cloned();
        let system = opening.system.as_deref().unwrap_or(&system);
        let prepared = PreparedWork::new(system, &opening.stage, &find)?;
        let mut results = prepared.run(0..prepared.items(), 8);
        for result in &mut results {
            if let ItemResult::Track(path) = result {
                spoil(&opening.stage.homotopy, path);
            }
        }
        Ok(results)
    });
    assert_eq!(done, Ok(()));
    root.solve.decomposition().unwrap().clone()
}

/// A parabola and a circle.
const CURVES: &str = "variable_group x, y; function f; f = (y - x^2)*(x^2 + y^2 - 3);";

#[test]
fn two_curves_are_told_apart() {
    for method in Method::ALL {
        let decomposition = decompose(CURVES, (method, 0), |_, _| {});
        let degrees: Vec<u64> = decomposition
            .components
            .iter()
            .map(|set| set.degree)
            .collect();
        assert_eq!(degrees, [2, 2]);
        assert!(
            decomposition.settled() && decomposition.adds_up(),
            "{decomposition:?}"
        );
        for set in &decomposition.components {
            for point in &set.points {
                let (x, y) = (point[0], point[1]);
                let value = (y - x * x) * (x * x + y * y - 3.0);
                assert!(value.norm_sqr() < 1e-24);
                let slice = &set.slice[0];
                let on_slice = slice[0] + slice[1] * x + slice[2] * y;
                assert!(on_slice.norm_sqr() < 1e-24);
            }
        }
    }
}

#[test]
fn components_of_a_dimension_share_their_slice() {
    let share = |decomposition: &Decomposition| {
        let [a, b] = decomposition.components.as_slice() else {
            panic!("two curves: {decomposition:?}");
        };
        Arc::ptr_eq(&a.slice, &b.slice)
    };
    let decomposition = decompose(CURVES, (Method::Cascade, 0), |_, _| {});
    assert!(share(&decomposition));
    // The components share a slice also after they were written and read.
    let read: Decomposition =
        postcard::from_bytes(&postcard::to_stdvec(&decomposition).unwrap()).unwrap();
    assert!(share(&read) && read == decomposition);
}

#[test]
fn a_lost_path_leaves_nothing_settled() {
    // Four paths end at the four witness points: the last of them is lost, however often it is tracked, and loops
    // do not come back.
    let lost = |homotopy: &HomotopyKind, path: &mut PathResult| {
        if path.origin.0 == 3 || is_loop(homotopy) {
            path.outcome = PathOutcome::Failed(Failure::TooManySteps);
        }
    };
    let decomposition = decompose(CURVES, (Method::Cascade, 0), lost);
    assert!(!decomposition.settled());
    let [dimension] = decomposition.dimensions.as_slice() else {
        panic!("one equation in two unknowns has curves: {decomposition:?}");
    };
    assert_eq!(dimension.complete, Completeness::No);
    assert!(dimension.doubts.contains(&Doubt::PointsMissing));
    // A component with all its points is still a component.
    assert!(
        decomposition.components.iter().any(|set| set.settled()),
        "{decomposition:?}"
    );
}

#[test]
fn a_path_lost_on_the_way_leaves_nothing_settled() {
    // Each curve is cut by itself: its second path is lost.
    let lost = |homotopy: &HomotopyKind, path: &mut PathResult| {
        if path.origin.0 == 1 && !is_loop(homotopy) {
            path.outcome = PathOutcome::Failed(Failure::TooManySteps);
        }
    };
    let decomposition = decompose(CURVES, (Method::Equations, 0), lost);
    assert!(!decomposition.settled());
    assert_eq!(decomposition.dimensions[0].failed, 2, "{decomposition:?}");
}

fn is_loop(homotopy: &HomotopyKind) -> bool {
    matches!(homotopy, HomotopyKind::Parameter { .. })
}

/// Whichever paths are lost, loops find the points that belong to others, and nothing that is settled is wrong.
#[test]
fn lost_points_are_found_by_loops() {
    let (mut found_all, mut settled) = (0, 0);
    for seed in 0..4 {
        for lost in 1..15u64 {
            let spoil = |homotopy: &HomotopyKind, path: &mut PathResult| {
                if lost >> path.origin.0 & 1 == 1 && !is_loop(homotopy) {
                    path.outcome = PathOutcome::Failed(Failure::TooManySteps);
                }
            };
            for method in [Method::Slices, Method::Cascade] {
                let decomposition = decompose(CURVES, (method, seed), spoil);
                let what = format!("{method:?}, seed {seed}, lost {lost:b}: {decomposition:?}");
                let degrees: Vec<u64> = decomposition.components.iter().map(|s| s.degree).collect();
                let dimension = &decomposition.dimensions[0];
                assert!(
                    decomposition.adds_up() || !decomposition.settled(),
                    "{what}"
                );
                assert!(dimension.found_by_loops <= dimension.failed, "{what}");
                let whole =
                    degrees == [2, 2] && decomposition.components.iter().all(WitnessSet::settled);
                found_all += u64::from(whole);
                settled += u64::from(decomposition.settled());
                // Paths that were lost on other slices may have led to more points than one.
                let accounted = method == Method::Slices && whole;
                assert_eq!(decomposition.settled(), accounted, "{what}");
            }
        }
    }
    // Of 14 losses six take all points of a curve, which nothing leads to; the others are made good. In a cascade more
    // is lost.
    assert!(found_all >= 48 && settled == 32, "{found_all}, {settled}");
}

#[test]
fn a_second_way_is_compared() {
    let text =
        "variable_group x, y, z; function f, g; f = (z - x*y)*(x - 2); g = (y - x^2)*(x - 2);";
    let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
    let system = formats::read("test", text.as_bytes()).unwrap().system;
    for method in [None, Some(Method::Cascade), Some(Method::Slices)] {
        let options = DecompositionOptions {
            method,
            verify: true,
            ..DecompositionOptions::default()
        };
        let solve = DecompositionSolve::new(&system, &options).unwrap();
        let mut decomposition = run_locally(solve, 8).unwrap();
        let second = decomposition.verification.clone().unwrap();
        assert!(second.agrees && second.settled && decomposition.settled());
        assert_ne!(second.method, decomposition.method);
        assert_eq!(decomposition.components.len(), 2);
        // A component that only one method finds is a difference.
        let mut other = decomposition.clone();
        other.components.pop();
        decomposition.verify(&other);
        assert!(!decomposition.settled());
    }
}

#[test]
fn a_point_that_is_no_solution_is_not_taken() {
    // The first path's end is moved away.
    let moved = |_: &HomotopyKind, path: &mut PathResult| {
        if path.origin.0 == 0 {
            let Coordinates::Double(end) = &mut path.endpoint;
            end[1] += 0.3;
        }
    };
    for method in [Method::Cascade, Method::Slices] {
        let decomposition = decompose(CURVES, (method, 0), moved);
        assert!(!decomposition.settled(), "{decomposition:?}");
    }
}

/// Decomposes with a state that is written down and read back after each stage is open; which kinds of work were
/// done is given back, too.
fn with_restarts(system: &System, options: &DecompositionOptions) -> (Decomposition, String) {
    let solve = DecompositionSolve::new(system, options).unwrap();
    let solve = AnySolve::Decomposition(Box::new(solve));
    let mut kinds = String::new();
    let solve = restarts::with_restarts(solve, system, &mut |opening| {
        let stage = &opening.stage;
        kinds.push_str(&format!("{:?} {:?}; ", stage.work, stage.homotopy));
    });
    assert!(AnyAlgorithm::restore(&solve.snapshot()).unwrap() == solve);
    let counted = postcard::to_stdvec(&solve.counted_snapshot()).unwrap();
    assert_eq!(counted, postcard::to_stdvec(&solve.snapshot()).unwrap());
    let Some(Answer::Decomposition(decomposition)) = solve.answer(system) else {
        panic!("a decomposition ends with one");
    };
    (Arc::unwrap_or_clone(decomposition), kinds)
}

#[test]
fn a_state_that_was_read_back_goes_on_as_the_one_that_lived() {
    let curves = "variable_group x, y, z; function f, g; \
                  f = (x - y)^2*(y - x^2 + 2); g = (z - x*y)*(x + y + z - 5);";
    let text = format!("CONFIG\nEND;\nINPUT\n{curves}\nEND;\n");
    let curves = formats::read("test", text.as_bytes()).unwrap().system;
    let points = cognate_systems::named::cyclic(5).system;
    let mut done = String::new();
    for (system, methods) in [
        (&curves, Method::ALL.as_slice()),
        (&points, &[Method::Slices]),
    ] {
        for &method in methods {
            let options = DecompositionOptions {
                method: Some(method),
                certify: true,
                ..DecompositionOptions::default()
            };
            let solve = DecompositionSolve::new(system, &options).unwrap();
            let lived = run_locally(solve, 8).unwrap();
            let (restarted, kinds) = with_restarts(system, &options);
            assert_eq!(restarted, lived, "{method:?}");
            done.push_str(&kinds);
        }
    }
    // Every kind of stage was among them.
    let kinds = [
        "Track StraightLine",
        "Track Toric",
        "Track Generic",
        "Track MoveSlice",
        "Track ProductToEquation",
        "Track Parameter",
        "LocalDimension",
        "Bend",
        "Certify",
    ];
    for kind in kinds {
        assert!(done.contains(kind), "{kind}");
    }
}

/// Equations of a damaged state lie beyond its expressions: it is refused.
#[test]
fn a_state_whose_equations_have_no_expressions_is_refused() {
    let system = formats::read("test", b"x*y = 0\nx*z = 0")
        .expect("equations")
        .system;
    let solve =
        DecompositionSolve::new(&system, &DecompositionOptions::default()).expect("a solve");
    let mut state = solve.state.clone();
    Arc::make_mut(&mut state.system).expressions = Default::default();
    let refused = DecompositionSolve::try_from(state);
    assert!(
        matches!(refused, Err(ProblemError::System(_))),
        "{refused:?}"
    );
}
