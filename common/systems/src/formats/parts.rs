//! Parts of a problem as texts: names, conditions and objective beside the equations.

use super::sharing::{self, WriteError};
use super::{Format, Problem};
use crate::condition::{Condition, Conditions, Relation};
use crate::expression::NodeId;
use crate::expression::display::Style;
use crate::helper_unknown::Helper;
use crate::objective::Goal;
use crate::system::System;
use std::collections::HashMap;

/// Most characters of a function of functions that is written as one.
const LONGEST_FUNCTION: usize = 10_000;

/// Parts of a problem for plain equations and our JSON, in which conditions and objective stand beside the equations.
pub(super) struct Parts {
    /// The system. A variable that is written as a function has the text of the function as its name.
    pub system: System,
    /// The variables that are declared, by index.
    pub declared: Vec<usize>,
    /// Names of all variables for declarations.
    pub names: Vec<String>,
    /// Conditions on the solutions that are wanted.
    pub conditions: Vec<String>,
    /// The expression of which critical points are wanted.
    pub objective: Option<(Goal, String)>,
}

impl Parts {
    /// The parts of a system alone.
    pub fn of_system(system: &System) -> Self {
        Self {
            declared: (0..system.variables.len()).collect(),
            names: system.variables.clone(),
            system: system.clone(),
            conditions: Vec::new(),
            objective: None,
        }
    }

    /// Names of the variables that are declared.
    pub fn declared_names(&self) -> Vec<String> {
        let names = self.declared.iter().map(|v| self.names[*v].clone());
        names.collect()
    }

    /// The parts of a problem, its equations with unknowns in place of functions.
    pub fn of_problem(problem: &Problem) -> Result<Self, WriteError> {
        let mut parts = Self::of_system(&problem.system);
        parts.conditions = condition_texts(problem)?;
        parts.enter_objective(problem);
        Ok(parts)
    }

    /// The parts of a problem with its functions as they were typed.
    pub fn as_typed(problem: &Problem) -> Option<Self> {
        let mut parts = Self::of_problem(problem).ok()?;
        let system = &mut parts.system;
        let helpers = std::mem::take(&mut system.helpers);
        let equations = system.equations.len().checked_sub(helpers.len())?;
        system.equations.truncate(equations);
        for helper in helpers {
            let written = match &helper {
                Helper::Root(root) => vec![(
                    root.variable,
                    operand(root.function(&text(system, root.radicand))),
                )],
                Helper::Angle(angle) => {
                    let argument = angle.unit.times(&angle.name);
                    parts.names[angle.cosine].clone_from(&angle.name);
                    vec![
                        (angle.cosine, format!("cos({argument})")),
                        (angle.sine, format!("sin({argument})")),
                    ]
                }
            };
            let added = match &helper {
                Helper::Root(root) => root.variable,
                Helper::Angle(angle) => angle.sine,
            };
            parts.declared.retain(|v| *v != added);
            for group in &mut system.groups {
                group.variables.retain(|v| *v != added);
            }
            for (variable, function) in written {
                if function.len() > LONGEST_FUNCTION {
                    return None;
                }
                system.variables[variable] = function;
            }
        }
        parts.enter_objective(problem);
        Some(parts)
    }

    fn enter_objective(&mut self, problem: &Problem) {
        let Some(objective) = &problem.objective else {
            return;
        };
        // The equations of an objective alone follow from it.
        if objective.is_free {
            self.system.equations.clear();
        }
        self.objective = Some((objective.goal, text(&self.system, objective.node)));
    }
}

/// The text of an expression of a system.
fn text(system: &System, node: NodeId) -> String {
    let shared = HashMap::new();
    sharing::display(system, Style::BERTINI, &shared).text(node)
}

/// A function as an operand: `x^(1/3)` in brackets.
fn operand(function: String) -> String {
    match function.starts_with('(') {
        true => format!("({function})"),
        false => function,
    }
}

/// The conditions of a problem, in the unknowns that were typed.
fn condition_texts(problem: &Problem) -> Result<Vec<String>, WriteError> {
    let Conditions {
        conditions,
        expressions,
        differences,
        ..
    } = &problem.conditions;
    let system = System {
        expressions: expressions.clone(),
        equations: differences.clone(),
        ..problem.system.typed_system()
    };
    if !sharing::fits_unshared(&system, Style::BERTINI) {
        return Err(WriteError::TooLarge(Format::Plain));
    }
    let texts = differences.iter().map(|node| text(&system, *node));
    let texts: Vec<String> = texts.collect();
    Ok(conditions
        .iter()
        .map(|one| condition(one, &texts))
        .collect())
}

/// The text of a condition, from those of the differences.
fn condition(stated: &Condition, differences: &[String]) -> String {
    let joined = |conditions: &[Condition], word: &str| {
        let parts = conditions.iter().map(|part| match part {
            Condition::Comparison { .. } => condition(part, differences),
            other => format!("({})", condition(other, differences)),
        });
        parts.collect::<Vec<String>>().join(word)
    };
    match stated {
        Condition::Comparison {
            difference,
            relation,
        } => {
            let sign = match relation {
                Relation::Less => "<",
                Relation::AtMost => "<=",
                Relation::Greater => ">",
                Relation::AtLeast => ">=",
                Relation::Equal => "=",
                Relation::NotEqual => "!=",
            };
            format!("{} {sign} 0", differences[*difference])
        }
        Condition::Every(conditions) => joined(conditions, " and "),
        Condition::Any(conditions) => joined(conditions, " or "),
        Condition::Not(inner) => format!("not ({})", condition(inner, differences)),
        Condition::Complementary {
            differences: [a, b],
        } => format!("{} >= 0 and {} >= 0", differences[*a], differences[*b]),
    }
}
