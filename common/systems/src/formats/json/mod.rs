//! Our own JSON problem, as the contract has it.
//!
//! Added to the contract's fields: `homogeneous` may be a list with one entry
//! for each group, and `path_variable` names the parameter of a user homotopy.

mod fields;
mod write;

pub use write::write;
pub(super) use write::write_parts;

use super::json_value::{self, Value};
use super::limits::{self, Limit};
use super::scope::{FieldFault, Scope, at, variable};
use super::{
    FileSettings, Format, FormatError, Problem, Source, conditions, degenerate, finish, hand_over,
    say_identities, symmetry,
};
use crate::condition::Conditions;
use crate::expression::NodeId;
use crate::expression::build::Use;
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::objective::{Goal, Objective};
use crate::system::{System, VariableGroup};
use fields::Fields;

/// Reads a problem in our JSON.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    let mut conditions = Conditions::default();
    let mut objective = None;
    let mut identities = Vec::new();
    let read = system(source, &mut conditions, &mut objective, &mut identities);
    let (system, data_accuracy) = read.map_err(|fault| fault.into_error(source))?;
    let mut warnings = Vec::new();
    identities.sort_by_key(|place| place.start);
    say_identities(source, &identities, &mut warnings);
    let settings = FileSettings {
        user_homotopy: system.path_variable.is_some(),
        data_accuracy,
        ..FileSettings::default()
    };
    Ok(Problem {
        system,
        settings,
        format: Format::Json,
        warnings,
        conditions,
        objective,
    })
}

/// The system, and the relative accuracy of its decimals.
fn system(
    source: &Source<'_>,
    conditions: &mut Conditions,
    objective: &mut Option<Objective>,
    identities: &mut Vec<Span>,
) -> Result<(System, f64), FieldFault> {
    let text = source.text;
    let root = json_value::parse(text, 0, text.len()).map_err(at(""))?;
    let fields = Fields::of(&root)?;
    let mut scope = Scope::default();
    let mut system = System::default();
    declarations(&fields, &mut scope, &mut system)?;
    define(&mut scope, fields.get("definitions"))?;
    *objective = stated_objective(&fields, &mut scope)?;
    let places = equations(&fields, objective.as_ref(), &mut scope, &mut system)?;
    structure(&fields, &mut scope, &mut system)?;
    hand_over(&mut scope.builder, &mut system, &places, objective.as_mut())
        .map_err(|fault| in_equation(&places, fault))?;
    let data_accuracy = scope.data_accuracy();
    let is_free = objective.as_ref().is_some_and(|one| one.is_free);
    let identities = (!is_free).then_some(identities);
    let system = finish(system, &places, fields.end, identities)
        .map_err(|fault| in_finished_system(&fields, &places, fault))?;
    if fields.contains("complementary") || fields.contains("where") {
        read_conditions(&fields, &system, conditions)?;
    }
    Ok((system, data_accuracy))
}

/// Declares variables, parameters and the path variable.
fn declarations(
    fields: &Fields<'_, '_>,
    scope: &mut Scope,
    system: &mut System,
) -> Result<(), FieldFault> {
    for (i, value) in limited(
        fields.required("variables")?,
        "variables",
        limits::VARIABLES,
    )?
    .iter()
    .enumerate()
    {
        let field = format!("variables[{i}]");
        let node = scope.builder.expressions.variable(i as u32);
        system
            .variables
            .push(declare(scope, value, &field, "a variable", node)?);
    }
    if let Some(value) = fields.get("parameters") {
        for (i, value) in limited(value, "parameters", limits::PARAMETERS)?
            .iter()
            .enumerate()
        {
            let field = format!("parameters[{i}]");
            let node = scope.builder.expressions.parameter(i as u32);
            system
                .parameters
                .push(declare(scope, value, &field, "a parameter", node)?);
        }
    }
    if let Some(value) = fields.get("path_variable") {
        let field = "path_variable";
        let name = value.text("the name of a parameter").map_err(at(field))?;
        let index = system.parameters.iter().position(|p| *p == name.text);
        let missing = || Fault::expected(value.span, "the name of a parameter", value.describe());
        system.path_variable = Some(index.ok_or_else(|| FieldFault::new(field, missing()))?);
    }
    Ok(())
}

