//! QuestionAnswer: the answer to a question about components as blocks of JSON, field by field as the contract has them.
//!
//! A coordinator makes the blocks of an answer, a client reads them. Fields of a block stand in alphabetical order, as in
//! the JSON; a field that older programs did not write is optional or has a default.

use cognate_solutions::witness::answer::{
    CertifiedComponent, CheckedComponent, GroupDegree, Membership, Mobility, Multidegree, Near,
    Projection, RealPoint, RealPoints, Samples,
};
use cognate_solutions::witness::real_curve::{
    CurveEdge, CurveVertex, ProvedFibre, RealCurve, VertexKind,
};
use cognate_solutions::witness::real_surface::RealSurface;
use cognate_solutions::witness::topology::Topology;
use cognate_solutions::witness::{Answer, ComponentId};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use serde_json::from_str;

/// Answer to a question about components, by the kind of question.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(untagged)]
pub enum QuestionAnswer {
    /// Whether components that were read are whole.
    Check(ComponentAnswers<CheckBlock>),
    /// Proofs of witness points.
    Certify(ComponentAnswers<CertifyBlock>),
    /// Components on which points lie.
    Member(PointAnswers<MemberBlock>),
    /// Points of components.
    Sample(ComponentPoints<Vec<Complex64>, SampleBlock>),
    /// Images of components.
    Project(ComponentAnswers<ProjectBlock>),
    /// Degrees by groups of variables.
    Multidegree(MultidegreeAnswer),
    /// Motions of points.
    Mobility(PointAnswers<MobilityBlock>),
    /// Real parts of components of dimension 1.
    RealCurve(RealCurveAnswer),
    /// Real points of components.
    RealPoints(ComponentPoints<RealPointBlock, RealPointCountsBlock>),
    /// Real parts of components of dimension 2.
    RealSurface(RealSurfaceAnswer),
    /// An answer of another program version, or components, which have a summary of their own.
    #[default]
    Other,
}

/// Answers for points that were asked about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointAnswers<P> {
    /// A block for each point.
    pub points: Vec<P>,
}

/// Answers for components.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ComponentAnswers<C> {
    /// A block for each component.
    pub components: Vec<C>,
}

/// Points of components, and counts of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ComponentPoints<P, C> {
    /// Points of all components, in the order of the components.
    pub points: Vec<P>,
    /// Counts of the points of each component.
    pub components: Vec<C>,
}

/// Degrees of components by groups of variables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MultidegreeAnswer {
    /// Degrees of each component.
    pub components: Vec<MultidegreeBlock>,
    /// Groups of variables, by names.
    pub groups: Vec<Vec<String>>,
}

/// Real parts of components of dimension 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealCurveAnswer {
    /// Counts of the parts of each curve.
    pub components: Vec<CurveCountsBlock>,
    /// Vertices and arcs of each curve.
    pub curves: Vec<CurveBlock>,
    /// All components together; nothing where an older program wrote the answer.
    #[serde(default)]
    pub union: Option<TopologyBlock>,
}

/// Real parts of components of dimension 2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealSurfaceAnswer {
    /// Counts of the parts of each surface.
    pub components: Vec<SurfaceCountsBlock>,
    /// Triangles of each surface.
    pub surfaces: Vec<SurfaceBlock>,
    /// All components together; nothing where an older program wrote the answer.
    #[serde(default)]
    pub union: Option<TopologyBlock>,
}

