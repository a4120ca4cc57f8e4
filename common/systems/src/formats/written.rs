//! Written problem: a problem in a notation, with conditions and objective where the notation has words for them, and a
//! sentence for each part that is left out or changed.
//!
//! Plain equations and our JSON have all of them, and keep the functions of unknowns as they were typed; in the other
//! notations a function is an unknown with an equation, which has the solutions on other branches, too.

use super::parts::Parts;
use super::sharing::WriteError;
use super::{Format, Problem, json, plain_text};
use crate::system::{System, VariableGroup};

/// A problem as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The text in the notation.
    pub text: String,
    /// A sentence for each part of the problem that the text does not have, or has in another form.
    pub warnings: Vec<String>,
}

/// Writes a problem; a part that the notation has no words for is named in a warning.
///
/// # Errors
/// When the notation has no words for the equations, or for an objective without equations.
pub fn write_problem(format: Format, problem: &Problem) -> Result<Written, WriteError> {
    let mut warnings = left_out(&problem.system, format);
    let write = match format {
        Format::Plain => plain_text::write_parts,
        Format::Json => json::write_parts,
        _ => {
            let text = write_equations(format, problem)?;
            warnings.extend(unsaid(problem));
            warnings.extend(on_other_branches(&problem.system));
            return Ok(Written { text, warnings });
        }
    };
    if !problem.system.helpers.is_empty()
        && let Some(parts) = Parts::as_typed(problem)
        && let Ok(text) = write(&parts)
        && let Ok(read) = super::read("", text.as_bytes())
        && read.system.helpers.len() == problem.system.helpers.len()
        && read.system.equations.len() == problem.system.equations.len()
    {
        return Ok(Written { text, warnings });
    }
    let text = write(&Parts::of_problem(problem)?)?;
    warnings.extend(on_other_branches(&problem.system));
    Ok(Written { text, warnings })
}

/// The text in a notation of equations alone.
fn write_equations(format: Format, problem: &Problem) -> Result<String, WriteError> {
    let system = &problem.system;
    if problem.objective.as_ref().is_some_and(|one| one.is_free) {
        let what = "objectives, and the problem has nothing else";
        return Err(WriteError::Inexpressible { format, what });
    }
    super::write(format, system, &problem.settings)
}

/// Parts of a system that the notation cannot express.
fn left_out(system: &System, format: Format) -> Vec<String> {
    let is_homogeneous = |group: &VariableGroup| group.homogeneous;
    let has_homogeneous = system.groups.iter().any(is_homogeneous);
    let has_groups = system.groups.len() > 1 || has_homogeneous;
    let groups_are_lost = match format {
        Format::Bertini | Format::Json => false,
        Format::Plain => has_homogeneous,
        _ => has_groups,
    };
    let only_json = format != Format::Json;
    let parts = [
        (
            groups_are_lost && format != Format::Plain,
            "variable groups",
        ),
        (
            groups_are_lost && format == Format::Plain,
            "homogeneous groups",
        ),
        (
            only_json && format != Format::Bertini && system.path_variable.is_some(),
            "path variables",
        ),
        (
            only_json && !system.conjugates.is_empty(),
            "pairs of conjugates",
        ),
        (
            only_json && !system.degenerate.is_empty(),
            "degenerate sets",
        ),
        (only_json && !system.symmetry.is_empty(), "symmetries"),
    ];
    let lost = parts.into_iter().filter(|(is_lost, _)| *is_lost);
    lost.map(|(_, what)| format!("{what} are left out, for which this notation has no words"))
        .collect()
}

/// The conditions and the objective of a problem, which are left out beside its equations.
fn unsaid(problem: &Problem) -> Vec<String> {
    let mut warnings = Vec::new();
    if !problem.conditions.is_empty() {
        let condition = problem.conditions.text();
        warnings.push(format!("the condition {condition} is left out"));
    }
    if let Some(objective) = &problem.objective {
        let (goal, text) = (objective.goal.name(), &objective.text);
        warnings.push(format!(
            "{goal}: {text} is left out: only the equations are written"
        ));
    }
    warnings
}

/// The functions of unknowns that are written as unknowns with equations.
fn on_other_branches(system: &System) -> Option<String> {
    let meanings = system.helper_meanings().into_iter();
    let meanings: Vec<String> = meanings
        .map(|m| format!("{} for {}", m.name, m.is))
        .collect();
    let has_roots = system.root_unknowns().next().is_some();
    let branches = match has_roots {
        true => "; the solutions on other branches of the roots are added",
        false => "",
    };
    let listed = meanings.join(", ");
    (!meanings.is_empty())
        .then(|| format!("functions are written as unknowns with equations: {listed}{branches}"))
}
