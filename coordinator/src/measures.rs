//! Measures: what this process has done since it began, counted where it is done.

use crate::histogram::Histogram;
use std::fmt::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Times of an operation on storage, and how often it failed.
#[derive(Debug, Default)]
pub struct Measure {
    times: Histogram,
    failures: AtomicU64,
}

impl Measure {
    /// Takes an operation in.
    pub fn observe(&self, time: Duration, failed: bool) {
        self.times.observe(time);
        self.failures
            .fetch_add(u64::from(failed), Ordering::Relaxed);
    }

    fn failures(&self) -> u64 {
        self.failures.load(Ordering::Relaxed)
    }
}

/// Operations on ledger and store.
#[derive(Debug, Default)]
pub struct StorageMeasures {
    /// Commits of the ledger: groups of writes.
    pub commits: Measure,
    /// Objects that were written, or found to be there.
    pub writes: Measure,
    /// Objects that were read.
    pub reads: Measure,
}

impl StorageMeasures {
    /// As Prometheus reads them.
    pub fn write(&self, text: &mut String) {
        let operations = [
            ("ledger_commit", &self.commits),
            ("object_write", &self.writes),
            ("object_read", &self.reads),
        ];
        let name = "cognate_storage_seconds";
        // Writing to a text does not fail.
        let _ = writeln!(
            text,
            "# HELP {name} Operations on ledger and results, and how long they took.\n# TYPE {name} histogram"
        );
        for (operation, measure) in operations {
            measure
                .times
                .write(text, name, &format!("operation=\"{operation}\""));
        }
        let name = "cognate_storage_failures_total";
        let _ = writeln!(
            text,
            "# HELP {name} Operations on ledger and results that failed.\n# TYPE {name} counter"
        );
        for (operation, measure) in operations {
            let failures = measure.failures();
            let _ = writeln!(text, "{name}{{operation=\"{operation}\"}} {failures}");
        }
    }
}

/// Events of chunks that are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChunkEvent {
    /// A chunk was given to a worker.
    Leased,
    /// A worker fell silent with a chunk.
    Expired,
    /// A worker gave a chunk back that it could not do.
    Failed,
    /// A chunk's results were accepted.
    Accepted,
    /// A chunk's results wait for a second worker.
    Unconfirmed,
    /// A report came after its lease had ended.
    Stale,
    /// A report is not what it should be.
    Refused,
    /// Results cannot be right, or differ from the results of other workers.
    Doubted,
    /// Results of a worker were wrong: it gets no more chunks.
    Struck,
}

impl ChunkEvent {
    const ALL: [Self; 9] = [
        Self::Leased,
        Self::Expired,
        Self::Failed,
        Self::Accepted,
        Self::Unconfirmed,
        Self::Stale,
        Self::Refused,
        Self::Doubted,
        Self::Struck,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Leased => "leased",
            Self::Expired => "expired",
            Self::Failed => "failed",
            Self::Accepted => "accepted",
            Self::Unconfirmed => "unconfirmed",
            Self::Stale => "stale",
            Self::Refused => "refused",
            Self::Doubted => "doubted",
            Self::Struck => "struck",
        }
    }
}

/// How often what happened to chunks.
#[derive(Debug, Default)]
pub struct ChunkEvents([AtomicU64; ChunkEvent::ALL.len()]);

impl ChunkEvents {
    /// Counts an event `times` times.
    pub fn count(&self, event: ChunkEvent, times: usize) {
        self.0[event as usize].fetch_add(times as u64, Ordering::Relaxed);
    }

    /// As Prometheus reads them.
    pub fn write(&self, text: &mut String) {
        let name = "cognate_chunk_events_total";
        let _ = writeln!(
            text,
            "# HELP {name} What happened to chunks at this coordinator.\n# TYPE {name} counter"
        );
        for event in ChunkEvent::ALL {
            let times = self.0[event as usize].load(Ordering::Relaxed);
            let _ = writeln!(text, "{name}{{event=\"{}\"}} {times}", event.name());
        }
    }
}

/// Writes metrics of this process that the operating system provides, under the names that Prometheus' own clients
/// use.
pub fn write_process(text: &mut String) {
    let page = rustix::param::page_size() as u64;
    let memory = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = memory.split_whitespace().nth(1);
    let pages: Option<u64> = pages.and_then(|pages| pages.parse().ok());
    let files = std::fs::read_dir("/proc/self/fd").map(|files| files.count() as u64);
    let values = [
        (
            "process_resident_memory_bytes",
            "Memory that the process has.",
            pages.map(|pages| pages * page),
        ),
        (
            "process_open_fds",
            "Files and sockets that are open.",
            files.ok(),
        ),
    ];
    for (name, help, value) in values {
        if let Some(value) = value {
            let _ = writeln!(
                text,
                "# HELP {name} {help}\n# TYPE {name} gauge\n{name} {value}"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_counted_is_written() {
        let (storage, events) = (StorageMeasures::default(), ChunkEvents::default());
        storage.commits.observe(Duration::from_millis(3), false);
        storage.reads.observe(Duration::from_millis(3), true);
        events.count(ChunkEvent::Leased, 3);
        events.count(ChunkEvent::Struck, 1);
        let mut text = String::new();
        storage.write(&mut text);
        events.write(&mut text);
        write_process(&mut text);
        for line in [
            "cognate_storage_seconds_count{operation=\"ledger_commit\"} 1",
            "cognate_storage_failures_total{operation=\"ledger_commit\"} 0",
            "cognate_storage_failures_total{operation=\"object_read\"} 1",
            "cognate_chunk_events_total{event=\"leased\"} 3",
            "cognate_chunk_events_total{event=\"struck\"} 1",
        ] {
            assert!(
                text.lines().any(|text_line| text_line == line),
                "{line} in {text}"
            );
        }
        assert!(text.contains("\nprocess_resident_memory_bytes "), "{text}");
    }
}
