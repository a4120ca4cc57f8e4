//! Branches: the enumeration of mixed cells cut into parts, each of which is found alone.
//!
//! Every mixed cell comes from one cell by exchanges, a tree that falls apart wherever a cell falls
//! in two. Its first open cells, the least advanced followed first, are dealt out to [`BRANCHES`]
//! branches: which cell comes from which branch is a function of supports, seed and lifting alone,
//! so workers enumerate different branches, and nobody holds the cells of more than a few.

use super::exact::Exact;
use super::mixed_cells::{
    Cell, Followed, MOST_LIFTINGS, MixedCell, MixedCellsError, Stop, Tuple, check, lifted,
};
use rug::Integer;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Number of branches; where there are few cells, some are empty.
pub const BRANCHES: u64 = 1024;

/// Open cells that are dealt out: several to each branch, so that branches are more alike. Of
/// cyclic-13 the longest branch then takes 2 % of all time, 5 % with half as many.
const OPEN_CELLS: usize = 8 * BRANCHES as usize;

/// Upper bound of all liftings: large enough that 10^9 events hardly have a tie, and small enough that machine words
/// hold the numbers that are computed from liftings.
const LIFTING_RANGE: u64 = 1 << 36;

/// Computes the bound of the liftings of these supports: lower than [`LIFTING_RANGE`] where degrees are so high that a
/// machine word would not hold their product.
fn lifting_range(supports: &[Vec<Vec<i64>>]) -> u64 {
    let extent = |support: &Vec<Vec<i64>>, j: usize| {
        let coordinates = || support.iter().map(|point| point[j]);
        let (least, most) = (coordinates().min(), coordinates().max());
        most.zip(least)
            .map_or(0, |(most, least)| most.abs_diff(least))
    };
    let degree = |support| (0..supports.len()).map(|j| extent(support, j)).sum::<u64>();
    let degree = supports.iter().map(degree).max().unwrap_or(0).max(1);
    LIFTING_RANGE.min((1 << 60) / degree).max(1 << 20)
}

/// The lifting of a subdivision and the number of start points in each of its branches. Pure data, which travels with a
/// stage.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellBranches {
    /// Number of liftings with ties before this one.
    pub lifting: u32,
    /// The volume of each branch, [`BRANCHES`] of them; empty while they are counted.
    pub volumes: Vec<u64>,
    /// The power that suits the weights of all cells (see `ToricPath`); 0 while they are counted.
    pub time_exponent: u32,
}

impl CellBranches {
    /// Branches that are still to be counted.
    pub fn uncounted(lifting: u32) -> Self {
        Self {
            lifting,
            volumes: Vec::new(),
            time_exponent: 0,
        }
    }

    /// Whether these numbers can be those of a subdivision with this mixed volume.
    pub fn is_sound(&self, mixed_volume: u64) -> bool {
        let sum = self
            .volumes
            .iter()
            .try_fold(0u64, |sum, &volume| sum.checked_add(volume));
        let counted = match self.volumes.len() as u64 {
            0 => self.time_exponent == 0,
            BRANCHES => (1..=MOST_TIME_EXPONENT).contains(&self.time_exponent),
            _ => false,
        };
        counted && self.lifting < MOST_LIFTINGS && sum == Some(mixed_volume)
    }
}

/// Result of the count of one branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BranchCount {
    /// Counts over all cells of the branch.
    Counted(CountedCells),
    /// Two points came down to a cell at once: the lifting is not generic.
    Tie,
    /// A cell does not fit in its numbers: 64 bits for the volume, 96 for the normal.
    TooLarge,
}

/// The cells of a branch, counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CountedCells {
    /// Mixed cells whose first choices are those of the branch.
    pub cells: u64,
    /// The sum of their volumes: how many start points they have.
    pub volume: u64,
    /// The power that suits their weights, from 1 to [`MOST_TIME_EXPONENT`].
    pub time_exponent: u32,
}

/// The largest power of [`time_exponent`].
pub const MOST_TIME_EXPONENT: u32 = 4;

/// The power q of `s = 1 - t^q` that spreads weights up to this one over t: the number of decimal
/// places of the largest one, at most [`MOST_TIME_EXPONENT`].
pub fn time_exponent(largest: f64) -> u32 {
    (1..MOST_TIME_EXPONENT)
        .find(|&q| largest <= 10f64.powi(q as i32))
        .unwrap_or(MOST_TIME_EXPONENT)
}

/// Open cells in the narrowest integers that hold all of them.
#[derive(Debug)]
enum OpenCells {
    Word(Vec<Cell<i64>>),
    Double(Vec<Cell<i128>>),
    Any(Vec<Cell<Integer>>),
}

