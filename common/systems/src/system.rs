//! System: F(x; p) with variables, parameters and variable groups.
//!
//! A system from a file or a client is checked: names are distinct, every variable is in exactly one group, every
//! equation depends on a variable. All other parts work on checked systems.

use crate::expression::{Dependence, Expressions, Node, NodeId};
use crate::helper_unknown::Helper;
use crate::scaling::{MOST_EXPONENT, Scaling};
use std::collections::{BTreeMap, HashSet};

/// Variables that are homogenised, or are homogeneous, together.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct VariableGroup {
    /// Indices of variables, in the order in which they are shown.
    pub variables: Vec<usize>,
    /// True when the equations are homogeneous in this group: a point is a
    /// line through the origin, and the group has no infinity.
    pub homogeneous: bool,
}

/// A named set of endpoints that are no answers.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum DegenerateSet {
    /// Points where this expression vanishes.
    Nonzero(NodeId),
    /// Points where all of these vanish.
    Equations(Vec<NodeId>),
}

impl DegenerateSet {
    /// The expressions that say which points are in the set.
    pub fn nodes(&self) -> &[NodeId] {
        match self {
            Self::Nonzero(node) => std::slice::from_ref(node),
            Self::Equations(nodes) => nodes,
        }
    }

    /// The expressions that say which points are in the set, to be replaced.
    pub fn nodes_mut(&mut self) -> &mut [NodeId] {
        match self {
            Self::Nonzero(node) => std::slice::from_mut(node),
            Self::Equations(nodes) => nodes,
        }
    }
}

/// One generator of a symmetry group of the solutions.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SymmetryGenerator {
    /// Variable `i` takes the value of variable `permutation[i]`.
    Permutation(Vec<usize>),
    /// Variable `i` takes the value of expression `map[i]` of the variables.
    Map(Vec<NodeId>),
}

/// A polynomial system in variables and parameters.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct System {
    /// All expressions of the system.
    pub expressions: Expressions,
    /// Names of the variables, in order.
    pub variables: Vec<String>,
    /// Names of the parameters, in order.
    pub parameters: Vec<String>,
    /// A partition of the variables.
    pub groups: Vec<VariableGroup>,
    /// The equations F_i = 0.
    pub equations: Vec<NodeId>,
    /// Names of the equations, for messages.
    pub equation_names: Vec<String>,
    /// The parameter that runs from 1 to 0 in a user homotopy.
    pub path_variable: Option<usize>,
    /// Pairs of variables that are each other's conjugates at a real solution.
    pub conjugates: Vec<(usize, usize)>,
    /// Sets of endpoints that are no answers, by name.
    pub degenerate: BTreeMap<String, DegenerateSet>,
    /// Generators of a symmetry group of the solutions.
    pub symmetry: Vec<SymmetryGenerator>,
    /// The units in which it is tracked; everything else about a system is in its own.
    pub scaling: Scaling,
    /// Unknowns that stand for functions of others.
    #[serde(default)]
    pub helpers: Vec<Helper>,
}

/// Reason why a system is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SystemError {
    /// The system has no variables.
    #[error("the system has no variables")]
    NoVariables,
    /// The system has no equations.
    #[error("the system has no equations")]
    NoEquations,
    /// Two things have one name.
    #[error("the name `{0}` stands for two things")]
    DuplicateName(String),
    /// A group names a variable that does not exist.
    #[error("variable group {group} names variable number {variable}, but there are only {count}")]
    UnknownVariable {
        /// Number of the group, from 1.
        group: usize,
        /// The index that is out of range, from 1.
        variable: usize,
        /// Number of variables.
        count: usize,
    },
    /// Groups do not partition the variables.
    #[error("variable `{variable}` is in {count} variable groups; it must be in exactly one")]
    NotAPartition {
        /// The variable's name.
        variable: String,
        /// Number of groups that the variable is in.
        count: usize,
    },
    /// An equation holds always or never.
    #[error("equation `{0}` contains no variable")]
    ConstantEquation(String),
    /// An equation or a degenerate set has a variable in a denominator.
    #[error("`{0}` divides by an expression with variables")]
    DivisionByVariables(String),
    /// Permutations, maps and pairs of conjugates must fit the variables.
    #[error("{0} does not fit the variables")]
    Misfit(String),
    /// A reference to a variable, parameter or node that does not exist.
    #[error("`{0}` refers to something that does not exist")]
    DanglingReference(String),
}

