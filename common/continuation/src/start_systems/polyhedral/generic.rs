//! The generic system of given supports, and the points where its toric homotopy begins.
//!
//! Every coefficient is a random number of modulus 1, so every solution of a
//! binomial system of two of them has all coordinates of modulus 1: an angle,
//! which is exact as a fraction of a turn. No logarithm and no power of a
//! modulus is ever taken.

use super::affine_supports;
use super::branches::{BranchedCells, CellBranches, time_exponent};
use super::mixed_cells::{MixedCell, MixedCellsError, mixed_cells};
use crate::chart::exact;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::roots_of_unity::on_the_circle;
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::polynomial::PolynomialWithNumbers;
use cognate_systems::system::System;
use num_complex::Complex64;
use rug::Integer;
use rug::ops::RemRounding;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Most operations that are spent on the mixed cells of a system that is solved, where they were
/// not counted in branches.
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

    /// The supports: `supports[equation][term][variable]`.
    pub fn supports(&self) -> &[Vec<Vec<i64>>] {
        &self.supports
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
        let mut coefficients = self.coefficients();
        for (support, &equation) in self.supports.iter().zip(&system.equations) {
            let (n, p) = (system.variable_count(), parameters.len());
            let other = PolynomialWithNumbers::expand(&system.expressions, equation, n, p);
            let other = other.map_or_else(Default::default, |f| {
                f.coefficients_at(&system.expressions, parameters)
            });
            for (point, g) in support.iter().zip(coefficients.by_ref()) {
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

/// Mixed cells, ascending, each with the index of its first start point.
#[derive(Debug)]
struct CellList {
    cells: Vec<MixedCell>,
    offsets: Vec<u64>,
    /// The index after the last.
    end: u64,
}

impl CellList {
    /// The first start point of all has the index `first`.
    fn new(cells: Vec<MixedCell>, first: u64) -> Self {
        let mut end = first;
        let offsets = cells.iter().map(|cell| {
            let offset = end;
            end = end.saturating_add(cell.volume);
            offset
        });
        Self {
            offsets: offsets.collect(),
            cells,
            end,
        }
    }

    /// The cell of a start point, and its number in it.
    fn locate(&self, index: u64) -> Option<(&MixedCell, u64)> {
        let place = self.offsets.partition_point(|&offset| offset <= index);
        let place = place.checked_sub(1)?;
        (index < self.end).then(|| (&self.cells[place], index - self.offsets[place]))
    }

    /// About as much memory as this, in bytes.
    fn size(&self) -> usize {
        let of_cell = |cell: &MixedCell| {
            size_of::<(MixedCell, u64)>() + size_of_val(&*cell.edges) + size_of_val(&*cell.normal)
        };
        self.cells.first().map_or(0, of_cell) * self.cells.len()
    }
}

/// Branches are held while the cells of all that are take less than this, in bytes; the one that
/// is used is held anyway.
const HELD_BYTES: usize = 64 << 20;

/// A branch that is held, or being enumerated; `None` where its cells are not those that were
/// counted.
type Held = Arc<OnceLock<Option<CellList>>>;

/// A subdivision in branches, which are enumerated when their start points are asked for.
#[derive(Debug)]
struct Branched {
    cells: BranchedCells,
    /// Index of the first start point of each branch, and the number of all.
    offsets: Vec<u64>,
    time_exponent: u32,
    /// The most recently used last.
    held: Mutex<Vec<(u64, Held)>>,
}

impl Branched {
    /// The branch of a start point. Threads that ask for the same one wait for one of them.
    fn list(&self, index: u64) -> Option<Held> {
        let branch = self.offsets.partition_point(|&offset| offset <= index);
        let branch = branch.checked_sub(1)?;
        let (first, end) = (self.offsets[branch], *self.offsets.get(branch + 1)?);
        let branch = branch as u64;
        let list = {
            let mut held = self.lock();
            let position = held.iter().rposition(|(number, _)| *number == branch);
            let list = position.map_or_else(Held::default, |place| held.remove(place).1);
            held.push((branch, Arc::clone(&list)));
            list
        };
        if list.get().is_none() {
            list.get_or_init(|| {
                let list = CellList::new(self.cells.cells(branch)?, first);
                (list.end == end).then_some(list)
            });
            self.make_room(HELD_BYTES);
        }
        Some(list)
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(u64, Held)>> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets go of the branches that were not used for the longest time, where all take more bytes.
    fn make_room(&self, most: usize) {
        let mut held = self.lock();
        let mut size = 0;
        let mut fits = |(_, list): &(u64, Held)| {
            size += list
                .get()
                .and_then(Option::as_ref)
                .map_or(0, CellList::size);
            size <= most
        };
        let kept = held
            .iter()
            .rev()
            .take_while(|held| fits(held))
            .count()
            .max(1);
        let excess = held.len().saturating_sub(kept);
        held.drain(..excess);
    }
}

/// The mixed cells of a generic system: where its toric homotopy begins.
#[derive(Debug)]
pub struct ToricStart {
    generic: GenericSystem,
    cells: Cells,
}

/// All cells, or where they are found.
#[derive(Debug)]
enum Cells {
    Whole {
        list: CellList,
        lifting: Vec<Vec<i64>>,
    },
    Branched(Branched),
}

impl ToricStart {
    /// Enumerates the cells; a function of supports and seed alone.
    pub fn new(generic: GenericSystem, seed: u64) -> Result<Self, MixedCellsError> {
        let enumeration = mixed_cells(&generic.supports, seed, SOLVING_OPERATIONS)?;
        let cells = Cells::Whole {
            list: CellList::new(enumeration.cells, 0),
            lifting: enumeration.lifting,
        };
        Ok(Self { generic, cells })
    }

    /// Prepares a start from cells that were counted in branches; each branch is enumerated when a start point in it is
    /// asked for.
    pub fn branched(
        generic: GenericSystem,
        seed: u64,
        counted: &CellBranches,
    ) -> Result<Self, MixedCellsError> {
        let cells = BranchedCells::new(&generic.supports, seed, counted.lifting)?;
        let mut offsets = vec![0u64];
        for volume in &counted.volumes {
            let end = offsets[offsets.len() - 1].checked_add(*volume);
            offsets.push(end.ok_or(MixedCellsError::TooLarge)?);
        }
        let cells = Cells::Branched(Branched {
            cells: cells.ok_or(MixedCellsError::NoLifting)?,
            offsets,
            time_exponent: counted.time_exponent,
            held: Mutex::default(),
        });
        Ok(Self { generic, cells })
    }

    /// The system whose solutions the toric homotopy finds.
    pub fn generic(&self) -> &GenericSystem {
        &self.generic
    }

    /// Number of start points: the mixed volume.
    pub fn count(&self) -> u64 {
        match &self.cells {
            Cells::Whole { list, .. } => list.end,
            Cells::Branched(branched) => branched.offsets.last().copied().unwrap_or(0),
        }
    }

    /// Applies `with` to the cell of a start point and to the number of the start point in this cell; `None` where the
    /// branch has other cells than were counted.
    fn at<T>(&self, index: u64, with: impl FnOnce(&MixedCell, u64) -> T) -> Option<T> {
        let held;
        let list = match &self.cells {
            Cells::Whole { list, .. } => list,
            Cells::Branched(branched) => {
                held = branched.list(index)?;
                held.get()?.as_ref()?
            }
        };
        let (cell, number) = list.locate(index)?;
        Some(with(cell, number))
    }

    /// The weights of the cell of a start point (see [`MixedCell::weights`]).
    pub fn weights(&self, index: u64) -> Vec<f64> {
        let lifting = match &self.cells {
            Cells::Whole { lifting, .. } => lifting,
            Cells::Branched(branched) => branched.cells.lifting(),
        };
        let supports = &self.generic.supports;
        let weights = self.at(index, |cell, _| cell.weights(supports, lifting));
        // Where there is no cell there is no start point either.
        weights.unwrap_or_else(|| vec![0.0; supports.iter().map(Vec::len).sum()])
    }

    /// The power that suits the weights of all cells (see [`time_exponent`]).
    pub fn time_exponent(&self) -> u32 {
        match &self.cells {
            Cells::Whole { list, lifting } => {
                let cells = list.cells.iter();
                let weights = cells.flat_map(|cell| cell.weights(&self.generic.supports, lifting));
                time_exponent(weights.fold(1.0, f64::max))
            }
            Cells::Branched(branched) => branched.time_exponent,
        }
    }

    /// Start point number `index`: a solution of the binomial system of its cell; `None` where its
    /// branch has other cells than were counted.
    pub fn point(&self, index: u64) -> Option<Vec<Complex64>> {
        self.at(index, |cell, number| self.generic.point(cell, number))
    }
}

impl GenericSystem {
    /// Solution number `number` of the binomial system of a mixed cell.
    fn point(&self, cell: &MixedCell, number: u64) -> Vec<Complex64> {
        let n = self.supports.len();
        let mut matrix = Vec::with_capacity(n);
        let mut right = Vec::with_capacity(n);
        for (i, &[a, b]) in cell.edges.iter().enumerate() {
            let (a, b) = (a as usize, b as usize);
            let support = &self.supports[i];
            matrix.push(
                (0..n)
                    .map(|j| Integer::from(support[b][j] - support[a][j]))
                    .collect::<Vec<Integer>>(),
            );
            // x^(b-a) = -c_a / c_b.
            let angles = &self.angles[i];
            right.push(angles[a].wrapping_sub(angles[b]).wrapping_add(1 << 127));
        }
        let transform = hermite(&mut matrix);
        // In z with x = z^transform the system is triangular: one root after the other.
        let mut rest = number;
        let mut z: Vec<Integer> = Vec::with_capacity(n);
        let turn = Integer::from(1) << 128;
        for i in 0..n {
            let mut angle = Integer::from(right[i]);
            for (entry, z) in matrix[i].iter().zip(&z) {
                angle -= Integer::from(entry * z);
            }
            let degree = &matrix[i][i];
            let degree_word = degree.to_u64().expect("it divides the volume");
            let angle = angle.rem_euc(&turn) + (Integer::from(rest % degree_word) << 128);
            rest /= degree_word;
            z.push(angle / degree);
        }
        (0..n)
            .map(|j| {
                let mut angle = Integer::new();
                for (entry, z) in transform[j].iter().zip(&z) {
                    angle += Integer::from(entry * z);
                }
                let angle: Integer = angle.rem_euc(&turn);
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
    use crate::start_systems::polyhedral::branches::BranchCount;
    use crate::start_systems::polyhedral::counting::CountingStage;
    use crate::tracker::outcome::{Failure, PathOutcome};
    use crate::tracker::settings::Settings;
    use crate::work::{Stage, Work};
    use cognate_systems::named::cyclic;

    fn toric(system: &System, count: u64) -> Result<PreparedStage, PrepareError> {
        in_branches(system, count, None)
    }

    fn in_branches(
        system: &System,
        count: u64,
        branches: Option<CellBranches>,
    ) -> Result<PreparedStage, PrepareError> {
        let stage = Stage::new(
            Work::Track,
            HomotopyKind::Toric,
            StartPoints::MixedCells { count, branches },
            Settings::default(),
            4,
        );
        PreparedStage::new(system, &stage, &|_| None)
    }

    #[test]
    fn toric_paths_are_the_same_at_every_width_and_end_regular() {
        let system = cyclic(5).system;
        let stage = toric(&system, 70).expect("the mixed volume is 70");
        let results = stage.track(0..70, 8);
        assert!(results.iter().all(|r| r.outcome == PathOutcome::Regular));
        for width in [1, 16] {
            let mut parts = stage.track(0..33, width);
            parts.extend(stage.track(33..70, width));
            assert_eq!(parts, results, "width {width}");
        }
    }

    /// Counts the cells of all branches of a system with seed 4, as workers do.
    fn counted(system: &System) -> CellBranches {
        let stage = Stage::new(
            Work::CountMixedCells,
            HomotopyKind::Toric,
            StartPoints::MixedCells {
                count: 0,
                branches: Some(CellBranches::uncounted(0)),
            },
            Settings::default(),
            4,
        );
        assert!(PreparedStage::new(system, &stage, &|_| None).is_err());
        let counting = CountingStage::new(system, &stage).expect("a stage that counts");
        let mut counted = CellBranches::uncounted(0);
        for (branch, result) in (0..).zip(counting.run(0..counting.items())) {
            assert_eq!(result.origin.0, branch);
            let Some(&BranchCount::Counted(cells)) = result.fact() else {
                panic!("{result:?}");
            };
            counted.volumes.push(cells.volume);
            counted.time_exponent = counted.time_exponent.max(cells.time_exponent);
        }
        assert!(counted.is_sound(70));
        counted
    }

    #[test]
    fn paths_from_branches_are_the_same_at_every_width_and_end_regular() {
        let system = cyclic(5).system;
        let counted = counted(&system);
        let stage = in_branches(&system, 70, Some(counted.clone())).expect("a stage");
        let results = stage.track(0..70, 8);
        assert!(results.iter().all(|r| r.outcome == PathOutcome::Regular));
        for width in [1, 16] {
            // The later ones first, and from nothing.
            let stage = in_branches(&system, 70, Some(counted.clone())).expect("a stage");
            let late = stage.track(33..70, width);
            let mut parts = stage.track(0..33, width);
            parts.extend(late);
            assert_eq!(parts, results, "width {width}");
        }
    }

    #[test]
    fn branches_with_other_cells_than_were_counted_give_no_start_points() {
        let system = cyclic(5).system;
        let mut counted = counted(&system);
        // A path of one branch is said to be of another.
        let full = counted.volumes.iter().position(|&volume| volume > 0);
        let empty = counted.volumes.iter().position(|&volume| volume == 0);
        counted.volumes[full.expect("there are cells")] -= 1;
        counted.volumes[empty.expect("there are few cells")] += 1;
        let stage = in_branches(&system, 70, Some(counted)).expect("the sum is right");
        let results = stage.track(0..70, 8);
        let lost = PathOutcome::Failed(Failure::InvalidStartPoint);
        let lost = results.iter().filter(|r| r.outcome == lost).count();
        assert!((2..70).contains(&lost), "{lost}");
    }

    #[test]
    fn branches_make_room_for_one_another() {
        let supports = vec![vec![vec![0, 0], vec![1, 0]], vec![vec![0, 0], vec![0, 1]]];
        let cells = BranchedCells::new(&supports, 0, 0).ok().flatten();
        let held = |branch: u64, size: usize| {
            let cell = MixedCell {
                edges: vec![[0; 2]; 2],
                volume: 1,
                normal: vec![0; 2],
            };
            let list = Held::default();
            let _ = list.set(Some(CellList::new(vec![cell; size], 0)));
            (branch, list)
        };
        let branched = Branched {
            cells: cells.expect("a generic lifting"),
            offsets: vec![0],
            time_exponent: 1,
            held: Mutex::new(vec![held(0, 90), held(1, 1), held(2, 90), held(3, 1)]),
        };
        let of_hundred = held(0, 100)
            .1
            .get()
            .and_then(Option::as_ref)
            .map(CellList::size);
        let most = of_hundred.expect("a list");
        branched.make_room(most);
        let kept = |branched: &Branched| -> Vec<u64> {
            branched.lock().iter().map(|(branch, _)| *branch).collect()
        };
        assert_eq!(kept(&branched), [1, 2, 3]);
        branched.lock().push(held(4, 200));
        branched.make_room(most);
        assert_eq!(kept(&branched), [4]);
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
        let mut start_points: Vec<Vec<Complex64>> = Vec::new();
        for index in 0..start.count() {
            let x = start.point(index).expect("it is in a cell");
            let cell = start.at(index, |cell, _| cell.clone());
            let weights = start.weights(index);
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
            for (other, y) in start_points.iter().enumerate() {
                let same = start.at(other as u64, |cell, _| cell.clone()) == cell;
                assert!(!same || distance(y) > 1e-3);
            }
            start_points.push(x);
        }
    }
}
