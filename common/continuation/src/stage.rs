//! PreparedStage: all that a worker makes of a stage before it tracks its items.

use crate::asked_system::AskedSystem;
use crate::chart::Chart;
use crate::homotopies::prepare::StartSystem;
use crate::homotopies::{Homotopy, HomotopyKind};
use crate::path_result::PathResult;
use crate::start_points::{DamagedPoints, Digest, StartPoints, StoredPoints};
use crate::start_systems::multihomogeneous::Multihomogeneous;
use crate::start_systems::total_degree::TotalDegree;
use crate::tracker::lockstep::Lockstep;
use crate::tracker::observer::{Observer, Recorder, StepEvent};
use crate::tracker::settings::Settings;
use crate::work::{Stage, Work};
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch_on};
use cognate_numeric::scalar::{DoubleDouble, Real};
use cognate_systems::polynomial::{PolynomialError, check_homogeneous, degrees};
use cognate_systems::system::{System, SystemError};
use cognate_systems::transform::randomize;
use num_complex::Complex64;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

/// Why a stage cannot be prepared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PrepareError {
    /// The system is not one.
    #[error(transparent)]
    System(#[from] SystemError),
    /// Fewer equations than unknowns.
    #[error(
        "the system has {equations} equations for {dimension} unknowns; tracking needs at least as many equations as unknowns"
    )]
    Underdetermined {
        /// Number of equations.
        equations: usize,
        /// Unknowns, up to the scaling of homogeneous groups.
        dimension: usize,
    },
    /// Degrees cannot be found, or the system is not homogeneous where it says so.
    #[error("{0}")]
    Degrees(String),
    /// The start points do not fit the system.
    #[error("the start points do not fit the system: {0}")]
    StartPoints(String),
    /// Parameter values do not fit the system.
    #[error("{what}: {found} values for {expected} parameters")]
    Parameters {
        /// Which values.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// The stage has no paths.
    #[error("the stage asks for other work than tracking")]
    Work,
    /// An arithmetic that is not there.
    #[error("not in this version: arithmetic of {0} bits; there are 53 and 106")]
    Precision(u32),
    /// The object with the start points is not there.
    #[error("the object {0} with the start points is missing")]
    MissingObject(Digest),
    /// The object with the start points is damaged.
    #[error(transparent)]
    Damaged(#[from] DamagedPoints),
}

#[derive(Debug)]
enum Points {
    Made(StartSystem),
    Stored(Arc<StoredPoints>),
}

/// A stage, ready to track any of its items, in any order, any number of times, with the same bits.
#[derive(Debug)]
pub struct PreparedStage {
    homotopy: Homotopy,
    /// The equations that are asked, where combinations of them are tracked.
    asked: Option<AskedSystem>,
    points: Points,
    stage: Stage,
    /// Number of start points of the stage that first started the paths.
    starts: u64,
    items: u64,
}

impl PreparedStage {
    /// Checks that stage and system fit, and compiles.
    ///
    /// `objects` finds stored start points by their digest.
    pub fn new(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        system.check()?;
        if stage.work != Work::Track {
            return Err(PrepareError::Work);
        }
        if !matches!(stage.settings.precision_bits, 53 | 106) {
            return Err(PrepareError::Precision(stage.settings.precision_bits));
        }
        let dimension = system.dimension();
        if system.equation_count() < dimension || dimension == 0 {
            return Err(PrepareError::Underdetermined {
                equations: system.equation_count(),
                dimension,
            });
        }
        let expected = system.parameters.len();
        let fits = |what, values: &[Complex64]| {
            if values.len() == expected {
                Ok(())
            } else {
                let found = values.len();
                Err(PrepareError::Parameters {
                    what,
                    found,
                    expected,
                })
            }
        };
        match &stage.homotopy {
            HomotopyKind::StraightLine { parameters } => fits("parameters", parameters)?,
            HomotopyKind::PathVariable { parameters } => {
                fits("parameters", parameters)?;
                if system.path_variable.is_none() {
                    return Err(PrepareError::StartPoints(
                        "the system has no path variable".into(),
                    ));
                }
            }
            HomotopyKind::Parameter { start, targets } => {
                fits("start parameters", start)?;
                if targets.is_empty() {
                    return Err(PrepareError::StartPoints(
                        "there are no target parameters".into(),
                    ));
                }
                for target in targets {
                    fits("target parameters", target)?;
                }
            }
        }
        let wrong = |error: PolynomialError| PrepareError::Degrees(error.to_string());
        let of_asked = degrees(system).map_err(wrong)?;
        check_homogeneous(system, &of_asked).map_err(wrong)?;
        let chart = Chart::new(system, stage.seed);
        // What is tracked: where there are more equations than unknowns, combinations of them.
        let overdetermined = system.equation_count() > dimension;
        let (asked, combined, of_system);
        let system = if overdetermined {
            let (kind, chart) = (&stage.homotopy, chart.clone());
            asked = Some(AskedSystem::new(system, &of_asked, kind, chart, stage.seed));
            combined = randomize(system, &of_asked, stage.seed);
            of_system = degrees(&combined).map_err(wrong)?;
            &combined
        } else {
            (asked, of_system) = (None, of_asked);
            system
        };
        let base = match &stage.start_points {
            StartPoints::Selected { base, .. } => base,
            other => other,
        };
        let starts = base
            .count()
            .ok_or_else(|| PrepareError::StartPoints("they are more than fit in 64 bits".into()))?;
        let items = stage
            .items()
            .ok_or_else(|| PrepareError::StartPoints("they are more than fit in 64 bits".into()))?;
        let straight = matches!(stage.homotopy, HomotopyKind::StraightLine { .. });
        let points = match base {
            StartPoints::TotalDegree { degrees } => {
                let fits = chart.group_count() == 1
                    && straight
                    && degrees
                        .iter()
                        .eq(of_system.by_group.iter().map(|row| &row[0]));
                if !fits {
                    return Err(PrepareError::StartPoints(
                        "a total-degree start has one group of variables and the degrees of the equations".into(),
                    ));
                }
                Points::Made(StartSystem::TotalDegree(TotalDegree::new(degrees)))
            }
            StartPoints::Multihomogeneous {
                degrees,
                dimensions,
            } => {
                let fits = straight
                    && *degrees == of_system.by_group
                    && dimensions.len() == chart.group_count()
                    && (0..dimensions.len())
                        .all(|k| dimensions[k] as usize == chart.group_size(k) - 1);
                let made = fits
                    .then(|| Multihomogeneous::new(degrees, dimensions, &chart, stage.seed))
                    .flatten()
                    .ok_or_else(|| {
                        PrepareError::StartPoints(
                            "the degrees or dimensions are not those of the system's groups".into(),
                        )
                    })?;
                Points::Made(StartSystem::Multihomogeneous(made))
            }
            StartPoints::Stored { object, count } => {
                let stored = objects(*object).ok_or(PrepareError::MissingObject(*object))?;
                if stored.len() as u64 != *count || stored.dimension != system.variable_count() {
                    return Err(PrepareError::StartPoints(format!(
                        "{} points of {} coordinates for {} variables",
                        stored.len(),
                        stored.dimension,
                        system.variable_count()
                    )));
                }
                if straight {
                    return Err(PrepareError::StartPoints(
                        "stored points start a parameter homotopy or a user homotopy".into(),
                    ));
                }
                Points::Stored(stored)
            }
            StartPoints::Selected { .. } => {
                return Err(PrepareError::StartPoints(
                    "a selection of a selection".into(),
                ));
            }
        };
        if let StartPoints::Selected { indices, .. } = &stage.start_points {
            let targets = match &stage.homotopy {
                HomotopyKind::Parameter { targets, .. } => targets.len() as u64,
                _ => 1,
            };
            let end = starts.saturating_mul(targets);
            if indices.iter().any(|&i| i >= end) {
                return Err(PrepareError::StartPoints(
                    "a selected index is too large".into(),
                ));
            }
        }
        let start_system = match &points {
            Points::Made(made) => Some(made),
            Points::Stored(_) => None,
        };
        let homotopy = Homotopy::new(
            system,
            &of_system,
            &stage.homotopy,
            start_system,
            chart,
            stage.seed,
        );
        Ok(Self {
            homotopy,
            asked,
            points,
            stage: stage.clone(),
            starts,
            items,
        })
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        self.items
    }

    /// The homotopy.
    pub fn homotopy(&self) -> &Homotopy {
        &self.homotopy
    }

    pub(crate) fn settings(&self) -> &Settings {
        &self.stage.settings
    }

    pub(crate) fn attempt(&self) -> u16 {
        self.stage.attempt
    }

    /// The path's index in the stage that first started it, and its target.
    pub(crate) fn item(&self, item: u64) -> (u64, u64) {
        let origin = self.stage.origin(item);
        match self.stage.homotopy {
            HomotopyKind::Parameter { .. } => (origin, origin / self.starts),
            _ => (origin, 0),
        }
    }

    /// The start point of the path with this origin, in the chart; `None` where it lies on no patch.
    pub(crate) fn start_point(&self, origin: u64) -> Option<Vec<Complex64>> {
        let chart = self.homotopy.chart();
        match &self.points {
            Points::Made(StartSystem::TotalDegree(s)) => s.point(chart, origin),
            Points::Made(StartSystem::Multihomogeneous(s)) => s.point(chart, origin),
            Points::Stored(points) => {
                let index = usize::try_from(origin % self.starts).ok()?;
                chart.from_variables(points.point(index))
            }
        }
    }

    /// Tracks the paths of these items, `width` (1, 8 or 16) at a time; results in item order.
    ///
    /// Pure: the same items give the same bits at every width, in every range, on every machine
    /// with fused multiply-add.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage or `width` is none of the three.
    pub fn track(&self, items: Range<u64>, width: usize) -> Vec<PathResult> {
        self.track_on(InstructionSet::detect(), items, width)
    }

    /// [`Self::track`] with one instruction set, for tests that compare them.
    pub fn track_on(
        &self,
        set: InstructionSet,
        items: Range<u64>,
        width: usize,
    ) -> Vec<PathResult> {
        assert!(items.end <= self.items, "a chunk lies within its stage");
        let wide = matches!(self.settings().precision_bits, 106);
        let first = items.start;
        let mut results = match (width, wide) {
            (1, false) => dispatch_on(set, Track::<f64>::new(self, items, None)),
            (8, false) => dispatch_on(set, Track::<Lanes<8>>::new(self, items, None)),
            (16, false) => dispatch_on(set, Track::<Lanes<16>>::new(self, items, None)),
            // Few paths come here, one at a time; lanes of double-doubles multiply the time that
            // this crate takes to compile by ten.
            (1 | 8 | 16, true) => {
                dispatch_on(set, Track::<DoubleDouble<f64>>::new(self, items, None))
            }
            _ => panic!("there are lanes of width 1, 8 and 16, not {width}"),
        };
        self.hold_against_asked(first, &mut results);
        results
    }

    /// Says of results, from item `first` on, how well they solve all equations that are asked.
    fn hold_against_asked(&self, first: u64, results: &mut [PathResult]) {
        if let Some(asked) = &self.asked {
            for (item, result) in (first..).zip(results) {
                result.asked = asked.fit(result, self.item(item).1);
            }
        }
    }

    /// Tracks one path again and keeps every step.
    pub fn trace(&self, item: u64) -> (PathResult, Vec<StepEvent>) {
        assert!(item < self.items, "the item lies within the stage");
        let mut recorder = Recorder::default();
        let (set, items) = (InstructionSet::detect(), item..item + 1);
        let mut results = if self.settings().precision_bits == 106 {
            dispatch_on(
                set,
                Track::<DoubleDouble<f64>>::new(self, items, Some(&mut recorder)),
            )
        } else {
            dispatch_on(set, Track::<f64>::new(self, items, Some(&mut recorder)))
        };
        self.hold_against_asked(item, &mut results);
        (results.remove(0), recorder.0)
    }
}

/// One chunk in one arithmetic.
struct Track<'a, R>(
    &'a PreparedStage,
    Range<u64>,
    Option<&'a mut dyn Observer>,
    PhantomData<R>,
);

