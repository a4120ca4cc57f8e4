//! Planted: random systems whose exact answer is known by construction, solved and compared.
//!
//! `cargo run --release -p cognate-tests --bin planted -- [--count 1700] [--first 0] [--seed 1] [--seconds 10] [--kind NAME] [--exact-count yes|no] [--folder PATH]`
//!
//! Prints a report page. A wrong answer that is called settled is named with its seed and makes the
//! exit code 1; `--folder` receives the text of each system that was not answered right. Each system is
//! solved by a process of its own (`--one NUMBER`), so that a path without end is stopped after
//! `--seconds` of CPU time; a process that breaks is named like a silent error. `--first` begins at a later
//! system of the series: a run that was stopped goes on there.

use cognate_algorithms::plan::SolveMethod;
use cognate_tests::arguments::{number, options, or_exit};
use cognate_tests::dice::Dice;
use cognate_tests::measures::process_cpu_seconds;
use cognate_tests::planted::kinds::{KINDS, planted};
use cognate_tests::planted::verdict::{Verdict, options as solve_options, solve, start};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

/// Settings of the program.
struct Wanted {
    first: u64,
    count: u64,
    seed: u64,
    seconds: u64,
    kind: Option<String>,
    folder: Option<PathBuf>,
    one: Option<u64>,
    no_exact_count: bool,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        first: 0,
        count: 100 * KINDS.len() as u64,
        seed: 1,
        seconds: 10,
        kind: None,
        folder: None,
        one: None,
        no_exact_count: false,
    };
    for (word, value) in options()? {
        match word.as_str() {
            "--first" => wanted.first = number(&word, &value)?,
            "--count" => wanted.count = number(&word, &value)?,
            "--seed" => wanted.seed = number(&word, &value)?,
            "--seconds" => wanted.seconds = number(&word, &value)?,
            "--kind" => wanted.kind = Some(value),
            "--one" => wanted.one = Some(number(&word, &value)?),
            "--exact-count" => wanted.no_exact_count = value == "no",
            "--folder" => wanted.folder = Some(value.into()),
            _ => {
                return Err(format!(
                    "{word}: expected --count N, --first N, --seed N, --seconds N, --kind NAME, --exact-count yes|no or --folder PATH"
                ));
            }
        }
    }
    Ok(wanted)
}

/// How many systems of one kind got which verdict.
#[derive(Default)]
struct Tally {
    right: u64,
    in_doubt: u64,
    doubt: u64,
    silent: u64,
    no_end: u64,
    refused: u64,
    seconds: f64,
    longest: f64,
}

/// The start and the seed with which a system of a series is solved.
fn throw(series: u64, number: u64) -> (SolveMethod, u64) {
    let mut dice = Dice(series ^ number.rotate_left(20));
    let start = start(&mut dice);
    (start, dice.below(1 << 32))
}

/// Solves one system in this process and prints the verdict: a word, and the faults.
fn solve_one(wanted: &Wanted, number: u64) -> ExitCode {
    let (start, seed) = throw(wanted.seed, number);
    let limit = Duration::from_secs(wanted.seconds);
    let system = planted(wanted.seed, number);
    let options = solve_options(start, seed, wanted.no_exact_count);
    let (word, wrong) = match solve(&system, &options, limit) {
        Verdict::Right => ("right", String::new()),
        Verdict::RightInDoubt => ("in-doubt", String::new()),
        Verdict::Doubt(wrong) => ("doubt", wrong),
        Verdict::Silent(wrong) => ("silent", wrong),
        Verdict::NoEnd => ("no-end", String::new()),
        Verdict::Refused(why) => ("refused", why),
    };
    println!("{word} {}", wrong.replace('\n', " "));
    if let Some(folder) = &wanted.folder {
        write(folder, wanted.seed, number, word, &wrong);
    }
    ExitCode::SUCCESS
}

