//! Synthesis: from points to linkages, by jobs of the service.
//!
//! The paths to follow are chosen in `cognate_kinematics` (`nine_point::search`); here each round becomes a job.

pub mod arguments;
pub mod designs;
pub mod point_files;
pub mod position_files;
pub mod spatial_dyads;
pub mod sweep;

use super::arguments::PresetName;
use super::commands::{submit, watch};
use super::connection::{Connection, Target};
use super::error::ClientError;
use super::output::progress::Progress;
use super::output::summary;
use super::problem::Prepared;
use cognate_continuation::start_points::StoredPoints;
use cognate_continuation::tracker::settings::Preset;
use cognate_kinematics::nine_point::class_record::{Arrived, PathEnd};
use cognate_kinematics::nine_point::{ClassRecord, PathPoints, Point, Search, family};
use cognate_protocol::submission::{
    Options, PrecisionChoice, SettingsChoice, Source, StartKind, StartSolutions, Submission,
};
use cognate_protocol::v1;
use cognate_solutions::closing_options::ClosingOptions;
use cognate_solutions::solution::Solution;
use cognate_summary::solve::Summary;
use cognate_systems::named::nine_point;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// How the paths are followed.
#[derive(Clone, Debug)]
pub struct How {
    /// Seed of everything random.
    pub seed: Option<u64>,
    /// Preset of the tracker's settings.
    pub preset: PresetName,
    /// Arithmetic of the paths.
    pub precision: PrecisionChoice,
    /// Whether the solutions are proved.
    pub certify: bool,
    /// Name of the points, for the user.
    pub name: String,
}

/// One job of a synthesis.
#[derive(Clone, Debug)]
pub struct Round {
    /// Purpose of the solve, in words.
    pub purpose: &'static str,
    /// Counts and warnings of the solve.
    pub summary: Summary,
}

/// State of all classes, with the jobs that were solved.
pub struct Answer {
    /// Class after class.
    pub record: ClassRecord,
    /// The jobs.
    pub rounds: Vec<Round>,
    /// Classes that were settled by implied solutions, not by what their own paths found.
    pub derived: usize,
}

/// Seed of a synthesis where none is asked for: the same points give the same bits.
const SEED: u64 = 0;

/// Follows all classes to these points.
pub async fn nine_points(
    target: &Target,
    points: &PathPoints,
    how: &How,
    progress: &mut Progress,
) -> Result<Answer, ClientError> {
    let search = Search::new(points);
    carry_out(target, points, how, progress, search).await
}

/// Carries out the rounds that a search has before it, each as one job.
async fn carry_out(
    target: &Target,
    points: &PathPoints,
    how: &How,
    progress: &mut Progress,
    mut search: Search,
) -> Result<Answer, ClientError> {
    let mut rounds = Vec::new();
    while let Some(round) = search.next_round() {
        let seed = how.seed.unwrap_or(SEED).wrapping_add(round.way);
        let preset = match round.careful {
            true => Preset::Careful,
            false => preset(how.preset),
        };
        let targets = [points.parameters()];
        let job = submission(&round.starts, &targets, points.is_real(), how, seed, preset);
        let (summary, ends) = run(target, job, progress).await?;
        rounds.push(Round {
            purpose: round.purpose,
            summary,
        });
        search.absorb(ends);
    }
    let (record, derived) = search.finish();
    Ok(Answer {
        record,
        rounds,
        derived,
    })
}

/// The system that is followed: without the group, of which only one member is wanted, and
/// without degenerate sets, which the record looks at itself.
fn followed_system(real: bool) -> System {
    let mut system = nine_point().system;
    system.symmetry.clear();
    system.degenerate.clear();
    if !real {
        system.conjugates.clear();
    }
    system
}

fn preset(name: PresetName) -> Preset {
    match name {
        PresetName::Careful => Preset::Careful,
        PresetName::Default => Preset::Default,
        PresetName::Fast => Preset::Fast,
        PresetName::Reckless => Preset::Reckless,
    }
}

/// From these starts to all of these targets.
fn submission(
    starts: &[Point],
    targets: &[Vec<Complex64>],
    real: bool,
    how: &How,
    seed: u64,
    preset: Preset,
) -> Prepared {
    let options = Options {
        start: StartKind::Given,
        seed: Some(seed),
        settings: SettingsChoice {
            preset: Some(preset),
            ..SettingsChoice::default()
        },
        precision: how.precision,
        start_parameters: family::parameters(),
        target_parameters: targets.to_vec(),
        start_solutions: Some(StartSolutions::Points(StoredPoints {
            dimension: 8,
            coordinates: starts.iter().flatten().copied().collect(),
        })),
        name: how.name.clone(),
        closings: ClosingOptions {
            certify: how.certify,
            ..ClosingOptions::default()
        },
        ..Options::default()
    };
    Prepared::new(
        Submission {
            source: Source::System(Box::new(followed_system(real))),
            options,
        },
        how.name.clone(),
    )
}

