//! Answers to clients: progress, results, lists, explanations.

use super::recorded::Recorded;
use super::{Coordinator, CoordinatorError, job_row};
use crate::jobs::planning::{Planned, STATE};
use crate::jobs::progress::JobProgress;
use crate::ledger::identity::{JobId, Tenant};
use crate::ledger::rows::{ChunkState, JobRow, JobState, StageRow, WorkerRow};
use crate::results::answer::StoredAnswer;
use cognate_algorithms::AnyAlgorithm;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::{StageId, Work};
use cognate_solutions::classification::Verdict;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::SolutionSet;
use cognate_summary::AnySummary;
use serde_json::json;
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep, timeout};

/// Pause between two messages to a client that watches a job, once it has watched for [`WATCHED`] times as long.
const SHORTEST: Duration = Duration::from_millis(50);
/// Ratio of the time that a client has watched to the pause before the next message, up to [`SHORTEST`]: the end of a
/// small job is reported at once.
const WATCHED: u32 = 10;
/// Longest time until the job of a watching client is read again: another coordinator may have changed it.
const LONGEST: Duration = Duration::from_secs(1);

/// Latest jobs among which the jobs of one tenant are looked for, when they are listed.
const LATEST_JOBS: u32 = 10_000;

/// One path of a finished job.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassifiedPath {
    /// Result of the last attempt at the path.
    pub result: PathResult,
    /// Class of the path's end.
    pub verdict: Verdict,
    /// The solution that it ended at, by its index among all solutions.
    pub solution: Option<u64>,
}

/// Explanation of a job's plan and outcome.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// Text for people.
    pub text: String,
    /// One JSON object, for programs.
    pub json: String,
}

impl Coordinator {
    /// How far a job is.
    pub async fn progress(&self, job: JobId) -> Result<JobProgress, CoordinatorError> {
        let row = job_row(&*self.ledger, job).await?;
        let stages = self.ledger.stages(job).await?;
        let mut purposes = HashMap::new();
        for stage in &stages {
            let definition = match self.stage_of(stage.definition).await {
                Ok(definition) => definition,
                // How far the job is can be said without.
                Err(error) if error.is_loss() => continue,
                Err(error) => return Err(error.into()),
            };
            let cells = match definition.work {
                Work::CountMixedCells => Some(self.cells_so_far(job, stage.stage).await?),
                _ => None,
            };
            purposes.insert(stage.stage, (definition.purpose(), cells));
        }
        let now = self.ledger.now().await?;
        Ok(JobProgress::new(&row, &stages, now, |stage: &StageRow| {
            purposes.get(&stage.stage).cloned().unwrap_or_default()
        }))
    }

    /// A job's progress: at once, then after every change; the last is the end.
    pub fn watch(
        self: &Arc<Self>,
        job: JobId,
    ) -> mpsc::Receiver<Result<JobProgress, CoordinatorError>> {
        let (sender, receiver) = mpsc::channel(4);
        let coordinator = Arc::clone(self);
        tokio::spawn(async move {
            let mut changes = coordinator.changes.of(job);
            let mut last: Option<JobProgress> = None;
            let begin = Instant::now();
            loop {
                changes.mark_unchanged();
                let progress = coordinator.progress(job).await;
                let ends = progress.as_ref().map_or(true, |p| p.state.has_ended());
                let news = match (&progress, &last) {
                    (Ok(now), Some(before)) => {
                        (now.state, &now.stages) != (before.state, &before.stages)
                            || now.elapsed_ms >= before.elapsed_ms + 1000
                    }
                    _ => true,
                };
                if news {
                    last = progress.as_ref().ok().cloned();
                    if sender.send(progress).await.is_err() {
                        return;
                    }
                }
                if ends {
                    return;
                }
                tokio::select! {
                    () = sender.closed() => return,
                    () = sleep(SHORTEST.min(begin.elapsed() / WATCHED)) => {}
                }
                tokio::select! {
                    () = sender.closed() => return,
                    // A change, or not: the ledger says what there is.
                    _ = timeout(LONGEST, changes.changed()) => {}
                }
            }
        });
        receiver
    }

