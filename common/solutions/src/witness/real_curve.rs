//! RealCurve: the real part of a component of dimension 1 as a graph: points where a real linear form is critical or
//! the curve singular, and between them arcs on which the form grows.

use super::witness_set::ComponentId;
use crate::disjoint_sets::DisjointSets;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Kind of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VertexKind {
    /// The form is critical there, and the curve is not singular.
    Critical,
    /// The curve is singular, and at least four half-branches meet.
    Node,
    /// The curve is singular, and no real branch passes.
    Acnode,
    /// The curve is singular, and one branch passes.
    Cusp,
    /// The curve is not singular; another component passes.
    Crossing,
    /// The curve leaves the box that was asked for.
    Window,
    /// A regular point at the value of another vertex.
    Regular,
}

/// A real point where arcs begin and end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveVertex {
    /// Kind of the vertex.
    pub kind: VertexKind,
    /// Values of the variables.
    pub point: Vec<Complex64>,
    /// Value of the form in the unknowns that are tracked.
    pub value: f64,
}

impl CurveVertex {
    /// Whether the curve is singular there.
    pub fn is_singular(&self) -> bool {
        matches!(
            self.kind,
            VertexKind::Node | VertexKind::Acnode | VertexKind::Cusp
        )
    }
}

/// An arc on which the form grows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveEdge {
    /// The vertices with the lower and the upper value, by place; `None` where it goes to infinity.
    pub ends: [Option<usize>; 2],
    /// Points of the arc, by growing value of the form.
    pub samples: Vec<Vec<Complex64>>,
}

/// Proofs for the points of a curve over one value of the form, inside a slab, as solutions of as many combinations of
/// the equations as are tracked. The slab has as many real branches as there are real points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProvedFibre {
    /// Value of the form in the unknowns that are tracked.
    pub value: f64,
    /// Points that are each alone in a box, and different from all others.
    pub different: u64,
    /// Points that are proved to be real.
    pub real: u64,
    /// Points that are proved not to be real.
    pub not_real: u64,
}

impl ProvedFibre {
    /// Whether `points` points are proved to be different, and each of them to be real or not real.
    pub fn is_complete(&self, points: u64) -> bool {
        self.different == points && self.real + self.not_real == points
    }
}

/// The real part of one component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealCurve {
    /// The component.
    pub id: ComponentId,
    /// Degree of the component.
    pub degree: u64,
    /// Coefficients of the form, real and imaginary part for each variable.
    pub form: Vec<[i32; 2]>,
    /// Points where arcs begin and end.
    pub vertices: Vec<CurveVertex>,
    /// The arcs, each from a vertex to a vertex.
    pub edges: Vec<CurveEdge>,
    /// Proofs for the points over each slab; empty where no proof was asked for.
    pub proofs: Vec<ProvedFibre>,
    /// Doubts about the curve, as shown to the user.
    pub doubts: Vec<String>,
}

/// Numbers of the connected parts and special points of the real part of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CurveCounts {
    /// Connected parts that are circles.
    pub closed_loops: u64,
    /// Connected parts that are lines.
    pub unbounded_arcs: u64,
    /// Connected parts that begin and end where the curve leaves the box that was asked for.
    pub arcs_across_box: u64,
    /// Points through which no real branch passes.
    pub isolated_points: u64,
    /// Real points where the curve is singular.
    pub singular_points: u64,
    /// All connected parts.
    pub connected_components: u64,
}

impl RealCurve {
    /// Number of arcs that end at each vertex; an arc that begins and ends there counts twice.
    pub fn degrees(&self) -> Vec<u64> {
        let mut degrees = vec![0; self.vertices.len()];
        for end in self.edges.iter().flat_map(|edge| edge.ends).flatten() {
            degrees[end] += 1;
        }
        degrees
    }

    /// Loops, arcs, isolated and singular points, connected parts.
    pub fn counts(&self) -> CurveCounts {
        let degrees = self.degrees();
        let mut counts = CurveCounts {
            singular_points: self.vertices.iter().filter(|v| v.is_singular()).count() as u64,
            ..CurveCounts::default()
        };
        // Vertices first, then edges.
        let vertices = self.vertices.len();
        let mut parts = DisjointSets::new(vertices + self.edges.len());
        for (e, edge) in self.edges.iter().enumerate() {
            for end in edge.ends.into_iter().flatten() {
                parts.join(vertices + e, end);
            }
        }
        for members in parts.clusters() {
            counts.connected_components += 1;
            let (points, arcs): (Vec<usize>, Vec<usize>) =
                members.into_iter().partition(|&k| k < vertices);
            let open: usize = arcs
                .iter()
                .flat_map(|&k| self.edges[k - vertices].ends)
                .filter(Option::is_none)
                .count();
            let (leaving, inner): (Vec<usize>, Vec<usize>) = points
                .into_iter()
                .partition(|&v| self.vertices[v].kind == VertexKind::Window);
            let plain = inner.iter().all(|&v| degrees[v] == 2);
            match (arcs.is_empty(), plain, open, leaving.len()) {
                (true, ..) => counts.isolated_points += 1,
                (false, true, 0, 0) => counts.closed_loops += 1,
                (false, true, 2, 0) => counts.unbounded_arcs += 1,
                (false, true, 0, 2) => counts.arcs_across_box += 1,
                _ => {}
            }
        }
        counts
    }

