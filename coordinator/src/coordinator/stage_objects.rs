//! Stage objects: whether workers can fetch what the stages of their leases need.
//!
//! A worker that was given a chunk of which it cannot fetch the stage would ask again and again. So what a stage needs is
//! read once before the first of its chunks is given out here; where it cannot be, nothing of the job is given out for a
//! while, and the job's steward makes the objects again or ends the job.

use super::{Coordinator, CoordinatorError};
use crate::ledger::identity::{JobId, LeaseId, Speaker};
use crate::ledger::rows::{GiveBack, Lease};
use crate::results::store::StoreError;
use cognate_continuation::start_points::Digest;

impl Coordinator {
    /// The jobs of which nothing is given out now.
    pub(super) fn sick_jobs(&self) -> Vec<JobId> {
        self.sick.jobs()
    }

    /// Whether the steward of a job is to look after its objects.
    pub fn is_sick(&self, job: JobId) -> bool {
        self.sick.is_sick(job)
    }

    /// The steward of a job has made its objects again, or has found none lost: its chunks are given out again.
    pub fn recovers(&self, job: JobId) {
        self.sick.recovers(job);
        self.work.notify_waiters();
    }

    /// A worker could not fetch what it needs for these leases: that is looked at again before the next one.
    pub fn not_fetched(&self, leases: &[LeaseId], by: &Speaker, why: &str) {
        for lease in leases {
            tracing::warn!(%lease, worker = %by.worker, why, "a worker cannot fetch what it needs");
            self.sick.uncheck(lease.chunk.job);
        }
    }

    /// An object that was read for a worker: one that is lost is remembered.
    pub(super) fn heed_loss<T>(
        &self,
        object: Digest,
        read: Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        if read.as_ref().is_err_and(StoreError::is_loss) {
            self.sick.forget(object);
        }
        read
    }

    /// The leases whose stages workers can fetch. The others are given back, and their stewards woken.
    pub(super) async fn fetchable(
        &self,
        leases: Vec<Lease>,
        by: &Speaker,
    ) -> Result<Vec<Lease>, CoordinatorError> {
        let mut fetchable = Vec::with_capacity(leases.len());
        for lease in leases {
            let chunk = lease.lease.chunk;
            match self.check_stage(&lease).await {
                Err(error) if error.is_loss() => {
                    tracing::error!(lease = %lease.lease, %error,
                        "what workers need is lost: nothing of the job is given out, its steward looks after it");
                    self.sick.falls_sick(chunk.job);
                    self.give_back(&[lease.lease], GiveBack::Drained, by)
                        .await?;
                }
                // Storage that cannot be reached is noticed by the health check.
                Ok(()) | Err(_) => fetchable.push(lease),
            }
        }
        Ok(fetchable)
    }

    /// Reads what workers need for a lease, once for each stage.
    async fn check_stage(&self, lease: &Lease) -> Result<(), StoreError> {
        let chunk = lease.lease.chunk;
        if self.sick.is_checked(chunk.job, chunk.stage) {
            return Ok(());
        }
        let stage = self.stage_of(lease.definition).await?;
        let system = stage.system.unwrap_or(lease.problem);
        self.read_problem(system).await?;
        let mut objects = vec![lease.definition, system];
        if let Some(points) = stage.start_points.object() {
            self.store.get(points).await?;
            objects.push(points);
        }
        self.sick.check(chunk.job, chunk.stage, objects);
        Ok(())
    }
}
