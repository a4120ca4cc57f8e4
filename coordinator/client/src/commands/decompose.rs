//! `cognate decompose`: every irreducible component of every dimension, on a coordinator of its own or on a
//! running one; of a system, of one whose components are known with further equations, or of a family at many values
//! of its parameters.

use super::question::{joined, read};
use crate::arguments::{Decompose, MethodName};
use crate::commands::{family, solve};
use crate::connection::Target;
use crate::error::{ClientError, Exit};
use crate::problem::{self, Prepared, read_equations};
use cognate_continuation::tracker::settings::Preset;
use cognate_protocol::submission::{self, Options, SettingsChoice, Source, Submission};
use cognate_solutions::closing_options::ClosingOptions;
use cognate_solutions::witness::KnownComponents;
use std::path::Path;

/// Decomposes, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &Decompose) -> Result<Exit, ClientError> {
    let running = a.service.running()?;
    let prepared = match (&a.resume, &a.add) {
        (Some(set), Some(added)) => resumed(a, set, added, running.as_ref()).await?,
        _ => problem::prepare(&a.problem())?,
    };
    let prepared = problem::for_components(prepared, &a.components)?;
    if prepared.submission.options.target_parameters.len() > 1 {
        return family::run(a, running, prepared).await;
    }
    let output = a.output();
    solve::anywhere(&a.service, running.as_ref(), &output, &a.progress, prepared).await
}

/// The components of a set with further equations.
async fn resumed(
    a: &Decompose,
    set: &Path,
    added: &Path,
    running: Option<&Target>,
) -> Result<Prepared, ClientError> {
    let method = a.components.method;
    if !matches!(method, MethodName::Auto | MethodName::Equations) {
        return Err(ClientError::Input {
            origin: "--method".into(),
            message: "does not go with --resume, which cuts equation by equation".into(),
        });
    }
    let resumed_set = read(set, &[], running).await?;
    resumed_set.check_whole(a.components.dimension.map_or(0, |d| d.lowest))?;
    let system = joined(&resumed_set, added, &read_equations(added)?)?;
    let equations = resumed_set.system.equations.len();
    let known_components = KnownComponents {
        equations: u32::try_from(equations).expect("equations are counted in 32 bits"),
        components: resumed_set.sets(),
        parameters: Vec::new(),
    };
    let options = Options {
        seed: Some(resumed_set.seed),
        settings: SettingsChoice {
            preset: Some(Preset::from(a.preset)),
            ..SettingsChoice::default()
        },
        closings: ClosingOptions {
            certify: a.certify,
            ..ClosingOptions::default()
        },
        name: resumed_set.name.chars().take(60).collect(),
        decompose: Some(submission::Decompose {
            known: Some(known_components),
            ..submission::Decompose::default()
        }),
        ..Options::default()
    };
    Ok(Prepared::new(
        Submission {
            source: Source::System(Box::new(system)),
            options,
        },
        resumed_set.name,
    ))
}
