//! Values of expressions at one point, node by node, without compiling anything.

use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Node, NodeId};
use crate::straight_line_program::constant::{ConstantPool, between};
use crate::straight_line_program::enclosure::enclose_at;
use cognate_numeric::scalar::{Complex, Interval};
use foldhash::{HashMap, HashMapExt};
use num_complex::Complex64;

/// Bits of bounds on the way to those of doubles.
const BITS: u32 = 128;

/// The values of some nodes at the point `x`, with these parameters, in plain doubles: good
/// enough to see how large they are. Infinite or not a number where they do not exist.
pub fn values(
    expressions: &Expressions,
    wanted: &[NodeId],
    x: &[Complex64],
    parameters: &[Complex64],
) -> Vec<Complex64> {
    let mut pool = ConstantPool::default();
    let mut done: HashMap<NodeId, Complex64> = HashMap::new();
    for id in below(expressions, wanted) {
        let value = match expressions.node(id) {
            _ if expressions.dependence(id) == Dependence::Constant => {
                let constant = pool.describe(expressions, id);
                let number = pool.insert(constant);
                pool.round::<f64>(number, ()).lane(0)
            }
            Node::Variable(v) => x[*v as usize],
            Node::Parameter(k) => parameters[*k as usize],
            Node::Add(a, b) => done[a] + done[b],
            Node::Subtract(a, b) => done[a] - done[b],
            Node::Multiply(a, b) => done[a] * done[b],
            Node::Divide(a, b) => done[a] / done[b],
            Node::Negate(a) => -done[a],
            Node::Power(a, exponent) => {
                let one = Complex64::new(1.0, 0.0);
                (0..*exponent).fold(one, |power, _| power * done[a])
            }
            Node::Constant(_) | Node::Root(..) | Node::Function(..) => {
                unreachable!("roots and functions are taken of constants only")
            }
        };
        done.insert(id, value);
    }
    wanted.iter().map(|id| done[id]).collect()
}

/// The value of a node at a box, with these parameters; invalid where no bounds are known. Functions of variables are
/// allowed.
pub fn enclosed(
    expressions: &Expressions,
    wanted: NodeId,
    x: &[Complex<Interval<f64>>],
    parameters: &[Complex<Interval<f64>>],
) -> Complex<Interval<f64>> {
    let part = |part: &Interval<f64>| between(BITS, part);
    let leaf = |node: &Node| {
        let side = match node {
            Node::Parameter(k) => &parameters[*k as usize],
            Node::Variable(v) => &x[*v as usize],
            _ => unreachable!("only variables and parameters have values from outside"),
        };
        Complex {
            re: part(&side.re),
            im: part(&side.im),
        }
    };
    let value = enclose_at(expressions, wanted, BITS, &leaf);
    Complex {
        re: between((), &value.re),
        im: between((), &value.im),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::{Evaluate, Interpreter};
    use crate::named::cyclic;

    #[test]
    fn they_are_those_of_the_interpreter() {
        let system = cyclic(5).system;
        let x: Vec<Complex64> = (0..5)
            .map(|k| Complex64::new(0.3 + 0.2 * f64::from(k), 0.7 - 0.3 * f64::from(k)))
            .collect();
        let direct = values(&system.expressions, &system.equations, &x, &[]);
        let program = Interpreter::compile(&system.expressions, &system.equations, 5, 0);
        let native: Vec<_> = x.iter().map(|z| Complex { re: z.re, im: z.im }).collect();
        let mut out = vec![Complex { re: 0.0, im: 0.0 }; 5];
        let mut scratch = Evaluate::<f64>::scratch(&program, ());
        program.value(&native, &[], &mut out, &mut scratch);
        for (a, b) in direct.iter().zip(&out) {
            assert!((a - b.lane(0)).norm_sqr() < 1e-24);
        }
    }
}
