//! Chains of two or three joints in space, for people and for programs.

use crate::error::{ClientError, Exit};
use crate::output::summary;
use crate::output::text::{Columns, Look, count, counted, real, seconds};
use crate::synthesis::spatial_dyads::Answer;
use cognate_kinematics::spatial_dyads::{Chain, Part, SpatialPoses, Vector};
use cognate_solutions::completeness::Completeness;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// Parts of a coordinate smaller than this beside the others are not shown.
const NOTHING: f64 = 1e-13;

/// Poses with the chains that pass them.
pub struct SpatialSheet {
    /// Name of the file, for the user.
    pub name: String,
    /// The poses.
    pub poses: SpatialPoses,
    /// The chains.
    pub answer: Answer,
    /// Time from reading the file to the answer.
    pub elapsed: Duration,
}

impl SpatialSheet {
    /// Whether every path is settled, and no chain is in doubt.
    pub fn exit(&self) -> Exit {
        match summary::exit(&self.answer.summary) {
            Exit::Solved if !self.answer.doubts.is_empty() => Exit::Unsettled,
            exit => exit,
        }
    }
}

fn name(chain: Chain) -> &'static str {
    match chain {
        Chain::BallBall => "SS",
        Chain::PlaneBall => "PPS",
        Chain::Cylinders => "CC",
        Chain::SphericalHinges => "spherical-RR",
        Chain::CylinderBall => "CS",
        Chain::HingeSliderBall => "RPS",
    }
}

/// Names of the vectors of the fixed part, and of the moving part.
fn names(chain: Chain) -> [&'static [&'static str]; 2] {
    match chain {
        Chain::BallBall => [&["point"], &["point"]],
        Chain::PlaneBall => [&["point", "normal"], &["point"]],
        Chain::Cylinders => [&["point", "direction"], &["point", "direction"]],
        Chain::SphericalHinges => [&["direction"], &["direction"]],
        Chain::CylinderBall | Chain::HingeSliderBall => [&["point", "direction"], &["point"]],
    }
}

/// The vectors of a part, in the order of their names.
fn vectors(part: Part) -> Vec<Vector> {
    match part {
        Part::Point(vector) | Part::Direction(vector) => vec![vector],
        Part::Line(point, vector)
        | Part::Plane(point, vector)
        | Part::Hyperboloid(point, vector, _) => vec![point, vector],
    }
}

/// The summary of the solve, with the chains and the linkages.
pub fn json(sheet: &SpatialSheet) -> String {
    let answer = &sheet.answer;
    let [of_fixed, of_moving] = names(sheet.poses.chain());
    let part = |names: &[&str], part: Part| -> Value {
        let named = names.iter().zip(vectors(part));
        named
            .map(|(name, vector)| ((*name).to_owned(), json!(vector)))
            .collect()
    };
    let mut value = json!(answer.summary);
    value["problem"]["name"] = json!(sheet.name);
    value["time"]["wall_seconds"] = json!(sheet.elapsed.as_secs_f64());
    value["settled"] = json!(sheet.exit() == Exit::Solved);
    if let Some(warnings) = value["warnings"].as_array_mut() {
        warnings.extend(answer.doubts.iter().map(|doubt| json!(doubt)));
    }
    value["chain"] = json!(name(sheet.poses.chain()));
    if sheet.poses.chain() == Chain::HingeSliderBall {
        value["on_other_surfaces"] = json!(answer.on_other_surfaces);
    }
    let dyads = answer.dyads.iter().map(|(dyad, certified)| {
        json!({"fixed": part(of_fixed, dyad.fixed), "moving": part(of_moving, dyad.moving), "distance": dyad.distance,
               "angle_degrees": dyad.angle, "error": dyad.error, "certified": certified})
    });
    value["dyads"] = dyads.collect();
    let linkages = answer.linkages.iter().map(|linkage| {
        json!({"dyads": linkage.dyads.map(|k| k + 1), "grade": linkage.grade.name(), "type": linkage.kind,
               "arcs_degrees": linkage.arcs})
    });
    value["linkages"] = linkages.collect();
    format!("{value:#}\n")
}

