//! Losses: how often workers are lost, and how large chunks may be so that little is tracked again.
//!
//! A worker that is killed has done half of a chunk on average, which is done again. Where workers are lost
//! every few seconds, chunks of seconds are too large.

use std::collections::VecDeque;
use std::time::Duration;
use tokio::time::Instant;

/// Longest time for which a loss counts.
const LONGEST_WINDOW: Duration = Duration::from_secs(300);
/// Shortest window over which losses are counted: one loss says nothing about how often they come.
const SHORTEST_WINDOW: Duration = Duration::from_secs(60);
/// Losses that are remembered; where there are more, the window is shorter.
const REMEMBERED: usize = 1000;

/// When workers were lost with chunks in hand.
#[derive(Debug, Default)]
pub struct Losses(VecDeque<Instant>);

impl Losses {
    /// Adds this number of workers that were found to be lost.
    pub fn add(&mut self, workers: usize, now: Instant) {
        self.0.extend(std::iter::repeat_n(now, workers));
        while self.0.len() > REMEMBERED {
            self.0.pop_front();
        }
    }

    /// Longest work of a chunk, in milliseconds of its worker's time, for which at most about `percent` of the paths
    /// are tracked again; no more than `longest_ms`. `workers` is the number of workers.
    pub fn longest_ms(&mut self, now: Instant, workers: u64, percent: u32, longest_ms: u64) -> u64 {
        while let Some(first) = self.0.front()
            && now.duration_since(*first) > LONGEST_WINDOW
        {
            self.0.pop_front();
        }
        let Some(first) = self.0.front().filter(|_| percent > 0) else {
            return longest_ms;
        };
        let window = now.duration_since(*first).max(SHORTEST_WINDOW).as_millis() as u64;
        // A worker is lost once in this time.
        let between = window.saturating_mul(workers.max(1)) / self.0.len() as u64;
        (between.saturating_mul(2 * u64::from(percent)) / 100).min(longest_ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_as_small_as_losses_are_frequent() {
        let mut losses = Losses::default();
        let begin = Instant::now();
        let at = |seconds| begin + Duration::from_secs(seconds);
        assert_eq!(losses.longest_ms(at(0), 4, 1, 3000), 3000);
        losses.add(1, at(0));
        assert_eq!(
            losses.longest_ms(at(1), 4, 1, 3000),
            3000,
            "one says nothing"
        );
        for second in (10..=300).step_by(10) {
            losses.add(1, at(second));
        }
        // One in ten seconds, of four workers: each is lost once in 39 s; half of 2 % of that is lost.
        assert_eq!(losses.longest_ms(at(300), 4, 1, 3000), 774);
        assert_eq!(losses.longest_ms(at(300), 40, 1, 3000), 3000);
        assert_eq!(
            losses.longest_ms(at(300), 4, 0, 3000),
            3000,
            "nobody asked for it"
        );
        assert_eq!(losses.longest_ms(at(700), 4, 1, 3000), 3000, "that is over");
        losses.add(5000, at(800));
        assert_eq!(losses.0.len(), REMEMBERED);
    }
}
