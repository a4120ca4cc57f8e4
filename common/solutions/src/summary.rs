//! The counts of a solve: the blocks `paths`, `solutions` and `classes` of the summary.
//!
//! Field by field as the contract has them; null stands for what this version
//! does not decide.

use crate::completeness::Completeness;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Every path counted once, in the first class that holds.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PathCounts {
    /// Paths of the first tracking stage.
    pub total: u64,
    /// Nonsingular and isolated.
    pub finite: u64,
    /// Singular and isolated.
    pub singular: u64,
    /// On a positive-dimensional set.
    pub positive_dimensional: Option<u64>,
    /// Solutions only of the combinations of equations that were tracked; 0 where nothing is
    /// randomised.
    pub excess: Option<u64>,
    /// The homogenising coordinate of an affine group is 0.
    pub at_infinity: u64,
    /// Paths that were not tracked to the end.
    pub failed: u64,
    /// Number of times that a path was tracked again.
    pub retracked: u64,
    /// Meetings of paths in one regular endpoint.
    pub crossings_found: u64,
    /// Crossings whose paths came apart when tracked again.
    pub crossings_resolved: u64,
    /// Finite or infinite only by the limit of the precision.
    pub decided_by_precision_limit: u64,
    /// Paths by the highest precision that they used, in bits.
    pub by_precision: BTreeMap<u32, u64>,
    /// The highest precision of all, in bits.
    pub highest_precision_bits: u32,
    /// Paths to singular endpoints in each named set that is given by equations.
    #[serde(default)]
    pub degenerate: BTreeMap<String, u64>,
    /// Number of paths that were not followed because they are images, by a symmetry, of others that were.
    #[serde(default)]
    pub images: u64,
    /// Paths that end at a finite singular point of which it is not known whether it is isolated.
    #[serde(default)]
    pub undecided: u64,
    /// Ends whose class would change within the accuracy of the decimals that were given.
    #[serde(default)]
    pub within_data_accuracy: u64,
    /// How many of those at infinity, and of those that end at no solution of what was asked, were not followed to their
    /// ends: all solutions are known, by an exact count. Where a solution has no path
    /// ([`SolutionCounts::without_path`]) some of these may lead to it.
    #[serde(default)]
    pub decided_by_exact_count: u64,
    /// Paths that end at points that were taken away from the answer (see [`SolutionCounts::removed`]).
    #[serde(default)]
    pub removed: u64,
}

impl PathCounts {
    /// The classes together: `total`, always.
    pub fn sum(&self) -> u64 {
        self.finite
            + self.singular
            + self.positive_dimensional.unwrap_or(0)
            + self.undecided
            + self.within_data_accuracy
            + self.excess.unwrap_or(0)
            + self.removed
            + self.at_infinity
            + self.failed
    }
}

/// Isolated finite points after merging.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SolutionCounts {
    /// Number of all distinct points.
    pub distinct: u64,
    /// Points with a regular Jacobian.
    pub nonsingular: u64,
    /// Points with a singular Jacobian.
    pub singular: u64,
    /// Fixed by the involution; null where it is not asked.
    pub real: Option<u64>,
    /// Reason why real solutions are not counted.
    pub real_reason: Option<String>,
    /// Sum of the multiplicities.
    pub with_multiplicity: u64,
    /// Solutions that are proved to exist and to differ from each other; null where that was not asked for.
    pub certified: Option<u64>,
    /// Solutions that are certified, distinct and proved to be real; null where that is not asked.
    pub certified_real: Option<u64>,
    /// Whether there is a positive-dimensional solution set; null until that can be decided.
    pub positive_dimensional: Option<bool>,
    /// Solutions in each named set of endpoints that are no answers.
    pub degenerate: BTreeMap<String, u64>,
    /// Solutions that were brought to more digits; null where that was not asked for.
    #[serde(default)]
    pub sharpened: Option<SharpenedCounts>,
    /// Finite singular points of which it is not known whether they are isolated; in no other count.
    #[serde(default)]
    pub undecided: u64,
    /// Singular solutions of which the number of paths is not confirmed by the multiplicity.
    #[serde(default)]
    pub doubtful_multiplicity: u64,
    /// Whether these are all isolated solutions.
    #[serde(default)]
    pub complete: Completeness,
    /// Why it is known whether these are all isolated solutions, or why it is not known.
    #[serde(default)]
    pub complete_reason: Option<String>,
    /// Number of solutions, computed from the equations without a path; null where it was not asked for, or takes too
    /// much.
    #[serde(default)]
    pub exact_count: Option<ExactCount>,
    /// Points that solve the equations that were tracked and are no solutions of those that were given, by the
    /// reason; in no other count.
    #[serde(default)]
    pub removed: BTreeMap<String, u64>,
    /// Points of which it is not known whether a denominator of the given equations is 0 there, or a root is on a false branch.
    #[serde(default)]
    pub doubtful_denominators: u64,
    /// Solutions that were computed from the equations alone: no path was followed to them.
    #[serde(default)]
    pub without_path: u64,
    /// Nonsingular solutions, not real, of equations that conjugation leaves as they are, without their conjugates: one of
    /// both is wrong or missing.
    #[serde(default)]
    pub without_conjugate: u64,
    /// Nonsingular solutions with a condition number above 1e7, or roots of one equation near each other: other digits of
    /// the data, in the last place of a double, may make one solution of two or leave none.
    #[serde(default)]
    pub ill_conditioned: u64,
}