/// A row for each chain.
pub fn csv(sheet: &SpatialSheet) -> String {
    let sides = ["fixed", "moving"]
        .into_iter()
        .zip(names(sheet.poses.chain()));
    let columns =
        sides.flat_map(|(side, names)| names.iter().map(move |name| format!("{side}_{name}")));
    let columns = columns.flat_map(|column| ["x", "y", "z"].map(|axis| format!("{column}_{axis}")));
    let columns: Vec<String> = columns.collect();
    let mut text = format!(
        "name,{},distance,angle_degrees,error,certified\n",
        columns.join(",")
    );
    for (k, (dyad, certified)) in sheet.answer.dyads.iter().enumerate() {
        let parts = [dyad.fixed, dyad.moving].into_iter().flat_map(vectors);
        let mut cells = vec![(k + 1).to_string()];
        cells.extend(parts.flatten().map(|x| x.to_string()));
        let optional = |value: Option<f64>| value.map(|x| x.to_string()).unwrap_or_default();
        cells.extend([
            optional(dyad.distance),
            optional(dyad.angle),
            dyad.error.to_string(),
            certified.to_string(),
        ]);
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// A row for each spherical four-bar.
fn csv_of_linkages(sheet: &SpatialSheet) -> String {
    let mut text = String::from(
        "name,driver,driven,grade,type,ground_degrees,driver_degrees,coupler_degrees,driven_degrees\n",
    );
    for (k, linkage) in sheet.answer.linkages.iter().enumerate() {
        let [driver, driven] = linkage.dyads.map(|dyad| dyad + 1);
        let arcs = linkage.arcs.map(|arc| arc.to_string()).join(",");
        let (grade, kind) = (linkage.grade.name(), linkage.kind);
        let _ = writeln!(text, "{},{driver},{driven},{grade},{kind},{arcs}", k + 1);
    }
    text
}

/// The answer for people.
pub fn table(sheet: &SpatialSheet, look: Look) -> String {
    let (answer, chain) = (&sheet.answer, sheet.poses.chain());
    let mut words = format!(
        "{} of type {} through the {} poses",
        counted(answer.dyads.len() as u64, "real chain"),
        name(chain),
        chain.poses()
    );
    if chain == Chain::SphericalHinges {
        let linkages = counted(answer.linkages.len() as u64, "spherical four-bar linkage");
        let _ = write!(words, ", {linkages}");
    }
    let mut text = format!("{}: {}\n", look.bold(&sheet.name), look.good(&words));
    let paths = &answer.summary.paths;
    let rest = [
        (paths.singular, "singular"),
        (
            paths.positive_dimensional.unwrap_or_default(),
            "on families",
        ),
        (paths.excess.unwrap_or_default(), "to no chain"),
        (paths.failed, "lost"),
    ];
    let rest = rest.into_iter().filter(|(number, _)| *number > 0);
    let rest: String = rest
        .map(|(number, end)| format!(", {} {end}", count(number)))
        .collect();
    let line = format!(
        "{}: {} finite, {} at infinity{rest}; at most {} chains; {}",
        counted(paths.total, "path"),
        paths.finite,
        paths.at_infinity,
        chain.most(),
        seconds(sheet.elapsed.as_secs_f64())
    );
    let _ = writeln!(text, "{}", look.dim(&line));
    if answer.on_other_surfaces > 0 {
        let _ = writeln!(
            text,
            "{} on ellipsoids or hyperboloids of two sheets, which no chain of this type makes",
            counted(answer.on_other_surfaces, "real solution")
        );
    }
    if answer.summary.solutions.complete != Completeness::Yes {
        let reason = answer.summary.solutions.complete_reason.as_deref();
        let reason = reason.map_or(String::new(), |reason| format!(": {reason}"));
        let _ = writeln!(text, "whether these are all chains is not known{reason}");
    }
    for warning in answer.summary.warnings.iter().chain(&answer.doubts) {
        let _ = writeln!(text, "warning: {warning}");
    }
    if !answer.dyads.is_empty() {
        text.push('\n');
        text.push_str(&chains(sheet, look));
    }
    if !answer.linkages.is_empty() {
        text.push('\n');
        text.push_str(&linkages(sheet, look));
    }
    text
}

fn chains(sheet: &SpatialSheet, look: Look) -> String {
    let vector = |vector: Vector| {
        let size = vector.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        let shown = |x: f64| real(if x.abs() < NOTHING * size { 0.0 } else { x }, 6);
        vector.map(shown).join(", ")
    };
    let dyads = &sheet.answer.dyads;
    let sides = ["fixed", "moving"]
        .into_iter()
        .zip(names(sheet.poses.chain()));
    let named =
        sides.flat_map(|(side, names)| names.iter().map(move |name| format!("{side} {name}")));
    let mut heads = vec!["chain".to_owned()];
    heads.extend(named);
    if let Some((first, _)) = dyads.first() {
        heads.extend(first.distance.map(|_| ">distance".to_owned()));
        heads.extend(first.angle.map(|_| ">angle".to_owned()));
    }
    heads.push("proved".into());
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let mut columns = Columns::new(&heads);
    for (k, (dyad, certified)) in dyads.iter().enumerate() {
        let mut row = vec![(k + 1).to_string()];
        let parts = [dyad.fixed, dyad.moving].into_iter().flat_map(vectors);
        row.extend(parts.map(vector));
        row.extend(dyad.distance.map(|x| real(x, 6)));
        row.extend(dyad.angle.map(|x| real(x, 6)));
        row.push(if *certified { "yes" } else { "-" }.into());
        columns.row(row);
    }
    columns.render(look)
}

fn linkages(sheet: &SpatialSheet, look: Look) -> String {
    let names = [
        "#", "chains", "passes", "type", ">ground", ">driver", ">coupler", ">driven",
    ];
    let mut columns = Columns::new(&names);
    for (k, linkage) in sheet.answer.linkages.iter().enumerate() {
        let [driver, driven] = linkage.dyads.map(|dyad| dyad + 1);
        let mut row = vec![
            (k + 1).to_string(),
            format!("{driver} {driven}"),
            linkage.grade.name().into(),
            linkage.kind.into(),
        ];
        row.extend(linkage.arcs.map(|arc| format!("{arc:.2}")));
        columns.row(row);
    }
    columns.render(look)
}

/// Writes summary.json and dyads.csv into a folder, and linkages.csv of hinges.
pub fn write(folder: &Path, sheet: &SpatialSheet) -> Result<(), ClientError> {
    let mut files = vec![
        ("summary.json".to_owned(), json(sheet)),
        ("dyads.csv".to_owned(), csv(sheet)),
    ];
    if sheet.poses.chain() == Chain::SphericalHinges {
        files.push(("linkages.csv".to_owned(), csv_of_linkages(sheet)));
    }
    super::write_files(folder, files)
}
