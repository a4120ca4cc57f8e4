//! Writes of workers: leases and their ends. Each function is one operation of a commit.

use super::accusations::{accuse, forget};
use super::decode::*;
use super::engine::{Connection, Row, query};
use super::speculation::{drop_elder, drop_elders_of_job, expire_elders, renew_elder, speculate};
use crate::chunks::sizing::Situation;
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::{HEARD_MS, PRESENT_MS, check_size, estimate};

/// The row of a chunk, as far as the operations here need it.
pub struct Found {
    pub items: ItemRange,
    pub state: String,
    pub epoch: Epoch,
    pub charged: i64,
    pub elder: Option<Elder>,
    pub row: Row,
}

impl Found {
    /// The worker that may report under this lease; `None` where the lease has ended, or the chunk has a result.
    pub fn holder(&self, lease: LeaseId) -> Result<Option<Holder>, LedgerError> {
        let stands = |elder: &&Elder| elder.epoch == lease.epoch && elder.until.is_some();
        if let Some(elder) = self.elder.as_ref().filter(stands) {
            return Ok(Some(Holder {
                worker: elder.worker.clone(),
                leased_at: Some(elder.leased_at),
                is_elder: true,
            }));
        }
        if self.state != "leased" || self.epoch != lease.epoch {
            return Ok(None);
        }
        let leased_at: Option<i64> = self.row.try_get("leased_at")?;
        Ok(Some(Holder {
            worker: worker(&self.row)?,
            leased_at: leased_at.map(LedgerTime),
            is_elder: false,
        }))
    }
}

/// One chunk.
pub async fn find(c: &mut Connection, chunk: ChunkId) -> Result<Option<Found>, LedgerError> {
    let row = query(
        "SELECT c.*, e.epoch AS elder_epoch, e.worker AS elder_worker,
                e.leased_at AS elder_leased_at, e.lease_until AS elder_until
         FROM chunks c
         LEFT JOIN elders e ON e.job = c.job AND e.stage = c.stage AND e.first = c.first
         WHERE c.job = ? AND c.stage = ? AND c.first = ?",
    )
    .bind(chunk.job.to_string())
    .bind(chunk.stage.0)
    .bind(signed(chunk.first))
    .fetch_optional(&mut *c)
    .await?;
    row.map(|row| {
        Ok(Found {
            elder: elder(&row)?,
            items: items(&row)?,
            state: row.try_get("state")?,
            epoch: Epoch(number(&row, "epoch")?),
            charged: row.try_get("charged")?,
            row,
        })
    })
    .transpose()
}

/// Gives chunks out.
pub async fn lease(
    c: &mut Connection,
    now: LedgerTime,
    request: LeaseRequest,
) -> Result<Vec<Lease>, LedgerError> {
    let until = now.after_ms(request.duration_ms);
    acquit(c, request.request.session()).await?;
    let held = query(
        "SELECT c.job, c.stage, c.first, c.last, c.epoch, c.alone, c.request, j.problem,
                s.definition
         FROM chunks c JOIN jobs j ON j.job = c.job
                       JOIN stages s ON s.job = c.job AND s.stage = c.stage
         WHERE c.state = 'leased' AND c.worker = ? ORDER BY c.job, c.stage, c.first",
    )
    .bind(request.worker.as_str())
    .fetch_all(&mut *c)
    .await?;
    let mut repeated_leases = Vec::new();
    let mut holds_alone = false;
    for row in &held {
        let alone = number(row, "alone")? != 0;
        holds_alone |= alone;
        let asked: Option<String> = row.try_get("request")?;
        if asked.as_deref() != Some(request.request.as_str()) {
            continue;
        }
        let chunk = chunk_id(row)?;
        set_lease_end(c, chunk, until).await?;
        repeated_leases.push(Lease {
            lease: LeaseId {
                chunk,
                epoch: Epoch(number(row, "epoch")?),
            },
            items: items(row)?,
            until,
            problem: digest(row, "problem")?,
            definition: digest(row, "definition")?,
            alone,
            speculative: false,
        });
    }
    if !repeated_leases.is_empty() || holds_alone || request.slots == 0 {
        return Ok(repeated_leases);
    }
    let mut leases: Vec<Lease> = Vec::new();
    while leases.len() < request.slots as usize && !leases.last().is_some_and(|l| l.alone) {
        match lease_one(c, now, &request).await? {
            Some(lease) => leases.push(lease),
            None => break,
        }
    }
    if leases.is_empty() && held.is_empty() {
        leases.extend(speculate(c, now, &request).await?);
    }
    if leases.is_empty() && is_evicted(c, &request.worker).await? {
        return Err(LedgerError::Evicted(request.worker));
    }
    Ok(leases)
}

