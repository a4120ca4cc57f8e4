//! Other words: options and commands of other programs in the words of this one, and equations without quotation marks.

use cognate_systems::formats;
use std::path::Path;

/// Options of other programs, each with the words that say the same here; none where nothing has to be said.
const OPTIONS: [(&str, &[&str]); 20] = [
    ("--json", &["--format", "json"]),
    ("--jsonl", &["--format", "jsonl"]),
    ("--csv", &["--format", "csv"]),
    ("-f", &["--format"]),
    ("-o", &["--output"]),
    ("-j", &["--threads"]),
    ("--jobs", &["--threads"]),
    ("--parameters", &["--targets"]),
    ("--parameter", &["--targets"]),
    ("--params", &["--targets"]),
    ("--param", &["--targets"]),
    ("-p", &["--targets"]),
    ("--set", &["--targets"]),
    ("--values", &["--targets"]),
    ("--target", &["--pose"]),
    ("-v", &[]),
    ("--verbose", &[]),
    ("-q", &[]),
    ("--quiet", &[]),
    ("--equations", &["--equation"]),
];

/// Commands of other programs.
const COMMANDS: [(&str, &str); 4] = [
    ("ik", "inverse"),
    ("fk", "forward"),
    ("dk", "forward"),
    ("factor", "decompose"),
];

/// The words of this program for an option of others; `None` where none is like it.
pub fn option_of_others(option: &str) -> Option<&'static [&'static str]> {
    let listed = OPTIONS.iter().find(|(other, _)| *other == option);
    listed.map(|(_, words)| *words)
}

/// The command of this program for one of others; the same where none is like it.
pub fn command_of_others(command: &str) -> &str {
    let listed = COMMANDS.iter().find(|(other, _)| *other == command);
    listed.map_or(command, |(_, name)| *name)
}

/// The equations of words behind a command that no quotation marks hold together, and the options behind them; `None`
/// where they are none.
pub fn loose_equations(words: &[String]) -> Option<(Vec<String>, &[String])> {
    let end = words.iter().position(|word| word.starts_with("--"));
    let (words, options) = words.split_at(end.unwrap_or(words.len()));
    let mut equations: Vec<String> = Vec::new();
    let mut begins = true;
    for word in words {
        if word == "-e" {
            begins = true;
            continue;
        }
        let is_file = Path::new(word).is_file();
        let last = equations.last_mut().filter(|_| !begins);
        match last {
            _ if is_file => return None,
            Some(last) if !(last.contains('=') && word.trim_matches('=').contains('=')) => {
                last.push(' ');
                last.push_str(word);
            }
            _ => equations.push(word.clone()),
        }
        begins = false;
    }
    let text = equations.join("\n");
    let is_read = text.contains('=') && formats::plain::typed("-e", &text).is_ok();
    is_read.then_some((equations, options))
}

/// A condition with the signs of other programs in the words of this one.
pub fn condition_of_others(text: &str) -> String {
    let signs = [
        ("&&", " and "),
        ("&", " and "),
        ("||", " or "),
        ("|", " or "),
        ("=>", ">="),
        ("=<", "<="),
        ("<>", "!="),
    ];
    let text = signs.iter().fold(text.to_owned(), |text, (other, sign)| {
        text.replace(other, sign)
    });
    text.split_whitespace().collect::<Vec<&str>>().join(" ")
}
