//! The generic system of given supports, and the points where its toric homotopy begins.
//!
//! Every coefficient is a random number of modulus 1, so every solution of a
//! binomial system of two of them has all coordinates of modulus 1: an angle,
//! which is exact as a fraction of a turn. No logarithm and no power of a
//! modulus is ever taken.

use super::affine_supports;
use super::mixed_cells::{MixedCellsError, MixedSubdivision, mixed_cells};
use crate::chart::exact;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::roots_of_unity::on_the_circle;
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::polynomial::Polynomial;
use cognate_systems::system::System;
use num_complex::Complex64;
use rug::Integer;

/// Most operations that are spent on the mixed cells of a system that is solved.
pub const SOLVING_OPERATIONS: u64 = 20_000_000_000;

/// A system with the same supports as another and generic coefficients.
#[derive(Clone, Debug)]
pub struct GenericSystem {
    /// `supports[equation][term][variable]`.
    supports: Vec<Vec<Vec<i64>>>,
    /// `angles[equation][term]`: of the coefficients, in 2^-128 of a turn.
    angles: Vec<Vec<u128>>,
}

impl GenericSystem {
    /// The supports that serve for all isolated solutions in C^n, with random coefficients;
    /// `nonzero`: variables that are 0 at none.
    pub fn new(supports: &[Vec<Vec<u32>>], nonzero: &[bool], seed: u64) -> Self {
        let supports = affine_supports(supports, nonzero);
        let angles = supports
            .iter()
            .enumerate()
            .map(|(i, support)| {
                let mut stream = RandomStream::new(seed, Purpose::StartSystem, i as u64);
                let angle = |_: &Vec<i64>| u128::from(stream.bits()) << 64;
                support.iter().map(angle).collect()
            })
            .collect();
        Self { supports, angles }
    }

    /// The coefficients, equation after equation.
    pub fn coefficients(&self) -> impl Iterator<Item = Complex64> {
        self.angles.iter().flatten().copied().map(on_the_circle)
    }

    /// The gamma with which no coefficient comes near 0 between this system and the one with its
    /// monomials: of some random units the one that is farthest from turning a coefficient of
    /// this system into the opposite direction of the other's.
    ///
    /// On `(1-t) f + t gamma g` a coefficient whose ends are nearly opposite nearly vanishes on the
    /// way, and where it belongs to a vertex of the supports solutions pass by infinity or 0 there:
    /// of 100 seeds of eco-8 two had a path as large as 1e13.
    pub fn gamma(&self, system: &System, parameters: &[Complex64], seed: u64) -> Complex64 {
        const DRAWS: usize = 64;
        let mut avoided = Vec::new();
        let mut own = self.coefficients();
        for (support, &equation) in self.supports.iter().zip(&system.equations) {
            let (n, p) = (system.variable_count(), parameters.len());
            let other = Polynomial::expand(&system.expressions, equation, n, p);
            let other = other.map_or_else(Default::default, |f| f.coefficients_at(parameters));
            for (point, g) in support.iter().zip(own.by_ref()) {
                let exponents = point.iter().map(|&e| u32::try_from(e).unwrap_or(u32::MAX));
                let f = other.get(&exponents.collect::<Vec<u32>>());
                let f = f.copied().unwrap_or_default();
                let opposite = -f * g.conj();
                let size = opposite.norm_sqr().sqrt();
                if size > 0.0 && size.is_finite() {
                    avoided.push(opposite / size);
                }
            }
        }
        let mut stream = RandomStream::new(seed, Purpose::Gamma, 0);
        let distance = |gamma: Complex64| {
            let distances = avoided.iter().map(|a| (gamma - a).norm_sqr());
            distances.fold(f64::INFINITY, |least, d| if d < least { d } else { least })
        };
        let mut best = stream.unit();
        for _ in 1..DRAWS {
            let gamma = stream.unit();
            if distance(gamma) > distance(best) {
                best = gamma;
            }
        }
        best
    }

