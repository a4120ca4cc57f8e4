//! Tests that every enclosing scalar passes: exact results of random expressions lie in the rounded ones.

use super::Real;
use crate::random::{Purpose, RandomStream};
use crate::rational::Rational;

/// A scalar that encloses.
pub(super) trait Enclosure: Real {
    /// True if the rational is in the enclosure; false if nothing is known.
    fn contains(&self, value: &Rational) -> bool;
    /// False where nothing is known, which is not a fault.
    fn is_known(&self) -> bool;
    /// Upper bound of the moduli in the enclosure; NaN or infinite if nothing is known.
    fn bound(&self) -> f64;
}

/// A random rational, and an enclosure of it that is a point, tight, or wide.
fn leaf<E: Enclosure>(context: E::Context, random: &mut RandomStream) -> (Rational, E) {
    let signed = |random: &mut RandomStream, below: u64| {
        i64::try_from(random.below(2 * below)).unwrap() - i64::try_from(below).unwrap()
    };
    let numerator = signed(random, 1 << 20);
    let denominator = 1 + random.below(1 << 12);
    let mut value = Rational::from((numerator, denominator));
    match random.below(6) {
        // Sizes where doubles overflow, underflow, or lose everything in a sum.
        0 => value <<= i32::try_from(signed(random, 1060)).unwrap(),
        1 => value = Rational::from(signed(random, 3)),
        2 => value = Rational::from((1u64 << 53) + random.below(64)),
        _ => {}
    }
    let mut enclosure = E::from_rational(context, &value);
    if random.below(3) == 0 {
        let width = Rational::from((random.below(1000), 1 + random.below(1 << 30)));
        enclosure = E::between(context, &(value.clone() - &width), &(value.clone() + width));
    }
    assert!(enclosure.contains(&value) || !enclosure.is_known());
    (value, enclosure)
}

/// One step of a random expression, in exact and in enclosing numbers.
fn step<E: Enclosure>(
    context: E::Context,
    random: &mut RandomStream,
    exact: &mut Rational,
    value: &mut E,
) {
    let (other, enclosure) = leaf::<E>(context, random);
    let (third, another) = leaf::<E>(context, random);
    match random.below(10) {
        0 => {
            *exact += &other;
            value.add(&enclosure);
        }
        1 => {
            *exact -= &other;
            value.sub(&enclosure);
        }
        2 => {
            *exact *= &other;
            value.mul(&enclosure);
        }
        3 if other != 0 => {
            *exact /= &other;
            value.div(&enclosure);
        }
        4 => {
            *exact += Rational::from(&other * &third);
            value.mul_add(&enclosure, &another);
        }
        5 => {
            *exact -= Rational::from(&other * &third);
            value.mul_sub(&enclosure, &another);
        }
        6 => {
            *exact = exact.clone().abs();
            value.abs();
        }
        7 => {
            *exact = -exact.clone();
            value.neg();
        }
        8 => {
            // The square and its root are |x|.
            value.abs();
            let copy = value.clone();
            value.mul(&copy);
            value.sqrt();
            *exact = exact.clone().abs();
        }
        _ => {
            // Cancels: (x + y) - y.
            value.add(&enclosure);
            value.sub(&enclosure);
        }
    }
}

/// Random expressions: what is exact lies in what was rounded, or nothing is claimed, which is seldom so.
///
/// # Panics
/// Where an exact result is outside.
pub(super) fn check<E: Enclosure>(context: E::Context) {
    for seed in 0..5 {
        let mut random = RandomStream::new(seed, Purpose::Test, 7);
        let mut known_values = 0;
        for _ in 0..2000 {
            let (mut exact, mut value) = leaf::<E>(context, &mut random);
            for _ in 0..8 {
                step(context, &mut random, &mut exact, &mut value);
                if !value.is_known() {
                    break;
                }
                assert!(value.contains(&exact), "{exact} is not in {value:?}");
                let bound = Rational::from_f64(value.bound());
                assert!(bound.is_none_or(|bound| exact.clone().abs() <= bound));
                // Numbers that would outgrow memory begin again.
                if exact.denom().significant_bits() > 20_000 {
                    break;
                }
            }
            if value.is_known() {
                known_values += 1;
            } else {
                assert!(!value.contains(&exact) && !value.bound().is_finite());
            }
        }
        assert!((1000..2000).contains(&known_values), "{known_values}");
    }
}

/// Checks that operations of an unknown with a known number give an unknown, and that comparisons with it are false.
///
/// # Panics
/// If one of them fails.
pub(super) fn check_unknown<E: Enclosure<Mask = bool>>(unknown: &E, enclosure: &E) {
    for operation in [
        Real::add,
        Real::sub,
        Real::mul,
        Real::div,
        Real::max,
        Real::min,
    ] {
        for (mut a, b) in [(unknown.clone(), enclosure), (enclosure.clone(), unknown)] {
            operation(&mut a, b);
            assert!(!a.is_known(), "{a:?}");
        }
    }
    assert!(!unknown.less(enclosure) && !enclosure.less(unknown) && !unknown.less_equal(unknown));
}
