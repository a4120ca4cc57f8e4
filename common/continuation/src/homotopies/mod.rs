//! Homotopies: H(x, t) from t = 1, where solutions are known, to t = 0, where they are wanted.
//!
//! Every homotopy is one program F(z; p) whose parameters move along a path
//! p(t): the straight line to a start system is one with the two parameters
//! 1 - t and gamma t. So the tracker knows one thing only, and what differs
//! between homotopies is which program is made and how p moves.

mod moved_values;
pub mod parameter_path;
pub mod prepare;
pub(crate) mod regeneration;
pub mod sections;
pub mod toric_path;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

use moved_values::moved;
pub use parameter_path::ParameterPath;
pub use prepare::{Homotopy, way_back};

/// Start and end of a deformation and the way between them. Pure data; [`prepare`] makes a program of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum HomotopyKind {
    /// `(1-t) F + t gamma G` with the start system G that belongs to the start points.
    StraightLine {
        /// Values of the system's parameters, if it has any.
        parameters: Vec<Complex64>,
    },
    /// F(x; p(t)) with p from the start parameters to each target in turn.
    /// Item number i starts at start point `i % starts` and goes to target `i / starts`.
    Parameter {
        /// Parameters at which the start points solve the system.
        start: Vec<Complex64>,
        /// Parameters at which solutions are wanted; every target has the length of `start`.
        targets: Vec<Vec<Complex64>>,
    },
    /// A homotopy of the user's own: the system's path variable is t.
    PathVariable {
        /// Values of the system's other parameters, at their places; the path variable's own is ignored.
        parameters: Vec<Complex64>,
    },
    /// From the binomial systems of the mixed cells to the generic system with the monomials of
    /// F (and a constant, where a solution can have a coordinate 0).
    Toric,
    /// `(1-t) F + t gamma G` with that generic system G, whose solutions are stored.
    Generic {
        /// Values of the system's parameters, if it has any.
        parameters: Vec<Complex64>,
    },
    /// A level of a regeneration (see `start_systems::slices`): on the first `level` equations
    /// and on the slices after the level's own, that one moves to each other form of the level.
    /// Item number i starts at start point `i % starts` and goes to form `1 + i / starts`.
    MoveSlice {
        /// Values of the system's parameters, if it has any.
        parameters: Vec<Complex64>,
        /// The equations in the order in which they are taken.
        order: Vec<u32>,
        /// Number of equations that hold already.
        level: u32,
        /// Number of forms besides the slice: the degree of the next equation, less one.
        forms: u32,
    },
    /// On the same equations and slices, from the product of the level's forms to the next equation.
    ProductToEquation {
        /// Values of the system's parameters, if it has any.
        parameters: Vec<Complex64>,
        /// The equations in the order in which they are taken.
        order: Vec<u32>,
        /// Number of equations that hold already.
        level: u32,
    },
    /// On the curve of the family over a line of its parameters, from one section to another
    /// (see [`sections`]): points have one coordinate more than the system has variables.
    Sections {
        /// Parameters of the system where the line begins.
        parameters: Vec<Complex64>,
        /// Direction of the line of parameters.
        direction: Vec<Complex64>,
        /// The section that the start points are on.
        start: Vec<Complex64>,
        /// The section on which end points are wanted.
        target: Vec<Complex64>,
    },
}

impl HomotopyKind {
    /// Number of ends for each start point.
    pub fn targets(&self) -> u64 {
        match self {
            Self::Parameter { targets, .. } => targets.len() as u64,
            Self::MoveSlice { forms, .. } => u64::from(*forms),
            Self::StraightLine { .. }
            | Self::PathVariable { .. }
            | Self::Toric
            | Self::Generic { .. }
            | Self::ProductToEquation { .. }
            | Self::Sections { .. } => 1,
        }
    }

    /// Number of sets of values of the parameters at which paths end.
    pub fn parameter_sets(&self) -> usize {
        self.target_parameters().map_or(1, <[_]>::len)
    }

    /// The values of the parameters that paths lead to from start parameters, one set for each target; `None` where
    /// paths begin at another system, or parameters do not move.
    pub fn target_parameters(&self) -> Option<&[Vec<Complex64>]> {
        match self {
            Self::Parameter { targets, .. } => Some(targets),
            Self::StraightLine { .. }
            | Self::PathVariable { .. }
            | Self::Toric
            | Self::Generic { .. }
            | Self::MoveSlice { .. }
            | Self::ProductToEquation { .. }
            | Self::Sections { .. } => None,
        }
    }

