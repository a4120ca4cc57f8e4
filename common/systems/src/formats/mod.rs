//! Formats: what people already have, read and written.
//!
//! `read` takes a problem as plain equations, in Bertini-classic, PHCpack, our JSON, or the notation of
//! Macaulay2, Maple, Singular or msolve, told apart by content, and gives a checked
//! `System` with the settings of the file.

pub mod bertini;
pub mod conditions;
mod constants;
pub(crate) mod definitions;
pub mod degenerate;
pub mod error;
pub mod json;
pub mod json_value;
pub mod limits;
pub mod macaulay2;
pub mod maple;
pub mod msolve;
mod number_list;
pub mod options;
mod parsed_condition;
mod parts;
pub mod phcpack;
pub mod plain;
mod plain_text;
pub mod points;
mod polynomial_list;
pub(crate) mod scope;
pub mod sets;
mod sharing;
pub mod singular;
pub mod symmetry;
mod target_block;
mod target_table;
pub mod targets;
pub mod written;

pub use error::{FormatError, Place, Source};
pub use sharing::WriteError;

use crate::condition::Conditions;
use crate::expression::build::Builder;
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::{Dependence, Node, NodeId};
use crate::objective::Objective;
use crate::polynomial::vanishes;
use crate::system::{System, SystemError};
use crate::transform::clear_denominators::{
    ZERO_DENOMINATOR, clear_denominators, denominator_factors,
};
use crate::transform::critical_points;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;
use std::borrow::Cow;
use std::fmt;

/// The notation of a problem file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Bertini-classic.
    Bertini,
    /// PHCpack.
    Phcpack,
    /// Our own JSON.
    Json,
    /// Macaulay2.
    Macaulay2,
    /// Maple.
    Maple,
    /// Singular.
    Singular,
    /// msolve.
    Msolve,
    /// Equations, one a line.
    Plain,
}

impl Format {
    /// All notations.
    pub const ALL: [Self; 8] = [
        Self::Bertini,
        Self::Phcpack,
        Self::Json,
        Self::Macaulay2,
        Self::Maple,
        Self::Singular,
        Self::Msolve,
        Self::Plain,
    ];
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Format::Bertini => "Bertini-classic",
            Format::Phcpack => "PHCpack",
            Format::Json => "JSON",
            Format::Macaulay2 => "Macaulay2",
            Format::Maple => "Maple",
            Format::Singular => "Singular",
            Format::Msolve => "msolve",
            Format::Plain => "plain",
        })
    }
}

/// Number of digits that a file asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrecisionHint {
    /// Double precision only (`MPType: 0`).
    Double,
    /// A fixed number of bits (`MPType: 1`, `Precision: 96`).
    Bits(u32),
    /// Each path takes as many digits as it needs (`MPType: 2`).
    Adaptive,
}

/// Settings that stand in a problem file; what the command line says goes first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileSettings {
    /// Seed of all random numbers (`RandomSeed`; 0 there means none is given).
    pub seed: Option<u64>,
    /// Largest relative accuracy of a rounded decimal: one of 8 significant digits or more is known to
    /// half a unit of its last digit; 0 where all numbers are exact.
    pub data_accuracy: f64,
    /// Digits to compute with (`MPType`, `Precision`).
    pub precision: Option<PrecisionHint>,
    /// Decimal digits of the solutions (`SharpenDigits`; 0 there means those of the paths).
    pub digits: Option<u32>,
    /// Accuracy of endpoints (`FinalTol`).
    pub final_tolerance: Option<f64>,
    /// Accuracy on the path (`TrackTolBeforeEG`).
    pub tracking_tolerance: Option<f64>,
    /// Accuracy on the path near its end (`TrackTolDuringEG`).
    pub endgame_tolerance: Option<f64>,
    /// Steps after which a path is given up (`MaxNumberSteps`).
    pub maximum_steps: Option<u64>,
    /// The file is a homotopy of the user's own (`UserHomotopy`, or a path variable is declared).
    pub user_homotopy: bool,
    /// The file is for a parameter homotopy (`ParameterHomotopy`; 1 solves generic
    /// parameters, 2 moves to wanted ones).
    pub parameter_homotopy: Option<u8>,
    /// The file asks for another kind of run than isolated solutions (`TrackType`).
    pub other_run: Option<OtherRun>,
}

