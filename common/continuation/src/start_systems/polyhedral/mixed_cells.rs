//! Mixed cells of a lifted tuple of supports, by tropical homotopy continuation.
//!
//! A. Jensen, Tropical homotopy continuation, arXiv:1601.02818: a mixed cell
//! lives as long as every other point lies above the hyperplane through its
//! lifted edges; when a point comes down to it, the cell is exchanged for the
//! one or two on the other side. The supports take the place of simplices one
//! after the other (regeneration): while support k does, the corners of its
//! simplex rise from below everything to above everything. All of it in exact
//! integers, cell by cell, depth first, without a memory of other cells; so the
//! enumeration can be cut into parts (see `branches`).

use super::exact::Exact;
use cognate_numeric::interruption::count_work;
use cognate_numeric::random::{Purpose, RandomStream};
use rug::Integer;

/// Liftings are below this where all cells are enumerated at once.
const LIFTING_RANGE: u64 = 1 << 20;
/// Liftings that may turn out not to be generic before this is given up.
pub const MOST_LIFTINGS: u32 = 20;
/// Entries of the inverses of all cells that wait at once: half a GiB of machine words. What needs more
/// is given up as too long.
const MOST_OPEN_ENTRIES: usize = 1 << 26;
/// Exponents above this are not taken.
const MOST_EXPONENT: i64 = 1 << 20;

/// One mixed cell: an edge of every support.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MixedCell {
    /// For each support the places of the edge's ends in it, the smaller first.
    pub edges: Vec<[u32; 2]>,
    /// Volume of the cell: the number of solutions of its binomial system.
    pub volume: u64,
    /// Inner normal of the cell times its volume: over each support, volume times lifting plus the product with this
    /// vector is smallest at the ends of the edge.
    pub normal: Vec<i128>,
}

/// All mixed cells of one generic lifting.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MixedSubdivision {
    /// `lifting[support][place]`.
    pub lifting: Vec<Vec<i64>>,
    /// The cells, ascending.
    pub cells: Vec<MixedCell>,
    /// The mixed volume: the sum of their volumes.
    pub mixed_volume: u64,
}

/// Reason why there is no subdivision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MixedCellsError {
    /// The number of supports is not the number of variables, or one is empty.
    #[error("a mixed volume needs as many equations as variables, none of them 0")]
    Shape,
    /// Exponents out of range.
    #[error("an exponent is larger than {MOST_EXPONENT}")]
    Exponents,
    /// The operations that were allowed are used up.
    #[error("counting takes too long")]
    TooLong,
    /// The mixed volume is larger than a machine word.
    #[error("the mixed volume does not fit in 64 bits")]
    TooLarge,
    /// No lifting was generic; this does not happen by chance.
    #[error("no generic lifting was found")]
    NoLifting,
}

/// Reason why an enumeration ends early.
#[derive(Debug)]
pub(super) enum Stop {
    /// Two points came down at once: the lifting is not generic.
    Tie,
    /// A number outgrew its type.
    Overflow,
    Error(MixedCellsError),
}

/// The mixed cells of `supports[equation][term][variable]` for a random lifting.
///
/// `operations` bounds the work, about one for each multiplication, so that
/// the answer does not depend on a clock. Pure: the seed decides the lifting.
pub fn mixed_cells(
    supports: &[Vec<Vec<i64>>],
    seed: u64,
    operations: u64,
) -> Result<MixedSubdivision, MixedCellsError> {
    check(supports)?;
    let n = supports.len() as u64;
    let points: u64 = supports.iter().map(|support| support.len() as u64).sum();
    // Nothing is built that is not paid for.
    let building = n.saturating_mul(points.saturating_add(2 * n));
    let mut left = operations
        .checked_sub(building)
        .ok_or(MixedCellsError::TooLong)?;
    for attempt in 0..MOST_LIFTINGS {
        let (lifting, tuple) = lifted(supports, seed, attempt, LIFTING_RANGE);
        let mut enumeration = tuple.enumerate::<i64>(&mut left);
        if matches!(enumeration, Err(Stop::Overflow)) {
            enumeration = tuple.enumerate::<i128>(&mut left);
        }
        if matches!(enumeration, Err(Stop::Overflow)) {
            enumeration = tuple.enumerate::<Integer>(&mut left);
        }
        match enumeration {
            Ok(mut cells) => {
                cells.sort_unstable();
                let mixed_volume = cells
                    .iter()
                    .try_fold(0u64, |sum, cell| sum.checked_add(cell.volume))
                    .ok_or(MixedCellsError::TooLarge)?;
                return Ok(MixedSubdivision {
                    lifting,
                    cells,
                    mixed_volume,
                });
            }
            Err(Stop::Tie | Stop::Overflow) => {}
            Err(Stop::Error(error)) => return Err(error),
        }
    }
    Err(MixedCellsError::NoLifting)
}

