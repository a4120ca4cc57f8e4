//! RetriedStage: a stage, and the stages that track again what failed or crossed in it.
//!
//! The books of one solve: every path's last result, its verdict, and which
//! paths are to be tracked again; at last, whether singular endpoints are isolated. Repetitions keep the seed (and so gamma:
//! another would change which start reaches which end) and tighten the
//! settings; the verdict uses the last.

use crate::finite_endpoints::{FiniteEndpoint, FiniteEndpoints};
use crate::opening::Opening;
use crate::progress::{self, Progress, StageProgress, VerdictCounts};
use crate::solve::{Next, StageNumbers};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::local_dimension::Question;
use cognate_continuation::local_dimension::candidates::{self, Candidate};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::precision::DOUBLE;
use cognate_solutions::classification::{Decision, Tolerances, Verdict, classify, is_unconfirmed};
use cognate_solutions::degenerate::{ASKED, DeclaredSets};
use cognate_solutions::images::with_images;
use cognate_solutions::path_crossing::{CrossingBook, broken_cycles, coincidences, crossings};
use cognate_solutions::plain::PlainCounts;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::{History, SolutionSet};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// How often a path is tracked again at most, before it counts as failed.
pub const MAX_RETRIES: u16 = 3;

/// Highest order of the functionals that are asked for at a singular endpoint, where the number of
/// paths that end there bounds its multiplicity;
const DEPTH: u32 = 40;
/// ... and where nothing does. Multiplicities of mechanisms are small; what goes on past it stays
/// undecided.
const DEPTH_WITHOUT_BOUND: u32 = 8;

/// What is kept of one target besides its results.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct TargetBook {
    crossings: CrossingBook,
    retracked: u64,
    verdicts: VerdictCounts,
}

/// One stage with its repetitions, and all that is known about its paths.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RetriedStage {
    first: Stage,
    /// Points that the first stage brings, until it is open.
    objects: Vec<Arc<StoredPoints>>,
    shape: PointShape,
    /// Sets of which a few endpoints are asked whether they are isolated.
    declared: DeclaredSets,
    tolerances: Tolerances,
    max_retries: u16,
    /// Paths for each target; the targets' paths follow each other.
    paths_per_target: u64,
    /// Last result of every path, by its index; with `plain` of those that are held, ascending.
    results: Vec<PathResult>,
    /// Paths that are not held, counted; `None` where all are.
    plain: Option<PlainCounts>,
    targets: Vec<TargetBook>,
    stages: Vec<StageProgress>,
    /// Paths that the next stage has to track; `None` before the first and after the last.
    wanted: Option<Vec<u64>>,
    /// Paths that end at one singular point each, when nothing is to be tracked any more: the items
    /// of a last stage, which finds out whether the points are isolated.
    singular_points: Vec<Vec<u64>>,
    /// That stage is to be opened.
    isolation_wanted: bool,
    /// Where it is of no interest whether singular endpoints are isolated.
    ends_only: bool,
    /// Paths that belong to this stage and never began: lost in the one before.
    lost: u64,
}

impl RetriedStage {
    /// A stage that is not open yet, with its number of targets.
    pub fn new(
        first: impl Into<Opening>,
        system: &System,
        tolerances: Tolerances,
        targets: u64,
    ) -> Self {
        Self {
            declared: DeclaredSets::of(system),
            ..Self::with_shape(first, PointShape::of(system), tolerances, targets)
        }
    }

    /// The same, where only the shape of the system's points is at hand.
    pub fn with_shape(
        first: impl Into<Opening>,
        shape: PointShape,
        tolerances: Tolerances,
        targets: u64,
    ) -> Self {
        let Opening {
            stage: first,
            objects,
            ..
        } = first.into();
        let items = first
            .items()
            .expect("a plan has only stages whose paths can be counted");
        assert!(
            targets > 0 && items.is_multiple_of(targets),
            "every target has the same number of paths"
        );
        Self {
            first,
            objects,
            shape,
            declared: DeclaredSets::default(),
            tolerances,
            max_retries: MAX_RETRIES,
            paths_per_target: items / targets,
            results: Vec::new(),
            plain: None,
            targets: vec![TargetBook::default(); targets as usize],
            stages: Vec::new(),
            wanted: None,
            singular_points: Vec::new(),
            isolation_wanted: false,
            ends_only: false,
            lost: 0,
        }
    }

    /// The same, where it is of no interest whether singular endpoints are isolated.
    #[must_use]
    pub fn ends_only(mut self) -> Self {
        self.ends_only = true;
        self
    }

