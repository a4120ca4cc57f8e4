//! Lockstep: many paths at once, one in each lane, always in the same phase of a step.
//!
//! Predict; Newton; Newton and tangent from one factorisation; accept or shrink.
//! Every lane has its own t and step, a rejected lane only shrinks its step, and
//! a lane whose path has ended takes the next start point with a step of length
//! 0. So there is no divergence, and no lane ever looks at another: the bits of
//! a path are those of the same path alone (W = 1 is a width). What a tracking
//! context (a chart and an arithmetic) cannot do, another may: see `tracking_context`.

use super::acceptance::{AcceptanceRule, Accepted};
use super::attempt::Attempt;
use super::batch::Batch;
use super::corrector::{Corrected, Corrections, Corrector};
use super::digits::Digits;
use super::lane::{Lane, Phase, Step};
use super::limits::{effort, rounds};
use super::observer::{Observer, StepEvent};
use super::outcome::Failure;
use super::precise_samples::NewtonAtSamples;
use super::prediction::Prediction;
use super::settings::Settings;
use super::step_length::set_next_length;
use super::taylor_probe::{Series, TaylorProbe};
use super::tracking_context::{Ended, Queue, TrackingContext};
use crate::endgames::circle::VERTICES;
use crate::refine::Refiner;
use crate::stage::PreparedStage;
use cognate_numeric::interruption::is_interrupted;
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::precision::{DOUBLE, DOUBLE_DOUBLE};
use cognate_numeric::roots_of_unity::roots_of_unity;
use cognate_numeric::scalar::{Mask, Real};
use num_complex::Complex64;

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
    pub(super) batch: Batch<R>,
    pub(super) lanes: Vec<Lane>,
    corrector: Corrector<'a, R>,
    acceptance: AcceptanceRule,
    pub(super) refiner: Refiner<'a, R::Single>,
    /// Made when first wanted.
    pub(super) newton_at_samples: Option<Box<NewtonAtSamples<'a>>>,
    /// Probe that estimates the distances to singularities and to other paths, in robust mode.
    pub(super) probe: Option<TaylorProbe<'a, R::Single>>,
    /// Last Taylor series of each lane's path; in robust mode, before the endgame.
    pub(super) series: Vec<Option<Series>>,
    pub(super) circle: Vec<Complex64>,
    queue: Queue,
    pub(super) ended: Ended,
    observer: Option<&'a mut dyn Observer>,
    pub(super) point: Vec<Complex64>,
    pub(super) tangent: Vec<Complex64>,
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
            corrector: Corrector::new(homotopy, context, rounds(tracking.bits)),
            acceptance: AcceptanceRule::new(tracking.bits, &settings),
            batch: Batch::new(context, n, parameters, settings.predictor_tolerance),
            probe: (settings.reach > 0.0).then(|| TaylorProbe::new(homotopy, context)),
            settings,
            series: vec![None; R::WIDTH],
            lanes: vec![Lane::default(); R::WIDTH],
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
            if is_interrupted() {
                self.end_lanes();
            } else {
                self.step();
            }
        }
        self.ended
    }

    /// Ends the paths of all lanes, whose results nobody waits for.
    fn end_lanes(&mut self) {
        for lane in 0..R::WIDTH {
            if self.lanes[lane].phase != Phase::Idle {
                let t = self.batch.t(lane);
                self.fail_and_refill(lane, t, Failure::TooManySteps);
            }
        }
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

    /// Makes one step in all lanes.
    #[inline(always)]
    fn step(&mut self) {
        let attempt = Attempt::next(&self.batch);
        let predicted = dispatch_baseline(Predict(self, &attempt));
        let used = predicted.used;
        let corrected = self
            .corrector
            .correct(&mut self.batch, &attempt.t, predicted);
        let accepted = dispatch_baseline(Judge(self, &attempt, &corrected.corrections, &used));
        dispatch_baseline(Advance(self, &attempt, corrected, &accepted));
    }

    /// Decides which lanes' steps are accepted, and how long their next ones are.
    #[inline(always)]
    fn judge(
        &mut self,
        attempt: &Attempt<R>,
        corrections: &Corrections<R>,
        used: &[R::Mask; 3],
    ) -> Accepted<R> {
        let around = around_zero::<R>(&self.lanes);
        let batch = &mut self.batch;
        let accepted = self.acceptance.judge(batch, corrections, around);
        let noise = self.acceptance.on_the_way.settled;
        let (settings, moved) = (&self.settings, accepted.moved);
        set_next_length(batch, attempt, settings, noise, used, corrections, moved);
        accepted
    }

    /// Predicts the points of all lanes: by Hermite's extrapolation, or in robust mode by Taylor series.
    #[inline(always)]
    fn predict(&mut self, attempt: &Attempt<R>) -> Prediction<R> {
        let (context, fine) = (self.context, self.fine());
        let mut predicted = Prediction::extrapolated(context, &mut self.batch, attempt, fine);
        if self.probe.is_some() {
            predicted.follow_series(context, &self.batch, attempt, &self.series);
        }
        predicted
    }

    /// Takes the lanes whose steps are accepted to where these lead; then every lane decides for itself: go on, change
    /// precision, enter the endgame.
    #[inline(always)]
    fn advance(&mut self, attempt: &Attempt<R>, corrected: Corrected<R>, accepted: &Accepted<R>) {
        let Corrected {
            mut x,
            mut tangent,
            corrections,
        } = corrected;
        let boundary = self.settings.endgame_boundary;
        let entering = attempt.enters(&self.batch, boundary).and(accepted.moved);
        self.batch.stay(&mut x, &mut tangent, accepted.all.not());
        self.batch.advance(x, tangent, &attempt.t, accepted.moved);

        let (rounds, effort) = (self.corrector.rounds(), effort(self.tracking.bits));
        for lane in 0..R::WIDTH {
            if self.lanes[lane].phase == Phase::Idle {
                continue;
            }
            let step = self.step_of(lane, attempt, &corrections, accepted);
            let path = &mut self.lanes[lane];
            path.count(&step, rounds, effort, &self.acceptance.around_zero);
            if entering.lane(lane) {
                let (keys, chart) = (self.stage.boundary(), self.tracking.homotopy.chart());
                let errors = [step.predictor_error, step.correction];
                path.boundary = keys.key(&self.batch, chart, (lane, boundary), errors);
            }
            self.observe(lane, attempt, &step);
            self.after_step(lane, &step);
        }
    }

    /// Extracts the result of the step in one lane.
    #[inline(always)]
    fn step_of(
        &self,
        lane: usize,
        attempt: &Attempt<R>,
        corrections: &Corrections<R>,
        accepted: &Accepted<R>,
    ) -> Step {
        let [first, second, third] = &corrections.relative;
        let last = match self.fine() {
            true => [second, third],
            false => [first, second],
        };
        let accepted = accepted.all.lane(lane);
        Step {
            accepted,
            arrived: accepted && attempt.reaches.lane(lane),
            refines: attempt.refines.lane(lane),
            predictor_error: first.lane(lane),
            correction: second.lane(lane),
            last: last.map(|correction| correction.lane(lane)),
            size: corrections.size.lane(lane),
        }
    }

    /// Tells the observer, if there is one, of a step in one lane.
    #[inline(always)]
    fn observe(&mut self, lane: usize, attempt: &Attempt<R>, step: &Step) {
        let Some(observer) = &mut self.observer else {
            return;
        };
        let path = &self.lanes[lane];
        let point: Vec<_> = self.batch.here().iter().map(|z| z.lane(lane)).collect();
        let event = StepEvent {
            phase: path.phase.name(),
            t: attempt.t.lane(lane),
            step: attempt.length.lane(lane),
            accepted: step.accepted,
            predictor_error: step.predictor_error,
            correction: step.correction,
            precision_bits: self.tracking.bits,
            point: self.tracking.homotopy.endpoint(&point),
        };
        observer.step(path.origin, event);
    }

    /// Whether points have more digits than doubles.
    pub(super) fn fine(&self) -> bool {
        self.tracking.bits > DOUBLE
    }
}

// The phases of a step are functions of their own: passes over loops take the optimiser time that grows with the square of
// a function's size, and one function of all phases took it four times as long (`tests/benches/build.md`).

struct Predict<'s, 'a, R: Real>(&'s mut Lockstep<'a, R>, &'s Attempt<R>);

impl<R: Real> Job for Predict<'_, '_, R> {
    type Output = Prediction<R>;
    #[inline(always)]
    fn run(self) -> Prediction<R> {
        self.0.predict(self.1)
    }
}

struct Judge<'s, 'a, R: Real>(
    &'s mut Lockstep<'a, R>,
    &'s Attempt<R>,
    &'s Corrections<R>,
    &'s [R::Mask; 3],
);

impl<R: Real> Job for Judge<'_, '_, R> {
    type Output = Accepted<R>;
    #[inline(always)]
    fn run(self) -> Accepted<R> {
        self.0.judge(self.1, self.2, self.3)
    }
}

struct Advance<'s, 'a, R: Real>(
    &'s mut Lockstep<'a, R>,
    &'s Attempt<R>,
    Corrected<R>,
    &'s Accepted<R>,
);

impl<R: Real> Job for Advance<'_, '_, R> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.0.advance(self.1, self.2, self.3);
    }
}
