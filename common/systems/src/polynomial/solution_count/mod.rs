//! SolutionCount: how many solutions a system has, without following a path.

mod chosen;
pub(super) mod equations;
pub(super) mod groebner;
pub(super) mod monomial;
pub(super) mod nonsingular;
mod not_counted;
pub(super) mod prime_field;
pub(super) mod quotient;
pub(super) mod residue_polynomial;

use super::dual_dimensions::PRIME;
use crate::expression::Node;
use crate::expression::differentiate::below;
use crate::system::System;
use crate::transform::without_linear_unknowns;
pub use chosen::{has_exact_constants, has_many_digits, is_chosen};
use equations::CountedEquations;
use groebner::{Budget, Terms, groebner_basis};
use monomial::{MOST_VARIABLES, Monomial};
use nonsingular::{with_inverse_of_determinant, with_inverses};
pub use not_counted::NotCounted;
use num_complex::Complex64;
use prime_field::PrimeField;
use quotient::Quotient;
use serde::{Deserialize, Serialize};

/// Number of solutions of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SolutionCount {
    /// The solutions are finitely many.
    Finite {
        /// Number of solutions with their multiplicities.
        with_multiplicity: u64,
        /// Number of distinct solutions; `None` where that takes too much to tell.
        distinct: Option<u64>,
    },
    /// The solutions are on sets of this dimension, and perhaps on others.
    Infinite {
        /// Largest dimension of a set.
        dimension: u32,
        /// Number of solutions where the Jacobian is square and has an inverse: points on none of the sets. `None`
        /// where that takes too much to tell.
        nonsingular: Option<u64>,
    },
}

/// The solutions of a system, counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CountedSolutions {
    /// Number of solutions.
    pub count: SolutionCount,
    /// Whether these are the solutions for general values of some numbers in the equations. For the values themselves
    /// there are no more isolated solutions, each with its multiplicity, where all are counted finite.
    pub is_general: bool,
    /// Whether the count is for the very numbers of the equations: only parameters with many digits are general, each
    /// of which has the value of its double.
    pub is_exact: bool,
}

/// Counts the solutions of a system whose parameters have these values, in at most some operations: from a Gröbner
/// basis over a prime field. That is the count over the rationals but for primes that divide one of the numbers
/// on the way, with odds of some 1e-8. Unknowns of large systems that linear equations give are left out. In homogeneous
/// groups points of projective spaces are counted. Points where a denominator of the given equations is 0 are no solutions.
///
/// D. Cox, J. Little, D. O'Shea: Using Algebraic Geometry, 2005, chapters 2 and 4.
pub fn solution_count(
    system: &System,
    parameters: &[Complex64],
    operations: u64,
) -> Result<CountedSolutions, NotCounted> {
    let has_many = system.variable_count() > MOST_VARIABLES;
    let fewer = has_many.then(|| without_linear_unknowns(system)).flatten();
    let counted = CountedEquations::of(fewer.as_ref().unwrap_or(system), parameters)?;
    let is_square = system.equation_count() == system.dimension();
    if !is_square && (counted.is_general || has_rounded_numbers(system)) {
        return Err(NotCounted::NotExact);
    }
    let CountedEquations {
        variables,
        equations,
        denominators,
        conjugates,
        is_general,
        is_exact,
    } = counted;
    let ideal = Ideal {
        variables,
        equations,
        denominators,
    };
    let count = ideal.count(operations).ok_or(NotCounted::Operations)?;
    let count = of_one(count, conjugates).ok_or(NotCounted::Constants)?;
    Ok(CountedSolutions {
        count,
        is_general,
        is_exact,
    })
}

/// Whether the equations have numbers with many digits, which may have been rounded.
pub fn has_rounded_numbers(system: &System) -> bool {
    let nodes = below(&system.expressions, &system.equations);
    nodes
        .into_iter()
        .any(|id| match system.expressions.node(id) {
            Node::Constant(number) => !is_chosen(number),
            _ => false,
        })
}

/// The count of one of several conjugate systems that were counted together.
fn of_one(count: SolutionCount, conjugates: u64) -> Option<SolutionCount> {
    let of_one = |number: u64| {
        number
            .is_multiple_of(conjugates)
            .then(|| number / conjugates)
    };
    Some(match count {
        SolutionCount::Finite {
            with_multiplicity,
            distinct,
        } => SolutionCount::Finite {
            with_multiplicity: of_one(with_multiplicity)?,
            distinct: distinct.and_then(of_one),
        },
        SolutionCount::Infinite {
            dimension,
            nonsingular,
        } => SolutionCount::Infinite {
            dimension,
            nonsingular: nonsingular.and_then(of_one),
        },
    })
}