impl System {
    /// Number of variables.
    pub fn variable_count(&self) -> usize {
        self.variables.len()
    }

    /// Number of equations.
    pub fn equation_count(&self) -> usize {
        self.equations.len()
    }

    /// Number of coordinates that a solution has up to scaling: one less than
    /// the variables for each homogeneous group.
    pub fn dimension(&self) -> usize {
        self.variables.len() - self.groups.iter().filter(|g| g.homogeneous).count()
    }

    /// Checks every invariant that this type promises.
    pub fn check(&self) -> Result<(), SystemError> {
        if self.variables.is_empty() {
            return Err(SystemError::NoVariables);
        }
        if self.equations.is_empty() {
            return Err(SystemError::NoEquations);
        }
        let mut names = HashSet::new();
        for name in self.variables.iter().chain(&self.parameters) {
            if !names.insert(name) {
                return Err(SystemError::DuplicateName(name.clone()));
            }
        }
        let mut seen = vec![0usize; self.variables.len()];
        for (g, group) in self.groups.iter().enumerate() {
            for &v in &group.variables {
                *seen.get_mut(v).ok_or(SystemError::UnknownVariable {
                    group: g + 1,
                    variable: v + 1,
                    count: self.variables.len(),
                })? += 1;
            }
        }
        if let Some(v) = seen.iter().position(|&n| n != 1) {
            return Err(SystemError::NotAPartition {
                variable: self.variables[v].clone(),
                count: seen[v],
            });
        }
        let nodes = self.expressions.nodes();
        for node in nodes {
            match node {
                Node::Variable(v) if *v as usize >= self.variables.len() => {
                    return Err(SystemError::DanglingReference(format!("variable {v}")));
                }
                Node::Parameter(p) if *p as usize >= self.parameters.len() => {
                    return Err(SystemError::DanglingReference(format!("parameter {p}")));
                }
                _ => {}
            }
        }
        for (i, &equation) in self.equations.iter().enumerate() {
            let name = self
                .equation_names
                .get(i)
                .cloned()
                .unwrap_or_else(|| format!("equation {}", i + 1));
            if equation.0 as usize >= nodes.len() {
                return Err(SystemError::DanglingReference(name));
            }
            if self.expressions.dependence(equation) != Dependence::Variables {
                return Err(SystemError::ConstantEquation(name));
            }
        }
        self.check_attachments()
    }

    /// Conjugates, degenerate sets, symmetry, path variable: each refers to what exists.
    fn check_attachments(&self) -> Result<(), SystemError> {
        let missing = |what: &str| SystemError::DanglingReference(what.into());
        if self
            .path_variable
            .is_some_and(|p| p >= self.parameters.len())
        {
            return Err(missing("the path variable"));
        }
        let count = self.variables.len();
        let exponents = &self.scaling.exponents;
        let too_large = |e: &i32| e.unsigned_abs() > MOST_EXPONENT.unsigned_abs();
        if !(exponents.is_empty() || exponents.len() == count) || exponents.iter().any(too_large) {
            return Err(SystemError::Misfit("the scaling".into()));
        }
        let mut paired = vec![false; count];
        for &(a, b) in &self.conjugates {
            for v in [a, b] {
                let taken = paired
                    .get_mut(v)
                    .ok_or_else(|| missing("a pair of conjugates"))?;
                if std::mem::replace(taken, true) {
                    let what = format!("the pair of conjugates with `{}`", self.variables[v]);
                    return Err(SystemError::Misfit(what));
                }
            }
        }
        let nodes = self.expressions.nodes();
        let exists = |node: &NodeId| (node.0 as usize) < nodes.len();
        let polynomial = self.polynomial_nodes();
        let divides = |node: &NodeId| !polynomial[node.0 as usize];
        for (i, equation) in self.equations.iter().enumerate() {
            if divides(equation) {
                let name = self.equation_names.get(i).cloned();
                let name = name.unwrap_or_else(|| format!("equation {}", i + 1));
                return Err(SystemError::DivisionByVariables(name));
            }
        }
        for (name, set) in &self.degenerate {
            let members = set.nodes();
            if !members.iter().all(exists) {
                return Err(missing(name));
            }
            if members.iter().any(divides) {
                return Err(SystemError::DivisionByVariables(name.clone()));
            }
        }
        for (i, generator) in self.symmetry.iter().enumerate() {
            let name = format!("symmetry generator {}", i + 1);
            let fits = match generator {
                SymmetryGenerator::Permutation(images) => {
                    let mut sorted = images.clone();
                    sorted.sort_unstable();
                    sorted.into_iter().eq(0..count)
                }
                SymmetryGenerator::Map(images) => {
                    if !images.iter().all(exists) {
                        return Err(missing(&name));
                    }
                    images.len() == count
                }
            };
            if !fits {
                return Err(SystemError::Misfit(name));
            }
        }
        self.check_helpers()
    }

