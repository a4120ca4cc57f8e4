//! From assignments to a program: runs of equal operation, few slots.
//!
//! One jump per operation is mispredicted more often than not; a run of equal
//! operations costs one. Operations that are ready are taken out of a window
//! of the depth-first order, so that runs are long and yet little is alive at
//! a time. Slots are given by linear scan and used again, the last one first.

use super::instruction::{Assignment, Operand, Operation};
use super::{Index, Layout, Run, StraightLineProgram, Target};
use std::collections::{BTreeMap, BTreeSet};

/// Longest run that is formed while other operations wait: longer ones keep
/// more alive and save nothing.
const LONGEST_RUN: usize = 16;

/// Orders the assignments, gives them slots, and packs them.
///
/// `window` is how far ahead of the first waiting assignment one may be taken.
pub(crate) fn schedule(
    assignments: &[Assignment],
    layout: Layout,
    outputs: usize,
    window: usize,
) -> StraightLineProgram {
    let runs = order_in_runs(assignments, window);
    let (slots, place) = give_slots(assignments, &runs);
    let address = |operand: &Operand| -> Index {
        match *operand {
            Operand::Variable(v) => layout.variable(v),
            Operand::Parameter(p) => layout.parameter(p),
            Operand::Direction(p) => layout.direction(p),
            Operand::Constant(c) => layout.constant(c),
            Operand::Value(v) => layout.temporary(place[v as usize]),
        }
    };
    let mut packed = Vec::new();
    let mut operands = super::Operands::default();
    for run in &runs {
        let first = &assignments[run[0] as usize];
        packed.push(Run {
            operation: first.operation,
            target: if first.output.is_some() {
                Target::Output
            } else {
                Target::Memory
            },
            length: u32::try_from(run.len()).expect("runs are short"),
        });
        for &number in run {
            let assignment = &assignments[number as usize];
            let target = match assignment.output {
                Some(entry) => entry,
                None => layout.temporary(place[number as usize]),
            };
            let [a, b, c, d] = assignment.operands.each_ref().map(address);
            match assignment.operation.arity() {
                1 => operands.unary.push([target, a]),
                2 => operands.binary.push([target, a, b]),
                3 => operands.ternary.push([target, a, b, c]),
                _ => operands.quaternary.push([target, a, b, c, d]),
            }
        }
    }
    StraightLineProgram::new(layout, slots, outputs, packed, operands)
}

/// All assignments, in runs of equal operation and target.
fn order_in_runs(assignments: &[Assignment], window: usize) -> Vec<Vec<u32>> {
    let mut waiting_for = vec![0u32; assignments.len()];
    let mut users: Vec<Vec<u32>> = vec![Vec::new(); assignments.len()];
    for (number, assignment) in assignments.iter().enumerate() {
        for operand in assignment.used() {
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
        let limit = u32::try_from(first_waiting + window).unwrap_or(u32::MAX);
        let best = ready
            .iter()
            .filter(|(_, set)| set.first().is_some_and(|&first| first < limit))
            .max_by_key(|(_, set)| {
                let count = set.range(..limit).take(LONGEST_RUN).count();
                let first = set.first().copied().unwrap_or(u32::MAX);
                (count, std::cmp::Reverse(first))
            })
            .map(|(&kind, _)| kind)
            .expect("the first waiting assignment is ready, since its operands stand before it");
        let mut run = Vec::new();
        while run.len() < LONGEST_RUN {
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
        for operand in assignment.used() {
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
        for operand in assignment.used() {
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
