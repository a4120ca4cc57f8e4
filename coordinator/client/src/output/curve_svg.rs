//! Real curves as a drawing (SVG): arcs, smooth and singular vertices, in two coordinates.

use super::axes::AxisOf;
use super::files::write_file;
use super::{curve_dxf, surface};
use crate::error::ClientError;
use cognate_solutions::witness::real_curve::{CurveEdge, VertexKind};
use cognate_summary::question_answer::{CurveBlock, SurfaceBlock};
use num_complex::Complex64;
use std::fmt::Write as _;
use std::path::Path;

/// Side of the drawing and its margin, in pixels.
const SIDE: f64 = 640.0;
const MARGIN: f64 = 40.0;
/// Colours that are told apart on white, also by the colour-blind (after Okabe and Ito).
const COLORS: [&str; 7] = [
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000",
];

/// Writes curve.svg and curve.dxf, and of curves in three variables and more curve.html.
pub fn write(folder: &Path, curves: &[CurveBlock], axes: &[AxisOf]) -> Result<(), ClientError> {
    write_file(
        folder,
        "curve.dxf",
        &curve_dxf::drawing(&lines(curves, axes)),
    )?;
    if let Some(spatial) = spatial(curves) {
        surface::page(folder, "curve.html", &spatial)?;
    }
    write_file(folder, "curve.svg", &drawing(curves, axes))
}

/// The points of each arc with its vertices, and names of the curves.
fn lines(curves: &[CurveBlock], axes: &[AxisOf]) -> Vec<(String, Vec<(f64, f64)>)> {
    let of_curve = |curve: &CurveBlock| {
        let name = curve.id.replace('.', "-");
        let arcs = curve.edges.iter();
        let arcs = arcs.map(|edge| (name.clone(), projected_arc(curve, edge, axes)));
        arcs.collect::<Vec<_>>()
    };
    curves.iter().flat_map(of_curve).collect()
}

/// The arcs in the first three variables, as pieces of a surface without triangles; `None` where there are fewer.
fn spatial(curves: &[CurveBlock]) -> Option<Vec<SurfaceBlock>> {
    let of_curve = |curve: &CurveBlock| {
        let (mut vertices, mut segments) = (Vec::new(), Vec::new());
        for edge in &curve.edges {
            let first = vertices.len() as u32;
            for point in arc(curve, edge) {
                let [x, y, z] = point.first_chunk()?;
                vertices.push([x.re, y.re, z.re]);
            }
            segments.extend((first + 1..vertices.len() as u32).map(|k| [k - 1, k]));
        }
        Some(SurfaceBlock {
            compact: Some(!is_unbounded(curve)),
            id: curve.id.clone(),
            segments,
            triangles: Vec::new(),
            vertices,
        })
    };
    curves.iter().map(of_curve).collect()
}

/// The points of an arc: from its lower vertex over its samples to its upper one.
fn arc<'a>(curve: &'a CurveBlock, edge: &'a CurveEdge) -> impl Iterator<Item = &'a Vec<Complex64>> {
    let [lower, upper] = edge.ends.map(|end| Some(&curve.vertices.get(end?)?.point));
    lower.into_iter().chain(&edge.samples).chain(upper)
}

/// The points of an arc as the drawing shows them.
fn projected_arc(curve: &CurveBlock, edge: &CurveEdge, axes: &[AxisOf]) -> Vec<(f64, f64)> {
    let points = arc(curve, edge);
    points.filter_map(|p| coordinates(p, axes)).collect()
}

fn coordinates(point: &[Complex64], axes: &[AxisOf]) -> Option<(f64, f64)> {
    let part = |axis: &AxisOf| {
        let z = point.get(axis.variable)?;
        Some(if axis.imaginary { z.im } else { z.re })
    };
    let (x, y) = (part(axes.first()?)?, part(axes.get(1)?)?);
    (x.is_finite() && y.is_finite()).then_some((x, y))
}

/// Left, right, low and high.
type Reach = [f64; 4];

/// The smallest rectangle that holds both.
fn around([a, b, c, d]: Reach, [e, f, g, h]: Reach) -> Reach {
    [a.min(e), b.max(f), c.min(g), d.max(h)]
}

/// The part of a curve that the drawing shows: all of a compact one; of one that goes to infinity, where its critical and
/// singular points are, with as much again on each side.
fn shown(curve: &CurveBlock, axes: &[AxisOf]) -> Option<Reach> {
    let reach = |points: &mut dyn Iterator<Item = &Vec<Complex64>>| {
        let places = points.filter_map(|p| coordinates(p, axes));
        places.map(|(x, y)| [x, x, y, y]).reduce(around)
    };
    let samples = curve.edges.iter().flat_map(|edge| &edge.samples);
    let whole = reach(&mut samples.chain(curve.vertices.iter().map(|v| &v.point)))?;
    let vertices = curve.vertices.iter();
    let special = vertices.filter(|v| v.kind != VertexKind::Regular);
    let special = reach(&mut special.map(|v| &v.point));
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
fn is_unbounded(curve: &CurveBlock) -> bool {
    let mut ends = curve.edges.iter().flat_map(|edge| edge.ends);
    ends.any(|end| end.is_none())
}

/// The drawing.
fn drawing(curves: &[CurveBlock], axes: &[AxisOf]) -> String {
    let reaches = curves.iter().filter_map(|curve| shown(curve, axes));
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
    for (k, curve) in curves.iter().enumerate() {
        let color = COLORS[k % COLORS.len()];
        for edge in &curve.edges {
            let points: Vec<String> = projected_arc(curve, edge, axes)
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
        for vertex in &curve.vertices {
            let singular = matches!(
                vertex.kind,
                VertexKind::Node | VertexKind::Acnode | VertexKind::Cusp
            );
            let Some((x, y)) = coordinates(&vertex.point, axes).map(place) else {
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

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_summary::question_answer::VertexBlock;

    #[test]
    fn arcs_go_from_vertex_to_vertex() {
        let point = |x: f64, y: f64| [x, y].map(Complex64::from).to_vec();
        let vertex = |kind: VertexKind, point: Vec<Complex64>| VertexBlock {
            edges: Vec::new(),
            kind,
            point,
            value: 0.0,
        };
        let edge = |ends, samples| CurveEdge { ends, samples };
        let curve = CurveBlock {
            edges: vec![
                edge([Some(0), Some(1)], vec![point(0.5, 0.25)]),
                edge([Some(1), None], Vec::new()),
            ],
            form: Vec::new(),
            id: "1.1".into(),
            slabs: Vec::new(),
            vertices: vec![
                vertex(VertexKind::Critical, point(0.0, 0.0)),
                vertex(VertexKind::Node, point(1.0, 1.0)),
            ],
        };
        let axis = |variable: usize, name: &str| AxisOf {
            variable,
            imaginary: false,
            name: name.into(),
        };
        let svg = drawing(&[curve], &[axis(0, "a<b"), axis(1, "y")]);
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(svg.contains("a&lt;b") && !svg.contains("NaN"));
        assert!(
            svg.contains("points=\"40.00,600.00 320.00,460.00 600.00,40.00\""),
            "{svg}"
        );
        assert!(drawing(&[], &[axis(0, "x"), axis(1, "y")]).contains("</svg>"));
    }
}
