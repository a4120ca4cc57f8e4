//! Outward-rounded intervals: a result encloses the exact results of all numbers within the operands.
//!
//! A scalar like the others, so that the one interpreter also proves. What has no enclosure
//! (division by an interval around 0) becomes an invalid interval, whose bounds are NaN: every
//! later result is invalid too, and no comparison accepts it. Not made for `dispatch`.

use super::directed::{Directed, Toward};
use super::{Complex, Real};
use crate::rational::Rational;

/// All real numbers from `lower` to `upper`; both are NaN where nothing is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Interval<R> {
    lower: R,
    upper: R,
}

impl<R: Directed> Interval<R> {
    /// The interval from one bound to another; invalid unless `lower <= upper`.
    #[inline]
    pub fn new(lower: R, upper: R) -> Self {
        if lower.less_equal(&upper) {
            Self { lower, upper }
        } else {
            Self::invalid(lower.context())
        }
    }

    /// One number; invalid where it is not finite.
    #[inline]
    pub fn point(value: &R) -> Self {
        if !value.is_finite() {
            return Self::invalid(value.context());
        }
        Self {
            lower: value.clone(),
            upper: value.clone(),
        }
    }

    /// The interval from `-radius` to `radius`.
    pub fn around_zero(context: R::Context, radius: f64) -> Self {
        Self::new(R::from_f64(context, -radius), R::from_f64(context, radius))
    }

    /// The interval of which nothing is known.
    #[inline]
    pub fn invalid(context: R::Context) -> Self {
        Self {
            lower: R::from_f64(context, f64::NAN),
            upper: R::from_f64(context, f64::NAN),
        }
    }

    /// False for an interval of which nothing is known.
    #[inline]
    pub fn is_valid(&self) -> bool {
        self.lower.less_equal(&self.upper)
    }

    /// The smallest number in it.
    pub fn lower(&self) -> &R {
        &self.lower
    }

    /// The largest number in it.
    pub fn upper(&self) -> &R {
        &self.upper
    }

    /// A bound of the moduli in it, as a double; NaN for an invalid interval.
    #[inline]
    pub fn magnitude(&self) -> f64 {
        let low = self.lower.to_double(Toward::Below).abs();
        let high = self.upper.to_double(Toward::Above).abs();
        if low > high || low.is_nan() {
            low
        } else {
            high
        }
    }

    /// True when 0 is in it, or nothing is known.
    #[inline]
    pub fn may_be_zero(&self) -> bool {
        !(self.lower.is_positive() || self.upper.is_negative())
    }

    /// True when no number is in both. False where one is invalid.
    pub fn is_disjoint(&self, other: &Self) -> bool {
        self.upper.less(&other.lower) || other.upper.less(&self.lower)
    }

    /// True when it lies in the interior of another. False where one is invalid.
    pub fn is_inside(&self, other: &Self) -> bool {
        other.lower.less(&self.lower) && self.upper.less(&other.upper) && self.is_valid()
    }

    /// True when this rational is in it.
    pub fn contains(&self, value: &Rational) -> bool {
        match (self.lower.to_rational(), self.upper.to_rational()) {
            (Some(lower), Some(upper)) => lower <= *value && *value <= upper,
            (None, Some(upper)) => self.is_valid() && *value <= upper,
            (Some(lower), None) => self.is_valid() && lower <= *value,
            (None, None) => self.is_valid(),
        }
    }

    /// `(min, max)` of the products of ends, each by `corner` with its direction of rounding.
    #[inline]
    fn corners(&self, b: &Self, corner: impl Fn(&R, &R, Toward) -> R) -> Self {
        use Toward::{Above, Below};
        let a = self;
        let (lower, upper) = if !a.lower.is_negative() && a.is_valid() {
            if !b.lower.is_negative() {
                (
                    corner(&a.lower, &b.lower, Below),
                    corner(&a.upper, &b.upper, Above),
                )
            } else if !b.upper.is_positive() {
                (
                    corner(&a.upper, &b.lower, Below),
                    corner(&a.lower, &b.upper, Above),
                )
            } else {
                (
                    corner(&a.upper, &b.lower, Below),
                    corner(&a.upper, &b.upper, Above),
                )
            }
        } else if !a.upper.is_positive() {
            if !b.lower.is_negative() {
                (
                    corner(&a.lower, &b.upper, Below),
                    corner(&a.upper, &b.lower, Above),
                )
            } else if !b.upper.is_positive() {
                (
                    corner(&a.upper, &b.upper, Below),
                    corner(&a.lower, &b.lower, Above),
                )
            } else {
                (
                    corner(&a.lower, &b.upper, Below),
                    corner(&a.lower, &b.lower, Above),
                )
            }
        } else if !b.lower.is_negative() {
            (
                corner(&a.lower, &b.upper, Below),
                corner(&a.upper, &b.upper, Above),
            )
        } else if !b.upper.is_positive() {
            (
                corner(&a.upper, &b.lower, Below),
                corner(&a.lower, &b.lower, Above),
            )
        } else {
            // Both straddle 0, or one is invalid and so is every corner.
            let (low, other) = (
                corner(&a.lower, &b.upper, Below),
                corner(&a.upper, &b.lower, Below),
            );
            let (high, another) = (
                corner(&a.lower, &b.lower, Above),
                corner(&a.upper, &b.upper, Above),
            );
            (
                if other.less(&low) { other } else { low },
                if high.less(&another) { another } else { high },
            )
        };
        Self::new(lower, upper)
    }

