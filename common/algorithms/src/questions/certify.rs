//! Certify: which witness points are proved, and whether they are proved to be different.
//!
//! Krawczyk's test on as many combinations of the equations as are tracked, with the slice: in each box is exactly one
//! solution of them. That the other equations hold there, too, is what traces and residuals say; it is not proved.

use super::context::Context;
use super::procedure::{GivenSystem, Procedure};
use crate::decomposition::job::Job;
use crate::decomposition::proof::certificate;
use cognate_continuation::certification::Certificate;
use cognate_solutions::certificates::{Distinctness, Groups, judge};
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::CertifiedComponent;
use serde::{Deserialize, Serialize};

/// Component by component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Certify {
    found: Vec<CertifiedComponent>,
}

impl Procedure for Certify {
    fn advance(&mut self, context: &mut Context<'_>, done: Option<Job>) -> Option<Job> {
        if let Some(job) = done {
            let operand = &context.operands[self.found.len()];
            let proved = job.answers().iter().filter_map(certificate);
            let proved: Vec<&Certificate> = proved.collect();
            self.found.push(CertifiedComponent {
                id: operand.id,
                points: operand.degree() as u64,
                certified: proved.len() as u64,
                distinct: are_different(&proved, context),
            });
        }
        let operand = context.operands.get(self.found.len())?;
        let fibre = (operand.slices.concat(), operand.set.doubles());
        let tracking = &context.problem.tracking;
        Some(Job::certify(operand.set.tracked(), &[fibre], tracking))
    }

    fn answer(&mut self, _: &GivenSystem<'_>) -> Answer {
        Answer::Certify(std::mem::take(&mut self.found))
    }

    fn description(&self) -> &'static str {
        "proving witness points"
    }
}

/// The unknowns of what is proved: all are affine.
pub(super) fn affine(proved: &[&Certificate]) -> Groups {
    let count = proved.first().map_or(0, |first| first.dimension());
    Groups {
        homogeneous: Vec::new(),
        affine: (0..count).collect(),
    }
}

/// Whether no two solutions can be the same.
fn are_different(proved: &[&Certificate], context: &Context<'_>) -> bool {
    let verdicts = judge(proved, &affine(proved), context.problem.seed());
    verdicts
        .iter()
        .all(|&verdict| verdict == Distinctness::Proved)
}
