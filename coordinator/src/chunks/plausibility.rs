//! Plausibility: whether reported ends of paths solve the equations, by one evaluation each.
//!
//! A worker computes wrongly, or lies: what it says of an end costs one evaluation to look at, a
//! thousandth of what the path cost. Nothing is decided by it but whether somebody else does the chunk,
//! too: the bounds are wide, and an end that cannot be looked at counts as plausible.

use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::work::{Stage, Work};
use cognate_solutions::point_shape::modulus;
use cognate_systems::evaluation;
use cognate_systems::expression::{Dependence, Node, NodeId};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Ends are taken to be no better than this, relative to the largest coordinate.
const LEAST_ERROR: f64 = 1e-6;
/// An equation does not hold where its value is more than this part of the sum of its terms. Ends that
/// are right have some 1e-6 of it, random points about all of it.
const DOUBTFUL: f64 = 1e-2;
/// Homogenising coordinates below this are too near to infinity for the affine equations.
const NEAR_INFINITY: f64 = 1e-6;

/// The equations at the end of a stage's paths.
#[derive(Clone, Debug)]
pub struct EndCheck {
    system: System,
    /// Operations of all nodes of the system's expressions.
    operations: Vec<Operation>,
    /// Number of coordinates of an end.
    coordinates: usize,
}

impl EndCheck {
    /// For a stage of this system; `None` where its paths do not end at solutions of the system, or
    /// at those of combinations of its equations.
    pub fn of(system: &System, stage: &Stage) -> Option<Self> {
        let square = system.equation_count() == system.dimension();
        if stage.work != Work::Track || !stage.homotopy.ends_at_the_system() || !square {
            return None;
        }
        if stage.homotopy.parameter_sets() != 1 {
            return None;
        }
        let ends = stage.homotopy.end_parameters(0, system.path_variable)?;
        let mut parameters = ends.into_owned();
        parameters.resize(system.parameters.len(), Complex64::ZERO);
        let coordinates = system.groups.iter();
        let coordinates =
            coordinates.map(|group| group.variables.len() + usize::from(!group.homogeneous));
        let coordinates = coordinates.sum();
        let system = system.in_unknowns().into_owned();
        Some(Self {
            coordinates,
            operations: operations(&system, &parameters),
            system,
        })
    }

    /// Doubts about the results that cannot be right, in the order of the results.
    pub fn doubts(&self, results: &[ItemResult]) -> Vec<Doubt> {
        let doubts = results.iter().enumerate().filter_map(|(place, result)| {
            let path = result.path()?;
            let why = self.doubt_of(path)?;
            Some(Doubt {
                place,
                why: format!("path {}: {why}", path.origin.0),
            })
        });
        doubts.collect()
    }

    fn doubt_of(&self, path: &PathResult) -> Option<String> {
        if !matches!(path.outcome, PathOutcome::Regular | PathOutcome::Singular) {
            return None;
        }
        let end = path.endpoint.to_double();
        if end.len() != self.coordinates {
            return Some(format!(
                "its end has {} coordinates; expected {}",
                end.len(),
                self.coordinates
            ));
        }
        let error = (10.0 * path.accuracy).clamp(LEAST_ERROR, 1.0);
        let (point, errors) = self.affine(end, error)?;
        let worst = self.worst_equation(&point, &errors)?;
        (worst.1 > DOUBTFUL).then(|| {
            format!(
                "equation {} does not hold at its end: its value is {:.0e} of the sum of its terms",
                worst.0 + 1,
                worst.1
            )
        })
    }

    /// Values of the unknowns and their errors; `None` near infinity.
    fn affine(&self, end: &[Complex64], error: f64) -> Option<(Vec<Complex64>, Vec<f64>)> {
        let n = self.system.variable_count();
        let (mut point, mut errors) = (vec![Complex64::ZERO; n], vec![0.0; n]);
        let mut rest = end;
        for group in &self.system.groups {
            let scale = match group.homogeneous {
                true => Complex64::ONE,
                false => {
                    let (first, others) = rest.split_first()?;
                    rest = others;
                    *first
                }
            };
            let (group_coordinates, others) = rest.split_at_checked(group.variables.len())?;
            rest = others;
            let largest = group_coordinates
                .iter()
                .map(|c| modulus(*c))
                .fold(modulus(scale), f64::max);
            // A comparison that a NaN fails.
            if !(modulus(scale) > NEAR_INFINITY * largest && largest.is_finite()) {
                return None;
            }
            for (&v, c) in group.variables.iter().zip(group_coordinates) {
                point[v] = c / scale;
                errors[v] = error * largest / modulus(scale);
            }
        }
        Some((point, errors))
    }

