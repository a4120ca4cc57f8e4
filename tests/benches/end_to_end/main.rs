//! Whole solves by every start, against other programs on the same file in the same run.
//!
//! `cargo bench -p cognate-tests --bench end_to_end [-- NAME]`, on one thread. Ours: CPU seconds of
//! planning (choosing a start, mixed volumes) and of solving (compiling, tracking, endgames,
//! classification), the median of three seeds. Figures and what peers need: `end_to_end.md`.

mod peers;

use crate::peers::{Answer, Peers};
use cognate_algorithms::plan::SolveMethod;
use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{SolveOptions, plan};
use cognate_systems::formats::{self, FileSettings, Format};
use cognate_systems::named::{cyclic, eco, katsura, noon, reimer};
use cognate_systems::system::System;
use cognate_tests::measures::cpu_seconds;
use cognate_tests::systems::{shared, six_revolute_axis_vectors};
use std::path::Path;

/// CPU seconds after which a peer is stopped, where `PEER_SECONDS` does not say otherwise.
const PATIENCE: u32 = 120;
/// Every start is measured with seeds from 1 to here.
const SEEDS: u64 = 3;

/// One start on one system, over all seeds.
struct Measured {
    label: String,
    paths: u64,
    /// Smallest number of distinct solutions that a seed finds.
    distinct: u64,
    /// Failed paths of all seeds together.
    failed: u64,
    /// Medians, in CPU seconds.
    planning: f64,
    solving: f64,
}

impl Measured {
    fn line(&self) -> String {
        let rate = self.paths as f64 / self.solving;
        let mut line = format!(
            "{:33} {:6} {:8} {:7.3} {:8.4} {rate:8.0}",
            self.label, self.paths, self.distinct, self.planning, self.solving
        );
        if self.failed > 0 {
            line += &format!("  {} failed in {SEEDS} runs", self.failed);
        }
        line
    }
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// Ours with every seed; `Ok(Err(reason))` where the start does not apply.
fn measure(
    system: &System,
    start: &SolveMethod,
) -> Result<Result<Measured, String>, Box<dyn std::error::Error>> {
    let (mut planning, mut solving) = (Vec::new(), Vec::new());
    let mut measured: Option<Measured> = None;
    for seed in 1..=SEEDS {
        let options = SolveOptions {
            method: start.clone(),
            seed,
            ..SolveOptions::default()
        };
        let begin = cpu_seconds()?;
        let mut plan = match plan(system, &options) {
            Ok(plan) => plan,
            Err(error) => return Ok(Err(format!("{}: {error}", start.name()))),
        };
        let planned = cpu_seconds()?;
        let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 16)?;
        solving.push(cpu_seconds()? - planned);
        planning.push(planned - begin);
        let (paths, counts) = (&sets[0].paths, &sets[0].counts);
        let before = measured.as_ref();
        measured = Some(Measured {
            label: match start {
                SolveMethod::Auto => format!("auto: {}", plan.start),
                _ => plan.start.to_string(),
            },
            paths: paths.total,
            distinct: before.map_or(counts.distinct, |m| m.distinct.min(counts.distinct)),
            failed: before.map_or(0, |m| m.failed) + paths.failed,
            planning: 0.0,
            solving: 0.0,
        });
    }
    let measured = measured.ok_or("there are seeds")?;
    Ok(Ok(Measured {
        planning: median(planning),
        solving: median(solving),
        ..measured
    }))
}

/// The system as one PHCpack file, written and read again: what both sides solve.
fn written(system: &System, input: &Path) -> Result<System, Box<dyn std::error::Error>> {
    let text = formats::write(Format::Phcpack, system, &FileSettings::default())?;
    std::fs::write(input, &text)?;
    Ok(formats::read("input.phc", text.as_bytes())?.system)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    use SolveMethod::{Auto, Multihomogeneous, Polyhedral, Regeneration};
    let folder = tempfile::tempdir()?;
    let patience = match std::env::var("PEER_SECONDS") {
        Ok(seconds) => seconds.parse().map_err(|_| "PEER_SECONDS: a number")?,
        Err(_) => PATIENCE,
    };
    let only: Option<String> = std::env::args().nth(1).filter(|a| !a.starts_with('-'));
    println!(
        "{:15} {:33} {:>6} {:>8} {:>7} {:>8} {:>8}",
        "system", "start or program", "paths", "distinct", "plan s", "solve s", "paths/s"
    );
    for (name, system, others) in [
        (
            "noon-5",
            noon(5).system,
            &[SolveMethod::LINEAR_PRODUCT, Polyhedral][..],
        ),
        ("reimer-5", reimer(5).system, &[]),
        ("eco-8", eco(8).system, &[]),
        ("cyclic-7", cyclic(7).system, &[]),
        ("katsura-10", katsura(10).system, &[]),
        (
            "Stewart-Gough",
            shared("stewart_gough_dietmaier"),
            &[Polyhedral],
        ),
        (
            "6R-8",
            shared("six_revolute_manseur_doty_tm8"),
            &[Multihomogeneous, Regeneration],
        ),
        ("6R-12", six_revolute_axis_vectors(), &[Polyhedral]),
    ] {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let input = folder.path().join("input.phc");
        let groups = system.groups.clone();
        let mut system = written(&system, &input)?;
        // PHCpack's format knows no groups; ours are those of the file.
        system.groups = groups;
        let mut ours = f64::INFINITY;
        let starts: Vec<SolveMethod> = [Auto].iter().chain(others).cloned().collect();
        for start in starts {
            match measure(&system, &start)? {
                Ok(measured) => {
                    ours = ours.min(measured.planning + measured.solving);
                    println!("{name:15} {}", measured.line());
                }
                Err(refused) => println!("{name:15} {refused}"),
            }
        }
        let peers = Peers {
            input: &input,
            system: &system,
            folder: folder.path(),
            patience,
        };
        for (program, answer) in peers.answers() {
            match answer {
                Answer::Found { seconds, count } => println!(
                    "{name:15} {program:33} {:>6} {count:8} {:>7} {seconds:8.2}  {:.1} times ours",
                    "",
                    "",
                    seconds / ours
                ),
                Answer::Stopped(limit) => println!(
                    "{name:15} {program:33} stopped after {limit} CPU seconds: more than {:.0} times ours",
                    f64::from(limit) / ours
                ),
                Answer::None(why) => println!("{name:15} {program:33} {why}"),
            }
        }
    }
    Ok(())
}
