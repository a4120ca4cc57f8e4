//! Monodromy: all solutions of a generic member of a family, from one of them.
//!
//! The start solutions are followed to random complex parameters, the base.
//! From there loops are made, in a graph of random parameters with several
//! detours between each two; every solution that turns up anywhere takes part in
//! all of them, whichever way leads to more new ones. When some loops in a row
//! bring nothing new, all that is known at the base is followed
//! to the parameters that are asked for. With a symmetry group one solution of
//! each orbit is tracked. A jump of a path cannot make a false solution here,
//! it only breaks the bijection of a leg, and that is seen ([`graph`]).

mod completeness;
pub mod counts;
pub mod estimate;
mod fresh_loops;
pub(crate) mod graph;
mod idle_loops;
mod loop_limits;
mod places;
pub mod trace;

use crate::answer::{Answer, FoundByLoops, IsolatedSolutions};
use crate::completeness_claim::CompletenessClaim;
use crate::finite_endpoints::FiniteEndpoints;
use crate::limits::MAX_PATHS;
use crate::opening::Opening;
use crate::parameter_solve::ParameterSolve;
use crate::plan_error::PlanError;
use crate::progress::{self, Progress, StageProgress, VerdictCounts};
use crate::retried_stage::{MAX_RETRIES, can_be_helped};
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::homotopies::{HomotopyKind, way_back};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::counted::counted;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::{Tolerances, Verdict, classify};
use cognate_solutions::path_crossing::radius;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::{History, SolutionSet};
use cognate_solutions::symmetry::SymmetryGroup;
use cognate_systems::system::System;
use counts::{LoopCounts, Stop, Tested};
use graph::{Correspondence, Direction, EdgeEnd, Graph, Known, Wanted};
pub use loop_limits::{LoopLimits, MOST_IDLE};
use num_complex::Complex64;
use places::{Sizes, generic_parameters};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use trace::{Curve, Test};

/// Vertex at whose parameters the start solutions solve the system; no edge leads back there.
const START: usize = 0;
/// Vertex where the loops begin and end.
const BASE: usize = 1;
/// The edge from one to the other.
const FIRST: usize = 0;

/// A batch of a round: the sources that one stage tracks along an edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Batch {
    wanted: Wanted,
    /// Number of the stage, once it is open.
    stage: Option<StageId>,
    results: Option<Vec<PathResult>>,
}

/// Step of a solve by monodromy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// Paths between vertices, round by round: each round has one stage for each edge with open
    /// sources, and is taken in when all are back, in the order of edges.
    Loops(Vec<Batch>),
    /// The images of one solution under the group are tracked on the spot: are they solutions?
    Check(Option<StageId>),
    /// Loops among the sections of a curve, for a trace test.
    Sections(Box<MonodromySolve>),
    /// Paths from the base to the wanted parameters.
    Arrive(Box<ParameterSolve>),
    /// There is nothing to go on from, or nothing more is asked.
    Stuck,
}

/// Parameters and points of the start solutions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopStart {
    /// Parameters at which the start solutions solve the system.
    pub parameters: Vec<Complex64>,
    /// Object that holds the start solutions.
    pub points: StartPoints,
    /// Number of start solutions.
    pub count: u64,
    /// Coordinates of all start solutions, if they were found on the way: then the object is made of them.
    pub found: Option<Vec<Complex64>>,
}

