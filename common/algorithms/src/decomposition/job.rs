//! Job: one stage of a decomposition with its repetitions, and the system that it is of.

use super::moved::MovedPoints;
use crate::opening::Opening;
use crate::polyhedral_solve::PolyhedralSolve;
use crate::retried_stage::RetriedStage;
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::start_systems::polyhedral::branches::CellBranches;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_solutions::classification::{Decision, Tolerances, Verdict};
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::witness::TrackedPaths;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Settings with which a stage's paths are tracked.
#[derive(Clone, Debug)]
pub(crate) struct Tracking {
    pub settings: Settings,
    pub tolerances: Tolerances,
    pub max_retries: u16,
    pub seed: u64,
}

/// Limits of a path that may fail, because other paths can be tracked in its place.
struct PathLimits {
    /// Steps of the first attempt; each repetition has four times the steps of the attempt before it.
    steps: u32,
    /// Highest precision, in bits.
    bits: u32,
    /// Repetitions of the path.
    retries: u16,
}

impl PathLimits {
    /// Limits where the hardest paths cost more than all paths of another loop, or to other combinations.
    const GIVEN_UP_SOON: Self = Self {
        steps: 5000,
        bits: 212,
        retries: 1,
    };
    /// Limits for more of the hardest paths: with twice the bits and one repetition more than
    /// [`Self::GIVEN_UP_SOON`], but the first repetition comes earlier.
    const GIVEN_UP_LATER: Self = Self {
        steps: 2500,
        bits: 424,
        retries: 2,
    };
}

impl Tracking {
    /// Settings for paths that may fail: they are given up soon.
    pub fn soon_given_up(&self) -> Self {
        self.limited(&PathLimits::GIVEN_UP_SOON)
    }

    /// Settings for paths that may fail: they are given up, though not as soon as by [`Self::soon_given_up`].
    pub fn given_up_later(&self) -> Self {
        self.limited(&PathLimits::GIVEN_UP_LATER)
    }

    fn limited(&self, limits: &PathLimits) -> Self {
        let mut limited = self.clone();
        let settings = &mut limited.settings;
        settings.max_steps = settings.max_steps.min(limits.steps);
        let most_bits = limits.bits.max(settings.precision_bits);
        settings.max_precision_bits = settings.max_precision_bits.min(most_bits);
        limited.max_retries = limited.max_retries.min(limits.retries);
        limited
    }
}

/// The system that a stage is of: what is written down of it, so that it can be made again.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum StageSystem {
    /// Combinations of the equations, as many as there are variables.
    Staircase,
    /// The equations of a family, whose parameters stay parameters, with the slices of their lowest dimension.
    Family,
    /// All given equations with the slices of this dimension.
    Sliced {
        /// The dimension.
        dimension: usize,
    },
    /// All equations that are regular after these deflations, with the slices of this dimension.
    Whole {
        /// Rank of the Jacobian before each deflation.
        ranks: Vec<u32>,
        /// The dimension.
        dimension: usize,
    },
    /// Combinations of the equations but the last, whose set of solutions has this dimension, and a factor of the
    /// last.
    Cut {
        /// The dimension before the last equation cuts.
        dimension: usize,
        /// Number of the factor.
        factor: u32,
    },
    /// As many combinations of the equations as cut out this dimension, with its slices.
    Combined {
        /// The dimension.
        dimension: usize,
        /// Seed of the combinations.
        seed: u64,
        /// Whether linear equations stay as they are.
        keep: bool,
    },
    /// Combinations of the equations that cut out curves, with the equation of the points that are critical for a real
    /// linear form.
    Critical {
        /// Coefficients of the form: real and imaginary parts.
        form: Vec<[i32; 2]>,
    },
    /// Combinations of the equations of two components, each regular after its deflations, side by side, with slices in
    /// the variables of both.
    Pair {
        /// Places of the components: in the first set, in the second set.
        places: [usize; 2],
    },
    /// Combinations of the equations of a multiple set after its deflations, and further equations that cut it, with
    /// the slices that are left.
    MultipleCut {
        /// Rank of the Jacobian before each deflation.
        ranks: Vec<u32>,
        /// Dimension of the set.
        dimension: usize,
        /// Number of further equations that hold already, and number of the factor of the next one that cuts.
        cut: [u32; 2],
        /// Linear forms whose product becomes that equation; none: a slice is in its place.
        forms: u32,
    },
    /// Combinations of the equations that cut out curves, with fibres of a real linear form: the form goes from one
    /// value to another.
    Fibre {
        /// Coefficients of the form: real and imaginary parts.
        form: Vec<[i32; 2]>,
        /// Bits of the values from which and to which the form goes.
        values: [u64; 2],
    },
    /// Combinations of the equations that are regular after these deflations, with the slices of this dimension.
    Tracked {
        /// Rank of the Jacobian before each deflation.
        ranks: Vec<u32>,
        /// The dimension.
        dimension: usize,
    },
    /// Combinations of the equations that are regular after these deflations, with the slices of this dimension and the
    /// equations of first and second derivatives by the slices.
    Bent {
        /// Rank of the Jacobian before each deflation.
        ranks: Vec<u32>,
        /// The dimension.
        dimension: usize,
    },
}

