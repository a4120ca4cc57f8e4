//! A folder of Bertini's: `witness_data` with the `input` that it belongs to.

use super::{Known, KnownSet, read_problem, read_text, wrong};
use crate::error::ClientError;
use cognate_algorithms::decomposition::DecompositionOptions;
use cognate_algorithms::questions::deflation_at;
use cognate_solutions::witness::bertini::read_witness_data;
use std::path::Path;

/// Seed of random choices in questions to components whose own seed is not known.
const SEED: u64 = 1;

/// The decomposition of a folder.
pub(super) fn read(folder: &Path) -> Result<KnownSet, ClientError> {
    let path = folder.join("witness_data");
    let origin = path.display().to_string();
    let text = read_text(&path)?;
    let system = read_problem(&folder.join("input"))?;
    if system.groups.iter().any(|group| group.homogeneous) {
        let message = "sets of homogeneous variables are read from decomposition.json only";
        return Err(wrong(&origin, message));
    }
    if !system.parameters.is_empty() {
        return Err(wrong(
            &origin,
            "its input has parameters; expected their values",
        ));
    }
    let read = read_witness_data(&text, system.variables.len())
        .map_err(|e| wrong(&format!("{origin}:{}", e.line), &e.message))?;
    let options = DecompositionOptions {
        seed: SEED,
        ..DecompositionOptions::default()
    };
    let mut components = Vec::with_capacity(read.len());
    for read in read {
        let (mut set, line) = (read.set, read.lines[0]);
        if read.deflations > 0 || set.multiplicity.scheme != Some(1) {
            let place = format!("{origin}:{line}");
            let ranks = deflation_at(&system, &options, &set.slice, &set.points[0])
                .map_err(|e| wrong(&place, &e.to_string()))?;
            set.deflation = ranks.ok_or_else(|| {
                wrong(
                    &place,
                    "no deflation makes the equations regular at this witness point",
                )
            })?;
        }
        components.push(Known {
            set,
            places: read
                .lines
                .iter()
                .map(|line| format!("{origin}:{line}"))
                .collect(),
        });
    }
    Ok(KnownSet {
        name: folder.display().to_string(),
        system,
        searched: None,
        seed: SEED,
        origin,
        components,
    })
}
