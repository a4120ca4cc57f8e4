//! Proofs of a decomposition that is found: witness points in boxes, and which unions of them are no components.
//!
//! For all components of one dimension with the same equations two stages follow one another: derivatives of the
//! witness points along a moving slice, and Krawczyk's test of the equations that points and derivatives solve together
//! ([`cognate_systems::transform::bent`]). Its boxes enclose both. A point that is a component has no derivatives:
//! its box is that of the point alone.

use super::deflated::ProblemContext;
use super::job::{Job, StageSystem};
use super::problem::Problem;
use super::unions::{Enclosed, exclude};
use cognate_continuation::bend::doubles_of;
use cognate_continuation::certification::Certificate;
use cognate_continuation::item_result::ItemResult;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::certificates::{Distinctness, Groups, judge};
use cognate_solutions::completeness::Completeness;
use cognate_solutions::witness::{Decomposition, Doubt, Irreducible, Proof};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Components with the same equations: dimension, highest first, and rank of the Jacobian before each deflation.
type Kind = (Reverse<u32>, Vec<u32>);

/// A witness point: the place of its component, and its own place there.
type Place = (usize, usize);

/// Facts that are proved so far, one kind of component after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Proving {
    found: Decomposition,
    /// Kinds of components that are done.
    done: usize,
    asking: Asking,
    /// Witness points and derivatives in their boxes.
    proved: Vec<(Place, Certificate)>,
}

/// Question of the open stage about points of the next kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
enum Asking {
    /// No stage is open.
    #[default]
    Nothing,
    /// Derivatives of these points.
    Derivatives(Vec<Place>),
    /// Boxes in which these points are proved, with their derivatives where they have some.
    Boxes(Vec<Place>),
}

impl Proving {
    pub fn new(decomposition: Decomposition) -> Self {
        Self {
            found: decomposition,
            done: 0,
            asking: Asking::Nothing,
            proved: Vec::new(),
        }
    }

    /// Components by kind.
    fn kinds(&self) -> BTreeMap<Kind, Vec<usize>> {
        let mut kinds: BTreeMap<Kind, Vec<usize>> = BTreeMap::new();
        for (place, set) in self.found.components.iter().enumerate() {
            let kind = (Reverse(set.dimension()), set.deflation.clone());
            kinds.entry(kind).or_default().push(place);
        }
        kinds
    }

    /// Learns from the stage that is done, and says which comes next.
    pub fn advance(&mut self, context: &mut ProblemContext<'_>, done: Option<&Job>) -> Option<Job> {
        let problem = context.problem;
        let kinds = self.kinds();
        match (std::mem::take(&mut self.asking), done) {
            (Asking::Derivatives(places), Some(job)) => {
                let (places, points) = with_derivatives(places, job);
                let ((Reverse(dimension), ranks), _) = kinds.into_iter().nth(self.done)?;
                let dimension = dimension as usize;
                let [slices, moved] = moving_slices(problem, dimension);
                let velocity = moved.iter().zip(&slices).map(|(to, from)| to - from);
                let parameters = slices.iter().copied().chain(velocity).collect();
                let system = StageSystem::Bent { ranks, dimension };
                self.asking = Asking::Boxes(places);
                let fibre = (parameters, points);
                return Some(Job::certify(system, &[fibre], &problem.tracking));
            }
            (Asking::Boxes(places), Some(job)) => {
                let pairs = places.into_iter().zip(job.answers());
                let proved =
                    pairs.filter_map(|(place, result)| Some((place, certificate(result)?.clone())));
                self.proved.extend(proved);
                self.done += 1;
            }
            _ => {}
        }
        for ((Reverse(dimension), ranks), members) in kinds.into_iter().skip(self.done) {
            let dimension = dimension as usize;
            let (places, points) = self.refined(context, dimension, &ranks, members);
            if points.is_empty() {
                self.done += 1;
                continue;
            }
            let tracked = StageSystem::Tracked { ranks, dimension };
            let ends = moving_slices(problem, dimension);
            if dimension > 0 {
                self.asking = Asking::Derivatives(places);
                return Some(Job::bend(tracked, ends, &points, &problem.tracking));
            }
            self.asking = Asking::Boxes(places);
            let [slices, _] = ends;
            return Some(Job::certify(
                tracked,
                &[(slices, points)],
                &problem.tracking,
            ));
        }
        None
    }