/// Equations, and polynomials that are 0 at no point that counts.
struct Ideal {
    variables: usize,
    equations: Vec<Terms>,
    denominators: Vec<Terms>,
}

impl Ideal {
    fn count(self, operations: u64) -> Option<SolutionCount> {
        let field = PrimeField::new(PRIME);
        let budget = &mut Budget(operations);
        let equations = self.equations.clone();
        let (variables, equations) =
            with_inverses(PRIME, self.variables, equations, &self.denominators)?;
        let basis = groebner_basis(field, equations, budget)?;
        let dimension = dimension(variables, &basis, budget)?;
        if dimension > 0 {
            let budget = &mut Budget(operations);
            return Some(SolutionCount::Infinite {
                dimension,
                nonsingular: self.nonsingular_points(budget),
            });
        }
        let quotient = Quotient::new(field, variables, &basis, budget)?;
        Some(SolutionCount::Finite {
            with_multiplicity: quotient.dimension() as u64,
            distinct: quotient.distinct_zeros(budget).map(|zeros| zeros as u64),
        })
    }

    fn nonsingular_points(self, budget: &mut Budget) -> Option<u64> {
        let field = PrimeField::new(PRIME);
        let variables = self.variables;
        let equations = with_inverse_of_determinant(variables, self.equations, budget)?;
        let (variables, equations) =
            with_inverses(PRIME, variables + 1, equations, &self.denominators)?;
        let basis = groebner_basis(field, equations, budget)?;
        let quotient = Quotient::new(field, variables, &basis, budget)?;
        Some(quotient.dimension() as u64)
    }
}

