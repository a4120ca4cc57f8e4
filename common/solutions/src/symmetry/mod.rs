//! Symmetry: a finite group that acts on the solutions, and its orbits.
//!
//! Generators come from the user, permutations of the variables or rational
//! maps. The group itself is found at one generic point: the shortest words
//! in the generators that lead to different points.

pub mod action;
pub mod classes;
mod generators;

use crate::point_shape::PointShape;
use crate::unique_points::{Neighbourhood, clusters};
use action::Action;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Largest group that is followed. The groups of mechanisms have 2 to 48 elements.
pub const MAX_ORDER: usize = 1000;
/// Images of one point under different words are one when they are this near, relative to their
/// size. Rounding moves them by some 1e-15 a letter; different solutions are farther apart.
const SAME: f64 = 1e-8;
/// Distance by which a point is moved to measure how much a word magnifies errors.
const NUDGE: f64 = 1e-7;
/// Images whose errors are magnified by more than this are not used for comparison: a map near
/// one of its poles says nothing.
const MOST_MAGNIFIED: f64 = 1e5;

/// Solutions at which a group is looked for, and its generators are tried.
const TRIED: usize = 32;

/// Reason why a group cannot be followed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SymmetryError {
    /// A generator that is no rational map over the rationals.
    #[error(
        "not in this version: symmetry generator {0} contains a parameter, a root or an \
         elementary function"
    )]
    NotRational(usize),
    /// The group has more elements than are followed.
    #[error("the symmetry group has more than {MAX_ORDER} elements, or is no finite group")]
    TooLarge,
    /// A map that takes two points to one, or of which powers come ever nearer to a point.
    #[error("symmetry generator {0} is no invertible map of finite order")]
    NotInvertible(usize),
    /// A map that does not exist at the solution where the group was looked for.
    #[error("symmetry generator {0} has no finite value at a solution of generic parameters")]
    Pole(usize),
}

/// A group by its generators and, once it was closed, its words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SymmetryGroup {
    generators: Vec<Action>,
    /// Letters are applied from first to last; the first word is empty.
    words: Vec<Vec<u16>>,
}

/// An image of a point under one element of the group.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Values of the variables.
    pub values: Vec<Complex64>,
    /// Factor by which errors of the point are larger in the image, at least 1.
    pub magnification: f64,
}

