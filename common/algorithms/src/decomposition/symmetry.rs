//! Symmetry: linear maps that take solutions to solutions, and where they take witness points and components.
//!
//! The image of a witness set lies on the image of its slice. A path for each point moves it back to the witness set's
//! own slice; then the map permutes witness points, and those of one component come to those of one component.

use cognate_numeric::linear_algebra::inverse::inverse;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Complex;
use cognate_solutions::disjoint_sets::DisjointSets;
use cognate_solutions::symmetry::action::Action;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A map is linear where its value at a random point is the sum of its parts within this, relative to the value.
const LINEAR: f64 = 1e-10;

/// Reason why a generator cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GeneratorError {
    /// The image of a slice would be none.
    #[error(
        "not in this version: symmetry generator {0} is no invertible linear map of the variables, which components need"
    )]
    NotLinear(usize),
    /// It would act on points by their coordinates in a chart.
    #[error(
        "not in this version: components of a system with homogeneous groups and a symmetry group"
    )]
    Homogeneous,
}

/// A map x -> A x + b of the unknowns that are tracked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinearMap {
    /// Columns of A.
    columns: Vec<Vec<Complex64>>,
    shift: Vec<Complex64>,
    /// Rows of the inverse of A.
    inverse: Vec<Vec<Complex64>>,
}

impl LinearMap {
    /// The generators of a system that is tracked in its own units.
    pub fn all(system: &System) -> Result<Vec<Self>, GeneratorError> {
        if system.symmetry.is_empty() {
            return Ok(Vec::new());
        }
        if system.groups.iter().any(|group| group.homogeneous) {
            return Err(GeneratorError::Homogeneous);
        }
        let generators = (1..).zip(&system.symmetry);
        generators
            .map(|(number, generator)| {
                let action = Action::of(generator, system);
                let linear_map = action.and_then(|action| Self::of(&action, system));
                linear_map.ok_or(GeneratorError::NotLinear(number))
            })
            .collect()
    }

    fn of(action: &Action, system: &System) -> Option<Self> {
        let (scaling, n) = (&system.scaling, system.variable_count());
        let value = |x: &[Complex64]| {
            let image = action.image(&scaling.to_variables(x))?;
            Some(scaling.to_unknowns(&image))
        };
        let zero = vec![Complex64::default(); n];
        let shift = value(&zero)?;
        let column = |k: usize| {
            let mut unit = zero.clone();
            unit[k] = Complex64::new(1.0, 0.0);
            let image = value(&unit)?;
            Some(image.iter().zip(&shift).map(|(y, b)| y - b).collect())
        };
        let columns: Vec<Vec<Complex64>> = (0..n).map(column).collect::<Option<_>>()?;
        let mut matrix: Matrix<f64> = Matrix::zeros((), n, n);
        for (j, column) in columns.iter().enumerate() {
            for (i, z) in column.iter().enumerate() {
                *matrix.at_mut(i, j) = Complex::from_f64((), z.re, z.im);
            }
        }
        let inverse = inverse((), &matrix)?;
        let entry = |i: usize, j: usize| Complex64::new(inverse.at(i, j).re, inverse.at(i, j).im);
        let map = Self {
            columns,
            shift,
            inverse: (0..n)
                .map(|i| (0..n).map(|j| entry(i, j)).collect())
                .collect(),
        };
        let mut random = RandomStream::new(0, Purpose::Probe, 5);
        let point: Vec<Complex64> = (0..n).map(|_| random.unit()).collect();
        let (told, mapped_point) = (value(&point)?, map.image(&point));
        let apart = told
            .iter()
            .zip(&mapped_point)
            .map(|(a, b)| (a - b).norm_sqr());
        let size = mapped_point.iter().map(|z| z.norm_sqr()).sum::<f64>();
        (apart.sum::<f64>() <= LINEAR * LINEAR * size).then_some(map)
    }

    /// The image of a point.
    pub fn image(&self, point: &[Complex64]) -> Vec<Complex64> {
        let mut image = self.shift.clone();
        for (column, x) in self.columns.iter().zip(point) {
            for (y, a) in image.iter_mut().zip(column) {
                *y += a * x;
            }
        }
        image
    }

