//! Random linkages and positions of them, for this crate's tests.

use crate::linkage::Linkage;
use crate::plane::modulus;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Complex;
use cognate_systems::evaluation::{Evaluate, Interpreter};
use cognate_systems::system::System;
use num_complex::Complex64;

/// A linkage somewhere in the plane; every type comes up.
pub fn random_linkage(seed: u64) -> Linkage {
    let mut random = RandomStream::new(seed, Purpose::Test, 1);
    let mut place = |size: f64| random.disc() * size;
    let pivots = [place(1.0), place(2.0)];
    let joints = [pivots[0] + place(1.5), pivots[1] + place(2.0)];
    Linkage {
        pivots,
        joints,
        point: joints[0] + place(2.0),
    }
}

/// Where circles meet: one of the two points, by its side; `None` where they do not.
pub fn meeting(p: Complex64, r: f64, q: Complex64, s: f64, left: bool) -> Option<Complex64> {
    let way = q - p;
    let distance = modulus(way);
    let along = (distance * distance + r * r - s * s) / (2.0 * distance);
    let across = (r * r - along * along).sqrt();
    if across.is_nan() {
        return None;
    }
    let across = if left { across } else { -across };
    Some(p + way / distance * Complex64::new(along, across))
}

/// The position where side A points there; `None` where it cannot.
pub fn position(linkage: &Linkage, direction: Complex64, left: bool) -> Option<Linkage> {
    let lengths = linkage.lengths();
    let first = linkage.pivots[0] + direction * lengths.sides[0];
    let second = meeting(
        first,
        lengths.coupler,
        linkage.pivots[1],
        lengths.sides[1],
        left,
    )?;
    let shape = (linkage.point - linkage.joints[0]) / (linkage.joints[1] - linkage.joints[0]);
    Some(Linkage {
        pivots: linkage.pivots,
        joints: [first, second],
        point: first + (second - first) * shape,
    })
}

/// Positions of a linkage, itself first. A third of the seeds keep the side of the coupler; a third
/// stay near the first direction, too.
pub fn at_points(linkage: &Linkage, seed: u64, count: usize) -> Vec<Linkage> {
    let mut random = RandomStream::new(seed, Purpose::Test, 2);
    let radius = linkage.joints[0] - linkage.pivots[0];
    let first = radius / modulus(radius);
    let reaches_linkage = |left: bool| {
        let there = position(linkage, first, left);
        there.is_some_and(|there| modulus(there.joints[1] - linkage.joints[1]) < 1e-6)
    };
    let side = reaches_linkage(true);
    let mut poses = vec![*linkage];
    while poses.len() < count {
        let (direction, left) = match seed % 3 {
            0 => (random.unit(), random.bits() & 1 == 1),
            1 => (random.unit(), side),
            _ => {
                let near = first + random.unit() * 0.7;
                (near / modulus(near), side)
            }
        };
        poses.extend(position(linkage, direction, left));
    }
    poses
}

/// The largest value of a system's equations there.
pub fn residual(system: &System, solution: &[Complex64], parameters: &[Complex64]) -> f64 {
    let native = |values: &[Complex64]| -> Vec<Complex<f64>> {
        let values = values.iter();
        values.map(|z| Complex { re: z.re, im: z.im }).collect()
    };
    let sizes = (solution.len(), parameters.len());
    let program = Interpreter::compile(&system.expressions, &system.equations, sizes.0, sizes.1);
    let mut scratch = Evaluate::<f64>::scratch(&program, ());
    let mut out = vec![Complex { re: 0.0, im: 0.0 }; system.equations.len()];
    program.value(
        &native(solution),
        &native(parameters),
        &mut out,
        &mut scratch,
    );
    let sizes = out.iter().map(|z| modulus(Complex64::new(z.re, z.im)));
    sizes.fold(0.0, f64::max)
}
