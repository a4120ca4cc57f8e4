//! Real curves: the real part of components of dimension 1 as graphs.
//!
//! The points where a real linear form is critical on the curve, or the curve singular, are where it meets one
//! hypersurface more. Between two of their real values every real branch is the graph of a function of the form:
//! fibres in the middle count the branches, and real paths lead from there to both ends (Lu, Bates, Sommese,
//! Wampler: Finding all real points of a complex curve, Contemp. Math. 448, 2007).

mod assembled;
mod boxed;
mod clip;
mod finer;
mod proofs;
mod traced;

use super::context::Context;
use super::denominators::keep_isolated_points;
use super::error::{QuestionError, check_number};
use super::levels::{Change, levels, range_of};
use super::mirror::{conjugates_to_slice, is_own_conjugate};
use super::procedure::{GivenSystem, Procedure};
use super::real_box::{self, RealBox};
use crate::decomposition::DecompositionOptions;
use crate::decomposition::deflated::{Deflations, equal_ones_merged};
use crate::decomposition::job::{Job, StageSystem, Tracking};
use crate::decomposition::operand::Operand;
use crate::decomposition::problem::Problem;
use crate::decomposition::superset::SingularEnd;
use crate::regeneration_solve::level_homotopy;
use assembled::assemble;
use cognate_continuation::bend::{Number, RefinedPoint, SlicedEquations, doubles_of, exactly};
use cognate_numeric::counted::counted;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::Verdict;
use cognate_solutions::involution::Involution;
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::question::CurveWish;
use cognate_solutions::witness::real_curve::RealCurve;
use cognate_systems::system::System;
use cognate_systems::transform::MOST_CRITICAL_VARIABLES;
use finer::finer_samples;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use traced::{Critical, End, FibrePoint, Task, Tracing, distance};
pub(super) use traced::{row_of, value};

/// Most samples on either side of the middle of an arc.
const MOST_ARC_SAMPLES: u64 = 1000;
/// Most stages between fibres: one for each end of a slab and for each sample.
const MOST_STAGES: usize = 20_000;
/// Forms that are tried until one leaves no doubt.
const MOST_FORMS: u32 = 3;
/// A point whose digits are known is real within this, relative to its size.
const REAL: f64 = 1e-11;
/// A singular point whose digits are not all known is real within this, relative to its size.
const REAL_SINGULAR: f64 = 1e-5;
/// Points that are neither clearly real nor clearly not are farther from their conjugates than real ones, by at most
/// this factor.
const CLEAR: f64 = 1e2;
/// Distances beyond the outermost levels at which fibres are counted once more, in ranges of the levels.
const FAR: [f64; 2] = [2.0, 30.0];
/// Equations are regular at an end if their least singular value is more than this part of the largest.
const LOST: f64 = 1e-9;
/// Equations are regular at an end if their least singular value, as a part of the largest, is also more than this many
/// times the error of the end. Singular ends of the surfaces in `tests/surfaces` have at most 1e-12, regular ends 1e-7
/// and more.
const LOST_FACTOR: f64 = 1e3;
/// Newton's method does not come to a solution from an end that it moves farther than this, relative to the size of the
/// point.
const LOST_MOVED: f64 = 1e-2;
/// The error of a singular end that has no estimate.
const UNKNOWN_ACCURACY: f64 = 1e-6;
/// Ends of paths at singular points nearer than this, relative to their size, are one point.
const SAME_SINGULAR: f64 = 1e-5;
/// A value of the form is that of a level that is given within this part of their range.
const AT_LEVEL: f64 = 1e-7;
/// Distances of the points near levels for which curves on a surface are asked, as parts of the last sample's distance.
pub(super) const NEAR_LEVELS: [f64; 2] = [1.0 / 30.0, 1.0 / 900.0];

