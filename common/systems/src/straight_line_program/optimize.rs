//! From a flow graph to assignments: dead code dropped, sums fused with their terms.
//!
//! A sum or product that only one sum uses becomes part of that sum, and a
//! multiple by a constant part of every sum that uses it.
//! The order of evaluation inside a sum is fixed (`instruction.rs`), so what a
//! program gives is decided here and not by the schedule.

use super::compile::{Flow, FlowGraph, Signed};
use super::constant::ConstantPool;
use super::instruction::{Assignment, Operand, Operation, Terms};

/// Longest sum of one instruction; longer ones are formed in pieces.
const MOST_TERMS: usize = 64;

/// Turns the graph into assignments in depth-first order of the outputs, which
/// keeps what belongs together near together. Constants are numbered by the pool.
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
        pool,
        place: vec![None; graph.values.len()],
        assignments: Vec::new(),
    };
    for (entry, output) in graph.outputs.iter().enumerate() {
        let entry = u32::try_from(entry).expect("a program has fewer than 2^32 outputs");
        fusion.give(entry, *output);
    }
    fusion.assignments
}

struct Fusion<'a> {
    graph: &'a FlowGraph,
    uses: Vec<u32>,
    pool: &'a mut ConstantPool,
    place: Vec<Option<Operand>>,
    assignments: Vec<Assignment>,
}

/// A value as it will be computed, from values not yet placed.
#[derive(Default)]
struct Shape {
    plus: Vec<u32>,
    minus: Vec<u32>,
    scaled: Vec<(u32, u32)>,
    turned: Vec<(u32, u32)>,
    products: Vec<(u32, u32)>,
    negatives: Vec<(u32, u32)>,
    /// Square or reciprocal, with its operand in `plus`.
    alone: Option<Operation>,
}

impl Shape {
    /// The values that it needs, in the order of the terms.
    fn needs(&self) -> Vec<u32> {
        let values = self.plus.iter().chain(&self.minus).copied();
        let multiples = self.scaled.iter().chain(&self.turned).map(|&(_, a)| a);
        let products = self.products.iter().chain(&self.negatives);
        values
            .chain(multiples)
            .chain(products.flat_map(|&(a, b)| [a, b]))
            .collect()
    }
}

