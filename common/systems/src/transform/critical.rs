//! Critical points of a linear form on the solutions of a system, and its fibres.

use crate::expression::differentiate::directional;
use crate::expression::{Expressions, Node, NodeId};
use crate::system::System;
use cognate_numeric::rational::{ComplexRational, Rational};

/// Most variables of a system of which the critical points of a form are written down: the determinant has a node for
/// each set of columns.
pub const MOST_CRITICAL_VARIABLES: usize = 12;

/// Coefficients of a linear form: integers, real and imaginary part, one for each variable.
pub type IntegerForm = [[i32; 2]];

fn coefficient(e: &mut Expressions, [re, im]: [i32; 2]) -> NodeId {
    e.constant(ComplexRational::new(re, im))
}

fn value_of(e: &mut Expressions, form: &IntegerForm) -> NodeId {
    let mut sum = e.integer(0);
    for (v, &c) in form.iter().enumerate() {
        let (c, x) = (coefficient(e, c), e.variable(v as u32));
        let term = e.multiply(c, x);
        sum = e.add(sum, term);
    }
    sum
}

/// The system, which has an equation fewer than variables, with the determinant of its Jacobian above the form as its
/// last equation: 0 where the form is critical on the solutions, and where they are singular.
///
/// # Panics
/// When the numbers of equations, coefficients and variables do not fit, or there are more than
/// [`MOST_CRITICAL_VARIABLES`].
pub fn critical(system: &System, form: &IntegerForm) -> System {
    let n = system.variables.len();
    assert!(
        system.equations.len() + 1 == n && form.len() == n && n <= MOST_CRITICAL_VARIABLES,
        "a curve, and a form in its variables"
    );
    let mut result = system.clone();
    let e = &mut result.expressions;
    let mut columns = columns_of(e, &system.equations, n);
    for (v, &c) in form.iter().enumerate() {
        let node = (c != [0, 0]).then(|| coefficient(e, c));
        columns[v].push(node);
    }
    let determinant = determinant(e, &columns);
    result.equations.push(determinant);
    result.equation_names.push("critical points".into());
    result
}

/// The Jacobian of these equations in columns, one for each of `n` variables; `None` where an entry is 0.
pub(super) fn columns_of(
    e: &mut Expressions,
    equations: &[NodeId],
    n: usize,
) -> Vec<Vec<Option<NodeId>>> {
    let one = e.integer(1);
    let mut columns = Vec::with_capacity(n);
    for v in 0..n as u32 {
        let mut leaf = |_: &mut Expressions, leaf: &Node| match leaf {
            Node::Variable(variable) => (*variable == v).then_some(one),
            _ => None,
        };
        columns.push(directional(e, equations, &mut leaf));
    }
    columns
}

/// The determinant of a square matrix in columns, by minors of its first rows.
pub(super) fn determinant(e: &mut Expressions, columns: &[Vec<Option<NodeId>>]) -> NodeId {
    let n = columns.len();
    let one = e.integer(1);
    // Minors of the first rows, by sets of columns.
    let mut minors: Vec<Option<NodeId>> = vec![None; 1 << n];
    minors[0] = Some(one);
    for set in 1usize..1 << n {
        let row = set.count_ones() as usize - 1;
        let mut sum: Option<NodeId> = None;
        let mut place = 0;
        for v in 0..n {
            if set >> v & 1 == 0 {
                continue;
            }
            let before = minors[set & !(1 << v)];
            if let (Some(minor), Some(entry)) = (before, columns[v][row]) {
                let term = e.multiply(minor, entry);
                // The sign of the last row's expansion.
                let negative = (row + place) % 2 == 1;
                sum = Some(match (sum, negative) {
                    (None, false) => term,
                    (None, true) => e.negate(term),
                    (Some(sum), false) => e.add(sum, term),
                    (Some(sum), true) => e.subtract(sum, term),
                });
            }
            place += 1;
        }
        minors[set] = sum;
    }
    minors[(1 << n) - 1].unwrap_or_else(|| e.integer(0))
}

/// The system, which has an equation fewer than variables, where the form goes from its first value, at t = 1, to its
/// second, at t = 0.
///
/// # Panics
/// When the numbers of equations, coefficients and variables do not fit, the system has parameters, or a value is not
/// finite.
pub fn fibre(system: &System, form: &IntegerForm, [from, to]: [f64; 2]) -> System {
    let n = system.variables.len();
    assert!(
        system.equations.len() + 1 == n && form.len() == n && system.parameters.is_empty(),
        "a curve, and a form in its variables"
    );
    let exact = |x: f64| Rational::from_f64(x).expect("values of a form on points are finite");
    let mut result = system.clone();
    let e = &mut result.expressions;
    let at = value_of(e, form);
    let (from, to) = (exact(from), exact(to));
    let difference = Rational::from(&from - &to);
    let difference = e.constant(ComplexRational::real(difference));
    let to = e.constant(ComplexRational::real(to));
    let t = e.parameter(0);
    let moved = e.multiply(t, difference);
    let value = e.add(to, moved);
    let equation = e.subtract(at, value);
    result.equations.push(equation);
    result.equation_names.push("fibre".into());
    result.parameters.push("path:t".into());
    result.path_variable = Some(0);
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial::degrees;

    #[test]
    fn the_determinant_has_the_degree_of_the_curve_of_critical_points() {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y, z; function f, g;\
                     f = x^2 + y^2 + z^2 - 4; g = (x - 1)^2 + y^2 - 1;\nEND;\n";
        let system = crate::formats::read("test", text).unwrap().system;
        let made = critical(&system, &[[3, 0], [5, 0], [-7, 0]]);
        assert_eq!(made.check(), Ok(()));
        assert_eq!(degrees(&made).unwrap().total, [2, 2, 2]);
        let moving = fibre(&system, &[[3, 0], [5, 0], [-7, 0]], [0.5, 2.0]);
        assert_eq!(moving.check(), Ok(()));
        assert_eq!(moving.path_variable, Some(0));
    }
}
