//! Jet: a number that moves, as its Taylor coefficients in one real variable. Automatic
//! differentiation of whatever is written for a scalar.

use super::Real;
use crate::lanes::dispatch::{Job, dispatch_baseline};
use crate::rational::Rational;

/// Coefficients that are kept: orders 0 to 4.
pub const TERMS: usize = 5;

/// `c[0] + c[1] s + c[2] s^2 + ...`, cut off behind order 4. Comparisons are of what it is at s = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Jet<S>(pub [S; TERMS]);

impl<S: Real> Jet<S> {
    /// A number that stays.
    #[inline(always)]
    fn constant(value: S) -> Self {
        let context = value.context();
        let mut jet = Self(std::array::from_fn(|_| S::from_f64(context, 0.0)));
        jet.0[0] = value;
        jet
    }

    /// `self += a*b`, or `self -= a*b`, term by term. A call of its own: written out at every place of the
    /// interpreter, with numbers of MPFR, it made a function of half a megabyte, the largest of the program.
    fn accumulate(&mut self, a: &Self, b: &Self, minus: bool) {
        dispatch_baseline(Product {
            sum: self,
            a,
            b,
            minus,
        });
    }
}

/// A product that is added to a sum or taken from it: fused operations are instructions only in what is compiled for
/// an instruction set.
struct Product<'a, S> {
    sum: &'a mut Jet<S>,
    a: &'a Jet<S>,
    b: &'a Jet<S>,
    minus: bool,
}

impl<S: Real> Job for Product<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for k in 0..TERMS {
            for j in 0..=k {
                let (a, b) = (&self.a.0[j], &self.b.0[k - j]);
                match self.minus {
                    false => self.sum.0[k].mul_add(a, b),
                    true => self.sum.0[k].mul_sub(a, b),
                }
            }
        }
    }
}

/// A quotient in place of what is divided: each coefficient from those before it.
struct Quotient<'a, S> {
    divided: &'a mut Jet<S>,
    by: &'a Jet<S>,
}

impl<S: Real> Job for Quotient<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for k in 0..TERMS {
            let (quotients, rest) = self.divided.0.split_at_mut(k);
            for (j, quotient) in quotients.iter().enumerate() {
                rest[0].mul_sub(quotient, &self.by.0[k - j]);
            }
            rest[0].div(&self.by.0[0]);
        }
    }
}

impl<S: Real> Real for Jet<S> {
    type Context = S::Context;
    type Mask = S::Mask;
    type Control = Jet<S::Control>;
    type Single = Self;
    const WIDTH: usize = S::WIDTH;

