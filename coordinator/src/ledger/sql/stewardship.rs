//! Writes of clients and stewards: jobs and stages. Each function is one operation of a commit.

use super::accusations::forget;
use super::audit;
use super::decode::*;
use super::engine::{Connection, query};
use super::leases::{insert_ready, release_all};
use super::removal::deleted;
use super::speculation::drop_elder;
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::{check_size, first_virtual_time, make_up};
use cognate_continuation::work::StageId;
use std::collections::BTreeSet;

async fn job(c: &mut Connection, job: JobId) -> Result<Option<JobRow>, LedgerError> {
    let row = query("SELECT * FROM jobs WHERE job = ?")
        .bind(job.to_string())
        .fetch_optional(&mut *c)
        .await?;
    row.as_ref().map(job_row).transpose()
}

/// The job, if this epoch is its steward's and it has not ended.
async fn fenced(c: &mut Connection, id: JobId, epoch: Epoch) -> Result<JobRow, LedgerError> {
    let job_row = job(c, id).await?.ok_or(LedgerError::UnknownJob(id))?;
    if job_row.steward_epoch != epoch || job_row.state.has_ended() {
        return Err(LedgerError::Fenced(id));
    }
    Ok(job_row)
}

/// Remembers a job.
pub async fn submit(
    c: &mut Connection,
    now: LedgerTime,
    request: RequestId,
    asked: NewJob,
) -> Result<Submitted, LedgerError> {
    let id = JobId::of_request(&request);
    if let Some(before) = job(c, id).await? {
        let same = query("SELECT 1 FROM jobs WHERE job = ? AND request = ?")
            .bind(id.to_string())
            .bind(request.as_str())
            .fetch_optional(&mut *c)
            .await?;
        if before.asked != asked || same.is_none() {
            return Err(LedgerError::RequestReused(request));
        }
        return Ok(Submitted {
            job: id,
            is_new: false,
        });
    }
    if deleted(id).fetch_optional(&mut *c).await?.is_some() {
        return Err(LedgerError::RequestOfDeleted(request));
    }
    // Nobody saves up virtual time while he has no jobs.
    let row = query(
        "SELECT (SELECT COALESCE(MAX(number), 0) + 1 FROM jobs) AS number,
                (SELECT MIN(t.virtual_time) FROM jobs j JOIN tenants t ON t.tenant = j.tenant
                 WHERE j.ended IS NULL) AS floor,
                (SELECT virtual_time FROM tenants WHERE tenant = ?) AS own,
                (SELECT MIN(virtual_time) FROM jobs
                 WHERE ended IS NULL AND tenant = ?) AS same_tenant,
                (SELECT MAX(virtual_time) FROM jobs
                 WHERE ended IS NULL AND started IS NULL AND tenant = ?) AS waiting",
    )
    .bind(asked.tenant.as_str())
    .bind(asked.tenant.as_str())
    .bind(asked.tenant.as_str())
    .fetch_one(&mut *c)
    .await?;
    let floor: Option<i64> = row.try_get("floor")?;
    let previous_time: Option<i64> = row.try_get("own")?;
    let same_tenant: Option<i64> = row.try_get("same_tenant")?;
    let waiting: Option<i64> = row.try_get("waiting")?;
    let previous_time = previous_time.unwrap_or(0);
    query(
        "INSERT INTO tenants (tenant, virtual_time) VALUES (?, ?)
         ON CONFLICT (tenant) DO UPDATE SET virtual_time = excluded.virtual_time",
    )
    .bind(asked.tenant.as_str())
    .bind(floor.map_or(previous_time, |floor| previous_time.max(floor)))
    .execute(&mut *c)
    .await?;
    query(
        "INSERT INTO jobs (job, number, request, tenant, label, problem, options,
                numerics_revision, state, submitted, steward_epoch, steward_until, virtual_time,
                leased_chunks)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, 'queued', ?, 0, 0, ?, 0)",
    )
    .bind(id.to_string())
    .bind(row.try_get::<i64>("number")?)
    .bind(request.as_str())
    .bind(asked.tenant.as_str())
    .bind(asked.label)
    .bind(asked.problem.to_string())
    .bind(to_hex(&asked.options))
    .bind(asked.numerics_revision)
    .bind(now.0)
    .bind(first_virtual_time(same_tenant, waiting))
    .execute(&mut *c)
    .await?;
    Ok(Submitted {
        job: id,
        is_new: true,
    })
}

