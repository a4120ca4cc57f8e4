//! Closed forms: all postures of an arm of six turning joints whose axes meet or are parallel as those of most arms do, by a few
//! quadratic equations and one of degree 4.
//!
//! [`ClosedForm`] tells from the screws of the joints whether an arm has one; each decomposition is a file and a line
//! of [`DECOMPOSITIONS`]. Postures are believed only if they are beyond doubt: every posture is brought to the digits
//! of the pose by Newton's method on the arm, no two are nearly one, none is nearly singular, and they are as many as
//! the arm has at a general pose. Any other pose is left to paths (`prepared_mechanism`).

mod circle;
mod condition;
mod newton;
mod number;
mod parallel_axes;
pub(crate) mod quartic;
mod six_turns;
mod spherical_wrist;
#[cfg(test)]
mod test_arms;
mod turn;
mod two_circles;

use super::postures::{Counts, Position, Postures, Route, sort, violated};
use super::special_pose::NEARLY_REAL;
use cognate_kinematics::compile::six_joint_arm::SixJointArm;
use cognate_kinematics::compile::{ArmFormulation, Target};
use cognate_kinematics::mechanism::Mechanism;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use newton::{Polished, polished};
use six_turns::{InnerArm, SixTurns, mirrored_turns};
use turn::{Turn, Turns};

/// Postures that differ by less than this may be one.
const APART: f64 = 1e-5;
/// Postures with a condition number above this are left to paths.
const WORST_CONDITION: f64 = 1e6;
/// Postures whose cosines and sines are larger than this are left to paths: the digits of the pose do not decide them.
const LARGEST: f64 = 1e4;

/// How the postures of a kind of arms come apart into problems with closed forms.
#[derive(Debug)]
struct Decomposition {
    /// Geometric property that defines the kind of arms, in words.
    name: &'static str,
    /// Whether it is seen from the hand: the arm is mirrored before all else.
    is_mirrored: bool,
    fits: fn(&SixTurns) -> bool,
    postures: fn(&SixTurns, &Pose) -> Option<Vec<Turns>>,
}

/// All decompositions; the first that fits is taken.
static DECOMPOSITIONS: [Decomposition; 4] = [
    Decomposition {
        name: "spherical wrist",
        is_mirrored: false,
        fits: spherical_wrist::fits,
        postures: spherical_wrist::postures,
    },
    Decomposition {
        name: "axes 2, 3 and 4 parallel",
        is_mirrored: false,
        fits: parallel_axes::fits,
        postures: parallel_axes::postures,
    },
    Decomposition {
        name: "spherical shoulder",
        is_mirrored: true,
        fits: spherical_wrist::fits,
        postures: spherical_wrist::postures,
    },
    Decomposition {
        name: "axes 3, 4 and 5 parallel",
        is_mirrored: true,
        fits: parallel_axes::fits,
        postures: parallel_axes::postures,
    },
];

/// An arm whose postures have a closed form.
pub struct ClosedForm {
    decomposition: &'static Decomposition,
    inner: InnerArm,
    /// The arm as the decomposition sees it.
    seen: SixTurns,
}

impl ClosedForm {
    /// Of an arm of which whole poses are asked; `None` where there is none.
    pub fn of(arm: &SixJointArm) -> Option<Self> {
        if !arm.is_chain() {
            return None;
        }
        let inner = InnerArm::of(&arm.arm)?;
        let mirrored = inner.arm.mirrored();
        let seen = |decomposition: &Decomposition| match decomposition.is_mirrored {
            true => mirrored,
            false => inner.arm,
        };
        let mut decompositions = DECOMPOSITIONS.iter();
        let decomposition = decompositions.find(|kind| (kind.fits)(&seen(kind)))?;
        Some(Self {
            seen: seen(decomposition),
            decomposition,
            inner,
        })
    }

