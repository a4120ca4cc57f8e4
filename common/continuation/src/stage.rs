//! PreparedStage: all that a worker makes of a stage before it tracks its items.

use crate::asked_system::AskedSystem;
use crate::chart::Chart;
use crate::homotopies::prepare::{Compile, StartSystem};
use crate::homotopies::sections::sections;
use crate::homotopies::{Homotopy, HomotopyKind};
use crate::moved_parameters::{MovedEnd, MovedParameters};
use crate::path_result::{AskedFit, PathResult};
pub use crate::prepare_error::PrepareError;
use crate::start_fit::{Points, StartFit, in_order};
use crate::start_points::{Digest, StartPoints, StoredPoints};
use crate::start_systems::polyhedral::generic::GenericSystem;
use crate::tracker::boundary::Boundary;
use crate::tracker::settings::Settings;
use crate::work::{Stage, Work};
use cognate_systems::evaluation::Interpreter;
use cognate_systems::polynomial::{Degrees, PolynomialError, check_homogeneous, degrees, supports};
use cognate_systems::scaling::Scaling;
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::nonzero_variables;
use cognate_systems::transform::randomize;
use num_complex::Complex64;
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

/// The homotopy in projective patches, compiled when the first path needs it.
#[derive(Debug)]
struct ProjectiveHomotopy {
    equations: Arc<ProjectiveEquations>,
    homotopy: OnceLock<Homotopy>,
}

/// The parts of a homotopy in projective patches; stages with other targets share them.
#[derive(Debug)]
struct ProjectiveEquations {
    system: System,
    degrees: Degrees,
    start_system: Option<StartSystem>,
    first_chart: Chart,
    /// The homotopy with the targets of the stage that needed it first.
    compiled: OnceLock<Homotopy>,
}

/// A stage, ready to track any of its items, in any order, any number of times, with the same bits.
#[derive(Debug)]
pub struct PreparedStage {
    /// Homotopy in the chart where the paths begin.
    homotopy: Homotopy,
    /// Homotopy in random projective patches, for paths that leave the affine chart; `None` where all paths are tracked
    /// in projective patches from the beginning.
    projective: Option<ProjectiveHomotopy>,
    /// The equations that are asked, where combinations of them are tracked.
    asked: Option<AskedSystem>,
    /// The equations at the end of paths with slightly other values of parameters, where the place of an end may depend
    /// on these.
    moved_parameters: Option<Arc<MovedParameters>>,
    points: Points,
    boundary: Boundary,
    stage: Stage,
    /// Number of start points of the stage that first started the paths.
    starts: u64,
    items: u64,
}

/// The equations that are tracked: the system, or combinations of its equations if it has more than unknowns.
struct TrackedEquations<'a> {
    system: Cow<'a, System>,
    degrees: Degrees,
    /// The equations that are asked, if combinations of them are tracked to the system.
    asked: Option<AskedSystem>,
}

impl<'a> TrackedEquations<'a> {
    fn new(system: &'a System, stage: &Stage) -> Result<Self, PrepareError> {
        let wrong = |error: PolynomialError| PrepareError::Degrees(error.to_string());
        let degrees_of_asked = degrees(system).map_err(wrong)?;
        check_homogeneous(system, &degrees_of_asked).map_err(wrong)?;
        if system.equation_count() <= system.dimension() {
            return Ok(Self {
                system: Cow::Borrowed(system),
                degrees: degrees_of_asked,
                asked: None,
            });
        }
        let kind = &stage.homotopy;
        let chart = Chart::new(system, stage.seed, stage.attempt);
        // On the way to the system its points are no solutions of it yet.
        let asked = kind
            .ends_at_the_system()
            .then(|| AskedSystem::new(system, &degrees_of_asked, kind, chart, stage.seed));
        let combined = randomize(system, &degrees_of_asked, stage.seed);
        Ok(Self {
            degrees: degrees(&combined).map_err(wrong)?,
            system: Cow::Owned(combined),
            asked,
        })
    }
}

