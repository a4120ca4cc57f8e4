//! Lockstep: many paths at once, one in each lane, always in the same phase of a step.
//!
//! Predict; Newton; Newton and tangent from one factorisation; accept or shrink.
//! Every lane has its own t and step, a rejected lane only shrinks its step, and
//! a lane whose path has ended takes the next start point with a step of length
//! 0. So there is no divergence, and no lane ever looks at another: the bits of
//! a path are those of the same path alone (W = 1 is a width). What a room
//! (a chart and an arithmetic) cannot do, another may: see `rooms`.

use super::lane::{Lane, Phase};
use super::observer::{Observer, StepEvent};
use super::outcome::{Failure, PathOutcome};
use super::rooms::{Departure, Door, Ended, Room, Waiting};
use super::settings::Settings;
use crate::chart::{LEAST_NORM, norm};
use crate::endgames::cauchy::{self, VERTICES, distance};
use crate::path_result::{Coordinates, Counts, PathIndex, PathResult};
use crate::predictor::hermite::{POINTS, weights};
use crate::refine::Refiner;
use crate::stage::PreparedStage;
use crate::step_control::next_step;
use cognate_machine_code::Evaluator;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::precision::{DOUBLE, unit_roundoff};
use cognate_numeric::roots_of_unity::roots_of_unity;
use cognate_numeric::scalar::{Complex, Mask, Real};
use cognate_systems::evaluation::Evaluate;
use num_complex::Complex64;

/// A step is accepted when the second Newton correction is at most this part of the first.
const CONTRACTION: f64 = 0.1;
/// Largest first correction at which a start point is believed.
const START_ERROR: f64 = 1e-3;
/// Farthest that the last Newton steps may move a regular endpoint.
const ARRIVED: f64 = 1e-7;
/// A refinement is accepted when its second correction is below this: then it is noise.
const REFINED: f64 = 1e-6;

/// Smallest step around 0, or towards it, as a part of the distance from it.
const LEAST_ARC: f64 = 1e-9;
/// Part of the way left below which a step speaks of a singularity beside the path: towards one
/// at its end, steps are a third of the way or so.
const PASSING: f64 = 0.1;
/// Part of the endgame's first radius at which the turns begin in any case.
const PASSED: f64 = 1e-3;
/// A path whose coordinates exceed this goes on in projective patches.
const FAR: f64 = 1e4;
/// So many rejections since the last accepted step that only noise explains send a path to the
/// next rung.
const STARVED: u32 = 2;
/// An endgame that does not settle is not tried again above this many bits: what then remains
/// is not for want of digits.
const ENDGAME_BITS: u32 = 212;

/// The paths of all lanes: coordinates in the chart.
///
/// The points stand in a ring. Every step fills the oldest slot: in lanes that moved with the new
/// point, in all others with a copy of the point where they still are, and the slot that was
/// copied no longer counts there. So nothing is shifted, and which points count in a lane is known
/// from its own steps alone.
struct Batch<R: Real> {
    x: [Vec<Complex<R>>; POINTS],
    tangent: [Vec<Complex<R>>; POINTS],
    t: [Complex<R::Control>; POINTS],
    /// In which lanes a slot's point counts; where a path is, always.
    known: [R::Mask; POINTS],
    /// The slot where the paths are.
    newest: usize,
    target: Complex<R::Control>,
    /// Wanted length of the next step.
    h: R::Control,
    /// Lanes whose next step has length 0.
    refine: R::Mask,
    /// Lanes whose last step was not rejected.
    may_grow: R::Mask,
    a: Vec<Complex<R>>,
    b: Vec<Complex<R>>,
    exchanges: R::Control,
}

