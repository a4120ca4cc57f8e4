//! System message to a checked System.

use super::at;
use super::expression_graph::{Graph, check_name, index, variable};
use crate::error::{ProtocolError, within_limit};
use crate::limits;
use crate::v1;
use cognate_systems::expression::NodeId;
use cognate_systems::formats::limits as sizes;
use cognate_systems::helper_unknown::Helper;
use cognate_systems::scaling::Scaling;
use cognate_systems::system::{DegenerateSet, SymmetryGenerator, System, VariableGroup};
use std::collections::BTreeMap;

/// A system, checked as a file would be.
pub fn system(m: &v1::System) -> Result<System, ProtocolError> {
    check_sizes(m)?;
    for (field, names) in [("variables", &m.variables), ("parameters", &m.parameters)] {
        for (i, name) in names.iter().enumerate() {
            check_name(name).map_err(|e| e.within(at(field, i)))?;
        }
    }
    let graph = Graph::of_nodes(m)?;
    let groups = variable_groups(m)?;
    let equations = equations(m, &graph)?;
    let path_variable = m
        .path_variable
        .map(|p| index("path_variable", p, m.parameters.len(), "parameters"))
        .transpose()?;
    let conjugates = conjugate_pairs(m)?;
    let degenerate = degenerate_sets(m, &graph)?;
    let symmetry = symmetry_generators(m, &graph)?;
    let helpers = helpers(m, &graph)?;
    let system = System {
        expressions: graph.into_expressions(),
        variables: m.variables.clone(),
        parameters: m.parameters.clone(),
        groups,
        equations,
        equation_names: if m.equations.iter().all(|e| e.name.is_empty()) {
            Vec::new()
        } else {
            m.equations.iter().map(|e| e.name.clone()).collect()
        },
        path_variable,
        conjugates,
        degenerate,
        symmetry,
        scaling: Scaling {
            exponents: m.unit_exponents.clone(),
        },
        helpers,
    };
    system.check().map_err(|source| ProtocolError::System {
        field: String::new(),
        source,
    })?;
    Ok(system)
}

/// Refuses lists that are longer than their limits.
fn check_sizes(m: &v1::System) -> Result<(), ProtocolError> {
    within_limit("variables", m.variables.len(), sizes::VARIABLES)?;
    within_limit("parameters", m.parameters.len(), sizes::PARAMETERS)?;
    within_limit("equations", m.equations.len(), sizes::EQUATIONS)?;
    within_limit("groups", m.groups.len(), sizes::VARIABLES)?;
    within_limit("nodes", m.nodes.len(), sizes::NODES)?;
    within_limit("conjugates", m.conjugates.len(), sizes::VARIABLES)?;
    within_limit("degenerate", m.degenerate.len(), limits::DEGENERATE_SETS)?;
    within_limit("unit_exponents", m.unit_exponents.len(), sizes::VARIABLES)?;
    within_limit("helpers", m.helpers.len(), sizes::VARIABLES)?;
    within_limit("symmetry", m.symmetry.len(), limits::SYMMETRY_GENERATORS)
}

/// The groups of variables; without any, all variables are one affine group.
fn variable_groups(m: &v1::System) -> Result<Vec<VariableGroup>, ProtocolError> {
    let mut groups = m
        .groups
        .iter()
        .enumerate()
        .map(|(g, group)| {
            within_limit(at("groups", g), group.variables.len(), sizes::VARIABLES)?;
            let variables = group
                .variables
                .iter()
                .map(|&v| variable(at("groups", g), v, m.variables.len()))
                .collect::<Result<Vec<_>, _>>()?;
            Ok(VariableGroup {
                variables,
                homogeneous: group.homogeneous,
            })
        })
        .collect::<Result<Vec<_>, ProtocolError>>()?;
    if groups.is_empty() && !m.variables.is_empty() {
        groups.push(VariableGroup {
            variables: (0..m.variables.len()).collect(),
            homogeneous: false,
        });
    }
    if let Some(g) = groups.iter().position(|g| g.variables.is_empty()) {
        return Err(ProtocolError::missing(format!("groups[{g}].variables")));
    }
    Ok(groups)
}

/// The equations, with names and degrees within their limits.
fn equations(m: &v1::System, graph: &Graph) -> Result<Vec<NodeId>, ProtocolError> {
    m.equations
        .iter()
        .enumerate()
        .map(|(i, e)| {
            let field = at("equations", i);
            within_limit(field.as_str(), e.name.len(), limits::NAME_BYTES)?;
            graph.equation(field, e.node)
        })
        .collect()
}

/// The pairs of variables that complex conjugation exchanges.
fn conjugate_pairs(m: &v1::System) -> Result<Vec<(usize, usize)>, ProtocolError> {
    m.conjugates
        .iter()
        .enumerate()
        .map(|(i, pair)| {
            Ok((
                variable(at("conjugates", i), pair.first, m.variables.len())?,
                variable(at("conjugates", i), pair.second, m.variables.len())?,
            ))
        })
        .collect()
}

/// The sets of degenerate solutions by their names.
fn degenerate_sets(
    m: &v1::System,
    graph: &Graph,
) -> Result<BTreeMap<String, DegenerateSet>, ProtocolError> {
    let mut degenerate = BTreeMap::new();
    for (i, set) in m.degenerate.iter().enumerate() {
        let field = at("degenerate", i);
        within_limit(field.as_str(), set.name.len(), limits::NAME_BYTES)?;
        let value = match set.set.as_ref() {
            None => return Err(ProtocolError::missing(format!("{field}.set"))),
            Some(v1::degenerate_set::Set::Nonzero(node)) => {
                DegenerateSet::Nonzero(graph.node(&field, *node)?)
            }
            Some(v1::degenerate_set::Set::Equations(list)) => {
                DegenerateSet::Equations(graph.list(&field, &list.nodes)?)
            }
        };
        if degenerate.insert(set.name.clone(), value).is_some() {
            return Err(ProtocolError::invalid(
                format!("{field}.name"),
                format!("`{}`", set.name),
                "a name that no other set has",
            ));
        }
    }
    Ok(degenerate)
}

/// The generators of the symmetry group.
fn symmetry_generators(
    m: &v1::System,
    graph: &Graph,
) -> Result<Vec<SymmetryGenerator>, ProtocolError> {
    m.symmetry
        .iter()
        .enumerate()
        .map(|(i, generator)| {
            graph
                .generator(generator)
                .map_err(|e| e.within(at("symmetry", i)))
        })
        .collect()
}

/// The unknowns that stand for roots and angles.
fn helpers(m: &v1::System, graph: &Graph) -> Result<Vec<Helper>, ProtocolError> {
    let helpers = m.helpers.iter().enumerate().map(|(i, message)| {
        let helper = graph.helper(message);
        helper.map_err(|e| e.within(at("helpers", i)))
    });
    helpers.collect()
}
