//! Configurations: all of a mechanism's as the solutions of equations, the coordinates that the unknowns are, and the point
//! whose path is asked for.

use super::formulation::PathText;
use super::text::Equations;
use crate::mechanism::chain::JointValue;
use crate::mechanism::exact::Number;
use crate::mechanism::pose::Pose;
use crate::mechanism::{Body, Mechanism, MechanismError, Output, PLATFORM, Vector, link_name};
use num_complex::Complex64;

/// The coordinates of a configuration in which degrees are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DegreeIn {
    /// Cosines and sines of the turns of moving links, and displacements.
    Links,
    /// Cosines and sines of the turns of all joints, and displacements.
    Joints,
    /// Points of a framework.
    Points,
    /// Study coordinates of a platform.
    Study,
    /// Position of a platform in the plane, and cosine and sine of its turn.
    Pose,
}

impl DegreeIn {
    /// The word for the coordinates.
    pub fn name(self) -> &'static str {
        match self {
            Self::Links => "links",
            Self::Joints => "joints",
            Self::Points => "points",
            Self::Study => "study",
            Self::Pose => "pose",
        }
    }
}

/// A configuration, as people give it.
#[derive(Clone, Debug, PartialEq)]
pub enum Placed {
    /// Values of joints.
    Joints(Vec<(String, JointValue)>),
    /// Places of points.
    Points(Vec<(String, [Complex64; 2])>),
    /// The pose of a platform.
    Pose(Pose),
}

/// The configuration of a solution.
type Placing = Box<dyn Fn(&[Complex64]) -> Option<Placed> + Send + Sync>;

/// All configurations of a mechanism.
pub struct Motion {
    /// The equations.
    pub equations: Equations,
    /// The coordinates that the unknowns are.
    pub degree_in: DegreeIn,
    /// The unknowns at the position of the file, where it has one.
    pub home: Option<Vec<f64>>,
    /// The point whose path is asked for.
    pub path: Option<PathText>,
    /// Numbers that the equations round.
    pub warnings: Vec<String>,
    pub(super) placing: Placing,
}

impl Motion {
    /// The configuration of a solution; `None` where that is none.
    pub fn placed(&self, solution: &[Complex64]) -> Option<Placed> {
        (self.placing)(solution)
    }
}

/// A point of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedPoint {
    /// Name of the link.
    pub link: String,
    /// The point in the coordinates of the link.
    pub point: Vector,
}

impl TracedPoint {
    /// The point of a mechanism's output; the origin of the link where the file names none.
    pub fn of_output(output: &Output) -> Self {
        let zero = || Number::integer(0);
        Self {
            link: output.link.clone(),
            point: output
                .point
                .clone()
                .unwrap_or_else(|| [zero(), zero(), zero()]),
        }
    }
}

/// An error about a point whose path is asked for.
pub(super) fn no_path(mechanism: &Mechanism, traced: &TracedPoint) -> MechanismError {
    let names: Vec<String> = match &mechanism.body {
        Body::Linkage(linkage) => linkage.links.clone(),
        Body::Chain(chain) => (1..chain.joints.len()).map(link_name).collect(),
        Body::Platform(_) => vec![PLATFORM.into()],
        Body::Framework(_) => Vec::new(),
    };
    match names.is_empty() {
        true => {
            mechanism.error("--path is for points of links; a framework has none: leave it out")
        }
        false => mechanism.error(format!(
            "--path {}: there is no such link; there are {}",
            traced.link,
            names.join(", ")
        )),
    }
}

/// Warning for a motion whose equations hold rounded numbers.
pub(super) const ROUNDED: &str = "numbers of the file that are not written in rationals and roots are rounded to doubles: what moves by special dimensions may seem rigid";
