//! `cognate mechanism`: from a mechanism's file to its equations, postures and positions.

use crate::error::{ClientError, Exit};
use crate::mechanism::answer::{Answer, AnswerOptions, answer};
use crate::mechanism::arguments::{
    AngleUnit, EquationsFormat, MechanismAnswer, MechanismCommand, MechanismConvert,
    MechanismEquations, MechanismFile, MechanismFormat, MechanismForward, MechanismInfo,
    MechanismInverse, Notation, ProblemName,
};
use crate::output;
use crate::output::mechanisms::{self, Shown};
use crate::output::text::Look;
use crate::problem::read_file;
use cognate_kinematics::compile::{Problem, Question, Target, compile};
use cognate_kinematics::mechanism::read_options::ChainEnds;
use cognate_kinematics::mechanism::{self, Mechanism, MechanismError, ReadOptions, targets, write};
use cognate_systems::formats;
use std::time::Instant;

/// Runs one of the commands.
pub fn run(command: &MechanismCommand) -> Result<Exit, ClientError> {
    match command {
        MechanismCommand::Info(a) => info(a),
        MechanismCommand::Equations(a) => equations(a),
        MechanismCommand::Convert(a) => convert(a),
        MechanismCommand::Inverse(a) => inverse(a),
        MechanismCommand::Forward(a) => forward(a),
    }
}

fn described(error: &MechanismError) -> ClientError {
    ClientError::Format(error.to_string())
}

fn wrong(origin: &str, message: impl Into<String>) -> ClientError {
    ClientError::Input {
        origin: origin.into(),
        message: message.into(),
    }
}

/// A mechanism that was read, with the bytes of its file.
struct Read {
    mechanism: Mechanism,
    content: Vec<u8>,
}

impl Read {
    fn of(a: &MechanismFile) -> Result<Self, ClientError> {
        let (name, content) = read_file(&a.file)?;
        let options = ReadOptions {
            no_snap: a.no_snap,
            ends: ChainEnds {
                base: a.base.clone(),
                tip: a.tip.clone(),
            },
        };
        let mechanism = mechanism::read(&name, &content, &options).map_err(|e| described(&e))?;
        Ok(Self { mechanism, content })
    }

    fn degrees(&self, a: &MechanismFile) -> bool {
        match a.angles {
            Some(unit) => unit == AngleUnit::Deg,
            None => self.mechanism.degrees,
        }
    }

    /// JOINT=VALUE pairs of an option.
    fn pairs(
        &self,
        option: &str,
        texts: &[String],
        degrees: bool,
    ) -> Result<Vec<(String, f64)>, ClientError> {
        let values = self.mechanism.values();
        let mut pairs: Vec<(String, f64)> = Vec::new();
        for text in texts {
            let Some((name, value)) = text.split_once('=') else {
                return Err(wrong(
                    option,
                    format!("expected JOINT=VALUE, found \"{text}\""),
                ));
            };
            let Some((_, is_angle)) = values.iter().find(|(n, _)| n == name) else {
                let names: Vec<&str> = values.iter().map(|(n, _)| n.as_str()).collect();
                return Err(wrong(
                    option,
                    format!("there is no joint {name}; there are {}", names.join(", ")),
                ));
            };
            if pairs.iter().any(|(n, _)| n == name) {
                return Err(wrong(option, format!("{name} is given twice")));
            }
            let number = targets::value(value, *is_angle, degrees);
            let number = number.ok_or_else(|| {
                wrong(
                    option,
                    format!("{name}: expected a number, found \"{value}\""),
                )
            })?;
            pairs.push((name.to_owned(), number));
        }
        Ok(pairs)
    }

    fn locks(&self, a: &MechanismFile) -> Result<Vec<(String, f64)>, ClientError> {
        self.pairs("--lock", &a.lock, self.degrees(a))
    }
}

fn some(list: &[String]) -> Option<Vec<String>> {
    (!list.is_empty()).then(|| list.to_vec())
}

fn info(a: &MechanismInfo) -> Result<Exit, ClientError> {
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
    let asked: Vec<(&str, Result<_, MechanismError>)> =
        [("inverse", Problem::Inverse), ("forward", Problem::Forward)]
            .into_iter()
            .map(|(name, problem)| {
                let question = Question {
                    problem,
                    inputs: None,
                    locks: locks.clone(),
                };
                (name, compile(&read.mechanism, &question))
            })
            .collect();
    let text = match a.format {
        MechanismFormat::Table => {
            mechanisms::info_table(&read.mechanism, &asked, Look::of_standard_output())
        }
        MechanismFormat::Json => mechanisms::info_json(&read.mechanism, &read.content, &asked),
    };
    output::print(&text)?;
    Ok(Exit::Solved)
}

