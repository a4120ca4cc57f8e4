//! Superset: what paths found in one dimension, before it is known what is junk and what is multiple.

use super::job::Job;
use super::problem::{Problem, REFINED, SINGULAR};
use cognate_continuation::bend::{SlicedEquations, exactly};
use cognate_solutions::classification::Verdict;
use cognate_solutions::path_crossing::coincidences;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A point at which several paths end, or one that is singular.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SingularEnd {
    pub values: Vec<Complex64>,
    pub accuracy: f64,
    /// Number of paths that end at the point.
    pub paths: u64,
}

/// Points of one dimension that solve all equations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Superset {
    pub dimension: usize,
    pub regular: Vec<Vec<Complex64>>,
    pub singular: Vec<SingularEnd>,
    /// Ends that solve combinations only, where nothing goes on from them.
    pub excess: u64,
    /// Paths that were lost on the way to this dimension.
    pub failed: u64,
    /// Ends of which it is not clear whether they solve all equations.
    pub unclear: u64,
    /// Points of multiple sets that the next equation should have cut, and could not.
    pub not_cut: u64,
}

/// Ends nearer than this, relative to their size, are one point.
const SAME: f64 = 1e-6;

fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let (mut apart, mut size) = (0.0, 1.0);
    for (x, y) in a.iter().zip(b) {
        apart += (x - y).norm_sqr();
        size += x.norm_sqr();
    }
    (apart / size).sqrt()
}

impl Superset {
    /// Nothing in this dimension.
    pub fn empty(dimension: usize) -> Self {
        Self {
            dimension,
            ..Self::default()
        }
    }

    /// Paths of which it is not known where they ended, or whether that is a point of the set.
    pub fn lost(&self) -> u64 {
        self.failed + self.unclear
    }

    /// Takes the ends of a job that is done on slices of its dimension, by these combinations of the equations, which
    /// may have more unknowns after the problem's; gives back regular ones that solve the combinations only, with all
    /// unknowns.
    pub fn sort(
        &mut self,
        problem: &Problem,
        combinations: &SlicedEquations,
        job: &Job,
    ) -> Vec<Vec<Complex64>> {
        let (mut singular, mut others) = (Vec::new(), Vec::new());
        let variable_count = problem.variables();
        for (place, (_, decision, mut values)) in job.ends().into_iter().enumerate() {
            let exact: Vec<_> = values.iter().map(|&z| exactly(z)).collect();
            match decision.verdict {
                // Another beginning may tell.
                Verdict::AtInfinity if decision.by_precision_limit && job.is_polyhedral() => {
                    self.unclear += 1;
                }
                Verdict::AtInfinity | Verdict::Removed => {}
                Verdict::Failed | Verdict::WithinDataAccuracy | Verdict::ExcessSolution => {
                    self.failed += 1
                }
                Verdict::Finite => {
                    let refined = combinations.refine(&exact);
                    let solves = |point: &[_]| problem.solves(&point[..variable_count], &REFINED);
                    match refined.and_then(|refined| solves(&refined.point)) {
                        Some(true) => {
                            values.truncate(variable_count);
                            self.regular.push(values);
                        }
                        Some(false) => others.push(values),
                        None => self.unclear += 1,
                    }
                }
                Verdict::Singular | Verdict::Undecided | Verdict::PositiveDimensional => {
                    match problem.solves(&exact[..variable_count], &SINGULAR) {
                        Some(true) => singular.push(place),
                        _ => self.unclear += 1,
                    }
                }
            }
        }
        self.failed += job.crossings_left() + job.lost();
        self.gather(problem, job, &singular);
        others
    }

    /// Takes points of its dimension that another factor left, each of them this many times. A point that both know
    /// is one.
    pub fn join(&mut self, other: Self, times: u64) {
        let end = |values: Vec<Complex64>| SingularEnd {
            values,
            accuracy: f64::EPSILON,
            paths: 1,
        };
        let mut ends: Vec<(SingularEnd, bool)> = Vec::new();
        ends.extend(self.regular.drain(..).map(|values| (end(values), true)));
        ends.extend(self.singular.drain(..).map(|end| (end, false)));
        ends.extend(other.regular.into_iter().map(|values| (end(values), true)));
        ends.extend(other.singular.into_iter().map(|end| {
            let paths = end.paths * times;
            (SingularEnd { paths, ..end }, false)
        }));
        let first = |end: &SingularEnd| end.values.first().map_or(0.0, |z| z.re);
        ends.sort_by(|a, b| first(&a.0).total_cmp(&first(&b.0)));
        // Windows of points that the first coordinate does not tell apart.
        let mut taken = vec![false; ends.len()];
        for k in 0..ends.len() {
            if taken[k] {
                continue;
            }
            let nobody = SingularEnd {
                values: Vec::new(),
                accuracy: 0.0,
                paths: 0,
            };
            let (mut one, mut regular) = std::mem::replace(&mut ends[k], (nobody, false));
            for j in k + 1..ends.len() {
                let near = SAME * (1.0 + first(&one).abs());
                if first(&ends[j].0) - first(&one) > near {
                    break;
                }
                if !taken[j] && distance(&one.values, &ends[j].0.values) <= SAME {
                    taken[j] = true;
                    regular = false;
                    let paths = one.paths + ends[j].0.paths;
                    if ends[j].0.accuracy < one.accuracy {
                        one = ends[j].0.clone();
                    }
                    one.paths = paths;
                }
            }
            match regular {
                true => self.regular.push(one.values),
                false => self.singular.push(one),
            }
        }
    }

    /// Takes singular ends of a job by their places: those that are one point together, in the problem's unknowns.
    pub fn gather(&mut self, problem: &Problem, job: &Job, singular: &[usize]) {
        let Some(shape) = job.shape() else {
            return;
        };
        let results = job.results();
        let (tolerances, seed) = (&problem.tracking.tolerances, problem.seed());
        let chosen = |place: usize| singular.binary_search(&place).is_ok();
        for members in coincidences(results, shape, tolerances, seed, chosen) {
            let accuracy = |&m: &usize| results[m].accuracy;
            let best = members.iter().copied();
            let best = best.min_by(|a, b| accuracy(a).total_cmp(&accuracy(b)));
            let best = best.expect("a cluster has members");
            let mut values = shape.to_variables(results[best].endpoint.to_double());
            values.truncate(problem.variables());
            self.singular.push(SingularEnd {
                values,
                accuracy: accuracy(&best),
                paths: members.len() as u64,
            });
        }
    }
}
