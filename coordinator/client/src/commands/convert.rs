//! `cognate convert`: a system in another notation.

use crate::arguments::Convert;
use crate::error::{ClientError, Exit};
use crate::notation::Notation;
use crate::output;
use crate::problem;
use crate::system_source::SystemSource;
use cognate_systems::formats::written::write_problem;

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
    let written = write_problem(to.format(), &read);
    let written = written.map_err(|e| ClientError::Input {
        origin: name.clone(),
        message: e.to_string(),
    })?;
    for warning in &written.warnings {
        eprintln!("warning: {name}: {warning}");
    }
    if read.settings.data_accuracy > 0.0 {
        eprintln!(
            "warning: {name}: its decimals count as rounded, to a relative {:.1e}; they are written as \
             exact fractions",
            read.settings.data_accuracy
        );
    }
    output::print(&written.text)?;
    Ok(Exit::Solved)
}
