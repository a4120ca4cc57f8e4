//! Mirror: whether a component is its own complex conjugate.
//!
//! The conjugates of its witness points lie on the conjugate of its slice. Paths bring them to the slice itself: where
//! the component is its own conjugate they end at its witness points, and where it is not they end at none of them.

use super::context::Context;
use super::locus::apart;
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_solutions::classification::Verdict;
use cognate_solutions::involution::Involution;

/// An end of a path is a witness point within this, relative to its size.
const SAME: f64 = 1e-6;

/// The paths from the conjugates of the witness points to the slice of the component.
pub(super) fn conjugates_to_slice(
    context: &mut Context<'_>,
    operand: &Operand,
    involution: &Involution,
) -> Job {
    let mut start = Vec::new();
    for row in &operand.slices {
        start.push(row[0].conj());
        start.extend(involution.image(&row[1..]));
    }
    let homotopy = HomotopyKind::Parameter {
        start,
        targets: vec![operand.slices.concat()],
    };
    let points = operand.set.doubles();
    let images: Vec<_> = points.iter().map(|p| involution.image(p)).collect();
    let system = context.of_components().described(operand.set.tracked());
    Job::track(system, homotopy, &images, &context.problem.tracking).ends_only()
}

/// Whether the component is its own conjugate, by where these paths ended; `None` where that is not clear.
pub(super) fn is_own_conjugate(operand: &Operand, job: &Job) -> Option<bool> {
    let points = operand.set.doubles();
    let ends = job.ends();
    let is_witness_point = |end: &[_]| points.iter().any(|p| apart(p, end) < SAME);
    let back = ends.iter().filter(|(_, _, end)| is_witness_point(end));
    let none_lost = ends.iter().all(|(_, d, _)| d.verdict == Verdict::Finite);
    match back.count() {
        count if count == points.len() => Some(true),
        0 if none_lost && ends.len() == points.len() => Some(false),
        _ => None,
    }
}
