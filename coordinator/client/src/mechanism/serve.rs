//! A stream of targets: a line of JSON in, a line of JSON out, in the same order, until the input ends.
//!
//! Lines that have arrived are answered as soon as no more are waiting, so that one line is answered at once and many
//! are answered side by side. At most one round of lines is held.

use crate::input_lines::{InputLine, read_lines};
use cognate_kinematics::compile::Target;
use cognate_kinematics::mechanism::MechanismError;
use cognate_kinematics::mechanism::line::{Line, LineId};
use cognate_kinematics::mechanism::pose::ReadPose;
use cognate_kinematics::mechanism::targets::PoseForm;
use cognate_mechanism_solver::postures::Postures;
use cognate_mechanism_solver::prepared_mechanism::{PreparedMechanism, ROUND};
use serde_json::{Value, json};
use std::io::{BufRead, Write};
use std::sync::mpsc::{Receiver, RecvError, sync_channel};

/// Longest line, in bytes; a target has a few hundred.
const LONGEST: u64 = 1 << 20;

/// How lines are read.
#[derive(Clone, Debug)]
pub enum LineKind {
    /// Poses of the output.
    Poses(PoseForm),
    /// Values of inputs.
    Inputs {
        /// Names of the inputs, each with whether the input is an angle.
        names: Vec<(String, bool)>,
        /// Whether angles without a unit are degrees; else radians.
        degrees: bool,
    },
}

/// Counts of a stream that has ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Served {
    /// Lines that were answered.
    pub answered: u64,
    /// Answers in which something is in doubt.
    pub unsettled: u64,
    /// Lines that were no target.
    pub refused: u64,
}

/// A line that was read: its target, or an error.
struct Asked {
    number: u64,
    id: Option<LineId>,
    target: Result<Target, MechanismError>,
    /// Warning for the user about how the target was read.
    warning: Option<String>,
}

/// Answers all lines. `shown` makes the JSON of an answer.
pub fn serve(
    prepared: &PreparedMechanism<'_>,
    kind: &LineKind,
    input: impl BufRead + Send + 'static,
    output: &mut impl Write,
    shown: &dyn Fn(u64, &Postures) -> Value,
) -> std::io::Result<Served> {
    let (sender, receiver) = sync_channel(ROUND);
    // Not joined: where the output has gone, the thread may wait for input for ever.
    std::thread::spawn(move || read_lines(input, LONGEST, |line| sender.send(line).is_ok()));
    let mut served = Served::default();
    let mut number = 0;
    while let Ok(lines) = round(&receiver) {
        let mut asked = Vec::new();
        let mut broken = None;
        for line in lines {
            number += 1;
            match line {
                InputLine::Broken(error) => broken = Some(error),
                InputLine::Whole(content) if content.trim_ascii().is_empty() => {}
                line => asked.push(read(number, &line, kind)),
            }
        }
        let answers = answers(prepared, &mut asked);
        let mut answers = answers.into_iter();
        for line in asked {
            let answer = match &line.target {
                Ok(_) => answers.next(),
                Err(_) => None,
            };
            let value = match (&line.target, answer) {
                (Ok(_), Some(mut answer)) => {
                    answer.warnings.extend(line.warning.clone());
                    served.answered += 1;
                    served.unsettled += u64::from(!answer.settled);
                    with_id(shown(line.number, &answer), line.id.as_ref())
                }
                (Err(error), _) => {
                    served.refused += 1;
                    with_id(refusal(line.number, error), line.id.as_ref())
                }
                (Ok(_), None) => unreachable!("each target that is solved has its answer"),
            };
            writeln!(output, "{value}")?;
        }
        output.flush()?;
        if let Some(error) = broken {
            return Err(error);
        }
    }
    Ok(served)
}

/// Waits for a line, and takes those that are there besides.
fn round(receiver: &Receiver<InputLine>) -> Result<Vec<InputLine>, RecvError> {
    let mut lines = vec![receiver.recv()?];
    while lines.len() < ROUND {
        match receiver.try_recv() {
            Ok(line) => lines.push(line),
            Err(_) => break,
        }
    }
    Ok(lines)
}

fn read(number: u64, line: &InputLine, kind: &LineKind) -> Asked {
    let wrong = |mut error: MechanismError| {
        error.line = usize::try_from(number).ok();
        error
    };
    let InputLine::Whole(content) = line else {
        let message = format!("a line of more than {LONGEST} bytes");
        return Asked {
            number,
            id: None,
            target: Err(wrong(MechanismError::of_file("input", message))),
            warning: None,
        };
    };
    let mut warning = None;
    let (id, target) = match Line::read("input", content) {
        Err(error) => (None, Err(error)),
        Ok(line) => {
            let target = match kind {
                LineKind::Poses(form) => {
                    let read = line.pose(*form);
                    let poses = read.as_ref().map(std::slice::from_ref);
                    warning = poses.ok().and_then(ReadPose::warning);
                    read.map(|read| Target::Pose(read.pose))
                }
                LineKind::Inputs { names, degrees } => {
                    line.inputs(names, *degrees).map(Target::Inputs)
                }
            };
            (line.id.clone(), target)
        }
    };
    Asked {
        number,
        id,
        target: target.map_err(wrong),
        warning,
    }
}