    /// The image of a slice: constant first, then a coefficient for each unknown.
    pub fn slice(&self, row: &[Complex64]) -> Vec<Complex64> {
        let mut image = vec![Complex64::default(); row.len()];
        for (of_row, c) in self.inverse.iter().zip(&row[1..]) {
            for (coefficient, a) in image[1..].iter_mut().zip(of_row) {
                *coefficient += c * a;
            }
        }
        let of_shift = image[1..].iter().zip(&self.shift).map(|(c, b)| c * b);
        image[0] = row[0] - of_shift.sum::<Complex64>();
        image
    }
}

/// Ways by which the images under each generator are moved back: a path that jumps on one of them does not on the
/// other.
pub(crate) const WAYS: usize = 2;

/// Images of the witness points of a set under the generators of a symmetry group.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct PointImages {
    /// Generators and ways that were asked, in this order.
    asked: usize,
    /// For each generator and way that permute the witness points, the image of each point.
    permutations: Vec<(usize, Vec<usize>)>,
    /// Generators that do not permute the witness points.
    refused: u64,
}

impl PointImages {
    /// The generator that is asked next, and the way.
    pub fn next(&self) -> (usize, usize) {
        (self.asked / WAYS, self.asked % WAYS)
    }

    /// Number of generators that do not permute the witness points.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Whether some generators permute the witness points.
    pub fn are_known(&self) -> bool {
        !self.permutations.is_empty()
    }

    /// Number of generators that were asked for.
    pub fn generators(&self) -> u64 {
        self.asked.div_ceil(WAYS) as u64
    }

    /// Number of known permutations, one for each generator and way.
    pub fn count(&self) -> usize {
        self.permutations.len()
    }

    /// Takes where the next generator takes all points by the next way; `None`: they are no permutation.
    pub fn take(&mut self, images: Option<Vec<usize>>) {
        let (generator, _) = self.next();
        match images {
            Some(images) => {
                self.permutations.push((generator, images));
                self.asked += 1;
            }
            None => {
                self.asked = (generator + 1) * WAYS;
                self.refuse(generator);
            }
        }
    }

    /// Takes back the generator of a permutation that two paths exchanged.
    pub fn take_back(&mut self, permutation: usize) {
        let (generator, _) = self.permutations[permutation];
        self.refuse(generator);
    }

    fn refuse(&mut self, generator: usize) {
        self.permutations.retain(|(source, _)| *source != generator);
        self.refused += 1;
    }

    /// The least of these points in each of their orbits, ascending.
    pub fn least_of_each(&self, points: &[usize]) -> Vec<usize> {
        let mut reached = BTreeSet::new();
        let mut least = Vec::new();
        for &point in points {
            if !reached.insert(point) {
                continue;
            }
            least.push(point);
            let mut next = vec![point];
            while let Some(point) = next.pop() {
                let images = self.permutations.iter().map(|(_, images)| images[point]);
                next.extend(images.filter(|&image| reached.insert(image)));
            }
        }
        least
    }

    /// Pairs of points that bring together what these do, and all their images, but for those by one permutation.
    pub fn with_images(&self, pairs: Vec<[usize; 2]>, without: Option<usize>) -> Vec<[usize; 2]> {
        let Some(count) = self.permutations.first().map(|(_, images)| images.len()) else {
            return pairs;
        };
        let mut joined = DisjointSets::new(count);
        let mut pairs_with_images = pairs;
        let mut next = pairs_with_images.clone();
        // Each pair that joins is followed once: there are fewer than points.
        while let Some([a, b]) = next.pop() {
            if !joined.join(a, b) {
                continue;
            }
            let permutations = self.permutations.iter().enumerate();
            for (_, (_, images)) in permutations.filter(|(k, _)| Some(*k) != without) {
                let image = [images[a], images[b]];
                pairs_with_images.push(image);
                next.push(image);
            }
        }
        pairs_with_images
    }

