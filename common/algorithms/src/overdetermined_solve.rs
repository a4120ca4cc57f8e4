//! Isolated solutions of more equations than unknowns, equation by equation: what each equation leaves of the sets
//! that those before have in common.
//!
//! Combinations of the equations have as many paths as their degrees say, however few solutions all equations have
//! together. Here the equations cut as they are, one after the other ([`crate::decomposition`]); at last every
//! isolated point is a path that stays where it is, of the combinations that any other start would track.

use crate::answer::Answer;
use crate::decomposition::DecompositionSolve;
use crate::finite_endpoints::FiniteEndpoints;
use crate::opening::Opening;
use crate::progress::{Progress, VerdictCounts};
use crate::retried_stage::RetriedStage;
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::start_points::StoredPoints;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::work::{Stage, StageId};
use cognate_solutions::classification::Tolerances;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::{History, SolutionSet};
use cognate_solutions::witness::{Decomposition, Doubt};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::denominator_factors;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// Equation by equation, to isolated points alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OverdeterminedSolve {
    decomposition: DecompositionSolve,
    /// Stage in which the combinations are tracked to the target; its start points are found first.
    last: Stage,
    shape: PointShape,
    tolerances: Tolerances,
    /// Paths that stay at the points, once the points are known and there are some.
    arrived: Option<RetriedStage>,
}

impl OverdeterminedSolve {
    /// Solve for the points that the decomposition finds in dimension 0. `last` describes how the combinations,
    /// `tracked`, are tracked to the target, from any start points.
    pub fn new(
        decomposition: DecompositionSolve,
        last: Stage,
        tracked: &System,
        tolerances: Tolerances,
    ) -> Self {
        Self {
            decomposition,
            last,
            shape: PointShape::of(tracked),
            tolerances,
            arrived: None,
        }
    }

    /// The stage at the isolated points that were found; `None` where there are none.
    fn arrival(&self, decomposition: &Decomposition) -> Option<RetriedStage> {
        let isolated = decomposition
            .components
            .iter()
            .filter(|set| set.dimension() == 0);
        let points: Vec<&Vec<Complex64>> = isolated.flat_map(|set| &set.points).collect();
        let dimension = points.first()?.len();
        let stored = Arc::new(StoredPoints {
            dimension,
            coordinates: points.into_iter().flatten().copied().collect(),
        });
        let parameters = self.parameters().into_owned();
        let stage = Stage {
            homotopy: HomotopyKind::Parameter {
                start: parameters.clone(),
                targets: vec![parameters],
            },
            start_points: stored.as_start(),
            ..self.last.clone()
        };
        let opening = Opening {
            stage,
            system: None,
            objects: vec![stored],
        };
        let tolerances = self.tolerances.clone();
        let stage = RetriedStage::with_shape(opening, self.shape.clone(), tolerances, 1);
        Some(stage.with_max_retries(self.decomposition.max_retries()))
    }

    /// Values of the parameters that are asked; none where the system has none.
    fn parameters(&self) -> Cow<'_, [Complex64]> {
        // Planning has put 0 in the place of a path variable.
        let asked = self.last.homotopy.end_parameters(0, None);
        asked.unwrap_or_default()
    }

    /// The last results of the paths that the answer counts: those at isolated points, and after them one that failed
    /// for each path or point of which the decomposition does not know what it leads to.
    fn results(&self) -> Vec<PathResult> {
        let arrived = self.arrived.as_ref();
        let mut results = arrived.map_or(Vec::new(), |stage| stage.results().to_vec());
        let doubts = self.doubts();
        let lost: u64 = doubts.into_iter().map(standing_for).sum();
        let nowhere = vec![Complex64::default(); self.shape.coordinates()];
        for _ in 0..lost {
            let failed = PathOutcome::Failed(Failure::EndgameUnsettled);
            let origin = results.len() as u64;
            results.push(PathResult {
                t: Complex64::new(1.0, 0.0),
                ..PathResult::untracked(origin, 0, failed, nowhere.clone())
            });
        }
        results
    }

    /// Doubts that the decomposition leaves open.
    fn doubts(&self) -> Vec<&Doubt> {
        let Some(decomposition) = self.decomposition.decomposition() else {
            return Vec::new();
        };
        let of_dimensions = decomposition.dimensions.iter().flat_map(|d| &d.doubts);
        let of_sets = decomposition
            .components
            .iter()
            .flat_map(|set| &set.evidence.doubts);
        of_dimensions.chain(of_sets).collect()
    }

    fn has_arrived(&self) -> bool {
        self.decomposition.decomposition().is_some()
    }
}

