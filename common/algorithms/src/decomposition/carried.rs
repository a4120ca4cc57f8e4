//! Carried: components of a general member of a family, on their way to other values of its parameters.
//!
//! Where a family has as many equations as cut out its lowest dimension, these and the slices are a square system,
//! whose isolated solutions at any values of the parameters are limits of those at general values (Sommese, Wampler:
//! The Numerical Solution of Systems of Polynomials, 2005, chapter 7). So the ends of the paths are a witness superset
//! of that dimension; higher ones are found by themselves.

use super::job::{DescribedSystem, Job, StageSystem};
use super::operand::TrackedSet;
use super::options::DecompositionOptions;
use super::problem::{Problem, ProblemError};
use super::superset::Superset;
use cognate_continuation::bend::{SlicedEquations, doubles_of};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_solutions::classification::Verdict;
use cognate_solutions::witness::{
    CarriedComponent, ComponentId, Family, KnownComponents, WitnessSet,
};
use cognate_systems::system::System;
use cognate_systems::transform::{affine_chart, equilibrate};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Ends nearer than this to a witness point, relative to its size, are that point: singular points are known to 5
/// digits.
const SAME: f64 = 1e-5;

/// End of a path from a witness point of the general member.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum End {
    Infinite,
    Lost,
    At(Vec<Complex64>),
}

/// Step of the move of the components.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// Component by component to the slices of the problem, at general values of the parameters.
    #[default]
    Sliding,
    /// All points together to the values that are asked.
    Carrying,
}

/// Component by component, then all together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Carried {
    phase: Phase,
    /// The component that comes next.
    place: usize,
    /// Points on the slices of the problem, and the component that each of them is of.
    points: Vec<Vec<Complex64>>,
    of: Vec<usize>,
    /// Points lost on the way to these slices.
    lost: u64,
    ends: Vec<End>,
    superset: Superset,
}

/// Reason, in words, why the lowest dimension is not found from known components; `None` if it is.
pub(super) fn obstacle(
    problem: &Problem,
    general: &Problem,
    member_components: &KnownComponents,
) -> Option<String> {
    let (n, equations) = (problem.variables(), problem.given.equation_count());
    let lowest = (n - problem.levels) as u32;
    if general.levels != problem.levels || general.given.equation_count() != equations {
        return Some("the equations have another rank at these values of the parameters".into());
    }
    if problem.levels < equations {
        return Some("there are more equations than cut out the lowest dimension".into());
    }
    if *problem.asked.start() > lowest {
        return Some(format!("dimension {lowest} is not asked"));
    }
    let lowest_components = member_components
        .components
        .iter()
        .filter(|c| c.dimension() == lowest);
    let multiple = lowest_components.clone().find(|c| !c.deflation.is_empty());
    if let Some(set) = multiple {
        return Some(format!(
            "component {} of the general member is multiple",
            set.id
        ));
    }
    let doubtful = lowest_components.clone().find(|c| !c.settled());
    doubtful.map(|set| format!("component {} of the general member is not settled", set.id))
}

/// The components of the lowest dimension, at the values of the parameters where they are known, in the units of the
/// problem.
pub(super) fn tracked(
    problem: &Problem,
    system: &System,
    options: &DecompositionOptions,
) -> Result<TrackedSet, ProblemError> {
    let general = general(problem, system, options)?;
    let lowest = (problem.variables() - problem.levels) as u32;
    let lowest_components: Vec<WitnessSet> = options
        .known
        .iter()
        .flat_map(|member_components| &member_components.components)
        .filter(|set| set.dimension() == lowest)
        .cloned()
        .collect();
    let tracked = TrackedSet::new(Arc::new(general), &lowest_components);
    tracked.map_err(|error| ProblemError::Known(error.to_string()))
}

/// The member of the family of which components are known.
pub(super) fn general(
    problem: &Problem,
    system: &System,
    options: &DecompositionOptions,
) -> Result<Problem, ProblemError> {
    let member_components = options.known.as_ref();
    let options = DecompositionOptions {
        parameters: member_components.map_or_else(Vec::new, |member_components| {
            member_components.parameters.clone()
        }),
        known: None,
        dimensions: None,
        ..options.clone()
    };
    Problem::in_units(system, &options, Some(problem.scaling().clone()))
}

/// The family with the slices of its lowest dimension, in the units and the chart of the problem.
fn family(problem: &Problem, system: &System) -> System {
    let seed = problem.seed();
    let system = System {
        scaling: problem.scaling().clone(),
        ..system.clone()
    };
    let chart = affine_chart(&system.in_unknowns(), seed);
    let mut family = System {
        conjugates: Vec::new(),
        symmetry: Vec::new(),
        degenerate: Default::default(),
        scaling: Default::default(),
        ..equilibrate(&chart, seed)
    };
    let e = &mut family.expressions;
    let lowest = problem.variables() - problem.levels;
    for (k, row) in problem.slices(lowest).iter().enumerate() {
        let part = |x: f64| Rational::from_f64(x).expect("coefficients of slices are finite");
        let mut number = |z: &Complex64| e.constant(ComplexRational::new(part(z.re), part(z.im)));
        let numbers: Vec<_> = row.iter().map(&mut number).collect();
        let mut sum = numbers[0];
        for (v, &c) in (0..).zip(&numbers[1..]) {
            let x = e.variable(v);
            let term = e.multiply(c, x);
            sum = e.add(sum, term);
        }
        family.equations.push(sum);
        family.equation_names.push(format!("slice {}", k + 1));
    }
    family
}

