//! Mixed cells: the cost of enumerating them in branches, against the whole at once.
//!
//! `cargo bench -p cognate-tests --bench mixed_cells [-- N [SEED]]`, in tests/: cyclic-N, 11 unless
//! told. Cells that differ are counted as a failure. Results: `end_to_end.md`.

use cognate_continuation::start_systems::polyhedral::affine_supports;
use cognate_continuation::start_systems::polyhedral::branches::{
    BRANCHES, BranchCount, BranchedCells,
};
use cognate_continuation::start_systems::polyhedral::mixed_cells::{MixedCell, mixed_cells};
use cognate_systems::named::cyclic;
use cognate_systems::polynomial::supports;
use cognate_systems::transform::clear_denominators::nonzero_variables;
use cognate_tests::measures::{cpu_seconds, memory_bytes};
use std::process::ExitCode;

type Failure = Box<dyn std::error::Error>;

/// The most memory that this process ever had, in MiB.
fn most_memory() -> Result<u64, Failure> {
    Ok(memory_bytes("self", "VmHWM")? >> 20)
}

fn main() -> ExitCode {
    match measure() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Sorts by size; gives the sum, the share of the largest in percent, and that of the largest 16.
fn shares(mut parts: Vec<f64>) -> (f64, f64, f64) {
    parts.sort_by(|a, b| b.total_cmp(a));
    let sum: f64 = parts.iter().sum();
    let most = |n: usize| 100.0 * parts.iter().take(n).sum::<f64>() / sum;
    (sum, most(1), most(16))
}

fn measure() -> Result<bool, Failure> {
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let n: usize = arguments.next().map_or(Ok(11), |n| n.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |n| n.parse())?;
    let system = cyclic(n).system;
    let supports = supports(&system).ok_or("no polynomials")?;
    let supports = affine_supports(&supports, &nonzero_variables(&system));
    println!("cyclic-{n}, seed {seed}; {} MiB before", most_memory()?);

    let begun = cpu_seconds()?;
    let branches = BranchedCells::new(&supports, seed, 0)?.ok_or("a tie")?;
    let opened = cpu_seconds()?;
    println!(
        "open cells: {:.2} s, {} MiB",
        opened - begun,
        most_memory()?
    );
    let (mut times, mut volumes, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut mark = opened;
    for branch in 0..BRANCHES {
        let BranchCount::Counted(counted) = branches.count(branch) else {
            return Err(format!("branch {branch} is not counted").into());
        };
        let cpu = cpu_seconds()?;
        times.push(cpu - mark);
        mark = cpu;
        volumes.push(counted.volume as f64);
        numbers.push(counted.cells as f64);
    }
    let most = most_memory()?;
    let (seconds, largest, sixteen) = shares(times);
    println!(
        "counting: {seconds:.2} s, {most} MiB; the longest branch {largest:.2} % of it, sixteen {sixteen:.1} %"
    );
    let (volume, largest, sixteen) = shares(volumes);
    println!("mixed volume {volume}; the largest branch {largest:.2} %, sixteen {sixteen:.1} %");
    let (cells, largest, sixteen) = shares(numbers);
    println!("{cells} cells; the largest branch {largest:.2} %, sixteen {sixteen:.1} %");

    let begun = cpu_seconds()?;
    let whole = match mixed_cells(&supports, seed, u64::MAX) {
        Ok(whole) => whole,
        Err(error) => {
            let seconds = cpu_seconds()? - begun;
            println!("the whole: {error} in {seconds:.2} s");
            return Ok(true);
        }
    };
    println!(
        "the whole: {:.2} s, {} MiB; {} cells, mixed volume {}",
        cpu_seconds()? - begun,
        most_memory()?,
        whole.cells.len(),
        whole.mixed_volume
    );
    let mut together: Vec<MixedCell> = Vec::new();
    for branch in 0..BRANCHES {
        together.extend(branches.cells(branch).ok_or("a branch without cells")?);
    }
    together.sort_unstable();
    let same = together == whole.cells;
    println!("the same cells: {same}");
    Ok(same)
}
