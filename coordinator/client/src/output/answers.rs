//! Answers of components for people, and the folder of --output.

use super::decomposition::indented;
use super::files::{make_folder, write_file};
use super::text::{Columns, Look, count, counted, seconds, wrapped};
use super::{json, objects, print, surface};
use crate::arguments::{AnswerFormat, OutputArguments, Shown};
use crate::error::{ClientError, Exit};
use cognate_summary::question::QuestionSummary;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

/// Rows of a table before it says how many more there are.
const SHOWN: usize = 20;
/// Doubts shown before a table says how many more there are.
const DOUBTS_SHOWN: usize = 8;

/// The exit code that this answer has.
pub fn exit(summary: &QuestionSummary) -> Exit {
    Exit::of_settled(summary.settled)
}

/// The answer in one phrase.
pub fn headline(summary: &QuestionSummary) -> String {
    let points = summary.points.as_deref().unwrap_or(&[]).len() as u64;
    let components = summary.components.as_deref().unwrap_or(&[]).len() as u64;
    match (summary.question.as_str(), points, components) {
        ("member", points, _) => {
            let list = summary.points.iter().flatten();
            let on = list.filter(|p| p["on"].as_array().is_some_and(|on| !on.is_empty()));
            format!(
                "{} of {} on components",
                on.count(),
                counted(points, "point")
            )
        }
        ("sample" | "real-points", points, components) => {
            format!(
                "{} of {}",
                counted(points, "point"),
                counted(components, "component")
            )
        }
        (question, 0, components) => format!("{question} of {}", counted(components, "component")),
        (question, points, _) => format!("{question} at {}", counted(points, "point")),
    }
}

/// Prints the answer and writes the files that were asked for.
pub fn show(
    summary_json: &str,
    summary: &QuestionSummary,
    output: &OutputArguments,
) -> Result<Exit, ClientError> {
    if let Some(folder) = &output.output {
        write(folder, summary_json, summary)?;
    }
    let text = match output.format {
        AnswerFormat::Json => json::summary(summary_json),
        AnswerFormat::Table => table(summary, output.show, Look::of_standard_output()),
        AnswerFormat::Csv if PointTable::is_of(summary) => PointTable::of(summary).short(),
        AnswerFormat::Jsonl | AnswerFormat::Csv => {
            let points = summary
                .points
                .as_deref()
                .filter(|points| !points.is_empty());
            let list = points.or(summary.components.as_deref());
            objects::rows(list.unwrap_or(&[]), output.format)
        }
    };
    print(&text)?;
    Ok(exit(summary))
}

fn table(summary: &QuestionSummary, show: Option<Shown>, look: Look) -> String {
    let answer = headline(summary);
    let answer = match summary.settled {
        true => look.good(&answer),
        false => look.warn(&answer),
    };
    let mut text = format!("{}: {answer}\n", look.bold(&summary.problem.name));
    for doubt in summary.unsettled.iter().take(DOUBTS_SHOWN) {
        for (i, line) in wrapped(doubt, look.width - 15).iter().enumerate() {
            let lead = if i == 0 {
                "not settled: "
            } else {
                "             "
            };
            let _ = writeln!(text, "{}{line}", look.warn(lead));
        }
    }
    let more = summary.unsettled.len().saturating_sub(DOUBTS_SHOWN) as u64;
    if more > 0 {
        let _ = writeln!(
            text,
            "{}and {} more",
            look.warn("not settled: "),
            count(more)
        );
    }
    let rows = rows(summary);
    if let Some(first) = rows.first() {
        text.push('\n');
        let names: Vec<&str> = first.iter().map(|(name, _)| name.as_str()).collect();
        let mut columns = Columns::new(&names);
        let shown = match show {
            None => SHOWN,
            Some(Shown::First(number)) => number,
            Some(Shown::All) => rows.len(),
        };
        for row in rows.iter().take(shown) {
            columns.row(row.iter().map(|(_, cell)| cell.clone()).collect());
        }
        text.push_str(&indented(&columns.render(Look {
            width: look.width - 2,
            ..look
        })));
        if rows.len() > shown {
            let note = format!("and {} more; --show all lists them", rows.len() - shown);
            let _ = writeln!(text, "  {}", look.dim(&note));
        }
    }
    let paths = counted(summary.paths.total, "path");
    let time = seconds(summary.time.wall_seconds);
    let cpu = seconds(summary.time.cpu_seconds);
    let _ = writeln!(
        text,
        "\n  {}",
        look.dim(&format!("{paths}, {time}, {cpu} of CPU"))
    );
    for warning in &summary.warnings {
        let _ = writeln!(text, "  {}{warning}", look.warn("warning: "));
    }
    text
}

