//! Paths that come close to one another: by a branch point at any distance, none takes the other's way.

use crate::check::{SEEDS, solve};
use crate::parameter_homotopies::solve_from;
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::SolveMethod;
use cognate_algorithms::plan::TrackingOptions;
use cognate_continuation::tracker::settings::Settings;
use cognate_systems::named::cyclic;
use cognate_tests::close_paths::ClosePaths;

#[test]
fn paths_beside_a_branch_point_keep_their_sheets() {
    let mut bits = Vec::new();
    for exponent in 3..=14 {
        let close = ClosePaths::at(exponent);
        let mut highest = 0;
        for seed in SEEDS {
            let options = SolveOptions {
                seed,
                ..SolveOptions::default()
            };
            let sets = solve_from(&close.system, close.starts.concat(), options);
            let paths = &sets[0].paths;
            assert_eq!(
                (paths.finite, paths.retracked),
                (4, 0),
                "distance 1e-{exponent}, seed {seed}: {paths:?}"
            );
            for solution in &sets[0].solutions {
                let values: Vec<_> = solution.variables.values().collect();
                let path = usize::try_from(solution.paths[0]).expect("there are four");
                let error = close.error(path, &values);
                assert!(
                    error < 1e-10,
                    "distance 1e-{exponent}, seed {seed}, path {path}"
                );
            }
            let most = paths.by_precision.keys().max().copied();
            highest = highest.max(most.unwrap_or(0));
        }
        bits.push(highest);
    }
    assert!(bits.is_sorted(), "more digits the closer: {bits:?}");
    assert!(bits[0] == 53 && bits[11] > 53, "{bits:?}");
}

/// Robust mode, with predictions that may else be off by a third of the point.
#[test]
fn robust_steps_keep_their_sheets() {
    for exponent in [3, 6, 9, 12] {
        let close = ClosePaths::at(exponent);
        for seed in SEEDS {
            let coarse = Settings {
                predictor_tolerance: 0.3,
                max_step: 0.25,
                ..Settings::default()
            };
            let options = SolveOptions {
                seed,
                tracking: TrackingOptions {
                    settings: coarse.robust(),
                    max_retries: 0,
                    ..TrackingOptions::default()
                },
                ..SolveOptions::default()
            };
            let sets = solve_from(&close.system, close.starts.concat(), options);
            assert_eq!(sets[0].paths.finite, 4, "1e-{exponent}, seed {seed}");
            for solution in &sets[0].solutions {
                let values: Vec<_> = solution.variables.values().collect();
                let path = usize::try_from(solution.paths[0]).expect("there are four");
                assert!(
                    close.error(path, &values) < 1e-8,
                    "1e-{exponent}, seed {seed}"
                );
            }
        }
    }
}

/// Newton's method that may leave an error of a hundredth behind predictions that may be off by half:
/// then paths jump, some onto paths to infinity, where ends do not show it. All are found where paths
/// enter the endgame, and come apart when they are tracked again; robust mode takes no step that jumps.
#[test]
fn robust_steps_do_not_jump_where_others_do() {
    let coarse = Settings {
        predictor_tolerance: 0.5,
        max_step: 0.25,
        tolerance: 1e-2,
        ..Settings::default()
    };
    let crossings_and_lost = |settings: &Settings, max_retries: u16| {
        let mut of_all = (0, 0);
        for seed in SEEDS {
            let options = SolveOptions {
                method: SolveMethod::TotalDegree,
                seed,
                tracking: TrackingOptions {
                    settings: settings.clone(),
                    max_retries,
                    ..TrackingOptions::default()
                },
                ..SolveOptions::default()
            };
            let (_, sets) = solve(&cyclic(5).system, &options, &|_| None);
            let (paths, counts) = (&sets[0].paths, &sets[0].counts);
            assert_eq!((paths.total, paths.sum()), (120, 120));
            let lost = 70 - counts.nonsingular;
            // The missing solutions are among the paths that are named.
            assert!(lost <= paths.failed, "seed {seed}: {lost} lost in silence");
            of_all.0 += paths.crossings_found;
            of_all.1 += lost;
        }
        of_all
    };
    let (crossings, _) = crossings_and_lost(&coarse, 0);
    assert!(crossings > 0);
    let (crossings, lost) = crossings_and_lost(&coarse, 3);
    assert!(
        crossings > 0 && lost == 0,
        "{crossings} crossings, {lost} lost"
    );
    assert_eq!(crossings_and_lost(&coarse.robust(), 0), (0, 0));
}
