//! Whole solves against PHCpack's black box and Bertini 2, on the same systems in the same run.
//!
//! `cargo bench -p cognate-tests --bench end_to_end [-- NAME]`, on one thread. CPU seconds: ours of
//! planning (choosing a start, mixed volumes) and of solving (compiling, tracking, endgames,
//! classification), best of three seeds; `phc -b -0` (apt: `phcpack`, where it is installed) of its
//! process, which starts in milliseconds; Bertini 2 (`BERTINI_PYTHON` names a Python with the
//! package `bertini2`) of its solve alone, without starting Python. A peer is stopped after
//! 120 CPU seconds.
//!
//! Figures of 2026-11-21, two shared cores of an AMD EPYC with AVX-512, `phc` 2.4.86; other builds
//! ran beside it on both sides. What is not here has not been measured since the starts changed:
//!
//! ```text
//! system          start or program                   paths distinct  plan s  solve s  paths/s
//! noon-5          auto: total-degree                   243      233   0.000   0.0040    61046
//! noon-5          linear-product                       233      233   0.000   0.0159    14613
//! noon-5          polyhedral                           233      233   0.000   0.0358     6507
//! noon-5          phc -b                                        233             1.97  494 times ours
//! cyclic-7        auto: polyhedral                     924      924   0.017   0.1328     6957
//! cyclic-7        phc -b                                        924             9.71   65 times ours
//! 6R, 8 quadrics  auto: linear-product                  64       32   0.000   0.0264     2426
//! 6R, 8 quadrics  multihomogeneous                      96       32   0.000   0.0480     2001
//! 6R, 8 quadrics  regeneration                          48       32   0.000   0.1978      243
//! 6R, 8 quadrics  phc -b                                         40             0.63   24 times ours
//! Stewart-Gough   auto: total-degree                   128       40   0.006   0.1153     1111
//! Stewart-Gough   polyhedral                           128       40   0.000   0.2283      561
//! ```
//!
//! Cyclic-7 is not asked by linear products: many of those paths to infinity climb to large numbers
//! of digits, and it takes minutes.
//!
//! `phc -b` chooses its start itself: on most of these a polyhedral one. Bertini 2 starts by total
//! degree. What a line says of ours is the start that stands there.

use cognate_algorithms::plan::StartChoice;
use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{PlanOptions, plan};
use cognate_systems::formats::{self, FileSettings, Format};
use cognate_systems::named::{cyclic, eco, katsura, noon, reimer};
use cognate_systems::system::System;
use cognate_tests::systems::{shared, six_revolute_axis_vectors};
use std::path::Path;
use std::process::Command;

/// CPU seconds after which a peer is stopped.
const PATIENCE: u32 = 120;

