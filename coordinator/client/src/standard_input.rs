//! Standard input: the text that was read from it, kept for the line that corrects it.

use std::sync::OnceLock;

/// The name of standard input in messages.
pub const NAME: &str = "standard input";

/// Bytes that are kept at most.
const LONGEST: usize = 100_000;

static KEPT: OnceLock<Vec<u8>> = OnceLock::new();

/// Keeps what was read, which is gone for a second reader, where it is short.
pub fn keep(content: &[u8]) {
    if content.len() <= LONGEST {
        KEPT.get_or_init(|| content.to_vec());
    }
}

/// The text that was kept.
pub fn kept() -> Option<&'static str> {
    std::str::from_utf8(KEPT.get()?).ok()
}
