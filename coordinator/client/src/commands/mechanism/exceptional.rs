//! `cognate mechanism exceptional`: for which values of numbers that a file leaves open more moves than in general.
//!
//! The open numbers become unknowns beside those of the motion. Of each component the image in the open numbers and the
//! dimension of what lies over a general point of it say how much moves there.

use super::free_numbers::FreeNumbers;
use super::motion;
use super::read::{described, refuse_locks, wrong};
use crate::commands::question;
use crate::commands::sequence::{Sequence, Working, served};
use crate::common_arguments::AnswerFormat;
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismExceptional;
use crate::mechanism::exceptional_answer::{
    ExceptionalAnswer, ExceptionalSet, FreeNumber, Value as FreeValue,
};
use crate::output::mechanisms::exceptional as shown;
use crate::output::objects;
use crate::output::text::Look;
use cognate_kinematics::compile::motion::{DegreeIn, motion_with_constants};
use cognate_kinematics::compile::near_number::recognized;
use cognate_kinematics::compile::size;
use cognate_kinematics::compile::text::Equations;
use cognate_solutions::witness::Question;
use cognate_summary::question_answer::QuestionAnswer;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde_json::Value;

/// A computed value is a short fraction within this, relative to it.
const RECOGNIZED: f64 = 1e-11;
/// A value is real where its imaginary part is below this, relative to 1 and its size.
const REAL: f64 = 1e-9;
/// Two sets of values of open numbers by which equations are compiled. They occur in no mechanism, so that each place where
/// such a number stands is that of an open number: the numerator of the first one, the step to the next, the denominator.
const MARKS: [[u64; 3]; 2] = [[1_000_003, 8 * 7, 7], [2_000_039, 8 * 11, 11]];

/// Decomposes, prints, stops everything that it started, also when interrupted.
pub async fn run(a: &MechanismExceptional) -> Result<Exit, ClientError> {
    refuse_locks(&a.mechanism)?;
    let free = FreeNumbers::of(&a.mechanism.file)?;
    let family = Family::of(a, &free)?;
    let running = a.service.running()?;
    let shown = (a.progress.progress, a.format != AnswerFormat::Table);
    let work = |jobs| -> Working<'_> { Box::pin(answer(a, jobs, family)) };
    served(&a.service, shown, running, Box::new(work)).await
}

/// Equations of the motion in which open numbers are unknowns.
struct Family {
    name: String,
    free: Vec<FreeNumber>,
    system: System,
    /// Places of the open numbers among the unknowns.
    places: Vec<u32>,
    degree_in: DegreeIn,
}

impl Family {
    fn of(a: &MechanismExceptional, free: &FreeNumbers) -> Result<Self, ClientError> {
        let [first, second] = [0, 1].map(|which| marked(a, free, MARKS[which]));
        let (first, second) = (first?, second?);
        if first.equations != second.equations || first.is_squared != second.is_squared {
            let what =
                "that enter equations in other ways than as lengths of bars or fields of rows";
            return Err(free.refusal(what));
        }
        let equations = first.equations;
        if equations.homogeneous {
            return Err(free.refusal("of platforms"));
        }
        let system = equations
            .clone()
            .system(&free.file)
            .map_err(|e| described(&e))?;
        let place = |k: usize| {
            let mut names = system.variables.iter();
            let place = names.position(|name| *name == variable(k));
            place.and_then(|place| u32::try_from(place).ok())
        };
        let places: Option<Vec<u32>> = (0..free.names.len()).map(place).collect();
        let needed = needed_texts(&equations);
        let occurs = |k: usize| needed.iter().any(|text| text.contains(&variable(k)));
        let Some(places) = places.filter(|_| (0..free.names.len()).all(occurs)) else {
            return Err(free.refusal("that the equations of the general motion do not contain"));
        };
        let names = free.names.iter().zip(&first.is_squared);
        Ok(Self {
            name: first.name,
            places,
            free: names
                .map(|(name, is_squared)| FreeNumber {
                    name: name.clone(),
                    is_squared: *is_squared,
                })
                .collect(),
            system,
            degree_in: first.degree_in,
        })
    }
}

/// The unknown that an open number is.
fn variable(number: usize) -> String {
    format!("free{}", number + 1)
}

/// Equations with marks in which open numbers were put back.
struct Marked {
    name: String,
    equations: Equations,
    /// Whether only the square of each open number occurs; the unknown is the square then.
    is_squared: Vec<bool>,
    degree_in: DegreeIn,
}

