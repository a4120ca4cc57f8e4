//! Topology: connected parts and Betti numbers of the real part of a curve or a surface, singular points included.
//!
//! A set of open cells has the homology of the complex of its incidences: an arc that goes to infinity shrinks to its
//! other end. The mesh of an unbounded surface is cut off at a window; whether the part inside has the homology of the whole
//! is checked by the Euler characteristic with compact support, which the cells of the whole surface give, too.

use super::real_curve::{RealCurve, VertexKind};
use super::real_surface::{Mesh, RealSurface};
use crate::disjoint_sets::DisjointSets;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Distance, in parts of 1 and the largest coordinate, up to which vertices of two curves are one point.
const SAME: f64 = 1e-7;
/// Vertices that are farther apart than [`SAME`] and nearer than this are in doubt.
const DIFFERENT: f64 = 1e-4;

/// The triangles of each edge of a mesh, by place.
type TrianglesOfEdges = BTreeMap<[u32; 2], Vec<usize>>;

/// Connected parts and Betti numbers of a real affine set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Topology {
    /// Number of connected parts.
    pub connected_parts: u64,
    /// Alternating sum of the Betti numbers.
    pub euler_characteristic: i64,
    /// Ranks of the homology groups with coefficients modulo 2, from dimension 0 to that of the set.
    pub betti: Vec<u64>,
}

impl Topology {
    /// Topology of the union of real curves. Curves that meet have a vertex there, each of its own.
    ///
    /// # Errors
    /// In words, where the curves do not tell.
    pub fn of_curves(curves: &[&RealCurve]) -> Result<Self, String> {
        if curves.iter().any(|curve| !curve.doubts.is_empty()) {
            return Err("something is in doubt".into());
        }
        let vertices = || curves.iter().flat_map(|curve| &curve.vertices);
        if vertices().any(|vertex| vertex.kind == VertexKind::Window) {
            return Err("a curve is cut off at the box".into());
        }
        let points: Vec<&[Complex64]> = vertices().map(|vertex| &*vertex.point).collect();
        let arcs: usize = curves.iter().map(|curve| curve.edges.len()).sum();
        let mut parts = DisjointSets::new(points.len() + arcs);
        let mut same = DisjointSets::new(points.len());
        let (mut first_vertex, mut arc) = (0, points.len());
        let mut incidences = 0;
        for curve in curves {
            let beyond = first_vertex + curve.vertices.len();
            // Vertices of one curve are different points.
            for vertex in first_vertex..beyond {
                for other in beyond..points.len() {
                    match distance(points[vertex], points[other]) {
                        d if d <= SAME => {
                            same.join(vertex, other);
                            parts.join(vertex, other);
                        }
                        d if d < DIFFERENT => {
                            return Err("points of two curves are near each other".into());
                        }
                        _ => {}
                    }
                }
            }
            for edge in &curve.edges {
                for end in edge.ends.into_iter().flatten() {
                    parts.join(first_vertex + end, arc);
                    incidences += 1;
                }
                arc += 1;
            }
            first_vertex = beyond;
        }
        let connected_parts = parts.clusters().len() as u64;
        let euler = (same.clusters().len() + arcs) as i64 - incidences;
        Self::of_numbers(connected_parts, euler, &[])
    }

    /// Topology of the real part of a surface.
    ///
    /// # Errors
    /// In words, where the mesh does not tell.
    pub fn of_surface(surface: &RealSurface) -> Result<Self, String> {
        if !surface.doubts.is_empty() {
            return Err("something is in doubt".into());
        }
        let counts = surface.mesh.counts();
        let edges = surface.mesh.triangles_of_edges();
        let at_window = euler_at_window(&surface.mesh, &edges);
        let is_whole = !surface.compact || counts.border == 0;
        if !is_whole || counts.euler - at_window != surface.euler {
            return Err("the mesh has another Euler characteristic than the cells".into());
        }
        let closed_sheets = closed_sheets(surface.mesh.triangles.len(), &edges);
        Self::of_numbers(counts.parts, counts.euler, &[closed_sheets])
    }

