//! How many certificates a second: Krawczyk's test at the solutions of a file, on one thread.
//!
//! `cargo bench -p cognate-tests --bench certification`. CPU seconds of the test alone, beside
//! those of the tracking that found the points; all points of a
//! system are certified in one call, as a worker certifies a piece of a chunk.

use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{SolveOptions, plan};
use cognate_continuation::certification::{Candidate, Krawczyk};
use cognate_tests::measures::cpu_seconds;
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::path::Path;

fn main() {
    println!(
        "{:34} {:>6} {:>6} {:>12} {:>12} {:>14}  bits",
        "system", "n", "points", "tracking s", "certifying s", "certificates/s"
    );
    for name in [
        "three_rpr",
        "six_revolute_manseur_doty",
        "stewart_gough_dietmaier",
        "cyclic_5",
        "noon_5",
        "katsura_10",
    ] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../deploy/examples")
            .join(format!("{name}.bertini"));
        let content = std::fs::read(&file).expect("an example");
        let system = cognate_systems::formats::read(name, &content)
            .expect("a problem")
            .system;
        let options = SolveOptions {
            seed: 1,
            ..SolveOptions::default()
        };
        let mut planned = plan(&system, &options).expect("a plan");
        let before = cpu_seconds().ok();
        let sets = run_locally(&planned.system, &mut planned.algorithm, &|_| None, 16)
            .expect("paths that can be tracked");
        let tracking = cpu_seconds().ok().zip(before).map(|(a, b)| a - b);
        let points: Vec<Vec<Complex64>> = sets[0]
            .solutions
            .iter()
            .filter(|solution| !solution.singular)
            .map(|solution| solution.variables.values().collect())
            .collect();
        let krawczyk = Krawczyk::new(&system);
        let candidates: Vec<Candidate<'_>> = points
            .iter()
            .map(|point| Candidate {
                parameters: &[],
                point,
            })
            .collect();
        let mut bits: BTreeMap<u32, usize> = BTreeMap::new();
        let before = cpu_seconds().ok();
        for certification in krawczyk.certify_all(&candidates) {
            if let Some(certificate) = certification.certificate() {
                *bits.entry(certificate.precision_bits).or_default() += 1;
            }
        }
        let certifying = cpu_seconds().ok().zip(before).map(|(a, b)| a - b);
        let shown = |seconds: Option<f64>| match seconds {
            Some(seconds) => format!("{seconds:.4}"),
            None => "-".to_owned(),
        };
        let rate = certifying.map(|seconds| points.len() as f64 / seconds);
        println!(
            "{name:34} {:>6} {:>6} {:>12} {:>12} {:>14}  {bits:?}",
            system.dimension(),
            points.len(),
            shown(tracking),
            shown(certifying),
            rate.map_or("-".to_owned(), |rate| format!("{rate:.0}")),
        );
    }
}
