//! Double-double: an unevaluated sum of two doubles, about 106 bits, in every width.
//!
//! Error-free transformations after Dekker (1971) and Knuth, products by fused
//! multiply-add; the sum and product algorithms and their error bounds are those
//! of Joldes, Muller, Popescu (Tight and rigorous error bounds for basic building
//! blocks of double-word arithmetic, ACM TOMS 44, 2017). Over lanes it is a lane
//! type like the others.

use super::Real;
use crate::lanes::Lanes;
use crate::rational::Rational;
use serde::{Deserialize, Serialize};

/// `hi + lo` with `hi` the sum rounded to a double, in the width of `B`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[repr(C)]
pub struct DoubleDouble<B> {
    hi: B,
    lo: B,
}

impl DoubleDouble<f64> {
    /// The two doubles, whose sum it is, the larger first.
    pub fn parts(&self) -> [f64; 2] {
        [self.hi, self.lo]
    }

    /// The number of these parts, as [`Self::parts`] gave them; `None` where they are not finite or the second
    /// is no rounding error of the first.
    pub fn from_parts([hi, lo]: [f64; 2]) -> Option<Self> {
        (hi.is_finite() && lo.is_finite() && hi + lo == hi).then_some(Self { hi, lo })
    }
}

impl<const W: usize> DoubleDouble<Lanes<W>> {
    /// The number in one lane, with all its digits.
    #[inline(always)]
    pub fn single(&self, lane: usize) -> DoubleDouble<f64> {
        DoubleDouble {
            hi: self.hi.0[lane],
            lo: self.lo.0[lane],
        }
    }
}

/// `a + b = sum + error`, exactly (TwoSum).
#[inline(always)]
fn two_sum<B: Real>(a: &B, b: &B) -> (B, B) {
    let mut sum = a.clone();
    sum.add(b);
    let mut b_part = sum.clone();
    b_part.sub(a);
    let mut a_part = sum.clone();
    a_part.sub(&b_part);
    let mut a_error = a.clone();
    a_error.sub(&a_part);
    let mut error = b.clone();
    error.sub(&b_part);
    error.add(&a_error);
    (sum, error)
}

/// `a + b = sum + error`, exactly, where |a| >= |b| (Fast2Sum).
#[inline(always)]
fn fast_two_sum<B: Real>(a: &B, b: &B) -> (B, B) {
    let mut sum = a.clone();
    sum.add(b);
    let mut difference = sum.clone();
    difference.sub(a);
    let mut error = b.clone();
    error.sub(&difference);
    (sum, error)
}

/// `a * b = product + error`, exactly (barring underflow).
#[inline(always)]
fn two_product<B: Real>(a: &B, b: &B) -> (B, B) {
    let mut product = a.clone();
    product.mul(b);
    let mut error = product.clone();
    error.neg();
    error.mul_add(a, b);
    (product, error)
}

impl<B: Real<Context = (), Control = B>> DoubleDouble<B> {
    #[inline(always)]
    fn put(&mut self, (hi, lo): (B, B)) {
        self.hi = hi;
        self.lo = lo;
    }

    /// Copies one number to every lane.
    #[inline(always)]
    fn everywhere(c: &DoubleDouble<f64>) -> Self {
        Self {
            hi: B::from_f64((), c.hi),
            lo: B::from_f64((), c.lo),
        }
    }

    /// `self += hi + lo` (AccurateDWPlusDW, relative error at most 3 u^2).
    #[inline(always)]
    fn accumulate(&mut self, hi: &B, lo: &B) {
        let (sum, mut error) = two_sum(&self.hi, hi);
        let (low, low_error) = two_sum(&self.lo, lo);
        error.add(&low);
        let (sum, mut error) = fast_two_sum(&sum, &error);
        error.add(&low_error);
        self.put(fast_two_sum(&sum, &error));
    }

    /// `a * b` (DWTimesDW3, relative error at most 4 u^2).
    #[inline(always)]
    fn product(a: &Self, b: &Self) -> (B, B) {
        let (product, mut error) = two_product(&a.hi, &b.hi);
        let mut cross = a.lo.clone();
        cross.mul(&b.lo);
        cross.mul_add(&a.hi, &b.lo);
        cross.mul_add(&a.lo, &b.hi);
        error.add(&cross);
        fast_two_sum(&product, &error)
    }
}

