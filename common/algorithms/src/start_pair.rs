//! Start pair: a point and parameters at which it solves the system, for a system that is linear
//! in its parameters.
//!
//! The point is random; the parameters are those nearest to random ones that
//! make it a solution: so the pair is generic on the set of all pairs.

use cognate_numeric::counted::counted;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Complex;
use cognate_systems::evaluation::{Evaluate, Interpreter};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Reason why there is no start pair.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StartPairError {
    /// Some parameter stands in a product with another, or in a power.
    #[error("the system is not linear in its parameters")]
    NotLinear,
    /// No parameters make a random point a solution.
    #[error(
        "no parameters make a random point a solution: {} and {} that cannot move all of them freely",
        counted(*.equations, "equation"),
        counted(*.parameters, "parameter")
    )]
    NotFree {
        /// Number of equations.
        equations: usize,
        /// Number of parameters.
        parameters: usize,
    },
}

/// Largest residual of a start pair, relative to the terms that cancel.
const RESIDUAL: f64 = 1e-12;
/// Largest second difference in the parameters that is rounding.
const LINEAR: f64 = 1e-10;

/// Values of F at one point, for any parameters.
struct Values {
    program: Interpreter,
    x: Vec<Complex<f64>>,
    equations: usize,
}

fn native(z: &Complex64) -> Complex<f64> {
    Complex { re: z.re, im: z.im }
}

impl Values {
    fn at(&self, p: &[Complex64]) -> Vec<Complex64> {
        let mut scratch = Evaluate::<f64>::scratch(&self.program, ());
        let p: Vec<_> = p.iter().map(native).collect();
        let mut out = vec![Complex { re: 0.0, im: 0.0 }; self.equations];
        self.program.value(&self.x, &p, &mut out, &mut scratch);
        out.iter().map(|z| Complex64::new(z.re, z.im)).collect()
    }
}

fn largest(values: &[Complex64]) -> f64 {
    values
        .iter()
        .map(|z| z.norm_sqr())
        .fold(0.0, f64::max)
        .sqrt()
}

fn sum(a: &[Complex64], b: &[Complex64]) -> Vec<Complex64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// Values of the variables, then of the parameters.
pub fn start_pair(
    system: &System,
    seed: u64,
) -> Result<(Vec<Complex64>, Vec<Complex64>), StartPairError> {
    let scaling = &system.scaling;
    let system = &*system.in_unknowns();
    let (equations, count) = (system.equation_count(), system.parameters.len());
    let not_free = StartPairError::NotFree {
        equations,
        parameters: count,
    };
    let mut random = RandomStream::new(seed, Purpose::StartSystem, u64::MAX);
    let x: Vec<Complex64> = (0..system.variable_count())
        .map(|_| random.unit())
        .collect();
    let values = Values {
        program: Interpreter::compile(&system.expressions, &system.equations, x.len(), count),
        x: x.iter().map(native).collect(),
        equations,
    };
    let mut p: Vec<Complex64> = (0..count).map(|_| random.disc()).collect();
    let q: Vec<Complex64> = (0..count).map(|_| random.disc()).collect();

    // F(p + q) - F(p) - F(q) + F(0) = 0 for every p and q says that F is linear in p.
    let zero = values.at(&vec![Complex64::default(); count]);
    let terms = [values.at(&sum(&p, &q)), values.at(&p), values.at(&q), zero];
    for k in 0..equations {
        let [both, one, other, none] = [0, 1, 2, 3].map(|t| terms[t][k]);
        let size = largest(&[both, one, other, none]);
        if largest(&[both - one - other + none]) > LINEAR * size {
            return Err(StartPairError::NotLinear);
        }
    }

    let origin = &terms[3];
    let columns: Vec<Vec<Complex64>> = (0..count)
        .map(|k| {
            let mut unit = vec![Complex64::default(); count];
            unit[k] = Complex64::new(1.0, 0.0);
            let moved = values.at(&unit);
            moved.iter().zip(origin).map(|(m, o)| m - o).collect()
        })
        .collect();
    // The shortest way to the solutions: A* (A A*)^-1 (-F), again for what rounding left.
    for _ in 0..3 {
        let residual = values.at(&p);
        let mut matrix = Matrix::<f64>::zeros((), equations, equations + 1);
        for i in 0..equations {
            for j in 0..equations {
                let entry: Complex64 = columns.iter().map(|c| c[i] * c[j].conj()).sum();
                *matrix.at_mut(i, j) = native(&entry);
            }
            *matrix.at_mut(i, equations) = native(&-residual[i]);
        }
        eliminate::<f64, 1>(&mut matrix, &mut 0.0);
        let y: Vec<Complex64> = (0..equations)
            .map(|i| {
                let z = matrix.at(i, equations);
                Complex64::new(z.re, z.im)
            })
            .collect();
        for (p, column) in p.iter_mut().zip(&columns) {
            let step: Complex64 = column.iter().zip(&y).map(|(a, y)| a.conj() * y).sum();
            *p += step;
        }
    }
    let residual = values.at(&p);
    let solved = (0..equations).all(|i| {
        let terms = columns.iter().zip(&p).map(|(c, p)| c[i] * p);
        let terms: Vec<Complex64> = terms.chain([origin[i]]).collect();
        largest(&residual[i..=i]) <= RESIDUAL * largest(&terms)
    });
    let bounded = p.iter().all(|z| z.norm_sqr() < 1e12);
    if solved && bounded {
        Ok((scaling.to_variables(&x), p))
    } else {
        Err(not_free)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{declared, system};

    #[test]
    fn a_pair_solves_the_system() {
        let (x, p) = start_pair(&system(), 3).unwrap();
        let error = x[0] * x[0] * x[0] * x[0] - p[0];
        assert!(error.norm_sqr() < 1e-28, "{error}");
        let more = declared(
            "variable_group x, y; parameter p, q, r; function f, g;
             f = p*x^2 + q*y - 3; g = r*x*y + 2*p*y + 1;",
        );
        let (x, p) = start_pair(&more, 5).unwrap();
        let f = p[0] * x[0] * x[0] + p[1] * x[1] - 3.0;
        let g = p[2] * x[0] * x[1] + p[0] * x[1] * 2.0 + 1.0;
        assert!(f.norm_sqr().max(g.norm_sqr()) < 1e-26, "{f} {g}");
        assert_ne!(start_pair(&more, 6).unwrap().0, x);
    }

    #[test]
    fn what_is_not_linear_or_not_free_is_refused() {
        let square = declared("variable_group x; parameter p; function f; f = x^2 - p^2;");
        assert_eq!(start_pair(&square, 1), Err(StartPairError::NotLinear));
        let half =
            declared("variable_group x, y; parameter p; function f, g; f = x^2 - p; g = x*y - 1;");
        assert!(matches!(
            start_pair(&half, 1),
            Err(StartPairError::NotFree {
                equations: 2,
                parameters: 1
            })
        ));
    }
}
