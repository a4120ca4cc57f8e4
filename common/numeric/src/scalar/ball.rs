//! Balls: a double and how far from it the exact result can be; enclosures without a change of rounding, for lanes.
//!
//! Middle and radius as in van der Hoeven (Ball arithmetic, 2009) and Johansson (Arb, 2017): the middle is rounded to
//! nearest, and the radius is an upper bound of what that and the operands' radii make of it. What has no
//! enclosure has a radius that is infinite or not a number, which no comparison accepts.

use super::directed::{Directed, Toward};
use super::magnitude::Magnitude;
use super::{Mask, Real};
use crate::rational::Rational;

/// All real numbers within `radius` of `middle`, in every lane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ball<F> {
    middle: F,
    radius: Magnitude<F>,
}

impl<F: Real<Context = (), Control = F>> Ball<F> {
    /// One number; nothing is known where it is not finite.
    #[inline(always)]
    pub fn point(middle: &F) -> Self {
        let mut nothing = middle.clone();
        nothing.sub(middle);
        Self::around(middle, &Magnitude::of(&nothing))
    }

    /// The ball around a number with this radius.
    #[inline(always)]
    pub fn around(middle: &F, radius: &Magnitude<F>) -> Self {
        Self {
            middle: middle.clone(),
            radius: radius.clone(),
        }
    }

    /// The middle.
    #[inline(always)]
    pub fn middle(&self) -> &F {
        &self.middle
    }

    /// A bound of the moduli in it.
    #[inline(always)]
    pub fn magnitude(&self) -> Magnitude<F> {
        let mut bound = Magnitude::of(&self.middle);
        bound.add(&self.radius);
        bound
    }

    /// Adds what the product of two balls is off by, whose middles' product is in `self.middle`, rounded once.
    #[inline(always)]
    fn widen_by_product(&mut self, a: &Self, b: &Self) {
        // |a b - ma mb| <= |ma| rb + ra (|mb| + rb).
        self.radius
            .add_product(&Magnitude::of(&a.middle), &b.radius);
        let mut modulus = Magnitude::of(&b.middle);
        modulus.add_nearest(&b.radius);
        self.radius.add_product(&a.radius, &modulus);
        self.radius.add_rounding(&self.middle);
        self.radius.outward();
    }

    /// A number that is at most all of |self|.
    #[inline(always)]
    fn least(&self) -> F {
        let mut least = self.middle.clone();
        least.abs();
        least.sub(self.radius.value());
        least.mul(&F::from_f64((), 1.0 - 8.0 * f64::EPSILON));
        least.sub(&F::from_f64((), f64::MIN_POSITIVE));
        least
    }

    /// `other - self`.
    #[inline(always)]
    fn difference(&self, other: &Self) -> Self
    where
        Self: Real,
    {
        let mut difference = other.clone();
        difference.sub(self);
        difference
    }
}

/// A constant, for all lanes.
#[inline(always)]
fn splat<F>(c: &Ball<F::Single>) -> Ball<F>
where
    F: Real<Context = (), Control = F>,
    F::Single: Real<Context = (), Control = F::Single>,
{
    // One times it, exactly.
    let every = |c: &F::Single| {
        let mut one = F::from_f64((), 1.0);
        one.mul_single(c);
        one
    };
    Ball::around(&every(&c.middle), &Magnitude::of(&every(c.radius.value())))
}

