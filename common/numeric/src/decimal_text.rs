//! Numbers as decimal text with as many digits as are meant.

use crate::rational::{ComplexRational, Rational};
use rug::Integer;
use rug::ops::Pow;

/// Above this exponent of ten a number is written with it, and below its negative.
const PLAIN: i64 = 21;

/// The place of a number's first digit: p with 10^p <= |value| < 10^(p+1); `None` for 0.
pub fn first_place(value: &Rational) -> Option<i64> {
    if *value == 0 {
        return None;
    }
    let value = Rational::from(value.abs_ref());
    let bits = |n: &Integer| f64::from(n.significant_bits());
    let mut place =
        ((bits(value.numer()) - bits(value.denom())) * std::f64::consts::LOG10_2) as i64;
    while value < power_of_ten(place) {
        place -= 1;
    }
    while value >= power_of_ten(place + 1) {
        place += 1;
    }
    Some(place)
}

fn power_of_ten(exponent: i64) -> Rational {
    let size = u32::try_from(exponent.unsigned_abs()).expect("exponents of numbers are small");
    let power = Rational::from(Integer::from(10).pow(size));
    if exponent < 0 { power.recip() } else { power }
}

/// A number rounded to a multiple of 10^place, half away from 0: `-0.0125`, `3.20e-31`, `0`.
pub fn decimal_text(value: &Rational, place: i64) -> String {
    let scaled = value * power_of_ten(-place);
    let (_, rounded) = scaled.fract_round(Integer::new());
    let sign = if rounded < 0 { "-" } else { "" };
    let digits = rounded.abs().to_string();
    if digits == "0" {
        return digits;
    }
    let first = digits.len() as i64 - 1 + place;
    let text = if place > 0 || first < -PLAIN / 3 {
        let (head, tail) = digits.split_at(1);
        let point = if tail.is_empty() { "" } else { "." };
        format!("{head}{point}{tail}e{first}")
    } else if first < 0 {
        format!("0.{}{digits}", "0".repeat((-1 - first) as usize))
    } else {
        let (head, tail) = digits.split_at(first as usize + 1);
        let point = if tail.is_empty() { "" } else { "." };
        format!("{head}{point}{tail}")
    };
    format!("{sign}{text}")
}

/// Real and imaginary part to this many digits of the larger of the two.
pub fn complex_text(value: &ComplexRational, digits: u32) -> [String; 2] {
    let places = [first_place(&value.re), first_place(&value.im)];
    let Some(first) = places.into_iter().flatten().max() else {
        return ["0".into(), "0".into()];
    };
    let place = first - i64::from(digits) + 1;
    [
        decimal_text(&value.re, place),
        decimal_text(&value.im, place),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_and_written_as_people_do() {
        let third = Rational::from((1, 3));
        for (value, place, text) in [
            (third.clone(), -5, "0.33333"),
            (Rational::from((-2, 3)), -3, "-0.667"),
            (Rational::from((1, 80)), -4, "0.0125"),
            (Rational::from((1, 80)), -3, "0.013"),
            (Rational::from(12345), 0, "12345"),
            (Rational::from(12345), 2, "1.23e4"),
            (Rational::from(10), -2, "10.00"),
            (Rational::from((999, 1000)), -2, "1.00"),
            (third.clone() >> 40, -15, "3.03e-13"),
            (third, 1, "0"),
        ] {
            assert_eq!(decimal_text(&value, place), text);
        }
    }

    #[test]
    fn first_places_are_exact() {
        for (value, place) in [(1, 0), (9, 0), (10, 1), (99, 1), (1000, 3)] {
            assert_eq!(first_place(&Rational::from(value)), Some(place));
            let inverse = if [1, 10, 1000].contains(&value) {
                -place
            } else {
                -place - 1
            };
            assert_eq!(first_place(&Rational::from((-1, value))), Some(inverse));
        }
        assert_eq!(first_place(&Rational::new()), None);
    }

    #[test]
    fn both_parts_have_the_digits_of_the_number() {
        let z = ComplexRational::new((2, 3), (1, 3_000_000));
        assert_eq!(
            complex_text(&z, 8),
            ["0.66666667", "0.00000033"].map(String::from)
        );
        let noise = ComplexRational::new(1, Rational::from(1) >> 200);
        assert_eq!(complex_text(&noise, 5), ["1.0000", "0"].map(String::from));
    }
}
