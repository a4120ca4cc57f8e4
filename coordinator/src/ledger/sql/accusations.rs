//! Accusations: which workers died of a chunk, or could not do it. Each function is a part of one
//! operation of a commit.

use super::decode::*;
use super::engine::{Connection, query};
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rules::PRESENT_MS;

/// Remembers that a worker accuses a chunk; how many suspicions more that is. One worker counts once,
/// while others are here that have not tried.
pub async fn accuse(
    c: &mut Connection,
    now: LedgerTime,
    chunk: ChunkId,
    who: &WorkerId,
) -> Result<u32, LedgerError> {
    let job = chunk.job.to_string();
    let updated_rows = query(
        "UPDATE accusations SET times = times + 1
         WHERE job = ? AND stage = ? AND first = ? AND worker = ?",
    )
    .bind(&job)
    .bind(chunk.stage.0)
    .bind(signed(chunk.first))
    .bind(who.as_str())
    .execute(&mut *c)
    .await?;
    if updated_rows == 0 {
        query("INSERT INTO accusations (job, stage, first, worker, times) VALUES (?, ?, ?, ?, 1)")
            .bind(&job)
            .bind(chunk.stage.0)
            .bind(signed(chunk.first))
            .bind(who.as_str())
            .execute(c)
            .await?;
        return Ok(1);
    }
    let other = query(
        "SELECT 1 AS one FROM workers o JOIN jobs j ON j.job = ?
         WHERE o.last_seen > ? AND o.draining = 0 AND o.evicted = 0
           AND o.numerics_revision = j.numerics_revision AND o.worker <> ?
           AND NOT EXISTS (SELECT 1 FROM accusations a WHERE a.job = j.job AND a.stage = ?
                           AND a.first = ? AND a.worker = o.worker) LIMIT 1",
    )
    .bind(&job)
    .bind(now.0.saturating_sub_unsigned(PRESENT_MS))
    .bind(who.as_str())
    .bind(chunk.stage.0)
    .bind(signed(chunk.first))
    .fetch_optional(c)
    .await?;
    Ok(u32::from(other.is_none()))
}

/// Forgets who accuses a chunk that is done or cut.
pub async fn forget(c: &mut Connection, chunk: ChunkId) -> Result<(), LedgerError> {
    query("DELETE FROM accusations WHERE job = ? AND stage = ? AND first = ?")
        .bind(chunk.job.to_string())
        .bind(chunk.stage.0)
        .bind(signed(chunk.first))
        .execute(c)
        .await?;
    Ok(())
}
