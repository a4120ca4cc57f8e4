//! PutAside: paths that do not end regularly wait until the others have ended. Where an exact count of solutions says
//! that these end at all there are, no path is left for any other: those put aside run to infinity, or to what solves
//! only the combinations of equations that are tracked; their endgames, which cost most, are not needed to know it.
//! Else they are followed further, first in few digits; and where that does not lead to all solutions, these are asked
//! of the equations, if they are few. Else the paths are followed to their ends.

use super::criteria::Criteria;
use super::path_store::PathStore;
use crate::exact_answer;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::tracker::settings::Settings;
use cognate_numeric::precision::{DOUBLE, DOUBLE_DOUBLE};
use cognate_solutions::classification::Verdict;
use cognate_systems::polynomial::exact_points::exact_points;
use cognate_systems::polynomial::{CountedSolutions, SolutionCount, solution_count};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A start with more paths than this is not for systems that can be counted.
const MOST_PATHS: u64 = 20_000;
/// Operations that a count may take for each path that is put aside: a fraction of what its endgame costs.
const OPERATIONS_PER_PATH: u64 = 300_000;
/// Most operations of one count, which also bounds the memory that it takes.
const MOST_OPERATIONS: u64 = 400_000_000;
/// Operations that a count may take even for the smallest systems.
const LEAST_OPERATIONS: u64 = 4_000_000;
/// Operations that all solutions of the equations may take for each path that would have its endgame in more digits
/// than 53, and than 106 bits: a fraction of that.
const EXACT_OPERATIONS_PER_PATH: [u64; 2] = [1_000_000, 20_000_000];
/// Operations that all solutions of the equations may take for each singular end of which it would be asked whether it
/// is isolated: what that takes for a multiple point.
const EXACT_OPERATIONS_PER_POINT: u64 = 20_000_000;

/// No more open paths than this for each missing solution are followed further: some of them lead to it.
const PATHS_FOR_EACH_MISSING: u64 = 2;

/// State of the paths of a stage that do not end regularly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) enum PutAside {
    /// Every path is followed to its end at once.
    #[default]
    Never,
    /// Paths that do not end regularly are put aside until the others have ended.
    First {
        /// Equations whose solutions are counted once the other paths have ended.
        equations: AskedEquations,
        /// Number of solutions of the equations, once it was asked for.
        count: Option<Option<CountedSolutions>>,
        /// Whether the answer may be that of the equations without paths.
        settles_doubts: bool,
    },
    /// Simple solutions are still missing: the paths that were put aside have their endgames, in few digits.
    InFewDigits {
        /// The most bits of a number.
        bits: u32,
        /// Number of solutions.
        counted: CountedSolutions,
        /// Equations, if the answer may be that of the equations without paths.
        equations: Option<AskedEquations>,
    },
    /// All solutions are found: no path that was put aside is tracked further.
    Confirmed(SolutionCount),
    /// The paths are tracked to their ends: not all solutions were found before, or their number is not known.
    Followed {
        /// Number of solutions, if it is known.
        count: Option<SolutionCount>,
        /// Equations, if the answer may be that of the equations without paths.
        equations: Option<AskedEquations>,
    },
}

/// Equations at values of their parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct AskedEquations {
    system: Arc<System>,
    parameters: Vec<Complex64>,
    /// Whether the given equations have no denominators: else these have more solutions than the given ones.
    are_given: bool,
}

impl PutAside {
    /// Puts paths aside where the solutions can be counted, and the number of finite ones says all about the others.
    /// `settles_doubts`: whether the answer may be that of the equations without paths.
    pub fn of(system: &System, criteria: &Criteria, settles_doubts: bool) -> Self {
        let homotopy = &criteria.first.homotopy;
        let affine = system.groups.iter().all(|group| !group.homogeneous);
        let determined = system.equation_count() >= system.dimension();
        let all_count = homotopy.takes_all_paths()
            && homotopy.ends_at_the_system()
            && criteria.lost == 0
            && criteria.exchange().is_none()
            && criteria.declared.names().next().is_none();
        let parameters = match all_count {
            true => homotopy.end_parameters(0, system.path_variable),
            false => None,
        };
        let is_small = criteria.paths_per_target <= MOST_PATHS;
        match parameters.filter(|_| affine && determined && is_small) {
            Some(parameters) => Self::First {
                equations: AskedEquations {
                    parameters: parameters.into_owned(),
                    are_given: system.degenerate.is_empty(),
                    // Paths end at solutions of the equations as they are tracked, where a denominator of the given
                    // ones is 0, too.
                    system: Arc::new(System {
                        degenerate: BTreeMap::new(),
                        ..system.clone()
                    }),
                },
                count: None,
                settles_doubts,
            },
            None => Self::Never,
        }
    }

