//! Nodes of a System message into the arena of expressions, each checked against the nodes before it.

use super::{at, required};
use crate::error::{ProtocolError, within_limit};
use crate::limits;
use crate::v1;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::{Dependence, Expressions, Function, Node, NodeId};
use cognate_systems::formats::limits as sizes;
use cognate_systems::helper_unknown::{AngleUnit, AngleUnknowns, Branch, Helper, RootUnknown};
use cognate_systems::system::SymmetryGenerator;

/// An exact rational, `p` or `p/q`.
pub fn rational(text: &str) -> Result<Rational, ProtocolError> {
    if text.is_empty() {
        return Ok(Rational::new());
    }
    let limit = limits::Limit {
        value: 2 * sizes::NUMBER_DIGITS.value,
        ..sizes::NUMBER_DIGITS
    };
    within_limit("", text.len(), limit)?;
    let expected = "`p` or `p/q` with decimal integers and q not 0";
    let bad = || ProtocolError::invalid("", format!("`{text}`"), expected);
    let number = text.strip_prefix('-').unwrap_or(text);
    let (p, q) = number.split_once('/').unwrap_or((number, "1"));
    let decimal = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    if !decimal(p) || !decimal(q) || q.bytes().all(|b| b == b'0') {
        return Err(bad());
    }
    Rational::parse(text).map(Rational::from).map_err(|_| bad())
}

/// Refuses a name that is empty, too long, or has blanks.
pub(super) fn check_name(name: &str) -> Result<(), ProtocolError> {
    within_limit("", name.len(), limits::NAME_BYTES)?;
    if name.is_empty() || name.chars().any(|c| c.is_control() || c.is_whitespace()) {
        return Err(ProtocolError::invalid(
            "",
            format!("{name:?}"),
            "a name without spaces",
        ));
    }
    Ok(())
}

/// An index below `count`, the number of the things that `what` names.
pub(super) fn index(
    field: impl Into<String>,
    index: u32,
    count: usize,
    what: &str,
) -> Result<usize, ProtocolError> {
    let position = index as usize;
    if position < count {
        return Ok(position);
    }
    Err(ProtocolError::invalid(
        field,
        position,
        format!("an index below the number of {what}, {count}"),
    ))
}

/// An index of one of `count` variables.
pub(super) fn variable(field: String, v: u32, count: usize) -> Result<usize, ProtocolError> {
    index(field, v, count, "variables")
}

/// The graph of expressions as far as it has been read.
pub(super) struct Graph {
    variables: usize,
    parameters: usize,
    expressions: Expressions,
    /// Place in the arena of each node of the message: equal nodes have one place.
    nodes: Vec<NodeId>,
    /// Degree in the variables, an upper bound.
    degrees: Vec<u64>,
}

/// A node that has been read, by its place in the arena.
struct Operand {
    id: NodeId,
    /// Degree in the variables, an upper bound.
    degree: u64,
}

/// A node that goes into the arena next.
struct NewNode {
    node: Node,
    /// Degree in the variables, an upper bound.
    degree: u64,
}

impl Graph {
    /// The graph of the nodes of a message, in the order of the message.
    pub(super) fn of_nodes(m: &v1::System) -> Result<Self, ProtocolError> {
        let mut graph = Self {
            variables: m.variables.len(),
            parameters: m.parameters.len(),
            expressions: Expressions::new(),
            nodes: Vec::with_capacity(m.nodes.len()),
            degrees: Vec::with_capacity(m.nodes.len()),
        };
        for (i, node) in m.nodes.iter().enumerate() {
            graph.push(node).map_err(|e| e.within(at("nodes", i)))?;
        }
        Ok(graph)
    }

    /// The arena of expressions.
    pub(super) fn into_expressions(self) -> Expressions {
        self.expressions
    }

    /// Place of the message's node `i` in the arena.
    pub(super) fn node(&self, field: &str, i: u32) -> Result<NodeId, ProtocolError> {
        index(field, i, self.nodes.len(), "nodes").map(|i| self.nodes[i])
    }

    /// An equation, within the limit of degrees.
    pub(super) fn equation(&self, field: String, i: u32) -> Result<NodeId, ProtocolError> {
        let node = self.node(&field, i)?;
        let degree = self.degrees[i as usize];
        within_limit(
            field,
            usize::try_from(degree).unwrap_or(usize::MAX),
            sizes::DEGREE,
        )?;
        Ok(node)
    }

    /// Several nodes, as many as a system has equations at most.
    pub(super) fn list(&self, field: &str, list: &[u32]) -> Result<Vec<NodeId>, ProtocolError> {
        within_limit(field, list.len(), sizes::EQUATIONS)?;
        list.iter().map(|&i| self.node(field, i)).collect()
    }

