//! The sheet as one HTML page that needs no server: the curves, and each linkage in motion.

use super::{Sheet, json, word};
use crate::output::text::{count, counted};
use cognate_kinematics::nine_point::ClassEnd;
use cognate_kinematics::nine_point::family::CLASSES;
use serde_json::{Value, json};

/// The page, with places for its title and its data.
const PAGE: &str = include_str!("page.html");

/// Texts and data of the page.
pub struct Content<'a> {
    /// Title of the page.
    pub title: &'a str,
    /// `[[x, y], ...]`, where all curves have them in common.
    pub points: Value,
    /// Directions of a body at the points, as unit vectors; null where there is none.
    pub turns: Value,
    /// `[{linkages: [...]}, ...]`, as in the summary; `points` in one are its own.
    pub curves: Value,
    /// Before, in and after the answer.
    pub answer: [String; 3],
    /// Text that is shown if there are no linkages.
    pub none: &'a str,
    /// Completeness of the answer, in a line.
    pub completeness: String,
    /// Counts by name.
    pub counts: Vec<(&'a str, Option<usize>)>,
}

/// The page of a nine-point synthesis.
pub fn page(sheet: &Sheet) -> String {
    let sheet_value = json::value(sheet);
    let failed = sheet.count(ClassEnd::Failed);
    let classes = |n: usize| match n {
        1 => "1 class".to_owned(),
        n => format!("{} classes", count(n as u64)),
    };
    let rest = match failed {
        0 => ". There are no others.".to_owned(),
        n => format!("; {} not settled.", classes(n)),
    };
    let curves = counted(sheet.curves.len() as u64, "coupler curve");
    let linkages = counted(sheet.linkages().count() as u64, "four-bar linkage");
    let mut counts: Vec<(&str, Option<usize>)> = sheet
        .classes
        .iter()
        .map(|(end, n)| (word(*end), Some(*n)))
        .collect();
    counts.push(("together", Some(CLASSES)));
    counts.push(("real", sheet.real));
    if let Some(n) = sheet.certified {
        let proved = sheet.curves.iter().filter(|curve| curve.certified).count();
        counts.extend([("proved", Some(n)), ("proved real", Some(proved))]);
    }
    filled(Content {
        title: &sheet.name,
        points: sheet_value["points"].clone(),
        turns: Value::Null,
        curves: sheet_value["curves"].clone(),
        answer: [
            "Through nine points: ".into(),
            format!("{curves} by {linkages}"),
            rest,
        ],
        none: "No four-bar linkage passes these points.",
        completeness: match failed {
            0 => format!(
                "How complete is this? {} followed, none lost",
                classes(CLASSES)
            ),
            n => format!(
                "How complete is this? {} followed, {n} lost",
                classes(CLASSES)
            ),
        },
        counts,
    })
}

/// The page with this content.
pub fn filled(content: Content<'_>) -> String {
    let [lead, answer, rest] = content.answer;
    let data = json!({
        "points": content.points,
        "turns": content.turns,
        "curves": content.curves,
        "words": {
            "lead": lead, "answer": answer, "rest": rest, "none": content.none,
            "completeness": content.completeness, "counts": content.counts,
        },
    });
    // Inside a script nothing may look like the end of it.
    let data = data.to_string().replace("</", "<\\/");
    PAGE.replace("@TITLE@", &escaped(content.title))
        .replace("/*@DATA@*/null", &data)
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
