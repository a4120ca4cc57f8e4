//! Nine-point synthesis from one generic member of the family to another: the tracker's rate.
//!
//! `cargo bench -p cognate-tests --bench nine_point [-- widths|threads|rotations|targets]`. Every figure is CPU time of the threads that
//! track, all sides of a ratio in turns within this run, the best of the rounds counts. Results, with the machine:
//! `nine_point.md`.

use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::stage::PreparedStage;
use cognate_continuation::start_points::{Digest, StartPoints, StoredPoints};
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_machine_code::Elimination;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch};
use cognate_numeric::linear_algebra::lu;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::{Complex, Real};
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::symmetry::SymmetryGroup;
use cognate_systems::evaluation::{Evaluate, Program};
use cognate_systems::formats::points::read_parameters;
use cognate_systems::named::{nine_point, nine_point_with_rotations, rotations};
use cognate_systems::system::System;
use cognate_tests::measures::cpu_seconds;
use num_complex::Complex64;
use std::path::Path;
use std::sync::Arc;

type Failure = Box<dyn std::error::Error>;

/// How often each side of a ratio is measured.
const ROUNDS: usize = 5;
/// Paths of which each side of a ratio consists.
const SHARE: u64 = 1440;
/// Two endpoints are the same below this distance, relative to their largest coordinate.
const SAME: f64 = 1e-8;

/// The least CPU seconds that the work took.
fn best(mut work: impl FnMut()) -> Result<f64, Failure> {
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let before = cpu_seconds()?;
        work();
        best = best.min(cpu_seconds()? - before);
    }
    Ok(best)
}

/// Fused multiply-adds of doubles, in as many independent chains as the processor can have under way.
struct Peak<'a> {
    rounds: usize,
    factors: &'a [Lanes<8>],
}

const CHAINS: usize = 12;

impl Job for Peak<'_> {
    type Output = f64;
    #[inline(always)]
    fn run(self) -> f64 {
        let factor = self.factors[0];
        let mut chains: [Lanes<8>; CHAINS] = std::array::from_fn(|k| self.factors[k]);
        for _ in 0..self.rounds {
            for other in self.factors {
                for chain in &mut chains {
                    chain.mul_add(other, &factor);
                }
            }
        }
        chains.iter().map(|chain| chain.lane(0)).sum()
    }
}

/// Real operations a second of one core that does nothing but fused multiply-adds.
fn peak() -> Result<f64, Failure> {
    let factors: Vec<Lanes<8>> = (0..64)
        .map(|k| <Lanes<8> as Real>::from_f64((), f64::from(k)))
        .collect();
    let rounds = 100_000;
    let seconds = best(|| {
        let factors = std::hint::black_box(&factors[..]);
        std::hint::black_box(dispatch(Peak { rounds, factors }));
    })?;
    Ok((rounds * factors.len() * CHAINS * 8 * 2) as f64 / seconds)
}

/// The kept member of the family: one representative of each pair that the exchange makes.
struct Family {
    system: System,
    shape: PointShape,
    exchange: SymmetryGroup,
    parameters: Vec<Complex64>,
    starts: Arc<StoredPoints>,
}

impl Family {
    fn read() -> Result<Self, Failure> {
        let mut system = nine_point().system;
        system.symmetry.truncate(1);
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../deploy/families/nine_point");
        let solutions = StoredPoints::from_bytes(&std::fs::read(folder.join("solutions.points"))?)?;
        let text = std::fs::read(folder.join("parameters.json"))?;
        let parameters = read_parameters("parameters.json", &text, &system.parameters)?
            .into_iter()
            .next()
            .ok_or("no parameters")?;
        let shape = PointShape::of(&system);
        let mut exchange = SymmetryGroup::of(&system)?;
        exchange.close(solutions.point(0), &shape)?;
        let listed: Vec<(&[Complex64], f64)> = (0..solutions.len())
            .map(|k| (solutions.point(k), SAME))
            .collect();
        let pairs = exchange.orbits(&listed, &shape, 1);
        let coordinates = pairs
            .iter()
            .flat_map(|pair| solutions.point(pair[0]).to_vec())
            .collect();
        Ok(Self {
            system,
            shape,
            exchange,
            parameters,
            starts: Arc::new(StoredPoints {
                dimension: solutions.dimension,
                coordinates,
            }),
        })
    }

