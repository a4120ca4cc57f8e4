//! Angles: sines and cosines of integer combinations of unknowns, as polynomials in those of the unknowns.
//!
//! cos(a + b) and sin(a + b) are real and imaginary part of a product of points (cos, sin) of the circle, and a multiple
//! of an angle is a power.

use super::build::Builder;
use super::differentiate::below;
use super::fault::{Fault, Span};
use super::function_name::FunctionName;
use super::{Dependence, Expressions, Function, Node, NodeId};
use crate::formats::limits;
use cognate_numeric::rational::{ComplexRational, Rational};
use std::collections::{BTreeMap, HashMap};

/// A linear combination of unknowns and a constant.
#[derive(Clone, Debug)]
pub(super) struct Combination {
    /// Coefficients that are not 0, by the index of the unknown.
    pub terms: BTreeMap<u32, ComplexRational>,
    /// An expression without unknowns and parameters.
    pub constant: NodeId,
}

/// Cosine and sine of an angle, as expressions.
#[derive(Clone, Copy, Debug)]
pub(super) struct CosineAndSine {
    pub cosine: NodeId,
    pub sine: NodeId,
}

/// Reason why an expression is no combination of angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoCombination {
    /// The expression holds a parameter.
    Parameter,
    /// A coefficient is no integer.
    Fraction,
    /// The expression is not linear in the unknowns.
    NotLinear,
}

impl Builder {
    /// An expression as a linear combination of typed unknowns with rational coefficients.
    pub(super) fn combination(&mut self, root: NodeId) -> Result<Combination, NoCombination> {
        let is_typed = |v: u32| !self.helpers.is_helper(v);
        let e = &mut self.expressions;
        let zero = e.integer(0);
        let mut combinations: HashMap<NodeId, Combination> = HashMap::new();
        for id in below(e, &[root]) {
            if e.dependence(id) == Dependence::Constant {
                let terms = BTreeMap::new();
                combinations.insert(
                    id,
                    Combination {
                        terms,
                        constant: id,
                    },
                );
                continue;
            }
            let combination = match *e.node(id) {
                Node::Parameter(_) => return Err(NoCombination::Parameter),
                Node::Variable(v) if is_typed(v) => Combination {
                    terms: BTreeMap::from([(v, ComplexRational::real(1))]),
                    constant: zero,
                },
                Node::Add(a, b) => combinations[&a].plus(&combinations[&b], e),
                Node::Subtract(a, b) => {
                    let minus = combinations[&b].times(e, &ComplexRational::real(-1));
                    combinations[&a].plus(&minus, e)
                }
                Node::Negate(a) => combinations[&a].times(e, &ComplexRational::real(-1)),
                Node::Multiply(a, b) => {
                    let (factor, other) = match e.dependence(a) {
                        Dependence::Constant => (a, b),
                        _ => (b, a),
                    };
                    if e.dependence(factor) != Dependence::Constant {
                        return Err(NoCombination::NotLinear);
                    }
                    let factor = e.as_constant(factor).cloned();
                    combinations[&other].times(e, &factor.ok_or(NoCombination::Fraction)?)
                }
                // A quotient by a rational number is built as a product.
                Node::Divide(_, b) if e.dependence(b) == Dependence::Constant => {
                    return Err(NoCombination::Fraction);
                }
                _ => return Err(NoCombination::NotLinear),
            };
            combinations.insert(id, combination);
        }
        combinations.remove(&root).ok_or(NoCombination::NotLinear)
    }

    /// Cosine and sine of a combination with integer coefficients.
    pub(super) fn cosine_and_sine(
        &mut self,
        name: FunctionName,
        combination: &Combination,
        at: Span,
    ) -> Result<CosineAndSine, Fault> {
        let mut point = self.turn(combination.constant, at)?;
        for (&angle, coefficient) in &combination.terms {
            let multiple = integer(coefficient);
            let multiple = multiple.ok_or_else(|| refused(name, NoCombination::Fraction, at))?;
            let size = multiple.unsigned_abs();
            if size > limits::EXPONENT.value {
                return Err(Fault::limit(at, limits::EXPONENT, multiple));
            }
            let mut unit = self.helper_angle(angle, at)?;
            if multiple < 0 {
                unit.sine = self.expressions.negate(unit.sine);
            }
            let turned = power(&mut self.expressions, unit, size);
            point = product(&mut self.expressions, point, turned);
        }
        Ok(point)
    }

