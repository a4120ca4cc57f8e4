//! The largest number of postures of a mechanism whose regions are not known: where as many are real at a point as there are
//! complex ones in general, no point has more.

use super::reached_point::ReachedPoint;
use cognate_kinematics::mechanism::chain::{Chain, JointValue};
use cognate_kinematics::mechanism::{Body, LegKind, Mechanism};

/// Points of an arm that are asked for: a cuspidal arm has four postures in a tenth of its reach.
const SAMPLES: u32 = 64;

/// Places of the output of an arm at joint values that are spread evenly; none of another mechanism.
pub fn samples(mechanism: &Mechanism) -> Vec<[f64; 3]> {
    match &mechanism.body {
        Body::Chain(chain) if !chain.closed => (1..=SAMPLES).map(|k| sample(chain, k)).collect(),
        _ => Vec::new(),
    }
}

/// The place of the tool at values of an additive recurrence: parts of multiples of square roots, which fill the cube of values.
fn sample(chain: &Chain, number: u32) -> [f64; 3] {
    let value = |(k, joint): (usize, &cognate_kinematics::mechanism::chain::ChainJoint)| {
        let part = (f64::from(number) * (k as f64 + 2.0).sqrt() * 1.3).fract();
        let extent = match joint.is_angle {
            true => std::f64::consts::PI,
            false => chain.size(),
        };
        JointValue::of_real((2.0 * part - 1.0) * extent, joint.is_angle)
    };
    let values: Vec<JointValue> = chain.joints.iter().enumerate().map(value).collect();
    chain.tool_pose(&values).position.map(|x| x.re)
}

/// The largest number of postures of a point, from answers for some points; an error says why it is not known.
pub fn most_postures(mechanism: &Mechanism, answers: &[ReachedPoint]) -> Result<u64, String> {
    let reached = answers.iter().filter_map(|answer| answer.postures).max();
    let general = match &mechanism.body {
        Body::Platform(platform) => {
            let turned = platform.legs.iter().filter(|leg| match leg.kind {
                LegKind::Strut { .. } => false,
                LegKind::Crank { .. } | LegKind::Slider { .. } => true,
            });
            2u64.checked_pow(turned.count() as u32)
        }
        _ => answers.iter().filter_map(|answer| answer.complex).max(),
    };
    match (reached, general) {
        (Some(reached), Some(general)) if reached == general => Ok(reached),
        (Some(reached), Some(general)) => Err(format!(
            "not decided in this version: {reached} at the points that were asked for, at most {general} anywhere"
        )),
        _ => Err("not decided in this version: no point was asked for".into()),
    }
}
