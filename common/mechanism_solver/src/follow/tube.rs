//! Boxes around pieces of a curve in each of which there is one solution for every value of the curve's parameter.
//!
//! A piece is the box m(p) + [-r, r] with m linear in the parameter p. Krawczyk's operator maps it into its interior for
//! all p of the piece at once (R. B. Kearfott and Z. Xing, An interval step control for continuation methods, 1994).
//! Where two pieces meet, a solution that is known within a smaller box lies in both: so they follow the same one, and no
//! leap to another branch is possible.

use super::curve::{
    Curve, Rectangle, above_product, above_sum, around, contracted, exactly, larger, largest_part,
    newton_step, product, times,
};
use cognate_numeric::scalar::directed::{Directed, Toward};
use cognate_numeric::scalar::{Complex, Interval, Real};
use num_complex::Complex64;

/// Boxes are no smaller than this part of the largest coordinate.
const SMALLEST_BOX: f64 = 1e-11;

/// A box around a point of a curve in which there is exactly one solution with the point's value of the parameter, and a
/// smaller box that holds it. All lists go by the coordinates of the point.
#[derive(Clone, Debug)]
pub struct Located {
    /// The middle.
    pub point: Vec<Complex64>,
    /// Half of the sides of the box in which there is no other solution.
    pub radius: Vec<f64>,
    /// Half of the sides of the box that holds the solution.
    pub error: Vec<f64>,
}

impl Located {
    /// The box that holds the solution.
    fn inner(&self) -> Vec<Rectangle> {
        boxes_around(&self.point, &self.error)
    }

    /// Whether another's solution is this one, where both have the same value of the parameter: it lies where there is no
    /// other.
    pub fn holds(&self, other: &Self, curve: &Curve<'_>) -> bool {
        let (inner, outer) = (other.inner(), boxes_around(&self.point, &self.radius));
        curve.free.iter().all(|&v| inner[v].is_inside(&outer[v]))
    }
}

/// The boxes with these middles and half sides.
fn boxes_around(middle: &[Complex64], radius: &[f64]) -> Vec<Rectangle> {
    let both = middle.iter().zip(radius);
    both.map(|(z, r)| widened(exactly(*z), *r)).collect()
}

fn widened(mut z: Rectangle, radius: f64) -> Rectangle {
    let side = Interval::around_zero((), radius);
    z.re.add(&side);
    z.im.add(&side);
    z
}

/// Newton's method with the parameter of the curve held; `None` where it does not converge.
pub fn refined(curve: &mut Curve<'_>, point: &[Complex64]) -> Option<Vec<Complex64>> {
    let mut point = point.to_vec();
    let mut last = f64::INFINITY;
    for _ in 0..12 {
        let approximate = curve.inverse(&point)?;
        let linear = curve.linear(&point);
        let steps = product(&approximate, |row| linear.value(row));
        let size = steps.iter().map(|z| z.norm_sqr()).fold(0.0, larger);
        if !size.is_finite() {
            return None;
        }
        if size >= 0.25 * last {
            break;
        }
        last = size;
        for (v, step) in curve.free.iter().zip(steps) {
            point[*v] -= step;
        }
    }
    (last < 1e-16 * (1.0 + scale(&point) * scale(&point))).then_some(point)
}

fn scale(x: &[Complex64]) -> f64 {
    x.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max).sqrt()
}

/// The solution near a point with the point's value of the parameter, with its boxes.
pub fn located(curve: &mut Curve<'_>, point: &[Complex64]) -> Option<Located> {
    let point = refined(curve, point)?;
    let approximate = curve.inverse(&point)?;
    let correction = newton_step(curve, &approximate, &point);
    let floor = SMALLEST_BOX * scale(&point);
    let mut radius: Vec<f64> = correction.iter().map(|d| larger(64.0 * d, floor)).collect();
    for _ in 0..3 {
        let by_coordinate = spread(curve, &radius, point.len());
        let slopes = curve.enclosure(&boxes_around(&point, &by_coordinate));
        if let Some(error) = contracted(&approximate, &slopes, &correction, &radius) {
            return Some(Located {
                error: spread(curve, &error, point.len()),
                radius: by_coordinate,
                point,
            });
        }
        for (r, d) in radius.iter_mut().zip(&correction) {
            *r = larger(0.1 * *r, 2.0 * d);
        }
    }
    None
}

