//! A stage with its repetitions, fed with made-up ends of paths.

use crate::any_algorithm::{AnyAlgorithm, AnySolve, RestoreError};
use crate::parameter_solve::ParameterSolve;
use crate::run_locally::drive;
use crate::synthetic::{SyntheticEnd, first_stage, system, track};
use crate::zero_dimensional_solve::ZeroDimensionalSolve;
use crate::{Next, PathAlgorithm};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::work::{Stage, Work};
use cognate_solutions::classification::Tolerances;
use cognate_solutions::solution_set::SolutionSet;
use num_complex::Complex64;
use std::convert::Infallible;

fn solve() -> AnyAlgorithm {
    let homotopy = HomotopyKind::StraightLine {
        parameters: vec![Complex64::new(1.0, 0.0)],
    };
    AnyAlgorithm::from(AnySolve::ZeroDimensional(ZeroDimensionalSolve::new(
        first_stage(homotopy),
        &system(),
        Tolerances::default(),
    )))
}

/// Runs it; returns the stages that it opened and what it found.
fn run(
    algorithm: &mut AnyAlgorithm,
    end_of: impl Fn(u64, u16) -> SyntheticEnd,
) -> (Vec<Stage>, Vec<SolutionSet>) {
    let mut stages = Vec::new();
    let done: Result<(), Infallible> = drive(algorithm, &mut |opening| {
        stages.push(opening.stage.clone());
        Ok(track(&opening.stage, &end_of))
    });
    assert_eq!(done, Ok(()));
    assert!(algorithm.progress().done);
    (stages, algorithm.solution_sets(&system()))
}

#[test]
fn clean_paths_are_tracked_once() {
    let (stages, sets) = run(&mut solve(), |path, _| SyntheticEnd::At(0.1 * path as f64));
    assert_eq!(stages.len(), 1);
    assert_eq!((sets[0].paths.total, sets[0].paths.finite), (4, 4));
    assert_eq!(sets[0].counts.real, Some(4));
    assert!(sets[0].settled());
}