/// The objective of the problem, if a field states one; at most one field may.
fn stated_objective(
    fields: &Fields<'_, '_>,
    scope: &mut Scope,
) -> Result<Option<Objective>, FieldFault> {
    let mut objective = None;
    for goal in Goal::ALL {
        let Some(value) = fields.get(goal.name()) else {
            continue;
        };
        let written = scope.parse(value, goal.name().into())?;
        if objective.is_some() {
            let fault = Fault::expected(value.span, "one objective", "another one");
            return Err(FieldFault::new(goal.name(), fault));
        }
        objective = Some(Objective {
            goal,
            text: value
                .text("an expression in quotes")
                .map_err(at(goal.name()))?
                .text
                .to_string(),
            node: scope.build(&written, Use::Rational)?,
            is_free: false,
        });
    }
    Ok(objective)
}

/// Builds the equations, with the products of complementary expressions behind them, and returns their places.
fn equations(
    fields: &Fields<'_, '_>,
    objective: Option<&Objective>,
    scope: &mut Scope,
    system: &mut System,
) -> Result<Vec<Span>, FieldFault> {
    let mut places = Vec::new();
    // A problem may consist of an objective alone.
    let equations = match fields.get("equations") {
        None if objective.is_some() => &[][..],
        _ => limited(
            fields.required("equations")?,
            "equations",
            limits::EQUATIONS,
        )?,
    };
    for (i, value) in equations.iter().enumerate() {
        let written = scope.parse_equation(value, format!("equations[{i}]"))?;
        system.equations.push(scope.build(&written, Use::Rational)?);
        system.equation_names.push(format!("f{}", i + 1));
        places.push(written.span());
    }
    if let Some(value) = fields.get("complementary") {
        for (product, place) in conditions::products(value, scope)? {
            system.equations.push(product);
            system
                .equation_names
                .push(format!("f{}", system.equations.len()));
            places.push(place);
        }
    }
    Ok(places)
}

/// Reads groups of variables, conjugates, degenerate sets and symmetry.
fn structure(
    fields: &Fields<'_, '_>,
    scope: &mut Scope,
    system: &mut System,
) -> Result<(), FieldFault> {
    groups(system, fields.get("groups"), fields.get("homogeneous"))?;
    if let Some(value) = fields.get("conjugates") {
        conjugates(system, value)?;
    }
    if let Some(value) = fields.get("degenerate") {
        system.degenerate = degenerate::sets(value, "degenerate", scope)?;
    }
    if let Some(value) = fields.get("symmetry") {
        system.symmetry = symmetry::generators(value, "symmetry", &system.variables, scope)?;
    }
    Ok(())
}

/// A fault of the equation that stands at the place of the fault.
fn in_equation(places: &[Span], fault: Fault) -> FieldFault {
    let i = places.iter().position(|p| *p == fault.span);
    let field = i.map_or(String::new(), |i| format!("equations[{i}]"));
    FieldFault::new(field, fault)
}

/// A fault of the whole system, at the field that it concerns.
fn in_finished_system(fields: &Fields<'_, '_>, places: &[Span], mut fault: Fault) -> FieldFault {
    match &fault.problem {
        What::ConstantEquation(_) | What::Limit { .. } => in_equation(places, fault),
        What::NoVariables => {
            fault.span = fields.span("variables");
            FieldFault::new("variables", fault)
        }
        What::NoEquations => {
            fault.span = fields.span("equations");
            FieldFault::new("equations", fault)
        }
        _ => FieldFault::new("", fault),
    }
}

/// Reads the complementary expressions and the conditions of the field `where`, in the unknowns of the user.
fn read_conditions(
    fields: &Fields<'_, '_>,
    system: &System,
    conditions: &mut Conditions,
) -> Result<(), FieldFault> {
    let mut scope = Scope::of(&system.typed_system());
    define(&mut scope, fields.get("definitions"))?;
    if let Some(value) = fields.get("complementary") {
        conditions::complementary(value, &mut scope, conditions)?;
    }
    if let Some(value) = fields.get("where") {
        selection(value, &mut scope, conditions)?;
    }
    conditions.expressions = scope.into_expressions();
    Ok(())
}

/// Enters the definitions of a problem into a scope.
fn define(scope: &mut Scope, definitions: Option<&Value<'_>>) -> Result<(), FieldFault> {
    let Some(value) = definitions else {
        return Ok(());
    };
    let mut list = Vec::new();
    for (name, value) in value
        .object("an object of expressions")
        .map_err(at("definitions"))?
    {
        let field = format!("definitions.{}", name.text);
        let span = Span {
            start: name.start,
            end: name.start + name.text.len(),
        };
        let number = scope
            .declare(name, span, "a definition", None)
            .map_err(at("definitions"))?;
        list.push((number, scope.parse(value, field)?));
    }
    scope.define(&list)
}

