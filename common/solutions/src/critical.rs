//! Critical points of an objective: values, kinds, and which value is the least.

mod extreme;
mod general_point;
mod kind;
mod limit;
mod sets;
mod spheres;
mod taken;
mod value;

pub use kind::Kind;

use crate::point_shape::{largest, modulus};
use crate::selection::{Box64, Selector, Verdict, boxes};
use crate::solution::{NamedValues, Solution};
use crate::typed_unknowns::typed_values;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Interval};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch, values};
use cognate_systems::expression::NodeId;
use cognate_systems::objective::{Goal, Objective};
use cognate_systems::system::System;
use kind::inertia;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use value::{Place, PointInside, Value, ValuesOnSphere};

/// A multiplier of the objective counts as 0 below this fraction of the largest multiplier: the equations are singular.
const ZERO_MULTIPLIER: f64 = 1e-8;

/// A critical point: the value of the objective and, at a real one, its kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriticalPoint {
    /// The real part of the objective.
    pub objective: f64,
    /// Kind of the point; `None` where the point is not real, or not known to be real.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<Kind>,
}

/// The least or the largest value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// Number of points with this value.
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
    /// Real critical points that do not meet the conditions, in no other count; `None` without conditions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outside: Option<u64>,
    /// Points that are critical with a whole set of multipliers, since the gradients of what holds with equality there
    /// depend on each other: listed, and in no count of solutions. Null where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_sets_of_multipliers: Option<u64>,
    /// On every positive-dimensional set of critical points only multipliers move.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub sets_of_multipliers_only: bool,
    /// Reason why the value is the least or largest, or why that is not known.
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

/// A comparison of the conditions, with its multiplier.
#[derive(Clone, Debug)]
pub struct Alternative {
    /// The expression that is at least 0, in the graph of the system of critical points.
    pub expression: NodeId,
    /// Indices of the differences in the conditions that are multiples of it.
    pub differences: Vec<usize>,
    /// Whether the critical points have a multiplier of it: without one, they are critical on the border as well.
    pub has_multiplier: bool,
}

/// The conditions of an objective, each of which is active at a critical point or not.
#[derive(Debug)]
pub struct Alternatives {
    /// The alternatives in the order of their multipliers; those without come last.
    pub alternatives: Vec<Alternative>,
    /// Decides the conditions with equality everywhere.
    pub closed: Selector,
    /// Number of differences of the conditions.
    pub differences: usize,
    /// Whether a condition excludes equality.
    pub excludes_equality: bool,
}

/// A critical point as it is shown.
#[derive(Clone, Debug)]
pub struct Presented {
    /// The solution without multipliers.
    pub solution: Solution,
    /// Value of the objective and kind of the point.
    pub point: CriticalPoint,
    /// Whether the point is selected; `None` where all are shown.
    pub verdict: Option<Verdict>,
}

/// An objective on the solutions of a system.
#[derive(Debug)]
pub struct Critical {
    /// Which critical points are wanted: those with the least value, with the largest value, or all.
    pub goal: Goal,
    /// The objective as it was typed.
    pub text: String,
    /// Whether an expression has a denominator, near the zeros of which values may be as large as one likes.
    pub has_denominators: bool,
    /// The system of the critical points, of `transform::critical_points`: its equations may have denominators.
    system: System,
    objective: NodeId,
    /// Unknowns without multipliers.
    unknowns: usize,
    /// The system of the equations that were given, of which some unknowns stand for roots and angles; `None` where none does.
    pub with_helpers: Option<System>,
    alternatives: Option<Alternatives>,
    program: Interpreter,
    scratch: Scratch<f64>,
    /// Program for bounds of the objective and, after it, of the expressions that are at least 0.
    value_program: Interpreter,
    value_scratch: Scratch<Interval<f64>>,
    /// The values at real points so far.
    values: Vec<Value>,
    counts: [u64; 4],
    outside: u64,
    /// The sets of critical points, where all are known.
    sets: Option<CriticalSets>,
    /// Real points that meet the equations and all conditions, with any values.
    points_inside: Vec<PointInside>,
    /// The least value of the objective and a small multiple of the squared distance to a general point, on the points
    /// that meet the conditions; `None` where it is not known.
    least_near: Option<f64>,
    /// A number that no value of the objective is below at points that meet the conditions, both with the sign of the goal;
    /// `None` where it was not asked.
    least_inside: Option<f64>,
    /// Values on a large sphere; `None` where they were not asked.
    on_sphere: Option<ValuesOnSphere>,
}

