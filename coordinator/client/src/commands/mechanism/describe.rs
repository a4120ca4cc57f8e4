//! Description of a mechanism, its equations, and the mechanism in another notation; nothing is solved.

use super::read::{Read, described, some, wrong};
use crate::common_arguments::Format;
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::{
    EquationsFormat, MechanismConvert, MechanismEquations, MechanismInfo, Notation, ProblemName,
};
use crate::output;
use crate::output::mechanisms::info as shown;
use crate::output::text::Look;
use cognate_kinematics::compile::motion::motion;
use cognate_kinematics::compile::{Problem, Question, compile};
use cognate_kinematics::mechanism::task::Task;
use cognate_kinematics::mechanism::{MechanismError, write};
use cognate_systems::formats;

/// `cognate mechanism info`.
pub fn info(a: &MechanismInfo) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    for warning in read
        .mechanism
        .snapping_warnings()
        .iter()
        .chain(&read.mechanism.warnings)
    {
        eprintln!("warning: {warning}");
    }
    let locks = read.locks(&a.mechanism)?;
    let compiled = |problem, task| {
        let question = Question {
            locks: locks.clone(),
            task,
            ..Question::of(problem)
        };
        compile(&read.mechanism, &question)
    };
    let mut asked: Vec<(&str, Result<_, MechanismError>)> = vec![
        ("inverse", compiled(Problem::Inverse, Task::Pose)),
        ("forward", compiled(Problem::Forward, Task::Pose)),
    ];
    // Tasks that give as many numbers as the chain has joints.
    let free = read.mechanism.values().len().saturating_sub(locks.len());
    let tasks = Task::PARTS
        .into_iter()
        .filter(|task| task.freedoms() == free);
    let tasks = tasks.map(|task| (task.name(), compiled(Problem::Inverse, task)));
    asked.extend(tasks.filter(|(_, compiled)| compiled.is_ok()));
    let text = match a.format {
        Format::Table => shown::table(&read.mechanism, &asked, Look::of_standard_output()),
        Format::Json => shown::json(&read.mechanism, &read.content, &asked),
    };
    output::print(&text)?;
    Ok(Exit::Solved)
}

/// `cognate mechanism equations`.
pub fn equations(a: &MechanismEquations) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    let question = Question {
        problem: match a.problem {
            ProblemName::Forward => Problem::Forward,
            ProblemName::Inverse => Problem::Inverse,
            ProblemName::Motion => Problem::Motion,
        },
        inputs: some(&a.input),
        locks: read.locks(&a.mechanism)?,
        task: Task::Pose,
    };
    let equations = match question.problem {
        Problem::Motion if question.locks.is_empty() => {
            let motion = motion(&read.mechanism, None).map_err(|e| described(&e))?;
            Some(motion.equations)
        }
        _ => {
            let formulation = compile(&read.mechanism, &question).map_err(|e| described(&e))?;
            formulation.equations().cloned()
        }
    };
    let Some(equations) = equations else {
        return Err(wrong(
            &read.mechanism.file,
            "this question has a closed form and no equations",
        ));
    };
    let format = match a.to {
        EquationsFormat::Json => {
            output::print(&equations.json())?;
            return Ok(Exit::Solved);
        }
        EquationsFormat::Bertini => formats::Format::Bertini,
        EquationsFormat::Phcpack => formats::Format::Phcpack,
    };
    let system = equations
        .system(&read.mechanism.file)
        .map_err(|e| described(&e))?;
    let text = formats::write(format, &system, &formats::FileSettings::default())
        .map_err(|e| wrong(&read.mechanism.file, e.to_string()))?;
    output::print(&text)?;
    Ok(Exit::Solved)
}

/// `cognate mechanism convert`.
pub fn convert(a: &MechanismConvert) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    let text = match a.to {
        Notation::Json => write::json(&read.mechanism, &read.content),
        Notation::Table => {
            if !write::table_is_whole(&read.mechanism) {
                eprintln!(
                    "warning: base and tool have no place in a table of rows; --to mechanism.json keeps them"
                );
            }
            write::dh_csv(&read.mechanism)
        }
    };
    for warning in read.mechanism.snapping_warnings() {
        eprintln!("warning: {warning}");
    }
    output::print(&text.map_err(|e| described(&e))?)?;
    Ok(Exit::Solved)
}
