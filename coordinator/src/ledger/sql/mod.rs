//! The ledger in a database: SQLite embedded, or PostgreSQL for several coordinators.
//!
//! One task writes: it groups operations into a commit and acknowledges them
//! after it. Readers have connections of their own. The statements are the same
//! for both engines; what differs stands in `engine`.

mod accusations;
mod audit;
pub mod copy;
mod damage;
mod decode;
mod engine;
mod file_system;
mod leases;
mod removal;
mod server_readers;
mod speculation;
mod stewardship;
mod writer;

use self::damage::Damage;
use self::decode::*;
use self::engine::{Engine, InitialValues, Query, Readers, Row, query};
use self::writer::Writer;
use super::clock::{Clock, LedgerTime};
use super::identity::*;
use super::rows::*;
use super::{Ledger, LedgerError};
use crate::chunks::audit::AuditKey;
use crate::measures::StorageMeasures;
use async_trait::async_trait;
use cognate_continuation::work::StageId;
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// Time for which opening the ledger waits for a database server that is not reached.
const PATIENCE: Duration = Duration::from_secs(30);
/// Pause between two attempts to reach the server.
const PAUSE: Duration = Duration::from_millis(500);

/// Disputes that are settled in one round.
const DISPUTES: u32 = 16;

/// Version of the schema that this program writes.
pub const SCHEMA_VERSION: i64 = 7;

/// Migrations: entry n makes version n + 1 of the schema from version n; entry 0 makes version 1 in an empty
/// database.
const MIGRATIONS: [&str; SCHEMA_VERSION as usize] = [
    include_str!("../schema.sql"),
    include_str!("../schema_2.sql"),
    include_str!("../schema_3.sql"),
    include_str!("../schema_4.sql"),
    include_str!("../schema_5.sql"),
    include_str!("../schema_6.sql"),
    include_str!("../schema_7.sql"),
];

/// A ledger in a database.
pub struct SqlLedger {
    writer: Writer,
    readers: Readers,
    measures: Arc<OnceLock<Arc<StorageMeasures>>>,
    damage: Damage,
}

impl SqlLedger {
    /// Opens the ledger in this file, or makes it; brings an older one up to date.
    pub async fn sqlite(path: &Path, clock: Arc<dyn Clock>) -> Result<Self, LedgerError> {
        if let Some(kind) = file_system::network_file_system(path) {
            tracing::warn!(path = %path.display(), kind, "the ledger is on a network file system: \
                SQLite's locks and syncs cannot be relied on there, put it on a local disk");
        }
        let ledger = Self::open(Engine::sqlite(path, Arc::clone(&clock))).await?;
        // The clock may have been set back since this was written; a lease lasts no longer for that.
        clock.is_at_least(ledger.latest().await?);
        Ok(ledger)
    }

    /// Opens the ledger in the database of this URL (`postgres://user@host/database`), or makes it
    /// there; brings an older one up to date. Deadlines are by the server's clock, or by `clock`
    /// where a test has one. A server that is not reached is waited for, 30 seconds long: it may be
    /// starting, too.
    pub async fn postgres(url: &str, clock: Option<Arc<dyn Clock>>) -> Result<Self, LedgerError> {
        let engine = Engine::postgres(url, clock)?;
        let end = Instant::now() + PATIENCE;
        loop {
            match Self::open(engine.clone()).await {
                Err(LedgerError::Unreachable(why)) if Instant::now() < end => {
                    tracing::warn!(%why, "waiting for the ledger's database");
                    tokio::time::sleep(PAUSE).await;
                }
                opened => return opened,
            }
        }
    }

