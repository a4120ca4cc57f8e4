//! `cognate solve`: a coordinator and workers for one problem, here.

use super::{results, submit, watch};
use crate::arguments::{Format, OutputArguments, OwnOrRunning, ProgressArguments, Solve};
use crate::connection::{Connection, Target};
use crate::embedded::Embedded;
use crate::error::{ClientError, Exit};
use crate::output::progress::Progress;
use crate::problem::{self, Prepared};
use cognate_protocol::v1::JobState;
use std::time::Instant;

/// Solves, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &Solve) -> Result<Exit, ClientError> {
    let prepared = problem::prepare(&a.problem)?;
    let service = Embedded::start(a.workers, a.threads).await?;
    embedded(&a.output, &a.progress, prepared, service).await
}

/// Has a problem solved by the running coordinator that was named, or by one of the command's own.
pub async fn anywhere(
    service: &OwnOrRunning,
    running: Option<&Target>,
    output: &OutputArguments,
    progress: &ProgressArguments,
    prepared: Prepared,
) -> Result<Exit, ClientError> {
    match running {
        Some(target) => tokio::select! {
            ended = follow(output, progress, prepared, target) => ended,
            () = crate::interrupted() => Err(ClientError::Interrupted),
        },
        None => embedded(output, progress, prepared, service.start().await?).await,
    }
}

/// Has a problem solved by this service, then stops it.
async fn embedded(
    output: &OutputArguments,
    progress: &ProgressArguments,
    prepared: Prepared,
    mut service: Embedded,
) -> Result<Exit, ClientError> {
    let target = Target::open_to_all(&service.address());
    let ended = tokio::select! {
        ended = follow(output, progress, prepared, &target) => ended,
        error = service.abandoned() => Err(error),
        () = crate::interrupted() => Err(ClientError::Interrupted),
    };
    service.stop().await;
    ended
}

/// Submits a problem, follows its job and shows the answer.
pub async fn follow(
    output: &OutputArguments,
    progress: &ProgressArguments,
    prepared: Prepared,
    target: &Target,
) -> Result<Exit, ClientError> {
    let quiet = output.format == Format::Json;
    let mut progress = Progress::of(progress.progress, quiet, Instant::now());
    let mut connection = Connection::open(target).await?;
    let request_id = uuid::Uuid::new_v4().to_string();
    let (job, warnings) = submit::send(&mut connection, &request_id, prepared).await?;
    for warning in &warnings {
        progress.say(&format!("warning: {warning}"));
    }
    let followed = watch::follow(target, &job, &mut progress).await;
    progress.finish();
    let (mut connection, last) = followed?;
    match last.state() {
        JobState::Failed => Err(ClientError::GaveUp(last.message)),
        JobState::Cancelled => Err(ClientError::Cancelled),
        _ => results::show(&mut connection, &job, output).await,
    }
}
