//! Folds: where two real solutions meet and vanish. There the Jacobian has a kernel: F(x, s) = 0, J(x, s) l = 0, a l = 1,
//! as many equations as unknowns x, s, l.

use super::curve::{Curve, Rectangle, around, contracted, exactly, larger, newton_step, product};
use super::trace::NearFold;
use cognate_systems::evaluation::Interpreter;
use cognate_systems::expression::Node;
use cognate_systems::expression::differentiate::directional;
use cognate_systems::system::System;
use num_complex::Complex64;

/// The equations of folds of a square system in a chart.
pub struct FoldSystem {
    program: Interpreter,
    /// The variables that are free in the chart.
    free: Vec<usize>,
    variables: usize,
}

/// A fold on a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Fold {
    /// Where on the segment, from 0 to 1.
    pub s: f64,
    /// The variables there.
    pub point: Vec<Complex64>,
    /// How far off s can be, where the fold is proved to be there.
    pub error: Option<f64>,
}

impl FoldSystem {
    /// For these free variables; the others are 1.
    pub fn new(square: &System, free: &[usize]) -> Self {
        let mut e = square.expressions.clone();
        let variables = square.variables.len();
        let index = |v: usize| u32::try_from(v).expect("variables are counted in 32 bits");
        let kernel: Vec<_> = (0..free.len())
            .map(|k| e.variable(index(variables + k)))
            .collect();
        let slopes = directional(&mut e, &square.equations, &mut |_, leaf| match leaf {
            Node::Variable(v) => {
                let place = free.iter().position(|f| index(*f) == *v);
                place.map(|place| kernel[place])
            }
            _ => None,
        });
        let zero = e.integer(0);
        let mut equations = square.equations.clone();
        equations.extend(slopes.into_iter().map(|slope| slope.unwrap_or(zero)));
        let mut scale = e.integer(-1);
        for (k, l) in kernel.iter().enumerate() {
            let weight = e.parameter(index(square.parameters.len() + k));
            let term = e.multiply(weight, *l);
            scale = e.add(scale, term);
        }
        equations.push(scale);
        let count = variables + free.len();
        let parameters = square.parameters.len() + free.len();
        Self {
            program: Interpreter::compile(&e, &equations, count, parameters),
            free: free.to_vec(),
            variables,
        }
    }

    /// The fold near a point of the segment from `start` to `end`, where the curve has about this direction; `None` where
    /// Newton's method finds none near it.
    pub fn near(
        &self,
        (start, end): (&[Complex64], &[Complex64]),
        near: &NearFold,
    ) -> Option<Fold> {
        let kernel = self.kernel(near)?;
        // Where l has length 1, its conjugate is a row with a l = 1.
        let weights: Vec<Complex64> = kernel.iter().map(|z| z.conj()).collect();
        let with_weights = |p: &[Complex64]| [p, &weights].concat();
        let unknowns = self.variables..=self.variables + self.free.len();
        let free = self.free.iter().copied().chain(unknowns).collect();
        let (start, end) = (with_weights(start), with_weights(end));
        let mut whole = Curve::new(&self.program, free, &start, &end);
        let (x, s) = near.point.split_at(self.variables);
        let mut y = [x, &kernel, s].concat();
        let mut last = f64::INFINITY;
        for _ in 0..30 {
            let approximate = whole.inverse(&y)?;
            let linear = whole.linear(&y);
            let steps = product(&approximate, |row| linear.value(row));
            let size = steps.iter().map(|z| z.norm_sqr()).fold(0.0, larger);
            if !size.is_finite() {
                return None;
            }
            if size >= 0.25 * last && last < 1e-20 {
                break;
            }
            last = size;
            for (v, step) in whole.free.iter().zip(&steps) {
                y[*v] -= step;
            }
            y[whole.place_of_s()].im = 0.0;
        }
        let size = y.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
        let s = y[whole.place_of_s()].re;
        if !(last < 1e-16 * size && (0.0..=1.0).contains(&s)) {
            return None;
        }
        let error = prove(&mut whole, &y);
        y.truncate(self.variables);
        Some(Fold { s, point: y, error })
    }

    /// The direction of the curve without s, of length 1.
    fn kernel(&self, near: &NearFold) -> Option<Vec<Complex64>> {
        let direction: Vec<Complex64> = self.free.iter().map(|v| near.direction[*v]).collect();
        let length = direction.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
        let has_length = length > 0.0 && length.is_finite();
        has_length.then(|| direction.iter().map(|z| z / length).collect())
    }
}

/// Krawczyk's test for real equations, by which s is real and all else: how far off s can be.
fn prove(whole: &mut Curve<'_>, y: &[Complex64]) -> Option<f64> {
    if y.iter().any(|z| z.im != 0.0) {
        return None;
    }
    let m = whole.free.len();
    let s = whole.place_of_s();
    let approximate = whole.inverse(y)?;
    let middle: Vec<Rectangle> = y.iter().map(|z| exactly(*z)).collect();
    let correction = newton_step(whole, &approximate, y);
    let mut radius: Vec<f64> = correction.iter().map(|d| larger(16.0 * d, 1e-12)).collect();
    for _ in 0..3 {
        let mut boxes = middle.clone();
        for (v, r) in whole.free.iter().zip(&radius) {
            boxes[*v].re = around(y[*v].re, *r);
        }
        let slopes = whole.enclosure(&boxes);
        let is_real = (0..m).all(|i| (0..m).all(|j| slopes.slope(i, j).im.magnitude() == 0.0));
        if !is_real {
            return None;
        }
        if let Some(error) = contracted(&approximate, &slopes, &correction, &radius) {
            let place = whole.free.iter().position(|v| *v == s)?;
            return Some(error[place]);
        }
        for (r, d) in radius.iter_mut().zip(&correction) {
            *r = larger(0.1 * *r, 2.0 * d);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::tube::slopes_at;
    use cognate_systems::formats::read;

    #[test]
    fn the_fold_of_a_circle_is_located_and_proved() {
        // x^2 + y^2 = 25 and y = p + 2: x vanishes where p = 3, two thirds of the way from 1 to 4.
        let text = r#"{"variables": ["x", "y"], "parameters": ["p"], "equations": ["x^2 + y^2 - 25", "y - p - 2"]}"#;
        let system = read("test", text.as_bytes()).unwrap().system;
        let program = Interpreter::compile(&system.expressions, &system.equations, 2, 1);
        let real = |v: f64| Complex64::new(v, 0.0);
        let near = |[from, to]: [f64; 2], point: [f64; 3]| {
            let (start, end) = ([real(from)], [real(to)]);
            let mut curve = Curve::new(&program, vec![0, 1], &start, &end);
            let point = point.map(real).to_vec();
            let direction = slopes_at(&mut curve, &point).expect("a regular point");
            let near = NearFold { point, direction };
            FoldSystem::new(&system, &[0, 1]).near((&start, &end), &near)
        };
        let s = 0.66;
        let y = 1.0 + 3.0 * s + 2.0;
        let x = f64::sqrt(25.0 - y * y);
        let fold = near([1.0, 4.0], [x, y, s]).expect("it is near");
        assert!((fold.s - 2.0 / 3.0).abs() < 1e-12, "{fold:?}");
        assert!(
            fold.point[0].norm_sqr() < 1e-20 && fold.error.is_some(),
            "{fold:?}"
        );
        // Far from it, and on a segment without one.
        assert_eq!(near([1.0, 2.0], [4.0, 3.0, 0.0]), None);
    }
}
