//! MPFR through rug: any number of bits, one path at a time.

use super::Real;
use crate::rational::Rational;
use rug::Float;
use rug::float::Round;
use rug::ops::NegAssign;

/// A real number of the precision that its context asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct MultiplePrecision(pub Float);

impl Real for MultiplePrecision {
    /// Precision in bits.
    type Context = u32;
    type Mask = bool;
    type Control = f64;
    type Single = Self;
    const WIDTH: usize = 1;

    fn from_f64(bits: u32, value: f64) -> Self {
        Self(Float::with_val(bits, value))
    }
    fn from_rational(bits: u32, value: &Rational) -> Self {
        Self(Float::with_val(bits, value))
    }
    fn from_control(bits: u32, value: &f64) -> Self {
        Self(Float::with_val(bits, *value))
    }
    fn bits(bits: u32) -> u32 {
        bits
    }
    fn context(&self) -> u32 {
        self.0.prec()
    }
    fn set(&mut self, other: &Self) {
        self.0.clone_from(&other.0);
    }
    fn set_lane(&mut self, _lane: usize, value: f64) {
        let bits = self.0.prec();
        self.0 = Float::with_val(bits, value);
    }
    fn lane(&self, _lane: usize) -> f64 {
        self.0.to_f64()
    }
    fn add(&mut self, other: &Self) {
        self.0 += &other.0;
    }
    fn sub(&mut self, other: &Self) {
        self.0 -= &other.0;
    }
    fn mul(&mut self, other: &Self) {
        self.0 *= &other.0;
    }
    fn div(&mut self, other: &Self) {
        self.0 /= &other.0;
    }
    fn mul_add(&mut self, a: &Self, b: &Self) {
        self.0 += &a.0 * &b.0;
    }
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        self.0 -= &a.0 * &b.0;
    }
    fn mul_single(&mut self, c: &Self) {
        self.mul(c);
    }
    fn mul_add_single(&mut self, c: &Self, a: &Self) {
        self.mul_add(c, a);
    }
    fn mul_sub_single(&mut self, c: &Self, a: &Self) {
        self.mul_sub(c, a);
    }
    fn neg(&mut self) {
        self.0.neg_assign();
    }
    fn abs(&mut self) {
        self.0.abs_mut();
    }
    fn sqrt(&mut self) {
        self.0.sqrt_mut();
    }
    fn less(&self, other: &Self) -> bool {
        self.0 < other.0
    }
    fn less_equal(&self, other: &Self) -> bool {
        self.0 <= other.0
    }
    fn select(&mut self, mask: bool, other: &Self) {
        if mask {
            self.set(other);
        }
    }
    fn control(&self) -> f64 {
        self.0.to_f64_round(Round::Nearest)
    }
}
