//! Whether a polynomial grows beyond its critical points: values on one sphere and the directions in which they change say
//! it of all larger ones.
//!
//! On the spheres around a general point p the least values of f lie on the curve where grad f = l (x - p). Along it f
//! changes with the radius r as l r does, and l is 0 at critical points only. Beyond the largest radius at which the curve
//! turns back, each of its branches meets every sphere once. Where l is positive at all real points of one such sphere,
//! f grows along all of them, so that all values further out are larger than the least one on this sphere.

use super::Critical;
use super::general_point::general_point;
use super::value::ValuesOnSphere;
use crate::point_shape::{largest, modulus};
use crate::solution::Solution;
use cognate_numeric::linear_algebra::vector::square;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::evaluation::values;
use cognate_systems::expression::differentiate::gradient;
use cognate_systems::expression::{Expressions, Node, NodeId};
use cognate_systems::objective::Goal;
use cognate_systems::system::{System, VariableGroup};
use cognate_systems::transform::critical_points;
use num_complex::Complex64;

/// The radius of the sphere, in units of the largest distance of a critical point and of a point where the curve turns
/// back.
const RADIUS_FACTOR: f64 = 2.0;
/// The bits of a double's mantissa.
const MANTISSA: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;
/// The sign of a rate is known where it is this many times its error.
const RATE_FACTOR: f64 = 100.0;

impl Critical {
    /// The system of the points where the curve turns back, from all critical points; `None` where the question is answered
    /// without it, or the objective is no polynomial without equations and conditions.
    pub fn turning_points(
        &self,
        critical: &[Solution],
        parameters: &[Complex64],
    ) -> Option<System> {
        if self.goal == Goal::Critical {
            return None;
        }
        let sign = self.sign();
        let is_free = self.constraints() == 0
            && self.alternatives.is_none()
            && self.with_helpers.is_none()
            && !self.has_denominators
            && self.system.variables.len() == self.unknowns;
        if !is_free || self.unknowns < 2 || self.attained(sign, parameters).is_some() {
            return None;
        }
        if sign > 0.0 && self.lower_bound().is_some() {
            return None;
        }
        if self.unknowns == 2 {
            return Some(self.turning_points_in_the_plane());
        }
        let radius = largest_distance(critical, self.unknowns);
        let gradient = self.size_at(&self.system.equations, radius, parameters);
        let mut curve = self.system.clone();
        let mut name = String::from("multiplier");
        while curve.variables.contains(&name) || curve.parameters.contains(&name) {
            name.push('_');
        }
        curve.variables.push(name);
        curve.groups.push(VariableGroup {
            variables: vec![self.unknowns],
            homogeneous: false,
        });
        let e = &mut curve.expressions;
        let differences = differences_to_centre(e, self.unknowns);
        let multiplier = e.variable(self.unknowns as u32);
        // So the multiplier is about 1.
        let unit = e.constant(power_of_two(gradient / radius));
        let multiplier = e.multiply(unit, multiplier);
        for (equation, difference) in curve.equations.iter_mut().zip(&differences) {
            let term = e.multiply(multiplier, *difference);
            *equation = e.subtract(*equation, term);
        }
        let distance = sum_of_squares(e, &differences);
        Some(critical_points(&curve, distance, &[]))
    }

    /// The turning points with two unknowns, and the centre: the curve has one equation, the derivative of f along a circle,
    /// and where it turns back the derivative of this along the circle is 0.
    fn turning_points_in_the_plane(&self) -> System {
        let mut plane = self.system.clone();
        let e = &mut plane.expressions;
        let differences = differences_to_centre(e, 2);
        let curve = along_circle(e, &differences, [plane.equations[0], plane.equations[1]]);
        let is_variable = &mut |node: &Node| matches!(node, Node::Variable(_));
        let of_curve = gradient(e, curve, is_variable);
        let zero = e.integer(0);
        let derivatives = [0, 1].map(|v| of_curve.get(&e.variable(v)).copied().unwrap_or(zero));
        let turn = along_circle(e, &differences, derivatives);
        plane.equations = vec![curve, turn];
        plane.equation_names = vec!["curve".into(), "turn".into()];
        plane
    }

    /// The size of expressions at a general point that lies this far from the centre.
    fn size_at(&self, nodes: &[NodeId], radius: f64, parameters: &[Complex64]) -> f64 {
        let centre = general_point(self.unknowns);
        let centre: Vec<Complex64> = centre
            .iter()
            .map(|p| Complex64::new(p.re.to_f64(), 0.0))
            .collect();
        let stretch = 1.0 + radius / square(&centre).sqrt();
        let point: Vec<Complex64> = centre.iter().map(|p| p * stretch).collect();
        let values = values(&self.system.expressions, nodes, &point, parameters);
        square(&values).sqrt()
    }

