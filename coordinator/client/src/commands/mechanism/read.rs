//! A mechanism from the file that is named, and what options say of its joints.

use super::open_numbers;
use crate::error::ClientError;
use crate::mechanism::arguments::{
    AngleUnit, MechanismFile, MechanismSingularities, MechanismSolving,
};
use crate::other_files;
use crate::output::text::counted;
use crate::problem::read_file;
use cognate_kinematics::compile::Target;
use cognate_kinematics::compile::singular_positions::SingularKind;
use cognate_kinematics::import::urdf::first_macro;
use cognate_kinematics::mechanism::exact::{Angle, read_angle};
use cognate_kinematics::mechanism::pose::ReadPose;
use cognate_kinematics::mechanism::read_options::ChainEnds;
use cognate_kinematics::mechanism::targets::PoseForm;
use cognate_kinematics::mechanism::task::Task;
use cognate_kinematics::mechanism::{self, Mechanism, MechanismError, ReadOptions, targets};
use cognate_mechanism_solver::cache::{Cache, Content};
use cognate_mechanism_solver::preparation::AnswerOptions;
use cognate_systems::expression::similar::meant;
use std::path::Path;
use std::process::Command;

/// The error of a mechanism as one of the command line.
pub fn described(error: &MechanismError) -> ClientError {
    ClientError::Format(error.to_string())
}

/// An error about an option or a file.
pub fn wrong(origin: &str, message: impl Into<String>) -> ClientError {
    ClientError::Input {
        origin: origin.into(),
        message: message.into(),
    }
}

/// Refuses `--lock` where a question does not hold joints.
pub fn refuse_locks(a: &MechanismFile) -> Result<(), ClientError> {
    match a.lock.is_empty() {
        true => Ok(()),
        false => Err(wrong(
            "--lock",
            "not in this version: here no joint can be held; write the two links as one",
        )),
    }
}

/// How a mechanism's file is read, as the options say.
pub fn read_options(a: &MechanismFile) -> ReadOptions {
    ReadOptions {
        no_snap: a.no_snap,
        ends: ChainEnds {
            base: a.base.clone(),
            tip: a.tip.clone(),
        },
    }
}

/// A mechanism that was read, with the bytes of its file.
pub struct Read {
    /// The mechanism.
    pub mechanism: Mechanism,
    /// The bytes of its file.
    pub content: Vec<u8>,
}

impl Read {
    /// Reads the file that is named.
    pub fn of(a: &MechanismFile) -> Result<Self, ClientError> {
        let (name, content) = read_file(&a.file)?;
        let content = expanded(&a.file, content)?;
        Self::of_content(&name, content, a)
    }

    /// Reads the content of a file; `name` is for messages.
    pub fn of_content(
        name: &str,
        content: Vec<u8>,
        a: &MechanismFile,
    ) -> Result<Self, ClientError> {
        let read = mechanism::read(name, &content, &read_options(a));
        let mechanism = read.map_err(|e| {
            let other = other_files::instead_of_mechanism(name, &content);
            let other = other.or_else(|| open_numbers::refusal(name, &content));
            other.unwrap_or_else(|| described(&e))
        })?;
        Ok(Self { mechanism, content })
    }

    /// Poses from a file.
    pub fn poses(&self, path: &Path, form: PoseForm) -> Result<Vec<Target>, ClientError> {
        let (name, content) = read_file(path)?;
        let poses = targets::poses(&name, &content, form);
        let poses = poses.map_err(|e| described(&e))?;
        Ok(poses_said(&poses))
    }

    /// How poses are written of which this task gives a part.
    pub fn form(&self, task: Task, degrees: bool) -> PoseForm {
        PoseForm {
            space: self.mechanism.space,
            task,
            degrees,
        }
    }

    /// Values of inputs from a file.
    pub fn inputs(
        &self,
        path: &Path,
        names: &[(String, bool)],
        degrees: bool,
    ) -> Result<Vec<Target>, ClientError> {
        let (name, content) = read_file(path)?;
        input_targets(&name, &content, names, degrees)
    }

    /// Whether angles are typed and shown in degrees.
    pub fn degrees(&self, a: &MechanismFile) -> bool {
        match a.angles {
            Some(unit) => unit == AngleUnit::Deg,
            None => self.mechanism.degrees,
        }
    }

    /// Values of all joints, as typed in an option; radians and lengths.
    pub fn joint_values(
        &self,
        option: &str,
        text: &str,
        degrees: bool,
    ) -> Result<Vec<f64>, ClientError> {
        let values = self.mechanism.values();
        let words: Vec<&str> = text.split([' ', ',']).filter(|w| !w.is_empty()).collect();
        if words.len() != values.len() {
            let names: Vec<&str> = values.iter().map(|(n, _)| n.as_str()).collect();
            let message = format!(
                "expected {} ({}), found {}",
                counted(values.len() as u64, "value"),
                names.join(" "),
                words.len()
            );
            return Err(wrong(option, message));
        }
        let pairs = words.iter().zip(&values);
        pairs
            .map(|(word, (name, is_angle))| {
                let value = targets::value(word, *is_angle, degrees);
                value.ok_or_else(|| {
                    let message = format!("{name}: expected a number, found \"{word}\"");
                    wrong(option, message)
                })
            })
            .collect()
    }

