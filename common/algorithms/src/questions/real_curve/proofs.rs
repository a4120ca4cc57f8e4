//! Proofs: of how many real branches a curve has over each slab, by Krawczyk's test of all points of a fibre in it.

use super::super::certify::affine;
use super::super::context::Context;
use super::traced::row_of;
use super::{Phase, RealCurves};
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use crate::decomposition::proof::certificate;
use cognate_solutions::certificates::{Distinctness, judge, judge_reality};
use cognate_solutions::involution::Involution;
use cognate_solutions::witness::real_curve::ProvedFibre;
use cognate_systems::system::System;

impl RealCurves {
    /// The stage that tests the points of all fibres.
    pub(super) fn prove(&mut self, context: &mut Context<'_>, operand: &Operand) -> Option<Job> {
        let tracing = &self.now;
        let fibres: Vec<_> = tracing
            .middles
            .iter()
            .zip(&tracing.fibres)
            .map(|(&middle, fibre)| {
                let points = fibre.iter().map(|p| p.point.clone()).collect();
                (row_of(&tracing.form, middle), points)
            })
            .collect();
        self.phase = Phase::Proofs;
        let tracking = &context.problem.tracking;
        Some(Job::certify(operand.set.tracked(), &fibres, tracking))
    }

    /// Takes in the proofs of each fibre, and notes the fibres that are not proved.
    pub(super) fn proved(
        &mut self,
        context: &mut Context<'_>,
        operand: &Operand,
        job: &Job,
    ) -> Option<Job> {
        // Combinations of real equations are real; where conjugation exchanges equations they need not be.
        let tracked = context
            .deflations
            .of_stage(context.problem, &operand.set.tracked());
        let system = System {
            conjugates: context.problem.given.conjugates.clone(),
            ..(*tracked).clone()
        };
        let row = row_of(&self.now.form, self.now.middles[0]);
        let involution = Involution::of(&system, &row).ok();
        let mut unproved = 0;
        let answers = job.answers();
        let fibres = self.now.fibres.iter().zip(&self.now.middles);
        for ((fibre, &value), answers) in fibres.zip(answers.chunks(operand.degree())) {
            let proved: Vec<_> = answers.iter().filter_map(certificate).collect();
            let groups = affine(&proved);
            let different = judge(&proved, &groups, context.problem.seed());
            let different = proved.iter().zip(different);
            let different = different.filter(|(_, d)| *d == Distinctness::Proved);
            let reality: Vec<Option<bool>> = different
                .map(|(c, _)| judge_reality(c, &groups, involution.as_ref()?))
                .collect();
            let count =
                |wanted: bool| reality.iter().filter(|r| **r == Some(wanted)).count() as u64;
            let proved_fibre = ProvedFibre {
                value,
                different: reality.len() as u64,
                real: count(true),
                not_real: count(false),
            };
            let counted = fibre.iter().filter(|p| p.real).count() as u64;
            if proved_fibre.is_complete(operand.degree() as u64) && proved_fibre.real != counted {
                let real = proved_fibre.real;
                return self.doubt(format!(
                    "{counted} points over {value:.6} were taken for real, and {real} are proved to be"
                ));
            }
            unproved += u64::from(!proved_fibre.is_complete(operand.degree() as u64));
            self.now.proofs.push(proved_fibre);
        }
        let slabs = self.now.proofs.len();
        if involution.is_none() {
            let doubt = "conjugation does not map the combinations of the equations that are tracked to themselves: \
                         which points are real is not proved";
            self.now.unproved.push(doubt.to_owned());
        } else if unproved > 0 {
            let doubt = format!(
                "the number of real branches is not proved over {unproved} of {slabs} slabs"
            );
            self.now.unproved.push(doubt);
        }
        self.follow(context)
    }
}
