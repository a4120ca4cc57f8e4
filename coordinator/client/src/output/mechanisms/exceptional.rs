//! Values of open numbers over which more moves than in general, as a table and JSON.

use crate::mechanism::exceptional_answer::{ExceptionalAnswer, ExceptionalSet, Value};
use crate::output::text::{Columns, Look, count};
use serde_json::json;

/// For people.
pub fn table(answer: &ExceptionalAnswer, look: Look) -> String {
    let names: Vec<&str> = answer.free.iter().map(|free| free.name.as_str()).collect();
    let general = match answer.generic {
        -1 => "cannot be assembled".to_owned(),
        0 => "does not move".to_owned(),
        freedoms => format!("moves with {freedoms} freedoms"),
    };
    let line = format!(
        "{}: for general {} it {general}",
        answer.name,
        names.join(", ")
    );
    let mut columns = Columns::new(&[">dimension", ">freedoms", "where"]);
    for set in &answer.sets {
        columns.row(vec![
            set.dimension.to_string(),
            set.mobility.to_string(),
            place(answer, set),
        ]);
    }
    let mut text = format!("{}\n\n", look.bold(&line));
    match answer.sets.is_empty() {
        true => text.push_str("no values over which more moves\n"),
        false => text.push_str(&columns.render(look)),
    }
    if answer.not_real > 0 {
        text.push_str(&format!(
            "\n{} more over values that are not real\n",
            count(answer.not_real)
        ));
    }
    text
}

fn place(answer: &ExceptionalAnswer, set: &ExceptionalSet) -> String {
    let shown = |value: &Value| {
        value
            .exact
            .clone()
            .unwrap_or_else(|| value.number.to_string())
    };
    let points = set.values.iter().map(|point| {
        let pairs = answer.free.iter().zip(point);
        let texts: Vec<String> = pairs
            .map(|(free, value)| format!("{} = {}", free.name, shown(value)))
            .collect();
        texts.join(", ")
    });
    let lines = set.equations.iter().map(|text| format!("{text} = 0"));
    let texts: Vec<String> = points.chain(lines).collect();
    match (texts.is_empty(), set.degree) {
        (false, _) => texts.join("; "),
        (true, Some(degree)) => format!("a set of degree {degree}"),
        (true, None) => "a set of unknown degree".into(),
    }
}

/// For programs.
pub fn json(answer: &ExceptionalAnswer) -> String {
    let names: Vec<&String> = answer.free.iter().map(|free| &free.name).collect();
    let point = |values: &Vec<Value>, exact: bool| {
        let pairs = names.iter().zip(values).map(|(name, value)| {
            let shown = match exact {
                true => json!(value.exact),
                false => json!(value.number),
            };
            ((*name).clone(), shown)
        });
        serde_json::Value::Object(pairs.collect())
    };
    let set = |set: &ExceptionalSet| {
        let mut object = json!({"dimension": set.dimension, "mobility": set.mobility});
        if set.dimension == 0 {
            let list = |exact: bool| {
                let values = set.values.iter().map(|values| point(values, exact));
                serde_json::Value::Array(values.collect())
            };
            object["values"] = list(false);
            object["exact"] = list(true);
        } else {
            object["degree"] = json!(set.degree);
            object["equations"] = json!(set.equations);
        }
        object
    };
    let object = json!({
        "mechanism": {"name": answer.name},
        "free": names,
        "generic": {"mobility": answer.generic},
        "sets": answer.sets.iter().map(set).collect::<Vec<_>>(),
        "not_real": answer.not_real,
        "settled": answer.doubts.is_empty(),
        "warnings": answer.doubts,
    });
    format!("{object:#}\n")
}
