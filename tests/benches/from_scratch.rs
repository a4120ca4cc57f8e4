//! A random sample of the paths of a start system: their ends, their rungs, their time.
//!
//! `cargo bench -p cognate-tests --bench from_scratch -- FILE PARAMETERS|- [COUNT|@LIST|all] [SEED] [BITS] [SOLUTIONS]`,
//! in tests/. LIST is a file of path indices. CPU seconds of one thread; BITS is the highest precision that paths may use. With
//! `all` the whole solve, on two threads, each path tracked again at most RETRIES times (a variable of
//! the environment); its solutions go to the file SOLUTIONS. Results: `from_scratch.md`.

use cognate_algorithms::plan::SolveMethod;
use cognate_algorithms::run_locally::drive;
use cognate_algorithms::{Next, PathAlgorithm, Plan, SolveOptions, plan};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::stage::PreparedStage;
use cognate_continuation::start_points::{Digest, StartPoints};
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::{Tolerances, classify};
use cognate_solutions::degenerate::lies_in;
use cognate_solutions::point_shape::PointShape;
use cognate_systems::formats::points::read_parameters;
use cognate_systems::system::System;
use cognate_tests::measures::cpu_seconds;
use num_complex::Complex64;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

/// The paths that are tracked.
enum Selection {
    /// The whole solve.
    WholeSolve,
    /// The paths whose indices stand in a file.
    Listed(String),
    /// A random sample; the number of its paths.
    Random(u64),
}

/// The command line.
struct Arguments {
    file: String,
    /// File of the parameters' values; `-` for none.
    values: String,
    selection: Selection,
    seed: u64,
    bits: u64,
    /// File for the solutions of a whole solve.
    solutions: Option<String>,
}

impl Arguments {
    fn read() -> Result<Self, Failure> {
        let arguments: Vec<String> = std::env::args()
            .skip(1)
            .filter(|a| a != "--bench")
            .collect();
        let file = arguments.first().ok_or("FILE is missing")?;
        let values = arguments.get(1).map_or("-", |s| s);
        let number = |k: usize, default: u64| arguments.get(k).map_or(Ok(default), |s| s.parse());
        let selection = match arguments.get(2).map(String::as_str) {
            Some("all") => Selection::WholeSolve,
            Some(count) if count.starts_with('@') => Selection::Listed(count[1..].to_owned()),
            _ => Selection::Random(number(2, 500)?),
        };
        Ok(Self {
            file: file.clone(),
            values: values.to_owned(),
            selection,
            seed: number(3, 1)?,
            bits: number(4, 1024)?,
            solutions: arguments.get(5).cloned(),
        })
    }

    /// Options of the solve for a system that is read from the file.
    fn solve_options(&self, system: &System) -> Result<SolveOptions, Failure> {
        let mut options = SolveOptions {
            method: SolveMethod::Multihomogeneous,
            seed: self.seed,
            ..SolveOptions::default()
        };
        if self.values != "-" {
            let content = std::fs::read(&self.values)?;
            options.target_parameters =
                read_parameters(&self.values, &content, &system.parameters)?;
        }
        options.tracking.settings.max_precision_bits = self.bits as u32;
        if let Ok(n) = std::env::var("RETRIES") {
            options.tracking.max_retries = n.parse()?;
        }
        Ok(options)
    }
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read()?;
    let file = &arguments.file;
    let system = cognate_systems::formats::read(file, &std::fs::read(file)?)?.system;
    let options = arguments.solve_options(&system)?;
    let mut planned = plan(&system, &options)?;
    if let Selection::WholeSolve = arguments.selection {
        return whole(&mut planned, arguments.solutions.as_ref());
    }
    let Next::Open(opening) = PathAlgorithm::next(&mut planned.algorithm) else {
        return Err("no first stage".into());
    };
    let mut stage = opening.stage;
    let total = planned.paths.ok_or("its paths are not counted yet")?;
    let indices = path_indices(&arguments.selection, total, arguments.seed)?;
    stage.start_points = StartPoints::Selected {
        base: Box::new(stage.start_points.clone()),
        indices: indices.into_iter().collect(),
    };
    let before = cpu_seconds()?;
    let prepared = PreparedStage::new(&planned.system, &stage, &|_| None)?;
    println!(
        "{total} paths; prepared in {:.2} s",
        cpu_seconds()? - before
    );
    let before = cpu_seconds()?;
    let parameters = options
        .target_parameters
        .first()
        .cloned()
        .unwrap_or_default();
    let results = prepared.track(0..prepared.items(), 16);
    let seconds = cpu_seconds()? - before;
    print_kinds(
        &kinds(&results, &planned.system, &parameters),
        results.len(),
    );
    println!(
        "{} paths in {seconds:.2} s: {:.1} paths/s; all {total}: {:.1} CPU minutes",
        results.len(),
        results.len() as f64 / seconds,
        total as f64 * seconds / results.len() as f64 / 60.0
    );
    Ok(())
}

/// Indices of the selected paths among all paths of the start system.
fn path_indices(selection: &Selection, total: u64, seed: u64) -> Result<BTreeSet<u64>, Failure> {
    let mut stream = RandomStream::new(seed, Purpose::Test, 0);
    let mut indices = BTreeSet::new();
    match selection {
        Selection::WholeSolve => {}
        Selection::Listed(list) => {
            for index in std::fs::read_to_string(list)?.split_whitespace() {
                indices.insert(index.parse()?);
            }
        }
        Selection::Random(count) => {
            while (indices.len() as u64) < (*count).min(total) {
                indices.insert(stream.below(total));
            }
        }
    }
    Ok(indices)
}

