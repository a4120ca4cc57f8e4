//! Pure sets: witness points of one dimension and one multiplicity, with equations that are regular there.
//!
//! Where the Jacobian of the given equations has too small a rank at a witness point, its kernel joins the
//! equations with new unknowns, until they are regular with the slice (Leykin, Verschelde, Zhao 2006). The
//! ranks depend on the component alone, since its witness points are general on it (Hauenstein, Wampler:
//! Isosingular sets and deflation, Found. Comput. Math. 13, 2013): points of other ranks are on others.

use super::job::{DescribedSystem, StageSystem};
use super::problem::Problem;
use super::superset::SingularEnd;
use cognate_continuation::bend::{Number, RefinedPoint, SlicedEquations, exactly, rounded};
use cognate_continuation::start_points::StoredPoints;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::witness::Multiplicity;
use cognate_systems::system::{System, VariableGroup};
use cognate_systems::transform::{bent, critical, deflate, fibre, slice};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// Most deflations one after the other.
const MOST_DEFLATIONS: usize = 6;
/// Most unknowns of deflated equations.
const MOST_UNKNOWNS: usize = 200;
/// Most nodes of equations that are deflated once more.
const MOST_NODES: usize = 20_000;
/// A singular value below this part of the largest may be 0, at a point that is known to a few digits.
const SMALL: f64 = 1e-3;
/// A singular value may be 0 only if the one before it is larger by this factor.
const GAP: f64 = 30.0;
/// Most ranks that are tried at one point.
const CANDIDATES: usize = 2;
/// Most sequences of ranks that are tried, shortest first.
const MOST_TRIED: usize = 16;
/// Singular values below this many times a point's error may be 0 and tell nothing.
const NOISE: f64 = 30.0;
/// Condition number above which equations are not regular at a point: there double-doubles lose half their digits.
/// Below it the test is whether Newton's method reaches all its digits at once.
const SINGULAR: f64 = 1e14;
/// Condition number below which equations are as regular at a point as beside it.
const CLEARLY_CONDITIONED: f64 = 1e6;
/// Newton's method must end with a last step below `STEP`, relative to the point, and equations below `RESIDUAL`.
const STEP: f64 = 1e-22;
const RESIDUAL: f64 = 1e-20;
/// A refined end has moved at most this far, or this many times its error, relative to the point.
const MOVED: f64 = 1e-5;
const MOVED_FACTOR: f64 = 1e3;
/// Refined points nearer than this, relative to their size, are one.
const SAME: f64 = 1e-14;

/// Witness points that are to be told apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PureSet {
    pub dimension: usize,
    /// Rank of the Jacobian before each deflation.
    pub ranks: Vec<u32>,
    pub multiplicity: Multiplicity,
    pub points: Vec<RefinedPoint>,
}

impl PureSet {
    /// The whole space of the problem's variables, by the point on all slices.
    pub fn everything(point: Option<Vec<Complex64>>) -> Option<Self> {
        let point = point?;
        let refined = RefinedPoint {
            point: point.iter().map(|&z| exactly(z)).collect(),
            correction: 0.0,
            moved: 0.0,
            residual: 0.0,
            condition: 1.0,
        };
        Deflations::reduced_set(point.len(), vec![refined])
    }

    /// The point as one of a superset, where it is regular and one path came to it.
    pub fn keeps(&self, point: &RefinedPoint, variable_count: usize) -> Option<Vec<Complex64>> {
        self.is_plain().then(|| doubles(point, variable_count))
    }

    /// The point as one of a superset, where it is not.
    pub fn keeps_multiple(
        &self,
        point: &RefinedPoint,
        variable_count: usize,
    ) -> Option<SingularEnd> {
        (!self.is_plain()).then(|| SingularEnd {
            values: doubles(point, variable_count),
            accuracy: f64::EPSILON,
            paths: self.multiplicity.tracked,
        })
    }

    fn is_plain(&self) -> bool {
        self.ranks.is_empty() && self.multiplicity.tracked == 1
    }

