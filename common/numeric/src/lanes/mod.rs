//! Lanes: one double of each of `W` paths, a plain array; a scalar like the others.
//!
//! Everything here and above it in a hot loop is `#[inline(always)]`: under
//! `dispatch` a function that is not inlined is compiled without the
//! instruction set and becomes an order of magnitude slower, silently.

pub mod called;
pub mod dispatch;

use crate::rational::Rational;
use crate::scalar::{Mask, Real};

/// One double in each of `W` lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<const W: usize>(pub [f64; W]);

/// One truth value in each of `W` lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<const W: usize>(pub [bool; W]);

impl<const W: usize> Mask for LaneMask<W> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([value; W])
    }
    #[inline(always)]
    fn and(mut self, other: Self) -> Self {
        for i in 0..W {
            self.0[i] &= other.0[i];
        }
        self
    }
    #[inline(always)]
    fn or(mut self, other: Self) -> Self {
        for i in 0..W {
            self.0[i] |= other.0[i];
        }
        self
    }
    #[inline(always)]
    fn not(mut self) -> Self {
        for i in 0..W {
            self.0[i] = !self.0[i];
        }
        self
    }
    #[inline(always)]
    fn any(self) -> bool {
        let mut any = false;
        for i in 0..W {
            any |= self.0[i];
        }
        any
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        self.0[lane]
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: bool) {
        self.0[lane] = value;
    }
}

impl<const W: usize> Real for Lanes<W> {
    type Context = ();
    type Mask = LaneMask<W>;
    type Control = Self;
    type Single = f64;
    const WIDTH: usize = W;

    #[inline(always)]
    fn from_f64(_: (), value: f64) -> Self {
        Self([value; W])
    }
    fn from_rational(_: (), value: &Rational) -> Self {
        Self([f64::from_rational((), value); W])
    }
    #[inline(always)]
    fn from_control(_: (), value: &Self) -> Self {
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
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.0[lane] = value;
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.0[lane]
    }
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        for i in 0..W {
            self.0[i] += other.0[i];
        }
    }
    #[inline(always)]
    fn sub(&mut self, other: &Self) {
        for i in 0..W {
            self.0[i] -= other.0[i];
        }
    }
    #[inline(always)]
    fn mul(&mut self, other: &Self) {
        for i in 0..W {
            self.0[i] *= other.0[i];
        }
    }
    #[inline(always)]
    fn div(&mut self, other: &Self) {
        for i in 0..W {
            self.0[i] /= other.0[i];
        }
    }
    #[inline(always)]
    fn mul_add(&mut self, a: &Self, b: &Self) {
        for i in 0..W {
            self.0[i] = a.0[i].mul_add(b.0[i], self.0[i]);
        }
    }
    #[inline(always)]
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        for i in 0..W {
            self.0[i] = (-a.0[i]).mul_add(b.0[i], self.0[i]);
        }
    }
    #[inline(always)]
    fn mul_single(&mut self, c: &f64) {
        for i in 0..W {
            self.0[i] *= *c;
        }
    }
    #[inline(always)]
    fn mul_add_single(&mut self, c: &f64, a: &Self) {
        for i in 0..W {
            self.0[i] = c.mul_add(a.0[i], self.0[i]);
        }
    }
    #[inline(always)]
    fn mul_sub_single(&mut self, c: &f64, a: &Self) {
        for i in 0..W {
            self.0[i] = (-*c).mul_add(a.0[i], self.0[i]);
        }
    }
    #[inline(always)]
    fn neg(&mut self) {
        for i in 0..W {
            self.0[i] = -self.0[i];
        }
    }
    #[inline(always)]
    fn abs(&mut self) {
        for i in 0..W {
            self.0[i] = self.0[i].abs();
        }
    }
    #[inline(always)]
    fn sqrt(&mut self) {
        for i in 0..W {
            self.0[i] = self.0[i].sqrt();
        }
    }
    #[inline(always)]
    fn less(&self, other: &Self) -> LaneMask<W> {
        let mut mask = LaneMask([false; W]);
        for i in 0..W {
            mask.0[i] = self.0[i] < other.0[i];
        }
        mask
    }
    #[inline(always)]
    fn less_equal(&self, other: &Self) -> LaneMask<W> {
        let mut mask = LaneMask([false; W]);
        for i in 0..W {
            mask.0[i] = self.0[i] <= other.0[i];
        }
        mask
    }
    #[inline(always)]
    fn select(&mut self, mask: LaneMask<W>, other: &Self) {
        for i in 0..W {
            self.0[i] = if mask.0[i] { other.0[i] } else { self.0[i] };
        }
    }
    #[inline(always)]
    fn control(&self) -> Self {
        *self
    }
    #[inline(always)]
    fn swap_lane(&mut self, other: &mut Self, lane: usize) {
        std::mem::swap(&mut self.0[lane], &mut other.0[lane]);
    }
}