/// The conditions of the field `where`: a text, or an array of them.
fn selection(
    value: &Value<'_>,
    scope: &mut Scope,
    conditions: &mut Conditions,
) -> Result<(), FieldFault> {
    if value.text("").is_ok() {
        return scope.condition_of(value, "where".into(), conditions);
    }
    for (i, value) in array(value, "where")?.iter().enumerate() {
        scope.condition_of(value, format!("where[{i}]"), conditions)?;
    }
    Ok(())
}

/// Reads an array with at most as many entries as the limit allows.
fn limited<'v, 'a>(
    value: &'v Value<'a>,
    field: &str,
    limit: Limit,
) -> Result<&'v [Value<'a>], FieldFault> {
    let items = array(value, field)?;
    match items.get(limit.value as usize) {
        Some(item) => {
            let fault = Fault::limit(item.span, limit, items.len());
            Err(FieldFault::new(field, fault))
        }
        None => Ok(items),
    }
}

fn array<'v, 'a>(value: &'v Value<'a>, field: &str) -> Result<&'v [Value<'a>], FieldFault> {
    value.array("an array").map_err(at(field))
}

fn declare(
    scope: &mut Scope,
    value: &Value<'_>,
    field: &str,
    kind: &'static str,
    node: NodeId,
) -> Result<String, FieldFault> {
    let name = value.text("a name in quotes").map_err(at(field))?;
    scope
        .declare(name, value.span, kind, Some(node))
        .map_err(at(field))?;
    Ok(name.text.to_string())
}

fn groups(
    system: &mut System,
    groups: Option<&Value<'_>>,
    homogeneous: Option<&Value<'_>>,
) -> Result<(), FieldFault> {
    match groups {
        None => system.groups.push(VariableGroup {
            variables: (0..system.variables.len()).collect(),
            homogeneous: false,
        }),
        Some(value) => {
            let mut seen = vec![false; system.variables.len()];
            for (i, group) in array(value, "groups")?.iter().enumerate() {
                let field = format!("groups[{i}]");
                let mut members = Vec::new();
                for (j, value) in array(group, &field)?.iter().enumerate() {
                    let field = format!("{field}[{j}]");
                    let index = variable(value, &system.variables).map_err(at(&field))?;
                    if std::mem::replace(&mut seen[index], true) {
                        let first = "is in a group already".into();
                        let name = system.variables[index].clone();
                        let problem = What::DuplicateName { name, first };
                        return Err(FieldFault::new(field, Fault::new(value.span, problem)));
                    }
                    members.push(index);
                }
                if members.is_empty() {
                    let fault = Fault::expected(group.span, "at least one variable", "none");
                    return Err(FieldFault::new(field, fault));
                }
                system.groups.push(VariableGroup {
                    variables: members,
                    homogeneous: false,
                });
            }
            if let Some(missing) = seen.iter().position(|s| !s) {
                let actual_input = format!("`{}` in none", system.variables[missing]);
                let fault = Fault::expected(value.span, "every variable in a group", actual_input);
                return Err(FieldFault::new("groups", fault));
            }
        }
    }
    let Some(value) = homogeneous else {
        return Ok(());
    };
    let field = "homogeneous";
    if let json_value::Kind::Array(flags) = &value.kind {
        if flags.len() != system.groups.len() {
            let expected = format!("one entry for each of the {} groups", system.groups.len());
            let fault = Fault::expected(value.span, expected, flags.len().to_string());
            return Err(FieldFault::new(field, fault));
        }
        for (group, flag) in system.groups.iter_mut().zip(flags) {
            group.homogeneous = flag.bool("true or false").map_err(at(field))?;
        }
    } else {
        let flag = value
            .bool("true, false or a list of them")
            .map_err(at(field))?;
        system
            .groups
            .iter_mut()
            .for_each(|group| group.homogeneous = flag);
    }
    Ok(())
}

fn conjugates(system: &mut System, value: &Value<'_>) -> Result<(), FieldFault> {
    let mut seen = vec![false; system.variables.len()];
    for (i, pair) in array(value, "conjugates")?.iter().enumerate() {
        let field = format!("conjugates[{i}]");
        let members = array(pair, &field)?;
        let [first, second] = members else {
            let fault = Fault::expected(pair.span, "two variables", members.len().to_string());
            return Err(FieldFault::new(field, fault));
        };
        let mut index = |value| {
            let index = variable(value, &system.variables)?;
            if std::mem::replace(&mut seen[index], true) {
                let first = "has a conjugate already".into();
                let name = system.variables[index].clone();
                return Err(Fault::new(value.span, What::DuplicateName { name, first }));
            }
            Ok(index)
        };
        let pair = index(first)
            .and_then(|a| Ok((a, index(second)?)))
            .map_err(at(&field))?;
        system.conjugates.push(pair);
    }
    Ok(())
}
