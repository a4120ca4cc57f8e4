//! Graph: parameter values with what is known to solve the system there, and the paths between them.
//!
//! Tracking all solutions at one vertex along an edge permutes them, up to
//! their names: an edge is a bijection between the orbits at its ends. Paths
//! that break it have jumped, and are tracked again more tightly (compare
//! Duff, Hill, Jensen, Lee, Leykin, Sommars: Solving polynomial systems via
//! homotopy continuation and monodromy, 2019). Every edge has one direction:
//! two edges with different detours make a loop, and m edges between two
//! vertices make m - 1 loops for m paths a solution, whichever way they lead.

use cognate_continuation::start_points::StoredPoints;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::symmetry::SymmetryGroup;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
    /// One for each parameter of the system.
    pub parameters: Vec<Complex64>,
    /// What is known there, one of each orbit, in the order in which they were found.
    pub points: Vec<Known>,
}

/// What became of one source point on an edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Fate {
    /// It is to be tracked, for the first time or again.
    Open { attempt: u16 },
    /// It leads to this point of the edge's other end.
    To { point: u32, attempt: u16 },
    /// Nothing more is tried.
    Lost,
}

/// A path between two vertices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Edge {
    pub from: usize,
    pub to: usize,
    /// Seed of its detour.
    pub seed: u64,
    /// Different orbits lead to different orbits.
    pub bijective: bool,
    /// For each point of `from`.
    pub fates: Vec<Fate>,
}

/// What tracking showed about one source.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arrival {
    pub edge: usize,
    pub source: u32,
    pub attempt: u16,
    /// Where it arrived; `None` where it arrived nowhere.
    pub end: Option<Known>,
}