    /// For each node, whether no denominator below it contains a variable.
    pub fn polynomial_nodes(&self) -> Vec<bool> {
        let mut polynomial: Vec<bool> = Vec::with_capacity(self.expressions.nodes().len());
        for (id, node) in self.expressions.nodes().iter().enumerate() {
            let mut children = self.expressions.children(NodeId(id as u32));
            let here = match node {
                Node::Divide(_, b) => self.expressions.dependence(*b) != Dependence::Variables,
                _ => true,
            };
            polynomial.push(here && children.all(|c| polynomial[c.0 as usize]));
        }
        polynomial
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system() -> System {
        let mut e = Expressions::new();
        let (x, y) = (e.variable(0), e.variable(1));
        let product = e.multiply(x, y);
        System {
            expressions: e,
            variables: vec!["x".into(), "y".into()],
            parameters: vec!["t".into()],
            groups: vec![VariableGroup {
                variables: vec![0, 1],
                homogeneous: false,
            }],
            equations: vec![product],
            equation_names: vec!["f".into()],
            ..System::default()
        }
    }

    #[test]
    fn what_is_attached_must_fit_the_system() {
        assert_eq!(system().check(), Ok(()));
        let change = |change: &dyn Fn(&mut System)| {
            let mut s = system();
            change(&mut s);
            s.check().map_err(|e| e.to_string())
        };
        let far = NodeId(99);
        let err = |text: &str| Err(text.to_string());
        assert_eq!(
            change(&|s| s.path_variable = Some(1)),
            err("`the path variable` refers to something that does not exist")
        );
        assert_eq!(
            change(&|s| s.conjugates = vec![(0, 2)]),
            err("`a pair of conjugates` refers to something that does not exist")
        );
        assert_eq!(
            change(&|s| s.conjugates = vec![(0, 0)]),
            err("the pair of conjugates with `x` does not fit the variables")
        );
        assert_eq!(
            change(&|s| drop(s.degenerate.insert("a".into(), DegenerateSet::Nonzero(far)))),
            err("`a` refers to something that does not exist")
        );
        let permutation = |images: &[usize]| SymmetryGenerator::Permutation(images.into());
        assert_eq!(change(&|s| s.symmetry = vec![permutation(&[1, 0])]), Ok(()));
        assert_eq!(
            change(&|s| s.symmetry = vec![permutation(&[1, 1])]),
            err("symmetry generator 1 does not fit the variables")
        );
        assert_eq!(
            change(&|s| s.symmetry = vec![SymmetryGenerator::Map(vec![far, far])]),
            err("`symmetry generator 1` refers to something that does not exist")
        );
        let quotient = |s: &mut System| {
            let (x, y) = (s.expressions.variable(0), s.expressions.variable(1));
            s.expressions.divide(x, y)
        };
        assert_eq!(
            change(&|s| s.equations[0] = quotient(s)),
            err("`f` divides by an expression with variables")
        );
        assert_eq!(
            change(&|s| {
                let q = quotient(s);
                s.symmetry = vec![SymmetryGenerator::Map(vec![q, q])];
            }),
            Ok(())
        );
    }
}
