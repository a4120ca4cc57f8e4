//! Drawing: what a page needs to draw a mechanism in its real positions and along branches, and the page. Positions that are
//! complex are only counted.

use super::listing::{Finished, Listing};
use super::path::ShownPath;
use super::view::View;
use crate::error::ClientError;
use crate::output::files::write_file;
use cognate_kinematics::compile::Configuration;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::shape::Shape;
use cognate_mechanism_solver::postures::{Counts, Position, Postures};
use cognate_summary::pictures::{MECHANISM, SCENE};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// The page, with places for its title, its data and the scripts that draw.
const PAGE: &str = include_str!("page.html");
/// Most places of bodies in one drawing, so that a page stays below 2 MB.
const MOST_PLACES: usize = 20_000;
/// Most positions in a list.
const MOST_SETS: usize = 400;
/// Most samples of a branch.
const MOST_SAMPLES: usize = 200;

/// A number with as many digits as a drawing needs.
fn rounded(x: f64) -> f64 {
    format!("{x:.7e}").parse().unwrap_or(x)
}

/// Quaternion and place: `[qw, qx, qy, qz, x, y, z]`.
fn place(pose: &Pose) -> Value {
    let numbers = pose.quaternion().into_iter();
    let numbers = numbers.chain(pose.position.map(|c| c.re)).map(rounded);
    json!(numbers.collect::<Vec<f64>>())
}

/// The drawing of a mechanism, to which positions are added while they come.
pub struct Drawing<'a> {
    view: View<'a>,
    shape: Shape,
    columns: Vec<String>,
    counts: Counts,
    sets: Vec<Value>,
    left_out: u64,
}

impl<'a> Drawing<'a> {
    /// Without positions.
    pub fn new(view: View<'a>) -> Self {
        Self {
            view,
            shape: Shape::of(view.mechanism),
            columns: Vec::new(),
            counts: Counts::default(),
            sets: Vec::new(),
            left_out: 0,
        }
    }

    /// Takes the real positions of a target that are listed.
    pub fn take(&mut self, index: u64, answer: &Postures) {
        self.counts.add(&answer.counts);
        let listed = answer.positions.iter();
        let listed = listed.filter(|p| p.is_real && self.view.lists(p));
        let most = MOST_SETS.min(MOST_PLACES / self.shape.bodies.len().max(1));
        for (k, position) in listed.enumerate() {
            if self.sets.len() == most {
                self.left_out += 1;
                continue;
            }
            if self.columns.is_empty() {
                let values = position.configuration.values.iter();
                let columns = values.map(|(name, value)| match value {
                    JointValue::Turn(..) if self.view.degrees => format!("{name} (deg)"),
                    JointValue::Turn(..) => format!("{name} (rad)"),
                    JointValue::Shift(_) => name.to_string(),
                });
                self.columns = columns.collect();
            }
            let title = format!("{}.{}", index + 1, k + 1);
            let set = self.set(title, position);
            self.sets.push(set);
        }
    }

    fn set(&self, title: String, position: &Position) -> Value {
        let values = position.configuration.values.iter();
        let values = values.map(|(_, value)| rounded(self.view.value(value)));
        json!({
            "title": title,
            "real": true,
            "proved": position.certified,
            "limits": match self.view.mechanism.limits.is_empty() {
                true => None,
                false => position.within_limits(),
            },
            "inputs": values.collect::<Vec<f64>>(),
            "poses": self.places(&position.configuration),
        })
    }

    /// Places of the bodies by name, and that of the output.
    fn places(&self, position: &Configuration) -> Map<String, Value> {
        let bodies = self.shape.bodies.iter().zip(self.shape.poses(position));
        let mut places: Map<String, Value> = bodies
            .filter_map(|(body, pose)| Some((body.name.clone(), place(&pose?))))
            .collect();
        if let Some(output) = &position.output {
            places.insert("output".to_owned(), place(output));
        }
        places
    }

    /// The data of the page; `branches` and `curves` are of a path.
    pub fn data(&self, branches: Vec<Value>, curves: Vec<Value>, notes: Vec<String>) -> Value {
        let bodies = self.shape.bodies.iter();
        let bodies =
            bodies.map(|b| json!({"name": b.name, "segments": b.segments, "faces": b.faces}));
        let joints = self.shape.joints.iter().map(|joint| {
            json!({
                "type": joint.kind.letter(), "body": joint.body,
                "point": joint.point, "axis": joint.axis,
            })
        });
        json!({
            "name": self.view.mechanism.name,
            "space": self.view.mechanism.space.name(),
            "bodies": bodies.collect::<Vec<Value>>(),
            "rods": self.shape.rods,
            "joints": joints.collect::<Vec<Value>>(),
            "columns": self.columns,
            "sets": self.sets,
            "left_out": self.left_out,
            "branches": branches,
            "curves": curves,
            "counts": self.counted(),
            "notes": notes,
        })
    }

