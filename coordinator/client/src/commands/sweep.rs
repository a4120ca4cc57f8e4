//! Sweep: a family at many values of its parameters. It is solved once at general values; its solutions are followed from
//! there to all targets, and targets where that leaves a doubt are solved by themselves.

use super::general_values::{general_values, rounded_sizes};
use super::sequence::ended;
use crate::arguments::{AnswerFormat, OutputArguments, ProgressArguments};
use crate::connection::{Connection, Target};
use crate::error::{ClientError, Exit};
use crate::output::progress::{Progress, Standing};
use crate::output::summary;
use crate::output::sweep::{Family, FamilySource, Row, Sweep};
use crate::output::sweep_solutions::{BatchSolutions, SweepSolutions, TargetSolutions};
use crate::output::text::{Look, counted};
use crate::problem::Prepared;
use crate::selection::View;
use cognate_continuation::start_points::StoredPoints;
use cognate_mechanism_solver::cache::{Cache, Entry, Kept, Key};
use cognate_numeric::rational::ComplexRational;
use cognate_protocol::digest::encode_system;
use cognate_protocol::submission::{Source, StartKind, StartSolutions};
use cognate_solutions::closing_options::ClosingOptions;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::summary::SolutionCounts;
use cognate_summary::solve::{Summary, TargetBlock};
use cognate_systems::polynomial::{SolutionCount, solution_count};
use cognate_systems::system::System;
use futures::StreamExt;
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::ops::Range;
use std::time::Instant;

/// Seed of the general values where none is given.
const SEED: u64 = 1;
/// Targets of one job at most: its summary has about 2 KB for each.
const TARGETS_OF_A_JOB: usize = 5_000;
/// Paths of one job at most: a coordinator holds their ends.
const PATHS_OF_A_JOB: usize = 200_000;
/// Values of parameters in one job at most; a message takes 64 MB.
const VALUES_OF_A_JOB: usize = 2_000_000;
/// Solves with other random numbers, where the first leaves doubts that may be bad luck.
const ATTEMPTS: u64 = 2;
/// Targets that are solved by themselves at one time.
const SIDE_BY_SIDE: usize = 8;

/// Operations of an exact count: some tenths of a second.
const COUNT_OPERATIONS: u64 = 100_000_000;
/// Why a base is whole that paths alone leave in doubt.
const BY_EXACT_COUNT: &str = "as many solutions as general values have by an exact count";

/// Solves the family and follows it to all targets; prints the answer.
pub(super) async fn run(
    output: &OutputArguments,
    progress: &ProgressArguments,
    mut prepared: Prepared,
    view: &mut View,
    target: &Target,
) -> Result<Exit, ClientError> {
    let began = Instant::now();
    let quiet = output.format != AnswerFormat::Table;
    let options = &mut prepared.submission.options;
    let warnings = std::mem::take(&mut options.warnings);
    let jobs = Jobs {
        target: target.clone(),
        targets: std::mem::take(&mut options.target_parameters),
        prepared,
    };
    let mut answer = Answer {
        sweep: Sweep {
            condition: view.condition(),
            ..Sweep::new(&jobs.prepared.name, jobs.parameters(), warnings)
        },
        solutions: SweepSolutions::new(output, view)?,
        progress: Progress::of(progress.progress, quiet, began),
    };
    for warning in &answer.sweep.warnings {
        answer.progress.say(&format!("warning: {warning}"));
    }
    let solved = jobs.solve(&mut answer).await;
    let Answer {
        mut sweep,
        solutions,
        progress,
    } = answer;
    progress.finish();
    solved?;
    sweep.finish(&jobs.targets, began.elapsed().as_secs_f64());
    solutions.finish(&sweep)?;
    match output.format {
        AnswerFormat::Json => crate::output::print_json(&sweep)?,
        AnswerFormat::Table => {
            let look = Look::of_standard_output();
            crate::output::print(&sweep.table(output.output.as_deref(), look))?;
        }
        AnswerFormat::Jsonl | AnswerFormat::Csv => {
            sweep.beside_rows(Look::of_standard_error()).print();
        }
    }
    Ok(Exit::of_settled(sweep.settled))
}