/// Step of the work on the current component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    Begin,
    /// Conjugates of the witness points go back to their slice.
    Mirror,
    /// Witness points go to the slice where levels begin.
    Start,
    /// A slice moves to the other forms of the level, as in a regeneration.
    MoveSlice,
    /// Paths go from the product of the forms to the equation whose solutions are the critical points.
    CriticalPoints,
    /// Witness points go to the faces of the box that was asked for.
    Window,
    Fibres,
    /// Points of all fibres are proved.
    Proofs,
    /// Tasks by place.
    Slabs(usize),
}

/// A form that is given, and values of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Given {
    form: Vec<[i32; 2]>,
    /// Levels besides those of the curve; none: only these.
    levels: Vec<f64>,
    /// The order of magnitude of the form.
    size: f64,
}

/// Component by component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RealCurves {
    given: Option<Given>,
    /// Samples of each arc, besides its ends and its middle; the variable along which all are followed; how near the
    /// samples are to the arcs.
    wish: CurveWish,
    found: Vec<RealCurve>,
    phase: Phase,
    number: u32,
    now: Tracing,
}

impl Procedure for RealCurves {
    fn advance(&mut self, context: &mut Context<'_>, mut done: Option<Job>) -> Option<Job> {
        loop {
            let operand = context.operands.get(self.found.len())?;
            let job = match (self.phase.clone(), done.take().as_ref()) {
                (Phase::Begin, _) => self.begin(context, operand),
                (Phase::Mirror, Some(job)) => self.mirrored(context, operand, job),
                (Phase::Start, Some(job)) => self.started(context, job),
                (Phase::MoveSlice, Some(job)) => self.slice_moved(context, job),
                (Phase::CriticalPoints, Some(job)) => self.critical_points(context, operand, job),
                (Phase::Window, Some(job)) => self.windowed(context, operand, job),
                (Phase::Fibres, Some(job)) => self.fibred(context, operand, job),
                (Phase::Proofs, Some(job)) => self.proved(context, operand, job),
                (Phase::Slabs(place), Some(job)) => self.connected(context, place, job),
                (_, None) => unreachable!("every phase after the first waits for a stage"),
            };
            if job.is_some() {
                return job;
            }
            self.settle(context, operand);
        }
    }

    fn answer(&mut self, given: &GivenSystem<'_>) -> Answer {
        Answer::RealCurve(given.take_solutions(&mut self.found, keep_isolated_points))
    }

    fn description(&self) -> &'static str {
        "following real branches between critical points"
    }
}

impl RealCurves {
    /// As [`Self::wished`], for a wish that comes from a client.
    pub fn new(system: &System, wish: &CurveWish) -> Result<Self, QuestionError> {
        check_number("samples", wish.samples.into(), MOST_ARC_SAMPLES)?;
        if let Some(tolerance) = wish.tolerance.filter(|t| !(t.is_finite() && *t > 0.0)) {
            let (value, expected) = (tolerance.to_string(), "a positive number");
            return Err(QuestionError::wish("tolerance", value, expected));
        }
        let count = system.variables.len();
        if let Some(place) = wish.projection.filter(|&place| place as usize >= count) {
            let value = place.to_string();
            let expected = format!("the place of one of {count} variables");
            return Err(QuestionError::wish("projection", value, expected));
        }
        real_box::checked(&wish.within, count)?;
        Ok(Self::wished(wish.clone()))
    }

    /// Along a variable, where that is wanted, or along random forms.
    pub fn wished(wish: CurveWish) -> Self {
        Self {
            given: None,
            wish,
            found: Vec::new(),
            phase: Phase::Begin,
            number: 0,
            now: Tracing::default(),
        }
    }

    /// Along this form, with these levels, among which are those of all curves, where there are some.
    pub fn along(samples: u32, form: Vec<[i32; 2]>, levels: Vec<f64>, size: f64) -> Self {
        Self {
            given: Some(Given { form, levels, size }),
            ..Self::wished(CurveWish {
                samples,
                ..CurveWish::default()
            })
        }
    }

