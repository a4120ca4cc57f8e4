//! Conjugates: the real part of a surface in space that is not its own complex conjugate.
//!
//! A real point of it is on its conjugate as well. The two meet in curves, on which the equations of both are singular:
//! the curves among the singular ones that are on the surface have all of its real points. Their own real parts, arcs
//! and isolated points, are the real part of the surface.

use super::super::context::Context;
use super::super::locus::apart;
use super::super::member::Member;
use super::super::mirror::is_own_conjugate;
use super::super::procedure::Procedure;
use super::super::real_curve::RealCurves;
use super::super::{AnyProcedure, QuestionSolve};
use super::reduced::reduced;
use super::squares::bases;
use super::{Child, Curves, Phase, RealSurfaces, equations};
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use cognate_solutions::witness::answer::Membership;
use cognate_solutions::witness::question::{CurveWish, GivenPoint};
use cognate_solutions::witness::real_curve::{CurveEdge, CurveVertex, RealCurve, VertexKind};
use cognate_solutions::witness::real_surface::{Mesh, RealSurface};
use cognate_solutions::witness::{Multiplicity, WitnessSet};
use num_complex::Complex64;
use std::sync::Arc;

/// Vertices of two curves nearer than this, relative to their size, are one point: singular points are known to so
/// much.
const SAME: f64 = 1e-5;
/// Vertices of two curves farther apart than this are two points.
const OTHER: f64 = 1e-3;
/// An end of a path is a witness point of the conjugate within this, relative to its size.
const SAME_END: f64 = 1e-6;
/// Least error of a witness point, relative to its size.
const LEAST_ERROR: f64 = 1e-14;
/// Said where paths do not tell.
const NOT_CLEAR: &str = "whether it is its own conjugate is not clear";
/// Said where a singular surface may hold the curves that are looked for.
const HIDDEN: &str = "it is not its own conjugate, and where it meets that may be hidden in another component, which is multiple";
/// Said of a curve that cannot be followed.
const MULTIPLE: &str = "it meets its conjugate in a multiple curve, of which no equations are regular: real points of it are not searched";
/// Said where paths to a curve do not tell.
const NOT_CLEARLY_ON: &str = "whether a singular curve is on it is not clear";

impl RealSurfaces {
    /// Goes on with the outline of a surface that is its own conjugate, and with the singular curves of one that is
    /// not.
    pub(super) fn mirrored(
        &mut self,
        context: &Context<'_>,
        operand: &Operand,
        job: &Job,
    ) -> Option<Job> {
        match is_own_conjugate(operand, job) {
            Some(true) => self.outline(context),
            Some(false) => {
                if let Some(surface) = self.of_conjugate(context, operand, job) {
                    self.settle(operand, Some(surface));
                    return None;
                }
                self.phase = Phase::Meeting;
                let variables = context.problem.variables();
                let witness_point = &operand.set.points[0].point[..variables];
                let system = bases(context.problem, witness_point)
                    .unwrap_or_else(|| equations::singular_solutions(context.problem));
                self.decompose(context, system, 1..=2)
            }
            None => self.doubt(NOT_CLEAR),
        }
    }

    /// The real part of the conjugate, where that is a surface that was asked before: it is the same. The paths ended
    /// at its witness points.
    fn of_conjugate(
        &self,
        context: &Context<'_>,
        operand: &Operand,
        job: &Job,
    ) -> Option<RealSurface> {
        let ends = job.ends();
        let is_conjugate = |other: &Operand| {
            let points = other.set.doubles();
            let near = |end: &Vec<Complex64>| points.iter().any(|p| apart(p, end) < SAME_END);
            other.slices == operand.slices
                && points.len() == ends.len()
                && ends.iter().all(|(_, _, end)| near(end))
        };
        let mut before = context.operands.iter().zip(&self.found);
        let (_, surface) = before.find(|(other, _)| is_conjugate(other))?;
        Some(RealSurface {
            id: operand.id,
            ..surface.clone()
        })
    }

    /// Begins to ask which of the singular curves are on the surface.
    pub(super) fn meet(
        &mut self,
        context: &mut Context<'_>,
        operand: &Operand,
        child: Child,
    ) -> Option<Job> {
        if let Child::Decomposition(solve) = &child
            && let Some(singular) = solve.decomposition()
            && singular.components.iter().any(|c| c.dimension() > 1)
        {
            return self.doubt(HIDDEN);
        }
        let [mut curves, multiple] = self.components(child)?;
        curves.extend(multiple);
        let points: Vec<GivenPoint> = curves.iter().flat_map(|c| given(context, c)).collect();
        self.now.asked = curves;
        if points.is_empty() {
            return self.draw(context, operand);
        }
        self.phase = Phase::Membership;
        match Member::new(&context.problem.given, &points) {
            Ok(membership) => self.now.membership = Some(membership),
            Err(error) => return self.doubt(error.to_string()),
        }
        self.ask_membership(context, operand, None)
    }

