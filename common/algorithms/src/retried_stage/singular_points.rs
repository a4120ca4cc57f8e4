//! SingularPoints: the points at which a stage's paths end singularly, and what is asked of them: whether they
//! are isolated.

use super::criteria::Criteria;
use super::path_store::PathStore;
use super::target_record::TargetRecord;
use crate::opening::Opening;
use cognate_continuation::local_dimension::Question;
use cognate_continuation::local_dimension::candidates::{self, Candidate};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::{Stage, Work};
use cognate_numeric::precision::DOUBLE;
use cognate_solutions::classification::{Decision, is_unconfirmed};
use cognate_solutions::degenerate::ASKED;
use cognate_solutions::path_crossing::coincidences;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Highest order of the functionals that are asked for at a singular endpoint, where the number of paths that end there
/// bounds its multiplicity.
const DEPTH: u32 = 40;
/// Highest order of the functionals where nothing bounds the multiplicity. Multiplicities of mechanisms are small; a
/// point whose dual space grows beyond this order stays undecided.
const DEPTH_WITHOUT_BOUND: u32 = 8;

/// The singular finite points of all targets, each by the paths that end there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct SingularPoints {
    /// Paths that end at each point. With an exchange, one of each two points that are images.
    points: Vec<Vec<u64>>,
    /// Places of the points of which something is not known, ascending: the items of the next stage.
    asked: Vec<usize>,
}

impl SingularPoints {
    /// The points at which paths end now.
    pub fn find(store: &PathStore, criteria: &Criteria) -> Self {
        let mut singular_points = Self::default();
        for (target, tracked) in store.by_target().enumerate() {
            let results = &*criteria.with_images(tracked);
            let decisions: Vec<Decision> = results.iter().map(|r| criteria.decide(r)).collect();
            let may_be_multiple = |decision: &Decision| decision.verdict.may_be_multiple();
            let mut singular: Vec<bool> = decisions.iter().map(may_be_multiple).collect();
            for place in not_asked(target, results, &decisions, criteria) {
                singular[place] = false;
            }
            let (shape, tolerances) = (&criteria.shape, &criteria.tolerances);
            let clusters = coincidences(results, shape, tolerances, criteria.first.seed, |place| {
                singular[place]
            });
            for members in clusters {
                // Results about an image hold for its path.
                let is_tracked = |&&m: &&usize| m < tracked.len();
                let mut held = members.iter().filter(is_tracked).peekable();
                if held.peek().is_none() {
                    continue;
                }
                if held.any(|&m| tracked[m].local_dimension.is_none()) {
                    singular_points.asked.push(singular_points.points.len());
                }
                let paths = members.iter().map(|&m| results[m].origin.0).collect();
                singular_points.points.push(paths);
            }
        }
        singular_points
    }

    /// Number of points about which something is to be asked.
    pub fn asked(&self) -> u64 {
        self.asked.len() as u64
    }

    /// The paths that end at the point of an item of the stage that asks.
    pub fn paths_of_item(&self, item: u64) -> &[u64] {
        let place = usize::try_from(item)
            .ok()
            .and_then(|k| self.asked.get(k))
            .copied();
        place.map_or(&[][..], |place| &self.points[place])
    }

    /// The stage that finds out whether points are isolated: one item for each, the most accurate of the
    /// endpoints there.
    pub fn opening(
        &self,
        store: &PathStore,
        targets: &[TargetRecord],
        criteria: &Criteria,
    ) -> Opening {
        let candidate = |&place: &usize| {
            let paths = &self.points[place];
            let result = most_accurate(paths, store);
            let target = criteria.target_of(result.origin.0);
            let record = &targets[target as usize];
            Candidate {
                values: (criteria.shape).to_variables(result.endpoint.to_double()),
                target,
                question: question(result.accuracy, paths.len() as u64, record, criteria),
            }
        };
        let points: Vec<Candidate> = self.asked.iter().map(candidate).collect();
        let points = Arc::new(candidates::to_stored(&points));
        Opening {
            stage: Stage {
                work: Work::LocalDimension,
                start_points: points.as_start(),
                ..criteria.first.clone()
            },
            system: None,
            objects: vec![points],
        }
    }

    /// The paths that doubles lead to one point of which deflated equations do not confirm that it is
    /// multiple: several points may lie there, closer together than doubles tell. Ascending.
    pub fn unconfirmed(&self, store: &PathStore, criteria: &Criteria) -> Vec<u64> {
        let complete = criteria.first.homotopy.takes_all_paths();
        let points = self.points.iter().filter(|paths| {
            let result = most_accurate(paths, store);
            let in_doubles = result.precision_bits <= DOUBLE;
            let number = complete.then_some(paths.len() as u64);
            in_doubles && is_unconfirmed(result, number, &criteria.tolerances)
        });
        let paths = points.flatten().map(|&path| criteria.tracked(path));
        let mut paths: Vec<u64> = paths.collect();
        paths.sort_unstable();
        paths.dedup();
        paths
    }

    /// The most accurate endpoint of each point.
    pub fn endpoints<'a>(&'a self, store: &'a PathStore) -> impl Iterator<Item = &'a PathResult> {
        self.points.iter().map(|paths| most_accurate(paths, store))
    }
}

/// The most accurate endpoint among the paths that end at one point.
fn most_accurate<'a>(paths: &[u64], store: &'a PathStore) -> &'a PathResult {
    let held = paths.iter().filter_map(|&path| store.get(path));
    held.min_by(|a, b| a.accuracy.total_cmp(&b.accuracy))
        .expect("a point is where a path ends")
}

/// Known facts about a singular point at which this many paths end, for the test whether it is isolated.
fn question(accuracy: f64, paths: u64, record: &TargetRecord, criteria: &Criteria) -> Question {
    // Paths of which the end is not known may all belong there.
    let failed = match criteria.exchange() {
        Some(_) => 2 * record.verdicts.failed,
        None => record.verdicts.failed,
    };
    let lost = criteria.lost + failed + record.crossings.paths().count() as u64;
    // Other homotopies may leave out paths, and then fewer than the multiplicity end there.
    let complete = criteria.first.homotopy.takes_all_paths();
    Question {
        accuracy,
        bound: if complete { paths + lost } else { u64::MAX },
        depth: if complete { DEPTH } else { DEPTH_WITHOUT_BOUND },
    }
}

/// Places of the endpoints in declared sets that are what a few others in the set are.
fn not_asked(
    target: usize,
    results: &[PathResult],
    decisions: &[Decision],
    criteria: &Criteria,
) -> Vec<usize> {
    let parameters = criteria.parameters(target);
    let (shape, tolerances) = (&criteria.shape, &criteria.tolerances);
    let sets = (criteria.declared).members(&parameters, results, decisions, shape, tolerances);
    let mut rest = Vec::new();
    for mut members in sets {
        members.sort_by(|&a, &b| results[a].accuracy.total_cmp(&results[b].accuracy));
        rest.extend(members.into_iter().skip(ASKED));
    }
    rest
}