/// Runs a job to its end: a connection that is open then, the job's id, its summary.
async fn finished(
    target: &Target,
    prepared: Prepared,
    progress: &mut Progress,
) -> Result<(Connection, String, Summary), ClientError> {
    let mut connection = Connection::open(target).await?;
    let request = uuid::Uuid::new_v4().to_string();
    let (job, warnings) = submit::send(&mut connection, &request, prepared).await?;
    for warning in &warnings {
        progress.say(&format!("warning: {warning}"));
    }
    let (mut connection, last) = watch::follow(target, &job, progress).await?;
    match last.state() {
        v1::JobState::Failed => return Err(ClientError::GaveUp(last.message)),
        v1::JobState::Cancelled => return Err(ClientError::Cancelled),
        _ => {}
    }
    let summary = summary::read(&connection.summary(&job).await?)?;
    Ok((connection, job, summary))
}

/// A real solution.
struct Root<const N: usize> {
    values: [Complex64; N],
    /// Proved to be there, alone, and to be real.
    certified: bool,
}

/// A system, with its parameters at the member that is solved, if it has some.
struct Family {
    system: System,
    parameters: Vec<Vec<Complex64>>,
    start: StartKind,
}

/// Solves a member of a family: the summary, and the real solutions.
async fn real_roots<const N: usize>(
    target: &Target,
    family: Family,
    how: &How,
    progress: &mut Progress,
) -> Result<(Summary, Vec<Root<N>>), ClientError> {
    let options = Options {
        start: family.start,
        seed: how.seed,
        settings: SettingsChoice {
            preset: Some(preset(how.preset)),
            ..SettingsChoice::default()
        },
        precision: how.precision,
        target_parameters: family.parameters,
        name: how.name.clone(),
        closings: ClosingOptions {
            certify: how.certify,
            ..ClosingOptions::default()
        },
        ..Options::default()
    };
    let prepared = Prepared::new(
        Submission {
            source: Source::System(Box::new(family.system)),
            options,
        },
        how.name.clone(),
    );
    let (mut connection, job, summary) = finished(target, prepared, progress).await?;
    let mut roots = vec![];
    connection
        .solutions(&job, |solution, _| {
            let values = solution.variables.values();
            let values = values.collect::<Vec<_>>().try_into().map_err(|_| {
                ClientError::GaveUp("a solution of it has another number of variables".into())
            })?;
            if solution.real == Some(true) {
                let proof = solution.certificate.as_ref();
                let certified = proof.is_some_and(|c| {
                    c.certified && c.distinct == Some(true) && c.real == Some(true)
                });
                roots.push(Root { values, certified });
            }
            Ok(true)
        })
        .await?;
    Ok((summary, roots))
}

/// Runs a job to its end: its summary, and how each path ended, by its number.
async fn run(
    target: &Target,
    prepared: Prepared,
    progress: &mut Progress,
) -> Result<(Summary, BTreeMap<usize, PathEnd>), ClientError> {
    let (mut connection, job, summary) = finished(target, prepared, progress).await?;
    let ends = ends(&mut connection, &job, &summary).await?;
    Ok((summary, ends))
}

/// Why a path to a singular point that may lie on a set of solutions counts as lost.
const UNDECIDED: &str = "whether the singular point where it ends is isolated is not known";

/// How each path of a finished job ended.
async fn ends(
    connection: &mut Connection,
    job: &str,
    summary: &Summary,
) -> Result<BTreeMap<usize, PathEnd>, ClientError> {
    let mut ends = BTreeMap::new();
    connection
        .solutions(job, |solution, _| {
            let arrived = arrived(&solution)?;
            for &path in &solution.paths {
                let arrival = match (solution.undecided, solution.singular) {
                    (true, _) => PathEnd::Failed(UNDECIDED.into()),
                    (false, true) => PathEnd::Singular(arrived.clone()),
                    (false, false) => PathEnd::Regular(arrived.clone()),
                };
                ends.insert(usize::try_from(path).unwrap_or(usize::MAX), arrival);
            }
            Ok(true)
        })
        .await?;
    // Paths that ended at no solution are asked for only where there are some.
    if (ends.len() as u64) < summary.paths.total {
        connection
            .paths(job, |path| {
                let result = path.result.clone().unwrap_or_default();
                let at = usize::try_from(result.origin).unwrap_or(usize::MAX);
                ends.entry(at)
                    .or_insert_with(|| without_solution(&path, &result));
                Ok(())
            })
            .await?;
    }
    Ok(ends)
}

fn arrived(solution: &Solution) -> Result<Arrived, ClientError> {
    let values = solution.variables.values();
    let point: Result<Point, _> = values.collect::<Vec<_>>().try_into();
    let proof = solution.certificate.as_ref();
    let certified = proof.is_some_and(|c| c.certified && c.distinct == Some(true));
    Ok(Arrived {
        point: point.map_err(|_| {
            ClientError::GaveUp("a solution of it has another number of variables".into())
        })?,
        accuracy: solution.accuracy,
        real: solution.real,
        certified,
        certified_real: certified && proof.is_some_and(|c| c.real == Some(true)),
    })
}

fn without_solution(path: &v1::ClassifiedPath, result: &v1::EndedPath) -> PathEnd {
    match path.class() {
        v1::PathClass::AtInfinity => PathEnd::AtInfinity,
        v1::PathClass::PositiveDimensional => PathEnd::PositiveDimensional,
        _ => {
            let outcome = result.outcome().as_str_name();
            let words = outcome.trim_start_matches("PATH_OUTCOME_");
            PathEnd::Failed(match result.outcome() {
                v1::PathOutcome::Regular | v1::PathOutcome::Singular => {
                    "it ends where another path does, or at no solution".into()
                }
                _ => words.to_lowercase().replace('_', " "),
            })
        }
    }
}
