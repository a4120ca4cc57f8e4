//! Dyads for more than five poses of a body: a fixed pivot a and a point b of the body whose distance l changes least.
//!
//! The error is the sum over the poses (place p, rotation R) of (|p + R b - a|^2 - l^2)^2. With k = |a|^2 + |b|^2 - l^2
//! each term is the square of k + |p|^2 + 2 p.(R b) - 2 p.a - 2 a.(R b), linear in k and bilinear in a and b, so that the
//! gradient is five polynomials; they have 25 common zeros for eight general poses.

use super::least_squares::add_square;
use super::{
    Frame, Stationary, exact, exact_direction, kind_of, sort_minima_first, stationary_points,
    vanishing_sums,
};
use cognate_solutions::critical::Kind;
use num_complex::Complex64;

/// Number of poses that a dyad can meet exactly.
pub const EXACT_POSES: usize = 5;

/// A pose of a body in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarPose {
    /// Where the body's origin is.
    pub place: Complex64,
    /// The direction of the body's first axis, of length 1.
    pub direction: Complex64,
}

/// A dyad at a stationary point of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dyad {
    /// The pivot, in the ground.
    pub pivot: Complex64,
    /// The joint, in the body.
    pub moving: Complex64,
    /// The length of the link between them.
    pub length: f64,
    /// The sum of squares, in the fourth power of the unit of length.
    pub error: f64,
    /// Kind of the stationary point: minimum, saddle or maximum.
    pub kind: Kind,
}

/// All real stationary points: minima first, each kind by its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Dyads {
    /// The real ones.
    pub dyads: Vec<Dyad>,
    /// How many there are.
    pub stationary: Stationary,
    /// Why the answer is not settled.
    pub doubts: Vec<String>,
}

/// The dyads.
///
/// # Errors
/// In words, where there are too few poses or all of them have one place.
pub fn dyads(poses: &[PlanarPose], seed: u64) -> Result<Dyads, String> {
    if poses.len() <= EXACT_POSES {
        return Err(format!(
            "{} poses are met exactly; expected more than {EXACT_POSES}, or type cognate synthesize body-guidance",
            poses.len()
        ));
    }
    let places: Vec<Complex64> = poses.iter().map(|pose| pose.place).collect();
    let frame = Frame::of(&places)
        .ok_or("the places of the poses are one, or their distances are out of range")?;
    let scaled: Vec<PlanarPose> = poses
        .iter()
        .map(|pose| PlanarPose {
            place: frame.inside(pose.place),
            ..*pose
        })
        .collect();
    let points = stationary_points(&equations(&scaled), seed)?;
    let dyad = |x: &Vec<f64>| {
        let (pivot, moving) = (Complex64::new(x[1], x[2]), Complex64::new(x[3], x[4]));
        let square = pivot.norm_sqr() + moving.norm_sqr() - x[0];
        let residuals = scaled
            .iter()
            .map(|pose| residual(pose, pivot, moving, square));
        let error: f64 = residuals.map(|r| r * r).sum();
        Dyad {
            pivot: frame.outside(pivot),
            moving: moving * frame.unit,
            length: square.max(0.0).sqrt() * frame.unit,
            error: error * frame.unit.powi(4),
            kind: kind_of(&second_derivatives(&scaled, x)),
        }
    };
    let mut dyads: Vec<Dyad> = points.real.iter().map(dyad).collect();
    sort_minima_first(&mut dyads, |dyad| (dyad.kind, dyad.error));
    Ok(Dyads {
        stationary: Stationary {
            complex: points.complex,
            real: dyads.len() as u64,
        },
        dyads,
        doubts: points.doubts,
    })
}

/// |p + R b - a|^2 - l^2.
fn residual(pose: &PlanarPose, pivot: Complex64, moving: Complex64, square: f64) -> f64 {
    (pose.place + pose.direction * moving - pivot).norm_sqr() - square
}

/// The gradient of the error, in k, a and b.
fn equations(poses: &[PlanarPose]) -> String {
    let mut text = String::from("unknowns: k, a1, a2, b1, b2\ngroups: k a1 a2 | b1 b2\n");
    let mut gradient: [Vec<String>; 5] = Default::default();
    for (j, pose) in poses.iter().enumerate() {
        let [c, s] = exact_direction(pose.direction);
        let [x, y] = [pose.place.re, pose.place.im].map(exact);
        let lines = format!(
            "x{j} := {x} + {c}*b1 - {s}*b2\n\
             y{j} := {y} + {s}*b1 + {c}*b2\n\
             f{j} := k + {x}^2 + {y}^2 + 2*{x}*(x{j} - {x}) + 2*{y}*(y{j} - {y}) - 2*a1*x{j} - 2*a2*y{j}\n"
        );
        text.push_str(&lines);
        let factors = [
            "1".to_owned(),
            format!("x{j}"),
            format!("y{j}"),
            format!("({c}*({x} - a1) + {s}*({y} - a2))"),
            format!("({c}*({y} - a2) - {s}*({x} - a1))"),
        ];
        for (terms, factor) in gradient.iter_mut().zip(factors) {
            terms.push(format!("f{j}*{factor}"));
        }
    }
    text + &vanishing_sums(&gradient)
}

/// Second derivatives of half the error by k, a1, a2, b1, b2.
fn second_derivatives(poses: &[PlanarPose], x: &[f64]) -> [[f64; 5]; 5] {
    let (pivot, moving) = (Complex64::new(x[1], x[2]), Complex64::new(x[3], x[4]));
    let square = pivot.norm_sqr() + moving.norm_sqr() - x[0];
    let mut rows = [[0.0; 5]; 5];
    for pose in poses {
        let value = residual(pose, pivot, moving, square);
        let joint = pose.place + pose.direction * moving;
        let back = pose.direction.conj() * (pose.place - pivot);
        let gradient = [
            1.0,
            -2.0 * joint.re,
            -2.0 * joint.im,
            2.0 * back.re,
            2.0 * back.im,
        ];
        add_square(&mut rows, &gradient);
        let (c, s) = (pose.direction.re, pose.direction.im);
        let mixed = [(1, 3, c), (1, 4, -s), (2, 3, s), (2, 4, c)];
        for (i, j, rotation) in mixed {
            rows[i][j] -= 2.0 * value * rotation;
            rows[j][i] -= 2.0 * value * rotation;
        }
    }
    rows
}
