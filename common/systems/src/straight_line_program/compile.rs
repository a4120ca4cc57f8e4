//! From an expression graph to a flow graph: signs, constants and powers resolved.
//!
//! The input is the arena with the wanted expressions. The result has only sums, differences, products, squares,
//! multiples and inverses of inputs and constants. Signs are carried outwards, so that a and -a are one value; powers
//! of one base share their repeated products.

use super::constant::{Constant, ConstantPool};
use super::instruction::Operand;
use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Node, NodeId};
use cognate_numeric::rational::ComplexRational;
use foldhash::{HashMap, HashMapExt};
use std::collections::{BTreeMap, BTreeSet};

/// A value of the flow graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Flow {
    /// An input or a constant.
    Leaf(Operand),
    /// Sum; the first has the smaller number.
    Add(u32, u32),
    /// Difference; the first has the smaller number.
    Subtract(u32, u32),
    /// Product; the first has the smaller number.
    Multiply(u32, u32),
    /// Square.
    Square(u32),
    /// A constant times a value.
    Scale(u32, u32),
    /// Reciprocal.
    Inverse(u32),
}

impl Flow {
    /// The values that this one is made of.
    pub(crate) fn operands(self) -> impl Iterator<Item = u32> {
        let (a, b) = match self {
            Self::Leaf(_) => (None, None),
            Self::Square(a) | Self::Inverse(a) => (Some(a), None),
            Self::Add(a, b) | Self::Subtract(a, b) | Self::Multiply(a, b) | Self::Scale(a, b) => {
                (Some(a), Some(b))
            }
        };
        a.into_iter().chain(b)
    }
}

/// A value with a sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Signed {
    /// Number of the value in the graph.
    pub value: u32,
    /// True for its negative.
    pub negative: bool,
}

impl Signed {
    fn negate_if(self, negate: bool) -> Self {
        Self {
            negative: self.negative != negate,
            ..self
        }
    }
}

/// The flow graph under construction; `None` stands for exactly 0.
pub(crate) struct FlowGraph {
    /// All values, operands before results.
    pub values: Vec<Flow>,
    /// Values that the program computes; `None` is 0.
    pub outputs: Vec<Option<Signed>>,
    index: HashMap<Flow, u32>,
    association: Association,
}

/// Bracketing of a product with a constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Association {
    /// As it was written: (c*x)*y shares c*x with a derivative.
    AsWritten,
    /// Constants outermost: c*(x*y) shares x*y with other equations.
    ConstantsOutside,
}

/// The first parameter that stands for a direction instead: parameters from
/// here on are derivatives of parameters along the path.
pub(crate) type FirstDirection = u32;

impl FlowGraph {
    /// Lowers the wanted expressions; constants go into the pool.
    pub(crate) fn lower(
        expressions: &Expressions,
        wanted: &[NodeId],
        first_direction: FirstDirection,
        association: Association,
        pool: &mut ConstantPool,
    ) -> Self {
        let mut graph = Self {
            association,
            values: Vec::new(),
            outputs: Vec::new(),
            index: HashMap::new(),
        };
        let order = below(expressions, wanted);
        let chains = power_chains(expressions, &order);
        let mut powers: HashMap<(NodeId, u32), Signed> = HashMap::new();
        let mut done: HashMap<NodeId, Option<Signed>> = HashMap::new();
        for id in order {
            let value = if expressions.dependence(id) == Dependence::Constant {
                let constant = pool.describe(expressions, id);
                graph.constant(pool, constant)
            } else {
                match *expressions.node(id) {
                    Node::Variable(v) => Some(graph.leaf(Operand::Variable(v))),
                    Node::Parameter(p) if p < first_direction => {
                        Some(graph.leaf(Operand::Parameter(p)))
                    }
                    Node::Parameter(p) => Some(graph.leaf(Operand::Direction(p - first_direction))),
                    Node::Add(a, b) => graph.add(pool, done[&a], done[&b]),
                    Node::Subtract(a, b) => {
                        let minus = done[&b].map(|b| b.negate_if(true));
                        graph.add(pool, done[&a], minus)
                    }
                    Node::Negate(a) => done[&a].map(|a| a.negate_if(true)),
                    Node::Multiply(a, b) => graph.multiply(pool, done[&a], done[&b]),
                    Node::Divide(a, b) => {
                        let inverse = graph.inverse(pool, done[&b]);
                        graph.multiply(pool, done[&a], Some(inverse))
                    }
                    Node::Power(a, exponent) => match done[&a] {
                        None => None,
                        Some(base) => {
                            powers.insert((a, 1), base);
                            for step in &chains[&a] {
                                let (left, right) = (powers[&(a, step.0)], powers[&(a, step.1)]);
                                let product = graph
                                    .multiply(pool, Some(left), Some(right))
                                    .expect("a product of values that are not 0");
                                powers.insert((a, step.0 + step.1), product);
                            }
                            Some(powers[&(a, exponent)])
                        }
                    },
                    Node::Constant(_) | Node::Root(..) | Node::Function(..) => {
                        unreachable!("constants were handled by their dependence")
                    }
                }
            };
            done.insert(id, value);
        }
        graph.outputs = wanted.iter().map(|id| done[id]).collect();
        graph
    }

