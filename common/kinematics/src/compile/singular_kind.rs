//! Kinds of singular positions, and what their equations are: all that is asked and answered, whatever the mechanism.

use super::configurations::Motion;

/// Kind of singularity: loss of control by the inputs, or loss of freedom of the output.
#[derive(Clone, Debug, PartialEq)]
pub enum SingularKind {
    /// Something moves while these inputs are held.
    Inputs(Vec<String>),
    /// Something moves while the output is held: it cannot begin to move in a direction in which it moves elsewhere.
    Outputs,
}

impl SingularKind {
    /// The word for it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Inputs(_) => "inputs",
            Self::Outputs => "outputs",
        }
    }

    /// The inputs that are held; `None` where it is the output.
    pub fn inputs(&self) -> Option<&[String]> {
        match self {
            Self::Inputs(names) => Some(names),
            Self::Outputs => None,
        }
    }

    /// Whether a joint is one of the inputs.
    pub fn is_input(&self, joint: &str) -> bool {
        let mut inputs = self.inputs().unwrap_or_default().iter();
        inputs.any(|name| name == joint)
    }
}

/// How much the equations say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Positions are singular where all equations hold.
    Solutions,
    /// All positions are singular: the equations are those of the motion.
    Everywhere,
    /// No position is singular, whatever it is.
    Nowhere,
}

/// All singular positions.
pub struct SingularPositions {
    /// The equations, and the meaning of their solutions.
    pub motion: Motion,
    /// Extent of the singular positions.
    pub extent: Extent,
    /// Number of equations, the first ones, that hold in all positions.
    pub closing: usize,
    /// Smallest dimension of components that are surely whole modes of the motion.
    pub whole_from: u32,
    /// Smallest dimension of components that may be whole modes of the motion.
    pub maybe_whole_from: u32,
}
