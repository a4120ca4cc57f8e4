//! AnyAlgorithm: a job, whatever solves it, which can be written down and read back.

use crate::answer::Answer;
use crate::closings::Closing;
use crate::completeness_claim::CompletenessClaim;
use crate::decomposition::DecompositionSolve;
use crate::exact_count::{self, ExactCounting, SEVERAL_TARGETS};
use crate::monodromy::MonodromySolve;
use crate::monodromy::counts::{LoopCounts, Stop};
use crate::overdetermined_solve::OverdeterminedSolve;
use crate::parameter_solve::ParameterSolve;
use crate::polyhedral_solve::PolyhedralSolve;
use crate::progress::Progress;
use crate::questions::QuestionSolve;
use crate::regeneration_solve::RegenerationSolve;
use crate::retried_stage::RetriedStage;
use crate::rounded_data::{doubt_coefficient, doubt_overdetermined_part, warn_of_rounded_data};
use crate::solve::{Next, PathAlgorithm, Solve, StageNumbers};
use crate::solve_without_paths::SolveWithoutPaths;
use crate::zero_dimensional_solve::ZeroDimensionalSolve;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::StageId;
use cognate_numeric::counted::counted;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::streamed::PathFilter;
use cognate_solutions::typed_unknowns::write_typed;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// Version of the snapshots; another is not read.
const VERSION: u8 = 42;

/// Every solve that a plan can choose.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum AnySolve {
    /// All isolated solutions of one system.
    ZeroDimensional(ZeroDimensionalSolve),
    /// Solutions at given parameters, tracked to other parameters.
    Parameter(ParameterSolve),
    /// All solutions of a general member of a family, from one of them by loops.
    Monodromy(Box<MonodromySolve>),
    /// All isolated solutions of one system, from mixed cells.
    Polyhedral(Box<PolyhedralSolve>),
    /// All regular solutions of one system, equation by equation.
    Regeneration(Box<RegenerationSolve>),
    /// All isolated solutions of more equations than unknowns, equation by equation.
    Overdetermined(Box<OverdeterminedSolve>),
    /// All components of one system.
    Decomposition(Box<DecompositionSolve>),
    /// A question to components that are known.
    Question(Box<QuestionSolve>),
    /// All solutions, computed while the solve is planned.
    WithoutPaths(Box<SolveWithoutPaths>),
}

/// A job: a solve, what is done with its endpoints afterwards, and the numbers of its stages.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnyAlgorithm {
    solve: AnySolve,
    /// Closings after the solve, in the order in which they run.
    closings: Vec<Closing>,
    counting: ExactCounting,
    /// Relative accuracy to which the equations' coefficients are known; 0 where they are exact.
    data_accuracy: f64,
    numbers: StageNumbers,
}

impl From<AnySolve> for AnyAlgorithm {
    fn from(solve: AnySolve) -> Self {
        Self {
            solve,
            closings: Vec::new(),
            counting: ExactCounting::default(),
            data_accuracy: 0.0,
            numbers: StageNumbers::default(),
        }
    }
}

/// Reason why a snapshot cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// Another version of the program wrote the snapshot.
    #[error("the snapshot has version {found}, this program reads version {VERSION}")]
    Version {
        /// The version that it names.
        found: u8,
    },
    /// The bytes are no snapshot, or not a whole one.
    #[error("the snapshot is damaged: {0}")]
    Damaged(String),
}

impl AnySolve {
    fn get(&self) -> &dyn Solve {
        match self {
            Self::ZeroDimensional(solve) => solve,
            Self::Parameter(solve) => solve,
            Self::Monodromy(solve) => &**solve,
            Self::Polyhedral(solve) => &**solve,
            Self::Regeneration(solve) => &**solve,
            Self::Overdetermined(solve) => &**solve,
            Self::Decomposition(solve) => &**solve,
            Self::Question(solve) => &**solve,
            Self::WithoutPaths(solve) => &**solve,
        }
    }

    fn get_mut(&mut self) -> &mut dyn Solve {
        match self {
            Self::ZeroDimensional(solve) => solve,
            Self::Parameter(solve) => solve,
            Self::Monodromy(solve) => &mut **solve,
            Self::Polyhedral(solve) => &mut **solve,
            Self::Regeneration(solve) => &mut **solve,
            Self::Overdetermined(solve) => &mut **solve,
            Self::Decomposition(solve) => &mut **solve,
            Self::Question(solve) => &mut **solve,
            Self::WithoutPaths(solve) => &mut **solve,
        }
    }
}

