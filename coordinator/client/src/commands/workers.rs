//! `cognate workers`: who tracks for a coordinator.

use crate::arguments::{Format, Listing};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output::text::{Columns, Look, count, seconds};
use crate::output::{self, json};
use cognate_protocol::v1::WorkerOverview;

/// Lists the workers.
pub async fn run(a: &Listing) -> Result<Exit, ClientError> {
    let mut connection = Connection::open(&a.service.target()?).await?;
    let workers = connection.workers().await?;
    let text = match a.format {
        Format::Json => json::workers(&workers),
        Format::Table => table(&workers, Look::of_standard_output()),
    };
    output::print(&text)?;
    Ok(Exit::Solved)
}

/// Activity of a worker, or the reason why it gets no work.
pub fn state(w: &WorkerOverview) -> String {
    if !w.refused.is_empty() {
        format!("refused: {}", w.refused)
    } else if w.leased_chunks > 0 {
        "tracking".into()
    } else {
        format!("idle {}", seconds(w.idle_seconds))
    }
}

/// The workers as a table.
pub fn table(workers: &[WorkerOverview], look: Look) -> String {
    if workers.is_empty() {
        return "no workers; `cognate worker --coordinator URL` starts one\n".into();
    }
    let mut columns = Columns::new(&[
        "WORKER", "HOST", ">THREADS", "LANES", "VIA", ">CHUNKS", ">PATHS", "STATE",
    ]);
    for w in workers {
        let lanes = match w.lane_width {
            0 => w.instruction_set.clone(),
            width => format!("{width} {}", w.instruction_set),
        };
        columns.row(vec![
            w.worker.clone(),
            w.host.clone(),
            count(w.threads.into()),
            lanes,
            w.transport.clone(),
            count(w.accepted_chunks),
            count(w.accepted_paths),
            state(w),
        ]);
    }
    columns.render(look)
}