    /// Writes down what is known of the component, or begins again with another form.
    fn settle(&mut self, context: &Context<'_>, operand: &Operand) {
        let tracing = std::mem::take(&mut self.now);
        let begun = !matches!(self.phase, Phase::Begin | Phase::Mirror);
        self.phase = Phase::Begin;
        let involution = context.problem.involution.as_ref();
        let within = involution.and_then(|i| RealBox::new(&self.wish.within, i));
        let mut curve = assemble(context, operand, &tracing, within);
        if begun && tracing.doubts.is_empty() {
            curve.check();
        }
        let random = self.given.is_none() && self.wish.projection.is_none();
        let others = random && self.number + 1 < MOST_FORMS;
        if begun && !curve.doubts.is_empty() && others {
            self.number += 1;
            return;
        }
        self.number = 0;
        self.found.push(curve);
    }

    fn doubt<T>(&mut self, doubt: impl Into<String>) -> Option<T> {
        self.now.doubts.push(doubt.into());
        None
    }

    fn begin(&mut self, context: &mut Context<'_>, operand: &Operand) -> Option<Job> {
        let n = context.problem.variables();
        if operand.dimension() != 1 {
            let dimension = operand.dimension();
            return self.doubt(format!("it has dimension {dimension}; curves have 1"));
        }
        if !operand.set.ranks.is_empty() {
            return self
                .doubt("it is multiple: its deflated equations are not followed to real points");
        }
        if n > MOST_CRITICAL_VARIABLES {
            return self.doubt(format!("{n} variables; at most {MOST_CRITICAL_VARIABLES}"));
        }
        let problem = context.problem;
        let Some(involution) = &problem.involution else {
            return self.doubt("complex conjugation does not map solutions to solutions");
        };
        self.now.form = match (&self.given, self.wish.projection) {
            (Some(given), _) => given.form.clone(),
            (None, Some(variable)) => {
                let variable = variable as usize;
                let conjugate_pair = [variable, involution.partner[variable]];
                let coefficient = |v: usize| [i32::from(conjugate_pair.contains(&v)), 0];
                (0..n).map(coefficient).collect()
            }
            (None, None) => form(context, self.number),
        };
        self.phase = Phase::Mirror;
        Some(conjugates_to_slice(context, operand, involution))
    }

    /// Whether the component is its own conjugate.
    fn mirrored(&mut self, context: &mut Context<'_>, operand: &Operand, job: &Job) -> Option<Job> {
        match is_own_conjugate(operand, job) {
            Some(own_conjugate) => self.now.apart = !own_conjugate,
            None => return self.doubt("whether it is its own conjugate is not clear"),
        }
        self.phase = Phase::Start;
        let targets = vec![context.problem.slices(1)];
        Some(operand.moved_to(&mut context.of_components(), targets))
    }

    fn started(&mut self, context: &mut Context<'_>, job: &Job) -> Option<Job> {
        for (_, decision, values) in job.ends() {
            match decision.verdict {
                Verdict::Finite => self.now.start.push(values),
                _ => return self.doubt("a witness point was lost on the way to another slice"),
            }
        }
        let degree = critical_degree(context, &self.now.form);
        match degree {
            0 => self.no_critical_points(context),
            1 => self.track_critical_points(context),
            degree => {
                self.phase = Phase::MoveSlice;
                Some(self.level(context, Some(degree - 1)))
            }
        }
    }

    /// A stage of the level that cuts the curve with its critical points.
    fn level(&self, context: &mut Context<'_>, other_forms: Option<u32>) -> Job {
        let n = context.problem.variables() as u32;
        let homotopy = level_homotopy(Vec::new(), (0..n).collect(), n - 1, other_forms);
        let wanted = StageSystem::Critical {
            form: self.now.form.clone(),
        };
        let system = context.of_components().described(wanted);
        let tracking = &context.problem.tracking;
        Job::track(system, homotopy, &self.now.start, tracking).ends_only()
    }