impl<R: Real> Batch<R> {
    fn new(context: R::Context, dimension: usize, parameters: usize) -> Self {
        let points = || vec![Complex::<R>::zero(context); dimension];
        let control = |v: f64| R::Control::from_f64((), v);
        Self {
            x: std::array::from_fn(|_| points()),
            tangent: std::array::from_fn(|_| points()),
            t: std::array::from_fn(|_| Complex::from_f64((), 1.0, 0.0)),
            known: [R::Mask::splat(false); POINTS],
            newest: 0,
            target: Complex::from_f64((), 1.0, 0.0),
            h: control(0.0),
            refine: R::Mask::splat(true),
            may_grow: R::Mask::splat(true),
            a: vec![Complex::zero(context); parameters],
            b: vec![Complex::zero(context); parameters],
            exchanges: control(0.0),
        }
    }

    /// The slot with the points of so many steps ago.
    #[inline(always)]
    fn slot(&self, age: usize) -> usize {
        (self.newest + age) % POINTS
    }

    /// Where the paths are.
    fn here(&self) -> &[Complex<R>] {
        &self.x[self.newest]
    }

    /// Where they go.
    fn tangent_here(&self) -> &[Complex<R>] {
        &self.tangent[self.newest]
    }

    /// Where a path is, in t.
    fn t(&self, lane: usize) -> Complex64 {
        self.t[self.newest].lane(lane)
    }

    /// The slot of the last point behind a path.
    fn before(&self, lane: usize) -> usize {
        (1..POINTS)
            .map(|age| self.slot(age))
            .find(|&slot| self.known[slot].lane(lane))
            .expect("the path has moved")
    }

    /// The points behind a lane no longer belong to where it goes.
    fn forget_history(&mut self, lane: usize) {
        for known in &mut self.known {
            known.set_lane(lane, false);
        }
    }

    fn read(
        &self,
        lane: usize,
        slot: usize,
        point: &mut Vec<Complex64>,
        tangent: &mut Vec<Complex64>,
    ) {
        point.clear();
        point.extend(self.x[slot].iter().map(|z| z.lane(lane)));
        tangent.clear();
        tangent.extend(self.tangent[slot].iter().map(|z| z.lane(lane)));
    }

    fn read_here(&self, lane: usize, point: &mut Vec<Complex64>, tangent: &mut Vec<Complex64>) {
        self.read(lane, self.newest, point, tangent);
    }

    fn write(&mut self, lane: usize, t: Complex64, point: &[Complex64], tangent: &[Complex64]) {
        let slot = self.newest;
        for (z, value) in self.x[slot].iter_mut().zip(point) {
            z.set_lane(lane, *value);
        }
        for (z, value) in self.tangent[slot].iter_mut().zip(tangent) {
            z.set_lane(lane, *value);
        }
        self.t[slot].set_lane(lane, t);
        self.forget_history(lane);
    }

    /// The lane's next step has length 0.
    fn refine(&mut self, lane: usize) {
        self.refine.set_lane(lane, true);
    }

    /// The lane's next steps lead to `target`, the first at most `h` long.
    fn follow(&mut self, lane: usize, target: Complex64, h: f64) {
        self.target.set_lane(lane, target);
        self.h.set_lane(lane, h);
        self.refine.set_lane(lane, false);
        self.may_grow.set_lane(lane, true);
    }
}

/// All lanes of one room.
pub(super) struct Lockstep<'a, R: Real> {
    stage: &'a PreparedStage,
    room: Room<'a>,
    context: R::Context,
    settings: Settings,
    /// Larger first corrections than this are not noise of this arithmetic.
    noise: f64,
    batch: Batch<R>,
    lanes: Vec<Lane>,
    scratch: <Evaluator as Evaluate<R>>::Scratch,
    matrix: Matrix<R>,
    p: Vec<Complex<R>>,
    dp: Vec<Complex<R>>,
    refiner: Refiner<'a, R::Single>,
    circle: Vec<Complex64>,
    waiting: Waiting,
    ended: Ended,
    observer: Option<&'a mut dyn Observer>,
    point: Vec<Complex64>,
    tangent: Vec<Complex64>,
}

/// What one step showed in one lane.
struct Step {
    accepted: bool,
    arrived: bool,
    /// First and second Newton correction, relative.
    predictor_error: f64,
    correction: f64,
    /// Largest coordinate of the point that was tried.
    size: f64,
}

