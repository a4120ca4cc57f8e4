//! Boxed: where a real curve leaves the box that was asked for, and its part inside.

use super::super::real_box::{Place, RealBox};
use super::super::{Context, Operand};
use super::traced::{Critical, value};
use super::{Phase, RealCurves, is_real, make_real};
use crate::decomposition::deflated::equal_ones_merged;
use crate::decomposition::job::Job;
use cognate_continuation::bend::doubles_of;
use cognate_solutions::classification::Verdict;
use cognate_solutions::witness::real_curve::{RealCurve, VertexKind};
use num_complex::Complex64;

/// How far a point may be off, relative to its size or to 1.
const ERROR: f64 = 1e-9;

impl RealCurves {
    /// The stage to all faces of the box, where one was asked for.
    pub(super) fn window(&mut self, with: &mut Context<'_>, operand: &Operand) -> Option<Job> {
        let involution = with.problem.involution.as_ref()?;
        let Some(within) = RealBox::new(&self.wish.within, involution) else {
            return self.slabs(with, operand);
        };
        let faces = within.faces().map(|face| vec![row(with, &within, face)]);
        let targets = faces.collect();
        self.phase = Phase::Window;
        Some(operand.moved_to(with.problem, with.deflations, targets))
    }

    /// All points on the faces are known.
    pub(super) fn windowed(
        &mut self,
        with: &mut Context<'_>,
        operand: &Operand,
        job: &Job,
    ) -> Option<Job> {
        let involution = with.problem.involution.as_ref()?;
        let bounds = self.wish.within.clone();
        let within = RealBox::new(&bounds, involution)?;
        let ends = job.ends();
        for (face, ends) in within.faces().zip(ends.chunks(operand.degree())) {
            let (variable, bound) = face;
            let not_general =
                || format!("the face of the box at {bound} is not general on the curve");
            let finite = ends
                .iter()
                .filter(|(_, d, _)| d.verdict != Verdict::AtInfinity);
            let finite: Vec<_> = finite.collect();
            if finite.iter().any(|(_, d, _)| d.verdict != Verdict::Finite) {
                return self.doubt(not_general());
            }
            let points: Vec<Vec<Complex64>> = finite.iter().map(|(_, _, v)| v.clone()).collect();
            let rows = [row(with, &within, face)];
            let refined = with
                .deflations
                .points_on(with.problem, (&rows, &[]), &points);
            let Some(refined) = refined.into_iter().collect::<Option<Vec<_>>>() else {
                return self.doubt(not_general());
            };
            let apart = refined.iter().map(|p| (p.clone(), 1)).collect();
            if equal_ones_merged(apart).len() < points.len() {
                return self.doubt(not_general());
            }
            for refined in refined {
                let mut point = doubles_of(&refined.point);
                let Some(real) = is_real(&refined, &point, involution) else {
                    return self.doubt("a point is neither clearly real nor clearly not");
                };
                if !real {
                    continue;
                }
                match place(with, &within, &point, Some(variable)) {
                    Place::Outside => continue,
                    Place::OnFace => return self.doubt("the curve meets an edge of the box"),
                    Place::Inside => {}
                }
                make_real(&mut point, involution);
                self.now.window.push(Critical {
                    value: value(&self.now.form, &point),
                    point,
                    regular: true,
                    exact: true,
                });
            }
        }
        self.slabs(with, operand)
    }

    /// Whether a real point is in the box, where there is one; `None` where it is on a face.
    pub(super) fn inside(&self, with: &Context<'_>, point: &[Complex64]) -> Option<bool> {
        let involution = with.problem.involution.as_ref()?;
        let Some(within) = RealBox::new(&self.wish.within, involution) else {
            return Some(true);
        };
        match place(with, &within, point, None) {
            Place::Inside => Some(true),
            Place::Outside => Some(false),
            Place::OnFace => None,
        }
    }
}

/// Where a point in the unknowns that are tracked is.
fn place(
    with: &Context<'_>,
    within: &RealBox<'_>,
    point: &[Complex64],
    face: Option<usize>,
) -> Place {
    let point = with.problem.to_variables(point);
    within.place(&point, ERROR * size(&point), face)
}

fn size(point: &[Complex64]) -> f64 {
    let squares = point.iter().map(|z| z.norm_sqr());
    squares.sum::<f64>().sqrt().max(1.0)
}

/// A face as a slice in the unknowns that are tracked.
fn row(
    with: &Context<'_>,
    within: &RealBox<'_>,
    (variable, bound): (usize, f64),
) -> Vec<Complex64> {
    let mut row = vec![Complex64::default(); with.problem.variables() + 1];
    row[0].re = -bound;
    for (v, coefficient) in within.coordinate(variable) {
        row[v + 1] = coefficient;
    }
    let tracked = with.problem.tracked_slices(&[row]);
    tracked.into_iter().next().unwrap_or_default()
}

/// Leaves the arcs that are wanted, and the vertices inside; points are in the variables.
pub(super) fn clip(curve: &mut RealCurve, wanted: &[bool], within: &RealBox<'_>) {
    let at = |point: &[Complex64]| within.place(point, ERROR * size(point), None);
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
