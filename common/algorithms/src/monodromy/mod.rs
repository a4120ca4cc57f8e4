//! Monodromy: all solutions of a generic member of a family, from one of them.
//!
//! The start solutions are followed to random complex parameters, the base.
//! From there loops are made, in a graph of random parameters with several
//! detours between each two; every solution that turns up anywhere takes part in
//! all of them, whichever way leads to more new ones. When some loops in a row
//! bring nothing new, all that is known at the base is followed
//! to the parameters that are asked for. With a symmetry group one solution of
//! each orbit is tracked. A jump of a path cannot make a false solution here,
//! it only breaks the bijection of a leg, and that is seen ([`graph`]).
//!
//! The search is a plain value ([`search`]); a trace test may make a second one ([`section_search`]). The solve opens
//! their stages ([`stages`]), and at last tracks all solutions to the parameters that are asked for.

pub mod counts;
pub mod estimate;
mod fresh_loops;
mod graph;
mod idle_loops;
mod loop_limits;
mod loop_start;
mod moved_slices;
mod orbits;
mod places;
mod search;
mod section_search;
mod stages;
pub mod trace;
mod warnings;

use crate::answer::{Answer, FoundByLoops, IsolatedSolutions};
use crate::completeness_claim::CompletenessClaim;
use crate::finite_endpoints::FiniteEndpoints;
use crate::parameter_solve::ParameterSolve;
use crate::plan_error::PlanError;
use crate::progress::{self, Progress, StageProgress, VerdictCounts};
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::StageId;
use cognate_numeric::counted::counted;
use cognate_solutions::classification::Tolerances;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::{History, SolutionSet};
use cognate_solutions::symmetry::SymmetryGroup;
use cognate_systems::system::System;
use counts::{LoopCounts, Stop};
use graph::{BASE, PathBatch};
pub use loop_limits::{LoopLimits, MOST_IDLE};
pub use loop_start::LoopStart;
use num_complex::Complex64;
use places::{Sizes, generic_parameters};
use search::{LoopSearch, NextRound, Symmetry};
use serde::{Deserialize, Serialize};
use stages::SearchStages;
use std::collections::BTreeMap;
use trace::TraceTest;

/// Batches of paths that are tracked side by side, each by a stage of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Round {
    /// Batches in the order in which their stages are opened.
    batches: Vec<PathBatch>,
    /// Number of batches whose stages are open or absorbed.
    opened: usize,
    /// Results of the absorbed stages.
    results: BTreeMap<StageId, Vec<PathResult>>,
}

/// Step of a solve by monodromy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// A search is asked for its next round.
    Planning,
    /// Paths between vertices are tracked; the round is taken in when all its stages are back.
    Tracking(Round),
    /// The images of one solution under this group are tracked on the spot: are they solutions?
    SymmetryCheck(SymmetryGroup),
    /// Paths from the base to the wanted parameters.
    Arriving(Box<ParameterSolve>),
    /// There is nothing to go on from, or nothing more is asked.
    Ended,
}

/// The solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MonodromySolve {
    search: LoopSearch,
    /// Search of a trace test with sections, while it runs: it is tracked in the place of the other.
    section_search: Option<Box<LoopSearch>>,
    phase: Phase,
    settings: Settings,
    targets: Vec<Vec<Complex64>>,
    /// Stages of both searches.
    stages: Vec<StageProgress>,
}

impl MonodromySolve {
    /// The solve of a checked system, whose parameters are free to move.
    pub fn new(
        system: &System,
        start: LoopStart,
        targets: Vec<Vec<Complex64>>,
        limits: LoopLimits,
        settings: Settings,
        tolerances: Tolerances,
        seed: u64,
    ) -> Result<Self, PlanError> {
        let group = SymmetryGroup::of(system)?;
        let shape = PointShape::of(system);
        let mut search = LoopSearch::new(start, limits, shape, tolerances, seed);
        if !group.is_trivial() {
            search.symmetry = Symmetry::Unchecked(group);
        }
        if limits.trace_test {
            let base = &search.graph.vertices[BASE].parameters;
            let direction = generic_parameters(base, seed, usize::MAX >> 1, Sizes::Own);
            let test = TraceTest::of(system, base, direction, seed);
            search.trace_test = Some(test.map_err(PlanError::NoTraceTest)?);
        }
        Ok(Self {
            search,
            section_search: None,
            phase: Phase::Planning,
            settings,
            targets,
            stages: Vec::new(),
        })
    }