    fn slice_moved(&mut self, context: &mut Context<'_>, job: &Job) -> Option<Job> {
        for (_, decision, values) in job.ends() {
            match decision.verdict {
                Verdict::Finite => self.now.start.push(values),
                _ => return self.doubt("a point was lost on the way to another slice"),
            }
        }
        self.track_critical_points(context)
    }

    fn track_critical_points(&mut self, context: &mut Context<'_>) -> Option<Job> {
        self.phase = Phase::CriticalPoints;
        Some(self.level(context, None))
    }

    /// A line has no critical points.
    fn no_critical_points(&mut self, context: &mut Context<'_>) -> Option<Job> {
        if self.now.apart {
            return None;
        }
        let operand = &context.operands[self.found.len()];
        self.window(context, operand)
    }

    fn critical_points(
        &mut self,
        context: &mut Context<'_>,
        operand: &Operand,
        job: &Job,
    ) -> Option<Job> {
        let wanted = StageSystem::Critical {
            form: self.now.form.clone(),
        };
        let system = context.of_components().system(&wanted);
        let equations = SlicedEquations::new(&system, Vec::new());
        let involution = context.problem.involution.as_ref()?;
        let mut lost = 0;
        let mut critical_points: Vec<Critical> = Vec::new();
        let mut singular = Vec::new();
        let critical = |point: Vec<Complex64>, regular: bool, exact: bool| Critical {
            point,
            value: 0.0,
            regular,
            exact,
        };
        for (result, decision, values) in job.ends() {
            match decision.verdict {
                Verdict::AtInfinity => continue,
                Verdict::Failed | Verdict::WithinDataAccuracy | Verdict::ExcessSolution => {
                    lost += 1;
                    continue;
                }
                _ => {}
            }
            let start: Vec<_> = values.iter().map(|&z| exactly(z)).collect();
            let refined = equations.refine(&start).filter(|refined| {
                refined.condition < 1e10 && refined.correction < 1e-20 && refined.moved < 1e-4
            });
            match refined {
                Some(refined) => {
                    critical_points.push(critical(doubles_of(&refined.point), true, true))
                }
                None if no_solution(&equations, &start, result.accuracy) => lost += 1,
                None => singular.push((values, result.accuracy)),
            }
        }
        if lost > 0 {
            return self.doubt(format!(
                "{} to critical points failed",
                counted(lost, "path")
            ));
        }
        // Many paths end at one singular point, which deflated equations know to all digits.
        let mut places = (!singular.is_empty())
            .then(|| SingularPlaces::new(&system, &context.problem.tracking))
            .flatten();
        for (values, accuracy) in singular {
            let is_listed = |c: &Critical| distance(&c.point, &values) < SAME_SINGULAR;
            if critical_points.iter().any(is_listed) {
                continue;
            }
            let place = places
                .as_mut()
                .and_then(|places| places.at(&values, accuracy));
            let exact = place.is_some();
            critical_points.push(critical(place.unwrap_or(values), false, exact));
        }
        for mut point in critical_points {
            let image = involution.image(&point.point);
            let apart = distance(&point.point, &image);
            let within = if point.exact { REAL } else { REAL_SINGULAR };
            if apart > within * CLEAR {
                continue;
            }
            if apart > within {
                return self.doubt("a critical point is neither clearly real nor clearly not");
            }
            make_real(&mut point.point, involution);
            point.value = value(&self.now.form, &point.point);
            let same = |listed_point: &Critical| {
                distance(&listed_point.point, &point.point) < SAME_SINGULAR
            };
            if !self.now.critical.iter().any(same) {
                self.now.critical.push(point);
            }
        }
        if self.now.apart {
            if self.wish.certify {
                let unproved = "it is not its own conjugate: its real points are not proved";
                self.now.unproved.push(unproved.to_owned());
            }
            return None;
        }
        self.window(context, operand)
    }