    /// Values of the system's parameters where paths to end number `target` end, with 0 for the path variable of
    /// the system: all ends have the one set, where there is one. `None` where paths end at a system without them.
    ///
    /// # Panics
    /// When there are several sets of parameters, and `target` is not one of them.
    pub fn end_parameters(
        &self,
        target: usize,
        path_variable: Option<usize>,
    ) -> Option<Cow<'_, [Complex64]>> {
        match self {
            Self::StraightLine { parameters }
            | Self::Generic { parameters }
            | Self::MoveSlice { parameters, .. }
            | Self::ProductToEquation { parameters, .. } => Some(Cow::Borrowed(parameters)),
            Self::Parameter { targets, .. } => Some(Cow::Borrowed(&targets[target])),
            Self::PathVariable { parameters } => {
                let mut parameters = parameters.clone();
                if let Some(t) = path_variable.and_then(|t| parameters.get_mut(t)) {
                    *t = Complex64::default();
                }
                Some(Cow::Owned(parameters))
            }
            Self::Toric | Self::Sections { .. } => None,
        }
    }

    /// This kind with slightly other values of parameters ([`moved_values`]), where these are compiled into the homotopy;
    /// `None` where parameters move along the path.
    pub(crate) fn with_moved_values(&self) -> Option<Self> {
        let mut kind = self.clone();
        match &mut kind {
            Self::StraightLine { parameters }
            | Self::PathVariable { parameters }
            | Self::Generic { parameters }
            | Self::MoveSlice { parameters, .. }
            | Self::ProductToEquation { parameters, .. } => *parameters = moved(parameters),
            Self::Parameter { .. } | Self::Toric | Self::Sections { .. } => return None,
        }
        Some(kind)
    }

    /// Index of the end to which a path with this origin goes, where there are `starts` start points. The end of a path
    /// from mixed cells is that of its own cell, found by the path.
    pub fn target_of(&self, origin: u64, starts: u64) -> u64 {
        match self {
            Self::Parameter { .. } | Self::MoveSlice { .. } => origin / starts,
            Self::Toric => origin,
            Self::StraightLine { .. }
            | Self::PathVariable { .. }
            | Self::Generic { .. }
            | Self::ProductToEquation { .. }
            | Self::Sections { .. } => 0,
        }
    }

    /// Whether paths begin in the coordinates of the system, at solutions of systems like it: almost all stay near, and
    /// those that run far out go on in projective patches.
    pub fn begins_in_affine_coordinates(&self) -> bool {
        match self {
            Self::Parameter { .. }
            | Self::Toric
            | Self::Generic { .. }
            | Self::MoveSlice { .. }
            | Self::ProductToEquation { .. } => true,
            Self::StraightLine { .. } | Self::PathVariable { .. } | Self::Sections { .. } => false,
        }
    }

    /// Whether paths begin at solutions of the generic system with the monomials of the system.
    pub fn begins_at_the_generic_system(&self) -> bool {
        match self {
            Self::Generic { .. } => true,
            Self::StraightLine { .. }
            | Self::Parameter { .. }
            | Self::PathVariable { .. }
            | Self::Toric
            | Self::MoveSlice { .. }
            | Self::ProductToEquation { .. }
            | Self::Sections { .. } => false,
        }
    }

    /// Whether paths begin or end at solutions of that generic system.
    pub fn has_the_generic_system(&self) -> bool {
        match self {
            Self::Toric | Self::Generic { .. } => true,
            Self::StraightLine { .. }
            | Self::Parameter { .. }
            | Self::PathVariable { .. }
            | Self::MoveSlice { .. }
            | Self::ProductToEquation { .. }
            | Self::Sections { .. } => false,
        }
    }

    /// For a level of a regeneration: the order of the equations, the number of them that hold already, and the number
    /// of forms that the slice moves to, if it moves.
    pub(crate) fn level(&self) -> Option<(&[u32], u32, Option<u32>)> {
        match self {
            Self::MoveSlice {
                order,
                level,
                forms,
                ..
            } => Some((order, *level, Some(*forms))),
            Self::ProductToEquation { order, level, .. } => Some((order, *level, None)),
            Self::StraightLine { .. }
            | Self::Parameter { .. }
            | Self::PathVariable { .. }
            | Self::Toric
            | Self::Generic { .. }
            | Self::Sections { .. } => None,
        }
    }

    /// Whether the paths of the homotopy are all that there are: those of a start system, not of points that are given.
    pub fn takes_all_paths(&self) -> bool {
        match self {
            Self::StraightLine { .. } | Self::Generic { .. } => true,
            Self::Parameter { .. }
            | Self::PathVariable { .. }
            | Self::Toric
            | Self::MoveSlice { .. }
            | Self::ProductToEquation { .. }
            | Self::Sections { .. } => false,
        }
    }

    /// Whether the paths end at solutions of the system, rather than of one on the way to it.
    pub fn ends_at_the_system(&self) -> bool {
        match self {
            Self::Toric | Self::MoveSlice { .. } | Self::Sections { .. } => false,
            Self::ProductToEquation { order, level, .. } => order.len() == *level as usize + 1,
            Self::StraightLine { .. }
            | Self::Parameter { .. }
            | Self::PathVariable { .. }
            | Self::Generic { .. } => true,
        }
    }
}
