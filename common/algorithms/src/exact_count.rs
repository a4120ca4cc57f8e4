//! Exact counts: what paths found is compared with how many solutions the equations have.

use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::summary::ExactCount;
use cognate_systems::polynomial::{SolutionCount, solution_count};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::denominator_factors;

/// Operations that a count may take for each path, and in all: a tenth of a millisecond and a tenth of a second.
const OPERATIONS_PER_PATH: u64 = 100_000;
const MOST_OPERATIONS: u64 = 100_000_000;
/// ... which are allowed for the smallest systems.
const LEAST_OPERATIONS: u64 = 4_000_000;

/// Asks the equations how many solutions they have, where paths were taken to end at infinity, at multiple points or on
/// sets, and nothing else is in doubt: where each path has a regular solution of its own, none is missing.
/// `known`: the number of solutions of the equations as they are tracked, where it is known already.
pub(crate) fn compare_with_exact_count(
    set: &mut SolutionSet,
    system: &System,
    known: Option<SolutionCount>,
) {
    let paths = &set.paths;
    if !set.is_settled_as_far_as_it_goes()
        || paths.finite == paths.total
        || !paths.degenerate.is_empty()
    {
        return;
    }
    let operations = OPERATIONS_PER_PATH.saturating_mul(paths.total);
    let operations = operations.clamp(LEAST_OPERATIONS, MOST_OPERATIONS);
    // The given equations have fewer where they have denominators.
    let known = known.filter(|_| denominator_factors(system).is_empty());
    if let Some(count) = known.or_else(|| solution_count(system, operations)) {
        compare(set, count);
    }
}

fn compare(set: &mut SolutionSet, count: SolutionCount) {
    let counts = &mut set.counts;
    let claimed = counts.complete == Completeness::Yes;
    let differs = |found: u64, exact: u64| found > exact || (claimed && found < exact);
    let (exact, contradiction) = match count {
        SolutionCount::Infinite {
            dimension,
            nonsingular,
        } => {
            let differs = nonsingular.is_some_and(|exact| differs(counts.nonsingular, exact));
            let exact = ExactCount {
                dimension,
                with_multiplicity: None,
                distinct: None,
                nonsingular,
                agrees: counts.positive_dimensional != Some(false) && !differs,
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
            let wrong = counts.positive_dimensional == Some(true)
                || differs(counts.with_multiplicity, with_multiplicity)
                || distinct.is_some_and(|distinct| differs(counts.distinct, distinct));
            let exact = ExactCount {
                dimension: 0,
                with_multiplicity: Some(with_multiplicity),
                distinct,
                nonsingular: None,
                agrees: !wrong,
            };
            let points =
                distinct.map_or(String::new(), |distinct| format!("{distinct} solutions, "));
            (
                exact,
                format!("{points}{with_multiplicity} with multiplicity, and no set of them"),
            )
        }
    };
    if !exact.agrees {
        counts.complete = Completeness::NotKnown;
        let found =
            format!("the equations have {contradiction}: paths were taken for what they are not");
        counts.complete_reason = Some(found.clone());
        set.warnings.push(found);
    } else if exact.with_multiplicity == Some(counts.with_multiplicity)
        && exact.distinct == Some(counts.distinct)
    {
        counts.complete = Completeness::Yes;
        let why = "as many solutions as the equations have by an exact count";
        counts.complete_reason = Some(why.to_string());
    } else if exact
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

    #[test]
    fn answers_that_agree_stay_as_they_are() {
        let mut set = answer();
        compare(&mut set, finite(2, 2));
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
            compare(&mut set, wrong);
            assert!(!set.settled() && set.warnings.len() == 1, "{wrong:?}");
            assert_eq!(set.counts.complete, Completeness::NotKnown);
        }
        let mut set = answer();
        set.counts.positive_dimensional = Some(true);
        let mut again = set.clone();
        compare(&mut set, finite(2, 2));
        assert!(!set.settled(), "no set of solutions is there");
        compare(&mut again, infinite);
        assert!(again.settled());
        again.counts.nonsingular = 3;
        compare(&mut again, infinite);
        assert!(!again.settled(), "a point of a set");
    }

    #[test]
    fn what_is_not_claimed_may_be_missing() {
        let mut set = answer();
        set.counts.complete = Completeness::NotKnown;
        let mut more = set.clone();
        compare(&mut more, finite(3, 3));
        assert_eq!(more.counts.complete, Completeness::No);
        assert!(more.is_settled_as_far_as_it_goes() && !more.settled());
        compare(&mut set, finite(2, 2));
        assert!(set.settled() && set.counts.complete == Completeness::Yes);
    }
}
