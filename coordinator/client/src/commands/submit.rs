//! `cognate submit`: hands a problem to a coordinator.

use crate::arguments::{Format, Submit};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output;
use crate::problem::{self, Prepared};
use cognate_continuation::start_points::Digest;
use cognate_protocol::submission::{StartSolutions, Submission};
use cognate_protocol::to_proto;
use std::time::{Duration, Instant};

/// Start solutions up to this size travel with the problem; larger ones are uploaded first.
const INLINE_BYTES: usize = 4 << 20;

/// How long a submission is sent again while the coordinator, or its ledger's database, starts; the request id
/// makes it one job.
const PATIENCE: Duration = Duration::from_secs(30);
/// The pause after the first attempt; it doubles after each further attempt, up to [`LARGEST_PAUSE`].
const FIRST_PAUSE: Duration = Duration::from_millis(200);
/// The largest pause between two attempts.
const LARGEST_PAUSE: Duration = Duration::from_secs(2);

/// Prints the job's id alone on a line.
pub async fn run(a: &Submit) -> Result<Exit, ClientError> {
    let mut prepared = problem::prepare(&a.problem)?;
    prepared.refuse_objective()?;
    let components = &a.components;
    if !a.decompose {
        prepared.refuse_other_run(&[])?;
    }
    if a.decompose {
        prepared = problem::for_components(prepared, components)?;
    } else if components.are_given() {
        return Err(ClientError::Input {
            origin: "--dimension, --loops, --method, --verify".into(),
            message: "only go with --decompose".into(),
        });
    }
    if prepared.is_sweep() {
        return Err(ClientError::Misfit(several_targets(
            prepared.submission.options.target_parameters.len(),
        )));
    }
    prepared.leave_conditions("`cognate results JOB --where CONDITION` selects solutions of a job");
    let mut connection = Connection::open(&a.service.target()?).await?;
    let request_id = match &a.request_id {
        Some(id) => id.clone(),
        None => uuid::Uuid::new_v4().to_string(),
    };
    let (job, warnings) = send(&mut connection, &request_id, prepared).await?;
    let answer = match a.format {
        Format::Table => {
            for warning in &warnings {
                eprintln!("warning: {warning}");
            }
            format!("{job}\n")
        }
        Format::Json => output::json::submitted(&job, &warnings),
    };
    output::print(&answer)?;
    Ok(Exit::Solved)
}

/// The refusal of targets that take several jobs.
fn several_targets(count: usize) -> String {
    format!(
        "{count} sets of values of the parameters are one job with --start monodromy, or with --start-solutions and \
         --start-parameters; `cognate solve FAMILY --targets VALUES` needs neither, and makes several jobs"
    )
}

/// Sends a problem; returns the job's id, and warnings for the user.
pub async fn send(
    connection: &mut Connection,
    request_id: &str,
    prepared: Prepared,
) -> Result<(String, Vec<String>), ClientError> {
    let Prepared { submission, .. } = prepared;
    let warnings = submission.options.warnings.clone();
    let message = to_proto::problem::submission(&uploaded(connection, submission).await?);
    let begin = Instant::now();
    let mut pause = FIRST_PAUSE;
    let answer = loop {
        match connection.submit(request_id, message.clone()).await {
            Err(ClientError::Unreachable { .. }) if begin.elapsed() < PATIENCE => {
                tokio::time::sleep(pause).await;
                pause = (2 * pause).min(LARGEST_PAUSE);
            }
            other => break other,
        }
    };
    // A warning about an ambiguous file may explain why the file is refused.
    let answer = answer.inspect_err(|_| {
        for warning in &warnings {
            eprintln!("warning: {warning}");
        }
    })?;
    Ok((answer.job, answer.warnings))
}

/// Large start solutions go ahead as an object.
async fn uploaded(
    connection: &mut Connection,
    mut submission: Submission,
) -> Result<Submission, ClientError> {
    if let Some(StartSolutions::Points(points)) = &submission.options.start_solutions
        && points.coordinates.len() * 16 > INLINE_BYTES
    {
        let stored = connection.upload(points.to_bytes()).await?;
        let digest = <[u8; 32]>::try_from(&stored.digest[..])
            .map_err(|_| ClientError::GaveUp("its answer to an upload names no object".into()))?;
        submission.options.start_solutions = Some(StartSolutions::Object(Digest(digest)));
    }
    Ok(submission)
}
