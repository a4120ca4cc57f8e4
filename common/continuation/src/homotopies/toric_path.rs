//! ToricPath: coefficients that grow from 0 one after the other, `c s^w` with s from 0 to 1.
//!
//! The polyhedral homotopy of a mixed cell (Huber and Sturmfels 1995) with `s = 1 - t^q`. A term
//! of weight w lives where s is within about 1/w of 1; with q = 1 terms of large weight would
//! all come in a last instant, with larger q that instant is spread over t.
//! Logarithm and exponential are series of our own: nothing from libm.

use cognate_numeric::scalar::{Complex, Real};

/// Halvings of the logarithm, by square roots, before its series.
const ROOTS: u32 = 7;
/// Terms of the series of the inverse hyperbolic tangent.
const LOGARITHM_TERMS: u32 = 11;
/// Halvings of an exponent before the series, squarings after it.
const SQUARINGS: u32 = 8;
/// Terms of the exponential series.
const EXPONENTIAL_TERMS: u32 = 9;
/// Real parts of exponents below this count as this: e^-60 is nothing beside 1.
const LEAST_EXPONENT: f64 = -60.0;

/// Path of s as a function of t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToricPath {
    /// The exponent q in `s = 1 - t^q`.
    pub exponent: u32,
}

fn real<C: Real<Context = ()>>(value: f64) -> C {
    C::from_f64((), value)
}

/// The principal root of a number with a real part of at least 0.
#[inline(always)]
fn square_root<C: Real<Context = ()>>(z: &Complex<C>) -> Complex<C> {
    let mut size = z.norm_sqr();
    size.sqrt();
    size.add(&z.re);
    size.mul(&real(0.5));
    size.sqrt();
    size.max(&real(1e-150));
    let mut twice = size.clone();
    twice.add(&size);
    let mut im = z.im.clone();
    im.div(&twice);
    Complex { re: size, im }
}

/// ln(1 - z), accurate also where z is small; a large negative number where z is 1.
#[inline(always)]
fn logarithm_of_rest<C: Real<Context = ()>>(z: &Complex<C>) -> Complex<C> {
    let one = Complex::<C>::from_f64((), 1.0, 0.0);
    let mut z = z.clone();
    for _ in 0..ROOTS {
        // 1 - sqrt(1 - z) = z / (1 + sqrt(1 - z)): nothing cancels.
        let mut rest = one.clone();
        rest.sub(&z);
        let mut divisor = square_root(&rest);
        divisor.add(&one);
        z.mul(&divisor.inverse());
    }
    // ln(1 - z) = -2 artanh(z / (2 - z)).
    let mut divisor = Complex::<C>::from_f64((), 2.0, 0.0);
    divisor.sub(&z);
    let mut v = z;
    v.mul(&divisor.inverse());
    let mut square = v.clone();
    square.set_square(&v);
    let mut sum = Complex::<C>::zero(());
    for k in (0..LOGARITHM_TERMS).rev() {
        let mut next = Complex::<C>::from_f64((), 1.0 / f64::from(2 * k + 1), 0.0);
        next.mul_add(&square, &sum);
        sum = next;
    }
    sum.mul(&v);
    sum.scale(&real(-2.0 * f64::from(1u32 << ROOTS)));
    sum
}

/// e^z for real parts that are not positive, up to a relative error of about 1e-13.
#[inline(always)]
fn exponential<C: Real<Context = ()>>(z: &Complex<C>) -> Complex<C> {
    let mut z = z.clone();
    z.re.max(&real(LEAST_EXPONENT));
    z.scale(&real(1.0 / f64::from(1u32 << SQUARINGS)));
    let mut sum = Complex::<C>::from_f64((), 1.0, 0.0);
    for k in (1..=EXPONENTIAL_TERMS).rev() {
        sum.mul(&z);
        sum.scale(&real(1.0 / f64::from(k)));
        sum.re.add(&real(1.0));
    }
    for _ in 0..SQUARINGS {
        let root = sum.clone();
        sum.set_square(&root);
    }
    sum
}

