//! Expressions over a prime field: what is not 0 here is not 0.
//!
//! Rationals map to residues, i to a root of -1, parameters and constants that
//! are not rational to random residues. An expression that vanishes at random
//! points of a field of 2^61 elements vanishes, but for odds of its degree to 2^61.

use crate::expression::differentiate::below;
use crate::expression::{Expressions, Node, NodeId};
use cognate_numeric::interruption::count_work;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use foldhash::{HashMap, HashMapExt};

/// The largest two primes below 2^61 that are 1 modulo 4, each with a square root of -1.
const FIELDS: [Field; 2] = [
    Field {
        prime: 2_305_843_009_213_693_921,
        i: 583_529_827_753_931_384,
    },
    Field {
        prime: 2_305_843_009_213_693_693,
        i: 966_685_122_347_009_555,
    },
];

/// Residues modulo a prime that is 1 modulo 4, and a square root of -1.
#[derive(Clone, Copy)]
pub(super) struct Field {
    pub prime: u64,
    pub i: u64,
}

impl Field {
    pub(super) fn add(self, a: u64, b: u64) -> u64 {
        (a + b) % self.prime
    }

    pub(super) fn sub(self, a: u64, b: u64) -> u64 {
        (a + self.prime - b) % self.prime
    }

    pub(super) fn mul(self, a: u64, b: u64) -> u64 {
        (u128::from(a) * u128::from(b) % u128::from(self.prime)) as u64
    }

    pub(super) fn power(self, mut base: u64, mut exponent: u64) -> u64 {
        let mut result = 1;
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.mul(result, base);
            }
            base = self.mul(base, base);
            exponent >>= 1;
        }
        result
    }

    pub(super) fn inverse(self, a: u64) -> Option<u64> {
        match a {
            0 => None,
            // Most numbers are whole: of their denominators no power is taken.
            1 => Some(1),
            _ => Some(self.power(a, self.prime - 2)),
        }
    }

    fn rational(self, q: &Rational) -> Option<u64> {
        let prime = rug::Integer::from(self.prime);
        let residue = |n: &rug::Integer| {
            let mut remainder = rug::Integer::from(n % &prime);
            if remainder < 0 {
                remainder += &prime;
            }
            remainder.to_u64().expect("a residue has 61 bits")
        };
        Some(self.mul(residue(q.numer()), self.inverse(residue(q.denom()))?))
    }

    pub(super) fn complex(self, c: &ComplexRational) -> Option<u64> {
        let im = self.mul(self.i, self.rational(&c.im)?);
        Some(self.add(self.rational(&c.re)?, im))
    }
}

#[derive(Clone, Copy)]
enum Step {
    Known(u64),
    Variable(usize),
    Add(usize, usize),
    Subtract(usize, usize),
    Multiply(usize, usize),
    Divide(usize, usize),
    Negate(usize),
    Power(usize, u32),
}

/// One expression, ready to be evaluated many times.
pub(super) struct Residues {
    field: Field,
    steps: Vec<Step>,
    variables: usize,
}

impl Residues {
    /// `None` where a denominator of a constant is 0 in every field.
    pub(super) fn new(
        expressions: &Expressions,
        root: NodeId,
        variables: usize,
        seed: u64,
    ) -> Option<Self> {
        FIELDS
            .iter()
            .find_map(|&field| Self::in_field(field, expressions, root, variables, seed))
    }

    fn in_field(
        field: Field,
        expressions: &Expressions,
        root: NodeId,
        variables: usize,
        seed: u64,
    ) -> Option<Self> {
        let mut place: HashMap<NodeId, usize> = HashMap::new();
        let mut steps = Vec::new();
        for id in below(expressions, &[root]) {
            // One residue for each parameter and constant, wherever it occurs.
            let random = |kind: u64, index: u32| {
                RandomStream::new(seed + kind, Purpose::Probe, u64::from(index)).below(field.prime)
            };
            let step = match expressions.node(id) {
                Node::Constant(c) => Step::Known(field.complex(c)?),
                Node::Variable(v) => Step::Variable(*v as usize),
                Node::Parameter(p) => Step::Known(random(1 << 32, *p)),
                Node::Root(..) | Node::Function(..) => Step::Known(random(2 << 32, id.0)),
                Node::Add(a, b) => Step::Add(place[a], place[b]),
                Node::Subtract(a, b) => Step::Subtract(place[a], place[b]),
                Node::Multiply(a, b) => Step::Multiply(place[a], place[b]),
                Node::Divide(a, b) => Step::Divide(place[a], place[b]),
                Node::Negate(a) => Step::Negate(place[a]),
                Node::Power(a, exponent) => Step::Power(place[a], *exponent),
            };
            place.insert(id, steps.len());
            steps.push(step);
        }
        Some(Self {
            field,
            steps,
            variables,
        })
    }

