//! Value of an objective at a real critical point, and whether the conditions let the point take it; values at other points.

use super::general_point::general_point;

/// The value at a real point, and how far it may be from the exact one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Value {
    pub value: f64,
    pub error: f64,
    pub place: Place,
}

impl Value {
    /// Whether this may be the same value.
    pub fn is_near(&self, other: &Self) -> bool {
        (other.value - self.value).abs() <= other.error + self.error
    }

    /// Reason why it is not known whether the value is taken, or values come near it, at points that meet the conditions.
    pub fn doubt(&self) -> Option<String> {
        let value = self.value;
        Some(match self.place {
            Place::Inside | Place::Limit => return None,
            Place::Unknown => format!(
                "it is not known whether the point with the value {value} meets the conditions, or lies outside by \
                 less than its accuracy"
            ),
            Place::OnSet => format!(
                "a positive-dimensional set of critical points has the value {value}, and it is not known whether it \
                 has real points that meet the conditions"
            ),
            Place::Excluded => format!(
                "it is not excluded that values come as near as one likes to {value}, at a point that the conditions \
                 exclude"
            ),
        })
    }
}

/// Place of a real critical point; of equal values the first in this order decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Place {
    /// The point meets all conditions.
    Inside,
    /// It is not known whether the point meets the conditions.
    Unknown,
    /// The value is taken on a set of positive dimension, of which the real points are not known.
    OnSet,
    /// The point meets a condition that excludes equality with equality, and all others; points that meet all are as near
    /// to it as one likes.
    Limit,
    /// The point meets a condition that excludes equality with equality, and all others; it may be isolated from the points
    /// that meet all.
    Excluded,
}

/// A real point that meets the equations and all conditions.
#[derive(Clone, Debug)]
pub(super) struct PointInside {
    /// Value of the objective.
    pub value: f64,
    /// How far the value may be from the exact one.
    pub error: f64,
    /// Values of the unknowns.
    pub unknowns: Vec<f64>,
}

impl PointInside {
    /// The squared distance to the general point.
    pub fn squared_distance(&self) -> f64 {
        let centre = general_point(self.unknowns.len());
        let squares = self.unknowns.iter().zip(&centre);
        squares.map(|(x, p)| (x - p.re.to_f64()).powi(2)).sum()
    }
}

/// Values on a sphere that all critical points and all points where the curve turns back lie in.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValuesOnSphere {
    /// The least value, its error taken off, times the sign of the goal.
    pub least: f64,
    /// Whether the values, times the sign of the goal, grow with the radius at all real points of the curve.
    pub grow: bool,
}