impl ToricPath {
    /// p(t) = c s^w and dp/dt in every lane; the weights w are the real parts of `weights`,
    /// 0 or at least 1.
    #[inline(always)]
    pub fn at<R: Real>(
        &self,
        context: R::Context,
        t: &Complex<R::Control>,
        coefficients: &[Complex<R>],
        weights: &[Complex<R>],
        p: &mut [Complex<R>],
        dp: &mut [Complex<R>],
    ) {
        let one = Complex::<R::Control>::from_f64((), 1.0, 0.0);
        // s = 1 - t^q, ds/dt = -q t^(q-1).
        let mut before = one.clone();
        for _ in 1..self.exponent {
            before.mul(t);
        }
        let mut power = before.clone();
        power.mul(t);
        let mut s = one.clone();
        s.sub(&power);
        let mut slope = before;
        slope.scale(&real(-f64::from(self.exponent)));
        let logarithm = logarithm_of_rest(&power);
        let zero = real::<R::Control>(0.0);
        for (k, c) in coefficients.iter().enumerate() {
            let weight = weights[k].re.control();
            // s^w = s^(w-1) s: the derivative stands beside it, and both are 0 where s is.
            let mut less = weight.clone();
            less.sub(&one.re);
            less.max(&zero);
            let mut exponent = logarithm.clone();
            exponent.scale(&less);
            let power = exponential(&exponent);
            let mut value = power.clone();
            value.mul(&s);
            let mut derivative = power;
            derivative.mul(&slope);
            derivative.scale(&weight);
            value.select(weight.less_equal(&zero), &one);
            let value = Complex::<R>::from_control(context, &value);
            let derivative = Complex::<R>::from_control(context, &derivative);
            p[k].set_product(c, &value);
            dp[k].set_product(c, &derivative);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;

    fn native(z: Complex64) -> Complex<f64> {
        Complex { re: z.re, im: z.im }
    }

    fn at(exponent: u32, weight: f64, t: Complex64) -> (Complex64, Complex64) {
        let path = ToricPath { exponent };
        let c = [native(Complex64::new(0.6, 0.8))];
        let w = [native(Complex64::new(weight, 0.0))];
        let (mut p, mut dp) = (
            [native(Complex64::default())],
            [native(Complex64::default())],
        );
        path.at::<f64>((), &native(t), &c, &w, &mut p, &mut dp);
        let foreign = |z: Complex<f64>| Complex64::new(z.re, z.im);
        (foreign(p[0]), foreign(dp[0]))
    }

    #[test]
    fn integer_weights_are_powers() {
        let c = Complex64::new(0.6, 0.8);
        for q in [1, 3] {
            for t in [
                Complex64::new(0.9, 0.0),
                Complex64::new(0.3, 0.0),
                Complex64::new(1e-3, 0.0),
                Complex64::new(0.05, -0.08),
            ] {
                for w in [0u32, 1, 2, 7, 40, 1000] {
                    let s = Complex64::new(1.0, 0.0) - t.powu(q);
                    let expected = c * s.powu(w);
                    let (coefficient, derivative) = at(q, f64::from(w), t);
                    let error = (coefficient - expected).norm_sqr().sqrt();
                    assert!(
                        error < 1e-12 * expected.norm_sqr().sqrt().max(1e-8),
                        "{q} {t} {w}: {error}"
                    );
                    let slope = t.powu(q - 1) * -f64::from(q);
                    let expected = match w {
                        0 => Complex64::default(),
                        w => c * slope * f64::from(w) * s.powu(w - 1),
                    };
                    let error = (derivative - expected).norm_sqr().sqrt();
                    assert!(
                        error < 1e-12 * expected.norm_sqr().sqrt().max(1e-8),
                        "{q} {t} {w}: {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_ends_are_exact() {
        let one = Complex64::new(1.0, 0.0);
        let c = Complex64::new(0.6, 0.8);
        for q in [1, 2, 4] {
            for w in [0.0, 1.0, 1.5, 300.25, 1e9] {
                assert_eq!(at(q, w, Complex64::default()).0, c);
                let (p, dp) = at(q, w, one);
                let at_start = if w == 0.0 { c } else { Complex64::default() };
                assert_eq!(p, at_start);
                if w == 1.0 {
                    assert_eq!(dp, c * -f64::from(q));
                } else {
                    assert!(dp.norm_sqr() < 1e-30, "{dp}");
                }
            }
        }
    }
}
