//! The one loop over runs of instructions, generic over scalar and width.
//!
//! Everything from `linearize` down to the arithmetic is `#[inline(always)]`,
//! so that `dispatch` compiles it for the instruction set of the machine
//! (`tests/dispatch_guard.rs` notices when it does not).

use super::{Evaluate, Shape};
use crate::expression::{Expressions, NodeId};
use crate::straight_line_program::assignments::{Assignments, WAYS};
use crate::straight_line_program::instruction::{Assignment, FREQUENT, Operand, Operation, Terms};
use crate::straight_line_program::schedule::{Scheduling, schedule};
use crate::straight_line_program::{Index, Layout, StraightLineProgram, Target};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Real};
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

/// A compiled system. Cloning shares the programs.
#[derive(Clone, Debug)]
pub struct Interpreter(Arc<Compiled>);

struct Compiled {
    assignments: Assignments,
    /// Constants of the pool that fill all lanes, in the order of the memory.
    constants: Vec<u32>,
    /// Constants of the pool that stand once for all lanes.
    singles: Vec<u32>,
    scheduling: Scheduling,
    wide: Programs,
    /// Programs for one path at a time.
    narrow: Programs,
}

impl std::fmt::Debug for Compiled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Compiled")
            .field("shape", &self.assignments.shape)
            .finish_non_exhaustive()
    }
}

/// Programs for one type of number, each scheduled when it is first used.
#[derive(Debug, Default)]
struct Programs {
    linearize: OnceLock<StraightLineProgram>,
    jacobian: OnceLock<StraightLineProgram>,
    value: OnceLock<StraightLineProgram>,
}

/// The matrix that a program of a system computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// The matrix [J | H | H_t].
    Linearize,
    /// The matrix [J | H].
    Jacobian,
    /// The vector H.
    Value,
}

impl Compiled {
    fn new(
        assignments: Assignments,
        constants: Vec<u32>,
        singles: Vec<u32>,
        scheduling: Scheduling,
    ) -> Self {
        Self {
            assignments,
            constants,
            singles,
            scheduling,
            wide: Programs::default(),
            narrow: Programs::default(),
        }
    }

    fn layout(&self) -> Layout {
        Layout {
            variables: self.assignments.shape.variables,
            parameters: self.assignments.shape.parameters,
            constants: self.constants.len(),
            singles: self.singles.len(),
        }
    }

    /// A program for lanes or for one path at a time.
    #[inline(always)]
    fn program(&self, program: Program, lanes: bool) -> &StraightLineProgram {
        let programs = if lanes { &self.wide } else { &self.narrow };
        let cell = match program {
            Program::Linearize => &programs.linearize,
            Program::Jacobian => &programs.jacobian,
            Program::Value => &programs.value,
        };
        match cell.get() {
            Some(program) => program,
            None => cell.get_or_init(|| self.schedule(program, lanes)),
        }
    }

    #[cold]
    fn schedule(&self, program: Program, lanes: bool) -> StraightLineProgram {
        let scheduling = if lanes {
            self.scheduling
        } else {
            // A slot of one double is small, and a mispredicted jump costs
            // more than an instruction: long runs before all.
            Scheduling {
                window: self.scheduling.window.saturating_mul(16),
                longest_run: self.scheduling.longest_run.saturating_mul(4),
            }
        };
        let shape = self.assignments.shape;
        let columns = shape.variables + 2;
        let (layout, entries) = (self.layout(), shape.equations * columns);
        match program {
            Program::Linearize => {
                let every_entry = |_| true;
                schedule(
                    &self.assignments.linearize,
                    layout,
                    entries,
                    every_entry,
                    scheduling,
                )
            }
            Program::Jacobian => {
                let wanted = |entry| entry % columns != columns - 1;
                let assignments = self.assignments.jacobian();
                schedule(&assignments, layout, entries, wanted, scheduling)
            }
            Program::Value => {
                let every_entry = |_| true;
                schedule(
                    &self.assignments.value,
                    layout,
                    shape.equations,
                    every_entry,
                    scheduling,
                )
            }
        }
    }
}

impl Interpreter {
    /// Compiles the equations, nodes of a checked system with this many
    /// variables and parameters.
    pub fn compile(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
    ) -> Self {
        Self::compile_with(
            expressions,
            equations,
            variables,
            parameters,
            Scheduling::default(),
        )
    }

