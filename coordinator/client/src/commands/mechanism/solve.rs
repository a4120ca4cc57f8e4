//! Postures for poses, and positions for inputs.

use super::read::{Read, cpu_seconds, described, input_targets, options, poses_said, some, wrong};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::{
    MechanismAnswer, MechanismFormat, MechanismForward, MechanismInverse,
};
use crate::output::mechanisms::beside_rows::BesideRows;
use crate::output::mechanisms::listing::{Finished, Listing, Sink};
use crate::output::mechanisms::table::Table;
use crate::output::mechanisms::{View, csv, folder, json};
use crate::output::progress::{Progress, Standing};
use crate::output::text::Look;
use crate::remedy::quoted;
use cognate_kinematics::compile::{Problem, Question, Target, compile};
use cognate_kinematics::mechanism::MechanismError;
use cognate_kinematics::mechanism::typed_pose::typed_pose;
use cognate_mechanism_solver::Postures;
use cognate_mechanism_solver::preparation::{AnswerOptions, Preparation};
use cognate_mechanism_solver::prepared_mechanism::{PreparedMechanism, ROUND};
use cognate_mechanism_solver::summary::Summary;
use cognate_mechanism_solver::sweep::{Sweep, sample_values};
use std::path::Path;
use std::time::Instant;

/// `cognate mechanism inverse`.
pub fn inverse(a: &MechanismInverse) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    let degrees = read.degrees(&a.mechanism);
    let task = a.task.task;
    let form = read.form(task, degrees);
    let targets = match (&a.poses, &a.pose) {
        (Some(path), _) => read.poses(path, form)?,
        (None, Some(pose)) => {
            let pose = typed_pose(pose, form);
            poses_said(&[pose.map_err(|e| described(&e))?])
        }
        (None, None) => return Err(wrong("--poses", "expected a file, or --pose")),
    };
    let question = Question {
        locks: read.locks(&a.mechanism)?,
        task,
        ..Question::of(Problem::Inverse)
    };
    let options = AnswerOptions {
        near: read.near(a.near.as_deref(), degrees)?,
        ..options(&a.answer.solving)
    };
    let start = Instant::now();
    let mechanism = &read.mechanism;
    let Some(joint) = &a.sweep else {
        let prepared = PreparedMechanism::new(mechanism, &question, &options);
        let prepared = prepared.map_err(|e| described(&e))?;
        return respond(
            &read,
            &question,
            (&prepared, start),
            &targets,
            (&a.answer, degrees),
        );
    };
    if question.locks.iter().any(|(name, _)| name == joint) {
        let message =
            format!("{joint} is held by --lock: expected one of --sweep and --lock for it");
        return Err(wrong("--sweep", message));
    }
    let values = sample_values(mechanism, joint, a.samples).map_err(|e| described(&e))?;
    let sweep = Sweep::new(mechanism, &question, &options, (joint, &values));
    let sweep = sweep.map_err(|e| described(&e))?;
    respond(
        &read,
        &question,
        (&sweep, start),
        &targets,
        (&a.answer, degrees),
    )
}

/// `cognate mechanism forward`.
pub fn forward(a: &MechanismForward) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    let degrees = read.degrees(&a.mechanism);
    let question = Question {
        inputs: some(&a.input),
        locks: read.locks(&a.mechanism)?,
        ..Question::of(Problem::Forward)
    };
    let formulation = compile(&read.mechanism, &question).map_err(|e| described(&e))?;
    let names = read.mechanism.kinds(formulation.inputs());
    let targets = forward_targets(&read, a, &names)?;
    let start = Instant::now();
    let options = options(&a.answer.solving);
    let prepared = PreparedMechanism::new(&read.mechanism, &question, &options);
    let prepared = prepared.map_err(|e| described(&e))?;
    respond(
        &read,
        &question,
        (&prepared, start),
        &targets,
        (&a.answer, degrees),
    )
}

/// Numbers that were typed in the place of a file; `None` where there is a file of this name.
fn typed_values(path: &Path) -> Option<&str> {
    let text = path.to_str()?;
    let mut words = text
        .split([' ', ',', ';', '\t'])
        .filter(|word| !word.is_empty());
    let begins_as_number = |word: &str| {
        let word = word.trim_start_matches(['+', '-', '.']);
        word.starts_with("pi") || word.starts_with(|c: char| c.is_ascii_digit())
    };
    let is_typed = begins_as_number(words.next()?) && words.all(begins_as_number);
    (is_typed && !path.exists()).then_some(text)
}

