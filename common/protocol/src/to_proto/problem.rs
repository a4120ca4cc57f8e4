//! Submission to Problem message, System to System message.

use super::question::{question, witness_set};
use super::{complexes, digest, points, small};
use crate::submission::{
    Decompose, Options, PrecisionChoice, SettingsChoice, Source, StartKind, StartSolutions,
    Submission,
};
use crate::v1;
use cognate_continuation::tracker::settings::Preset;
use cognate_solutions::witness::Method;
use cognate_systems::expression::{Function, Node, NodeId};
use cognate_systems::helper_unknown::{Branch, Helper};
use cognate_systems::system::{DegenerateSet, SymmetryGenerator, System};

/// Message of a client's submission.
pub fn submission(submission: &Submission) -> v1::Problem {
    v1::Problem {
        source: Some(match &submission.source {
            Source::System(s) => v1::problem::Source::System(system(s)),
            Source::Text { name, content } => v1::problem::Source::Text(v1::Text {
                name: name.clone(),
                content: bytes::Bytes::copy_from_slice(content),
            }),
        }),
        options: Some(options(&submission.options)),
    }
}

/// Message of the options of a solve.
pub fn options(options: &Options) -> v1::Options {
    use v1::precision::Kind;
    v1::Options {
        start: match options.start {
            StartKind::Auto => v1::StartKind::Auto,
            StartKind::TotalDegree => v1::StartKind::TotalDegree,
            StartKind::Multihomogeneous => v1::StartKind::Multihomogeneous,
            StartKind::Given => v1::StartKind::Given,
            StartKind::Monodromy => v1::StartKind::Monodromy,
            StartKind::Polyhedral => v1::StartKind::Polyhedral,
            StartKind::LinearProduct => v1::StartKind::LinearProduct,
            StartKind::Regeneration => v1::StartKind::Regeneration,
        }
        .into(),
        groups: options
            .groups
            .iter()
            .flatten()
            .map(|names| v1::NameList {
                names: names.clone(),
            })
            .collect(),
        conjugates: options
            .conjugates
            .iter()
            .map(|(first, second)| v1::NamePair {
                first: first.clone(),
                second: second.clone(),
            })
            .collect(),
        seed: options.seed,
        settings: Some(settings(&options.settings)),
        precision: Some(v1::Precision {
            kind: Some(match options.precision {
                PrecisionChoice::Adaptive => Kind::Adaptive(true),
                PrecisionChoice::Double => Kind::Double(true),
                PrecisionChoice::Bits(bits) => Kind::Bits(bits),
            }),
        }),
        start_parameters: complexes(&options.start_parameters),
        target_parameters: options
            .target_parameters
            .iter()
            .map(|values| v1::ParameterValues {
                values: complexes(values),
            })
            .collect(),
        start_solutions: options
            .start_solutions
            .as_ref()
            .map(|s| v1::StartSolutions {
                source: Some(match s {
                    StartSolutions::Points(p) => v1::start_solutions::Source::Points(points(p)),
                    StartSolutions::Object(object) => {
                        v1::start_solutions::Source::Object(digest(*object))
                    }
                }),
            }),
        name: options.name.clone(),
        idle_loops: options.idle_loops,
        expected_solutions: options.expected_solutions,
        certify: options.closings.certify,
        trace_test: options.trace_test,
        confidence: options.confidence,
        digits: options.closings.digits,
        deflate: options.closings.deflate,
        no_exact_count: options.closings.no_exact_count,
        approximate: options.closings.approximate,
        warnings: options.warnings.clone(),
        sets: options
            .sets
            .as_ref()
            .map_or(Vec::new(), |sets| equation_sets(sets)),
        // Starts are said in the fields that every version reads.
        method: match (&options.decompose, &options.question) {
            (_, Some(asked)) => Some(v1::options::Method::Question(question(asked))),
            (Some(wanted), None) => Some(v1::options::Method::Decompose(decompose(wanted))),
            (None, None) => None,
        },
    }
}

fn decompose(wanted: &Decompose) -> v1::Decompose {
    v1::Decompose {
        lowest_dimension: wanted.dimensions.map(|[lowest, _]| lowest),
        highest_dimension: wanted.dimensions.map(|[_, highest]| highest),
        idle_loops: wanted.idle_loops,
        method: wanted.method.map(|method| method_number(method) as i32),
        verify: wanted.verify,
        without_split: wanted.without_split,
        known: wanted
            .known
            .as_ref()
            .map(|known_components| v1::KnownComponents {
                equations: known_components.equations,
                components: known_components
                    .components
                    .iter()
                    .map(witness_set)
                    .collect(),
                parameters: complexes(&known_components.parameters),
            }),
    }
}

fn method_number(method: Method) -> v1::DecompositionMethod {
    match method {
        Method::Cascade => v1::DecompositionMethod::Cascade,
        Method::Equations => v1::DecompositionMethod::Equations,
        Method::Slices => v1::DecompositionMethod::Slices,
    }
}

/// The sets of each equation.
pub fn equation_sets(sets: &[Vec<Vec<u32>>]) -> Vec<v1::EquationSets> {
    let set = |variables: &Vec<u32>| v1::VariableSet {
        variables: variables.clone(),
    };
    sets.iter()
        .map(|factors| v1::EquationSets {
            sets: factors.iter().map(set).collect(),
        })
        .collect()
}

