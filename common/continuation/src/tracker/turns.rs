//! Turns: how a lane's path follows what the endgame wants around t = 0.
//!
//! `endgames::cauchy` decides where a path goes next. This module takes the path there, and hands back the point, its
//! homogenising coordinates and their valuations.

use super::digits::Digits;
use super::ends::End;
use super::far_out;
use super::lane::{Phase, Step};
use super::limits::ENDGAME_BITS;
use super::lockstep::Lockstep;
use super::outcome::{Failure, PathOutcome};
use super::precise_samples::NewtonAtSamples;
use super::scaled_newton;
use super::tracking_context::Handoff;
use crate::chart::norm;
use crate::endgames::cauchy::{self, distance};
use crate::endgames::circle::VERTICES;
use crate::endgames::infinity::Homogenizing;
use crate::refine::Report;
use cognate_numeric::precision::{DOUBLE, unit_roundoff};
use cognate_numeric::scalar::{Complex, Real};
use num_complex::Complex64;

/// The first point of turns is where they may begin again on another rung if its last Newton
/// correction is below this.
const FIRM: f64 = 1e-10;
/// Residual of each equation, scaled to 1 or as a part of its terms, at the end of an endgame: at most this or
/// [`SOLVES_WITHIN`] times the error.
const SOLVES: f64 = 1e-11;
/// Residual at the end of an endgame, as a multiple of the end's estimated error: at most this.
const SOLVES_WITHIN: f64 = 1e3;
/// A regular end is known at least as well as Newton's method must converge.
const BLURRED: f64 = 1e-8;
/// Valuations are compared again when t has fallen to this part of its value at the last comparison.
const ZONE: f64 = 0.5;