    #[inline(always)]
    fn from_f64(context: S::Context, value: f64) -> Self {
        Self::constant(S::from_f64(context, value))
    }
    fn from_rational(context: S::Context, value: &Rational) -> Self {
        Self::constant(S::from_rational(context, value))
    }
    #[inline(always)]
    fn from_control(context: S::Context, value: &Self::Control) -> Self {
        Self(std::array::from_fn(|k| {
            S::from_control(context, &value.0[k])
        }))
    }
    fn bits(context: S::Context) -> u32 {
        S::bits(context)
    }
    #[inline(always)]
    fn context(&self) -> S::Context {
        self.0[0].context()
    }
    #[inline(always)]
    fn set(&mut self, other: &Self) {
        for (coefficient, other) in self.0.iter_mut().zip(&other.0) {
            coefficient.set(other);
        }
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.0[0].set_lane(lane, value);
        for term in &mut self.0[1..] {
            term.set_lane(lane, 0.0);
        }
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.0[0].lane(lane)
    }
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        for (coefficient, other) in self.0.iter_mut().zip(&other.0) {
            coefficient.add(other);
        }
    }
    #[inline(always)]
    fn sub(&mut self, other: &Self) {
        for (coefficient, other) in self.0.iter_mut().zip(&other.0) {
            coefficient.sub(other);
        }
    }
    fn mul(&mut self, other: &Self) {
        let a = self.clone();
        *self = Self::from_f64(a.context(), 0.0);
        self.accumulate(&a, other, false);
    }
    fn div(&mut self, other: &Self) {
        dispatch_baseline(Quotient {
            divided: self,
            by: other,
        });
    }
    #[inline(always)]
    fn mul_add(&mut self, a: &Self, b: &Self) {
        self.accumulate(a, b, false);
    }
    #[inline(always)]
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        self.accumulate(a, b, true);
    }
    #[inline(always)]
    fn mul_single(&mut self, c: &Self) {
        self.mul(c);
    }
    #[inline(always)]
    fn mul_add_single(&mut self, c: &Self, a: &Self) {
        self.accumulate(c, a, false);
    }
    #[inline(always)]
    fn mul_sub_single(&mut self, c: &Self, a: &Self) {
        self.accumulate(c, a, true);
    }
    #[inline(always)]
    fn neg(&mut self) {
        self.0.iter_mut().for_each(Real::neg);
    }
    /// |x| is x or -x, whichever is positive at s = 0.
    #[inline(always)]
    fn abs(&mut self) {
        let zero = S::from_f64(self.context(), 0.0);
        let negative = self.0[0].less(&zero);
        let mut turned = self.clone();
        turned.neg();
        self.select(negative, &turned);
    }
    /// r r = a: each coefficient of r from those before it.
    #[inline(always)]
    fn sqrt(&mut self) {
        self.0[0].sqrt();
        let mut twice = self.0[0].clone();
        twice.add(&self.0[0]);
        for k in 1..TERMS {
            let (coefficients, rest) = self.0.split_at_mut(k);
            for j in 1..k {
                rest[0].mul_sub(&coefficients[j], &coefficients[k - j]);
            }
            rest[0].div(&twice);
        }
    }
    #[inline(always)]
    fn less(&self, other: &Self) -> S::Mask {
        self.0[0].less(&other.0[0])
    }
    #[inline(always)]
    fn less_equal(&self, other: &Self) -> S::Mask {
        self.0[0].less_equal(&other.0[0])
    }
    #[inline(always)]
    fn select(&mut self, mask: S::Mask, other: &Self) {
        for (coefficient, other) in self.0.iter_mut().zip(&other.0) {
            coefficient.select(mask, other);
        }
    }
    #[inline(always)]
    fn control(&self) -> Self::Control {
        Jet(std::array::from_fn(|k| self.0[k].control()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Complex;

    fn moving(start: f64, slope: f64) -> Jet<f64> {
        Jet([start, slope, 0.0, 0.0, 0.0])
    }

    fn close(jet: &Jet<f64>, expected: [f64; TERMS]) {
        for (a, b) in jet.0.iter().zip(expected) {
            assert!((a - b).abs() < 1e-14 * (1.0 + b.abs()), "{jet:?}");
        }
    }

    #[test]
    fn series_are_those_of_calculus() {
        // 1/(1 - 2s), sqrt(1 + 4s), (1 + s)^4
        let mut geometric = Jet::from_f64((), 1.0);
        geometric.div(&moving(1.0, -2.0));
        close(&geometric, [1.0, 2.0, 4.0, 8.0, 16.0]);
        let mut root = moving(1.0, 4.0);
        root.sqrt();
        close(&root, [1.0, 2.0, -2.0, 4.0, -10.0]);
        let mut power = moving(1.0, 1.0);
        power.mul(&moving(1.0, 1.0));
        let square = power.clone();
        power.mul(&square);
        close(&power, [1.0, 4.0, 6.0, 4.0, 1.0]);
        let mut size = moving(-3.0, 1.0);
        size.abs();
        close(&size, [3.0, -1.0, 0.0, 0.0, 0.0]);
        let mut sum = moving(0.5, 1.0);
        sum.mul_add(&moving(2.0, 1.0), &moving(3.0, -1.0));
        sum.mul_sub(&moving(0.0, 1.0), &moving(0.0, 1.0));
        close(&sum, [6.5, 2.0, -2.0, 0.0, 0.0]);
    }

    #[test]
    fn complex_numbers_move_as_well() {
        // 1/(1 + i s) = 1 - i s - s^2 + i s^3 + s^4
        let z = Complex {
            re: moving(1.0, 0.0),
            im: moving(0.0, 1.0),
        };
        let inverse = z.inverse();
        close(&inverse.re, [1.0, 0.0, -1.0, 0.0, 1.0]);
        close(&inverse.im, [0.0, -1.0, 0.0, 1.0, 0.0]);
    }
}