    /// The orbit of each of these classes, by the first of its classes; `None` where the images of one are not one.
    pub fn orbits(&self, classes: &[&[usize]]) -> Option<Vec<usize>> {
        let mut class_of = BTreeMap::new();
        for (k, class) in classes.iter().enumerate() {
            class_of.extend(class.iter().map(|&point| (point, k)));
        }
        let mut orbits: Vec<usize> = (0..classes.len()).collect();
        for (_, images) in &self.permutations {
            for (k, class) in classes.iter().enumerate() {
                let image = *class_of.get(&images[*class.first()?])?;
                let whole = class
                    .iter()
                    .all(|&point| class_of.get(&images[point]) == Some(&image));
                if !whole || classes[image].len() != class.len() {
                    return None;
                }
                let (a, b) = (orbits[k], orbits[image]);
                let least = a.min(b);
                for orbit in orbits.iter_mut().filter(|o| **o == a || **o == b) {
                    *orbit = least;
                }
            }
        }
        Some(orbits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(symmetry: &str) -> System {
        let text = format!(
            r#"{{"variables": ["x", "y", "z"], "equations": ["x*y*z - 1"], "symmetry": {symmetry}}}"#
        );
        cognate_systems::formats::read("test", text.as_bytes())
            .unwrap()
            .system
    }

    #[test]
    fn the_image_of_a_point_is_on_the_image_of_its_slice() {
        let cycle = r#"[{"permutation": {"x": "y", "y": "z", "z": "x"}}, {"map": {"x": "2*x - y + 3", "y": "I*z", "z": "x + y"}}]"#;
        let maps = LinearMap::all(&read(cycle)).unwrap();
        let number = |re: f64, im: f64| Complex64::new(re, im);
        let point = [number(1.0, 2.0), number(-0.5, 1.0), number(3.0, -1.0)];
        let row = [
            number(0.0, 0.0),
            number(1.0, 1.0),
            number(2.0, -1.0),
            number(0.5, 0.25),
        ];
        let value = |row: &[Complex64], x: &[Complex64]| -> Complex64 {
            row[0]
                + row[1..]
                    .iter()
                    .zip(x)
                    .map(|(a, x)| a * x)
                    .sum::<Complex64>()
        };
        for map in &maps {
            let value_at_image = value(&map.slice(&row), &map.image(&point));
            assert!(
                (value_at_image - value(&row, &point)).norm_sqr() < 1e-24,
                "{value_at_image}"
            );
        }
        assert_eq!(maps[0].image(&point), [point[1], point[2], point[0]]);
    }

    #[test]
    fn what_is_no_linear_map_is_refused() {
        for wrong in [
            r#"[{"map": {"x": "x^2"}}]"#,
            r#"[{"map": {"x": "1/x"}}]"#,
            r#"[{"map": {"x": "y"}}]"#,
        ] {
            let refused = LinearMap::all(&read(wrong)).unwrap_err();
            assert_eq!(refused, GeneratorError::NotLinear(1), "{wrong}");
        }
    }

    #[test]
    fn pairs_and_classes_go_with_their_images() {
        let mut images = PointImages::default();
        // Two squares that are turned, and exchanged.
        for permutation in [[1, 2, 3, 0, 5, 6, 7, 4], [4, 5, 6, 7, 0, 1, 2, 3]] {
            for _ in 0..WAYS {
                images.take(Some(permutation.to_vec()));
            }
        }
        assert_eq!(images.least_of_each(&[2, 3, 5]), [2]);
        let pairs = images.with_images(vec![[0, 2]], Some(1));
        for pair in [[0, 2], [1, 3], [4, 6], [5, 7]] {
            let turned = [pair[1], pair[0]];
            assert!(
                pairs.contains(&pair) || pairs.contains(&turned),
                "{pairs:?}"
            );
        }
        let classes: [&[usize]; 4] = [&[0, 2], &[1, 3], &[4, 6], &[5, 7]];
        assert_eq!(images.orbits(&classes), Some(vec![0; 4]));
        let torn: [&[usize]; 3] = [&[0, 1], &[2, 3], &[4, 5, 6, 7]];
        assert_eq!(images.orbits(&torn), None);
        images.take(None);
        assert_eq!((images.next(), images.refused()), ((3, 0), 1));
        // Nothing is left of a generator that one way refuses.
        images.take(Some((0..8).collect()));
        images.take(None);
        assert_eq!((images.generators(), images.refused()), (4, 2));
        assert_eq!(images.count(), 2 * WAYS);
    }
}
