//! Critical points of an objective: values, kinds, and which value is the least.

use crate::point_shape::{largest, modulus};
use crate::selection::{Box64, Selector, Verdict, boxes};
use crate::solution::{NamedValues, Solution};
use crate::typed_unknowns::typed_values;
use crate::witness::WitnessSet;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::linear_algebra::symmetric_eigenvalues::symmetric_eigenvalues;
use cognate_numeric::precision::DOUBLE;
use cognate_numeric::scalar::{Complex, Interval};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch, values};
use cognate_systems::expression::{Node, NodeId};
use cognate_systems::objective::{Goal, Objective};
use cognate_systems::polynomial::Polynomial;
use cognate_systems::polynomial::attained::{Attained, Region, attained, lower_bound};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// An eigenvalue of the second derivatives counts as 0 below this fraction of the largest: what the digits of a point and of
/// its multipliers leave of them.
const ZERO_EIGENVALUE: f64 = 1e-8;
/// A multiplier of the objective counts as 0 below this fraction of the largest multiplier: the equations are singular.
const ZERO_MULTIPLIER: f64 = 1e-8;

/// A singular value of the equations' derivatives by the multipliers counts as 0 below this fraction of the largest: half of
/// the digits of a double, since the point may be singular.
const ZERO_SINGULAR_VALUE: f64 = 1e-8;

/// Error of the objective at a witness point, relative to 1 and its size: half of the digits of a double, since the point may
/// be singular.
const ERROR_ON_A_SET: f64 = 1e-8;

/// Kind of a real critical point, by the second derivatives along the solutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A strict local minimum.
    Minimum,
    /// A strict local maximum.
    Maximum,
    /// A critical point that is neither a local minimum nor a local maximum.
    Saddle,
    /// The second derivatives do not tell, or the equations are singular.
    Degenerate,
}

impl Kind {
    /// Kind of a point with gradient 0, where `rows` are the second derivatives by all unknowns and no equation
    /// restricts the unknowns.
    pub fn of_second_derivatives(rows: &[Vec<f64>]) -> Self {
        match inertia(rows) {
            Some((_, 0)) => Self::Minimum,
            Some((0, _)) => Self::Maximum,
            Some(_) => Self::Saddle,
            None => Self::Degenerate,
        }
    }

    /// Word for the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
            Self::Saddle => "saddle",
            Self::Degenerate => "degenerate",
        }
    }
}

/// Numbers of positive and negative eigenvalues of the symmetric matrix with these rows; `None` where one counts as 0.
fn inertia(rows: &[Vec<f64>]) -> Option<(usize, usize)> {
    let eigenvalues = symmetric_eigenvalues(rows);
    let largest = eigenvalues
        .iter()
        .fold(0.0f64, |largest, value| largest.max(value.abs()));
    let tiny = ZERO_EIGENVALUE * largest;
    let positive = eigenvalues.iter().filter(|value| **value > tiny).count();
    let negative = eigenvalues.iter().filter(|value| **value < -tiny).count();
    (positive + negative == rows.len()).then_some((positive, negative))
}

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

/// The value at a real point, and how far it may be from the exact one.
#[derive(Clone, Copy, Debug)]
struct Value {
    value: f64,
    error: f64,
    place: Place,
}

impl Value {
    /// Whether this may be the same value.
    fn is_near(&self, other: &Self) -> bool {
        (other.value - self.value).abs() <= other.error + self.error
    }

    /// Reason why it is not known, or not so, that the value is taken at a point that meets the conditions.
    fn why_not_taken(&self) -> Option<String> {
        let value = self.value;
        Some(match self.place {
            Place::Inside => return None,
            Place::Unknown => format!(
                "it is not known whether the point with the value {value} meets the conditions, or lies outside by \
                 less than its accuracy"
            ),
            Place::OnSet => format!(
                "a positive-dimensional set of critical points has the value {value}, and it is not known whether it \
                 has real points that meet the conditions"
            ),
            Place::Excluded => format!(
                "there is none: values come as near as one likes to {value}, at a point that the conditions exclude"
            ),
        })
    }
}

/// Place of a real critical point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// The point meets all conditions.
    Inside,
    /// The point meets one condition that excludes equality with equality, and all others.
    Excluded,
    /// It is not known whether the point meets the conditions.
    Unknown,
    /// The value is taken on a set of positive dimension, of which the real points are not known.
    OnSet,
}

