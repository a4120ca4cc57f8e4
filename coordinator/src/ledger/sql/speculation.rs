//! Speculation: late chunks that a second worker gets. Each function is a part of one operation of a
//! commit.

use super::accusations::accuse;
use super::decode::*;
use super::engine::{Connection, query};
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::estimate;

/// Oldest late chunk of the job whose turn it is: `Speculation::is_overdue` in SQL, by the time that the stage's
/// accepted chunks took, or the job's where the stage has none. A chunk under suspicion gets no second victim, and an
/// audited chunk is done twice anyway.
const OVERDUE: &str = "
    SELECT s.*, j.problem, j.tenant, c.first AS chunk_first, c.last AS chunk_last,
           c.epoch AS chunk_epoch
    FROM jobs j
    JOIN tenants t ON t.tenant = j.tenant
    JOIN stages s ON s.job = j.job
    JOIN chunks c ON c.job = s.job AND c.stage = s.stage
    WHERE j.ended IS NULL AND j.state = 'running' AND j.numerics_revision = ?
      AND s.ready_chunks = 0 AND s.leased_chunks > 0 AND ? NOT LIKE '%' || j.job || '%'
      AND c.state = 'leased' AND c.worker <> ?
      AND c.suspicions = 0 AND c.alone = 0 AND c.votes = 0
      AND ? - c.leased_at >= ?
      AND CAST(? - c.leased_at AS DOUBLE PRECISION)
          * (CASE WHEN s.accepted_items > 0 THEN s.accepted_items
             ELSE (SELECT CAST(SUM(m.accepted_items) AS BIGINT) FROM stages m
                   WHERE m.job = s.job) END)
          > CAST(? AS DOUBLE PRECISION) * (c.last - c.first)
          * (CASE WHEN s.accepted_items > 0 THEN s.held_ms
             ELSE (SELECT CAST(SUM(m.held_ms) AS BIGINT) FROM stages m
                   WHERE m.job = s.job) END)
      AND NOT EXISTS (SELECT 1 FROM elders e
                      WHERE e.job = c.job AND e.stage = c.stage AND e.first = c.first)
      AND NOT EXISTS (SELECT 1 FROM workers w WHERE w.worker = ? AND w.evicted = 1)
    ORDER BY t.virtual_time, j.virtual_time, j.number, s.stage, c.leased_at, c.first LIMIT 1";

/// The writes of a second lease, as one exchange: the row becomes its, the lease before it an elder.
const OVERTAKE: &str = "
    INSERT INTO elders (job, stage, first, epoch, worker, leased_at, lease_until)
    SELECT job, stage, first, epoch, worker, leased_at, lease_until FROM chunks
    WHERE job = ? AND stage = ? AND first = ?;
    UPDATE chunks SET epoch = ?, worker = ?, leased_at = ?, lease_until = ?, request = ?,
           charged = charged + ?
    WHERE job = ? AND stage = ? AND first = ?;
    UPDATE stages SET speculative_leases = speculative_leases + 1 WHERE job = ? AND stage = ?;
    UPDATE jobs SET virtual_time = virtual_time + ? WHERE job = ?;
    UPDATE tenants SET virtual_time = virtual_time + ? WHERE tenant = ?";

