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
pub(crate) mod graph;
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
use counts::{LoopCounts, Mixing, Stop, Tested, moving};
use estimate::Estimate;
use graph::{Correspondence, Direction, EdgeEnd, Graph, Known, Wanted};
use num_complex::Complex64;
use places::{Sizes, generic_parameters};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use trace::{Curve, Test};

/// When loops end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopLimits {
    /// Loops in a row without anything new after which the set is taken for complete.
    /// HomotopyContinuation.jl takes 5. Where solutions are few, loops cost nothing, and up to
    /// [`MOST_IDLE`] are made: a random loop may well act trivially on three points.
    pub idle_loops: u32,
    /// Solutions at generic parameters, where that number is known: loops end when they are
    /// found, and go on four times longer when they are not.
    pub count: Option<u64>,
    /// Whether a trace test decides that all are found.
    pub trace_test: bool,
    /// With what probability, below 1, none should be missing if loops permute at random
    /// ([`estimate`]); then it is not idle loops that end the search, unless they are very many.
    pub confidence: Option<f64>,
    /// Whether loops that end without a trace test that passes have no answer: they were not asked for, and an answer
    /// that may miss solutions would look settled.
    pub only_complete: bool,
}

impl LoopLimits {
    /// Five loops in a row without anything new, and nothing else.
    pub const DEFAULT: Self = Self {
        idle_loops: 5,
        count: None,
        trace_test: false,
        confidence: None,
        only_complete: false,
    };
}

impl Default for LoopLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Most idle loops that a small set is asked for. So many, or as many as cost 512 paths, or the five
/// of the default would hide a solution with a probability below 1e-9 if each permuted all of them at
/// random.
pub const MOST_IDLE: u64 = 32;
/// Paths that idle loops may always cost.
const IDLE_PATHS: u64 = 512;
/// How many times more idle loops are made where too few of them move a solution, or where they do not
/// permute as random ones do.
const IDLE_PATIENCE: u64 = 4;
/// Idle loops after which the search ends whatever confidence was asked for: paths are lost then.
const HOPELESS: u64 = 256;
/// Detours between two places, at most, on either side of the line between them: another on one of
/// these sides is mostly the same loop again.
const DETOURS: usize = 2;

/// Edges to a fresh place, at most, where solutions are few.
const EDGES_OF_FEW: usize = 5;

/// Where the start solutions solve the system; nothing leads back there.
const START: usize = 0;
/// Where the loops begin and end.
const BASE: usize = 1;
/// The edge from one to the other.
const FIRST: usize = 0;

/// What an open stage is for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Batch {
    wanted: Wanted,
    /// Its stage, once it is open.
    stage: Option<StageId>,
    results: Option<Vec<PathResult>>,
}

/// What is being done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// Paths between vertices, round by round: each round has one stage for each edge with open
    /// sources, and is taken in when all are back, in the order of edges.
    Loops(Vec<Batch>),
    /// The images of one solution under the group are tracked on the spot: are they solutions?
    Check(Option<StageId>),
    /// Loops among the sections of a curve, for a trace test.
    Sections(Box<MonodromySolve>),
    /// From the base to the wanted parameters.
    Arrive(Box<ParameterSolve>),
    /// There is nothing to go on from, or nothing more is asked.
    Stuck,
}

