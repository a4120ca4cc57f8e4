//! Linkage: a planar four-bar with its coupler point, at one of its positions.

use crate::plane::{cross, modulus};
use num_complex::Complex64;

/// Lengths are equal where they differ by less than this, relative to the longest: a linkage on
/// the border between two Grashof types.
pub const EQUAL_LENGTHS: f64 = 1e-9;

/// One of the two sides of a four-bar: the pivot on the ground and the link that turns around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// Pivot and joint 0.
    A,
    /// Pivot and joint 1.
    B,
}

impl Side {
    /// Index of the side in arrays of two.
    pub fn index(self) -> usize {
        match self {
            Self::A => 0,
            Self::B => 1,
        }
    }

    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// A four-bar linkage at one of its positions, in the units of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linkage {
    /// Where the two links are held by the ground.
    pub pivots: [Complex64; 2],
    /// Where they hold the coupler.
    pub joints: [Complex64; 2],
    /// The coupler point.
    pub point: Complex64,
}

/// Lengths of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lengths {
    /// Distance of the pivots.
    pub ground: f64,
    /// Distance from each pivot to its joint.
    pub sides: [f64; 2],
    /// Distance of the joints.
    pub coupler: f64,
    /// Distance from each joint to the coupler point.
    pub arms: [f64; 2],
}

/// Mobility of a four-bar by its lengths (Grashof 1883): whether a link turns all the way round against the others, and
/// which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mobility {
    /// The link on this side is the shortest and turns round; the other one rocks.
    CrankRocker(Side),
    /// The ground is the shortest: both sides turn round.
    DoubleCrank,
    /// The coupler is the shortest and turns round; both sides rock.
    DoubleRocker,
    /// No link turns round.
    TripleRocker,
    /// The shortest and the longest together are as long as the other two: it can fold flat.
    ChangePoint,
}

impl Lengths {
    /// Ground, side A, coupler, side B, as they follow around the loop.
    pub fn around(&self) -> [f64; 4] {
        [self.ground, self.sides[0], self.coupler, self.sides[1]]
    }

    /// Grashof type of the linkage.
    pub fn mobility(&self) -> Mobility {
        let around = self.around();
        let least = around.iter().copied().fold(f64::INFINITY, f64::min);
        let most = around.iter().copied().fold(0.0, f64::max);
        let excess = 2.0 * (least + most) - around.iter().sum::<f64>();
        if excess.abs() <= EQUAL_LENGTHS * most {
            Mobility::ChangePoint
        } else if excess > 0.0 {
            Mobility::TripleRocker
        } else if least == self.ground {
            Mobility::DoubleCrank
        } else if least == self.coupler {
            Mobility::DoubleRocker
        } else if least == self.sides[0] {
            Mobility::CrankRocker(Side::A)
        } else {
            Mobility::CrankRocker(Side::B)
        }
    }
}

impl Mobility {
    /// Name of the Grashof type for a linkage that is driven from this side.
    pub fn name(self, driver: Side) -> &'static str {
        match self {
            Self::CrankRocker(crank) if crank == driver => "crank-rocker",
            Self::CrankRocker(_) => "rocker-crank",
            Self::DoubleCrank => "double-crank",
            Self::DoubleRocker => "double-rocker",
            Self::TripleRocker => "triple-rocker",
            Self::ChangePoint => "change-point",
        }
    }

    /// Whether the link on this side can turn all the way round.
    pub fn turns_round(self, side: Side) -> bool {
        self == Self::DoubleCrank || self == Self::CrankRocker(side)
    }

    /// How many circuits it has: closed curves of positions, between which it must be taken
    /// apart. A change-point linkage passes from one to the other where it is flat.
    pub fn circuits(self) -> usize {
        match self {
            Self::CrankRocker(_) | Self::DoubleCrank | Self::DoubleRocker => 2,
            Self::TripleRocker | Self::ChangePoint => 1,
        }
    }
}

impl Linkage {
    /// Lengths of the links.
    pub fn lengths(&self) -> Lengths {
        let between = |p: Complex64, q: Complex64| modulus(p - q);
        Lengths {
            ground: between(self.pivots[0], self.pivots[1]),
            sides: [0, 1].map(|k| between(self.pivots[k], self.joints[k])),
            coupler: between(self.joints[0], self.joints[1]),
            arms: [0, 1].map(|k| between(self.joints[k], self.point)),
        }
    }

    /// The sign of the joint between coupler and the side that is not driven: it changes where
    /// the driver is at a dead centre. 1 and -1; 0 where it is flat.
    pub fn assembly(&self, driver: Side) -> f64 {
        let (driver_index, other) = (driver.index(), driver.other().index());
        let held = self.joints[other];
        sign(self.joints[driver_index] - held, self.pivots[other] - held)
    }

    /// Which circuit this position is on: 1 or -1 where there are two (0 where it is flat), 0
    /// where there is one.
    ///
    /// Where the shortest link turns round, a joint that it does not touch cannot straighten:
    /// the other three lengths do not reach. Its sign tells the circuits apart.
    pub fn circuit(&self) -> f64 {
        match self.lengths().mobility() {
            Mobility::TripleRocker | Mobility::ChangePoint => 0.0,
            // Joint B, between coupler and side B, touches neither ground nor side A.
            Mobility::DoubleCrank | Mobility::CrankRocker(Side::A) => self.assembly(Side::A),
            Mobility::CrankRocker(Side::B) => self.assembly(Side::B),
            // Pivot A, between ground and side A.
            Mobility::DoubleRocker => sign(
                self.pivots[1] - self.pivots[0],
                self.joints[0] - self.pivots[0],
            ),
        }
    }
}

fn sign(z: Complex64, w: Complex64) -> f64 {
    let area = cross(z, w);
    if area == 0.0 { 0.0 } else { area.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lengths(ground: f64, a: f64, coupler: f64, b: f64) -> Lengths {
        Lengths {
            ground,
            sides: [a, b],
            coupler,
            arms: [1.0, 1.0],
        }
    }

    #[test]
    fn types_are_those_of_the_textbook() {
        let types = [
            (lengths(4.0, 1.0, 3.0, 3.5), Mobility::CrankRocker(Side::A)),
            (lengths(4.0, 3.5, 3.0, 1.0), Mobility::CrankRocker(Side::B)),
            (lengths(1.0, 3.0, 4.0, 3.5), Mobility::DoubleCrank),
            (lengths(4.0, 3.0, 1.0, 3.5), Mobility::DoubleRocker),
            (lengths(5.0, 2.0, 3.0, 2.5), Mobility::TripleRocker),
            (lengths(2.0, 1.0, 2.0, 1.0), Mobility::ChangePoint),
        ];
        for (lengths, mobility) in types {
            assert_eq!(lengths.mobility(), mobility, "{lengths:?}");
        }
        assert_eq!(types[0].1.name(Side::A), "crank-rocker");
        assert_eq!(types[0].1.name(Side::B), "rocker-crank");
        assert!(types[2].1.turns_round(Side::B) && !types[3].1.turns_round(Side::A));
    }
}