impl<'a, R: Real> Lockstep<'a, R> {
    #[inline(always)]
    pub(super) fn new(
        room: Room<'a>,
        context: R::Context,
        waiting: Waiting,
        observer: Option<&'a mut dyn Observer>,
    ) -> Self {
        let homotopy = room.homotopy;
        let n = homotopy.dimension();
        let parameters = homotopy.parameter_count();
        let settings = room.settings();
        let noise =
            0.01 * settings.predictor_tolerance * unit_roundoff(room.bits) / unit_roundoff(DOUBLE);
        Self {
            stage: room.stage,
            context,
            settings,
            noise,
            batch: Batch::new(context, n, parameters),
            lanes: vec![Lane::default(); R::WIDTH],
            scratch: Evaluate::<R>::scratch(homotopy.evaluator(), context),
            matrix: Matrix::zeros(context, n, n + 2),
            p: vec![Complex::zero(context); parameters],
            dp: vec![Complex::zero(context); parameters],
            refiner: Refiner::new(homotopy, context),
            circle: roots_of_unity(VERTICES),
            room,
            waiting,
            ended: Ended::default(),
            observer,
            point: Vec::with_capacity(n),
            tangent: Vec::with_capacity(n),
        }
    }

    /// Until every path has ended or left.
    #[inline(always)]
    pub(super) fn run(mut self) -> Ended {
        for lane in 0..R::WIDTH {
            self.refill(lane);
        }
        while self.lanes.iter().any(|lane| lane.phase != Phase::Idle) {
            self.step();
        }
        self.ended
    }

    /// Puts the next path into a lane, if there is one.
    fn refill(&mut self, lane: usize) {
        let homotopy = self.room.homotopy;
        loop {
            let path = &mut self.lanes[lane];
            let (t, exchanges, start) = if let Some(item) = self.waiting.items.next() {
                let (origin, target) = self.stage.item(item);
                path.begin(item, origin, target);
                let start = self.stage.start_point(origin);
                (Complex64::new(1.0, 0.0), 0.0, start)
            } else if let Some(departure) = self.waiting.departures.pop_front() {
                *path = departure.lane;
                let start = homotopy.chart().point(&departure.point);
                (departure.t, departure.exchanges, start)
            } else {
                path.phase = Phase::Idle;
                return;
            };
            path.arrive(self.room.bits);
            let target = path.target;
            self.batch.exchanges.set_lane(lane, exchanges);
            let (a, b) = homotopy.ends(target);
            for (slot, value) in self.batch.a.iter_mut().zip(a) {
                slot.set_lane(lane, value);
            }
            for (slot, value) in self.batch.b.iter_mut().zip(b) {
                slot.set_lane(lane, value);
            }
            if let Some(point) = start {
                self.batch.write(lane, t, &point, &point);
                self.batch.follow(lane, t, 0.0);
                self.batch.refine(lane);
                return;
            }
            self.point.clear();
            self.point
                .resize(homotopy.dimension(), Complex64::default());
            self.fail(lane, t, Failure::InvalidStartPoint);
        }
    }

