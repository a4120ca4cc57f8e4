//! Locus answer: all singular positions of a mechanism.

use super::motion_answer::Isolated;
use cognate_kinematics::compile::motion::{DegreeIn, Placed};
use cognate_kinematics::compile::singular_positions::SingularKind;
use std::collections::BTreeMap;

/// Singular positions that depend on each other: a component of positive dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct LocusComponent {
    /// Name of the component: `1.2` is the second of dimension 1.
    pub id: String,
    /// The number of freedoms of the component's positions.
    pub dimension: u32,
    /// The degree in the coordinates that the answer names.
    pub degree: u64,
    /// Whether it is a whole mode of the motion, so that a mode is singular everywhere; `None` in doubt.
    pub is_whole_mode: Option<bool>,
}

/// A singular position that is alone.
#[derive(Clone, Debug, PartialEq)]
pub struct SingularPosition {
    /// Whether it is real; `None` in doubt.
    pub is_real: Option<bool>,
    /// The position, where it is real.
    pub placed: Option<Placed>,
}

/// A curve of singular positions in the plane of the output.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnCurve {
    /// The component.
    pub id: String,
    /// The degree of the curve.
    pub degree: u64,
    /// Real points of it, along its arcs.
    pub samples: Vec<[f64; 2]>,
}

/// All singular positions.
#[derive(Clone, Debug, PartialEq)]
pub struct LocusAnswer {
    /// Kind of singularity that was asked for.
    pub kind: SingularKind,
    /// The coordinates in which degrees are counted.
    pub degree_in: DegreeIn,
    /// Components of positive dimension, the largest first.
    pub components: Vec<LocusComponent>,
    /// Numbers of positions that are alone.
    pub isolated: Isolated,
    /// Positions that are alone, real ones first.
    pub positions: Vec<SingularPosition>,
    /// Curves in the output's plane; `None` where the locus was not drawn.
    pub curves: Option<Vec<DrawnCurve>>,
    /// Components that are no positions, by the reason: number and degree of each.
    pub removed: BTreeMap<String, Vec<[u64; 3]>>,
    /// Doubts that keep the answer from being settled.
    pub doubts: Vec<String>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

impl LocusAnswer {
    /// The largest dimension; 0 where positions are alone, -1 where there are none; `None` in doubt.
    pub fn dimension(&self) -> Option<i64> {
        let isolated = self.isolated.complex?;
        Some(match self.components.first() {
            Some(component) => i64::from(component.dimension),
            None if isolated > 0 => 0,
            None => -1,
        })
    }

    /// Whether nothing is in doubt.
    pub fn is_settled(&self) -> bool {
        self.doubts.is_empty()
    }
}
