//! All regular isolated solutions of one system, equation by equation (regeneration).
//!
//! Level k holds the regular solutions of the first k equations on random
//! slices; each level is two stages: slide the slice of the level to as many
//! forms as the next equation has degrees, then deform the product of the forms
//! into the equation. What goes to infinity or is singular on the way is no
//! beginning of a regular solution and is left behind; what fails is named as
//! failed in the end. (Hauenstein, Sommese, Wampler 2011.)

use crate::answer::Answer;
use crate::finite_endpoints::FiniteEndpoints;
use crate::opening::Opening;
use crate::progress::{Progress, StageProgress, VerdictCounts};
use crate::retried_stage::RetriedStage;
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::{PathIndex, PathResult};
use cognate_continuation::start_points::StoredPoints;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_solutions::classification::{Tolerances, Verdict};
use cognate_solutions::solution_set::History;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Data that do not change from level to level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Levels {
    /// The equations in the order in which they are taken.
    pub order: Vec<u32>,
    /// Degrees of the equations, in the same order.
    pub degrees: Vec<u32>,
    /// Values of the system's parameters.
    pub parameters: Vec<Complex64>,
    /// Settings of the path tracker.
    pub settings: Settings,
    /// Seed of the slices and of everything else.
    pub seed: u64,
    /// Whether this method was asked for: where it was not, an answer that may miss solutions is not settled.
    pub asked_for: bool,
}

/// Equation by equation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegenerationSolve {
    levels: Levels,
    level: u32,
    stage: RetriedStage,
    /// The points that the open level began with, one after the other.
    points: Vec<Complex64>,
    variables: usize,
    /// Paths that failed on the levels before.
    lost: Vec<PathResult>,
    /// The stages of the levels before.
    behind: Vec<StageProgress>,
    /// Counts of the levels before: paths tracked again, crossings found, crossings resolved.
    repeated: [u64; 3],
    /// Singular points of the first equations that no level went on from: solutions that lie there
    /// may be missing.
    left_behind: u64,
    /// No level is to be opened any more.
    last: bool,
}

impl RegenerationSolve {
    /// The solve that begins with this point on all slices. `system` is square up to
    /// combinations, in one affine group whose variables stand in order.
    ///
    /// # Panics
    /// When there is no level.
    pub fn new(
        levels: Levels,
        point: Vec<Complex64>,
        system: &System,
        tolerances: Tolerances,
    ) -> Self {
        assert!(
            !levels.order.is_empty() && levels.order.len() == levels.degrees.len(),
            "a level for each equation"
        );
        let variables = point.len();
        let first = open(&levels, 0, slides(&levels, 0), &point, variables);
        let targets = targets(&first.stage);
        Self {
            stage: RetriedStage::new(first, system, tolerances, targets),
            last: levels.order.len() == 1 && !slides(&levels, 0),
            levels,
            level: 0,
            points: point,
            variables,
            lost: Vec::new(),
            behind: Vec::new(),
            repeated: [0; 3],
            left_behind: 0,
        }
    }

    /// Replaces the limit of repetitions of a path.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.stage = self.stage.with_max_retries(max_retries);
        self
    }

    /// Puts the next stage in the place of one of which all is known; false after the last.
    fn advance(&mut self) -> bool {
        if self.last {
            return false;
        }
        let slid = matches!(self.stage.first().homotopy, HomotopyKind::MoveSlice { .. });
        let mut points = match slid {
            // The first form is the slice: there nothing moves.
            true => self.points.clone(),
            false => Vec::new(),
        };
        let shape = self.stage.shape();
        for (result, decision) in self.stage.results().iter().zip(self.stage.decisions()) {
            let regular = decision.verdict == Verdict::Finite;
            let point = shape.to_variables(result.endpoint.to_double());
            if regular && point.iter().all(|z| z.re.is_finite() && z.im.is_finite()) {
                points.extend(point);
            } else if slid || decision.verdict == Verdict::Failed {
                // From one generic slice to another all solutions are regular.
                self.lost.push(result.clone());
            } else if decision.verdict != Verdict::AtInfinity && !self.reached_the_system() {
                // The ends of the last level are all in the answer.
                self.left_behind += 1;
                if !self.levels.asked_for {
                    self.lost.push(result.clone());
                }
            }
        }
        let number = self.levels.order.len() as u32;
        if !slid {
            self.level += 1;
            self.points.clone_from(&points);
        }
        if points.is_empty() || self.level == number {
            self.last = true;
            return false;
        }
        let slide = !slid && slides(&self.levels, self.level);
        self.behind.extend(self.stage.progress("").stages);
        for target in 0..targets(self.stage.first()) as usize {
            let history = self.stage.history(target, true);
            self.repeated[0] += history.retracked;
            self.repeated[1] += history.crossings_found;
            self.repeated[2] += history.crossings_resolved;
        }
        let first = open(&self.levels, self.level, slide, &points, self.variables);
        self.stage = self.stage.followed_by(first, 0);
        self.last = self.level + 1 == number && !slide;
        true
    }

    /// The last results of the paths that the answer counts: those of the last level, and after
    /// them those that were lost before it.
    pub fn results(&self) -> Vec<PathResult> {
        let mut results = match self.last && self.reached_the_system() {
            true => self.stage.results().to_vec(),
            false => Vec::new(),
        };
        for lost in &self.lost {
            let failure = match lost.outcome {
                PathOutcome::Failed(failure) => failure,
                PathOutcome::Regular
                | PathOutcome::Singular
                | PathOutcome::Diverging
                | PathOutcome::PutAside => Failure::EndgameUnsettled,
            };
            results.push(PathResult {
                origin: PathIndex(results.len() as u64),
                outcome: PathOutcome::Failed(failure),
                t: Complex64::new(1.0, 0.0),
                ..lost.clone()
            });
        }
        results
    }

    /// Whether the present stage ends at the system that is asked.
    fn reached_the_system(&self) -> bool {
        self.stage.first().homotopy.ends_at_the_system()
    }

    /// Reason why solutions may be missing.
    fn may_miss(&self) -> Option<String> {
        let ends = match self.left_behind {
            0 => return None,
            1 => "1 path to a singular point of the first equations was".to_string(),
            n => format!("{n} paths to singular points of the first equations were"),
        };
        Some(format!(
            "{ends} not gone on from: solutions there, which are singular or lie on a set of \
             solutions of these equations, may be missing"
        ))
    }

    fn description(&self) -> String {
        format!("equation {} of {}", self.level + 1, self.levels.order.len())
    }
}

