//! Build: from the postfix steps of an expression to nodes of a graph.
//!
//! Here exact arithmetic is bounded, and what the graph may not hold is
//! refused at its place: denominators that it may not have, exponents that are no
//! small rational numbers. Functions are in `functions.rs`.

use super::differentiate::below;
use super::fault::{Fault, Problem, Span};
use super::helper_drafts::HelpersInMaking;
use super::parse::{Operation, Parsed};
use super::{Dependence, Expressions, Function, Node, NodeId};
use crate::formats::limits;
use crate::system::{DegenerateSet, System};
use crate::transform::clear_denominators::ZERO_DENOMINATOR;
use cognate_numeric::rational::{ComplexRational, Rational};
use rug::Integer;
use rug::ops::Pow;
use std::collections::BTreeSet;

/// Use of an expression: as a polynomial or as a rational function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// A polynomial in the variables: no variable in a denominator.
    Polynomial,
    /// A rational function: variables may stand in denominators.
    Rational,
}

/// A graph that grows, with the budget of exact arithmetic.
#[derive(Clone, Debug, Default)]
pub struct Builder {
    /// The graph so far.
    pub expressions: Expressions,
    constant_bits: u64,
    /// Denominators of what was simplified to a constant: `0/x`, `1/x - 1/x`.
    dropped_denominators: BTreeSet<NodeId>,
    /// Unknowns that stand for functions of others.
    pub(super) helpers: HelpersInMaking,
}

impl Builder {
    /// Goes on with the graph of a finished system.
    pub fn of(system: &System) -> Self {
        Self {
            expressions: system.expressions.clone(),
            constant_bits: 0,
            dropped_denominators: BTreeSet::new(),
            helpers: HelpersInMaking::of(system),
        }
    }

    /// Lets functions of unknowns stay in the graph, of which only the values at points are wanted.
    pub(crate) fn keep_functions(&mut self) {
        self.helpers.are_values = true;
    }

    /// Puts an expression into the graph; `resolve` says what a name stands for.
    pub fn build(
        &mut self,
        parsed: &Parsed,
        usage: Use,
        resolve: &mut dyn FnMut(&mut Expressions, u32, Span) -> Result<NodeId, Fault>,
    ) -> Result<NodeId, Fault> {
        let mut stack: Vec<(NodeId, Span)> = Vec::new();
        for step in &parsed.steps {
            let at = step.span;
            let value = match step.operation {
                Operation::Number(n) => {
                    let value = ComplexRational::real(parsed.numbers[n as usize].clone());
                    (self.expressions.constant(value), at)
                }
                Operation::Name(n) => (resolve(&mut self.expressions, n, at)?, at),
                Operation::ImaginaryUnit => (self.expressions.constant(ComplexRational::i()), at),
                Operation::Pi => {
                    let zero = self.expressions.integer(0);
                    (self.expressions.function(Function::Pi, zero), at)
                }
                Operation::Negate => {
                    let (a, span) = operand(&mut stack);
                    (self.expressions.negate(a), at.to(span))
                }
                Operation::Call(function) => {
                    let (a, span) = operand(&mut stack);
                    (self.call(function, a, span, usage)?, at.to(span))
                }
                binary => {
                    let (b, b_span) = operand(&mut stack);
                    let (a, a_span) = operand(&mut stack);
                    let node = match binary {
                        Operation::Add => self.expressions.add(a, b),
                        Operation::Subtract => self.expressions.subtract(a, b),
                        Operation::Multiply => self.expressions.multiply(a, b),
                        Operation::Divide => self.divide(a, b, b_span, usage)?,
                        _ => self.power(a, b, a_span, b_span, usage)?,
                    };
                    if self.constant(node).is_some() {
                        self.keep_denominators(a, b, binary);
                    }
                    (node, a_span.to(b_span))
                }
            };
            self.check_size(value.0, at)?;
            stack.push(value);
        }
        let (node, _) = operand(&mut stack);
        assert!(stack.is_empty(), "the parser leaves one value on the stack");
        Ok(node)
    }

