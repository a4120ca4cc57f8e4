//! `cognate decompose`: every irreducible component of every dimension, on a coordinator of its own or on a
//! running one.

use crate::client::arguments::Decompose;
use crate::client::commands::solve;
use crate::client::connection::Target;
use crate::client::embedded::Embedded;
use crate::client::error::{ClientError, Exit};
use crate::client::problem;

/// Decomposes, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &Decompose) -> Result<Exit, ClientError> {
    let prepared = problem::for_components(problem::prepare(&a.problem())?, &a.components);
    let output = a.output();
    if let Some(coordinator) = &a.coordinator {
        let target = Target::read(coordinator, &a.credentials)?;
        return tokio::select! {
            ended = solve::follow(&output, &a.progress, prepared, &target) => ended,
            () = crate::client::interrupted() => Err(ClientError::Interrupted),
        };
    }
    let service = Embedded::start(a.workers, a.threads).await?;
    solve::embedded(&output, &a.progress, prepared, service).await
}
