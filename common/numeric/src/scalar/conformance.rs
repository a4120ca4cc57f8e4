//! Laws that every scalar passes, written once: `scalar_conformance!(name, Type, context)`.

use super::{Mask, Real};

/// Checks the laws of one scalar type on a few hundred pairs of doubles.
///
/// # Panics
/// Where a law does not hold.
pub fn check<R: Real>(context: R::Context) {
    let values: Vec<f64> = (0..24)
        .map(|k| f64::from(k * k - 97) / f64::from(3 * k + 1))
        .chain([0.0, 1.0, -1.0, 1e-30, 1e30, 0.1])
        .collect();
    for &a in &values {
        for &b in &values {
            let x = R::from_f64(context, a);
            let y = R::from_f64(context, b);
            let each = |r: &R, expected: f64| {
                for lane in 0..R::WIDTH {
                    let error = (r.lane(lane) - expected).abs();
                    assert!(
                        error <= 2.3e-16 * expected.abs(),
                        "{a} and {b}: {} in lane {lane}, {expected} expected",
                        r.lane(lane)
                    );
                }
            };
            let with = |f: &dyn Fn(&mut R)| {
                let mut r = x.clone();
                f(&mut r);
                r
            };
            each(&with(&|r| r.add(&y)), a + b);
            each(&with(&|r| r.sub(&y)), a - b);
            each(&with(&|r| r.mul(&y)), a * b);
            each(&with(&|r| r.neg()), -a);
            each(&with(&|r| r.abs()), a.abs());
            each(&with(&|r| r.max(&y)), a.max(b));
            each(&with(&|r| r.min(&y)), a.min(b));
            if b != 0.0 {
                each(&with(&|r| r.div(&y)), a / b);
            }
            each(
                &with(&|r| {
                    r.abs();
                    r.sqrt();
                }),
                a.abs().sqrt(),
            );
            // Fused: a*b - round(a*b) is what the rounding lost, and exact.
            let product = with(&|r| r.mul(&y));
            let mut lost = product.clone();
            lost.neg();
            lost.mul_add(&x, &y);
            let mut rounding_error = product.clone();
            rounding_error.mul_sub(&x, &y);
            rounding_error.neg();
            for lane in 0..R::WIDTH {
                assert_eq!(lost.lane(lane), rounding_error.lane(lane), "{a} * {b}");
            }
            // A constant for all lanes acts as itself in every lane.
            let single = R::Single::from_f64(context, b);
            each(&with(&|r| r.mul_single(&single)), a * b);
            for sub in [false, true] {
                let mut sum = R::from_f64(context, 0.3);
                let mut expected = sum.clone();
                if sub {
                    sum.mul_sub_single(&single, &x);
                    expected.mul_sub(&y, &x);
                } else {
                    sum.mul_add_single(&single, &x);
                    expected.mul_add(&y, &x);
                }
                for lane in 0..R::WIDTH {
                    assert_eq!(sum.lane(lane), expected.lane(lane), "{a} * {b}");
                }
            }
            assert_eq!(x.less(&y).lane(0), a < b);
            assert_eq!(x.less_equal(&y).lane(R::WIDTH - 1), a <= b);
            let mut chosen = x.clone();
            chosen.select(x.less(&y), &y);
            each(&chosen, a.max(b));
            let mut other = x.clone();
            other.set_lane(R::WIDTH - 1, b);
            assert_eq!(other.lane(R::WIDTH - 1), b);
            if R::WIDTH > 1 {
                assert_eq!(other.lane(0), a);
            }
        }
    }
    let third = R::from_rational(context, &crate::rational::Rational::from((1, 3)));
    assert_eq!(third.lane(0), 1.0 / 3.0);
}

/// Runs the conformance suite of scalars for one type.
#[macro_export]
macro_rules! scalar_conformance {
    ($name:ident, $type:ty, $context:expr) => {
        #[test]
        fn $name() {
            $crate::scalar::conformance::check::<$type>($context);
        }
    };
}

#[cfg(test)]
mod tests {
    use crate::lanes::Lanes;
    use crate::scalar::{DoubleDouble, MultiplePrecision};
    crate::scalar_conformance!(double, f64, ());
    crate::scalar_conformance!(one_lane, Lanes<1>, ());
    crate::scalar_conformance!(eight_lanes, Lanes<8>, ());
    crate::scalar_conformance!(sixteen_lanes, Lanes<16>, ());
    crate::scalar_conformance!(double_double, DoubleDouble<f64>, ());
    crate::scalar_conformance!(eight_double_doubles, DoubleDouble<Lanes<8>>, ());
    crate::scalar_conformance!(multiple_precision_53, MultiplePrecision, 53);
    crate::scalar_conformance!(multiple_precision_200, MultiplePrecision, 200);
}
