//! Histogram: durations of an operation, in buckets as Prometheus reads them.

use std::fmt::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Upper bounds of the buckets, in seconds. A write takes milliseconds, a worker's question for work up to half a
/// minute.
pub const BOUNDS: [f64; 10] = [0.001, 0.005, 0.02, 0.1, 0.5, 2.0, 5.0, 10.0, 30.0, 60.0];

/// Durations that were observed.
#[derive(Debug, Default)]
pub struct Histogram {
    /// Durations in each bucket and in no smaller one; the last: above all bounds.
    counts: [AtomicU64; BOUNDS.len() + 1],
    micros: AtomicU64,
}

impl Histogram {
    /// Adds a duration.
    pub fn observe(&self, time: Duration) {
        let seconds = time.as_secs_f64();
        let place = BOUNDS.iter().position(|bound| seconds <= *bound);
        self.counts[place.unwrap_or(BOUNDS.len())].fetch_add(1, Ordering::Relaxed);
        let micros = u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        self.micros.fetch_add(micros, Ordering::Relaxed);
    }

    /// How many times were taken in.
    pub fn count(&self) -> u64 {
        self.counts
            .iter()
            .map(|count| count.load(Ordering::Relaxed))
            .sum()
    }

    /// The lines of one member of a family; `labels` as in `method="Submit"`, or empty.
    pub fn write(&self, text: &mut String, name: &str, labels: &str) {
        let comma = if labels.is_empty() { "" } else { "," };
        let mut sum = 0;
        for (bound, count) in BOUNDS.iter().zip(&self.counts) {
            sum += count.load(Ordering::Relaxed);
            // Writing to a text does not fail.
            let _ = writeln!(text, "{name}_bucket{{{labels}{comma}le=\"{bound}\"}} {sum}");
        }
        sum += self.counts[BOUNDS.len()].load(Ordering::Relaxed);
        let seconds = self.micros.load(Ordering::Relaxed) as f64 / 1e6;
        let _ = writeln!(text, "{name}_bucket{{{labels}{comma}le=\"+Inf\"}} {sum}");
        let braces = if labels.is_empty() {
            String::new()
        } else {
            format!("{{{labels}}}")
        };
        let _ = writeln!(
            text,
            "{name}_sum{braces} {seconds}\n{name}_count{braces} {sum}"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buckets_add_up() {
        let histogram = Histogram::default();
        for milliseconds in [0, 1, 3, 700, 90_000] {
            histogram.observe(Duration::from_millis(milliseconds));
        }
        let mut text = String::new();
        histogram.write(&mut text, "t_seconds", "method=\"Pull\"");
        assert_eq!(histogram.count(), 5);
        for line in [
            "t_seconds_bucket{method=\"Pull\",le=\"0.001\"} 2",
            "t_seconds_bucket{method=\"Pull\",le=\"0.005\"} 3",
            "t_seconds_bucket{method=\"Pull\",le=\"60\"} 4",
            "t_seconds_bucket{method=\"Pull\",le=\"+Inf\"} 5",
            "t_seconds_sum{method=\"Pull\"} 90.704",
            "t_seconds_count{method=\"Pull\"} 5",
        ] {
            assert!(
                text.lines().any(|text_line| text_line == line),
                "{line} in {text}"
            );
        }
    }
}
