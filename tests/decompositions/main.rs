//! Decompositions: systems whose components are known, each decomposed with several seeds and compared.
//!
//! `cargo run --release -p cognate-tests --bin decompositions -- [--seeds 3] [--first 1] [--limit 100] [--only NAME,NAME] [--method NAME] [--verify true] [--certify true] [--folder PATH]`
//!
//! The systems stand beside the repository in `../shared/systems` (`--folder` names another place): each a
//! folder with `system.bertini`, and `expected.components` in its `meta.json`. Without them the program says so and ends
//! with 0. Prints a line of a table for each system. After `--limit` seconds no further stage of a
//! decomposition is begun. A wrong answer that is called settled makes the exit code 1.

use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve};
use cognate_algorithms::solve::Root;
use cognate_solutions::witness::{Decomposition, Method};
use cognate_systems::formats;
use cognate_systems::system::System;
use cognate_tests::arguments::{number, options, or_exit};
use cognate_tests::limited::run_within;
use cognate_tests::tally::{Tally, Verdict};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Settings of the program.
struct Wanted {
    seeds: u64,
    first: u64,
    limit: f64,
    only: Vec<String>,
    method: Option<Method>,
    verify: bool,
    certify: bool,
    folder: PathBuf,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        seeds: 3,
        first: 1,
        limit: 100.0,
        only: Vec::new(),
        method: None,
        verify: false,
        certify: false,
        folder: Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/systems"),
    };
    for (word, value) in options()? {
        match word.as_str() {
            "--seeds" => wanted.seeds = number(&word, &value)?,
            "--first" => wanted.first = number(&word, &value)?,
            "--limit" => wanted.limit = number(&word, &value)?,
            "--only" => wanted.only = value.split(',').map(str::to_owned).collect(),
            "--method" => wanted.method = method(&value)?,
            "--verify" => wanted.verify = number(&word, &value)?,
            "--certify" => wanted.certify = number(&word, &value)?,
            "--folder" => wanted.folder = value.into(),
            _ => {
                return Err(format!(
                    "{word}: expected --seeds N, --first N, --limit SECONDS, --only NAMES, --method NAME, --verify true, --certify true or --folder PATH"
                ));
            }
        }
    }
    Ok(wanted)
}

fn method(name: &str) -> Result<Option<Method>, String> {
    let named_method = Method::ALL.into_iter().find(|method| method.name() == name);
    match (name, named_method) {
        ("auto", _) => Ok(None),
        (_, Some(method)) => Ok(Some(method)),
        _ => Err(format!(
            "--method {name}: expected auto, cascade, equations or slices"
        )),
    }
}

/// Components by dimension, degree and multiplicity (0 where it is not known).
type Components = BTreeMap<(u64, u64, u64), u64>;

/// A system, and its components.
struct Instance {
    name: String,
    system: System,
    expected: Components,
}

/// The systems of the folder whose components are known, by name.
fn instances(wanted: &Wanted) -> Result<Vec<Instance>, String> {
    let mut instances = Vec::new();
    let folders = std::fs::read_dir(&wanted.folder).map_err(|e| e.to_string())?;
    for folder in folders.flatten() {
        let name = folder.file_name().to_string_lossy().into_owned();
        if !wanted.only.is_empty() && !wanted.only.contains(&name) {
            continue;
        }
        let Ok(meta) = std::fs::read(folder.path().join("meta.json")) else {
            continue;
        };
        let meta: Value = serde_json::from_slice(&meta).map_err(|e| format!("{name}: {e}"))?;
        let Some(expected) = components(&meta["expected"]["components"]) else {
            continue;
        };
        let Ok(content) = std::fs::read(folder.path().join("system.bertini")) else {
            continue;
        };
        let system = formats::read(&name, &content)
            .map_err(|e| e.to_string())?
            .system;
        instances.push(Instance {
            name,
            system,
            expected,
        });
    }
    instances.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(instances)
}

/// Components that are listed by dimension and degree; a list of anything else is none.
fn components(listed: &Value) -> Option<Components> {
    let mut components = Components::new();
    for entry in listed.as_array()? {
        let field = |name: &str| entry.get(name).and_then(Value::as_u64);
        let key = (
            field("dim")?,
            field("degree")?,
            field("multiplicity").unwrap_or(1),
        );
        *components.entry(key).or_default() += field("count").unwrap_or(1);
    }
    Some(components)
}