    /// Follows the real part of the curves that are on the surface, once all of them are told.
    pub(super) fn ask_membership(
        &mut self,
        context: &mut Context<'_>,
        operand: &Operand,
        done: Option<Job>,
    ) -> Option<Job> {
        let mut membership = self.now.membership.take()?;
        let place = self.found.len();
        let mut of_surface = Context {
            problem: context.problem,
            operands: &context.operands[place..=place],
            deflations: &mut *context.deflations,
            whole: context.whole,
            whole_deflations: &mut *context.whole_deflations,
            other: None,
        };
        if let Some(job) = membership.advance(&mut of_surface, done) {
            self.now.membership = Some(membership);
            return Some(job);
        }
        let points = membership.take();
        let mut points = points.as_slice();
        let mut on_surface = Vec::new();
        for curve in std::mem::take(&mut self.now.asked) {
            let (of_curve, others) = points.split_at(curve.points.len());
            points = others;
            match is_on_surface(of_curve) {
                Some(true) => on_surface.push(curve),
                Some(false) => {}
                None => return self.doubt(NOT_CLEARLY_ON),
            }
        }
        self.meeting_curves(context, operand, on_surface)
    }

    /// Begins to follow the curves in which the surface meets its conjugate.
    fn meeting_curves(
        &mut self,
        context: &mut Context<'_>,
        operand: &Operand,
        on_surface: Vec<WitnessSet>,
    ) -> Option<Job> {
        let is_reduced = |c: &WitnessSet| c.deflation.is_empty();
        let (plain, multiple): (Vec<_>, Vec<_>) = on_surface.into_iter().partition(is_reduced);
        let (seed, whole) = (
            context.problem.seed(),
            Arc::clone(&self.now.curves[0].system),
        );
        self.now.curves.clear();
        if !plain.is_empty() {
            let system = reduced(&whole, &plain, seed).map_or(Arc::clone(&whole), Arc::new);
            self.now.curves.push(Curves {
                system,
                components: plain,
                singular: false,
                found: Vec::new(),
            });
        }
        if !multiple.is_empty() {
            let Some(system) = reduced(&whole, &multiple, seed) else {
                return self.doubt(MULTIPLE);
            };
            let without_deflation = |curve: WitnessSet| WitnessSet {
                deflation: Vec::new(),
                multiplicity: Multiplicity {
                    scheme: Some(1),
                    tracked: 1,
                    dual_dimensions: Vec::new(),
                },
                ..curve
            };
            self.now.curves.push(Curves {
                system: Arc::new(system),
                components: multiple.into_iter().map(without_deflation).collect(),
                singular: false,
                found: Vec::new(),
            });
        }
        self.follow_meeting(context, operand, 0)
    }

    /// Follows the curves of this number, where there are some.
    fn follow_meeting(
        &mut self,
        context: &Context<'_>,
        operand: &Operand,
        number: usize,
    ) -> Option<Job> {
        let Some(curves) = self.now.curves.get(number) else {
            return self.draw(context, operand);
        };
        let along = RealCurves::wished(CurveWish {
            samples: self.samples,
            ..CurveWish::default()
        });
        let options = self.options(context);
        let along = AnyProcedure::RealCurve(Box::new(along));
        match QuestionSolve::begin(&curves.system, &options, &curves.components, along) {
            Ok(solve) => {
                self.phase = Phase::MeetingCurves(number);
                self.child = Some(Child::Curves(Box::new(solve)));
                None
            }
            Err(error) => self.doubt(error.to_string()),
        }
    }

    /// Takes the real part of the curves of this number, and goes on with the next ones.
    pub(super) fn meeting_followed(
        &mut self,
        context: &Context<'_>,
        operand: &Operand,
        number: usize,
        child: Child,
    ) -> Option<Job> {
        self.take_curves(number, child)?;
        self.follow_meeting(context, operand, number + 1)
    }