/// Numbers of sets of critical points, from a decomposition of all of them.
#[derive(Debug)]
struct CriticalSets {
    /// Number of isolated critical points.
    isolated: u64,
    /// Number of sets of critical points of positive dimension.
    count: u64,
    /// Real points with sets of multipliers: on each of these only the multipliers move.
    single_points: Vec<Solution>,
}

impl Critical {
    /// Prepares an objective in the graph of a system of critical points, which has `unknowns` unknowns before its
    /// multipliers, with the conditions, where there are some.
    pub fn new(
        objective: Objective,
        system: System,
        unknowns: usize,
        alternatives: Option<Alternatives>,
    ) -> Self {
        let Objective {
            goal, text, node, ..
        } = objective;
        let (variables, parameters) = (system.variables.len(), system.parameters.len());
        let program = Interpreter::compile(
            &system.expressions,
            &system.equations,
            variables,
            parameters,
        );
        let mut roots = vec![node];
        let conditions = alternatives.iter().flat_map(|with| &with.alternatives);
        roots.extend(conditions.map(|alternative| alternative.expression));
        let value_program =
            Interpreter::compile(&system.expressions, &roots, variables, parameters);
        Self {
            value_scratch: Evaluate::<Interval<f64>>::scratch(&value_program, ()),
            value_program,
            goal,
            text,
            has_denominators: false,
            objective: node,
            unknowns,
            with_helpers: None,
            alternatives,
            scratch: Evaluate::<f64>::scratch(&program, ()),
            program,
            system,
            values: Vec::new(),
            counts: [0; 4],
            outside: 0,
            sets: None,
            points_inside: Vec::new(),
            least_near: None,
            least_inside: None,
            on_sphere: None,
        }
    }

    /// Number of unknowns without multipliers.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// 1 where the least value is wanted, -1 where the largest is.
    fn sign(&self) -> f64 {
        match self.goal {
            Goal::Maximize => -1.0,
            Goal::Minimize | Goal::Critical => 1.0,
        }
    }

    /// The expressions that are at least 0 by the conditions.
    fn alternatives(&self) -> &[Alternative] {
        let alternatives = self.alternatives.as_ref();
        alternatives.map_or(&[][..], |with| &with.alternatives)
    }

    /// Number of equations that were given.
    fn constraints(&self) -> usize {
        let alternatives = self.alternatives().iter();
        let multipliers = alternatives
            .filter(|alternative| alternative.has_multiplier)
            .count();
        self.system.equations.len() - self.unknowns - multipliers
    }

