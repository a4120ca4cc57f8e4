//! Constants: what a name means that nothing declares.

use crate::expression::parse::Names;
use crate::expression::{Expressions, Function, NodeId};
use cognate_numeric::rational::ComplexRational;

/// The circle constant as SymPy, MATLAB, Octave, Maple, Maxima and Scilab write it.
const PI: [&str; 4] = ["pi", "PI", "π", "%pi"];
/// The imaginary unit of Maxima and Scilab, and of numbers such as `2i` of MATLAB and Octave.
const IMAGINARY_UNIT: [&str; 2] = ["%i", "1i"];

/// Whether a name is a constant where nothing declares it.
pub(crate) fn is_constant(names: &Names, name: u32) -> bool {
    let text = names.name(name);
    // `2i` beside an `i` could be a product.
    let is_unit = IMAGINARY_UNIT.contains(&text) && (text != "1i" || names.find("i").is_none());
    is_unit || PI.contains(&text)
}

/// The constant of a name that nothing declares.
pub(crate) fn constant(names: &Names, name: u32, expressions: &mut Expressions) -> Option<NodeId> {
    if !is_constant(names, name) {
        return None;
    }
    if PI.contains(&names.name(name)) {
        let zero = expressions.integer(0);
        return Some(expressions.function(Function::Pi, zero));
    }
    Some(expressions.constant(ComplexRational::i()))
}
