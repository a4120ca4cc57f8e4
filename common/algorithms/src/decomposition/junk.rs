//! The junk filter: points of a superset that lie on sets of higher dimension are left out.
//!
//! A regular point is isolated on its slice, and no junk. Of a singular one the dual space of all
//! equations on the slice says whether it is isolated (Bates, Hauenstein, Peterson, Sommese 2009); unless it
//! says that it is not, paths on the sets of higher dimension to slices through the point ask whether it is on
//! one of them; with `confirm_junk` also then. Where both speak they must agree.

use super::deflated::{Deflations, Multiple, ProblemContext, PureSet, equal_ones_merged};
use super::job::{Job, StageSystem};
use super::problem::Problem;
use super::superset::{SingularEnd, Superset};
use cognate_continuation::bend::RefinedPoint;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::local_dimension::Question;
use cognate_continuation::local_dimension::candidates::{Candidate, to_stored};
use cognate_continuation::path_result::PathResult;
use cognate_solutions::classification::{Isolation, Verdict, isolation_by};
use cognate_solutions::completeness::Completeness;
use cognate_solutions::witness::{Dimension, Doubt};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Highest order of functionals that are asked for.
const DEPTH: u32 = 12;
/// Condition number below which a point to which Newton's method comes is isolated without further question: on a
/// set of higher dimension, where there is none, rounding errors of doubles leave 1e13 and more.
const CLEARLY_REGULAR: f64 = 1e10;
/// An end of a path is the point within this many times the errors of both; this limit is kept between `NEAR` and
/// `FAR`.
const NEAR_FACTOR: f64 = 100.0;
/// Distance, relative to the size of the point, within which an end of a path is always the point.
const NEAR: f64 = 1e-7;
/// Distance, relative to the size of the point, beyond which an end of a path is another point.
const FAR: f64 = 1e-3;
/// Relative error that is assumed of an end that was called regular and is not.
const ACCURACY: f64 = 1e-9;
/// Most paths that confirm in one dimension what dual spaces and moved slices call junk: where there would be more,
/// points spread evenly among them are asked for all.
const MOST_CONFIRMING: usize = 100_000;

/// Facts about a singular point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Suspect {
    end: SingularEnd,
    isolation: Isolation,
    dual_dimensions: Vec<u32>,
    /// Whether paths ask about it.
    asked: bool,
    /// Whether the point is on a set of higher dimension, by these paths; `None` if that is not clear.
    member: Option<bool>,
}

/// Question of the open stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Asking {
    Nothing,
    Isolation,
    /// Whether these suspects are on this set.
    Membership {
        set: usize,
        suspects: Vec<usize>,
    },
}

/// Tells junk from witness points, dimension by dimension.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct JunkFilter {
    supersets: VecDeque<Superset>,
    /// Several paths may come to a reduced point: sets that meet there were cut one by one.
    shared: bool,
    /// Points need not be isolated solutions of the equations: only paths ask whether they are junk, about all of them.
    by_paths: bool,
    current: Option<Superset>,
    suspects: Vec<Suspect>,
    asking: Asking,
    /// Sets of higher dimension that are still to be asked.
    sets_left: Vec<usize>,
    dimensions: Vec<Dimension>,
}

impl JunkFilter {
    /// `shared`: whether several paths may come to a reduced point.
    pub fn new(supersets: Vec<Superset>, shared: bool) -> Self {
        Self {
            supersets: supersets.into(),
            shared,
            by_paths: false,
            current: None,
            suspects: Vec::new(),
            asking: Asking::Nothing,
            sets_left: Vec::new(),
            dimensions: Vec::new(),
        }
    }

    /// For points of sets that are not components of the equations: as points of whichever multiplicity, each once,
    /// they are all among the singular ends.
    pub fn of_sets(supersets: Vec<Superset>) -> Self {
        Self {
            by_paths: true,
            ..Self::new(supersets, true)
        }
    }

    /// Results of the dimensions, highest first.
    pub fn dimensions(&mut self) -> Vec<Dimension> {
        std::mem::take(&mut self.dimensions)
    }

