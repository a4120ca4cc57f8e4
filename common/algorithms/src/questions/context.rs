//! Context: the problems that a question works with, made of the system and the components that were given.

use super::error::QuestionError;
use crate::decomposition::DecompositionOptions;
use crate::decomposition::deflated::{Deflations, ProblemContext};
use crate::decomposition::operand::{Operand, TrackedSet};
use crate::decomposition::problem::Problem;
use cognate_solutions::witness::WitnessSet;
use cognate_solutions::witness::question::SecondSet;
use cognate_systems::system::System;
use std::sync::Arc;

/// Problems of a question. They are not written down: they are made again when the question is read back.
#[derive(Clone, Debug)]
pub(super) struct Problems {
    /// The components, with the equations that they are of.
    first: TrackedSet,
    /// All equations.
    whole: Arc<Problem>,
    whole_deflations: Deflations,
    second: Option<TrackedSet>,
}

impl Problems {
    /// Problems of a question to these components, with a second set or without one.
    pub fn new(
        system: &System,
        options: &DecompositionOptions,
        components: &[WitnessSet],
        second: Option<&SecondSet>,
    ) -> Result<Self, QuestionError> {
        let whole = Arc::new(Problem::of_options(system, options)?);
        let equation_count = system.equations.len();
        let problem = match second.map(|second| second.own as usize) {
            Some(count) if count < equation_count => Arc::new(whole.part(|i| i < count)?),
            _ => Arc::clone(&whole),
        };
        let first = TrackedSet::new(problem, components)?;
        let second = match second.filter(|second| !second.components.is_empty()) {
            Some(second) => {
                let problem = match second.from as usize {
                    0 => Arc::clone(&whole),
                    from => Arc::new(whole.part(|i| i >= from)?),
                };
                Some(TrackedSet::new(problem, &second.components)?)
            }
            None => None,
        };
        Ok(Self {
            first,
            whole,
            whole_deflations: Deflations::default(),
            second,
        })
    }

    /// The problems as a procedure sees them.
    pub fn context(&mut self) -> Context<'_> {
        Context {
            problem: &self.first.problem,
            operands: &self.first.operands,
            deflations: &mut self.first.deflations,
            whole: &self.whole,
            whole_deflations: &mut self.whole_deflations,
            other: self.second.as_mut(),
        }
    }
}

impl Context<'_> {
    /// Problem of the equations that the components are of, and its deflations.
    pub fn of_components(&mut self) -> ProblemContext<'_> {
        ProblemContext {
            problem: self.problem,
            deflations: self.deflations,
        }
    }

    /// Problem of all equations, and its deflations.
    pub fn of_whole(&mut self) -> ProblemContext<'_> {
        ProblemContext {
            problem: self.whole,
            deflations: self.whole_deflations,
        }
    }
}

/// Problems and components that a procedure works with.
pub(super) struct Context<'a> {
    /// Problem of the equations that the components are of.
    pub problem: &'a Problem,
    /// The components.
    pub operands: &'a [Operand],
    pub deflations: &'a mut Deflations,
    /// Problem of all equations, if the components are not of all.
    pub whole: &'a Problem,
    pub whole_deflations: &'a mut Deflations,
    /// Components of a second set.
    pub other: Option<&'a mut TrackedSet>,
}