/// A stage's system with the description by which it can be made again.
pub(crate) struct DescribedSystem {
    pub description: StageSystem,
    pub system: Arc<System>,
}

/// Kind of the job, with the stages that are under way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum JobKind {
    /// Paths, tracked again where they failed or crossed.
    Tracked(Box<RetriedStage>),
    /// Paths in two legs, from mixed cells.
    Polyhedral(Box<PolyhedralSolve>),
    /// Points about which something is asked once.
    Asked {
        /// The stage that asks, until it is open.
        opening: Option<Box<Opening>>,
        answers: Answers,
        absorbed: bool,
    },
}

/// Results about points that the job keeps until its stage is complete.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Answers {
    /// All results.
    Whole(Vec<ItemResult>),
    /// Data of the points that sums of their second derivatives need; `unknowns`: number of unknowns of each point.
    Sums { moved: MovedPoints, unknowns: usize },
}

impl Answers {
    fn take(&mut self, taken: &mut dyn Iterator<Item = ItemResult>) {
        match self {
            Self::Whole(results) => results.extend(taken),
            Self::Sums { moved, unknowns } => {
                for result in taken {
                    let ItemResult::Bend(result) = result else {
                        unreachable!("a stage that asks for derivatives has no {result:?}")
                    };
                    let bend = result.fact().map(|bend| &**bend);
                    moved.push(bend.filter(|bend| bend.acceleration.len() == *unknowns));
                }
            }
        }
    }
}

/// A job: one stage with its repetitions and results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Job {
    pub system: StageSystem,
    kind: JobKind,
}

fn stored(points: &[Vec<Complex64>]) -> Arc<StoredPoints> {
    Arc::new(StoredPoints {
        dimension: points.first().map_or(0, Vec::len),
        coordinates: points.concat(),
    })
}

impl Job {
    /// Paths from these points.
    pub fn track(
        system: DescribedSystem,
        homotopy: HomotopyKind,
        points: &[Vec<Complex64>],
        with: &Tracking,
    ) -> Self {
        let first = opening(Work::Track, homotopy, stored(points), with);
        Self::tracked(system, first, with)
    }

    /// Paths from all solutions of a start system of these degrees, with these values of the parameters.
    pub fn straight(
        system: DescribedSystem,
        parameters: Vec<Complex64>,
        degrees: Vec<u32>,
        with: &Tracking,
    ) -> Self {
        let homotopy = HomotopyKind::StraightLine { parameters };
        let start_points = StartPoints::TotalDegree { degrees };
        let first = stage(Work::Track, homotopy, start_points, with);
        Self::tracked(system, first, with)
    }

