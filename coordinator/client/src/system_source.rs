//! SystemSource: where a system comes from, a file or equations that are typed.

use super::error::ClientError;
use super::problem::{self, described};
use clap::Args;
use cognate_systems::formats;
use std::path::PathBuf;

/// The name of typed equations in messages.
const TYPED: &str = "-e";

/// A file, or equations that are typed.
#[derive(Clone, Debug, Default, Args)]
#[group(required = true, multiple = false)]
pub struct SystemSource {
    /// A system: equations, one a line, Bertini-classic input, PHCpack format, JSON, Macaulay2, Maple, Singular or msolve, told
    /// apart by content; - is standard input
    pub file: Option<PathBuf>,
    /// An equation, instead of a file; once for each: -e "x^2 + y^2 = 1" -e "x = y"
    #[arg(
        short = 'e',
        long = "equation",
        value_name = "EQUATION",
        allow_hyphen_values = true
    )]
    pub equation: Vec<String>,
}

impl SystemSource {
    /// Reads the system, and puts these groups in the place of its own.
    pub fn read(&self, groups: Option<&str>) -> Result<formats::Problem, ClientError> {
        if let Some(file) = &self.file {
            return problem::read_system(file, groups);
        }
        let text = self.equation.join("\n");
        let mut typed = formats::plain::typed(TYPED, &text).map_err(|e| described(&e))?;
        if let Some(groups) = groups {
            formats::options::groups(groups, &mut typed.system).map_err(|e| described(&e))?;
        }
        Ok(typed)
    }

    /// The file's name without its folders.
    pub fn short_name(&self) -> String {
        match &self.file {
            Some(file) => problem::short_name(file),
            None => "equations".into(),
        }
    }
}
