//! Changes: wakes the watchers of a job when this job changes.

use crate::ledger::identity::JobId;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// The jobs that are watched.
#[derive(Debug, Default)]
pub struct Changes {
    watched: Mutex<HashMap<JobId, watch::Sender<u64>>>,
}

impl Changes {
    fn watched(&self) -> MutexGuard<'_, HashMap<JobId, watch::Sender<u64>>> {
        self.watched.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Grows with everything that clients may see of this job.
    pub fn of(&self, job: JobId) -> watch::Receiver<u64> {
        let mut watched = self.watched();
        // Jobs without watchers are dropped from the table.
        watched.retain(|_, sender| sender.receiver_count() > 0);
        let sender = watched.entry(job).or_insert_with(|| watch::Sender::new(0));
        sender.subscribe()
    }

    /// Clients may see something else of this job now.
    pub fn happened(&self, job: JobId) {
        if let Some(sender) = self.watched().get(&job) {
            sender.send_modify(|count| *count += 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_s_changes_wake_its_watchers_only() {
        let changes = Changes::default();
        let (mut one, mut two) = (changes.of(JobId(1)), changes.of(JobId(2)));
        changes.happened(JobId(1));
        changes.happened(JobId(3));
        assert!(one.has_changed().unwrap() && !two.has_changed().unwrap());
        one.mark_unchanged();
        let late_watcher = changes.of(JobId(2));
        changes.happened(JobId(2));
        assert!(!one.has_changed().unwrap() && two.has_changed().unwrap());
        assert!(late_watcher.has_changed().unwrap(), "all of them");
        two.mark_unchanged();
        drop((one, two, late_watcher));
        changes.of(JobId(4));
        assert_eq!(changes.watched().len(), 1, "nobody watches the others");
    }
}
