//! Exact counts: what paths found is compared with how many solutions the equations have.

use crate::exact_answer;
use cognate_numeric::counted::counted as with_noun;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::summary::ExactCount;
use cognate_solutions::weak_evidence::WeakEvidence;
use cognate_systems::polynomial::{CountedSolutions, SolutionCount, solution_count};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::denominator_factors;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Operations that a count may take for each path (a tenth of a millisecond), and `MOST_OPERATIONS` in all (a tenth of
/// a second).
const OPERATIONS_PER_PATH: u64 = 100_000;
pub(crate) const MOST_OPERATIONS: u64 = 100_000_000;
/// Operations that a count may take even for the smallest systems.
const LEAST_OPERATIONS: u64 = 4_000_000;

/// Reason why no count is made: none is needed.
const NOT_NEEDED: &str = "each path ends at a solution of its own";
/// Reason why no count is made: it would not make the answer settled.
const IN_DOUBT: &str = "the answer is in doubt without it";
/// Reason why an answer is not complete where only the exact count has sets of solutions, and equations hold roots.
const BRANCHES_OF_SETS: &str = "the equations have a set of solutions if roots may be any of their values; it is not known \
                                whether solutions of it have the roots that are meant";
/// Reason why no count is made: sets of solutions were taken away.
const SETS_OF_FALSE_BRANCHES: &str = "sets of solutions are on false branches";
/// Reason why no count is made: there are several answers.
pub(crate) const SEVERAL_TARGETS: &str = "solutions are counted for one set of parameters only";
/// Reason why no count is made: it is switched off.
const SWITCHED_OFF: &str = "switched off";
/// Reason why no count is made: ends are declared to be no answers.
const DECLARED: &str = "endpoints are counted by name";

/// The number of isolated solutions of a family at general parameters, where it can be counted in a time that suits this
/// number of paths.
pub(crate) fn of_general_member(family: &System, paths: u64) -> Option<u64> {
    let mut stream = RandomStream::new(0, Purpose::Probe, 0);
    let parameters: Vec<Complex64> = family.parameters.iter().map(|_| stream.unit()).collect();
    let operations = OPERATIONS_PER_PATH.saturating_mul(paths);
    let operations = operations.clamp(LEAST_OPERATIONS, MOST_OPERATIONS);
    match solution_count(family, &parameters, operations).ok()?.count {
        SolutionCount::Finite { distinct, .. } => distinct,
        SolutionCount::Infinite { .. } => None,
    }
}

/// Whether the solutions of a job are counted without paths.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ExactCounting {
    /// The paths alone decide.
    pub switched_off: bool,
    /// Values of the parameters where solutions are wanted.
    pub parameters: Vec<Complex64>,
    /// All solutions are asked for, and the numbers of the equations are exact: where paths leave an answer in doubt,
    /// the equations are solved without them.
    pub settles_doubts: bool,
    /// Paths are few because equations were solved one after the other: that each ends at a solution of its own is no
    /// evidence, since a solution that an earlier equation lost has no path.
    pub paths_follow_equations: bool,
}

impl ExactCounting {
    /// Asks the equations how many solutions they have, where paths were taken to end at infinity, at multiple points
    /// or on sets, and nothing else is in doubt: where each path has a regular solution of its own, none is missing.
    /// `tracked_count`: the number of solutions of the equations as they are tracked, where it is known already.
    pub fn compare(
        &self,
        set: &mut SolutionSet,
        system: &System,
        tracked_count: Option<SolutionCount>,
    ) {
        let counted = self.count(set, system, tracked_count);
        add_false_branches(set);
        match counted {
            Ok(counted) => compare(set, counted),
            Err(reason) => set.no_exact_count = Some(reason),
        }
        let exact = set.counts.exact_count.as_ref();
        if !exact.is_some_and(|exact| confirms(exact, set)) {
            doubt_clusters(set);
        }
        subtract_false_branches(set);
        if self.settles_doubts && !set.settled() {
            self.settle(set, system);
        }
        name_sets(set, system);
    }

    /// Settles an answer in doubt, by the count where the paths have as many solutions, else by the solutions of the
    /// equations.
    fn settle(&self, set: &mut SolutionSet, system: &System) {
        let parameters = &self.parameters;
        let exact = self.count_with_distinct(set, system);
        let is_counted = exact
            .is_some_and(|exact| exact_answer::settle_by_count(set, &exact, system, parameters));
        if !is_counted {
            exact_answer::settle(set, system, parameters);
        }
    }

