//! Graph: parameter values with what is known to solve the system there, and the paths between them.
//!
//! Tracking all solutions at one vertex along an edge permutes them, up to
//! their names: an edge is a bijection between the orbits at its ends, and a
//! path along it shows one pair of it, whichever end the path began at (Duff,
//! Hill, Jensen, Lee, Leykin, Sommars: Solving polynomial systems via homotopy
//! continuation and monodromy, 2019). Paths that break it have jumped, and are
//! tracked again more tightly. So an edge costs one path a solution, and each
//! edge more than a tree needs makes a loop more.

use super::orbits::{Orbits, RegularSolution};
use cognate_continuation::start_points::StoredPoints;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

/// Vertex at whose parameters the start solutions solve the system; no edge leads back there.
pub(super) const START: usize = 0;
/// Vertex where the loops begin and end.
pub(super) const BASE: usize = 1;
/// Edge from the start to the base.
pub(super) const FIRST: usize = 0;

/// Part that a vertex plays in a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Role {
    /// The search begins there.
    Start,
    /// Loops lead through the vertex.
    Place,
    /// A trace test moves the solutions of the base there.
    TraceTest,
}

/// Values of the parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Vertex {
    /// Values, one for each parameter of the system.
    pub parameters: Vec<Complex64>,
    /// Part that the vertex plays.
    pub role: Role,
    /// Known solutions at these parameters, one of each orbit, in the order in which they were found.
    pub points: Vec<RegularSolution>,
}

/// Partner of one point at the other end of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Correspondence {
    /// The partner is not known: the point is to be tracked, for the first time or again.
    Open { attempt: u16 },
    /// The partner is this point at the other end of the edge.
    To { point: u32, attempt: u16 },
    /// Nothing more is tried.
    Lost,
}

impl Correspondence {
    /// Number of the partner, if it is known.
    fn partner(&self) -> Option<u32> {
        match self {
            Self::To { point, .. } => Some(*point),
            Self::Open { .. } | Self::Lost => None,
        }
    }

    /// Number of times that the point was tracked again; of one that is lost, as if it could be again.
    fn attempt(&self) -> u16 {
        match self {
            Self::Open { attempt } | Self::To { attempt, .. } => *attempt,
            Self::Lost => u16::MAX - 1,
        }
    }
}

/// Direction in which an edge is tracked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) enum Direction {
    /// From the beginning of the edge to its end.
    Ahead,
    /// From the end of the edge to its beginning, on the same detour.
    Back,
}

impl Direction {
    fn other(self) -> Self {
        match self {
            Self::Ahead => Self::Back,
            Self::Back => Self::Ahead,
        }
    }
}

/// A path between two vertices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Edge {
    /// The vertices where it begins and ends.
    pub ends: [usize; 2],
    /// Seed of its detour.
    pub seed: u64,
    /// Different orbits lead to different orbits, and it is tracked in both directions; else ahead only.
    pub bijective: bool,
    /// Partner of each point of the vertices where the edge begins and ends; of the end only if the edge is bijective.
    pub correspondences: [Vec<Correspondence>; 2],
}

impl Edge {
    /// The vertex where paths of this direction begin.
    pub fn source(&self, direction: Direction) -> usize {
        self.ends[direction as usize]
    }

    /// The vertex where they arrive.
    pub fn target(&self, direction: Direction) -> usize {
        self.ends[direction.other() as usize]
    }

    /// Directions in which the edge is tracked: both, or the only one.
    fn directions(&self) -> &'static [Direction] {
        if self.bijective {
            &[Direction::Ahead, Direction::Back]
        } else {
            &[Direction::Ahead]
        }
    }

    /// Number of points without a partner that are to be tracked in this direction.
    fn open(&self, direction: Direction) -> usize {
        let correspondences = self.correspondences[direction as usize].iter();
        correspondences
            .filter(|correspondence| matches!(correspondence, Correspondence::Open { .. }))
            .count()
    }

    /// Number of known pairs.
    pub fn pairs(&self) -> usize {
        self.partners().flatten().count()
    }

    /// Partners at the end of the edge of all points where it begins.
    fn partners(&self) -> impl Iterator<Item = Option<u32>> {
        self.correspondences[0].iter().map(Correspondence::partner)
    }
}

