//! Loci: what further equations, or components of another set, leave of components: intersections, singular loci,
//! critical points.
//!
//! Equations, or determinants whose common zeros are the locus, cut a component as a cascade does: general
//! combinations of them, one after the other; an end at which all of them hold belongs to the superset of its
//! dimension, and every other begins the next level (Hauenstein, Sommese, Wampler: Regenerative cascade homotopies,
//! Appl. Math. Comput. 218, 2011). Two components are paired: from the pairs of their witness points, in the variables
//! of both, slices move to as many general combinations of the differences of the variables as leave a dimension
//! (Sommese, Verschelde, Wampler: Homotopies for intersecting solution components, SIAM J. Numer. Anal. 42, 2004). A
//! locus need be no component of the equations: paths alone tell what is junk, and deflations make its points regular.

mod cutting;
mod pairs;
mod questions;

use super::context::Context;
use super::procedure::{GivenSystem, Procedure};
use crate::decomposition::cascade::Cascade;
use crate::decomposition::deflated::{Deflations, PureSet, doubles};
use crate::decomposition::job::{Job, StageSystem};
use crate::decomposition::junk::JunkFilter;
use crate::decomposition::multiple_cut::DeflatedSet;
use crate::decomposition::operand::Operand;
use crate::decomposition::problem::{Problem, REFINED};
use crate::decomposition::split::Split;
use crate::decomposition::superset::{SingularEnd, Superset};
use crate::decomposition::{ordered, remove_zero_denominators};
use cognate_solutions::witness::question::SecondSet;
use cognate_solutions::witness::{
    Answer, Decomposition, Dimension, Doubt, Method, TrackedPaths, WitnessSet,
};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;
use std::sync::Arc;

/// Ends nearer than this, relative to their size, are one point.
const SAME: f64 = 1e-6;
/// Ends that are known to few digits may be as far from each other as this and be one point.
const MOST_APART: f64 = 1e-4;

/// Locus that is cut out of each component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Wanted {
    /// Common points of the component and the solutions of the equations from `from` on.
    Equations {
        /// Place of the first of these equations in the system.
        from: u32,
    },
    /// Common points of the component and the components of another set.
    Others,
    /// Points of the component where the equations have less than their rank.
    Singular,
    /// Points of the component where the distance to a random point is critical, and its singular points.
    Critical,
}

/// Step of the work on a component or a pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// A component, or a pair of them, is next.
    Begin,
    /// Witness points go to the slices where levels begin.
    Start,
    /// The witness points are cut.
    Cut(Box<Cascade>),
    /// Pairs of witness points go to pairs of equal points.
    Pair {
        /// The dimension whose superset the open stage finds.
        dimension: usize,
    },
    Sift(Box<JunkFilter>),
    Split(Box<Split>),
    Done,
}

/// Systems derived from the problem; they are made again when the state is read back.
#[derive(Debug, Default)]
struct Made {
    /// The problem that cuts this component.
    cut: Option<(usize, Option<Arc<Problem>>, Deflations)>,
    /// The system of this pair.
    pair: Option<([usize; 2], Arc<System>)>,
}

impl Clone for Made {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for Made {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Search for the loci of components.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Locus {
    wanted: Wanted,
    /// The set with which components are intersected; `None` for other loci.
    second: Option<SecondSet>,
    phase: Phase,
    /// The component, and the one of the other set.
    place: [usize; 2],
    /// Place after the last component.
    end: usize,
    supersets: BTreeMap<usize, Superset>,
    /// Paths lost that may have led to sets of at most this dimension.
    lost: BTreeMap<usize, u64>,
    /// Sets that are to be split, highest dimension first.
    sets: VecDeque<PureSet>,
    components: Vec<WitnessSet>,
    dimensions: Vec<Dimension>,
    paths: TrackedPaths,
    paths_of_loops: TrackedPaths,
    /// Questions that could not be asked, in words.
    pub doubts: Vec<String>,
    #[serde(skip)]
    made: Made,
}

impl Procedure for Locus {
    fn advance(&mut self, context: &mut Context<'_>, mut done: Option<Job>) -> Option<Job> {
        if let Some(job) = &done {
            match self.phase {
                Phase::Split(_) => self.paths_of_loops.add(&job.paths()),
                _ => self.paths.add(&job.paths()),
            }
        }
        loop {
            let job = match (&mut self.phase, done.take()) {
                (Phase::Done, _) => return None,
                (Phase::Begin, _) if self.place[0] >= self.end => self.gathered(context),
                (Phase::Begin, _) if self.wanted == Wanted::Others => self.pair(context),
                (Phase::Begin, _) => self.begin(context),
                (Phase::Start, Some(job)) => self.started(context, &job),
                (Phase::Pair { dimension }, Some(job)) => {
                    let dimension = *dimension;
                    self.paired(context, dimension, &job)
                }
                (Phase::Start | Phase::Pair { .. }, None) => {
                    unreachable!("these phases wait for a stage")
                }
                (Phase::Cut(_), job) => self.cutting(context, job.as_ref()),
                (Phase::Sift(filter), job) => {
                    let mut sets = Vec::from(std::mem::take(&mut self.sets));
                    let next = filter.advance(&mut context.of_whole(), job.as_ref(), &mut sets);
                    self.sets = sets.into();
                    if next.is_none() {
                        self.dimensions = filter.dimensions();
                        self.next_split();
                    }
                    next
                }
                (Phase::Split(split), job) => {
                    let next = split.advance(&mut context.of_whole(), job);
                    if next.is_none() {
                        self.split(context);
                    }
                    next
                }
            };
            if job.is_some() {
                return job;
            }
        }
    }

