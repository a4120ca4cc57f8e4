//! Options message to the options of a submission: starts, settings, parameters, decomposition.

use super::question::{question, witness_sets};
use super::{at, complexes, digest, method, points};
use crate::error::{ProtocolError, within_limit};
use crate::limits;
use crate::submission::{
    Decompose, Options, PrecisionChoice, SettingsChoice, StartKind, StartSolutions,
};
use crate::v1;
use crate::v1::options::Method;
use cognate_continuation::sharpening::MOST_DIGITS;
use cognate_continuation::tracker::settings::Preset;
use cognate_solutions::closing_options::ClosingOptions;
use cognate_solutions::witness::{self, KnownComponents};
use cognate_systems::formats::limits as sizes;
use num_complex::Complex64;

/// Most loops in a row without anything new in a decomposition.
const MOST_IDLE_LOOPS: u32 = 200;

/// Options of a solve from the message.
pub fn options(m: v1::Options) -> Result<Options, ProtocolError> {
    let (m, method) = method::unfolded(m)?;
    without_method(m).map_err(|error| method::placed(error, method))
}

/// Options without a method that is a start: `start` says how paths begin.
fn without_method(m: v1::Options) -> Result<Options, ProtocolError> {
    check_sizes(&m)?;
    let start_parameters = complexes("start_parameters", &m.start_parameters)?;
    let target_parameters = target_parameters(&m)?;
    let start_solutions = start_solutions(m.start_solutions)?;
    let (decompose, question) = match m.method {
        Some(Method::Decompose(m)) => (Some(decompose(m)?), None),
        Some(Method::Question(m)) => (None, Some(question(m)?)),
        _ => (None, None),
    };
    Ok(Options {
        start: start_kind(m.start)?,
        groups: (!m.groups.is_empty()).then(|| m.groups.into_iter().map(|g| g.names).collect()),
        conjugates: m
            .conjugates
            .into_iter()
            .map(|p| (p.first, p.second))
            .collect(),
        seed: m.seed,
        settings: settings(&m.settings.unwrap_or_default()).map_err(|e| e.within("settings"))?,
        precision: precision(m.precision)?,
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
            approximate: m.approximate,
        },
        trace_test: m.trace_test,
        confidence: confidence(m.confidence)?,
        warnings: m.warnings,
        sets: if m.sets.is_empty() {
            None
        } else {
            Some(equation_sets("sets", &m.sets)?)
        },
        decompose,
        question,
    })
}

/// Refuses names and lists that are longer than their limits.
fn check_sizes(m: &v1::Options) -> Result<(), ProtocolError> {
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
    )
}

/// The sets of target parameters, as many values in each.
fn target_parameters(m: &v1::Options) -> Result<Vec<Vec<Complex64>>, ProtocolError> {
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
    Ok(target_parameters)
}

/// The start solutions that a client gives, as points or by the digest of an object.
fn start_solutions(
    message: Option<v1::StartSolutions>,
) -> Result<Option<StartSolutions>, ProtocolError> {
    Ok(match message.and_then(|s| s.source) {
        None => None,
        Some(v1::start_solutions::Source::Points(p)) => Some(StartSolutions::Points(
            points(&p).map_err(|e| e.within("start_solutions.points"))?,
        )),
        Some(v1::start_solutions::Source::Object(bytes)) => Some(StartSolutions::Object(digest(
            "start_solutions.object",
            &bytes,
        )?)),
    })
}

/// The start system that a client asks for.
fn start_kind(start: i32) -> Result<StartKind, ProtocolError> {
    Ok(match v1::StartKind::try_from(start) {
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
                start,
                "a start kind that this version knows",
            ));
        }
    })
}

/// The precision in which paths are tracked.
fn precision(message: Option<v1::Precision>) -> Result<PrecisionChoice, ProtocolError> {
    Ok(match message.and_then(|p| p.kind) {
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
    Ok(Decompose {
        dimensions,
        idle_loops: m.idle_loops,
        method,
        verify: m.verify,
        without_split: m.without_split,
        known: m.known.map(known_components).transpose()?,
    })
}

/// Components of the system that the client has from a run before.
fn known_components(m: v1::KnownComponents) -> Result<KnownComponents, ProtocolError> {
    Ok(KnownComponents {
        equations: m.equations,
        components: witness_sets(m.components).map_err(|e| e.within("decompose.known"))?,
        parameters: {
            let (field, values) = ("decompose.known.parameters", &m.parameters);
            within_limit(field, values.len(), sizes::PARAMETERS)?;
            complexes(field, values)?
        },
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