/// The numbers of runs that find components: a decomposition, and witness sets that are printed.
pub const DECOMPOSES: [i64; 2] = [1, 4];

/// A run of another kind than one for isolated solutions, which commands of their own do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherRun {
    /// The number by which a Bertini file asks for it.
    pub track_type: i64,
    /// The refusal of every command that does something else; it names the place and the right command.
    pub refusal: FormatError,
}

impl FileSettings {
    /// With `ParameterHomotopy: 1`, which solves a family from nothing at random parameters: these, of
    /// modulus 1, and what to say about them. `seed`: the one that goes before the file's.
    pub fn random_parameters(
        &self,
        system: &System,
        seed: Option<u64>,
    ) -> Option<(Vec<Complex64>, String)> {
        if self.parameter_homotopy != Some(1)
            || system.path_variable.is_some()
            || system.parameters.is_empty()
        {
            return None;
        }
        let seed = seed.or(self.seed).unwrap_or(0);
        let mut random = RandomStream::new(seed, Purpose::DeclaredConstant, u64::MAX);
        let values: Vec<Complex64> = system.parameters.iter().map(|_| random.unit()).collect();
        let named = system.parameters.iter().zip(&values);
        let named: Vec<String> = named
            .take(MOST_NAMED)
            .map(|(name, z)| format!("{name} = [{:?}, {:?}]", z.re, z.im))
            .collect();
        let more = match system.parameters.len() > MOST_NAMED {
            true => ", ...",
            false => "",
        };
        let warning = format!(
            "ParameterHomotopy: 1: solved at random parameters, those of seed {seed}: {}{more}",
            named.join(", ")
        );
        Some((values, warning))
    }
}

/// Most parameters that a warning names with their values.
const MOST_NAMED: usize = 50;

/// Something in a file that was understood but not followed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The file's name.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// Description of the part of the file that is not followed.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.message)
    }
}

/// Warnings kept for one file; a file with more has one mistake many times.
const WARNINGS: usize = 100;

/// Adds a warning about the place of a byte.
pub(crate) fn warn(warnings: &mut Vec<Warning>, source: &Source<'_>, at: usize, message: String) {
    if warnings.len() < WARNINGS {
        let (line, _) = source.line_and_column(at);
        warnings.push(Warning {
            file: source.name.into(),
            line,
            message,
        });
    }
}

/// Contents of a problem file.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The system, checked.
    pub system: System,
    /// The file's settings.
    pub settings: FileSettings,
    /// The notation it was in.
    pub format: Format,
    /// One warning for each thing in the file that is not followed.
    pub warnings: Vec<Warning>,
    /// Conditions for the wanted solutions.
    pub conditions: Conditions,
    /// Expression of which the least value, the largest value or all critical points are wanted.
    pub objective: Option<Objective>,
}

/// Reads a problem in any of the formats, told apart by content.
///
/// `name` is only for messages.
pub fn read(name: &str, content: &[u8]) -> Result<Problem, FormatError> {
    let content = without_latin1_comments(content);
    let text = decode(name, &content, limits::FILE_BYTES)?;
    let source = Source { name, text };
    let mut problem = match text.trim_start().chars().next() {
        _ if bertini::later_config(text).is_some() => bertini::read(&source),
        Some('{') if is_list(text) => plain::read(&source),
        Some('{') => json::read(&source),
        Some('0'..='9') if !plain::is(text) => phcpack::read(&source),
        _ if macaulay2::is(text) => macaulay2::read(&source),
        _ if singular::is(text) => singular::read(&source),
        _ if maple::is(text) => maple::read(&source),
        _ if msolve::is(text) => msolve::read(&source),
        _ if plain::is(text) => plain::read(&source),
        _ => bertini::read(&source),
    }?;
    say_denominators(&mut problem, &source);
    Ok(problem)
}

/// Whether a text in braces is a list of expressions, as Mathematica has them, and no JSON.
fn is_list(text: &str) -> bool {
    let inside = text.trim_start().trim_start_matches('{').trim_start();
    let begins = |c: char| c.is_alphanumeric() || matches!(c, '(' | '-' | '√');
    inside.starts_with(begins) && !text.contains(['"', ':'])
}

