//! Targets: the values of the parameters at which solutions are wanted, from files and typed texts.
//!
//! Each source gives values to some parameters; several are combined, all with all, the last of them fastest.

use super::json_value::{self, Kind, Text, Value};
use super::points::{Point, bertini, json_number};
use super::scope::{FieldFault, at};
use super::target_block::Block;
use super::{FormatError, Source, Warning, decode, limits, number_list, target_table};
use crate::expression::fault::{Fault, Problem, Span};
use crate::expression::parse::accuracy_of_decimals;
use crate::expression::token::shorten;
use cognate_numeric::counted::counted;
use num_complex::Complex64;

/// A file with values of parameters, or a text such as `omega=linspace(0.5, 2, 100)`.
#[derive(Clone, Copy, Debug)]
pub struct TargetSource<'a> {
    /// The file's name, or that of the option.
    pub name: &'a str,
    /// Bytes of the file, or of the text.
    pub content: &'a [u8],
    /// Whether this is a text `NAME=VALUES` of the command line.
    pub is_typed: bool,
}

/// All targets, with warnings where an input has a second possible meaning.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Targets {
    /// The targets, each with a value for each parameter.
    pub values: Vec<Point>,
    /// Largest relative accuracy of a rounded decimal among them; 0 where all are exact.
    pub data_accuracy: f64,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// Reads the targets of all sources.
