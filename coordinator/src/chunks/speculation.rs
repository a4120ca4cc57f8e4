//! Speculation: when the last chunks of a stage are given to a second worker.
//!
//! A chunk is given to a second worker when no chunk of the stage waits, the worker has nothing to do, and another
//! worker has had the chunk for clearly longer than chunks of this size take. That worker may be dead or stand still,
//! and its lease has not ended yet. The first report counts: paths are pure.

use serde::{Deserialize, Serialize};

/// The numbers that decide when a chunk is given out a second time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Speculation {
    /// Ratio of a chunk's age to the time that as many items took on average, from lease to result, above which the
    /// chunk is given out again; 0: never. Default 3: paths of one stage differ, and a chunk with a hard path is no
    /// reason.
    pub times: u32,
    /// Age below which a chunk is never given out again, in milliseconds. Default 1000: a worker that stands still
    /// costs a job little more, and shorter chunks are not worth doing twice.
    pub least_ms: u64,
}

impl Default for Speculation {
    fn default() -> Self {
        Self {
            times: 3,
            least_ms: 1000,
        }
    }
}

/// Time that the accepted chunks of a stage took, from which the time of the next chunk is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pace {
    /// Items that were accepted.
    pub items: u64,
    /// Time from lease to result of the accepted chunks, in milliseconds.
    pub held_ms: u64,
}

impl Speculation {
    /// Whether a chunk of `items` items has been with its worker for clearly longer than expected. False while
    /// nothing is measured. The ledgers on databases compute the same in SQL.
    pub fn is_overdue(&self, held_ms: u64, items: u64, pace: Pace) -> bool {
        let expected = f64::from(self.times) * items as f64 * pace.held_ms as f64;
        self.times > 0 && held_ms >= self.least_ms && held_ms as f64 * pace.items as f64 > expected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_clearly_late_is_done_twice() {
        let rule = Speculation::default();
        // 20 ms an item: 100 take 2 s, and are late after 6.
        let pace = Pace {
            items: 1000,
            held_ms: 20_000,
        };
        assert!(!rule.is_overdue(6000, 100, pace));
        assert!(rule.is_overdue(6001, 100, pace));
        // Short ones not before a second has passed.
        assert!(!rule.is_overdue(999, 1, pace));
        assert!(rule.is_overdue(1000, 1, pace));
        // Nothing is measured; or it is not wanted.
        assert!(!rule.is_overdue(1_000_000, 1, Pace::default()));
        let never = Speculation { times: 0, ..rule };
        assert!(!never.is_overdue(1_000_000, 1, pace));
    }
}