    /// Remembers the denominators of two operands that became a constant.
    fn keep_denominators(&mut self, a: NodeId, b: NodeId, operation: Operation) {
        let e = &self.expressions;
        let is_variable = |node: &NodeId| e.dependence(*node) == Dependence::Variables;
        if !is_variable(&a) && !is_variable(&b) {
            return;
        }
        let divided_by = below(e, &[a, b])
            .into_iter()
            .filter_map(|id| match e.node(id) {
                Node::Divide(_, denominator) => Some(*denominator),
                _ => None,
            });
        let last = (operation == Operation::Divide).then_some(b);
        let denominators = divided_by.chain(last).filter(is_variable);
        self.dropped_denominators.extend(denominators);
    }

    /// Hands the graph to a system, with the denominators that are not in it any more and the helper unknowns. `places` are
    /// those of the equations in the text.
    pub fn hand_over(&mut self, system: &mut System, places: &[Span]) -> Result<(), Fault> {
        system.expressions = std::mem::take(&mut self.expressions);
        let out = &mut system.expressions;
        for denominator in std::mem::take(&mut self.dropped_denominators) {
            let product = match system.degenerate.get(ZERO_DENOMINATOR) {
                Some(DegenerateSet::Nonzero(others)) => out.multiply(*others, denominator),
                _ => denominator,
            };
            let set = DegenerateSet::Nonzero(product);
            system.degenerate.insert(ZERO_DENOMINATOR.into(), set);
        }
        let place = |equation: usize| places.get(equation).copied().unwrap_or_default();
        self.finish_helpers(system, place)
    }

    fn check_size(&mut self, node: NodeId, span: Span) -> Result<(), Fault> {
        if self.expressions.nodes().len() as u64 > limits::NODES.value {
            return Err(Fault::limit(span, limits::NODES, "more"));
        }
        if let Some(value) = self.expressions.as_constant(node) {
            let bits = bits(value);
            self.constant_bits += bits;
            if bits > limits::CONSTANT_BITS.value {
                return Err(Fault::limit(span, limits::CONSTANT_BITS, bits));
            }
            if self.constant_bits > limits::TOTAL_CONSTANT_BITS.value {
                return Err(Fault::limit(span, limits::TOTAL_CONSTANT_BITS, "more"));
            }
        }
        Ok(())
    }

    fn constant(&self, node: NodeId) -> Option<&ComplexRational> {
        self.expressions.as_constant(node)
    }

    pub(super) fn divide(
        &mut self,
        a: NodeId,
        b: NodeId,
        at: Span,
        usage: Use,
    ) -> Result<NodeId, Fault> {
        let serves = match usage {
            Use::Polynomial => self.expressions.dependence(b) != Dependence::Variables,
            Use::Rational => true,
        };
        if !serves {
            return Err(Fault::new(at, Problem::DivisionByVariables));
        }
        if self.constant(b).is_some_and(ComplexRational::is_zero) {
            return Err(Fault::new(at, Problem::DivisionByZero));
        }
        Ok(self.expressions.divide(a, b))
    }

