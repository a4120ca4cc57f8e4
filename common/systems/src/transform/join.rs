//! Join: a system with the equations of another, by the names of their variables.

use super::import_renumbered::import_renumbered;
use crate::expression::NodeId;
use crate::system::{DegenerateSet, System};
use crate::transform::clear_denominators::{ZERO_DENOMINATOR, denominator_factors};
use foldhash::{HashMap, HashMapExt};

/// Reason why two systems cannot be joined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JoinError {
    /// One of the systems has parameters without values.
    #[error("`{0}` is a parameter; expected a system without parameters")]
    Parameter(String),
    /// A variable is in the second system only.
    #[error("`{name}` is no variable of the first system; expected some of {expected}")]
    Variable {
        /// The variable.
        name: String,
        /// Variables of the first system, separated by commas.
        expected: String,
    },
    /// Together they are none, as where an equation is not homogeneous in a homogeneous group.
    #[error("together they are no system: {0}")]
    System(String),
}

/// The variables and groups of the first system with the equations of both, those of the first first. What is attached
/// to the equations of the first, as symmetries, is left out, but denominators of both; its conjugates stay where the second has the same.
pub fn join(first: &System, second: &System) -> Result<System, JoinError> {
    let parameters = first.parameters.iter().chain(&second.parameters);
    if let Some(name) = parameters.into_iter().next() {
        return Err(JoinError::Parameter(name.clone()));
    }
    let place = |name: &String| first.variables.iter().position(|variable| variable == name);
    let mut places = Vec::with_capacity(second.variables.len());
    for name in &second.variables {
        let expected = || first.variables.join(", ");
        places.push(place(name).ok_or_else(|| JoinError::Variable {
            name: name.clone(),
            expected: expected(),
        })?);
    }
    let mut result = System {
        symmetry: Vec::new(),
        helpers: Vec::new(),
        degenerate: Default::default(),
        ..first.clone()
    };
    let mut memory: HashMap<NodeId, NodeId> = HashMap::new();
    for (&equation, name) in second.equations.iter().zip(&second.equation_names) {
        let from = (second, equation);
        let copy = import_renumbered(&mut result.expressions, from, &mut memory, |v| places[v]);
        result.equations.push(copy);
        let mut name = name.clone();
        while result.equation_names.contains(&name) {
            name.push('_');
        }
        result.equation_names.push(name);
    }
    let denominators = [(first, None), (second, Some(&places))];
    for (system, places) in denominators {
        for factor in denominator_factors(system) {
            let copy = match places {
                None => factor,
                Some(places) => {
                    let from = (system, factor);
                    import_renumbered(&mut result.expressions, from, &mut memory, |v| places[v])
                }
            };
            let product = match result.degenerate.get(ZERO_DENOMINATOR) {
                Some(DegenerateSet::Nonzero(others)) => result.expressions.multiply(*others, copy),
                _ => copy,
            };
            let set = DegenerateSet::Nonzero(product);
            result.degenerate.insert(ZERO_DENOMINATOR.into(), set);
        }
    }
    let checked = result.check();
    checked.map_err(|fault| JoinError::System(fault.to_string()))?;
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> System {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        crate::formats::read("test", text.as_bytes())
            .unwrap()
            .system
    }

    #[test]
    fn equations_are_joined_by_names() {
        let first = read("variable_group x, y, z; function f; f = x*y - z;");
        let second = read("variable_group z, x; function f, g; f = z - 1; g = x^2 - z;");
        let both = join(&first, &second).unwrap();
        assert_eq!(both.equation_names, ["f", "f_", "g"]);
        let e = &both.expressions;
        assert_eq!(e.node(both.equations[1]).clone(), {
            let mut expressions = both.expressions.clone();
            let (z, one) = (expressions.variable(2), expressions.integer(1));
            let difference = expressions.subtract(z, one);
            expressions.node(difference).clone()
        });
        let other = read("variable_group x, w; function f; f = x*w - 1;");
        let refused = join(&first, &other).unwrap_err().to_string();
        assert!(
            refused.contains("`w`") && refused.contains("x, y, z"),
            "{refused}"
        );
    }
}