    /// The stage of fibres in the middle of all slabs.
    fn slabs(&mut self, context: &mut Context<'_>, operand: &Operand) -> Option<Job> {
        let tracing = &mut self.now;
        tracing.critical.sort_by(|a, b| a.value.total_cmp(&b.value));
        let critical_points = tracing.critical.iter().chain(&tracing.window);
        let changes = critical_points.map(|critical| Change {
            value: critical.value,
            exact: critical.exact,
        });
        let Some(critical_values) = levels(changes.collect()) else {
            return self.doubt("two critical points have nearly the same value");
        };
        match self.given.as_ref().filter(|g| !g.levels.is_empty()) {
            None => tracing.levels = critical_values,
            Some(given) => {
                let range = range_of(critical_values.iter().copied());
                let same = |a: f64| {
                    let near = |b: &f64| (a - b).abs() <= AT_LEVEL * range;
                    given.levels.iter().any(near)
                };
                tracing.levels = given.levels.clone();
                if !critical_values.into_iter().all(same) {
                    return self.doubt("a critical point is at none of the levels");
                }
            }
        }
        let size = self
            .given
            .as_ref()
            .map_or_else(|| size_of(operand, &tracing.form), |g| g.size);
        tracing.middles = middles(&tracing.levels, size);
        let row = |value: &f64| vec![row_of(&tracing.form, *value)];
        let far = far_values(&tracing.levels, size);
        let targets = tracing.middles.iter().chain(&far).map(row).collect();
        tracing.far = far;
        self.phase = Phase::Fibres;
        Some(operand.moved_to(&mut context.of_components(), targets))
    }

    fn fibred(&mut self, context: &mut Context<'_>, operand: &Operand, job: &Job) -> Option<Job> {
        let involution = context.problem.involution.as_ref()?;
        let ends = job.ends();
        for (slab, ends) in ends.chunks(operand.degree()).enumerate() {
            let slabs = self.now.middles.len();
            let middle = match slab.checked_sub(slabs) {
                None => self.now.middles[slab],
                Some(far) => self.now.far[far],
            };
            let is = |wanted: Verdict| ends.iter().any(|(_, d, _)| d.verdict == wanted);
            if self.wish.projection.is_some() && is(Verdict::AtInfinity) {
                return self.doubt(format!(
                    "points of the fibre at {middle:.6} are at infinity, since the projection is not general"
                ));
            }
            if ends.iter().any(|(_, d, _)| d.verdict != Verdict::Finite) {
                return self.doubt(format!("points of the fibre at {middle:.6} were lost"));
            }
            let rows = vec![row_of(&self.now.form, middle)];
            let points: Vec<Vec<Complex64>> = ends.iter().map(|(_, _, v)| v.clone()).collect();
            let refined = context
                .deflations
                .points_on(context.problem, (&rows, &[]), &points);
            let Some(refined) = refined.into_iter().collect::<Option<Vec<_>>>() else {
                return self.doubt(format!("the fibre at {middle:.6} is not regular"));
            };
            let apart = refined.iter().map(|p| (p.clone(), 1)).collect();
            if equal_ones_merged(apart).len() < operand.degree() {
                return self.doubt(format!("two paths met in the fibre at {middle:.6}"));
            }
            let mut fibre = Vec::new();
            for refined in refined {
                let point = doubles_of(&refined.point);
                let Some(real) = is_real(&refined, &point, involution) else {
                    return self.doubt("a point is neither clearly real nor clearly not");
                };
                let Some(inside) = self.inside(context, &point) else {
                    return self.doubt(format!("at {middle:.6} the curve is on a face of the box"));
                };
                let wanted = real && inside;
                fibre.push(FibrePoint {
                    point,
                    real,
                    wanted,
                });
            }
            if slab < slabs {
                self.now.fibres.push(fibre);
                continue;
            }
            // Nothing happens beyond the outermost levels: else one is missing.
            let nearest = if middle < self.now.middles[0] {
                0
            } else {
                slabs - 1
            };
            let real = |fibre: &[FibrePoint]| fibre.iter().filter(|p| p.real).count();
            let [far, near] = [real(&fibre), real(&self.now.fibres[nearest])];
            if far != near {
                return self.doubt(format!(
                    "{far} real points over {middle:.6}, and {near} nearer: a critical point is missing"
                ));
            }
        }
        match self.wish.certify {
            true => self.prove(context, operand),
            false => self.follow(context),
        }
    }

