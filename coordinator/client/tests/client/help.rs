//! The text of `--help`: lines that fit a terminal, the file before the options, an example.

use super::program::text;
use std::process::Command;

/// The help of a command in a terminal of 80 columns.
fn help(words: &[String]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    command.args(words).arg("--help").env("COLUMNS", "80");
    text(&command.output().expect("the program starts").stdout)
}

/// The subcommands that a help lists.
fn subcommands(help: &str) -> Vec<String> {
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let listed = listed.take_while(|line| !line.is_empty());
    let names = listed.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.filter_map(|line| line.split_whitespace().next());
    names
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

/// All commands, each with its help.
fn commands() -> Vec<(Vec<String>, String)> {
    let mut open = vec![vec![]];
    let mut all_commands = Vec::new();
    while let Some(words) = open.pop() {
        let help = help(&words);
        open.extend(
            subcommands(&help)
                .into_iter()
                .map(|name| [words.clone(), vec![name]].concat()),
        );
        all_commands.push((words, help));
    }
    all_commands
}

/// Whether a line is one that is never broken: the usage, or an option with its value.
fn is_whole(line: &str) -> bool {
    line.starts_with("Usage: ") || line.trim_start().starts_with("--")
}

#[test]
fn every_help_fits_a_terminal() {
    let commands = commands();
    assert!(commands.len() > 40, "{}", commands.len());
    let mut wide = Vec::new();
    for (words, help) in &commands {
        assert!(help.contains("Usage: cognate"), "{words:?}");
        let lines = help
            .lines()
            .filter(|line| line.chars().count() > 80 && !is_whole(line));
        wide.extend(lines.map(|line| format!("{}: {line}", words.join(" "))));
    }
    assert!(wide.is_empty(), "{}", wide.join("\n"));
}

#[test]
fn every_command_shows_an_example_and_its_file_first() {
    for (words, help) in commands() {
        let example = format!("  cognate {}", words.join(" "));
        let is_group = help.contains("\nCommands:\n");
        assert!(is_group || help.contains(&example), "{words:?}:\n{help}");
        // A line to type is not broken by the terminal: its rest would stand at the margin.
        let examples = help.lines().skip_while(|line| *line != "Examples:");
        let mut examples = examples.skip(1).take_while(|line| !line.is_empty());
        assert!(examples.all(|line| line.starts_with("  ")), "{help}");
        let file = help.find("\nArguments:\n");
        let options = help.find("\nOptions:\n");
        assert!(
            file.is_none_or(|file| options.is_some_and(|options| file < options)),
            "{words:?}"
        );
        let is_taken = help
            .lines()
            .any(|line| line.starts_with("Usage:") && line.contains("FILE"));
        assert!(
            !is_taken || is_group || file.is_some(),
            "{words:?}:\n{help}"
        );
    }
}
