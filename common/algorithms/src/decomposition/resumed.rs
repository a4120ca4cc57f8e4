//! Resumed: known components of the first equations, on their way to the slices on which the other equations cut them.

use super::deflated::PureSet;
use super::job::Job;
use super::operand::TrackedSet;
use super::problem::Problem;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
                let slice = whole.slices(operand.dimension());
                return Some(tracked_set.moved(self.place, slice));
            }
            self.sets.push(operand.set.clone());
            self.place += 1;
        }
    }

    fn learn(&mut self, whole: &Problem, tracked_set: &mut TrackedSet, job: &Job) {
        let set = tracked_set.operands[self.place].set.clone();
        let slice = whole.slices(set.dimension);
        let (points, lost) = tracked_set.arrived(self.place, &slice, job);
        self.place += 1;
        if lost > 0 {
            *self.lost.entry(set.dimension).or_default() += lost;
        }
        if !points.is_empty() {
            self.sets.push(PureSet { points, ..set });
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
