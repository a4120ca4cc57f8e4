//! A decomposition that is carried from general values of parameters to others, and is written down in between.

use super::*;
use crate::restarts;
use crate::{AnySolve, PathAlgorithm};
use cognate_systems::formats;
use num_complex::Complex64;

#[test]
fn a_state_that_was_read_back_goes_on() {
    let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y, z; parameter a; function f, g;\
                f = x*z - y^2 + a*z; g = y - x^2 + a*(z + 2);\nEND;\n";
    let system = formats::read("test", text.as_bytes()).unwrap().system;
    let general = vec![Complex64::new(0.6, -0.8)];
    let first = DecompositionOptions {
        seed: 6,
        parameters: general.clone(),
        ..DecompositionOptions::default()
    };
    let general_decomposition =
        run_locally(DecompositionSolve::new(&system, &first).unwrap(), 8).unwrap();
    let options = DecompositionOptions {
        parameters: vec![Complex64::default()],
        known: Some(KnownComponents {
            equations: 2,
            components: general_decomposition.components,
            parameters: general,
        }),
        ..first
    };
    let lived = run_locally(DecompositionSolve::new(&system, &options).unwrap(), 8).unwrap();
    let solve = DecompositionSolve::new(&system, &options).unwrap();
    let solve = AnySolve::Decomposition(Box::new(solve));
    let solve = restarts::with_restarts(solve, &system, &mut |_| {});
    let Some(Answer::Decomposition(restarted)) = solve.answer(&system) else {
        panic!("a decomposition ends with one");
    };
    assert_eq!(*restarted, lived);
}
