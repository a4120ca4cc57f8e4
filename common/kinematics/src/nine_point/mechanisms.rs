//! Mechanisms: the linkages that can be built, cognates together, best first.

use super::class_record::Found;
use super::realization::{Realization, realizations};
use super::{PathPoints, Point};
use crate::assessment::Assessment;

/// One linkage that passes the nine points.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism {
    /// Where its links are when the coupler point is at each of the nine.
    pub realization: Realization,
    /// Assessment of the mechanism.
    pub assessment: Assessment,
}

/// A coupler curve through the nine points, and the linkages that draw it.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Index of the curve's symmetry class.
    pub class: usize,
    /// How many classes end here: 1, or more where the solution is singular.
    pub classes: usize,
    /// The solution that it was made from.
    pub solution: Point,
    /// Whether the linkage is proved to exist, to be alone and to be real.
    pub certified: bool,
    /// Cognates of the linkage, best first: three, or fewer where some are at infinity.
    pub linkages: Vec<Mechanism>,
}

impl Mechanism {
    /// Whether it stands before another one.
    fn order(&self, other: &Self) -> std::cmp::Ordering {
        self.assessment.order(&other.assessment)
    }
}

/// The real curves among the solutions, best first: by grade, then by quality.
pub fn curves(solutions: &[Found], points: &PathPoints) -> Vec<Curve> {
    let real = solutions.iter().filter(|f| f.arrived.real == Some(true));
    let mut curves: Vec<Curve> = real
        .map(|solution| {
            let made = realizations(&solution.arrived.point, points).into_iter();
            let mut linkages: Vec<Mechanism> = made
                .map(|realization| Mechanism {
                    assessment: Assessment::new(&realization.poses),
                    realization,
                })
                .collect();
            linkages.sort_by(Mechanism::order);
            Curve {
                class: solution.class,
                classes: solution.classes,
                solution: solution.arrived.point,
                certified: solution.arrived.certified_real,
                linkages,
            }
        })
        .filter(|curve| !curve.linkages.is_empty())
        .collect();
    curves.sort_by(|one, two| one.linkages[0].order(&two.linkages[0]));
    curves
}

/// A linkage's name: its curve's place in the list, from 1, and a letter.
pub fn name(curve: usize, linkage: usize) -> String {
    let letter = ["a", "b", "c"].get(linkage).copied().unwrap_or("x");
    format!("{}{letter}", curve + 1)
}
