//! Generators: whether the maps that somebody declared take the solutions to solutions, no two to one.

use super::{Image, MOST_MAGNIFIED, SAME, SymmetryGroup, TRIED};
use crate::point_shape::PointShape;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::evaluation::values;
use cognate_systems::system::System;
use num_complex::Complex64;

/// Points beside an image with which its residuals are compared.
const BESIDE: usize = 4;
/// Least distance of these points.
const LEAST_DISTANCE: f64 = 1e-6;
/// Largest distance of these points: images of larger error say nothing.
const MOST_DISTANCE: f64 = 1e-2;
/// Distance of these points over the error of an image.
const ERRORS: f64 = 100.0;
/// An equation holds at an image where it is smaller than this part of its values beside it.
const HOLDS: f64 = 0.5;
/// Two solutions are different where they are farther apart than this.
const APART: f64 = 1e-4;

impl SymmetryGroup {
    /// Reason why a generator is no symmetry of these solutions; each comes with the radius of its error.
    pub(super) fn doubt(
        &self,
        points: &[(&[Complex64], f64)],
        system: &System,
        parameters: &[Complex64],
        shape: &PointShape,
    ) -> Option<String> {
        let points = &points[..points.len().min(TRIED)];
        let equations = Equations {
            system,
            parameters,
            shape,
        };
        for letter in 0..self.generators.len() {
            let generator = Self {
                generators: vec![self.generators[letter].clone()],
                words: vec![vec![0]],
            };
            let mut seen: Vec<[Vec<Complex64>; 2]> = Vec::new();
            for (values, radius) in points {
                let image = generator.images(values, shape).pop().flatten();
                let Some(image) = image.filter(|image| image.magnification <= MOST_MAGNIFIED)
                else {
                    continue;
                };
                if !equations.may_hold(&image, *radius) {
                    let number = letter + 1;
                    return Some(format!(
                        "symmetry generator {number} does not take solutions to solutions"
                    ));
                }
                seen.push([values, &image.values[..]].map(|point| shape.to_coordinates(point)));
            }
            let is_joined = |a: &[Vec<Complex64>; 2], b: &[Vec<Complex64>; 2]| {
                shape.distance(&a[1], &b[1]) <= SAME && shape.distance(&a[0], &b[0]) >= APART
            };
            let mut pairs = (0..seen.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            if pairs.any(|(i, j)| is_joined(&seen[i], &seen[j])) {
                let number = letter + 1;
                return Some(format!(
                    "symmetry generator {number} takes two solutions to one"
                ));
            }
        }
        None
    }
}

/// The equations at values of their parameters.
struct Equations<'a> {
    system: &'a System,
    parameters: &'a [Complex64],
    shape: &'a PointShape,
}

impl Equations<'_> {
    /// Whether an image of a solution with this error may be a solution: each equation is smaller there than at random
    /// points that lie beside it at a hundred times its error.
    fn may_hold(&self, image: &Image, radius: f64) -> bool {
        let distance = (ERRORS * radius * image.magnification).max(LEAST_DISTANCE);
        if distance > MOST_DISTANCE {
            return true;
        }
        let mut random = RandomStream::new(0, Purpose::Probe, 3);
        let mut beside = vec![0.0f64; self.system.equations.len()];
        for _ in 0..BESIDE {
            let mut coordinates = self.shape.to_coordinates(&image.values);
            for z in &mut coordinates {
                *z += random.unit() * distance;
            }
            let residuals = self.residuals(&self.shape.to_variables(&coordinates));
            for (largest, residual) in beside.iter_mut().zip(residuals) {
                *largest = largest.max(residual);
            }
        }
        let at = self.residuals(&image.values);
        at.iter()
            .zip(&beside)
            .all(|(at, beside)| *at <= HOLDS * beside)
    }

    fn residuals(&self, point: &[Complex64]) -> Vec<f64> {
        let system = self.system;
        let residuals = values(
            &system.expressions,
            &system.equations,
            point,
            self.parameters,
        );
        residuals.iter().map(|f| f.norm_sqr().sqrt()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::formats;

    /// The doubt about one generator, at these solutions of the equations.
    fn doubt(equations: &str, generator: &str, solutions: &[[f64; 2]]) -> Option<String> {
        let text = format!(
            r#"{{"variables": ["x", "y"], "equations": [{equations}], "symmetry": [{generator}]}}"#
        );
        let problem = formats::read("test", text.as_bytes()).expect("a problem of this test");
        let system = problem.system;
        let group = SymmetryGroup::of(&system).expect("a rational map");
        let points: Vec<[Complex64; 2]> = solutions
            .iter()
            .map(|solution| solution.map(Complex64::from))
            .collect();
        let points: Vec<(&[Complex64], f64)> =
            points.iter().map(|point| (&point[..], 1e-10)).collect();
        group.doubt(&points, &system, &[], &PointShape::of(&system))
    }

    const CIRCLE: &str = r#""x^2 + y^2 - 5", "x*y - 2""#;
    const ON_CIRCLE: [[f64; 2]; 4] = [[1.0, 2.0], [2.0, 1.0], [-1.0, -2.0], [-2.0, -1.0]];

    #[test]
    fn what_takes_solutions_elsewhere_is_no_symmetry() {
        let elsewhere = "symmetry generator 1 does not take solutions to solutions";
        for generator in [
            r#"{"map": {"x": "2*x", "y": "y/2"}}"#,
            r#"{"map": {"x": "y"}}"#,
            r#"{"map": {"x": "x + 1/10000"}}"#,
        ] {
            let doubt = doubt(CIRCLE, generator, &ON_CIRCLE);
            assert_eq!(doubt.as_deref(), Some(elsewhere), "{generator}");
        }
        for generator in [
            r#"{"permutation": {"x": "y", "y": "x"}}"#,
            r#"{"map": {"x": "-x", "y": "-y"}}"#,
            r#"{"map": {"x": "2/x", "y": "2/y"}}"#,
        ] {
            assert_eq!(doubt(CIRCLE, generator, &ON_CIRCLE), None, "{generator}");
        }
    }

    #[test]
    fn coordinates_that_are_zero_are_compared_too() {
        let zeros = r#""x*(x - 1)", "y*(y - 1)*(x + 1)""#;
        let solutions = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let turn = r#"{"map": {"x": "1 - x", "y": "1 - y"}}"#;
        assert_eq!(doubt(zeros, turn, &solutions), None);
        let joined = doubt(zeros, r#"{"map": {"x": "y"}}"#, &solutions);
        let two = "symmetry generator 1 takes two solutions to one";
        assert_eq!(joined.as_deref(), Some(two));
    }
}