    /// The joint values of `--near`; none where it is not given.
    pub fn near(&self, text: Option<&str>, degrees: bool) -> Result<Vec<f64>, ClientError> {
        let values = text.map(|text| self.joint_values("--near", text, degrees));
        Ok(values.transpose()?.unwrap_or_default())
    }

    /// JOINT=VALUE pairs of an option.
    pub fn pairs(
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
            let (name, value) = (name.trim(), value.trim());
            let Some((_, is_angle)) = values.iter().find(|(n, _)| n == name) else {
                let names: Vec<&str> = values.iter().map(|(n, _)| n.as_str()).collect();
                let perhaps = meant(name, names.iter().copied());
                let perhaps = perhaps.map_or(String::new(), |joint| format!(", perhaps {joint}"));
                let message = format!(
                    "there is no joint {name}{perhaps}; there are {}",
                    names.join(", ")
                );
                return Err(wrong(option, message));
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

    /// Kind of singularity that is asked for: of the inputs that are named, or of the file's inputs, or of the output.
    pub fn singular_kind(&self, a: &MechanismSingularities) -> SingularKind {
        match (a.outputs, a.input.is_empty()) {
            (true, _) => SingularKind::Outputs,
            (false, true) => SingularKind::Inputs(self.mechanism.inputs.clone()),
            (false, false) => SingularKind::Inputs(a.input.clone()),
        }
    }

    /// The joints that are held, with their values.
    pub fn locks(&self, a: &MechanismFile) -> Result<Vec<(String, f64)>, ClientError> {
        self.pairs("--lock", &a.lock, self.degrees(a))
    }
}

/// A URDF in macros as the program xacro expands it, where that is installed; anything else as it is.
fn expanded(path: &Path, content: Vec<u8>) -> Result<Vec<u8>, ClientError> {
    let is_xacro = str::from_utf8(&content).is_ok_and(|text| first_macro(text).is_some());
    if !is_xacro || path.as_os_str() == "-" {
        return Ok(content);
    }
    match Command::new("xacro").arg("--").arg(path).output() {
        Ok(output) if output.status.success() => Ok(output.stdout),
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.trim().lines().next_back().unwrap_or("it says nothing");
            Err(wrong(
                &path.display().to_string(),
                format!("xacro does not expand it: {last}"),
            ))
        }
        // Without the program the reader says what the file is.
        Err(_) => Ok(content),
    }
}

/// The angle of `--orientation`, where one was typed.
pub fn orientation(text: Option<&str>, degrees: bool) -> Result<Option<Angle>, ClientError> {
    let angle = |text: &str| {
        let read = read_angle(text, degrees, false);
        let message = || format!("expected an angle, found \"{text}\"");
        let read = read.ok_or_else(|| wrong("--orientation", message()));
        read.map(|read| read.angle)
    };
    text.map(angle).transpose()
}

/// The list as typed; `None` if it is empty.
pub fn some(list: &[String]) -> Option<Vec<String>> {
    (!list.is_empty()).then(|| list.to_vec())
}

/// Values of inputs as targets, from a text that a file or an option of this name has.
pub fn input_targets(
    name: &str,
    text: &[u8],
    inputs: &[(String, bool)],
    degrees: bool,
) -> Result<Vec<Target>, ClientError> {
    let values = targets::inputs(name, text, inputs, degrees);
    let values = values.map_err(|e| described(&e))?;
    Ok(values.into_iter().map(Target::Inputs).collect())
}

/// Poses as targets; a warning about them goes to standard error.
pub fn poses_said(poses: &[ReadPose]) -> Vec<Target> {
    if let Some(warning) = ReadPose::warning(poses) {
        eprintln!("warning: {warning}");
    }
    poses.iter().map(|read| Target::Pose(read.pose)).collect()
}

/// Options of answers, from the typed arguments.
pub fn options(a: &MechanismSolving) -> AnswerOptions {
    let usual = || {
        let usual = Cache::usual_folder(Content::Mechanisms);
        usual.filter(|_| !a.no_cache)
    };
    AnswerOptions {
        seed: a.seed,
        certify: a.certify,
        paths_only: a.paths_only,
        cache: a.cache.clone().or_else(usual),
        near: Vec::new(),
        threads: a.threads,
    }
}

/// CPU time of all threads of this process so far, in seconds.
pub fn cpu_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
