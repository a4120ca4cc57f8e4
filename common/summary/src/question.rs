//! QuestionSummary: the answer of components in one JSON object, field by field as the contract has it.

use super::about::{About, TimeBlock, WorkerBlock};
use super::question_answer::QuestionAnswer;
use cognate_algorithms::answer::AnsweredQuestion;
use cognate_numeric::counted::counted;
use cognate_solutions::witness::TrackedPaths;
use serde::{Deserialize, Serialize};

/// A question that is answered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuestionSummary {
    /// Id of the job.
    pub job: String,
    /// Kind of the question: `member`, `sample`, `project`, `multidegree`, `mobility`, `real-curve`, `real-surface`,
    /// `real-points` or `certify`.
    pub question: String,
    /// The system and the seed.
    pub problem: AskedProblem,
    /// Blocks of the answer.
    #[serde(flatten, skip_deserializing)]
    pub answer: QuestionAnswer,
    /// Doubts in words; empty if all is settled.
    pub unsettled: Vec<String>,
    /// True when nothing is in doubt.
    pub settled: bool,
    /// Paths that were tracked.
    pub paths: TrackedPaths,
    /// Wall time and CPU time.
    pub time: TimeBlock,
    /// Workers and the number of items that each did.
    pub workers: Vec<WorkerBlock>,
    /// Warnings for the user, one sentence each.
    pub warnings: Vec<String>,
}

/// Problem that the question is about.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AskedProblem {
    /// Name of the problem, usually that of its file.
    pub name: String,
    /// Digest of the system.
    pub digest: String,
    /// Number of variables.
    pub variables: u64,
    /// Names of the unknowns, in the order of the coordinates of points; empty where an older program wrote the summary.
    #[serde(default)]
    pub unknowns: Vec<String>,
    /// Number of equations.
    pub equations: u64,
    /// Seed of everything random.
    pub seed: u64,
}

impl QuestionSummary {
    /// The summary of a job that has answered this question.
    pub fn new(about: &About, asked: &AnsweredQuestion) -> Self {
        let answer = &asked.answer;
        let unsettled = asked.doubts.clone();
        Self {
            job: about.job.clone(),
            question: answer.name().into(),
            problem: AskedProblem {
                name: about.name.clone(),
                digest: about.digest.clone(),
                variables: about.variables,
                unknowns: asked.unknowns.clone(),
                equations: about.equations,
                seed: about.seed,
            },
            answer: QuestionAnswer::new(answer),
            settled: unsettled.is_empty(),
            unsettled,
            paths: asked.paths,
            time: about.time.clone(),
            workers: about.workers.clone(),
            warnings: about.warnings.clone(),
        }
    }

    /// Reads a summary.
    pub(crate) fn read(json: &str) -> Result<Self, serde_json::Error> {
        let mut summary: Self = serde_json::from_str(json)?;
        summary.answer = QuestionAnswer::read(&summary.question, json)?;
        Ok(summary)
    }

    /// Lines that `explain` prints about the answer.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "{}: {}, {} failed, {} tracked again",
            self.question,
            counted(self.paths.total, "path"),
            self.paths.failed,
            self.paths.retracked
        )];
        let unsettled = self.unsettled.iter();
        lines.extend(unsettled.map(|doubt| format!("not settled: {doubt}")));
        lines.extend(self.warnings.iter().map(|w| format!("warning: {w}")));
        lines
    }
}
