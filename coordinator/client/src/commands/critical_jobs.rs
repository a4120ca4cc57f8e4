//! Jobs beside that of the critical points: their positive-dimensional sets, on each of which an objective has one value,
//! points near them, which tell whether it is taken, and values on a large sphere.

use super::results::not_all;
use super::sequence::ended;
use crate::connection::{Connection, Target};
use crate::error::{ClientError, Exit};
use crate::output::progress::Progress;
use crate::output::summary;
use crate::problem::Prepared;
use crate::selection::View;
use crate::sets::KnownSet;
use cognate_protocol::submission::{Decompose, Options, Source};
use cognate_solutions::solution::Solution;
use cognate_summary::AnySummary;
use cognate_summary::solve::Summary;
use cognate_systems::system::System;

/// Decomposes a system of critical points and hands its components to the objective of the view. Nothing is handed over
/// where the decomposition is not settled.
pub(super) async fn add_sets(
    target: &Target,
    prepared: Prepared,
    view: &mut View,
    progress: &mut Progress,
) -> Result<(), ClientError> {
    progress.say("critical points are not isolated: their sets are found");
    let plain = with_plain_options(prepared);
    let mut decomposition = plain.clone();
    decomposition.submission.options.decompose = Some(Decompose::default());
    let (mut connection, job) = ended(target, decomposition, progress).await?;
    let answer = summary::read_any(&connection.summary(&job).await?)?;
    if matches!(answer, AnySummary::Decomposition(summary) if summary.settled) {
        let set = KnownSet::of_job(&mut connection, &job).await?;
        view.add_critical_sets(&set.sets());
    }
    if let Some(system) = view.near_critical_sets() {
        progress.say("whether their values are taken: points near the sets are found");
        let near = with_system(&plain, system);
        if let Some(near) = solve_beside(target, near, progress).await? {
            let are_all = not_all(&near.summary, None).is_none();
            view.add_points_near_critical_sets(near.solutions, are_all);
        }
    }
    if let Some(system) = view.farthest() {
        let farthest = with_system(&plain, system);
        if let Some(points) = all_points(target, farthest, progress).await? {
            view.add_farthest_points(points);
        }
    }
    Ok(())
}

/// Hands the values on a large sphere to the objective of the view, where they are needed to tell whether it grows beyond
/// its critical points. Nothing is handed over where a solve on the way is not settled.
pub(super) async fn add_sphere(
    connection: &mut Connection,
    job: &str,
    target: &Target,
    prepared: Prepared,
    view: &mut View,
    progress: &mut Progress,
) -> Result<(), ClientError> {
    let critical = all_solutions(connection, job).await?;
    let Some(turning_points) = view.turning_points(&critical) else {
        return Ok(());
    };
    progress.say("whether there are better values towards infinity: large spheres are looked at");
    let plain = with_plain_options(prepared);
    let turning = with_system(&plain, turning_points);
    let Some(turning) = all_points(target, turning, progress).await? else {
        return Ok(());
    };
    let Some(on_sphere) = view.on_sphere(&turning, &critical) else {
        return Ok(());
    };
    let on_sphere = with_system(&plain, on_sphere);
    if let Some(points) = all_points(target, on_sphere, progress).await? {
        view.add_points_on_sphere(&points);
    }
    Ok(())
}

/// All solutions of a problem; `None` where they are not known to be all.
async fn all_points(
    target: &Target,
    prepared: Prepared,
    progress: &mut Progress,
) -> Result<Option<Vec<Solution>>, ClientError> {
    let solved = solve_beside(target, prepared, progress).await?;
    let settled = solved.filter(|solved| not_all(&solved.summary, None).is_none());
    Ok(settled.map(|solved| solved.solutions))
}

/// The answer of a job beside that of the critical points.
struct Solved {
    summary: Summary,
    solutions: Vec<Solution>,
}

/// Solves a system of our own; `None` where it is refused or fails, which leaves a question open and is no error of the user.
async fn solve_beside(
    target: &Target,
    prepared: Prepared,
    progress: &mut Progress,
) -> Result<Option<Solved>, ClientError> {
    let (mut connection, job) = match ended(target, prepared, progress).await {
        Ok(answered) => answered,
        Err(ClientError::GaveUp(_)) => return Ok(None),
        Err(error) if error.exit() == Exit::BadInput => return Ok(None),
        Err(error) => return Err(error),
    };
    let summary = summary::read(&connection.summary(&job).await?)?;
    let solutions = all_solutions(&mut connection, &job).await?;
    Ok(Some(Solved { summary, solutions }))
}

async fn all_solutions(
    connection: &mut Connection,
    job: &str,
) -> Result<Vec<Solution>, ClientError> {
    let mut solutions = Vec::new();
    let take = |solution, _| {
        solutions.push(solution);
        Ok(true)
    };
    connection.solutions(job, take).await?;
    Ok(solutions)
}

/// A problem without a start and without closings, which are not those of another system.
fn with_plain_options(mut prepared: Prepared) -> Prepared {
    let asked = std::mem::take(&mut prepared.submission.options);
    prepared.submission.options = Options {
        seed: asked.seed,
        settings: asked.settings,
        precision: asked.precision,
        target_parameters: asked.target_parameters,
        name: asked.name,
        ..Options::default()
    };
    prepared
}

/// A problem with its system replaced.
fn with_system(prepared: &Prepared, system: System) -> Prepared {
    let mut other = prepared.clone();
    other.submission.source = Source::System(Box::new(system));
    other
}
