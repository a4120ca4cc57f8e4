//! Real curves as a drawing (SVG): arcs, smooth and singular vertices, in two coordinates.

use super::files::write_file;
use super::text::counted;
use super::{curve_dxf, surface};
use crate::error::ClientError;
use cognate_systems::system::System;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;

/// Side of the drawing and its margin, in pixels.
const SIDE: f64 = 640.0;
const MARGIN: f64 = 40.0;
/// Colours that are told apart on white, also by the colour-blind (after Okabe and Ito).
const COLORS: [&str; 7] = [
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000",
];

/// From coordinates to pixels.
type Placement<'a> = dyn Fn((f64, f64)) -> (f64, f64) + 'a;

/// A coordinate that is shown: of which variable, and whether its imaginary part.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisOf {
    variable: usize,
    imaginary: bool,
    name: String,
}

/// The two coordinates that are shown: of these variables, or of the first two. Of a variable that has another as its
/// conjugate both parts are shown.
pub fn axes(system: &System, names: &[String]) -> Result<Vec<AxisOf>, String> {
    let variables = &system.variables;
    let axis = |variable: usize, imaginary: bool| AxisOf {
        variable,
        imaginary,
        name: match imaginary {
            true => format!("Im {}", variables[variable]),
            false => variables[variable].clone(),
        },
    };
    let paired = |v: usize| {
        let mut pairs = system.conjugates.iter();
        pairs.any(|&(a, b)| a != b && (a == v || b == v))
    };
    let place = |name: &String| {
        let place = variables.iter().position(|v| v == name.trim());
        place.ok_or_else(|| format!("`{name}`; expected some of {}", variables.join(", ")))
    };
    let chosen = names.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    match chosen.as_slice() {
        [] if paired(0) => Ok(vec![axis(0, false), axis(0, true)]),
        [] => Ok(vec![
            axis(0, false),
            axis(1.min(variables.len() - 1), false),
        ]),
        [one, other] if paired(*one) && paired(*other) => {
            Ok(vec![axis(*one, false), axis(*one, true)])
        }
        [one] if paired(*one) => Ok(vec![axis(*one, false), axis(*one, true)]),
        [one, other] => Ok(vec![axis(*one, false), axis(*other, false)]),
        several => Err(format!(
            "{}; expected two",
            counted(several.len() as u64, "variable")
        )),
    }
}

/// Writes curve.svg and curve.dxf from the folder's curve.json, and of curves in three variables and more curve.html.
pub fn write(folder: &Path, axes: &[AxisOf]) -> Result<(), ClientError> {
    let path = folder.join("curve.json");
    let text = std::fs::read_to_string(&path).map_err(|source| ClientError::File {
        action: "cannot read",
        path: path.clone(),
        source,
    })?;
    let curves: Value = serde_json::from_str(&text)
        .map_err(|e| ClientError::GaveUp(format!("its curves are no JSON: {e}")))?;
    write_file(
        folder,
        "curve.dxf",
        &curve_dxf::drawing(&lines(&curves, axes)),
    )?;
    if let Some(spatial) = spatial(&curves) {
        surface::page(folder, "curve.html", &spatial)?;
    }
    write_file(folder, "curve.svg", &drawing(&curves, axes))
}

/// The points of each arc with its vertices, and names of the curves.
fn lines(curves: &Value, axes: &[AxisOf]) -> Vec<(String, Vec<(f64, f64)>)> {
    let of_curve = |curve: &Value| {
        let name = curve["id"].as_str().unwrap_or("curve").replace('.', "-");
        let edges = list(&curve["edges"]).iter();
        let arcs = edges.map(|edge| (name.clone(), whole_arc(curve, edge, axes)));
        arcs.collect::<Vec<_>>()
    };
    list(curves).iter().flat_map(of_curve).collect()
}

/// The arcs in the first three variables, as pieces of a surface without triangles; `None` where there are fewer.
fn spatial(curves: &Value) -> Option<Vec<Value>> {
    let mut spatial_curves = Vec::new();
    for curve in list(curves) {
        let (mut vertices, mut segments) = (Vec::new(), Vec::new());
        let point = |p: &Value| -> Option<[f64; 3]> {
            let part = |k: usize| p[k][0].as_f64();
            Some([part(0)?, part(1)?, part(2)?])
        };
        for edge in list(&curve["edges"]) {
            let end = |k: usize| {
                let vertex = edge["ends"][k].as_u64()?;
                Some(&curve["vertices"][vertex as usize]["point"])
            };
            let samples = list(&edge["samples"]).iter();
            let first = vertices.len();
            for p in end(0).into_iter().chain(samples).chain(end(1)) {
                vertices.push(point(p)?);
            }
            segments.extend((first + 1..vertices.len()).map(|k| [k - 1, k]));
        }
        spatial_curves.push(
            json!({"id": curve["id"], "compact": !is_unbounded(curve), "vertices": vertices, "triangles": [], "segments": segments}),
        );
    }
    Some(spatial_curves)
}

/// The points of an arc: from its lower vertex over its samples to its upper one.
fn whole_arc(curve: &Value, edge: &Value, axes: &[AxisOf]) -> Vec<(f64, f64)> {
    let end = |k: usize| {
        let vertex = edge["ends"][k].as_u64()?;
        coordinates(&curve["vertices"][vertex as usize]["point"], axes)
    };
    let samples = list(&edge["samples"]).iter();
    let samples = samples.filter_map(|p| coordinates(p, axes));
    end(0).into_iter().chain(samples).chain(end(1)).collect()
}