/// Declares blocks: each is a struct that can be written and read as JSON, with a private function `new` that makes it of
/// a part of an answer. A field is declared with its type and its value.
macro_rules! blocks {
    ($(
        $(#[$doc:meta])*
        $block:ident($($part:ident: $of:ty),*) $(let ($($local:ident = $computed:expr),*))? {
            $($(#[$attribute:meta])* $field:ident: $type:ty = $value:expr,)*
        }
    )*) => {$(
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        pub struct $block {
            $($(#[$attribute])* pub $field: $type,)*
        }

        impl $block {
            fn new($($part: $of),*) -> Self {
                $($(let $local = $computed;)*)?
                Self { $($field: $value,)* }
            }
        }
    )*};
}

blocks! {
    /// Whether a component that was read is whole.
    CheckBlock(component: &CheckedComponent) {
        /// Whether the sum of second derivatives is 0.
        closed: bool = component.closed,
        /// Name of the component.
        id: String = component.id.to_string(),
        /// Dimension of the dual space at a witness point; `null` where it did not close.
        multiplicity: Option<u64> = component.multiplicity,
    }

    /// Numbers of witness points of a component that are proved.
    CertifyBlock(component: &CertifiedComponent) {
        /// Witness points that are each alone in a box.
        certified: u64 = component.certified,
        /// Whether the certified points are proved to be different.
        distinct: bool = component.distinct,
        /// Name of the component.
        id: String = component.id.to_string(),
        /// Number of witness points.
        points: u64 = component.points,
    }

    /// Components on which a point lies.
    MemberBlock(point: &Membership) {
        /// Dimension of each component of `on`.
        dimensions: Vec<u32> = point.on.iter().map(|id| id.dimension).collect(),
        /// Index of the point among the points that were asked.
        index: u64 = point.index,
        /// Names of the components on which the point lies.
        on: Vec<String> = names(&point.on),
        /// Whether the point solves the equations, within its accuracy; `null` where that is not clear.
        solves: Option<bool> = point.solves,
        /// Components for which it is not clear whether the point lies on them.
        unsettled: Vec<NearBlock> = point.unsettled.iter().map(NearBlock::new).collect(),
    }

    /// A component of which it is not clear whether a point lies on it.
    NearBlock(near: &Near) {
        /// Name of the component.
        component: String = near.id.to_string(),
        /// Distance of the nearest point of the component, relative to the point's size; `null` where it is not known.
        distance: Option<f64> = near.distance,
    }

    /// Counts of the points of a component that were wanted.
    SampleBlock(samples: &Samples) {
        /// Number of points that were found.
        count: u64 = samples.points.len() as u64,
        /// Paths that failed.
        failed: u64 = samples.failed,
        /// Name of the component.
        id: String = samples.id.to_string(),
        /// Number of points that were wanted.
        wanted: u64 = samples.wanted,
    }

    /// The closure of a component's image.
    ProjectBlock(image: &Projection) {
        /// Degree of the image; `null` where it is not clear.
        degree: Option<u64> = image.degree,
        /// Dimension of the image; `null` where ranks do not tell.
        dimension: Option<u32> = image.dimension,
        /// Doubts about this block, in words.
        doubts: Vec<String> = image.doubts.clone(),
        /// Degree of a general fibre.
        fiber_degree: Option<u64> = image.fiber_degree,
        /// Dimension of a general fibre.
        fiber_dimension: Option<u32> = image.fiber_dimension,
        /// Name of the component.
        id: String = image.id.to_string(),
        /// Least gap between singular values that were taken as not 0 and as 0.
        rank_gap: f64 = image.rank_gap,
        /// The first of the components before it that has the same image.
        same_image: Option<String> = image.same_image.map(|id| id.to_string()),
    }

    /// Degrees of a component by groups of variables.
    MultidegreeBlock(component: &Multidegree) {
        /// Doubts about this block, in words.
        doubts: Vec<String> = component.doubts.clone(),
        /// Name of the component.
        id: String = component.id.to_string(),
        /// An entry for each way to share the slices out.
        multidegree: Vec<GroupDegreeBlock> = component.degrees.iter().map(GroupDegreeBlock::new).collect(),
    }

    /// Number of points that slices in single groups of variables cut out of a component.
    GroupDegreeBlock(entry: &GroupDegree) {
        /// The number of points; `null` where it is not clear.
        degree: Option<u64> = entry.degree,
        /// Slices in each group.
        slices: Vec<u32> = entry.slices.clone(),
    }

    /// Motions of a point.
    MobilityBlock(point: &Mobility) {
        /// Dimensions of the dual space up to each order, from 0.
        dimensions_by_order: Vec<u32> = point.dimensions_by_order.clone(),
        /// Index of the point among the points that were asked.
        index: u64 = point.index,
        /// Dimension of the tangent space.
        infinitesimal: Option<u32> = point.infinitesimal,
        /// Largest dimension of a component through the point; `null` where it is not known.
        local_dimension: Option<u32> = point.local_dimension,
        /// Names of the components through the point, where some are known.
        on: Vec<String> = names(&point.on),
        /// Reason by which the local dimension is known.
        reason: String = point.reason.clone(),
    }

    /// A real point of a component.
    RealPointBlock(component: ComponentId, point: &RealPoint) {
        /// Name of the component.
        component: String = component.to_string(),
        /// Values of the variables.
        point: Vec<Complex64> = point.point.clone(),
        /// Whether the distance to a random point has a regular critical point there.
        regular: bool = point.regular,
    }

    /// Counts of the real points of a component.
    RealPointCountsBlock(component: &RealPoints) let (settled = component.doubts.is_empty()) {
        /// Doubts about this block, in words.
        doubts: Vec<String> = component.doubts.clone(),
        /// Whether the component has real points; `null` where none were found and something is in doubt.
        has_real_points: Option<bool> = match component.points.is_empty() {
            true => settled.then_some(false),
            false => Some(true),
        },
        /// Name of the component.
        id: String = component.id.to_string(),
        /// Number of real points.
        points: u64 = component.points.len() as u64,
        /// Whether nothing is in doubt.
        settled: bool = settled,
    }

    /// Counts of loops, arcs and points in the real part of a component of dimension 1.
    CurveCountsBlock(curve: &RealCurve)
    let (counts = curve.counts(), topology = Topology::of_curves(&[curve])) {
        /// Connected parts that begin and end at the border of a box.
        #[serde(default)]
        arcs_across_box: u64 = counts.arcs_across_box,
        /// Connected parts that are circles.
        closed_loops: u64 = counts.closed_loops,
        /// All connected parts.
        connected_components: u64 = counts.connected_components,
        /// Degree of the component.
        degree: u64 = curve.degree,
        /// Number of arcs.
        edges: usize = curve.edges.len(),
        /// Name of the component.
        id: String = curve.id.to_string(),
        /// Points through which no real branch passes.
        isolated_points: u64 = counts.isolated_points,
        /// Slabs over which the number of real branches is proved; `null` where no proof was asked for.
        proved_slabs: Option<usize> = curve.proved_slabs(),
        /// Whether nothing is in doubt.
        settled: bool = curve.doubts.is_empty(),
        /// Real points where the curve is singular.
        singular_points: u64 = counts.singular_points,
        /// All slabs; `null` where no proof was asked for.
        slabs: Option<usize> = curve.proved_slabs().map(|_| curve.proofs.len()),
        /// Connected parts and Betti numbers; `null` where they are not known.
        #[serde(default)]
        topology: Option<Topology> = topology.clone().ok(),
        /// Reason by which the topology is not known.
        #[serde(default)]
        topology_reason: Option<String> = topology.err(),
        /// Connected parts that are lines.
        unbounded_arcs: u64 = counts.unbounded_arcs,
        /// Number of points where arcs begin and end.
        vertices: usize = curve.vertices.len(),
    }

    /// The topology of all components together.
    TopologyBlock(topology: Result<Topology, String>) {
        /// Connected parts and Betti numbers; `null` where they are not known.
        topology: Option<Topology> = topology.clone().ok(),
        /// Reason by which the topology is not known.
        topology_reason: Option<String> = topology.err(),
    }

    /// A real curve as it is drawn.
    CurveBlock(curve: &RealCurve) {
        /// The arcs.
        edges: Vec<CurveEdge> = curve.edges.clone(),
        /// Coefficients of the form that grows on arcs, real and imaginary part for each variable.
        form: Vec<[i32; 2]> = curve.form.clone(),
        /// Name of the component.
        id: String = curve.id.to_string(),
        /// Proofs for the points over each slab; none where no proof was asked for.
        #[serde(default)]
        slabs: Vec<SlabBlock> = curve.proofs.iter().map(|proof| SlabBlock::new(proof, curve.degree)).collect(),
        /// Points where arcs begin and end.
        vertices: Vec<VertexBlock> = vertices(curve),
    }

    /// Proofs for the points of a curve over one value of the form.
    SlabBlock(proof: &ProvedFibre, degree: u64) {
        /// Points that are each alone in a box, and different from all others.
        different: u64 = proof.different,
        /// Points that are proved not to be real.
        not_real: u64 = proof.not_real,
        /// Whether all points of the fibre are proved to be different, and each of them to be real or not real.
        proved: bool = proof.is_complete(degree),
        /// Points that are proved to be real.
        real: u64 = proof.real,
        /// Value of the form.
        value: f64 = proof.value,
    }

    /// A point where arcs of a curve begin and end.
    VertexBlock(vertex: &CurveVertex) {
        /// Places of the arcs that begin or end here, among all arcs; an arc that does both stands twice.
        edges: Vec<usize> = Vec::new(),
        /// Kind of the vertex.
        kind: VertexKind = vertex.kind,
        /// Values of the variables.
        point: Vec<Complex64> = vertex.point.clone(),
        /// Value of the form.
        value: f64 = vertex.value,
    }

    /// Counts of parts in the real part of a component of dimension 2; `null` where something is in doubt.
    SurfaceCountsBlock(surface: &RealSurface)
    let (settled = surface.doubts.is_empty(), counts = surface.mesh.counts(),
         topology = Topology::of_surface(surface)) {
        /// Whether the surface is bounded.
        compact: Option<bool> = settled.then_some(surface.compact),
        /// Edges with more than two triangles.
        crossing_edges: Option<u64> = settled.then_some(counts.crossing),
        /// Connected parts that are curves.
        curve_parts: Option<u64> = settled.then_some(counts.curve_parts),
        /// Degree of the component.
        degree: u64 = surface.degree,
        /// Euler characteristic with compact support.
        euler: Option<i64> = settled.then_some(surface.euler),
        /// Name of the component.
        id: String = surface.id.to_string(),
        /// Number of values of a linear form at which the section changes.
        levels: usize = surface.levels.len(),
        /// Connected parts.
        parts: Option<u64> = settled.then_some(counts.parts),
        /// Connected parts that are points.
        point_parts: Option<u64> = settled.then_some(counts.point_parts),
        /// Whether nothing is in doubt.
        settled: bool = settled,
        /// Connected parts and Betti numbers; `null` where they are not known.
        #[serde(default)]
        topology: Option<Topology> = topology.clone().ok(),
        /// Reason by which the topology is not known.
        #[serde(default)]
        topology_reason: Option<String> = topology.err(),
        /// Number of triangles.
        triangles: usize = surface.mesh.triangles.len(),
        /// Number of vertices of triangles and segments.
        vertices: usize = surface.mesh.vertices.len(),
    }

    /// Triangles of a real surface, and curves and points on it that lie on no triangle.
    SurfaceBlock(surface: &RealSurface) {
        /// Whether the surface is bounded; `null` where an older program wrote the block.
        compact: Option<bool> = Some(surface.compact),
        /// Name of the component.
        id: String = surface.id.to_string(),
        /// Pieces of curves where the surface is singular, by the places of their ends in `vertices`.
        segments: Vec<[u32; 2]> = surface.mesh.segments.clone(),
        /// Triangles, by the places of their corners in `vertices`.
        triangles: Vec<[u32; 3]> = surface.mesh.triangles.clone(),
        /// Values of the three variables.
        vertices: Vec<[f64; 3]> = surface.mesh.vertices.clone(),
    }
}

/// Topology of several surfaces together, which is known where there is one.
fn union_of_surfaces(surfaces: &[SurfaceCountsBlock]) -> TopologyBlock {
    let reason = match surfaces {
        [surface] => {
            return TopologyBlock {
                topology: surface.topology.clone(),
                topology_reason: surface.topology_reason.clone(),
            };
        }
        [] => "there is no surface",
        _ => "surfaces may meet in curves, which their meshes do not share",
    };
    TopologyBlock::new(Err(reason.into()))
}

impl QuestionAnswer {
    /// Blocks of an answer.
    pub(crate) fn new(answer: &Answer) -> Self {
        match answer {
            Answer::Check(sets) => Self::Check(of_components(sets, CheckBlock::new)),
            Answer::Certify(sets) => Self::Certify(of_components(sets, CertifyBlock::new)),
            Answer::Member(points) => Self::Member(of_points(points, MemberBlock::new)),
            Answer::Sample(components) => Self::Sample(ComponentPoints {
                points: components.iter().flat_map(|c| c.points.clone()).collect(),
                components: components.iter().map(SampleBlock::new).collect(),
            }),
            Answer::Project(images) => Self::Project(of_components(images, ProjectBlock::new)),
            Answer::Multidegree { groups, components } => Self::Multidegree(MultidegreeAnswer {
                components: components.iter().map(MultidegreeBlock::new).collect(),
                groups: groups.clone(),
            }),
            Answer::Mobility(points) => Self::Mobility(of_points(points, MobilityBlock::new)),
            Answer::RealCurve(curves) => Self::RealCurve(RealCurveAnswer {
                components: curves.iter().map(CurveCountsBlock::new).collect(),
                curves: curves.iter().map(CurveBlock::new).collect(),
                union: Some(TopologyBlock::new(Topology::of_curves(
                    &curves.iter().collect::<Vec<_>>(),
                ))),
            }),
            Answer::RealPoints(components) => Self::RealPoints(ComponentPoints {
                points: components.iter().flat_map(real_points).collect(),
                components: components.iter().map(RealPointCountsBlock::new).collect(),
            }),
            Answer::RealSurface(surfaces) => {
                let components: Vec<_> = surfaces.iter().map(SurfaceCountsBlock::new).collect();
                Self::RealSurface(RealSurfaceAnswer {
                    union: Some(union_of_surfaces(&components)),
                    components,
                    surfaces: surfaces.iter().map(SurfaceBlock::new).collect(),
                })
            }
            Answer::Components(_) => Self::Other,
        }
    }

    /// Reads the blocks of a summary, by the name of its question. The enum does not derive this: serde keeps the content
    /// of an untagged enum in a form in which `serde_json` with numbers of any precision finds no floats.
    pub(crate) fn read(question: &str, json: &str) -> Result<Self, serde_json::Error> {
        Ok(match question {
            "check" => Self::Check(from_str(json)?),
            "certify" => Self::Certify(from_str(json)?),
            "member" => Self::Member(from_str(json)?),
            "sample" => Self::Sample(from_str(json)?),
            "project" => Self::Project(from_str(json)?),
            "multidegree" => Self::Multidegree(from_str(json)?),
            "mobility" => Self::Mobility(from_str(json)?),
            "real-curve" => Self::RealCurve(from_str(json)?),
            "real-points" => Self::RealPoints(from_str(json)?),
            "real-surface" => Self::RealSurface(from_str(json)?),
            _ => Self::Other,
        })
    }
}

fn of_points<A, P>(points: &[A], block: fn(&A) -> P) -> PointAnswers<P> {
    let points = points.iter().map(block).collect();
    PointAnswers { points }
}

fn of_components<A, C>(components: &[A], block: fn(&A) -> C) -> ComponentAnswers<C> {
    let components = components.iter().map(block).collect();
    ComponentAnswers { components }
}

fn names(ids: &[ComponentId]) -> Vec<String> {
    ids.iter().map(ToString::to_string).collect()
}

/// The real points of a component.
fn real_points(component: &RealPoints) -> impl Iterator<Item = RealPointBlock> {
    let points = component.points.iter();
    points.map(|point| RealPointBlock::new(component.id, point))
}

/// The vertices of a curve, each with the arcs that begin or end there.
fn vertices(curve: &RealCurve) -> Vec<VertexBlock> {
    let mut vertices: Vec<VertexBlock> = curve.vertices.iter().map(VertexBlock::new).collect();
    for (place, edge) in curve.edges.iter().enumerate() {
        for end in edge.ends.into_iter().flatten() {
            vertices[end].edges.push(place);
        }
    }
    vertices
}
