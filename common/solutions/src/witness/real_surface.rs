//! RealSurface: the real part of a component of dimension 2 in space, as a triangulation and by counts of its cells.

use super::witness_set::ComponentId;
use crate::disjoint_sets::DisjointSets;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Triangles of a surface in a window, and curves and points on it that lie on no triangle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Values of the three variables.
    pub vertices: Vec<[f64; 3]>,
    /// Vertices of triangles, by place.
    pub triangles: Vec<[u32; 3]>,
    /// Pieces of curves where the surface is singular, by their ends.
    pub segments: Vec<[u32; 2]>,
}

/// Numbers of the connected parts and special edges of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshCounts {
    /// Connected parts.
    pub parts: u64,
    /// Connected parts that consist of segments alone: curves.
    pub curve_parts: u64,
    /// Connected parts that are one vertex.
    pub point_parts: u64,
    /// Vertices less edges plus triangles.
    pub euler: i64,
    /// Edges with one triangle: none where the surface is compact.
    pub border: u64,
    /// Edges with more than two triangles: where it crosses itself.
    pub crossing: u64,
}

/// The real part of one component. If the component is not its own conjugate, the real part is the intersection of
/// both: curves and points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealSurface {
    /// The component.
    pub id: ComponentId,
    /// Degree of the component.
    pub degree: u64,
    /// Whether the surface is bounded; else the mesh ends at the border of a window.
    pub compact: bool,
    /// Euler characteristic with compact support: the sum over its open cells of -1 to the power of their dimension.
    pub euler: i64,
    /// Values of a linear form at which the section changes.
    pub levels: Vec<f64>,
    /// Triangulation of the surface.
    pub mesh: Mesh,
    /// Doubts about the surface, as shown to the user.
    pub doubts: Vec<String>,
}

impl Mesh {
    /// The triangles of each edge, by place; a segment that bounds no triangle is an edge with none.
    pub(super) fn triangles_of_edges(&self) -> BTreeMap<[u32; 2], Vec<usize>> {
        let mut edges: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        let ordered = |a: u32, b: u32| [a.min(b), a.max(b)];
        for (triangle, &[a, b, c]) in self.triangles.iter().enumerate() {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                edges.entry(ordered(a, b)).or_default().push(triangle);
            }
        }
        for &[a, b] in &self.segments {
            edges.entry(ordered(a, b)).or_default();
        }
        edges
    }

    /// Parts, Euler characteristic, border.
    pub fn counts(&self) -> MeshCounts {
        let edges = self.triangles_of_edges();
        let mut joined = DisjointSets::new(self.vertices.len());
        for &[a, b] in edges.keys() {
            joined.join(a as usize, b as usize);
        }
        let mut on_triangle = vec![false; self.vertices.len()];
        for &corner in self.triangles.iter().flatten() {
            on_triangle[corner as usize] = true;
        }
        let parts = joined.clusters();
        let (points, others): (Vec<_>, Vec<_>) = parts.iter().partition(|part| part.len() == 1);
        let is_curve = |part: &&&Vec<usize>| !part.iter().any(|&v| on_triangle[v]);
        let (v, e, f) = (self.vertices.len(), edges.len(), self.triangles.len());
        MeshCounts {
            parts: parts.len() as u64,
            curve_parts: others.iter().filter(is_curve).count() as u64,
            point_parts: points.len() as u64,
            euler: v as i64 - e as i64 + f as i64,
            border: edges.values().filter(|t| t.len() == 1).count() as u64,
            crossing: edges.values().filter(|t| t.len() > 2).count() as u64,
        }
    }
}

impl RealSurface {
    /// Adds a doubt where the mesh of a bounded surface has a border, or another Euler characteristic than its cells.
    pub fn check(&mut self) {
        if !self.compact || !self.doubts.is_empty() {
            return;
        }
        let counts = self.mesh.counts();
        if counts.border > 0 {
            let border = counts.border;
            self.doubts.push(format!(
                "the mesh has {border} edges with one triangle, though the surface is bounded"
            ));
        }
        if counts.euler != self.euler {
            self.doubts.push(format!(
                "the mesh has Euler characteristic {}, the cells have {}",
                counts.euler, self.euler
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> RealSurface {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        RealSurface {
            id: ComponentId {
                dimension: 2,
                number: 1,
            },
            degree: 2,
            compact: true,
            euler: 2,
            levels: Vec::new(),
            mesh: Mesh {
                vertices,
                triangles: vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]],
                segments: Vec::new(),
            },
            doubts: Vec::new(),
        }
    }

    #[test]
    fn a_face_that_was_taken_away_is_found() {
        let mut whole = tetrahedron();
        whole.check();
        assert!(whole.doubts.is_empty(), "{:?}", whole.doubts);
        for lost in 0..4 {
            let mut broken = tetrahedron();
            broken.mesh.triangles.remove(lost);
            broken.check();
            assert_eq!(broken.doubts.len(), 2);
        }
    }

    #[test]
    fn parts_segments_and_points_are_counted() {
        let mut mesh = tetrahedron().mesh;
        mesh.vertices.extend([[5.0; 3], [6.0; 3], [7.0; 3]]);
        mesh.segments.push([4, 5]);
        let counts = mesh.counts();
        assert_eq!((counts.parts, counts.euler), (3, 4));
        assert_eq!((counts.curve_parts, counts.point_parts), (1, 1));
    }
}