impl<B: Real<Context = (), Control = B>> Real for DoubleDouble<B> {
    type Context = ();
    type Mask = B::Mask;
    type Control = B;
    type Single = DoubleDouble<f64>;
    const WIDTH: usize = B::WIDTH;

    #[inline(always)]
    fn from_f64(_: (), value: f64) -> Self {
        Self {
            hi: B::from_f64((), value),
            lo: B::from_f64((), 0.0),
        }
    }
    fn from_rational(_: (), value: &Rational) -> Self {
        let hi = super::double::nearest_double(value);
        let rest = match Rational::from_f64(hi) {
            Some(hi) => value - hi,
            None => Rational::new(),
        };
        Self {
            hi: B::from_f64((), hi),
            lo: B::from_f64((), super::double::nearest_double(&rest)),
        }
    }
    #[inline(always)]
    fn from_control(_: (), value: &B) -> Self {
        Self {
            hi: value.clone(),
            lo: B::from_f64((), 0.0),
        }
    }
    #[inline(always)]
    fn context(&self) -> Self::Context {}
    fn bits(_: ()) -> u32 {
        106
    }
    #[inline(always)]
    fn set(&mut self, other: &Self) {
        self.hi.set(&other.hi);
        self.lo.set(&other.lo);
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.hi.set_lane(lane, value);
        self.lo.set_lane(lane, 0.0);
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.hi.lane(lane)
    }
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.accumulate(&other.hi, &other.lo);
    }
    #[inline(always)]
    fn sub(&mut self, other: &Self) {
        let mut minus = other.clone();
        minus.neg();
        self.accumulate(&minus.hi, &minus.lo);
    }
    #[inline(always)]
    fn mul(&mut self, other: &Self) {
        let product = Self::product(self, other);
        self.put(product);
    }
    #[inline(always)]
    fn div(&mut self, other: &Self) {
        // Two quotients and a remainder (DWDivDW2): relative error at most 15 u^2.
        let mut first = self.hi.clone();
        first.div(&other.hi);
        let quotient = Self::from_control((), &first);
        let (hi, lo) = Self::product(other, &quotient);
        let mut rest = self.clone();
        let (mut hi, mut lo) = (hi, lo);
        hi.neg();
        lo.neg();
        rest.accumulate(&hi, &lo);
        let mut second = rest.hi;
        second.div(&other.hi);
        self.put(fast_two_sum(&first, &second));
    }
    /// The product and the sum are each rounded to a double-double.
    #[inline(always)]
    fn mul_add(&mut self, a: &Self, b: &Self) {
        let (hi, lo) = Self::product(a, b);
        self.accumulate(&hi, &lo);
    }
    #[inline(always)]
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        let (mut hi, mut lo) = Self::product(a, b);
        hi.neg();
        lo.neg();
        self.accumulate(&hi, &lo);
    }
    #[inline(always)]
    fn mul_single(&mut self, c: &DoubleDouble<f64>) {
        let product = Self::product(&Self::everywhere(c), self);
        self.put(product);
    }
    #[inline(always)]
    fn mul_add_single(&mut self, c: &DoubleDouble<f64>, a: &Self) {
        self.mul_add(&Self::everywhere(c), a);
    }
    #[inline(always)]
    fn mul_sub_single(&mut self, c: &DoubleDouble<f64>, a: &Self) {
        self.mul_sub(&Self::everywhere(c), a);
    }
    #[inline(always)]
    fn neg(&mut self) {
        self.hi.neg();
        self.lo.neg();
    }
    #[inline(always)]
    fn abs(&mut self) {
        let negative = self.hi.less(&B::from_f64((), 0.0));
        let mut minus = self.clone();
        minus.neg();
        self.select(negative, &minus);
    }
    #[inline(always)]
    fn sqrt(&mut self) {
        // One Newton step from the rounded root (Karp and Markstein 1997); 0 stays 0.
        let mut root = self.hi.clone();
        root.sqrt();
        let (mut hi, mut lo) = two_product(&root, &root);
        hi.neg();
        lo.neg();
        let mut rest = self.clone();
        rest.accumulate(&hi, &lo);
        let mut twice = root.clone();
        twice.add(&root);
        let mut correction = rest.hi;
        correction.div(&twice);
        let zero = B::from_f64((), 0.0);
        correction.select(root.less_equal(&zero), &zero);
        self.put(fast_two_sum(&root, &correction));
    }
    #[inline(always)]
    fn less(&self, other: &Self) -> Self::Mask {
        let mut difference = self.clone();
        difference.sub(other);
        difference.hi.less(&B::from_f64((), 0.0))
    }
    #[inline(always)]
    fn less_equal(&self, other: &Self) -> Self::Mask {
        let mut difference = self.clone();
        difference.sub(other);
        difference.hi.less_equal(&B::from_f64((), 0.0))
    }
    #[inline(always)]
    fn select(&mut self, mask: Self::Mask, other: &Self) {
        self.hi.select(mask, &other.hi);
        self.lo.select(mask, &other.lo);
    }
    #[inline(always)]
    fn control(&self) -> B {
        self.hi.clone()
    }
    #[inline(always)]
    fn swap_lane(&mut self, other: &mut Self, lane: usize) {
        self.hi.swap_lane(&mut other.hi, lane);
        self.lo.swap_lane(&mut other.lo, lane);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use crate::random::{Purpose, RandomStream};
    use crate::scalar::MultiplePrecision;

    fn exact(x: &DoubleDouble<f64>) -> MultiplePrecision {
        let mut sum = MultiplePrecision::from_f64(400, x.hi);
        sum.add(&MultiplePrecision::from_f64(400, x.lo));
        sum
    }

    #[test]
    fn operations_are_good_to_a_hundred_bits() {
        let mut stream = RandomStream::new(3, Purpose::Test, 0);
        let mut draw = || {
            let rational = Rational::from((stream.bits() as i64, 1 + (stream.bits() >> 9) as i64));
            DoubleDouble::<f64>::from_rational((), &rational)
        };
        type Operation = (
            fn(&mut DoubleDouble<f64>, &DoubleDouble<f64>),
            fn(&mut MultiplePrecision, &MultiplePrecision),
        );
        let operations: [Operation; 4] = [
            (|a, b| a.add(b), |a, b| a.add(b)),
            (|a, b| a.sub(b), |a, b| a.sub(b)),
            (|a, b| a.mul(b), |a, b| a.mul(b)),
            (|a, b| a.div(b), |a, b| a.div(b)),
        ];
        for _ in 0..2000 {
            let (a, b) = (draw(), draw());
            for (ours, reference) in operations {
                let (mut x, mut y) = (a, exact(&a));
                ours(&mut x, &b);
                reference(&mut y, &exact(&b));
                let mut error = exact(&x);
                error.sub(&y);
                error.abs();
                let mut bound = y.clone();
                bound.abs();
                // Sums may cancel: their error is relative to the larger operand.
                let mut size = exact(&a);
                size.abs();
                bound.max(&size);
                bound.mul(&MultiplePrecision::from_f64(400, 2f64.powi(-102)));
                assert!(error.less_equal(&bound), "{a:?} {b:?}");
            }
            let mut root = a;
            root.abs();
            let size = exact(&root);
            root.sqrt();
            let mut square = exact(&root);
            let exact_root = square.clone();
            square.mul(&exact_root);
            square.sub(&size);
            square.abs();
            let mut bound = size;
            bound.mul(&MultiplePrecision::from_f64(400, 2f64.powi(-100)));
            assert!(square.less_equal(&bound));
        }
    }

    #[test]
    fn lanes_agree_with_one_path() {
        let mut stream = RandomStream::new(4, Purpose::Test, 0);
        let mut wide: Vec<DoubleDouble<Lanes<8>>> =
            (0..3).map(|_| DoubleDouble::from_f64((), 0.0)).collect();
        let mut narrow = vec![vec![DoubleDouble::<f64>::from_f64((), 0.0); 3]; 8];
        for lane in 0..8 {
            for k in 0..3 {
                let value = stream.uniform();
                wide[k].set_lane(lane, value);
                narrow[lane][k].set_lane(0, value);
            }
        }
        fn formula<R: Real>(x: &[R]) -> R {
            let mut r = x[0].clone();
            r.div(&x[1]);
            r.mul_add(&x[1], &x[2]);
            r.sqrt();
            r.mul_sub(&x[0], &x[2]);
            r
        }
        let formula_in_lanes = formula(&wide);
        for lane in 0..8 {
            let one = formula(&narrow[lane]);
            assert_eq!(
                (one.hi, one.lo),
                (
                    formula_in_lanes.hi.lane(lane),
                    formula_in_lanes.lo.lane(lane)
                )
            );
        }
    }
}