/// Gives a late chunk to a second worker.
pub async fn speculate(
    c: &mut Connection,
    now: LedgerTime,
    request: &LeaseRequest,
) -> Result<Option<Lease>, LedgerError> {
    let rule = request.speculation;
    if rule.times == 0 {
        return Ok(None);
    }
    let row = query(OVERDUE)
        .bind(request.numerics_revision)
        .bind(request.without_text())
        .bind(request.worker.as_str())
        .bind(now.0)
        .bind(signed(rule.least_ms))
        .bind(now.0)
        .bind(rule.times)
        .bind(request.worker.as_str())
        .fetch_optional(&mut *c)
        .await?;
    let Some(row) = row else {
        return Ok(None);
    };
    let stage = stage_row(&row)?;
    let items = ItemRange {
        first: number(&row, "chunk_first")?,
        last: number(&row, "chunk_last")?,
    };
    let lease = LeaseId {
        chunk: ChunkId {
            job: job_id(&row)?,
            stage: stage.stage,
            first: items.first,
        },
        epoch: Epoch(number(&row, "chunk_epoch")? + 1),
    };
    let charged = estimate(items.len(), &stage);
    let until = now.after_ms(request.duration_ms);
    let job = lease.chunk.job.to_string();
    query(OVERTAKE)
        .bind(&job)
        .bind(stage.stage.0)
        .bind(signed(items.first))
        .bind(signed(lease.epoch.0))
        .bind(request.worker.as_str())
        .bind(now.0)
        .bind(until.0)
        .bind(request.request.as_str())
        .bind(charged)
        .bind(&job)
        .bind(stage.stage.0)
        .bind(signed(items.first))
        .bind(&job)
        .bind(stage.stage.0)
        .bind(charged)
        .bind(&job)
        .bind(charged)
        .bind(row.try_get::<String>("tenant")?)
        .execute(&mut *c)
        .await?;
    Ok(Some(Lease {
        lease,
        items,
        until,
        problem: digest(&row, "problem")?,
        definition: stage.definition,
        alone: false,
        speculative: true,
    }))
}

/// Prolongs the lease before the last of a late chunk; false where this is none, or it has ended.
pub async fn renew_elder(
    c: &mut Connection,
    lease: LeaseId,
    until: LedgerTime,
) -> Result<bool, LedgerError> {
    let done = query(
        "UPDATE elders SET lease_until = ? WHERE job = ? AND stage = ? AND first = ?
         AND epoch = ? AND lease_until IS NOT NULL",
    )
    .bind(until.0)
    .bind(lease.chunk.job.to_string())
    .bind(lease.chunk.stage.0)
    .bind(signed(lease.chunk.first))
    .bind(signed(lease.epoch.0))
    .execute(c)
    .await?;
    Ok(done > 0)
}

/// Ends the lease before the last of this chunk, with `suspicions` new suspicions.
pub async fn drop_elder(
    c: &mut Connection,
    chunk: ChunkId,
    suspicions: u32,
) -> Result<(), LedgerError> {
    let job = chunk.job.to_string();
    query(
        "DELETE FROM elders WHERE job = ? AND stage = ? AND first = ?;
         UPDATE chunks SET suspicions = suspicions + ? WHERE job = ? AND stage = ? AND first = ?",
    )
    .bind(&job)
    .bind(chunk.stage.0)
    .bind(signed(chunk.first))
    .bind(suspicions)
    .bind(&job)
    .bind(chunk.stage.0)
    .bind(signed(chunk.first))
    .execute(c)
    .await?;
    Ok(())
}

/// Ends the leases before the last of all chunks of a job that ends.
pub async fn drop_elders_of_job(c: &mut Connection, job: JobId) -> Result<(), LedgerError> {
    query("DELETE FROM elders WHERE job = ? AND lease_until IS NOT NULL")
        .bind(job.to_string())
        .execute(c)
        .await?;
    Ok(())
}

/// Ends the leases before the last that this worker has.
pub async fn drop_elders_of_worker(c: &mut Connection, who: &WorkerId) -> Result<(), LedgerError> {
    query("DELETE FROM elders WHERE worker = ? AND lease_until IS NOT NULL")
        .bind(who.as_str())
        .execute(c)
        .await?;
    Ok(())
}

/// The leases before the last that have ended by now, each a suspicion.
pub async fn expire_elders(
    c: &mut Connection,
    now: LedgerTime,
) -> Result<Vec<Expired>, LedgerError> {
    let rows = query(
        "SELECT e.*, k.suspicions FROM elders e
         JOIN chunks k ON k.job = e.job AND k.stage = e.stage AND k.first = e.first
         WHERE e.lease_until IS NOT NULL AND e.lease_until <= ? ORDER BY e.job, e.stage, e.first",
    )
    .bind(now.0)
    .fetch_all(&mut *c)
    .await?;
    let mut expired = Vec::with_capacity(rows.len());
    for row in rows {
        let chunk = chunk_id(&row)?;
        let suspicions = accuse(c, now, chunk, &worker(&row)?).await?;
        expired.push(expired_lease(&row, suspicions)?);
        drop_elder(c, chunk, suspicions).await?;
    }
    Ok(expired)
}