    /// Compiles the equations several times as fast, in the first way to differentiate instead of the cheapest: for a
    /// few evaluations that decide no bit of a result.
    pub fn compile_in_one_way(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
    ) -> Self {
        let ways = &WAYS[..1];
        let assignments =
            Assignments::compile_as(expressions, equations, variables, parameters, ways);
        Self::of_assignments(assignments, Scheduling::default())
    }

    /// Compiles with another way to form runs, to measure the effect of runs. The schedule does not change any result.
    pub fn compile_with(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
        scheduling: Scheduling,
    ) -> Self {
        let assignments = Assignments::compile(expressions, equations, variables, parameters);
        Self::of_assignments(assignments, scheduling)
    }

    /// The values of equations in parameters only: no derivatives, for which compiling takes most of its time.
    pub fn of_values(expressions: &Expressions, equations: &[NodeId], parameters: usize) -> Self {
        let assignments = Assignments::of_values(expressions, equations, [0, parameters], &WAYS);
        Self::of_assignments(assignments, Scheduling::default())
    }

    fn of_assignments(mut assignments: Assignments, scheduling: Scheduling) -> Self {
        let constants = assignments.number_constants();
        let singles = assignments.number_singles();
        Self(Arc::new(Compiled::new(
            assignments,
            constants,
            singles,
            scheduling,
        )))
    }

    /// Puts the equations into another order: row i of the results is the present row `order[i]`, bit for bit.
    ///
    /// # Panics
    /// When `order` is no permutation of the equations.
    #[must_use]
    pub fn with_row_order(&self, order: &[usize]) -> Self {
        let mut sorted = order.to_vec();
        sorted.sort_unstable();
        assert!(
            sorted.into_iter().eq(0..self.0.assignments.shape.equations),
            "every equation has its place"
        );
        Self(Arc::new(Compiled::new(
            self.0.assignments.with_row_order(order),
            self.0.constants.clone(),
            self.0.singles.clone(),
            self.0.scheduling,
        )))
    }

    /// Sizes of the system.
    pub fn shape(&self) -> Shape {
        self.0.assignments.shape
    }

    /// The program of `linearize` for lanes.
    pub fn linearize_program(&self) -> &StraightLineProgram {
        self.0.program(Program::Linearize, true)
    }

    /// The program of `jacobian` for lanes.
    pub fn jacobian_program(&self) -> &StraightLineProgram {
        self.0.program(Program::Jacobian, true)
    }

    /// The program of `value` for lanes.
    pub fn value_program(&self) -> &StraightLineProgram {
        self.0.program(Program::Value, true)
    }

    /// The assignments of a program, operation by operation, for evaluators of another kind: they choose time and place
    /// of each operation, and keep the order of rounding.
    pub fn assignments(&self, program: Program) -> Cow<'_, [Assignment]> {
        match program {
            Program::Linearize => Cow::Borrowed(&self.0.assignments.linearize),
            Program::Jacobian => Cow::Owned(self.0.assignments.jacobian()),
            Program::Value => Cow::Borrowed(&self.0.assignments.value),
        }
    }

    /// The constants of the assignments in doubles, by number: first those that fill all lanes
    /// (`Operand::Constant`), then those that stand once (`Operand::Single`).
    pub fn constants(&self) -> [Vec<Complex<f64>>; 2] {
        let pool = &self.0.assignments.pool;
        [&self.0.constants, &self.0.singles]
            .map(|numbers| numbers.iter().map(|&c| pool.round(c, ())).collect())
    }

    /// Entries of J that may differ from 0, row after row.
    pub fn pattern(&self) -> Vec<Vec<bool>> {
        let shape = self.shape();
        let [constants, _] = self.constants();
        let mut pattern = vec![vec![false; shape.variables]; shape.equations];
        for assignment in &self.0.assignments.linearize {
            let Some(entry) = assignment.output else {
                continue;
            };
            let (i, j) = (
                entry as usize / (shape.variables + 2),
                entry as usize % (shape.variables + 2),
            );
            let zero = matches!(assignment.operation, Operation::Sum(_))
                && matches!(assignment.operands[..], [Operand::Constant(c)]
                    if constants[c as usize].norm_sqr() == 0.0);
            if let Some(may) = pattern[i].get_mut(j) {
                *may |= !zero;
            }
        }
        pattern
    }

    /// Real operations of one `linearize` of one path.
    pub fn flops(&self) -> usize {
        self.linearize_program().flops()
    }

    /// Bytes of scratch space of `linearize`, of which most is used in every call.
    pub fn scratch_bytes<R: Real>(&self) -> usize {
        let program = self.0.program(Program::Linearize, R::WIDTH > 1);
        program.memory() * size_of::<Complex<R>>()
            + self.0.singles.len() * size_of::<Complex<R::Single>>()
    }
}

