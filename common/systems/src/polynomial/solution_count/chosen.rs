//! Numbers that somebody chose, and numbers that were rounded.

use crate::expression::{Expressions, Node};
use cognate_numeric::rational::{ComplexRational, Rational};
use rug::Integer;

/// A fraction with a larger denominator was rounded, as a decimal with more digits was.
const LARGEST: u32 = 100_000_000;

/// Whether a number is one that somebody chose: integers, fractions, and decimals of few digits, whatever their power
/// of ten.
pub fn is_chosen(number: &ComplexRational) -> bool {
    part_is_chosen(&number.re) && part_is_chosen(&number.im)
}

fn part_is_chosen(part: &Rational) -> bool {
    if *part.denom() <= LARGEST {
        return true;
    }
    // As a decimal 3.5e-20 is 7/(2 10^19).
    *part.numer().as_abs() <= LARGEST && exponents_of_ten(part.denom()).is_some()
}

/// Whether a number may be a double that a program printed as a fraction, such as 3602879701896397/36028797018963968 for
/// 0.1: exact as it stands, and rounded nevertheless.
fn may_be_double(number: &ComplexRational) -> bool {
    let may_be = |part: &Rational| !part_is_chosen(part) && is_double(part);
    may_be(&number.re) || may_be(&number.im)
}

/// Whether no constant of the expressions may be a double.
pub fn has_exact_constants(expressions: &Expressions) -> bool {
    expressions.nodes().iter().all(|node| match node {
        Node::Constant(number) => !may_be_double(number),
        _ => true,
    })
}

/// Bits of numerator and denominator together from which on a number has many digits: more than nine decimal ones.
const MANY_BITS: u32 = 32;
/// Significant digits of decimals that were rounded: more than a person types, and as many as programs print of a
/// double.
const ROUNDED_DIGITS: std::ops::RangeInclusive<usize> = 9..=20;

/// Whether a number is exact and has many digits. Equations with long numbers may have solutions, and distances between
/// solutions, of very different sizes. A decimal that was rounded has no digits beyond its own, and does not count.
pub fn has_many_digits(number: &ComplexRational) -> bool {
    part_has_many_digits(&number.re) || part_has_many_digits(&number.im)
}

fn part_has_many_digits(part: &Rational) -> bool {
    let bits = part.numer().significant_bits() + part.denom().significant_bits();
    let is_rounded = decimal_digits(part).is_some_and(|n| ROUNDED_DIGITS.contains(&n));
    bits >= MANY_BITS && !is_rounded && !is_double(part)
}

/// Whether a number that is no integer is a double.
fn is_double(part: &Rational) -> bool {
    let is_fraction = *part.denom() != 1 && part.denom().is_power_of_two();
    is_fraction && part.numer().significant_bits() <= f64::MANTISSA_DIGITS
}

/// Significant digits of a decimal that is no integer; `None` of another number.
fn decimal_digits(part: &Rational) -> Option<usize> {
    if *part.denom() == 1 {
        return None;
    }
    let [twos, fives] = exponents_of_ten(part.denom())?;
    let power = |base: u32, exponent: u32| Integer::from(Integer::u_pow_u(base, exponent));
    let places = twos.max(fives);
    let digits = part.numer().clone() * power(2, places - twos) * power(5, places - fives);
    let text = digits.to_string();
    Some(text.trim_start_matches('-').trim_end_matches('0').len())
}

/// The exponents of 2 and 5 in a denominator that has no other prime factors: that of a decimal.
fn exponents_of_ten(denominator: &Integer) -> Option<[u32; 2]> {
    let split = |n: &Integer, factor: u32| n.clone().remove_factor(&Integer::from(factor));
    let (without_two, twos) = split(denominator, 2);
    let (rest, fives) = split(&without_two, 5);
    (rest == 1).then_some([twos, fives])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_decimals_have_no_digits_beyond_their_own() {
        let many = |numerator: &str, denominator: &str| {
            let integer =
                |text: &str| -> Integer { text.parse().expect("an integer of this test") };
            part_has_many_digits(&Rational::from((integer(numerator), integer(denominator))))
        };
        assert!(!many("355", "113") && !many("71", "200") && !many("-1929", "15625"));
        // 600001/100000, 700000002304/125, a decimal of 21 digits.
        assert!(many("600001", "100000") && many("700000002304", "1125"));
        assert!(many("724999979000248899979", "100000000000000000000"));
        // 0.1234567890123 and a double.
        assert!(!many("1234567890123", "10000000000000"));
        assert!(!many("59999999999999998", "100000000000000000"));
        assert!(!many("5404319552844595", "9007199254740992"));
        assert!(many("12345678901", "1"), "an integer is exact");
    }

    #[test]
    fn fractions_that_are_doubles_are_told_from_others() {
        let is = |numerator: i64, denominator: i64| {
            may_be_double(&ComplexRational::real(Rational::from((
                numerator,
                denominator,
            ))))
        };
        assert!(is(3_602_879_701_896_397, 36_028_797_018_963_968), "0.1");
        assert!(!is(3, 4) && !is(5, 1) && !is(4_000_000_000_001, 500_000_000_000));
    }

    #[test]
    fn short_decimals_are_chosen_and_long_ones_rounded() {
        let chosen = |numerator: i64, denominator: &str| {
            let denominator: Integer = denominator.parse().expect("an integer of this test");
            is_chosen(&ComplexRational::real(Rational::from((
                numerator,
                denominator,
            ))))
        };
        assert!(chosen(1, "3") && chosen(-355, "113") && chosen(123_456_789_012, "1"));
        assert!(chosen(1, "1000000000000000000") && chosen(-7, "20000000000000000000"));
        assert!(!chosen(3_333_333_333, "10000000000") && !chosen(1, "3000000000"));
    }
}
