//! Real surfaces without an outline: planes.

use super::tests::{ask, components, system};
use cognate_solutions::witness::{Answer, Question};

/// Euler characteristics with compact support of the components of one equation.
fn euler_characteristics(equation: &str, seed: u64) -> Vec<i64> {
    let system = system(&format!(
        "variable_group x, y, z; function f; f = {equation};"
    ));
    let decomposition = components(&system, seed);
    let question = Question::RealSurface { samples: 1 };
    let (answer, doubts) = ask(&system, &decomposition.components, &question);
    let Answer::RealSurface(surfaces) = answer else {
        panic!("{answer:?}");
    };
    assert!(doubts.is_empty(), "{equation}, seed {seed}: {doubts:?}");
    assert!(surfaces.iter().all(|surface| !surface.compact));
    surfaces.iter().map(|surface| surface.euler).collect()
}

#[test]
fn planes_have_no_outline() {
    for seed in 1..4 {
        assert_eq!(euler_characteristics("x + 2*y + 3*z - 4", seed), [1]);
        assert_eq!(euler_characteristics("z^2 - 1", seed), [1, 1]);
    }
}
