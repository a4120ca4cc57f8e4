//! One general 6R arm in rational numbers, written twice: as a loop of joints and by its axes.
//!
//! `deploy/examples/six_revolute_loop.bertini` is the loop: from the base through three joints and
//! from the hand back through three is the same frame, twelve equations in the cosines and sines of
//! six joints, and the six circles. Here are its numbers, and twelve equations for the same arm in
//! the directions of its inner axes.

use crate::builders::example;
use crate::systems::{SerialArm, by_axes};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Cosine and sine of the twist from joint k to joint k + 1.
const TWISTS: [[(i32, i32); 2]; 5] = [
    [(3, 5), (4, 5)],
    [(5, 13), (12, 13)],
    [(8, 17), (15, 17)],
    [(7, 25), (24, 25)],
    [(20, 29), (21, 29)],
];
/// Common normals of the axes, and offsets along the next axis.
const LENGTHS: [(i32, i32); 5] = [(4, 5), (6, 5), (3, 4), (5, 7), (2, 3)];
const OFFSETS: [(i32, i32); 5] = [(1, 3), (3, 7), (2, 5), (4, 9), (1, 2)];
/// The hand's axis and its place.
const AXIS: [(i32, i32); 3] = [(22, 39), (26, 39), (19, 39)];
const PLACE: [(i32, i32); 3] = [(7, 5), (-3, 5), (4, 5)];

fn number((p, q): (i32, i32)) -> f64 {
    f64::from(p) / f64::from(q)
}

fn text((p, q): (i32, i32)) -> String {
    format!("({p}/{q})")
}

/// 18 equations in the cosines and sines of the six joints: c1, s1, c2, ..., s6.
pub fn as_a_loop() -> System {
    let content = example("six_revolute_loop.bertini");
    match cognate_systems::formats::read("six_revolute_loop", content.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}

/// 12 equations in the directions of the axes 2 to 5.
pub fn by_its_axes() -> System {
    let z = |k: usize| -> [String; 3] {
        match k {
            1 => ["0", "0", "1"].map(String::from),
            6 => AXIS.map(text),
            k => ["x", "y", "w"].map(|c| format!("{c}{k}")),
        }
    };
    by_axes(&SerialArm {
        axis: &z,
        cosine: &|k| text(TWISTS[k - 1][0]),
        length: &|k| {
            let ((p, q), (sine, over)) = (LENGTHS[k - 1], TWISTS[k - 1][1]);
            text((p * over, q * sine))
        },
        offset: &|k| text(OFFSETS[k - 1]),
        place: &|c| text(PLACE[c]),
    })
}

/// The directions of the axes 2 to 5 where the joints are so, in the order of [`by_its_axes`].
pub fn axes_of(joints: &[Complex64]) -> Vec<Complex64> {
    let (zero, one) = (Complex64::new(0.0, 0.0), Complex64::new(1.0, 0.0));
    type Direction = [Complex64; 3];
    let mix = |a: Direction, p: Complex64, b: Direction, q: Complex64| -> Direction {
        std::array::from_fn(|i| a[i] * p + b[i] * q)
    };
    // Columns of the frame so far.
    let mut frame = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
    let mut axes = Vec::new();
    for k in 0..4 {
        let (c, s) = (joints[2 * k], joints[2 * k + 1]);
        let [cosine, sine] = TWISTS[k].map(|ratio| one * number(ratio));
        let [x, y, z] = frame;
        let (ahead, aside) = (mix(x, c, y, s), mix(x, -s, y, c));
        let next = mix(aside, -sine, z, cosine);
        frame = [ahead, mix(aside, cosine, z, sine), next];
        axes.extend(next);
    }
    axes
}
