//! Scaling: a power of two for each variable, in whose units a system is tracked.
//!
//! A change of units changes nothing in what a system says, but doubles, tolerances and the
//! decision that a point is at infinity all take 1 for the size of an ordinary number. So the
//! unknowns X_i = x_i / 2^(e_i) are tracked, with the equations multiplied by powers of two, and
//! everything that is shown or read is in x. The exponents are integers: going over is exact.

use cognate_numeric::rational::{ComplexRational, Rational};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Largest exponent of a unit: products of a few of these are doubles still.
pub const MOST_EXPONENT: i32 = 900;

/// Exponents of two, one for each variable; none at all where a system is tracked as it is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Scaling {
    /// e_i: variable i is 2^(e_i) times the unknown that is tracked. All 0 where only the
    /// coefficients need powers of two.
    pub exponents: Vec<i32>,
}

/// `value * 2^exponent`: exact, but for what is too large or too small for a double.
pub fn times_power_of_two(value: f64, exponent: i32) -> f64 {
    const STEP: i32 = 1000;
    let power = |e: i32| f64::from_bits(((1023 + e) as u64) << 52);
    let (mut value, mut left) = (value, exponent);
    while left != 0 {
        let step = left.clamp(-STEP, STEP);
        value *= power(step);
        left -= step;
    }
    value
}

fn complex_times(z: Complex64, exponent: i32) -> Complex64 {
    let part = |v: f64| times_power_of_two(v, exponent);
    Complex64::new(part(z.re), part(z.im))
}

/// `value * 2^exponent`, exact.
pub fn exact_times(value: &ComplexRational, exponent: i64) -> ComplexRational {
    let part = |v: &Rational| {
        let by = u32::try_from(exponent.unsigned_abs()).expect("sizes of numbers are 32-bit");
        match exponent < 0 {
            true => Rational::from(v >> by),
            false => Rational::from(v << by),
        }
    };
    ComplexRational::new(part(&value.re), part(&value.im))
}

impl Scaling {
    /// True where the system is tracked as it is.
    pub fn is_none(&self) -> bool {
        self.exponents.is_empty()
    }

    /// The exponent of one variable.
    pub fn exponent(&self, variable: usize) -> i32 {
        self.exponents.get(variable).copied().unwrap_or(0)
    }

    /// Values of the variables from those of the unknowns that are tracked.
    pub fn to_variables(&self, unknowns: &[Complex64]) -> Vec<Complex64> {
        let each = unknowns.iter().enumerate();
        each.map(|(v, &z)| complex_times(z, self.exponent(v)))
            .collect()
    }

    /// Values of the unknowns that are tracked from those of the variables.
    pub fn to_unknowns(&self, variables: &[Complex64]) -> Vec<Complex64> {
        let each = variables.iter().enumerate();
        each.map(|(v, &z)| complex_times(z, -self.exponent(v)))
            .collect()
    }

    /// Converts one value of an unknown to a value of its variable.
    pub fn to_variable(&self, variable: usize, unknown: Complex64) -> Complex64 {
        complex_times(unknown, self.exponent(variable))
    }

    /// Converts one value of a variable to a value of its unknown.
    pub fn to_unknown(&self, variable: usize, value: Complex64) -> Complex64 {
        complex_times(value, -self.exponent(variable))
    }

    /// Adds one variable in its own units after the first `variables`.
    pub fn with_one_more(&self, variables: usize) -> Self {
        match self.is_none() {
            true => Self::default(),
            false => Self {
                exponents: (0..=variables).map(|v| self.exponent(v)).collect(),
            },
        }
    }

    /// The scaling in the other direction, with all exponents negated.
    pub fn inverse(&self) -> Self {
        Self {
            exponents: self.exponents.iter().map(|e| -e).collect(),
        }
    }
}