    fn power(
        &mut self,
        base: NodeId,
        exponent: NodeId,
        base_span: Span,
        at: Span,
        usage: Use,
    ) -> Result<NodeId, Fault> {
        let wrong =
            |actual_input: &str| Fault::expected(at, "a rational number as exponent", actual_input);
        let exponent = match self.constant(exponent) {
            Some(value) if value.is_real() => value.re.clone(),
            Some(_) => return Err(wrong("a complex number")),
            None => {
                return Err(wrong(match self.expressions.dependence(exponent) {
                    Dependence::Constant => "a number that is not rational",
                    Dependence::Parameters => "an expression with parameters",
                    Dependence::Variables => "an expression with variables",
                }));
            }
        };
        let largest = limits::EXPONENT.value;
        let (numerator, denominator) = match (
            exponent
                .numer()
                .to_i64()
                .filter(|n| n.unsigned_abs() <= largest),
            exponent
                .denom()
                .to_u32()
                .filter(|&d| u64::from(d) <= largest),
        ) {
            (Some(n), Some(d)) => (n, d),
            _ => {
                let text = exponent.to_string();
                let text = super::token::shorten(&text);
                return Err(Fault::limit(at, limits::EXPONENT, text));
            }
        };
        let size = numerator.unsigned_abs() as u32;
        if numerator < 0 && self.constant(base).is_some_and(ComplexRational::is_zero) {
            return Err(Fault::new(base_span, Problem::DivisionByZero));
        }
        if denominator != 1 {
            return match self.expressions.dependence(base) {
                Dependence::Constant => Ok(self.root(base, exponent)),
                _ => self.power_of_root(base, &exponent, (base_span, at), usage),
            };
        }
        if let Some(value) = self.constant(base) {
            let needed = bits(value).saturating_mul(u64::from(size));
            let unit = bits(value) <= 1;
            if !unit && needed > limits::CONSTANT_BITS.value {
                return Err(Fault::limit(
                    base_span.to(at),
                    limits::CONSTANT_BITS,
                    needed,
                ));
            }
            if unit {
                // 0, 1, -1, i and -i: the exponent counts modulo 4.
                let reduced = if size > 4 { size % 4 + 4 } else { size };
                return self.signed_power(base, reduced, numerator < 0, base_span, usage);
            }
        }
        self.signed_power(base, size, numerator < 0, base_span, usage)
    }

    fn signed_power(
        &mut self,
        base: NodeId,
        size: u32,
        negative: bool,
        base_span: Span,
        usage: Use,
    ) -> Result<NodeId, Fault> {
        let power = self.expressions.power(base, size);
        if !negative {
            return Ok(power);
        }
        let one = self.expressions.integer(1);
        self.divide(one, power, base_span, usage)
    }

    /// A rational power of a constant, exact where it is a rational number.
    pub(super) fn root(&mut self, base: NodeId, exponent: Rational) -> NodeId {
        if let Some(value) = self.constant(base)
            && let Some(exact) = exact_root(value, &exponent)
        {
            return self.expressions.constant(exact);
        }
        self.expressions.root(base, exponent)
    }
}

fn operand(stack: &mut Vec<(NodeId, Span)>) -> (NodeId, Span) {
    stack
        .pop()
        .expect("the parser gives every operator its operands")
}

/// Size of an exact number: 0 has none; 1, -1, i and -i have one bit.
pub(crate) fn bits(value: &ComplexRational) -> u64 {
    [&value.re, &value.im]
        .iter()
        .map(|part| {
            let denominator = if *part.denom() == 1 {
                0
            } else {
                part.denom().significant_bits()
            };
            u64::from(part.numer().significant_bits()) + u64::from(denominator)
        })
        .sum()
}

/// `value^exponent` on the principal branch, where it is rational and easily seen to be.
pub(super) fn exact_root(value: &ComplexRational, exponent: &Rational) -> Option<ComplexRational> {
    if value.is_zero() {
        return Some(value.clone());
    }
    if value.is_one() {
        return Some(value.clone());
    }
    let degree = exponent.denom().to_u32()?;
    let times = exponent.numer().to_i32()?;
    if !value.is_real() || degree > 64 || times.unsigned_abs() > 64 {
        return None;
    }
    let negative = value.re < 0;
    if negative && degree != 2 {
        return None;
    }
    let whole = |n: &Integer| {
        let root = Integer::from(n.abs_ref()).root(degree);
        (Integer::from((&root).pow(degree)) == Integer::from(n.abs_ref())).then_some(root)
    };
    let root = Rational::from((whole(value.re.numer())?, whole(value.re.denom())?));
    // The square root of a negative number is i times that of its absolute value.
    let root = if negative {
        ComplexRational::new(0, root)
    } else {
        ComplexRational::real(root)
    };
    let power = root.power(times.unsigned_abs());
    if times < 0 {
        ComplexRational::real(1).divide(&power)
    } else {
        Some(power)
    }
}