    fn system_of(&mut self, context: &mut Context<'_>, wanted: &StageSystem) -> Arc<System> {
        match (&self.phase, wanted) {
            (_, StageSystem::Pair { places }) => self.pair_system(context, *places),
            (Phase::Cut(_), _) => {
                self.make_cut(context);
                if let StageSystem::MultipleCut { .. } = wanted
                    && let (Phase::Cut(cascade), Some((_, Some(problem), _))) =
                        (&self.phase, &self.made.cut)
                {
                    return cascade.system_of(problem, &mut context.of_components(), wanted);
                }
                let Some((_, Some(problem), deflations)) = &mut self.made.cut else {
                    unreachable!("nothing is cut where no problem can be made")
                };
                let problem = Arc::clone(problem);
                deflations.of_stage(&problem, wanted)
            }
            (Phase::Sift(_) | Phase::Split(_), _) => context.of_whole().system(wanted),
            _ => context.of_components().system(wanted),
        }
    }

    fn description(&self) -> &'static str {
        match self.phase {
            Phase::Begin | Phase::Start | Phase::Cut(_) => "cutting components",
            Phase::Pair { .. } => "pairing components",
            Phase::Sift(_) => "telling junk from witness points",
            Phase::Split(_) | Phase::Done => "telling components apart",
        }
    }

    fn answer(&mut self, given: &GivenSystem<'_>) -> Answer {
        let mut locus = self.take(&given.system.variables);
        if given.denominators.is_some() {
            remove_zero_denominators(&mut locus, given.system, given.seed);
            locus = ordered(locus);
        }
        Answer::Components(Box::new(locus))
    }

    fn second_set(&self) -> Option<&SecondSet> {
        self.second.as_ref()
    }
}

impl Locus {
    /// Search for the wanted loci of these components, by place.
    pub fn new(wanted: Wanted, components: Range<usize>) -> Self {
        Self {
            wanted,
            second: None,
            phase: Phase::Begin,
            place: [components.start, 0],
            end: components.end,
            supersets: BTreeMap::new(),
            lost: BTreeMap::new(),
            sets: VecDeque::new(),
            components: Vec::new(),
            dimensions: Vec::new(),
            paths: TrackedPaths::default(),
            paths_of_loops: TrackedPaths::default(),
            doubts: Vec::new(),
            made: Made::default(),
        }
    }

    fn next(&mut self) {
        self.place = [self.place[0] + 1, 0];
        self.phase = Phase::Begin;
    }

    fn superset(&mut self, dimension: usize) -> &mut Superset {
        let entry = self.supersets.entry(dimension);
        entry.or_insert_with(|| Superset::empty(dimension))
    }

    fn lose(&mut self, dimension: usize, paths: u64) {
        *self.lost.entry(dimension).or_default() += paths;
    }

    /// Makes the problem that cuts the current component, where it is not there.
    fn make_cut(&mut self, context: &Context<'_>) {
        let place = self.place[0];
        if matches!(&self.made.cut, Some((cut_place, ..)) if *cut_place == place) {
            return;
        }
        let made = match cutting::problem(context, &context.operands[place], self.wanted) {
            Ok(made) => made.map(Arc::new),
            Err(reason) => {
                if !self.doubts.contains(&reason) {
                    self.doubts.push(reason);
                    self.lose(context.operands[place].dimension() - 1, 1);
                }
                None
            }
        };
        self.made.cut = Some((place, made, Deflations::default()));
    }

    fn cut_problem(&mut self, context: &Context<'_>) -> Option<Arc<Problem>> {
        self.make_cut(context);
        let (_, problem, _) = self.made.cut.as_ref()?;
        problem.clone()
    }