    /// The equation with the largest value, relative to the sum of the moduli of its terms.
    fn worst_equation(&self, point: &[Complex64], errors: &[f64]) -> Option<(usize, f64)> {
        // Of each node the value, and the sum of the moduli of the terms that it has written out.
        let mut nodes: Vec<(Complex64, f64)> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            nodes.push(match *operation {
                Operation::Fixed(value) => (value, modulus(value)),
                Operation::Variable(v) => (point[v], modulus(point[v]) + errors[v]),
                Operation::Add(a, b) => (nodes[a].0 + nodes[b].0, nodes[a].1 + nodes[b].1),
                Operation::Subtract(a, b) => (nodes[a].0 - nodes[b].0, nodes[a].1 + nodes[b].1),
                Operation::Multiply(a, b) => (nodes[a].0 * nodes[b].0, nodes[a].1 * nodes[b].1),
                Operation::Divide(a, b) => {
                    (nodes[a].0 / nodes[b].0, nodes[a].1 / modulus(nodes[b].0))
                }
                Operation::Negate(a) => (-nodes[a].0, nodes[a].1),
                Operation::Power(a, exponent) => {
                    let (value, size) = nodes[a];
                    let whole = i32::try_from(exponent).unwrap_or(i32::MAX);
                    (value.powu(exponent), size.powi(whole))
                }
            });
        }
        let ratios = self.system.equations.iter().enumerate().map(|(i, id)| {
            let (value, size) = nodes[id.0 as usize];
            (
                i,
                if size > 0.0 {
                    modulus(value) / size
                } else {
                    0.0
                },
            )
        });
        // Equations whose values overflow are left out.
        ratios
            .filter(|(_, ratio)| ratio.is_finite())
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// A result that cannot be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    /// Index of the result among the results of its report.
    pub place: usize,
    /// Reason why the result cannot be right.
    pub why: String,
}

impl Doubt {
    /// Doubt about a result that the check of its kind of work does not confirm.
    pub fn not_confirmed(place: usize, result: &ItemResult) -> Self {
        let origin = result.origin().0;
        let why = match result {
            ItemResult::Track(_) => {
                format!("path {origin}: Newton's method is not at rest at its end")
            }
            ItemResult::Certify(_) => format!("point {origin}: its certificate is another one"),
            _ => format!("item {origin}: another result was found here"),
        };
        Self { place, why }
    }
}

/// Whether a result is an end of a path that is no regular finite solution. A worker that makes such an end up takes a
/// solution away, and no evaluation shows that. A path that failed has no end: it is tracked again, or the answer
/// says so.
pub fn is_nonregular_end(result: &ItemResult) -> bool {
    let Some(path) = result.path() else {
        return false;
    };
    match path.outcome {
        PathOutcome::Diverging | PathOutcome::Singular | PathOutcome::PutAside => true,
        PathOutcome::Regular | PathOutcome::Failed(_) => false,
    }
}

/// Operation at one node of the expressions, with the indices of its operands.
#[derive(Clone, Copy, Debug)]
enum Operation {
    /// Value that depends on no variable.
    Fixed(Complex64),
    Variable(usize),
    Add(usize, usize),
    Subtract(usize, usize),
    Multiply(usize, usize),
    Divide(usize, usize),
    Negate(usize),
    Power(usize, u32),
}

