//! The sheet as one HTML page that needs no server: the curves, and each linkage in motion.

use super::{Sheet, json};
use serde_json::Value;

/// The page, with places for its title and its data.
const PAGE: &str = include_str!("page.html");

/// The whole page.
pub fn page(sheet: &Sheet) -> String {
    let all = json::value(sheet);
    let data: Value = ["points", "classes", "curves"]
        .into_iter()
        .map(|field| (field.to_string(), all[field].clone()))
        .collect::<serde_json::Map<_, _>>()
        .into();
    // Inside a script nothing may look like the end of it.
    let data = data.to_string().replace("</", "<\\/");
    let title = escaped(&sheet.name);
    PAGE.replace("@TITLE@", &title)
        .replace("/*@DATA@*/null", &data)
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