/// Solutions of the family at general values, from which paths begin.
struct Base {
    parameters: Vec<Complex64>,
    points: StoredPoints,
    complete_reason: String,
}

/// One choice of general values.
struct Attempt {
    general: Vec<Complex64>,
    /// The problem at these values.
    prepared: Prepared,
    key: Key,
}

/// Why the solutions at general values are no base for others.
struct NoBase {
    /// How many solutions there are.
    solutions: u64,
    reason: String,
    /// Whether other general values would have the same reason.
    is_final: bool,
    /// How many solutions the equations have at general values, with multiplicities, where that was asked.
    exact_count: Option<u64>,
}

/// The answer in the making.
struct Answer<'a> {
    sweep: Sweep,
    solutions: SweepSolutions<'a>,
    progress: Progress,
}

/// Result for a target that was solved by itself.
struct Lone {
    index: usize,
    /// The connection with the job's answer, its id and its summary, or why there is none.
    job: Result<(Connection, String, Summary), String>,
}

/// The jobs of a sweep, with the data that they share.
struct Jobs {
    target: Target,
    targets: Vec<Vec<Complex64>>,
    /// The problem without targets.
    prepared: Prepared,
}

impl Jobs {
    fn system(&self) -> Option<&System> {
        match &self.prepared.submission.source {
            Source::System(system) => Some(system),
            Source::Text { .. } => None,
        }
    }

    fn parameters(&self) -> Vec<String> {
        let system = self.system();
        system.map_or_else(Vec::new, |system| system.parameters.clone())
    }

    /// The family, then every target.
    async fn solve(&self, answer: &mut Answer<'_>) -> Result<(), ClientError> {
        let base = self.base(answer).await?;
        let count = self.targets.len();
        let size = base.as_ref().map_or(count, |base| self.batch(base));
        for first in (0..count).step_by(size.max(1)) {
            let batch = first..count.min(first + size);
            if size < count {
                let numbers = format!("targets {} to {} of {count}", first + 1, batch.end);
                answer.progress.say(&numbers);
            }
            match &base {
                Some(base) => self.follow(base, batch, answer).await?,
                None => self.solve_each(batch, answer).await?,
            }
        }
        Ok(())
    }

    /// How many targets one job has.
    fn batch(&self, base: &Base) -> usize {
        let paths = PATHS_OF_A_JOB / base.points.len().max(1);
        let values = VALUES_OF_A_JOB / base.parameters.len().max(1);
        paths.min(values).clamp(1, TARGETS_OF_A_JOB)
    }

    /// The solutions at general values, of the cache or new, where they are a base for all others.
    async fn base(&self, answer: &mut Answer<'_>) -> Result<Option<Base>, ClientError> {
        let Some(system) = self.system() else {
            return Ok(None);
        };
        let reason = if system.equations.len() != system.dimension() {
            Some(format!(
                "{} for {}: solutions of special values need not come from general ones",
                counted(system.equations.len() as u64, "equation"),
                counted(system.dimension() as u64, "unknown")
            ))
        } else if system.helpers.is_empty() {
            None
        } else {
            let reason =
                "points on false branches of functions of unknowns would have to be followed, too";
            Some(reason.to_owned())
        };
        if let Some(reason) = reason {
            answer
                .progress
                .say(&format!("each target is solved by itself: {reason}"));
            answer.no_base(None, reason);
            return Ok(None);
        }
        let attempts: Vec<Attempt> = (0..ATTEMPTS).map(|k| self.attempt(system, k)).collect();
        let cache = Cache::of_families();
        if let Some(cache) = &cache {
            for attempt in &attempts {
                if let Some(kept) = answer.kept(cache, &attempt.key)
                    && let Some(base) = base_of_cache(kept, &attempt.general, system)
                {
                    answer.family(FamilySource::Cache, base.points.len());
                    return Ok(Some(base));
                }
            }
        }
        for (number, attempt) in attempts.iter().enumerate() {
            let mut solved = self.solved_base(attempt, system, answer).await?;
            if let Err(refusal) = &solved
                && number == 0
                && let Some(count) = refusal.exact_count
                && let Some(base) = self.base_by_targets(count, attempt, system, answer).await?
            {
                solved = Ok(base);
            }
            match solved {
                Ok(base) => {
                    answer.family(FamilySource::Solved, base.points.len());
                    if let Some(cache) = &cache {
                        answer.keep(cache, &attempt.key, &base);
                    }
                    return Ok(Some(base));
                }
                Err(refusal) => {
                    let is_final = refusal.is_final;
                    answer.no_base(Some(refusal.solutions), refusal.reason);
                    if is_final {
                        break;
                    }
                }
            }
        }
        let reason = answer.sweep.family.reason.clone().unwrap_or_default();
        let message = format!("each target is solved by itself: {reason}");
        answer.progress.say(&message);
        Ok(None)
    }

