//! Any bytes: readers are given what a seed makes of good files, and must end in time and memory, with a value or an error.
//!
//! Each reader has a second, or `COGNATE_FUZZ_SECONDS`, from the seed 1, or `COGNATE_FUZZ_SEED`. An input that a
//! reader panics at, or takes too long or too much memory for, is added to its corpus. Where the program counts its edges
//! ([`coverage`]), inputs that reach new ones are changed further, and `COGNATE_FUZZ_KEEP=yes` keeps the shortest of
//! them: `tests/any_bytes/README.md`.

mod corpus;
mod reach;

use crate::coverage;
use crate::dice::Dice;
use crate::measures::memory_bytes;
use corpus::Corpus;
use reach::Reach;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Longest time that a reader may take for one input.
const LONGEST: Duration = Duration::from_secs(10);
/// Largest growth of the peak memory while a reader takes one input, in bytes.
const MEMORY: u64 = 512 << 20;
/// Largest length of an input, in bytes.
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

/// Inputs made at random from good ones.
struct Inputs {
    good: Vec<Vec<u8>>,
    dice: Dice,
}

impl Inputs {
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
                let repeated_bytes: Vec<u8> = bytes[at..end].to_vec();
                for _ in 0..1 + self.below(30) {
                    bytes.splice(at..at, repeated_bytes.iter().copied());
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

/// Counts of a reader: inputs that it took, and inputs that it refused.
struct Trial<'a> {
    name: &'a str,
    corpus: Corpus,
    taken: u64,
    refused: u64,
}

impl Trial<'_> {
    /// Gives the reader an input.
    ///
    /// # Panics
    /// When the reader does, or takes too long or too much memory.
    fn check(&mut self, bytes: &[u8], read: &impl Fn(&[u8]) -> bool) {
        let peak = || memory_bytes("self", "VmHWM").unwrap_or(0);
        let (before, began) = (peak(), Instant::now());
        let outcome = catch_unwind(AssertUnwindSafe(|| read(bytes)));
        let (took, more) = (began.elapsed(), peak().saturating_sub(before));
        let wrong = match outcome {
            Ok(was_taken) => {
                *(if was_taken {
                    &mut self.taken
                } else {
                    &mut self.refused
                }) += 1;
                match (took > LONGEST, more > MEMORY) {
                    (true, _) => format!("takes {took:?}"),
                    (_, true) => format!("takes {} MiB", more >> 20),
                    _ => return,
                }
            }
            Err(_) => "panics".to_owned(),
        };
        let added = self.corpus.add_fault(bytes);
        panic!(
            "{} {wrong} at the last input of its corpus ({added:?}): {}",
            self.name,
            bytes.escape_ascii()
        );
    }
}

/// Gives a reader what the seed makes of these inputs and its corpus, and the inputs themselves. `read` says whether it
/// took the bytes.
///
/// # Panics
/// When the reader does, or an input takes too long or too much memory, or all inputs are refused or taken, which shows
/// nothing.
pub fn read_any_bytes(name: &str, good: &[Vec<u8>], read: impl Fn(&[u8]) -> bool) {
    assert!(!good.is_empty(), "{name}: there are no good inputs");
    let seconds = setting("COGNATE_FUZZ_SECONDS", 1);
    let corpus = Corpus::of(name);
    let mut inputs = Inputs {
        good: good.iter().cloned().chain(corpus.inputs()).collect(),
        dice: Dice(setting("COGNATE_FUZZ_SEED", 1)),
    };
    let mut trial = Trial {
        name,
        corpus,
        taken: 0,
        refused: 0,
    };
    let mut reach = Reach::default();
    for bytes in &inputs.good {
        trial.check(bytes, &read);
        reach.is_new();
    }
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(seconds) {
        let bytes = inputs.next();
        trial.check(&bytes, &read);
        if reach.is_new() {
            inputs.good.push(bytes);
        }
    }
    if coverage::is_counted() && std::env::var_os("COGNATE_FUZZ_KEEP").is_some() {
        let new_inputs = inputs.good.split_off(good.len());
        let mut reach = Reach::default();
        let mut reaches = |bytes: &[u8]| {
            trial.check(bytes, &read);
            reach.is_new()
        };
        for bytes in good {
            reaches(bytes);
        }
        let kept = corpus::shortest(new_inputs, &mut reaches);
        trial.corpus.keep(kept).expect("the corpus can be written");
    }
    let Trial { taken, refused, .. } = trial;
    println!(
        "{name}: {taken} inputs taken, {refused} refused{}",
        reach.words()
    );
    assert!(
        taken > 0 && refused > 0,
        "{name}: {taken} taken, {refused} refused"
    );
}
