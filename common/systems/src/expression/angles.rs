//! Angles: sines and cosines of combinations of unknowns, as polynomials in those of the unknowns.
//!
//! cos(a + b) and sin(a + b) are real and imaginary part of a product of points (cos, sin) of the circle, and an integer
//! multiple of an angle is a power. Other multiples (x/2, x*pi/180 of an angle in degrees) are integer multiples of the angle
//! in another unit, which all multiples of an unknown have in common.

use super::build::Builder;
use super::differentiate::below;
use super::fault::{Fault, Span};
use super::function_name::FunctionName;
use super::{Dependence, Expressions, Function, Node, NodeId};
use crate::formats::limits;
use crate::helper_unknown::{AngleUnit, MOST_PI_POWER};
use cognate_numeric::rational::ComplexRational;
use std::collections::{BTreeMap, HashMap};

/// Most operations of a constant that is read as a number times a power of pi; a unit such as pi/180 has three.
const MOST_OPERATIONS: u32 = 64;

/// A number times a power of pi.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Multiple {
    pub number: ComplexRational,
    pub pi_power: i32,
    /// A factor is a multiple of 1/180 as it is typed: with pi it converts degrees.
    pub is_of_degrees: bool,
}

/// Degrees in half a turn.
const HALF_TURN: u32 = 180;

/// A linear combination of unknowns and a constant.
#[derive(Clone, Debug)]
pub(super) struct Combination {
    /// Coefficients that are not 0, by the index of the unknown.
    pub terms: BTreeMap<u32, Multiple>,
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
    /// A coefficient is no rational number times a power of pi, or an unknown has coefficients with several powers.
    Coefficient,
    /// The expression is not linear in the unknowns.
    NotLinear,
}

