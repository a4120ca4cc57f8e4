//! The answer of a large job: what is not held is read again from its results, a chunk at a time.

use super::answers::ClassifiedPath;
use super::recorded::{Recorded, was_at_infinity};
use super::{Coordinator, CoordinatorError};
use crate::jobs::large_stage::{page, read};
use crate::jobs::planning::STATE;
use crate::ledger::identity::JobId;
use crate::ledger::rows::JobRow;
use crate::results::answer::{LargeAnswer, StoredAnswer};
use cognate_algorithms::AnyAlgorithm;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::StageId;
use cognate_solutions::classification::Verdict;
use cognate_solutions::solution::Solution;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::streamed::PathFilter;
use futures::StreamExt;
use std::collections::HashMap;
use std::sync::Arc;
use tokio::sync::mpsc;

/// A path, and what is named for it.
pub struct Answered {
    /// The path with its class.
    pub path: ClassifiedPath,
    /// The solution of which it is the first path, and the target that has it.
    pub solution: Option<(u32, Solution)>,
}

/// Chunks of answers that wait for a client.
const AHEAD: usize = 1;

impl Coordinator {
    /// A solved job's answer, where it is large.
    pub(super) async fn large(
        &self,
        row: &JobRow,
    ) -> Result<Option<LargeAnswer>, CoordinatorError> {
        Ok(match row.solutions {
            Some(digest) => StoredAnswer::large(&self.store, digest).await?,
            None => None,
        })
    }

    /// All paths of a large job by their indices, each with its solution if it is the first to end there;
    /// a chunk at a time, as fast as they are taken. `None` where the job is not large.
    pub async fn answers(
        self: &Arc<Self>,
        job: JobId,
    ) -> Result<Option<mpsc::Receiver<Result<Vec<Answered>, CoordinatorError>>>, CoordinatorError>
    {
        let row = self.solved(job).await?;
        let Some(answer) = self.large(&row).await? else {
            return Ok(None);
        };
        let (sender, receiver) = mpsc::channel(AHEAD);
        let coordinator = Arc::clone(self);
        tokio::spawn(async move {
            if let Err(error) = coordinator.stream(&row, answer, &sender).await {
                // The receiver may be gone.
                let _ = sender.send(Err(error)).await;
            }
        });
        Ok(Some(receiver))
    }

    /// All answers at once.
    pub(super) async fn all_answers(
        self: &Arc<Self>,
        job: JobId,
    ) -> Result<Option<Vec<Answered>>, CoordinatorError> {
        let Some(mut receiver) = self.answers(job).await? else {
            return Ok(None);
        };
        let mut answers = Vec::new();
        while let Some(some) = receiver.recv().await {
            answers.extend(some?);
        }
        Ok(Some(answers))
    }

    async fn stream(
        &self,
        row: &JobRow,
        answer: LargeAnswer,
        listener: &mpsc::Sender<Result<Vec<Answered>, CoordinatorError>>,
    ) -> Result<(), CoordinatorError> {
        let job = row.job;
        let system = self.problem(row.asked.problem).await?;
        let unreadable = |what: String| {
            CoordinatorError::Problem(format!("the state of job {job} cannot be read: {what}"))
        };
        let state = row
            .snapshot
            .ok_or_else(|| unreadable("there is none".into()))?;
        let state = self.store.bytes_record(&STATE, state).await?;
        let algorithm = AnyAlgorithm::restore(&state).map_err(|e| unreadable(e.to_string()))?;
        let large = algorithm
            .large()
            .ok_or_else(|| unreadable("it is of another kind".into()))?;
        let first = large.first_id();
        let filters = algorithm.filters(&system);
        let items = large.first().items().unwrap_or_default();
        let mut answers = AnswerStream {
            paths_per_target: (items / filters.len() as u64).max(1),
            filters,
            again: self.tracked_again(job, first).await?,
            held: Held::new(answer),
            exact: large.first().settings.exact_data,
            number: 0,
        };
        let mut from = 0;
        loop {
            let objects = page(&*self.ledger, job, first, from).await?;
            let Some(last) = objects.last() else {
                return Ok(());
            };
            from = last.items.last;
            let mut chunks = std::pin::pin!(read(&self.store, objects));
            while let Some(results) = chunks.next().await {
                let results = results?;
                let answering = tokio::task::spawn_blocking(move || {
                    let some = results.into_iter().map(|r| answers.answer(r)).collect();
                    (answers, some)
                });
                let some;
                (answers, some) = match answering.await {
                    Ok(done) => done,
                    Err(error) => std::panic::resume_unwind(error.into_panic()),
                };
                if listener.send(Ok(some)).await.is_err() {
                    return Ok(());
                }
            }
        }
    }

