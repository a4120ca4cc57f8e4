//! SolutionSet: what a solve found, with counts that add up.
//!
//! Made from the last results of all paths of one target. Equal results give an equal set, for all workers and all
//! sizes of chunks.

use crate::approximate::{Approximate, ExcessEnds};
use crate::branches::{BranchDecision, Branches, FalseBranches};
use crate::certificates::CertifiedSystem;
use crate::classification::{
    Decision, Isolation, Tolerances, Verdict, classify, isolation, solves,
};
use crate::completeness::Completeness;
use crate::degenerate::{self, DeclaredSets};
use crate::denominators::{AskedPoint, Denominator, Denominators};
use crate::failed_path::{FailedPath, FailureReason};
use crate::involution::Involution;
use crate::path_crossing::{broken_cycles, coincidences, crossings, neighbourhood};
use crate::point_shape::PointShape;
use crate::real::{is_real, write_as_real};
use crate::solution::Solution;
use crate::summary::{ClassCounts, PathCounts, SolutionCounts};
use crate::symmetry::classes;
use crate::weak_evidence::{Expected, WeakEvidence, is_in_cluster};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_systems::helper_unknown::FALSE_BRANCH;
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::ZERO_DENOMINATOR;
use ill_conditioned::ill_conditioned;
use mirror::without_conjugate;
use num_complex::Complex64;
use open_questions::{OpenQuestions, multiplicities_are_not_confirmed, winding_numbers_do_not_fit};
use serde::{Deserialize, Serialize};

mod ill_conditioned;
mod isolated_by_count;
mod mirror;
mod open_questions;
mod singular_digits;

/// Facts about a solve that the last results of its paths do not show.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct History {
    /// Number of times that a path was tracked again.
    pub retracked: u64,
    /// Crossings that were seen.
    pub crossings_found: u64,
    /// Crossings whose paths came apart.
    pub crossings_resolved: u64,
    /// True when the start system bounds the solutions, so that every isolated
    /// solution and every positive-dimensional set has a path that ends on it.
    pub complete_start: bool,
    /// Reason why solutions may be missing though every path is accounted for: a limit of the start or of the method.
    /// Without a reason a complete start gives a complete answer.
    pub may_miss: Option<String>,
    /// Number of results that are images of others (see `images`).
    pub images: u64,
    /// Least number of paths that end on positive-dimensional sets, where there are such sets: fewer paths end at
    /// points.
    pub least_on_sets: u64,
    /// True where the ends of further paths are counted apart, among which conjugates may be.
    pub is_part: bool,
}

/// The finished answer for one target.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolutionSet {
    /// Every path, counted once.
    pub paths: PathCounts,
    /// The solutions, counted.
    pub counts: SolutionCounts,
    /// Symmetry classes, counted.
    pub classes: ClassCounts,
    /// The solutions, by their first paths.
    pub solutions: Vec<Solution>,
    /// Finite singular points of which it is not known whether they are isolated, by their first
    /// paths: in no count of solutions.
    pub undecided: Vec<Solution>,
    /// The paths that failed, ascending.
    pub failed: Vec<FailedPath>,
    /// The paths that end on positive-dimensional solution sets, ascending.
    pub on_positive_dimensional_sets: Vec<u64>,
    /// The paths that end at points that were taken away from the answer, ascending.
    #[serde(default)]
    pub removed: Vec<u64>,
    /// The paths that failed, or ended where no solution is, though all solutions are known without paths, ascending.
    #[serde(default)]
    pub at_no_solution: Vec<u64>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// The system to which the certificates refer, where there are certificates.
    pub certified_system: Option<CertifiedSystem>,
    /// Verdicts that rest on too little; none where an exact count agrees. The paths are among those that are
    /// counted as decided by the limit of the precision.
    pub weak_evidence: WeakEvidence,
    /// Paths that were taken to infinity together with others.
    pub in_clusters_at_infinity: u64,
    /// Reason why the solutions were not counted without paths; `None` where they were.
    pub no_exact_count: Option<String>,
    /// Points on false branches, which an exact count of the polynomial equations holds, too. Not stored: the count is
    /// compared where the set is made.
    #[serde(skip)]
    pub false_branches: FalseBranches,
    /// Points of least residual, where they were asked for.
    #[serde(default)]
    pub approximate: Option<Approximate>,
    /// Ends of the excess paths of more equations than unknowns. Not stored: points of least residual are looked for where
    /// the set is made.
    #[serde(skip)]
    pub excess_ends: ExcessEnds,
}

