//! All isolated solutions of one system by a polyhedral homotopy, in two legs.
//!
//! Where there may be too many mixed cells to be counted in planning, workers count them first,
//! branch by branch. Then from the mixed cells to all solutions of the generic system with the
//! same monomials (toric homotopy), then from those to the system that is
//! asked. Each leg is a retried stage with its own crossing check; a path that
//! does not arrive in the first is named as failed in the end, so that the
//! counts add up to the mixed volume.

use crate::answer::Answer;
use crate::finite_endpoints::FiniteEndpoints;
use crate::opening::Opening;
use crate::plan_error::{PlanError, checked_volume};
use crate::progress::{self, Progress, StageProgress, VerdictCounts};
use crate::retried_stage::RetriedStage;
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::{PathIndex, PathResult};
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::start_systems::polyhedral::branches::{BranchCount, CellBranches};
use cognate_continuation::start_systems::polyhedral::mixed_cells::{
    MOST_LIFTINGS, MixedCellsError,
};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_solutions::classification::{Tolerances, Verdict};
use cognate_systems::polynomial::SolutionCount;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// With more paths than this it costs more to follow some of them twice than to follow all to their ends at once.
const MOST_COUNTED: usize = 3000;

/// The stages that count mixed cells: one, and another for each lifting that is not generic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Counting {
    stages: Vec<StageProgress>,
    /// The lifting that is next, or being counted.
    lifting: u32,
    outcome: Option<Result<(), String>>,
}

/// Mixed cells to a generic system, the generic system to the target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolyhedralSolve {
    /// `None` where the cells were counted in planning.
    counting: Option<Counting>,
    generic: RetriedStage,
    /// `None` until all paths of the first leg have ended.
    target: Option<RetriedStage>,
    /// Paths of the first leg that arrived, ascending: path k of the second leg
    /// is path `arrived[k]`.
    arrived: Vec<u64>,
    /// Values of the system's parameters.
    parameters: Vec<Complex64>,
    /// The system, where regular ends come first.
    counted: Option<Arc<System>>,
    /// Whether the answer may be that of the equations without paths.
    settles_doubts: bool,
}

impl PolyhedralSolve {
    /// The solve that begins with this stage, a toric homotopy; where its start points are not
    /// counted yet, with stages that do.
    ///
    /// # Panics
    /// When the stage is none.
    pub fn new(
        first: Stage,
        system: &System,
        parameters: Vec<Complex64>,
        tolerances: Tolerances,
    ) -> Self {
        assert!(
            matches!(first.homotopy, HomotopyKind::Toric),
            "a polyhedral solve begins in mixed cells"
        );
        let counting = match &first.start_points {
            StartPoints::MixedCells {
                branches: Some(branches),
                ..
            } if branches.volumes.is_empty() => Some(Counting {
                stages: Vec::new(),
                lifting: branches.lifting,
                outcome: None,
            }),
            _ => None,
        };
        Self {
            counting,
            generic: RetriedStage::new(first, system, tolerances, 1),
            target: None,
            arrived: Vec::new(),
            parameters,
            counted: None,
            settles_doubts: false,
        }
    }

    /// Puts paths of the second leg that do not end regularly aside: they are tracked to their ends only if the others
    /// leave solutions of the system to be found. `settles_doubts`: whether the answer may be that of the equations
    /// without paths.
    #[must_use]
    pub fn regular_ends_first(mut self, system: &System, settles_doubts: bool) -> Self {
        self.counted = Some(Arc::new(system.clone()));
        self.settles_doubts = settles_doubts;
        self
    }

