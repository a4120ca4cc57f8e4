//! Elimination: `linear_algebra::lu::eliminate` as straight-line code for one size, the same bits;
//! by lists where a large matrix has few entries.
//!
//! A routine for each column: the row of the last pivot, then the column and a look at its own
//! pivot. A lane whose pivot is small exchanges rows between two routines, as there. Rows are
//! taken in blocks, so that many sums grow side by side and share an operand.

use crate::encoder::VectorSet;
use crate::executable::{Arrays, Executable, as_lanes_mut, vector_set};
use crate::registers::assemble;
use crate::routine::{OUTPUT, Operation, Pair, Routine, Step, Sum, Value};
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch_baseline};
use cognate_numeric::linear_algebra::lu;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::sparse::SparseElimination;
use cognate_numeric::scalar::Real;
use std::sync::{Arc, OnceLock};

/// Larger matrices are eliminated by the loop. Code that is far longer than the first-level cache
/// comes too slowly: at n = 14 it is 1.6 times as fast as the loop, at n = 24 no more.
pub const MOST_ROWS: usize = 18;

/// Room for values that find no register: the size of the own pivot, and a few more.
const SPILLS: usize = 8;

/// Elimination of matrices of one size, n rows and n + 2 columns. Cloning shares the code.
#[derive(Clone, Debug)]
pub struct Elimination {
    n: usize,
    code: Option<Arc<Code>>,
    sparse: Option<Arc<SparseElimination>>,
}

#[derive(Debug)]
struct Code {
    set: VectorSet,
    eight: Programs<8>,
    sixteen: Programs<16>,
}

/// The routines for each number of right-hand sides, made when they are first used; `None` where
/// this was refused.
#[derive(Debug, Default)]
struct Programs<const W: usize>([OnceLock<Option<Vec<Executable<W>>>>; 2]);

impl Elimination {
    /// Makes the code for matrices of n rows on this instruction set; without code the loop of `lu` eliminates.
    pub fn new(n: usize, instruction_set: InstructionSet) -> Self {
        let code = vector_set(instruction_set)
            .filter(|_| (1..=MOST_ROWS).contains(&n))
            .map(|set| {
                Arc::new(Code {
                    set,
                    eight: Programs::default(),
                    sixteen: Programs::default(),
                })
            });
        Self {
            n,
            code,
            sparse: None,
        }
    }

    /// Makes the elimination of matrices of n rows with few entries that differ from 0, in known places.
    pub fn sparse(n: usize, elimination: SparseElimination) -> Self {
        Self {
            n,
            code: None,
            sparse: Some(Arc::new(elimination)),
        }
    }

    /// Bytes of machine code for 8 lanes and 2 right-hand sides, which is made if need be.
    pub fn code_bytes(&self) -> Option<usize> {
        let code = self.code.as_ref()?;
        let routines = code.eight.get(self.n, 2, code.set)?;
        Some(routines.iter().map(Executable::len).sum())
    }

    /// Eliminates as `lu::eliminate` does, with the same bits, a matrix of the size and pattern that this code was made
    /// for; `RHS` is 1 or 2.
    ///
    /// # Panics
    /// When the matrix has another size.
    #[inline(always)]
    pub fn eliminate<R: Real, const RHS: usize>(
        &self,
        a: &mut Matrix<R>,
        exchanges: &mut R::Control,
    ) {
        const { assert!(RHS == 1 || RHS == 2, "one or two right-hand sides") };
        assert!(
            a.rows() == self.n && a.columns() == self.n + 2,
            "the matrix has the size that the elimination was made for"
        );
        if !self.run::<8, R>(|code| &code.eight, RHS, a, exchanges)
            && !self.run::<16, R>(|code| &code.sixteen, RHS, a, exchanges)
        {
            dispatch_baseline(Loop::<R, RHS> {
                sparse: self.sparse.as_deref(),
                a,
                exchanges,
            });
        }
    }

    #[inline(always)]
    fn run<const W: usize, R: Real>(
        &self,
        programs: impl Fn(&Code) -> &Programs<W>,
        rhs: usize,
        a: &mut Matrix<R>,
        exchanges: &mut R::Control,
    ) -> bool {
        let n = self.n;
        if let Some(code) = &self.code
            && as_lanes_mut::<W, R>(&mut a.entries).is_some()
            && let Some(routines) = programs(code).get(n, rhs, code.set)
        {
            let mut spills = [Lanes([0.0; 8]); SPILLS];
            for (k, routine) in routines.iter().enumerate() {
                let Some(out) = as_lanes_mut::<W, R>(&mut a.entries) else {
                    return false;
                };
                let small = routine.call(Arrays {
                    x: &[],
                    p: &[],
                    dp: &[],
                    out,
                    spills: &mut spills,
                });
                if small != 0 {
                    for lane in 0..R::WIDTH {
                        if small >> lane & 1 != 0 {
                            lu::exchange(&mut a.entries, n + 2, k..n, n + rhs, lane);
                            exchanges.set_lane(lane, exchanges.lane(lane) + 1.0);
                        }
                    }
                }
            }
            return true;
        }
        false
    }
}

