//! Equations with denominators: points and components where one is 0 are no answers, and are counted by name.
//!
//! `COGNATE_FRACTIONS=500` plants as many systems; `COGNATE_FRACTIONS_FOLDER` keeps them as files.

use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve, run_locally};
use cognate_algorithms::plan::SolveMethod;
use cognate_solutions::witness::Decomposition;
use cognate_systems::formats;
use cognate_systems::system::System;
use cognate_tests::dice::Dice;
use cognate_tests::planted::Planted;
use cognate_tests::planted::fractions::fractions;
use cognate_tests::planted::verdict::{Verdict, options, solve, solve_within, start};
use std::collections::BTreeMap;
use std::time::Duration;

/// Planted systems where no other number is asked for.
const SAMPLE: u64 = 20;
const LIMIT: Duration = Duration::from_secs(60);

fn read(text: &str) -> System {
    match formats::read("fractions", text.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}\n{text}"),
    }
}

fn decomposed(system: &System, seed: u64) -> Decomposition {
    let options = DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    };
    let solve = match DecompositionSolve::new(system, &options) {
        Ok(solve) => solve,
        Err(error) => panic!("{error}"),
    };
    match run_locally(solve, 8) {
        Ok(decomposition) => decomposition,
        Err(error) => panic!("{error}"),
    }
}

/// Dimensions and degrees of components, with how many there are.
fn components(decomposition: &Decomposition) -> BTreeMap<(u32, u64), usize> {
    let mut counts = BTreeMap::new();
    for set in &decomposition.components {
        *counts.entry((set.dimension(), set.degree)).or_default() += 1;
    }
    counts
}

fn decompose(planted: &Planted, seed: u64) -> Verdict {
    let system = match formats::read("planted", planted.file("").as_bytes()) {
        Ok(problem) => problem.system,
        // A numerator that is constant has no solution, and the equation is refused.
        Err(error) => return Verdict::Refused(error.to_string()),
    };
    let decomposition = decomposed(&system, seed);
    let mut expected = BTreeMap::new();
    if !planted.roots.is_empty() {
        expected.insert((0, 1), planted.roots.len());
    }
    if planted.on_a_set {
        expected.insert((planted.variables.len() as u32 - 1, 1), 1);
    }
    let components = components(&decomposition);
    let wrong = format!("{components:?} instead of {expected:?}");
    match (components == expected, decomposition.settled()) {
        (true, true) => Verdict::Right,
        (true, false) => Verdict::RightInDoubt,
        (false, true) => Verdict::Silent(wrong),
        (false, false) => Verdict::Doubt(wrong),
    }
}

#[test]
fn planted_fractions_are_answered_right() {
    let asked = std::env::var("COGNATE_FRACTIONS").ok();
    let count = asked.and_then(|n| n.parse().ok()).unwrap_or(SAMPLE);
    let folder = std::env::var("COGNATE_FRACTIONS_FOLDER").ok();
    let mut silent = Vec::new();
    let mut tally: BTreeMap<String, u64> = BTreeMap::new();
    for number in 0..count {
        let planted = fractions(1, number);
        if let Some(folder) = &folder {
            let path = std::path::Path::new(folder).join(format!("{number}.bertini"));
            std::fs::write(path, planted.file("")).expect("the folder takes files");
        }
        let mut dice = Dice(number);
        let by = match number % 2 {
            0 => SolveMethod::Auto,
            _ => start(&mut dice),
        };
        let seed = dice.below(1 << 32);
        let verdicts = [
            (
                "solve",
                solve(&planted, &options(by.clone(), seed, false), LIMIT),
            ),
            ("decompose", decompose(&planted, seed)),
        ];
        for (what, verdict) in verdicts {
            let (name, note) = match &verdict {
                Verdict::Right => ("right", String::new()),
                Verdict::RightInDoubt => ("right, in doubt", String::new()),
                Verdict::Doubt(wrong) => ("in doubt", wrong.clone()),
                Verdict::Silent(wrong) => ("silent", wrong.clone()),
                Verdict::NoEnd => ("no end", String::new()),
                Verdict::Refused(why) => ("refused", why.clone()),
            };
            if name != "right" {
                let start = by.name();
                println!("{number}, {what} by {start}, seed {seed}: {name}{note}");
            }
            if let Verdict::Silent(wrong) = verdict {
                let answer = planted.file("");
                silent.push(format!("{number}, {what}, {seed}: {wrong}\n{answer}"));
            }
            *tally.entry(format!("{what} {name}")).or_default() += 1;
        }
    }
    println!("{tally:?}");
    assert!(silent.is_empty(), "{}", silent.join("\n"));
}

