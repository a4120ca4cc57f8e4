//! Field: the arithmetic that expressions are evaluated in, and the one sweep that does it.
//!
//! Two fields for deciding whether a system is invariant under an involution:
//! integers modulo a prime (exact), and many bits where constants are not
//! rational. One more, with a bound beside each value, is in `degenerate`.

use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::{Expressions, Function, Node, NodeId};
use num_complex::Complex64;
use rug::ops::{NegAssign, Pow};
use rug::{Complex, Float, Integer};
use std::collections::HashMap;

/// An arithmetic for expressions. `None` means that a value does not exist in it.
pub trait Field {
    /// An element.
    type Value: Clone;
    /// An exact number.
    fn constant(&self, value: &ComplexRational) -> Option<Self::Value>;
    /// `a + b`.
    fn add(&self, a: &Self::Value, b: &Self::Value) -> Self::Value;
    /// `-a`.
    fn negate(&self, a: &Self::Value) -> Self::Value;
    /// `a * b`.
    fn multiply(&self, a: &Self::Value, b: &Self::Value) -> Self::Value;
    /// `a / b`, unless `b` is 0.
    fn divide(&self, a: &Self::Value, b: &Self::Value) -> Option<Self::Value>;
    /// A rational power, principal branch.
    fn root(&self, a: &Self::Value, exponent: &Rational) -> Option<Self::Value>;
    /// An elementary function.
    fn function(&self, function: Function, a: &Self::Value) -> Option<Self::Value>;
}

/// The values of some nodes; `None` when one of them does not exist in the field.
///
/// Children have smaller numbers than parents, so one ascending sweep does it.
pub fn evaluate<F: Field>(
    field: &F,
    expressions: &Expressions,
    roots: &[NodeId],
    variables: &[F::Value],
    parameters: &[F::Value],
) -> Option<Vec<F::Value>> {
    let count = roots.iter().map(|r| r.0 as usize + 1).max().unwrap_or(0);
    let mut needed = vec![false; count];
    for root in roots {
        needed[root.0 as usize] = true;
    }
    for id in (0..count).rev() {
        if needed[id] {
            for child in expressions.children(NodeId(id as u32)) {
                needed[child.0 as usize] = true;
            }
        }
    }
    let mut values: Vec<Option<F::Value>> = vec![None; count];
    for id in 0..count {
        if !needed[id] {
            continue;
        }
        let node = expressions.node(NodeId(id as u32));
        let value = of_node(field, node, &values, variables, parameters)?;
        values[id] = Some(value);
    }
    roots.iter().map(|r| values[r.0 as usize].clone()).collect()
}

/// Some roots with all that they need and no other node, numbered anew; children stand before
/// parents.
pub(crate) fn extract(e: &Expressions, roots: &[NodeId]) -> (Vec<Node>, Vec<NodeId>) {
    let mut needed = vec![false; e.nodes().len()];
    for root in roots {
        needed[root.0 as usize] = true;
    }
    for id in (0..needed.len()).rev() {
        if needed[id] {
            for child in e.children(NodeId(id as u32)) {
                needed[child.0 as usize] = true;
            }
        }
    }
    let mut places = HashMap::new();
    let mut nodes = Vec::new();
    for id in (0..needed.len()).filter(|&id| needed[id]) {
        let at = |n: &NodeId| places[n];
        let node = match e.node(NodeId(id as u32)) {
            Node::Add(a, b) => Node::Add(at(a), at(b)),
            Node::Subtract(a, b) => Node::Subtract(at(a), at(b)),
            Node::Multiply(a, b) => Node::Multiply(at(a), at(b)),
            Node::Divide(a, b) => Node::Divide(at(a), at(b)),
            Node::Negate(a) => Node::Negate(at(a)),
            Node::Power(a, exponent) => Node::Power(at(a), *exponent),
            Node::Root(a, exponent) => Node::Root(at(a), exponent.clone()),
            Node::Function(function, a) => Node::Function(*function, at(a)),
            leaf @ (Node::Constant(_) | Node::Variable(_) | Node::Parameter(_)) => leaf.clone(),
        };
        places.insert(NodeId(id as u32), NodeId(nodes.len() as u32));
        nodes.push(node);
    }
    (nodes, roots.iter().map(|root| places[root]).collect())
}

