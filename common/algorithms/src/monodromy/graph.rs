//! Graph: parameter values with what is known to solve the system there, and the paths between them.
//!
//! Tracking all solutions at one vertex along an edge permutes them, up to
//! their names: an edge is a bijection between the orbits at its ends, and a
//! path along it shows one pair of it, whichever end the path began at (Duff,
//! Hill, Jensen, Lee, Leykin, Sommars: Solving polynomial systems via homotopy
//! continuation and monodromy, 2019). Paths that break it have jumped, and are
//! tracked again more tightly. So an edge costs one path a solution, and each
//! edge more than a tree needs makes a loop more.

use cognate_continuation::start_points::StoredPoints;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::symmetry::SymmetryGroup;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A solution, which stands for its orbit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Known {
    /// Values of the variables.
    pub values: Vec<Complex64>,
    /// Within what distance another point is the same: half of the sum.
    pub radius: f64,
}

/// Values of the parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Vertex {
    /// Values, one for each parameter of the system.
    pub parameters: Vec<Complex64>,
    /// Known solutions at these parameters, one of each orbit, in the order in which they were found.
    pub points: Vec<Known>,
}

/// Partner of one point at the other end of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Correspondence {
    /// The partner is not known: the point is to be tracked, for the first time or again.
    Open { attempt: u16 },
    /// The partner is this point at the other end of the edge.
    To { point: u32, attempt: u16 },
    /// Nothing more is tried.
    Lost,
}

/// Direction in which an edge is tracked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum Direction {
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
pub(crate) struct Edge {
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
        match self.bijective {
            true => &[Direction::Ahead, Direction::Back],
            false => &[Direction::Ahead],
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
        let correspondences = self.correspondences[0].iter();
        correspondences
            .filter(|correspondence| matches!(correspondence, Correspondence::To { .. }))
            .count()
    }
}

/// Paths that can be tracked together: of one edge, one direction, and equally tight.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Wanted {
    pub edge: usize,
    pub direction: Direction,
    pub attempt: u16,
    /// Points of the vertex where they begin, ascending.
    pub sources: Vec<u32>,
}

/// Result of tracking one source along an edge.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EdgeEnd {
    pub edge: usize,
    pub direction: Direction,
    pub source: u32,
    pub attempt: u16,
    /// End of the path; `None` if the path arrived nowhere.
    pub end: Option<Known>,
}

/// A point on an edge: the edge, the direction in which it is a source, and its number there.
type Key = (usize, Direction, u32);

impl EdgeEnd {
    fn key(&self) -> Key {
        (self.edge, self.direction, self.source)
    }
}

/// Counts of the events when arrivals were taken in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Settled {
    /// Meetings of paths on a bijective edge, seen for the first time.
    pub crossings: u64,
    /// Meetings that were given up: all paths of it but one are lost.
    pub crossings_left: u64,
    /// Paths that arrived nowhere, or not clearly, and are not tried again.
    pub lost: u64,
}

/// Vertices and edges.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Graph {
    pub vertices: Vec<Vertex>,
    pub edges: Vec<Edge>,
}

