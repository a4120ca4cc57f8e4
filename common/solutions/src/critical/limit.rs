//! Limit points: points that meet the conditions with equality, near which there are points that meet them without.

use super::Critical;
use crate::point_shape::largest;
use crate::selection::Box64;
use cognate_numeric::linear_algebra::least_squares::least_squares;
use cognate_numeric::linear_algebra::symmetric_eigenvalues::symmetric_eigenvalues;
use cognate_numeric::linear_algebra::vector::{inner, square};
use cognate_systems::expression::Node;
use num_complex::Complex64;

/// Distance, relative to 1 and the largest coordinate, over which a gradient has to stay the same up to a tenth: one that
/// changes more may be 0 at the exact point. A condition that is not greater may hold with equality.
const NEIGHBOURHOOD: f64 = 1e-6;
/// Part of a gradient that has to be left along the equations, and that a direction has to have of each gradient: more
/// than what errors within the neighbourhood change.
const LEAST_PART: f64 = 1e-2;
/// An eigenvalue of second derivatives counts as 0 below this, relative to 1 and the largest of them.
const ZERO_CURVATURE: f64 = 1e-6;
/// Corrections of a direction, at most: 1 / `LEAST_PART`^2 suffice where there is one with twice that part.
const MOST_CORRECTIONS: usize = 10_000;

/// A gradient at a point and, to see how it changes, beside it.
struct Gradient {
    at: Vec<Complex64>,
    beside: Vec<Complex64>,
}

impl Gradient {
    fn is_steady(&self) -> bool {
        let change: Vec<Complex64> = self
            .at
            .iter()
            .zip(&self.beside)
            .map(|(a, b)| b - a)
            .collect();
        let length = square(&self.at);
        length > 0.0 && square(&change) <= 0.01 * length
    }
}

/// A condition that holds with equality at a point.
struct ActiveCondition {
    /// Index of its alternative.
    index: usize,
    /// The multiples of the equations' gradients that are nearest to its own gradient.
    coefficients: Vec<Complex64>,
    /// The rest of its gradient; `None` where that may be 0.
    along: Option<Vec<Complex64>>,
}

impl Critical {
    /// Whether points that meet all conditions without equality are as near as one likes to a real point that meets
    /// them. That is so where the gradients of the equations are independent and, along the solutions, all conditions
    /// that are active grow in one direction (Mangasarian and Fromovitz 1967), or the only one grows by its second
    /// derivatives. False where that is not shown. `bounds` are those of the conditions' expressions at the point.
    pub(super) fn is_limit(
        &mut self,
        point: &[Complex64],
        parameters: &[Complex64],
        bounds: &[Box64],
    ) -> bool {
        let active = self.active_conditions(point, parameters, bounds);
        let Some((equations, active)) = active else {
            return false;
        };
        let along = active.iter().map(|condition| condition.along.as_deref());
        match (along.collect::<Option<Vec<_>>>(), &active[..]) {
            (Some(gradients), _) => have_common_direction(&gradients),
            (None, [only]) => self.grows_by_curvature(point, parameters, &equations, only),
            (None, _) => false,
        }
    }

    /// The gradients of the equations, and the conditions that are active; `None` where the equations are singular.
    fn active_conditions(
        &mut self,
        point: &[Complex64],
        parameters: &[Complex64],
        bounds: &[Box64],
    ) -> Option<(Vec<Vec<Complex64>>, Vec<ActiveCondition>)> {
        let step = NEIGHBOURHOOD * (1.0 + largest(&point[..self.unknowns]));
        // Lengths of which the quotients are no simple numbers.
        let shift = |(i, z): (usize, &Complex64)| z + step * (1.0 + 0.754_877_666 * i as f64);
        let beside: Vec<Complex64> = point.iter().enumerate().map(shift).collect();
        let gradients = self.gradients(point, parameters)?.into_iter();
        let beside = self.gradients(&beside, parameters)?.into_iter();
        let gradients = gradients
            .zip(beside)
            .map(|(at, beside)| Gradient { at, beside });
        let mut equations: Vec<Gradient> = gradients.collect();
        let conditions = equations.split_off(self.constraints());
        if !equations.iter().all(Gradient::is_steady) {
            return None;
        }
        let equations: Vec<Vec<Complex64>> = equations.into_iter().map(|g| g.at).collect();
        let is_active = |bound: &Box64| !bound.re.is_valid() || *bound.re.lower() <= NEIGHBOURHOOD;
        let mut active = Vec::new();
        let with_bounds = conditions.iter().zip(bounds).enumerate();
        for (index, (gradient, _)) in with_bounds.filter(|(_, (_, bound))| is_active(bound)) {
            let coefficients = least_squares(&equations, &gradient.at)?;
            let along = remainder(&equations, &coefficients, &gradient.at);
            let is_enough = square(&along) > LEAST_PART * LEAST_PART * square(&gradient.at);
            active.push(ActiveCondition {
                index,
                coefficients,
                along: (is_enough && gradient.is_steady()).then_some(along),
            });
        }
        Some((equations, active))
    }

