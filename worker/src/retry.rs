//! Retry: one call that is made until it is answered, with growing pauses between failures.
//!
//! Pure: time comes in as an argument. A `Moment` is time since the process started, by
//! the worker's own monotonic clock; no other clock is ever compared with it.

use std::ops::{Add, Sub};
use std::time::Duration;

/// Time since the worker's process started, by its own monotonic clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment(pub Duration);

impl Add<Duration> for Moment {
    type Output = Self;
    fn add(self, later: Duration) -> Self {
        Self(self.0.saturating_add(later))
    }
}

impl Sub<Duration> for Moment {
    type Output = Self;
    fn sub(self, earlier: Duration) -> Self {
        Self(self.0.saturating_sub(earlier))
    }
}

impl Moment {
    /// How long after `earlier` this is; zero if it is before.
    pub fn since(self, earlier: Self) -> Duration {
        self.0.saturating_sub(earlier.0)
    }
}

/// Pauses between failures: doubled each time, up to a largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Backoff {
    /// After the first failure.
    pub first: Duration,
    /// After many.
    pub largest: Duration,
}

impl Default for Backoff {
    /// 50 ms, because a coordinator that is started again on its ledger is there within
    /// tenths of a second; 2 s at most, because a thousand workers that call every 2 s are
    /// no load, and longer pauses only let cores idle.
    fn default() -> Self {
        Self {
            first: Duration::from_millis(50),
            largest: Duration::from_secs(2),
        }
    }
}

impl Backoff {
    /// Pause after this number of failures in a row.
    pub fn pause(&self, failures: u32) -> Duration {
        let doubled = self.first.saturating_mul(
            1u32.checked_shl(failures.saturating_sub(1))
                .unwrap_or(u32::MAX),
        );
        doubled.min(self.largest)
    }
}

/// One call: waiting to be made, or on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Retry {
    failures: u32,
    in_flight: bool,
    not_before: Moment,
}

impl Retry {
    /// Whether the call is to be made now.
    pub fn is_due(&self, now: Moment) -> bool {
        !self.in_flight && now >= self.not_before
    }

    /// Whether the call is on its way.
    pub fn is_in_flight(&self) -> bool {
        self.in_flight
    }

    /// The call is made now.
    pub fn begin(&mut self) {
        assert!(!self.in_flight, "a call is not made twice at once");
        self.in_flight = true;
    }

    /// The call was answered; the next one may be made at once.
    pub fn succeed(&mut self) {
        *self = Self::default();
    }

    /// The next call is not made before this moment.
    pub fn rest_until(&mut self, moment: Moment) {
        self.not_before = moment;
    }

    /// The call was not answered; the next one waits.
    pub fn fail(&mut self, now: Moment, backoff: &Backoff) {
        self.in_flight = false;
        self.failures = self.failures.saturating_add(1);
        self.not_before = now + backoff.pause(self.failures);
    }

    /// When it is to be made; `None` while it is on its way.
    pub fn due_at(&self) -> Option<Moment> {
        (!self.in_flight).then_some(self.not_before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_double_up_to_the_largest() {
        let backoff = Backoff::default();
        let pauses: Vec<u128> = [1, 2, 3, 6, 7, 40, u32::MAX]
            .map(|failures| backoff.pause(failures).as_millis())
            .to_vec();
        assert_eq!(pauses, [50, 100, 200, 1600, 2000, 2000, 2000]);
    }

    #[test]
    fn a_call_is_due_again_after_its_pause() {
        let backoff = Backoff::default();
        let now = Moment(Duration::from_secs(7));
        let mut retry = Retry::default();
        assert!(retry.is_due(now));
        retry.begin();
        assert!(!retry.is_due(now + Duration::from_secs(100)));
        assert_eq!(retry.due_at(), None);
        retry.fail(now, &backoff);
        assert!(!retry.is_due(now));
        assert!(retry.is_due(now + backoff.first));
        retry.begin();
        retry.succeed();
        assert!(retry.is_due(now), "success forgets the failures");
    }
}
