//! Why the monomials of a system are not at hand, for starts that are made of them.

use cognate_systems::expression::Node;
use cognate_systems::polynomial::degrees_by_form;
use cognate_systems::system::System;

/// Why the monomials of a system are not known: the equation that may have the most of them, by its
/// form. A system whose equations share subexpressions is solved without its monomials.
pub(crate) fn not_multiplied_out(system: &System) -> String {
    let variables_of_system: Vec<usize> = (0..system.variable_count()).collect();
    let sizes = system.equations.iter().enumerate().map(|(i, &equation)| {
        let degrees = degrees_by_form(&system.expressions, equation, &variables_of_system);
        let nodes = degrees.keys().map(|&id| system.expressions.node(id));
        let variables = nodes
            .filter(|node| matches!(node, Node::Variable(_)))
            .count();
        let degree = degrees[&equation];
        // Monomials of at most this degree: (n + d) over n.
        let terms = (1..=variables).try_fold(1u128, |product, k| {
            let next = product.checked_mul(u128::from(degree) + k as u128)?;
            Some(next / k as u128).filter(|&terms| terms <= MANY_TERMS)
        });
        (terms.unwrap_or(MANY_TERMS), i, degree, variables)
    });
    let Some((terms, i, degree, variables)) =
        sizes.max_by_key(|&(terms, i, ..)| (terms, usize::MAX - i))
    else {
        return "there are no equations".into();
    };
    let name = match system.equation_names.get(i) {
        Some(name) if !name.is_empty() => format!("equation {name}"),
        _ => format!("equation {}", i + 1),
    };
    let terms = match terms {
        MANY_TERMS => "more than 10^12".into(),
        terms => format!("up to {terms}"),
    };
    format!(
        "the equations are not multiplied out: {name}, of degree {degree} in {variables} variables, may \
         have {terms} terms"
    )
}

/// Numbers of terms are not told beyond.
const MANY_TERMS: u128 = 1_000_000_000_000;