/// Numbers of solutions of the equations, by elimination over a prime field. Where numbers in the equations are not
/// exact, the count is for general values of these, which have at least as many solutions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ExactCount {
    /// Dimension of the set of solutions; 0 also where there is none.
    pub dimension: u32,
    /// Number of solutions with multiplicities; null where there are infinitely many.
    pub with_multiplicity: Option<u64>,
    /// Number of distinct solutions; null where there are infinitely many, or it takes too much.
    pub distinct: Option<u64>,
    /// Nonsingular ones where there are infinitely many solutions; null where it was not asked.
    pub nonsingular: Option<u64>,
    /// Whether what paths found agrees with it.
    pub agrees: bool,
    /// Whether the count is for general values.
    #[serde(default)]
    pub is_general: bool,
}

/// Solutions with more digits than paths give.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SharpenedCounts {
    /// Decimal digits that were asked for.
    pub digits: u32,
    /// Solutions that have this many digits.
    pub solutions: u64,
    /// Singular solutions that got their digits by deflation.
    pub by_deflation: u64,
}

/// Orbits under a symmetry group.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClassCounts {
    /// Number of orbits.
    pub count: Option<u64>,
    /// Order of the group.
    pub group_order: Option<u64>,
    /// Orbits of which every member was found.
    pub complete: Option<u64>,
    /// Reason why a declared symmetry is none; the solutions then have no classes.
    #[serde(default)]
    pub doubt: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_as_the_contract_has_them() {
        let paths = PathCounts {
            total: 128,
            by_precision: [(106, 2), (53, 126)].into(),
            excess: Some(0),
            ..PathCounts::default()
        };
        assert_eq!(
            serde_json::to_string(&paths).unwrap(),
            "{\"total\":128,\"finite\":0,\"singular\":0,\"positive_dimensional\":null,\
             \"excess\":0,\"at_infinity\":0,\"failed\":0,\"retracked\":0,\"crossings_found\":0,\
             \"crossings_resolved\":0,\"decided_by_precision_limit\":0,\
             \"by_precision\":{\"53\":126,\"106\":2},\"highest_precision_bits\":0,\
             \"degenerate\":{},\"images\":0,\"undecided\":0,\"within_data_accuracy\":0,\
             \"decided_by_exact_count\":0,\"removed\":0}"
        );
        let back: PathCounts =
            serde_json::from_str(&serde_json::to_string(&paths).unwrap()).unwrap();
        assert_eq!(back, paths);
        assert_eq!(
            serde_json::to_string(&SolutionCounts::default()).unwrap(),
            "{\"distinct\":0,\"nonsingular\":0,\"singular\":0,\"real\":null,\"real_reason\":null,\
             \"with_multiplicity\":0,\"certified\":null,\"certified_real\":null,\"positive_dimensional\":null,\
             \"degenerate\":{},\"sharpened\":null,\"undecided\":0,\
             \"doubtful_multiplicity\":0,\"complete\":\"not known\",\"complete_reason\":null,\
             \"exact_count\":null,\"removed\":{},\"doubtful_denominators\":0,\"without_path\":0,\"without_conjugate\":0,\
             \"ill_conditioned\":0}"
        );
        assert_eq!(
            serde_json::to_string(&ClassCounts::default()).unwrap(),
            "{\"count\":null,\"group_order\":null,\"complete\":null,\"doubt\":null}"
        );
    }
}
