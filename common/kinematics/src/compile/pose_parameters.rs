//! Parameters that are a pose: a quaternion of any length, and a position.

use crate::mechanism::pose::Pose;
use num_complex::Complex64;

/// Numbers of the quaternion.
const QUATERNION: usize = 4;
/// Places of a general target in parts of the mechanism's size: not far beyond its reach.
const REACH: f64 = 0.4;

/// The parameters of a real pose.
pub fn of_pose(pose: &Pose) -> Vec<Complex64> {
    let mut values: Vec<Complex64> = pose.quaternion().map(Complex64::from).to_vec();
    values.extend(pose.position);
    values
}

/// The pose of these parameters; `None` where the quaternion has the square 0.
pub fn pose(parameters: &[Complex64]) -> Option<Pose> {
    let (quaternion, position) = parameters.split_first_chunk::<QUATERNION>()?;
    Pose::of_quaternion(*quaternion, position.try_into().ok()?)
}

/// General parameters for a mechanism of this size, by random numbers of modulus about 1.
pub fn general(size: f64, draw: &mut dyn FnMut() -> Complex64) -> Vec<Complex64> {
    let mut values: Vec<Complex64> = (0..QUATERNION).map(|_| draw()).collect();
    values.extend((0..3).map(|_| draw() * (REACH * size)));
    values
}

/// Places of the parameters that count up to a common factor.
pub fn homogeneous() -> Vec<Vec<usize>> {
    vec![(0..QUATERNION).collect()]
}
