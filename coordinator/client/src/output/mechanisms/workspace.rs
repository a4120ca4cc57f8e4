//! Reachability of points by an output, and the boundary of the points that it reaches, as tables and JSON.

use super::view::mechanism_json;
use crate::output::text::{Columns, Look, counted};
use cognate_kinematics::mechanism::Mechanism;
use cognate_mechanism_solver::workspace::{Boundary, BoundaryCurve, Cause, ReachedPoint};
use serde_json::{Value, json};

/// Data that all points of a workspace share.
pub struct WorkspaceView<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// The bytes of its file.
    pub content: &'a [u8],
    /// Whether a point counts as reachable only within limits.
    pub within_limits: bool,
    /// Whether nothing is in doubt.
    pub is_settled: bool,
    /// Boundary of the points that are reached.
    pub boundary: &'a Boundary,
}

/// Points and the boundary, for people.
pub fn table(view: &WorkspaceView<'_>, answers: &[ReachedPoint], look: Look) -> String {
    let mut text = String::new();
    if !answers.is_empty() {
        text.push_str(&point_rows(view, answers, look));
    }
    let most = view.boundary.max_postures.as_ref();
    let most = most.map(|most| format!("at most {} at a point", counted(*most, "posture")));
    let Ok(curves) = &view.boundary.curves else {
        if let Ok(most) = most {
            text.push_str(&format!("{most}\n"));
        }
        return text;
    };
    if !answers.is_empty() {
        text.push('\n');
    }
    if !curves.is_empty() {
        text.push_str(&curve_rows(curves, look));
    }
    let area = match &view.boundary.area {
        Ok(area) => format!("area {area:.6}"),
        Err(reason) => format!("no area: {reason}"),
    };
    let most = most.unwrap_or_else(Clone::clone);
    text.push_str(&format!("{area}; {most}\n"));
    text
}

/// The points, a row each.
fn point_rows(view: &WorkspaceView<'_>, answers: &[ReachedPoint], look: Look) -> String {
    let mut columns = Columns::new(&[">point", "reachable", ">postures", ">within limits"]);
    for (index, answer) in answers.iter().enumerate() {
        let word = match answer.is_reachable(view.within_limits) {
            Some(true) => "yes",
            Some(false) => "no",
            None => "in doubt",
        };
        let infinitely_many = "infinitely many";
        let postures = match answer.reachable.is_some() {
            true => infinitely_many,
            false => "?",
        };
        let within = match answer.reachable_within_limits {
            Some(true) => infinitely_many,
            _ => "?",
        };
        let count = |n: Option<u64>, word: &str| n.map_or_else(|| word.into(), |n| n.to_string());
        columns.row(vec![
            index.to_string(),
            word.into(),
            count(answer.postures, postures),
            count(answer.within_limits, within),
        ]);
    }
    columns.render(look)
}

/// The curves, a row each.
fn curve_rows(curves: &[BoundaryCurve], look: Look) -> String {
    let mut columns = Columns::new(&["circle from", ">center", ">radius", "bounds"]);
    for drawn in curves {
        let circle = drawn.curve.circle;
        let from = match &drawn.curve.cause {
            Cause::Singularity => "singularity".to_owned(),
            Cause::Limit(names) => format!("limit of {}", names.join(" and ")),
        };
        // Without the sign of a negative zero.
        let place = |x: f64| format!("{:.6}", (x * 1e6).round() / 1e6 + 0.0);
        columns.row(vec![
            from,
            format!("{}, {}", place(circle.center.re), place(circle.center.im)),
            place(circle.radius),
            match drawn.on_boundary {
                Some(true) => "yes",
                Some(false) => "no",
                None => "in doubt",
            }
            .into(),
        ]);
    }
    columns.render(look)
}

/// Points and the boundary, for programs.
pub fn json(view: &WorkspaceView<'_>, answers: &[ReachedPoint]) -> String {
    let point = |(index, answer): (usize, &ReachedPoint)| {
        json!({
            "index": index,
            "reachable": answer.is_reachable(view.within_limits),
            "postures": answer.postures,
            "within_limits": answer.within_limits,
            "reason": answer.doubts(true).next(),
        })
    };
    let points: Vec<Value> = answers.iter().enumerate().map(point).collect();
    let boundary = view.boundary;
    let curves = boundary.curves.as_ref().ok();
    let curves = curves.map(|curves| curves.iter().map(curve_json).collect::<Vec<_>>());
    let object = json!({
        "mechanism": mechanism_json(view.mechanism, view.content),
        "points": points,
        "boundary": curves,
        "boundary_reason": boundary.curves.as_ref().err(),
        "area": boundary.area.as_ref().ok(),
        "area_reason": boundary.area.as_ref().err(),
        "max_postures": boundary.max_postures.as_ref().ok(),
        "max_postures_reason": boundary.max_postures.as_ref().err(),
        "settled": view.is_settled,
    });
    format!("{object:#}\n")
}

fn curve_json(drawn: &BoundaryCurve) -> Value {
    let (circle, cause) = (drawn.curve.circle, &drawn.curve.cause);
    let (from, joints) = match cause {
        Cause::Singularity => ("singularity", None),
        Cause::Limit(names) => ("limit", Some(names.join(" and "))),
    };
    json!({
        "from": from,
        "of": joints,
        "degree": 2,
        "circle": {"center": [circle.center.re, circle.center.im], "radius": circle.radius},
        "on_boundary": drawn.on_boundary,
        "samples": drawn.samples,
    })
}