/// Whether these are as many supports as variables, none empty, with exponents in range.
pub(super) fn check(supports: &[Vec<Vec<i64>>]) -> Result<(), MixedCellsError> {
    let n = supports.len();
    let fits = |point: &Vec<i64>| point.len() == n;
    if n == 0 || supports.iter().any(|s| s.is_empty() || !s.iter().all(fits)) {
        return Err(MixedCellsError::Shape);
    }
    let large = |&e: &i64| !(-MOST_EXPONENT..=MOST_EXPONENT).contains(&e);
    if supports.iter().flatten().flatten().any(large) {
        return Err(MixedCellsError::Exponents);
    }
    Ok(())
}

/// A random lifting below `range`, of which so many before had ties: `lifting[support][place]`, and
/// the supports with it.
pub(super) fn lifted(
    supports: &[Vec<Vec<i64>>],
    seed: u64,
    attempt: u32,
    range: u64,
) -> (Vec<Vec<i64>>, Tuple) {
    let attempt = u64::from(attempt) << 32;
    let lifting: Vec<Vec<i64>> = supports
        .iter()
        .enumerate()
        .map(|(i, support)| {
            let mut stream = RandomStream::new(seed, Purpose::Lifting, attempt | i as u64);
            support.iter().map(|_| stream.below(range) as i64).collect()
        })
        .collect();
    let stream = RandomStream::new(seed, Purpose::Lifting, attempt | 0xffff_ffff);
    let tuple = Tuple::new(supports, &lifting, range, stream);
    (lifting, tuple)
}

impl MixedCell {
    /// The exponent of s at every term of the toric homotopy of this cell, equation after
    /// equation: 0 at the ends of the cell's edges, elsewhere at least 1, and 1 at one term at
    /// least (where the cell is not all there is).
    pub fn weights(&self, supports: &[Vec<Vec<i64>>], lifting: &[Vec<i64>]) -> Vec<f64> {
        let volume = i128::from(self.volume);
        // Volume times the height above the cell, exactly.
        let mut heights = Vec::new();
        for ((support, lifting), edge) in supports.iter().zip(lifting).zip(&self.edges) {
            let height = |term: usize| {
                let lifted = volume * i128::from(lifting[term]);
                let along: i128 = support[term]
                    .iter()
                    .zip(&self.normal)
                    .map(|(&a, &v)| i128::from(a) * v)
                    .sum();
                lifted + along
            };
            let base = height(edge[0] as usize);
            heights.extend((0..support.len()).map(|term| height(term) - base));
        }
        let least = heights.iter().copied().filter(|&h| h > 0).min();
        let least = least.unwrap_or(1) as f64;
        heights.iter().map(|&h| h as f64 / least).collect()
    }
}

/// Points of one support, one after the other, and their liftings. Only the coordinates that are not 0
/// are held: the corners of all simplices together would have n^3.
#[derive(Clone, Debug, Default)]
struct Points {
    /// Variable and coordinate, ascending in each point.
    coordinates: Vec<(usize, i64)>,
    /// End of each point among the coordinates.
    ends: Vec<usize>,
    lifting: Vec<i64>,
}

