//! Polynomials in the values of the second and third joint of an arm: cosine and sine of a turn, or a shift.
//!
//! Powers of a sine above the first are written by cosines, so that equal functions have equal coefficients.

use cognate_kinematics::mechanism::exact::{Angle, double_expression};
use std::collections::BTreeMap;

/// Coefficients below this part of the sum of the products that make them are rounding.
const ROUNDING: f64 = 1e-14;
/// Powers that are kept side by side; higher ones are rare.
const POWERS: usize = 8;
/// Names of the unknowns: cosine and sine of the second joint, then of the third. A shift has the name of the sine.
const NAMES: [&str; 4] = ["c2", "s2", "c3", "s3"];

/// Exponents of cosine and sine of the second joint, then of the third; a shift stands in the place of the sine.
type Exponents = [u8; 4];

/// Whether the second and the third joint turn.
pub type Turns = [bool; 2];

/// A polynomial in cosines and sines of turns, and in shifts.
#[derive(Clone, Debug, PartialEq)]
pub struct JointPolynomial {
    terms: BTreeMap<Exponents, f64>,
    turns: Turns,
}

impl JointPolynomial {
    /// A constant.
    pub fn constant(turns: Turns, value: f64) -> Self {
        let terms = (value != 0.0).then_some(([0; 4], value)).into_iter();
        Self {
            terms: terms.collect(),
            turns,
        }
    }

    /// A constant among polynomials in the same joints.
    #[must_use]
    pub fn constant_like(&self, value: f64) -> Self {
        Self::constant(self.turns, value)
    }

    /// The cosine of a joint, 0 for the second and 1 for the third.
    pub fn cosine(turns: Turns, joint: usize) -> Self {
        Self::unknown(turns, 2 * joint)
    }

    /// The sine of a joint that turns, the shift of one that does not.
    pub fn sine(turns: Turns, joint: usize) -> Self {
        Self::unknown(turns, 2 * joint + 1)
    }

    fn unknown(turns: Turns, place: usize) -> Self {
        let mut exponents = [0; 4];
        exponents[place] = 1;
        Self {
            terms: BTreeMap::from([(exponents, 1.0)]),
            turns,
        }
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        for (exponents, value) in &other.terms {
            *sum.terms.entry(*exponents).or_default() += value;
        }
        sum
    }

    /// The difference.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.scaled(-1.0))
    }

    /// The product with a number.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let terms = self.terms.iter().map(|(e, value)| (*e, factor * value));
        Self {
            terms: terms.filter(|(_, value)| *value != 0.0).collect(),
            turns: self.turns,
        }
    }

    /// The product.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::constant(self.turns, 0.0);
        for (a, x) in &self.terms {
            for (b, y) in &other.terms {
                product.add(std::array::from_fn(|k| a[k] + b[k]), x * y);
            }
        }
        product
    }

    /// Adds a term, with squares of sines written by cosines.
    fn add(&mut self, mut exponents: Exponents, value: f64) {
        for joint in 0..2 {
            let (cosine, sine) = (2 * joint, 2 * joint + 1);
            if self.turns[joint] && exponents[sine] >= 2 {
                exponents[sine] -= 2;
                self.add(exponents, value);
                exponents[cosine] += 2;
                self.add(exponents, -value);
                return;
            }
        }
        *self.terms.entry(exponents).or_default() += value;
    }

    /// The derivative by a joint's value, 0 for the second joint and 1 for the third.
    #[must_use]
    pub fn derivative(&self, joint: usize) -> Self {
        let (cosine, sine) = (2 * joint, 2 * joint + 1);
        let mut derivative = Self::constant(self.turns, 0.0);
        for (exponents, value) in &self.terms {
            let [c, s] = [exponents[cosine], exponents[sine]];
            let mut moved = |by: [i8; 2], factor: f64| {
                let mut exponents = *exponents;
                exponents[cosine] = exponents[cosine].wrapping_add_signed(by[0]);
                exponents[sine] = exponents[sine].wrapping_add_signed(by[1]);
                derivative.add(exponents, factor * value);
            };
            if self.turns[joint] {
                if c > 0 {
                    moved([-1, 1], -f64::from(c));
                }
                if s > 0 {
                    moved([1, -1], f64::from(s));
                }
            } else if s > 0 {
                moved([0, -1], f64::from(s));
            }
        }
        derivative
    }

    /// Without the coefficients that are rounding where sums of this size cancel.
    #[must_use]
    pub fn rounded(mut self, size: f64) -> Self {
        self.terms.retain(|_, value| value.abs() > ROUNDING * size);
        self
    }

    /// The sum of the absolute values of the coefficients: a bound of the values where all joints turn.
    pub fn bound(&self) -> f64 {
        self.terms.values().map(|value| value.abs()).sum()
    }

    /// A bound of the second derivatives in directions of length 1, where all joints turn (S. Bernstein 1912).
    pub fn second_derivative_bound(&self) -> f64 {
        let square = |[a, b]: [u8; 2]| f64::from(a + b) * f64::from(a + b);
        let terms = self.terms.iter();
        let bounds =
            terms.map(|([a, b, c, d], value)| value.abs() * (square([*a, *b]) + square([*c, *d])));
        bounds.sum()
    }

    /// Whether no coefficient is left.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// Whether no joint stands in it.
    pub fn is_constant(&self) -> bool {
        self.terms.keys().all(|exponents| *exponents == [0; 4])
    }

    /// The value at cosine and sine (0 and shift) of both joints.
    pub fn value(&self, at: &[f64; 4]) -> f64 {
        let mut powers = [[1.0; POWERS]; 4];
        for (row, x) in powers.iter_mut().zip(at) {
            for k in 1..POWERS {
                row[k] = row[k - 1] * x;
            }
        }
        let power = |k: usize, e: u8| match powers[k].get(usize::from(e)) {
            Some(power) => *power,
            None => at[k].powi(i32::from(e)),
        };
        let term = |[a, b, c, d]: [u8; 4]| power(0, a) * power(1, b) * power(2, c) * power(3, d);
        self.terms.iter().map(|(e, value)| value * term(*e)).sum()
    }

    /// The polynomial as it stands in equations.
    pub fn expression(&self) -> String {
        let term = |(exponents, value): (&Exponents, &f64)| {
            let mut text = double_expression(*value);
            for (name, power) in NAMES.iter().zip(exponents) {
                match power {
                    0 => {}
                    1 => text.push_str(&format!("*{name}")),
                    power => text.push_str(&format!("*{name}^{power}")),
                }
            }
            text
        };
        let terms: Vec<String> = self.terms.iter().map(term).collect();
        match terms.is_empty() {
            true => "0".into(),
            false => format!("({})", terms.join("+")),
        }
    }

    /// The coefficients by powers of the third joint's cosine and sine, each a polynomial in the second joint.
    pub fn by_third_joint(&self) -> BTreeMap<[u8; 2], Self> {
        let mut parts: BTreeMap<[u8; 2], Self> = BTreeMap::new();
        for (exponents, value) in &self.terms {
            let [a, b, c, d] = *exponents;
            let zero = || Self::constant(self.turns, 0.0);
            parts
                .entry([c, d])
                .or_insert_with(zero)
                .add([a, b, 0, 0], *value);
        }
        parts
    }
}