    fn counted(&self) -> Vec<(&'static str, u64)> {
        let counts = &self.counts;
        let always = [("complex", counts.complex), ("real", counts.real)];
        let asked = [
            ("proved real", counts.certified_real),
            (
                "within limits",
                (!self.view.mechanism.limits.is_empty()).then_some(counts.within_limits),
            ),
        ];
        let rest = [
            ("singular", counts.singular),
            ("at infinity", counts.at_infinity),
            ("on sets of positions", counts.positive_dimensional),
            ("no positions", counts.degenerate),
            ("failed", counts.failed),
        ];
        let asked = asked.into_iter().filter_map(|(name, n)| Some((name, n?)));
        let rest = rest.into_iter().filter(|(_, n)| *n > 0);
        always.into_iter().chain(asked).chain(rest).collect()
    }
}

/// The page that shows this data, in one file that needs no server.
pub fn page(title: &str, data: &Value) -> String {
    // Nothing in it can end the script.
    let data = data.to_string().replace('<', "\\u003c");
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    PAGE.replace("@TITLE@", &title)
        .replace("@SCENE@", SCENE)
        .replace("@MECHANISM@", MECHANISM)
        .replace("@DATA@", &data)
}

/// Writes `page.json` and `page.html`.
fn write(folder: &Path, data: &Value) -> Result<(), ClientError> {
    let title = data["name"].as_str().unwrap_or("mechanism");
    write_file(folder, "page.json", &format!("{data}\n"))?;
    write_file(folder, "page.html", &page(title, data))
}

/// The drawing as two files of the folder of --output.
pub struct Pages<'a> {
    drawing: Drawing<'a>,
    folder: PathBuf,
}

impl<'a> Pages<'a> {
    /// In a folder that is there.
    pub fn new(view: View<'a>, folder: &Path) -> Self {
        Self {
            drawing: Drawing::new(view),
            folder: folder.to_owned(),
        }
    }
}

impl Listing for Pages<'_> {
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError> {
        self.drawing.take(index, answer);
        Ok(())
    }

    fn finish(self: Box<Self>, end: &Finished<'_>) -> Result<(), ClientError> {
        let notes = match end.summary.settled {
            true => Vec::new(),
            false => vec!["Not settled: a count is in doubt.".to_owned()],
        };
        let data = self.drawing.data(Vec::new(), Vec::new(), notes);
        write(&self.folder, &data)
    }
}

/// The branches of a path as data of a page.
pub fn of_path(shown: &ShownPath<'_>) -> Value {
    let mut drawing = Drawing::new(shown.view);
    for answer in &shown.path.answers {
        drawing.counts.add(&answer.counts);
    }
    let chosen: Vec<_> = shown.branches().collect();
    let places = drawing.shape.bodies.len().max(1) * chosen.len().max(1);
    let most = (MOST_PLACES / places).clamp(10, MOST_SAMPLES);
    let mut notes = Vec::new();
    if !shown.path.settled {
        notes.push("Not settled: a branch is in doubt.".to_owned());
    }
    if chosen.iter().any(|(_, b)| b.positions.len() > most) {
        notes.push(format!("Branches are drawn with {most} of their samples."));
    }
    let (mut branches, mut curves) = (Vec::new(), Vec::new());
    for (b, branch) in chosen {
        let last = branch.positions.len() - 1;
        let count = most.min(last + 1);
        let samples = (0..count).map(|k| k * last / (count - 1).max(1));
        let (mut input, mut poses, mut traced) = (Vec::new(), Map::new(), Vec::new());
        for k in samples {
            let sample = branch.first + k;
            let answer = &shown.path.answers[sample];
            let position = &answer.positions[branch.positions[k]].configuration;
            input.push(sample + 1);
            traced.extend(
                position
                    .output
                    .map(|pose| pose.position.map(|c| rounded(c.re))),
            );
            for (name, place) in drawing.places(position) {
                let list = poses.entry(name).or_insert_with(|| json!([]));
                list.as_array_mut()
                    .into_iter()
                    .for_each(|l| l.push(place.clone()));
            }
        }
        let folds = shown
            .path
            .folds
            .iter()
            .filter(|fold| fold.branches.contains(&b));
        branches.push(json!({
            "title": format!("branch {}", b + 1),
            "input": input,
            "poses": poses,
            "folds": folds.map(|fold| fold.at + 1.0).collect::<Vec<f64>>(),
            "limits": branch.within_limits,
        }));
        curves.push(json!({"of": "output", "points": traced}));
    }
    drawing.data(branches, curves, notes)
}

/// Writes the page of a path.
pub fn write_path(shown: &ShownPath<'_>, folder: &Path) -> Result<(), ClientError> {
    write(folder, &of_path(shown))
}
