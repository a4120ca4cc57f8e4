//! Any algorithm from beginning to end in one thread: for examples, tests and tools.

use crate::{Next, PathAlgorithm};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::stage::{PrepareError, PreparedStage};
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::Stage;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use std::sync::Arc;

/// Solves with lanes of this width; one solution set for each target.
///
/// `system` is the plan's, not the one that was planned for. `objects` finds
/// stored start points.
///
/// ```
/// use cognate_algorithms::{PlanOptions, plan, run_locally::run_locally};
///
/// let text = b"CONFIG\nEND;\nINPUT\nvariable_group x; function f; f = x^2 - 2;\nEND;\n";
/// let system = cognate_systems::formats::read("example", text)?.system;
/// let mut plan = plan(&system, &PlanOptions::default())?;
/// let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 1)?;
/// assert_eq!((sets[0].paths.total, sets[0].counts.real), (2, Some(2)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_locally(
    system: &System,
    algorithm: &mut dyn PathAlgorithm,
    objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    width: usize,
) -> Result<Vec<SolutionSet>, PrepareError> {
    drive::<PrepareError>(algorithm, &mut |stage| {
        let prepared = PreparedStage::new(system, stage, objects)?;
        Ok(prepared.track(0..prepared.items(), width))
    })?;
    Ok(algorithm.solution_sets(system))
}

/// Drives an algorithm until it is done. `track` follows all paths of a stage,
/// in item order; its first error ends the run.
pub fn drive<E>(
    algorithm: &mut dyn PathAlgorithm,
    track: &mut dyn FnMut(&Stage) -> Result<Vec<PathResult>, E>,
) -> Result<(), E> {
    let mut open = std::collections::VecDeque::new();
    loop {
        match algorithm.next() {
            Next::Open(stage) => open.push_back(stage),
            Next::Wait => {
                let stage: Box<Stage> = open
                    .pop_front()
                    .expect("an algorithm waits only for a stage that it opened");
                let results = track(&stage)?;
                algorithm.absorb(stage.id, &mut results.into_iter());
            }
            Next::Done => return Ok(()),
        }
    }
}
