//! Drive: a steward's decisions carried out on ledger and store, one step at a time.
//!
//! Objects are written first, then one fenced row; what was not acknowledged
//! may have happened, and doing it again is harmless. A drive that is fenced
//! has another steward by now, and is dropped.

use super::large_stage::{self, Interrupted, LargeStage, Received};
use super::planning::{Planned, STATE, first_chunks};
use super::steward::{Steward, Wanted, next_to_absorb};
use super::tools::{DriveError, Tools};
use crate::chunks::expiry::{SuspectAction, killed_its_worker, suspect_action};
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::{ChunkId, Epoch, JobId, LeaseId};
use crate::ledger::rows::*;
use crate::ledger::{Ledger, LedgerError};
use crate::results::answer::StoredAnswer;
use crate::results::finished::Finished;
use crate::results::store::Store;
use cognate_algorithms::Opening;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_summary::AnySummary;
use cognate_systems::system::System;
use std::collections::HashSet;
use std::sync::Arc;
use tokio::sync::mpsc;

const HERE: &str = "the steward is back before the step ends";

/// A steward that has taken the results of a complete stage as they were read, and what it wants then.
pub(super) async fn absorbed(
    tools: &Tools<'_>,
    job: JobId,
    mut steward: Steward,
    (stage, items, work): (StageId, u64, Work),
) -> Result<(Steward, Wanted), DriveError> {
    let (sender, receiver) = mpsc::channel(1);
    let working = tokio::task::spawn_blocking(move || {
        let wanted = steward.absorb(stage, Received::new(receiver, items));
        (steward, wanted)
    });
    let sent = large_stage::send_all(tools, job, (stage, items, work), sender).await;
    match working.await {
        Ok(taken) => sent.map(|()| taken),
        Err(ended) => match (ended.into_panic(), sent) {
            (cause, Err(error)) if cause.is::<Interrupted>() => Err(error),
            (cause, _) => std::panic::resume_unwind(cause),
        },
    }
}

/// Whether a step of driving a job changed anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driven {
    /// The step did nothing: chunks are with workers, or wait for them.
    Waits,
    /// The step did something: ask again at once.
    Went,
    /// The job has ended.
    Ended,
}

/// A job that this coordinator drives. After an error it is dropped: its state may be ahead of
/// what is written, and is read again.
pub struct Drive {
    job: JobId,
    epoch: Epoch,
    planned: Planned,
    /// Away only while it works on another thread, and after results that it took were lost.
    steward: Option<Steward>,
    /// Nothing was opened yet, or the algorithm is done and the job must be ended.
    pending: Option<Wanted>,
    /// Index of a first stage that is too large to be held in memory.
    large: LargeStage,
    /// Systems that were made for stages and can be read back.
    readable: HashSet<Digest>,
}

