//! Retention: how long what has ended is kept, and when what nothing names is removed.

use std::time::Duration;

/// How long what has ended is kept, and when what nothing names is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Retention {
    /// Jobs that ended longer ago than this are deleted, in milliseconds. Default 0: never.
    pub keep_ms: u64,
    /// So long an object that nothing names stays in the trash, in milliseconds. Default 24 hours: long
    /// enough between an upload and the submission that names it, and for a coordinator that stands still
    /// between an object and its row.
    pub grace_ms: u64,
    /// Time between two looks at everything. Default 1 hour: a look reads the small objects of all jobs.
    pub every: Duration,
}

impl Default for Retention {
    fn default() -> Self {
        Self {
            keep_ms: 0,
            grace_ms: 24 * 3_600_000,
            every: Duration::from_secs(3600),
        }
    }
}
