//! Reduced: two equations, in the same variables, that are regular along curves on which those that are given need not
//! be.
//!
//! Where the Jacobian has rank 1 on a curve, its minors of size 2 vanish there; all of them follow from those with one
//! entry that is not 0. Where it has rank 0, all derivatives vanish. The minors or derivatives are added as equations
//! until the rank is that of a reduced curve in space, 2. (Hauenstein, Mourrain, Szanto: On deflation and multiplicity
//! structure, J. Symb. Comput. 83, 2017.)

use cognate_continuation::bend::{SlicedEquations, exactly};
use cognate_solutions::witness::WitnessSet;
use cognate_systems::expression::differentiate::gradient;
use cognate_systems::expression::{Dependence, Node, NodeId};
use cognate_systems::polynomial::degrees;
use cognate_systems::system::System;
use cognate_systems::transform::equilibrate;
use num_complex::Complex64;

/// Most times that equations are added.
const MOST_DEFLATIONS: usize = 4;
/// Most equations that are taken.
const MOST_EQUATIONS: usize = 100;
/// Most equations, of least degree, that are tried in pairs.
const MOST_PAIRED: usize = 12;
/// A singular value of the Jacobian, whose rows are at most 1, is 0 below this at a witness point.
const ZERO: f64 = 1e-7;
/// A singular value above this is not 0.
const NONZERO: f64 = 1e-4;

/// Two equations that hold on these curves in space and are regular along them, of the least degrees among those of the
/// system and further ones; `None` where there are none that are regular along all of the curves.
pub(super) fn reduced(system: &System, curves: &[WitnessSet], seed: u64) -> Option<System> {
    let witness_points: Vec<&Vec<Complex64>> =
        curves.iter().filter_map(|c| c.points.first()).collect();
    let mut system = equilibrate(system, seed);
    for _ in 0..=MOST_DEFLATIONS {
        let equations = SlicedEquations::new(&system, Vec::new());
        let ranks = witness_points.iter().map(|point| rank(&equations, point));
        let ranks: Vec<usize> = ranks.collect::<Option<_>>()?;
        let first = *ranks.first()?;
        if ranks.iter().any(|&rank| rank != first) {
            return None;
        }
        let added: Vec<NodeId> = match first {
            0 => partials(&mut system),
            1 => {
                let entry = |point: &&Vec<Complex64>| largest_entry(&equations, point);
                let entries: Vec<_> = witness_points.iter().map(entry).collect();
                let each = entries.into_iter();
                each.flat_map(|entry| minors(&mut system, entry)).collect()
            }
            _ => return Some(two_of(&system, &witness_points).unwrap_or(system)),
        };
        let mut extended = system.equations.clone();
        extended.extend(
            added
                .into_iter()
                .filter(|node| !system.equations.contains(node)),
        );
        let changing =
            |&node: &NodeId| system.expressions.dependence(node) == Dependence::Variables;
        extended.retain(changing);
        if extended.len() > MOST_EQUATIONS {
            return None;
        }
        system = equilibrate(&with_equations(&system, extended), seed);
    }
    None
}

/// The system with other equations in its expressions.
pub(super) fn with_equations(system: &System, equations: Vec<NodeId>) -> System {
    System {
        equation_names: (1..=equations.len()).map(|k| format!("f{k}")).collect(),
        equations,
        symmetry: Vec::new(),
        conjugates: Vec::new(),
        ..system.clone()
    }
}

/// The first two equations, by their degrees, that have rank 2 at all of these points.
fn two_of(system: &System, points: &[&Vec<Complex64>]) -> Option<System> {
    let alone = |&node: &NodeId| with_equations(system, vec![node]);
    let degree = |node: &NodeId| Some(degrees(&alone(node)).ok()?.total[0]);
    let mut by_degree: Vec<(u32, NodeId)> = system
        .equations
        .iter()
        .filter_map(|node| Some((degree(node)?, *node)))
        .collect();
    by_degree.sort_by_key(|(degree, _)| *degree);
    by_degree.truncate(MOST_PAIRED);
    for last in 1..by_degree.len() {
        for first in 0..last {
            let pair = vec![by_degree[first].1, by_degree[last].1];
            let system = with_equations(system, pair);
            let equations = SlicedEquations::new(&system, Vec::new());
            if points
                .iter()
                .all(|point| rank(&equations, point) == Some(2))
            {
                return Some(system);
            }
        }
    }
    None
}

/// The rank of the Jacobian at a witness point; `None` where it is not clear.
fn rank(equations: &SlicedEquations, point: &[Complex64]) -> Option<usize> {
    let point: Vec<_> = point.iter().map(|&z| exactly(z)).collect();
    let values = equations.singular_values(&point);
    let clear = values.iter().all(|&s| !(ZERO..NONZERO).contains(&s));
    clear.then(|| values.iter().filter(|&&s| s >= NONZERO).count())
}

/// Equation and variable of the largest entry of the Jacobian.
fn largest_entry(equations: &SlicedEquations, point: &[Complex64]) -> [usize; 2] {
    let point: Vec<_> = point.iter().map(|&z| exactly(z)).collect();
    let (_, columns) = equations.linear_part(&point, 0);
    let mut largest = (0.0, [0, 0]);
    for (variable, column) in columns.iter().enumerate() {
        for (equation, entry) in column.iter().enumerate() {
            if entry.norm_sqr() > largest.0 {
                largest = (entry.norm_sqr(), [equation, variable]);
            }
        }
    }
    largest.1
}

/// The partial derivatives of an equation that are not 0 everywhere, by variable.
fn derivatives(system: &mut System, equation: usize) -> Vec<Option<NodeId>> {
    let e = &mut system.expressions;
    let mut wanted = |node: &Node| matches!(node, Node::Variable(_));
    let partials = gradient(e, system.equations[equation], &mut wanted);
    let variables = 0..system.variables.len();
    variables
        .map(|v| {
            let leaf = e.variable(v as u32);
            partials.get(&leaf).copied()
        })
        .collect()
}

/// All partial derivatives of all equations.
fn partials(system: &mut System) -> Vec<NodeId> {
    let equations = 0..system.equations.len();
    equations
        .flat_map(|equation| derivatives(system, equation).into_iter().flatten())
        .collect()
}

/// The minors of size 2 of the Jacobian that have an entry, by equation and variable.
fn minors(system: &mut System, [equation, variable]: [usize; 2]) -> Vec<NodeId> {
    let pivot_row = derivatives(system, equation);
    let mut minors = Vec::new();
    for other in (0..system.equations.len()).filter(|&other| other != equation) {
        let row = derivatives(system, other);
        for k in (0..row.len()).filter(|&k| k != variable) {
            let e = &mut system.expressions;
            let mut product = |a: Option<NodeId>, b: Option<NodeId>| match (a, b) {
                (Some(a), Some(b)) => Some(e.multiply(a, b)),
                _ => None,
            };
            let terms = [
                product(pivot_row[variable], row[k]),
                product(pivot_row[k], row[variable]),
            ];
            match terms {
                [Some(a), Some(b)] => minors.push(e.subtract(a, b)),
                [Some(term), None] | [None, Some(term)] => minors.push(term),
                [None, None] => {}
            }
        }
    }
    minors
}
