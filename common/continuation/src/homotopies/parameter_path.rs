//! ParameterPath: how the parameters of a homotopy's program move with t.
//!
//! `p(t) = a + phi(t) b` with `phi(t) = gamma t / (1 + (gamma - 1) t)`, from 0 at
//! t = 0 to 1 at t = 1. For gamma = 1 this is the straight segment; for a random
//! gamma on the unit circle it is an arc through generic complex values, which
//! with probability one meets no singularity (survey, section 6.2; Morgan and
//! Sommese, Coefficient-parameter polynomial continuation, 1989).

use super::toric_path::ToricPath;
use cognate_numeric::scalar::{Complex, Real};
use num_complex::Complex64;

/// The path of the parameters, without the path's own `a` and `b`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterPath {
    /// `gamma`; `None` for the straight segment.
    pub arc: Option<Complex64>,
    /// `a` are coefficients and `b` weights: [`ToricPath`].
    pub toric: Option<ToricPath>,
}

impl ParameterPath {
    /// p(t) and dp/dt in every lane.
    #[inline(always)]
    pub fn at<R: Real>(
        &self,
        context: R::Context,
        t: &Complex<R::Control>,
        a: &[Complex<R>],
        b: &[Complex<R>],
        p: &mut [Complex<R>],
        dp: &mut [Complex<R>],
    ) {
        if let Some(toric) = &self.toric {
            return toric.at(context, t, a, b, p, dp);
        }
        let t = Complex::<R>::from_control(context, t);
        let (phi, derivative) = match self.arc {
            None => (t, Complex::from_f64(context, 1.0, 0.0)),
            Some(gamma) => {
                let mut denominator = Complex::from_f64(context, 1.0, 0.0);
                let minus_one = Complex::from_f64(context, gamma.re - 1.0, gamma.im);
                denominator.mul_add(&minus_one, &t);
                let inverse = denominator.inverse();
                let gamma = Complex::from_f64(context, gamma.re, gamma.im);
                let mut phi = Complex::zero(context);
                phi.set_product(&gamma, &t);
                phi.mul(&inverse);
                let mut derivative = Complex::zero(context);
                derivative.set_product(&gamma, &inverse);
                derivative.mul(&inverse);
                (phi, derivative)
            }
        };
        for (((a, b), p), dp) in a.iter().zip(b).zip(p).zip(dp) {
            p.set(a);
            p.mul_add(&phi, b);
            dp.set_product(&derivative, b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_met_and_the_derivative_agrees_with_differences() {
        for arc in [None, Some(Complex64::new(0.6, -0.8))] {
            let path = ParameterPath { arc, toric: None };
            let at = |t: f64| {
                let (mut p, mut dp) = ([Complex::zero(())], [Complex::zero(())]);
                let t = Complex { re: t, im: 0.0 };
                let a = [Complex { re: 2.0, im: 1.0 }];
                let b = [Complex { re: -1.0, im: 3.0 }];
                path.at::<f64>((), &t, &a, &b, &mut p, &mut dp);
                (p[0], dp[0])
            };
            assert_eq!(at(0.0).0, Complex { re: 2.0, im: 1.0 });
            let end = at(1.0).0;
            assert!((end.re - 1.0).abs() < 1e-14 && (end.im - 4.0).abs() < 1e-14);
            let (before, after, (_, slope)) = (at(0.3 - 1e-5).0, at(0.3 + 1e-5).0, at(0.3));
            assert!(((after.re - before.re) / 2e-5 - slope.re).abs() < 1e-8);
            assert!(((after.im - before.im) / 2e-5 - slope.im).abs() < 1e-8);
        }
    }
}