    /// General values of the parameters, the problem there, and its place in the cache.
    fn attempt(&self, system: &System, number: u64) -> Attempt {
        let seed = self.prepared.submission.options.seed.unwrap_or(SEED);
        let seed = seed.wrapping_add(number);
        let general = general_values(&rounded_sizes(&self.targets), seed);
        let prepared = self.at_general_values(&general);
        let options = format!("{:?}", prepared.submission.options);
        let version = env!("CARGO_PKG_VERSION");
        let system = encode_system(system);
        let parts = [&system[..], options.as_bytes(), version.as_bytes()];
        Attempt {
            key: Key::of_parts(&parts, &general, seed),
            general,
            prepared,
        }
    }

    /// The problem at general values, without proofs and other work on its solutions.
    fn at_general_values(&self, general: &[Complex64]) -> Prepared {
        let mut prepared = self.prepared.clone();
        let options = &mut prepared.submission.options;
        options.name.clear();
        options.target_parameters = vec![general.to_vec()];
        options.closings = ClosingOptions {
            no_exact_count: options.closings.no_exact_count,
            ..ClosingOptions::default()
        };
        prepared
    }

    /// Solves the family at general values; the inner error says why its solutions are no base.
    async fn solved_base(
        &self,
        attempt: &Attempt,
        system: &System,
        answer: &mut Answer<'_>,
    ) -> Result<Result<Base, NoBase>, ClientError> {
        let message = "solving the family at general values of its parameters";
        answer.progress.say(message);
        let prepared = attempt.prepared.clone();
        let (mut connection, job) = ended(&self.target, prepared, &mut answer.progress).await?;
        let summary = summary::read(&connection.summary(&job).await?)?;
        answer.sweep.add_time(&summary.time, summary.paths.total);
        if let Some(mut refusal) = why_no_base(&summary) {
            if !refusal.is_final && !attempt.prepared.submission.options.closings.no_exact_count {
                refusal.exact_count = general_count(system, &attempt.general);
            }
            if refusal.exact_count != Some(summary.solutions.nonsingular) {
                forget(&mut connection, &job).await;
                return Ok(Err(refusal));
            }
        }
        let points = nonsingular_points(&mut connection, &job, &summary, system).await?;
        let by_count = (!summary.settled).then(|| BY_EXACT_COUNT.to_owned());
        let reason = by_count.or(summary.solutions.complete_reason);
        Ok(Ok(Base {
            parameters: attempt.general.clone(),
            points,
            complete_reason: reason.unwrap_or_default(),
        }))
    }

    /// The solutions at general values by way of a target that has as many as general values have by an exact count.
    async fn base_by_targets(
        &self,
        count: u64,
        attempt: &Attempt,
        system: &System,
        answer: &mut Answer<'_>,
    ) -> Result<Option<Base>, ClientError> {
        let last = self.targets.len() - 1;
        for index in [0, last / 2, last] {
            let (from, to) = (&self.targets[index], &attempt.general);
            answer.progress.say(&format!(
                "paths at general values leave doubts; {} by an exact count: solving target {index}",
                counted(count, "solution")
            ));
            let Lone { job: Ok(lone), .. } = self.lone(index).await? else {
                continue;
            };
            let (mut connection, job, summary) = lone;
            answer.sweep.add_time(&summary.time, summary.paths.total);
            if summary.solutions.nonsingular != count {
                forget(&mut connection, &job).await;
                continue;
            }
            let points = nonsingular_points(&mut connection, &job, &summary, system).await?;
            let mut prepared = attempt.prepared.clone();
            start_from(&mut prepared, &points, from);
            prepared.submission.options.target_parameters = vec![to.clone()];
            let (mut connection, job) = ended(&self.target, prepared, &mut answer.progress).await?;
            let summary = summary::read(&connection.summary(&job).await?)?;
            answer.sweep.add_time(&summary.time, summary.paths.total);
            if summary.solutions.nonsingular == count {
                let points = nonsingular_points(&mut connection, &job, &summary, system).await?;
                return Ok(Some(Base {
                    parameters: to.clone(),
                    points,
                    complete_reason: BY_EXACT_COUNT.to_owned(),
                }));
            }
            forget(&mut connection, &job).await;
        }
        Ok(None)
    }

