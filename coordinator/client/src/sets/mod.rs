//! Sets: components that were found before, read from a folder, from Bertini's files or from a job, and checked before
//! anything is asked of them.

pub mod arguments;
mod bertini_folder;
mod folder;
pub mod points;
#[cfg(test)]
mod tests;

use super::connection::Connection;
use super::error::ClientError;
use super::other_files;
use super::remedy::quoted;
use cognate_algorithms::decomposition::{DecompositionOptions, dimensions};
use cognate_algorithms::questions::{OperandError, QuestionError, QuestionSolve, run_locally};
use cognate_solutions::completeness::Completeness;
use cognate_solutions::witness::{Answer, ComponentId, Irreducible, Question, WitnessSet};
use cognate_systems::formats;
use cognate_systems::system::System;
use serde::Deserialize;
use std::path::Path;

/// Lanes of the check: points are few and moved by no path.
const WIDTH: usize = 8;

/// A component with where it stands in files.
#[derive(Clone, Debug)]
pub struct Known {
    /// The component.
    pub set: WitnessSet,
    /// The file and the line of each point; empty where there are no files.
    places: Vec<String>,
}

/// A decomposition that was made before.
#[derive(Clone, Debug)]
pub struct KnownSet {
    /// Name of the set, for the user.
    pub name: String,
    /// The system at the values of its parameters.
    pub system: System,
    /// Dimensions that were searched, if that is known.
    searched: Option<Searched>,
    /// Seed of the decomposition, which charts of homogeneous groups depend on.
    pub seed: u64,
    /// The file, or the job, with the components.
    origin: String,
    /// The components.
    pub components: Vec<Known>,
}

/// Contents of a decomposition in files and messages, apart from its points.
#[derive(Debug, Deserialize)]
struct Described {
    variables: Vec<String>,
    components: Vec<WitnessSet>,
    dimensions: Vec<DescribedDimension>,
    seed: u64,
    asked: [u32; 2],
    /// Absent where an older program wrote it.
    #[serde(default)]
    locus: Option<bool>,
    /// Where the system is not in a file of its own.
    #[serde(default)]
    system: Option<String>,
}

/// Dimensions of which a set holds all components.
#[derive(Clone, Debug)]
struct Searched {
    /// Lowest and highest dimension that was asked.
    asked: [u32; 2],
    /// Whether it is known to be a decomposition, and no locus.
    whole: bool,
    /// Dimensions in which components may be missing.
    incomplete: Vec<u32>,
}

impl Searched {
    fn of(described: &Described) -> Self {
        let dimensions = described.dimensions.iter();
        let incomplete = dimensions.filter(|d| d.complete != Completeness::Yes);
        Self {
            asked: described.asked,
            whole: described.locus == Some(false),
            incomplete: incomplete.map(|d| d.number).collect(),
        }
    }
}

/// A dimension of a decomposition: its number, the degree, and whether all its components are there.
#[derive(Debug, Deserialize)]
struct DescribedDimension {
    number: u32,
    degree: u64,
    complete: Completeness,
}

impl KnownSet {
    /// The components of a finished job.
    pub async fn of_job(connection: &mut Connection, job: &str) -> Result<Self, ClientError> {
        let value = connection.decomposition(job).await?;
        let origin = format!("job {job}");
        let strange = |e: serde_json::Error| wrong(&origin, &e.to_string());
        let described: Described = serde_json::from_str(&value.to_string()).map_err(strange)?;
        let text = described.system.as_deref().unwrap_or_default();
        let system = formats::read(&origin, text.as_bytes())
            .map_err(|e| ClientError::Format(e.to_string()))?
            .system;
        let job_set = Self {
            name: job.to_owned(),
            system,
            searched: Some(Searched::of(&described)),
            seed: described.seed,
            origin: origin.clone(),
            components: described
                .components
                .iter()
                .map(|set| Known {
                    set: set.clone(),
                    places: Vec::new(),
                })
                .collect(),
        };
        job_set.check_counts(&described)?;
        Ok(job_set)
    }

