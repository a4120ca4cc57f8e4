//! Blocks of an answer: JSON objects of its points, components, real curves and real surfaces, field by field as the
//! contract has them.

use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::{
    CertifiedComponent, CheckedComponent, Membership, Mobility, Multidegree, Projection,
    RealPoints, Samples,
};
use cognate_solutions::witness::real_curve::RealCurve;
use cognate_solutions::witness::real_surface::RealSurface;
use num_complex::Complex64;
use serde_json::{Value, json};

/// The blocks of one answer; an answer has a block only if its question asks for it.
#[derive(Default)]
pub(crate) struct AnswerBlocks {
    /// Answers, one object for each point.
    pub points: Option<Vec<Value>>,
    /// Answers, one object for each component.
    pub components: Option<Vec<Value>>,
    /// Real curves with vertices and arcs.
    pub curves: Option<Vec<Value>>,
    /// Triangles of real surfaces.
    pub surfaces: Option<Vec<Value>>,
    /// Groups of variables, by names.
    pub groups: Option<Vec<Vec<String>>>,
}

impl AnswerBlocks {
    /// The blocks of an answer of components.
    pub(crate) fn of(answer: &Answer) -> Self {
        match answer {
            Answer::Check(components) => Self::of_components(components, checked),
            Answer::Certify(components) => Self::of_components(components, certified),
            Answer::Member(points) => Self::of_points(points, membership),
            Answer::Sample(components) => {
                let points = components
                    .iter()
                    .flat_map(|c| c.points.iter().map(|p| point(p)));
                Self {
                    points: Some(points.collect()),
                    ..Self::of_components(components, samples)
                }
            }
            Answer::Project(components) => Self::of_components(components, projection),
            Answer::Multidegree { groups, components } => Self {
                groups: Some(groups.clone()),
                ..Self::of_components(components, multidegree)
            },
            // A decomposition has a summary of its own.
            Answer::Components(_) => Self::default(),
            Answer::RealPoints(components) => Self {
                points: Some(components.iter().flat_map(real_points).collect()),
                ..Self::of_components(components, real_point_counts)
            },
            Answer::RealSurface(surfaces) => Self {
                surfaces: Some(surfaces.iter().map(mesh).collect()),
                ..Self::of_components(surfaces, surface_counts)
            },
            Answer::RealCurve(curves) => Self {
                curves: Some(curves.iter().map(graph).collect()),
                ..Self::of_components(curves, curve_counts)
            },
            Answer::Mobility(points) => Self::of_points(points, mobility),
        }
    }

    fn of_components<T>(components: &[T], object: impl Fn(&T) -> Value) -> Self {
        Self {
            components: Some(components.iter().map(object).collect()),
            ..Self::default()
        }
    }

    fn of_points<T>(points: &[T], object: impl Fn(&T) -> Value) -> Self {
        Self {
            points: Some(points.iter().map(object).collect()),
            ..Self::default()
        }
    }
}

/// Coordinates of a point, each as its real and imaginary part.
fn point(coordinates: &[Complex64]) -> Value {
    let values: Vec<Value> = coordinates.iter().map(|z| json!([z.re, z.im])).collect();
    Value::Array(values)
}

fn checked(c: &CheckedComponent) -> Value {
    json!({ "id": c.id.to_string(), "closed": c.closed, "multiplicity": c.multiplicity })
}

fn certified(c: &CertifiedComponent) -> Value {
    json!({
        "id": c.id.to_string(), "points": c.points, "certified": c.certified,
        "distinct": c.distinct,
    })
}

fn membership(p: &Membership) -> Value {
    let on: Vec<String> = p.on.iter().map(ToString::to_string).collect();
    let dimensions: Vec<u32> = p.on.iter().map(|id| id.dimension).collect();
    let near = p.unsettled.iter();
    let unsettled: Vec<Value> = near
        .map(|n| json!({ "component": n.id.to_string(), "distance": n.distance }))
        .collect();
    json!({
        "index": p.index, "on": on, "dimensions": dimensions, "unsettled": unsettled,
        "solves": p.solves,
    })
}

fn samples(c: &Samples) -> Value {
    json!({
        "id": c.id.to_string(), "wanted": c.wanted, "count": c.points.len(), "failed": c.failed,
    })
}

fn projection(c: &Projection) -> Value {
    json!({
        "id": c.id.to_string(), "dimension": c.dimension, "degree": c.degree,
        "fiber_dimension": c.fiber_dimension, "fiber_degree": c.fiber_degree,
        "same_image": c.same_image.map(|id| id.to_string()), "rank_gap": c.rank_gap,
        "doubts": c.doubts,
    })
}