    /// Begins with the paths between fibres.
    fn follow(&mut self, context: &mut Context<'_>) -> Option<Job> {
        self.plan_tasks();
        let stages = self.now.tasks.len();
        if stages > MOST_STAGES {
            return self.doubt(format!(
                "{stages} stages between fibres; at most {MOST_STAGES}: fewer samples take fewer"
            ));
        }
        self.next_task(context, 0)
    }

    /// Both ends of every slab, and samples in between.
    fn plan_tasks(&mut self) {
        let samples = self.wish.samples;
        let tracing = &mut self.now;
        let last = tracing.levels.len();
        // Where there is no level.
        let reach = self.given.as_ref().map_or(1.0, |given| 0.5 * given.size);
        let near = self
            .given
            .as_ref()
            .is_some_and(|given| !given.levels.is_empty());
        for slab in 0..tracing.middles.len() {
            let middle = tracing.middles[slab];
            let sides = [slab.checked_sub(1), (slab < last).then_some(slab)];
            let values = values_beside(&tracing.levels, middle, (slab, reach), (samples, near));
            for (values, level) in values.into_iter().zip(sides) {
                tracing.tasks.extend(level.map(|level| Task {
                    slab,
                    to: tracing.levels[level],
                    level: Some(level),
                    needed: true,
                }));
                if tracing.fibres[slab].iter().any(|p| p.wanted) {
                    let sample = |(place, to): (usize, f64)| Task {
                        slab,
                        to,
                        level: None,
                        needed: place < samples as usize,
                    };
                    tracing
                        .tasks
                        .extend(values.into_iter().enumerate().map(sample));
                }
            }
        }
    }

    fn next_task(&mut self, context: &mut Context<'_>, place: usize) -> Option<Job> {
        let task = *self.now.tasks.get(place)?;
        self.phase = Phase::Slabs(place);
        let wanted = StageSystem::Fibre {
            form: self.now.form.clone(),
            values: [self.now.middles[task.slab].to_bits(), task.to.to_bits()],
        };
        let system = context.of_components().described(wanted);
        let points: Vec<Vec<Complex64>> = self.travellers(&task).map(|p| p.point.clone()).collect();
        let tracking = &context.problem.tracking;
        Some(Job::along(system, &points, tracking).ends_only())
    }

    /// The points of a task: all of the fibre to the end of a slab, wanted ones to samples.
    fn travellers(&self, task: &Task) -> impl Iterator<Item = &FibrePoint> {
        let ends_at_level = task.level.is_some();
        let fibre = self.now.fibres[task.slab].iter();
        fibre.filter(move |p| ends_at_level || p.wanted)
    }

    fn connected(&mut self, context: &mut Context<'_>, place: usize, job: &Job) -> Option<Job> {
        let ends = job.ends().into_iter().map(|(_, decision, values)| {
            let regular = match decision.verdict {
                Verdict::Failed | Verdict::WithinDataAccuracy => return None,
                Verdict::AtInfinity => return Some(End::Infinite),
                verdict => verdict == Verdict::Finite,
            };
            Some(End::At {
                point: values,
                regular,
            })
        });
        self.now.ends.push(ends.collect());
        if place + 1 == self.now.tasks.len()
            && let Some(tolerance) = self.wish.tolerance
        {
            let finer = finer_samples(&self.now, tolerance, &|p| context.problem.to_variables(p));
            if finer.len() + self.now.tasks.len() > MOST_STAGES {
                return self.doubt(format!(
                    "the tolerance {tolerance} takes more than {MOST_STAGES} stages between fibres"
                ));
            }
            self.now.tasks.extend(finer);
        }
        self.next_task(context, place + 1)
    }
}

