//! Deflation: equations that are regular, or at least less multiple, at a multiple solution of others.

use crate::expression::differentiate::directional;
use crate::expression::{Expressions, Node, NodeId};
use cognate_numeric::random::RandomStream;
use cognate_numeric::rational::ComplexRational;

/// Adds F'(x) B l = 0 and h l = 1 to F(x) = 0, in the unknowns x and `rank + 1` multipliers l, with
/// a random matrix B and a random row h (Leykin, Verschelde, Zhao: Newton's method with
/// deflation for isolated singularities of polynomial systems, Theor. Comput. Sci. 359, 2006).
///
/// Where F' has this rank at an isolated solution x, there is exactly one l to it, and (x, l) is
/// less multiple a solution; fewer deflations than the multiplicity make it regular. Derivatives
/// are taken by the variables `unknowns`; the multipliers are the variables from `first` on.
/// All of it exact. Returns all equations, those of `equations` first.
pub fn deflate(
    expressions: &mut Expressions,
    equations: &[NodeId],
    unknowns: &[usize],
    first: usize,
    rank: usize,
    random: &mut RandomStream,
) -> Vec<NodeId> {
    let index = |v: usize| u32::try_from(v).expect("variables are counted in 32 bits");
    let multipliers: Vec<NodeId> = (0..=rank)
        .map(|k| expressions.variable(index(first + k)))
        .collect();
    let mut form = |e: &mut Expressions| {
        let zero = e.integer(0);
        multipliers.iter().fold(zero, |sum, &multiplier| {
            let weight = e.constant(unit(random));
            let term = e.multiply(weight, multiplier);
            e.add(sum, term)
        })
    };
    let direction: Vec<NodeId> = unknowns.iter().map(|_| form(expressions)).collect();
    let scale = form(expressions);
    let slopes = directional(expressions, equations, &mut |_, leaf| match leaf {
        Node::Variable(v) => {
            let place = unknowns.iter().position(|&u| u == *v as usize);
            place.map(|place| direction[place])
        }
        _ => None,
    });
    let one = expressions.integer(1);
    let scaled = expressions.subtract(scale, one);
    let mut deflated_equations = equations.to_vec();
    deflated_equations.extend(slopes.into_iter().flatten());
    deflated_equations.push(scaled);
    deflated_equations
}

/// A random number of modulus between 1/2 and 3/2, exact in few bits.
fn unit(random: &mut RandomStream) -> ComplexRational {
    loop {
        let part = |random: &mut RandomStream| random.below(1 << 17) as i64 - (1 << 16);
        let (re, im) = (part(random), part(random));
        let square = re * re + im * im;
        if (1 << 30..=9 << 30).contains(&square) {
            return ComplexRational::new((re, 1 << 16), (im, 1 << 16));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::random::Purpose;

    #[test]
    fn a_double_root_becomes_regular() {
        // x^2 = 0 has rank 0 at 0: one multiplier, 2 x b l = 0 and h l = 1.
        let mut e = Expressions::new();
        let x = e.variable(0);
        let square = e.power(x, 2);
        let mut random = RandomStream::new(1, Purpose::Test, 0);
        let deflated_equations = deflate(&mut e, &[square], &[0], 1, 0, &mut random);
        assert_eq!(deflated_equations.len(), 3);
        assert_eq!(deflated_equations[0], square);
        let slope = directional(&mut e, &deflated_equations[1..2], &mut |e, leaf| {
            matches!(leaf, Node::Variable(0)).then(|| e.integer(1))
        });
        assert!(slope[0].is_some(), "it moves with x, at 0 too");
    }
}
