//! Rows of the database to rows of the ledger: every value is checked.

use super::engine::Row;
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::StageId;
use std::fmt::Display;

/// The error for a value that this program did not write.
pub fn damaged(what: impl Display) -> LedgerError {
    LedgerError::Damaged(what.to_string())
}

/// A nonnegative number.
pub fn number(row: &Row, column: &str) -> Result<u64, LedgerError> {
    let value: i64 = row.try_get(column)?;
    u64::try_from(value).map_err(|_| damaged(format_args!("{column} is {value}")))
}

/// A nonnegative number of at most 32 bits.
pub fn small(row: &Row, column: &str) -> Result<u32, LedgerError> {
    let value = number(row, column)?;
    u32::try_from(value).map_err(|_| damaged(format_args!("{column} is {value}")))
}

pub fn text(row: &Row, column: &str) -> Result<String, LedgerError> {
    row.try_get(column)
}

fn time(row: &Row, column: &str) -> Result<LedgerTime, LedgerError> {
    Ok(LedgerTime(row.try_get(column)?))
}

/// A number as a database holds it.
pub fn signed(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}

/// A digest.
pub fn digest(row: &Row, column: &str) -> Result<Digest, LedgerError> {
    parse_digest(&text(row, column)?).map_err(damaged)
}

fn optional_digest(row: &Row, column: &str) -> Result<Option<Digest>, LedgerError> {
    let value: Option<String> = row.try_get(column)?;
    value.map(|v| parse_digest(&v).map_err(damaged)).transpose()
}

/// A worker's name.
pub fn worker(row: &Row) -> Result<WorkerId, LedgerError> {
    WorkerId::new(text(row, "worker")?).map_err(damaged)
}

/// The question that a row's lease was asked for, where it is remembered.
pub fn request_of(row: &Row) -> Result<Option<RequestId>, LedgerError> {
    let request: Option<String> = row.try_get("request")?;
    request.map(RequestId::new).transpose().map_err(damaged)
}

/// A job's id.
pub fn job_id(row: &Row) -> Result<JobId, LedgerError> {
    text(row, "job")?.parse().map_err(damaged)
}

/// A job's state by its name.
pub fn job_state(row: &Row) -> Result<JobState, LedgerError> {
    let name = text(row, "state")?;
    let state = JobState::ALL.into_iter().find(|s| s.name() == name);
    state.ok_or_else(|| damaged(format_args!("a job's state is `{name}`")))
}

/// A whole job.
pub fn job_row(row: &Row) -> Result<JobRow, LedgerError> {
    let optional_time = |column| -> Result<Option<LedgerTime>, LedgerError> {
        let value: Option<i64> = row.try_get(column)?;
        Ok(value.map(LedgerTime))
    };
    let steward: Option<String> = row.try_get("steward")?;
    Ok(JobRow {
        job: job_id(row)?,
        number: number(row, "number")?,
        asked: NewJob {
            tenant: Tenant::new(text(row, "tenant")?).map_err(damaged)?,
            label: text(row, "label")?,
            problem: digest(row, "problem")?,
            options: from_hex(&text(row, "options")?)?,
            numerics_revision: small(row, "numerics_revision")?,
        },
        state: job_state(row)?,
        reason: row.try_get("reason")?,
        submitted: time(row, "submitted")?,
        started: optional_time("started")?,
        ended: optional_time("ended")?,
        steward: steward
            .map(|s| CoordinatorId::new(s).map_err(damaged))
            .transpose()?,
        steward_epoch: Epoch(number(row, "steward_epoch")?),
        steward_until: time(row, "steward_until")?,
        snapshot: optional_digest(row, "snapshot")?,
        solutions: optional_digest(row, "solutions")?,
        summary: optional_digest(row, "summary")?,
    })
}

fn outcomes(row: &Row) -> Result<Outcomes, LedgerError> {
    Ok(Outcomes {
        regular: number(row, "paths_regular")?,
        singular: number(row, "paths_singular")?,
        failed: number(row, "paths_failed")?,
    })
}

/// A stage with its counts.
pub fn stage_row(row: &Row) -> Result<StageRow, LedgerError> {
    let count = |items: &str, chunks: &str| -> Result<Count, LedgerError> {
        Ok(Count {
            items: number(row, items)?,
            chunks: number(row, chunks)?,
        })
    };
    Ok(StageRow {
        stage: StageId(small(row, "stage")?),
        definition: digest(row, "definition")?,
        items: number(row, "items")?,
        closed: number(row, "closed")? != 0,
        ready: count("ready_items", "ready_chunks")?,
        leased: count("leased_items", "leased_chunks")?,
        accepted: count("accepted_items", "accepted_chunks")?,
        failed: count("failed_items", "failed_chunks")?,
        cpu_micros: number(row, "cpu_micros")?,
        outcomes: outcomes(row)?,
        held_ms: number(row, "held_ms")?,
        speculative_leases: number(row, "speculative_leases")?,
        speculative_won: number(row, "speculative_won")?,
    })
}