    /// The equations with their own coefficients; see [`Self::equations`].
    pub fn constant_equations(
        &self,
        system: &System,
        degrees: &[Vec<u32>],
        out: &mut Expressions,
        coordinates: &[Vec<NodeId>],
    ) -> Vec<NodeId> {
        let mut coefficients = self.coefficients();
        let next = |out: &mut Expressions| exact(out, coefficients.next().unwrap_or_default());
        self.equations(system, degrees, out, coordinates, next)
    }

    /// Writes the equations over the homogeneous coordinates of the system's
    /// affine groups, each of the degree that the system's own has in the group.
    /// `coefficients` yields a node for each term, equation after equation.
    ///
    /// # Panics
    /// When a group is homogeneous, or a term has a higher degree than its equation.
    pub fn equations(
        &self,
        system: &System,
        degrees: &[Vec<u32>],
        out: &mut Expressions,
        coordinates: &[Vec<NodeId>],
        mut coefficient: impl FnMut(&mut Expressions) -> NodeId,
    ) -> Vec<NodeId> {
        self.supports
            .iter()
            .zip(degrees)
            .map(|(support, degrees)| {
                let mut sum = out.integer(0);
                for point in support {
                    let mut term = coefficient(out);
                    for (g, group) in system.groups.iter().enumerate() {
                        assert!(
                            !group.homogeneous,
                            "only affine groups have supports in C^n"
                        );
                        let mut left = degrees[g];
                        for (j, &v) in group.variables.iter().enumerate() {
                            let exponent = u32::try_from(point[v]).expect("a polynomial's");
                            left = left.checked_sub(exponent).expect("at most the degree");
                            let power = out.power(coordinates[g][j + 1], exponent);
                            term = out.multiply(term, power);
                        }
                        let power = out.power(coordinates[g][0], left);
                        term = out.multiply(term, power);
                    }
                    sum = out.add(sum, term);
                }
                sum
            })
            .collect()
    }
}

/// The mixed cells of a generic system: where its toric homotopy begins.
#[derive(Clone, Debug)]
pub struct ToricStart {
    generic: GenericSystem,
    subdivision: MixedSubdivision,
    /// Index of the first start point of each cell.
    offsets: Vec<u64>,
}

impl ToricStart {
    /// Enumerates the cells; a function of supports and seed alone.
    pub fn new(generic: GenericSystem, seed: u64) -> Result<Self, MixedCellsError> {
        let subdivision = mixed_cells(&generic.supports, seed, SOLVING_OPERATIONS)?;
        let offsets = subdivision
            .cells
            .iter()
            .scan(0, |sum, cell| {
                let offset = *sum;
                *sum += cell.volume;
                Some(offset)
            })
            .collect();
        Ok(Self {
            generic,
            subdivision,
            offsets,
        })
    }

    /// The system whose solutions the toric homotopy finds.
    pub fn generic(&self) -> &GenericSystem {
        &self.generic
    }

    /// Number of start points: the mixed volume.
    pub fn count(&self) -> u64 {
        self.subdivision.mixed_volume
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.subdivision.cells.len()
    }

    /// The cell of a start point.
    pub fn cell(&self, index: u64) -> usize {
        self.offsets.partition_point(|&offset| offset <= index) - 1
    }

    /// The exponent of s at every term of the toric homotopy of a cell, equation
    /// after equation: 0 at the ends of the cell's edges, elsewhere at least 1,
    /// and 1 at one term at least (where the cell is not all there is).
    pub fn weights(&self, cell: usize) -> Vec<f64> {
        let cell = &self.subdivision.cells[cell];
        let volume = i128::from(cell.volume);
        // Volume times the height above the cell, exactly.
        let mut heights = Vec::new();
        for (i, support) in self.generic.supports.iter().enumerate() {
            let height = |term: usize| {
                let lifted = volume * i128::from(self.subdivision.lifting[i][term]);
                let along: i128 = support[term]
                    .iter()
                    .zip(&cell.normal)
                    .map(|(&a, &v)| i128::from(a) * v)
                    .sum();
                lifted + along
            };
            let base = height(cell.edges[i][0] as usize);
            heights.extend((0..support.len()).map(|term| height(term) - base));
        }
        let least = heights.iter().copied().filter(|&h| h > 0).min();
        let least = least.unwrap_or(1) as f64;
        heights.iter().map(|&h| h as f64 / least).collect()
    }