/// Takes the suspicions back that rest on the silence of a session that speaks.
async fn acquit(c: &mut Connection, session: &str) -> Result<(), LedgerError> {
    // Names are visible ASCII, so that every one that begins so is below this one.
    let end = format!("{session}\u{7f}");
    query(
        "UPDATE chunks SET request = NULL, lease_until = NULL,
                suspicions = CASE WHEN suspicions > 0 THEN suspicions - 1 ELSE 0 END
         WHERE state = 'ready' AND request IS NOT NULL AND request >= ? AND request < ?",
    )
    .bind(session)
    .bind(end)
    .execute(c)
    .await?;
    Ok(())
}

/// Chooses the next chunk: the first of the job with the least virtual time, within the tenant with the least virtual
/// time; with the threads of all other workers and the number of running jobs. A chunk under suspicion goes to a
/// worker that has been here for a lease's time and has not tried it, if there is one. A chunk with votes goes to a
/// worker of another credential if one is here, else of another name, else to the only worker. A chunk whose votes
/// differ goes to another credential only; the coordinator decides meanwhile.
const CHOOSE: &str = "
    SELECT s.*, j.problem, j.tenant, c.first AS chunk_first, c.last AS chunk_last,
           c.epoch AS chunk_epoch, c.alone AS chunk_alone, c.votes AS chunk_votes,
           c.suspicions AS chunk_suspicions,
           (SELECT CAST(COALESCE(SUM(threads), 0) AS BIGINT) FROM workers
            WHERE last_seen > ? AND draining = 0 AND evicted = 0 AND worker <> ?)
           AS other_threads,
           (SELECT COUNT(*) FROM jobs r
            WHERE r.ended IS NULL AND r.state = 'running') AS running_jobs
    FROM jobs j
    JOIN tenants t ON t.tenant = j.tenant
    JOIN stages s ON s.job = j.job
    JOIN chunks c ON c.job = s.job AND c.stage = s.stage
     AND c.first = (SELECT MIN(r.first) FROM chunks r
                    WHERE r.job = s.job AND r.stage = s.stage AND r.state = 'ready'
                      AND r.suspicions < ?
                      AND (r.suspicions = 0
                           OR (EXISTS (SELECT 1 FROM workers m
                                       WHERE m.worker = ? AND m.first_seen <= ?)
                               AND NOT EXISTS (SELECT 1 FROM accusations a
                                               WHERE a.job = r.job AND a.stage = r.stage
                                                 AND a.first = r.first AND a.worker = ?))
                           OR NOT EXISTS (SELECT 1 FROM workers p WHERE p.last_seen > ?
                                          AND p.first_seen <= ? AND p.draining = 0
                                          AND p.evicted = 0 AND p.numerics_revision = ?
                                          AND p.worker <> ?
                                          AND NOT EXISTS (SELECT 1 FROM accusations a
                                              WHERE a.job = r.job AND a.stage = r.stage
                                                AND a.first = r.first
                                                AND a.worker = p.worker)))
                      AND (r.votes = 0
                           OR (r.votes < 2
                               AND NOT EXISTS (SELECT 1 FROM workers o WHERE o.last_seen > ?
                                               AND o.draining = 0 AND o.evicted = 0
                                               AND o.numerics_revision = ? AND o.worker <> ?))
                           OR (NOT EXISTS (SELECT 1 FROM votes v WHERE v.job = r.job
                                           AND v.stage = r.stage AND v.first = r.first
                                           AND v.worker = ?)
                               AND (NOT EXISTS (SELECT 1 FROM votes v JOIN workers m
                                                ON m.worker = ?
                                                WHERE v.job = r.job AND v.stage = r.stage
                                                  AND v.first = r.first
                                                  AND v.credential = m.credential)
                                    OR (r.votes < 2
                                        AND NOT EXISTS (SELECT 1 FROM workers p
                                            WHERE p.last_seen > ? AND p.draining = 0
                                              AND p.evicted = 0 AND p.numerics_revision = ?
                                              AND NOT EXISTS (SELECT 1 FROM votes v
                                                  WHERE v.job = r.job AND v.stage = r.stage
                                                    AND v.first = r.first
                                                    AND v.credential = p.credential)))))))
    WHERE j.ended IS NULL AND j.state = 'running' AND j.numerics_revision = ?
      AND j.leased_chunks < ? AND s.ready_chunks > 0 AND ? NOT LIKE '%' || j.job || '%'
      AND NOT EXISTS (SELECT 1 FROM workers e WHERE e.worker = ? AND e.evicted = 1)
    ORDER BY t.virtual_time, j.virtual_time, j.number, s.stage LIMIT 1";

