//! Any algorithm from beginning to end in one thread: for examples, tests and tools.

use crate::{Next, PathAlgorithm};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::Stage;

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
