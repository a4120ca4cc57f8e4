//! Approximate synthesis against answers of other programs.

use super::angle_pairs::function_generators;
use super::dyads::{PlanarPose, dyads};
use super::path_points::path_linkages;
use super::{exact_direction, stationary_points};
use cognate_kinematics::coupler_curve::circuits;
use cognate_kinematics::linkage::Linkage;
use cognate_kinematics::plane::{direction, unit};
use cognate_solutions::critical::Kind;
use num_complex::Complex64;

/// Eight poses: places, and directions before they are made unit.
const POSES: [[f64; 4]; 8] = [
    [0.0, 0.0, 1.0, 0.0],
    [0.5, 0.2, 99.0, 20.0],
    [1.0, 0.6, 12.0, 5.0],
    [1.4, 1.2, 21.0, 20.0],
    [1.5, 2.0, 3.0, 4.0],
    [1.3, 2.6, 7.0, 24.0],
    [0.8, 3.0, 0.0, 1.0],
    [0.2, 3.2, -5.0, 12.0],
];

/// Seven pairs of angles of crank and rocker, in radians.
#[allow(clippy::approx_constant)] // Four digits that were given, not pi/6.
const PAIRS: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [0.2, 0.3043],
    [0.4, 0.392],
    [0.6, 0.5236],
    [0.8, 0.7652],
    [1.0, 0.8535],
    [1.2, 0.858],
];

fn is_near(value: f64, expected: f64, relative: f64) -> bool {
    (value - expected).abs() <= relative * expected.abs()
}

#[test]
fn directions_are_exact_points_of_the_circle() {
    for k in 0..24 {
        let angle = direction(15.0 * f64::from(k));
        let [cosine, sine] = exact_direction(angle);
        let text = format!("unknowns: x, y\nx = {cosine}\ny = {sine}\n");
        let points = stationary_points(&text, 1).expect("a solution");
        let point = &points.real[0];
        assert!((point[0] - angle.re).abs() < 1e-15, "{k}");
        assert!((point[1] - angle.im).abs() < 1e-15, "{k}");
    }
}

/// Number of stationary points: length of the gradient's ideal by Singular modulo 32003; the minima: the positive definite
/// ones among real solutions by Singular's solver.
#[test]
fn eight_poses_have_two_dyads_that_miss_them_least() {
    let pose = |[x, y, c, s]: [f64; 4]| PlanarPose {
        place: Complex64::new(x, y),
        direction: unit(Complex64::new(c, s)),
    };
    let answer = dyads(&POSES.map(pose), 1).expect("dyads");
    assert!(answer.doubts.is_empty(), "{:?}", answer.doubts);
    assert_eq!(answer.stationary.complex, 25);
    let minima = answer.dyads.iter().filter(|d| d.kind == Kind::Minimum);
    let minima: Vec<_> = minima.collect();
    assert_eq!(minima.len(), 2, "{answer:?}");
}

/// By Levenberg and Marquardt's method from 400 starts of the offsets, by another program.
#[test]
fn seven_pairs_of_angles_have_one_linkage() {
    let degrees = |angle: f64| angle * (180.0 / std::f64::consts::PI);
    let pairs = PAIRS.map(|pair| pair.map(|angle| direction(degrees(angle))));
    let answer = function_generators(&pairs, 1).expect("linkages");
    assert!(answer.doubts.is_empty(), "{:?}", answer.doubts);
    let best = answer.linkages.first().expect("a linkage");
    assert_eq!(best.kind, Kind::Minimum);
    assert!(
        is_near(best.error, 2.750_040_437_541_155_8e-5, 1e-3),
        "{best:?}"
    );
    assert!(
        is_near(best.crank, -2.623_374_603_204_212, 1e-6),
        "{best:?}"
    );
    assert!(
        is_near(best.rocker, -3.128_297_647_970_102_3, 1e-6),
        "{best:?}"
    );
    assert!(
        is_near(best.coupler, 0.498_250_045_061_849_9, 1e-6),
        "{best:?}"
    );
    assert!(
        is_near(best.crank_offset, -0.557_692_836_900_182_9, 1e-6),
        "{best:?}"
    );
    let minima = answer.linkages.iter().filter(|l| l.kind == Kind::Minimum);
    assert_eq!(minima.count(), 1);
}

/// Points of a linkage's own curve: the error can be 0.
#[test]
fn points_of_a_coupler_curve_are_passed() {
    let linkage = Linkage {
        pivots: [Complex64::new(0.0, 0.0), Complex64::new(2.0, 0.0)],
        joints: [Complex64::new(0.0, 0.8), Complex64::new(2.6, 1.7)],
        point: Complex64::new(1.6, 2.1),
    };
    let curve = &circuits(&linkage)[0].points;
    let points: Vec<Complex64> = curve
        .iter()
        .step_by(curve.len() / 12)
        .take(12)
        .copied()
        .collect();
    let answer = path_linkages(&points, 400, 1, 2).expect("linkages");
    let best = answer.linkages.first().expect("a local minimum");
    // Samples of the curve are points of it to rounding.
    assert!(best.error < 1e-3, "{best:?}");
    assert!(
        answer
            .linkages
            .iter()
            .all(|linkage| linkage.kind == Kind::Minimum)
    );
}