/// The writes of one lease; together they are one exchange with the engine's thread, which costs
/// more than a statement.
macro_rules! lease_writes {
    () => {
        "UPDATE chunks SET last = ?, state = 'leased', epoch = ?, worker = ?, leased_at = ?,
                lease_until = ?, request = ?, charged = ?
         WHERE job = ? AND stage = ? AND first = ?;
         UPDATE stages SET ready_items = ready_items - ?, ready_chunks = ready_chunks - ?,
                leased_items = leased_items + ?, leased_chunks = leased_chunks + 1
         WHERE job = ? AND stage = ?;
         UPDATE jobs SET started = COALESCE(started, ?), virtual_time = virtual_time + ?,
                leased_chunks = leased_chunks + 1
         WHERE job = ?;
         UPDATE tenants SET virtual_time = virtual_time + ? WHERE tenant = ?"
    };
}
/// Writes of a lease of a part of a chunk: first the rest becomes a chunk of its own.
const CUT_AND_LEASE: &str = concat!(
    "INSERT INTO chunks (job, stage, first, last, state, epoch, suspicions, alone, charged)
     SELECT job, stage, ?, last, 'ready', epoch, suspicions, alone, 0 FROM chunks
     WHERE job = ? AND stage = ? AND first = ?;",
    lease_writes!()
);

/// The part of a ready chunk that a worker gets.
struct Allotment {
    lease: LeaseId,
    items: ItemRange,
    /// The rest of the chunk stays ready, as a chunk of its own.
    is_cut: bool,
    /// Estimated CPU time of the items in microseconds, charged to the job and its tenant.
    charged: i64,
    until: LedgerTime,
}

impl Allotment {
    /// Items by the sizing of the request, out of the chunk in a row of `CHOOSE`.
    fn of_row(
        row: &Row,
        stage: &StageRow,
        now: LedgerTime,
        request: &LeaseRequest,
    ) -> Result<Self, LedgerError> {
        let chunk = ChunkId {
            job: job_id(row)?,
            stage: stage.stage,
            first: number(row, "chunk_first")?,
        };
        let last = number(row, "chunk_last")?;
        let wanted = request.sizing.items(&Situation {
            ready_items: stage.ready.items,
            done_items: stage.accepted.items,
            done_micros: stage.cpu_micros,
            threads: u64::from(request.threads),
            all_threads: number(row, "other_threads")? + u64::from(request.threads),
            jobs: number(row, "running_jobs")?,
        });
        let sized = chunk.first.saturating_add(wanted).min(last);
        // A chunk that was voted on, or is suspected, is given out whole.
        let is_whole = number(row, "chunk_votes")? != 0 || number(row, "chunk_suspicions")? != 0;
        let is_cut = sized < last && !is_whole;
        let items = ItemRange {
            first: chunk.first,
            last: if is_cut { sized } else { last },
        };
        let epoch = Epoch(number(row, "chunk_epoch")? + 1);
        Ok(Self {
            lease: LeaseId { chunk, epoch },
            items,
            is_cut,
            charged: estimate(items.len(), stage),
            until: now.after_ms(request.duration_ms),
        })
    }
}