fn marked(
    a: &MechanismExceptional,
    free: &FreeNumbers,
    [numerator, step, denominator]: [u64; 3],
) -> Result<Marked, ClientError> {
    let numerators: Vec<u64> = (0..free.names.len() as u64)
        .map(|k| numerator + step * k)
        .collect();
    let with_values = |values: &dyn Fn(usize) -> String| {
        let names = free.names.iter().enumerate();
        let given = names.map(|(k, name)| (name.clone(), Value::String(values(k))));
        free.mechanism(&given.collect(), "general values", &a.mechanism)
    };
    let mechanism = with_values(&|k| format!("{}/{denominator}", numerators[k]))?;
    let motion = motion_with_constants(&mechanism, None).map_err(|e| described(&e))?;
    let mut equations = motion.equations;
    let mut is_squared = Vec::new();
    for (k, numerator) in numerators.iter().enumerate() {
        let mark = format!("({numerator}/{denominator})");
        let square = format!("({}/{})", numerator * numerator, denominator * denominator);
        let occurs = |text: &str| texts(&equations).any(|each| each.contains(text));
        let squared = occurs(&square) && !occurs(&mark);
        let put = match squared {
            true => variable(k),
            false => format!("{}^2", variable(k)),
        };
        for text in texts_mut(&mut equations) {
            *text = text.replace(&square, &put).replace(&mark, &variable(k));
        }
        is_squared.push(squared);
    }
    // Constants are judged by the numbers that are given; one of open numbers alone is an equation.
    let given_size = with_values(&|_| "1".into()).map_or(1.0, |mechanism| size(&mechanism));
    equations
        .groups
        .push((0..free.names.len()).map(variable).collect());
    let gap = equations
        .settle_constants(&mechanism, given_size)
        .map_err(|e| described(&e))?;
    if let Some(gap) = gap {
        return Err(wrong(&free.file, gap));
    }
    Ok(Marked {
        name: mechanism.name,
        equations,
        is_squared,
        degree_in: motion.degree_in,
    })
}

/// The equations, and the definitions that they need.
fn needed_texts(equations: &Equations) -> Vec<&String> {
    let mut needed: Vec<&String> = equations.equations.iter().collect();
    // A definition uses earlier ones only.
    for (name, text) in equations.definitions.iter().rev() {
        if needed.iter().any(|other| other.contains(name)) {
            needed.push(text);
        }
    }
    needed
}

fn texts(equations: &Equations) -> impl Iterator<Item = &String> {
    let definitions = equations.definitions.iter().map(|(_, text)| text);
    definitions.chain(&equations.equations)
}

fn texts_mut(equations: &mut Equations) -> impl Iterator<Item = &mut String> {
    let definitions = equations.definitions.iter_mut().map(|(_, text)| text);
    definitions.chain(&mut equations.equations)
}

async fn answer(
    a: &MechanismExceptional,
    jobs: Sequence,
    family: Family,
) -> Result<Exit, ClientError> {
    let prepared = motion::prepared(
        (a.seed, a.preset),
        &family.name,
        &family.system,
        family.degree_in,
    );
    let (summary, set) = jobs.decompose(prepared, None).await?;
    let mut doubts = summary.decomposition.unsettled.clone();
    if !summary.settled && doubts.is_empty() {
        doubts.push("the decomposition is not settled".into());
    }
    let mut over = Vec::new();
    if !set.components.is_empty() {
        let onto = family.places.clone();
        let prepared = question::prepared(a.preset, &set, Question::Project { onto })?;
        let answer = jobs.question(prepared).await?;
        doubts.extend(answer.unsettled);
        let QuestionAnswer::Project(images) = answer.answer else {
            return Err(ClientError::GaveUp("its answer is no projection".into()));
        };
        for image in images.components {
            let mut components = set.components.iter();
            let component = components.find(|c| c.set.id.to_string() == image.id);
            match (component, image.dimension, image.fiber_dimension) {
                (Some(component), Some(dimension), Some(mobility)) => over.push(Over {
                    dimension: dimension.into(),
                    mobility: mobility.into(),
                    degree: image.degree,
                    points: component
                        .set
                        .points
                        .iter()
                        .map(|point| family.places.iter().map(|k| point[*k as usize]).collect())
                        .collect(),
                }),
                _ => doubts.push(format!("the image of component {} is not known", image.id)),
            }
        }
    }
    let answer = assembled(&family, &over, doubts);
    for doubt in &answer.doubts {
        eprintln!("warning: {doubt}");
    }
    objects::print(
        a.format,
        &["/sets"],
        || shown::table(&answer, Look::of_standard_output()),
        || shown::json(&answer),
    )?;
    Ok(Exit::of_settled(answer.doubts.is_empty()))
}

/// A set of values of the open numbers, with the positions over it.
struct Over {
    /// Dimension of the set of values.
    dimension: u64,
    /// Freedoms at a general point of it.
    mobility: u64,
    /// Degree of the set of values.
    degree: Option<u64>,
    /// Values at the witness points of the component.
    points: Vec<Vec<Complex64>>,
}

