//! About: what is known of a job that has ended, besides its answer.

use serde::{Deserialize, Serialize};

/// Facts about a job that has ended, besides its answer.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Id of the job.
    pub job: String,
    /// Name of the problem, usually that of its file.
    pub name: String,
    /// Digest of the system.
    pub digest: String,
    /// Number of variables.
    pub variables: u64,
    /// Number of equations.
    pub equations: u64,
    /// Start of the paths: `total-degree`, for instance.
    pub start: String,
    /// Reason for this start: which variable groups, for instance, and who chose them.
    pub why: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Statements of the problem that are not followed, one sentence each.
    pub warnings: Vec<String>,
    /// Wall time and CPU time.
    pub time: TimeBlock,
    /// Workers and the number of items that each did.
    pub workers: Vec<WorkerBlock>,
}

/// Wall and CPU time of a job, in seconds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeBlock {
    /// Time from submission to the end, in seconds.
    pub wall_seconds: f64,
    /// CPU time of all processes, as far as it is known: that of the tracking.
    pub cpu_seconds: f64,
    /// CPU time of the tracking.
    pub tracking_cpu_seconds: f64,
    /// Items of all stages by wall time.
    pub paths_per_second: f64,
}

impl TimeBlock {
    /// The time of a job of `items` items: milliseconds from submission to the end, and microseconds of CPU time of
    /// the tracking.
    pub fn new(wall_ms: u64, tracking_micros: u64, items: u64) -> Self {
        let wall_seconds = wall_ms as f64 / 1000.0;
        let tracking_cpu_seconds = tracking_micros as f64 / 1e6;
        Self {
            wall_seconds,
            cpu_seconds: tracking_cpu_seconds,
            tracking_cpu_seconds,
            paths_per_second: items as f64 / wall_seconds.max(0.001),
        }
    }
}

/// Share of one worker in a job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WorkerBlock {
    /// Name of the worker.
    pub id: String,
    /// Items that it finished.
    pub paths: u64,
    /// Transport of the worker: `grpc` or `shared-memory`.
    pub transport: String,
}
