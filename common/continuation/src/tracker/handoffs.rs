//! Handoffs: how a lane's path goes on in another tracking context, or fails for want of one.

use super::digits::Digits;
use super::limits::ENDGAME_BITS;
use super::lockstep::Lockstep;
use super::outcome::Failure;
use super::tracking_context::{HandedOffPath, Handoff};
use cognate_numeric::precision::DOUBLE_DOUBLE;
use cognate_numeric::scalar::Real;
use num_complex::Complex64;

impl<R: Real> Lockstep<'_, R> {
    /// Hands a path that cannot go on in this tracking context to another one, or lets it fail.
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

    /// A point of the chart where paths begin in the projective patch, if there is one; `None` where
    /// that misses it.
    pub(super) fn projective_point(&self, point: Vec<Complex64>) -> Option<Vec<Complex64>> {
        match self.stage.projective_homotopy() {
            Some(projective) => {
                let coordinates = self.stage.homotopy().chart().homogeneous(&point);
                projective.chart().point(&coordinates)
            }
            None => Some(point),
        }
    }

    /// The path goes on in another tracking context from where it is.
    pub(super) fn hand_off(&mut self, lane: usize, t: Complex64, handoff: Handoff) {
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