fn coordinates(point: &Value, axes: &[AxisOf]) -> Option<(f64, f64)> {
    let part = |axis: &AxisOf| point[axis.variable][usize::from(axis.imaginary)].as_f64();
    let (x, y) = (part(axes.first()?)?, part(axes.get(1)?)?);
    (x.is_finite() && y.is_finite()).then_some((x, y))
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Left, right, low and high.
type Reach = [f64; 4];

/// The smallest rectangle that holds both.
fn around([a, b, c, d]: Reach, [e, f, g, h]: Reach) -> Reach {
    [a.min(e), b.max(f), c.min(g), d.max(h)]
}

/// The part of a curve that the drawing shows: all of a compact one; of one that goes to infinity, where its critical and
/// singular points are, with as much again on each side.
fn shown(curve: &Value, axes: &[AxisOf]) -> Option<Reach> {
    let reach = |points: &mut dyn Iterator<Item = &Value>| {
        let places = points.filter_map(|p| coordinates(p, axes));
        places.map(|(x, y)| [x, x, y, y]).reduce(around)
    };
    let vertices = list(&curve["vertices"]);
    let samples = list(&curve["edges"]).iter();
    let samples = samples.flat_map(|e| list(&e["samples"]));
    let whole = reach(&mut samples.chain(vertices.iter().map(|v| &v["point"])))?;
    let special = vertices.iter().filter(|v| v["kind"] != "regular");
    let special = reach(&mut special.map(|v| &v["point"]));
    let Some([left, right, low, high]) = special.filter(|_| is_unbounded(curve)) else {
        return Some(whole);
    };
    let more = (right - left)
        .max(high - low)
        .max(1e-3 * (right.abs() + high.abs()) + 1e-9);
    Some([
        whole[0].max(left - more),
        whole[1].min(right + more),
        whole[2].max(low - more),
        whole[3].min(high + more),
    ])
}

/// Whether an arc has an end at infinity.
fn is_unbounded(curve: &Value) -> bool {
    let ends = list(&curve["edges"]).iter().flat_map(|e| list(&e["ends"]));
    ends.into_iter().any(Value::is_null)
}

/// The drawing.
pub fn drawing(curves: &Value, axes: &[AxisOf]) -> String {
    let reaches = list(curves).iter().filter_map(|curve| shown(curve, axes));
    let reach = reaches.reduce(around);
    let [left, right, low, high] = reach.unwrap_or([-1.0, 1.0, -1.0, 1.0]);
    // One scale for both axes: circles stay circles.
    let size = (right - left).max(high - low).max(1e-300);
    let scale = (SIDE - 2.0 * MARGIN) / size;
    let (middle_x, middle_y) = (0.5 * (left + right), 0.5 * (low + high));
    let place = |(x, y): (f64, f64)| {
        let across = SIDE / 2.0 + scale * (x - middle_x);
        (across, SIDE / 2.0 - scale * (y - middle_y))
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {SIDE} {SIDE}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{SIDE}\" height=\"{SIDE}\" fill=\"white\"/>\n"
    );
    for (k, curve) in list(curves).iter().enumerate() {
        let color = COLORS[k % COLORS.len()];
        for edge in list(&curve["edges"]) {
            draw_arc(&mut svg, curve, edge, axes, (&place, color));
        }
        for vertex in list(&curve["vertices"]) {
            let singular = matches!(vertex["kind"].as_str(), Some("node" | "acnode" | "cusp"));
            let Some((x, y)) = coordinates(&vertex["point"], axes).map(place) else {
                continue;
            };
            let (radius, fill) = if singular {
                (4.0, color)
            } else {
                (2.0, "white")
            };
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"{color}\"/>"
            );
        }
    }
    let names: Vec<String> = axes.iter().map(|a| escaped(&a.name)).collect();
    let _ = writeln!(
        svg,
        "<text x=\"8\" y=\"16\">{}: {left:.4} to {right:.4}, {low:.4} to {high:.4}</text>\n</svg>",
        names.join(", ")
    );
    svg
}

/// One arc: from its lower vertex over its samples to its upper one.
fn draw_arc(
    svg: &mut String,
    curve: &Value,
    edge: &Value,
    axes: &[AxisOf],
    (place, color): (&Placement<'_>, &str),
) {
    let points: Vec<String> = whole_arc(curve, edge, axes)
        .into_iter()
        .map(place)
        .map(|(x, y)| format!("{x:.2},{y:.2}"))
        .collect();
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>",
        points.join(" ")
    );
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_go_from_vertex_to_vertex() {
        let curves = json!([{
            "id": "1.1",
            "vertices": [
                {"kind": "critical", "point": [[0.0, 0.0], [0.0, 0.0]]},
                {"kind": "node", "point": [[1.0, 0.0], [1.0, 0.0]]}
            ],
            "edges": [{"ends": [0, 1], "samples": [[[0.5, 0.0], [0.25, 0.0]]]}, {"ends": [1, null], "samples": []}]
        }]);
        let axis = |variable: usize, name: &str| AxisOf {
            variable,
            imaginary: false,
            name: name.into(),
        };
        let svg = drawing(&curves, &[axis(0, "a<b"), axis(1, "y")]);
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(svg.contains("a&lt;b") && !svg.contains("NaN"));
        assert!(
            svg.contains("points=\"40.00,600.00 320.00,460.00 600.00,40.00\""),
            "{svg}"
        );
        assert!(drawing(&json!([]), &[axis(0, "x"), axis(1, "y")]).contains("</svg>"));
    }
}