    /// One step of all lanes.
    #[inline(always)]
    fn step(&mut self) {
        let settings = &self.settings;
        let n = self.room.homotopy.dimension();
        let control = |v: f64| R::Control::from_f64((), v);

        // Where to: a step of length h towards the target, or the target itself.
        let batch = &mut self.batch;
        let mut way = batch.target.clone();
        let newest = batch.newest;
        way.sub(&batch.t[newest]);
        let mut remaining = way.norm_sqr();
        remaining.sqrt();
        let reaches = remaining.less_equal(&batch.h);
        // The last two steps are equal: a tiny last one would show nothing but noise.
        let mut half = remaining.clone();
        half.mul(&control(0.5));
        let mut tried = batch.h.clone();
        tried.select(half.less_equal(&batch.h), &half);
        tried.select(reaches, &remaining);
        let mut ratio = tried.clone();
        ratio.div(&remaining);
        tried.select(batch.refine, &control(0.0));
        let mut t = batch.t[newest].clone();
        way.scale(&ratio);
        t.add(&way);
        t.select(reaches, &batch.target);
        t.select(batch.refine, &batch.t[newest]);

        // Predict, from the point itself where the step has length 0.
        let slots: [usize; POINTS] = std::array::from_fn(|age| batch.slot(age));
        let counts: [R::Mask; POINTS - 1] = std::array::from_fn(|k| batch.known[slots[k + 1]]);
        let moving = batch.refine.not();
        let w = weights(
            &std::array::from_fn(|age| batch.t[slots[age]].clone()),
            &t,
            &std::array::from_fn(|k| counts[k].and(moving)),
        );
        let next = slots[POINTS - 1];
        let mut candidate = std::mem::take(&mut batch.x[next]);
        let mut candidate_tangent = std::mem::take(&mut batch.tangent[next]);
        for i in 0..n {
            let weight = Complex::from_control(self.context, &w.point[POINTS - 1]);
            let mut sum = Complex::zero(self.context);
            sum.set_product(&weight, &candidate[i]);
            let weight = Complex::from_control(self.context, &w.tangent[POINTS - 1]);
            sum.mul_add(&weight, &candidate_tangent[i]);
            for age in (0..POINTS - 1).rev() {
                let slot = slots[age];
                let weight = Complex::from_control(self.context, &w.tangent[age]);
                sum.mul_add(&weight, &batch.tangent[slot][i]);
                let weight = Complex::from_control(self.context, &w.point[age]);
                sum.mul_add(&weight, &batch.x[slot][i]);
            }
            candidate[i].set(&sum);
        }

        // Newton; then Newton and tangent from one factorisation.
        let homotopy = self.room.homotopy;
        homotopy.path().at(
            self.context,
            &t,
            &batch.a,
            &batch.b,
            &mut self.p,
            &mut self.dp,
        );
        let mut corrections = [control(0.0), control(0.0)];
        let mut size = control(0.0);
        for (round, correction) in corrections.iter_mut().enumerate() {
            if round == 0 {
                homotopy.evaluator().jacobian(
                    &candidate,
                    &self.p,
                    &mut self.matrix,
                    &mut self.scratch,
                );
                homotopy
                    .elimination()
                    .eliminate::<R, 1>(&mut self.matrix, &mut batch.exchanges);
            } else {
                homotopy.evaluator().linearize(
                    &candidate,
                    &self.p,
                    &self.dp,
                    &mut self.matrix,
                    &mut self.scratch,
                );
                homotopy
                    .elimination()
                    .eliminate::<R, 2>(&mut self.matrix, &mut batch.exchanges);
            }
            size = control(LEAST_NORM * LEAST_NORM);
            for i in 0..n {
                let delta = self.matrix.at(i, n);
                correction.max(&delta.norm_sqr().control());
                candidate[i].sub(delta);
                size.max(&candidate[i].norm_sqr().control());
            }
        }
        for i in 0..n {
            let tangent = &mut candidate_tangent[i];
            tangent.set(self.matrix.at(i, n + 1));
            tangent.neg();
        }
        size.sqrt();
        for correction in &mut corrections {
            correction.sqrt();
            correction.div(&size);
        }
        let [first, second] = &corrections;

        // Accept: the correction contracts, and what is left of it is below the tolerance.
        let limit = control(settings.predictor_tolerance);
        let tolerance = control(settings.tolerance);
        let mut contracted = control(CONTRACTION);
        contracted.mul(first);
        let mut left = second.clone();
        left.mul(second);
        let mut allowed = tolerance.clone();
        allowed.mul(first);
        let converging = second
            .less_equal(&contracted)
            .and(left.less_equal(&allowed));
        let mut noise = control(0.1);
        noise.mul(&tolerance);
        let moved = first
            .less_equal(&limit)
            .and(converging.or(second.less_equal(&noise)))
            .and(batch.refine.not());
        let refined = second
            .less_equal(&control(REFINED))
            .and(first.less_equal(&control(START_ERROR)))
            .and(batch.refine);
        let accepted = moved.or(refined);
        let wanted = next_step(&batch.h, first, &limit, &counts, moved, batch.may_grow);
        // A step that only reached its target says little about longer ones: keep the wish.
        let mut h = wanted;
        h.min(&control(settings.max_step));
        h.select(batch.refine, &batch.h);
        batch.h.set(&h);
        let refining = batch.refine;
        batch.may_grow = moved.or(refining);

        // Move: what stays where it is stands in the new slot, and no longer in the old one.
        let stays = accepted.not();
        if stays.any() {
            for i in 0..n {
                candidate[i].select(stays, &batch.x[newest][i]);
                candidate_tangent[i].select(stays, &batch.tangent[newest][i]);
            }
        }
        batch.x[next] = candidate;
        batch.tangent[next] = candidate_tangent;
        let mut there = batch.t[newest].clone();
        there.select(moved, &t);
        batch.t[next] = there;
        batch.known[newest] = moved;
        batch.known[next] = R::Mask::splat(false);
        batch.newest = next;

        // What only single paths know: a glance at each, and more where something happened.
        for lane in 0..R::WIDTH {
            if self.lanes[lane].phase == Phase::Idle {
                continue;
            }
            let path = &mut self.lanes[lane];
            path.evaluations += 2;
            let step = Step {
                accepted: accepted.lane(lane),
                arrived: accepted.lane(lane) && reaches.lane(lane),
                predictor_error: first.lane(lane),
                correction: second.lane(lane),
                size: size.lane(lane),
            };
            if refining.lane(lane) {
            } else if step.accepted {
                path.steps += 1;
                path.steps_here += 1;
                (path.starved, path.last_rejected) = (0, f64::INFINITY);
            } else {
                path.rejections += 1;
                // A correction that neither Newton's method nor a shorter step makes smaller is
                // noise.
                let stuck = step.predictor_error <= self.noise
                    && step.correction > CONTRACTION * step.predictor_error
                    && step.correction > 0.3 * path.last_rejected;
                path.starved += u32::from(stuck);
                path.last_rejected = step.correction;
            }
            if let Some(observer) = &mut self.observer {
                let point: Vec<_> = self.batch.here().iter().map(|z| z.lane(lane)).collect();
                let event = StepEvent {
                    phase: path.phase.name(),
                    t: t.lane(lane),
                    step: tried.lane(lane),
                    accepted: step.accepted,
                    predictor_error: step.predictor_error,
                    correction: step.correction,
                    precision_bits: self.room.bits,
                    point: homotopy.endpoint(&point),
                };
                observer.step(path.origin, event);
            }
            self.attend(lane, &step);
        }
    }

