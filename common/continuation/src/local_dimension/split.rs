//! Split: domain and range of a system at a singular point, split where the Jacobian is regular and where
//! it is 0, and the equations that are left in the variables of the null space.

use super::series::{Monomials, Series};
use crate::asked_system::{AskedSystem, Linearization};
use crate::chart::norm;
use crate::path_result::LocalDimension;
use cognate_numeric::linear_algebra::svd::Svd;
pub(super) use cognate_numeric::linear_algebra::vector::square;
use num_complex::Complex64;

/// Singular values below this many times the noise count as 0. What lies within the margin of a
/// verdict's tolerance on either side is said by [`LocalDimension::margin`].
pub(super) const CUT: f64 = 30.0;
/// Rounding errors of the expansion, relative to what is expanded.
const ROUNDING: f64 = 1e-13;
/// Newton steps that bring the point nearer in the regular directions.
const MOST_STEPS: usize = 4;
/// A point may be moved by at most this many times its error.
pub(super) const FARTHEST: f64 = 100.0;

/// Counts the singular values that are not noise; what is near the border narrows the margin.
pub(super) fn rank(values: &[f64], noise: f64, margin: &mut f64) -> usize {
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

/// Domain and range split where the Jacobian is regular and where it is 0.
pub(super) struct Split {
    /// The point, brought as near to the solutions as the regular directions can.
    pub(super) point: Vec<Complex64>,
    /// Basis of the directions in which the Jacobian is regular, and its singular values.
    regular: Vec<Vec<Complex64>>,
    values: Vec<f64>,
    /// Basis of its null space.
    pub(super) kernel: Vec<Vec<Complex64>>,
    /// Images of the regular directions, orthonormal.
    range: Vec<Vec<Complex64>>,
    /// Basis of what is orthogonal to them.
    corange: Vec<Vec<Complex64>>,
    /// Size of the terms of which the equations are sums.
    pub(super) scale: f64,
}

/// Equations in the variables of the kernel.
pub(super) struct Reduced {
    pub(super) equations: Vec<Series>,
    /// Rounding errors of their coefficients.
    rounding: f64,
}

impl Split {
    /// `None` where the point leaves under Newton's method or the values are no numbers.
    pub(super) fn new(
        system: &AskedSystem,
        target: u64,
        point: &[Complex64],
        error: f64,
        found: &mut LocalDimension,
    ) -> Option<Self> {
        let mut point = point.to_vec();
        let farthest = FARTHEST * error;
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
    pub(super) fn reduce(
        &self,
        system: &AskedSystem,
        target: u64,
        monomials: &Monomials,
    ) -> Option<Reduced> {
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

impl Reduced {
    /// Bound of the errors of the coefficients up to this order: when the point moves by its error, they move by d/dz
    /// of the coefficients of one order more.
    pub(super) fn noise(&self, monomials: &Monomials, order: u32, error: f64) -> f64 {
        let moved = |equation: &Series| -> f64 {
            (3..=order + 1)
                .map(|d| f64::from(d * d) * square(&equation[monomials.of_degree(d)]))
                .sum()
        };
        let moves: f64 = self.equations.iter().map(moved).sum();
        error * moves.sqrt() + self.rounding
    }
}
