//! Real surfaces as files: JSON, OBJ and STL for other programs, a picture, and a page on which the surface can be turned.

use super::files::{create, write_file};
use super::text::real;
use crate::error::ClientError;
use cognate_summary::pictures::SCENE;
use cognate_summary::question_answer::SurfaceBlock;
use std::fmt::Write as _;
use std::path::Path;

/// Width and height of the picture.
const SIZE: f64 = 640.0;
/// The page; `DATA` stands for the surfaces, and `SCENE` for the script that draws.
const PAGE: &str = include_str!("surface.html");
/// The direction from which the picture is seen, and the upward direction in it: orthogonal vectors of length 1.
const VIEW: [[f64; 3]; 3] = [
    [-0.8, 0.6, 0.0],
    [-0.288, -0.384, 0.877_268],
    [0.526_361, 0.701_814, 0.48],
];

/// Distance at which the picture of a surface that goes to infinity ends, as a multiple of the median distance of its
/// vertices.
const CUT: f64 = 2.0;

/// Whether the corners of triangles and segments are among the vertices.
fn is_whole(surface: &SurfaceBlock) -> bool {
    let corners = surface.triangles.iter().flatten();
    let mut places = corners.chain(surface.segments.iter().flatten());
    places.all(|&place| (place as usize) < surface.vertices.len())
}

/// Writes all files.
pub fn write(folder: &Path, surfaces: &[SurfaceBlock]) -> Result<(), ClientError> {
    if !surfaces.iter().all(is_whole) {
        let message = "its triangles are not what was agreed";
        return Err(ClientError::GaveUp(message.into()));
    }
    write_file(folder, "surface.json", &format!("{}\n", text(surfaces)))?;
    let mut out = create(folder, "surface.obj")?;
    let mut first = 1;
    for surface in surfaces {
        out.write(&format!("o component {}\n", surface.id))?;
        for [x, y, z] in &surface.vertices {
            out.write(&format!("v {x} {y} {z}\n"))?;
        }
        for [a, b, c] in &surface.triangles {
            out.write(&format!("f {} {} {}\n", a + first, b + first, c + first))?;
        }
        for [a, b] in &surface.segments {
            out.write(&format!("l {} {}\n", a + first, b + first))?;
        }
        first += surface.vertices.len() as u32;
    }
    out.finish()?;
    let mut out = create(folder, "surface.stl")?;
    out.write("solid surface\n")?;
    for surface in surfaces {
        for triangle in &surface.triangles {
            let [a, b, c] = triangle.map(|k| surface.vertices[k as usize]);
            let [x, y, z] = normal(a, b, c);
            out.write(&format!("facet normal {x} {y} {z}\n  outer loop\n"))?;
            for [x, y, z] in [a, b, c] {
                out.write(&format!("    vertex {x} {y} {z}\n"))?;
            }
            out.write("  endloop\nendfacet\n")?;
        }
    }
    out.write("endsolid surface\n")?;
    out.finish()?;
    write_file(folder, "surface.svg", &picture(surfaces))?;
    page(folder, "surface.html", surfaces)
}

/// A page on which surfaces, and curves as pieces of lines, can be turned by hand.
pub fn page(folder: &Path, name: &str, surfaces: &[SurfaceBlock]) -> Result<(), ClientError> {
    // Nothing in it can end the script.
    let data = text(surfaces).replace('<', "\\u003c");
    write_file(
        folder,
        name,
        &PAGE.replace("SCENE", SCENE).replace("DATA", &data),
    )
}

/// The surfaces as JSON.
fn text(surfaces: &[SurfaceBlock]) -> String {
    serde_json::to_string(surfaces).expect("names and numbers are JSON")
}

/// The unit vector on a triangle; 0 where it has none.
fn normal(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
    let (p, q) = (
        [0, 1, 2].map(|k| b[k] - a[k]),
        [0, 1, 2].map(|k| c[k] - a[k]),
    );
    let n = [0, 1, 2].map(|k| p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3]);
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    match length > 0.0 {
        true => n.map(|x| x / length),
        false => [0.0; 3],
    }
}

/// The part of surfaces that pictures show, where one goes to infinity: a middle, and the greatest distance from it.
fn ball(surfaces: &[SurfaceBlock]) -> Option<([f64; 3], f64)> {
    let unbounded = surfaces.iter().filter(|s| s.compact == Some(false));
    let points: Vec<&[f64; 3]> = unbounded.flat_map(|surface| &surface.vertices).collect();
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let coordinate = |k: usize| median(points.iter().map(|p| p[k]).collect());
    let middle = [coordinate(0)?, coordinate(1)?, coordinate(2)?];
    let distances = points.iter().map(|p| distance(p, &middle)).collect();
    Some((middle, CUT * median(distances)?))
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y));
    squares.sum::<f64>().sqrt()
}