/// Number of paths or points that a doubt is about.
fn standing_for(doubt: &Doubt) -> u64 {
    match doubt {
        Doubt::FailedPaths { paths } => *paths,
        Doubt::Junk { points }
        | Doubt::NotDeflated { points }
        | Doubt::NotCut { points }
        | Doubt::Asked { points } => *points,
        _ => 1,
    }
}

impl Solve for OverdeterminedSolve {
    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        loop {
            if let Some(stage) = &mut self.arrived {
                return stage.next_stage(numbers);
            }
            match self.decomposition.next(numbers) {
                Next::Done => {}
                other => return other,
            }
            let decomposition = self.decomposition.decomposition();
            self.arrived = decomposition.and_then(|decomposition| self.arrival(decomposition));
            if self.arrived.is_none() {
                return Next::Done;
            }
        }
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        match &mut self.arrived {
            Some(arrived) => arrived.absorb(stage, results),
            None => self.decomposition.absorb(stage, results),
        }
    }

    fn failure(&self) -> Option<String> {
        self.decomposition.failure()
    }

    fn progress(&self) -> Progress {
        let before = self.decomposition.progress();
        let Some(stage) = &self.arrived else {
            let failed = match self.has_arrived() {
                true => self.results().len() as u64,
                false => 0,
            };
            let paths = VerdictCounts {
                failed,
                ..VerdictCounts::default()
            };
            return Progress { paths, ..before };
        };
        let mut present = stage.progress("isolated points");
        present.stages.splice(0..0, before.stages);
        present.paths.failed += (self.results().len() - stage.results().len()) as u64;
        present
    }

    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        let endpoints = self.arrived.as_ref()?.finite_endpoints();
        Some(FiniteEndpoints {
            homotopy: self.last.homotopy.clone(),
            ..endpoints
        })
    }

    fn answer(&self, system: &System) -> Option<Answer> {
        if !self.has_arrived() {
            return None;
        }
        let doubts: Vec<String> = self.doubts().iter().map(ToString::to_string).collect();
        let history = History {
            complete_start: true,
            may_miss: (!doubts.is_empty()).then(|| doubts.join("; ")),
            ..match &self.arrived {
                Some(stage) => stage.history(0, true),
                None => History::default(),
            }
        };
        let (tolerances, seed) = (&self.tolerances, self.last.seed);
        let parameters = self.parameters();
        let results = self.results();
        let mut set = SolutionSet::new(system, &parameters, &results, &history, tolerances, seed);
        set.warnings.extend(doubts);
        if self.decomposition.has_sets_above() {
            // Without a path to them they are not told from sets where a denominator is 0.
            let has_denominators = !denominator_factors(system).is_empty();
            set.counts.positive_dimensional = (!has_denominators).then_some(true);
        }
        Some(Answer::from(vec![set]))
    }

    fn renumbered_results(&self) -> Option<Vec<PathResult>> {
        Some(self.results())
    }

    /// The stage of the isolated points, where there is one.
    fn counted_stage(&self) -> StageId {
        self.arrived
            .as_ref()
            .map_or(StageId(0), RetriedStage::first_id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{SolveOptions, plan};
    use crate::restarts::with_restarts;
    use crate::run_locally::run_locally;
    use crate::start_kind::StartKind;
    use crate::synthetic::declared;
    use crate::{AnySolve, PathAlgorithm};
    use cognate_solutions::completeness::Completeness;

    /// 1156 paths by degrees, and one point.
    const ONE_POINT: &str = "variable_group x, y; function f, g, h; \
        f = (x - 1)*(x^33 - y - 2); g = (y - 1)*(y^33 - x - 3); h = x^2*y - 1;";

    #[test]
    fn one_point_of_many_paths_is_found_by_few() {
        let system = declared(ONE_POINT);
        for seed in 1..=2 {
            let mut options = SolveOptions {
                seed,
                ..SolveOptions::default()
            };
            options.tracking.max_retries = 5;
            let mut plan = plan(&system, &options).unwrap();
            assert_eq!((plan.start, plan.paths), (StartKind::Regeneration, None));
            assert!(plan.why.contains("1156 paths"), "{}", plan.why);
            let AnySolve::Overdetermined(solve) = plan.algorithm.solve().clone() else {
                panic!("{}", plan.why);
            };
            assert_eq!(solve.decomposition.max_retries(), 5);
            let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8).unwrap();
            let set = &sets[0];
            assert_eq!((set.paths.total, set.counts.nonsingular), (1, 1));
            assert_eq!(set.counts.real, Some(1));
            assert!(set.settled() && set.counts.complete == Completeness::Yes);
            let progress = plan.algorithm.progress();
            assert!(progress.done && progress.paths.finite == 1, "{progress:?}");
            let tracked: u64 = progress.stages.iter().map(|stage| stage.items).sum();
            assert!(tracked < 500, "{tracked} items");
            let mut opened = 0;
            let solve = AnySolve::Overdetermined(solve);
            let restarted = with_restarts(solve, &plan.system, &mut |_| opened += 1);
            // The plan counts exactly, the solve alone does not.
            let restarted_set = &restarted.solution_sets(&plan.system)[0];
            assert_eq!(restarted_set.solutions, set.solutions);
            assert_eq!(restarted_set.paths, set.paths);
            let exact = set.counts.exact_count.as_ref();
            assert_eq!(exact.and_then(|exact| exact.with_multiplicity), Some(1));
            assert_eq!(opened, progress.stages.len());
        }
    }

    /// The equations of `ONE_POINT` changed to have no common point, or to have a common curve beside the point.
    #[test]
    fn none_is_an_answer_and_a_curve_is_none() {
        let solved = |text: &str| {
            let system = declared(text);
            let mut plan = plan(&system, &SolveOptions::default()).unwrap();
            assert!(matches!(
                plan.algorithm.solve(),
                AnySolve::Overdetermined(_)
            ));
            let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8).unwrap();
            assert!(plan.algorithm.progress().done);
            (sets[0].clone(), (sets[0].paths.total, sets[0].settled()))
        };
        let exact = |set: &SolutionSet| set.counts.exact_count.clone();
        let none = ONE_POINT.replace("x^2*y - 1", "x^2*y - 3");
        let (set, counts) = solved(&none);
        assert_eq!(counts, (0, true));
        // No path was left to follow: the equations are asked.
        assert_eq!(
            exact(&set).and_then(|count| count.with_multiplicity),
            Some(0)
        );
        let curve = ["f", "g", "h"]
            .iter()
            .fold(ONE_POINT.to_string(), |text, f| {
                text.replace(&format!("{f} = "), &format!("{f} = (x + y - 7)*"))
            });
        let curve = curve.replace("*x^2*y - 1", "*(x^2*y - 1)");
        let (set, counts) = solved(&curve);
        assert_eq!(counts, (1, true), "{:?}", set.warnings);
        assert_eq!(exact(&set).map(|count| count.dimension), Some(1));
        assert_eq!(set.counts.positive_dimensional, Some(true));
        let alone = curve.replace("x^2*y - 1", "x^2*y - 3");
        let (set, counts) = solved(&alone);
        assert_eq!(counts, (0, true), "{:?}", set.warnings);
        assert_eq!(exact(&set).map(|count| count.dimension), Some(1));
        assert_eq!(set.counts.positive_dimensional, Some(true));
    }

    #[test]
    fn what_is_in_doubt_stands_for_paths_that_failed() {
        assert_eq!(standing_for(&Doubt::NotCut { points: 224 }), 224);
        assert_eq!(standing_for(&Doubt::FailedPaths { paths: 3 }), 3);
        assert_eq!(standing_for(&Doubt::PointsMissing), 1);
    }
}