    /// The parameter homotopy to the target of this number.
    fn prepare(&self, target: u64, settings: Settings) -> Result<PreparedStage, Failure> {
        let mut random = RandomStream::new(target, Purpose::Test, 1);
        let numbers = self.parameters.iter().map(|_| random.unit()).collect();
        let stage = Stage {
            id: StageId(0),
            system: None,
            work: Work::Track,
            homotopy: HomotopyKind::Parameter {
                start: self.parameters.clone(),
                targets: vec![numbers],
            },
            start_points: StartPoints::Stored {
                object: Digest([0; 32]),
                count: self.starts.len() as u64,
            },
            settings,
            seed: target,
            attempt: 0,
        };
        let find = |_| Some(Arc::clone(&self.starts));
        Ok(PreparedStage::new(&self.system, &stage, &find)?)
    }

    /// How many endpoints there are twice, the exchange counted as nothing.
    fn duplicates(&self, points: &[Vec<Complex64>]) -> usize {
        let listed: Vec<(&[Complex64], f64)> = points.iter().map(|x| (&x[..], SAME)).collect();
        points.len() - self.exchange.orbits(&listed, &self.shape, 1).len()
    }
}

/// The values of the variables where a path ended regularly.
fn endpoint(result: &PathResult) -> Option<Vec<Complex64>> {
    let y = result.endpoint.to_double();
    (result.outcome == PathOutcome::Regular).then(|| y[1..].iter().map(|z| z / y[0]).collect())
}

fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let size = a.iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr());
    (apart.fold(0.0, f64::max) / size).sqrt()
}

/// Real operations of evaluation and elimination for two Newton rounds, which is a step.
fn flops_of_a_step(stage: &PreparedStage) -> [f64; 2] {
    let program = stage.homotopy().program();
    let n = stage.homotopy().dimension() as u64;
    let evaluation = [Program::Jacobian, Program::Linearize].map(|which| {
        let assignments = program.assignments(which);
        assignments
            .iter()
            .map(|a| a.operation.flops())
            .sum::<usize>()
    });
    let elimination = lu::flops(n, 1) + lu::flops(n, 2);
    [evaluation.iter().sum::<usize>() as f64, elimination as f64]
}

fn steps(results: &[PathResult]) -> f64 {
    let evaluations = results.iter().map(|r| f64::from(r.counts.evaluations));
    evaluations.sum::<f64>() / 2.0
}

/// Ten targets, each with all representatives, and each again with a hundred times tighter steps.
fn targets(family: &Family, peak: f64) -> Result<(), Failure> {
    println!(
        "\n{:>6} {:>6} {:>6} {:>8} {:>7} {:>6} {:>10} {:>8} {:>9} {:>9} {:>8} {:>10} {:>9}",
        "target",
        "paths",
        "higher",
        "regular",
        "failed",
        "twice",
        "as tight",
        "differ",
        "steps",
        "paths/s",
        "Gflop/s",
        "% of peak",
        "tight /s"
    );
    let mut rates = Vec::new();
    for target in 1..=10 {
        let stage = family.prepare(target, Settings::default())?;
        let before = cpu_seconds()?;
        let results = stage.track(0..stage.items(), 16);
        let seconds = cpu_seconds()? - before;
        let tighter = Settings {
            predictor_tolerance: 0.01 * Settings::default().predictor_tolerance,
            ..Settings::default()
        };
        let tight = family.prepare(target, tighter)?;
        let before = cpu_seconds()?;
        let tight_results = tight.track(0..tight.items(), 16);
        let seconds_tight = cpu_seconds()? - before;
        let (mut same, mut differ) = (0, 0);
        for (a, b) in results.iter().zip(&tight_results) {
            if let (Some(a), Some(b)) = (endpoint(a), endpoint(b)) {
                match distance(&a, &b) < SAME {
                    true => same += 1,
                    false => differ += 1,
                }
            }
        }
        let points: Vec<_> = results.iter().filter_map(endpoint).collect();
        let failed = results
            .iter()
            .filter(|r| matches!(r.outcome, PathOutcome::Failed(_)))
            .count();
        let higher = results.iter().filter(|r| r.precision_bits > 53).count();
        let count = results.len() as f64;
        let [evaluation, elimination] = flops_of_a_step(&stage);
        let flops = steps(&results) * (evaluation + elimination) / seconds;
        rates.push(count / seconds);
        println!(
            "{target:>6} {:>6} {higher:>6} {:>8} {failed:>7} {:>6} {same:>10} {differ:>8} {:>9.1} {:>9.0} {:>8.1} {:>10.1} {:>9.0}",
            results.len(),
            points.len(),
            family.duplicates(&points),
            steps(&results) / count,
            count / seconds,
            flops * 1e-9,
            100.0 * flops / peak,
            count / seconds_tight,
        );
    }
    rates.sort_by(f64::total_cmp);
    println!(
        "paths/s of one thread: least {:.0}, median {:.0}, most {:.0}",
        rates[0],
        0.5 * (rates[4] + rates[5]),
        rates[9]
    );
    Ok(())
}

