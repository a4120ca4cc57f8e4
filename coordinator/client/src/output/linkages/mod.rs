//! Linkages that were found, for people and for programs: one sheet, in several notations.

pub mod csv;
pub mod designs;
pub mod dxf;
pub mod html;
pub mod json;
pub mod spatial;
pub mod table;

use crate::error::ClientError;
use crate::synthesis::{Answer, Round};
use cognate_kinematics::nine_point::class_record::Found;
use cognate_kinematics::nine_point::family::CLASSES;
use cognate_kinematics::nine_point::{ClassEnd, Curve, PathPoints, mechanisms};
use cognate_systems::named::nine_point;
use std::path::Path;
use std::time::Duration;

/// Links whose lengths are off by more than this, relative to the points' extent, are warned of.
const ROUGH: f64 = 1e-6;

/// All results of a synthesis, with their cost.
pub struct Sheet {
    /// Name of the points, for the user.
    pub name: String,
    /// The points.
    pub points: PathPoints,
    /// Classes by their end: 1442 together.
    pub classes: Vec<(ClassEnd, usize)>,
    /// Classes that were settled by implied solutions, not by what their own paths found.
    pub derived: usize,
    /// Real ones among them; `None` for complex points.
    pub real: Option<usize>,
    /// Classes whose linkage is proved; `None` where that was not asked for.
    pub certified: Option<usize>,
    /// The curves that can be built, best first.
    pub curves: Vec<Curve>,
    /// A solution of each class that has a linkage.
    pub solutions: Vec<Found>,
    /// The jobs.
    pub rounds: Vec<Round>,
    /// Time from reading the points to the answer.
    pub elapsed: Duration,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

impl Sheet {
    /// The sheet of an answer.
    pub fn new(
        name: &str,
        points: &PathPoints,
        answer: Answer,
        certify: bool,
        elapsed: Duration,
    ) -> Self {
        let Answer {
            record,
            rounds,
            derived,
        } = answer;
        let linkages = record.found();
        let curves = mechanisms::curves(&linkages, points);
        let lost = (0..CLASSES).filter(|&class| record.end(class) == ClassEnd::Failed);
        let mut warnings: Vec<String> = lost
            .map(|class| format!("class {class} is not settled: {}", record.reason(class)))
            .collect();
        for (place, curve) in curves.iter().enumerate() {
            let errors = curve.linkages.iter().map(|m| m.realization.error);
            let worst = errors.fold(0.0, f64::max);
            if worst > ROUGH {
                warnings.push(format!(
                    "a linkage of curve {} misses the points by {worst:.0e} of their extent: it \
                     is too large, or too flat, for double precision",
                    place + 1
                ));
            }
        }
        let certified = certify.then(|| linkages.iter().filter(|f| f.arrived.certified).count());
        Self {
            name: name.to_owned(),
            points: points.clone(),
            classes: record.counts(),
            derived,
            real: points.is_real().then_some(curves.len()),
            certified,
            curves,
            solutions: linkages,
            rounds,
            elapsed,
            warnings,
        }
    }

    /// Number of classes with this end.
    pub fn count(&self, end: ClassEnd) -> usize {
        let of_it = self.classes.iter().find(|(kind, _)| *kind == end);
        of_it.map_or(0, |(_, n)| *n)
    }

    /// All linkages, best curve first, with their names.
    pub fn linkages(
        &self,
    ) -> impl Iterator<Item = (String, &Curve, &cognate_kinematics::nine_point::Mechanism)> {
        self.curves.iter().enumerate().flat_map(|(k, curve)| {
            let linkages = curve.linkages.iter().enumerate();
            linkages.map(move |(j, linkage)| (mechanisms::name(k, j), curve, linkage))
        })
    }

    /// CPU time of the tracking, of all jobs.
    pub fn tracking_seconds(&self) -> f64 {
        let rounds = self.rounds.iter();
        rounds.map(|r| r.summary.time.tracking_cpu_seconds).sum()
    }
}

/// The word for an end, as JSON has it.
pub fn word(end: ClassEnd) -> &'static str {
    match end {
        ClassEnd::Finite => "finite",
        ClassEnd::Multiple => "multiple",
        ClassEnd::Degenerate => "degenerate",
        ClassEnd::AtInfinity => "at_infinity",
        ClassEnd::Failed => "failed",
    }
}

/// Lines of solutions.jsonl: a solution of each class that has a linkage. Fields that no class keeps are null.
fn solution_lines(solutions: &[Found]) -> String {
    let unknowns = nine_point().system.variables;
    let line = |solution: &Found| {
        let Found {
            class,
            arrived,
            classes,
        } = solution;
        let values = unknowns.iter().zip(&arrived.point);
        let variables: serde_json::Map<String, serde_json::Value> = values
            .map(|(name, z)| (name.clone(), serde_json::json!([z.re, z.im])))
            .collect();
        let line = serde_json::json!({
            "variables": variables,
            "multiplicity": classes,
            "cycles": null,
            "real": arrived.real,
            "singular": *classes > 1,
            "residual": null,
            "condition": null,
            "accuracy": arrived.accuracy,
            "precision_bits": null,
            "class": class,
            "paths": null,
            "certificate": null,
            "certified": arrived.certified,
        });
        format!("{line}\n")
    };
    solutions.iter().map(line).collect()
}

/// Writes the sheet into a folder: summary.json, solutions.jsonl, linkages.csv, linkages.html, and a drawing of each linkage
/// in dxf/.
pub fn write(folder: &Path, sheet: &Sheet) -> Result<(), ClientError> {
    let mut files = vec![
        ("summary.json".to_owned(), json::sheet(sheet)),
        (
            "solutions.jsonl".to_owned(),
            solution_lines(&sheet.solutions),
        ),
        ("linkages.csv".to_owned(), csv::sheet(sheet)),
        ("linkages.html".to_owned(), html::page(sheet)),
    ];
    let points = sheet.points.plane();
    for (name, _, mechanism) in sheet.linkages() {
        let drawing = dxf::drawing(&mechanism.realization.poses[0], &points);
        files.push((format!("dxf/{name}.dxf"), drawing));
    }
    write_files(folder, files)
}

/// Writes files into a folder, which is made, with a folder dxf in it.
fn write_files(folder: &Path, files: Vec<(String, String)>) -> Result<(), ClientError> {
    let failed = |path: &Path, source| ClientError::File {
        action: "cannot write",
        path: path.to_path_buf(),
        source,
    };
    for (name, text) in files {
        let path = folder.join(name);
        let parent = path.parent().unwrap_or(folder);
        std::fs::create_dir_all(parent).map_err(|e| failed(parent, e))?;
        std::fs::write(&path, text).map_err(|e| failed(&path, e))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_kinematics::nine_point::class_record::Arrived;
    use cognate_systems::formats::points::read_solutions;
    use num_complex::Complex64;

    /// A synthesis wrote no solutions, from which another one could start (2026-11-30).
    #[test]
    fn solutions_can_be_read_as_start_solutions() {
        let solution = Found {
            class: 7,
            arrived: Arrived {
                point: std::array::from_fn(|k| Complex64::new(k as f64 / 3.0, -0.5)),
                accuracy: 1e-15,
                real: Some(false),
                certified: true,
                certified_real: false,
            },
            classes: 1,
        };
        let lines = solution_lines(&[solution.clone(), solution.clone()]);
        let unknowns = nine_point().system.variables;
        let read = read_solutions("solutions.jsonl", lines.as_bytes(), &unknowns);
        let expected = vec![solution.arrived.point.to_vec(); 2];
        assert_eq!(read.expect("points"), expected);
    }
}
