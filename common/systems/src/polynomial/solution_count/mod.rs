//! SolutionCount: how many solutions a system has, without following a path.

mod groebner;
mod monomial;
mod nonsingular;
mod quotient;

use super::Polynomial;
use super::dual_dimensions::FIELD;
use crate::expression::NodeId;
use crate::system::System;
use crate::transform::clear_denominators::denominator_factors;
use groebner::{Budget, Terms, groebner_basis};
use monomial::{MOST_VARIABLES, Monomial};
use nonsingular::{with_inverse_of_determinant, with_inverses};
use quotient::Quotient;
use serde::{Deserialize, Serialize};

/// How many solutions a system has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SolutionCount {
    /// Finitely many.
    Finite {
        /// With their multiplicities.
        with_multiplicity: u64,
        /// Each once; not known where that takes too much to tell.
        distinct: Option<u64>,
    },
    /// On sets of this dimension, and perhaps others.
    Infinite {
        /// The largest of any set.
        dimension: u32,
        /// Where the Jacobian is square and has an inverse: points on none of the sets. Not known where that takes
        /// too much to tell.
        nonsingular: Option<u64>,
    },
}

/// Counts the solutions of a system of affine groups without parameters, in at most some operations: from a Gröbner
/// basis over a prime field. That is the count over the rationals but for primes that divide one of the numbers
/// on the way, with odds of some 1e-8. `None` where it takes more, or equations are no polynomials with
/// rational coefficients. Points where a denominator of the given equations is 0 are no solutions.
///
/// D. Cox, J. Little, D. O'Shea: Using Algebraic Geometry, 2005, chapters 2 and 4.
pub fn solution_count(system: &System, operations: u64) -> Option<SolutionCount> {
    let variables = system.variable_count();
    let affine = system.groups.iter().all(|group| !group.homogeneous);
    if !affine || !system.parameters.is_empty() || variables > MOST_VARIABLES {
        return None;
    }
    let residues = |equation: &NodeId| -> Option<Terms> {
        let polynomial = Polynomial::expand(&system.expressions, *equation, variables, 0)?;
        let terms = polynomial.terms.iter();
        let terms =
            terms.map(|(exponents, c)| Some((Monomial::new(exponents)?, FIELD.complex(c)?)));
        let mut terms = terms.collect::<Option<Terms>>()?;
        terms.retain(|&(_, c)| c != 0);
        terms.sort_unstable_by_key(|&(monomial, _)| std::cmp::Reverse(monomial));
        Some(terms)
    };
    let equations: Option<Vec<Terms>> = system.equations.iter().map(residues).collect();
    let denominators = denominator_factors(system);
    let denominators: Option<Vec<Terms>> = denominators.iter().map(residues).collect();
    let ideal = Ideal {
        variables,
        equations: equations?,
        denominators: denominators?,
    };
    ideal.count(operations)
}

/// Equations, and polynomials that are 0 at no point that counts.
struct Ideal {
    variables: usize,
    equations: Vec<Terms>,
    denominators: Vec<Terms>,
}

impl Ideal {
    fn count(self, operations: u64) -> Option<SolutionCount> {
        let budget = &mut Budget(operations);
        let equations = self.equations.clone();
        let (variables, equations) = with_inverses(self.variables, equations, &self.denominators)?;
        let basis = groebner_basis(equations, budget)?;
        let dimension = dimension(variables, &basis, budget)?;
        if dimension > 0 {
            let budget = &mut Budget(operations);
            return Some(SolutionCount::Infinite {
                dimension,
                nonsingular: self.nonsingular_points(budget),
            });
        }
        let quotient = Quotient::new(variables, &basis, budget)?;
        Some(SolutionCount::Finite {
            with_multiplicity: quotient.dimension() as u64,
            distinct: quotient.distinct_zeros(budget).map(|zeros| zeros as u64),
        })
    }

    fn nonsingular_points(self, budget: &mut Budget) -> Option<u64> {
        let variables = self.variables;
        let equations = with_inverse_of_determinant(variables, self.equations, budget)?;
        let (variables, equations) = with_inverses(variables + 1, equations, &self.denominators)?;
        let basis = groebner_basis(equations, budget)?;
        let quotient = Quotient::new(variables, &basis, budget)?;
        Some(quotient.dimension() as u64)
    }
}

