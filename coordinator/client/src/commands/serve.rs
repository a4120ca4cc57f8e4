//! `cognate serve`: systems as lines of JSON on standard input, their answers as lines on standard output; for programs that
//! ask often, since a process costs more than a small system.

use super::{results, solve};
use crate::arguments::{ProgressForm, Solve};
use crate::error::{ClientError, Exit};
use crate::input_lines::{InputLine, read_lines};
use crate::interruption::unless_interrupted;
use crate::output;
use crate::output::progress::Progress;
use crate::remedy::misunderstood;
use clap::{Args, FromArgMatches};
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::mpsc::{Receiver, channel};

/// Longest line, in bytes; arguments name files, or hold equations.
const LONGEST: u64 = 1 << 26;
/// Lines that are read before their turn.
const LINES_AHEAD: usize = 64;

/// A line: what would be typed behind `cognate solve`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    /// Options and the file, or equations.
    arguments: Vec<String>,
    /// Given back with the answer, as it came.
    #[serde(default)]
    id: Value,
}

/// First fields of each answer and of each line of progress.
struct Label {
    /// Number of the line, from 1.
    line: u64,
    id: Value,
}

impl Label {
    /// An answer without its closing brace.
    fn opened(&self) -> String {
        let Self { line, id } = self;
        match id {
            Value::Null => format!("{{\"line\":{line}"),
            id => format!("{{\"line\":{line},\"id\":{id}"),
        }
    }
}

/// Answers line after line, until the input ends. The exit code is that of the worst answer.
pub async fn run() -> Result<Exit, ClientError> {
    let mut lines = lines_of_input();
    let mut command = solve_command();
    let mut worst = Exit::Solved;
    let mut number = 0;
    while let Some(line) = unless_interrupted(async { Ok(lines.recv().await) }).await? {
        number += 1;
        let content = match line {
            InputLine::Whole(content) if content.trim_ascii().is_empty() => continue,
            InputLine::Whole(content) => Some(content),
            InputLine::TooLong => None,
            InputLine::Broken(source) => {
                return Err(ClientError::File {
                    action: "cannot read",
                    path: "standard input".into(),
                    source,
                });
            }
        };
        let (label, asked) = read(number, content.as_deref());
        let (exit, answer) = match asked {
            Ok(arguments) => match answer(&label, &mut command, &arguments).await {
                Err(ClientError::Interrupted) => return Err(ClientError::Interrupted),
                Ok(answered) => answered,
                Err(error) => (error.exit(), refusal(&error)),
            },
            Err(error) => (error.exit(), refusal(&error)),
        };
        if exit as u8 > worst as u8 {
            worst = exit;
        }
        let code = exit as u8;
        output::print(&format!(
            "{},\"exit_code\":{code},{answer}}}\n",
            label.opened()
        ))?;
    }
    Ok(worst)
}

/// The lines of standard input, read by a thread of their own.
fn lines_of_input() -> Receiver<InputLine> {
    let (sender, receiver) = channel(LINES_AHEAD);
    // Not joined: it may wait for input for ever.
    std::thread::spawn(move || {
        let input = std::io::BufReader::new(std::io::stdin());
        read_lines(input, LONGEST, |line| sender.blocking_send(line).is_ok());
    });
    receiver
}

/// A line's label, and its arguments. `None` stands for a line that is too long.
fn read(line: u64, content: Option<&[u8]>) -> (Label, Result<Vec<String>, ClientError>) {
    let wrong = |message: String| {
        Err(ClientError::Input {
            origin: format!("line {line}"),
            message,
        })
    };
    let unlabelled = Label {
        line,
        id: Value::Null,
    };
    let Some(content) = content else {
        return (unlabelled, wrong(format!("has more than {LONGEST} bytes")));
    };
    let asked: Asked = match serde_json::from_slice(content) {
        Ok(asked) => asked,
        Err(error) => {
            let message = format!(
                "expected an object such as {{\"arguments\": [\"-e\", \"x^2 = 2\"], \"id\": 1}}: {error}"
            );
            return (unlabelled, wrong(message));
        }
    };
    let label = Label { line, id: asked.id };
    let is_input = |word: &String| word == "-" || word.ends_with("=-");
    if asked.arguments.iter().any(is_input) {
        return (
            label,
            wrong("standard input is for these lines; name a file".to_owned()),
        );
    }
    (label, Ok(asked.arguments))
}