    /// Paths from the mixed cells of the system, with these values of its parameters; `count`: how many, where that is
    /// known.
    pub fn polyhedral(
        system: DescribedSystem,
        parameters: Vec<Complex64>,
        count: Option<u64>,
        with: &Tracking,
    ) -> Self {
        let start_points = StartPoints::MixedCells {
            count: count.unwrap_or_default(),
            branches: count.is_none().then(|| CellBranches::uncounted(0)),
        };
        let first = stage(Work::Track, HomotopyKind::Toric, start_points, with);
        let solve =
            PolyhedralSolve::new(first, &system.system, parameters, with.tolerances.clone());
        let solve = solve.with_max_retries(with.max_retries).ends_only();
        Self {
            system: system.description,
            kind: JobKind::Polyhedral(Box::new(solve)),
        }
    }

    fn tracked(system: DescribedSystem, first: impl Into<Opening>, with: &Tracking) -> Self {
        let first: Opening = first.into();
        let targets = first.stage.homotopy.targets();
        let stages = RetriedStage::new(first, &system.system, with.tolerances.clone(), targets);
        Self {
            system: system.description,
            kind: JobKind::Tracked(Box::new(stages.with_max_retries(with.max_retries))),
        }
    }

    /// Skips the isolation test of singular ends.
    #[must_use]
    pub fn ends_only(mut self) -> Self {
        if let JobKind::Tracked(stages) = self.kind {
            self.kind = JobKind::Tracked(Box::new(stages.ends_only()));
        }
        self
    }

    /// Paths from these points along the path variable of the system.
    pub fn along(system: DescribedSystem, points: &[Vec<Complex64>], with: &Tracking) -> Self {
        let homotopy = HomotopyKind::PathVariable {
            parameters: vec![Complex64::default()],
        };
        let first = opening(Work::Track, homotopy, stored(points), with);
        Self::tracked(system, first, with)
    }

    /// Whether these candidates at the only target are isolated.
    pub fn isolate(
        system: StageSystem,
        parameters: Vec<Complex64>,
        candidates: StoredPoints,
        with: &Tracking,
    ) -> Self {
        let homotopy = HomotopyKind::Parameter {
            start: parameters.clone(),
            targets: vec![parameters],
        };
        Self::ask(
            system,
            Work::LocalDimension,
            homotopy,
            Arc::new(candidates),
            with,
        )
    }

    /// Whether points on slices are proved to be near solutions: fibre by fibre, each with its slices and the same
    /// number of points.
    pub fn certify(
        system: StageSystem,
        fibres: &[(Vec<Complex64>, Vec<Vec<Complex64>>)],
        with: &Tracking,
    ) -> Self {
        let points = fibres.iter().flat_map(|(_, points)| points);
        let points = stored(&points.cloned().collect::<Vec<_>>());
        let count = points.len() as u64;
        let each = count / fibres.len().max(1) as u64;
        let place = |item: u64| item / each.max(1) * count + item;
        let first = fibres.first().map(|(slices, _)| slices.clone());
        let homotopy = HomotopyKind::Parameter {
            start: first.unwrap_or_default(),
            targets: fibres.iter().map(|(slices, _)| slices.clone()).collect(),
        };
        let selected = StartPoints::Selected {
            base: Box::new(points.as_start()),
            indices: (0..count).map(place).collect(),
        };
        let opening = Opening {
            objects: vec![points],
            ..stage(Work::Certify, homotopy, selected, with).into()
        };
        Self::asked(system, opening)
    }

    /// Asks for the derivatives of these witness points when the parameters go from the first to the second.
    pub fn bend(
        system: StageSystem,
        ends: [Vec<Complex64>; 2],
        points: &[Vec<Complex64>],
        with: &Tracking,
    ) -> Self {
        Self::bend_stored(system, ends, stored(points), with)
    }

