//! The command line for terminals and shells: `top`, `completions`, `man`.

use crate::common_arguments::ServiceArguments;
use clap::Args;
use std::path::PathBuf;

/// `cognate top`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate top
  cognate top --once --coordinator http://head:7654")]
pub struct Top {
    /// Seconds between two looks
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0, value_parser = pause)]
    pub every: f64,
    /// Print once and end, as where standard output is no terminal
    #[arg(long)]
    pub once: bool,
    /// The coordinator that is asked.
    #[command(flatten)]
    pub service: ServiceArguments,
}

/// A pause between two looks, as typed.
fn pause(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.1..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("expected seconds from 0.1 to 3600".to_owned()),
    }
}

/// `cognate completions`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate completions bash > ~/.local/share/bash-completion/completions/cognate
  cognate completions zsh > ~/.zfunc/_cognate   with fpath+=~/.zfunc
  cognate completions fish > ~/.config/fish/completions/cognate.fish")]
pub struct Completions {
    /// The shell
    pub shell: clap_complete::Shell,
}

/// `cognate man`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate man | man -l -
  cognate man --output ~/.local/share/man/man1 && man cognate-solve")]
pub struct Manual {
    /// Write a page for every command here, instead of printing that of `cognate`
    #[arg(long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}
