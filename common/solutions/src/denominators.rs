//! Denominators: whether a denominator of the equations that were given is 0 at an endpoint.
//!
//! Equations are tracked with their denominators multiplied out, and a point where one of them is 0 is no solution of
//! what was given. A denominator that is far from 0 beside the endpoint's error is not 0. Where one is near 0 the
//! endpoint is brought to fifty digits, by deflation where it is multiple, and these decide; where it cannot be
//! brought to them, its own digits decide as far as they are clear.

use crate::classification::{Tolerances, error_bound};
use crate::degenerate::Bounded;
use crate::field::{ManyBits, evaluate};
use crate::point_shape::{largest, modulus};
use cognate_continuation::sharpening::Sharpened;
use cognate_continuation::sharpening::search::sharpen;
use cognate_numeric::rational::ComplexRational;
use cognate_systems::expression::NodeId;
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::denominator_factors;
use num_complex::Complex64;

/// Decimal digits of an endpoint beside which a denominator is near 0.
pub(crate) const DIGITS: u32 = 50;
/// A relative error of a coordinate that has [`DIGITS`] digits: five of them are not trusted.
const SHARPENED_ERROR: f64 = 1e-45;
/// The error of a coordinate that is 0 beside the others, relative to the largest of its group.
const SHARPENED_ZERO: f64 = 1e-90;
/// Bits of values at points that were brought to more digits.
pub(crate) const SHARPENED_BITS: u32 = 512;
/// Bits of values at endpoints.
pub(crate) const BITS: u32 = 128;
/// A value is not 0 if it exceeds its error by this factor.
pub(crate) const CLEARLY_NOT_ZERO: f64 = 1e3;
/// Errors of singular endpoints are estimated less well: at least this, relative to the largest coordinate. Beside points
/// of multiplicity 8 doubles had left 2e-3.
const SINGULAR_ERROR: f64 = 1e-6;
/// Digits that leave an error above this decide nothing.
pub(crate) const LARGEST_ERROR: f64 = 1e-4;
/// Most endpoints of one answer that are brought to more digits; further ones are decided by the digits that they have.
pub(crate) const MOST_SHARPENED: u32 = 1000;

/// Whether some denominator is 0 at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Denominator {
    /// No denominator is 0.
    Nonzero,
    /// One denominator is 0: the point is no solution of the given equations.
    Zero,
    /// The digits do not tell.
    Doubtful,
}

/// A point at which denominators are asked.
#[derive(Clone, Copy, Debug)]
pub struct AskedPoint<'a> {
    /// Values of the variables.
    pub values: &'a [Complex64],
    /// Estimated error, relative to the largest coordinate of each group.
    pub accuracy: f64,
    /// Whether the Jacobian is singular there.
    pub singular: bool,
    /// Whether the point is an isolated solution, as far as is known: a point on a curve of solutions has no digits of
    /// its own.
    pub isolated: bool,
}

impl AskedPoint<'_> {
    /// A bound for the error of its coordinates; larger at a singular point, whose accuracy is estimated less well.
    pub(crate) fn trusted_error(&self, tolerances: &Tolerances) -> f64 {
        let accuracy = match self.singular {
            true => self.accuracy.max(SINGULAR_ERROR),
            false => self.accuracy,
        };
        error_within(accuracy, tolerances)
    }
}

/// Condition numbers below this say little of how far a solution moves: that of one equation in one unknown is always 1.
const LEAST_CONDITION: f64 = 100.0;

/// How far an error of rounded coefficients moves a point with this condition number, relative to 1 and its largest
/// coordinate.
pub(crate) fn error_of_data(tolerances: &Tolerances, condition: f64) -> f64 {
    let accuracy = tolerances.data_accuracy;
    if condition.is_finite() {
        2.0 * condition.max(LEAST_CONDITION) * accuracy
    } else {
        // Multiple solutions part by the square root of a change, at least.
        accuracy.sqrt()
    }
}

fn error_within(accuracy: f64, tolerances: &Tolerances) -> f64 {
    let (factor, floor) = (tolerances.degenerate_factor, tolerances.degenerate_floor);
    error_bound(accuracy, factor, floor)
}

/// The denominators of a system at given values of its parameters.
pub struct Denominators<'a> {
    /// The system in the unknowns that are tracked.
    system: std::borrow::Cow<'a, System>,
    scaling: &'a cognate_systems::scaling::Scaling,
    factors: Vec<NodeId>,
    parameters: &'a [Complex64],
    tolerances: &'a Tolerances,
    seed: u64,
    sharpened: std::cell::Cell<u32>,
}