    /// The power q of `s = 1 - t^q` that spreads all weights over t: the number
    /// of decimal places of the largest one, at most 4.
    pub fn time_exponent(&self) -> u32 {
        let largest = (0..self.cell_count())
            .flat_map(|cell| self.weights(cell))
            .fold(1.0, f64::max);
        (1..4)
            .find(|&q| largest <= 10f64.powi(q))
            .unwrap_or(4)
            .unsigned_abs()
    }

    /// Start point number `index`: a solution of the binomial system of its cell.
    pub fn point(&self, index: u64) -> Vec<Complex64> {
        let number = self.cell(index);
        let cell = &self.subdivision.cells[number];
        let n = self.generic.supports.len();
        let mut matrix = Vec::with_capacity(n);
        let mut right = Vec::with_capacity(n);
        for (i, &[a, b]) in cell.edges.iter().enumerate() {
            let (a, b) = (a as usize, b as usize);
            let support = &self.generic.supports[i];
            matrix.push(
                (0..n)
                    .map(|j| Integer::from(support[b][j] - support[a][j]))
                    .collect::<Vec<Integer>>(),
            );
            // x^(b-a) = -c_a / c_b.
            let angles = &self.generic.angles[i];
            right.push(angles[a].wrapping_sub(angles[b]).wrapping_add(1 << 127));
        }
        let transform = hermite(&mut matrix);
        // In z with x = z^transform the system is triangular: one root after the other.
        let mut rest = index - self.offsets[number];
        let mut z: Vec<Integer> = Vec::with_capacity(n);
        let turn = Integer::from(1) << 128;
        for i in 0..n {
            let mut angle = Integer::from(right[i]);
            for (entry, z) in matrix[i].iter().zip(&z) {
                angle -= Integer::from(entry * z);
            }
            let degree = &matrix[i][i];
            let degree_word = degree.to_u64().expect("it divides the volume");
            let angle = angle.modulo(&turn) + (Integer::from(rest % degree_word) << 128);
            rest /= degree_word;
            z.push(angle / degree);
        }
        (0..n)
            .map(|j| {
                let mut angle = Integer::new();
                for (entry, z) in transform[j].iter().zip(&z) {
                    angle += Integer::from(entry * z);
                }
                let angle = angle.modulo(&turn);
                on_the_circle(angle.to_u128().expect("it is below 2^128"))
            })
            .collect()
    }
}