/// CPU seconds of this thread so far; `None` where the system does not tell.
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// What a shell prints that runs this under the limit of CPU seconds.
fn shell(script: &str, arguments: &[&Path]) -> Result<String, String> {
    let output = Command::new("bash")
        .arg("-c")
        .arg(format!("ulimit -t {PATIENCE}; {script}"))
        .arg("bash")
        .args(arguments)
        .env("BERTINI_NUM_THREADS", "1")
        .output()
        .map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err("-".into());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// CPU seconds of `phc -b` on this file and the solutions that it lists, or why there are none.
fn phc(input: &Path, folder: &Path) -> Result<(f64, u64), String> {
    let copy = folder.join("phc_input"); // phc writes into its input
    std::fs::copy(input, &copy).map_err(|error| error.to_string())?;
    let output = folder.join("phc_output");
    let _ = std::fs::remove_file(&output);
    let script = "TIMEFORMAT='%U %S'; { time phc -b -0 \"$1\" \"$2\" >/dev/null 2>&1; } 2>&1";
    let text = shell(script, &[&copy, &output])?;
    let words = text.split_whitespace();
    let times: Vec<f64> = words.filter_map(|t| t.parse().ok()).collect();
    let found = std::fs::read_to_string(&copy).unwrap_or_default();
    // "THE SOLUTIONS :" and on the next line their number and dimension.
    let mut lines = found
        .lines()
        .skip_while(|line| !line.contains("THE SOLUTIONS"));
    let count = lines
        .nth(1)
        .and_then(|line| line.split_whitespace().next()?.parse().ok());
    match (&times[..], count) {
        ([user, system], Some(count)) => Ok((user + system, count)),
        _ => Err("-".into()),
    }
}

/// CPU seconds of Bertini 2 on this system and the finite solutions that it finds.
fn bertini(system: &System, folder: &Path) -> Result<(f64, u64), String> {
    let python = std::env::var("BERTINI_PYTHON").map_err(|_| "-")?;
    let text = formats::write(Format::Bertini, system, &FileSettings::default())
        .map_err(|error| error.to_string())?;
    let inner = text.split_once("INPUT").map_or("", |(_, rest)| rest);
    let inner = inner.split("END;").next().unwrap_or("");
    let (input, program) = (folder.join("bertini_input"), folder.join("bertini.py"));
    let script = "import sys, time, tempfile, bertini\n\
                  system = bertini.parse.system(open(sys.argv[1]).read())\n\
                  before = time.process_time()\n\
                  found = bertini.solve(system, seed=1, directory=tempfile.mkdtemp(), show_progress=False)\n\
                  print(time.process_time() - before, len(found))\n";
    std::fs::write(&input, inner).map_err(|error| error.to_string())?;
    std::fs::write(&program, script).map_err(|error| error.to_string())?;
    let text = shell(
        "\"$1\" \"$2\" \"$3\" 2>/dev/null",
        &[Path::new(&python), &program, &input],
    )?;
    let mut words = text.split_whitespace();
    let seconds = words.next().and_then(|word| word.parse().ok());
    let count = words.next().and_then(|word| word.parse().ok());
    seconds.zip(count).ok_or_else(|| "-".into())
}

/// The system as one PHCpack file, written and read again: what both sides solve.
fn written(system: &System, input: &Path) -> Result<System, Box<dyn std::error::Error>> {
    let text = formats::write(Format::Phcpack, system, &FileSettings::default())?;
    std::fs::write(input, &text)?;
    Ok(formats::read("input.phc", text.as_bytes())?.system)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    use StartChoice::{
        Auto, LinearProduct, Multihomogeneous, Polyhedral, Regeneration, TotalDegree,
    };
    let folder = tempfile::tempdir()?;
    let only: Option<String> = std::env::args().nth(1).filter(|a| !a.starts_with('-'));
    println!(
        "{:15} {:33} {:>6} {:>8} {:>7} {:>8} {:>8}",
        "system", "start or program", "paths", "distinct", "plan s", "solve s", "paths/s"
    );
    for (name, system, others) in [
        (
            "noon-5",
            noon(5).system,
            &[TotalDegree, LinearProduct, Polyhedral][..],
        ),
        ("reimer-5", reimer(5).system, &[Polyhedral]),
        ("eco-8", eco(8).system, &[TotalDegree, LinearProduct]),
        ("cyclic-7", cyclic(7).system, &[TotalDegree]),
        (
            "katsura-10",
            katsura(10).system,
            &[Polyhedral, Regeneration],
        ),
        (
            "Stewart-Gough",
            shared("stewart_gough_dietmaier"),
            &[Polyhedral],
        ),
        (
            "6R, 8 quadrics",
            shared("six_revolute_manseur_doty_tm8"),
            &[Multihomogeneous, Regeneration],
        ),
        (
            "6R, axes",
            six_revolute_axis_vectors(),
            &[Multihomogeneous, Polyhedral, Regeneration],
        ),
    ] {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let input = folder.path().join("input.phc");
        let groups = system.groups.clone();
        let mut system = written(&system, &input)?;
        // PHCpack's format knows no groups; ours are those of the file.
        system.groups = groups;
        let mut best_of_all = f64::INFINITY;
        let starts: Vec<StartChoice> = [Auto].iter().chain(others).copied().collect();
        for start in starts {
            let (mut best, mut planning) = (f64::INFINITY, f64::INFINITY);
            let mut line = String::new();
            for seed in 1..=3 {
                let options = PlanOptions {
                    start,
                    seed,
                    ..PlanOptions::default()
                };
                let clock = || cpu_seconds().ok_or("no /proc/thread-self/schedstat here");
                let begin = clock()?;
                let mut plan = match plan(&system, &options) {
                    Ok(plan) => plan,
                    Err(error) => {
                        line = error.to_string();
                        break;
                    }
                };
                let planned = clock()?;
                let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 16)?;
                let solved = clock()? - planned;
                planning = planning.min(planned - begin);
                best = best.min(solved);
                let (paths, counts) = (&sets[0].paths, &sets[0].counts);
                let label = match start {
                    Auto => format!("auto: {}", plan.start),
                    _ => plan.start.to_string(),
                };
                let rate = paths.total as f64 / best;
                line = format!(
                    "{label:33} {:6} {:8} {planning:7.3} {best:8.4} {rate:8.0}",
                    paths.total, counts.distinct
                );
                if paths.failed > 0 {
                    line += &format!("  {} failed", paths.failed);
                }
            }
            best_of_all = best_of_all.min(best + planning);
            println!("{name:15} {line}");
        }
        for (program, answer) in [
            ("phc -b", phc(&input, folder.path())),
            ("bertini2", bertini(&system, folder.path())),
        ] {
            match answer {
                Ok((seconds, count)) => println!(
                    "{name:15} {program:33} {:>6} {count:8} {:>7} {seconds:8.2}  {:.1} times ours",
                    "",
                    "",
                    seconds / best_of_all
                ),
                Err(why) => println!("{name:15} {program:33} {why}"),
            }
        }
    }
    Ok(())
}