impl<'a> Denominators<'a> {
    /// The denominators of a system; `None` where the given equations have none.
    pub fn of(
        system: &'a System,
        parameters: &'a [Complex64],
        tolerances: &'a Tolerances,
        seed: u64,
    ) -> Option<Self> {
        if denominator_factors(system).is_empty() {
            return None;
        }
        let in_unknowns = system.in_unknowns();
        let factors = denominator_factors(&in_unknowns);
        Some(Self {
            system: in_unknowns,
            scaling: &system.scaling,
            factors,
            parameters,
            tolerances,
            seed,
            sharpened: std::cell::Cell::new(0),
        })
    }

    /// Whether one of them is 0 at a point with this condition number, also for other digits beyond those of rounded
    /// coefficients.
    pub fn within_data(&self, point: AskedPoint<'_>, condition: f64) -> Denominator {
        match self.at(point) {
            Denominator::Nonzero => {}
            decision => return decision,
        }
        let error = error_of_data(self.tolerances, condition);
        let unknowns = self.scaling.to_unknowns(point.values);
        match error > 0.0 && self.nearest(&unknowns, error) == Nearness::Zero {
            true => Denominator::Doubtful,
            false => Denominator::Nonzero,
        }
    }

    /// Whether one of them is 0 at a point.
    pub fn at(&self, point: AskedPoint<'_>) -> Denominator {
        let unknowns = self.scaling.to_unknowns(point.values);
        let error = point.trusted_error(self.tolerances);
        let near = self.nearest(&unknowns, error);
        if near == Nearness::Clear {
            return Denominator::Nonzero;
        }
        if point.isolated && self.sharpened.get() < MOST_SHARPENED {
            self.sharpened.set(self.sharpened.get() + 1);
            let more = sharpen(&self.system, self.parameters, &unknowns, DIGITS, self.seed);
            if let Ok(sharpened) = more {
                return self.at_sharpened(&sharpened);
            }
        }
        let error = error_within(point.accuracy, self.tolerances);
        match self.nearest(&unknowns, error) {
            // No digits could be had, and those of a multiple point are not to be trusted.
            Nearness::Clear if point.singular && point.isolated => Denominator::Doubtful,
            Nearness::Clear => Denominator::Nonzero,
            Nearness::Zero if error <= LARGEST_ERROR => Denominator::Zero,
            _ => Denominator::Doubtful,
        }
    }

    /// The denominator that is nearest to 0, with unknowns that may be off by this part of their group's largest.
    fn nearest(&self, unknowns: &[Complex64], error: f64) -> Nearness {
        let variables = variables_within(&self.system, unknowns, error);
        let values = self.values(BITS, &variables);
        values.map_or(Nearness::Between, |values| {
            let nearness = values.iter().map(Nearness::of);
            nearness.max().unwrap_or(Nearness::Clear)
        })
    }

    /// Fifty digits decide: what is 0 to all of them is 0.
    fn at_sharpened(&self, point: &Sharpened) -> Denominator {
        let variables = sharpened_variables(point);
        let values = self.values(SHARPENED_BITS, &variables);
        let nearness = values.map(|values| values.iter().map(Nearness::of).max());
        match nearness.flatten() {
            Some(Nearness::Clear) => Denominator::Nonzero,
            Some(Nearness::Zero) => Denominator::Zero,
            Some(Nearness::Between) | None => Denominator::Doubtful,
        }
    }

    fn values(
        &self,
        bits: u32,
        variables: &[(rug::Complex, f64)],
    ) -> Option<Vec<(rug::Complex, f64)>> {
        let field = Bounded(ManyBits(bits));
        let parameters = field.parameters(self.parameters);
        let expressions = &self.system.expressions;
        evaluate(&field, expressions, &self.factors, variables, &parameters)
    }
}

/// Unknowns that may be off by this part of their group's largest.
pub(crate) fn variables_within(
    system: &System,
    unknowns: &[Complex64],
    error: f64,
) -> Vec<(rug::Complex, f64)> {
    let mut variables: Vec<(rug::Complex, f64)> = unknowns
        .iter()
        .map(|z| (rug::Complex::with_val(BITS, (z.re, z.im)), 0.0))
        .collect();
    for group in &system.groups {
        let members: Vec<Complex64> = group.variables.iter().map(|&v| unknowns[v]).collect();
        let scale = largest(&members).max(if group.homogeneous { 0.0 } else { 1.0 });
        for &v in &group.variables {
            variables[v].1 = error * scale;
        }
    }
    variables
}