    /// The components of a folder, of its `decomposition.json` or of its `witness_data`.
    pub fn read(path: &Path) -> Result<Self, ClientError> {
        let is = |name: &str| path.file_name().is_some_and(|n| n == name);
        refuse_no_set(path)?;
        let folder = match path.is_dir() {
            true => path,
            false => path.parent().unwrap_or(Path::new(".")),
        };
        let ours = folder.join("decomposition.json");
        if is("witness_data") || (path.is_dir() && !ours.exists()) {
            return bertini_folder::read(folder);
        }
        folder::read(folder)
    }

    /// Keeps only these components; all if none is named.
    pub fn choose(&mut self, wanted: &[ComponentId]) -> Result<(), ClientError> {
        if wanted.is_empty() {
            return Ok(());
        }
        for id in wanted {
            if !self
                .components
                .iter()
                .any(|component| component.set.id == *id)
            {
                let ids: Vec<String> = self
                    .components
                    .iter()
                    .map(|k| k.set.id.to_string())
                    .collect();
                let message = format!(
                    "no component {id} is in {}; there are {}",
                    self.origin,
                    ids.join(", ")
                );
                return Err(wrong("--component", &message));
            }
        }
        self.components
            .retain(|component| wanted.contains(&component.set.id));
        Ok(())
    }

    /// Leaves out the components of other dimensions; gives their names.
    pub fn leave_other_dimensions(&mut self, dimension: u32) -> Vec<ComponentId> {
        let is_other = |component: &Known| component.set.dimension() != dimension;
        let others = self
            .components
            .iter()
            .filter(|component| is_other(component));
        let others = others.map(|component| component.set.id).collect();
        self.components.retain(|component| !is_other(component));
        others
    }

    /// The components.
    pub fn sets(&self) -> Vec<WitnessSet> {
        self.components
            .iter()
            .map(|component| component.set.clone())
            .collect()
    }

    /// Whether these are all components that other equations may cut down to the lowest dimension that is wanted.
    pub fn check_whole(&self, lowest: u32) -> Result<(), ClientError> {
        let refused = |message: &str| Err(wrong(&self.origin, message));
        let Some(searched) = &self.searched else {
            return refused(
                "does not say which dimensions were searched; expected decomposition.json",
            );
        };
        if !searched.whole {
            return refused(
                "holds components of a locus, or is of an older program; expected all components of a system",
            );
        }
        let possible = dimensions(&self.system, &self.options());
        let [least, most] = possible.map_err(|error| wrong(&self.origin, &error.to_string()))?;
        let [from, to] = searched.asked;
        if from > least.max(lowest) || to < most {
            let message = format!(
                "its dimensions {from} to {to} were searched; expected {} to {most}",
                least.max(lowest)
            );
            return refused(&message);
        }
        if let Some(number) = searched.incomplete.iter().find(|&&n| n >= lowest) {
            let message =
                format!("dimension {number} may not be complete, so that nothing is made of it");
            return refused(&message);
        }
        Ok(())
    }

    /// How this set is asked: by its own seed.
    pub fn options(&self) -> DecompositionOptions {
        DecompositionOptions {
            seed: self.seed,
            ..DecompositionOptions::default()
        }
    }

    /// Degrees that do not add up, or a component without its points.
    fn check_counts(&self, described: &Described) -> Result<(), ClientError> {
        if described.variables != self.system.variables {
            let message = format!(
                "its variables are {}, those of the system {}",
                described.variables.join(", "),
                self.system.variables.join(", ")
            );
            return Err(wrong(&self.origin, &message));
        }
        for dimension in &described.dimensions {
            let sets_of_dimension = self.components.iter().map(|component| &component.set);
            let sets_of_dimension =
                sets_of_dimension.filter(|set| set.dimension() == dimension.number);
            let degree: u64 = sets_of_dimension.map(|set| set.degree).sum();
            if degree != dimension.degree {
                let message = format!(
                    "dimension {} has degree {}, its components have degree {degree} in all",
                    dimension.number, dimension.degree
                );
                return Err(wrong(&self.origin, &message));
            }
        }
        Ok(())
    }

