//! All isolated solutions of one system by a polyhedral homotopy, in two legs.
//!
//! First from the mixed cells to all solutions of the generic system with the
//! same monomials (toric homotopy), then from those to the system that is
//! asked. Each leg is a retried stage with its own crossing check; a path that
//! does not arrive in the first is named as failed in the end, so that the
//! counts add up to the mixed volume.

use crate::any_algorithm::AnyAlgorithm;
use crate::closing_stage::FiniteEndpoints;
use crate::opening::Opening;
use crate::progress::VerdictCounts;
use crate::retried_stage::RetriedStage;
use crate::{Next, PathAlgorithm, Progress};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::path_result::{PathIndex, PathResult};
use cognate_continuation::start_points::StoredPoints;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::work::{Stage, StageId};
use cognate_solutions::classification::{Tolerances, Verdict};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Mixed cells to a generic system, the generic system to the target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolyhedralSolve {
    generic: RetriedStage,
    /// `None` until all paths of the first leg have ended.
    target: Option<RetriedStage>,
    /// Paths of the first leg that arrived, ascending: path k of the second leg
    /// is path `arrived[k]`.
    arrived: Vec<u64>,
    /// Values of the system's parameters.
    parameters: Vec<Complex64>,
}

impl PolyhedralSolve {
    /// The solve that begins with this stage, a toric homotopy.
    ///
    /// # Panics
    /// When the stage is none.
    pub fn new(
        first: Stage,
        system: &System,
        parameters: Vec<Complex64>,
        tolerances: Tolerances,
    ) -> Self {
        assert!(
            matches!(first.homotopy, HomotopyKind::Toric),
            "a polyhedral solve begins in mixed cells"
        );
        Self {
            generic: RetriedStage::new(first, system, tolerances, 1),
            target: None,
            arrived: Vec::new(),
            parameters,
        }
    }

    /// The same with another limit of repetitions.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.generic = self.generic.with_max_retries(max_retries);
        self
    }

    /// The second leg, from what the first one found; `None` where it found nothing.
    fn second_leg(&mut self) -> Option<Opening> {
        let mut coordinates = Vec::new();
        for (result, decision) in self.generic.results().iter().zip(self.generic.decisions()) {
            // The generic system has regular finite solutions only.
            if decision.verdict != Verdict::Finite || !regular(result) {
                continue;
            }
            let shape = self.generic.shape();
            let point = shape.to_variables(result.endpoint.to_double());
            if point.iter().all(|z| z.re.is_finite() && z.im.is_finite()) {
                self.arrived.push(result.origin.0);
                coordinates.extend(point);
            }
        }
        if self.arrived.is_empty() {
            return None;
        }
        let points = Arc::new(StoredPoints {
            dimension: coordinates.len() / self.arrived.len(),
            coordinates,
        });
        let first = Stage {
            homotopy: HomotopyKind::Generic {
                parameters: self.parameters.clone(),
            },
            start_points: points.as_start(),
            ..self.generic.first().clone()
        };
        let lost = (self.generic.results().len() - self.arrived.len()) as u64;
        let mut target = self.generic.followed_by(first, lost);
        let next = target.next_stage();
        self.target = Some(target);
        match next {
            Next::Open(mut opening) => {
                opening.objects.push(points);
                Some(*opening)
            }
            Next::Wait | Next::Done => None,
        }
    }

    /// The last result of every path of the whole, by its index in the first leg.
    pub fn results(&self) -> Vec<PathResult> {
        let mut results: Vec<PathResult> = self
            .generic
            .results()
            .iter()
            .map(|result| PathResult {
                outcome: match result.outcome {
                    PathOutcome::Failed(failure) => PathOutcome::Failed(failure),
                    // Where a generic system has no solution.
                    PathOutcome::Regular | PathOutcome::Singular | PathOutcome::Diverging => {
                        PathOutcome::Failed(Failure::EndgameUnsettled)
                    }
                },
                t: Complex64::new(1.0, 0.0),
                ..result.clone()
            })
            .collect();
        let target = self.target.iter().flat_map(RetriedStage::results);
        for (result, &origin) in target.zip(&self.arrived) {
            results[origin as usize] = PathResult {
                origin: PathIndex(origin),
                ..result.clone()
            };
        }
        results
    }
}

fn regular(result: &PathResult) -> bool {
    result.outcome == PathOutcome::Regular
}

impl PathAlgorithm for PolyhedralSolve {
    fn next(&mut self) -> Next {
        if let Some(target) = &mut self.target {
            return target.next_stage();
        }
        match self.generic.next_stage() {
            Next::Done => match self.second_leg() {
                Some(opening) => Next::Open(Box::new(opening)),
                None => Next::Done,
            },
            other => other,
        }
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = PathResult>) {
        match &mut self.target {
            Some(target) => target.absorb(stage, results),
            None => self.generic.absorb(stage, results),
        }
    }

    fn progress(&self) -> Progress {
        let first = self
            .generic
            .progress("a generic system with the same monomials");
        match &self.target {
            None => Progress {
                // Nothing is known of the system that is asked.
                paths: VerdictCounts::default(),
                done: first.done && !self.generic.results().iter().any(regular),
                ..first
            },
            Some(target) => {
                let mut second = target.progress("from the generic system to this one");
                second.paths.failed += (self.generic.results().len() - self.arrived.len()) as u64;
                let mut stages = first.stages;
                stages.append(&mut second.stages);
                Progress { stages, ..second }
            }
        }
    }

    fn snapshot(&self) -> Vec<u8> {
        AnyAlgorithm::Polyhedral(Box::new(self.clone())).to_bytes()
    }

    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        let mut finite_endpoints = self.target.as_ref()?.finite_endpoints();
        finite_endpoints.homotopy = HomotopyKind::StraightLine {
            parameters: self.parameters.clone(),
        };
        let FiniteEndpoints {
            regular, singular, ..
        } = &mut finite_endpoints;
        for point in regular.iter_mut().chain(singular) {
            point.path = self.arrived[point.path as usize];
        }
        Some(finite_endpoints)
    }

    fn solution_sets(&self, system: &System) -> Vec<SolutionSet> {
        let results = self.results();
        let last = self.target.as_ref().unwrap_or(&self.generic);
        let mut history = last.history(0, true);
        if self.target.is_some() {
            // What was tracked again on the way counts too.
            let first = self.generic.history(0, true);
            history.retracked += first.retracked;
            history.crossings_found += first.crossings_found;
            history.crossings_resolved += first.crossings_resolved;
        }
        vec![last.set_of(system, &self.parameters, &results, &history)]
    }
}