/// The solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MonodromySolve {
    shape: PointShape,
    tolerances: Tolerances,
    settings: Settings,
    seed: u64,
    max_retries: u16,
    limits: LoopLimits,
    start: LoopStart,
    targets: Vec<Vec<Complex64>>,
    group: SymmetryGroup,
    /// The group is closed and was checked.
    group_known: bool,
    graph: Graph,
    phase: Phase,
    /// Distinct images of the base's points, as far as they were counted, and of how many points.
    counted: (u64, usize),
    /// Points of the base when everything was last exhausted.
    exhausted_at: usize,
    /// Edges that there were when the base last got a new point: later ones close idle loops.
    idle_from: usize,
    counts: LoopCounts,
    stages: Vec<StageProgress>,
    /// Last results of the start solutions, for when none of them leads anywhere.
    first_results: Vec<PathResult>,
    warnings: Vec<String>,
    /// Loops that were weighed already when idle ones were counted.
    weighed: u64,
    /// Test of completeness; `None` if none was asked for.
    test: Option<Test>,
    /// Points of the base that the last test was about.
    tested: Option<usize>,
    /// Curve of this family on which the loops of a trace test run.
    curve: Option<Box<Curve>>,
}

impl MonodromySolve {
    /// The solve of a checked system, whose parameters are free to move.
    pub fn new(
        system: &System,
        start: LoopStart,
        targets: Vec<Vec<Complex64>>,
        limits: LoopLimits,
        settings: Settings,
        tolerances: Tolerances,
        seed: u64,
    ) -> Result<Self, PlanError> {
        let group = SymmetryGroup::of(system)?;
        let shape = PointShape::of(system);
        let mut solve = Self::begin(shape, group, start, limits, settings, tolerances, seed);
        solve.targets = targets;
        if limits.trace_test {
            let base = &solve.graph.vertices[BASE].parameters;
            let direction = generic_parameters(base, seed, usize::MAX >> 1, Sizes::Own);
            let test = Test::new(system, base, direction, seed);
            solve.test = Some(test.map_err(PlanError::NoTraceTest)?);
        }
        Ok(solve)
    }

    /// A solve without targets: it ends with its loops.
    fn begin(
        shape: PointShape,
        group: SymmetryGroup,
        start: LoopStart,
        limits: LoopLimits,
        settings: Settings,
        tolerances: Tolerances,
        seed: u64,
    ) -> Self {
        let mut graph = Graph::default();
        graph.add_vertex(start.parameters.clone());
        let base = generic_parameters(&start.parameters, seed, BASE, Sizes::Own);
        graph.add_vertex(base);
        graph.add_edge(START, BASE, edge_seed(seed, FIRST), false);
        let count = usize::try_from(start.count).expect("a plan has no more paths than its limit");
        graph.edges[FIRST].correspondences[0] = vec![Correspondence::Open { attempt: 0 }; count];
        Self {
            shape,
            tolerances,
            settings,
            seed,
            max_retries: MAX_RETRIES,
            limits,
            start,
            targets: Vec::new(),
            group_known: group.is_trivial(),
            group,
            graph,
            phase: Phase::Loops(Vec::new()),
            counted: (0, 0),
            exhausted_at: 0,
            idle_from: FIRST + 1,
            counts: LoopCounts {
                group_order: 1,
                ..LoopCounts::default()
            },
            stages: Vec::new(),
            first_results: Vec::new(),
            warnings: Vec::new(),
            weighed: 0,
            test: None,
            tested: None,
            curve: None,
        }
    }

