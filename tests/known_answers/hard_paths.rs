//! Systems whose paths end at very singular points at infinity.
//!
//! Doubles do not settle all of them yet: run with `--ignored` to see how far it is.

use crate::classical_systems::check_named;
use cognate_systems::named::{eco, reimer};

#[test]
#[ignore = "endpoints of high multiplicity at infinity need the complete endgame"]
fn eco_6_has_16_solutions() {
    check_named("eco-6", &eco(6), 162, 16);
}

#[test]
#[ignore = "endpoints of high multiplicity at infinity need the complete endgame"]
fn reimer_4_has_36_solutions() {
    check_named("reimer-4", &reimer(4), 120, 36);
}