impl Points {
    fn push(&mut self, point: impl Iterator<Item = i64>, lifting: i64) {
        let sparse = point.enumerate().filter(|&(_, c)| c != 0);
        self.coordinates.extend(sparse);
        self.ends.push(self.coordinates.len());
        self.lifting.push(lifting);
    }

    /// The origin, or a multiple of the unit vector of a variable.
    fn push_corner(&mut self, corner: Option<(usize, i64)>, lifting: i64) {
        self.coordinates.extend(corner);
        self.ends.push(self.coordinates.len());
        self.lifting.push(lifting);
    }

    fn point(&self, place: usize) -> &[(usize, i64)] {
        let begin = place.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.coordinates[begin..self.ends[place]]
    }

    /// All coordinates of one point less those of another, of `n` each.
    fn difference(&self, to: usize, from: usize, n: usize) -> Vec<i64> {
        let mut difference = vec![0; n];
        for &(j, c) in self.point(to) {
            difference[j] += c;
        }
        for &(j, c) in self.point(from) {
            difference[j] -= c;
        }
        difference
    }
}

/// A support in its three ages.
#[derive(Debug)]
struct Support {
    /// Index of the support among the supports that were given.
    given: usize,
    /// Degree of the support: that of the simplex around it.
    degree: i64,
    /// The points before the stage of the support: the corners of the standard simplex.
    simplex: Points,
    /// The points during the stage: those of the support, then the corners of the simplex of its degree.
    both: Points,
    /// The points after the stage: those of the support.
    points: Points,
}

/// Supports in the order in which they take the place of their simplices.
#[derive(Debug)]
pub(super) struct Tuple {
    pub(super) n: usize,
    supports: Vec<Support>,
    /// Largest sum of the absolute coordinates of a difference of two points.
    reach: i64,
    /// Liftings are below this.
    range: i64,
}

/// A mixed cell while it is followed, of some stage.
#[derive(Clone, Debug)]
pub(super) struct Cell<T> {
    /// Number of supports that have taken the place of their simplices.
    pub(super) stage: usize,
    /// Places of the ends of the edges in the points of the stage.
    edges: Vec<[usize; 2]>,
    /// Determinant of the edges, positive.
    volume: T,
    /// `inverse[j*n + i]`: volume times the coordinate along edge i of the unit vector j.
    inverse: Vec<T>,
}

impl<T> Cell<T> {
    /// Converts the cell to wider integers.
    pub(super) fn widened<U: From<T>>(self) -> Cell<U> {
        Cell {
            stage: self.stage,
            edges: self.edges,
            volume: self.volume.into(),
            inverse: self.inverse.into_iter().map(U::from).collect(),
        }
    }
}

/// Result of following an open cell one step further.
pub(super) enum Followed<T> {
    /// The cell went on, fell in two, or ended without a mixed cell.
    Open(Option<Cell<T>>, Option<Cell<T>>),
    /// The cell came to the end.
    Mixed(MixedCell),
}

