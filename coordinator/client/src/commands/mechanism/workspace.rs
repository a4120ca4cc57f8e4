//! At which points the output of a mechanism can be, in how many postures, and what bounds them.

use super::read::{Read, described, options, orientation, refuse_locks, wrong};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismWorkspace;
use crate::output::mechanisms::workspace as shown;
use crate::output::objects;
use crate::output::text::{Look, counted};
use crate::problem::read_file;
use crate::remedy::quoted;
use cognate_kinematics::mechanism::targets;
use cognate_kinematics::mechanism::{Body, Mechanism, MechanismError, Space};
use cognate_mechanism_solver::workspace::{Boundary, ReachedPoint, boundary, workspace};

/// How the refusal of a mechanism begins whose points are not decided.
const NOT_YET: &str = "not in this version: points of";

/// The refusal of a mechanism whose points are not decided, with the line that tells most of them.
fn instead(mechanism: &Mechanism, a: &MechanismWorkspace) -> ClientError {
    let file = a.mechanism.file.display().to_string();
    let name = quoted(&file);
    let points = a.points.as_ref().map_or_else(String::new, |points| {
        format!(" --points {}", quoted(&points.display().to_string()))
    });
    let poses = format!("cognate mechanism inverse {name} --poses poses.csv");
    let (message, line) = match &mechanism.body {
        Body::Chain(chain) if !chain.closed => (
            format!(
                "points of an arm with {} are not decided in this version, only of arms with three joints; give each point \
                 an orientation: a pose with 0 real postures is out of reach",
                counted(chain.joints.len() as u64, "joint")
            ),
            poses,
        ),
        Body::Platform(_) if mechanism.space == Space::Planar => (
            "a planar platform is held at an angle: --orientation".to_owned(),
            format!("cognate mechanism workspace {name}{points} --orientation 0"),
        ),
        Body::Platform(_) => (
            "points of a platform that turns are not decided in this version; give each point an orientation: a pose of which \
             no legs are real is out of reach"
                .to_owned(),
            poses,
        ),
        Body::Chain(_) | Body::Framework(_) | Body::Linkage(_) => (
            "points are decided in this version of arms with three joints, of platforms that keep their orientation, and of \
             planar linkages"
                .to_owned(),
            format!("cognate mechanism motion {name}"),
        ),
    };
    wrong(&file, format!("{message}\n  try: {line}"))
}

/// `cognate mechanism workspace`.
pub fn run(a: &MechanismWorkspace) -> Result<Exit, ClientError> {
    let read = Read::of(&a.mechanism)?;
    refuse_locks(&a.mechanism)?;
    let degrees = read.degrees(&a.mechanism);
    let orientation = orientation(a.orientation.as_deref(), degrees)?;
    let points = match &a.points {
        Some(file) => {
            let (name, content) = read_file(file)?;
            let is_planar = read.mechanism.space == Space::Planar;
            targets::points(&name, &content, is_planar).map_err(|e| described(&e))?
        }
        None => Vec::new(),
    };
    let answering = options(&a.solving);
    let refused = |e: MechanismError| match e.message.starts_with(NOT_YET) {
        true => instead(&read.mechanism, a),
        false => described(&e),
    };
    let answers = workspace(&read.mechanism, &points, orientation, &answering).map_err(refused)?;
    let asked = (orientation, a.within_limits);
    let boundary = boundary(&read.mechanism, asked, &answers, &answering).map_err(refused)?;
    let doubts = doubts(a, &answers, &boundary);
    for doubt in &doubts {
        eprintln!("warning: {doubt}");
    }
    let view = shown::WorkspaceView {
        mechanism: &read.mechanism,
        content: &read.content,
        within_limits: a.within_limits,
        is_settled: doubts.is_empty(),
        boundary: &boundary,
    };
    let lists = match a.points {
        Some(_) => &["/points"],
        None => &["/boundary"],
    };
    objects::print(
        a.format,
        lists,
        || shown::table(&view, &answers, Look::of_standard_output()),
        || shown::json(&view, &answers),
    )?;
    Ok(Exit::of_settled(doubts.is_empty()))
}

/// Doubts about points and about the boundary. A boundary that is not known is a doubt if nothing else was asked for.
fn doubts(a: &MechanismWorkspace, answers: &[ReachedPoint], boundary: &Boundary) -> Vec<String> {
    let mut doubts = Vec::new();
    for (index, answer) in answers.iter().enumerate() {
        let of_point = answer.doubts(a.within_limits);
        doubts.extend(of_point.map(|doubt| format!("point {index}: {doubt}")));
    }
    doubts.extend(boundary.doubt.clone());
    if let (None, Err(reason)) = (&a.points, &boundary.curves) {
        doubts.push(format!("no boundary: {reason}"));
    }
    doubts
}
