//! Branches: whether the roots of a solution are those that were typed.
//!
//! A root is tracked as an unknown h with h^q = radicand, which all q roots of the radicand solve. The roots of a radicand
//! that is not 0 are far apart beside its size, so that the digits of an endpoint tell them; the border of a branch is
//! the negative axis, where fifty digits decide whether a radicand is real. At a radicand 0 there is one root.

use crate::classification::Tolerances;
use crate::degenerate::Bounded;
use crate::denominators::{
    AskedPoint, BITS, CLEARLY_NOT_ZERO, LARGEST_ERROR, MOST_SHARPENED, SHARPENED_BITS,
    error_of_data, sharpened_variables, variables_within,
};
use crate::field::{Field, ManyBits, evaluate};
use crate::point_shape::{largest, modulus};
use cognate_continuation::sharpening::search::sharpen;
use cognate_numeric::rational::Rational;
use cognate_systems::expression::NodeId;
use cognate_systems::helper_unknown::{Branch, RootUnknown};
use cognate_systems::scaling::Scaling;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::borrow::Cow;

/// Numbers of points that were taken away because a root is on a false branch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FalseBranches {
    /// Number of points.
    pub distinct: u64,
    /// Number of points with a regular Jacobian.
    pub nonsingular: u64,
    /// Sum of their multiplicities.
    pub with_multiplicity: u64,
    /// Paths to them that ended on sets of solutions.
    pub on_sets: u64,
}

/// Whether all roots of a point are those that are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchDecision {
    /// All roots at the point are the meant ones.
    Meant,
    /// One root is not the meant one: the point is no solution of the given equations.
    False,
    /// The digits do not tell.
    Doubtful,
}

/// One root at one point, as far as some digits tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Reading {
    Meant,
    Unclear,
    Other,
}

/// The roots of a system at given values of its parameters.
pub struct Branches<'a> {
    /// The system in the unknowns that are tracked.
    system: Cow<'a, System>,
    scaling: &'a Scaling,
    parameters: &'a [Complex64],
    tolerances: &'a Tolerances,
    seed: u64,
    sharpened: std::cell::Cell<u32>,
}

impl<'a> Branches<'a> {
    /// The roots of a system; `None` where it has none.
    pub fn of(
        system: &'a System,
        parameters: &'a [Complex64],
        tolerances: &'a Tolerances,
        seed: u64,
    ) -> Option<Self> {
        system.root_unknowns().next()?;
        Some(Self {
            system: system.in_unknowns(),
            scaling: &system.scaling,
            parameters,
            tolerances,
            seed,
            sharpened: std::cell::Cell::new(0),
        })
    }

    /// Whether the roots of a point with this condition number are those that are meant.
    pub fn at(&self, point: AskedPoint<'_>, condition: f64) -> BranchDecision {
        let unknowns = self.scaling.to_unknowns(point.values);
        let error = point.trusted_error(self.tolerances);
        let variables = variables_within(&self.system, &unknowns, error);
        let near_zero = self.near_zero(point.values, condition);
        match self.reading(BITS, &variables, &near_zero, false) {
            Reading::Meant => return BranchDecision::Meant,
            Reading::Other => return BranchDecision::False,
            Reading::Unclear => {}
        }
        if point.isolated && self.sharpened.get() < MOST_SHARPENED {
            self.sharpened.set(self.sharpened.get() + 1);
            let digits = crate::denominators::DIGITS;
            let more = sharpen(&self.system, self.parameters, &unknowns, digits, self.seed);
            if let Ok(sharpened) = more {
                let variables = sharpened_variables(&sharpened);
                return decision(self.reading(SHARPENED_BITS, &variables, &near_zero, true));
            }
        }
        match error <= LARGEST_ERROR {
            true => decision(self.reading(BITS, &variables, &near_zero, true)),
            false => BranchDecision::Doubtful,
        }
    }

    /// Whether each root may be 0 for other digits of rounded coefficients: two roots of a radicand change places there.
    fn near_zero(&self, values: &[Complex64], condition: f64) -> Vec<bool> {
        let error = error_of_data(self.tolerances, condition) * largest(values).max(1.0);
        let roots = self.system.root_unknowns();
        let is_near = |root: &RootUnknown| error > 0.0 && modulus(values[root.variable]) <= error;
        roots.map(is_near).collect()
    }

    /// The reading of all roots together. `is_last`: what is 0 or real within the error is taken to be so. A root that
    /// is not the meant one, but marked by `near_zero`, may be it.
    fn reading(
        &self,
        bits: u32,
        variables: &[(rug::Complex, f64)],
        near_zero: &[bool],
        is_last: bool,
    ) -> Reading {
        let field = Bounded(ManyBits(bits));
        let parameters = field.parameters(self.parameters);
        let radicands: Vec<NodeId> = self.system.root_unknowns().map(|r| r.radicand).collect();
        let expressions = &self.system.expressions;
        let values = evaluate(&field, expressions, &radicands, variables, &parameters);
        let Some(values) = values else {
            return Reading::Unclear;
        };
        let roots = self.system.root_unknowns().zip(&values).zip(near_zero);
        let readings = roots.map(|((root, radicand), is_near_zero)| {
            let value = &variables[root.variable];
            match read(root, radicand, value, bits, is_last) {
                Reading::Other if *is_near_zero => Reading::Unclear,
                reading => reading,
            }
        });
        readings.max().unwrap_or(Reading::Meant)
    }
}

