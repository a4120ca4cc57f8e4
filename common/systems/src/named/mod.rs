//! Classical test systems by name, each with its published root count and source.

mod benchmarks;
mod nine_point;
mod singular;

pub use benchmarks::{cyclic, eco, katsura, noon, reimer};
pub use nine_point::{
    FourBar, NINE_POINT_SOLUTIONS, nine_point, nine_point_with_rotations, random_four_bar,
    rotations,
};
pub use singular::{caprasse, griewank_osborne, hyperbola_in_a_plane, kss, ojika_1};

use crate::expression::{Expressions, NodeId};
use crate::system::{System, VariableGroup};
use cognate_numeric::rational::{ComplexRational, Rational};

/// A system with its known answer.
#[derive(Clone, Debug)]
pub struct Named {
    /// The system, one affine group of variables.
    pub system: System,
    /// Number of distinct isolated solutions in C^n, where it is published.
    pub finite_solutions: Option<u64>,
    /// Number of isolated solutions in C^n, counted with multiplicity, where it is published.
    pub with_multiplicity: Option<u64>,
    /// Source of the system and of its count.
    pub source: &'static str,
}

/// A system while it is written down.
struct Draft {
    e: Expressions,
    x: Vec<NodeId>,
    names: Vec<String>,
    equations: Vec<NodeId>,
}

impl Draft {
    fn new(names: impl IntoIterator<Item = String>) -> Self {
        let mut e = Expressions::new();
        let names: Vec<String> = names.into_iter().collect();
        let x = (0..names.len() as u32).map(|v| e.variable(v)).collect();
        Self {
            e,
            x,
            names,
            equations: Vec::new(),
        }
    }

    fn number(&mut self, numerator: i64, denominator: u64) -> NodeId {
        let value = Rational::from((numerator, denominator));
        self.e.constant(ComplexRational::real(value))
    }

    /// The first term begins the sum, so that no 0 stands in the expression.
    fn sum(&mut self, terms: &[NodeId]) -> NodeId {
        let zero = self.e.integer(0);
        terms.iter().fold(zero, |sum, &term| self.e.add(sum, term))
    }

    fn product(&mut self, factors: &[NodeId]) -> NodeId {
        let one = self.e.integer(1);
        factors
            .iter()
            .fold(one, |product, &factor| self.e.multiply(product, factor))
    }

    /// `coefficient * product of variables`.
    fn term(&mut self, coefficient: i64, variables: &[usize]) -> NodeId {
        let mut factors = vec![self.e.integer(coefficient)];
        factors.extend(variables.iter().map(|&v| self.x[v]));
        self.product(&factors)
    }

    fn equate(&mut self, terms: &[NodeId]) {
        let sum = self.sum(terms);
        self.equations.push(sum);
    }

    fn finish(self, finite: Option<u64>, multiple: Option<u64>, source: &'static str) -> Named {
        let system = System {
            groups: vec![VariableGroup {
                variables: (0..self.names.len()).collect(),
                homogeneous: false,
            }],
            equation_names: (1..=self.equations.len())
                .map(|i| format!("f{i}"))
                .collect(),
            expressions: self.e,
            variables: self.names,
            equations: self.equations,
            ..System::default()
        };
        if let Err(error) = system.check() {
            panic!("a named system is a system: {error}");
        }
        Named {
            system,
            finite_solutions: finite,
            with_multiplicity: multiple,
            source,
        }
    }
}

fn numbered(letter: &str, from: usize, to: usize) -> impl Iterator<Item = String> {
    (from..=to).map(move |k| format!("{letter}{k}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_counts() {
        let sizes = |n: &Named| (n.system.variable_count(), n.system.equation_count());
        for n in 3..9 {
            for named in [cyclic(n), noon(n), eco(n), reimer(n)] {
                assert_eq!(sizes(&named), (n, n));
            }
            assert_eq!(sizes(&katsura(n)), (n + 1, n + 1));
        }
        assert_eq!(sizes(&caprasse()), (4, 4));
        assert_eq!(sizes(&kss(5)), (5, 5));
        assert_eq!(sizes(&griewank_osborne()), (2, 2));
        assert_eq!(katsura(10).finite_solutions, Some(1024));
        assert_eq!(cyclic(5).finite_solutions, Some(70));
        assert_eq!(noon(5).finite_solutions, Some(233));
        assert_eq!(eco(8).finite_solutions, Some(64));
    }

    #[test]
    fn known_solutions_satisfy_their_systems() {
        use crate::expression::exact::values;
        let vanishes = |named: &Named, x: &[ComplexRational]| {
            let s = &named.system;
            values(&s.expressions, &s.equations, x, &[])
                .into_iter()
                .all(|v| v.is_some_and(|v| v.is_zero()))
        };
        let real = |v: &[(i64, u64)]| -> Vec<ComplexRational> {
            v.iter()
                .map(|&q| ComplexRational::real(Rational::from(q)))
                .collect()
        };
        // Katsura: all weight at 0, u0 = 1.
        let mut u = vec![(0, 1); 11];
        u[0] = (1, 1);
        assert!(vanishes(&katsura(10), &real(&u)));
        // Reimer 2 has x1^2 - x2^2 = x1^3 - x2^3 = 1/2; no rational point is
        // known, but a multiple of the first equation's must fail.
        assert!(!vanishes(&reimer(2), &real(&[(3, 4), (1, 4)])));
        assert!(vanishes(&griewank_osborne(), &real(&[(0, 1), (0, 1)])));
        assert!(vanishes(&kss(5), &real(&[(1, 1); 5])));
        for point in [[(1, 1), (2, 1)], [(-3, 1), (-6, 1)]] {
            assert!(vanishes(&ojika_1(), &real(&point)));
        }
        let on_the_curve = real(&[(0, 1), (5, 1), (1, 5)]);
        assert!(vanishes(&hyperbola_in_a_plane(), &on_the_curve));
        // Cyclic 4 has the curve (a, b, -a, -b) with a^2 b^2 = 1.
        assert!(vanishes(
            &cyclic(4),
            &real(&[(2, 1), (1, 2), (-2, 1), (-1, 2)])
        ));
        // Eco 3: (x1 + x1 x2) x3 = 1, x2 x3 = 2, x1 + x2 = -1 at (1, -2, -1).
        assert!(vanishes(&eco(3), &real(&[(1, 1), (-2, 1), (-1, 1)])));
    }
}