    /// Replaces the limit of repetitions of a path.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.max_retries = max_retries;
        self
    }

    /// Counts of the loops so far.
    pub fn counts(&self) -> &LoopCounts {
        &self.counts
    }

    /// A stage along a path of parameters.
    fn stage(&self, from: &[Complex64], to: &[Complex64], seed: u64, points: StartPoints) -> Stage {
        Stage {
            id: StageId(0),
            system: None,
            work: Work::Track,
            homotopy: match &self.curve {
                None => HomotopyKind::Parameter {
                    start: from.to_vec(),
                    targets: vec![to.to_vec()],
                },
                Some(curve) => HomotopyKind::Sections {
                    parameters: curve.parameters.clone(),
                    direction: curve.direction.clone(),
                    start: from.to_vec(),
                    target: to.to_vec(),
                },
            },
            start_points: points,
            settings: self.settings.clone(),
            seed,
            attempt: 0,
        }
    }

    /// The stage that tracks these paths.
    fn opening(&self, wanted: &Wanted) -> Opening {
        let Wanted {
            edge,
            direction,
            attempt,
            ref sources,
        } = *wanted;
        let e = &self.graph.edges[edge];
        let (from, to) = (e.source(direction), e.target(direction));
        let seed = match direction {
            Direction::Ahead => e.seed,
            Direction::Back => way_back(e.seed),
        };
        let (points, objects) = if edge == FIRST {
            let is_whole_start = sources.len() as u64 == self.start.count;
            let points = if is_whole_start {
                self.start.points.clone()
            } else {
                StartPoints::Selected {
                    base: Box::new(self.start.points.clone()),
                    indices: sources.iter().map(|&k| u64::from(k)).collect(),
                }
            };
            let start_object = self.start.found.iter().map(|values| {
                Arc::new(StoredPoints {
                    dimension: values.len() / self.start.count as usize,
                    coordinates: values.clone(),
                })
            });
            (points, start_object.collect())
        } else {
            let points = Arc::new(self.graph.stored(from, sources));
            (points.as_start(), vec![points])
        };
        let (from, to) = (&self.graph.vertices[from], &self.graph.vertices[to]);
        let stage = self.stage(&from.parameters, &to.parameters, seed, points);
        Opening {
            stage: Stage {
                settings: self.settings.tightened(attempt),
                attempt,
                ..stage
            },
            system: None,
            objects,
        }
    }

    /// Solutions at the base, all members of the orbits counted.
    fn count_solutions(&mut self) -> u64 {
        let (mut sum, from) = self.counted;
        let points = &self.graph.vertices[BASE].points;
        for point in &points[from..] {
            sum += self.orbit(point).len() as u64;
        }
        self.counted = (sum, points.len());
        sum
    }

    /// The different images of a point, itself first.
    fn orbit(&self, point: &Known) -> Vec<Vec<Complex64>> {
        self.group.orbit(&point.values, &self.shape)
    }

    /// Plans the next step after a round, or at the beginning. The phase is `Loops` without batches.
    fn plan_round(&mut self) {
        let open = self.graph.wanted(self.expected());
        let started = open.iter().all(|wanted| wanted.edge != FIRST);
        if started && self.graph.vertices[BASE].points.is_empty() {
            self.counts.stop = Some(Stop::NoStart);
            self.phase = Phase::Stuck;
            return;
        }
        if started && !self.group_known {
            self.close_group();
            return;
        }
        if started {
            self.counts.classes = self.graph.vertices[BASE].points.len() as u64;
            self.counts.solutions = self.count_solutions();
            let enough = self
                .limits
                .count
                .is_some_and(|n| self.counts.solutions >= n);
            let too_many = self.counts.tracked > MAX_PATHS;
            let exhausted = open.is_empty() && self.is_exhausted();
            self.counts.estimate = self.estimate();
            let stop = if enough {
                Some(Stop::Count)
            } else if self.is_confident() {
                Some(Stop::Confidence)
            } else if too_many {
                Some(Stop::PathLimit)
            } else if open.is_empty() {
                match self.test_completeness(exhausted) {
                    Tested::Complete => Some(Stop::TraceTest),
                    Tested::Begun => None,
                    Tested::No => exhausted.then_some(Stop::IdleLoops),
                }
            } else {
                None
            };
            if stop.is_some() {
                self.counts.stop = stop;
                self.arrive();
                return;
            }
            if matches!(self.phase, Phase::Sections(_)) {
                return;
            }
        }
        let mut open = self.graph.wanted(self.expected());
        if open.is_empty() {
            self.add_loops();
            open = self.graph.wanted(self.expected());
        }
        let batches = open.into_iter().map(|wanted| Batch {
            wanted,
            stage: None,
            results: None,
        });
        self.phase = Phase::Loops(batches.collect());
    }

    /// Vertices that loops lead through, the base among them.
    fn places(&self) -> impl Iterator<Item = usize> {
        (BASE..self.graph.vertices.len()).filter(|&vertex| !self.is_beside(vertex))
    }

    /// How many points a vertex has, if as many solutions are as was said and their orbits are as
    /// large as those that are known.
    fn expected(&self) -> Option<usize> {
        let (counted, points) = self.counted;
        let (count, points) = (self.limits.count?, points as u64);
        let orbits = count.saturating_mul(points).div_ceil(counted.max(1));
        usize::try_from(orbits).ok().filter(|_| counted > 0)
    }

    /// Finds the group at the first solution that is known at generic parameters.
    fn close_group(&mut self) {
        let point = self.graph.vertices[BASE].points[0].values.clone();
        match self.group.close(&point, &self.shape) {
            Ok(()) => self.phase = Phase::Check(None),
            Err(error) => self.drop_group(&error.to_string()),
        }
    }

    fn drop_group(&mut self, why: &str) {
        self.warnings
            .push(format!("the symmetry group is not used: {why}"));
        self.group = SymmetryGroup::trivial();
        self.group_known = true;
        self.phase = Phase::Loops(Vec::new());
    }

    /// The images of the first solution, and the path that stays where it is.
    fn check(&self) -> Opening {
        let base = &self.graph.vertices[BASE];
        let images = self.orbit(&base.points[0]);
        let points = Arc::new(StoredPoints {
            dimension: base.points[0].values.len(),
            coordinates: images.into_iter().flatten().collect(),
        });
        let here = &base.parameters;
        let stage = self.stage(here, here, edge_seed(self.seed, FIRST), points.as_start());
        Opening {
            stage,
            system: None,
            objects: vec![points],
        }
    }

    fn absorb_check(&mut self, results: &[PathResult]) {
        let order = self.group.order();
        let good = |result: &&PathResult| self.arrival_of(result).is_some();
        let solved = results.iter().filter(good).count();
        if solved < order {
            self.drop_group(&format!(
                "of the {order} images of a solution only {solved} are solutions"
            ));
            return;
        }
        self.group_known = true;
        self.counts.group_order = order as u64;
        self.graph.merge(BASE, &self.group, &self.shape, self.seed);
        self.phase = Phase::Loops(Vec::new());
    }

    /// End of a path, if it is a regular finite solution.
    fn arrival_of(&self, result: &PathResult) -> Option<Known> {
        let decision = classify(result, &self.shape, &self.tolerances);
        (decision.verdict == Verdict::Finite).then(|| Known {
            values: self.shape.to_variables(result.endpoint.to_double()),
            radius: radius(result, &self.tolerances),
        })
    }

    /// All batches of a round are back.
    fn settle(&mut self, batches: Vec<Batch>) {
        let mut arrivals = Vec::new();
        for Batch {
            wanted, results, ..
        } in batches
        {
            let results = results.expect("the round is complete");
            for (&source, result) in wanted.sources.iter().zip(&results) {
                let end = self.arrival_of(result);
                // A path that more attempts cannot help is not tracked again.
                let attempt = if end.is_some() || can_be_helped(result.outcome) {
                    wanted.attempt
                } else {
                    self.max_retries
                };
                arrivals.push(EdgeEnd {
                    edge: wanted.edge,
                    direction: wanted.direction,
                    source,
                    attempt,
                    end,
                });
            }
            if wanted.edge == FIRST {
                for (&source, result) in wanted.sources.iter().zip(results) {
                    let place = source as usize;
                    if place < self.first_results.len() {
                        self.first_results[place] = result;
                    } else {
                        self.first_results.push(result);
                    }
                }
            }
        }
        let settled = self.graph.settle(
            &arrivals,
            &self.group,
            &self.shape,
            self.seed,
            self.max_retries,
        );
        self.counts.lost += settled.lost;
        self.counts.crossings_found += settled.crossings;
        // A meeting is resolved until it is given up.
        self.counts.crossings_resolved += settled.crossings;
        self.counts.crossings_resolved = self
            .counts
            .crossings_resolved
            .saturating_sub(settled.crossings_left);
        self.phase = Phase::Loops(Vec::new());
    }

    /// Tracks all known solutions at the base to the wanted parameters.
    fn arrive(&mut self) {
        if self.targets.is_empty() || self.falls_short() {
            self.phase = Phase::Stuck;
            return;
        }
        let base = &self.graph.vertices[BASE];
        let points = self.arriving_points();
        let mut stage = self.stage(
            &base.parameters,
            &[],
            edge_seed(self.seed, usize::MAX),
            points.as_start(),
        );
        stage.homotopy = HomotopyKind::Parameter {
            start: base.parameters.clone(),
            targets: self.targets.clone(),
        };
        let first = Opening {
            stage,
            system: None,
            objects: vec![Arc::new(points)],
        };
        let solve = ParameterSolve::with_shape(first, &self.shape, self.tolerances.clone())
            .with_group(self.group.clone());
        self.warn_of_the_end();
        self.phase = Phase::Arrive(Box::new(solve.with_max_retries(self.max_retries)));
    }

    /// Whether loops have ended that may have missed solutions where that is no answer.
    fn falls_short(&self) -> bool {
        let stop = self.counts.stop;
        self.limits.only_complete && stop.is_some_and(|stop| stop != Stop::TraceTest)
    }

    /// All that is known at the base, orbit by orbit.
    fn arriving_points(&self) -> StoredPoints {
        let points = &self.graph.vertices[BASE].points;
        let orbit_values = points.iter().flat_map(|point| self.orbit(point)).flatten();
        StoredPoints {
            dimension: points[0].values.len(),
            coordinates: orbit_values.collect(),
        }
    }

    fn description(&self) -> String {
        let counts = &self.counts;
        let solutions = if counts.group_order > 1 {
            format!(
                "{} in {}",
                counted(counts.solutions, "solution"),
                counted(counts.classes, "class")
            )
        } else {
            counted(counts.solutions, "solution")
        };
        let open = self.stages.iter().filter(|stage| !stage.absorbed);
        let paths: u64 = open.map(|stage| stage.items).sum();
        format!(
            "monodromy: {solutions}, {} ({} idle), tracking {}",
            counted(counts.loops, "loop"),
            counts.idle_loops,
            counted(paths, "path")
        )
    }
}