impl SolutionSet {
    /// True when no path failed, every crossing came apart, of every endpoint that is on no declared set it
    /// is known whether it is isolated, none is infinite but for digits beyond the accuracy of the data, none is finite or at infinity only by the limit of the precision, and
    /// multiplicities are what the numbers of paths say, no solution lacks its conjugate, no exact count says otherwise, and the answer is not known to
    /// be incomplete.
    pub fn settled(&self) -> bool {
        self.is_settled_as_far_as_it_goes() && self.counts.complete != Completeness::No
    }

    /// True as [`Self::settled`], but also for an answer that is known to be incomplete.
    pub fn is_settled_as_far_as_it_goes(&self) -> bool {
        self.paths.failed == 0
            && self.counts.undecided == 0
            && self.counts.doubtful_denominators == 0
            && self.paths.within_data_accuracy == 0
            && self.paths.decided_by_precision_limit == 0
            && self.counts.doubtful_multiplicity == 0
            && self.counts.without_conjugate == 0
            && self.classes.doubt.is_none()
            && self.paths.crossings_found == self.paths.crossings_resolved
            && self
                .counts
                .exact_count
                .as_ref()
                .is_none_or(|count| count.agrees)
    }

    /// The solutions, and after them the points of which it is not known whether they are isolated.
    pub fn points(&self) -> impl Iterator<Item = &Solution> {
        self.solutions.iter().chain(&self.undecided)
    }

    /// From the last result of every path of one target, ascending by path.
    ///
    /// `parameters` are the system's parameters at the target.
    pub fn new(
        system: &System,
        parameters: &[Complex64],
        results: &[PathResult],
        history: &History,
        tolerances: &Tolerances,
        seed: u64,
    ) -> Self {
        Draft::new(system, parameters, results, tolerances, seed).finish(history)
    }
}

/// A set in the making.
struct Draft<'a> {
    system: &'a System,
    parameters: &'a [Complex64],
    results: &'a [PathResult],
    tolerances: &'a Tolerances,
    seed: u64,
    shape: PointShape,
    decisions: Vec<Decision>,
    /// Whether each endpoint lies on a declared set of which no point was seen to be isolated.
    on_declared_sets: Vec<bool>,
    /// The endpoints in each declared set, by their places.
    in_declared_sets: Vec<(String, Vec<usize>)>,
    /// First paths of the points of which it is not known whether a denominator is 0 there.
    doubtful_denominators: Vec<u64>,
    /// First paths of the points of which it is not known whether a root is on a false branch.
    doubtful_branches: Vec<u64>,
    set: SolutionSet,
}

impl<'a> Draft<'a> {
    fn new(
        system: &'a System,
        parameters: &'a [Complex64],
        results: &'a [PathResult],
        tolerances: &'a Tolerances,
        seed: u64,
    ) -> Self {
        let shape = PointShape::of(system);
        let decisions = results
            .iter()
            .map(|result| classify(result, &shape, tolerances))
            .collect();
        Self {
            system,
            parameters,
            results,
            tolerances,
            seed,
            shape,
            decisions,
            on_declared_sets: vec![false; results.len()],
            in_declared_sets: Vec::new(),
            doubtful_denominators: Vec::new(),
            doubtful_branches: Vec::new(),
            set: SolutionSet::default(),
        }
    }

    fn finish(mut self, history: &History) -> SolutionSet {
        self.fail_what_still_crosses();
        self.settle_declared_sets();
        self.absorb_regular_ends();
        self.fail_what_coincides();
        self.fail_what_doubles_do_not_hold();
        self.remove_zero_denominators();
        self.remove_false_branches();
        self.list_failures();
        self.weigh_evidence(history);
        self.count_paths(history);
        self.set.excess_ends =
            ExcessEnds::of(self.results, &self.decisions, &self.shape, self.parameters);
        let representatives = self.merge(history);
        self.decide_reality(&representatives, history);
        self.count_solutions(history, &representatives);
        self.find_classes();
        self.judge_completeness(history);
        self.warn();
        self.set
    }

