//! The answers for programs: one object on standard output, and the lines of solutions.jsonl.

use cognate_protocol::v1;
use cognate_solutions::solution::Solution;
use serde_json::{Map, Value, json};

/// A solution as a line of `solutions.jsonl`, without the line's end; with several targets each says at which of
/// them it is.
pub fn solution_line(solution: &Solution, target: Option<u32>) -> String {
    #[derive(serde::Serialize)]
    struct Line<'a> {
        #[serde(flatten)]
        solution: &'a Solution,
        #[serde(skip_serializing_if = "Option::is_none")]
        target: Option<u32>,
    }
    let line = Line { solution, target };
    serde_json::to_string(&line).expect("a solution has only names and numbers")
}

/// A double with the digits that it has; JSON has no infinity, and what is unknown is null.
fn number(x: f64) -> Value {
    serde_json::Number::from_f64(x).map_or(Value::Null, Value::Number)
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
pub fn submitted(job: &str, warnings: &[String]) -> String {
    let mut answer = json!({ "job": job });
    if !warnings.is_empty() {
        answer["warnings"] = json!(warnings);
    }
    format!("{answer}\n")
}

/// State and progress of a job, as JSON.
pub fn progress(p: &v1::JobProgress, exit: u8) -> String {
    let stages: Vec<Value> = p
        .stages
        .iter()
        .map(|s| {
            json!({
                "stage": s.stage, "purpose": s.purpose, "total": s.total, "ready": s.ready,
                "leased": s.leased, "accepted": s.accepted, "failed": s.failed,
                "mixed_cells": s.mixed_cells,
            })
        })
        .collect();
    let outcomes: Map<String, Value> = p
        .outcomes
        .iter()
        .map(|o| (o.name.clone(), json!(o.count)))
        .collect();
    let answer = json!({
        "job": p.job,
        "state": state_name(p.state()),
        "exit_code": exit,
        "message": if p.message.is_empty() { Value::Null } else { json!(p.message) },
        "elapsed_seconds": number(p.elapsed_seconds),
        "stages": stages,
        "outcomes": outcomes,
        "warnings": p.warnings,
    });
    format!("{answer}\n")
}

/// All jobs.
pub fn jobs(jobs: &[v1::JobOverview]) -> String {
    let list: Vec<Value> = jobs
        .iter()
        .map(|j| {
            json!({
                "job": j.job, "name": j.name, "tenant": j.tenant, "state": state_name(j.state()),
                "submitted_unix_ms": j.submitted_unix_ms,
                "paths_total": j.items_total, "paths_accepted": j.items_accepted,
            })
        })
        .collect();
    format!("{}\n", json!({ "jobs": list }))
}

/// All workers.
pub fn workers(workers: &[v1::WorkerOverview]) -> String {
    let list: Vec<Value> = workers
        .iter()
        .map(|w| {
            json!({
                "worker": w.worker, "host": w.host, "version": w.version,
                "numerics_revision": w.numerics_revision, "instruction_set": w.instruction_set,
                "lane_width": w.lane_width, "threads": w.threads, "transport": w.transport,
                "idle_seconds": number(w.idle_seconds), "leased_chunks": w.leased_chunks,
                "accepted_chunks": w.accepted_chunks, "accepted_paths": w.accepted_paths,
                "refused": if w.refused.is_empty() { Value::Null } else { json!(w.refused) },
            })
        })
        .collect();
    format!("{}\n", json!({ "workers": list }))
}

/// The summary as the service gave it, laid out for reading.
pub fn summary(json: &str) -> String {
    // The service's own text goes through untouched where it is no JSON: better odd than lost.
    match serde_json::from_str::<Value>(json) {
        Ok(value) => format!("{value:#}\n"),
        Err(_) => format!("{}\n", json.trim_end()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_keeps_its_fields_and_numbers() {
        let shown = summary(r#"{"b": 1, "a": {"c": 1e-16}}"#);
        let value: Value = serde_json::from_str(&shown).expect("one object");
        assert_eq!(value["b"], 1);
        assert_eq!(value["a"]["c"].as_f64(), Some(1e-16));
    }
}
