//! `cognate intersect`: what components have in common with other components, or with the solutions of a file. The job
//! is of the equations of both together; its answer is a decomposition.

use super::question::{joined, prepared, read, send};
use crate::error::{ClientError, Exit};
use crate::problem::read_equations;
use crate::sets::arguments::Intersect;
use cognate_solutions::witness::Question;
use cognate_solutions::witness::question::SecondSet;
use std::path::Path;

/// Reads and checks both, asks, and shows the answer.
pub async fn run(a: &Intersect) -> Result<Exit, ClientError> {
    let running = a.set.service.running()?;
    let first = read(&a.set.set, &a.set.components, running.as_ref()).await?;
    let equation_count = count(first.system.equations.len());
    let is_set = is_set(&a.second) || (running.is_some() && !a.second.exists());
    let (system, second) = match is_set {
        true => {
            let other = read(&a.second, &a.others, running.as_ref()).await?;
            let same = other.system == first.system;
            let homogeneous = first.system.groups.iter().any(|group| group.homogeneous);
            if homogeneous && other.seed != first.seed {
                let message = format!(
                    "was found with seed {}; expected {}, that of the first: points of homogeneous groups are \
                     normalized by it",
                    other.seed, first.seed
                );
                return Err(wrong(&a.second, &message));
            }
            let system = match same {
                true => first.system.clone(),
                false => joined(&first, &a.second, &other.system)?,
            };
            let second = SecondSet {
                own: equation_count,
                from: if same { 0 } else { equation_count },
                components: other.sets(),
            };
            if second.components.is_empty() {
                return Err(wrong(&a.second, "has no components"));
            }
            (system, second)
        }
        false => {
            if let Some(id) = a.others.first() {
                let message = format!("holds equations; --other {id} names a component");
                return Err(wrong(&a.second, &message));
            }
            let given = read_equations(&a.second)?;
            let second = SecondSet {
                own: equation_count,
                from: equation_count,
                components: Vec::new(),
            };
            (joined(&first, &a.second, &given)?, second)
        }
    };
    let mut both = first;
    both.system = system;
    let prepared = prepared(a.set.preset, &both, Question::Intersect(second))?;
    send(&a.set, running.as_ref(), prepared).await
}

/// Whether a path names components, not equations.
fn is_set(path: &Path) -> bool {
    let names = ["decomposition.json", "witness_data"];
    path.is_dir()
        || names
            .iter()
            .any(|name| path.file_name().is_some_and(|n| n == *name))
}

fn count(equations: usize) -> u32 {
    u32::try_from(equations).expect("equations are counted in 32 bits")
}

fn wrong(path: &Path, message: &str) -> ClientError {
    ClientError::Input {
        origin: path.display().to_string(),
        message: message.into(),
    }
}