    /// Learns from the stage that is done, and says which comes next. What is found is added to `sets`.
    pub fn advance(
        &mut self,
        context: &mut ProblemContext<'_>,
        done: Option<&Job>,
        sets: &mut Vec<PureSet>,
    ) -> Option<Job> {
        let problem = context.problem;
        if let Some(job) = done {
            self.learn(problem, job, sets);
        }
        loop {
            if self.current.is_some() {
                if let Some(job) = self.membership(context, sets) {
                    return Some(job);
                }
                let regular = self.refine(context);
                if let Some(dimension) = self.suspect(&regular) {
                    self.sets_left = (0..sets.len()).collect();
                    self.asking = Asking::Isolation;
                    return Some(self.isolate(problem, dimension));
                }
                self.settle(context, regular, sets);
            }
            let superset = self.supersets.pop_front()?;
            let superset = match self.by_paths {
                true => superset,
                false => self.regular_at_once(context, superset),
            };
            self.suspects = superset.singular.iter().map(Suspect::new).collect();
            self.sets_left = (0..sets.len()).collect();
            let dimension = superset.dimension;
            self.current = Some(superset);
            if !self.suspects.is_empty() && !self.by_paths {
                self.asking = Asking::Isolation;
                return Some(self.isolate(problem, dimension));
            }
        }
    }

    /// The superset with its ends that the tracker called singular for their condition, and that Newton's method
    /// finds regular, among the regular ones: these are isolated.
    fn regular_at_once(
        &self,
        context: &mut ProblemContext<'_>,
        mut superset: Superset,
    ) -> Superset {
        let dimension = superset.dimension;
        for end in std::mem::take(&mut superset.singular) {
            let regular = end.paths == 1
                && context
                    .deflations
                    .reduced_point(context.problem, dimension, &end.values)
                    .is_some_and(|refined| refined.condition < CLEARLY_REGULAR);
            match regular {
                true => superset.regular.push(end.values),
                false => superset.singular.push(end),
            }
        }
        superset
    }

    /// The ends that the tracker called regular, refined on the given equations; `None`: they are not regular there.
    fn refine(&self, context: &mut ProblemContext<'_>) -> Vec<Option<RefinedPoint>> {
        let (problem, deflations) = (context.problem, &mut *context.deflations);
        let regular = |superset: &Superset| -> Vec<Option<RefinedPoint>> {
            let ends = superset.regular.iter();
            ends.map(|end| deflations.reduced_point(problem, superset.dimension, end))
                .collect()
        };
        self.current.as_ref().map(regular).unwrap_or_default()
    }

    /// Takes ends that are not regular after all among those of which it is asked whether they are isolated; the
    /// dimension, where there are some.
    fn suspect(&mut self, regular: &[Option<RefinedPoint>]) -> Option<usize> {
        let superset = self.current.as_mut().filter(|_| !self.by_paths)?;
        let ends = std::mem::take(&mut superset.regular);
        let (mut kept, mut some) = (Vec::with_capacity(ends.len()), false);
        for (values, refined) in ends.into_iter().zip(regular) {
            if refined.is_some() {
                kept.push(values);
                continue;
            }
            some = true;
            let end = SingularEnd {
                values,
                accuracy: ACCURACY,
                paths: 1,
            };
            self.suspects.push(Suspect::new(&end));
            superset.singular.push(end);
        }
        superset.regular = kept;
        some.then_some(superset.dimension)
    }

    fn isolate(&self, problem: &Problem, dimension: usize) -> Job {
        let system = StageSystem::Sliced { dimension };
        let candidate = |suspect: &Suspect| Candidate {
            values: suspect.end.values.clone(),
            target: 0,
            question: Question {
                accuracy: suspect.end.accuracy,
                bound: u64::MAX,
                depth: DEPTH,
            },
        };
        let candidates: Vec<Candidate> = self.suspects.iter().map(candidate).collect();
        let (points, parameters) = (to_stored(&candidates), problem.slices(dimension).concat());
        Job::isolate(system, parameters, points, &problem.tracking)
    }

    /// Paths on the next set that may hold points about which something is to be learnt.
    fn membership(&mut self, context: &mut ProblemContext<'_>, sets: &[PureSet]) -> Option<Job> {
        let problem = context.problem;
        while !self.sets_left.is_empty() {
            let set = self.sets_left.remove(0);
            let asks = |suspect: &Suspect| suspect.asked && suspect.member != Some(true);
            let places = 0..self.suspects.len();
            let suspects: Vec<usize> = places.filter(|&k| asks(&self.suspects[k])).collect();
            if suspects.is_empty() {
                continue;
            }
            let pure_set = &sets[set];
            let start = problem.slices(pure_set.dimension).concat();
            let through =
                |&k: &usize| slices_through(problem, pure_set, &self.suspects[k].end.values);
            let targets = suspects.iter().map(through).collect();
            let homotopy = HomotopyKind::Parameter { start, targets };
            let points = pure_set.doubles();
            self.asking = Asking::Membership { set, suspects };
            let system = context.described(pure_set.tracked());
            let job = Job::track(system, homotopy, &points, &problem.tracking);
            return Some(job.ends_only());
        }
        None
    }

