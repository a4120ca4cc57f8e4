//! Linkages that guide a body through poses, for people and for programs.

use super::html::{Content, filled};
use super::json::mechanism_value;
use super::{dxf, table};
use crate::client::error::ClientError;
use crate::client::output::text::{Columns, Look, counted, real, seconds};
use crate::client::synthesis::body_guidance::Dyad;
use crate::results::summary::Summary;
use cognate_kinematics::body_guidance::{Guide, Poses};
use num_complex::Complex64;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// Everything that was found of five poses.
pub struct Guides {
    /// What people call them.
    pub name: String,
    /// The poses.
    pub poses: Poses,
    /// The real dyads.
    pub dyads: Vec<Dyad>,
    /// Their pairs, best first.
    pub guides: Vec<Guide>,
    /// The job.
    pub summary: Summary,
    /// From reading the poses to here.
    pub elapsed: Duration,
}

fn at(z: Complex64) -> Value {
    json!([z.re, z.im])
}

/// The job's summary, with dyads and linkages.
pub fn json(guides: &Guides) -> String {
    format!("{:#}\n", value(guides))
}

fn value(guides: &Guides) -> Value {
    let mut answer = json!(guides.summary);
    answer["problem"]["name"] = json!(guides.name);
    answer["time"]["wall_seconds"] = json!(guides.elapsed.as_secs_f64());
    answer["poses"] = guides
        .poses
        .places()
        .iter()
        .zip(guides.poses.turns())
        .map(|(place, turn)| json!({"place": at(*place), "turn": at(*turn)}))
        .collect();
    let dyads = guides.dyads.iter().map(|dyad| {
        let [pivot, joint] = dyad.ends;
        json!({"pivot": at(pivot), "joint": at(joint), "certified": dyad.certified})
    });
    answer["dyads"] = dyads.collect();
    let linkages = guides.guides.iter().enumerate().map(|(k, guide)| {
        let name = (k + 1).to_string();
        let mut linkage = mechanism_value(&name, &guide.poses, &guide.assessment, guide.error);
        linkage["dyads"] = json!(guide.dyads.map(|d| d + 1));
        linkage
    });
    answer["linkages"] = linkages.collect();
    answer
}

/// A row for each linkage.
pub fn csv(guides: &Guides) -> String {
    let mut text = String::from(
        "name,dyads,grade,type,driver,pivot_a_x,pivot_a_y,pivot_b_x,pivot_b_y,joint_a_x,joint_a_y,\
         joint_b_x,joint_b_y,ground,side_a,coupler,side_b,one_circuit,one_branch,in_order,\
         transmission_degrees,size,error\n",
    );
    for (k, guide) in guides.guides.iter().enumerate() {
        let a = &guide.assessment;
        let first = &guide.poses[0];
        let mut row = vec![
            (k + 1).to_string(),
            format!("{} {}", guide.dyads[0] + 1, guide.dyads[1] + 1),
            a.grade.name().into(),
            a.kind().into(),
            ["a", "b"][a.driver.index()].into(),
        ];
        for z in first.pivots.iter().chain(&first.joints) {
            row.extend([z.re.to_string(), z.im.to_string()]);
        }
        row.extend(a.lengths.around().map(|l| l.to_string()));
        let drive = a.drive();
        row.extend([a.one_circuit, drive.one_branch, drive.in_order].map(|b| b.to_string()));
        row.extend([drive.transmission_degrees, a.size, guide.error].map(|x| x.to_string()));
        let _ = writeln!(text, "{}", row.join(","));
    }
    text
}

