//! A solution followed with proof: boxes around pieces of its curve in each of which there is one solution for every s.
//!
//! A piece is the box m(s) + [-r, r] with m linear in s. Krawczyk's operator maps it into its interior for all s of the
//! piece at once (R. B. Kearfott and Z. Xing, An interval step control for continuation methods, 1994). Where two pieces
//! meet, a solution that is known within a smaller box lies in both: so they follow the same one, and no leap to another
//! branch is possible.

use super::curve::{
    Curve, Rectangle, above_product, above_sum, around, contracted, exactly, larger, largest_part,
    times,
};
use cognate_numeric::scalar::directed::{Directed, Toward};
use cognate_numeric::scalar::{Interval, Real};
use num_complex::Complex64;

/// The longest first piece.
const FIRST: f64 = 0.25;
/// Pieces shorter than this are not tried: a fold is near.
const SHORTEST: f64 = 1.0 / ((1 << 24) as f64);
/// Boxes are no smaller than this part of the largest coordinate.
const SMALLEST_BOX: f64 = 1e-11;

/// A box around a point in which there is exactly one solution, and a smaller box that holds it.
#[derive(Clone, Debug)]
pub struct Located {
    /// The middle.
    pub point: Vec<Complex64>,
    /// Half of the sides of the box in which there is no other solution.
    pub radius: Vec<f64>,
    /// Half of the sides of the box that holds the solution.
    pub error: Vec<f64>,
}

/// Where a followed solution ended.
#[derive(Clone, Debug)]
pub enum Followed {
    /// At s = 1.
    Arrived(Located),
    /// Before it: the last place that was reached.
    Stopped {
        /// The last s.
        s: f64,
        /// The solution there.
        point: Vec<Complex64>,
    },
}

impl Located {
    /// The box that holds the solution, in the free variables.
    fn inner(&self, curve: &Curve<'_>) -> Vec<Rectangle> {
        let error = |(k, v): (usize, &usize)| widened(exactly(self.point[*v]), self.error[k]);
        curve.free.iter().enumerate().map(error).collect()
    }

    /// Whether another's solution is this one: it lies where there is no other.
    pub fn holds(&self, other: &Self, curve: &Curve<'_>) -> bool {
        let inner = other.inner(curve);
        curve
            .free
            .iter()
            .enumerate()
            .all(|(k, v)| inner[k].is_inside(&widened(exactly(self.point[*v]), self.radius[k])))
    }
}

fn widened(mut z: Rectangle, radius: f64) -> Rectangle {
    let side = Interval::around_zero((), radius);
    z.re.add(&side);
    z.im.add(&side);
    z
}

/// Newton's method at one s; `None` where it does not converge.
pub fn refined(curve: &mut Curve<'_>, x: &[Complex64], s: f64) -> Option<Vec<Complex64>> {
    let n = curve.free.len();
    let mut x = x.to_vec();
    let mut last = f64::INFINITY;
    for _ in 0..12 {
        let approximate = curve.inverse(&x, s, n)?;
        let linear = curve.linear(&x, s);
        let mut size = 0.0f64;
        let mut steps = Vec::new();
        for i in 0..n {
            let mut step = Complex64::default();
            for j in 0..n {
                let (entry, value) = (approximate.at(i, j), linear.value(j));
                step += Complex64::new(entry.re, entry.im) * Complex64::new(value.re, value.im);
            }
            size = larger(size, step.norm_sqr());
            steps.push(step);
        }
        if !size.is_finite() {
            return None;
        }
        if size >= 0.25 * last {
            break;
        }
        last = size;
        for (v, step) in curve.free.iter().zip(steps) {
            x[*v] -= step;
        }
    }
    (last < 1e-16 * (1.0 + scale(&x) * scale(&x))).then_some(x)
}

fn scale(x: &[Complex64]) -> f64 {
    x.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max).sqrt()
}

/// The solution near a point at one s, with its boxes.
pub fn located(curve: &mut Curve<'_>, x: &[Complex64], s: f64) -> Option<Located> {
    let point = refined(curve, x, s)?;
    let n = curve.free.len();
    let approximate = curve.inverse(&point, s, n)?;
    let middle: Vec<Rectangle> = point.iter().map(|z| exactly(*z)).collect();
    let here = Interval::point(&s);
    let values = curve.enclosure(&middle, &here);
    let values: Vec<Rectangle> = (0..n).map(|i| values.value(i).clone()).collect();
    let correction: Vec<f64> = times(&approximate, &values)
        .iter()
        .map(largest_part)
        .collect();
    let floor = SMALLEST_BOX * scale(&point);
    let mut radius: Vec<f64> = correction.iter().map(|d| larger(64.0 * d, floor)).collect();
    for _ in 0..3 {
        let mut boxes = middle.clone();
        for (v, r) in curve.free.iter().zip(&radius) {
            boxes[*v] = widened(boxes[*v].clone(), *r);
        }
        let slopes = curve.enclosure(&boxes, &here);
        if let Some(error) = contracted(&approximate, &slopes, &correction, &radius) {
            return Some(Located {
                point,
                radius,
                error,
            });
        }
        for (r, d) in radius.iter_mut().zip(&correction) {
            *r = larger(0.1 * *r, 2.0 * d);
        }
    }
    None
}

