//! SystemSource: where a system comes from, a file or equations that are typed.

use clap::Args;
use std::path::PathBuf;

/// A file, or equations that are typed.
#[derive(Clone, Debug, Default, Args)]
#[group(required = true, multiple = false)]
pub struct SystemSource {
    /// A system: equations, one a line, Bertini-classic input, PHCpack format, JSON, Macaulay2, Maple, Singular or msolve, told
    /// apart by content; - is standard input
    #[arg(help_heading = None)]
    pub file: Option<PathBuf>,
    /// An equation, instead of a file; once for each: -e "x^2 + y^2 = 1" -e "x = y"
    #[arg(
        short = 'e',
        long = "equation",
        value_name = "EQUATION",
        allow_hyphen_values = true
    )]
    pub equation: Vec<String>,
    /// The content of a file, from a program that holds it in memory.
    #[arg(skip)]
    pub content: Option<Vec<u8>>,
}