/// Numbers of the free coordinates as numbers of all `count` coordinates, 0 for the others.
fn spread(curve: &Curve<'_>, numbers: &[f64], count: usize) -> Vec<f64> {
    let mut by_coordinate = vec![0.0; count];
    for (v, number) in curve.free.iter().zip(numbers) {
        by_coordinate[*v] = *number;
    }
    by_coordinate
}

/// The direction of the curve at a point, by coordinates, with 1 for the parameter; `None` where it is not regular.
pub fn slopes_at(curve: &mut Curve<'_>, point: &[Complex64]) -> Option<Vec<Complex64>> {
    let n = curve.free.len();
    let approximate = curve.inverse(point)?;
    let linear = curve.linear(point);
    let mut slopes = vec![Complex64::default(); point.len()];
    let solved = product(&approximate, |row| linear.slope(row, n));
    for (v, slope) in curve.free.iter().zip(solved) {
        slopes[*v] = -slope;
    }
    slopes[curve.parameter] = Complex64::new(1.0, 0.0);
    Some(slopes)
}

/// A piece of the curve between two values of its parameter.
pub struct Piece {
    /// The coordinate that is the parameter.
    parameter: usize,
    /// Values of the parameter.
    range: Interval<f64>,
    /// The point in the middle.
    pub middle: Vec<Complex64>,
    /// Change of the coordinates with the parameter, along the piece's line; 1 for the parameter itself.
    pub slope: Vec<Complex64>,
    /// Half of the sides of the box around each point of the line; 0 for coordinates that are not free.
    radius: Vec<f64>,
    /// Bounds of the difference between the slope of the curve and that of the line.
    slope_error: Vec<f64>,
}

impl Piece {
    /// A proved piece between two values of the curve's parameter, near a point; `None` where the proof fails.
    pub fn new(curve: &mut Curve<'_>, point: &[Complex64], [from, to]: [f64; 2]) -> Option<Self> {
        let parameter = curve.parameter;
        let mut predicted = point.to_vec();
        let middle_value = 0.5 * (from + to);
        let away = middle_value - point[parameter].re;
        for (z, slope) in predicted.iter_mut().zip(slopes_at(curve, point)?) {
            *z += slope * away;
        }
        predicted[parameter] = Complex64::new(middle_value, 0.0);
        let middle = refined(curve, &predicted)?;
        let slope = slopes_at(curve, &middle)?;
        let half = 0.5 * (to - from).abs() * (1.0 + 1e-12);
        let piece = Self {
            parameter,
            range: around(middle_value, half),
            radius: vec![0.0; middle.len()],
            slope_error: vec![0.0; middle.len()],
            middle,
            slope,
        };
        piece.proved(curve, half)
    }

    /// The piece with a box that Krawczyk's operator maps into its interior.
    fn proved(mut self, curve: &mut Curve<'_>, half: f64) -> Option<Self> {
        let (n, count) = (curve.free.len(), self.middle.len());
        let approximate = curve.inverse(&self.middle)?;
        let at_middle = newton_step(curve, &approximate, &self.middle);
        let floor = 16.0 * SMALLEST_BOX * scale(&self.middle);
        let mut radius: Vec<f64> = at_middle.iter().map(|d| larger(2.0 * d, floor)).collect();
        let line = self.at(&self.range);
        for _ in 0..4 {
            let by_coordinate = spread(curve, &radius, count);
            let boxes: Vec<Rectangle> = line
                .iter()
                .zip(&by_coordinate)
                .map(|(z, r)| widened(z.clone(), *r))
                .collect();
            let slopes = curve.enclosure(&boxes);
            // By the mean value theorem: F(m(p)) is within half the range times the derivative along the line.
            let along: Vec<Rectangle> = (0..n)
                .map(|i| {
                    let mut sum = slopes.slope(i, n).clone();
                    for (j, v) in curve.free.iter().enumerate() {
                        sum.mul_add(slopes.slope(i, j), &exactly(self.slope[*v]));
                    }
                    sum
                })
                .collect();
            let along: Vec<f64> = times(&approximate, &along)
                .iter()
                .map(largest_part)
                .collect();
            let correction: Vec<f64> = along
                .iter()
                .zip(&at_middle)
                .map(|(z, d)| above_sum(*d, above_product(half, *z)))
                .collect();
            if correction.iter().any(|d| !d.is_finite()) {
                return None;
            }
            if let Some(needed) = contracted(&approximate, &slopes, &correction, &radius) {
                let error = slope_errors(&along, &correction, &needed, &radius);
                self.slope_error = spread(curve, &error, count);
                self.radius = by_coordinate;
                return Some(self);
            }
            for (r, d) in radius.iter_mut().zip(&correction) {
                *r = larger(*r, 2.5 * d);
            }
        }
        None
    }