    /// The points in the unknowns that are tracked.
    pub fn doubles(&self) -> Vec<Vec<Complex64>> {
        let double = |p: &RefinedPoint| p.point.iter().map(rounded).collect();
        self.points.iter().map(double).collect()
    }

    /// The points from this place on in the unknowns that are tracked, as they are stored.
    pub fn stored_from(&self, first: usize) -> StoredPoints {
        let dimension = self.points[first..].first().map_or(0, |p| p.point.len());
        let mut coordinates = Vec::with_capacity(dimension * (self.points.len() - first));
        for point in &self.points[first..] {
            coordinates.extend(point.point.iter().map(rounded));
        }
        StoredPoints {
            dimension,
            coordinates,
        }
    }

    /// Stage of all equations of the set with the slices, whose coefficients are parameters.
    pub fn whole(&self) -> StageSystem {
        StageSystem::Whole {
            ranks: self.ranks.clone(),
            dimension: self.dimension,
        }
    }

    /// Stage of the combinations of the set's equations that are tracked, with the slices, whose coefficients are
    /// parameters.
    pub fn tracked(&self) -> StageSystem {
        StageSystem::Tracked {
            ranks: self.ranks.clone(),
            dimension: self.dimension,
        }
    }
}

/// The first coordinates of a point.
pub(crate) fn doubles(point: &RefinedPoint, variable_count: usize) -> Vec<Complex64> {
    point.point[..variable_count].iter().map(rounded).collect()
}

/// A point of a multiple set at which the equations are regular after these deflations.
#[derive(Clone, Debug)]
pub(crate) struct DeflatedPoint {
    ranks: Vec<u32>,
    pub refined: RefinedPoint,
}

impl DeflatedPoint {
    /// Rank of the Jacobian before each deflation.
    pub fn ranks(&self) -> &[u32] {
        &self.ranks
    }

    /// Whether the given equations are regular there.
    pub fn is_reduced(&self) -> bool {
        self.ranks.is_empty()
    }
}

/// A point of a multiple set.
#[derive(Clone, Debug)]
pub(crate) struct Multiple {
    pub point: DeflatedPoint,
    /// Multiplicity as a scheme; `None` if it is not known.
    pub scheme: Option<u64>,
    /// Paths that ended there.
    pub paths: u64,
    pub dual_dimensions: Vec<u32>,
}

impl Multiple {
    /// A point at which the given equations are regular, to which several paths came.
    pub fn reduced(refined: RefinedPoint, paths: u64) -> Self {
        Self {
            point: DeflatedPoint {
                ranks: Vec::new(),
                refined,
            },
            scheme: Some(1),
            paths,
            dual_dimensions: Vec::new(),
        }
    }
}

/// Refined points with how many paths came to each, each point once.
pub(crate) fn equal_ones_merged(points: Vec<(RefinedPoint, u64)>) -> Vec<(RefinedPoint, u64)> {
    let first = |k: usize| points[k].0.point.first().map_or(0.0, |z| rounded(z).re);
    let mut by_first: Vec<usize> = (0..points.len()).collect();
    by_first.sort_by(|&a, &b| first(a).total_cmp(&first(b)));
    let mut into: Vec<usize> = (0..points.len()).collect();
    for (place, &k) in by_first.iter().enumerate() {
        for &j in &by_first[place + 1..] {
            if first(j) - first(k)
                > SAME * (1.0 + points[k].0.point.len() as f64) * (1.0 + first(k).abs())
            {
                break;
            }
            if into[j] == j && distance(&points[k].0.point, &points[j].0.point) < SAME {
                into[j] = into[k];
            }
        }
    }
    let mut paths = vec![0; points.len()];
    for (k, &into) in into.iter().enumerate() {
        paths[into] += points[k].1;
    }
    let pairs = points.into_iter().zip(paths);
    let merged = pairs.filter(|(_, paths)| *paths > 0);
    merged.map(|((point, _), paths)| (point, paths)).collect()
}

/// A problem, and the systems that were made of it.
pub(crate) struct ProblemContext<'a> {
    pub problem: &'a Problem,
    pub deflations: &'a mut Deflations,
}

