//! At which points the output of a mechanism can be, and in how many postures.

use super::read::{Read, described, options, orientation, refuse_locks};
use crate::common_arguments::Format;
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismWorkspace;
use crate::output;
use crate::output::mechanisms::near as shown;
use crate::output::text::Look;
use crate::problem::read_file;
use cognate_kinematics::mechanism::Space;
use cognate_kinematics::mechanism::targets;
use cognate_mechanism_solver::workspace::workspace;

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
    let answers = answers.map_err(|e| described(&e))?;
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