/// A stage that fits its system; nothing is compiled yet.
struct Checked<'a> {
    /// The system that is tracked: the given system, or combinations of its equations.
    system: Cow<'a, System>,
    degrees: Degrees,
    asked: Option<AskedSystem>,
    chart: Chart,
    /// The chart of the first attempt.
    first_chart: Chart,
    /// Whether paths begin in the system's own coordinates.
    affine: bool,
    points: Points,
    start_system: Option<StartSystem>,
    starts: u64,
    items: u64,
}

impl<'a> Checked<'a> {
    /// `system` is in the unknowns that are tracked; stored points are values of the variables,
    /// which are `scaling` times as large.
    fn new(
        system: &'a System,
        scaling: &Scaling,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        if stage.work != Work::Track {
            return Err(PrepareError::Work);
        }
        let dimension = system.dimension();
        if system.equation_count() < dimension || dimension == 0 {
            return Err(PrepareError::Underdetermined {
                equations: system.equation_count(),
                dimension,
            });
        }
        check_homotopy(system, &stage.homotopy)?;
        let overdetermined = system.equation_count() > dimension;
        let tracked = TrackedEquations::new(system, stage)?;
        let system: &System = &tracked.system;
        let affine = stage.homotopy.begins_in_affine_coordinates();
        let exchange = stage.start_points.exchange();
        if exchange.is_some_and(|exchange| overdetermined || !exchange.fits(system)) {
            return Err(PrepareError::StartPoints(
                "the exchange is none of the system's groups and equations".into(),
            ));
        }
        let chart = |attempt| match (affine, exchange) {
            (true, _) => Chart::affine(system, stage.seed, attempt),
            (false, None) => Chart::new(system, stage.seed, attempt),
            (false, Some(exchange)) => {
                Chart::new(system, stage.seed, attempt).with_exchange(exchange)
            }
        };
        let (first_chart, chart) = (chart(0), chart(stage.attempt));
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
        let generic = match stage.homotopy.has_the_generic_system() {
            true => Some(generic_system(system, overdetermined, stage.seed)?),
            false => None,
        };
        let fit = StartFit {
            system,
            degrees: &tracked.degrees,
            chart: &chart,
            scaling,
            stage,
            generic: generic.as_ref(),
        };
        let points = fit.points(base, objects)?;
        check_selection(stage, starts)?;
        let start_system = match &points {
            Points::Made(made) => Some(made.clone()),
            Points::Stored(_) => generic.map(StartSystem::Generic),
        };
        Ok(Self {
            system: tracked.system,
            degrees: tracked.degrees,
            asked: tracked.asked,
            chart,
            first_chart,
            affine,
            points,
            start_system,
            starts,
            items,
        })
    }
}

/// Refuses a selection of paths that the stage does not have; `starts` is its number of start points.
fn check_selection(stage: &Stage, starts: u64) -> Result<(), PrepareError> {
    if let StartPoints::Selected { indices, .. } = &stage.start_points {
        let end = starts.saturating_mul(stage.homotopy.targets());
        if indices.iter().any(|&i| i >= end) {
            return Err(PrepareError::StartPoints(
                "a selected index is too large".into(),
            ));
        }
    }
    Ok(())
}