/// Paths that can be tracked together: of one edge, one direction, and equally tight.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct PathBatch {
    pub edge: usize,
    pub direction: Direction,
    /// Number of times that the paths were tracked before.
    pub attempt: u16,
    /// Points of the vertex where they begin, ascending.
    pub sources: Vec<u32>,
}

/// A point at one end of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct EdgePoint {
    pub edge: usize,
    /// Direction in which the edge leads away from the point.
    pub direction: Direction,
    /// Number of the point at its vertex.
    pub point: u32,
}

impl EdgePoint {
    /// A point at the other end of the edge.
    fn across(self, point: u32) -> Self {
        Self {
            edge: self.edge,
            direction: self.direction.other(),
            point,
        }
    }
}

/// A path along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct EdgePath {
    pub source: EdgePoint,
    /// Number of times that the path was tracked before.
    pub attempt: u16,
}

/// Result of tracking one path along an edge.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EdgeEnd {
    pub path: EdgePath,
    /// End of the path; `None` if the path arrived nowhere.
    pub end: Option<RegularSolution>,
}

/// An end of a path at a vertex.
#[derive(Clone, Copy)]
struct Arrival<'a> {
    path: EdgePath,
    end: &'a RegularSolution,
}

/// Counts of the events of one round of tracking.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct RoundCounts {
    /// Meetings of paths on a bijective edge, seen for the first time.
    pub crossings: u64,
    /// Meetings that were given up: all paths of it but one are lost.
    pub crossings_left: u64,
    /// Paths that arrived nowhere, or not clearly, and are not tried again.
    pub lost: u64,
}

impl AddAssign for RoundCounts {
    fn add_assign(&mut self, other: Self) {
        self.crossings += other.crossings;
        self.crossings_left += other.crossings_left;
        self.lost += other.lost;
    }
}

/// Vertices and edges.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Graph {
    pub vertices: Vec<Vertex>,
    pub edges: Vec<Edge>,
}

/// Seed of the detour of an edge, by the number of the edge.
pub(super) fn edge_seed(seed: u64, edge: usize) -> u64 {
    RandomStream::new(seed, Purpose::Loop, edge as u64).bits()
}

/// Permutation of the points of the base by one loop.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LoopPermutation {
    /// Number of the edge that closes the loop.
    pub edge: usize,
    /// Image of each point, as far as it is known.
    pub images: Vec<Option<u32>>,
}

impl Graph {
    /// A graph of the start, with this number of points, the base, and the edge between them.
    pub fn new(start: Vec<Complex64>, count: usize, base: Vec<Complex64>, seed: u64) -> Self {
        let mut graph = Self::default();
        graph.add_vertex(start, Role::Start);
        graph.add_vertex(base, Role::Place);
        graph.add_edge(START, BASE, edge_seed(seed, FIRST), false);
        graph.edges[FIRST].correspondences[0] = vec![Correspondence::Open { attempt: 0 }; count];
        graph
    }

    /// Known solutions at the base, one of each orbit.
    pub fn base_points(&self) -> &[RegularSolution] {
        &self.vertices[BASE].points
    }

    /// Vertices that loops lead through, the base first.
    pub fn places(&self) -> Vec<usize> {
        let vertices = self.vertices.iter().enumerate();
        vertices
            .filter(|(_, vertex)| vertex.role == Role::Place)
            .map(|(number, _)| number)
            .collect()
    }

    /// A vertex where nothing is known yet; returns its number.
    pub fn add_vertex(&mut self, parameters: Vec<Complex64>, role: Role) -> usize {
        self.vertices.push(Vertex {
            parameters,
            role,
            points: Vec::new(),
        });
        self.vertices.len() - 1
    }

    /// An edge on which no pair is known.
    pub fn add_edge(&mut self, from: usize, to: usize, seed: u64, bijective: bool) {
        let open = |vertex: usize| {
            vec![Correspondence::Open { attempt: 0 }; self.vertices[vertex].points.len()]
        };
        let back = if bijective { open(to) } else { Vec::new() };
        self.edges.push(Edge {
            ends: [from, to],
            seed,
            bijective,
            correspondences: [open(from), back],
        });
    }

