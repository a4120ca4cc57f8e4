//! The families that are solved already, and their members solved anew.

use super::read::wrong;
use crate::common_arguments::Format;
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::{FamilyAction, MechanismFamilies};
use crate::output;
use crate::output::mechanisms::families as shown;
use crate::output::text::Look;
use cognate_kinematics::compile::families::SOLVED;
use cognate_mechanism_solver::families::solve_member;

/// `cognate mechanism families`.
pub fn run(a: &MechanismFamilies) -> Result<Exit, ClientError> {
    let Some(FamilyAction::Prepare {
        name,
        seed,
        output: folder,
    }) = &a.action
    else {
        output::print(&match a.format {
            Format::Table => shown::table(Look::of_standard_output()),
            Format::Json => shown::json(),
        })?;
        return Ok(Exit::Solved);
    };
    let Some(family) = SOLVED.iter().find(|family| family.name == name) else {
        let names: Vec<&str> = SOLVED.iter().map(|family| family.name).collect();
        let message = format!("there is no family {name}; there are {}", names.join(", "));
        return Err(wrong("families prepare", message));
    };
    let member = solve_member(family, *seed).map_err(ClientError::Local)?;
    for warning in &member.warnings {
        eprintln!("warning: {warning}");
    }
    if let Some(folder) = folder {
        shown::write(&member, folder)?;
    }
    output::print(&shown::prepared(family, &member))?;
    Ok(if member.settled {
        Exit::Solved
    } else {
        Exit::Unsettled
    })
}