    /// Replaces the limit of repetitions of a path.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.search.max_retries = max_retries;
        self
    }

    /// Counts of the loops so far.
    pub fn counts(&self) -> &LoopCounts {
        &self.search.counts
    }

    /// The search whose paths are tracked.
    fn running_search(&self) -> &LoopSearch {
        self.section_search.as_deref().unwrap_or(&self.search)
    }

    fn running_search_mut(&mut self) -> &mut LoopSearch {
        let section_search = self.section_search.as_deref_mut();
        section_search.unwrap_or(&mut self.search)
    }

    /// Stages of the search whose paths are tracked.
    fn search_stages(&self) -> SearchStages<'_> {
        SearchStages {
            search: self.running_search(),
            settings: &self.settings,
        }
    }

    /// The phase after a round, or at the beginning.
    fn next_phase(&mut self) -> Phase {
        match self.running_search_mut().next_round() {
            NextRound::Batches(batches) => Phase::Tracking(Round {
                batches,
                opened: 0,
                results: BTreeMap::new(),
            }),
            NextRound::SymmetryCheck(group) => Phase::SymmetryCheck(group),
            NextRound::Sections(search) => {
                self.section_search = Some(search);
                Phase::Planning
            }
            NextRound::Stop => match self.section_search.take() {
                Some(sections) => {
                    self.search.settle_sections(&sections);
                    Phase::Planning
                }
                None => self.arrival(),
            },
        }
    }

    /// Begins to track all solutions of the base to the wanted parameters.
    fn arrival(&self) -> Phase {
        if self.search.counts.stop == Some(Stop::NoStart) || self.falls_short() {
            return Phase::Ended;
        }
        let first = self.search_stages().arrival(&self.targets);
        let (orbits, tolerances) = (&self.search.orbits, &self.search.tolerances);
        let solve = ParameterSolve::with_shape(first, &orbits.shape, tolerances.clone())
            .with_group(orbits.group.clone())
            .with_max_retries(self.search.max_retries);
        Phase::Arriving(Box::new(solve))
    }

    /// Whether loops have ended that may have missed solutions where that is no answer.
    fn falls_short(&self) -> bool {
        let stop = self.search.counts.stop;
        self.search.limits.only_complete && stop.is_some_and(|stop| stop != Stop::TraceTest)
    }

    fn description(&self) -> String {
        let counts = &self.running_search().counts;
        let solutions = if counts.group_order > 1 {
            format!(
                "{} in {}",
                counted(counts.solutions, "solution"),
                counted(counts.classes, "class")
            )
        } else {
            counted(counts.solutions, "solution")
        };
        let open = self.stages.iter().filter(|stage| !stage.absorbed);
        let paths: u64 = open.map(|stage| stage.items).sum();
        let prefix = if self.section_search.is_some() {
            "trace test; "
        } else {
            ""
        };
        format!(
            "{prefix}monodromy: {solutions}, {} ({} idle), tracking {}",
            counted(counts.loops, "loop"),
            counts.idle_loops,
            counted(paths, "path")
        )
    }
}