    /// Paths to be tracked next; empty when all pairs of all edges are known.
    ///
    /// An edge is tracked one way in a round, from where more is known. With d points at every
    /// vertex, q and r known at the ends of an edge and c pairs known, a path that begins at q leads
    /// to a new point with probability (d - r) / (d - c), if partners are random (the potential of
    /// Duff et al., section 4), so q - c paths bring (q - c)(d - r) / (d - c): more than the (r - c)(d - q) / (d - c)
    /// the other way exactly where q > r, whatever d is.
    ///
    /// `expected_points`: how many points a vertex has, where that is thought to be known. Then not everything
    /// need be tracked: of the edges into a vertex the ones with the largest potential are taken until
    /// they would bring all that is missing there, if they brought different points.
    pub fn open_batches(&self, expected_points: Option<usize>) -> Vec<PathBatch> {
        let mut chosen = self.open_directions();
        if let Some(expected_points) = expected_points {
            for edges in chosen.values_mut() {
                let left =
                    |number: usize| expected_points.saturating_sub(self.edges[number].pairs());
                edges.sort_by_key(|&(number, _)| (left(number), number));
                let mut share = 0.0;
                edges.retain(|&(number, direction)| {
                    let taken = share < 1.0;
                    share += self.edges[number].open(direction) as f64 / left(number).max(1) as f64;
                    taken
                });
            }
        }
        let mut chosen: Vec<(usize, Direction)> = chosen.into_values().flatten().collect();
        chosen.sort_unstable();
        let mut batches = Vec::new();
        for (edge, direction) in chosen {
            let mut open = BTreeMap::<u16, Vec<u32>>::new();
            let correspondences = self.edges[edge].correspondences[direction as usize].iter();
            for (source, correspondence) in correspondences.enumerate() {
                if let Correspondence::Open { attempt } = correspondence {
                    open.entry(*attempt).or_default().push(source as u32);
                }
            }
            batches.extend(open.into_iter().map(|(attempt, sources)| PathBatch {
                edge,
                direction,
                attempt,
                sources,
            }));
        }
        batches
    }

    /// Edges with open points, by the vertex where their paths arrive, each in the direction from where more is known.
    fn open_directions(&self) -> BTreeMap<usize, Vec<(usize, Direction)>> {
        let mut chosen = BTreeMap::<usize, Vec<(usize, Direction)>>::new();
        for (number, edge) in self.edges.iter().enumerate() {
            let directions = edge
                .directions()
                .iter()
                .filter(|&&direction| edge.open(direction) > 0);
            let best = directions.max_by_key(|&&direction| {
                let point_count = self.vertices[edge.source(direction)].points.len();
                (point_count, direction.other())
            });
            if let Some(&direction) = best {
                let edges = chosen.entry(edge.target(direction)).or_default();
                edges.push((number, direction));
            }
        }
        chosen
    }

    /// Some points of a vertex, as they are stored.
    pub fn stored(&self, vertex: usize, sources: &[u32]) -> StoredPoints {
        let points = &self.vertices[vertex].points;
        let dimension = points.first().map_or(0, |point| point.values.len());
        let sources = sources.iter();
        StoredPoints {
            dimension,
            coordinates: sources
                .flat_map(|&k| points[k as usize].values.iter().copied())
                .collect(),
        }
    }

    fn add_point(&mut self, vertex: usize, point: RegularSolution) -> u32 {
        let points = &mut self.vertices[vertex].points;
        points.push(point);
        let number = points.len() as u32 - 1;
        for edge in &mut self.edges {
            for &direction in edge.directions() {
                if edge.source(direction) == vertex {
                    edge.correspondences[direction as usize]
                        .push(Correspondence::Open { attempt: 0 });
                }
            }
        }
        number
    }

