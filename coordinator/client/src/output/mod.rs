//! Answers in two forms: for people and for programs.

pub mod answers;
pub mod axes;
mod bertini;
pub mod beside_rows;
pub mod certificates;
pub mod curve_dxf;
pub mod curve_svg;
pub mod decomposition;
pub mod drawing;
pub mod exceptional;
pub mod family;
pub mod files;
pub mod json;
pub mod linkages;
pub mod listed;
pub mod mechanisms;
pub mod objects;
pub mod parquet;
pub mod paths;
pub mod progress;
pub mod rates;
pub mod screen;
pub mod solution_list;
pub mod summary;
pub mod surface;
pub mod sweep;
pub mod sweep_folder;
pub mod sweep_solutions;
pub mod table;
pub mod text;
mod witness_files;

use super::error::ClientError;
use std::io::Write;

/// Writes to standard output. A reader that has gone away (`| head`) is no error.
pub fn print(text: &str) -> Result<(), ClientError> {
    let mut out = std::io::stdout().lock();
    unless_gone(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Writes a JSON object to standard output, laid out for reading.
pub fn print_json(value: &impl serde::Serialize) -> Result<(), ClientError> {
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let written = serde_json::to_writer_pretty(&mut out, value).map_err(std::io::Error::from);
    unless_gone(
        written
            .and_then(|()| out.write_all(b"\n"))
            .and_then(|()| out.flush()),
    )
}

/// Result of writing to standard output; a reader that has gone away is no error.
fn unless_gone(written: std::io::Result<()>) -> Result<(), ClientError> {
    match written {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(ClientError::File {
            action: "cannot write",
            path: "standard output".into(),
            source: e,
        }),
        _ => Ok(()),
    }
}
