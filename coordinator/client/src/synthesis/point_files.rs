//! Point files: nine points, or many sets of them, as CSV or as JSON, checked line by line.

use crate::output::text::cut;
use cognate_kinematics::nine_point::{PathPoints, PointFault};
use num_complex::Complex64;
use serde_json::{Map, Value};

/// Something, and where it stands, in words.
pub(super) type Placed<T> = (T, String);

/// x and y of a point.
type PlacedPoint = Placed<[Complex64; 2]>;

/// The text of a file, without a byte order mark.
pub(super) fn decoded<'a>(name: &str, content: &'a [u8]) -> Result<&'a str, String> {
    let text = std::str::from_utf8(content).map_err(|e| {
        format!(
            "{name}: is no text: byte {} is not UTF-8",
            e.valid_up_to() + 1
        )
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// Refuses an object with a field of another name than these: no number of a file is passed over.
pub(super) fn only_fields(
    name: &str,
    fields: &Map<String, Value>,
    expected: &[&str],
) -> Result<(), String> {
    let unknown = fields
        .keys()
        .find(|field| !expected.contains(&field.as_str()));
    unknown.map_or(Ok(()), |field| {
        let (field, expected) = (cut(field, 40), expected.join("\", \""));
        Err(format!(
            "{name}: unknown field \"{field}\"; expected \"{expected}\""
        ))
    })
}

/// Whether a text is meant as JSON.
pub(super) fn is_json(text: &str) -> bool {
    text.trim_start().starts_with(['{', '['])
}

/// The JSON value that a text holds.
pub(super) fn parsed(name: &str, text: &str) -> Result<Value, String> {
    serde_json::from_str(text)
        .map_err(|e| format!("{name}:{}:{}: is no JSON: {e}", e.line(), e.column()))
}

/// Reads nine points; the message names file, line and field.
pub fn read(name: &str, content: &[u8]) -> Result<PathPoints, String> {
    let text = decoded(name, content)?;
    let placed = if is_json(text) {
        json(name, text)?
    } else {
        csv(name, text)?
    };
    nine(name, &placed)
}

/// Checks that there are nine, and that they are different.
fn nine(name: &str, placed: &[PlacedPoint]) -> Result<PathPoints, String> {
    if placed.len() != 9 {
        let point_count = placed.len();
        let last = placed
            .last()
            .map_or(String::new(), |(_, at)| format!(" (the last is {at})"));
        return Err(format!(
            "{name}: expected nine points, found {point_count}{last}"
        ));
    }
    let points: Vec<[Complex64; 2]> = placed.iter().map(|(point, _)| *point).collect();
    let points = points.try_into().expect("nine were counted");
    PathPoints::new(points).map_err(|fault| {
        let at = |k: usize| &placed[k].1;
        match fault {
            PointFault::NotFinite(k) => format!("{name}: {}: {fault}", at(k)),
            PointFault::Coincident(j, k) => {
                format!("{name}: {} and {}: {fault}", at(j), at(k))
            }
            PointFault::Extent(_) => format!("{name}: {fault}"),
        }
    })
}

/// Many sets of nine points, each with a name.
///
/// CSV with a header `x1,y1,...,x9,y9`, or the same with `name` before it, a row for each set; or
/// JSON, a line for each: a list of points, or `{"name": ..., "points": [...]}`.
pub fn read_many(name: &str, content: &[u8]) -> Result<Vec<(String, PathPoints)>, String> {
    let text = decoded(name, content)?;
    let mut rows = text
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .peekable();
    let is_json = rows
        .peek()
        .is_some_and(|(_, row)| row.starts_with(['{', '[']));
    let mut sets = vec![];
    if is_json {
        for (line, row) in rows {
            let origin = format!("{name}:{line}");
            let placed = json(&origin, row)?;
            let value: Value = serde_json::from_str(row).unwrap_or_default();
            let called = value["name"].as_str().map(str::to_owned);
            let called = called.unwrap_or_else(|| (sets.len() + 1).to_string());
            sets.push((called, nine(&origin, &placed)?));
        }
    } else {
        let header = rows.next().map_or("", |(_, row)| row).to_lowercase();
        let between = [',', ';', '\t'].into_iter().find(|&c| header.contains(c));
        let between = between.unwrap_or(',');
        let names: Vec<&str> = header.split(between).map(str::trim).collect();
        let coordinates = (1..=9).flat_map(|k| [format!("x{k}"), format!("y{k}")]);
        let coordinates: Vec<String> = coordinates.collect();
        let named = names.first() == Some(&"name");
        if names[usize::from(named)..] != coordinates {
            return Err(format!(
                "{name}: expected the header x1,y1,...,x9,y9, or name,x1,y1,...,x9,y9, or a line of \
                 JSON for each set of points"
            ));
        }
        for (line, row) in rows {
            let cells: Vec<&str> = row.split(between).map(str::trim).collect();
            if cells.len() != names.len() {
                let (expected, field_count) = (names.len(), cells.len());
                return Err(format!(
                    "{name}:{line}: expected {expected} fields, found {field_count}"
                ));
            }
            let called = match named {
                true => cells[0].to_owned(),
                false => (sets.len() + 1).to_string(),
            };
            let numbers = coordinates.iter().zip(&cells[usize::from(named)..]);
            let numbers: Vec<Complex64> = numbers
                .map(|(field, cell)| {
                    let number = finite(cell).map(|x| Complex64::new(x, 0.0));
                    number.ok_or_else(|| {
                        let cell = cut(cell, 40);
                        format!("{name}:{line}: {field}: expected a finite number, found `{cell}`")
                    })
                })
                .collect::<Result<_, _>>()?;
            let placed: Vec<PlacedPoint> = numbers
                .chunks_exact(2)
                .enumerate()
                .map(|(k, point)| ([point[0], point[1]], format!("x{0},y{0}", k + 1)))
                .collect();
            sets.push((called, nine(&format!("{name}:{line}"), &placed)?));
        }
    }
    match sets.is_empty() {
        true => Err(format!("{name}: holds no set of points")),
        false => Ok(sets),
    }
}

fn csv(name: &str, text: &str) -> Result<Vec<PlacedPoint>, String> {
    let rows = rows(name, text, ["x", "y"])?.into_iter();
    let point = |[x, y]: [f64; 2]| [x, y].map(|c| Complex64::new(c, 0.0));
    Ok(rows.map(|(row, at)| (point(row), at)).collect())
}

/// Rows of numbers below a header of these names; commas, semicolons or tabs between. Empty lines
/// and lines that begin with # are comments.
pub(super) fn rows<const N: usize>(
    name: &str,
    text: &str,
    fields: [&str; N],
) -> Result<Vec<Placed<[f64; N]>>, String> {
    let rows = rows_with_blanks(name, text, fields, &[])?.into_iter();
    let whole = |row: [Option<f64>; N]| row.map(|cell| cell.expect("no field may be blank"));
    Ok(rows.map(|(row, at)| (whole(row), at)).collect())
}

/// Rows of numbers in which the fields in `blank` may be left blank.
pub(super) fn rows_with_blanks<const N: usize>(
    name: &str,
    text: &str,
    fields: [&str; N],
    blank: &[&str],
) -> Result<Vec<Placed<[Option<f64>; N]>>, String> {
    let mut rows = text
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let expected = fields.join(",");
    let header = rows.next();
    let (line, header) =
        header.ok_or_else(|| format!("{name}: is empty; expected a header {expected}"))?;
    let between = [',', ';', '\t'].into_iter().find(|&c| header.contains(c));
    let between = between.unwrap_or(',');
    let names = header.split(between);
    let names: Vec<String> = names
        .map(|s| s.trim().trim_matches('"').to_lowercase())
        .collect();
    if names != fields {
        let header = cut(header, 40);
        return Err(format!(
            "{name}:{line}: expected the header {expected}, found `{header}`"
        ));
    }
    let mut number_rows = vec![];
    for (line, row) in rows {
        let cells: Vec<&str> = row.split(between).map(str::trim).collect();
        if cells.len() != N {
            let s = if cells.len() == 1 { "" } else { "s" };
            return Err(format!(
                "{name}:{line}: expected {N} numbers, {expected}, found {} field{s}",
                cells.len()
            ));
        }
        let mut numbers = [None; N];
        for ((number, cell), field) in numbers.iter_mut().zip(cells).zip(fields) {
            *number = finite(cell);
            if number.is_none() && !(cell.is_empty() && blank.contains(&field)) {
                let cell = cut(cell, 40);
                return Err(format!(
                    "{name}:{line}: {field}: expected a finite number, found `{cell}`"
                ));
            }
        }
        number_rows.push((numbers, format!("line {line}")));
    }
    Ok(number_rows)
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

/// `{"points": [[x, y], ...]}`, also with a `name`, or the list alone; a complex coordinate is `[re, im]`.
fn json(name: &str, text: &str) -> Result<Vec<PlacedPoint>, String> {
    let value = parsed(name, text)?;
    let list = match &value {
        Value::Object(fields) => {
            only_fields(name, fields, &["points", "name"])?;
            let list = fields.get("points");
            list.ok_or_else(|| format!("{name}: expected the field \"points\", a list of [x, y]"))?
        }
        list => list,
    };
    let list = list.as_array().ok_or_else(|| {
        format!(
            "{name}: points: expected a list of [x, y], found {}",
            kind(list)
        )
    })?;
    let points = list.iter().enumerate().map(|(k, point)| {
        let at = format!("points[{k}]");
        let Some([x, y]) = point.as_array().map(Vec::as_slice) else {
            let json_kind = kind(point);
            return Err(format!("{name}: {at}: expected [x, y], found {json_kind}"));
        };
        let coordinate = |field: &str, value: &Value| {
            complex(value).ok_or_else(|| {
                let json_kind = kind(value);
                format!(
                    "{name}: {at}.{field}: expected a finite number or [re, im], found {json_kind}"
                )
            })
        };
        Ok(([coordinate("x", x)?, coordinate("y", y)?], at))
    });
    points.collect()
}

pub(super) fn complex(value: &Value) -> Option<Complex64> {
    let number = |value: &Value| value.as_f64().filter(|x| x.is_finite());
    match value {
        Value::Array(parts) => match &parts[..] {
            [re, im] => Some(Complex64::new(number(re)?, number(im)?)),
            _ => None,
        },
        _ => Some(Complex64::new(number(value)?, 0.0)),
    }
}

pub(super) fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Bool(b) => b.to_string(),
        Value::Number(n) => format!("the number {n}"),
        Value::String(_) => "a string".into(),
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(_) => "an object".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: [&str; 9] = [
        "0.25,0", "0.52,0.1", "0.8,0.7", "1.2,1", "1.4,1.3", "1.1,1.48", "0.7,1.4", "0.2,1",
        "0.02,0.4",
    ];

    fn file(rows: &[&str]) -> String {
        format!("# nine points\nx,y\n{}\n", rows.join("\n"))
    }

    fn fault(text: &str) -> String {
        read("p.csv", text.as_bytes()).expect_err("it is not right")
    }

    #[test]
    fn the_same_points_in_every_notation() {
        let csv = read("p.csv", file(&ROWS).as_bytes()).expect("points");
        let semicolons = file(&ROWS).replace(',', "; ");
        assert_eq!(read("p.csv", semicolons.as_bytes()), Ok(csv.clone()));
        let list: Vec<String> = ROWS.iter().map(|row| format!("[{row}]")).collect();
        let list = format!("[{}]", list.join(", "));
        let object = format!("{{\"points\": {list}}}");
        assert_eq!(read("p.json", list.as_bytes()), Ok(csv.clone()));
        assert_eq!(read("p.json", object.as_bytes()), Ok(csv.clone()));
        let complex = object.replace("[0.25,0]", "[[0.25, 0], [0, 0]]");
        assert_eq!(read("p.json", complex.as_bytes()), Ok(csv));
        let complex = object.replace("[0.25,0]", "[[0.25, 0.5], 0]");
        assert!(
            !read("p.json", complex.as_bytes())
                .expect("points")
                .is_real()
        );
    }

    #[test]
    fn many_sets_are_read_and_their_mistakes_named() {
        let one = read("p.csv", file(&ROWS).as_bytes()).expect("points");
        let header: Vec<String> = (1..=9).map(|k| format!("x{k},y{k}")).collect();
        let (header, row) = (header.join(","), ROWS.join(","));
        let plain = format!("{header}\n{row}\n\n{row}\n");
        let sets = read_many("t.csv", plain.as_bytes()).expect("two sets");
        let expected = [
            ("1".to_string(), one.clone()),
            ("2".to_string(), one.clone()),
        ];
        assert_eq!(sets, expected);
        let named = format!("name,{header}\nwing,{row}\n");
        let sets = read_many("t.csv", named.as_bytes()).expect("one set");
        assert_eq!(sets, [("wing".to_string(), one.clone())]);
        let list: Vec<String> = ROWS.iter().map(|row| format!("[{row}]")).collect();
        let list = list.join(", ");
        let lines = format!("[{list}]\n{{\"name\": \"wing\", \"points\": [{list}]}}\n");
        let sets = read_many("t.jsonl", lines.as_bytes()).expect("two sets");
        assert_eq!(
            sets,
            [("1".to_string(), one.clone()), ("wing".to_string(), one)]
        );
        let fault = |text: String| read_many("t", text.as_bytes()).expect_err("it is not right");
        let twice = row.replace("0.52,0.1", "0.25,0");
        let cases = [
            (
                format!("{header}\n{row},1\n"),
                "t:2: expected 18 fields, found 19",
            ),
            (
                format!("{header}\n{}\n", row.replace("1.48", "?")),
                "t:2: y6: expected a finite number",
            ),
            (
                format!("{header}\n{row}\n{twice}\n"),
                "t:3: x1,y1 and x2,y2: points 1 and 2 coincide",
            ),
            ("x,y\n1,2\n".into(), "expected the header x1,y1,...,x9,y9"),
            (format!("{header}\n"), "holds no set of points"),
            (
                format!("[{list}]\n[[1, 2]]\n"),
                "t:2: expected nine points, found 1",
            ),
        ];
        for (text, expected) in cases {
            let message = fault(text);
            assert!(message.contains(expected), "{message}\nexpected {expected}");
        }
    }

    #[test]
    fn mistakes_are_named_with_line_and_field() {
        let with = |k: usize, row: &'static str| {
            let mut rows = ROWS;
            rows[k] = row;
            fault(&file(&rows))
        };
        let cases = [
            (
                with(2, "0.8,zero"),
                "p.csv:5: y: expected a finite number, found `zero`",
            ),
            (
                with(2, "inf,1"),
                "p.csv:5: x: expected a finite number, found `inf`",
            ),
            (
                with(2, "0.8"),
                "p.csv:5: expected 2 numbers, x,y, found 1 field",
            ),
            (with(2, "0.8,1,2"), "found 3 fields"),
            (
                with(8, "0.52,0.1"),
                "p.csv: line 4 and line 11: points 2 and 9 coincide",
            ),
            (
                fault(&file(&ROWS[..8])),
                "expected nine points, found 8 (the last is line 10)",
            ),
            (
                fault("a,b\n1,2\n"),
                "p.csv:1: expected the header x,y, found `a,b`",
            ),
            (fault(""), "p.csv: is empty"),
            (
                fault("{\"points\": [[1, null]]}"),
                "points[0].y: expected a finite number or [re, im], found null",
            ),
            (
                fault("{\"points\": [1]}"),
                "points[0]: expected [x, y], found the number 1",
            ),
            (fault("{}"), "expected the field \"points\""),
            (
                fault("{\"dots\": []}"),
                "p.csv: unknown field \"dots\"; expected \"points\", \"name\"",
            ),
            (fault("{\"points\": "), "p.csv:1:"),
        ];
        for (message, expected) in cases {
            assert!(message.contains(expected), "{message}\nexpected {expected}");
        }
        assert!(read("p", b"x,y\n\xff").is_err_and(|e| e.contains("byte 5 is not UTF-8")));
    }
}