    /// Of paths that end at one regular point only one can belong there.
    fn fail_what_still_crosses(&mut self) {
        let left = crossings(
            self.results,
            &self.decisions,
            &self.shape,
            self.tolerances,
            self.seed,
        );
        for place in left.iter().flat_map(|members| &members[1..]) {
            self.decisions[*place].verdict = Verdict::Failed;
        }
    }

    /// Of the singular endpoints in a declared set a few were asked whether they are isolated; if one
    /// shows the set and none is isolated, all are on it.
    fn settle_declared_sets(&mut self) {
        let sets = DeclaredSets::of(self.system);
        let members = sets.members(
            self.parameters,
            self.results,
            &self.decisions,
            &self.shape,
            self.tolerances,
        );
        for (name, members) in sets.names().zip(members) {
            let (asked, others): (Vec<usize>, Vec<usize>) = members
                .iter()
                .partition(|&&place| self.results[place].local_dimension.is_some());
            let answers = |wanted: fn(&Isolation) -> bool| {
                asked
                    .iter()
                    .any(|&place| wanted(&isolation(&self.results[place], self.tolerances)))
            };
            let on_set = answers(|answer| *answer == Isolation::PositiveDimensional);
            let alone = answers(|answer| matches!(answer, Isolation::Isolated { .. }));
            if !alone {
                members
                    .iter()
                    .for_each(|&place| self.on_declared_sets[place] = true);
            }
            if on_set && !alone {
                for place in asked.into_iter().chain(others) {
                    self.decisions[place].verdict = Verdict::PositiveDimensional;
                }
            }
            self.in_declared_sets.push((name.to_string(), members));
        }
    }

    /// One point is not both regular and singular: an endpoint that was taken for regular and coincides
    /// with singular ones is one of theirs; with one on a set of solutions it is not decided. Several singular ends
    /// that coincide are no regular point, whatever each was found to be.
    fn absorb_regular_ends(&mut self) {
        let finite = |verdict: Verdict| verdict == Verdict::Finite;
        let singular =
            |verdict: Verdict| verdict.may_be_multiple() || verdict == Verdict::PositiveDimensional;
        let ends_singularly = |place: usize| self.results[place].outcome == PathOutcome::Singular;
        if !(0..self.results.len())
            .any(|k| singular(self.decisions[k].verdict) || ends_singularly(k))
        {
            return;
        }
        let points = coincidences(
            self.results,
            &self.shape,
            self.tolerances,
            self.seed,
            |place| {
                finite(self.decisions[place].verdict) || singular(self.decisions[place].verdict)
            },
        );
        for members in points {
            let others = members.iter().map(|&m| self.decisions[m].verdict);
            let verdict = match others.filter(|&v| !finite(v)).min() {
                None if members.len() > 1 && members.iter().any(|&m| ends_singularly(m)) => {
                    Verdict::Singular
                }
                None => continue,
                Some(Verdict::Singular) => Verdict::Singular,
                Some(_) => Verdict::Undecided,
            };
            for member in members {
                if finite(self.decisions[member].verdict) {
                    self.decisions[member].verdict = verdict;
                }
            }
        }
    }

    /// Whether ends coincide depends a little on which others are looked at with them. What counts as regular is looked
    /// at by itself until no two are at one point.
    fn fail_what_coincides(&mut self) {
        loop {
            let finite = |place: usize| self.decisions[place].verdict == Verdict::Finite;
            let points = coincidences(
                self.results,
                &self.shape,
                self.tolerances,
                self.seed,
                finite,
            );
            let others: Vec<usize> = points
                .into_iter()
                .flat_map(|members| members.into_iter().skip(1))
                .collect();
            if others.is_empty() {
                return;
            }
            for place in others {
                self.decisions[place].verdict = Verdict::Failed;
            }
        }
    }