/// A subdivision of which no cells are held but the open ones from which the others come.
#[derive(Debug)]
pub struct BranchedCells {
    supports: Vec<Vec<Vec<i64>>>,
    lifting: Vec<Vec<i64>>,
    tuple: Tuple,
    open: OpenCells,
    /// Cells that were found before there were open ones enough.
    early: Vec<MixedCell>,
}

/// The part of a list that belongs to a branch.
fn dealt<T>(list: &[T], branch: u64) -> impl Iterator<Item = &T> {
    list.iter().skip(branch as usize).step_by(BRANCHES as usize)
}

/// True where wider integers may serve.
fn overflown<T>(enumeration: &Result<T, Stop>) -> bool {
    matches!(enumeration, Err(Stop::Overflow))
}

impl BranchedCells {
    /// The branches of a random lifting, before which `lifting` others had ties; the seed decides it. `Ok(None)` where
    /// this lifting has a tie already.
    pub fn new(
        supports: &[Vec<Vec<i64>>],
        seed: u64,
        attempt: u32,
    ) -> Result<Option<Self>, MixedCellsError> {
        check(supports)?;
        let (lifting, tuple) = lifted(supports, seed, attempt, lifting_range(supports));
        match Self::of(supports, lifting, tuple, OPEN_CELLS) {
            Ok(branches) => Ok(Some(branches)),
            Err(Stop::Tie | Stop::Overflow) => Ok(None),
            Err(Stop::Error(error)) => Err(error),
        }
    }

    fn of(
        supports: &[Vec<Vec<i64>>],
        lifting: Vec<Vec<i64>>,
        tuple: Tuple,
        wanted: usize,
    ) -> Result<Self, Stop> {
        let mut enumeration =
            open_cells(&tuple, wanted).map(|(open, early)| (OpenCells::Word(open), early));
        if overflown(&enumeration) {
            enumeration =
                open_cells(&tuple, wanted).map(|(open, early)| (OpenCells::Double(open), early));
        }
        if overflown(&enumeration) {
            enumeration =
                open_cells(&tuple, wanted).map(|(open, early)| (OpenCells::Any(open), early));
        }
        let (open, early) = enumeration?;
        Ok(Self {
            supports: supports.to_vec(),
            lifting,
            tuple,
            open,
            early,
        })
    }

    /// Goes through the mixed cells of a branch in an order that is always the same. Where numbers
    /// outgrow their type it begins again with wider ones, and so `begin` is called again.
    fn fold<S>(
        &self,
        branch: u64,
        begin: impl Fn() -> S,
        add: impl Fn(&mut S, MixedCell) -> Result<(), Stop>,
    ) -> Result<S, Stop> {
        let early = || {
            let mut sum = begin();
            for cell in dealt(&self.early, branch) {
                add(&mut sum, cell.clone())?;
            }
            Ok(sum)
        };
        let mut branch_sum = match &self.open {
            OpenCells::Word(open) => self.below(dealt(open, branch).cloned(), early()?, &add),
            OpenCells::Double(_) | OpenCells::Any(_) => Err(Stop::Overflow),
        };
        if overflown(&branch_sum) {
            branch_sum = match &self.open {
                OpenCells::Word(open) => {
                    let open = dealt(open, branch).cloned();
                    self.below(open.map(Cell::widened::<i128>), early()?, &add)
                }
                OpenCells::Double(open) => self.below(dealt(open, branch).cloned(), early()?, &add),
                OpenCells::Any(_) => Err(Stop::Overflow),
            };
        }
        if overflown(&branch_sum) {
            branch_sum = match &self.open {
                OpenCells::Word(open) => {
                    let open = dealt(open, branch).cloned();
                    self.below(open.map(Cell::widened::<Integer>), early()?, &add)
                }
                OpenCells::Double(open) => {
                    let open = dealt(open, branch).cloned();
                    self.below(open.map(Cell::widened::<Integer>), early()?, &add)
                }
                OpenCells::Any(open) => self.below(dealt(open, branch).cloned(), early()?, &add),
            };
        }
        branch_sum
    }

    fn below<T: Exact, S>(
        &self,
        open: impl Iterator<Item = Cell<T>>,
        mut sum: S,
        add: &impl Fn(&mut S, MixedCell) -> Result<(), Stop>,
    ) -> Result<S, Stop> {
        // Nobody waits for a worker by a clock: it tells that it lives beside its work.
        let mut operations = u64::MAX;
        for cell in open {
            self.tuple
                .below(cell, &mut operations, &mut |cell| add(&mut sum, cell))?;
        }
        Ok(sum)
    }

