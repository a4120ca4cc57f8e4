//! Limited: an algorithm from beginning to end in one thread, as long as its CPU seconds last.

use crate::measures::cpu_seconds;
use cognate_algorithms::PathAlgorithm;
use cognate_algorithms::run_locally::drive;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_systems::system::System;
use std::collections::HashMap;
use std::sync::Arc;

/// Runs an algorithm and returns whether it ended: after `limit` CPU seconds no further stage begins. With `STAGES` in
/// the environment there is a line for every stage.
///
/// # Errors
/// When a stage cannot be prepared.
pub fn run_within(
    limit: f64,
    system: &System,
    algorithm: &mut dyn PathAlgorithm,
) -> Result<bool, String> {
    let began = cpu_seconds().map_err(|e| e.to_string())?;
    let verbose = std::env::var_os("STAGES").is_some();
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    let driven: Result<(), Option<String>> = drive(algorithm, &mut |opening| {
        let now = cpu_seconds().map_err(|e| Some(e.to_string()))?;
        if now - began > limit {
            return Err(None);
        }
        let made = opening.objects.iter();
        objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
        let find = |digest: Digest| objects.get(&digest).cloned();
        let system = opening.system.as_deref().unwrap_or(system);
        let prepared = PreparedWork::new(system, &opening.stage, &find);
        let prepared = prepared.map_err(|e| Some(e.to_string()))?;
        let results = prepared.run(0..prepared.items(), 8);
        if verbose {
            let kind = format!("{:?}", opening.stage.homotopy);
            let after = cpu_seconds().map_err(|e| Some(e.to_string()))?;
            eprintln!(
                "    {:.2} s: {:?} {}, attempt {}, {} items, {:.3} s",
                now - began,
                opening.stage.work,
                kind.split([' ', '(']).next().unwrap_or_default(),
                opening.stage.attempt,
                prepared.items(),
                after - now
            );
        }
        Ok(results)
    });
    match driven {
        Ok(()) => Ok(true),
        Err(None) => Ok(false),
        Err(Some(error)) => Err(error),
    }
}
