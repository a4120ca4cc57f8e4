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
    /// The multiplicity of the last one found is being asked.
    counting: bool,
    bending: bool,
}

impl Procedure for Check {
    fn advance(&mut self, context: &mut Context<'_>, done: Option<Job>) -> Option<Job> {
        if let Some(job) = done {
            self.learn(context, &job);
        }
        if let Some(last) = self.found.len().checked_sub(1)
            && self.counting
        {
            return Some(count(context, &context.operands[last]));
        }
        while let Some(operand) = context.operands.get(self.found.len()) {
            if operand.dimension() > 0 {
                self.bending = true;
                return Some(bend(context, operand));
            }
            self.found.push(CheckedComponent {
                id: operand.id,
                trace: None,
                closed: true,
                multiplicity: Some(1),
            });
            if !operand.set.ranks.is_empty() {
                self.counting = true;
                return Some(count(context, operand));
            }
        }
        None
    }

    fn answer(&mut self, _: &GivenSystem<'_>) -> Answer {
        Answer::Check(std::mem::take(&mut self.found))
    }

    fn description(&self) -> &'static str {
        "checking witness points"
    }
}

impl Check {
    fn learn(&mut self, context: &Context<'_>, job: &Job) {
        if self.bending {
            self.bending = false;
            let operand = &context.operands[self.found.len()];
            let bends: Vec<&Bend> = job.answers().iter().filter_map(bend_of).collect();
            let mut moved = MovedPoints::with_capacity(bends.len(), context.problem.variables());
            bends.iter().for_each(|bend| moved.push(Some(*bend)));
            let trace = moved.whole();
            self.found.push(CheckedComponent {
                id: operand.id,
                closed: bends.len() == operand.degree() && is_closed(&trace),
                trace: Some(trace),
                multiplicity: Some(1),
            });
            self.counting = !operand.set.ranks.is_empty();
            return;
        }
        self.counting = false;
        let Some(checked_component) = self.found.last_mut() else {
            return;
        };
        let fact = job.answers().first().and_then(|result| match result {
            ItemResult::LocalDimension(result) => result.fact(),
            _ => None,
        });
        let isolation = fact.map(|fact| isolation_by(fact, &context.problem.tracking.tolerances));
        checked_component.multiplicity = match isolation {
            Some(Isolation::Isolated { multiplicity }) => Some(u64::from(multiplicity)),
            _ => None,
        };
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
