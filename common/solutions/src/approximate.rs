//! Approximate: points of least residual of equations that have no common solution.
//!
//! Strict local minima of the sum of the squares of the equations, in real unknowns: damped Newton steps (Marquardt 1963) with
//! the exact second derivatives of the sum, from ends of paths that solve only combinations of the equations.

use crate::classification::{Decision, Verdict};
use crate::point_shape::PointShape;
use crate::solution::NamedValues;
use crate::summary::SolutionCounts;
use cognate_continuation::path_result::PathResult;
use cognate_numeric::counted::counted;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::symmetric_eigenvalues::symmetric_eigenvalues;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Complex;
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use cognate_systems::expression::Node;
use cognate_systems::expression::differentiate::gradient;
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::denominator_factors;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Most starts from which minima are looked for, those of the least sums: each takes some hundred evaluations.
const MOST_STARTS: usize = 10_000;
/// Most steps from one start.
const MOST_STEPS: usize = 200;
/// Damping of the first step, relative to the squares of the derivatives.
const FIRST_DAMPING: f64 = 1e-3;
/// Damping above which a step is too small to help.
const MOST_DAMPING: f64 = 1e12;
/// Damping below which a step is one of Newton's.
const LEAST_DAMPING: f64 = 1e-9;
/// A step that would lower the residual by less than this part of it, squared, is the last one.
const CONVERGED: f64 = 1e-7;
/// Error of the residual by rounding, relative to the terms of the equations.
const ROUNDING: f64 = 1e-13;
/// Two points are one where the second derivatives say that the residual between them differs by less than this part.
const SAME: f64 = 1e-6;
/// An eigenvalue of the second derivatives counts as 0 below this part of the largest.
const ZERO_EIGENVALUE: f64 = 1e-8;

/// A point at which the residual of the equations is least among the points near it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ApproximatePoint {
    /// Values of the variables, which are real.
    pub variables: NamedValues,
    /// Square root of the sum of the squares of the equations as they were given.
    pub residual: f64,
    /// Paths from the ends of which the point was reached, ascending.
    pub paths: Vec<u64>,
}

/// Points of least residual, the least first, and why there may be others.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Approximate {
    /// The points; none of them is a solution.
    pub points: Vec<ApproximatePoint>,
    /// Reason why there is no point, or why there may be more.
    pub reason: Option<String>,
}

/// Ends of paths that solve only combinations of the equations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExcessEnds {
    parameters: Vec<Complex64>,
    ends: Vec<ExcessEnd>,
}

/// The end of a path that solves only combinations of the equations.
#[derive(Clone, Debug, PartialEq)]
struct ExcessEnd {
    path: u64,
    values: Vec<Complex64>,
}

impl ExcessEnds {
    /// The excess ends among these.
    pub fn of(
        results: &[PathResult],
        decisions: &[Decision],
        shape: &PointShape,
        parameters: &[Complex64],
    ) -> Self {
        let is_excess = |decision: &Decision| decision.verdict == Verdict::ExcessSolution;
        let ends = results.iter().zip(decisions);
        let ends = ends.filter(|(_, decision)| is_excess(decision));
        let points = ends.map(|(result, _)| (result.origin.0, result.endpoint.to_double()));
        let held = points.filter(|(_, point)| shape.holds(point));
        let named = held.map(|(path, point)| ExcessEnd {
            path,
            values: shape.to_variables(point),
        });
        Self {
            parameters: parameters.to_vec(),
            ends: named.collect(),
        }
    }
}

