//! Our own JSON problem, as the contract has it.
//!
//! Added to the contract's fields: `homogeneous` may be a list with one entry
//! for each group, and `path_variable` names the parameter of a user homotopy.

use super::json_value::{self, Value};
use super::limits::{self, Limit};
use super::scope::{FieldFault, Scope, at, variable};
use super::sharing::{self, WriteError};
use super::{
    FileSettings, Format, FormatError, Problem, Source, conditions, degenerate, finish,
    free_objective, symmetry,
};
use crate::condition::Conditions;
use crate::expression::NodeId;
use crate::expression::build::Use;
use crate::expression::display::Style;
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::parse::Dialect;
use crate::expression::similar::meant;
use crate::expression::token::shorten;
use crate::objective::{Goal, Objective};
use crate::system::{DegenerateSet, SymmetryGenerator, System, VariableGroup};
use std::collections::{HashMap, HashSet};

/// The fields of a problem.
const FIELDS: [&str; 15] = [
    "variables",
    "groups",
    "homogeneous",
    "parameters",
    "path_variable",
    "definitions",
    "equations",
    "conjugates",
    "degenerate",
    "symmetry",
    "where",
    "complementary",
    "minimize",
    "maximize",
    "critical",
];

/// Reads a problem in our JSON.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    let mut conditions = Conditions::default();
    let mut objective = None;
    let read = system(source, &mut conditions, &mut objective);
    let (system, data_accuracy) = read.map_err(|fault| fault.into_error(source))?;
    let settings = FileSettings {
        user_homotopy: system.path_variable.is_some(),
        data_accuracy,
        ..FileSettings::default()
    };
    Ok(Problem {
        system,
        settings,
        format: Format::Json,
        warnings: Vec::new(),
        conditions,
        objective,
    })
}