/// Writes the text of a system and the faults of its answer into a folder.
fn write(folder: &Path, series: u64, number: u64, word: &str, wrong: &str) {
    let (start, seed) = throw(series, number);
    let note = format!("; --start {} --seed {seed}: {word}{wrong}", start.name()).to_lowercase();
    let name = format!("{word}_{series}_{number}.bertini");
    let written = std::fs::write(folder.join(name), planted(series, number).file(&note));
    or_exit(written.map_err(|e| format!("{}: {e}", folder.display())));
}

/// The verdict of a process of its own.
fn verdict_of(wanted: &Wanted, number: u64) -> Result<(String, String), String> {
    let text = |e: std::io::Error| e.to_string();
    let count = if wanted.no_exact_count { "no" } else { "yes" };
    let options = [
        ("--seed", wanted.seed.to_string()),
        ("--seconds", wanted.seconds.to_string()),
        ("--one", number.to_string()),
        ("--exact-count", count.to_string()),
    ];
    let options = options.map(|(word, value)| [word.to_string(), value]);
    let mut child = Command::new(std::env::current_exe().map_err(text)?)
        .args(options.as_flattened())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(text)?;
    while child.try_wait().map_err(text)?.is_none() {
        if process_cpu_seconds(child.id()) > wanted.seconds as f64 {
            child.kill().map_err(text)?;
            child.wait().map_err(text)?;
            return Ok(("no-end".into(), String::new()));
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let mut said = String::new();
    let mut out = child.stdout.take().ok_or("it has no output")?;
    out.read_to_string(&mut said).map_err(text)?;
    let (word, wrong) = said
        .trim_end()
        .split_once(' ')
        .unwrap_or((said.trim_end(), ""));
    Ok(match word {
        "" => ("silent".into(), " its process broke".into()),
        word => (word.into(), wrong.into()),
    })
}

fn main() -> ExitCode {
    let wanted = or_exit(wanted());
    if let Some(number) = wanted.one {
        return solve_one(&wanted, number);
    }
    let mut tallies = BTreeMap::<&str, Tally>::new();
    let mut named = Vec::new();
    for number in wanted.first..wanted.first + wanted.count {
        let system = planted(wanted.seed, number);
        if wanted.kind.as_ref().is_some_and(|kind| kind != system.kind) {
            continue;
        }
        let (start, seed) = throw(wanted.seed, number);
        let begun = Instant::now();
        let (word, wrong) = or_exit(verdict_of(&wanted, number));
        let took = begun.elapsed().as_secs_f64();
        let tally = tallies.entry(system.kind).or_default();
        tally.seconds += took;
        tally.longest = tally.longest.max(took);
        *match word.as_str() {
            "right" => &mut tally.right,
            "in-doubt" => &mut tally.in_doubt,
            "doubt" => &mut tally.doubt,
            "no-end" => &mut tally.no_end,
            "refused" => &mut tally.refused,
            _ => &mut tally.silent,
        } += 1;
        if matches!(word.as_str(), "right" | "in-doubt") {
            continue;
        }
        let line = format!(
            "{word}: system {number} of seed {}, {}, start {}, seed {seed}:{wrong}",
            wanted.seed,
            system.kind,
            start.name()
        );
        eprintln!("{line}");
        if let Some(folder) = &wanted.folder {
            write(folder, wanted.seed, number, &word, &wrong);
        }
        if word == "silent" {
            named.push(line);
        }
    }
    println!(
        "| kind | right | right, in doubt | wrong, in doubt | **silent** | no end | refused | s | longest |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (kind, t) in &tallies {
        println!(
            "| {kind} | {} | {} | {} | {} | {} | {} | {:.1} | {:.1} |",
            t.right, t.in_doubt, t.doubt, t.silent, t.no_end, t.refused, t.seconds, t.longest
        );
    }
    println!("\nSilent errors: {}", named.len());
    named.iter().for_each(|line| println!("- {line}"));
    ExitCode::from(u8::from(!named.is_empty()))
}
