//! Metrics: what the ledger says, as Prometheus reads it. Counts only, no names of problems.
//!
//! Every answer is asked of the ledger, so that any coordinator over a database says the same.

use crate::ledger::identity::JobId;
use crate::ledger::rows::JobState;
use crate::ledger::{Ledger, LedgerError};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;
use std::time::Duration;
use tokio::time::Instant;

/// The latest jobs and workers that are counted.
const ROWS: u32 = 10_000;
/// A worker that was silent for longer counts as gone. Default 60 s: six heartbeats.
const PRESENT_MS: u64 = 60_000;
/// CPU time that is expected of an item while no item of its stage is done, in microseconds.
const UNKNOWN_MICROS: u64 = 1_000;

/// Since when jobs wait: how far each had got when it was last seen to get on, and when that was.
#[derive(Debug, Default)]
pub struct Waiting(HashMap<JobId, (u64, Instant)>);

impl Waiting {
    /// Takes in how far the jobs are of which chunks wait; how long the one has waited that has not got on for
    /// longest.
    fn longest(&mut self, jobs: HashMap<JobId, u64>, now: Instant) -> Duration {
        self.0.retain(|job, _| jobs.contains_key(job));
        for (job, got) in jobs {
            let known = self.0.entry(job).or_insert((got, now));
            if known.0 != got {
                *known = (got, now);
            }
        }
        let waited = self.0.values().map(|(_, since)| now.duration_since(*since));
        waited.max().unwrap_or_default()
    }
}

/// A family of values, each with its label.
fn family(text: &mut String, name: &str, kind: &str, help: &str, values: &[(String, u64)]) {
    // Writing to a text does not fail.
    let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} {kind}");
    for (labels, value) in values {
        let _ = writeln!(text, "{name}{labels} {value}");
    }
}

/// A family of one value.
fn single(text: &mut String, name: &str, kind: &str, help: &str, value: u64) {
    family(text, name, kind, help, &[(String::new(), value)]);
}

fn label(name: &str, value: &str) -> String {
    let value = value.replace('\\', "\\\\").replace('"', "\\\"");
    format!("{{{name}=\"{}\"}}", value.replace('\n', " "))
}