    fn learn(&mut self, problem: &Problem, job: &Job, sets: &[PureSet]) {
        match std::mem::replace(&mut self.asking, Asking::Nothing) {
            Asking::Nothing => {}
            Asking::Isolation => {
                for (suspect, result) in self.suspects.iter_mut().zip(job.answers()) {
                    let ItemResult::LocalDimension(result) = result else {
                        unreachable!("a stage that looks at endpoints has no {result:?}")
                    };
                    suspect.isolation = Isolation::Undecided;
                    if let Some(local_dimension) = result.fact() {
                        suspect.isolation =
                            isolation_by(local_dimension, &problem.tracking.tolerances);
                        suspect
                            .dual_dimensions
                            .clone_from(&local_dimension.dual_dimensions);
                    }
                }
                self.choose_asked(problem, sets);
            }
            Asking::Membership { set, suspects } => {
                let ends = job.ends();
                let paths = sets[set].points.len();
                for (place, ends) in suspects.iter().zip(ends.chunks(paths)) {
                    let suspect = &mut self.suspects[*place];
                    let is_on_set = nearest(&suspect.end, ends);
                    suspect.member = match (suspect.member, is_on_set) {
                        (_, Some(true)) => Some(true),
                        (earlier_membership, Some(false)) => earlier_membership,
                        (_, None) => None,
                    };
                }
            }
        }
    }

    /// Chooses the points about which paths ask: all that are not clear, and of clear junk as many as there is time
    /// for.
    fn choose_asked(&mut self, problem: &Problem, sets: &[PureSet]) {
        let clear = |suspect: &&mut Suspect| suspect.isolation == Isolation::PositiveDimensional;
        let count = self.suspects.iter_mut().filter(clear).count();
        let degree: usize = sets.iter().map(|set| set.points.len()).sum();
        let chosen = match problem.confirm_junk {
            true => (MOST_CONFIRMING / degree.max(1)).clamp(1, count.max(1)),
            false => 0,
        };
        for (k, suspect) in self.suspects.iter_mut().filter(clear).enumerate() {
            suspect.asked = k * chosen / count != (k + 1) * chosen / count;
        }
    }

    /// Decides about the points of the current dimension.
    fn settle(
        &mut self,
        context: &mut ProblemContext<'_>,
        refined: Vec<Option<RefinedPoint>>,
        sets: &mut Vec<PureSet>,
    ) {
        let Some(mut superset) = self.current.take() else {
            return;
        };
        // Refined ones are in their place.
        let regular_ends = std::mem::take(&mut superset.regular).len() as u64;
        let dimension = superset.dimension;
        let mut judged = self.judge_suspects(context, dimension, sets);
        for point in refined {
            match point {
                Some(point) => judged.regular.push((point, 1)),
                None => judged.not_deflated += 1,
            }
        }
        let mut single = Vec::new();
        for (refined, paths) in equal_ones_merged(std::mem::take(&mut judged.regular)) {
            match paths {
                1 => single.push(refined),
                _ if self.shared => judged.multiple.push(Multiple::reduced(refined, paths)),
                // Two paths that came to one regular point: one of them has left its way.
                _ => judged.unclear += paths,
            }
        }
        let multiple_points = std::mem::take(&mut judged.multiple);
        sets.extend(Deflations::reduced_set(dimension, single));
        sets.extend(Deflations::multiple_sets(
            context.problem,
            dimension,
            multiple_points,
        ));
        let singular: u64 = superset.singular.iter().map(|end| end.paths).sum();
        self.dimensions.push(Dimension {
            number: dimension as u32,
            superset: regular_ends + singular,
            junk: judged.junk,
            removed: 0,
            excess: superset.excess,
            failed: superset.failed,
            found_by_loops: 0,
            degree: 0,
            complete: Completeness::NotKnown,
            doubts: judged.doubts(&superset),
        });
    }