    /// Presents a solution of the system of critical points without its multipliers: kind of the point, and whether the
    /// conditions select it as they were typed.
    pub fn present(
        &mut self,
        solution: Solution,
        parameters: &[Complex64],
        selector: Option<&mut Selector>,
    ) -> Presented {
        let point: Vec<Complex64> = solution.variables.values().collect();
        let bounds = self.bounds(&solution, parameters);
        let (value, error) = self.value(&point, parameters, &bounds[0]);
        let active = self.active(&point, &bounds[1..], solution.singular);
        let is_real = solution.real == Some(true) && !solution.undecided;
        let kind = is_real.then(|| self.kind(&point, parameters, &active, solution.singular));
        let solution = without_multipliers(solution, &point, self.unknowns);
        let zeros = self.zeros(&active);
        let verdict = selector.map(|s| s.verdict_with_zeros(&solution, parameters, &zeros));
        if let Some(kind) = kind {
            let place = match self.place(&solution, parameters, verdict, &zeros) {
                Some(Place::Limit) if !self.is_limit(&point, parameters, &bounds[1..]) => {
                    Some(Place::Excluded)
                }
                place => place,
            };
            self.values.extend(place.map(|place| Value {
                value,
                error,
                place,
            }));
            match place {
                Some(Place::Inside | Place::Unknown) => self.counts[kind as usize] += 1,
                _ => self.outside += 1,
            }
        }
        let mut solution = solution;
        if let Some(system) = &self.with_helpers {
            solution.variables = typed_values(&solution, &system.typed_unknowns(), None);
        }
        Presented {
            solution,
            point: CriticalPoint {
                objective: value,
                kind,
            },
            verdict,
        }
    }

    /// The real part of the objective at a point, and its error; `bound` is the objective at the box of the point.
    fn value(&self, point: &[Complex64], parameters: &[Complex64], bound: &Box64) -> (f64, f64) {
        let (expressions, objective) = (&self.system.expressions, self.objective);
        let value = values(expressions, &[objective], point, parameters)[0].re;
        // A value that may be 0 by the digits of the point is 0.
        if !bound.re.is_valid() {
            (value, f64::INFINITY)
        } else if bound.re.may_be_zero() {
            (0.0, bound.re.upper().max(-bound.re.lower()))
        } else {
            (
                value,
                (bound.re.upper() - value).max(value - bound.re.lower()),
            )
        }
    }

    /// The objective and what is at least 0 by the conditions, at the box of a solution.
    fn bounds(&mut self, solution: &Solution, parameters: &[Complex64]) -> Vec<Box64> {
        let exactly = |z: &Complex64| Complex {
            re: Interval::point(&z.re),
            im: Interval::point(&z.im),
        };
        let parameters: Vec<Box64> = parameters.iter().map(exactly).collect();
        let mut bounds = vec![Box64::zero(()); 1 + self.alternatives().len()];
        let mut point = boxes(solution);
        point.truncate(self.system.variables.len());
        self.value_program
            .value(&point, &parameters, &mut bounds, &mut self.value_scratch);
        bounds
    }

    /// Decides which alternatives are active: their multiplier is not 0, so that the condition holds with equality. At
    /// a singular solution both may be 0.
    fn active(&self, point: &[Complex64], bounds: &[Box64], is_singular: bool) -> Vec<bool> {
        let multipliers = &point[self.unknowns.min(point.len())..];
        let tiny = ZERO_MULTIPLIER * largest(multipliers);
        let first = 1 + self.constraints();
        let multiplier = |k: usize| multipliers.get(first + k).map_or(0.0, |z| modulus(*z));
        let is_active = |(k, bound): (usize, &Box64)| {
            multiplier(k) > tiny || is_singular && bound.re.may_be_zero()
        };
        bounds.iter().enumerate().map(is_active).collect()
    }

    /// The differences of the conditions that are 0, by their index.
    fn zeros(&self, active: &[bool]) -> Vec<bool> {
        let mut zeros = vec![false; self.alternatives.as_ref().map_or(0, |a| a.differences)];
        for (alternative, is_active) in self.alternatives().iter().zip(active) {
            for &difference in &alternative.differences {
                zeros[difference] |= is_active;
            }
        }
        zeros
    }

    /// Finds the place of a real critical point; `None` where the point does not meet the conditions, `Limit` where it meets
    /// them all but for equality.
    fn place(
        &mut self,
        solution: &Solution,
        parameters: &[Complex64],
        verdict: Option<Verdict>,
        zeros: &[bool],
    ) -> Option<Place> {
        let Some(Alternatives { closed, .. }) = &mut self.alternatives else {
            return Some(Place::Inside);
        };
        match (
            verdict,
            closed.verdict_with_zeros(solution, parameters, zeros),
        ) {
            (None | Some(Verdict::Selected), _) => Some(Place::Inside),
            (_, Verdict::Rejected) => None,
            (Some(Verdict::Rejected), Verdict::Selected) => Some(Place::Limit),
            (Some(Verdict::Rejected), _) => Some(Place::Excluded),
            _ => Some(Place::Unknown),
        }
    }