    fn bend_stored(
        system: StageSystem,
        [start, target]: [Vec<Complex64>; 2],
        points: impl Into<Arc<StoredPoints>>,
        with: &Tracking,
    ) -> Self {
        let homotopy = HomotopyKind::Parameter {
            start,
            targets: vec![target],
        };
        Self::ask(system, Work::Bend, homotopy, points.into(), with)
    }

    /// Asks for the derivatives of points of which only the sums of second derivatives in the first `variable_count`
    /// variables are used: only the data of these sums are kept.
    pub fn bend_for_sums(
        system: StageSystem,
        ends: [Vec<Complex64>; 2],
        points: StoredPoints,
        variable_count: usize,
        with: &Tracking,
    ) -> Self {
        let sums = Answers::Sums {
            moved: MovedPoints::with_capacity(points.len(), variable_count),
            unknowns: points.dimension,
        };
        let mut job = Self::bend_stored(system, ends, points, with);
        if let JobKind::Asked { answers, .. } = &mut job.kind {
            *answers = sums;
        }
        job
    }

    fn ask(
        system: StageSystem,
        work: Work,
        homotopy: HomotopyKind,
        points: Arc<StoredPoints>,
        with: &Tracking,
    ) -> Self {
        Self::asked(system, opening(work, homotopy, points, with))
    }

    fn asked(system: StageSystem, opening: Opening) -> Self {
        Self {
            system,
            kind: JobKind::Asked {
                opening: Some(Box::new(opening)),
                answers: Answers::Whole(Vec::new()),
                absorbed: false,
            },
        }
    }