    /// A random point.
    pub(super) fn point(&self, stream: &mut RandomStream) -> Vec<u64> {
        (0..self.variables)
            .map(|_| stream.below(self.field.prime))
            .collect()
    }

    /// `a + s*b`, coordinate by coordinate.
    pub(super) fn along(&self, a: &[u64], b: &[u64], s: u64) -> Vec<u64> {
        a.iter()
            .zip(b)
            .map(|(&a, &b)| self.field.add(a, self.field.mul(s, b)))
            .collect()
    }

    /// The value at a point; `None` where a denominator is 0.
    pub(super) fn value(&self, x: &[u64], memory: &mut Vec<u64>) -> Option<u64> {
        let f = self.field;
        memory.clear();
        for &step in &self.steps {
            let value = match step {
                Step::Known(c) => c,
                Step::Variable(v) => x[v],
                Step::Add(a, b) => f.add(memory[a], memory[b]),
                Step::Subtract(a, b) => f.sub(memory[a], memory[b]),
                Step::Multiply(a, b) => f.mul(memory[a], memory[b]),
                Step::Divide(a, b) => f.mul(memory[a], f.inverse(memory[b])?),
                Step::Negate(a) => f.sub(0, memory[a]),
                Step::Power(a, exponent) => f.power(memory[a], u64::from(exponent)),
            };
            memory.push(value);
        }
        memory.last().copied()
    }

    /// The degree of `f(a + s*b)` in s, where it is at most `bound`; `None`
    /// for the zero polynomial, for a point where a denominator is 0, and where the work is interrupted.
    pub(super) fn degree_along(&self, a: &[u64], b: &[u64], bound: u32) -> Option<u32> {
        let f = self.field;
        let mut memory = Vec::new();
        let mut differences: Vec<u64> = (0..=u64::from(bound))
            .map(|s| {
                let work = 2 * (self.variables + self.steps.len()) as u64;
                if count_work(work) {
                    return None;
                }
                self.value(&self.along(a, b, s), &mut memory)
            })
            .collect::<Option<_>>()?;
        // Newton's divided differences at 0, 1, ..: after round k, entry k is
        // the coefficient of s(s-1)...(s-k+1).
        let count = differences.len();
        for k in 1..count {
            let inverse = f.inverse(k as u64)?;
            if count_work(2 * (count - k) as u64) {
                return None;
            }
            for j in (k..count).rev() {
                let difference = f.sub(differences[j], differences[j - 1]);
                differences[j] = f.mul(difference, inverse);
            }
        }
        let last = differences.iter().rposition(|&c| c != 0)?;
        u32::try_from(last).ok()
    }

    /// Whether f(a with the group scaled by s) = s^degree f(a), at random a and s.
    pub(super) fn scales(&self, group: &[usize], degree: u32, stream: &mut RandomStream) -> bool {
        let f = self.field;
        let mut memory = Vec::new();
        (0..3).all(|_| {
            let a = self.point(stream);
            let s = stream.below(f.prime);
            let mut scaled = a.clone();
            for &v in group {
                scaled[v] = f.mul(scaled[v], s);
            }
            let (before, after) = (
                self.value(&a, &mut memory),
                self.value(&scaled, &mut memory),
            );
            match (before, after) {
                (Some(before), Some(after)) => {
                    f.mul(before, f.power(s, u64::from(degree))) == after
                }
                _ => false,
            }
        })
    }
}
