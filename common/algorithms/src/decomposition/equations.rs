//! Equation by equation: the sets that the equations so far have in common are cut by the next, where it does not
//! hold on them.
//!
//! From a set of dimension m its slice m moves to as many forms as the next equation has degrees, and their
//! product becomes that equation: a set of dimension m - 1. What comes out is sifted before the next equation
//! cuts it, so that paths begin at regular points of sets that are there. Systems that are products stay in pieces.
//! A multiple set is cut through the deflated equations of what it was cut out by ([`super::multiple_cut`]).
//! (Hauenstein, Wampler: Unification and extension of intersection algorithms, Appl. Math. Comput. 293, 2017.)

use super::deflated::{Deflations, ProblemContext, PureSet, doubles};
use super::job::{DescribedSystem, Job, StageSystem};
use super::junk::JunkFilter;
use super::multiple_cut::{self, DeflatedSet};
use super::problem::{Problem, REFINED};
use super::superset::{SingularEnd, Superset};
use crate::regeneration_solve::level_homotopy;
use cognate_continuation::bend::RefinedPoint;
use cognate_continuation::start_systems::slices::common_point;
use cognate_numeric::interruption::Interruption;
use cognate_solutions::classification::Verdict;
use cognate_solutions::witness::{Dimension, Doubt};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The first equations in the order in which they cut, and what is made of them; each made once.
#[derive(Clone, Debug, Default)]
pub(super) struct Prefixes {
    made: BTreeMap<usize, (Arc<Problem>, Deflations)>,
}

impl Prefixes {
    /// Problem of the first `count` equations.
    pub fn problem(&mut self, whole: &Problem, count: usize) -> Arc<Problem> {
        let (problem, _) = self.entry(whole, count);
        Arc::clone(problem)
    }

    /// Problem of the first `count` equations, and its deflations.
    pub fn of(&mut self, whole: &Problem, count: usize) -> ProblemContext<'_> {
        let (problem, deflations) = self.entry(whole, count);
        ProblemContext {
            problem,
            deflations,
        }
    }

    fn entry(&mut self, whole: &Problem, count: usize) -> &mut (Arc<Problem>, Deflations) {
        self.made.entry(count).or_insert_with(|| {
            // Made to its end, also where this thread is told to stop: the next stage is not opened then.
            let prefix = Interruption::default().run(|| whole.prefix(count));
            let prefix = prefix.expect("equations that have degrees have factors that have");
            (Arc::new(prefix), Deflations::default())
        })
    }
}

/// Points that are cut together: their dimension, the deflations of their set, and for how many paths each stands.
type Kind<'a> = (usize, &'a [u32], u64);

/// Points of one dimension on their way to the next equation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Cut {
    dimension: usize,
    /// Deflations of the multiple set that they are of, with whose multipliers they are; none: they are regular.
    ranks: Vec<u32>,
    /// Number of paths for which each point stands.
    tracked: u64,
    /// The factor that cuts, its degree and its exponent.
    factor: u32,
    degree: u32,
    exponent: u32,
    /// The equation has no other factor, and cuts no multiple set of this dimension.
    alone: bool,
    /// Points where the paths began; after the slice moved, its moved points.
    points: Vec<Vec<Complex64>>,
    sliding: bool,
}

/// Step of the treatment of one equation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// The sets that the equation cuts are not known yet.
    Begin,
    /// The sets that are still to be cut; the stage that is under way, where one is, is of the last.
    Cutting { left: Vec<Cut> },
    /// The supersets that the equation leaves are sifted: junk is told from witness points.
    Sifting(Box<JunkFilter>),
}

/// Equation by equation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Equations {
    /// Number of equations that hold on the sets.
    taken: usize,
    phase: Phase,
    /// Sets on which they hold, highest dimension first.
    sets: Vec<PureSet>,
    /// Witness supersets that the next equation leaves of the sets, by dimension.
    supersets: BTreeMap<usize, Superset>,
    /// Paths lost, and points not cut, that may have led to sets of at most this dimension.
    lost: BTreeMap<usize, [u64; 2]>,
}

