//! Routine: what is computed, as operations on vectors of doubles; each makes a new value.
//!
//! Complex numbers are two values. The order of rounding is fixed here, by the same steps as
//! `Complex` of the numeric crate takes; where a value stands is not.

use crate::encoder::{Base, Signs};
use std::collections::HashMap;

/// A vector of doubles, by number.
pub(crate) type Value = u32;

/// Place of a vector in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Place {
    /// Part 0 (real) or 1 (imaginary) of a number of one of the caller's arrays.
    Number {
        /// The caller's array, by the register of its address.
        base: Base,
        /// Index of the number in the array.
        index: u32,
        /// Real part (0) or imaginary part (1).
        part: u8,
    },
    /// One of the constants, the same in all lanes.
    Constant(u32),
    /// Room for values that find no register.
    Spill(u32),
}

/// Registers of the addresses of the arrays that a routine is called with.
pub(crate) const VARIABLES: Base = Base::First;
pub(crate) const PARAMETERS: Base = Base::Second;
pub(crate) const DIRECTIONS: Base = Base::Third;
pub(crate) const OUTPUT: Base = Base::Fourth;
pub(crate) const SPILL: Base = Base::Fifth;
pub(crate) const CONSTANTS: Base = Base::Sixth;

/// Operation of a step on its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a * b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// Exclusive or of the bits: with -0, the other sign.
    Xor,
    /// `a` where `a > b`, else `b`, also where one is not a number.
    Maximum,
    /// `±a*b ± c` with one rounding.
    Fused(Signs),
}

/// One step of a routine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// A new value; operands that the operation does not have repeat the first.
    Compute(Operation, [Value; 3], Value),
    /// A value goes to an array of the caller.
    Store(Value, Place),
    /// The routine's result: the lanes where the first is less than the second, as bits.
    Less([Value; 2]),
}

impl Step {
    /// Values that the instruction reads.
    pub(crate) fn operands(&self) -> &[Value] {
        match self {
            Self::Compute(Operation::Fused(_), operands, _) => operands,
            Self::Compute(_, operands, _) => &operands[..2],
            Self::Store(value, _) => std::slice::from_ref(value),
            Self::Less(operands) => operands,
        }
    }
}

/// A complex value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pair {
    pub re: Value,
    pub im: Value,
}

/// Steps in order, and the values that stand in memory before the first.
#[derive(Debug, Default)]
pub(crate) struct Routine {
    /// Steps in the order of their execution.
    pub steps: Vec<Step>,
    /// For every value its place in memory from the beginning, if it has one.
    pub homes: Vec<Option<Place>>,
    /// The constants.
    pub constants: Vec<f64>,
    known: HashMap<Place, Value>,
    constant_numbers: HashMap<u64, u32>,
}

impl Routine {
    fn value(&mut self, home: Option<Place>) -> Value {
        let value =
            Value::try_from(self.homes.len()).expect("a routine has fewer than 2^32 values");
        self.homes.push(home);
        value
    }

    /// The value of this place in memory.
    pub(crate) fn at(&mut self, place: Place) -> Value {
        if let Some(&value) = self.known.get(&place) {
            return value;
        }
        let value = self.value(Some(place));
        self.known.insert(place, value);
        value
    }

    /// A number of an array.
    pub(crate) fn number(&mut self, base: Base, index: u32) -> Pair {
        let mut part = |part| self.at(Place::Number { base, index, part });
        Pair {
            re: part(0),
            im: part(1),
        }
    }

    /// Value that holds this double in all lanes.
    pub(crate) fn constant(&mut self, constant: f64) -> Value {
        let next = u32::try_from(self.constants.len()).expect("fewer than 2^32 constants");
        let number = *self
            .constant_numbers
            .entry(constant.to_bits())
            .or_insert(next);
        if number == next {
            self.constants.push(constant);
        }
        self.at(Place::Constant(number))
    }

    fn compute(&mut self, operation: Operation, operands: [Value; 3]) -> Value {
        let result = self.value(None);
        self.steps.push(Step::Compute(operation, operands, result));
        result
    }

    /// `a op b`.
    pub(crate) fn binary(&mut self, operation: Operation, a: Value, b: Value) -> Value {
        self.compute(operation, [a, b, a])
    }

    /// `±a*b ± c`.
    pub(crate) fn fused(&mut self, signs: Signs, a: Value, b: Value, c: Value) -> Value {
        self.compute(Operation::Fused(signs), [a, b, c])
    }

    /// `-a`.
    pub(crate) fn negative(&mut self, a: Value) -> Value {
        let sign = self.constant(-0.0);
        self.binary(Operation::Xor, a, sign)
    }

    /// `a*b - c`.
    pub(crate) fn less(&mut self, a: Value, b: Value, c: Value) -> Value {
        let signs = Signs {
            product: false,
            addend: true,
        };
        self.fused(signs, a, b, c)
    }

