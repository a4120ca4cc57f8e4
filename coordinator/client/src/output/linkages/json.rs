//! The sheet as one JSON object: the summary of the first job, with classes and linkages.

use super::{Sheet, word};
use crate::synthesis::Round;
use cognate_kinematics::assessment::Assessment;
use cognate_kinematics::drive::Drive;
use cognate_kinematics::linkage::Linkage;
use cognate_kinematics::nine_point::family::CLASSES;
use cognate_kinematics::nine_point::{ClassEnd, Curve, Mechanism, mechanisms};
use num_complex::Complex64;
use serde_json::{Map, Value, json};

/// The object, laid out for reading.
pub fn sheet(sheet: &Sheet) -> String {
    format!("{:#}\n", value(sheet))
}

/// The object.
pub fn value(sheet: &Sheet) -> Value {
    let first = sheet.rounds.first().map(|round| &round.summary);
    let mut answer = first.map_or_else(|| json!({}), |s| json!(s));
    answer["problem"]["name"] = json!(sheet.name);
    answer["points"] = points(sheet);
    answer["classes"] = classes(sheet);
    answer["rounds"] = rounds(&sheet.rounds);
    let tracking = sheet.tracking_seconds();
    answer["time"]["wall_seconds"] = json!(sheet.elapsed.as_secs_f64());
    answer["time"]["cpu_seconds"] = json!(tracking);
    answer["time"]["tracking_cpu_seconds"] = json!(tracking);
    answer["settled"] = json!(sheet.count(ClassEnd::Failed) == 0);
    answer["warnings"] = json!(sheet.warnings);
    let curves = sheet.curves.iter().enumerate();
    answer["curves"] = curves.map(|(place, c)| curve(place, c)).collect();
    answer
}

/// A line for one set of a sweep: its classes, its points, and its linkages without their
/// positions.
pub fn line(sheet: &Sheet) -> String {
    let curves = sheet.curves.iter().enumerate().map(|(place, c)| {
        let mut curve = curve(place, c);
        for linkage in curve["linkages"].as_array_mut().into_iter().flatten() {
            if let Some(fields) = linkage.as_object_mut() {
                fields.remove("positions");
            }
        }
        curve
    });
    let line = json!({
        "name": sheet.name,
        "points": points(sheet),
        "classes": classes(sheet),
        "settled": sheet.count(ClassEnd::Failed) == 0,
        "curves": curves.collect::<Value>(),
        "warnings": sheet.warnings,
    });
    format!("{line}\n")
}

fn points(sheet: &Sheet) -> Value {
    let points = sheet.points.coordinates().iter();
    if sheet.points.is_real() {
        return points.map(|[x, y]| json!([x.re, y.re])).collect();
    }
    let parts = |z: &Complex64| json!([z.re, z.im]);
    points.map(|[x, y]| json!([parts(x), parts(y)])).collect()
}

/// The counts, which add up to 1442.
fn classes(sheet: &Sheet) -> Value {
    let mut classes = Map::new();
    classes.insert("count".into(), json!(CLASSES));
    classes.insert("group_order".into(), json!(6));
    let settled = CLASSES - sheet.count(ClassEnd::Failed);
    classes.insert("complete".into(), json!(settled));
    for (end, n) in &sheet.classes {
        classes.insert(word(*end).into(), json!(n));
    }
    classes.insert("derived".into(), json!(sheet.derived));
    classes.insert("real".into(), json!(sheet.real));
    classes.insert("certified".into(), json!(sheet.certified));
    let proved = sheet.curves.iter().filter(|c| c.certified).count();
    classes.insert(
        "certified_real".into(),
        json!(sheet.certified.map(|_| proved)),
    );
    classes.into()
}

/// The jobs, each with its paths.
pub(super) fn rounds(rounds: &[Round]) -> Value {
    let rounds = rounds.iter().map(|round| {
        json!({"purpose": round.purpose, "job": round.summary.job, "paths": round.summary.paths})
    });
    rounds.collect()
}

fn curve(place: usize, curve: &Curve) -> Value {
    let linkages = curve.linkages.iter().enumerate();
    let solution = curve.solution.iter().map(|z| json!([z.re, z.im]));
    json!({
        "curve": place + 1,
        "class": curve.class,
        "multiplicity": curve.classes,
        "certified": curve.certified,
        "solution": solution.collect::<Value>(),
        "linkages": linkages
            .map(|(k, linkage)| mechanism(&mechanisms::name(place, k), linkage))
            .collect::<Value>(),
    })
}

fn at(z: Complex64) -> Value {
    json!([z.re, z.im])
}

fn mechanism(name: &str, mechanism: &Mechanism) -> Value {
    let made = &mechanism.realization;
    mechanism_value(name, &made.poses, &mechanism.assessment, made.error)
}

/// A linkage in its positions.
pub(super) fn mechanism_value(name: &str, poses: &[Linkage], a: &Assessment, error: f64) -> Value {
    let first = &poses[0];
    let position = |pose: &Linkage| json!({"joints": pose.joints.map(at)});
    json!({
        "name": name,
        "grade": a.grade.name(),
        "type": a.kind(),
        "grashof": a.mobility.circuits() == 2,
        "pivots": first.pivots.map(at),
        "joints": first.joints.map(at),
        "coupler_point": at(first.point),
        "lengths": {
            "ground": a.lengths.ground,
            "sides": a.lengths.sides,
            "coupler": a.lengths.coupler,
            "arms": a.lengths.arms,
        },
        "one_circuit": a.one_circuit,
        "driver": a.driver.index(),
        "drives": a.drives.each_ref().map(drive),
        "size": a.size,
        "quality": a.quality(),
        "error": error,
        "positions": poses.iter().map(position).collect::<Value>(),
    })
}

fn drive(drive: &Drive) -> Value {
    let order = drive
        .order
        .as_ref()
        .map(|order| order.iter().map(|k| k + 1).collect::<Vec<_>>());
    json!({
        "turns_round": drive.turns_round,
        "one_branch": drive.one_branch,
        "order": order,
        "in_order": drive.in_order,
        "transmission_degrees": drive.transmission_degrees,
        "swing_degrees": drive.swing_degrees,
    })
}
