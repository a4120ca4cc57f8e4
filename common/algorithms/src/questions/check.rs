//! Check: whether components that were read are whole, by the sums of their second derivatives, and whether their
//! multiplicities are those of the equations.

use super::context::Context;
use super::procedure::{GivenSystem, Procedure};
use crate::decomposition::job::{Job, StageSystem};
use crate::decomposition::moved::{MovedPoints, is_closed};
use crate::decomposition::operand::Operand;
use cognate_continuation::bend::{Bend, doubles_of};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::local_dimension::Question;
use cognate_continuation::local_dimension::candidates::{Candidate, to_stored};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::{Isolation, isolation_by};
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::CheckedComponent;
use serde::{Deserialize, Serialize};

/// Highest order of functionals that are asked for.
const DEPTH: u32 = 12;

/// Component by component: how its points move, and how often one of them counts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Check {
    found: Vec<CheckedComponent>,
    state: State,
}

/// State of the check of the next component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
enum State {
    /// Nothing has been asked.
    #[default]
    Begin,
    /// Derivatives of the witness points are asked.
    Derivatives,
    /// The multiplicity of the component is asked; the rest is known.
    Multiplicity(CheckedComponent),
}

impl Procedure for Check {
    fn advance(&mut self, context: &mut Context<'_>, mut done: Option<Job>) -> Option<Job> {
        loop {
            let operand = context.operands.get(self.found.len())?;
            let component = match (std::mem::take(&mut self.state), done.take()) {
                (State::Derivatives, Some(job)) => by_derivatives(context, operand, &job),
                (State::Multiplicity(component), Some(job)) => {
                    let multiplicity = multiplicity(context, &job);
                    self.found.push(CheckedComponent {
                        multiplicity,
                        ..component
                    });
                    continue;
                }
                _ if operand.dimension() > 0 => {
                    self.state = State::Derivatives;
                    return Some(bend(context, operand));
                }
                _ => CheckedComponent {
                    id: operand.id,
                    trace: None,
                    closed: true,
                    multiplicity: Some(1),
                },
            };
            if !operand.set.ranks.is_empty() {
                self.state = State::Multiplicity(component);
                return Some(count(context, operand));
            }
            self.found.push(component);
        }
    }

    fn answer(&mut self, _: &GivenSystem<'_>) -> Answer {
        Answer::Check(std::mem::take(&mut self.found))
    }

    fn description(&self) -> &'static str {
        "checking witness points"
    }
}

/// A component by the derivatives of its witness points, as one of multiplicity 1.
fn by_derivatives(context: &Context<'_>, operand: &Operand, job: &Job) -> CheckedComponent {
    let bends: Vec<&Bend> = job.answers().iter().filter_map(bend_of).collect();
    let mut moved = MovedPoints::with_capacity(bends.len(), context.problem.variables());
    bends.iter().for_each(|bend| moved.push(Some(*bend)));
    let trace = moved.whole();
    CheckedComponent {
        id: operand.id,
        closed: bends.len() == operand.degree() && is_closed(&trace),
        trace: Some(trace),
        multiplicity: Some(1),
    }
}

/// Multiplicity of an isolated point by its dual space; `None` where that does not tell.
fn multiplicity(context: &Context<'_>, job: &Job) -> Option<u64> {
    let Some(ItemResult::LocalDimension(result)) = job.answers().first() else {
        return None;
    };
    match isolation_by(result.fact()?, &context.problem.tracking.tolerances) {
        Isolation::Isolated { multiplicity } => Some(u64::from(multiplicity)),
        _ => None,
    }
}

fn bend_of(result: &ItemResult) -> Option<&Bend> {
    match result {
        ItemResult::Bend(result) => result.fact().map(|bend| &**bend),
        _ => None,
    }
}

/// The stage that asks how the points move when the constants of the slices do.
fn bend(context: &Context<'_>, operand: &Operand) -> Job {
    let problem = context.problem;
    let mut random = RandomStream::new(problem.seed(), Purpose::Question, 0);
    let mut moved = operand.slices.clone();
    for row in &mut moved {
        row[0] += random.unit();
    }
    let ends = [operand.slices.concat(), moved.concat()];
    let points = operand.set.doubles();
    Job::bend(operand.set.whole(), ends, &points, &problem.tracking)
}

/// The stage that asks the dual space of the first witness point.
fn count(context: &Context<'_>, operand: &Operand) -> Job {
    let problem = context.problem;
    let point = &operand.set.points[0].point[..problem.variables()];
    let candidate = Candidate {
        values: doubles_of(point),
        target: 0,
        question: Question {
            accuracy: f64::EPSILON,
            bound: u64::MAX,
            depth: DEPTH,
        },
    };
    let system = StageSystem::Sliced {
        dimension: operand.dimension(),
    };
    let parameters = operand.slices.concat();
    Job::isolate(
        system,
        parameters,
        to_stored(&[candidate]),
        &problem.tracking,
    )
}
