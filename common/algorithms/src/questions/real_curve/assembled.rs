//! The graph of a real curve, put together from what paths between fibres found.

use super::super::context::Context;
use super::super::real_box::RealBox;
use super::clip::clip;
use super::traced::{End, FibrePoint, Task, Tracing, distance, value};
use crate::decomposition::operand::Operand;
use cognate_continuation::bend::{SlicedEquations, exactly};
use cognate_solutions::witness::real_curve::{CurveEdge, CurveVertex, RealCurve, VertexKind};
use num_complex::Complex64;

/// An end of a path this near a critical point, relative to its size, is that point.
const AT_CRITICAL: f64 = 1e-3;
/// Regular ends nearer than this are one point.
const SAME: f64 = 1e-7;
/// The Jacobian of all equations has a smaller rank at a point than on the curve if a singular value is below this part
/// of the largest.
const SINGULAR: f64 = 1e-4;
/// The Jacobian of all equations has the same rank at a point as on the curve if the singular value is above this part
/// of the largest.
const SMOOTH: f64 = 1e-3;

/// Vertices and arcs so far.
struct Assembly<'a> {
    now: &'a Tracing,
    vertices: Vec<CurveVertex>,
    /// Complex paths from below and from above that came to each vertex.
    arrived: Vec<[u64; 2]>,
    /// The arc of each real point of each slab.
    arcs: Vec<Vec<Option<usize>>>,
    edges: Vec<CurveEdge>,
    doubts: Vec<String>,
}

/// The graph. What is in doubt already has no graph.
pub(super) fn assemble(
    context: &Context<'_>,
    operand: &Operand,
    tracing: &Tracing,
    within: Option<RealBox<'_>>,
) -> RealCurve {
    let mut curve = RealCurve {
        id: operand.id,
        degree: operand.degree() as u64,
        form: tracing.form.clone(),
        vertices: Vec::new(),
        edges: Vec::new(),
        proofs: tracing.proofs.clone(),
        doubts: tracing.doubts.clone(),
    };
    if !curve.doubts.is_empty() {
        return curve;
    }
    let mut assembly = Assembly::new(tracing);
    for (task, ends) in tracing.tasks.iter().zip(&tracing.ends) {
        match task.level {
            Some(level) => assembly.arrive(task.slab, level, ends),
            None => assembly.sample(task, ends),
        }
    }
    match tracing.apart {
        true => assembly.alone(),
        false => assembly.kinds(context),
    }
    let wanted = assembly.wanted();
    let Assembly {
        mut vertices,
        mut edges,
        mut doubts,
        ..
    } = assembly;
    for edge in &mut edges {
        let key = |p: &Vec<Complex64>| value(&tracing.form, p);
        edge.samples.sort_by(|a, b| key(a).total_cmp(&key(b)));
        for point in &mut edge.samples {
            *point = context.problem.to_variables(point);
        }
    }
    for vertex in &mut vertices {
        vertex.point = context.problem.to_variables(&vertex.point);
    }
    (curve.vertices, curve.edges) = (vertices, edges);
    doubts.extend(tracing.unproved.iter().cloned());
    curve.doubts = doubts;
    if let Some(within) = within {
        clip(&mut curve, &wanted, &within);
    }
    curve
}

impl<'a> Assembly<'a> {
    fn new(tracing: &'a Tracing) -> Self {
        let vertices: Vec<CurveVertex> = tracing
            .critical
            .iter()
            .map(|critical| (VertexKind::Critical, critical))
            .chain(
                tracing
                    .window
                    .iter()
                    .map(|point| (VertexKind::Window, point)),
            )
            .map(|(kind, at)| CurveVertex {
                kind,
                point: at.point.clone(),
                value: at.value,
            })
            .collect();
        let mut edges = Vec::new();
        let arcs = tracing
            .fibres
            .iter()
            .map(|fibre| {
                let arc = |p: &FibrePoint| {
                    p.real.then(|| {
                        edges.push(CurveEdge {
                            ends: [None, None],
                            samples: vec![p.point.clone()],
                        });
                        edges.len() - 1
                    })
                };
                fibre.iter().map(arc).collect()
            })
            .collect();
        Self {
            now: tracing,
            arrived: vec![[0, 0]; vertices.len()],
            vertices,
            arcs,
            edges,
            doubts: Vec::new(),
        }
    }

    /// All points of a slab came to the level at one of its ends.
    fn arrive(&mut self, slab: usize, level: usize, ends: &[Option<End>]) {
        let at = self.now.levels[level];
        // The level is above the slab, or below it.
        let side = usize::from(level == slab);
        for (k, end) in ends.iter().enumerate() {
            let arc = self.arcs[slab][k];
            let Some(End::At { point, regular }) = end else {
                self.doubts
                    .push(format!("a path to the fibre at {at:.6} was lost"));
                continue;
            };
            let vertex = self.vertex(at, point, *regular, arc.is_some());
            if let Some(vertex) = vertex {
                self.arrived[vertex][1 - side] += 1;
            }
            match (arc, vertex) {
                (Some(arc), Some(vertex)) => self.edges[arc].ends[side] = Some(vertex),
                (Some(_), None) => {
                    let doubt = format!("a real path to the fibre at {at:.6} ends nowhere");
                    self.doubts.push(doubt);
                }
                (None, Some(vertex)) if self.vertices[vertex].kind == VertexKind::Regular => {
                    let doubt =
                        format!("a path at {at:.6} came from complex points to a regular real one");
                    self.doubts.push(doubt);
                }
                (None, _) => {}
            }
        }
    }