    /// Follows the solutions at general values to these targets, and solves those by themselves of which that leaves a
    /// doubt.
    async fn follow(
        &self,
        base: &Base,
        batch: Range<usize>,
        answer: &mut Answer<'_>,
    ) -> Result<(), ClientError> {
        let prepared = self.followed(base, batch.clone());
        let (mut connection, job) = ended(&self.target, prepared, &mut answer.progress).await?;
        let summary = summary::read(&connection.summary(&job).await?)?;
        answer.sweep.add_job(&summary);
        let blocks = blocks(summary);
        if blocks.len() != batch.len() {
            let message = "its summary has another number of targets".to_owned();
            return Err(ClientError::GaveUp(message));
        }
        let mut rows: Vec<Row> = blocks
            .iter()
            .map(|block| followed_row(block, base))
            .collect();
        let is_doubtful = |k: &usize| {
            let block = &blocks[k - batch.start];
            !is_answered(block, base) || depends_on_rounding(block, &self.targets[*k])
        };
        let doubtful: Vec<usize> = batch.clone().filter(is_doubtful).collect();
        if !doubtful.is_empty() {
            let targets = counted(doubtful.len() as u64, "target");
            answer.progress.say(&format!(
                "{targets} solved by themselves: solutions are singular or nearly so, or paths leave a doubt"
            ));
        }
        let mut lone_targets = self.side_by_side(doubtful);
        let mut aside = BTreeMap::new();
        while let Some(lone) = lone_targets.next().await {
            let lone = lone?;
            answer.show(lone.index, self.targets.len());
            let row = &mut rows[lone.index - batch.start];
            match lone.job {
                Err(reason) => answer.doubt(row, lone.index, &reason),
                Ok((mut connection, job, summary)) => {
                    answer.sweep.add_time(&summary.time, summary.paths.total);
                    *row = lone_row(&summary, Some(base));
                    let solutions = answer.solutions_of(&mut connection, &job, lone.index);
                    aside.insert(lone.index, solutions.await?);
                    forget(&mut connection, &job).await;
                }
            }
        }
        if answer.solutions.takes_any() {
            let mut shown = BatchSolutions::new(&mut answer.solutions, batch.start, aside);
            let take = |solution, target: u32| {
                shown.take(solution, batch.start + target as usize)?;
                Ok(true)
            };
            connection.solutions(&job, take).await?;
            for (row, selected) in rows.iter_mut().zip(shown.finish(batch.end)?) {
                row.select(selected);
            }
        }
        forget(&mut connection, &job).await;
        answer.sweep.rows.extend(rows);
        Ok(())
    }

    /// The problem at these targets, from the solutions at general values.
    fn followed(&self, base: &Base, batch: Range<usize>) -> Prepared {
        let mut prepared = self.prepared.clone();
        let options = &mut prepared.submission.options;
        options.target_parameters = self.targets[batch].to_vec();
        start_from(&mut prepared, &base.points, &base.parameters);
        prepared
    }

