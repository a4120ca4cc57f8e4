//! Digits: one complex number with all its digits, whatever arithmetic it comes from.

use cognate_numeric::scalar::{Complex, Real};
use num_complex::Complex64;

/// A number as a sum of doubles, the largest first: exact for every rung of the ladder, so that
/// a path changes rung without changing place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Digits(Vec<Complex64>);

impl Digits {
    /// The number in one lane.
    pub fn of<R: Real>(z: &Complex<R>, lane: usize) -> Self {
        let mut parts = vec![z.lane(lane)];
        let context = z.re.context();
        let mut rest = z.clone();
        for _ in 1..R::bits(context).div_ceil(53) {
            let last = parts[parts.len() - 1];
            rest.sub(&Complex::from_f64(context, last.re, last.im));
            let next = rest.lane(lane);
            if next == Complex64::default() || !(next.re + next.im).is_finite() {
                break;
            }
            parts.push(next);
        }
        Self(parts)
    }

    /// The number in this arithmetic, the same in every lane.
    pub fn value<R: Real>(&self, context: R::Context) -> Complex<R> {
        let mut sum = Complex::zero(context);
        for part in self.0.iter().rev() {
            sum.add(&Complex::from_f64(context, part.re, part.im));
        }
        sum
    }

    /// Rounded to doubles.
    pub fn rounded(&self) -> Complex64 {
        self.0[0]
    }
}

impl From<Complex64> for Digits {
    fn from(value: Complex64) -> Self {
        Self(vec![value])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::scalar::{DoubleDouble, MultiplePrecision};

    fn third<R: Real>(context: R::Context) -> Complex<R> {
        let mut z = Complex::from_f64(context, 3.0, -7.0);
        z = z.inverse();
        z
    }

    #[test]
    fn no_digit_is_lost_on_the_way_up_and_rounding_is_as_it_should_on_the_way_down() {
        let z = third::<MultiplePrecision>(212);
        assert_eq!(Digits::of(&z, 0).value::<MultiplePrecision>(212), z);
        assert_eq!(
            Digits::of(&z, 0).value::<MultiplePrecision>(848).re.0,
            z.re.0
        );
        let w = third::<DoubleDouble<f64>>(());
        assert_eq!(Digits::of(&w, 0).value::<DoubleDouble<f64>>(()), w);
        let v = Digits::of(&z, 0).value::<f64>(());
        assert_eq!(v.lane(0), Digits::of(&z, 0).rounded());
        assert_eq!(
            Digits::from(Complex64::new(0.0, 0.0)).value::<f64>(()),
            Complex::zero(())
        );
    }
}