/// Hands over what a builder holds as [`Builder::hand_over`] does, with an objective: helpers of its functions are entered as
/// those of an equation.
fn hand_over(
    builder: &mut Builder,
    system: &mut System,
    places: &[Span],
    objective: Option<&mut Objective>,
) -> Result<(), Fault> {
    let Some(objective) = objective else {
        return builder.hand_over(system, places);
    };
    let last = system.equations.len();
    system.equations.push(objective.node);
    builder.hand_over(system, places)?;
    objective.node = system.equations.remove(last);
    free_objective(system, objective);
    Ok(())
}

/// Without equations those of an objective's critical points are the system's; where one of them would be constant, an
/// unknown stands for them, and only conditions bring critical points.
fn free_objective(system: &mut System, objective: &mut Objective) {
    if system.equations.is_empty() {
        objective.is_free = true;
        let free = critical_points(system, objective.node, &[]);
        let depends = |root: &NodeId| free.expressions.dependence(*root) == Dependence::Variables;
        let has_multiplier = free.variables.len() > system.variables.len();
        if !has_multiplier && free.equations.iter().all(depends) {
            *system = free;
        } else {
            system.equations.push(system.expressions.variable(0));
            system.equation_names.push(objective.goal.name().to_owned());
        }
    }
}

/// Says which equations are left out because they hold for all values; `identities` are their places.
fn say_identities(source: &Source<'_>, identities: &[Span], warnings: &mut Vec<Warning>) {
    for place in identities {
        let equation = source.text[place.start..place.end].trim_matches('"');
        let message = format!("`{equation}` holds for all values, and is left out");
        warn(warnings, source, place.start, message);
    }
}

/// Says what becomes of denominators, where there are some.
fn say_denominators(problem: &mut Problem, source: &Source<'_>) {
    let system = &problem.system;
    let factors = denominator_factors(system);
    if !factors.is_empty() {
        let mut names: Vec<&str> = Vec::new();
        for factor in &factors {
            match system.expressions.node(*factor) {
                Node::Variable(v) => names.push(&system.variables[*v as usize]),
                _ if names.last() == Some(&"a sum") => {}
                _ => names.push("a sum"),
            }
        }
        names.sort_by_key(|name| {
            (
                *name == "a sum",
                system.variables.iter().position(|v| v == name),
            )
        });
        names.dedup();
        let names = match names.split_last() {
            Some((last, [])) => (*last).to_owned(),
            Some((last, others)) => format!("{} or {last}", others.join(", ")),
            None => String::new(),
        };
        let message = format!(
            "denominators are multiplied out; where {names} is 0 there is no solution, and what the multiplied equations \
             have there is removed (`{ZERO_DENOMINATOR}`)"
        );
        warn(&mut problem.warnings, source, 0, message);
    }
}

/// The content with `?` for every byte of a comment (from `%` to the end of the line) that is not
/// UTF-8: people's names in Latin-1. Places stay what they are.
fn without_latin1_comments(content: &[u8]) -> Cow<'_, [u8]> {
    if content.len() as u64 > limits::FILE_BYTES.value || std::str::from_utf8(content).is_ok() {
        return Cow::Borrowed(content);
    }
    let mut text = content.to_vec();
    for line in text.split_mut(|&byte| byte == b'\n') {
        let Some(at) = line.iter().position(|&byte| byte == b'%') else {
            continue;
        };
        let comment = &mut line[at..];
        if std::str::from_utf8(comment).is_err() {
            let foreign = comment.iter_mut().filter(|byte| !byte.is_ascii());
            foreign.for_each(|byte| *byte = b'?');
        }
    }
    Cow::Owned(text)
}

/// Writes a system, and where the notation has a place for them the settings.
pub fn write(
    format: Format,
    system: &System,
    settings: &FileSettings,
) -> Result<String, WriteError> {
    match format {
        Format::Bertini => bertini::write(system, settings),
        Format::Phcpack => phcpack::write(system),
        Format::Json => json::write(system),
        Format::Macaulay2 => macaulay2::write(system),
        Format::Maple => maple::write(system),
        Format::Singular => singular::write(system),
        Format::Msolve => msolve::write(system),
        Format::Plain => plain::write(system),
    }
}