    /// Next step of the job.
    pub fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        match &mut self.kind {
            JobKind::Tracked(stages) => stages.next_stage(numbers),
            JobKind::Polyhedral(solve) => solve.next(numbers),
            JobKind::Asked {
                opening, absorbed, ..
            } => match (opening.take(), absorbed) {
                (Some(opening), _) => numbers.open(*opening, &mut Vec::new()),
                (None, false) => Next::Wait,
                (None, true) => Next::Done,
            },
        }
    }

    /// Takes the results of an open stage.
    pub fn absorb(&mut self, id: StageId, taken: &mut dyn Iterator<Item = ItemResult>) {
        match &mut self.kind {
            JobKind::Tracked(stages) => stages.absorb(id, taken),
            JobKind::Polyhedral(solve) => solve.absorb(id, taken),
            JobKind::Asked {
                answers, absorbed, ..
            } => {
                answers.take(taken);
                *absorbed = true;
            }
        }
    }

    /// Data for sums of second derivatives; `None` if the job did not ask for sums.
    pub fn into_moved(self) -> Option<MovedPoints> {
        match self.kind {
            JobKind::Asked {
                answers: Answers::Sums { moved, .. },
                ..
            } => Some(moved),
            JobKind::Asked { .. } | JobKind::Tracked(_) | JobKind::Polyhedral(_) => None,
        }
    }

    /// The stage in which its paths end; `None` where it tracks none to the end.
    fn ending(&self) -> Option<&RetriedStage> {
        match &self.kind {
            JobKind::Tracked(stages) => Some(stages),
            JobKind::Polyhedral(solve) => solve.last_leg(),
            JobKind::Asked { .. } => None,
        }
    }

    /// All stages of the job that track paths.
    fn legs(&self) -> impl Iterator<Item = &RetriedStage> {
        let first = match &self.kind {
            JobKind::Polyhedral(solve) => Some(solve.first_leg()),
            JobKind::Tracked(_) | JobKind::Asked { .. } => None,
        };
        first.into_iter().chain(self.ending())
    }

    /// Whether its paths begin in mixed cells.
    pub fn is_polyhedral(&self) -> bool {
        matches!(self.kind, JobKind::Polyhedral(_))
    }

    /// Whether its paths could not be counted, so that none was tracked.
    pub fn is_uncounted(&self) -> bool {
        matches!(&self.kind, JobKind::Polyhedral(solve) if solve.failure().is_some())
    }

    /// Paths that were lost before its last leg began.
    pub fn lost(&self) -> u64 {
        match &self.kind {
            JobKind::Polyhedral(solve) => solve.lost(),
            JobKind::Tracked(_) | JobKind::Asked { .. } => 0,
        }
    }

    /// The last results of its paths, in the order of its items; none where it asks about points.
    pub fn results(&self) -> &[PathResult] {
        self.ending().map_or(&[], RetriedStage::results)
    }

    /// Results about its points, in their order; none where it tracks paths or only sums are wanted.
    pub fn answers(&self) -> &[ItemResult] {
        match &self.kind {
            JobKind::Asked {
                answers: Answers::Whole(results),
                ..
            } => results,
            JobKind::Asked { .. } | JobKind::Tracked(_) | JobKind::Polyhedral(_) => &[],
        }
    }

    /// The results of its paths, what their ends are, and the values of the variables there.
    pub fn ends(&self) -> Vec<(&PathResult, Decision, Vec<Complex64>)> {
        let Some(stages) = self.ending() else {
            return Vec::new();
        };
        // One that ended its worker has no end.
        let values = |r: &PathResult| match r.endpoint.to_double() {
            [] => Vec::new(),
            end => stages.shape().to_variables(end),
        };
        let pairs = stages.results().iter().zip(stages.decisions());
        pairs.map(|(r, d)| (r, d, values(r))).collect()
    }

    /// The regular ends of its paths, and how many paths were lost: from one general slice to another all solutions are
    /// regular.
    pub fn regular_ends(&self) -> (Vec<Vec<Complex64>>, u64) {
        let ends = self.ends().into_iter();
        let (regular, others): (Vec<_>, Vec<_>) =
            ends.partition(|(_, decision, _)| decision.verdict == Verdict::Finite);
        let points = regular.into_iter().map(|(_, _, values)| values).collect();
        (points, others.len() as u64 + self.crossings_left())
    }

    /// Layout of the coordinates of the paths' ends.
    pub fn shape(&self) -> Option<&PointShape> {
        self.ending().map(RetriedStage::shape)
    }

    /// Counts of the job's paths.
    pub fn paths(&self) -> TrackedPaths {
        let failed = |stages: &RetriedStage| {
            let decisions = stages.decisions().into_iter();
            decisions.filter(|d| d.verdict == Verdict::Failed).count() as u64
        };
        let lost = self.lost();
        let Some(ending) = self.ending() else {
            return TrackedPaths {
                total: lost,
                failed: lost,
                ..TrackedPaths::default()
            };
        };
        let mut paths = TrackedPaths {
            total: lost + ending.results().len() as u64,
            failed: lost + failed(ending),
            ..TrackedPaths::default()
        };
        for stages in self.legs() {
            for target in 0..stages.first().homotopy.targets() as usize {
                let history = stages.history(target, false);
                paths.retracked += history.retracked;
                paths.crossings_found += history.crossings_found;
                paths.crossings_resolved += history.crossings_resolved;
            }
        }
        paths
    }

    /// Crossings of its paths that are left.
    pub fn crossings_left(&self) -> u64 {
        let paths = self.paths();
        paths.crossings_found - paths.crossings_resolved
    }
}

/// A stage that the root numbers when it is opened, and of which it names the system.
fn stage(work: Work, homotopy: HomotopyKind, start_points: StartPoints, with: &Tracking) -> Stage {
    Stage::new(
        work,
        homotopy,
        start_points,
        with.settings.clone(),
        with.seed,
    )
}

/// Opening of a stage, with the points where it starts.
fn opening(
    work: Work,
    homotopy: HomotopyKind,
    points: Arc<StoredPoints>,
    with: &Tracking,
) -> Opening {
    Opening {
        objects: vec![Arc::clone(&points)],
        ..stage(work, homotopy, points.as_start(), with).into()
    }
}
