//! Degrees, supports and coefficients of a system, where it is polynomial.
//!
//! A start system from degrees that are too large would send paths to
//! infinity that nobody asked for, and one from degrees that are too small
//! would miss solutions; so [`degrees`] are exact even where terms cancel.

pub mod attained;
mod dual_dimensions;
pub mod exact_points;
mod expansion;
mod linear_dependence;
mod modular;
mod primes;
pub mod quotient;
mod solution_count;
pub mod sublevel_set;
pub mod univariate;
mod with_numbers;

pub use dual_dimensions::dual_dimensions;
pub use expansion::Polynomial;
pub use linear_dependence::independent_equations;
pub use solution_count::{
    CountedSolutions, NotCounted, SolutionCount, has_exact_constants, has_many_digits,
    has_rounded_numbers, is_chosen, solution_count,
};

pub use with_numbers::PolynomialWithNumbers;

use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Node, NodeId};
use crate::system::System;
use cognate_numeric::interruption::is_interrupted;
use cognate_numeric::random::{Purpose, RandomStream};
use foldhash::{HashMap, HashMapExt};
use modular::Residues;

/// Past this degree the bound that the form of an expression gives is taken as it is.
const MOST_DEGREE: u32 = 4096;
/// Exponents of all terms of all equations that are held at once, four bytes each: no system that could
/// be solved from its monomials comes near.
const MOST_EXPONENTS: usize = 1 << 25;

/// The degrees of all equations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Degrees {
    /// `by_group[i][g]`: degree of equation i in the variables of group g.
    pub by_group: Vec<Vec<u32>>,
    /// Degree of each equation in all variables.
    pub total: Vec<u32>,
}

/// Reason why the equations of a system cannot be used as polynomials.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PolynomialError {
    /// All terms of the equation cancel.
    #[error("equation `{0}` is 0 for all values of the variables")]
    Vanishes(String),
    /// Every variable cancels.
    #[error("equation `{0}` contains no variable once its terms are collected")]
    Constant(String),
    /// A variable below the line.
    #[error("equation `{0}` has a variable in a denominator; multiply it out")]
    NotPolynomial(String),
    /// The caller stopped waiting before the degrees were counted.
    #[error("the degrees of equation `{0}` were not counted: it takes too long")]
    Interrupted(String),
    /// A homogeneous group whose equation is none.
    #[error(
        "equation `{equation}` is not homogeneous in the group of `{variable}`; \
         use variable_group instead of hom_variable_group, or homogenise it"
    )]
    NotHomogeneous {
        /// The equation's name.
        equation: String,
        /// First variable of the group.
        variable: String,
    },
}

/// The name of an equation, for messages.
fn name(system: &System, equation: usize) -> String {
    system
        .equation_names
        .get(equation)
        .cloned()
        .unwrap_or_else(|| format!("equation {}", equation + 1))
}

/// All degrees, exact where terms cancel; parameters are generic.
///
/// The form of an expression bounds its degree from above, its values along a
/// random line modulo a prime from below. Where the two differ, the equation is
/// multiplied out; where that takes too much, the lower bound is right but for
/// odds of about 2^-50.
pub fn degrees(system: &System) -> Result<Degrees, PolynomialError> {
    let mut result = Degrees {
        by_group: Vec::new(),
        total: Vec::new(),
    };
    for (i, &equation) in system.equations.iter().enumerate() {
        if !is_polynomial(&system.expressions, equation) {
            return Err(PolynomialError::NotPolynomial(name(system, i)));
        }
        let mut measured = Measured::new(system, equation, i);
        let variables: Vec<usize> = (0..system.variable_count()).collect();
        let without_degree = || match is_interrupted() {
            true => PolynomialError::Interrupted(name(system, i)),
            false => PolynomialError::Vanishes(name(system, i)),
        };
        let total = measured.degree(&variables).ok_or_else(without_degree)?;
        if total == 0 {
            return Err(PolynomialError::Constant(name(system, i)));
        }
        let by_group = system
            .groups
            .iter()
            .map(|group| measured.degree(&group.variables).ok_or_else(without_degree))
            .collect::<Result<Vec<u32>, _>>()?;
        if is_interrupted() {
            return Err(PolynomialError::Interrupted(name(system, i)));
        }
        result.total.push(total);
        result.by_group.push(by_group);
    }
    Ok(result)
}

