//! A stream of targets on standard input, their answers on standard output.

use super::read::{Read, described, options, some, wrong};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismServe;
use crate::mechanism::serve::{LineKind, serve};
use crate::output::mechanisms::{View, json};
use cognate_kinematics::compile::{Problem, Question};
use cognate_mechanism_solver::preparation::AnswerOptions;
use cognate_mechanism_solver::prepared_mechanism::PreparedMechanism;
use std::io::{BufRead, Write};

/// `cognate mechanism serve`.
pub fn run(a: &MechanismServe) -> Result<Exit, ClientError> {
    if a.mechanism.file.as_os_str() == "-" {
        return Err(wrong(
            "-",
            "standard input is for targets; give the mechanism as a file",
        ));
    }
    let read = Read::of(&a.mechanism)?;
    let (question, options) = asked(a, &read)?;
    let prepared =
        PreparedMechanism::new(&read.mechanism, &question, &options).map_err(|e| described(&e))?;
    for warning in &prepared.preparation().warnings {
        eprintln!("warning: {warning}");
    }
    let input = std::io::BufReader::new(std::io::stdin());
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    match answer_lines(a, &read, &prepared, input, &mut out) {
        Ok(exit) => Ok(exit),
        // The reader has gone: nobody waits for more.
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(Exit::Solved),
        Err(source) => Err(ClientError::File {
            action: "cannot read or write",
            path: "standard input or output".into(),
            source,
        }),
    }
}

/// Forward or inverse kinematics.
fn problem(a: &MechanismServe) -> Problem {
    if a.forward {
        Problem::Forward
    } else {
        Problem::Inverse
    }
}

/// The question to a mechanism, and how it is answered.
pub fn asked(a: &MechanismServe, read: &Read) -> Result<(Question, AnswerOptions), ClientError> {
    let question = Question {
        problem: problem(a),
        inputs: some(&a.input),
        locks: read.locks(&a.mechanism)?,
        task: a.task.task,
    };
    let options = AnswerOptions {
        near: read.near(a.near.as_deref(), read.degrees(&a.mechanism))?,
        ..options(&a.solving)
    };
    Ok((question, options))
}

/// Answers lines of targets; gives the exit code of the worst answer.
pub fn answer_lines(
    a: &MechanismServe,
    read: &Read,
    prepared: &PreparedMechanism<'_>,
    input: impl BufRead + Send + 'static,
    output: &mut impl Write,
) -> std::io::Result<Exit> {
    let preparation = prepared.preparation();
    let degrees = read.degrees(&a.mechanism);
    let kind = if a.forward {
        LineKind::Inputs {
            names: read.mechanism.kinds(&preparation.inputs),
            degrees,
        }
    } else {
        LineKind::Poses(read.form(a.task.task, degrees))
    };
    let view = View {
        mechanism: &read.mechanism,
        problem: problem(a),
        preparation,
        degrees,
        only_within_limits: a.within_limits,
        complex: a.complex,
    };
    let shown = |line: u64, answer: &_| json::line(&view, line, answer);
    let served = serve(prepared, &kind, input, output, &shown)?;
    Ok(match (served.refused, served.unsettled) {
        (0, 0) if preparation.settled => Exit::Solved,
        (0, _) => Exit::Unsettled,
        _ => Exit::BadInput,
    })
}
