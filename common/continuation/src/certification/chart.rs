//! Chart: a point with the largest variable of each homogeneous group at 1.

use num_complex::Complex64;

/// A point with the largest variable of each homogeneous group at 1.
#[derive(Clone, Debug)]
pub(super) struct Chart {
    /// Values of all variables.
    pub point: Vec<Complex64>,
    /// The variables that are not fixed so.
    pub free: Vec<usize>,
}

impl Chart {
    /// The point in its chart; `None` where it is damaged. `homogeneous`: the variables of each homogeneous group.
    pub fn of(point: &[Complex64], variables: usize, homogeneous: &[Vec<usize>]) -> Option<Self> {
        let finite = |z: &Complex64| z.re.is_finite() && z.im.is_finite();
        if point.len() != variables || !point.iter().all(finite) {
            return None;
        }
        let mut point = point.to_vec();
        let mut fixed = Vec::new();
        for group in homogeneous {
            let size = |v: usize| point[v].norm_sqr();
            let largest = group
                .iter()
                .copied()
                .reduce(|a, b| if size(b) > size(a) { b } else { a })?;
            let scale = point[largest];
            if scale.norm_sqr() == 0.0 {
                return None;
            }
            for &v in group {
                point[v] /= scale;
            }
            point[largest] = Complex64::new(1.0, 0.0);
            fixed.push(largest);
        }
        let free = (0..point.len()).filter(|v| !fixed.contains(v)).collect();
        Some(Self { point, free })
    }
}