/// The points of least residual that are reached from excess ends; `counts` are those of the solutions.
pub fn approximate(excess: &ExcessEnds, counts: &SolutionCounts, system: &System) -> Approximate {
    if let Some(reason) = refusal(excess, counts, system) {
        return Approximate {
            points: Vec::new(),
            reason: Some(reason),
        };
    }
    let mut sum = SumOfSquares::new(system, &excess.parameters);
    let mut starts: Vec<Start> = Vec::new();
    for end in &excess.ends {
        let real: Vec<f64> = end.values.iter().map(|z| z.re).collect();
        // From a point that symmetry makes a saddle no step leads away.
        let beside: Vec<f64> = end.values.iter().map(|z| z.re + z.im).collect();
        let points = [real, beside].into_iter();
        starts.extend(points.map(|point| Start {
            path: end.path,
            sum: sum.value(&point),
            point,
        }));
    }
    starts.retain(|start| start.sum.is_finite());
    starts.sort_by(|a, b| a.sum.total_cmp(&b.sum).then(a.path.cmp(&b.path)));
    let left_out = starts.len().saturating_sub(MOST_STARTS);
    starts.truncate(MOST_STARTS);
    let mut minima: Vec<Minimum> = Vec::new();
    for start in starts {
        let Some(mut minimum) = sum.minimum(start.point) else {
            continue;
        };
        match minima.iter_mut().find(|other| other.is(&minimum)) {
            Some(other) => other.paths.push(start.path),
            None => {
                minimum.paths.push(start.path);
                minima.push(minimum);
            }
        }
    }
    let reason = match (minima.is_empty(), left_out) {
        (true, _) => Some("the steps from the excess ends reach no strict local minimum".into()),
        (false, 0) => None,
        (false, more) => Some(format!("{} left out", counted(more as u64, "start"))),
    };
    minima.sort_by(|a, b| a.sum.total_cmp(&b.sum));
    Approximate {
        points: minima
            .into_iter()
            .map(|minimum| minimum.named(system))
            .collect(),
        reason,
    }
}

/// Reason why there are no points of least residual besides the solutions, or why they are not computed.
fn refusal(excess: &ExcessEnds, counts: &SolutionCounts, system: &System) -> Option<String> {
    let is_solved =
        counts.distinct + counts.undecided > 0 || counts.positive_dimensional == Some(true);
    let reason = if system.equation_count() <= system.dimension() {
        "there are no more equations than unknowns"
    } else if is_solved {
        "the equations have common solutions"
    } else if !system.helpers.is_empty() {
        "functions of unknowns are not in this version"
    } else if !denominator_factors(system).is_empty() {
        "unknowns in denominators are not in this version"
    } else if system.groups.iter().any(|group| group.homogeneous) {
        "homogeneous groups have no residual"
    } else if !is_real(system, &excess.parameters) {
        "the equations are not real in real unknowns"
    } else if excess.ends.is_empty() {
        "no path has an excess end"
    } else {
        return None;
    };
    Some(reason.to_owned())
}

/// Whether the equations have real values at real points, which a random one shows.
fn is_real(system: &System, parameters: &[Complex64]) -> bool {
    let (n, count) = (system.variables.len(), system.parameters.len());
    let graph = &system.expressions;
    let compiled = Interpreter::compile_in_one_way(graph, &system.equations, n, count);
    let mut random = RandomStream::new(0, Purpose::Probe, 1);
    let point: Vec<Complex<f64>> = (0..n).map(|_| real(random.uniform() + 0.5)).collect();
    let parameters: Vec<Complex<f64>> = parameters.iter().map(to_complex).collect();
    let mut out = Matrix::zeros((), system.equations.len(), n + 2);
    let mut scratch = compiled.scratch(());
    compiled.jacobian(&point, &parameters, &mut out, &mut scratch);
    let is_real = |i: usize| {
        let row = (0..=n).map(|j| out.at(i, j));
        let largest = row.clone().map(|z| z.re.abs()).fold(0.0, f64::max);
        row.into_iter().all(|z| z.im.abs() <= ROUNDING * largest)
    };
    system.conjugates.is_empty() && (0..system.equations.len()).all(is_real)
}

/// A point from which steps begin.
struct Start {
    path: u64,
    sum: f64,
    point: Vec<f64>,
}

/// A strict local minimum of the sum of squares.
struct Minimum {
    point: Vec<f64>,
    sum: f64,
    /// Half the second derivatives.
    second: Vec<Vec<f64>>,
    /// Sum that rounding makes of 0.
    rounding: f64,
    paths: Vec<u64>,
}

impl Minimum {
    /// Whether another minimum is this one.
    fn is(&self, other: &Self) -> bool {
        let pairs = self.point.iter().zip(&other.point);
        let difference: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
        let rows = self.second.iter().zip(&difference);
        let between: f64 = rows.map(|(row, d)| d * dot(row, &difference)).sum();
        between <= SAME * SAME * self.sum + self.rounding
    }

