//! Product: two systems side by side, in variables of their own.

use super::import_renumbered::import_renumbered;
use crate::expression::{Expressions, NodeId};
use crate::system::{System, VariableGroup};
use foldhash::{HashMap, HashMapExt};

/// The equations of both systems, which have no parameters, as one affine group: first `leading_variables` variables
/// of each, then the other variables of the first, then the other variables of the second. A solution of the product is
/// a pair of a solution of the first and one of the second.
///
/// # Panics
/// When one of them has parameters, or fewer variables than `leading_variables`.
pub fn product(first: &System, second: &System, leading_variables: usize) -> System {
    let plain = |s: &System| s.parameters.is_empty() && s.variables.len() >= leading_variables;
    assert!(
        plain(first) && plain(second),
        "no parameters, and variables of each"
    );
    let more = [first, second].map(|system| system.variables.len() - leading_variables);
    let place = |which: usize, v: usize| match v < leading_variables {
        true => which * leading_variables + v,
        false => 2 * leading_variables + which * more[0] + v - leading_variables,
    };
    let mut result = System {
        expressions: Expressions::new(),
        equations: Vec::new(),
        equation_names: Vec::new(),
        variables: vec![String::new(); 2 * leading_variables + more[0] + more[1]],
        groups: Vec::new(),
        conjugates: Vec::new(),
        symmetry: Vec::new(),
        helpers: Vec::new(),
        degenerate: Default::default(),
        ..first.clone()
    };
    for (which, system) in [first, second].into_iter().enumerate() {
        let mut memory: HashMap<NodeId, NodeId> = HashMap::new();
        for (&equation, name) in system.equations.iter().zip(&system.equation_names) {
            let (from, place) = ((system, equation), |v| place(which, v));
            let copy = import_renumbered(&mut result.expressions, from, &mut memory, place);
            result.equations.push(copy);
            // With a colon in it, it is the name of no variable in a file.
            let side = which + 1;
            result.equation_names.push(format!("{side}:{name}"));
        }
        for (v, name) in system.variables.iter().enumerate() {
            result.variables[place(which, v)] = format!("{}:{name}", which + 1);
        }
    }
    result.groups = vec![VariableGroup {
        variables: (0..result.variables.len()).collect(),
        homogeneous: false,
    }];
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_of_both_stand_side_by_side() {
        let read = |text: &[u8]| crate::formats::read("test", text).unwrap().system;
        let first =
            read(b"CONFIG\nEND;\nINPUT\nvariable_group x, y, l; function f; f = x*y - l;\nEND;\n");
        let second = read(
            b"CONFIG\nEND;\nINPUT\nvariable_group x, y; function f, g; f = x^2; g = y;\nEND;\n",
        );
        let both = product(&first, &second, 2);
        assert_eq!(both.check(), Ok(()));
        assert_eq!(both.variables, ["1:x", "1:y", "2:x", "2:y", "1:l"]);
        assert_eq!(both.equation_count(), 3);
    }
}
