//! Critical points of an objective: values, kinds, and which value is the least.

use crate::selection::{Box64, boxes};
use crate::solution::{NamedValues, Solution};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::symmetric_eigenvalues::symmetric_eigenvalues;
use cognate_numeric::scalar::{Complex, Interval};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch, values};
use cognate_systems::expression::NodeId;
use cognate_systems::objective::Goal;
use cognate_systems::polynomial::Polynomial;
use cognate_systems::polynomial::attained::{Attained, attained, lower_bound};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// An eigenvalue of the second derivatives counts as 0 below this fraction of the largest: what the digits of a point and of
/// its multipliers leave of them.
const ZERO_EIGENVALUE: f64 = 1e-8;
/// A multiplier of the objective counts as 0 below this fraction of the largest multiplier: the equations are singular.
const ZERO_MULTIPLIER: f64 = 1e-8;

/// What a real critical point is, by the second derivatives along the solutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A strict local minimum.
    Minimum,
    /// A strict local maximum.
    Maximum,
    /// Neither.
    Saddle,
    /// The second derivatives do not tell, or the equations are singular.
    Degenerate,
}

impl Kind {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
            Self::Saddle => "saddle",
            Self::Degenerate => "degenerate",
        }
    }
}

/// A critical point: the value of the objective and, at a real one, its kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriticalPoint {
    /// The real part of the objective.
    pub objective: f64,
    /// What it is; `None` where it is not real, or not known to be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<Kind>,
}

/// The least or the largest value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// How many points have it.
    pub points: u64,
}

/// Critical points, counted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriticalCounts {
    /// The objective as it was typed.
    pub objective: String,
    /// The least value; null where it was not asked, or it is not known to be one.
    pub minimum: Option<Extreme>,
    /// The largest value; null where it was not asked, or it is not known to be one.
    pub maximum: Option<Extreme>,
    /// Real points that are strict local minima.
    pub minima: u64,
    /// Real points that are strict local maxima.
    pub maxima: u64,
    /// Real points that are neither.
    pub saddles: u64,
    /// Real points of which the second derivatives do not tell what they are.
    pub degenerate: u64,
    /// Why the value is the least or largest, or why that is not known.
    pub reason: String,
}

impl CriticalCounts {
    /// The least and the largest value, where they are known, with the word for each.
    pub fn extremes(&self) -> impl Iterator<Item = (&'static str, Extreme)> {
        let values = [("least", self.minimum), ("largest", self.maximum)];
        values
            .into_iter()
            .filter_map(|(word, extreme)| Some((word, extreme?)))
    }
}

/// The value at a real point, and how far it may be from the exact one.
#[derive(Clone, Copy, Debug)]
struct Value {
    value: f64,
    error: f64,
}

/// An objective on the solutions of a system.
#[derive(Debug)]
pub struct Critical {
    /// What is asked.
    pub goal: Goal,
    /// The objective as it was typed.
    pub text: String,
    /// The system of the critical points, of `transform::critical_points`.
    system: System,
    objective: NodeId,
    /// Unknowns without multipliers.
    unknowns: usize,
    program: Interpreter,
    scratch: Scratch<f64>,
    /// The objective within bounds.
    value_program: Interpreter,
    value_scratch: Scratch<Interval<f64>>,
    /// The values at real points so far.
    values: Vec<Value>,
    counts: [u64; 4],
}

impl Critical {
    /// Of an objective in the graph of a system of critical points, which has so many unknowns before its multipliers.
    pub fn new(
        goal: Goal,
        text: String,
        objective: NodeId,
        system: System,
        unknowns: usize,
    ) -> Self {
        let (variables, parameters) = (system.variables.len(), system.parameters.len());
        let program = Interpreter::compile(
            &system.expressions,
            &system.equations,
            variables,
            parameters,
        );
        let roots = [objective];
        let value_program =
            Interpreter::compile(&system.expressions, &roots, variables, parameters);
        Self {
            value_scratch: Evaluate::<Interval<f64>>::scratch(&value_program, ()),
            value_program,
            goal,
            text,
            objective,
            unknowns,
            scratch: Evaluate::<f64>::scratch(&program, ()),
            program,
            system,
            values: Vec::new(),
            counts: [0; 4],
        }
    }

