//! The systems of curves on a surface in space: where two linear forms are critical, and where it is singular.

use crate::decomposition::problem::Problem;
use crate::degrees_or_bounds::degrees_or_bounds;
use cognate_systems::expression::Node;
use cognate_systems::expression::differentiate::gradient;
use cognate_systems::system::System;
use cognate_systems::transform::{combine, critical};

/// A combination of the equations that the surface is cut out by.
fn combined(problem: &Problem) -> System {
    let degrees = degrees_or_bounds(&problem.given);
    let degrees = degrees.expect("equations of a problem have degrees");
    let mut made = combine(&problem.given, &degrees, 1, problem.seed());
    made.symmetry.clear();
    made.conjugates.clear();
    made.degenerate.clear();
    made
}

/// All equations, and others in the same expressions.
fn with_others(problem: &Problem, made: System, count: usize) -> System {
    let others = made.equations[made.equations.len() - count..].to_vec();
    let mut equations = problem.given.equations.clone();
    equations.extend(others);
    System {
        equation_names: (1..=equations.len()).map(|k| format!("f{k}")).collect(),
        equations,
        ..made
    }
}

/// System of the outline of the surface on the plane of the forms: both forms are critical together.
pub(super) fn outline(problem: &Problem, forms: &[Vec<[i32; 2]>; 2]) -> System {
    let mut made = combined(problem);
    let e = &mut made.expressions;
    let mut sum = e.integer(0);
    for (v, c) in (0..).zip(&forms[0]) {
        let (c, x) = (e.integer(i64::from(c[0])), e.variable(v));
        let term = e.multiply(c, x);
        sum = e.add(sum, term);
    }
    made.equations.push(sum);
    made.equation_names.push("form".into());
    with_others(problem, critical(&made, &forms[1]), 1)
}

/// Where the surface is singular. Where a denominator of the given equations is 0 it has no solutions.
pub(super) fn singular_solutions(problem: &Problem) -> System {
    System {
        degenerate: problem.given.degenerate.clone(),
        ..singular(problem)
    }
}

/// Where the surface is singular.
pub(super) fn singular(problem: &Problem) -> System {
    let mut made = combined(problem);
    let root = made.equations[0];
    let e = &mut made.expressions;
    let mut wanted = |node: &Node| matches!(node, Node::Variable(_));
    let partials: Vec<_> = gradient(e, root, &mut wanted).into_values().collect();
    let count = partials.len();
    made.equations.extend(partials);
    with_others(problem, made, count)
}