async fn lease_one(
    c: &mut Connection,
    now: LedgerTime,
    request: &LeaseRequest,
) -> Result<Option<Lease>, LedgerError> {
    let Some(row) = next_ready_chunk(c, now, request).await? else {
        return Ok(None);
    };
    let stage = stage_row(&row)?;
    let allotment = Allotment::of_row(&row, &stage, now, request)?;
    let tenant = row.try_get::<String>("tenant")?;
    write_lease(c, now, request, &allotment, tenant).await?;
    Ok(Some(Lease {
        lease: allotment.lease,
        items: allotment.items,
        until: allotment.until,
        problem: digest(&row, "problem")?,
        definition: stage.definition,
        alone: number(&row, "chunk_alone")? != 0,
        speculative: false,
    }))
}

/// The ready chunk whose turn it is, with its job, stage and the fleet.
async fn next_ready_chunk(
    c: &mut Connection,
    now: LedgerTime,
    request: &LeaseRequest,
) -> Result<Option<Row>, LedgerError> {
    query(CHOOSE)
        .bind(now.0.saturating_sub_unsigned(PRESENT_MS))
        .bind(request.worker.as_str())
        .bind(request.suspicion_limit)
        .bind(request.worker.as_str())
        .bind(now.0.saturating_sub_unsigned(request.duration_ms))
        .bind(request.worker.as_str())
        .bind(now.0.saturating_sub_unsigned(PRESENT_MS))
        .bind(now.0.saturating_sub_unsigned(request.duration_ms))
        .bind(request.numerics_revision)
        .bind(request.worker.as_str())
        .bind(now.0.saturating_sub_unsigned(HEARD_MS))
        .bind(request.numerics_revision)
        .bind(request.worker.as_str())
        .bind(request.worker.as_str())
        .bind(request.worker.as_str())
        .bind(now.0.saturating_sub_unsigned(HEARD_MS))
        .bind(request.numerics_revision)
        .bind(request.numerics_revision)
        .bind(request.in_flight_limit)
        .bind(request.without_text())
        .bind(request.worker.as_str())
        .fetch_optional(c)
        .await
}

async fn write_lease(
    c: &mut Connection,
    now: LedgerTime,
    request: &LeaseRequest,
    allotment: &Allotment,
    tenant: String,
) -> Result<(), LedgerError> {
    let Allotment { lease, items, .. } = allotment;
    let (chunk, job) = (lease.chunk, lease.chunk.job.to_string());
    let writes = if allotment.is_cut {
        query(CUT_AND_LEASE)
            .bind(signed(items.last))
            .bind(&job)
            .bind(chunk.stage.0)
            .bind(signed(items.first))
    } else {
        query(lease_writes!())
    };
    writes
        .bind(signed(items.last))
        .bind(signed(lease.epoch.0))
        .bind(request.worker.as_str())
        .bind(now.0)
        .bind(allotment.until.0)
        .bind(request.request.as_str())
        .bind(allotment.charged)
        .bind(&job)
        .bind(chunk.stage.0)
        .bind(signed(items.first))
        .bind(signed(items.len()))
        .bind(i64::from(!allotment.is_cut))
        .bind(signed(items.len()))
        .bind(&job)
        .bind(chunk.stage.0)
        .bind(now.0)
        .bind(allotment.charged)
        .bind(&job)
        .bind(allotment.charged)
        .bind(tenant)
        .execute(c)
        .await?;
    Ok(())
}

/// Writes a chunk that is ready. The stage's counts are the caller's business.
pub async fn insert_ready(c: &mut Connection, chunk: &ChunkRow) -> Result<(), LedgerError> {
    query(
        "INSERT INTO chunks (job, stage, first, last, state, epoch, suspicions, alone, charged)
         VALUES (?, ?, ?, ?, 'ready', ?, ?, ?, 0)",
    )
    .bind(chunk.chunk.job.to_string())
    .bind(chunk.chunk.stage.0)
    .bind(signed(chunk.items.first))
    .bind(signed(chunk.items.last))
    .bind(signed(chunk.epoch.0))
    .bind(chunk.suspicions)
    .bind(i64::from(chunk.alone))
    .execute(&mut *c)
    .await?;
    Ok(())
}