/// A comparison of the conditions, with its multiplier.
#[derive(Clone, Copy, Debug)]
pub struct Alternative {
    /// The expression that is at least 0, in the graph of the system of critical points.
    pub expression: NodeId,
    /// Index of the difference in the conditions.
    pub difference: usize,
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
    /// Number of real points with sets of multipliers.
    single_points: u64,
    /// The sets of critical points, where all are known.
    sets: Option<CriticalSets>,
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

/// Values of the unknowns at a point with a set of multipliers.
struct SinglePoint(Vec<Complex64>);

impl SinglePoint {
    fn is_real(&self) -> bool {
        let size = 1.0 + largest(&self.0);
        self.0.iter().all(|z| z.im.abs() <= ERROR_ON_A_SET * size)
    }
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
            single_points: 0,
            sets: None,
        }
    }

    /// Number of critical points that are isolated by a whole decomposition, where one was made.
    pub fn isolated(&self) -> Option<u64> {
        self.sets.as_ref().map(|sets| sets.isolated)
    }

    /// Adds the components of a whole decomposition of the system of critical points. Where the multiplier of the objective
    /// is not 0 its derivatives along a component are 0, so that it has one value there: that of a witness point. Nothing
    /// is added where the multiplier is 0 on a component, or the values at its witness points differ.
    pub fn add_sets(&mut self, sets: &[WitnessSet], parameters: &[Complex64]) {
        let mut values = Vec::new();
        let mut single_points = Vec::new();
        let (isolated, mut curves): (Vec<&WitnessSet>, Vec<&WitnessSet>) =
            sets.iter().partition(|set| set.id.dimension == 0);
        curves.retain(|set| match self.single_point(set, parameters) {
            Some(point) => {
                single_points.extend(point.is_real().then(|| self.solution_at(&point.0)));
                false
            }
            None => true,
        });
        for set in &curves {
            let Some(value) = self.value_on(set, parameters) else {
                return;
            };
            // At a real point the objective is real.
            if value.im.abs() <= ERROR_ON_A_SET * (1.0 + modulus(value)) {
                values.push(Value {
                    value: value.re,
                    error: ERROR_ON_A_SET * (1.0 + modulus(value)),
                    place: Place::OnSet,
                });
            }
        }
        self.values.extend(values);
        self.single_points = single_points.len() as u64;
        self.sets = Some(CriticalSets {
            isolated: isolated.iter().map(|set| set.degree).sum(),
            count: curves.len() as u64,
            single_points,
        });
    }

    /// The real points at which only multipliers move, to be presented as solutions are.
    pub fn take_single_points(&mut self) -> Vec<Solution> {
        let sets = self.sets.as_mut();
        sets.map_or(Vec::new(), |sets| std::mem::take(&mut sets.single_points))
    }

    /// The values of the unknowns that a component has all over, where only multipliers move on it.
    ///
    /// Multipliers enter linearly: those that belong to a point are a linear space in projective space, and where its dimension is that of
    /// the component, which is irreducible, both are the same.
    fn single_point(&mut self, set: &WitnessSet, parameters: &[Complex64]) -> Option<SinglePoint> {
        let (n, variables) = (self.unknowns, self.system.variables.len());
        let [point] = &set.points[..] else {
            return None;
        };
        if point.len() != variables || variables == n {
            return None;
        }
        let jacobian = self.jacobian(point, parameters);
        let entry = |i: usize, j: usize| {
            let z = jacobian.at(i, j);
            Complex64::new(z.re, z.im)
        };
        let column = |j: usize| (0..jacobian.rows()).map(|i| entry(i, j)).collect();
        let singular_values = Svd::of((n..variables).map(column).collect()).values;
        let largest = singular_values.first().copied()?;
        let rank = singular_values
            .iter()
            .filter(|value| **value > ZERO_SINGULAR_VALUE * largest);
        let free = variables - n - rank.count();
        (free == set.id.dimension as usize + 1).then(|| SinglePoint(point[..n].to_vec()))
    }

    /// A real point with these values of the unknowns as a singular solution, without multipliers.
    fn solution_at(&self, unknowns: &[Complex64]) -> Solution {
        let real = unknowns.iter().map(|z| Complex64::new(z.re, 0.0));
        let values = real.chain(std::iter::repeat(Complex64::default()));
        Solution {
            variables: self.system.variables.iter().cloned().zip(values).collect(),
            multiplicity: 1,
            cycles: Vec::new(),
            real: Some(true),
            singular: true,
            residual: 0.0,
            condition: f64::INFINITY,
            accuracy: ERROR_ON_A_SET,
            precision_bits: DOUBLE,
            class: None,
            paths: Vec::new(),
            certificate: None,
            deflations: None,
            undecided: false,
        }
    }

    /// The value of the objective on a component.
    fn value_on(&self, set: &WitnessSet, parameters: &[Complex64]) -> Option<Complex64> {
        let (expressions, n) = (&self.system.expressions, self.unknowns);
        let value = |point: &Vec<Complex64>| {
            let is_regular = match point.get(n) {
                Some(first) => modulus(*first) > ERROR_ON_A_SET * largest(&point[n..]),
                None => true,
            };
            let value = values(expressions, &[self.objective], point, parameters)[0];
            (is_regular && value.is_finite()).then_some(value)
        };
        let mut values = set.points.iter().map(value);
        let first = values.next()??;
        let is_same = |value: Option<Complex64>| {
            value.is_some_and(|z| modulus(z - first) <= ERROR_ON_A_SET * (1.0 + modulus(first)))
        };
        values.all(is_same).then_some(first)
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
        let value = values(
            &self.system.expressions,
            &[self.objective],
            &point,
            parameters,
        )[0]
        .re;
        let bounds = self.bounds(&solution, parameters);
        // A value that may be 0 by the digits of the point is 0.
        let value = match bounds[0].re.is_valid() && bounds[0].re.may_be_zero() {
            true => 0.0,
            false => value,
        };
        let error = match bounds[0].re.is_valid() {
            true => (bounds[0].re.upper() - value).max(value - bounds[0].re.lower()),
            false => f64::INFINITY,
        };
        let active = self.active(&point, &bounds[1..], solution.singular);
        let is_real = solution.real == Some(true) && !solution.undecided;
        let kind = is_real.then(|| self.kind(&point, parameters, &active, solution.singular));
        let solution = without_multipliers(solution, &point, self.unknowns);
        let zeros = self.zeros(&active);
        let verdict = selector.map(|s| s.verdict_with_zeros(&solution, parameters, &zeros));
        if let Some(kind) = kind {
            let place = self.place(&solution, parameters, verdict, &zeros);
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

    /// The objective and what is at least 0 by the conditions, at the box of a solution.
    fn bounds(&mut self, solution: &Solution, parameters: &[Complex64]) -> Vec<Box64> {
        let exactly = |z: &Complex64| Complex {
            re: Interval::point(&z.re),
            im: Interval::point(&z.im),
        };
        let parameters: Vec<Box64> = parameters.iter().map(exactly).collect();
        let mut bounds = vec![Box64::zero(()); 1 + self.alternatives().len()];
        let point = boxes(solution);
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
            zeros[alternative.difference] |= is_active;
        }
        zeros
    }

    /// Finds the place of a real critical point; `None` where the point does not meet the conditions.
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
            (Some(Verdict::Rejected), Verdict::Selected) => Some(Place::Excluded),
            (_, Verdict::Rejected) => None,
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
            outside: self.alternatives.as_ref().map(|_| self.outside),
            with_sets_of_multipliers: (self.single_points > 0).then_some(self.single_points),
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
        // Of equal values one at a point that meets the conditions for sure decides.
        let inside = |value: &&Value| value.place == Place::Inside;
        let best = best.map(|best| self.near(best).find(inside).unwrap_or(best));
        if let Some(reason) = best.and_then(Value::why_not_taken) {
            return (None, reason);
        }
        let expressions = &self.system.expressions;
        let variable_of = |alternative: &Alternative| match expressions.node(alternative.expression)
        {
            Node::Variable(variable) => Some(*variable as usize),
            _ => None,
        };
        let nonnegative: Vec<usize> = self.alternatives().iter().filter_map(variable_of).collect();
        let bound = (sign > 0.0).then(|| lower_bound(expressions, self.objective, &nonnegative));
        let by_bound = || {
            let reaches = |bound: &f64| best.is_some_and(|best| best.value - best.error <= *bound);
            bound
                .flatten()
                .filter(reaches)
                .map(|_| Attained::LowerBound)
        };
        let Some(attained) = self.attained(sign, parameters).or_else(by_bound) else {
            let lower = if sign > 0.0 { "lower" } else { "larger" };
            let near = match self.has_denominators {
                true => ", or near the zeros of a denominator,",
                false => "",
            };
            let reason = format!(
                "all critical points are known; a {lower} value towards infinity{near} is not excluded"
            );
            return (None, reason);
        };
        let Some(best) = best else {
            return (
                None,
                "there is no real solution: the value would be taken at one".into(),
            );
        };
        let extreme = Extreme {
            value: best.value,
            points: self.near(best).filter(inside).count() as u64,
        };
        let given = match (self.constraints(), self.alternatives().len()) {
            (_, 0) => "equations",
            (0, _) => "conditions",
            _ => "equations and conditions",
        };
        let because = match attained {
            Attained::Bounded => format!("the {given} bound all unknowns"),
            Attained::Grows => format!(
                "the objective grows towards infinity in every direction that the {given} leave"
            ),
            Attained::LowerBound => "no sum of even powers is below it".to_owned(),
        };
        let on_sets = match &self.sets {
            Some(CriticalSets { count: 0, .. }) | None => String::new(),
            Some(CriticalSets { count, .. }) => {
                format!(", also on {count} positive-dimensional sets of critical points")
            }
        };
        let reason =
            format!("the {least} of all critical values{on_sets}, which is taken since {because}");
        (Some(extreme), reason)
    }

    /// The values that may be the same as this one.
    fn near<'a>(&'a self, value: &'a Value) -> impl Iterator<Item = &'a Value> {
        self.values.iter().filter(|other| other.is_near(value))
    }

    fn attained(&self, sign: f64, parameters: &[Complex64]) -> Option<Attained> {
        if self.has_denominators {
            return None;
        }
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
        let equations = &self.system.equations[n..n + self.constraints()];
        let equations: Vec<Polynomial> = equations.iter().filter_map(|e| expand(*e)).collect();
        let inequalities = self.alternatives().iter();
        let inequalities: Vec<Polynomial> =
            inequalities.filter_map(|a| expand(a.expression)).collect();
        let region = Region {
            equations: &equations,
            inequalities: &inequalities,
            parameters,
        };
        attained(&objective, &region, sign)
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