    /// Solves each of these targets by itself.
    async fn solve_each(
        &self,
        batch: Range<usize>,
        answer: &mut Answer<'_>,
    ) -> Result<(), ClientError> {
        let mut lone_targets = self.side_by_side(batch.collect());
        while let Some(lone) = lone_targets.next().await {
            let lone = lone?;
            answer.show(lone.index, self.targets.len());
            let row = match lone.job {
                Err(reason) => {
                    let mut row = Row::unanswered(&reason);
                    answer.doubt(&mut row, lone.index, &reason);
                    row
                }
                Ok((mut connection, job, summary)) => {
                    answer.sweep.add_job(&summary);
                    let solutions = answer.solutions_of(&mut connection, &job, lone.index);
                    let solutions = solutions.await?;
                    answer.solutions.write(&solutions)?;
                    forget(&mut connection, &job).await;
                    let mut row = lone_row(&summary, None);
                    row.select(solutions.selected);
                    row
                }
            };
            answer.sweep.rows.push(row);
        }
        Ok(())
    }

    /// Solves these targets by themselves, several at one time; the answers are in their order.
    fn side_by_side(
        &self,
        indices: Vec<usize>,
    ) -> impl futures::Stream<Item = Result<Lone, ClientError>> + Unpin {
        let lone = futures::stream::iter(indices).map(|index| self.lone(index));
        Box::pin(lone.buffered(SIDE_BY_SIDE))
    }

    /// Solves one target by itself; once more with another seed if paths fail.
    async fn lone(&self, index: usize) -> Result<Lone, ClientError> {
        let mut best = None;
        for number in 0..ATTEMPTS {
            let mut prepared = self.prepared.clone();
            let options = &mut prepared.submission.options;
            options.target_parameters = vec![self.targets[index].clone()];
            if number > 0 {
                options.seed = Some(options.seed.unwrap_or(SEED).wrapping_add(number));
            }
            let job = match ended(&self.target, prepared, &mut Progress::silent()).await {
                Ok((mut connection, job)) => {
                    let summary = summary::read(&connection.summary(&job).await?)?;
                    Ok((connection, job, summary))
                }
                // Other targets may well have answers.
                Err(ClientError::Refused(reason) | ClientError::GaveUp(reason)) => Err(reason),
                Err(error) => return Err(error),
            };
            let is_settled = job.as_ref().is_ok_and(|(.., summary)| summary.settled);
            let has_failed = job
                .as_ref()
                .is_ok_and(|(.., summary)| summary.paths.failed > 0);
            if is_settled || best.is_none() {
                best = Some(job);
            }
            if !has_failed {
                break;
            }
        }
        let job = best.unwrap_or_else(|| Err("it was not tried".to_owned()));
        Ok(Lone { index, job })
    }
}

impl Answer<'_> {
    /// Solutions that are shown of a job that solved the target of this index by itself.
    async fn solutions_of(
        &mut self,
        connection: &mut Connection,
        job: &str,
        index: usize,
    ) -> Result<TargetSolutions, ClientError> {
        let mut solutions = Vec::new();
        if self.solutions.takes_any() {
            let take = |solution, _| {
                solutions.push(solution);
                Ok(true)
            };
            connection.solutions(job, take).await?;
        }
        Ok(self.solutions.at(solutions, index))
    }

    fn warn(&mut self, warning: String) {
        self.progress.say(&format!("warning: {warning}"));
        self.sweep.warnings.push(warning);
    }

    /// The entry of the cache; one that cannot be used is said.
    fn kept(&mut self, cache: &Cache, key: &Key) -> Option<Kept> {
        match cache.find(key) {
            Entry::Absent => None,
            Entry::Found(kept) => Some(kept),
            Entry::Unusable(warning) => {
                self.warn(warning);
                None
            }
        }
    }

    /// Keeps a base for later sweeps; says so where that is not possible.
    fn keep(&mut self, cache: &Cache, key: &Key, base: &Base) {
        let kept = Kept {
            points: base.points.coordinates.clone(),
            others: base.complete_reason.clone(),
        };
        if let Some(warning) = cache.keep(key, &kept) {
            self.warn(warning);
        }
    }

    /// Records that the family has `count` solutions, which are followed to each target.
    fn family(&mut self, source: FamilySource, count: usize) {
        let from = match source {
            FamilySource::Cache => " (from the cache)",
            _ => "",
        };
        let solutions = counted(count as u64, "solution");
        self.progress.say(&format!(
            "{solutions} at general values{from}, followed to each target"
        ));
        self.sweep.family = Family {
            solutions: Some(count as u64),
            source,
            settled: true,
            reason: None,
        };
    }

    /// Records that no solutions can be followed, for this reason.
    fn no_base(&mut self, count: Option<u64>, reason: String) {
        self.sweep.family = Family {
            solutions: count,
            source: FamilySource::EachTarget,
            settled: false,
            reason: Some(reason),
        };
    }

    /// A target that could not be solved by itself.
    fn doubt(&mut self, row: &mut Row, index: usize, reason: &str) {
        row.settled = false;
        self.warn(format!("target {index}: {reason}"));
    }

    /// How far targets by themselves have come.
    fn show(&mut self, index: usize, targets: usize) {
        let standing = Standing {
            phase: "targets by themselves".to_owned(),
            done: index as u64 + 1,
            total: targets as u64,
            failed: 0,
            unit: "target",
        };
        self.progress.show(&standing, Instant::now());
    }
}