    /// Ends with a coordinate that is too large for a double have no place among the solutions.
    fn fail_what_doubles_do_not_hold(&mut self) {
        for (result, decision) in self.results.iter().zip(&mut self.decisions) {
            let may_be_listed =
                decision.verdict == Verdict::Finite || decision.verdict.may_be_multiple();
            if may_be_listed && is_beyond_doubles(&self.shape, result) {
                decision.verdict = Verdict::Failed;
            }
        }
    }

    /// Takes away the points where a denominator of the given equations is 0.
    fn remove_zero_denominators(&mut self) {
        let (parameters, tolerances, seed) = (self.parameters, self.tolerances, self.seed);
        let Some(denominators) = Denominators::of(self.system, parameters, tolerances, seed) else {
            return;
        };
        let mut removed = 0;
        for members in self.finite_points() {
            let first = members[0];
            let best = self.most_accurate(&members);
            let result = &self.results[best];
            let verdict = self.decisions[best].verdict;
            let values = self.shape.to_variables(result.endpoint.to_double());
            let point = AskedPoint {
                values: &values,
                accuracy: result.accuracy,
                singular: verdict != Verdict::Finite,
                isolated: verdict != Verdict::PositiveDimensional,
            };
            match denominators.within_data(point, result.condition) {
                Denominator::Nonzero => {}
                Denominator::Doubtful => {
                    let path = self.results[first].origin.0;
                    self.doubtful_denominators.push(path);
                }
                Denominator::Zero => {
                    // Points of one set are not told apart.
                    removed += u64::from(verdict != Verdict::PositiveDimensional);
                    for member in members {
                        self.decisions[member].verdict = Verdict::Removed;
                    }
                }
            }
        }
        let counts = &mut self.set.counts.removed;
        counts.insert(ZERO_DENOMINATOR.into(), removed);
    }

    /// Takes away the points where a root is another than the one that was typed.
    fn remove_false_branches(&mut self) {
        let (parameters, tolerances, seed) = (self.parameters, self.tolerances, self.seed);
        let Some(branches) = Branches::of(self.system, parameters, tolerances, seed) else {
            return;
        };
        let mut removed = FalseBranches::default();
        let mut false_on_sets = Vec::new();
        for members in self.finite_points() {
            let best = self.most_accurate(&members);
            let result = &self.results[best];
            let verdict = self.decisions[best].verdict;
            let values = self.shape.to_variables(result.endpoint.to_double());
            let point = AskedPoint {
                values: &values,
                accuracy: result.accuracy,
                singular: verdict != Verdict::Finite,
                isolated: verdict != Verdict::PositiveDimensional,
            };
            let decision = branches.at(point, result.condition);
            let paths = members.len() as u64;
            match decision {
                BranchDecision::Meant => continue,
                BranchDecision::Doubtful => {
                    let path = self.results[members[0]].origin.0;
                    self.doubtful_branches.push(path);
                    continue;
                }
                BranchDecision::False if verdict == Verdict::PositiveDimensional => {
                    // Points of one set are not told apart, and other points of the set may be on the meant branch.
                    false_on_sets.push(members);
                    continue;
                }
                BranchDecision::False => {
                    removed.distinct += 1;
                    removed.nonsingular += u64::from(verdict == Verdict::Finite);
                    removed.with_multiplicity += self.multiplicity(paths, result);
                }
            }
            for member in members {
                self.decisions[member].verdict = Verdict::Removed;
            }
        }
        let is_on_set = |decision: &Decision| decision.verdict == Verdict::PositiveDimensional;
        let ends = self
            .decisions
            .iter()
            .filter(|decision| is_on_set(decision))
            .count();
        let is_meant = ends > false_on_sets.iter().map(Vec::len).sum::<usize>();
        for members in false_on_sets {
            if !is_meant {
                // A set of which no end is on the meant branch.
                self.doubtful_branches
                    .push(self.results[members[0]].origin.0);
                continue;
            }
            removed.on_sets += members.len() as u64;
            for member in members {
                self.decisions[member].verdict = Verdict::Removed;
            }
        }
        let counts = &mut self.set.counts.removed;
        counts.insert(FALSE_BRANCH.into(), removed.distinct);
        self.set.false_branches = removed;
    }

