//! Upper bounds of numbers that are not negative, in doubles of any width: what the radius of a ball is made of.
//!
//! Rounded to nearest and then outward: every result is multiplied by 1 + 16 u and enlarged by the smallest
//! normal double, which is more than a handful of roundings (each of u, relatively) and of underflows can take.
//! u is the unit roundoff 2^-53.

use super::{Mask, Real};

/// 1 + 16 u.
const GROWTH: f64 = 1.0 + 8.0 * f64::EPSILON;
/// A little more than u: u |exact result| is at most this times |rounded result|.
const ROUNDING: f64 = 0.51 * f64::EPSILON;

/// A bound in the width of `F`; not a number where nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Magnitude<F>(F);

impl<F: Real<Context = (), Control = F>> Magnitude<F> {
    /// |value|.
    #[inline(always)]
    pub fn of(value: &F) -> Self {
        let mut bound = value.clone();
        bound.abs();
        Self(bound)
    }

    /// |value|, in every lane.
    #[inline(always)]
    pub fn from_f64(value: f64) -> Self {
        Self(F::from_f64((), value.abs()))
    }

    /// 0.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// The bound itself.
    #[inline(always)]
    pub fn value(&self) -> &F {
        &self.0
    }

    /// Makes up for the rounding of at most a dozen operations that led here.
    #[inline(always)]
    pub(super) fn outward(&mut self) {
        let mut bound = F::from_f64((), f64::MIN_POSITIVE);
        bound.mul_add(&self.0, &F::from_f64((), GROWTH));
        self.0 = bound;
    }

    /// Adds what a result that was rounded once is off by; not yet [outward](Self::outward).
    #[inline(always)]
    pub(super) fn add_rounding(&mut self, rounded: &F) {
        let size = Self::of(rounded);
        self.0.mul_add(&size.0, &F::from_f64((), ROUNDING));
    }

    /// Adds a product; not yet [outward](Self::outward).
    #[inline(always)]
    pub(super) fn add_product(&mut self, a: &Self, b: &Self) {
        self.0.mul_add(&a.0, &b.0);
    }

    /// Adds; not yet [outward](Self::outward).
    #[inline(always)]
    pub(super) fn add_nearest(&mut self, other: &Self) {
        self.0.add(&other.0);
    }

    /// Divides by a number that is at most the divisor; not yet [outward](Self::outward). Nothing is known where
    /// it is not positive.
    #[inline(always)]
    pub(super) fn divide(&mut self, least: &F) {
        self.0.div(least);
        let positive = F::from_f64((), 0.0).less(least);
        self.0
            .select(positive.not(), &F::from_f64((), f64::INFINITY));
    }

    /// `self += other`.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.add_nearest(other);
        self.outward();
    }

    /// `self += a*b`.
    #[inline(always)]
    pub fn mul_add(&mut self, a: &Self, b: &Self) {
        self.add_product(a, b);
        self.outward();
    }

    /// `self = sqrt(self)`.
    #[inline(always)]
    pub fn sqrt(&mut self) {
        self.0.sqrt();
        self.outward();
    }

    /// The larger of both; not a number where either is.
    #[inline(always)]
    pub fn max(&mut self, other: &Self) {
        let mut sum = self.0.clone();
        sum.add(&other.0);
        let unknown = sum.less_equal(&sum).not();
        self.0.max(&other.0);
        self.0.select(unknown, &sum);
    }

    /// `self = other` in the lanes where `mask` is true.
    #[inline(always)]
    pub fn select(&mut self, mask: F::Mask, other: &Self) {
        self.0.select(mask, &other.0);
    }
}