    fn insert(&mut self, flow: Flow) -> u32 {
        if let Some(&value) = self.index.get(&flow) {
            return value;
        }
        let value = u32::try_from(self.values.len()).expect("a program has fewer than 2^32 values");
        self.values.push(flow);
        self.index.insert(flow, value);
        value
    }

    fn leaf(&mut self, operand: Operand) -> Signed {
        Signed {
            value: self.insert(Flow::Leaf(operand)),
            negative: false,
        }
    }

    /// A constant, with its sign outside: c and -c are one constant.
    fn constant(&mut self, pool: &mut ConstantPool, constant: Constant) -> Option<Signed> {
        let (constant, negative) = match constant {
            Constant::Exact(c) if c.is_zero() => return None,
            Constant::Exact(c) => {
                let negative = c.re < 0 || (c.re == 0 && c.im < 0);
                let positive = if negative { c.negate() } else { c };
                (Constant::Exact(positive), negative)
            }
            algebraic => (algebraic, false),
        };
        let leaf = self.leaf(Operand::Constant(pool.insert(constant)));
        Some(leaf.negate_if(negative))
    }

    /// The exact constant that a value is, if it is one.
    fn exact<'a>(&self, pool: &'a ConstantPool, value: u32) -> Option<&'a ComplexRational> {
        match self.values[value as usize] {
            Flow::Leaf(Operand::Constant(c)) => match &pool.constants()[c as usize] {
                Constant::Exact(c) => Some(c),
                Constant::Algebraic(_) => None,
            },
            _ => None,
        }
    }

    fn add(
        &mut self,
        pool: &mut ConstantPool,
        a: Option<Signed>,
        b: Option<Signed>,
    ) -> Option<Signed> {
        let (Some(a), Some(b)) = (a, b) else {
            return a.or(b);
        };
        if let (Some(x), Some(y)) = (self.exact(pool, a.value), self.exact(pool, b.value)) {
            let x = if a.negative { x.negate() } else { x.clone() };
            let sum = if b.negative { x.subtract(y) } else { x.add(y) };
            return self.constant(pool, Constant::Exact(sum));
        }
        if a.value == b.value && a.negative != b.negative {
            return None;
        }
        let (first, second) = if a.value <= b.value { (a, b) } else { (b, a) };
        let value = if a.negative == b.negative {
            self.insert(Flow::Add(first.value, second.value))
        } else {
            self.insert(Flow::Subtract(first.value, second.value))
        };
        Some(Signed {
            value,
            negative: first.negative,
        })
    }

    fn multiply(
        &mut self,
        pool: &mut ConstantPool,
        a: Option<Signed>,
        b: Option<Signed>,
    ) -> Option<Signed> {
        let (a, b) = (a?, b?);
        let negative = a.negative != b.negative;
        if a.value == b.value {
            let value = self.insert(Flow::Square(a.value));
            return Some(Signed { value, negative });
        }
        for (number, factor) in [(a, b), (b, a)] {
            let Flow::Leaf(Operand::Constant(_)) = self.values[number.value as usize] else {
                continue;
            };
            let (mut number, mut factor) = (number.value, factor.value);
            let mut negative = negative;
            // Exact constants that meet become one.
            if let Some(c) = self.exact(pool, number).cloned() {
                let (inner, rest) = match self.values[factor as usize] {
                    Flow::Scale(inner, value) => (inner, Some(value)),
                    _ => (factor, None),
                };
                if let Some(d) = self.exact(pool, inner) {
                    let product = c.multiply(d);
                    let constant = self.constant(pool, Constant::Exact(product))?;
                    negative = negative != constant.negative;
                    number = constant.value;
                    match rest {
                        None => {
                            return Some(Signed {
                                value: number,
                                negative,
                            });
                        }
                        Some(value) => factor = value,
                    }
                }
                if self
                    .exact(pool, number)
                    .is_some_and(ComplexRational::is_one)
                {
                    return Some(Signed {
                        value: factor,
                        negative,
                    });
                }
            }
            let value = self.insert(Flow::Scale(number, factor));
            return Some(Signed { value, negative });
        }
        if self.association == Association::ConstantsOutside {
            for (multiple, factor) in [(a, b), (b, a)] {
                if let Flow::Scale(constant, rest) = self.values[multiple.value as usize] {
                    let rest = Signed {
                        value: rest,
                        negative: false,
                    };
                    let constant = Signed {
                        value: constant,
                        negative,
                    };
                    let factor = Signed {
                        negative: false,
                        ..factor
                    };
                    let product = self.multiply(pool, Some(rest), Some(factor));
                    return self.multiply(pool, Some(constant), product);
                }
            }
        }
        let (first, second) = (a.value.min(b.value), a.value.max(b.value));
        let value = self.insert(Flow::Multiply(first, second));
        Some(Signed { value, negative })
    }

    fn inverse(&mut self, pool: &mut ConstantPool, a: Option<Signed>) -> Signed {
        // A denominator that cancels to 0 gives infinities, as division does.
        let a = a.unwrap_or_else(|| self.leaf(Operand::Constant(pool.zero())));
        if let Flow::Leaf(Operand::Constant(c)) = self.values[a.value as usize]
            && let Some(inverse) = pool.inverse(c)
        {
            let constant = self.leaf(Operand::Constant(inverse));
            return constant.negate_if(a.negative);
        }
        Signed {
            value: self.insert(Flow::Inverse(a.value)),
            negative: a.negative,
        }
    }
}

