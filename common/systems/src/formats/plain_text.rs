//! Plain equations as text: names, equations, conditions and objective, a line each.

use super::Format;
use super::parts::Parts;
use super::polynomial_list::{self as list, Words};
use super::sharing::WriteError;
use crate::expression::display::Style;
use crate::expression::parse::Dialect;
use crate::system::{System, VariableGroup};

pub(super) const WORDS: Words = Words {
    format: Format::Plain,
    style: Style::BERTINI,
    dialect: Dialect::PLAIN,
    functions: true,
    brackets: true,
};

/// Writes the equations of a system.
pub fn write(system: &System) -> Result<String, WriteError> {
    write_parts(&Parts::of_system(system))
}

/// Writes the parts of a problem.
pub(super) fn write_parts(parts: &Parts) -> Result<String, WriteError> {
    let system = &parts.system;
    list::check(system, &WORDS)?;
    let mut text = format!("unknowns: {}\n", parts.declared_names().join(", "));
    if !system.parameters.is_empty() {
        text.push_str(&format!("parameters: {}\n", system.parameters.join(", ")));
    }
    if system.groups.len() > 1 {
        let names = |group: &VariableGroup| {
            let names = group.variables.iter().map(|v| parts.names[*v].clone());
            names.collect::<Vec<String>>().join(" ")
        };
        let groups: Vec<String> = system.groups.iter().map(names).collect();
        text.push_str(&format!("groups: {}\n", groups.join(" | ")));
    }
    for equation in list::texts(system, WORDS.style) {
        text.push_str(&format!("{equation} = 0\n"));
    }
    for condition in &parts.conditions {
        text.push_str(&format!("where: {condition}\n"));
    }
    if let Some((goal, expression)) = &parts.objective {
        text.push_str(&format!("{}: {expression}\n", goal.name()));
    }
    Ok(text)
}
