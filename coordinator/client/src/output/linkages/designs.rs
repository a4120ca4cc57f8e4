//! Linkages of the nine-point problem's sisters, for people and for programs.

use super::html::{Content, filled};
use super::json::mechanism_value;
use super::{dxf, table};
use crate::error::{ClientError, Exit};
use crate::output::summary;
use crate::output::text::{Columns, Look, count, counted, real, seconds};
use crate::synthesis::designs::{Found, Sister};
use cognate_kinematics::design::Design;
use num_complex::Complex64;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// Smaller parts of a coordinate are not shown.
const NOTHING: f64 = 1e-13;

/// Everything that was found.
pub struct Designs {
    /// Name of the file, for the user.
    pub name: String,
    /// The synthesis problem that was asked.
    pub sister: Sister,
    /// The linkages that were found, and their counts.
    pub found: Found,
    /// Time from reading the file to the answer.
    pub elapsed: Duration,
}

/// A sister in words.
struct Words {
    /// Words after the count of linkages.
    given: &'static str,
    /// How many there can be, and who says so.
    most: String,
}

impl Designs {
    fn words(&self) -> Words {
        match &self.sister {
            Sister::Poses(_) => Words {
                given: "through the five poses",
                most: "at most 4 dyads (Burmester)".into(),
            },
            Sister::TimedPoints(_) => Words {
                given: "through the five points at the crank's angles",
                most: "at most 4 drivers with 3 partners each".into(),
            },
            Sister::AnglePairs(_) => Words {
                given: "for the five pairs of angles",
                most: "at most 3 linkages; the root 0 is none".into(),
            },
            Sister::TimedPoses(_, pivots) => Words {
                given: "through the three poses at the crank's angles",
                most: match pivots.is_empty() {
                    true => "one crank; any link that passes the poses may be driven: --pivot X,Y names its pivot".into(),
                    false => "one crank, and one driven link for each pivot".into(),
                },
            },
            Sister::PosesAndPoints(given) => Words {
                given: "through the poses and points",
                most: format!(
                    "at most {} linkages, each of two paths (Brake and others 2016)",
                    count(given.mixture().linkages())
                ),
            },
        }
    }

    /// The places that were asked for, none of angles.
    fn places(&self) -> &[Complex64] {
        match &self.sister {
            Sister::Poses(poses) => poses.places(),
            Sister::TimedPoints(points) => points.points(),
            Sister::AnglePairs(_) => &[],
            Sister::PosesAndPoints(given) => given.places(),
            Sister::TimedPoses(poses, _) => poses.places(),
        }
    }

    /// The sum of a count over all jobs.
    fn sum(&self, count: impl Fn(&cognate_summary::solve::Summary) -> u64) -> u64 {
        let rounds = self.found.rounds.iter();
        rounds.map(|round| count(&round.summary)).sum()
    }

    /// Whether every path of every job is settled.
    pub fn exit(&self) -> Exit {
        let exits = self.found.rounds.iter();
        let mut exits = exits.map(|round| summary::exit(&round.summary));
        let open = exits.find(|exit| *exit != Exit::Solved);
        // Linear equations make no job; what they do not determine is a warning.
        let undetermined = self.found.rounds.is_empty() && !self.found.warnings.is_empty();
        open.unwrap_or(if undetermined {
            Exit::Unsettled
        } else {
            Exit::Solved
        })
    }

    /// Names of the two dyads of a design.
    fn pair(&self, design: &Design) -> String {
        match self.found.dyads.is_empty() {
            true => String::new(),
            false => format!("{} {}", design.dyads[0] + 1, design.dyads[1] + 1),
        }
    }
}

fn at(z: Complex64) -> Value {
    json!([z.re, z.im])
}

/// The first job's summary, with the task, the dyads and the linkages.
pub fn json(designs: &Designs) -> String {
    format!("{:#}\n", value(designs))
}