/// Whether the numbers of a homotopy fit the system.
fn check_homotopy(system: &System, homotopy: &HomotopyKind) -> Result<(), PrepareError> {
    let dimension = system.dimension();
    let expected = system.parameters.len();
    let fits = |what, values: &[Complex64]| {
        if values.len() == expected {
            Ok(())
        } else {
            let length = values.len();
            Err(PrepareError::Parameters {
                what,
                found: length,
                expected,
            })
        }
    };
    match homotopy {
        HomotopyKind::StraightLine { parameters } | HomotopyKind::Generic { parameters } => {
            fits("parameters", parameters)?;
        }
        HomotopyKind::MoveSlice {
            parameters,
            order,
            level,
            ..
        }
        | HomotopyKind::ProductToEquation {
            parameters,
            order,
            level,
        } => {
            fits("parameters", parameters)?;
            let mut sorted = order.clone();
            sorted.sort_unstable();
            let takes_each_once = sorted.iter().copied().eq(0..dimension as u32);
            if !(takes_each_once && (*level as usize) < dimension && in_order(system)) {
                return Err(PrepareError::StartPoints(
                    "a regeneration takes each equation once, in one affine group of all variables"
                        .into(),
                ));
            }
        }
        HomotopyKind::Toric => {}
        HomotopyKind::Sections { .. } => {
            return Err(PrepareError::StartPoints("a section of a section".into()));
        }
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
    Ok(())
}

/// A stage on the sections of a curve is one of the curve's own system, in which the sections
/// are parameters; `None` for every other.
fn on_sections(system: &System, stage: &Stage) -> Result<Option<(System, Stage)>, PrepareError> {
    let HomotopyKind::Sections {
        parameters,
        direction,
        start,
        target,
    } = &stage.homotopy
    else {
        return Ok(None);
    };
    system.check()?;
    let curve = sections(system, parameters, direction).ok_or_else(|| {
        PrepareError::StartPoints("the system has no sections, or not with these numbers".into())
    })?;
    let along = Stage {
        homotopy: HomotopyKind::Parameter {
            start: start.clone(),
            targets: vec![target.clone()],
        },
        ..stage.clone()
    };
    Ok(Some((curve, along)))
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
        Self::compiled(system, stage, objects, Interpreter::compile)
    }

    /// Prepares the stage for checks of ends: the program compiles several times as fast and runs slower. Paths that it
    /// tracks have other bits than those of [`Self::new`].
    pub(crate) fn for_checks(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        Self::compiled(system, stage, objects, Interpreter::compile_in_one_way)
    }

    fn compiled(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
        compile: Compile,
    ) -> Result<Self, PrepareError> {
        if let Some((curve, along)) = on_sections(system, stage)? {
            return Self::compiled(&curve, &along, objects, compile);
        }
        system.check()?;
        let in_unknowns = system.in_unknowns();
        let checked = Checked::new(&in_unknowns, &system.scaling, stage, objects)?;
        let homotopy = Homotopy::new(
            &checked.system,
            &checked.degrees,
            &stage.homotopy,
            checked.start_system.as_ref(),
            checked.chart.clone(),
            &checked.first_chart,
            &sample(&checked.points, &checked.chart),
            stage.seed,
            compile,
        );
        let moved_parameters = MovedParameters::new(
            system,
            &checked.system,
            &checked.degrees,
            checked.start_system.as_ref(),
            &checked.first_chart,
            stage,
        );
        let projective = checked.affine.then(|| ProjectiveHomotopy {
            equations: Arc::new(ProjectiveEquations {
                system: checked.system.into_owned(),
                degrees: checked.degrees,
                start_system: checked.start_system,
                first_chart: checked.first_chart,
                compiled: OnceLock::new(),
            }),
            homotopy: OnceLock::new(),
        });
        let exchange = stage.start_points.exchange();
        Ok(Self {
            boundary: Boundary::new(homotopy.chart(), exchange, stage.seed),
            homotopy,
            projective,
            asked: checked.asked,
            moved_parameters: moved_parameters.map(Arc::new),
            points: checked.points,
            stage: stage.clone(),
            starts: checked.starts,
            items: checked.items,
        })
    }

    /// Prepares a stage of the same system and objects without compiling, with the same result as [`Self::new`]. `None`
    /// where more than the targets of a parameter homotopy is different, or where the compiled program depends on the
    /// targets.
    pub fn with_targets(&self, stage: &Stage) -> Option<Self> {
        let (
            HomotopyKind::Parameter { start, .. },
            HomotopyKind::Parameter {
                start: other_start,
                targets,
            },
        ) = (&self.stage.homotopy, &stage.homotopy)
        else {
            return None;
        };
        let same_otherwise = start == other_start
            && self.stage.system == stage.system
            && self.stage.work == stage.work
            && self.stage.start_points == stage.start_points
            && self.stage.settings == stage.settings
            && (self.stage.seed, self.stage.attempt) == (stage.seed, stage.attempt);
        let fit = !targets.is_empty() && targets.iter().all(|target| target.len() == start.len());
        let starts_are_selected = matches!(stage.start_points, StartPoints::Selected { .. });
        if !same_otherwise || !fit || starts_are_selected || self.asked.is_some() {
            return None;
        }
        let Points::Stored(points) = &self.points else {
            return None;
        };
        let projective = self.projective.as_ref();
        Some(Self {
            homotopy: self.homotopy.with_targets(targets)?,
            projective: projective.map(|projective| ProjectiveHomotopy {
                equations: Arc::clone(&projective.equations),
                homotopy: OnceLock::new(),
            }),
            asked: None,
            moved_parameters: self.moved_parameters.clone(),
            points: Points::Stored(Arc::clone(points)),
            boundary: self.boundary.clone(),
            stage: stage.clone(),
            starts: self.starts,
            items: stage.items()?,
        })
    }

    /// Whether [`Self::new`] would succeed, without what takes long: nothing is compiled.
    pub fn check(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<(), PrepareError> {
        let on_curve = on_sections(system, stage)?;
        let (system, stage) = match &on_curve {
            Some((curve, along)) => (curve, along),
            None => (system, stage),
        };
        system.check()?;
        Checked::new(&system.in_unknowns(), &system.scaling, stage, objects).map(|_| ())
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        self.items
    }

    /// The homotopy in the chart where the paths begin.
    pub fn homotopy(&self) -> &Homotopy {
        &self.homotopy
    }

    /// The homotopy in projective patches, for paths that left the affine chart; `None` where
    /// all paths begin in projective patches.
    pub(crate) fn projective_homotopy(&self) -> Option<&Homotopy> {
        let projective = self.projective.as_ref()?;
        Some(projective.homotopy.get_or_init(|| {
            let equations = &projective.equations;
            let HomotopyKind::Parameter { targets, .. } = &self.stage.homotopy else {
                return self.in_patches(equations);
            };
            let compiled = equations
                .compiled
                .get_or_init(|| self.in_patches(equations));
            let with_own = compiled.with_targets(targets);
            with_own.unwrap_or_else(|| self.in_patches(equations))
        }))
    }

    /// Compiles the homotopy in projective patches.
    fn in_patches(&self, equations: &ProjectiveEquations) -> Homotopy {
        let chart = Chart::new(&equations.system, self.stage.seed, self.stage.attempt);
        let begins = sample(&self.points, &chart);
        Homotopy::new(
            &equations.system,
            &equations.degrees,
            &self.stage.homotopy,
            equations.start_system.as_ref(),
            chart,
            &equations.first_chart,
            &begins,
            self.stage.seed,
            Interpreter::compile,
        )
    }

    /// Whether paths end at solutions of the system, rather than of one on the way to it.
    pub(crate) fn ends_at_the_system(&self) -> bool {
        self.stage.homotopy.ends_at_the_system()
    }

    /// Whether paths may leave the chart where they begin.
    pub(crate) fn has_projective_homotopy(&self) -> bool {
        self.projective.is_some()
    }

    /// Whether the place of an end may depend on rounding of the values of parameters.
    pub(crate) fn has_moved_parameters(&self) -> bool {
        self.moved_parameters.is_some()
    }

    /// The equations at the end of paths to this target with slightly other values of parameters; `None` where the place
    /// of an end does not depend on these. `homotopy`: that of this stage in which a path has come to its end.
    pub(crate) fn with_moved_parameters(
        &self,
        homotopy: &Homotopy,
        target: u64,
    ) -> Option<MovedEnd<'_>> {
        let moved = self.moved_parameters.as_ref()?;
        Some(moved.at_end(homotopy, target))
    }

    /// Keys by which paths are known where they enter the endgame.
    pub(crate) fn boundary(&self) -> &Boundary {
        &self.boundary
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
        (origin, self.stage.homotopy.target_of(origin, self.starts))
    }

    /// The start point of the path with this origin, in the chart; `None` where it lies on no patch.
    pub(crate) fn start_point(&self, origin: u64) -> Option<Vec<Complex64>> {
        let chart = self.homotopy.chart();
        match &self.points {
            Points::Made(StartSystem::TotalDegree(s)) => s.point(chart, origin),
            Points::Made(StartSystem::Multihomogeneous(s)) => s.point(chart, origin),
            Points::Made(StartSystem::LinearProduct(s)) => s.point(chart, origin),
            Points::Made(StartSystem::Toric(s)) => chart.from_variables(&s.point(origin)?),
            Points::Made(StartSystem::Generic(_)) => None,
            Points::Stored(points) => {
                let index = usize::try_from(origin % self.starts).ok()?;
                chart.from_variables(points.point(index))
            }
        }
    }

    /// Computes how well an end solves all equations that are asked, for this target; `None` where these are tracked.
    pub(crate) fn fit_of_asked(&self, path: &PathResult, target: u64) -> Option<AskedFit> {
        let asked = self.asked.as_ref()?;
        asked.fit(path, target)
    }

    /// Says of results, from item `first` on, how well they solve all equations that are asked.
    pub(crate) fn hold_against_asked(&self, first: u64, results: &mut [PathResult]) {
        if let Some(asked) = &self.asked {
            for (item, result) in (first..).zip(results) {
                result.asked = asked.fit(result, self.item(item).1);
            }
        }
    }
}

