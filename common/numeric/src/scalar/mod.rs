//! The arithmetic that everything above is written in, once: [`Real`], [`Mask`], [`Complex`].
//!
//! Operations are in place and by reference, without `Copy`, and carry a
//! context for the precision, so that MPFR fits beside hardware doubles and
//! lanes. Comparisons return masks and control flow selects, so that one path
//! and sixteen paths in lockstep are the same code and give the same bits.

mod ball;
pub mod conformance;
pub mod directed;
mod double;
mod double_double;
#[cfg(test)]
mod enclosure_conformance;
mod interval;
pub mod jet;
mod magnitude;
mod multiple_precision;

pub use ball::Ball;
pub use double_double::DoubleDouble;
pub use interval::Interval;
pub use jet::Jet;
pub use magnitude::Magnitude;
pub use multiple_precision::MultiplePrecision;

use crate::rational::{ComplexRational, Rational};
use serde::{Deserialize, Serialize};

/// One truth value per lane.
pub trait Mask: Copy + Send + Sync + std::fmt::Debug + PartialEq + 'static {
    /// Copies one truth value to every lane.
    fn splat(value: bool) -> Self;
    /// Lane-wise and.
    #[must_use]
    fn and(self, other: Self) -> Self;
    /// Lane-wise or.
    #[must_use]
    fn or(self, other: Self) -> Self;
    /// Lane-wise negation.
    #[must_use]
    fn not(self) -> Self;
    /// True when at least one lane is.
    fn any(self) -> bool;
    /// The value of one lane.
    fn lane(self, lane: usize) -> bool;
    /// Sets the value of one lane.
    fn set_lane(&mut self, lane: usize, value: bool);
}

/// A real scalar, or one real scalar in each of `WIDTH` lanes.
///
/// Every operation is correctly rounded to the scalar's precision, and nothing
/// in it comes from libm, so equal inputs give equal bits on every machine.
pub trait Real: Clone + Send + Sync + std::fmt::Debug + 'static {
    /// Data needed to make a number: nothing, or the precision.
    type Context: Copy + Send + Sync + std::fmt::Debug;
    /// Result of a comparison.
    type Mask: Mask;
    /// Norms, steps and t: doubles of the same width.
    type Control: Real<Mask = Self::Mask, Context = (), Control = Self::Control>;
    /// One number for all lanes: a constant, broadcast where it is used.
    type Single: Real<Context = Self::Context>;
    /// Number of lanes.
    const WIDTH: usize;
    /// True for intervals, which enclose what they are made of instead of rounding it.
    const ENCLOSES: bool = false;

    /// Copies one double to every lane, exactly.
    fn from_f64(context: Self::Context, value: f64) -> Self;
    /// A rational, rounded to nearest, in every lane.
    fn from_rational(context: Self::Context, value: &Rational) -> Self;
    /// A number that is known to lie between two rationals: an interval encloses both, any
    /// other scalar takes the lower.
    fn between(context: Self::Context, lower: &Rational, _upper: &Rational) -> Self {
        Self::from_rational(context, lower)
    }
    /// A control number, exactly.
    fn from_control(context: Self::Context, value: &Self::Control) -> Self;
    /// Bits of the significand of numbers made with this context.
    fn bits(context: Self::Context) -> u32;
    /// The context that makes numbers of this one's precision.
    fn context(&self) -> Self::Context;
    /// `self = other`.
    fn set(&mut self, other: &Self);
    /// Puts a double into one lane.
    fn set_lane(&mut self, lane: usize, value: f64);
    /// The number in one lane, rounded to a double.
    fn lane(&self, lane: usize) -> f64;
    /// `self += other`.
    fn add(&mut self, other: &Self);
    /// `self -= other`.
    fn sub(&mut self, other: &Self);
    /// `self *= other`.
    fn mul(&mut self, other: &Self);
    /// `self /= other`.
    fn div(&mut self, other: &Self);
    /// `self += a*b` with one rounding.
    fn mul_add(&mut self, a: &Self, b: &Self);
    /// `self -= a*b` with one rounding.
    fn mul_sub(&mut self, a: &Self, b: &Self);
    /// `self *= c`.
    fn mul_single(&mut self, c: &Self::Single);
    /// `self += c*a` with one rounding.
    fn mul_add_single(&mut self, c: &Self::Single, a: &Self);
    /// `self -= c*a` with one rounding.
    fn mul_sub_single(&mut self, c: &Self::Single, a: &Self);
    /// `self = -self`.
    fn neg(&mut self);
    /// `self = |self|`.
    fn abs(&mut self);
    /// `self = sqrt(self)`.
    fn sqrt(&mut self);
    /// `self < other`; false where either is not a number.
    fn less(&self, other: &Self) -> Self::Mask;
    /// `self <= other`; false where either is not a number.
    fn less_equal(&self, other: &Self) -> Self::Mask;
    /// `self = other` in the lanes where `mask` is true.
    fn select(&mut self, mask: Self::Mask, other: &Self);
    /// Rounded to a double.
    fn control(&self) -> Self::Control;
    /// Exchanges one lane with another number's; as it stands here for scalars of one lane.
    #[inline(always)]
    fn swap_lane(&mut self, other: &mut Self, _lane: usize) {
        std::mem::swap(self, other);
    }
    /// `sum = a*b`, as [`Complex::set_product`] says; scalars whose operations are calls make one of it.
    #[inline(always)]
    fn set_product(sum: &mut Complex<Self>, a: &Complex<Self>, b: &Complex<Self>) {
        set_product(&mut sum.re, &mut sum.im, [&a.re, &a.im], [&b.re, &b.im]);
    }
    /// `sum += a*b`, as [`Complex::mul_add`] says.
    #[inline(always)]
    fn add_product(sum: &mut Complex<Self>, a: &Complex<Self>, b: &Complex<Self>) {
        add_product(&mut sum.re, &mut sum.im, [&a.re, &a.im], [&b.re, &b.im]);
    }
    /// `sum -= a*b`, as [`Complex::mul_sub`] says.
    #[inline(always)]
    fn subtract_product(sum: &mut Complex<Self>, a: &Complex<Self>, b: &Complex<Self>) {
        subtract_product(&mut sum.re, &mut sum.im, [&a.re, &a.im], [&b.re, &b.im]);
    }
    /// `self = max(self, other)`; a lane that is not a number takes the other.
    #[inline(always)]
    fn max(&mut self, other: &Self) {
        let mask = other.less_equal(self).not();
        self.select(mask, other);
    }
    /// `self = min(self, other)`; a lane that is not a number takes the other.
    #[inline(always)]
    fn min(&mut self, other: &Self) {
        let mask = self.less_equal(other).not();
        self.select(mask, other);
    }
}