fn assembled(family: &Family, over: &[Over], mut doubts: Vec<String>) -> ExceptionalAnswer {
    let all_values = family.free.len() as u64;
    let general = over.iter().filter(|each| each.dimension == all_values);
    // A mechanism that cannot be assembled has mobility -1.
    let generic = general.map(|each| each.mobility as i64).max().unwrap_or(-1);
    if over.iter().any(|each| each.dimension > 1) {
        doubts.push(
            "a set of values has dimension 2 or more: smaller sets inside it over which one freedom more exists are not looked for"
                .into(),
        );
    }
    let mut sets: Vec<ExceptionalSet> = Vec::new();
    let mut not_real = 0u64;
    for each in over {
        if each.dimension == all_values || each.mobility as i64 <= generic {
            continue;
        }
        let mut set = ExceptionalSet {
            dimension: each.dimension,
            mobility: each.mobility,
            degree: each.degree,
            values: Vec::new(),
            equations: Vec::new(),
        };
        if each.dimension == 0 {
            match values(family, &each.points[0]) {
                Some(point) => set.values.push(point),
                None => {
                    not_real += 1;
                    continue;
                }
            }
        } else if (each.dimension, each.degree, all_values) == (1, Some(1), 2) {
            set.equations.extend(line(family, &each.points[0]));
        }
        // Points over which as much moves are one set; so are lines with one equation.
        let same = |other: &&mut ExceptionalSet| {
            let is_alike = (other.dimension, other.mobility) == (set.dimension, set.mobility);
            let is_line = !set.equations.is_empty() && other.equations == set.equations;
            is_alike && (set.dimension == 0 || is_line)
        };
        match sets.iter_mut().find(same) {
            Some(other) => {
                for point in set.values {
                    if !other.values.contains(&point) {
                        other.values.push(point);
                    }
                }
            }
            None => sets.push(set),
        }
    }
    for set in &mut sets {
        set.values.sort_by(|a, b| {
            let pairs = a.iter().zip(b);
            let order = pairs.map(|(a, b)| b.number.total_cmp(&a.number));
            order.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
        });
    }
    sets.sort_by_key(|set| (std::cmp::Reverse(set.dimension), set.mobility));
    ExceptionalAnswer {
        name: family.name.clone(),
        free: family.free.clone(),
        generic,
        sets,
        not_real,
        doubts,
    }
}

/// Real values of the open numbers at a point; `None` where one is not real. Of numbers that occur squared the positive ones.
fn values(family: &Family, point: &[Complex64]) -> Option<Vec<FreeValue>> {
    let value = |(free, z): (&FreeNumber, &Complex64)| {
        if z.im.abs() > REAL * (1.0 + z.re.abs()) || free.is_squared && z.re < 0.0 {
            return None;
        }
        let x = if free.is_squared { z.re.sqrt() } else { z.re };
        let exact = recognized(x, RECOGNIZED);
        Some(FreeValue {
            number: exact.as_ref().map_or(x, |(_, number)| *number),
            exact: exact.map(|(text, _)| text),
        })
    };
    family.free.iter().zip(point).map(value).collect()
}

/// The equation of a real line through a complex point that is not real: a x + b y + c = 0 for its real and its imaginary
/// part; `None` where the coefficients are no short fractions.
fn line(family: &Family, point: &[Complex64]) -> Option<String> {
    let [x, y] = [point[0], point[1]];
    let text = |k: usize| match family.free[k].is_squared {
        true => format!("{}^2", family.free[k].name),
        false => family.free[k].name.clone(),
    };
    if y.im.abs() <= REAL * x.im.abs() {
        let constant = recognized(y.re, RECOGNIZED)?;
        return Some(sum(&[
            (1.0, "1", text(1)),
            (-constant.1, &constant.0, String::new()),
        ]));
    }
    // x - slope y = constant
    let slope = recognized(
        if x.im.abs() <= REAL * y.im.abs() {
            0.0
        } else {
            x.im / y.im
        },
        RECOGNIZED,
    )?;
    let rest = x.re - slope.1 * y.re;
    let is_zero = rest.abs() <= REAL * (x.re.abs() + 1.0);
    let constant = recognized(if is_zero { 0.0 } else { rest }, RECOGNIZED)?;
    Some(sum(&[
        (1.0, "1", text(0)),
        (-slope.1, &slope.0, text(1)),
        (-constant.1, &constant.0, String::new()),
    ]))
}

/// A sum of terms: the sign of the first number with the size that the text has, times a name.
fn sum(terms: &[(f64, &str, String)]) -> String {
    let mut text = String::new();
    for (sign, size, name) in terms.iter().filter(|(sign, ..)| *sign != 0.0) {
        let size = size.trim_start_matches('-');
        text.push_str(match (text.is_empty(), *sign < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        });
        text.push_str(&match (size, name.is_empty()) {
            (size, true) => size.to_owned(),
            ("1", false) => name.clone(),
            (size, false) => format!("{size}*{name}"),
        });
    }
    text
}
