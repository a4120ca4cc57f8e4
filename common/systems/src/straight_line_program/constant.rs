//! Constants of a program: exact numbers, and roots and elementary functions of them.
//!
//! They are rounded once, when scratch space is made, from their exact
//! meaning to the precision of that scratch space.

use super::enclosure::enclose;
use crate::expression::{Expressions, Function, Node, NodeId};
use cognate_numeric::rational::ComplexRational;
use cognate_numeric::scalar::directed::Directed;
use cognate_numeric::scalar::{Complex, Interval, Real};
use foldhash::{HashMap, HashMapExt};
use rug::Float;

/// A number that the program knows.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Constant {
    /// A rational number.
    Exact(ComplexRational),
    /// A node of the pool's own arena, built with roots or elementary functions.
    Algebraic(NodeId),
}

/// All constants of one evaluator, each of them once.
#[derive(Clone, Debug, Default)]
pub struct ConstantPool {
    arena: Expressions,
    constants: Vec<Constant>,
    index: HashMap<Constant, u32>,
    imported: HashMap<NodeId, NodeId>,
}

impl ConstantPool {
    /// All constants, by number.
    pub fn constants(&self) -> &[Constant] {
        &self.constants
    }

    /// The number of a constant, which is put in if it is new.
    pub(crate) fn insert(&mut self, constant: Constant) -> u32 {
        if let Some(&number) = self.index.get(&constant) {
            return number;
        }
        let number =
            u32::try_from(self.constants.len()).expect("a pool has fewer than 2^32 constants");
        self.constants.push(constant.clone());
        self.index.insert(constant, number);
        number
    }

    /// The number of 0.
    pub(crate) fn zero(&mut self) -> u32 {
        self.insert(Constant::Exact(ComplexRational::default()))
    }

    /// A pool with the same constants, for nodes of another arena.
    pub(crate) fn for_another_arena(&self) -> Self {
        Self {
            imported: HashMap::new(),
            ..self.clone()
        }
    }

    /// Describes a constant node. Algebraic constants are copied into the pool's arena; one pool serves one arena.
    pub(crate) fn describe(&mut self, expressions: &Expressions, id: NodeId) -> Constant {
        match expressions.node(id) {
            Node::Constant(c) => Constant::Exact(c.clone()),
            _ => {
                let copy = self
                    .arena
                    .import(expressions, id, &mut self.imported, &mut |_, _| {
                        unreachable!("a constant contains no variable and no parameter")
                    });
                match self.arena.node(copy) {
                    Node::Constant(c) => Constant::Exact(c.clone()),
                    _ => Constant::Algebraic(copy),
                }
            }
        }
    }

    /// The number of the negative of a constant.
    pub(crate) fn negative(&mut self, constant: u32) -> u32 {
        let negative = match self.constants[constant as usize].clone() {
            Constant::Exact(c) => Constant::Exact(c.negate()),
            Constant::Algebraic(id) => Constant::Algebraic(self.arena.negate(id)),
        };
        self.insert(negative)
    }

    /// The number of the reciprocal of a constant; `None` for exactly 0.
    pub(crate) fn inverse(&mut self, constant: u32) -> Option<u32> {
        let one = ComplexRational::real(1);
        let inverse = match self.constants[constant as usize].clone() {
            Constant::Exact(c) => Constant::Exact(one.divide(&c)?),
            Constant::Algebraic(id) => {
                let one = self.arena.constant(one);
                Constant::Algebraic(self.arena.divide(one, id))
            }
        };
        Some(self.insert(inverse))
    }

    /// Whether a constant is real; for an algebraic one, to a thousand bits.
    pub(crate) fn is_real(&self, constant: u32) -> bool {
        match &self.constants[constant as usize] {
            Constant::Exact(c) => c.is_real(),
            Constant::Algebraic(id) => algebraic(&self.arena, *id, 53).is_real(),
        }
    }

    /// An algebraic constant between proven bounds. The program treats as real what is so to a
    /// thousand bits; where that is not proven, neither is anything else.
    fn enclosed<R: Real>(&self, constant: u32, id: NodeId, context: R::Context) -> Complex<R> {
        let bounds = enclose(&self.arena, id, R::bits(context) + 64);
        let imaginary = bounds.im.lower().is_negative() || bounds.im.upper().is_positive();
        if imaginary && self.is_real(constant) {
            return Complex::from_f64(context, f64::NAN, f64::NAN);
        }
        Complex {
            re: between(context, &bounds.re),
            im: between(context, &bounds.im),
        }
    }

    /// A constant, rounded to nearest for this context; enclosed where the scalar encloses.
    pub fn round<R: Real>(&self, constant: u32, context: R::Context) -> Complex<R> {
        match &self.constants[constant as usize] {
            Constant::Exact(c) => Complex::from_rational(context, c),
            Constant::Algebraic(id) if R::ENCLOSES => self.enclosed(constant, *id, context),
            Constant::Algebraic(id) => {
                let value = algebraic(&self.arena, *id, R::bits(context));
                Complex::from_rational(context, &value)
            }
        }
    }
}

/// An interval's part between two bounds; NaN, which no proof survives, where there are none.
pub(crate) fn between<R: Real, D: Directed>(context: R::Context, part: &Interval<D>) -> R {
    match (part.lower().to_rational(), part.upper().to_rational()) {
        (Some(lower), Some(upper)) => R::between(context, &lower, &upper),
        _ => R::from_f64(context, f64::NAN),
    }
}

