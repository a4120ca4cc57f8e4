//! Limited submission: a job that exceeds the limits of its tenant is refused.
//!
//! Jobs are counted in the ledger when one is submitted, so that every coordinator counts the same. Two coordinators that
//! are asked in the same moment may each let one in.

use super::submission_limits::SubmissionLimits;
use super::{Coordinator, CoordinatorError};
use crate::jobs::planning::Planned;
use crate::ledger::identity::{JobId, RequestId, Tenant};

impl Coordinator {
    /// Refuses a job of `paths` paths that exceeds the limits of its tenant. A repeated request for an existing job
    /// adds nothing.
    pub(super) async fn check_limits(
        &self,
        request: &RequestId,
        tenant: &Tenant,
        limits: SubmissionLimits,
        paths: u64,
    ) -> Result<(), CoordinatorError> {
        if !limits.is_any() {
            return Ok(());
        }
        if self.ledger.job(JobId::of_request(request)).await?.is_some() {
            return Ok(());
        }
        let mut used = (0u64, 0u64);
        for job in self.ledger.unfinished_jobs().await? {
            let Some(row) = self.ledger.job(job).await? else {
                continue;
            };
            if row.asked.tenant != *tenant {
                continue;
            }
            used.0 += 1;
            let planned = Planned::from_bytes(&row.asked.options)?.paths;
            used.1 = used.1.saturating_add(match planned {
                Some(paths) => paths,
                None => {
                    let stages = self.ledger.stages(job).await?;
                    stages.iter().map(|stage| stage.items).sum()
                }
            });
        }
        let check = |what, limit: Option<u64>, used: u64, asked: u64| match limit {
            Some(limit) if used.saturating_add(asked) > limit => Err(CoordinatorError::OverLimit {
                tenant: tenant.clone(),
                what,
                limit,
                used,
                asked,
            }),
            _ => Ok(()),
        };
        check("unfinished jobs", limits.jobs, used.0, 1)?;
        check("paths of unfinished jobs", limits.paths, used.1, paths)
    }
}
