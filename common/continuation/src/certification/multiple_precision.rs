//! Krawczyk's test of one point in intervals of MPFR's numbers, where doubles do not decide.

use super::candidate::Candidate;
use super::certificate::Uncertified;
use super::chart::Chart;
use super::limits::{FARTHEST, INFLATION, MOST_STEPS, SMALLEST_RADIUS, STRONG, TRIES};
use super::proved::Proved;
use cognate_numeric::linear_algebra::inverse::inverse;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::precision::unit_roundoff;
use cognate_numeric::rational::ComplexRational;
use cognate_numeric::scalar::directed::{Directed, Toward};
use cognate_numeric::scalar::{Complex, Interval, MultiplePrecision, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use num_complex::Complex64;

/// Bits at which it begins.
const FIRST_BITS: u32 = 128;
/// Bits at which a point is given up: a Jacobian that is regular by less is as good as singular.
pub const MOST_BITS: u32 = 1024;

type Number = MultiplePrecision;
type Enclosure = Interval<MultiplePrecision>;

/// Tries to prove it with more and more bits.
pub(super) fn prove(
    program: &Interpreter,
    candidate: &Candidate<'_>,
    chart: &Chart,
) -> Result<Proved, Uncertified> {
    let mut reason = Uncertified::NoContraction;
    let mut bits = FIRST_BITS;
    while bits <= MOST_BITS {
        let mut test = Test::new(program, candidate.parameters, &chart.free, bits);
        if bits == FIRST_BITS && !test.encloses() {
            return Err(Uncertified::NoEnclosure);
        }
        match test.run(&chart.point) {
            Ok(proved) => return Ok(proved),
            Err(refusal) => reason = refusal,
        }
        bits *= 2;
    }
    Err(reason)
}

/// One system in the chart of one point, with its work space.
struct Test<'a> {
    program: &'a Interpreter,
    /// The variables that are not fixed at 1.
    free: &'a [usize],
    bits: u32,
    of_points: Scratch<Number>,
    of_boxes: Scratch<Enclosure>,
    parameters: Vec<Complex<Number>>,
    box_parameters: Vec<Complex<Enclosure>>,
}

fn lift<R: Real>(context: R::Context, values: &[Complex64]) -> Vec<Complex<R>> {
    values
        .iter()
        .map(|z| Complex::from_f64(context, z.re, z.im))
        .collect()
}

impl<'a> Test<'a> {
    fn new(
        program: &'a Interpreter,
        parameters: &[Complex64],
        free: &'a [usize],
        bits: u32,
    ) -> Self {
        Self {
            program,
            free,
            bits,
            of_points: program.scratch(bits),
            of_boxes: program.scratch(bits),
            parameters: lift(bits, parameters),
            box_parameters: lift(bits, parameters),
        }
    }

    /// False where a constant or a parameter is not enclosed.
    fn encloses(&mut self) -> bool {
        // At any point at all: an invalid constant spoils the values that it is in.
        let variables = Evaluate::<Number>::shape(self.program).variables;
        let x = vec![Complex::from_f64(self.bits, 1.0, 0.0); variables];
        let values = self.values(&x);
        values.iter().all(Complex::is_valid)
    }

    fn values(&mut self, x: &[Complex<Enclosure>]) -> Vec<Complex<Enclosure>> {
        let mut values = vec![Complex::zero(self.bits); self.free.len()];
        self.program
            .value(x, &self.box_parameters, &mut values, &mut self.of_boxes);
        values
    }

    fn run(&mut self, point: &[Complex64]) -> Result<Proved, Uncertified> {
        let mut x: Vec<Complex<Number>> = lift(self.bits, point);
        let jacobian = self.refine(&mut x, point)?;
        let approximate = inverse(self.bits, &jacobian).ok_or(Uncertified::Singular)?;
        let mut c = Matrix::<Enclosure>::zeros(self.bits, self.free.len(), self.free.len());
        for (entry, value) in c.entries.iter_mut().zip(&approximate.entries) {
            *entry = enclosed(value);
        }
        self.contract(&x, &c)
    }