    /// Whether every component is whole: its points solve the equations on the slice, their second derivatives sum to
    /// 0, and its multiplicity is that of the equations. A fault is named with its place.
    pub fn check(&self) -> Result<(), ClientError> {
        let unsettled = |component: &&Known| component.set.irreducible != Irreducible::Yes;
        if let Some(component) = self.components.iter().find(unsettled) {
            let message = format!(
                "component {} is unsettled, so nothing can be asked of it; --component names others",
                component.set.id
            );
            return Err(wrong(&self.origin, &message));
        }
        let sets = self.sets();
        let solve = QuestionSolve::new(&self.system, &self.options(), &sets, &Question::Check)
            .map_err(|error| self.placed(&error))?;
        let (answer, _) =
            run_locally(solve, WIDTH).map_err(|error| wrong(&self.origin, &error.to_string()))?;
        let doubts = answer.doubts();
        if let Some(doubt) = doubts.first() {
            return Err(wrong(&self.origin, doubt));
        }
        let Answer::Check(checked) = &answer else {
            return Ok(());
        };
        for (checked, set) in checked.iter().zip(&sets) {
            if let (Some(dual_dimension), Some(said)) =
                (checked.multiplicity, set.multiplicity.scheme)
                && dual_dimension != said
            {
                let message = format!(
                    "component {}: multiplicity {said}, but the dual space at a witness point has dimension {dual_dimension}",
                    set.id
                );
                return Err(wrong(&self.origin, &message));
            }
        }
        Ok(())
    }

    /// An error with the file and the line of the point at fault, or with the origin of the set.
    fn placed(&self, error: &QuestionError) -> ClientError {
        let QuestionError::Operand(operand) = error else {
            return wrong(&self.origin, &error.to_string());
        };
        let place = OperandError::place(operand).and_then(|(id, point)| {
            let component = self
                .components
                .iter()
                .find(|component| component.set.id == id)?;
            component.places.get(point?).cloned()
        });
        let origin = place.unwrap_or_else(|| self.origin.clone());
        wrong(&origin, &operand.to_string())
    }
}

/// Refuses a path that is no folder of components, by its kind.
fn refuse_no_set(path: &Path) -> Result<(), ClientError> {
    let name = path.display().to_string();
    let refused = |what: &str| {
        let line = format!("try: cognate decompose FILE --output {}", quoted(&name));
        Err(wrong(&name, &format!("{what}\n  {line}")))
    };
    if !path.exists() {
        return refused(
            "there is no such folder; expected components, the folder of `decompose --output`",
        );
    }
    if path.is_dir() {
        let holds = |file: &str| path.join(file).exists();
        return match holds("decomposition.json") || holds("witness_data") {
            true => Ok(()),
            false => {
                refused("the folder holds no decomposition.json, and no witness_data of Bertini's")
            }
        };
    }
    let is_of_set = SET_FILES.iter().any(|file| path.ends_with(file));
    if is_of_set {
        return Ok(());
    }
    let other = std::fs::read(path).ok();
    let other = other.and_then(|content| other_files::instead_of_components(&name, &content));
    match other {
        Some(refusal) => Err(refusal),
        None => refused("is no folder of components"),
    }
}

/// Files that stand for the folder of components in which they are.
const SET_FILES: [&str; 4] = [
    "decomposition.json",
    "witness_data",
    "system.json",
    "witness_points.jsonl",
];

fn wrong(origin: &str, message: &str) -> ClientError {
    ClientError::Input {
        origin: origin.into(),
        message: message.into(),
    }
}

fn read_text(path: &Path) -> Result<String, ClientError> {
    let content = std::fs::read(path).map_err(|source| ClientError::File {
        action: "cannot read",
        path: path.to_path_buf(),
        source,
    })?;
    String::from_utf8(content).map_err(|e| {
        let byte = e.utf8_error().valid_up_to() + 1;
        wrong(
            &path.display().to_string(),
            &format!("is no text: byte {byte} is not UTF-8"),
        )
    })
}

fn read_problem(path: &Path) -> Result<System, ClientError> {
    let text = read_text(path)?;
    let read = formats::read(&path.display().to_string(), text.as_bytes());
    Ok(read.map_err(|e| ClientError::Format(e.to_string()))?.system)
}
