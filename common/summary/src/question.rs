//! QuestionSummary: the answer of components in one JSON object, field by field as the contract has it.

use super::about::{About, TimeBlock, WorkerBlock};
use cognate_algorithms::answer::AnsweredQuestion;
use cognate_numeric::counted::counted;
use cognate_solutions::witness::real_curve::RealCurve;
use cognate_solutions::witness::real_surface::RealSurface;
use cognate_solutions::witness::{Answer, TrackedPaths};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A question that is answered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuestionSummary {
    /// Id of the job.
    pub job: String,
    /// What was asked: `member`, `sample`, `project`, `multidegree`, `mobility`, `real-curve`,
    /// `real-surface`, `real-points` or `certify`.
    pub question: String,
    /// The system and the seed.
    pub problem: AskedProblem,
    /// What is said of each point, where points were asked about, or the points that were wanted of one component.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points: Option<Vec<Value>>,
    /// What is said of each component.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub components: Option<Vec<Value>>,
    /// Real curves with their vertices and arcs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curves: Option<Vec<Value>>,
    /// Triangles of real surfaces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surfaces: Option<Vec<Value>>,
    /// Groups of variables, where degrees are by groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub groups: Option<Vec<Vec<String>>>,
    /// What is not clear, in words; empty where all is settled.
    pub unsettled: Vec<String>,
    /// True when nothing is in doubt.
    pub settled: bool,
    /// Paths that were tracked.
    pub paths: TrackedPaths,
    /// Wall time and CPU time.
    pub time: TimeBlock,
    /// Workers and the number of items that each did.
    pub workers: Vec<WorkerBlock>,
    /// What a person should know, one sentence each.
    pub warnings: Vec<String>,
}

/// What was asked about.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AskedProblem {
    /// Name of the problem, usually that of its file.
    pub name: String,
    /// Digest of the system.
    pub digest: String,
    /// Number of variables.
    pub variables: u64,
    /// Names of the unknowns, in the order of the coordinates of points; empty where an older program wrote the summary.
    #[serde(default)]
    pub unknowns: Vec<String>,
    /// Number of equations.
    pub equations: u64,
    /// Seed of everything random.
    pub seed: u64,
}

/// What an answer says of points, of components, and of which groups.
type Blocks = (
    Option<Vec<Value>>,
    Option<Vec<Value>>,
    Option<Vec<Vec<String>>>,
);

fn blocks(answer: &Answer) -> Blocks {
    match answer {
        Answer::Check(components) => {
            let each = components.iter().map(|c| {
                json!({ "id": c.id.to_string(), "closed": c.closed, "multiplicity": c.multiplicity })
            });
            (None, Some(each.collect()), None)
        }
        Answer::Certify(components) => {
            let each = components.iter().map(|c| {
                json!({
                    "id": c.id.to_string(), "points": c.points, "certified": c.certified,
                    "distinct": c.distinct,
                })
            });
            (None, Some(each.collect()), None)
        }
        Answer::Member(points) => {
            let each = points.iter().map(|p| {
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
            });
            (Some(each.collect()), None, None)
        }
        Answer::Sample(components) => {
            let point = |p: &Vec<Complex64>| {
                let values: Vec<Value> = p.iter().map(|z| json!([z.re, z.im])).collect();
                Value::Array(values)
            };
            let all = components.iter().flat_map(|c| c.points.iter().map(point));
            let each = components.iter().map(|c| {
                json!({
                    "id": c.id.to_string(), "wanted": c.wanted, "count": c.points.len(), "failed": c.failed,
                })
            });
            (Some(all.collect()), Some(each.collect()), None)
        }
        Answer::Project(components) => {
            let each = components.iter().map(|c| {
                json!({
                    "id": c.id.to_string(), "dimension": c.dimension, "degree": c.degree,
                    "fiber_dimension": c.fiber_dimension, "fiber_degree": c.fiber_degree,
                    "same_image": c.same_image.map(|id| id.to_string()), "rank_gap": c.rank_gap,
                    "doubts": c.doubts,
                })
            });
            (None, Some(each.collect()), None)
        }
        Answer::Multidegree { groups, components } => {
            let each = components.iter().map(|c| {
                let degrees = c.degrees.iter();
                let degrees: Vec<Value> = degrees
                    .map(|d| json!({ "slices": d.slices, "degree": d.degree }))
                    .collect();
                json!({ "id": c.id.to_string(), "multidegree": degrees, "doubts": c.doubts })
            });
            (None, Some(each.collect()), Some(groups.clone()))
        }
        // A decomposition has a summary of its own.
        Answer::Components(_) => (None, None, None),
        Answer::RealPoints(components) => {
            let each = components.iter();
            let points = each.clone().flat_map(|c| {
                c.points.iter().map(move |p| {
                    let values: Vec<Value> = p.point.iter().map(|z| json!([z.re, z.im])).collect();
                    json!({ "component": c.id.to_string(), "point": values, "regular": p.regular })
                })
            });
            let points = points.collect();
            let each = each.map(|c| {
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
            });
            (Some(points), Some(each.collect()), None)
        }
        Answer::RealSurface(surfaces) => {
            let each = surfaces.iter().map(surface_counts);
            (None, Some(each.collect()), None)
        }
        Answer::RealCurve(curves) => (None, Some(curves.iter().map(counts).collect()), None),
        Answer::Mobility(points) => {
            let each = points.iter().map(|p| {
                let on: Vec<String> = p.on.iter().map(ToString::to_string).collect();
                json!({
                    "index": p.index, "infinitesimal": p.infinitesimal,
                    "dimensions_by_order": p.dimensions_by_order,
                    "local_dimension": p.local_dimension, "reason": p.reason, "on": on,
                })
            });
            (Some(each.collect()), None, None)
        }
    }
}