    /// Settings for the next stage.
    pub fn settings(&self, settings: Settings) -> Settings {
        let max_endgame_bits = match self {
            Self::First { .. } => 0,
            Self::InFewDigits { bits, .. } => *bits,
            Self::Never | Self::Confirmed(_) | Self::Followed { .. } => u32::MAX,
        };
        Settings {
            max_endgame_bits,
            ..settings
        }
    }

    /// Number of solutions of the system, if it was counted. Where values of parameters may stand for special ones with
    /// fewer solutions, only if all are found.
    pub fn count(&self) -> Option<SolutionCount> {
        match self {
            Self::Confirmed(count)
            | Self::Followed {
                count: Some(count), ..
            } => Some(*count),
            _ => self.counted().and_then(special),
        }
    }

    /// Whether each of the solutions that there are is the end of a path of its own, so that none is left for any other
    /// path; no two finite ends meet. What is not known of the others is not asked then: they are put aside.
    pub fn confirms(&mut self, paths: &mut PathStore, criteria: &Criteria) -> bool {
        self.ask(paths);
        let Some(simple) = self.simple() else {
            return false;
        };
        let decided = |result: &PathResult| (result.origin.0, criteria.decide(result).verdict);
        let verdicts: Vec<(u64, Verdict)> = paths.results().iter().map(decided).collect();
        let finite = verdicts.iter().filter(|(_, v)| *v == Verdict::Finite);
        if finite.count() as u64 != simple {
            return false;
        }
        for (path, verdict) in verdicts {
            let held = match verdict {
                Verdict::Failed
                | Verdict::PositiveDimensional
                | Verdict::Undecided
                | Verdict::Singular => paths.get_mut(path),
                Verdict::Finite
                | Verdict::AtInfinity
                | Verdict::Removed
                | Verdict::ExcessSolution
                | Verdict::WithinDataAccuracy => None,
            };
            if let Some(held) = held {
                held.outcome = PathOutcome::PutAside;
            }
        }
        *self = Self::Confirmed(all_simple(simple));
        true
    }

    /// Counts the solutions of the system, once some paths are put aside or have failed.
    fn ask(&mut self, paths: &PathStore) {
        let Self::First {
            equations, count, ..
        } = self
        else {
            return;
        };
        let unended =
            |r: &&PathResult| matches!(r.outcome, PathOutcome::PutAside | PathOutcome::Failed(_));
        let unended = paths.results().iter().filter(unended).count() as u64;
        if count.is_none() && unended > 0 {
            let operations = OPERATIONS_PER_PATH.saturating_mul(unended);
            let operations = operations.clamp(LEAST_OPERATIONS, MOST_OPERATIONS);
            let counted = solution_count(&equations.system, &equations.parameters, operations).ok();
            // A number of solutions that is not exact decides nothing about single paths.
            *count = Some(counted.filter(|counted| counted.is_exact));
        }
    }

    /// No path fails or meets another any more, and solutions are missing, or their number is not known: the paths that
    /// must be followed further, ascending.
    pub fn follow(&mut self, paths: &PathStore) -> Vec<u64> {
        let simple = self.counted().filter(|_| self.simple().is_some());
        let follows = match (simple, &*self) {
            (_, Self::Never | Self::Confirmed(_) | Self::Followed { .. }) => return Vec::new(),
            (Some(counted), Self::First { .. }) => Self::InFewDigits {
                bits: DOUBLE,
                counted,
                equations: self.equations_instead().cloned(),
            },
            (Some(counted), Self::InFewDigits { bits: DOUBLE, .. }) => Self::InFewDigits {
                bits: DOUBLE_DOUBLE,
                counted,
                equations: self.equations_instead().cloned(),
            },
            _ => Self::Followed {
                count: self.count(),
                equations: self.equations_instead().cloned(),
            },
        };
        *self = follows;
        let aside = |result: &&PathResult| result.outcome == PathOutcome::PutAside;
        let aside = paths.results().iter().filter(aside);
        aside.map(|result| result.origin.0).collect()
    }