impl Equations {
    pub fn new(problem: &Problem) -> Self {
        let point = common_point(problem.seed(), problem.variables());
        Self {
            taken: 0,
            phase: Phase::Begin,
            sets: PureSet::everything(point).into_iter().collect(),
            supersets: BTreeMap::new(),
            lost: BTreeMap::new(),
        }
    }

    /// Begins with the sets of the first known equations, each set on the problem's slices, and the number of paths
    /// lost on the way to them, by dimension.
    pub fn from_sets(
        problem: &Problem,
        (sets, lost): (Vec<PureSet>, BTreeMap<usize, u64>),
    ) -> Self {
        let variable_count = problem.variables();
        let taken = problem.known;
        let mut supersets = BTreeMap::new();
        if taken == problem.order.len() {
            // Nothing cuts.
            for set in &sets {
                for point in &set.points {
                    keep(
                        superset(&mut supersets, set.dimension),
                        set,
                        point,
                        variable_count,
                    );
                }
            }
        }
        Self {
            taken,
            phase: Phase::Begin,
            sets,
            supersets,
            lost: lost.into_iter().map(|(m, lost)| (m, [lost, 0])).collect(),
        }
    }

    /// The system of the open stage.
    pub fn system_of(
        &self,
        whole: &Problem,
        prefixes: &mut Prefixes,
        wanted: &StageSystem,
    ) -> Arc<System> {
        let problem = prefixes.problem(whole, self.prefix());
        match wanted {
            StageSystem::MultipleCut { cut, .. } => multiple_system(
                &mut prefixes.of(whole, self.taken),
                &problem,
                wanted,
                cut[1],
            ),
            _ => prefixes.of(whole, self.prefix()).system(wanted),
        }
    }

    /// Number of first equations that the open stage uses.
    pub fn prefix(&self) -> usize {
        self.taken + 1
    }

    /// Describes the open stage in a few words.
    pub fn description(&self, problem: &Problem) -> String {
        let equation_count = problem.order.len();
        match &self.phase {
            Phase::Sifting(_) => format!(
                "sifting what {} of {equation_count} equations leave",
                self.prefix()
            ),
            Phase::Begin | Phase::Cutting { .. } => {
                format!("cutting by equation {} of {equation_count}", self.prefix())
            }
        }
    }

    /// Learns from the stage that is done, and says which comes next.
    pub fn advance(
        &mut self,
        whole: &Problem,
        prefixes: &mut Prefixes,
        mut done: Option<&Job>,
    ) -> Option<Job> {
        let last = whole.order.len();
        loop {
            if self.taken == last {
                return None;
            }
            let problem = prefixes.problem(whole, self.prefix());
            match &mut self.phase {
                Phase::Begin => self.begin(&problem),
                Phase::Cutting { left } => {
                    if let Some(job) = done.take() {
                        let mut cut = left.pop().expect("the open one is there");
                        if let Some(more) = learn(&problem, job, &mut cut, &mut self.supersets) {
                            add(&mut self.lost, cut.dimension - 1, [more, 0]);
                        }
                        left.extend(cut.sliding.then_some(cut));
                        continue;
                    }
                    if let Some(cut) = left.last_mut() {
                        let before = self.taken + usize::from(cut.ranks.is_empty());
                        return Some(next_job(&problem, &mut prefixes.of(whole, before), cut));
                    }
                    if self.taken + 1 == last {
                        self.taken = last;
                        return None;
                    }
                    let filter = JunkFilter::new(self.take_supersets(0), true);
                    self.sets.clear();
                    self.phase = Phase::Sifting(Box::new(filter));
                }
                Phase::Sifting(filter) => {
                    let mut context = prefixes.of(whole, self.taken + 1);
                    if let Some(job) = filter.advance(&mut context, done.take(), &mut self.sets) {
                        return Some(job);
                    }
                    for dimension in filter.dimensions() {
                        let number = dimension.number as usize;
                        add(&mut self.lost, number, [0, unclear(&dimension)]);
                    }
                    self.taken += 1;
                    self.phase = Phase::Begin;
                }
            }
        }
    }

