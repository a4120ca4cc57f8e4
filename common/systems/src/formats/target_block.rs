//! Block: the values that one source of targets gives to some parameters.

use super::points::Point;
use crate::expression::fault::Span;

/// Values that one source gives to some parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Block {
    /// Indices of these parameters, ascending.
    pub parameters: Vec<usize>,
    /// Sets of values, each with one value for each of these parameters.
    pub rows: Vec<Point>,
    /// Place where the source names the parameters.
    pub span: Span,
}
