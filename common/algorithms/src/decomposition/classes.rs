//! Classes: witness points that belong together, and what pairs of points bring together.

use cognate_solutions::disjoint_sets::DisjointSets;
use cognate_solutions::witness::Trace;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Points that belong together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Class {
    /// Numbers of the points within the set.
    pub points: Vec<usize>,
    /// Evidence that the class is a component, once it is one.
    pub closed: Option<Trace>,
}

impl Class {
    /// A point by itself.
    pub fn of(point: usize) -> Self {
        Self {
            points: vec![point],
            closed: None,
        }
    }
}

/// Place of each point in the list.
pub(super) fn places(points: &[usize]) -> BTreeMap<usize, usize> {
    let places = points.iter().enumerate();
    places.map(|(k, &point)| (point, k)).collect()
}

/// The points in the parts that these pairs leave; `place`: where each point of the set is among them.
pub(super) fn parts<'a>(
    points: &[usize],
    place: &BTreeMap<usize, usize>,
    pairs: impl Iterator<Item = &'a [usize; 2]>,
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

/// Joins the classes of each of these pairs of points.
pub(super) fn join(classes: &mut Vec<Class>, pairs: &[[usize; 2]]) {
    let mut place: BTreeMap<usize, usize> = BTreeMap::new();
    for (k, class) in classes.iter().enumerate() {
        place.extend(class.points.iter().map(|&point| (point, k)));
    }
    let places: Vec<usize> = (0..classes.len()).collect();
    let identity: BTreeMap<usize, usize> = places.iter().map(|&k| (k, k)).collect();
    let joined: Vec<[usize; 2]> = pairs
        .iter()
        .map(|pair| pair.map(|point| place[&point]))
        .collect();
    let together = parts(&places, &identity, joined.iter());
    let mut before: Vec<Option<Class>> = std::mem::take(classes).into_iter().map(Some).collect();
    for members in together {
        let mut taken = members.into_iter().filter_map(|k| before[k].take());
        if let Some(mut first) = taken.next() {
            for other in taken {
                first.points.extend(other.points);
            }
            classes.push(first);
        }
    }
}