/// Work space of an [`Interpreter`]: inputs, constants, temporaries.
#[derive(Clone, Debug)]
pub struct Scratch<R: Real> {
    memory: Vec<Complex<R>>,
    singles: Vec<Complex<R::Single>>,
    /// Results are formed here before they are written, since a result may
    /// replace an operand. Lanes keep it in registers.
    result: Option<Complex<R>>,
}

impl<R: Real> Evaluate<R> for Interpreter {
    type Scratch = Scratch<R>;

    fn shape(&self) -> Shape {
        self.0.assignments.shape
    }

    fn scratch(&self, context: R::Context) -> Scratch<R> {
        // The memory grows when a program that needs more is used for the first time.
        let layout = self.0.layout();
        let pool = &self.0.assignments.pool;
        let mut memory = vec![Complex::zero(context); layout.temporaries()];
        let first = layout.temporaries() - layout.constants;
        for (slot, &constant) in memory[first..].iter_mut().zip(&self.0.constants) {
            *slot = pool.round(constant, context);
        }
        let round = |&constant| pool.round(constant, context);
        Scratch {
            memory,
            singles: self.0.singles.iter().map(round).collect(),
            result: Some(Complex::zero(context)),
        }
    }

    #[inline(always)]
    fn linearize(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        dp: &[Complex<R>],
        out: &mut Matrix<R>,
        s: &mut Scratch<R>,
    ) {
        let shape = &self.0.assignments.shape;
        assert_columns(shape, out);
        load(&mut s.memory, x, 0, shape.variables);
        load(&mut s.memory, p, shape.variables, shape.parameters);
        let directions = shape.variables + shape.parameters;
        load(&mut s.memory, dp, directions, shape.parameters);
        let program = self.0.program(Program::Linearize, R::WIDTH > 1);
        execute(program, s, &mut out.entries);
    }

    #[inline(always)]
    fn jacobian(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut Matrix<R>,
        s: &mut Scratch<R>,
    ) {
        let shape = &self.0.assignments.shape;
        assert_columns(shape, out);
        load(&mut s.memory, x, 0, shape.variables);
        load(&mut s.memory, p, shape.variables, shape.parameters);
        let program = self.0.program(Program::Jacobian, R::WIDTH > 1);
        execute(program, s, &mut out.entries);
    }

    #[inline(always)]
    fn value(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut [Complex<R>],
        s: &mut Scratch<R>,
    ) {
        let shape = &self.0.assignments.shape;
        load(&mut s.memory, x, 0, shape.variables);
        load(&mut s.memory, p, shape.variables, shape.parameters);
        execute(self.0.program(Program::Value, R::WIDTH > 1), s, out);
    }
}

#[inline(always)]
fn assert_columns<R: Real>(shape: &Shape, out: &Matrix<R>) {
    assert!(
        out.rows() == shape.equations && out.columns() == shape.variables + 2,
        "[J | H | H_t] has a row for each equation and two columns more than variables"
    );
}

/// Copies inputs to their place in the memory.
#[inline(always)]
fn load<R: Real>(memory: &mut [Complex<R>], from: &[Complex<R>], start: usize, length: usize) {
    assert_eq!(from.len(), length, "an input has the length of its shape");
    for (to, from) in memory[start..start + length].iter_mut().zip(from) {
        to.set(from);
    }
}

/// Makes room for the temporaries of a program that is used for the first time.
#[cold]
fn grow<R: Real>(memory: &mut Vec<Complex<R>>, length: usize) {
    if let Some(any) = memory.first().cloned() {
        memory.resize(length, any);
    }
}

