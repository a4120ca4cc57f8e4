//! Close paths: the cost of keeping two paths apart that pass a branch point at ever smaller distance.
//!
//! `cargo bench -p cognate-tests --bench close_paths [-- FIGURE.svg]`, in tests/. A path that took another's way is
//! counted, and the exit code says so. Results: `close_paths.md`.

use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::stage::PreparedStage;
use cognate_continuation::start_points::{Digest, StartPoints, StoredPoints};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_tests::close_paths::ClosePaths;
use num_complex::Complex64;
use std::fmt::Write as _;
use std::process::ExitCode;
use std::sync::Arc;

type Failure = Box<dyn std::error::Error>;

/// Random patches for each distance.
const SEEDS: u64 = 25;
/// Nearest and farthest: powers of ten.
const EXPONENTS: std::ops::RangeInclusive<u32> = 3..=14;

/// Measurements for one distance of the paths.
struct Row {
    exponent: u32,
    paths: u64,
    /// Ended elsewhere, or not at all.
    lost: u64,
    steps: f64,
    /// How many paths used more digits than doubles have.
    higher: u64,
    most_bits: u32,
    largest_error: f64,
}

fn measure(exponent: u32) -> Result<Row, Failure> {
    let close = ClosePaths::at(exponent);
    let stored = Arc::new(StoredPoints {
        dimension: 2,
        coordinates: close.starts.concat(),
    });
    let mut results: Vec<PathResult> = Vec::new();
    for seed in 1..=SEEDS {
        let stage = Stage {
            id: StageId(0),
            system: None,
            work: Work::Track,
            homotopy: HomotopyKind::PathVariable {
                parameters: vec![Complex64::new(1.0, 0.0)],
            },
            start_points: StartPoints::Stored {
                object: Digest([0; 32]),
                count: 4,
            },
            settings: Settings::default(),
            seed,
            attempt: 0,
        };
        let prepared = PreparedStage::new(&close.system, &stage, &|_| Some(stored.clone()))?;
        results.extend(prepared.track(0..4, 8));
    }
    let error = |result: &PathResult| {
        let values: Vec<Complex64> = match result.endpoint.to_double() {
            [first, rest @ ..] if rest.len() == 2 => rest.iter().map(|z| z / first).collect(),
            affine_point => affine_point.to_vec(),
        };
        close.error(result.origin.0 as usize, &values)
    };
    let errors: Vec<f64> = results.iter().map(error).collect();
    let kept = errors.iter().filter(|&&e| e < 1e-8);
    let tried = results.iter().map(|r| r.counts.steps + r.counts.rejections);
    let paths = results.len() as u64;
    Ok(Row {
        exponent,
        paths,
        lost: paths - kept.clone().count() as u64,
        steps: f64::from(tried.sum::<u32>()) / paths as f64,
        higher: results.iter().filter(|r| r.precision_bits > 53).count() as u64,
        most_bits: results.iter().map(|r| r.precision_bits).max().unwrap_or(0),
        largest_error: kept.fold(0.0, |m, &e| f64::max(m, e)),
    })
}

/// Steps a path over the distance; filled: all digits that doubles have were enough.
fn figure(rows: &[Row]) -> String {
    let most = rows.iter().fold(1.0, |m, row| f64::max(m, row.steps));
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 560 300\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"560\" height=\"300\" fill=\"white\"/>\n\
         <text x=\"20\" y=\"20\">steps a path; number: bits of the highest rung; distance from the branch point below</text>\n",
    );
    for (k, row) in rows.iter().enumerate() {
        let (x, height) = (30 + 43 * k, 200.0 * row.steps / most);
        let y = 260.0 - height;
        let colour = if row.most_bits > 53 {
            "#c05020"
        } else {
            "#4070b0"
        };
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"{y:.1}\" width=\"30\" height=\"{height:.1}\" fill=\"{colour}\"/>\
             <text x=\"{x}\" y=\"{:.1}\">{}</text><text x=\"{x}\" y=\"278\">1e-{}</text>",
            y - 5.0,
            row.most_bits,
            row.exponent
        );
    }
    svg + "</svg>\n"
}

fn run() -> Result<u64, Failure> {
    let rows: Vec<Row> = EXPONENTS.map(measure).collect::<Result<_, _>>()?;
    println!(
        "| distance | paths | lost | steps tried a path | above doubles | most bits | error |"
    );
    println!("|---|---|---|---|---|---|---|");
    for row in &rows {
        println!(
            "| 1e-{} | {} | {} | {:.1} | {} | {} | {:.1e} |",
            row.exponent,
            row.paths,
            row.lost,
            row.steps,
            row.higher,
            row.most_bits,
            row.largest_error
        );
    }
    if let Some(path) = std::env::args().skip(1).find(|word| word.ends_with(".svg")) {
        std::fs::write(&path, figure(&rows)).map_err(|e| format!("{path}: {e}"))?;
    }
    Ok(rows.iter().map(|row| row.lost).sum())
}

fn main() -> ExitCode {
    match run() {
        Ok(0) => ExitCode::SUCCESS,
        Ok(lost) => {
            eprintln!("{lost} paths did not keep their sheet");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