    /// Decides how one path goes on after a step.
    fn attend(&mut self, lane: usize, step: &Step) {
        let settings = &self.settings;
        let phase = self.lanes[lane].phase;
        let t = self.batch.t(lane);
        let h = self.batch.h.lane(lane);
        let steps = self.lanes[lane].steps + self.lanes[lane].rejections;
        if steps > settings.max_steps {
            self.batch
                .read_here(lane, &mut self.point, &mut self.tangent);
            return self.fail_and_refill(lane, t, Failure::TooManySteps);
        }
        match phase {
            Phase::Idle => {}
            Phase::Starting => {
                self.batch
                    .read_here(lane, &mut self.point, &mut self.tangent);
                if !step.accepted {
                    return self.give_up(lane, t, Failure::InvalidStartPoint);
                }
                // With the tangent alone the error is about (h |x'|/|x|)^2 / 2.
                let speed = norm(&self.tangent) / norm(&self.point);
                let mut reach = settings.predictor_tolerance;
                Real::sqrt(&mut reach);
                let h = (0.5 * reach / speed).min(settings.max_step).max(1e-6);
                self.batch.follow(lane, Complex64::default(), h);
                self.lanes[lane].phase = Phase::Approaching;
            }
            Phase::Approaching => {
                // Steps far shorter than the way that is left speak of a singularity beside the
                // path, not at its end: it is passed by before the turns begin.
                let radius = settings.endgame_radius;
                let passing = h < PASSING * t.re && t.re > PASSED * radius;
                let at_end = t.re <= radius && !passing && !(step.accepted && h >= t.re);
                if step.arrived {
                    self.lanes[lane].phase = Phase::Arriving;
                    self.batch.refine(lane);
                } else if self.room.beyond && (step.size > FAR || at_end) {
                    self.batch
                        .read_here(lane, &mut self.point, &mut self.tangent);
                    self.leave(lane, t, Door::Beyond);
                } else if step.accepted
                    && self.room.down
                    && self.lanes[lane].may_go_down()
                    && t.re > 10.0 * settings.endgame_radius
                {
                    self.batch
                        .read_here(lane, &mut self.point, &mut self.tangent);
                    self.leave(lane, t, Door::Down);
                } else if at_end {
                    self.lanes[lane].phase = Phase::Settling;
                    self.batch.refine(lane);
                } else if self.lanes[lane].starved >= STARVED
                    || h < settings.min_step * t.re.max(settings.endgame_radius)
                {
                    self.batch
                        .read_here(lane, &mut self.point, &mut self.tangent);
                    self.give_up(lane, t, Failure::StepTooSmall);
                }
            }
            Phase::Arriving => {
                self.batch
                    .read_here(lane, &mut self.point, &mut self.tangent);
                self.tangent.clone_from(&self.point);
                let report = self
                    .refiner
                    .refine(&mut self.point, self.lanes[lane].target);
                // From a singular endpoint Newton's method may leave for another solution.
                let moved = distance(&self.point, &self.tangent) / norm(&self.tangent);
                if step.accepted
                    && report.condition <= settings.singular_condition
                    && report.converged
                    && moved <= ARRIVED
                {
                    return self.finish(lane, PathOutcome::Regular, report, None, Vec::new());
                }
                // Back to the last point before 0, from where the turns begin.
                let slot = self.batch.before(lane);
                let before = self.batch.t[slot].lane(lane);
                self.batch
                    .read(lane, slot, &mut self.point, &mut self.tangent);
                if self.room.beyond {
                    return self.leave(lane, before, Door::Beyond);
                }
                let (point, tangent) = (
                    std::mem::take(&mut self.point),
                    std::mem::take(&mut self.tangent),
                );
                self.batch.write(lane, before, &point, &tangent);
                (self.point, self.tangent) = (point, tangent);
                if before.re > settings.endgame_boundary {
                    let boundary = Complex64::new(settings.endgame_boundary, 0.0);
                    self.batch.follow(lane, boundary, 0.1 * before.re);
                    self.lanes[lane].phase = Phase::Inward;
                } else {
                    self.batch.refine(lane);
                    self.lanes[lane].phase = Phase::Settling;
                }
            }
            Phase::Inward | Phase::Turning => {
                if step.arrived {
                    self.lanes[lane].phase = match phase {
                        Phase::Inward => Phase::Settling,
                        _ => Phase::Sampling,
                    };
                    self.batch.refine(lane);
                } else if self.lanes[lane].starved >= STARVED || h < LEAST_ARC * t.norm_sqr().sqrt()
                {
                    self.batch
                        .read_here(lane, &mut self.point, &mut self.tangent);
                    self.give_up(lane, t, Failure::StepTooSmall);
                }
            }
            Phase::Settling | Phase::Sampling => {
                self.batch
                    .read_here(lane, &mut self.point, &mut self.tangent);
                if !step.accepted {
                    return self.give_up(lane, t, Failure::EndgameUnsettled);
                }
                let homogenizing = self.homogenizing(false);
                let next = if phase == Phase::Settling {
                    let path = &mut self.lanes[lane];
                    path.first_turn
                        .get_or_insert_with(|| (t.re, self.point.clone()));
                    path.cauchy.begin(
                        t.re,
                        &self.point,
                        &self.tangent,
                        step.correction,
                        &homogenizing,
                    )
                } else {
                    let valuations = self.valuations(t, &homogenizing);
                    self.lanes[lane].cauchy.at_vertex(
                        &self.point,
                        step.correction,
                        &homogenizing,
                        &valuations,
                        settings,
                    )
                };
                self.obey(lane, next);
            }
        }
    }

