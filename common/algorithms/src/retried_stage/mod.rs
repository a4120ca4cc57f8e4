//! RetriedStage: a stage, and the stages that track again what failed or crossed in it.
//!
//! Every path's last result ([`path_store`]), what is known of each target ([`target_record`]), and which paths are to
//! be tracked again; at last, whether singular endpoints are isolated ([`singular_points`]). Repetitions keep the seed
//! (and so gamma: another would change which start reaches which end) and tighten the settings; the verdict uses the
//! last.

mod criteria;
mod path_store;
mod phase;
mod put_aside;
mod singular_points;
mod target_record;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_put_aside;

use crate::finite_endpoints::{FiniteEndpoint, FiniteEndpoints};
use crate::opening::Opening;
use crate::progress::{self, Progress, StageProgress};
use crate::solve::{Next, StageNumbers};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::counted::counted;
use cognate_solutions::classification::{Decision, Tolerances, Verdict};
use cognate_solutions::degenerate::DeclaredSets;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::{History, SolutionSet};
use cognate_solutions::streamed::StreamedCounts;
use cognate_systems::polynomial::SolutionCount;
use cognate_systems::system::System;
use criteria::Criteria;
use num_complex::Complex64;
use path_store::PathStore;
use phase::Phase;
use put_aside::PutAside;
use serde::{Deserialize, Serialize};
use singular_points::SingularPoints;
use target_record::TargetRecord;
pub(crate) use target_record::can_be_helped;

/// Most repetitions of a path before it counts as failed.
pub const MAX_RETRIES: u16 = 3;

/// One stage with its repetitions, and all that is known about its paths.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RetriedStage {
    criteria: Criteria,
    max_retries: u16,
    /// Skips the isolation test of singular endpoints.
    ends_only: bool,
    /// State of the paths that do not end regularly.
    put_aside: PutAside,
    phase: Phase,
    paths: PathStore,
    targets: Vec<TargetRecord>,
    stages: Vec<StageProgress>,
    /// Singular points, once no path is to be tracked any more.
    singular_points: SingularPoints,
}

/// Items of a stage of a plan.
fn items_of(stage: &Stage) -> u64 {
    stage
        .items()
        .expect("a plan has only stages whose paths can be counted")
}

impl RetriedStage {
    /// A stage that is not open yet, with its number of targets.
    pub fn new(
        first: impl Into<Opening>,
        system: &System,
        tolerances: Tolerances,
        targets: u64,
    ) -> Self {
        let mut stage = Self::with_shape(first, PointShape::of(system), tolerances, targets);
        stage.criteria.declared = DeclaredSets::of(system);
        stage
    }

    /// Makes the stage from the shape of the system's points alone.
    pub fn with_shape(
        first: impl Into<Opening>,
        shape: PointShape,
        tolerances: Tolerances,
        targets: u64,
    ) -> Self {
        let first = first.into();
        let criteria = Criteria {
            first: first.stage.clone(),
            shape,
            declared: DeclaredSets::default(),
            tolerances,
            paths_per_target: 0,
            lost: 0,
        };
        Self::begin(first, targets, criteria)
    }

    fn begin(first: Opening, targets: u64, criteria: Criteria) -> Self {
        let items = items_of(&first.stage);
        assert!(
            targets > 0 && items.is_multiple_of(targets),
            "every target has the same number of paths"
        );
        let paths_per_target = items / targets;
        Self {
            criteria: Criteria {
                first: first.stage,
                paths_per_target,
                ..criteria
            },
            max_retries: MAX_RETRIES,
            ends_only: false,
            put_aside: PutAside::Never,
            phase: Phase::Begins(first.objects),
            paths: PathStore::new(paths_per_target, targets),
            targets: vec![TargetRecord::default(); targets as usize],
            stages: Vec::new(),
            singular_points: SingularPoints::default(),
        }
    }

    /// Skips the isolation test of singular endpoints.
    #[must_use]
    pub fn ends_only(mut self) -> Self {
        self.ends_only = true;
        self
    }