/// The answer for people.
pub fn table(guides: &Guides, look: Look) -> String {
    let paths = &guides.summary.paths;
    let answer = format!(
        "{} through the five poses, {}",
        counted(guides.guides.len() as u64, "four-bar linkage"),
        counted(guides.dyads.len() as u64, "real dyad"),
    );
    let mut text = format!("{}: {}\n", look.bold(&guides.name), look.good(&answer));
    let open = match paths.failed {
        0 => String::new(),
        n => format!(", {n} lost"),
    };
    let line = format!(
        "{}: {} finite, {} at infinity{open}; at most 4 dyads (Burmester); {}",
        counted(paths.total, "path"),
        paths.finite,
        paths.at_infinity,
        seconds(guides.elapsed.as_secs_f64())
    );
    let _ = writeln!(text, "{}\n", look.dim(&line));
    let place = |z: Complex64| format!("{}, {}", real(z.re, 6), real(z.im, 6));
    let mut columns = Columns::new(&["dyad", "pivot", "joint in pose 1", "proved"]);
    for (k, dyad) in guides.dyads.iter().enumerate() {
        let [pivot, joint] = dyad.ends;
        let proved = if dyad.certified { "yes" } else { "-" };
        columns.row(vec![
            (k + 1).to_string(),
            place(pivot),
            place(joint),
            proved.into(),
        ]);
    }
    text.push_str(&columns.render(look));
    if guides.guides.is_empty() {
        return text;
    }
    text.push('\n');
    let mut columns = Columns::new(&[
        "#", "dyads", "passes", "type", ">angle", ">size", "order", ">ground", ">driver",
        ">coupler", ">driven",
    ]);
    for (k, guide) in guides.guides.iter().enumerate() {
        let a = &guide.assessment;
        let (own, other) = (a.driver.index(), a.driver.other().index());
        let [ground, coupler] = [a.lengths.ground, a.lengths.coupler];
        let mut row = vec![
            (k + 1).to_string(),
            format!("{} {}", guide.dyads[0] + 1, guide.dyads[1] + 1),
            a.grade.name().into(),
            a.kind().into(),
            format!("{:.1}", a.drive().transmission_degrees),
            real(a.size, 3),
            table::order(a.drive()),
        ];
        let lengths = [
            ground,
            a.lengths.sides[own],
            coupler,
            a.lengths.sides[other],
        ];
        row.extend(lengths.map(|l| real(l, 4)));
        columns.row(row);
    }
    text.push_str(&columns.render(look));
    text
}

/// Writes everything into a folder: summary.json, linkages.csv, linkages.html, and drawings in dxf/.
pub fn write(folder: &Path, guides: &Guides) -> Result<(), ClientError> {
    let page = filled(Content {
        title: &guides.name,
        points: guides.poses.places().iter().map(|z| at(*z)).collect(),
        turns: guides.poses.turns().iter().map(|z| at(*z)).collect(),
        curves: value(guides)["linkages"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|linkage| json!({"linkages": [linkage], "certified": false, "multiplicity": 1}))
            .collect(),
        answer: [
            "Through five poses: ".into(),
            counted(guides.guides.len() as u64, "four-bar linkage"),
            format!(" of {}.", counted(guides.dyads.len() as u64, "dyad")),
        ],
        none: "No four-bar linkage takes a body through these poses.",
        completeness: format!(
            "How complete is this? {} followed, {} lost",
            counted(guides.summary.paths.total, "path"),
            guides.summary.paths.failed
        ),
        counts: vec![
            ("finite", usize::try_from(guides.summary.paths.finite).ok()),
            (
                "at infinity",
                usize::try_from(guides.summary.paths.at_infinity).ok(),
            ),
            ("real", Some(guides.dyads.len())),
        ],
    });
    let mut files = vec![
        ("summary.json".to_owned(), json(guides)),
        ("linkages.csv".to_owned(), csv(guides)),
        ("linkages.html".to_owned(), page),
    ];
    for (k, guide) in guides.guides.iter().enumerate() {
        let drawing = dxf::drawing(&guide.poses[0], guides.poses.places());
        files.push((format!("dxf/{}.dxf", k + 1), drawing));
    }
    super::write_files(folder, files)
}