    fn begin(&mut self, context: &mut Context<'_>) -> Option<Job> {
        let operand = &context.operands[self.place[0]];
        let dimension = operand.dimension();
        if dimension == 0 {
            self.point(context, operand);
            self.next();
            return None;
        }
        let multiple = !operand.set.ranks.is_empty();
        if multiple && self.wanted == Wanted::Critical {
            self.superset(dimension - 1).not_cut += operand.degree() as u64;
            self.next();
            return None;
        }
        // A multiple component is singular everywhere: nothing cuts it.
        let singular = multiple && self.wanted == Wanted::Singular;
        if !singular && self.cut_problem(context).is_none() {
            self.next();
            return None;
        }
        self.phase = Phase::Start;
        let targets = vec![context.problem.slices(dimension)];
        Some(operand.moved_to(&mut context.of_components(), targets))
    }

    /// An isolated point, of which there is nothing less.
    fn point(&mut self, context: &Context<'_>, operand: &Operand) {
        let variable_count = context.problem.variables();
        let point = &operand.set.points[0];
        let belongs = match self.wanted {
            Wanted::Equations { .. } => context
                .whole
                .solves(&point.point[..variable_count], &REFINED),
            Wanted::Singular => Some(!operand.set.ranks.is_empty()),
            Wanted::Others | Wanted::Critical => Some(true),
        };
        let end = exact_end(doubles(point, variable_count));
        let superset = self.superset(0);
        match belongs {
            Some(true) => superset.singular.push(end),
            Some(false) => {}
            None => superset.unclear += 1,
        }
    }

    fn started(&mut self, context: &mut Context<'_>, job: &Job) -> Option<Job> {
        let dimension = context.operands[self.place[0]].dimension();
        let (mut points, lost) = job.regular_ends();
        if lost > 0 {
            self.lose(dimension, lost);
        }
        let ranks = context.operands[self.place[0]].set.ranks.clone();
        let variable_count = context.problem.variables();
        let singular = self.wanted == Wanted::Singular && !ranks.is_empty();
        let problem = match singular {
            true => None,
            false => Some(self.cut_problem(context)?),
        };
        let holds = |values: &Vec<Complex64>| {
            // Where nothing cuts, all of the component is wanted.
            let Some(problem) = &problem else {
                return Some(true);
            };
            let rows = vec![values[..variable_count].to_vec()];
            let on = (problem.slices(dimension), ranks.as_slice());
            let refined = context
                .deflations
                .points_on(context.problem, (&on.0, on.1), &rows);
            let refined = refined.into_iter().next().flatten()?;
            problem.solves(&refined.point[..variable_count], &REFINED)
        };
        let holding: Vec<Option<bool>> = points.iter().map(holds).collect();
        if let Some(problem) = &problem
            && holding.iter().all(|&holds| holds == Some(false))
        {
            let level = variable_count - dimension;
            let cascade = match ranks.is_empty() {
                true => Cascade::from_level(level, points),
                false => Cascade::on_multiple(problem, DeflatedSet { ranks, dimension }, points),
            };
            self.phase = Phase::Cut(Box::new(cascade));
            return None;
        }
        for point in &mut points {
            point.truncate(variable_count);
        }
        // All of the component belongs to the locus.
        let whole = holding.iter().all(|&holds| holds == Some(true));
        let superset = self.superset(dimension);
        match whole {
            true => superset.singular.extend(points.into_iter().map(exact_end)),
            false => superset.unclear += points.len() as u64,
        }
        self.next();
        None
    }

    fn cutting(&mut self, context: &mut Context<'_>, job: Option<&Job>) -> Option<Job> {
        let problem = self.cut_problem(context);
        let Phase::Cut(cascade) = &mut self.phase else {
            unreachable!("a cascade is under way")
        };
        let problem = problem.expect("what begins to cut has a problem");
        let next = cascade.advance(&problem, Some(&mut context.of_components()), job);
        if next.is_some() {
            return next;
        }
        for superset in cascade.take_supersets(&problem) {
            let regular = superset.regular.into_iter().map(exact_end);
            let locus_superset = self.superset(superset.dimension);
            locus_superset
                .singular
                .extend(superset.singular.into_iter().chain(regular));
            locus_superset.excess += superset.excess;
            locus_superset.failed += superset.failed;
            locus_superset.unclear += superset.unclear;
        }
        self.next();
        None
    }