    async fn open(engine: Engine) -> Result<Self, LedgerError> {
        // By a connection of its own: the pages that it has read are not what the others find later.
        let mut checking = engine.connect().await?;
        checking.quick_check().await?;
        checking.close().await?;
        let mut connection = engine.connect().await?;
        let initial = InitialValues {
            identity: uuid::Uuid::new_v4().to_string(),
            audit_secret: AuditKey::new_text(),
        };
        connection
            .migrate(&MIGRATIONS, SCHEMA_VERSION, &initial)
            .await?;
        let damage = Damage::default();
        let readers = engine.readers(damage.clone()).await?;
        let measures = Arc::default();
        Ok(Self {
            writer: Writer::start(engine, connection, Arc::clone(&measures), damage.clone()),
            readers,
            measures,
            damage,
        })
    }

    /// The latest time at which something happened here.
    async fn latest(&self) -> Result<LedgerTime, LedgerError> {
        let rows = query(
            "SELECT MAX(COALESCE((SELECT MAX(last_seen) FROM workers), 0),
                        COALESCE((SELECT MAX(submitted) FROM jobs), 0),
                        COALESCE((SELECT MAX(started) FROM jobs), 0),
                        COALESCE((SELECT MAX(ended) FROM jobs), 0)) AS latest",
        );
        let row = rows.read_optional(&self.readers).await?;
        let latest = row.map_or(Ok(0), |row| row.try_get::<i64>("latest"))?;
        Ok(LedgerTime(latest))
    }

    /// Counts its commits in these from now on, once and for all.
    pub fn measure(&self, measures: Arc<StorageMeasures>) {
        // Said twice, the first ones are kept.
        let _ = self.measures.set(measures);
    }

    /// Writes what is under way and closes the connections.
    pub async fn close(&self) {
        self.writer.close().await;
        self.readers.close().await;
    }

    /// The rows that belong to a job; where there are none, the job must be known.
    async fn rows_of<T>(
        &self,
        job: JobId,
        rows: Query,
        decode: impl Fn(&Row) -> Result<T, LedgerError>,
    ) -> Result<Vec<T>, LedgerError> {
        let rows = rows.read_all(&self.readers).await?;
        if rows.is_empty() {
            let job_row = query("SELECT 1 AS one FROM jobs WHERE job = ?")
                .bind(job.to_string())
                .read_optional(&self.readers)
                .await?;
            job_row.ok_or(LedgerError::UnknownJob(job))?;
        }
        rows.iter().map(decode).collect()
    }
}

#[async_trait]
impl Ledger for SqlLedger {
    async fn now(&self) -> Result<LedgerTime, LedgerError> {
        self.readers.now().await
    }

    fn damage(&self) -> Option<String> {
        self.damage.noted()
    }

    async fn submit(&self, id: RequestId, job: NewJob) -> Result<Submitted, LedgerError> {
        self.writer
            .write(|c, now| Box::pin(stewardship::submit(c, now, id, job)))
            .await
    }

    async fn cancel(&self, job: JobId, reason: &str) -> Result<Cancelled, LedgerError> {
        let reason = reason.to_owned();
        self.writer
            .write(move |c, now| Box::pin(stewardship::cancel(c, now, job, reason)))
            .await
    }

    async fn delete(&self, job: JobId) -> Result<Deleted, LedgerError> {
        self.writer
            .write(move |c, now| Box::pin(removal::delete(c, now, job)))
            .await
    }

    async fn is_deleted(&self, job: JobId) -> Result<bool, LedgerError> {
        let row = removal::deleted(job).read_optional(&self.readers).await?;
        Ok(row.is_some())
    }

    async fn identity(&self) -> Result<Option<String>, LedgerError> {
        let row = query("SELECT identity FROM ledger")
            .read_optional(&self.readers)
            .await?;
        let row = row.ok_or_else(|| LedgerError::Damaged("it has no identity".into()))?;
        row.try_get("identity")
    }

    async fn audit_key(&self) -> Result<AuditKey, LedgerError> {
        let row = query("SELECT audit_secret FROM ledger")
            .read_optional(&self.readers)
            .await?;
        let row = row.ok_or_else(|| LedgerError::Damaged("it has no audit secret".into()))?;
        let text: String = row.try_get("audit_secret")?;
        Ok(AuditKey::from_text(&text))
    }

