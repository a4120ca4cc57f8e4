//! Branches of positions along a path of targets.

use super::read::{Read, cpu_seconds, described, options, some, wrong};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::{MechanismFollow, MechanismFormat};
use crate::output;
use crate::output::mechanisms::path::{self, ShownPath};
use crate::output::mechanisms::{View, folder};
use crate::output::text::Look;
use cognate_kinematics::compile::{Problem, Question, size};
use cognate_kinematics::mechanism::targets::MOST_TARGETS;
use cognate_kinematics::mechanism::task::Task;
use cognate_mechanism_solver::follow::samples::samples;
use cognate_mechanism_solver::follow::{Path, follow};
use cognate_mechanism_solver::postures::distance;
use cognate_mechanism_solver::prepared_mechanism::PreparedMechanism;
use std::time::Instant;

/// `cognate mechanism follow`.
pub fn run(a: &MechanismFollow) -> Result<Exit, ClientError> {
    let start = Instant::now();
    let read = Read::of(&a.mechanism)?;
    let degrees = read.degrees(&a.mechanism);
    let question = Question {
        problem: if a.inputs.is_some() {
            Problem::Forward
        } else {
            Problem::Inverse
        },
        inputs: some(&a.input),
        locks: read.locks(&a.mechanism)?,
        task: Task::Pose,
    };
    let prepared = PreparedMechanism::new(&read.mechanism, &question, &options(&a.solving));
    let prepared = prepared.map_err(|e| described(&e))?;
    let preparation = prepared.preparation();
    let kinds = read.mechanism.kinds(&preparation.inputs);
    let targets = match (&a.poses, &a.inputs) {
        (Some(file), _) => read.poses(file, read.form(Task::Pose, degrees))?,
        (None, Some(file)) => read.inputs(file, &kinds, degrees)?,
        (None, None) => return Err(wrong("--poses", "expected a file, or --inputs")),
    };
    let angles: Vec<bool> = kinds.iter().map(|(_, angle)| *angle).collect();
    let path_samples = samples(&targets, a.samples, size(&read.mechanism), &angles);
    if path_samples.len() > MOST_TARGETS {
        let message = format!(
            "{} samples keep neighbours near; at most {MOST_TARGETS} are solved",
            path_samples.len()
        );
        return Err(wrong("--samples", message));
    }
    let followed = follow(&prepared, path_samples).map_err(|e| described(&e))?;
    let chosen = match &a.seed_angles {
        Some(text) => {
            let values = read.joint_values("--seed-angles", text, degrees)?;
            Some(nearest(&followed, &values)?)
        }
        None => None,
    };
    let shown = ShownPath {
        view: View {
            mechanism: &read.mechanism,
            problem: question.problem,
            preparation,
            degrees,
            only_within_limits: a.within_limits,
            complex: false,
        },
        path: &followed,
        content: &read.content,
        chosen,
        wall_seconds: start.elapsed().as_secs_f64(),
        cpu_seconds: cpu_seconds(),
    };
    let settled = followed.settled && preparation.settled;
    for warning in preparation.warnings.iter().chain(&followed.warnings) {
        eprintln!("warning: {warning}");
    }
    if let Some(path) = &a.output {
        folder::write_path(&shown, path)?;
    }
    output::print(&match a.format {
        MechanismFormat::Table => path::table(&shown, Look::of_standard_output()),
        MechanismFormat::Json => path::json(&shown),
        MechanismFormat::Jsonl => path::lines(&shown),
        MechanismFormat::Csv => path::csv(&shown),
    })?;
    Ok(if settled {
        Exit::Solved
    } else {
        Exit::Unsettled
    })
}

/// The branch that begins nearest to these joint values.
fn nearest(path: &Path, values: &[f64]) -> Result<usize, ClientError> {
    let far = |b: &usize| {
        let first = path.branches[*b].positions[0];
        distance(&path.answers[0].positions[first], values)
    };
    let begins = (0..path.branches.len()).filter(|b| path.branches[*b].first == 0);
    begins
        .min_by(|a, b| far(a).total_cmp(&far(b)))
        .ok_or_else(|| {
            wrong(
                "--seed-angles",
                "the first sample has no real position from which a branch begins",
            )
        })
}
