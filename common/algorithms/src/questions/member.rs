//! Member: on which components points lie.
//!
//! The slices of a component are moved in parallel until they pass the point; it lies on the component exactly when
//! a path from a witness point ends there (Sommese, Wampler 2005, section 15.4). A point that clearly does
//! not solve the equations is on none, without paths.

use super::context::Context;
use super::error::QuestionError;
use super::procedure::{GivenSystem, Procedure};
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use crate::decomposition::problem::Known;
use cognate_continuation::bend::{doubles_of, exactly};
use cognate_continuation::path_result::PathResult;
use cognate_solutions::classification::{Decision, Verdict};
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::{Membership, Near};
use cognate_solutions::witness::question::GivenPoint;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Most points in one question.
const MOST_POINTS: usize = 100_000;
/// A point is an end of a path within this many times the errors of both.
const SAME: f64 = 8.0;
/// A point is not the end of a path beyond this many times the errors of both.
const OTHER: f64 = 1e3;
/// Errors above this tell nothing.
const FAR: f64 = 1e-3;
/// A singular end is known to this part of its size at best: the root of a double's rounding error.
const SINGULAR_ERROR: f64 = 1e-7;

/// Whether a point is on a component.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    On,
    Off,
    /// Neither, at this distance; `None` where a path failed.
    Unclear(Option<f64>),
}

/// Point by point, component by component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Member {
    points: Vec<GivenPoint>,
    /// Memberships of the points so far; none before the equations were evaluated.
    memberships: Vec<Membership>,
    operand: usize,
    /// The point where the stage after this one begins, and the points of the open stage.
    next: usize,
    open: Vec<usize>,
}

/// The points of a question, each with a value for each variable.
pub(super) fn checked(system: &System, points: &[GivenPoint]) -> Result<(), QuestionError> {
    let wrong = |value, expected| QuestionError::wish("points", value, expected);
    if points.is_empty() || points.len() > MOST_POINTS {
        let expected = format!("1 to {MOST_POINTS}");
        return Err(wrong(format!("{} points", points.len()), expected));
    }
    let n = system.variables.len();
    for (k, point) in points.iter().enumerate() {
        let finite = point
            .values
            .iter()
            .all(|z| z.re.is_finite() && z.im.is_finite());
        if point.values.len() != n || !finite {
            let description = format!("point {} has {} values", k + 1, point.values.len());
            return Err(wrong(description, format!("{n} finite ones")));
        }
        if !(0.0..1.0).contains(&point.accuracy) {
            let description = format!("accuracy {} of point {}", point.accuracy, k + 1);
            return Err(wrong(description, "at least 0, less than 1".to_owned()));
        }
    }
    Ok(())
}

impl Procedure for Member {
    fn advance(&mut self, context: &mut Context<'_>, done: Option<Job>) -> Option<Job> {
        if self.memberships.is_empty() {
            self.memberships = self.evaluated(context);
        }
        if let Some(job) = done {
            self.learn(context, &job);
        }
        self.next_stage(context)
    }

    fn answer(&mut self, _: &GivenSystem<'_>) -> Answer {
        Answer::Member(self.take())
    }

    fn description(&self) -> &'static str {
        "moving slices through points"
    }
}

impl Member {
    pub fn new(system: &System, points: &[GivenPoint]) -> Result<Self, QuestionError> {
        checked(system, points)?;
        Ok(Self {
            points: points.to_vec(),
            memberships: Vec::new(),
            operand: 0,
            next: 0,
            open: Vec::new(),
        })
    }

    /// Memberships of all points, when all is known.
    pub fn take(&mut self) -> Vec<Membership> {
        std::mem::take(&mut self.memberships)
    }

    /// Memberships of the points as far as the equations decide them.
    fn evaluated(&self, context: &Context<'_>) -> Vec<Membership> {
        let each = self.points.iter().enumerate();
        each.map(|(index, point)| {
            let values = context.problem.to_unknowns(&point.values);
            let exact: Vec<_> = values.iter().map(|&z| exactly(z)).collect();
            let thresholds = Known::to_accuracy(point.accuracy);
            Membership {
                index: index as u64,
                on: Vec::new(),
                unsettled: Vec::new(),
                solves: context.problem.solves(&exact, &thresholds),
            }
        })
        .collect()
    }