    /// The latest jobs but for the `skip` newest, of all tenants or of one, newest first, each with its stages.
    pub async fn jobs(
        &self,
        skip: u32,
        limit: u32,
        tenant: Option<&Tenant>,
    ) -> Result<Vec<(JobRow, Vec<StageRow>)>, CoordinatorError> {
        let wanted = skip.saturating_add(limit);
        // Jobs of one tenant may stand behind many of others.
        let looked = match tenant {
            Some(_) => wanted.max(LATEST_JOBS),
            None => wanted,
        };
        let jobs = self.ledger.overviews(looked).await?.into_iter().rev();
        let tenant_jobs =
            jobs.filter(|(row, _)| tenant.is_none_or(|tenant| row.asked.tenant == *tenant));
        Ok(tenant_jobs
            .skip(skip as usize)
            .take(limit as usize)
            .collect())
    }

    /// The workers that were heard of last, latest first.
    pub async fn workers(&self, limit: u32) -> Result<Vec<WorkerRow>, CoordinatorError> {
        Ok(self.ledger.workers(limit).await?)
    }

    pub(super) async fn solved(&self, job: JobId) -> Result<JobRow, CoordinatorError> {
        let row = job_row(&*self.ledger, job).await?;
        if row.state == JobState::Solved {
            return Ok(row);
        }
        Err(CoordinatorError::NoResult {
            job,
            state: row.state,
            reason: row.reason,
        })
    }

    /// The summary of a solved job, as it was written.
    pub async fn summary(&self, job: JobId) -> Result<(AnySummary, String), CoordinatorError> {
        let row = self.solved(job).await?;
        let missing = || CoordinatorError::NoResult {
            job,
            state: row.state,
            reason: Some("its summary was not written".into()),
        };
        let bytes = self.store.get(row.summary.ok_or_else(missing)?).await?;
        let damaged = |what: String| {
            CoordinatorError::Problem(format!("the summary of job {job} cannot be read: {what}"))
        };
        let text = String::from_utf8(bytes.to_vec()).map_err(|e| damaged(e.to_string()))?;
        let summary = AnySummary::read(&text).map_err(|e| damaged(e.to_string()))?;
        Ok((summary, text))
    }

    /// The solution sets of a solved job, one for each target.
    pub async fn solutions(
        self: &Arc<Self>,
        job: JobId,
    ) -> Result<Arc<Vec<SolutionSet>>, CoordinatorError> {
        let digest = self.answer_of(job).await?;
        if let Some(sets) = self.solutions.get(&digest) {
            return Ok(sets);
        }
        match StoredAnswer::get(&self.store, digest).await? {
            StoredAnswer::Isolated(sets) => {
                let sets = Arc::new(sets);
                self.solutions.keep(digest, Arc::clone(&sets));
                Ok(sets)
            }
            StoredAnswer::Large(answer) => Ok(Arc::new(self.whole(job, answer).await?)),
            other => Err(CoordinatorError::OtherAnswer {
                job,
                is: other.describe(),
            }),
        }
    }

    /// The object with the answer of a solved job.
    pub(super) async fn answer_of(&self, job: JobId) -> Result<Digest, CoordinatorError> {
        let row = self.solved(job).await?;
        row.solutions.ok_or(CoordinatorError::NoResult {
            job,
            state: row.state,
            reason: Some("its solutions were not written".into()),
        })
    }

    /// All paths of a solved job, by their indices.
    pub async fn paths(
        self: &Arc<Self>,
        job: JobId,
    ) -> Result<Vec<ClassifiedPath>, CoordinatorError> {
        let row = self.solved(job).await?;
        if let Some(answers) = self.all_answers(job).await? {
            return Ok(answers.into_iter().map(|answered| answered.path).collect());
        }
        let sets = self.solutions(job).await?;
        let system = self.problem(row.asked.problem).await?;
        let mut results = Vec::new();
        let stages = self.ledger.stages(job).await?;
        let state = match row.snapshot {
            // Found while it was planned.
            None if stages.is_empty() => Some(Planned::from_bytes(&row.asked.options)?.first_state),
            state => state,
        };
        let counted = match state {
            None => StageId(0),
            Some(state) => {
                let state = self.store.bytes_record(&STATE, state).await?;
                let algorithm = AnyAlgorithm::restore(&state).map_err(|error| {
                    CoordinatorError::Problem(format!(
                        "the state of job {job} cannot be read: {error}"
                    ))
                })?;
                if let Some(results) = algorithm.renumbered_results() {
                    return Ok(classified(results, &sets, &PointShape::of(&system)));
                }
                algorithm.counted_stage()
            }
        };
        for stage in stages.into_iter().filter(|stage| stage.stage >= counted) {
            if !self.stage_of(stage.definition).await?.work.tracks_paths() {
                continue; // its items are no paths
            }
            let (mut from, first) = (0, results.is_empty());
            loop {
                let rows = self
                    .ledger
                    .finished_chunks(job, stage.stage, from, 1000)
                    .await?;
                let Some(last) = rows.last() else { break };
                from = last.items.last;
                for row in rows {
                    let (ChunkState::Accepted { result, .. } | ChunkState::Failed { result }) =
                        row.state
                    else {
                        continue;
                    };
                    for result in self.store.paths(&result).await? {
                        if first {
                            results.push(result);
                        } else if let Ok(place) = usize::try_from(result.origin.0)
                            && place < results.len()
                        {
                            results[place] = result;
                        }
                    }
                }
            }
        }
        Ok(classified(results, &sets, &PointShape::of(&system)))
    }