/// Where the start solutions are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopStart {
    /// Parameters at which they solve the system.
    pub parameters: Vec<Complex64>,
    /// The object that holds them.
    pub points: StartPoints,
    /// How many they are.
    pub count: u64,
    /// Coordinates of all where they were found on the way: then the object is made of them.
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
    /// How completeness is tested; `None` where that is not asked.
    test: Option<Test>,
    /// Points of the base that the last test was about.
    tested: Option<usize>,
    /// Where the loops of a test are: on a curve of this family.
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

    /// The same with another limit of repetitions.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.max_retries = max_retries;
        self
    }

    /// How far the loops have come.
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
            let all = sources.len() as u64 == self.start.count;
            let points = if all {
                self.start.points.clone()
            } else {
                StartPoints::Selected {
                    base: Box::new(self.start.points.clone()),
                    indices: sources.iter().map(|&k| u64::from(k)).collect(),
                }
            };
            let found = self.start.found.iter().map(|values| {
                Arc::new(StoredPoints {
                    dimension: values.len() / self.start.count as usize,
                    coordinates: values.clone(),
                })
            });
            (points, found.collect())
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

    /// What comes after a round, or at the beginning. The phase is `Loops` without batches.
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

    /// All legs are tracked: counts idle loops; true when they are enough. Loops that leave every known
    /// solution where it is are no evidence, nor are any before they permute as random ones do; where
    /// that does not come about, loops end without evidence.
    fn is_exhausted(&mut self) -> bool {
        let known = self.graph.vertices[BASE].points.len();
        let places: Vec<usize> = self.places().collect();
        let loops = self.graph.permutations(&places);
        if known > self.exhausted_at {
            self.counts.idle_loops = 0;
            self.idle_from = self.graph.edges.len();
        } else {
            self.counts.idle_loops += self.counts.loops - self.weighed;
        }
        self.weighed = self.counts.loops;
        self.exhausted_at = known;
        self.counts.idle_moving = moving(&loops, self.idle_from);
        self.counts.mixing = Mixing::of(&loops);
        let wanted = self.idle_wanted();
        let moved = self.counts.idle_moving >= wanted && self.is_mixing();
        let patience = if self.limits.confidence.is_some() {
            1
        } else {
            IDLE_PATIENCE
        };
        let given_up = self.counts.idle_loops >= wanted.saturating_mul(patience);
        self.counts.idle_loops >= wanted && (moved || known == 1 || given_up)
    }

    /// Vertices that loops lead through, the base among them.
    fn places(&self) -> impl Iterator<Item = usize> {
        (BASE..self.graph.vertices.len()).filter(|&vertex| !self.is_beside(vertex))
    }

    /// What the graph says about the number of classes, once there are loops. Between two places only
    /// one detour is counted: all go around the same branch points, nearly, so that the others are no
    /// random permutations (measured: with them, one of 10 solves of two cubics missed a solution at a
    /// claimed 0.9999).
    fn estimate(&self) -> Option<Estimate> {
        let known = self.places().map(|v| self.graph.vertices[v].points.len());
        let mut pairs = BTreeMap::<[usize; 2], usize>::new();
        for edge in &self.graph.edges[FIRST + 1..] {
            if !edge.ends.iter().any(|&v| self.is_beside(v)) {
                let most = pairs.entry(edge.ends).or_default();
                *most = edge.pairs().max(*most);
            }
        }
        let pairs: Vec<usize> = pairs.into_values().collect();
        let started = self.graph.targets(FIRST);
        (self.counts.loops > 0).then(|| {
            let estimate = Estimate::new(&known.collect::<Vec<_>>(), &pairs, started);
            match self.is_mixing() {
                true => estimate,
                false => estimate.without_confidence(),
            }
        })
    }

    /// Whether all that is known anywhere is known at the base, and more is unlikely enough.
    fn is_confident(&self) -> bool {
        let (Some(wanted), Some(estimate)) = (self.limits.confidence, &self.counts.estimate) else {
            return false;
        };
        let points = |v: usize| self.graph.vertices[v].points.len();
        let all = self.places().all(|v| points(v) <= points(BASE));
        let tested = self.test.is_none() || self.tested == Some(points(BASE));
        let idle = self.counts.idle_loops >= self.cheap_loops();
        let mixed = self.is_mixing();
        all && tested && idle && mixed && estimate.confidence >= wanted
    }

    /// Whether loops are seen to permute the known solutions as random ones do.
    fn is_mixing(&self) -> bool {
        let known = self.graph.vertices[BASE].points.len() as u64;
        self.counts.mixing.is_shown(known)
    }

    /// How many loops more would make the estimate as certain as is wanted, if they bring nothing new:
    /// each divides the odds of one more class by their number.
    fn loops_for_confidence(&self, wanted: f64) -> u64 {
        let known = self.graph.vertices[BASE].points.len() as f64;
        let estimate = self.counts.estimate.as_ref();
        let mut doubt = 1.0 - estimate.map_or(0.0, |estimate| estimate.confidence);
        let mut loops = 0;
        while loops < 1 || (doubt > 1.0 - wanted && loops < HOPELESS) {
            doubt /= known + 1.0;
            loops += 1;
        }
        let idle = self.cheap_loops().saturating_sub(self.counts.idle_loops);
        loops.max(idle)
    }

    /// Idle loops that cost so little that they are always made: of few solutions many loops move none.
    fn cheap_loops(&self) -> u64 {
        let known = self.graph.vertices[BASE].points.len() as u64;
        (IDLE_PATHS / known.max(1)).min(MOST_IDLE)
    }

    /// How many idle loops are enough.
    fn idle_wanted(&self) -> u64 {
        if self.limits.confidence.is_some() {
            return HOPELESS;
        }
        let wanted = u64::from(self.limits.idle_loops).max(self.cheap_loops());
        let patience = if self.limits.count.is_some() { 4 } else { 1 };
        wanted.saturating_mul(patience).max(1)
    }

    /// How many points a vertex has, if as many solutions are as was said and their orbits are as
    /// large as those that are known.
    fn expected(&self) -> Option<usize> {
        let (counted, points) = self.counted;
        let (count, points) = (self.limits.count?, points as u64);
        let orbits = count.saturating_mul(points).div_ceil(counted.max(1));
        usize::try_from(orbits).ok().filter(|_| counted > 0)
    }

    /// A fresh place, joined to those before it as often as is still needed; at first two places, since
    /// two detours between two places make one loop only, which brings new solutions one by one.
    fn add_loops(&mut self) {
        let before = self.places().count();
        if before == 1 {
            self.add_place(DETOURS);
            self.add_place(DETOURS + 1);
            return;
        }
        let limits = &self.limits;
        let (loops, most) = match (limits.confidence, limits.count) {
            (Some(wanted), _) => (self.loops_for_confidence(wanted), before),
            // What is missing is on some loop: few are enough, most likely.
            (None, Some(_)) => (u64::MAX, before),
            (None, None) => (
                self.idle_wanted().saturating_sub(self.counts.idle_loops),
                // Where paths cost little, places are many rather than loops through the same ones.
                match self.cheap_loops() > u64::from(limits.idle_loops) {
                    true => EDGES_OF_FEW.min(DETOURS * before),
                    false => DETOURS * before,
                },
            ),
        };
        let edges = usize::try_from(loops.saturating_add(1)).map_or(most, |n| n.clamp(2, most));
        self.add_place(edges);
    }

    /// A fresh vertex and so many edges to it, from one place after another: one each, and then the
    /// others on the other side.
    fn add_place(&mut self, edges: usize) {
        let number = self.graph.vertices.len();
        // Where the number is known, sizes need not vary before loops are idle.
        let same = if self.limits.count.is_some() { 4 } else { 0 };
        let sizes = Sizes::of_place((number - BASE).saturating_sub(same));
        let parameters = generic_parameters(&self.start.parameters, self.seed, number, sizes);
        let before: Vec<usize> = match self.places().collect::<Vec<_>>() {
            // The second place is joined to the base on both sides, to the first on one.
            all if edges == DETOURS + 1 && all.len() == 2 => vec![all[0], all[1], all[0]],
            all => all,
        };
        let vertex = self.graph.add_vertex(parameters);
        let mut seeds = BTreeMap::<usize, u64>::new();
        for k in 0..edges {
            let place = before[k % before.len()];
            let fresh = edge_seed(self.seed, self.graph.edges.len());
            let seed = match seeds.insert(place, fresh) {
                None => fresh,
                Some(other_side) => way_back(other_side),
            };
            self.graph.add_edge(place, vertex, seed, true);
        }
        self.counts.loops += edges as u64 - 1;
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

    /// Where a path arrived, if that is a regular finite solution.
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
                // What nothing can help is not tried again.
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

    /// From everything that is known at the base to the wanted parameters.
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
        let all = points.iter().flat_map(|point| self.orbit(point)).flatten();
        StoredPoints {
            dimension: points[0].values.len(),
            coordinates: all.collect(),
        }
    }

    fn description(&self) -> String {
        let counts = &self.counts;
        let known = if counts.group_order > 1 {
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
            "monodromy: {known}, {} ({} idle), tracking {}",
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
        let found = self.counts.solutions;
        self.falls_short().then(|| {
            format!(
                "loops through the family of the system found {found} solutions of a member, and no trace test \
                 says that these are all; another seed may do, or another start"
            )
        })
    }

    fn progress(&self) -> Progress {
        let mut progress = match &self.phase {
            Phase::Arrive(solve) => {
                let mut progress = solve.progress();
                let known = self.counts.solutions;
                progress.description = format!(
                    "monodromy found {known} solutions; {}",
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