/// The most variables of which no leading monomial is a product; 0 also where one is 1.
pub(super) fn dimension(variables: usize, basis: &[Terms], budget: &mut Budget) -> Option<u32> {
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
        let system = read.expect("a problem of this test").system;
        let counted = solution_count(&system, &[], 10_000_000).ok()?;
        assert!(!counted.is_general, "{text}");
        Some(counted.count)
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
        let count = |text: &str| count_of(&format!("variable_group x, y; function f, g; {text}"));
        assert_eq!(count("f = x^2 + y^2 - 5; g = x*y - 2;"), finite(4, 4));
        assert_eq!(count("f = (x - 1)^3*(x + 2); g = y^2 - x;"), finite(8, 4));
        // x^2 + y^2, x^3 (Dayton, Zeng): multiplicity 6.
        assert_eq!(count("f = x^2 + y^2; g = x^3;"), finite(6, 1));
        assert_eq!(count("f = x*y - 1; g = x*y - 2;"), finite(0, 0));
        assert_eq!(count("f = x^2 - I; g = y - I*x;"), finite(2, 2));
        // Two roots 1e-30 apart.
        assert_eq!(
            count("f = (x - 1)*(x - 1 - 1e-30); g = y - 1/3;"),
            finite(2, 2)
        );
        // In units of 1e20.
        assert_eq!(count("f = x^2 - 1e40; g = x*y^2 - 1e-20;"), finite(4, 4));
    }

    #[test]
    fn sets_have_their_dimension() {
        let count = |text: &str| count_of(&format!("variable_group x, y, z; {text}"));
        let line = "function f, g, h; f = x*y; g = x*(y - 1); h = x*z;";
        assert_eq!(count(line), infinite(2, Some(0)));
        let curve = "function f, g, h; f = y - x^2; g = z - x^3; h = x*z - y^2;";
        assert_eq!(count(curve), infinite(1, Some(0)));
    }

    #[test]
    fn nonsingular_points_are_told_from_those_of_sets() {
        let count = |text: &str| count_of(&format!("variable_group x, y; {text}"));
        // A hyperbola, four points of which one is double, and one that is on the hyperbola.
        let text =
            "function f, g; f = (x*y - 1)*(x - 2)*(x + 3); g = (x*y - 1)*(y - 1/2)*(y + 5)^2;";
        assert_eq!(count(text), infinite(1, Some(1)));
        let more = "function f, g, h; f = x*y; g = x*(y - 1); h = x*(x - 1);";
        assert_eq!(count(more), infinite(1, None), "not square");
    }

    #[test]
    fn points_where_a_denominator_is_0_do_not_count() {
        let count = |text: &str| count_of(&format!("variable_group x, y; function f, g; {text}"));
        assert_eq!(
            count("f = x/y + y/x - 5/2; g = 1/x + 1/y - 3/2;"),
            finite(2, 2)
        );
        assert_eq!(count("f = 1/x - 1/y - 1; g = x - y;"), finite(0, 0));
        // Multiplied out, the line x = y.
        let cut = "f = (x^2 - y^2)/(x - y); g = (x - y)*(x^2 + 1)/(x^2 - y^2) - 1/y;";
        assert_eq!(count(cut), finite(0, 0));
        assert_eq!(count("f = (x - 1)*x/x; g = y^2*x;"), finite(2, 1));
        // The axis y = 0, without one point; the other axis is gone.
        let set = "f = x*y/x; g = y*(y - 1)*(x - 2)/x;";
        assert_eq!(count(set), infinite(1, Some(0)));
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

    /// The number of solutions does not change with an equation's factor, with the sign of a square root, or with a
    /// number that fulfils no relation.
    #[test]
    fn irrational_numbers_are_counted_exactly_where_their_relations_are_known() {
        let count = |text: &str| count_of(&format!("variable_group x, y; function f, g; {text}"));
        assert_eq!(count("f = Pi*(x^2 - 2); g = y^2 - x;"), finite(4, 4));
        assert_eq!(
            count("f = x - y - sqrt(2); g = 1e-18*y^3 - x^2 + 2;"),
            finite(3, 3)
        );
        // With sqrt(2) a double solution, and with sqrt(2), sqrt(3) two.
        assert_eq!(count("f = x^2 - 2*sqrt(2)*x + 2; g = y - x;"), finite(2, 1));
        let two = "f = x^2 - 2*sqrt(2)*x + 2; g = (y - x/sqrt(3))^2;";
        assert_eq!(count(two), finite(4, 1));
        assert_eq!(
            count("f = x^2 + y^2 - 1; g = x*sin(1) - y*cos(1);"),
            finite(2, 2)
        );
        assert_eq!(count("f = x^2 - Pi; g = x*y - 1/Pi;"), finite(2, 2));
    }

    #[test]
    fn general_values_are_said_to_be_general() {
        let general = |text: &str, parameters: &[Complex64]| {
            let read = crate::formats::read("test", text.as_bytes());
            let system = read.expect("a problem of this test").system;
            solution_count(&system, parameters, 10_000_000)
        };
        let counted = |with_multiplicity, distinct, is_general| {
            let count = finite(with_multiplicity, distinct).unwrap();
            Ok(CountedSolutions {
                count,
                is_general,
                is_exact: true,
            })
        };
        // sqrt(8) is twice sqrt(2).
        let text = "variable_group x; function f; f = (x - sqrt(8))*(x - 2*sqrt(2));";
        let of_others = counted(2, 2, true).map(|counted| CountedSolutions {
            is_exact: false,
            ..counted
        });
        assert_eq!(general(text, &[]), of_others);
        let text = r#"{"variables": ["x"], "parameters": ["p"], "equations": ["x^2 - p*x + 1"]}"#;
        let value = |p| [Complex64::new(p, 0.0)];
        assert_eq!(general(text, &value(2.0)), counted(2, 1, false));
        assert_eq!(general(text, &value(0.1)), counted(2, 2, true));
        assert_eq!(general(text, &[]), Err(NotCounted::Parameters));
        let more = "variable_group x; function f, g; f = x - sin(1); g = x - sin(2);";
        assert_eq!(general(more, &[]), Err(NotCounted::NotExact));
        let rounded = "variable_group x; function f, g; f = x - 0.333333333333; g = 3*x - 1;";
        assert_eq!(general(rounded, &[]), Err(NotCounted::NotExact));
    }

    /// Points of a projective space, each once.
    #[test]
    fn homogeneous_groups_have_points_of_projective_spaces() {
        let count = |text: &str| count_of(&format!("hom_variable_group x, y, w; {text}"));
        let fat = "function f, g, h; f = x^2; g = x*y; h = y^2;";
        assert_eq!(count(fat), finite(3, 1));
        let conics = "function f, g; f = x^2 + y^2 - 5*w^2; g = x*y - 2*w^2;";
        assert_eq!(count(conics), finite(4, 4));
    }

    #[test]
    fn what_takes_too_much_is_not_known() {
        let text = "variable_group x; function f; f = x^40000 - 1;";
        assert_eq!(count_of(text), None, "a degree too high");
    }
}