/// Columns that are shown only where there is something in them.
const ONLY_WHERE_ANY: [&str; 5] = [
    "arcs_across_box",
    "proved_slabs",
    "slabs",
    "curve_parts",
    "point_parts",
];

/// Name and cell of each column.
type Row = Vec<(String, String)>;

fn rows(summary: &QuestionSummary) -> Vec<Row> {
    let list = match summary.question.as_str() {
        "member" | "mobility" => &summary.points,
        _ => &summary.components,
    };
    let list = list.as_deref().unwrap_or(&[]);
    if summary.question == "multidegree" {
        return list.iter().flat_map(degrees).collect();
    }
    let columns: &[&str] = match summary.question.as_str() {
        "member" => &["index", "on", "unsettled", "solves"],
        "mobility" => &[
            "index",
            "infinitesimal",
            "dimensions_by_order",
            "local_dimension",
            "on",
            "reason",
        ],
        "sample" => &["id", "count", "wanted", "failed"],
        "certify" => &["id", "points", "certified", "distinct"],
        "real-surface" => &[
            "id",
            "degree",
            "compact",
            "euler",
            "parts",
            "curve_parts",
            "point_parts",
            "triangles",
            "settled",
        ],
        "real-points" => &["id", "points", "has_real_points", "settled"],
        "real-curve" => &[
            "id",
            "degree",
            "closed_loops",
            "unbounded_arcs",
            "isolated_points",
            "singular_points",
            "connected_components",
            "arcs_across_box",
            "proved_slabs",
            "slabs",
            "settled",
        ],
        _ => &[
            "id",
            "dimension",
            "degree",
            "fiber_dimension",
            "fiber_degree",
        ],
    };
    let said = |name: &str| {
        list.iter()
            .any(|value| value[name].as_u64().is_some_and(|n| n > 0))
    };
    let shown = |name: &&&str| !ONLY_WHERE_ANY.contains(name) || said(name);
    let shown: Vec<&&str> = columns.iter().filter(shown).collect();
    let row = |value: &Value| {
        let cells = shown.iter();
        cells
            .map(|name| (heading(name), cell(&value[**name])))
            .collect()
    };
    list.iter().map(row).collect()
}

/// The heading of a field's column.
fn heading(field: &str) -> String {
    match field {
        // As real surfaces have them.
        "connected_components" => "parts".to_owned(),
        field => field.replace('_', " "),
    }
}

fn degrees(component: &Value) -> Vec<Row> {
    let list = component["multidegree"].as_array();
    let entry = |entry: &Value| {
        vec![
            ("id".to_owned(), cell(&component["id"])),
            ("slices in groups".to_owned(), cell(&entry["slices"])),
            ("degree".to_owned(), cell(&entry["degree"])),
        ]
    };
    list.map(|list| list.iter().map(entry).collect())
        .unwrap_or_default()
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => "?".into(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        Value::String(text) => text.clone(),
        Value::Array(list) if list.is_empty() => "-".into(),
        Value::Array(list) => list.iter().map(cell).collect::<Vec<_>>().join(" "),
        Value::Object(fields) => match fields.get("component") {
            Some(component) => cell(component),
            None => "...".into(),
        },
        Value::Number(number) => number.to_string(),
    }
}

