//! `cognate decompose`: every irreducible component of every dimension.
//!
//! Stages are tracked in this process, on as many threads as it has cores.

use crate::client::arguments::{Decompose, Format};
use crate::client::error::{ClientError, Exit};
use crate::client::output;
use crate::client::output::decomposition;
use crate::client::output::text::Look;
use crate::client::problem;
use crate::coordinator::NewProblem;
use crate::intake;
use crate::jobs::planning::plan_options;
use crate::results::decomposition::{
    DecomposedProblem, DecompositionBlock, DecompositionSummary, PathBlock,
};
use crate::results::summary::TimeBlock;
use cognate_algorithms::Opening;
use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve};
use cognate_algorithms::run_locally::drive;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_protocol::digest;
use cognate_solutions::witness::Decomposition;
use cognate_systems::system::System;
use cognate_worker::chunk_runner::{ChunkEnd, ChunkRunner, ChunkTracker};
use std::collections::HashMap;
use std::fmt::Display;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Decomposes and shows.
pub fn run(a: &Decompose) -> Result<Exit, ClientError> {
    let began = Instant::now();
    let prepared = problem::prepare(&a.problem())?;
    let name = prepared.name.clone();
    let wrong = |e: &dyn Display| ClientError::Input {
        origin: name.clone(),
        message: e.to_string(),
    };
    let taken = intake::take(prepared.submission).map_err(|e| wrong(&e))?;
    let options = options(a, &taken, &wrong)?;
    for warning in &taken.warnings {
        eprintln!("warning: {warning}");
    }
    let solve = DecompositionSolve::new(&taken.system, &options).map_err(|e| wrong(&e))?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = a.threads.map_or(cores, |n| n as usize);
    let mut tracking = Tracking::new(threads)?;
    let found = tracking.decompose(&taken.system, solve)?;
    let wall_seconds = began.elapsed().as_secs_f64();
    let summary = DecompositionSummary {
        job: String::new(),
        problem: DecomposedProblem {
            name: taken.options.name.clone(),
            digest: digest::of_system(&taken.system).to_string(),
            variables: taken.system.variable_count() as u64,
            equations: taken.system.equation_count() as u64,
            method: "cascade".into(),
            seed: options.seed,
        },
        decomposition: DecompositionBlock::new(&found),
        paths: PathBlock {
            superset: found.paths,
            loops: found.paths_of_loops,
        },
        time: TimeBlock {
            wall_seconds,
            cpu_seconds: tracking.cpu.as_secs_f64(),
            tracking_cpu_seconds: tracking.cpu.as_secs_f64(),
            paths_per_second: tracking.items as f64 / wall_seconds.max(0.001),
        },
        workers: Vec::new(),
        settled: found.settled(),
        warnings: taken.warnings.clone(),
    };
    show(a, &summary, &found, &taken.system)
}

/// What the arguments and the file say about how the system is decomposed.
fn options(
    a: &Decompose,
    taken: &NewProblem,
    wrong: &dyn Fn(&dyn Display) -> ClientError,
) -> Result<DecompositionOptions, ClientError> {
    let plan = plan_options(&taken.options, None).map_err(|e| wrong(&e))?;
    let parameters = match plan.target_parameters.as_slice() {
        [] => Vec::new(),
        [values] => values.clone(),
        several => {
            let message = format!("holds {} sets of parameters; expected one", several.len());
            return Err(ClientError::Input {
                origin: "--target-parameters".into(),
                message,
            });
        }
    };
    let default = DecompositionOptions::default();
    Ok(DecompositionOptions {
        seed: plan.seed,
        parameters,
        dimensions: a.dimension.map(|d| d.lowest..=d.highest),
        settings: plan.settings,
        tolerances: plan.tolerances,
        max_retries: plan.max_retries,
        idle_loops: a.loops.unwrap_or(default.idle_loops),
        ..default
    })
}

/// Threads that track, and what they did.
struct Tracking {
    runner: ChunkRunner,
    objects: HashMap<Digest, Arc<StoredPoints>>,
    cpu: Duration,
    items: u64,
}

impl Tracking {
    fn new(threads: usize) -> Result<Self, ClientError> {
        let runner = ChunkRunner::new(threads, None);
        let runner =
            runner.map_err(|e| ClientError::Local(format!("threads could not be started: {e}")))?;
        Ok(Self {
            runner,
            objects: HashMap::new(),
            cpu: Duration::ZERO,
            items: 0,
        })
    }

    fn decompose(
        &mut self,
        system: &System,
        mut solve: DecompositionSolve,
    ) -> Result<Decomposition, ClientError> {
        drive(&mut solve, &mut |opening| self.stage(system, opening))?;
        let found = solve.decomposition().cloned();
        found.ok_or_else(|| ClientError::Local("the decomposition ended without an answer".into()))
    }

    fn stage(
        &mut self,
        system: &System,
        opening: &Opening,
    ) -> Result<Vec<PathResult>, ClientError> {
        let made = opening.objects.iter();
        self.objects
            .extend(made.map(|points| (points.digest(), Arc::clone(points))));
        let find = |wanted: Digest| self.objects.get(&wanted).cloned();
        let system = opening.system.as_deref().unwrap_or(system);
        let prepared = PreparedWork::new(system, &opening.stage, &find);
        let prepared = prepared
            .map_err(|e| ClientError::Local(format!("a stage could not be prepared: {e}")))?;
        let items = ChunkTracker::items(&prepared);
        match self.runner.run(Arc::new(prepared), 0..items) {
            ChunkEnd::Tracked(chunk) => {
                self.cpu += chunk.cpu;
                self.items += items;
                Ok(chunk.results)
            }
            ChunkEnd::Panicked(message) => Err(ClientError::Local(message)),
            ChunkEnd::Abandoned => Err(ClientError::Interrupted),
        }
    }
}

fn show(
    a: &Decompose,
    summary: &DecompositionSummary,
    found: &Decomposition,
    system: &System,
) -> Result<Exit, ClientError> {
    if let Some(folder) = &a.output {
        decomposition::write(folder, summary, found, &system.variables)?;
    }
    let text = match a.format {
        Format::Json => format!("{}\n", String::from_utf8_lossy(&summary.to_json())),
        Format::Table => {
            let look = Look::of_standard_output();
            decomposition::table(summary, a.output.as_deref(), look)
        }
    };
    output::print(&text)?;
    Ok(decomposition::exit(summary))
}