    /// Replaces the limit of repetitions of a path.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.generic = self.generic.with_max_retries(max_retries);
        self
    }

    /// Skips the isolation test of singular ends.
    #[must_use]
    pub fn ends_only(mut self) -> Self {
        self.generic = self.generic.ends_only();
        self
    }

    /// The leg to the system that is asked; `None` before the first one has found something.
    pub fn last_leg(&self) -> Option<&RetriedStage> {
        self.target.as_ref()
    }

    /// The leg to the generic system.
    pub fn first_leg(&self) -> &RetriedStage {
        &self.generic
    }

    /// Paths of the first leg that did not arrive.
    pub fn lost(&self) -> u64 {
        (self.generic.results().len() - self.arrived.len()) as u64
    }

    /// Takes the counts of all branches: the first leg has as many paths, or another lifting is
    /// counted, or it ends here.
    fn counted(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        let counting = self.counting.as_mut().expect("it is counting");
        let counting_stage = progress::absorb(&mut counting.stages, stage);
        let counts: Vec<Option<BranchCount>> = results.map(count_of).collect();
        assert_eq!(
            counts.len() as u64,
            counting_stage.items,
            "a stage is absorbed as a whole"
        );
        match sum(&counts, counting.lifting) {
            Ok(Some((count, branches))) => {
                counting.outcome = Some(Ok(()));
                let first = Stage {
                    start_points: StartPoints::MixedCells {
                        count,
                        branches: Some(branches),
                    },
                    ..self.generic.first().clone()
                };
                self.generic = self.generic.with_first(first);
            }
            Ok(None) => counting.lifting += 1,
            Err(reason) => counting.outcome = Some(Err(reason)),
        }
    }

    /// Begins the second leg from what the first one found; `None` where it found nothing.
    fn second_leg(&mut self) -> Option<&mut RetriedStage> {
        let mut coordinates = Vec::new();
        for (result, decision) in self.generic.results().iter().zip(self.generic.decisions()) {
            // The generic system has regular finite solutions only.
            if decision.verdict != Verdict::Finite || !regular(result) {
                continue;
            }
            let shape = self.generic.shape();
            let point = shape.to_variables(result.endpoint.to_double());
            if point.iter().all(|z| z.re.is_finite() && z.im.is_finite()) {
                self.arrived.push(result.origin.0);
                coordinates.extend(point);
            }
        }
        if self.arrived.is_empty() {
            return None;
        }
        let points = Arc::new(StoredPoints {
            dimension: coordinates.len() / self.arrived.len(),
            coordinates,
        });
        let stage = Stage {
            homotopy: HomotopyKind::Generic {
                parameters: self.parameters.clone(),
            },
            start_points: points.as_start(),
            ..self.generic.first().clone()
        };
        let first = Opening {
            stage,
            system: None,
            objects: vec![points],
        };
        let mut second = self.generic.followed_by(first, self.lost());
        if let Some(system) = &self.counted
            && self.arrived.len() <= MOST_COUNTED
        {
            second = second.regular_ends_first(system, self.settles_doubts);
        }
        Some(self.target.insert(second))
    }

    /// The last result of every path of the whole, by its index in the first leg.
    pub fn results(&self) -> Vec<PathResult> {
        let mut results: Vec<PathResult> = self
            .generic
            .results()
            .iter()
            .map(|result| PathResult {
                outcome: match result.outcome {
                    PathOutcome::Failed(failure) => PathOutcome::Failed(failure),
                    // Where a generic system has no solution.
                    PathOutcome::Regular
                    | PathOutcome::Singular
                    | PathOutcome::Diverging
                    | PathOutcome::PutAside => PathOutcome::Failed(Failure::EndgameUnsettled),
                },
                t: Complex64::new(1.0, 0.0),
                ..result.clone()
            })
            .collect();
        let target = self.target.iter().flat_map(RetriedStage::results);
        for (result, &origin) in target.zip(&self.arrived) {
            results[origin as usize] = PathResult {
                origin: PathIndex(origin),
                ..result.clone()
            };
        }
        results
    }
}

fn regular(result: &PathResult) -> bool {
    result.outcome == PathOutcome::Regular
}

