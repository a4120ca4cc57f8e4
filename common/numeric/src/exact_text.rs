//! Dyadic numbers as text, every bit of them: `-0x1fp-3` is -31/8. What bounds of intervals are.

use crate::rational::Rational;

/// Exponents are smaller than this in modulus.
const MOST_EXPONENT: i32 = 1 << 20;

/// A dyadic number: sign, `0x`, an odd integer in hexadecimal digits, `p`, a power of two in
/// decimal digits. `None` for a number that is not dyadic.
pub fn exact_text(value: &Rational) -> Option<String> {
    let (numerator, denominator) = (value.numer(), value.denom());
    if !denominator.is_power_of_two() {
        return None;
    }
    let down = i64::from(denominator.significant_bits()) - 1;
    if let Some(small) = numerator.to_i64() {
        return Some(text(small < 0, small.unsigned_abs(), -down));
    }
    let up = i64::from(numerator.find_one(0).unwrap_or(0));
    let odd = rug::Integer::from(numerator >> u32::try_from(up).ok()?);
    let sign = if odd < 0 { "-" } else { "" };
    Some(format!("{sign}0x{:x}p{}", odd.abs(), up - down))
}

/// A double, which is dyadic; `None` for one that is not finite.
pub fn exact_text_of_double(value: f64) -> Option<String> {
    const STORED_BITS: u32 = f64::MANTISSA_DIGITS - 1;
    let bits = value.to_bits();
    let stored = bits & ((1 << STORED_BITS) - 1);
    // Numbers without a leading 1 have the exponent of the smallest with it.
    let exponent = i64::from((bits >> STORED_BITS) as u16 & 0x7ff);
    let significand = stored | u64::from(exponent > 0) << STORED_BITS;
    value
        .is_finite()
        .then(|| text(value < 0.0, significand, exponent.max(1) - 1075))
}

/// `-significand * 2^exponent` or without the sign.
fn text(negative: bool, significand: u64, exponent: i64) -> String {
    if significand == 0 {
        return "0x0p0".into();
    }
    let up = significand.trailing_zeros();
    let sign = if negative { "-" } else { "" };
    format!(
        "{sign}0x{:x}p{}",
        significand >> up,
        exponent + i64::from(up)
    )
}

/// Reads what [`exact_text`] wrote; `None` for anything else.
pub fn read_exact(text: &str) -> Option<Rational> {
    let (negative, rest) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text),
    };
    let (digits, exponent) = rest.strip_prefix("0x")?.split_once('p')?;
    let digits = rug::Integer::from_str_radix(digits, 16).ok()?;
    // Larger powers are no numbers that arise here, and would fill the memory.
    let exponent: i32 = exponent
        .parse()
        .ok()
        .filter(|e: &i32| e.abs() < MOST_EXPONENT)?;
    let value = Rational::from(if negative { -digits } else { digits });
    Some(value << exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_comes_back() {
        for (value, text) in [
            (Rational::new(), "0x0p0"),
            (Rational::from((-31, 8)), "-0x1fp-3"),
            (Rational::from(96), "0x3p5"),
            (Rational::from_f64(0.1).unwrap(), "0xccccccccccccdp-55"),
        ] {
            assert_eq!(exact_text(&value).as_deref(), Some(text));
            assert_eq!(read_exact(text), Some(value));
        }
        for x in [
            f64::MIN_POSITIVE,
            f64::MAX,
            -1e-300,
            f64::from_bits(1),
            0.1,
            -0.0,
        ] {
            let value = Rational::from_f64(x).unwrap();
            assert_eq!(exact_text(&value), exact_text_of_double(x));
            assert_eq!(read_exact(&exact_text(&value).unwrap()), Some(value));
        }
        assert_eq!(exact_text(&Rational::from((1, 3))), None);
        assert_eq!(exact_text_of_double(f64::NEG_INFINITY), None);
        let large = (Rational::from(-3) << 200u32) + 5;
        assert_eq!(read_exact(&exact_text(&large).unwrap()), Some(large));
        for bad in ["", "1p2", "0x1", "0xp", "0x1p1.5", "0x1p99999999999"] {
            assert_eq!(read_exact(bad), None);
        }
    }
}