    /// Not inlined: an interpreter has hundreds of products, and each is a dozen of branches.
    #[inline(never)]
    fn product(&self, b: &Self) -> Self {
        if !self.is_valid() || !b.is_valid() {
            return Self::invalid(self.context());
        }
        self.corners(b, R::product)
    }
}

impl<R: Directed> Complex<Interval<R>> {
    /// True when neither part is invalid.
    pub fn is_valid(&self) -> bool {
        self.re.is_valid() && self.im.is_valid()
    }

    /// True for 1 alone.
    pub fn is_one(&self) -> bool {
        let only = |part: &Interval<R>, n: f64| {
            let n = R::from_f64(part.context(), n);
            [&part.lower, &part.upper]
                .into_iter()
                .all(|end| end.less_equal(&n) && n.less_equal(end))
        };
        only(&self.re, 1.0) && only(&self.im, 0.0)
    }

    /// True when no number is in both boxes.
    pub fn is_disjoint(&self, other: &Self) -> bool {
        self.re.is_disjoint(&other.re) || self.im.is_disjoint(&other.im)
    }

    /// True when the box lies in the interior of another.
    pub fn is_inside(&self, other: &Self) -> bool {
        self.re.is_inside(&other.re) && self.im.is_inside(&other.im)
    }
}

impl<R: Directed> Real for Interval<R> {
    type Context = R::Context;
    type Mask = bool;
    type Control = f64;
    type Single = Self;
    const WIDTH: usize = 1;
    const ENCLOSES: bool = true;

