//! Lines of two cylinder joints whose directions are known.
//!
//! A line with direction u through x has the moment m = x x u. Angle and distance of two lines are equal in two poses where
//! the products u.v and u.n + m.v are (m, n the moments). A displacement takes the moment n of a line of direction v to
//! R n + d x R v, so that each pose gives one linear equation in both moments; each moment is at right angles to its
//! direction.

use super::{Displacement, Vector, minus};
use crate::mechanism::pose::{cross, dot};
use cognate_numeric::linear_algebra::least_squares::least_squares;
use num_complex::Complex64;

/// A point and the direction of the ground's line and of the body's; `None` where they are not determined.
pub(super) fn lines(
    displacements: &[Displacement],
    fixed: Vector,
    moving: Vector,
) -> Option<[[Vector; 2]; 2]> {
    let row = |d: &Displacement| {
        let (turned, back) = (d.direction(moving), transposed(d.rotation, fixed));
        let (of_fixed, of_moving) = (minus(turned, moving), minus(back, fixed));
        let right = -dot(fixed, cross(d.shift, turned));
        ([of_fixed, of_moving], right)
    };
    let mut rows: Vec<([Vector; 2], f64)> = displacements.iter().map(row).collect();
    // Small rotations have small rows.
    for (parts, right) in &mut rows {
        let size = parts
            .as_flattened()
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt();
        if size > 0.0 {
            parts.as_flattened_mut().iter_mut().for_each(|x| *x /= size);
            *right /= size;
        }
    }
    rows.push(([fixed, [0.0; 3]], 0.0));
    rows.push(([[0.0; 3], moving], 0.0));
    let column = |k: usize| {
        let entries = rows.iter().map(|(parts, _)| parts.as_flattened()[k]);
        entries.map(Complex64::from).collect()
    };
    let columns: Vec<Vec<Complex64>> = (0..6).map(column).collect();
    let right: Vec<Complex64> = rows.iter().map(|(_, right)| (*right).into()).collect();
    let moments = least_squares(&columns, &right)?;
    let moment = |first: usize| std::array::from_fn(|k| moments[first + k].re);
    // The point of a line that is nearest to the origin is u x m.
    Some([
        [cross(fixed, moment(0)), fixed],
        [cross(moving, moment(3)), moving],
    ])
}

fn transposed(rotation: [Vector; 3], x: Vector) -> Vector {
    std::array::from_fn(|k| (0..3).map(|i| rotation[i][k] * x[i]).sum())
}
