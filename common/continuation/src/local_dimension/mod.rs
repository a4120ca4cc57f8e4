//! Local dimension: whether a singular endpoint is isolated, and how multiple it is.
//!
//! The dual space of a system at a point: all differential functionals that
//! vanish on the ideal. Its dimension up to order k grows with every k exactly
//! where the point lies on a positive-dimensional solution set, and stops at
//! the multiplicity where the point is isolated (Macaulay 1916; Bates,
//! Hauenstein, Peterson, Sommese: A numerical local dimension test for points
//! on the solution set of a system of polynomial equations, SIAM J. Numer. Anal.
//! 47, 2009; Dayton, Zeng: Computing the multiplicity structure in solving
//! polynomial systems, ISSAC 2005). Here in as many variables as the Jacobian's
//! null space has: the others are eliminated as power series, which changes no
//! dimension, since the local ring stays the same.

pub mod candidates;
pub mod prepared;
pub mod series;

use crate::asked_system::{AskedSystem, Linearization};
use crate::chart::norm;
use cognate_numeric::linear_algebra::svd::Svd;
use num_complex::Complex64;
use series::{Monomials, Series};

use crate::path_result::LocalDimension;

/// Singular values below this many times the noise count as 0. What lies within the margin of a
/// verdict's tolerance on either side is said by [`LocalDimension::margin`].
const CUT: f64 = 30.0;
/// Smallest relative error that is assumed of an endpoint: estimates of singular ones are no
/// better than this.
const LEAST_ERROR: f64 = 1e-11;
/// Rounding errors of the expansion, relative to what is expanded.
const ROUNDING: f64 = 1e-13;
/// More monomials than this are not handled: their matrix would take seconds.
const MOST_MONOMIALS: usize = 500;
/// That the dimension outgrows the bound is believed from this order on, so that endpoints of one
/// point that were taken for two do not make it one of a curve.
const LEAST_ORDER: u32 = 2;
/// Newton steps that bring the point nearer in the regular directions.
const MOST_STEPS: usize = 4;

/// What is asked of one endpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question {
    /// Estimated relative error of the endpoint.
    pub accuracy: f64,
    /// An isolated point has at most this multiplicity: the number of paths that end there,
    /// and of those of which the end is not known. `u64::MAX` where no such number is known.
    pub bound: u64,
    /// No functional of higher order is asked for.
    pub depth: u32,
}

/// The tower of dual spaces at a point of the chart.
pub fn local_dimension(
    system: &AskedSystem,
    target: u64,
    point: &[Complex64],
    question: Question,
) -> LocalDimension {
    let mut found = LocalDimension {
        dual_dimensions: vec![1],
        bound: question.bound,
        margin: f64::INFINITY,
    };
    let size = norm(point);
    let error = question.accuracy.max(LEAST_ERROR) * size;
    let Some(split) = Split::new(system, target, point, error, &mut found) else {
        return found;
    };
    let kernel = split.kernel.len();
    found.dual_dimensions.push(1 + kernel as u32);
    if kernel == 0 {
        return found;
    }
    for order in 2..=question.depth {
        // One order more than asked tells how the coefficients move with the point.
        let expanded = order + 1;
        if Monomials::count_of(kernel, expanded) > MOST_MONOMIALS {
            break;
        }
        let monomials = Monomials::new(kernel, expanded);
        let Some(reduced) = split.reduce(system, target, &monomials) else {
            break;
        };
        let nullity = dual_dimension(&monomials, &reduced, order, error, &mut found.margin);
        let last = *found.dual_dimensions.last().expect("it began with one");
        found.dual_dimensions.push(nullity);
        let closed = nullity <= last;
        if closed || (u64::from(nullity) > question.bound && order >= LEAST_ORDER) {
            break;
        }
    }
    found
}

/// Counts the singular values that are not noise; what is near the border narrows the margin.
fn rank(values: &[f64], noise: f64, margin: &mut f64) -> usize {
    let cut = CUT * noise;
    let rank = values.iter().filter(|&&s| s > cut).count();
    for &value in values {
        let distance = if value > cut {
            value / cut
        } else {
            cut / value.max(f64::MIN_POSITIVE)
        };
        *margin = margin.min(distance);
    }
    rank
}

fn square(a: &[Complex64]) -> f64 {
    a.iter().map(|z| z.norm_sqr()).sum()
}

/// Domain and range split where the Jacobian is regular and where it is 0.
struct Split {
    /// The point, brought as near to the solutions as the regular directions can.
    point: Vec<Complex64>,
    /// Basis of the directions in which the Jacobian is regular, and its singular values.
    regular: Vec<Vec<Complex64>>,
    values: Vec<f64>,
    /// Basis of its null space.
    kernel: Vec<Vec<Complex64>>,
    /// Images of the regular directions, orthonormal.
    range: Vec<Vec<Complex64>>,
    /// Basis of what is orthogonal to them.
    corange: Vec<Vec<Complex64>>,
    /// How large the terms are that the equations are sums of.
    scale: f64,
}

/// Equations in the variables of the kernel.
struct Reduced {
    equations: Vec<Series>,
    /// Rounding errors of their coefficients.
    rounding: f64,
}