    /// Explains the plan of a job and its outcome.
    pub async fn explain(&self, job: JobId) -> Result<Explanation, CoordinatorError> {
        let row = job_row(&*self.ledger, job).await?;
        let planned = Planned::from_bytes(&row.asked.options)?;
        let progress = self.progress(job).await?;
        let summary = match row.state {
            JobState::Solved => Some(self.summary(job).await?.0),
            _ => None,
        };
        // Where workers count mixed cells, how many paths there are is known after that.
        let tracked = progress.stages.iter().find(|s| s.mixed_cells.is_none());
        let paths = planned.paths.or(tracked.map(|stage| stage.total));
        let mut lines = vec![
            format!("job {job}: {} ({})", planned.name, row.state.name()),
            format!(
                "problem {}: {} equations in {} variables",
                planned.problem, planned.equations, planned.variables
            ),
            format!(
                "start {}: {}; {} paths, seed {}",
                planned.start,
                planned.why,
                paths.map_or("an unknown number of".to_owned(), |n| n.to_string()),
                planned.seed
            ),
        ];
        if !progress.message.is_empty() {
            lines.push(format!("reason: {}", progress.message));
        }
        for stage in &progress.stages {
            lines.push(format!(
                "stage {} ({}): {} items; {} done, {} given up, {} with workers, {} waiting",
                stage.stage.0,
                stage.purpose,
                stage.total,
                stage.accepted,
                stage.failed,
                stage.leased,
                stage.ready
            ));
        }
        let rows = self.ledger.stages(job).await?;
        let late: u64 = rows.iter().map(|stage| stage.speculative_leases).sum();
        let won: u64 = rows.iter().map(|stage| stage.speculative_won).sum();
        if late > 0 {
            lines.push(format!(
                "late: {late} chunks were given to a second worker, which reported {won} of them first"
            ));
        }
        let standing = match row.state.has_ended() {
            true => Vec::new(),
            false => self.standing_still(&row).await?,
        };
        lines.extend(standing.iter().cloned());
        lines.extend(summary.iter().flat_map(AnySummary::lines));
        let stages: Vec<_> = progress
            .stages
            .iter()
            .map(|stage| {
                // How many paths there are is not known while their cells are counted.
                let paths = stage.mixed_cells.is_none().then_some(stage.total);
                json!({
                    "stage": stage.stage.0, "purpose": stage.purpose, "paths": paths,
                    "ready": stage.ready, "leased": stage.leased, "accepted": stage.accepted,
                    "failed": stage.failed, "mixed_cells": stage.mixed_cells,
                })
            })
            .collect();
        let json = json!({
            "job": job.to_string(),
            "name": planned.name,
            "state": row.state.name(),
            "reason": row.reason,
            "problem": planned.problem.to_string(),
            "start": planned.start,
            "why": planned.why,
            "paths": paths,
            "seed": planned.seed,
            "stages": stages,
            "speculative_leases": late,
            "speculative_won": won,
            "standing": standing,
            "summary": summary,
        });
        Ok(Explanation {
            text: lines.join("\n"),
            json: json.to_string(),
        })
    }
}

/// Every path with its class and its solution; solutions are counted through all targets.
fn classified(
    results: Vec<PathResult>,
    sets: &[SolutionSet],
    shape: &PointShape,
) -> Vec<ClassifiedPath> {
    let mut solution_of = HashMap::new();
    let mut number = 0;
    for set in sets {
        for solution in set.points() {
            solution_of.extend(solution.paths.iter().map(|&path| (path, number)));
            number += 1;
        }
    }
    let recorded = Recorded::new(sets);
    results
        .into_iter()
        .map(|result| ClassifiedPath {
            verdict: recorded.verdict(&result, shape),
            solution: solution_of.get(&result.origin.0).copied(),
            result,
        })
        .collect()
}