/// A complex number of any rung. At the edges it is `num_complex::Complex64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[repr(C)]
pub struct Complex<R> {
    /// Real part.
    pub re: R,
    /// Imaginary part.
    pub im: R,
}

/// `re + i*im = a*b`, where `a` and `b` are given as real and imaginary part.
#[inline(always)]
pub(crate) fn set_product<R: Real>(re: &mut R, im: &mut R, a: [&R; 2], b: [&R; 2]) {
    re.set(a[1]);
    re.mul(b[1]);
    re.neg();
    re.mul_add(a[0], b[0]);
    im.set(a[1]);
    im.mul(b[0]);
    im.mul_add(a[0], b[1]);
}

/// `re + i*im += a*b`.
#[inline(always)]
pub(crate) fn add_product<R: Real>(re: &mut R, im: &mut R, a: [&R; 2], b: [&R; 2]) {
    re.mul_add(a[0], b[0]);
    re.mul_sub(a[1], b[1]);
    im.mul_add(a[0], b[1]);
    im.mul_add(a[1], b[0]);
}

/// `re + i*im -= a*b`.
#[inline(always)]
pub(crate) fn subtract_product<R: Real>(re: &mut R, im: &mut R, a: [&R; 2], b: [&R; 2]) {
    re.mul_sub(a[0], b[0]);
    re.mul_add(a[1], b[1]);
    im.mul_sub(a[0], b[1]);
    im.mul_sub(a[1], b[0]);
}

impl<R: Real> Complex<R> {
    /// 0.
    #[inline(always)]
    pub fn zero(context: R::Context) -> Self {
        Self::from_f64(context, 0.0, 0.0)
    }

    /// `re + i*im`, the same in every lane.
    #[inline(always)]
    pub fn from_f64(context: R::Context, re: f64, im: f64) -> Self {
        Self {
            re: R::from_f64(context, re),
            im: R::from_f64(context, im),
        }
    }

    /// An exact number rounded to the precision of the context.
    pub fn from_rational(context: R::Context, value: &ComplexRational) -> Self {
        Self {
            re: R::from_rational(context, &value.re),
            im: R::from_rational(context, &value.im),
        }
    }

    /// A control number, exactly.
    #[inline(always)]
    pub fn from_control(context: R::Context, value: &Complex<R::Control>) -> Self {
        Self {
            re: R::from_control(context, &value.re),
            im: R::from_control(context, &value.im),
        }
    }

    /// Rounded to doubles.
    #[inline(always)]
    pub fn control(&self) -> Complex<R::Control> {
        Complex {
            re: self.re.control(),
            im: self.im.control(),
        }
    }

    /// `self = other`.
    #[inline(always)]
    pub fn set(&mut self, other: &Self) {
        self.re.set(&other.re);
        self.im.set(&other.im);
    }

