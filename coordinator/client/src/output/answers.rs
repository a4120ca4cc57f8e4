//! Answers of components for people, and the folder of --output.

use super::axes::AxisOf;
use super::decomposition::indented;
use super::files::{create, make_folder, write_file};
use super::text::{Columns, Look, count, counted, seconds, wrapped};
use super::{beside_rows, curve_svg, json, objects, print, surface};
use crate::arguments::{AnswerFormat, OutputArguments, Shown};
use crate::error::{ClientError, Exit};
use cognate_summary::question::QuestionSummary;
use cognate_summary::question_answer::{
    CurveBlock, MultidegreeBlock, QuestionAnswer, RealCurveAnswer,
};
use num_complex::Complex64;
use serde::Serialize;
use serde_json::{Value, json};
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
    let count = Listing::of(&summary.answer).objects.len() as u64;
    match &summary.answer {
        QuestionAnswer::Member(answer) => {
            let on_components = answer.points.iter().filter(|point| !point.on.is_empty());
            let asked = counted(count, "point");
            format!("{} of {asked} on components", on_components.count())
        }
        QuestionAnswer::Mobility(_) => format!("mobility at {}", counted(count, "point")),
        _ => {
            let points = PointTable::of(summary);
            let points = points.map(|table| counted(table.points.len() as u64, "point"));
            let subject = points.unwrap_or(summary.question.clone());
            format!("{subject} of {}", counted(count, "component"))
        }
    }
}