    /// Makes one point of the points of each orbit at the base, once the group is known and before any edge can be
    /// tracked from there.
    ///
    /// # Panics
    /// When an edge can be tracked from the base.
    pub fn merge_base(&mut self, orbits: &Orbits) {
        let leads_away = |edge: &Edge| {
            let mut directions = edge.directions().iter();
            directions.any(|&direction| edge.source(direction) == BASE)
        };
        assert!(
            !self.edges.iter().any(leads_away),
            "points are merged before their names are used"
        );
        let points = &self.vertices[BASE].points;
        let orbits = orbits.members(points);
        let mut names = vec![0; points.len()];
        for (name, orbit) in orbits.iter().enumerate() {
            for &member in orbit {
                names[member] = name as u32;
            }
        }
        let kept = orbits.iter().map(|orbit| points[orbit[0]].clone());
        self.vertices[BASE].points = kept.collect();
        for edge in self.edges.iter_mut().filter(|edge| edge.ends[1] == BASE) {
            for correspondence in &mut edge.correspondences[0] {
                if let Correspondence::To { point, .. } = correspondence {
                    *point = names[*point as usize];
                }
            }
        }
    }

    /// Adds solutions to the base that are not known there; returns the number of their orbits.
    pub fn add_to_base(&mut self, solutions: &[RegularSolution], orbits: &Orbits) -> usize {
        let points = &self.vertices[BASE].points;
        let point_count = points.len();
        let orbits = orbits.members(points.iter().chain(solutions));
        let new = orbits.iter().filter(|orbit| orbit[0] >= point_count);
        let new: Vec<RegularSolution> = new
            .map(|orbit| solutions[orbit[0] - point_count].clone())
            .collect();
        for point in &new {
            self.add_point(BASE, point.clone());
        }
        new.len()
    }

    /// Number of different points to which the start solutions lead.
    pub fn start_targets(&self) -> usize {
        let points = self.edges[FIRST].partners().flatten();
        points.collect::<BTreeSet<u32>>().len()
    }

    /// Points to which the points of the base lead along the one edge to this vertex; `None` while one of them leads
    /// nowhere.
    pub fn reached(&self, vertex: usize) -> Option<Vec<&RegularSolution>> {
        let edge = self.edges.iter().find(|edge| edge.ends[1] == vertex)?;
        let points = &self.vertices[vertex].points;
        let reached = edge.partners();
        reached
            .map(|point| Some(&points[point? as usize]))
            .collect()
    }

    /// Permutations of the points of the base by the independent loops, which begin there. The first edge to a place
    /// is part of a tree; each other edge closes a loop.
    pub fn permutations(&self) -> Vec<LoopPermutation> {
        let count = |vertex: usize| self.vertices[vertex].points.len();
        // From the points of the base to those of each place, along the tree.
        let mut along = BTreeMap::<usize, Vec<Option<u32>>>::new();
        along.insert(BASE, (0..count(BASE) as u32).map(Some).collect());
        let mut loops = Vec::new();
        for (number, edge) in self.edges.iter().enumerate() {
            let [from, to] = edge.ends;
            let is_inside = self.vertices[to].role == Role::Place;
            let Some(here) = along.get(&from).filter(|_| is_inside) else {
                continue;
            };
            let step = |point: u32| edge.correspondences[0][point as usize].partner();
            let there: Vec<Option<u32>> = here.iter().map(|point| point.and_then(step)).collect();
            let Some(tree) = along.get(&to) else {
                along.insert(to, there);
                continue;
            };
            let mut back = vec![None; count(to)];
            for (point, image) in tree.iter().enumerate() {
                if let Some(image) = image {
                    back[*image as usize] = Some(point as u32);
                }
            }
            let around = there.iter().map(|point| back[(*point)? as usize]);
            loops.push(LoopPermutation {
                edge: number,
                images: around.collect(),
            });
        }
        loops
    }