    /// The same with another limit of repetitions.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.max_retries = max_retries;
        self
    }

    /// The same with another first stage, for one target, where none is open yet.
    pub fn with_first(&self, first: Stage) -> Self {
        Self {
            paths_per_target: first.items().unwrap_or_default(),
            first,
            ..self.clone()
        }
    }

    /// The stage that comes first.
    pub fn first(&self) -> &Stage {
        &self.first
    }

    /// The stage that comes after all of this one: the same system, tolerances and limit of
    /// repetitions.
    /// `lost`: paths that did not arrive where the new stage begins.
    pub fn followed_by(&self, first: Opening, lost: u64) -> Self {
        let Opening {
            stage: first,
            objects,
            ..
        } = first;
        let items = first
            .items()
            .expect("a plan has only stages whose paths can be counted");
        let targets = first.homotopy.targets();
        Self {
            first: Stage {
                attempt: 0,
                ..first
            },
            objects,
            paths_per_target: items / targets,
            results: Vec::new(),
            plain: None,
            targets: vec![TargetBook::default(); targets as usize],
            stages: Vec::new(),
            wanted: None,
            singular_points: Vec::new(),
            isolation_wanted: false,
            lost,
            ..self.clone()
        }
    }

    /// The number of the stage that comes first; 0 before it is open.
    pub fn first_id(&self) -> StageId {
        progress::first_id(&self.stages)
    }

    /// False where the ends of paths are compared with more than each other, so that all are held.
    pub fn can_leave_out(&self) -> bool {
        self.targets.len() == 1
            && self.lost == 0
            && self.first.work == Work::Track
            && self.first.start_points.exchange().is_none()
            && self.declared.names().next().is_none()
    }

    /// These paths are not held (see `plain`); said before the first stage is absorbed, with the results
    /// of all others, and again whenever some are taken back.
    ///
    /// # Panics
    /// Where ends are compared with more than each other.
    pub fn leave_out(&mut self, plain: PlainCounts) {
        assert!(self.can_leave_out(), "here every end is held");
        self.plain = Some(plain);
    }

    /// True where not all paths are held.
    pub fn leaves_out(&self) -> bool {
        self.plain.is_some()
    }

    /// Holds these paths, too, which were plain: another may end where they do.
    pub fn take_back(&mut self, results: Vec<PathResult>, plain: PlainCounts) {
        self.leave_out(plain);
        self.results.extend(results);
        self.results.sort_by_key(|result| result.origin);
    }

    /// Where the result of a path stands; `None` where it is not held.
    fn place(&self, path: u64) -> Option<usize> {
        if self.plain.is_some() {
            let found = self.results.binary_search_by_key(&path, |r| r.origin.0);
            return found.ok();
        }
        usize::try_from(path)
            .ok()
            .filter(|&place| place < self.results.len())
    }

    /// The results that are held, target by target.
    fn by_target(&self) -> impl Iterator<Item = &[PathResult]> {
        let size = self.paths_per_target.max(1) as usize;
        let one = self.plain.is_some().then_some(&self.results[..]);
        let each = self.results.chunks(size).filter(move |_| one.is_none());
        one.into_iter().chain(each)
    }

    /// The verdicts on the last results of all paths so far.
    pub fn decisions(&self) -> Vec<Decision> {
        self.results
            .iter()
            .map(|result| classify(result, &self.shape, &self.tolerances))
            .collect()
    }

    /// The last results of all paths so far.
    pub fn results(&self) -> &[PathResult] {
        &self.results
    }

    /// The last results of one target's paths so far.
    pub fn results_of(&self, target: usize) -> &[PathResult] {
        let size = self.paths_per_target as usize;
        let all = self.results.get(target * size..(target + 1) * size);
        all.unwrap_or(&[])
    }

    /// These results of one target, and the images of their paths where they have some.
    fn with_images<'a>(&self, results: &'a [PathResult]) -> Cow<'a, [PathResult]> {
        let exchange = self.first.start_points.exchange();
        with_images(results, self.paths_per_target, exchange, &self.shape)
    }

    /// The last results of all paths and of their images; none where no path has one.
    pub fn results_with_images(&self) -> Option<Vec<PathResult>> {
        let exchange = self.first.start_points.exchange();
        exchange.map(|_| self.with_images(&self.results).into_owned())
    }

    /// How its points are laid out.
    pub fn shape(&self) -> &PointShape {
        &self.shape
    }

    /// By what its verdicts are reached.
    pub fn tolerances(&self) -> &Tolerances {
        &self.tolerances
    }

    /// Opens a stage of another making, after all repetitions: its results stand in the place of
    /// those of the paths that it names as origins, and none is tracked again.
    pub fn open_last(&mut self, opening: Opening, numbers: &mut StageNumbers) -> Next {
        let stage = Stage {
            attempt: self.max_retries.max(self.stages.len() as u16) + 1,
            ..opening.stage
        };
        numbers.open(Opening { stage, ..opening }, &mut self.stages)
    }

    /// What is wanted next.
    pub fn next_stage(&mut self, numbers: &mut StageNumbers) -> Next {
        if self.stages.iter().any(|stage| !stage.absorbed) {
            return Next::Wait;
        }
        let opening = if self.stages.is_empty() {
            Opening {
                objects: std::mem::take(&mut self.objects),
                ..self.first.clone().into()
            }
        } else if let Some(indices) = self.wanted.take() {
            self.repetition(indices).into()
        } else if std::mem::take(&mut self.isolation_wanted) {
            self.isolation()
        } else {
            return Next::Done;
        };
        numbers.open(opening, &mut self.stages)
    }

    /// The stage that finds out whether singular endpoints are isolated: one item for each point,
    /// the most accurate of the endpoints there.
    fn isolation(&self) -> Opening {
        let points: Vec<Candidate> = self
            .singular_points
            .iter()
            .map(|paths| {
                let result = self.most_accurate(paths);
                let target = result.origin.0 / self.paths_per_target;
                Candidate {
                    values: self.shape.to_variables(result.endpoint.to_double()),
                    target,
                    question: self.question(result.accuracy, target, paths.len() as u64),
                }
            })
            .collect();
        let points = Arc::new(candidates::to_stored(&points));
        Opening {
            stage: Stage {
                work: Work::LocalDimension,
                start_points: points.as_start(),
                ..self.first.clone()
            },
            system: None,
            objects: vec![points],
        }
    }

    /// Of the paths that end at one point the one that knows it best.
    fn most_accurate(&self, paths: &[u64]) -> &PathResult {
        // What is known of an image is known of its path.
        let held = paths.iter().filter_map(|&path| self.place(path));
        held.map(|place| &self.results[place])
            .min_by(|a, b| a.accuracy.total_cmp(&b.accuracy))
            .expect("a point is where a path ends")
    }

    /// What is known of a singular point at which this many paths end.
    fn question(&self, accuracy: f64, target: u64, paths: u64) -> Question {
        let book = &self.targets[target as usize];
        // Paths of which the end is not known may all belong there.
        let failed = match self.first.start_points.exchange() {
            Some(_) => 2 * book.verdicts.failed,
            None => book.verdicts.failed,
        };
        let lost = self.lost + failed + book.crossings.paths().count() as u64;
        // Other homotopies may leave out paths, and then fewer than the multiplicity end there.
        let complete = self.first.homotopy.takes_all_paths();
        Question {
            accuracy,
            bound: if complete { paths + lost } else { u64::MAX },
            depth: if complete { DEPTH } else { DEPTH_WITHOUT_BOUND },
        }
    }

    fn repetition(&self, indices: Vec<u64>) -> Stage {
        let tracked = |stage: &&StageProgress| stage.work != Work::LocalDimension;
        let attempt = self.stages.iter().filter(tracked).count() as u16;
        let attempt = attempt.min(self.max_retries);
        let tighter = self.first.settings.tightened(attempt);
        // Paths that met, or do not fit into their cycles, may have jumped; one that failed lacks steps
        // or digits, of which looking around takes more.
        let failed = |path: &u64| {
            let result = self.place(*path).map(|place| &self.results[place]);
            let decide = |result| classify(result, &self.shape, &self.tolerances).verdict;
            result.map(decide) == Some(Verdict::Failed)
        };
        let settings = match indices.iter().any(failed) {
            true => tighter,
            false => tighter.robust(),
        };
        Stage {
            start_points: StartPoints::Selected {
                base: Box::new(self.first.start_points.clone()),
                indices,
            },
            settings,
            attempt,
            ..self.first.clone()
        }
    }

    /// Takes the results of an open stage.
    ///
    /// # Panics
    /// When the stage is not open, or the results are not its own, complete and in order.
    pub fn absorb(&mut self, id: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        let stage = progress::absorb(&mut self.stages, id);
        let (attempt, items, work) = (stage.attempt, stage.items, stage.work);
        let mut taken = 0;
        if work == Work::LocalDimension {
            for result in results {
                let point = usize::try_from(taken).unwrap_or(usize::MAX);
                let paths = self.singular_points.get(point).map_or(&[][..], |p| &p[..]);
                let places: Vec<usize> = paths.iter().filter_map(|&p| self.place(p)).collect();
                let ItemResult::LocalDimension(found) = result else {
                    unreachable!("a stage that looks at endpoints has no {result:?}")
                };
                for place in places {
                    let known = &mut self.results[place].local_dimension;
                    *known = found.fact().cloned();
                }
                taken += 1;
            }
            assert_eq!(taken, items, "a stage is absorbed as a whole");
            self.judge();
            self.wanted = self.unconfirmed();
            return;
        }
        for result in results.map(ItemResult::into_path) {
            let origin = result.origin.0;
            if attempt == 0 {
                let last = self.results.last().map(|r| r.origin.0);
                let in_order = match self.plain {
                    None => origin == taken,
                    Some(_) => last.is_none_or(|last| last < origin),
                };
                assert!(in_order, "results come in item order");
                self.results.push(result);
            } else {
                let place = self
                    .place(origin)
                    .expect("an index of a path that is in memory");
                let of_target = usize::try_from(origin).unwrap_or(usize::MAX);
                self.targets[of_target / self.paths_per_target as usize].retracked += 1;
                self.results[place] = result;
            }
            taken += 1;
        }
        if attempt == 0 {
            taken += self.plain.as_ref().map_or(0, PlainCounts::total);
        }
        assert_eq!(taken, items, "a stage is absorbed as a whole");
        let suspects = self.judge();
        self.wanted = (!suspects.is_empty() && attempt < self.max_retries).then_some(suspects);
        if self.wanted.is_none() {
            self.singular_points = self.find_singular_points();
            // Some homotopies end at another system than the one that is asked.
            let asked = self.first.homotopy.ends_at_the_system() && !self.ends_only;
            self.isolation_wanted = asked && !self.singular_points.is_empty();
        }
    }

    /// The paths that doubles lead to one point of which deflated equations do not confirm that it is
    /// multiple: several points may lie there, closer together than doubles tell. They are tracked again
    /// once; what is asked a second time stays as it is.
    fn unconfirmed(&self) -> Option<Vec<u64>> {
        let looks = |stage: &&StageProgress| stage.work == Work::LocalDimension;
        if self.stages.iter().filter(looks).count() > 1 || self.max_retries == 0 {
            return None;
        }
        let complete = self.first.homotopy.takes_all_paths();
        let points = self.singular_points.iter().filter(|paths| {
            let result = self.most_accurate(paths);
            let in_doubles = result.precision_bits <= DOUBLE;
            let number = complete.then_some(paths.len() as u64);
            in_doubles && is_unconfirmed(result, number, &self.tolerances)
        });
        let mut paths: Vec<u64> = points.flatten().copied().collect();
        // An image is tracked again by its path.
        if self.first.start_points.exchange().is_some() {
            paths
                .iter_mut()
                .for_each(|path| *path %= self.paths_per_target);
        }
        paths.sort_unstable();
        paths.dedup();
        (!paths.is_empty()).then_some(paths)
    }

    /// The paths that end at one singular finite point, for each such point; with an exchange for
    /// one of each two points, images among the paths.
    fn find_singular_points(&self) -> Vec<Vec<u64>> {
        let mut points = Vec::new();
        for (target, tracked) in self.by_target().enumerate() {
            let results = &*self.with_images(tracked);
            let decide = |result| classify(result, &self.shape, &self.tolerances);
            let decisions: Vec<Decision> = results.iter().map(decide).collect();
            let mut singular: Vec<bool> = decisions
                .iter()
                .map(|decision| decision.verdict.may_be_multiple())
                .collect();
            for place in self.not_asked(target, results, &decisions) {
                singular[place] = false;
            }
            let clusters = coincidences(
                results,
                &self.shape,
                &self.tolerances,
                self.first.seed,
                |place| singular[place],
            );
            let paths =
                |members: Vec<usize>| members.iter().map(|&m| results[m].origin.0).collect();
            // One of which everything is known already is not asked again.
            let known = |members: &Vec<usize>| {
                let of_path = |&&m: &&usize| m < tracked.len();
                let mut held = members.iter().filter(of_path);
                held.any(|&m| tracked[m].local_dimension.is_none())
            };
            points.extend(clusters.into_iter().filter(known).map(paths));
        }
        points
    }

    /// The endpoints in declared sets that are what a few others in the set are.
    fn not_asked(
        &self,
        target: usize,
        results: &[PathResult],
        decisions: &[Decision],
    ) -> Vec<usize> {
        let parameters: &[Complex64] = match &self.first.homotopy {
            HomotopyKind::StraightLine { parameters }
            | HomotopyKind::PathVariable { parameters }
            | HomotopyKind::Generic { parameters }
            | HomotopyKind::Slide { parameters, .. }
            | HomotopyKind::Intersect { parameters, .. } => parameters,
            HomotopyKind::Parameter { targets, .. } => &targets[target],
            HomotopyKind::Toric | HomotopyKind::Sections { .. } => &[],
        };
        let (shape, tolerances) = (&self.shape, &self.tolerances);
        let sets = (self.declared).members(parameters, results, decisions, shape, tolerances);
        let mut rest = Vec::new();
        for mut members in sets {
            members.sort_by(|&a, &b| results[a].accuracy.total_cmp(&results[b].accuracy));
            rest.extend(members.into_iter().skip(ASKED));
        }
        rest
    }

    /// Brings all verdicts up to date; returns the paths to track again, ascending.
    fn judge(&mut self) -> Vec<u64> {
        let mut suspects = Vec::new();
        let mut targets = std::mem::take(&mut self.targets);
        for (tracked, book) in self.by_target().zip(&mut targets) {
            let exchange = self.first.start_points.exchange();
            let paths = self.paths_per_target;
            let results = &*with_images(tracked, paths, exchange, &self.shape);
            let decisions: Vec<Decision> = results
                .iter()
                .map(|result| classify(result, &self.shape, &self.tolerances))
                .collect();
            let meetings = crossings(
                results,
                &decisions,
                &self.shape,
                &self.tolerances,
                self.first.seed,
            );
            book.crossings.update(
                meetings
                    .iter()
                    .map(|members| members.iter().map(|&m| results[m].origin.0).collect())
                    .collect(),
            );
            book.verdicts = VerdictCounts::default();
            if let Some(plain) = &self.plain {
                book.verdicts.finite = plain.finite;
                book.verdicts.at_infinity = plain.at_infinity;
            }
            for (result, decision) in tracked.iter().zip(&decisions) {
                match decision.verdict {
                    Verdict::Finite => book.verdicts.finite += 1,
                    Verdict::Singular => book.verdicts.singular += 1,
                    Verdict::Undecided => book.verdicts.undecided += 1,
                    Verdict::WithinDataAccuracy => book.verdicts.within_data_accuracy += 1,
                    Verdict::AtInfinity => book.verdicts.at_infinity += 1,
                    Verdict::PositiveDimensional => book.verdicts.positive_dimensional += 1,
                    Verdict::Excess => book.verdicts.excess += 1,
                    Verdict::Failed => {
                        book.verdicts.failed += 1;
                        if can_be_helped(result.outcome) {
                            suspects.push(result.origin.0);
                        }
                    }
                }
            }
            // An image is tracked again by its path.
            let of_path = |path| {
                if exchange.is_some() {
                    path % paths
                } else {
                    path
                }
            };
            suspects.extend(book.crossings.paths().map(of_path));
            // Where a path failed it may be what a cycle lacks, and where paths are left out too.
            if book.verdicts.failed == 0 && self.first.homotopy.takes_all_paths() {
                let singular = |place: usize| decisions[place].verdict.may_be_multiple();
                let (shape, tolerances) = (&self.shape, &self.tolerances);
                let points = coincidences(results, shape, tolerances, self.first.seed, singular);
                for members in points {
                    let broken = broken_cycles(results, &members).into_iter();
                    suspects.extend(broken.map(|place| of_path(results[place].origin.0)));
                }
            }
        }
        self.targets = targets;
        suspects.sort_unstable();
        suspects.dedup();
        suspects
    }

    /// How far it is.
    pub fn progress(&self, what: &str) -> Progress {
        let mut paths = VerdictCounts::default();
        for book in &self.targets {
            paths.finite += book.verdicts.finite;
            paths.singular += book.verdicts.singular;
            paths.undecided += book.verdicts.undecided;
            paths.within_data_accuracy += book.verdicts.within_data_accuracy;
            paths.at_infinity += book.verdicts.at_infinity;
            paths.excess += book.verdicts.excess;
            paths.positive_dimensional += book.verdicts.positive_dimensional;
            paths.failed += book.verdicts.failed;
        }
        let open = self.stages.iter().find(|stage| !stage.absorbed);
        let done = !self.stages.is_empty()
            && open.is_none()
            && self.wanted.is_none()
            && !self.isolation_wanted;
        let description = match open {
            Some(stage) if stage.work == Work::LocalDimension => format!(
                "{what}: finding out whether {} singular points are isolated",
                stage.items
            ),
            Some(stage) if stage.attempt == 0 => format!("{what}: tracking {} paths", stage.items),
            Some(stage) if stage.attempt > self.max_retries => {
                format!("{what}: completing {} paths by symmetry", stage.items)
            }
            Some(stage) => format!(
                "{what}: tracking {} paths again, more carefully ({} of {})",
                stage.items, stage.attempt, self.max_retries
            ),
            None if done => format!("{what}: done"),
            None => what.to_string(),
        };
        Progress {
            description,
            stages: self.stages.clone(),
            paths,
            done,
        }
    }

    /// The finite endpoints of all targets.
    pub fn finite_endpoints(&self) -> FiniteEndpoints {
        let size = self.paths_per_target.max(1) as usize;
        let endpoint = |target, result: &PathResult| FiniteEndpoint {
            target,
            path: result.origin.0,
            values: self.shape.to_variables(result.endpoint.to_double()),
        };
        let mut regular = Vec::new();
        for (target, results) in (0u64..).zip(self.results.chunks(size)) {
            for result in &*self.with_images(results) {
                let decision = classify(result, &self.shape, &self.tolerances);
                if decision.verdict == Verdict::Finite {
                    regular.push(endpoint(target, result));
                }
            }
        }
        let singular = self.singular_points.iter().filter_map(|paths| {
            let result = self.most_accurate(paths);
            let verdict = classify(result, &self.shape, &self.tolerances).verdict;
            let target = result.origin.0 / self.paths_per_target;
            (verdict == Verdict::Singular).then(|| endpoint(target, result))
        });
        FiniteEndpoints {
            homotopy: self.first.homotopy.clone(),
            seed: self.first.seed,
            settings: self.first.settings.clone(),
            regular,
            singular: singular.collect(),
        }
    }

    /// What was found for one target, at which the parameters have these values. Solutions at which
    /// paths end that are not held are counted, and not in the list.
    pub fn solution_set(
        &self,
        target: usize,
        system: &System,
        parameters: &[Complex64],
        complete_start: bool,
    ) -> SolutionSet {
        let size = self.paths_per_target as usize;
        let history = self.history(target, complete_start);
        if let Some(plain) = &self.plain {
            let held = self.set_of(system, parameters, &self.results, &history);
            return held.with_plain(plain);
        }
        let results = self
            .results
            .get(target * size..(target + 1) * size)
            .unwrap_or(&[]);
        self.set_of(system, parameters, &self.with_images(results), &history)
    }

    /// What was done for the paths of one target.
    pub fn history(&self, target: usize, complete_start: bool) -> History {
        let book = &self.targets[target];
        History {
            retracked: book.retracked,
            crossings_found: book.crossings.found(),
            crossings_resolved: book.crossings.resolved(),
            complete_start,
            may_miss: None,
            images: match self.first.start_points.exchange() {
                Some(_) => self.paths_per_target,
                None => 0,
            },
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
            &self.tolerances,
            self.first.seed,
        )
    }
}

