//! Cost of checking the results of workers at a coordinator, beside the cost of finding them at the workers.
//!
//! `cargo bench -p cognate-tests --bench result_checks [-- CHUNKS [SYSTEM...]]`, in tests/. Each stage of a few solves
//! is done as a worker does it, cut into CHUNKS chunks (32 by default), and each chunk is checked as a coordinator
//! checks it. SYSTEM is a folder of `decomposition/systems`. CPU seconds of one thread, the mean of several rounds,
//! both sides within this run. Results in doubt are done again, up to four of a chunk, as a coordinator does; all are
//! honest here. Results: `../../deploy/security.md`.

use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve};
use cognate_algorithms::run_locally::drive;
use cognate_algorithms::solve::Root;
use cognate_algorithms::{PathAlgorithm, SolveOptions, plan};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_check::PreparedCheck;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StartPoints, StoredPoints};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::formats::points::read_parameters;
use cognate_systems::named::{cyclic, katsura, nine_point};
use cognate_systems::system::System;
use cognate_tests::measures::cpu_seconds;
use cognate_tests::systems::from_file;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

type Failure = Box<dyn std::error::Error>;

/// Results in doubt that a coordinator does itself, of one chunk (`arbitration::MOST_RULED`).
const MOST_RULED: usize = 4;
/// Rounds: the clock of CPU time may tick every 4 ms only.
const ROUNDS: u32 = 10;
/// Paths of the family of nine points.
const NINE_POINT_PATHS: u64 = 1440;

/// CPU seconds of all stages of a solve, and the number of results in doubt.
#[derive(Default)]
struct Costs {
    /// Workers: compiling the stages, doing the items.
    working: f64,
    /// The coordinator: compiling the stages for checks.
    compiling: f64,
    /// The coordinator: checking all results.
    checking: f64,
    /// The coordinator: doing items in doubt.
    repeating: f64,
    stages: u64,
    items: u64,
    doubts: usize,
}

/// Result of `work`, and the CPU seconds that it takes: the mean of all rounds.
fn timed<T>(mut work: impl FnMut() -> T) -> Result<(T, f64), Failure> {
    let begun = cpu_seconds()?;
    for _ in 1..ROUNDS {
        std::hint::black_box(work());
    }
    let value = work();
    Ok((value, (cpu_seconds()? - begun) / f64::from(ROUNDS)))
}

impl Costs {
    /// Does a stage in chunks, and checks them.
    fn add_stage(
        &mut self,
        system: &System,
        stage: &Stage,
        find: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
        chunks: u64,
    ) -> Result<Vec<ItemResult>, Failure> {
        let (prepared, compiling) = timed(|| PreparedWork::new(system, stage, find))?;
        let prepared = prepared?;
        let items = prepared.items();
        self.stages += 1;
        self.items += items;
        let size = items.div_ceil(chunks).max(1);
        let starts = (0..items).step_by(usize::try_from(size)?);
        let ranges: Vec<_> = starts.map(|first| first..items.min(first + size)).collect();
        let width = prepared.preferred_width();
        let (results, working) = timed(|| {
            let chunks = ranges.iter();
            let chunks = chunks.map(|range| prepared.run(range.clone(), width));
            chunks.collect::<Vec<_>>()
        })?;
        self.working += compiling + working;
        if stage.work.has_checkable_results() && items > 0 {
            let (check, compiling) = timed(|| PreparedCheck::new(system, stage, find))?;
            let check = check?;
            let (doubtful, checking) = timed(|| {
                let chunks = ranges.iter().zip(&results);
                let places = chunks.map(|(range, results)| check.doubtful(range.start, results));
                places.collect::<Vec<_>>()
            })?;
            let (_, repeating) = timed(|| {
                for (range, places) in ranges.iter().zip(&doubtful) {
                    for place in places.iter().take(MOST_RULED) {
                        let item = range.start + *place as u64;
                        std::hint::black_box(prepared.run(item..item + 1, 1));
                    }
                }
            })?;
            self.compiling += compiling;
            self.checking += checking;
            self.repeating += repeating;
            self.doubts += doubtful.iter().map(Vec::len).sum::<usize>();
        }
        Ok(results.into_iter().flatten().collect())
    }

