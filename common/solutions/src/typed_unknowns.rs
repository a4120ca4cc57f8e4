//! Typed unknowns: solutions in the unknowns that somebody typed, without helpers, with angles in the units in
//! which they were typed.
//!
//! The last step of an answer: everything before is decided in the variables that are tracked. Logarithms are those of
//! MPFR, which are the same on every machine.

use crate::solution::{NamedValue, NamedValues, Solution};
use crate::solution_set::SolutionSet;
use cognate_numeric::decimal_text::complex_text;
use cognate_numeric::rational::ComplexRational;
use cognate_systems::helper_unknown::{AngleUnit, AngleUnknowns};
use cognate_systems::system::System;
use cognate_systems::typed_unknowns::TypedUnknown;
use num_complex::Complex64;
use rug::float::Constant;
use rug::{Complex, Float};

/// Bits of an angle that is rounded to doubles.
const BITS: u32 = 128;

/// Writes the solutions of a set in the typed unknowns of their system.
pub fn write_typed(set: &mut SolutionSet, system: &System) {
    if system.helpers.is_empty() {
        return;
    }
    let typed = system.typed_unknowns();
    let digits = set
        .counts
        .sharpened
        .as_ref()
        .map(|sharpened| sharpened.digits);
    for solution in set.solutions.iter_mut().chain(&mut set.undecided) {
        solution.variables = typed_values(solution, &typed, digits);
    }
}

/// Computes the values of the typed unknowns at a solution in the variables of their system. `digits`: decimal digits of
/// the solution, where it has more than a double.
pub fn typed_values(
    solution: &Solution,
    typed: &[TypedUnknown<'_>],
    digits: Option<u32>,
) -> NamedValues {
    let variables = &solution.variables.0;
    let values = typed.iter().map(|unknown| match unknown {
        TypedUnknown::Variable(v) => variables[*v].clone(),
        TypedUnknown::Angle(angle) => {
            let point = CirclePoint {
                cosine: &variables[angle.cosine],
                sine: &variables[angle.sine],
                accuracy: solution.accuracy.max(f64::EPSILON),
                is_real: solution.real == Some(true),
            };
            point.angle(angle, digits)
        }
    });
    NamedValues(values.collect())
}

/// Cosine and sine of an angle, as far as they are known.
struct CirclePoint<'a> {
    cosine: &'a NamedValue,
    sine: &'a NamedValue,
    accuracy: f64,
    is_real: bool,
}

impl CirclePoint<'_> {
    /// The angle in its unit, with its real part above minus half a turn and at most half a turn.
    fn angle(&self, typed: &AngleUnknowns, digits: Option<u32>) -> NamedValue {
        let has_digits = self.cosine.digits.is_some() || self.sine.digits.is_some();
        let digits = digits.filter(|_| has_digits);
        // A decimal digit is less than four bits.
        let bits = digits.map_or(BITS, |digits| BITS + 4 * digits);
        let (cosine, sine) = (value(self.cosine, bits), value(self.sine, bits));
        let i = Complex::with_val(bits, (0, 1));
        let turned = Complex::with_val(bits, &sine * &i);
        // exp(i a) and exp(-i a): the larger has more digits.
        let forth = Complex::with_val(bits, &cosine + &turned);
        let back = Complex::with_val(bits, &cosine - &turned);
        let size = |z: &Complex| Float::with_val(53, z.norm_ref());
        let angle = match size(&forth) >= size(&back) {
            true => self.of_logarithm(forth, 1),
            false => self.of_logarithm(back, -1),
        };
        let angle = in_unit(angle, typed.unit);
        let exact = |part: &Float| part.to_rational().unwrap_or_default();
        let text = digits.map(|digits| {
            let angle = ComplexRational::new(exact(angle.real()), exact(angle.imag()));
            complex_text(&angle, digits)
        });
        NamedValue {
            name: typed.name.clone(),
            value: Complex64::new(angle.real().to_f64(), angle.imag().to_f64()),
            digits: text,
        }
    }

    /// -i log(z) times a sign. On the negative axis, as far as the accuracy tells, the real part is pi.
    fn of_logarithm(&self, z: Complex, sign: i32) -> Complex {
        let bits = z.prec().0;
        let (re, im) = (z.real().to_f64(), z.imag().to_f64());
        let logarithm = z.ln();
        let mut argument = Float::with_val(bits, logarithm.imag() * sign);
        if re < 0.0 && im.abs() <= -re * self.accuracy && argument.is_sign_negative() {
            argument = -argument;
        }
        let mut growth = Float::with_val(bits, logarithm.real() * -sign);
        if self.is_real || growth.is_zero() {
            growth = Float::new(bits);
        }
        if argument.is_zero() {
            argument = Float::new(bits);
        }
        Complex::with_val(bits, (argument, growth))
    }
}

/// An angle in radians, divided by a unit.
fn in_unit(mut angle: Complex, unit: AngleUnit) -> Complex {
    let pi = Float::with_val(angle.prec().0, Constant::Pi);
    for _ in 0..unit.pi_power {
        angle /= &pi;
    }
    for _ in unit.pi_power..0 {
        angle *= &pi;
    }
    angle * unit.denominator
}

/// The value of a variable with all its digits.
fn value(variable: &NamedValue, bits: u32) -> Complex {
    let part = |digits: Option<&String>, double: f64| {
        let parsed = digits.and_then(|text| Float::parse(text).ok());
        parsed.map_or_else(
            || Float::with_val(bits, double),
            |parsed| Float::with_val(bits, parsed),
        )
    };
    let digits = variable.digits.as_ref();
    let re = part(digits.map(|[re, _]| re), variable.value.re);
    let im = part(digits.map(|[_, im]| im), variable.value.im);
    Complex::with_val(bits, (re, im))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(value: Complex64) -> NamedValue {
        NamedValue {
            name: String::new(),
            value,
            digits: None,
        }
    }

    #[track_caller]
    fn check(cosine: Complex64, sine: Complex64, is_real: bool, expected: Complex64) {
        let point = CirclePoint {
            cosine: &named(cosine),
            sine: &named(sine),
            accuracy: 1e-15,
            is_real,
        };
        let typed = AngleUnknowns {
            name: "a".to_owned(),
            cosine: 0,
            sine: 1,
            unit: AngleUnit::RADIAN,
        };
        let angle = point.angle(&typed, None);
        assert_eq!(angle.name, "a");
        assert!((angle.value - expected).norm_sqr() < 1e-30, "{angle:?}");
        assert!(!is_real || angle.value.im == 0.0);
    }

    #[test]
    fn angles_are_between_minus_pi_and_pi() {
        let real = |re: f64| Complex64::new(re, 0.0);
        let pi = std::f64::consts::PI;
        check(real(1.0), real(0.0), true, real(0.0));
        check(real(0.0), real(-1.0), true, real(-pi / 2.0));
        check(real(-1.0), real(0.0), true, real(pi));
        check(real(-1.0), real(-1e-17), true, real(pi));
        check(real(0.6), real(0.8), true, real(0.927_295_218_001_612_2));
        // cos(a) = 2: a = i acosh 2.
        let imaginary = Complex64::new(0.0, 1.316_957_896_924_816_7);
        check(
            real(2.0),
            Complex64::new(0.0, 3f64.sqrt()),
            false,
            imaginary,
        );
        check(
            real(2.0),
            Complex64::new(0.0, -3f64.sqrt()),
            false,
            -imaginary,
        );
    }
}
