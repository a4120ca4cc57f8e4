//! Audits: votes on chunks, and what becomes of a worker that was outvoted. Each function is a part
//! of one operation of a commit.

use super::decode::*;
use super::engine::{Connection, Query, Row, query};
use super::leases::{Found, accept, complete, find, release, release_all};
use super::speculation::{drop_elder, drop_elders_of_worker};
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::{HEARD_MS, check_size, tainted};
use std::collections::BTreeSet;

/// Asks for the votes on a chunk.
pub fn votes_on(chunk: ChunkId) -> Query {
    query("SELECT * FROM votes WHERE job = ? AND stage = ? AND first = ? ORDER BY epoch")
        .bind(chunk.job.to_string())
        .bind(chunk.stage.0)
        .bind(signed(chunk.first))
}

/// A vote.
pub fn vote(row: &Row) -> Result<Vote, LedgerError> {
    Ok(Vote {
        epoch: Epoch(number(row, "epoch")?),
        worker: worker(row)?,
        credential: Credential(text(row, "credential")?),
        hash: digest(row, "hash")?,
    })
}

async fn votes(c: &mut Connection, chunk: ChunkId) -> Result<Vec<Vote>, LedgerError> {
    let rows = votes_on(chunk).fetch_all(c).await?;
    rows.iter().map(vote).collect()
}

/// Whether another worker is here that could confirm what this one found.
async fn has_other(
    c: &mut Connection,
    now: LedgerTime,
    who: &WorkerId,
) -> Result<bool, LedgerError> {
    let other = query(
        "SELECT 1 AS one FROM workers o JOIN workers m ON m.worker = ?
         WHERE o.worker <> m.worker AND o.numerics_revision = m.numerics_revision
           AND o.last_seen > ? AND o.draining = 0 AND o.evicted = 0 LIMIT 1",
    )
    .bind(who.as_str())
    .bind(now.0.saturating_sub_unsigned(HEARD_MS))
    .fetch_optional(c)
    .await?;
    Ok(other.is_some())
}

/// Whether a worker of another credential is here that could confirm what this one found.
async fn has_other_credential(
    c: &mut Connection,
    now: LedgerTime,
    who: &WorkerId,
) -> Result<bool, LedgerError> {
    let other = query(
        "SELECT 1 AS one FROM workers o JOIN workers m ON m.worker = ?
         WHERE o.credential <> m.credential AND o.numerics_revision = m.numerics_revision
           AND o.last_seen > ? AND o.draining = 0 AND o.evicted = 0 LIMIT 1",
    )
    .bind(who.as_str())
    .bind(now.0.saturating_sub_unsigned(HEARD_MS))
    .fetch_optional(c)
    .await?;
    Ok(other.is_some())
}