/// A choice of settings.
pub fn settings(choice: &SettingsChoice) -> v1::Settings {
    choice.to_message(match choice.preset {
        None => v1::Preset::Unspecified,
        Some(Preset::Careful) => v1::Preset::Careful,
        Some(Preset::Default) => v1::Preset::Default,
        Some(Preset::Fast) => v1::Preset::Fast,
        Some(Preset::Reckless) => v1::Preset::Reckless,
    })
}

fn indices(list: &[usize]) -> Vec<u32> {
    list.iter().copied().map(small).collect()
}

fn nodes(list: &[NodeId]) -> Vec<u32> {
    list.iter().map(|n| n.0).collect()
}

/// A system, node by node as it is.
pub fn system(system: &System) -> v1::System {
    let names = system.equation_names.iter().cloned();
    v1::System {
        nodes: system.expressions.nodes().iter().map(node).collect(),
        variables: system.variables.clone(),
        parameters: system.parameters.clone(),
        groups: system
            .groups
            .iter()
            .map(|g| v1::VariableGroup {
                variables: indices(&g.variables),
                homogeneous: g.homogeneous,
            })
            .collect(),
        equations: system
            .equations
            .iter()
            .zip(names.chain(std::iter::repeat(String::new())))
            .map(|(n, name)| v1::Equation { node: n.0, name })
            .collect(),
        path_variable: system.path_variable.map(small),
        conjugates: system
            .conjugates
            .iter()
            .map(|&(a, b)| v1::ConjugatePair {
                first: small(a),
                second: small(b),
            })
            .collect(),
        degenerate: system
            .degenerate
            .iter()
            .map(|(name, set)| v1::DegenerateSet {
                name: name.clone(),
                set: Some(match set {
                    DegenerateSet::Nonzero(n) => v1::degenerate_set::Set::Nonzero(n.0),
                    DegenerateSet::Equations(list) => {
                        v1::degenerate_set::Set::Equations(v1::NodeList { nodes: nodes(list) })
                    }
                }),
            })
            .collect(),
        symmetry: system
            .symmetry
            .iter()
            .map(|generator| v1::SymmetryGenerator {
                action: Some(match generator {
                    SymmetryGenerator::Permutation(images) => {
                        v1::symmetry_generator::Action::Permutation(v1::Permutation {
                            images: indices(images),
                        })
                    }
                    SymmetryGenerator::Map(list) => {
                        v1::symmetry_generator::Action::Map(v1::NodeList { nodes: nodes(list) })
                    }
                }),
            })
            .collect(),
        unit_exponents: system.scaling.exponents.clone(),
        helpers: system.helpers.iter().map(helper).collect(),
    }
}

fn helper(helper: &Helper) -> v1::Helper {
    use v1::helper::Kind;
    let kind = match helper {
        Helper::Root(root) => Kind::Root(v1::HelperRoot {
            variable: small(root.variable),
            degree: root.degree,
            radicand: root.radicand.0,
            real: root.branch == Branch::Real,
        }),
        Helper::Angle(angle) => Kind::Angle(v1::HelperAngle {
            name: angle.name.clone(),
            cosine: small(angle.cosine),
            sine: small(angle.sine),
            unit_denominator: match angle.unit.denominator {
                1 => 0,
                denominator => denominator,
            },
            unit_pi_power: angle.unit.pi_power,
        }),
    };
    v1::Helper { kind: Some(kind) }
}

fn node(node: &Node) -> v1::Node {
    use v1::node::Kind;
    let binary = |a: &NodeId, b: &NodeId| v1::Binary {
        left: a.0,
        right: b.0,
    };
    let kind = match node {
        Node::Constant(z) => Kind::Constant(v1::ExactComplex {
            re: z.re.to_string(),
            im: if z.im == 0 {
                String::new()
            } else {
                z.im.to_string()
            },
        }),
        Node::Variable(v) => Kind::Variable(*v),
        Node::Parameter(p) => Kind::Parameter(*p),
        Node::Add(a, b) => Kind::Add(binary(a, b)),
        Node::Subtract(a, b) => Kind::Subtract(binary(a, b)),
        Node::Multiply(a, b) => Kind::Multiply(binary(a, b)),
        Node::Divide(a, b) => Kind::Divide(binary(a, b)),
        Node::Negate(a) => Kind::Negate(a.0),
        Node::Power(a, exponent) => Kind::Power(v1::Power {
            base: a.0,
            exponent: *exponent,
        }),
        Node::Root(a, exponent) => Kind::Root(v1::Root {
            base: a.0,
            exponent: exponent.to_string(),
        }),
        Node::Function(function, a) => Kind::Function(v1::FunctionCall {
            function: match function {
                Function::SquareRoot => v1::Function::SquareRoot,
                Function::Exponential => v1::Function::Exponential,
                Function::Logarithm => v1::Function::Logarithm,
                Function::Sine => v1::Function::Sine,
                Function::Cosine => v1::Function::Cosine,
                Function::Tangent => v1::Function::Tangent,
                Function::Pi => v1::Function::Pi,
            }
            .into(),
            argument: a.0,
        }),
    };
    v1::Node { kind: Some(kind) }
}