    /// The finite endpoints, by their places: those that coincide together.
    fn finite_points(&self) -> Vec<Vec<usize>> {
        let verdict = |place: usize| self.decisions[place].verdict;
        // No two are at one point: see `fail_what_coincides`.
        let finite = (0..self.results.len()).filter(|&place| verdict(place) == Verdict::Finite);
        let mut points: Vec<Vec<usize>> = finite.map(|place| vec![place]).collect();
        let singular = |place: usize| {
            verdict(place).may_be_multiple() || verdict(place) == Verdict::PositiveDimensional
        };
        let (results, shape) = (self.results, &self.shape);
        let coinciding = coincidences(results, shape, self.tolerances, self.seed, singular);
        points.extend(coinciding);
        points
    }

    fn list_failures(&mut self) {
        for (result, decision) in self.results.iter().zip(&self.decisions) {
            if decision.verdict != Verdict::Failed {
                continue;
            }
            let reason = match result.outcome {
                PathOutcome::Failed(failure) => FailureReason::Tracking(failure),
                _ if !self.shape.holds(result.endpoint.to_double()) => FailureReason::DamagedResult,
                _ if !solves(result, self.tolerances) => FailureReason::NoSolution,
                _ if is_beyond_doubles(&self.shape, result) => FailureReason::BeyondDoubles,
                _ => FailureReason::Crossing,
            };
            self.set.failed.push(FailedPath {
                path: result.origin.0,
                reason,
                t: result.t.norm_sqr().sqrt(),
            });
        }
    }

    fn weigh_evidence(&mut self, history: &History) {
        let (results, decisions) = (self.results, &self.decisions);
        let is_square = self.system.equation_count() == self.system.dimension();
        let expected = Expected {
            every_solution: history.complete_start,
            least_on_sets: if is_square { history.least_on_sets } else { 0 },
        };
        self.set.weak_evidence =
            WeakEvidence::of(self.system, &self.shape, results, decisions, expected);
        let in_clusters = results.iter().zip(decisions).filter(|(result, decision)| {
            decision.verdict == Verdict::AtInfinity && is_in_cluster(result)
        });
        self.set.in_clusters_at_infinity = in_clusters.count() as u64;
    }

    fn count_paths(&mut self, history: &History) {
        let count = |verdict: Verdict| {
            let of_it = self.decisions.iter().filter(|d| d.verdict == verdict);
            of_it.count() as u64
        };
        let singular = count(Verdict::Singular);
        let on_sets = count(Verdict::PositiveDimensional);
        let mut paths = PathCounts {
            total: self.results.len() as u64,
            finite: count(Verdict::Finite),
            singular,
            positive_dimensional: Some(on_sets),
            undecided: count(Verdict::Undecided),
            within_data_accuracy: count(Verdict::WithinDataAccuracy),
            excess: Some(count(Verdict::ExcessSolution)),
            removed: count(Verdict::Removed),
            at_infinity: count(Verdict::AtInfinity),
            failed: count(Verdict::Failed),
            retracked: history.retracked,
            crossings_found: history.crossings_found,
            crossings_resolved: history.crossings_resolved,
            decided_by_precision_limit: {
                let by_limit = self.decisions.iter().filter(|d| d.by_precision_limit);
                by_limit.count() as u64 + self.set.weak_evidence.paths()
            },
            degenerate: {
                let sets = std::mem::take(&mut self.in_declared_sets).into_iter();
                let kept = |k: &usize| self.decisions[*k].verdict != Verdict::Removed;
                sets.map(|(name, mut members)| {
                    members.retain(kept);
                    (name, members.len() as u64)
                })
                .collect()
            },
            images: history.images,
            decided_by_exact_count: {
                let aside = |result: &&PathResult| result.outcome == PathOutcome::PutAside;
                self.results.iter().filter(aside).count() as u64
            },
            ..PathCounts::default()
        };
        for result in self.results {
            *paths.by_precision.entry(result.precision_bits).or_default() += 1;
        }
        paths.highest_precision_bits = paths.by_precision.keys().copied().max().unwrap_or(0);
        assert_eq!(paths.sum(), paths.total, "every path is in one class");
        self.set.paths = paths;
        let with = |verdict: Verdict| -> Vec<u64> {
            let places = self.results.iter().zip(&self.decisions);
            places
                .filter(|(_, decision)| decision.verdict == verdict)
                .map(|(result, _)| result.origin.0)
                .collect()
        };
        let on_sets = with(Verdict::PositiveDimensional);
        self.set.removed = with(Verdict::Removed);
        self.set.on_positive_dimensional_sets = on_sets;
    }