impl Split {
    /// `None` where the point leaves under Newton's method or the values are no numbers.
    fn new(
        system: &AskedSystem,
        target: u64,
        point: &[Complex64],
        error: f64,
        found: &mut LocalDimension,
    ) -> Option<Self> {
        let mut point = point.to_vec();
        let farthest = 100.0 * error;
        let mut moved = 0.0;
        let mut last = f64::INFINITY;
        for step in 0.. {
            let Linearization { values, columns } = system.linearize(&point, target);
            if !square(&values).is_finite() {
                found.margin = 0.0;
                return None;
            }
            let curvature = system.curvature(&point, target, &columns);
            let slope = columns.iter().map(|c| square(c)).sum::<f64>().sqrt();
            let noise = error * curvature + ROUNDING * slope;
            let rows = values.len();
            let svd = Svd::of(columns.clone());
            let mut margin = f64::INFINITY;
            let rank = rank(&svd.values, noise, &mut margin);
            let correction = svd.least_squares(&values, rank);
            let length = square(&correction).sqrt();
            let settled = length <= 1e-15 * norm(&point) || length > 0.5 * last;
            if step == MOST_STEPS || settled {
                found.margin = found.margin.min(margin);
                let adjoint = (0..rows).map(|i| columns.iter().map(|c| c[i].conj()).collect());
                let adjoint = Svd::of(adjoint.collect());
                let mut regular = svd.domain;
                let kernel = regular.split_off(rank);
                let unit = |k: usize| -> Vec<Complex64> {
                    svd.images[k].iter().map(|z| z / svd.values[k]).collect()
                };
                return Some(Self {
                    point,
                    regular,
                    range: (0..rank).map(unit).collect(),
                    values: svd.values[..rank].to_vec(),
                    kernel,
                    corange: adjoint.domain[rank..].to_vec(),
                    scale: slope.max(curvature).max(1.0),
                });
            }
            moved += length;
            if moved > farthest {
                // Not where the endgame said: whatever is found there is of another point.
                found.margin = 0.0;
                return None;
            }
            for (x, d) in point.iter_mut().zip(&correction) {
                *x -= d;
            }
            last = length;
        }
        unreachable!("the loop ends at the last step")
    }

    /// The equations in the variables of the kernel that are left when the regular directions are
    /// eliminated (Lyapunov and Schmidt). Their terms of order 0 and 1 are errors, and left out.
    fn reduce(&self, system: &AskedSystem, target: u64, monomials: &Monomials) -> Option<Reduced> {
        let zero = vec![Complex64::default(); monomials.len()];
        let mut eliminated: Vec<Series> = vec![zero.clone(); self.regular.len()];
        let top = monomials.degree(monomials.len() - 1);
        let mut round = 0;
        loop {
            let coordinates: Vec<Series> = (0..self.point.len())
                .map(|i| {
                    let mut series = zero.clone();
                    series[0] = self.point[i];
                    for (k, direction) in self.kernel.iter().enumerate() {
                        series[monomials.variable(k)] += direction[i];
                    }
                    for (y, direction) in eliminated.iter().zip(&self.regular) {
                        for (s, y) in series.iter_mut().zip(y) {
                            *s += y * direction[i];
                        }
                    }
                    series
                })
                .collect();
            let values = system.expand(monomials, &coordinates, target)?;
            let component = |basis: &[Complex64]| -> Series {
                let mut sum = zero.clone();
                for (weight, value) in basis.iter().zip(&values) {
                    for (s, v) in sum.iter_mut().zip(value) {
                        *s += weight.conj() * v;
                    }
                }
                sum
            };
            // Each round makes one order more of the eliminated ones exact.
            if round == top.saturating_sub(1) {
                let low = monomials.of_degree(0).end.max(monomials.of_degree(1).end);
                let reduced = |basis: &Vec<Complex64>| {
                    let mut equation = component(basis);
                    equation[..low].fill(Complex64::default());
                    equation
                };
                let largest = eliminated.iter().flatten().map(|z| z.norm_sqr());
                return Some(Reduced {
                    equations: self.corange.iter().map(reduced).collect(),
                    rounding: ROUNDING * self.scale * largest.fold(1.0, f64::max),
                });
            }
            for (k, y) in eliminated.iter_mut().enumerate() {
                for (y, v) in y.iter_mut().zip(component(&self.range[k])) {
                    *y -= v / self.values[k];
                }
            }
            round += 1;
        }
    }
}

/// Dimension of the dual space up to an order, of equations that begin with order 2: monomials up
/// to it less the rank of Macaulay's matrix of all multiples.
fn dual_dimension(
    monomials: &Monomials,
    reduced: &Reduced,
    order: u32,
    error: f64,
    margin: &mut f64,
) -> u32 {
    let within = monomials.of_degree(order).end;
    let first = monomials.of_degree(2).start;
    let mut rows: Vec<Vec<Complex64>> = Vec::new();
    let mut moves = 0.0;
    for equation in &reduced.equations {
        // How far the coefficients up to this order move when the point does by its error:
        // d/dz of those of one order more.
        let moved: f64 = (3..=order + 1)
            .map(|d| f64::from(d * d) * square(&equation[monomials.of_degree(d)]))
            .sum();
        for shift in 0..monomials.of_degree(order - 2).end {
            let mut row = vec![Complex64::default(); within - first];
            for (place, &value) in equation[..within].iter().enumerate().skip(first) {
                if let Some(product) = monomials.product(shift, place)
                    && product < within
                {
                    row[product - first] = value;
                }
            }
            moves += moved;
            rows.push(row);
        }
    }
    let noise = error * moves.sqrt() + reduced.rounding;
    // The singular values of the transpose are the same, and there are fewer of the shorter side.
    let columns = within - first;
    let values = if rows.len() <= columns {
        Svd::of(rows).values
    } else {
        let column = |j: usize| rows.iter().map(|row| row[j]).collect();
        Svd::of((0..columns).map(column).collect()).values
    };
    (within - rank(&values, noise, margin)) as u32
}

#[cfg(test)]
mod tests;