    /// Whether solutions are missing still after endgames in few digits, but the equations have them all without paths:
    /// what is not known of paths is not asked then. The answer takes them from there. `attempt`: how often paths that
    /// failed were tracked again.
    pub fn leaves_the_rest_to_the_equations(&mut self, paths: &PathStore, attempt: u16) -> bool {
        let number = |holds: &dyn Fn(&PathOutcome) -> bool| {
            let counted = paths.results().iter().filter(|r| holds(&r.outcome));
            counted.count() as u64
        };
        let regular = number(&|outcome| *outcome == PathOutcome::Regular);
        let failed = number(&|outcome| matches!(outcome, PathOutcome::Failed(_)));
        let open = failed + number(&|outcome| *outcome == PathOutcome::PutAside);
        let failed_again = if attempt > 0 { failed } else { 0 };
        let [few, many] = EXACT_OPERATIONS_PER_PATH;
        let (of_each, missing) = match self {
            Self::InFewDigits { bits, counted, .. } => {
                let SolutionCount::Finite {
                    with_multiplicity, ..
                } = counted.count
                else {
                    return false;
                };
                let of_each = if *bits == DOUBLE { few } else { many };
                (of_each, with_multiplicity.saturating_sub(regular))
            }
            // No count says how many are missing.
            Self::First {
                count: Some(None), ..
            } => (0, open),
            _ => return false,
        };
        if failed_again == 0 && open <= missing.saturating_mul(PATHS_FOR_EACH_MISSING) {
            return false;
        }
        let operations = of_each.saturating_mul(open);
        self.is_left_to_the_equations(operations + many.saturating_mul(failed_again))
    }

    /// Whether the equations have all solutions without paths for less than it takes to find out whether this many
    /// singular ends are isolated, which is not asked then. The answer takes the solutions from there.
    pub fn leaves_singular_ends_to_the_equations(&mut self, points: u64) -> bool {
        // Ends where a denominator is 0 are taken from the answer, which must know of them whether they are isolated.
        let are_given = self.equations_instead().is_some_and(|e| e.are_given);
        let operations = EXACT_OPERATIONS_PER_POINT.saturating_mul(points);
        are_given && self.is_left_to_the_equations(operations)
    }

    /// Whether the equations have all solutions without paths, within this many operations, and as many as are counted.
    fn is_left_to_the_equations(&mut self, operations: u64) -> bool {
        let Some(equations) = self.equations_instead() else {
            return false;
        };
        let operations = operations.min(exact_answer::MOST_OPERATIONS);
        let points = exact_points(&equations.system, &equations.parameters, 0, operations);
        let Ok(Some(points)) = points else {
            return false;
        };
        let exact = SolutionCount::Finite {
            with_multiplicity: points.iter().map(|point| point.multiplicity).sum(),
            distinct: Some(points.len() as u64),
        };
        let agrees = self.count().is_none_or(|counted| counted == exact);
        if agrees {
            *self = Self::Confirmed(exact);
        }
        agrees
    }

    /// The equations, where the answer may be theirs without paths.
    fn equations_instead(&self) -> Option<&AskedEquations> {
        match self {
            Self::First {
                equations,
                settles_doubts: true,
                ..
            } => Some(equations),
            Self::InFewDigits { equations, .. } | Self::Followed { equations, .. } => {
                equations.as_ref()
            }
            Self::First { .. } | Self::Never | Self::Confirmed(_) => None,
        }
    }

    /// Whether solutions are missing whose number is known, and no endgame has begun.
    pub fn knows_what_is_missing(&self) -> bool {
        matches!(self, Self::First { .. }) && self.simple().is_some()
    }

    /// The count, until all are found or it is of no use any more.
    fn counted(&self) -> Option<CountedSolutions> {
        match self {
            Self::First { count, .. } => (*count)?,
            Self::InFewDigits { counted, .. } => Some(*counted),
            Self::Never | Self::Confirmed(_) | Self::Followed { .. } => None,
        }
    }

    /// Number of solutions, if none is multiple.
    fn simple(&self) -> Option<u64> {
        let counted = self.counted().map(|counted| counted.count);
        match counted.or_else(|| self.count())? {
            SolutionCount::Finite {
                with_multiplicity,
                distinct: Some(distinct),
            } => Some(distinct).filter(|&distinct| distinct == with_multiplicity),
            _ => None,
        }
    }
}

/// A count that is not one of general values.
fn special(counted: CountedSolutions) -> Option<SolutionCount> {
    (!counted.is_general).then_some(counted.count)
}

/// Count of this number of solutions, none of them multiple.
fn all_simple(number: u64) -> SolutionCount {
    SolutionCount::Finite {
        with_multiplicity: number,
        distinct: Some(number),
    }
}