impl Fusion<'_> {
    /// Writes one entry of the output.
    fn give(&mut self, entry: u32, output: Option<Signed>) {
        let Some(Signed { value, negative }) = output else {
            let zero = Operand::Constant(self.pool.zero());
            let copy = Operation::Sum(Terms {
                plus: 1,
                ..Terms::default()
            });
            self.push(copy, vec![zero], Some(entry));
            return;
        };
        let flow = self.graph.values[value as usize];
        let alone = self.uses[value as usize] == 1
            && !matches!(flow, Flow::Leaf(_))
            && !(negative && matches!(flow, Flow::Inverse(_)));
        let shape = if alone {
            self.shape(value, negative)
        } else {
            // Used elsewhere too: copied, perhaps with the other sign.
            let mut shape = Shape::default();
            let side = if negative {
                &mut shape.minus
            } else {
                &mut shape.plus
            };
            side.push(value);
            shape
        };
        for need in shape.needs() {
            self.compute(need);
        }
        self.emit(&shape, Some(entry));
    }

    fn push(&mut self, operation: Operation, operands: Vec<Operand>, output: Option<u32>) -> u32 {
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
    fn compute(&mut self, value: u32) {
        let mut stack = vec![(value, false)];
        while let Some((value, ready)) = stack.pop() {
            if self.place[value as usize].is_some() {
                continue;
            }
            if let Flow::Leaf(operand) = self.graph.values[value as usize] {
                self.place[value as usize] = Some(operand);
                continue;
            }
            let shape = self.shape(value, false);
            if ready {
                let number = self.emit(&shape, None);
                self.place[value as usize] = Some(Operand::Value(number));
            } else {
                stack.push((value, true));
                stack.extend(shape.needs().into_iter().rev().map(|need| (need, false)));
            }
        }
    }

    fn placed(&self, value: u32) -> Operand {
        self.place[value as usize].expect("operands are placed first")
    }

    /// Assigns a shape whose needs are placed; long sums in pieces.
    fn emit(&mut self, shape: &Shape, output: Option<u32>) -> u32 {
        if let Some(operation) = shape.alone {
            let operand = self.placed(shape.plus[0]);
            return self.push(operation, vec![operand], output);
        }
        #[derive(Clone, Copy)]
        enum Kind {
            Plus,
            Minus,
            Scaled,
            Turned,
            Product,
            Negative,
        }
        let mut terms: Vec<(Kind, [Operand; 2])> = Vec::new();
        let pair = |operand| [operand, operand];
        terms.extend(
            shape
                .plus
                .iter()
                .map(|&a| (Kind::Plus, pair(self.placed(a)))),
        );
        terms.extend(
            shape
                .minus
                .iter()
                .map(|&a| (Kind::Minus, pair(self.placed(a)))),
        );
        for (list, kind) in [(&shape.scaled, Kind::Scaled), (&shape.turned, Kind::Turned)] {
            let multiple = |&(c, a): &(u32, u32)| (kind, [Operand::Single(c), self.placed(a)]);
            terms.extend(list.iter().map(multiple));
        }
        for (list, kind) in [
            (&shape.products, Kind::Product),
            (&shape.negatives, Kind::Negative),
        ] {
            let product = |&(a, b): &(u32, u32)| (kind, [self.placed(a), self.placed(b)]);
            terms.extend(list.iter().map(product));
        }
        let mut rest = terms.as_slice();
        let mut carried: Option<u32> = None;
        loop {
            let (sum_terms, later) = rest.split_at(rest.len().min(MOST_TERMS));
            let mut counts = Terms::default();
            let mut operands = Vec::new();
            if let Some(sum) = carried {
                counts.plus += 1;
                operands.push(Operand::Value(sum));
            }
            for (kind, pair) in sum_terms {
                let (count, used) = match kind {
                    Kind::Plus => (&mut counts.plus, &pair[..1]),
                    Kind::Minus => (&mut counts.minus, &pair[..1]),
                    Kind::Scaled => (&mut counts.scaled, &pair[..]),
                    Kind::Turned => (&mut counts.turned, &pair[..]),
                    Kind::Product => (&mut counts.products, &pair[..]),
                    Kind::Negative => (&mut counts.negatives, &pair[..]),
                };
                *count += 1;
                operands.extend_from_slice(used);
            }
            let last = later.is_empty();
            let number = self.push(
                Operation::Sum(counts),
                operands,
                if last { output } else { None },
            );
            if last {
                return number;
            }
            carried = Some(number);
            rest = later;
        }
    }

    /// Shape of the computation of a value or its negative; values that only it uses are absorbed.
    fn shape(&mut self, value: u32, negative: bool) -> Shape {
        let mut shape = Shape::default();
        match self.graph.values[value as usize] {
            Flow::Square(a) if !negative => {
                shape.alone = Some(Operation::Square);
                shape.plus.push(a);
                return shape;
            }
            Flow::Inverse(a) => {
                assert!(!negative, "a negative reciprocal is computed in two steps");
                shape.alone = Some(Operation::Inverse);
                shape.plus.push(a);
                return shape;
            }
            _ => {}
        }
        let mut stack = vec![(value, negative)];
        while let Some((term, negative)) = stack.pop() {
            let absorbed = term == value || self.uses[term as usize] == 1;
            match self.graph.values[term as usize] {
                Flow::Add(a, b) if absorbed => stack.extend([(b, negative), (a, negative)]),
                Flow::Subtract(a, b) if absorbed => stack.extend([(b, !negative), (a, negative)]),
                Flow::Multiply(a, b) if absorbed => {
                    let side = if negative {
                        &mut shape.negatives
                    } else {
                        &mut shape.products
                    };
                    side.push((a, b));
                }
                Flow::Square(a) if absorbed => {
                    let side = if negative {
                        &mut shape.negatives
                    } else {
                        &mut shape.products
                    };
                    side.push((a, a));
                }
                // One more constant to read is cheaper than one more value to store.
                Flow::Scale(c, a) => {
                    let constant = match self.graph.values[c as usize] {
                        Flow::Leaf(Operand::Constant(constant)) => constant,
                        _ => unreachable!("a multiple's first operand is a constant"),
                    };
                    let constant = if negative {
                        self.pool.negative(constant)
                    } else {
                        constant
                    };
                    if self.pool.is_real(constant) {
                        shape.scaled.push((constant, a));
                    } else {
                        shape.turned.push((constant, a));
                    }
                }
                _ if negative => shape.minus.push(term),
                _ => shape.plus.push(term),
            }
        }
        shape
    }
}
