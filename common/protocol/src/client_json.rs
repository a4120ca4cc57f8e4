//! JSON objects of the service for clients, as `cognate ... --format json` prints them and the live page reads them.

use crate::v1;
use cognate_solutions::critical::CriticalPoint;
use cognate_solutions::solution::Solution;
use serde_json::{Map, Value, json};
use std::fmt;

/// A solution as a line of `solutions.jsonl`; shown, it is the line without its end.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct SolutionLine<'a> {
    /// The solution.
    #[serde(flatten)]
    pub solution: &'a Solution,
    /// The index of its target parameters, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<u32>,
    /// Whether the conditions that were asked hold with equality only; null where it is not known whether they hold, and
    /// `None` where none were asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_border: Option<Option<bool>>,
    /// Kind of critical point; `None` unless an objective was given.
    #[serde(flatten)]
    pub critical: Option<CriticalPoint>,
}

impl fmt::Display for SolutionLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&serde_json::to_string(self).expect("a solution has only names and numbers"))
    }
}

/// A solution as a line of `solutions.jsonl`, without the line's end; with several targets each says at which of
/// them it is.
pub fn solution_line(solution: &Solution, target: Option<u32>) -> String {
    let line = SolutionLine {
        solution,
        target,
        on_border: None,
        critical: None,
    };
    line.to_string()
}

/// A double with the digits that it has; JSON has no infinity, and what is unknown is null.
pub fn number(x: f64) -> Value {
    serde_json::Number::from_f64(x).map_or(Value::Null, Value::Number)
}

/// A text, or null for none.
fn text(text: &str) -> Value {
    match text {
        "" => Value::Null,
        text => json!(text),
    }
}

/// A state's name, as it is in every JSON answer and table.
pub fn state_name(state: v1::JobState) -> &'static str {
    match state {
        v1::JobState::Unspecified => "unknown",
        v1::JobState::Queued => "queued",
        v1::JobState::Running => "running",
        v1::JobState::Solved => "solved",
        v1::JobState::Failed => "failed",
        v1::JobState::Cancelled => "cancelled",
    }
}

/// The job's id, as `submit` answers.
pub fn submitted(job: &str, warnings: &[String]) -> Value {
    let mut answer = json!({ "job": job });
    if !warnings.is_empty() {
        answer["warnings"] = json!(warnings);
    }
    answer
}

/// State and progress of a job.
pub fn progress(p: &v1::JobProgress) -> Value {
    let stages = p.stages.iter().map(|s| {
        json!({
            "stage": s.stage, "purpose": s.purpose, "total": s.total, "ready": s.ready,
            "leased": s.leased, "accepted": s.accepted, "failed": s.failed,
            "mixed_cells": s.mixed_cells,
        })
    });
    let outcomes = p.outcomes.iter().map(|o| (o.name.clone(), json!(o.count)));
    json!({
        "job": p.job,
        "state": state_name(p.state()),
        "message": text(&p.message),
        "elapsed_seconds": number(p.elapsed_seconds),
        "stages": stages.collect::<Vec<_>>(),
        "outcomes": outcomes.collect::<Map<_, _>>(),
        "warnings": p.warnings,
    })
}

/// A list of jobs.
pub fn jobs(jobs: &[v1::JobOverview]) -> Value {
    let list = jobs.iter().map(|j| {
        json!({
            "job": j.job, "name": j.name, "tenant": j.tenant, "state": state_name(j.state()),
            "submitted_unix_ms": j.submitted_unix_ms,
            "paths_total": j.items_total, "paths_accepted": j.items_accepted,
        })
    });
    json!({ "jobs": list.collect::<Vec<_>>() })
}

/// A list of workers.
pub fn workers(workers: &[v1::WorkerOverview]) -> Value {
    let list = workers.iter().map(|w| {
        json!({
            "worker": w.worker, "host": w.host, "version": w.version,
            "numerics_revision": w.numerics_revision, "instruction_set": w.instruction_set,
            "lane_width": w.lane_width, "threads": w.threads, "transport": w.transport,
            "idle_seconds": number(w.idle_seconds), "leased_chunks": w.leased_chunks,
            "accepted_chunks": w.accepted_chunks, "accepted_paths": w.accepted_paths,
            "refused": text(&w.refused),
        })
    });
    json!({ "workers": list.collect::<Vec<_>>() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_written_as_agreed() {
        let progress = progress(&v1::JobProgress {
            job: "j".to_owned(),
            state: v1::JobState::Running.into(),
            stages: vec![v1::StageProgress {
                total: 8,
                ready: 1,
                leased: 2,
                accepted: 5,
                purpose: "paths".to_owned(),
                ..v1::StageProgress::default()
            }],
            outcomes: vec![v1::NamedCount {
                name: "regular".to_owned(),
                count: 5,
            }],
            elapsed_seconds: 0.5,
            ..v1::JobProgress::default()
        });
        let expected = json!({
            "job": "j", "state": "running", "message": null, "elapsed_seconds": 0.5, "warnings": [],
            "outcomes": {"regular": 5},
            "stages": [{"stage": 0, "purpose": "paths", "total": 8, "ready": 1, "leased": 2, "accepted": 5,
                "failed": 0, "mixed_cells": null}],
        });
        assert_eq!(progress, expected);
    }

    #[test]
    fn jobs_and_workers_are_written_as_agreed() {
        let job = v1::JobOverview {
            job: "j".to_owned(),
            name: "a.bertini".to_owned(),
            tenant: "default".to_owned(),
            state: v1::JobState::Solved.into(),
            submitted_unix_ms: 17,
            items_total: 8,
            items_accepted: 8,
        };
        let expected = json!({"jobs": [{"job": "j", "name": "a.bertini", "tenant": "default", "state": "solved",
            "submitted_unix_ms": 17, "paths_total": 8, "paths_accepted": 8}]});
        assert_eq!(jobs(&[job]), expected);
        let worker = v1::WorkerOverview {
            worker: "w".to_owned(),
            idle_seconds: f64::INFINITY,
            ..v1::WorkerOverview::default()
        };
        let expected = json!({"workers": [{"worker": "w", "host": "", "version": "", "numerics_revision": 0,
            "instruction_set": "", "lane_width": 0, "threads": 0, "transport": "", "idle_seconds": null,
            "leased_chunks": 0, "accepted_chunks": 0, "accepted_paths": 0, "refused": null}]});
        assert_eq!(workers(&[worker]), expected);
    }
}
