//! Decisions: how one lane's path goes on after a step, phase by phase.

use super::lane::{Phase, Step};
use super::limits::effort;
use super::lockstep::Lockstep;
use super::outcome::{Failure, PathOutcome};
use super::taylor_probe::Estimate;
use super::tracking_context::Handoff;
use crate::chart::norm;
use crate::endgames::cauchy::distance;
use cognate_numeric::precision::DOUBLE;
use cognate_numeric::scalar::jet::TERMS;
use cognate_numeric::scalar::{Mask, Real};
use num_complex::Complex64;

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
/// Largest condition number at which a path may go down a rung.
const TAME: f64 = 1e10;
/// Rejections since the last accepted step that only noise explains; a path with this many goes to the next rung.
const STARVED: u32 = 2;
/// In robust mode a first Newton correction is at most this part of the distance to another path.
const APART: f64 = 0.05;
/// Divisor of the most steps of a path: a path in doubles with more effort than the quotient follows noise, in its
/// turns, past the endgame's boundary, and in robust mode anywhere.
const LABOUR: u32 = 8;
/// Steps in doubles before [`SHORT`] applies.
const MANY_STEPS: u32 = 500;
/// Steps shorter than this part of the way left are too short: the rest would take ten times [`MANY_STEPS`].
const SHORT: f64 = 1e-4;

impl<R: Real> Lockstep<'_, R> {
    /// Decides how one path goes on after a step.
    pub(super) fn after_step(&mut self, lane: usize, step: &Step) {
        let path = &self.lanes[lane];
        let (phase, t) = (path.phase, self.batch.t(lane));
        if path.effort > u64::from(self.settings.max_steps) {
            return self.fail_and_refill(lane, t, Failure::TooManySteps);
        }
        if self.labours(lane) {
            return self.give_up(lane, t, Failure::StepTooSmall);
        }
        match phase {
            Phase::Idle => {}
            Phase::Starting => self.after_start(lane, t, step),
            Phase::Approaching => self.after_approach(lane, step),
            Phase::Arriving => self.after_arrival(lane, step),
            Phase::Turning if step.arrived && self.is_sample(lane, step) => {
                let left = step.left().max(self.lanes[lane].cauchy.noise());
                self.sample(lane, t, left);
            }
            Phase::Inward => self.after_arc(lane, t, step, Phase::Settling),
            Phase::Turning => self.after_arc(lane, t, step, Phase::Sampling),
            Phase::Settling | Phase::Sampling if !step.accepted => {
                self.give_up(lane, t, Failure::EndgameUnsettled);
            }
            Phase::Settling => self.begin_turns(lane, t, step),
            Phase::Sampling => self.sample(lane, t, step.last[1]),
        }
    }

    /// The start point is refined, or is none.
    fn after_start(&mut self, lane: usize, t: Complex64, step: &Step) {
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
        let mut reach = self.settings.predictor_tolerance;
        Real::sqrt(&mut reach);
        let h = (0.5 * reach / speed).min(self.settings.max_step).max(1e-6);
        self.batch.follow(lane, Complex64::default(), h);
        self.lanes[lane].phase = Phase::Approaching;
        self.comes_too_near(lane, None);
    }

    /// The path goes on towards t = 0, arrives there, enters the endgame, or leaves this tracking context.
    fn after_approach(&mut self, lane: usize, step: &Step) {
        let too_near = step.accepted && !step.arrived && self.comes_too_near(lane, Some(step));
        let settings = &self.settings;
        let (h, t) = (self.batch.h.lane(lane), self.batch.t(lane));
        let radius = settings.endgame_radius;
        let too_small = h < settings.min_step * t.re.max(radius);
        if too_near && !too_small {
            return;
        }
        // Steps far shorter than the way that is left speak of a singularity beside the
        // path, not at its end: it is passed by before the turns begin.
        let passing = h < PASSING * t.re && t.re > PASSED * radius;
        let reaches = step.accepted && h >= t.re;
        let without_endgame = settings.max_endgame_bits < self.tracking.bits;
        // Where no endgame comes, a regular end may still be a few steps away.
        let near = match without_endgame {
            true => t.re <= PASSED * radius,
            false => t.re <= radius && !passing,
        };
        let within_boundary = t.re <= settings.endgame_boundary;
        let at_end = !reaches && (near || self.in_endgame_zone(lane, step, t));
        let far = self.tracking.projective && step.size > FAR;
        if step.arrived {
            self.series[lane] = None;
            self.lanes[lane].phase = Phase::Arriving;
            self.batch.refine(lane);
        } else if without_endgame && (at_end || far && within_boundary) {
            self.put_aside(lane, t);
        } else if far || self.tracking.projective && at_end {
            self.hand_off(lane, t, Handoff::Projective);
        } else if step.accepted
            && self.tracking.down
            && self.lanes[lane].may_go_down()
            && t.re > 10.0 * radius
        {
            self.go_down_where_tame(lane, t);
        } else if at_end {
            self.series[lane] = None;
            self.lanes[lane].phase = Phase::Settling;
            self.batch.refine(lane);
        } else if self.lanes[lane].starved >= STARVED || too_small {
            self.give_up(lane, t, Failure::StepTooSmall);
        }
    }

    /// The path goes down a rung where its point is well conditioned; else it is asked again some steps later.
    fn go_down_where_tame(&mut self, lane: usize, t: Complex64) {
        self.batch
            .read_here(lane, &mut self.point, &mut self.tangent);
        let target = self.lanes[lane].target;
        if self.refiner.condition_at(&self.point, t, target) <= TAME {
            self.hand_off(lane, t, Handoff::Down);
        } else {
            self.lanes[lane].steps_here = 0;
        }
    }

    /// The path ends at a regular point at t = 0, or the endgame begins at the point before it.
    fn after_arrival(&mut self, lane: usize, step: &Step) {
        self.batch
            .read_here(lane, &mut self.point, &mut self.tangent);
        self.tangent.clone_from(&self.point);
        let report = self
            .refiner
            .refine(&mut self.point, self.lanes[lane].target);
        // From a singular endpoint Newton's method may leave for another solution.
        let moved = distance(&self.point, &self.tangent) / norm(&self.tangent);
        let target = self.lanes[lane].target;
        if step.accepted && moved <= ARRIVED && self.is_regular_end(&self.point, target, &report) {
            return self.finish(lane, PathOutcome::Regular, report, None, Vec::new());
        }
        // Back to the last point before 0, from where the turns begin.
        let before = self.batch.step_back(lane);
        let settings = &self.settings;
        if settings.max_endgame_bits < self.tracking.bits {
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

    /// The path goes on around 0, or inward; at its target the phase `there` begins.
    fn after_arc(&mut self, lane: usize, t: Complex64, step: &Step, there: Phase) {
        if step.arrived {
            self.lanes[lane].phase = there;
            self.batch.refine(lane);
        } else if self.lanes[lane].starved >= STARVED
            || self.batch.h.lane(lane) < self.least_arc() * t.norm_sqr().sqrt()
        {
            self.give_up(lane, t, Failure::StepTooSmall);
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
}
