//! Project: dimension and degree of the closure of each component's image in some of its variables.
//!
//! The rank of the projection on the tangent space at a witness point is the dimension of the image. Slices in special
//! position, as many in the variables of the projection as the image has dimensions, the others general, cut out of the
//! component the general fibres over the points of a general slice of the image. The number of different images is the
//! degree of the image, and each occurs as often as the fibre's degree (Hauenstein, Sommese: Witness sets of
//! projections, Appl. Math. Comput. 217, 2010). Both numbers must come out twice, on two choices of the slices. Two
//! images of one dimension meet a general slice in the same points if they are the same, else in no common one.

use super::context::Context;
use super::error::QuestionError;
use super::procedure::{GivenSystem, Procedure};
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use cognate_continuation::bend::{Number, SlicedEquations, doubles_of};
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::Verdict;
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::Projection;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Slices that must lead to the same numbers.
const SLICES: usize = 2;
/// A gap of singular values smaller than this tells no rank.
const LEAST_GAP: f64 = 1e6;
/// Singular values below this part of the largest may be 0.
const SMALL: f64 = 1e-8;
/// Images nearer than this, relative to their size, are one.
const SAME: f64 = 1e-9;
/// Images farther apart than this, relative to their size, are two.
const OTHER: f64 = 1e-6;

/// Component by component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Project {
    onto: Vec<u32>,
    found: Vec<Projection>,
    /// For each component the points of its image on the first slice; none if they are not clear.
    images: Vec<Vec<Vec<Complex64>>>,
}

impl Procedure for Project {
    fn advance(&mut self, context: &mut Context<'_>, done: Option<Job>) -> Option<Job> {
        if let Some(job) = done {
            self.learn(context, &job);
        }
        while let Some(operand) = context.operands.get(self.found.len()) {
            let (rank, gap) = self.image_dimension(context, operand);
            let mut projection = Projection {
                id: operand.id,
                dimension: rank,
                degree: None,
                fiber_degree: None,
                fiber_dimension: None,
                same_image: None,
                rank_gap: gap.min(f64::MAX),
                doubts: Vec::new(),
            };
            let Some(rank) = rank else {
                let doubt = format!("ranks do not tell the dimension of the image: gap {gap:.1e}");
                projection.doubts.push(doubt);
                self.found.push(projection);
                self.images.push(Vec::new());
                continue;
            };
            projection.fiber_dimension = Some(operand.dimension() as u32 - rank);
            self.found.push(projection);
            if operand.dimension() == 0 {
                let point = doubles_of(&operand.set.points[0].point);
                self.settle((1, 1), vec![self.image(&point)]);
                continue;
            }
            let slice = |number: usize| self.special(context, operand, rank as usize, number);
            let targets = (0..SLICES).map(slice).collect();
            return Some(operand.moved_to(&mut context.of_components(), targets));
        }
        None
    }

    fn answer(&mut self, _: &GivenSystem<'_>) -> Answer {
        Answer::Project(std::mem::take(&mut self.found))
    }

    fn description(&self) -> &'static str {
        "moving slices to fibres"
    }
}

impl Project {
    pub fn new(system: &System, onto: &[u32]) -> Result<Self, QuestionError> {
        let n = system.variables.len();
        let wrong = |value: String| {
            let expected = format!("some of the {n} variables, each once");
            QuestionError::wish("onto", value, expected)
        };
        let mut sorted = onto.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        if onto.is_empty() || sorted.len() < onto.len() {
            return Err(wrong(format!("{} variables", onto.len())));
        }
        if let Some(strange) = onto.iter().find(|&&v| v as usize >= n) {
            return Err(wrong(format!("variable {strange}")));
        }
        Ok(Self {
            onto: onto.to_vec(),
            found: Vec::new(),
            images: Vec::new(),
        })
    }

    fn image(&self, point: &[Complex64]) -> Vec<Complex64> {
        self.onto.iter().map(|&v| point[v as usize]).collect()
    }