/// Whether tracking a failed path more carefully can make it succeed.
pub(crate) fn can_be_helped(outcome: PathOutcome) -> bool {
    match outcome {
        PathOutcome::Failed(failure) => match failure {
            Failure::StepTooSmall | Failure::TooManySteps | Failure::EndgameUnsettled => true,
            Failure::InvalidStartPoint | Failure::KilledItsWorker => false,
        },
        // It failed by its result: damaged, or a crossing.
        PathOutcome::Regular | PathOutcome::Singular | PathOutcome::Diverging => true,
    }
}

#[cfg(test)]
mod tests {
    use crate::any_algorithm::{AnyAlgorithm, AnySolve, RestoreError};
    use crate::parameter_solve::ParameterSolve;
    use crate::run_locally::drive;
    use crate::synthetic::{Fate, first_stage, system, track};
    use crate::zero_dimensional_solve::ZeroDimensionalSolve;
    use crate::{Next, PathAlgorithm};
    use cognate_continuation::homotopies::HomotopyKind;
    use cognate_continuation::start_points::StartPoints;
    use cognate_continuation::work::Stage;
    use cognate_solutions::classification::Tolerances;
    use cognate_solutions::solution_set::SolutionSet;
    use num_complex::Complex64;
    use std::convert::Infallible;