/// Elimination without machine code, by lists where the places of the entries are known; a function of its own, as
/// the interpreter is.
struct Loop<'a, R: Real, const RHS: usize> {
    sparse: Option<&'a SparseElimination>,
    a: &'a mut Matrix<R>,
    exchanges: &'a mut R::Control,
}

impl<R: Real, const RHS: usize> Job for Loop<'_, R, RHS> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        match self.sparse {
            Some(sparse) => sparse.eliminate::<R, RHS>(self.a, self.exchanges),
            None => lu::eliminate::<R, RHS>(self.a, self.exchanges),
        }
    }
}

impl<const W: usize> Programs<W> {
    #[inline(always)]
    fn get(&self, n: usize, rhs: usize, set: VectorSet) -> Option<&[Executable<W>]> {
        let cell = &self.0[rhs - 1];
        match cell.get() {
            Some(routines) => routines.as_deref(),
            None => Self::make(cell, n, rhs, set),
        }
    }

    #[cold]
    fn make(
        cell: &OnceLock<Option<Vec<Executable<W>>>>,
        n: usize,
        rhs: usize,
        set: VectorSet,
    ) -> Option<&[Executable<W>]> {
        let make = |routine: Routine| {
            let assembled = assemble(&routine, set, W);
            if assembled.spills > SPILLS {
                return None;
            }
            Executable::new(assembled, routine.constants, set)
        };
        let compile_blocks = || routines(n, rhs, set).into_iter().map(make).collect();
        cell.get_or_init(compile_blocks).as_deref()
    }
}

/// All of an elimination: routine k ends with the look at pivot k.
fn routines(n: usize, rhs: usize, set: VectorSet) -> Vec<Routine> {
    let size = Size {
        n,
        rhs,
        block: match set {
            VectorSet::Avx512 => 8,
            VectorSet::Avx2 => 4,
        },
    };
    let mut routines = Vec::new();
    for k in 0..n {
        let mut r = Routine::default();
        if k > 0 {
            size.row(&mut r, k - 1);
        }
        size.column(&mut r, k);
        if k == n - 1 {
            // The last pivot has nothing to be compared with.
            size.row(&mut r, k);
            size.substitute(&mut r);
        }
        routines.push(r);
    }
    routines
}

struct Size {
    n: usize,
    rhs: usize,
    /// Number of sums that grow side by side.
    block: usize,
}

impl Size {
    fn index(&self, i: usize, j: usize) -> u32 {
        u32::try_from(i * (self.n + 2) + j).expect("the matrix is small")
    }

    fn at(&self, r: &mut Routine, i: usize, j: usize) -> Pair {
        r.number(OUTPUT, self.index(i, j))
    }

    /// Column k from the diagonal down, and whether its own pivot is small beside its largest.
    fn column(&self, r: &mut Routine, k: usize) {
        let (mut diagonal, mut largest): (Option<Value>, Option<Value>) = (None, None);
        let rows: Vec<usize> = (k..self.n).collect();
        for block in rows.chunks(self.block) {
            let first = |&i: &usize| Sum::new(self.at(r, i, k), false);
            let mut sums: Vec<Sum> = block.iter().map(first).collect();
            for m in 0..k {
                let upper = self.at(r, m, k);
                for (&i, sum) in block.iter().zip(&mut sums) {
                    let lower = self.at(r, i, m);
                    sum.add_product(r, lower, upper, true);
                }
            }
            for (&i, sum) in block.iter().zip(sums) {
                let entry = sum.finish(r);
                if k > 0 {
                    r.store(entry, OUTPUT, self.index(i, k));
                }
                if k + 1 < self.n {
                    let size = r.norm_sqr(entry);
                    diagonal = diagonal.or(Some(size));
                    largest = Some(match largest {
                        Some(largest) => r.binary(Operation::Maximum, largest, size),
                        None => size,
                    });
                }
            }
        }
        if let (Some(diagonal), Some(largest)) = (diagonal, largest) {
            let kept = r.constant(lu::KEPT_PIVOT * lu::KEPT_PIVOT);
            let bound = r.binary(Operation::Multiply, largest, kept);
            r.steps.push(Step::Less([diagonal, bound]));
        }
    }

