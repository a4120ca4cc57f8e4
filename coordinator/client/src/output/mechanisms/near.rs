//! Freedoms and singularities at configurations as tables and JSON.

use super::view::mechanism_json;
use crate::mechanism::mobility_answer::MobilityAnswer;
use crate::output::text::{Columns, Look, wrapped};
use cognate_kinematics::compile::singular_positions::SingularKind;
use cognate_kinematics::mechanism::Mechanism;
use cognate_mechanism_solver::local::number_effects::NumberEffect;
use cognate_mechanism_solver::local::singularity::Singularity;
use serde_json::{Value, json};
use std::f64::consts::PI;

fn number<T: ToString>(x: Option<T>) -> String {
    x.map_or_else(|| "?".into(), |x| x.to_string())
}

/// Freedoms, for people.
pub fn mobility_table(mechanism: &Mechanism, answers: &[MobilityAnswer], look: Look) -> String {
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
        let answer = &answer.mobility;
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
    let mut text = columns.render(look);
    let idle = mechanism.graph().idle;
    if idle > 0 {
        text.push_str(&format!(
            "idle: {idle} (links that spin between two balls besides, not counted above)\n"
        ));
    }
    for (index, answer) in answers.iter().enumerate() {
        let Some(effects) = &answer.why else { continue };
        let place = match answers.len() {
            1 => String::new(),
            _ => format!("configuration {index}: "),
        };
        text.push('\n');
        for sentence in effect_sentences(effects, answer.mobility.local) {
            for line in wrapped(&format!("{place}{sentence}"), look.width) {
                text.push_str(&line);
                text.push('\n');
            }
        }
    }
    text
}

/// Which numbers take a freedom away, which do not, and of which it is not known.
fn effect_sentences(effects: &[NumberEffect], local: Option<usize>) -> Vec<String> {
    let listed = |chosen: &dyn Fn(&NumberEffect) -> bool| {
        let names = effects.iter().filter(|effect| chosen(effect));
        let names: Vec<&str> = names.map(|effect| effect.number.name.as_str()).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    let mut sentences = Vec::new();
    let freedom = match local {
        Some(1) => "the freedom",
        _ => "a freedom",
    };
    let opens = |effect: &NumberEffect| {
        effect.keeps == Some(false) && (effect.assembles == Some(false) || local == Some(0))
    };
    let takes = |effect: &NumberEffect| effect.keeps == Some(false) && !opens(effect);
    if let Some(names) = listed(&takes) {
        sentences.push(format!(
            "Changed by itself, each of these takes {freedom} away: {names}."
        ));
    }
    if let Some(names) = listed(&opens) {
        sentences.push(match local {
            Some(0) => format!("Changed by itself, each of these keeps the mechanism from closing near there: {names}."),
            _ => format!(
                "Changed by itself, each of these takes {freedom} away, and the mechanism does not close near there any more: {names}."
            ),
        });
    }
    if let Some(names) = listed(&|effect| effect.keeps == Some(true)) {
        sentences.push(match (sentences.is_empty(), local) {
            (true, Some(0)) => format!(
                "Changed by itself, each of these lets the mechanism close near there: {names}."
            ),
            (true, _) => format!("Changed by itself, none of these takes a freedom away: {names}."),
            (false, _) => format!("These do not: {names}."),
        });
    }
    if let Some(names) = listed(&|effect| effect.keeps.is_none()) {
        sentences.push(format!("In doubt: {names}."));
    }
    if sentences.is_empty() {
        sentences.push("The file has no number that could be changed.".into());
    }
    sentences
}

fn effect_json(effect: &NumberEffect, degrees: bool) -> Value {
    let number = &effect.number;
    let mut object = json!({
        "number": number.name,
        "value": match number.is_angle && degrees {
            true => number.value * (180.0 / PI),
            false => number.value,
        },
        "freedoms": effect.keeps.map(|keeps| if keeps { "kept" } else { "fewer" }),
        "reason": effect.reason,
    });
    if let Some(assembles) = effect.assembles {
        object["assembles"] = json!(assembles);
    }
    object
}

/// Freedoms, for programs; those of a lone configuration stand at the top, too.
pub fn mobility_json(
    mechanism: &Mechanism,
    content: &[u8],
    answers: &[MobilityAnswer],
    degrees: bool,
) -> String {
    let point = |(index, answer): (usize, &MobilityAnswer)| {
        let why = answer.why.as_ref();
        let answer = &answer.mobility;
        let mut object = json!({
            "index": index,
            "infinitesimal": answer.infinitesimal,
            "local": answer.local,
            "dimensions_by_order": answer.dimensions_by_order,
            "multiplicity": answer.multiplicity,
            "exact": answer.is_exact,
            "reason": answer.reason,
        });
        if let Some(effects) = why {
            let effects = effects.iter().map(|effect| effect_json(effect, degrees));
            object["why"] = effects.collect();
        }
        object
    };
    let points: Vec<Value> = answers.iter().enumerate().map(point).collect();
    let mut object = match &points[..] {
        [one] => one.clone(),
        _ => json!({}),
    };
    object["mechanism"] = mechanism_json(mechanism, content);
    object["idle"] = json!(mechanism.graph().idle);
    object["settled"] = json!(answers.iter().all(MobilityAnswer::is_settled));
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
            Some(true) if answer.is_everywhere => "in every position",
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
            "everywhere": answer.is_singular.map(|_| answer.is_everywhere),
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