/// The part of a triangle or a line that is within a ball.
fn within(corners: &[[f64; 3]], ball: Option<([f64; 3], f64)>) -> Vec<[f64; 3]> {
    let Some((middle, most)) = ball else {
        return corners.to_vec();
    };
    let mut part = Vec::with_capacity(corners.len() + 1);
    let next = corners.iter().cycle().skip(1);
    for (a, b) in corners.iter().zip(next) {
        let [from, to] = [a, b].map(|p| distance(p, &middle) - most);
        if from <= 0.0 {
            part.push(*a);
        }
        if (from <= 0.0) != (to <= 0.0) {
            part.push([0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * from / (from - to)));
        }
    }
    part
}

/// The triangles from far to near, each as bright as it faces the light.
fn picture(surfaces: &[SurfaceBlock]) -> String {
    let seen = |p: &[f64; 3]| VIEW.map(|row| row.iter().zip(p).map(|(a, b)| a * b).sum::<f64>());
    let ball = ball(surfaces);
    let part = |surface: &SurfaceBlock, places: &[u32]| -> Vec<[f64; 3]> {
        let corners = places.iter().map(|&k| surface.vertices[k as usize]);
        let corners: Vec<[f64; 3]> = corners.collect();
        within(&corners, ball).iter().map(seen).collect()
    };
    let points = surfaces.iter().flat_map(|surface| {
        let triangles = surface.triangles.iter().flat_map(|t| part(surface, t));
        triangles.chain(surface.segments.iter().flat_map(|s| part(surface, s)))
    });
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in points {
        for ((low, high), x) in low.iter_mut().zip(&mut high).zip(point) {
            (*low, *high) = (low.min(x), high.max(x));
        }
    }
    let range = (high[0] - low[0])
        .max(high[1] - low[1])
        .max(f64::MIN_POSITIVE);
    let scale = 0.9 * SIZE / range;
    let at = |p: [f64; 3]| {
        let x = SIZE / 2.0 + (p[0] - (low[0] + high[0]) / 2.0) * scale;
        let y = SIZE / 2.0 - (p[1] - (low[1] + high[1]) / 2.0) * scale;
        format!("{x:.1},{y:.1}")
    };
    let mut parts: Vec<(f64, String)> = Vec::new();
    for surface in surfaces {
        for triangle in &surface.triangles {
            let corners = part(surface, triangle);
            if corners.len() < 3 {
                continue;
            }
            let depth = corners.iter().map(|p| p[2]).sum::<f64>() / corners.len() as f64;
            let n = normal(corners[0], corners[1], corners[2]);
            // The light comes from the viewer, a little from above and from the left.
            let light = (-0.3 * n[0] + 0.5 * n[1] + 0.8 * n[2]).abs().min(1.0);
            let front = n[2] * (-0.3 * n[0] + 0.5 * n[1] + 0.8 * n[2]) >= 0.0;
            let shade = 60.0 + 180.0 * if front { light } else { 0.7 * light };
            let [r, g, b] = [0.55, 0.75, 1.0].map(|part| (shade * part) as u8);
            let color = format!("#{r:02x}{g:02x}{b:02x}");
            let corners = corners.into_iter().map(at).collect::<Vec<_>>().join(" ");
            parts.push((depth, format!(
                "<polygon points=\"{corners}\" fill=\"{color}\" stroke=\"{color}\" stroke-width=\"0.4\"/>\n"
            )));
        }
        for segment in &surface.segments {
            let ends = part(surface, segment);
            let Some(first) = ends.first() else { continue };
            let depth = first[2] + 0.01 * range;
            let ends = ends.into_iter().map(at).collect::<Vec<_>>().join(" ");
            parts.push((depth, format!(
                "<polyline points=\"{ends}\" fill=\"none\" stroke=\"#b02020\" stroke-width=\"1.5\"/>\n"
            )));
        }
    }
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut text = String::new();
    let _ = writeln!(
        text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {SIZE} {SIZE}\" width=\"{SIZE}\" height=\"{SIZE}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>"
    );
    for (_, part) in parts {
        text.push_str(&part);
    }
    if let Some((middle, most)) = ball {
        let [x, y, z] = middle.map(|x| real(x, 3));
        let _ = writeln!(
            text,
            "<text x=\"8\" y=\"18\" font-family=\"sans-serif\" font-size=\"12\">cut at distance {} from ({x}, {y}, {z})</text>",
            real(most, 3)
        );
    }
    text.push_str("</svg>\n");
    text
}
