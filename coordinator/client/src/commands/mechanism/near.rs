//! How a mechanism moves near configurations: its freedoms there, and whether it is singular.

use super::read::{Read, described, refuse_locks, wrong};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::{MechanismMobility, MechanismSingularities};
use crate::mechanism::mobility_answer::MobilityAnswer;
use crate::output::mechanisms::near as shown;
use crate::output::objects;
use crate::output::text::Look;
use crate::problem::read_file;
use cognate_kinematics::mechanism::configuration::{GivenConfiguration, configurations};
use cognate_mechanism_solver::local::mobility::mobility;
use cognate_mechanism_solver::local::number_effects::number_effects;
use cognate_mechanism_solver::local::singularity::singularity;
use std::path::Path;

/// `--at home`: the position of the mechanism's file.
const HOME: &str = "home";

/// `cognate mechanism mobility`.
pub fn mobility_of(a: &MechanismMobility) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    refuse_locks(&a.mechanism)?;
    let given = at(&read, &a.at, read.degrees(&a.mechanism))?;
    let answer = |given: &GivenConfiguration| {
        let mobility = mobility(&read.mechanism, given, a.seed)?;
        let effects = || number_effects(&read.mechanism, given, &mobility, a.seed);
        let why = a.why.then(effects).transpose()?;
        Ok(MobilityAnswer { mobility, why })
    };
    let answers = each(&a.at, &given, answer)?;
    for (index, answer) in answers.iter().enumerate() {
        for doubt in answer.doubts() {
            eprintln!("warning: configuration {index}: {doubt}");
        }
    }
    let degrees = read.degrees(&a.mechanism);
    objects::print(
        a.format,
        &["/points"],
        || shown::mobility_table(&read.mechanism, &answers, Look::of_standard_output()),
        || shown::mobility_json(&read.mechanism, &read.content, &answers, degrees),
    )?;
    Ok(Exit::of_settled(
        answers.iter().all(|answer| answer.is_settled()),
    ))
}

/// `cognate mechanism singularities --at`.
pub fn singularities_of(a: &MechanismSingularities) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    refuse_locks(&a.mechanism)?;
    let Some(path) = &a.at else {
        unreachable!("without configurations the command talks to a service: `start` runs it");
    };
    let given = at(&read, path, read.degrees(&a.mechanism))?;
    let kind = read.singular_kind(a);
    let answer = |given: &GivenConfiguration| singularity(&read.mechanism, given, &kind, a.seed);
    let answers = each(path, &given, answer)?;
    for (index, answer) in answers.iter().enumerate() {
        if let Some(doubt) = &answer.doubt {
            eprintln!("warning: configuration {index}: {doubt}");
        }
        if answer.is_everywhere {
            eprintln!(
                "warning: configuration {index}: in every position near it something moves while the inputs are held"
            );
        }
    }
    objects::print(
        a.format,
        &["/points"],
        || shown::singularities_table(&answers, Look::of_standard_output()),
        || shown::singularities_json(&read.mechanism, &read.content, &kind, &answers),
    )?;
    Ok(Exit::of_settled(
        answers.iter().all(|answer| answer.doubt.is_none()),
    ))
}

fn at(read: &Read, path: &Path, degrees: bool) -> Result<Vec<GivenConfiguration>, ClientError> {
    if path.as_os_str() == HOME {
        return Ok(vec![GivenConfiguration::Home]);
    }
    let (name, content) = read_file(path)?;
    configurations(&name, &content, &read.mechanism, degrees).map_err(|e| described(&e))
}

/// An answer for each configuration; an error names the one that has none.
fn each<T>(
    path: &Path,
    given: &[GivenConfiguration],
    answer: impl Fn(&GivenConfiguration) -> Result<T, String>,
) -> Result<Vec<T>, ClientError> {
    let one = |(index, given): (usize, &GivenConfiguration)| {
        answer(given).map_err(|message| {
            wrong(
                &path.display().to_string(),
                format!("configuration {index}: {message}"),
            )
        })
    };
    given.iter().enumerate().map(one).collect()
}
