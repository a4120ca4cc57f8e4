//! Classes: which witness points of a set are on one component, by the evidence so far.
//!
//! A union of components, and nothing else, has witness points whose second derivatives along a moving slice have the
//! sum 0 (see `continuation::bend`): it is closed. A smallest closed set of points is a component. Permutations, by
//! loops of the slice and by a symmetry group, join classes; where few are left, all unions of them are tried.

mod jumps;
#[cfg(test)]
mod tests;

use super::moved::{MovedPoints, is_closed};
use super::symmetry::PointImages;
use cognate_continuation::bend::length;
use cognate_solutions::disjoint_sets::DisjointSets;
use cognate_solutions::witness::Trace;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Most classes of which all unions are tried.
const MOST_CLASSES: usize = 16;
/// A sum in doubles above this part of its terms' lengths is not 0: rounding errors are smaller.
const ROUGHLY_CLOSED: f64 = 1e-10;

/// Points that belong together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Class {
    /// Numbers of the points within the set.
    pub points: Vec<usize>,
    /// Evidence that the class is a component, once it is one.
    pub closed: Option<Trace>,
}

impl Class {
    /// Points of which no evidence says that they are a component.
    fn open(points: Vec<usize>) -> Self {
        Self {
            points,
            closed: None,
        }
    }
}

/// Classes of all witness points of a set, and the evidence for them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Classes {
    classes: Vec<Class>,
    second_derivatives: MovedPoints,
    /// Pairs of a point and its image under each loop, without points that came back to themselves.
    loops: Vec<Vec<[usize; 2]>>,
    /// Permutations of the points by a symmetry group.
    pub symmetry: PointImages,
    /// Smallest deviation from 0 of a sum that is not 0.
    smallest_wrong: Option<f64>,
    /// Number of permutations that joined points of different components, and were taken back.
    taken_back: u64,
}

impl Classes {
    /// A class for each of `count` points.
    pub fn of_single_points(count: usize) -> Self {
        Self {
            classes: (0..count).map(|point| Class::open(vec![point])).collect(),
            second_derivatives: MovedPoints::default(),
            loops: Vec::new(),
            symmetry: PointImages::default(),
            smallest_wrong: None,
            taken_back: 0,
        }
    }

    /// Takes points that were missing, each as a class, and forgets the images under the symmetry group, which are not
    /// known of these points.
    pub fn add_points(&mut self, points: Range<usize>) {
        let single_points = points.map(|point| Class::open(vec![point]));
        self.classes.extend(single_points);
        self.symmetry = PointImages::default();
    }

    /// Takes the second derivatives of the points after those of which they are known.
    pub fn add_second_derivatives(&mut self, second_derivatives: MovedPoints) {
        self.second_derivatives.extend(second_derivatives);
    }

    /// Number of points of which second derivatives are known.
    pub fn second_derivative_count(&self) -> usize {
        self.second_derivatives.count()
    }

    /// Number of permutations that were taken back.
    pub fn taken_back(&self) -> u64 {
        self.taken_back
    }

    /// Smallest deviation from 0 of a sum that is not 0, relative to the lengths of its terms.
    pub fn smallest_wrong(&self) -> Option<f64> {
        self.smallest_wrong
    }

    /// The sum of second derivatives over these points.
    pub fn trace(&self, points: impl Iterator<Item = usize>) -> Trace {
        self.second_derivatives.trace(points)
    }

    /// Classes that are not known to be components.
    pub fn open(&self) -> impl Iterator<Item = &Class> {
        self.classes.iter().filter(|class| class.closed.is_none())
    }

    /// Points of open classes, ascending.
    pub fn open_points(&self) -> Vec<usize> {
        let mut points: Vec<usize> = self.open().flat_map(|c| c.points.clone()).collect();
        points.sort_unstable();
        points
    }

    /// The sum of second derivatives over the points of all open classes.
    pub fn open_trace(&self) -> Trace {
        let points = self.open().flat_map(|class| &class.points);
        self.trace(points.copied())
    }

    /// Whether loops may find components: several classes are open, or one of which more loops must confirm that no
    /// permutation that joined it jumped.
    pub fn may_be_joined(&self) -> bool {
        self.open().count() > 1 || self.open().any(|class| self.is_untested(class))
    }

    /// Moves the classes out, and drops the second derivatives.
    pub fn take(&mut self) -> Vec<Class> {
        self.second_derivatives = MovedPoints::default();
        std::mem::take(&mut self.classes)
    }

    /// Joins the classes between which a loop leads, and their images under the symmetry group. `images`: where the
    /// loop takes each of `sources`. Whether there are fewer classes than before.
    pub fn join_by_loop(&mut self, sources: &[usize], images: &[usize]) -> bool {
        let class_count = self.classes.len();
        let pairs = sources.iter().zip(images);
        let pairs: Vec<[usize; 2]> = pairs
            .filter(|(source, image)| source != image)
            .map(|(&source, &image)| [source, image])
            .collect();
        self.join(&self.symmetry.with_images(pairs.clone(), None));
        self.loops.push(pairs);
        self.classes.len() < class_count
    }