impl ProblemContext<'_> {
    /// The system of a stage.
    pub fn system(&mut self, wanted: &StageSystem) -> Arc<System> {
        self.deflations.of_stage(self.problem, wanted)
    }

    /// The system of a stage, with this description.
    pub fn described(&mut self, description: StageSystem) -> DescribedSystem {
        self.deflations.described(self.problem, description)
    }
}

/// Deflated equations by their ranks, made once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Deflations {
    systems: BTreeMap<Vec<u32>, Arc<System>>,
    of_stages: BTreeMap<StageSystem, Arc<System>>,
    sliced: BTreeMap<(Vec<u32>, usize), Arc<SlicedEquations>>,
    /// Slices instead of the problem's.
    slices: Option<Vec<Vec<Complex64>>>,
    movable: Movable,
}

/// Equations by their ranks, compiled once, whose slices are exchanged. A copy begins without them.
#[derive(Debug, Default)]
struct Movable(BTreeMap<Vec<u32>, SlicedEquations>);

impl Clone for Movable {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Deflations {
    /// Equations with these slices instead of the problem's.
    pub fn on_slices(slices: Vec<Vec<Complex64>>) -> Self {
        Self {
            slices: Some(slices),
            ..Self::default()
        }
    }

    fn system(&mut self, problem: &Problem, ranks: &[u32]) -> Arc<System> {
        if let Some(cached_system) = self.systems.get(ranks) {
            return Arc::clone(cached_system);
        }
        let made = match ranks.split_last() {
            None => Arc::clone(&problem.given),
            Some((&rank, before)) => {
                let inner = self.system(problem, before);
                Arc::new(deflated(&inner, rank as usize, ranks.len(), problem.seed()))
            }
        };
        self.systems.insert(ranks.to_vec(), Arc::clone(&made));
        made
    }

    /// The system of a stage.
    pub fn of_stage(&mut self, problem: &Problem, wanted: &StageSystem) -> Arc<System> {
        if let Some(cached_system) = self.of_stages.get(wanted) {
            return Arc::clone(cached_system);
        }
        let made = match wanted {
            StageSystem::Staircase => Arc::clone(&problem.staircase),
            StageSystem::Cut { dimension, factor } => {
                let cut = problem.cut(*dimension, *factor as usize);
                Arc::new(cut.expect("it has been made of equations with degrees"))
            }
            StageSystem::Critical { form } => Arc::new(critical(&problem.curve_equations(), form)),
            StageSystem::Fibre { form, values } => {
                let values = values.map(f64::from_bits);
                Arc::new(fibre(&problem.curve_equations(), form, values))
            }
            StageSystem::Pair { .. } | StageSystem::MultipleCut { .. } | StageSystem::Family => {
                unreachable!("these are of two problems: who asks makes them")
            }
            StageSystem::Sliced { dimension } => {
                Arc::new(slice(&problem.given, *dimension, problem.variables()))
            }
            StageSystem::Whole { ranks, dimension } => {
                let system = self.system(problem, ranks);
                Arc::new(slice(&system, *dimension, problem.variables()))
            }
            StageSystem::Combined {
                dimension,
                seed,
                keep,
            } => {
                let rows = problem.combined(*dimension, *seed, *keep);
                Arc::new(slice(&rows, *dimension, problem.variables()))
            }
            StageSystem::Tracked { ranks, dimension } => {
                let tracked = problem.tracked(&self.system(problem, ranks), *dimension);
                Arc::new(tracked.expect("derivatives of polynomials have degrees"))
            }
            StageSystem::Bent { ranks, dimension } => {
                let (ranks, dimension) = (ranks.clone(), *dimension);
                let tracked = StageSystem::Tracked { ranks, dimension };
                Arc::new(bent(&self.of_stage(problem, &tracked)))
            }
        };
        self.of_stages.insert(wanted.clone(), Arc::clone(&made));
        made
    }

    /// The system of a stage with this description.
    pub fn described(&mut self, problem: &Problem, description: StageSystem) -> DescribedSystem {
        let system = self.of_stage(problem, &description);
        DescribedSystem {
            description,
            system,
        }
    }