impl Counting {
    /// Next step of the count; `None` when all branches are counted.
    fn next(&mut self, first: &Stage, numbers: &mut StageNumbers) -> Option<Next> {
        match &self.outcome {
            Some(Ok(())) => return None,
            Some(Err(_)) => return Some(Next::Done),
            None if self.stages.iter().any(|stage| !stage.absorbed) => return Some(Next::Wait),
            None => {}
        }
        let stage = Stage {
            work: Work::CountMixedCells,
            start_points: StartPoints::MixedCells {
                count: 0,
                branches: Some(CellBranches::uncounted(self.lifting)),
            },
            ..first.clone()
        };
        Some(numbers.open(stage.into(), &mut self.stages))
    }

    fn failure(&self) -> Option<&String> {
        self.outcome.as_ref()?.as_ref().err()
    }
}

/// Count of a worker for one branch.
fn count_of(result: ItemResult) -> Option<BranchCount> {
    match result {
        ItemResult::CountMixedCells(branch) => branch.into_fact(),
        other => unreachable!("a stage that counts mixed cells has no {other:?}"),
    }
}

/// The mixed volume and its branches by the counts of all; `None` where the lifting is not generic,
/// and the next one is to be counted.
fn sum(
    counts: &[Option<BranchCount>],
    lifting: u32,
) -> Result<Option<(u64, CellBranches)>, String> {
    let refused = |error: MixedCellsError| PlanError::NoMixedCells(error.to_string()).to_string();
    if counts.contains(&Some(BranchCount::Tie)) {
        return match lifting + 1 < MOST_LIFTINGS {
            true => Ok(None),
            false => Err(refused(MixedCellsError::NoLifting)),
        };
    }
    let mut branches = CellBranches::uncounted(lifting);
    let mut volume = 0u64;
    for (branch, count) in counts.iter().enumerate() {
        match count {
            Some(BranchCount::Counted(counted)) => {
                let sum = volume.checked_add(counted.volume);
                volume = sum.ok_or_else(|| refused(MixedCellsError::TooLarge))?;
                branches.volumes.push(counted.volume);
                branches.time_exponent = branches.time_exponent.max(counted.time_exponent);
            }
            Some(BranchCount::Tie | BranchCount::TooLarge) => {
                return Err(refused(MixedCellsError::TooLarge));
            }
            None => {
                let why = format!("branch {branch} of the mixed cells ended every worker");
                return Err(PlanError::NoMixedCells(why).to_string());
            }
        }
    }
    let volume = checked_volume(volume).map_err(|error| error.to_string())?;
    Ok(Some((volume, branches)))
}

