//! Question: what is asked about components that are known by their witness sets.

use super::witness_set::WitnessSet;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A point as it was given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GivenPoint {
    /// Values of the variables.
    pub values: Vec<Complex64>,
    /// Error of the point, relative to its size; the rounding error of doubles where the numbers are exact.
    pub accuracy: f64,
}

/// Points of a component that are wanted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SampleWish {
    /// Number of points.
    pub count: u64,
    /// Points near this one.
    pub near: Option<GivenPoint>,
    /// Whether only real points are wanted.
    pub real: bool,
    /// Real points whose variables lie between these, one pair for each variable; empty: anywhere.
    pub within: Vec<[f64; 2]>,
}

/// Settings for following real curves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CurveWish {
    /// Points of each arc, on either side of its middle.
    pub samples: u32,
    /// The variable along which it is followed, of a pair of conjugates its real part; `None`: a random form.
    pub projection: Option<u32>,
    /// Largest distance of the arc from the lines between its points, in the units of the variables; more points are
    /// taken until the distance is not larger. `None`: only the samples.
    pub tolerance: Option<f64>,
    /// Only what lies in this box: lower and upper bound for each variable, of a pair of conjugates for the real part and
    /// for the imaginary part; empty: all of the curve.
    pub within: Vec<[f64; 2]>,
    /// Whether the number of real branches over each slab is proved.
    pub certify: bool,
}

/// The set with which components are intersected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SecondSet {
    /// Number of equations of the first set; they are the first equations of the system.
    pub own: u32,
    /// The second set is of the equations from this place on; 0 where both are of all equations.
    pub from: u32,
    /// Components of the second set; empty: all solutions of its equations.
    pub components: Vec<WitnessSet>,
}

/// A question to all components of a set, or to those that the client chose.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Question {
    /// Whether what was read is whole: traces and multiplicities.
    Check,
    /// Proofs of witness points, and whether they are proved to be different.
    Certify,
    /// On which components each point lies.
    Member {
        /// The points.
        points: Vec<GivenPoint>,
    },
    /// Points of each component.
    Sample(SampleWish),
    /// Dimension and degree of the closure of each component's image in these variables.
    Project {
        /// Indices of the variables.
        onto: Vec<u32>,
    },
    /// Degrees by groups of variables.
    Multidegree,
    /// Number of directions in which a point can be moved, to the first order and to higher ones.
    Mobility {
        /// The points.
        points: Vec<GivenPoint>,
        /// The highest order of motions.
        depth: u32,
    },
    /// The real part of each component of dimension 1.
    RealCurve(CurveWish),
    /// Intersection of each component with a second set.
    Intersect(SecondSet),
    /// The set on each component where the equations have less than their rank.
    SingularLocus,
    /// At least one point on every connected part of the real points of each component.
    RealPoints,
    /// The real part of each component of dimension 2 in space.
    RealSurface {
        /// Sections between two levels on either side of a middle, and points of each strip of a section.
        samples: u32,
    },
}