    /// The system of a stage, where it has been made.
    pub fn known_stage(&self, wanted: &StageSystem) -> Option<Arc<System>> {
        self.of_stages.get(wanted).cloned()
    }

    /// Keeps the system of a stage that somebody else made.
    pub fn remember_stage(&mut self, wanted: &StageSystem, made: System) -> Arc<System> {
        let made = Arc::new(made);
        self.of_stages.insert(wanted.clone(), Arc::clone(&made));
        made
    }

    fn sliced(
        &mut self,
        problem: &Problem,
        ranks: &[u32],
        dimension: usize,
    ) -> Arc<SlicedEquations> {
        let key = (ranks.to_vec(), dimension);
        if let Some(cached_equations) = self.sliced.get(&key) {
            return Arc::clone(cached_equations);
        }
        let system = self.system(problem, ranks);
        let slices = self.slices.clone();
        let slices = slices.unwrap_or_else(|| problem.slices(dimension));
        let made = Arc::new(SlicedEquations::new(&system, slices));
        self.sliced.insert(key, Arc::clone(&made));
        made
    }

    /// A witness point at which the given equations are regular.
    pub fn reduced_point(
        &mut self,
        problem: &Problem,
        dimension: usize,
        values: &[Complex64],
    ) -> Option<RefinedPoint> {
        let equations = self.sliced(problem, &[], dimension);
        let start: Vec<Number> = values.iter().map(|&z| exactly(z)).collect();
        let refined = refined_from(&equations, &start, dimension);
        refined.filter(|refined| settled(refined, MOVED))
    }

    /// A point of a multiple set with the fewest deflations that make the equations regular there.
    pub fn regular_point(
        &mut self,
        problem: &Problem,
        dimension: usize,
        end: &SingularEnd,
    ) -> Option<DeflatedPoint> {
        let start: Vec<Number> = end.values.iter().map(|&z| exactly(z)).collect();
        let moved = (MOVED_FACTOR * end.accuracy).max(MOVED);
        let mut untried = VecDeque::from([(Vec::new(), start)]);
        for _ in 0..MOST_TRIED {
            let (ranks, start): (Vec<u32>, Vec<Number>) = untried.pop_front()?;
            let equations = self.sliced(problem, &ranks, dimension);
            let refined = refined_from(&equations, &start, dimension);
            if let Some(refined) = refined.filter(|refined| settled(refined, moved)) {
                return Some(DeflatedPoint { ranks, refined });
            }
            if ranks.len() == MOST_DEFLATIONS {
                continue;
            }
            let unknowns = start.len();
            for rank in candidates(&equations.singular_values(&start), end.accuracy) {
                let nodes = self.system(problem, &ranks).expressions.nodes().len();
                if unknowns + rank < MOST_UNKNOWNS && nodes < MOST_NODES {
                    let mut ranks = ranks.clone();
                    ranks.push(rank as u32);
                    let start = self.with_multipliers(problem, dimension, &ranks, &start);
                    untried.push_back((ranks, start));
                }
            }
        }
        None
    }

    /// The point with the multipliers of the last deflation: the solution of linear equations.
    fn with_multipliers(
        &mut self,
        problem: &Problem,
        dimension: usize,
        ranks: &[u32],
        start: &[Number],
    ) -> Vec<Number> {
        let count = ranks.last().map_or(0, |&rank| rank as usize + 1);
        let equations = self.sliced(problem, ranks, dimension);
        let mut longer = start.to_vec();
        longer.resize(start.len() + count, Number::zero(()));
        let (values, columns) = equations.linear_part(&longer, start.len());
        let multipliers = Svd::of(columns).least_squares(&values, count);
        for (place, multiplier) in longer[start.len()..].iter_mut().zip(multipliers) {
            *place = exactly(-multiplier);
        }
        longer
    }