/// An algebraic constant, exact to more than `bits` bits of each part.
///
/// The working precision is doubled until two of them round alike. What never
/// does so and shrinks with the precision is an exact 0.
pub fn algebraic(arena: &Expressions, id: NodeId, bits: u32) -> ComplexRational {
    let mut working = bits.max(53) + 64;
    let mut coarse = evaluate(arena, id, working);
    let agree = |a: &Float, b: &Float| Float::with_val(bits + 2, a) == Float::with_val(bits + 2, b);
    // 16 times the bits are enough for every cancellation short of an exact one.
    for _ in 0..4 {
        working *= 2;
        let fine = evaluate(arena, id, working);
        if agree(coarse.real(), fine.real()) && agree(coarse.imag(), fine.imag()) {
            return ComplexRational::new(rational(fine.real()), rational(fine.imag()));
        }
        coarse = fine;
    }
    let fine = evaluate(arena, id, working + 64);
    let settle = |a: &Float, b: &Float| {
        let tiny = b
            .get_exp()
            .is_some_and(|e| i64::from(e) < -i64::from(working / 2));
        if tiny && !agree(a, b) {
            rug::Rational::new()
        } else {
            rational(b)
        }
    };
    ComplexRational::new(
        settle(coarse.real(), fine.real()),
        settle(coarse.imag(), fine.imag()),
    )
}

/// Infinities and what is not a number have no rational; 0 stands for them,
/// and the formats refuse the expressions that give them.
fn rational(x: &Float) -> rug::Rational {
    x.to_rational().unwrap_or_default()
}

/// One evaluation with every operation at this many bits, principal branches.
fn evaluate(arena: &Expressions, id: NodeId, working: u32) -> rug::Complex {
    let mut values: HashMap<NodeId, rug::Complex> = HashMap::new();
    let new = |re: &rug::Rational, im: &rug::Rational| rug::Complex::with_val(working, (re, im));
    for node in crate::expression::differentiate::below(arena, &[id]) {
        let value = match arena.node(node) {
            Node::Constant(c) => new(&c.re, &c.im),
            Node::Add(a, b) => rug::Complex::with_val(working, &values[a] + &values[b]),
            Node::Subtract(a, b) => rug::Complex::with_val(working, &values[a] - &values[b]),
            Node::Multiply(a, b) => rug::Complex::with_val(working, &values[a] * &values[b]),
            Node::Divide(a, b) => rug::Complex::with_val(working, &values[a] / &values[b]),
            Node::Negate(a) => rug::Complex::with_val(working, -&values[a]),
            Node::Power(a, e) => {
                rug::Complex::with_val(working, rug::ops::Pow::pow(&values[a], *e))
            }
            Node::Root(a, exponent) => {
                let half = rug::Rational::from((1, 2));
                if *exponent == half {
                    values[a].clone().sqrt()
                } else {
                    let power = rug::Complex::with_val(working, (exponent, 0));
                    rug::ops::Pow::pow(values[a].clone(), power)
                }
            }
            Node::Function(function, a) => {
                let x = values[a].clone();
                match function {
                    Function::SquareRoot => x.sqrt(),
                    Function::Exponential => x.exp(),
                    Function::Logarithm => x.ln(),
                    Function::Sine => x.sin(),
                    Function::Cosine => x.cos(),
                    Function::Tangent => x.tan(),
                    Function::Pi => rug::Complex::with_val(
                        working,
                        Float::with_val(working, rug::float::Constant::Pi),
                    ),
                }
            }
            Node::Variable(_) | Node::Parameter(_) => {
                unreachable!("a constant contains no variable and no parameter")
            }
        };
        values.insert(node, value);
    }
    values.remove(&id).expect("the last node is the wanted one")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rug::Rational;

    #[test]
    fn roots_and_functions_are_rounded_to_nearest() {
        let mut e = Expressions::new();
        let three = e.integer(3);
        let root = e.root(three, Rational::from((1, 2)));
        let mut pool = ConstantPool::default();
        let described = pool.describe(&e, root);
        pool.insert(described);
        let value = pool.round::<f64>(0, ()).re;
        let mut expected = 3.0;
        Real::sqrt(&mut expected);
        assert_eq!(value, expected);
        let zero = e.integer(0);
        let pi = e.function(Function::Pi, zero);
        let described = pool.describe(&e, pi);
        pool.insert(described);
        assert_eq!(pool.round::<f64>(1, ()).re, std::f64::consts::PI);
    }

    #[test]
    fn what_cancels_exactly_is_zero() {
        let mut e = Expressions::new();
        let two = e.integer(2);
        let root = e.root(two, Rational::from((1, 2)));
        let square = e.power(root, 2);
        let difference = e.subtract(square, two);
        assert!(algebraic(&e, difference, 53).is_zero());
        // (-1)^(1/3) is the principal root, with both parts.
        let minus = e.integer(-1);
        let cube_root = e.root(minus, Rational::from((1, 3)));
        let w = algebraic(&e, cube_root, 53);
        assert_eq!(f64::from_rational((), &w.re), 0.5);
        assert!((w.im.to_f64() - 0.866_025_403_784_438_6).abs() < 1e-15);
    }
}