    /// Carries out what the endgame wants.
    fn obey(&mut self, lane: usize, next: cauchy::Next) {
        let settings = &self.settings;
        let target = self.lanes[lane].target;
        match next {
            cauchy::Next::Vertex { radius, vertex } => {
                let to = self.circle[(vertex % VERTICES) as usize] * radius;
                let h = self.batch.h.lane(lane).min(radius);
                let h = if vertex == 1 { h.max(0.1 * radius) } else { h };
                self.batch.follow(lane, to, h);
                self.lanes[lane].phase = Phase::Turning;
            }
            cauchy::Next::Inward(radius) => {
                // A path that closed after one turn may simply be regular.
                if let Some(mean) = self.lanes[lane].cauchy.closed_after_one_turn() {
                    self.point.clear();
                    self.point.extend_from_slice(mean);
                    let report = self.refiner.refine(&mut self.point, target);
                    let moved = distance(&self.point, mean) / norm(mean);
                    if report.converged
                        && report.condition <= settings.singular_condition
                        && moved < 1e-6
                    {
                        return self.finish(
                            lane,
                            PathOutcome::Regular,
                            report,
                            Some(1),
                            Vec::new(),
                        );
                    }
                }
                let path = &self.lanes[lane];
                let (point, tangent) = path.cauchy.start();
                let t = Complex64::new(path.cauchy.radius(), 0.0);
                self.batch.write(lane, t, point, tangent);
                self.batch
                    .follow(lane, Complex64::new(radius, 0.0), 0.1 * t.re);
                self.lanes[lane].phase = Phase::Inward;
            }
            cauchy::Next::Settled(settled) => {
                self.point.clear();
                self.point.extend_from_slice(&settled.endpoint);
                let mut report = self.refiner.refine(&mut self.point, target);
                // A condition number that stops growing towards t = 0 belongs to a regular
                // endpoint; one that grows with the accuracy of the point to a singular one.
                let near = self.refiner.condition_at(
                    self.lanes[lane].cauchy.start().0,
                    Complex64::new(settled.radius, 0.0),
                    target,
                );
                let moved = distance(&self.point, &settled.endpoint) / norm(&settled.endpoint);
                let regular = settled.winding_number == 1
                    && report.converged
                    && report.condition <= 100.0 * near
                    && moved <= 1e3 * settled.accuracy.max(1e-12);
                let outcome = if regular {
                    PathOutcome::Regular
                } else {
                    self.point.clear();
                    self.point.extend_from_slice(&settled.endpoint);
                    report = self.refiner.look(&self.point, target);
                    report.accuracy = settled.accuracy;
                    PathOutcome::Singular
                };
                self.finish(
                    lane,
                    outcome,
                    report,
                    Some(settled.winding_number),
                    settled.infinity_turns,
                );
            }
            cauchy::Next::Diverging => {
                let path = &self.lanes[lane];
                let t = Complex64::new(path.cauchy.radius(), 0.0);
                let report = crate::refine::Report::unknown();
                self.record(lane, PathOutcome::Diverging, t, report, None, Vec::new());
                self.refill(lane);
            }
            cauchy::Next::Unsettled => {
                let t = self.batch.t(lane);
                self.give_up(lane, t, Failure::EndgameUnsettled);
            }
        }
    }

