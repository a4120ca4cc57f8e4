//! Real points: at least one on every connected part of the real points of each component.
//!
//! On each connected part a point has the least distance to a random real one. Where the equations have their rank
//! there, the distance is critical; else the point is on the singular locus (Hauenstein: Numerically computing real
//! points on algebraic sets, Acta Appl. Math. 125, 2013; after Seidenberg, 1954). Polars cut out both together. Their
//! isolated points are tested for reality. A linear singular set of higher dimension has a real point in the middle of
//! a witness point and its conjugate; other singular sets are named.

use super::context::Context;
use super::denominators::keep_real_points;
use super::locus::{Locus, Wanted, apart};
use super::procedure::{GivenSystem, Procedure};
use crate::decomposition::deflated::doubles;
use crate::decomposition::job::{Job, StageSystem};
use crate::decomposition::operand::Operand;
use cognate_continuation::bend::{doubles_of, exactly};
use cognate_numeric::counted::counted;
use cognate_solutions::classification::Verdict;
use cognate_solutions::witness::answer::{RealPoint, RealPoints as Found};
use cognate_solutions::witness::{Answer, ComponentId, WitnessSet};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A regular point, whose digits are known, is real within this, relative to its size.
const REAL: f64 = 1e-11;
/// A singular point is real within this, relative to its size.
const REAL_SINGULAR: f64 = 1e-5;
/// Points that are neither clearly real nor clearly not are farther from their conjugates than real ones, by at most
/// this factor.
const CLEAR: f64 = 1e2;
/// A conjugate of a point of a linear set is on the set within this.
const BACK: f64 = 1e-8;
/// Said where a path did not end.
const NOT_CLEAR: &str = "whether a linear set is its own conjugate is not clear";

/// Step of the work on the current component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
enum Phase {
    #[default]
    Begin,
    /// Whether the conjugate of a linear component's point is on the component.
    Mirror,
    Locus(Box<Locus>),
    /// Whether conjugates of the points of linear singular sets are on the sets, the last set first.
    Singular {
        sets: Vec<WitnessSet>,
        points: Vec<RealPoint>,
        doubts: Vec<String>,
    },
}

/// Component by component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct RealPoints {
    phase: Phase,
    found: Vec<Found>,
}

impl Procedure for RealPoints {
    fn advance(&mut self, context: &mut Context<'_>, mut done: Option<Job>) -> Option<Job> {
        loop {
            let place = self.found.len();
            let operand = context.operands.get(place)?;
            let job = match (&mut self.phase, done.take()) {
                (Phase::Begin, _) => self.begin(context, operand),
                (Phase::Mirror, Some(job)) => {
                    self.mirrored(context, operand, &job);
                    None
                }
                (Phase::Mirror, None) => unreachable!("it waits for a stage"),
                (Phase::Locus(locus), job) => {
                    let next = locus.advance(context, job);
                    if next.is_none() {
                        self.collect(context);
                    }
                    next
                }
                (Phase::Singular { .. }, job) => self.singular(context, operand, job.as_ref()),
            };
            if job.is_some() {
                return job;
            }
        }
    }

    fn answer(&mut self, given: &GivenSystem<'_>) -> Answer {
        Answer::RealPoints(given.take_solutions(&mut self.found, keep_real_points))
    }

    fn description(&self) -> &'static str {
        match &self.phase {
            Phase::Locus(locus) => locus.description(),
            Phase::Begin | Phase::Mirror | Phase::Singular { .. } => "looking for real points",
        }
    }

    fn system_of(&mut self, context: &mut Context<'_>, wanted: &StageSystem) -> Arc<System> {
        match &mut self.phase {
            Phase::Locus(locus) => locus.system_of(context, wanted),
            Phase::Begin | Phase::Mirror | Phase::Singular { .. } => {
                context.of_components().system(wanted)
            }
        }
    }
}

impl RealPoints {
    fn settle(&mut self, id: ComponentId, points: Vec<RealPoint>, doubts: Vec<String>) {
        self.phase = Phase::Begin;
        self.found.push(Found { id, points, doubts });
    }