    /// Writes down the degrees of the last component, and whether its image is that of one before it.
    fn settle(&mut self, (degree, fiber): (u64, u64), images: Vec<Vec<Complex64>>) {
        let (projection, before) = self.found.split_last_mut().expect("there is a last one");
        (projection.degree, projection.fiber_degree) = (Some(degree), Some(fiber));
        let others = before.iter().zip(&self.images);
        for (other, its) in others.filter(|(other, _)| other.same_image.is_none()) {
            if (other.dimension, other.degree) != (projection.dimension, projection.degree) {
                continue;
            }
            match alike(&images, its) {
                Some(true) => projection.same_image = Some(other.id),
                Some(false) => continue,
                None => projection.doubts.push(format!(
                    "whether its image is that of {} is not clear",
                    other.id
                )),
            }
            break;
        }
        self.images.push(images);
    }

    /// Rank of the projection on the tangent space at the witness points, and the least gap between singular values
    /// taken as 0 and not; `None` where points do not agree or there is no gap.
    fn image_dimension(&self, context: &mut Context<'_>, operand: &Operand) -> (Option<u32>, f64) {
        let system = context
            .deflations
            .equations(context.problem, &operand.set.ranks);
        let equations = SlicedEquations::new(&system, Vec::new());
        let mut common: Option<u32> = None;
        let mut least = f64::INFINITY;
        for point in operand.set.points.iter().take(3) {
            let columns = self.with_rows(&equations, &point.point);
            let unknowns = columns.len();
            let (rank, gap) = rank_of(&Svd::of(columns).values);
            least = least.min(gap);
            // The equations alone leave as many directions as the component has dimensions.
            let free = (rank + operand.dimension()).checked_sub(unknowns);
            let Some(free) = free.filter(|_| gap >= LEAST_GAP) else {
                return (None, gap);
            };
            match common {
                Some(image_rank) if image_rank != free as u32 => return (None, gap),
                _ => common = Some(free as u32),
            }
        }
        (common, least)
    }

    /// The Jacobian of the equations, each row scaled to 1, above the projection: in columns.
    fn with_rows(&self, equations: &SlicedEquations, point: &[Number]) -> Vec<Vec<Complex64>> {
        let (_, mut columns) = equations.linear_part(point, 0);
        let rows = columns.first().map_or(0, Vec::len);
        for i in 0..rows {
            let size = columns.iter().map(|c| c[i].norm_sqr()).sum::<f64>().sqrt();
            if size > 0.0 {
                columns.iter_mut().for_each(|column| column[i] /= size);
            }
        }
        for (v, column) in columns.iter_mut().enumerate() {
            for &onto in &self.onto {
                let one = if onto as usize == v { 1.0 } else { 0.0 };
                column.push(Complex64::new(one, 0.0));
            }
        }
        columns
    }

    /// Slices in special position: `rank` of them in the variables of the projection, the others general.
    fn special(
        &self,
        context: &Context<'_>,
        operand: &Operand,
        rank: usize,
        number: usize,
    ) -> Vec<Vec<Complex64>> {
        let n = context.problem.variables();
        let seed = context.problem.seed();
        let mut random = RandomStream::new(seed, Purpose::Question, number as u64);
        let rows = 0..operand.dimension();
        rows.map(|row| {
            let mut coefficients: Vec<Complex64> = (0..=n).map(|_| random.unit()).collect();
            if row < rank {
                for v in 0..n {
                    if !self.onto.contains(&(v as u32)) {
                        coefficients[v + 1] = Complex64::default();
                    }
                }
            }
            coefficients
        })
        .collect()
    }

    fn learn(&mut self, context: &Context<'_>, job: &Job) {
        let place = self.found.len() - 1;
        let operand = &context.operands[place];
        let mut counted = Vec::new();
        let mut doubts = Vec::new();
        let mut first_images = Vec::new();
        let ends = job.ends();
        for ends in ends.chunks(operand.degree()) {
            let mut images: Vec<Vec<Complex64>> = Vec::new();
            let mut bad = 0;
            for (_, decision, end) in ends {
                match decision.verdict {
                    Verdict::Finite => images.push(self.image(end)),
                    Verdict::AtInfinity => {}
                    _ => bad += 1,
                }
            }
            if bad > 0 {
                doubts.push(format!(
                    "{bad} paths to a special slice failed or ended at singular points"
                ));
            }
            match grouped(&images) {
                Some(counts) => counted.push(counts),
                None => doubts.push("images of fibres cannot be told apart".into()),
            }
            if first_images.is_empty() {
                first_images = images;
            }
        }
        let first = counted.first().copied();
        if doubts.is_empty() && counted.iter().any(|&counts| Some(counts) != first) {
            doubts.push(format!("two slices give different degrees: {counted:?}"));
        }
        match first.filter(|_| doubts.is_empty()) {
            Some(first) => self.settle(first, first_images),
            None => {
                self.found[place].doubts.extend(doubts);
                self.images.push(Vec::new());
            }
        }
    }
}

