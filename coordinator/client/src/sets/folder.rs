//! The folder that `decompose --output` wrote: decomposition.json, system.json, witness_points.jsonl.

use super::{Described, Known, KnownSet, Searched, read_problem, read_text, wrong};
use crate::error::ClientError;
use crate::output::text::counted;
use cognate_solutions::witness::ComponentId;
use num_complex::Complex64;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A line of witness_points.jsonl.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PointLine {
    component: String,
    variables: BTreeMap<String, [f64; 2]>,
}

/// The decomposition of a folder.
pub(super) fn read(folder: &Path) -> Result<KnownSet, ClientError> {
    let path = folder.join("decomposition.json");
    let origin = path.display().to_string();
    let text = read_text(&path)?;
    let described: Described = serde_json::from_str(&text).map_err(|e| {
        let place = format!("{origin}:{}:{}", e.line(), e.column());
        wrong(&place, &format!("is no decomposition: {e}"))
    })?;
    let system = read_problem(&folder.join("system.json"))?;
    let mut components: Vec<Known> = Vec::with_capacity(described.components.len());
    for set in &described.components {
        if !set.points.is_empty() {
            let message = format!(
                "component {}: its points are in witness_points.jsonl",
                set.id
            );
            return Err(wrong(&origin, &message));
        }
        components.push(Known {
            set: set.clone(),
            places: Vec::new(),
        });
    }
    read_points(folder, &described.variables, &mut components)?;
    for component in &components {
        let (set, points) = (&component.set, component.set.points.len() as u64);
        if set.degree != points {
            let file = folder.join("witness_points.jsonl");
            let message = format!(
                "component {} has {}; {origin} says that it has degree {}",
                set.id,
                counted(points, "witness point"),
                set.degree
            );
            return Err(wrong(&file.display().to_string(), &message));
        }
    }
    let folder_set = KnownSet {
        name: folder.display().to_string(),
        system,
        searched: Some(Searched::of(&described)),
        seed: described.seed,
        origin,
        components,
    };
    folder_set.check_counts(&described)?;
    Ok(folder_set)
}

fn read_points(
    folder: &Path,
    variables: &[String],
    components: &mut [Known],
) -> Result<(), ClientError> {
    let path = folder.join("witness_points.jsonl");
    let text = read_text(&path)?;
    let places: BTreeMap<ComponentId, usize> = components
        .iter()
        .enumerate()
        .map(|(place, component)| (component.set.id, place))
        .collect();
    for (number, line) in text.lines().enumerate() {
        let origin = format!("{}:{}", path.display(), number + 1);
        let line: PointLine = serde_json::from_str(line)
            .map_err(|e| wrong(&format!("{origin}:{}", e.column()), &e.to_string()))?;
        let id: ComponentId = line
            .component
            .parse()
            .map_err(|e: String| wrong(&origin, &e))?;
        let Some(&place) = places.get(&id) else {
            let message = format!("component {id} is not in decomposition.json");
            return Err(wrong(&origin, &message));
        };
        if line.variables.len() != variables.len() {
            let message = format!(
                "{}; expected {}",
                counted(line.variables.len() as u64, "variable"),
                variables.len()
            );
            return Err(wrong(&origin, &message));
        }
        let value = |name: &String| -> Result<Complex64, ClientError> {
            let pair = line.variables.get(name);
            let [re, im] = pair.ok_or_else(|| wrong(&origin, &format!("no variable {name}")))?;
            Ok(Complex64::new(*re, *im))
        };
        let point = variables.iter().map(value).collect::<Result<Vec<_>, _>>()?;
        components[place].set.points.push(point);
        components[place].places.push(origin);
    }
    Ok(())
}
