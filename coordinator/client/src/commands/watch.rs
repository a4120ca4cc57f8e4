//! `cognate watch`: follows a job until it ends.

use crate::arguments::{Format, OneJob, Watch};
use crate::connection::{Connection, Target};
use crate::error::{ClientError, Exit};
use crate::output::json;
use crate::output::progress::{Progress, Standing};
use crate::output::{self, answers, decomposition, summary, table, text};
use cognate_protocol::v1;
use cognate_summary::AnySummary;
use std::time::{Duration, Instant};

/// How long a coordinator that went away may take to come back: a restart takes seconds.
const PATIENCE: Duration = Duration::from_secs(60);

/// Pause between two attempts to find the coordinator again.
const RETRY: Duration = Duration::from_millis(500);

/// Follows a job; the exit code is the job's.
pub async fn run(watch: &Watch) -> Result<Exit, ClientError> {
    let a: &OneJob = &watch.job;
    let quiet = a.format == Format::Json;
    let mut progress = Progress::of(watch.progress.progress, quiet, Instant::now());
    let target = a.service.target()?;
    let followed = follow(&target, &a.job, &mut progress).await;
    progress.finish();
    let (mut connection, last) = followed?;
    let (exit, line) = verdict(&mut connection, &last).await?;
    match a.format {
        Format::Table => eprintln!("{line}"),
        Format::Json => output::print(&json::progress(&last, exit as u8))?,
    }
    Ok(exit)
}

/// Follows a job until it ends, also over a restart of the coordinator; gives its last state.
pub async fn follow(
    target: &Target,
    job: &str,
    progress: &mut Progress,
) -> Result<(Connection, v1::JobProgress), ClientError> {
    let mut connection = Connection::open(target).await?;
    let mut gone_since: Option<Instant> = None;
    loop {
        match follow_once(&mut connection, job, progress, &mut gone_since).await {
            Ok(last) => return Ok((connection, last)),
            Err(lost @ ClientError::Unreachable { .. }) => {
                let now = Instant::now();
                let since = *gone_since.get_or_insert_with(|| {
                    progress.say("the coordinator is gone; waiting for it to come back");
                    now
                });
                if now.duration_since(since) > PATIENCE {
                    return Err(lost);
                }
                tokio::time::sleep(RETRY).await;
                if let Ok(reopened_connection) = Connection::open_at_once(target).await {
                    connection = reopened_connection;
                }
            }
            Err(other) => return Err(other),
        }
    }
}

async fn follow_once(
    connection: &mut Connection,
    job: &str,
    progress: &mut Progress,
    gone_since: &mut Option<Instant>,
) -> Result<v1::JobProgress, ClientError> {
    let mut following = connection.watch(job).await?;
    while let Some(job_progress) = following.next().await? {
        // Only an answer shows that it is back; the next absence has its own patience.
        if gone_since.take().is_some() {
            progress.say("the coordinator is back");
        }
        progress.show(&standing(&job_progress), Instant::now());
        if ended(job_progress.state()) {
            return Ok(job_progress);
        }
    }
    Err(connection.stopped_early())
}

/// Whether nothing more happens to a job in this state.
pub fn ended(state: v1::JobState) -> bool {
    matches!(
        state,
        v1::JobState::Solved | v1::JobState::Failed | v1::JobState::Cancelled
    )
}

/// State of a job's progress, as the display shows it.
pub fn standing(p: &v1::JobProgress) -> Standing {
    let open = p.stages.iter().rfind(|s| s.accepted + s.failed < s.total);
    // Branches whose mixed cells are counted are no paths: how many there will be is not known.
    let counting = open.or(p.stages.last());
    if let Some((stage, cells)) = counting.and_then(|s| Some((s, s.mixed_cells?))) {
        return Standing {
            phase: format!("{}, {} so far", stage.purpose, text::counted(cells, "cell")),
            done: stage.accepted,
            total: stage.total,
            failed: stage.failed,
            unit: "part",
        };
    }
    let paths = || p.stages.iter().filter(|s| s.mixed_cells.is_none());
    let phase = match (p.state(), open) {
        (v1::JobState::Queued, _) => "waiting".to_string(),
        (_, Some(stage)) if !stage.purpose.is_empty() => stage.purpose.clone(),
        (_, Some(_)) => "tracking".to_string(),
        (_, None) => "finishing".to_string(),
    };
    Standing {
        phase,
        done: paths().map(|s| s.accepted).sum(),
        total: paths().map(|s| s.total).sum(),
        failed: paths().map(|s| s.failed).sum(),
        unit: "path",
    }
}

/// The exit code of a job that has ended, and a line that says how it did.
pub async fn verdict(
    connection: &mut Connection,
    last: &v1::JobProgress,
) -> Result<(Exit, String), ClientError> {
    let time = text::seconds(last.elapsed_seconds);
    match last.state() {
        v1::JobState::Cancelled => Ok((Exit::Cancelled, format!("cancelled after {time}"))),
        v1::JobState::Failed => Ok((
            Exit::Unavailable,
            format!("given up after {time}: {}", last.message),
        )),
        _ => {
            let json = connection.summary(&last.job).await?;
            let summary = match summary::read_any(&json)? {
                AnySummary::Solve(summary) => summary,
                AnySummary::Decomposition(summary) => {
                    let mut line = format!("done in {time}: {}", decomposition::answer(&summary));
                    for doubt in &summary.decomposition.unsettled {
                        line.push_str(&format!("\nnot settled: {doubt}"));
                    }
                    return Ok((decomposition::exit(&summary), line));
                }
                AnySummary::Question(summary) => {
                    let mut line = format!("done in {time}: {}", answers::headline(&summary));
                    for doubt in &summary.unsettled {
                        line.push_str(&format!("\nnot settled: {doubt}"));
                    }
                    return Ok((answers::exit(&summary), line));
                }
            };
            let paths = text::counted(summary.paths.total, "path");
            let has_sets = summary.solutions.positive_dimensional == Some(true);
            let answer = table::answer(&summary, has_sets);
            let mut line = format!("done in {time}: {paths}, {answer}");
            for question in summary::open_questions(&summary) {
                line.push_str(&format!("\nnot settled: {question}"));
            }
            Ok((summary::exit(&summary), line))
        }
    }
}
