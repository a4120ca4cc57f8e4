//! A system in our JSON, with everything that it has but the names of its equations.

use crate::expression::NodeId;
use crate::expression::display::{Display, Style};
use crate::expression::parse::Dialect;
use crate::formats::Format;
use crate::formats::json_value::quote;
use crate::formats::parts::Parts;
use crate::formats::sharing::{self, Sharing, WriteError};
use crate::system::{DegenerateSet, SymmetryGenerator, System};
use std::collections::HashSet;

/// Writes a system in our JSON.
pub fn write(system: &System) -> Result<String, WriteError> {
    write_parts(&Parts::of_system(system))
}

/// Writes the parts of a problem in our JSON.
pub(in crate::formats) fn write_parts(parts: &Parts) -> Result<String, WriteError> {
    let system = &parts.system;
    refuse_reserved_names(parts)?;
    let names = parts.names.iter().chain(&system.parameters);
    let taken: HashSet<String> = names.cloned().collect();
    let roots = sharing::roots(system, false);
    let style = Style::BERTINI;
    // A rational map may have variables in denominators, a definition may not.
    let polynomial = system.polynomial_nodes();
    let may_share = |node: NodeId| polynomial[node.0 as usize];
    let sharing = sharing::share(system, style, &roots, taken, &may_share);
    let notation = Notation {
        parts,
        system,
        sharing: &sharing,
        display: sharing::display(system, style, &sharing.names),
    };
    let mut fields = notation.declarations();
    fields.extend(notation.definitions());
    fields.push(("equations", notation.equations()));
    fields.extend(notation.conjugates());
    fields.extend(notation.degenerate_sets());
    fields.extend(notation.symmetry());
    if !parts.conditions.is_empty() {
        fields.push(("where", quoted(&parts.conditions)));
    }
    if let Some((goal, expression)) = &parts.objective {
        fields.push((goal.name(), quote(expression)));
    }
    let fields: Vec<String> = fields
        .into_iter()
        .map(|(name, value)| format!("  \"{name}\": {value}"))
        .collect();
    Ok(format!("{{\n{}\n}}\n", fields.join(",\n")))
}

/// Refuses a system that has a name with a meaning in our notation.
fn refuse_reserved_names(parts: &Parts) -> Result<(), WriteError> {
    for name in parts.names.iter().chain(&parts.system.parameters) {
        if let Some(meaning) = Dialect::BERTINI.reserved(name) {
            let (name, format) = (name.clone(), Format::Json);
            return Err(WriteError::ReservedName {
                name,
                format,
                meaning,
            });
        }
    }
    Ok(())
}

/// A field of the problem: its name, and its value in JSON.
type Field = (&'static str, String);

/// The notation of one system: names of shared subexpressions, and the text of each expression.
struct Notation<'s> {
    parts: &'s Parts,
    system: &'s System,
    sharing: &'s Sharing,
    display: Display<'s>,
}

impl Notation<'_> {
    /// Variables with their groups, parameters and the path variable.
    fn declarations(&self) -> Vec<Field> {
        let system = self.system;
        let groups = system
            .groups
            .iter()
            .map(|g| list(g.variables.iter().map(|v| self.variable(v)).collect()));
        let homogeneous = system.groups.iter().map(|g| g.homogeneous.to_string());
        let mut fields = vec![
            ("variables", quoted(&self.parts.declared_names())),
            ("groups", list(groups.collect())),
            ("homogeneous", list(homogeneous.collect())),
        ];
        if !system.parameters.is_empty() {
            fields.push(("parameters", quoted(&system.parameters)));
        }
        if let Some(path_variable) = system.path_variable {
            fields.push(("path_variable", quote(&system.parameters[path_variable])));
        }
        fields
    }

    /// Definitions of the shared subexpressions.
    fn definitions(&self) -> Option<Field> {
        let order = &self.sharing.order;
        let definition = |node: &NodeId| {
            format!(
                "{}: {}",
                quote(&self.sharing.names[node]),
                quote(&self.display.text(*node))
            )
        };
        (!order.is_empty()).then(|| {
            (
                "definitions",
                block(order.iter().map(definition).collect(), "{", "}"),
            )
        })
    }

    fn equations(&self) -> String {
        let equations = self.system.equations.iter();
        block(equations.map(|e| self.expression(e)).collect(), "[", "]")
    }

    fn conjugates(&self) -> Option<Field> {
        let conjugates = &self.system.conjugates;
        let pair = |(a, b): &(usize, usize)| list(vec![self.variable(a), self.variable(b)]);
        (!conjugates.is_empty())
            .then(|| ("conjugates", list(conjugates.iter().map(pair).collect())))
    }

    fn degenerate_sets(&self) -> Option<Field> {
        let sets = &self.system.degenerate;
        let set = |(name, set): (&String, &DegenerateSet)| match set {
            DegenerateSet::Nonzero(node) => {
                format!(
                    "{}: {{\"nonzero\": {}}}",
                    quote(name),
                    self.expression(node)
                )
            }
            DegenerateSet::Equations(nodes) => {
                let nodes = list(nodes.iter().map(|node| self.expression(node)).collect());
                format!("{}: {{\"equations\": {nodes}}}", quote(name))
            }
        };
        (!sets.is_empty()).then(|| {
            (
                "degenerate",
                block(sets.iter().map(set).collect(), "{", "}"),
            )
        })
    }

    fn symmetry(&self) -> Option<Field> {
        let generators = &self.system.symmetry;
        let generator = |generator: &SymmetryGenerator| match generator {
            SymmetryGenerator::Permutation(p) => {
                format!(
                    "{{\"permutation\": {{{}}}}}",
                    self.images(p.iter().map(|v| self.variable(v)))
                )
            }
            SymmetryGenerator::Map(map) => {
                format!(
                    "{{\"map\": {{{}}}}}",
                    self.images(map.iter().map(|node| self.expression(node)))
                )
            }
        };
        (!generators.is_empty()).then(|| {
            (
                "symmetry",
                block(generators.iter().map(generator).collect(), "[", "]"),
            )
        })
    }

    /// Each variable with its image under a generator.
    fn images(&self, images: impl Iterator<Item = String>) -> String {
        images
            .enumerate()
            .map(|(variable, image)| format!("{}: {image}", self.variable(&variable)))
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// An expression in quotes; the name of its definition where it is shared.
    fn expression(&self, node: &NodeId) -> String {
        match self.sharing.names.get(node) {
            Some(name) => quote(name),
            None => quote(&self.display.text(*node)),
        }
    }

    /// The name in quotes of the variable with an index.
    fn variable(&self, index: &usize) -> String {
        quote(&self.parts.names[*index])
    }
}

/// A list on one line.
fn list(items: Vec<String>) -> String {
    format!("[{}]", items.join(", "))
}

/// A list or an object with one entry on each line.
fn block(items: Vec<String>, open: &str, close: &str) -> String {
    if items.is_empty() {
        format!("{open}{close}")
    } else {
        format!("{open}\n    {}\n  {close}", items.join(",\n    "))
    }
}

/// Names in quotes.
fn quoted(names: &[String]) -> String {
    list(names.iter().map(|n| quote(n)).collect())
}