/// The value of one node, whose children have theirs in `values`.
pub(crate) fn of_node<F: Field>(
    field: &F,
    node: &Node,
    values: &[Option<F::Value>],
    variables: &[F::Value],
    parameters: &[F::Value],
) -> Option<F::Value> {
    let operand = |n: &NodeId| values[n.0 as usize].as_ref();
    Some(match node {
        Node::Constant(c) => field.constant(c)?,
        Node::Variable(v) => variables.get(*v as usize)?.clone(),
        Node::Parameter(p) => parameters.get(*p as usize)?.clone(),
        Node::Add(a, b) => field.add(operand(a)?, operand(b)?),
        Node::Subtract(a, b) => field.add(operand(a)?, &field.negate(operand(b)?)),
        Node::Multiply(a, b) => field.multiply(operand(a)?, operand(b)?),
        Node::Divide(a, b) => field.divide(operand(a)?, operand(b)?)?,
        Node::Negate(a) => field.negate(operand(a)?),
        Node::Power(a, exponent) => power(field, operand(a)?, *exponent)?,
        Node::Root(a, exponent) => field.root(operand(a)?, exponent)?,
        Node::Function(f, a) => field.function(*f, operand(a)?)?,
    })
}

/// By repeated squaring.
fn power<F: Field>(field: &F, base: &F::Value, exponent: u32) -> Option<F::Value> {
    let mut result = field.constant(&ComplexRational::real(1))?;
    let mut square = base.clone();
    let mut left = exponent;
    while left > 0 {
        if left & 1 == 1 {
            result = field.multiply(&result, &square);
        }
        left >>= 1;
        if left > 0 {
            square = field.multiply(&square, &square);
        }
    }
    Some(result)
}

/// Integers modulo a prime in which -1 has a square root, taken as i.
#[derive(Clone, Copy, Debug)]
pub struct PrimeField {
    prime: u64,
    i: u64,
}

/// Primes that are 1 modulo 4, so that -1 has a square root.
pub const PRIMES: [u64; 2] = [2_305_843_009_213_693_921, 2_305_843_009_213_693_693];

impl PrimeField {
    /// The field of this prime.
    pub fn new(prime: u64) -> Self {
        let field = Self { prime, i: 0 };
        // a^((p-1)/4) is a root of -1 for every second a.
        let i = (2..)
            .map(|a| field.raise(a, (prime - 1) / 4))
            .find(|&r| field.times(r, r) == prime - 1)
            .expect("half of all numbers are no squares");
        Self { prime, i }
    }

    /// Replaces i by the other square root of -1 in the same field, so that every value becomes its conjugate.
    pub fn conjugate(self) -> Self {
        Self {
            prime: self.prime,
            i: self.prime - self.i,
        }
    }

    /// The prime.
    pub fn prime(&self) -> u64 {
        self.prime
    }

    fn times(&self, a: u64, b: u64) -> u64 {
        (u128::from(a) * u128::from(b) % u128::from(self.prime)) as u64
    }

    fn raise(&self, mut base: u64, mut exponent: u64) -> u64 {
        let mut result = 1;
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.times(result, base);
            }
            base = self.times(base, base);
            exponent >>= 1;
        }
        result
    }

    /// `1 / a` for a residue that is not 0, by Euclid's algorithm: a sixth of the time of the power `prime - 2`.
    fn inverse(&self, a: u64) -> u64 {
        // `factor * a` is `rest` modulo the prime, and no factor is larger than the prime, which has 61 bits.
        let (mut rest, mut next_rest) = (self.prime, a);
        let (mut factor, mut next_factor) = (0i64, 1i64);
        while next_rest != 0 {
            let quotient = rest / next_rest;
            (rest, next_rest) = (next_rest, rest - quotient * next_rest);
            (factor, next_factor) = (next_factor, factor - quotient as i64 * next_factor);
        }
        factor.rem_euclid(self.prime as i64) as u64
    }

    fn rational(&self, value: &Rational) -> Option<u64> {
        let part = |n: &Integer| {
            // Most numbers are small, and take no memory.
            if let Some(small) = n.to_i64() {
                let rest = small.unsigned_abs() % self.prime;
                return Some(if small < 0 { self.negate(&rest) } else { rest });
            }
            let mut rest = Integer::from(n % self.prime);
            if rest < 0 {
                rest += self.prime;
            }
            rest.to_u64()
        };
        self.divide(&part(value.numer())?, &part(value.denom())?)
    }
}

