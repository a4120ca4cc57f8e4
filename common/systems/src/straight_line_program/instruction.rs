//! The instructions and their operands; what each one computes and how it is rounded.
//!
//! Almost everything is one instruction: a sum of values, real and complex
//! multiples, and products, formed in registers and stored once. A product is
//! rounded as in `Complex::set_product`, each further one as in
//! `Complex::mul_add` and `mul_sub`. The reference evaluator spells it out.

/// How many terms of each kind a sum has.
///
/// A sum starts with its first term in the order of the fields here, and adds
/// the others in the same order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Terms {
    /// Values that are added.
    pub plus: u8,
    /// Values that are subtracted.
    pub minus: u8,
    /// Values times a real constant.
    pub scaled: u8,
    /// Values times a complex constant.
    pub turned: u8,
    /// Products that are added.
    pub products: u8,
    /// Products that are subtracted.
    pub negatives: u8,
}

impl Terms {
    /// Number of operands: one for a value, two for everything else.
    #[inline(always)]
    pub const fn operands(self) -> usize {
        self.plus as usize
            + self.minus as usize
            + 2 * (self.scaled as usize
                + self.turned as usize
                + self.products as usize
                + self.negatives as usize)
    }

    fn count(self) -> usize {
        [
            self.plus,
            self.minus,
            self.scaled,
            self.turned,
            self.products,
            self.negatives,
        ]
        .into_iter()
        .map(usize::from)
        .sum()
    }
}

/// Sums that are frequent enough for an arm of their own in an interpreter;
/// a run knows its place in this list.
pub const FREQUENT: [Terms; 20] = {
    /// In the order of the fields.
    const fn of(plus: u8, minus: u8, scaled: u8, products: u8, negatives: u8) -> Terms {
        Terms {
            plus,
            minus,
            scaled,
            turned: 0,
            products,
            negatives,
        }
    }
    [
        of(1, 0, 0, 0, 0),
        of(0, 1, 0, 0, 0),
        of(2, 0, 0, 0, 0),
        of(1, 1, 0, 0, 0),
        of(3, 0, 0, 0, 0),
        of(0, 0, 1, 0, 0),
        of(0, 0, 2, 0, 0),
        of(1, 0, 1, 0, 0),
        of(0, 0, 0, 1, 0),
        of(0, 0, 0, 0, 1),
        of(1, 0, 0, 1, 0),
        of(1, 0, 0, 0, 1),
        of(0, 1, 0, 1, 0),
        of(0, 0, 0, 2, 0),
        of(0, 0, 0, 1, 1),
        of(1, 0, 0, 2, 0),
        of(1, 0, 0, 1, 1),
        of(2, 0, 0, 1, 0),
        of(0, 0, 0, 3, 0),
        of(0, 0, 0, 2, 1),
    ]
};

/// Operation of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operation {
    /// The sum of its terms, of which there is at least one.
    Sum(Terms),
    /// The square of its operand.
    Square,
    /// The reciprocal of its operand.
    Inverse,
}

impl Operation {
    /// Number of operands.
    #[inline(always)]
    pub fn operands(self) -> usize {
        match self {
            Self::Sum(terms) => terms.operands(),
            Self::Square | Self::Inverse => 1,
        }
    }

    /// Real additions, subtractions, multiplications and divisions; a fused
    /// multiply-add counts as two, a change of sign as none.
    pub fn flops(self) -> usize {
        match self {
            Self::Square | Self::Inverse => 5,
            Self::Sum(terms) => {
                // Two for each term to be added to what is there, but for the first.
                2 * (terms.count() - 1)
                    + 2 * usize::from(terms.scaled)
                    + 6 * usize::from(terms.turned)
                    + 6 * (usize::from(terms.products) + usize::from(terms.negatives))
            }
        }
    }

    /// Whether an operand is a single constant instead of an address in memory.
    pub fn takes_single(self, operand: usize) -> bool {
        match self {
            Self::Sum(terms) => {
                let first = usize::from(terms.plus) + usize::from(terms.minus);
                let constants = usize::from(terms.scaled) + usize::from(terms.turned);
                operand >= first
                    && operand < first + 2 * constants
                    && (operand - first).is_multiple_of(2)
            }
            Self::Square | Self::Inverse => false,
        }
    }
}

/// Source of an operand, before slots are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operand {
    /// A variable, by index.
    Variable(u32),
    /// A parameter, by index.
    Parameter(u32),
    /// The derivative of a parameter along the path, by index.
    Direction(u32),
    /// A constant that fills all lanes, by index.
    Constant(u32),
    /// A constant that stands once for all lanes, by index; only a multiple takes it.
    Single(u32),
    /// The result of an earlier assignment, by index.
    Value(u32),
}

/// One operation in a list where every assignment makes a new value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// The operation.
    pub operation: Operation,
    /// Operands of the operation; for a sum in the order of [`Terms`], a multiple's constant first.
    pub operands: Vec<Operand>,
    /// The entry of the output that the result is, if it is one. A result that is an output is no operand of anything.
    pub output: Option<u32>,
}