    /// A helper unknown: a root or an angle.
    pub(super) fn helper(&self, m: &v1::Helper) -> Result<Helper, ProtocolError> {
        use v1::helper::Kind;
        let variable_at = |field: &str, v| variable(field.into(), v, self.variables);
        Ok(match required("kind", m.kind.as_ref())? {
            Kind::Root(root) => Helper::Root(RootUnknown {
                variable: variable_at("root.variable", root.variable)?,
                degree: root.degree,
                radicand: self.node("root.radicand", root.radicand)?,
                branch: if root.real {
                    Branch::Real
                } else {
                    Branch::Principal
                },
            }),
            Kind::Angle(angle) => {
                check_name(&angle.name).map_err(|e| e.within("angle.name"))?;
                Helper::Angle(AngleUnknowns {
                    name: angle.name.clone(),
                    cosine: variable_at("angle.cosine", angle.cosine)?,
                    sine: variable_at("angle.sine", angle.sine)?,
                    unit: AngleUnit {
                        denominator: angle.unit_denominator.max(1),
                        pi_power: angle.unit_pi_power,
                    },
                })
            }
        })
    }

    fn operand(&self, field: &str, i: u32) -> Result<Operand, ProtocolError> {
        index(field, i, self.nodes.len(), "the nodes before this one").map(|i| Operand {
            id: self.nodes[i],
            degree: self.degrees[i],
        })
    }

    /// Left and right operand of the operation `name`.
    fn operands(&self, name: &str, m: &v1::Binary) -> Result<(Operand, Operand), ProtocolError> {
        let operand = |field, i| self.operand(field, i).map_err(|e| e.within(name));
        Ok((operand("left", m.left)?, operand("right", m.right)?))
    }

    fn constant_operand(&self, field: &str, i: u32) -> Result<NodeId, ProtocolError> {
        let Operand { id, .. } = self.operand(field, i)?;
        if self.expressions.dependence(id) == Dependence::Constant {
            return Ok(id);
        }
        Err(ProtocolError::invalid(
            field,
            format!("node {i}, which is not constant"),
            "a constant",
        ))
    }

    fn is_zero(&self, id: NodeId) -> bool {
        self.expressions
            .as_constant(id)
            .is_some_and(ComplexRational::is_zero)
    }

    fn push(&mut self, m: &v1::Node) -> Result<(), ProtocolError> {
        use v1::node::Kind;
        let NewNode { node, degree } = match required("kind", m.kind.as_ref())? {
            Kind::Constant(z) => constant(z)?,
            Kind::Variable(v) => self.variable(*v)?,
            Kind::Parameter(p) => self.parameter(*p)?,
            Kind::Add(m) => self.sum("add", m, Node::Add)?,
            Kind::Subtract(m) => self.sum("subtract", m, Node::Subtract)?,
            Kind::Multiply(m) => self.product(m)?,
            Kind::Divide(m) => self.quotient(m)?,
            Kind::Negate(a) => self.negation(*a)?,
            Kind::Power(m) => self.power(m)?,
            Kind::Root(m) => self.root(m)?,
            Kind::Function(m) => self.function_value(m)?,
        };
        self.nodes.push(self.expressions.insert(node));
        self.degrees.push(degree);
        Ok(())
    }

    fn variable(&self, v: u32) -> Result<NewNode, ProtocolError> {
        index("variable", v, self.variables, "variables")?;
        Ok(NewNode {
            node: Node::Variable(v),
            degree: 1,
        })
    }

    fn parameter(&self, p: u32) -> Result<NewNode, ProtocolError> {
        index("parameter", p, self.parameters, "parameters")?;
        Ok(NewNode {
            node: Node::Parameter(p),
            degree: 0,
        })
    }

    /// A sum or a difference, as `operation` says.
    fn sum(
        &self,
        name: &str,
        m: &v1::Binary,
        operation: fn(NodeId, NodeId) -> Node,
    ) -> Result<NewNode, ProtocolError> {
        let (left, right) = self.operands(name, m)?;
        Ok(NewNode {
            node: operation(left.id, right.id),
            degree: left.degree.max(right.degree),
        })
    }

    fn product(&self, m: &v1::Binary) -> Result<NewNode, ProtocolError> {
        let (left, right) = self.operands("multiply", m)?;
        Ok(NewNode {
            node: Node::Multiply(left.id, right.id),
            degree: left.degree.saturating_add(right.degree),
        })
    }

    fn quotient(&self, m: &v1::Binary) -> Result<NewNode, ProtocolError> {
        let (left, right) = self.operands("divide", m)?;
        if self.is_zero(right.id) {
            return Err(ProtocolError::invalid(
                "divide.right",
                "0",
                "a denominator that is not 0",
            ));
        }
        // Variables may stand in the denominators of a rational map, and nowhere
        // else: `System::check` looks at that.
        Ok(NewNode {
            node: Node::Divide(left.id, right.id),
            degree: left.degree,
        })
    }

