//! How many bends a second: derivatives of witness points in ten unknowns along a moving slice, on one thread.
//!
//! `cargo bench -p cognate-tests --bench bends`. CPU seconds of the stage's items alone.

use cognate_continuation::bend::stage::BendStage;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::transform::slice;
use cognate_tests::measures::cpu_seconds;
use num_complex::Complex64;
use std::fmt::Write;
use std::sync::Arc;

/// Unknowns of the curve, and points that are asked.
const UNKNOWNS: usize = 10;
const POINTS: usize = 20_000;

/// Quadrics x_i x_(i+1) + 3 x_i^2 + x_(i+2) = c_i through a point of small integers, which is given with them.
fn curve() -> (String, Vec<f64>) {
    let point: Vec<f64> = (0..UNKNOWNS).map(|k| (k * 7 % 5) as f64 + 1.0).collect();
    let names: Vec<String> = (0..UNKNOWNS).map(|k| format!("x{k}")).collect();
    let functions: Vec<String> = (1..UNKNOWNS).map(|k| format!("f{k}")).collect();
    let mut text = format!(
        "CONFIG\nEND;\nINPUT\nvariable_group {}; function {};\n",
        names.join(", "),
        functions.join(", ")
    );
    for k in 1..UNKNOWNS {
        let (b, c) = ((k + 1) % UNKNOWNS, (k + 2) % UNKNOWNS);
        let value = point[k] * point[b] + 3.0 * point[k] * point[k] + point[c];
        let _ = writeln!(text, "f{k} = x{k}*x{b} + 3*x{k}^2 + x{c} - {value};");
    }
    (text + "END;\n", point)
}

fn main() {
    let (text, point) = curve();
    let system = cognate_systems::formats::read("bends", text.as_bytes())
        .expect("a problem")
        .system;
    let sliced = slice(&system, 1, UNKNOWNS);
    let mut random = RandomStream::new(1, Purpose::Test, 0);
    let coefficients: Vec<Complex64> = (0..UNKNOWNS).map(|_| random.unit()).collect();
    let forms = point.iter().zip(&coefficients).map(|(x, c)| c * x);
    let constant = -forms.sum::<Complex64>();
    let mut start = vec![constant];
    start.extend(coefficients);
    let mut target = start.clone();
    target[0] += Complex64::new(0.6, 0.8);
    let near = |k: usize| {
        let by = 1e-10 * (k % 97) as f64;
        point.iter().map(move |&x| Complex64::new(x + by, -by))
    };
    let points = Arc::new(StoredPoints {
        dimension: UNKNOWNS,
        coordinates: (0..POINTS).flat_map(near).collect(),
    });
    let stage = Stage {
        id: StageId(0),
        system: None,
        work: Work::Bend,
        homotopy: HomotopyKind::Parameter {
            start,
            targets: vec![target],
        },
        start_points: StartPoints::Selected {
            base: Box::new(points.as_start()),
            indices: (0..POINTS as u64).collect(),
        },
        settings: Settings::default(),
        seed: 1,
        attempt: 0,
    };
    let find = |_| Some(Arc::clone(&points));
    let prepared = BendStage::new(&sliced, &stage, &find).expect("a stage");
    let before = cpu_seconds().ok();
    let results = prepared.run(0..prepared.items());
    let seconds = cpu_seconds().ok().zip(before).map(|(a, b)| a - b);
    let facts = results.iter().filter(|result| result.fact().is_some());
    let facts = facts.count();
    match seconds {
        Some(seconds) => println!(
            "{facts} of {POINTS} points in {UNKNOWNS} unknowns: {seconds:.2} s, {:.1} s for 100,000",
            seconds * 1e5 / POINTS as f64
        ),
        None => println!("{facts} of {POINTS} points: no clock of the processor here"),
    }
}
