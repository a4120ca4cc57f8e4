//! Boxed: where a real curve leaves the box that was asked for.

use super::super::context::Context;
use super::super::real_box::{ERROR, Place, RealBox};
use super::traced::{Critical, value};
use super::{Phase, RealCurves, is_real, make_real};
use crate::decomposition::deflated::equal_ones_merged;
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use cognate_continuation::bend::doubles_of;
use cognate_solutions::classification::Verdict;
use num_complex::Complex64;

impl RealCurves {
    /// The stage to all faces of the box, where one was asked for.
    pub(super) fn window(&mut self, context: &mut Context<'_>, operand: &Operand) -> Option<Job> {
        let involution = context.problem.involution.as_ref()?;
        let Some(within) = RealBox::new(&self.wish.within, involution) else {
            return self.slabs(context, operand);
        };
        let faces = within.faces().map(|face| vec![row(context, &within, face)]);
        let targets = faces.collect();
        self.phase = Phase::Window;
        Some(operand.moved_to(&mut context.of_components(), targets))
    }

    /// All points on the faces are known.
    pub(super) fn windowed(
        &mut self,
        context: &mut Context<'_>,
        operand: &Operand,
        job: &Job,
    ) -> Option<Job> {
        let involution = context.problem.involution.as_ref()?;
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
            let rows = [row(context, &within, face)];
            let refined = context
                .deflations
                .points_on(context.problem, (&rows, &[]), &points);
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
                match place(context, &within, &point, Some(variable)) {
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
        self.slabs(context, operand)
    }

    /// Whether a real point is in the box, where there is one; `None` where it is on a face.
    pub(super) fn inside(&self, context: &Context<'_>, point: &[Complex64]) -> Option<bool> {
        let involution = context.problem.involution.as_ref()?;
        let Some(within) = RealBox::new(&self.wish.within, involution) else {
            return Some(true);
        };
        match place(context, &within, point, None) {
            Place::Inside => Some(true),
            Place::Outside => Some(false),
            Place::OnFace => None,
        }
    }
}

/// Place in the box of a point in the unknowns that are tracked.
fn place(
    context: &Context<'_>,
    within: &RealBox<'_>,
    point: &[Complex64],
    face: Option<usize>,
) -> Place {
    within.place(&context.problem.to_variables(point), ERROR, face)
}

/// A face as a slice in the unknowns that are tracked.
fn row(
    context: &Context<'_>,
    within: &RealBox<'_>,
    (variable, bound): (usize, f64),
) -> Vec<Complex64> {
    let mut row = vec![Complex64::default(); context.problem.variables() + 1];
    row[0].re = -bound;
    for (v, coefficient) in within.coordinate(variable) {
        row[v + 1] = coefficient;
    }
    let tracked = context.problem.tracked_slices(&[row]);
    tracked.into_iter().next().unwrap_or_default()
}
