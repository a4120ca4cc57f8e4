//! The same answers for people and for programs.

pub mod progress;
pub mod summary;
pub mod table;
pub mod text;

use std::io::Write;

/// Writes to standard output. A reader that has gone away (`| head`) is no error.
pub fn print(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