/// Paths that ended alike, by the name of the end: verdict, outcome, named sets, precision.
fn kinds(
    results: &[PathResult],
    system: &System,
    parameters: &[Complex64],
) -> BTreeMap<String, Kind> {
    let shape = PointShape::of(system);
    let tolerances = Tolerances::default();
    let mut kinds: BTreeMap<String, Kind> = BTreeMap::new();
    for result in results {
        let decision = classify(result, &shape, &tolerances);
        let mut name = match result.outcome {
            PathOutcome::Failed(why) => format!("failed: {why:?}"),
            outcome => format!("{:?} {outcome:?}", decision.verdict),
        };
        if !matches!(
            result.outcome,
            PathOutcome::Failed(_) | PathOutcome::Diverging
        ) {
            let variables = shape.to_variables(result.endpoint.to_double());
            for (set, what) in &system.degenerate {
                if lies_in(
                    what,
                    system,
                    parameters,
                    &variables,
                    result.accuracy,
                    &tolerances,
                ) {
                    name += &format!(" [{set}]");
                }
            }
        }
        name += &format!(" {} bits", result.precision_bits);
        kinds.entry(name).or_default().add(result);
    }
    kinds
}

/// Prints shares and mean costs of each kind of end among `tracked` paths.
fn print_kinds(kinds: &BTreeMap<String, Kind>, tracked: usize) {
    println!(
        "{:>60} {:>6} {:>7} {:>8} {:>8} {:>7} winding",
        "end", "paths", "share", "steps", "rejected", "turns"
    );
    for (name, kind) in kinds {
        let paths = kind.paths as f64;
        println!(
            "{name:>60} {:>6} {:>6.2}% {:>8.0} {:>8.0} {:>7.1} {:?}",
            kind.paths,
            100.0 * paths / tracked as f64,
            kind.steps as f64 / paths,
            kind.rejections as f64 / paths,
            kind.turns as f64 / paths,
            kind.windings,
        );
    }
}

/// Two threads follow this many paths at a time.
const CHUNK: u64 = 64;

/// The whole solve, on two threads.
fn whole(planned: &mut Plan, solutions: Option<&String>) -> Result<(), Failure> {
    let begun = Instant::now();
    let system = &planned.system;
    drive::<Failure, _>(&mut planned.algorithm, &mut |opening| {
        let made = |wanted: Digest| {
            let mut objects = opening.objects.iter();
            objects.find(|points| points.digest() == wanted).cloned()
        };
        let stage = PreparedWork::new(system, &opening.stage, &made)?;
        let next = AtomicU64::new(0);
        let track = || {
            let mut chunks = Vec::new();
            loop {
                let first = next.fetch_add(CHUNK, Ordering::Relaxed);
                if first >= stage.items() {
                    return chunks;
                }
                let end = stage.items().min(first + CHUNK);
                chunks.push((first, stage.run(first..end, 16)));
                if first.is_multiple_of(64 * CHUNK) {
                    println!(
                        "{end} of {}, {:.0} s",
                        stage.items(),
                        begun.elapsed().as_secs_f64()
                    );
                }
            }
        };
        let mut chunks = std::thread::scope(|scope| {
            let threads = [(); 2].map(|()| scope.spawn(track));
            let joined = threads.map(|thread| thread.join().map_err(|_| "a thread panicked"));
            joined.into_iter().flatten().flatten().collect::<Vec<_>>()
        });
        chunks.sort_by_key(|(first, _)| *first);
        let (id, work) = (opening.stage.id.0, opening.stage.work);
        println!(
            "stage {id}, {work:?}: {} items, {:.1} s since the beginning",
            stage.items(),
            begun.elapsed().as_secs_f64()
        );
        Ok(chunks
            .into_iter()
            .flat_map(|(_, results)| results)
            .collect())
    })?;
    let sets = PathAlgorithm::solution_sets(&planned.algorithm, system);
    for set in &sets {
        println!("{}", serde_json::to_string_pretty(&set.paths)?);
        println!("{}", serde_json::to_string_pretty(&set.counts)?);
        println!("{}", serde_json::to_string_pretty(&set.classes)?);
        set.warnings
            .iter()
            .for_each(|warning| println!("{warning}"));
        if let Some(file) = solutions {
            let mut lines = String::new();
            for solution in &set.solutions {
                let variables = solution.variables.0.iter();
                let variables: serde_json::Map<_, _> = variables
                    .map(|v| (v.name.clone(), serde_json::json!([v.value.re, v.value.im])))
                    .collect();
                let line =
                    serde_json::json!({"variables": variables, "singular": solution.singular});
                lines += &format!("{line}\n");
            }
            std::fs::write(file, lines)?;
        }
    }
    println!("{:.1} s in all", begun.elapsed().as_secs_f64());
    Ok(())
}

/// Paths that ended alike.
#[derive(Default)]
struct Kind {
    paths: u64,
    steps: u64,
    rejections: u64,
    turns: u64,
    windings: BTreeMap<u32, u64>,
}

impl Kind {
    fn add(&mut self, result: &PathResult) {
        self.paths += 1;
        self.steps += u64::from(result.counts.steps);
        self.rejections += u64::from(result.counts.rejections);
        self.turns += u64::from(result.counts.turns);
        if let Some(winding) = result.winding_number {
            *self.windings.entry(winding).or_default() += 1;
        }
    }
}
