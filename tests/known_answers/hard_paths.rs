//! Systems whose paths end at very singular points at infinity.
//!
//! Not all paths of eco-6 are settled yet: what is asked of them is that none is lost in silence.

use crate::check::solve;
use crate::classical_systems::check_named;
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::SolveMethod;
use cognate_systems::named::{eco, katsura, reimer};

/// By total degree, at most four of its 162 paths come so near to others (1e-14 and less, half-way,
/// where they are larger than 1e14) that they take too many steps with hundreds of bits. Every one
/// of them must be named, and the 16 solutions must all be there.
#[test]
fn eco_6_names_every_path_that_it_does_not_settle() {
    for seed in 1..=2 {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&eco(6).system, &options, &|_| None);
        let (paths, counts) = (&sets[0].paths, &sets[0].counts);
        assert_eq!((paths.total, paths.sum()), (162, 162), "seed {seed}");
        assert_eq!(counts.nonsingular, 16, "seed {seed}");
        assert_eq!(sets[0].failed.len() as u64, paths.failed, "seed {seed}");
        assert!(paths.failed <= 4, "seed {seed}: {} failed", paths.failed);
        assert_eq!(sets[0].settled(), paths.failed == 0, "seed {seed}");
    }
}

/// By total degree, some paths of eco-5 have coordinates like t, t^3, t^9, t^27: doubles lose such a
/// path half-way, and with more digits it is followed from its beginning. (Paths beside it that take
/// too many steps with other seeds are like those of eco-6.)
#[test]
fn what_doubles_lose_begins_again_with_more_digits() {
    for seed in 1..=2 {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&eco(5).system, &options, &|_| None);
        let paths = &sets[0].paths;
        assert_eq!(
            (paths.total, paths.finite, paths.at_infinity, paths.failed),
            (54, 8, 46, 0),
            "seed {seed}"
        );
    }
}

/// Start points have the digits of doubles; three Newton steps do not give them those of 512 bits.
#[test]
fn paths_may_begin_with_any_number_of_bits() {
    for bits in [106, 212, 512, 2048] {
        let mut options = SolveOptions::default();
        options.tracking.settings.precision_bits = bits;
        options.tracking.settings.max_precision_bits = bits;
        let (_, sets) = solve(&katsura(3).system, &options, &|_| None);
        let paths = &sets[0].paths;
        assert_eq!((paths.finite, paths.failed), (8, 0), "{bits} bits");
        assert_eq!(
            paths.by_precision.keys().copied().collect::<Vec<_>>(),
            [bits]
        );
    }
}

#[test]
fn reimer_4_has_36_solutions() {
    check_named("reimer-4", &reimer(4), 120, 36);
}

/// With these seeds and any gamma, a coefficient nearly vanished half-way, and one of the 64
/// polyhedral paths passed by infinity there, as large as 4e13.
#[test]
fn no_path_of_eco_8_passes_by_infinity() {
    for seed in [55, 1_913_475_225] {
        let options = SolveOptions {
            method: SolveMethod::Polyhedral,
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&eco(8).system, &options, &|_| None);
        let (paths, counts) = (&sets[0].paths, &sets[0].counts);
        assert_eq!((paths.total, paths.finite, paths.failed), (64, 64, 0));
        assert_eq!((paths.retracked, counts.nonsingular), (0, 64));
    }
}
