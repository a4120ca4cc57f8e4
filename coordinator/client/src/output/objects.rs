//! Objects: JSON objects of an answer, one a line or as rows of CSV.

use crate::common_arguments::AnswerFormat;
use crate::error::ClientError;
use serde::Serialize;
use serde_json::{Value, json};

/// Prints an answer: the table, the JSON object, or the objects in these lists of it, a line or a row each. A list is named
/// by its JSON pointer (RFC 6901).
pub fn print(
    format: AnswerFormat,
    lists: &[&str],
    table: impl FnOnce() -> String,
    json: impl FnOnce() -> String,
) -> Result<(), ClientError> {
    let text = match format {
        AnswerFormat::Table => table(),
        AnswerFormat::Json => json(),
        AnswerFormat::Jsonl | AnswerFormat::Csv => {
            let objects = listed(&json(), lists);
            if objects.is_empty() {
                let names = lists.iter().map(|list| list.trim_start_matches('/'));
                let names: Vec<&str> = names.collect();
                let names = names.join(", ");
                eprintln!("note: no rows, for there are no {names}; --format json has the rest");
            }
            rows(&objects, format)
        }
    };
    super::print(&text)
}

/// The objects in these lists of a JSON object.
fn listed(json: &str, lists: &[&str]) -> Vec<Value> {
    let whole: Value = serde_json::from_str(json).unwrap_or_default();
    let lists = lists
        .iter()
        .filter_map(|list| whole.pointer(list)?.as_array());
    lists.flatten().cloned().collect()
}

/// The objects as lines of JSON, or as rows of CSV with a column for each number, text or truth value in any of them.
pub fn rows(objects: &[impl Serialize], format: AnswerFormat) -> String {
    let objects = objects.iter().map(|object| json!(object));
    match format {
        AnswerFormat::Csv => table(objects),
        _ => objects.map(|object| format!("{object}\n")).collect(),
    }
}

/// A column's name and its value in one object.
type Cell = (String, String);

fn table(objects: impl Iterator<Item = Value>) -> String {
    let rows: Vec<Vec<Cell>> = objects
        .map(|object| {
            let mut cells = Vec::new();
            flatten("", &object, &mut cells);
            cells
        })
        .collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return String::new();
    }
    let mut out = csv::Writer::from_writer(Vec::new());
    let value = |row: &[Cell], name: &str| {
        let cell = row.iter().find(|(column, _)| column == name);
        cell.map_or(String::new(), |(_, value)| value.clone())
    };
    let mut write = |cells: Vec<String>| {
        // To memory, and rows have equally many cells.
        let _ = out.write_record(cells);
    };
    write(names.iter().map(|name| (*name).to_owned()).collect());
    for row in &rows {
        write(names.iter().map(|name| value(row, name)).collect());
    }
    let bytes = out.into_inner().unwrap_or_default();
    String::from_utf8(bytes).unwrap_or_default()
}

/// The values of an object, with the names of the fields around them; a list of plain values is one cell.
fn flatten(name: &str, value: &Value, cells: &mut Vec<Cell>) {
    let below = |field: &dyn std::fmt::Display| match name {
        "" => field.to_string(),
        name => format!("{name}.{field}"),
    };
    match value {
        Value::Object(fields) => {
            for (field, value) in fields {
                flatten(&below(field), value, cells);
            }
        }
        Value::Array(list) if list.iter().any(|item| item.is_object() || item.is_array()) => {
            for (index, item) in list.iter().enumerate() {
                flatten(&below(&index), item, cells);
            }
        }
        Value::Array(list) => {
            let texts: Vec<String> = list.iter().map(text).collect();
            cells.push((name.to_owned(), texts.join(" ")));
        }
        value => cells.push((name.to_owned(), text(value))),
    }
}

fn text(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Commands on mechanisms refused --format csv and jsonl (2026-11-30).
    #[test]
    fn objects_of_the_lists_of_an_answer_are_rows() {
        let answer = r#"{"sets": [{"id": "1.1", "center": [0.5, 2]}], "inner": {"points": [{"index": 0}]}, "other": null}"#;
        let objects = listed(answer, &["/sets", "/inner/points", "/other", "/absent"]);
        let lines = rows(&objects, AnswerFormat::Jsonl);
        assert_eq!(
            lines,
            "{\"center\":[0.5,2],\"id\":\"1.1\"}\n{\"index\":0}\n"
        );
        let table = rows(&objects, AnswerFormat::Csv);
        assert_eq!(table, "center,id,index\n0.5 2,1.1,\n,,0\n");
    }
}