/// A piece of the curve from `from` to `to`.
struct Piece {
    middle_s: f64,
    middle: Vec<Complex64>,
    slope: Vec<Complex64>,
    radius: Vec<f64>,
}

impl Piece {
    /// The box at these s, in the free variables.
    fn at(&self, curve: &Curve<'_>, s: &Interval<f64>) -> Vec<Rectangle> {
        let mut away = s.clone();
        away.sub(&Interval::point(&self.middle_s));
        let away = cognate_numeric::scalar::Complex {
            re: away,
            im: Interval::point(&0.0),
        };
        let free = curve.free.iter().enumerate();
        free.map(|(k, v)| {
            let mut z = exactly(self.middle[*v]);
            z.mul_add(&exactly(self.slope[k]), &away);
            z
        })
        .collect()
    }

    /// Whether a solution that is located at s is the one of this piece.
    fn holds(&self, curve: &Curve<'_>, s: f64, located: &Located) -> bool {
        let line = self.at(curve, &Interval::point(&s));
        let inner = located.inner(curve);
        line.into_iter()
            .zip(&self.radius)
            .zip(&inner)
            .all(|((z, r), inner)| inner.is_inside(&shrunk(z, *r)))
    }
}

/// The rectangle that is `radius` around every number of `line`: smaller than [`widened`], as far as the line is not exact.
fn shrunk(line: Rectangle, radius: f64) -> Rectangle {
    let part = |interval: &Interval<f64>| {
        let low = f64::difference(interval.upper(), &radius, Toward::Above);
        let high = f64::sum(interval.lower(), &radius, Toward::Below);
        Interval::new(low, high)
    };
    cognate_numeric::scalar::Complex {
        re: part(&line.re),
        im: part(&line.im),
    }
}

/// A proved piece from s to s + h near a solution, or nothing.
fn piece(curve: &mut Curve<'_>, x: &[Complex64], s: f64, h: f64) -> Option<Piece> {
    let n = curve.free.len();
    let middle_s = s + 0.5 * h;
    let slope_at = |curve: &mut Curve<'_>, x: &[Complex64], s: f64| {
        let approximate = curve.inverse(x, s, n)?;
        let linear = curve.linear(x, s);
        let slope: Vec<Complex64> = (0..n)
            .map(|i| {
                (0..n).fold(Complex64::default(), |sum, j| {
                    let (entry, by_s) = (approximate.at(i, j), linear.slope(j, n));
                    sum - Complex64::new(entry.re, entry.im) * Complex64::new(by_s.re, by_s.im)
                })
            })
            .collect();
        Some((approximate, slope))
    };
    let (_, slope) = slope_at(curve, x, s)?;
    let mut predicted = x.to_vec();
    for (v, slope) in curve.free.iter().zip(&slope) {
        predicted[*v] += slope * (0.5 * h);
    }
    let middle = refined(curve, &predicted, middle_s)?;
    let (approximate, slope) = slope_at(curve, &middle, middle_s)?;
    let exact: Vec<Rectangle> = middle.iter().map(|z| exactly(*z)).collect();
    let values = curve.enclosure(&exact, &Interval::point(&middle_s));
    let values: Vec<Rectangle> = (0..n).map(|i| values.value(i).clone()).collect();
    let at_middle: Vec<f64> = times(&approximate, &values)
        .iter()
        .map(largest_part)
        .collect();
    let floor = 16.0 * SMALLEST_BOX * scale(&middle);
    let mut piece = Piece {
        middle_s,
        middle,
        slope,
        radius: at_middle.iter().map(|d| larger(2.0 * d, floor)).collect(),
    };
    let whole_interval = around(middle_s, 0.5 * h * (1.0 + 1e-12));
    for _ in 0..4 {
        let mut boxes = exact.clone();
        let line = piece.at(curve, &whole_interval);
        for ((v, z), r) in curve.free.iter().zip(line).zip(&piece.radius) {
            boxes[*v] = widened(z, *r);
        }
        let slopes = curve.enclosure(&boxes, &whole_interval);
        // By the mean value theorem in s: F(m(s)) is within h/2 times the derivative along the line.
        let along: Vec<Rectangle> = (0..n)
            .map(|i| {
                let mut sum = slopes.slope(i, n).clone();
                for (j, slope) in piece.slope.iter().enumerate() {
                    sum.mul_add(slopes.slope(i, j), &exactly(*slope));
                }
                sum
            })
            .collect();
        let half = 0.5 * h * (1.0 + 1e-12);
        let correction: Vec<f64> = times(&approximate, &along)
            .iter()
            .zip(&at_middle)
            .map(|(z, d)| above_sum(*d, above_product(half, largest_part(z))))
            .collect();
        if correction.iter().any(|d| !d.is_finite()) {
            return None;
        }
        if contracted(&approximate, &slopes, &correction, &piece.radius).is_some() {
            return Some(piece);
        }
        for (r, d) in piece.radius.iter_mut().zip(&correction) {
            *r = larger(*r, 2.5 * d);
        }
    }
    None
}