impl Tuple {
    pub(super) fn new(
        supports: &[Vec<Vec<i64>>],
        lifting: &[Vec<i64>],
        range: u64,
        mut stream: RandomStream,
    ) -> Self {
        // Liftings of the simplices' corners at the beginning are below four times this.
        let corner_range = range / 4;
        let n = supports.len();
        let mut order: Vec<usize> = (0..n).collect();
        // Few points first: what they cut down is not carried along (cyclic-9 and
        // cyclic-10 take a third of the time that the order of the file takes).
        order.sort_by_key(|&i| (supports[i].len(), i));
        let mut reach = 0;
        let supports = order
            .into_iter()
            .enumerate()
            .map(|(place, given)| {
                let support = &supports[given];
                let least: Vec<i64> = (0..n)
                    .map(|j| support.iter().map(|p| p[j]).min().unwrap_or(0))
                    .collect();
                let mut points = Points::default();
                let mut degree = 1;
                for (point, &height) in support.iter().zip(&lifting[given]) {
                    let shifted = point.iter().zip(&least).map(|(p, l)| p - l);
                    degree = degree.max(shifted.clone().sum());
                    points.push(shifted, height);
                }
                reach = reach.max(2 * degree);
                // The origin and the corner of its own coordinate are low, so that
                // the edges between them are the one cell of all simplices.
                let mut corner = |j: Option<usize>| {
                    let low = j.is_none() || j == Some(place);
                    let height = stream.below(corner_range) as i64;
                    height + if low { 0 } else { 2 * corner_range as i64 }
                };
                let heights: Vec<i64> = (0..=n).map(|j| corner(j.checked_sub(1))).collect();
                let mut simplex = Points::default();
                let mut both = points.clone();
                for (j, &height) in heights.iter().enumerate() {
                    let unit = j.checked_sub(1);
                    simplex.push_corner(unit.map(|j| (j, 1)), height);
                    both.push_corner(unit.map(|j| (j, degree)), height * degree);
                }
                Support {
                    given,
                    degree,
                    simplex,
                    both,
                    points,
                }
            })
            .collect();
        Self {
            n,
            supports,
            reach,
            range: range as i64,
        }
    }

    fn points(&self, support: usize, stage: usize) -> &Points {
        let s = &self.supports[support];
        match support.cmp(&stage) {
            std::cmp::Ordering::Less => &s.points,
            std::cmp::Ordering::Equal => &s.both,
            std::cmp::Ordering::Greater => &s.simplex,
        }
    }

    /// The one cell from which all others come.
    pub(super) fn first<T: Exact>(&self) -> Result<Cell<T>, Stop> {
        let n = self.n;
        self.enter(Cell {
            stage: 0,
            edges: (0..n).map(|i| [0, i + 1]).collect(),
            volume: T::from(1),
            inverse: (0..n * n)
                .map(|k| T::from(i64::from(k / n == k % n)))
                .collect(),
        })
    }

    fn enumerate<T: Exact>(&self, operations: &mut u64) -> Result<Vec<MixedCell>, Stop> {
        let mut cells = Vec::new();
        self.below(self.first::<T>()?, operations, &mut |cell| {
            cells.push(cell);
            Ok(())
        })?;
        Ok(cells)
    }

    /// All mixed cells that come from an open one, depth first.
    pub(super) fn below<T: Exact>(
        &self,
        cell: Cell<T>,
        operations: &mut u64,
        visitor: &mut dyn FnMut(MixedCell) -> Result<(), Stop>,
    ) -> Result<(), Stop> {
        let most_open = MOST_OPEN_ENTRIES / (self.n * self.n).max(1);
        let exchanging = (self.n * self.n) as u64;
        let mut open = vec![cell];
        while let Some(mut cell) = open.pop() {
            loop {
                let before = *operations;
                let followed = self.follow(cell, operations)?;
                let work = before - *operations + exchanging;
                if open.len() > most_open || count_work(work) {
                    return Err(Stop::Error(MixedCellsError::TooLong));
                }
                match followed {
                    Followed::Open(stays, other) => {
                        open.extend(other);
                        match stays {
                            Some(next) => cell = next,
                            None => break,
                        }
                    }
                    Followed::Mixed(cell) => {
                        visitor(cell)?;
                        break;
                    }
                }
            }
        }
        Ok(())
    }

    /// An open cell until its next event.
    pub(super) fn follow<T: Exact>(
        &self,
        mut cell: Cell<T>,
        operations: &mut u64,
    ) -> Result<Followed<T>, Stop> {
        if let Some((support, place)) = self.next_event(&cell, operations)? {
            let (stays, other) = self.exchange(cell, support, place)?;
            return Ok(Followed::Open(stays, other));
        }
        let real = self.supports[cell.stage].points.lifting.len();
        if cell.edges[cell.stage].iter().any(|&place| place >= real) {
            return Ok(Followed::Open(None, None));
        }
        cell.stage += 1;
        if cell.stage == self.n {
            return Ok(Followed::Mixed(self.finished(&cell)?));
        }
        Ok(Followed::Open(Some(self.enter(cell)?), None))
    }