/// Prints the answer and writes the files that were asked for.
pub fn show(
    summary_json: &str,
    summary: &QuestionSummary,
    output: &OutputArguments,
) -> Result<Exit, ClientError> {
    if let Some(folder) = &output.output {
        write(folder, summary_json, summary, &output.axes)?;
    }
    if matches!(output.format, AnswerFormat::Csv | AnswerFormat::Jsonl) {
        beside_rows::of_question(summary, Look::of_standard_error()).print();
    }
    let text = match (output.format, PointTable::of(summary)) {
        (AnswerFormat::Json, _) => json::summary(summary_json),
        (AnswerFormat::Table, _) => table(summary, output.show, Look::of_standard_output()),
        (AnswerFormat::Csv, Some(points)) => points.short(),
        (format, _) => match &summary.answer {
            QuestionAnswer::Sample(answer) if !answer.points.is_empty() => {
                objects::rows(&answer.points, format)
            }
            QuestionAnswer::RealPoints(answer) if !answer.points.is_empty() => {
                objects::rows(&answer.points, format)
            }
            answer => objects::rows(&Listing::of(answer).objects, format),
        },
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
    let rows = Listing::of(&summary.answer).rows;
    if let Some(first) = rows.first() {
        text.push('\n');
        let names: Vec<String> = first.iter().map(|(field, _)| heading(field)).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
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

/// Columns that are shown only where a number in them is not 0.
const ONLY_WHERE_ANY: [&str; 5] = [
    "arcs_across_box",
    "proved_slabs",
    "slabs",
    "curve_parts",
    "point_parts",
];

/// Field and cell of each column.
type Row = Vec<(&'static str, String)>;

/// The row of a block: these fields of it.
macro_rules! row {
    ($block:ident: $($field:ident),*) => {
        vec![$((stringify!($field), cell(&json!($block.$field)))),*]
    };
}

/// Blocks of an answer, of components where there are any and else of points: as JSON objects, and as rows of a table.
#[derive(Default)]
struct Listing {
    objects: Vec<Value>,
    rows: Vec<Row>,
}

impl Listing {
    fn of(answer: &QuestionAnswer) -> Self {
        use QuestionAnswer::*;
        match answer {
            Check(a) => Self::new(&a.components, |c| row!(c: id, closed, multiplicity)),
            Certify(a) => Self::new(&a.components, |c| row!(c: id, points, certified, distinct)),
            Member(a) => Self::new(&a.points, |p| {
                let near: Vec<&String> = p.unsettled.iter().map(|near| &near.component).collect();
                let unsettled = vec![("unsettled", cell(&json!(near)))];
                [row!(p: index, on), unsettled, row!(p: solves)].concat()
            }),
            Sample(a) => Self::new(&a.components, |c| row!(c: id, count, wanted, failed)),
            Project(a) => Self::new(
                &a.components,
                |c| row!(c: id, dimension, degree, fiber_dimension, fiber_degree),
            ),
            Multidegree(a) => Self {
                rows: a.components.iter().flat_map(degrees).collect(),
                ..Self::new(&a.components, |_| Row::new())
            },
            Mobility(a) => Self::new(
                &a.points,
                |p| row!(p: index, infinitesimal, dimensions_by_order, local_dimension, on, reason),
            ),
            RealCurve(a) => Self::new(&a.components, |c| {
                row!(c: id, degree, closed_loops, unbounded_arcs, isolated_points, singular_points,
                    connected_components, arcs_across_box, proved_slabs, slabs, settled)
            }),
            RealPoints(a) => Self::new(
                &a.components,
                |c| row!(c: id, points, has_real_points, settled),
            ),
            RealSurface(a) => Self::new(&a.components, |c| {
                row!(c: id, degree, compact, euler, parts, curve_parts, point_parts, triangles,
                    settled)
            }),
            Other => Self::default(),
        }
    }

    fn new<B: Serialize>(blocks: &[B], row: impl Fn(&B) -> Row) -> Self {
        let mut rows: Vec<Row> = blocks.iter().map(row).collect();
        let has_any = |field: &str| {
            let mut cells = rows.iter().flatten().filter(|(name, _)| *name == field);
            cells.any(|(_, cell)| cell != "0" && cell != "?")
        };
        let fields = ONLY_WHERE_ANY.into_iter();
        let hidden: Vec<&str> = fields.filter(|field| !has_any(field)).collect();
        for row in &mut rows {
            row.retain(|(field, _)| !hidden.contains(field));
        }
        let objects = blocks.iter().map(|block| json!(block)).collect();
        Self { objects, rows }
    }
}

/// The heading of a field's column.
fn heading(field: &str) -> String {
    match field {
        "connected_components" => "parts".to_owned(),
        "slices" => "slices in groups".to_owned(),
        field => field.replace('_', " "),
    }
}

fn degrees(component: &MultidegreeBlock) -> impl Iterator<Item = Row> {
    let entries = component.multidegree.iter();
    entries.map(|entry| [row!(component: id), row!(entry: slices, degree)].concat())
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => "?".into(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        Value::String(text) => text.clone(),
        Value::Array(list) if list.is_empty() => "-".into(),
        Value::Array(list) => list.iter().map(cell).collect::<Vec<_>>().join(" "),
        Value::Number(_) | Value::Object(_) => value.to_string(),
    }
}

/// summary.json, samples.csv with real and imaginary parts, and drawings of curves and surfaces.
fn write(
    folder: &Path,
    summary_json: &str,
    summary: &QuestionSummary,
    axes: &[AxisOf],
) -> Result<(), ClientError> {
    make_folder(folder)?;
    if let Some(points) = PointTable::of(summary) {
        write_file(folder, "samples.csv", &points.whole())?;
    }
    if let QuestionAnswer::RealCurve(RealCurveAnswer { curves, .. }) = &summary.answer {
        let mut file = create(folder, "curve.json")?;
        file.write_json(curves)?;
        file.finish()?;
        let text = arcs(curves, &unknowns(summary));
        write_file(folder, "samples.csv", &text)?;
        if !axes.is_empty() {
            curve_svg::write(folder, curves, axes)?;
        }
    }
    if let QuestionAnswer::RealSurface(answer) = &summary.answer {
        surface::write(folder, &answer.surfaces)?;
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
    points: Vec<(&'a str, &'a [Complex64])>,
}

impl<'a> PointTable<'a> {
    /// The points of an answer; `None` where it is not points of components.
    fn of(summary: &'a QuestionSummary) -> Option<Self> {
        let points = match &summary.answer {
            QuestionAnswer::RealPoints(answer) => {
                let points = answer.points.iter();
                points
                    .map(|p| (p.component.as_str(), p.point.as_slice()))
                    .collect()
            }
            QuestionAnswer::Sample(answer) => {
                let components = answer.components.iter();
                let ids =
                    components.flat_map(|c| std::iter::repeat_n(c.id.as_str(), c.count as usize));
                ids.zip(answer.points.iter().map(Vec::as_slice)).collect()
            }
            _ => return None,
        };
        let unknowns = unknowns(summary);
        Some(Self { unknowns, points })
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
        let mut coordinates = self.points.iter().flat_map(|(_, point)| *point);
        if !coordinates.all(|z| z.im == 0.0) {
            return self.whole();
        }
        let names = self.unknowns.iter().map(|name| format!(",{name}"));
        let mut text = format!("component{}\n", names.collect::<String>());
        for (id, point) in &self.points {
            let numbers = point.iter().map(|z| format!(",{}", json!(z.re)));
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
fn numbers(point: &[Complex64]) -> String {
    let numbers = point.iter();
    let numbers = numbers.map(|z| format!("{},{}", json!(z.re), json!(z.im)));
    numbers.collect::<Vec<String>>().join(",")
}

/// The points of arcs, one a line.
fn arcs(curves: &[CurveBlock], unknowns: &[String]) -> String {
    let mut text = format!("component,edge,index,{}\n", parts(unknowns));
    for curve in curves {
        for (edge, arc) in curve.edges.iter().enumerate() {
            for (index, point) in arc.samples.iter().enumerate() {
                let _ = writeln!(text, "{},{edge},{index},{}", curve.id, numbers(point));
            }
        }
    }
    text
}
