//! The naive evaluator: one assignment after the other, one value for each, every rounding spelt out.
//!
//! It shares differentiation and fusion with the interpreter (they decide the
//! rounding) and nothing after that: no schedule, no slots, no runs, none of
//! the complex arithmetic. The interpreter must agree with it bit for bit.

use super::{Evaluate, Shape};
use crate::expression::{Expressions, NodeId};
use crate::straight_line_program::assignments::Assignments;
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
    /// All constants, rounded.
    type Scratch = Vec<Complex<R>>;

    fn shape(&self) -> Shape {
        self.0.shape
    }

    fn scratch(&self, context: R::Context) -> Vec<Complex<R>> {
        let count = self.0.pool.constants().len() as u32;
        (0..count)
            .map(|constant| self.0.pool.round(constant, context))
            .collect()
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

    fn jacobian(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut Matrix<R>,
        s: &mut Vec<Complex<R>>,
    ) {
        evaluate(&self.0.jacobian(), x, p, &[], s, &mut out.entries);
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
            .operands
            .iter()
            .map(|operand| match *operand {
                Operand::Variable(v) => x[v as usize].clone(),
                Operand::Parameter(q) => p[q as usize].clone(),
                Operand::Direction(q) => dp[q as usize].clone(),
                Operand::Constant(c) | Operand::Single(c) => constants[c as usize].clone(),
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

fn minus<R: Real>(a: &Complex<R>) -> Complex<R> {
    Complex {
        re: negative(&a.re),
        im: negative(&a.im),
    }
}

/// `a*b`, the product of the imaginary part of a rounded first.
fn multiply<R: Real>(a: &Complex<R>, b: &Complex<R>) -> Complex<R> {
    Complex {
        re: fused(&a.re, &b.re, &negative(&product(&a.im, &b.im))),
        im: fused(&a.re, &b.im, &product(&a.im, &b.re)),
    }
}

/// `c + a*b`, the real part of a first.
fn add_product<R: Real>(c: &Complex<R>, a: &Complex<R>, b: &Complex<R>) -> Complex<R> {
    Complex {
        re: fused(&negative(&a.im), &b.im, &fused(&a.re, &b.re, &c.re)),
        im: fused(&a.im, &b.re, &fused(&a.re, &b.im, &c.im)),
    }
}

fn apply<R: Real>(operation: Operation, operands: &[Complex<R>]) -> Complex<R> {
    match (operation, operands) {
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
        (Operation::Sum(terms), _) => {
            let mut rest = operands.iter();
            let mut next = || rest.next().expect("a sum has all its operands");
            let mut total: Option<Complex<R>> = None;
            for _ in 0..terms.plus {
                let a = next();
                total = Some(match total {
                    None => a.clone(),
                    Some(t) => Complex {
                        re: sum(&t.re, &a.re),
                        im: sum(&t.im, &a.im),
                    },
                });
            }
            for _ in 0..terms.minus {
                let a = minus(next());
                total = Some(match total {
                    None => a,
                    Some(t) => Complex {
                        re: sum(&t.re, &a.re),
                        im: sum(&t.im, &a.im),
                    },
                });
            }
            for _ in 0..terms.scaled {
                let (r, a) = (&next().re, next());
                total = Some(match total {
                    None => Complex {
                        re: product(r, &a.re),
                        im: product(r, &a.im),
                    },
                    Some(t) => Complex {
                        re: fused(r, &a.re, &t.re),
                        im: fused(r, &a.im, &t.im),
                    },
                });
            }
            for _ in 0..u32::from(terms.turned) + u32::from(terms.products) {
                let (a, b) = (next(), next());
                total = Some(match total {
                    None => multiply(a, b),
                    Some(t) => add_product(&t, a, b),
                });
            }
            for _ in 0..terms.negatives {
                let (a, b) = (next(), next());
                total = Some(match total {
                    None => minus(&multiply(a, b)),
                    Some(t) => add_product(&t, &minus(a), b),
                });
            }
            total.expect("a sum has a term")
        }
        _ => unreachable!("a square and a reciprocal have one operand"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::conformance::check_exactly;
    use crate::straight_line_program::assignments::WAYS;

    /// Compiles in one way alone, at any cost.
    fn way<const W: usize>(
        expressions: &Expressions,
        equations: &[NodeId],
        variables: usize,
        parameters: usize,
    ) -> Reference {
        let ways = &WAYS[W..=W];
        Reference(Assignments::compile_as(
            expressions,
            equations,
            variables,
            parameters,
            ways,
        ))
    }

    #[test]
    fn every_way_to_derive_a_program_is_exact() {
        const { assert!(WAYS.len() == 8) };
        check_exactly(way::<0>);
        check_exactly(way::<1>);
        check_exactly(way::<2>);
        check_exactly(way::<3>);
        check_exactly(way::<4>);
        check_exactly(way::<5>);
        check_exactly(way::<6>);
        check_exactly(way::<7>);
    }
}
