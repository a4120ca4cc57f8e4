//! The instructions and their operands; what each one computes and how it is rounded.
//!
//! A product is rounded as in `Complex::set_product`, a fused sum as in
//! `Complex::mul_add` and `mul_sub`: the real factor's products first, one
//! rounding each. The reference evaluator spells each one out.

/// What an instruction computes from its operands a, b, c, d.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operation {
    /// a
    Copy,
    /// -a
    Negate,
    /// a^2
    Square,
    /// 1/a
    Inverse,
    /// a + b
    Add,
    /// a - b
    Subtract,
    /// a*b
    Multiply,
    /// re(a)*b, where a is a real constant
    Scale,
    /// c + a*b
    MultiplyAdd,
    /// a*b - c
    MultiplySubtract,
    /// c - a*b
    SubtractProduct,
    /// c + re(a)*b, where a is a real constant
    ScaleAdd,
    /// re(a)*b - c, where a is a real constant
    ScaleSubtract,
    /// c - re(a)*b, where a is a real constant
    SubtractScaled,
    /// a*b + c*d: c*d is rounded first
    ProductSum,
    /// a*b - c*d: a*b is rounded first
    ProductDifference,
}

impl Operation {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Copy,
        Self::Negate,
        Self::Square,
        Self::Inverse,
        Self::Add,
        Self::Subtract,
        Self::Multiply,
        Self::Scale,
        Self::MultiplyAdd,
        Self::MultiplySubtract,
        Self::SubtractProduct,
        Self::ScaleAdd,
        Self::ScaleSubtract,
        Self::SubtractScaled,
        Self::ProductSum,
        Self::ProductDifference,
    ];

    /// Number of operands, 1 to 4.
    pub fn arity(self) -> usize {
        match self {
            Self::Copy | Self::Negate | Self::Square | Self::Inverse => 1,
            Self::Add | Self::Subtract | Self::Multiply | Self::Scale => 2,
            Self::MultiplyAdd
            | Self::MultiplySubtract
            | Self::SubtractProduct
            | Self::ScaleAdd
            | Self::ScaleSubtract
            | Self::SubtractScaled => 3,
            Self::ProductSum | Self::ProductDifference => 4,
        }
    }

    /// Real additions, subtractions, multiplications and divisions; a fused
    /// multiply-add counts as two, a change of sign as none.
    pub fn flops(self) -> usize {
        match self {
            Self::Copy | Self::Negate => 0,
            Self::Square | Self::Inverse => 5,
            Self::Add | Self::Subtract | Self::Scale => 2,
            Self::Multiply => 6,
            Self::ScaleAdd | Self::ScaleSubtract | Self::SubtractScaled => 4,
            Self::MultiplyAdd | Self::MultiplySubtract | Self::SubtractProduct => 8,
            Self::ProductSum | Self::ProductDifference => 14,
        }
    }
}

/// Where an operand comes from, before slots are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operand {
    /// A variable, by index.
    Variable(u32),
    /// A parameter, by index.
    Parameter(u32),
    /// The derivative of a parameter along the path, by index.
    Direction(u32),
    /// A constant of the program, by index.
    Constant(u32),
    /// The result of an earlier assignment, by index.
    Value(u32),
}

/// One operation in a list where every assignment makes a new value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// What is computed.
    pub operation: Operation,
    /// From what; the first `operation.arity()` of them count.
    pub operands: [Operand; 4],
    /// The entry of the output that the result is, if it is one. Such a
    /// result is no operand of anything.
    pub output: Option<u32>,
}

impl Assignment {
    /// The operands that count.
    pub fn used(&self) -> &[Operand] {
        &self.operands[..self.operation.arity()]
    }
}