    /// Whether these deflations, which somebody else names, can be made.
    pub fn admits(&mut self, problem: &Problem, ranks: &[u32]) -> bool {
        if ranks.len() > MOST_DEFLATIONS {
            return false;
        }
        let mut unknowns = problem.variables();
        for (depth, &rank) in ranks.iter().enumerate() {
            let rank = rank as usize;
            if rank >= unknowns || unknowns + rank >= MOST_UNKNOWNS {
                return false;
            }
            let system = self.system(problem, &ranks[..depth]);
            if system.expressions.nodes().len() >= MOST_NODES {
                return false;
            }
            unknowns += rank + 1;
        }
        true
    }

    /// Points on these slices, each `None` where the equations are not regular there after these deflations, or
    /// where Newton's method leaves.
    pub fn points_on(
        &mut self,
        problem: &Problem,
        (slices, ranks): (&[Vec<Complex64>], &[u32]),
        points: &[Vec<Complex64>],
    ) -> Vec<Option<RefinedPoint>> {
        let movable_equations = self.movable.0.remove(ranks);
        let mut equations = movable_equations.unwrap_or_else(|| {
            let system = self.system(problem, ranks);
            SlicedEquations::new(&system, Vec::new())
        });
        equations.set_slices(slices.to_vec());
        let mut refine = |values: &Vec<Complex64>| {
            let mut start: Vec<Number> = values.iter().map(|&z| exactly(z)).collect();
            for depth in 1..=ranks.len() {
                start = self.with_multipliers(problem, slices.len(), &ranks[..depth], &start);
            }
            let refined = refined_from(&equations, &start, slices.len());
            refined.filter(|refined| settled(refined, MOVED))
        };
        let refined = points.iter().map(&mut refine).collect();
        self.movable.0.insert(ranks.to_vec(), equations);
        refined
    }

    /// The least gap between singular values that were taken as not 0 and as 0: before each deflation at the rank that
    /// it uses, and after the last at the rank that the dimension leaves. Where there is no further singular value
    /// rounding error stands for it.
    pub fn rank_gap(
        &mut self,
        problem: &Problem,
        (dimension, ranks): (usize, &[u32]),
        point: &RefinedPoint,
    ) -> f64 {
        let mut least = f64::INFINITY;
        for depth in 0..=ranks.len() {
            let system = self.system(problem, &ranks[..depth]);
            let unknowns = system.variable_count();
            let rank = match ranks.get(depth) {
                Some(&rank) => rank as usize,
                None => unknowns - dimension,
            };
            let equations = SlicedEquations::new(&system, Vec::new());
            let values = equations.singular_values(&point.point[..unknowns]);
            let largest = values.first().copied().unwrap_or(0.0);
            let before = rank.checked_sub(1).and_then(|k| values.get(k));
            let before = before.copied().unwrap_or(largest);
            let after = values.get(rank).copied().unwrap_or(0.0);
            least = least.min(before / after.max(f64::EPSILON * largest));
        }
        least
    }

    /// The equations after these deflations.
    pub fn equations(&mut self, problem: &Problem, ranks: &[u32]) -> Arc<System> {
        self.system(problem, ranks)
    }

    /// The set of these points at which the given equations are regular.
    pub fn reduced_set(dimension: usize, points: Vec<RefinedPoint>) -> Option<PureSet> {
        let multiplicity = Multiplicity {
            scheme: Some(1),
            tracked: 1,
            dual_dimensions: Vec::new(),
        };
        (!points.is_empty()).then(|| PureSet {
            dimension,
            ranks: Vec::new(),
            multiplicity,
            points,
        })
    }

