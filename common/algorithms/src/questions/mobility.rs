//! Mobility: in how many directions a point can be moved on the solutions, to the first order and to higher ones.
//!
//! The dual space of the equations at a point counts the motions of each order; it stops growing exactly where the
//! point is isolated (Wampler, Hauenstein, Sommese: Mechanism mobility and a local dimension test, Mech. Mach. Theory
//! 46, 2011). Where components are known, the largest dimension of a component through the point is the local
//! dimension.

use super::context::Context;
use super::error::{QuestionError, check_number};
use super::member::Member;
use super::procedure::{GivenSystem, Procedure};
use crate::decomposition::job::{Job, StageSystem};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::local_dimension::Question;
use cognate_continuation::local_dimension::candidates::{Candidate, to_stored};
use cognate_continuation::path_result::LocalDimension;
use cognate_solutions::classification::{Isolation, isolation_by};
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::Mobility as Found;
use cognate_solutions::witness::question::GivenPoint;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// Highest order of functionals at a point.
const MOST_DEPTH: u64 = 20;

/// Mobility of points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Mobility {
    points: Vec<GivenPoint>,
    depth: u32,
    step: Step,
    member: Member,
}

/// Step of the question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Step {
    /// Nothing has been asked.
    Begin,
    /// Dual spaces of the points are asked.
    DualSpaces,
    /// Components on which the points lie are asked; for each point its mobility by the dual space, and whether it is
    /// isolated.
    Components(Vec<(Found, bool)>),
}

impl Procedure for Mobility {
    fn advance(&mut self, context: &mut Context<'_>, done: Option<Job>) -> Option<Job> {
        match (&self.step, done) {
            (Step::Begin, _) => {
                self.step = Step::DualSpaces;
                Some(self.ask(context))
            }
            (Step::DualSpaces, done) => {
                let answers = done.as_ref().map_or(&[][..], Job::answers);
                let each = answers.iter().enumerate();
                let findings = each.map(|(index, answer)| self.learn(context, index, answer));
                self.step = Step::Components(findings.collect());
                self.member.advance(context, None)
            }
            (Step::Components(_), done) => self.member.advance(context, done),
        }
    }

    fn answer(&mut self, _: &GivenSystem<'_>) -> Answer {
        let memberships = self.member.take();
        let Step::Components(findings) = std::mem::replace(&mut self.step, Step::Begin) else {
            unreachable!("the components come last")
        };
        let pairs = findings.into_iter().zip(memberships);
        let findings = pairs
            .map(|((mut finding, isolated), member)| {
                finding.on = member.on;
                if member.solves == Some(false) {
                    finding.local_dimension = None;
                    finding.reason = "the point does not solve the equations".into();
                    return finding;
                }
                let largest = finding.on.iter().map(|id| id.dimension).max();
                if let (Some(largest), true) = (largest, member.unsettled.is_empty()) {
                    if isolated && largest > 0 {
                        finding.local_dimension = None;
                        finding.reason = format!(
                            "its dual space stops growing, and it lies on a component of dimension {largest}"
                        );
                    } else {
                        finding.local_dimension = Some(largest);
                        finding.reason = "the largest component through the point".into();
                    }
                }
                finding
            })
            .collect();
        Answer::Mobility(findings)
    }

    fn description(&self) -> &'static str {
        "asking points for their dual spaces"
    }
}

impl Mobility {
    pub fn new(system: &System, points: &[GivenPoint], depth: u32) -> Result<Self, QuestionError> {
        let member = Member::new(system, points)?;
        check_number("depth", depth.into(), MOST_DEPTH)?;
        Ok(Self {
            points: points.to_vec(),
            depth,
            step: Step::Begin,
            member,
        })
    }

    fn ask(&self, context: &Context<'_>) -> Job {
        let candidate = |point: &GivenPoint| Candidate {
            values: context.problem.to_unknowns(&point.values),
            target: 0,
            question: Question {
                accuracy: point.accuracy.max(f64::EPSILON),
                bound: u64::MAX,
                depth: self.depth,
            },
        };
        let candidates: Vec<Candidate> = self.points.iter().map(candidate).collect();
        let system = StageSystem::Sliced { dimension: 0 };
        let tracking = &context.problem.tracking;
        Job::isolate(system, Vec::new(), to_stored(&candidates), tracking)
    }

    /// Mobility by the dual space, and whether the point is isolated.
    fn learn(&self, context: &Context<'_>, index: usize, answer: &ItemResult) -> (Found, bool) {
        let fact: Option<&LocalDimension> = match answer {
            ItemResult::LocalDimension(result) => result.fact(),
            _ => None,
        };
        let mut finding = Found {
            index: index as u64,
            infinitesimal: None,
            dimensions_by_order: Vec::new(),
            local_dimension: None,
            reason: "nothing is known of the point".into(),
            on: Vec::new(),
        };
        let Some(fact) = fact else {
            return (finding, false);
        };
        let dimensions = &fact.dual_dimensions;
        finding.dimensions_by_order.clone_from(dimensions);
        if let [first, second, ..] = dimensions.as_slice() {
            finding.infinitesimal = Some(second - first);
        }
        let tolerances = &context.problem.tracking.tolerances;
        let isolated = match isolation_by(fact, tolerances) {
            Isolation::Isolated { multiplicity } => {
                finding.local_dimension = Some(0);
                finding.reason = format!(
                    "isolated, of multiplicity {multiplicity}: its dual space stops growing"
                );
                true
            }
            Isolation::PositiveDimensional => {
                finding.reason =
                    "solutions were met beside it, and its dual space does not stop growing: not isolated".into();
                false
            }
            Isolation::Undecided => {
                finding.reason = format!("dual spaces up to order {} do not tell", self.depth);
                false
            }
        };
        (finding, isolated)
    }
}
