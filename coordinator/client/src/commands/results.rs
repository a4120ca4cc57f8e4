//! `cognate results`: the answer of a job, as a table, as JSON, as rows, as files.

use super::watch::{ended, standing};
use crate::arguments::{AnswerFormat, OutputArguments, Results};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output::certificates::Certificates;
use crate::output::files::Folder;
use crate::output::listed::{CsvRows, Listed, Listing, Rows, WantedCounts};
use crate::output::paths::Paths;
use crate::output::solution_list::solutions_shown;
use crate::output::sweep::Sweep;
use crate::output::text::{Look, counted};
use crate::output::{
    self, answers, beside_rows, decomposition, json, objects, summary, sweep_folder, table,
};
use crate::selection::View;
use cognate_protocol::v1;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::selection::SelectedCounts;
use cognate_solutions::solution::Solution;
use cognate_summary::AnySummary;
use cognate_summary::decomposition::DecompositionSummary;
use cognate_summary::solve::Summary;
use cognate_systems::condition::Conditions;
use cognate_systems::system::System;
use std::path::Path;

/// Shows a job's answer; the exit code is the job's.
pub async fn run(a: &Results) -> Result<Exit, ClientError> {
    let mut connection = Connection::open(&a.service.target()?).await?;
    let progress = connection.progress(&a.job).await?;
    match progress.state() {
        v1::JobState::Cancelled => return Err(ClientError::Cancelled),
        v1::JobState::Failed => return Err(ClientError::GaveUp(progress.message)),
        state if !ended(state) => {
            let at = standing(&progress);
            let paths = counted(at.total, "path");
            return Err(ClientError::Refused(format!(
                "job {} has not ended: {}, {} of {paths}; `cognate watch {}` waits for it",
                a.job, at.phase, at.done, a.job
            )));
        }
        _ => {}
    }
    let mut view = View::default();
    if !a.selection.is_empty() {
        let system = unknowns(&mut connection, &a.job).await?;
        let conditions = a.selection.conditions(&system, Conditions::default())?;
        let variables = system.variables.len();
        view = a.selection.view(&system, variables, conditions, vec![])?;
    }
    show(&mut connection, &a.job, &a.output, &mut view).await
}

/// A system without equations in the unknowns of a job's solutions.
async fn unknowns(connection: &mut Connection, job: &str) -> Result<System, ClientError> {
    let mut system = System::default();
    let take = |solution: Solution, _| {
        let names = solution.variables.0.into_iter();
        system.variables = names.map(|variable| variable.name).collect();
        Ok(false)
    };
    connection.solutions(job, take).await?;
    Ok(system)
}

/// Prints the answer of a finished job and writes the files that were asked for.
pub async fn show(
    connection: &mut Connection,
    job: &str,
    output: &OutputArguments,
    view: &mut View,
) -> Result<Exit, ClientError> {
    let json = connection.summary(job).await?;
    let summary = match summary::read_any(&json)? {
        AnySummary::Solve(summary) => *summary,
        AnySummary::Decomposition(summary) => {
            return components(connection, job, &json, &summary, output).await;
        }
        AnySummary::Question(summary) => return answers::show(&json, &summary, output),
    };
    let answer = Answer::gather(connection, job, json, summary, output, view).await?;
    let look = Look::of_standard_output();
    let text = match output.format {
        AnswerFormat::Json => answer.json().to_owned(),
        AnswerFormat::Table => {
            let files = output.output.as_deref();
            // Results of several targets are not added up.
            match answer
                .targets
                .as_ref()
                .filter(|targets| targets.rows.len() > 1)
            {
                Some(targets) => targets.table(files, look),
                None => table::summary(&answer.summary, &answer.rows, &answer.wanted, files, look),
            }
        }
        AnswerFormat::Jsonl | AnswerFormat::Csv => {
            let look = Look::of_standard_error();
            beside_rows::of_solve(&answer.summary, &answer.wanted, look).print();
            String::new()
        }
    };
    output::print(&text)?;
    Ok(answer.exit())
}

