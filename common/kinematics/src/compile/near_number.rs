//! Near number: the short exact number that a double rounds, for chains of which only doubles are kept.
//!
//! Overconstrained loops move by their exact dimensions: 182/85 moves, the double next to it does not.

use crate::mechanism::exact::{Angle, Surd, double_expression, expression};
use cognate_numeric::rational::Rational;

/// Denominators of short fractions. A double is by accident within rounding of one of them about once in 10^5.
const MOST_DENOMINATOR: u64 = 20_000;
/// Fractions that a number may be near by accident, on average, where one of them is taken for it.
const MOST_ACCIDENTS: f64 = 1e-4;
/// A double that comes of a few operations is within this of the number that was meant, relative to it.
const ROUNDING: f64 = 8e-16;

/// The short fraction that a double rounds.
fn short_fraction(x: f64) -> Option<Rational> {
    fraction_within(x, ROUNDING)
}

/// The fraction with a small denominator that is within `tolerance` of a number, relative to it.
fn fraction_within(x: f64, tolerance: f64) -> Option<Rational> {
    if x == 0.0 {
        return Some(Rational::new());
    }
    let (mut h, mut k) = ([1u64, 0], [0u64, 1]);
    let mut rest = x.abs();
    for _ in 0..40 {
        let whole = rest.floor();
        if whole > 1e9 {
            return None;
        }
        let next = |last: [u64; 2]| (whole as u64).checked_mul(last[0])?.checked_add(last[1]);
        h = [next(h)?, h[0]];
        k = [next(k)?, k[0]];
        if k[0] > MOST_DENOMINATOR {
            return None;
        }
        let near = h[0] as f64 / k[0] as f64;
        if (near - x.abs()).abs() <= tolerance * x.abs() {
            let fraction = Rational::from((h[0], k[0]));
            return Some(if x < 0.0 { -fraction } else { fraction });
        }
        rest = 1.0 / (rest - whole);
    }
    None
}

/// A double as text: the short fraction, or root of one, that it rounds, else itself. Says whether it was one.
pub fn near_text(x: f64) -> (String, bool) {
    if let Some(fraction) = short_fraction(x) {
        return (expression(&fraction), true);
    }
    let root = short_fraction(x * x).and_then(|square| Surd::root(&square));
    match root {
        Some(root) if x < 0.0 => (format!("(-{})", root.expression()), true),
        Some(root) => (root.expression(), true),
        None => (double_expression(x), false),
    }
}

/// The short fraction, or root of one, that a computed number is within `tolerance` of, relative to it; as text, and
/// rounded. A number below the square of `tolerance` is 0.
pub fn recognized(x: f64, tolerance: f64) -> Option<(String, f64)> {
    if x.abs() <= tolerance * tolerance {
        return Some(("0".into(), 0.0));
    }
    let no_accident = |x: f64, tolerance: f64| {
        let fraction = fraction_within(x, tolerance)?;
        // About so many fractions with such denominators are within the tolerance of any number of this size.
        let denominator = fraction.denom().to_f64();
        let accidents = denominator * denominator * x.abs() * tolerance;
        (accidents <= MOST_ACCIDENTS).then_some(fraction)
    };
    if let Some(fraction) = no_accident(x, tolerance) {
        return Some((fraction.to_string(), fraction.to_f64()));
    }
    let square = no_accident(x * x, 2.0 * tolerance)?;
    let sign = if x < 0.0 { "-" } else { "" };
    let root = square.to_f64().sqrt();
    Some((format!("{sign}sqrt({square})"), root.copysign(x)))
}

/// Cosine and sine of an angle as text, on the circle exactly. Says whether the angle was recognized.
pub fn near_turn(angle: &Angle) -> ([String; 2], bool) {
    let [w, t] = angle.half;
    if w == 0.0 {
        return (["(-1)", "0"].map(String::from), true);
    }
    let circle = |tangent: &Rational| {
        let square = Rational::from(tangent * tangent);
        let over = Rational::from(&square + 1u32).recip();
        let cosine = Rational::from(1u32 - &square) * &over;
        let sine = Rational::from(tangent * 2u32) * over;
        [cosine, sine].map(|number| expression(&number))
    };
    if let Some(tangent) = short_fraction(t / w) {
        return (circle(&tangent), true);
    }
    let [c, s] = angle.direction;
    let across = |side: &Rational, sign: f64| {
        let square = 1u32 - Rational::from(side * side);
        let root = Surd::root(&square)?.expression();
        Some(if sign < 0.0 {
            format!("(-{root})")
        } else {
            root
        })
    };
    if let Some(cosine) = short_fraction(c)
        && let Some(sine) = across(&cosine, s)
    {
        return ([expression(&cosine), sine], true);
    }
    if let Some(sine) = short_fraction(s)
        && let Some(cosine) = across(&sine, c)
    {
        return ([cosine, expression(&sine)], true);
    }
    let tangent = Rational::from_f64(t / w).unwrap_or_default();
    (circle(&tangent), false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_numbers_are_recognized_where_that_is_no_accident() {
        let text = |x: f64| recognized(x, 1e-11).map(|(text, _)| text);
        for x in [506.348_945_077_434_6, 180.507_279_532_779_14] {
            assert_eq!(text(x), None);
        }
        assert_eq!(text(-5.9e-33).as_deref(), Some("0"));
        assert_eq!(text(182.0 / 85.0).as_deref(), Some("182/85"));
        assert_eq!(text(0.75f64.sqrt()).as_deref(), Some("sqrt(3/4)"));
        assert_eq!(text(300.5).as_deref(), Some("601/2"));
    }

    #[test]
    fn short_numbers_are_recognized() {
        assert_eq!(near_text(182.0 / 85.0), ("(182/85)".into(), true));
        assert_eq!(near_text(-1.56), ("(-39/25)".into(), true));
        assert_eq!(near_text(0.0), ("0".into(), true));
        assert_eq!(near_text(0.75f64.sqrt()), ("(1*sqrt(3/4))".into(), true));
        assert!(!near_text(0.123_456_789_012_345).1);
        let angle = Angle::of_radians(0.643_501_108_793_284_4);
        assert_eq!(
            near_turn(&angle),
            (["(4/5)", "(3/5)"].map(String::from), true)
        );
        let third = Angle::of_degrees(120.0);
        let expected = ["(-1/2)", "(1*sqrt(3/4))"].map(String::from);
        assert_eq!(near_turn(&third), (expected, true));
        assert!(!near_turn(&Angle::of_radians(-0.853)).1);
    }
}
