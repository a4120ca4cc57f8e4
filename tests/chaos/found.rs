//! Found: observations of a run, and whether they keep the promises.

use crate::fault::Fault;
use crate::scene::{CHUNK, PROMISED, WORKERS};
use crate::wanted::Wanted;
use std::process::ExitCode;
use std::time::Duration;

/// Longest time that a fault may take beyond the length of a lease, on any machine.
const GOES_ON: Duration = Duration::from_secs(30);

/// Observations of a run.
pub struct Found {
    /// How long it took.
    pub took: Duration,
    /// Jobs that were solved.
    pub jobs: u64,
    /// Paths of all these jobs.
    pub paths: u64,
    /// Every fault, with the time until work went on.
    pub faults: Vec<(Fault, Duration)>,
    /// Logs of the honest workers.
    pub logs: Vec<String>,
    /// How many workers did evil.
    pub evil: usize,
    /// Faults in the treatment of evil workers.
    pub unnamed: Vec<String>,
    /// How many results were damaged or lost.
    pub spoilt: usize,
    /// How many jobs have no list of paths because of it, and say so.
    pub without_paths: usize,
}

/// How many paths the workers began, by their logs.
fn begun(logs: &[String]) -> u64 {
    let range = |line: &str| -> Option<u64> {
        let items = line.split("items=").nth(1)?.split_whitespace().next()?;
        let (first, end) = items.split_once("..")?;
        Some(end.parse::<u64>().ok()? - first.parse::<u64>().ok()?)
    };
    let lines = logs.iter().flat_map(|log| log.lines());
    let lines = lines.filter(|line| line.contains("tracking lease="));
    lines.filter_map(range).sum()
}

/// Prints it, and says whether all was as promised.
pub fn report(wanted: &Wanted, run: &Found) -> ExitCode {
    let Found {
        took,
        jobs,
        paths,
        faults,
        logs,
        evil,
        unnamed,
        spoilt,
        without_paths,
    } = run;
    let paths = *paths;
    let ledger = if wanted.postgres {
        "PostgreSQL"
    } else {
        "SQLite"
    };
    println!(
        "\nChaos on {ledger}, {} coordinator(s), seed {}, {:.0} s",
        wanted.coordinators,
        wanted.seed,
        took.as_secs_f64()
    );
    println!("  {jobs} jobs, {paths} paths: each answer as without faults, bit for bit");
    for kind in Fault::ALL {
        let mut times: Vec<_> = faults.iter().filter(|f| f.0 == kind).map(|f| f.1).collect();
        times.sort_unstable();
        if let Some(longest) = times.last() {
            println!(
                "  {:>3} x {kind}: work went on after {:.2} s (median), {:.2} s (longest)",
                times.len(),
                times[times.len() / 2].as_secs_f64(),
                longest.as_secs_f64()
            );
        }
    }
    let begun = begun(logs);
    let retracked = begun.saturating_sub(paths);
    // Each worker holds two chunks; every fault may cost all that are held.
    let held = 2 * WORKERS as u64 * CHUNK;
    let bound = faults.len() as u64 * held + paths / 100;
    println!(
        "  {retracked} paths tracked again, {:.1} a fault; at most {bound} expected",
        retracked as f64 / faults.len().max(1) as f64
    );
    let promised = wanted.lease + PROMISED;
    let later = faults.iter().filter(|(_, time)| *time > promised).count();
    println!(
        "  {later} of {} faults took longer than {promised:?}",
        faults.len()
    );
    let limit = wanted.lease + GOES_ON;
    let late = faults.iter().filter(|(_, time)| *time > limit).count();
    if *evil > 0 {
        println!(
            "  {evil} workers that did evil; {} not named",
            unnamed.len()
        );
    }
    if *spoilt > 0 {
        println!(
            "  {spoilt} results damaged or lost; of {without_paths} jobs the paths cannot be listed, which is said"
        );
    }
    let mut broken = unnamed.clone();
    if late > 0 {
        broken.push(format!("{late} faults took longer than {limit:?}"));
    }
    if later > faults.len() / 2 {
        broken.push(format!(
            "most of {} faults took longer than {promised:?}",
            faults.len()
        ));
    }
    // Paths that are tracked again because of evil workers or damaged results are allowed.
    let counts = !wanted.evil_workers && !wanted.storage_faults;
    if counts && retracked > bound {
        broken.push(format!("{retracked} paths were tracked again"));
    }
    if counts && begun < paths {
        broken.push(format!(
            "the logs show {begun} paths that were begun, of {paths}"
        ));
    }
    for what in &broken {
        println!("  NOT AS PROMISED: {what}");
    }
    match broken.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    }
}
