//! Chart: homogeneous coordinates of a system, and the random patch in which paths are tracked.
//!
//! Each group has homogeneous coordinates y_0 .. y_m (an affine group's y_0 is the
//! homogenising one). A random linear equation, the patch, removes y_0:
//! `y_0 = c_0 + c_1 y_1 + ... + c_m y_m`. What is left are the coordinates that the
//! tracker sees; solutions at infinity are ordinary points of it (survey, section 6.3).
//! The affine chart has the patch `y_0 = 1`: infinity is far away in it, and programs are short.

use crate::start_systems::exchange::Exchange;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::system::System;
use num_complex::Complex64;

/// One group of the chart.
#[derive(Clone, Debug)]
struct ChartGroup {
    /// The system's variables in the group.
    variables: Vec<usize>,
    homogeneous: bool,
    /// c_0, c_1, ..., c_m.
    patch: Vec<Complex64>,
    /// Index of y_1 among the chart's coordinates.
    first: usize,
}

/// Homogeneous coordinates and patches of all groups.
#[derive(Clone, Debug)]
pub struct Chart {
    groups: Vec<ChartGroup>,
    variables: usize,
    dimension: usize,
}

/// An exact node for a double complex number.
pub(crate) fn exact(out: &mut Expressions, value: Complex64) -> NodeId {
    let part = |v: f64| Rational::from_f64(v).expect("coefficients of our own making are finite");
    out.constant(ComplexRational::new(part(value.re), part(value.im)))
}

/// Least size of a point of the chart: where all its coordinates are small, the coordinate that
/// the patch removed is not (the solution 0 of an affine group is an ordinary point).
pub(crate) const LEAST_NORM: f64 = 0.25;

/// Size of a point of the chart: its largest coordinate, the removed ones counted.
pub(crate) fn norm(point: &[Complex64]) -> f64 {
    point
        .iter()
        .fold(LEAST_NORM * LEAST_NORM, |m, z| m.max(z.norm_sqr()))
        .sqrt()
}

impl Chart {
    /// A random patch for each group of the system, others for each `attempt`: of many paths some
    /// end where one patch has its infinity.
    pub fn new(system: &System, seed: u64, attempt: u16) -> Self {
        let mut first = 0;
        let groups = system
            .groups
            .iter()
            .enumerate()
            .map(|(k, group)| {
                let count = group.variables.len() + usize::from(!group.homogeneous);
                let number = k as u64 | u64::from(attempt) << 32;
                let mut stream = RandomStream::new(seed, Purpose::Patch, number);
                let group = ChartGroup {
                    variables: group.variables.clone(),
                    homogeneous: group.homogeneous,
                    patch: (0..count).map(|_| stream.unit()).collect(),
                    first,
                };
                first += count - 1;
                group
            })
            .collect();
        Self {
            groups,
            variables: system.variables.len(),
            dimension: first,
        }
    }

    /// The affine chart: y_0 = 1 in every affine group, so that the chart's coordinates are the
    /// system's variables. Homogeneous groups keep their random patches.
    pub fn affine(system: &System, seed: u64, attempt: u16) -> Self {
        let mut chart = Self::new(system, seed, attempt);
        for group in chart.groups.iter_mut().filter(|group| !group.homogeneous) {
            group.patch.fill(Complex64::default());
            group.patch[0] = Complex64::new(1.0, 0.0);
        }
        chart
    }

    /// Sets the patch of each exchanged group to the image of the patch of its partner.
    pub(crate) fn with_exchange(mut self, exchange: &Exchange) -> Self {
        for (k, &to) in exchange.groups.iter().enumerate() {
            if k < to {
                self.groups[to].patch = self.exchanged(&self.groups[k].patch, k, exchange);
            }
        }
        self
    }

    /// The image of a linear form in the homogeneous coordinates of group `k`.
    pub(crate) fn exchanged(
        &self,
        form: &[Complex64],
        k: usize,
        exchange: &Exchange,
    ) -> Vec<Complex64> {
        let (group, other) = (&self.groups[k], &self.groups[exchange.groups[k]]);
        let offset = usize::from(!group.homogeneous);
        let mut image = form.to_vec();
        for (place, &v) in other.variables.iter().enumerate() {
            let from = exchange.variables[v];
            let from = group.variables.iter().position(|&w| w == from);
            image[offset + place] = form[offset + from.expect("groups are exchanged as a whole")];
        }
        image
    }

    /// Number of coordinates that the tracker sees.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of groups.
    pub fn group_count(&self) -> usize {
        self.groups.len()
    }

    /// Number of homogeneous coordinates of a group.
    pub fn group_size(&self, group: usize) -> usize {
        self.groups[group].patch.len()
    }

    /// Whether a group is homogeneous: none of its coordinates is a homogenising one.
    pub(crate) fn is_homogeneous(&self, group: usize) -> bool {
        self.groups[group].homogeneous
    }

    /// The patch of a group: c_0 .. c_m, and where y_1 stands in the chart.
    pub(crate) fn patch(&self, group: usize) -> (&[Complex64], usize) {
        (&self.groups[group].patch, self.groups[group].first)
    }