    fn finished<T: Exact>(&self, cell: &Cell<T>) -> Result<MixedCell, Stop> {
        let too_large = Stop::Error(MixedCellsError::TooLarge);
        let volume = cell.volume.to_i128().and_then(|v| u64::try_from(v).ok());
        let volume = volume.ok_or(too_large)?;
        let mut edges = vec![[0; 2]; self.n];
        for (support, &[a, b]) in self.supports.iter().zip(&cell.edges) {
            edges[support.given] = [a.min(b) as u32, a.max(b) as u32];
        }
        let rest = self.slopes(cell)?;
        // Small enough that no height above the cell overflows.
        let small = |v: &i128| v.unsigned_abs() < 1 << 96;
        let normal = rest.iter().map(|r| (-r.clone()).to_i128().filter(small));
        let normal: Option<Vec<i128>> = normal.collect();
        Ok(MixedCell {
            edges,
            volume,
            normal: normal.ok_or(Stop::Error(MixedCellsError::TooLarge))?,
        })
    }

    /// Slopes, times its volume, of the hyperplane through the lifted edges of a cell.
    fn slopes<T: Exact>(&self, cell: &Cell<T>) -> Result<Vec<T>, Stop> {
        let n = self.n;
        let rise: Vec<i64> = (0..n)
            .map(|i| {
                let lifting = &self.points(i, cell.stage).lifting;
                lifting[cell.edges[i][1]] - lifting[cell.edges[i][0]]
            })
            .collect();
        cell.inverse
            .chunks(n)
            .map(|row| {
                let mut sum = T::from(0);
                for (entry, &rise) in row.iter().zip(&rise) {
                    if !entry.leaves_room_for(rise) {
                        return Err(Stop::Overflow);
                    }
                    sum = sum + entry.clone() * T::from(rise);
                }
                match sum.leaves_room_for(self.reach) {
                    true => Ok(sum),
                    false => Err(Stop::Overflow),
                }
            })
            .collect()
    }

    /// Into the stage: the edge of its simplex grows to the simplex of its degree.
    fn enter<T: Exact>(&self, mut cell: Cell<T>) -> Result<Cell<T>, Stop> {
        let k = cell.stage;
        let support = &self.supports[k];
        let shift = support.points.lifting.len();
        cell.edges[k] = cell.edges[k].map(|place| place + shift);
        let degree = T::from(support.degree);
        cell.volume = cell.volume * degree.clone();
        let mut fits = cell.volume.is_entry();
        for (index, entry) in cell.inverse.iter_mut().enumerate() {
            if index % self.n != k {
                *entry = entry.clone() * degree.clone();
                fits &= entry.is_entry();
            }
        }
        if fits { Ok(cell) } else { Err(Stop::Overflow) }
    }