    /// The exact count of an answer in doubt. Where the paths have as many solutions with multiplicity, and only the number
    /// of distinct ones was too long to count, that is counted, too: it decides whether ends are single points.
    fn count_with_distinct(&self, set: &SolutionSet, system: &System) -> Option<ExactCount> {
        let exact = set.counts.exact_count.clone()?;
        let is_open = exact.distinct.is_none() && !exact.is_general;
        if !is_open || exact.with_multiplicity != Some(exact_answer::with_multiplicity(set)) {
            return Some(exact);
        }
        let operations = exact_answer::MOST_OPERATIONS;
        let counted = solution_count(system, &self.parameters, operations);
        let distinct = counted.ok().and_then(|counted| match counted.count {
            SolutionCount::Finite { distinct, .. } => distinct,
            SolutionCount::Infinite { .. } => None,
        });
        Some(ExactCount { distinct, ..exact })
    }

    fn count(
        &self,
        set: &SolutionSet,
        system: &System,
        tracked_count: Option<SolutionCount>,
    ) -> Result<CountedSolutions, String> {
        let paths = &set.paths;
        let because = |reason: &str| Err(reason.to_string());
        if self.switched_off {
            return because(SWITCHED_OFF);
        }
        if !paths.degenerate.is_empty() {
            return because(DECLARED);
        }
        let paths_are_evidence = paths.total > 0 && !self.paths_follow_equations;
        if paths_are_evidence && paths.finite + set.false_branches.nonsingular == paths.total {
            return because(NOT_NEEDED);
        }
        if set.false_branches.on_sets > 0 {
            return because(SETS_OF_FALSE_BRANCHES);
        }
        if !self.settles_doubts && !without_weak_evidence(set).is_settled_as_far_as_it_goes() {
            return because(IN_DOUBT);
        }
        // The given equations have fewer where they have denominators.
        let tracked_count = tracked_count.filter(|_| denominator_factors(system).is_empty());
        if let Some(count) = tracked_count {
            return Ok(CountedSolutions {
                count,
                is_general: false,
                is_exact: true,
            });
        }
        let operations = if paths_are_evidence {
            OPERATIONS_PER_PATH.saturating_mul(paths.total)
        } else {
            MOST_OPERATIONS
        };
        let operations = operations.clamp(LEAST_OPERATIONS, MOST_OPERATIONS);
        let counted = solution_count(system, &self.parameters, operations);
        counted.map_err(|reason| reason.to_string())
    }
}

/// Notes the sets of solutions that an exact count has and no path came to. Of a set whose equations hold helpers for roots
/// it is not known whether the roots are the meant ones.
fn name_sets(set: &mut SolutionSet, system: &System) {
    let counts = &mut set.counts;
    let exact = counts.exact_count.as_ref();
    let has_sets =
        exact.is_some_and(|exact| exact.dimension > 0 && exact.agrees && !exact.is_general);
    if !has_sets || counts.positive_dimensional.is_some() {
        return;
    }
    counts.positive_dimensional = Some(true);
    if system.root_unknowns().next().is_some() {
        counts.complete = Completeness::NotKnown;
        counts.complete_reason = Some(BRANCHES_OF_SETS.to_string());
    }
}

/// Points on false branches are solutions of the polynomial equations, which are counted.
fn add_false_branches(set: &mut SolutionSet) {
    let removed = set.false_branches;
    set.counts.distinct += removed.distinct;
    set.counts.nonsingular += removed.nonsingular;
    set.counts.with_multiplicity += removed.with_multiplicity;
}

fn subtract_false_branches(set: &mut SolutionSet) {
    let removed = set.false_branches;
    set.counts.distinct -= removed.distinct;
    set.counts.nonsingular -= removed.nonsingular;
    set.counts.with_multiplicity -= removed.with_multiplicity;
}

/// The answer as it would be if all verdicts rested on enough.
fn without_weak_evidence(set: &SolutionSet) -> SolutionSet {
    let mut paths = set.paths.clone();
    paths.decided_by_precision_limit -= set.weak_evidence.paths();
    SolutionSet {
        paths,
        counts: set.counts.clone(),
        ..SolutionSet::default()
    }
}

/// Whether a count is that of the answer, so that no verdict on a path needs more evidence.
fn confirms(exact: &ExactCount, set: &SolutionSet) -> bool {
    let counts = &set.counts;
    if !exact.agrees {
        return false;
    }
    match exact.with_multiplicity {
        Some(with_multiplicity) => {
            counts.positive_dimensional != Some(true)
                && counts.with_multiplicity == with_multiplicity
                // Where no solution is multiple each counts once.
                && counts.distinct == exact.distinct.unwrap_or(with_multiplicity)
        }
        None => !exact.is_general && exact.nonsingular == Some(counts.nonsingular),
    }
}

