//! Sequence: jobs of one command, one after the other, at a running coordinator or at one of the command's own.

use super::{submit, watch};
use crate::common_arguments::{OwnOrRunning, ProgressForm};
use crate::connection::{Connection, Target};
use crate::error::{ClientError, Exit};
use crate::interruption::unless_interrupted;
use crate::output::progress::Progress;
use crate::output::{decomposition, summary};
use crate::problem::Prepared;
use crate::sets::KnownSet;
use cognate_protocol::v1::JobState;
use cognate_summary::AnySummary;
use cognate_summary::decomposition::DecompositionSummary;
use cognate_summary::question::QuestionSummary;
use futures::future::LocalBoxFuture;
use std::path::Path;
use std::time::Instant;

/// The running command that works with its sequence of jobs.
pub(super) type Working<'a> = LocalBoxFuture<'a, Result<Exit, ClientError>>;

/// Coordinator for all jobs of a command, with the form of progress.
pub(super) struct Sequence {
    target: Target,
    progress: ProgressForm,
    /// Whether programs read the answer, so that nothing is said beside it unless asked for.
    quiet: bool,
}

/// Does the work of a command at the running coordinator that was named, or at one of its own that is stopped then.
pub(super) async fn served<'a>(
    service: &OwnOrRunning,
    (progress, quiet): (ProgressForm, bool),
    running: Option<Target>,
    work: Box<dyn FnOnce(Sequence) -> Working<'a> + 'a>,
) -> Result<Exit, ClientError> {
    let sequence = |target| Sequence {
        target,
        progress,
        quiet,
    };
    if let Some(target) = running {
        return unless_interrupted(work(sequence(target))).await;
    }
    let mut embedded_service = service.start().await?;
    let jobs = sequence(embedded_service.target());
    let ended = embedded_service.attend(work(jobs)).await;
    embedded_service.stop().await;
    ended
}

/// Runs one job to its end: the connection that has its answer, and its id.
pub(super) async fn ended(
    target: &Target,
    prepared: Prepared,
    progress: &mut Progress,
) -> Result<(Connection, String), ClientError> {
    let mut connection = Connection::open(target).await?;
    let request = uuid::Uuid::new_v4().to_string();
    let (job, _) = submit::send(&mut connection, &request, prepared).await?;
    let (connection, last) = watch::follow(target, &job, progress).await?;
    match last.state() {
        JobState::Failed => Err(ClientError::GaveUp(last.message)),
        JobState::Cancelled => Err(ClientError::Cancelled),
        _ => Ok((connection, job)),
    }
}

impl Sequence {
    pub fn say(&self, what: &str) {
        Progress::of(self.progress, self.quiet, Instant::now()).say(what);
    }

    /// Runs one job to its end: its id and its summary, as text and typed.
    pub async fn answer(
        &self,
        prepared: Prepared,
    ) -> Result<(Connection, String, String, AnySummary), ClientError> {
        let (mut connection, job) = ended(&self.target, prepared, &mut Progress::silent()).await?;
        let text = connection.summary(&job).await?;
        let answer_summary = summary::read_any(&text)?;
        Ok((connection, job, text, answer_summary))
    }

    /// Asks one question to components.
    pub async fn question(&self, prepared: Prepared) -> Result<QuestionSummary, ClientError> {
        match self.answer(prepared).await? {
            (.., AnySummary::Question(answer)) => Ok(*answer),
            _ => Err(ClientError::GaveUp("its answer is of another kind".into())),
        }
    }

    /// Runs one decomposition: its summary and its set; writes files if a folder is named.
    pub async fn decompose(
        &self,
        prepared: Prepared,
        folder: Option<&Path>,
    ) -> Result<(DecompositionSummary, KnownSet), ClientError> {
        let (mut connection, job, text, answer_summary) = self.answer(prepared).await?;
        let AnySummary::Decomposition(summary) = answer_summary else {
            return Err(ClientError::GaveUp("its answer is no decomposition".into()));
        };
        if let Some(folder) = folder {
            let components = connection.decomposition(&job).await?;
            decomposition::write(folder, &text, components)?;
        }
        let set = KnownSet::of_job(&mut connection, &job).await?;
        Ok((*summary, set))
    }
}