/// Whether the doubles that a target was followed to are not the short numbers that they stand for, and solutions there
/// depend on their last digits.
fn depends_on_rounding(block: &TargetBlock, values: &[Complex64]) -> bool {
    let numbers: Option<Vec<_>> = values
        .iter()
        .map(|z| ComplexRational::from_short(*z))
        .collect();
    let is_rounded = numbers.is_some_and(|numbers| {
        let mut both = numbers.into_iter().zip(values);
        both.any(|(number, value)| ComplexRational::from_doubles(*value) != Some(number))
    });
    block.solutions.ill_conditioned > 0 && is_rounded
}

/// Removes a job whose answer was taken, so that a coordinator does not hold those of all batches.
async fn forget(connection: &mut Connection, job: &str) {
    // The answer is here: what cannot be removed does no harm.
    let _ = connection.delete(job, false).await;
}

/// Makes paths begin at these points, which are solutions at these values of the parameters.
fn start_from(prepared: &mut Prepared, points: &StoredPoints, parameters: &[Complex64]) {
    let options = &mut prepared.submission.options;
    options.start = StartKind::Given;
    options.sets = None;
    options.start_solutions = Some(StartSolutions::Points(points.clone()));
    options.start_parameters = parameters.to_vec();
}

/// The nonsingular solutions of a job, which is removed then.
async fn nonsingular_points(
    connection: &mut Connection,
    job: &str,
    summary: &Summary,
    system: &System,
) -> Result<StoredPoints, ClientError> {
    let mut points = StoredPoints {
        dimension: system.variables.len(),
        coordinates: Vec::new(),
    };
    let coordinates = &mut points.coordinates;
    connection
        .solutions(job, |solution, _| {
            if !solution.singular && !solution.undecided {
                coordinates.extend(solution.variables.values());
            }
            Ok(true)
        })
        .await?;
    forget(connection, job).await;
    if points.len() as u64 != summary.solutions.nonsingular {
        let message = "it gave another number of solutions than its summary has";
        return Err(ClientError::GaveUp(message.to_owned()));
    }
    Ok(points)
}

/// The number of isolated solutions, with multiplicities, at general values; at special ones there are no more. `None`
/// where there are infinitely many, or the count takes too much.
fn general_count(system: &System, general: &[Complex64]) -> Option<u64> {
    let counted = solution_count(system, general, COUNT_OPERATIONS).ok()?;
    match counted.count {
        SolutionCount::Finite {
            with_multiplicity, ..
        } => Some(with_multiplicity),
        SolutionCount::Infinite { .. } => None,
    }
}

/// The base that was kept, where it has the form of one.
fn base_of_cache(kept: Kept, general: &[Complex64], system: &System) -> Option<Base> {
    let points = StoredPoints {
        dimension: system.variables.len(),
        coordinates: kept.points,
    };
    let is_whole = points
        .coordinates
        .len()
        .is_multiple_of(points.dimension.max(1));
    (is_whole && !points.is_empty()).then(|| Base {
        parameters: general.to_vec(),
        points,
        complete_reason: kept.others,
    })
}