    /// Computes the product as `Complex::set_product` does.
    pub(crate) fn product(&mut self, a: Pair, b: Pair) -> Pair {
        let re = self.binary(Operation::Multiply, a.im, b.im);
        let im = self.binary(Operation::Multiply, a.im, b.re);
        Pair {
            re: self.less(a.re, b.re, re),
            im: self.fused(Signs::default(), a.re, b.im, im),
        }
    }

    /// Computes the square as `Complex::set_square` does.
    pub(crate) fn square(&mut self, a: Pair) -> Pair {
        let re = self.binary(Operation::Multiply, a.im, a.im);
        let im = self.binary(Operation::Add, a.re, a.re);
        Pair {
            re: self.less(a.re, a.re, re),
            im: self.binary(Operation::Multiply, im, a.im),
        }
    }

    /// Computes `c*a` with a constant `c` as `Complex::set_turned` does.
    pub(crate) fn turned(&mut self, c: Pair, a: Pair) -> Pair {
        let re = self.binary(Operation::Multiply, a.im, c.im);
        let im = self.binary(Operation::Multiply, a.re, c.im);
        Pair {
            re: self.less(c.re, a.re, re),
            im: self.fused(Signs::default(), c.re, a.im, im),
        }
    }

    /// Computes the squared modulus as `Complex::norm_sqr` does.
    pub(crate) fn norm_sqr(&mut self, a: Pair) -> Value {
        let square = self.binary(Operation::Multiply, a.re, a.re);
        self.fused(Signs::default(), a.im, a.im, square)
    }

    /// Computes the inverse as `Complex::inverse` does.
    pub(crate) fn inverse(&mut self, a: Pair) -> Pair {
        let n = self.norm_sqr(a);
        let im = self.negative(a.im);
        Pair {
            re: self.binary(Operation::Divide, a.re, n),
            im: self.binary(Operation::Divide, im, n),
        }
    }

    /// A number goes to an array. What stood there before must not be used any more.
    pub(crate) fn store(&mut self, pair: Pair, base: Base, index: u32) {
        for (part, value) in [(0, pair.re), (1, pair.im)] {
            let place = Place::Number { base, index, part };
            self.steps.push(Step::Store(value, place));
            self.known.insert(place, value);
        }
    }
}

/// A sum under construction: the negative of what stands in it, where `negative`. A change of
/// sign is exact, so that it may wait for the next term and cost nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sum {
    so_far: Pair,
    negative: bool,
}

impl Sum {
    /// Begins with a term.
    pub(crate) fn new(first: Pair, negative: bool) -> Self {
        Self {
            so_far: first,
            negative,
        }
    }

    fn each(&mut self, mut step: impl FnMut(Value, usize) -> Value) {
        self.so_far = Pair {
            re: step(self.so_far.re, 0),
            im: step(self.so_far.im, 1),
        };
    }

    /// `self += a`.
    pub(crate) fn add(&mut self, r: &mut Routine, a: Pair) {
        let (a, negative) = ([a.re, a.im], std::mem::take(&mut self.negative));
        self.each(|sum, part| match negative {
            true => r.binary(Operation::Subtract, a[part], sum),
            false => r.binary(Operation::Add, sum, a[part]),
        });
    }

    /// `self -= a`.
    pub(crate) fn subtract(&mut self, r: &mut Routine, a: Pair) {
        self.so_far = self.finish(r);
        self.negative = false;
        let a = [a.re, a.im];
        self.each(|sum, part| r.binary(Operation::Subtract, sum, a[part]));
    }

    /// `self += c*a` with a real constant `c`.
    pub(crate) fn add_multiple(&mut self, r: &mut Routine, c: Value, a: Pair) {
        let a = [a.re, a.im];
        let signs = self.signs(false);
        self.each(|sum, part| r.fused(signs, c, a[part], sum));
    }

    /// `self += a*b`, or `self -= a*b`, as `Complex::mul_add` and `mul_sub`; a constant times a
    /// value, as `Complex::add_turned`, is the same.
    pub(crate) fn add_product(&mut self, r: &mut Routine, a: Pair, b: Pair, negative: bool) {
        let first = self.signs(negative);
        self.each(|sum, part| r.fused(first, a.re, [b.re, b.im][part], sum));
        let signs = [self.signs(!negative), self.signs(negative)];
        self.each(|sum, part| r.fused(signs[part], a.im, [b.im, b.re][part], sum));
    }

    /// Signs of a fused step that adds a product, or subtracts it, and takes the waiting sign.
    fn signs(&mut self, negative: bool) -> Signs {
        Signs {
            product: negative,
            addend: std::mem::take(&mut self.negative),
        }
    }

    /// The sum.
    pub(crate) fn finish(self, r: &mut Routine) -> Pair {
        if !self.negative {
            return self.so_far;
        }
        Pair {
            re: r.negative(self.so_far.re),
            im: r.negative(self.so_far.im),
        }
    }
}
