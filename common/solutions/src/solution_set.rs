//! SolutionSet: what a solve found, with counts that add up.
//!
//! Made from the last results of all paths of one target. The same results
//! give the same set, whoever tracked them in whatever chunks.

use crate::certificates::CertifiedSystem;
use crate::classification::{
    Decision, Isolation, Tolerances, Verdict, classify, isolation, solves,
};
use crate::degenerate::{self, DeclaredSets};
use crate::involution::Involution;
use crate::path_crossing::{broken_cycles, coincidences, crossings, radius};
use crate::point_shape::PointShape;
use crate::real::is_real;
use crate::solution::Solution;
use crate::summary::{ClassCounts, PathCounts, SolutionCounts};
use crate::symmetry::classes;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// What is known of a solve besides its last results.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct History {
    /// How often a path was tracked again.
    pub retracked: u64,
    /// Crossings seen.
    pub crossings_found: u64,
    /// ... of which came apart.
    pub crossings_resolved: u64,
    /// True when the start system bounds the solutions, so that every isolated
    /// solution and every positive-dimensional set has a path that ends on it.
    pub complete_start: bool,
    /// How many of the results are images of others (see `images`).
    pub images: u64,
}

/// Why a path counts as failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum FailureReason {
    /// The tracker gave it up.
    Tracking(Failure),
    /// Its result held no point.
    DamagedResult,
    /// What was taken for its endpoint does not solve the system.
    NoSolution,
    /// It ends at the regular endpoint of an earlier path, however tightly both are tracked.
    Crossing,
}

impl FailureReason {
    /// The reason in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Tracking(failure) => failure.describe(),
            Self::DamagedResult => "its result holds no point",
            Self::NoSolution => "what was taken for its endpoint does not solve the system",
            Self::Crossing => "it ends at the regular endpoint of another path",
        }
    }
}

/// A path that was not accounted for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailedPath {
    /// Its index in the stage that first started it.
    pub path: u64,
    /// Why.
    pub reason: FailureReason,
    /// Where it stopped, as |t|.
    pub t: f64,
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
    /// The paths that failed, ascending.
    pub failed: Vec<FailedPath>,
    /// The paths that end on positive-dimensional solution sets, ascending.
    pub on_positive_dimensional_sets: Vec<u64>,
    /// What a reader should know.
    pub warnings: Vec<String>,
    /// What the certificates are of, where there are some.
    pub certified_system: Option<CertifiedSystem>,
}

