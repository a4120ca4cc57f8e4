//! Expression: an arena of shared nodes.
//!
//! The formats write into it, the compiler reads it. Equal subexpressions are
//! one node (hash-consing), and what is exact arithmetic on constants is done
//! at once, so that the graph of a system holds no node twice and no work that
//! could have been done before.

mod angles;
pub mod build;
mod constant_accuracy;
pub mod differentiate;
pub mod display;
pub mod exact;
pub mod fault;
pub mod function_name;
mod functions;
mod helper_drafts;
mod helpers_in_making;
pub mod parse;
pub mod similar;
mod step;
pub mod token;

use cognate_numeric::rational::{ComplexRational, Rational};
use foldhash::HashMap;
use serde::{Deserialize, Serialize};

/// One node of an [`Expressions`] arena. Children always have smaller numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct NodeId(pub u32);

/// Elementary functions; they may be applied to constants only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Function {
    /// Square root, principal branch.
    SquareRoot,
    /// Exponential.
    Exponential,
    /// Natural logarithm, principal branch.
    Logarithm,
    /// Sine.
    Sine,
    /// Cosine.
    Cosine,
    /// Tangent.
    Tangent,
    /// The circle constant; its argument is ignored and must be the constant 0.
    Pi,
}

/// A node: a number, a variable, a parameter, or an operation on other nodes.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Node {
    /// An exact number.
    Constant(ComplexRational),
    /// A variable of the system, by its index.
    Variable(u32),
    /// A parameter of the system, by its index.
    Parameter(u32),
    /// Sum.
    Add(NodeId, NodeId),
    /// Difference.
    Subtract(NodeId, NodeId),
    /// Product.
    Multiply(NodeId, NodeId),
    /// Quotient; in equations the denominator contains no variable.
    Divide(NodeId, NodeId),
    /// Negation.
    Negate(NodeId),
    /// Nonnegative integer power, at least 2.
    Power(NodeId, u32),
    /// Rational power of a constant, principal branch: `3^(1/2)`.
    Root(NodeId, Rational),
    /// Elementary function of a constant.
    Function(Function, NodeId),
}

/// Whether a subexpression depends on variables, on parameters only, or on neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dependence {
    /// Neither variables nor parameters: a number, though perhaps not a rational one.
    Constant,
    /// Parameters, but no variable.
    Parameters,
    /// At least one variable.
    Variables,
}

/// For nodes of another arena, their nodes in the arena that imported them.
pub type Imported = HashMap<NodeId, NodeId>;

/// The arena. Nodes are only added; two equal nodes have one number.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(into = "Vec<Node>", try_from = "Vec<Node>")]
pub struct Expressions {
    nodes: Vec<Node>,
    dependence: Vec<Dependence>,
    index: HashMap<Node, NodeId>,
}

/// Nodes that are no graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("node {0} of a graph of expressions is a repetition, or has a child that is not before it")]
pub struct NoGraph(usize);

impl From<Expressions> for Vec<Node> {
    fn from(expressions: Expressions) -> Self {
        expressions.nodes
    }
}

impl TryFrom<Vec<Node>> for Expressions {
    type Error = NoGraph;

    fn try_from(nodes: Vec<Node>) -> Result<Self, NoGraph> {
        let mut expressions = Self::new();
        for (place, node) in nodes.into_iter().enumerate() {
            let before = |child: &NodeId| (child.0 as usize) < place;
            let whole = match &node {
                Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => true,
                Node::Add(a, b)
                | Node::Subtract(a, b)
                | Node::Multiply(a, b)
                | Node::Divide(a, b) => before(a) && before(b),
                Node::Negate(a) | Node::Power(a, _) | Node::Root(a, _) | Node::Function(_, a) => {
                    before(a)
                }
            };
            if !whole || expressions.insert(node).0 as usize != place {
                return Err(NoGraph(place));
            }
        }
        Ok(expressions)
    }
}

impl PartialEq for Expressions {
    fn eq(&self, other: &Self) -> bool {
        self.nodes == other.nodes
    }
}

impl Expressions {
    /// An empty arena.
    pub fn new() -> Self {
        Self::default()
    }

