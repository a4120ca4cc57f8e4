//! Events: what changes, as a browser hears it (server-sent events).
//!
//! One job's progress comes from its watch; the lists of jobs and workers are looked at every second, and sent where
//! they differ from what was sent before.

use super::caller::Calls;
use super::request::Fault;
use bytes::Bytes;
use cognate_protocol::{client_json, v1};
use futures::{Stream, StreamExt};
use http_body::Frame;
use serde_json::{Value, json};
use std::convert::Infallible;
use std::time::Duration;
use tokio::time::sleep;
use tonic::Status;

/// Between two looks at the lists.
const EVERY: Duration = Duration::from_secs(1);
/// Looks without news after which a comment shows that the connection lives.
const QUIET_LOOKS: u32 = 15;

/// A piece of the body.
pub type Piece = Result<Frame<Bytes>, Infallible>;

fn event(name: &str, data: &Value) -> Piece {
    Ok(Frame::data(
        format!("event: {name}\ndata: {data}\n\n").into(),
    ))
}

fn failure(status: Status) -> Piece {
    let fault = Fault::from(status);
    event(
        "failure",
        &json!({ "error": fault.message, "status": fault.status.as_u16() }),
    )
}

/// A page of the list of jobs, newest first.
pub async fn jobs(calls: &mut Calls, from: u32, limit: u32) -> Result<Value, Status> {
    let request = v1::ListJobsRequest {
        limit: limit + 1,
        skip: from,
    };
    let mut list = calls.list_jobs(request).await?.into_inner().jobs;
    let more = list.len() > limit as usize;
    list.truncate(limit as usize);
    let mut answer = client_json::jobs(&list);
    answer["from"] = json!(from);
    answer["more"] = json!(more);
    Ok(answer)
}

/// The list of workers.
pub async fn workers(calls: &mut Calls) -> Result<Value, Status> {
    let list = calls.list_workers(v1::ListWorkersRequest {}).await?;
    Ok(client_json::workers(&list.into_inner().workers))
}

/// Lists of jobs and workers, as they were sent last.
struct Lists {
    calls: Calls,
    from: u32,
    limit: u32,
    jobs: Option<Value>,
    workers: Option<Value>,
    quiet: u32,
    ended: bool,
}

impl Lists {
    /// Waits for news; nothing after a failure.
    async fn next(&mut self) -> Option<Vec<Piece>> {
        if self.ended {
            return None;
        }
        loop {
            if self.jobs.is_some() {
                sleep(EVERY).await;
            }
            let jobs = jobs(&mut self.calls, self.from, self.limit).await;
            let workers = workers(&mut self.calls).await;
            let (jobs, workers) = match (jobs, workers) {
                (Ok(jobs), Ok(workers)) => (jobs, workers),
                (Err(status), _) | (_, Err(status)) => {
                    self.ended = true;
                    return Some(vec![failure(status)]);
                }
            };
            let mut pieces = Vec::new();
            for (name, listing, sent) in [
                ("jobs", jobs, &mut self.jobs),
                ("workers", workers, &mut self.workers),
            ] {
                if sent.as_ref() != Some(&listing) {
                    pieces.push(event(name, &listing));
                    *sent = Some(listing);
                }
            }
            self.quiet += 1;
            if pieces.is_empty() && self.quiet >= QUIET_LOOKS {
                pieces.push(Ok(Frame::data(Bytes::from_static(b": quiet\n\n"))));
            }
            if !pieces.is_empty() {
                self.quiet = 0;
                return Some(pieces);
            }
        }
    }
}

/// The lists, now and whenever they change.
pub fn of_lists(calls: Calls, from: u32, limit: u32) -> impl Stream<Item = Piece> + Send {
    let lists = Lists {
        calls,
        from,
        limit,
        jobs: None,
        workers: None,
        quiet: 0,
        ended: false,
    };
    futures::stream::unfold(lists, |mut lists| async move {
        Some((lists.next().await?, lists))
    })
    .flat_map(futures::stream::iter)
}

/// A job's progress, now and whenever it changes, and `end` when nothing more will.
pub async fn of_job(
    mut calls: Calls,
    job: &str,
) -> Result<impl Stream<Item = Piece> + Send + use<>, Status> {
    let request = v1::WatchRequest {
        job: job.to_owned(),
    };
    let progress = calls.watch(request).await?.into_inner();
    let pieces = progress.map(|progress| match progress {
        Ok(progress) => event("progress", &client_json::progress(&progress)),
        Err(status) => failure(status),
    });
    let end = futures::stream::once(async { event("end", &json!({})) });
    Ok(pieces.chain(end))
}
