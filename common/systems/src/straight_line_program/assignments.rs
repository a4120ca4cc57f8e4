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
use crate::expression::differentiate::below;
use crate::expression::{Expressions, NodeId};
use std::collections::BTreeSet;

/// Past this many nodes times variables few ways are tried: compiling should
/// stay far below a second.
const TRY_ALL_BELOW: usize = 20_000;

/// The programs of one system before they are scheduled.
pub(crate) struct Assignments {
    /// Sizes of the system.
    pub shape: Shape,
    /// All constants of the programs.
    pub pool: ConstantPool,
    /// Assignments that compute [J | H | H_t].
    pub linearize: Vec<Assignment>,
    /// Assignments that compute H.
    pub value: Vec<Assignment>,
}

/// The way in which a program is derived from the equations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    jacobian: Sweep,
    along_path: Sweep,
    association: Association,
}

/// All ways; the first two serve where compiling takes long.
pub(crate) const WAYS: [Way; 8] = {
    const fn way(jacobian: Sweep, along_path: Sweep, association: Association) -> Way {
        Way {
            jacobian,
            along_path,
            association,
        }
    }
    use Association::{AsWritten, ConstantsOutside};
    use Sweep::{Forward, Reverse};
    [
        way(Reverse, Reverse, AsWritten),
        way(Reverse, Reverse, ConstantsOutside),
        way(Reverse, Forward, AsWritten),
        way(Reverse, Forward, ConstantsOutside),
        way(Forward, Reverse, AsWritten),
        way(Forward, Reverse, ConstantsOutside),
        way(Forward, Forward, AsWritten),
        way(Forward, Forward, ConstantsOutside),
    ]
};

/// Cost of an assignment in wide lanes, roughly in cycles: operands are read and results written at the speed of the
/// cache; a constant that stands once for all lanes costs nothing.
fn cost(assignment: &Assignment) -> usize {
    let read = assignment
        .operands
        .iter()
        .filter(|operand| !matches!(operand, Operand::Single(_)))
        .count();
    assignment.operation.flops() + 4 * read + 8
}

fn total_cost(assignments: &[Assignment]) -> usize {
    assignments.iter().map(cost).sum()
}

/// Lowers these nodes to assignments, and returns the constants that the assignments use, too.
fn lower(
    (arena, wanted): (&Expressions, &[NodeId]),
    parameters: usize,
    way: &Way,
    pool: &ConstantPool,
) -> (Vec<Assignment>, ConstantPool) {
    let first_direction = u32::try_from(parameters).expect("fewer than 2^32 parameters");
    let mut pool = pool.for_another_arena();
    let association = way.association;
    let graph = FlowGraph::lower(arena, wanted, first_direction, association, &mut pool);
    (fuse(&graph, &mut pool), pool)
}

impl Assignments {
    /// Differentiates, lowers and fuses, in the cheapest way.
    pub(crate) fn compile(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
    ) -> Self {
        let size = below(expressions, equations).len() * variables.max(1);
        let tried = if size > TRY_ALL_BELOW { 2 } else { WAYS.len() };
        let ways = &WAYS[..tried];
        Self::compile_as(expressions, equations, variables, parameters, ways)
    }

    /// Compiles in the cheapest of `ways`, of which there is at least one.
    pub(crate) fn compile_as(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
        ways: &[Way],
    ) -> Self {
        let values = Self::of_values(expressions, equations, [variables, parameters], ways);
        let pool = &values.pool;
        let (linearize, pool) = ways
            .iter()
            .map(|way| {
                let linearization_graph = linearization(
                    expressions,
                    equations,
                    variables,
                    parameters,
                    way.jacobian,
                    way.along_path,
                );
                lower(
                    (&linearization_graph.arena, &linearization_graph.entries),
                    parameters,
                    way,
                    pool,
                )
            })
            .min_by_key(|(assignments, _)| total_cost(assignments))
            .expect("at least one way is tried");
        Self {
            pool,
            linearize,
            ..values
        }
    }

    /// The values alone, without derivatives, in the cheapest of some ways, at least one.
    pub(crate) fn of_values(
        expressions: &Expressions,
        equations: &[NodeId],
        [variables, parameters]: [usize; 2],
        ways: &[Way],
    ) -> Self {
        let none = ConstantPool::default();
        let (value, pool) = ways
            .iter()
            .take(2)
            .map(|way| lower((expressions, equations), parameters, way, &none))
            .min_by_key(|(assignments, _)| total_cost(assignments))
            .expect("at least one way is tried");
        Self {
            shape: Shape {
                variables,
                parameters,
                equations: equations.len(),
            },
            pool,
            linearize: Vec::new(),
            value,
        }
    }

    /// Puts the equations into another order: row i is the present row `order[i]`. The operations do not change, so no
    /// bit of a result changes.
    pub(crate) fn with_row_order(&self, order: &[usize]) -> Self {
        let mut place = vec![0u32; order.len()];
        for (row, &old) in order.iter().enumerate() {
            place[old] = u32::try_from(row).expect("fewer than 2^32 equations");
        }
        let columns = u32::try_from(self.shape.variables + 2).expect("fewer than 2^32 variables");
        let moved = |assignments: &[Assignment], columns: u32| {
            let mut moved = assignments.to_vec();
            for entry in moved.iter_mut().filter_map(|a| a.output.as_mut()) {
                *entry = place[(*entry / columns) as usize] * columns + *entry % columns;
            }
            moved
        };
        Self {
            shape: self.shape,
            pool: self.pool.clone(),
            linearize: moved(&self.linearize, columns),
            value: moved(&self.value, 1),
        }
    }

    /// The assignments of `linearize` that compute [J | H], in the same order; the last column is left out.
    pub(crate) fn jacobian(&self) -> Vec<Assignment> {
        let columns = u32::try_from(self.shape.variables + 2).expect("fewer than 2^32 variables");
        let mut wanted = vec![false; self.linearize.len()];
        for (number, assignment) in self.linearize.iter().enumerate().rev() {
            wanted[number] |= assignment
                .output
                .is_some_and(|entry| entry % columns != columns - 1);
            if wanted[number] {
                for operand in &assignment.operands {
                    if let Operand::Value(v) = operand {
                        wanted[*v as usize] = true;
                    }
                }
            }
        }
        let mut place = vec![0u32; self.linearize.len()];
        let mut kept = Vec::new();
        for (number, assignment) in self.linearize.iter().enumerate() {
            if !wanted[number] {
                continue;
            }
            place[number] = u32::try_from(kept.len()).expect("fewer than 2^32 assignments");
            let mut assignment = assignment.clone();
            for operand in &mut assignment.operands {
                if let Operand::Value(v) = operand {
                    *v = place[*v as usize];
                }
            }
            kept.push(assignment);
        }
        kept
    }

    /// Numbers the constants that fill all lanes afresh, those that are used,
    /// from 0; gives their numbers in the pool.
    pub(crate) fn number_constants(&mut self) -> Vec<u32> {
        self.number(Operand::Constant, |operand| match operand {
            Operand::Constant(c) => Some(*c),
            _ => None,
        })
    }

    /// Numbers the constants that stand once for all lanes afresh, those that are used, from 0; gives their numbers in
    /// the pool.
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