fn counted(decomposition: &Decomposition) -> Components {
    let mut components = Components::new();
    for set in &decomposition.components {
        let multiplicity = set.multiplicity.scheme.unwrap_or(0);
        let key = (u64::from(set.dimension()), set.degree, multiplicity);
        *components.entry(key).or_default() += 1;
    }
    components
}

/// The decomposition; `None` where the time was over, or what went wrong.
fn decompose(system: &System, seed: u64, wanted: &Wanted) -> Result<Option<Decomposition>, String> {
    let options = DecompositionOptions {
        seed,
        method: wanted.method,
        verify: wanted.verify,
        certify: wanted.certify,
        ..DecompositionOptions::default()
    };
    let solve = DecompositionSolve::new(system, &options).map_err(|e| e.to_string())?;
    let mut root = Root::new(solve);
    let whole = run_within(wanted.limit, system, &mut root)?;
    Ok(whole.then(|| root.solve.decomposition().cloned()).flatten())
}

/// Counts of proofs, if proofs are asked for.
#[derive(Default)]
struct Proofs {
    /// Components, and of these: all witness points in boxes, which meet no other; the given equations proved; no
    /// proper union left.
    components: u64,
    whole: u64,
    given: u64,
    irreducible: u64,
    unions: u64,
}

impl Proofs {
    fn add(&mut self, decomposition: &Decomposition) {
        for set in &decomposition.components {
            let Some(proof) = set.evidence.proof else {
                continue;
            };
            let whole = proof.points == set.degree && proof.distinct == set.degree;
            self.components += 1;
            self.whole += u64::from(whole);
            self.given += u64::from(proof.all_equations);
            self.irreducible += u64::from(proof.irreducible);
            self.unions += proof.unions;
        }
    }
}

/// Verdict on a decomposition, compared with the known components.
fn judged(instance: &Instance, decomposition: &Decomposition) -> (Verdict, Option<String>) {
    let components = counted(decomposition);
    let mut what = Vec::new();
    if components != instance.expected {
        what.push(format!("{components:?} instead of {:?}", instance.expected));
    }
    if !decomposition.adds_up() {
        what.push("counts do not add up".into());
    }
    let doubts = decomposition
        .dimensions
        .iter()
        .map(|d| (d.number, &d.doubts));
    let of_sets = decomposition.components.iter();
    let of_sets = of_sets.map(|set| (set.dimension(), &set.evidence.doubts));
    for (dimension, doubts) in doubts.chain(of_sets) {
        let said = doubts.iter().map(|d| format!("dimension {dimension}: {d}"));
        what.extend(said);
    }
    let verdict = match (decomposition.settled(), what.is_empty()) {
        (true, true) => Verdict::Right,
        (true, false) => Verdict::Wrong,
        (false, _) => Verdict::Unsettled,
    };
    (verdict, (!what.is_empty()).then(|| what.join("; ")))
}

fn main() -> ExitCode {
    let wanted = or_exit(wanted());
    if !wanted.folder.is_dir() {
        println!("skipped: {} is not there", wanted.folder.display());
        return ExitCode::SUCCESS;
    }
    println!("{}", Tally::head("system"));
    let mut wrong = 0;
    for instance in or_exit(instances(&wanted)) {
        let mut proofs = Proofs::default();
        let seeds = wanted.first..wanted.first + wanted.seeds;
        let tally = or_exit(Tally::of(seeds, |seed| {
            match decompose(&instance.system, seed, &wanted) {
                Ok(Some(decomposition)) => {
                    proofs.add(&decomposition);
                    judged(&instance, &decomposition)
                }
                Ok(None) => (Verdict::Unfinished, None),
                Err(error) => (Verdict::Unfinished, Some(error)),
            }
        }));
        println!("{}", tally.line(&instance.name));
        if wanted.certify {
            let p = &proofs;
            println!(
                "  proofs: {} components, {} with all points in boxes apart, {} of the given equations, {} irreducible \
                 where no point is missing; {} unions excluded",
                p.components, p.whole, p.given, p.irreducible, p.unions
            );
        }
        for note in tally.notes() {
            println!("  {note}");
        }
        wrong += tally.wrong();
    }
    ExitCode::from(u8::from(wrong > 0))
}
