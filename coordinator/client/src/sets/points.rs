//! Points that are asked about: CSV with a header of variables, JSON, or solutions.jsonl. Numbers may be fractions.

use super::wrong;
use crate::error::ClientError;
use crate::output::text::counted;
use crate::problem::read_file;
use cognate_solutions::witness::question::GivenPoint;
use num_complex::Complex64;
use serde_json::Value;
use std::path::Path;

/// Number of significant digits from which a decimal is known to half a unit of its last digit.
const ROUNDED_DIGITS: usize = 8;

/// The points of a file; `accuracy` replaces what their digits say.
pub fn read(
    path: &Path,
    variables: &[String],
    accuracy: Option<f64>,
) -> Result<Vec<GivenPoint>, ClientError> {
    let (name, content) = read_file(path)?;
    let text = String::from_utf8(content).map_err(|e| {
        let byte = e.utf8_error().valid_up_to() + 1;
        wrong(&name, &format!("is no text: byte {byte} is not UTF-8"))
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let mut points = match text.trim_start().chars().next() {
        Some('{' | '[') => json(&name, text, variables)?,
        _ => csv(&name, text, variables)?,
    };
    if points.is_empty() {
        return Err(wrong(&name, "holds no point"));
    }
    if let Some(accuracy) = accuracy {
        points.iter_mut().for_each(|p| p.accuracy = accuracy);
    }
    Ok(points)
}

/// A number, and its error.
type Read = (Complex64, f64);

fn point(values: Vec<Read>) -> GivenPoint {
    let size = values
        .iter()
        .map(|(z, _)| z.norm_sqr())
        .sum::<f64>()
        .sqrt()
        .max(1.0);
    let error = values.iter().map(|(_, e)| e * e).sum::<f64>().sqrt();
    GivenPoint {
        accuracy: (error / size).clamp(f64::EPSILON, 0.5),
        values: values.into_iter().map(|(z, _)| z).collect(),
    }
}

/// A real number or a fraction, and its error.
fn real(text: &str) -> Option<(f64, f64)> {
    if let Some((p, q)) = text.split_once('/') {
        let (p, q) = (p.trim().parse::<f64>().ok()?, q.trim().parse::<f64>().ok()?);
        let value = p / q;
        return value
            .is_finite()
            .then_some((value, value.abs() * f64::EPSILON));
    }
    let value: f64 = text.parse().ok()?;
    let mantissa = text.split(['e', 'E']).next().unwrap_or(text);
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let significant = digits.trim_start_matches('0').len();
    let half = match significant < ROUNDED_DIGITS {
        true => f64::EPSILON,
        false => 5.0 * 10f64.powi(-(significant.min(17) as i32)),
    };
    value
        .is_finite()
        .then_some((value, value.abs() * half.max(f64::EPSILON)))
}

/// A number such as `3/5`, `0.25` or `1-2i`.
fn number(text: &str) -> Option<Read> {
    let text = text.trim();
    let Some(imaginary) = text.strip_suffix(['i', 'I']) else {
        return real(text).map(|(x, e)| (Complex64::new(x, 0.0), e));
    };
    let bytes = imaginary.as_bytes();
    let splits =
        |k: &usize| matches!(bytes[*k], b'+' | b'-') && !matches!(bytes[k - 1], b'e' | b'E');
    let split = (1..bytes.len()).rev().find(splits).unwrap_or(0);
    let (first, second) = imaginary.split_at(split);
    let second = second.trim().trim_end_matches('*');
    let second = match second {
        "" | "+" => (1.0, 0.0),
        "-" => (-1.0, 0.0),
        other => real(other)?,
    };
    let first = if first.trim().is_empty() {
        (0.0, 0.0)
    } else {
        real(first.trim())?
    };
    Some((Complex64::new(first.0, second.0), first.1 + second.1))
}

fn csv(name: &str, text: &str, variables: &[String]) -> Result<Vec<GivenPoint>, ClientError> {
    let rows = text.lines().enumerate();
    let mut rows = rows.filter(|(_, row)| !row.trim().is_empty() && !row.starts_with('#'));
    let (_, header) = rows.next().unwrap_or((0, ""));
    let between = [',', ';', '\t']
        .into_iter()
        .find(|&c| header.contains(c))
        .unwrap_or(',');
    let names: Vec<&str> = header.split(between).map(str::trim).collect();
    let place = |variable: &String| names.iter().position(|n| n == variable);
    let places: Option<Vec<usize>> = variables.iter().map(place).collect();
    let Some(places) = places.filter(|_| names.len() == variables.len()) else {
        let message = format!(
            "line 1: `{}`; expected a header with the variables {}",
            header.chars().take(80).collect::<String>(),
            variables.join(",")
        );
        return Err(wrong(name, &message));
    };
    let mut points = Vec::new();
    for (line, row) in rows {
        let origin = format!("{name}:{}", line + 1);
        let cells: Vec<&str> = row.split(between).collect();
        if cells.len() != names.len() {
            let message = format!("{} fields; expected {}", cells.len(), names.len());
            return Err(wrong(&origin, &message));
        }
        let values = places.iter().map(|&k| {
            number(cells[k]).ok_or_else(|| {
                let message = format!(
                    "field {} is `{}`; expected a number",
                    names[k],
                    cells[k].trim()
                );
                wrong(&origin, &message)
            })
        });
        points.push(point(values.collect::<Result<_, _>>()?));
    }
    Ok(points)
}

fn json(name: &str, text: &str, variables: &[String]) -> Result<Vec<GivenPoint>, ClientError> {
    // A whole value, or a value on each line.
    if let Ok(value) = serde_json::from_str::<Value>(text) {
        return whole(name, &value, variables);
    }
    let mut points = Vec::new();
    for (line, row) in text.lines().enumerate() {
        if row.trim().is_empty() {
            continue;
        }
        let origin = format!("{name}:{}", line + 1);
        let value: Value = serde_json::from_str(row).map_err(|e| {
            wrong(
                &format!("{origin}:{}", e.column()),
                &format!("is no JSON: {e}"),
            )
        })?;
        points.push(one(&origin, &value, variables)?);
    }
    Ok(points)
}

fn whole(name: &str, value: &Value, variables: &[String]) -> Result<Vec<GivenPoint>, ClientError> {
    let list = match value {
        Value::Array(list) => list,
        Value::Object(fields) if fields.contains_key("points") => match &fields["points"] {
            Value::Array(list) => list,
            _ => return Err(wrong(name, "`points` is no list")),
        },
        single => return Ok(vec![one(name, single, variables)?]),
    };
    let each = list.iter().enumerate();
    each.map(|(k, value)| one(&format!("{name}: point {}", k + 1), value, variables))
        .collect()
}

/// One point: a list of numbers in the order of the variables, an object by names, or a line of solutions.jsonl.
fn one(origin: &str, value: &Value, variables: &[String]) -> Result<GivenPoint, ClientError> {
    let coordinate = |name: &str, value: &Value| {
        json_number(value).ok_or_else(|| {
            let message = format!("{name} is {value}; expected a number, a fraction or [re, im]");
            wrong(origin, &message)
        })
    };
    let count = |coordinates: usize| {
        let message = format!(
            "{}; expected {}",
            counted(coordinates as u64, "coordinate"),
            variables.len()
        );
        wrong(origin, &message)
    };
    match value {
        Value::Array(list) => {
            if list.len() != variables.len() {
                return Err(count(list.len()));
            }
            let pairs = variables.iter().zip(list);
            let values = pairs.map(|(name, value)| coordinate(name, value));
            Ok(point(values.collect::<Result<_, _>>()?))
        }
        Value::Object(fields) => {
            let named = fields
                .get("variables")
                .and_then(Value::as_object)
                .unwrap_or(fields);
            let value_of = |name: &String| {
                let value = named.get(name);
                value.ok_or_else(|| wrong(origin, &format!("no value of {name}")))
            };
            let values = variables
                .iter()
                .map(|name| coordinate(name, value_of(name)?));
            let mut given_point = point(values.collect::<Result<_, _>>()?);
            if let Some(accuracy) = fields.get("accuracy").and_then(Value::as_f64) {
                given_point.accuracy = accuracy.clamp(f64::EPSILON, 0.5);
            }
            Ok(given_point)
        }
        _ => Err(wrong(origin, "is no point; expected a list or an object")),
    }
}

fn json_number(value: &Value) -> Option<Read> {
    match value {
        Value::Number(n) => number(&n.to_string()),
        Value::String(text) => number(text),
        Value::Array(pair) => match pair.as_slice() {
            [re, im] => {
                let (re, im) = (json_number(re)?, json_number(im)?);
                Some((Complex64::new(re.0.re, im.0.re), re.1 + im.1))
            }
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Vec<String> {
        vec!["x".into(), "y".into()]
    }

    #[test]
    fn points_are_read_in_every_form() {
        let expected = [Complex64::new(0.6, 0.0), Complex64::new(1.0, -2.0)];
        let forms = [
            "x,y\n3/5,1-2i\n",
            "y;x\n1-2i;0.6\n",
            r#"[["3/5", [1, -2]]]"#,
            r#"{"points": [[0.6, "1-2i"]]}"#,
            "{\"x\": [0.6, 0], \"y\": [1, -2]}\n{\"x\": [0.6, 0], \"y\": [1, -2]}\n",
            r#"{"variables": {"x": [0.6, 0], "y": [1, -2]}, "accuracy": 1e-12}"#,
        ];
        for text in forms {
            let points = match text.starts_with(['{', '[']) {
                true => json("test", text, &names()),
                false => csv("test", text, &names()),
            };
            let points = points.unwrap();
            assert_eq!(points[0].values, expected, "{text}");
            assert!(points[0].accuracy < 1e-11, "{text}");
        }
    }

    #[test]
    fn decimals_of_many_digits_are_rounded_ones() {
        assert!(real("0.33333333").unwrap().1 > 1e-9);
        assert!(real("0.3333").unwrap().1 < 1e-15);
        assert!(real("1/3").unwrap().1 < 1e-15);
        assert_eq!(number("i").unwrap().0, Complex64::new(0.0, 1.0));
        assert_eq!(
            number("-2.5e-3-1e+2i").unwrap().0,
            Complex64::new(-2.5e-3, -100.0)
        );
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let said = |text: &str| csv("p.csv", text, &names()).unwrap_err().to_string();
        assert!(said("x,z\n1,2\n").contains("header"));
        assert!(said("x,y\n1,2\n1,two\n").starts_with("p.csv:3: field y"));
        assert!(said("x,y\n1\n").starts_with("p.csv:2: 1 fields"));
        let error = json("p.json", "[[1]]", &names()).unwrap_err().to_string();
        assert!(error.contains("point 1: 1 coordinate"), "{error}");
    }
}