/// Variables, equations, expected solutions, and how many are removed.
const PUBLISHED: [(&str, &str, u64, u64); 4] = [
    // Roots that make a denominator 0 must be ruled out: ModelingToolkit.jl, issue 3151.
    (
        "\"x\", \"y\"",
        "\"x/y + y/x - 5/2\", \"1/x + 1/y - 3/2\"",
        2,
        1,
    ),
    // A contradiction that was given a solution: Maxima, bug 1700056.
    ("\"a\", \"b\"", "\"1/a - 1/b - 1\", \"a - b\"", 0, 1),
    // The expression that is given decides.
    ("\"x\"", "\"x*(x - 1)/x\"", 1, 0),
    ("\"x\"", "\"(x^2 - 1)/(x - 1)\"", 1, 1),
];

#[test]
fn published_fractions() {
    for (variables, equations, expected, removed) in PUBLISHED {
        let text = format!("{{\"variables\": [{variables}], \"equations\": [{equations}]}}");
        let system = read(&text);
        for seed in 0..3 {
            let options = cognate_algorithms::SolveOptions {
                seed,
                ..cognate_algorithms::SolveOptions::default()
            };
            let set = match solve_within(&system, &options, LIMIT) {
                Ok(set) => set,
                Err(verdict) => panic!("{equations}: {verdict:?}"),
            };
            let counts = &set.counts;
            assert!(set.settled(), "{equations}: {:?}", set.warnings);
            assert_eq!(counts.distinct, expected, "{equations}");
            assert_eq!(counts.real, Some(expected), "{equations}");
            assert_eq!(counts.positive_dimensional, Some(false), "{equations}");
            assert_eq!(counts.removed["a denominator is 0"], removed);
            assert!(counts.degenerate.is_empty(), "in one count only");
            let decomposition = decomposed(&system, seed);
            assert!(
                decomposition.settled() && decomposition.adds_up(),
                "{equations}"
            );
            assert_eq!(
                decomposition.components.len() as u64,
                expected,
                "{equations}"
            );
            assert_eq!(decomposition.removed.len() as u64, removed, "{equations}");
        }
    }
}

/// A solution within the errors of a zero of a denominator is told from it by more digits, not by a tolerance.
#[test]
fn solutions_near_the_zeros_of_a_denominator_stay() {
    for (equations, expected) in [
        ("\"1/x - 1e14\", \"y - x\"", 1),
        ("\"(x - y)/(x - 1 - 1e-15)\", \"(x - 1)*(y - 2)\"", 2),
        ("\"(x^2 - 2)*(x - y)/(y - x)\", \"y^2 - 2\"", 2),
    ] {
        let system = read(&format!(
            "{{\"variables\": [\"x\", \"y\"], \"equations\": [{equations}]}}"
        ));
        let set = solve_within(&system, &cognate_algorithms::SolveOptions::default(), LIMIT);
        let set = match set {
            Ok(set) => set,
            Err(verdict) => panic!("{equations}: {verdict:?}"),
        };
        assert!(set.settled(), "{equations}: {:?}", set.warnings);
        assert_eq!(set.counts.distinct, expected, "{equations}");
    }
}