/// Whether an expression is 0 for all values of variables and parameters; false where it takes too much to be multiplied out.
pub fn vanishes(system: &System, root: NodeId) -> bool {
    let expressions = &system.expressions;
    let (variables, parameters) = (system.variable_count(), system.parameters.len());
    let residues = Residues::new(expressions, root, variables, 0);
    let mut stream = RandomStream::new(0, Purpose::Probe, 0);
    let is_zero_somewhere = residues.is_none_or(|residues| {
        let point = residues.point(&mut stream);
        residues.value(&point, &mut Vec::new()) == Some(0)
    });
    is_zero_somewhere
        && Polynomial::expand(expressions, root, variables, parameters)
            .is_some_and(|polynomial| polynomial.terms.is_empty())
}

/// The exponents that occur in each equation once its terms are collected, with generic parameters and generic numbers
/// where they are not rational. `None` where an equation is no polynomial or takes too much to be multiplied out.
pub fn supports(system: &System) -> Option<Vec<Vec<Vec<u32>>>> {
    let mut left = MOST_EXPONENTS;
    system
        .equations
        .iter()
        .map(|&equation| {
            let (n, p) = (system.variable_count(), system.parameters.len());
            let expanded = PolynomialWithNumbers::expand(&system.expressions, equation, n, p)?;
            let expanded = expanded.polynomial;
            // Before the exponents are copied: a file of some kilobytes can have billions of them.
            left = left.checked_sub(expanded.term_count().saturating_mul(n))?;
            Some(expanded.support())
        })
        .collect()
}

/// Checks that every equation is homogeneous in every homogeneous group.
pub fn check_homogeneous(system: &System, degrees: &Degrees) -> Result<(), PolynomialError> {
    for (i, &equation) in system.equations.iter().enumerate() {
        for (g, group) in system.groups.iter().enumerate() {
            if !group.homogeneous
                || homogeneous_by_form(&system.expressions, equation, &group.variables)
            {
                continue;
            }
            let mut measured = Measured::new(system, equation, i);
            if !measured.is_homogeneous(&group.variables, degrees.by_group[i][g]) {
                return Err(PolynomialError::NotHomogeneous {
                    equation: name(system, i),
                    variable: group
                        .variables
                        .first()
                        .map(|&v| system.variables[v].clone())
                        .unwrap_or_default(),
                });
            }
        }
    }
    Ok(())
}

/// Whether no variable stands below the line.
fn is_polynomial(expressions: &Expressions, root: NodeId) -> bool {
    below(expressions, &[root]).into_iter().all(|id| {
        !matches!(expressions.node(id),
            Node::Divide(_, b) if expressions.dependence(*b) == Dependence::Variables)
    })
}

/// The degree that the form of each node below `root` suggests, at least the true one.
pub fn degrees_by_form(
    expressions: &Expressions,
    root: NodeId,
    variables: &[usize],
) -> HashMap<NodeId, u32> {
    let mut degree: HashMap<NodeId, u32> = HashMap::new();
    for id in below(expressions, &[root]) {
        let d = match expressions.node(id) {
            Node::Variable(v) => u32::from(variables.contains(&(*v as usize))),
            Node::Add(a, b) | Node::Subtract(a, b) => degree[a].max(degree[b]),
            Node::Multiply(a, b) => degree[a].saturating_add(degree[b]),
            Node::Divide(a, _) | Node::Negate(a) => degree[a],
            Node::Power(a, exponent) => degree[a].saturating_mul(*exponent),
            Node::Constant(_) | Node::Parameter(_) | Node::Root(..) | Node::Function(..) => 0,
        };
        degree.insert(id, d);
    }
    degree
}