pub fn read(sources: &[TargetSource<'_>], parameters: &[String]) -> Result<Targets, FormatError> {
    let mut targets = Targets::default();
    let mut blocks = Vec::new();
    let mut texts: Vec<Source<'_>> = Vec::new();
    for source in sources {
        let text = decode(source.name, source.content, limits::POINT_FILE_BYTES)?;
        let text = Source {
            name: source.name,
            text,
        };
        let warnings = &mut targets.warnings;
        let block = block(source, &text, parameters, warnings);
        let block = block.map_err(|fault| fault.into_error(&text))?;
        targets.data_accuracy = targets.data_accuracy.max(accuracy_of_decimals(text.text));
        check_new(&blocks, &block, parameters).map_err(|fault| text.error(fault))?;
        blocks.push(block);
        texts.push(text);
    }
    if let (Some(text), Some(block)) = (texts.last(), blocks.last()) {
        check_complete(&blocks, block.span, parameters).map_err(|fault| text.error(fault))?;
        let combined = combined(&blocks, block.span, parameters.len());
        targets.values = combined.map_err(|fault| text.error(fault))?;
    }
    Ok(targets)
}

/// The values of one source.
fn block(
    source: &TargetSource<'_>,
    text: &Source<'_>,
    parameters: &[String],
    warnings: &mut Vec<Warning>,
) -> Result<Block, FieldFault> {
    let content = text.text.trim_start();
    if source.is_typed {
        return typed(text.text, parameters).map_err(at(""));
    }
    if content.starts_with(['{', '[']) {
        return json(text, parameters, warnings);
    }
    let is_count = |word: &str| word.bytes().all(|b| b.is_ascii_digit());
    let mut words = content.split(|c: char| c.is_whitespace() || c == ';');
    match words.next() {
        Some(word) if !is_count(word) => target_table::read(text.text, parameters),
        _ => Ok(Block {
            parameters: (0..parameters.len()).collect(),
            rows: bertini(text.text, parameters.len(), false).map_err(at(""))?,
            span: Span::default(),
        }),
    }
}

/// The index of a parameter.
fn index(name: &str, span: Span, parameters: &[String]) -> Result<usize, Fault> {
    let index = parameters.iter().position(|parameter| parameter == name);
    index.ok_or_else(|| {
        let expected = format!("the name of a parameter ({})", parameters.join(", "));
        Fault::expected(span, expected, format!("`{}`", shorten(name)))
    })
}

/// `NAME=VALUES`, or one value of each of several parameters: `NAME=VALUE, NAME=VALUE`.
fn typed(text: &str, parameters: &[String]) -> Result<Block, Fault> {
    let whole = Span {
        start: 0,
        end: text.len(),
    };
    let assignments = parts_outside_brackets(text, whole, &[',', ';']);
    let is_assignment = |part: &Span| text[part.start..part.end].contains('=');
    if assignments
        .iter()
        .filter(|part| is_assignment(part))
        .count()
        > 1
    {
        return several_assignments(text, &assignments, parameters);
    }
    let form = "NAME=VALUES, as in omega=linspace(0.5, 2, 100)";
    let missing = || Fault::expected(whole, form, format!("`{}`", shorten(text)));
    let (name, _) = text.split_once('=').ok_or_else(missing)?;
    let span = Span {
        start: 0,
        end: name.len(),
    };
    let values = Span {
        start: name.len() + 1,
        end: text.len(),
    };
    let parameter = index(name.trim(), span, parameters)?;
    let values = number_list::list(text, values)?;
    Ok(Block {
        parameters: vec![parameter],
        rows: values.into_iter().map(|value| vec![value]).collect(),
        span,
    })
}

/// One target: a value of each of these parameters.
fn several_assignments(
    text: &str,
    assignments: &[Span],
    parameters: &[String],
) -> Result<Block, Fault> {
    let mut values: Vec<(usize, Complex64)> = Vec::new();
    for part in assignments {
        let said = &text[part.start..part.end];
        let fault = |span: Span| {
            let expected = "one value of each parameter, as in a=1, b=2; a list of values of one parameter stands in \
                            --targets of its own";
            Fault::expected(span, expected, format!("`{}`", shorten(said.trim())))
        };
        let (name, _) = said.split_once('=').ok_or_else(|| fault(*part))?;
        let span = Span {
            start: part.start,
            end: part.start + name.len(),
        };
        let value = Span {
            start: span.end + 1,
            end: part.end,
        };
        let parameter = index(name.trim(), span, parameters)?;
        if values.iter().any(|(other, _)| *other == parameter) {
            let problem = Problem::DuplicateName {
                name: parameters[parameter].clone(),
                first: "has a value already".into(),
            };
            return Err(Fault::new(span, problem));
        }
        match number_list::list(text, value)?[..] {
            [only] => values.push((parameter, only)),
            _ => return Err(fault(value)),
        }
    }
    values.sort_by_key(|(parameter, _)| *parameter);
    Ok(Block {
        parameters: values.iter().map(|(parameter, _)| *parameter).collect(),
        rows: vec![values.iter().map(|(_, value)| *value).collect()],
        span: Span {
            start: 0,
            end: text.len(),
        },
    })
}

/// The parts of `text[span.start..span.end]` between these signs, as far as no bracket is open there.
fn parts_outside_brackets(text: &str, span: Span, signs: &[char]) -> Vec<Span> {
    let mut depth = 0_usize;
    let mut parts = Vec::new();
    let mut start = span.start;
    for (at, c) in text[span.start..span.end].char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            c if depth == 0 && signs.contains(&c) => {
                let end = span.start + at;
                parts.push(Span { start, end });
                start = end + 1;
            }
            _ => {}
        }
    }
    parts.push(Span {
        start,
        end: span.end,
    });
    parts
}

/// Reads an object of values by name, a list of these objects, or a list of values in the order of the parameters.
fn json(
    source: &Source<'_>,
    parameters: &[String],
    warnings: &mut Vec<Warning>,
) -> Result<Block, FieldFault> {
    let value = json_value::parse(source.text, 0, source.text.len()).map_err(at(""))?;
    let Kind::Array(items) = &value.kind else {
        let fields = value
            .object("an object of values by name")
            .map_err(at(""))?;
        warn_of_pairs(source, fields, warnings);
        return object(&value, "", parameters);
    };
    let mut whole: Option<Block> = None;
    for (number, item) in items.iter().enumerate() {
        let field = format!("[{number}]");
        let block = match item.kind {
            Kind::Object(_) => object(item, &field, parameters)?,
            _ => in_order(item, &field, parameters)?,
        };
        let Some(whole) = &mut whole else {
            whole = Some(block);
            continue;
        };
        let differing = difference(&whole.parameters, &block.parameters);
        if let Some((parameter, is_missing_here)) = differing {
            let expected = format!("a value for `{}`", parameters[parameter]);
            let (span, field) = match is_missing_here {
                true => (item.span, field),
                false => (whole.span, "[0]".to_owned()),
            };
            return Err(FieldFault::new(
                field,
                Fault::expected(span, expected, "none"),
            ));
        }
        let size = (whole.rows.len() + block.rows.len()) as u64;
        if size > limits::TARGETS.value {
            let fault = Fault::limit(item.span, limits::TARGETS, size);
            return Err(FieldFault::new(field, fault));
        }
        whole.rows.extend(block.rows);
    }
    let nothing = || Fault::expected(value.span, "values of parameters", "an empty list");
    whole.ok_or_else(|| FieldFault::new("", nothing()))
}