    /// Counts the cells of a branch, and holds none of them.
    pub fn count(&self, branch: u64) -> BranchCount {
        let begin = || CountedCells {
            cells: 0,
            volume: 0,
            time_exponent: 1,
        };
        let counted = self.fold(branch, begin, |sum, cell| {
            let volume = sum.volume.checked_add(cell.volume);
            sum.volume = volume.ok_or(Stop::Error(MixedCellsError::TooLarge))?;
            sum.cells += 1;
            let weights = cell.weights(&self.supports, &self.lifting).into_iter();
            let exponent = time_exponent(weights.fold(1.0, f64::max));
            sum.time_exponent = sum.time_exponent.max(exponent);
            Ok(())
        });
        match counted {
            Ok(counted) => BranchCount::Counted(counted),
            Err(Stop::Tie) => BranchCount::Tie,
            Err(Stop::Overflow | Stop::Error(_)) => BranchCount::TooLarge,
        }
    }

    /// The mixed cells of a branch, ascending; `None` where there is a tie or one is too large.
    pub fn cells(&self, branch: u64) -> Option<Vec<MixedCell>> {
        let branch_cells = self.fold(branch, Vec::new, |cells, cell| {
            cells.push(cell);
            Ok(())
        });
        let mut cells = branch_cells.ok()?;
        cells.sort_unstable();
        cells.shrink_to_fit();
        Some(cells)
    }

    /// The lifting of all supports: `lifting[support][place]`.
    pub fn lifting(&self) -> &[Vec<i64>] {
        &self.lifting
    }
}

