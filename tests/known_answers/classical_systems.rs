//! Classical systems by name; each count has its source in `systems/named`.

use crate::check::{Answer, check};
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::SolveMethod;
use cognate_systems::named::{Named, cyclic, katsura, noon};

/// By total degree: regular finite solutions, and all other paths at infinity.
pub fn check_named(name: &str, named: &Named, paths: u64, finite: u64) {
    assert_eq!(named.finite_solutions, Some(finite));
    check(
        name,
        &named.system,
        &SolveOptions {
            method: SolveMethod::TotalDegree,
            ..SolveOptions::default()
        },
        Answer {
            paths,
            nonsingular: finite,
            at_infinity: paths - finite,
            ..Answer::default()
        },
    );
}

#[test]
fn katsura_8_has_256_solutions() {
    check_named("katsura-8", &katsura(8), 256, 256);
}

#[test]
fn katsura_10_has_1024_solutions() {
    check_named("katsura-10", &katsura(10), 1024, 1024);
}

#[test]
fn cyclic_5_has_70_solutions() {
    check_named("cyclic-5", &cyclic(5), 120, 70);
}

#[test]
fn noon_5_has_233_solutions() {
    check_named("noon-5", &noon(5), 243, 233);
}