    /// Takes in the ends of the paths of one round. The order of ends decides the names of new
    /// points, nothing else. A path is tried again up to `max_retries` times.
    pub fn settle(&mut self, ends: &[EdgeEnd], orbits: &Orbits, max_retries: u16) -> RoundCounts {
        let mut counts = RoundCounts::default();
        for end in ends.iter().filter(|end| end.end.is_none()) {
            counts.lost += u64::from(!self.retry(end.path, max_retries));
        }
        for vertex in 0..self.vertices.len() {
            let target = |source: EdgePoint| self.edges[source.edge].target(source.direction);
            let arrivals = ends.iter().filter_map(|EdgeEnd { path, end }| {
                let end = end.as_ref().filter(|_| target(path.source) == vertex)?;
                Some(Arrival { path: *path, end })
            });
            let arrivals: Vec<Arrival<'_>> = arrivals.collect();
            if !arrivals.is_empty() {
                counts += self.settle_at(vertex, &arrivals, orbits, max_retries);
            }
        }
        counts
    }

    /// Takes in the ends of paths at one vertex.
    fn settle_at(
        &mut self,
        vertex: usize,
        arrivals: &[Arrival<'_>],
        orbits: &Orbits,
        max_retries: u16,
    ) -> RoundCounts {
        let mut counts = RoundCounts::default();
        let points = &self.vertices[vertex].points;
        let point_count = points.len();
        let orbits = orbits.members(points.iter().chain(arrivals.iter().map(|a| a.end)));
        // The paths that claim to lead to a point.
        let mut claims = BTreeMap::<EdgePoint, Vec<EdgePath>>::new();
        for orbit in orbits {
            let split = orbit.partition_point(|&member| member < point_count);
            let (old, new) = orbit.split_at(split);
            let arrived = new.iter().map(|&member| arrivals[member - point_count]);
            let by_radius =
                |a: &Arrival<'_>, b: &Arrival<'_>| a.end.radius.total_cmp(&b.end.radius);
            let Some(best) = arrived.clone().min_by(by_radius) else {
                continue;
            };
            let target = match old {
                [] => self.add_point(vertex, best.end.clone()),
                [one] => *one as u32,
                // Too inaccurate to tell two known points apart.
                _ => {
                    for Arrival { path, .. } in arrived {
                        counts.lost += u64::from(!self.retry(path, max_retries));
                    }
                    continue;
                }
            };
            for Arrival { path, .. } in arrived {
                let target = path.source.across(target);
                claims.entry(target).or_default().push(path);
            }
        }
        for (target, paths) in claims {
            counts += self.settle_claims(target, paths, max_retries);
        }
        counts
    }

    /// Pairs a point with the path that leads there; paths that meet there on a bijective edge are tracked again.
    fn settle_claims(
        &mut self,
        target: EdgePoint,
        mut paths: Vec<EdgePath>,
        max_retries: u16,
    ) -> RoundCounts {
        let bijective = self.edges[target.edge].bijective;
        if bijective {
            // The earlier partner of the target, tracked in either direction.
            if let Some(source) = self.correspondence(target).partner() {
                let source = target.across(source);
                let attempt = self.correspondence(source).attempt();
                paths.push(EdgePath { source, attempt });
            }
        }
        paths.sort_unstable();
        let crossed = bijective && paths.len() > 1;
        if crossed {
            // The target's partner is looked for again, if the target needs one.
            let attempt = (self.correspondence(target).attempt() + 1).min(max_retries);
            *self.correspondence(target) = Correspondence::Open { attempt };
        }
        let mut is_resolved = true;
        for (place, &path) in paths.iter().enumerate() {
            if crossed && (self.retry(path, max_retries) || place > 0) {
                is_resolved &= path.attempt < max_retries;
            } else {
                // Paths that never come apart leave the target to the first of them.
                is_resolved &= !crossed;
                self.pair(path, target);
            }
        }
        RoundCounts {
            crossings: u64::from(crossed && paths.iter().any(|path| path.attempt == 0)),
            crossings_left: u64::from(crossed && !is_resolved),
            lost: 0,
        }
    }

    fn correspondence(&mut self, at: EdgePoint) -> &mut Correspondence {
        &mut self.edges[at.edge].correspondences[at.direction as usize][at.point as usize]
    }

    /// Notes that a path leads to a target, for both its ends.
    fn pair(&mut self, path: EdgePath, target: EdgePoint) {
        let EdgePath { source, attempt } = path;
        let point = target.point;
        *self.correspondence(source) = Correspondence::To { point, attempt };
        if self.edges[source.edge].bijective {
            let attempt = self.correspondence(target).attempt();
            let point = source.point;
            *self.correspondence(target) = Correspondence::To { point, attempt };
        }
    }

    /// Lets a path be tracked again, more tightly; false where that was done often enough.
    fn retry(&mut self, path: EdgePath, max_retries: u16) -> bool {
        let may = path.attempt < max_retries;
        *self.correspondence(path.source) = if may {
            Correspondence::Open {
                attempt: path.attempt + 1,
            }
        } else {
            Correspondence::Lost
        };
        may
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::system;
    use cognate_solutions::point_shape::PointShape;
    use cognate_solutions::symmetry::SymmetryGroup;

    /// The point x = `x` in one variable.
    fn at(x: f64) -> RegularSolution {
        RegularSolution {
            values: vec![Complex64::new(x, 0.0)],
            radius: 1e-10,
        }
    }

    fn arrival(source: u32, attempt: u16, x: f64) -> EdgeEnd {
        let source = EdgePoint {
            edge: 0,
            direction: Direction::Ahead,
            point: source,
        };
        EdgeEnd {
            path: EdgePath { source, attempt },
            end: Some(at(x)),
        }
    }

    /// Two vertices, three points at the first, one edge.
    fn graph() -> Graph {
        let mut graph = Graph::default();
        let (a, b) = (
            graph.add_vertex(vec![], Role::Start),
            graph.add_vertex(vec![], Role::Place),
        );
        for x in [0.1, 0.2, 0.3] {
            graph.add_point(a, at(x));
        }
        graph.add_edge(a, b, 1, true);
        graph
    }

    fn settle(graph: &mut Graph, arrivals: &[EdgeEnd]) -> RoundCounts {
        let orbits = Orbits {
            group: SymmetryGroup::trivial(),
            shape: PointShape::of(&system()),
            seed: 1,
        };
        graph.settle(arrivals, &orbits, 2)
    }

    fn back(arrival: EdgeEnd) -> EdgeEnd {
        let mut back = arrival;
        back.path.source.direction = Direction::Back;
        back
    }

    fn open_batches(graph: &Graph) -> Vec<(usize, Direction, u16, Vec<u32>)> {
        let batches = graph.open_batches(None).into_iter();
        batches
            .map(|batch| (batch.edge, batch.direction, batch.attempt, batch.sources))
            .collect()
    }

    #[test]
    fn everything_is_tracked_once() {
        let mut graph = graph();
        assert_eq!(
            open_batches(&graph),
            [(0, Direction::Ahead, 0, vec![0, 1, 2])]
        );
        let arrivals = [arrival(0, 0, 0.7), arrival(1, 0, 0.8), arrival(2, 0, 0.9)];
        assert_eq!(settle(&mut graph, &arrivals), RoundCounts::default());
        assert_eq!(
            (open_batches(&graph), graph.vertices[1].points.len()),
            (vec![], 3)
        );
        assert_eq!(graph.stored(1, &[2, 0]).point(0)[0].re, 0.9);
    }

    /// Known points without a partner at the far end are tracked back, and nothing is tracked both ways.
    #[test]
    fn an_edge_is_tracked_from_where_more_is_known() {
        let mut graph = graph();
        let arrivals = [arrival(0, 0, 0.7), arrival(1, 0, 0.8), arrival(2, 0, 0.9)];
        settle(&mut graph, &arrivals);
        graph.add_point(1, at(0.6));
        graph.add_edge(0, 1, 2, true);
        let back_alone = (0, Direction::Back, 0, vec![3]);
        let all_back = (1, Direction::Back, 0, vec![0, 1, 2, 3]);
        assert_eq!(open_batches(&graph), [back_alone, all_back.clone()]);
        let arrivals_back = [back(arrival(3, 0, 0.4))];
        assert_eq!(settle(&mut graph, &arrivals_back), RoundCounts::default());
        assert_eq!(graph.vertices[0].points.len(), 4);
        let to = |point| Correspondence::To { point, attempt: 0 };
        assert_eq!(
            graph.edges[0].correspondences,
            [0, 1].map(|_| [0, 1, 2, 3].map(to).to_vec())
        );
        // As much is known on both sides now.
        assert_eq!(
            open_batches(&graph),
            [(1, Direction::Ahead, 0, vec![0, 1, 2, 3])]
        );
    }

    /// The edge with two pairs leads to more new points a path; where it would bring all that is
    /// missing, the other one waits.
    #[test]
    fn where_the_number_is_known_the_best_edges_are_tracked_first() {
        let mut graph = graph();
        graph.add_point(0, at(0.4));
        graph.add_edge(0, 1, 2, true);
        settle(&mut graph, &[arrival(0, 0, 0.7), arrival(1, 0, 0.8)]);
        let edges = |expected_points: Option<usize>| -> Vec<(usize, usize)> {
            let batches = graph.open_batches(expected_points).into_iter();
            batches
                .map(|batch| (batch.edge, batch.sources.len()))
                .collect()
        };
        assert_eq!(edges(None), [(0, 2), (1, 4)]);
        assert_eq!(
            edges(Some(6)),
            [(0, 2), (1, 4)],
            "2/4 of what is missing is not all"
        );
        assert_eq!(edges(Some(4)), [(0, 2)]);
    }

    /// A pair that was found from one end is broken by a path from the other that meets it.
    #[test]
    fn two_ways_that_disagree_are_tracked_again() {
        let mut graph = graph();
        let arrivals = [arrival(0, 0, 0.7), arrival(1, 0, 0.8), arrival(2, 0, 0.9)];
        settle(&mut graph, &arrivals);
        graph.add_point(1, at(0.6));
        let met = settle(&mut graph, &[back(arrival(3, 0, 0.3))]);
        assert_eq!((met.crossings, met.crossings_left), (1, 0));
        // Both that claim (0.3), and (0.3) itself; the far end knows more.
        assert_eq!(open_batches(&graph), [(0, Direction::Back, 1, vec![2, 3])]);
        assert_eq!(
            graph.edges[0].correspondences[0][2],
            Correspondence::Open { attempt: 1 }
        );
        let repeated_arrivals = [back(arrival(2, 1, 0.3)), back(arrival(3, 1, 0.5))];
        assert_eq!(
            settle(&mut graph, &repeated_arrivals),
            RoundCounts::default()
        );
        assert_eq!(
            (open_batches(&graph), graph.vertices[0].points.len()),
            (vec![], 4)
        );
    }

    #[test]
    fn two_paths_to_one_point_are_tracked_again_even_if_one_came_earlier() {
        let mut graph = graph();
        let first = [arrival(0, 0, 0.7), arrival(1, 0, 0.8)];
        settle(&mut graph, &first);
        let third = settle(&mut graph, &[arrival(2, 0, 0.8)]);
        assert_eq!((third.crossings, third.crossings_left), (1, 0));
        assert_eq!(open_batches(&graph), [(0, Direction::Ahead, 1, vec![1, 2])]);
        let repeat_outcome = settle(&mut graph, &[arrival(1, 1, 0.8), arrival(2, 1, 0.9)]);
        assert_eq!(repeat_outcome, RoundCounts::default());
        assert_eq!(
            (open_batches(&graph), graph.vertices[1].points.len()),
            (vec![], 3)
        );
    }

    #[test]
    fn what_never_parts_or_arrives_is_named() {
        let mut graph = graph();
        let nowhere = |attempt| EdgeEnd {
            end: None,
            ..arrival(2, attempt, 0.0)
        };
        let mut total = RoundCounts::default();
        for attempt in 0..3 {
            let round = [
                arrival(0, attempt, 0.7),
                arrival(1, attempt, 0.7),
                nowhere(attempt),
            ];
            total += settle(&mut graph, &round);
        }
        assert_eq!((total.crossings_left, total.lost), (1, 1));
        let kept = |attempt| Correspondence::To { point: 0, attempt };
        assert_eq!(
            graph.edges[0].correspondences[0],
            [kept(2), Correspondence::Lost, Correspondence::Lost]
        );
        assert!(matches!(
            graph.edges[0].correspondences[1][..],
            [Correspondence::To { point: 0, .. }]
        ));
        assert_eq!(open_batches(&graph), []);
    }
}