    async fn job(&self, job: JobId) -> Result<Option<JobRow>, LedgerError> {
        let row = query("SELECT * FROM jobs WHERE job = ?")
            .bind(job.to_string())
            .read_optional(&self.readers)
            .await?;
        row.as_ref().map(job_row).transpose()
    }

    async fn jobs(&self, limit: u32) -> Result<Vec<JobRow>, LedgerError> {
        let rows = query("SELECT * FROM jobs ORDER BY number DESC LIMIT ?")
            .bind(limit)
            .read_all(&self.readers)
            .await?;
        rows.iter().rev().map(job_row).collect()
    }

    async fn stages(&self, job: JobId) -> Result<Vec<StageRow>, LedgerError> {
        let rows = query("SELECT * FROM stages WHERE job = ? ORDER BY stage").bind(job.to_string());
        self.rows_of(job, rows, stage_row).await
    }

    async fn overviews(&self, limit: u32) -> Result<Vec<(JobRow, Vec<StageRow>)>, LedgerError> {
        let jobs = self.jobs(limit).await?;
        let rows = query(
            "SELECT * FROM stages WHERE job IN (SELECT job FROM jobs ORDER BY number DESC LIMIT ?) ORDER BY stage",
        )
        .bind(limit)
        .read_all(&self.readers)
        .await?;
        let mut stages: HashMap<JobId, Vec<StageRow>> = HashMap::new();
        for row in &rows {
            stages
                .entry(job_id(row)?)
                .or_default()
                .push(stage_row(row)?);
        }
        // Jobs that came or went between the two questions have no stages, or are not asked for.
        let overview = |job: JobRow| {
            let stages = stages.remove(&job.job).unwrap_or_default();
            (job, stages)
        };
        Ok(jobs.into_iter().map(overview).collect())
    }

    async fn steward(
        &self,
        job: JobId,
        who: &CoordinatorId,
        duration_ms: u64,
    ) -> Result<Option<Epoch>, LedgerError> {
        let who = who.clone();
        self.writer
            .write(move |c, now| Box::pin(stewardship::steward(c, now, job, who, duration_ms)))
            .await
    }

    async fn renew_stewardships(
        &self,
        who: &CoordinatorId,
        duration_ms: u64,
    ) -> Result<(), LedgerError> {
        let who = who.clone();
        self.writer
            .write(move |c, now| Box::pin(stewardship::renew_all(c, now, who, duration_ms)))
            .await
    }

    async fn attention(
        &self,
        who: &CoordinatorId,
        suspicions: u32,
    ) -> Result<Vec<JobId>, LedgerError> {
        let now = self.now().await?;
        let rows = query(
            "SELECT j.job FROM jobs j
             WHERE j.ended IS NULL
               AND (j.steward IS NULL OR j.steward_until <= ?
                    OR (j.steward = ?
                        AND (NOT EXISTS (SELECT 1 FROM stages s
                                         WHERE s.job = j.job AND s.closed = 0)
                             OR EXISTS (SELECT 1 FROM stages s
                                        WHERE s.job = j.job AND s.closed = 0
                                          AND s.accepted_items + s.failed_items = s.items)
                             OR EXISTS (SELECT 1 FROM chunks c
                                        WHERE c.job = j.job AND c.state = 'ready'
                                          AND c.suspicions >= ?))))
             ORDER BY j.number",
        )
        .bind(now.0)
        .bind(who.as_str())
        .bind(suspicions)
        .read_all(&self.readers)
        .await?;
        rows.iter().map(job_id).collect()
    }

    async fn unfinished_jobs(&self) -> Result<Vec<JobId>, LedgerError> {
        let rows = query("SELECT job FROM jobs WHERE ended IS NULL ORDER BY number")
            .read_all(&self.readers)
            .await?;
        rows.iter().map(job_id).collect()
    }

    async fn advance(&self, job: JobId, epoch: Epoch, step: Advance) -> Result<(), LedgerError> {
        self.writer
            .write(move |c, _| Box::pin(stewardship::advance(c, job, epoch, step)))
            .await
    }

