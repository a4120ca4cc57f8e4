//! Conduct: how workers have done lately, and who gets no chunk for a while.
//!
//! A worker that fails one chunk after the other, which others do, takes more than it gives: each failure
//! costs a lease, and what it gives back is there for it again at once. So after some failures in a row it
//! is put aside for a time that doubles, by name; one chunk that it does clears it. This is what one
//! coordinator sees, for as long as it runs: nothing depends on it but who works.

use crate::ledger::identity::WorkerId;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::time::Instant;

/// Number of workers whose failures are remembered.
const REMEMBERED: usize = 100_000;
/// Time without failures after which a worker's record is clean.
const FORGIVEN: Duration = Duration::from_secs(3600);

/// When a worker that fails is put aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConductRules {
    /// Failures in a row after which a worker is put aside. Default 3: one is a path at fault, two may be chance.
    pub failures: u32,
    /// First time for which the worker is put aside, in milliseconds. Default 5000; each further failure doubles it.
    pub first_ms: u64,
    /// Longest time for which a worker is put aside, in milliseconds. Default 300,000: a machine that was mended is
    /// back within minutes.
    pub longest_ms: u64,
}

impl Default for ConductRules {
    fn default() -> Self {
        Self {
            failures: 3,
            first_ms: 5000,
            longest_ms: 300_000,
        }
    }
}

#[derive(Clone, Debug)]
struct Record {
    failures: u32,
    why: String,
    last: Instant,
    until: Option<Instant>,
}

/// Failures of workers that this coordinator remembers.
#[derive(Debug, Default)]
pub struct Conduct {
    rules: ConductRules,
    records: Mutex<HashMap<WorkerId, Record>>,
}

impl Conduct {
    /// Nobody has done anything yet.
    pub fn new(rules: ConductRules) -> Self {
        Self {
            rules,
            records: Mutex::default(),
        }
    }

    fn records(&self) -> MutexGuard<'_, HashMap<WorkerId, Record>> {
        self.records.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A chunk of this worker was accepted.
    pub fn did_well(&self, worker: &WorkerId) {
        self.records().remove(worker);
    }

    /// A worker could not do a chunk, fell silent with one, or reported what cannot be. For how long it
    /// is put aside, if it is.
    pub fn failed(&self, worker: &WorkerId, why: &str, now: Instant) -> Option<Duration> {
        let mut records = self.records();
        if records.len() >= REMEMBERED {
            records.retain(|_, record| now - record.last < FORGIVEN);
        }
        if records.len() >= REMEMBERED && !records.contains_key(worker) {
            return None;
        }
        let record = records.entry(worker.clone()).or_insert(Record {
            failures: 0,
            why: String::new(),
            last: now,
            until: None,
        });
        if now - record.last >= FORGIVEN {
            record.failures = 0;
        }
        record.failures = record.failures.saturating_add(1);
        record.last = now;
        record.why = why.chars().take(200).collect();
        let doublings = record.failures.checked_sub(self.rules.failures)?;
        let factor = 1u64.checked_shl(doublings).unwrap_or(u64::MAX);
        let time = self.rules.first_ms.saturating_mul(factor);
        let time = Duration::from_millis(time.min(self.rules.longest_ms));
        record.until = Some(now + time);
        Some(time)
    }

    /// Until when a worker gets no chunk.
    pub fn aside_until(&self, worker: &WorkerId, now: Instant) -> Option<Instant> {
        let records = self.records();
        let record = records.get(worker)?;
        record.until.filter(|&until| until > now)
    }

    /// Why a worker gets no chunk now, in words.
    pub fn refusal(&self, worker: &WorkerId, now: Instant) -> Option<String> {
        let records = self.records();
        let record = records.get(worker)?;
        let left = record.until.filter(|&until| until > now)? - now;
        Some(format!(
            "put aside for {} s: it failed {} chunks in a row, the last because {}",
            left.as_secs() + 1,
            record.failures,
            record.why
        ))
    }

    /// Names of the workers that get no chunk now.
    pub fn aside(&self, now: Instant) -> Vec<WorkerId> {
        let records = self.records();
        let aside = records
            .iter()
            .filter(|(_, record)| record.until.is_some_and(|until| until > now));
        let mut names: Vec<WorkerId> = aside.map(|(worker, _)| worker.clone()).collect();
        names.sort();
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_fails_in_a_row_is_put_aside_for_longer_each_time() {
        let conduct = Conduct::new(ConductRules::default());
        let worker = WorkerId::new("hole").unwrap();
        let begin = Instant::now();
        assert_eq!(conduct.failed(&worker, "no", begin), None);
        assert_eq!(conduct.failed(&worker, "no", begin), None);
        assert_eq!(conduct.aside_until(&worker, begin), None);
        for seconds in [5, 10, 20, 40] {
            let time = Duration::from_secs(seconds);
            assert_eq!(conduct.failed(&worker, "it cannot", begin), Some(time));
            assert_eq!(conduct.aside_until(&worker, begin), Some(begin + time));
        }
        let said = conduct.refusal(&worker, begin).unwrap();
        assert!(
            said.ends_with("it failed 6 chunks in a row, the last because it cannot"),
            "{said}"
        );
        assert_eq!(conduct.aside(begin), std::slice::from_ref(&worker));
        assert_eq!(
            conduct.aside_until(&worker, begin + Duration::from_secs(41)),
            None
        );
        for _ in 0..40 {
            conduct.failed(&worker, "no", begin);
        }
        let longest = Some(Duration::from_secs(300));
        assert_eq!(conduct.failed(&worker, "no", begin), longest);
        conduct.did_well(&worker);
        assert_eq!(conduct.failed(&worker, "no", begin), None);
    }
}
