//! From assignments to a program: runs of equal operation, few slots.
//!
//! One jump per operation is mispredicted more often than not; a run of equal
//! operations costs one. Operations that are ready are taken out of a window
//! of the depth-first order, so that runs are long and yet little is alive at
//! a time. Slots are given by linear scan and used again, the last one first.

use super::instruction::{Assignment, Operand, Operation};
use super::{Index, Layout, Run, StraightLineProgram, Target};
use std::collections::{BTreeMap, BTreeSet};

/// Rule by which runs are formed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scheduling {
    /// Farthest that an assignment may be ahead of the first waiting one when it is taken: a longer window makes longer
    /// runs and keeps more values alive.
    pub window: usize,
    /// Longest run that is formed while other operations wait.
    pub longest_run: usize,
}

impl Default for Scheduling {
    /// Best for lanes and near the best for single paths
    /// (`benches/evaluation.rs` has the figures).
    fn default() -> Self {
        Self {
            window: 96,
            longest_run: 16,
        }
    }
}

/// Orders the assignments, gives them slots, and packs them. The results are the `wanted` entries of the output.
pub(crate) fn schedule(
    assignments: &[Assignment],
    layout: Layout,
    outputs: usize,
    wanted: impl Fn(usize) -> bool,
    scheduling: Scheduling,
) -> StraightLineProgram {
    let runs = order_in_runs(assignments, scheduling);
    let (slots, place) = give_slots(assignments, &runs);
    let address = |operand: &Operand| -> Index {
        match *operand {
            Operand::Variable(v) => layout.variable(v),
            Operand::Parameter(p) => layout.parameter(p),
            Operand::Direction(p) => layout.direction(p),
            Operand::Constant(c) => layout.constant(c),
            Operand::Single(c) => c,
            Operand::Value(v) => layout.temporary(place[v as usize]),
        }
    };
    let mut packed = Vec::new();
    let mut code = Vec::new();
    for run in &runs {
        let first = &assignments[run[0] as usize];
        let target = if first.output.is_some() {
            Target::Output
        } else {
            Target::Memory
        };
        packed.push(Run::new(first.operation, target, run.len()));
        for &number in run {
            let assignment = &assignments[number as usize];
            code.push(match assignment.output {
                Some(entry) => entry,
                None => layout.temporary(place[number as usize]),
            });
            code.extend(assignment.operands.iter().map(address));
        }
    }
    StraightLineProgram::new(layout, slots, outputs, wanted, packed, code)
}

/// All assignments, in runs of equal operation and target.
fn order_in_runs(assignments: &[Assignment], scheduling: Scheduling) -> Vec<Vec<u32>> {
    let mut waiting_for = vec![0u32; assignments.len()];
    let mut users: Vec<Vec<u32>> = vec![Vec::new(); assignments.len()];
    for (number, assignment) in assignments.iter().enumerate() {
        for operand in &assignment.operands {
            if let Operand::Value(v) = operand {
                waiting_for[number] += 1;
                users[*v as usize].push(number as u32);
            }
        }
    }
    let kind = |number: u32| {
        let assignment = &assignments[number as usize];
        (assignment.operation, assignment.output.is_some())
    };
    let mut ready: BTreeMap<(Operation, bool), BTreeSet<u32>> = BTreeMap::new();
    for (number, &count) in waiting_for.iter().enumerate() {
        if count == 0 {
            let number = number as u32;
            ready.entry(kind(number)).or_default().insert(number);
        }
    }
    let mut done = vec![false; assignments.len()];
    let mut first_waiting = 0usize;
    let mut runs = Vec::new();
    while first_waiting < assignments.len() {
        let limit = first_waiting.saturating_add(scheduling.window.max(1));
        let limit = u32::try_from(limit).unwrap_or(u32::MAX);
        let best = ready
            .iter()
            .filter(|(_, set)| set.first().is_some_and(|&first| first < limit))
            .max_by_key(|(_, set)| {
                let count = set.range(..limit).take(scheduling.longest_run).count();
                let first = set.first().copied().unwrap_or(u32::MAX);
                (count, std::cmp::Reverse(first))
            })
            .map(|(&kind, _)| kind)
            .expect("the first waiting assignment is ready, since its operands stand before it");
        let mut run = Vec::new();
        while run.len() < scheduling.longest_run.max(1) {
            let set = ready.get_mut(&best).expect("chosen among the ready");
            let Some(&number) = set.first().filter(|&&first| first < limit) else {
                break;
            };
            set.remove(&number);
            run.push(number);
            done[number as usize] = true;
            for &user in &users[number as usize] {
                waiting_for[user as usize] -= 1;
                if waiting_for[user as usize] == 0 {
                    ready.entry(kind(user)).or_default().insert(user);
                }
            }
        }
        if ready.get(&best).is_some_and(BTreeSet::is_empty) {
            ready.remove(&best);
        }
        runs.push(run);
        while done.get(first_waiting) == Some(&true) {
            first_waiting += 1;
        }
    }
    runs
}

/// The number of slots and the slot of every assignment that has one.
fn give_slots(assignments: &[Assignment], runs: &[Vec<u32>]) -> (usize, Vec<u32>) {
    let mut remaining = vec![0u32; assignments.len()];
    for assignment in assignments {
        for operand in &assignment.operands {
            if let Operand::Value(v) = operand {
                remaining[*v as usize] += 1;
            }
        }
    }
    let mut place = vec![u32::MAX; assignments.len()];
    let mut free: Vec<u32> = Vec::new();
    let mut slots = 0u32;
    for &number in runs.iter().flatten() {
        let assignment = &assignments[number as usize];
        // An operation reads before it writes, so it may write over an operand.
        for operand in &assignment.operands {
            if let Operand::Value(v) = operand {
                remaining[*v as usize] -= 1;
                if remaining[*v as usize] == 0 {
                    free.push(place[*v as usize]);
                }
            }
        }
        if assignment.output.is_none() {
            place[number as usize] = free.pop().unwrap_or_else(|| {
                slots += 1;
                slots - 1
            });
        }
    }
    (slots as usize, place)
}