    /// All nodes, children before parents.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The node with this number.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0 as usize]
    }

    /// Whether the node depends on variables, on parameters only, or on neither.
    pub fn dependence(&self, id: NodeId) -> Dependence {
        self.dependence[id.0 as usize]
    }

    /// The exact value, where the node is a rational constant.
    pub fn as_constant(&self, id: NodeId) -> Option<&ComplexRational> {
        match self.node(id) {
            Node::Constant(c) => Some(c),
            _ => None,
        }
    }

    /// Puts a node as it is, without simplification, unless it is there already.
    ///
    /// For decoders and writers that must keep a graph as it was; children must exist.
    pub fn insert(&mut self, node: Node) -> NodeId {
        if let Some(&id) = self.index.get(&node) {
            return id;
        }
        let dependence = match &node {
            Node::Constant(_) => Dependence::Constant,
            Node::Variable(_) => Dependence::Variables,
            Node::Parameter(_) => Dependence::Parameters,
            Node::Add(a, b) | Node::Subtract(a, b) | Node::Multiply(a, b) | Node::Divide(a, b) => {
                self.dependence(*a).max(self.dependence(*b))
            }
            Node::Negate(a) | Node::Power(a, _) | Node::Root(a, _) | Node::Function(_, a) => {
                self.dependence(*a)
            }
        };
        let id =
            NodeId(u32::try_from(self.nodes.len()).expect("an arena holds at most 2^32 nodes"));
        self.nodes.push(node.clone());
        self.dependence.push(dependence);
        self.index.insert(node, id);
        id
    }

    /// An exact number.
    pub fn constant(&mut self, value: ComplexRational) -> NodeId {
        self.insert(Node::Constant(value))
    }

    /// An integer.
    pub fn integer(&mut self, value: i64) -> NodeId {
        self.constant(ComplexRational::real(value))
    }

    /// A variable, by its index in the system.
    pub fn variable(&mut self, index: u32) -> NodeId {
        self.insert(Node::Variable(index))
    }

    /// A parameter, by its index in the system.
    pub fn parameter(&mut self, index: u32) -> NodeId {
        self.insert(Node::Parameter(index))
    }

    /// `a + b`.
    pub fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.as_constant(a), self.as_constant(b)) {
            (Some(x), Some(y)) => {
                let sum = x.add(y);
                return self.constant(sum);
            }
            (Some(x), None) if x.is_zero() => return b,
            (None, Some(y)) if y.is_zero() => return a,
            _ => {}
        }
        if let Node::Negate(inner) = *self.node(b) {
            return self.subtract(a, inner);
        }
        if let Node::Negate(inner) = *self.node(a) {
            return self.subtract(b, inner);
        }
        // One order for a commutative operation, so that a + b and b + a are one node.
        let (a, b) = if a <= b { (a, b) } else { (b, a) };
        self.insert(Node::Add(a, b))
    }

    /// `a - b`.
    pub fn subtract(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if a == b {
            return self.integer(0);
        }
        match (self.as_constant(a), self.as_constant(b)) {
            (Some(x), Some(y)) => {
                let difference = x.subtract(y);
                return self.constant(difference);
            }
            (Some(x), None) if x.is_zero() => return self.negate(b),
            (None, Some(y)) if y.is_zero() => return a,
            _ => {}
        }
        if let Node::Negate(inner) = *self.node(b) {
            return self.add(a, inner);
        }
        self.insert(Node::Subtract(a, b))
    }

    /// `a * b`.
    pub fn multiply(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.as_constant(a), self.as_constant(b)) {
            (Some(x), Some(y)) => {
                let product = x.multiply(y);
                return self.constant(product);
            }
            (Some(x), None) => {
                if x.is_zero() {
                    return a;
                }
                if x.is_one() {
                    return b;
                }
                if *x == ComplexRational::real(-1) {
                    return self.negate(b);
                }
            }
            (None, Some(_)) => return self.multiply(b, a),
            _ => {}
        }
        if a == b {
            return self.power(a, 2);
        }
        let (a, b) = if a <= b { (a, b) } else { (b, a) };
        self.insert(Node::Multiply(a, b))
    }

    /// `a / b`; `b` must not be exactly 0 (the formats check that).
    ///
    /// In equations `b` contains no variable; only rational maps of a symmetry may have one there.
    pub fn divide(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if let Some(y) = self.as_constant(b).cloned() {
            if let Some(x) = self.as_constant(a) {
                let quotient = x
                    .divide(&y)
                    .expect("a zero denominator is refused where it is read");
                return self.constant(quotient);
            }
            let inverse = ComplexRational::real(1)
                .divide(&y)
                .expect("a zero denominator is refused where it is read");
            let inverse = self.constant(inverse);
            return self.multiply(inverse, a);
        }
        if self.as_constant(a).is_some_and(ComplexRational::is_zero) {
            return a;
        }
        self.insert(Node::Divide(a, b))
    }

    /// `-a`.
    pub fn negate(&mut self, a: NodeId) -> NodeId {
        match self.node(a) {
            Node::Constant(x) => {
                let negative = x.negate();
                self.constant(negative)
            }
            Node::Negate(inner) => *inner,
            &Node::Subtract(x, y) => self.subtract(y, x),
            _ => self.insert(Node::Negate(a)),
        }
    }

    /// `a` to a nonnegative integer power.
    ///
    /// Exact constants are expanded only while the result stays small; the
    /// formats refuse exponents past their limit before they come here.
    pub fn power(&mut self, a: NodeId, exponent: u32) -> NodeId {
        match exponent {
            0 => return self.integer(1),
            1 => return a,
            _ => {}
        }
        if let Some(x) = self.as_constant(a) {
            let bits = x.re.numer().significant_bits()
                + x.re.denom().significant_bits()
                + x.im.numer().significant_bits()
                + x.im.denom().significant_bits();
            if u64::from(bits) * u64::from(exponent) <= 1 << 20 {
                let value = x.power(exponent);
                return self.constant(value);
            }
        }
        self.insert(Node::Power(a, exponent))
    }

    /// `a` to a rational power, principal branch; `a` must be a constant.
    pub fn root(&mut self, a: NodeId, exponent: Rational) -> NodeId {
        assert!(
            self.dependence(a) == Dependence::Constant,
            "a root of something that is not constant is refused where it is read"
        );
        self.insert(Node::Root(a, exponent))
    }

    /// An elementary function of a constant.
    pub fn function(&mut self, function: Function, a: NodeId) -> NodeId {
        assert!(
            self.dependence(a) == Dependence::Constant,
            "an elementary function of something that is not constant is refused where it is read"
        );
        self.insert(Node::Function(function, a))
    }

    /// Copies the subgraph below `root` out of `other` into this arena, with
    /// every variable and parameter replaced by what `leaf` gives for it.
    ///
    /// `memory` maps nodes already copied; keep it between calls on one `other`.
    pub fn import(
        &mut self,
        other: &Expressions,
        root: NodeId,
        memory: &mut Imported,
        leaf: &mut dyn FnMut(&mut Expressions, &Node) -> NodeId,
    ) -> NodeId {
        // Children have smaller numbers, so an ascending sweep over what is
        // needed never recurses: graphs may be deeper than the stack.
        let mut needed = vec![false; root.0 as usize + 1];
        needed[root.0 as usize] = true;
        for id in (0..=root.0).rev() {
            if !needed[id as usize] || memory.contains_key(&NodeId(id)) {
                continue;
            }
            for child in other.children(NodeId(id)) {
                needed[child.0 as usize] = true;
            }
        }
        for id in 0..=root.0 {
            let id = NodeId(id);
            if !needed[id.0 as usize] || memory.contains_key(&id) {
                continue;
            }
            let copy = match other.node(id) {
                Node::Constant(c) => self.constant(c.clone()),
                node @ (Node::Variable(_) | Node::Parameter(_)) => leaf(self, node),
                Node::Add(a, b) => self.add(memory[a], memory[b]),
                Node::Subtract(a, b) => self.subtract(memory[a], memory[b]),
                Node::Multiply(a, b) => self.multiply(memory[a], memory[b]),
                // A rational map keeps its denominators as they are.
                Node::Divide(a, b) => match (memory[a], memory[b]) {
                    (a, b) if self.dependence(b) == Dependence::Variables => {
                        self.insert(Node::Divide(a, b))
                    }
                    (a, b) => self.divide(a, b),
                },
                Node::Negate(a) => self.negate(memory[a]),
                Node::Power(a, e) => self.power(memory[a], *e),
                Node::Root(a, e) => self.root(memory[a], e.clone()),
                Node::Function(f, a) => self.function(*f, memory[a]),
            };
            memory.insert(id, copy);
        }
        memory[&root]
    }

    /// An upper bound of the degree of every node in the variables, without overflow. Nothing is divided by variables.
    pub fn degree_bounds(&self) -> Vec<u64> {
        let mut degrees: Vec<u64> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let operand_degree = |id: &NodeId| degrees[id.0 as usize];
            let degree = match node {
                Node::Variable(_) => 1,
                Node::Constant(_) | Node::Parameter(_) | Node::Root(..) | Node::Function(..) => 0,
                Node::Add(a, b) | Node::Subtract(a, b) => operand_degree(a).max(operand_degree(b)),
                Node::Multiply(a, b) => operand_degree(a).saturating_add(operand_degree(b)),
                Node::Divide(a, _) | Node::Negate(a) => operand_degree(a),
                Node::Power(a, exponent) => operand_degree(a).saturating_mul(u64::from(*exponent)),
            };
            degrees.push(degree);
        }
        degrees
    }

    /// The children of a node, at most two.
    pub fn children(&self, id: NodeId) -> impl Iterator<Item = NodeId> + use<> {
        let (a, b) = match self.node(id) {
            Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => (None, None),
            Node::Add(a, b) | Node::Subtract(a, b) | Node::Multiply(a, b) | Node::Divide(a, b) => {
                (Some(*a), Some(*b))
            }
            Node::Negate(a) | Node::Power(a, _) | Node::Root(a, _) | Node::Function(_, a) => {
                (Some(*a), None)
            }
        };
        a.into_iter().chain(b)
    }
}