/// One execution of an audited chunk.
pub async fn confirm(
    c: &mut Connection,
    now: LedgerTime,
    lease: LeaseId,
    result: ResultObject,
    why: Confirmation,
) -> Result<Completion, LedgerError> {
    let cpu_micros = check_size("the CPU time of a chunk", result.cpu_micros)?;
    let Some(stored_chunk) = find(c, lease.chunk).await? else {
        return Ok(Completion::Stale);
    };
    let votes = votes(c, lease.chunk).await?;
    let holder = match stored_chunk.state.as_str() {
        "accepted" => None,
        _ => stored_chunk
            .holder(lease)?
            .filter(|_| stored_chunk.items == result.items),
    };
    let Some(holder) = holder else {
        let vote = votes.iter().find(|vote| vote.epoch == lease.epoch);
        return match vote.filter(|_| stored_chunk.state != "accepted") {
            Some(vote) if vote.hash == result.hash => Ok(Completion::Unconfirmed),
            Some(_) => Ok(Completion::HashDiffers),
            None => complete(c, now, lease, result).await,
        };
    };
    if why == Confirmation::Wrong {
        // The leases of the worker end, this one among them.
        evict(c, now, &holder.worker).await?;
        return Ok(Completion::Unconfirmed);
    }
    let is_spared = votes.is_empty()
        && match why {
            Confirmation::Audit => !has_other(c, now, &holder.worker).await?,
            Confirmation::Unchecked => !has_other_credential(c, now, &holder.worker).await?,
            Confirmation::Compare => true,
            Confirmation::Doubt | Confirmation::Wrong => false,
        };
    if is_spared {
        return complete(c, now, lease, result).await;
    }
    let (job, first) = (lease.chunk.job.to_string(), signed(lease.chunk.first));
    query(
        "INSERT INTO votes (job, stage, first, epoch, worker, hash, credential)
         VALUES (?, ?, ?, ?, ?, ?,
                 COALESCE((SELECT credential FROM workers WHERE worker = ?), ''));
         UPDATE chunks SET votes = votes + 1 WHERE job = ? AND stage = ? AND first = ?",
    )
    .bind(&job)
    .bind(lease.chunk.stage.0)
    .bind(first)
    .bind(signed(lease.epoch.0))
    .bind(holder.worker.as_str())
    .bind(result.hash.to_string())
    .bind(holder.worker.as_str())
    .bind(&job)
    .bind(lease.chunk.stage.0)
    .bind(first)
    .execute(&mut *c)
    .await?;
    if !votes.iter().any(|vote| vote.hash == result.hash) {
        // The time of this execution is charged, as for any other. If two workers had the chunk, neither has it now.
        if stored_chunk.state == "leased" {
            let used = Found {
                charged: stored_chunk.charged - cpu_micros,
                ..stored_chunk
            };
            release(c, lease.chunk, &used, 0, false).await?;
        } else {
            charge(c, lease.chunk.job, cpu_micros).await?;
        }
        drop_elder(c, lease.chunk, 0).await?;
        return Ok(Completion::Unconfirmed);
    }
    accept(c, now, lease, &stored_chunk, &holder, &result, cpu_micros).await?;
    for outvoted in votes.iter().filter(|vote| vote.hash != result.hash) {
        evict(c, now, &outvoted.worker).await?;
    }
    Ok(Completion::Accepted)
}

/// Takes a vote away.
pub async fn strike(
    c: &mut Connection,
    now: LedgerTime,
    vote: LeaseId,
    why: Strike,
) -> Result<(), LedgerError> {
    let votes = votes(c, vote.chunk).await?;
    let Some(struck) = votes.iter().find(|cast| cast.epoch == vote.epoch) else {
        return Ok(());
    };
    // Of a chunk that was accepted meanwhile the votes say who confirmed whom.
    let stored_chunk = find(c, vote.chunk).await?;
    if stored_chunk.is_none_or(|chunk| chunk.state == "accepted") {
        return Ok(());
    }
    let (job, first) = (vote.chunk.job.to_string(), signed(vote.chunk.first));
    query(
        "DELETE FROM votes WHERE job = ? AND stage = ? AND first = ? AND epoch = ?;
         UPDATE chunks SET votes = votes - 1 WHERE job = ? AND stage = ? AND first = ?",
    )
    .bind(&job)
    .bind(vote.chunk.stage.0)
    .bind(first)
    .bind(signed(vote.epoch.0))
    .bind(&job)
    .bind(vote.chunk.stage.0)
    .bind(first)
    .execute(&mut *c)
    .await?;
    match why {
        Strike::Wrong => evict(c, now, &struck.worker).await,
        Strike::Lost => Ok(()),
    }
}

/// Adds to the virtual time of a job and its tenant.
async fn charge(c: &mut Connection, job: JobId, micros: i64) -> Result<(), LedgerError> {
    let job = job.to_string();
    query(
        "UPDATE jobs SET virtual_time = virtual_time + ? WHERE job = ?;
         UPDATE tenants SET virtual_time = virtual_time + ?
         WHERE tenant = (SELECT tenant FROM jobs WHERE job = ?)",
    )
    .bind(micros)
    .bind(&job)
    .bind(micros)
    .bind(&job)
    .execute(c)
    .await?;
    Ok(())
}

/// Chunks of unfinished jobs that this worker has done, and for which nobody else has found the same.
const UNCONFIRMED: &str = "
    SELECT c.*, s.closed FROM chunks c
    JOIN stages s ON s.job = c.job AND s.stage = c.stage
    JOIN jobs j ON j.job = c.job
    WHERE c.worker = ? AND c.state = 'accepted' AND j.ended IS NULL
      AND NOT EXISTS (SELECT 1 FROM votes v
                      WHERE v.job = c.job AND v.stage = c.stage AND v.first = c.first
                        AND v.worker <> c.worker AND v.hash = c.hash)
    ORDER BY c.job, c.stage, c.first";

