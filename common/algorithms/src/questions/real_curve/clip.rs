//! Clip: the part of a real curve that is in the box that was asked for.

use super::super::real_box::{ERROR, Place, RealBox};
use cognate_solutions::witness::real_curve::{RealCurve, VertexKind};
use num_complex::Complex64;

/// Leaves the arcs that are wanted, and the vertices inside; points are in the variables.
pub(super) fn clip(curve: &mut RealCurve, wanted: &[bool], within: &RealBox<'_>) {
    let at = |point: &[Complex64]| within.place(point, ERROR, None);
    let mut names = Vec::with_capacity(curve.vertices.len());
    let mut kept = Vec::new();
    for vertex in std::mem::take(&mut curve.vertices) {
        let place = match vertex.kind {
            VertexKind::Window => Place::Inside,
            _ => at(&vertex.point),
        };
        if place == Place::OnFace {
            let value = vertex.value;
            let doubt = format!("a vertex where the form is {value:.6} is on a face of the box");
            curve.doubts.push(doubt);
        }
        names.push((place == Place::Inside).then_some(kept.len()));
        if place == Place::Inside {
            kept.push(vertex);
        }
    }
    curve.vertices = kept;
    let mut leaves = false;
    for (mut edge, _) in std::mem::take(&mut curve.edges)
        .into_iter()
        .zip(wanted)
        .filter(|(_, wanted)| **wanted)
    {
        for end in &mut edge.ends {
            *end = end.and_then(|vertex| names[vertex]);
            leaves |= end.is_none();
        }
        leaves |= edge.samples.iter().any(|p| at(p) == Place::Outside);
        curve.edges.push(edge);
    }
    if leaves {
        curve
            .doubts
            .push("an arc leaves the box where none was seen to".to_owned());
    }
}