impl Solve for PolyhedralSolve {
    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        if let Some(counting) = &mut self.counting
            && let Some(next) = counting.next(self.generic.first(), numbers)
        {
            return next;
        }
        if let Some(target) = &mut self.target {
            return target.next_stage(numbers);
        }
        match self.generic.next_stage(numbers) {
            Next::Done => match self.second_leg() {
                Some(target) => target.next_stage(numbers),
                None => Next::Done,
            },
            other => other,
        }
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        if self.counting.as_ref().is_some_and(|c| c.outcome.is_none()) {
            return self.counted(stage, results);
        }
        match &mut self.target {
            Some(target) => target.absorb(stage, results),
            None => self.generic.absorb(stage, results),
        }
    }

    fn progress(&self) -> Progress {
        let counting = self.counting.as_ref();
        if let Some(counting) = counting.filter(|counting| counting.outcome != Some(Ok(()))) {
            return Progress {
                description: match counting.failure() {
                    Some(reason) => reason.clone(),
                    None => "counting mixed cells".into(),
                },
                stages: counting.stages.clone(),
                paths: VerdictCounts::default(),
                done: counting.outcome.is_some(),
            };
        }
        let mut first = self
            .generic
            .progress("a generic system with the same monomials");
        if let Some(counting) = counting {
            first.stages.splice(0..0, counting.stages.iter().copied());
        }
        match &self.target {
            None => Progress {
                // Nothing is known of the system that is asked.
                paths: VerdictCounts::default(),
                done: first.done && !self.generic.results().iter().any(regular),
                ..first
            },
            Some(target) => {
                let mut second = target.progress("from the generic system to this one");
                second.paths.failed += self.lost();
                let mut stages = first.stages;
                stages.append(&mut second.stages);
                Progress { stages, ..second }
            }
        }
    }

    fn failure(&self) -> Option<String> {
        self.counting.as_ref()?.failure().cloned()
    }

    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        let mut finite_endpoints = self.target.as_ref()?.finite_endpoints();
        finite_endpoints.homotopy = HomotopyKind::StraightLine {
            parameters: self.parameters.clone(),
        };
        let FiniteEndpoints {
            regular, singular, ..
        } = &mut finite_endpoints;
        for point in regular.iter_mut().chain(singular) {
            point.path = self.arrived[point.path as usize];
        }
        Some(finite_endpoints)
    }

    fn answer(&self, system: &System) -> Option<Answer> {
        let results = self.results();
        let last = self.target.as_ref().unwrap_or(&self.generic);
        let mut history = last.history(0, true);
        if self.target.is_some() {
            // Repetitions on the way to the generic system count, too.
            let first = self.generic.history(0, true);
            history.retracked += first.retracked;
            history.crossings_found += first.crossings_found;
            history.crossings_resolved += first.crossings_resolved;
        }
        let set = last.set_of(system, &self.parameters, &results, &history);
        Some(Answer::from(vec![set]))
    }

    fn renumbered_results(&self) -> Option<Vec<PathResult>> {
        Some(self.results())
    }

    fn solution_count(&self) -> Option<SolutionCount> {
        self.target.as_ref()?.solution_count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::any_algorithm::AnyAlgorithm;
    use crate::plan::SolveMethod;
    use crate::run_locally::run_locally;
    use crate::solve::PathAlgorithm;
    use crate::{Plan, SolveOptions, plan};
    use cognate_continuation::item_result::PointResult;
    use cognate_continuation::prepared_work::PreparedWork;
    use cognate_continuation::start_systems::polyhedral::branches::{BRANCHES, CountedCells};
    use cognate_solutions::solution_set::SolutionSet;
    use cognate_systems::named::cyclic;
    use std::collections::HashMap;

    fn options(counting_operations: u64) -> SolveOptions {
        SolveOptions {
            method: SolveMethod::Polyhedral,
            seed: 3,
            counting_operations,
            ..SolveOptions::default()
        }
    }

    /// A plan in which workers count.
    fn counted_by_workers(system: &System) -> Plan {
        let plan = plan(system, &options(10)).expect("a plan");
        assert_eq!(plan.paths, None);
        assert!(plan.why.contains("counted by workers"), "{}", plan.why);
        plan
    }

    /// Coordinates to a few digits, sorted.
    fn values(sets: &[SolutionSet]) -> Vec<Vec<(i64, i64)>> {
        let digits = |z: Complex64| ((z.re * 1e8).round() as i64, (z.im * 1e8).round() as i64);
        let values_of =
            |s: &cognate_solutions::solution::Solution| s.variables.values().map(digits).collect();
        let mut points: Vec<_> = sets[0].solutions.iter().map(values_of).collect();
        points.sort();
        points
    }

    /// The results of a stage, as a worker has them.
    fn worked(system: &System, opening: &Opening, width: usize) -> Vec<ItemResult> {
        let find = |wanted| opening.object(wanted);
        let prepared = PreparedWork::new(system, &opening.stage, &find).expect("a stage");
        prepared.run(0..prepared.items(), width)
    }

    /// Result of a worker for this branch; without a count, the branch ended every worker.
    fn branch(number: u64, count: Option<BranchCount>) -> ItemResult {
        let origin = PathIndex(number);
        match count {
            Some(count) => {
                let point = vec![Complex64::default()];
                ItemResult::CountMixedCells(PointResult::new(origin, 0, point, Some(count)))
            }
            None => ItemResult::killed_its_worker(Work::CountMixedCells, origin, 0),
        }
    }

    fn next_opening(algorithm: &mut AnyAlgorithm) -> Box<Opening> {
        match algorithm.next() {
            Next::Open(opening) => opening,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn solutions_are_the_same_whoever_counts_also_after_every_restart() {
        let system = cyclic(6).system;
        let mut planned = plan(&system, &options(u64::MAX)).expect("a plan");
        assert_eq!(planned.paths, Some(156));
        let sets = run_locally(&planned.system, &mut planned.algorithm, &|_| None, 8);
        let sets = sets.expect("solution sets");
        let Plan {
            mut algorithm,
            system,
            ..
        } = counted_by_workers(&system);
        let mut open: Option<Box<Opening>> = None;
        let mut stages = Vec::new();
        loop {
            algorithm = AnyAlgorithm::restore(&algorithm.snapshot()).expect("a snapshot");
            match algorithm.next() {
                Next::Open(opening) => {
                    let stage = &opening.stage;
                    stages.push((stage.id.0, stage.work, stage.items().unwrap_or_default()));
                    let description = algorithm.progress().description;
                    let counts = stage.work == Work::CountMixedCells;
                    assert_eq!(
                        description == "counting mixed cells",
                        counts,
                        "{description}"
                    );
                    open = Some(opening);
                }
                Next::Wait => {
                    let opening = open.take().expect("an open stage");
                    let mut results = worked(&system, &opening, 8).into_iter();
                    algorithm.absorb(opening.stage.id, &mut results);
                }
                Next::Done => break,
            }
        }
        let expected = [
            (0, Work::CountMixedCells, BRANCHES),
            (1, Work::Track, 156),
            (2, Work::Track, 156),
        ];
        assert_eq!(stages, expected);
        let progress = algorithm.progress();
        assert!(progress.done && algorithm.failure().is_none());
        let numbers: Vec<u32> = progress.stages.iter().map(|stage| stage.id.0).collect();
        assert_eq!(numbers, [0, 1, 2]);
        let counted = algorithm.solution_sets(&system);
        assert_eq!(
            (counted[0].paths.total, counted[0].paths.finite),
            (156, 156)
        );
        assert!(counted[0].settled(), "{:?}", counted[0].warnings);
        assert_eq!(values(&counted), values(&sets));
    }

    #[test]
    fn a_lifting_with_a_tie_is_followed_by_another() {
        let Plan {
            mut algorithm,
            system,
            ..
        } = counted_by_workers(&cyclic(5).system);
        let first = next_opening(&mut algorithm);
        let mut results = worked(&system, &first, 1);
        results[77] = branch(77, Some(BranchCount::Tie));
        algorithm.absorb(first.stage.id, &mut results.into_iter());
        let second = next_opening(&mut algorithm);
        let StartPoints::MixedCells { count: 0, branches } = &second.stage.start_points else {
            panic!("{:?}", second.stage.start_points);
        };
        assert_eq!(branches, &Some(CellBranches::uncounted(1)));
        assert_eq!(algorithm.next(), Next::Wait);
        let results = worked(&system, &second, 1);
        algorithm.absorb(second.stage.id, &mut results.into_iter());
        let toric = next_opening(&mut algorithm);
        assert_eq!((toric.stage.id.0, toric.stage.items()), (2, Some(70)));
        let results = worked(&system, &toric, 8);
        assert!(results.iter().filter_map(ItemResult::path).all(regular));
        algorithm.absorb(toric.stage.id, &mut results.into_iter());
        let generic = next_opening(&mut algorithm);
        assert_eq!((generic.stage.id.0, generic.stage.items()), (3, Some(70)));
    }

    /// Paths of any branches, tracked again.
    #[test]
    fn a_few_paths_are_tracked_again_from_where_they_began() {
        let Plan {
            mut algorithm,
            system,
            ..
        } = counted_by_workers(&cyclic(6).system);
        let counting = next_opening(&mut algorithm);
        let mut results = worked(&system, &counting, 1).into_iter();
        algorithm.absorb(counting.stage.id, &mut results);
        let toric = next_opening(&mut algorithm);
        let results = worked(&system, &toric, 16);
        let lost = [3usize, 40, 41, 155];
        let mut failed = results.clone();
        for path in lost {
            let ItemResult::Track(path) = &mut failed[path] else {
                panic!("{:?}", failed[path]);
            };
            path.outcome = PathOutcome::Failed(Failure::TooManySteps);
        }
        algorithm.absorb(toric.stage.id, &mut failed.into_iter());
        let retries = next_opening(&mut algorithm);
        assert_eq!((retries.stage.id.0, retries.stage.attempt), (2, 1));
        let ends = worked(&system, &retries, 8);
        assert_eq!(ends.len(), lost.len());
        let paths = ends.iter().filter_map(ItemResult::path);
        for (path, result) in lost.into_iter().zip(paths) {
            assert_eq!(result.origin.0, path as u64);
            let before = results[path].path().expect("a path");
            let (a, b) = (&before.endpoint, &result.endpoint);
            let apart = a.to_double().iter().zip(b.to_double());
            let apart: f64 = apart.map(|(a, b)| (a - b).norm_sqr()).sum();
            assert!(regular(result) && apart < 1e-16, "path {path}: {apart}");
        }
        algorithm.absorb(retries.stage.id, &mut ends.into_iter());
        assert_eq!(next_opening(&mut algorithm).stage.items(), Some(156));
    }

    #[test]
    fn what_cannot_be_followed_ends_the_solve_with_its_reason() {
        let system = cyclic(5).system;
        let told = |change: &dyn Fn(&mut Vec<ItemResult>)| {
            let mut options = options(10);
            options.closings.certify = true;
            let mut algorithm = plan(&system, &options).expect("a plan").algorithm;
            let mut stages = 0;
            loop {
                match algorithm.next() {
                    Next::Open(opening) => {
                        stages += 1;
                        let mut results = worked(&system, &opening, 1);
                        change(&mut results);
                        algorithm.absorb(opening.stage.id, &mut results.into_iter());
                    }
                    Next::Wait => panic!("no stage is open"),
                    Next::Done => break,
                }
            }
            assert_eq!(algorithm.next(), Next::Done);
            assert!(algorithm.progress().done);
            let restored = AnyAlgorithm::restore(&algorithm.snapshot()).expect("a snapshot");
            assert_eq!(restored.failure(), algorithm.failure());
            (stages, algorithm.failure().expect("a reason"))
        };
        let every_branch = |count: Option<BranchCount>| {
            move |results: &mut Vec<ItemResult>| {
                for (number, result) in (0..).zip(results) {
                    *result = branch(number, count);
                }
            }
        };
        let of_volume = |volume| {
            let cells = 1;
            every_branch(Some(BranchCount::Counted(CountedCells {
                cells,
                volume,
                time_exponent: 1,
            })))
        };
        let reasons = HashMap::from([
            ("ties", told(&every_branch(Some(BranchCount::Tie)))),
            (
                "large",
                told(&|results: &mut Vec<ItemResult>| {
                    results[9] = branch(9, Some(BranchCount::TooLarge));
                }),
            ),
            ("sum", told(&of_volume(u64::MAX / 2))),
            ("many", told(&of_volume(4000))),
            ("none", told(&of_volume(0))),
            (
                "killed",
                told(&|results: &mut Vec<ItemResult>| {
                    results[9] = branch(9, None);
                }),
            ),
        ]);
        let is = |name: &str, stages: u32, part: &str| {
            let (opened, reason) = &reasons[name];
            assert!(
                *opened == stages && reason.contains(part),
                "{opened}: {reason}"
            );
        };
        is("ties", MOST_LIFTINGS, "no generic lifting");
        is("large", 1, "64 bits");
        is("sum", 1, "64 bits");
        is("many", 1, "has 4096000 paths, more than the limit");
        is("none", 1, "the mixed volume is 0");
        is(
            "killed",
            1,
            "branch 9 of the mixed cells ended every worker",
        );
    }
}
