//! Hermite extrapolation through up to four points with their tangents.
//!
//! The polynomial in t through (t_k, x_k, x'_k) at `ahead` is a linear
//! combination of the x_k and x'_k whose weights depend on the t_k only. They are
//! complex numbers, so points on a corner of the path in t serve as well.

use cognate_numeric::scalar::{Complex, Mask, Real};

/// Number of points of a path that are kept, the present one among them.
pub const POINTS: usize = 4;

/// Weights of the points and of their tangents, the newest first.
#[derive(Clone, Debug)]
pub struct Weights<C> {
    /// Weights of the points.
    pub point: [Complex<C>; POINTS],
    /// Weights of the tangents.
    pub tangent: [Complex<C>; POINTS],
}

/// `a - b`. A function, since a closure under `dispatch` cannot be inlined for certain.
#[inline(always)]
fn difference<C: Real>(a: &Complex<C>, b: &Complex<C>) -> Complex<C> {
    let mut d = a.clone();
    d.sub(b);
    d
}

/// `a b`.
#[inline(always)]
fn product<C: Real<Context = ()>>(a: &Complex<C>, b: &Complex<C>) -> Complex<C> {
    let mut c = Complex::zero(());
    c.set_product(a, b);
    c
}

/// Weights for extrapolation to `ahead` from the points at `t`, newest first.
///
/// `history[k]`: in which lanes point k + 1 counts; point 0 always does.
/// The basis function l of a node is 1 there and 0 at the others; with its slope l' there and
/// d = ahead - node, the value has the weight (1 - 2 d l') l^2 and the tangent d l^2.
#[inline(always)]
pub fn weights<C: Real<Context = (), Control = C>>(
    t: &[Complex<C>; POINTS],
    ahead: &Complex<C>,
    history: &[C::Mask; POINTS - 1],
) -> Weights<C> {
    let one = Complex::from_f64((), 1.0, 0.0);
    let zero = Complex::zero(());
    let mut weights = Weights {
        point: std::array::from_fn(|_| zero.clone()),
        tangent: std::array::from_fn(|_| zero.clone()),
    };
    for k in 0..POINTS {
        let d = difference(ahead, &t[k]);
        let mut l = one.clone();
        let mut slope = zero.clone();
        for j in 0..POINTS {
            if j == k {
                continue;
            }
            let inverse = difference(&t[k], &t[j]).inverse();
            let factor = product(&difference(ahead, &t[j]), &inverse);
            let more = product(&l, &factor);
            let mut steeper = slope.clone();
            steeper.add(&inverse);
            if j == 0 {
                l = more;
                slope = steeper;
            } else {
                l.select(history[j - 1], &more);
                slope.select(history[j - 1], &steeper);
            }
        }
        let square = product(&l, &l);
        let mut twice = product(&d, &slope);
        twice.re.add(&twice.re.clone());
        twice.im.add(&twice.im.clone());
        let mut value = one.clone();
        value.sub(&twice);
        value.mul(&square);
        let tangent = product(&d, &square);
        if k == 0 {
            weights.point[0] = value;
            weights.tangent[0] = tangent;
        } else {
            weights.point[k].select(history[k - 1], &value);
            weights.tangent[k].select(history[k - 1], &tangent);
        }
    }
    weights
}

/// Lanes in which at least 2, 3, ... points count.
#[inline(always)]
pub fn at_least<M: Mask>(history: &[M; POINTS - 1]) -> [M; POINTS - 1] {
    let mut least = [M::splat(false); POINTS - 1];
    for &one_more in history {
        for k in (1..POINTS - 1).rev() {
            least[k] = least[k].or(least[k - 1].and(one_more));
        }
        least[0] = least[0].or(one_more);
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_the_right_degree_are_met() {
        let z = |re: f64, im: f64| Complex { re, im };
        let t = [z(0.5, 0.1), z(0.7, 0.0), z(1.0, -0.2), z(1.1, 0.1)];
        let ahead = z(0.3, 0.15);
        for pattern in 0..1 << (POINTS - 1) {
            let history: [bool; POINTS - 1] = std::array::from_fn(|k| pattern >> k & 1 == 1);
            let points = 1 + history.iter().filter(|history| **history).count();
            let degree = 2 * points as u32 - 1;
            let least: [bool; POINTS - 1] = std::array::from_fn(|k| points > k + 1);
            assert_eq!(at_least(&history), least);
            let w = weights::<f64>(&t, &ahead, &history);
            let power = |x: &Complex<f64>, n: u32| {
                let mut p = z(1.0, 0.0);
                for _ in 0..n {
                    p.mul(x);
                }
                p
            };
            for n in 0..=degree {
                let mut sum = z(0.0, 0.0);
                for k in 0..POINTS {
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