impl Solve for MonodromySolve {
    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        match &self.phase {
            Phase::Arriving(solve) => solve.finite_endpoints(),
            Phase::Planning | Phase::Tracking(_) | Phase::SymmetryCheck(_) | Phase::Ended => None,
        }
    }

    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        loop {
            match &mut self.phase {
                Phase::Planning => {
                    self.phase = self.next_phase();
                    if let Phase::SymmetryCheck(group) = &self.phase {
                        let opening = self.search_stages().symmetry_check(group);
                        return numbers.open(opening, &mut self.stages);
                    }
                }
                Phase::Tracking(round) => {
                    let Some(batch) = round.batches.get(round.opened).cloned() else {
                        return Next::Wait;
                    };
                    round.opened += 1;
                    let opening = self.search_stages().batch(&batch);
                    return numbers.open(opening, &mut self.stages);
                }
                Phase::SymmetryCheck(_) => return Next::Wait,
                Phase::Arriving(solve) => return solve.next(numbers),
                Phase::Ended => return Next::Done,
            }
        }
    }

    fn absorb(&mut self, id: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        if let Phase::Arriving(solve) = &mut self.phase {
            solve.absorb(id, results);
            return;
        }
        let stage = progress::absorb(&mut self.stages, id);
        let results: Vec<PathResult> = results.map(ItemResult::into_path).collect();
        assert_eq!(
            results.len() as u64,
            stage.items,
            "a stage is absorbed as a whole"
        );
        self.running_search_mut().counts.tracked += stage.items;
        match std::mem::replace(&mut self.phase, Phase::Planning) {
            Phase::SymmetryCheck(group) => self.search.settle_symmetry(group, &results),
            Phase::Tracking(mut round) => {
                round.results.insert(id, results);
                if round.results.len() < round.batches.len() {
                    self.phase = Phase::Tracking(round);
                } else {
                    let results = round.results.into_values();
                    self.running_search_mut().settle(round.batches, results);
                }
            }
            Phase::Planning | Phase::Arriving(_) | Phase::Ended => {
                unreachable!("no stage is open then")
            }
        }
    }

    fn failure(&self) -> Option<String> {
        let solution_count = self.search.counts.solutions;
        self.falls_short().then(|| {
            format!(
                "loops through the family of the system found {solution_count} solutions of a \
                 member, and no trace test says that these are all; another seed may do, or another \
                 start"
            )
        })
    }

    fn progress(&self) -> Progress {
        let counts = &self.search.counts;
        let mut progress = if let Phase::Arriving(solve) = &self.phase {
            let progress = solve.progress();
            Progress {
                description: format!(
                    "monodromy found {} solutions; {}",
                    counts.solutions, progress.description
                ),
                ..progress
            }
        } else {
            let done = matches!(self.phase, Phase::Ended);
            Progress {
                description: if done {
                    "monodromy: no start solution could be tracked".to_string()
                } else {
                    self.description()
                },
                stages: Vec::new(),
                paths: VerdictCounts {
                    finite: counts.tracked - counts.lost,
                    failed: counts.lost,
                    ..VerdictCounts::default()
                },
                done,
            }
        };
        progress.stages.splice(0..0, self.stages.iter().copied());
        progress
    }

    fn completeness(&self) -> Option<CompletenessClaim> {
        warnings::completeness(&self.search.counts, self.search.limits.count)
    }

    fn answer(&self, system: &System) -> Option<Answer> {
        let search = &self.search;
        let mut warnings: Vec<String> = warnings::of_symmetry(search).into_iter().collect();
        let mut sets = if let Phase::Arriving(solve) = &self.phase {
            warnings.extend(warnings::of_end(search));
            solve.solution_sets(system)
        } else {
            let start_results: Vec<PathResult> = search.start_results.values().cloned().collect();
            let set = SolutionSet::new(
                system,
                &search.graph.vertices[BASE].parameters,
                &start_results,
                &History::default(),
                &search.tolerances,
                search.seed,
            );
            vec![set; self.targets.len()]
        };
        for set in &mut sets {
            set.warnings.extend(warnings.iter().cloned());
        }
        let names = system.parameters.iter().cloned();
        let parameters = match self.targets.as_slice() {
            [one] => names.zip(one.iter().copied()).collect(),
            _ => BTreeMap::new(),
        };
        Some(Answer::Isolated(IsolatedSolutions {
            sets,
            loops: Some(FoundByLoops {
                counts: search.counts.clone(),
                parameters,
            }),
            held: None,
        }))
    }

    /// The first stage to the wanted parameters.
    fn counted_stage(&self) -> StageId {
        if let Phase::Arriving(solve) = &self.phase {
            solve.paths().first_id()
        } else {
            StageId(0)
        }
    }
}

#[cfg(test)]
mod tests;