    /// Puts paths that do not end regularly aside: they are tracked to their ends only if the others leave solutions of
    /// the system to be found. `settles_doubts`: whether the answer may be that of the equations without paths.
    #[must_use]
    pub fn regular_ends_first(mut self, system: &System, settles_doubts: bool) -> Self {
        self.put_aside = PutAside::of(system, &self.criteria, settles_doubts);
        self
    }

    /// Number of solutions of the system, if it was counted on the way.
    pub fn solution_count(&self) -> Option<SolutionCount> {
        self.put_aside.count()
    }

    /// Replaces the limit of repetitions of a path.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.max_retries = max_retries;
        self
    }

    /// A stage with another first stage, for one target; to be called while no stage is open.
    pub fn with_first(&self, first: Stage) -> Self {
        let paths_per_target = first.items().unwrap_or_default();
        Self {
            criteria: Criteria {
                first,
                paths_per_target,
                ..self.criteria.clone()
            },
            paths: PathStore::new(paths_per_target, 1),
            ..self.clone()
        }
    }

    /// The stage that comes first.
    pub fn first(&self) -> &Stage {
        &self.criteria.first
    }

    /// The stage that comes after all of this one: the same system, tolerances and limit of
    /// repetitions.
    /// `lost`: paths that did not arrive where the new stage begins.
    pub fn followed_by(&self, first: Opening, lost: u64) -> Self {
        let targets = first.stage.homotopy.targets();
        let stage = Stage {
            attempt: 0,
            ..first.stage
        };
        let criteria = Criteria {
            lost,
            ..self.criteria.clone()
        };
        Self {
            max_retries: self.max_retries,
            ends_only: self.ends_only,
            ..Self::begin(Opening { stage, ..first }, targets, criteria)
        }
    }

    /// The number of the stage that comes first; 0 before it is open.
    pub fn first_id(&self) -> StageId {
        progress::first_id(&self.stages)
    }

    /// False where the ends of paths are compared with more than each other, so that all are held.
    pub fn can_leave_out(&self) -> bool {
        self.put_aside == PutAside::Never
            && self.criteria.lost == 0
            && self.criteria.first.work == Work::Track
            && self.criteria.exchange().is_none()
            && self.criteria.declared.names().next().is_none()
    }

    /// These paths are not held (see `solutions::streamed`), counted for each target; said before the first stage is
    /// absorbed, with the results of all others, and again whenever some are taken back.
    ///
    /// # Panics
    /// Where ends are compared with more than each other.
    pub fn leave_out(&mut self, streamed: Vec<StreamedCounts>) {
        assert!(self.can_leave_out(), "here every end is held");
        self.paths.leave_out(streamed);
    }

    /// True where not all paths are held.
    pub fn leaves_out(&self) -> bool {
        self.paths.leaves_out()
    }

    /// The paths that are held, ascending, where these are not all.
    pub fn held(&self) -> Option<Vec<u64>> {
        let results = self.paths.results().iter();
        self.leaves_out()
            .then(|| results.map(|result| result.origin.0).collect())
    }

    /// Holds these paths, too, which were only counted: another may end where they do.
    ///
    /// # Panics
    /// Where ends are compared with more than each other.
    pub fn take_back(&mut self, results: Vec<PathResult>, streamed: Vec<StreamedCounts>) {
        assert!(self.can_leave_out(), "here every end is held");
        self.paths.take_back(results, streamed);
    }

    /// The verdicts on the last results of all paths so far.
    pub fn decisions(&self) -> Vec<Decision> {
        let results = self.paths.results().iter();
        results.map(|result| self.criteria.decide(result)).collect()
    }

    /// The last results of all paths so far.
    pub fn results(&self) -> &[PathResult] {
        self.paths.results()
    }

    /// The last results of one target's paths so far.
    pub fn results_of(&self, target: usize) -> &[PathResult] {
        self.paths.of_target(target)
    }

    /// The last results of all paths and of their images; none where no path has one.
    pub fn results_with_images(&self) -> Option<Vec<PathResult>> {
        self.criteria.exchange()?;
        let results = self.criteria.with_images(self.paths.results());
        Some(results.into_owned())
    }

    /// The last results of all paths, where an exact count decided some of them.
    pub fn confirmed_results(&self) -> Option<Vec<PathResult>> {
        match self.put_aside {
            PutAside::Confirmed(_) => Some(self.paths.results().to_vec()),
            _ => None,
        }
    }

    /// Layout of the coordinates of the stage's points.
    pub fn shape(&self) -> &PointShape {
        &self.criteria.shape
    }

    /// Tolerances of the verdicts.
    pub fn tolerances(&self) -> &Tolerances {
        &self.criteria.tolerances
    }

    /// Opens a stage of another making, after all repetitions: its results stand in the place of
    /// those of the paths that it names as origins, and none is tracked again.
    pub fn open_last(&mut self, opening: Opening, numbers: &mut StageNumbers) -> Next {
        let stage = Stage {
            attempt: self.max_retries.max(self.stages.len() as u16) + 1,
            ..opening.stage
        };
        self.phase = Phase::Waits;
        numbers.open(Opening { stage, ..opening }, &mut self.stages)
    }

    /// Next step of the stage and its repetitions.
    pub fn next_stage(&mut self, numbers: &mut StageNumbers) -> Next {
        let opening = match std::mem::replace(&mut self.phase, Phase::Waits) {
            Phase::Begins(objects) => Opening {
                objects,
                ..self
                    .as_first(self.criteria.first.start_points.clone())
                    .into()
            },
            Phase::Waits => return Next::Wait,
            Phase::Follows(paths) => self.as_first(self.selected(paths)).into(),
            Phase::Repeats(paths) => self.repetition(paths).into(),
            Phase::Asks => {
                (self.singular_points).opening(&self.paths, &self.targets, &self.criteria)
            }
            Phase::Done => {
                self.phase = Phase::Done;
                return Next::Done;
            }
        };
        numbers.open(opening, &mut self.stages)
    }

    /// Start points of the paths with these indices.
    fn selected(&self, indices: Vec<u64>) -> StartPoints {
        StartPoints::Selected {
            base: Box::new(self.criteria.first.start_points.clone()),
            indices,
        }
    }

    /// A stage of first attempts.
    fn as_first(&self, start_points: StartPoints) -> Stage {
        let first = self.criteria.first.clone();
        Stage {
            settings: self.put_aside.settings(first.settings.clone()),
            start_points,
            ..first
        }
    }

    /// The stage that tracks these paths again.
    fn repetition(&self, indices: Vec<u64>) -> Stage {
        let first = &self.criteria.first;
        let tracked = |stage: &&StageProgress| stage.work != Work::LocalDimension;
        let attempts = self.stages.iter().filter(tracked).map(|s| s.attempt + 1);
        let attempt = attempts.max().unwrap_or_default().min(self.max_retries);
        let tighter = first.settings.tightened(attempt);
        // Paths that met, or do not fit into their cycles, may have jumped; one that failed lacks steps
        // or digits, of which looking around takes more.
        let failed = |&path: &u64| {
            let decided = self.paths.get(path).map(|r| self.criteria.decide(r));
            decided.is_some_and(|decision| decision.verdict == Verdict::Failed)
        };
        let settings = match indices.iter().any(failed) {
            true => tighter,
            false => tighter.robust(),
        };
        Stage {
            settings: self.put_aside.settings(settings),
            start_points: self.selected(indices),
            attempt,
            ..first.clone()
        }
    }

    /// Takes the results of an open stage.
    ///
    /// # Panics
    /// When the stage is not open, or the results are not its own, complete and in order.
    pub fn absorb(&mut self, id: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        let stage = progress::absorb(&mut self.stages, id);
        self.phase = match stage.work {
            Work::LocalDimension => self.learn_dimensions(&stage, results),
            _ => self.learn_ends(&stage, results),
        };
    }

    /// Takes whether singular points are isolated; what is wanted then. What stays unconfirmed is tracked
    /// again once; what is asked a second time stays as it is.
    fn learn_dimensions(
        &mut self,
        stage: &StageProgress,
        results: &mut dyn Iterator<Item = ItemResult>,
    ) -> Phase {
        let mut taken = 0;
        for result in results {
            let ItemResult::LocalDimension(local_dimension) = result else {
                unreachable!("a stage that looks at endpoints has no {result:?}")
            };
            for &path in self.singular_points.paths_of_item(taken) {
                if let Some(held) = self.paths.get_mut(path) {
                    held.local_dimension = local_dimension.fact().cloned();
                }
            }
            taken += 1;
        }
        assert_eq!(taken, stage.items, "a stage is absorbed as a whole");
        self.judge();
        let looks = |stage: &&StageProgress| stage.work == Work::LocalDimension;
        if self.stages.iter().filter(looks).count() > 1 || self.max_retries == 0 {
            return Phase::Done;
        }
        match (self.singular_points).unconfirmed(&self.paths, &self.criteria) {
            paths if paths.is_empty() => Phase::Done,
            paths => Phase::Repeats(paths),
        }
    }

    /// Takes the ends of paths; what is wanted then.
    fn learn_ends(
        &mut self,
        stage: &StageProgress,
        results: &mut dyn Iterator<Item = ItemResult>,
    ) -> Phase {
        let is_first = stage.id == self.first_id();
        let mut taken = 0;
        for result in results.map(ItemResult::into_path) {
            taken += 1;
            if is_first {
                self.paths.begin(result);
                continue;
            }
            let target = self.criteria.target_of(result.origin.0);
            self.paths.replace(result);
            self.targets[target as usize].retracked += u64::from(stage.attempt > 0);
        }
        if is_first {
            taken = self.paths.known();
        }
        assert_eq!(taken, stage.items, "a stage is absorbed as a whole");
        let suspects = self.judge();
        let meet = |record: &TargetRecord| record.crossings.paths().next().is_some();
        if !self.targets.iter().any(meet) {
            if self.put_aside.confirms(&mut self.paths, &self.criteria) {
                self.judge();
                return Phase::Done;
            }
            // Endgames of paths that were put aside cost less than tracking failed paths again.
            if self.put_aside.knows_what_is_missing() {
                let unended = self.put_aside.follow(&self.paths);
                if !unended.is_empty() {
                    return Phase::Follows(unended);
                }
            }
            if (self.put_aside).leaves_the_rest_to_the_equations(&self.paths, stage.attempt) {
                return Phase::Done;
            }
        }
        if !suspects.is_empty() && stage.attempt < self.max_retries {
            return Phase::Repeats(suspects);
        }
        let unended = self.put_aside.follow(&self.paths);
        if !unended.is_empty() {
            return Phase::Follows(unended);
        }
        self.singular_points = SingularPoints::find(&self.paths, &self.criteria);
        // Some homotopies end at another system than the one that is asked.
        let asks = self.criteria.first.homotopy.ends_at_the_system() && !self.ends_only;
        let points = self.singular_points.asked();
        if !asks || points == 0 || self.put_aside.leaves_singular_ends_to_the_equations(points) {
            return Phase::Done;
        }
        Phase::Asks
    }

    /// Brings all verdicts up to date; returns the paths to track again, ascending.
    fn judge(&mut self) -> Vec<u64> {
        let mut suspects = Vec::new();
        for (target, record) in self.targets.iter_mut().enumerate() {
            let (tracked, streamed) = (self.paths.of_target(target), self.paths.streamed(target));
            suspects.extend(record.judge(tracked, streamed, &self.criteria));
        }
        suspects.sort_unstable();
        suspects.dedup();
        suspects
    }

    /// Progress of the stage and its repetitions.
    pub fn progress(&self, what: &str) -> Progress {
        let done = self.phase == Phase::Done;
        let description = match self.stages.iter().find(|stage| !stage.absorbed) {
            Some(stage) if stage.work == Work::LocalDimension => format!(
                "{what}: finding out whether {} isolated",
                match stage.items {
                    1 => "1 singular point is".to_owned(),
                    n => format!("{n} singular points are"),
                }
            ),
            Some(stage) if stage.attempt == 0 => {
                format!("{what}: tracking {}", counted(stage.items, "path"))
            }
            Some(stage) if stage.attempt > self.max_retries => {
                format!(
                    "{what}: completing {} by symmetry",
                    counted(stage.items, "path")
                )
            }
            Some(stage) => format!(
                "{what}: tracking {} again, more carefully ({} of {})",
                counted(stage.items, "path"),
                stage.attempt,
                self.max_retries
            ),
            None if done => format!("{what}: done"),
            None => what.to_string(),
        };
        Progress {
            description,
            stages: self.stages.clone(),
            paths: self.targets.iter().map(|record| record.verdicts).sum(),
            done,
        }
    }

    /// The finite endpoints of all targets.
    pub fn finite_endpoints(&self) -> FiniteEndpoints {
        let criteria = &self.criteria;
        let endpoint = |target, result: &PathResult| FiniteEndpoint {
            target,
            path: result.origin.0,
            values: (criteria.shape).to_variables(result.endpoint.to_double()),
        };
        let mut regular = Vec::new();
        for (target, results) in (0u64..).zip(self.paths.by_target()) {
            for result in &*criteria.with_images(results) {
                if criteria.decide(result).verdict == Verdict::Finite {
                    regular.push(endpoint(target, result));
                }
            }
        }
        let singular = self.singular_points.endpoints(&self.paths);
        let singular =
            singular.filter(|result| criteria.decide(result).verdict == Verdict::Singular);
        FiniteEndpoints {
            homotopy: criteria.first.homotopy.clone(),
            seed: criteria.first.seed,
            settings: criteria.first.settings.clone(),
            regular,
            singular: singular
                .map(|result| endpoint(criteria.target_of(result.origin.0), result))
                .collect(),
        }
    }

    /// Solutions found for one target, at which the parameters have these values. Solutions at which paths end that are
    /// not held are counted, and not in the list.
    pub fn solution_set(
        &self,
        target: usize,
        system: &System,
        parameters: &[Complex64],
        complete_start: bool,
    ) -> SolutionSet {
        let streamed = self.paths.streamed(target);
        let history = History {
            is_part: streamed.is_some(),
            ..self.history(target, complete_start)
        };
        let results = self.criteria.with_images(self.paths.of_target(target));
        let held = self.set_of(system, parameters, &results, &history);
        match streamed {
            Some(streamed) => held.with_streamed(streamed),
            None => held,
        }
    }

    /// A set of dimension 1 or more is a component of the common points of hypersurfaces in a projective space to which
    /// at least as many paths of a total-degree start lead as the lowest degree says (W. Fulton, Intersection Theory,
    /// 1998, theorem 12.3).
    fn least_on_sets(&self) -> u64 {
        match &self.criteria.first.start_points {
            StartPoints::TotalDegree { degrees } => {
                u64::from(degrees.iter().copied().min().unwrap_or_default())
            }
            _ => 0,
        }
    }

    /// History of the paths of one target: repetitions and crossings.
    pub fn history(&self, target: usize, complete_start: bool) -> History {
        let record = &self.targets[target];
        History {
            retracked: record.retracked,
            crossings_found: record.crossings.found(),
            crossings_resolved: record.crossings.resolved(),
            complete_start,
            may_miss: None,
            images: match self.criteria.exchange() {
                Some(_) => self.criteria.paths_per_target,
                None => 0,
            },
            least_on_sets: self.least_on_sets(),
            is_part: false,
        }
    }

    /// The solution set of these results, with the tolerances of this stage.
    pub fn set_of(
        &self,
        system: &System,
        parameters: &[Complex64],
        results: &[PathResult],
        history: &History,
    ) -> SolutionSet {
        SolutionSet::new(
            system,
            parameters,
            results,
            history,
            &self.criteria.tolerances,
            self.criteria.first.seed,
        )
    }
}