#[test]
fn what_fails_or_crosses_is_tracked_again_with_the_same_gamma() {
    // Paths 0 and 2 meet once; path 3 fails twice.
    let (stages, sets) = run(&mut solve(), |path, attempt| match (path, attempt) {
        (2, 0) => SyntheticEnd::At(0.0),
        (3, 0 | 1) => SyntheticEnd::Fails,
        _ => SyntheticEnd::At(0.1 * path as f64),
    });
    let selected: Vec<_> = stages[1..]
        .iter()
        .map(|stage| match &stage.start_points {
            StartPoints::Selected { indices, .. } => indices.clone(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(selected, [vec![0, 2, 3], vec![3]]);
    for (k, stage) in stages.iter().enumerate() {
        assert_eq!((stage.id.0, usize::from(stage.attempt)), (k as u32, k));
        assert_eq!(stage.seed, stages[0].seed);
        assert_eq!(stage.settings, stages[0].settings.tightened(k as u16));
    }
    let paths = &sets[0].paths;
    assert_eq!((paths.finite, paths.failed, paths.retracked), (4, 0, 4));
    assert_eq!((paths.crossings_found, paths.crossings_resolved), (1, 1));
    assert!(sets[0].settled());
}

#[test]
fn a_turn_that_is_no_permutation_is_made_again() {
    // Paths 0 and 1 exchange places in a turn, but path 1 says that it needs three.
    let (stages, sets) = run(&mut solve(), |path, attempt| match (path, attempt) {
        (1, 0) => SyntheticEnd::Turns(0.5, 3),
        (0 | 1, _) => SyntheticEnd::Turns(0.5, 2),
        _ => SyntheticEnd::At(0.1 * path as f64),
    });
    let repeats = stages.iter().filter(|stage| stage.attempt == 1);
    let repeats: Vec<_> = repeats.map(|stage| stage.start_points.clone()).collect();
    let [StartPoints::Selected { indices, .. }] = repeats.as_slice() else {
        panic!("{repeats:?}");
    };
    assert_eq!(indices, &[0, 1]);
    let settings = &stages[1].settings;
    assert_eq!(settings, &stages[0].settings.tightened(1).robust());
    // Once more, since the made-up dual space has 3 functionals where 2 paths end.
    let paths = &sets[0].paths;
    assert_eq!((paths.finite, paths.singular, paths.retracked), (2, 2, 4));
    let singular = sets[0].solutions.iter().find(|s| s.singular).unwrap();
    assert_eq!(singular.cycles, [2]);
    // One that never fits is named.
    let (_, sets) = run(&mut solve(), |path, _| match path {
        0 => SyntheticEnd::Turns(0.5, 2),
        _ => SyntheticEnd::At(0.1 * path as f64),
    });
    let named = |warning: &String| warning.contains("winding numbers do not fit");
    assert!(sets[0].warnings.iter().any(named), "{:?}", sets[0].warnings);
}

#[test]
fn a_point_that_is_known_stays_where_another_is_asked_again() {
    // Three paths to one point, as many as it has functionals; one to another, which is tracked again.
    let mut algorithm = solve();
    let (stages, _) = run(&mut algorithm, |path, _| match path {
        3 => SyntheticEnd::Turns(0.9, 1),
        _ => SyntheticEnd::Turns(0.5, 3),
    });
    let work: Vec<(Work, Option<u64>)> = stages.iter().map(|s| (s.work, s.items())).collect();
    let (track, look) = (Work::Track, Work::LocalDimension);
    let expected = [(track, 4), (look, 2), (track, 1), (look, 1)];
    assert_eq!(work, expected.map(|(work, items)| (work, Some(items))));
    let AnySolve::ZeroDimensional(solve) = algorithm.solve() else {
        unreachable!("it was made so");
    };
    let singular = solve.paths().finite_endpoints().singular;
    let ends_at_half = singular.iter().filter(|end| end.values[0].re == 0.5);
    assert_eq!(ends_at_half.count(), 1, "{singular:?}");
}

#[test]
fn a_path_that_became_another_one_is_found_where_both_end() {
    // Four paths to one point; path 2 had jumped onto path 1 before.
    let end_of = |path: u64, attempt: u16| match (path, attempt) {
        (2, 0) => SyntheticEnd::Jumps(0.5, 0.1 + 1e-7),
        _ => SyntheticEnd::Jumps(0.5, 0.1 * path as f64),
    };
    let (stages, sets) = run(&mut solve(), end_of);
    let repeats = stages.iter().filter(|stage| stage.attempt == 1);
    let repeats: Vec<_> = repeats.map(|stage| stage.start_points.clone()).collect();
    let [StartPoints::Selected { indices, .. }] = repeats.as_slice() else {
        panic!("{repeats:?}");
    };
    assert_eq!(indices, &[1, 2]);
    // All four once more, since the made-up dual space has 3 functionals.
    let paths = &sets[0].paths;
    assert_eq!((paths.singular, paths.failed, paths.retracked), (4, 0, 6));
    assert_eq!((paths.crossings_found, paths.crossings_resolved), (1, 1));
    // One that stays there is named.
    let (_, sets) = run(&mut solve(), |path, _| end_of(path, 0));
    let paths = &sets[0].paths;
    assert_eq!((paths.singular, paths.failed, paths.total), (3, 1, 4));
    assert_eq!((paths.crossings_found, paths.crossings_resolved), (1, 0));
    assert_eq!(sets[0].failed[0].path, 2);
}

#[test]
fn what_does_not_come_apart_is_accounted_for() {
    let (stages, sets) = run(&mut solve(), |path, _| match path {
        1 => SyntheticEnd::At(0.0),
        2 => SyntheticEnd::Hopeless,
        3 => SyntheticEnd::Fails,
        _ => SyntheticEnd::At(0.1 * path as f64),
    });
    assert_eq!(stages.len(), 4);
    assert_eq!(
        stages[3].items(),
        Some(3),
        "the hopeless path is left alone"
    );
    let paths = &sets[0].paths;
    assert_eq!((paths.finite, paths.failed, paths.total), (1, 3, 4));
    assert_eq!((paths.crossings_found, paths.crossings_resolved), (1, 0));
    assert!(!sets[0].settled());
}

#[test]
fn every_target_has_its_own_set() {
    let one = |re: f64| vec![Complex64::new(re, 0.0)];
    let homotopy = HomotopyKind::Parameter {
        start: one(1.0),
        targets: vec![one(2.0), vec![Complex64::new(0.0, 1.0)], one(3.0)],
    };
    let mut algorithm = AnyAlgorithm::from(AnySolve::Parameter(ParameterSolve::new(
        first_stage(homotopy),
        &system(),
        Tolerances::default(),
    )));
    // Equal endpoints of different targets are no crossing; paths 8 and 9 are one.
    let (stages, sets) = run(&mut algorithm, |path, attempt| match (path, attempt) {
        (9, 0) => SyntheticEnd::At(0.0),
        _ => SyntheticEnd::At(0.1 * (path % 4) as f64),
    });
    assert_eq!(stages.len(), 2);
    assert_eq!(stages[1].items(), Some(2));
    assert_eq!(sets.len(), 3);
    assert!(
        sets.iter()
            .all(|set| set.paths.finite == 4 && set.settled())
    );
    let crossings: Vec<u64> = sets.iter().map(|s| s.paths.crossings_found).collect();
    assert_eq!(crossings, [0, 0, 1]);
    let real: Vec<Option<u64>> = sets.iter().map(|s| s.counts.real).collect();
    assert_eq!(real, [Some(4), None, Some(4)], "x^4 = i is not real");
    assert_eq!(sets[1].solutions[0].paths, [4]);
}

#[test]
fn a_restored_solve_goes_on_to_the_same_answer() {
    let end_of = |path: u64, attempt: u16| match (path, attempt) {
        (0, 0) | (1, 0..=2) => SyntheticEnd::Fails,
        _ => SyntheticEnd::At(0.1 * path as f64),
    };
    let (_, expected) = run(&mut solve(), end_of);
    // A new process before every step.
    let mut algorithm = solve();
    let mut open = Vec::new();
    loop {
        let bytes = algorithm.snapshot();
        let restored = AnyAlgorithm::restore(&bytes).unwrap();
        assert_eq!(restored, algorithm);
        algorithm = restored;
        match algorithm.next() {
            Next::Open(opening) => open.push(opening.stage),
            Next::Wait => {
                let stage = open.pop().unwrap();
                let results = track(&stage, end_of);
                algorithm.absorb(stage.id, &mut results.into_iter());
            }
            Next::Done => break,
        }
    }
    assert_eq!(algorithm.solution_sets(&system()), expected);
}

#[test]
fn damaged_snapshots_are_refused() {
    let bytes = solve().snapshot();
    assert!(matches!(
        AnyAlgorithm::restore(&bytes[..bytes.len() / 2]),
        Err(RestoreError::Damaged(_))
    ));
    assert!(AnyAlgorithm::restore(&[]).is_err());
    assert_eq!(
        AnyAlgorithm::restore(&[99]),
        Err(RestoreError::Version { found: 99 })
    );
}
