//! Step: the steps of an expression in postfix order.

use super::fault::Span;
use super::function_name::FunctionName;

/// One step of a stack machine; operators take their operands from the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Puts a number: index into [`Parsed::numbers`](super::parse::Parsed::numbers).
    Number(u32),
    /// Puts what a name stands for: index into [`Names`](super::parse::Names).
    Name(u32),
    /// Puts the imaginary unit.
    ImaginaryUnit,
    /// Puts the circle constant.
    Pi,
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a * b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// `a ^ b`.
    Power,
    /// `-a`.
    Negate,
    /// A function.
    Call(FunctionName),
}

/// A step and the place of its own sign in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// The operation.
    pub operation: Operation,
    /// Place of the operation in the text.
    pub span: Span,
}