/// What happened when arrivals were taken in.
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

    /// An edge along which everything that is known is to be tracked.
    pub fn add_edge(&mut self, from: usize, to: usize, seed: u64, bijective: bool) {
        let known = self.vertices[from].points.len();
        self.edges.push(Edge {
            from,
            to,
            seed,
            bijective,
            fates: vec![Fate::Open { attempt: 0 }; known],
        });
    }

    /// What is to be tracked: for each edge and attempt the sources, ascending.
    pub fn open(&self) -> Vec<(usize, u16, Vec<u32>)> {
        let mut open = BTreeMap::<(usize, u16), Vec<u32>>::new();
        for (number, edge) in self.edges.iter().enumerate() {
            for (source, fate) in edge.fates.iter().enumerate() {
                if let Fate::Open { attempt } = fate {
                    open.entry((number, *attempt))
                        .or_default()
                        .push(source as u32);
                }
            }
        }
        let open = open.into_iter();
        open.map(|((edge, attempt), sources)| (edge, attempt, sources))
            .collect()
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
        for edge in self.edges.iter_mut().filter(|edge| edge.from == vertex) {
            edge.fates.push(Fate::Open { attempt: 0 });
        }
        number
    }

    /// Once the group is known: points of one orbit become one, before any edge leads away.
    ///
    /// # Panics
    /// When an edge leads away already.
    pub fn merge(&mut self, vertex: usize, group: &SymmetryGroup, shape: &PointShape, seed: u64) {
        assert!(
            self.edges.iter().all(|edge| edge.from != vertex),
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
        for edge in self.edges.iter_mut().filter(|edge| edge.to == vertex) {
            for fate in &mut edge.fates {
                if let Fate::To { point, .. } = fate {
                    *point = names[*point as usize];
                }
            }
        }
    }

    /// Adds what is not known at a vertex; returns how many orbits that are.
    pub fn learn(
        &mut self,
        vertex: usize,
        found: &[Known],
        group: &SymmetryGroup,
        shape: &PointShape,
        seed: u64,
    ) -> usize {
        let points = &self.vertices[vertex].points;
        let known = points.len();
        let all: Vec<(&[Complex64], f64)> = points
            .iter()
            .chain(found)
            .map(|point| (point.values.as_slice(), point.radius))
            .collect();
        let orbits = group.orbits(&all, shape, seed);
        let new = orbits.iter().filter(|orbit| orbit[0] >= known);
        let new: Vec<Known> = new.map(|orbit| found[orbit[0] - known].clone()).collect();
        for point in &new {
            self.add_point(vertex, point.clone());
        }
        new.len()
    }

    /// The points that all of a vertex lead to along one edge; `None` while one does not.
    pub fn reached(&self, edge: usize) -> Option<Vec<&Known>> {
        let Edge { to, fates, .. } = &self.edges[edge];
        let points = &self.vertices[*to].points;
        let reached = fates.iter().map(|fate| match fate {
            Fate::To { point, .. } => Some(&points[*point as usize]),
            Fate::Open { .. } | Fate::Lost => None,
        });
        reached.collect()
    }

    /// Takes in what a round of tracking showed. The order of arrivals decides the names of new
    /// points, nothing else. A path is tried again up to `most` times.
    pub fn settle(
        &mut self,
        arrivals: &[Arrival],
        group: &SymmetryGroup,
        shape: &PointShape,
        seed: u64,
        most: u16,
    ) -> Settled {
        let mut settled = Settled::default();
        for arrival in arrivals.iter().filter(|arrival| arrival.end.is_none()) {
            settled.lost +=
                u64::from(!self.again(arrival.edge, arrival.source, arrival.attempt, most));
        }
        for vertex in 0..self.vertices.len() {
            let here: Vec<(&Arrival, &Known)> = arrivals
                .iter()
                .filter(|arrival| self.edges[arrival.edge].to == vertex)
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
        here: &[(&Arrival, &Known)],
        group: &SymmetryGroup,
        shape: &PointShape,
        seed: u64,
        most: u16,
        settled: &mut Settled,
    ) {
        let known = self.vertices[vertex].points.len();
        let points: Vec<(&[Complex64], f64)> = self.vertices[vertex]
            .points
            .iter()
            .chain(here.iter().map(|(_, end)| *end))
            .map(|point| (point.values.as_slice(), point.radius))
            .collect();
        let orbits = group.orbits(&points, shape, seed);
        // For each edge and target point: who claims to lead there.
        let mut claims = BTreeMap::<(usize, u32), Vec<(u32, u16)>>::new();
        for orbit in orbits {
            let split = orbit.partition_point(|&member| member < known);
            let (old, new) = orbit.split_at(split);
            if new.is_empty() {
                continue;
            }
            let arrived = new.iter().map(|&member| here[member - known]);
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
                        let (edge, source) = (arrival.edge, arrival.source);
                        let again = self.again(edge, source, arrival.attempt, most);
                        settled.lost += u64::from(!again);
                    }
                    continue;
                }
            };
            for (arrival, _) in arrived {
                let claim = claims.entry((arrival.edge, target)).or_default();
                claim.push((arrival.source, arrival.attempt));
            }
        }
        let mut before = BTreeMap::<(usize, u32), Vec<(u32, u16)>>::new();
        for (number, edge) in self.edges.iter().enumerate() {
            if edge.to != vertex || !edge.bijective {
                continue;
            }
            for (source, fate) in edge.fates.iter().enumerate() {
                if let Fate::To { point, attempt } = fate {
                    let sources = before.entry((number, *point)).or_default();
                    sources.push((source as u32, *attempt));
                }
            }
        }
        for ((edge, target), mut sources) in claims {
            sources.extend(before.remove(&(edge, target)).into_iter().flatten());
            sources.sort_unstable();
            let crossed = self.edges[edge].bijective && sources.len() > 1;
            let mut all_again = true;
            for (place, &(source, attempt)) in sources.iter().enumerate() {
                let arrived = Fate::To {
                    point: target,
                    attempt,
                };
                if crossed && (self.again(edge, source, attempt, most) || place > 0) {
                    all_again &= attempt < most;
                } else {
                    // What never comes apart leaves the target to the first.
                    all_again &= !crossed;
                    self.edges[edge].fates[source as usize] = arrived;
                }
            }
            settled.crossings += u64::from(crossed && sources.iter().any(|s| s.1 == 0));
            settled.crossings_left += u64::from(crossed && !all_again);
        }
    }

    /// Lets a source be tracked again, more tightly; false where that was done often enough.
    fn again(&mut self, edge: usize, source: u32, attempt: u16, most: u16) -> bool {
        let may = attempt < most;
        self.edges[edge].fates[source as usize] = if may {
            Fate::Open {
                attempt: attempt + 1,
            }
        } else {
            Fate::Lost
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

    fn arrival(source: u32, attempt: u16, x: f64) -> Arrival {
        Arrival {
            edge: 0,
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

    fn settle(graph: &mut Graph, arrivals: &[Arrival]) -> Settled {
        let system = system();
        let group = SymmetryGroup::of(&system).unwrap();
        graph.settle(arrivals, &group, &PointShape::of(&system), 1, 2)
    }

    #[test]
    fn everything_is_tracked_once() {
        let mut graph = graph();
        assert_eq!(graph.open(), [(0, 0, vec![0, 1, 2])]);
        let all = [arrival(0, 0, 0.7), arrival(1, 0, 0.8), arrival(2, 0, 0.9)];
        assert_eq!(settle(&mut graph, &all), Settled::default());
        assert_eq!((graph.open(), graph.vertices[1].points.len()), (vec![], 3));
        assert_eq!(graph.stored(1, &[2, 0]).point(0)[0].re, 0.9);
    }

    #[test]
    fn two_paths_to_one_point_are_tracked_again_even_if_one_came_earlier() {
        let mut graph = graph();
        let first = [arrival(0, 0, 0.7), arrival(1, 0, 0.8)];
        settle(&mut graph, &first);
        let third = settle(&mut graph, &[arrival(2, 0, 0.8)]);
        assert_eq!((third.crossings, third.crossings_left), (1, 0));
        assert_eq!(graph.open(), [(0, 1, vec![1, 2])]);
        let again = settle(&mut graph, &[arrival(1, 1, 0.8), arrival(2, 1, 0.9)]);
        assert_eq!(again, Settled::default());
        assert_eq!((graph.open(), graph.vertices[1].points.len()), (vec![], 3));
    }

    #[test]
    fn what_never_parts_or_arrives_is_named() {
        let mut graph = graph();
        let nowhere = |attempt| Arrival {
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
        let kept = Fate::To {
            point: 0,
            attempt: 2,
        };
        assert_eq!(graph.edges[0].fates, [kept, Fate::Lost, Fate::Lost]);
        assert_eq!(graph.open(), []);
    }
}