/// Whether every sum below `root` adds like degrees; enough, but not necessary.
fn homogeneous_by_form(expressions: &Expressions, root: NodeId, variables: &[usize]) -> bool {
    let degree = degrees_by_form(expressions, root, variables);
    degree.keys().all(|&id| match expressions.node(id) {
        Node::Add(a, b) | Node::Subtract(a, b) => degree[a] == degree[b],
        _ => true,
    })
}

/// Facts about one equation, each computed once and when it is needed.
struct Measured<'a> {
    system: &'a System,
    equation: NodeId,
    stream: RandomStream,
    residues: Option<Residues>,
    expanded: Option<Option<Polynomial>>,
}

impl<'a> Measured<'a> {
    fn new(system: &'a System, equation: NodeId, index: usize) -> Self {
        Self {
            system,
            equation,
            // A fixed seed: the answer is a property of the system.
            stream: RandomStream::new(0, Purpose::Probe, index as u64),
            residues: Residues::new(&system.expressions, equation, system.variable_count(), 0),
            expanded: None,
        }
    }

    fn expanded(&mut self) -> Option<&Polynomial> {
        self.expanded
            .get_or_insert_with(|| {
                Polynomial::expand(
                    &self.system.expressions,
                    self.equation,
                    self.system.variable_count(),
                    self.system.parameters.len(),
                )
            })
            .as_ref()
    }

    /// Degree in some variables; `None` for 0.
    fn degree(&mut self, variables: &[usize]) -> Option<u32> {
        let bound =
            degrees_by_form(&self.system.expressions, self.equation, variables)[&self.equation];
        let measured = match &self.residues {
            Some(residues) if bound <= MOST_DEGREE => {
                let base = residues.point(&mut self.stream);
                let random = residues.point(&mut self.stream);
                let mut direction = vec![0; base.len()];
                for &v in variables {
                    direction[v] = random[v];
                }
                residues.degree_along(&base, &direction, bound)
            }
            _ => return Some(bound),
        };
        if measured == Some(bound) {
            return measured;
        }
        match self.expanded() {
            Some(polynomial) if polynomial.terms.is_empty() => None,
            Some(polynomial) => Some(polynomial.degree_in(variables)),
            None => measured,
        }
    }