impl Field for PrimeField {
    type Value = u64;

    fn constant(&self, value: &ComplexRational) -> Option<u64> {
        let (re, im) = (self.rational(&value.re)?, self.rational(&value.im)?);
        Some(self.add(&re, &self.times(im, self.i)))
    }
    fn add(&self, a: &u64, b: &u64) -> u64 {
        (a + b) % self.prime
    }
    fn negate(&self, a: &u64) -> u64 {
        (self.prime - a) % self.prime
    }
    fn multiply(&self, a: &u64, b: &u64) -> u64 {
        self.times(*a, *b)
    }
    fn divide(&self, a: &u64, b: &u64) -> Option<u64> {
        match b {
            0 => None,
            // Most numbers are whole.
            1 => Some(*a),
            _ => Some(self.times(*a, self.inverse(*b))),
        }
    }
    fn root(&self, _: &u64, _: &Rational) -> Option<u64> {
        None
    }
    fn function(&self, _: Function, _: &u64) -> Option<u64> {
        None
    }
}

/// Complex doubles: for symmetries, whose images are compared with a margin. No roots and no
/// functions, which would need libm.
#[derive(Clone, Copy, Debug)]
pub struct Doubles;

impl Field for Doubles {
    type Value = Complex64;

    fn constant(&self, value: &ComplexRational) -> Option<Complex64> {
        Some(Complex64::new(value.re.to_f64(), value.im.to_f64()))
    }
    fn add(&self, a: &Complex64, b: &Complex64) -> Complex64 {
        a + b
    }
    fn negate(&self, a: &Complex64) -> Complex64 {
        -a
    }
    fn multiply(&self, a: &Complex64, b: &Complex64) -> Complex64 {
        a * b
    }
    fn divide(&self, a: &Complex64, b: &Complex64) -> Option<Complex64> {
        let quotient = a / b;
        (quotient.re.is_finite() && quotient.im.is_finite()).then_some(quotient)
    }
    fn root(&self, _: &Complex64, _: &Rational) -> Option<Complex64> {
        None
    }
    fn function(&self, _: Function, _: &Complex64) -> Option<Complex64> {
        None
    }
}

/// Complex numbers of many bits, which round.
#[derive(Clone, Copy, Debug)]
pub struct ManyBits(pub u32);

impl ManyBits {
    /// A number on the positive side of every branch cut: no zero is negative.
    fn clean(mut value: Complex) -> Complex {
        if value.real().is_zero() && value.real().is_sign_negative() {
            value.mut_real().neg_assign();
        }
        if value.imag().is_zero() && value.imag().is_sign_negative() {
            value.mut_imag().neg_assign();
        }
        value
    }
}

impl Field for ManyBits {
    type Value = Complex;

