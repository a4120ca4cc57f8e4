//! Hermite extrapolation through one, two or three points with their tangents.
//!
//! The polynomial in t through (t_k, x_k, x'_k) at `ahead` is a linear
//! combination of the x_k and x'_k whose weights depend on the t_k only. They are
//! complex numbers, so points on a corner of the path in t serve as well.

use cognate_numeric::scalar::{Complex, Mask, Real};

/// Weights of the three points and of their tangents, the newest first.
#[derive(Clone, Debug)]
pub struct Weights<C> {
    /// Weights of the points.
    pub point: [Complex<C>; 3],
    /// Weights of the tangents.
    pub tangent: [Complex<C>; 3],
}

/// Local error order: error grows as step^order with this many points.
pub const ORDER: [f64; 3] = [2.0, 4.0, 6.0];

/// Weights for extrapolation to `ahead` from `t[0]` (newest) with as many points as the masks allow.
///
/// Lanes where `two` is false use one point, where `three` is false at most two.
#[inline(always)]
pub fn weights<C: Real<Context = (), Control = C>>(
    t: [&Complex<C>; 3],
    ahead: &Complex<C>,
    two: C::Mask,
    three: C::Mask,
) -> Weights<C> {
    let difference = |a: &Complex<C>, b: &Complex<C>| {
        let mut d = a.clone();
        d.sub(b);
        d
    };
    let product = |a: &Complex<C>, b: &Complex<C>| {
        let mut c = Complex::zero(());
        c.set_product(a, b);
        c
    };
    let one = Complex::from_f64((), 1.0, 0.0);
    // The basis function with value 1 at its node and 0 at the others, l, gives
    // (1 - 2 d l') l^2 for the value and d l^2 for the slope, d = ahead - node.
    let weigh = |d: &Complex<C>, l: &Complex<C>, slope: &Complex<C>| {
        let square = product(l, l);
        let mut value = product(d, slope);
        value.re.add(&value.re.clone());
        value.im.add(&value.im.clone());
        let mut value_weight = one.clone();
        value_weight.sub(&value);
        value_weight.mul(&square);
        (value_weight, product(d, &square))
    };
    let d = [
        difference(ahead, t[0]),
        difference(ahead, t[1]),
        difference(ahead, t[2]),
    ];
    let a = difference(t[0], t[1]).inverse();
    let b = difference(t[0], t[2]).inverse();
    let c = difference(t[1], t[2]).inverse();
    let zero = Complex::zero(());
    let mut weights = Weights {
        point: [one.clone(), zero.clone(), zero.clone()],
        tangent: [d[0].clone(), zero.clone(), zero],
    };
    if two.any() {
        let l0 = product(&d[1], &a);
        let mut minus_a = a.clone();
        minus_a.neg();
        let l1 = product(&d[0], &minus_a);
        for (k, (l, slope)) in [(l0, &a), (l1, &minus_a)].iter().enumerate() {
            let (value, tangent) = weigh(&d[k], l, slope);
            weights.point[k].select(two, &value);
            weights.tangent[k].select(two, &tangent);
        }
    }
    let all = two.and(three);
    if all.any() {
        let l0 = product(&product(&d[1], &d[2]), &product(&a, &b));
        let mut l1 = product(&product(&d[0], &d[2]), &product(&a, &c));
        l1.neg();
        let l2 = product(&product(&d[0], &d[1]), &product(&b, &c));
        let mut s0 = a.clone();
        s0.add(&b);
        let s1 = difference(&c, &a);
        let mut s2 = b;
        s2.add(&c);
        s2.neg();
        for (k, (l, slope)) in [(l0, s0), (l1, s1), (l2, s2)].iter().enumerate() {
            let (value, tangent) = weigh(&d[k], l, slope);
            weights.point[k].select(all, &value);
            weights.tangent[k].select(all, &tangent);
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_the_right_degree_are_met() {
        let z = |re: f64, im: f64| Complex { re, im };
        let t = [z(0.5, 0.1), z(0.7, 0.0), z(1.0, -0.2)];
        let ahead = z(0.3, 0.15);
        for (points, degree) in [(1, 1), (2, 3), (3, 5)] {
            let w = weights::<f64>([&t[0], &t[1], &t[2]], &ahead, points > 1, points > 2);
            let power = |x: &Complex<f64>, n: u32| {
                let mut p = z(1.0, 0.0);
                for _ in 0..n {
                    p.mul(x);
                }
                p
            };
            for n in 0..=degree {
                let mut sum = z(0.0, 0.0);
                for k in 0..3 {
                    sum.mul_add(&w.point[k], &power(&t[k], n));
                    if n > 0 {
                        let mut slope = power(&t[k], n - 1);
                        slope.scale(&f64::from(n));
                        sum.mul_add(&w.tangent[k], &slope);
                    }
                }
                sum.sub(&power(&ahead, n));
                assert!(sum.norm_sqr() < 1e-24, "{points} points, degree {n}");
            }
        }
    }
}