/// Sixteen paths at a time, eight, and one.
fn widths(family: &Family) -> Result<(), Failure> {
    let stage = family.prepare(1, Settings::default())?;
    let mut seconds = [f64::INFINITY; 3];
    for _ in 0..ROUNDS {
        for (width, least) in [16, 8, 1].into_iter().zip(&mut seconds) {
            let before = cpu_seconds()?;
            std::hint::black_box(stage.track(0..SHARE, width));
            *least = f64::min(*least, cpu_seconds()? - before);
        }
    }
    let [sixteen, eight, one] = seconds.map(|s| SHARE as f64 / s);
    println!(
        "\npaths/s by width: 16 {sixteen:.0}, 8 {eight:.0}, 1 {one:.0}; 16 to 1: {:.2}",
        sixteen / one
    );
    Ok(())
}

/// Measures the paths on one thread, and half of the paths on each of two threads.
fn threads(family: &Family) -> Result<(), Failure> {
    let stage = family.prepare(1, Settings::default())?;
    let half = SHARE / 2;
    let mut least = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        let before = cpu_seconds()?;
        std::hint::black_box(stage.track(0..half, 16));
        std::hint::black_box(stage.track(half..SHARE, 16));
        least[0] = least[0].min(cpu_seconds()? - before);
        let both = std::thread::scope(|scope| {
            let work = [0..half, half..SHARE].map(|share| {
                let stage = &stage;
                scope.spawn(move || {
                    std::hint::black_box(stage.track(share, 16));
                    cpu_seconds().map_err(|error| error.to_string())
                })
            });
            let mut both = 0.0;
            for thread in work {
                both += thread.join().map_err(|_| "a thread panicked")??;
            }
            Ok::<f64, Failure>(both)
        })?;
        least[1] = least[1].min(both);
    }
    println!(
        "CPU ms of {SHARE} paths: one thread {:.1}, two threads {:.1} together; ratio {:.3}",
        1e3 * least[0],
        1e3 * least[1],
        least[1] / least[0]
    );
    Ok(())
}

/// Eliminates the same matrices again and again.
struct Eliminate<'a> {
    elimination: &'a Elimination,
    matrix: &'a Matrix<Lanes<8>>,
    count: usize,
}

impl Job for Eliminate<'_> {
    type Output = f64;
    #[inline(always)]
    fn run(self) -> f64 {
        let mut exchanges = <Lanes<8> as Real>::from_f64((), 0.0);
        let mut work = self.matrix.clone();
        for _ in 0..self.count {
            for (work, entry) in work.entries.iter_mut().zip(&self.matrix.entries) {
                *work = *entry;
            }
            self.elimination
                .eliminate::<Lanes<8>, 2>(&mut work, &mut exchanges);
        }
        (0..8).map(|lane| exchanges.lane(lane)).sum()
    }
}