/// For each base, the products (i, j) that give all its wanted powers
/// `a^(i+j) = a^i * a^j`, in order.
fn power_chains(expressions: &Expressions, order: &[NodeId]) -> HashMap<NodeId, Vec<(u32, u32)>> {
    let mut wanted: BTreeMap<NodeId, BTreeSet<u32>> = BTreeMap::new();
    for &id in order {
        if let Node::Power(a, exponent) = *expressions.node(id) {
            wanted.entry(a).or_default().insert(exponent);
        }
    }
    wanted
        .into_iter()
        .map(|(base, exponents)| (base, power_chain(exponents)))
        .collect()
}

fn power_chain(mut exponents: BTreeSet<u32>) -> Vec<(u32, u32)> {
    exponents.insert(1);
    let split = |set: &BTreeSet<u32>, e: u32| {
        set.range(e.div_ceil(2)..e)
            .rev()
            .find(|&&i| set.contains(&(e - i)))
            .map(|&i| (i, e - i))
    };
    let mut next = exponents.last().copied();
    while let Some(e) = next {
        if e > 1 && split(&exponents, e).is_none() {
            if e % 2 == 0 {
                exponents.insert(e / 2);
            } else {
                exponents.insert(e - 1);
            }
        }
        next = exponents.range(..e).next_back().copied();
    }
    exponents
        .iter()
        .filter(|&&e| e > 1)
        .map(|&e| split(&exponents, e).expect("every exponent was given a split above"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::power_chain;

    #[test]
    fn powers_share_their_products() {
        assert_eq!(power_chain([2].into()), [(1, 1)]);
        assert_eq!(power_chain([4, 5].into()), [(1, 1), (2, 2), (4, 1)]);
        assert_eq!(power_chain([2, 3, 4].into()), [(1, 1), (2, 1), (3, 1)]);
        for exponent in 2..200 {
            let chain = power_chain([exponent].into());
            let mut chain_exponents = vec![1];
            for (i, j) in &chain {
                assert!(chain_exponents.contains(i) && chain_exponents.contains(j));
                chain_exponents.push(i + j);
            }
            assert_eq!(chain_exponents.last(), Some(&exponent));
            assert!(chain.len() < 2 * 8);
        }
    }
}