    fn named(mut self, system: &System) -> ApproximatePoint {
        self.paths.sort_unstable();
        self.paths.dedup();
        let values = self.point.into_iter().map(|x| Complex64::new(x, 0.0));
        ApproximatePoint {
            variables: system.variables.iter().cloned().zip(values).collect(),
            residual: self.sum.sqrt(),
            paths: self.paths,
        }
    }
}

/// A program with its work space.
struct Program {
    interpreter: Interpreter,
    scratch: Scratch<f64>,
}

impl Program {
    fn new(interpreter: Interpreter) -> Self {
        Self {
            scratch: interpreter.scratch(()),
            interpreter,
        }
    }

    /// The derivatives, and after them the value, of each expression.
    fn rows(&mut self, point: &[Complex<f64>], parameters: &[Complex<f64>]) -> Vec<Vec<f64>> {
        let (count, n) = (self.interpreter.shape().equations, point.len());
        let mut out = Matrix::zeros((), count, n + 2);
        self.interpreter
            .jacobian(point, parameters, &mut out, &mut self.scratch);
        let row = |i: usize| (0..=n).map(|j| out.at(i, j).re).collect();
        (0..count).map(row).collect()
    }
}

/// The sum of the squares of equations.
struct SumOfSquares {
    equations: Program,
    gradient: Program,
    parameters: Vec<Complex<f64>>,
}

/// Value and derivatives of the sum of squares at a point.
struct Derivatives {
    sum: f64,
    /// Half the gradient.
    gradient: Vec<f64>,
    /// Half the second derivatives.
    second: Vec<Vec<f64>>,
    /// For each unknown the sum of the squares of the equations' derivatives.
    squares: Vec<f64>,
    /// Sum that rounding makes of 0.
    rounding: f64,
}

impl SumOfSquares {
    fn new(system: &System, parameters: &[Complex64]) -> Self {
        let (n, count) = (system.variables.len(), system.parameters.len());
        let mut graph = system.expressions.clone();
        let mut sum = graph.integer(0);
        for &equation in &system.equations {
            let square = graph.multiply(equation, equation);
            sum = graph.add(sum, square);
        }
        let is_variable = &mut |node: &Node| matches!(node, Node::Variable(_));
        let derivatives = gradient(&mut graph, sum, is_variable);
        let zero = graph.integer(0);
        let gradient: Vec<_> = (0..n)
            .map(|v| graph.variable(v as u32))
            .map(|variable| derivatives.get(&variable).copied().unwrap_or(zero))
            .collect();
        let compiled = |roots| Interpreter::compile_in_one_way(&graph, roots, n, count);
        Self {
            equations: Program::new(compiled(&system.equations)),
            gradient: Program::new(compiled(&gradient)),
            parameters: parameters.iter().map(to_complex).collect(),
        }
    }

    fn value(&mut self, point: &[f64]) -> f64 {
        let point: Vec<Complex<f64>> = point.iter().map(|&x| real(x)).collect();
        let count = self.equations.interpreter.shape().equations;
        let mut values = vec![Complex::zero(()); count];
        let Program {
            interpreter,
            scratch,
        } = &mut self.equations;
        interpreter.value(&point, &self.parameters, &mut values, scratch);
        values.iter().map(|f| f.re * f.re).sum()
    }

    fn derivatives(&mut self, point: &[f64]) -> Derivatives {
        let complex: Vec<Complex<f64>> = point.iter().map(|&x| real(x)).collect();
        let rows = self.equations.rows(&complex, &self.parameters);
        let n = point.len();
        let terms = |row: &Vec<f64>| -> f64 {
            let of_unknowns: f64 = row.iter().zip(point).map(|(d, x)| (d * x).abs()).sum();
            of_unknowns + row[n].abs()
        };
        let largest = rows.iter().map(terms).fold(0.0, f64::max);
        let halves = self.gradient.rows(&complex, &self.parameters);
        let half = |row: &[f64]| row.iter().map(|x| 0.5 * x).collect();
        Derivatives {
            sum: rows.iter().map(|row| row[n] * row[n]).sum(),
            gradient: halves.iter().map(|row| 0.5 * row[n]).collect(),
            second: halves.iter().map(|row| half(&row[..n])).collect(),
            squares: (0..n)
                .map(|j| rows.iter().map(|row| row[j] * row[j]).sum())
                .collect(),
            rounding: (ROUNDING * largest) * (ROUNDING * largest),
        }
    }