    fn is_homogeneous(&mut self, variables: &[usize], degree: u32) -> bool {
        if let Some(polynomial) = self.expanded() {
            return polynomial.is_homogeneous_in(variables);
        }
        match &self.residues {
            Some(residues) => residues.scales(variables, degree, &mut self.stream),
            None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::VariableGroup;
    use cognate_numeric::rational::Rational;

    /// One equation in x, y and the parameter p, in the groups given.
    fn system(groups: &[(&[usize], bool)], f: impl Fn(&mut Expressions) -> NodeId) -> System {
        let mut expressions = Expressions::new();
        let equation = f(&mut expressions);
        System {
            expressions,
            variables: vec!["x".into(), "y".into()],
            parameters: vec!["p".into()],
            groups: groups
                .iter()
                .map(|(v, homogeneous)| VariableGroup {
                    variables: v.to_vec(),
                    homogeneous: *homogeneous,
                })
                .collect(),
            equations: vec![equation],
            equation_names: vec!["f".into()],
            ..System::default()
        }
    }

    /// (base+1)^power - base^power, of one degree less than it looks.
    fn telescope(e: &mut Expressions, base: NodeId, power: u32) -> NodeId {
        let one = e.integer(1);
        let next = e.add(base, one);
        let (a, b) = (e.power(next, power), e.power(base, power));
        e.subtract(a, b)
    }

    #[test]
    fn degrees_are_exact_where_terms_cancel() {
        for power in [2, 5, 40] {
            let s = system(&[(&[0], false), (&[1], false)], |e| {
                let (x, y) = (e.variable(0), e.variable(1));
                let f = telescope(e, x, power);
                let y3 = e.power(y, 3);
                e.multiply(f, y3)
            });
            let d = degrees(&s).expect("polynomial");
            assert_eq!(d.by_group, [[power - 1, 3]]);
            assert_eq!(d.total, [power + 2]);
        }
    }

    #[test]
    fn degrees_are_found_where_expansion_is_out_of_reach() {
        // (x + y + p)^200 - (x + y)^200 has degree 199 and 20,000 terms;
        // 1/p keeps it from being multiplied out at all.
        let s = system(&[(&[0, 1], false)], |e| {
            let (x, y, p) = (e.variable(0), e.variable(1), e.parameter(0));
            let sum = e.add(x, y);
            let one = e.integer(1);
            let shift = e.divide(one, p);
            let shifted = e.add(sum, shift);
            let (a, b) = (e.power(shifted, 200), e.power(sum, 200));
            e.subtract(a, b)
        });
        assert_eq!(degrees(&s).expect("polynomial").total, [199]);
    }

    #[test]
    fn what_vanishes_or_is_constant_is_named() {
        let zero = system(&[(&[0, 1], false)], |e| {
            let x = e.variable(0);
            let f = telescope(e, x, 2);
            let two = e.integer(-2);
            let g = e.multiply(two, x);
            let h = e.add(f, g);
            let minus = e.integer(-1);
            e.add(h, minus)
        });
        assert_eq!(degrees(&zero), Err(PolynomialError::Vanishes("f".into())));
        let constant = system(&[(&[0, 1], false)], |e| {
            let x = e.variable(0);
            let f = telescope(e, x, 2);
            let two = e.integer(-2);
            let g = e.multiply(two, x);
            e.add(f, g)
        });
        assert_eq!(
            degrees(&constant),
            Err(PolynomialError::Constant("f".into()))
        );
        let rational = system(&[(&[0, 1], false)], |e| {
            let (x, y) = (e.variable(0), e.variable(1));
            e.insert(Node::Divide(x, y))
        });
        assert_eq!(
            degrees(&rational),
            Err(PolynomialError::NotPolynomial("f".into()))
        );
    }

    #[test]
    fn homogeneity_is_checked_and_the_equation_named() {
        // x*((x+1)^2 - x^2) - x + c*x*y = 2x^2 + c*x*y is homogeneous, though not
        // by its form; without - x it is not. c = 3^(1/2) keeps it from being
        // multiplied out.
        for root in [false, true] {
            for spoilt in [false, true] {
                let s = system(&[(&[0, 1], true)], |e| {
                    let (x, y) = (e.variable(0), e.variable(1));
                    let slope = telescope(e, x, 2);
                    let product = e.multiply(slope, x);
                    let three = e.integer(3);
                    let c = if root {
                        e.root(three, Rational::from((1, 2)))
                    } else {
                        three
                    };
                    let xy = e.multiply(x, y);
                    let cxy = e.multiply(c, xy);
                    let sum = e.add(product, cxy);
                    if spoilt { sum } else { e.subtract(sum, x) }
                });
                let d = degrees(&s).expect("polynomial");
                assert_eq!(d.total, [2]);
                assert_eq!(check_homogeneous(&s, &d).is_err(), spoilt);
            }
        }
    }

    #[test]
    fn named_systems_have_their_degrees() {
        let total = |n: crate::named::Named| degrees(&n.system).expect("polynomial").total;
        assert_eq!(total(crate::named::katsura(4)), [2, 2, 2, 2, 1]);
        assert_eq!(total(crate::named::cyclic(5)), [1, 2, 3, 4, 5]);
        assert_eq!(total(crate::named::reimer(3)), [2, 3, 4]);
        assert_eq!(total(crate::named::caprasse()), [3, 4, 3, 4]);
    }
}
