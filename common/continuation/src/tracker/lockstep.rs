//! Lockstep: many paths at once, one in each lane, always in the same phase of a step.
//!
//! Predict; Newton; Newton and tangent from one factorisation; accept or shrink.
//! Every lane has its own t and step, a rejected lane only shrinks its step, and
//! a lane whose path has ended takes the next start point with a step of length
//! 0. So there is no divergence, and no lane ever looks at another: the bits of
//! a path are those of the same path alone (W = 1 is a width). What a tracking
//! context (a chart and an arithmetic) cannot do, another may: see `tracking_context`.

use super::batch::Batch;
use super::digits::Digits;
use super::lane::{Lane, Phase};
use super::limits::{Limits, MOST_ROUNDS, rounds};
use super::observer::{Observer, StepEvent};
use super::outcome::{Failure, PathOutcome};
use super::precise_samples::NewtonAtSamples;
use super::settings::Settings;
use super::taylor_probe::{Estimate, Series, TaylorProbe};
use super::tracking_context::{Ended, HandedOffPath, Handoff, Queue, TrackingContext};
use crate::chart::{LEAST_NORM, norm};
use crate::endgames::cauchy::distance;
use crate::endgames::circle::VERTICES;
use crate::predictor::hermite::{POINTS, weights};
use crate::refine::Refiner;
use crate::stage::PreparedStage;
use crate::step_control::{largest_error, next_step};
use cognate_machine_code::Evaluator;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::precision::{DOUBLE, DOUBLE_DOUBLE};
use cognate_numeric::roots_of_unity::roots_of_unity;
use cognate_numeric::scalar::jet::TERMS;
use cognate_numeric::scalar::{Complex, Mask, Real};
use cognate_systems::evaluation::Evaluate;
use num_complex::Complex64;

/// A step is accepted when the second Newton correction is at most this part of the first.
const CONTRACTION: f64 = 0.1;
/// And on the higher rungs, where other paths are near, the third at most this part of the second:
/// while a first correction is made up of what every path has, the later ones show where between
/// two paths the prediction fell.
const CONVERGENCE: f64 = 0.01;
/// Corrections that shrink twice by a factor between these are those of Newton's method at a multiple point (a half at a
/// double one): the prediction fell nearer to it than to the path.
const LINEAR: (f64, f64) = (0.3, 0.9);
/// Largest first correction at which a start point is believed.
const START_ERROR: f64 = 1e-3;
/// Farthest that the last Newton steps may move a regular endpoint.
const ARRIVED: f64 = 1e-7;

/// Smallest step of doubles around 0, or towards it, as a part of the distance from it; with more
/// digits, `min_step`.
const LEAST_ARC: f64 = 1e-9;
/// Part of the way left below which a step speaks of a singularity beside the path: towards one
/// at its end, steps are a third of the way or so.
const PASSING: f64 = 0.1;
/// Part of the endgame's first radius at which the turns begin in any case.
const PASSED: f64 = 1e-3;
/// A path whose coordinates exceed this goes on in projective patches.
const FAR: f64 = 1e4;
/// With such a condition number a path may go down a rung.
const TAME: f64 = 1e10;
/// So many rejections since the last accepted step that only noise explains send a path to the
/// next rung.
const STARVED: u32 = 2;
/// In robust mode a first Newton correction is at most this part of the distance to another path.
const APART: f64 = 0.05;
/// An endgame that does not settle is not tried again above this many bits: what then remains
/// is not for want of digits.
pub(super) const ENDGAME_BITS: u32 = 212;
/// This part of all steps that a path may take is enough for its turns in doubles, and in robust mode for its way.
const LABOUR: u32 = 8;
/// A step in multiple precision counts as so many in doubles for each two doubles' digits.
const MULTIPLE_PRECISION: u32 = 4;
/// After so many steps in doubles,
const MANY_STEPS: u32 = 500;
/// those shorter than this part of the way left are too short: the rest would take ten times as many.
const SHORT: f64 = 1e-4;

/// The point from which a path is tracked in a context.
enum Entry {
    Start(Vec<Complex64>),
    HandedOff(Vec<Digits>),
}