    /// The strict local minimum to which steps lead from a point; `None` where they lead to none.
    fn minimum(&mut self, mut point: Vec<f64>) -> Option<Minimum> {
        let mut damping = FIRST_DAMPING;
        for _ in 0..MOST_STEPS {
            let at = self.derivatives(&point);
            if let Some(step) = at.step(0.0) {
                let decrease = dot(&step, &at.gradient);
                if decrease <= CONVERGED * CONVERGED * at.sum + at.rounding {
                    let point = minus(&point, &step);
                    return self.derivatives(&point).strict_minimum(point);
                }
            }
            loop {
                let next = at.step(damping).map(|step| minus(&point, &step));
                if let Some(next) = next.filter(|next| self.value(next) < at.sum) {
                    point = next;
                    break;
                }
                damping = damping.max(LEAST_DAMPING) * 4.0;
                if damping > MOST_DAMPING {
                    return None;
                }
            }
            damping = if damping < LEAST_DAMPING {
                0.0
            } else {
                0.2 * damping
            };
        }
        None
    }
}

impl Derivatives {
    /// The damped step against the gradient, by Cholesky's factors; `None` where the damped second derivatives are not
    /// positive definite.
    fn step(&self, damping: f64) -> Option<Vec<f64>> {
        let n = self.gradient.len();
        let mut factor = vec![vec![0.0; n]; n];
        for i in 0..n {
            for j in 0..=i {
                let product = dot(&factor[i][..j], &factor[j][..j]);
                if i == j {
                    let entry = self.second[i][i] + damping * self.squares[i];
                    let rest = entry - product;
                    if rest.is_nan() || rest <= f64::EPSILON * entry.abs() {
                        return None;
                    }
                    factor[i][i] = rest.sqrt();
                } else {
                    factor[i][j] = (self.second[i][j] - product) / factor[j][j];
                }
            }
        }
        let mut step = self.gradient.clone();
        for i in 0..n {
            step[i] = (step[i] - dot(&factor[i][..i], &step[..i])) / factor[i][i];
        }
        for i in (0..n).rev() {
            let above: f64 = (i + 1..n).map(|k| factor[k][i] * step[k]).sum();
            step[i] = (step[i] - above) / factor[i][i];
        }
        step.iter().all(|x| x.is_finite()).then_some(step)
    }

    /// The minimum at this point, where the second derivatives, in units that make their diagonal 1, say that it is one.
    fn strict_minimum(self, point: Vec<f64>) -> Option<Minimum> {
        let unit: Vec<f64> = (0..point.len())
            .map(|k| self.second[k][k].abs().sqrt())
            .collect();
        let scaled = |(i, row): (usize, &Vec<f64>)| -> Vec<f64> {
            let entries = row.iter().zip(&unit);
            entries.map(|(entry, u)| entry / (u * unit[i])).collect()
        };
        let rows: Vec<Vec<f64>> = self.second.iter().enumerate().map(scaled).collect();
        let is_finite = rows.iter().flatten().all(|entry| entry.is_finite());
        let is_strict = is_finite && {
            let eigenvalues = symmetric_eigenvalues(&rows);
            let ends = eigenvalues.first().zip(eigenvalues.last());
            ends.is_some_and(|(least, largest)| *least > ZERO_EIGENVALUE * largest)
        };
        is_strict.then_some(Minimum {
            point,
            sum: self.sum,
            second: self.second,
            rounding: self.rounding,
            paths: Vec::new(),
        })
    }
}

fn real(x: f64) -> Complex<f64> {
    Complex { re: x, im: 0.0 }
}

