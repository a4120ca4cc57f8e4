//! Roots of unity, correctly rounded: from MPFR, never from libm.

use num_complex::Complex64;
use rug::Float;
use rug::float::Constant;

/// The `degree` numbers z with z^degree = 1, counterclockwise from 1.
pub fn roots_of_unity(degree: u32) -> Vec<Complex64> {
    let pi = Float::with_val(120, Constant::Pi);
    (0..degree)
        .map(|k| {
            // Axis points are exact: the sine of a rounded pi is not 0.
            let eighths = u64::from(k) * 4;
            if eighths % u64::from(degree) == 0 {
                return [
                    Complex64::new(1.0, 0.0),
                    Complex64::new(0.0, 1.0),
                    Complex64::new(-1.0, 0.0),
                    Complex64::new(0.0, -1.0),
                ][(eighths / u64::from(degree)) as usize];
            }
            let angle = Float::with_val(120, &pi * (2 * k)) / degree;
            let (sine, cosine) = angle.sin_cos(Float::new(120));
            Complex64::new(cosine.to_f64(), sine.to_f64())
        })
        .collect()
}

/// The number of modulus 1 at an angle of `turn` / 2^128 of a full turn.
pub fn on_the_circle(turn: u128) -> Complex64 {
    let quarter = 1 << 126;
    if turn.is_multiple_of(quarter) {
        return roots_of_unity(4)[(turn / quarter) as usize];
    }
    let pi = Float::with_val(200, Constant::Pi);
    let angle = Float::with_val(200, Float::with_val(200, turn) * pi) >> 127u32;
    let (sine, cosine) = angle.sin_cos(Float::new(200));
    Complex64::new(cosine.to_f64(), sine.to_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_turns() {
        let i = on_the_circle(1 << 126);
        assert_eq!(i, Complex64::new(0.0, 1.0));
        let eighth = on_the_circle(1 << 125);
        assert_eq!(eighth, roots_of_unity(8)[1]);
        assert!(on_the_circle(u128::MAX).im < 0.0);
    }

    #[test]
    fn powers_are_one() {
        assert_eq!(roots_of_unity(4)[3], Complex64::new(0.0, -1.0));
        for degree in 1..20u32 {
            for root in roots_of_unity(degree) {
                let error = root.powu(degree) - Complex64::new(1.0, 0.0);
                assert!(error.norm_sqr() < 1e-28, "{degree}: {error}");
            }
        }
    }
}