/// summary.json, and samples.csv with real and imaginary parts.
fn write(folder: &Path, summary_json: &str, summary: &QuestionSummary) -> Result<(), ClientError> {
    make_folder(folder)?;
    if PointTable::is_of(summary) {
        write_file(folder, "samples.csv", &PointTable::of(summary).whole())?;
    }
    if let Some(curves) = &summary.curves {
        let list = Value::Array(curves.clone());
        write_file(folder, "curve.json", &format!("{list:#}\n"))?;
        let text = arcs(curves, &unknowns(summary));
        write_file(folder, "samples.csv", &text)?;
    }
    if let Some(surfaces) = &summary.surfaces {
        surface::write(folder, surfaces)?;
    }
    write_file(folder, "summary.json", &json::summary(summary_json))
}

/// Names of the unknowns; numbers where an older program wrote the summary.
fn unknowns(summary: &QuestionSummary) -> Vec<String> {
    let problem = &summary.problem;
    match problem.unknowns.is_empty() {
        true => (1..=problem.variables).map(|v| format!("x{v}")).collect(),
        false => problem.unknowns.clone(),
    }
}

/// Points of components as rows of CSV.
struct PointTable<'a> {
    unknowns: Vec<String>,
    /// The component of each point, and its coordinates.
    points: Vec<(String, &'a Value)>,
}

impl<'a> PointTable<'a> {
    /// Whether the answer is points of components.
    fn is_of(summary: &QuestionSummary) -> bool {
        matches!(summary.question.as_str(), "sample" | "real-points")
    }

    fn of(summary: &'a QuestionSummary) -> Self {
        let points = summary.points.iter().flatten();
        let points = match summary.question.as_str() {
            "real-points" => points
                .map(|p| (cell(&p["component"]), &p["point"]))
                .collect(),
            // Points stand in the order of their components.
            _ => {
                let components = summary.components.iter().flatten();
                let ids = components.flat_map(|c| {
                    let count = c["count"].as_u64().unwrap_or(0) as usize;
                    std::iter::repeat_n(cell(&c["id"]), count)
                });
                ids.zip(points).collect()
            }
        };
        Self {
            unknowns: unknowns(summary),
            points,
        }
    }

    /// With real and imaginary parts.
    fn whole(&self) -> String {
        let mut text = format!("component,{}\n", parts(&self.unknowns));
        for (id, point) in &self.points {
            let _ = writeln!(text, "{id},{}", numbers(point));
        }
        text
    }

    /// With real parts only where all points are real.
    fn short(&self) -> String {
        let coordinates = |point: &'a Value| point.as_array().into_iter().flatten();
        let mut point_coordinates = self.points.iter().flat_map(|(_, point)| coordinates(point));
        if !point_coordinates.all(|z| z[1].as_f64() == Some(0.0)) {
            return self.whole();
        }
        let names = self.unknowns.iter().map(|name| format!(",{name}"));
        let mut text = format!("component{}\n", names.collect::<String>());
        for (id, point) in &self.points {
            let numbers = coordinates(point).map(|z| format!(",{}", z[0]));
            let _ = writeln!(text, "{id}{}", numbers.collect::<String>());
        }
        text
    }
}

/// Heads of the columns with the real and imaginary parts of a point.
fn parts(unknowns: &[String]) -> String {
    let parts = unknowns.iter().map(|name| format!("{name}_re,{name}_im"));
    parts.collect::<Vec<String>>().join(",")
}

/// The real and imaginary parts of a point.
fn numbers(point: &Value) -> String {
    let coordinates = point.as_array().into_iter().flatten();
    let numbers = coordinates.map(|z| format!("{},{}", z[0], z[1]));
    numbers.collect::<Vec<String>>().join(",")
}

/// The points of arcs, one a line.
fn arcs(curves: &[Value], unknowns: &[String]) -> String {
    let mut text = format!("component,edge,index,{}\n", parts(unknowns));
    for curve in curves {
        for (edge, arc) in curve["edges"].as_array().into_iter().flatten().enumerate() {
            let samples = arc["samples"].as_array().into_iter().flatten();
            for (index, point) in samples.enumerate() {
                let (id, numbers) = (cell(&curve["id"]), numbers(point));
                let _ = writeln!(text, "{id},{edge},{index},{numbers}");
            }
        }
    }
    text
}
