//! Simultaneous iteration: all roots of a square-free polynomial at once, in as many bits as it takes until inclusion
//! discs hold one root each (O. Aberth 1973; L. W. Ehrlich 1967; D. A. Bini and G. Fiorentino, MPSolve, 2000).
//!
//! Newton's corrections are made with all bits, the sums over the other approximations in doubles, which they change
//! little once approximations are near their roots.

use super::evaluation::RoundedPolynomial;
use super::inclusion_discs::{Approximation, InclusionDiscs, Wanted};
use super::square_free::SymmetricFactor;
use super::start_points::start_points;
use super::wide::{Wide, power_of_two};
use cognate_numeric::interruption::count_work;
use num_complex::Complex64;
use rug::{Assign, Complex};

/// Bits of the first round; each further one has twice as many.
const FIRST_BITS: u32 = 64;
/// Most sweeps over all approximations in one round, in which the slowest of ordinary polynomials need about one
/// for each root of a cluster.
const MOST_SWEEPS: u32 = 400;
/// Sizes that differ by more than this power of two are out of the range of doubles.
const RANGE: i64 = 500;
/// Bits of sums over the other approximations, and of what they change.
const SUM_BITS: u32 = 64;
/// A correction that changes at most this many of the last bits leaves an approximation at rest; the next round has
/// twice as many bits.
const LAST_BITS: i64 = 6;

/// Operations that are left, about one for each product of two 64-bit numbers.
pub(super) struct Budget(pub u64);

impl Budget {
    /// Takes operations from the budget; `None` where fewer are left.
    fn spend(&mut self, operations: u64) -> Option<()> {
        self.0 = self.0.checked_sub(operations)?;
        if count_work(operations) {
            return None;
        }
        Some(())
    }
}

/// Finds one root of the factor in each disc; `None` where that takes more than the budget.
pub(super) fn isolated_roots(
    factor: &SymmetricFactor,
    wanted: &Wanted,
    budget: &mut Budget,
) -> Option<Vec<Approximation>> {
    let mut bits = FIRST_BITS;
    let mut points = start_points(&factor.polynomial, bits);
    // Which roots are known well enough.
    let mut settled = vec![false; points.len()];
    loop {
        let polynomial = RoundedPolynomial::new(&factor.polynomial, bits);
        for point in &mut points {
            point.set_prec(bits);
        }
        let mut round = Round {
            polynomial: &polynomial,
            bits,
            points,
            at_rest: settled,
        };
        round.iterate(budget)?;
        points = round.points;
        let operations = cost(bits, polynomial.term_count() + points.len());
        budget.spend(operations * points.len() as u64)?;
        let discs = InclusionDiscs::new(&polynomial, &points);
        let isolated = discs.settle(factor, wanted);
        if isolated.iter().all(Option::is_some) {
            return Some(isolated.into_iter().flatten().collect());
        }
        settled = isolated.iter().map(Option::is_some).collect();
        bits *= 2;
    }
}

/// Operations for `products` products of numbers with these bits.
fn cost(bits: u32, products: usize) -> u64 {
    let limbs = u64::from(bits.div_ceil(64));
    // Schoolbook products of few limbs, less for many; and what a call costs.
    let product = limbs * limbs.min(32) + 8;
    product * products as u64
}

/// The iteration in some bits.
struct Round<'a> {
    polynomial: &'a RoundedPolynomial,
    bits: u32,
    points: Vec<Complex>,
    /// Whether each approximation is as good as these bits make it, or was good enough before.
    at_rest: Vec<bool>,
}

impl Round<'_> {
    /// Sweeps until all is at rest; `None` where that takes more than the budget.
    fn iterate(&mut self, budget: &mut Budget) -> Option<()> {
        let count = self.points.len();
        let operations = cost(self.bits, self.polynomial.term_count()) + count as u64;
        for _ in 0..MOST_SWEEPS {
            if self.at_rest.iter().all(|&rest| rest) {
                break;
            }
            for k in 0..count {
                if self.at_rest[k] {
                    continue;
                }
                budget.spend(operations)?;
                self.step(k);
            }
        }
        Some(())
    }

    /// Moves one approximation by (p/p') / (1 - (p/p') S) with the sum S over the others.
    fn step(&mut self, k: usize) {
        let at = self.polynomial.at(&self.points[k]);
        if Wide::of_complex(&at.value) < at.error {
            self.at_rest[k] = true;
            return;
        }
        let repulsion = self.repulsion(k);
        let slope = Complex::with_val(SUM_BITS, &at.derivative / &at.value);
        let denominator = slope.clone() - &repulsion;
        if is_zero(&denominator) {
            // A point from which no direction is better than another.
            let aside = Complex::with_val(self.bits, (0.75, 0.125));
            self.points[k] *= aside;
            return;
        }
        // With all bits where Newton's correction is the larger part of it.
        let correction = match is_zero(&slope) {
            true => Complex::with_val(self.bits, denominator.recip_ref()),
            false => {
                let newton = Complex::with_val(self.bits, &at.value / &at.derivative);
                newton * (slope / denominator)
            }
        };
        let moved = Wide::of_complex(&correction);
        let last_bits = Wide::power_of_two(LAST_BITS - i64::from(self.bits));
        self.points[k] -= correction;
        self.at_rest[k] = moved < Wide::of_complex(&self.points[k]).times(last_bits);
    }

    /// The sum of 1/(z_k - z_j) over all others.
    fn repulsion(&self, k: usize) -> Complex {
        let scale = Wide::of_complex(&self.points[k]);
        let unit = if scale.is_zero() { 0 } else { scale.exponent() };
        let mut sum = Complex64::default();
        let mut of_nearest = Complex::new(SUM_BITS);
        let mut difference = Complex::new(self.bits);
        for (j, other) in self.points.iter().enumerate() {
            if j == k {
                continue;
            }
            difference.assign(&self.points[k] - other);
            let size = Wide::of_complex(&difference);
            if size.is_zero() {
                continue;
            }
            let nearer = unit - size.exponent();
            if nearer > RANGE {
                of_nearest += Complex::with_val(SUM_BITS, difference.recip_ref());
            } else if nearer > -RANGE {
                let direction = in_unit(&difference, size.exponent());
                sum += direction.conj() / direction.norm_sqr() * power_of_two(nearer);
            }
        }
        let mut others = Complex::with_val(SUM_BITS, (sum.re, sum.im));
        others >>= i32::try_from(unit).expect("sizes of numbers are 32-bit");
        others + of_nearest
    }
}

fn is_zero(number: &Complex) -> bool {
    number.real().is_zero() && number.imag().is_zero()
}

/// The number in units of a power of two that is about as large.
fn in_unit(number: &Complex, unit: i64) -> Complex64 {
    let part = |part: &rug::Float| {
        let (mantissa, exponent) = part.to_f64_exp();
        let exponent = i64::from(exponent) - unit;
        match exponent {
            _ if mantissa == 0.0 || exponent < -RANGE => 0.0,
            _ => mantissa * power_of_two(exponent),
        }
    };
    Complex64::new(part(number.real()), part(number.imag()))
}
