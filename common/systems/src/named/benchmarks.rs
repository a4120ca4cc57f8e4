//! Families of any size: cyclic, katsura, noon, eco, reimer.

use super::{Draft, Named, numbered};

/// Cyclic n-roots: elementary cyclic sums of n variables, the last equal to 1.
///
/// G. Björck, R. Fröberg, A faster way to count the solutions of inhomogeneous
/// systems of algebraic equations, with applications to cyclic n-roots, J.
/// Symbolic Computation 12 (1991). For n prime there are binomial(2n-2, n-1)
/// solutions (U. Haagerup, Cyclic p-roots of prime lengths p and related
/// complex Hadamard matrices, arXiv:0803.2629); 156 for n = 6, 34,940 for
/// n = 10. Where a square divides n there are curves of solutions.
pub fn cyclic(n: usize) -> Named {
    let mut d = Draft::new(numbered("x", 1, n));
    for length in 1..n {
        let terms: Vec<_> = (0..n)
            .map(|first| {
                let factors: Vec<usize> = (0..length).map(|k| (first + k) % n).collect();
                d.term(1, &factors)
            })
            .collect();
        d.equate(&terms);
    }
    let full_product = d.term(1, &(0..n).collect::<Vec<_>>());
    let minus_one = d.e.integer(-1);
    d.equate(&[full_product, minus_one]);
    let count = match n {
        2 => Some(2),
        3 => Some(6),
        5 => Some(70),
        6 => Some(156),
        7 => Some(924),
        10 => Some(34_940),
        11 => Some(184_756),
        13 => Some(2_704_156),
        _ => None,
    };
    d.finish(count, count, "Björck and Fröberg 1991; Haagerup 2008")
}

/// Katsura's magnetism equations in u0..un: 2^n solutions.
///
/// S. Katsura, Spin glass problem by the method of integral equation of the
/// effective field, in: New Trends in Magnetism (1990); count: PoSSo test
/// suite (total degree, nothing at infinity).
pub fn katsura(n: usize) -> Named {
    let mut d = Draft::new(numbered("u", 0, n));
    let bound = n as i64;
    for m in 0..bound {
        // Each product of two different unknowns occurs twice; once with factor 2.
        let mut coefficients = std::collections::BTreeMap::new();
        for l in -bound..=bound {
            let (i, j) = (l.unsigned_abs() as usize, (m - l).unsigned_abs() as usize);
            if j <= n {
                *coefficients.entry((i.min(j), i.max(j))).or_insert(0) += 1;
            }
        }
        let mut terms: Vec<_> = coefficients
            .into_iter()
            .map(|((i, j), c)| d.term(c, &[i, j]))
            .collect();
        terms.push(d.term(-1, &[m as usize]));
        d.equate(&terms);
    }
    let mut terms = vec![d.x[0]];
    for i in 1..=n {
        terms.push(d.term(2, &[i]));
    }
    terms.push(d.e.integer(-1));
    d.equate(&terms);
    let count = u32::try_from(n).ok().and_then(|n| 2u64.checked_pow(n));
    d.finish(count, count, "Katsura 1990; PoSSo test suite")
}

/// Noonburg's neural network: 3^n - 2n solutions for n of at least 3.
///
/// V. W. Noonburg, A neural network modeled by an adaptive Lotka-Volterra
/// system, SIAM J. Appl. Math. 49 (1989); count: PoSSo test suite (21, 73, 233
/// for n = 3, 4, 5).
pub fn noon(n: usize) -> Named {
    let mut d = Draft::new(numbered("x", 1, n));
    for i in 0..n {
        let mut squares = Vec::new();
        for j in (0..n).filter(|&j| j != i) {
            let square = d.e.power(d.x[j], 2);
            squares.push(square);
        }
        let squares = d.sum(&squares);
        let cubic = d.e.multiply(d.x[i], squares);
        let coefficient = d.number(-11, 10);
        let linear = d.e.multiply(coefficient, d.x[i]);
        let one = d.e.integer(1);
        d.equate(&[cubic, linear, one]);
    }
    let count = u32::try_from(n)
        .ok()
        .filter(|&n| n >= 3)
        .and_then(|n| Some(3u64.checked_pow(n)? - 2 * u64::from(n)));
    d.finish(count, count, "Noonburg 1989; PoSSo test suite")
}

/// Morgan's economics model: 2^(n-2) solutions.
///
/// A. Morgan, Solving Polynomial Systems Using Continuation for Engineering
/// and Scientific Problems (1987), page 148.
pub fn eco(n: usize) -> Named {
    let mut d = Draft::new(numbered("x", 1, n));
    for k in 1..n {
        let mut terms = vec![d.x[k - 1]];
        for i in 1..n - k {
            let term = d.term(1, &[i - 1, i + k - 1]);
            terms.push(term);
        }
        let sum = d.sum(&terms);
        let product = d.e.multiply(sum, d.x[n - 1]);
        let right = d.e.integer(-(k as i64));
        d.equate(&[product, right]);
    }
    let mut terms = d.x[..n - 1].to_vec();
    terms.push(d.e.integer(1));
    d.equate(&terms);
    let count = u32::try_from(n)
        .ok()
        .filter(|&n| n >= 3)
        .and_then(|n| 2u64.checked_pow(n - 2));
    d.finish(count, count, "Morgan 1987")
}

/// Reimer's alternating power sums: of the (n+1)! of the total degree only a
/// part is finite.
///
/// PoSSo test suite, and J. Verschelde's database of polynomial systems (36
/// and 144 solutions for n = 4 and 5); 4 and 12 for n = 2 and 3 were found with PHCpack.
pub fn reimer(n: usize) -> Named {
    let mut d = Draft::new(numbered("x", 1, n));
    for k in 1..=n as u32 {
        let mut terms = Vec::new();
        for i in 0..n {
            let power = d.e.power(d.x[i], k + 1);
            let sign = d.e.integer(if i % 2 == 0 { 2 } else { -2 });
            let term = d.e.multiply(sign, power);
            terms.push(term);
        }
        terms.push(d.e.integer(-1));
        d.equate(&terms);
    }
    let count = match n {
        2 => Some(4),
        3 => Some(12),
        4 => Some(36),
        5 => Some(144),
        _ => None,
    };
    d.finish(count, count, "PoSSo test suite; Verschelde's database")
}
