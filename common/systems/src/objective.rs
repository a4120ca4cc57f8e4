//! Objective: the expression of which the smallest, the largest or all critical values on the solutions are asked.

use crate::expression::NodeId;

/// Which critical points of an objective are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// Points with the smallest value.
    Minimize,
    /// Points with the largest value.
    Maximize,
    /// All critical points.
    Critical,
}

impl Goal {
    /// All goals.
    pub const ALL: [Self; 3] = [Self::Minimize, Self::Maximize, Self::Critical];

    /// Word for the goal in files, and name of the option.
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
    /// Which critical points are wanted.
    pub goal: Goal,
    /// The expression as it was typed.
    pub text: String,
    /// The expression, in the graph of the system.
    pub node: NodeId,
    /// True where no equations were given; the equations of the system then say that the gradient is 0.
    pub is_free: bool,
}
