//! Subjects: systems whose number of solutions is published, as a client submits them.

use crate::client::Submission;
use cognate_protocol::v1::SummaryCounts;
use cognate_systems::formats::{self, FileSettings, Format};
use cognate_systems::named::Named;
use cognate_systems::system::System;

/// The sum of all classes of paths: their total, where none is missing.
pub fn paths_in_classes(counts: &SummaryCounts) -> u64 {
    counts.paths_finite
        + counts.paths_singular
        + counts.paths_positive_dimensional.unwrap_or(0)
        + counts.paths_undecided
        + counts.paths_within_data_accuracy
        + counts.paths_excess.unwrap_or(0)
        + counts.paths_at_infinity
        + counts.paths_failed
}

/// A system and how many solutions it has.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Name of the system in tables.
    pub name: &'static str,
    /// The system in Bertini's notation.
    pub text: String,
    /// Number of nonsingular solutions.
    pub solutions: u64,
}

impl Subject {
    /// A system with this number of nonsingular solutions.
    ///
    /// # Panics
    /// When it cannot be written.
    pub fn new(name: &'static str, system: &System, solutions: u64) -> Self {
        let text = formats::write(Format::Bertini, system, &FileSettings::default());
        Self {
            name,
            text: text.expect("systems of our own can be written"),
            solutions,
        }
    }

    /// A classical system.
    ///
    /// # Panics
    /// When its count is not published.
    pub fn named(name: &'static str, named: &Named) -> Self {
        let solutions = named.finite_solutions.expect("its count is published");
        Self::new(name, &named.system, solutions)
    }

    /// `n` quartics in as many unknowns with 4^n solutions: at infinity only the fourth powers
    /// count, so that nothing is lost of Bézout's number.
    pub fn quartics(n: usize) -> Self {
        let names = |letter: &str| {
            let names = (1..=n).map(|i| format!("{letter}{i}"));
            names.collect::<Vec<_>>().join(", ")
        };
        let equation = |i: usize| {
            let (j, a, b) = (i % n + 1, 2 * i + 1, 3 * i + 2);
            format!("f{i} = x{i}^4 + {a}*x{i}*x{j} - {b};\n")
        };
        let equations: String = (1..=n).map(equation).collect();
        let (x, f) = (names("x"), names("f"));
        Self {
            name: "quartics",
            text: format!(
                "CONFIG\nEND;\nINPUT\nvariable_group {x};\nfunction {f};\n{equations}END;\n"
            ),
            solutions: 4_u64.pow(n as u32),
        }
    }

    /// To be solved with this seed.
    pub fn submission(&self, seed: u64) -> Submission {
        let mut submission = Submission::of(self.text.clone());
        submission.options.seed = Some(seed);
        submission
    }

    /// Whether all solutions were found and every path is in one class.
    pub fn is_right(&self, counts: &SummaryCounts) -> bool {
        counts.solutions_nonsingular == self.solutions
            && paths_in_classes(counts) == counts.paths_total
    }
}
