//! InputLine: the lines of an input that goes on, read one by one until it ends, none of them longer than is allowed.

use std::io::{BufRead, Read};

/// A line as it came.
pub enum InputLine {
    /// The line, with its end where it has one.
    Whole(Vec<u8>),
    /// A line that is longer than allowed; its content is passed by.
    TooLong,
    /// The input failed.
    Broken(std::io::Error),
}

/// Reads lines of at most `longest` bytes and hands each to `take`, until the input ends or `take` wants no more.
pub fn read_lines(mut input: impl BufRead, longest: u64, mut take: impl FnMut(InputLine) -> bool) {
    loop {
        let mut content = Vec::new();
        let taken = input.by_ref().take(longest).read_until(b'\n', &mut content);
        let line = match taken {
            Ok(0) => return,
            Ok(_) if content.ends_with(b"\n") || (content.len() as u64) < longest => {
                InputLine::Whole(content)
            }
            Ok(_) => match skip_line(&mut input) {
                Ok(()) => InputLine::TooLong,
                Err(error) => InputLine::Broken(error),
            },
            Err(error) => InputLine::Broken(error),
        };
        let is_end = matches!(line, InputLine::Broken(_));
        if !take(line) || is_end {
            return;
        }
    }
}

/// Passes by the rest of a line without holding it.
fn skip_line(input: &mut impl BufRead) -> std::io::Result<()> {
    loop {
        let buffer = input.fill_buf()?;
        let end = buffer.iter().position(|byte| *byte == b'\n');
        let (length, is_done) = match end {
            Some(end) => (end + 1, true),
            None => (buffer.len(), buffer.is_empty()),
        };
        input.consume(length);
        if is_done {
            return Ok(());
        }
    }
}
