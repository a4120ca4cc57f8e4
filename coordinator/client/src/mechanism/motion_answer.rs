//! Motion answer: the modes of a mechanism's motion, and how they lie to each other.

use cognate_kinematics::compile::motion::{DegreeIn, Placed};
use num_complex::Complex64;
use serde_json::Value;
use std::collections::BTreeMap;

/// Topology of the real positions of a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct RealPositions {
    /// Connected pieces, isolated points left out.
    pub circuits: u64,
    /// Counts of loops, arcs and points, as `real-curve` gives them.
    pub counts: Value,
}

/// A component of the configurations that has a positive dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Name of the mode: `1.2` is the second of dimension 1.
    pub id: String,
    /// Number of freedoms of the mode.
    pub dimension: u32,
    /// Degree in the coordinates that the answer names.
    pub degree: u64,
    /// Multiplicity of the scheme; `None` where that is not known.
    pub multiplicity: Option<u64>,
    /// Whether the position of the file is on the mode; `None` if the file has none, or in doubt.
    pub home: Option<bool>,
    /// Real positions of the mode, if they were asked for and no doubt is left.
    pub real: Option<RealPositions>,
    /// Degree of the path of the point that was asked for.
    pub path_degree: Option<u64>,
}

/// A position that two modes have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct MeetingPoint {
    /// Whether it is real; `None` where that is in doubt.
    pub is_real: Option<bool>,
    /// The position, where it is real.
    pub placed: Option<Placed>,
    /// The unknowns of the decomposition there.
    pub solution: Vec<Complex64>,
}

/// Intersection of two modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Meeting {
    /// Names of the two modes.
    pub modes: [String; 2],
    /// Common positions; `None` where they are infinitely many, or were not found out.
    pub points: Option<Vec<MeetingPoint>>,
}

/// Numbers of the positions that are alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Isolated {
    /// All of them.
    pub complex: Option<u64>,
    /// The real ones among them.
    pub real: Option<u64>,
}

/// All ways in which a mechanism moves.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionAnswer {
    /// The coordinates in which degrees are counted.
    pub degree_in: DegreeIn,
    /// The modes, largest dimension first, then largest degree.
    pub modes: Vec<Mode>,
    /// Positions that are alone.
    pub isolated: Isolated,
    /// Pairs of modes that have positions in common.
    pub meetings: Vec<Meeting>,
    /// Whether modes of different dimensions meet in a real position; `None` where that is in doubt.
    pub is_kinematotropic: Option<bool>,
    /// Connected pieces of all real positions that are not alone; `None` where that was not asked or is in doubt.
    pub circuits: Option<u64>,
    /// Whether circuits were asked for.
    pub asks_real: bool,
    /// Whether the degree of a path was asked for.
    pub asks_path: bool,
    /// Components that are no positions, by the reason: number and degree of each.
    pub removed: BTreeMap<String, Vec<[u64; 3]>>,
    /// Doubts that keep the answer from being settled.
    pub doubts: Vec<String>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

impl MotionAnswer {
    /// The largest dimension of a mode; 0 where positions are alone, -1 where there are none; `None` in doubt.
    pub fn mobility(&self) -> Option<i64> {
        match (self.modes.first(), self.isolated.complex) {
            (Some(mode), _) => Some(i64::from(mode.dimension)),
            (None, Some(0)) => Some(-1),
            (None, Some(_)) => Some(0),
            (None, None) => None,
        }
        .filter(|_| self.is_complete())
    }

    /// Whether the decomposition left nothing in doubt.
    fn is_complete(&self) -> bool {
        self.isolated.complex.is_some()
    }

    /// Whether all that was asked is known.
    pub fn is_settled(&self) -> bool {
        self.doubts.is_empty()
    }
}
