//! Sample: points of each component, by moving its slices: at random, near a point, or through real points of a box.

use super::context::Context;
use super::error::{QuestionError, check_number};
use super::member::checked;
use super::procedure::{GivenSystem, Procedure};
use super::real_box::{self, Place, RealBox};
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use crate::decomposition::problem::Known;
use cognate_continuation::bend::exactly;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::Verdict;
use cognate_solutions::involution::Involution;
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::Samples;
use cognate_solutions::witness::question::SampleWish;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Most samples of a component.
const MOST_SAMPLES: u64 = 1_000_000;
/// Most coordinates of the points of a component.
const MOST_COORDINATES: u64 = 1_000_000;
/// Rounds of stages without enough real points before the search ends.
const MOST_ROUNDS: u32 = 12;
/// Slices of a round for each point that is wanted, at least.
const LEAST_SLICES: u64 = 16;
/// Distance from a point, relative to its size, of the slices that find other points near it.
const NEAR: f64 = 1e-2;
/// A coordinate this small beside the point's size is no imaginary part.
const REAL: f64 = 1e-9;

/// Component by component, round by round.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Sample {
    wish: SampleWish,
    found: Vec<Samples>,
    round: u32,
    /// Slices that were used for the component.
    used: u64,
}

impl Procedure for Sample {
    fn advance(&mut self, context: &mut Context<'_>, done: Option<Job>) -> Option<Job> {
        if let Some(job) = done {
            self.learn(context, &job);
        }
        loop {
            let place = self.found.len().saturating_sub(1);
            let enough = |samples: &Samples| samples.points.len() as u64 >= samples.wanted;
            let current = self.found.last();
            if current.is_none_or(enough) || self.round >= MOST_ROUNDS {
                let operand = context.operands.get(self.found.len())?;
                self.found.push(Samples {
                    id: operand.id,
                    wanted: self.wish.count,
                    points: Vec::new(),
                    failed: 0,
                });
                (self.round, self.used) = (0, 0);
                if operand.dimension() == 0 {
                    self.take_point(context, operand);
                }
                continue;
            }
            let operand = &context.operands[place];
            let targets = self.targets(context, operand, &self.found[place]);
            self.round += 1;
            self.used += targets.len() as u64;
            return Some(operand.moved_to(&mut context.of_components(), targets));
        }
    }

    fn answer(&mut self, _: &GivenSystem<'_>) -> Answer {
        Answer::Sample(std::mem::take(&mut self.found))
    }

    fn description(&self) -> &'static str {
        "moving slices to samples"
    }
}

impl Sample {
    pub fn new(system: &System, wish: &SampleWish) -> Result<Self, QuestionError> {
        check_number("count", wish.count, MOST_SAMPLES)?;
        let coordinates = wish.count.saturating_mul(system.variables.len() as u64);
        if coordinates > MOST_COORDINATES {
            let expected = format!("at most {MOST_COORDINATES} coordinates in all");
            let count = wish.count.to_string();
            return Err(QuestionError::wish("count", count, expected));
        }
        if let Some(near) = &wish.near {
            checked(system, std::slice::from_ref(near))?;
        }
        real_box::checked(&wish.within, system.variables.len())?;
        Ok(Self {
            wish: wish.clone(),
            found: Vec::new(),
            round: 0,
            used: 0,
        })
    }

    fn is_real(&self) -> bool {
        self.wish.real || !self.wish.within.is_empty()
    }

    /// An isolated point is all there is.
    fn take_point(&mut self, context: &Context<'_>, operand: &Operand) {
        let n = context.problem.variables();
        let point = cognate_continuation::bend::doubles_of(&operand.set.points[0].point[..n]);
        let values = context.problem.to_variables(&point);
        let fits = self.fits(context, &values);
        if let Some(samples) = self.found.last_mut() {
            samples.wanted = 1;
            if fits {
                samples.points.push(values);
            } else {
                samples.wanted = 0;
            }
        }
    }

    /// The slices of the next round.
    fn targets(
        &self,
        context: &Context<'_>,
        operand: &Operand,
        samples: &Samples,
    ) -> Vec<Vec<Vec<Complex64>>> {
        let degree = operand.degree() as u64;
        let missing = samples.wanted - samples.points.len() as u64;
        let wanted = match (self.is_real() || self.wish.near.is_some(), self.round) {
            (false, _) => missing.div_ceil(degree),
            (true, 0) => missing.max(LEAST_SLICES),
            // As many points come from a slice as before.
            (true, _) => {
                let each = samples.points.len().max(1) as u64;
                (missing * self.used).div_ceil(each).max(LEAST_SLICES)
            }
        };
        let count = wanted.min(operand.most_targets() as u64);
        let slice = |k: u64| self.slice(context, operand, self.used + k);
        (0..count).map(slice).collect()
    }

