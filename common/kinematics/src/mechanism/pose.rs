//! Poses of bodies: rotation and position in complex numbers, so that complex solutions are checked as real ones
//! are; quaternions, roll-pitch-yaw, and rotations that a file rounds.

use super::exact::{Angle, radians};
use crate::plane::modulus;
use num_complex::Complex64;

/// Rotations of a file may be off by this much; they are projected then.
pub const ROTATION_ERROR: f64 = 1e-6;
/// Rotations of targets may be off by this much, as people type 0.7071; they are projected then, and it is said.
pub const TYPED_ROTATION_ERROR: f64 = 2e-2;

/// A pose as it was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadPose {
    /// The pose.
    pub pose: Pose,
    /// Error of the rotation as it was read: the largest entry of M'M - I, or of a quaternion's square less 1.
    pub rounding: f64,
}

impl ReadPose {
    /// A pose whose rotation is exact.
    pub fn exact(pose: Pose) -> Self {
        Self {
            pose,
            rounding: 0.0,
        }
    }

    /// Warning about the rounding of these poses; `None` if they are exact enough.
    pub fn warning(poses: &[Self]) -> Option<String> {
        let mut rounded = (1..)
            .zip(poses)
            .filter(|(_, pose)| pose.rounding > ROTATION_ERROR);
        let (number, first) = rounded.next()?;
        let others = match rounded.count() {
            0 => String::new(),
            others => format!("; so are {others} others"),
        };
        Some(format!(
            "pose {number}: its rotation is off by {:.1e} from orthogonal vectors of length 1, and the nearest one is taken{others}",
            first.rounding
        ))
    }

    /// From a quaternion [w, x, y, z] of about length 1; the error says by how much its square is off.
    pub fn of_quaternion(q: [f64; 4], position: Vector3) -> Result<Self, String> {
        let square: f64 = q.iter().map(|c| c * c).sum();
        let rounding = (square - 1.0).abs();
        let pose = Pose::of_quaternion(q.map(Complex64::from), position);
        match pose.filter(|_| rounding <= TYPED_ROTATION_ERROR) {
            Some(pose) => Ok(Self { pose, rounding }),
            None => Err(format!(
                "expected a quaternion of length 1, its square is {square}"
            )),
        }
    }

    /// From the rows of about a rotation.
    pub fn of_rows(rows: [[f64; 3]; 3], position: Vector3) -> Result<Self, String> {
        let (rounding, rotation) = nearest_rotation(rows);
        if dot(cross(rows[0], rows[1]), rows[2]) < 0.0 {
            let message = "this is no rotation: its determinant is negative, as that of a reflection is; that of a rotation is 1";
            return Err(message.to_owned());
        }
        if rounding > TYPED_ROTATION_ERROR {
            return Err(format!(
                "this is no rotation: rows are off from orthogonal unit vectors by {rounding:.1e}; at most {TYPED_ROTATION_ERROR:.0e} is rounded away"
            ));
        }
        let pose = Pose {
            position,
            ..Pose::real(rotation, [0.0; 3])
        };
        Ok(Self { pose, rounding })
    }
}

const ZERO: Complex64 = Complex64::new(0.0, 0.0);
const ONE: Complex64 = Complex64::new(1.0, 0.0);

/// A complex vector.
pub type Vector3 = [Complex64; 3];

