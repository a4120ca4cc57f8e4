//! `cognate convert`: a system in another notation.

use crate::arguments::Convert;
use crate::error::{ClientError, Exit};
use crate::notation::Notation;
use crate::output;
use crate::problem;
use crate::system_source::SystemSource;
use cognate_systems::formats::{self, Problem};
use cognate_systems::system::System;

/// The JSON Schema of our JSON, for editors and other programs.
const SCHEMA: &str = include_str!("problem.schema.json");

/// Reads, checks and writes; solves nothing.
pub fn run(a: &Convert) -> Result<Exit, ClientError> {
    let system = SystemSource {
        file: a.file.clone(),
        equation: a.equation.clone(),
        content: None,
    };
    match a.to {
        Some(to) if !a.schema => convert(&system, to),
        _ => {
            output::print(SCHEMA)?;
            Ok(Exit::Solved)
        }
    }
}

fn convert(system: &SystemSource, to: Notation) -> Result<Exit, ClientError> {
    let read = problem::read_source(system, None)?;
    for warning in &read.warnings {
        eprintln!("warning: {warning}");
    }
    let name = problem::source_name(system);
    let Problem {
        system, settings, ..
    } = &read;
    let written = formats::write(to.format(), system, settings);
    let text = written.map_err(|e| ClientError::Input {
        origin: name.clone(),
        message: e.to_string(),
    })?;
    for what in left_out(system, to) {
        eprintln!("warning: {name}: {what} left out, for which this notation has no words");
    }
    if !read.conditions.is_empty() {
        let condition = read.conditions.text();
        eprintln!("warning: {name}: the condition {condition} is left out");
    }
    if settings.data_accuracy > 0.0 {
        eprintln!(
            "warning: {name}: its decimals count as rounded, to a relative {:.1e}; they are written as \
             exact fractions",
            settings.data_accuracy
        );
    }
    output::print(&text)?;
    Ok(Exit::Solved)
}

/// Parts of a system that the notation cannot express, as subject and verb of a message.
fn left_out(system: &System, notation: Notation) -> Vec<&'static str> {
    let grouped = system.groups.len() > 1 || system.groups.iter().any(|g| g.homogeneous);
    let only_json = notation != Notation::Json;
    let parts = [
        (
            grouped && !matches!(notation, Notation::Bertini | Notation::Json),
            "variable groups are",
        ),
        (
            only_json && !system.conjugates.is_empty(),
            "pairs of conjugates are",
        ),
        (
            only_json && !system.degenerate.is_empty(),
            "degenerate sets are",
        ),
        (only_json && !system.symmetry.is_empty(), "symmetries are"),
    ];
    let lost = parts.into_iter().filter(|(lost, _)| *lost);
    lost.map(|(_, what)| what).collect()
}
