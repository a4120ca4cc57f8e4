//! A system whose parameters have become numbers.

use crate::expression::differentiate::below;
use crate::expression::{Expressions, Node, NodeId, exact};
use crate::helper_unknown::Helper;
use crate::system::{SymmetryGenerator, System};
use cognate_numeric::counted::counted;
use cognate_numeric::rational::ComplexRational;
use foldhash::{HashMap, HashMapExt};

/// Reason why parameters cannot have these values.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FixError {
    /// Too few or too many.
    #[error(
        "the system has {}, but {} given",
        counted(*.expected, "parameter"),
        match .found {
            1 => "1 value was".to_owned(),
            n => format!("{n} values were"),
        }
    )]
    Count {
        /// Number of parameters of the system.
        expected: usize,
        /// Number of values that were given.
        found: usize,
    },
    /// A denominator becomes 0.
    #[error("a denominator in equation `{0}` is 0 at these values of the parameters")]
    ZeroDenominator(String),
}

/// Substitutes exact values for all parameters; everything else stays.
pub fn fix_parameters(system: &System, values: &[ComplexRational]) -> Result<System, FixError> {
    if values.len() != system.parameters.len() {
        return Err(FixError::Count {
            expected: system.parameters.len(),
            found: values.len(),
        });
    }
    let mut fixed = Fixed {
        from: &system.expressions,
        to: Expressions::new(),
        memory: HashMap::new(),
        values,
    };
    let mut equations = Vec::new();
    for (i, &equation) in system.equations.iter().enumerate() {
        let name = || {
            system
                .equation_names
                .get(i)
                .cloned()
                .unwrap_or_else(|| format!("equation {}", i + 1))
        };
        equations.push(fixed.copy(equation, &name)?);
    }
    let mut degenerate = system.degenerate.clone();
    for (name, set) in &mut degenerate {
        for node in set.nodes_mut() {
            *node = fixed.copy(*node, &|| name.clone())?;
        }
    }
    let mut symmetry = system.symmetry.clone();
    for generator in &mut symmetry {
        if let SymmetryGenerator::Map(nodes) = generator {
            for node in nodes {
                *node = fixed.copy(*node, &|| "symmetry".into())?;
            }
        }
    }
    let mut helpers = system.helpers.clone();
    for helper in &mut helpers {
        if let Helper::Root(root) = helper {
            root.radicand = fixed.copy(root.radicand, &|| "a radicand".into())?;
        }
    }
    Ok(System {
        helpers,
        expressions: fixed.to,
        equations,
        degenerate,
        symmetry,
        parameters: Vec::new(),
        path_variable: None,
        ..system.clone()
    })
}

struct Fixed<'a> {
    from: &'a Expressions,
    to: Expressions,
    memory: HashMap<NodeId, NodeId>,
    values: &'a [ComplexRational],
}

impl Fixed<'_> {
    fn copy(&mut self, root: NodeId, name: &dyn Fn() -> String) -> Result<NodeId, FixError> {
        let denominators: Vec<NodeId> = below(self.from, &[root])
            .into_iter()
            .filter_map(|id| match self.from.node(id) {
                Node::Divide(_, b) => Some(*b),
                _ => None,
            })
            .collect();
        // A denominator with variables has no value here and is kept.
        let zero = exact::values(self.from, &denominators, &[], self.values)
            .iter()
            .flatten()
            .any(ComplexRational::is_zero);
        if zero {
            return Err(FixError::ZeroDenominator(name()));
        }
        let values = self.values;
        Ok(self.to.import(
            self.from,
            root,
            &mut self.memory,
            &mut |to, leaf| match leaf {
                Node::Parameter(p) => to.constant(values[*p as usize].clone()),
                other => to.insert(other.clone()),
            },
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quotient() -> System {
        let mut e = Expressions::new();
        let (x, p, q) = (e.variable(0), e.parameter(0), e.parameter(1));
        let difference = e.subtract(p, q);
        let quotient = e.divide(x, difference);
        let equation = e.add(quotient, p);
        System {
            expressions: e,
            variables: vec!["x".into()],
            parameters: vec!["p".into(), "q".into()],
            equations: vec![equation],
            ..System::default()
        }
    }

    #[test]
    fn values_take_the_place_of_parameters() {
        let values = [3, 1].map(ComplexRational::real);
        let fixed = fix_parameters(&quotient(), &values).expect("3 - 1 is not 0");
        assert!(fixed.parameters.is_empty());
        // x/2 + 3 vanishes at -6.
        let at = exact::value(
            &fixed.expressions,
            fixed.equations[0],
            &[ComplexRational::real(-6)],
            &[],
        );
        assert_eq!(at, Some(ComplexRational::default()));
    }

    #[test]
    fn a_denominator_that_becomes_zero_is_refused() {
        let values = [2, 2].map(ComplexRational::real);
        assert_eq!(
            fix_parameters(&quotient(), &values),
            Err(FixError::ZeroDenominator("equation 1".into()))
        );
        assert!(matches!(
            fix_parameters(&quotient(), &values[..1]),
            Err(FixError::Count {
                expected: 2,
                found: 1
            })
        ));
    }
}