/// Rotation and position: x -> rotation x + position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation's matrix by rows.
    pub rotation: [[Complex64; 3]; 3],
    /// Image of the origin.
    pub position: Vector3,
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose {
    /// The pose that moves nothing.
    pub const IDENTITY: Self = Self {
        rotation: [[ONE, ZERO, ZERO], [ZERO, ONE, ZERO], [ZERO, ZERO, ONE]],
        position: [ZERO; 3],
    };

    /// A real pose.
    pub fn real(rotation: [[f64; 3]; 3], position: [f64; 3]) -> Self {
        Self {
            rotation: rotation.map(|row| row.map(Complex64::from)),
            position: position.map(Complex64::from),
        }
    }

    /// A shift.
    pub fn shift(
        x: impl Into<Complex64>,
        y: impl Into<Complex64>,
        z: impl Into<Complex64>,
    ) -> Self {
        Self {
            position: [x.into(), y.into(), z.into()],
            ..Self::IDENTITY
        }
    }

    /// The turn about z by cosine and sine.
    pub fn about_z(c: Complex64, s: Complex64) -> Self {
        Self {
            rotation: [[c, -s, ZERO], [s, c, ZERO], [ZERO, ZERO, ONE]],
            ..Self::IDENTITY
        }
    }

    /// The turn about x by cosine and sine.
    pub fn about_x(c: Complex64, s: Complex64) -> Self {
        Self {
            rotation: [[ONE, ZERO, ZERO], [ZERO, c, -s], [ZERO, s, c]],
            ..Self::IDENTITY
        }
    }

    /// Rz(yaw) Ry(pitch) Rx(roll): what URDF calls rpy.
    pub fn of_roll_pitch_yaw(angles: [Angle; 3]) -> Self {
        let [roll, pitch, yaw] = angles.map(|a| a.direction.map(Complex64::from));
        let about_y = Self {
            rotation: [
                [pitch[0], ZERO, pitch[1]],
                [ZERO, ONE, ZERO],
                [-pitch[1], ZERO, pitch[0]],
            ],
            ..Self::IDENTITY
        };
        Self::about_z(yaw[0], yaw[1])
            .then(&about_y)
            .then(&Self::about_x(roll[0], roll[1]))
    }

    /// The rotation of a quaternion [w, x, y, z] of any length; `None` for one of length 0.
    pub fn of_quaternion(q: [Complex64; 4], position: Vector3) -> Option<Self> {
        let [w, x, y, z] = q;
        let square = w * w + x * x + y * y + z * z;
        let size: f64 = q.iter().map(|c| c.norm_sqr()).sum();
        if size == 0.0 || square.norm_sqr() <= 1e-24 * size * size {
            return None;
        }
        let rows = [
            [
                w * w + x * x - y * y - z * z,
                (x * y - w * z) * 2.0,
                (x * z + w * y) * 2.0,
            ],
            [
                (x * y + w * z) * 2.0,
                w * w - x * x + y * y - z * z,
                (y * z - w * x) * 2.0,
            ],
            [
                (x * z - w * y) * 2.0,
                (y * z + w * x) * 2.0,
                w * w - x * x - y * y + z * z,
            ],
        ];
        Some(Self {
            rotation: rows.map(|row| row.map(|c| c / square)),
            position,
        })
    }

    /// The unit quaternion [w, x, y, z] of a real rotation, w >= 0.
    pub fn quaternion(&self) -> [f64; 4] {
        let mut q = self.any_quaternion().map(|c| c.re);
        let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
        q.iter_mut().for_each(|c| *c *= sign / length);
        q
    }

    /// A quaternion [w, x, y, z] of a rotation, real or complex, of any length.
    pub fn any_quaternion(&self) -> [Complex64; 4] {
        let m = &self.rotation;
        let squares = [
            ONE + m[0][0] + m[1][1] + m[2][2],
            ONE + m[0][0] - m[1][1] - m[2][2],
            ONE - m[0][0] + m[1][1] - m[2][2],
            ONE - m[0][0] - m[1][1] + m[2][2],
        ];
        let largest = (0..4).fold(0, |best, i| {
            if squares[i].norm_sqr() > squares[best].norm_sqr() {
                i
            } else {
                best
            }
        });
        let mixed = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
        let sums = [m[1][0] + m[0][1], m[0][2] + m[2][0], m[2][1] + m[1][2]];
        let s = squares[largest];
        match largest {
            0 => [s, mixed[0], mixed[1], mixed[2]],
            1 => [mixed[0], s, sums[0], sums[1]],
            2 => [mixed[1], sums[0], s, sums[2]],
            _ => [mixed[2], sums[1], sums[2], s],
        }
    }

    /// This pose, then the other in its frame: self * other.
    pub fn then(&self, other: &Self) -> Self {
        let columns: [Vector3; 3] = std::array::from_fn(|j| self.direction(other.column(j)));
        Self {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i])),
            position: self.point(other.position),
        }
    }

    /// This pose, then a turn about its z axis: only two columns change.
    pub fn turned(&self, c: Complex64, s: Complex64) -> Self {
        Self {
            rotation: self
                .rotation
                .map(|[x, y, z]| [x * c + y * s, y * c - x * s, z]),
            position: self.position,
        }
    }

    /// This pose, then a link Tz(offset) Tx(length) Rx(twist), the twist by its cosine and sine.
    pub fn along_link(&self, length: f64, [c, s]: [f64; 2], offset: f64) -> Self {
        let mut position = self.position;
        for (p, [x, _, z]) in position.iter_mut().zip(&self.rotation) {
            *p += x * length + z * offset;
        }
        Self {
            rotation: self
                .rotation
                .map(|[x, y, z]| [x, y * c + z * s, z * c - y * s]),
            position,
        }
    }

    /// The pose that takes back; its rotation is orthogonal.
    pub fn inverse(&self) -> Self {
        let transposed: [[Complex64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| self.rotation[j][i]));
        let turned = Self {
            rotation: transposed,
            position: [ZERO; 3],
        };
        Self {
            position: turned.point(self.position).map(|c| -c),
            ..turned
        }
    }

    /// Image of a point.
    pub fn point(&self, p: Vector3) -> Vector3 {
        let turned = self.direction(p);
        std::array::from_fn(|i| turned[i] + self.position[i])
    }

    /// Image of a direction.
    pub fn direction(&self, d: Vector3) -> Vector3 {
        self.rotation
            .map(|[x, y, z]| x * d[0] + y * d[1] + z * d[2])
    }

    /// A column of the rotation.
    pub fn column(&self, j: usize) -> Vector3 {
        std::array::from_fn(|i| self.rotation[i][j])
    }

    /// The largest difference of an entry, positions in units of `size`.
    pub fn distance(&self, other: &Self, size: f64) -> f64 {
        let mut most = 0.0f64;
        for i in 0..3 {
            for j in 0..3 {
                most = most.max(modulus(self.rotation[i][j] - other.rotation[i][j]));
            }
            most = most.max(modulus(self.position[i] - other.position[i]) / size);
        }
        most
    }

    /// Roll, pitch and yaw of a real rotation, in radians.
    pub fn roll_pitch_yaw(&self) -> [f64; 3] {
        let m = self.rotation.map(|row| row.map(|c| c.re));
        let across = (m[0][0] * m[0][0] + m[1][0] * m[1][0]).sqrt();
        let angle = |c: f64, s: f64| radians(Complex64::new(c, s));
        let pitch = angle(across, -m[2][0]);
        if across > 1e-12 {
            [angle(m[2][2], m[2][1]), pitch, angle(m[0][0], m[1][0])]
        } else {
            [0.0, pitch, angle(m[1][1], -m[0][1])]
        }
    }
}

