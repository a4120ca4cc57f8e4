//! Assessment: what a linkage is worth to somebody who wants to build it.

use crate::drive::Drive;
use crate::linkage::{Lengths, Linkage, Mobility, Side};
use crate::plane::modulus;
use num_complex::Complex64;

/// How well a linkage serves its points, best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Grade {
    /// One side drives it through all points in their order.
    InOrder,
    /// One side drives it through all points, in another order.
    OneBranch,
    /// All points are on one circuit, but no side drives it past all of them: a dead centre lies
    /// between.
    OneCircuit,
    /// It must be taken apart between some of the points.
    TwoCircuits,
}

impl Grade {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::InOrder => "in-order",
            Self::OneBranch => "one-branch",
            Self::OneCircuit => "one-circuit",
            Self::TwoCircuits => "two-circuits",
        }
    }
}

/// Assessment of a four-bar linkage by its positions: lengths, Grashof type, and how well each side drives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// Lengths of its links.
    pub lengths: Lengths,
    /// Grashof type of the linkage.
    pub mobility: Mobility,
    /// All positions are on one circuit.
    pub one_circuit: bool,
    /// Drive from side A, and drive from side B.
    pub drives: [Drive; 2],
    /// The side that drives better, or the side that has to drive.
    pub driver: Side,
    /// How well, driven from there.
    pub grade: Grade,
    /// The diagonal of the box around pivots, joints and points in all positions, in diagonals
    /// of the box around the points.
    pub size: f64,
}

impl Assessment {
    /// Looks at positions of one linkage.
    ///
    /// # Panics
    /// When there is no position.
    pub fn new(poses: &[Linkage]) -> Self {
        let lengths = poses[0].lengths();
        let circuits: Vec<f64> = poses.iter().map(Linkage::circuit).collect();
        let one_circuit = !circuits.contains(&1.0) || !circuits.contains(&-1.0);
        let drives = [Side::A, Side::B].map(|side| Drive::new(poses, side));
        let key = |drive: &Drive| {
            let grade = grade(drive, one_circuit);
            (grade, !drive.turns_round, -drive.transmission_degrees)
        };
        let better = |one: &Drive, two: &Drive| {
            let (one, two) = (key(one), key(two));
            one.partial_cmp(&two).is_none_or(|o| o.is_le())
        };
        let driver = if better(&drives[0], &drives[1]) {
            Side::A
        } else {
            Side::B
        };
        Self {
            lengths,
            mobility: lengths.mobility(),
            one_circuit,
            grade: grade(&drives[driver.index()], one_circuit),
            drives,
            driver,
            size: size(poses),
        }
    }

    /// The assessment of the linkage when it is driven from `side`, for a driver that is not free to choose.
    pub fn driven_from(mut self, side: Side) -> Self {
        self.grade = grade(&self.drives[side.index()], self.one_circuit);
        self.driver = side;
        self
    }

    /// Driven from the side that serves better, or must.
    pub fn drive(&self) -> &Drive {
        &self.drives[self.driver.index()]
    }

    /// Number that ranks linkages of one grade, the larger the better: the transmission angle as a share of 90 degrees,
    /// divided by the size.
    pub fn quality(&self) -> f64 {
        self.drive().transmission_degrees / 90.0 / self.size
    }

    /// Which of two stands first: the better grade, then the better quality.
    pub fn order(&self, other: &Self) -> std::cmp::Ordering {
        let grades = self.grade.cmp(&other.grade);
        grades.then(other.quality().total_cmp(&self.quality()))
    }

    /// Grashof type in words, driven from `driver`.
    pub fn kind(&self) -> &'static str {
        self.mobility.name(self.driver)
    }
}

fn grade(drive: &Drive, one_circuit: bool) -> Grade {
    match (drive.one_branch, drive.in_order) {
        (true, true) => Grade::InOrder,
        (true, false) => Grade::OneBranch,
        _ if one_circuit => Grade::OneCircuit,
        _ => Grade::TwoCircuits,
    }
}

/// The diagonal of the box around everything, in those of the box around the coupler points.
fn size(poses: &[Linkage]) -> f64 {
    let diagonal = |points: &mut dyn Iterator<Item = Complex64>| {
        let start = (
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
        );
        let (left, right, low, high) = points.fold(start, |(l, r, b, t), p| {
            (l.min(p.re), r.max(p.re), b.min(p.im), t.max(p.im))
        });
        modulus(Complex64::new(right - left, high - low))
    };
    let points_of_pose = |pose: &Linkage| {
        let [a, b] = pose.pivots;
        let [p, q] = pose.joints;
        [a, b, p, q, pose.point]
    };
    diagonal(&mut poses.iter().flat_map(points_of_pose))
        / diagonal(&mut poses.iter().map(|pose| pose.point))
}
