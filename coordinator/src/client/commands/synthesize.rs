//! `cognate synthesize`: from points to linkages, on a coordinator of its own or on a running one.

use crate::client::arguments::{NinePoint, SynthesisFormat, Synthesize};
use crate::client::embedded::Embedded;
use crate::client::error::{ClientError, Exit};
use crate::client::output;
use crate::client::output::linkages::{self, Sheet};
use crate::client::output::progress::Progress;
use crate::client::output::text::Look;
use crate::client::problem;
use crate::client::synthesis::{How, nine_points, point_files};
use cognate_kinematics::nine_point::{ClassEnd, PathPoints};
use std::time::Instant;

/// Finds all linkages, prints them, stops everything that it started.
pub async fn run(a: &Synthesize) -> Result<Exit, ClientError> {
    let Synthesize::NinePoint(a) = a;
    let (name, content) = problem::read_file(&a.file)?;
    let points = point_files::read(&name, &content).map_err(ClientError::Format)?;
    if let Some(coordinator) = &a.coordinator {
        return tokio::select! {
            ended = find(a, &points, coordinator) => ended,
            () = crate::client::interrupted() => Err(ClientError::Interrupted),
        };
    }
    let mut service = Embedded::start(a.workers, a.threads).await?;
    let address = service.address();
    let ended = tokio::select! {
        ended = find(a, &points, &address) => ended,
        error = service.abandoned() => Err(error),
        () = crate::client::interrupted() => Err(ClientError::Interrupted),
    };
    service.stop().await;
    ended
}

async fn find(a: &NinePoint, points: &PathPoints, address: &str) -> Result<Exit, ClientError> {
    let began = Instant::now();
    let quiet = a.format != SynthesisFormat::Table;
    let mut progress = Progress::new(quiet, began);
    let how = How {
        seed: a.seed,
        preset: a.preset,
        precision: a.precision,
        certify: a.certify,
        name: problem::short_name(&a.file).chars().take(60).collect(),
    };
    let answer = nine_points(address, points, &how, &mut progress).await;
    progress.finish();
    let sheet = Sheet::new(&how.name, points, answer?, a.certify, began.elapsed());
    if let Some(folder) = &a.output {
        linkages::write(folder, &sheet)?;
    }
    let text = match a.format {
        SynthesisFormat::Table => {
            linkages::table::sheet(&sheet, a.output.as_deref(), Look::of_standard_output())
        }
        SynthesisFormat::Json => linkages::json::sheet(&sheet),
        SynthesisFormat::Csv => linkages::csv::sheet(&sheet),
    };
    output::print(&text)?;
    Ok(match sheet.count(ClassEnd::Failed) {
        0 => Exit::Solved,
        _ => Exit::Unsettled,
    })
}
