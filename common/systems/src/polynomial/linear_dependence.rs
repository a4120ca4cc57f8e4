//! Linear dependence of equations: which of them are sums of multiples of others.

use super::Polynomial;
use crate::system::System;
use cognate_numeric::rational::ComplexRational;
use std::collections::BTreeMap;

/// Indices of equations, ascending, of which none is a linear combination of those before it and all others are: they have
/// the solutions of all. Equations that cannot be multiplied out are kept.
pub fn independent_equations(system: &System) -> Vec<usize> {
    let (variables, parameters) = (system.variables.len(), system.parameters.len());
    // Each row begins with a term that no row after it has.
    let mut rows: Vec<BTreeMap<Vec<u32>, ComplexRational>> = Vec::new();
    let is_independent = |index: &usize| {
        let equation = system.equations[*index];
        let expanded = Polynomial::expand(&system.expressions, equation, variables, parameters);
        let Some(Polynomial { mut terms, .. }) = expanded else {
            return true;
        };
        for row in &rows {
            subtract_multiple(&mut terms, row);
        }
        let is_zero = terms.is_empty();
        if !is_zero {
            rows.push(terms);
        }
        !is_zero
    };
    (0..system.equations.len()).filter(is_independent).collect()
}

impl Polynomial {
    /// Whether this is another polynomial times a positive number; false for 0.
    pub fn is_positive_multiple_of(&self, other: &Self) -> bool {
        let factor = self
            .terms
            .first_key_value()
            .zip(other.terms.first_key_value());
        let factor = factor.and_then(|((_, a), (_, b))| a.divide(b));
        let Some(factor) = factor.filter(|factor| factor.is_real() && factor.re > 0) else {
            return false;
        };
        let mut pairs = self.terms.iter().zip(&other.terms);
        self.terms.len() == other.terms.len()
            && pairs
                .all(|((monomial, a), (other, b))| monomial == other && *a == factor.multiply(b))
    }
}

/// Subtracts the multiple of a row that has the same coefficient of the row's first term.
fn subtract_multiple(
    terms: &mut BTreeMap<Vec<u32>, ComplexRational>,
    row: &BTreeMap<Vec<u32>, ComplexRational>,
) {
    let Some((first, leading)) = row.first_key_value() else {
        return;
    };
    let coefficient = terms.get(first).cloned();
    let Some(factor) = coefficient.and_then(|coefficient| coefficient.divide(leading)) else {
        return;
    };
    for (monomial, coefficient) in row {
        let entry = terms.entry(monomial.clone()).or_default();
        *entry = entry.subtract(&factor.multiply(coefficient));
        if entry.is_zero() {
            terms.remove(monomial);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::read;

    #[track_caller]
    fn check(equations: &str, independent: &[usize]) {
        let problem = read("equations", equations.as_bytes()).expect("the equations are read");
        assert_eq!(independent_equations(&problem.system), independent);
    }

    #[test]
    fn multiples_and_sums_are_dependent() {
        check("x^2 + y^2 = 1\n2*x^2 + 2*y^2 = 2", &[0]);
        check("x + y + z = 1\nx - y = 0\n2*x + z = 1", &[0, 1]);
        check("x*y = 1\n(x + 1)*(y - 1) = 1\ny - x = 1", &[0, 1]);
        check("x^2 + y^2 = 1\n2*x^2 + 2*y^2 = 2.0000001", &[0, 1]);
        check("parameters: a\na*x = y\na^2*x = a*y", &[0, 1]);
    }
}