    /// How many equations were given.
    fn constraints(&self) -> usize {
        self.system.equations.len() - self.unknowns
    }

    /// A solution of the system of critical points without its multipliers, and what it is.
    pub fn present(
        &mut self,
        mut solution: Solution,
        parameters: &[Complex64],
    ) -> (Solution, CriticalPoint) {
        let point: Vec<Complex64> = solution.variables.values().collect();
        let value = values(
            &self.system.expressions,
            &[self.objective],
            &point,
            parameters,
        )[0]
        .re;
        let error = self.error(&solution, parameters, value);
        let is_real = solution.real == Some(true) && !solution.undecided;
        let kind = is_real.then(|| self.kind(&point, parameters, solution.singular));
        if let Some(kind) = kind {
            self.values.push(Value { value, error });
            self.counts[kind as usize] += 1;
        }
        // The error is relative to the largest coordinate, which may have been a multiplier.
        let largest = |point: &[Complex64]| {
            point
                .iter()
                .map(|z| z.norm_sqr())
                .fold(0.0, f64::max)
                .sqrt()
        };
        let mut variables = std::mem::take(&mut solution.variables.0);
        variables.truncate(self.unknowns);
        let ratio = largest(&point) / largest(&point[..self.unknowns.min(point.len())]);
        if ratio.is_finite() {
            solution.accuracy *= ratio.max(1.0);
        }
        solution.variables = NamedValues(variables);
        let objective = value;
        (solution, CriticalPoint { objective, kind })
    }

    /// How far the objective may be from a value, by the accuracy of a solution; infinite where that is not known.
    fn error(&mut self, solution: &Solution, parameters: &[Complex64], value: f64) -> f64 {
        let exactly = |z: &Complex64| Complex {
            re: Interval::point(&z.re),
            im: Interval::point(&z.im),
        };
        let parameters: Vec<Box64> = parameters.iter().map(exactly).collect();
        let mut bounds = [Box64::zero(())];
        let point = boxes(solution);
        self.value_program
            .value(&point, &parameters, &mut bounds, &mut self.value_scratch);
        let [Complex { re, .. }] = bounds;
        match re.is_valid() {
            true => (re.upper() - value).max(value - re.lower()),
            false => f64::INFINITY,
        }
    }

    /// What a real critical point is: the signs of the second derivatives of the objective less multiples of the
    /// equations, on the directions along the solutions. These are the signs of the bordered matrix, less one of each
    /// kind for each equation (Haynsworth's inertia additivity).
    fn kind(&mut self, point: &[Complex64], parameters: &[Complex64], is_singular: bool) -> Kind {
        let (n, m) = (self.unknowns, self.constraints());
        if is_singular {
            return Kind::Degenerate;
        }
        // Without equations there are no multipliers.
        let mut scaled = point.to_vec();
        if m > 0 {
            let multipliers = &point[n..];
            let largest = multipliers
                .iter()
                .map(|z| z.norm_sqr())
                .fold(0.0, f64::max)
                .sqrt();
            let first = multipliers[0];
            if first.norm_sqr().sqrt() <= ZERO_MULTIPLIER * largest {
                return Kind::Degenerate;
            }
            for z in &mut scaled[n..] {
                *z /= first;
            }
        }
        let jacobian = self.jacobian(&scaled, parameters);
        let size = n + m;
        let mut rows = vec![vec![0.0; size]; size];
        for i in 0..size {
            for j in 0..n.min(i + 1) {
                rows[i][j] = jacobian.at(i, j).re;
            }
        }
        let eigenvalues = symmetric_eigenvalues(&rows);
        let largest = eigenvalues
            .iter()
            .fold(0.0f64, |largest, value| largest.max(value.abs()));
        let tiny = ZERO_EIGENVALUE * largest;
        let positive = eigenvalues.iter().filter(|value| **value > tiny).count();
        let negative = eigenvalues.iter().filter(|value| **value < -tiny).count();
        if positive + negative < size || positive < m || negative < m {
            return Kind::Degenerate;
        }
        match (positive - m, negative - m) {
            // The equations leave no direction.
            (0, 0) if self.goal == Goal::Maximize => Kind::Maximum,
            (_, 0) => Kind::Minimum,
            (0, _) => Kind::Maximum,
            _ => Kind::Saddle,
        }
    }