/// Number of singular values, descending, that are not 0, and the gap after them.
fn rank_of(values: &[f64]) -> (usize, f64) {
    let largest = values.first().copied().unwrap_or(0.0);
    let rank = values.iter().filter(|&&s| s > SMALL * largest).count();
    let before = rank.checked_sub(1).map_or(0.0, |k| values[k]);
    let after = values.get(rank).copied().unwrap_or(0.0);
    (rank, before / after.max(f64::EPSILON * largest))
}

/// Whether two lists hold the same points, however often each; `None` where some are neither equal nor different, or
/// only some are common.
fn alike(a: &[Vec<Complex64>], b: &[Vec<Complex64>]) -> Option<bool> {
    let mut common = 0;
    for point in a {
        let size = point.iter().map(|z| z.norm_sqr()).sum::<f64>();
        let size = size.sqrt().max(1.0);
        let distance = |other: &Vec<Complex64>| {
            let pairs = point.iter().zip(other);
            pairs.map(|(x, y)| (x - y).norm_sqr()).sum::<f64>().sqrt() / size
        };
        let nearest = b.iter().map(distance).fold(f64::INFINITY, f64::min);
        match () {
            () if nearest <= SAME => common += 1,
            () if nearest <= OTHER => return None,
            () => {}
        }
    }
    match common {
        0 => Some(false),
        _ => (common == a.len()).then_some(true),
    }
}

/// The number of different points, and how often each is there; `None` where some are there more often than
/// others, or points are neither equal nor different.
fn grouped(points: &[Vec<Complex64>]) -> Option<(u64, u64)> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a][0].re.total_cmp(&points[b][0].re));
    let mut groups: Vec<(usize, u64)> = Vec::new();
    for k in order {
        let mut group = None;
        for (g, (first, _)) in groups.iter().enumerate().rev() {
            let size = points[k]
                .iter()
                .map(|z| z.norm_sqr())
                .sum::<f64>()
                .sqrt()
                .max(1.0);
            if points[k][0].re - points[*first][0].re > OTHER * size {
                break;
            }
            let pairs = points[k].iter().zip(&points[*first]);
            let apart = pairs.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>().sqrt() / size;
            match () {
                () if apart <= SAME => group = Some(g),
                () if apart <= OTHER => return None,
                () => {}
            }
        }
        match group {
            Some(g) => groups[g].1 += 1,
            None => groups.push((k, 1)),
        }
    }
    let each = groups.first().map_or(0, |(_, count)| *count);
    let alike = groups.iter().all(|(_, count)| *count == each);
    (alike && !groups.is_empty()).then_some((groups.len() as u64, each))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_images_are_counted_once() {
        let point = |x: f64, y: f64| vec![Complex64::new(x, y), Complex64::new(y, 0.0)];
        let points = [
            point(1.0, 2.0),
            point(0.0, 1.0),
            point(1.0, 2.0),
            point(0.0, 1.0),
        ];
        assert_eq!(grouped(&points), Some((2, 2)));
        assert_eq!(grouped(&points[..3]), None);
        let near = [point(1.0, 2.0), point(1.0 + 1e-7, 2.0)];
        assert_eq!(grouped(&near), None);
        assert_eq!(alike(&points, &points[..2]), Some(true));
        assert_eq!(alike(&points, &near[..1]), None);
        assert_eq!(alike(&near[1..], &points), None);
        assert_eq!(alike(&[point(3.0, 2.0)], &points), Some(false));
    }
}
