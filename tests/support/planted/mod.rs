//! Planted systems: random ones whose exact answer is known because they were built from it.
//!
//! Each is drawn from a seed and a number. Its roots are multiple, huge, tiny, nearly double, at
//! infinity or on a positive-dimensional set; [`kinds`] builds them, [`verdict`] solves one and
//! compares. A count that is wrong and called settled is a silent error.

pub mod fractions;
pub mod kinds;
pub mod linear;
pub mod lines;
pub mod polynomial;
pub mod verdict;

use cognate_numeric::rational::{ComplexRational, Rational};
use num_complex::Complex64;
use std::fmt::Write;

/// An isolated solution.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Root {
    /// Coordinates of the root, without error.
    pub point: Vec<ComplexRational>,
    /// Intersection multiplicity of the root.
    pub multiplicity: u64,
}

/// A rational number as the nearest double.
fn nearest(value: &Rational) -> f64 {
    value.to_f64()
}

impl Root {
    /// The nearest doubles.
    pub fn rounded(&self) -> Vec<Complex64> {
        let coordinates = self.point.iter();
        coordinates
            .map(|z| Complex64::new(nearest(&z.re), nearest(&z.im)))
            .collect()
    }

    /// Whether every coordinate is real.
    pub fn is_real(&self) -> bool {
        self.point.iter().all(ComplexRational::is_real)
    }
}

/// A system and its exact answer.
#[derive(Clone, Debug)]
pub struct Planted {
    /// How it was built.
    pub kind: &'static str,
    /// Names of its variables.
    pub variables: Vec<String>,
    /// Equations of the system, as text.
    pub equations: Vec<String>,
    /// All isolated solutions, no two the same.
    pub roots: Vec<Root>,
    /// Whether it has solutions that are not isolated.
    pub on_a_set: bool,
    /// Whether multiplicities are those of the system itself, not of a combination of its equations.
    pub square: bool,
}

impl Planted {
    /// The sum of all multiplicities.
    pub fn with_multiplicity(&self) -> u64 {
        self.roots.iter().map(|root| root.multiplicity).sum()
    }

    /// Isolated solutions of multiplicity 1.
    pub fn nonsingular(&self) -> u64 {
        let simple = self.roots.iter().filter(|root| root.multiplicity == 1);
        simple.count() as u64
    }

    /// Isolated solutions with real coordinates only.
    pub fn real(&self) -> u64 {
        self.roots.iter().filter(|root| root.is_real()).count() as u64
    }

    /// The exact answer in one line.
    pub fn answer(&self) -> String {
        format!(
            "distinct {}, nonsingular {}, with multiplicity {}, real {}, positive-dimensional {}",
            self.roots.len(),
            self.nonsingular(),
            self.with_multiplicity(),
            self.real(),
            self.on_a_set
        )
    }

    /// The system in the notation of Bertini-classic, the answer in its first line.
    pub fn file(&self, note: &str) -> String {
        let mut text = format!("% expected: {}; {}{note}\n", self.answer(), self.kind);
        for root in self.roots.iter().take(24) {
            let values: Vec<String> = self
                .variables
                .iter()
                .zip(root.rounded())
                .map(written)
                .collect();
            writeln!(text, "% {} times {}", root.multiplicity, values.join(", ")).expect("text");
        }
        let names: Vec<String> = (1..=self.equations.len())
            .map(|k| format!("f{k}"))
            .collect();
        let equations = names.iter().zip(&self.equations);
        let equations: Vec<String> = equations.map(|(f, e)| format!("{f} = {e};")).collect();
        writeln!(
            text,
            "CONFIG\nEND;\nINPUT\nvariable_group {};\nfunction {};\n{}\nEND;",
            self.variables.join(", "),
            names.join(", "),
            equations.join("\n")
        )
        .expect("text");
        text
    }
}

fn written((name, z): (&String, Complex64)) -> String {
    match z.im == 0.0 {
        true => format!("{name} = {:e}", z.re),
        false => format!("{name} = {:e}{:+e}i", z.re, z.im),
    }
}
