//! From a system's assignments to a routine: every operation as the interpreter does it.

use crate::routine::{DIRECTIONS, OUTPUT, PARAMETERS, Pair, Routine, Sum, VARIABLES};
use cognate_numeric::scalar::Complex;
use cognate_systems::straight_line_program::instruction::{Assignment, Operand, Operation, Terms};

/// Constants as the assignments number them, in doubles.
pub(crate) struct Constants {
    /// Constants that fill all lanes.
    pub full: Vec<Complex<f64>>,
    /// Constants that stand once.
    pub single: Vec<Complex<f64>>,
}

/// The routine that computes the assignments and writes their outputs.
pub(crate) fn lower(assignments: &[Assignment], constants: &Constants) -> Routine {
    let mut routine = Routine::default();
    let r = &mut routine;
    let mut results: Vec<Option<Pair>> = vec![None; assignments.len()];
    for (number, assignment) in assignments.iter().enumerate() {
        let pairs: Vec<Pair> = assignment
            .operands
            .iter()
            .map(|operand| match *operand {
                Operand::Variable(v) => r.number(VARIABLES, v),
                Operand::Parameter(p) => r.number(PARAMETERS, p),
                Operand::Direction(p) => r.number(DIRECTIONS, p),
                Operand::Constant(c) => constant(r, &constants.full[c as usize]),
                Operand::Single(c) => constant(r, &constants.single[c as usize]),
                Operand::Value(v) => {
                    results[v as usize].expect("operands are computed before they are used")
                }
            })
            .collect();
        let result = match assignment.operation {
            Operation::Square => r.square(pairs[0]),
            Operation::Inverse => r.inverse(pairs[0]),
            Operation::Sum(terms) => sum(r, terms, &pairs),
        };
        match assignment.output {
            Some(entry) => r.store(result, OUTPUT, entry),
            None => results[number] = Some(result),
        }
    }
    routine
}

fn constant(r: &mut Routine, c: &Complex<f64>) -> Pair {
    Pair {
        re: r.constant(c.re),
        im: r.constant(c.im),
    }
}

/// One sum; see [`Terms`] for the order.
fn sum(r: &mut Routine, terms: Terms, operands: &[Pair]) -> Pair {
    let (plus, rest) = operands.split_at(usize::from(terms.plus));
    let (minus, rest) = rest.split_at(usize::from(terms.minus));
    let (scaled, rest) = rest.split_at(2 * usize::from(terms.scaled));
    let (turned, rest) = rest.split_at(2 * usize::from(terms.turned));
    let (products, negatives) = rest.split_at(2 * usize::from(terms.products));
    let mut sum: Option<Sum> = None;
    for &a in plus {
        match &mut sum {
            Some(sum) => sum.add(r, a),
            None => sum = Some(Sum::new(a, false)),
        }
    }
    for &a in minus {
        match &mut sum {
            Some(sum) => sum.subtract(r, a),
            None => sum = Some(Sum::new(a, true)),
        }
    }
    for pair in scaled.chunks_exact(2) {
        let (c, a) = (pair[0].re, pair[1]);
        match &mut sum {
            Some(sum) => sum.add_multiple(r, c, a),
            None => {
                let first = Pair {
                    re: r.binary(crate::routine::Operation::Multiply, a.re, c),
                    im: r.binary(crate::routine::Operation::Multiply, a.im, c),
                };
                sum = Some(Sum::new(first, false));
            }
        }
    }
    for pair in turned.chunks_exact(2) {
        match &mut sum {
            Some(sum) => sum.add_product(r, pair[0], pair[1], false),
            None => sum = Some(Sum::new(r.turned(pair[0], pair[1]), false)),
        }
    }
    for (factors, negative) in [(products, false), (negatives, true)] {
        for pair in factors.chunks_exact(2) {
            match &mut sum {
                Some(sum) => sum.add_product(r, pair[0], pair[1], negative),
                None => sum = Some(Sum::new(r.product(pair[0], pair[1]), negative)),
            }
        }
    }
    sum.expect("a sum has a term").finish(r)
}
