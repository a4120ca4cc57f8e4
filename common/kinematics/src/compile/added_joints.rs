//! Chains with fewer free joints than a pose has freedoms: joints are added until there are six, and have to stay at 0.

use crate::mechanism::chain::{Axis, Chain, JointValue};
use cognate_numeric::random::{Purpose, RandomStream};

/// Freedoms of a pose.
pub const FREEDOMS: usize = 6;
/// Number of the random stream of added axes.
const ADDED: u64 = 0x6164_6465;

/// A chain with fewer free joints than a pose has freedoms, and joints behind its tool that make six of them. The axes of
/// these are drawn at random: the arm is general, and its postures in which the added joints stay at 0 are those of the
/// chain. `None` where the axes give no rows.
pub fn extended(chain: &Chain, held: &[Option<f64>]) -> Option<Chain> {
    let values: Vec<f64> = held.iter().map(|value| value.unwrap_or(0.0)).collect();
    let (axes, tool) = chain.axes(&values);
    let free = axes
        .into_iter()
        .zip(held)
        .filter(|(_, held)| held.is_none());
    let mut axes: Vec<Axis> = free.map(|(axis, _)| axis).collect();
    let mut random = RandomStream::new(0, Purpose::Probe, ADDED);
    let mut vector = || -> [f64; 3] { std::array::from_fn(|_| 2.0 * random.uniform() - 1.0) };
    let size = chain.size();
    while axes.len() < FREEDOMS {
        let offset = vector();
        axes.push(Axis {
            name: format!("added {}", axes.len() + 1),
            is_angle: true,
            point: std::array::from_fn(|i| tool.position[i].re + 0.3 * size * offset[i]),
            direction: vector(),
        });
    }
    Chain::of_axes(&axes, tool)
}

/// The name of the family of a chain that was extended.
pub fn extended_name(letters: &str) -> String {
    let added = FREEDOMS - letters.len();
    let joints = if added == 1 {
        "joint that stays"
    } else {
        "joints that stay"
    };
    format!("{letters} and {added} added {joints} at 0")
}

/// Joints that were added stay at 0 within this: a pose of 16 digits is reached to as many.
const AT_REST: f64 = 1e-9;

/// What a solution is called in which added joints move.
pub const OUT_OF_REACH: &str = "out of the chain's reach";

/// Whether the last so many values, those of added joints, are 0.
pub fn at_rest(values: &[JointValue], added: usize) -> bool {
    distance_from_rest(values, added) <= AT_REST
}

/// The largest sine of the last so many values, or infinity where one has turned further than a right angle.
pub fn distance_from_rest(values: &[JointValue], added: usize) -> f64 {
    let last = &values[values.len().saturating_sub(added)..];
    let distance = |value: &JointValue| match value {
        JointValue::Turn(c, s) if c.re > 0.0 => s.norm_sqr().sqrt(),
        JointValue::Turn(..) => f64::INFINITY,
        JointValue::Shift(d) => d.norm_sqr().sqrt(),
    };
    last.iter().map(distance).fold(0.0, f64::max)
}