/// All of it, in the text format of Prometheus.
pub async fn metrics(ledger: &dyn Ledger, waiting: &mut Waiting) -> Result<String, LedgerError> {
    let mut states: BTreeMap<&str, u64> = JobState::ALL
        .iter()
        .map(|state| (state.name(), 0))
        .collect();
    let mut chunks = [0; 3];
    let mut paths: BTreeMap<&str, u64> = BTreeMap::new();
    let mut micros = 0;
    let mut backlog_micros = 0u64;
    let mut speculative = [0; 2];
    let mut standing = HashMap::new();
    for (job, stages) in ledger.overviews(ROWS).await? {
        *states.entry(job.state.name()).or_default() += 1;
        for stage in stages {
            if !job.state.has_ended() {
                chunks[0] += stage.ready.chunks;
                chunks[1] += stage.leased.chunks;
                let done = stage.accepted.chunks + stage.failed.chunks;
                chunks[2] += done;
                let each = stage.cpu_micros.checked_div(stage.accepted.items);
                let wanted = stage
                    .ready
                    .items
                    .saturating_mul(each.unwrap_or(UNKNOWN_MICROS));
                backlog_micros = backlog_micros.saturating_add(wanted);
                // What is leased or done differs once a chunk is given out, comes back or is done.
                let got = stage.leased.chunks + 2 * done + u64::from(stage.stage.0);
                if stage.ready.chunks > 0 {
                    *standing.entry(job.job).or_default() += got;
                }
            }
            *paths.entry("regular").or_default() += stage.outcomes.regular;
            *paths.entry("singular").or_default() += stage.outcomes.singular;
            *paths.entry("failed").or_default() += stage.outcomes.failed;
            micros += stage.cpu_micros;
            speculative[0] += stage.speculative_leases;
            speculative[1] += stage.speculative_won;
        }
    }
    let now = ledger.now().await?;
    let mut workers: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    for worker in ledger.workers(ROWS).await? {
        if now.since_ms(worker.last_seen) <= PRESENT_MS {
            let of_kind = workers.entry(worker.says.transport).or_default();
            of_kind.0 += 1;
            of_kind.1 += u64::from(worker.says.threads);
        }
    }
    let mut text = String::new();
    let named = |counts: BTreeMap<&str, u64>, name: &str| -> Vec<(String, u64)> {
        counts.iter().map(|(k, v)| (label(name, k), *v)).collect()
    };
    let jobs = named(states, "state");
    family(&mut text, "cognate_jobs", "gauge", "Jobs by state.", &jobs);
    let of_chunks = ["ready", "leased", "done"].iter().zip(chunks);
    let of_chunks: Vec<_> = of_chunks.map(|(k, v)| (label("state", k), v)).collect();
    let help = "Chunks of jobs that have not ended; ready ones wait for a worker.";
    family(&mut text, "cognate_chunks", "gauge", help, &of_chunks);
    let help = "CPU seconds that the items which wait for a worker are expected to take, by those done so far.";
    let backlog = backlog_micros.div_ceil(1_000_000);
    single(&mut text, "cognate_backlog_seconds", "gauge", help, backlog);
    let longest = waiting.longest(standing, Instant::now()).as_secs();
    let help =
        "Seconds that the job has waited which has ready chunks and has not got on for longest.";
    single(&mut text, "cognate_waiting_seconds", "gauge", help, longest);
    let help = "Paths accepted, of all stages, by how they ended.";
    let of_paths = named(paths, "outcome");
    family(&mut text, "cognate_paths_total", "counter", help, &of_paths);
    let help = "CPU time of accepted chunks, in microseconds.";
    let name = "cognate_tracking_microseconds_total";
    single(&mut text, name, "counter", help, micros);
    let of_speculative = [
        (
            "cognate_speculative_leases_total",
            "Late chunks that were given to a second worker.",
        ),
        (
            "cognate_speculative_leases_won_total",
            "Late chunks that the second worker reported first.",
        ),
    ];
    for ((name, help), value) in of_speculative.into_iter().zip(speculative) {
        single(&mut text, name, "counter", help, value);
    }
    let of = |count: fn(&(u64, u64)) -> u64| -> Vec<(String, u64)> {
        let counts = workers.iter();
        counts
            .map(|(k, v)| (label("transport", k), count(v)))
            .collect()
    };
    let help = "Workers heard of in the last minute.";
    family(&mut text, "cognate_workers", "gauge", help, &of(|c| c.0));
    let help = "Their tracking threads.";
    family(
        &mut text,
        "cognate_worker_threads",
        "gauge",
        help,
        &of(|c| c.1),
    );
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::clock::ManualClock;
    use crate::ledger::conformance::*;
    use crate::ledger::memory::MemoryLedger;
    use crate::ledger::rows::Advance;
    use std::sync::Arc;

    async fn busy() -> Arc<dyn Ledger> {
        let ledger = MemoryLedger::new(Arc::new(ManualClock::default()));
        let job = ledger.submit(request("r"), new_job("t", 1)).await.unwrap();
        let job = job.job;
        let epoch = ledger.steward(job, &coordinator("c"), 1000).await;
        let open = Advance {
            open: vec![stage(0, 100, 10)],
            ..Advance::default()
        };
        ledger
            .advance(job, epoch.unwrap().unwrap(), open)
            .await
            .unwrap();
        let lease = ledger.lease(wants("w", "q", 1)).await.unwrap()[0].clone();
        let object = result(lease.items, 1, 7_000);
        ledger.complete(lease.lease, object).await.unwrap();
        Arc::new(ledger)
    }

    #[tokio::test]
    async fn what_the_ledger_says_is_counted() {
        let text = metrics(&*busy().await, &mut Waiting::default())
            .await
            .unwrap();
        assert!(text.contains("cognate_jobs{state=\"running\"} 1"), "{text}");
        assert!(
            text.contains("cognate_chunks{state=\"leased\"} 0"),
            "{text}"
        );
        assert!(text.contains("cognate_chunks{state=\"done\"} 1"), "{text}");
        assert!(text.contains("cognate_tracking_microseconds_total 7000"));
        // 90 items at 700 µs: less than a second.
        assert!(text.contains("cognate_backlog_seconds 1"), "{text}");
        assert!(text.contains("cognate_speculative_leases_total 0"));
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let (name, value) = line.rsplit_once(' ').expect("name and value");
            assert!(name.starts_with("cognate_") && value.parse::<u64>().is_ok());
        }
    }

    #[test]
    fn who_does_not_get_on_waits() {
        let mut waiting = Waiting::default();
        let (one, two) = (JobId(1), JobId(2));
        let begin = Instant::now();
        let seconds = Duration::from_secs;
        let jobs = |got| HashMap::from([(one, 5), (two, got)]);
        assert_eq!(waiting.longest(jobs(0), begin), seconds(0));
        assert_eq!(waiting.longest(jobs(1), begin + seconds(7)), seconds(7));
        let only_two = HashMap::from([(two, 1)]);
        assert_eq!(waiting.longest(only_two, begin + seconds(9)), seconds(2));
        assert_eq!(
            waiting.longest(HashMap::new(), begin + seconds(10)),
            seconds(0)
        );
    }
}
