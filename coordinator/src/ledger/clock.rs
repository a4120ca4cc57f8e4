//! The ledger's clock: the machine's, or one that tests and simulations set by hand.

use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

/// Milliseconds since 1970 by the ledger's clock.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct LedgerTime(pub i64);

impl LedgerTime {
    /// This much later.
    #[must_use]
    pub fn after_ms(self, milliseconds: u64) -> Self {
        Self(self.0.saturating_add_unsigned(milliseconds))
    }

    /// Milliseconds from `earlier` to here; 0 if it is later.
    pub fn since_ms(self, earlier: Self) -> u64 {
        u64::try_from(self.0.saturating_sub(earlier.0)).unwrap_or(0)
    }
}

/// What tells the time.
pub trait Clock: Send + Sync {
    /// Now. Never earlier than before.
    fn now(&self) -> LedgerTime;
}

/// The machine's clock, held back where it would run backwards.
#[derive(Debug, Default)]
pub struct SystemClock {
    latest: AtomicI64,
}

impl Clock for SystemClock {
    fn now(&self) -> LedgerTime {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let ms = since.map_or(0, |d| i64::try_from(d.as_millis()).unwrap_or(i64::MAX));
        LedgerTime(self.latest.fetch_max(ms, Ordering::Relaxed).max(ms))
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
