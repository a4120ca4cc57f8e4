//! TEMP probe
use cognate_continuation::{
    homotopies::HomotopyKind, stage::PreparedStage, start_points::StartPoints, tracker::outcome::*,
    tracker::settings::Settings, work::*,
};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let seeds: u64 = args[2].parse().unwrap();
    let width: usize = args[3].parse().unwrap();
    use cognate_systems::named::*;
    let system = match args[1].as_str() {
        "katsura8" => katsura(8).system,
        "katsura10" => katsura(10).system,
        "cyclic5" => cyclic(5).system,
        "cyclic6" => cyclic(6).system,
        "noon5" => noon(5).system,
        "eco8" => eco(8).system,
        "reimer5" => reimer(5).system,
        "caprasse" => caprasse().system,
        "cyclic7" => cyclic(7).system,
        "go" => griewank_osborne().system,
        f => {
            let text = std::fs::read_to_string(f).unwrap();
            cognate_systems::formats::read(f, text.as_bytes())
                .unwrap()
                .system
        }
    };
    let d = cognate_systems::polynomial::degrees(&system)
        .unwrap()
        .by_group;
    let dims: Vec<u32> = system
        .groups
        .iter()
        .map(|g| g.variables.len() as u32 - u32::from(g.homogeneous))
        .collect();
    let sp = if dims.len() == 1 {
        StartPoints::TotalDegree {
            degrees: d.iter().map(|r| r[0]).collect(),
        }
    } else {
        StartPoints::Multihomogeneous {
            degrees: d,
            dimensions: dims,
        }
    };
    for seed in 1..=seeds {
        let stage = Stage {
            id: StageId(0),
            work: Work::Track,
            homotopy: HomotopyKind::StraightLine { parameters: vec![] },
            start_points: sp.clone(),
            settings: Settings {
                precision_bits: std::env::var("BITS")
                    .ok()
                    .and_then(|b| b.parse().ok())
                    .unwrap_or(53),
                ..Settings::default()
            },
            seed,
            attempt: 0,
        };
        let t0 = std::time::Instant::now();
        let prepared = PreparedStage::new(&system, &stage, &|_| None).unwrap();
        let t1 = std::time::Instant::now();
        let results = if args.len() > 5 {
            let i: u64 = args[5].parse().unwrap();
            let (r, e) = prepared.trace(i);
            for e in &e {
                if e.phase != "turn" {
                    eprintln!(
                        "{:9} t {:.3e} h {:.1e} {} pe {:.1e} c {:.1e}",
                        e.phase, e.t, e.step, e.accepted, e.predictor_error, e.correction
                    );
                }
            }
            vec![r]
        } else {
            prepared.track(0..prepared.items(), width)
        };
        let t2 = std::time::Instant::now();
        let hom = prepared.homotopy().chart().homogenizing();
        let (mut fin, mut inf, mut sing, mut singinf, mut failed) = (0, 0, 0, 0, 0);
        let mut keys: Vec<(f64, usize)> = vec![];
        let mut steps = 0;
        let mut evals = 0;
        let mut turns = 0;
        for (i, r) in results.iter().enumerate() {
            let x = r.endpoint.to_double();
            steps += r.counts.steps + r.counts.rejections;
            evals += r.counts.evaluations;
            turns += r.counts.turns;
            let x0 = hom
                .iter()
                .map(|&k| x[k].norm_sqr().sqrt())
                .fold(f64::INFINITY, f64::min);
            match r.outcome {
                PathOutcome::Regular => {
                    if args.len() > 4 && (x0 < 1e-2) {
                        println!(
                            "  {i} REG x0 {x0:.2e} cond {:.1e} acc {:.1e} c {:?} turns {} res {:.1e}",
                            r.condition, r.accuracy, r.winding_number, r.counts.turns, r.residual
                        );
                    }
                    if x0 < 1e-12 {
                        inf += 1
                    } else {
                        fin += 1;
                    }
                    let s: f64 = x[1..]
                        .iter()
                        .enumerate()
                        .map(|(k, z)| {
                            let w = z / x[0];
                            (w.re * 0.37 + w.im * 0.71) * ((k * k + 3) as f64 * 0.618).fract()
                        })
                        .sum();
                    keys.push((s, i));
                }
                PathOutcome::Singular => {
                    if x0 < 1e-7 {
                        singinf += 1
                    } else {
                        sing += 1
                    };
                    if args.len() > 4 {
                        println!(
                            "  {i} sing c={:?} acc {:.1e} cond {:.1e} x0 {:.1e} turns {:?} total {}",
                            r.winding_number,
                            r.accuracy,
                            r.condition,
                            x0,
                            r.infinity_turns,
                            r.counts.turns
                        );
                    }
                }
                PathOutcome::Failed(f) => {
                    failed += 1;
                    if args.len() > 4 {
                        println!("  {i} {f:?} t={} {:?}", r.t, r.counts);
                    }
                }
            }
        }
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        let dup = keys
            .windows(2)
            .filter(|w| (w[0].0 - w[1].0).abs() < 1e-9 * (1.0 + w[0].0.abs()))
            .count();
        println!(
            "seed {seed}: {} paths: finite {fin} inf {inf} sing {sing} sing-inf {singinf} failed {failed} dup {dup}; steps/path {:.0} evals/path {:.0} turns {turns}; prepare {:.1} ms, track {:.1} ms, {:.0} paths/s",
            results.len(),
            steps as f64 / results.len() as f64,
            evals as f64 / results.len() as f64,
            (t1 - t0).as_secs_f64() * 1e3,
            (t2 - t1).as_secs_f64() * 1e3,
            results.len() as f64 / (t2 - t1).as_secs_f64()
        );
    }
}