    /// Joins the classes of each of these pairs of points.
    fn join(&mut self, pairs: &[[usize; 2]]) {
        let point_count = self.classes.iter().map(|class| class.points.len()).sum();
        let mut class_of = vec![0; point_count];
        for (number, class) in self.classes.iter().enumerate() {
            for &point in &class.points {
                class_of[point] = number;
            }
        }
        let mut joined = DisjointSets::new(self.classes.len());
        for &[a, b] in pairs {
            joined.join(class_of[a], class_of[b]);
        }
        let mut before = std::mem::take(&mut self.classes);
        for members in joined.clusters() {
            let mut members = members.into_iter().map(|k| std::mem::take(&mut before[k]));
            let mut first = members.next().expect("a cluster has members");
            for other in members {
                first.points.extend(other.points);
            }
            self.classes.push(first);
        }
    }

    /// Finds the classes that are components, alone or, where few are left, in unions. Before that, permutations that
    /// joined points of different components are taken back.
    pub fn close(&mut self) {
        self.take_jumps_back();
        for k in self.tested_places() {
            let trace = self.trace(self.classes[k].points.iter().copied());
            if is_closed(&trace) {
                self.classes[k].closed = Some(trace);
            } else {
                self.note_wrong(trace.deviation);
            }
        }
        while let Some((members, trace)) = self.smallest_closed_union() {
            let mut points = Vec::new();
            for &k in members.iter().rev() {
                points.extend(self.classes.remove(k).points);
            }
            points.sort_unstable();
            let closed = Some(trace);
            self.classes.push(Class { points, closed });
        }
    }

    /// Places of the open classes, without those that more loops must confirm.
    fn tested_places(&self) -> Vec<usize> {
        let places = 0..self.classes.len();
        let is_tested = |class: &Class| class.closed.is_none() && !self.is_untested(class);
        places.filter(|&k| is_tested(&self.classes[k])).collect()
    }

    fn note_wrong(&mut self, deviation: f64) {
        let least = self.smallest_wrong.unwrap_or(f64::INFINITY);
        self.smallest_wrong = Some(least.min(deviation));
    }

    /// The closed union of the fewest open classes, by their places, ascending; `None` where there is none or there are
    /// too many classes to try.
    fn smallest_closed_union(&mut self) -> Option<(Vec<usize>, Trace)> {
        let places = self.tested_places();
        if places.len() < 2 || places.len() > MOST_CLASSES {
            return None;
        }
        let parts: Vec<&[usize]> = places
            .iter()
            .map(|&k| self.classes[k].points.as_slice())
            .collect();
        let mut unions: Vec<u32> = (1..1u32 << parts.len())
            .filter(|union| union.count_ones() > 1)
            .collect();
        unions.sort_by_key(|union| (union.count_ones(), *union));
        let tried = self.try_unions(&parts, unions.into_iter());
        if let Some(deviation) = tried.smallest_wrong {
            self.note_wrong(deviation);
        }
        let (union, trace) = tried.closed?;
        Some((members(union).map(|k| places[k]).collect(), trace))
    }

    /// Tries unions of these parts, one after the other, until one is closed.
    fn try_unions(&self, parts: &[&[usize]], unions: impl Iterator<Item = u32>) -> TriedUnions {
        // Sums in doubles leave few unions to be looked at in all digits.
        let rough_sums: Vec<(Vec<Complex64>, f64)> = parts
            .iter()
            .map(|part| self.second_derivatives.rough(part))
            .collect();
        let mut tried = TriedUnions::default();
        for union in unions {
            let mut deviation = rough_deviation(&rough_sums, union);
            let is_wrong = deviation > ROUGHLY_CLOSED;
            if !is_wrong {
                let points = members(union).flat_map(|k| parts[k].iter().copied());
                let trace = self.trace(points);
                if is_closed(&trace) {
                    tried.closed = Some((union, trace));
                    return tried;
                }
                deviation = trace.deviation;
            }
            let least = tried.smallest_wrong.unwrap_or(f64::INFINITY);
            tried.smallest_wrong = Some(least.min(deviation));
        }
        tried
    }
}

/// Result of unions that were tried.
#[derive(Default)]
struct TriedUnions {
    /// The union that is closed, where one is: bit k stands for part k.
    closed: Option<(u32, Trace)>,
    /// Smallest deviation from 0 of the sums that are not 0.
    smallest_wrong: Option<f64>,
}

/// Numbers of the parts in a union.
fn members(union: u32) -> impl Iterator<Item = usize> {
    (0..u32::BITS as usize).filter(move |k| union >> k & 1 == 1)
}

/// Length of the sum over a union of parts, relative to the lengths of its terms.
fn rough_deviation(rough_sums: &[(Vec<Complex64>, f64)], union: u32) -> f64 {
    let variable_count = rough_sums.first().map_or(0, |(sum, _)| sum.len());
    let mut sum = vec![Complex64::default(); variable_count];
    let mut lengths = 0.0;
    for k in members(union) {
        let (part, part_lengths) = &rough_sums[k];
        lengths += part_lengths;
        for (sum, t) in sum.iter_mut().zip(part) {
            *sum += t;
        }
    }
    length(&sum) / lengths
}
