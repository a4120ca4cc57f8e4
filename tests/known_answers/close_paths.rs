//! Paths that come close to one another: by a branch point at any distance, none takes the other's way.

use crate::check::SEEDS;
use crate::parameter_homotopies::solve_from;
use cognate_algorithms::PlanOptions;
use cognate_tests::systems::written;
use num_complex::Complex64;

/// The principal square root of re + im i with im > 0.
fn principal_root(re: f64, im: f64) -> Complex64 {
    let half = ((re * re + im * im).sqrt() + re.abs()) / 2.0;
    let large = half.sqrt();
    let small = im / (2.0 * large);
    match re >= 0.0 {
        true => Complex64::new(large, small),
        false => Complex64::new(small, large),
    }
}

/// u^2 = t - 1/2 + d i and v^2 = t - 1/3 + d i with u = x + 2 y and v = x - 3 y: two paths come within
/// 2 sqrt(d) of each other where t = 1/2, and again where t = 1/3. The principal square roots are
/// continuous on the way, so u and v keep their signs.
#[test]
fn paths_beside_a_branch_point_keep_their_sheets() {
    let mut bits = Vec::new();
    for exponent in 3..=14 {
        let distance = 0.1f64.powi(exponent);
        let system = written(&format!(
            "variable x, y; pathvariable t; function f, g; \
             f = (x + 2*y)^2 - (t - 1/2 + 1e-{exponent}*I); \
             g = (x - 3*y)^2 - (t - 1/3 + 1e-{exponent}*I);"
        ));
        let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let root = |re: f64| principal_root(re, distance);
        let points = |t: f64| {
            signs.map(|(s, r)| {
                let (u, v) = (root(t - 0.5) * s, root(t - 1.0 / 3.0) * r);
                let y = (u - v) / 5.0;
                [u - y * 2.0, y]
            })
        };
        let (starts, ends) = (points(1.0), points(0.0));
        let mut highest = 0;
        for seed in SEEDS {
            let options = PlanOptions {
                seed,
                ..PlanOptions::default()
            };
            let sets = solve_from(&system, starts.concat(), options);
            let paths = &sets[0].paths;
            assert_eq!(
                (paths.finite, paths.retracked),
                (4, 0),
                "distance 1e-{exponent}, seed {seed}: {paths:?}"
            );
            for solution in &sets[0].solutions {
                let end = ends[usize::try_from(solution.paths[0]).unwrap()];
                for ((_, value), expected) in solution.variables.0.iter().zip(end) {
                    let error = (value - expected).norm_sqr().sqrt();
                    assert!(error < 1e-10, "distance 1e-{exponent}, seed {seed}");
                }
            }
            let most = paths.by_precision.keys().max().copied();
            highest = highest.max(most.unwrap_or(0));
        }
        bits.push(highest);
    }
    assert!(bits.is_sorted(), "more digits the closer: {bits:?}");
    assert!(bits[0] == 53 && bits[11] > 53, "{bits:?}");
}
