//! Problem message to Submission, System message to a checked System.

use super::question::{question, witness_sets};
use super::{digest, finite, method, points, required};
use crate::error::{ProtocolError, within_limit};
use crate::limits;
use crate::submission::{
    Decompose, Options, PrecisionChoice, SettingsChoice, Source, StartKind, StartSolutions,
    Submission,
};
use crate::v1;
use crate::v1::options::Method;
use cognate_continuation::sharpening::MOST_DIGITS;
use cognate_continuation::tracker::settings::Preset;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_solutions::closing_options::ClosingOptions;
use cognate_solutions::witness::{self, KnownComponents};
use cognate_systems::expression::{Dependence, Expressions, Function, Node, NodeId};
use cognate_systems::formats::limits as sizes;
use cognate_systems::helper_unknown::{AngleUnknowns, Branch, Helper, RootUnknown};
use cognate_systems::scaling::Scaling;
use cognate_systems::system::{DegenerateSet, SymmetryGenerator, System, VariableGroup};
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Most loops in a row without anything new in a decomposition.
const MOST_IDLE_LOOPS: u32 = 200;

/// What a client asks for.
pub fn submission(message: v1::Problem) -> Result<Submission, ProtocolError> {
    let source = match required("source", message.source)? {
        v1::problem::Source::System(m) => {
            let mut system = system(&m).map_err(|e| e.within("system"))?;
            // What works with parts of a system takes equations by their names, too.
            if system.equation_names.is_empty() {
                let names = (1..=system.equation_count()).map(|i| format!("equation {i}"));
                system.equation_names = names.collect();
            }
            Source::System(Box::new(system))
        }
        v1::problem::Source::Text(m) => {
            within_limit("text.name", m.name.len(), limits::NAME_BYTES)?;
            within_limit("text.content", m.content.len(), sizes::FILE_BYTES)?;
            Source::Text {
                name: if m.name.is_empty() {
                    "problem".to_owned()
                } else {
                    m.name
                },
                content: m.content.to_vec(),
            }
        }
    };
    let options = options(message.options.unwrap_or_default()).map_err(|e| e.within("options"))?;
    Ok(Submission { source, options })
}

/// How a problem is to be solved.
pub fn options(m: v1::Options) -> Result<Options, ProtocolError> {
    let (m, method) = method::unfolded(m)?;
    without_method(m).map_err(|error| method::placed(error, method))
}

