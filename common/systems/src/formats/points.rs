//! Points: start solutions and values of parameters, in the notations that people have.

use super::json_value::{self, Kind, Value, decimal};
use super::scope::{FieldFault, at};
use super::{FormatError, Source, decode, limits};
use crate::expression::fault::{Fault, Problem, Span};
use crate::expression::token::shorten;
use cognate_numeric::counted::counted;
use num_complex::Complex64;

/// A point: one complex number for each name, in the order of the names asked for.
pub type Point = Vec<Complex64>;

/// Reads start solutions: our `solutions.jsonl`, Bertini's `start` format or a
/// PHCpack solution list, told apart by content.
///
/// Coordinates are put in the order of `variables`; where the notation has
/// names, each variable must occur and no other.
pub fn read_solutions(
    name: &str,
    content: &[u8],
    variables: &[String],
) -> Result<Vec<Point>, FormatError> {
    let text = decode(name, content, limits::POINT_FILE_BYTES)?;
    let source = Source { name, text };
    if text.trim_start().starts_with('{') {
        return json_lines(&source, variables).map_err(|fault| fault.into_error(&source));
    }
    let listed = |line: &str| line.trim_start().starts_with("solution ");
    let points = if text.lines().any(listed) {
        phcpack(text, variables)
    } else {
        bertini(text, variables.len(), true)
    };
    points.map_err(|fault| source.error(fault))
}

/// Reads values of parameters: Bertini's `start_parameters` format, or JSON: an object of values by name, or a list of
/// these objects for many targets.
pub fn read_parameters(
    name: &str,
    content: &[u8],
    parameters: &[String],
) -> Result<Vec<Point>, FormatError> {
    let text = decode(name, content, limits::POINT_FILE_BYTES)?;
    let source = Source { name, text };
    if !text.trim_start().starts_with(['{', '[']) {
        return bertini(text, parameters.len(), false).map_err(|fault| source.error(fault));
    }
    let json = || {
        let value = json_value::parse(text, 0, text.len()).map_err(at(""))?;
        match &value.kind {
            Kind::Array(items) if items.is_empty() => {
                let actual_input = "an empty list";
                Err(FieldFault::new(
                    "",
                    Fault::expected(value.span, "values of parameters", actual_input),
                ))
            }
            Kind::Array(items) => items
                .iter()
                .enumerate()
                .map(|(i, item)| json_point(item, &format!("[{i}]"), parameters))
                .collect(),
            _ => Ok(vec![json_point(&value, "", parameters)?]),
        }
    };
    json().map_err(|fault: FieldFault| fault.into_error(&source))
}

fn json_lines(source: &Source<'_>, variables: &[String]) -> Result<Vec<Point>, FieldFault> {
    let mut points = Vec::new();
    let mut start = 0;
    for line in source.text.split_inclusive('\n') {
        let end = start + line.len();
        if !line.trim().is_empty() {
            let value = json_value::parse(source.text, start, end).map_err(at(""))?;
            let fields = value.object("an object with a solution").map_err(at(""))?;
            // A singular point that may not be isolated is no solution to start from.
            let undecided = fields.iter().any(|(name, value)| {
                name.text == "undecided" && matches!(value.kind, Kind::Bool(true))
            });
            if undecided {
                start = end;
                continue;
            }
            let point = fields.iter().find(|(name, _)| name.text == "variables");
            let missing = || {
                let actual_input = "an object without it";
                FieldFault::new(
                    "",
                    Fault::expected(value.span, "the field \"variables\"", actual_input),
                )
            };
            let (_, point) = point.ok_or_else(missing)?;
            points.push(json_point(point, "variables", variables)?);
        }
        start = end;
    }
    Ok(points)
}

