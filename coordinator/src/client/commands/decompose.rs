//! `cognate decompose`: every irreducible component of every dimension, on a coordinator of its own or on a
//! running one.

use crate::client::arguments::{ComponentArguments, Decompose};
use crate::client::commands::solve;
use crate::client::connection::Target;
use crate::client::embedded::Embedded;
use crate::client::error::{ClientError, Exit};
use crate::client::problem::{self, Prepared};
use cognate_protocol::submission;

/// Decomposes, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &Decompose) -> Result<Exit, ClientError> {
    let prepared = prepared(problem::prepare(&a.problem())?, &a.components);
    let output = a.output();
    if let Some(coordinator) = &a.coordinator {
        let target = Target::read(coordinator, &a.credentials)?;
        return tokio::select! {
            ended = solve::follow(&output, prepared, &target) => ended,
            () = crate::client::interrupted() => Err(ClientError::Interrupted),
        };
    }
    let service = Embedded::start(a.workers, a.threads).await?;
    solve::embedded(&output, prepared, service).await
}

/// The submission that asks for these components instead of isolated solutions.
pub fn prepared(mut prepared: Prepared, wanted: &ComponentArguments) -> Prepared {
    let options = &mut prepared.submission.options;
    // A file's digits are those of isolated solutions.
    if options.digits.take().is_some() {
        options
            .warnings
            .push("the file asks for digits; witness points have those of doubles".into());
    }
    options.decompose = Some(submission::Decompose {
        dimensions: wanted.dimension.map(|d| [d.lowest, d.highest]),
        idle_loops: wanted.loops,
    });
    prepared
}
