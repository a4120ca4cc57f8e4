//! Enclosures of algebraic constants, for proofs: roots and elementary functions with both bounds rounded outward.
//!
//! Real arguments only, and the exponential of complex ones; what has no enclosure here is
//! invalid, and then nothing that depends on it is proved.

use crate::expression::{Expressions, Function, Node, NodeId, differentiate::below};
use cognate_numeric::scalar::directed::{Directed, Toward};
use cognate_numeric::scalar::{Complex, Interval, MultiplePrecision, Real};
use foldhash::{HashMap, HashMapExt};
use rug::Float;
use rug::float::{Constant, Round};

type Bounds = Interval<MultiplePrecision>;

/// A constant of the arena, enclosed with this many bits; invalid parts where that is not known.
pub(super) fn enclose(arena: &Expressions, id: NodeId, bits: u32) -> Complex<Bounds> {
    enclose_at(arena, id, bits, &|_| {
        unreachable!("a constant contains no variable and no parameter")
    })
}

/// An expression of the arena, enclosed where `leaf` gives the values of variables and parameters.
pub(crate) fn enclose_at(
    arena: &Expressions,
    id: NodeId,
    bits: u32,
    leaf: &dyn Fn(&Node) -> Complex<Bounds>,
) -> Complex<Bounds> {
    let mut values: HashMap<NodeId, Complex<Bounds>> = HashMap::new();
    for node in below(arena, &[id]) {
        let binary = |a: &NodeId, b: &NodeId, f: fn(&mut Complex<Bounds>, &Complex<Bounds>)| {
            let mut value = values[a].clone();
            f(&mut value, &values[b]);
            value
        };
        let value = match arena.node(node) {
            Node::Constant(c) => Complex::from_rational(bits, c),
            Node::Add(a, b) => binary(a, b, Complex::add),
            Node::Subtract(a, b) => binary(a, b, Complex::sub),
            Node::Multiply(a, b) => binary(a, b, Complex::mul),
            Node::Divide(a, b) => binary(a, b, |a, b| {
                if is_real(b) {
                    a.re.div(&b.re);
                    a.im.div(&b.re);
                } else {
                    a.div(b);
                }
            }),
            Node::Negate(a) => {
                let mut value = values[a].clone();
                value.neg();
                value
            }
            Node::Power(a, exponent) => power(&values[a], *exponent, bits),
            Node::Root(a, exponent) if *exponent.numer() == 1 && *exponent.denom() == 2 => {
                square_root(&values[a], bits)
            }
            Node::Root(a, exponent) => {
                // x^e = exp(e ln x).
                let mut power = logarithm(&values[a], bits);
                power.scale(&Bounds::from_rational(bits, exponent));
                exponential(&power, bits)
            }
            Node::Function(function, a) => {
                let x = &values[a];
                match function {
                    Function::SquareRoot => square_root(x, bits),
                    Function::Exponential => exponential(x, bits),
                    Function::Logarithm => logarithm(x, bits),
                    Function::Sine => real_function(x, bits, |x| Some(sine(x))),
                    Function::Cosine => real_function(x, bits, |x| Some(cosine(x))),
                    Function::Tangent => real_function(x, bits, |x| {
                        let mut quotient = sine(x);
                        quotient.div(&cosine(x));
                        Some(quotient)
                    }),
                    Function::Pi => Complex {
                        re: pi(bits),
                        im: Bounds::from_f64(bits, 0.0),
                    },
                }
            }
            variable @ (Node::Variable(_) | Node::Parameter(_)) => leaf(variable),
        };
        values.insert(node, value);
    }
    values.remove(&id).expect("the last node is the wanted one")
}

/// The imaginary part is exactly 0.
fn is_real(x: &Complex<Bounds>) -> bool {
    x.im.lower().0.is_zero() && x.im.upper().0.is_zero()
}

fn invalid(bits: u32) -> Complex<Bounds> {
    Complex {
        re: Bounds::invalid(bits),
        im: Bounds::invalid(bits),
    }
}

/// The interval between what is rounded down and what is rounded up.
fn both(value: impl Fn(Round) -> Float) -> Bounds {
    Interval::new(
        MultiplePrecision(value(Round::Down)),
        MultiplePrecision(value(Round::Up)),
    )
}

/// An increasing function, which rounds as it is told.
fn monotone(x: &Bounds, f: impl Fn(&mut Float, Round)) -> Bounds {
    let end = |bound: &MultiplePrecision, round| {
        let mut value = bound.0.clone();
        f(&mut value, round);
        MultiplePrecision(value)
    };
    Interval::new(end(x.lower(), Round::Down), end(x.upper(), Round::Up))
}

fn real_function(
    x: &Complex<Bounds>,
    bits: u32,
    f: impl Fn(&Bounds) -> Option<Bounds>,
) -> Complex<Bounds> {
    match f(&x.re) {
        Some(re) if is_real(x) => Complex {
            re,
            im: Bounds::from_f64(bits, 0.0),
        },
        _ => invalid(bits),
    }
}

