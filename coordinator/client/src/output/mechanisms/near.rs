//! Freedoms and singularities at configurations as tables and JSON.

use super::view::mechanism_json;
use crate::output::text::{Columns, Look};
use cognate_kinematics::compile::singular_positions::SingularKind;
use cognate_kinematics::mechanism::Mechanism;
use cognate_mechanism_solver::local::mobility::Mobility;
use cognate_mechanism_solver::local::singularity::Singularity;
use serde_json::{Value, json};

fn number<T: ToString>(x: Option<T>) -> String {
    x.map_or_else(|| "?".into(), |x| x.to_string())
}

/// Freedoms, for people.
pub fn mobility_table(answers: &[Mobility], look: Look) -> String {
    let headings = [
        ">configuration",
        ">first order",
        ">local",
        "by order",
        ">multiplicity",
        "reason",
    ];
    let mut columns = Columns::new(&headings);
    for (index, answer) in answers.iter().enumerate() {
        let lengths: Vec<String> = answer
            .dimensions_by_order
            .iter()
            .map(u64::to_string)
            .collect();
        columns.row(vec![
            index.to_string(),
            number(answer.infinitesimal),
            number(answer.local),
            lengths.join(" "),
            answer
                .multiplicity
                .map_or_else(|| "-".into(), |m| m.to_string()),
            answer.reason.clone(),
        ]);
    }
    columns.render(look)
}

/// Freedoms, for programs; those of a lone configuration stand at the top, too.
pub fn mobility_json(mechanism: &Mechanism, content: &[u8], answers: &[Mobility]) -> String {
    let point = |(index, answer): (usize, &Mobility)| {
        json!({
            "index": index,
            "infinitesimal": answer.infinitesimal,
            "local": answer.local,
            "dimensions_by_order": answer.dimensions_by_order,
            "multiplicity": answer.multiplicity,
            "exact": answer.is_exact,
            "reason": answer.reason,
        })
    };
    let points: Vec<Value> = answers.iter().enumerate().map(point).collect();
    let mut object = match &points[..] {
        [one] => one.clone(),
        _ => json!({}),
    };
    object["mechanism"] = mechanism_json(mechanism, content);
    object["settled"] = json!(answers.iter().all(Mobility::is_settled));
    object["points"] = json!(points);
    format!("{object:#}\n")
}

/// Singularities, for people.
pub fn singularities_table(answers: &[Singularity], look: Look) -> String {
    let mut columns = Columns::new(&[
        ">configuration",
        "singular",
        ">rank loss",
        ">value",
        "classes",
    ]);
    for (index, answer) in answers.iter().enumerate() {
        let word = match answer.is_singular {
            Some(true) => "singular",
            Some(false) => "regular",
            None => "in doubt",
        };
        columns.row(vec![
            index.to_string(),
            word.into(),
            answer.rank_loss.to_string(),
            format!("{:.2e}", answer.value),
            answer.classes.join(" "),
        ]);
    }
    columns.render(look)
}

/// Singularities, for programs.
pub fn singularities_json(
    mechanism: &Mechanism,
    content: &[u8],
    kind: &SingularKind,
    answers: &[Singularity],
) -> String {
    let point = |(index, answer): (usize, &Singularity)| {
        json!({
            "index": index,
            "singular": answer.is_singular,
            "rank_loss": answer.is_singular.map(|_| answer.rank_loss),
            "value": answer.value,
            "classes": answer.classes,
            "reason": answer.doubt,
        })
    };
    let points: Vec<Value> = answers.iter().enumerate().map(point).collect();
    let object = json!({
        "mechanism": mechanism_json(mechanism, content),
        "kind": kind.name(),
        "inputs": kind.inputs(),
        "points": points,
        "settled": answers.iter().all(|answer| answer.doubt.is_none()),
    });
    format!("{object:#}\n")
}