    fn begin(&mut self, context: &mut Context<'_>, operand: &Operand) -> Option<Job> {
        let Some(involution) = &context.problem.involution else {
            let doubt = "complex conjugation does not map solutions to solutions";
            self.settle(operand.id, Vec::new(), vec![doubt.into()]);
            return None;
        };
        if operand.dimension() > 0 && operand.degree() == 1 {
            self.phase = Phase::Mirror;
            let variable_count = context.problem.variables();
            let image = involution.image(&operand.set.doubles()[0][..variable_count]);
            let through = vec![operand.slices_through(&image)];
            return Some(operand.moved_to(&mut context.of_components(), through));
        }
        self.cut(operand)
    }

    fn cut(&mut self, operand: &Operand) -> Option<Job> {
        let place = self.found.len();
        if operand.dimension() > 0 && !operand.set.ranks.is_empty() {
            let doubt = "it is multiple and not linear: its real points are not searched";
            self.settle(operand.id, Vec::new(), vec![doubt.into()]);
            return None;
        }
        let locus = Locus::new(Wanted::Critical, place..place + 1);
        self.phase = Phase::Locus(Box::new(locus));
        None
    }

    /// A linear component that is its own conjugate has a point in the middle of one of its points and the conjugate.
    fn mirrored(&mut self, context: &mut Context<'_>, operand: &Operand, job: &Job) {
        match self.real_of_linear(context, operand, job) {
            Some(Some(point)) => self.settle(operand.id, vec![point], Vec::new()),
            Some(None) => {
                self.cut(operand);
            }
            None => self.settle(operand.id, Vec::new(), vec![NOT_CLEAR.into()]),
        }
    }

    /// A real point of a linear set, from the path to a slice through the conjugate of its witness point: none where
    /// the set is not its own conjugate; `None` where that is not clear.
    fn real_of_linear(
        &self,
        context: &Context<'_>,
        operand: &Operand,
        job: &Job,
    ) -> Option<Option<RealPoint>> {
        let variable_count = context.problem.variables();
        let point = &operand.set.doubles()[0][..variable_count];
        let image = context.problem.involution.as_ref()?.image(point);
        let ends = job.ends();
        let (_, decision, end) = ends.first()?;
        if decision.verdict != Verdict::Finite {
            return None;
        }
        let back = apart(&image, &end[..variable_count]) <= BACK;
        let regular = operand.set.ranks.is_empty();
        Some(back.then(|| self.middle(context, point, regular)))
    }