    /// Over how many slabs the number of real branches is proved; `None` where that was not asked.
    pub fn proved_slabs(&self) -> Option<usize> {
        let complete = self.proofs.iter().filter(|p| p.is_complete(self.degree));
        (!self.proofs.is_empty()).then(|| complete.count())
    }

    /// Adds a doubt for each vertex at which a branch is missing.
    pub fn check(&mut self) {
        let degrees = self.degrees();
        for (vertex, degree) in self.vertices.iter().zip(degrees) {
            let fits = match vertex.kind {
                VertexKind::Critical | VertexKind::Crossing | VertexKind::Regular => degree == 2,
                VertexKind::Cusp => degree == 2,
                VertexKind::Node => degree >= 4 && degree % 2 == 0,
                VertexKind::Acnode => degree == 0,
                VertexKind::Window => degree == 1,
            };
            if !fits {
                self.doubts.push(format!(
                    "{degree} half-branches meet at a {} point where the form is {:.6}: a branch is missing",
                    match vertex.is_singular() {
                        true => "singular",
                        false => "smooth",
                    },
                    vertex.value
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertex(kind: VertexKind) -> CurveVertex {
        CurveVertex {
            kind,
            point: Vec::new(),
            value: 0.0,
        }
    }

    fn curve(kinds: &[VertexKind], ends: &[[Option<usize>; 2]]) -> RealCurve {
        let edge = |ends: &[Option<usize>; 2]| CurveEdge {
            ends: *ends,
            samples: Vec::new(),
        };
        RealCurve {
            id: ComponentId {
                dimension: 1,
                number: 1,
            },
            degree: 4,
            form: Vec::new(),
            vertices: kinds.iter().map(|&kind| vertex(kind)).collect(),
            edges: ends.iter().map(edge).collect(),
            proofs: Vec::new(),
            doubts: Vec::new(),
        }
    }

    #[test]
    fn circles_lines_and_points_are_told_apart() {
        use VertexKind::{Acnode, Critical, Node};
        let circle = [[Some(0), Some(1)], [Some(0), Some(1)]];
        let mut loops = curve(&[Critical, Critical], &circle);
        loops.check();
        assert!(loops.doubts.is_empty());
        let counts = loops.counts();
        assert_eq!((counts.closed_loops, counts.connected_components), (1, 1));
        let line = curve(
            &[Critical, Critical, Acnode],
            &[[None, Some(0)], [Some(1), Some(0)], [Some(1), None]],
        );
        let counts = line.counts();
        assert_eq!((counts.unbounded_arcs, counts.isolated_points), (1, 1));
        assert_eq!(
            (counts.connected_components, counts.singular_points),
            (2, 1)
        );
        // Two loops that meet in a node are neither.
        let eight = curve(
            &[Critical, Node, Critical],
            &[
                [Some(0), Some(1)],
                [Some(0), Some(1)],
                [Some(1), Some(2)],
                [Some(1), Some(2)],
            ],
        );
        let counts = eight.counts();
        assert_eq!((counts.closed_loops, counts.connected_components), (0, 1));
    }

    #[test]
    fn what_leaves_a_box_is_neither_a_loop_nor_unbounded() {
        use VertexKind::{Critical, Window};
        let ends = [[Some(0), Some(1)], [Some(2), Some(1)]];
        let mut arc = curve(&[Window, Critical, Window], &ends);
        arc.check();
        assert!(arc.doubts.is_empty());
        let counts = arc.counts();
        assert_eq!(
            (counts.arcs_across_box, counts.connected_components),
            (1, 1)
        );
        assert_eq!((counts.closed_loops, counts.unbounded_arcs), (0, 0));
        let mut touching = curve(
            &[Window, Critical],
            &[[Some(0), Some(1)], [Some(0), Some(1)]],
        );
        touching.check();
        assert!(!touching.doubts.is_empty());
    }

    #[test]
    fn a_slab_with_a_point_that_is_not_proved_is_not_counted() {
        let mut broken = curve(&[], &[]);
        assert_eq!(broken.proved_slabs(), None);
        let whole = ProvedFibre {
            value: 0.0,
            different: 4,
            real: 2,
            not_real: 2,
        };
        let lost = ProvedFibre {
            different: 3,
            real: 1,
            ..whole.clone()
        };
        let unclear = ProvedFibre {
            not_real: 1,
            ..whole.clone()
        };
        broken.proofs = vec![whole, lost, unclear];
        assert_eq!(broken.proved_slabs(), Some(1));
    }

    #[test]
    fn a_branch_that_was_taken_away_is_found() {
        use VertexKind::{Critical, Node};
        let ends = [
            [Some(0), Some(1)],
            [Some(0), Some(1)],
            [Some(1), Some(2)],
            [Some(1), Some(2)],
        ];
        for lost in 0..ends.len() {
            let mut left = ends.to_vec();
            left.remove(lost);
            let mut broken = curve(&[Critical, Node, Critical], &left);
            broken.check();
            assert!(!broken.doubts.is_empty(), "edge {lost}");
        }
    }
}
