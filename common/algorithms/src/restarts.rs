//! Restarts: a solve in one thread that is written down and read back on its way, for tests.

use crate::{AnyAlgorithm, AnySolve, Next, Opening, PathAlgorithm};
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_systems::system::System;
use std::collections::HashMap;
use std::sync::Arc;

/// Runs a solve with a state that is written down and read back after each stage is open; `look` sees each stage.
/// `system`: of stages that name none.
pub(crate) fn with_restarts(
    solve: AnySolve,
    system: &System,
    look: &mut dyn FnMut(&Opening),
) -> AnyAlgorithm {
    let mut solve = AnyAlgorithm::from(solve);
    let mut open: Option<Box<Opening>> = None;
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    loop {
        let snapshot = solve.snapshot();
        let restored = AnyAlgorithm::restore(&snapshot).unwrap();
        assert!(restored == solve && restored.snapshot() == snapshot);
        solve = restored;
        match solve.next() {
            Next::Open(opening) => open = Some(opening),
            Next::Wait => {
                let opening = open.take().unwrap();
                look(&opening);
                let made = opening.objects.iter();
                objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
                let find = |digest: Digest| objects.get(&digest).cloned();
                let system = opening.system.as_deref().unwrap_or(system);
                let prepared = PreparedWork::new(system, &opening.stage, &find).unwrap();
                let results = prepared.run(0..prepared.items(), 8);
                solve.absorb(opening.stage.id, &mut results.into_iter());
            }
            Next::Done => return solve,
        }
    }
}