    /// Puts a double into one lane.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, value: num_complex::Complex64) {
        self.re.set_lane(lane, value.re);
        self.im.set_lane(lane, value.im);
    }

    /// The number in one lane, rounded to double.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> num_complex::Complex64 {
        num_complex::Complex64::new(self.re.lane(lane), self.im.lane(lane))
    }

    /// Exchanges the numbers of one lane with another's.
    #[inline(always)]
    pub fn swap_lane(&mut self, other: &mut Self, lane: usize) {
        self.re.swap_lane(&mut other.re, lane);
        self.im.swap_lane(&mut other.im, lane);
    }

    /// `self = other` where `mask` is true.
    #[inline(always)]
    pub fn select(&mut self, mask: R::Mask, other: &Self) {
        self.re.select(mask, &other.re);
        self.im.select(mask, &other.im);
    }

    /// `self += other`.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.re.add(&other.re);
        self.im.add(&other.im);
    }

    /// `self -= other`.
    #[inline(always)]
    pub fn sub(&mut self, other: &Self) {
        self.re.sub(&other.re);
        self.im.sub(&other.im);
    }

    /// `self = -self`.
    #[inline(always)]
    pub fn neg(&mut self) {
        self.re.neg();
        self.im.neg();
    }

    /// `self = a*b`: real part `-(a.im*b.im) + a.re*b.re`, imaginary part
    /// `a.im*b.re + a.re*b.im`, the first product rounded, the second fused.
    #[inline(always)]
    pub fn set_product(&mut self, a: &Self, b: &Self) {
        R::set_product(self, a, b);
    }

    /// `self = a*a`: real part `-(a.im*a.im) + a.re*a.re`, imaginary part
    /// `(a.re + a.re)*a.im`, the products fused as in [`Complex::set_product`].
    #[inline(always)]
    pub fn set_square(&mut self, a: &Self) {
        self.re.set(&a.im);
        self.re.mul(&a.im);
        self.re.neg();
        self.re.mul_add(&a.re, &a.re);
        self.im.set(&a.re);
        self.im.add(&a.re);
        self.im.mul(&a.im);
    }

    /// `self *= other`.
    #[inline(always)]
    pub fn mul(&mut self, other: &Self) {
        let a = self.clone();
        self.set_product(&a, other);
    }

    /// `self += a*b`.
    #[inline(always)]
    pub fn mul_add(&mut self, a: &Self, b: &Self) {
        R::add_product(self, a, b);
    }

    /// `self -= a*b`.
    #[inline(always)]
    pub fn mul_sub(&mut self, a: &Self, b: &Self) {
        R::subtract_product(self, a, b);
    }

    /// `self *= r` with `r` real.
    #[inline(always)]
    pub fn scale(&mut self, r: &R) {
        self.re.mul(r);
        self.im.mul(r);
    }

    /// `self = r*a` with `r` real.
    #[inline(always)]
    pub fn set_multiple(&mut self, r: &R::Single, a: &Self) {
        self.set(a);
        self.re.mul_single(r);
        self.im.mul_single(r);
    }

    /// `self += r*a` with `r` real.
    #[inline(always)]
    pub fn add_multiple(&mut self, r: &R::Single, a: &Self) {
        self.re.mul_add_single(r, &a.re);
        self.im.mul_add_single(r, &a.im);
    }

    /// `self = c*a`, rounded as [`Complex::set_product`].
    #[inline(always)]
    pub fn set_turned(&mut self, c: &Complex<R::Single>, a: &Self) {
        self.re.set(&a.im);
        self.re.mul_single(&c.im);
        self.re.neg();
        self.re.mul_add_single(&c.re, &a.re);
        self.im.set(&a.re);
        self.im.mul_single(&c.im);
        self.im.mul_add_single(&c.re, &a.im);
    }

    /// `self += c*a`, rounded as [`Complex::mul_add`].
    #[inline(always)]
    pub fn add_turned(&mut self, c: &Complex<R::Single>, a: &Self) {
        self.re.mul_add_single(&c.re, &a.re);
        self.re.mul_sub_single(&c.im, &a.im);
        self.im.mul_add_single(&c.re, &a.im);
        self.im.mul_add_single(&c.im, &a.re);
    }

    /// `|self|^2`.
    #[inline(always)]
    pub fn norm_sqr(&self) -> R {
        let mut n = self.re.clone();
        n.mul(&self.re);
        n.mul_add(&self.im, &self.im);
        n
    }

    /// `1/self`; infinite or not a number where `self` is 0.
    #[inline(always)]
    pub fn inverse(&self) -> Self {
        let n = self.norm_sqr();
        let mut inverse = self.clone();
        inverse.re.div(&n);
        inverse.im.neg();
        inverse.im.div(&n);
        inverse
    }

    /// `self /= other`.
    #[inline(always)]
    pub fn div(&mut self, other: &Self) {
        let inverse = other.inverse();
        self.mul(&inverse);
    }

    /// `self = conjugate(self)`.
    #[inline(always)]
    pub fn conjugate(&mut self) {
        self.im.neg();
    }
}