    /// One slice, a row for each dimension.
    fn slice(&self, context: &Context<'_>, operand: &Operand, number: u64) -> Vec<Vec<Complex64>> {
        let problem = context.problem;
        let n = problem.variables();
        let index = (u64::from(operand.id.dimension) << 52) ^ (u64::from(operand.id.number) << 32);
        let mut random = RandomStream::new(
            problem.seed(),
            Purpose::Question,
            (1 << 60) ^ index ^ number,
        );
        let real = self.is_real();
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mut complex = |size: f64| Complex64::new(between(-size, size), between(-size, size));
        let through: Vec<Complex64> = match (&self.wish.near, self.wish.within.is_empty()) {
            (Some(near), _) => {
                let size = NEAR * length(&near.values).max(1.0);
                let moved = near.values.iter().map(|z| z + complex(size));
                problem.to_unknowns(&moved.collect::<Vec<_>>())
            }
            (None, false) => {
                let parts: Vec<f64> = (0..n).map(|_| 0.5 * (1.0 + complex(1.0).re)).collect();
                let involution = conjugation(context);
                let wanted = RealBox::new(&self.wish.within, &involution);
                let point = wanted.map(|wanted| wanted.point(&parts));
                problem.to_unknowns(&point.unwrap_or_default())
            }
            (None, true) => {
                let size = spread(operand);
                (0..n).map(|_| complex(size)).collect()
            }
        };
        // The slice of a real wish is mapped to itself by the conjugation of the system.
        let symmetric = |values: Vec<Complex64>| match (real, &problem.involution) {
            (false, _) => values,
            (true, Some(involution)) => {
                let image = involution.image(&values);
                let pairs = values.iter().zip(image);
                pairs.map(|(a, b)| 0.5 * (a + b)).collect()
            }
            (true, None) => values.iter().map(|z| Complex64::new(z.re, 0.0)).collect(),
        };
        let through = symmetric(through);
        let rows = 0..operand.dimension();
        rows.map(|_| {
            let coefficients = symmetric((0..n).map(|_| complex(1.0)).collect());
            let terms = coefficients.iter().zip(&through);
            let constant = -terms.map(|(c, x)| c * x).sum::<Complex64>();
            std::iter::once(constant).chain(coefficients).collect()
        })
        .collect()
    }

    fn learn(&mut self, context: &Context<'_>, job: &Job) {
        let n = context.problem.variables();
        let mut taken: Vec<Vec<Complex64>> = Vec::new();
        let mut failed = 0;
        let place = self.found.len().saturating_sub(1);
        let degree = context.operands[place].degree();
        for ends in job.ends().chunks(degree) {
            let mut of_slice: Vec<Vec<Complex64>> = Vec::new();
            for (result, decision, end) in ends {
                match decision.verdict {
                    Verdict::AtInfinity => continue,
                    Verdict::Finite => {}
                    _ => {
                        failed += 1;
                        continue;
                    }
                }
                let exact: Vec<_> = end[..n].iter().map(|&z| exactly(z)).collect();
                let thresholds = Known::to_accuracy(result.accuracy.max(1e-12));
                let values = context.problem.to_variables(&end[..n]);
                if context.problem.solves(&exact, &thresholds) == Some(false) {
                    failed += 1;
                } else if self.fits(context, &values) {
                    of_slice.push(values);
                }
            }
            match &self.wish.near {
                // One end of each slice is near the point.
                Some(near) => {
                    let apart = |p: &Vec<Complex64>| -> f64 {
                        let pairs = p.iter().zip(&near.values);
                        pairs.map(|(a, b)| (a - b).norm_sqr()).sum()
                    };
                    let nearest = of_slice
                        .into_iter()
                        .min_by(|a, b| apart(a).total_cmp(&apart(b)));
                    taken.extend(nearest);
                }
                None => taken.extend(of_slice),
            }
        }
        if let Some(samples) = self.found.last_mut() {
            let room = samples.wanted as usize - samples.points.len();
            taken.truncate(room);
            let real = self.wish.real || !self.wish.within.is_empty();
            samples
                .points
                .extend(taken.into_iter().map(|point| match real {
                    true => real_parts(point),
                    false => point,
                }));
            samples.failed += failed;
        }
    }

    /// Whether a point is real and not outside of the box, if real points are wanted.
    fn fits(&self, context: &Context<'_>, values: &[Complex64]) -> bool {
        if !self.is_real() {
            return true;
        }
        let size = length(values).max(1.0);
        // In isotropic coordinates a point is real where conjugates are each other's.
        let involution = conjugation(context);
        let image = involution.image(values);
        let mut pairs = values.iter().zip(&image);
        let real = pairs.all(|(a, b)| (a - b).norm_sqr().sqrt() <= REAL * size);
        let wanted = RealBox::new(&self.wish.within, &involution);
        real && wanted.is_none_or(|wanted| wanted.place(values, 0.0, None) != Place::Outside)
    }
}

/// Involution that fixes real points: conjugation, with the exchange of conjugate variables.
fn conjugation(context: &Context<'_>) -> Involution {
    let conjugation_of_variables = || Involution {
        partner: (0..context.problem.variables()).collect(),
    };
    context
        .problem
        .involution
        .clone()
        .unwrap_or_else(conjugation_of_variables)
}

/// Spread of the witness points, at least 1.
fn spread(operand: &Operand) -> f64 {
    let points = operand.set.doubles();
    let mut sizes: Vec<f64> = points
        .iter()
        .map(|p| p.iter().map(|z| z.norm_sqr().sqrt()).fold(0.0, f64::max))
        .collect();
    sizes.sort_by(f64::total_cmp);
    sizes[sizes.len() / 2].max(1.0)
}

fn length(values: &[Complex64]) -> f64 {
    values.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt()
}

/// A point without imaginary parts, where all its variables are real.
fn real_parts(mut point: Vec<Complex64>) -> Vec<Complex64> {
    let size = length(&point).max(1.0);
    if point.iter().all(|z| z.im.abs() <= REAL * size) {
        for z in &mut point {
            z.im = 0.0;
        }
    }
    point
}