fn to_complex(z: &Complex64) -> Complex<f64> {
    Complex { re: z.re, im: z.im }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::formats;

    /// The points that are reached from ends with these values.
    fn reached(equations: &str, ends: &[&[(f64, f64)]]) -> Approximate {
        let problem = formats::read("test", equations.as_bytes()).expect("a problem of this test");
        let end = |(path, values): (usize, &&[(f64, f64)])| ExcessEnd {
            path: path as u64,
            values: values
                .iter()
                .map(|&(re, im)| Complex64::new(re, im))
                .collect(),
        };
        let excess = ExcessEnds {
            parameters: Vec::new(),
            ends: ends.iter().enumerate().map(end).collect(),
        };
        approximate(&excess, &SolutionCounts::default(), &problem.system)
    }

    /// Values, residual and paths of the only point.
    fn only(approximate: &Approximate) -> (Vec<f64>, f64, &[u64]) {
        let [point] = approximate.points.as_slice() else {
            panic!("{approximate:?}");
        };
        let values = point.variables.values().map(|z| z.re).collect();
        (values, point.residual, &point.paths)
    }

    #[test]
    fn between_two_parallels_and_in_a_triangle() {
        let middle = reached("x = 0; x = 1", &[&[(0.3, 0.8)], &[(9.0, 0.0)]]);
        let (values, residual, paths) = only(&middle);
        assert!((values[0] - 0.5).abs() < 1e-15 && (residual - 0.5f64.sqrt()).abs() < 1e-15);
        assert_eq!((paths, &middle.reason), (&[0u64, 1][..], &None));
        // Normal equations 2 x = 1, 2 y = 1: residuals 1/2, 1/2 and 1/2 of lines through a right angle and its opposite.
        let triangle = reached("x = 0; y = 0; x + y = 1.5", &[&[(0.1, 0.0), (0.9, 0.0)]]);
        let (values, residual, _) = only(&triangle);
        assert!(values.iter().all(|x| (x - 0.5).abs() < 1e-15), "{values:?}");
        assert!((residual - 0.75f64.sqrt()).abs() < 1e-15);
    }

    /// (x^2 - 2)^2 + (x - 0.1)^2 has derivative 4 x^3 - 6 x - 0.2: minima near 1.24 and -1.21, a maximum between.
    #[test]
    fn two_minima_and_none_at_a_maximum() {
        let ends: [&[(f64, f64)]; 3] = [&[(1.4, 0.1)], &[(-1.4, 0.0)], &[(1.3, -0.2)]];
        let both = reached("x^2 = 2; x = 0.1", &ends);
        let points: Vec<f64> = both
            .points
            .iter()
            .map(|p| p.variables.0[0].value.re)
            .collect();
        assert!((points[0] - 1.241_083_2).abs() < 1e-6, "{points:?}");
        assert!((points[1] + 1.207_725_1).abs() < 1e-6, "{points:?}");
        for (point, paths) in both.points.iter().zip([&[0u64, 2][..], &[1]]) {
            let x = point.variables.0[0].value.re;
            assert!((4.0 * x * x * x - 6.0 * x - 0.2).abs() < 1e-12, "{x}");
            assert_eq!(point.paths, paths);
        }
        assert!(both.points[0].residual < both.points[1].residual);
        // From the maximum of x^4 - 4 x^2 + ... itself nothing is reached, from beside it both minima are.
        let even = "x^2 = 2; x^2 = 2.1";
        assert_eq!(reached(even, &[&[(0.0, 0.0)]]).points, []);
        assert_eq!(only(&reached(even, &[&[(0.0, 0.3)]])).0, [2.05f64.sqrt()]);
    }

    #[test]
    fn a_curve_of_least_residual_is_no_point_and_reasons_are_named() {
        let said = |equations: &str| {
            let approximate = reached(equations, &[&[(0.6, 0.1), (0.3, 0.2)]]);
            assert_eq!(approximate.points, [], "{equations}");
            approximate.reason.expect("a reason")
        };
        let circles = "x^2 + y^2 = 1; x^2 + y^2 = 1.1; 2*x^2 + 2*y^2 = 2.3";
        assert!(said(circles).contains("no strict local minimum"));
        assert!(said("x = 1; y = 2").contains("no more equations than unknowns"));
        assert!(said("x = 1; y = 2; x + I*y = 3").contains("not real"));
        assert!(said("x = 1; y = 2; 1/x + y = 3").contains("denominators"));
        assert!(said("x = 1; y = 2; sqrt(x) + y = 4").contains("functions"));
    }
}