/// Follows a solution from s = 0 to s = 1; `None` where it is not shown to be one at s = 0.
pub fn follow(curve: &mut Curve<'_>, x: &[Complex64]) -> Option<Followed> {
    let mut solution = located(curve, x, 0.0)?;
    let (mut s, mut h) = (0.0f64, FIRST);
    while s < 1.0 {
        if h < SHORTEST {
            return Some(Followed::Stopped {
                s,
                point: solution.point,
            });
        }
        let end = if s + h >= 1.0 { 1.0 } else { s + h };
        let next = piece(curve, &solution.point, s, end - s)
            .filter(|piece| piece.holds(curve, s, &solution))
            .and_then(|piece| {
                let ahead = piece.at(curve, &Interval::point(&end));
                let mut guess = solution.point.clone();
                for (v, z) in curve.free.iter().zip(&ahead) {
                    guess[*v] = Complex64::new(z.re.lane(0), z.im.lane(0));
                }
                let there = located(curve, &guess, end)?;
                piece.holds(curve, end, &there).then_some(there)
            });
        match next {
            Some(there) => {
                (solution, s, h) = (there, end, 2.0 * h);
            }
            None => h = 0.5 * (end - s),
        }
    }
    Some(Followed::Arrived(solution))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::evaluation::Interpreter;
    use cognate_systems::formats::read;

    fn program(equation: &str) -> Interpreter {
        let text =
            format!(r#"{{"variables": ["x"], "parameters": ["p"], "equations": ["{equation}"]}}"#);
        let system = read("test", text.as_bytes()).unwrap().system;
        Interpreter::compile(&system.expressions, &system.equations, 1, 1)
    }

    fn end(program: &Interpreter, [from, to]: [f64; 2], x: f64) -> Option<Followed> {
        let real = |v: f64| vec![Complex64::new(v, 0.0)];
        let mut curve = Curve::new(program, vec![0], &real(from), &real(to));
        follow(&mut curve, &real(x))
    }

    #[test]
    fn each_root_goes_to_its_own() {
        // x^2 = p: no way from one root to the other as long as p is not 0.
        let program = program("x^2 - p");
        for (x, expected) in [(1.0, 3.0), (-1.0, -3.0)] {
            let Some(Followed::Arrived(root)) = end(&program, [1.0, 9.0], x) else {
                panic!("{x} does not arrive");
            };
            assert!((root.point[0] - expected).norm_sqr() < 1e-24);
            assert!(root.error[0] < root.radius[0] && root.radius[0] < 1e-6);
        }
        // Very near to each other, and still apart.
        let Some(Followed::Arrived(root)) = end(&program, [1.0, 1e-4], 1.0) else {
            panic!("the root is regular all the way");
        };
        assert!((root.point[0] - 1e-2).norm_sqr() < 1e-20);
    }

    #[test]
    fn a_fold_stops_it() {
        let program = program("x^2 - p");
        let Some(Followed::Stopped { s, point }) = end(&program, [1.0, -1.0], 1.0) else {
            panic!("beyond p = 0 there is no real root");
        };
        assert!(s < 0.5 && s > 0.49, "{s}");
        assert!((point[0] * point[0] - (1.0 - 2.0 * s)).norm_sqr() < 1e-20);
        assert!(end(&program, [1.0, 2.0], 0.3).is_none_or(|f| matches!(f, Followed::Arrived(_))));
    }
}