    /// The nodes of the homogeneous coordinates, group by group, over the chart's variables.
    pub fn nodes(&self, out: &mut Expressions) -> Vec<Vec<NodeId>> {
        self.groups
            .iter()
            .map(|group| {
                let free: Vec<NodeId> = (1..group.patch.len())
                    .map(|j| out.variable((group.first + j - 1) as u32))
                    .collect();
                let mut y0 = exact(out, group.patch[0]);
                for (&y, &c) in free.iter().zip(&group.patch[1..]) {
                    if c == Complex64::default() {
                        continue;
                    }
                    let c = exact(out, c);
                    let term = out.multiply(c, y);
                    y0 = out.add(y0, term);
                }
                std::iter::once(y0).chain(free).collect()
            })
            .collect()
    }

    /// Homogeneous coordinates, group after group, of a point of the chart.
    pub fn homogeneous(&self, point: &[Complex64]) -> Vec<Complex64> {
        let mut coordinates = Vec::with_capacity(self.dimension + self.groups.len());
        for group in &self.groups {
            let free = &point[group.first..group.first + group.patch.len() - 1];
            let mut y0 = group.patch[0];
            for (c, y) in group.patch[1..].iter().zip(free) {
                y0 += c * y;
            }
            coordinates.push(y0);
            coordinates.extend_from_slice(free);
        }
        coordinates
    }

    /// The homogenising coordinates of the affine groups at a point of the chart, of one lane.
    pub(crate) fn homogenizing_values<R: Real>(
        &self,
        context: R::Context,
        point: &[Complex<R>],
    ) -> Vec<Complex<R>> {
        let affine = self.groups.iter().filter(|group| !group.homogeneous);
        affine
            .map(|group| {
                let exact = |c: Complex64| Complex::<R>::from_f64(context, c.re, c.im);
                let mut y0 = exact(group.patch[0]);
                for (&c, y) in group.patch[1..].iter().zip(&point[group.first..]) {
                    y0.mul_add(&exact(c), y);
                }
                y0
            })
            .collect()
    }

    /// Scales each group of homogeneous coordinates by a power of two, so that its largest
    /// coordinate has modulus between 1/2 and 1.
    pub fn normalize(&self, coordinates: &mut [Complex64]) {
        let mut at = 0;
        for group in &self.groups {
            let part = &mut coordinates[at..at + group.patch.len()];
            at += group.patch.len();
            let largest = part.iter().fold(0.0f64, |m, y| m.max(y.norm_sqr())).sqrt();
            if largest.is_finite() && largest > 0.0 {
                let mut scale = 1.0;
                while largest * scale > 1.0 {
                    scale *= 0.5;
                }
                while largest * scale <= 0.5 {
                    scale *= 2.0;
                }
                for y in part {
                    *y *= scale;
                }
            }
        }
    }

    /// The chart's point with these homogeneous coordinates; `None` where the patch misses it.
    pub fn point(&self, coordinates: &[Complex64]) -> Option<Vec<Complex64>> {
        let mut point = Vec::with_capacity(self.dimension);
        let mut at = 0;
        for group in &self.groups {
            let y = &coordinates[at..at + group.patch.len()];
            at += group.patch.len();
            let mut offset = y[0];
            for (c, y) in group.patch[1..].iter().zip(&y[1..]) {
                offset -= c * y;
            }
            let scale = group.patch[0] / offset;
            if !(scale.re.is_finite() && scale.im.is_finite()) {
                return None;
            }
            point.extend(y[1..].iter().map(|y| y * scale));
        }
        Some(point)
    }

    /// The chart's point for values of the system's variables.
    pub fn from_variables(&self, values: &[Complex64]) -> Option<Vec<Complex64>> {
        debug_assert_eq!(values.len(), self.variables);
        let mut coordinates = Vec::with_capacity(self.dimension + self.groups.len());
        for group in &self.groups {
            if !group.homogeneous {
                coordinates.push(Complex64::new(1.0, 0.0));
            }
            coordinates.extend(group.variables.iter().map(|&v| values[v]));
        }
        self.point(&coordinates)
    }

    /// Positions of the homogenising coordinates of the affine groups among all homogeneous coordinates.
    pub fn homogenizing(&self) -> Vec<usize> {
        let mut at = 0;
        let mut positions = Vec::new();
        for group in &self.groups {
            if !group.homogeneous {
                positions.push(at);
            }
            at += group.patch.len();
        }
        positions
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::system::VariableGroup;

    #[test]
    fn a_point_goes_into_the_chart_and_back() {
        let system = System {
            variables: ["a", "b", "c", "d"].map(String::from).to_vec(),
            groups: vec![
                VariableGroup {
                    variables: vec![2, 0],
                    homogeneous: false,
                },
                VariableGroup {
                    variables: vec![1, 3],
                    homogeneous: true,
                },
            ],
            ..System::default()
        };
        let chart = Chart::new(&system, 5, 0);
        assert_eq!(chart.dimension(), 3);
        let values: Vec<Complex64> = (1..5).map(|k| Complex64::new(f64::from(k), 0.5)).collect();
        let point = chart.from_variables(&values).unwrap();
        let mut back = chart.homogeneous(&point);
        let close = |a: Complex64, b: Complex64| (a - b).norm_sqr() < 1e-24;
        assert!(close(back[1] / back[0], values[2]) && close(back[2] / back[0], values[0]));
        assert!(close(back[3] * values[3], back[4] * values[1]));
        chart.normalize(&mut back);
        assert!(back[..3].iter().all(|y| y.norm_sqr() <= 1.0));
        let chart_point = chart.point(&back).unwrap();
        assert!(point.iter().zip(&chart_point).all(|(a, b)| close(*a, *b)));
        assert_eq!(chart.homogenizing(), vec![0]);
    }
}