fn edge_seed(seed: u64, edge: usize) -> u64 {
    RandomStream::new(seed, Purpose::Loop, edge as u64).bits()
}

impl Solve for MonodromySolve {
    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        match &self.phase {
            Phase::Arrive(solve) => solve.finite_endpoints(),
            Phase::Check(_) | Phase::Loops(_) | Phase::Sections(_) | Phase::Stuck => None,
        }
    }

    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        loop {
            match &mut self.phase {
                Phase::Arrive(solve) => return solve.next(numbers),
                Phase::Stuck => return Next::Done,
                Phase::Sections(inner) => match inner.next(numbers) {
                    Next::Done => self.take_in_sections(),
                    next => return next,
                },
                Phase::Check(Some(_)) => return Next::Wait,
                Phase::Check(None) => {
                    let next = numbers.open(self.check(), &mut self.stages);
                    self.phase = Phase::Check(self.stages.last().map(|stage| stage.id));
                    return next;
                }
                Phase::Loops(batches) => {
                    let planned = batches.iter().position(|batch| batch.stage.is_none());
                    if let Some(place) = planned {
                        let wanted = batches[place].wanted.clone();
                        let opening = self.opening(&wanted);
                        let next = numbers.open(opening, &mut self.stages);
                        if let Phase::Loops(batches) = &mut self.phase {
                            batches[place].stage = self.stages.last().map(|stage| stage.id);
                        }
                        return next;
                    }
                    if !batches.is_empty() {
                        return Next::Wait;
                    }
                    self.plan_round();
                }
            }
        }
    }

    fn absorb(&mut self, id: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        if let Phase::Arrive(solve) = &mut self.phase {
            solve.absorb(id, results);
            return;
        }
        if let Phase::Sections(inner) = &mut self.phase {
            inner.absorb(id, results);
            return;
        }
        let stage = progress::absorb(&mut self.stages, id);
        let results: Vec<PathResult> = results.map(ItemResult::into_path).collect();
        assert_eq!(
            results.len() as u64,
            stage.items,
            "a stage is absorbed as a whole"
        );
        self.counts.tracked += stage.items;
        match std::mem::replace(&mut self.phase, Phase::Stuck) {
            Phase::Check(_) => self.absorb_check(&results),
            Phase::Loops(mut batches) => {
                let batch = batches.iter_mut().find(|batch| batch.stage == Some(id));
                batch.expect("a stage belongs to a batch").results = Some(results);
                if batches.iter().all(|batch| batch.results.is_some()) {
                    self.settle(batches);
                } else {
                    self.phase = Phase::Loops(batches);
                }
            }
            Phase::Arrive(_) | Phase::Sections(_) | Phase::Stuck => {
                unreachable!("no stage is open then")
            }
        }
    }

    fn failure(&self) -> Option<String> {
        let solution_count = self.counts.solutions;
        self.falls_short().then(|| {
            format!(
                "loops through the family of the system found {solution_count} solutions of a member, and no trace test \
                 says that these are all; another seed may do, or another start"
            )
        })
    }

    fn progress(&self) -> Progress {
        let mut progress = match &self.phase {
            Phase::Arrive(solve) => {
                let mut progress = solve.progress();
                let solution_count = self.counts.solutions;
                progress.description = format!(
                    "monodromy found {solution_count} solutions; {}",
                    progress.description
                );
                progress
            }
            phase => Progress {
                description: match phase {
                    Phase::Sections(inner) => format!("trace test; {}", inner.description()),
                    Phase::Stuck => "monodromy: no start solution could be tracked".to_string(),
                    _ => self.description(),
                },
                stages: Vec::new(),
                paths: VerdictCounts {
                    finite: self.counts.tracked - self.counts.lost,
                    failed: self.counts.lost,
                    ..VerdictCounts::default()
                },
                done: *phase == Phase::Stuck,
            },
        };
        if let Phase::Sections(inner) = &self.phase {
            progress.stages.extend(inner.stages.iter().copied());
        }
        progress.stages.splice(0..0, self.stages.iter().copied());
        progress
    }

    fn completeness(&self) -> Option<CompletenessClaim> {
        Self::completeness(self)
    }

    fn answer(&self, system: &System) -> Option<Answer> {
        let mut sets = match &self.phase {
            Phase::Arrive(solve) => solve.solution_sets(system),
            _ => {
                let set = SolutionSet::new(
                    system,
                    &self.graph.vertices[BASE].parameters,
                    &self.first_results,
                    &History::default(),
                    &self.tolerances,
                    self.seed,
                );
                vec![set; self.targets.len()]
            }
        };
        for set in &mut sets {
            set.warnings.extend(self.warnings.iter().cloned());
        }
        let names = system.parameters.iter().cloned();
        let parameters = match self.targets.as_slice() {
            [one] => names.zip(one.iter().copied()).collect(),
            _ => BTreeMap::new(),
        };
        Some(Answer::Isolated(IsolatedSolutions {
            sets,
            loops: Some(FoundByLoops {
                counts: self.counts.clone(),
                parameters,
            }),
            held: None,
        }))
    }

    /// The first stage to the wanted parameters.
    fn counted_stage(&self) -> StageId {
        match &self.phase {
            Phase::Arrive(solve) => solve.paths().first_id(),
            _ => StageId(0),
        }
    }
}

#[cfg(test)]
mod tests;