    /// Tells the points at which the next equation holds from those where it cuts.
    fn begin(&mut self, problem: &Problem) {
        let variable_count = problem.variables();
        let mut cuts: BTreeMap<Kind<'_>, Vec<Vec<Complex64>>> = BTreeMap::new();
        for set in &self.sets {
            let m = set.dimension;
            for point in &set.points {
                match problem.solves(&point.point[..variable_count], &REFINED) {
                    Some(true) => {
                        keep(superset(&mut self.supersets, m), set, point, variable_count);
                    }
                    // A point that lies on no further hypersurface is gone.
                    Some(false) if m == 0 => {}
                    Some(false) => {
                        let tracked = match set.ranks.is_empty() {
                            true => 1,
                            false => set.multiplicity.tracked,
                        };
                        let kind = (m, set.ranks.as_slice(), tracked);
                        let unknowns = doubles(point, point.point.len());
                        cuts.entry(kind).or_default().push(unknowns);
                    }
                    None => add(&mut self.lost, m, [0, 1]),
                }
            }
        }
        let lowest = *problem.asked.start() as usize;
        cuts.retain(|(m, ..), _| *m > lowest);
        let kinds = cuts.keys().filter(|(_, ranks, _)| !ranks.is_empty());
        let multiple: BTreeSet<usize> = kinds.map(|(m, ..)| *m).collect();
        // Counted to the end, also where this thread is told to stop: the next stage is not opened then.
        let factors = Interruption::default().run(|| problem.last_factors());
        let factors = factors.expect("factors of equations with degrees have degrees");
        let mut left = Vec::new();
        for ((dimension, ranks, tracked), points) in cuts {
            for (factor, [degree, exponent]) in (0..).zip(factors.iter().copied()) {
                left.push(Cut {
                    dimension,
                    ranks: ranks.to_vec(),
                    tracked,
                    factor,
                    degree,
                    exponent,
                    alone: factors.len() == 1 && exponent == 1 && !multiple.contains(&dimension),
                    points: points.clone(),
                    sliding: false,
                });
            }
        }
        self.phase = Phase::Cutting { left };
    }

    fn take_supersets(&mut self, lowest: usize) -> Vec<Superset> {
        let supersets = std::mem::take(&mut self.supersets);
        let wanted = supersets.into_iter().rev();
        let wanted = wanted.filter(|(dimension, _)| *dimension >= lowest);
        wanted.map(|(_, superset)| superset).collect()
    }

    /// Supersets of all dimensions that are asked for and of the dimensions above them, highest first.
    pub fn supersets(&mut self, problem: &Problem) -> Vec<Superset> {
        let lowest = *problem.asked.start() as usize;
        for dimension in lowest..problem.variables() {
            let superset = superset(&mut self.supersets, dimension);
            for (_, [failed, not_cut]) in self.lost.range(dimension..) {
                superset.failed += failed;
                superset.not_cut += not_cut;
            }
        }
        self.take_supersets(lowest)
    }
}

fn superset(supersets: &mut BTreeMap<usize, Superset>, dimension: usize) -> &mut Superset {
    let entry = supersets.entry(dimension);
    entry.or_insert_with(|| Superset::empty(dimension))
}

/// Takes a point of a set on which the equations hold.
fn keep(superset: &mut Superset, set: &PureSet, point: &RefinedPoint, variable_count: usize) {
    superset.regular.extend(set.keeps(point, variable_count));
    superset
        .singular
        .extend(set.keeps_multiple(point, variable_count));
}

fn add(lost: &mut BTreeMap<usize, [u64; 2]>, dimension: usize, more: [u64; 2]) {
    let lost_paths = lost.entry(dimension).or_default();
    lost_paths[0] += more[0];
    lost_paths[1] += more[1];
}

