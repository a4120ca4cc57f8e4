//! Assignments: what the programs of a system compute, and in which order of rounding.
//!
//! All ways to differentiate and to bracket are tried, and the cheapest is
//! taken. What comes out decides every bit of a result; how it is scheduled
//! does not.

use super::compile::{Association, FlowGraph};
use super::constant::ConstantPool;
use super::instruction::{Assignment, Operand};
use super::jacobian::{Sweep, linearization};
use super::optimize::fuse;
use crate::evaluation::Shape;
use crate::expression::{Expressions, NodeId};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Past this many operations only one way to differentiate is tried:
/// compiling should stay far below a second.
const TRY_ALL_BELOW: usize = 20_000;

/// The programs of one system before they are scheduled.
pub(crate) struct Assignments {
    /// Sizes of the system.
    pub shape: Shape,
    /// All constants.
    pub pool: ConstantPool,
    /// [J | H | H_t].
    pub linearize: Vec<Assignment>,
    /// H.
    pub value: Vec<Assignment>,
}

/// One way to write what a program computes.
struct Attempt<'a> {
    arena: Cow<'a, Expressions>,
    wanted: Cow<'a, [NodeId]>,
    association: Association,
}

/// What an assignment costs in wide lanes, roughly in cycles: operands are
/// read and results written at the speed of the cache; a constant that stands
/// once for all lanes costs nothing.
fn cost(assignment: &Assignment) -> usize {
    let read = assignment
        .operands
        .iter()
        .filter(|operand| !matches!(operand, Operand::Single(_)))
        .count();
    assignment.operation.flops() + 4 * read + 8
}

/// The cheapest of some attempts, with the constants of the pool and its own.
fn cheapest<'a>(
    pool: &ConstantPool,
    first_direction: u32,
    attempts: impl Iterator<Item = Attempt<'a>>,
) -> (Vec<Assignment>, ConstantPool) {
    attempts
        .map(|attempt| {
            let mut pool = pool.for_another_arena();
            let graph = FlowGraph::lower(
                &attempt.arena,
                &attempt.wanted,
                first_direction,
                attempt.association,
                &mut pool,
            );
            (fuse(&graph, &mut pool), pool)
        })
        .min_by_key(|(assignments, _)| assignments.iter().map(cost).sum::<usize>())
        .expect("at least one attempt is made")
}

impl Assignments {
    /// Differentiates, lowers and fuses.
    pub(crate) fn compile(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
    ) -> Self {
        let first_direction = u32::try_from(parameters).expect("fewer than 2^32 parameters");
        let associations = [Association::AsWritten, Association::ConstantsOutside];
        let values = associations.iter().map(|&association| Attempt {
            arena: Cow::Borrowed(expressions),
            wanted: Cow::Borrowed(equations),
            association,
        });
        let (value, pool) = cheapest(&ConstantPool::default(), first_direction, values);
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
        let linearizations = sweeps[..tried].iter().flat_map(|&(jacobian, along_path)| {
            let all = linearization(
                expressions,
                equations,
                variables,
                parameters,
                jacobian,
                along_path,
            );
            associations.map(|association| Attempt {
                arena: Cow::Owned(all.arena.clone()),
                wanted: Cow::Owned(all.entries.clone()),
                association,
            })
        });
        let (linearize, pool) = cheapest(&pool, first_direction, linearizations);
        Self {
            shape: Shape {
                variables,
                parameters,
                equations: equations.len(),
            },
            pool,
            linearize,
            value,
        }
    }

    /// Numbers the constants that fill all lanes afresh, those that are used,
    /// from 0; gives their numbers in the pool.
    pub(crate) fn number_constants(&mut self) -> Vec<u32> {
        self.number(Operand::Constant, |operand| match operand {
            Operand::Constant(c) => Some(*c),
            _ => None,
        })
    }

    /// The same for the constants that stand once for all lanes.
    pub(crate) fn number_singles(&mut self) -> Vec<u32> {
        self.number(Operand::Single, |operand| match operand {
            Operand::Single(c) => Some(*c),
            _ => None,
        })
    }

    fn number(
        &mut self,
        kind: fn(u32) -> Operand,
        number: fn(&Operand) -> Option<u32>,
    ) -> Vec<u32> {
        let mut operands: Vec<&mut Operand> = [&mut self.linearize, &mut self.value]
            .into_iter()
            .flatten()
            .flat_map(|assignment| &mut assignment.operands)
            .filter(|operand| number(operand).is_some())
            .collect();
        let used: BTreeSet<u32> = operands.iter().filter_map(|o| number(o)).collect();
        let used: Vec<u32> = used.into_iter().collect();
        for operand in &mut operands {
            let old = number(operand).expect("only these were collected");
            let new = used.binary_search(&old).expect("collected above");
            **operand = kind(u32::try_from(new).expect("fewer than 2^32 constants"));
        }
        used
    }
}
