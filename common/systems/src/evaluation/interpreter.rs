//! The one loop over runs of instructions, generic over scalar and width.
//!
//! Everything from `linearize` down to the arithmetic is `#[inline(always)]`,
//! so that `dispatch` compiles it for the instruction set of the machine
//! (`tests/dispatch_guard.rs` notices when it does not).

use super::{Evaluate, Shape};
use crate::expression::{Expressions, NodeId};
use crate::straight_line_program::compile::FlowGraph;
use crate::straight_line_program::constant::ConstantPool;
use crate::straight_line_program::instruction::{Assignment, Operation};
use crate::straight_line_program::jacobian::{Sweep, linearization};
use crate::straight_line_program::optimize::fuse;
use crate::straight_line_program::schedule::schedule;
use crate::straight_line_program::{Layout, StraightLineProgram, Target};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Real};
use std::sync::Arc;

/// Past this many nodes only one way to differentiate is tried: compiling
/// should stay far below a second.
const TRY_ALL_BELOW: usize = 20_000;

/// A compiled system. Cloning shares the programs.
#[derive(Clone, Debug)]
pub struct Interpreter(Arc<Compiled>);

#[derive(Debug)]
struct Compiled {
    shape: Shape,
    constants: ConstantPool,
    linearize: StraightLineProgram,
    value: StraightLineProgram,
}

/// Programs before they are scheduled: what they compute and in which order
/// of rounding.
pub(super) struct Assignments {
    pub shape: Shape,
    pub constants: ConstantPool,
    pub linearize: Vec<Assignment>,
    pub value: Vec<Assignment>,
}

