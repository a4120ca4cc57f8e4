//! PointShape: which coordinate of an endpoint belongs to which variable.
//!
//! Endpoints come in homogeneous coordinates, group after group (see
//! `Coordinates`); this is the one place that knows how to read them.

use cognate_continuation::path_result::REFINED_ERROR;
use cognate_continuation::projection::Projection;
use cognate_continuation::start_systems::exchange::Exchange;
use cognate_systems::scaling::Scaling;
use cognate_systems::system::{System, VariableGroup};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ops::Range;

/// The groups of a system, as the coordinates of its endpoints are laid out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointShape {
    groups: Vec<VariableGroup>,
    variables: usize,
    /// The units of the coordinates, which are those of the unknowns that are tracked.
    scaling: Scaling,
}

/// The coordinates of one group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span<'a> {
    /// Places of the group's coordinates.
    pub range: Range<usize>,
    /// The group: an affine one has its homogenising coordinate first.
    pub group: &'a VariableGroup,
}

/// |z|, without libm.
pub fn modulus(z: Complex64) -> f64 {
    z.norm_sqr().sqrt()
}

/// The largest modulus among some numbers.
pub fn largest(values: &[Complex64]) -> f64 {
    values
        .iter()
        .map(|z| z.norm_sqr())
        .fold(0.0, f64::max)
        .sqrt()
}

impl PointShape {
    /// The shape of a system's endpoints.
    pub fn of(system: &System) -> Self {
        Self {
            groups: system.groups.clone(),
            variables: system.variables.len(),
            scaling: system.scaling.clone(),
        }
    }

    /// Number of coordinates of an endpoint.
    pub fn coordinates(&self) -> usize {
        self.variables + self.groups.iter().filter(|g| !g.homogeneous).count()
    }

    /// The groups with their places, in order.
    pub fn spans(&self) -> impl Iterator<Item = Span<'_>> {
        let mut start = 0;
        self.groups.iter().map(move |group| {
            let length = group.variables.len() + usize::from(!group.homogeneous);
            let range = start..start + length;
            start += length;
            Span { range, group }
        })
    }

    /// A number for each point, by which points are sorted.
    pub fn projection(&self, seed: u64) -> Projection {
        Projection::new(self.spans().map(|span| span.range.len()), seed, 0)
    }

    /// The value of each variable: affine groups divided by their homogenising
    /// coordinate, homogeneous groups scaled so that their largest variable is 1.
    pub fn to_variables(&self, point: &[Complex64]) -> Vec<Complex64> {
        let mut values = vec![Complex64::new(0.0, 0.0); self.variables];
        let unknowns_are_variables = self.scaling.is_none();
        for span in self.spans() {
            let group = &point[span.range.clone()];
            let members = &span.group.variables;
            // Exactly 1, not nearly: z/z rounds.
            let quotient = |z: Complex64, divisor: Complex64| match z == divisor {
                true => Complex64::new(1.0, 0.0),
                false => z / divisor,
            };
            if !span.group.homogeneous {
                for (&variable, &z) in members.iter().zip(&group[1..]) {
                    let unknown = quotient(z, group[0]);
                    values[variable] = self.scaling.to_variable(variable, unknown);
                }
                continue;
            }
            let scaled: Cow<'_, [Complex64]> = match unknowns_are_variables {
                true => Cow::Borrowed(group),
                false => {
                    let scaled = members.iter().zip(group);
                    scaled
                        .map(|(&v, &z)| self.scaling.to_variable(v, z))
                        .collect()
                }
            };
            let divisor = scaled[largest_index(&scaled)];
            for (&variable, &z) in members.iter().zip(&*scaled) {
                values[variable] = quotient(z, divisor);
            }
        }
        values
    }

    /// The coordinates of the point that an exchange of groups makes of a point of this shape.
    pub fn exchanged(&self, point: &[Complex64], exchange: &Exchange) -> Vec<Complex64> {
        let mut place = vec![0; self.variables];
        for span in self.spans() {
            let first = span.range.start + usize::from(!span.group.homogeneous);
            for (at, &v) in (first..).zip(&span.group.variables) {
                place[v] = at;
            }
        }
        let starts: Vec<usize> = self.spans().map(|span| span.range.start).collect();
        let mut image = point.to_vec();
        for (k, span) in self.spans().enumerate() {
            let mut at = span.range.start;
            if !span.group.homogeneous {
                image[at] = point[starts[exchange.groups[k]]];
                at += 1;
            }
            for (at, &v) in (at..).zip(&span.group.variables) {
                image[at] = point[place[exchange.variables[v]]];
            }
        }
        image
    }

    /// The other way: coordinates of the point at which the variables have these values.
    pub fn to_coordinates(&self, values: &[Complex64]) -> Vec<Complex64> {
        let mut point = Vec::with_capacity(self.coordinates());
        for span in self.spans() {
            let start = point.len();
            if !span.group.homogeneous {
                point.push(Complex64::new(1.0, 0.0));
            }
            let members = span.group.variables.iter();
            point.extend(members.map(|&v| self.scaling.to_unknown(v, values[v])));
            let scale = largest(&point[start..]);
            if scale > 0.0 {
                for z in &mut point[start..] {
                    *z /= scale;
                }
            }
        }
        point
    }

    /// Distance of two points, group by group up to scaling: the largest difference of coordinates after both are
    /// divided by the coordinate that is largest in the first.
    pub fn distance(&self, a: &[Complex64], b: &[Complex64]) -> f64 {
        let mut distance = 0.0f64;
        for span in self.spans() {
            let (a, b) = (&a[span.range.clone()], &b[span.range]);
            let pivot = largest_index(a);
            for (x, y) in a.iter().zip(b) {
                let difference = modulus(x / a[pivot] - y / b[pivot]);
                if !difference.is_finite() {
                    return f64::INFINITY;
                }
                distance = distance.max(difference);
            }
        }
        distance
    }

    /// Whether the value of one unknown differs at two refined ends: by more than the part `reach` of its size and the
    /// errors that both may have. Far from 0 points with other values are close in homogeneous coordinates.
    pub fn have_other_values(&self, a: &[Complex64], b: &[Complex64], reach: f64) -> bool {
        let affine = self.spans().filter(|span| !span.group.homogeneous);
        let values = affine.flat_map(|span| {
            let (a, b) = (&a[span.range.clone()], &b[span.range]);
            let pairs = a[1..].iter().zip(&b[1..]);
            pairs.map(|(x, y)| (x / a[0], y / b[0]))
        });
        let values: Vec<(Complex64, Complex64)> = values.collect();
        let size = |(x, y): &(Complex64, Complex64)| modulus(*x).max(modulus(*y));
        let error = 4.0 * REFINED_ERROR * values.iter().map(size).fold(0.0, f64::max);
        let differ =
            |pair: &(Complex64, Complex64)| modulus(pair.0 - pair.1) > reach * size(pair) + error;
        values.iter().any(differ)
    }

    /// True for coordinates that can be a point: as many as there should be,
    /// all finite, and no group all 0.
    pub fn holds(&self, point: &[Complex64]) -> bool {
        point.len() == self.coordinates()
            && point.iter().all(|z| z.re.is_finite() && z.im.is_finite())
            && self.spans().all(|span| largest(&point[span.range]) > 0.0)
    }
}