async fn set_lease_end(
    c: &mut Connection,
    chunk: ChunkId,
    until: LedgerTime,
) -> Result<(), LedgerError> {
    query("UPDATE chunks SET lease_until = ? WHERE job = ? AND stage = ? AND first = ?")
        .bind(until.0)
        .bind(chunk.job.to_string())
        .bind(chunk.stage.0)
        .bind(signed(chunk.first))
        .execute(&mut *c)
        .await?;
    Ok(())
}

/// Prolongs leases.
pub async fn renew(
    c: &mut Connection,
    now: LedgerTime,
    leases: Vec<LeaseId>,
    duration_ms: u64,
) -> Result<Vec<Renewal>, LedgerError> {
    let until = now.after_ms(duration_ms);
    let mut renewals = Vec::with_capacity(leases.len());
    for lease in leases {
        let done = query(
            "UPDATE chunks SET lease_until = ? WHERE job = ? AND stage = ? AND first = ?
             AND epoch = ? AND state = 'leased'",
        )
        .bind(until.0)
        .bind(lease.chunk.job.to_string())
        .bind(lease.chunk.stage.0)
        .bind(signed(lease.chunk.first))
        .bind(signed(lease.epoch.0))
        .execute(&mut *c)
        .await?;
        renewals.push(match done {
            0 if !renew_elder(c, lease, until).await? => Renewal::Lost,
            _ => Renewal::Until(until),
        });
    }
    Ok(renewals)
}

/// The writes of an accepted chunk, as one exchange, where it was in this state.
macro_rules! accept_writes {
    ($state:literal, $leased_chunks:literal) => {
        concat!(
            "UPDATE chunks SET state = 'accepted', worker = ?, lease_until = NULL, request = NULL,
                    charged = 0, address = ?, hash = ?, cpu_micros = ?, paths_regular = ?,
                    paths_singular = ?, paths_failed = ?
             WHERE job = ? AND stage = ? AND first = ?;
             UPDATE stages SET ",
            $state,
            "_items = ",
            $state,
            "_items - ?, ",
            $state,
            "_chunks = ",
            $state,
            "_chunks - 1, accepted_items = accepted_items + ?,
                    accepted_chunks = accepted_chunks + 1, cpu_micros = cpu_micros + ?,
                    paths_regular = paths_regular + ?, paths_singular = paths_singular + ?,
                    paths_failed = paths_failed + ?, held_ms = held_ms + ?,
                    speculative_won = speculative_won + ?
             WHERE job = ? AND stage = ?;
             UPDATE jobs SET virtual_time = virtual_time + ?, leased_chunks = leased_chunks - ",
            $leased_chunks,
            " WHERE job = ?;
             UPDATE tenants SET virtual_time = virtual_time + ?
             WHERE tenant = (SELECT tenant FROM jobs WHERE job = ?);
             UPDATE workers SET items_done = items_done + ?, chunks_done = chunks_done + 1
             WHERE worker = ?"
        )
    };
}
const ACCEPT_LEASED: &str = accept_writes!("leased", "1");
/// A chunk that the second worker lost again, and the first one reports.
const ACCEPT_READY: &str = accept_writes!("ready", "0");

async fn is_evicted(c: &mut Connection, worker: &WorkerId) -> Result<bool, LedgerError> {
    let row = query("SELECT 1 AS one FROM workers WHERE worker = ? AND evicted = 1")
        .bind(worker.as_str())
        .fetch_optional(c)
        .await?;
    Ok(row.is_some())
}

/// Accepts a result, if the lease still stands.
pub async fn complete(
    c: &mut Connection,
    now: LedgerTime,
    lease: LeaseId,
    result: ResultObject,
) -> Result<Completion, LedgerError> {
    let cpu_micros = check_size("the CPU time of a chunk", result.cpu_micros)?;
    let Some(stored_chunk) = find(c, lease.chunk).await? else {
        return Ok(Completion::Stale);
    };
    if stored_chunk.items != result.items {
        return Ok(Completion::Stale);
    }
    if stored_chunk.state == "accepted" {
        let elder = stored_chunk.elder.as_ref();
        let was_leased = lease.epoch == stored_chunk.epoch
            || elder.is_some_and(|elder| elder.epoch == lease.epoch);
        return Ok(if digest(&stored_chunk.row, "hash")? != result.hash {
            Completion::HashDiffers
        } else if !was_leased {
            Completion::Stale
        } else if stored_chunk.row.try_get::<String>("address")? == result.address {
            Completion::AlreadyAccepted
        } else {
            Completion::Overtaken
        });
    }
    let Some(holder) = stored_chunk.holder(lease)? else {
        return Ok(Completion::Stale);
    };
    accept(c, now, lease, &stored_chunk, &holder, &result, cpu_micros).await?;
    Ok(Completion::Accepted)
}

