//! `cognate completions`, `cognate man`: what shells and manuals know of the commands.

use crate::arguments::{Arguments, Completions, Manual};
use crate::error::{ClientError, Exit};
use crate::output;
use clap::CommandFactory;
use std::path::Path;

/// Prints the script of a shell.
pub fn completions(a: &Completions) -> Result<Exit, ClientError> {
    let mut script = Vec::new();
    clap_complete::generate(a.shell, &mut Arguments::command(), "cognate", &mut script);
    output::print(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Solved)
}

/// Prints the manual page, or writes those of all commands into a folder.
pub fn manual(a: &Manual) -> Result<Exit, ClientError> {
    let command = Arguments::command();
    match &a.output {
        None => {
            let page = page(command).map_err(|e| ClientError::Local(e.to_string()))?;
            output::print(&page)?;
        }
        Some(folder) => {
            let failed = |path: &Path, source| ClientError::File {
                action: "cannot write",
                path: path.to_owned(),
                source,
            };
            std::fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
            for (name, command) in named(command, "cognate") {
                let path = folder.join(format!("{name}.1"));
                let written = page(command).and_then(|page| std::fs::write(&path, page));
                written.map_err(|e| failed(&path, e))?;
            }
        }
    }
    Ok(Exit::Solved)
}

/// A command and all below it, each by the name of its page.
fn named(mut command: clap::Command, name: &str) -> Vec<(String, clap::Command)> {
    // Builds the tree: what commands inherit is in their pages.
    command.build();
    let below: Vec<clap::Command> = command.get_subcommands().cloned().collect();
    // The command ends when its pages are written; clap wants names that last as long.
    let lasting: &'static str = name.to_owned().leak();
    let command_page = command.name(lasting).disable_help_subcommand(true);
    let mut pages = vec![(name.to_owned(), command_page)];
    for below in below.into_iter().filter(|below| below.get_name() != "help") {
        let name = format!("{name}-{}", below.get_name());
        pages.extend(named(below, &name));
    }
    pages
}

/// A manual page.
fn page(command: clap::Command) -> std::io::Result<String> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page)?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page() {
        let pages = named(Arguments::command(), "cognate");
        let names: Vec<&str> = pages.iter().map(|(name, _)| name.as_str()).collect();
        for name in [
            "cognate",
            "cognate-solve",
            "cognate-mechanism-inverse",
            "cognate-fleet-slurm",
        ] {
            assert!(names.contains(&name), "{name}: {names:?}");
        }
        for (name, command) in pages {
            let page = page(command).unwrap();
            assert!(
                page.contains(".SH NAME") && page.contains(".SH SYNOPSIS"),
                "{name}"
            );
        }
    }

    #[test]
    fn shells_complete_commands_and_options() {
        for shell in [
            clap_complete::Shell::Bash,
            clap_complete::Shell::Zsh,
            clap_complete::Shell::Fish,
        ] {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "cognate", &mut script);
            let script = String::from_utf8(script).unwrap();
            for word in ["decompose", "real-curve", "certify", "coordinator"] {
                assert!(script.contains(word), "{shell}: {word}");
            }
        }
    }
}
