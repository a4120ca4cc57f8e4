//! FollowedPaths: paths from known solutions to targets, planned once; each is followed once, and that is all.
//!
//! A solve also treats paths that end at singular points or meet. For the targets of arms this is often in vain,
//! because the arm decides there. A target of which all paths end regularly is solved from here on, with the results of
//! its paths.

use cognate_algorithms::plan::{GivenStart, Plan};
use cognate_algorithms::run_locally::drive;
use cognate_algorithms::{Next, Opening, PathAlgorithm, SolveOptions, plan};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::{PathIndex, PathResult};
use cognate_continuation::prepared_family::PreparedFamily;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::work::{Stage, Work};
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::sync::Arc;

/// Paths from known solutions of a system to any targets.
pub struct FollowedPaths {
    start: Arc<StoredPoints>,
    /// Digest of the start points.
    object: Digest,
    options: SolveOptions,
    stage: Stage,
    /// The system by which the paths go.
    pub system: System,
}

impl FollowedPaths {
    /// Plans them by one target.
    pub fn new(
        system: &System,
        options: &SolveOptions,
        start: &Arc<StoredPoints>,
        target: Vec<Complex64>,
    ) -> Result<Self, String> {
        let given = GivenStart::of(start);
        let options = SolveOptions {
            method: options.method.clone().with_points(given),
            ..options.clone()
        };
        let mut plan = planned(system, &options, vec![target])?;
        match plan.algorithm.next() {
            Next::Open(opening) if opening.stage.work == Work::Track => Ok(Self {
                start: Arc::clone(start),
                object: given.object,
                options,
                stage: opening.stage,
                system: plan.system,
            }),
            _ => Err("the solve does not begin with paths".into()),
        }
    }

    /// How many paths lead to a target.
    pub fn count(&self) -> usize {
        self.start.len()
    }

    /// The results of all paths to these targets, target by target.
    pub fn follow(
        &self,
        targets: Vec<Vec<Complex64>>,
        family: &PreparedFamily,
    ) -> Result<Vec<PathResult>, String> {
        let mut stage = self.stage.clone();
        if let HomotopyKind::Parameter {
            targets: stage_targets,
            ..
        } = &mut stage.homotopy
        {
            *stage_targets = targets;
        }
        let find = |_| Some(Arc::clone(&self.start));
        let prepared = family.prepare(&self.system, &stage, &find);
        let prepared = prepared.map_err(|error| error.to_string())?;
        let results = prepared.run(0..prepared.items(), prepared.preferred_width());
        let paths = results.into_iter().map(|result| match result {
            ItemResult::Track(path) => Ok(path),
            _ => Err("a stage of paths has other results".to_string()),
        });
        paths.collect()
    }

    /// The result that a path would have which ends at this solution, regular and with this condition number.
    pub fn result_at(&self, solution: &[Complex64], condition: f64) -> PathResult {
        let endpoint = PointShape::of(&self.system).to_coordinates(solution);
        let accuracy = f64::EPSILON * condition;
        PathResult {
            residual: f64::EPSILON,
            condition,
            accuracy,
            ..PathResult::untracked(0, 0, PathOutcome::Regular, endpoint)
        }
    }

    /// The solution sets at these targets from the results of their paths, target by target.
    pub fn solution_sets(
        &self,
        system: &System,
        targets: Vec<Vec<Complex64>>,
        results: Vec<PathResult>,
        family: &PreparedFamily,
    ) -> Result<Vec<SolutionSet>, String> {
        let plan = planned(system, &self.options, targets)?;
        let (tracked, mut algorithm) = (plan.system, plan.algorithm);
        let mut followed = Some(results);
        let mut work = |opening: &Opening| {
            let stage = &opening.stage;
            // By its first target a solve may choose other units.
            let fits = tracked == self.system && stage.settings == self.stage.settings;
            if let Some(results) = followed.take().filter(|_| fits) {
                let numbered = (0..).zip(results).map(|(number, result)| PathResult {
                    origin: PathIndex(number),
                    ..result
                });
                return Ok(numbered.map(ItemResult::Track).collect());
            }
            let find = |wanted: Digest| {
                let start = || (wanted == self.object).then(|| Arc::clone(&self.start));
                opening.object(wanted).or_else(start)
            };
            let system = opening.system.as_deref().unwrap_or(&tracked);
            let prepared = family.prepare(system, stage, &find);
            let prepared = prepared.map_err(|error| error.to_string())?;
            Ok::<Vec<ItemResult>, String>(
                prepared.run(0..prepared.items(), prepared.preferred_width()),
            )
        };
        drive(&mut algorithm, &mut work)?;
        Ok(algorithm.solution_sets(&tracked))
    }
}

/// The plan of a solve to these targets.
fn planned(
    system: &System,
    options: &SolveOptions,
    targets: Vec<Vec<Complex64>>,
) -> Result<Plan, String> {
    let options = SolveOptions {
        target_parameters: targets,
        ..options.clone()
    };
    plan(system, &options).map_err(|error| error.to_string())
}