    /// Values of the homogenising coordinates at `self.point`, which is that of the one lane
    /// where there is one: then with all its digits. With `back`, at the point less its tangent.
    fn homogenizing(&self, back: bool) -> Vec<Complex64> {
        let homotopy = self.room.homotopy;
        if R::WIDTH == 1 {
            let here = self.batch.here();
            if !back {
                return homotopy.homogenizing(self.context, here);
            }
            let mut point = here.to_vec();
            for (x, tangent) in point.iter_mut().zip(self.batch.tangent_here()) {
                x.sub(tangent);
            }
            homotopy.homogenizing(self.context, &point)
        } else {
            let native = |z: Complex64| Complex { re: z.re, im: z.im };
            let both = self.point.iter().zip(&self.tangent);
            let point: Vec<Complex<f64>> = both
                .map(|(&x, &tangent)| native(if back { x - tangent } else { x }))
                .collect();
            homotopy.homogenizing((), &point)
        }
    }

    /// t x'/x of the homogenising coordinates, which are linear in the chart's.
    fn valuations(&self, t: Complex64, homogenizing: &[Complex64]) -> Vec<Complex64> {
        let back = self.homogenizing(true);
        let both = homogenizing.iter().zip(back);
        both.map(|(x, back)| t * (x - back) / x).collect()
    }