impl Graph {
    /// A vertex where nothing is known yet; returns its number.
    pub fn add_vertex(&mut self, parameters: Vec<Complex64>) -> usize {
        self.vertices.push(Vertex {
            parameters,
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

    /// Points to be tracked next; empty when all pairs of all edges are known.
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
    pub fn wanted(&self, expected_points: Option<usize>) -> Vec<Wanted> {
        let point_count = |vertex: usize| self.vertices[vertex].points.len();
        let mut chosen = BTreeMap::<usize, Vec<(usize, Direction)>>::new();
        for (number, edge) in self.edges.iter().enumerate() {
            let directions = edge
                .directions()
                .iter()
                .filter(|&&direction| edge.open(direction) > 0);
            let best = directions
                .max_by_key(|&&direction| (point_count(edge.source(direction)), direction.other()));
            if let Some(&direction) = best {
                chosen
                    .entry(edge.target(direction))
                    .or_default()
                    .push((number, direction));
            }
        }
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
        let mut wanted = Vec::new();
        for (number, direction) in chosen {
            let mut open = BTreeMap::<u16, Vec<u32>>::new();
            let correspondences = self.edges[number].correspondences[direction as usize].iter();
            for (source, correspondence) in correspondences.enumerate() {
                if let Correspondence::Open { attempt } = correspondence {
                    open.entry(*attempt).or_default().push(source as u32);
                }
            }
            wanted.extend(open.into_iter().map(|(attempt, sources)| Wanted {
                edge: number,
                direction,
                attempt,
                sources,
            }));
        }
        wanted
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

    fn add_point(&mut self, vertex: usize, point: Known) -> u32 {
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

    /// Once the group is known: points of one orbit become one, before any edge can be tracked from
    /// there.
    ///
    /// # Panics
    /// When one can already.
    pub fn merge(&mut self, vertex: usize, group: &SymmetryGroup, shape: &PointShape, seed: u64) {
        assert!(
            self.edges.iter().all(|edge| edge
                .directions()
                .iter()
                .all(|&direction| edge.source(direction) != vertex)),
            "points are merged before their names are used"
        );
        let points = &self.vertices[vertex].points;
        let listed: Vec<(&[Complex64], f64)> = points
            .iter()
            .map(|point| (point.values.as_slice(), point.radius))
            .collect();
        let orbits = group.orbits(&listed, shape, seed);
        let mut names = vec![0; points.len()];
        for (name, orbit) in orbits.iter().enumerate() {
            for &member in orbit {
                names[member] = name as u32;
            }
        }
        let kept = orbits.iter().map(|orbit| points[orbit[0]].clone());
        self.vertices[vertex].points = kept.collect();
        for edge in self.edges.iter_mut().filter(|edge| edge.ends[1] == vertex) {
            for correspondence in &mut edge.correspondences[0] {
                if let Correspondence::To { point, .. } = correspondence {
                    *point = names[*point as usize];
                }
            }
        }
    }

    /// Adds what is not known at a vertex; returns how many orbits that are.
    pub fn learn(
        &mut self,
        vertex: usize,
        solutions: &[Known],
        group: &SymmetryGroup,
        shape: &PointShape,
        seed: u64,
    ) -> usize {
        let points = &self.vertices[vertex].points;
        let vertex_points = points.len();
        let balls: Vec<(&[Complex64], f64)> = points
            .iter()
            .chain(solutions)
            .map(|point| (point.values.as_slice(), point.radius))
            .collect();
        let orbits = group.orbits(&balls, shape, seed);
        let new = orbits.iter().filter(|orbit| orbit[0] >= vertex_points);
        let new: Vec<Known> = new
            .map(|orbit| solutions[orbit[0] - vertex_points].clone())
            .collect();
        for point in &new {
            self.add_point(vertex, point.clone());
        }
        new.len()
    }

    /// Number of different points to which an edge leads.
    pub fn targets(&self, edge: usize) -> usize {
        let correspondences = self.edges[edge].correspondences[0].iter();
        let points = correspondences.filter_map(|correspondence| match correspondence {
            Correspondence::To { point, .. } => Some(*point),
            Correspondence::Open { .. } | Correspondence::Lost => None,
        });
        points.collect::<BTreeSet<u32>>().len()
    }

    /// The points that all of a vertex lead to along one edge, ahead; `None` while one does not.
    pub fn reached(&self, edge: usize) -> Option<Vec<&Known>> {
        let Edge {
            ends,
            correspondences,
            ..
        } = &self.edges[edge];
        let points = &self.vertices[ends[1]].points;
        let reached = correspondences[0]
            .iter()
            .map(|correspondence| match correspondence {
                Correspondence::To { point, .. } => Some(&points[*point as usize]),
                Correspondence::Open { .. } | Correspondence::Lost => None,
            });
        reached.collect()
    }

    /// Permutations of the points of the first vertex by the independent loops through these vertices, which begin
    /// there: for each edge that closes a loop, the number of the edge and the image of each point, as far as it is
    /// known. The first edge to a vertex is part of a tree and closes no loop.
    pub fn permutations(&self, places: &[usize]) -> Vec<(usize, Vec<Option<u32>>)> {
        let count = |vertex: usize| self.vertices[vertex].points.len();
        let Some(&base) = places.first() else {
            return Vec::new();
        };
        // From the points of the base to those of each vertex, along the tree.
        let mut along = BTreeMap::<usize, Vec<Option<u32>>>::new();
        along.insert(base, (0..count(base) as u32).map(Some).collect());
        let mut loops = Vec::new();
        for (number, edge) in self.edges.iter().enumerate() {
            let [from, to] = edge.ends;
            let inside = edge.bijective && places.contains(&from) && places.contains(&to);
            let Some(here) = along.get(&from).filter(|_| inside) else {
                continue;
            };
            let step = |point: u32| match edge.correspondences[0][point as usize] {
                Correspondence::To { point, .. } => Some(point),
                Correspondence::Open { .. } | Correspondence::Lost => None,
            };
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
            loops.push((number, around.collect()));
        }
        loops
    }

    /// Takes in what a round of tracking showed. The order of arrivals decides the names of new
    /// points, nothing else. A path is tried again up to `most` times.
    pub fn settle(
        &mut self,
        arrivals: &[EdgeEnd],
        group: &SymmetryGroup,
        shape: &PointShape,
        seed: u64,
        most: u16,
    ) -> Settled {
        let mut settled = Settled::default();
        for arrival in arrivals.iter().filter(|arrival| arrival.end.is_none()) {
            settled.lost += u64::from(!self.again(arrival.key(), arrival.attempt, most));
        }
        for vertex in 0..self.vertices.len() {
            let here: Vec<(&EdgeEnd, &Known)> = arrivals
                .iter()
                .filter(|arrival| self.edges[arrival.edge].target(arrival.direction) == vertex)
                .filter_map(|arrival| Some((arrival, arrival.end.as_ref()?)))
                .collect();
            if !here.is_empty() {
                self.settle_at(vertex, &here, group, shape, seed, most, &mut settled);
            }
        }
        settled
    }

    #[allow(clippy::too_many_arguments)]
    fn settle_at(
        &mut self,
        vertex: usize,
        here: &[(&EdgeEnd, &Known)],
        group: &SymmetryGroup,
        shape: &PointShape,
        seed: u64,
        most: u16,
        settled: &mut Settled,
    ) {
        let vertex_points = self.vertices[vertex].points.len();
        let points: Vec<(&[Complex64], f64)> = self.vertices[vertex]
            .points
            .iter()
            .chain(here.iter().map(|(_, end)| *end))
            .map(|point| (point.values.as_slice(), point.radius))
            .collect();
        let orbits = group.orbits(&points, shape, seed);
        // For each edge, direction and target point: who claims to lead there.
        let mut claims = BTreeMap::<(usize, Direction, u32), Vec<(u32, u16)>>::new();
        for orbit in orbits {
            let split = orbit.partition_point(|&member| member < vertex_points);
            let (old, new) = orbit.split_at(split);
            if new.is_empty() {
                continue;
            }
            let arrived = new.iter().map(|&member| here[member - vertex_points]);
            let target = match old {
                [] => {
                    let best = arrived
                        .clone()
                        .min_by(|a, b| a.1.radius.total_cmp(&b.1.radius))
                        .expect("an orbit has a member");
                    self.add_point(vertex, best.1.clone())
                }
                [one] => *one as u32,
                // Too inaccurate to tell two known points apart.
                _ => {
                    for (arrival, _) in arrived {
                        let is_repeated = self.again(arrival.key(), arrival.attempt, most);
                        settled.lost += u64::from(!is_repeated);
                    }
                    continue;
                }
            };
            for (arrival, _) in arrived {
                let claim = (arrival.edge, arrival.direction, target);
                let claim = claims.entry(claim).or_default();
                claim.push((arrival.source, arrival.attempt));
            }
        }
        for ((edge, direction, target), mut sources) in claims {
            let bijective = self.edges[edge].bijective;
            if bijective {
                // The earlier partner of the target, tracked in either direction.
                let before =
                    self.edges[edge].correspondences[direction.other() as usize][target as usize];
                if let Correspondence::To { point, .. } = before {
                    let attempt = self.attempt((edge, direction, point));
                    sources.push((point, attempt));
                }
            }
            sources.sort_unstable();
            let crossed = bijective && sources.len() > 1;
            if crossed {
                // The target's own partner is looked for again, if the target needs one.
                let key = (edge, direction.other(), target);
                let attempt = (self.attempt(key) + 1).min(most);
                *self.correspondence(key) = Correspondence::Open { attempt };
            }
            let mut all_again = true;
            for (place, &(source, attempt)) in sources.iter().enumerate() {
                if crossed && (self.again((edge, direction, source), attempt, most) || place > 0) {
                    all_again &= attempt < most;
                } else {
                    // Paths that never come apart leave the target to the first of them.
                    all_again &= !crossed;
                    self.pair((edge, direction, source), attempt, target);
                }
            }
            settled.crossings += u64::from(crossed && sources.iter().any(|s| s.1 == 0));
            settled.crossings_left += u64::from(crossed && !all_again);
        }
    }

    fn correspondence(&mut self, (edge, direction, point): Key) -> &mut Correspondence {
        &mut self.edges[edge].correspondences[direction as usize][point as usize]
    }

    /// How often a point was tracked again; of one that is lost, as if it could be again.
    fn attempt(&self, (edge, direction, point): Key) -> u16 {
        match self.edges[edge].correspondences[direction as usize][point as usize] {
            Correspondence::Open { attempt } | Correspondence::To { attempt, .. } => attempt,
            Correspondence::Lost => u16::MAX - 1,
        }
    }

    /// Notes that a source has been tracked to a target, for both.
    fn pair(&mut self, key: Key, attempt: u16, target: u32) {
        let (edge, direction, source) = key;
        *self.correspondence(key) = Correspondence::To {
            point: target,
            attempt,
        };
        if self.edges[edge].bijective {
            let partner = (edge, direction.other(), target);
            let attempt = self.attempt(partner);
            *self.correspondence(partner) = Correspondence::To {
                point: source,
                attempt,
            };
        }
    }

    /// Lets a source be tracked again, more tightly; false where that was done often enough.
    fn again(&mut self, key: Key, attempt: u16, most: u16) -> bool {
        let may = attempt < most;
        *self.correspondence(key) = if may {
            Correspondence::Open {
                attempt: attempt + 1,
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

    /// The point x = `x` in one variable.
    fn at(x: f64) -> Known {
        Known {
            values: vec![Complex64::new(x, 0.0)],
            radius: 1e-10,
        }
    }

    fn arrival(source: u32, attempt: u16, x: f64) -> EdgeEnd {
        EdgeEnd {
            edge: 0,
            direction: Direction::Ahead,
            source,
            attempt,
            end: Some(at(x)),
        }
    }

    /// Two vertices, three points at the first, one edge.
    fn graph() -> Graph {
        let mut graph = Graph::default();
        let (a, b) = (graph.add_vertex(vec![]), graph.add_vertex(vec![]));
        for x in [0.1, 0.2, 0.3] {
            graph.add_point(a, at(x));
        }
        graph.add_edge(a, b, 1, true);
        graph
    }

    fn settle(graph: &mut Graph, arrivals: &[EdgeEnd]) -> Settled {
        let system = system();
        let group = SymmetryGroup::of(&system).unwrap();
        graph.settle(arrivals, &group, &PointShape::of(&system), 1, 2)
    }

    fn back(arrival: EdgeEnd) -> EdgeEnd {
        EdgeEnd {
            direction: Direction::Back,
            ..arrival
        }
    }

    fn wanted(graph: &Graph) -> Vec<(usize, Direction, u16, Vec<u32>)> {
        let wanted = graph.wanted(None).into_iter();
        wanted
            .map(|w| (w.edge, w.direction, w.attempt, w.sources))
            .collect()
    }

    #[test]
    fn everything_is_tracked_once() {
        let mut graph = graph();
        assert_eq!(wanted(&graph), [(0, Direction::Ahead, 0, vec![0, 1, 2])]);
        let arrivals = [arrival(0, 0, 0.7), arrival(1, 0, 0.8), arrival(2, 0, 0.9)];
        assert_eq!(settle(&mut graph, &arrivals), Settled::default());
        assert_eq!(
            (wanted(&graph), graph.vertices[1].points.len()),
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
        assert_eq!(wanted(&graph), [back_alone, all_back.clone()]);
        let arrivals_back = [back(arrival(3, 0, 0.4))];
        assert_eq!(settle(&mut graph, &arrivals_back), Settled::default());
        assert_eq!(graph.vertices[0].points.len(), 4);
        let to = |point| Correspondence::To { point, attempt: 0 };
        assert_eq!(
            graph.edges[0].correspondences,
            [0, 1].map(|_| [0, 1, 2, 3].map(to).to_vec())
        );
        // As much is known on both sides now.
        assert_eq!(wanted(&graph), [(1, Direction::Ahead, 0, vec![0, 1, 2, 3])]);
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
            let wanted = graph.wanted(expected_points).into_iter();
            wanted.map(|w| (w.edge, w.sources.len())).collect()
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
        assert_eq!(wanted(&graph), [(0, Direction::Back, 1, vec![2, 3])]);
        assert_eq!(
            graph.edges[0].correspondences[0][2],
            Correspondence::Open { attempt: 1 }
        );
        let repeated_arrivals = [back(arrival(2, 1, 0.3)), back(arrival(3, 1, 0.5))];
        assert_eq!(settle(&mut graph, &repeated_arrivals), Settled::default());
        assert_eq!(
            (wanted(&graph), graph.vertices[0].points.len()),
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
        assert_eq!(wanted(&graph), [(0, Direction::Ahead, 1, vec![1, 2])]);
        let repeat_outcome = settle(&mut graph, &[arrival(1, 1, 0.8), arrival(2, 1, 0.9)]);
        assert_eq!(repeat_outcome, Settled::default());
        assert_eq!(
            (wanted(&graph), graph.vertices[1].points.len()),
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
        let mut total = Settled::default();
        for attempt in 0..3 {
            let round = [
                arrival(0, attempt, 0.7),
                arrival(1, attempt, 0.7),
                nowhere(attempt),
            ];
            let settled = settle(&mut graph, &round);
            total.crossings_left += settled.crossings_left;
            total.lost += settled.lost;
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
        assert_eq!(wanted(&graph), []);
    }
}
