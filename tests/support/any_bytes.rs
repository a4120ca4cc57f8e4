//! Any bytes: readers are given what a seed makes of good files, and must end in time and memory, with a value or an error.
//!
//! Each reader has a second, or `COGNATE_FUZZ_SECONDS`, from the seed 1, or `COGNATE_FUZZ_SEED`. An input that a
//! reader panics at, or takes too long or too much memory for, is written to a file that the test names. What was found
//! so is kept in `tests/any_bytes`.

use crate::dice::Dice;
use crate::measures::memory_bytes;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Inputs that a reader once failed at, in a folder of its name.
const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/any_bytes");

/// No input may take longer, ...
const LONGEST: Duration = Duration::from_secs(10);
/// ... nor more memory than all before it, in bytes, ...
const MEMORY: u64 = 512 << 20;
/// ... and none is longer, in bytes.
const LENGTH: usize = 64 << 10;

/// Words that readers know or numbers at their limits, put where bytes were.
const WORDS: [&str; 30] = [
    "0",
    "-1",
    "1e999999",
    "1/0",
    "NaN",
    "inf",
    "18446744073709551615",
    "9223372036854775808",
    "4294967296",
    "99999999999999999999999999999999999999",
    "^",
    "^1000000000000",
    "((((((((((((((((",
    "[[[[[[[[[[[[[[[[",
    "{\"\":",
    "\"",
    "\\u0000",
    "\u{feff}",
    "\u{202e}",
    "é",
    ";",
    ",,",
    "=",
    "%",
    "<!--",
    "<a>",
    "]]>",
    "&amp;",
    "\r\n",
    "\t",
];

fn setting(name: &str, default: u64) -> u64 {
    let value = std::env::var(name).ok();
    value.map_or(default, |value| {
        let number = value.parse();
        number.unwrap_or_else(|_| panic!("{name}={value} is no number"))
    })
}

/// What the dice make of some good inputs.
struct Inputs<'a> {
    good: &'a [Vec<u8>],
    dice: Dice,
}

impl Inputs<'_> {
    fn below(&mut self, bound: usize) -> usize {
        self.dice.below(bound.max(1) as u64) as usize
    }

    /// A good input with some places changed.
    fn next(&mut self) -> Vec<u8> {
        let first = self.below(self.good.len());
        let mut bytes = self.good[first].clone();
        for _ in 0..1 + self.below(4) {
            self.change(&mut bytes);
        }
        bytes.truncate(LENGTH);
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>) {
        let at = self.below(bytes.len() + 1);
        let longest = if self.below(8) == 0 { bytes.len() } else { 16 };
        let length = self.below(longest) + 1;
        let end = (at + length).min(bytes.len());
        match self.below(9) {
            0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
            1 if at < bytes.len() => bytes[at] = self.below(256) as u8,
            2 => drop(bytes.drain(at..end)),
            3 => bytes.truncate(at),
            4 => {
                let again: Vec<u8> = bytes[at..end].to_vec();
                for _ in 0..1 + self.below(30) {
                    bytes.splice(at..at, again.iter().copied());
                }
            }
            5 => {
                let word = WORDS[self.below(WORDS.len())];
                bytes.splice(at..end, word.bytes());
            }
            6 => {
                // The largest and smallest numbers of each width, in the order of bytes that records have.
                let fill = if self.below(2) == 0 { 0xff } else { 0 };
                let width = 1 << self.below(4);
                bytes[at..].iter_mut().take(width).for_each(|b| *b = fill);
            }
            _ => {
                let other = self.below(self.good.len());
                let other = &self.good[other];
                let from = self.dice.below(other.len() as u64 + 1) as usize;
                let part = &other[from..(from + length * 8).min(other.len())];
                bytes.splice(at..end, part.iter().copied());
            }
        }
    }
}

/// The inputs of the corpus.
fn found_before(name: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(format!("{CORPUS}/{name}"));
    let entries = entries.into_iter().flatten().flatten();
    entries
        .map(|entry| std::fs::read(entry.path()).expect("the corpus is readable"))
        .collect()
}

/// Gives a reader what the seed makes of these inputs, and the inputs themselves. `read` says whether it took the bytes.
///
/// # Panics
/// When the reader does, or an input takes too long or too much memory, or all inputs are refused or taken, which shows
/// nothing.
pub fn read_any_bytes(name: &str, good: &[Vec<u8>], read: impl Fn(&[u8]) -> bool) {
    assert!(!good.is_empty(), "{name}: there are no good inputs");
    let seconds = setting("COGNATE_FUZZ_SECONDS", 1);
    let mut inputs = Inputs {
        good,
        dice: Dice(setting("COGNATE_FUZZ_SEED", 1)),
    };
    let (mut taken, mut refused) = (0u64, 0u64);
    let peak = || memory_bytes("self", "VmHWM").unwrap_or(0);
    let mut check = |bytes: &[u8]| {
        let (before, began) = (peak(), Instant::now());
        let outcome = catch_unwind(AssertUnwindSafe(|| read(bytes)));
        let (took, more) = (began.elapsed(), peak().saturating_sub(before));
        let wrong = match outcome {
            Ok(was_taken) => {
                *(if was_taken { &mut taken } else { &mut refused }) += 1;
                match (took > LONGEST, more > MEMORY) {
                    (true, _) => format!("takes {took:?}"),
                    (_, true) => format!("takes {} MiB", more >> 20),
                    _ => return,
                }
            }
            Err(_) => "panics".to_owned(),
        };
        let file = std::env::temp_dir().join(format!("any-bytes-{name}-{}", std::process::id()));
        let written = std::fs::write(&file, bytes);
        panic!("{name} {wrong} at {} ({written:?})", file.display());
    };
    for bytes in good.iter().chain(&found_before(name)) {
        check(bytes);
    }
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(seconds) {
        check(&inputs.next());
    }
    println!("{name}: {taken} inputs taken, {refused} refused");
    assert!(
        taken > 0 && refused > 0,
        "{name}: {taken} taken, {refused} refused"
    );
}