impl AnyAlgorithm {
    /// The state that [`Self::snapshot`] wrote.
    pub fn restore(snapshot: &[u8]) -> Result<Self, RestoreError> {
        match snapshot.split_first() {
            None => Err(RestoreError::Damaged("it is empty".into())),
            Some((&VERSION, bytes)) => postcard::from_bytes(bytes)
                .map_err(|error| RestoreError::Damaged(error.to_string())),
            Some((&version, _)) => Err(RestoreError::Version { found: version }),
        }
    }

    /// The whole state, to be restored where another process goes on (see [`Self::restore`]).
    pub fn snapshot(&self) -> Vec<u8> {
        postcard::to_extend(self, vec![VERSION]).expect("memory takes every byte")
    }

    /// The state as a value to be serialized piece by piece: the written bytes read as the bytes of [`Self::snapshot`]
    /// with their number before them.
    pub fn counted_snapshot(&self) -> impl Serialize + '_ {
        let state = (VERSION, self);
        let size = postcard::experimental::serialized_size(&state);
        (size.expect("a state has a size"), state)
    }

    /// Closes the solve with this, too, after the closings that there are.
    pub fn close_with(&mut self, closing: Closing) {
        self.closings.push(closing);
    }

    /// Sets how the solutions are counted exactly.
    #[must_use]
    pub(crate) fn with_counting(self, counting: ExactCounting) -> Self {
        Self { counting, ..self }
    }

    /// Sets the relative accuracy to which the coefficients of the equations are known.
    #[must_use]
    pub(crate) fn with_data_accuracy(self, data_accuracy: f64) -> Self {
        Self {
            data_accuracy,
            ..self
        }
    }

    /// The solve, without what is done afterwards.
    pub fn solve(&self) -> &AnySolve {
        &self.solve
    }

    /// The solve by monodromy, if it is one.
    pub fn monodromy(&self) -> Option<&MonodromySolve> {
        match &self.solve {
            AnySolve::Monodromy(solve) => Some(&**solve),
            AnySolve::ZeroDimensional(_)
            | AnySolve::Parameter(_)
            | AnySolve::Polyhedral(_)
            | AnySolve::Regeneration(_)
            | AnySolve::Overdetermined(_)
            | AnySolve::Decomposition(_)
            | AnySolve::Question(_)
            | AnySolve::WithoutPaths(_) => None,
        }
    }

    /// Counts of the loops, in a solve by monodromy.
    pub fn loops(&self) -> Option<&LoopCounts> {
        self.monodromy().map(MonodromySolve::counts)
    }

    /// The last results of all paths by the numbers that people see, where a stage counts its
    /// paths by others, or not all of them.
    pub fn renumbered_results(&self) -> Option<Vec<PathResult>> {
        self.solve.get().renumbered_results()
    }

    /// The stage whose paths the answer counts; stages before it only prepared it.
    pub fn counted_stage(&self) -> StageId {
        self.solve.get().counted_stage()
    }

    /// Paths of a solve whose results need not all be held (see `solutions::streamed`); `None` for any other solve.
    pub fn large(&self) -> Option<&RetriedStage> {
        match &self.solve {
            AnySolve::ZeroDimensional(solve) if self.can_leave_out() => Some(solve.paths()),
            AnySolve::Parameter(solve) if self.can_leave_out() => Some(solve.paths()),
            _ => None,
        }
    }

    /// Paths of a solve whose results need not all be held, to be told which results are held; `None` for any other
    /// solve.
    pub fn large_mut(&mut self) -> Option<&mut RetriedStage> {
        let large = self.can_leave_out();
        match &mut self.solve {
            AnySolve::ZeroDimensional(solve) if large => Some(solve.paths_mut()),
            AnySolve::Parameter(solve) if large => Some(solve.paths_mut()),
            _ => None,
        }
    }

    /// Filters that tell paths that need not be held from others, one for each target; none for a solve whose paths are
    /// all held.
    pub fn filters(&self, system: &System) -> Vec<PathFilter> {
        match &self.solve {
            AnySolve::ZeroDimensional(solve) => solve.filters(system),
            AnySolve::Parameter(solve) => solve.filters(system),
            AnySolve::Polyhedral(_)
            | AnySolve::Regeneration(_)
            | AnySolve::Monodromy(_)
            | AnySolve::Overdetermined(_)
            | AnySolve::Decomposition(_)
            | AnySolve::Question(_)
            | AnySolve::WithoutPaths(_) => Vec::new(),
        }
    }

    /// Whether endpoints are compared with each other alone. Closings take all of them; what is tracked on from
    /// all of them, as from mixed cells, does so too.
    fn can_leave_out(&self) -> bool {
        self.closings.is_empty()
            && match &self.solve {
                AnySolve::ZeroDimensional(solve) => solve.paths().can_leave_out(),
                AnySolve::Parameter(solve) => solve.can_leave_out(),
                AnySolve::Polyhedral(_)
                | AnySolve::Regeneration(_)
                | AnySolve::Monodromy(_)
                | AnySolve::Overdetermined(_)
                | AnySolve::Decomposition(_)
                | AnySolve::Question(_)
                | AnySolve::WithoutPaths(_) => false,
            }
    }

    /// Claim of the solve about missing isolated solutions; `None` if its paths and their verdicts are all that is
    /// known.
    pub fn completeness(&self) -> Option<CompletenessClaim> {
        self.solve.get().completeness()
    }
}

