//! How many items a lease takes: a pure function of what is measured and what is left.
//!
//! Guided self-scheduling: a worker gets its share of a fraction of what is
//! left, so that chunks shrink towards the end and all workers stop together;
//! never more than some seconds of work, and small while nothing is measured.

use serde::{Deserialize, Serialize};

/// The numbers that decide the sizes of chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sizing {
    /// Most work in a chunk, in milliseconds of all of the worker's threads. Default 3000:
    /// little is lost with a worker, and the ledger sees few chunks.
    pub longest_ms: u64,
    /// Most work in a chunk while other jobs are running, in milliseconds. Default 250: a small job
    /// waits for the two chunks that a worker holds of a large one.
    pub shared_ms: u64,
    /// Least work in a chunk while more is left, in milliseconds. Default 10: a lease and its
    /// report cost about 2 ms over gRPC.
    pub shortest_ms: u64,
    /// Items for each thread while nothing is measured. Default 16: one full vector of lanes.
    pub first_items: u64,
    /// A chunk is at most the worker's share of what is left, divided by this. Default 2.
    pub tail: u64,
    /// Most items in a chunk. Default 10,000: a result object stays below some megabytes.
    pub most_items: u64,
}

impl Default for Sizing {
    fn default() -> Self {
        Self {
            longest_ms: 3000,
            shared_ms: 250,
            shortest_ms: 10,
            first_items: 16,
            tail: 2,
            most_items: 10_000,
        }
    }
}

/// Less CPU time than this says nothing about the next chunk, in microseconds.
const MEASURED_MICROS: u64 = 1000;

/// State of the stage and the workers when a chunk is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Situation {
    /// Items of the stage that no worker has.
    pub ready_items: u64,
    /// Items of the stage that are done.
    pub done_items: u64,
    /// CPU time of the items that are done, in microseconds.
    pub done_micros: u64,
    /// Threads of the worker that asks.
    pub threads: u64,
    /// Threads of all workers that are here, this one included.
    pub all_threads: u64,
    /// Jobs that are running, this one included.
    pub jobs: u64,
}

impl Sizing {
    /// How many items the next chunk takes, at least 1.
    pub fn items(&self, situation: &Situation) -> u64 {
        let threads = situation.threads.max(1);
        let all_threads = situation.all_threads.max(threads);
        let share = situation.ready_items.saturating_mul(threads) / all_threads / self.tail.max(1);
        // While next to nothing is measured, half a vector of lanes a thread is worth the exchange.
        let (shortest, longest) = if situation.done_micros < MEASURED_MICROS {
            let first = self.first_items.saturating_mul(threads);
            (first.div_ceil(2), first)
        } else {
            let within = |milliseconds: u64| {
                let micros = u128::from(milliseconds) * 1000 * u128::from(threads);
                let items = micros * u128::from(situation.done_items)
                    / u128::from(situation.done_micros.max(1));
                u64::try_from(items).unwrap_or(u64::MAX)
            };
            let longest = match situation.jobs {
                0 | 1 => self.longest_ms,
                _ => self.longest_ms.min(self.shared_ms),
            };
            (within(self.shortest_ms), within(longest))
        };
        share
            .max(shortest)
            .min(longest)
            .clamp(1, self.most_items.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn situation(ready_items: u64, done_items: u64, done_micros: u64) -> Situation {
        Situation {
            ready_items,
            done_items,
            done_micros,
            threads: 1,
            all_threads: 2,
            jobs: 1,
        }
    }

    #[test]
    fn a_small_job_is_spread_over_two_workers() {
        let first = Sizing::default().items(&situation(128, 0, 0));
        assert_eq!(first, 16);
    }

    #[test]
    fn chunks_grow_with_speed_and_shrink_at_the_tail() {
        let sizing = Sizing::default();
        // 1 ms an item: 3 seconds are 3000 items.
        assert_eq!(sizing.items(&situation(1_000_000, 100, 100_000)), 3000);
        // 100 items left for two equal workers: a quarter each time.
        assert_eq!(sizing.items(&situation(100, 100, 100_000)), 25);
        // Never below 10 ms.
        assert_eq!(sizing.items(&situation(4, 100, 100_000)), 10);
        // An item of a minute: one at a time.
        assert_eq!(sizing.items(&situation(4, 1, 60_000_000)), 1);
        // Fast items: bounded by their number.
        assert_eq!(
            sizing.items(&situation(1_000_000_000, 100_000, 2000)),
            10_000
        );
        // Hardly measured is not measured.
        assert_eq!(sizing.items(&situation(1_000_000_000, 6, 0)), 16);
    }

    #[test]
    fn chunks_are_short_beside_other_jobs() {
        let beside = Situation {
            jobs: 2,
            ..situation(1_000_000, 100, 100_000)
        };
        assert_eq!(Sizing::default().items(&beside), 250);
    }

    #[test]
    fn a_larger_worker_gets_more() {
        let large = Situation {
            threads: 64,
            all_threads: 65,
            ..situation(1_000_000, 100, 10_000_000)
        };
        assert_eq!(
            Sizing::default().items(&large),
            64 * Sizing::default().items(&Situation {
                threads: 1,
                ..large
            })
        );
    }
}