/// All lanes of one tracking context.
pub(super) struct Lockstep<'a, R: Real> {
    pub(super) stage: &'a PreparedStage,
    pub(super) tracking: TrackingContext<'a>,
    pub(super) context: R::Context,
    pub(super) settings: Settings,
    pub(super) on_the_way: Limits,
    pub(super) around_zero: Limits,
    pub(super) batch: Batch<R>,
    pub(super) lanes: Vec<Lane>,
    pub(super) scratch: <Evaluator as Evaluate<R>>::Scratch,
    pub(super) matrix: Matrix<R>,
    pub(super) p: Vec<Complex<R>>,
    pub(super) dp: Vec<Complex<R>>,
    pub(super) refiner: Refiner<'a, R::Single>,
    /// Made when first wanted.
    pub(super) newton_at_samples: Option<Box<dyn NewtonAtSamples + 'a>>,
    /// In robust mode.
    pub(super) probe: Option<TaylorProbe<'a, R::Single>>,
    /// Where each lane's path goes on, as its last Taylor series showed; in robust mode, on the way.
    pub(super) series: Vec<Option<Series>>,
    pub(super) circle: Vec<Complex64>,
    pub(super) queue: Queue,
    pub(super) ended: Ended,
    pub(super) observer: Option<&'a mut dyn Observer>,
    pub(super) point: Vec<Complex64>,
    pub(super) tangent: Vec<Complex64>,
}

/// What one step showed in one lane.
pub(super) struct Step {
    pub(super) accepted: bool,
    pub(super) arrived: bool,
    /// First and second Newton correction, relative.
    pub(super) predictor_error: f64,
    pub(super) correction: f64,
    /// The last two.
    pub(super) last: [f64; 2],
    /// Largest coordinate of the point that was tried.
    pub(super) size: f64,
}

impl Step {
    /// What one more Newton correction would be, by quadratic convergence: with c_1 and c_2 the last
    /// two, c_3 = c_2 (c_2 / c_1)^2.
    pub(super) fn left(&self) -> f64 {
        let [before, last] = self.last;
        if last == 0.0 {
            return 0.0;
        }
        let ratio = last / before;
        last * ratio * ratio
    }
}

/// The lanes whose paths are in the endgame.
#[inline(always)]
fn around_zero<R: Real>(lanes: &[Lane]) -> R::Mask {
    let mut around = R::Mask::splat(false);
    for (lane, path) in lanes.iter().enumerate() {
        around.set_lane(lane, path.phase.is_around_zero());
    }
    around
}

/// `sum += weight * value`. Within a function of its own, since a closure that is called in several places would
/// not be compiled for the instruction set of its caller.
#[inline(always)]
fn accumulate<R: Real>(
    context: R::Context,
    sum: &mut Complex<R>,
    weight: &Complex<R::Control>,
    value: &Complex<R>,
) {
    sum.mul_add(&Complex::from_control(context, weight), value);
}