    /// Row k right of the diagonal, divided by the pivot.
    fn row(&self, r: &mut Routine, k: usize) {
        let pivot = self.at(r, k, k);
        let inverse = r.inverse(pivot);
        let columns: Vec<usize> = (k + 1..self.n + self.rhs).collect();
        for block in columns.chunks(self.block) {
            let first = |&j: &usize| Sum::new(self.at(r, k, j), false);
            let mut sums: Vec<Sum> = block.iter().map(first).collect();
            for m in 0..k {
                let lower = self.at(r, k, m);
                for (&j, sum) in block.iter().zip(&mut sums) {
                    let upper = self.at(r, m, j);
                    sum.add_product(r, lower, upper, true);
                }
            }
            for (&j, sum) in block.iter().zip(sums) {
                let sum = sum.finish(r);
                let quotient = r.product(sum, inverse);
                r.store(quotient, OUTPUT, self.index(k, j));
            }
        }
    }

    /// The solutions, from the last to the first.
    fn substitute(&self, r: &mut Routine) {
        let n = self.n;
        for k in (0..n).rev() {
            let columns = n..n + self.rhs;
            let first = |j: usize| Sum::new(self.at(r, k, j), false);
            let mut sums: Vec<Sum> = columns.clone().map(first).collect();
            for m in k + 1..n {
                let factor = self.at(r, k, m);
                for (j, sum) in columns.clone().zip(&mut sums) {
                    let solution = self.at(r, m, j);
                    sum.add_product(r, factor, solution, true);
                }
            }
            for (j, sum) in columns.zip(sums) {
                if k + 1 < n {
                    let solution = sum.finish(r);
                    r.store(solution, OUTPUT, self.index(k, j));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::lanes::dispatch::{Job, dispatch};
    use cognate_numeric::random::{Purpose, RandomStream};
    use num_complex::Complex64;

    struct Both<'a, R: Real> {
        elimination: &'a Elimination,
        a: Matrix<R>,
        rhs: usize,
    }

    impl<R: Real<Context = (), Control = R>> Job for Both<'_, R> {
        type Output = [(Matrix<R>, R); 2];
        #[inline(always)]
        fn run(self) -> Self::Output {
            let zero = R::from_f64((), 0.0);
            let (mut code, mut by_code) = (self.a.clone(), zero.clone());
            let (mut looped, mut by_loop) = (self.a, zero);
            if self.rhs == 1 {
                self.elimination.eliminate::<R, 1>(&mut code, &mut by_code);
                lu::eliminate::<R, 1>(&mut looped, &mut by_loop);
            } else {
                self.elimination.eliminate::<R, 2>(&mut code, &mut by_code);
                lu::eliminate::<R, 2>(&mut looped, &mut by_loop);
            }
            [(code, by_code), (looped, by_loop)]
        }
    }

    fn compare<const W: usize>(n: usize, rhs: usize, set: InstructionSet) -> f64 {
        let elimination = Elimination::new(n, set);
        let code = elimination.code.as_ref();
        if let Some(code) = code {
            assert!(
                code.eight.get(n, rhs, code.set).is_some(),
                "no code, n = {n}"
            );
        }
        let mut a = Matrix::<Lanes<W>>::zeros((), n, n + 2);
        for lane in 0..W {
            let mut stream = RandomStream::new(lane as u64, Purpose::Test, n as u64);
            for (at, entry) in a.entries.iter_mut().enumerate() {
                let mut value = stream.disc();
                // Small pivots; a column of zeros, which nothing survives; a sparse lane.
                let (i, j) = (at / (n + 2), at % (n + 2));
                value *= match lane {
                    1 | 2 if i == j => 1e-9,
                    3 if j == n / 2 => 0.0,
                    4 if i != j && (i + j) % 3 != 0 => 0.0,
                    _ => 1.0,
                };
                entry.set_lane(lane, Complex64::new(value.re, value.im));
            }
        }
        let elimination = &elimination;
        let [code, looped] = dispatch(Both {
            elimination,
            a,
            rhs,
        });
        for lane in 0..W {
            assert_eq!(
                code.1.lane(lane),
                looped.1.lane(lane),
                "exchanges in lane {lane}"
            );
            for (at, (x, y)) in code.0.entries.iter().zip(&looped.0.entries).enumerate() {
                for (x, y) in [
                    (x.re.lane(lane), y.re.lane(lane)),
                    (x.im.lane(lane), y.im.lane(lane)),
                ] {
                    assert!(
                        x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan()),
                        "entry {at} of lane {lane} is {x:e} instead of {y:e}, n = {n}, {rhs} right-hand sides"
                    );
                }
            }
        }
        (0..W).map(|lane| code.1.lane(lane)).sum()
    }

    #[test]
    fn the_bits_are_those_of_the_loop() {
        let mut exchanges = 0.0;
        for set in [InstructionSet::Avx512, InstructionSet::Avx2] {
            for n in [1, 2, 3, 5, 8, 11, 18] {
                for rhs in [1, 2] {
                    exchanges += compare::<8>(n, rhs, set);
                    exchanges += compare::<16>(n, rhs, set);
                }
            }
        }
        assert!(exchanges > 10.0, "some lane had to exchange rows");
    }
}