    /// Computes the kind of a real critical point: the signs of the second derivatives of the objective less multiples
    /// of the equations and of the active conditions, on the directions along both. These are the signs of the bordered
    /// matrix, less one of each kind for each equation (Haynsworth's inertia additivity). Away from an active condition
    /// the objective grows where its multiplier is positive.
    fn kind(
        &mut self,
        point: &[Complex64],
        parameters: &[Complex64],
        active: &[bool],
        is_singular: bool,
    ) -> Kind {
        let n = self.unknowns;
        let equations = self.constraints();
        if is_singular {
            return Kind::Degenerate;
        }
        // Without equations there are no multipliers.
        let mut scaled = point.to_vec();
        if let Some(&first) = point.get(n) {
            if modulus(first) <= ZERO_MULTIPLIER * largest(&point[n..]) {
                return Kind::Degenerate;
            }
            for z in &mut scaled[n..] {
                *z /= first;
            }
        }
        let jacobian = self.jacobian(&scaled, parameters);
        // The derivatives of a multiplier times its condition are, where that is 0, a multiple of the condition's.
        let conditions = active.iter().enumerate().filter(|(_, active)| **active);
        let places: Vec<usize> = conditions.map(|(k, _)| equations + k).collect();
        let growth: Vec<f64> = places.iter().map(|p| scaled[n + 1 + p].re).collect();
        let borders: Vec<usize> = (0..equations).chain(places).map(|p| n + p).collect();
        let m = borders.len();
        let size = n + m;
        let mut rows = vec![vec![0.0; size]; size];
        for (i, place) in (0..n).chain(borders).enumerate() {
            for j in 0..n.min(i + 1) {
                rows[i][j] = jacobian.at(place, j).re;
            }
        }
        let inertia = inertia(&rows).filter(|&(positive, negative)| positive.min(negative) >= m);
        let Some((positive, negative)) = inertia else {
            return Kind::Degenerate;
        };
        let grows = growth.iter().all(|multiplier| *multiplier > 0.0);
        let falls = growth.iter().all(|multiplier| *multiplier < 0.0);
        match (positive - m, negative - m) {
            // No direction is left.
            (0, 0) if falls && (!grows || self.goal == Goal::Maximize) => Kind::Maximum,
            (_, 0) if grows => Kind::Minimum,
            (0, _) if falls => Kind::Maximum,
            _ => Kind::Saddle,
        }
    }

    fn jacobian(&mut self, point: &[Complex64], parameters: &[Complex64]) -> Matrix<f64> {
        let to_complex = |z: &Complex64| Complex { re: z.re, im: z.im };
        let x: Vec<Complex<f64>> = point.iter().map(to_complex).collect();
        let p: Vec<Complex<f64>> = parameters.iter().map(to_complex).collect();
        let mut out = Matrix::zeros((), self.system.equations.len(), x.len() + 2);
        self.program.jacobian(&x, &p, &mut out, &mut self.scratch);
        out
    }
}

/// Removes the coordinates after the first `unknowns`. The accuracy of a solution is relative to the largest
/// coordinate, which may have been a multiplier.
fn without_multipliers(mut solution: Solution, point: &[Complex64], unknowns: usize) -> Solution {
    let mut variables = std::mem::take(&mut solution.variables.0);
    variables.truncate(unknowns);
    let ratio = largest(point) / largest(&point[..unknowns.min(point.len())]);
    if ratio.is_finite() {
        solution.accuracy *= ratio.max(1.0);
    }
    solution.variables = NamedValues(variables);
    solution
}
