//! From a real solution to a linkage and its nine positions in the plane.

use super::cognates::cognates;
use super::{PathPoints, Point};
use crate::linkage::Linkage;
use crate::plane::{cross, modulus, unit};
use num_complex::Complex64;

/// Below this the rotation that two equations give is not trusted; see [`rotation`].
const SURE: f64 = 1e-4;

/// How far a solution is from its own conjugate (X from the conjugate of x, and so on), relative
/// to its largest coordinate: 0 for a real linkage.
pub fn imaginary_part(point: &Point) -> f64 {
    let size = point.iter().map(|&z| modulus(z)).fold(0.0, f64::max);
    let pairs = point.chunks_exact(2);
    pairs
        .map(|p| modulus(p[1] - p[0].conj()))
        .fold(0.0, f64::max)
        / size
}

/// A real solution without its rounding: every capital is the conjugate of its letter.
pub fn made_real(point: &Point) -> Point {
    std::array::from_fn(|k| {
        let mean = (point[k] + point[k ^ 1].conj()) / 2.0;
        // Halves of sums that round alike: the pair is exactly conjugate.
        if k % 2 == 0 {
            mean
        } else {
            ((point[k ^ 1] + point[k].conj()) / 2.0).conj()
        }
    })
}

/// A linkage in its nine positions.
#[derive(Clone, Debug, PartialEq)]
pub struct Realization {
    /// The linkage at point 1, 2, ..., 9: pivots and lengths are the same in all.
    pub poses: Vec<Linkage>,
    /// The largest error of a link's length in any of them, relative to the points' extent.
    pub error: f64,
}

/// The linkages of a real solution: itself and its cognates, those that are finite.
pub fn realizations(point: &Point, points: &PathPoints) -> Vec<Realization> {
    let members = cognates(&made_real(point));
    let made = members.iter().map(|member| realization(member, points));
    made.flatten().collect()
}

/// One linkage in its nine positions; `None` where it is not finite.
pub fn realization(member: &Point, points: &PathPoints) -> Option<Realization> {
    let [x, _, a, _, y, _, b, _] = *member;
    let pivots = [points.place(a), points.place(b)];
    let [x, y] = [x, y].map(|z| z * points.scale());
    let plane = points.plane();
    let first = Linkage {
        pivots,
        joints: [plane[0] + x, plane[0] + y],
        point: plane[0],
    };
    let finite = |z: &Complex64| z.re.is_finite() && z.im.is_finite();
    if !first.pivots.iter().chain(&first.joints).all(finite) {
        return None;
    }
    let mut poses = vec![first];
    for &point in &plane[1..] {
        let turned = rotation(&first, point);
        poses.push(Linkage {
            pivots,
            joints: [point + x * turned, point + y * turned],
            point,
        });
    }
    let lengths = first.lengths();
    let error = poses
        .iter()
        .map(|pose| misfit(pose, lengths.sides))
        .fold(0.0, f64::max);
    Some(Realization {
        poses,
        error: error / points.extent(),
    })
}

/// How far the sides are from their lengths.
fn misfit(pose: &Linkage, sides: [f64; 2]) -> f64 {
    let errors = [0, 1].map(|k| (modulus(pose.joints[k] - pose.pivots[k]) - sides[k]).abs());
    errors[0].max(errors[1])
}

/// By how much the coupler has turned when its point is there: a unit vector.
///
/// Each side gives an equation linear in the turned unit vector t, |p + v t - q| = r with v the
/// arm, q the pivot: 2 Re(conj(p - q) v t) = r^2 - |v|^2 - |p - q|^2. Two such equations have one
/// solution where their determinant is not 0; else one of the two that the first equation
/// has together with |t| = 1.
pub(crate) fn rotation(first: &Linkage, point: Complex64) -> Complex64 {
    let equations = [0, 1].map(|k| {
        let arm = first.joints[k] - first.point;
        let radius = first.joints[k] - first.pivots[k];
        let way = point - first.pivots[k];
        let factor = way * arm.conj();
        // Re(conj(factor) t) = right, with conj(conj(way) arm) = way conj(arm).
        let right = (radius.norm_sqr() - arm.norm_sqr() - way.norm_sqr()) / 2.0;
        let size = modulus(factor);
        (factor / size, right / size)
    });
    let [(f, p), (g, q)] = equations;
    let determinant = cross(f, g);
    let misfit = |t: &Complex64| {
        let pose = Linkage {
            joints: [0, 1].map(|k| point + (first.joints[k] - first.point) * t),
            point,
            ..*first
        };
        misfit(&pose, first.lengths().sides)
    };
    let mut candidates = Vec::with_capacity(5);
    if determinant.abs() > SURE {
        let solution = Complex64::new(p * g.im - q * f.im, q * f.re - p * g.re) / determinant;
        candidates.push(unit(solution));
    }
    for (f, p) in equations {
        let rest = (1.0 - p * p).max(0.0).sqrt();
        candidates.extend([1.0, -1.0].map(|sign| unit(f * Complex64::new(p, sign * rest))));
    }
    let numbers = candidates
        .into_iter()
        .filter(|t| t.re.is_finite() && t.im.is_finite());
    let best = numbers.min_by(|s, t| misfit(s).total_cmp(&misfit(t)));
    best.unwrap_or(Complex64::new(1.0, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_linkages::{at_points, random_linkage};

    #[test]
    fn a_linkage_is_found_in_its_nine_positions() {
        for seed in 0..200 {
            let linkage = random_linkage(seed);
            let poses = at_points(&linkage, seed, 9);
            let plane: Vec<Complex64> = poses.iter().map(|p| p.point).collect();
            let points = PathPoints::real(&plane.try_into().expect("nine")).expect("points");
            let z = |w: Complex64| w / points.scale();
            let (x, y) = (
                z(poses[0].joints[0] - poses[0].point),
                z(poses[0].joints[1] - poses[0].point),
            );
            let (a, b) = (
                z(poses[0].pivots[0] - poses[0].point),
                z(poses[0].pivots[1] - poses[0].point),
            );
            let member = [x, x.conj(), a, a.conj(), y, y.conj(), b, b.conj()];
            assert!(imaginary_part(&member) < 1e-15);
            let made = realization(&member, &points).expect("it is finite");
            assert!(made.error < 1e-9, "seed {seed}: {:e}", made.error);
            for (k, (made, pose)) in made.poses.iter().zip(&poses).enumerate() {
                for side in 0..2 {
                    let error = modulus(made.joints[side] - pose.joints[side]);
                    assert!(error < 1e-6, "seed {seed}, pose {k}: {error:e}");
                }
            }
            // The cognates of the linkage pass through the same points.
            let family = realizations(&member, &points);
            assert_eq!(family.len(), 3);
            let worst = family.iter().map(|r| r.error).fold(0.0, f64::max);
            assert!(worst < 1e-7, "seed {seed}: {worst:e}");
        }
    }
}