    /// Cosine and sine of a constant: exact for multiples of a quarter turn.
    fn turn(&mut self, constant: NodeId, at: Span) -> Result<CosineAndSine, Fault> {
        if let Some(quarters) = quarter_turns(&self.expressions, constant) {
            let [cosine, sine] = [[1, 0], [0, 1], [-1, 0], [0, -1]][quarters];
            let [cosine, sine] = [cosine, sine].map(|value| self.expressions.integer(value));
            return Ok(CosineAndSine { cosine, sine });
        }
        let cosine = self.call_of_constant(FunctionName::Cosine, constant, at)?;
        let sine = self.call_of_constant(FunctionName::Sine, constant, at)?;
        Ok(CosineAndSine { cosine, sine })
    }
}

impl Combination {
    fn plus(&self, other: &Self, e: &mut Expressions) -> Self {
        let mut terms = self.terms.clone();
        for (&unknown, coefficient) in &other.terms {
            let sum = match terms.get(&unknown) {
                Some(before) => before.add(coefficient),
                None => coefficient.clone(),
            };
            terms.insert(unknown, sum);
        }
        terms.retain(|_, coefficient| !coefficient.is_zero());
        let constant = e.add(self.constant, other.constant);
        Self { terms, constant }
    }

    fn times(&self, e: &mut Expressions, factor: &ComplexRational) -> Self {
        let each = self.terms.iter();
        let terms = each.map(|(&unknown, coefficient)| (unknown, coefficient.multiply(factor)));
        let number = e.constant(factor.clone());
        Self {
            terms: terms.collect(),
            constant: e.multiply(number, self.constant),
        }
    }
}

fn integer(value: &ComplexRational) -> Option<i64> {
    let is_integer = value.is_real() && *value.re.denom() == 1;
    value.re.numer().to_i64().filter(|_| is_integer)
}

/// The number of quarter turns, modulo 4, in a rational multiple of the circle constant.
fn quarter_turns(e: &Expressions, constant: NodeId) -> Option<usize> {
    let multiple = match *e.node(constant) {
        Node::Constant(ref value) if value.is_zero() => Rational::new(),
        Node::Negate(a) if is_pi(e, a) => Rational::from(-1),
        Node::Multiply(a, b) if is_pi(e, b) => real(e, a)?,
        Node::Multiply(a, b) if is_pi(e, a) => real(e, b)?,
        _ if is_pi(e, constant) => Rational::from(1),
        _ => return None,
    };
    let quarters = multiple * 2u32;
    let whole = (*quarters.denom() == 1).then(|| quarters.numer().mod_u(4));
    whole.map(|quarters| quarters as usize)
}

fn is_pi(e: &Expressions, id: NodeId) -> bool {
    matches!(e.node(id), Node::Function(Function::Pi, _))
}

fn real(e: &Expressions, id: NodeId) -> Option<Rational> {
    let value = e.as_constant(id).filter(|value| value.is_real());
    value.map(|value| value.re.clone())
}

/// Cosine and sine of a sum.
fn product(e: &mut Expressions, a: CosineAndSine, b: CosineAndSine) -> CosineAndSine {
    let cosines = e.multiply(a.cosine, b.cosine);
    let sines = e.multiply(a.sine, b.sine);
    let first = e.multiply(a.sine, b.cosine);
    let second = e.multiply(a.cosine, b.sine);
    CosineAndSine {
        cosine: e.subtract(cosines, sines),
        sine: e.add(first, second),
    }
}

/// Cosine and sine of a multiple, by repeated doubling.
fn power(e: &mut Expressions, angle: CosineAndSine, multiple: u64) -> CosineAndSine {
    let mut point = CosineAndSine {
        cosine: e.integer(1),
        sine: e.integer(0),
    };
    let mut doubled = angle;
    let mut left = multiple;
    while left > 0 {
        if left & 1 == 1 {
            point = product(e, point, doubled);
        }
        left >>= 1;
        if left > 0 {
            doubled = product(e, doubled, doubled);
        }
    }
    point
}

/// The fault of an argument that is no combination of angles.
pub(super) fn refused(name: FunctionName, why: NoCombination, at: Span) -> Fault {
    let function = name.text();
    let (expected, actual_input) = match (why, name) {
        (NoCombination::Parameter, _) => (
            format!("unknown angles inside `{function}`; an unknown with an equation can stand for a parameter"),
            "a parameter",
        ),
        (_, FunctionName::Exponential) => (
            "`exp(I*a)` of unknown angles with integer multiples: exponentials of other unknowns have no polynomial form \
             (where x occurs only in exp(x), write y for exp(x))"
                .into(),
            "another expression",
        ),
        (NoCombination::Fraction, _) => (
            format!(
                "unknown angles with integer multiples inside `{function}`: for {function}(x/2) write x = 2*t, so \
                 {function}(t)"
            ),
            "another multiple",
        ),
        (NoCombination::NotLinear, _) => (
            format!("a sum of unknown angles with integer multiples inside `{function}`"),
            "another expression",
        ),
    };
    Fault::expected(at, expected, actual_input)
}
