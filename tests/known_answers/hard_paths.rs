//! Systems whose paths end at very singular points at infinity.
//!
//! Not all paths of eco-6 are settled yet: what is asked of them is that none is lost in silence.

use crate::check::{SEEDS, solve};
use crate::classical_systems::check_named;
use cognate_algorithms::PlanOptions;
use cognate_algorithms::plan::StartChoice;
use cognate_systems::named::{eco, reimer};

/// Five or six of its 162 paths by total degree run into a very singular point at infinity that takes more than
/// double-doubles. Every one of them must be named, and the 16 solutions must all be there.
#[test]
fn eco_6_names_every_path_that_it_does_not_settle() {
    for seed in SEEDS {
        let options = PlanOptions {
            seed,
            start: StartChoice::TotalDegree,
            ..PlanOptions::default()
        };
        let (_, sets) = solve(&eco(6).system, &options, &|_| None);
        let (paths, counts) = (&sets[0].paths, &sets[0].counts);
        assert_eq!((paths.total, paths.sum()), (162, 162), "seed {seed}");
        assert_eq!(counts.nonsingular, 16, "seed {seed}");
        assert_eq!(sets[0].failed.len() as u64, paths.failed, "seed {seed}");
        assert!(paths.failed <= 12, "seed {seed}: {} failed", paths.failed);
        assert_eq!(sets[0].settled(), paths.failed == 0, "seed {seed}");
    }
}

#[test]
fn reimer_4_has_36_solutions() {
    check_named("reimer-4", &reimer(4), 120, 36);
}