/// What the real part of a component consists of.
fn counts(curve: &RealCurve) -> Value {
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

/// What the real part of a component of dimension 2 consists of; numbers that are not known are `null`.
fn surface_counts(surface: &RealSurface) -> Value {
    let settled = surface.doubts.is_empty();
    let counts = surface.mesh.counts();
    let known = |value: Value| if settled { value } else { Value::Null };
    json!({
        "id": surface.id.to_string(), "degree": surface.degree,
        "compact": known(json!(surface.compact)), "euler": known(json!(surface.euler)),
        "parts": known(json!(counts.parts)), "curve_parts": known(json!(counts.curve_parts)),
        "point_parts": known(json!(counts.point_parts)), "crossing_edges": known(json!(counts.crossing)),
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
    let point = |p: &Vec<Complex64>| -> Value {
        let values: Vec<Value> = p.iter().map(|z| json!([z.re, z.im])).collect();
        Value::Array(values)
    };
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
        let samples: Vec<Value> = e.samples.iter().map(point).collect();
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

impl QuestionSummary {
    /// The summary of a job that has answered this question.
    pub fn new(about: &About, asked: &AnsweredQuestion) -> Self {
        let answer = &asked.answer;
        let (points, components, groups) = blocks(answer);
        let curves = match answer {
            Answer::RealCurve(curves) => Some(curves.iter().map(graph).collect()),
            _ => None,
        };
        let surfaces = match answer {
            Answer::RealSurface(surfaces) => Some(surfaces.iter().map(mesh).collect()),
            _ => None,
        };
        let unsettled = asked.doubts.clone();
        Self {
            job: about.job.clone(),
            question: answer.name().into(),
            problem: AskedProblem {
                name: about.name.clone(),
                digest: about.digest.clone(),
                variables: about.variables,
                unknowns: asked.unknowns.clone(),
                equations: about.equations,
                seed: about.seed,
            },
            points,
            components,
            curves,
            surfaces,
            groups,
            settled: unsettled.is_empty(),
            unsettled,
            paths: asked.paths,
            time: about.time.clone(),
            workers: about.workers.clone(),
            warnings: about.warnings.clone(),
        }
    }

    /// What `explain` says of it.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "{}: {}, {} failed, {} tracked again",
            self.question,
            counted(self.paths.total, "path"),
            self.paths.failed,
            self.paths.retracked
        )];
        let unsettled = self.unsettled.iter();
        lines.extend(unsettled.map(|doubt| format!("not settled: {doubt}")));
        lines.extend(self.warnings.iter().map(|w| format!("warning: {w}")));
        lines
    }
}