    /// Solutions from finite endpoints; returns the place of the result that stands for each.
    fn merge(&mut self, history: &History) -> Vec<usize> {
        let mut placed_solutions: Vec<(usize, Solution)> = Vec::new();
        let mut undecided: Vec<Solution> = Vec::new();
        let mut broken = Vec::new();
        for verdict in [Verdict::Finite, Verdict::Singular, Verdict::Undecided] {
            let chosen = |place: usize| {
                let declared = self.on_declared_sets[place] && verdict == Verdict::Undecided;
                self.decisions[place].verdict == verdict && !declared
            };
            let groups = match verdict {
                // No two are at one point: see `fail_what_coincides`.
                Verdict::Finite => (0..self.results.len())
                    .filter(|place| chosen(*place))
                    .map(|place| vec![place])
                    .collect(),
                _ => coincidences(
                    self.results,
                    &self.shape,
                    self.tolerances,
                    self.seed,
                    chosen,
                ),
            };
            for members in groups {
                let solution = self.solution(&members, verdict);
                if !broken_cycles(self.results, &members).is_empty() {
                    broken.push(members[0]);
                }
                match verdict {
                    Verdict::Undecided => undecided.push(solution.1),
                    _ => placed_solutions.push(solution),
                }
            }
        }
        self.compare_multiplicities(history, &placed_solutions);
        if let Some(&first) = broken.first() {
            let first_path = self.results[first].origin.0;
            let warning = winding_numbers_do_not_fit(broken.len(), first_path);
            self.set.warnings.push(warning);
        }
        placed_solutions.sort_by_key(|(_, solution)| solution.paths[0]);
        undecided.sort_by_key(|point| point.paths[0]);
        self.set.undecided = undecided;
        let (representatives, solutions) = placed_solutions.into_iter().unzip();
        self.set.solutions = solutions;
        representatives
    }

    /// As many paths end at an isolated point as its dual space has dimensions, where all paths of
    /// a complete start are known and the equations were tracked as they are, and no fewer where combinations were.
    /// Where that is not so, points were taken for one, or one for several.
    fn compare_multiplicities(
        &mut self,
        history: &History,
        placed_solutions: &[(usize, Solution)],
    ) {
        let square = self.system.equation_count() == self.system.dimension();
        if !history.complete_start || !self.set.failed.is_empty() {
            return;
        }
        let differing: Vec<u64> = placed_solutions
            .iter()
            .filter(|(_, solution)| solution.singular)
            .filter(
                |(place, solution)| match isolation(&self.results[*place], self.tolerances) {
                    Isolation::Isolated { multiplicity } if square => {
                        u64::from(multiplicity) != solution.multiplicity
                    }
                    // A point of combinations has at least the multiplicity of the equations that are asked.
                    Isolation::Isolated { multiplicity } => {
                        u64::from(multiplicity) > solution.paths.len() as u64
                    }
                    Isolation::PositiveDimensional | Isolation::Undecided => square,
                },
            )
            .map(|(_, solution)| solution.paths[0])
            .collect();
        self.set.counts.doubtful_multiplicity = differing.len() as u64;
        if !differing.is_empty() {
            let warning = multiplicities_are_not_confirmed(&differing);
            self.set.warnings.push(warning);
        }
    }

