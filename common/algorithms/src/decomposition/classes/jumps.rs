//! Jumps: permutations in which paths changed to another component are found by the parts that are closed without
//! them, and taken back.

use super::{Class, Classes};
use crate::decomposition::moved::is_closed;
use cognate_solutions::disjoint_sets::DisjointSets;
use std::collections::BTreeMap;

/// Most parts of a class of which all unions are tried, to tell a false permutation.
const MOST_PARTS: usize = 12;

/// A permutation of the points that joins classes.
#[derive(Clone, Copy, PartialEq)]
enum Permutation {
    /// By the loop with this number.
    Loop(usize),
    /// By the symmetry group, with this number.
    Symmetry(usize),
}

/// Verdict on the permutations that joined a closed class.
enum Verdict {
    /// Without any of the permutations no proper part of the class is closed.
    Sound,
    /// Without one of the permutations the class falls into more parts than can be tried in all unions.
    Untested,
    /// Without this permutation the class falls into these parts, some of which are closed together.
    Jumped(Permutation, Vec<Vec<usize>>),
}

impl Classes {
    /// Takes back what permutations did in which paths jumped from one component to another: classes that one
    /// permutation brought together to a closed one, of which a proper part is closed without it. No proper part of a
    /// component is.
    pub(super) fn take_jumps_back(&mut self) {
        let mut k = 0;
        while k < self.classes.len() {
            let class = &self.classes[k];
            let Verdict::Jumped(permutation, parts) = self.verdict(class) else {
                k += 1;
                continue;
            };
            let points = self.classes.remove(k).points;
            let parts = match permutation {
                Permutation::Loop(number) => {
                    self.loops[number].retain(|pair| !points.contains(&pair[0]));
                    parts
                }
                Permutation::Symmetry(number) => {
                    // All permutations of its generator go.
                    self.symmetry.take_back(number);
                    parts_of(&points, &places(&points), &self.pairs(None))
                }
            };
            self.classes.extend(parts.into_iter().map(Class::open));
            self.taken_back += 1;
            k = 0;
        }
    }

    /// Whether an open class is closed, and more loops must confirm that no permutation that joined it jumped.
    pub(super) fn is_untested(&self, class: &Class) -> bool {
        matches!(self.verdict(class), Verdict::Untested)
    }

    /// Judges the permutations that joined an open class, if its sum is 0.
    fn verdict(&self, class: &Class) -> Verdict {
        let points = &class.points;
        let is_joined = class.closed.is_none() && points.len() > 1;
        if !is_joined || !is_closed(&self.trace(points.iter().copied())) {
            return Verdict::Sound;
        }
        let place = places(points);
        let loops = (0..self.loops.len()).map(Permutation::Loop);
        let symmetry = (0..self.symmetry.count()).map(Permutation::Symmetry);
        let mut verdict = Verdict::Sound;
        for permutation in loops.chain(symmetry) {
            let parts = parts_of(points, &place, &self.pairs(Some(permutation)));
            if parts.len() > MOST_PARTS {
                verdict = Verdict::Untested;
            } else if parts.len() > 1 && self.has_closed_part(&parts) {
                return Verdict::Jumped(permutation, parts);
            }
        }
        verdict
    }

    /// Pairs of points that the permutations bring together, without one of them.
    fn pairs(&self, without: Option<Permutation>) -> Vec<[usize; 2]> {
        let loops = self.loops.iter().enumerate();
        let loops = loops.filter(|(number, _)| without != Some(Permutation::Loop(*number)));
        let pairs = loops.flat_map(|(_, pairs)| pairs).copied().collect();
        let without_symmetry = match without {
            Some(Permutation::Symmetry(number)) => Some(number),
            Some(Permutation::Loop(_)) | None => None,
        };
        self.symmetry.with_images(pairs, without_symmetry)
    }

    /// Whether a proper union of these parts is closed.
    fn has_closed_part(&self, parts: &[Vec<usize>]) -> bool {
        let parts: Vec<&[usize]> = parts.iter().map(Vec::as_slice).collect();
        let proper_unions = 1..(1u32 << parts.len()) - 1;
        self.try_unions(&parts, proper_unions).closed.is_some()
    }
}

/// Place of each point in the list.
fn places(points: &[usize]) -> BTreeMap<usize, usize> {
    let places = points.iter().enumerate();
    places.map(|(k, &point)| (point, k)).collect()
}

/// The points in the parts that these pairs leave; `place`: where each point of the set is among them.
fn parts_of(
    points: &[usize],
    place: &BTreeMap<usize, usize>,
    pairs: &[[usize; 2]],
) -> Vec<Vec<usize>> {
    let mut joined = DisjointSets::new(points.len());
    for [from, to] in pairs {
        if let (Some(&a), Some(&b)) = (place.get(from), place.get(to)) {
            joined.join(a, b);
        }
    }
    let clusters = joined.clusters().into_iter();
    let of_points = |members: Vec<usize>| members.into_iter().map(|k| points[k]).collect();
    clusters.map(of_points).collect()
}
