//! The ledger's clock: the machine's, or one that tests and simulations set by hand.

use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Milliseconds since 1970 by the ledger's clock.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct LedgerTime(pub i64);

impl LedgerTime {
    /// Time that is `milliseconds` later.
    #[must_use]
    pub fn after_ms(self, milliseconds: u64) -> Self {
        Self(self.0.saturating_add_unsigned(milliseconds))
    }

    /// Milliseconds from `earlier` to here; 0 if it is later.
    pub fn since_ms(self, earlier: Self) -> u64 {
        u64::try_from(self.0.saturating_sub(earlier.0)).unwrap_or(0)
    }
}

/// Source of time: the system's clock, or one that a test sets.
pub trait Clock: Send + Sync {
    /// Now. Never earlier than before.
    fn now(&self) -> LedgerTime;
    /// Tells the clock that something happened at this time: from now on the clock does not say less. Clocks that are
    /// set by hand ignore this.
    fn is_at_least(&self, _seen: LedgerTime) {}
}

/// The machine's clock as it was at the start, plus the time that has passed since. Setting the machine's clock
/// forward or back ends no lease and prolongs none.
#[derive(Debug)]
pub struct SystemClock {
    begin: LedgerTime,
    began: Instant,
    /// Lower bound from a ledger that has seen a later time, because the clock was set back between two starts.
    at_least: AtomicI64,
}

impl Default for SystemClock {
    fn default() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        Self::from(LedgerTime(since.map_or(0, milliseconds)))
    }
}

impl SystemClock {
    /// A clock that says this now.
    fn from(begin: LedgerTime) -> Self {
        Self {
            begin,
            began: Instant::now(),
            at_least: AtomicI64::new(begin.0),
        }
    }
}

fn milliseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_millis()).unwrap_or(i64::MAX)
}

impl Clock for SystemClock {
    fn now(&self) -> LedgerTime {
        let begin = self.at_least.load(Ordering::Relaxed).max(self.begin.0);
        LedgerTime(begin.saturating_add(milliseconds(self.began.elapsed())))
    }

    fn is_at_least(&self, seen: LedgerTime) {
        let passed = milliseconds(self.began.elapsed());
        let begin = seen.0.saturating_sub(passed);
        self.at_least.fetch_max(begin, Ordering::Relaxed);
    }
}

/// A clock that stands still until it is moved.
#[derive(Debug, Default)]
pub struct ManualClock {
    now: AtomicI64,
}

impl ManualClock {
    /// Moves the clock forward.
    pub fn advance_ms(&self, milliseconds: u64) {
        let ms = i64::try_from(milliseconds).unwrap_or(i64::MAX);
        self.now.fetch_add(ms, Ordering::Relaxed);
    }
}

impl Clock for ManualClock {
    fn now(&self) -> LedgerTime {
        LedgerTime(self.now.load(Ordering::Relaxed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_was_set_back_goes_on_from_what_was_seen() {
        let hour = 3_600_000;
        let clock = SystemClock::default();
        let now = clock.now();
        let wall = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map(milliseconds);
        assert!(
            (now.0 - wall.unwrap()).abs() < 60_000,
            "milliseconds since 1970"
        );
        // A ledger that was written before the machine's clock was set back by an hour.
        let seen = now.after_ms(hour);
        clock.is_at_least(seen);
        assert!(clock.now() >= seen && clock.now() < seen.after_ms(60_000));
        clock.is_at_least(now);
        assert!(clock.now() >= seen, "never earlier than before");
        let before = clock.now();
        std::thread::sleep(Duration::from_millis(5));
        assert!(clock.now() > before, "and it goes on");
    }
}
