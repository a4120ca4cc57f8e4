//! `cognate synthesize`: from points, poses or angles to linkages, on a coordinator of its own or on a running one.

use crate::connection::Target;
use crate::error::{ClientError, Exit};
use crate::interruption::unless_interrupted;
use crate::output;
use crate::output::linkages::designs::{self, Designs};
use crate::output::linkages::spatial::{self, SpatialSheet};
use crate::output::linkages::{self, Sheet};
use crate::output::progress::Progress;
use crate::output::text::{self, Look, counted};
use crate::problem;
use crate::synthesis::arguments::{NinePoint, SynthesisArguments, SynthesisFormat, Synthesize};
use crate::synthesis::designs::{Sister, designs};
use crate::synthesis::spatial_dyads::spatial_dyads;
use crate::synthesis::{How, nine_points, point_files, position_files, sweep};
use cognate_kinematics::nine_point::family::CLASSES;
use cognate_kinematics::nine_point::{ClassEnd, PathPoints};
use cognate_kinematics::spatial_dyads::SpatialPoses;
use num_complex::Complex64;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The synthesis problem, read and checked.
enum Task {
    One(String, Box<PathPoints>),
    Many(String, Vec<(String, PathPoints)>),
    Sister(String, Sister),
    Spatial(String, SpatialPoses),
}

/// Finds all linkages, prints them, stops everything that it started.
pub async fn run(a: &Synthesize) -> Result<Exit, ClientError> {
    let task = match a {
        Synthesize::NinePoint(a) => read(a)?,
        Synthesize::BodyGuidance(a) => sister(&a.file, position_files::read_poses)?,
        Synthesize::PathTiming(a) => sister(&a.file, position_files::read_timed_points)?,
        Synthesize::FunctionGeneration(a) => sister(&a.file, position_files::read_angles)?,
        Synthesize::PosesAndPoints(a) => sister(&a.file, position_files::read_poses_and_points)?,
        Synthesize::BodyGuidanceTiming(a) => sister(&a.file, |name, content| {
            let poses = position_files::read_timed_poses(name, content)?;
            let pivots = a.pivot.iter().map(|[x, y]| Complex64::new(*x, *y));
            Ok(Sister::TimedPoses(poses, pivots.collect()))
        })?,
        Synthesize::SpatialDyads(a) => {
            let (name, content) = problem::read_file(&a.file)?;
            let poses = position_files::read_spatial_poses(&name, &content, a.chain);
            Task::Spatial(short(&a.file), poses.map_err(ClientError::Format)?)
        }
    };
    let a = a.common();
    if let Some(target) = a.service.running()? {
        return unless_interrupted(perform(a, &task, &target)).await;
    }
    let mut service = a.service.start().await?;
    let target = service.target();
    let ended = service.attend(perform(a, &task, &target)).await;
    service.stop().await;
    ended
}

fn read(a: &NinePoint) -> Result<Task, ClientError> {
    let one = |path: &PathBuf| {
        let (name, content) = problem::read_file(path)?;
        let points = point_files::read(&name, &content).map_err(ClientError::Format)?;
        Ok((short(path), points))
    };
    let first = a.file.as_ref().map(one).transpose()?;
    if let Some(path) = &a.targets {
        let (name, content) = problem::read_file(path)?;
        let mut sets = point_files::read_many(&name, &content).map_err(ClientError::Format)?;
        sets.splice(0..0, first);
        return Ok(Task::Many(short(path), sets));
    }
    let Some((name, points)) = first else {
        unreachable!("the arguments name points or --targets")
    };
    Ok(Task::One(name, Box::new(points)))
}

/// Short name of a file, cut to what fits beside other words.
fn short(path: &Path) -> String {
    problem::short_name(path).chars().take(60).collect()
}

fn sister(
    path: &Path,
    read: impl Fn(&str, &[u8]) -> Result<Sister, String>,
) -> Result<Task, ClientError> {
    let (name, content) = problem::read_file(path)?;
    let sister = read(&name, &content).map_err(ClientError::Format)?;
    Ok(Task::Sister(short(path), sister))
}

