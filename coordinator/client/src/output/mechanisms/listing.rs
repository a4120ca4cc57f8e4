//! Listings: how answers about a mechanism are written while they come, so that memory does not grow with the number of
//! targets.

use crate::error::ClientError;
use crate::output::files::Written;
use crate::output::unless_gone;
use cognate_mechanism_solver::postures::Postures;
use cognate_mechanism_solver::summary::Summary;
use std::io::{BufWriter, Stdout, Write};

/// Totals that are known when all targets are answered.
#[derive(Clone, Copy, Debug)]
pub struct Finished<'a> {
    /// Summary of all targets together.
    pub summary: &'a Summary,
    /// Time from reading the file to the answer, in seconds.
    pub wall_seconds: f64,
    /// CPU time of all threads for the answer, in seconds.
    pub cpu_seconds: f64,
}

/// Writes answers in some form.
pub trait Listing {
    /// Takes the answer for the target of this number, counted from 0; targets come in their order.
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError>;
    /// Writes the text after the last target.
    fn finish(self: Box<Self>, end: &Finished<'_>) -> Result<(), ClientError>;
}

/// Where a listing is written.
pub enum Sink {
    /// Standard output. A reader that has gone away (`| head`) is no error.
    Standard(BufWriter<Stdout>),
    /// A file that has its name once it is whole.
    File(Written),
}

impl Sink {
    /// Standard output.
    pub fn standard() -> Self {
        Self::Standard(BufWriter::new(std::io::stdout()))
    }

    /// Writes a text.
    pub fn write(&mut self, text: &str) -> Result<(), ClientError> {
        match self {
            Self::Standard(out) => unless_gone(out.write_all(text.as_bytes())),
            Self::File(file) => file.write(text),
        }
    }

    /// Everything is written.
    pub fn finish(self) -> Result<(), ClientError> {
        match self {
            Self::Standard(mut out) => unless_gone(out.flush()),
            Self::File(file) => file.finish(),
        }
    }
}