impl Drive {
    /// Takes the right to drive a job, where nobody else has it, and the job's state.
    pub async fn take(tools: &Tools<'_>, job: JobId) -> Result<Option<Self>, DriveError> {
        let Tools {
            ledger,
            store,
            who,
            policy,
        } = tools;
        let Some(epoch) = ledger.steward(job, who, policy.steward_ms).await? else {
            return Ok(None);
        };
        match Self::load(*ledger, store, job, epoch).await {
            Ok(drive) => Ok(Some(drive)),
            Err(error) if error.is_permanent() => {
                let reason = error.to_string();
                tracing::error!(%job, reason, "the job cannot be driven");
                ledger.finish(job, epoch, JobEnd::Failed { reason }).await?;
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    async fn load(
        ledger: &dyn Ledger,
        store: &Store,
        job: JobId,
        epoch: Epoch,
    ) -> Result<Self, DriveError> {
        let row = ledger.job(job).await?.ok_or(LedgerError::UnknownJob(job))?;
        let planned = Planned::from_bytes(&row.asked.options)
            .map_err(|error| DriveError::State(error.to_string()))?;
        let system = Arc::new(store.problem(row.asked.problem).await?);
        let state = row.snapshot.unwrap_or(planned.first_state);
        let state = store.bytes_record(&STATE, state).await?;
        let mut steward = Steward::restore(system, &state)
            .map_err(|error| DriveError::State(error.to_string()))?;
        let stages = ledger.stages(job).await?;
        // A state is kept after the algorithm was asked, together with what it opened. So it
        // wants something new only at the beginning and at the end.
        let pending = if stages.iter().all(|stage| stage.closed) {
            Some(steward.ask())
        } else {
            None
        };
        Ok(Self {
            job,
            epoch,
            planned,
            steward: Some(steward),
            pending,
            large: LargeStage::default(),
            readable: HashSet::new(),
        })
    }

    /// The job.
    pub fn job(&self) -> JobId {
        self.job
    }

    /// Epoch of the right to drive the job.
    pub fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// The state that the job began with, as an object.
    pub(super) fn first_state(&self) -> Digest {
        self.planned.first_state
    }

    /// The steward, unless results that it took were lost.
    pub(super) fn held_steward(&self) -> Option<&Steward> {
        self.steward.as_ref()
    }

    /// The record of the job's state.
    pub(super) async fn packed_state(&mut self) -> Vec<u8> {
        self.at_work(|steward| steward.packed_state()).await
    }

    /// The steward with the job's state.
    pub fn steward(&self) -> &Steward {
        self.steward.as_ref().expect(HERE)
    }

    /// Lets the steward work, where it holds nobody up.
    async fn at_work<T: Send + 'static>(
        &mut self,
        work: impl FnOnce(&mut Steward) -> T + Send + 'static,
    ) -> T {
        let mut steward = self.steward.take().expect(HERE);
        let working = tokio::task::spawn_blocking(move || {
            let value = work(&mut steward);
            (steward, value)
        });
        match working.await {
            Ok((steward, value)) => {
                self.steward = Some(steward);
                value
            }
            Err(error) => std::panic::resume_unwind(error.into_panic()),
        }
    }

    /// Ends the right to drive, so that another may begin at once.
    pub async fn give_up(self, tools: &Tools<'_>) -> Result<(), DriveError> {
        tools.ledger.steward(self.job, tools.who, 0).await?;
        Ok(())
    }

    /// Does what can be done now.
    pub async fn step(&mut self, tools: &Tools<'_>) -> Result<Driven, DriveError> {
        match self.try_step(tools).await {
            Err(DriveError::LostResults { chunk, why }) => {
                let driven = self.track_lost_again(tools, chunk, why).await?;
                if self.steward.is_none() && driven == Driven::Went {
                    *self = Self::load(tools.ledger, tools.store, self.job, self.epoch).await?;
                }
                Ok(driven)
            }
            Err(error) if error.is_permanent() => {
                if error.is_loss() {
                    let mended = self.mend(tools).await?;
                    if mended == Driven::Went {
                        // The state may be ahead of what is written.
                        *self = Self::load(tools.ledger, tools.store, self.job, self.epoch).await?;
                    }
                    if mended != Driven::Waits {
                        return Ok(mended);
                    }
                }
                let reason = error.to_string();
                tracing::error!(job = %self.job, reason, "the job has failed");
                let end = JobEnd::Failed { reason };
                tools.ledger.finish(self.job, self.epoch, end).await?;
                Ok(Driven::Ended)
            }
            other => other,
        }
    }

    /// Opens the chunks of a stage again whose results are lost: paths are pure, and workers find the same.
    async fn track_lost_again(
        &mut self,
        tools: &Tools<'_>,
        chunk: ChunkId,
        why: String,
    ) -> Result<Driven, DriveError> {
        let stages = tools.ledger.stages(self.job).await?;
        let row = stages.iter().find(|row| row.stage == chunk.stage);
        let Some(row) = row.filter(|row| !row.closed) else {
            // Results that were absorbed cannot be absorbed again.
            let reason = format!("results that were used before are lost: {why}");
            tracing::error!(job = %self.job, reason, "the job has failed");
            let end = JobEnd::Failed { reason };
            tools.ledger.finish(self.job, self.epoch, end).await?;
            return Ok(Driven::Ended);
        };
        let work = tools.store.stage(row.definition).await?.work;
        for (chunk, why) in large_stage::lost_chunks(tools, self.job, chunk.stage, work).await? {
            tracing::warn!(job = %self.job, ?chunk, why, "results are lost: the chunk is tracked again");
            tools.ledger.reopen(chunk, self.epoch).await?;
        }
        Ok(Driven::Went)
    }

    async fn try_step(&mut self, tools: &Tools<'_>) -> Result<Driven, DriveError> {
        if let Some(wanted) = self.pending.take() {
            return self.carry_out(tools, &[], &wanted).await;
        }
        let stages = tools.ledger.stages(self.job).await?;
        // Asked after the stages were read: if the job is still ours, nobody else moved them.
        let row = tools.ledger.job(self.job).await?;
        if row.is_none_or(|row| row.steward_epoch != self.epoch || row.state.has_ended()) {
            return Err(LedgerError::Fenced(self.job).into());
        }
        let Some(stage) = next_to_absorb(&stages) else {
            return self.judge_suspects(tools).await;
        };
        let work = tools.store.stage(stage.definition).await?.work;
        let (stage, items) = (stage.stage, stage.items);
        let steward = self.steward();
        let is_large = steward.leaves_out()
            || (items > tools.policy.held_paths
                && steward.can_leave_out()
                && stage == steward.first_stage());
        if is_large {
            tracing::info!(job = %self.job, stage = stage.0, items, "absorbing a stage of a large job");
            let (large, steward) = (&mut self.large, &mut self.steward);
            let wanted = large.absorb(tools, self.job, steward, (stage, items, work));
            let wanted = wanted.await?;
            return self.carry_out(tools, &[stage], &wanted).await;
        }
        tracing::info!(job = %self.job, stage = stage.0, items, "absorbing a stage");
        let wanted = self.absorb(tools, (stage, items, work)).await?;
        self.carry_out(tools, &[stage], &wanted).await
    }

    /// Lets the steward take the results of a complete stage as they are read, so that they are never all in memory.
    /// After an error the steward is gone, and its state is to be read again.
    async fn absorb(
        &mut self,
        tools: &Tools<'_>,
        (stage, items, work): (StageId, u64, Work),
    ) -> Result<Wanted, DriveError> {
        let steward = self.steward.take().expect(HERE);
        let results = (stage, items, work);
        let (steward, wanted) = absorbed(tools, self.job, steward, results).await?;
        self.steward = Some(steward);
        Ok(wanted)
    }

    /// Writes what the algorithm wants: objects, then one row.
    async fn carry_out(
        &mut self,
        tools: &Tools<'_>,
        close: &[StageId],
        wanted: &Wanted,
    ) -> Result<Driven, DriveError> {
        let _turn = tools.store.naming().begin();
        let mut step = Advance {
            close: close.to_vec(),
            ..Advance::default()
        };
        for opening in &wanted.open {
            let Opening {
                stage,
                system,
                objects,
            } = opening;
            for points in objects {
                tools.store.put(points.to_bytes().into()).await?;
            }
            let stage = &Stage {
                system: match system {
                    Some(system) => Some(self.keep_system(tools, system).await?),
                    None => None,
                },
                ..stage.clone()
            };
            let items = stage
                .items()
                .ok_or(LedgerError::TooLarge("the number of items of a stage"))?;
            step.open.push(NewStage {
                stage: stage.id,
                definition: tools.store.put_stage(stage).await?,
                items,
                chunks: first_chunks(items),
            });
        }
        if !step.close.is_empty() || !step.open.is_empty() {
            let state = self.packed_state().await;
            step.snapshot = Some(tools.store.put(state.into()).await?);
            for stage in &step.open {
                let (number, items) = (stage.stage.0, stage.items);
                tracing::info!(job = %self.job, stage = number, items, "opening a stage");
            }
            tools.ledger.advance(self.job, self.epoch, step).await?;
        }
        if wanted.done {
            if let Err(error) = self.finish(tools).await {
                // The stage is closed; only the end is to be written again.
                self.pending = Some(Wanted {
                    open: Vec::new(),
                    done: true,
                });
                return if error.is_permanent() || error.is_fenced() {
                    Err(error)
                } else {
                    tracing::warn!(job = %self.job, %error, "the job's end is written again");
                    Ok(Driven::Waits)
                };
            }
            return Ok(Driven::Ended);
        }
        Ok(Driven::Went)
    }

    /// Keeps a system that was made for a stage. What no worker could read ends the job here.
    async fn keep_system(
        &mut self,
        tools: &Tools<'_>,
        system: &System,
    ) -> Result<Digest, DriveError> {
        let digest = tools.store.put_problem(system).await?;
        if !self.readable.contains(&digest) {
            tools.store.problem(digest).await?;
            self.readable.insert(digest);
        }
        Ok(digest)
    }

    async fn finish(&mut self, tools: &Tools<'_>) -> Result<(), DriveError> {
        let Tools { ledger, store, .. } = tools;
        if let Some(reason) = self.steward().failure() {
            tracing::warn!(job = %self.job, reason, "the job has no answer");
            return Ok(ledger
                .finish(self.job, self.epoch, JobEnd::Failed { reason })
                .await?);
        }
        let row = ledger.job(self.job).await?;
        let row = row.ok_or(LedgerError::UnknownJob(self.job))?;
        let stages = ledger.stages(self.job).await?;
        let workers = ledger.contributions(self.job).await?;
        let now = ledger.now().await?;
        let answer = self.at_work(|steward| steward.answer()).await;
        let answer = answer.ok_or_else(|| DriveError::State("it has no answer".into()))?;
        let about = Finished {
            job: &row,
            planned: &self.planned,
            stages: &stages,
            workers: &workers,
            now,
        };
        let summary = AnySummary::new(&answer, &about.about());
        let solutions = StoredAnswer::put(answer, store).await?;
        let summary = store.put(summary.to_json().into()).await?;
        let end = JobEnd::Solved { solutions, summary };
        ledger.finish(self.job, self.epoch, end).await?;
        tracing::info!(job = %self.job, "the job is solved");
        Ok(())
    }

    /// Splits the chunks that no worker survives, down to the path at fault.
    async fn judge_suspects(&self, tools: &Tools<'_>) -> Result<Driven, DriveError> {
        let Tools {
            ledger,
            store,
            policy,
            ..
        } = tools;
        let mut suspects = Vec::new();
        let limit = policy.suspicion_limit;
        // Two questions, so that the clock is asked only where there is a suspect.
        let any = LedgerTime(i64::MAX);
        if !ledger.suspects(self.job, limit, any).await?.is_empty() {
            // A worker that could not be heard, but lives, has a lease's time to ask for work again.
            let until = LedgerTime(
                ledger
                    .now()
                    .await?
                    .0
                    .saturating_sub_unsigned(policy.lease_ms),
            );
            suspects = ledger.suspects(self.job, limit, until).await?;
        }
        for suspect in &suspects {
            let (chunk, items) = (suspect.chunk, suspect.items);
            match suspect_action(suspect, policy) {
                SuspectAction::Split(pieces) => {
                    let pieces_count = pieces.len();
                    tracing::warn!(job = %self.job, ?items, pieces_count,
                        "workers die of this chunk: it is split");
                    ledger.split(chunk, self.epoch, &pieces).await?;
                }
                SuspectAction::FailItem => {
                    let stages = ledger.stages(self.job).await?;
                    let row = stages.iter().find(|s| s.stage == chunk.stage);
                    let row = row.ok_or_else(|| {
                        LedgerError::Damaged("a chunk without its stage".to_owned())
                    })?;
                    let stage = store.stage(row.definition).await?;
                    let results = (items.first..items.last)
                        .map(|item| killed_its_worker(&stage, item))
                        .collect();
                    tracing::warn!(job = %self.job, ?items, "workers die of this path: it failed");
                    // No worker ever has this epoch of the chunk: leases begin above the last.
                    let verdict_lease = LeaseId {
                        chunk,
                        epoch: Epoch(suspect.epoch.0 + 1),
                    };
                    let object = store.put_results(verdict_lease, items, results, 0).await?;
                    ledger.fail_item(chunk, self.epoch, object).await?;
                }
            }
        }
        Ok(if suspects.is_empty() {
            Driven::Waits
        } else {
            Driven::Went
        })
    }
}