/// Takes a worker's leases, its right to others, and what it alone has found.
pub async fn evict(c: &mut Connection, now: LedgerTime, who: &WorkerId) -> Result<(), LedgerError> {
    query("UPDATE workers SET evicted = 1 WHERE worker = ?")
        .bind(who.as_str())
        .execute(&mut *c)
        .await?;
    let held = query("SELECT * FROM chunks WHERE state = 'leased' AND worker = ?")
        .bind(who.as_str())
        .fetch_all(&mut *c)
        .await?;
    for row in held {
        let chunk = chunk_id(&row)?;
        if let Some(stored_chunk) = find(c, chunk).await? {
            release(c, chunk, &stored_chunk, 0, false).await?;
        }
    }
    drop_elders_of_worker(c, who).await?;
    let (mut used, mut open) = (BTreeSet::new(), Vec::new());
    let rows = query(UNCONFIRMED)
        .bind(who.as_str())
        .fetch_all(&mut *c)
        .await?;
    for row in &rows {
        if number(row, "closed")? != 0 {
            used.insert(job_id(row)?);
        } else {
            open.push(chunk_row(row)?);
        }
    }
    for &job in &used {
        query("UPDATE jobs SET state = 'failed', reason = ?, ended = ? WHERE job = ?")
            .bind(tainted(who))
            .bind(now.0)
            .bind(job.to_string())
            .execute(&mut *c)
            .await?;
        release_all(c, job).await?;
    }
    let mut touched = used.clone();
    for chunk in open.iter().filter(|chunk| !used.contains(&chunk.chunk.job)) {
        reopen(c, chunk).await?;
        drop_elder(c, chunk.chunk, 0).await?;
        touched.insert(chunk.chunk.job);
    }
    for job in touched {
        // The steward of the job has read results that were taken back.
        query(
            "UPDATE jobs SET steward = NULL, steward_epoch = steward_epoch + 1, steward_until = 0
             WHERE job = ?",
        )
        .bind(job.to_string())
        .execute(&mut *c)
        .await?;
    }
    Ok(())
}

/// Takes the result of a finished chunk back.
pub async fn reopen(c: &mut Connection, chunk: &ChunkRow) -> Result<(), LedgerError> {
    let (result, writes) = match &chunk.state {
        ChunkState::Accepted { result, .. } => (result, REOPEN_ACCEPTED),
        ChunkState::Failed { result } => (result, REOPEN_FAILED),
        ChunkState::Ready | ChunkState::Leased { .. } => return Ok(()),
    };
    let (job, stage) = (chunk.chunk.job.to_string(), chunk.chunk.stage.0);
    let items = signed(chunk.items.len());
    // A result that the coordinator itself gave took no time that was counted.
    let cpu_micros = match chunk.state {
        ChunkState::Failed { .. } => 0,
        _ => result.cpu_micros,
    };
    query(writes)
        .bind(&job)
        .bind(stage)
        .bind(signed(chunk.chunk.first))
        .bind(&job)
        .bind(stage)
        .bind(signed(chunk.chunk.first))
        .bind(items)
        .bind(items)
        .bind(signed(cpu_micros))
        .bind(signed(result.outcomes.regular))
        .bind(signed(result.outcomes.singular))
        .bind(signed(result.outcomes.failed))
        .bind(&job)
        .bind(stage)
        .execute(c)
        .await?;
    Ok(())
}

/// The writes that take a result back, of a chunk in this state.
macro_rules! reopen_writes {
    ($state:literal) => {
        concat!(
            "UPDATE chunks SET state = 'ready', worker = NULL, address = NULL, hash = NULL,
                    cpu_micros = NULL, paths_regular = NULL, paths_singular = NULL,
                    paths_failed = NULL, votes = 0
             WHERE job = ? AND stage = ? AND first = ?;
             DELETE FROM votes WHERE job = ? AND stage = ? AND first = ?;
             UPDATE stages SET ready_items = ready_items + ?, ready_chunks = ready_chunks + 1, ",
            $state,
            "_items = ",
            $state,
            "_items - ?, ",
            $state,
            "_chunks = ",
            $state,
            "_chunks - 1, cpu_micros = cpu_micros - ?, paths_regular = paths_regular - ?,
                    paths_singular = paths_singular - ?, paths_failed = paths_failed - ?
             WHERE job = ? AND stage = ?"
        )
    };
}
const REOPEN_ACCEPTED: &str = reopen_writes!("accepted");
const REOPEN_FAILED: &str = reopen_writes!("failed");