/// The field of an answer that is an error, without braces.
pub fn refusal(error: &ClientError) -> String {
    format!("\"error\":{}", json!(error.to_string()))
}

/// The command `cognate solve` alone: to make all commands of the program takes longer than to solve a small system.
pub fn solve_command() -> clap::Command {
    let name = "cognate solve";
    Solve::augment_args(clap::Command::new(name).bin_name(name)).no_binary_name(true)
}

/// The solve that the arguments of a line ask for.
///
/// # Errors
/// When the arguments are not those of `cognate solve`, or ask for a page.
pub fn asked_solve(
    command: &mut clap::Command,
    arguments: &[String],
) -> Result<Solve, ClientError> {
    let matches = command.try_get_matches_from_mut(arguments);
    let asked = matches
        .and_then(|matches| Solve::from_arg_matches(&matches))
        .map_err(|refused| misunderstood(&refused, &["cognate", "solve"], arguments))?;
    refuse_page(&asked)?;
    Ok(asked)
}

/// The exit code that `cognate solve` would end with, and the fields of an answer, without braces.
pub fn fields(answer: &results::Answer) -> Result<(Exit, String), ClientError> {
    let counts: Value = serde_json::from_str(answer.json())
        .map_err(|e| ClientError::GaveUp(format!("its summary is not JSON: {e}")))?;
    let solutions: Vec<String> = answer.rows.iter().map(|row| row.line()).collect();
    let solutions: Vec<&str> = solutions.iter().map(|line| line.trim_end()).collect();
    let fields = format!(
        "\"summary\":{counts},\"solutions\":[{}]",
        solutions.join(",")
    );
    Ok((answer.exit(), fields))
}

/// Solves what a line asks; gives the exit code that `cognate solve` would end with, and the rest of the answer.
async fn answer(
    label: &Label,
    command: &mut clap::Command,
    arguments: &[String],
) -> Result<(Exit, String), ClientError> {
    let asked = asked_solve(command, arguments)?;
    fields(&solve::answer(&asked, progress(&asked, label)).await?)
}

/// Refuses a page for browsers, which would stay until the command is interrupted.
fn refuse_page(asked: &Solve) -> Result<(), ClientError> {
    match &asked.page {
        None => Ok(()),
        Some(_) => Err(ClientError::Input {
            origin: "--page".into(),
            message: "is for `cognate solve`".into(),
        }),
    }
}

/// Lines of progress between the answers, where `--progress json` asks for them.
fn progress(asked: &Solve, label: &Label) -> Progress {
    if asked.progress.progress != ProgressForm::Json {
        return Progress::silent();
    }
    let opened = label.opened();
    Progress::told(move |standing| {
        // That nobody reads any more shows when the answer is written.
        let _ = output::print(&format!("{opened},\"progress\":{standing}}}\n"));
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(line: &str) -> String {
        let (_, asked) = read(3, Some(line.as_bytes()));
        asked.expect_err("a mistake").to_string()
    }

    #[test]
    fn a_line_has_arguments_and_a_label_that_is_given_back() {
        let (label, asked) = read(2, Some(br#"{"arguments": ["-e", "x = 1"], "id": "a"}"#));
        assert_eq!(asked.expect("arguments"), ["-e", "x = 1"]);
        assert_eq!(label.opened(), r#"{"line":2,"id":"a""#);
        let (label, _) = read(1, Some(br#"{"arguments": []}"#));
        assert_eq!(label.opened(), r#"{"line":1"#);
    }

    #[test]
    fn what_is_no_request_is_refused_with_its_line() {
        assert!(refused("nonsense").starts_with("line 3: expected an object"));
        assert!(refused(r#"{"arguments": ["-"]}"#).contains("standard input"));
        assert!(refused(r#"{"arguments": ["f", "--targets=-"]}"#).contains("standard input"));
        assert!(refused(r#"{"argument": []}"#).contains("unknown field"));
        let (_, asked) = read(1, None);
        assert!(asked.expect_err("too long").to_string().contains("bytes"));
    }
}