impl<F> Real for Ball<F>
where
    F: Real<Context = (), Control = F>,
    F::Single: Real<Context = (), Control = F::Single, Single = F::Single>,
{
    type Context = ();
    type Mask = F::Mask;
    type Control = F;
    type Single = Ball<F::Single>;
    const WIDTH: usize = F::WIDTH;
    const ENCLOSES: bool = true;

    #[inline(always)]
    fn from_f64(_: (), value: f64) -> Self {
        Self::point(&F::from_f64((), value))
    }
    fn from_rational(_: (), value: &Rational) -> Self {
        Self::between((), value, value)
    }
    fn between(_: (), lower: &Rational, upper: &Rational) -> Self {
        let middle = f64::from_rational((), lower);
        let radius = Rational::from_f64(middle).map_or(f64::INFINITY, |exact| {
            let (below, above) = (
                Rational::from(&exact - lower).abs(),
                Rational::from(upper - &exact).abs(),
            );
            f64::rounded((), &below.max(above), Toward::Above)
        });
        Self::around(&F::from_f64((), middle), &Magnitude::from_f64(radius))
    }
    #[inline(always)]
    fn from_control(_: (), value: &F) -> Self {
        Self::point(value)
    }
    fn bits(_: ()) -> u32 {
        53
    }
    #[inline(always)]
    fn context(&self) -> Self::Context {}
    #[inline(always)]
    fn set(&mut self, other: &Self) {
        *self = other.clone();
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.middle.set_lane(lane, value);
        let mut radius = self.radius.value().clone();
        // Not 0: nothing is known where it is not finite.
        radius.set_lane(lane, 0.0 * value);
        self.radius = Magnitude::of(&radius);
    }
    /// The middle.
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.middle.lane(lane)
    }
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.middle.add(&other.middle);
        self.radius.add_nearest(&other.radius);
        self.radius.add_rounding(&self.middle);
        self.radius.outward();
    }
    #[inline(always)]
    fn sub(&mut self, other: &Self) {
        self.middle.sub(&other.middle);
        self.radius.add_nearest(&other.radius);
        self.radius.add_rounding(&self.middle);
        self.radius.outward();
    }
    #[inline(always)]
    fn mul(&mut self, other: &Self) {
        let a = self.clone();
        self.middle.mul(&other.middle);
        self.radius = Magnitude::zero();
        self.widen_by_product(&a, other);
    }
    /// Nothing is known where the divisor may be 0.
    #[inline(always)]
    fn div(&mut self, other: &Self) {
        self.middle.div(&other.middle);
        // |a/b - ma/mb| <= (ra + |ma/mb| rb)/(|mb| - rb).
        let mut quotient = Magnitude::of(&self.middle);
        quotient.outward();
        self.radius.add_product(&quotient, &other.radius);
        self.radius.outward();
        self.radius.divide(&other.least());
        self.radius.add_rounding(&self.middle);
        self.radius.outward();
    }
    #[inline(always)]
    fn mul_add(&mut self, a: &Self, b: &Self) {
        self.middle.mul_add(&a.middle, &b.middle);
        self.widen_by_product(a, b);
    }
    #[inline(always)]
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        self.middle.mul_sub(&a.middle, &b.middle);
        self.widen_by_product(a, b);
    }
    #[inline(always)]
    fn mul_single(&mut self, c: &Self::Single) {
        self.mul(&splat(c));
    }
    #[inline(always)]
    fn mul_add_single(&mut self, c: &Self::Single, a: &Self) {
        self.mul_add(&splat(c), a);
    }
    #[inline(always)]
    fn mul_sub_single(&mut self, c: &Self::Single, a: &Self) {
        self.mul_sub(&splat(c), a);
    }
    #[inline(always)]
    fn neg(&mut self) {
        self.middle.neg();
    }
    #[inline(always)]
    fn abs(&mut self) {
        self.middle.abs();
    }
    /// Nothing is known where a number in it may not be positive.
    #[inline(always)]
    fn sqrt(&mut self) {
        // |sqrt(x) - sqrt(m)| <= r/sqrt(m).
        let negative = self.middle.less(&F::from_f64((), 0.0));
        let mut root = self.least();
        root.select(negative, &F::from_f64((), f64::NAN));
        root.sqrt();
        self.radius.outward();
        self.radius.divide(&root);
        self.middle.sqrt();
        self.radius.add_rounding(&self.middle);
        self.radius.outward();
    }
    /// Every number of this one is less than every number of the other.
    #[inline(always)]
    fn less(&self, other: &Self) -> Self::Mask {
        let difference = self.difference(other);
        difference.radius.value().less(&difference.middle)
    }
    /// No number of this one is more than any number of the other, by more than what is lost to rounding.
    #[inline(always)]
    fn less_equal(&self, other: &Self) -> Self::Mask {
        let difference = self.difference(other);
        difference.radius.value().less_equal(&difference.middle)
    }
    #[inline(always)]
    fn select(&mut self, mask: Self::Mask, other: &Self) {
        self.middle.select(mask, &other.middle);
        self.radius.select(mask, &other.radius);
    }
    /// The middle.
    #[inline(always)]
    fn control(&self) -> F {
        self.middle.clone()
    }
    #[inline(always)]
    fn swap_lane(&mut self, other: &mut Self, lane: usize) {
        let mine = self.clone();
        let mut mask = Self::Mask::splat(false);
        mask.set_lane(lane, true);
        self.select(mask, other);
        other.select(mask, &mine);
    }
    /// The larger of any two numbers.
    #[inline(always)]
    fn max(&mut self, other: &Self) {
        self.middle.max(&other.middle);
        self.radius.max(&other.radius);
    }
    /// The smaller of any two numbers.
    #[inline(always)]
    fn min(&mut self, other: &Self) {
        self.middle.min(&other.middle);
        self.radius.max(&other.radius);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use crate::scalar::enclosure_conformance::{Enclosure, check, check_unknown};

    impl Enclosure for Ball<f64> {
        fn contains(&self, value: &Rational) -> bool {
            let radius = Rational::from_f64(*self.radius.value());
            let middle = Rational::from_f64(self.middle);
            middle
                .zip(radius)
                .is_some_and(|(middle, radius)| (middle - value).abs() <= radius)
        }
        fn is_known(&self) -> bool {
            self.radius.value().is_finite()
        }
        fn bound(&self) -> f64 {
            *self.magnitude().value()
        }
    }

    #[test]
    fn exact_results_lie_in_rounded_ones() {
        check::<Ball<f64>>(());
    }

    #[test]
    fn what_is_unknown_stays_unknown() {
        let wide = Ball::around(&0.5, &Magnitude::from_f64(1.0));
        let unknown = [
            {
                let mut x = Ball::<f64>::from_f64((), 1.0);
                x.div(&wide);
                x
            },
            {
                let mut x = wide;
                x.sqrt();
                x
            },
            Ball::from_f64((), f64::NAN),
            Ball::from_f64((), f64::INFINITY),
            Ball::from_rational((), &(Rational::from(1) << 2000i32)),
        ];
        for bad in unknown {
            check_unknown(&bad, &wide);
        }
    }

    #[test]
    fn only_what_is_less_in_all_numbers_is_less() {
        let one = Ball::<f64>::from_f64((), 1.0);
        let about_two = Ball::around(&2.0, &Magnitude::from_f64(0.75));
        let about_three = Ball::around(&3.0, &Magnitude::from_f64(0.75));
        assert!(one.less(&about_two) && !about_two.less(&one));
        assert!(!about_two.less(&about_three) && !about_three.less_equal(&about_two));
    }

    #[test]
    fn lanes_have_their_own_numbers() {
        let mut x = Ball::<Lanes<8>>::from_rational((), &Rational::from((1, 3)));
        x.set_lane(3, 7.0);
        let mut y = Ball::<Lanes<8>>::from_f64((), 2.0);
        y.swap_lane(&mut x, 3);
        assert_eq!((x.lane(3), y.lane(3), x.lane(2)), (2.0, 7.0, 1.0 / 3.0));
        assert!(x.radius.value().lane(3) == 0.0 && x.radius.value().lane(2) > 0.0);
        y.sqrt();
        assert!((y.lane(3) - f64::sqrt(7.0)).abs() < 1e-15 && y.lane(0) == f64::sqrt(2.0));
    }
}