fn pi(bits: u32) -> Bounds {
    both(|round| Float::with_val_round(bits, Constant::Pi, round).0)
}

/// Principal branch, of a real number of known sign.
fn logarithm(x: &Complex<Bounds>, bits: u32) -> Complex<Bounds> {
    let mut size = x.re.clone();
    let mut turn = Bounds::from_f64(bits, 0.0);
    if size.upper().is_negative() {
        size.neg();
        turn = pi(bits);
    }
    if !is_real(x) || !size.lower().is_positive() {
        return invalid(bits);
    }
    Complex {
        re: monotone(&size, |x, round| {
            x.ln_round(round);
        }),
        im: turn,
    }
}

/// Principal branch, of a real number of known sign.
fn square_root(x: &Complex<Bounds>, bits: u32) -> Complex<Bounds> {
    let zero = Bounds::from_f64(bits, 0.0);
    let mut root = x.re.clone();
    if !is_real(x) {
        invalid(bits)
    } else if !root.lower().is_negative() {
        root.sqrt();
        Complex { re: root, im: zero }
    } else {
        // Invalid where the sign is not known.
        root.neg();
        root.sqrt();
        Complex { re: zero, im: root }
    }
}

/// `e^(x + iy) = e^x (cos y + i sin y)`.
fn exponential(x: &Complex<Bounds>, bits: u32) -> Complex<Bounds> {
    let modulus = monotone(&x.re, |x, round| {
        x.exp_round(round);
    });
    if is_real(x) {
        return Complex {
            re: modulus,
            im: Bounds::from_f64(bits, 0.0),
        };
    }
    let mut value = Complex {
        re: cosine(&x.im),
        im: sine(&x.im),
    };
    value.scale(&modulus);
    value
}

fn sine(x: &Bounds) -> Bounds {
    lipschitz(x, |x, round| {
        x.sin_round(round);
    })
}

fn cosine(x: &Bounds) -> Bounds {
    lipschitz(x, |x, round| {
        x.cos_round(round);
    })
}

/// A function that changes no faster than its argument: its value at the lower end, and the width.
fn lipschitz(x: &Bounds, f: impl Fn(&mut Float, Round)) -> Bounds {
    let mut value = monotone(&Interval::point(x.lower()), f);
    let width = MultiplePrecision::difference(x.upper(), x.lower(), Toward::Above);
    let mut opposite = width.clone();
    opposite.neg();
    value.add(&Interval::new(opposite, width));
    value
}

/// Computes a power by repeated products, as many as it takes.
fn power(x: &Complex<Bounds>, exponent: u32, bits: u32) -> Complex<Bounds> {
    let mut result = Complex::from_f64(bits, 1.0, 0.0);
    let (mut base, mut rest) = (x.clone(), exponent);
    while rest > 0 {
        if rest & 1 == 1 {
            result.mul(&base);
        }
        rest >>= 1;
        let copy = base.clone();
        if rest > 0 {
            base.mul(&copy);
        }
    }
    // An even power of a real number is not negative.
    if exponent.is_multiple_of(2) && is_real(x) && result.re.lower().is_negative() {
        let zero = MultiplePrecision(Float::new(bits));
        result.re = Interval::new(zero, result.re.upper().clone());
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::straight_line_program::constant::algebraic;
    use rug::Rational;

    #[test]
    fn enclosures_hold_the_constants_and_are_narrow() {
        let mut e = Expressions::new();
        let (two, three, zero) = (e.integer(2), e.integer(-3), e.integer(0));
        let pi = e.function(Function::Pi, zero);
        let root = e.root(two, Rational::from((1, 2)));
        let imaginary = e.root(three, Rational::from((1, 2)));
        let power = e.root(pi, Rational::from((-2, 3)));
        let sum = e.add(imaginary, power);
        let square = e.power(sum, 5);
        let ratio = e.divide(square, root);
        let turned = e.function(Function::Exponential, imaginary);
        let mut constants = vec![pi, root, imaginary, power, sum, square, ratio, turned];
        for function in [
            Function::SquareRoot,
            Function::Exponential,
            Function::Logarithm,
            Function::Sine,
            Function::Cosine,
            Function::Tangent,
        ] {
            constants.push(e.function(function, power));
        }
        constants.push(e.function(Function::Logarithm, three));
        constants.push(e.root(three, Rational::from((2, 5))));
        for id in constants {
            for bits in [64, 200] {
                let box_ = enclose(&e, id, bits);
                let value = algebraic(&e, id, 400);
                assert!(box_.re.contains(&value.re) && box_.im.contains(&value.im));
                let mut width = box_.re.clone();
                width.sub(&box_.re);
                assert!(width.magnitude() < if bits == 64 { 1e-14 } else { 1e-50 });
            }
        }
        // The logarithm and the sine of a complex number are not known here.
        for function in [Function::Logarithm, Function::Sine] {
            let id = e.function(function, imaginary);
            assert!(!enclose(&e, id, 64).is_valid());
        }
    }
}
