//! Objective: the expression of which the smallest, the largest or all critical values on the solutions are asked.

use crate::expression::NodeId;

/// What is asked of an objective.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// Its smallest value.
    Minimize,
    /// Its largest value.
    Maximize,
    /// All its critical points.
    Critical,
}

impl Goal {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Minimize, Self::Maximize, Self::Critical];

    /// The word for it in files, and the option.
    pub fn name(self) -> &'static str {
        match self {
            Self::Minimize => "minimize",
            Self::Maximize => "maximize",
            Self::Critical => "critical",
        }
    }
}

/// An expression on the solutions of a system.
#[derive(Clone, Debug, PartialEq)]
pub struct Objective {
    /// What is asked.
    pub goal: Goal,
    /// The expression as it was typed.
    pub text: String,
    /// The expression, in the graph of the system.
    pub node: NodeId,
    /// True where no equations were given: those of the system are then that the gradient is 0.
    pub is_free: bool,
}