    /// The last results of paths that were tracked more than once.
    async fn tracked_again(
        &self,
        job: JobId,
        first: StageId,
    ) -> Result<HashMap<u64, PathResult>, CoordinatorError> {
        let mut retracked_paths = HashMap::new();
        let stages = self.ledger.stages(job).await?.into_iter();
        for stage in stages.filter(|stage| stage.stage > first) {
            if !self.stage_of(stage.definition).await?.work.tracks_paths() {
                continue; // its items are no paths
            }
            let mut from = 0;
            loop {
                let objects = page(&*self.ledger, job, stage.stage, from).await?;
                let Some(last) = objects.last() else { break };
                from = last.items.last;
                let mut chunks = std::pin::pin!(read(&self.store, objects));
                while let Some(results) = chunks.next().await {
                    retracked_paths.extend(results?.into_iter().map(|r| (r.origin.0, r)));
                }
            }
        }
        Ok(retracked_paths)
    }

    /// The solution sets of a large job with all their solutions.
    pub(super) async fn whole(
        self: &Arc<Self>,
        job: JobId,
        mut answer: LargeAnswer,
    ) -> Result<Vec<SolutionSet>, CoordinatorError> {
        for set in &mut answer.sets {
            set.solutions.clear();
            set.undecided.clear();
        }
        let answers = self.all_answers(job).await?.unwrap_or_default();
        for (target, point) in answers.into_iter().filter_map(|answered| answered.solution) {
            let Some(set) = answer.sets.get_mut(target as usize) else {
                continue; // a target for each set
            };
            match point.undecided {
                true => set.undecided.push(point),
                false => set.solutions.push(point),
            }
        }
        Ok(answer.sets)
    }
}

/// Data of the paths that are held in memory.
struct Held {
    paths: Vec<u64>,
    /// The solutions, and the points of which it is not known whether they are isolated.
    solutions: Vec<Solution>,
    /// Number of each solution among all solutions.
    numbers: Vec<Option<u64>>,
    /// The solution of each path.
    solution_of: HashMap<u64, usize>,
    recorded: Recorded,
}

impl Held {
    fn new(answer: LargeAnswer) -> Self {
        let recorded = Recorded::new(&answer.sets);
        let mut solutions = Vec::new();
        for set in answer.sets {
            solutions.extend(set.solutions.into_iter().chain(set.undecided));
        }
        let ends = |(k, solution): (usize, &Solution)| -> Vec<(u64, usize)> {
            solution.paths.iter().map(|&path| (path, k)).collect()
        };
        Self {
            paths: answer.held,
            solution_of: solutions.iter().enumerate().flat_map(ends).collect(),
            numbers: vec![None; solutions.len()],
            recorded,
            solutions,
        }
    }
}

/// Answers path after path, in the order of their indices.
struct AnswerStream {
    paths_per_target: u64,
    /// Filter of the paths of each target.
    filters: Vec<PathFilter>,
    again: HashMap<u64, PathResult>,
    held: Held,
    /// Whether the coefficients of the system count as exact.
    exact: bool,
    /// Number of solutions that were named.
    number: u64,
}

impl AnswerStream {
    fn next_number(&mut self) -> u64 {
        self.number += 1;
        self.number - 1
    }

    fn answer(&mut self, result: PathResult) -> Answered {
        let path = result.origin.0;
        let target = path / self.paths_per_target;
        let named = |solution| (u32::try_from(target).unwrap_or(u32::MAX), solution);
        let filter = &self.filters[target as usize];
        if self.held.paths.binary_search(&path).is_err() {
            let (verdict, solution) = match self.exact || !was_at_infinity(&result, filter.shape())
            {
                true => filter.answer(&result),
                false => (Verdict::AtInfinity, None),
            };
            let number = solution.is_some().then(|| self.next_number());
            let path = ClassifiedPath {
                verdict,
                solution: number,
                result,
            };
            return Answered {
                path,
                solution: solution.map(named),
            };
        }
        let result = self.again.remove(&path).unwrap_or(result);
        let mut verdict = self.held.recorded.verdict(&result, filter.shape());
        if verdict == Verdict::Finite && !self.held.solution_of.contains_key(&path) {
            // Each path that is held and finite has its solution.
            verdict = Verdict::AtInfinity;
        }
        let at = self.held.solution_of.get(&path).copied();
        let mut begun = None;
        if let Some(at) = at
            && self.held.numbers[at].is_none()
        {
            self.held.numbers[at] = Some(self.next_number());
            begun = Some(self.held.solutions[at].clone());
        }
        let path = ClassifiedPath {
            verdict,
            solution: at.and_then(|at| self.held.numbers[at]),
            result,
        };
        Answered {
            path,
            solution: begun.map(named),
        }
    }
}
