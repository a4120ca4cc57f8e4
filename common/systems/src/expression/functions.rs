//! Functions in expressions: of constants they are numbers, of unknowns they become helper unknowns.
//!
//! Called by the builder of expressions for every call and every rational power. What no polynomial can say
//! (logarithms, an unknown beside its sine) is refused here, with the reason.

use super::angles::{Combination, CosineAndSine, Multiple, NoCombination, refused};
use super::build::{Builder, Use, exact_root};
use super::fault::{Fault, Span};
use super::function_name::FunctionName;
use super::{Dependence, Function, Node, NodeId};
use crate::formats::limits;
use crate::helper_unknown::Branch;
use cognate_numeric::rational::{ComplexRational, Rational};

impl Builder {
    /// A function of an argument; `at` is the place of the argument.
    pub(super) fn call(
        &mut self,
        name: FunctionName,
        argument: NodeId,
        at: Span,
        usage: Use,
    ) -> Result<NodeId, Fault> {
        let is_root = matches!(name, FunctionName::CubeRoot | FunctionName::Absolute);
        match self.expressions.dependence(argument) {
            Dependence::Constant => self.call_of_constant(name, argument, at),
            _ if self.helpers.are_values && !is_root => self.call_of_constant(name, argument, at),
            Dependence::Parameters | Dependence::Variables => {
                self.call_of_unknowns(name, argument, at, usage)
            }
        }
    }

    fn call_of_unknowns(
        &mut self,
        name: FunctionName,
        argument: NodeId,
        at: Span,
        usage: Use,
    ) -> Result<NodeId, Fault> {
        match name {
            FunctionName::SquareRoot => self.helper_root(argument, 2, Branch::Principal, at),
            FunctionName::CubeRoot => self.helper_root(argument, 3, Branch::Real, at),
            FunctionName::Absolute => {
                let square = self.expressions.power(argument, 2);
                self.helper_root(square, 2, Branch::Principal, at)
            }
            FunctionName::Logarithm => Err(Fault::expected(
                at,
                "a constant as argument of `log`: equations with logarithms of unknowns have no polynomial form",
                "an expression with unknowns or parameters",
            )),
            FunctionName::Exponential => {
                let combination = self.combination(argument);
                let combination = combination.and_then(|c| c.divided_by_i(&mut self.expressions));
                let combination = combination.map_err(|why| refused(name, why, at))?;
                let unit = self.cosine_and_sine(name, &combination.angles, at)?;
                let i = self.expressions.constant(ComplexRational::i());
                let turned = self.expressions.multiply(i, unit.sine);
                let unit = self.expressions.add(unit.cosine, turned);
                let factor =
                    self.call_of_constant(FunctionName::Exponential, combination.constant, at)?;
                Ok(self.expressions.multiply(factor, unit))
            }
            _ => {
                let combination = self.combination(argument);
                let combination = combination.map_err(|why| refused(name, why, at))?;
                let unit = self.cosine_and_sine(name, &combination, at)?;
                self.quotient_of(name, unit, at, usage)
            }
        }
    }

    /// A trigonometric function from cosine and sine of its argument.
    fn quotient_of(
        &mut self,
        name: FunctionName,
        CosineAndSine { cosine, sine }: CosineAndSine,
        at: Span,
        usage: Use,
    ) -> Result<NodeId, Fault> {
        let one = self.expressions.integer(1);
        match name {
            FunctionName::Sine => Ok(sine),
            FunctionName::Tangent => self.divide(sine, cosine, at, usage),
            FunctionName::Cotangent => self.divide(cosine, sine, at, usage),
            FunctionName::Secant => self.divide(one, cosine, at, usage),
            FunctionName::Cosecant => self.divide(one, sine, at, usage),
            _ => Ok(cosine),
        }
    }

