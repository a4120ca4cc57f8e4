//! Combinations of equations for a cascade, where row i is general in the equations from i on, or for one dimension.
//!
//! Equations by descending degree, each row one of them plus random real multiples of all that
//! come after it. On the zeros of the rows before it, a row is general among all equations, so
//! that outside the solutions of all of them every set that the rows cut out is smooth (Bertini's
//! theorem; Hauenstein, Sommese, Wampler: Regenerative cascade homotopies, Appl. Math. Comput. 218,
//! 2011). Equations that `independent` finds come first and stay as they are.

use super::independent::independent;
use super::randomize::{coefficient, scaled};
use crate::expression::NodeId;
use crate::polynomial::Degrees;
use crate::system::System;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::ComplexRational;
use std::cmp::Reverse;

/// The first `count` rows of this form for a system in affine groups; all of them where it has fewer equations.
///
/// A pure function of its arguments. `degrees` are those of `system`.
///
/// # Panics
/// When `degrees` has another length, or a group is homogeneous.
pub fn combine(system: &System, degrees: &Degrees, count: usize, seed: u64) -> System {
    let whole = independent(system, degrees);
    rows(system, degrees, (count, seed), whole, |row, _| row + 1)
}

/// Combines all equations, so that none stays as it is: row i is general among all of them also on a set on which some
/// of them hold.
///
/// # Panics
/// When `degrees` has another length, or a group is homogeneous.
pub fn combine_all(system: &System, degrees: &Degrees, count: usize, seed: u64) -> System {
    rows(system, degrees, (count, seed), Vec::new(), |row, _| row + 1)
}

/// As many rows as cut out sets of one codimension, of few terms: each has one equation of those that are combined, and
/// random multiples of those only that no row begins with. With `keep` equations that `independent` finds stay as
/// they are; else those are combined, too, where that leaves over no others.
///
/// In row echelon form all general combinations of the equations look like this, so the rows cut out the same kind of
/// set as those of [`combine`], with fewer monomials. The rows of one `count` are not among those of another. A pure
/// function of its arguments.
///
/// # Panics
/// When `degrees` has another length, or a group is homogeneous.
pub fn combine_few(
    system: &System,
    degrees: &Degrees,
    count: usize,
    seed: u64,
    keep: bool,
) -> System {
    let mut whole = independent(system, degrees);
    // As many as would be left over may be combined with all others.
    let left_over = system.equation_count().saturating_sub(count);
    if !keep && (1..=whole.len()).contains(&left_over) {
        whole.clear();
    }
    rows(system, degrees, (count, seed), whole, |_, mixed| mixed)
}

/// The rows, `whole` ones first; `begin`: from which equation on others are added to one, by its row and by the number
/// of rows that are not whole.
fn rows(
    system: &System,
    degrees: &Degrees,
    (count, seed): (usize, u64),
    mut whole: Vec<usize>,
    begin: impl Fn(usize, usize) -> usize,
) -> System {
    let equations = system.equation_count();
    assert_eq!(degrees.total.len(), equations, "a degree for each equation");
    let affine = system.groups.iter().all(|group| !group.homogeneous);
    assert!(affine, "rows of several degrees are added as they are");
    whole.truncate(count);
    let mut order: Vec<usize> = (0..equations).filter(|i| !whole.contains(i)).collect();
    order.sort_by_key(|&i| (Reverse(degrees.total[i]), i));
    let mut result = System {
        equations: whole.iter().map(|&i| system.equations[i]).collect(),
        equation_names: Vec::new(),
        ..system.clone()
    };
    let out = &mut result.expressions;
    let scaled = scaled(system, out, seed);
    let mixed = count.min(equations) - whole.len();
    for row in 0..mixed {
        let mut random = RandomStream::new(seed, Purpose::Randomization, row as u64);
        let first: NodeId = scaled[order[row]];
        let others = &order[begin(row, mixed)..];
        let sum = others.iter().fold(first, |sum, &j| {
            let a = out.constant(ComplexRational::real(coefficient(&mut random)));
            let term = out.multiply(a, scaled[j]);
            out.add(sum, term)
        });
        result.equations.push(sum);
    }
    result.equation_names = (1..=result.equations.len())
        .map(|k| format!("combination {k}"))
        .collect();
    result
}

/// The system with each equation times a power of two, so that its values at points with coordinates of
/// modulus 1 are about 1.
pub fn equilibrate(system: &System, seed: u64) -> System {
    let mut result = system.clone();
    result.equations = scaled(system, &mut result.expressions, seed);
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial::degrees;

    #[test]
    fn rows_keep_the_degrees_and_what_is_linear_comes_first() {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y, z; function f1, f2, f3;\
                     f1 = x*y - 1; f2 = x^3 - y^2*z; f3 = z - 2;\nEND;\n";
        let problem = crate::formats::read("test", text);
        let system = problem.expect("a problem of this test").system;
        let system_degrees = degrees(&system).unwrap();
        let rows = combine(&system, &system_degrees, 3, 1);
        assert_eq!(degrees(&rows).unwrap().total, [1, 2, 3]);
        assert_eq!(rows.equations[0], system.equations[2]);
        assert_eq!(rows, combine(&system, &system_degrees, 3, 1));
        assert_eq!(
            combine(&system, &system_degrees, 2, 1).equations,
            rows.equations[..2]
        );
    }

    #[test]
    fn few_terms_are_those_of_one_equation_and_of_the_ones_left_over() {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y, z; function f1, f2, f3, f4;\
                     f1 = x*y - 1; f2 = x^3 - y^2*z; f3 = z - 2; f4 = x^2*z - 3;\nEND;\n";
        let problem = crate::formats::read("test", text);
        let system = problem.expect("a problem of this test").system;
        let system_degrees = degrees(&system).unwrap();
        let terms = |count: usize, keep: bool| -> Vec<usize> {
            let rows = combine_few(&system, &system_degrees, count, 1, keep);
            let supports = crate::polynomial::supports(&rows).expect("few terms");
            supports.iter().map(Vec::len).collect()
        };
        // z - 2 and the smooth conic stay as they are; the cubics are combined where one is left over.
        assert_eq!(terms(3, true), [2, 2, 4]);
        assert_eq!(terms(4, true), [2, 2, 2, 2]);
        assert_eq!(terms(2, true), [2, 2]);
        // The linear one is the one left over, then the conic as well.
        assert_eq!(terms(3, false), [4, 3, 3]);
        assert_eq!(terms(2, false), [5, 4]);
    }
}
