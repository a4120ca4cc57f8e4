//! Surfaces: real surfaces whose topology is known, each asked with several seeds and compared.
//!
//! `cargo run --release -p cognate-tests --bin surfaces -- [--seeds 3] [--first 1] [--samples 2] [--limit 100] [--only NAME,NAME] [--known FILE]`
//!
//! `known.json`, or another file, has their equations, and Euler characteristic with compact support, whether they are bounded, and how many
//! connected parts they have, by their `source`. Prints a line of a table for each surface. After `--limit` CPU seconds no
//! further stage is begun. A wrong answer that is called settled makes the exit code 1.

use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve};
use cognate_algorithms::questions::QuestionSolve;
use cognate_algorithms::solve::Root;
use cognate_solutions::witness::{Answer, Question};
use cognate_systems::system::System;
use cognate_tests::arguments::{number, options, or_exit};
use cognate_tests::limited::run_within;
use cognate_tests::systems::written;
use cognate_tests::tally::{Tally, Verdict};
use serde::Deserialize;
use std::process::ExitCode;

/// Settings of the program.
struct Wanted {
    seeds: u64,
    first: u64,
    samples: u32,
    limit: f64,
    only: Vec<String>,
    known: Vec<Known>,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        seeds: 3,
        first: 1,
        samples: 2,
        limit: 100.0,
        only: Vec::new(),
        known: read(include_str!("known.json"))?,
    };
    for (word, value) in options()? {
        match word.as_str() {
            "--seeds" => wanted.seeds = number(&word, &value)?,
            "--first" => wanted.first = number(&word, &value)?,
            "--samples" => wanted.samples = number(&word, &value)?,
            "--limit" => wanted.limit = number(&word, &value)?,
            "--known" => {
                let text = std::fs::read_to_string(&value).map_err(|e| format!("{value}: {e}"))?;
                wanted.known = read(&text)?;
            }
            "--only" => wanted.only = value.split(',').map(str::to_owned).collect(),
            _ => {
                return Err(format!(
                    "{word}: expected --seeds N, --first N, --samples N, --limit SECONDS, --only NAMES or --known FILE"
                ));
            }
        }
    }
    Ok(wanted)
}

/// A surface with its known properties.
#[derive(Deserialize)]
struct Known {
    name: String,
    equation: String,
    euler: i64,
    compact: Option<bool>,
    parts: Option<u64>,
}

fn read(text: &str) -> Result<Vec<Known>, String> {
    serde_json::from_str(text).map_err(|e| format!("known surfaces: {e}"))
}

/// Answer about a surface.
enum Said {
    Settled {
        euler: i64,
        compact: bool,
        parts: u64,
    },
    Doubt(String),
    Unfinished,
}

fn ask(system: &System, seed: u64, wanted: &Wanted) -> Result<Said, String> {
    let options = DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    };
    let solve = DecompositionSolve::new(system, &options).map_err(|e| e.to_string())?;
    let mut root = Root::new(solve);
    if !run_within(wanted.limit, system, &mut root)? {
        return Ok(Said::Unfinished);
    }
    let decomposition = root.solve.decomposition().cloned();
    let components = decomposition
        .ok_or("it is done without an answer")?
        .components;
    let question = Question::RealSurface {
        samples: wanted.samples,
    };
    let solve = QuestionSolve::new(system, &options, &components, &question);
    let mut root = Root::new(solve.map_err(|e| e.to_string())?);
    if !run_within(wanted.limit, system, &mut root)? {
        return Ok(Said::Unfinished);
    }
    if let Some(doubt) = root.solve.doubts().into_iter().next() {
        return Ok(Said::Doubt(doubt));
    }
    let Some(Answer::RealSurface(surfaces)) = root.solve.answer() else {
        return Err("the answer is no surface".into());
    };
    let [surface] = surfaces.as_slice() else {
        return Err(format!("{} components", surfaces.len()));
    };
    Ok(Said::Settled {
        euler: surface.euler,
        compact: surface.compact,
        parts: surface.mesh.counts().parts,
    })
}

/// Verdict on an answer, compared with the known one.
fn judged(published: &Known, said: Result<Said, String>) -> (Verdict, Option<String>) {
    match said {
        Ok(Said::Settled {
            euler,
            compact,
            parts,
        }) => {
            let right = euler == published.euler
                && published
                    .compact
                    .is_none_or(|is_compact| is_compact == compact)
                && published.parts.is_none_or(|count| count == parts);
            if right {
                return (Verdict::Right, None);
            }
            let note = format!("WRONG: {euler}, bounded {compact}, {parts} parts");
            (Verdict::Wrong, Some(note))
        }
        Ok(Said::Doubt(doubt)) => (Verdict::Unsettled, Some(doubt)),
        Ok(Said::Unfinished) => (Verdict::Unfinished, None),
        Err(error) => (Verdict::Unfinished, Some(error)),
    }
}

fn main() -> ExitCode {
    let wanted = or_exit(wanted());
    println!("{}", Tally::head("surface"));
    let mut wrong = 0;
    for published in &wanted.known {
        if !wanted.only.is_empty() && !wanted.only.contains(&published.name) {
            continue;
        }
        let input = format!(
            "variable_group x, y, z; function f; f = {};",
            published.equation
        );
        let system = written(&input);
        let seeds = wanted.first..wanted.first + wanted.seeds;
        let tally = or_exit(Tally::of(seeds, |seed| {
            judged(published, ask(&system, seed, &wanted))
        }));
        println!("{}", tally.line(&published.name));
        for note in tally.notes() {
            println!("  {note}");
        }
        wrong += tally.wrong();
    }
    ExitCode::from(u8::from(wrong > 0))
}
