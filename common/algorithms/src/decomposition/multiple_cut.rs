//! Multiple cut: a multiple set, cut by a further equation through its deflated equations.
//!
//! With the multipliers of its deflation the set is regular, and paths on it are. Slices and the equation are in
//! the variables alone, so that degrees are those of the set; multipliers lie on a general patch of a projective
//! space and stay finite. An end is a point of the variables: where the set has a point that is special the
//! deflated equations may be singular. What the end is, the equations that are given tell.

use super::deflated::ProblemContext;
use super::job::{DescribedSystem, Job, StageSystem};
use super::problem::Problem;
use cognate_continuation::bend::SlicedEquations;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::start_systems::slices::form;
use cognate_systems::system::System;
use cognate_systems::transform::{append, product_to_equation, slice};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A multiple set that is cut: which deflations make the equations regular on it, and its dimension.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DeflatedSet {
    pub ranks: Vec<u32>,
    pub dimension: usize,
}

impl DeflatedSet {
    /// The stage in which `forms` linear forms (0: a slice) become the next equation; `before` of the equations hold
    /// already, and `factor` is the factor of the next equation that cuts.
    pub fn stage(&self, [before, factor]: [u32; 2], forms: u32) -> StageSystem {
        StageSystem::MultipleCut {
            ranks: self.ranks.clone(),
            dimension: self.dimension,
            cut: [before, factor],
            forms,
        }
    }

    /// The deflated equations, as many combinations of them as cut out the set, and those of `by`.
    fn rows(&self, context: &mut ProblemContext<'_>, by: &System) -> System {
        let problem = context.problem;
        let equations = context.deflations.equations(problem, &self.ranks);
        let rows = problem.tracked_rows(&equations, self.dimension);
        append(&rows.expect("derivatives of polynomials have degrees"), by)
    }

    /// Deflated equations of the set and the equations of `by`, with the slices that are left.
    pub fn sliced(&self, context: &mut ProblemContext<'_>, by: &System) -> SlicedEquations {
        let left = self.dimension - by.equation_count();
        let rows = self.rows(context, by);
        SlicedEquations::new(&rows, context.problem.slices(left))
    }

    /// The system of a stage: `by` has the equations that hold and the one that cuts.
    pub fn system(&self, context: &mut ProblemContext<'_>, by: &System, forms: u32) -> System {
        let (variable_count, held) = (context.problem.variables(), by.equation_count() - 1);
        let left = self.dimension - held;
        let mut rows = self.rows(context, by);
        if forms > 0 {
            return product_to_equation(&rows, [forms as usize, left - 1], variable_count);
        }
        rows.equations.pop();
        rows.equation_names.pop();
        slice(&rows, left, variable_count)
    }
}

/// Paths on a set of this dimension: its slice moves to as many forms as the next equation has degrees; or, with
/// `forms`, their product becomes the equation.
pub(crate) fn job(
    problem: &Problem,
    system: DescribedSystem,
    (dimension, degree, forms): (usize, u32, u32),
    points: &[Vec<Complex64>],
) -> Job {
    let n = problem.variables();
    let level = (n - dimension) as u32;
    let others = problem.slices(dimension - 1).concat();
    let form = |number: u32| form(problem.seed(), level, number, n);
    let homotopy = match forms {
        0 => HomotopyKind::Parameter {
            start: [form(0), others.clone()].concat(),
            targets: (1..degree)
                .map(|number| [form(number), others.clone()].concat())
                .collect(),
        },
        _ => {
            let product: Vec<Complex64> = (0..forms).flat_map(form).collect();
            let at = |equation: f64| {
                let blend = [equation, 1.0 - equation].map(|x| Complex64::new(x, 0.0));
                [&others[..], &blend, &product].concat()
            };
            HomotopyKind::Parameter {
                start: at(0.0),
                targets: vec![at(1.0)],
            }
        }
    };
    Job::track(system, homotopy, points, &problem.tracking).ends_only()
}

/// Number of linear forms of the next stage: 0 while the slice moves, which it does before its points are cut.
pub(crate) fn forms(sliding: bool, degree: u32) -> u32 {
    match sliding {
        true => 0,
        false => degree,
    }
}

/// System of a stage that cuts a multiple set; `by` is made only if the system is new.
pub(crate) fn system_of(
    context: &mut ProblemContext<'_>,
    wanted: &StageSystem,
    by: impl FnOnce() -> System,
) -> Arc<System> {
    let StageSystem::MultipleCut {
        ranks,
        dimension,
        forms,
        ..
    } = wanted
    else {
        unreachable!("a multiple set is cut, not {wanted:?}")
    };
    if let Some(stage_system) = context.deflations.known_stage(wanted) {
        return stage_system;
    }
    let set = DeflatedSet {
        ranks: ranks.clone(),
        dimension: *dimension,
    };
    let made = set.system(context, &by(), *forms);
    context.deflations.remember_stage(wanted, made)
}