/// How far a matrix is from a rotation, and the rotation near to it.
///
/// The error is the largest entry of M'M - I, or infinite for a mirror image.
pub fn nearest_rotation(rows: [[f64; 3]; 3]) -> (f64, [[f64; 3]; 3]) {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut error = 0.0f64;
    for i in 0..3 {
        for j in 0..3 {
            let wanted = if i == j { 1.0 } else { 0.0 };
            error = error.max((dot(rows[i], rows[j]) - wanted).abs());
        }
    }
    if cross(rows[0], rows[1])
        .iter()
        .zip(rows[2])
        .map(|(a, b)| a * b)
        .sum::<f64>()
        < 0.0
        || !error.is_finite()
    {
        return (f64::INFINITY, rows);
    }
    // By the quaternion: exactly orthogonal up to rounding.
    let q = Pose::real(rows, [0.0; 3]).quaternion();
    let Some(pose) = Pose::of_quaternion(q.map(Complex64::from), [ZERO; 3]) else {
        return (f64::INFINITY, rows);
    };
    (error, pose.rotation.map(|row| row.map(|c| c.re)))
}

/// The vector product.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The scalar product.
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector of length 1 in this direction; `None` for the vector 0.
pub fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(a, a).sqrt();
    (length > 0.0 && length.is_finite()).then(|| a.map(|c| c / length))
}

/// A frame with its origin at a point, its z along a direction, its x as near as can be to another one,
/// or to an axis of the coordinates. `None` where a direction is 0 or the two are parallel.
pub fn frame(point: [f64; 3], z: [f64; 3], x: Option<[f64; 3]>) -> Option<Pose> {
    let z = unit(z)?;
    let x = x.unwrap_or_else(|| {
        let least = (0..3).fold(
            0,
            |best, i| if z[i].abs() < z[best].abs() { i } else { best },
        );
        std::array::from_fn(|i| if i == least { 1.0 } else { 0.0 })
    });
    let along = dot(x, z);
    let x: [f64; 3] = std::array::from_fn(|i| x[i] - along * z[i]);
    if dot(x, x) < 1e-20 {
        return None;
    }
    let x = unit(x)?;
    let y = cross(z, x);
    let rotation = std::array::from_fn(|i| [x[i], y[i], z[i]]);
    Some(Pose::real(rotation, point))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(k: f64) -> Pose {
        let q = [0.3 + k, -0.5, 0.7 * k, 0.2].map(Complex64::from);
        Pose::of_quaternion(q, [k.into(), 2.0.into(), (-1.0).into()]).unwrap()
    }

    #[test]
    fn representations_come_back() {
        for k in [-2.0, -0.3, 0.0, 0.4, 5.0] {
            let pose = sample(k);
            let q = pose.quaternion().map(Complex64::from);
            let back = Pose::of_quaternion(q, pose.position).unwrap();
            assert!(pose.distance(&back, 1.0) < 1e-14);
            let rpy = pose.roll_pitch_yaw().map(Angle::of_radians);
            let turned = Pose {
                position: pose.position,
                ..Pose::of_roll_pitch_yaw(rpy)
            };
            assert!(pose.distance(&turned, 1.0) < 1e-14);
            let identity = pose.then(&pose.inverse());
            assert!(identity.distance(&Pose::IDENTITY, 1.0) < 1e-14);
        }
    }

    #[test]
    fn rotations_that_are_none_are_told() {
        let rows = sample(0.4).rotation.map(|row| row.map(|c| c.re));
        let (error, _) = nearest_rotation(rows);
        assert!(error < 1e-15);
        let mirrored = [rows[1], rows[0], rows[2]];
        let message = ReadPose::of_rows(mirrored, [ZERO; 3]).unwrap_err();
        assert!(message.contains("a reflection"), "{message}");
        let mut off = rows;
        off[0][0] += 1e-4;
        let (error, near) = nearest_rotation(off);
        assert!(error > 1e-5 && error < 1e-3);
        assert!(nearest_rotation(near).0 < 1e-15);
        let mirrored = [rows[1], rows[0], rows[2]];
        assert_eq!(nearest_rotation(mirrored).0, f64::INFINITY);
    }
}
