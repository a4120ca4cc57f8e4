//! Files of a decomposition's components: Bertini's `input`, `witness_data`, `main_data` and `witness_set_DIM_COMP`, and the
//! points of each component.

use super::files::write_file;
use super::witness_files;
use crate::error::ClientError;
use cognate_solutions::witness::WitnessSet;
use cognate_solutions::witness::bertini::{write_main_data, write_witness_data};
use cognate_systems::formats::{self, FileSettings};
use cognate_systems::polynomial::degrees;
use cognate_systems::system::System;
use serde_json::Value;
use std::path::Path;

/// Writes Bertini's files where Bertini has words for the system: affine variables, and names that it does not reserve.
pub(super) fn write(folder: &Path, decomposition: &Value) -> Result<(), ClientError> {
    let strange = |what: &str| ClientError::GaveUp(format!("its components: {what}"));
    let text = decomposition["system"]
        .as_str()
        .ok_or_else(|| strange("no system"))?;
    let read = formats::read("system", text.as_bytes()).map_err(|e| strange(&e.to_string()))?;
    let system: System = read.system;
    let sets: Vec<WitnessSet> = serde_json::from_str(&decomposition["components"].to_string())
        .map_err(|e| strange(&e.to_string()))?;
    write_file(
        folder,
        "main_data",
        &write_main_data(&sets, &system.variables),
    )?;
    witness_files::points(folder, &sets)?;
    if system.groups.iter().any(|group| group.homogeneous) {
        return Ok(());
    }
    let Ok(input) = formats::bertini::write(&system, &FileSettings::default()) else {
        return Ok(());
    };
    let equation_degrees = degrees(&system).map_err(|e| strange(&e.to_string()))?;
    write_file(folder, "input", &input)?;
    witness_files::witness_sets(folder, &sets)?;
    let data = write_witness_data(&sets, system.variables.len(), &equation_degrees.total);
    write_file(folder, "witness_data", &data)
}