/// All nodes of a system's expressions, operands before what they are operands of.
fn operations(system: &System, parameters: &[Complex64]) -> Vec<Operation> {
    let expressions = &system.expressions;
    let ids = (0..expressions.nodes().len() as u32).map(NodeId);
    let is_fixed = |id: &NodeId| expressions.dependence(*id) != Dependence::Variables;
    let fixed: Vec<NodeId> = ids.clone().filter(is_fixed).collect();
    let mut values = evaluation::values(expressions, &fixed, &[], parameters).into_iter();
    let place = |id: &NodeId| id.0 as usize;
    ids.map(|id| match expressions.node(id) {
        _ if is_fixed(&id) => Operation::Fixed(values.next().unwrap_or_default()),
        Node::Variable(v) => Operation::Variable(*v as usize),
        Node::Add(a, b) => Operation::Add(place(a), place(b)),
        Node::Subtract(a, b) => Operation::Subtract(place(a), place(b)),
        Node::Multiply(a, b) => Operation::Multiply(place(a), place(b)),
        Node::Divide(a, b) => Operation::Divide(place(a), place(b)),
        Node::Negate(a) => Operation::Negate(place(a)),
        Node::Power(a, exponent) => Operation::Power(place(a), *exponent),
        Node::Constant(_) | Node::Parameter(_) | Node::Root(..) | Node::Function(..) => {
            unreachable!("these depend on no variable")
        }
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::path_result::Coordinates;
    use cognate_continuation::prepared_work::PreparedWork;
    use cognate_numeric::random::{Purpose, RandomStream};
    use cognate_systems::named;

    fn stage_of(system: &System) -> (System, Stage) {
        let plan = cognate_algorithms::plan::plan(system, &Default::default()).unwrap();
        let mut algorithm = plan.algorithm.clone();
        let cognate_algorithms::Next::Open(opening) =
            cognate_algorithms::PathAlgorithm::next(&mut algorithm)
        else {
            panic!("a plan begins with a stage");
        };
        (plan.system, opening.stage.clone())
    }

    #[test]
    fn right_ends_are_plausible_and_random_ones_are_not() {
        for system in [
            named::katsura(4).system,
            named::noon(3).system,
            named::cyclic(5).system,
        ] {
            let (system, mut stage) = stage_of(&system);
            if stage.work != Work::Track || !stage.homotopy.ends_at_the_system() {
                let start = cognate_algorithms::plan::SolveOptions {
                    method: cognate_algorithms::plan::SolveMethod::TotalDegree,
                    ..Default::default()
                };
                let plan = cognate_algorithms::plan::plan(&system, &start).unwrap();
                let mut algorithm = plan.algorithm.clone();
                if let cognate_algorithms::Next::Open(opening) =
                    cognate_algorithms::PathAlgorithm::next(&mut algorithm)
                {
                    stage = opening.stage.clone();
                }
            }
            let check = EndCheck::of(&system, &stage).unwrap();
            let prepared = PreparedWork::new(&system, &stage, &|_| None).unwrap();
            let results = prepared.run(0..prepared.items(), 8);
            assert!(check.doubts(&results).is_empty());
            let (mut doubted_ends, mut regular) = (0, 0);
            for (k, result) in results.iter().enumerate() {
                let ItemResult::Track(path) = result else {
                    panic!("paths are tracked");
                };
                if path.outcome != PathOutcome::Regular {
                    continue;
                }
                regular += 1;
                let mut wrong = path.clone();
                let mut stream = RandomStream::new(k as u64, Purpose::Test, 0);
                let mut part = || stream.below(2001) as f64 / 1000.0 - 1.0;
                let end: Vec<Complex64> = (0..check.coordinates)
                    .map(|_| Complex64::new(part(), part()))
                    .collect();
                wrong.endpoint = Coordinates::Double(end.clone());
                let doubts = check.doubts(&[ItemResult::Track(wrong.clone())]);
                doubted_ends += u32::from(!doubts.is_empty());
                wrong.endpoint = Coordinates::Double(end[1..].to_vec());
                let doubts = check.doubts(&[ItemResult::Track(wrong)]);
                assert!(doubts[0].why.contains("coordinates"));
            }
            assert!(
                regular > 0 && doubted_ends * 10 >= regular * 9,
                "{doubted_ends} of {regular}"
            );
        }
    }
}
