//! Cognates: the three linkages of one coupler curve (Roberts 1875), and Newton's method for all
//! of them.

use super::Point;
use crate::plane::modulus;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::Complex;
use cognate_systems::evaluation::{Evaluate, Interpreter};
use cognate_systems::named::nine_point;
use num_complex::Complex64;

/// The linkage `p` with its two sides exchanged.
pub fn exchanged(p: &Point) -> Point {
    let [x, xx, a, aa, y, yy, b, bb] = *p;
    [y, yy, b, bb, x, xx, a, aa]
}

/// The three cognates, the linkage itself first. With c = (b x - a y)/(x - y) they are
/// [(a, x), (b, y)], [(a, a - x), (c, y (x - a)/(x - y))], [(b, b - y), (c, x (y - b)/(y - x))],
/// each a pair of (pivot, vector from the coupler point to the joint), and the same in capitals.
///
/// Where x = y or X = Y two of them are at infinity: their coordinates are not finite.
pub fn cognates(p: &Point) -> [Point; 3] {
    let first = next(p);
    let second = next(&exchanged(p));
    [*p, first, second]
}

fn next(p: &Point) -> Point {
    let half = |x: Complex64, a: Complex64, y: Complex64, b: Complex64| {
        let difference = x - y;
        [
            a - x,
            a,
            y * (x - a) / difference,
            (b * x - a * y) / difference,
        ]
    };
    let [x, xx, a, aa, y, yy, b, bb] = *p;
    let [p, q, r, s] = half(x, a, y, b);
    let [pp, qq, rr, ss] = half(xx, aa, yy, bb);
    [p, pp, q, qq, r, rr, s, ss]
}

/// True where every coordinate is a number.
pub fn is_finite(p: &Point) -> bool {
    p.iter().all(|z| z.re.is_finite() && z.im.is_finite())
}

/// How far from degenerate a solution is: the least over the points of
/// |K_j| beside the size of its two terms, K = alpha beta' - alpha' beta, from 0 to 2. Solutions
/// with some K_j = 0 are no linkages.
pub fn least_determinant(p: &Point, parameters: &[Complex64]) -> f64 {
    let [x, xx, a, aa, y, yy, b, bb] = *p;
    let (n, nn, m, mm) = (a * xx, aa * x, b * yy, bb * y);
    let relative_determinant = |d: &[Complex64]| {
        let one = (d[1] * x - nn) * (d[0] * yy - m);
        let two = (d[1] * y - mm) * (d[0] * xx - n);
        modulus(one - two) / modulus(one).max(modulus(two))
    };
    let determinants = parameters.chunks_exact(2).map(relative_determinant);
    // The ratio 0/0 is not known and counts as 0.
    determinants.fold(2.0, |least, k| {
        if k < least {
            k
        } else if k.is_nan() {
            0.0
        } else {
            least
        }
    })
}

/// The system compiled once, for Newton's method in doubles.
pub struct Newton {
    program: Interpreter,
    scratch: <Interpreter as Evaluate<f64>>::Scratch,
    matrix: Matrix<f64>,
}

impl Default for Newton {
    fn default() -> Self {
        Self::new()
    }
}

impl Newton {
    /// Compiles the nine-point system.
    pub fn new() -> Self {
        let system = nine_point().system;
        let program = Interpreter::compile(&system.expressions, &system.equations, 8, 16);
        let scratch = Evaluate::<f64>::scratch(&program, ());
        Self {
            program,
            scratch,
            matrix: Matrix::zeros((), 8, 10),
        }
    }

    /// The point after one step, and the step's length relative to the largest coordinate (and
    /// at least 1); `None` where the Jacobian is singular.
    pub fn step(&mut self, point: &Point, parameters: &[Complex64]) -> Option<(Point, f64)> {
        let native = |values: &[Complex64]| -> Vec<Complex<f64>> {
            let values = values.iter();
            values.map(|z| Complex { re: z.re, im: z.im }).collect()
        };
        let (x, p) = (native(point), native(parameters));
        self.program
            .jacobian(&x, &p, &mut self.matrix, &mut self.scratch);
        eliminate::<f64, 1>(&mut self.matrix, &mut 0.0);
        let step: Point = std::array::from_fn(|k| {
            let z = self.matrix.at(k, 8);
            Complex64::new(z.re, z.im)
        });
        if !is_finite(&step) {
            return None;
        }
        let size = point.iter().map(|&z| modulus(z)).fold(1.0, f64::max);
        let length = step.iter().map(|&z| modulus(z)).fold(0.0, f64::max) / size;
        Some((std::array::from_fn(|k| point[k] - step[k]), length))
    }

    /// Newton's method until it no longer improves: the point, and the length of the last step;
    /// `None` where it does not converge to within 1e-9.
    pub fn polish(&mut self, point: &Point, parameters: &[Complex64]) -> Option<(Point, f64)> {
        const STEPS: usize = 8;
        let mut best: Option<(Point, f64)> = None;
        let mut at = *point;
        for _ in 0..STEPS {
            let (next, length) = self.step(&at, parameters)?;
            // The step says how far `at` was off.
            if best.is_some_and(|(_, before)| length >= before) {
                break;
            }
            best = Some((at, length));
            at = next;
        }
        best.filter(|&(_, length)| length < 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::named::random_four_bar;

    #[test]
    fn cognates_are_solutions_and_a_group() {
        let mut newton = Newton::new();
        let near = |p: &Point, q: &Point| p.iter().zip(q).all(|(a, b)| modulus(a - b) < 1e-8);
        for seed in 0..20 {
            let four_bar = random_four_bar(seed);
            let point: Point = four_bar
                .variables
                .clone()
                .try_into()
                .expect("eight numbers");
            let members = cognates(&point);
            for member in &members {
                let polished = newton.polish(member, &four_bar.parameters);
                let (polished, _) = polished.expect("a regular solution");
                assert!(near(&polished, member), "seed {seed}");
                assert!(least_determinant(member, &four_bar.parameters) > 1e-6);
            }
            // The cognates of a cognate are the same three, with their sides in some order.
            for image in cognates(&members[1]) {
                let is_member = members
                    .iter()
                    .any(|m| near(m, &image) || near(&exchanged(m), &image));
                assert!(is_member, "seed {seed}");
            }
            let mut off = members[2];
            off[0] += 0.3;
            assert!(
                newton
                    .polish(&off, &four_bar.parameters)
                    .is_none_or(|(p, _)| !near(&p, &off))
            );
        }
    }
}