impl SymmetryGroup {
    /// The generators of a checked system. Its words are found by [`Self::close`]; until then the
    /// group is trivial.
    pub fn of(system: &System) -> Result<Self, SymmetryError> {
        let generators = system.symmetry.iter().enumerate();
        let generators = generators
            .map(|(k, g)| Action::of(g, system).ok_or(SymmetryError::NotRational(k + 1)))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            generators,
            words: vec![Vec::new()],
        })
    }

    /// The group of nothing but the identity.
    pub fn trivial() -> Self {
        Self {
            generators: Vec::new(),
            words: vec![Vec::new()],
        }
    }

    /// Number of elements of the group.
    pub fn order(&self) -> usize {
        self.words.len()
    }

    /// True where there is nothing but the identity.
    pub fn is_trivial(&self) -> bool {
        self.generators.is_empty()
    }

    /// Finds the elements, as words that lead from this point to different ones.
    pub fn close(&mut self, point: &[Complex64], shape: &PointShape) -> Result<(), SymmetryError> {
        let mut words: Vec<Vec<u16>> = vec![Vec::new()];
        let mut points = vec![(point.to_vec(), shape.to_coordinates(point))];
        // For each generator, the points that are images under it.
        let mut images = vec![BTreeSet::new(); self.generators.len()];
        let mut next = 0;
        while next < words.len() {
            for (letter, generator) in self.generators.iter().enumerate() {
                let image = generator.image(&points[next].0);
                let image = image.ok_or(SymmetryError::Pole(letter + 1))?;
                let coordinates = shape.to_coordinates(&image);
                let is_listed =
                    |p: &(_, Vec<Complex64>)| shape.distance(&p.1, &coordinates) <= SAME;
                let place = points.iter().position(is_listed);
                if !images[letter].insert(place.unwrap_or(points.len())) {
                    return Err(SymmetryError::NotInvertible(letter + 1));
                }
                if place.is_some() {
                    continue;
                }
                if words.len() == MAX_ORDER {
                    return Err(SymmetryError::TooLarge);
                }
                let mut word = words[next].clone();
                word.push(letter as u16);
                words.push(word);
                points.push((image, coordinates));
            }
            next += 1;
        }
        self.words = words;
        Ok(())
    }

    /// The group as it acts on a random point, or where its maps are no finite group away from solutions, on these.
    pub fn acting(
        &self,
        points: &[(&[Complex64], f64)],
        shape: &PointShape,
    ) -> Result<Self, SymmetryError> {
        let mut random = RandomStream::new(0, Purpose::Probe, 2);
        let coordinates: Vec<Complex64> = (0..shape.coordinates())
            .map(|_| random.unit() * (0.5 + random.uniform()))
            .collect();
        let mut group = self.clone();
        match group.close(&shape.to_variables(&coordinates), shape) {
            Ok(()) => Ok(group),
            Err(_) => self.seen_at(points, shape),
        }
    }

    /// The group as these solutions show it: the largest that one of them leads to. A special
    /// solution, which some element fixes, shows only a part.
    pub fn seen_at(
        &self,
        points: &[(&[Complex64], f64)],
        shape: &PointShape,
    ) -> Result<Self, SymmetryError> {
        let mut best: Option<Self> = None;
        let mut refused = None;
        for (values, _) in points.iter().take(TRIED) {
            let mut here = self.clone();
            match here.close(values, shape) {
                Ok(()) if best.as_ref().is_none_or(|b| b.order() < here.order()) => {
                    best = Some(here);
                }
                Ok(()) => {}
                Err(error) => refused = Some(error),
            }
        }
        match (best, refused) {
            (Some(group), _) => Ok(group),
            (None, Some(error)) => Err(error),
            (None, None) => Ok(self.clone()),
        }
    }

    /// Images of these points that are not among them, each once: with a true symmetry of a
    /// system, solutions that were not found.
    pub fn missing(
        &self,
        points: &[(&[Complex64], f64)],
        shape: &PointShape,
        seed: u64,
    ) -> Vec<Vec<Complex64>> {
        let mut values: Vec<Vec<Complex64>> = points.iter().map(|(v, _)| v.to_vec()).collect();
        let mut radii: Vec<f64> = points.iter().map(|(_, radius)| *radius).collect();
        for (point, radius) in points {
            for image in self.images(point, shape).into_iter().flatten().skip(1) {
                if image.magnification <= MOST_MAGNIFIED {
                    values.push(image.values);
                    radii.push(radius * 2.0 * image.magnification);
                }
            }
        }
        let neighbourhoods: Vec<(&[Complex64], f64)> =
            values.iter().map(Vec::as_slice).zip(radii).collect();
        let orbits = Self::trivial().orbits(&neighbourhoods, shape, seed);
        let new = orbits.iter().filter(|orbit| orbit[0] >= points.len());
        new.map(|orbit| values[orbit[0]].clone()).collect()
    }

    fn apply(&self, word: &[u16], values: &[Complex64]) -> Option<Vec<Complex64>> {
        word.iter().try_fold(values.to_vec(), |values, &letter| {
            self.generators[usize::from(letter)].image(&values)
        })
    }

    /// The images of a point under all elements, the point itself first; `None` where a map does
    /// not exist there.
    pub fn images(&self, values: &[Complex64], shape: &PointShape) -> Vec<Option<Image>> {
        let mut random = RandomStream::new(0, Purpose::Probe, 1);
        let mut nudged = shape.to_coordinates(values);
        for z in &mut nudged {
            *z += random.unit() * NUDGE;
        }
        let nudged = shape.to_variables(&nudged);
        self.words
            .iter()
            .map(|word| {
                let image = self.apply(word, values)?;
                if word.is_empty() {
                    return Some(Image {
                        values: image,
                        magnification: 1.0,
                    });
                }
                let moved = self.apply(word, &nudged)?;
                let (at, moved) = (shape.to_coordinates(&image), shape.to_coordinates(&moved));
                if !shape.holds(&at) || !shape.holds(&moved) {
                    return None;
                }
                let magnification = (shape.distance(&at, &moved) / NUDGE).max(1.0);
                Some(Image {
                    values: image,
                    magnification,
                })
            })
            .collect()
    }

    /// The different images of a point, itself first. Images near a pole of their map are there
    /// too, though with few digits.
    pub fn orbit(&self, values: &[Complex64], shape: &PointShape) -> Vec<Vec<Complex64>> {
        let mut members: Vec<(Vec<Complex64>, Vec<Complex64>)> = Vec::new();
        for word in &self.words {
            let Some(image) = self.apply(word, values) else {
                continue;
            };
            let coordinates = shape.to_coordinates(&image);
            let is_member = members
                .iter()
                .any(|(_, other)| shape.distance(other, &coordinates) <= SAME);
            if !is_member {
                members.push((image, coordinates));
            }
        }
        members.into_iter().map(|(values, _)| values).collect()
    }

    /// Puts points whose orbits coincide together: members ascending, orbits by their first
    /// members. A point comes with the radius within which another is the same (see
    /// [`Neighbourhood`]). In n log n times the order of the group.
    pub fn orbits(
        &self,
        points: &[(&[Complex64], f64)],
        shape: &PointShape,
        seed: u64,
    ) -> Vec<Vec<usize>> {
        let mut owners = Vec::new();
        let mut images: Vec<(Vec<Complex64>, f64)> = Vec::new();
        for (owner, (values, radius)) in points.iter().enumerate() {
            let images_here = self.images(values, shape).into_iter().flatten();
            for image in images_here.filter(|image| image.magnification <= MOST_MAGNIFIED) {
                owners.push(owner);
                images.push((
                    shape.to_coordinates(&image.values),
                    radius * 2.0 * image.magnification,
                ));
            }
        }
        let neighbourhoods: Vec<Neighbourhood<'_>> = images
            .iter()
            .map(|(point, radius)| Neighbourhood {
                point,
                radius: *radius,
                refined: false,
            })
            .collect();
        let mut root: Vec<usize> = (0..points.len()).collect();
        let find = |root: &mut Vec<usize>, mut k: usize| {
            while root[k] != k {
                root[k] = root[root[k]];
                k = root[k];
            }
            k
        };
        for cluster in clusters(&neighbourhoods, shape, seed) {
            let first = find(&mut root, owners[cluster[0]]);
            let mut least = first;
            for &member in &cluster[1..] {
                let other = find(&mut root, owners[member]);
                let (small, large) = (least.min(other), least.max(other));
                root[large] = small;
                least = small;
            }
        }
        let mut place = vec![usize::MAX; points.len()];
        let mut orbits: Vec<Vec<usize>> = Vec::new();
        for point in 0..points.len() {
            let first = find(&mut root, point);
            if place[first] == usize::MAX {
                place[first] = orbits.len();
                orbits.push(Vec::new());
            }
            orbits[place[first]].push(point);
        }
        orbits
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::formats;

    /// Variables x, y with the exchange of the two and the map to (1/x, 1/y): a group of four.
    fn four() -> (System, PointShape) {
        let text = r#"{"variables": ["x", "y"], "equations": ["x*y - 1", "x + y - 5"],
            "symmetry": [{"permutation": {"x": "y", "y": "x"}}, {"map": {"x": "1/x", "y": "1/y"}}]}"#;
        let system = formats::read("test", text.as_bytes()).unwrap().system;
        let shape = PointShape::of(&system);
        (system, shape)
    }

    fn point(seed: u64) -> Vec<Complex64> {
        let mut random = RandomStream::new(seed, Purpose::Test, 4);
        vec![random.disc(), random.disc() * 3.0]
    }

    #[test]
    fn a_group_is_found_from_its_generators() {
        let (system, shape) = four();
        let mut group = SymmetryGroup::of(&system).unwrap();
        assert_eq!(group.order(), 1);
        group.close(&point(1), &shape).unwrap();
        assert_eq!(group.order(), 4);
        let images = group.images(&point(2), &shape);
        assert!(images.iter().all(Option::is_some));
        // 0 has no inverse: only the two images by exchange are left.
        let on_axis = [Complex64::new(0.0, 0.0), Complex64::new(2.0, 1.0)];
        let images = group.images(&on_axis, &shape);
        assert_eq!(images.iter().flatten().count(), 2);
    }

    #[test]
    fn points_of_one_orbit_come_together() {
        let (system, shape) = four();
        let mut group = SymmetryGroup::of(&system).unwrap();
        group.close(&point(1), &shape).unwrap();
        let mut orbit_points = Vec::new();
        for seed in 0..5 {
            let images = group.images(&point(10 + seed), &shape);
            orbit_points.extend(images.into_iter().flatten().map(|image| image.values));
        }
        // Member k of every orbit in turn.
        let order: Vec<usize> = (0..20).map(|i| (i % 5) * 4 + i / 5).collect();
        let points: Vec<(&[Complex64], f64)> = order
            .iter()
            .map(|&k| (orbit_points[k].as_slice(), 1e-10))
            .collect();
        let orbits = group.orbits(&points, &shape, 3);
        let expected: Vec<Vec<usize>> = (0..5)
            .map(|k| (0..4).map(|j| k + 5 * j).collect())
            .collect();
        assert_eq!(orbits, expected);
        // Of the last orbit one is taken away, of the first two.
        let some: Vec<(&[Complex64], f64)> = (2..19)
            .map(|k| (orbit_points[k].as_slice(), 1e-10))
            .collect();
        let missing = group.missing(&some, &shape, 3);
        let near = |a: &[Complex64], b: &[Complex64]| {
            let (a, b) = (shape.to_coordinates(a), shape.to_coordinates(b));
            shape.distance(&a, &b) < 1e-12
        };
        assert_eq!(missing.len(), 3);
        for gone in [0, 1, 19] {
            assert!(missing.iter().any(|point| near(point, &orbit_points[gone])));
        }
    }

    /// The order counts maps, also where each solution is fixed by some of them.
    #[test]
    fn the_order_is_that_at_general_points() {
        let order = |equations: &str, symmetry: &str, solution: [f64; 2]| {
            let text = format!(
                r#"{{"variables": ["x", "y"], "equations": {equations}, "symmetry": {symmetry}}}"#
            );
            let system = formats::read("test", text.as_bytes()).unwrap().system;
            let solution = solution.map(Complex64::from);
            let group = SymmetryGroup::of(&system).unwrap();
            let group = group.acting(&[(&solution, 1e-12)], &PointShape::of(&system));
            group.map(|group| group.order())
        };
        let exchange = r#"{"permutation": {"x": "y", "y": "x"}}"#;
        let squares = r#"["x^2 - 1", "y^2 - 1"]"#;
        let sign = r#"{"map": {"x": "-x", "y": "y"}}"#;
        let both = format!("[{exchange}, {sign}]");
        assert_eq!(order(squares, &both, [1.0, -1.0]), Ok(8));
        let line = r#"["x + y - 2", "x*y - 1"]"#;
        assert_eq!(order(line, &format!("[{exchange}]"), [1.0, 1.0]), Ok(2));
        // On x*y = 1 the map is an involution, elsewhere it is none.
        let inverse = r#"[{"map": {"x": "y", "y": "1/y"}}]"#;
        assert_eq!(
            order(r#"["x*y - 1", "x + y - 5"]"#, inverse, [4.0, 0.25]),
            Ok(2)
        );
        let double = r#"[{"map": {"x": "2*x", "y": "y/2"}}]"#;
        let refused = Err(SymmetryError::NotInvertible(1));
        assert_eq!(order(line, double, [1.0, 1.0]), refused);
        assert_eq!(order(line, r#"[{"map": {"x": "y"}}]"#, [1.0, 2.0]), refused);
    }

    #[test]
    fn an_infinite_group_is_refused() {
        let text = r#"{"variables": ["x"], "equations": ["x^2 - 1"],
            "symmetry": [{"map": {"x": "x + 1"}}]}"#;
        let system = formats::read("test", text.as_bytes()).unwrap().system;
        let shape = PointShape::of(&system);
        let mut group = SymmetryGroup::of(&system).unwrap();
        let start = [Complex64::new(0.5, 0.0)];
        assert_eq!(group.close(&start, &shape), Err(SymmetryError::TooLarge));
    }
}