/// Takes the result of a worker that has the chunk.
pub async fn accept(
    c: &mut Connection,
    now: LedgerTime,
    lease: LeaseId,
    stored_chunk: &Found,
    holder: &Holder,
    result: &ResultObject,
    cpu_micros: i64,
) -> Result<(), LedgerError> {
    let job = lease.chunk.job.to_string();
    let items = signed(result.items.len());
    let charged = cpu_micros - stored_chunk.charged;
    let has_elder = stored_chunk.elder.is_some();
    let writes = match stored_chunk.state.as_str() {
        "ready" => ACCEPT_READY,
        _ => ACCEPT_LEASED,
    };
    query(writes)
        .bind(holder.worker.as_str())
        .bind(result.address.as_str())
        .bind(result.hash.to_string())
        .bind(cpu_micros)
        .bind(signed(result.outcomes.regular))
        .bind(signed(result.outcomes.singular))
        .bind(signed(result.outcomes.failed))
        .bind(&job)
        .bind(lease.chunk.stage.0)
        .bind(signed(lease.chunk.first))
        .bind(items)
        .bind(items)
        .bind(cpu_micros)
        .bind(signed(result.outcomes.regular))
        .bind(signed(result.outcomes.singular))
        .bind(signed(result.outcomes.failed))
        .bind(signed(holder.held_ms(now)))
        .bind(i64::from(has_elder && !holder.is_elder))
        .bind(&job)
        .bind(lease.chunk.stage.0)
        .bind(charged)
        .bind(&job)
        .bind(charged)
        .bind(&job)
        .bind(items)
        .bind(holder.worker.as_str())
        .execute(&mut *c)
        .await?;
    if number(&stored_chunk.row, "suspicions")? != 0 {
        forget(c, lease.chunk).await?;
    }
    if has_elder {
        // It stays, so that the later report is known to be no error.
        query("UPDATE elders SET lease_until = NULL WHERE job = ? AND stage = ? AND first = ?")
            .bind(&job)
            .bind(lease.chunk.stage.0)
            .bind(signed(lease.chunk.first))
            .execute(&mut *c)
            .await?;
    }
    Ok(())
}

/// Takes a leased chunk from its worker, with `suspicions` new suspicions. Where the worker fell silent the row keeps
/// its request and the time at which the lease ended.
pub async fn release(
    c: &mut Connection,
    chunk: ChunkId,
    stored_chunk: &Found,
    suspicions: u32,
    silent: bool,
) -> Result<(), LedgerError> {
    let job = chunk.job.to_string();
    let items = signed(stored_chunk.items.len());
    query(
        "UPDATE chunks SET state = 'ready', worker = NULL,
                lease_until = CASE WHEN ? = 1 THEN lease_until END,
                request = CASE WHEN ? = 1 THEN request END,
                charged = 0, suspicions = suspicions + ?
         WHERE job = ? AND stage = ? AND first = ?;
         UPDATE stages SET leased_items = leased_items - ?, leased_chunks = leased_chunks - 1,
                ready_items = ready_items + ?, ready_chunks = ready_chunks + 1
         WHERE job = ? AND stage = ?;
         UPDATE jobs SET virtual_time = virtual_time - ?, leased_chunks = leased_chunks - 1
         WHERE job = ?;
         UPDATE tenants SET virtual_time = virtual_time - ?
         WHERE tenant = (SELECT tenant FROM jobs WHERE job = ?)",
    )
    .bind(i64::from(silent))
    .bind(i64::from(silent))
    .bind(suspicions)
    .bind(&job)
    .bind(chunk.stage.0)
    .bind(signed(chunk.first))
    .bind(items)
    .bind(items)
    .bind(&job)
    .bind(chunk.stage.0)
    .bind(stored_chunk.charged)
    .bind(&job)
    .bind(stored_chunk.charged)
    .bind(&job)
    .execute(&mut *c)
    .await?;
    Ok(())
}

