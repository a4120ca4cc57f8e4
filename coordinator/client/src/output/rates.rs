//! Rates: how fast counts grow, smoothed over some looks.

use std::collections::HashMap;

/// Weight of the earlier rate at each look: half of it is gone after one.
const MEMORY: f64 = 0.5;

/// Counts that were seen, and how fast each has grown.
#[derive(Debug, Default)]
pub struct Rates {
    seen: HashMap<String, Seen>,
}

#[derive(Debug)]
struct Seen {
    /// Time of the observation in seconds, of any clock.
    at: f64,
    count: u64,
    rate: Option<f64>,
}

impl Rates {
    /// A count at a time in seconds.
    pub fn saw(&mut self, name: &str, count: u64, at: f64) {
        let fresh = Seen {
            at,
            count,
            rate: None,
        };
        let seen = self.seen.entry(name.to_owned()).or_insert(fresh);
        let seconds = at - seen.at;
        if seconds > 0.0 {
            // A count that falls began anew: a coordinator was started again.
            let measured_rate = count.saturating_sub(seen.count) as f64 / seconds;
            let rate = seen.rate.map_or(measured_rate, |before| {
                MEMORY * before + (1.0 - MEMORY) * measured_rate
            });
            *seen = Seen {
                at,
                count,
                rate: Some(rate),
            };
        }
    }

    /// Per second; nothing after one look.
    pub fn of(&self, name: &str) -> Option<f64> {
        self.seen.get(name)?.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_needs_two_looks_and_follows_slowly() {
        let mut rates = Rates::default();
        rates.saw("a", 10, 0.0);
        assert_eq!(rates.of("a"), None);
        rates.saw("a", 30, 2.0);
        assert_eq!(rates.of("a"), Some(10.0));
        rates.saw("a", 30, 3.0);
        assert_eq!(rates.of("a"), Some(5.0));
        rates.saw("a", 0, 4.0);
        assert_eq!(rates.of("a"), Some(2.5));
        assert_eq!(rates.of("b"), None);
    }
}
