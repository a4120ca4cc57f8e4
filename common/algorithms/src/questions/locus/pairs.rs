//! Pairs: what two components have in common, from the pairs of their witness points.

use super::super::context::Context;
use super::{Locus, Phase, apart, exact_end};
use crate::decomposition::deflated::PureSet;
use crate::decomposition::job::{DescribedSystem, Job, StageSystem};
use crate::decomposition::operand::Operand;
use crate::decomposition::superset::SingularEnd;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::Verdict;
use cognate_systems::system::System;
use cognate_systems::transform::{product, slice};
use num_complex::Complex64;
use std::sync::Arc;

/// The two halves of a pair are one point within `EQUAL`, relative to their size, or within `EQUAL_FACTOR` times the
/// error.
const EQUAL: f64 = 1e-7;
const EQUAL_FACTOR: f64 = 100.0;
/// The two halves of a pair are two points beyond this, relative to their size.
const OTHER: f64 = 1e-3;
/// Numbers of random streams, apart from those of other questions.
const DIAGONAL: u64 = 1 << 53;

impl Locus {
    /// The first stage of the next pair, or what is known of it without any.
    pub(super) fn pair(&mut self, context: &mut Context<'_>) -> Option<Job> {
        let Some([first, second]) = operands(context, self.place) else {
            self.next();
            return None;
        };
        let dimensions = [first.dimension(), second.dimension()];
        if dimensions == [0, 0] {
            let variable_count = context.whole.variables();
            let [a, b] = [first, second].map(|o| o.set.doubles()[0][..variable_count].to_vec());
            let superset = self.superset(0);
            match apart(&a, &b) {
                distance if distance <= EQUAL => superset.singular.push(exact_end(a)),
                distance if distance <= OTHER => superset.unclear += 1,
                _ => {}
            }
            self.next_pair();
            return None;
        }
        let highest = dimensions[0].min(dimensions[1]);
        self.phase = Phase::Pair { dimension: highest };
        Some(self.pair_stage(context, highest))
    }

    fn next_pair(&mut self) {
        self.place[1] += 1;
        self.phase = Phase::Begin;
    }

    /// The stage whose ends are the superset of this dimension.
    fn pair_stage(&mut self, context: &mut Context<'_>, dimension: usize) -> Job {
        let places = self.place;
        let system = self.pair_system(context, places);
        let [first, second] = operands(context, places).expect("a pair that was begun is there");
        let n = context.whole.variables();
        let zeros = vec![Complex64::default(); n];
        let index = DIAGONAL | ((places[0] as u64) << 26) | ((places[1] as u64) << 6);
        let index = index | dimension as u64;
        let mut random = RandomStream::new(context.whole.seed(), Purpose::Question, index);
        let mut start = Vec::new();
        for (operand, which) in [(first, 0), (second, 1)] {
            for row in &operand.slices {
                // Where paths go must not depend on how the slices are scaled.
                let turn = random.unit();
                let mut halves = [zeros.clone(), zeros.clone()];
                halves[which] = row[1..].iter().map(|c| c * turn).collect();
                start.push(row[0] * turn);
                start.extend(halves.concat());
            }
        }
        let mut target = Vec::new();
        for row in context.whole.slices(dimension) {
            target.extend(row);
            target.extend(&zeros);
        }
        for _ in dimension..first.dimension() + second.dimension() {
            let coefficients: Vec<Complex64> = (0..n).map(|_| random.unit()).collect();
            target.push(Complex64::default());
            target.extend(&coefficients);
            target.extend(coefficients.iter().map(|c| -c));
        }
        let mut points = Vec::new();
        for a in first.set.doubles() {
            for b in second.set.doubles() {
                points.push([&a[..n], &b[..n], &a[n..], &b[n..]].concat());
            }
        }
        let homotopy = HomotopyKind::Parameter {
            start,
            targets: vec![target],
        };
        let system = DescribedSystem {
            description: StageSystem::Pair { places },
            system,
        };
        Job::track(system, homotopy, &points, &context.whole.tracking).ends_only()
    }

    /// Takes the ends of a stage, and opens that of the next dimension.
    pub(super) fn paired(
        &mut self,
        context: &mut Context<'_>,
        dimension: usize,
        job: &Job,
    ) -> Option<Job> {
        let n = context.whole.variables();
        let [first, second] = operands(context, self.place)?;
        let lowest = (first.dimension() + second.dimension()).saturating_sub(n);
        let superset = self.superset(dimension);
        superset.failed += job.crossings_left();
        for (result, decision, values) in job.ends() {
            match decision.verdict {
                Verdict::AtInfinity => continue,
                Verdict::Failed | Verdict::WithinDataAccuracy | Verdict::ExcessSolution => {
                    superset.failed += 1;
                    continue;
                }
                _ => {}
            }
            let (a, b) = (&values[..n], &values[n..2 * n]);
            let equal = (EQUAL_FACTOR * result.accuracy).clamp(EQUAL, OTHER);
            match apart(a, b) {
                distance if distance <= equal => superset.singular.push(SingularEnd {
                    values: a.to_vec(),
                    accuracy: result.accuracy.max(f64::EPSILON),
                    paths: 1,
                }),
                distance if distance <= OTHER => superset.unclear += 1,
                _ => superset.excess += 1,
            }
        }
        if dimension > lowest {
            self.phase = Phase::Pair {
                dimension: dimension - 1,
            };
            return Some(self.pair_stage(context, dimension - 1));
        }
        self.next_pair();
        None
    }

    /// Equations of both components, in variables of their own, with slices in the variables of both.
    pub(super) fn pair_system(
        &mut self,
        context: &mut Context<'_>,
        places: [usize; 2],
    ) -> Arc<System> {
        if let Some((pair_places, system)) = &self.made.pair
            && *pair_places == places
        {
            return Arc::clone(system);
        }
        let [first, second] = operands(context, places).expect("a pair that was begun is there");
        let (first, second) = (first.set.clone(), second.set.clone());
        let n = context.whole.variables();
        let rows = |set: &PureSet, problem, equations: &System| -> System {
            let problem: &crate::decomposition::problem::Problem = problem;
            let rows = problem.tracked_rows(equations, set.dimension);
            rows.expect("derivatives of polynomials have degrees")
        };
        let equations = context.deflations.equations(context.problem, &first.ranks);
        let a = rows(&first, context.problem, &equations);
        let other = context.other.as_mut().expect("a pair has two sets");
        let equations = other.deflations.equations(&other.problem, &second.ranks);
        let b = rows(&second, &other.problem, &equations);
        let slices = first.dimension + second.dimension;
        let made = Arc::new(slice(&product(&a, &b, n), slices, 2 * n));
        self.made.pair = Some((places, Arc::clone(&made)));
        made
    }
}

/// The components of a pair; `None` where the second set has no more.
fn operands<'a>(context: &'a Context<'_>, places: [usize; 2]) -> Option<[&'a Operand; 2]> {
    let other = context.other.as_ref()?;
    let second = other.operands.get(places[1])?;
    Some([&context.operands[places[0]], second])
}