    /// The solution of some coinciding endpoints, and whose point it is: the most accurate.
    fn solution(&self, members: &[usize], verdict: Verdict) -> (usize, Solution) {
        let best = self.most_accurate(members);
        let result = &self.results[best];
        let values = self.shape.to_variables(result.endpoint.to_double());
        let mut solution = Solution {
            variables: self.system.variables.iter().cloned().zip(values).collect(),
            multiplicity: self.multiplicity(members.len() as u64, result),
            cycles: cycles(
                members
                    .iter()
                    .map(|&m| self.results[m].winding_number.unwrap_or(1)),
            ),
            real: None,
            singular: verdict != Verdict::Finite,
            residual: result.residual,
            condition: result.condition,
            accuracy: result.accuracy,
            precision_bits: members
                .iter()
                .map(|&m| self.results[m].precision_bits)
                .max()
                .unwrap_or(0),
            class: None,
            paths: members.iter().map(|&m| self.results[m].origin.0).collect(),
            certificate: None,
            deflations: None,
            undecided: verdict == Verdict::Undecided,
        };
        if solution.singular {
            solution.accuracy = solution.accuracy.max(self.spread(members, best));
            singular_digits::write_exact(
                &mut solution,
                self.system,
                self.parameters,
                self.tolerances,
            );
        }
        (best, solution)
    }

    /// Largest distance of some coinciding endpoints from one of them.
    fn spread(&self, members: &[usize], best: usize) -> f64 {
        let point = |member: usize| self.results[member].endpoint.to_double();
        let distances = members
            .iter()
            .map(|&member| self.shape.distance(point(best), point(member)));
        distances.fold(0.0, f64::max)
    }

    /// The multiplicity of a solution at which `paths` paths end: this number, unless combinations of more equations
    /// were tracked, of which a multiple point has a higher multiplicity.
    fn multiplicity(&self, paths: u64, result: &PathResult) -> u64 {
        if self.system.equation_count() <= self.system.dimension() {
            return paths;
        }
        match isolation(result, self.tolerances) {
            Isolation::Isolated { multiplicity } => paths.min(u64::from(multiplicity)),
            Isolation::PositiveDimensional | Isolation::Undecided => paths,
        }
    }

    /// The most accurate of some coinciding endpoints; one whose dual spaces were asked, where there is one.
    fn most_accurate(&self, members: &[usize]) -> usize {
        *members
            .iter()
            .min_by(|&&a, &&b| {
                let unasked = |m: usize| self.results[m].local_dimension.is_none();
                let accuracy = |m: usize| self.results[m].accuracy;
                let first = unasked(a).cmp(&unasked(b));
                first.then(accuracy(a).total_cmp(&accuracy(b)))
            })
            .expect("a cluster has a member")
    }

    fn decide_reality(&mut self, representatives: &[usize], history: &History) {
        match Involution::of(self.system, self.parameters) {
            Err(reason) => self.set.counts.real_reason = Some(reason.to_string()),
            Ok(involution) => {
                let roots: Vec<usize> = self.system.root_unknowns().map(|r| r.variable).collect();
                let mut count = 0;
                for (solution, &place) in self.set.solutions.iter_mut().zip(representatives) {
                    let result = &self.results[place];
                    let end = neighbourhood(result, self.tolerances);
                    let real = is_real(&end, &self.shape, &involution, &roots);
                    solution.real = Some(real);
                    count += u64::from(real);
                    if real {
                        write_as_real(&mut solution.variables, &self.shape, &involution, &roots);
                    }
                }
                self.set.counts.real = Some(count);
                self.count_without_conjugate(&involution, history);
            }
        }
    }