    /// The vertex of a level at a point; regular points make new ones where a real path came.
    fn vertex(&mut self, at: f64, point: &[Complex64], regular: bool, real: bool) -> Option<usize> {
        let levels = &self.now.levels;
        let gap = levels
            .iter()
            .map(|level| (level - at).abs())
            .filter(|gap| *gap > 0.0)
            .fold(f64::INFINITY, f64::min);
        let mut nearest: Option<(f64, usize)> = None;
        for (k, vertex) in self.vertices.iter().enumerate() {
            if (vertex.value - at).abs() > 0.25 * gap {
                continue;
            }
            let apart = distance(&vertex.point, point);
            if nearest.is_none_or(|(least, _)| apart < least) {
                nearest = Some((apart, k));
            }
        }
        if let Some((apart, k)) = nearest {
            let smooth = [VertexKind::Regular, VertexKind::Window];
            let critical = !smooth.contains(&self.vertices[k].kind);
            if apart <= SAME
                || (critical && apart <= AT_CRITICAL && (!regular || apart < 0.01 * AT_CRITICAL))
            {
                return Some(k);
            }
            if critical && apart <= AT_CRITICAL {
                let doubt =
                    format!("an end at {at:.6} is very near a critical point, and not on it");
                self.doubts.push(doubt);
                return None;
            }
        }
        if !regular || !real {
            return None;
        }
        self.vertices.push(CurveVertex {
            kind: VertexKind::Regular,
            point: point.to_vec(),
            value: at,
        });
        self.arrived.push([0, 0]);
        Some(self.vertices.len() - 1)
    }

    /// Real points of a slab came to a value inside it.
    fn sample(&mut self, task: &Task, ends: &[Option<End>]) {
        let at = task.to;
        let fibre = self.arcs[task.slab].iter().zip(&self.now.fibres[task.slab]);
        let arcs = fibre.filter_map(|(arc, point)| arc.filter(|_| point.wanted));
        for (arc, end) in arcs.zip(ends) {
            match end {
                Some(End::At {
                    point,
                    regular: true,
                }) => self.edges[arc].samples.push(point.clone()),
                _ if task.needed => self.doubts.push(format!("a sample at {at:.6} was lost")),
                _ => {}
            }
        }
    }

    /// The arcs that are wanted.
    fn wanted(&self) -> Vec<bool> {
        let points = self.now.fibres.iter().flatten();
        points.filter(|p| p.real).map(|p| p.wanted).collect()
    }

    /// The real points of a curve that is not its own conjugate: its conjugate passes there, too.
    fn alone(&mut self) {
        for vertex in &mut self.vertices {
            vertex.kind = VertexKind::Acnode;
        }
    }

    /// Finds the kinds of the critical vertices.
    fn kinds(&mut self, context: &Context<'_>) {
        let equations = SlicedEquations::new(&context.problem.given, Vec::new());
        let rank = context.problem.variables() - 1;
        let mut half_branches = vec![0; self.vertices.len()];
        for end in self.edges.iter().flat_map(|edge| edge.ends).flatten() {
            half_branches[end] += 1;
        }
        for (k, critical) in self.now.critical.iter().enumerate() {
            let [below, above] = self.arrived[k];
            if below != above {
                self.doubts.push(format!(
                    "{below} paths from below and {above} from above came to the critical point at {:.6}",
                    critical.value
                ));
            }
            if critical.regular {
                continue;
            }
            let point: Vec<_> = critical.point.iter().map(|&z| exactly(z)).collect();
            let values = equations.singular_values(&point);
            let least = values.get(rank - 1).copied().unwrap_or(0.0);
            // Rows are scaled to at most 1, and equations to about 1 at points of size 1.
            let part = least / values.first().copied().unwrap_or(1.0).max(1.0);
            self.vertices[k].kind = match () {
                () if part > SMOOTH => match half_branches[k] {
                    // Combinations of the equations made it critical.
                    2 => VertexKind::Crossing,
                    _ => VertexKind::Critical,
                },
                () if part > SINGULAR => {
                    let value = critical.value;
                    let doubt = format!("whether the curve is singular at {value:.6} is not clear");
                    self.doubts.push(doubt);
                    continue;
                }
                () if below == 1 => VertexKind::Crossing,
                () => match half_branches[k] {
                    0 => VertexKind::Acnode,
                    2 => VertexKind::Cusp,
                    _ => VertexKind::Node,
                },
            };
        }
    }
}