/// A parameter that one of two ascending lists has alone, and whether the first list is the one.
fn difference(first: &[usize], second: &[usize]) -> Option<(usize, bool)> {
    let missing = first.iter().find(|p| !second.contains(p));
    let more = second.iter().find(|p| !first.contains(p));
    let missing = missing.map(|p| (*p, true));
    missing.or_else(|| more.map(|p| (*p, false)))
}

/// Reads one target from a list of values in the order of the parameters, or from the value of the only parameter.
fn in_order(item: &Value<'_>, field: &str, parameters: &[String]) -> Result<Block, FieldFault> {
    let expected = match parameters.len() {
        1 => "an object of values by name, a number or [re, im]".to_owned(),
        n => format!(
            "an object of values by name, or a list of {n} values in the order of the parameters"
        ),
    };
    let wrong = |actual_input: String| {
        FieldFault::new(
            field,
            Fault::expected(item.span, expected.clone(), actual_input),
        )
    };
    let row = match (&item.kind, parameters.len()) {
        (Kind::Array(values), n) if n > 1 && values.len() == n => {
            let values = values.iter().enumerate();
            let values = values
                .map(|(place, value)| json_number(value).map_err(at(&format!("{field}[{place}]"))));
            values.collect::<Result<Point, FieldFault>>()?
        }
        (Kind::Array(values), n) if n > 1 => {
            return Err(wrong(format!("a list of {}", values.len())));
        }
        (Kind::Array(_) | Kind::Number(_), 1) => vec![json_number(item).map_err(at(field))?],
        _ => return Err(wrong(item.describe())),
    };
    Ok(Block {
        parameters: (0..parameters.len()).collect(),
        rows: vec![row],
        span: item.span,
    })
}

/// Values by name: lists of one length run together, a single value stays.
fn object(value: &Value<'_>, field: &str, parameters: &[String]) -> Result<Block, FieldFault> {
    let fields = value
        .object("an object of values by name")
        .map_err(at(field))?;
    let mut columns: Vec<(usize, Vec<Complex64>)> = Vec::new();
    let mut longest: Option<(&str, usize)> = None;
    for (name, value) in fields {
        let inner = match field {
            "" => name.text.to_string(),
            _ => format!("{field}.{}", name.text),
        };
        let span = Span {
            start: name.start,
            end: name.start + name.text.len(),
        };
        let parameter = index(&name.text, span, parameters).map_err(at(field))?;
        let values = match single(value) {
            true => vec![json_number(value).map_err(at(&inner))?],
            false => several(value, &inner)?,
        };
        if !single(value) {
            match longest {
                Some((other, length)) if length != values.len() => {
                    let expected = format!("{}, as `{other}` has", counted(length, "value"));
                    let fault = Fault::expected(value.span, expected, values.len().to_string());
                    return Err(FieldFault::new(inner, fault));
                }
                _ => longest = Some((&name.text, values.len())),
            }
        }
        columns.push((parameter, values));
    }
    columns.sort_by_key(|(parameter, _)| *parameter);
    let row = |k: usize| {
        let values = columns.iter().map(|(_, values)| match values.as_slice() {
            [only] => *only,
            values => values[k],
        });
        values.collect::<Point>()
    };
    let count = longest.map_or(1, |(_, length)| length);
    let size = (count * columns.len()) as u64;
    if size > limits::TARGET_VALUES.value {
        let fault = Fault::limit(value.span, limits::TARGET_VALUES, size);
        return Err(FieldFault::new(field, fault));
    }
    Ok(Block {
        rows: (0..count).map(row).collect(),
        parameters: columns.iter().map(|(parameter, _)| *parameter).collect(),
        span: value.span,
    })
}