/// A few of the stored start points, evenly spaced, in the chart; none of a start system.
fn sample(points: &Points, chart: &Chart) -> Vec<Vec<Complex64>> {
    const SAMPLES: usize = 32;
    let Points::Stored(points) = points else {
        return Vec::new();
    };
    let count = points.len().min(SAMPLES);
    (0..count)
        .filter_map(|k| chart.from_variables(points.point(k * points.len() / count)))
        .collect()
}

/// The generic system with the monomials of a square one in affine groups.
pub(crate) fn generic_system(
    system: &System,
    overdetermined: bool,
    seed: u64,
) -> Result<GenericSystem, PrepareError> {
    if overdetermined || system.groups.iter().any(|group| group.homogeneous) {
        return Err(PrepareError::StartPoints(
            "mixed cells are for as many equations as unknowns, in affine groups".into(),
        ));
    }
    let supports = supports(system).ok_or_else(|| {
        PrepareError::StartPoints("the equations are too large to be multiplied out".into())
    })?;
    Ok(GenericSystem::new(
        &supports,
        &nonzero_variables(system),
        seed,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path_result::PathIndex;
    use crate::tracker::outcome::PathOutcome;
    use cognate_numeric::lanes::dispatch::InstructionSet;
    use cognate_systems::named::{cyclic, griewank_osborne, katsura};

    fn stage(degrees: &[u32]) -> Stage {
        Stage::new(
            Work::Track,
            HomotopyKind::StraightLine {
                parameters: Vec::new(),
            },
            StartPoints::TotalDegree {
                degrees: degrees.to_vec(),
            },
            Settings::default(),
            11,
        )
    }

    fn prepare(system: &System) -> PreparedStage {
        let equation_degrees = degrees(system).unwrap();
        PreparedStage::new(system, &stage(&equation_degrees.total), &|_| None).unwrap()
    }

    #[test]
    fn what_leaves_the_affine_chart_goes_on_and_is_the_same_at_every_width() {
        // p x^2 + x - 2 and y - x^2: for p -> 0 one of the two solutions runs away.
        let mut e = cognate_systems::expression::Expressions::new();
        let (x, y, p) = (e.variable(0), e.variable(1), e.parameter(0));
        let square = e.power(x, 2);
        let scaled = e.multiply(p, square);
        let (sum, two) = (e.add(scaled, x), e.integer(2));
        let equations = vec![e.subtract(sum, two), e.subtract(y, square)];
        let system = System {
            expressions: e,
            variables: vec!["x".into(), "y".into()],
            parameters: vec!["p".into()],
            groups: vec![cognate_systems::system::VariableGroup {
                variables: vec![0, 1],
                homogeneous: false,
            }],
            equations,
            equation_names: vec!["f".into(), "g".into()],
            ..System::default()
        };
        let c = |re: f64| Complex64::new(re, 0.0);
        // x^2 + x - 2 = (x - 1)(x + 2), many times over.
        let points: Vec<Complex64> = (0..20)
            .flat_map(|_| [c(1.0), c(1.0), c(-2.0), c(4.0)])
            .collect();
        let stored = Arc::new(StoredPoints {
            dimension: 2,
            coordinates: points,
        });
        let stage = Stage {
            homotopy: HomotopyKind::Parameter {
                start: vec![c(1.0)],
                targets: vec![vec![c(0.0)], vec![Complex64::new(-2.0, 1.0)]],
            },
            start_points: StartPoints::Stored {
                object: Digest([0; 32]),
                count: 40,
            },
            ..stage(&[2, 2])
        };
        let prepared = PreparedStage::new(&system, &stage, &|_| Some(stored.clone())).unwrap();
        let narrow = prepared.track(0..prepared.items(), 1);
        for width in [8, 16] {
            assert_eq!(narrow, prepared.track(0..prepared.items(), width));
        }
        assert_eq!(narrow[31..47], prepared.track(31..47, 8)[..]);
        for (i, result) in narrow.iter().enumerate() {
            let end = result.endpoint.to_double();
            let far = result.outcome == PathOutcome::Diverging || end[0].norm_sqr() < 1e-20;
            assert_eq!(far, i < 40 && i % 2 == 1, "{i}: {result:?}");
            if !far {
                assert_eq!(result.outcome, PathOutcome::Regular, "{i}");
                assert!(result.accuracy < 1e-12, "{i}: {result:?}");
            }
        }
        assert!(
            (narrow[0].endpoint.to_double()[1] / narrow[0].endpoint.to_double()[0] - 2.0)
                .norm_sqr()
                < 1e-20
        );
    }

    #[test]
    fn a_path_is_the_same_alone_in_any_company_and_on_any_instruction_set() {
        for system in [
            katsura(5).system,
            cyclic(5).system,
            griewank_osborne().system,
        ] {
            let prepared = prepare(&system);
            let results = prepared.track(0..prepared.items(), 8);
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
                    assert_eq!(results, split, "{} at width {width}", set.name());
                }
            }
        }
    }

    /// Paths that are tracked again go on in another patch, and the homotopy is the same one: each
    /// start point has the end that it had.
    #[test]
    fn a_path_tracked_again_keeps_its_start_and_its_end() {
        for system in [katsura(4).system, cyclic(5).system] {
            let first = prepare(&system);
            let indices: Vec<u64> = (0..first.items()).step_by(3).collect();
            let mut retry = stage(&degrees(&system).unwrap().total);
            retry.start_points = StartPoints::Selected {
                base: Box::new(retry.start_points),
                indices: indices.clone(),
            };
            retry.settings = retry.settings.tightened(1);
            retry.attempt = 1;
            let second = PreparedStage::new(&system, &retry, &|_| None).unwrap();
            assert_ne!(first.start_point(3), second.start_point(3), "another patch");
            let old = first.track(0..first.items(), 8);
            let new = second.track(0..second.items(), 8);
            let mut regular = 0;
            for (result, &index) in new.iter().zip(&indices) {
                assert_eq!((result.origin, result.attempt), (PathIndex(index), 1));
                let before = &old[index as usize];
                let ends_regularly = |path: &PathResult| path.outcome == PathOutcome::Regular;
                assert_eq!(
                    ends_regularly(before),
                    ends_regularly(result),
                    "path {index}"
                );
                if !ends_regularly(result) {
                    continue;
                }
                regular += 1;
                let (a, b) = (before.endpoint.to_double(), result.endpoint.to_double());
                let pairs = || a.iter().zip(b.iter());
                for (x, y) in pairs() {
                    for (v, w) in pairs() {
                        assert!((x * w - v * y).norm_sqr() < 1e-20, "path {index}");
                    }
                }
            }
            assert!(regular > 5);
        }
    }

    #[test]
    fn a_traced_path_ends_like_the_path_and_shows_its_steps() {
        let prepared = prepare(&katsura(4).system);
        let results = prepared.track(0..prepared.items(), 16);
        let straight = results.iter().position(|result| result.counts.turns == 0);
        let path = straight.expect("most paths end without turns");
        let (result, events) = prepared.trace(path as u64);
        assert_eq!(result, results[path]);
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
