//! Product to equation: a set of solutions, cut by an equation that a product of linear forms becomes.
//!
//! Forms and slices are in the first variables only: other unknowns, as the multipliers of a deflation, are functions
//! of these on the set, and would raise its degree.

use super::import_renumbered::import_renumbered;
use super::slice::{form, slice};
use crate::expression::NodeId;
use crate::system::System;
use foldhash::{HashMap, HashMapExt};

/// The equations of `rows`, then those of another system in the first of its variables.
///
/// # Panics
/// When one of the systems has parameters, or `more` has more variables than `rows`.
pub fn append(rows: &System, more: &System) -> System {
    let plain = rows.parameters.is_empty() && more.parameters.is_empty();
    assert!(
        plain && more.variables.len() <= rows.variables.len(),
        "no parameters, and variables that are there"
    );
    let mut result = rows.clone();
    let mut memory: HashMap<NodeId, NodeId> = HashMap::new();
    for &equation in &more.equations {
        let out = &mut result.expressions;
        let copy = import_renumbered(out, (more, equation), &mut memory, |v| v);
        result.equations.push(copy);
        let number = result.equations.len();
        // With a colon in it, it is the name of no variable in a file.
        result.equation_names.push(format!("appended:{number}"));
    }
    result
}

/// A system whose last equation g becomes the last row u g + v p = 0, with the product p of `forms` linear forms, after
/// `slices` linear equations; forms and slices in the first `leading_variables` variables. All variables are one
/// affine group. The parameters are the coefficients of the slices, slice by slice, the constant first; u; v; and the
/// coefficients of the forms likewise.
///
/// # Panics
/// When the system has parameters, no equation, or fewer variables than `leading_variables`.
pub fn product_to_equation(
    system: &System,
    [forms, slices]: [usize; 2],
    leading_variables: usize,
) -> System {
    let mut rows = system.clone();
    let last = rows.equations.pop().expect("an equation cuts");
    rows.equation_names.pop();
    let mut result = slice(&rows, slices, leading_variables);
    let u = result.parameters.len();
    let e = &mut result.expressions;
    let index = |k: usize| u32::try_from(k).expect("parameters are counted in 32 bits");
    let mut product = e.parameter(index(u + 1));
    for number in 0..forms {
        let factor = form(
            e,
            u + 2 + number * (leading_variables + 1),
            leading_variables,
        );
        product = e.multiply(product, factor);
    }
    let scale = e.parameter(index(u));
    let equation = e.multiply(scale, last);
    let moving = e.add(equation, product);
    result.equations.push(moving);
    result.equation_names.push("cut".into());
    // With a colon in them, they are names of no variables in a file.
    let blend = ["cut:equation".to_string(), "cut:product".to_string()];
    result.parameters.extend(blend);
    for number in 1..=forms {
        let names = (0..=leading_variables).map(|k| format!("form:{number}:{k}"));
        result.parameters.extend(names);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial::degrees;

    #[test]
    fn product_and_equation_have_one_degree() {
        let read = |text: &str| {
            let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
            let problem = crate::formats::read("test", text.as_bytes());
            problem.expect("a problem of this test").system
        };
        let rows = read("variable_group x, y, z, l; function f, g; f = z^2; g = 2*z*l - 1;");
        let by = read("variable_group x, y, z; function h, k; h = x - y; k = x^3 - y*z;");
        let cut = product_to_equation(&append(&rows, &by), [3, 1], 3);
        assert_eq!(cut.check(), Ok(()));
        assert_eq!(cut.parameters.len(), 4 + 2 + 3 * 4);
        assert_eq!(degrees(&cut).unwrap().total, [2, 2, 1, 1, 3]);
    }
}