impl Carried {
    /// The system of the open stage.
    pub fn system_of(
        &self,
        problem: &Problem,
        system: &System,
        tracked_set: &mut TrackedSet,
        wanted: &StageSystem,
    ) -> Arc<System> {
        match wanted {
            StageSystem::Family => Arc::new(family(problem, system)),
            _ => tracked_set.context().system(wanted),
        }
    }

    /// Describes the open stage in a few words.
    pub fn description(&self) -> &'static str {
        match self.phase {
            Phase::Sliding => "moving the components of a general member of the family",
            Phase::Carrying => "following components to the values of the parameters",
        }
    }

    /// Learns from the stage that is done, and says which comes next.
    pub fn advance(
        &mut self,
        problem: &Problem,
        (system, options): (&System, &DecompositionOptions),
        tracked_set: &mut TrackedSet,
        done: Option<&Job>,
    ) -> Option<Job> {
        match (self.phase.clone(), done) {
            (Phase::Carrying, Some(job)) => {
                self.carried(problem, tracked_set, job);
                return None;
            }
            (Phase::Carrying, None) => return None,
            (Phase::Sliding, Some(job)) => self.slid(problem, tracked_set, job),
            (Phase::Sliding, None) => {}
        }
        while let Some(operand) = tracked_set.operands.get(self.place) {
            if operand.dimension() > 0 {
                let slice = problem.slices(operand.dimension());
                return Some(tracked_set.moved(self.place, slice));
            }
            self.take(operand.set.doubles());
        }
        self.phase = Phase::Carrying;
        self.superset.dimension = problem.variables() - problem.levels;
        if self.points.is_empty() {
            return None;
        }
        let start = options
            .known
            .as_ref()
            .map(|member_components| member_components.parameters.clone());
        let homotopy = HomotopyKind::Parameter {
            start: start.unwrap_or_default(),
            targets: vec![options.parameters.clone()],
        };
        let system = DescribedSystem {
            description: StageSystem::Family,
            system: Arc::new(family(problem, system)),
        };
        Some(Job::track(system, homotopy, &self.points, &problem.tracking).ends_only())
    }

    /// Takes the points of the next component.
    fn take(&mut self, points: Vec<Vec<Complex64>>) {
        self.of
            .extend(std::iter::repeat_n(self.place, points.len()));
        self.points.extend(points);
        self.place += 1;
    }

    /// A component came to the slices of the problem.
    fn slid(&mut self, problem: &Problem, tracked_set: &mut TrackedSet, job: &Job) {
        let slice = problem.slices(tracked_set.operands[self.place].dimension());
        let (points, lost) = tracked_set.arrived(self.place, &slice, job);
        self.lost += lost;
        self.take(
            points
                .iter()
                .map(|point| doubles_of(&point.point))
                .collect(),
        );
    }

    /// All points came to the values of the parameters.
    fn carried(&mut self, problem: &Problem, tracked_set: &TrackedSet, job: &Job) {
        let dimension = self.superset.dimension;
        let equations = SlicedEquations::new(&problem.given, problem.slices(dimension));
        let end = |verdict: Verdict, values: Vec<Complex64>| match verdict {
            Verdict::AtInfinity => End::Infinite,
            Verdict::Failed | Verdict::WithinDataAccuracy | Verdict::ExcessSolution => End::Lost,
            _ => End::At(values),
        };
        let ends = job.ends().into_iter();
        self.ends = ends.map(|(_, d, values)| end(d.verdict, values)).collect();
        self.superset.sort(problem, &equations, job);
        self.superset.failed += self.lost;
        debug_assert_eq!(tracked_set.operands.len(), self.place);
    }

    /// Witness superset of the lowest dimension.
    pub fn superset(&self) -> Superset {
        self.superset.clone()
    }

    /// Components that the points of each known component have become.
    pub fn family(
        &self,
        problem: &Problem,
        member_ids: &[ComponentId],
        witness_sets: &[WitnessSet],
    ) -> Family {
        let dimension = self.superset.dimension as u32;
        let here: Vec<&WitnessSet> = witness_sets
            .iter()
            .filter(|c| c.dimension() == dimension)
            .collect();
        let mut components: Vec<CarriedComponent> = member_ids
            .iter()
            .map(|&id| CarriedComponent {
                id,
                ..CarriedComponent::default()
            })
            .collect();
        for (end, &place) in self.ends.iter().zip(&self.of) {
            let from = &mut components[place];
            let point = match end {
                End::Infinite => {
                    from.at_infinity += 1;
                    continue;
                }
                End::Lost => {
                    from.failed += 1;
                    continue;
                }
                End::At(values) => problem.to_variables(values),
            };
            match nearest(&here, &point) {
                None => from.elsewhere += 1,
                Some(id) => match from
                    .becomes
                    .iter_mut()
                    .find(|(component_id, _)| *component_id == id)
                {
                    Some((_, points)) => *points += 1,
                    None => from.becomes.push((id, 1)),
                },
            }
        }
        for component in &mut components {
            component.becomes.sort_unstable();
        }
        Family {
            dimension: Some(dimension),
            components,
            reason: String::new(),
        }
    }
}

/// The component of which a witness point is at this place.
fn nearest(sets: &[&WitnessSet], point: &[Complex64]) -> Option<ComponentId> {
    let distance = |witness_point: &[Complex64]| {
        let (mut apart, mut size) = (0.0, 1.0f64);
        for (x, y) in witness_point.iter().zip(point) {
            apart += (x - y).norm_sqr();
            size += x.norm_sqr();
        }
        (apart / size).sqrt()
    };
    let each = sets.iter().flat_map(|set| {
        let points = set.points.iter();
        points.map(|witness_point| (distance(witness_point), set.id))
    });
    let least = each.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (least.0 < SAME).then_some(least.1)
}