/// Points of a dimension of which the junk filter does not know what they are.
fn unclear(dimension: &Dimension) -> u64 {
    let points = |doubt: &Doubt| match doubt {
        Doubt::Junk { points } | Doubt::NotDeflated { points } | Doubt::Asked { points } => *points,
        _ => 0,
    };
    dimension.doubts.iter().map(points).sum()
}

/// System in which the last equation of a problem cuts a multiple set of the equations before it.
fn multiple_system(
    set_problem: &mut ProblemContext<'_>,
    problem: &Problem,
    wanted: &StageSystem,
    factor: u32,
) -> Arc<System> {
    multiple_cut::system_of(set_problem, wanted, || problem.last_factor(factor as usize))
}

/// The stage that moves the slice of a set, or that cuts it. `set_problem`: the problem of the set where that is
/// multiple, else the one that the equation belongs to.
fn next_job(problem: &Problem, set_problem: &mut ProblemContext<'_>, cut: &mut Cut) -> Job {
    let n = problem.variables();
    cut.sliding = !cut.sliding && cut.degree > 1;
    if !cut.ranks.is_empty() {
        let set = DeflatedSet {
            ranks: cut.ranks.clone(),
            dimension: cut.dimension,
        };
        let forms = multiple_cut::forms(cut.sliding, cut.degree);
        let description = set.stage([0, cut.factor], forms);
        let system = DescribedSystem {
            system: multiple_system(set_problem, problem, &description, cut.factor),
            description,
        };
        let how = (cut.dimension, cut.degree, forms);
        return multiple_cut::job(problem, system, how, &cut.points);
    }
    let (order, level) = ((0..n as u32).collect(), (n - cut.dimension) as u32);
    let other_forms = cut.sliding.then(|| cut.degree - 1);
    let homotopy = level_homotopy(Vec::new(), order, level, other_forms);
    let wanted = StageSystem::Cut {
        dimension: cut.dimension,
        factor: cut.factor,
    };
    let system = set_problem.described(wanted);
    Job::track(system, homotopy, &cut.points, &problem.tracking).ends_only()
}

/// Takes the ends of a stage; paths that were lost, where some were.
fn learn(
    problem: &Problem,
    job: &Job,
    cut: &mut Cut,
    supersets: &mut BTreeMap<usize, Superset>,
) -> Option<u64> {
    if cut.sliding {
        let (points, lost) = job.regular_ends();
        cut.points.extend(points);
        return (lost > 0).then_some(lost);
    }
    let mut lost = job.crossings_left();
    let mut cut_superset = Superset::empty(cut.dimension - 1);
    let mut singular = Vec::new();
    let multiple = !cut.ranks.is_empty();
    for (place, (result, decision, mut values)) in job.ends().into_iter().enumerate() {
        match decision.verdict {
            Verdict::AtInfinity | Verdict::Removed => {}
            // Regular with the multipliers; the point itself is not, unless the equation makes it so.
            Verdict::Finite if multiple => {
                values.truncate(problem.variables());
                cut_superset.singular.push(SingularEnd {
                    values,
                    accuracy: result.accuracy.max(f64::EPSILON),
                    paths: 1,
                });
            }
            Verdict::Finite if cut.exponent == 1 => cut_superset.regular.push(values),
            Verdict::Finite
            | Verdict::Singular
            | Verdict::Undecided
            | Verdict::PositiveDimensional => {
                singular.push(place);
            }
            Verdict::Failed | Verdict::WithinDataAccuracy | Verdict::ExcessSolution => lost += 1,
        }
    }
    cut_superset.gather(problem, job, &singular);
    for end in &mut cut_superset.singular {
        end.paths *= cut.tracked;
    }
    let superset = superset(supersets, cut.dimension - 1);
    match cut.alone {
        true => {
            superset.regular.extend(cut_superset.regular);
            superset.singular.extend(cut_superset.singular);
        }
        false => superset.join(cut_superset, u64::from(cut.exponent)),
    }
    (lost > 0).then_some(lost)
}
