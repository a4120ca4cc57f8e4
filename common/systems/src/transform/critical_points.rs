//! Critical points of an expression on the solutions of a system, with multipliers in a projective space.
//!
//! At a critical point x of f on g = 0 the gradients of f and of the equations are dependent:
//! l0 grad f = l1 grad g1 + ... + lm grad gm with (l0 : ... : lm) in projective space (Fritz John). Nothing runs to
//! infinity where the equations are singular: these points have l0 = 0, and are among the solutions.

use crate::expression::differentiate::gradient;
use crate::expression::{Node, NodeId};
use crate::polynomial::{PolynomialError, degrees};
use crate::system::{System, VariableGroup};
use crate::transform::clear_denominators::clear_denominators;
use cognate_numeric::rational::ComplexRational;
use std::collections::BTreeMap;

/// The system of the critical points of `objective` where each of `inequalities` is at least 0; all are expressions in the
/// graph of `system`. First comes the gradient, an equation for each variable, then the equations of `system`, then the
/// product of each inequality with its multiplier. The multipliers follow the variables: that of the objective, those of
/// the equations, those of the inequalities. Without equations and inequalities there is none, unless a derivative is a
/// constant: no value of the multiplier then solves the equations.
pub fn critical_points(system: &System, objective: NodeId, inequalities: &[NodeId]) -> System {
    let multipliers = match system.equations.len() + inequalities.len() {
        0 => 0,
        count => count + 1,
    };
    let made = with_multipliers(system, objective, inequalities, multipliers);
    if multipliers > 0 {
        return made;
    }
    let mut cleared = made.clone();
    clear_denominators(&mut cleared);
    match degrees(&cleared) {
        Err(PolynomialError::Constant(_)) => with_multipliers(system, objective, inequalities, 1),
        _ => made,
    }
}

/// Adds `weight` times half of the squared distance to `centre` to the objective of a system of critical points. The centre
/// has a coordinate for each unknown; the variables after them are multipliers.
pub fn add_squared_distance(
    system: &mut System,
    centre: &[ComplexRational],
    weight: &ComplexRational,
) {
    let unknowns = centre.len();
    let e = &mut system.expressions;
    let weight = e.constant(weight.clone());
    let factor = if system.variables.len() > unknowns {
        let multiplier = e.variable(unknowns as u32);
        e.multiply(multiplier, weight)
    } else {
        weight
    };
    for (v, coordinate) in centre.iter().enumerate() {
        let (variable, coordinate) = (e.variable(v as u32), e.constant(coordinate.clone()));
        let difference = e.subtract(variable, coordinate);
        let term = e.multiply(factor, difference);
        system.equations[v] = e.add(system.equations[v], term);
    }
}

/// Takes the objective of a system of critical points out: its derivatives by each of the first variables.
pub fn subtract_objective(system: &mut System, objective: NodeId, unknowns: usize) {
    let e = &mut system.expressions;
    let is_variable = &mut |node: &Node| matches!(node, Node::Variable(_));
    let derivatives = gradient(e, objective, is_variable);
    let multiplier = (system.variables.len() > unknowns).then(|| e.variable(unknowns as u32));
    for v in 0..unknowns {
        let variable = e.variable(v as u32);
        let Some(&derivative) = derivatives.get(&variable) else {
            continue;
        };
        let term = multiplier.map_or(derivative, |factor| e.multiply(factor, derivative));
        system.equations[v] = e.subtract(system.equations[v], term);
    }
}

/// The system of the critical points with this number of multipliers.
fn with_multipliers(
    system: &System,
    objective: NodeId,
    inequalities: &[NodeId],
    multipliers: usize,
) -> System {
    let n = system.variables.len();
    let equations = system.equations.len();
    let constraints = [&system.equations, inequalities].concat();
    let mut result = System {
        equations: Vec::new(),
        equation_names: Vec::new(),
        conjugates: Vec::new(),
        symmetry: Vec::new(),
        ..system.clone()
    };
    let mut names: Vec<String> = Vec::new();
    for number in 0..multipliers {
        let mut name = format!("multiplier_{number}");
        while system.variables.contains(&name) || system.parameters.contains(&name) {
            name.push('_');
        }
        names.push(name);
    }
    result.variables.extend(names);
    if multipliers > 0 {
        result.groups.push(VariableGroup {
            variables: (n..n + multipliers).collect(),
            homogeneous: true,
        });
    }
    let e = &mut result.expressions;
    let is_variable = &mut |node: &Node| matches!(node, Node::Variable(_));
    let roots = std::iter::once(objective).chain(constraints.iter().copied());
    let gradients: Vec<BTreeMap<NodeId, NodeId>> =
        roots.map(|root| gradient(e, root, is_variable)).collect();
    for v in 0..n {
        let variable = e.variable(v as u32);
        let mut sum = e.integer(0);
        for (k, derivatives) in gradients.iter().enumerate() {
            let Some(&derivative) = derivatives.get(&variable) else {
                continue;
            };
            if multipliers == 0 {
                sum = derivative;
                continue;
            }
            let multiplier = e.variable((n + k) as u32);
            let term = e.multiply(multiplier, derivative);
            sum = match k {
                0 => e.add(sum, term),
                _ => e.subtract(sum, term),
            };
        }
        result.equations.push(sum);
        result
            .equation_names
            .push(format!("gradient in {}", system.variables[v]));
    }
    result.equations.extend(&constraints[..equations]);
    result
        .equation_names
        .extend(system.equation_names.iter().cloned());
    for (number, &inequality) in inequalities.iter().enumerate() {
        let e = &mut result.expressions;
        let multiplier = e.variable((n + 1 + equations + number) as u32);
        result.equations.push(e.multiply(multiplier, inequality));
        result
            .equation_names
            .push(format!("alternative {}", number + 1));
    }
    result
}