    /// Topology by the number of parts, the Euler characteristic and the Betti numbers above dimension 1.
    fn of_numbers(connected_parts: u64, euler: i64, above: &[u64]) -> Result<Self, String> {
        let even: u64 = connected_parts + above.first().unwrap_or(&0);
        let cycles = u64::try_from(even as i64 - euler);
        let cycles = cycles.map_err(|_| "its cells contradict each other".to_string())?;
        Ok(Self {
            connected_parts,
            euler_characteristic: euler,
            betti: [&[connected_parts, cycles], above].concat(),
        })
    }
}

/// Largest difference of coordinates, in parts of 1 and the largest coordinate.
fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let difference = a.iter().zip(b).map(|(x, y)| (x - y).l1_norm());
    let size = a.iter().map(Complex64::l1_norm).fold(1.0, f64::max);
    difference.fold(0.0, f64::max) / size
}

/// Euler characteristic of the graph in which a mesh ends at its window: edges with one triangle, and ends of curves.
fn euler_at_window(mesh: &Mesh, edges: &TrianglesOfEdges) -> i64 {
    let border = edges.iter().filter(|(_, triangles)| triangles.len() == 1);
    let border: Vec<[u32; 2]> = border.map(|(edge, _)| *edge).collect();
    let mut vertices: BTreeSet<u32> = border.iter().flatten().copied().collect();
    let mut segments: BTreeMap<u32, u32> = BTreeMap::new();
    for &end in mesh.segments.iter().flatten() {
        *segments.entry(end).or_default() += 1;
    }
    let on_triangle: BTreeSet<u32> = mesh.triangles.iter().flatten().copied().collect();
    let ends = segments.into_iter().filter(|(_, count)| *count == 1);
    vertices.extend(
        ends.map(|(end, _)| end)
            .filter(|end| !on_triangle.contains(end)),
    );
    vertices.len() as i64 - border.len() as i64
}

/// Rank of the second homology group modulo 2: the sets of triangles with an even number at each edge. Triangles that only two
/// share an edge are in such a set together or not at all.
fn closed_sheets(triangles: usize, edges: &TrianglesOfEdges) -> u64 {
    let mut sheets = DisjointSets::new(triangles);
    for triangles in edges.values() {
        if let [a, b] = triangles[..] {
            sheets.join(a, b);
        }
    }
    // Each equation is the set of the sheets whose sum is 0.
    let mut equations: BTreeSet<BTreeSet<usize>> = BTreeSet::new();
    for triangles in edges.values().filter(|triangles| triangles.len() != 2) {
        let mut equation = BTreeSet::new();
        for &triangle in triangles {
            toggle(&mut equation, sheets.root(triangle));
        }
        equations.insert(equation);
    }
    let mut rank = 0;
    let mut solved: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for mut equation in equations {
        while let Some(&first) = equation.first() {
            let Some(earlier) = solved.get(&first) else {
                solved.insert(first, equation);
                rank += 1;
                break;
            };
            for &sheet in earlier {
                toggle(&mut equation, sheet);
            }
        }
    }
    sheets.clusters().len() as u64 - rank
}