/// Finds at least `wanted` open cells, or none where all cells are found, and the mixed cells that were found on the
/// way. A cell of the earliest stage is followed first, of several the oldest one, until it falls in two or enters the
/// next stage.
fn open_cells<T: Exact>(
    tuple: &Tuple,
    wanted: usize,
) -> Result<(Vec<Cell<T>>, Vec<MixedCell>), Stop> {
    let mut operations = u64::MAX;
    let mut open: Vec<VecDeque<Cell<T>>> = (0..tuple.n).map(|_| VecDeque::new()).collect();
    let mut early = Vec::new();
    let mut count = 1;
    open[0].push_back(tuple.first()?);
    while count < wanted {
        let Some(mut cell) = open.iter_mut().find_map(VecDeque::pop_front) else {
            break;
        };
        count -= 1;
        let stage = cell.stage;
        loop {
            match tuple.follow(cell, &mut operations)? {
                Followed::Mixed(mixed_cell) => {
                    early.push(mixed_cell);
                    break;
                }
                Followed::Open(Some(next), None) if next.stage == stage => cell = next,
                Followed::Open(one, other) => {
                    for next in [one, other].into_iter().flatten() {
                        count += 1;
                        open[next.stage].push_back(next);
                    }
                    break;
                }
            }
        }
    }
    Ok((open.into_iter().flatten().collect(), early))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::start_systems::polyhedral::mixed_cells::mixed_cells;
    use cognate_numeric::random::{Purpose, RandomStream};

    type Supports = Vec<Vec<Vec<i64>>>;

    fn cyclic(n: usize) -> Supports {
        let mut supports: Supports = (1..n)
            .map(|degree| {
                let term = |first: usize| {
                    let mut point = vec![0; n];
                    (0..degree).for_each(|k| point[(first + k) % n] = 1);
                    point
                };
                (0..n).map(term).collect()
            })
            .collect();
        supports.push(vec![vec![1; n], vec![0; n]]);
        supports
    }

    /// Supports of `points` random points with exponents below `most`.
    fn random(seed: u64, n: usize, points: usize, most: u64) -> Supports {
        let mut stream = RandomStream::new(seed, Purpose::Test, 40);
        let mut support = || -> Vec<Vec<i64>> {
            let mut exponents: Vec<Vec<i64>> = (0..points)
                .map(|_| (0..n).map(|_| stream.below(most) as i64).collect())
                .collect();
            exponents.sort_unstable();
            exponents.dedup();
            exponents
        };
        (0..n).map(|_| support()).collect()
    }

    fn branches(supports: &Supports, seed: u64, wanted: usize) -> BranchedCells {
        // As the whole has it.
        let (lifting, tuple) = lifted(supports, seed, 0, 1 << 20);
        BranchedCells::of(supports, lifting, tuple, wanted).expect("a generic lifting")
    }

    /// All cells of all branches, ascending; each branch counted as it is enumerated.
    fn together(branches: &BranchedCells) -> (Vec<MixedCell>, u64) {
        let mut cells_of_branches = Vec::new();
        let mut volume = 0;
        for branch in 0..BRANCHES {
            let cells = branches.cells(branch).expect("no tie");
            assert!(cells.is_sorted());
            let BranchCount::Counted(counted) = branches.count(branch) else {
                panic!("branch {branch} is not counted");
            };
            let branch_volume: u64 = cells.iter().map(|cell| cell.volume).sum();
            assert_eq!(
                (counted.cells, counted.volume),
                (cells.len() as u64, branch_volume)
            );
            volume += counted.volume;
            cells_of_branches.extend(cells);
        }
        cells_of_branches.sort_unstable();
        (cells_of_branches, volume)
    }

    #[test]
    fn branches_together_are_the_whole_however_many_cells_are_open() {
        let mut cases = vec![cyclic(5), cyclic(7), cyclic(8)];
        cases.extend((0..4).map(|seed| random(seed, 4, 5, 6)));
        cases.extend((4..6).map(|seed| random(seed, 6, 6, 3)));
        for (seed, supports) in (0..).zip(&cases) {
            let whole = mixed_cells(supports, seed, u64::MAX).expect("it is small");
            for wanted in [1, 7, 100, OPEN_CELLS] {
                let branches = branches(supports, seed, wanted);
                assert_eq!(branches.lifting(), whole.lifting);
                let (cells, volume) = together(&branches);
                assert_eq!(cells, whole.cells, "{wanted} open cells of case {seed}");
                assert_eq!(volume, whole.mixed_volume);
            }
        }
    }

    #[test]
    fn open_cells_are_as_many_as_are_wanted_and_dealt_out_to_all_branches() {
        let branches = branches(&cyclic(9), 0, BRANCHES as usize);
        let OpenCells::Word(open) = &branches.open else {
            panic!("small numbers");
        };
        assert_eq!(open.len() as u64, BRANCHES);
        let volumes: Vec<u64> = (0..BRANCHES)
            .map(|branch| match branches.count(branch) {
                BranchCount::Counted(counted) => counted.volume,
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(volumes.iter().sum::<u64>(), 11_016);
        assert!(volumes.iter().all(|&volume| volume < 200));
    }

    #[test]
    fn a_tie_is_seen_where_it_is() {
        // Every lifting alike: the first two points come down at once.
        let supports = cyclic(6);
        let (mut lifting, _) = lifted(&supports, 0, 0, LIFTING_RANGE);
        lifting.iter_mut().flatten().for_each(|height| *height = 1);
        let stream = || RandomStream::new(0, Purpose::Lifting, 0);
        let tuple = || Tuple::new(&supports, &lifting, LIFTING_RANGE, stream());
        let early = BranchedCells::of(&supports, lifting.clone(), tuple(), OPEN_CELLS);
        assert!(matches!(early, Err(Stop::Tie)));
        let late = BranchedCells::of(&supports, lifting.clone(), tuple(), 1).expect("one cell");
        assert_eq!(late.count(0), BranchCount::Tie);
        assert_eq!(late.cells(0), None);
    }

    #[test]
    fn numbers_that_outgrow_a_word_widen_a_branch_alone() {
        // Degrees of 50,000 in four variables, as in the test of the whole.
        let n = 4;
        let supports: Supports = (0..n)
            .map(|i| {
                let unit = |j: usize, e: i64| (0..n).map(|k| if k == j { e } else { 0 }).collect();
                let mut exponents: Vec<Vec<i64>> = vec![vec![0; n], unit(i, 1)];
                exponents.extend((0..n).map(|j| unit(j, 50_000 - (i + j) as i64)));
                exponents
            })
            .collect();
        let whole = mixed_cells(&supports, 0, u64::MAX).expect("it fits in 64 bits");
        for wanted in [1, 3, OPEN_CELLS] {
            let branches = branches(&supports, 0, wanted);
            let narrow = matches!(branches.open, OpenCells::Word(_));
            assert_eq!(narrow, wanted == 1, "{wanted} open cells");
            assert_eq!(together(&branches).0, whole.cells);
        }
    }

    #[test]
    fn what_cannot_be_branches_is_told() {
        let sound = CellBranches {
            lifting: 0,
            volumes: vec![2; BRANCHES as usize],
            time_exponent: 3,
        };
        assert!(sound.is_sound(2 * BRANCHES));
        assert!(!sound.is_sound(7));
        assert!(CellBranches::uncounted(19).is_sound(0));
        assert!(!CellBranches::uncounted(20).is_sound(0));
        let huge = CellBranches {
            volumes: vec![u64::MAX; BRANCHES as usize],
            ..sound.clone()
        };
        assert!(!huge.is_sound(u64::MAX));
        let exponent = CellBranches {
            time_exponent: 0,
            ..sound
        };
        assert!(!exponent.is_sound(2 * BRANCHES));
    }
}