    /// Judges the suspects of a dimension, which are taken, where these sets of higher dimension are known.
    fn judge_suspects(
        &mut self,
        context: &mut ProblemContext<'_>,
        dimension: usize,
        higher_sets: &[PureSet],
    ) -> JudgedPoints {
        let mut judged = JudgedPoints::default();
        for suspect in std::mem::take(&mut self.suspects) {
            let paths = suspect.end.paths;
            match suspect.is_isolated(higher_sets) {
                Some(false) => judged.junk += paths,
                None => judged.unclear += paths,
                Some(true) => {
                    let scheme = match suspect.isolation {
                        Isolation::Isolated { multiplicity } => Some(u64::from(multiplicity)),
                        _ => None,
                    };
                    let end = &suspect.end;
                    let problem = context.problem;
                    match context.deflations.regular_point(problem, dimension, end) {
                        // The tracker called it singular for its condition.
                        Some(point) if point.is_reduced() => {
                            judged.regular.push((point.refined, paths));
                        }
                        Some(point) => judged.multiple.push(Multiple {
                            point,
                            scheme,
                            paths,
                            dual_dimensions: suspect.dual_dimensions,
                        }),
                        None => judged.not_deflated += paths,
                    }
                }
            }
        }
        judged
    }
}

/// Points of one dimension as they were judged: witness points, and numbers of paths to the other points.
#[derive(Default)]
struct JudgedPoints {
    /// Reduced witness points, each with the number of paths to it.
    regular: Vec<(RefinedPoint, u64)>,
    multiple: Vec<Multiple>,
    /// Paths to points on sets of higher dimension.
    junk: u64,
    /// Paths to points of which it is not clear whether they are junk.
    unclear: u64,
    /// Paths to points for which no equations were found that are regular there.
    not_deflated: u64,
}

impl JudgedPoints {
    /// The doubts about the dimension of this superset.
    fn doubts(&self, superset: &Superset) -> Vec<Doubt> {
        let (failed, asked, not_cut) = (superset.failed, superset.unclear, superset.not_cut);
        let (junk, not_deflated) = (self.unclear, self.not_deflated);
        let doubts = [
            (failed, Doubt::FailedPaths { paths: failed }),
            (asked, Doubt::Asked { points: asked }),
            (not_cut, Doubt::NotCut { points: not_cut }),
            (junk, Doubt::Junk { points: junk }),
            (
                not_deflated,
                Doubt::NotDeflated {
                    points: not_deflated,
                },
            ),
        ];
        let doubts = doubts.into_iter().filter(|(count, _)| *count > 0);
        doubts.map(|(_, doubt)| doubt).collect()
    }
}

impl Suspect {
    fn new(end: &SingularEnd) -> Self {
        Self {
            end: end.clone(),
            isolation: Isolation::Undecided,
            dual_dimensions: Vec::new(),
            asked: true,
            member: Some(false),
        }
    }

    /// Whether the point is isolated by its dual space and by paths on these sets; `None` where that is not clear.
    fn is_isolated(&self, higher_sets: &[PureSet]) -> Option<bool> {
        match (self.isolation, self.member) {
            (Isolation::PositiveDimensional, Some(false)) if self.asked => None,
            (Isolation::PositiveDimensional, _) if !higher_sets.is_empty() => Some(false),
            (Isolation::Undecided, Some(true)) => Some(false),
            (Isolation::Isolated { .. } | Isolation::Undecided, Some(false)) => Some(true),
            _ => None,
        }
    }
}

/// The slices of a set, moved in parallel until they pass the point.
fn slices_through(problem: &Problem, pure_set: &PureSet, point: &[Complex64]) -> Vec<Complex64> {
    let mut rows = problem.slices(pure_set.dimension);
    for row in &mut rows {
        let terms = row[1..].iter().zip(point);
        row[0] = -terms.map(|(c, x)| c * x).sum::<Complex64>();
    }
    rows.concat()
}

/// Whether a path ends at the point: yes, no, or not clear.
fn nearest(
    point: &SingularEnd,
    ends: &[(
        &PathResult,
        cognate_solutions::classification::Decision,
        Vec<Complex64>,
    )],
) -> Option<bool> {
    let mut answer = Some(false);
    let length =
        |v: &mut dyn Iterator<Item = Complex64>| v.map(|z| z.norm_sqr()).sum::<f64>().sqrt();
    let size = length(&mut point.values.iter().copied()).max(1.0);
    for (result, decision, values) in ends {
        match decision.verdict {
            Verdict::AtInfinity => continue,
            Verdict::Failed | Verdict::WithinDataAccuracy => {
                answer = None;
                continue;
            }
            _ => {}
        }
        let pairs = point.values.iter().zip(values);
        let distance = length(&mut pairs.map(|(a, b)| a - b)) / size;
        let errors = point.accuracy + result.accuracy;
        if distance <= (NEAR_FACTOR * errors).clamp(NEAR, FAR) {
            return Some(true);
        }
        if distance <= FAR {
            answer = None;
        }
    }
    answer
}
