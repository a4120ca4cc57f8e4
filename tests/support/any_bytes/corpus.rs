//! Corpus: the inputs of a reader that are kept in the tree, a line each in `tests/any_bytes/READER.txt`.
//!
//! `fault` was one that the reader failed at; `reach` takes edges of the code that shorter ones do not. Bytes are
//! escaped as Rust escapes them.

use std::io::{self, Write};
use std::path::PathBuf;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/any_bytes");
/// Largest number of bytes of the kept inputs of a reader, without faults: 26 readers have a quarter of a megabyte.
const MOST_BYTES: usize = 9_000;

/// The corpus of a reader.
pub struct Corpus {
    file: PathBuf,
    faults: Vec<Vec<u8>>,
    reaching: Vec<Vec<u8>>,
}

impl Corpus {
    /// Reads the corpus of a reader; empty where there is none.
    pub fn of(reader: &str) -> Self {
        let file = PathBuf::from(format!("{FOLDER}/{reader}.txt"));
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let of_kind = |kind: &str| -> Vec<Vec<u8>> {
            let lines = text.lines().filter_map(|line| line.split_once(' '));
            let lines = lines.filter(|(is, _)| *is == kind);
            lines.map(|(_, escaped)| unescaped(escaped)).collect()
        };
        let (faults, reaching) = (of_kind("fault"), of_kind("reach"));
        Self {
            file,
            faults,
            reaching,
        }
    }

    /// All inputs.
    pub fn inputs(&self) -> impl Iterator<Item = Vec<u8>> {
        self.faults.iter().chain(&self.reaching).cloned()
    }

    /// Adds an input that the reader fails at, unless it is there.
    pub fn add_fault(&self, bytes: &[u8]) -> io::Result<()> {
        if self.inputs().any(|input| input == bytes) {
            return Ok(());
        }
        let mut options = std::fs::OpenOptions::new();
        let mut file = options.append(true).create(true).open(&self.file)?;
        writeln!(file, "fault {}", bytes.escape_ascii())
    }

    /// Writes the corpus anew: the faults that it has, and these.
    pub fn keep(&self, reaching: Vec<Vec<u8>>) -> io::Result<()> {
        let mut text = String::new();
        for (kind, inputs) in [("fault", &self.faults), ("reach", &reaching)] {
            for bytes in inputs {
                text.push_str(&format!("{kind} {}\n", bytes.escape_ascii()));
            }
        }
        std::fs::write(&self.file, text)
    }
}

/// Of these inputs the shortest that reach what none before them does, as many as a corpus may have.
pub fn shortest(mut inputs: Vec<Vec<u8>>, reaches: &mut impl FnMut(&[u8]) -> bool) -> Vec<Vec<u8>> {
    inputs.sort_by(|a, b| (a.len(), a).cmp(&(b.len(), b)));
    let mut room = MOST_BYTES;
    inputs.retain(|bytes| {
        let size = bytes.escape_ascii().count() + "reach \n".len();
        let is_kept = size <= room && reaches(bytes);
        room -= if is_kept { size } else { 0 };
        is_kept
    });
    inputs
}

/// The bytes that were escaped so.
///
/// # Panics
/// When it is no such text.
fn unescaped(text: &str) -> Vec<u8> {
    let mut rest = text.bytes();
    let mut bytes = Vec::with_capacity(text.len());
    let digit = |byte: Option<u8>| {
        let digit = byte.and_then(|byte| char::from(byte).to_digit(16));
        digit.expect("\\x has two hexadecimal digits") as u8
    };
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'\\' => match rest.next().expect("something is escaped") {
                b'n' => b'\n',
                b'r' => b'\r',
                b't' => b'\t',
                b'x' => 16 * digit(rest.next()) + digit(rest.next()),
                other => other,
            },
            other => other,
        });
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_bytes_are_escaped_and_back() {
        let every_byte: Vec<u8> = (0..=255).collect();
        assert_eq!(
            unescaped(&every_byte.escape_ascii().to_string()),
            every_byte
        );
    }

    #[test]
    fn the_shortest_that_reach_something_new_are_kept() {
        let inputs = [&b"aaaa"[..], b"b", b"ab", b"a"].map(<[u8]>::to_vec);
        let mut seen: Vec<u8> = Vec::new();
        let mut reaches = |bytes: &[u8]| {
            let new = bytes.iter().any(|byte| !seen.contains(byte));
            seen.extend(bytes);
            new
        };
        let kept = shortest(inputs.to_vec(), &mut reaches);
        assert_eq!(kept, [b"a".to_vec(), b"b".to_vec()]);
    }
}