/// Index of the largest coordinate; the first of equals.
fn largest_index(values: &[Complex64]) -> usize {
    let mut best = 0;
    for (index, z) in values.iter().enumerate() {
        if z.norm_sqr() > values[best].norm_sqr() {
            best = index;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complex(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    fn shape() -> PointShape {
        PointShape {
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
            variables: 4,
            scaling: Scaling::default(),
        }
    }

    #[test]
    fn coordinates_and_variables_are_each_others_inverse() {
        let shape = shape();
        let point = [
            complex(0.0, 0.5),
            complex(1.0, 0.0),
            complex(0.25, 0.0),
            complex(0.0, 1.0),
            complex(0.5, 0.0),
        ];
        let values = shape.to_variables(&point);
        assert_eq!(values[2], complex(0.0, -2.0));
        assert_eq!(values[0], complex(0.0, -0.5));
        assert_eq!(values[1], complex(1.0, 0.0));
        assert_eq!(values[3], complex(0.0, -0.5));
        let back = shape.to_coordinates(&values);
        assert!(shape.holds(&back));
        assert!(shape.distance(&point, &back) < 1e-15);
    }

    #[test]
    fn distance_ignores_factors_per_group_only() {
        let shape = shape();
        let point: Vec<_> = (1..=5).map(|k| complex(0.1 * f64::from(k), -0.3)).collect();
        let mut scaled = point.clone();
        scaled[..3].iter_mut().for_each(|z| *z *= complex(0.0, 7.0));
        scaled[3..]
            .iter_mut()
            .for_each(|z| *z *= complex(-1e-3, 1.0));
        assert!(shape.distance(&point, &scaled) < 1e-15);
        scaled[2] *= 1.5;
        assert!(shape.distance(&point, &scaled) > 0.1);
    }

    #[test]
    fn what_is_no_point_is_seen() {
        let shape = shape();
        let mut point = vec![complex(1.0, 0.0); 5];
        assert!(shape.holds(&point));
        assert!(!shape.holds(&point[..4]));
        point[1] = complex(f64::NAN, 0.0);
        assert!(!shape.holds(&point));
        assert!(!shape.holds(&[complex(0.0, 0.0); 5]));
    }
}
