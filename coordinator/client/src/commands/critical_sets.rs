//! Positive-dimensional sets of critical points: an objective has one value on each, which is compared like that of a point.

use super::sequence::ended;
use crate::connection::Target;
use crate::error::ClientError;
use crate::output::progress::Progress;
use crate::output::summary;
use crate::problem::Prepared;
use crate::selection::View;
use crate::sets::KnownSet;
use cognate_protocol::submission::{Decompose, Options};
use cognate_summary::AnySummary;

/// Decomposes a system of critical points and hands its components to the objective of the view. Nothing is handed over
/// where the decomposition is not settled.
pub(super) async fn add(
    target: &Target,
    mut prepared: Prepared,
    view: &mut View,
    progress: &mut Progress,
) -> Result<(), ClientError> {
    progress.say("critical points are not isolated: their sets are found");
    // A start, and what closes a solve, are not those of a decomposition.
    let asked = std::mem::take(&mut prepared.submission.options);
    prepared.submission.options = Options {
        seed: asked.seed,
        settings: asked.settings,
        precision: asked.precision,
        target_parameters: asked.target_parameters,
        name: asked.name,
        decompose: Some(Decompose::default()),
        ..Options::default()
    };
    let (mut connection, job) = ended(target, prepared, progress).await?;
    let answer = summary::read_any(&connection.summary(&job).await?)?;
    if matches!(answer, AnySummary::Decomposition(summary) if summary.settled) {
        let set = KnownSet::of_job(&mut connection, &job).await?;
        view.add_critical_sets(&set.sets());
    }
    Ok(())
}