    /// The gradients of the equations, then of the conditions, at the real parts of a point; `None` where one is not
    /// at hand.
    fn gradients(
        &mut self,
        point: &[Complex64],
        parameters: &[Complex64],
    ) -> Option<Vec<Vec<Complex64>>> {
        let n = self.unknowns;
        // The derivatives of a condition times its multiplier 1.
        let real = point[..n].iter().map(|z| Complex64::new(z.re, 0.0));
        let ones = std::iter::repeat(Complex64::new(1.0, 0.0));
        let point: Vec<Complex64> = real.chain(ones).take(self.system.variables.len()).collect();
        let jacobian = self.jacobian(&point, parameters);
        let row = |i: usize| {
            (0..n)
                .map(|j| Complex64::new(jacobian.at(i, j).re, 0.0))
                .collect()
        };
        let mut gradients: Vec<Vec<Complex64>> =
            (n..self.system.equations.len()).map(row).collect();
        for alternative in self.alternatives().iter().filter(|a| !a.has_multiplier) {
            let Node::Variable(v) = self.system.expressions.node(alternative.expression) else {
                return None;
            };
            let unit = |j: usize| Complex64::from(f64::from(u8::from(j == *v as usize)));
            gradients.push((0..n).map(unit).collect());
        }
        Some(gradients)
    }

    /// Whether a condition grows along the solutions by its second derivatives less those of the equations' multiples.
    fn grows_by_curvature(
        &mut self,
        point: &[Complex64],
        parameters: &[Complex64],
        equations: &[Vec<Complex64>],
        condition: &ActiveCondition,
    ) -> bool {
        let n = self.unknowns;
        let real = point[..n].iter().map(|z| Complex64::new(z.re, 0.0));
        let mut point: Vec<Complex64> = real.collect();
        point.resize(self.system.variables.len(), Complex64::default());
        let multipliers = point.iter_mut().skip(n + 1);
        multipliers
            .zip(&condition.coefficients)
            .for_each(|(multiplier, c)| *multiplier = *c);
        // A condition without multiplier is linear.
        if let Some(multiplier) = point.get_mut(n + 1 + equations.len() + condition.index) {
            *multiplier = Complex64::new(-1.0, 0.0);
        }
        let jacobian = self.jacobian(&point, parameters);
        let along_solutions = |i: usize| {
            let unit: Vec<Complex64> = (0..n)
                .map(|j| Complex64::from(f64::from(u8::from(i == j))))
                .collect();
            let coefficients = least_squares(equations, &unit)?;
            Some(remainder(equations, &coefficients, &unit))
        };
        let Some(directions) = (0..n).map(along_solutions).collect::<Option<Vec<_>>>() else {
            return false;
        };
        let mut size = 0.0f64;
        let mut rows = vec![vec![0.0; n]; n];
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let second = jacobian.at(i, j).re;
            size = size.max(second.abs());
            for (a, left) in directions.iter().enumerate() {
                for (b, right) in directions.iter().enumerate() {
                    rows[a][b] += left[i].re * second * right[j].re;
                }
            }
        }
        let tiny = ZERO_CURVATURE * (1.0 + size);
        symmetric_eigenvalues(&rows)
            .iter()
            .any(|value| *value > tiny)
    }
}

/// A vector less a sum of multiples.
fn remainder(
    columns: &[Vec<Complex64>],
    coefficients: &[Complex64],
    vector: &[Complex64],
) -> Vec<Complex64> {
    let mut left = vector.to_vec();
    for (column, coefficient) in columns.iter().zip(coefficients) {
        for (a, b) in left.iter_mut().zip(column) {
            *a -= coefficient * b;
        }
    }
    left
}

/// Whether a direction has a positive part of each of these gradients, by the perceptron algorithm (Rosenblatt 1958).
fn have_common_direction(gradients: &[&[Complex64]]) -> bool {
    let unit = |gradient: &&[Complex64]| -> Vec<Complex64> {
        let length = square(gradient).sqrt();
        gradient.iter().map(|z| z / length).collect()
    };
    let units: Vec<Vec<Complex64>> = gradients.iter().map(unit).collect();
    let Some(mut direction) = units.first().cloned() else {
        return false;
    };
    for _ in 0..MOST_CORRECTIONS {
        let least = LEAST_PART * square(&direction).sqrt();
        let falls = |unit: &&Vec<Complex64>| inner(unit, &direction).re <= least;
        let Some(correction) = units.iter().find(falls) else {
            return true;
        };
        direction
            .iter_mut()
            .zip(correction)
            .for_each(|(a, b)| *a += b);
    }
    false
}
