//! Walks: whether real points of a mode with several freedoms are on one connected piece of it.
//!
//! There is a real point of each piece (`real-points`). Two of them are on one piece where small steps lead from one to
//! the other through regular points of the configurations, which no other mode passes. Where no walk arrives nothing is
//! said.

use super::Asked;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::evaluation;
use num_complex::Complex64;

/// Length of a step, in parts of the larger one of 1 and the size of the point.
const STEP: f64 = 0.02;
/// A walk to a singular point, at which equations say nothing, ends so near to it.
const NEAR_SINGULAR: f64 = 2e-3;
/// Steps of a walk, and detours of walks from one point.
const MOST_STEPS: usize = 4000;
const DETOURS: usize = 40;
/// Number of the stream of random numbers that directions of detours come from.
const DETOUR: u64 = 1 << 32;
/// A correction is shorter than this part of the step, or the step is too long.
const CORRECTION: f64 = 0.5;
/// A point is on the mode within this.
const CLOSED: f64 = 1e-10;
/// Smallest pivot within the rank of the equations at a regular point, as a part of the largest pivot.
const REGULAR: f64 = 1e-4;
/// Largest pivot behind the rank of the equations at a regular point, as a part of the largest pivot.
const DEPENDENT: f64 = 1e-7;
/// Difference by which derivatives are taken.
const DIFFERENCE: f64 = 1e-5;

/// A real point of a mode.
pub(super) struct RealPoint {
    /// Values of the unknowns.
    pub values: Vec<Complex64>,
    /// Whether the equations have their rank there.
    pub is_regular: bool,
}

/// Real configurations of a mode, in real coordinates.
pub(super) struct Walker<'a> {
    asked: &'a Asked,
    dimension: usize,
    random: RandomStream,
}

/// Equations and their derivatives at a point, real and imaginary parts.
struct Linear {
    values: Vec<f64>,
    /// Row by row.
    rows: Vec<Vec<f64>>,
}

impl<'a> Walker<'a> {
    pub fn new(asked: &'a Asked, dimension: u32, seed: u64) -> Self {
        Self {
            asked,
            dimension: dimension as usize,
            random: RandomStream::new(seed, Purpose::Question, DETOUR),
        }
    }

    /// Whether all points are on one piece; `None` where no walk was found.
    pub fn are_joined(&mut self, points: &[RealPoint]) -> Option<bool> {
        let mut goals: Vec<(Vec<f64>, bool)> = points
            .iter()
            .map(|point| (self.to_real(&point.values), point.is_regular))
            .collect();
        let start = goals.iter().position(|(_, is_regular)| *is_regular)?;
        let (start, _) = goals.swap_remove(start);
        for (goal, is_regular) in &goals {
            let within = if *is_regular { STEP } else { NEAR_SINGULAR };
            let arrives = (0..DETOURS).any(|detour| self.reaches(&start, goal, within, detour > 0));
            if !arrives {
                return None;
            }
        }
        Some(true)
    }

    /// Real coordinates: real and imaginary part of a pair of conjugates.
    fn to_real(&self, point: &[Complex64]) -> Vec<f64> {
        let partner = |k: usize| self.asked.partners[k];
        let coordinate = |k: usize| match partner(k) {
            other if other < k => point[other].im,
            _ => point[k].re,
        };
        (0..point.len()).map(coordinate).collect()
    }

    fn to_complex(&self, real: &[f64]) -> Vec<Complex64> {
        let coordinate = |k: usize| match self.asked.partners[k] {
            other if other < k => Complex64::new(real[other], -real[k]),
            other if other > k => Complex64::new(real[k], real[other]),
            _ => Complex64::new(real[k], 0.0),
        };
        (0..real.len()).map(coordinate).collect()
    }

    fn values(&self, real: &[f64]) -> Vec<f64> {
        let system = &self.asked.system;
        let point = self.to_complex(real);
        let values = evaluation::values(&system.expressions, &system.equations, &point, &[]);
        values.iter().flat_map(|z| [z.re, z.im]).collect()
    }

