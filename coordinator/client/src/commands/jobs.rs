//! `cognate jobs`: all jobs of a coordinator, newest first.

use crate::arguments::{Format, Listing};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output::text::{Columns, Look, count, seconds};
use crate::output::{self, json};
use cognate_protocol::v1::JobOverview;
use std::time::{SystemTime, UNIX_EPOCH};

/// Lists the jobs.
pub async fn run(a: &Listing) -> Result<Exit, ClientError> {
    let mut connection = Connection::open(&a.service.target()?).await?;
    let jobs = connection.jobs().await?;
    let text = match a.format {
        Format::Json => json::jobs(&jobs),
        Format::Table => {
            let now = SystemTime::now()
                .duration_since(UNIX_EPOCH)
                .unwrap_or_default();
            table(&jobs, now.as_secs_f64(), Look::of_standard_output())
        }
    };
    output::print(&text)?;
    Ok(Exit::Solved)
}

/// The jobs as a table; `now` in seconds since 1970.
pub fn table(jobs: &[JobOverview], now: f64, look: Look) -> String {
    if jobs.is_empty() {
        return "no jobs yet; `cognate submit FILE` makes one\n".into();
    }
    let mut columns = Columns::new(&["JOB", "NAME", "STATE", ">PATHS", ">OF", ">AGE"]);
    for j in jobs {
        let submitted = j.submitted_unix_ms as f64 / 1e3;
        columns.row(vec![
            j.job.clone(),
            j.name.clone(),
            json::state_name(j.state()).into(),
            count(j.items_accepted),
            count(j.items_total),
            age(now - submitted),
        ]);
    }
    columns.render(look)
}

/// An age in whole units; clocks of two machines may differ by a little.
pub fn age(s: f64) -> String {
    match s.max(0.0) {
        s if s < 60.0 => format!("{} s", s as u64),
        s if s < 86_400.0 => seconds(s),
        s => format!("{} d", (s / 86_400.0) as u64),
    }
}
