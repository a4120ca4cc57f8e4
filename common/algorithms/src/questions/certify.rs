//! Certify: which witness points are proved, and whether they are proved to be different.
//!
//! Krawczyk's test on as many combinations of the equations as are tracked, with the slice: in each box is exactly one
//! solution of them. That the other equations hold there, too, is what traces and residuals say; it is not proved.

use super::Context;
use crate::decomposition::job::Job;
use cognate_continuation::certification::Certificate;
use cognate_continuation::item_result::ItemResult;
use cognate_numeric::rational::Rational;
use cognate_solutions::witness::answer::CertifiedComponent;
use serde::{Deserialize, Serialize};

/// Component by component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Certify {
    found: Vec<CertifiedComponent>,
}

impl Certify {
    pub fn advance(&mut self, with: &mut Context<'_>, done: Option<&Job>) -> Option<Job> {
        if let Some(job) = done {
            let operand = &with.operands[self.found.len()];
            let proved = job.answers().iter().filter_map(certificate);
            let proved: Vec<&Certificate> = proved.collect();
            self.found.push(CertifiedComponent {
                id: operand.id,
                points: operand.degree() as u64,
                certified: proved.len() as u64,
                distinct: are_different(&proved),
            });
        }
        let operand = with.operands.get(self.found.len())?;
        let (slices, points) = (operand.slices.concat(), operand.set.doubles());
        let tracking = &with.problem.tracking;
        Some(Job::certify(
            operand.set.tracked(),
            slices,
            &points,
            tracking,
        ))
    }

    pub fn take(&mut self) -> Vec<CertifiedComponent> {
        std::mem::take(&mut self.found)
    }
}

fn certificate(result: &ItemResult) -> Option<&Certificate> {
    match result {
        ItemResult::Certify(result) => result.fact().and_then(|fact| fact.certificate()),
        _ => None,
    }
}

/// Whether no two solutions can be the same: in some coordinate their centres are farther apart than their errors.
fn are_different(proved: &[&Certificate]) -> bool {
    let exact = |x: f64| Rational::from_f64(x).unwrap_or_default();
    let apart = |a: &Certificate, b: &Certificate, v: usize| {
        let errors = exact(a.error[v]) + exact(b.error[v]);
        let (a, b) = (&a.centre[v], &b.centre[v]);
        let re = Rational::from(&a.re - &b.re).abs();
        let im = Rational::from(&a.im - &b.im).abs();
        re > errors || im > errors
    };
    let mut order: Vec<&&Certificate> = proved.iter().collect();
    order.sort_by(|a, b| a.centre[0].re.cmp(&b.centre[0].re));
    let widest = proved.iter().map(|c| c.error[0]).fold(0.0, f64::max);
    for (k, a) in order.iter().enumerate() {
        for b in &order[k + 1..] {
            let ahead = Rational::from(&b.centre[0].re - &a.centre[0].re);
            if ahead > exact(2.0 * widest) {
                break;
            }
            if !(0..a.dimension()).any(|v| apart(a, b, v)) {
                return false;
            }
        }
    }
    true
}