/// Whether this is one value: a number, a text of one number, or the real and imaginary part of one.
fn single(value: &Value<'_>) -> bool {
    match &value.kind {
        Kind::Array(parts) => {
            parts.len() == 2
                && parts
                    .iter()
                    .all(|part| !matches!(part.kind, Kind::Array(_)))
        }
        Kind::Text(text) => json_value::decimal(&text.text).is_some(),
        _ => true,
    }
}

/// A list of numbers and pairs, or a text such as `linspace(0, 1, 100)`.
fn several(value: &Value<'_>, field: &str) -> Result<Vec<Complex64>, FieldFault> {
    let mut values = Vec::new();
    match &value.kind {
        Kind::Text(text) => {
            let whole = Span {
                start: 0,
                end: text.text.len(),
            };
            values = number_list::list(&text.text, whole).map_err(|fault| {
                let span = text.span(fault.span);
                FieldFault::new(field, Fault { span, ..fault })
            })?;
        }
        Kind::Array(items) => {
            for (number, item) in items.iter().enumerate() {
                let inner = format!("{field}[{number}]");
                let next = json_number(item).map_err(at(&inner))?;
                let next = std::iter::once(next);
                number_list::extend(&mut values, next, item.span).map_err(at(&inner))?;
            }
        }
        _ => {}
    }
    match values.is_empty() {
        true => {
            let fault = Fault::expected(value.span, "at least one value", "an empty list");
            Err(FieldFault::new(field, fault))
        }
        false => Ok(values),
    }
}

/// Says that two numbers are one complex value, where two values may be meant: beside a longer list, or where no other
/// value is a pair.
fn warn_of_pairs(
    source: &Source<'_>,
    fields: &[(Text<'_>, Value<'_>)],
    warnings: &mut Vec<Warning>,
) {
    let is_pair = |value: &Value<'_>| matches!(value.kind, Kind::Array(_)) && single(value);
    let pairs: Vec<_> = fields.iter().filter(|(_, value)| is_pair(value)).collect();
    let has_longer_list = fields.iter().any(|(_, value)| !single(value));
    if !has_longer_list && pairs.len() != 1 {
        return;
    }
    for (name, value) in pairs {
        let is_complex = json_number(value).is_ok_and(|z| z.im != 0.0);
        if !is_complex && !has_longer_list {
            continue;
        }
        let shown = &source.text[value.span.start..value.span.end];
        warnings.push(Warning {
            file: source.name.to_owned(),
            line: source.line_and_column(value.span.start).0,
            message: format!(
                "`{}`: {} is one complex value [re, im]; two values are written as [[0.5, 0], [1, 0]]",
                name.text,
                shorten(shown)
            ),
        });
    }
}

/// A parameter has its values from one source.
fn check_new(blocks: &[Block], block: &Block, parameters: &[String]) -> Result<(), Fault> {
    let is_given = |p: &&usize| blocks.iter().any(|b| b.parameters.binary_search(p).is_ok());
    match block.parameters.iter().find(is_given) {
        None => Ok(()),
        Some(parameter) => {
            let problem = Problem::DuplicateName {
                name: parameters[*parameter].clone(),
                first: "has values already; several values stand in one list".into(),
            };
            Err(Fault::new(block.span, problem))
        }
    }
}

/// Every parameter has values.
fn check_complete(blocks: &[Block], span: Span, parameters: &[String]) -> Result<(), Fault> {
    let is_given = |p: &usize| blocks.iter().any(|b| b.parameters.binary_search(p).is_ok());
    let missing = (0..parameters.len()).filter(|p| !is_given(p));
    let missing: Vec<String> = missing.map(|p| format!("`{}`", parameters[p])).collect();
    match missing.len() {
        0 => Ok(()),
        1 => Err(Fault::expected(
            span,
            format!("a value for {} too", missing[0]),
            "none",
        )),
        _ => Err(Fault::expected(
            span,
            format!("values for {} too", missing.join(", ")),
            "none",
        )),
    }
}

