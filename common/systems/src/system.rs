//! System: F(x; p) with variables, parameters and variable groups.
//!
//! What a file or a client gives, checked: names are distinct, every variable
//! is in exactly one group, every equation depends on a variable. The rest of
//! the house works on this.

use crate::expression::{Dependence, Expressions, Node, NodeId};
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

/// One generator of a symmetry group of the solutions.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SymmetryGenerator {
    /// Variable `i` takes the value of variable `permutation[i]`.
    Permutation(Vec<usize>),
    /// Variable `i` takes the value of expression `map[i]` of the variables.
    Map(Vec<NodeId>),
}

/// A polynomial system in variables and parameters.
#[derive(Clone, Debug, Default, PartialEq)]
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
}

/// Why a system is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SystemError {
    /// There is nothing to solve for.
    #[error("the system has no variables")]
    NoVariables,
    /// There is nothing to solve.
    #[error("the system has no equations")]
    NoEquations,
    /// Two things have one name.
    #[error("the name `{0}` stands for two things")]
    DuplicateName(String),
    /// A group names a variable that does not exist.
    #[error("variable group {group} names variable number {variable}, but there are only {count}")]
    UnknownVariable {
        /// Which group, from 1.
        group: usize,
        /// The index that is out of range, from 1.
        variable: usize,
        /// How many variables there are.
        count: usize,
    },
    /// Groups do not partition the variables.
    #[error("variable `{variable}` is in {count} variable groups; it must be in exactly one")]
    NotAPartition {
        /// The variable's name.
        variable: String,
        /// In how many groups it is.
        count: usize,
    },
    /// An equation holds always or never.
    #[error("equation `{0}` contains no variable")]
    ConstantEquation(String),
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
        Ok(())
    }
}
