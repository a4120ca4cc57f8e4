//! The answers for programs: one object on standard output, and the lines of solutions.jsonl.

use super::listed::WantedCounts;
use cognate_protocol::client_json;
pub use cognate_protocol::client_json::state_name;
use cognate_protocol::v1;
use serde_json::{Value, json};

/// The job's id, as `submit` answers.
pub fn submitted(job: &str, warnings: &[String]) -> String {
    format!("{}\n", client_json::submitted(job, warnings))
}

/// State and progress of a job, as JSON.
pub fn progress(p: &v1::JobProgress, exit: u8) -> String {
    let mut answer = client_json::progress(p);
    answer["exit_code"] = json!(exit);
    format!("{answer}\n")
}

/// All jobs.
pub fn jobs(jobs: &[v1::JobOverview]) -> String {
    format!("{}\n", client_json::jobs(jobs))
}

/// All workers.
pub fn workers(workers: &[v1::WorkerOverview]) -> String {
    format!("{}\n", client_json::workers(workers))
}

/// The summary as the service gave it, laid out for reading.
pub fn summary(json: &str) -> String {
    // The service's own text goes through untouched where it is no JSON: better odd than lost.
    match serde_json::from_str::<Value>(json) {
        Ok(value) => format!("{value:#}\n"),
        Err(_) => format!("{}\n", json.trim_end()),
    }
}

/// The summary as the service gave it, with the counts of the solutions that are wanted.
pub fn summary_with(json: &str, wanted: &WantedCounts) -> String {
    let Ok(mut value) = serde_json::from_str::<Value>(json) else {
        return summary(json);
    };
    if let Some(selected) = &wanted.selected {
        value["selected"] = json!(selected);
    }
    if wanted.undecided() > 0 {
        value["settled"] = json!(false);
    }
    if let Some(critical) = &wanted.critical {
        value["critical"] = json!(critical);
        // The solutions have no multipliers.
        value["problem"]["variables"] = json!(wanted.unknowns);
    }
    format!("{value:#}\n")
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
