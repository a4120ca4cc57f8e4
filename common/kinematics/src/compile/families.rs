//! Families of which the solutions of a general member are part of the program: every member is reached from there.

use super::formulation::KnownMember;
use super::text::Equations;
use super::{serial, six_revolute};
use num_complex::Complex64;

/// A family that is solved already.
#[derive(Clone, Copy, Debug)]
pub struct SolvedFamily {
    /// Name of the family, and of the folder of the family in `deploy/families`.
    pub name: &'static str,
    /// Description of the mechanisms that belong to the family.
    pub members: &'static str,
    /// Positions of a general member.
    pub number: u64,
    /// Publication that gives the number of positions.
    pub source: &'static str,
    /// Makes the equations of the family.
    pub equations: fn() -> Equations,
    /// The general member that is kept, with its positions.
    pub known_member: fn() -> Option<KnownMember>,
    /// Whether a solution of the equations is a position at these parameters.
    pub is_position: fn(&[Complex64], &[Complex64]) -> bool,
}

/// All families whose number of positions is published.
pub const SOLVED: [SolvedFamily; 1] = [SolvedFamily {
    name: "six_revolute",
    members: "arms and loops of six turning joints, a pose of the hand given",
    number: 16,
    source: "Raghavan and Roth 1993",
    equations: six_revolute::equations,
    known_member: six_revolute::known_member,
    is_position: serial::is_position,
}];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_members_that_are_kept_have_their_numbers_of_positions() {
        for family in SOLVED {
            let member = (family.known_member)().expect(family.name);
            let dimension = (family.equations)().variables().len();
            let points: Vec<&[Complex64]> = member.points.chunks(dimension).collect();
            assert_eq!(points.len() as u64, family.number, "{}", family.name);
            for (k, point) in points.iter().enumerate() {
                assert!(
                    (family.is_position)(&member.parameters, point),
                    "{}: {k}",
                    family.name
                );
                assert!(!points[..k].contains(point), "{}: {k}", family.name);
            }
        }
    }
}
