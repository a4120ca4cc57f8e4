//! At which points the output of a mechanism can be, and in how many postures.

use super::read::{Read, described, options, orientation, refuse_locks, wrong};
use crate::common_arguments::Format;
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismWorkspace;
use crate::output;
use crate::output::mechanisms::near as shown;
use crate::output::text::{Look, counted};
use crate::problem::read_file;
use crate::remedy::quoted;
use cognate_kinematics::mechanism::targets;
use cognate_kinematics::mechanism::{Body, Mechanism, Space};
use cognate_mechanism_solver::workspace::workspace;

/// How the refusal of a mechanism begins whose points are not decided.
const NOT_YET: &str = "not in this version: points of";

/// The refusal of a mechanism whose points are not decided, with the line that tells most of them.
fn instead(mechanism: &Mechanism, a: &MechanismWorkspace) -> ClientError {
    let file = a.mechanism.file.display().to_string();
    let name = quoted(&file);
    let points = quoted(&a.points.display().to_string());
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
            format!("cognate mechanism workspace {name} --points {points} --orientation 0"),
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
    let (name, content) = read_file(&a.points)?;
    let is_planar = read.mechanism.space == Space::Planar;
    let points = targets::points(&name, &content, is_planar).map_err(|e| described(&e))?;
    let answers = workspace(&read.mechanism, &points, orientation, &options(&a.solving));
    let answers = answers.map_err(|e| match e.message.starts_with(NOT_YET) {
        true => instead(&read.mechanism, a),
        false => described(&e),
    })?;
    let mut is_settled = true;
    for (index, answer) in answers.iter().enumerate() {
        for doubt in answer.doubts(a.within_limits) {
            is_settled = false;
            eprintln!("warning: point {index}: {doubt}");
        }
    }
    let view = shown::WorkspaceView {
        mechanism: &read.mechanism,
        content: &read.content,
        within_limits: a.within_limits,
        is_settled,
    };
    output::print(&match a.format {
        Format::Table => shown::workspace_table(&view, &answers, Look::of_standard_output()),
        Format::Json => shown::workspace_json(&view, &answers),
    })?;
    Ok(Exit::of_settled(is_settled))
}
