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

/// Most steps of a path that may fail, because others can be tracked in its place, and is given up soon.
const FEW_STEPS: u32 = 5000;
/// Highest precision, in bits, of a path that may fail and is given up soon.
const FEW_BITS: u32 = 212;
/// Most repetitions of a path that may fail and is given up soon.
const FEW_RETRIES: u16 = 1;

/// Most steps of the first attempt of a path that may fail and is given up later; a repetition has more steps.
const SOME_STEPS: u32 = 2500;
/// Highest precision, in bits, of a path that may fail and is given up later.
const SOME_BITS: u32 = 424;
/// Most repetitions of a path that may fail and is given up later.
const SOME_RETRIES: u16 = 2;

impl Tracking {
    /// Settings for paths that may fail: they are given up soon.
    pub fn soon_given_up(&self) -> Self {
        self.limited(FEW_STEPS, FEW_BITS, FEW_RETRIES)
    }

    /// Settings for paths that may fail: they are given up, though not as soon as by [`Self::soon_given_up`].
    pub fn given_up_later(&self) -> Self {
        self.limited(SOME_STEPS, SOME_BITS, SOME_RETRIES)
    }

    fn limited(&self, steps: u32, bits: u32, retries: u16) -> Self {
        let mut with = self.clone();
        let settings = &mut with.settings;
        settings.max_steps = settings.max_steps.min(steps);
        let most = bits.max(settings.precision_bits);
        settings.max_precision_bits = settings.max_precision_bits.min(most);
        with.max_retries = with.max_retries.min(retries);
        with
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

/// Work of the job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Doing {
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
    work: Doing,
}

fn stored(points: &[Vec<Complex64>]) -> Arc<StoredPoints> {
    Arc::new(StoredPoints {
        dimension: points.first().map_or(0, Vec::len),
        coordinates: points.concat(),
    })
}

impl Job {
    /// Paths from these points. `system` is the one of this description.
    pub fn track(
        (description, system): (StageSystem, &System),
        homotopy: HomotopyKind,
        points: &[Vec<Complex64>],
        with: &Tracking,
    ) -> Self {
        let first = opening(Work::Track, homotopy, stored(points), with);
        Self::tracked((description, system), first, with)
    }

    /// Paths from all solutions of a start system of these degrees, with these values of the parameters.
    pub fn straight(
        (description, system): (StageSystem, &System),
        parameters: Vec<Complex64>,
        degrees: Vec<u32>,
        with: &Tracking,
    ) -> Self {
        let homotopy = HomotopyKind::StraightLine { parameters };
        let start_points = StartPoints::TotalDegree { degrees };
        let first = stage(Work::Track, homotopy, start_points, with);
        Self::tracked((description, system), first, with)
    }

    /// Paths from the mixed cells of the system, with these values of its parameters; `count`: how many, where that is
    /// known.
    pub fn polyhedral(
        (description, system): (StageSystem, &System),
        parameters: Vec<Complex64>,
        count: Option<u64>,
        with: &Tracking,
    ) -> Self {
        let start_points = StartPoints::MixedCells {
            count: count.unwrap_or_default(),
            branches: count.is_none().then(|| CellBranches::uncounted(0)),
        };
        let first = stage(Work::Track, HomotopyKind::Toric, start_points, with);
        let solve = PolyhedralSolve::new(first, system, parameters, with.tolerances.clone());
        let solve = solve.with_max_retries(with.max_retries).ends_only();
        Self {
            system: description,
            work: Doing::Polyhedral(Box::new(solve)),
        }
    }

    fn tracked(
        (description, system): (StageSystem, &System),
        first: impl Into<Opening>,
        with: &Tracking,
    ) -> Self {
        let first: Opening = first.into();
        let targets = first.stage.homotopy.targets();
        let stages = RetriedStage::new(first, system, with.tolerances.clone(), targets);
        Self {
            system: description,
            work: Doing::Tracked(Box::new(stages.with_max_retries(with.max_retries))),
        }
    }