    fn solve() -> AnyAlgorithm {
        let homotopy = HomotopyKind::StraightLine {
            parameters: vec![Complex64::new(1.0, 0.0)],
        };
        AnyAlgorithm::from(AnySolve::ZeroDimensional(ZeroDimensionalSolve::new(
            first_stage(homotopy),
            &system(),
            Tolerances::default(),
        )))
    }

    /// Runs it; returns the stages that it opened and what it found.
    fn run(
        algorithm: &mut AnyAlgorithm,
        fate: impl Fn(u64, u16) -> Fate,
    ) -> (Vec<Stage>, Vec<SolutionSet>) {
        let mut stages = Vec::new();
        let done: Result<(), Infallible> = drive(algorithm, &mut |opening| {
            stages.push(opening.stage.clone());
            Ok(track(&opening.stage, &fate))
        });
        assert_eq!(done, Ok(()));
        assert!(algorithm.progress().done);
        (stages, algorithm.solution_sets(&system()))
    }

    #[test]
    fn clean_paths_are_tracked_once() {
        let (stages, sets) = run(&mut solve(), |path, _| Fate::At(0.1 * path as f64));
        assert_eq!(stages.len(), 1);
        assert_eq!((sets[0].paths.total, sets[0].paths.finite), (4, 4));
        assert_eq!(sets[0].counts.real, Some(4));
        assert!(sets[0].settled());
    }