    /// The sets of these points of multiple sets: one for each sequence of ranks and each multiplicity.
    pub fn multiple_sets(
        problem: &Problem,
        dimension: usize,
        multiple_points: Vec<Multiple>,
    ) -> Vec<PureSet> {
        let variable_count = problem.variables();
        let mut different: Vec<Multiple> = Vec::new();
        for multiple in multiple_points {
            let place = |m: &Multiple| m.point.refined.point[..variable_count].to_vec();
            let at = place(&multiple);
            let same = |earlier_point: &&mut Multiple| distance(&place(earlier_point), &at) < SAME;
            match different.iter_mut().find(same) {
                Some(earlier_point) => earlier_point.paths += multiple.paths,
                None => different.push(multiple),
            }
        }
        // Points to which as many paths came: on one component each has as many.
        let mut groups: BTreeMap<(Vec<u32>, Option<u64>, u64), Vec<Multiple>> = BTreeMap::new();
        for multiple in different {
            let key = (
                multiple.point.ranks.clone(),
                multiple.scheme,
                multiple.paths,
            );
            groups.entry(key).or_default().push(multiple);
        }
        let mut sets = Vec::new();
        for ((ranks, scheme, tracked), group) in groups {
            let multiplicity = Multiplicity {
                scheme,
                tracked,
                dual_dimensions: group[0].dual_dimensions.clone(),
            };
            let points = group.into_iter().map(|m| m.point.refined).collect();
            sets.push(PureSet {
                dimension,
                ranks,
                multiplicity,
                points,
            });
        }
        sets
    }
}

/// Newton's method from near a point of a set of this dimension on its slices. Where equations are not clearly regular
/// their rank is taken at the point itself, too: a little beside a set of higher dimension they are regular.
fn refined_from(
    equations: &SlicedEquations,
    start: &[Number],
    dimension: usize,
) -> Option<RefinedPoint> {
    let mut refined = equations.refine(start)?;
    if refined.condition >= CLEARLY_CONDITIONED {
        let values = equations.singular_values(&refined.point);
        let rank = start.len() - dimension;
        let least = rank.checked_sub(1).and_then(|k| values.get(k));
        let ends = values.first().zip(least);
        let condition = ends.map_or(f64::INFINITY, |(largest, least)| largest / least);
        // No number: all of them are 0.
        match condition.is_nan() {
            true => refined.condition = f64::INFINITY,
            false => refined.condition = refined.condition.max(condition),
        }
    }
    Some(refined)
}

fn settled(refined: &RefinedPoint, moved: f64) -> bool {
    refined.correction < STEP
        && refined.residual < RESIDUAL
        && refined.condition < SINGULAR
        && refined.moved < moved
}

/// Distance of two points relative to their size.
fn distance(a: &[Number], b: &[Number]) -> f64 {
    let pairs = a.iter().zip(b).map(|(x, y)| (rounded(x), rounded(y)));
    let (mut apart, mut size) = (0.0, 1.0);
    for (x, y) in pairs {
        apart += (x - y).norm_sqr();
        size += x.norm_sqr();
    }
    (apart / size).sqrt()
}

/// Ranks that a matrix with these singular values, descending, can have where its entries have errors of this
/// size, by the gap after them.
fn candidates(values: &[f64], accuracy: f64) -> Vec<usize> {
    let scale = values.first().copied().unwrap_or(0.0).max(1.0);
    let noise = NOISE * accuracy.max(1e-14) * scale;
    let mut gaps: Vec<(f64, usize)> = Vec::new();
    for (rank, &after) in values.iter().enumerate() {
        let before = match rank {
            0 => scale,
            _ => values[rank - 1],
        };
        let gap = before.max(noise) / after.max(noise);
        if after <= SMALL * scale && gap >= GAP {
            gaps.push((gap, rank));
        }
    }
    gaps.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    gaps.truncate(CANDIDATES);
    gaps.into_iter().map(|(_, rank)| rank).collect()
}

/// The equations with the kernel of their Jacobian, which has this rank.
fn deflated(system: &System, rank: usize, depth: usize, seed: u64) -> System {
    let mut result = system.clone();
    let unknowns: Vec<usize> = (0..system.variable_count()).collect();
    let first = unknowns.len();
    let mut random = RandomStream::new(seed, Purpose::Deflation, depth as u64);
    result.equations = deflate(
        &mut result.expressions,
        &system.equations,
        &unknowns,
        first,
        rank,
        &mut random,
    );
    let names = (0..=rank).map(|k| format!("multiplier:{depth}:{k}"));
    result.variables.extend(names);
    result.groups = vec![VariableGroup {
        variables: (0..result.variables.len()).collect(),
        homogeneous: false,
    }];
    let count = result.equations.len();
    result.equation_names = (1..=count).map(|k| format!("equation {k}")).collect();
    result
}