/// The same, where `start` says how paths begin.
fn without_method(m: v1::Options) -> Result<Options, ProtocolError> {
    within_limit("name", m.name.len(), limits::NAME_BYTES)?;
    within_limit("warnings", m.warnings.len(), limits::WARNINGS)?;
    for (i, warning) in m.warnings.iter().enumerate() {
        within_limit(at("warnings", i), warning.len(), limits::WARNING_BYTES)?;
    }
    within_limit("groups", m.groups.len(), sizes::VARIABLES)?;
    within_limit("conjugates", m.conjugates.len(), sizes::VARIABLES)?;
    within_limit(
        "start_parameters",
        m.start_parameters.len(),
        sizes::PARAMETERS,
    )?;
    within_limit(
        "target_parameters",
        m.target_parameters.len(),
        limits::TARGETS,
    )?;
    let start_parameters = complexes("start_parameters", &m.start_parameters)?;
    let target_parameters = m
        .target_parameters
        .iter()
        .enumerate()
        .map(|(i, t)| {
            complexes("values", &t.values).map_err(|e| e.within(at("target_parameters", i)))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let lengths = |i: usize| target_parameters.get(i).map(Vec::len);
    if let Some(i) = (1..target_parameters.len()).find(|&i| lengths(i) != lengths(0)) {
        return Err(ProtocolError::invalid(
            at("target_parameters", i),
            format!("{} values", target_parameters[i].len()),
            format!("{} values, as in the first set", target_parameters[0].len()),
        ));
    }
    let start_solutions = match m.start_solutions.and_then(|s| s.source) {
        None => None,
        Some(v1::start_solutions::Source::Points(p)) => Some(StartSolutions::Points(
            points(&p).map_err(|e| e.within("start_solutions.points"))?,
        )),
        Some(v1::start_solutions::Source::Object(bytes)) => Some(StartSolutions::Object(digest(
            "start_solutions.object",
            &bytes,
        )?)),
    };
    let (decompose, question) = match m.method {
        Some(Method::Decompose(m)) => (Some(decompose(m)?), None),
        Some(Method::Question(m)) => (None, Some(question(m)?)),
        _ => (None, None),
    };
    Ok(Options {
        start: match v1::StartKind::try_from(m.start) {
            Ok(v1::StartKind::Unspecified | v1::StartKind::Auto) => StartKind::Auto,
            Ok(v1::StartKind::TotalDegree) => StartKind::TotalDegree,
            Ok(v1::StartKind::Multihomogeneous) => StartKind::Multihomogeneous,
            Ok(v1::StartKind::Given) => StartKind::Given,
            Ok(v1::StartKind::Monodromy) => StartKind::Monodromy,
            Ok(v1::StartKind::Polyhedral) => StartKind::Polyhedral,
            Ok(v1::StartKind::LinearProduct) => StartKind::LinearProduct,
            Ok(v1::StartKind::Regeneration) => StartKind::Regeneration,
            Err(_) => {
                return Err(ProtocolError::invalid(
                    "start",
                    m.start,
                    "a start kind that this version knows",
                ));
            }
        },
        groups: (!m.groups.is_empty()).then(|| m.groups.into_iter().map(|g| g.names).collect()),
        conjugates: m
            .conjugates
            .into_iter()
            .map(|p| (p.first, p.second))
            .collect(),
        seed: m.seed,
        settings: settings(&m.settings.unwrap_or_default()).map_err(|e| e.within("settings"))?,
        precision: match m.precision.and_then(|p| p.kind) {
            None | Some(v1::precision::Kind::Adaptive(_)) => PrecisionChoice::Adaptive,
            Some(v1::precision::Kind::Double(_)) => PrecisionChoice::Double,
            Some(v1::precision::Kind::Bits(bits)) => {
                if bits < 53 {
                    return Err(ProtocolError::invalid(
                        "precision.bits",
                        bits,
                        "at least 53",
                    ));
                }
                within_limit("precision.bits", bits as usize, limits::PRECISION_BITS)?;
                PrecisionChoice::Bits(bits)
            }
        },
        start_parameters,
        target_parameters,
        start_solutions,
        name: m.name,
        idle_loops: m.idle_loops,
        expected_solutions: m.expected_solutions,
        closings: ClosingOptions {
            certify: m.certify,
            digits: digits(m.digits)?,
            deflate: m.deflate,
            no_exact_count: m.no_exact_count,
        },
        trace_test: m.trace_test,
        confidence: confidence(m.confidence)?,
        warnings: m.warnings,
        sets: match m.sets.is_empty() {
            true => None,
            false => Some(equation_sets("sets", &m.sets)?),
        },
        decompose,
        question,
    })
}

fn confidence(confidence: Option<f64>) -> Result<Option<f64>, ProtocolError> {
    match confidence {
        Some(p) if !(p > 0.0 && p < 1.0) => {
            let expected = "a probability between 0 and 1, both excluded";
            Err(ProtocolError::invalid("confidence", p, expected))
        }
        confidence => Ok(confidence),
    }
}

fn digits(digits: Option<u32>) -> Result<Option<u32>, ProtocolError> {
    match digits {
        Some(digits) if !(1..=MOST_DIGITS).contains(&digits) => {
            let expected = format!("1 to {MOST_DIGITS}");
            Err(ProtocolError::invalid("digits", digits, expected))
        }
        digits => Ok(digits),
    }
}

fn decompose(m: v1::Decompose) -> Result<Decompose, ProtocolError> {
    let dimensions = match (m.lowest_dimension, m.highest_dimension) {
        (None, None) => None,
        (Some(lowest), Some(highest)) if lowest <= highest => Some([lowest, highest]),
        (Some(lowest), highest) => {
            return Err(ProtocolError::invalid(
                "decompose.highest_dimension",
                highest.map_or("nothing".to_owned(), |n| n.to_string()),
                format!("a number from {lowest}, the lowest dimension"),
            ));
        }
        (None, Some(_)) => return Err(ProtocolError::missing("decompose.lowest_dimension")),
    };
    if let Some(loops) = m.idle_loops
        && !(1..=MOST_IDLE_LOOPS).contains(&loops)
    {
        let expected = format!("1 to {MOST_IDLE_LOOPS}");
        return Err(ProtocolError::invalid(
            "decompose.idle_loops",
            loops,
            expected,
        ));
    }
    let method = match m.method.map(v1::DecompositionMethod::try_from) {
        None => None,
        Some(Ok(v1::DecompositionMethod::Cascade)) => Some(witness::Method::Cascade),
        Some(Ok(v1::DecompositionMethod::Equations)) => Some(witness::Method::Equations),
        Some(Ok(v1::DecompositionMethod::Slices)) => Some(witness::Method::Slices),
        Some(Ok(v1::DecompositionMethod::Unspecified) | Err(_)) => {
            return Err(ProtocolError::invalid(
                "decompose.method",
                m.method.unwrap_or_default(),
                "cascade, equations or slices",
            ));
        }
    };
    let known = match m.known {
        None => None,
        Some(known) => Some(KnownComponents {
            equations: known.equations,
            components: witness_sets(known.components).map_err(|e| e.within("decompose.known"))?,
            parameters: {
                let (field, values) = ("decompose.known.parameters", &known.parameters);
                within_limit(field, values.len(), sizes::PARAMETERS)?;
                complexes(field, values)?
            },
        }),
    };
    Ok(Decompose {
        dimensions,
        idle_loops: m.idle_loops,
        method,
        verify: m.verify,
        without_split: m.without_split,
        known,
    })
}

/// The sets of each equation of a linear-product start; `field` names them.
pub fn equation_sets(
    field: &str,
    equations: &[v1::EquationSets],
) -> Result<Vec<Vec<Vec<u32>>>, ProtocolError> {
    within_limit(field, equations.len(), sizes::EQUATIONS)?;
    for (i, equation) in equations.iter().enumerate() {
        let field = format!("{field}[{i}].sets");
        within_limit(&field, equation.sets.len(), limits::FACTORS)?;
        for set in &equation.sets {
            within_limit(&field, set.variables.len(), sizes::VARIABLES)?;
        }
    }
    let sets = |equation: &v1::EquationSets| {
        let sets = equation.sets.iter();
        sets.map(|set| set.variables.clone()).collect()
    };
    Ok(equations.iter().map(sets).collect())
}

/// A choice of settings, every number in its range.
pub fn settings(m: &v1::Settings) -> Result<SettingsChoice, ProtocolError> {
    let preset = match v1::Preset::try_from(m.preset) {
        Ok(v1::Preset::Unspecified) => None,
        Ok(v1::Preset::Careful) => Some(Preset::Careful),
        Ok(v1::Preset::Default) => Some(Preset::Default),
        Ok(v1::Preset::Fast) => Some(Preset::Fast),
        Ok(v1::Preset::Reckless) => Some(Preset::Reckless),
        Err(_) => {
            return Err(ProtocolError::invalid(
                "preset",
                m.preset,
                "a preset that this version knows",
            ));
        }
    };
    SettingsChoice::from_message(m, preset)
}

/// Complex numbers, all finite.
pub(super) fn complexes(field: &str, m: &[v1::Complex]) -> Result<Vec<Complex64>, ProtocolError> {
    let values: Vec<_> = m.iter().map(|z| Complex64::new(z.re, z.im)).collect();
    finite(field, &values)?;
    Ok(values)
}

fn at(field: &str, index: usize) -> String {
    format!("{field}[{index}]")
}

/// A system, checked as a file would be.
pub fn system(m: &v1::System) -> Result<System, ProtocolError> {
    within_limit("variables", m.variables.len(), sizes::VARIABLES)?;
    within_limit("parameters", m.parameters.len(), sizes::PARAMETERS)?;
    within_limit("equations", m.equations.len(), sizes::EQUATIONS)?;
    within_limit("groups", m.groups.len(), sizes::VARIABLES)?;
    within_limit("nodes", m.nodes.len(), sizes::NODES)?;
    within_limit("conjugates", m.conjugates.len(), sizes::VARIABLES)?;
    within_limit("degenerate", m.degenerate.len(), limits::DEGENERATE_SETS)?;
    within_limit("unit_exponents", m.unit_exponents.len(), sizes::VARIABLES)?;
    within_limit("helpers", m.helpers.len(), sizes::VARIABLES)?;
    within_limit("symmetry", m.symmetry.len(), limits::SYMMETRY_GENERATORS)?;
    for (field, names) in [("variables", &m.variables), ("parameters", &m.parameters)] {
        for (i, name) in names.iter().enumerate() {
            check_name(name).map_err(|e| e.within(at(field, i)))?;
        }
    }
    let mut graph = Graph {
        variables: m.variables.len(),
        parameters: m.parameters.len(),
        expressions: Expressions::new(),
        nodes: Vec::with_capacity(m.nodes.len()),
        degrees: Vec::with_capacity(m.nodes.len()),
    };
    for (i, node) in m.nodes.iter().enumerate() {
        graph.push(node).map_err(|e| e.within(at("nodes", i)))?;
    }
    let variable = |field: String, index: u32| variable(field, index, m.variables.len());
    let mut groups = m
        .groups
        .iter()
        .enumerate()
        .map(|(g, group)| {
            within_limit(at("groups", g), group.variables.len(), sizes::VARIABLES)?;
            let variables = group
                .variables
                .iter()
                .map(|&v| variable(at("groups", g), v))
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
    let equations = m
        .equations
        .iter()
        .enumerate()
        .map(|(i, e)| {
            let field = at("equations", i);
            within_limit(field.as_str(), e.name.len(), limits::NAME_BYTES)?;
            let node = graph.node(&field, e.node)?;
            let degree = graph.degrees[e.node as usize];
            within_limit(
                field,
                usize::try_from(degree).unwrap_or(usize::MAX),
                sizes::DEGREE,
            )?;
            Ok(node)
        })
        .collect::<Result<Vec<_>, ProtocolError>>()?;
    let path_variable = m
        .path_variable
        .map(|p| index("path_variable", p, m.parameters.len(), "parameters"))
        .transpose()?;
    let conjugates = m
        .conjugates
        .iter()
        .enumerate()
        .map(|(i, pair)| {
            Ok((
                variable(at("conjugates", i), pair.first)?,
                variable(at("conjugates", i), pair.second)?,
            ))
        })
        .collect::<Result<Vec<_>, ProtocolError>>()?;
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
    let symmetry = m
        .symmetry
        .iter()
        .enumerate()
        .map(|(i, generator)| {
            graph
                .generator(generator)
                .map_err(|e| e.within(at("symmetry", i)))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let helpers = m.helpers.iter().enumerate().map(|(i, message)| {
        let helper = graph.helper(message);
        helper.map_err(|e| e.within(at("helpers", i)))
    });
    let helpers = helpers.collect::<Result<Vec<_>, _>>()?;
    let system = System {
        expressions: graph.expressions,
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

/// An exact rational, `p` or `p/q`.
pub fn rational(text: &str) -> Result<Rational, ProtocolError> {
    if text.is_empty() {
        return Ok(Rational::new());
    }
    let limit = limits::Limit {
        value: 2 * sizes::NUMBER_DIGITS.value,
        ..sizes::NUMBER_DIGITS
    };
    within_limit("", text.len(), limit)?;
    let expected = "`p` or `p/q` with decimal integers and q not 0";
    let bad = || ProtocolError::invalid("", format!("`{text}`"), expected);
    let number = text.strip_prefix('-').unwrap_or(text);
    let (p, q) = number.split_once('/').unwrap_or((number, "1"));
    let decimal = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    if !decimal(p) || !decimal(q) || q.bytes().all(|b| b == b'0') {
        return Err(bad());
    }
    Rational::parse(text).map(Rational::from).map_err(|_| bad())
}

fn check_name(name: &str) -> Result<(), ProtocolError> {
    within_limit("", name.len(), limits::NAME_BYTES)?;
    if name.is_empty() || name.chars().any(|c| c.is_control() || c.is_whitespace()) {
        return Err(ProtocolError::invalid(
            "",
            format!("{name:?}"),
            "a name without spaces",
        ));
    }
    Ok(())
}

fn index(
    field: impl Into<String>,
    index: u32,
    count: usize,
    what: &str,
) -> Result<usize, ProtocolError> {
    let found = index as usize;
    if found < count {
        return Ok(found);
    }
    Err(ProtocolError::invalid(
        field,
        found,
        format!("an index below the number of {what}, {count}"),
    ))
}

fn variable(field: String, v: u32, count: usize) -> Result<usize, ProtocolError> {
    index(field, v, count, "variables")
}

/// The graph as far as it has been read.
struct Graph {
    variables: usize,
    parameters: usize,
    expressions: Expressions,
    /// Where each node of the message stands in the arena: equal nodes are one there.
    nodes: Vec<NodeId>,
    /// Degree in the variables, an upper bound.
    degrees: Vec<u64>,
}

impl Graph {
    fn node(&self, field: &str, i: u32) -> Result<NodeId, ProtocolError> {
        index(field, i, self.nodes.len(), "nodes").map(|i| self.nodes[i])
    }

    fn list(&self, field: &str, list: &[u32]) -> Result<Vec<NodeId>, ProtocolError> {
        within_limit(field, list.len(), sizes::EQUATIONS)?;
        list.iter().map(|&i| self.node(field, i)).collect()
    }

    fn helper(&self, m: &v1::Helper) -> Result<Helper, ProtocolError> {
        use v1::helper::Kind;
        let at = |field: &str, v| variable(field.into(), v, self.variables);
        Ok(match required("kind", m.kind.as_ref())? {
            Kind::Root(root) => Helper::Root(RootUnknown {
                variable: at("root.variable", root.variable)?,
                degree: root.degree,
                radicand: self.node("root.radicand", root.radicand)?,
                branch: match root.real {
                    true => Branch::Real,
                    false => Branch::Principal,
                },
            }),
            Kind::Angle(angle) => {
                check_name(&angle.name).map_err(|e| e.within("angle.name"))?;
                Helper::Angle(AngleUnknowns {
                    name: angle.name.clone(),
                    cosine: at("angle.cosine", angle.cosine)?,
                    sine: at("angle.sine", angle.sine)?,
                })
            }
        })
    }

    fn operand(&self, field: &str, i: u32) -> Result<(NodeId, u64), ProtocolError> {
        index(field, i, self.nodes.len(), "the nodes before this one")
            .map(|i| (self.nodes[i], self.degrees[i]))
    }

    fn constant_operand(&self, field: &str, i: u32) -> Result<NodeId, ProtocolError> {
        let (id, _) = self.operand(field, i)?;
        if self.expressions.dependence(id) == Dependence::Constant {
            return Ok(id);
        }
        Err(ProtocolError::invalid(
            field,
            format!("node {i}, which is not constant"),
            "a constant",
        ))
    }

    fn push(&mut self, m: &v1::Node) -> Result<(), ProtocolError> {
        use v1::node::Kind;
        let both = |graph: &Self, m: &v1::Binary| {
            Ok::<_, ProtocolError>((
                graph.operand("left", m.left)?,
                graph.operand("right", m.right)?,
            ))
        };
        let (node, degree) = match required("kind", m.kind.as_ref())? {
            Kind::Constant(z) => (
                Node::Constant(ComplexRational {
                    re: rational(&z.re).map_err(|e| e.within("constant.re"))?,
                    im: rational(&z.im).map_err(|e| e.within("constant.im"))?,
                }),
                0,
            ),
            Kind::Variable(v) => {
                index("variable", *v, self.variables, "variables")?;
                (Node::Variable(*v), 1)
            }
            Kind::Parameter(p) => {
                index("parameter", *p, self.parameters, "parameters")?;
                (Node::Parameter(*p), 0)
            }
            Kind::Add(m) => {
                let ((a, d), (b, e)) = both(self, m).map_err(|e| e.within("add"))?;
                (Node::Add(a, b), d.max(e))
            }
            Kind::Subtract(m) => {
                let ((a, d), (b, e)) = both(self, m).map_err(|e| e.within("subtract"))?;
                (Node::Subtract(a, b), d.max(e))
            }
            Kind::Multiply(m) => {
                let ((a, d), (b, e)) = both(self, m).map_err(|e| e.within("multiply"))?;
                (Node::Multiply(a, b), d.saturating_add(e))
            }
            Kind::Divide(m) => {
                let ((a, d), (b, _)) = both(self, m).map_err(|e| e.within("divide"))?;
                let zero = self
                    .expressions
                    .as_constant(b)
                    .is_some_and(ComplexRational::is_zero);
                if zero {
                    return Err(ProtocolError::invalid(
                        "divide.right",
                        "0",
                        "a denominator that is not 0",
                    ));
                }
                // Variables may stand in the denominators of a rational map, and nowhere
                // else: `System::check` looks at that.
                (Node::Divide(a, b), d)
            }
            Kind::Negate(a) => {
                let (a, d) = self.operand("negate", *a)?;
                (Node::Negate(a), d)
            }
            Kind::Power(m) => {
                let (a, d) = self.operand("power.base", m.base)?;
                if m.exponent < 2 {
                    return Err(ProtocolError::invalid(
                        "power.exponent",
                        m.exponent,
                        "at least 2",
                    ));
                }
                within_limit("power.exponent", m.exponent as usize, sizes::EXPONENT)?;
                (
                    Node::Power(a, m.exponent),
                    d.saturating_mul(u64::from(m.exponent)),
                )
            }
            Kind::Root(m) => {
                let a = self.constant_operand("root.base", m.base)?;
                let exponent = rational(&m.exponent).map_err(|e| e.within("root.exponent"))?;
                let size = exponent
                    .numer()
                    .to_i64()
                    .map(i64::unsigned_abs)
                    .max(exponent.denom().to_u64());
                let small = exponent.numer().to_i64().is_some()
                    && exponent.denom().to_u64().is_some()
                    && size <= Some(sizes::EXPONENT.value);
                if !small {
                    return Err(ProtocolError::invalid(
                        "root.exponent",
                        &m.exponent,
                        format!(
                            "numerator and denominator up to the limit EXPONENT of {}",
                            sizes::EXPONENT.value
                        ),
                    ));
                }
                (Node::Root(a, exponent), 0)
            }
            Kind::Function(m) => {
                let a = self.constant_operand("function.argument", m.argument)?;
                let function = match v1::Function::try_from(m.function) {
                    Ok(v1::Function::SquareRoot) => Function::SquareRoot,
                    Ok(v1::Function::Exponential) => Function::Exponential,
                    Ok(v1::Function::Logarithm) => Function::Logarithm,
                    Ok(v1::Function::Sine) => Function::Sine,
                    Ok(v1::Function::Cosine) => Function::Cosine,
                    Ok(v1::Function::Tangent) => Function::Tangent,
                    Ok(v1::Function::Pi) => {
                        let zero = self.expressions.as_constant(a);
                        if !zero.is_some_and(ComplexRational::is_zero) {
                            return Err(ProtocolError::invalid(
                                "function.argument",
                                format!("node {}", m.argument),
                                "the constant 0 as the argument of pi",
                            ));
                        }
                        Function::Pi
                    }
                    Ok(v1::Function::Unspecified) | Err(_) => {
                        return Err(ProtocolError::invalid(
                            "function.function",
                            m.function,
                            "a function that this version knows",
                        ));
                    }
                };
                (Node::Function(function, a), 0)
            }
        };
        self.nodes.push(self.expressions.insert(node));
        self.degrees.push(degree);
        Ok(())
    }

    fn generator(&self, m: &v1::SymmetryGenerator) -> Result<SymmetryGenerator, ProtocolError> {
        let count = |field: &str, n: usize| {
            if n == self.variables {
                return Ok(());
            }
            Err(ProtocolError::invalid(
                field,
                format!("{n} entries"),
                format!("one for each of the {} variables", self.variables),
            ))
        };
        match required("action", m.action.as_ref())? {
            v1::symmetry_generator::Action::Permutation(p) => {
                count("permutation", p.images.len())?;
                let images = p
                    .images
                    .iter()
                    .map(|&v| variable("permutation".to_owned(), v, self.variables))
                    .collect::<Result<Vec<_>, _>>()?;
                let mut seen = vec![false; self.variables];
                for &v in &images {
                    if std::mem::replace(&mut seen[v], true) {
                        return Err(ProtocolError::invalid(
                            "permutation",
                            format!("variable {v} twice"),
                            "every variable once",
                        ));
                    }
                }
                Ok(SymmetryGenerator::Permutation(images))
            }
            v1::symmetry_generator::Action::Map(list) => {
                count("map", list.nodes.len())?;
                Ok(SymmetryGenerator::Map(self.list("map", &list.nodes)?))
            }
        }
    }
}