fn toggle(sum: &mut BTreeSet<usize>, sheet: usize) {
    if !sum.remove(&sheet) {
        sum.insert(sheet);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::witness::ComponentId;
    use crate::witness::real_curve::{CurveEdge, CurveVertex};

    const ID: ComponentId = ComponentId {
        dimension: 1,
        number: 1,
    };

    /// A curve with vertices at these places of a line, and arcs between them or to infinity.
    fn curve(places: &[f64], arcs: &[[Option<usize>; 2]]) -> RealCurve {
        let vertex = |place: &f64| CurveVertex {
            kind: VertexKind::Critical,
            point: vec![Complex64::from(*place)],
            value: *place,
        };
        let edge = |ends: &[Option<usize>; 2]| CurveEdge {
            ends: *ends,
            samples: Vec::new(),
        };
        RealCurve {
            id: ID,
            degree: 2,
            form: Vec::new(),
            vertices: places.iter().map(vertex).collect(),
            edges: arcs.iter().map(edge).collect(),
            proofs: Vec::new(),
            doubts: Vec::new(),
        }
    }

    fn betti(topology: Result<Topology, String>) -> Vec<u64> {
        topology.expect("it is known").betti
    }

    #[test]
    fn curves_have_the_homology_of_their_graphs() {
        let circle = curve(&[0.0, 2.0], &[[Some(0), Some(1)], [Some(0), Some(1)]]);
        assert_eq!(betti(Topology::of_curves(&[&circle])), [1, 1]);
        let line = curve(&[], &[[None, None]]);
        assert_eq!(betti(Topology::of_curves(&[&line])), [1, 0]);
        // The nodal cubic: a loop at the node, and two arcs to infinity.
        let node = curve(
            &[0.0, 1.0],
            &[
                [Some(0), Some(1)],
                [Some(0), Some(1)],
                [None, Some(0)],
                [None, Some(0)],
            ],
        );
        assert_eq!(betti(Topology::of_curves(&[&node])), [1, 1]);
        let point = curve(&[5.0], &[]);
        assert_eq!(betti(Topology::of_curves(&[&point])), [1, 0]);
        // Two circles that touch at 2, and a line apart from them.
        let other = curve(&[2.0, 3.0], &[[Some(0), Some(1)], [Some(0), Some(1)]]);
        let union = Topology::of_curves(&[&circle, &other, &line]).expect("it is known");
        assert_eq!((union.connected_parts, union.euler_characteristic), (2, 0));
        assert_eq!(union.betti, [2, 2]);
        let near = curve(&[2.00001, 3.0], &[[Some(0), Some(1)], [Some(0), Some(1)]]);
        assert!(Topology::of_curves(&[&circle, &near]).is_err());
        assert_eq!(betti(Topology::of_curves(&[])), [0, 0]);
    }

    fn surface(vertices: usize, triangles: &[[u32; 3]], compact: bool, euler: i64) -> RealSurface {
        RealSurface {
            id: ID,
            degree: 2,
            compact,
            euler,
            levels: Vec::new(),
            mesh: Mesh {
                vertices: vec![[0.0; 3]; vertices],
                triangles: triangles.to_vec(),
                segments: Vec::new(),
            },
            doubts: Vec::new(),
        }
    }

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];

    #[test]
    fn surfaces_have_the_homology_of_their_meshes() {
        let sphere = surface(4, &TETRAHEDRON, true, 2);
        assert_eq!(betti(Topology::of_surface(&sphere)), [1, 0, 1]);
        // Two spheres with a common triangle: three triangles at its edges, two cavities.
        let across = [[0, 1, 4], [0, 2, 4], [1, 2, 4]];
        let double = surface(5, &[&TETRAHEDRON[..], &across].concat(), true, 3);
        assert_eq!(betti(Topology::of_surface(&double)), [1, 0, 2]);
        // The torus of seven vertices, and the projective plane of six.
        let torus: Vec<[u32; 3]> = (0..7)
            .flat_map(|k| [[k, (k + 1) % 7, (k + 3) % 7], [k, (k + 2) % 7, (k + 3) % 7]])
            .collect();
        let torus = surface(7, &torus, true, 0);
        assert_eq!(betti(Topology::of_surface(&torus)), [1, 2, 1]);
        let plane = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 1],
            [1, 2, 4],
            [2, 3, 5],
            [3, 4, 1],
            [4, 5, 2],
            [5, 1, 3],
        ];
        let projective = surface(6, &plane, true, 1);
        assert_eq!(betti(Topology::of_surface(&projective)), [1, 1, 1]);
    }

    #[test]
    fn an_unbounded_surface_is_known_by_its_part_in_the_window() {
        // A plane has Euler characteristic 1 with compact support, a cylinder 0.
        let plane = surface(3, &[[0, 1, 2]], false, 1);
        assert_eq!(betti(Topology::of_surface(&plane)), [1, 0, 0]);
        let ring = [
            [0, 1, 3],
            [1, 3, 4],
            [1, 2, 4],
            [2, 4, 5],
            [2, 0, 5],
            [0, 5, 3],
        ];
        let cylinder = surface(6, &ring, false, 0);
        assert_eq!(betti(Topology::of_surface(&cylinder)), [1, 1, 0]);
        // A window that cuts off a handle is found.
        let wrong = surface(3, &[[0, 1, 2]], false, -1);
        assert!(Topology::of_surface(&wrong).is_err());
        // A line of double points: two segments.
        let mut line = surface(3, &[], false, -1);
        line.mesh.segments = vec![[0, 1], [1, 2]];
        assert_eq!(betti(Topology::of_surface(&line)), [1, 0, 0]);
        line.doubts.push("one".into());
        assert!(Topology::of_surface(&line).is_err());
    }
}