impl Builder {
    /// An expression as a linear combination of typed unknowns, with coefficients that are numbers times powers of pi.
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
                    terms: BTreeMap::from([(v, Multiple::of_number(1))]),
                    constant: zero,
                },
                Node::Add(a, b) => combinations[&a].plus(&combinations[&b], e)?,
                Node::Subtract(a, b) => {
                    let minus = combinations[&b].negated(e);
                    combinations[&a].plus(&minus, e)?
                }
                Node::Negate(a) => combinations[&a].negated(e),
                Node::Multiply(a, b) => {
                    let (factor, other) = match e.dependence(a) {
                        Dependence::Constant => (a, b),
                        _ => (b, a),
                    };
                    if e.dependence(factor) != Dependence::Constant {
                        return Err(NoCombination::NotLinear);
                    }
                    combinations[&other].times(e, factor)?
                }
                // A quotient by a rational number is built as a product.
                Node::Divide(a, b) if e.dependence(b) == Dependence::Constant => {
                    let one = e.integer(1);
                    let factor = e.divide(one, b);
                    combinations[&a].times(e, factor)?
                }
                _ => return Err(NoCombination::NotLinear),
            };
            combinations.insert(id, combination);
        }
        combinations.remove(&root).ok_or(NoCombination::NotLinear)
    }

    /// Cosine and sine of a combination with real coefficients.
    pub(super) fn cosine_and_sine(
        &mut self,
        name: FunctionName,
        combination: &Combination,
        at: Span,
    ) -> Result<CosineAndSine, Fault> {
        let mut point = self.turn(combination.constant, at)?;
        for (&angle, multiple) in &combination.terms {
            let (count, unit) = multiple
                .in_units()
                .ok_or_else(|| refused(name, NoCombination::Coefficient, at))?;
            let size = count.unsigned_abs();
            if size > limits::EXPONENT.value {
                return Err(Fault::limit(at, limits::EXPONENT, count));
            }
            let mut turn = self.helper_angle(angle, unit, name, at)?;
            if count < 0 {
                turn.sine = self.expressions.negate(turn.sine);
            }
            let turned = power(&mut self.expressions, turn, size);
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

impl Multiple {
    pub(super) fn of_number(number: i64) -> Self {
        Self::new(ComplexRational::real(number), 0)
    }

    fn new(number: ComplexRational, pi_power: i32) -> Self {
        Self {
            is_of_degrees: number.re.denom().is_divisible_u(HALF_TURN),
            number,
            pi_power,
        }
    }

    /// The value of a constant; `None` where it is no number times a power of pi, or takes many operations.
    fn of_constant(e: &Expressions, constant: NodeId) -> Option<Self> {
        Self::within(e, constant, &mut { MOST_OPERATIONS })
    }

    /// The value of a constant of at most this many operations, which also bound the recursion.
    fn within(e: &Expressions, constant: NodeId, operations: &mut u32) -> Option<Self> {
        *operations = operations.checked_sub(1)?;
        match *e.node(constant) {
            Node::Constant(ref number) => Some(Self::new(number.clone(), 0)),
            Node::Function(Function::Pi, _) => Some(Self::new(ComplexRational::real(1), 1)),
            Node::Negate(a) => Self::within(e, a, operations)?.times(&Self::of_number(-1)),
            Node::Multiply(a, b) => {
                Self::within(e, a, operations)?.times(&Self::within(e, b, operations)?)
            }
            Node::Divide(a, b) => {
                let divisor = Self::within(e, b, operations)?;
                let inverse = ComplexRational::real(1).divide(&divisor.number)?;
                let inverse = Self::new(inverse, -divisor.pi_power);
                Self::within(e, a, operations)?.times(&inverse)
            }
            _ => None,
        }
    }

    /// The product; `None` where the power of pi is too large for a unit.
    fn times(&self, other: &Self) -> Option<Self> {
        let pi_power = self.pi_power.checked_add(other.pi_power)?;
        (pi_power.unsigned_abs() <= MOST_PI_POWER).then(|| Self {
            number: self.number.multiply(&other.number),
            pi_power,
            is_of_degrees: self.is_of_degrees || other.is_of_degrees,
        })
    }

    /// The sum of two multiples with the same power of pi.
    fn plus(&self, other: &Self) -> Self {
        Self {
            number: self.number.add(&other.number),
            pi_power: self.pi_power,
            is_of_degrees: self.is_of_degrees || other.is_of_degrees,
        }
    }

    /// How many units it is, an integer. The unit is the largest that allows this, but not larger than a degree for an
    /// unknown in degrees: 2*x*pi/180 has all x of a turn, as 2*x in radians. `None` where it is not real or too large.
    fn in_units(&self) -> Option<(i64, AngleUnit)> {
        let number = self.number.is_real().then_some(&self.number.re)?;
        let reduced = number.denom().to_u32()?;
        let is_of_degrees = self.is_of_degrees && self.pi_power == 1;
        let factor = if is_of_degrees && HALF_TURN.is_multiple_of(reduced) {
            HALF_TURN / reduced
        } else {
            1
        };
        let unit = AngleUnit {
            denominator: reduced * factor,
            pi_power: self.pi_power,
        };
        let count = number.numer().to_i64()?.checked_mul(i64::from(factor))?;
        Some((count, unit))
    }
}

impl Combination {
    fn plus(&self, other: &Self, e: &mut Expressions) -> Result<Self, NoCombination> {
        let mut terms = self.terms.clone();
        for (&unknown, multiple) in &other.terms {
            let sum = match terms.get(&unknown) {
                Some(before) if before.pi_power != multiple.pi_power => {
                    return Err(NoCombination::Coefficient);
                }
                Some(before) => before.plus(multiple),
                None => multiple.clone(),
            };
            terms.insert(unknown, sum);
        }
        terms.retain(|_, multiple| !multiple.number.is_zero());
        let constant = e.add(self.constant, other.constant);
        Ok(Self { terms, constant })
    }

    fn negated(&self, e: &mut Expressions) -> Self {
        let minus_one = e.integer(-1);
        let negated = self.times(e, minus_one);
        negated.expect("-1 is a rational number")
    }

    /// The product with a constant.
    fn times(&self, e: &mut Expressions, factor: NodeId) -> Result<Self, NoCombination> {
        let multiple = Multiple::of_constant(e, factor).ok_or(NoCombination::Coefficient)?;
        let mut terms = BTreeMap::new();
        for (&unknown, coefficient) in &self.terms {
            let product = coefficient.times(&multiple);
            terms.insert(unknown, product.ok_or(NoCombination::Coefficient)?);
        }
        Ok(Self {
            terms,
            constant: e.multiply(factor, self.constant),
        })
    }
}

/// The number of quarter turns, modulo 4, in a rational multiple of the circle constant.
fn quarter_turns(e: &Expressions, constant: NodeId) -> Option<usize> {
    let multiple = Multiple::of_constant(e, constant)?;
    let is_turn = multiple.number.is_zero() || multiple.pi_power == 1;
    if !is_turn || !multiple.number.is_real() {
        return None;
    }
    let quarters = multiple.number.re * 2u32;
    let whole = (*quarters.denom() == 1).then(|| quarters.numer().mod_u(4));
    whole.map(|quarters| quarters as usize)
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
pub(super) fn power(e: &mut Expressions, angle: CosineAndSine, multiple: u64) -> CosineAndSine {
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
            "`exp(I*a)` of unknown angles with rational multiples: exponentials of other unknowns have no polynomial form \
             (where x occurs only in exp(x), write y for exp(x))"
                .into(),
            "another expression",
        ),
        (NoCombination::Coefficient, _) => (
            format!(
                "multiples of an unknown angle inside `{function}` that are rational, or rational times pi, so that one \
                 unit measures all of them: {function}(x/2), {function}(x*pi/180)"
            ),
            "another multiple",
        ),
        (NoCombination::NotLinear, _) => (
            format!("a sum of multiples of unknown angles inside `{function}`"),
            "another expression",
        ),
    };
    Fault::expected(at, expected, actual_input)
}
