//! A system with rational numbers in the place of its constants that are not rational.

use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Imported, Node, NodeId};
use crate::straight_line_program::constant::ConstantPool;
use crate::system::{DegenerateSet, System};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::MultiplePrecision;
use foldhash::HashMapExt;
use rug::Integer;

/// The system with a rational number for each constant such as `10^(-6.3)`: the simplest that differs from it by at most
/// 2^-`bits` of it, parts of complex numbers by themselves. `None` where a constant that is divided by is 0.
///
/// Equations and denominators are changed; symmetry, helper unknowns and units stay those of the given system.
pub fn rational_constants(system: &System, bits: u32) -> Option<System> {
    let from = &system.expressions;
    let mut out = from.clone();
    let mut copies = rational_numbers(system, bits, &mut out)?;
    let mut copy = |root: NodeId| {
        out.import(from, root, &mut copies, &mut |e, leaf| match leaf {
            Node::Variable(v) => e.variable(*v),
            Node::Parameter(p) => e.parameter(*p),
            _ => unreachable!("other nodes are no leaves"),
        })
    };
    let equations = system.equations.iter().map(|&root| copy(root)).collect();
    let mut degenerate = system.degenerate.clone();
    for node in degenerate.values_mut().flat_map(DegenerateSet::nodes_mut) {
        *node = copy(*node);
    }
    Some(System {
        expressions: out,
        equations,
        degenerate,
        ..system.clone()
    })
}

/// The rational number, among the expressions `out`, for each constant of a system that is not rational. `None` where
/// something is divided by a constant that is 0.
fn rational_numbers(system: &System, bits: u32, out: &mut Expressions) -> Option<Imported> {
    let from = &system.expressions;
    let of_sets = system.degenerate.values().flat_map(DegenerateSet::nodes);
    let roots: Vec<NodeId> = system.equations.iter().chain(of_sets).copied().collect();
    let mut pool = ConstantPool::default();
    let mut numbers = Imported::new();
    for id in below(from, &roots) {
        if from.dependence(id) == Dependence::Constant && from.as_constant(id).is_none() {
            let constant = pool.describe(from, id);
            let number = pool.insert(constant);
            // The simplest number near it is sought among more digits than it needs.
            let precise = pool.round::<MultiplePrecision>(number, 2 * bits);
            let part = |part: &MultiplePrecision| Some(simplest(&part.0.to_rational()?, bits));
            let near = ComplexRational::new(part(&precise.re)?, part(&precise.im)?);
            numbers.insert(id, out.constant(near));
        }
        if let Node::Divide(_, b) = from.node(id) {
            let number = numbers.get(b).and_then(|&number| out.as_constant(number));
            if number.is_some_and(ComplexRational::is_zero) {
                return None;
            }
        }
    }
    Some(numbers)
}

/// The convergent of the continued fraction of a number that is the first within 2^-`bits` of it.
fn simplest(number: &Rational, bits: u32) -> Rational {
    let tolerance = Rational::from(number.abs_ref()) >> bits;
    let (mut above, mut last) = (
        [Integer::from(1), Integer::from(0)],
        [Integer::from(0), Integer::from(1)],
    );
    let mut rest = number.clone();
    loop {
        let whole = Integer::from(rest.floor_ref());
        let next = [
            Integer::from(&whole * &above[0]) + &last[0],
            Integer::from(&whole * &above[1]) + &last[1],
        ];
        last = std::mem::replace(&mut above, next);
        let convergent = Rational::from((above[0].clone(), above[1].clone()));
        let difference = Rational::from(&convergent - number).abs();
        rest -= whole;
        if difference <= tolerance || rest == 0 {
            return convergent;
        }
        rest.recip_mut();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::exact;
    use crate::formats::plain;

    #[test]
    fn numbers_are_the_simplest_near_ones() {
        let number = |numerator: u64, denominator: u64| Rational::from((numerator, denominator));
        // pi to 20 digits: its convergents are 3, 22/7, 333/106, 355/113.
        let pi = Rational::from((
            "31415926535897932385".parse::<Integer>().unwrap(),
            Integer::from(Integer::u_pow_u(10, 19)),
        ));
        assert_eq!(simplest(&pi, 8), number(22, 7));
        assert_eq!(simplest(&pi, 20), number(355, 113));
        assert_eq!(simplest(&number(3, 4), 40), number(3, 4));
        assert_eq!(simplest(&-number(7, 2), 40), -number(7, 2));
        assert_eq!(simplest(&Rational::new(), 40), 0);
    }

    #[test]
    fn constants_become_rational_and_hardly_change() {
        let text = "10^(-6.3)*x + y/pi = cbrt(5)\nx/(y + sqrt(2)) = 1";
        let given = plain::typed("-e", text).expect("plain equations").system;
        let near = rational_constants(&given, 128).expect("no parameters");
        let nodes = below(&near.expressions, &near.equations);
        let is_rational = |id: &NodeId| {
            !matches!(
                near.expressions.node(*id),
                Node::Root(..) | Node::Function(..)
            )
        };
        assert!(nodes.iter().all(is_rational));
        // The constant term of the first equation is the cube root of 5.
        let zero = vec![ComplexRational::default(); 2];
        let root = exact::value(&near.expressions, near.equations[0], &zero, &[]);
        let root = root.expect("rational").re;
        let cube = Rational::from(&root * &root) * &root;
        let error = (cube.abs() - 5u32).to_f64().abs();
        assert!(error > 0.0 && error < 1e-36, "{error:e}");
    }

    #[test]
    fn roots_of_parameters_stay() {
        let text = "parameters: p\nx^2 = p/sqrt(2)\nx + y = 1";
        let given = plain::typed("-e", text).expect("plain equations").system;
        let near = rational_constants(&given, 64).expect("only a number is replaced");
        assert_eq!(near.parameters, given.parameters);
    }
}