/// Whether the level has more forms than the slice.
fn slides(levels: &Levels, level: u32) -> bool {
    levels.degrees[level as usize] > 1
}

fn targets(stage: &Stage) -> u64 {
    stage.homotopy.targets()
}

/// Homotopy of a level of equations in this order: its slice moves to so many other forms, or, without a number, the
/// product of the forms becomes its equation.
pub(crate) fn level_homotopy(
    parameters: Vec<Complex64>,
    order: Vec<u32>,
    level: u32,
    other_forms: Option<u32>,
) -> HomotopyKind {
    match other_forms {
        Some(forms) => HomotopyKind::MoveSlice {
            parameters,
            order,
            level,
            forms,
        },
        None => HomotopyKind::ProductToEquation {
            parameters,
            order,
            level,
        },
    }
}

/// A stage of a level, with the points where it begins.
fn open(
    levels: &Levels,
    level: u32,
    slide: bool,
    points: &[Complex64],
    variables: usize,
) -> Opening {
    let (parameters, order) = (levels.parameters.clone(), levels.order.clone());
    let other_forms = slide.then(|| levels.degrees[level as usize] - 1);
    let homotopy = level_homotopy(parameters, order, level, other_forms);
    let stored = Arc::new(StoredPoints {
        dimension: variables,
        coordinates: points.to_vec(),
    });
    let stage = Stage::new(
        Work::Track,
        homotopy,
        stored.as_start(),
        levels.settings.clone(),
        levels.seed,
    );
    Opening {
        stage,
        system: None,
        objects: vec![stored],
    }
}

impl Solve for RegenerationSolve {
    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        loop {
            match self.stage.next_stage(numbers) {
                Next::Done if self.advance() => {}
                other => return other,
            }
        }
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        self.stage.absorb(stage, results);
    }

    fn progress(&self) -> Progress {
        let present = self.stage.progress(&self.description());
        let mut stages = self.behind.clone();
        stages.extend(present.stages);
        let at_the_system = self.reached_the_system();
        let mut paths = match at_the_system {
            true => present.paths,
            false => VerdictCounts::default(),
        };
        paths.failed += self.lost.len() as u64;
        Progress {
            description: present.description,
            stages,
            paths,
            done: present.done && self.last,
        }
    }

    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        let mut finite_endpoints = self.stage.finite_endpoints();
        if !self.reached_the_system() {
            finite_endpoints.regular.clear();
            finite_endpoints.singular.clear();
        }
        finite_endpoints.homotopy = HomotopyKind::StraightLine {
            parameters: self.levels.parameters.clone(),
        };
        Some(finite_endpoints)
    }

    fn answer(&self, system: &System) -> Option<Answer> {
        let results = self.results();
        let mut history = History {
            retracked: self.repeated[0],
            crossings_found: self.repeated[1],
            crossings_resolved: self.repeated[2],
            complete_start: self.left_behind == 0,
            may_miss: self.may_miss(),
            images: 0,
            least_on_sets: 0,
            is_part: false,
        };
        for target in 0..targets(self.stage.first()) as usize {
            let present = self.stage.history(target, false);
            history.retracked += present.retracked;
            history.crossings_found += present.crossings_found;
            history.crossings_resolved += present.crossings_resolved;
        }
        let parameters = &self.levels.parameters;
        let mut set = self.stage.set_of(system, parameters, &results, &history);
        set.warnings.extend(self.may_miss());
        Some(Answer::from(vec![set]))
    }

    fn renumbered_results(&self) -> Option<Vec<PathResult>> {
        Some(self.results())
    }
}