    /// The witness points of these components that can be refined, and their places.
    fn refined(
        &self,
        context: &mut ProblemContext<'_>,
        dimension: usize,
        ranks: &[u32],
        members: Vec<usize>,
    ) -> (Vec<Place>, Vec<Vec<Complex64>>) {
        let problem = context.problem;
        let slices = problem.slices(dimension);
        let (mut places, mut points) = (Vec::new(), Vec::new());
        for component in members {
            let witness_points = self.found.components[component].points.iter();
            let witness_points: Vec<_> = witness_points.map(|p| problem.to_unknowns(p)).collect();
            let on = (slices.as_slice(), ranks);
            let refined = context.deflations.points_on(problem, on, &witness_points);
            for (place, point) in refined.into_iter().enumerate() {
                if let Some(point) = point {
                    places.push((component, place));
                    points.push(doubles_of(&point.point));
                }
            }
        }
        (places, points)
    }

    /// The decomposition with what is proved of it. What was asked to be proved and is not is in doubt.
    pub fn take(&mut self, problem: &Problem) -> Decomposition {
        let variable_count = problem.variables();
        let proved = std::mem::take(&mut self.proved);
        let distinct = self.distinct(&proved, variable_count, problem.seed());
        let mut of_component: BTreeMap<usize, Vec<(&Certificate, bool)>> = BTreeMap::new();
        for (((component, _), certificate), distinct) in proved.iter().zip(distinct) {
            let certificates = of_component.entry(*component).or_default();
            certificates.push((certificate, distinct));
        }
        for (place, set) in self.found.components.iter_mut().enumerate() {
            let codimension = variable_count - set.dimension() as usize;
            let certificates = of_component.remove(&place).unwrap_or_default();
            let mut proof = Proof {
                points: certificates.len() as u64,
                distinct: certificates
                    .iter()
                    .filter(|(_, distinct)| *distinct)
                    .count() as u64,
                all_equations: set.deflation.is_empty()
                    && problem.given.equation_count() == codimension,
                ..Proof::default()
            };
            let mut doubts = Vec::new();
            if proof.points < set.degree {
                let points = set.degree - proof.points;
                doubts.push(Doubt::NotProved { points });
            } else if set.dimension() == 0 {
                (proof.least_degree, proof.irreducible) = (1, true);
            } else {
                let derivatives = certificates
                    .iter()
                    .map(|(c, _)| second_derivative(c, variable_count));
                let derivatives: Vec<Enclosed> = derivatives.collect();
                let exclusion = exclude(&derivatives, problem.seed());
                proof.unions = exclusion.unions;
                proof.least_degree = exclusion.least_degree;
                proof.irreducible = exclusion.all && exclusion.whole_may_be_closed;
                let refuted = !exclusion.whole_may_be_closed || exclusion.closed_part;
                if refuted && set.irreducible == Irreducible::Yes {
                    set.irreducible = Irreducible::Unsettled;
                    doubts.push(match exclusion.whole_may_be_closed {
                        true => Doubt::Open { classes: 1 },
                        false => Doubt::PointsMissing,
                    });
                }
            }
            if proof.distinct < proof.points {
                let points = proof.points - proof.distinct;
                doubts.push(Doubt::NotDistinct { points });
            }
            set.evidence.doubts.extend(doubts);
            set.evidence.proof = Some(proof);
        }
        for dimension in &mut self.found.dimensions {
            let witness_sets = self.found.components.iter();
            let mut witness_sets = witness_sets.filter(|set| set.dimension() == dimension.number);
            let doubted =
                witness_sets.any(|set| set.evidence.doubts.contains(&Doubt::PointsMissing));
            if doubted && dimension.complete == Completeness::Yes {
                dimension.complete = Completeness::NotKnown;
            }
        }
        self.found.clone()
    }

