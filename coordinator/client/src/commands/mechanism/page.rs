//! Mechanisms on the page of a coordinator: their positions and branches, solved in this process.

use crate::output::mechanisms::View;
use crate::output::mechanisms::drawing::{Drawing, of_path};
use crate::output::mechanisms::path::ShownPath;
use cognate_coordinator::page::mechanisms::{MechanismQuestion, Mechanisms};
use cognate_kinematics::compile::{Problem, Question, Target, compile, size};
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::targets::PoseForm;
use cognate_kinematics::mechanism::{self, Body, LegKind, Mechanism, ReadOptions, Space, targets};
use cognate_mechanism_solver::cache::{Cache, Content};
use cognate_mechanism_solver::follow::follow;
use cognate_mechanism_solver::follow::samples::samples;
use cognate_mechanism_solver::preparation::AnswerOptions;
use cognate_mechanism_solver::prepared_mechanism::PreparedMechanism;
use cognate_mechanism_solver::summary::Summary;
use serde_json::{Value, json};

/// Most targets of one question; a page shows no more.
const MOST_TARGETS: usize = 500;
/// Samples along a path, where a person typed fewer targets.
const SAMPLES: usize = 120;

/// Answers with the engine of this program, on one thread.
#[derive(Debug)]
pub struct PageMechanisms;

impl Mechanisms for PageMechanisms {
    fn describe(&self, name: &str, file: &str) -> Result<Value, String> {
        let mechanism = read(name, file)?;
        let inputs = compile(&mechanism, &question(Problem::Forward));
        let inputs = inputs.map(|formulation| formulation.inputs().to_vec());
        let poses = compile(&mechanism, &question(Problem::Inverse)).is_ok();
        let example = inputs
            .as_ref()
            .ok()
            .map(|names| example_inputs(&mechanism, names));
        let mut given: Vec<(&str, String)> = example.map(|e| ("inputs", e)).into_iter().collect();
        given.extend(poses.then(|| ("poses", example_pose(&mechanism))));
        if matches!(mechanism.body, Body::Chain(_)) {
            given.reverse();
        }
        Ok(json!({
            "name": mechanism.name,
            "angles": if mechanism.degrees { "deg" } else { "rad" },
            "given": given,
            "no_inputs": inputs.err().map(|error| error.to_string()),
        }))
    }

    fn positions(&self, asked: &MechanismQuestion) -> Result<Value, String> {
        let mechanism = read(&asked.name, &asked.file)?;
        let problem = match asked.poses {
            true => Problem::Inverse,
            false => Problem::Forward,
        };
        let options = AnswerOptions {
            seed: 1,
            paths_only: false,
            certify: asked.certify,
            cache: Cache::usual_folder(Content::Mechanisms),
            near: Vec::new(),
            threads: 1,
        };
        let prepared = PreparedMechanism::new(&mechanism, &question(problem), &options);
        let prepared = prepared.map_err(|e| e.to_string())?;
        let preparation = prepared.preparation();
        let inputs = mechanism.kinds(&preparation.inputs);
        let targets = self.targets(asked, &mechanism, &inputs)?;
        let view = View {
            mechanism: &mechanism,
            problem,
            preparation,
            degrees: mechanism.degrees,
            only_within_limits: false,
            complex: false,
        };
        if asked.follow {
            let angles: Vec<bool> = inputs.iter().map(|(_, angle)| *angle).collect();
            let path_samples = samples(&targets, Some(SAMPLES), size(&mechanism), &angles);
            few(path_samples.len(), "samples")?;
            let path = follow(&prepared, path_samples).map_err(|e| e.to_string())?;
            return Ok(of_path(&ShownPath {
                view,
                path: &path,
                content: asked.file.as_bytes(),
                chosen: None,
                wall_seconds: 0.0,
                cpu_seconds: 0.0,
            }));
        }
        let mut drawing = Drawing::new(view);
        let mut summary = Summary::of(preparation);
        for answer in prepared.solve(&targets).map_err(|e| e.to_string())? {
            drawing.take(summary.targets, &answer);
            summary.note(&answer);
        }
        let mut notes = summary.warnings;
        if !summary.settled {
            notes.insert(0, "Not settled: a count is in doubt.".to_owned());
        }
        Ok(drawing.data(Vec::new(), Vec::new(), notes))
    }
}