impl JointPolynomial {
    /// The coefficients by powers of the third joint's cosine and sine, of a polynomial in the third joint alone.
    pub fn third_coefficients(&self) -> BTreeMap<[u8; 2], f64> {
        let alone = self.terms.iter().filter(|(e, _)| e[0] == 0 && e[1] == 0);
        alone.map(|(e, value)| ([e[2], e[3]], *value)).collect()
    }
}

/// Names of the unknowns of a joint, 0 for the second and 1 for the third.
pub fn unknowns(turns: Turns, joint: usize) -> Vec<String> {
    let names = &NAMES[2 * joint..2 * joint + 2];
    let names = if turns[joint] { names } else { &names[1..] };
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// Cosine and sine of two joint values; 0 and the shift.
pub fn place(turns: Turns, values: [f64; 2]) -> [f64; 4] {
    let [a, b] = [0, 1].map(|k| match turns[k] {
        true => Angle::of_radians(values[k]).direction,
        false => [0.0, values[k]],
    });
    [a[0], a[1], b[0], b[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURNS: Turns = [true, true];

    #[test]
    fn squares_of_cosine_and_sine_add_to_one() {
        let (c, s) = (
            JointPolynomial::cosine(TURNS, 1),
            JointPolynomial::sine(TURNS, 1),
        );
        let sum = c.times(&c).plus(&s.times(&s)).rounded(1.0);
        assert_eq!(sum, JointPolynomial::constant(TURNS, 1.0));
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let (c, s) = (
            JointPolynomial::cosine(TURNS, 0),
            JointPolynomial::sine(TURNS, 1),
        );
        let f = c
            .times(&s)
            .times(&s)
            .plus(&c.times(&c).scaled(0.7))
            .plus(&s);
        let step = 1e-5;
        for joint in 0..2 {
            let at = |by: f64| {
                let mut values = [0.4, 1.1];
                values[joint] += by;
                f.value(&place(TURNS, values))
            };
            let difference = (at(step) - at(-step)) / (2.0 * step);
            let derivative = f.derivative(joint).value(&place(TURNS, [0.4, 1.1]));
            assert!((difference - derivative).abs() < 1e-9);
        }
        let shift = JointPolynomial::sine([true, false], 1);
        let square = shift.times(&shift);
        assert_eq!(square.derivative(1).value(&[1.0, 0.0, 0.0, 3.0]), 6.0);
    }
}