/// The values of the inputs that are asked for, from a file or typed; none where nothing drives the mechanism.
fn forward_targets(
    read: &Read,
    a: &MechanismForward,
    names: &[(String, bool)],
) -> Result<Vec<Target>, ClientError> {
    let degrees = read.degrees(&a.mechanism);
    let list: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
    let list = list.join(", ");
    if let Some(path) = &a.inputs {
        if names.is_empty() {
            let message = "nothing drives this mechanism; name its inputs with --input";
            return Err(wrong("--inputs", message));
        }
        return match typed_values(path) {
            Some(typed) => input_targets("--inputs", typed.as_bytes(), names, degrees),
            None => read.inputs(path, names, degrees),
        };
    }
    if a.set.is_empty() && names.is_empty() {
        return Ok(Vec::new());
    }
    // Every refusal ends with a line in which each input has a value.
    let refused = |option: &str, message: String| {
        let values = names
            .iter()
            .map(|(name, _)| format!(" --set {}=0", quoted(name)));
        let file = quoted(&a.mechanism.file.display().to_string());
        let line = format!(
            "cognate mechanism forward {file}{}",
            values.collect::<String>()
        );
        wrong(option, format!("{message}\n  try: {line}"))
    };
    if a.set.is_empty() {
        let message =
            format!("expected values of {list}: a file, the numbers, or --set JOINT=VALUE");
        return Err(refused("--inputs", message));
    }
    let pairs = read.pairs("--set", &a.set, degrees);
    let pairs = pairs.map_err(|error| match error {
        ClientError::Input { origin, message } => refused(&origin, message),
        other => other,
    })?;
    let is_input = |name: &String| names.iter().any(|(input, _)| input == name);
    if let Some((name, _)) = pairs.iter().find(|(name, _)| !is_input(name)) {
        let message = format!("{name} is no input; the inputs are {list}");
        return Err(refused("--set", message));
    }
    let value = |(input, _): &(String, bool)| {
        let value = pairs.iter().find(|(name, _)| name == input);
        let message = || format!("{input} has no value; the inputs are {list}");
        value
            .map(|(_, x)| *x)
            .ok_or_else(|| refused("--set", message()))
    };
    let values = names.iter().map(value).collect::<Result<_, _>>()?;
    Ok(vec![Target::Inputs(values)])
}

/// Solver of targets.
trait Solver {
    /// Facts that are known before the targets.
    fn preparation(&self) -> &Preparation;
    /// Number of answers for each target.
    fn answers_per_target(&self) -> usize;
    /// Answers targets, in their order.
    fn solve(&self, targets: &[Target]) -> Result<Vec<Postures>, MechanismError>;
}

impl Solver for PreparedMechanism<'_> {
    fn preparation(&self) -> &Preparation {
        self.preparation()
    }
    fn answers_per_target(&self) -> usize {
        1
    }
    fn solve(&self, targets: &[Target]) -> Result<Vec<Postures>, MechanismError> {
        self.solve(targets)
    }
}

impl Solver for Sweep<'_> {
    fn preparation(&self) -> &Preparation {
        self.preparation()
    }
    fn answers_per_target(&self) -> usize {
        self.samples()
    }
    fn solve(&self, targets: &[Target]) -> Result<Vec<Postures>, MechanismError> {
        self.solve(targets)
    }
}

/// Answers targets; `start` is when their solver began to be prepared.
fn respond(
    read: &Read,
    question: &Question,
    (solver, start): (&dyn Solver, Instant),
    targets: &[Target],
    (a, degrees): (&MechanismAnswer, bool),
) -> Result<Exit, ClientError> {
    let view = View {
        mechanism: &read.mechanism,
        problem: question.problem,
        preparation: solver.preparation(),
        degrees,
        only_within_limits: a.within_limits,
        complex: a.complex,
    };
    let mut listings: Vec<Box<dyn Listing + '_>> = vec![match a.format {
        MechanismFormat::Table => Box::new(Table::new(view, Look::of_standard_output())),
        MechanismFormat::Json => {
            let sink = Sink::standard();
            Box::new(json::Object::new(view, &read.content, true, sink)?)
        }
        MechanismFormat::Jsonl => Box::new(json::Lines::new(view, Sink::standard())),
        MechanismFormat::Csv => Box::new(csv::Positions::new(view, Sink::standard())),
    }];
    if a.format == MechanismFormat::Csv {
        let beside = BesideRows::new(view, Look::of_standard_error());
        listings.push(Box::new(beside));
    }
    if let Some(path) = &a.output {
        listings.extend(folder::listings(view, &read.content, path)?);
    }
    // Where nothing is given, there is one target.
    let lone = [Target::Inputs(Vec::new())];
    let targets = match targets {
        [] => &lone[..],
        targets => targets,
    };
    let mut summary = Summary::of(solver.preparation());
    let each = solver.answers_per_target();
    let mut progress = match targets.len() * each > ROUND {
        true => Progress::new(true, start),
        false => Progress::silent(),
    };
    for round in targets.chunks(ROUND.div_ceil(each)) {
        for answer in solver.solve(round).map_err(|e| described(&e))? {
            for listing in &mut listings {
                listing.target(summary.targets, &answer)?;
            }
            summary.note(&answer);
        }
        let standing = Standing {
            phase: "solving".into(),
            done: summary.targets,
            total: (targets.len() * each) as u64,
            failed: 0,
            unit: "target",
        };
        progress.show(&standing, Instant::now());
    }
    progress.finish();
    if a.format != MechanismFormat::Json {
        for warning in &summary.warnings {
            eprintln!("warning: {warning}");
        }
    }
    let end = Finished {
        summary: &summary,
        wall_seconds: start.elapsed().as_secs_f64(),
        cpu_seconds: cpu_seconds(),
    };
    for listing in listings {
        listing.finish(&end)?;
    }
    Ok(if summary.settled {
        Exit::Solved
    } else {
        Exit::Unsettled
    })
}