async fn perform(
    a: &SynthesisArguments,
    task: &Task,
    target: &Target,
) -> Result<Exit, ClientError> {
    let how = |name: &str| How {
        seed: a.seed,
        preset: a.preset,
        precision: a.precision,
        certify: a.certify,
        name: name.to_owned(),
    };
    match task {
        Task::One(name, points) => find(a, points, &how(name), target).await,
        Task::Many(name, sets) => find_many(a, sets, &how(name), target).await,
        Task::Sister(name, sister) => find_designs(a, sister, &how(name), target).await,
        Task::Spatial(name, poses) => find_spatial_dyads(a, poses, &how(name), target).await,
    }
}

/// Every set is answered on a line of its own as soon as it and those before it are settled; at
/// the end standard error says how many paths that were, and which classes were lost.
async fn find_many(
    a: &SynthesisArguments,
    sets: &[(String, PathPoints)],
    how: &How,
    target: &Target,
) -> Result<Exit, ClientError> {
    let began = Instant::now();
    let mut lost = 0;
    if a.format == SynthesisFormat::Csv {
        output::print(&format!("set,{}", linkages::csv::header()))?;
    }
    sweep::sweep(target, sets, how, |place, answer| {
        let (name, points) = &sets[place];
        let sheet = Sheet::new(name, points, answer, a.certify, began.elapsed());
        for warning in &sheet.warnings {
            eprintln!("warning: set {name}: {warning}");
        }
        lost += sheet.count(ClassEnd::Failed);
        output::print(&match a.format {
            SynthesisFormat::Table => linkages::table::line(&sheet),
            SynthesisFormat::Json => linkages::json::line(&sheet),
            SynthesisFormat::Csv => linkages::csv::rows(&sheet, Some(name)),
        })
    })
    .await?;
    let seconds = began.elapsed().as_secs_f64();
    let paths = (sets.len() * CLASSES) as u64;
    eprintln!(
        "{} in {}: {}, {} paths/s; {} lost",
        counted(sets.len() as u64, "set"),
        text::seconds(seconds),
        counted(paths, "path"),
        text::rate(paths as f64 / seconds.max(1e-9)),
        text::count(lost as u64)
    );
    Ok(match lost {
        0 => Exit::Solved,
        _ => Exit::Unsettled,
    })
}

async fn find(
    a: &SynthesisArguments,
    points: &PathPoints,
    how: &How,
    target: &Target,
) -> Result<Exit, ClientError> {
    let began = Instant::now();
    let quiet = a.format != SynthesisFormat::Table;
    let mut progress = Progress::new(quiet, began);
    let answer = nine_points(target, points, how, &mut progress).await;
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

/// A sister of the nine-point problem: a few paths, a few linkages.
async fn find_designs(
    a: &SynthesisArguments,
    sister: &Sister,
    how: &How,
    target: &Target,
) -> Result<Exit, ClientError> {
    let began = Instant::now();
    let mut progress = Progress::new(a.format != SynthesisFormat::Table, began);
    let design_set = designs(target, sister, how, &mut progress).await;
    progress.finish();
    let design_set = Designs {
        name: how.name.clone(),
        sister: sister.clone(),
        found: design_set?,
        elapsed: began.elapsed(),
    };
    if let Some(folder) = &a.output {
        designs::write(folder, &design_set)?;
    }
    output::print(&match a.format {
        SynthesisFormat::Table => designs::table(&design_set, Look::of_standard_output()),
        SynthesisFormat::Json => designs::json(&design_set),
        SynthesisFormat::Csv => designs::csv(&design_set),
    })?;
    Ok(design_set.exit())
}

/// Chains of two or three joints in space.
async fn find_spatial_dyads(
    a: &SynthesisArguments,
    poses: &SpatialPoses,
    how: &How,
    target: &Target,
) -> Result<Exit, ClientError> {
    let began = Instant::now();
    let mut progress = Progress::new(a.format != SynthesisFormat::Table, began);
    let answer = spatial_dyads(target, poses, how, &mut progress).await;
    progress.finish();
    let sheet = SpatialSheet {
        name: how.name.clone(),
        poses: poses.clone(),
        answer: answer?,
        elapsed: began.elapsed(),
    };
    if let Some(folder) = &a.output {
        spatial::write(folder, &sheet)?;
    }
    output::print(&match a.format {
        SynthesisFormat::Table => spatial::table(&sheet, Look::of_standard_output()),
        SynthesisFormat::Json => spatial::json(&sheet),
        SynthesisFormat::Csv => spatial::csv(&sheet),
    })?;
    Ok(sheet.exit())
}