/// The name of a chunk.
pub fn chunk_id(row: &Row) -> Result<ChunkId, LedgerError> {
    Ok(ChunkId {
        job: job_id(row)?,
        stage: StageId(small(row, "stage")?),
        first: number(row, "first")?,
    })
}

/// The items of a chunk.
pub fn items(row: &Row) -> Result<ItemRange, LedgerError> {
    Ok(ItemRange {
        first: number(row, "first")?,
        last: number(row, "last")?,
    })
}

/// A whole chunk.
pub fn chunk_row(row: &Row) -> Result<ChunkRow, LedgerError> {
    let items = items(row)?;
    let result = || -> Result<ResultObject, LedgerError> {
        Ok(ResultObject {
            items,
            address: text(row, "address")?,
            hash: digest(row, "hash")?,
            cpu_micros: number(row, "cpu_micros")?,
            outcomes: outcomes(row)?,
        })
    };
    let state = match text(row, "state")?.as_str() {
        "ready" => ChunkState::Ready,
        "leased" => ChunkState::Leased {
            worker: worker(row)?,
            until: time(row, "lease_until")?,
        },
        "accepted" => ChunkState::Accepted {
            worker: worker(row)?,
            result: result()?,
        },
        "failed" => ChunkState::Failed { result: result()? },
        other => return Err(damaged(format_args!("a chunk's state is `{other}`"))),
    };
    Ok(ChunkRow {
        chunk: chunk_id(row)?,
        items,
        state,
        epoch: Epoch(number(row, "epoch")?),
        suspicions: small(row, "suspicions")?,
        alone: number(row, "alone")? != 0,
    })
}

/// The lease before the last of a chunk that was given to a second worker; the columns' names begin
/// with `elder_`.
pub fn elder(row: &Row) -> Result<Option<Elder>, LedgerError> {
    let Some(name) = row.try_get::<Option<String>>("elder_worker")? else {
        return Ok(None);
    };
    let until: Option<i64> = row.try_get("elder_until")?;
    Ok(Some(Elder {
        epoch: Epoch(number(row, "elder_epoch")?),
        worker: WorkerId::new(name).map_err(damaged)?,
        leased_at: time(row, "elder_leased_at")?,
        until: until.map(LedgerTime),
    }))
}

/// Work of one worker for a job.
pub fn contribution(row: &Row) -> Result<Contribution, LedgerError> {
    Ok(Contribution {
        worker: worker(row)?,
        transport: text(row, "transport")?,
        items: number(row, "items")?,
        cpu_micros: number(row, "cpu_micros")?,
    })
}

/// A whole worker.
pub fn worker_row(row: &Row) -> Result<WorkerRow, LedgerError> {
    Ok(WorkerRow {
        says: WorkerSeen {
            worker: worker(row)?,
            version: text(row, "version")?,
            numerics_revision: small(row, "numerics_revision")?,
            instruction_set: text(row, "instruction_set")?,
            threads: small(row, "threads")?,
            lane_width: small(row, "lane_width")?,
            host: text(row, "host")?,
            transport: text(row, "transport")?,
            draining: number(row, "draining")? != 0,
            credential: Credential(text(row, "credential")?),
        },
        first_seen: time(row, "first_seen")?,
        last_seen: time(row, "last_seen")?,
        items_done: number(row, "items_done")?,
        chunks_done: number(row, "chunks_done")?,
        leased_chunks: number(row, "leased_chunks")?,
        evicted: number(row, "evicted")? != 0,
    })
}

/// Bytes as hexadecimal text.
pub fn to_hex(bytes: &[u8]) -> String {
    let digit = |nibble: u8| char::from(b"0123456789abcdef"[usize::from(nibble)]);
    let pairs = bytes.iter().flat_map(|b| [digit(b >> 4), digit(b & 15)]);
    pairs.collect()
}

/// Hexadecimal text as bytes.
pub fn from_hex(text: &str) -> Result<Vec<u8>, LedgerError> {
    let nibble = |c: u8| char::from(c).to_digit(16);
    let pairs = text.as_bytes().chunks(2).map(|pair| match *pair {
        [a, b] => Some((nibble(a)? * 16 + nibble(b)?) as u8),
        _ => None,
    });
    pairs
        .collect::<Option<_>>()
        .ok_or_else(|| damaged("a job's options are no hexadecimal text"))
}

/// Expired lease of this row, of a chunk or of an elder, with `more` suspicions added.
pub fn expired_lease(row: &Row, more: u32) -> Result<Expired, LedgerError> {
    Ok(Expired {
        lease: LeaseId {
            chunk: chunk_id(row)?,
            epoch: Epoch(number(row, "epoch")?),
        },
        worker: worker(row)?,
        suspicions: small(row, "suspicions")? + more,
    })
}