    /// Asks linear sets of singular points one after the other.
    fn singular(
        &mut self,
        context: &mut Context<'_>,
        component: &Operand,
        job: Option<&Job>,
    ) -> Option<Job> {
        let phase = std::mem::replace(&mut self.phase, Phase::Begin);
        let Phase::Singular {
            mut sets,
            mut points,
            mut doubts,
        } = phase
        else {
            unreachable!("singular sets are asked")
        };
        let operand = |context: &mut Context<'_>, set: &WitnessSet| {
            Operand::new(&mut context.of_components(), set)
        };
        if let Some(job) = job
            && let Some(set) = sets.pop()
        {
            let made = operand(context, &set).ok();
            match made.and_then(|operand| self.real_of_linear(context, &operand, job)) {
                Some(Some(point)) => points.push(point),
                Some(None) => doubts.push(not_searched(&set)),
                None => doubts.push(NOT_CLEAR.into()),
            }
        }
        while let Some(set) = sets.last() {
            if set.settled()
                && set.degree == 1
                && let Ok(operand) = operand(context, set)
                && let Some(involution) = &context.problem.involution
            {
                let variable_count = context.problem.variables();
                let image = involution.image(&operand.set.doubles()[0][..variable_count]);
                let through = vec![operand.slices_through(&image)];
                self.phase = Phase::Singular {
                    sets,
                    points,
                    doubts,
                };
                return Some(operand.moved_to(&mut context.of_components(), through));
            }
            doubts.push(not_searched(set));
            sets.pop();
        }
        points.sort_by(|a, b| {
            let key = |p: &RealPoint| p.point.iter().map(|z| z.re).collect::<Vec<f64>>();
            let pairs = key(a).into_iter().zip(key(b));
            let mut orders = pairs.map(|(a, b)| a.total_cmp(&b));
            let first = orders.find(|order| order.is_ne());
            first.unwrap_or(std::cmp::Ordering::Equal)
        });
        self.settle(component.id, points, doubts);
        None
    }

    /// The middle of a point, in unknowns, and its conjugate.
    fn middle(&self, context: &Context<'_>, point: &[Complex64], regular: bool) -> RealPoint {
        let image = match &context.problem.involution {
            Some(involution) => involution.image(point),
            None => point.to_vec(),
        };
        let pairs = point.iter().zip(&image);
        let middle: Vec<Complex64> = pairs.map(|(a, b)| 0.5 * (a + b)).collect();
        RealPoint {
            point: context.problem.to_variables(&middle),
            regular,
        }
    }

    /// The real ones among the points of the locus.
    fn collect(&mut self, context: &mut Context<'_>) {
        let Phase::Locus(locus) = &mut self.phase else {
            unreachable!("a locus is there")
        };
        let (ends, problem) = locus.take_points(context);
        let mut doubts = std::mem::take(&mut locus.doubts);
        let variables = vec![String::new(); context.problem.variables()];
        let locus = locus.take(&variables);
        let (lost, unclear) = (ends.failed, ends.unclear);
        if lost > 0 {
            doubts.push(format!(
                "{} to critical points failed",
                counted(lost, "path")
            ));
        }
        if unclear > 0 {
            doubts.push(format!(
                "whether {unclear} ends are critical points is not clear"
            ));
        }
        let equations = problem.map(|problem| problem.level_equations(0));
        let mut points: Vec<RealPoint> = Vec::new();
        for end in &ends.singular {
            let start: Vec<_> = end.values.iter().map(|&z| exactly(z)).collect();
            let refined = equations
                .as_ref()
                .and_then(|equations| equations.refine(&start));
            let refined = refined.filter(|refined| {
                refined.condition < 1e10 && refined.correction < 1e-20 && refined.moved < 1e-4
            });
            let (point, regular, exact) = match refined {
                Some(refined) => (doubles_of(&refined.point), true, true),
                // An isolated component, or a singular point that is regular for deflated equations.
                None => match context.deflations.regular_point(context.problem, 0, end) {
                    Some(regular_point) => {
                        let variable_count = context.problem.variables();
                        (
                            doubles(&regular_point.refined, variable_count),
                            regular_point.is_reduced(),
                            true,
                        )
                    }
                    None => (end.values.clone(), false, false),
                },
            };
            let Some(involution) = &context.problem.involution else {
                continue;
            };
            let distance = apart(&point, &involution.image(&point));
            let within = if exact { REAL } else { REAL_SINGULAR };
            if distance > within * CLEAR {
                continue;
            }
            if distance > within {
                doubts.push("a point is neither clearly real nor clearly not".into());
                continue;
            }
            let real_point = self.middle(context, &point, regular);
            let same = |listed_point: &RealPoint| {
                apart(&listed_point.point, &real_point.point) < REAL_SINGULAR
            };
            if !points.iter().any(same) {
                points.push(real_point);
            }
        }
        for dimension in &locus.dimensions {
            let number = dimension.number;
            let said = dimension.doubts.iter();
            doubts
                .extend(said.map(|doubt| format!("singular points, dimension {number}: {doubt}")));
        }
        self.phase = Phase::Singular {
            sets: locus.components,
            points,
            doubts,
        };
    }
}

/// Doubt about a set of singular points that is not searched.
fn not_searched(set: &WitnessSet) -> String {
    let (dimension, degree) = (set.dimension(), set.degree);
    format!(
        "real points of a singular set of dimension {dimension} and degree {degree} are not searched"
    )
}