    /// The line at these values of the parameter.
    fn at(&self, values: &Interval<f64>) -> Vec<Rectangle> {
        let mut away = values.clone();
        away.sub(&Interval::point(&self.middle[self.parameter].re));
        let away = Complex {
            re: away,
            im: Interval::point(&0.0),
        };
        let both = self.middle.iter().zip(&self.slope);
        both.map(|(middle, slope)| {
            let mut z = exactly(*middle);
            z.mul_add(&exactly(*slope), &away);
            z
        })
        .collect()
    }

    /// The point of the line at a value of the parameter, in doubles.
    pub fn point_at(&self, value: f64) -> Vec<Complex64> {
        let line = self.at(&Interval::point(&value));
        let mut point: Vec<Complex64> = line
            .iter()
            .map(|z| Complex64::new(z.re.lane(0), z.im.lane(0)))
            .collect();
        point[self.parameter] = Complex64::new(value, 0.0);
        point
    }

    /// Whether a located solution is the one of this piece.
    pub fn holds(&self, located: &Located) -> bool {
        let inner = located.inner();
        let value = &inner[self.parameter].re;
        let in_range = self.range.lower() <= value.lower() && value.upper() <= self.range.upper();
        let line = self.at(value);
        let mut free = (0..line.len()).filter(|&v| self.radius[v] > 0.0);
        in_range && free.all(|v| inner[v].is_inside(&shrunk(line[v].clone(), self.radius[v])))
    }

    /// Real parts that a coordinate has on the piece.
    pub fn values(&self, coordinate: usize) -> Interval<f64> {
        let line = self.at(&self.range).swap_remove(coordinate);
        widened(line, self.radius[coordinate]).re
    }

    /// Whether a coordinate only grows or only falls along the piece.
    pub fn is_monotone(&self, coordinate: usize) -> bool {
        self.slope[coordinate].re.abs() > self.slope_error[coordinate]
    }
}

/// Bounds of the difference w between the slope of the curve and that of the line: |w| <= c + E |w| by Krawczyk's
/// operator, with c (`along`) the approximate inverse times the derivative along the line, and E its distance from the
/// inverse, of which the boxes say E r = `needed` - `correction` < r.
fn slope_errors(along: &[f64], correction: &[f64], needed: &[f64], radius: &[f64]) -> Vec<f64> {
    const ROUNDING: f64 = 1.0 + 1e-9;
    let rest: Vec<f64> = needed
        .iter()
        .zip(correction)
        .map(|(need, d)| (need - d) * ROUNDING + f64::MIN_POSITIVE)
        .collect();
    let by_radius = |numbers: &[f64]| {
        let parts = numbers.iter().zip(radius).map(|(number, r)| number / r);
        parts.fold(0.0, larger)
    };
    let contraction = by_radius(&rest) * ROUNDING;
    if contraction >= 1.0 {
        return vec![f64::INFINITY; radius.len()];
    }
    let most = by_radius(along) * ROUNDING / (1.0 - contraction);
    let bounds = along.iter().zip(&rest);
    bounds
        .map(|(c, rest)| (c + rest * most) * ROUNDING)
        .collect()
}

/// The rectangle that is `radius` around every number of `line`: smaller than [`widened`], as far as the line is not exact.
fn shrunk(line: Rectangle, radius: f64) -> Rectangle {
    let part = |interval: &Interval<f64>| {
        let low = f64::difference(interval.upper(), &radius, Toward::Above);
        let high = f64::sum(interval.lower(), &radius, Toward::Below);
        Interval::new(low, high)
    };
    Complex {
        re: part(&line.re),
        im: part(&line.im),
    }
}