fn value(designs: &Designs) -> Value {
    let design_set = &designs.found;
    let first = design_set.rounds.first().map(|round| &round.summary);
    let mut answer = first.map_or_else(|| json!({}), |s| json!(s));
    answer["problem"]["name"] = json!(designs.name);
    answer["time"]["wall_seconds"] = json!(designs.elapsed.as_secs_f64());
    answer["settled"] = json!(designs.exit() == Exit::Solved);
    answer["rounds"] = super::json::rounds(&design_set.rounds);
    answer["warnings"] = json!(design_set.warnings);
    match &designs.sister {
        Sister::Poses(poses) => {
            let both = poses.places().iter().zip(poses.turns());
            let pose = |(place, turn): (&Complex64, &Complex64)| json!({"place": at(*place), "turn": at(*turn)});
            answer["poses"] = both.map(pose).collect();
        }
        Sister::TimedPoints(points) => {
            let both = points.points().iter().zip(points.cranks());
            let timed = |(place, crank): (&Complex64, &Complex64)| json!({"place": at(*place), "crank": at(*crank)});
            answer["points"] = both.map(timed).collect();
        }
        Sister::AnglePairs(pairs) => {
            let pair = |[input, output]: &[Complex64; 2]| json!({"input": at(*input), "output": at(*output)});
            answer["angles"] = pairs.pairs().iter().map(pair).collect();
        }
        Sister::TimedPoses(poses, _) => {
            let each = (0..3).map(|k| {
                let [place, turn, crank] =
                    [poses.places(), poses.turns(), poses.cranks()].map(|z| at(z[k]));
                json!({"place": place, "turn": turn, "crank": crank})
            });
            answer["poses"] = each.collect();
        }
        Sister::PosesAndPoints(given) => {
            let both = given.places().iter().zip(given.turns());
            let position = |(place, turn): (&Complex64, &Option<Complex64>)| json!({"place": at(*place), "turn": turn.map(at)});
            answer["positions"] = both.map(position).collect();
        }
    }
    let dyads = design_set.dyads.iter().map(|dyad| {
        let [pivot, joint] = dyad.ends;
        json!({"pivot": at(pivot), "joint": at(joint), "certified": dyad.certified})
    });
    answer["dyads"] = dyads.collect();
    let linkages = design_set.designs.iter().enumerate().map(|(k, design)| {
        let name = (k + 1).to_string();
        let mut linkage =
            mechanism_value(&name, &design.positions, &design.assessment, design.error);
        if !design_set.dyads.is_empty() {
            linkage["dyads"] = json!(design.dyads.map(|d| d + 1));
        }
        linkage
    });
    answer["linkages"] = linkages.collect();
    answer
}

