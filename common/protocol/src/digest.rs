//! Digest of a system: its name by content, the same on every machine.
//!
//! BLAKE3 over an encoding of our own: tagged, every length written, numbers
//! little endian, rationals in lowest terms in hexadecimal, names in order.
//! Protobuf bytes are not canonical, so they are not used. The graph counts as
//! it stands: the order of its nodes decides the order of roundings. Settings
//! are no part of it.

use cognate_continuation::start_points::Digest;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::{Function, Node, NodeId};
use cognate_systems::system::{DegenerateSet, SymmetryGenerator, System};

/// Version of the encoding; a change of it gives every system a new name.
const MAGIC: &[u8] = b"cognate system 1\n";

/// The digest of these bytes.
pub fn of_bytes(bytes: &[u8]) -> Digest {
    Digest(*blake3::hash(bytes).as_bytes())
}

/// The digest of a checked system.
pub fn of_system(system: &System) -> Digest {
    let mut w = Writer(blake3::Hasher::new());
    w.0.update(MAGIC);
    let System {
        expressions,
        variables,
        parameters,
        groups,
        equations,
        equation_names,
        path_variable,
        conjugates,
        degenerate,
        symmetry,
    } = system;
    w.names(variables);
    w.names(parameters);
    w.length(groups.len());
    for group in groups {
        w.byte(u8::from(group.homogeneous));
        w.indices(&group.variables);
    }
    w.length(expressions.nodes().len());
    for node in expressions.nodes() {
        w.node(node);
    }
    w.nodes(equations);
    // A name that is not there and an empty name are the same.
    for i in 0..equations.len() {
        w.bytes(equation_names.get(i).map_or(b"", |name| name.as_bytes()));
    }
    match path_variable {
        None => w.byte(0),
        Some(index) => {
            w.byte(1);
            w.length(*index);
        }
    }
    w.length(conjugates.len());
    for (a, b) in conjugates {
        w.length(*a);
        w.length(*b);
    }
    w.length(degenerate.len());
    for (name, set) in degenerate {
        w.bytes(name.as_bytes());
        match set {
            DegenerateSet::Nonzero(node) => {
                w.byte(0);
                w.word(node.0);
            }
            DegenerateSet::Equations(nodes) => {
                w.byte(1);
                w.nodes(nodes);
            }
        }
    }
    w.length(symmetry.len());
    for generator in symmetry {
        match generator {
            SymmetryGenerator::Permutation(images) => {
                w.byte(0);
                w.indices(images);
            }
            SymmetryGenerator::Map(nodes) => {
                w.byte(1);
                w.nodes(nodes);
            }
        }
    }
    Digest(*w.0.finalize().as_bytes())
}

struct Writer(blake3::Hasher);

impl Writer {
    fn byte(&mut self, byte: u8) {
        self.0.update(&[byte]);
    }

    fn word(&mut self, word: u32) {
        self.0.update(&word.to_le_bytes());
    }

    fn length(&mut self, length: usize) {
        self.0.update(&(length as u64).to_le_bytes());
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.length(bytes.len());
        self.0.update(bytes);
    }

    fn names(&mut self, names: &[String]) {
        self.length(names.len());
        for name in names {
            self.bytes(name.as_bytes());
        }
    }

    fn indices(&mut self, indices: &[usize]) {
        self.length(indices.len());
        for &index in indices {
            self.length(index);
        }
    }

    fn nodes(&mut self, nodes: &[NodeId]) {
        self.length(nodes.len());
        for node in nodes {
            self.word(node.0);
        }
    }

    fn rational(&mut self, value: &Rational) {
        self.bytes(value.numer().to_string_radix(16).as_bytes());
        self.bytes(value.denom().to_string_radix(16).as_bytes());
    }

    fn complex(&mut self, value: &ComplexRational) {
        self.rational(&value.re);
        self.rational(&value.im);
    }

    fn pair(&mut self, tag: u8, a: NodeId, b: NodeId) {
        self.byte(tag);
        self.word(a.0);
        self.word(b.0);
    }

    fn node(&mut self, node: &Node) {
        match node {
            Node::Constant(value) => {
                self.byte(0);
                self.complex(value);
            }
            Node::Variable(index) => {
                self.byte(1);
                self.word(*index);
            }
            Node::Parameter(index) => {
                self.byte(2);
                self.word(*index);
            }
            Node::Add(a, b) => self.pair(3, *a, *b),
            Node::Subtract(a, b) => self.pair(4, *a, *b),
            Node::Multiply(a, b) => self.pair(5, *a, *b),
            Node::Divide(a, b) => self.pair(6, *a, *b),
            Node::Negate(a) => {
                self.byte(7);
                self.word(a.0);
            }
            Node::Power(a, exponent) => {
                self.byte(8);
                self.word(a.0);
                self.word(*exponent);
            }
            Node::Root(a, exponent) => {
                self.byte(9);
                self.word(a.0);
                self.rational(exponent);
            }
            Node::Function(function, a) => {
                self.byte(10);
                self.byte(match function {
                    Function::SquareRoot => 0,
                    Function::Exponential => 1,
                    Function::Logarithm => 2,
                    Function::Sine => 3,
                    Function::Cosine => 4,
                    Function::Tangent => 5,
                    Function::Pi => 6,
                });
                self.word(a.0);
            }
        }
    }
}
