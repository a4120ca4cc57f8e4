//! Resumed: known components of the first equations, on their way to the slices on which the other equations cut them.

use super::deflated::{PureSet, equal_ones_merged};
use super::job::{Job, StageSystem};
use super::operand::TrackedSet;
use super::problem::Problem;
use cognate_solutions::classification::Verdict;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Component by component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Resumed {
    /// The component that comes next.
    place: usize,
    sets: Vec<PureSet>,
    /// Paths lost, by the dimension of their component.
    lost: BTreeMap<usize, u64>,
}

impl Resumed {
    /// The system of the open stage.
    pub fn system_of(&self, tracked_set: &mut TrackedSet, wanted: &StageSystem) -> Arc<System> {
        tracked_set
            .deflations
            .of_stage(&tracked_set.problem, wanted)
    }

    /// Learns from the stage that is done, and says which comes next.
    pub fn advance(
        &mut self,
        whole: &Problem,
        tracked_set: &mut TrackedSet,
        done: Option<&Job>,
    ) -> Option<Job> {
        if let Some(job) = done {
            self.learn(whole, tracked_set, job);
        }
        loop {
            let operand = tracked_set.operands.get(self.place)?;
            if operand.dimension() > 0 {
                let targets = vec![whole.slices(operand.dimension())];
                return Some(operand.moved_to(
                    &tracked_set.problem,
                    &mut tracked_set.deflations,
                    targets,
                ));
            }
            self.sets.push(operand.set.clone());
            self.place += 1;
        }
    }

    fn learn(&mut self, whole: &Problem, tracked_set: &mut TrackedSet, job: &Job) {
        let operand = &tracked_set.operands[self.place];
        self.place += 1;
        let set = &operand.set;
        let slices = whole.slices(set.dimension);
        let ends = job.ends().into_iter();
        let finite = ends.filter(|(_, decision, _)| decision.verdict == Verdict::Finite);
        let ends: Vec<Vec<Complex64>> = finite
            .map(|(_, _, values)| values[..whole.variables()].to_vec())
            .collect();
        let on = (slices.as_slice(), set.ranks.as_slice());
        let refined = tracked_set
            .deflations
            .points_on(&tracked_set.problem, on, &ends);
        let points_with_paths = refined.into_iter().flatten().map(|point| (point, 1));
        let moved: Vec<_> = equal_ones_merged(points_with_paths.collect())
            .into_iter()
            .filter(|(_, paths)| *paths == 1)
            .map(|(point, _)| point)
            .collect();
        // From one general slice to another all points of a component go apart.
        let lost = (set.points.len() - moved.len()) as u64 + job.crossings_left();
        if lost > 0 {
            *self.lost.entry(set.dimension).or_default() += lost;
        }
        if !moved.is_empty() {
            self.sets.push(PureSet {
                points: moved,
                ..set.clone()
            });
        }
    }

    /// The components on their new slices, highest dimension first, and the paths lost on the way.
    pub fn take(&mut self) -> (Vec<PureSet>, BTreeMap<usize, u64>) {
        let mut sets = std::mem::take(&mut self.sets);
        sets.sort_by_key(|set| std::cmp::Reverse(set.dimension));
        (sets, std::mem::take(&mut self.lost))
    }

    /// Describes the open stage in a few words.
    pub fn description(&self) -> &'static str {
        "moving known components"
    }
}