/// The answer of a solve: its counts, and the solutions that a table lists.
pub struct Answer {
    /// The summary.
    pub summary: Summary,
    /// The summary with the counts of the solutions that are wanted.
    json: String,
    /// The solutions that are listed, as many as were asked.
    pub rows: Vec<Listed>,
    wanted: WantedCounts,
    /// The answer at each target, where a family has targets.
    targets: Option<Sweep>,
}

impl Answer {
    /// Fetches the answer of a finished job, writes the files that were asked for, and prints rows.
    pub async fn gather(
        connection: &mut Connection,
        job: &str,
        json: String,
        summary: Summary,
        output: &OutputArguments,
        view: &mut View,
    ) -> Result<Self, ClientError> {
        let mut shown = ShownSolutions::new(&summary, output, view)?;
        let conditions = view.condition().map(SelectedCounts::of);
        let mut at_targets: Vec<SelectedCounts> = match conditions {
            Some(counts) => vec![counts; summary.targets.len()],
            None => Vec::new(),
        };
        let mut listing = Listing::new(view, !summary.targets.is_empty());
        if shown.takes_any() || listing.selects() {
            let take = |solution: Solution, target| {
                let presented = listing.presented(solution, target);
                let counts = at_targets.get_mut(target as usize);
                if let (Some(counts), Some(verdict)) = (counts, presented.verdict) {
                    counts.add(verdict);
                }
                shown.solution(&presented.solution)?;
                let listed = listing.take(presented, target);
                listed.map_or(Ok(()), |listed| shown.listed(listed))?;
                Ok(shown.takes_any() || listing.selects())
            };
            connection.solutions(job, take).await?;
        }
        for listed in listing.single_critical_points() {
            shown.listed(listed)?;
        }
        let (sorted, selected) = listing.finish();
        for listed in sorted {
            shown.listed(listed)?;
        }
        let wanted = WantedCounts {
            selected,
            critical: view.critical_counts(not_all(&summary, view.isolated_critical_points())),
            unknowns: view.unknowns().len(),
        };
        let has_targets = !summary.targets.is_empty();
        let targets = has_targets.then(|| Sweep::of_job(&summary, view, at_targets));
        let mut json = json::summary_with(&json, &wanted);
        if let Some(targets) = &targets {
            json = targets.added_to(&json);
        }
        let rows = shown
            .finish(connection, job, &json, targets.as_ref())
            .await?;
        Ok(Self {
            summary,
            json,
            rows,
            wanted,
            targets,
        })
    }

    /// The exit code: a doubt about the conditions is one about the answer.
    pub fn exit(&self) -> Exit {
        match self.wanted.undecided() {
            0 => summary::exit(&self.summary),
            _ => Exit::Unsettled,
        }
    }

    /// The summary with the counts of the solutions that are wanted.
    pub fn json(&self) -> &str {
        &self.json
    }
}

/// Why an answer may not hold all solutions; `None` where it does. `isolated` is the number of isolated solutions by a whole
/// decomposition, of which the sets are known as well.
pub(super) fn not_all(summary: &Summary, isolated: Option<u64>) -> Option<String> {
    let counts = &summary.solutions;
    if isolated == Some(counts.distinct) && summary.settled && counts.real.is_some() {
        None
    } else if counts.positive_dimensional == Some(true) {
        Some("there is a positive-dimensional set of them, which `cognate decompose` finds".into())
    } else if !summary.settled {
        Some("the answer is not settled".into())
    } else if counts.complete != Completeness::Yes {
        let reason = counts.complete_reason.clone();
        Some(reason.unwrap_or_else(|| "the start may miss some".into()))
    } else if counts.positive_dimensional.is_none() && counts.exact_count.is_none() {
        Some("it is not known whether there is a positive-dimensional set of them".into())
    } else if counts.real.is_none() {
        Some("it is not known which of them are real".into())
    } else {
        None
    }
}