fn json_point(value: &Value<'_>, field: &str, names: &[String]) -> Result<Point, FieldFault> {
    let mut point = vec![None; names.len()];
    for (name, value) in value
        .object("an object of values by name")
        .map_err(at(field))?
    {
        let inner = match field {
            "" => name.text.to_string(),
            _ => format!("{field}.{}", name.text),
        };
        let span = Span {
            start: name.start,
            end: name.start + name.text.len(),
        };
        let Some(index) = names.iter().position(|n| *n == name.text) else {
            let problem = Problem::unknown(&name.text, names.iter().map(String::as_str));
            return Err(FieldFault::new(field, Fault::new(span, problem)));
        };
        point[index] = Some(json_number(value).map_err(at(&inner))?);
    }
    let complete = complete(&point, names, value.span);
    complete.map_err(at(field))
}

pub(super) fn json_number(value: &Value<'_>) -> Result<Complex64, Fault> {
    let expected = "a finite number";
    let Kind::Array(parts) = &value.kind else {
        return Ok(Complex64::new(value.number("[re, im] or a number")?, 0.0));
    };
    let [re, im] = &parts[..] else {
        let actual_input = format!("a list of {}", parts.len());
        return Err(Fault::expected(value.span, "[re, im]", actual_input));
    };
    Ok(Complex64::new(re.number(expected)?, im.number(expected)?))
}

/// The point, if every name has a value.
fn complete(point: &[Option<Complex64>], names: &[String], span: Span) -> Result<Point, Fault> {
    match point.iter().position(Option::is_none) {
        Some(missing) => {
            let expected = format!("a value for `{}`", names[missing]);
            Err(Fault::expected(span, expected, "none"))
        }
        None => Ok(point.iter().flatten().copied().collect()),
    }
}

/// Words of a text, apart at blanks and semicolons.
struct Words<'a> {
    text: &'a str,
    position: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<(&'a str, Span)> {
        let apart = |c: char| c.is_whitespace() || c == ';';
        let rest = &self.text[self.position..];
        let word = rest.trim_start_matches(apart);
        let start = self.text.len() - word.len();
        let length = word.find(apart).unwrap_or(word.len());
        self.position = start + length;
        let span = Span {
            start,
            end: self.position,
        };
        (length > 0).then(|| (&word[..length], span))
    }

    fn number(&mut self, expected: impl Fn() -> String) -> Result<f64, Fault> {
        match self.next() {
            Some((word, span)) => decimal(word)
                .ok_or_else(|| Fault::expected(span, expected(), format!("`{}`", shorten(word)))),
            None => {
                let end = Span {
                    start: self.text.len(),
                    end: self.text.len(),
                };
                Err(Fault::expected(end, expected(), "the end of the text"))
            }
        }
    }
}

/// Bertini's `start` format (a count of points) or `start_parameters` (a count of parameters).
pub(super) fn bertini(text: &str, coordinates: usize, many: bool) -> Result<Vec<Point>, Fault> {
    let mut words = Words { text, position: 0 };
    let expected = if many {
        "the number of points"
    } else {
        "the number of parameters"
    };
    let (word, span) = words.next().unwrap_or(("", Span::default()));
    let actual_input = if word.is_empty() {
        "an empty file".into()
    } else {
        format!("`{}`", shorten(word))
    };
    let count: usize = word
        .parse()
        .map_err(|_| Fault::expected(span, expected, actual_input))?;
    if !many && count != coordinates {
        let expected = format!("{}, as the system has", counted(coordinates, "parameter"));
        return Err(Fault::expected(span, expected, count.to_string()));
    }
    if many && coordinates == 0 {
        return Err(Fault::new(span, Problem::NoVariables));
    }
    let count = if many { count } else { 1 };
    let mut points = Vec::new();
    for number in 1..=count {
        let mut point = Vec::with_capacity(coordinates);
        for index in 1..=coordinates {
            let place = |part: &str| match many {
                true => {
                    format!("the {part} part of coordinate {index} of point {number} of {count}")
                }
                false => format!("the {part} part of parameter {index} of {coordinates}"),
            };
            let re = words.number(|| place("real"))?;
            let im = words.number(|| place("imaginary"))?;
            point.push(Complex64::new(re, im));
        }
        points.push(point);
    }
    match words.next() {
        None => Ok(points),
        Some((word, span)) => {
            let what = if many {
                counted(count, "point")
            } else {
                "the parameters".into()
            };
            let expected = format!("the end of the file after {what}");
            Err(Fault::expected(
                span,
                expected,
                format!("`{}`", shorten(word)),
            ))
        }
    }
}