    /// Newton's method to the end of the arithmetic; returns the Jacobian at the last point.
    fn refine(
        &mut self,
        x: &mut [Complex<Number>],
        start: &[Complex64],
    ) -> Result<Matrix<Number>, Uncertified> {
        let (bits, n, coordinate_count) = (self.bits, self.free.len(), x.len());
        let mut whole = Matrix::<Number>::zeros(bits, n, coordinate_count + 2);
        let mut work = Matrix::<Number>::zeros(bits, n, n + 1);
        let mut jacobian = Matrix::<Number>::zeros(bits, n, n);
        let size = |z: Complex64| z.norm_sqr().sqrt();
        // The largest coordinate, of which the homogenising one is 1.
        let largest = start.iter().fold(1.0, |m: f64, &z| m.max(size(z)));
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            self.program
                .jacobian(x, &self.parameters, &mut whole, &mut self.of_points);
            for i in 0..n {
                for (j, &v) in self.free.iter().enumerate() {
                    work.at_mut(i, j).set(whole.at(i, v));
                    jacobian.at_mut(i, j).set(whole.at(i, v));
                }
                work.at_mut(i, n).set(whole.at(i, coordinate_count));
            }
            eliminate::<Number, 1>(&mut work, &mut 0.0);
            let step = (0..n).fold(0.0, |m, i| larger(size(work.at(i, n).lane(0)), m));
            if !step.is_finite() {
                return Err(Uncertified::Singular);
            }
            if step >= 0.5 * last {
                break; // rounding error is reached, or there is nothing to converge to
            }
            last = step;
            for (i, &v) in self.free.iter().enumerate() {
                x[v].sub(work.at(i, n));
            }
            let moved = x
                .iter()
                .zip(start)
                .fold(0.0, |m: f64, (x, &start)| m.max(size(x.lane(0) - start)));
            if moved.is_nan() || moved > FARTHEST * largest {
                return Err(Uncertified::NewtonLeaves);
            }
            if step <= unit_roundoff(bits) * largest {
                break;
            }
        }
        Ok(jacobian)
    }

    /// Looks for a box that the operator leads into its interior.
    fn contract(
        &mut self,
        x: &[Complex<Number>],
        c: &Matrix<Enclosure>,
    ) -> Result<Proved, Uncertified> {
        let n = self.free.len();
        let centre: Vec<Complex<Enclosure>> = x.iter().map(enclosed).collect();
        let values = self.values(&centre);
        // How far from the centre C F(c) leads, in either part.
        let correction: Vec<f64> = (0..n)
            .map(|i| {
                let mut sum = Complex::<Enclosure>::zero(self.bits);
                for (j, value) in values.iter().enumerate() {
                    sum.mul_add(c.at(i, j), value);
                }
                larger(sum.re.magnitude(), sum.im.magnitude())
            })
            .collect();
        if correction.iter().any(|d| !d.is_finite()) {
            return Err(Uncertified::NoContraction);
        }
        let floor = unit_roundoff(self.bits.min(300));
        let mut radius: Vec<f64> = (0..n)
            .map(|i| {
                let z = x[self.free[i]].lane(0);
                let roundoff = floor * larger(z.re.abs(), z.im.abs());
                (INFLATION * larger(correction[i], roundoff)).max(SMALLEST_RADIUS)
            })
            .collect();
        let mut still_too_wide = false;
        for _ in 0..TRIES {
            let slopes = self.slopes(&centre, &radius, c);
            let contraction = (0..n).fold(0.0, |m: f64, i| {
                let row = (0..n).fold(0.0, |sum, j| above_sum(sum, slopes[i * n + j].0));
                larger(m, row)
            });
            // |K_i - c_i| <= |C F(c)|_i + sum_j (|Re M_ij| + |Im M_ij|) r_j in either part.
            let needed: Vec<f64> = (0..n)
                .map(|i| {
                    (0..n).fold(correction[i], |sum, j| {
                        let slope = &slopes[i * n + j].1;
                        above_sum(sum, f64::product(slope, &radius[j], Toward::Above))
                    })
                })
                .collect();
            let inside = needed.iter().zip(&radius).all(|(need, r)| need < r);
            if contraction < STRONG && inside {
                return Ok(self.proved(x, radius, needed, contraction));
            }
            if contraction < STRONG && needed.iter().all(|need| need.is_finite()) {
                // Some radius is small beside the others: as large as its row asks for.
                for (r, need) in radius.iter_mut().zip(&needed) {
                    *r = larger(*r, 8.0 * need);
                }
                if still_too_wide {
                    break;
                }
            } else {
                // Too wide: nearer to what the correction itself needs.
                still_too_wide = true;
                for (r, d) in radius.iter_mut().zip(&correction) {
                    *r = (0.125 * *r).max(2.0 * d);
                }
            }
        }
        Err(Uncertified::NoContraction)
    }

    /// Bounds of M = 1 - C F'(box): of each entry's modulus, and of |Re| + |Im|.
    fn slopes(
        &mut self,
        centre: &[Complex<Enclosure>],
        radius: &[f64],
        c: &Matrix<Enclosure>,
    ) -> Vec<(f64, f64)> {
        let (bits, n) = (self.bits, self.free.len());
        let mut boxes = centre.to_vec();
        for (&v, &r) in self.free.iter().zip(radius) {
            let side = Interval::around_zero(bits, r);
            boxes[v].re.add(&side);
            boxes[v].im.add(&side);
        }
        let mut whole = Matrix::<Enclosure>::zeros(bits, n, centre.len() + 2);
        self.program
            .jacobian(&boxes, &self.box_parameters, &mut whole, &mut self.of_boxes);
        let mut slopes = Vec::with_capacity(n * n);
        for i in 0..n {
            for (j, &v) in self.free.iter().enumerate() {
                let mut sum = Complex::from_f64(bits, if i == j { 1.0 } else { 0.0 }, 0.0);
                for k in 0..n {
                    sum.mul_sub(c.at(i, k), whole.at(k, v));
                }
                let (re, im) = (sum.re.magnitude(), sum.im.magnitude());
                let squares = above_sum(
                    f64::product(&re, &re, Toward::Above),
                    f64::product(&im, &im, Toward::Above),
                );
                slopes.push((f64::root(&squares, Toward::Above), above_sum(re, im)));
            }
        }
        slopes
    }

    fn proved(
        &self,
        x: &[Complex<Number>],
        radius: Vec<f64>,
        needed: Vec<f64>,
        contraction: f64,
    ) -> Proved {
        let exact = |value: &Number| {
            value
                .to_rational()
                .expect("a point that was proved to be near a solution is finite")
        };
        let centre = x
            .iter()
            .map(|z| ComplexRational::new(exact(&z.re), exact(&z.im)));
        Proved {
            centre: centre.collect(),
            radius,
            needed,
            contraction,
            precision_bits: self.bits,
        }
    }
}

fn enclosed(z: &Complex<Number>) -> Complex<Enclosure> {
    Complex {
        re: Interval::point(&z.re),
        im: Interval::point(&z.im),
    }
}

/// The larger one; NaN where either is.
fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

fn above_sum(a: f64, b: f64) -> f64 {
    f64::sum(&a, &b, Toward::Above)
}
