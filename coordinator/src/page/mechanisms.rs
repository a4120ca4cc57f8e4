//! Mechanisms: questions about links and joints. The service knows polynomials only; the program that starts a
//! coordinator may provide a [`Mechanisms`], which runs in this process and answers one question at a time.

use serde_json::Value;
use std::fmt::Debug;

/// Most bytes of a question: a file and its targets.
pub const MOST_BYTES: usize = 4 << 20;

/// Question about a mechanism.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MechanismQuestion {
    /// Name of the file, for its kind and for messages.
    pub name: String,
    /// The file: JSON, TOML, URDF, or a table of rows.
    pub file: String,
    /// Poses of the output, or values of the inputs: JSON, or CSV with a header.
    pub targets: String,
    /// Whether targets are poses; else they are inputs.
    pub poses: bool,
    /// Follow branches along the targets.
    pub follow: bool,
    /// Prove the positions.
    pub certify: bool,
}

/// Answers questions about mechanisms, in the calling thread: it may be interrupted
/// ([`cognate_numeric::interruption`]). Errors are sentences for the person who asked.
pub trait Mechanisms: Debug + Send + Sync {
    /// Kinds of targets of a mechanism, with examples as CSV, the usual one first:
    /// `{"name", "angles": "deg"|"rad", "given": [["poses"|"inputs", csv]...], "no_inputs": why}`.
    fn describe(&self, name: &str, file: &str) -> Result<Value, String>;
    /// Positions or branches, as [`cognate_summary::pictures::MECHANISM`] draws them.
    fn positions(&self, question: &MechanismQuestion) -> Result<Value, String>;
}
