//! Cutting: the problems in which further equations, or polars, cut a component.

use super::super::context::Context;
use super::Wanted;
use crate::decomposition::operand::Operand;
use crate::decomposition::problem::Problem;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_solutions::involution::Involution;
use cognate_systems::system::System;
use cognate_systems::transform::{MOST_CRITICAL_VARIABLES, polar};
use num_complex::Complex64;
use std::cmp::Ordering;

/// Numbers of random streams, apart from those of other questions.
const POLARS: u64 = 1 << 51;
const PLACE: u64 = 1 << 52;

/// The problem that cuts a component; `None` where the equations that cut have no solutions. An error says why there is
/// none.
pub(super) fn problem(
    context: &Context<'_>,
    operand: &Operand,
    wanted: Wanted,
) -> Result<Option<Problem>, String> {
    let dimension = operand.dimension();
    let problem = context.problem;
    let extended = match wanted {
        Wanted::Equations { from } => problem.followed_by(context.whole, |i| i >= from as usize),
        Wanted::Singular => polars(problem, dimension, None)?,
        Wanted::Critical => {
            let involution = problem.involution.as_ref();
            polars(problem, dimension, Some(involution.ok_or(NOT_REAL)?))?
        }
        Wanted::Others => unreachable!("pairs are cut by no equations"),
    };
    let made = problem.cut_by(dimension, extended);
    made.map_err(|error| error.to_string())
}

/// Said where there are no real points.
pub(super) const NOT_REAL: &str = "complex conjugation does not map solutions to solutions";

/// The equations and enough polars that all of them together hold on the locus only.
fn polars(
    problem: &Problem,
    dimension: usize,
    involution: Option<&Involution>,
) -> Result<System, String> {
    let n = problem.variables();
    if n > MOST_CRITICAL_VARIABLES {
        return Err(format!("{n} variables; at most {MOST_CRITICAL_VARIABLES}"));
    }
    let mut system = (*problem.given).clone();
    let towards = involution.map(|involution| {
        let partners = partners(involution, n);
        (place(problem, &partners), partners)
    });
    let square = problem.given.equation_count() == n - dimension;
    let free = dimension - usize::from(towards.is_some());
    // One more than general members of a linear system need, to have nothing in common outside of its base.
    let count = if square && free == 0 {
        1
    } else {
        dimension + 2
    };
    for number in 0..count as u64 {
        let seed = problem.seed() ^ (number << 32);
        let rows = problem.combinations(&system, dimension, seed);
        system.expressions = rows.expressions;
        let mut random = RandomStream::new(problem.seed(), Purpose::Question, POLARS | number);
        let towards = towards.as_ref();
        let towards = towards.map(|(point, partners)| (point.as_slice(), partners.as_slice()));
        polar(&mut system, &rows.equations, towards, &mut random);
    }
    Ok(system)
}

/// A random real point: values of variables that conjugation exchanges are conjugates.
fn place(problem: &Problem, partners: &[usize]) -> Vec<ComplexRational> {
    let mut random = RandomStream::new(problem.seed(), Purpose::Question, PLACE);
    let mut part = || Rational::from((random.below(1999) as i32 - 999, 512u32));
    let mut point: Vec<ComplexRational> = Vec::with_capacity(partners.len());
    for (v, &partner) in partners.iter().enumerate() {
        let (re, im) = (part(), part());
        point.push(match partner.cmp(&v) {
            Ordering::Less => point[partner].conjugate(),
            Ordering::Equal => ComplexRational::real(re),
            Ordering::Greater => ComplexRational::new(re, im),
        });
    }
    point
}

/// Partner of each variable under conjugation.
fn partners(involution: &Involution, n: usize) -> Vec<usize> {
    let places: Vec<Complex64> = (0..n).map(|v| Complex64::new(v as f64, 0.0)).collect();
    let images = involution.image(&places).into_iter();
    images.map(|z| z.re as usize).collect()
}