    /// The system of the critical points on a sphere that all turning points and critical points lie in.
    pub fn on_sphere(
        &self,
        turning_points: &[Solution],
        critical: &[Solution],
        parameters: &[Complex64],
    ) -> System {
        let n = self.unknowns;
        let inner = largest_distance(turning_points, n).max(largest_distance(critical, n));
        let radius = (RADIUS_FACTOR * inner).ceil();
        let size = self.size_at(&[self.objective], radius, parameters);
        let mut sphere = self.system.clone();
        let e = &mut sphere.expressions;
        // In these units both multipliers are about 1.
        let unit = e.constant(power_of_two(size));
        let objective = e.divide(self.objective, unit);
        let differences = differences_to_centre(e, n);
        let distance = sum_of_squares(e, &differences);
        let square = Rational::from_f64(radius * radius).unwrap_or_default();
        let square = e.constant(ComplexRational::real(square));
        let distance = e.divide(distance, square);
        let one = e.integer(1);
        sphere.equations = vec![e.subtract(distance, one)];
        sphere.equation_names = vec!["sphere".into()];
        critical_points(&sphere, objective, &[])
    }

    /// Adds all critical points on the sphere.
    pub fn add_points_on_sphere(&mut self, points: &[Solution], parameters: &[Complex64]) {
        let sign = self.sign();
        let mut values = ValuesOnSphere {
            least: f64::INFINITY,
            grow: true,
        };
        let may_be_real = |solution: &&Solution| solution.real != Some(false);
        for solution in points.iter().filter(may_be_real) {
            let point: Vec<Complex64> = solution.variables.values().collect();
            let bounds = self.bounds(solution, parameters);
            let (value, error) = self.value(&point[..self.unknowns], parameters, &bounds[0]);
            let rate = sign * self.rate(&point, solution.accuracy);
            values.grow &= rate > 0.0 && solution.real == Some(true);
            values.least = values.least.min(sign * value - error);
        }
        self.on_sphere = values.least.is_finite().then_some(values);
    }

    /// A positive multiple of the change of the objective with the radius, at a critical point on the sphere; 0 where its
    /// sign is not known.
    fn rate(&self, point: &[Complex64], accuracy: f64) -> f64 {
        // The gradient of the objective is twice the quotient of the second and the first, times x - p.
        let &[first, second] = &point[self.unknowns..] else {
            return 0.0;
        };
        let product = (second * first.conj()).re;
        let error = accuracy * modulus(first).max(modulus(second)) * largest(point);
        if product.abs() > RATE_FACTOR * error {
            product
        } else {
            0.0
        }
    }

    /// Whether all values beyond the sphere are larger than this one (`sign` 1), or smaller (`sign` -1).
    pub(super) fn grows_beyond(&self, value: f64, sign: f64) -> bool {
        let values = self.on_sphere.as_ref();
        values.is_some_and(|values| values.grow && sign * value < values.least)
    }
}

/// The largest distance from the centre of a solution that may be real, at least 1.
fn largest_distance(solutions: &[Solution], unknowns: usize) -> f64 {
    let centre = general_point(unknowns);
    let distance = |solution: &Solution| {
        let values = solution.variables.values();
        let differences: Vec<Complex64> = values
            .zip(&centre)
            .map(|(z, p)| z - p.re.to_f64())
            .collect();
        square(&differences).sqrt()
    };
    let may_be_real = solutions
        .iter()
        .filter(|solution| solution.real != Some(false));
    may_be_real.map(distance).fold(1.0, f64::max)
}

/// The power of two next below a positive number; 1 for others.
fn power_of_two(value: f64) -> ComplexRational {
    let is_regular = value.is_normal() && value > 0.0;
    let power = if is_regular {
        f64::from_bits(value.to_bits() & !MANTISSA)
    } else {
        1.0
    };
    ComplexRational::real(Rational::from_f64(power).unwrap_or_else(|| Rational::from(1)))
}

/// Each unknown less its coordinate of the centre.
fn differences_to_centre(e: &mut Expressions, unknowns: usize) -> Vec<NodeId> {
    let coordinates = general_point(unknowns).into_iter().enumerate();
    let difference = |(v, coordinate)| {
        let (variable, coordinate) = (e.variable(v as u32), e.constant(coordinate));
        e.subtract(variable, coordinate)
    };
    coordinates.map(difference).collect()
}

/// The derivative of an expression in two unknowns, with these derivatives by them, along circles around the centre.
fn along_circle(e: &mut Expressions, differences: &[NodeId], derivatives: [NodeId; 2]) -> NodeId {
    let first = e.multiply(derivatives[0], differences[1]);
    let second = e.multiply(derivatives[1], differences[0]);
    e.subtract(first, second)
}

fn sum_of_squares(e: &mut Expressions, terms: &[NodeId]) -> NodeId {
    let mut sum = e.integer(0);
    for &term in terms {
        let square = e.power(term, 2);
        sum = e.add(sum, square);
    }
    sum
}
