//! Endpoints by the million: which of them are one point, and where paths have crossed.
//!
//! `cargo bench -p cognate-tests --bench endpoints -- [COUNT...]`; without counts 10^4, 10^5 and 10^6.
//! Endpoints are made up, with three coordinates; of each ten one is another's, moved by less than its
//! error, and all of these must be found, and no others. Then as many keys of where paths entered the
//! endgame, as uncertain as those of real paths can be. Results: `endpoints.md`.

use cognate_continuation::path_result::{BoundaryKey, NUMBERS, PathResult};
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::{Decision, Tolerances, classify};
use cognate_solutions::path_crossing::{crossings, meetings};
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::unique_points::{Neighbourhood, clusters};
use cognate_systems::named::katsura;
use cognate_tests::measures::memory_bytes;
use num_complex::Complex64;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

/// Coordinates of an endpoint, the homogenising one among them.
const COORDINATES: usize = 4;
/// One endpoint in this number is at the point of the one before.
const TWICE: usize = 10;
/// Number of endpoints beyond which whole results do not fit beside one another: only their points are compared.
const WHOLE_RESULTS: usize = 1_000_000;

fn endpoints(count: usize) -> Vec<Complex64> {
    let mut random = RandomStream::new(count as u64, Purpose::Test, 0);
    let mut flat: Vec<Complex64> = Vec::with_capacity(count * COORDINATES);
    for k in 0..count {
        for c in 0..COORDINATES {
            let fresh = random.disc();
            let near = |k: usize| flat[(k - 1) * COORDINATES + c] * (1.0 + fresh * 1e-15);
            let coordinate = if k % TWICE == TWICE - 1 {
                near(k)
            } else {
                fresh
            };
            flat.push(coordinate);
        }
    }
    flat
}

/// How uncertain a number of a key is at most, by default settings: a twentieth of the largest error of a
/// prediction, times the slope of four coordinates.
const MARGIN: f64 = 0.05 * 1e-4 * 4.0;

/// Keys of the boundary: numbers in [0, 1].
fn keys(count: usize) -> Vec<BoundaryKey> {
    let mut random = RandomStream::new(count as u64, Purpose::Test, 1);
    let mut keys: Vec<BoundaryKey> = Vec::with_capacity(count);
    for k in 0..count {
        let numbers = match k % TWICE == TWICE - 1 {
            true => keys[k - 1].numbers.map(|number| number + MARGIN),
            false => std::array::from_fn::<f64, NUMBERS, _>(|_| random.uniform()),
        };
        keys.push(BoundaryKey {
            numbers,
            margin: MARGIN,
        });
    }
    keys
}

fn result(path: usize, point: &[Complex64]) -> PathResult {
    PathResult {
        residual: 1e-16,
        condition: 10.0,
        accuracy: 1e-15,
        ..PathResult::untracked(path as u64, 0, PathOutcome::Regular, point.to_vec())
    }
}

fn main() -> Result<(), Failure> {
    let words = std::env::args().skip(1).filter(|a| a != "--bench");
    let counts: Vec<usize> = words.map(|word| word.parse()).collect::<Result<_, _>>()?;
    let counts = match counts.is_empty() {
        true => vec![10_000, 100_000, 1_000_000],
        false => counts,
    };
    // Three variables in one group, as katsura-2 has them.
    let shape = PointShape::of(&katsura(2).system);
    assert_eq!(shape.coordinates(), COORDINATES);
    println!(
        "{:>10} {:>10} {:>9} {:>16} {:>9} {:>11} {:>9} {:>9} {:>9}",
        "endpoints", "points", "s", "ns/(n log2 n)", "crossings", "s", "keys met", "s", "peak MiB"
    );
    for count in counts {
        let flat = endpoints(count);
        let points: Vec<Neighbourhood<'_>> = flat
            .chunks_exact(COORDINATES)
            .map(|point| Neighbourhood {
                point,
                radius: 1e-14,
                refined: false,
            })
            .collect();
        let expected = count / TWICE;
        let began = Instant::now();
        let point_clusters = clusters(&points, &shape, 1);
        let seconds = began.elapsed().as_secs_f64();
        if point_clusters.len() != count - expected {
            return Err(
                format!("{} points, not {}", point_clusters.len(), count - expected).into(),
            );
        }
        let distinct = point_clusters.len();
        drop((point_clusters, points));
        let mut crossed = ("-".to_owned(), "-".to_owned());
        if count <= WHOLE_RESULTS {
            let tolerances = Tolerances::default();
            let results: Vec<PathResult> = flat
                .chunks_exact(COORDINATES)
                .enumerate()
                .map(|(k, point)| result(k, point))
                .collect();
            let decide = |result| classify(result, &shape, &tolerances);
            let decisions: Vec<Decision> = results.iter().map(decide).collect();
            let began = Instant::now();
            let crossed_paths = crossings(&results, &decisions, &shape, &tolerances, 1);
            let seconds = began.elapsed().as_secs_f64();
            if crossed_paths.len() != expected || crossed_paths.iter().any(|pair| pair.len() != 2) {
                return Err(format!("{} crossings, not {expected}", crossed_paths.len()).into());
            }
            crossed = (crossed_paths.len().to_string(), format!("{seconds:.3}"));
        }
        let keys = keys(count);
        let began = Instant::now();
        let met = meetings(&keys);
        let at_boundary = began.elapsed().as_secs_f64();
        // Among this many endpoints some are as near as that by chance, too.
        let is_twin = |pair: &[usize]| pair[1] % TWICE == TWICE - 1 && pair[0] + 1 == pair[1];
        let pairs = met.iter().flat_map(|members| members.windows(2));
        let pairs = pairs.filter(|pair| is_twin(pair)).count();
        if pairs != expected {
            return Err(format!("{pairs} keys met, not {expected}").into());
        }
        let n = count as f64;
        let per = seconds * 1e9 / (n * f64::from(count.ilog2()));
        println!(
            "{count:>10} {distinct:>10} {seconds:>9.3} {per:>16.1} {:>9} {:>11} {:>9} {at_boundary:>9.3} {:>9}",
            crossed.0,
            crossed.1,
            met.len(),
            memory_bytes("self", "VmHWM")? >> 20
        );
    }
    Ok(())
}