    async fn split(
        &self,
        chunk: ChunkId,
        epoch: Epoch,
        pieces: &[Piece],
    ) -> Result<(), LedgerError> {
        let pieces = pieces.to_vec();
        self.writer
            .write(move |c, _| Box::pin(stewardship::split(c, chunk, epoch, pieces)))
            .await
    }

    async fn fail_item(
        &self,
        chunk: ChunkId,
        epoch: Epoch,
        result: ResultObject,
    ) -> Result<(), LedgerError> {
        self.writer
            .write(move |c, _| Box::pin(stewardship::fail_item(c, chunk, epoch, result)))
            .await
    }

    async fn reopen(&self, chunk: ChunkId, epoch: Epoch) -> Result<(), LedgerError> {
        self.writer
            .write(move |c, _| Box::pin(stewardship::reopen(c, chunk, epoch)))
            .await
    }

    async fn standing(&self, lease: LeaseId) -> Result<Standing, LedgerError> {
        // The younger of two leases stands in the chunk's row, the elder beside it. One look at both: between two the
        // chunk may be leased.
        let rows = query(
            "SELECT worker, request, epoch, state FROM chunks WHERE job = ? AND stage = ? AND first = ?
             UNION ALL
             SELECT worker, NULL, epoch, 'leased' FROM elders WHERE job = ? AND stage = ? AND first = ?
             AND epoch = ? AND lease_until IS NOT NULL",
        );
        let job = lease.chunk.job.to_string();
        let (stage, first) = (lease.chunk.stage.0, signed(lease.chunk.first));
        let rows = rows.bind(&job).bind(stage).bind(first);
        let rows = rows.bind(&job).bind(stage).bind(first);
        let rows = rows.bind(signed(lease.epoch.0));
        let mut standing = Standing::Never;
        for row in rows.read_all(&self.readers).await? {
            let epoch = number(&row, "epoch")?;
            if epoch == lease.epoch.0 && text(&row, "state")? == "leased" {
                return Ok(Standing::Held {
                    worker: worker(&row)?,
                    request: request_of(&row)?,
                });
            }
            if epoch >= lease.epoch.0 {
                standing = Standing::Ended;
            }
        }
        Ok(standing)
    }

    async fn finish(&self, job: JobId, epoch: Epoch, end: JobEnd) -> Result<(), LedgerError> {
        self.writer
            .write(move |c, now| Box::pin(stewardship::finish(c, now, job, epoch, end)))
            .await
    }

    async fn finished_chunks(
        &self,
        job: JobId,
        stage: StageId,
        from: u64,
        limit: u32,
    ) -> Result<Vec<ChunkRow>, LedgerError> {
        let rows = query(
            "SELECT * FROM chunks WHERE job = ? AND stage = ? AND first >= ?
             AND state IN ('accepted', 'failed') ORDER BY first LIMIT ?",
        )
        .bind(job.to_string())
        .bind(stage.0)
        .bind(i64::try_from(from).unwrap_or(i64::MAX))
        .bind(limit);
        self.rows_of(job, rows, chunk_row).await
    }

    async fn suspects(
        &self,
        job: JobId,
        suspicions: u32,
        until: LedgerTime,
    ) -> Result<Vec<ChunkRow>, LedgerError> {
        let rows = query(
            "SELECT * FROM chunks WHERE job = ? AND state = 'ready' AND suspicions >= ?
             AND (lease_until IS NULL OR lease_until <= ?) ORDER BY stage, first",
        )
        .bind(job.to_string())
        .bind(suspicions)
        .bind(until.0);
        self.rows_of(job, rows, chunk_row).await
    }