    /// A path has ended at `self.point`; the lane takes the next one.
    fn finish(
        &mut self,
        lane: usize,
        outcome: PathOutcome,
        report: crate::refine::Report,
        winding_number: Option<u32>,
        infinity_turns: Vec<i32>,
    ) {
        self.record(
            lane,
            outcome,
            Complex64::default(),
            report,
            winding_number,
            infinity_turns,
        );
        self.refill(lane);
    }

    /// In this room there is no going on: elsewhere there may be.
    fn give_up(&mut self, lane: usize, t: Complex64, why: Failure) {
        let door = if self.room.beyond {
            Door::Beyond
        } else if self.room.up
            && (why != Failure::EndgameUnsettled || self.room.bits < ENDGAME_BITS)
        {
            Door::Up
        } else {
            return self.fail_and_refill(lane, t, why);
        };
        // The turns around 0 are made again from the beginning, which lies on the real axis.
        match self.lanes[lane].first_turn.take() {
            Some((radius, point)) => {
                self.point = point;
                self.leave(lane, Complex64::new(radius, 0.0), door);
            }
            None => self.leave(lane, t, door),
        }
    }

    /// The path goes on in another room from `self.point`.
    fn leave(&mut self, lane: usize, t: Complex64, door: Door) {
        let mut path = self.lanes[lane].clone();
        path.cauchy.forget();
        if door == Door::Up {
            path.climbs += 1;
        }
        self.ended.departures.push(Departure {
            lane: path,
            t,
            point: self.room.homotopy.chart().homogeneous(&self.point),
            exchanges: self.batch.exchanges.lane(lane),
            door,
        });
        self.refill(lane);
    }

    fn fail_and_refill(&mut self, lane: usize, t: Complex64, why: Failure) {
        self.fail(lane, t, why);
        self.refill(lane);
    }

    fn fail(&mut self, lane: usize, t: Complex64, why: Failure) {
        let report = crate::refine::Report::unknown();
        self.record(lane, PathOutcome::Failed(why), t, report, None, Vec::new());
    }

    fn record(
        &mut self,
        lane: usize,
        outcome: PathOutcome,
        t: Complex64,
        report: crate::refine::Report,
        winding_number: Option<u32>,
        infinity_turns: Vec<i32>,
    ) {
        let path = &self.lanes[lane];
        let result = PathResult {
            origin: PathIndex(path.origin),
            attempt: self.stage.attempt(),
            outcome,
            endpoint: Coordinates::Double(self.room.homotopy.endpoint(&self.point)),
            t,
            residual: report.residual,
            condition: report.condition,
            accuracy: report.accuracy,
            winding_number,
            infinity_turns,
            precision_bits: path.highest_bits,
            counts: Counts {
                steps: path.steps,
                rejections: path.rejections,
                evaluations: path.evaluations,
                exchanges: self.batch.exchanges.lane(lane) as u32,
                turns: path.cauchy.total_turns(),
            },
            asked: None,
            certification: None,
            local_dimension: None,
        };
        self.ended.results.push((path.item, result));
    }
}
