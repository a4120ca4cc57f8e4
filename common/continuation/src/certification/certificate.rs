//! Certificate: a box with exactly one solution in it, in exact numbers.

use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::directed::Directed;
use cognate_numeric::scalar::{Complex, Interval, Real};
use cognate_systems::scaling::{Scaling, exact_times, times_power_of_two};
use serde::{Deserialize, Serialize};

/// A proof that the square system has exactly one solution in the box of all z with |Re (z_i - c_i)| <= `radius[i]` and
/// |Im (z_i - c_i)| <= `radius[i]`, and that this solution lies within `error[i]` of c_i in the same sense.
///
/// One entry for each variable of the system. In a homogeneous group the largest variable is
/// fixed at 1: its centre is 1 and its radius 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// The box's centre c: exact dyadic numbers.
    pub centre: Vec<ComplexRational>,
    /// Half of the box's sides, exact; positive, but 0 for a variable that is fixed.
    pub radius: Vec<f64>,
    /// Bound of the distance from the centre to the solution; less than the radius, but 0 with it.
    pub error: Vec<f64>,
    /// A bound of ||1 - C J|| in the maximum norm over the box, for an approximate inverse C of
    /// the Jacobian J at the centre. Below 1/sqrt(2), which makes every point of the box an
    /// approximate zero in Smale's sense (arXiv 2011.05000).
    pub contraction: f64,
    /// Bits of the arithmetic that sufficed.
    pub precision_bits: u32,
}

/// Reason why nothing was proved about a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Uncertified {
    /// The point has the wrong number of coordinates, or some that are not finite.
    DamagedPoint,
    /// A constant or parameter of the system has no enclosure here.
    NoEnclosure,
    /// Newton's method leaves the point: there may be no solution near it.
    NewtonLeaves,
    /// The Jacobian is singular, or so nearly that the limit of precision does not tell.
    Singular,
    /// No box contracts at any precision up to the limit.
    NoContraction,
}

impl Uncertified {
    /// The reason in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::DamagedPoint => "its point is damaged",
            Self::NoEnclosure => "a constant of the system has no enclosure in this version",
            Self::NewtonLeaves => "Newton's method leaves it",
            Self::Singular => "the Jacobian is singular there, or too nearly so to tell",
            Self::NoContraction => "no box around it contracts, up to the limit of precision",
        }
    }
}

/// The outcome of one attempt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Certification {
    /// A proof that exactly one solution is near the point.
    Certified(Box<Certificate>),
    /// No proof, and the reason.
    Uncertified(Uncertified),
}

impl Certification {
    /// The certificate, if there is one.
    pub fn certificate(&self) -> Option<&Certificate> {
        match self {
            Self::Certified(certificate) => Some(certificate),
            Self::Uncertified(_) => None,
        }
    }
}

impl Certificate {
    /// Number of variables.
    pub fn dimension(&self) -> usize {
        self.centre.len()
    }

    /// True when its parts belong together: read from outside, it may be anything.
    pub fn is_sound(&self) -> bool {
        let bounded = |radius: &f64, error: &f64| {
            radius.is_finite()
                && *error >= 0.0
                && (error < radius || (*error == 0.0 && *radius == 0.0))
        };
        self.radius.len() == self.centre.len()
            && self.error.len() == self.centre.len()
            && self
                .radius
                .iter()
                .zip(&self.error)
                .all(|(r, e)| bounded(r, e))
            && self.contraction >= 0.0
            && self.contraction < 1.0
    }

    /// The certificate of unknowns that are tracked, in the variables; `None` where a double does
    /// not hold a radius. `homogeneous`: the variables of each homogeneous group.
    pub fn in_variables(&self, scaling: &Scaling, homogeneous: &[Vec<usize>]) -> Option<Self> {
        // By how much each variable is larger; the one of a group that is 1 stays 1.
        let mut exponents: Vec<i32> = (0..self.dimension()).map(|v| scaling.exponent(v)).collect();
        for group in homogeneous {
            let fixed = group.iter().find(|&&v| self.radius[v] == 0.0);
            let of_fixed = fixed.map_or(0, |&v| exponents[v]);
            group.iter().for_each(|&v| exponents[v] -= of_fixed);
        }
        let times = |value: &f64, &exponent: &i32| {
            let scaled = times_power_of_two(*value, exponent);
            (times_power_of_two(scaled, -exponent) == *value).then_some(scaled)
        };
        let to_variables = |values: &[f64]| -> Option<Vec<f64>> {
            let pairs = values.iter().zip(&exponents);
            pairs
                .map(|(value, exponent)| times(value, exponent))
                .collect()
        };
        let centre = self.centre.iter().zip(&exponents);
        Some(Self {
            centre: centre.map(|(c, &e)| exact_times(c, i64::from(e))).collect(),
            radius: to_variables(&self.radius)?,
            error: to_variables(&self.error)?,
            ..*self
        })
    }

    /// The box in which the solution is the only one, enclosed.
    pub fn unique_in<R: Directed>(&self, context: R::Context) -> Vec<Complex<Interval<R>>> {
        self.around(context, &self.radius)
    }

    /// The smaller box in which the solution is, enclosed.
    pub fn lies_in<R: Directed>(&self, context: R::Context) -> Vec<Complex<Interval<R>>> {
        self.around(context, &self.error)
    }

    fn around<R: Directed>(&self, context: R::Context, by: &[f64]) -> Vec<Complex<Interval<R>>> {
        let part = |centre: &Rational, by: f64| {
            let mut part = Interval::from_rational(context, centre);
            part.add(&Interval::around_zero(context, by));
            part
        };
        self.centre
            .iter()
            .zip(by)
            .map(|(c, &by)| Complex {
                re: part(&c.re, by),
                im: part(&c.im, by),
            })
            .collect()
    }
}
