//! Systems with multiple solutions: caprasse, Griewank and Osborne.

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

/// One triple root, at the origin, from which Newton's method diverges.
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