    fn count_solutions(&mut self, history: &History, representatives: &[usize]) {
        let points: Vec<(&[Complex64], f64)> = representatives
            .iter()
            .map(|&place| {
                let result = &self.results[place];
                (result.endpoint.to_double(), result.accuracy)
            })
            .collect();
        let set = &mut self.set;
        let counts = &mut set.counts;
        counts.distinct = set.solutions.len() as u64;
        counts.singular = set.solutions.iter().filter(|s| s.singular).count() as u64;
        counts.nonsingular = counts.distinct - counts.singular;
        counts.ill_conditioned = ill_conditioned(&set.solutions);
        counts.undecided = set.undecided.len() as u64;
        let doubtful = self.doubtful_denominators.len() + self.doubtful_branches.len();
        counts.doubtful_denominators = doubtful as u64;
        counts.with_multiplicity = set.solutions.iter().map(|s| s.multiplicity).sum();
        // Every positive-dimensional set has an end of a complete start system's
        // paths on it, where the Jacobian is singular, if only at infinity.
        let ends = self.results.iter().zip(&self.decisions);
        let all_isolated = ends.into_iter().all(|(result, decision)| {
            let isolated = || isolation(result, self.tolerances);
            result.outcome == PathOutcome::Regular
                || decision.verdict == Verdict::Singular
                || decision.verdict == Verdict::Removed
                    && matches!(isolated(), Isolation::Isolated { .. })
        });
        counts.positive_dimensional = if set.on_positive_dimensional_sets.is_empty() {
            (history.complete_start && all_isolated && set.failed.is_empty()).then_some(false)
        } else {
            Some(true)
        };
        counts.degenerate = degenerate::count(
            self.system,
            self.parameters,
            &self.shape,
            &points,
            self.tolerances,
        );
        assert_eq!(
            counts.nonsingular, set.paths.finite,
            "each finite path has a solution of its own"
        );
        let paths: u64 = set.solutions.iter().map(|s| s.paths.len() as u64).sum();
        assert_eq!(
            paths,
            set.paths.finite + set.paths.singular,
            "each path to a finite point is one of a solution"
        );
    }

    /// A complete start leads to the conjugates, too. Of roots with a branch, and of points up to scale, it is not asked.
    fn count_without_conjugate(&mut self, involution: &Involution, history: &History) {
        let system = self.system;
        let is_affine = system.groups.iter().all(|group| !group.homogeneous);
        if history.complete_start
            && !history.is_part
            && is_affine
            && system.root_unknowns().next().is_none()
        {
            let set = &mut self.set;
            set.counts.without_conjugate =
                without_conjugate(&set.solutions, &set.undecided, involution);
        }
    }

    /// All solutions are known where the start bounds them and every path is accounted for.
    fn judge_completeness(&mut self, history: &History) {
        let mut reasons = self.open_questions().reasons();
        reasons.extend(history.may_miss.clone());
        let counts = &mut self.set.counts;
        (counts.complete, counts.complete_reason) = if !reasons.is_empty() {
            (Completeness::NotKnown, Some(reasons.join("; ")))
        } else if history.complete_start {
            let why = "no more isolated solutions than paths, and every path is accounted for";
            (Completeness::Yes, Some(why.to_string()))
        } else {
            let why = "as many as the start points lead to; others are not looked for";
            (Completeness::NotKnown, Some(why.to_string()))
        };
    }

    /// Classes are of solutions: not of singular endpoints that may lie on a set of them.
    fn find_classes(&mut self) {
        let set = &mut self.set;
        let mut solutions: Vec<&mut Solution> = set.solutions.iter_mut().collect();
        let (system, parameters) = (self.system, self.parameters);
        match classes::assign(
            &mut solutions,
            system,
            parameters,
            self.tolerances,
            self.seed,
        ) {
            Ok(counts) => set.classes = counts,
            Err(reason) => set.warnings.push(reason),
        }
    }

    fn warn(&mut self) {
        let warnings = self.open_questions().warnings();
        self.set.warnings.extend(warnings);
    }

    fn open_questions(&self) -> OpenQuestions<'_> {
        OpenQuestions {
            paths: &self.set.paths,
            counts: &self.set.counts,
            weak_evidence: &self.set.weak_evidence,
            failed: &self.set.failed,
            doubtful_denominators: &self.doubtful_denominators,
            doubtful_branches: &self.doubtful_branches,
        }
    }
}

/// Winding numbers of the cycles that paths with these winding numbers form:
/// each cycle of winding number w is w of the paths.
fn cycles(windings: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut counts = std::collections::BTreeMap::<u32, u32>::new();
    for winding in windings {
        *counts.entry(winding.max(1)).or_default() += 1;
    }
    counts
        .into_iter()
        .flat_map(|(winding, paths)| std::iter::repeat_n(winding, paths.div_ceil(winding) as usize))
        .collect()
}

/// Whether a coordinate of the end of a path is too large for a double.
fn is_beyond_doubles(shape: &PointShape, result: &PathResult) -> bool {
    let values = shape.to_variables(result.endpoint.to_double());
    values
        .iter()
        .any(|z| !z.re.is_finite() || !z.im.is_finite())
}

#[cfg(test)]
mod tests;
