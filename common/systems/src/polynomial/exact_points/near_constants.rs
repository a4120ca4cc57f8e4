//! The solutions of equations with constants that are neither rational nor square roots of rational numbers, such as
//! `10^(-6.3)`, by those of equations with rational numbers near them.
//!
//! A regular solution moves by the difference of the constants times its condition, to first order, and both are bounded
//! here: it differs in no digit of a double. That the equations have no other solutions is said by a count: with general
//! constants they have as many.

use super::exact_point::ExactPoint;
use super::rational_equations::RationalEquations;
use super::rational_solutions::solved;
use crate::polynomial::solution_count::{NotCounted, SolutionCount, solution_count};
use crate::system::System;
use crate::transform::rational_constants;
use num_complex::Complex64;

/// The numbers differ from the constants by at most 2 to this power, negative, of them.
const BITS: u32 = 128;
/// Largest condition of a solution: it moves by 2^-88 of its coordinates, far below the last place of a double.
const MOST_CONDITION: f64 = 1e12;

/// All solutions, where each is regular and as many are counted; `None` inside where they are infinitely many.
pub(super) fn points(
    system: &System,
    parameters: &[Complex64],
    operations: u64,
) -> Result<Option<Vec<ExactPoint>>, NotCounted> {
    if system.equation_count() != system.dimension() {
        return Err(NotCounted::Constants);
    }
    let counted = solution_count(system, parameters, operations)?.count;
    let near = rational_constants(system, BITS).ok_or(NotCounted::Constants)?;
    let equations = RationalEquations::of(&near, parameters)?;
    let Some(points) = solved(&equations, 0, operations)? else {
        return Ok(None);
    };
    let is_regular =
        |point: &ExactPoint| point.multiplicity == 1 && point.condition <= MOST_CONDITION;
    let number = points.len() as u64;
    let general = SolutionCount::Finite {
        with_multiplicity: number,
        distinct: Some(number),
    };
    match points.iter().all(is_regular) && counted == general {
        true => Ok(Some(points)),
        false => Err(NotCounted::Constants),
    }
}