impl<'a, R: Real> Lockstep<'a, R> {
    #[inline(always)]
    pub(super) fn new(
        tracking: TrackingContext<'a>,
        context: R::Context,
        queue: Queue,
        observer: Option<&'a mut dyn Observer>,
    ) -> Self {
        let homotopy = tracking.homotopy;
        let n = homotopy.dimension();
        let parameters = homotopy.parameter_count();
        let settings = tracking.settings();
        assert!(
            tracking.bits <= DOUBLE_DOUBLE || R::WIDTH == 1,
            "numbers of MPFR have one lane"
        );
        Self {
            stage: tracking.stage,
            context,
            on_the_way: Limits::on_the_way(tracking.bits, &settings),
            around_zero: Limits::around_zero(tracking.bits, &settings),
            batch: Batch::new(context, n, parameters, settings.predictor_tolerance),
            probe: (settings.reach > 0.0).then(|| TaylorProbe::new(homotopy, context)),
            settings,
            series: vec![None; R::WIDTH],
            lanes: vec![Lane::default(); R::WIDTH],
            scratch: Evaluate::<R>::scratch(homotopy.evaluator(), context),
            matrix: Matrix::zeros(context, n, n + 2),
            p: vec![Complex::zero(context); parameters],
            dp: vec![Complex::zero(context); parameters],
            refiner: Refiner::new(homotopy, context),
            newton_at_samples: None,
            circle: roots_of_unity(VERTICES),
            tracking,
            queue,
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
    pub(super) fn refill(&mut self, lane: usize) {
        let homotopy = self.tracking.homotopy;
        loop {
            let path = &mut self.lanes[lane];
            let (t, exchanges, entry) = if let Some(item) = self.queue.items.next() {
                let (origin, target) = self.stage.item(item);
                path.begin(item, origin, target);
                let entry = self.stage.start_point(origin).map(Entry::Start);
                (Complex64::new(1.0, 0.0), 0.0, entry)
            } else if let Some(handed_off) = self.queue.handed_off.pop_front() {
                *path = handed_off.lane;
                let entry = handed_off.point.map(Entry::HandedOff);
                (handed_off.t, handed_off.exchanges, entry)
            } else {
                path.phase = Phase::Idle;
                return;
            };
            path.arrive(self.tracking.bits);
            self.series[lane] = None;
            let target = path.target;
            self.batch.exchanges.set_lane(lane, exchanges);
            let (a, b) = homotopy.ends(target);
            for (slot, value) in self.batch.a.iter_mut().zip(a) {
                slot.set_lane(lane, value);
            }
            for (slot, value) in self.batch.b.iter_mut().zip(b) {
                slot.set_lane(lane, value);
            }
            if let Some(entry) = entry {
                match entry {
                    Entry::Start(point) => self.batch.write(lane, t, &point),
                    Entry::HandedOff(point) => {
                        self.batch.write_digits(self.context, lane, t, &point);
                    }
                }
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
        let n = self.tracking.homotopy.dimension();
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
        let mut counts: [R::Mask; POINTS - 1] = std::array::from_fn(|k| batch.known[slots[k + 1]]);
        let moving = batch.refine.not();
        let w = weights(
            &std::array::from_fn(|age| batch.t[slots[age]].clone()),
            &t,
            &std::array::from_fn(|k| counts[k].and(moving)),
        );
        let next = batch.slot(POINTS);
        let fine = self.tracking.bits > DOUBLE;
        let mut candidate = std::mem::take(&mut batch.x[next]);
        let mut candidate_tangent = std::mem::take(&mut batch.tangent[next]);
        let context = self.context;
        for i in 0..n {
            let mut sum = Complex::zero(context);
            let here = &batch.x[newest][i];
            for (age, &slot) in slots.iter().enumerate().rev() {
                accumulate(context, &mut sum, &w.tangent[age], &batch.tangent[slot][i]);
                // Weights are doubles: their rounding counts as a part of how far the points are apart,
                // not of how large they are, where there are more digits.
                if !fine {
                    accumulate(context, &mut sum, &w.point[age], &batch.x[slot][i]);
                } else if age > 0 {
                    candidate[i].set(&batch.x[slot][i]);
                    candidate[i].sub(here);
                    accumulate(context, &mut sum, &w.point[age], &candidate[i]);
                }
            }
            if fine {
                sum.add(here);
            }
            candidate[i].set(&sum);
        }
        if self.probe.is_some() {
            for (lane, series) in self.series.iter().enumerate() {
                if let Some(series) = series.as_ref().filter(|_| moving.lane(lane)) {
                    batch.extrapolate(self.context, lane, series, tried.lane(lane), &mut candidate);
                    // Its error is of order 5: between those of Hermite's with two points and three.
                    for (k, known) in counts.iter_mut().enumerate() {
                        known.set_lane(lane, k == 0);
                    }
                }
            }
        }

        // Newton; then Newton and tangent from one factorisation.
        let around = around_zero::<R>(&self.lanes);
        let homotopy = self.tracking.homotopy;
        homotopy.path().at(
            self.context,
            &t,
            &batch.a,
            &batch.b,
            &mut self.p,
            &mut self.dp,
        );
        let rounds = rounds(self.tracking.bits);
        let mut corrections: [R::Control; MOST_ROUNDS] = std::array::from_fn(|_| control(0.0));
        let mut size = control(0.0);
        for (round, correction) in corrections.iter_mut().enumerate().take(rounds) {
            if round + 1 < rounds {
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
        let [first, second, third] = &corrections;

        // Accept: the correction contracts, and what is left of it is below the tolerance.
        let limit = batch.limit.clone();
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
        // Which correction decides, and how small it must be, is another thing on the way than around 0;
        // in doubles both are the same.
        let (way, zero) = (self.on_the_way, self.around_zero);
        let of_phase = |way: f64, zero: f64| {
            let mut value = control(way);
            value.select(around, &control(zero));
            value
        };
        let noise = of_phase(way.settled, zero.settled);
        let mut last = if way.decisive == MOST_ROUNDS {
            third
        } else {
            second
        }
        .clone();
        let second_decides = R::Mask::splat(zero.decisive < MOST_ROUNDS).and(around);
        last.select(second_decides, second);
        let mut quadratically = control(CONVERGENCE);
        quadratically.mul(second);
        let quadratically = third.less_equal(&quadratically).or(second_decides);
        let quadratically = quadratically.or(R::Mask::splat(way.decisive < MOST_ROUNDS));
        let converging = converging.and(quadratically);
        let mut settled = last.less_equal(&noise).or(converging);
        if fine {
            settled = settled.and(linearly(first, second, third).not());
        }
        let mut refined = last.less_equal(&of_phase(way.refined, zero.refined));
        if fine {
            // A start point has the digits of doubles, however many there are here.
            refined = refined.or(converging.and(second_decides.not()));
        }
        let moved = first
            .less_equal(&limit)
            .and(settled)
            .and(batch.refine.not());
        let refined = refined
            .and(first.less_equal(&control(START_ERROR)))
            .and(batch.refine);
        let accepted = moved.or(refined);
        let least = control(way.settled);
        let largest = largest_error(first, second, &limit, &tolerance, &least);
        let wanted = next_step(&batch.h, first, &largest, &counts, moved, batch.may_grow);
        // A step that only reached its target says little about longer ones: keep the wish.
        let mut h = wanted;
        h.min(&control(settings.max_step));
        h.select(batch.refine, &batch.h);
        batch.h.set(&h);
        let refining = batch.refine;
        batch.may_grow = moved.or(refining);
        let boundary = control(settings.endgame_boundary);
        let before = &batch.t[newest].re;
        let entering = moved.and(t.re.less_equal(&boundary));
        let entering = entering.and(before.less_equal(&boundary).not());

        let stays = accepted.not();
        if stays.any() {
            for i in 0..n {
                candidate[i].select(stays, &batch.x[newest][i]);
                candidate_tangent[i].select(stays, &batch.tangent[newest][i]);
            }
        }
        batch.advance(candidate, candidate_tangent, &t, moved);

        // Decisions that are made lane by lane: accept, change precision, enter the endgame.
        for lane in 0..R::WIDTH {
            if self.lanes[lane].phase == Phase::Idle {
                continue;
            }
            let path = &mut self.lanes[lane];
            path.evaluations += rounds as u32;
            path.effort += effort(self.tracking.bits);
            let step = Step {
                accepted: accepted.lane(lane),
                arrived: accepted.lane(lane) && reaches.lane(lane),
                predictor_error: first.lane(lane),
                correction: second.lane(lane),
                last: if fine {
                    [second, third]
                } else {
                    [first, second]
                }
                .map(|c| c.lane(lane)),
                size: size.lane(lane),
            };
            if refining.lane(lane) {
            } else if step.accepted {
                path.steps += 1;
                path.steps_here += 1;
                (path.starved, path.last_rejected) = (0, f64::INFINITY);
                if entering.lane(lane) {
                    let (keys, chart) = (self.stage.boundary(), homotopy.chart());
                    let at = (lane, self.settings.endgame_boundary);
                    let corrections = [step.predictor_error, step.correction];
                    path.boundary = keys.key(&self.batch, chart, at, corrections);
                }
            } else {
                path.rejections += 1;
                // A correction that neither Newton's method nor a shorter step makes smaller is
                // noise.
                let stuck = step.predictor_error <= zero.noise
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
                    precision_bits: self.tracking.bits,
                    point: homotopy.endpoint(&point),
                };
                observer.step(path.origin, event);
            }
            self.after_step(lane, &step);
        }
    }

    /// Decides how one path goes on after a step.
    fn after_step(&mut self, lane: usize, step: &Step) {
        let settings = &self.settings;
        let phase = self.lanes[lane].phase;
        let t = self.batch.t(lane);
        let h = self.batch.h.lane(lane);
        if self.lanes[lane].effort > u64::from(settings.max_steps) {
            return self.fail_and_refill(lane, t, Failure::TooManySteps);
        }
        if self.labours(lane) {
            return self.give_up(lane, t, Failure::StepTooSmall);
        }
        match phase {
            Phase::Idle => {}
            Phase::Starting => {
                if !step.accepted {
                    if self.lanes[lane].steps == 0 {
                        return self.give_up(lane, t, Failure::InvalidStartPoint);
                    }
                    return match self.begins_again(lane) {
                        true => (),
                        false => self.give_up(lane, t, Failure::StepTooSmall),
                    };
                }
                self.batch
                    .read_here(lane, &mut self.point, &mut self.tangent);
                // With the tangent alone the error is about (h |x'|/|x|)^2 / 2.
                let speed = norm(&self.tangent) / norm(&self.point);
                let mut reach = settings.predictor_tolerance;
                Real::sqrt(&mut reach);
                let h = (0.5 * reach / speed).min(settings.max_step).max(1e-6);
                self.batch.follow(lane, Complex64::default(), h);
                self.lanes[lane].phase = Phase::Approaching;
                self.comes_too_near(lane, None);
            }
            Phase::Approaching => {
                let too_near =
                    step.accepted && !step.arrived && self.comes_too_near(lane, Some(step));
                let settings = &self.settings;
                let (h, t) = (self.batch.h.lane(lane), self.batch.t(lane));
                let too_small = h < settings.min_step * t.re.max(settings.endgame_radius);
                if too_near && !too_small {
                    return;
                }
                // Steps far shorter than the way that is left speak of a singularity beside the
                // path, not at its end: it is passed by before the turns begin.
                let radius = settings.endgame_radius;
                let passing = h < PASSING * t.re && t.re > PASSED * radius;
                let reaches = step.accepted && h >= t.re;
                // Where no endgame comes, a regular end may still be a few steps away.
                let near = match settings.max_endgame_bits < self.tracking.bits {
                    true => t.re <= PASSED * radius,
                    false => t.re <= radius && !passing,
                };
                let at_end = !reaches && (near || self.in_endgame_zone(lane, step, t));
                let settings = &self.settings;
                let far = self.tracking.projective && step.size > FAR;
                if step.arrived {
                    self.series[lane] = None;
                    self.lanes[lane].phase = Phase::Arriving;
                    self.batch.refine(lane);
                } else if settings.max_endgame_bits < self.tracking.bits
                    && (at_end || far && t.re <= settings.endgame_boundary)
                {
                    self.put_aside(lane, t);
                } else if far || self.tracking.projective && at_end {
                    self.hand_off(lane, t, Handoff::Projective);
                } else if step.accepted
                    && self.tracking.down
                    && self.lanes[lane].may_go_down()
                    && t.re > 10.0 * settings.endgame_radius
                {
                    self.batch
                        .read_here(lane, &mut self.point, &mut self.tangent);
                    let target = self.lanes[lane].target;
                    if self.refiner.condition_at(&self.point, t, target) <= TAME {
                        self.hand_off(lane, t, Handoff::Down);
                    } else {
                        self.lanes[lane].steps_here = 0;
                    }
                } else if at_end {
                    self.series[lane] = None;
                    self.lanes[lane].phase = Phase::Settling;
                    self.batch.refine(lane);
                } else if self.lanes[lane].starved >= STARVED || too_small {
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
                let before = self.batch.step_back(lane);
                if self.settings.max_endgame_bits < self.tracking.bits {
                    return self.put_aside(lane, before);
                }
                if self.tracking.projective {
                    return self.hand_off(lane, before, Handoff::Projective);
                }
                if before.re > settings.endgame_boundary {
                    let boundary = Complex64::new(settings.endgame_boundary, 0.0);
                    self.batch.follow(lane, boundary, 0.1 * before.re);
                    self.lanes[lane].phase = Phase::Inward;
                } else {
                    self.batch.refine(lane);
                    self.lanes[lane].phase = Phase::Settling;
                }
            }
            Phase::Turning if step.arrived && self.is_sample(lane, step) => {
                let left = step.left().max(self.lanes[lane].cauchy.noise());
                self.sample(lane, t, left);
            }
            Phase::Inward | Phase::Turning => {
                if step.arrived {
                    self.lanes[lane].phase = match phase {
                        Phase::Inward => Phase::Settling,
                        _ => Phase::Sampling,
                    };
                    self.batch.refine(lane);
                } else if self.lanes[lane].starved >= STARVED
                    || h < self.least_arc() * t.norm_sqr().sqrt()
                {
                    self.give_up(lane, t, Failure::StepTooSmall);
                }
            }
            Phase::Settling | Phase::Sampling => {
                if !step.accepted {
                    return self.give_up(lane, t, Failure::EndgameUnsettled);
                }
                match phase {
                    Phase::Settling => self.begin_turns(lane, t, step),
                    _ => self.sample(lane, t, step.last[1]),
                }
            }
        }
    }

    /// In robust mode the next step of a path stays away from singularities and from other paths; one
    /// that has come too near to another is taken back.
    fn comes_too_near(&mut self, lane: usize, step: Option<&Step>) -> bool {
        let Some(probe) = &mut self.probe else {
            return false;
        };
        let (context, t) = (self.context, self.batch.t(lane));
        let digits = self.batch.digits(lane);
        let point: Vec<_> = digits
            .iter()
            .map(|z| z.value::<R::Single>(context))
            .collect();
        let path = &mut self.lanes[lane];
        path.evaluations += TERMS as u32;
        path.effort += effort(self.tracking.bits);
        let Estimate {
            radius,
            separation,
            series,
        } = probe.estimate(&point, t, path.target);
        let limit = APART * separation;
        // How far apart paths are is known where they were before: they may have come closer.
        if step.is_some_and(|step| step.predictor_error > limit) {
            path.rejections += 1;
            let before = self.batch.step_back(lane);
            let half = 0.5 * (before - t).norm_sqr().sqrt();
            self.batch.restrict(lane, half, limit);
            self.batch.may_grow.set_lane(lane, false);
            return true;
        }
        self.series[lane] = Some(series);
        self.batch
            .restrict(lane, self.settings.reach * radius, limit);
        false
    }

    /// Smallest step around 0, or towards it, as a part of the distance from it.
    fn least_arc(&self) -> f64 {
        if self.fine() {
            self.settings.min_step
        } else {
            LEAST_ARC
        }
    }

    /// Whether points have more digits than doubles.
    pub(super) fn fine(&self) -> bool {
        self.tracking.bits > DOUBLE
    }

    /// A path that cannot go on in this tracking context is handed to another one, or fails.
    pub(super) fn give_up(&mut self, lane: usize, t: Complex64, why: Failure) {
        let most = self.settings.max_endgame_bits;
        let more =
            most < self.tracking.bits || most == self.tracking.bits && !self.tracking.projective;
        // Most paths that need very many digits on their way are not those of solutions that are missing.
        let climbs = most < u32::MAX && self.tracking.bits >= DOUBLE_DOUBLE;
        if climbs || more && t.re <= self.settings.endgame_boundary {
            return self.put_aside(lane, t);
        }
        let helps = match self.probe {
            // Steps that looking around makes too short do not become longer with still more digits.
            Some(_) => self.tracking.bits < DOUBLE_DOUBLE,
            None => self.tracking.bits < ENDGAME_BITS || why != Failure::EndgameUnsettled,
        };
        let handoff = if self.tracking.projective {
            Handoff::Projective
        } else if self.tracking.up && helps {
            Handoff::Up
        } else {
            return self.fail_and_refill(lane, t, why);
        };
        // The turns around 0 are made again from their beginning, which lies on the real axis: where
        // steps became too short, those at this radius; else all, at radii where there is less noise.
        let path = &mut self.lanes[lane];
        let (first, last) = (path.first_turn.take(), path.last_turn.take());
        let begin = match (handoff, why) {
            (Handoff::Up, Failure::StepTooSmall) => last.or(first),
            _ => first,
        };
        match begin {
            Some((radius, point)) => {
                path.cauchy.forget();
                self.hand_off_from(lane, Complex64::new(radius, 0.0), point, handoff);
            }
            None => self.hand_off(lane, t, handoff),
        }
    }

    /// Whether a path takes very many steps in doubles around 0, or past the endgame's boundary, or so short
    /// ones before it that it will not get there: it is their noise that it follows. In robust mode very many steps
    /// anywhere say so.
    fn labours(&self, lane: usize) -> bool {
        if self.tracking.bits > DOUBLE || !(self.tracking.up || self.tracking.projective) {
            return false;
        }
        let path = &self.lanes[lane];
        let many = path.effort > u64::from(self.settings.max_steps / LABOUR);
        match path.phase {
            Phase::Turning | Phase::Inward => many,
            Phase::Approaching => {
                let (t, h) = (self.batch.t(lane).re, self.batch.h.lane(lane));
                let too_short = path.steps_here >= MANY_STEPS && h < SHORT * t;
                let robust = self.probe.is_some();
                too_short || many && (robust || t <= self.settings.endgame_boundary)
            }
            _ => false,
        }
    }

    /// A path that came up a rung from where fewer digits had lost it follows its whole way on
    /// this one.
    fn begins_again(&mut self, lane: usize) -> bool {
        let (bits, path) = (self.tracking.bits, &self.lanes[lane]);
        if bits == DOUBLE || path.began_with >= bits {
            return false;
        }
        let start = self.stage.start_point(path.origin);
        let Some(start) = start.and_then(|start| self.projective_point(start)) else {
            return false;
        };
        self.lanes[lane].begin_again(bits);
        let beginning = Complex64::new(1.0, 0.0);
        self.batch.write(lane, beginning, &start);
        self.batch.follow(lane, beginning, 0.0);
        self.batch.refine(lane);
        true
    }

    /// A point of the chart where paths begin in the projective patch, if there is one; `None` where
    /// that misses it.
    fn projective_point(&self, point: Vec<Complex64>) -> Option<Vec<Complex64>> {
        match self.stage.projective_homotopy() {
            Some(projective) => {
                let coordinates = self.stage.homotopy().chart().homogeneous(&point);
                projective.chart().point(&coordinates)
            }
            None => Some(point),
        }
    }

    /// The path goes on in another tracking context from where it is.
    fn hand_off(&mut self, lane: usize, t: Complex64, handoff: Handoff) {
        let point = self.batch.digits(lane);
        self.lanes[lane].cauchy.forget();
        self.hand_off_from(lane, t, point, handoff);
    }

    /// The path goes on in another tracking context from this point of this one's chart.
    pub(super) fn hand_off_from(
        &mut self,
        lane: usize,
        t: Complex64,
        point: Vec<Digits>,
        handoff: Handoff,
    ) {
        let point = match handoff {
            Handoff::Projective => {
                let rounded: Vec<Complex64> = point.iter().map(Digits::rounded).collect();
                let there = self.projective_point(rounded);
                there.map(|point| point.into_iter().map(Digits::from).collect())
            }
            Handoff::Up | Handoff::Down => Some(point),
        };
        let mut path = self.lanes[lane].clone();
        if handoff == Handoff::Up {
            path.climbs += 1;
        }
        self.ended.handed_off.push(HandedOffPath {
            lane: path,
            t,
            point,
            exchanges: self.batch.exchanges.lane(lane),
            handoff,
        });
        self.refill(lane);
    }
}

/// A step of this precision, as so many in doubles: numbers of more digits than two doubles are tracked one at a time,
/// by functions of a library.
fn effort(bits: u32) -> u64 {
    match bits {
        ..=DOUBLE_DOUBLE => 1,
        _ => u64::from(MULTIPLE_PRECISION * (bits / DOUBLE_DOUBLE)),
    }
}

/// `a b`. A function, since a closure under `dispatch` cannot be inlined for certain.
#[inline(always)]
fn times<C: Real<Context = (), Control = C>>(a: &C, b: f64) -> C {
    let mut product = C::from_f64((), b);
    product.mul(a);
    product
}

/// In which lanes three corrections converge linearly.
#[inline(always)]
fn linearly<C: Real<Context = (), Control = C>>(first: &C, second: &C, third: &C) -> C::Mask {
    let slowly = times(first, LINEAR.0).less_equal(second);
    let slowly = slowly.and(times(second, LINEAR.0).less_equal(third));
    let shrinks = second.less_equal(&times(first, LINEAR.1));
    slowly
        .and(shrinks)
        .and(third.less_equal(&times(second, LINEAR.1)))
}
