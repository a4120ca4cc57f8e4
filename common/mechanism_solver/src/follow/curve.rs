//! Curve: the solutions of equations while their parameters move along a segment, evaluated in doubles and in intervals.

use cognate_numeric::linear_algebra::inverse::inverse;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::directed::{Directed, Toward};
use cognate_numeric::scalar::{Complex, Interval, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use num_complex::Complex64;

/// An interval of complex numbers: a rectangle.
pub type Rectangle = Complex<Interval<f64>>;

/// Equations while their parameters are on a segment: `start` at s = 0, `end` at s = 1, exactly.
///
/// A point of the curve has the variables as its coordinates and s as its last one. One coordinate is the parameter of
/// the curve, those in `free` are solved for, the others are held.
pub struct Curve<'a> {
    program: &'a Interpreter,
    /// The coordinates that are solved for.
    pub free: Vec<usize>,
    /// The coordinate that is the parameter of the curve.
    pub parameter: usize,
    start: Vec<Complex64>,
    end: Vec<Complex64>,
    doubles: Scratch<f64>,
    intervals: Scratch<Interval<f64>>,
}

/// Jacobian by the coordinates of a point, and values.
pub struct Linear<R: Real> {
    matrix: Matrix<R>,
    free: Vec<usize>,
    parameter: usize,
}

impl<R: Real> Linear<R> {
    /// An entry of the Jacobian by the free coordinates; the column after the last of them is the derivative by the
    /// parameter of the curve.
    pub fn slope(&self, row: usize, column: usize) -> &Complex<R> {
        let coordinate = self.free.get(column).copied().unwrap_or(self.parameter);
        // The values stand between the derivatives by the variables and that by s.
        let s = self.matrix.columns() - 2;
        let place = if coordinate == s { s + 1 } else { coordinate };
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
    /// A program with as many equations as free coordinates; s is the parameter of the curve where it is not free.
    pub fn new(
        program: &'a Interpreter,
        free: Vec<usize>,
        start: &[Complex64],
        end: &[Complex64],
    ) -> Self {
        Self {
            program,
            free,
            parameter: Evaluate::<f64>::shape(program).variables,
            start: start.to_vec(),
            end: end.to_vec(),
            doubles: program.scratch(()),
            intervals: program.scratch(()),
        }
    }

    fn equations(&self) -> usize {
        Evaluate::<f64>::shape(self.program).equations
    }

    /// The place of s among the coordinates of a point.
    pub fn place_of_s(&self) -> usize {
        Evaluate::<f64>::shape(self.program).variables
    }

    /// Makes another coordinate the parameter of the curve; the one that was is solved for.
    pub fn set_parameter(&mut self, parameter: usize) {
        let mut free = self.free.iter_mut();
        if let Some(coordinate) = free.find(|coordinate| **coordinate == parameter) {
            std::mem::swap(coordinate, &mut self.parameter);
        }
    }

    /// The parameters of the equations on a rectangle of s, and their derivative.
    fn parameters(&self, s: &Rectangle) -> (Vec<Rectangle>, Vec<Rectangle>) {
        let values_and_slopes = self.start.iter().zip(&self.end).map(|(start, end)| {
            let mut slope = exactly(*end);
            slope.sub(&exactly(*start));
            let mut value = exactly(*start);
            value.mul_add(&slope, s);
            (value, slope)
        });
        values_and_slopes.unzip()
    }

    /// In doubles.
    pub fn linear(&mut self, point: &[Complex64]) -> Linear<f64> {
        let double = |z: &Complex64| Complex { re: z.re, im: z.im };
        let (x, s) = point.split_at(self.place_of_s());
        let s = s[0].re;
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
            parameter: self.parameter,
        }
    }

    /// In intervals, on a box.
    pub fn enclosure(&mut self, boxes: &[Rectangle]) -> Linear<Interval<f64>> {
        let (x, s) = boxes.split_at(self.place_of_s());
        let (value, slope) = self.parameters(&s[0]);
        let mut matrix = Matrix::zeros((), self.equations(), x.len() + 2);
        let program = self.program;
        program.linearize(x, &value, &slope, &mut matrix, &mut self.intervals);
        Linear {
            matrix,
            free: self.free.clone(),
            parameter: self.parameter,
        }
    }

    /// The approximate inverse of the Jacobian by the free coordinates at a point.
    pub fn inverse(&mut self, point: &[Complex64]) -> Option<Matrix<f64>> {
        let n = self.free.len();
        let linear = self.linear(point);
        let mut square = Matrix::zeros((), n, n);
        for i in 0..n {
            for j in 0..n {
                square.at_mut(i, j).set(linear.slope(i, j));
            }
        }
        inverse((), &square)
    }
}

/// A matrix times a vector, in doubles.
pub fn product<'a>(
    matrix: &Matrix<f64>,
    vector: impl Fn(usize) -> &'a Complex<f64>,
) -> Vec<Complex64> {
    let double = |z: &Complex<f64>| Complex64::new(z.re, z.im);
    (0..matrix.rows())
        .map(|i| {
            let terms = (0..matrix.columns()).map(|j| double(matrix.at(i, j)) * double(vector(j)));
            terms.fold(Complex64::default(), |sum, term| sum + term)
        })
        .collect()
}

/// Bounds of the Newton step at a point, by the free coordinates, from the approximate inverse of the Jacobian there.
pub fn newton_step(
    curve: &mut Curve<'_>,
    approximate: &Matrix<f64>,
    point: &[Complex64],
) -> Vec<f64> {
    let exact: Vec<Rectangle> = point.iter().map(|z| exactly(*z)).collect();
    let enclosure = curve.enclosure(&exact);
    let values: Vec<Rectangle> = (0..curve.free.len())
        .map(|i| enclosure.value(i).clone())
        .collect();
    let step = times(approximate, &values);
    step.iter().map(largest_part).collect()
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