impl<'a, R> Track<'a, R> {
    fn new(
        stage: &'a PreparedStage,
        items: Range<u64>,
        observer: Option<&'a mut dyn Observer>,
    ) -> Self {
        Self(stage, items, observer, PhantomData)
    }
}

impl<R: Real<Context = ()>> Job for Track<'_, R> {
    type Output = Vec<PathResult>;
    #[inline(always)]
    fn run(self) -> Vec<PathResult> {
        Lockstep::<R>::new(self.0, (), self.1, self.2).run()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path_result::PathIndex;
    use crate::tracker::outcome::PathOutcome;
    use crate::work::StageId;
    use cognate_systems::named::{cyclic, griewank_osborne, katsura};

    fn stage(degrees: &[u32]) -> Stage {
        Stage {
            id: StageId(0),
            work: Work::Track,
            homotopy: HomotopyKind::StraightLine {
                parameters: Vec::new(),
            },
            start_points: StartPoints::TotalDegree {
                degrees: degrees.to_vec(),
            },
            settings: Settings::default(),
            seed: 11,
            attempt: 0,
        }
    }

    fn prepare(system: &System) -> PreparedStage {
        let found = degrees(system).unwrap();
        PreparedStage::new(system, &stage(&found.total), &|_| None).unwrap()
    }

    #[test]
    fn a_path_is_the_same_alone_in_any_company_and_on_any_instruction_set() {
        for system in [
            katsura(5).system,
            cyclic(5).system,
            griewank_osborne().system,
        ] {
            let prepared = prepare(&system);
            let all = prepared.track(0..prepared.items(), 8);
            for set in [
                InstructionSet::Avx512,
                InstructionSet::Avx2,
                InstructionSet::Neon,
            ] {
                for width in [1, 8, 16] {
                    let mut split = Vec::new();
                    let mut begin = 0;
                    for size in [1, 2, 3, 5, 7, 11, 13].into_iter().cycle() {
                        let end = (begin + size).min(prepared.items());
                        split.extend(prepared.track_on(set, begin..end, width));
                        begin = end;
                        if begin == prepared.items() {
                            break;
                        }
                    }
                    assert_eq!(all, split, "{} at width {width}", set.name());
                }
            }
        }
    }

    #[test]
    fn a_path_tracked_again_keeps_its_start_and_its_end() {
        let system = katsura(4).system;
        let first = prepare(&system);
        let mut again = stage(&degrees(&system).unwrap().total);
        again.start_points = StartPoints::Selected {
            base: Box::new(again.start_points),
            indices: vec![3, 7],
        };
        again.settings = again.settings.tightened(1);
        again.attempt = 1;
        let again = PreparedStage::new(&system, &again, &|_| None).unwrap();
        let (old, new) = (first.track(0..16, 8), again.track(0..2, 8));
        for (result, index) in new.iter().zip([3, 7]) {
            assert_eq!((result.origin, result.attempt), (PathIndex(index), 1));
            let before = &old[index as usize];
            let pairs = before
                .endpoint
                .to_double()
                .iter()
                .zip(result.endpoint.to_double());
            for (a, b) in pairs {
                assert!((a - b).norm_sqr() < 1e-20);
            }
        }
    }

    #[test]
    fn a_traced_path_ends_like_the_path_and_shows_its_steps() {
        let prepared = prepare(&katsura(4).system);
        let (result, events) = prepared.trace(5);
        assert_eq!(result, prepared.track(5..6, 16)[0]);
        let moves = ["approach", "inward", "turn"];
        let accepted = events
            .iter()
            .filter(|e| e.accepted && moves.contains(&e.phase));
        assert_eq!(accepted.count(), result.counts.steps as usize);
        assert_eq!(events.first().unwrap().phase, "start");
        assert_eq!(events.last().unwrap().phase, "arrival");
    }

    #[test]
    fn a_parameter_homotopy_moves_solutions_and_comes_back() {
        // x^2 = p from p = 4 to p = 9 and to p = -1.
        let mut system = System {
            variables: vec!["x".into()],
            parameters: vec!["p".into()],
            groups: vec![cognate_systems::system::VariableGroup {
                variables: vec![0],
                homogeneous: false,
            }],
            equation_names: vec!["f".into()],
            ..System::default()
        };
        let x = system.expressions.variable(0);
        let square = system.expressions.power(x, 2);
        let p = system.expressions.parameter(0);
        let f = system.expressions.subtract(square, p);
        system.equations = vec![f];
        let real = |v: f64| Complex64::new(v, 0.0);
        let points = Arc::new(StoredPoints {
            dimension: 1,
            coordinates: vec![real(2.0), real(-2.0), real(0.5)],
        });
        let digest = Digest([7; 32]);
        let mut stage = stage(&[2]);
        stage.homotopy = HomotopyKind::Parameter {
            start: vec![real(4.0)],
            targets: vec![vec![real(9.0)], vec![real(-1.0)]],
        };
        stage.start_points = StartPoints::Stored {
            object: digest,
            count: 3,
        };
        let missing = PreparedStage::new(&system, &stage, &|_| None);
        assert_eq!(missing.unwrap_err(), PrepareError::MissingObject(digest));
        let prepared = PreparedStage::new(&system, &stage, &|_| Some(points.clone())).unwrap();
        let results = prepared.track(0..prepared.items(), 8);
        let squares: Vec<_> = results
            .iter()
            .map(|r| {
                let y = r.endpoint.to_double();
                (r.outcome, (y[1] / y[0]) * (y[1] / y[0]))
            })
            .collect();
        for (k, target) in [(0, 9.0), (1, 9.0), (3, -1.0), (4, -1.0)] {
            assert_eq!(squares[k].0, PathOutcome::Regular);
            assert!((squares[k].1 - target).norm_sqr() < 1e-20, "{squares:?}");
        }
        // 0.5 is no solution at p = 4: said so, for both targets.
        for k in [2, 5] {
            let expected = PathOutcome::Failed(crate::tracker::outcome::Failure::InvalidStartPoint);
            assert_eq!(squares[k].0, expected);
        }
    }

    /// Survey, system (35): three conics through (0,0), (1,0), (0,-1); two combinations of them
    /// meet in a fourth point, which solves only those.
    #[test]
    fn an_endpoint_is_held_against_all_equations_that_are_asked() {
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y; function f1, f2, f3; \
                    f1 = x*y; f2 = x*(x - y - 1); f3 = y*(x - y - 1);\nEND;\n";
        let system = cognate_systems::formats::read("35", text.as_bytes()).unwrap();
        let prepared = PreparedStage::new(&system.system, &stage(&[2, 2]), &|_| None).unwrap();
        let results = prepared.track(0..4, 8);
        let mut solutions = 0;
        for result in &results {
            assert_eq!(result.outcome, PathOutcome::Regular);
            let y = result.endpoint.to_double();
            let (x, y) = (y[1] / y[0], y[2] / y[0]);
            let near = |a: f64, b: f64| (x - a).norm_sqr() + (y - b).norm_sqr() < 1e-20;
            let solves = near(0.0, 0.0) || near(1.0, 0.0) || near(0.0, -1.0);
            let fit = result.asked.unwrap();
            assert_eq!(fit.residual < 1e-12, solves, "{fit:?} at ({x}, {y})");
            assert_eq!(fit.correction < 1e-12, solves, "{fit:?} at ({x}, {y})");
            solutions += u64::from(solves);
        }
        assert_eq!(solutions, 3);
        assert_eq!(prepared.trace(2).0, results[2]);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let system = katsura(3).system;
        let refused = |stage: &Stage| PreparedStage::new(&system, stage, &|_| None).unwrap_err();
        assert!(matches!(
            refused(&stage(&[2, 2, 2])),
            PrepareError::StartPoints(_)
        ));
        let mut wrong = stage(&degrees(&system).unwrap().total);
        wrong.homotopy = HomotopyKind::StraightLine {
            parameters: vec![Complex64::default()],
        };
        assert!(matches!(
            refused(&wrong),
            PrepareError::Parameters {
                found: 1,
                expected: 0,
                ..
            }
        ));
        let mut fewer = system.clone();
        fewer.equations.pop();
        let error = PreparedStage::new(&fewer, &stage(&[1]), &|_| None).unwrap_err();
        assert!(matches!(error, PrepareError::Underdetermined { .. }));
    }
}
