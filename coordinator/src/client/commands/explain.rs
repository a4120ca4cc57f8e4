//! `cognate explain`: how a job's numbers came about.

use crate::client::arguments::{Format, OneJob};
use crate::client::connection::Connection;
use crate::client::error::{ClientError, Exit};
use crate::client::output::{self, json};

/// Prints what the coordinator says about a job's plan and what became of it.
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