/// Measures the nine-point problem with 24 unknowns, of which each equation has few: elimination by lists beside the
/// loop over all entries, and whole paths.
fn rotations_as_unknowns(family: &Family) -> Result<(), Failure> {
    let system = nine_point_with_rotations().system;
    let starts = &family.starts;
    let lifted = (0..starts.len()).flat_map(|k| {
        let point = starts.point(k);
        [point.to_vec(), rotations(point, &family.parameters)].concat()
    });
    let lifted = Arc::new(StoredPoints {
        dimension: 24,
        coordinates: lifted.collect(),
    });
    let mut random = RandomStream::new(1, Purpose::Test, 1);
    let targets = vec![family.parameters.iter().map(|_| random.unit()).collect()];
    let stage = Stage {
        id: StageId(0),
        system: None,
        work: Work::Track,
        homotopy: HomotopyKind::Parameter {
            start: family.parameters.clone(),
            targets,
        },
        start_points: StartPoints::Stored {
            object: Digest([0; 32]),
            count: lifted.len() as u64,
        },
        settings: Settings::default(),
        seed: 1,
        attempt: 0,
    };
    let stage = PreparedStage::new(&system, &stage, &|_| Some(Arc::clone(&lifted)))?;
    // The Jacobians of eight start points, their rows as each way prefers them.
    let program = stage.homotopy().program();
    let mut scratch = Evaluate::<f64>::scratch(program, ());
    let native = |z: &Complex64| Complex { re: z.re, im: z.im };
    let p: Vec<_> = family.parameters.iter().map(native).collect();
    let mut samples = Vec::new();
    for k in 0..8 {
        let x: Vec<_> = lifted.point(500 * k).iter().map(native).collect();
        let mut matrix = Matrix::<f64>::zeros((), 24, 26);
        program.linearize(&x, &p, &p, &mut matrix, &mut scratch);
        samples.push(matrix);
    }
    let in_lanes = |order: &[usize]| {
        let mut lane_matrix = Matrix::<Lanes<8>>::zeros((), 24, 26);
        for (lane, sample) in samples.iter().enumerate() {
            for (i, &row) in order.iter().enumerate() {
                for j in 0..26 {
                    let z = sample.at(row, j);
                    lane_matrix
                        .at_mut(i, j)
                        .set_lane(lane, Complex64::new(z.re, z.im));
                }
            }
        }
        lane_matrix
    };
    let natural: Vec<usize> = (0..24).collect();
    let all_entries = Elimination::new(24, InstructionSet::detect());
    let sides = [
        (stage.homotopy().elimination(), in_lanes(&natural)),
        (&all_entries, in_lanes(&lu::pivot_order(&samples))),
    ];
    let mut least = [f64::INFINITY; 2];
    let count = 2000;
    for _ in 0..ROUNDS {
        for ((elimination, matrix), least) in sides.iter().zip(&mut least) {
            let before = cpu_seconds()?;
            std::hint::black_box(dispatch(Eliminate {
                elimination,
                matrix,
                count,
            }));
            *least = f64::min(*least, cpu_seconds()? - before);
        }
    }
    let [lists, full_elimination] = least.map(|s| 1e9 * s / (8 * count) as f64);
    println!(
        "elimination with 24 unknowns, ns a path: lists {lists:.0}, all entries {full_elimination:.0}; ratio {:.2}",
        full_elimination / lists
    );
    let seconds = best(|| {
        std::hint::black_box(stage.track(0..SHARE, 8));
    })?;
    println!("paths/s with 24 unknowns: {:.0}", SHARE as f64 / seconds);
    Ok(())
}

fn main() -> Result<(), Failure> {
    println!("instruction set: {}", InstructionSet::detect().name());
    let peak = peak()?;
    println!(
        "fused multiply-adds: {:.1} Gflop/s on one core",
        peak * 1e-9
    );
    let family = Family::read()?;
    let before = cpu_seconds()?;
    let stage = family.prepare(1, Settings::default())?;
    let [evaluation, elimination] = flops_of_a_step(&stage);
    println!(
        "a stage is prepared in {:.1} ms; flops of a step: {evaluation} evaluation, {elimination} elimination",
        1e3 * (cpu_seconds()? - before)
    );
    let only = std::env::args()
        .nth(1)
        .filter(|word| !word.starts_with("--"));
    let wanted = |part: &str| only.as_ref().is_none_or(|only| only == part);
    if wanted("widths") {
        widths(&family)?;
    }
    if wanted("threads") {
        threads(&family)?;
    }
    if wanted("rotations") {
        rotations_as_unknowns(&family)?;
    }
    if wanted("targets") {
        targets(&family, peak)?;
    }
    Ok(())
}