fn decision(reading: Reading) -> BranchDecision {
    match reading {
        Reading::Meant => BranchDecision::Meant,
        Reading::Unclear => BranchDecision::Doubtful,
        Reading::Other => BranchDecision::False,
    }
}

fn size(value: &rug::Complex) -> f64 {
    modulus(Complex64::new(value.real().to_f64(), value.imag().to_f64()))
}

/// Reads one root beside its radicand, both with their errors.
fn read(
    root: &RootUnknown,
    (radicand, radicand_error): &(rug::Complex, f64),
    (value, value_error): &(rug::Complex, f64),
    bits: u32,
    is_last: bool,
) -> Reading {
    let radicand_size = size(radicand);
    if !radicand_error.is_finite() || !radicand_size.is_finite() {
        return Reading::Unclear;
    }
    if radicand_size <= *radicand_error && is_last {
        return Reading::Meant;
    }
    if radicand_size <= CLEARLY_NOT_ZERO * radicand_error {
        return Reading::Unclear;
    }
    let imaginary = radicand.imag().to_f64().abs();
    let is_negative = radicand.real().to_f64() < 0.0;
    if is_negative && !is_last && imaginary <= CLEARLY_NOT_ZERO * radicand_error {
        return Reading::Unclear;
    }
    let is_real = imaginary <= *radicand_error;
    let meant = meant_root(root, radicand, is_real && is_negative, bits);
    let Some(meant) = meant else {
        return Reading::Unclear;
    };
    let distance = size(&rug::Complex::with_val(bits, value - &meant)) / size(&meant);
    let error = value_error / size(value).max(size(&meant)) + radicand_error / radicand_size;
    // Neighbours among the q roots are 2 sin(pi/q) apart, which is at least 4/q.
    let half = 2.0 / f64::from(root.degree);
    if distance + error < half {
        Reading::Meant
    } else if distance - error > half {
        Reading::Other
    } else {
        Reading::Unclear
    }
}

/// The root of a radicand that is meant. `on_cut`: the radicand is a negative real number.
fn meant_root(
    root: &RootUnknown,
    radicand: &rug::Complex,
    on_cut: bool,
    bits: u32,
) -> Option<rug::Complex> {
    let field = ManyBits(bits);
    let exponent = Rational::from((1, root.degree));
    if !on_cut {
        return field.root(radicand, &exponent);
    }
    let part = radicand.real().clone();
    match root.branch {
        Branch::Real => {
            let size = rug::Complex::with_val(bits, -part);
            Some(field.negate(&field.root(&size, &exponent)?))
        }
        Branch::Principal => field.root(&rug::Complex::with_val(bits, part), &exponent),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(equations: &str, values: &[(f64, f64)], expected: BranchDecision) {
        let problem = cognate_systems::formats::plain::typed("test", equations);
        let system = problem.expect("a problem of this test").system;
        let tolerances = Tolerances::default();
        let branches = Branches::of(&system, &[], &tolerances, 1).expect("there are roots");
        let values: Vec<Complex64> = values
            .iter()
            .map(|&(re, im)| Complex64::new(re, im))
            .collect();
        let asked = AskedPoint {
            values: &values,
            accuracy: 1e-15,
            singular: false,
            isolated: true,
        };
        let decision = branches.at(asked, 1.0);
        assert_eq!(decision, expected, "{equations} at {values:?}");
    }

    #[test]
    fn square_roots_have_a_real_part_that_is_not_negative() {
        let equations = "sqrt(x + 3) = x - 3";
        check(equations, &[(6.0, 0.0), (3.0, 0.0)], BranchDecision::Meant);
        check(equations, &[(1.0, 0.0), (-2.0, 0.0)], BranchDecision::False);
        // sqrt(-4) is 2i, though the radicand is seen a little below the axis.
        let imaginary = "sqrt(x) = y; x = -4";
        check(
            imaginary,
            &[(-4.0, -1e-17), (0.0, 2.0), (1e-17, 2.0)],
            BranchDecision::Meant,
        );
        check(
            imaginary,
            &[(-4.0, 0.0), (0.0, -2.0), (0.0, -2.0)],
            BranchDecision::False,
        );
        check(
            "sqrt(x) = y; y = 0",
            &[(0.0, 0.0), (0.0, 0.0), (0.0, 0.0)],
            BranchDecision::Meant,
        );
    }

    #[test]
    fn cube_roots_of_real_numbers_are_real() {
        let root = (-2.0, 0.0);
        check(
            "cbrt(x) = y; x = -8",
            &[(-8.0, 0.0), root, root],
            BranchDecision::Meant,
        );
        check(
            "x^(1/3) = y; x = -8",
            &[(-8.0, 0.0), root, root],
            BranchDecision::False,
        );
        let principal = (1.0, 3f64.sqrt());
        check(
            "x^(1/3) = y; x = -8",
            &[(-8.0, 0.0), principal, principal],
            BranchDecision::Meant,
        );
        check(
            "cbrt(x) = y; x = -8",
            &[(-8.0, 0.0), principal, principal],
            BranchDecision::False,
        );
    }
}
