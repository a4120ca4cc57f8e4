//! PutAside: paths that do not end regularly wait until the others have ended. Where an exact count of solutions says
//! that these end at all there are, no path is left for any other: those put aside run to infinity, or to what solves only
//! the combinations of equations that are tracked; their endgames, which cost most, are not needed to know it. Else
//! they are followed to their ends.

use super::criteria::Criteria;
use super::path_store::PathStore;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::tracker::settings::Settings;
use cognate_numeric::precision::DOUBLE;
use cognate_solutions::classification::Verdict;
use cognate_systems::polynomial::{SolutionCount, solution_count};
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A start with more paths than this is not for systems that can be counted.
const MOST_PATHS: u64 = 20_000;
/// Operations that a count may take for each path that is put aside: a fraction of what its endgame costs.
const OPERATIONS_PER_PATH: u64 = 300_000;
/// ... in all, which bounds the memory that a count takes, too,
const MOST_OPERATIONS: u64 = 400_000_000;
/// ... and for the smallest systems.
const LEAST_OPERATIONS: u64 = 4_000_000;

/// What becomes of the paths of a stage that do not end regularly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) enum PutAside {
    /// Every path is followed to its end at once.
    #[default]
    Never,
    /// They are put aside until the others have ended; the solutions of this system are counted then.
    First(Arc<System>),
    /// Simple solutions are missing still, of so many: those that are put aside have their endgames, in doubles.
    InDoubles(u64),
    /// All solutions are found: none of those put aside is followed.
    Confirmed(SolutionCount),
    /// They are followed to their ends: not all solutions were found before, or their number is not known.
    Followed(Option<SolutionCount>),
}

impl PutAside {
    /// Puts paths aside where the solutions can be counted, and the number of finite ones says all about the others.
    pub fn of(system: &System, criteria: &Criteria) -> Self {
        let homotopy = &criteria.first.homotopy;
        let affine = system.groups.iter().all(|group| !group.homogeneous);
        let determined = system.equation_count() >= system.dimension();
        let all_count = homotopy.takes_all_paths()
            && homotopy.ends_at_the_system()
            && criteria.lost == 0
            && criteria.exchange().is_none()
            && criteria.declared.names().next().is_none();
        let countable = affine && determined && system.parameters.is_empty();
        match all_count && countable && criteria.paths_per_target <= MOST_PATHS {
            true => Self::First(Arc::new(system.clone())),
            false => Self::Never,
        }
    }

    /// These settings, for the next stage.
    pub fn settings(&self, settings: Settings) -> Settings {
        let max_endgame_bits = match self {
            Self::First(_) => 0,
            Self::InDoubles(_) => DOUBLE,
            Self::Never | Self::Confirmed(_) | Self::Followed(_) => u32::MAX,
        };
        Settings {
            max_endgame_bits,
            ..settings
        }
    }

    /// How many solutions the system has, if that was asked.
    pub fn count(&self) -> Option<SolutionCount> {
        match self {
            Self::Never | Self::First(_) => None,
            Self::InDoubles(simple) => Some(all_simple(*simple)),
            Self::Confirmed(count) => Some(*count),
            Self::Followed(count) => *count,
        }
    }

    /// No path fails or meets another any more: the paths that must be followed further, ascending.
    pub fn close(&mut self, paths: &PathStore, criteria: &Criteria) -> Vec<u64> {
        let is_aside = |result: &&PathResult| result.outcome == PathOutcome::PutAside;
        let results = paths.results().iter();
        let aside: Vec<u64> = results.filter(is_aside).map(|r| r.origin.0).collect();
        let count = match self {
            Self::Never | Self::Confirmed(_) | Self::Followed(_) => return Vec::new(),
            Self::First(_) if aside.is_empty() => None,
            Self::First(system) => {
                let operations = OPERATIONS_PER_PATH.saturating_mul(aside.len() as u64);
                solution_count(system, operations.clamp(LEAST_OPERATIONS, MOST_OPERATIONS))
            }
            Self::InDoubles(simple) => Some(all_simple(*simple)),
        };
        let decisions = paths.results().iter().map(|r| criteria.decide(r).verdict);
        let finite = decisions.filter(|&v| v == Verdict::Finite).count() as u64;
        let simple = match count {
            Some(SolutionCount::Finite {
                with_multiplicity,
                distinct: Some(distinct),
            }) if with_multiplicity == distinct => Some(distinct),
            _ => None,
        };
        let missing = simple.map(|simple| simple.saturating_sub(finite));
        *self = match (simple, missing, &*self) {
            (Some(simple), Some(0), _) if finite == simple => Self::Confirmed(all_simple(simple)),
            (Some(simple), Some(1..), Self::First(_)) => Self::InDoubles(simple),
            _ => Self::Followed(count),
        };
        if let Self::Confirmed(_) = self {
            return Vec::new();
        }
        aside
    }
}

/// So many solutions, none of them multiple.
fn all_simple(number: u64) -> SolutionCount {
    SolutionCount::Finite {
        with_multiplicity: number,
        distinct: Some(number),
    }
}
