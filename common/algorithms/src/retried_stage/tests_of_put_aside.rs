//! Paths that are put aside, and followed where an exact count says that solutions are missing.

use crate::plan::SolveMethod;
use crate::run_locally::drive;
use crate::synthetic::declared;
use crate::{PathAlgorithm, SolveOptions, plan};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::work::{Stage, Work};
use cognate_numeric::precision::DOUBLE;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution_set::SolutionSet;

/// Solves by total degree; `fault` may change what the tracker found.
fn solve(text: &str, fault: impl Fn(&Stage, &mut PathResult)) -> (Vec<Stage>, SolutionSet) {
    let options = SolveOptions {
        method: SolveMethod::TotalDegree,
        seed: 3,
        ..SolveOptions::default()
    };
    let mut plan = plan(&declared(text), &options).expect("a plan");
    let mut stages = Vec::new();
    let system = plan.system.clone();
    let done: Result<(), PrepareError> = drive(&mut plan.algorithm, &mut |opening| {
        let objects = opening.objects.clone();
        let find = |digest| objects.iter().find(|o| o.digest() == digest).cloned();
        let prepared = PreparedWork::new(&system, &opening.stage, &find)?;
        let mut results = prepared.run(0..prepared.items(), 8);
        for result in &mut results {
            if let ItemResult::Track(path) = result {
                fault(&opening.stage, path);
            }
        }
        stages.push(opening.stage.clone());
        Ok(results)
    });
    done.expect("stages that can be prepared");
    let set = plan.algorithm.solution_sets(&system).remove(0);
    assert_eq!(set.paths.sum(), set.paths.total);
    (stages, set)
}

/// A hyperbola and a parabola meet in three points, and at infinity.
const THREE_OF_FOUR: &str = "variable_group x, y; function f, g; f = x*y - 1; g = x^2 + y - 3;";

/// Two parabolas of one axis: they meet in two points, and touch at infinity.
const TWO_OF_FOUR: &str = "variable_group x, y; function f, g; f = y - x^2; g = y + x^2 + x - 2;";

#[test]
fn where_all_solutions_are_found_no_endgame_is_needed() {
    let (stages, set) = solve(TWO_OF_FOUR, |_, _| {});
    assert_eq!(stages.len(), 1);
    assert!(stages[0].settings.max_endgame_bits == 0);
    let paths = &set.paths;
    assert_eq!((paths.total, paths.finite, paths.at_infinity), (4, 2, 2));
    assert_eq!((paths.decided_by_exact_count, paths.retracked), (2, 0));
    assert!(set.settled());
    assert_eq!(set.counts.complete, Completeness::Yes);
}

#[test]
fn a_solution_whose_path_is_put_aside_is_found() {
    let lost = |stage: &Stage, path: &mut PathResult| {
        if stage.settings.max_endgame_bits == 0 && path.outcome == PathOutcome::Regular {
            path.outcome = PathOutcome::PutAside;
        }
    };
    let (stages, set) = solve(THREE_OF_FOUR, lost);
    assert_eq!(stages.len(), 2);
    let followed = &stages[1];
    assert_eq!((followed.attempt, followed.items()), (0, Some(4)));
    assert!(followed.settings.max_endgame_bits == DOUBLE);
    let paths = &set.paths;
    assert_eq!((paths.finite, paths.at_infinity), (3, 1));
    assert_eq!(paths.retracked, 0);
    assert!(set.settled());
}

#[test]
fn multiple_solutions_and_sets_have_their_endgames() {
    let double = "variable_group x, y; function f, g; f = x*y - 1; g = x^2*y^2 - 2*x + y;";
    let touching = "variable_group x, y; function f, g; f = y - x^2; g = y*(y - 2*x + 1);";
    let line = "variable_group x, y; function f, g; f = x*(y - 1); g = x*(x + y - 4);";
    for (text, work, finite, singular, on_sets) in [
        (double, 2, 2, 0, 0),
        (touching, 3, 0, 4, 0),
        (line, 3, 1, 0, 3),
    ] {
        let (stages, set) = solve(text, |_, _| {});
        let tracked = stages.iter().filter(|stage| stage.work == Work::Track);
        assert!(tracked.count() <= 2 && stages.len() <= work, "{text}");
        let paths = &set.paths;
        assert_eq!((paths.finite, paths.singular), (finite, singular), "{text}");
        assert_eq!(paths.positive_dimensional, Some(on_sets), "{text}");
        assert!(set.settled(), "{text}: {:?}", set.warnings);
    }
}