impl Assignments {
    /// Differentiates, lowers and fuses; of the ways to differentiate, the
    /// one with the fewest real operations.
    pub fn compile(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
    ) -> Self {
        let first_direction = u32::try_from(parameters).expect("fewer than 2^32 parameters");
        let mut constants = ConstantPool::default();
        let graph = FlowGraph::lower(expressions, equations, first_direction, &mut constants);
        let value = fuse(&graph, &mut constants);
        let sweeps = [
            (Sweep::Reverse, Sweep::Reverse),
            (Sweep::Reverse, Sweep::Forward),
            (Sweep::Forward, Sweep::Reverse),
            (Sweep::Forward, Sweep::Forward),
        ];
        let tried = if value.len() * variables.max(1) > TRY_ALL_BELOW {
            1
        } else {
            sweeps.len()
        };
        let cost = |assignments: &[Assignment]| -> usize {
            assignments.iter().map(|a| a.operation.flops() + 1).sum()
        };
        let (linearize, constants) = sweeps[..tried]
            .iter()
            .map(|&(jacobian, along_path)| {
                let all = linearization(
                    expressions,
                    equations,
                    variables,
                    parameters,
                    jacobian,
                    along_path,
                );
                // The pool of each attempt starts from that of the values.
                let mut pool = constants.for_another_arena();
                let graph = FlowGraph::lower(&all.arena, &all.entries, first_direction, &mut pool);
                let assignments = fuse(&graph, &mut pool);
                (assignments, pool)
            })
            .min_by_key(|(assignments, _)| cost(assignments))
            .expect("at least one way to differentiate is tried");
        Self {
            shape: Shape {
                variables,
                parameters,
                equations: equations.len(),
            },
            constants,
            linearize,
            value,
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
        let assignments = Assignments::compile(expressions, equations, variables, parameters);
        let layout = Layout {
            variables,
            parameters,
            constants: assignments.constants.constants().len(),
        };
        let equations = equations.len();
        let program = |list: &[Assignment], outputs| schedule(list, layout, outputs, WINDOW);
        Self(Arc::new(Compiled {
            linearize: program(&assignments.linearize, equations * (variables + 2)),
            value: program(&assignments.value, equations),
            shape: assignments.shape,
            constants: assignments.constants,
        }))
    }

    /// Sizes of the system.
    pub fn shape(&self) -> Shape {
        self.0.shape
    }

    /// The program of `linearize`.
    pub fn linearize_program(&self) -> &StraightLineProgram {
        &self.0.linearize
    }

    /// The program of `value`.
    pub fn value_program(&self) -> &StraightLineProgram {
        &self.0.value
    }

    /// Real operations of one `linearize` of one path.
    pub fn flops(&self) -> usize {
        self.0.linearize.flops()
    }

    /// Bytes of scratch space, of which most is used in every call.
    pub fn scratch_bytes<R: Real>(&self) -> usize {
        self.0.linearize.memory().max(self.0.value.memory()) * size_of::<Complex<R>>()
    }
}

/// How far ahead the scheduler looks (`benches/evaluation.rs` has the figures).
const WINDOW: usize = 128;

/// Work space of an [`Interpreter`]: inputs, constants, temporaries.
#[derive(Debug)]
pub struct Scratch<R> {
    memory: Vec<Complex<R>>,
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
        let program = &self.0.linearize;
        let layout = program.layout();
        let length = program.memory().max(self.0.value.memory());
        let mut memory = vec![Complex::zero(context); length];
        let constants = layout.temporaries() - layout.constants;
        memory[constants..layout.temporaries()]
            .clone_from_slice(&self.0.constants.round::<R>(context));
        Scratch {
            memory,
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
        execute(&self.0.linearize, s, &mut out.entries);
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
        execute(&self.0.value, s, out);
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
    let out = &mut out[..program.outputs()];
    let operands = program.operands();
    let (mut unary, mut binary) = (operands.unary.as_slice(), operands.binary.as_slice());
    let (mut ternary, mut quaternary) =
        (operands.ternary.as_slice(), operands.quaternary.as_slice());
    // One arm for each operation and target; `$m` is the memory, the names are
    // operands, the body leaves the value in `$r`.
    macro_rules! run {
        ($list:ident, $run:ident, |$r:ident $(, $name:ident)+| $body:expr) => {{
            let (now, later) = $list.split_at($run.length as usize);
            $list = later;
            match $run.target {
                Target::Memory => {
                    for &[target $(, $name)+] in now {
                        {
                            let $r = &mut result;
                            $(let $name = &memory[$name as usize];)+
                            $body;
                        }
                        memory[target as usize].set(&result);
                    }
                }
                Target::Output => {
                    for &[target $(, $name)+] in now {
                        {
                            let $r = &mut result;
                            $(let $name = &memory[$name as usize];)+
                            $body;
                        }
                        out[target as usize].set(&result);
                    }
                }
            }
        }};
    }
    for run in program.runs() {
        match run.operation {
            Operation::Copy => run!(unary, run, |r, a| r.set(a)),
            Operation::Negate => run!(unary, run, |r, a| {
                r.set(a);
                r.neg();
            }),
            Operation::Square => run!(unary, run, |r, a| r.set_square(a)),
            Operation::Inverse => run!(unary, run, |r, a| *r = a.inverse()),
            Operation::Add => run!(binary, run, |r, a, b| {
                r.set(a);
                r.add(b);
            }),
            Operation::Subtract => run!(binary, run, |r, a, b| {
                r.set(a);
                r.sub(b);
            }),
            Operation::Multiply => run!(binary, run, |r, a, b| r.set_product(a, b)),
            Operation::Scale => run!(binary, run, |r, a, b| {
                r.set(b);
                r.scale(&a.re);
            }),
            Operation::MultiplyAdd => run!(ternary, run, |r, a, b, c| {
                r.set(c);
                r.mul_add(a, b);
            }),
            Operation::MultiplySubtract => run!(ternary, run, |r, a, b, c| {
                r.set(c);
                r.neg();
                r.mul_add(a, b);
            }),
            Operation::SubtractProduct => run!(ternary, run, |r, a, b, c| {
                r.set(c);
                r.mul_sub(a, b);
            }),
            Operation::ScaleAdd => run!(ternary, run, |r, a, b, c| {
                r.set(c);
                r.scale_add(&a.re, b);
            }),
            Operation::ScaleSubtract => run!(ternary, run, |r, a, b, c| {
                r.set(c);
                r.neg();
                r.scale_add(&a.re, b);
            }),
            Operation::SubtractScaled => run!(ternary, run, |r, a, b, c| {
                r.set(c);
                r.scale_sub(&a.re, b);
            }),
            Operation::ProductSum => run!(quaternary, run, |r, a, b, c, d| {
                r.set_product(c, d);
                r.mul_add(a, b);
            }),
            Operation::ProductDifference => run!(quaternary, run, |r, a, b, c, d| {
                r.set_product(a, b);
                r.mul_sub(c, d);
            }),
        }
    }
    s.result = Some(result);
}
