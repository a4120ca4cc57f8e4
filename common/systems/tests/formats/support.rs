//! Shared by the tests of the formats: files, seeded numbers, exact values.

use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::exact;
use cognate_systems::formats::{self, Problem};
use cognate_systems::system::System;
use std::path::PathBuf;

/// Reads a problem or fails with its message.
pub fn read(text: &str) -> Problem {
    match formats::read("test", text.as_bytes()) {
        Ok(problem) => problem,
        Err(e) => panic!("{e}\n{text}"),
    }
}

/// The message of a problem that must be refused.
pub fn refused(text: &str) -> String {
    match formats::read("test", text.as_bytes()) {
        Ok(_) => panic!("accepted: {text}"),
        Err(e) => e.to_string(),
    }
}

/// A real rational number.
pub fn rational(numerator: i64, denominator: i64) -> ComplexRational {
    ComplexRational::real(Rational::from((numerator, denominator)))
}

/// The values of a system's equations at a point.
pub fn values(
    system: &System,
    variables: &[ComplexRational],
    parameters: &[ComplexRational],
) -> Vec<ComplexRational> {
    exact::values(
        &system.expressions,
        &system.equations,
        variables,
        parameters,
    )
    .into_iter()
    .map(|v| v.expect("a rational value"))
    .collect()
}

/// The folder of the test systems.
pub fn systems() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/systems"))
}

/// Names of the test systems, in order.
pub fn system_names() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(systems())
        .expect("the test systems")
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .into_string()
                .expect("a name")
        })
        .collect();
    names.sort();
    names
}

/// A generator of numbers that are the same on every machine: SplitMix64 of Steele, Lea and
/// Flood (OOPSLA 2014).
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// A complex rational with small parts.
    pub fn complex(&mut self) -> ComplexRational {
        let mut part = || Rational::from((self.below(201) as i64 - 100, self.below(30) as i64 + 1));
        ComplexRational::new(part(), part())
    }

    /// A point.
    pub fn point(&mut self, dimension: usize) -> Vec<ComplexRational> {
        (0..dimension).map(|_| self.complex()).collect()
    }
}
