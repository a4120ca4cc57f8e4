//! `cognate delete`: removes jobs that have ended.

use crate::arguments::{Delete, Format};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output;
use crate::output::text::{counted, seconds};
use cognate_protocol::v1::DeleteResponse;
use serde_json::json;

/// Deletes job after job. One that is refused is said, and the others are deleted all the same.
pub async fn run(a: &Delete) -> Result<Exit, ClientError> {
    let mut connection = Connection::open(&a.service.target()?).await?;
    let mut exit = Exit::Solved;
    for job in &a.jobs {
        match connection.delete(job, a.cancel_first).await {
            Ok(removed) => output::print(&text(job, &removed, a.format))?,
            Err(ClientError::Refused(why)) => {
                eprintln!("error: {}", ClientError::Refused(why));
                exit = Exit::BadInput;
            }
            Err(error) => return Err(error),
        }
    }
    Ok(exit)
}

fn text(job: &str, removed: &DeleteResponse, format: Format) -> String {
    if format == Format::Json {
        let answer = json!({
            "job": job,
            "stages": removed.stages,
            "chunks": removed.chunks,
            "objects": removed.objects,
            "bytes": removed.bytes,
            "deleted_before": removed.deleted_before,
            "grace_seconds": removed.grace_seconds,
        });
        return format!("{answer}\n");
    }
    let state = match removed.deleted_before {
        true => "had been deleted before",
        false => "is deleted",
    };
    format!(
        "{job} {state}: {}, {}, {} of results ({}); what nothing else names goes \
         in {}\n",
        counted(removed.stages, "stage"),
        counted(removed.chunks, "chunk"),
        counted(removed.objects, "object"),
        counted(removed.bytes, "byte"),
        seconds(removed.grace_seconds)
    )
}
