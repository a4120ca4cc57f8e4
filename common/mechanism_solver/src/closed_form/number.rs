//! Number: what Newton's method on the arm computes with.

use num_complex::Complex64;
use std::ops::{Add, Div, Mul, Sub};

/// A real or a complex number.
pub trait Number:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
{
    /// Whether all numbers of the type are real.
    const IS_REAL: bool;
    /// The square of the modulus.
    fn square(self) -> f64;
}

impl Number for f64 {
    const IS_REAL: bool = true;

    fn square(self) -> f64 {
        self * self
    }
}

impl Number for Complex64 {
    const IS_REAL: bool = false;

    fn square(self) -> f64 {
        self.norm_sqr()
    }
}