    fn constant(&self, value: &ComplexRational) -> Option<Complex> {
        Some(Complex::with_val(self.0, (&value.re, &value.im)))
    }
    fn add(&self, a: &Complex, b: &Complex) -> Complex {
        Complex::with_val(self.0, a + b)
    }
    fn negate(&self, a: &Complex) -> Complex {
        Self::clean(Complex::with_val(self.0, -a))
    }
    fn multiply(&self, a: &Complex, b: &Complex) -> Complex {
        Complex::with_val(self.0, a * b)
    }
    fn divide(&self, a: &Complex, b: &Complex) -> Option<Complex> {
        (*b != 0).then(|| Complex::with_val(self.0, a / b))
    }
    fn root(&self, a: &Complex, exponent: &Rational) -> Option<Complex> {
        if *a == 0 {
            return (*exponent > 0).then(|| a.clone());
        }
        let exponent = Float::with_val(self.0, exponent);
        Some(Self::clean(Complex::with_val(
            self.0,
            Self::clean(a.clone()).pow(exponent),
        )))
    }
    fn function(&self, function: Function, a: &Complex) -> Option<Complex> {
        let a = Self::clean(a.clone());
        let value = match function {
            Function::SquareRoot => a.sqrt(),
            Function::Exponential => a.exp(),
            Function::Logarithm => {
                if a == 0 {
                    return None;
                }
                a.ln()
            }
            Function::Sine => a.sin(),
            Function::Cosine => a.cos(),
            Function::Tangent => a.tan(),
            Function::Pi => Complex::with_val(self.0, rug::float::Constant::Pi),
        };
        let value = Self::clean(value);
        (value.real().is_finite() && value.imag().is_finite()).then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rug::integer::IsPrime;

    #[test]
    fn the_primes_are_primes_with_a_root_of_minus_one() {
        for prime in PRIMES {
            assert_ne!(Integer::from(prime).is_probably_prime(40), IsPrime::No);
            let field = PrimeField::new(prime);
            assert_eq!(field.times(field.i, field.i), prime - 1);
            let third = field.constant(&ComplexRational::new((-1, 3), 0)).unwrap();
            assert_eq!(field.times(third, 3), prime - 1);
            for a in [1, 2, 3, 10_000_000, prime / 2, prime - 2, prime - 1] {
                assert_eq!(field.times(field.inverse(a), a), 1, "{a}");
                assert_eq!(field.inverse(a), field.raise(a, prime - 2), "{a}");
            }
            let whole = |n: Integer| field.constant(&ComplexRational::real(n));
            for small in [7, -7, i64::MAX, i64::MIN] {
                let large = Integer::from(prime) * u64::MAX + small;
                assert_eq!(whole(small.into()), whole(large), "{small}");
            }
            let conjugate = field.conjugate();
            let z = ComplexRational::new(2, 5);
            assert_eq!(
                field.constant(&z.conjugate()),
                conjugate.constant(&z),
                "the other root of -1 conjugates"
            );
        }
    }

    #[test]
    fn fields_agree_with_each_other_and_with_known_values() {
        let mut e = Expressions::new();
        let x = e.variable(0);
        let p = e.parameter(0);
        let third = e.constant(ComplexRational::new((1, 3), (2, 7)));
        let product = e.multiply(third, x);
        let quotient = e.divide(product, p);
        let cube = e.power(quotient, 3);
        let root = e.subtract(cube, x);
        let at = [ComplexRational::new(2, -1)];
        let with = [ComplexRational::new(5, 0)];
        let exact = cognate_systems::expression::exact::value(&e, root, &at, &with).unwrap();
        let field = PrimeField::new(PRIMES[0]);
        let lift = |z: &[ComplexRational]| vec![field.constant(&z[0]).unwrap()];
        let value = evaluate(&field, &e, &[root], &lift(&at), &lift(&with)).unwrap();
        assert_eq!(Some(value[0]), field.constant(&exact));
        let bits = ManyBits(300);
        let lift = |z: &[ComplexRational]| vec![bits.constant(&z[0]).unwrap()];
        let value = evaluate(&bits, &e, &[root], &lift(&at), &lift(&with)).unwrap();
        let difference = Complex::with_val(300, &value[0] - bits.constant(&exact).unwrap());
        assert!(Float::with_val(53, difference.abs_ref()) < 1e-80);
    }

    #[test]
    fn roots_of_negative_numbers_take_the_principal_branch() {
        let mut e = Expressions::new();
        let two = e.integer(-2);
        let root = e.root(two, (1, 2).into());
        let field = ManyBits(100);
        let value = evaluate(&field, &e, &[root], &[], &[]).unwrap();
        assert!(value[0].imag().to_f64() > 1.41 && value[0].real().to_f64().abs() < 1e-20);
        assert!(evaluate(&PrimeField::new(PRIMES[0]), &e, &[root], &[], &[]).is_none());
    }
}