    /// The point that comes down to the cell first: its support and place.
    fn next_event<T: Exact>(
        &self,
        cell: &Cell<T>,
        operations: &mut u64,
    ) -> Result<Option<(usize, usize)>, Stop> {
        let (n, k) = (self.n, cell.stage);
        let zero = || T::from(0);
        let real = self.supports[k].points.lifting.len();
        let rising = |place: usize| i64::from(place >= real);
        let [alpha, beta] = cell.edges[k];
        let slope = rising(beta) - rising(alpha);
        // The hyperplane's slopes, times the volume, at rest and by the corners' rise.
        let rest = self.slopes(cell)?;
        let moving: Vec<T> = (0..n)
            .map(|j| cell.inverse[j * n + k].clone() * T::from(slope))
            .collect();
        if moving.iter().any(|m| !m.leaves_room_for(self.reach)) {
            return Err(Stop::Overflow);
        }
        if !cell.volume.leaves_room_for(8 * self.range) {
            return Err(Stop::Overflow);
        }
        let height = |slopes: &[T], point: &[(usize, i64)]| {
            let mut sum = zero();
            for &(j, c) in point {
                sum = sum + slopes[j].clone() * T::from(c);
            }
            sum
        };
        // (support, place, what is left, how fast it goes).
        let mut best: Option<(usize, usize, T, T)> = None;
        let mut tie = false;
        for support in 0..n {
            if slope == 0 && support != k {
                continue;
            }
            let points = self.points(support, k);
            let count = points.lifting.len();
            *operations = operations
                .checked_sub((count * n) as u64)
                .ok_or(Stop::Error(MixedCellsError::TooLong))?;
            let rise_at = |place: usize| if support == k { rising(place) } else { 0 };
            let [a, b] = cell.edges[support];
            let moving_base = height(&moving, points.point(a));
            let rest_base = height(&rest, points.point(a));
            for place in (0..count).filter(|&place| place != a && place != b) {
                let point = points.point(place);
                let speed = cell.volume.clone() * T::from(rise_at(place) - rise_at(a))
                    - (height(&moving, point) - moving_base.clone());
                if speed >= zero() {
                    continue;
                }
                let speed = -speed;
                let above = cell.volume.clone()
                    * T::from(points.lifting[place] - points.lifting[a])
                    - (height(&rest, point) - rest_base.clone());
                let order = match &best {
                    None => std::cmp::Ordering::Less,
                    Some((_, _, least, fastest)) => {
                        T::compare_fractions(&above, &speed, least, fastest)
                    }
                };
                match order {
                    std::cmp::Ordering::Less => {
                        best = Some((support, place, above, speed));
                        tie = false;
                    }
                    std::cmp::Ordering::Equal => tie = true,
                    std::cmp::Ordering::Greater => {}
                }
            }
        }
        if tie {
            return Err(Stop::Tie);
        }
        Ok(best.map(|(support, place, _, _)| (support, place)))
    }

    /// The cells on the other side of the wall where a point of `support` came down.
    ///
    /// Seen along the other edges, the point lies on the line of the edge:
    /// between its ends, and the edge falls in two; or beyond one end, and two
    /// edges, this one and the one from that end to the point, become one. Of
    /// those two cells only one goes on, by the order of the points.
    #[allow(clippy::type_complexity)]
    fn exchange<T: Exact>(
        &self,
        cell: Cell<T>,
        support: usize,
        place: usize,
    ) -> Result<(Option<Cell<T>>, Option<Cell<T>>), Stop> {
        let n = self.n;
        let points = self.points(support, cell.stage);
        let [alpha, beta] = cell.edges[support];
        let mut along = T::from(0);
        for (j, c) in points.difference(place, alpha, n).into_iter().enumerate() {
            along = along + cell.inverse[j * n + support].clone() * T::from(c);
        }
        let zero = T::from(0);
        if along > zero && along < cell.volume {
            let other = self.replace(cell.clone(), support, 0, place)?;
            let one = self.replace(cell, support, 1, place)?;
            return Ok((Some(one), Some(other)));
        }
        let (end, goes_on) = if along == zero {
            (0, true)
        } else if along == cell.volume {
            (1, true)
        } else if along > zero {
            (1, alpha < place)
        } else {
            (0, beta < place)
        };
        let next = match goes_on {
            true => Some(self.replace(cell, support, end, place)?),
            false => None,
        };
        Ok((next, None))
    }