/// The system, and the relative accuracy of its decimals.
fn system(
    source: &Source<'_>,
    conditions: &mut Conditions,
    objective: &mut Option<Objective>,
) -> Result<(System, f64), FieldFault> {
    let text = source.text;
    let root = json_value::parse(text, 0, text.len()).map_err(at(""))?;
    let mut fields: HashMap<&str, &Value<'_>> = HashMap::new();
    for (name, value) in root
        .object("a JSON object with a problem")
        .map_err(at(""))?
    {
        let Some(&known) = FIELDS.iter().find(|&&f| f == name.text) else {
            let end = name.start + name.text.len();
            let fault = Fault::expected(
                Span {
                    start: name.start,
                    end,
                },
                match meant(&name.text, FIELDS) {
                    Some(field) => {
                        format!("one of the fields {}; perhaps {field}", FIELDS.join(", "))
                    }
                    None => format!("one of the fields {}", FIELDS.join(", ")),
                },
                format!("\"{}\"", shorten(&name.text)),
            );
            return Err(FieldFault::new("", fault));
        };
        fields.insert(known, value);
    }
    let end = Span {
        start: root.span.end.saturating_sub(1),
        end: root.span.end,
    };
    let required = |name: &str| {
        let missing = || {
            Fault::expected(
                end,
                format!("the field \"{name}\""),
                "the end of the problem",
            )
        };
        fields
            .get(name)
            .copied()
            .ok_or_else(|| FieldFault::new("", missing()))
    };
    let mut scope = Scope::default();
    let mut system = System::default();
    for (i, value) in limited(required("variables")?, "variables", limits::VARIABLES)?
        .iter()
        .enumerate()
    {
        let field = format!("variables[{i}]");
        let node = scope.builder.expressions.variable(i as u32);
        system
            .variables
            .push(declare(&mut scope, value, &field, "a variable", node)?);
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
                .push(declare(&mut scope, value, &field, "a parameter", node)?);
        }
    }
    if let Some(value) = fields.get("path_variable") {
        let field = "path_variable";
        let name = value.text("the name of a parameter").map_err(at(field))?;
        let index = system.parameters.iter().position(|p| *p == name.text);
        let missing = || Fault::expected(value.span, "the name of a parameter", value.describe());
        system.path_variable = Some(index.ok_or_else(|| FieldFault::new(field, missing()))?);
    }
    let definitions_value = fields.get("definitions").copied();
    define(&mut scope, definitions_value)?;
    let mut places = Vec::new();
    for goal in Goal::ALL {
        let Some(value) = fields.get(goal.name()) else {
            continue;
        };
        let written = scope.parse(value, goal.name().into())?;
        if objective.is_some() {
            let fault = Fault::expected(value.span, "one objective", "another one");
            return Err(FieldFault::new(goal.name(), fault));
        }
        *objective = Some(Objective {
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
    // An objective may be all that is given.
    let equations = match fields.get("equations") {
        None if objective.is_some() => &[][..],
        _ => limited(required("equations")?, "equations", limits::EQUATIONS)?,
    };
    for (i, value) in equations.iter().enumerate() {
        let written = scope.parse_equation(value, format!("equations[{i}]"))?;
        system.equations.push(scope.build(&written, Use::Rational)?);
        system.equation_names.push(format!("f{}", i + 1));
        places.push(written.span());
    }
    if let Some(value) = fields.get("complementary") {
        for (product, place) in conditions::products(value, &mut scope)? {
            system.equations.push(product);
            system
                .equation_names
                .push(format!("f{}", system.equations.len()));
            places.push(place);
        }
    }
    groups(
        &mut system,
        fields.get("groups").copied(),
        fields.get("homogeneous").copied(),
    )?;
    if let Some(value) = fields.get("conjugates") {
        conjugates(&mut system, value)?;
    }
    if let Some(value) = fields.get("degenerate") {
        system.degenerate = degenerate::sets(value, "degenerate", &mut scope)?;
    }
    if let Some(value) = fields.get("symmetry") {
        system.symmetry = symmetry::generators(value, "symmetry", &system.variables, &mut scope)?;
    }
    let by_place = |fault: Fault| {
        let i = places.iter().position(|p| *p == fault.span);
        let field = i.map_or(String::new(), |i| format!("equations[{i}]"));
        FieldFault::new(field, fault)
    };
    scope
        .builder
        .hand_over(&mut system, &places)
        .map_err(by_place)?;
    free_objective(&mut system, objective).map_err(at(""))?;
    let variables = required("variables")?.span;
    let equations = fields.get("equations").map_or(end, |value| value.span);
    let finished = finish(system, &places, end).map(|system| (system, scope.data_accuracy()));
    let finished = finished.map_err(|mut fault| match &fault.problem {
        What::ConstantEquation(_) | What::Limit { .. } => by_place(fault),
        What::NoVariables => {
            fault.span = variables;
            FieldFault::new("variables", fault)
        }
        What::NoEquations => {
            fault.span = equations;
            FieldFault::new("equations", fault)
        }
        _ => FieldFault::new("", fault),
    })?;
    if fields.contains_key("complementary") || fields.contains_key("where") {
        let mut scope = Scope::of(&finished.0.typed_system());
        define(&mut scope, definitions_value)?;
        if let Some(value) = fields.get("complementary") {
            conditions::complementary(value, &mut scope, conditions)?;
        }
        if let Some(value) = fields.get("where") {
            selection(value, &mut scope, conditions)?;
        }
        conditions.expressions = scope.into_expressions();
    }
    Ok(finished)
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

/// An array with at most so many entries.
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
                let found = format!("`{}` in none", system.variables[missing]);
                let fault = Fault::expected(value.span, "every variable in a group", found);
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

/// Writes a system in our JSON, with everything that it has but the names of its equations.
pub fn write(system: &System) -> Result<String, WriteError> {
    let quote = json_value::quote;
    let names = || system.variables.iter().chain(&system.parameters);
    for name in names() {
        if let Some(meaning) = Dialect::BERTINI.reserved(name) {
            let (name, format) = (name.clone(), Format::Json);
            return Err(WriteError::ReservedName {
                name,
                format,
                meaning,
            });
        }
    }
    let taken: HashSet<String> = names().cloned().collect();
    let roots = sharing::roots(system, false);
    let style = Style::BERTINI;
    // A rational map may have variables in denominators, a definition may not.
    let polynomial = system.polynomial_nodes();
    let may_share = |node: NodeId| polynomial[node.0 as usize];
    let sharing = sharing::share(system, style, &roots, taken, &may_share);
    let display = sharing::display(system, style, &sharing.names);
    let expression = |node: &NodeId| match sharing.names.get(node) {
        Some(name) => quote(name),
        None => quote(&display.text(*node)),
    };
    let list = |items: Vec<String>| format!("[{}]", items.join(", "));
    let block = |items: Vec<String>, open, close| match items.is_empty() {
        true => format!("{open}{close}"),
        false => format!("{open}\n    {}\n  {close}", items.join(",\n    ")),
    };
    let variable = |v: &usize| quote(&system.variables[*v]);
    let quoted = |names: &[String]| list(names.iter().map(|n| quote(n)).collect());
    let groups = system
        .groups
        .iter()
        .map(|g| list(g.variables.iter().map(variable).collect()));
    let homogeneous = system.groups.iter().map(|g| g.homogeneous.to_string());
    let mut fields = vec![
        ("variables", quoted(&system.variables)),
        ("groups", list(groups.collect())),
        ("homogeneous", list(homogeneous.collect())),
    ];
    if !system.parameters.is_empty() {
        fields.push(("parameters", quoted(&system.parameters)));
    }
    if let Some(path_variable) = system.path_variable {
        fields.push(("path_variable", quote(&system.parameters[path_variable])));
    }
    if !sharing.order.is_empty() {
        let definition = |node: &NodeId| {
            format!(
                "{}: {}",
                quote(&sharing.names[node]),
                quote(&display.text(*node))
            )
        };
        fields.push((
            "definitions",
            block(sharing.order.iter().map(definition).collect(), "{", "}"),
        ));
    }
    fields.push((
        "equations",
        block(system.equations.iter().map(expression).collect(), "[", "]"),
    ));
    if !system.conjugates.is_empty() {
        let pair = |(a, b): &(usize, usize)| list(vec![variable(a), variable(b)]);
        fields.push((
            "conjugates",
            list(system.conjugates.iter().map(pair).collect()),
        ));
    }
    if !system.degenerate.is_empty() {
        let set = |(name, set): (&String, &DegenerateSet)| match set {
            DegenerateSet::Nonzero(node) => {
                format!("{}: {{\"nonzero\": {}}}", quote(name), expression(node))
            }
            DegenerateSet::Equations(nodes) => {
                let nodes = list(nodes.iter().map(expression).collect());
                format!("{}: {{\"equations\": {nodes}}}", quote(name))
            }
        };
        fields.push((
            "degenerate",
            block(system.degenerate.iter().map(set).collect(), "{", "}"),
        ));
    }
    if !system.symmetry.is_empty() {
        let image = |(i, image): (usize, String)| format!("{}: {image}", variable(&i));
        let images = |images: Vec<String>| {
            images
                .into_iter()
                .enumerate()
                .map(image)
                .collect::<Vec<_>>()
                .join(", ")
        };
        let generator = |generator: &SymmetryGenerator| match generator {
            SymmetryGenerator::Permutation(p) => {
                format!(
                    "{{\"permutation\": {{{}}}}}",
                    images(p.iter().map(variable).collect())
                )
            }
            SymmetryGenerator::Map(map) => {
                format!(
                    "{{\"map\": {{{}}}}}",
                    images(map.iter().map(expression).collect())
                )
            }
        };
        fields.push((
            "symmetry",
            block(system.symmetry.iter().map(generator).collect(), "[", "]"),
        ));
    }
    let fields: Vec<String> = fields
        .into_iter()
        .map(|(name, value)| format!("  \"{name}\": {value}"))
        .collect();
    Ok(format!("{{\n{}\n}}\n", fields.join(",\n")))
}
