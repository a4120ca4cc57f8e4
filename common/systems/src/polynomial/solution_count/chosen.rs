//! Numbers that somebody chose, and numbers that were rounded.

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
    // As a decimal 3.5e-20 is 7/(2 10^19): of its denominator only 2 and 5 are factors.
    let without = |n: &Integer, factor: u32| n.clone().remove_factor(&Integer::from(factor)).0;
    *part.numer().as_abs() <= LARGEST && without(&without(part.denom(), 2), 5) == 1
}

#[cfg(test)]
mod tests {
    use super::*;

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