    /// A function of a constant, or of what has values at points: exact where that is easily seen.
    pub(super) fn call_of_constant(
        &mut self,
        name: FunctionName,
        a: NodeId,
        at: Span,
    ) -> Result<NodeId, Fault> {
        let function = match name {
            FunctionName::SquareRoot => Function::SquareRoot,
            FunctionName::Exponential => Function::Exponential,
            FunctionName::Logarithm => Function::Logarithm,
            FunctionName::Sine => Function::Sine,
            FunctionName::Cosine => Function::Cosine,
            FunctionName::Tangent => Function::Tangent,
            FunctionName::CubeRoot => return self.cube_root_of_constant(a, at),
            FunctionName::Absolute => return self.absolute_of_constant(a, at),
            FunctionName::Cotangent | FunctionName::Secant | FunctionName::Cosecant => {
                let cosine = self.call_of_constant(FunctionName::Cosine, a, at)?;
                let sine = self.call_of_constant(FunctionName::Sine, a, at)?;
                let unit = CosineAndSine { cosine, sine };
                return self.quotient_of(name, unit, at, Use::Rational);
            }
        };
        if let Some(value) = self.expressions.as_constant(a) {
            let exact = match function {
                Function::SquareRoot => exact_root(value, &Rational::from((1, 2))),
                Function::Exponential | Function::Cosine => {
                    value.is_zero().then(|| ComplexRational::real(1))
                }
                Function::Sine | Function::Tangent => {
                    value.is_zero().then(|| ComplexRational::real(0))
                }
                Function::Logarithm if value.is_zero() => {
                    return Err(Fault::expected(
                        at,
                        "a number that is not 0 as argument of `log`",
                        "0",
                    ));
                }
                Function::Logarithm => value.is_one().then(|| ComplexRational::real(0)),
                Function::Pi => None,
            };
            if let Some(exact) = exact {
                return Ok(self.expressions.constant(exact));
            }
        }
        Ok(self.expressions.insert(Node::Function(function, a)))
    }

    /// The real cube root of a real number, the principal one of any other.
    fn cube_root_of_constant(&mut self, a: NodeId, at: Span) -> Result<NodeId, Fault> {
        let third = Rational::from((1, 3));
        match self.expressions.as_constant(a) {
            Some(value) if value.is_real() && value.re < 0 => {
                let size = self.expressions.negate(a);
                let root = self.root(size, third);
                Ok(self.expressions.negate(root))
            }
            Some(_) => Ok(self.root(a, third)),
            None => Err(Fault::expected(
                at,
                "a rational number as argument of `cbrt`",
                "a number that is not rational",
            )),
        }
    }

    fn absolute_of_constant(&mut self, a: NodeId, at: Span) -> Result<NodeId, Fault> {
        let Some(value) = self.expressions.as_constant(a) else {
            return Err(Fault::expected(
                at,
                "a rational number as argument of `abs`",
                "a number that is not rational",
            ));
        };
        let square = value.re.clone() * &value.re + value.im.clone() * &value.im;
        let square = self.expressions.constant(ComplexRational::real(square));
        Ok(self.root(square, Rational::from((1, 2))))
    }

    /// A rational power of what is not constant, by the principal root.
    pub(super) fn power_of_root(
        &mut self,
        base: NodeId,
        exponent: &Rational,
        (base_span, at): (Span, Span),
        usage: Use,
    ) -> Result<NodeId, Fault> {
        let too_large = || Fault::limit(at, limits::EXPONENT, exponent);
        let degree = exponent.denom().to_u32().ok_or_else(too_large)?;
        let size = exponent.numer().to_i32().ok_or_else(too_large)?;
        let root = self.helper_root(base, degree, Branch::Principal, base_span)?;
        let power = self.expressions.power(root, size.unsigned_abs());
        if size > 0 {
            return Ok(power);
        }
        let one = self.expressions.integer(1);
        self.divide(one, power, base_span, usage)
    }
}

impl Combination {
    /// A combination of angles whose coefficients and constant are divided by the imaginary unit.
    fn divided_by_i(
        self,
        expressions: &mut super::Expressions,
    ) -> Result<ImaginaryCombination, NoCombination> {
        let mut angles = Combination {
            terms: Default::default(),
            constant: expressions.integer(0),
        };
        for (angle, coefficient) in self.terms {
            let quotient = coefficient.number.divide(&ComplexRational::i());
            let number = quotient.expect("the imaginary unit is not 0");
            angles.terms.insert(
                angle,
                Multiple {
                    number,
                    ..coefficient
                },
            );
        }
        Ok(ImaginaryCombination {
            angles,
            constant: self.constant,
        })
    }
}

/// I times a combination of angles, and a constant.
struct ImaginaryCombination {
    angles: Combination,
    constant: NodeId,
}
