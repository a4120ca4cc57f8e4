//! Metrics: what the ledger says, as Prometheus reads it. Counts only, no names of problems.
//!
//! Every answer is asked of the ledger, so that any coordinator over a database says the same.

use crate::ledger::identity::JobId;
use crate::ledger::rows::{JobRow, JobState, StageRow};
use crate::ledger::{Ledger, LedgerError};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;
use std::time::Duration;
use tokio::time::Instant;

/// Latest jobs and latest workers that are counted.
const ROWS: u32 = 10_000;
/// Time of silence after which a worker counts as gone, in milliseconds. Default 60 s: six heartbeats.
const PRESENT_MS: u64 = 60_000;
/// Expected CPU time of an item while no item of its stage is done, in microseconds.
const UNKNOWN_MICROS: u64 = 1_000;

/// Last progress of each job that waits, and the time of that progress.
#[derive(Debug, Default)]
pub struct Waiting(HashMap<JobId, (u64, Instant)>);

impl Waiting {
    /// Takes in the progress of the jobs with ready chunks, and returns the longest time that any of them has made
    /// none.
    fn longest(&mut self, jobs: HashMap<JobId, u64>, now: Instant) -> Duration {
        self.0.retain(|job, _| jobs.contains_key(job));
        for (job, got) in jobs {
            let last_progress = self.0.entry(job).or_insert((got, now));
            if last_progress.0 != got {
                *last_progress = (got, now);
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

/// All metrics, in the text format of Prometheus.
pub async fn metrics(ledger: &dyn Ledger, waiting: &mut Waiting) -> Result<String, LedgerError> {
    let mut work = WorkCounts::default();
    for (job, stages) in ledger.overviews(ROWS).await? {
        work.add_job(&job, &stages);
    }
    let workers = workers_by_transport(ledger).await?;
    let longest = waiting
        .longest(std::mem::take(&mut work.progress), Instant::now())
        .as_secs();
    let mut text = String::new();
    work.write(&mut text, longest);
    write_workers(&mut text, &workers);
    Ok(text)
}

/// Counts over the latest jobs and their stages.
struct WorkCounts {
    /// Jobs by state.
    states: BTreeMap<&'static str, u64>,
    /// Chunks of jobs that have not ended.
    ready_chunks: u64,
    leased_chunks: u64,
    done_chunks: u64,
    /// Paths accepted, by outcome.
    paths: BTreeMap<&'static str, u64>,
    /// CPU time of accepted chunks, in microseconds.
    micros: u64,
    /// CPU time that the ready items are expected to take, in microseconds.
    backlog_micros: u64,
    /// Chunks that were given to a second worker, and those that it reported first.
    speculative_leases: u64,
    speculative_won: u64,
    /// Jobs with ready chunks, each with a number that grows when the job gets on.
    progress: HashMap<JobId, u64>,
}

impl Default for WorkCounts {
    fn default() -> Self {
        Self {
            states: JobState::ALL
                .iter()
                .map(|state| (state.name(), 0))
                .collect(),
            ready_chunks: 0,
            leased_chunks: 0,
            done_chunks: 0,
            paths: BTreeMap::new(),
            micros: 0,
            backlog_micros: 0,
            speculative_leases: 0,
            speculative_won: 0,
            progress: HashMap::new(),
        }
    }
}

impl WorkCounts {
    fn add_job(&mut self, job: &JobRow, stages: &[StageRow]) {
        *self.states.entry(job.state.name()).or_default() += 1;
        for stage in stages {
            if !job.state.has_ended() {
                self.add_open_stage(job.job, stage);
            }
            *self.paths.entry("regular").or_default() += stage.outcomes.regular;
            *self.paths.entry("singular").or_default() += stage.outcomes.singular;
            *self.paths.entry("failed").or_default() += stage.outcomes.failed;
            self.micros += stage.cpu_micros;
            self.speculative_leases += stage.speculative_leases;
            self.speculative_won += stage.speculative_won;
        }
    }

    /// Chunks and backlog of a stage whose job has not ended.
    fn add_open_stage(&mut self, job: JobId, stage: &StageRow) {
        self.ready_chunks += stage.ready.chunks;
        self.leased_chunks += stage.leased.chunks;
        let done = stage.accepted.chunks + stage.failed.chunks;
        self.done_chunks += done;
        let each = stage.cpu_micros.checked_div(stage.accepted.items);
        let wanted = stage
            .ready
            .items
            .saturating_mul(each.unwrap_or(UNKNOWN_MICROS));
        self.backlog_micros = self.backlog_micros.saturating_add(wanted);
        // This number changes when a chunk is given out, comes back or is done.
        let got = stage.leased.chunks + 2 * done + u64::from(stage.stage.0);
        if stage.ready.chunks > 0 {
            *self.progress.entry(job).or_default() += got;
        }
    }

    /// Writes all families of jobs; `longest` is the longest wait of a job, in seconds.
    fn write(self, text: &mut String, longest: u64) {
        let named = |counts: BTreeMap<&str, u64>, name: &str| -> Vec<(String, u64)> {
            counts.iter().map(|(k, v)| (label(name, k), *v)).collect()
        };
        let jobs = named(self.states, "state");
        family(text, "cognate_jobs", "gauge", "Jobs by state.", &jobs);
        let chunks = [
            (label("state", "ready"), self.ready_chunks),
            (label("state", "leased"), self.leased_chunks),
            (label("state", "done"), self.done_chunks),
        ];
        let help = "Chunks of jobs that have not ended; ready ones wait for a worker.";
        family(text, "cognate_chunks", "gauge", help, &chunks);
        let help = "CPU seconds that the items which wait for a worker are expected to take, by those done so far.";
        let backlog = self.backlog_micros.div_ceil(1_000_000);
        single(text, "cognate_backlog_seconds", "gauge", help, backlog);
        let help = "Seconds that the job has waited which has ready chunks and has not got on for longest.";
        single(text, "cognate_waiting_seconds", "gauge", help, longest);
        let help = "Paths accepted, of all stages, by how they ended.";
        let paths = named(self.paths, "outcome");
        family(text, "cognate_paths_total", "counter", help, &paths);
        let help = "CPU time of accepted chunks, in microseconds.";
        let name = "cognate_tracking_microseconds_total";
        single(text, name, "counter", help, self.micros);
        let name = "cognate_speculative_leases_total";
        let help = "Late chunks that were given to a second worker.";
        single(text, name, "counter", help, self.speculative_leases);
        let name = "cognate_speculative_leases_won_total";
        let help = "Late chunks that the second worker reported first.";
        single(text, name, "counter", help, self.speculative_won);
    }
}

/// Workers of one kind of transport.
#[derive(Default)]
struct WorkerCounts {
    workers: u64,
    threads: u64,
}

/// Counts of the workers that were heard of in the last minute, by their transport.
async fn workers_by_transport(
    ledger: &dyn Ledger,
) -> Result<BTreeMap<String, WorkerCounts>, LedgerError> {
    let now = ledger.now().await?;
    let mut workers: BTreeMap<String, WorkerCounts> = BTreeMap::new();
    for worker in ledger.workers(ROWS).await? {
        if now.since_ms(worker.last_seen) <= PRESENT_MS {
            let counts = workers.entry(worker.says.transport).or_default();
            counts.workers += 1;
            counts.threads += u64::from(worker.says.threads);
        }
    }
    Ok(workers)
}

fn write_workers(text: &mut String, workers: &BTreeMap<String, WorkerCounts>) {
    let counted = |count: fn(&WorkerCounts) -> u64| -> Vec<(String, u64)> {
        let counts = workers.iter();
        counts
            .map(|(k, v)| (label("transport", k), count(v)))
            .collect()
    };
    let help = "Workers heard of in the last minute.";
    let values = counted(|c| c.workers);
    family(text, "cognate_workers", "gauge", help, &values);
    let help = "Their tracking threads.";
    let values = counted(|c| c.threads);
    family(text, "cognate_worker_threads", "gauge", help, &values);
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
