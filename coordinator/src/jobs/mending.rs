//! Mending: objects of a job that storage has lost, made again from what is left.
//!
//! A job's stages follow from its first state and from the results that its closed stages were absorbed with. So a
//! second steward begins where the first one began, takes the same results in the same order, and opens the same
//! stages: what it opens has the digests that the ledger names, or it is of no use.

use super::drive::{Drive, Driven, absorbed};
use super::planning::STATE;
use super::steward::{Steward, Wanted};
use super::tools::{DriveError, Tools};
use crate::ledger::identity::{JobId, digest_of};
use crate::ledger::rows::{JobEnd, JobRow, StageRow};
use crate::ledger::{Ledger, LedgerError};
use crate::results::store::{Store, StoreError};
use cognate_algorithms::Opening;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::Stage;

/// The first object of a job that cannot be read.
struct Loss {
    what: String,
    error: StoreError,
}

impl Drive {
    /// Looks whether everything is there that workers and clients need of the job, makes again what is lost, and ends
    /// the job by name where that cannot be done. [`Driven::Waits`]: nothing is lost.
    pub async fn mend(&mut self, tools: &Tools<'_>) -> Result<Driven, DriveError> {
        let job = self.job();
        let Some(loss) = first_loss(tools, job).await? else {
            return Ok(Driven::Waits);
        };
        tracing::warn!(%job, what = loss.what, error = %loss.error, "an object is lost: it is made again");
        match self.make_again(tools).await {
            Ok(()) => {}
            Err(error) if error.is_loss() || error.is_permanent() => {
                tracing::warn!(%job, %error, "nor can what it would be made from be read");
            }
            Err(error) => return Err(error),
        }
        let Some(Loss { what, error }) = first_loss(tools, job).await? else {
            tracing::info!(%job, "all objects of the job are there again");
            return Ok(Driven::Went);
        };
        let reason = format!("storage has lost {what}, and it cannot be made again: {error}");
        tracing::error!(%job, reason, "the job has failed");
        let end = JobEnd::Failed { reason };
        tools.ledger.finish(job, self.epoch(), end).await?;
        Ok(Driven::Ended)
    }

    async fn make_again(&mut self, tools: &Tools<'_>) -> Result<(), DriveError> {
        let Tools { ledger, store, .. } = tools;
        let job = self.job();
        let row = job_row(*ledger, job).await?;
        let system = match self.held_steward() {
            Some(steward) => {
                store.put_problem_again(steward.system()).await?;
                self.keep_state_again(store, &row).await?;
                self.steward().system().clone()
            }
            None => store.problem(row.asked.problem).await?.into(),
        };
        let first_state = store.bytes_record(&STATE, self.first_state()).await?;
        let steward = Steward::restore(system, &first_state);
        let mut steward = steward.map_err(|error| DriveError::State(error.to_string()))?;
        let mut stages = ledger.stages(job).await?;
        stages.sort_by_key(|stage| stage.stage);
        let mut wanted = steward.ask();
        keep_again(store, &wanted).await?;
        for stage in stages.iter().filter(|stage| stage.closed) {
            if first_loss(tools, job).await?.is_none() {
                return Ok(());
            }
            if stage.items > tools.policy.held_paths {
                // A stage of this size is not absorbed as a whole, so a job that has one is not replayed.
                return Ok(());
            }
            let work = store.stage(stage.definition).await?.work;
            let results = (stage.stage, stage.items, work);
            (steward, wanted) = absorbed(tools, job, steward, results).await?;
            keep_again(store, &wanted).await?;
        }
        Ok(())
    }

    /// Writes the state of the job again, where the ledger names the state that is held.
    async fn keep_state_again(&mut self, store: &Store, row: &JobRow) -> Result<(), DriveError> {
        let Some(named) = row.snapshot else {
            return Ok(());
        };
        if store.get(named).await.is_err_and(|error| error.is_loss()) {
            let state = self.packed_state().await;
            if digest_of(&state) == named {
                store.put_again(state.into()).await?;
            }
        }
        Ok(())
    }
}

/// Writes the objects of stages that were opened.
async fn keep_again(store: &Store, wanted: &Wanted) -> Result<(), StoreError> {
    for opening in &wanted.open {
        let Opening {
            stage,
            system,
            objects,
        } = opening;
        for points in objects {
            store.put_again(points.to_bytes().into()).await?;
        }
        let mut stage: Stage = stage.clone();
        if let Some(system) = system {
            store.put_problem_again(system).await?;
            stage.system = Some(store.put_problem(system).await?);
        }
        store.put_stage_again(&stage).await?;
    }
    Ok(())
}

async fn job_row(ledger: &dyn Ledger, job: JobId) -> Result<JobRow, LedgerError> {
    ledger.job(job).await?.ok_or(LedgerError::UnknownJob(job))
}

/// First lost object among the problem, the state and the stages of a job, including the objects of its open stages
/// that workers need.
async fn first_loss(tools: &Tools<'_>, job: JobId) -> Result<Option<Loss>, DriveError> {
    let store = tools.store;
    let row = job_row(tools.ledger, job).await?;
    if let Some(loss) = loss_of(store, "the problem".to_owned(), row.asked.problem).await? {
        return Ok(Some(loss));
    }
    if let Some(state) = row.snapshot
        && let Some(loss) = loss_of(store, "the state".to_owned(), state).await?
    {
        return Ok(Some(loss));
    }
    for stage in tools.ledger.stages(job).await? {
        if let Some(loss) = loss_of_stage(store, &stage).await? {
            return Ok(Some(loss));
        }
    }
    Ok(None)
}

async fn loss_of_stage(store: &Store, row: &StageRow) -> Result<Option<Loss>, StoreError> {
    let number = row.stage.0;
    let definition = match store.stage(row.definition).await {
        Ok(definition) => definition,
        Err(error) if error.is_loss() => {
            let what = format!("the definition of stage {number}");
            return Ok(Some(Loss { what, error }));
        }
        Err(error) => return Err(error),
    };
    if row.closed {
        return Ok(None);
    }
    for (what, object) in [
        ("the system", definition.system),
        ("the start points", definition.start_points.object()),
    ] {
        if let Some(object) = object
            && let Some(loss) = loss_of(store, format!("{what} of stage {number}"), object).await?
        {
            return Ok(Some(loss));
        }
    }
    Ok(None)
}

async fn loss_of(store: &Store, what: String, object: Digest) -> Result<Option<Loss>, StoreError> {
    match store.get(object).await {
        Ok(_) => Ok(None),
        Err(error) if error.is_loss() => Ok(Some(Loss { what, error })),
        Err(error) => Err(error),
    }
}
