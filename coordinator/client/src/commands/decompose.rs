//! `cognate decompose`: every irreducible component of every dimension, on a coordinator of its own or on a
//! running one.

use crate::arguments::Decompose;
use crate::commands::solve;
use crate::error::{ClientError, Exit};
use crate::problem;

/// Decomposes, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &Decompose) -> Result<Exit, ClientError> {
    let prepared = problem::for_components(problem::prepare(&a.problem())?, &a.components);
    let output = a.output();
    let running = a.service.running()?;
    solve::anywhere(&a.service, running.as_ref(), &output, &a.progress, prepared).await
}