    /// Writes down the real part that consists of these curves.
    fn draw(&mut self, context: &Context<'_>, operand: &Operand) -> Option<Job> {
        let of_systems: Vec<&[RealCurve]> = self
            .now
            .curves
            .iter()
            .map(|curves| curves.found.as_slice())
            .filter(|curves| !curves.is_empty())
            .collect();
        // Curves of different systems may meet where only one of them has a vertex.
        let is_plain =
            |v: &CurveVertex| matches!(v.kind, VertexKind::Regular | VertexKind::Critical);
        let curves = of_systems.concat();
        let all_plain = curves.iter().flat_map(|c| &c.vertices).all(is_plain);
        let joined = match of_systems.len() < 2 || all_plain {
            true => JoinedCurves::of(&curves),
            false => None,
        };
        let Some(joined) = joined else {
            return self.doubt("whether two curves on it meet is not clear");
        };
        let mut surface = RealSurface {
            id: operand.id,
            degree: operand.degree() as u64,
            compact: joined.compact,
            euler: joined.euler,
            levels: Vec::new(),
            mesh: joined.mesh(context),
            doubts: Vec::new(),
        };
        surface.check();
        self.settle(operand, Some(surface));
        None
    }
}

/// The witness points of a curve in the variables of the problem.
fn given(context: &Context<'_>, curve: &WitnessSet) -> Vec<GivenPoint> {
    let accuracy = (curve.evidence.worst_condition * f64::EPSILON).clamp(LEAST_ERROR, 1e-9);
    let points = curve.points.iter();
    let point = |unknowns: &Vec<Complex64>| GivenPoint {
        values: context.problem.to_variables(unknowns),
        accuracy,
    };
    points.map(point).collect()
}

/// Whether a curve is on the surface that its witness points were asked about: all of it is, or nearly none of it, and
/// so one point that is clear tells; `None` where none is, or two say different things.
fn is_on_surface(witness_points: &[Membership]) -> Option<bool> {
    let on = witness_points.iter().any(|point| !point.on.is_empty());
    let off = |point: &Membership| point.on.is_empty() && point.unsettled.is_empty();
    let off = witness_points.iter().any(off);
    (on != off).then_some(on)
}

/// The graphs of several curves, joined where they meet.
struct JoinedCurves {
    vertices: Vec<Vec<Complex64>>,
    arcs: Vec<CurveEdge>,
    /// Euler characteristic with compact support.
    euler: i64,
    compact: bool,
}

impl JoinedCurves {
    /// The curves with each common vertex once: two of them meet only where both are singular, at vertices; `None`
    /// where two vertices are neither clearly one nor clearly two.
    fn of(curves: &[RealCurve]) -> Option<Self> {
        let mut joined = Self {
            vertices: Vec::new(),
            arcs: Vec::new(),
            euler: 0,
            compact: true,
        };
        for curve in curves {
            let others = joined.vertices.len();
            let mut places = Vec::with_capacity(curve.vertices.len());
            for vertex in &curve.vertices {
                let distances = joined.vertices[..others]
                    .iter()
                    .map(|other| apart(other, &vertex.point));
                let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
                match nearest {
                    Some((place, distance)) if distance <= SAME => places.push(place),
                    Some((_, distance)) if distance <= OTHER => return None,
                    _ => {
                        places.push(joined.vertices.len());
                        joined.vertices.push(vertex.point.clone());
                    }
                }
            }
            for edge in &curve.edges {
                let ends = edge.ends.map(|end| end.map(|vertex| places[vertex]));
                joined.compact &= ends.iter().all(Option::is_some);
                let samples = edge.samples.clone();
                joined.arcs.push(CurveEdge { ends, samples });
            }
        }
        joined.euler = joined.vertices.len() as i64 - joined.arcs.len() as i64;
        Some(joined)
    }

    /// The arcs as segments between their points, in the variables of the problem.
    fn mesh(&self, context: &Context<'_>) -> Mesh {
        let place = |unknowns: &Vec<Complex64>| {
            let point = context.problem.to_variables(unknowns);
            [point[0].re, point[1].re, point[2].re]
        };
        let mut mesh = Mesh {
            vertices: self.vertices.iter().map(place).collect(),
            ..Mesh::default()
        };
        for CurveEdge { ends, samples } in &self.arcs {
            let [first, last] = *ends;
            let inner = mesh.vertices.len()..mesh.vertices.len() + samples.len();
            mesh.vertices.extend(samples.iter().map(place));
            let chain: Vec<usize> = first.into_iter().chain(inner).chain(last).collect();
            let pairs = chain
                .windows(2)
                .map(|pair| [pair[0] as u32, pair[1] as u32]);
            mesh.segments.extend(pairs);
        }
        mesh
    }
}
