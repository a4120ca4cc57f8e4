//! `cognate explain`: how a job's numbers came about.

use crate::arguments::{Format, OneJob};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output::{self, json};

/// Prints the coordinator's description of a job's plan and of its stages.
pub async fn run(a: &OneJob) -> Result<Exit, ClientError> {
    let mut connection = Connection::open(&a.service.target()?).await?;
    let explanation = connection.explanation(&a.job).await?;
    let text = match a.format {
        Format::Table => format!("{}\n", explanation.text.trim_end()),
        Format::Json => json::summary(&explanation.json),
    };
    output::print(&text)?;
    Ok(Exit::Solved)
}
