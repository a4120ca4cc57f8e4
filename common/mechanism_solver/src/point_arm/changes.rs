//! Changes of posture of an arm of three joints: whether there is one without a singularity.
//!
//! A simple cusp proves that there is one (P. Wenger 1992). That there is none is settled for arms whose postures are told by the
//! signs of two derivatives, and for arms of three turns with a smooth singular curve and no cusp.

use super::contracted_lines::contracted_lines;
use super::cusps::cusps;
use super::plane_map::PlaneMap;
use super::posture_polynomial::{Elimination, eliminated};
use cognate_kinematics::mechanism::Mechanism;

/// Why there is a change of posture without a singularity, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Around a simple cusp two postures are joined.
    Cusp,
    /// A combination of the coordinates depends on the third joint alone: signs of two derivatives tell the postures.
    ThirdJointAlone,
    /// The postures follow from an equation of degree 2 in a function that is even about a value of the third joint.
    Even,
    /// Three shifts: there is one posture.
    OnePosture,
    /// The singular curve is smooth and its image has no cusp (D. Salunkhe, C. Spartalis, J. Capco, D. Chablat, P. Wenger 2022).
    NoCusp,
}

impl Reason {
    /// The reason in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Cusp => "around a cusp a posture becomes another one",
            Self::ThirdJointAlone => {
                "one coordinate depends on the third joint alone, and signs of two derivatives tell the postures"
            }
            Self::Even => {
                "an equation of degree 2 gives the postures, and signs of two derivatives tell them"
            }
            Self::OnePosture => "each point has one posture",
            Self::NoCusp => "the singular curve is smooth and its image has no cusp",
        }
    }
}

/// Singular positions of an arm, and whether it changes its posture without a singularity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PostureChanges {
    /// Dimension of the set of singular positions in the joints: 3 where all are singular, -1 where none is.
    pub dimension: i64,
    /// Number of cusps of the critical values; `None` in doubt.
    pub cusps: Option<u64>,
    /// The cusps, in the coordinates that `coordinates` names.
    pub places: Vec<[f64; 2]>,
    /// Two coordinates of the point that the first joint does not change, in words.
    pub coordinates: &'static str,
    /// Whether a posture changes without a singularity; `None` in doubt.
    pub cuspidal: Option<bool>,
    /// The theorem or observation that decides `cuspidal`.
    pub reason: Option<Reason>,
    /// Doubts about the answer.
    pub doubts: Vec<String>,
}

/// Whether an arm of three joints that places a point changes its posture without a singularity; `None` for other mechanisms.
pub fn posture_changes(mechanism: &Mechanism, seed: u64) -> Option<PostureChanges> {
    let map = PlaneMap::of(mechanism)?;
    let changes = if map.determinant.is_zero() {
        Ok(PostureChanges {
            dimension: 3,
            doubts: vec![
                "all positions are singular: there are no critical values to speak of".into(),
            ],
            ..PostureChanges::default()
        })
    } else if map.determinant.is_constant() {
        Ok(PostureChanges {
            dimension: -1,
            cusps: Some(0),
            cuspidal: Some(false),
            reason: Some(Reason::OnePosture),
            ..PostureChanges::default()
        })
    } else {
        of_curve(&map, seed)
    };
    Some(changes.unwrap_or_else(|doubt| PostureChanges {
        dimension: 2,
        doubts: vec![doubt],
        ..PostureChanges::default()
    }))
}

/// Posture changes of an arm whose singular positions have a curve in the second and third joint.
fn of_curve(map: &PlaneMap, seed: u64) -> Result<PostureChanges, String> {
    let mut changes = PostureChanges {
        dimension: 2,
        coordinates: match map.first_turns {
            true => "distance from the first axis, height along it",
            false => "across the first shift",
        },
        ..PostureChanges::default()
    };
    let lines = contracted_lines(map)?;
    let cusps = cusps(map, &lines, seed)?;
    changes.places = cusps.cusps.iter().map(|cusp| cusp.place).collect();
    changes
        .places
        .sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    changes.cusps = cusps.doubts.is_empty().then_some(cusps.cusps.len() as u64);
    changes.doubts.extend(cusps.doubts.iter().cloned());
    let reason = if cusps.cusps.is_empty() {
        let is_smooth = cusps.crossings == 0 && lines.values.is_empty();
        without_cusps(map, changes.cusps == Some(0) && is_smooth)
    } else {
        Ok(Reason::Cusp)
    };
    match reason {
        Ok(reason) => {
            changes.reason = Some(reason);
            changes.cuspidal = Some(reason == Reason::Cusp);
        }
        Err(doubt) => changes.doubts.push(doubt),
    }
    Ok(changes)
}

/// Why an arm without cusps does not change its posture; an error gives the doubt.
fn without_cusps(map: &PlaneMap, is_generic: bool) -> Result<Reason, String> {
    let elimination = eliminated(map);
    let is_even = match &elimination {
        Elimination::ThirdJointAlone => return Ok(Reason::ThirdJointAlone),
        Elimination::Doubtful => None,
        Elimination::Polynomial(polynomial) => polynomial.is_even(),
    };
    if is_even == Some(true) {
        return Ok(Reason::Even);
    }
    if map.first_turns && map.turns == [true, true] && is_generic {
        return Ok(Reason::NoCusp);
    }
    Err("there is no cusp, but the arm is special: whether a posture changes without a singularity is not decided in this version".into())
}