    /// Geometric property of the arm that gives it a closed form, in words.
    pub fn name(&self) -> &'static str {
        self.decomposition.name
    }

    /// The postures at a pose, each brought to the digits of the pose; `None` where one is in doubt.
    fn postures(&self, pose: &Pose) -> Option<Vec<Polished>> {
        let arm = &self.inner.arm;
        let hand = self.inner.hand(pose);
        let is_mirrored = self.decomposition.is_mirrored;
        let seen = match is_mirrored {
            true => arm.mirrored_hand(&hand),
            false => hand,
        };
        let turns = (self.decomposition.postures)(&self.seen, &seen)?;
        let mut postures: Vec<Polished> = Vec::with_capacity(turns.len());
        for turns in turns {
            let turns = match is_mirrored {
                true => mirrored_turns(&turns),
                false => turns,
            };
            let posture = polished(arm, &hand, &turns, self.inner.tool)?;
            if is_doubtful(&posture) || postures.iter().any(|other| are_near(other, &posture)) {
                return None;
            }
            postures.push(posture);
        }
        Some(postures)
    }

    /// The values of the joints in all postures, each with its condition number; `None` as for an answer.
    pub fn values(&self, pose: &Pose, here: u64) -> Option<Vec<(Vec<JointValue>, f64)>> {
        let postures = self
            .postures(pose)
            .filter(|solutions| solutions.len() as u64 == here)?;
        let values = postures.iter();
        let values = values.map(|posture| (self.inner.values(&posture.turns), posture.condition));
        Some(values.collect())
    }

    /// The answer at a pose; `None` where it is in doubt, or has another number of postures than the arm at a general pose.
    pub fn answer(
        &self,
        mechanism: &Mechanism,
        formulation: &dyn ArmFormulation,
        pose: &Pose,
        here: u64,
    ) -> Option<Postures> {
        let postures = self
            .postures(pose)
            .filter(|solutions| solutions.len() as u64 == here)?;
        let positions = postures.iter().map(|posture| {
            let values = self.inner.values(&posture.turns);
            let configuration = formulation.position(&values, pose);
            let is_real = is_real(&posture.turns);
            Position {
                violated: match is_real {
                    true => violated(mechanism, &configuration),
                    false => Vec::new(),
                },
                configuration,
                is_real,
                certified: None,
                condition: posture.condition,
                is_singular: false,
                multiplicity: 1,
                dependent: Vec::new(),
                point: Vec::new(),
            }
        });
        let mut positions: Vec<Position> = positions.collect();
        sort(&mut positions);
        let real = positions.iter().filter(|position| position.is_real);
        let within_limits = real.clone().filter(|position| position.violated.is_empty());
        Some(Postures {
            target: Target::Pose(*pose),
            held: Vec::new(),
            counts: Counts {
                complex: here,
                real: real.clone().count() as u64,
                within_limits: within_limits.count() as u64,
                ..Counts::default()
            },
            positions,
            sets: Vec::new(),
            settled: true,
            warnings: Vec::new(),
            route: Route::ClosedForm(self.name()),
        })
    }
}

/// Whether all turns are real: decompositions make them so exactly.
fn is_real(turns: &Turns) -> bool {
    turns.iter().all(|turn| turn.imaginary() == 0.0)
}

/// Whether a posture is nearly singular, far from real ones, or nearly real and not real.
fn is_doubtful(posture: &Polished) -> bool {
    let imaginary = posture.turns.iter().map(Turn::imaginary);
    let imaginary = imaginary.fold(0.0, f64::max);
    let size = posture.turns.iter().map(Turn::size).fold(1.0, f64::max);
    let is_clear = posture.condition < WORST_CONDITION
        && size < LARGEST
        && (imaginary == 0.0 || imaginary >= NEARLY_REAL);
    !is_clear
}

/// Whether two postures may be one.
fn are_near(one: &Polished, other: &Polished) -> bool {
    one.turns.iter().zip(&other.turns).all(|(a, b)| {
        let border = APART * a.size();
        (a.c - b.c).norm_sqr() + (a.s - b.s).norm_sqr() < border * border
    })
}