    /// Whether each box meets no other of its dimension.
    fn distinct(
        &self,
        proved: &[(Place, Certificate)],
        variable_count: usize,
        seed: u64,
    ) -> Vec<bool> {
        let mut distinct = vec![false; proved.len()];
        let mut by_dimension: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (k, ((component, _), _)) in proved.iter().enumerate() {
            let dimension = self.found.components[*component].dimension();
            by_dimension.entry(dimension).or_default().push(k);
        }
        let groups = Groups {
            homogeneous: Vec::new(),
            affine: (0..variable_count).collect(),
        };
        for members in by_dimension.into_values() {
            let boxes: Vec<Certificate> = members
                .iter()
                .map(|&k| of_point(&proved[k].1, variable_count))
                .collect();
            let verdicts = judge(&boxes.iter().collect::<Vec<_>>(), &groups, seed);
            for (k, verdict) in members.into_iter().zip(verdicts) {
                distinct[k] = verdict == Distinctness::Proved;
            }
        }
        distinct
    }

    /// Describes how many of the kinds of components are done.
    pub fn description(&self) -> String {
        let (done, kind_count) = (self.done, self.kinds().len());
        format!("proving witness points: {done} of {kind_count} kinds of components")
    }
}

/// The points with their derivatives and their places, those that have none left out.
fn with_derivatives(places: Vec<Place>, job: &Job) -> (Vec<Place>, Vec<Vec<Complex64>>) {
    let pairs = places.into_iter().zip(job.answers());
    let with_derivatives = pairs.filter_map(|(place, result)| {
        let ItemResult::Bend(result) = result else {
            return None;
        };
        let bend = result.fact()?;
        let derivatives = [&bend.velocity, &bend.acceleration].map(|v| doubles_of(v));
        Some((place, [&result.point[..], &derivatives.concat()].concat()))
    });
    with_derivatives.unzip()
}

/// Coefficients of the slices of a dimension, and those to which they move.
pub(super) fn moving_slices(problem: &Problem, dimension: usize) -> [Vec<Complex64>; 2] {
    let mut random = RandomStream::new(problem.seed(), Purpose::Detour, dimension as u64);
    let slices = problem.slices(dimension);
    let start = slices.concat();
    let mut moved = slices;
    for row in &mut moved {
        row[0] += random.unit();
    }
    [start, moved.concat()]
}

pub(crate) fn certificate(result: &ItemResult) -> Option<&Certificate> {
    match result {
        ItemResult::Certify(result) => result.fact()?.certificate(),
        _ => None,
    }
}

/// The box of the point alone, in the first coordinates.
fn of_point(certificate: &Certificate, variable_count: usize) -> Certificate {
    Certificate {
        centre: certificate.centre[..variable_count].to_vec(),
        radius: certificate.radius[..variable_count].to_vec(),
        error: certificate.error[..variable_count].to_vec(),
        ..*certificate
    }
}

