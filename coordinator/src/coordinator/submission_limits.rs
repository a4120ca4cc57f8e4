//! Submission limits: how many jobs and paths a tenant may have at once.

/// Limits on a tenant's jobs that have not ended; `None`: no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SubmissionLimits {
    /// Number of jobs.
    pub jobs: Option<u64>,
    /// Number of planned paths of all these jobs. A job whose paths are counted by workers counts with the paths of
    /// its stages so far.
    pub paths: Option<u64>,
}

impl SubmissionLimits {
    /// Whether anything is limited.
    pub fn is_any(&self) -> bool {
        self.jobs.is_some() || self.paths.is_some()
    }
}
