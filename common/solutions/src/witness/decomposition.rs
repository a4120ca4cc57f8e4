//! Decomposition: all components of all dimensions, and how the paths that found them add up.

use super::evidence::Doubt;
use super::family::Family;
use super::method::{Method, Verification};
use super::witness_set::{WitnessSet, sharing_slices};
use crate::completeness::Completeness;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Counts of the paths to one dimension.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dimension {
    /// The dimension.
    pub number: u32,
    /// Paths that ended at solutions of the given equations.
    pub superset: u64,
    /// Paths of the superset that ended at points of sets of higher dimension.
    pub junk: u64,
    /// Paths of the superset that ended at components that were taken away from the answer.
    #[serde(default)]
    pub removed: u64,
    /// Paths that ended at solutions of combinations of the equations alone, in the last dimension.
    pub excess: u64,
    /// Paths that failed on the way to this dimension.
    pub failed: u64,
    /// Paths that must have been lost: loops found witness points that no path reached.
    #[serde(default)]
    pub found_by_loops: u64,
    /// Sum of the degrees of the components of this dimension.
    pub degree: u64,
    /// Whether all components of this dimension are found.
    pub complete: Completeness,
    /// Doubts about the components of this dimension.
    pub doubts: Vec<Doubt>,
}

/// Paths that were tracked, counted without repetitions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrackedPaths {
    /// Number of all tracked paths.
    pub total: u64,
    /// Paths that failed.
    pub failed: u64,
    /// Number of times that a path was tracked again.
    pub retracked: u64,
    /// Groups of paths that met.
    pub crossings_found: u64,
    /// Groups of paths that met and came apart when they were tracked again.
    pub crossings_resolved: u64,
}

impl TrackedPaths {
    /// Counts others with these.
    pub fn add(&mut self, other: &Self) {
        self.total += other.total;
        self.failed += other.failed;
        self.retracked += other.retracked;
        self.crossings_found += other.crossings_found;
        self.crossings_resolved += other.crossings_resolved;
    }
}

/// A component of the equations that were tracked which is none of those that were given.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RemovedComponent {
    /// Reason why the component was removed: `a denominator is 0`.
    pub reason: String,
    /// The dimension of the component.
    pub dimension: u32,
    /// The degree of the component.
    pub degree: u64,
}

/// All irreducible components of a system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decomposition {
    /// Names of the variables, in the order of the coordinates.
    pub variables: Vec<String>,
    /// Method by which the witness points were found.
    pub method: Method,
    /// Comparison with a second method; `None` where none was asked for.
    pub verification: Option<Verification>,
    /// Whether these are components of a locus that was asked for, and not all components of the equations.
    pub locus: bool,
    /// Lowest and highest dimension of the components that are wanted.
    pub asked: [u32; 2],
    /// The components: by dimension, degree and multiplicity, largest first.
    #[serde(deserialize_with = "sharing_slices")]
    pub components: Vec<WitnessSet>,
    /// The dimensions that were asked, highest first.
    pub dimensions: Vec<Dimension>,
    /// Paths that were tracked to the superset.
    pub paths: TrackedPaths,
    /// Paths that were tracked in loops to tell the points of the superset apart.
    pub paths_of_loops: TrackedPaths,
    /// Components transferred from a general member of the family, where these were known.
    #[serde(default)]
    pub family: Option<Family>,
    /// Components that were taken away from the answer: in no other count but those of paths.
    #[serde(default)]
    pub removed: Vec<RemovedComponent>,
}

impl Decomposition {
    /// Whether every claim is settled, and something was asked.
    pub fn settled(&self) -> bool {
        !self.dimensions.is_empty()
            && self.components.iter().all(WitnessSet::settled)
            && self
                .dimensions
                .iter()
                .all(|d| d.doubts.is_empty() && d.complete == Completeness::Yes)
    }

    /// Compares with what a second way found: dimension by dimension, in degrees, multiplicities and counts. A
    /// difference is a doubt in its dimension.
    pub fn verify(&mut self, second: &Self) {
        let mut agrees = true;
        for dimension in &mut self.dimensions {
            let number = dimension.number;
            let (listing, other) = (
                listed(&self.components, number),
                listed(&second.components, number),
            );
            if listing != other {
                agrees = false;
                dimension.complete = Completeness::NotKnown;
                dimension.doubts.push(Doubt::Differs {
                    method: second.method,
                    found: in_words(&other),
                });
            }
        }
        self.verification = Some(Verification {
            method: second.method,
            agrees,
            settled: second.settled(),
        });
    }

    /// Whether the paths add up in every dimension: paths to solutions and lost paths to points that loops found on one
    /// side, paths to components, each counted with the paths to its witness points, and to junk on the other.
    pub fn adds_up(&self) -> bool {
        let explained = |d: &Dimension| d.junk + d.removed + paths_to(&self.components, d.number);
        let mut dimensions = self.dimensions.iter();
        dimensions.all(|d| d.superset + d.found_by_loops == explained(d))
    }

    /// Notes in each dimension by how much its counts do not add up, where nothing else explains that.
    pub fn check_counts(&mut self) {
        for dimension in &mut self.dimensions {
            let explained =
                dimension.junk + dimension.removed + paths_to(&self.components, dimension.number);
            let superset = dimension.superset + dimension.found_by_loops;
            if superset != explained && dimension.doubts.is_empty() {
                dimension.complete = Completeness::NotKnown;
                dimension.doubts.push(Doubt::Counts {
                    superset,
                    explained,
                });
            }
        }
    }
}

/// Paths to the witness points of a dimension.
fn paths_to(components: &[WitnessSet], dimension: u32) -> u64 {
    let witness_sets = components.iter();
    let witness_sets = witness_sets.filter(|set| set.dimension() == dimension);
    witness_sets
        .map(|set| set.degree * set.multiplicity.tracked)
        .sum()
}

/// Components of a dimension by degree and multiplicity, with how many there are.
type Listed = BTreeMap<(u64, Option<u64>), u64>;

fn listed(components: &[WitnessSet], dimension: u32) -> Listed {
    let mut listed = Listed::new();
    for set in components.iter().filter(|set| set.dimension() == dimension) {
        *listed
            .entry((set.degree, set.multiplicity.scheme))
            .or_default() += 1;
    }
    listed
}

fn in_words(listed: &Listed) -> String {
    let each = listed.iter().rev().map(|((degree, multiplicity), count)| {
        let multiplicity = match multiplicity {
            Some(1) => String::new(),
            Some(m) => format!(" and multiplicity {m}"),
            None => " and unknown multiplicity".into(),
        };
        format!("{count} of degree {degree}{multiplicity}")
    });
    match listed.is_empty() {
        true => "nothing".into(),
        false => each.collect::<Vec<_>>().join(", "),
    }
}
