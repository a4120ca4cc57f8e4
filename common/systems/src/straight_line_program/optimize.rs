//! From a flow graph to assignments: dead code dropped, sums fused with their products.
//!
//! A product that only one sum uses becomes part of that sum. The order of
//! evaluation inside a fused operation is fixed (`instruction.rs`), so what a
//! program gives is decided here and not by the schedule.

use super::compile::{Flow, FlowGraph, Signed};
use super::constant::ConstantPool;
use super::instruction::{Assignment, Operand, Operation};

/// Turns the graph into assignments in depth-first order of the outputs, which
/// keeps what belongs together near together.
pub(crate) fn fuse(graph: &FlowGraph, pool: &mut ConstantPool) -> Vec<Assignment> {
    let mut uses = vec![0u32; graph.values.len()];
    let mut reachable = vec![false; graph.values.len()];
    let mut stack = Vec::new();
    for output in graph.outputs.iter().flatten() {
        uses[output.value as usize] += 1;
        stack.push(output.value);
    }
    while let Some(value) = stack.pop() {
        if std::mem::replace(&mut reachable[value as usize], true) {
            continue;
        }
        for operand in graph.values[value as usize].operands() {
            uses[operand as usize] += 1;
            stack.push(operand);
        }
    }
    let mut fusion = Fusion {
        graph,
        uses,
        place: vec![None; graph.values.len()],
        assignments: Vec::new(),
    };
    for (entry, output) in graph.outputs.iter().enumerate() {
        let entry = u32::try_from(entry).expect("a program has fewer than 2^32 outputs");
        fusion.give(entry, *output, pool);
    }
    fusion.assignments
}

struct Fusion<'a> {
    graph: &'a FlowGraph,
    uses: Vec<u32>,
    place: Vec<Option<Operand>>,
    assignments: Vec<Assignment>,
}

/// An operation on values of the graph, not yet placed.
struct Shape {
    operation: Operation,
    operands: [u32; 4],
}

impl Fusion<'_> {
    /// Writes one entry of the output.
    fn give(&mut self, entry: u32, output: Option<Signed>, pool: &mut ConstantPool) {
        let Some(Signed { value, negative }) = output else {
            let zero = Operand::Constant(pool.zero());
            self.push(Operation::Copy, [zero; 4], Some(entry));
            return;
        };
        let flow = self.graph.values[value as usize];
        let alone = self.uses[value as usize] == 1 && !matches!(flow, Flow::Leaf(_));
        if alone && let Some(shape) = self.shape(value, negative) {
            for &operand in &shape.operands[..shape.operation.arity()] {
                self.place(operand);
            }
            let operands = self.placed(&shape);
            self.push(shape.operation, operands, Some(entry));
            return;
        }
        self.place(value);
        let operand = self.place[value as usize].expect("just placed");
        let operation = if negative {
            Operation::Negate
        } else {
            Operation::Copy
        };
        self.push(operation, [operand; 4], Some(entry));
    }

    fn push(&mut self, operation: Operation, operands: [Operand; 4], output: Option<u32>) -> u32 {
        let value =
            u32::try_from(self.assignments.len()).expect("a program has fewer than 2^32 values");
        self.assignments.push(Assignment {
            operation,
            operands,
            output,
        });
        value
    }

    /// Computes a value and all that it needs; no recursion, graphs are deep.
    fn place(&mut self, value: u32) {
        let mut stack = vec![(value, false)];
        while let Some((value, ready)) = stack.pop() {
            if self.place[value as usize].is_some() {
                continue;
            }
            if let Flow::Leaf(operand) = self.graph.values[value as usize] {
                self.place[value as usize] = Some(operand);
                continue;
            }
            let shape = self
                .shape(value, false)
                .expect("every operation that is not negated has a shape");
            if ready {
                let operands = self.placed(&shape);
                let number = self.push(shape.operation, operands, None);
                self.place[value as usize] = Some(Operand::Value(number));
            } else {
                stack.push((value, true));
                for &operand in shape.operands[..shape.operation.arity()].iter().rev() {
                    stack.push((operand, false));
                }
            }
        }
    }

    fn placed(&self, shape: &Shape) -> [Operand; 4] {
        let first = self.place[shape.operands[0] as usize].expect("operands are placed first");
        let mut operands = [first; 4];
        for k in 1..shape.operation.arity() {
            operands[k] =
                self.place[shape.operands[k] as usize].expect("operands are placed first");
        }
        operands
    }

    /// The factors of a product that only one sum uses.
    fn product(&self, value: u32) -> Option<(u32, u32)> {
        match self.graph.values[value as usize] {
            Flow::Multiply(a, b) if self.uses[value as usize] == 1 => Some((a, b)),
            Flow::Square(a) if self.uses[value as usize] == 1 => Some((a, a)),
            _ => None,
        }
    }

    /// The factors of a real multiple that only one sum uses.
    fn multiple(&self, value: u32) -> Option<(u32, u32)> {
        match self.graph.values[value as usize] {
            Flow::Scale(c, a) if self.uses[value as usize] == 1 => Some((c, a)),
            _ => None,
        }
    }

    /// The operation that gives a value or its negative, with what it absorbs.
    /// `None` where the negative is not as cheap.
    fn shape(&self, value: u32, negative: bool) -> Option<Shape> {
        let make = |operation, operands: &[u32]| {
            let mut all = [operands[0]; 4];
            all[..operands.len()].copy_from_slice(operands);
            Some(Shape {
                operation,
                operands: all,
            })
        };
        match self.graph.values[value as usize] {
            Flow::Leaf(_) => None,
            Flow::Subtract(x, y) => {
                let (x, y) = if negative { (y, x) } else { (x, y) };
                match (self.product(x), self.product(y)) {
                    (Some((a, b)), Some((c, d))) => {
                        make(Operation::ProductDifference, &[a, b, c, d])
                    }
                    (Some((a, b)), None) => make(Operation::MultiplySubtract, &[a, b, y]),
                    (None, Some((a, b))) => make(Operation::SubtractProduct, &[a, b, x]),
                    (None, None) => match (self.multiple(x), self.multiple(y)) {
                        (Some((c, a)), _) => make(Operation::ScaleSubtract, &[c, a, y]),
                        (None, Some((c, a))) => make(Operation::SubtractScaled, &[c, a, x]),
                        (None, None) => make(Operation::Subtract, &[x, y]),
                    },
                }
            }
            _ if negative => None,
            Flow::Add(x, y) => match (self.product(x), self.product(y)) {
                (Some((a, b)), Some((c, d))) => make(Operation::ProductSum, &[a, b, c, d]),
                (Some((a, b)), None) => make(Operation::MultiplyAdd, &[a, b, y]),
                (None, Some((a, b))) => make(Operation::MultiplyAdd, &[a, b, x]),
                (None, None) => match (self.multiple(x), self.multiple(y)) {
                    (Some((c, a)), _) => make(Operation::ScaleAdd, &[c, a, y]),
                    (None, Some((c, a))) => make(Operation::ScaleAdd, &[c, a, x]),
                    (None, None) => make(Operation::Add, &[x, y]),
                },
            },
            Flow::Multiply(a, b) => make(Operation::Multiply, &[a, b]),
            Flow::Square(a) => make(Operation::Square, &[a]),
            Flow::Scale(c, a) => make(Operation::Scale, &[c, a]),
            Flow::Inverse(a) => make(Operation::Inverse, &[a]),
        }
    }
}
