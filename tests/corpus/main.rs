//! Corpus: other people's systems, each solved with several seeds by the `cognate` program and compared
//! with what is known of it. Prints a report page.
//!
//! `cargo run --release -p cognate-tests --bin corpus -- [--seeds 5] [--limit 20] [--only WORD] [--every 1] [--folder PATH]`
//!
//! The systems stand beside the repository in `../shared/corpus` (`--folder` names another place) and
//! are none of its own; without them the program says so and ends with 0. `--limit` is in seconds of
//! wall time a solve, `--every N` takes each N-th system. An answer that differs from what is known and
//! is called settled (exit code 0) is a silent disagreement and makes the exit code 1.

use cognate_tests::arguments::{number, options, or_exit};
use cognate_tests::processes::cognate;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

/// Settings of the program.
struct Wanted {
    seeds: u64,
    limit: u64,
    only: String,
    every: usize,
    folder: PathBuf,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        seeds: 5,
        limit: 20,
        only: String::new(),
        every: 1,
        folder: Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/corpus"),
    };
    for (word, value) in options()? {
        match word.as_str() {
            "--seeds" => wanted.seeds = number(&word, &value)?,
            "--limit" => wanted.limit = number(&word, &value)?,
            "--only" => wanted.only = value,
            "--every" => wanted.every = number::<usize>(&word, &value)?.max(1),
            "--folder" => wanted.folder = value.into(),
            _ => {
                return Err(format!(
                    "{word}: expected --seeds N, --limit SECONDS, --only WORD, --every N or --folder PATH"
                ));
            }
        }
    }
    Ok(wanted)
}

/// Verdict on one solve.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    /// Settled, and as known.
    Right,
    /// Settled, and nothing is known to compare with.
    Unknown,
    /// The answer is called not settled: its text, and the known answer.
    Named(String),
    /// No answer came within the time.
    NoEnd,
    /// The system was not accepted, or the program broke: its exit code and last words.
    Refused(String),
    /// Settled, and not as known.
    Silent(String),
}

/// Differences of a solve from the known answer; empty if there is none.
fn differences(table_row: &Value, answer: &Value) -> String {
    let solutions = &answer["solutions"];
    let pairs = [
        ("distinct", "distinct"),
        ("mult", "with_multiplicity"),
        ("real", "real"),
    ];
    let mut text = String::new();
    for (of_table, of_answer) in pairs {
        if let (Some(expected), Some(count)) =
            (table_row[of_table].as_u64(), solutions[of_answer].as_u64())
            && expected != count
        {
            write!(text, " {of_answer} {count} instead of {expected};").expect("text takes all");
        }
    }
    text
}

/// Runs the program on one file and returns its output, or why there is none.
fn solve(file: &Path, arguments: &[String], limit: Duration) -> Result<(i32, Value), Verdict> {
    let folder = tempfile::tempdir().map_err(|e| Verdict::Refused(e.to_string()))?;
    let (out, err) = (folder.path().join("out"), folder.path().join("err"));
    let create = |path: &Path| File::create(path).map_err(|e| Verdict::Refused(e.to_string()));
    let mut command = Command::new(cognate());
    command
        .arg("solve")
        .arg(file)
        .args(["--format", "json", "--workers", "1", "--threads", "1"])
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(create(&out)?)
        .stderr(create(&err)?)
        .process_group(0);
    let mut child = command
        .spawn()
        .map_err(|e| Verdict::Refused(e.to_string()))?;
    let until = Instant::now() + limit;
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if Instant::now() > until => {
                // The solve and its workers are one group of processes, which this program started.
                let group = format!("-{}", child.id());
                for signal in ["-TERM", "-KILL"] {
                    let sent = Command::new("kill").args([signal, "--", &group]).status();
                    sent.map_err(|e| Verdict::Refused(e.to_string()))?;
                    std::thread::sleep(Duration::from_millis(300));
                }
                let _ = child.wait();
                return Err(Verdict::NoEnd);
            }
            Ok(None) => std::thread::sleep(Duration::from_millis(20)),
            Err(e) => return Err(Verdict::Refused(e.to_string())),
        }
    };
    let code = status.code().unwrap_or(-1);
    let text = std::fs::read_to_string(&out).unwrap_or_default();
    serde_json::from_str(&text)
        .map(|answer| (code, answer))
        .map_err(|_| {
            let said = std::fs::read_to_string(&err).unwrap_or_default();
            let last = said.trim().lines().last().unwrap_or("nothing").to_string();
            Verdict::Refused(format!(" exit code {code}: {last}"))
        })
}