/// Whether loops found all: what a trace test says, or `claim`, what the loops say of themselves. A trace test knows of no
/// solutions that loops do not connect with these: `general_count` is the number of solutions of a general member.
fn judge_loops(
    loops: &LoopCounts,
    claim: Option<&CompletenessClaim>,
    general_count: Option<u64>,
    set: &mut SolutionSet,
) {
    let settled = set.settled();
    let counts = &mut set.counts;
    let (complete, why) = match (&loops.trace_test, claim) {
        (Some(test), _) if !test.complete => {
            let why = "a trace test says that some are missing";
            (Completeness::No, why.to_string())
        }
        _ if general_count.is_some_and(|count| count > loops.solutions) => {
            let why = format!(
                "a general member has {} by an exact count, and loops connect {}: the family has several components",
                counted(general_count.unwrap_or_default(), "solution"),
                loops.solutions
            );
            (Completeness::No, why)
        }
        (_, Some(claim)) if settled => (claim.complete, claim.reason.clone()),
        _ => return,
    };
    (counts.complete, counts.complete_reason) = (complete, Some(why));
}

impl PathAlgorithm for AnyAlgorithm {
    fn next(&mut self) -> Next {
        let solve = self.solve.get_mut();
        match solve.next(&mut self.numbers) {
            Next::Done => {}
            other => return other,
        }
        for closing in &mut self.closings {
            let next = match closing.next() {
                Some(next) => next,
                // A solve without an answer has no endpoints either.
                None => match solve
                    .finite_endpoints()
                    .filter(|_| solve.failure().is_none())
                {
                    Some(endpoints) => closing.open(endpoints, &mut self.numbers),
                    None => Next::Done,
                },
            };
            if next != Next::Done {
                return next;
            }
        }
        Next::Done
    }
    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        match self.closings.iter_mut().find(|closing| closing.is_open()) {
            Some(closing) => closing.absorb(stage, results),
            None => self.solve.get_mut().absorb(stage, results),
        }
    }
    fn failure(&self) -> Option<String> {
        self.solve.get().failure()
    }
    fn progress(&self) -> Progress {
        let solve = self.solve.get();
        let before = solve.progress();
        if solve.failure().is_some() {
            return before; // nothing is looked at
        }
        let closings = self.closings.iter();
        closings.fold(before, |progress, closing| closing.progress(progress))
    }
    fn answer(&self, system: &System) -> Option<Answer> {
        let mut answer = self.solve.get().answer(system)?;
        if let Answer::Isolated(isolated) = &mut answer {
            for closing in &self.closings {
                closing.apply(&mut isolated.sets, system);
            }
            if let Some(loops) = &isolated.loops {
                let claim = self.completeness();
                let is_claimed = loops.counts.stop == Some(Stop::TraceTest);
                let count = || exact_count::of_general_member(system, loops.counts.solutions);
                let is_asked = is_claimed && !self.counting.switched_off;
                let general_count = is_asked.then(count).flatten();
                for set in &mut isolated.sets {
                    judge_loops(&loops.counts, claim.as_ref(), general_count, set);
                }
            }
            match &mut isolated.sets[..] {
                [set] => {
                    let solution_count = self.solve.get().solution_count();
                    self.counting.compare(set, system, solution_count);
                }
                several => {
                    for set in several {
                        set.no_exact_count = Some(SEVERAL_TARGETS.to_string());
                    }
                }
            }
            for set in &mut isolated.sets {
                warn_of_rounded_data(set, self.data_accuracy);
                doubt_overdetermined_part(set, system, self.data_accuracy);
                doubt_coefficient(set, self.data_accuracy);
                write_typed(set, system);
            }
        }
        Some(answer)
    }
}