/// Where paths went to infinity together with others, and no count says that no solution is among their ends, nobody
/// knows whether the answer is complete.
fn doubt_clusters(set: &mut SolutionSet) {
    let together = set.in_clusters_at_infinity;
    let counts = &mut set.counts;
    if together == 0 || counts.complete != Completeness::Yes {
        return;
    }
    let reason = match &set.no_exact_count {
        Some(reason) => format!("the solutions were not counted exactly: {reason}"),
        None => "an exact count does not say how many solutions there are".to_string(),
    };
    counts.complete = Completeness::NotKnown;
    let s = if together == 1 { "" } else { "s" };
    counts.complete_reason = Some(format!(
        "{together} path{s} went to infinity together with others, and {reason}"
    ));
}

fn compare(set: &mut SolutionSet, counted: CountedSolutions) {
    let CountedSolutions {
        count, is_general, ..
    } = counted;
    if let SolutionCount::Infinite { .. } = count
        && set.paths.total == 0
    {
        set.counts.positive_dimensional = Some(true);
    }
    let counts = &set.counts;
    let claimed = counts.complete == Completeness::Yes || set.weak_evidence.paths() > 0;
    // For special values there may be fewer solutions than for general ones.
    let differs =
        |number: u64, exact: u64| number > exact || (claimed && !is_general && number < exact);
    let (exact, contradiction) = match count {
        SolutionCount::Infinite {
            dimension,
            nonsingular,
        } => {
            let differs = nonsingular.is_some_and(|exact| differs(counts.nonsingular, exact));
            let is_set = counts.positive_dimensional != Some(false);
            let exact = ExactCount {
                dimension,
                with_multiplicity: None,
                distinct: None,
                nonsingular,
                agrees: is_general || (is_set && !differs),
                is_general,
            };
            let points =
                nonsingular.map_or(String::new(), |n| format!(" and {n} nonsingular ones"));
            (
                exact,
                format!("solutions on sets of dimension {dimension}{points}"),
            )
        }
        SolutionCount::Finite {
            with_multiplicity,
            distinct,
        } => {
            let on_sets = counts.positive_dimensional == Some(true);
            let wrong = (on_sets && !is_general)
                || differs(counts.with_multiplicity, with_multiplicity)
                || (!is_general
                    && distinct.is_some_and(|distinct| differs(counts.distinct, distinct)));
            let exact = ExactCount {
                dimension: 0,
                with_multiplicity: Some(with_multiplicity),
                distinct,
                nonsingular: None,
                agrees: !wrong,
                is_general,
            };
            let points = distinct.map_or(String::new(), |distinct| {
                format!("{}, ", with_noun(distinct, "solution"))
            });
            (
                exact,
                format!("{points}{with_multiplicity} with multiplicity, and no set of them"),
            )
        }
    };
    let is_confirmed = confirms(&exact, set);
    if is_confirmed {
        set.paths.decided_by_precision_limit -= set.weak_evidence.paths();
        set.weak_evidence = WeakEvidence::default();
    }
    let counts = &mut set.counts;
    if !exact.agrees {
        counts.complete = Completeness::NotKnown;
        let reason =
            format!("the equations have {contradiction}: paths were taken for what they are not");
        counts.complete_reason = Some(reason.clone());
        set.warnings.push(reason);
    } else if is_confirmed && exact.with_multiplicity.is_some() {
        counts.complete = Completeness::Yes;
        let why = match is_general {
            true => "as many solutions as the equations have for general values of their numbers",
            false => "as many solutions as the equations have by an exact count",
        };
        counts.complete_reason = Some(why.to_string());
    } else if !is_general
        && exact
            .distinct
            .is_some_and(|distinct| counts.distinct < distinct)
    {
        counts.complete = Completeness::No;
        let why = format!("the equations have {contradiction}");
        counts.complete_reason = Some(why);
    }
    counts.exact_count = Some(exact);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two solutions by four paths, two of which end at infinity.
    fn answer() -> SolutionSet {
        let mut set = SolutionSet::default();
        set.paths.total = 4;
        set.paths.finite = 2;
        set.paths.at_infinity = 2;
        set.counts.distinct = 2;
        set.counts.nonsingular = 2;
        set.counts.with_multiplicity = 2;
        set.counts.positive_dimensional = Some(false);
        set.counts.complete = Completeness::Yes;
        set
    }

    fn finite(with_multiplicity: u64, distinct: u64) -> SolutionCount {
        SolutionCount::Finite {
            with_multiplicity,
            distinct: Some(distinct),
        }
    }

    fn exactly(count: SolutionCount) -> CountedSolutions {
        CountedSolutions {
            count,
            is_general: false,
            is_exact: true,
        }
    }

    #[test]
    fn answers_that_agree_stay_as_they_are() {
        let mut set = answer();
        compare(&mut set, exactly(finite(2, 2)));
        assert!(set.settled() && set.warnings.is_empty());
        assert_eq!(set.counts.complete, Completeness::Yes);
    }

    #[test]
    fn planted_faults_are_found() {
        let infinite = SolutionCount::Infinite {
            dimension: 1,
            nonsingular: Some(2),
        };
        for wrong in [
            finite(3, 3),
            finite(3, 2),
            finite(2, 1),
            finite(1, 1),
            infinite,
        ] {
            let mut set = answer();
            compare(&mut set, exactly(wrong));
            assert!(!set.settled() && set.warnings.len() == 1, "{wrong:?}");
            assert_eq!(set.counts.complete, Completeness::NotKnown);
        }
        let mut set = answer();
        set.counts.positive_dimensional = Some(true);
        let mut set_with_curve = set.clone();
        compare(&mut set, exactly(finite(2, 2)));
        assert!(!set.settled(), "no set of solutions is there");
        compare(&mut set_with_curve, exactly(infinite));
        assert!(set_with_curve.settled());
        set_with_curve.counts.nonsingular = 3;
        compare(&mut set_with_curve, exactly(infinite));
        assert!(!set_with_curve.settled(), "a point of a set");
    }

    #[test]
    fn what_is_not_claimed_may_be_missing() {
        let mut set = answer();
        set.counts.complete = Completeness::NotKnown;
        let mut more = set.clone();
        compare(&mut more, exactly(finite(3, 3)));
        assert_eq!(more.counts.complete, Completeness::No);
        assert!(more.is_settled_as_far_as_it_goes() && !more.settled());
        compare(&mut set, exactly(finite(2, 2)));
        assert!(set.settled() && set.counts.complete == Completeness::Yes);
    }

    /// A count of general values confirms, and says nothing where it is larger.
    #[test]
    fn special_values_may_have_fewer_solutions_than_general_ones() {
        let general = |count| CountedSolutions {
            count,
            is_general: true,
            is_exact: false,
        };
        let mut set = answer();
        compare(&mut set, general(finite(3, 3)));
        assert!(set.settled() && set.counts.complete == Completeness::Yes);
        let mut set = answer();
        compare(&mut set, general(finite(1, 1)));
        assert!(!set.settled(), "more regular solutions than there are");
        let mut set = doubtful();
        compare(&mut set, general(finite(3, 3)));
        assert!(!set.settled());
        compare(&mut set, general(finite(2, 2)));
        assert!(set.settled() && set.counts.complete == Completeness::Yes);
    }

    /// Two solutions by four paths, two of which end at infinity with too weak evidence.
    fn doubtful() -> SolutionSet {
        let mut set = answer();
        set.weak_evidence.at_infinity = 2;
        set.in_clusters_at_infinity = 2;
        set.paths.decided_by_precision_limit = 2;
        set.counts.complete = Completeness::NotKnown;
        set
    }

    #[test]
    fn a_count_settles_what_paths_leave_open() {
        let mut set = doubtful();
        assert!(!set.settled());
        compare(&mut set, exactly(finite(2, 2)));
        assert!(set.settled() && set.counts.complete == Completeness::Yes);
        let mut set = doubtful();
        compare(&mut set, exactly(finite(3, 3)));
        assert!(!set.settled() && set.warnings.len() == 1);
    }

    #[test]
    fn without_a_count_an_answer_with_clusters_at_infinity_is_not_known_to_be_complete() {
        let counting = ExactCounting {
            switched_off: true,
            ..ExactCounting::default()
        };
        let system = System::default();
        let mut set = answer();
        counting.compare(&mut set, &system, None);
        assert_eq!(set.counts.complete, Completeness::Yes);
        let mut set = answer();
        set.in_clusters_at_infinity = 2;
        counting.compare(&mut set, &system, None);
        assert!(set.settled() && set.counts.exact_count.is_none());
        assert_eq!(set.counts.complete, Completeness::NotKnown);
        let reason = set.counts.complete_reason.unwrap();
        assert!(
            reason.contains("not counted exactly: switched off"),
            "{reason}"
        );
    }
}