    async fn contributions(&self, job: JobId) -> Result<Vec<Contribution>, LedgerError> {
        let rows = query(
            "SELECT c.worker, COALESCE(w.transport, '') AS transport,
                    CAST(SUM(c.last - c.first) AS BIGINT) AS items,
                    CAST(SUM(c.cpu_micros) AS BIGINT) AS cpu_micros
             FROM chunks c LEFT JOIN workers w ON w.worker = c.worker
             WHERE c.job = ? AND c.state = 'accepted'
             GROUP BY c.worker, w.transport ORDER BY c.worker",
        )
        .bind(job.to_string());
        self.rows_of(job, rows, contribution).await
    }

    async fn lease(&self, request: LeaseRequest) -> Result<Vec<Lease>, LedgerError> {
        self.writer
            .write(move |c, now| Box::pin(leases::lease(c, now, request)))
            .await
    }

    async fn renew(
        &self,
        leases: &[LeaseId],
        duration_ms: u64,
    ) -> Result<Vec<Renewal>, LedgerError> {
        let ids = leases.to_vec();
        self.writer
            .write(move |c, now| Box::pin(leases::renew(c, now, ids, duration_ms)))
            .await
    }

    async fn complete(
        &self,
        lease: LeaseId,
        result: ResultObject,
    ) -> Result<Completion, LedgerError> {
        self.writer
            .write(move |c, now| Box::pin(leases::complete(c, now, lease, result)))
            .await
    }

    async fn confirm(
        &self,
        lease: LeaseId,
        result: ResultObject,
        why: Confirmation,
    ) -> Result<Completion, LedgerError> {
        self.writer
            .write(move |c, now| Box::pin(audit::confirm(c, now, lease, result, why)))
            .await
    }

    async fn disputes(&self) -> Result<Vec<Dispute>, LedgerError> {
        let chunks = query(
            "SELECT c.* FROM chunks c JOIN jobs j ON j.job = c.job
             WHERE c.state = 'ready' AND c.votes >= 2 AND j.ended IS NULL
             ORDER BY c.job, c.stage, c.first LIMIT ?",
        )
        .bind(DISPUTES);
        let mut disputes = Vec::new();
        for row in chunks.read_all(&self.readers).await? {
            let chunk = chunk_row(&row)?;
            let votes = audit::votes_on(chunk.chunk).read_all(&self.readers).await?;
            disputes.push(Dispute {
                votes: votes.iter().map(audit::vote).collect::<Result<_, _>>()?,
                chunk,
            });
        }
        Ok(disputes)
    }

    async fn strike(&self, vote: LeaseId, why: Strike) -> Result<(), LedgerError> {
        self.writer
            .write(move |c, now| Box::pin(audit::strike(c, now, vote, why)))
            .await
    }

    async fn evict(&self, worker: &WorkerId) -> Result<(), LedgerError> {
        let worker = worker.clone();
        self.writer
            .write(move |c, now| Box::pin(async move { audit::evict(c, now, &worker).await }))
            .await
    }

    async fn give_back(&self, lease: LeaseId, why: GiveBack) -> Result<(), LedgerError> {
        self.writer
            .write(move |c, now| Box::pin(leases::give_back(c, now, lease, why)))
            .await
    }

    async fn expire(&self) -> Result<Vec<Expired>, LedgerError> {
        // Renewals that came before this moment are written before this is.
        let now = self.now().await?;
        self.writer
            .write(move |c, _| Box::pin(leases::expire(c, now)))
            .await
    }

    async fn seen(&self, worker: WorkerSeen) -> Result<(), LedgerError> {
        self.writer
            .write(move |c, now| Box::pin(leases::seen(c, now, worker)))
            .await
    }

    async fn workers(&self, limit: u32) -> Result<Vec<WorkerRow>, LedgerError> {
        let rows = query(
            "SELECT w.*, (SELECT COUNT(*) FROM chunks c
                          WHERE c.state = 'leased' AND c.worker = w.worker) AS leased_chunks
             FROM workers w ORDER BY last_seen DESC, worker DESC LIMIT ?",
        )
        .bind(limit)
        .read_all(&self.readers)
        .await?;
        rows.iter().map(worker_row).collect()
    }
}

#[cfg(test)]
mod tests;