impl<R: Real> Lockstep<'_, R> {
    /// The turns around 0 begin where the path is.
    pub(super) fn begin_turns(&mut self, lane: usize, t: Complex64, step: &Step) {
        self.batch
            .read_here(lane, &mut self.point, &mut self.tangent);
        let homogenizing = self.homogenizing(lane, false);
        self.batch.drop_anchor(lane);
        let digits = [
            self.fine(),
            self.tracking.up && self.tracking.bits < ENDGAME_BITS,
        ];
        let path = &mut self.lanes[lane];
        let begin = (t.re, self.batch.digits(lane));
        if step.last[1] <= FIRM {
            path.last_turn = Some(begin.clone());
        }
        path.first_turn.get_or_insert(begin);
        let next = path
            .cauchy
            .begin(t.re, &self.point, step.last[1], &homogenizing, digits);
        self.follow_endgame(lane, next);
    }

    /// Whether a step that reached a vertex leaves no more error there than the point had where the turn
    /// began.
    pub(super) fn is_sample(&self, lane: usize, step: &Step) -> bool {
        let rounding = unit_roundoff(self.tracking.bits.min(ENDGAME_BITS));
        step.left() <= self.lanes[lane].cauchy.noise().max(2.0 * rounding)
    }

    /// The path stands at a vertex, with this relative error.
    pub(super) fn sample(&mut self, lane: usize, t: Complex64, noise: f64) {
        self.batch
            .read_here(lane, &mut self.point, &mut self.tangent);
        let homogenizing = self.homogenizing(lane, false);
        let valuations = self.valuations(lane, t, &homogenizing);
        let form = self.form_from_anchor(lane);
        let next = self.lanes[lane].cauchy.at_vertex(
            t,
            &self.point,
            noise,
            form,
            &homogenizing,
            &valuations,
            &self.settings,
        );
        self.follow_endgame(lane, next);
    }

    /// Whether a path that has come past the boundary of the endgame runs to infinity like a power of t
    /// already: turns tell more there than further in, where coordinates are of very different sizes.
    pub(super) fn in_endgame_zone(&mut self, lane: usize, step: &Step, t: Complex64) -> bool {
        if self.tracking.projective || !step.accepted || t.re > self.settings.endgame_boundary {
            return false;
        }
        let due = |(before, _): &(f64, Vec<Complex64>)| t.re <= ZONE * before;
        if !self.lanes[lane].valuations.as_ref().is_none_or(due) {
            return false;
        }
        self.batch
            .read_here(lane, &mut self.point, &mut self.tangent);
        let homogenizing = self.homogenizing(lane, false);
        let valuations = self.valuations(lane, t, &homogenizing);
        let before = self.lanes[lane]
            .valuations
            .replace((t.re, valuations.clone()));
        before.is_some_and(|(_, before)| {
            let mut both = valuations.iter().zip(&before);
            both.any(|(valuation, before)| cauchy::is_steady(*valuation, *before))
        })
    }

    /// Carries out what the endgame wants.
    pub(super) fn follow_endgame(&mut self, lane: usize, next: cauchy::Next) {
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
                    if moved < 1e-6 && self.is_regular_end(&self.point, target, &report) {
                        return self.finish(
                            lane,
                            PathOutcome::Regular,
                            report,
                            Some(1),
                            Vec::new(),
                        );
                    }
                }
                let from = self.lanes[lane].cauchy.radius();
                self.batch.return_to_anchor(lane, from);
                self.batch
                    .follow(lane, Complex64::new(radius, 0.0), 0.1 * from);
                self.lanes[lane].phase = Phase::Inward;
            }
            cauchy::Next::Settled(settled) => self.settle(lane, settled),
            cauchy::Next::Diverging {
                winding_number,
                infinity_turns,
                power_sum,
            } => {
                self.diverge(lane, winding_number, infinity_turns, power_sum);
            }
            cauchy::Next::PreciseSamples => {
                let next = self.with_precise_samples(lane);
                self.follow_endgame(lane, next);
            }
            cauchy::Next::Finer if self.settings.max_endgame_bits <= self.tracking.bits => {
                let t = self.batch.t(lane);
                self.put_aside(lane, t);
            }
            cauchy::Next::Finer => {
                let path = &mut self.lanes[lane];
                let begin = path.last_turn.take().or(path.first_turn.take());
                let (radius, point) = begin.expect("turns begin somewhere");
                self.hand_off_from(lane, Complex64::new(radius, 0.0), point, Handoff::Up);
            }
            cauchy::Next::Unsettled => {
                let t = self.batch.t(lane);
                self.give_up(lane, t, Failure::EndgameUnsettled);
            }
        }
    }

    /// The regular solution at a point of the chart, whose coordinates may be of very different sizes: the point of the
    /// chart, and normalised homogeneous coordinates, each with digits of its own. `None` where there is none, or one that
    /// coefficients within their accuracy may take to infinity.
    fn regular_in_own_units(
        &self,
        point: &[Complex64],
        target: u64,
    ) -> Option<(Vec<Complex64>, Vec<Complex64>)> {
        let (homotopy, affine) = (self.tracking.homotopy, self.stage.homotopy());
        let there = affine.chart().point(&homotopy.endpoint(point))?;
        let regular_point = scaled_newton::regular_nearby(affine, &there, target)?;
        let endpoint = affine.endpoint(&regular_point);
        let is_finite =
            far_out::is_finite(&self.settings, homotopy.smallest_homogenizing(&endpoint));
        let point = homotopy
            .chart()
            .point(&affine.chart().homogeneous(&regular_point));
        Some((point.filter(|_| is_finite)?, endpoint))
    }

    /// Refines the samples of the present turns to double-doubles, and returns the next action of the endgame.
    fn with_precise_samples(&mut self, lane: usize) -> cauchy::Next {
        let homotopy = self.tracking.homotopy;
        let newton = &mut self.newton_at_samples;
        let newton = newton.get_or_insert_with(|| Box::new(NewtonAtSamples::new(homotopy)));
        let path = &mut self.lanes[lane];
        let (places, points) = path.cauchy.samples();
        let precise_samples = newton.precise(&places, points, path.target);
        path.evaluations += precise_samples.evaluations;
        path.effort += u64::from(precise_samples.evaluations);
        path.cauchy
            .with_precise_samples(precise_samples.samples, &self.settings)
    }

    /// Two radii agree on where a path ends: it does, at a regular point or a singular one, unless that is no solution.
    fn settle(&mut self, lane: usize, settled: cauchy::Settled) {
        let target = self.lanes[lane].target;
        self.point.clear();
        self.point.extend_from_slice(&settled.endpoint);
        let mut report = self.refiner.refine(&mut self.point, target);
        // A condition number that stops growing towards t = 0 belongs to a regular
        // endpoint; one that grows with the accuracy of the point to a singular one.
        let near = self.refiner.condition_at(
            self.lanes[lane].cauchy.start(),
            Complex64::new(settled.radius, 0.0),
            target,
        );
        let moved = distance(&self.point, &settled.endpoint) / norm(&settled.endpoint);
        let farthest = 1e3 * settled.accuracy.max(1e-12);
        let regular = settled.winding_number == 1
            && report.converged
            && report.condition <= 100.0 * near
            && moved <= farthest;
        if !regular && settled.winding_number == 1 {
            let end = &settled.endpoint;
            let beside = |(point, _): &(Vec<_>, _)| distance(point, end) <= farthest * norm(end);
            let regular_end = self.regular_in_own_units(end, target).filter(beside);
            if let Some((point, endpoint)) = regular_end {
                let report = self.refiner.report(&point, target);
                let end = End {
                    outcome: PathOutcome::Regular,
                    t: Complex64::default(),
                    report: Report {
                        accuracy: f64::EPSILON,
                        ..report
                    },
                    winding_number: Some(1),
                    infinity_turns: Vec::new(),
                };
                self.record(lane, end, endpoint);
                return self.refill(lane);
            }
        }
        // In doubles a multiple point and points that are only close are the same (a
        // perturbation by the unit roundoff takes a double point apart by its square root). Deflated
        // equations tell; where they did not the path is tracked again, and the next rung tells.
        let is_retry = self.stage.attempt() > 0;
        if !regular && is_retry && self.tracking.bits == DOUBLE && self.tracking.up {
            let path = &mut self.lanes[lane];
            let begin = path.last_turn.take().or(path.first_turn.take());
            let (radius, point) = begin.expect("turns begin somewhere");
            self.hand_off_from(lane, Complex64::new(radius, 0.0), point, Handoff::Up);
            return;
        }
        // Newton's method converges, to what rounding makes of the equations.
        if regular && report.accuracy > BLURRED {
            if self.tracking.up {
                return self.follow_endgame(lane, cauchy::Next::Finer);
            }
            return self.follow_endgame(lane, cauchy::Next::Unsettled);
        }
        let outcome = if regular {
            PathOutcome::Regular
        } else {
            self.point.clear();
            self.point.extend_from_slice(&settled.endpoint);
            let error = SOLVES_WITHIN * settled.accuracy;
            let part = SOLVES.max(error);
            let Some(solution) = (self.refiner).report_solution(&self.point, target, part, error)
            else {
                let next = self.lanes[lane].cauchy.agreed_on_none(&self.settings);
                return self.follow_endgame(lane, next);
            };
            report = Report {
                accuracy: settled.accuracy,
                ..solution
            };
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

    /// Turns have taken a path for one to infinity: it is, unless it ends far out.
    fn diverge(
        &mut self,
        lane: usize,
        winding_number: Option<u32>,
        infinity_turns: Vec<i32>,
        power_sum: Option<f64>,
    ) {
        let path = &self.lanes[lane];
        let homotopy = self.tracking.homotopy;
        let far_out = match winding_number {
            Some(1) => {
                let mean = path.cauchy.mean();
                far_out::find_isolated(self.stage, homotopy, &mean, path.target)
            }
            _ => None,
        };
        let (end, endpoint) = match far_out {
            Some((report, endpoint)) => (
                End {
                    outcome: PathOutcome::Regular,
                    t: Complex64::default(),
                    report,
                    winding_number,
                    infinity_turns: Vec::new(),
                },
                endpoint,
            ),
            None => (
                End {
                    outcome: PathOutcome::Diverging,
                    t: Complex64::new(path.cauchy.radius(), 0.0),
                    report: Report {
                        accuracy: power_sum.unwrap_or(f64::INFINITY),
                        ..Report::unknown()
                    },
                    winding_number,
                    infinity_turns,
                },
                homotopy.endpoint(&self.point),
            ),
        };
        self.record(lane, end, endpoint);
        self.refill(lane);
    }

    /// The endgame's generic form of how far a path is from where its turns began: on the higher
    /// rungs with their digits, then rounded.
    fn form_from_anchor(&self, lane: usize) -> Complex64 {
        if !self.fine() {
            return cauchy::form_of_difference(&self.point, self.lanes[lane].cauchy.start());
        }
        let mut form = Complex::<R>::zero(self.context);
        let both = self.batch.here().iter().zip(self.batch.anchor());
        for ((x, anchor), c) in both.zip(cauchy::generic_form()) {
            let mut difference = x.clone();
            difference.sub(anchor);
            form.mul_add(&Complex::from_f64(self.context, c.re, c.im), &difference);
        }
        form.lane(lane)
    }

    /// Values of the homogenising coordinates at `self.point`, where the lane's path is; above doubles with
    /// all its digits. With `back`, at the point less its tangent.
    fn homogenizing(&self, lane: usize, back: bool) -> Vec<Homogenizing> {
        let homotopy = self.tracking.homotopy;
        if self.fine() {
            let context = self.context;
            let both = self.batch.here().iter().zip(self.batch.tangent_here());
            let one = |z: &Complex<R>| Digits::of(z, lane).value::<R::Single>(context);
            let point: Vec<Complex<R::Single>> = both
                .map(|(x, tangent)| {
                    let mut x = one(x);
                    if back {
                        x.sub(&one(tangent));
                    }
                    x
                })
                .collect();
            let values = homotopy.homogenizing(context, &point);
            let values = values.iter().map(|z| Digits::of(z, 0).value(()));
            values.collect()
        } else {
            let native = |z: Complex64| Complex { re: z.re, im: z.im };
            let both = self.point.iter().zip(&self.tangent);
            let point: Vec<Complex<f64>> = both
                .map(|(&x, &tangent)| native(if back { x - tangent } else { x }))
                .collect();
            let values = homotopy.homogenizing((), &point);
            let values = values.iter().map(|z| Digits::of(z, 0).value(()));
            values.collect()
        }
    }

    /// t x'/x of the homogenising coordinates, which are linear in the chart's.
    fn valuations(
        &self,
        lane: usize,
        t: Complex64,
        homogenizing: &[Homogenizing],
    ) -> Vec<Complex64> {
        let back = self.homogenizing(lane, true);
        let both = homogenizing.iter().zip(back);
        both.map(|(x, back)| {
            let (x, back) = (x.lane(0), back.lane(0));
            t * (x - back) / x
        })
        .collect()
    }
}