/// A line of a text with its place.
#[derive(Clone, Copy)]
struct Line<'a> {
    text: &'a str,
    start: usize,
}

impl Line<'_> {
    fn span(&self) -> Span {
        let lead = self.text.len() - self.text.trim_start().len();
        Span {
            start: self.start + lead,
            end: self.start + self.text.trim_end().len().max(lead),
        }
    }
}

/// PHCpack's list of solutions; in a longer output it is the last one that counts.
fn phcpack(text: &str, variables: &[String]) -> Result<Vec<Point>, Fault> {
    let mut start = 0;
    let lines: Vec<Line<'_>> = text
        .split_inclusive('\n')
        .map(|line| {
            let place = start;
            start += line.len();
            Line {
                text: line,
                start: place,
            }
        })
        .collect();
    let title = lines
        .iter()
        .rposition(|l| l.text.trim_start().starts_with("THE SOLUTIONS"));
    let mut lines = lines[title.map_or(0, |t| t + 1)..]
        .iter()
        .copied()
        .peekable();
    let mut announced: Option<(usize, Span)> = None;
    let mut points = Vec::new();
    while let Some(line) = lines.next() {
        let trimmed = line.text.trim_start();
        if !trimmed.starts_with("solution ") {
            let mut words = trimmed.split_whitespace().map(str::parse::<usize>);
            if points.is_empty()
                && let (Some(Ok(count)), Some(Ok(_)), None) =
                    (words.next(), words.next(), words.next())
            {
                announced = Some((count, line.span()));
            }
            continue;
        }
        let mut point: Vec<Option<Complex64>> = vec![None; variables.len()];
        let mut begun = false;
        while let Some(&inner) = lines.peek() {
            let content = inner.text.trim();
            if content.starts_with("==") || content.starts_with("solution ") {
                break;
            }
            lines.next();
            if !begun || content.is_empty() {
                begun |= content.starts_with("the solution for t");
                continue;
            }
            let (index, value) = phcpack_coordinate(inner, variables)?;
            if point[index].replace(value).is_some() {
                let name = variables[index].clone();
                let first = "has a value in this solution already".into();
                return Err(Fault::new(
                    inner.span(),
                    Problem::DuplicateName { name, first },
                ));
            }
        }
        points.push(complete(&point, variables, line.span())?);
    }
    match announced {
        Some((count, span)) if count != points.len() => {
            let expected = format!("the number of solutions that follow, {}", points.len());
            Err(Fault::expected(span, expected, count.to_string()))
        }
        _ => Ok(points),
    }
}

/// A line ` x :  1.5E+00   0.0E+00`.
fn phcpack_coordinate(line: Line<'_>, variables: &[String]) -> Result<(usize, Complex64), Fault> {
    let form = "a coordinate `name : real part  imaginary part`";
    let actual_input = || format!("`{}`", shorten(line.text.trim()));
    let (name, rest) = line
        .text
        .split_once(':')
        .ok_or_else(|| Fault::expected(line.span(), form, actual_input()))?;
    let name = name.trim();
    let index = variables.iter().position(|v| v == name).ok_or_else(|| {
        Fault::new(
            line.span(),
            Problem::unknown(&shorten(name), variables.iter().map(String::as_str)),
        )
    })?;
    let mut parts = rest.split_whitespace().map(decimal);
    match (parts.next().flatten(), parts.next().flatten(), parts.next()) {
        (Some(re), Some(im), None) => Ok((index, Complex64::new(re, im))),
        _ => Err(Fault::expected(line.span(), form, actual_input())),
    }
}