    fn jacobian(&mut self, point: &[Complex64], parameters: &[Complex64]) -> Matrix<f64> {
        let own = |z: &Complex64| Complex { re: z.re, im: z.im };
        let x: Vec<Complex<f64>> = point.iter().map(own).collect();
        let p: Vec<Complex<f64>> = parameters.iter().map(own).collect();
        let mut out = Matrix::zeros((), self.system.equations.len(), x.len() + 2);
        self.program.jacobian(&x, &p, &mut out, &mut self.scratch);
        out
    }

    /// The counts. `doubt` says why not all critical points are known, where that is so.
    pub fn counts(&self, parameters: &[Complex64], doubt: Option<String>) -> CriticalCounts {
        let [minima, maxima, saddles, degenerate] = self.counts;
        let mut counts = CriticalCounts {
            objective: self.text.clone(),
            minimum: None,
            maximum: None,
            minima,
            maxima,
            saddles,
            degenerate,
            reason: "critical points were asked, not the least or the largest value".into(),
        };
        let sign = match self.goal {
            Goal::Critical => return counts,
            Goal::Minimize => 1.0,
            Goal::Maximize => -1.0,
        };
        let (extreme, reason) = self.extreme(sign, parameters, doubt);
        counts.reason = reason;
        match self.goal {
            Goal::Maximize => counts.maximum = extreme,
            _ => counts.minimum = extreme,
        }
        counts
    }

    /// The least value (`sign` 1) or the largest (`sign` -1), where it is known, and the reason.
    fn extreme(
        &self,
        sign: f64,
        parameters: &[Complex64],
        doubt: Option<String>,
    ) -> (Option<Extreme>, String) {
        let least = if sign > 0.0 { "least" } else { "largest" };
        if let Some(doubt) = doubt {
            return (None, format!("not all critical points are known: {doubt}"));
        }
        if self.values.iter().any(|value| !value.error.is_finite()) {
            return (None, "the accuracy of a critical point is not known".into());
        }
        let by_value = |a: &&Value, b: &&Value| (sign * a.value).total_cmp(&(sign * b.value));
        let best = self.values.iter().min_by(by_value);
        let bound = (sign > 0.0).then(|| lower_bound(&self.system.expressions, self.objective));
        let by_bound = || {
            let reaches = |bound: &f64| best.is_some_and(|best| best.value - best.error <= *bound);
            bound
                .flatten()
                .filter(reaches)
                .map(|_| Attained::LowerBound)
        };
        let Some(attained) = self.attained(sign, parameters).or_else(by_bound) else {
            let lower = if sign > 0.0 { "lower" } else { "larger" };
            let reason = format!(
                "all critical points are known; a {lower} value towards infinity is not excluded"
            );
            return (None, reason);
        };
        let Some(best) = best else {
            return (
                None,
                "there is no real solution: the value would be taken at one".into(),
            );
        };
        let is_best = |other: &&Value| (other.value - best.value).abs() <= other.error + best.error;
        let extreme = Extreme {
            value: best.value,
            points: self.values.iter().filter(is_best).count() as u64,
        };
        let because = match attained {
            Attained::Bounded => "the equations bound all unknowns",
            Attained::Grows => {
                "the objective grows towards infinity in every direction that the equations leave"
            }
            Attained::LowerBound => "no sum of even powers is below it",
        };
        let reason = format!("the {least} of all critical values, which is taken since {because}");
        (Some(extreme), reason)
    }

    fn attained(&self, sign: f64, parameters: &[Complex64]) -> Option<Attained> {
        let n = self.unknowns;
        let total = self.system.variables.len();
        let expand = |node: NodeId| {
            let expanded = Polynomial::expand(
                &self.system.expressions,
                node,
                total,
                self.system.parameters.len(),
            )?;
            // Without the exponents of the multipliers, which do not occur.
            let terms = expanded.terms.into_iter().map(|(mut key, coefficient)| {
                key.drain(n..total);
                (key, coefficient)
            });
            Some(Polynomial {
                terms: terms.collect(),
                variables: n,
            })
        };
        let objective = expand(self.objective)?;
        let equations = self.system.equations[n..]
            .iter()
            .filter_map(|equation| expand(*equation));
        let equations: Vec<Polynomial> = equations.collect();
        attained(&objective, &equations, parameters, sign)
    }
}