    fn show(&self, name: &str) {
        let checks = self.compiling + self.checking + self.repeating;
        println!(
            "{name:24} {:>6} {:>8} {:>10.4} {:>10.4} {:>10.4} {:>10.4} {:>8} {:>7.2} %",
            self.stages,
            self.items,
            self.working,
            self.compiling,
            self.checking,
            self.repeating,
            self.doubts,
            100.0 * checks / self.working
        );
    }
}

/// The whole of an algorithm.
fn solve(
    system: &System,
    algorithm: &mut dyn PathAlgorithm,
    chunks: u64,
) -> Result<Costs, Failure> {
    let mut costs = Costs::default();
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    drive::<Failure, _>(algorithm, &mut |opening| {
        let made = opening.objects.iter();
        objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
        let find = |digest: Digest| objects.get(&digest).cloned();
        let system = opening.system.as_deref().unwrap_or(system);
        costs.add_stage(system, &opening.stage, &find, chunks)
    })?;
    Ok(costs)
}

/// The solutions of a system, with boxes or digits where they are asked.
fn solutions(system: &System, certify: bool, chunks: u64) -> Result<Costs, Failure> {
    let mut options = SolveOptions {
        seed: 1,
        ..SolveOptions::default()
    };
    options.closings.certify = certify;
    let mut planned = plan(system, &options)?;
    solve(&planned.system, &mut planned.algorithm, chunks)
}

/// From one member of the family of nine points to another.
fn nine_points(chunks: u64) -> Result<Costs, Failure> {
    let mut system = nine_point().system;
    system.symmetry.clear();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../deploy/families/nine_point");
    let starts = StoredPoints::from_bytes(&std::fs::read(folder.join("solutions.points"))?)?;
    let starts = Arc::new(starts);
    let text = std::fs::read(folder.join("parameters.json"))?;
    let members = read_parameters("parameters.json", &text, &system.parameters)?;
    let start = members.into_iter().next().ok_or("no parameters")?;
    let mut random = RandomStream::new(1, Purpose::Test, 1);
    let target = start.iter().map(|_| random.unit()).collect();
    let stage = Stage {
        id: StageId(0),
        system: None,
        work: Work::Track,
        homotopy: HomotopyKind::Parameter {
            start,
            targets: vec![target],
        },
        start_points: StartPoints::Selected {
            base: Box::new(StartPoints::Stored {
                object: Digest([0; 32]),
                count: starts.len() as u64,
            }),
            indices: (0..NINE_POINT_PATHS).collect(),
        },
        settings: Settings::default(),
        seed: 1,
        attempt: 0,
    };
    let mut costs = Costs::default();
    costs.add_stage(&system, &stage, &|_| Some(Arc::clone(&starts)), chunks)?;
    Ok(costs)
}

/// The components of a system.
fn components(name: &str, chunks: u64) -> Result<Costs, Failure> {
    let system = from_file(
        &format!("../decomposition/systems/{name}"),
        "system.bertini",
    );
    let solve_of_components = DecompositionSolve::new(&system, &DecompositionOptions::default())?;
    solve(&system, &mut Root::new(solve_of_components), chunks)
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let chunks: u64 = arguments.next().map_or(Ok(32), |n| n.parse())?;
    let systems: Vec<String> = arguments.collect();
    println!("CPU seconds; {chunks} chunks a stage");
    println!(
        "{:24} {:>6} {:>8} {:>10} {:>10} {:>10} {:>10} {:>8} {:>9}",
        "solve",
        "stages",
        "items",
        "work",
        "compiling",
        "checking",
        "repeating",
        "doubts",
        "checks"
    );
    if systems.is_empty() {
        nine_points(chunks)?.show("nine points");
        solutions(&katsura(12).system, false, chunks)?.show("katsura-12");
        solutions(&cyclic(7).system, false, chunks)?.show("cyclic-7");
        components("seven_bar_roberts", chunks)?.show("seven_bar_roberts");
        solutions(&katsura(10).system, true, chunks)?.show("katsura-10, certified");
    }
    for name in &systems {
        components(name, chunks)?.show(name);
    }
    Ok(())
}
