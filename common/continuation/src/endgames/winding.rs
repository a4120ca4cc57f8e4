//! Winding numbers of sampled closed curves, by sign changes: no arc tangent.

use num_complex::Complex64;

/// Counts how often a sampled curve goes around 0, counterclockwise positive.
///
/// Exact for the polygon through the samples; the curve's own number if no two
/// neighbouring samples are half a turn apart.
#[derive(Clone, Debug, Default)]
pub struct Winding {
    last: Option<Complex64>,
    turns: i32,
}

impl Winding {
    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The next sample of the curve.
    pub fn sample(&mut self, z: Complex64) {
        if let Some(last) = self.last {
            // The segment crosses the negative real axis where the imaginary part
            // changes sign and the crossing lies left of 0.
            let (upper, upper_last) = (z.im >= 0.0, last.im >= 0.0);
            if upper != upper_last {
                let cross = last.re * z.im - last.im * z.re;
                if upper_last && cross > 0.0 {
                    self.turns += 1;
                }
                if upper && cross < 0.0 {
                    self.turns -= 1;
                }
            }
        }
        self.last = Some(z);
    }

    /// Turns so far.
    pub fn turns(&self) -> i32 {
        self.turns
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::roots_of_unity::roots_of_unity;

    #[test]
    fn powers_wind_as_often_as_their_exponent() {
        for exponent in -3..=3i32 {
            for shift in [0.0, 0.3, -0.7] {
                let mut winding = Winding::default();
                let circle = roots_of_unity(16);
                for k in 0..=16 {
                    let z = circle[k % 16].powi(exponent) * Complex64::new(0.8, shift) * 1e-9;
                    winding.sample(z);
                }
                assert_eq!(winding.turns(), exponent);
            }
        }
        let mut around_one = Winding::default();
        for z in roots_of_unity(16) {
            around_one.sample(z + 1.5);
        }
        assert_eq!(around_one.turns(), 0);
    }
}