/// Cancels a job.
pub async fn cancel(
    c: &mut Connection,
    now: LedgerTime,
    id: JobId,
    reason: String,
) -> Result<Cancelled, LedgerError> {
    let job_row = job(c, id).await?.ok_or(LedgerError::UnknownJob(id))?;
    if job_row.state.has_ended() {
        return Ok(Cancelled::HadEnded(job_row.state));
    }
    query("UPDATE jobs SET state = 'cancelled', reason = ?, ended = ? WHERE job = ?")
        .bind(reason)
        .bind(now.0)
        .bind(id.to_string())
        .execute(&mut *c)
        .await?;
    release_all(c, id).await?;
    Ok(Cancelled::Now)
}

/// Takes or keeps the right to drive a job.
pub async fn steward(
    c: &mut Connection,
    now: LedgerTime,
    id: JobId,
    who: CoordinatorId,
    duration_ms: u64,
) -> Result<Option<Epoch>, LedgerError> {
    let job_row = job(c, id).await?.ok_or(LedgerError::UnknownJob(id))?;
    let held = job_row.steward_until > now;
    let mine = job_row.steward.as_ref() == Some(&who);
    if job_row.state.has_ended() || (held && !mine) {
        return Ok(None);
    }
    let mut epoch = job_row.steward_epoch;
    if !held || !mine {
        epoch.0 += 1;
    }
    query("UPDATE jobs SET steward = ?, steward_epoch = ?, steward_until = ? WHERE job = ?")
        .bind(who.as_str())
        .bind(i64::try_from(epoch.0).map_err(|_| LedgerError::TooLarge("the steward's epoch"))?)
        .bind(now.after_ms(duration_ms).0)
        .bind(id.to_string())
        .execute(&mut *c)
        .await?;
    Ok(Some(epoch))
}

/// Keeps all rights to drive jobs that a coordinator has.
pub async fn renew_all(
    c: &mut Connection,
    now: LedgerTime,
    who: CoordinatorId,
    duration_ms: u64,
) -> Result<(), LedgerError> {
    query(
        "UPDATE jobs SET steward_until = ?
         WHERE ended IS NULL AND steward = ? AND steward_until > ?",
    )
    .bind(now.after_ms(duration_ms).0)
    .bind(who.as_str())
    .bind(now.0)
    .execute(c)
    .await?;
    Ok(())
}

