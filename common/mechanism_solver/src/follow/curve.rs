//! Curve: the solutions of equations while their parameters move along a segment, evaluated in doubles and in intervals.

use cognate_numeric::linear_algebra::inverse::inverse;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::directed::{Directed, Toward};
use cognate_numeric::scalar::{Complex, Interval, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use num_complex::Complex64;

/// An interval of complex numbers: a rectangle.
pub type Rectangle = Complex<Interval<f64>>;

/// Equations in the variables `free`, the others being held at 1, and the segment on which the parameters are: `start`
/// at s = 0, `end` at s = 1, exactly.
pub struct Curve<'a> {
    program: &'a Interpreter,
    /// The variables that are solved for.
    pub free: Vec<usize>,
    start: Vec<Complex64>,
    end: Vec<Complex64>,
    doubles: Scratch<f64>,
    intervals: Scratch<Interval<f64>>,
}

/// Jacobian by the free variables, values, and the derivative by s.
pub struct Linear<R: Real> {
    matrix: Matrix<R>,
    free: Vec<usize>,
}

impl<R: Real> Linear<R> {
    /// An entry of the Jacobian; the column after the last variable is the derivative by s.
    pub fn slope(&self, row: usize, column: usize) -> &Complex<R> {
        let last = self.matrix.columns() - 1;
        let place = self.free.get(column).copied().unwrap_or(last);
        self.matrix.at(row, place)
    }

    /// The value of an equation.
    pub fn value(&self, row: usize) -> &Complex<R> {
        self.matrix.at(row, self.matrix.columns() - 2)
    }
}

/// A rectangle that holds one number.
pub fn exactly(z: Complex64) -> Rectangle {
    Complex::from_f64((), z.re, z.im)
}

/// The real interval around `middle`, at least so wide.
pub fn around(middle: f64, radius: f64) -> Interval<f64> {
    let mut interval = Interval::around_zero((), radius);
    interval.add(&Interval::point(&middle));
    interval
}

/// A bound of either part of a rectangle's numbers.
pub fn largest_part(z: &Rectangle) -> f64 {
    larger(z.re.magnitude(), z.im.magnitude())
}

/// The larger one; NaN where either is.
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// A bound of a sum.
pub fn above_sum(a: f64, b: f64) -> f64 {
    f64::sum(&a, &b, Toward::Above)
}

/// A bound of a product of numbers that are not negative.
pub fn above_product(a: f64, b: f64) -> f64 {
    f64::product(&a, &b, Toward::Above)
}

impl<'a> Curve<'a> {
    /// A program with as many equations as free variables, or one more where s is an unknown, too.
    pub fn new(
        program: &'a Interpreter,
        free: Vec<usize>,
        start: &[Complex64],
        end: &[Complex64],
    ) -> Self {
        Self {
            program,
            free,
            start: start.to_vec(),
            end: end.to_vec(),
            doubles: program.scratch(()),
            intervals: program.scratch(()),
        }
    }

    fn equations(&self) -> usize {
        Evaluate::<f64>::shape(self.program).equations
    }

    /// The parameters on an interval of s, and their derivative.
    fn parameters(&self, s: &Interval<f64>) -> (Vec<Rectangle>, Vec<Rectangle>) {
        let s = Complex {
            re: s.clone(),
            im: Interval::point(&0.0),
        };
        let values_and_slopes = self.start.iter().zip(&self.end).map(|(start, end)| {
            let mut slope = exactly(*end);
            slope.sub(&exactly(*start));
            let mut value = exactly(*start);
            value.mul_add(&slope, &s);
            (value, slope)
        });
        values_and_slopes.unzip()
    }

    /// In doubles.
    pub fn linear(&mut self, x: &[Complex64], s: f64) -> Linear<f64> {
        let double = |z: &Complex64| Complex { re: z.re, im: z.im };
        let x: Vec<Complex<f64>> = x.iter().map(double).collect();
        let pairs = || self.start.iter().zip(&self.end);
        let slope: Vec<Complex<f64>> = pairs().map(|(a, b)| double(&(b - a))).collect();
        let value: Vec<Complex<f64>> = pairs().map(|(a, b)| double(&(a + (b - a) * s))).collect();
        let mut matrix = Matrix::zeros((), self.equations(), x.len() + 2);
        let program = self.program;
        program.linearize(&x, &value, &slope, &mut matrix, &mut self.doubles);
        Linear {
            matrix,
            free: self.free.clone(),
        }
    }

    /// In intervals, on a box and an interval of s.
    pub fn enclosure(&mut self, x: &[Rectangle], s: &Interval<f64>) -> Linear<Interval<f64>> {
        let (value, slope) = self.parameters(s);
        let mut matrix = Matrix::zeros((), self.equations(), x.len() + 2);
        let program = self.program;
        program.linearize(x, &value, &slope, &mut matrix, &mut self.intervals);
        Linear {
            matrix,
            free: self.free.clone(),
        }
    }

    /// The approximate inverse of the first `columns` columns of the Jacobian at a point.
    pub fn inverse(&mut self, x: &[Complex64], s: f64, columns: usize) -> Option<Matrix<f64>> {
        let linear = self.linear(x, s);
        let mut square = Matrix::zeros((), columns, columns);
        for i in 0..columns {
            for j in 0..columns {
                square.at_mut(i, j).set(linear.slope(i, j));
            }
        }
        inverse((), &square)
    }
}

/// A matrix times a vector of rectangles.
pub fn times(matrix: &Matrix<f64>, vector: &[Rectangle]) -> Vec<Rectangle> {
    (0..matrix.rows())
        .map(|i| {
            let mut sum = Rectangle::zero(());
            for (j, z) in vector.iter().enumerate() {
                let entry = matrix.at(i, j);
                sum.mul_add(&exactly(Complex64::new(entry.re, entry.im)), z);
            }
            sum
        })
        .collect()
}

/// Krawczyk's bound: how far from the middle of a box a zero of all functions with these values in the middle (already
/// multiplied by the approximate inverse: `correction`) and these slopes on the box can be. `None` where the box is not
/// shown to be mapped into its interior.
pub fn contracted(
    approximate: &Matrix<f64>,
    slopes: &Linear<Interval<f64>>,
    correction: &[f64],
    radius: &[f64],
) -> Option<Vec<f64>> {
    let n = radius.len();
    let mut needed = correction.to_vec();
    for j in 0..n {
        let column: Vec<Rectangle> = (0..n).map(|k| slopes.slope(k, j).clone()).collect();
        let product = times(approximate, &column);
        for (i, entry) in product.iter().enumerate() {
            let mut rest = exactly(Complex64::new(if i == j { 1.0 } else { 0.0 }, 0.0));
            rest.sub(entry);
            let size = above_sum(rest.re.magnitude(), rest.im.magnitude());
            needed[i] = above_sum(needed[i], above_product(size, radius[j]));
        }
    }
    let inside = needed.iter().zip(radius).all(|(need, r)| need < r);
    inside.then_some(needed)
}
