//! The summary as a client reads it: the JSON object that the service gives, field by field.
//!
//! Fields that this client does not know are ignored, so that it can talk to a
//! newer service; a class that was not decided is `None`.

use super::text::counted;
use crate::client::error::Exit;
use cognate_solutions::summary::{ClassCounts, PathCounts, SolutionCounts};
use serde::Deserialize;

/// Everything that is counted about a finished job.
#[derive(Clone, Debug, Deserialize)]
pub struct Summary {
    /// What was solved.
    pub problem: ProblemBlock,
    /// Every path, counted once.
    pub paths: PathCounts,
    /// Isolated finite points after merging.
    pub solutions: SolutionCounts,
    /// Orbits of a symmetry group, where one was given.
    #[serde(default)]
    pub classes: ClassCounts,
    /// How long it took.
    pub time: TimeBlock,
    /// Who tracked.
    #[serde(default)]
    pub workers: Vec<WorkerBlock>,
    /// What a reader should know.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// What was solved.
#[derive(Clone, Debug, Deserialize)]
pub struct ProblemBlock {
    /// Name of the problem by its content.
    pub digest: String,
    /// Number of variables.
    pub variables: u64,
    /// Number of equations.
    pub equations: u64,
    /// The start system.
    pub start: String,
    /// Seed of everything random.
    pub seed: u64,
}

/// How long it took.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct TimeBlock {
    /// From submission to the end.
    pub wall_seconds: f64,
    /// On all processors together.
    pub cpu_seconds: Option<f64>,
    /// Of these, tracking paths.
    pub tracking_cpu_seconds: Option<f64>,
    /// Paths over wall time.
    pub paths_per_second: Option<f64>,
}

/// One worker's share.
#[derive(Clone, Debug, Deserialize)]
pub struct WorkerBlock {
    /// Its name.
    pub id: String,
    /// Paths accepted from it.
    pub paths: u64,
    /// How its results came.
    pub transport: String,
}

impl Summary {
    /// Reads the object that the service gives.
    pub fn read(json: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(json)
    }

    /// What keeps the answer from being settled, in words; nothing where all is.
    ///
    /// A class that this version does not decide is said in the table, and its
    /// paths are accounted for in the next class.
    pub fn open_questions(&self) -> Vec<String> {
        let paths = &self.paths;
        let mut open = vec![];
        if paths.failed > 0 {
            open.push(format!("{} failed", counted(paths.failed, "path")));
        }
        let unresolved = paths
            .crossings_found
            .saturating_sub(paths.crossings_resolved);
        if unresolved > 0 {
            let crossings = counted(unresolved, "path crossing");
            open.push(format!("{crossings} not resolved"));
        }
        open
    }

    /// The exit code that this answer has.
    pub fn exit(&self) -> Exit {
        if self.open_questions().is_empty() {
            Exit::Solved
        } else {
            Exit::Unsettled
        }
    }
}