    #[test]
    fn what_fails_or_crosses_is_tracked_again_with_the_same_gamma() {
        // Paths 0 and 2 meet once; path 3 fails twice.
        let (stages, sets) = run(&mut solve(), |path, attempt| match (path, attempt) {
            (2, 0) => Fate::At(0.0),
            (3, 0 | 1) => Fate::Fails,
            _ => Fate::At(0.1 * path as f64),
        });
        let selected: Vec<_> = stages[1..]
            .iter()
            .map(|stage| match &stage.start_points {
                StartPoints::Selected { indices, .. } => indices.clone(),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(selected, [vec![0, 2, 3], vec![3]]);
        for (k, stage) in stages.iter().enumerate() {
            assert_eq!((stage.id.0, usize::from(stage.attempt)), (k as u32, k));
            assert_eq!(stage.seed, stages[0].seed);
            assert_eq!(stage.settings, stages[0].settings.tightened(k as u16));
        }
        let paths = &sets[0].paths;
        assert_eq!((paths.finite, paths.failed, paths.retracked), (4, 0, 4));
        assert_eq!((paths.crossings_found, paths.crossings_resolved), (1, 1));
        assert!(sets[0].settled());
    }

    #[test]
    fn a_turn_that_is_no_permutation_is_made_again() {
        // Paths 0 and 1 exchange places in a turn, but path 1 says that it needs three.
        let (stages, sets) = run(&mut solve(), |path, attempt| match (path, attempt) {
            (1, 0) => Fate::Turns(0.5, 3),
            (0 | 1, _) => Fate::Turns(0.5, 2),
            _ => Fate::At(0.1 * path as f64),
        });
        let again = stages.iter().filter(|stage| stage.attempt == 1);
        let again: Vec<_> = again.map(|stage| stage.start_points.clone()).collect();
        let [StartPoints::Selected { indices, .. }] = again.as_slice() else {
            panic!("{again:?}");
        };
        assert_eq!(indices, &[0, 1]);
        let settings = &stages[1].settings;
        assert_eq!(settings, &stages[0].settings.tightened(1).robust());
        // Once more, since the made-up dual space has 3 functionals where 2 paths end.
        let paths = &sets[0].paths;
        assert_eq!((paths.finite, paths.singular, paths.retracked), (2, 2, 4));
        let singular = sets[0].solutions.iter().find(|s| s.singular).unwrap();
        assert_eq!(singular.cycles, [2]);
        // One that never fits is named.
        let (_, sets) = run(&mut solve(), |path, _| match path {
            0 => Fate::Turns(0.5, 2),
            _ => Fate::At(0.1 * path as f64),
        });
        let named = |warning: &String| warning.contains("winding numbers do not fit");
        assert!(sets[0].warnings.iter().any(named), "{:?}", sets[0].warnings);
    }

    #[test]
    fn a_path_that_became_another_one_is_found_where_both_end() {
        // Four paths to one point; path 2 had jumped onto path 1 before.
        let fate = |path: u64, attempt: u16| match (path, attempt) {
            (2, 0) => Fate::Jumps(0.5, 0.1 + 1e-7),
            _ => Fate::Jumps(0.5, 0.1 * path as f64),
        };
        let (stages, sets) = run(&mut solve(), fate);
        let again = stages.iter().filter(|stage| stage.attempt == 1);
        let again: Vec<_> = again.map(|stage| stage.start_points.clone()).collect();
        let [StartPoints::Selected { indices, .. }] = again.as_slice() else {
            panic!("{again:?}");
        };
        assert_eq!(indices, &[1, 2]);
        // All four once more, since the made-up dual space has 3 functionals.
        let paths = &sets[0].paths;
        assert_eq!((paths.singular, paths.failed, paths.retracked), (4, 0, 6));
        assert_eq!((paths.crossings_found, paths.crossings_resolved), (1, 1));
        // One that stays there is named.
        let (_, sets) = run(&mut solve(), |path, _| fate(path, 0));
        let paths = &sets[0].paths;
        assert_eq!((paths.singular, paths.failed, paths.total), (3, 1, 4));
        assert_eq!((paths.crossings_found, paths.crossings_resolved), (1, 0));
        assert_eq!(sets[0].failed[0].path, 2);
    }

    #[test]
    fn what_does_not_come_apart_is_accounted_for() {
        let (stages, sets) = run(&mut solve(), |path, _| match path {
            1 => Fate::At(0.0),
            2 => Fate::Hopeless,
            3 => Fate::Fails,
            _ => Fate::At(0.1 * path as f64),
        });
        assert_eq!(stages.len(), 4);
        assert_eq!(
            stages[3].items(),
            Some(3),
            "the hopeless path is left alone"
        );
        let paths = &sets[0].paths;
        assert_eq!((paths.finite, paths.failed, paths.total), (1, 3, 4));
        assert_eq!((paths.crossings_found, paths.crossings_resolved), (1, 0));
        assert!(!sets[0].settled());
    }

    #[test]
    fn every_target_has_its_own_set() {
        let one = |re: f64| vec![Complex64::new(re, 0.0)];
        let homotopy = HomotopyKind::Parameter {
            start: one(1.0),
            targets: vec![one(2.0), vec![Complex64::new(0.0, 1.0)], one(3.0)],
        };
        let mut algorithm = AnyAlgorithm::from(AnySolve::Parameter(ParameterSolve::new(
            first_stage(homotopy),
            &system(),
            Tolerances::default(),
        )));
        // Equal endpoints of different targets are no crossing; paths 8 and 9 are one.
        let (stages, sets) = run(&mut algorithm, |path, attempt| match (path, attempt) {
            (9, 0) => Fate::At(0.0),
            _ => Fate::At(0.1 * (path % 4) as f64),
        });
        assert_eq!(stages.len(), 2);
        assert_eq!(stages[1].items(), Some(2));
        assert_eq!(sets.len(), 3);
        assert!(
            sets.iter()
                .all(|set| set.paths.finite == 4 && set.settled())
        );
        let crossings: Vec<u64> = sets.iter().map(|s| s.paths.crossings_found).collect();
        assert_eq!(crossings, [0, 0, 1]);
        let real: Vec<Option<u64>> = sets.iter().map(|s| s.counts.real).collect();
        assert_eq!(real, [Some(4), None, Some(4)], "x^4 = i is not real");
        assert_eq!(sets[1].solutions[0].paths, [4]);
    }

    #[test]
    fn a_restored_solve_goes_on_to_the_same_answer() {
        let fate = |path: u64, attempt: u16| match (path, attempt) {
            (0, 0) | (1, 0..=2) => Fate::Fails,
            _ => Fate::At(0.1 * path as f64),
        };
        let (_, expected) = run(&mut solve(), fate);
        // A new process before every step.
        let mut algorithm = solve();
        let mut open = Vec::new();
        loop {
            let bytes = algorithm.snapshot();
            let restored = AnyAlgorithm::restore(&bytes).unwrap();
            assert_eq!(restored, algorithm);
            algorithm = restored;
            match algorithm.next() {
                Next::Open(opening) => open.push(opening.stage),
                Next::Wait => {
                    let stage = open.pop().unwrap();
                    let results = track(&stage, fate);
                    algorithm.absorb(stage.id, &mut results.into_iter());
                }
                Next::Done => break,
            }
        }
        assert_eq!(algorithm.solution_sets(&system()), expected);
    }

    #[test]
    fn damaged_snapshots_are_refused() {
        let bytes = solve().snapshot();
        assert!(matches!(
            AnyAlgorithm::restore(&bytes[..bytes.len() / 2]),
            Err(RestoreError::Damaged(_))
        ));
        assert!(AnyAlgorithm::restore(&[]).is_err());
        assert_eq!(
            AnyAlgorithm::restore(&[99]),
            Err(RestoreError::Version { found: 99 })
        );
    }
}