    /// The cell with one end of an edge replaced by another point.
    fn replace<T: Exact>(
        &self,
        mut cell: Cell<T>,
        support: usize,
        end: usize,
        place: usize,
    ) -> Result<Cell<T>, Stop> {
        let n = self.n;
        if end == 0 {
            // The two ends of the edge are exchanged.
            cell.edges[support].swap(0, 1);
            for j in 0..n {
                let entry = &mut cell.inverse[j * n + support];
                *entry = -entry.clone();
            }
        }
        let points = self.points(support, cell.stage);
        let edge = points.difference(place, cell.edges[support][0], n);
        // Volume times the coordinates of the new edge along the old ones.
        let mut along = vec![T::from(0); n];
        for (j, c) in edge.into_iter().enumerate() {
            if c == 0 {
                continue;
            }
            for (sum, entry) in along.iter_mut().zip(&cell.inverse[j * n..(j + 1) * n]) {
                if !entry.leaves_room_for(self.reach) {
                    return Err(Stop::Overflow);
                }
                *sum = sum.clone() + entry.clone() * T::from(c);
            }
        }
        let zero = T::from(0);
        let negative = along[support] < zero;
        if negative {
            for a in &mut along {
                *a = -a.clone();
            }
        }
        let volume = along[support].clone();
        let mut fits = along.iter().all(T::is_entry);
        if fits {
            let divisor = cell.volume.divisor();
            for row in cell.inverse.chunks_mut(n) {
                let pivot = row[support].clone();
                for (i, (entry, along)) in row.iter_mut().zip(&along).enumerate() {
                    if i == support {
                        continue;
                    }
                    let product = volume.clone() * entry.clone() - along.clone() * pivot.clone();
                    *entry = product.divide(&divisor);
                    fits &= entry.is_entry();
                }
                if negative {
                    row[support] = -pivot;
                }
            }
        }
        if !fits {
            return Err(Stop::Overflow);
        }
        cell.volume = volume;
        cell.edges[support][1] = place;
        Ok(cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn units(n: usize, terms: &[&[usize]]) -> Vec<Vec<i64>> {
        let point = |term: &&[usize]| {
            (0..n)
                .map(|j| term.iter().filter(|&&v| v == j).count() as i64)
                .collect()
        };
        terms.iter().map(point).collect()
    }

    fn cyclic(n: usize) -> Vec<Vec<Vec<i64>>> {
        let mut supports: Vec<Vec<Vec<i64>>> = (1..n)
            .map(|degree| {
                (0..n)
                    .map(|first| {
                        let mut point = vec![0; n];
                        for k in 0..degree {
                            point[(first + k) % n] = 1;
                        }
                        point
                    })
                    .collect()
            })
            .collect();
        supports.push(vec![vec![1; n], vec![0; n]]);
        supports
    }

    fn volume(supports: &[Vec<Vec<i64>>]) -> u64 {
        let cells = mixed_cells(supports, 0, u64::MAX);
        match cells {
            Ok(cells) => cells.mixed_volume,
            Err(error) => panic!("{error}"),
        }
    }

    /// Checks mixed volumes by hand: areas of sums less areas of summands.
    #[test]
    fn small_mixed_volumes() {
        // Two quadrics; a line and a cubic; an edge that is met by nothing.
        let dense = |d: i64| -> Vec<Vec<i64>> {
            (0..=d)
                .flat_map(|i| (0..=d - i).map(move |j| vec![i, j]))
                .collect()
        };
        assert_eq!(volume(&[dense(2), dense(2)]), 4);
        assert_eq!(volume(&[dense(1), dense(3)]), 3);
        let x = vec![vec![0, 0], vec![3, 0]];
        assert_eq!(volume(&[x.clone(), x.clone()]), 0);
        assert_eq!(volume(&[x, vec![vec![0, 5], vec![0, 0]]]), 15);
        // A translate changes nothing.
        let f = vec![vec![0, 0], vec![1, 1], vec![2, 0], vec![0, 2]];
        let laurent: Vec<Vec<i64>> = f.iter().map(|p| vec![p[0] - 7, p[1] - 2]).collect();
        assert_eq!(volume(&[f.clone(), laurent]), 4);
    }

    /// Verschelde, Gatermann, Cools (1996) and later authors.
    #[test]
    fn cyclic_roots() {
        let published = [70, 156, 924, 2560, 11_016, 35_940, 184_756];
        for (n, expected) in (5..).zip(published) {
            assert_eq!(volume(&cyclic(n)), expected, "cyclic-{n}");
        }
    }

    #[test]
    fn the_sum_does_not_depend_on_the_lifting_and_cells_do() {
        let a = mixed_cells(&cyclic(5), 1, u64::MAX).expect("it is small");
        let b = mixed_cells(&cyclic(5), 2, u64::MAX).expect("it is small");
        assert_eq!(a.mixed_volume, b.mixed_volume);
        assert_ne!(a.lifting, b.lifting);
        assert_eq!(
            a,
            mixed_cells(&cyclic(5), 1, u64::MAX).expect("it is small")
        );
        assert!(a.cells.is_sorted());
    }

    #[test]
    fn wider_integers_find_the_same_cells() {
        let supports = cyclic(6);
        let lifting: Vec<Vec<i64>> = supports
            .iter()
            .enumerate()
            .map(|(i, s)| {
                let mut stream = RandomStream::new(3, Purpose::Test, i as u64);
                s.iter().map(|_| stream.below(10_000) as i64).collect()
            })
            .collect();
        let stream = RandomStream::new(3, Purpose::Lifting, 0);
        let tuple = Tuple::new(&supports, &lifting, LIFTING_RANGE, stream);
        let mut left = u64::MAX;
        let sorted = |enumeration: Result<Vec<MixedCell>, Stop>| {
            let Ok(mut cells) = enumeration else {
                panic!("small numbers fit");
            };
            cells.sort_unstable();
            cells
        };
        let narrow = sorted(tuple.enumerate::<i64>(&mut left));
        assert_eq!(narrow, sorted(tuple.enumerate::<i128>(&mut left)));
        assert_eq!(narrow, sorted(tuple.enumerate::<Integer>(&mut left)));
        assert_eq!(narrow.iter().map(|c| c.volume).sum::<u64>(), 156);
    }

    #[test]
    fn numbers_that_outgrow_a_word_are_counted_all_the_same() {
        // Degrees of 50,000 in four variables.
        let n = 4;
        let d = 50_000;
        let supports: Vec<Vec<Vec<i64>>> = (0..n)
            .map(|i| {
                let mut exponents = units(n, &[&[], &[i]]);
                for j in 0..n {
                    let mut point = vec![0; n];
                    point[j] = d - (i + j) as i64;
                    exponents.push(point);
                }
                exponents
            })
            .collect();
        let cells = mixed_cells(&supports, 0, u64::MAX).expect("it fits in 64 bits");
        assert!(cells.mixed_volume > 1 << 61);
        let cells_of_second_seed = mixed_cells(&supports, 1, u64::MAX).expect("it fits in 64 bits");
        assert_eq!(cells.mixed_volume, cells_of_second_seed.mixed_volume);
    }

    /// The corners of all simplices, each with all of its coordinates, took 16 n^3 bytes.
    #[test]
    fn a_thousand_variables_take_little_memory_and_few_operations() {
        let n = 1000;
        let supports: Vec<_> = (0..n).map(|i| units(n, &[&[], &[i]])).collect();
        assert_eq!(
            mixed_cells(&supports, 0, 10_000_000),
            Err(MixedCellsError::TooLong)
        );
        let (_, tuple) = lifted(&supports, 0, 0, LIFTING_RANGE);
        let entries = |points: &Points| points.coordinates.len();
        let held = tuple.supports.iter();
        let held = held.map(|s| entries(&s.simplex) + entries(&s.both) + entries(&s.points));
        assert_eq!(held.sum::<usize>(), n * (2 * n + 2));
    }

    #[test]
    fn operations_are_bounded() {
        assert_eq!(
            mixed_cells(&cyclic(8), 0, 1000),
            Err(MixedCellsError::TooLong)
        );
        assert_eq!(
            mixed_cells(&[vec![vec![1, 2]]], 0, 1000),
            Err(MixedCellsError::Shape)
        );
    }
}