/// The text of a file, if it is text of an acceptable size.
pub(crate) fn decode<'a>(
    name: &str,
    content: &'a [u8],
    limit: limits::Limit,
) -> Result<&'a str, FormatError> {
    if content.len() as u64 > limit.value {
        let fault = Fault::limit(Span::default(), limit, content.len());
        return Err(Source { name, text: "" }.error(fault));
    }
    let readable = |text: &'a str, actual_input: &str| {
        let at = Span {
            start: text.len(),
            end: text.len(),
        };
        Source { name, text }.error(Fault::expected(at, "text in UTF-8", actual_input))
    };
    let text = match std::str::from_utf8(content) {
        Ok(text) => text,
        Err(e) => {
            let valid = &content[..e.valid_up_to()];
            let text = std::str::from_utf8(valid).unwrap_or_default();
            return Err(readable(
                text,
                &format!("the byte 0x{:02x}", content[e.valid_up_to()]),
            ));
        }
    };
    if let Some(at) = text.find('\0') {
        return Err(readable(&text[..at], "the byte 0x00"));
    }
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// Checks what every reader promises; `places` are the equations' places in the text.
///
/// Monomials in denominators of equations are multiplied out (see [`clear_denominators`]).
/// Equations that hold for all values are left out where `identities` takes their places, and else refused.
pub(crate) fn finish(
    mut system: System,
    places: &[Span],
    end: Span,
    mut identities: Option<&mut Vec<Span>>,
) -> Result<System, Fault> {
    let mut places = places.to_vec();
    let sizes = [
        (limits::VARIABLES, system.variables.len()),
        (limits::EQUATIONS, system.equations.len()),
        (limits::PARAMETERS, system.parameters.len()),
    ];
    for (limit, count) in sizes {
        if count as u64 > limit.value {
            return Err(Fault::limit(end, limit, count));
        }
    }
    if system.variables.is_empty() {
        return Err(Fault::new(end, What::NoVariables));
    }
    let depends = |system: &System, i: usize| {
        system.expressions.dependence(system.equations[i]) == Dependence::Variables
    };
    let mut depended: Vec<bool> = (0..system.equations.len())
        .map(|i| depends(&system, i))
        .collect();
    clear_denominators(&mut system);
    if let Some(identities) = &mut identities {
        for i in (0..system.equations.len()).rev() {
            if vanishes(&system, system.equations[i]) {
                system.equations.remove(i);
                system.equation_names.remove(i);
                depended.remove(i);
                identities.extend((i < places.len()).then(|| places.remove(i)));
            }
        }
        if system.equations.is_empty() && !identities.is_empty() {
            let expected = "an equation that holds only for some values";
            let actual = match system.degenerate.contains_key(ZERO_DENOMINATOR) {
                true => {
                    "none: every value of the unknowns solves what there is, but where a denominator is 0"
                }
                false => "none: every value of the unknowns solves what there is",
            };
            return Err(Fault::expected(identities[0], expected, actual));
        }
    }
    let at = |i: usize| places.get(i).copied().unwrap_or(end);
    for (i, depended) in depended.into_iter().enumerate() {
        if depends(&system, i) {
            continue;
        }
        let name = system.equation_names[i].clone();
        return Err(if depended {
            let actual = match vanishes(&system, system.equations[i]) {
                true => format!("`{name}`, whose numerator is 0: it holds for all values"),
                false => format!(
                    "`{name}`, whose numerator is a constant: no values of its variables make it 0"
                ),
            };
            Fault::expected(at(i), "an equation that has a solution", actual)
        } else {
            Fault::new(at(i), What::ConstantEquation(name))
        });
    }
    let degrees = system.expressions.degree_bounds();
    for (i, &equation) in system.equations.iter().enumerate() {
        let degree = degrees[equation.0 as usize];
        if degree > limits::DEGREE.value {
            return Err(Fault::limit(at(i), limits::DEGREE, degree));
        }
    }
    match system.check() {
        Ok(()) => Ok(system),
        Err(SystemError::NoVariables) => Err(Fault::new(end, What::NoVariables)),
        Err(SystemError::NoEquations) => Err(Fault::new(end, What::NoEquations)),
        Err(other) => Err(Fault::expected(
            end,
            "a consistent system",
            other.to_string(),
        )),
    }
}
