//! Hardware doubles: the first rung, one path at a time.

use super::{Mask, Real};
use crate::rational::Rational;

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }
    #[inline(always)]
    fn not(self) -> Self {
        !self
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn lane(self, _lane: usize) -> bool {
        self
    }
    #[inline(always)]
    fn set_lane(&mut self, _lane: usize, value: bool) {
        *self = value;
    }
}

/// The double that this rational is, found without arithmetic of many digits; `None` where it is none, or too large or
/// small to be found so.
pub(crate) fn exact_double(value: &Rational) -> Option<f64> {
    /// Powers of two that stay normal, also under 53 bits.
    const MOST_DOWN: u32 = 960;
    let (numerator, denominator) = (value.numer(), value.denom());
    if numerator.significant_bits() > f64::MANTISSA_DIGITS || !denominator.is_power_of_two() {
        return None;
    }
    let down = denominator.significant_bits() - 1;
    let numerator = numerator.to_i64().filter(|_| down <= MOST_DOWN)?;
    let unit = f64::from_bits(u64::from(1023 - down) << 52);
    Some(numerator as f64 * unit)
}

/// The double nearest to a rational, ties to even.
pub(crate) fn nearest_double(value: &Rational) -> f64 {
    exact_double(value).unwrap_or_else(|| nearest_of_many_digits(value))
}

/// The double nearest to a rational, ties to even; made for rationals that are most likely no double.
pub(crate) fn nearest_of_many_digits(value: &Rational) -> f64 {
    // Rational::to_f64 truncates; MPFR at 53 bits rounds to nearest.
    rug::Float::with_val(53, value).to_f64()
}

impl Real for f64 {
    type Context = ();
    type Mask = bool;
    type Control = f64;
    type Single = f64;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn from_f64(_: (), value: f64) -> Self {
        value
    }
    fn from_rational(_: (), value: &Rational) -> Self {
        nearest_double(value)
    }
    #[inline(always)]
    fn from_control(_: (), value: &f64) -> Self {
        *value
    }
    fn bits(_: ()) -> u32 {
        53
    }
    #[inline(always)]
    fn context(&self) -> Self::Context {}
    #[inline(always)]
    fn set(&mut self, other: &Self) {
        *self = *other;
    }
    #[inline(always)]
    fn set_lane(&mut self, _lane: usize, value: f64) {
        *self = value;
    }
    #[inline(always)]
    fn lane(&self, _lane: usize) -> f64 {
        *self
    }
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        *self += *other;
    }
    #[inline(always)]
    fn sub(&mut self, other: &Self) {
        *self -= *other;
    }
    #[inline(always)]
    fn mul(&mut self, other: &Self) {
        *self *= *other;
    }
    #[inline(always)]
    fn div(&mut self, other: &Self) {
        *self /= *other;
    }
    #[inline(always)]
    fn mul_add(&mut self, a: &Self, b: &Self) {
        *self = a.mul_add(*b, *self);
    }
    #[inline(always)]
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        *self = (-*a).mul_add(*b, *self);
    }
    #[inline(always)]
    fn mul_single(&mut self, c: &f64) {
        *self *= *c;
    }
    #[inline(always)]
    fn mul_add_single(&mut self, c: &f64, a: &Self) {
        *self = c.mul_add(*a, *self);
    }
    #[inline(always)]
    fn mul_sub_single(&mut self, c: &f64, a: &Self) {
        *self = (-*c).mul_add(*a, *self);
    }
    #[inline(always)]
    fn neg(&mut self) {
        *self = -*self;
    }
    #[inline(always)]
    fn abs(&mut self) {
        *self = f64::abs(*self);
    }
    #[inline(always)]
    fn sqrt(&mut self) {
        *self = f64::sqrt(*self);
    }
    #[inline(always)]
    fn less(&self, other: &Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn less_equal(&self, other: &Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(&mut self, mask: bool, other: &Self) {
        if mask {
            *self = *other;
        }
    }
    #[inline(always)]
    fn control(&self) -> f64 {
        *self
    }
}