/// Brings a regular square matrix, by unimodular operations on its columns, to
/// lower triangular form with a positive diagonal; returns the operations:
/// old matrix times result = new matrix.
fn hermite(matrix: &mut [Vec<Integer>]) -> Vec<Vec<Integer>> {
    let n = matrix.len();
    let mut transform: Vec<Vec<Integer>> = (0..n)
        .map(|i| (0..n).map(|j| Integer::from(i32::from(i == j))).collect())
        .collect();
    for i in 0..n {
        loop {
            // The smallest entry of the row from the diagonal on goes to the diagonal.
            let pivot = (i..n)
                .filter(|&j| matrix[i][j] != 0)
                .min_by(|&a, &b| matrix[i][a].cmp_abs(&matrix[i][b]))
                .expect("a regular matrix has no such row");
            let rows = || 0..n;
            for k in rows() {
                matrix[k].swap(i, pivot);
                transform[k].swap(i, pivot);
            }
            if matrix[i][i] < 0 {
                for k in rows() {
                    for row in [&mut matrix[k], &mut transform[k]] {
                        let entry = std::mem::take(&mut row[i]);
                        row[i] = -entry;
                    }
                }
            }
            let mut done = true;
            for j in i + 1..n {
                let quotient = matrix[i][j].clone().div_rem_floor(matrix[i][i].clone()).0;
                if quotient == 0 {
                    done &= matrix[i][j] == 0;
                    continue;
                }
                for k in rows() {
                    for row in [&mut matrix[k], &mut transform[k]] {
                        let part = Integer::from(&row[i] * &quotient);
                        row[j] -= part;
                    }
                }
                done &= matrix[i][j] == 0;
            }
            if done {
                break;
            }
        }
    }
    transform
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::homotopies::HomotopyKind;
    use crate::stage::{PrepareError, PreparedStage};
    use crate::start_points::StartPoints;
    use crate::tracker::outcome::PathOutcome;
    use crate::tracker::settings::Settings;
    use crate::work::{Stage, StageId, Work};
    use cognate_systems::named::cyclic;

    fn toric(system: &System, count: u64) -> Result<PreparedStage, PrepareError> {
        let stage = Stage {
            id: StageId(0),
            work: Work::Track,
            homotopy: HomotopyKind::Toric,
            start_points: StartPoints::MixedCells { count },
            settings: Settings::default(),
            seed: 4,
            attempt: 0,
        };
        PreparedStage::new(system, &stage, &|_| None)
    }

    #[test]
    fn toric_paths_are_the_same_at_every_width_and_end_regular() {
        let system = cyclic(5).system;
        let stage = toric(&system, 70).expect("the mixed volume is 70");
        let all = stage.track(0..70, 8);
        assert!(all.iter().all(|r| r.outcome == PathOutcome::Regular));
        for width in [1, 16] {
            let mut again = stage.track(0..33, width);
            again.extend(stage.track(33..70, width));
            assert_eq!(again, all, "width {width}");
        }
    }

    #[test]
    fn another_count_or_kind_of_start_is_refused() {
        let system = cyclic(5).system;
        let error = toric(&system, 71).err().map(|e| e.to_string());
        assert!(error.is_some_and(|e| e.contains("70")));
    }

    #[test]
    fn start_points_solve_their_binomials_and_differ() {
        // Volumes above 1, negative entries: two sparse equations of high degree in three variables.
        let supports: Vec<Vec<Vec<u32>>> = vec![
            vec![vec![0, 0, 0], vec![3, 1, 0], vec![0, 2, 5], vec![1, 1, 1]],
            vec![vec![0, 0, 0], vec![2, 4, 1], vec![1, 0, 3]],
            vec![vec![0, 0, 0], vec![0, 3, 2], vec![4, 0, 0], vec![2, 2, 2]],
        ];
        let start = ToricStart::new(GenericSystem::new(&supports, &[], 5), 5).expect("it is small");
        assert!(start.count() > 20);
        let coefficients: Vec<Complex64> = start.generic.coefficients().collect();
        let mut all: Vec<Vec<Complex64>> = Vec::new();
        for index in 0..start.count() {
            let x = start.point(index);
            let cell = start.cell(index);
            let weights = start.weights(cell);
            let mut k = 0;
            for support in &start.generic.supports {
                let mut sum = Complex64::default();
                let mut zeros = 0;
                for point in support {
                    assert!(weights[k] == 0.0 || weights[k] >= 1.0);
                    if weights[k] == 0.0 {
                        zeros += 1;
                        let monomial = point
                            .iter()
                            .zip(&x)
                            .fold(Complex64::new(1.0, 0.0), |m, (&e, x)| m * x.powi(e as i32));
                        sum += coefficients[k] * monomial;
                    }
                    k += 1;
                }
                assert_eq!(zeros, 2, "an edge has two ends");
                assert!(sum.norm_sqr() < 1e-26, "{sum}");
            }
            assert!(weights.contains(&1.0));
            let distance = |y: &Vec<Complex64>| -> f64 {
                y.iter().zip(&x).map(|(a, b)| (a - b).norm_sqr()).sum()
            };
            for (other, y) in all.iter().enumerate() {
                assert!(start.cell(other as u64) != cell || distance(y) > 1e-3);
            }
            all.push(x);
        }
    }
}
