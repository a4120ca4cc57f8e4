//! ClosePaths: four paths that pass by two branch points at a known distance, and where they end.

use crate::systems::written;
use cognate_systems::system::System;
use num_complex::Complex64;

/// u^2 = t - 1/2 + d i and v^2 = t - 1/3 + d i with u = x + 2 y and v = x - 3 y: two paths come within
/// 2 sqrt(d) of each other where t = 1/2, and again where t = 1/3. The principal square roots are
/// continuous on the way, so u and v keep their signs.
pub struct ClosePaths {
    /// The homotopy; its path variable is the only parameter.
    pub system: System,
    /// Coordinates x and y of each path at t = 1.
    pub starts: [[Complex64; 2]; 4],
    /// Coordinates x and y of each path at t = 0.
    pub ends: [[Complex64; 2]; 4],
}

/// The principal square root of re + im i with im > 0.
fn principal_root(re: f64, im: f64) -> Complex64 {
    let half = ((re * re + im * im).sqrt() + re.abs()) / 2.0;
    let large = half.sqrt();
    let small = im / (2.0 * large);
    match re >= 0.0 {
        true => Complex64::new(large, small),
        false => Complex64::new(small, large),
    }
}

impl ClosePaths {
    /// With d = 10^-exponent.
    pub fn at(exponent: u32) -> Self {
        let distance = (0..exponent).fold(1.0, |d, _| d / 10.0);
        let system = written(&format!(
            "variable x, y; pathvariable t; function f, g; \
             f = (x + 2*y)^2 - (t - 1/2 + 1e-{exponent}*I); \
             g = (x - 3*y)^2 - (t - 1/3 + 1e-{exponent}*I);"
        ));
        let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let root = |re: f64| principal_root(re, distance);
        let points = |t: f64| {
            signs.map(|(s, r)| {
                let (u, v) = (root(t - 0.5) * s, root(t - 1.0 / 3.0) * r);
                let y = (u - v) / 5.0;
                [u - y * 2.0, y]
            })
        };
        Self {
            system,
            starts: points(1.0),
            ends: points(0.0),
        }
    }

    /// How far a point is from the end of path number `path`; to any other it is more than 0.2.
    pub fn error(&self, path: usize, point: &[Complex64]) -> f64 {
        let both = self.ends[path].iter().zip(point);
        let errors = both.map(|(end, z)| (end - z).norm_sqr().sqrt());
        errors.fold(0.0, f64::max)
    }
}