fn equations(a: &MechanismEquations) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    let question = Question {
        problem: match a.problem {
            ProblemName::Forward => Problem::Forward,
            ProblemName::Inverse => Problem::Inverse,
            ProblemName::Motion => Problem::Motion,
        },
        inputs: some(&a.input),
        locks: read.locks(&a.mechanism)?,
    };
    let formulation = compile(&read.mechanism, &question).map_err(|e| described(&e))?;
    let Some(equations) = formulation.equations() else {
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

fn convert(a: &MechanismConvert) -> Result<Exit, ClientError> {
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

fn inverse(a: &MechanismInverse) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    let degrees = read.degrees(&a.mechanism);
    let poses = match (&a.poses, &a.pose) {
        (Some(path), _) => {
            let (name, content) = read_file(path)?;
            targets::poses(&name, &content, &read.mechanism, degrees)
        }
        (None, Some(pose)) => targets::typed_pose(pose, &read.mechanism, degrees).map(|p| vec![p]),
        (None, None) => return Err(wrong("--poses", "expected a file, or --pose")),
    };
    let poses = poses.map_err(|e| described(&e))?;
    let question = Question {
        problem: Problem::Inverse,
        inputs: None,
        locks: read.locks(&a.mechanism)?,
    };
    let targets: Vec<Target> = poses.into_iter().map(Target::Pose).collect();
    respond(&read, &question, &targets, &a.answer, degrees)
}

fn forward(a: &MechanismForward) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    let degrees = read.degrees(&a.mechanism);
    let question = Question {
        problem: Problem::Forward,
        inputs: some(&a.input),
        locks: read.locks(&a.mechanism)?,
    };
    let formulation = compile(&read.mechanism, &question).map_err(|e| described(&e))?;
    let kinds = read.mechanism.values();
    let is_angle = |name: &String| kinds.iter().any(|(n, angle)| n == name && *angle);
    let names: Vec<(String, bool)> = formulation
        .inputs()
        .iter()
        .map(|n| (n.clone(), is_angle(n)))
        .collect();
    let list = || {
        names
            .iter()
            .map(|(n, _)| n.as_str())
            .collect::<Vec<&str>>()
            .join(", ")
    };
    let given: Vec<Vec<f64>> = if let Some(path) = &a.inputs {
        if names.is_empty() {
            return Err(wrong(
                "--inputs",
                "nothing drives this mechanism; name its inputs with --input",
            ));
        }
        let (name, content) = read_file(path)?;
        targets::inputs(&name, &content, &names, degrees).map_err(|e| described(&e))?
    } else if !a.set.is_empty() {
        let pairs = read.pairs("--set", &a.set, degrees)?;
        if let Some((name, _)) = pairs
            .iter()
            .find(|(p, _)| !names.iter().any(|(n, _)| n == p))
        {
            return Err(wrong(
                "--set",
                format!("{name} is no input; the inputs are {}", list()),
            ));
        }
        let mut values = Vec::new();
        for (name, _) in &names {
            let value = pairs.iter().find(|(p, _)| p == name).map(|(_, v)| *v);
            values.push(value.ok_or_else(|| {
                wrong(
                    "--set",
                    format!("{name} has no value; the inputs are {}", list()),
                )
            })?);
        }
        vec![values]
    } else if names.is_empty() {
        Vec::new()
    } else {
        return Err(wrong(
            "--inputs",
            format!(
                "expected values of {}: a file, or --set JOINT=VALUE",
                list()
            ),
        ));
    };
    let targets: Vec<Target> = given.into_iter().map(Target::Inputs).collect();
    respond(&read, &question, &targets, &a.answer, degrees)
}

fn respond(
    read: &Read,
    question: &Question,
    targets: &[Target],
    a: &MechanismAnswer,
    degrees: bool,
) -> Result<Exit, ClientError> {
    let start = Instant::now();
    let options = AnswerOptions {
        seed: a.seed,
        certify: a.certify,
    };
    let found: Answer =
        answer(&read.mechanism, question, targets, &options).map_err(|e| described(&e))?;
    let shown = Shown {
        mechanism: &read.mechanism,
        content: &read.content,
        problem: question.problem,
        answer: &found,
        wall_seconds: start.elapsed().as_secs_f64(),
        degrees,
        only_within_limits: a.within_limits,
        complex: a.complex,
    };
    let text = match a.format {
        MechanismFormat::Table => {
            for warning in &found.warnings {
                eprintln!("warning: {warning}");
            }
            mechanisms::answer_table(&shown, Look::of_standard_output())
        }
        MechanismFormat::Json => mechanisms::answer_json(&shown),
    };
    output::print(&text)?;
    Ok(if found.settled {
        Exit::Solved
    } else {
        Exit::Unsettled
    })
}