/// Everything that the solutions of an answer are shown in.
struct ShownSolutions<'a> {
    files: Option<Files<'a>>,
    rows: Rows,
    table: Vec<Listed>,
    /// Rows that the table has at most.
    wanted: usize,
}

/// The folder of --output.
struct Files<'a> {
    path: &'a Path,
    folder: Folder,
    certificates: Option<Certificates>,
}

impl<'a> ShownSolutions<'a> {
    fn new(
        summary: &Summary,
        output: &'a OutputArguments,
        view: &View,
    ) -> Result<Self, ClientError> {
        let files = output
            .output
            .as_deref()
            .map(|path| Files::new(path, summary));
        Ok(Self {
            files: files.transpose()?,
            rows: Rows::of(output.format, || CsvRows::of_answer(summary, view)),
            table: Vec::new(),
            wanted: match output.format {
                AnswerFormat::Table => solutions_shown(output.show),
                _ => 0,
            },
        })
    }

    /// Whether one more solution would be shown.
    fn takes_any(&self) -> bool {
        self.files.is_some() || !self.rows.is_none() || self.table.len() < self.wanted
    }

    /// Takes a solution, which may be shown or not.
    fn solution(&mut self, solution: &Solution) -> Result<(), ClientError> {
        let Some(files) = &mut self.files else {
            return Ok(());
        };
        files.folder.solution(solution)?;
        match &mut files.certificates {
            Some(certificates) => certificates.solution(solution),
            None => Ok(()),
        }
    }

    /// Takes a solution that is shown.
    fn listed(&mut self, listed: Listed) -> Result<(), ClientError> {
        if let Some(files) = &mut self.files {
            files.folder.line(&listed)?;
        }
        self.rows.row(&listed)?;
        if self.table.len() < self.wanted {
            self.table.push(listed);
        }
        Ok(())
    }

    /// Completes all files; gives the rows of the table.
    async fn finish(
        self,
        connection: &mut Connection,
        job: &str,
        summary: &str,
        targets: Option<&Sweep>,
    ) -> Result<Vec<Listed>, ClientError> {
        self.rows.finish()?;
        if let Some(files) = self.files {
            let mut paths = Paths::new(files.path.join("paths.parquet"));
            connection.paths(job, |path| paths.path(path)).await?;
            paths.finish()?;
            if let Some(certificates) = files.certificates {
                certificates.finish()?;
            }
            files.folder.finish(summary)?;
            if let Some(targets) = targets {
                sweep_folder::write_table(files.path, targets)?;
            }
        }
        Ok(self.table)
    }
}

impl<'a> Files<'a> {
    fn new(path: &'a Path, summary: &Summary) -> Result<Self, ClientError> {
        let mut folder = Folder::create(path)?;
        if let Some(block) = &summary.monodromy
            && !block.parameters.is_empty()
        {
            folder.family(&block.parameters)?;
        }
        Ok(Self {
            path,
            folder,
            certificates: Certificates::create(path, summary)?,
        })
    }
}

/// Shows and writes the results of a decomposition.
async fn components(
    connection: &mut Connection,
    job: &str,
    json: &str,
    summary: &DecompositionSummary,
    output: &OutputArguments,
) -> Result<Exit, ClientError> {
    if let Some(folder) = &output.output {
        let decomposition_value = connection.decomposition(job).await?;
        decomposition::write(folder, json, decomposition_value)?;
    }
    let text = match output.format {
        AnswerFormat::Json => json::summary(json),
        AnswerFormat::Table => {
            let look = Look::of_standard_output();
            decomposition::table(summary, output.output.as_deref(), look)
        }
        AnswerFormat::Jsonl | AnswerFormat::Csv => {
            beside_rows::of_components(summary, Look::of_standard_error()).print();
            objects::rows(&summary.decomposition.components, output.format)
        }
    };
    output::print(&text)?;
    Ok(decomposition::exit(summary))
}