/// Where every solution has a path of its own, a path that failed is none of theirs, and is not tracked again.
#[test]
fn what_failed_is_not_repeated_where_all_solutions_are_found() {
    let (stages, set) = solve(TWO_OF_FOUR, |_, path| {
        if path.outcome == PathOutcome::PutAside {
            path.outcome = PathOutcome::Failed(Failure::TooManySteps);
        }
    });
    assert_eq!(stages.len(), 1);
    let paths = &set.paths;
    assert_eq!((paths.finite, paths.at_infinity, paths.failed), (2, 2, 0));
    assert_eq!((paths.decided_by_exact_count, paths.retracked), (2, 0));
    assert!(set.settled(), "{:?}", set.warnings);
}

/// A solution whose path fails at first is missing: what waits has its endgames before that path is repeated, and then
/// it is found.
#[test]
fn a_solution_whose_path_fails_is_found() {
    let (stages, set) = solve(TWO_OF_FOUR, |stage, path| {
        if stage.settings.max_endgame_bits == 0 && path.outcome == PathOutcome::Regular {
            path.outcome = PathOutcome::Failed(Failure::TooManySteps);
        }
    });
    let attempts: Vec<u16> = stages.iter().map(|stage| stage.attempt).collect();
    assert_eq!(attempts, [0, 0, 1]);
    assert_eq!(stages[1].items(), Some(2));
    let paths = &set.paths;
    assert_eq!(
        (paths.finite, paths.at_infinity, paths.retracked),
        (2, 2, 2)
    );
    assert!(set.settled(), "{:?}", set.warnings);
}

/// Two solutions at generic coefficients, and one at these: the other path from mixed cells waits.
#[test]
fn paths_from_mixed_cells_wait_too() {
    let text = "variable_group x, y; function f, g; f = x*y + x + y - 5; g = x*y + 2*x + y - 6;";
    let mut stages = Vec::new();
    let options = SolveOptions {
        method: SolveMethod::Polyhedral,
        seed: 3,
        ..SolveOptions::default()
    };
    let mut plan = plan(&declared(text), &options).expect("a plan");
    let system = plan.system.clone();
    let done: Result<(), PrepareError> = drive(&mut plan.algorithm, &mut |opening| {
        let objects = opening.objects.clone();
        let find = |digest| objects.iter().find(|o| o.digest() == digest).cloned();
        let prepared = PreparedWork::new(&system, &opening.stage, &find)?;
        stages.push(opening.stage.settings.max_endgame_bits);
        Ok(prepared.run(0..prepared.items(), 8))
    });
    done.expect("stages that can be prepared");
    let set = plan.algorithm.solution_sets(&system).remove(0);
    assert_eq!(stages, [u32::MAX, 0]);
    let paths = &set.paths;
    assert_eq!((paths.total, paths.finite, paths.at_infinity), (2, 1, 1));
    assert_eq!(paths.decided_by_exact_count, 1);
    assert!(set.settled(), "{:?}", set.warnings);
}

/// One solution twice is not as many as two.
#[test]
fn paths_that_meet_do_not_make_up_for_one_that_is_put_aside() {
    let ends = std::cell::RefCell::new(Vec::new());
    let (stages, set) = solve(THREE_OF_FOUR, |stage, path| {
        if stage.settings.max_endgame_bits == 0 && path.outcome == PathOutcome::Regular {
            let mut ends = ends.borrow_mut();
            ends.push(path.endpoint.clone());
            path.endpoint = ends[ends.len().saturating_sub(2)].clone();
        }
    });
    assert!(stages.len() > 1);
    assert_eq!((set.paths.finite, set.paths.at_infinity), (3, 1));
    assert!(set.paths.crossings_found > 0 && set.settled());
}
