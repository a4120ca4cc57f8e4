//! A stream of targets on standard input, their answers on standard output.

use super::read::{Read, described, options, some, wrong};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismServe;
use crate::mechanism::serve::{LineKind, serve};
use crate::output::mechanisms::{View, json};
use cognate_kinematics::compile::{Problem, Question};
use cognate_mechanism_solver::preparation::AnswerOptions;
use cognate_mechanism_solver::prepared_mechanism::PreparedMechanism;

/// `cognate mechanism serve`.
pub fn run(a: &MechanismServe) -> Result<Exit, ClientError> {
    if a.mechanism.file.as_os_str() == "-" {
        return Err(wrong(
            "-",
            "standard input is for targets; give the mechanism as a file",
        ));
    }
    let read = Read::of(&a.mechanism)?;
    let question = Question {
        problem: if a.forward {
            Problem::Forward
        } else {
            Problem::Inverse
        },
        inputs: some(&a.input),
        locks: read.locks(&a.mechanism)?,
        task: a.task.task,
    };
    let options = AnswerOptions {
        near: read.near(a.near.as_deref(), read.degrees(&a.mechanism))?,
        ..options(&a.solving)
    };
    let prepared =
        PreparedMechanism::new(&read.mechanism, &question, &options).map_err(|e| described(&e))?;
    let preparation = prepared.preparation();
    for warning in &preparation.warnings {
        eprintln!("warning: {warning}");
    }
    let degrees = read.degrees(&a.mechanism);
    let kind = if a.forward {
        LineKind::Inputs {
            names: read.mechanism.kinds(&preparation.inputs),
            degrees,
        }
    } else {
        LineKind::Poses(read.form(question.task, degrees))
    };
    let view = View {
        mechanism: &read.mechanism,
        problem: question.problem,
        preparation,
        degrees,
        only_within_limits: a.within_limits,
        complex: a.complex,
    };
    let shown = |line: u64, answer: &_| json::line(&view, line, answer);
    let input = std::io::BufReader::new(std::io::stdin());
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let served = match serve(&prepared, &kind, input, &mut out, &shown) {
        Ok(served) => served,
        // The reader has gone: nobody waits for more.
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => return Ok(Exit::Solved),
        Err(source) => {
            return Err(ClientError::File {
                action: "cannot read or write",
                path: "standard input or output".into(),
                source,
            });
        }
    };
    Ok(match (served.refused, served.unsettled) {
        (0, 0) if preparation.settled => Exit::Solved,
        (0, _) => Exit::Unsettled,
        _ => Exit::BadInput,
    })
}