/// A row for each linkage.
pub fn csv(designs: &Designs) -> String {
    let mut text = String::from(
        "name,dyads,grade,type,driver,pivot_a_x,pivot_a_y,pivot_b_x,pivot_b_y,joint_a_x,joint_a_y,\
         joint_b_x,joint_b_y,ground,side_a,coupler,side_b,one_circuit,one_branch,in_order,\
         transmission_degrees,size,error\n",
    );
    for (k, design) in designs.found.designs.iter().enumerate() {
        let a = &design.assessment;
        let first = &design.positions[0];
        let mut row = vec![
            (k + 1).to_string(),
            designs.pair(design),
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
        row.extend([drive.transmission_degrees, a.size, design.error].map(|x| x.to_string()));
        let _ = writeln!(text, "{}", row.join(","));
    }
    text
}

/// The answer for people.
pub fn table(designs: &Designs, look: Look) -> String {
    let (design_set, words) = (&designs.found, designs.words());
    let mut answer = format!(
        "{} {}",
        counted(design_set.designs.len() as u64, "four-bar linkage"),
        words.given
    );
    if !design_set.dyads.is_empty() {
        let dyads = counted(design_set.dyads.len() as u64, "real dyad");
        let _ = write!(answer, ", {dyads}");
    }
    let mut text = format!("{}: {}\n", look.bold(&designs.name), look.good(&answer));
    let lost = designs.sum(|summary| summary.paths.failed);
    let open = match lost {
        0 => String::new(),
        n => format!(", {n} lost"),
    };
    let line = if design_set.rounds.is_empty() {
        format!("{}; {}", words.most, seconds(designs.elapsed.as_secs_f64()))
    } else {
        format!(
            "{}: {} finite, {} at infinity{open}; {}; {}",
            counted(designs.sum(|summary| summary.paths.total), "path"),
            designs.sum(|summary| summary.paths.finite),
            designs.sum(|summary| summary.paths.at_infinity),
            words.most,
            seconds(designs.elapsed.as_secs_f64())
        )
    };
    let _ = writeln!(text, "{}", look.dim(&line));
    for warning in &design_set.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    if !design_set.dyads.is_empty() {
        text.push('\n');
        text.push_str(&dyads(designs, look));
    }
    if !design_set.designs.is_empty() {
        text.push('\n');
        text.push_str(&linkages(designs, look));
    }
    text
}

fn dyads(designs: &Designs, look: Look) -> String {
    let place = |z: Complex64| {
        // A coordinate that is only rounding beside the other is 0.
        let shown = |x: f64| match x.abs() < NOTHING * (1.0 + z.re.abs().max(z.im.abs())) {
            true => real(0.0, 6),
            false => real(x, 6),
        };
        format!("{}, {}", shown(z.re), shown(z.im))
    };
    let joint = match designs.sister {
        Sister::Poses(_) | Sister::TimedPoses(..) => "joint in pose 1",
        _ => "joint in position 1",
    };
    let mut columns = Columns::new(&["dyad", "pivot", joint, "proved"]);
    for (k, dyad) in designs.found.dyads.iter().enumerate() {
        let proved = if dyad.certified { "yes" } else { "-" };
        let [pivot, joint] = dyad.ends.map(place);
        columns.row(vec![(k + 1).to_string(), pivot, joint, proved.into()]);
    }
    columns.render(look)
}

fn linkages(designs: &Designs, look: Look) -> String {
    let mut names = vec![
        "#", "passes", "type", ">angle", ">size", "order", ">ground", ">driver", ">coupler",
        ">driven",
    ];
    let of_dyads = !designs.found.dyads.is_empty();
    if of_dyads {
        names.insert(1, "dyads");
    }
    let mut columns = Columns::new(&names);
    for (k, design) in designs.found.designs.iter().enumerate() {
        let a = &design.assessment;
        let (driver, other) = (a.driver.index(), a.driver.other().index());
        let mut row = vec![(k + 1).to_string()];
        if of_dyads {
            row.push(designs.pair(design));
        }
        row.extend([
            a.grade.name().into(),
            a.kind().into(),
            format!("{:.1}", a.drive().transmission_degrees),
            real(a.size, 3),
            table::order(a.drive()),
        ]);
        let lengths = [
            a.lengths.ground,
            a.lengths.sides[driver],
            a.lengths.coupler,
            a.lengths.sides[other],
        ];
        row.extend(lengths.map(|l| real(l, 4)));
        columns.row(row);
    }
    columns.render(look)
}

/// Writes everything into a folder: summary.json, linkages.csv, linkages.html, and drawings in dxf/.
pub fn write(folder: &Path, designs: &Designs) -> Result<(), ClientError> {
    let mut files = vec![
        ("summary.json".to_owned(), json(designs)),
        ("linkages.csv".to_owned(), csv(designs)),
        ("linkages.html".to_owned(), page(designs)),
    ];
    for (k, design) in designs.found.designs.iter().enumerate() {
        let drawing = dxf::drawing(&design.positions[0], designs.places());
        files.push((format!("dxf/{}.dxf", k + 1), drawing));
    }
    super::write_files(folder, files)
}

fn page(designs: &Designs) -> String {
    let (design_set, words) = (&designs.found, designs.words());
    let turns = match &designs.sister {
        Sister::Poses(poses) => poses.turns().iter().map(|z| at(*z)).collect(),
        Sister::PosesAndPoints(given) => given.turns().iter().map(|turn| turn.map(at)).collect(),
        Sister::TimedPoses(poses, _) => poses.turns().iter().map(|z| at(*z)).collect(),
        Sister::TimedPoints(_) | Sister::AnglePairs(_) => Value::Null,
    };
    let own_points = |design: &Design| -> Value {
        match designs.sister {
            Sister::AnglePairs(_) => design.positions.iter().map(|p| at(p.point)).collect(),
            Sister::Poses(_)
            | Sister::TimedPoints(_)
            | Sister::TimedPoses(..)
            | Sister::PosesAndPoints(_) => Value::Null,
        }
    };
    let designs_value = value(designs);
    let linkages = designs_value["linkages"].as_array().into_iter().flatten();
    let lost = designs.sum(|summary| summary.paths.failed);
    let number = |n: u64| usize::try_from(n).ok();
    filled(Content {
        title: &designs.name,
        points: designs.places().iter().map(|z| at(*z)).collect(),
        turns,
        curves: linkages
            .zip(&design_set.designs)
            .map(|(linkage, design)| {
                json!({"linkages": [linkage], "points": own_points(design), "certified": false,
                       "multiplicity": 1})
            })
            .collect(),
        answer: [
            "There are ".into(),
            counted(design_set.designs.len() as u64, "four-bar linkage"),
            format!(" {}.", words.given),
        ],
        none: "No four-bar linkage does that.",
        completeness: format!(
            "How complete is this? {} followed, {lost} lost",
            counted(designs.sum(|summary| summary.paths.total), "path"),
        ),
        counts: vec![
            (
                "finite",
                number(designs.sum(|summary| summary.paths.finite)),
            ),
            (
                "at infinity",
                number(designs.sum(|summary| summary.paths.at_infinity)),
            ),
            ("linkages", Some(design_set.designs.len())),
        ],
    })
}
