//! The one loop over runs of instructions, generic over scalar and width.
//!
//! Everything from `linearize` down to the arithmetic is `#[inline(always)]`,
//! so that `dispatch` compiles it for the instruction set of the machine
//! (`tests/dispatch_guard.rs` notices when it does not).

use super::{Evaluate, Shape};
use crate::expression::{Expressions, NodeId};
use crate::straight_line_program::assignments::Assignments;
use crate::straight_line_program::constant::ConstantPool;
use crate::straight_line_program::instruction::{FREQUENT, Operation, Terms};
use crate::straight_line_program::schedule::{Scheduling, schedule};
use crate::straight_line_program::{Index, Layout, StraightLineProgram, Target};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Real};
use std::sync::Arc;

/// A compiled system. Cloning shares the programs.
#[derive(Clone, Debug)]
pub struct Interpreter(Arc<Compiled>);

#[derive(Debug)]
struct Compiled {
    shape: Shape,
    pool: ConstantPool,
    /// Constants of the pool that fill all lanes, in the order of the memory.
    constants: Vec<u32>,
    /// Constants of the pool that stand once for all lanes.
    singles: Vec<u32>,
    wide: Programs,
    /// The same for one path at a time.
    narrow: Programs,
}

#[derive(Debug)]
struct Programs {
    linearize: StraightLineProgram,
    value: StraightLineProgram,
}

impl Compiled {
    /// The programs for one type of number.
    #[inline(always)]
    fn programs<R: Real>(&self) -> &Programs {
        if R::WIDTH == 1 {
            &self.narrow
        } else {
            &self.wide
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

    /// The same with another way to form runs, to measure what runs bring. The
    /// schedule does not change any result.
    pub fn compile_with(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
        scheduling: Scheduling,
    ) -> Self {
        let mut assignments = Assignments::compile(expressions, equations, variables, parameters);
        let constants = assignments.number_constants();
        let singles = assignments.number_singles();
        let layout = Layout {
            variables,
            parameters,
            constants: constants.len(),
            singles: singles.len(),
        };
        let entries = equations.len() * (variables + 2);
        let programs = |scheduling| Programs {
            linearize: schedule(&assignments.linearize, layout, entries, scheduling),
            value: schedule(&assignments.value, layout, equations.len(), scheduling),
        };
        Self(Arc::new(Compiled {
            wide: programs(scheduling),
            // A slot of one double is small, and a mispredicted jump costs
            // more than an instruction: long runs before all.
            narrow: programs(Scheduling {
                window: scheduling.window.saturating_mul(16),
                longest_run: scheduling.longest_run.saturating_mul(4),
            }),
            shape: assignments.shape,
            pool: assignments.pool,
            constants,
            singles,
        }))
    }

    /// Sizes of the system.
    pub fn shape(&self) -> Shape {
        self.0.shape
    }

    /// The program of `linearize` for lanes.
    pub fn linearize_program(&self) -> &StraightLineProgram {
        &self.0.wide.linearize
    }

    /// The program of `value` for lanes.
    pub fn value_program(&self) -> &StraightLineProgram {
        &self.0.wide.value
    }

    /// Real operations of one `linearize` of one path.
    pub fn flops(&self) -> usize {
        self.0.wide.linearize.flops()
    }

    /// Bytes of scratch space, of which most is used in every call.
    pub fn scratch_bytes<R: Real>(&self) -> usize {
        let programs = self.0.programs::<R>();
        programs.linearize.memory().max(programs.value.memory()) * size_of::<Complex<R>>()
            + self.0.singles.len() * size_of::<Complex<R::Single>>()
    }
}

/// Work space of an [`Interpreter`]: inputs, constants, temporaries.
#[derive(Debug)]
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
        self.0.shape
    }

    fn scratch(&self, context: R::Context) -> Scratch<R> {
        let programs = self.0.programs::<R>();
        let layout = programs.linearize.layout();
        let length = programs.linearize.memory().max(programs.value.memory());
        let mut memory = vec![Complex::zero(context); length];
        let first = layout.temporaries() - layout.constants;
        for (slot, &constant) in memory[first..].iter_mut().zip(&self.0.constants) {
            *slot = self.0.pool.round(constant, context);
        }
        let round = |&constant| self.0.pool.round(constant, context);
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
        let shape = &self.0.shape;
        assert!(
            out.rows() == shape.equations && out.columns() == shape.variables + 2,
            "[J | H | H_t] has a row for each equation and two columns more than variables"
        );
        load(&mut s.memory, x, 0, shape.variables);
        load(&mut s.memory, p, shape.variables, shape.parameters);
        let directions = shape.variables + shape.parameters;
        load(&mut s.memory, dp, directions, shape.parameters);
        execute(&self.0.programs::<R>().linearize, s, &mut out.entries);
    }

    #[inline(always)]
    fn value(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut [Complex<R>],
        s: &mut Scratch<R>,
    ) {
        let shape = &self.0.shape;
        load(&mut s.memory, x, 0, shape.variables);
        load(&mut s.memory, p, shape.variables, shape.parameters);
        execute(&self.0.programs::<R>().value, s, out);
    }
}

/// Copies inputs to their place in the memory.
#[inline(always)]
fn load<R: Real>(memory: &mut [Complex<R>], from: &[Complex<R>], start: usize, length: usize) {
    assert_eq!(from.len(), length, "an input has the length of its shape");
    for (to, from) in memory[start..start + length].iter_mut().zip(from) {
        to.set(from);
    }
}

/// Runs the program; its addresses were checked when it was made.
#[inline(always)]
fn execute<R: Real>(program: &StraightLineProgram, s: &mut Scratch<R>, out: &mut [Complex<R>]) {
    let mut result = s.result.take().expect("the result is put back below");
    let memory = &mut s.memory[..program.memory()];
    let singles = s.singles.as_slice();
    let out = &mut out[..program.outputs()];
    let mut code = program.code();
    for run in program.runs() {
        let (now, later) = code.split_at(run.stride() * run.length as usize);
        code = later;
        // Stride and terms are known in most arms, and the loops over the terms
        // of a sum then unroll.
        macro_rules! each {
            ($stride:expr, |$operands:ident| $body:expr) => {
                for instruction in now.chunks_exact($stride) {
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

/// One sum; see [`Terms`] for the order.
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