    /// All supersets are there: what in them is junk.
    fn gathered(&mut self, context: &Context<'_>) -> Option<Job> {
        let highest = context.operands.iter().map(Operand::dimension).max();
        let mut supersets = Vec::new();
        for dimension in (self.lowest()..=highest.unwrap_or(0)).rev() {
            let lost: u64 = self.lost.range(dimension..).map(|(_, lost)| lost).sum();
            let mut superset = self
                .supersets
                .remove(&dimension)
                .unwrap_or_else(|| Superset::empty(dimension));
            superset.failed += lost;
            superset.singular = unique(superset.singular);
            supersets.push(superset);
        }
        self.phase = Phase::Sift(Box::new(JunkFilter::of_sets(supersets)));
        None
    }

    /// The lowest dimension whose points are told apart.
    fn lowest(&self) -> usize {
        // Critical points are taken as they are.
        usize::from(self.wanted == Wanted::Critical)
    }

    fn next_split(&mut self) {
        self.phase = match self.sets.pop_front() {
            Some(set) => Phase::Split(Box::new(Split::new(set))),
            None => Phase::Done,
        };
    }

    fn split(&mut self, context: &mut Context<'_>) {
        let Phase::Split(split) = &mut self.phase else {
            unreachable!("a set is being split")
        };
        let (mut witness_sets, dimension) = split.components(&mut context.of_whole());
        for set in &mut witness_sets {
            // Of a locus the multiplicity is not asked.
            set.evidence
                .doubts
                .retain(|doubt| *doubt != Doubt::Multiplicity);
        }
        self.components.extend(witness_sets);
        let dimensions = self.dimensions.iter_mut();
        if let Some(earlier_dimension) = dimensions
            .into_iter()
            .find(|d| d.number == dimension.number)
        {
            earlier_dimension.doubts.extend(dimension.doubts);
            earlier_dimension.found_by_loops += dimension.found_by_loops;
        }
        self.next_split();
    }

    /// Ends of dimension 0 as they came, with how they are known; the problem that cut them out.
    pub fn take_points(&mut self, context: &Context<'_>) -> (Superset, Option<Arc<Problem>>) {
        let lost: u64 = self.lost.values().sum();
        let mut points = self
            .supersets
            .remove(&0)
            .unwrap_or_else(|| Superset::empty(0));
        points.failed += lost;
        self.place[0] = self.end - 1;
        let problem = match context.operands[self.place[0]].dimension() {
            0 => None,
            _ => self.cut_problem(context),
        };
        (points, problem)
    }

    /// The components of the locus, of all dimensions.
    pub fn take(&mut self, variables: &[String]) -> Decomposition {
        let highest = self.dimensions.first().map_or(0, |d| d.number);
        ordered(Decomposition {
            family: None,
            removed: Vec::new(),
            variables: variables.to_vec(),
            method: Method::Equations,
            verification: None,
            locus: true,
            asked: [self.lowest() as u32, highest],
            components: std::mem::take(&mut self.components),
            dimensions: std::mem::take(&mut self.dimensions),
            paths: self.paths,
            paths_of_loops: self.paths_of_loops,
        })
    }
}

/// A point that is known to all digits.
fn exact_end(values: Vec<Complex64>) -> SingularEnd {
    SingularEnd {
        values,
        accuracy: f64::EPSILON,
        paths: 1,
    }
}

/// Distance of two points, relative to the size of the first and 1.
pub(super) fn apart(a: &[Complex64], b: &[Complex64]) -> f64 {
    let (mut apart, mut size) = (0.0, 1.0f64);
    for (x, y) in a.iter().zip(b) {
        apart += (x - y).norm_sqr();
        size += x.norm_sqr();
    }
    (apart / size).sqrt()
}

/// Each point once, as it is known best, as one to which one path came.
fn unique(mut ends: Vec<SingularEnd>) -> Vec<SingularEnd> {
    let first = |end: &SingularEnd| end.values.first().map_or(0.0, |z| z.re);
    ends.sort_by(|a, b| first(a).total_cmp(&first(b)));
    let mut kept = Vec::with_capacity(ends.len());
    let mut taken = vec![false; ends.len()];
    for k in 0..ends.len() {
        if taken[k] {
            continue;
        }
        let mut best = k;
        let size = ends[k].values.iter().map(|z| z.norm_sqr()).sum::<f64>();
        let window = MOST_APART * (1.0 + size.sqrt());
        for j in k + 1..ends.len() {
            if first(&ends[j]) - first(&ends[k]) > window {
                break;
            }
            let errors = 8.0 * (ends[k].accuracy + ends[j].accuracy);
            let limit = errors.clamp(SAME, MOST_APART);
            if !taken[j] && apart(&ends[k].values, &ends[j].values) <= limit {
                taken[j] = true;
                if ends[j].accuracy < ends[best].accuracy {
                    best = j;
                }
            }
        }
        kept.push(SingularEnd {
            paths: 1,
            ..ends[best].clone()
        });
    }
    kept
}