/// Runs the program; its addresses were checked when it was made.
#[inline(always)]
fn execute<R: Real>(program: &StraightLineProgram, s: &mut Scratch<R>, out: &mut [Complex<R>]) {
    let mut result = s.result.take().expect("the result is put back below");
    if s.memory.len() < program.memory() {
        grow(&mut s.memory, program.memory());
    }
    let memory = &mut s.memory[..program.memory()];
    let singles = s.singles.as_slice();
    let out = &mut out[..program.outputs()];
    let mut code = program.code();
    for run in program.runs() {
        let (run_code, later) = code.split_at(run.stride() * run.length as usize);
        code = later;
        // Stride and terms are known in most arms, and the loops over the terms
        // of a sum then unroll.
        macro_rules! each {
            ($stride:expr, |$operands:ident| $body:expr) => {
                for instruction in run_code.chunks_exact($stride) {
                    let (target, $operands) = (instruction[0] as usize, &instruction[1..]);
                    $body;
                    match run.target {
                        Target::Memory => memory[target].set(&result),
                        Target::Output => out[target].set(&result),
                    }
                }
            };
        }
        macro_rules! arms {
            ($($arm:literal)+) => {
                match (run.arm, run.operation) {
                    $(
                        ($arm, _) => each!(const { 1 + FREQUENT[$arm].operands() }, |operands| {
                            sum(const { FREQUENT[$arm] }, operands, memory, singles, &mut result)
                        }),
                    )+
                    (_, Operation::Sum(terms)) => each!(run.stride(), |operands| {
                        sum(terms, operands, memory, singles, &mut result)
                    }),
                    (_, Operation::Square) => {
                        each!(2, |a| result.set_square(&memory[a[0] as usize]))
                    }
                    (_, Operation::Inverse) => {
                        each!(2, |a| result = memory[a[0] as usize].inverse())
                    }
                }
            };
        }
        const { assert!(FREQUENT.len() == 20, "each frequent sum has its arm") };
        arms!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19);
    }
    s.result = Some(result);
}

/// Computes one sum; see [`Terms`] for the order.
#[inline(always)]
fn sum<R: Real>(
    terms: Terms,
    operands: &[Index],
    memory: &[Complex<R>],
    singles: &[Complex<R::Single>],
    result: &mut Complex<R>,
) {
    let (mut plus, rest) = operands.split_at(terms.plus as usize);
    let (mut minus, rest) = rest.split_at(terms.minus as usize);
    let (mut scaled, rest) = rest.split_at(2 * terms.scaled as usize);
    let (mut turned, rest) = rest.split_at(2 * terms.turned as usize);
    let (mut products, rest) = rest.split_at(2 * terms.products as usize);
    let mut negatives = &rest[..2 * terms.negatives as usize];
    let at = |index: Index| &memory[index as usize];
    let constant = |index: Index| &singles[index as usize];
    if terms.plus > 0 {
        result.set(at(plus[0]));
        plus = &plus[1..];
    } else if terms.minus > 0 {
        result.set(at(minus[0]));
        result.neg();
        minus = &minus[1..];
    } else if terms.scaled > 0 {
        result.set_multiple(&constant(scaled[0]).re, at(scaled[1]));
        scaled = &scaled[2..];
    } else if terms.turned > 0 {
        result.set_turned(constant(turned[0]), at(turned[1]));
        turned = &turned[2..];
    } else if terms.products > 0 {
        result.set_product(at(products[0]), at(products[1]));
        products = &products[2..];
    } else {
        result.set_product(at(negatives[0]), at(negatives[1]));
        result.neg();
        negatives = &negatives[2..];
    }
    for &a in plus {
        result.add(at(a));
    }
    for &a in minus {
        result.sub(at(a));
    }
    for pair in scaled.chunks_exact(2) {
        result.add_multiple(&constant(pair[0]).re, at(pair[1]));
    }
    for pair in turned.chunks_exact(2) {
        result.add_turned(constant(pair[0]), at(pair[1]));
    }
    for pair in products.chunks_exact(2) {
        result.mul_add(at(pair[0]), at(pair[1]));
    }
    for pair in negatives.chunks_exact(2) {
        result.mul_sub(at(pair[0]), at(pair[1]));
    }
}