/// Closes and opens stages.
pub async fn advance(
    c: &mut Connection,
    id: JobId,
    epoch: Epoch,
    step: Advance,
) -> Result<(), LedgerError> {
    fenced(c, id, epoch).await?;
    let rows = query("SELECT * FROM stages WHERE job = ?")
        .bind(id.to_string())
        .fetch_all(&mut *c)
        .await?;
    let stages: Vec<StageRow> = rows.iter().map(stage_row).collect::<Result<_, _>>()?;
    for &close in &step.close {
        let stage = stages.iter().find(|s| s.stage == close);
        if !stage.is_some_and(|s| !s.closed && s.is_complete()) {
            return Err(LedgerError::StageOrder(id, close));
        }
    }
    let mut stage_ids: BTreeSet<StageId> = stages.iter().map(|s| s.stage).collect();
    for new in &step.open {
        check_size("the number of items of a stage", new.items)?;
        let whole = ItemRange {
            first: 0,
            last: new.items,
        };
        if !stage_ids.insert(new.stage) || !make_up(new.chunks.iter().copied(), whole) {
            return Err(LedgerError::StageOrder(id, new.stage));
        }
    }
    for close in &step.close {
        query("UPDATE stages SET closed = 1 WHERE job = ? AND stage = ?")
            .bind(id.to_string())
            .bind(close.0)
            .execute(&mut *c)
            .await?;
    }
    for new in &step.open {
        let items = check_size("the number of items of a stage", new.items)?;
        query(
            "INSERT INTO stages (job, stage, definition, items, closed, ready_items,
                    ready_chunks, leased_items, leased_chunks, accepted_items, accepted_chunks,
                    failed_items, failed_chunks, cpu_micros, paths_regular, paths_singular,
                    paths_failed)
             VALUES (?, ?, ?, ?, 0, ?, ?, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)",
        )
        .bind(id.to_string())
        .bind(new.stage.0)
        .bind(new.definition.to_string())
        .bind(items)
        .bind(items)
        .bind(i64::try_from(new.chunks.len()).unwrap_or(i64::MAX))
        .execute(&mut *c)
        .await?;
        for &items in &new.chunks {
            let chunk = ChunkRow {
                chunk: ChunkId {
                    job: id,
                    stage: new.stage,
                    first: items.first,
                },
                items,
                state: ChunkState::Ready,
                epoch: Epoch(0),
                suspicions: 0,
                alone: false,
            };
            insert_ready(c, &chunk).await?;
        }
    }
    let snapshot = step.snapshot.map(|digest| digest.to_string());
    let opened = i64::from(!step.open.is_empty());
    query(
        "UPDATE jobs SET snapshot = COALESCE(?, snapshot),
                state = CASE WHEN ? = 1 THEN 'running' ELSE state END
         WHERE job = ?",
    )
    .bind(snapshot)
    .bind(opened)
    .bind(id.to_string())
    .execute(&mut *c)
    .await?;
    Ok(())
}

async fn ready_chunk(c: &mut Connection, chunk: ChunkId) -> Result<Option<ChunkRow>, LedgerError> {
    let row =
        query("SELECT * FROM chunks WHERE job = ? AND stage = ? AND first = ? AND state = 'ready'")
            .bind(chunk.job.to_string())
            .bind(chunk.stage.0)
            .bind(i64::try_from(chunk.first).unwrap_or(i64::MAX))
            .fetch_optional(&mut *c)
            .await?;
    row.as_ref().map(chunk_row).transpose()
}

/// Cuts a ready chunk into pieces.
pub async fn split(
    c: &mut Connection,
    chunk: ChunkId,
    epoch: Epoch,
    pieces: Vec<Piece>,
) -> Result<(), LedgerError> {
    fenced(c, chunk.job, epoch).await?;
    let whole = ready_chunk(c, chunk)
        .await?
        .filter(|whole| make_up(pieces.iter().map(|p| p.items), whole.items))
        .ok_or(LedgerError::NotAPartition(chunk.job))?;
    for statement in [
        "DELETE FROM accusations WHERE job = ? AND stage = ? AND first = ?",
        "DELETE FROM votes WHERE job = ? AND stage = ? AND first = ?",
        "DELETE FROM elders WHERE job = ? AND stage = ? AND first = ?",
        "DELETE FROM chunks WHERE job = ? AND stage = ? AND first = ?",
    ] {
        query(statement)
            .bind(chunk.job.to_string())
            .bind(chunk.stage.0)
            .bind(i64::try_from(chunk.first).unwrap_or(i64::MAX))
            .execute(&mut *c)
            .await?;
    }
    for piece in &pieces {
        let mut row = whole.clone();
        row.chunk.first = piece.items.first;
        row.items = piece.items;
        row.suspicions = piece.suspicions;
        row.alone = piece.alone;
        insert_ready(c, &row).await?;
    }
    query("UPDATE stages SET ready_chunks = ready_chunks - 1 + ? WHERE job = ? AND stage = ?")
        .bind(i64::try_from(pieces.len()).unwrap_or(i64::MAX))
        .bind(chunk.job.to_string())
        .bind(chunk.stage.0)
        .execute(&mut *c)
        .await?;
    Ok(())
}

