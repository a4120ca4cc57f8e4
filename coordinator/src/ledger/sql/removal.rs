//! Removal of jobs: rows of a job that has ended go, and its id is remembered. One operation of a commit.

use super::decode::*;
use super::engine::{Connection, Query, query};
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;

/// The row of a deleted job, if it is one.
pub fn deleted(job: JobId) -> Query {
    query("SELECT 1 AS one FROM deleted_jobs WHERE job = ?").bind(job.to_string())
}

/// Deletes a job that has ended.
pub async fn delete(
    c: &mut Connection,
    now: LedgerTime,
    job: JobId,
) -> Result<Deleted, LedgerError> {
    let id = job.to_string();
    let row = query("SELECT * FROM jobs WHERE job = ?")
        .bind(&id)
        .fetch_optional(&mut *c)
        .await?;
    let Some(row) = row else {
        let before = deleted(job).fetch_optional(c).await?;
        return match before {
            Some(_) => Ok(Deleted::Before),
            None => Err(LedgerError::UnknownJob(job)),
        };
    };
    let state = job_row(&row)?.state;
    if !state.has_ended() {
        return Ok(Deleted::GoesOn(state));
    }
    let mut removed = [0; 2];
    for (statement, counted) in [
        ("DELETE FROM accusations WHERE job = ?", None),
        ("DELETE FROM votes WHERE job = ?", None),
        ("DELETE FROM elders WHERE job = ?", None),
        ("DELETE FROM chunks WHERE job = ?", Some(1)),
        ("DELETE FROM stages WHERE job = ?", Some(0)),
        ("DELETE FROM jobs WHERE job = ?", None),
    ] {
        let rows = query(statement).bind(&id).execute(&mut *c).await?;
        if let Some(counted) = counted {
            removed[counted] = rows;
        }
    }
    query("INSERT INTO deleted_jobs (job, deleted) VALUES (?, ?)")
        .bind(&id)
        .bind(now.0)
        .execute(c)
        .await?;
    let [stages, chunks] = removed;
    Ok(Deleted::Now { stages, chunks })
}
