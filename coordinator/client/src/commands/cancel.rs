//! `cognate cancel`: stops a job.

use crate::arguments::{Format, OneJob};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output::{self, json};
use cognate_protocol::v1::JobState;

/// Stops a job; one that has ended already stays as it is, and that is said.
pub async fn run(a: &OneJob) -> Result<Exit, ClientError> {
    let mut connection = Connection::open(&a.service.target()?).await?;
    let state = connection.cancel(&a.job).await?;
    let name = json::state_name(state);
    let text = match (a.format, state) {
        (Format::Json, _) => {
            let answer = serde_json::json!({ "job": a.job, "state": name });
            format!("{answer}\n")
        }
        (Format::Table, JobState::Cancelled) => format!("{} is cancelled\n", a.job),
        (Format::Table, JobState::Solved | JobState::Failed) => {
            format!("{} had ended before: {name}\n", a.job)
        }
        (Format::Table, _) => format!("{} is being cancelled\n", a.job),
    };
    output::print(&text)?;
    Ok(Exit::Solved)
}