/// Settles a ready chunk with the coordinator's own verdict.
pub async fn fail_item(
    c: &mut Connection,
    chunk: ChunkId,
    epoch: Epoch,
    result: ResultObject,
) -> Result<(), LedgerError> {
    fenced(c, chunk.job, epoch).await?;
    let cpu_micros = check_size("the CPU time of a chunk", result.cpu_micros)?;
    ready_chunk(c, chunk)
        .await?
        .filter(|chunk_row| chunk_row.items == result.items)
        .ok_or(LedgerError::NotAPartition(chunk.job))?;
    let items = i64::try_from(result.items.len()).unwrap_or(i64::MAX);
    let count = |value: u64| i64::try_from(value).unwrap_or(i64::MAX);
    query(
        "UPDATE chunks SET state = 'failed', address = ?, hash = ?, cpu_micros = ?,
                paths_regular = ?, paths_singular = ?, paths_failed = ?
         WHERE job = ? AND stage = ? AND first = ?;
         UPDATE stages SET ready_items = ready_items - ?, ready_chunks = ready_chunks - 1,
                failed_items = failed_items + ?, failed_chunks = failed_chunks + 1,
                paths_regular = paths_regular + ?, paths_singular = paths_singular + ?,
                paths_failed = paths_failed + ?
         WHERE job = ? AND stage = ?",
    )
    .bind(result.address.as_str())
    .bind(result.hash.to_string())
    .bind(cpu_micros)
    .bind(count(result.outcomes.regular))
    .bind(count(result.outcomes.singular))
    .bind(count(result.outcomes.failed))
    .bind(chunk.job.to_string())
    .bind(chunk.stage.0)
    .bind(count(chunk.first))
    .bind(items)
    .bind(items)
    .bind(count(result.outcomes.regular))
    .bind(count(result.outcomes.singular))
    .bind(count(result.outcomes.failed))
    .bind(chunk.job.to_string())
    .bind(chunk.stage.0)
    .execute(&mut *c)
    .await?;
    forget(c, chunk).await?;
    drop_elder(c, chunk, 0).await
}

/// Takes the result of a finished chunk of an open stage back.
pub async fn reopen(c: &mut Connection, chunk: ChunkId, epoch: Epoch) -> Result<(), LedgerError> {
    fenced(c, chunk.job, epoch).await?;
    let row = query(
        "SELECT c.*, s.closed FROM chunks c JOIN stages s ON s.job = c.job AND s.stage = c.stage
         WHERE c.job = ? AND c.stage = ? AND c.first = ?",
    )
    .bind(chunk.job.to_string())
    .bind(chunk.stage.0)
    .bind(signed(chunk.first))
    .fetch_optional(&mut *c)
    .await?;
    let Some(row) = row else {
        return Ok(());
    };
    if number(&row, "closed")? != 0 {
        return Err(LedgerError::StageOrder(chunk.job, chunk.stage));
    }
    audit::reopen(c, &chunk_row(&row)?).await?;
    drop_elder(c, chunk, 0).await
}

/// Ends a job.
pub async fn finish(
    c: &mut Connection,
    now: LedgerTime,
    id: JobId,
    epoch: Epoch,
    end: JobEnd,
) -> Result<(), LedgerError> {
    fenced(c, id, epoch).await?;
    let (state, reason, solutions, summary) = match end {
        JobEnd::Solved { solutions, summary } => (
            JobState::Solved,
            None,
            Some(solutions.to_string()),
            Some(summary.to_string()),
        ),
        JobEnd::Failed { reason } => (JobState::Failed, Some(reason), None, None),
    };
    query(
        "UPDATE jobs SET state = ?, reason = ?, ended = ?, solutions = ?, summary = ?
         WHERE job = ?",
    )
    .bind(state.name())
    .bind(reason)
    .bind(now.0)
    .bind(solutions)
    .bind(summary)
    .bind(id.to_string())
    .execute(&mut *c)
    .await?;
    release_all(c, id).await
}