fn judge(table_row: &Value, solved: Result<(i32, Value), Verdict>) -> Verdict {
    let (code, answer) = match solved {
        Ok(solved) => solved,
        Err(verdict) => return verdict,
    };
    let wrong = differences(table_row, &answer);
    let nothing = table_row["distinct"].is_null() && table_row["mult"].is_null();
    match (code, wrong.is_empty(), nothing) {
        (0, false, _) => Verdict::Silent(wrong),
        (0, true, true) => Verdict::Unknown,
        (0, true, false) => Verdict::Right,
        (1, ..) => Verdict::Named(wrong),
        (code, ..) => Verdict::Refused(format!(" exit code {code}")),
    }
}

fn main() -> ExitCode {
    let wanted = or_exit(wanted());
    let table = wanted.folder.join("table.json");
    let Ok(text) = std::fs::read_to_string(&table) else {
        println!("skipped: there is no {}", table.display());
        return ExitCode::SUCCESS;
    };
    let rows: Value = or_exit(serde_json::from_str(&text).map_err(|e| e.to_string()));
    let rows = rows.as_array().cloned().unwrap_or_default();
    let mut counts = BTreeMap::<&str, u64>::new();
    let mut named = Vec::new();
    let mut silent = 0;
    let (mut systems, mut unanswered) = (0, 0);
    for row in rows.iter().step_by(wanted.every) {
        let name = row["name"].as_str().unwrap_or_default();
        if !name.contains(&wanted.only) {
            continue;
        }
        systems += 1;
        let file = wanted.folder.join(row["file"].as_str().unwrap_or_default());
        let extra = row["args"].as_array().cloned().unwrap_or_default();
        let extra = extra.iter().filter_map(Value::as_str);
        // An `@` stands for the folder of the table.
        let extra: Vec<String> = extra
            .map(|word| match word.strip_prefix('@') {
                Some(path) => wanted.folder.join(path).display().to_string(),
                None => word.to_string(),
            })
            .collect();
        let mut verdicts = BTreeMap::<Verdict, Vec<u64>>::new();
        for seed in 1..=wanted.seeds {
            let mut arguments = extra.clone();
            arguments.extend(["--seed".to_string(), seed.to_string()]);
            let solved = solve(&file, &arguments, Duration::from_secs(wanted.limit));
            let verdict = judge(&row["known"], solved);
            let word = match &verdict {
                Verdict::Right => "right",
                Verdict::Unknown => "settled, nothing known",
                Verdict::Named(_) => "not settled",
                Verdict::NoEnd => "no end",
                Verdict::Refused(_) => "refused",
                Verdict::Silent(_) => "**silent**",
            };
            *counts.entry(word).or_default() += 1;
            verdicts.entry(verdict).or_default().push(seed);
        }
        let answered = |verdict: &Verdict| !matches!(verdict, Verdict::NoEnd | Verdict::Refused(_));
        unanswered += u64::from(!verdicts.keys().any(answered));
        for (verdict, seeds) in verdicts {
            let line = match verdict {
                Verdict::Right | Verdict::Unknown => continue,
                Verdict::Named(wrong) => format!("not settled:{wrong}"),
                Verdict::NoEnd => format!("no end in {} s", wanted.limit),
                Verdict::Refused(why) => format!("refused:{why}"),
                Verdict::Silent(wrong) => {
                    silent += seeds.len();
                    format!("**silent**:{wrong}")
                }
            };
            let line = format!("| {name} | {seeds:?} | {line} |");
            eprintln!("{line}");
            named.push(line);
        }
    }
    println!(
        "{systems} systems, {} seeds each, {} s a solve\n",
        wanted.seeds, wanted.limit
    );
    counts
        .iter()
        .for_each(|(word, count)| println!("- {word}: {count}"));
    println!("- systems without an answer for any seed: {unanswered}");
    println!("\n| system | seeds | what |\n|---|---|---|");
    named.iter().for_each(|line| println!("{line}"));
    println!("\nSilent disagreements: {silent}");
    ExitCode::from(u8::from(silent > 0))
}