/// All combinations of the rows of the blocks, the last block runs fastest.
fn combined(blocks: &[Block], span: Span, parameters: usize) -> Result<Vec<Point>, Fault> {
    let sizes = blocks.iter().map(|block| block.rows.len() as u64);
    let count = sizes.fold(1u64, u64::saturating_mul);
    if count > limits::TARGETS.value {
        return Err(Fault::limit(span, limits::TARGETS, count));
    }
    let size = count.saturating_mul(parameters as u64);
    if size > limits::TARGET_VALUES.value {
        return Err(Fault::limit(span, limits::TARGET_VALUES, size));
    }
    let target = |number: u64| {
        let mut values = vec![Complex64::new(0.0, 0.0); parameters];
        let mut rest = number;
        for block in blocks.iter().rev() {
            let length = block.rows.len() as u64;
            let row = &block.rows[(rest % length) as usize];
            rest /= length;
            for (parameter, value) in block.parameters.iter().zip(row) {
                values[*parameter] = *value;
            }
        }
        values
    };
    Ok((0..count).map(target).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Vec<String> {
        ["omega", "d"].map(str::to_owned).to_vec()
    }

    /// Targets of files, or of typed texts where these have a `=`.
    fn check(texts: &[&str]) -> Result<Targets, String> {
        let sources: Vec<TargetSource<'_>> = texts
            .iter()
            .map(|text| TargetSource {
                name: "t",
                content: text.as_bytes(),
                is_typed: text.contains('='),
            })
            .collect();
        read(&sources, &names()).map_err(|error| error.to_string())
    }

    fn reals(texts: &[&str]) -> Vec<[f64; 2]> {
        let targets = match check(texts) {
            Ok(targets) => targets,
            Err(error) => panic!("{texts:?}: {error}"),
        };
        let values = targets.values.iter();
        values.map(|values| [values[0].re, values[1].re]).collect()
    }

    #[test]
    fn values_are_read_in_every_form() {
        let three = [[0.5, 0.1], [1.0, 0.1], [2.0, 0.1]];
        for texts in [
            &[r#"{"omega": [0.5, 1, 2], "d": 0.1}"#][..],
            &[r#"{"omega": "0.5, 1, 2", "d": [0.1, 0]}"#],
            &[r#"{"d": [0.1, 0.1, "0.1"], "omega": [[0.5, 0], 1, [2, 0]]}"#],
            &[r#"[{"omega": 0.5, "d": 0.1}, {"d": 0.1, "omega": [1, 2, 2]}]"#],
            &["[[0.5, 0.1], [1, 0.1], [2, [0.1, 0]]]"],
            &["omega=0.5,1,2", "d=0.1"],
            &["omega = 0.5,1, 2", r#"{"d": 0.1}"#],
            &["omega,d\n0.5,0.1\n1,0.1\n2,0.1\n"],
            &["\"d\" ; omega_im; omega_re\r\n 1/10; 0; 0.5\r\n\r\n0.1;0;1\r\n0.1;0;2"],
            &["d\tomega\n0.1\t0.5\n0.1\t1+0*I\n0.1\t2"],
            &["omega\n0.5\n1\n2\n", "d=0.1"],
        ] {
            let expected = match texts[0].contains("[1, 2, 2]") {
                true => vec![three[0], three[1], three[2], three[2]],
                false => three.to_vec(),
            };
            assert_eq!(reals(texts), expected, "{texts:?}");
        }
        assert_eq!(reals(&["2\n\n0.5 0\n0.1 0\n"]), [three[0]]);
        let grid = reals(&["d=1,2", "omega=linspace(0, 1, 3)"]);
        let expected = [
            [0.0, 1.0],
            [0.5, 1.0],
            [1.0, 1.0],
            [0.0, 2.0],
            [0.5, 2.0],
            [1.0, 2.0],
        ];
        assert_eq!(grid, expected);
        let complex = check(&[r#"{"omega": [0.5, 1], "d": [0.25, -1]}"#]).expect("as before");
        let values = [Complex64::new(0.5, 1.0), Complex64::new(0.25, -1.0)];
        assert_eq!(
            (complex.values, complex.warnings),
            (vec![values.to_vec()], vec![])
        );
        let only = |text: &str| {
            let source = TargetSource {
                name: "t",
                content: text.as_bytes(),
                is_typed: false,
            };
            read(&[source], &names()[..1]).map(|targets| targets.values.len())
        };
        assert_eq!(only("[1, [2, 0], 3]"), Ok(3));
        assert_eq!(only("[0.5, 1]"), Ok(2));
    }

    /// As in equations, decimals of eight digits and more are rounded, and those of doubles have no more digits than these.
    #[test]
    fn the_worst_decimal_says_the_accuracy_of_the_targets() {
        let sqrt_of_three = 0.5 / 173_205_080.0;
        for (texts, accuracy) in [
            (&["omega=1.73205080", "d=0.1234567890"][..], sqrt_of_three),
            (&["omega,d\n0.5,-1.73205080e-3\n0.25,1\n"], sqrt_of_three),
            (&[r#"{"omega": [1.73205080, 2], "d": 0.5}"#], sqrt_of_three),
            (&[r#"[{"omega": 0.5, "d": 173205080e1}]"#], sqrt_of_three),
            (&["2\n0.5 1.73205080\n0.1 0\n"], sqrt_of_three),
            (&["omega=2+1.73205080*sqrt(2)", "d=1.5"], sqrt_of_three),
            (&["omega=2+1.73205080I", "d=1.5"], sqrt_of_three),
            (&["omega=0.30000000000000004, d=1e-14"], f64::EPSILON / 2.0),
            (&["omega=linspace(0.5, 2, 12)", "d=0.0000000000"], 0.0),
            (&["omega=0.30000000000000000004", "d=1"], 0.5 / 3e19),
            (&["omega=0.0000125,1/3", "d=123456789"], 0.0),
        ] {
            let said = check(texts).expect(texts[0]).data_accuracy;
            assert!(
                (said - accuracy).abs() <= 1e-9 * accuracy,
                "{texts:?}: {said}"
            );
        }
    }

    #[test]
    fn several_parameters_are_typed_in_one_text_and_constants_are_computed() {
        for text in [
            "omega=1, d=-2",
            "d = -2; omega = 1",
            "d=-sqrt(4),omega=cos(0)",
        ] {
            assert_eq!(reals(&[text]), [[1.0, -2.0]], "{text}");
        }
        let computed = reals(&["omega=sqrt(2), d=pi/2"]);
        assert_eq!(
            computed,
            [[std::f64::consts::SQRT_2, std::f64::consts::FRAC_PI_2]]
        );
        let listed = reals(&["omega=sqrt(9), linspace(0, 1, 2), 2^3", "d=1"]);
        let omegas: Vec<f64> = listed.iter().map(|[omega, _]| *omega).collect();
        assert_eq!(omegas, [3.0, 0.0, 1.0, 8.0]);
        refused(&[
            (
                &["omega=1, omega=2"],
                "t:1:9: expected a new name, found `omega`",
            ),
            (
                &["omega=1, 2, d=3"],
                "t:1:9: expected one value of each parameter, as in a=1, b=2",
            ),
            (
                &["omega=linspace(0,1,2), d=3"],
                "t:1:7: expected one value of each parameter",
            ),
            (
                &["omega=1, x=3"],
                "expected the name of a parameter (omega, d), found `x`",
            ),
            (&["omega=sqrt(x), d=3"], "t:1:7: expected a number such as"),
            (&["omega=1/0, d=3"], "t:1:7: expected a finite number"),
        ]);
    }

    #[test]
    fn two_numbers_that_may_be_two_values_are_said_to_be_one() {
        for (text, count) in [
            (r#"{"omega": [0.5, 1], "d": 0.1}"#, 1),
            (r#"{"omega": [0.5, 0], "d": 0.1}"#, 0),
            (r#"{"omega": [0.5, 1], "d": [1, 2, 3]}"#, 1),
            (r#"[{"omega": [0.5, 1], "d": 3}]"#, 0),
        ] {
            let warnings = check(&[text]).expect(text).warnings;
            assert_eq!(warnings.len(), count, "{text}: {warnings:?}");
        }
    }

    /// Checks that each reading is refused with the text that stands beside it.
    fn refused(readings: &[(&[&str], &str)]) {
        for (texts, expected) in readings {
            let said = check(texts).expect_err(texts[0]);
            assert!(said.contains(expected), "{texts:?}: {said}");
        }
    }

    #[test]
    fn wrong_values_by_name_are_refused_with_their_place() {
        refused(&[
            (
                &["[]"],
                "t:1:1: expected values of parameters, found an empty list",
            ),
            (
                &[r#"{"omega": 1}"#],
                "t:1:1: expected a value for `d` too, found none",
            ),
            (&["omega=1"], "t:1:1: expected a value for `d` too"),
            (&[r#"{}"#], "t:1:1: expected values for `omega`, `d` too"),
            (
                &[r#"{"omega": 1, "x": 2}"#],
                "t:1:15: expected the name of a parameter (omega, d), found `x`",
            ),
            (
                &["x=1"],
                "t:1:1: expected the name of a parameter (omega, d), found `x`",
            ),
            (
                &["omega=1", "omega=2"],
                "t:1:1: expected a new name, found `omega`, which has values already",
            ),
            (
                &[r#"{"omega": [1, 2, 3], "d": [1, 2, 3, 4]}"#],
                "t:1:27: d: expected 3 values, as `omega` has, found 4",
            ),
            (
                &[r#"{"omega": [], "d": 1}"#],
                "t:1:11: omega: expected at least one value",
            ),
            (
                &[r#"{"omega": [1, true, 2], "d": 1}"#],
                "t:1:15: omega[1]: expected [re, im] or a number, found true",
            ),
            (
                &[r#"{"omega": "linspace(0, 1)", "d": 1}"#],
                "t:1:25: omega: expected `,`",
            ),
            (
                &[r#"[{"omega": 1, "d": 2}, {"omega": 1}]"#],
                "t:1:24: [1]: expected a value for `d`, found none",
            ),
            (
                &[r#"[{"omega": 1}, {"omega": 1, "d": 2}]"#],
                "t:1:2: [0]: expected a value for `d`, found none",
            ),
            (
                &["[[1, 2, 3]]"],
                "t:1:2: [0]: expected an object of values by name, or a list of 2 values",
            ),
            (
                &["[1, 2]"],
                "t:1:2: [0]: expected an object of values by name",
            ),
        ]);
    }

    #[test]
    fn wrong_tables_are_refused_with_their_place() {
        refused(&[
            (
                &["omega,d\n1,2\n3\n"],
                "t:3:1: expected 2 values, as the header has, found fewer",
            ),
            (
                &["omega,d\n1,2,3\n"],
                "t:2:5: expected the end of the line after 2 values, found `3`",
            ),
            (&["omega,d\n1,two\n"], "t:2:3: d: expected a number such as"),
            (&["omega,d\n1,\n"], "t:2:3: d: expected a number such as"),
            (
                &["omega,x\n1,2\n"],
                "t:1:7: expected a header with names of parameters (omega, d), found `x`",
            ),
            (
                &["omega,omega\n1,2\n"],
                "t:1:7: expected a new name, found `omega`, which has a column already",
            ),
            (
                &["omega_re,d\n1,2\n"],
                "t:1:1: expected a column `omega_im` too, found `omega_re` alone",
            ),
            (
                &["omega_re,omega_im,d\nI,0,2\n"],
                "t:2:1: omega_re: expected a real number",
            ),
            (
                &["omega,d\n"],
                "t:1:1: expected a line of values below the header",
            ),
            (&["omega\n1\n"], "t:1:1: expected a value for `d` too"),
            (
                &["3\n1 2\n"],
                "t:1:1: expected 2 parameters, as the system has, found 3",
            ),
        ]);
    }

    #[test]
    fn too_many_targets_are_refused() {
        refused(&[
            (&["omega=linspace(0,1,2000000)", "d=1"], "limit TARGETS"),
            (
                &["omega=linspace(0,1,2000)", "d=linspace(0,1,2000)"],
                "4000000 (not in this version: limit TARGETS)",
            ),
        ]);
    }

    #[test]
    fn many_values_of_many_parameters_are_refused_before_they_are_made() {
        let names: Vec<String> = (0..1000).map(|k| format!("p{k}")).collect();
        let header = names[1..].join(",");
        let line = vec!["1"; 999].join(",");
        let table = format!("{header}\n{line}\n");
        let typed = "p0=linspace(0, 1, 100000)";
        let sources = [(table.as_str(), false), (typed, true)];
        let sources = sources.map(|(text, is_typed)| TargetSource {
            name: "t",
            content: text.as_bytes(),
            is_typed,
        });
        let said = read(&sources, &names).map_err(|error| error.to_string());
        assert!(said.is_err_and(|text| text.contains("limit TARGET_VALUES")));
    }
}