    fn negation(&self, i: u32) -> Result<NewNode, ProtocolError> {
        let Operand { id, degree } = self.operand("negate", i)?;
        Ok(NewNode {
            node: Node::Negate(id),
            degree,
        })
    }

    fn power(&self, m: &v1::Power) -> Result<NewNode, ProtocolError> {
        let base = self.operand("power.base", m.base)?;
        if m.exponent < 2 {
            return Err(ProtocolError::invalid(
                "power.exponent",
                m.exponent,
                "at least 2",
            ));
        }
        within_limit("power.exponent", m.exponent as usize, sizes::EXPONENT)?;
        Ok(NewNode {
            node: Node::Power(base.id, m.exponent),
            degree: base.degree.saturating_mul(u64::from(m.exponent)),
        })
    }

    fn root(&self, m: &v1::Root) -> Result<NewNode, ProtocolError> {
        let base = self.constant_operand("root.base", m.base)?;
        let exponent = rational(&m.exponent).map_err(|e| e.within("root.exponent"))?;
        let size = exponent
            .numer()
            .to_i64()
            .map(i64::unsigned_abs)
            .max(exponent.denom().to_u64());
        let small = exponent.numer().to_i64().is_some()
            && exponent.denom().to_u64().is_some()
            && size <= Some(sizes::EXPONENT.value);
        if !small {
            return Err(ProtocolError::invalid(
                "root.exponent",
                &m.exponent,
                format!(
                    "numerator and denominator up to the limit EXPONENT of {}",
                    sizes::EXPONENT.value
                ),
            ));
        }
        Ok(NewNode {
            node: Node::Root(base, exponent),
            degree: 0,
        })
    }

    fn function_value(&self, m: &v1::FunctionCall) -> Result<NewNode, ProtocolError> {
        let argument = self.constant_operand("function.argument", m.argument)?;
        let function = match v1::Function::try_from(m.function) {
            Ok(v1::Function::SquareRoot) => Function::SquareRoot,
            Ok(v1::Function::Exponential) => Function::Exponential,
            Ok(v1::Function::Logarithm) => Function::Logarithm,
            Ok(v1::Function::Sine) => Function::Sine,
            Ok(v1::Function::Cosine) => Function::Cosine,
            Ok(v1::Function::Tangent) => Function::Tangent,
            Ok(v1::Function::Pi) => {
                if !self.is_zero(argument) {
                    return Err(ProtocolError::invalid(
                        "function.argument",
                        format!("node {}", m.argument),
                        "the constant 0 as the argument of pi",
                    ));
                }
                Function::Pi
            }
            Ok(v1::Function::Unspecified) | Err(_) => {
                return Err(ProtocolError::invalid(
                    "function.function",
                    m.function,
                    "a function that this version knows",
                ));
            }
        };
        Ok(NewNode {
            node: Node::Function(function, argument),
            degree: 0,
        })
    }

    /// A generator of the symmetry group: a permutation of the variables or a map.
    pub(super) fn generator(
        &self,
        m: &v1::SymmetryGenerator,
    ) -> Result<SymmetryGenerator, ProtocolError> {
        let count = |field: &str, n: usize| {
            if n == self.variables {
                return Ok(());
            }
            Err(ProtocolError::invalid(
                field,
                format!("{n} entries"),
                format!("one for each of the {} variables", self.variables),
            ))
        };
        match required("action", m.action.as_ref())? {
            v1::symmetry_generator::Action::Permutation(p) => {
                count("permutation", p.images.len())?;
                let images = p
                    .images
                    .iter()
                    .map(|&v| variable("permutation".to_owned(), v, self.variables))
                    .collect::<Result<Vec<_>, _>>()?;
                let mut seen = vec![false; self.variables];
                for &v in &images {
                    if std::mem::replace(&mut seen[v], true) {
                        return Err(ProtocolError::invalid(
                            "permutation",
                            format!("variable {v} twice"),
                            "every variable once",
                        ));
                    }
                }
                Ok(SymmetryGenerator::Permutation(images))
            }
            v1::symmetry_generator::Action::Map(list) => {
                count("map", list.nodes.len())?;
                Ok(SymmetryGenerator::Map(self.list("map", &list.nodes)?))
            }
        }
    }
}

fn constant(z: &v1::ExactComplex) -> Result<NewNode, ProtocolError> {
    Ok(NewNode {
        node: Node::Constant(ComplexRational {
            re: rational(&z.re).map_err(|e| e.within("constant.re"))?,
            im: rational(&z.im).map_err(|e| e.within("constant.im"))?,
        }),
        degree: 0,
    })
}