    fn next_stage(&mut self, context: &mut Context<'_>) -> Option<Job> {
        loop {
            let operand = context.operands.get(self.operand)?;
            let most = operand.most_targets();
            self.open.clear();
            while self.next < self.points.len() && self.open.len() < most {
                let point = self.next;
                self.next += 1;
                if self.memberships[point].solves == Some(false) {
                    continue;
                }
                match operand.dimension() {
                    0 => {
                        let place = self.beside(context, operand, point);
                        take(&mut self.memberships[point], operand, place);
                    }
                    _ => self.open.push(point),
                }
            }
            if !self.open.is_empty() {
                let through = |&k: &usize| {
                    operand.slices_through(&context.problem.to_unknowns(&self.points[k].values))
                };
                let targets = self.open.iter().map(through).collect();
                return Some(operand.moved_to(&mut context.of_components(), targets));
            }
            if self.next == self.points.len() {
                self.operand += 1;
                self.next = 0;
            }
        }
    }

    fn learn(&mut self, context: &mut Context<'_>, job: &Job) {
        let Some(operand) = context.operands.get(self.operand) else {
            return;
        };
        let ends = job.ends();
        for (&point, ends) in self.open.iter().zip(ends.chunks(operand.degree())) {
            let place = self.nearest(context, operand, point, ends);
            take(&mut self.memberships[point], operand, place);
        }
    }

    /// Whether the point is an isolated one.
    fn beside(&self, context: &Context<'_>, operand: &Operand, point: usize) -> Place {
        let given = &self.points[point];
        let values = context.problem.to_unknowns(&given.values);
        let refined = &operand.set.points[0];
        let isolated_point = doubles_of(&refined.point[..context.problem.variables()]);
        let error = given.accuracy + f64::EPSILON;
        judge(
            distance(&values, &isolated_point),
            SAME * error,
            OTHER * error,
        )
    }

    fn nearest(
        &self,
        context: &mut Context<'_>,
        operand: &Operand,
        point: usize,
        ends: &[(&PathResult, Decision, Vec<Complex64>)],
    ) -> Place {
        let given = &self.points[point];
        let values = context.problem.to_unknowns(&given.values);
        let mut answer = Place::Off;
        for (result, decision, end) in ends {
            let regular = match decision.verdict {
                Verdict::AtInfinity => continue,
                Verdict::Failed | Verdict::WithinDataAccuracy => {
                    if answer == Place::Off {
                        answer = Place::Unclear(None);
                    }
                    continue;
                }
                verdict => verdict == Verdict::Finite,
            };
            let end_values = &end[..values.len()];
            let apart = distance(&values, end_values);
            if apart > FAR {
                continue;
            }
            match self.compare(
                context,
                (operand, given),
                &values,
                end_values,
                (result, regular),
            ) {
                Place::On => return Place::On,
                Place::Off => {}
                unclear => answer = unclear,
            }
        }
        answer
    }

    /// Whether an end that is near the point is the point.
    fn compare(
        &self,
        context: &mut Context<'_>,
        (operand, given): (&Operand, &GivenPoint),
        values: &[Complex64],
        end: &[Complex64],
        (result, regular): (&PathResult, bool),
    ) -> Place {
        let through = operand.slices_through(values);
        let on = (through.as_slice(), operand.set.ranks.as_slice());
        let refined = match regular {
            true => context
                .deflations
                .points_on(context.problem, on, &[end.to_vec()])
                .pop()
                .flatten(),
            false => None,
        };
        let accuracy = given.accuracy.max(f64::EPSILON);
        match refined {
            Some(refined) => {
                // The slice passes the point only as exactly as that is known, and the end moves with the slice.
                let refined_values = doubles_of(&refined.point[..values.len()]);
                let error = accuracy * (1.0 + refined.condition);
                let apart = distance(values, &refined_values);
                judge(apart, SAME * error, OTHER * error)
            }
            None => {
                let root = accuracy.sqrt();
                let error = result.accuracy.max(root).max(SINGULAR_ERROR);
                judge(distance(values, end), SAME * error, OTHER * error)
            }
        }
    }
}

fn take(membership: &mut Membership, operand: &Operand, place: Place) {
    match place {
        Place::On => membership.on.push(operand.id),
        Place::Off => {}
        Place::Unclear(distance) => membership.unsettled.push(Near {
            id: operand.id,
            distance,
        }),
    }
}

fn judge(apart: f64, same: f64, other: f64) -> Place {
    match () {
        () if apart <= same && same <= FAR => Place::On,
        () if apart > other.min(FAR).max(same) => Place::Off,
        () => Place::Unclear(Some(apart)),
    }
}

/// Distance relative to the size of the first, or to 1.
fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let (mut apart, mut size) = (0.0, 1.0f64);
    for (x, y) in a.iter().zip(b) {
        apart += (x - y).norm_sqr();
        size += x.norm_sqr();
    }
    (apart / size).sqrt()
}
