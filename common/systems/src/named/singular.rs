//! Systems with multiple solutions, and one with a curve of them.

use super::{Draft, Named};

/// Caprasse's system: 56 solutions with multiplicity, 24 of them simple and 8
/// fourfold.
///
/// PoSSo test suite; multiplicities: J. Verschelde's database of polynomial systems.
pub fn caprasse() -> Named {
    let mut d = Draft::new(["x", "y", "z", "t"].map(String::from));
    let (x, y, z, t) = (0, 1, 2, 3);
    let equations: [&[(i64, &[usize])]; 4] = [
        &[(1, &[y, y, z]), (2, &[x, y, t]), (-2, &[x]), (-1, &[z])],
        &[
            (-1, &[x, x, x, z]),
            (4, &[x, y, y, z]),
            (4, &[x, x, y, t]),
            (2, &[y, y, y, t]),
            (4, &[x, x]),
            (-10, &[y, y]),
            (4, &[x, z]),
            (-10, &[y, t]),
            (2, &[]),
        ],
        &[(2, &[y, z, t]), (1, &[x, t, t]), (-1, &[x]), (-2, &[z])],
        &[
            (-1, &[x, z, z, z]),
            (4, &[y, z, z, t]),
            (4, &[x, z, t, t]),
            (2, &[y, t, t, t]),
            (4, &[x, z]),
            (4, &[z, z]),
            (-10, &[y, t]),
            (-10, &[t, t]),
            (2, &[]),
        ],
    ];
    for equation in equations {
        let terms: Vec<_> = equation.iter().map(|(c, v)| d.term(*c, v)).collect();
        d.equate(&terms);
    }
    d.finish(
        Some(32),
        Some(56),
        "PoSSo test suite; Verschelde's database",
    )
}

/// A system with one triple root, at the origin, from which Newton's method diverges.
///
/// A. Griewank, M. R. Osborne, Analysis of Newton's method at irregular
/// singularities, SIAM J. Numer. Anal. 20 (1983).
pub fn griewank_osborne() -> Named {
    let mut d = Draft::new(["x", "y"].map(String::from));
    let coefficient = d.number(29, 16);
    let cube = d.e.power(d.x[0], 3);
    let cubic = d.e.multiply(coefficient, cube);
    let mixed = d.term(-2, &[0, 1]);
    d.equate(&[cubic, mixed]);
    let square = d.e.power(d.x[0], 2);
    let minus = d.e.negate(square);
    d.equate(&[d.x[1], minus]);
    d.finish(Some(1), Some(3), "Griewank and Osborne 1983")
}

/// `x_i^2 + (x_1 + ... + x_n) - 2 x_i - (n - 1) = 0`: a solution of multiplicity 2^(n-1) at
/// (1, ..., 1), where the Jacobian has rank 1, and 2^(n-1) simple ones for odd n, a point for each
/// choice of signs of x_i - 1 but one of every two.
///
/// H. Kobayashi, H. Suzuki, Y. Sakai, Numerical calculation of the multiplicity of a solution to
/// algebraic equations, Math. Comp. 67 (1998); n = 5 in Dayton and Zeng, Computing the
/// multiplicity structure in solving polynomial systems (ISSAC 2005).
pub fn kss(n: usize) -> Named {
    let mut d = Draft::new(super::numbered("x", 1, n));
    for i in 0..n {
        let mut terms = vec![d.term(1, &[i, i])];
        terms.extend((0..n).map(|j| d.term(1, &[j])));
        terms.push(d.term(-2, &[i]));
        let constant = i64::try_from(n).expect("a system has fewer than 2^63 variables") - 1;
        terms.push(d.e.integer(-constant));
        d.equate(&terms);
    }
    let (finite, multiple) = if n == 5 {
        (Some(17), Some(32))
    } else {
        (None, None)
    };
    d.finish(finite, multiple, "Kobayashi, Suzuki, Sakai 1998")
}

/// A solution of multiplicity 3 at (1, 2) and a simple one at (-3, -6).
///
/// T. Ojika, Modified deflation algorithm for the solution of singular problems, J. Math. Anal.
/// Appl. 123 (1987), example 1.
pub fn ojika_1() -> Named {
    let mut d = Draft::new(["x", "y"].map(String::from));
    let first = [d.term(1, &[0, 0]), d.term(1, &[1]), d.e.integer(-3)];
    d.equate(&first);
    let eighth = d.number(1, 8);
    let square = d.term(1, &[1, 1]);
    let second = [
        d.term(1, &[0]),
        d.e.multiply(eighth, square),
        d.number(-3, 2),
    ];
    d.equate(&second);
    d.finish(Some(2), Some(4), "Ojika 1987")
}

/// xy = xz = 0, yz = 1: the hyperbola yz = 1 in the plane x = 0, and no isolated point.
///
/// The curve by hand: yz = 1 makes y a unit, so that x = 0.
pub fn hyperbola_in_a_plane() -> Named {
    let mut d = Draft::new(["x", "y", "z"].map(String::from));
    for factors in [[0, 1], [0, 2]] {
        let product = d.term(1, &factors);
        d.equate(&[product]);
    }
    let last = [d.term(1, &[1, 2]), d.e.integer(-1)];
    d.equate(&last);
    d.finish(Some(0), Some(0), "by hand")
}