/// Returns one chunk.
pub async fn give_back(
    c: &mut Connection,
    now: LedgerTime,
    lease: LeaseId,
    why: GiveBack,
) -> Result<(), LedgerError> {
    let Some(stored_chunk) = find(c, lease.chunk).await? else {
        return Ok(());
    };
    let Some(holder) = stored_chunk.holder(lease)? else {
        return Ok(());
    };
    let suspicions = match why {
        GiveBack::Drained => 0,
        GiveBack::Failed { .. } => accuse(c, now, lease.chunk, &holder.worker).await?,
    };
    match holder.is_elder {
        true => drop_elder(c, lease.chunk, suspicions).await,
        false => release(c, lease.chunk, &stored_chunk, suspicions, false).await,
    }
}

/// Returns the chunks whose leases have ended.
pub async fn expire(c: &mut Connection, now: LedgerTime) -> Result<Vec<Expired>, LedgerError> {
    let rows = query(
        "SELECT * FROM chunks WHERE state = 'leased' AND lease_until <= ?
         ORDER BY job, stage, first",
    )
    .bind(now.0)
    .fetch_all(&mut *c)
    .await?;
    let mut expired = Vec::with_capacity(rows.len());
    for row in rows {
        let chunk = chunk_id(&row)?;
        let suspicions = accuse(c, now, chunk, &worker(&row)?).await?;
        expired.push(expired_lease(&row, suspicions)?);
        if let Some(stored_chunk) = find(c, chunk).await? {
            release(c, chunk, &stored_chunk, suspicions, true).await?;
        }
    }
    expired.extend(expire_elders(c, now).await?);
    Ok(expired)
}

/// Returns all leased chunks of a job that ends.
pub async fn release_all(c: &mut Connection, job: JobId) -> Result<(), LedgerError> {
    let rows = query("SELECT * FROM chunks WHERE state = 'leased' AND job = ?")
        .bind(job.to_string())
        .fetch_all(&mut *c)
        .await?;
    for row in rows {
        let chunk = chunk_id(&row)?;
        if let Some(stored_chunk) = find(c, chunk).await? {
            release(c, chunk, &stored_chunk, 0, false).await?;
        }
    }
    drop_elders_of_job(c, job).await
}

/// Remembers a worker.
pub async fn seen(
    c: &mut Connection,
    now: LedgerTime,
    says: WorkerSeen,
) -> Result<(), LedgerError> {
    let taken = query(
        "SELECT 1 AS one FROM workers WHERE worker = ? AND last_seen > ?
         AND credential <> '' AND credential <> ?",
    )
    .bind(says.worker.as_str())
    .bind(now.0.saturating_sub_unsigned(HEARD_MS))
    .bind(says.credential.0.as_str())
    .fetch_optional(&mut *c)
    .await?;
    if taken.is_some() {
        return Err(LedgerError::NameTaken(says.worker));
    }
    query(
        "INSERT INTO workers (worker, version, numerics_revision, instruction_set, threads,
                lane_width, host, transport, draining, credential, first_seen, last_seen,
                items_done, chunks_done)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 0, 0)
         ON CONFLICT (worker) DO UPDATE SET version = excluded.version,
                numerics_revision = excluded.numerics_revision,
                instruction_set = excluded.instruction_set, threads = excluded.threads,
                lane_width = excluded.lane_width, host = excluded.host,
                transport = excluded.transport, draining = excluded.draining,
                credential = excluded.credential, last_seen = excluded.last_seen",
    )
    .bind(says.worker.as_str())
    .bind(says.version)
    .bind(says.numerics_revision)
    .bind(says.instruction_set)
    .bind(says.threads)
    .bind(says.lane_width)
    .bind(says.host)
    .bind(says.transport)
    .bind(i64::from(says.draining))
    .bind(says.credential.0)
    .bind(now.0)
    .bind(now.0)
    .execute(&mut *c)
    .await?;
    Ok(())
}