/// Whether a refined point is real; `None` where that is not clear.
fn is_real(refined: &RefinedPoint, point: &[Complex64], involution: &Involution) -> Option<bool> {
    let apart = distance(point, &involution.image(point));
    let limit = REAL * refined.condition.clamp(1.0, 1e4);
    match (apart <= limit, apart > limit * CLEAR) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        _ => None,
    }
}

/// Whether there is no solution near the end of a path: the equations are regular there, and yet Newton's method does
/// not come to one. (Where an equation nearly cancels, a path may seem to have ended before it has begun.)
fn no_solution(equations: &SlicedEquations, end: &[Number], accuracy: f64) -> bool {
    let values = equations.singular_values(end);
    let largest = values.first().copied().unwrap_or(1.0);
    let least = values.last().copied().unwrap_or(0.0);
    let noise = (LOST_FACTOR * accuracy).max(LOST);
    least > noise * largest
        && equations
            .refine(end)
            .is_none_or(|refined| refined.moved > LOST_MOVED)
}

/// Moves a point that is real but for rounding errors to the middle between it and its image.
fn make_real(point: &mut [Complex64], involution: &Involution) {
    let image = involution.image(point);
    for (coordinate, image) in point.iter_mut().zip(image) {
        *coordinate = 0.5 * (*coordinate + image);
    }
}

/// Values of the form in the middle of the slabs: before the first level, between two, after the last.
fn middles(levels: &[f64], size: f64) -> Vec<f64> {
    let (Some(first), Some(last)) = (levels.first(), levels.last()) else {
        return vec![0.0];
    };
    let margin = match levels.len() {
        1 => 0.5 * size,
        _ => 0.2 * (last - first).max(1e-3 * first.abs().max(1.0)),
    };
    let between = levels.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let before = std::iter::once(first - margin);
    before.chain(between).chain([last + margin]).collect()
}

/// Values beyond all levels, where a fibre must have as many real points as in the outermost slabs.
fn far_values(levels: &[f64], size: f64) -> Vec<f64> {
    let (first, last) = match (levels.first(), levels.last()) {
        (Some(&first), Some(&last)) => (first, last),
        _ => (0.0, 0.0),
    };
    let range = (last - first).max(0.5 * size);
    let beyond = FAR.map(|part| [first - part * range, last + part * range]);
    beyond.concat()
}

/// Values of samples on either side of the middle of a slab, with those near levels where they are wanted; `reach`: how
/// far they go where there is no level at all.
fn values_beside(
    levels: &[f64],
    middle: f64,
    (slab, reach): (usize, f64),
    (samples, near_wanted): (u32, bool),
) -> [Vec<f64>; 2] {
    let sides = [slab.checked_sub(1), (slab < levels.len()).then_some(slab)];
    let other = sides.into_iter().flatten().next();
    let reach = other.map_or(reach, |level| (levels[level] - middle).abs());
    let count = f64::from(samples + 1);
    let parts = (1..=samples).map(|k| f64::from(k) / count);
    // Denser near the end, where arcs may turn.
    let parts: Vec<f64> = parts.map(|part| part * (2.0 - part)).collect();
    let side = |level: Option<usize>, sign: f64| -> Vec<f64> {
        let end = level.map_or(middle + sign * reach, |level| levels[level]);
        let left = 1.0 - parts.last().copied().unwrap_or(0.0);
        let near = NEAR_LEVELS.map(|part| end - part * left * (end - middle));
        let near = near.into_iter().filter(|_| near_wanted && level.is_some());
        let values = parts.iter().map(|part| middle + part * (end - middle));
        values.chain(near).collect()
    };
    [side(sides[0], -1.0), side(sides[1], 1.0)]
}