fn multidegree(c: &Multidegree) -> Value {
    let degrees = c.degrees.iter();
    let degrees: Vec<Value> = degrees
        .map(|d| json!({ "slices": d.slices, "degree": d.degree }))
        .collect();
    json!({ "id": c.id.to_string(), "multidegree": degrees, "doubts": c.doubts })
}

/// The real points of a component, each with the component's id.
fn real_points(c: &RealPoints) -> impl Iterator<Item = Value> + '_ {
    c.points.iter().map(|p| {
        json!({
            "component": c.id.to_string(), "point": point(&p.point), "regular": p.regular,
        })
    })
}

/// Counts of the real points of a component.
fn real_point_counts(c: &RealPoints) -> Value {
    let settled = c.doubts.is_empty();
    // That a component has no real points is said only where nothing is in doubt.
    let real = match (c.points.is_empty(), settled) {
        (false, _) => Some(true),
        (true, true) => Some(false),
        (true, false) => None,
    };
    json!({
        "id": c.id.to_string(), "points": c.points.len(), "has_real_points": real,
        "settled": settled, "doubts": c.doubts,
    })
}

fn mobility(p: &Mobility) -> Value {
    let on: Vec<String> = p.on.iter().map(ToString::to_string).collect();
    json!({
        "index": p.index, "infinitesimal": p.infinitesimal,
        "dimensions_by_order": p.dimensions_by_order,
        "local_dimension": p.local_dimension, "reason": p.reason, "on": on,
    })
}

/// Counts of loops, arcs and points in the real part of a component of dimension 1.
fn curve_counts(curve: &RealCurve) -> Value {
    let counts = curve.counts();
    json!({
        "id": curve.id.to_string(), "degree": curve.degree,
        "closed_loops": counts.closed_loops, "unbounded_arcs": counts.unbounded_arcs,
        "isolated_points": counts.isolated_points, "singular_points": counts.singular_points,
        "connected_components": counts.connected_components,
        "arcs_across_box": counts.arcs_across_box,
        "proved_slabs": curve.proved_slabs(), "slabs": curve.proved_slabs().map(|_| curve.proofs.len()),
        "vertices": curve.vertices.len(), "edges": curve.edges.len(),
        "settled": curve.doubts.is_empty(),
    })
}

/// Counts of parts in the real part of a component of dimension 2; numbers that are not known are `null`.
fn surface_counts(surface: &RealSurface) -> Value {
    let settled = surface.doubts.is_empty();
    let counts = surface.mesh.counts();
    let settled_count = |value: Value| if settled { value } else { Value::Null };
    json!({
        "id": surface.id.to_string(), "degree": surface.degree,
        "compact": settled_count(json!(surface.compact)), "euler": settled_count(json!(surface.euler)),
        "parts": settled_count(json!(counts.parts)), "curve_parts": settled_count(json!(counts.curve_parts)),
        "point_parts": settled_count(json!(counts.point_parts)), "crossing_edges": settled_count(json!(counts.crossing)),
        "levels": surface.levels.len(), "vertices": surface.mesh.vertices.len(),
        "triangles": surface.mesh.triangles.len(), "settled": settled,
    })
}

/// A real surface as it is drawn.
fn mesh(surface: &RealSurface) -> Value {
    let mesh = &surface.mesh;
    json!({
        "id": surface.id.to_string(), "compact": surface.compact, "vertices": mesh.vertices,
        "triangles": mesh.triangles, "segments": mesh.segments,
    })
}

/// A real curve as it is drawn.
fn graph(curve: &RealCurve) -> Value {
    let mut edges_of = vec![Vec::new(); curve.vertices.len()];
    for (k, edge) in curve.edges.iter().enumerate() {
        for end in edge.ends.into_iter().flatten() {
            edges_of[end].push(k);
        }
    }
    let vertices = curve.vertices.iter().zip(edges_of).map(|(v, edges)| {
        json!({ "kind": v.kind, "point": point(&v.point), "value": v.value, "edges": edges })
    });
    let edges = curve.edges.iter().map(|e| {
        let samples: Vec<Value> = e.samples.iter().map(|p| point(p)).collect();
        json!({ "ends": e.ends, "samples": samples })
    });
    let proofs = curve.proofs.iter().map(|p| {
        json!({
            "value": p.value, "different": p.different, "real": p.real, "not_real": p.not_real,
            "proved": p.is_complete(curve.degree),
        })
    });
    json!({
        "id": curve.id.to_string(), "form": curve.form,
        "vertices": vertices.collect::<Vec<_>>(), "edges": edges.collect::<Vec<_>>(),
        "slabs": proofs.collect::<Vec<_>>(),
    })
}
