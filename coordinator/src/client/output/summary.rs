//! The summary as a client reads it: the JSON object that the service gives, field by field.
//!
//! Fields that this client does not know are ignored, so that it can talk to a
//! newer service; a class that was not decided is `None`.

use crate::client::error::Exit;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Everything that is counted about a finished job.
#[derive(Clone, Debug, Deserialize)]
pub struct Summary {
    /// What was solved.
    pub problem: ProblemBlock,
    /// Every path, counted once.
    pub paths: PathsBlock,
    /// Isolated finite points after merging.
    pub solutions: SolutionsBlock,
    /// Orbits of a symmetry group, where one was given.
    #[serde(default)]
    pub classes: ClassesBlock,
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

/// Every path, counted once.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct PathsBlock {
    /// Paths of the first tracking stage.
    pub total: u64,
    /// At a nonsingular isolated solution.
    pub finite: Option<u64>,
    /// At a singular point.
    pub singular: Option<u64>,
    /// On a positive-dimensional solution set.
    pub positive_dimensional: Option<u64>,
    /// At a point that solves only the system after randomisation.
    pub excess: Option<u64>,
    /// At infinity.
    pub at_infinity: Option<u64>,
    /// Given up.
    pub failed: Option<u64>,
    /// Tracked again.
    #[serde(default)]
    pub retracked: u64,
    /// Two paths found at one regular endpoint.
    #[serde(default)]
    pub crossings_found: u64,
    /// Of these, set right by tracking again.
    #[serde(default)]
    pub crossings_resolved: u64,
    /// Verdicts that only the limit of precision gave.
    #[serde(default)]
    pub decided_by_precision_limit: u64,
    /// How many paths needed how many bits.
    #[serde(default)]
    pub by_precision: BTreeMap<String, u64>,
}

/// Isolated finite points after merging.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct SolutionsBlock {
    /// All of them.
    pub distinct: u64,
    /// With a regular Jacobian.
    pub nonsingular: u64,
    /// With a singular Jacobian.
    pub singular: u64,
    /// Fixed by complex conjugation; `None` where that was not asked.
    pub real: Option<u64>,
    /// Why it was not asked.
    pub real_reason: Option<String>,
    /// Counted with their multiplicities.
    pub with_multiplicity: u64,
    /// Proved, where that was asked.
    pub certified: Option<u64>,
    /// Whether there is a positive-dimensional solution set as well.
    pub positive_dimensional: Option<bool>,
    /// How many lie in each named set of endpoints that are no answers.
    #[serde(default)]
    pub degenerate: BTreeMap<String, u64>,
}

/// Orbits of a symmetry group.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct ClassesBlock {
    /// How many.
    pub count: Option<u64>,
    /// Elements of the group.
    pub group_order: Option<u64>,
    /// How many are complete, or whether all are.
    pub complete: Option<serde_json::Value>,
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
    pub fn open_questions(&self) -> Vec<String> {
        let paths = &self.paths;
        let mut open = vec![];
        let number = super::text::counted;
        if let Some(failed) = paths.failed.filter(|&n| n > 0) {
            open.push(format!("{} failed", number(failed, "path")));
        }
        if paths.failed.is_none() {
            open.push("how many paths failed".into());
        }
        if paths.at_infinity.is_none() {
            open.push("which paths end at infinity".into());
        }
        if paths.excess.is_none() && self.problem.equations > self.problem.variables {
            open.push("which endpoints solve the system before randomisation".into());
        }
        // Where every endpoint is regular, every endpoint is isolated: nothing is open then.
        if let (None, Some(singular)) = (paths.positive_dimensional, paths.singular)
            && singular > 0
        {
            let ends = number(singular, "singular path");
            open.push(format!("which of {ends} end on a positive-dimensional set"));
        }
        let unresolved = paths
            .crossings_found
            .saturating_sub(paths.crossings_resolved);
        if unresolved > 0 {
            open.push(format!(
                "{} not resolved",
                number(unresolved, "path crossing")
            ));
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