/// The box of the second derivative of the first coordinates.
fn second_derivative(certificate: &Certificate, variable_count: usize) -> Enclosed {
    let unknowns = certificate.dimension() / 3;
    let enclosure = certificate.lies_in::<f64>(());
    enclosure[2 * unknowns..2 * unknowns + variable_count].to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decomposition::{DecompositionOptions, DecompositionSolve, Step, run_locally};
    use cognate_systems::formats;
    use cognate_systems::system::System;
    use std::collections::BTreeSet;

    fn system(text: &str) -> System {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        formats::read("test", text.as_bytes()).unwrap().system
    }

    fn proved(text: &str) -> Decomposition {
        let options = DecompositionOptions {
            certify: true,
            ..DecompositionOptions::default()
        };
        let solve = DecompositionSolve::new(&system(text), &options).unwrap();
        run_locally(solve, 8).unwrap()
    }

    #[test]
    fn every_kind_of_component_is_proved() {
        // A surface, a double curve, lines, and points of multiplicities 1 to 3.
        let decomposition = proved(
            "variable_group x, y, z; function f, g, h; \
             f = (x^2 + y^2 + z^2 - 4)*(y - x^2)^2*(x - 1)*(x - 3); \
             g = (x^2 + y^2 + z^2 - 4)*(z - x*y)*(y - 1)*(y - 5*x); \
             h = (x^2 + y^2 + z^2 - 4)*(z - x*y)*(z^2 - 7)*(z + x - 9);",
        );
        assert!(decomposition.settled());
        let mut kinds = BTreeSet::new();
        for set in &decomposition.components {
            let proof = set.evidence.proof.unwrap();
            assert_eq!((proof.points, proof.distinct), (set.degree, set.degree));
            assert!(proof.irreducible && proof.least_degree == set.degree);
            let reduced = set.deflation.is_empty();
            assert_eq!(proof.all_equations, set.dimension() == 0 && reduced);
            kinds.insert((set.dimension(), reduced));
        }
        let expected = [(0, false), (0, true), (1, false), (1, true), (2, true)];
        assert_eq!(kinds.into_iter().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn a_wrong_answer_is_not_proved() {
        // Two circles and a parabola.
        let text = "variable_group x, y; function f; \
                    f = (x^2 + y^2 - 4)*(x^2 + 3*y^2 - 5)*(y - x^2);";
        let right = proved(text);
        let spoilt_decomposition = |spoil: &dyn Fn(&mut Decomposition)| {
            let mut decomposition = right.clone();
            decomposition
                .components
                .iter_mut()
                .for_each(|set| set.evidence.proof = None);
            spoil(&mut decomposition);
            let options = DecompositionOptions::default();
            let mut solve = DecompositionSolve::new(&system(text), &options).unwrap();
            solve.state.step = Step::Prove(Box::new(Proving::new(decomposition)));
            run_locally(solve, 8).unwrap()
        };
        assert_eq!(spoilt_decomposition(&|_| {}), right);
        let proof = |decomposition: &Decomposition, k: usize| {
            decomposition.components[k].evidence.proof.unwrap()
        };
        // Points of two components are exchanged.
        let swapped = spoilt_decomposition(&|decomposition| {
            let point = decomposition.components[0].points[1].clone();
            let other = std::mem::replace(&mut decomposition.components[1].points[0], point);
            decomposition.components[0].points[1] = other;
        });
        assert!(!swapped.settled());
        for k in [0, 1] {
            assert!(!proof(&swapped, k).irreducible);
            let doubts = &swapped.components[k].evidence.doubts;
            assert_eq!(*doubts, [Doubt::PointsMissing]);
        }
        assert_eq!(swapped.components[2], right.components[2]);
        // Two components are taken for one.
        let joined = spoilt_decomposition(&|decomposition| {
            let second = decomposition.components.remove(1);
            decomposition.components[0].points.extend(second.points);
            decomposition.components[0].degree = 4;
        });
        assert_eq!(proof(&joined, 0).least_degree, 2);
        assert!(!proof(&joined, 0).irreducible && !joined.settled());
        // A point is there twice, in two components.
        let twice = spoilt_decomposition(&|decomposition| {
            let point = decomposition.components[0].points[1].clone();
            decomposition.components[1].points.push(point);
            decomposition.components[1].degree = 3;
        });
        let doubts = &twice.components[1].evidence.doubts;
        assert!(
            doubts.contains(&Doubt::NotDistinct { points: 1 }),
            "{doubts:?}"
        );
        // A point is none.
        let moved =
            spoilt_decomposition(&|decomposition| decomposition.components[2].points[0][1] += 0.01);
        let doubts = &moved.components[2].evidence.doubts;
        assert_eq!(*doubts, [Doubt::NotProved { points: 1 }]);
        assert_eq!(proof(&moved, 2).points, 1);
    }
}