    #[inline]
    fn from_f64(context: R::Context, value: f64) -> Self {
        Self::point(&R::from_f64(context, value))
    }
    fn from_rational(context: R::Context, value: &Rational) -> Self {
        Self::between(context, value, value)
    }
    fn between(context: R::Context, lower: &Rational, upper: &Rational) -> Self {
        Self::new(
            R::rounded(context, lower, Toward::Below),
            R::rounded(context, upper, Toward::Above),
        )
    }
    #[inline]
    fn from_control(context: R::Context, value: &f64) -> Self {
        Self::from_f64(context, *value)
    }
    fn bits(context: R::Context) -> u32 {
        R::bits(context)
    }
    #[inline]
    fn context(&self) -> R::Context {
        self.lower.context()
    }
    #[inline]
    fn set(&mut self, other: &Self) {
        self.lower.set(&other.lower);
        self.upper.set(&other.upper);
    }
    #[inline]
    fn set_lane(&mut self, _lane: usize, value: f64) {
        *self = Self::from_f64(self.context(), value);
    }
    /// The middle.
    #[inline]
    fn lane(&self, _lane: usize) -> f64 {
        self.control()
    }
    #[inline]
    fn add(&mut self, other: &Self) {
        *self = Self::new(
            R::sum(&self.lower, &other.lower, Toward::Below),
            R::sum(&self.upper, &other.upper, Toward::Above),
        );
    }
    #[inline]
    fn sub(&mut self, other: &Self) {
        *self = Self::new(
            R::difference(&self.lower, &other.upper, Toward::Below),
            R::difference(&self.upper, &other.lower, Toward::Above),
        );
    }
    #[inline]
    fn mul(&mut self, other: &Self) {
        *self = self.product(other);
    }
    /// Invalid where the divisor may be 0.
    #[inline]
    fn div(&mut self, other: &Self) {
        if other.may_be_zero() || !self.is_valid() {
            *self = Self::invalid(self.context());
            return;
        }
        // Where b is negative, a/b = (-a)/(-b).
        let (mut a, mut b) = (self.clone(), other.clone());
        if b.upper.is_negative() {
            a.neg();
            b.neg();
        }
        let low = if a.lower.is_negative() {
            &b.lower
        } else {
            &b.upper
        };
        let high = if a.upper.is_negative() {
            &b.upper
        } else {
            &b.lower
        };
        *self = Self::new(
            R::quotient(&a.lower, low, Toward::Below),
            R::quotient(&a.upper, high, Toward::Above),
        );
    }
    #[inline]
    fn mul_add(&mut self, a: &Self, b: &Self) {
        let product = a.product(b);
        self.add(&product);
    }
    #[inline]
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        let product = a.product(b);
        self.sub(&product);
    }
    #[inline]
    fn mul_single(&mut self, c: &Self) {
        self.mul(c);
    }
    #[inline]
    fn mul_add_single(&mut self, c: &Self, a: &Self) {
        self.mul_add(c, a);
    }
    #[inline]
    fn mul_sub_single(&mut self, c: &Self, a: &Self) {
        self.mul_sub(c, a);
    }
    #[inline]
    fn neg(&mut self) {
        std::mem::swap(&mut self.lower, &mut self.upper);
        self.lower.neg();
        self.upper.neg();
    }
    #[inline]
    fn abs(&mut self) {
        if self.upper.is_negative() {
            self.neg();
        } else if self.lower.is_negative() {
            self.lower.neg();
            if self.upper.less(&self.lower) {
                std::mem::swap(&mut self.lower, &mut self.upper);
            }
            self.lower = R::from_f64(self.context(), 0.0);
        }
    }
    /// Invalid where a negative number is in it.
    #[inline]
    fn sqrt(&mut self) {
        if self.lower.is_negative() || !self.is_valid() {
            *self = Self::invalid(self.context());
        } else {
            *self = Self::new(
                R::root(&self.lower, Toward::Below),
                R::root(&self.upper, Toward::Above),
            );
        }
    }
    /// Every number of this one is less than every number of the other.
    #[inline]
    fn less(&self, other: &Self) -> bool {
        self.upper.less(&other.lower)
    }
    /// No number of this one is more than any number of the other.
    #[inline]
    fn less_equal(&self, other: &Self) -> bool {
        self.upper.less_equal(&other.lower)
    }
    #[inline]
    fn select(&mut self, mask: bool, other: &Self) {
        if mask {
            self.set(other);
        }
    }
    /// The middle, rounded to a double.
    #[inline]
    fn control(&self) -> f64 {
        0.5 * self.lower.control() + 0.5 * self.upper.control()
    }
    /// The larger of any two numbers; invalid where one is.
    #[inline]
    fn max(&mut self, other: &Self) {
        if !other.is_valid() || !self.is_valid() {
            *self = Self::invalid(self.context());
            return;
        }
        self.lower.max(&other.lower);
        self.upper.max(&other.upper);
    }
    /// The smaller of any two numbers; invalid where one is.
    #[inline]
    fn min(&mut self, other: &Self) {
        if !other.is_valid() || !self.is_valid() {
            *self = Self::invalid(self.context());
            return;
        }
        self.lower.min(&other.lower);
        self.upper.min(&other.upper);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::MultiplePrecision;
    use crate::scalar::enclosure_conformance::{Enclosure, check, check_unknown};

    impl<R: Directed> Enclosure for Interval<R> {
        fn contains(&self, value: &Rational) -> bool {
            self.contains(value)
        }
        fn is_known(&self) -> bool {
            if !self.is_valid() {
                assert!(!self.is_inside(&Self::around_zero(self.context(), 1e300)));
                assert!(self.may_be_zero());
            }
            self.is_valid()
        }
        fn bound(&self) -> f64 {
            self.magnitude()
        }
    }

    #[test]
    fn exact_results_lie_in_rounded_ones() {
        check::<Interval<f64>>(());
        check::<Interval<MultiplePrecision>>(128);
    }

    #[test]
    fn a_rational_that_is_no_double_becomes_a_proper_interval() {
        let tenth = Rational::from((1, 10));
        let x = Interval::<f64>::from_rational((), &tenth);
        assert!(x.lower() < x.upper() && x.upper() - x.lower() < 2e-17);
        let half = Interval::<f64>::from_rational((), &Rational::from((1, 2)));
        assert_eq!(half, Interval::point(&0.5));
        let huge = Rational::from(1) << 2000i32;
        let huge = Interval::<f64>::from_rational((), &huge);
        assert_eq!((*huge.lower(), *huge.upper()), (f64::MAX, f64::INFINITY));
    }

    #[test]
    fn what_is_unknown_stays_unknown() {
        let unknown = [
            {
                let mut x = Interval::from_f64((), 1.0);
                x.div(&Interval::around_zero((), 1.0));
                x
            },
            {
                let mut x = Interval::around_zero((), 1.0);
                x.sqrt();
                x
            },
            Interval::<f64>::from_f64((), f64::NAN),
            Interval::<f64>::from_f64((), f64::INFINITY),
            Interval::new(2.0, 1.0),
        ];
        for bad in unknown {
            let good = Interval::around_zero((), 2.0);
            check_unknown(&bad, &good);
            assert!(!bad.is_disjoint(&good) && !bad.is_inside(&good) && !good.is_inside(&bad));
        }
        // Overflow is no error, and no knowledge either.
        let mut x = Interval::<f64>::from_f64((), 1e200);
        let y = x.clone();
        x.mul(&y);
        assert_eq!((*x.lower(), *x.upper()), (f64::MAX, f64::INFINITY));
        let z = x.clone();
        x.sub(&z);
        assert!(x.may_be_zero() && !x.is_inside(&Interval::around_zero((), f64::MAX)));
    }

    #[test]
    fn what_is_exact_stays_a_point() {
        let mut x = Interval::<f64>::from_f64((), 3.0);
        x.mul(&Interval::from_f64((), 0.0));
        x.add(&Interval::from_f64((), 5.0));
        x.sub(&Interval::from_f64((), 0.125));
        assert_eq!(x, Interval::point(&4.875));
    }
}