    fn linear(&self, real: &[f64]) -> Linear {
        let values = self.values(real);
        let mut rows = vec![vec![0.0; real.len()]; values.len()];
        for k in 0..real.len() {
            let moved = |by: f64| {
                let mut point = real.to_vec();
                point[k] += by;
                self.values(&point)
            };
            let (above, below) = (moved(DIFFERENCE), moved(-DIFFERENCE));
            for (row, (a, b)) in rows.iter_mut().zip(above.iter().zip(&below)) {
                row[k] = (a - b) / (2.0 * DIFFERENCE);
            }
        }
        Linear { values, rows }
    }

    /// Whether steps lead from a point to another one, some of the way in a random direction.
    fn reaches(&mut self, from: &[f64], goal: &[f64], within: f64, detours: bool) -> bool {
        let mut at = from.to_vec();
        if detours {
            let aim: Vec<f64> = from
                .iter()
                .map(|x| x + 3.0 * (2.0 * self.random.uniform() - 1.0))
                .collect();
            for _ in 0..MOST_STEPS / 40 {
                match self.step(&at, &aim) {
                    Some(next) => at = next,
                    None => break,
                }
            }
        }
        for _ in 0..MOST_STEPS {
            if distance(&at, goal) < within {
                return true;
            }
            match self.step(&at, goal) {
                Some(next) if distance(&next, &at) > within * 1e-2 => at = next,
                _ => return false,
            }
        }
        false
    }

    /// A step towards a point, and back to the mode; `None` where the point is not regular or the step too long.
    fn step(&self, at: &[f64], goal: &[f64]) -> Option<Vec<f64>> {
        let here = self.linear(at);
        let rank = at.len() - self.dimension;
        let basis = normals(&here, rank, true)?;
        let mut along: Vec<f64> = goal.iter().zip(at).map(|(g, x)| g - x).collect();
        for (normal, _) in &basis {
            let product = dot(&along, normal);
            for (x, n) in along.iter_mut().zip(normal) {
                *x -= product * n;
            }
        }
        let size = dot(at, at).sqrt().max(1.0);
        let length = dot(&along, &along).sqrt();
        let by = (STEP * size).min(0.7 * length) / length.max(f64::MIN_POSITIVE);
        let aim: Vec<f64> = at.iter().zip(&along).map(|(x, d)| x + by * d).collect();
        let mut next = aim.clone();
        for _ in 0..8 {
            let there = self.linear(&next);
            let largest = there.values.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            if largest < CLOSED {
                break;
            }
            for (normal, value) in normals(&there, rank, false)? {
                for (x, n) in next.iter_mut().zip(&normal) {
                    *x -= value * n;
                }
            }
        }
        let residual = self.values(&next);
        let is_closed = residual.iter().all(|x| x.abs() < 100.0 * CLOSED);
        let is_near = distance(&next, &aim) <= CORRECTION * STEP * size;
        (is_closed && is_near).then_some(next)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let square = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y));
    square.sum::<f64>().sqrt()
}

/// An orthonormal basis of the span of the rows, the longest first, and the values that go with it; `None` where its
/// dimension is not clearly `rank`. Beside the mode dependent equations may be independent, which `is_on` does not bear.
fn normals(linear: &Linear, rank: usize, is_on: bool) -> Option<Vec<(Vec<f64>, f64)>> {
    let rows = linear.rows.iter().cloned();
    let mut left: Vec<(Vec<f64>, f64)> = rows.zip(linear.values.iter().copied()).collect();
    let mut basis: Vec<(Vec<f64>, f64)> = Vec::new();
    let mut first = 0.0f64;
    loop {
        let longest = left
            .iter()
            .max_by(|(a, _), (b, _)| dot(a, a).total_cmp(&dot(b, b)));
        let (longest, value) = longest?;
        let length = dot(longest, longest).sqrt();
        if basis.is_empty() {
            first = length;
        }
        if basis.len() == rank {
            return (!is_on || length <= DEPENDENT * first).then_some(basis);
        }
        if length <= REGULAR * first {
            return None;
        }
        let normal: Vec<f64> = longest.iter().map(|x| x / length).collect();
        let value = value / length;
        for (row, other) in &mut left {
            let product = dot(row, &normal);
            for (x, n) in row.iter_mut().zip(&normal) {
                *x -= product * n;
            }
            *other -= product * value;
        }
        basis.push((normal, value));
    }
}
