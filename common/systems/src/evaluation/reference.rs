//! The naive evaluator: one assignment after the other, one value for each, every rounding spelt out.
//!
//! It shares differentiation and fusion with the interpreter (they decide the
//! rounding) and nothing after that: no schedule, no slots, no runs, none of
//! the complex arithmetic. The interpreter must agree with it bit for bit.

use super::interpreter::Assignments;
use super::{Evaluate, Shape};
use crate::expression::{Expressions, NodeId};
use crate::straight_line_program::instruction::{Assignment, Operand, Operation};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Real};

/// A system evaluated the slow way, for tests.
pub struct Reference(Assignments);

impl Reference {
    /// Takes the equations as [`super::Interpreter::compile`] does.
    pub fn compile(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
    ) -> Self {
        Self(Assignments::compile(
            expressions,
            equations,
            variables,
            parameters,
        ))
    }
}

impl<R: Real> Evaluate<R> for Reference {
    /// The constants, rounded.
    type Scratch = Vec<Complex<R>>;

    fn shape(&self) -> Shape {
        self.0.shape
    }

    fn scratch(&self, context: R::Context) -> Vec<Complex<R>> {
        self.0.constants.round(context)
    }

    fn linearize(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        dp: &[Complex<R>],
        out: &mut Matrix<R>,
        s: &mut Vec<Complex<R>>,
    ) {
        evaluate(&self.0.linearize, x, p, dp, s, &mut out.entries);
    }

    fn value(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut [Complex<R>],
        s: &mut Vec<Complex<R>>,
    ) {
        evaluate(&self.0.value, x, p, &[], s, out);
    }
}

fn evaluate<R: Real>(
    assignments: &[Assignment],
    x: &[Complex<R>],
    p: &[Complex<R>],
    dp: &[Complex<R>],
    constants: &[Complex<R>],
    out: &mut [Complex<R>],
) {
    let mut values: Vec<Complex<R>> = Vec::with_capacity(assignments.len());
    for assignment in assignments {
        let operands: Vec<Complex<R>> = assignment
            .used()
            .iter()
            .map(|operand| match *operand {
                Operand::Variable(v) => x[v as usize].clone(),
                Operand::Parameter(q) => p[q as usize].clone(),
                Operand::Direction(q) => dp[q as usize].clone(),
                Operand::Constant(c) => constants[c as usize].clone(),
                Operand::Value(v) => values[v as usize].clone(),
            })
            .collect();
        let value = apply(assignment.operation, &operands);
        if let Some(entry) = assignment.output {
            out[entry as usize] = value.clone();
        }
        values.push(value);
    }
}

fn negative<R: Real>(a: &R) -> R {
    let mut r = a.clone();
    r.neg();
    r
}

fn sum<R: Real>(a: &R, b: &R) -> R {
    let mut r = a.clone();
    r.add(b);
    r
}

fn product<R: Real>(a: &R, b: &R) -> R {
    let mut r = a.clone();
    r.mul(b);
    r
}

/// `a*b + c`, rounded once.
fn fused<R: Real>(a: &R, b: &R, c: &R) -> R {
    let mut r = c.clone();
    r.mul_add(a, b);
    r
}

/// `c + a*b`: real parts first, then imaginary ones.
fn add_product<R: Real>(c: &Complex<R>, a: &Complex<R>, b: &Complex<R>) -> Complex<R> {
    Complex {
        re: fused(&negative(&a.im), &b.im, &fused(&a.re, &b.re, &c.re)),
        im: fused(&a.im, &b.re, &fused(&a.re, &b.im, &c.im)),
    }
}

fn apply<R: Real>(operation: Operation, operands: &[Complex<R>]) -> Complex<R> {
    let each = |f: &dyn Fn(&R) -> R, a: &Complex<R>| Complex {
        re: f(&a.re),
        im: f(&a.im),
    };
    let multiply = |a: &Complex<R>, b: &Complex<R>| Complex {
        re: fused(&a.re, &b.re, &negative(&product(&a.im, &b.im))),
        im: fused(&a.re, &b.im, &product(&a.im, &b.re)),
    };
    let minus = |a: &Complex<R>| each(&negative, a);
    match (operation, operands) {
        (Operation::Copy, [a]) => a.clone(),
        (Operation::Negate, [a]) => minus(a),
        (Operation::Square, [a]) => Complex {
            re: fused(&a.re, &a.re, &negative(&product(&a.im, &a.im))),
            im: product(&sum(&a.re, &a.re), &a.im),
        },
        (Operation::Inverse, [a]) => {
            let modulus = fused(&a.im, &a.im, &product(&a.re, &a.re));
            let mut inverse = a.clone();
            inverse.re.div(&modulus);
            inverse.im = negative(&inverse.im);
            inverse.im.div(&modulus);
            inverse
        }
        (Operation::Add, [a, b]) => Complex {
            re: sum(&a.re, &b.re),
            im: sum(&a.im, &b.im),
        },
        (Operation::Subtract, [a, b]) => Complex {
            re: sum(&a.re, &negative(&b.re)),
            im: sum(&a.im, &negative(&b.im)),
        },
        (Operation::Multiply, [a, b]) => multiply(a, b),
        (Operation::Scale, [a, b]) => each(&|x| product(&a.re, x), b),
        (Operation::MultiplyAdd, [a, b, c]) => add_product(c, a, b),
        (Operation::MultiplySubtract, [a, b, c]) => add_product(&minus(c), a, b),
        (Operation::SubtractProduct, [a, b, c]) => add_product(c, &minus(a), b),
        (Operation::ScaleAdd, [a, b, c]) => Complex {
            re: fused(&a.re, &b.re, &c.re),
            im: fused(&a.re, &b.im, &c.im),
        },
        (Operation::ScaleSubtract, [a, b, c]) => Complex {
            re: fused(&a.re, &b.re, &negative(&c.re)),
            im: fused(&a.re, &b.im, &negative(&c.im)),
        },
        (Operation::SubtractScaled, [a, b, c]) => Complex {
            re: fused(&negative(&a.re), &b.re, &c.re),
            im: fused(&negative(&a.re), &b.im, &c.im),
        },
        (Operation::ProductSum, [a, b, c, d]) => add_product(&multiply(c, d), a, b),
        (Operation::ProductDifference, [a, b, c, d]) => add_product(&multiply(a, b), &minus(c), d),
        _ => unreachable!("an assignment has as many operands as its operation"),
    }
}