    /// Skips the isolation test of singular ends.
    #[must_use]
    pub fn ends_only(mut self) -> Self {
        if let Doing::Tracked(stages) = self.work {
            self.work = Doing::Tracked(Box::new(stages.ends_only()));
        }
        self
    }

    /// Paths from these points along the path variable of the system.
    pub fn along(
        (description, system): (StageSystem, &System),
        points: &[Vec<Complex64>],
        with: &Tracking,
    ) -> Self {
        let homotopy = HomotopyKind::PathVariable {
            parameters: vec![Complex64::default()],
        };
        let first = opening(Work::Track, homotopy, stored(points), with);
        Self::tracked((description, system), first, with)
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
        if let Doing::Asked { answers, .. } = &mut job.work {
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
            work: Doing::Asked {
                opening: Some(Box::new(opening)),
                answers: Answers::Whole(Vec::new()),
                absorbed: false,
            },
        }
    }

    /// Next step of the job.
    pub fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        match &mut self.work {
            Doing::Tracked(stages) => stages.next_stage(numbers),
            Doing::Polyhedral(solve) => solve.next(numbers),
            Doing::Asked {
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
        match &mut self.work {
            Doing::Tracked(stages) => stages.absorb(id, taken),
            Doing::Polyhedral(solve) => solve.absorb(id, taken),
            Doing::Asked {
                answers, absorbed, ..
            } => {
                answers.take(taken);
                *absorbed = true;
            }
        }
    }

    /// Data for sums of second derivatives; `None` if the job did not ask for sums.
    pub fn into_moved(self) -> Option<MovedPoints> {
        match self.work {
            Doing::Asked {
                answers: Answers::Sums { moved, .. },
                ..
            } => Some(moved),
            Doing::Asked { .. } | Doing::Tracked(_) | Doing::Polyhedral(_) => None,
        }
    }

    /// The stage in which its paths end; `None` where it tracks none to the end.
    fn ending(&self) -> Option<&RetriedStage> {
        match &self.work {
            Doing::Tracked(stages) => Some(stages),
            Doing::Polyhedral(solve) => solve.last_leg(),
            Doing::Asked { .. } => None,
        }
    }

    /// All stages of the job that track paths.
    fn legs(&self) -> impl Iterator<Item = &RetriedStage> {
        let first = match &self.work {
            Doing::Polyhedral(solve) => Some(solve.first_leg()),
            Doing::Tracked(_) | Doing::Asked { .. } => None,
        };
        first.into_iter().chain(self.ending())
    }

    /// Whether its paths begin in mixed cells.
    pub fn is_polyhedral(&self) -> bool {
        matches!(self.work, Doing::Polyhedral(_))
    }

    /// Whether its paths could not be counted, so that none was tracked.
    pub fn is_uncounted(&self) -> bool {
        matches!(&self.work, Doing::Polyhedral(solve) if solve.failure().is_some())
    }

    /// Paths that were lost before its last leg began.
    pub fn lost(&self) -> u64 {
        match &self.work {
            Doing::Polyhedral(solve) => solve.lost(),
            Doing::Tracked(_) | Doing::Asked { .. } => 0,
        }
    }

    /// The last results of its paths, in the order of its items; none where it asks about points.
    pub fn results(&self) -> &[PathResult] {
        self.ending().map_or(&[], RetriedStage::results)
    }

    /// Results about its points, in their order; none where it tracks paths or only sums are wanted.
    pub fn answers(&self) -> &[ItemResult] {
        match &self.work {
            Doing::Asked {
                answers: Answers::Whole(results),
                ..
            } => results,
            Doing::Asked { .. } | Doing::Tracked(_) | Doing::Polyhedral(_) => &[],
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
    Stage {
        id: StageId(0),
        system: None,
        work,
        homotopy,
        start_points,
        settings: with.settings.clone(),
        seed: with.seed,
        attempt: 0,
    }
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