impl SolutionSet {
    /// True when no path failed and every crossing came apart.
    pub fn settled(&self) -> bool {
        self.paths.failed == 0 && self.paths.crossings_found == self.paths.crossings_resolved
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
            set: SolutionSet::default(),
        }
    }

    fn finish(mut self, history: &History) -> SolutionSet {
        self.fail_what_still_crosses();
        self.settle_declared_sets();
        self.list_failures();
        self.count_paths(history);
        let representatives = self.merge(history);
        self.decide_reality(&representatives);
        self.count_solutions(history, &representatives);
        self.find_classes(&representatives);
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
            let on_set = answers(|found| *found == Isolation::PositiveDimensional);
            let alone = answers(|found| matches!(found, Isolation::Isolated { .. }));
            if on_set && !alone {
                for place in asked.into_iter().chain(others) {
                    self.decisions[place].verdict = Verdict::PositiveDimensional;
                }
            }
            let counts = &mut self.set.paths.degenerate;
            counts.insert(name.to_string(), members.len() as u64);
        }
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
                _ => FailureReason::Crossing,
            };
            self.set.failed.push(FailedPath {
                path: result.origin.0,
                reason,
                t: result.t.norm_sqr().sqrt(),
            });
        }
    }

    fn count_paths(&mut self, history: &History) {
        let count = |verdict: Verdict| {
            let of_it = self.decisions.iter().filter(|d| d.verdict == verdict);
            of_it.count() as u64
        };
        let singular = count(Verdict::Singular);
        let on_sets = count(Verdict::PositiveDimensional);
        let undecided = self.undecided();
        let mut paths = PathCounts {
            total: self.results.len() as u64,
            finite: count(Verdict::Finite),
            singular,
            // Null only where nothing is known; else the warning says how many are open.
            positive_dimensional: (undecided == 0 || on_sets > 0).then_some(on_sets),
            excess: Some(count(Verdict::Excess)),
            at_infinity: count(Verdict::AtInfinity),
            failed: count(Verdict::Failed),
            retracked: history.retracked,
            crossings_found: history.crossings_found,
            crossings_resolved: history.crossings_resolved,
            decided_by_precision_limit: self
                .decisions
                .iter()
                .filter(|d| d.by_precision_limit)
                .count() as u64,
            degenerate: std::mem::take(&mut self.set.paths.degenerate),
            images: history.images,
            ..PathCounts::default()
        };
        for result in self.results {
            *paths.by_precision.entry(result.precision_bits).or_default() += 1;
        }
        paths.highest_precision_bits = paths.by_precision.keys().copied().max().unwrap_or(0);
        assert_eq!(paths.sum(), paths.total, "every path is in one class");
        self.set.paths = paths;
        let places = self.results.iter().zip(&self.decisions);
        self.set.on_positive_dimensional_sets = places
            .filter(|(_, decision)| decision.verdict == Verdict::PositiveDimensional)
            .map(|(result, _)| result.origin.0)
            .collect();
    }

    /// Singular endpoints of which it is not decided whether they are isolated.
    fn undecided(&self) -> u64 {
        let singular = self.results.iter().zip(&self.decisions);
        singular
            .filter(|(result, decision)| {
                decision.verdict == Verdict::Singular
                    && isolation(result, self.tolerances) == Isolation::Undecided
            })
            .count() as u64
    }

    /// Solutions from finite endpoints; returns the place of the result that stands for each.
    fn merge(&mut self, history: &History) -> Vec<usize> {
        let mut found: Vec<(usize, Solution)> = Vec::new();
        let mut broken = Vec::new();
        for verdict in [Verdict::Finite, Verdict::Singular] {
            let groups = coincidences(
                self.results,
                &self.shape,
                self.tolerances,
                self.seed,
                |place| self.decisions[place].verdict == verdict,
            );
            for members in groups {
                let solution = self.solution(&members, verdict == Verdict::Singular);
                if !broken_cycles(self.results, &members).is_empty() {
                    broken.push(members[0]);
                }
                found.push(solution);
            }
        }
        self.compare_multiplicities(history, &found);
        if let Some(&first) = broken.first() {
            self.set.warnings.push(format!(
                "at {} singular endpoint{} (first of path {}) the winding numbers do not fit the \
                 number of paths that end there; multiplicities are numbers of paths",
                broken.len(),
                plural(broken.len()),
                self.results[first].origin.0,
            ));
        }
        found.sort_by_key(|(_, solution)| solution.paths[0]);
        let (representatives, solutions) = found.into_iter().unzip();
        self.set.solutions = solutions;
        representatives
    }

    /// As many paths end at an isolated point as its dual space has dimensions, where all paths of
    /// a complete start are known and the equations were tracked as they are.
    fn compare_multiplicities(&mut self, history: &History, found: &[(usize, Solution)]) {
        let square = self.system.equation_count() == self.system.dimension();
        if !history.complete_start || !square || !self.set.failed.is_empty() {
            return;
        }
        let differing: Vec<u64> = found
            .iter()
            .filter(
                |(place, solution)| match isolation(&self.results[*place], self.tolerances) {
                    Isolation::Isolated { multiplicity } => {
                        u64::from(multiplicity) != solution.multiplicity
                    }
                    _ => false,
                },
            )
            .map(|(_, solution)| solution.paths[0])
            .collect();
        if !differing.is_empty() {
            self.set.warnings.push(format!(
                "at {} isolated singular point{} another number of paths ends than the \
                 multiplicity by the dual space (first paths: {})",
                differing.len(),
                plural(differing.len()),
                some_of(&differing),
            ));
        }
    }

    /// The solution of some coinciding endpoints, and whose point it is: the most accurate.
    fn solution(&self, members: &[usize], singular: bool) -> (usize, Solution) {
        let best = *members
            .iter()
            .min_by(|&&a, &&b| {
                self.results[a]
                    .accuracy
                    .total_cmp(&self.results[b].accuracy)
            })
            .expect("a cluster has a member");
        let result = &self.results[best];
        let values = self.shape.to_variables(result.endpoint.to_double());
        let solution = Solution {
            variables: self.system.variables.iter().cloned().zip(values).collect(),
            multiplicity: members.len() as u64,
            cycles: cycles(
                members
                    .iter()
                    .map(|&m| self.results[m].winding_number.unwrap_or(1)),
            ),
            real: None,
            singular,
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
        };
        (best, solution)
    }

    fn decide_reality(&mut self, representatives: &[usize]) {
        match Involution::of(self.system, self.parameters) {
            Err(reason) => self.set.counts.real_reason = Some(reason.to_string()),
            Ok(involution) => {
                let mut count = 0;
                for (solution, &place) in self.set.solutions.iter_mut().zip(representatives) {
                    let result = &self.results[place];
                    let real = is_real(
                        result.endpoint.to_double(),
                        radius(result, self.tolerances),
                        &self.shape,
                        &involution,
                    );
                    solution.real = Some(real);
                    count += u64::from(real);
                }
                self.set.counts.real = Some(count);
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
        counts.with_multiplicity = set.solutions.iter().map(|s| s.multiplicity).sum();
        // Every positive-dimensional set has an end of a complete start system's
        // paths on it, where the Jacobian is singular, if only at infinity.
        let all_isolated = self.results.iter().all(|result| {
            result.outcome == PathOutcome::Regular
                || matches!(
                    isolation(result, self.tolerances),
                    Isolation::Isolated { .. }
                )
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
        assert_eq!(
            counts.with_multiplicity,
            set.paths.finite + set.paths.singular,
            "each path to a finite point is counted in one multiplicity"
        );
    }

    /// Classes are of solutions: not of singular endpoints that may lie on a set of them.
    fn find_classes(&mut self, representatives: &[usize]) {
        let set = &mut self.set;
        let isolated = |place: &usize| {
            let found = isolation(&self.results[*place], self.tolerances);
            matches!(found, Isolation::Isolated { .. })
        };
        let both = set.solutions.iter_mut().zip(representatives);
        let mut known: Vec<&mut Solution> = both
            .filter(|(solution, place)| !solution.singular || isolated(place))
            .map(|(solution, _)| solution)
            .collect();
        match classes::assign(&mut known, self.system, self.tolerances, self.seed) {
            Ok(counts) => set.classes = counts,
            Err(reason) => set.warnings.push(reason),
        }
    }

    fn warn(&mut self) {
        let undecided = self.undecided();
        let set = &mut self.set;
        let paths = &set.paths;
        if undecided > 0 {
            set.warnings.push(format!(
                "whether {undecided} of the {} path{} to singular endpoints end{} at an isolated \
                 point is not decided: if not, no solution but a positive-dimensional set is there",
                paths.singular,
                plural(paths.singular as usize),
                if undecided == 1 { "s" } else { "" },
            ));
        }
        if paths.crossings_found > paths.crossings_resolved {
            set.warnings.push(format!(
                "{} crossing{} of paths could not be resolved: solutions may be missing",
                paths.crossings_found - paths.crossings_resolved,
                plural((paths.crossings_found - paths.crossings_resolved) as usize),
            ));
        }
        if paths.failed > 0 {
            let mut reasons = std::collections::BTreeMap::<_, Vec<u64>>::new();
            for failed in &set.failed {
                reasons.entry(failed.reason).or_default().push(failed.path);
            }
            for (reason, failed) in reasons {
                set.warnings.push(format!(
                    "{} path{} failed ({}): {}",
                    failed.len(),
                    plural(failed.len()),
                    reason.describe(),
                    some_of(&failed),
                ));
            }
        }
        if paths.decided_by_precision_limit > 0 {
            set.warnings.push(format!(
                "{} path{} finite or at infinity only by the limit of the precision",
                paths.decided_by_precision_limit,
                if paths.decided_by_precision_limit == 1 {
                    " is"
                } else {
                    "s are"
                },
            ));
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

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

/// The first few of many.
fn some_of(paths: &[u64]) -> String {
    const SHOWN: usize = 10;
    let mut list: Vec<String> = paths.iter().take(SHOWN).map(u64::to_string).collect();
    if paths.len() > SHOWN {
        list.push("...".into());
    }
    list.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_results::{failed, regular, singular};
    use cognate_systems::system::{DegenerateSet, VariableGroup};

    /// x^5 = x, say: a real equation in one variable; x must not vanish.
    fn system() -> System {
        let mut system = System {
            variables: vec!["x".into()],
            groups: vec![VariableGroup {
                variables: vec![0],
                homogeneous: false,
            }],
            equation_names: vec!["f".into()],
            ..System::default()
        };
        let e = &mut system.expressions;
        let x = e.variable(0);
        let fifth = e.power(x, 5);
        system.equations = vec![e.subtract(fifth, x)];
        system
            .degenerate
            .insert("zero".into(), DegenerateSet::Nonzero(x));
        system
    }

    fn set_of(results: &[PathResult], history: &History) -> SolutionSet {
        SolutionSet::new(&system(), &[], results, history, &Tolerances::default(), 42)
    }

    fn complete() -> History {
        History {
            complete_start: true,
            ..History::default()
        }
    }

    #[test]
    fn all_regular_is_all_decided() {
        let results = [
            regular(0, &[(0.5, 0.0), (0.5, 0.0)]),
            regular(1, &[(0.0, 0.5), (0.0, -0.5)]),
            regular(2, &[(0.5, 0.0), (0.0, 0.5)]),
            regular(3, &[(0.5, 0.0), (0.0, -0.5)]),
            regular(4, &[(1.0, 0.0), (1e-17, 1e-18)]),
        ];
        let set = set_of(&results, &complete());
        assert_eq!((set.paths.total, set.paths.finite), (5, 5));
        assert_eq!(set.paths.positive_dimensional, Some(0));
        assert_eq!(set.counts.real, Some(3));
        assert_eq!(set.counts.positive_dimensional, Some(false));
        assert_eq!(set.counts.degenerate["zero"], 1);
        assert!(
            set.settled() && set.warnings.is_empty(),
            "{:?}",
            set.warnings
        );
        assert_eq!(set.solutions[1].real, Some(true));
        assert_eq!(set.solutions[2].real, Some(false));
        assert_eq!(
            set.solutions[0].variables.0[0].value,
            Complex64::new(1.0, 0.0)
        );
    }

    #[test]
    fn singular_endpoints_are_merged_with_their_cycles() {
        let double = [(1.0, 0.0), (0.5, 0.0)];
        let near = [(1.0, 0.0), (0.5, 3e-10)];
        let results = [
            singular(0, &double, 2, &[0]),
            singular(1, &[(1.0, 0.0), (-0.5, 0.0)], 1, &[0]),
            singular(2, &near, 2, &[0]),
            singular(3, &near, 1, &[0]),
            singular(4, &[(1e-14, 0.0), (1.0, 0.0)], 1, &[1]),
        ];
        let set = set_of(&results, &complete());
        assert_eq!((set.paths.singular, set.paths.at_infinity), (4, 1));
        assert_eq!(set.paths.positive_dimensional, None);
        assert_eq!(set.counts.positive_dimensional, None);
        assert_eq!((set.counts.distinct, set.counts.with_multiplicity), (2, 4));
        assert_eq!(set.solutions[0].paths, [0, 2, 3]);
        assert_eq!(set.solutions[0].cycles, [1, 2]);
        assert_eq!(set.solutions[0].real, Some(true));
        assert_eq!(set.warnings.len(), 1, "{:?}", set.warnings);
        assert!(set.settled());
        let set = set_of(&results[..2], &complete());
        assert!(
            set.warnings[0].contains("winding numbers"),
            "half a cycle is missing"
        );
    }

    #[test]
    fn an_unresolved_crossing_is_a_failed_path_and_said() {
        let point = [(1.0, 0.0), (0.5, 0.0)];
        let results = [regular(0, &point), failed(1), regular(2, &point)];
        let history = History {
            retracked: 6,
            crossings_found: 2,
            crossings_resolved: 1,
            complete_start: true,
            images: 0,
        };
        let set = set_of(&results, &history);
        assert_eq!((set.paths.finite, set.paths.failed), (1, 2));
        assert_eq!(set.counts.distinct, 1);
        assert!(!set.settled());
        let reasons: Vec<_> = set.failed.iter().map(|f| (f.path, f.reason)).collect();
        assert_eq!(
            reasons,
            [
                (1, FailureReason::Tracking(Failure::StepTooSmall)),
                (2, FailureReason::Crossing)
            ]
        );
        assert_eq!(set.warnings.len(), 3, "{:?}", set.warnings);
    }

    #[test]
    fn cycles_take_as_many_paths_as_they_turn() {
        assert_eq!(cycles([2, 2, 1, 2, 2, 3, 3, 3].into_iter()), [1, 2, 2, 3]);
        assert_eq!(cycles([3].into_iter()), [3]);
    }
}