/// Unknowns with the errors of fifty digits.
pub(crate) fn sharpened_variables(point: &Sharpened) -> Vec<(rug::Complex, f64)> {
    let doubles: Vec<Complex64> = point.values.iter().map(rounded).collect();
    let mut variables: Vec<(rug::Complex, f64)> = point
        .values
        .iter()
        .zip(&doubles)
        .map(|(exact, z)| {
            let value = rug::Complex::with_val(SHARPENED_BITS, (&exact.re, &exact.im));
            (value, modulus(*z) * SHARPENED_ERROR)
        })
        .collect();
    let scale = largest(&doubles).max(1.0);
    for variable in &mut variables {
        variable.1 += scale * SHARPENED_ZERO;
    }
    variables
}

fn rounded(value: &ComplexRational) -> Complex64 {
    Complex64::new(value.re.to_f64(), value.im.to_f64())
}

/// Nearness of a value to 0, beside its error; the nearer, the greater.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Nearness {
    Clear,
    Between,
    Zero,
}

impl Nearness {
    fn of((value, error): &(rug::Complex, f64)) -> Self {
        let (re, im) = (value.real().to_f64(), value.imag().to_f64());
        let size = re.abs().max(im.abs());
        match size {
            _ if !error.is_finite() || !size.is_finite() => Self::Between,
            _ if size <= *error => Self::Zero,
            _ if size <= CLEARLY_NOT_ZERO * error => Self::Between,
            _ => Self::Clear,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(equations: &str) -> System {
        let text = format!("{{\"variables\": [\"x\", \"y\"], \"equations\": [{equations}]}}");
        let read = cognate_systems::formats::read("test", text.as_bytes());
        read.expect("a problem of this test").system
    }

    fn at(equations: &str, values: [f64; 2], singular: bool, isolated: bool) -> Denominator {
        let system = system(equations);
        let tolerances = Tolerances::default();
        let denominators = Denominators::of(&system, &[], &tolerances, 1).unwrap();
        denominators.at(AskedPoint {
            values: &values.map(|re| Complex64::new(re, 0.0)),
            accuracy: if singular { 1e-11 } else { 1e-15 },
            singular,
            isolated,
        })
    }

    #[test]
    fn fifty_digits_tell_0_from_what_is_small() {
        // 1/x is 1e16 at the one, and x y = 0 at the other.
        let small = "\"1/x - 1e16\", \"y - 1\"";
        assert_eq!(at(small, [1e-16, 1.0], false, true), Denominator::Nonzero);
        let zero = "\"x*y/x\", \"x - y*(y - 1)\"";
        assert_eq!(at(zero, [1e-17, 1.0], false, true), Denominator::Zero);
        let sums = "\"(x^2 - 2)/(x - y)\", \"y^2 - 2\"";
        let root = 2f64.sqrt();
        assert_eq!(at(sums, [root, root], false, true), Denominator::Zero);
        assert_eq!(at(sums, [root, -root], false, true), Denominator::Nonzero);
        let near = "\"(x^2 - 2)/(x - y)\", \"y^2 - 2 - 1e-18\"";
        assert_eq!(at(near, [root, root], false, true), Denominator::Nonzero);
    }

    #[test]
    fn multiple_points_are_deflated() {
        let double = "\"(x - y)^2/(y - 3)\", \"x - 3\"";
        let beside = [3.0, 3.0 + 1e-9];
        assert_eq!(at(double, beside, true, true), Denominator::Zero);
        let apart = "\"(x - y)^2/(y - 3 - 1e-12)\", \"x - 3\"";
        assert_eq!(at(apart, beside, true, true), Denominator::Nonzero);
    }

    #[test]
    fn where_digits_do_not_tell_nothing_is_decided() {
        let line = "\"x*y/x\", \"x*(y - 1)\"";
        assert_eq!(at(line, [1e-13, 0.3], true, false), Denominator::Zero);
        assert_eq!(at(line, [1e-8, 0.3], true, false), Denominator::Doubtful);
        assert_eq!(at(line, [1e-3, 0.3], true, false), Denominator::Nonzero);
    }
}