/// Where singular critical points are, by deflations of the equations that they solve.
struct SingularPlaces {
    problem: Problem,
    deflations: Deflations,
}

impl SingularPlaces {
    fn new(critical: &System, tracking: &Tracking) -> Option<Self> {
        let options = DecompositionOptions {
            seed: tracking.seed,
            own_units: false,
            ..DecompositionOptions::default()
        };
        Some(Self {
            problem: Problem::of_options(critical, &options).ok()?,
            deflations: Deflations::default(),
        })
    }

    /// The isolated singular point near the end of a path, to all digits of a double.
    fn at(&mut self, values: &[Complex64], accuracy: f64) -> Option<Vec<Complex64>> {
        let end = SingularEnd {
            values: values.to_vec(),
            accuracy: if accuracy.is_finite() {
                accuracy
            } else {
                UNKNOWN_ACCURACY
            },
            paths: 1,
        };
        let regular_point = self.deflations.regular_point(&self.problem, 0, &end)?;
        Some(doubles_of(&regular_point.refined.point[..values.len()]))
    }
}

/// Values of the middles and of all samples of each slab, with those near levels, ascending, of curves along a form of
/// this size that is given.
pub(super) fn sections(levels: &[f64], size: f64, samples: u32) -> Vec<Vec<f64>> {
    let middles = middles(levels, size).into_iter().enumerate();
    let values = middles.map(|(slab, middle)| {
        let [below, above] = values_beside(levels, middle, (slab, 0.5 * size), (samples, true));
        let mut values: Vec<f64> = below.into_iter().chain([middle]).chain(above).collect();
        values.sort_by(f64::total_cmp);
        values
    });
    values.collect()
}

/// A random real form: integers that conjugation exchanges where it exchanges variables.
fn form(context: &Context<'_>, number: u32) -> Vec<[i32; 2]> {
    let n = context.problem.variables();
    let index = (1 << 50) | u64::from(number);
    let mut random = RandomStream::new(context.problem.seed(), Purpose::Question, index);
    let mut part = || random.below(1999) as i32 - 999;
    let mut form: Vec<[i32; 2]> = (0..n).map(|_| [part(), part()]).collect();
    let places: Vec<Complex64> = (0..n).map(|v| Complex64::new(v as f64, 0.0)).collect();
    let partners = context
        .problem
        .involution
        .as_ref()
        .map(|i| i.image(&places));
    for v in 0..n {
        let partner = partners.as_ref().map_or(v, |p| p[v].re as usize);
        if partner == v {
            form[v][1] = 0;
        } else if partner < v {
            form[v] = [form[partner][0], -form[partner][1]];
        }
        if form[v] == [0, 0] {
            form[v][0] = 1;
        }
    }
    form
}

/// The order of magnitude of the form on a component.
pub(super) fn size_of(operand: &Operand, form: &[[i32; 2]]) -> f64 {
    let row = row_of(form, 0.0);
    let length = row.iter().map(|c| c.norm_sqr()).sum::<f64>().sqrt();
    let points = operand.set.doubles();
    let mut sizes: Vec<f64> = points
        .iter()
        .map(|p| p.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt())
        .collect();
    sizes.sort_by(f64::total_cmp);
    length * sizes[sizes.len() / 2].max(1e-3)
}

/// Degree of the equation of critical points.
fn critical_degree(context: &mut Context<'_>, form: &[[i32; 2]]) -> u32 {
    let wanted = StageSystem::Critical {
        form: form.to_vec(),
    };
    let system = context.of_components().system(&wanted);
    let degrees = cognate_systems::polynomial::degrees(&system);
    // A constant that is not 0 has degree 0, and one that vanishes has none.
    degrees.map_or(0, |degrees| degrees.total.last().copied().unwrap_or(0))
}