/// The answers of all that are targets; where one of them cannot be solved, its line says why.
fn answers(prepared: &PreparedMechanism<'_>, asked: &mut [Asked]) -> Vec<Postures> {
    let targets: Vec<Target> = asked
        .iter()
        .filter_map(|line| line.target.as_ref().ok().cloned())
        .collect();
    if let Ok(answers) = prepared.solve(&targets) {
        return answers;
    }
    // One of them is at fault: each by itself.
    let mut postures = Vec::new();
    for line in asked {
        let Ok(target) = &line.target else { continue };
        match prepared.solve(std::slice::from_ref(target)) {
            Ok(answers) => postures.extend(answers),
            Err(error) => {
                line.target = Err(MechanismError {
                    line: usize::try_from(line.number).ok(),
                    ..error
                });
            }
        }
    }
    postures
}

fn refusal(number: u64, error: &MechanismError) -> Value {
    json!({
        "error": error.message,
        "line": number,
        "field": (!error.field.is_empty()).then_some(&error.field),
    })
}

/// An answer with the id of its line.
fn with_id(mut value: Value, id: Option<&LineId>) -> Value {
    let id = match id {
        None => return value,
        Some(LineId::Text(text)) => json!(text),
        // As it came; a number that would come back in other digits goes as text.
        Some(LineId::Number(text)) => serde_json::from_str(text)
            .ok()
            .filter(|number: &Value| format!("{number}") == *text)
            .unwrap_or_else(|| json!(text)),
    };
    value["id"] = id;
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_kinematics::compile::{Problem, Question};
    use cognate_kinematics::mechanism::{ReadOptions, read};
    use cognate_mechanism_solver::preparation::AnswerOptions;

    const ARM: &[u8] = br#"{"angles": "rad", "serial": {"joints": [
        {"name": "q1", "a": 0.1, "d": 0.2}, {"name": "q2", "a": 0.3, "alpha": 0.4}]}}"#;

    /// Forward kinematics of an open chain needs no solving: checks the answers and their order.
    fn run(lines: &str) -> (Vec<Value>, Served) {
        let mechanism = read("arm.json", ARM, &ReadOptions::default()).unwrap();
        let question = Question::of(Problem::Forward);
        let options = AnswerOptions::default();
        let prepared = PreparedMechanism::new(&mechanism, &question, &options).unwrap();
        let names = ["q1", "q2"].map(|name| (name.to_owned(), true)).to_vec();
        let kind = LineKind::Inputs {
            names,
            degrees: false,
        };
        let input = std::io::Cursor::new(lines.to_owned().into_bytes());
        let mut output = Vec::new();
        let shown = |number: u64, answer: &Postures| json!({"line": number, "complex": answer.counts.complex});
        let served = serve(&prepared, &kind, input, &mut output, &shown).unwrap();
        let text = String::from_utf8(output).unwrap();
        let values = text.lines().map(|l| serde_json::from_str(l).unwrap());
        (values.collect(), served)
    }

    #[test]
    fn each_line_has_its_answer_and_bad_ones_an_error() {
        let long = "x".repeat(LONGEST as usize + 5);
        let lines = format!(
            "{{\"q1\": 0.1, \"q2\": 0.2, \"id\": \"first\"}}\n\nnonsense\n{{\"q1\": 0.1, \"q2\": \"a\", \"id\": 7}}\n\
             {long}\n{{\"q1\": 0.1, \"q3\": 1}}\n{{\"q1\": 1, \"q2\": 2}}"
        );
        let (values, served) = run(&lines);
        assert_eq!(
            served,
            Served {
                answered: 2,
                unsettled: 0,
                refused: 4
            }
        );
        assert_eq!(values.len(), 6, "{values:?}");
        assert_eq!(values[0], json!({"line": 1, "complex": 1, "id": "first"}));
        assert_eq!(values[1]["line"], 3);
        assert_eq!(
            (&values[2]["id"], &values[2]["field"]),
            (&json!(7), &json!("q2"))
        );
        assert!(values[3]["error"].as_str().unwrap().contains("more than"));
        assert!(values[4]["error"].as_str().unwrap().contains("q2"));
        assert_eq!(values[5], json!({"line": 7, "complex": 1}));
    }

    #[test]
    fn many_lines_keep_their_order() {
        let lines: String = (0..3000)
            .map(|k| format!("{{\"q1\": 0.{k}, \"q2\": 1, \"id\": {k}}}\n"))
            .collect();
        let (values, served) = run(&lines);
        assert_eq!(served.answered, 3000);
        let ids: Vec<u64> = values.iter().map(|v| v["id"].as_u64().unwrap()).collect();
        assert!(ids.into_iter().eq(0..3000));
    }
}