impl PageMechanisms {
    /// The targets that were typed; where nothing drives the mechanism, the only one.
    fn targets(
        &self,
        asked: &MechanismQuestion,
        mechanism: &Mechanism,
        inputs: &[(String, bool)],
    ) -> Result<Vec<Target>, String> {
        let (text, degrees) = (asked.targets.as_bytes(), mechanism.degrees);
        let targets: Vec<Target> = if asked.poses {
            let poses = targets::poses("targets", text, PoseForm::whole(mechanism.space, degrees));
            let poses = poses.map_err(|e| e.to_string())?;
            poses.iter().map(|read| Target::Pose(read.pose)).collect()
        } else if inputs.is_empty() {
            vec![Target::Inputs(Vec::new())]
        } else {
            let values = targets::inputs("targets", text, inputs, degrees);
            let values = values.map_err(|e| e.to_string())?;
            values.into_iter().map(Target::Inputs).collect()
        };
        few(targets.len(), "targets")?;
        Ok(targets)
    }
}

fn few(count: usize, what: &str) -> Result<(), String> {
    match count > MOST_TARGETS {
        true => Err(format!(
            "{count} {what}; a page takes {MOST_TARGETS}, `cognate mechanism` takes more"
        )),
        false => Ok(()),
    }
}

fn read(name: &str, file: &str) -> Result<Mechanism, String> {
    mechanism::read(name, file.as_bytes(), &ReadOptions::default()).map_err(|e| e.to_string())
}

fn question(problem: Problem) -> Question {
    Question::of(problem)
}

/// A pose as a table of one row: of a chain one that it reaches.
fn example_pose(mechanism: &Mechanism) -> String {
    let Body::Chain(chain) = &mechanism.body else {
        return match mechanism.space {
            Space::Planar => "x,y,angle\n1,1,0\n".to_owned(),
            _ => "x,y,z,qw,qx,qy,qz\n0.1,0.2,1,1,0,0,0\n".to_owned(),
        };
    };
    let joints = chain.joints.iter().enumerate();
    let values = joints.map(|(k, joint)| JointValue::of_real(0.3 + 0.2 * k as f64, joint.is_angle));
    let pose = chain.tool_pose(&values.collect::<Vec<_>>());
    let [x, y, z] = pose.position.map(|c| c.re);
    let [qw, qx, qy, qz] = pose.quaternion();
    format!("x,y,z,qw,qx,qy,qz\n{x},{y},{z},{qw},{qx},{qy},{qz}\n")
}

/// Values of the inputs as a table: 0, or the lengths of legs at some pose.
fn example_inputs(mechanism: &Mechanism, names: &[String]) -> String {
    let value = |name: &String| match &mechanism.body {
        Body::Platform(platform) => {
            let leg = platform.legs.iter().find(|leg| leg.name == *name)?;
            let LegKind::Strut { from, .. } = &leg.kind else {
                return None;
            };
            let shift = match mechanism.space {
                Space::Planar => [0.1, 0.2, 0.0],
                _ => [0.1, 0.2, 1.0],
            };
            let gap = |k: usize| leg.to[k].to_f64() + shift[k] - from[k].to_f64();
            Some((0..3).map(|k| gap(k) * gap(k)).sum::<f64>().sqrt())
        }
        _ => None,
    };
    let values = names
        .iter()
        .map(|name| value(name).unwrap_or(0.0).to_string());
    format!(
        "{}\n{}\n",
        names.join(","),
        values.collect::<Vec<_>>().join(",")
    )
}