/// Why the solutions at general values are no base for other values; `None` where they are one. A base has all isolated
/// solutions, each nonsingular, and no other solutions: then every isolated solution of a square system at special values
/// is the end of a path (Morgan, Sommese 1989: Coefficient-parameter polynomial continuation).
fn why_no_base(summary: &Summary) -> Option<NoBase> {
    let solutions = &summary.solutions;
    let refusal = |is_final: bool, reason: String| {
        Some(NoBase {
            solutions: solutions.distinct,
            reason: format!("at general values {reason}"),
            is_final,
            exact_count: None,
        })
    };
    if solutions.positive_dimensional == Some(true) {
        let reason = "there is a positive-dimensional set of solutions";
        // Without an exact count, paths may take a distant solution for a set.
        let is_counted = solutions.exact_count.is_some();
        return refusal(summary.settled && is_counted, reason.to_owned());
    }
    if !summary.settled {
        let open = summary::open_questions(summary).join("; ");
        return refusal(false, format!("there are doubts: {open}"));
    }
    if solutions.complete != Completeness::Yes {
        let reason = solutions.complete_reason.as_deref().unwrap_or_default();
        return refusal(false, format!("solutions may be missing: {reason}"));
    }
    if solutions.singular > 0 {
        let count = counted(solutions.singular, "solution");
        return refusal(true, format!("{count} singular"));
    }
    match solutions.nonsingular {
        0 => refusal(true, "there is no solution".to_owned()),
        _ => None,
    }
}

/// The counts of each target.
fn blocks(summary: Summary) -> Vec<TargetBlock> {
    match summary.targets.is_empty() {
        false => summary.targets,
        true => vec![TargetBlock {
            paths: summary.paths,
            solutions: summary.solutions,
            classes: summary.classes,
            certification: summary.certification,
            settled: summary.settled,
        }],
    }
}

/// Whether every path to this target has an end that leaves no doubt, and none of these is singular.
fn is_answered(block: &TargetBlock, base: &Base) -> bool {
    let (paths, solutions) = (&block.paths, &block.solutions);
    let doubts = [
        paths.failed,
        paths.undecided,
        paths.within_data_accuracy,
        paths.decided_by_precision_limit,
        paths.singular,
        paths.positive_dimensional.unwrap_or(0),
        paths.excess.unwrap_or(0),
        solutions.undecided,
        solutions.singular,
        solutions.doubtful_multiplicity,
        solutions.doubtful_denominators,
        solutions.without_conjugate,
    ];
    doubts.iter().all(|count| *count == 0)
        && paths.total == base.points.len() as u64
        && paths.crossings_found == paths.crossings_resolved
        && solutions.positive_dimensional != Some(true)
        && solutions.complete != Completeness::No
        && block.classes.doubt.is_none()
}

/// The row of a target that paths of the family lead to.
fn followed_row(block: &TargetBlock, base: &Base) -> Row {
    let settled = is_answered(block, base);
    let mut solutions = block.solutions.clone();
    if settled {
        solutions.complete = Completeness::Yes;
        let count = counted(base.points.len() as u64, "solution");
        let reason = format!("{count} at general values, each followed here");
        solutions.complete_reason = Some(reason);
    }
    Row {
        solutions,
        selected: None,
        settled,
        by_itself: false,
    }
}

/// The row of a target that was solved by itself. Where the family has no more solutions at general values than are here,
/// all nonsingular, none is missing: isolated solutions of special values are limits of those of general values.
fn lone_row(summary: &Summary, base: Option<&Base>) -> Row {
    let mut solutions: SolutionCounts = summary.solutions.clone();
    let is_whole = base.is_some_and(|base| {
        solutions.nonsingular == base.points.len() as u64
            && solutions.singular == 0
            && solutions.doubtful_denominators == 0
            && solutions.positive_dimensional != Some(true)
            && summary.classes.doubt.is_none()
    });
    if is_whole && !summary.settled {
        // A point that is not isolated is no solution to count.
        solutions.undecided = 0;
        solutions.complete = Completeness::Yes;
        solutions.complete_reason = Some("as many solutions as at general values".to_owned());
    }
    Row {
        solutions,
        selected: None,
        settled: summary.settled || is_whole,
        by_itself: true,
    }
}