/// The most variables of which no leading monomial is a product; 0 also where one is 1.
fn dimension(variables: usize, basis: &[Terms], budget: &mut Budget) -> Option<u32> {
    budget.take(basis.len() << variables)?;
    let occurring = |lead: &Monomial| -> u32 {
        let bits = (0..variables).map(|k| u32::from(lead.exponent(variables, k) > 0) << k);
        bits.sum()
    };
    let leads: Vec<u32> = basis.iter().map(|terms| occurring(&terms[0].0)).collect();
    let free = |&chosen: &u32| leads.iter().all(|lead| lead & !chosen != 0);
    let sizes = (0..1u32 << variables).filter(free).map(u32::count_ones);
    Some(sizes.max().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count_of(text: &str) -> Option<SolutionCount> {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        let read = crate::formats::read("test", text.as_bytes());
        solution_count(&read.expect("a problem of this test").system, 10_000_000)
    }

    fn finite(with_multiplicity: u64, distinct: u64) -> Option<SolutionCount> {
        Some(SolutionCount::Finite {
            with_multiplicity,
            distinct: Some(distinct),
        })
    }

    fn infinite(dimension: u32, nonsingular: Option<u64>) -> Option<SolutionCount> {
        Some(SolutionCount::Infinite {
            dimension,
            nonsingular,
        })
    }

    #[test]
    fn points_are_counted_with_and_without_multiplicities() {
        let of = |text: &str| count_of(&format!("variable_group x, y; function f, g; {text}"));
        assert_eq!(of("f = x^2 + y^2 - 5; g = x*y - 2;"), finite(4, 4));
        assert_eq!(of("f = (x - 1)^3*(x + 2); g = y^2 - x;"), finite(8, 4));
        // x^2 + y^2, x^3 (Dayton, Zeng): multiplicity 6.
        assert_eq!(of("f = x^2 + y^2; g = x^3;"), finite(6, 1));
        assert_eq!(of("f = x*y - 1; g = x*y - 2;"), finite(0, 0));
        assert_eq!(of("f = x^2 - I; g = y - I*x;"), finite(2, 2));
        // Two roots 1e-30 apart.
        assert_eq!(
            of("f = (x - 1)*(x - 1 - 1e-30); g = y - 1/3;"),
            finite(2, 2)
        );
        // In units of 1e20.
        assert_eq!(of("f = x^2 - 1e40; g = x*y^2 - 1e-20;"), finite(4, 4));
    }

    #[test]
    fn sets_have_their_dimension() {
        let of = |text: &str| count_of(&format!("variable_group x, y, z; {text}"));
        let line = "function f, g, h; f = x*y; g = x*(y - 1); h = x*z;";
        assert_eq!(of(line), infinite(2, Some(0)));
        let curve = "function f, g, h; f = y - x^2; g = z - x^3; h = x*z - y^2;";
        assert_eq!(of(curve), infinite(1, Some(0)));
    }

    #[test]
    fn nonsingular_points_are_told_from_those_of_sets() {
        let of = |text: &str| count_of(&format!("variable_group x, y; {text}"));
        // A hyperbola, four points of which one is double, and one that is on the hyperbola.
        let text =
            "function f, g; f = (x*y - 1)*(x - 2)*(x + 3); g = (x*y - 1)*(y - 1/2)*(y + 5)^2;";
        assert_eq!(of(text), infinite(1, Some(1)));
        let more = "function f, g, h; f = x*y; g = x*(y - 1); h = x*(x - 1);";
        assert_eq!(of(more), infinite(1, None), "not square");
    }

    #[test]
    fn points_where_a_denominator_is_0_do_not_count() {
        let of = |text: &str| count_of(&format!("variable_group x, y; function f, g; {text}"));
        assert_eq!(
            of("f = x/y + y/x - 5/2; g = 1/x + 1/y - 3/2;"),
            finite(2, 2)
        );
        assert_eq!(of("f = 1/x - 1/y - 1; g = x - y;"), finite(0, 0));
        // Multiplied out, the line x = y.
        let cut = "f = (x^2 - y^2)/(x - y); g = (x - y)*(x^2 + 1)/(x^2 - y^2) - 1/y;";
        assert_eq!(of(cut), finite(0, 0));
        assert_eq!(of("f = (x - 1)*x/x; g = y^2*x;"), finite(2, 1));
        // The axis y = 0, without one point; the other axis is gone.
        let set = "f = x*y/x; g = y*(y - 1)*(x - 2)/x;";
        assert_eq!(of(set), infinite(1, Some(0)));
    }

    /// G. Björck, 1985; J. Backelin, R. Fröberg, 1991; S. Katsura, 1986.
    #[test]
    fn known_counts() {
        let cyclic_5 = "variable_group a, b, c, d, e; function f1, f2, f3, f4, f5; f1 = a + b + c + d + e; \
             f2 = a*b + b*c + c*d + d*e + e*a; f3 = a*b*c + b*c*d + c*d*e + d*e*a + e*a*b; \
             f4 = a*b*c*d + b*c*d*e + c*d*e*a + d*e*a*b + e*a*b*c; f5 = a*b*c*d*e - 1;";
        assert_eq!(count_of(cyclic_5), finite(70, 70));
        let cyclic_4 = "variable_group a, b, c, d; function f1, f2, f3, f4; f1 = a + b + c + d; \
             f2 = a*b + b*c + c*d + d*a; f3 = a*b*c + b*c*d + c*d*a + d*a*b; f4 = a*b*c*d - 1;";
        let curves = infinite(1, Some(0));
        assert_eq!(count_of(cyclic_4), curves);
        let katsura_3 = "variable_group x, y, z, w; function f1, f2, f3, f4; \
             f1 = x + 2*y + 2*z + 2*w - 1; f2 = x^2 + 2*y^2 + 2*z^2 + 2*w^2 - x; \
             f3 = 2*x*y + 2*y*z + 2*z*w - y; f4 = y^2 + 2*x*z + 2*y*w - z;";
        assert_eq!(count_of(katsura_3), finite(8, 8));
    }

    #[test]
    fn what_takes_too_much_is_not_known() {
        let text = "variable_group x; function f; f = x^200 - 1;";
        assert_eq!(count_of(text), None, "a degree too high");
        let text = "variable_group x; function f; f = x^2 - cos(1);";
        assert_eq!(count_of(text), None, "no polynomial");
    }
}
