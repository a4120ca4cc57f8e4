//! `cognate results`: the answer of a job, as a table, as JSON, as files.

use super::watch::{ended, standing};
use crate::arguments::{Format, OutputArguments, Results};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output::certificates::Certificates;
use crate::output::files::Folder;
use crate::output::paths::Paths;
use crate::output::solution_list::SOLUTIONS_SHOWN;
use crate::output::text::{Look, counted};
use crate::output::{self, answers, decomposition, json, summary, table};
use cognate_protocol::v1;
use cognate_solutions::solution::Solution;
use cognate_summary::AnySummary;
use cognate_summary::decomposition::DecompositionSummary;

/// Shows a job's answer; the exit code is the job's.
pub async fn run(a: &Results) -> Result<Exit, ClientError> {
    let mut connection = Connection::open(&a.service.target()?).await?;
    let now = connection.progress(&a.job).await?;
    match now.state() {
        v1::JobState::Cancelled => return Err(ClientError::Cancelled),
        v1::JobState::Failed => return Err(ClientError::GaveUp(now.message)),
        state if !ended(state) => {
            let at = standing(&now);
            let paths = counted(at.total, "path");
            return Err(ClientError::Refused(format!(
                "job {} has not ended: {}, {} of {paths}; `cognate watch {}` waits for it",
                a.job, at.phase, at.done, a.job
            )));
        }
        _ => {}
    }
    show(&mut connection, &a.job, &a.output).await
}

/// Prints the answer of a finished job and writes the files that were asked for.
pub async fn show(
    connection: &mut Connection,
    job: &str,
    output: &OutputArguments,
) -> Result<Exit, ClientError> {
    let json = connection.summary(job).await?;
    let summary = match summary::read_any(&json)? {
        AnySummary::Solve(summary) => *summary,
        AnySummary::Decomposition(summary) => {
            return components(connection, job, &json, &summary, output).await;
        }
        AnySummary::Question(summary) => return answers::show(&json, &summary, output),
    };
    let mut rows: Vec<Solution> = vec![];
    let wanted = match output.format {
        Format::Table => SOLUTIONS_SHOWN,
        Format::Json => 0,
    };
    if let Some(path) = &output.output {
        let mut folder = Folder::create(path)?;
        if let Some(block) = &summary.monodromy
            && !block.parameters.is_empty()
        {
            folder.family(&block.parameters)?;
        }
        let mut certificates = Certificates::create(path, &summary)?;
        let several = !summary.targets.is_empty();
        connection
            .solutions(job, |solution, target| {
                let target = several.then_some(target);
                folder.solution(&solution, target)?;
                if let Some(certificates) = &mut certificates {
                    certificates.solution(&solution)?;
                }
                if rows.len() < wanted {
                    rows.push(solution);
                }
                Ok(true)
            })
            .await?;
        let mut paths = Paths::new(path.join("paths.parquet"));
        connection.paths(job, |path| paths.path(path)).await?;
        paths.finish()?;
        if let Some(certificates) = certificates {
            certificates.finish()?;
        }
        folder.finish(&json)?;
    } else if wanted > 0 {
        connection
            .solutions(job, |solution, _| {
                rows.push(solution);
                Ok(rows.len() < wanted)
            })
            .await?;
    }
    let text = match output.format {
        Format::Json => json::summary(&json),
        Format::Table => {
            let look = Look::of_standard_output();
            table::summary(&summary, &rows, output.output.as_deref(), look)
        }
    };
    output::print(&text)?;
    Ok(summary::exit(&summary))
}

/// The same for a decomposition.
async fn components(
    connection: &mut Connection,
    job: &str,
    json: &str,
    summary: &DecompositionSummary,
    output: &OutputArguments,
) -> Result<Exit, ClientError> {
    if let Some(folder) = &output.output {
        let found = connection.decomposition(job).await?;
        decomposition::write(folder, json, found)?;
    }
    let text = match output.format {
        Format::Json => json::summary(json),
        Format::Table => {
            let look = Look::of_standard_output();
            decomposition::table(summary, output.output.as_deref(), look)
        }
    };
    output::print(&text)?;
    Ok(decomposition::exit(summary))
}
