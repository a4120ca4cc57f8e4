//! Slices: linear equations beside a system, their coefficients its parameters.
//!
//! The witness points of a set of solutions of dimension m are where it meets m general linear
//! equations. With the coefficients as parameters, moving a slice is a parameter homotopy.

use crate::expression::Expressions;
use crate::system::{System, VariableGroup};

/// The system with `count` linear equations `s_0 + s_1 x_1 + ... + s_n x_n = 0` after its own, in its
/// first `leading_variables` variables; all variables are one affine group. The parameters are the coefficients, slice
/// by slice, the constant first.
///
/// # Panics
/// When the system has parameters or fewer variables than `leading_variables`.
pub fn slice(system: &System, count: usize, leading_variables: usize) -> System {
    assert!(
        system.parameters.is_empty() && leading_variables <= system.variables.len(),
        "slices are the only parameters, in variables that are there"
    );
    let mut sliced = System {
        groups: vec![VariableGroup {
            variables: (0..system.variables.len()).collect(),
            homogeneous: false,
        }],
        conjugates: Vec::new(),
        symmetry: Vec::new(),
        helpers: Vec::new(),
        degenerate: Default::default(),
        ..system.clone()
    };
    for row in 0..count {
        let first = row * (leading_variables + 1);
        let form = form(&mut sliced.expressions, first, leading_variables);
        sliced.equations.push(form);
        sliced.equation_names.push(format!("slice {}", row + 1));
        // With a colon in it, it is the name of no variable in a file.
        let names = (0..=leading_variables).map(|k| format!("slice:{}:{k}", row + 1));
        sliced.parameters.extend(names);
    }
    sliced
}

/// The linear equation in the first variables whose coefficients are the parameters from this one on, the constant first.
pub(super) fn form(
    e: &mut Expressions,
    first: usize,
    leading_variables: usize,
) -> crate::expression::NodeId {
    let index = |k: usize| u32::try_from(k).expect("parameters are counted in 32 bits");
    let mut sum = e.parameter(index(first));
    for v in 0..leading_variables {
        let (coefficient, x) = (e.parameter(index(first + 1 + v)), e.variable(index(v)));
        let term = e.multiply(coefficient, x);
        sum = e.add(sum, term);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_parameters() {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y, z; function f;\
                     f = x*y - z;\nEND;\n";
        let problem = crate::formats::read("test", text);
        let system = problem.expect("a problem of this test").system;
        let sliced = slice(&system, 2, 3);
        assert_eq!(sliced.check(), Ok(()));
        assert_eq!((sliced.equation_count(), sliced.parameters.len()), (3, 8));
    }
}
