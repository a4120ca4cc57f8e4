//! PathPoints: nine points as they were given, and as parameters of the nine-point system.

use crate::plane::{modulus, scale};
use num_complex::Complex64;

/// Points nearer to each other than this, relative to the extent of all, are one.
const COINCIDENT: f64 = 1e-10;

/// Nine points of the plane, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoints {
    /// Coordinates x and y of each point; complex only if they were given so.
    points: [[Complex64; 2]; 9],
    /// Divisor of the differences of points: a power of 2, so that nothing is rounded.
    scale: f64,
}

/// Why nine points cannot be used; numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PointFault {
    /// A coordinate is infinite or not a number.
    #[error("point {} is not finite", .0 + 1)]
    NotFinite(usize),
    /// Two of them are one.
    #[error(
        "points {} and {} coincide; expected nine different points: with eight there is a curve \
         of linkages, not a list", .0 + 1, .1 + 1
    )]
    Coincident(usize, usize),
    /// Differences of the points overflow or vanish in double precision.
    #[error(
        "the points' extent is {0:e}; expected a number from 1e-290 to 1e290, so that it can be \
         scaled"
    )]
    Extent(f64),
}

impl PathPoints {
    /// Checks and scales.
    pub fn new(points: [[Complex64; 2]; 9]) -> Result<Self, PointFault> {
        for (k, [x, y]) in points.iter().enumerate() {
            if ![x.re, x.im, y.re, y.im].iter().all(|c| c.is_finite()) {
                return Err(PointFault::NotFinite(k));
            }
        }
        let distance = |j: usize, k: usize| {
            let [x, y] = [0, 1].map(|c| modulus(points[j][c] - points[k][c]));
            x.max(y)
        };
        let extent = (1..9).map(|k| distance(k, 0)).fold(0.0, f64::max);
        for j in 0..9 {
            for k in j + 1..9 {
                if distance(j, k) <= COINCIDENT * extent {
                    return Err(PointFault::Coincident(j, k));
                }
            }
        }
        let scale = scale(extent).ok_or(PointFault::Extent(extent))?;
        Ok(Self { points, scale })
    }

    /// Nine real points, as complex numbers.
    pub fn real(points: &[Complex64; 9]) -> Result<Self, PointFault> {
        Self::new(points.map(|p| [p.re, p.im].map(|c| Complex64::new(c, 0.0))))
    }

    /// True where every coordinate is real: only then there are linkages that can be built.
    pub fn is_real(&self) -> bool {
        self.points.iter().flatten().all(|c| c.im == 0.0)
    }

    /// x and y of each point.
    pub fn coordinates(&self) -> &[[Complex64; 2]; 9] {
        &self.points
    }

    /// The points in the plane; of complex ones the real parts.
    pub fn plane(&self) -> [Complex64; 9] {
        self.points.map(|[x, y]| Complex64::new(x.re, y.re))
    }

    /// d_1, D_1, ..., d_8, D_8 of the system: differences from the first point, scaled, in
    /// isotropic coordinates.
    pub fn parameters(&self) -> Vec<Complex64> {
        let mut parameters = Vec::with_capacity(16);
        let [x0, y0] = self.points[0];
        for [x, y] in &self.points[1..] {
            let (x, y) = ((x - x0) / self.scale, (y - y0) / self.scale);
            let iy = Complex64::new(-y.im, y.re);
            parameters.extend([x + iy, x - iy]);
        }
        parameters
    }

    /// The place in the plane of a place in the system's coordinates.
    pub fn place(&self, z: Complex64) -> Complex64 {
        self.plane()[0] + z * self.scale
    }

    /// Divisor of the differences of points.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The diagonal of the box around the points.
    pub fn extent(&self) -> f64 {
        let plane = self.plane();
        let span = |part: fn(&Complex64) -> f64| {
            let values = plane.iter().map(part);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
            high - low
        };
        modulus(Complex64::new(span(|p| p.re), span(|p| p.im)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spiral(scale: f64) -> [Complex64; 9] {
        std::array::from_fn(|k| {
            let t = k as f64;
            Complex64::new(t * t - 7.0, 3.0 * t - 0.25 * t * t) * scale
        })
    }

    #[test]
    fn the_scale_is_a_power_of_two_and_no_order_of_magnitude_matters() {
        let ours = PathPoints::real(&spiral(1.0)).expect("points");
        for power in [-900, -30, 0, 30, 900] {
            let factor = if power < 0 {
                1.0 / f64::from_bits(((1023 - power) as u64) << 52)
            } else {
                f64::from_bits(((1023 + power) as u64) << 52)
            };
            let scaled = PathPoints::real(&spiral(factor)).expect("points");
            assert_eq!(scaled.parameters(), ours.parameters(), "{power}");
            assert_eq!(scaled.scale(), ours.scale() * factor);
        }
        let size = ours
            .parameters()
            .iter()
            .map(|&d| modulus(d))
            .fold(0.0, f64::max);
        assert!((1.0..3.0).contains(&size), "{size}");
        assert_eq!(ours.parameters()[1], ours.parameters()[0].conj());
        let last = ours.place(ours.parameters()[14]);
        assert!(modulus(last - spiral(1.0)[8]) < 1e-12);
    }

    #[test]
    fn bad_points_are_named() {
        let mut points = spiral(1.0);
        points[6] = points[2];
        assert_eq!(PathPoints::real(&points), Err(PointFault::Coincident(2, 6)));
        points[6] = Complex64::new(f64::NAN, 0.0);
        assert_eq!(PathPoints::real(&points), Err(PointFault::NotFinite(6)));
        let tiny = PathPoints::real(&spiral(1e-300));
        assert!(matches!(tiny, Err(PointFault::Extent(_))), "{tiny:?}");
        let one = PathPoints::real(&[Complex64::new(3.0, 4.0); 9]);
        assert_eq!(one, Err(PointFault::Coincident(0, 1)));
    }

    #[test]
    fn complex_points_have_isotropic_coordinates_of_their_own() {
        let mut points = spiral(1.0).map(|p| [p.re, p.im].map(|c| Complex64::new(c, 0.0)));
        points[3][0].im = 0.5;
        let points = PathPoints::new(points).expect("points");
        assert!(!points.is_real());
        let parameters = points.parameters();
        assert_ne!(parameters[5], parameters[4].conj());
    }
}
