//! Whole solves against PHCpack's black box, on the same file in the same run.
//!
//! `cargo bench -p cognate-tests --bench end_to_end`, on one thread; `phc` (apt:
//! `phcpack`) is asked where it is installed. CPU seconds on both sides; ours are
//! those of tracking and classification, without start-up, `phc`'s are of its
//! process (which starts in milliseconds).
//!
//! Figures of 2026-11-21, two shared cores of an AMD EPYC with AVX-512, `phc` 2.4.86, best of three
//! seeds on our side, one run on theirs; other builds ran beside it on both sides:
//!
//! ```text
//! system            paths  distinct  tracking CPU s  paths/s   phc -b CPU s   ratio
//! katsura-10         1024      1024          0.2878     3558          45.60     158
//! Stewart-Gough       128        84          0.0933     1371          11.14     119
//! noon-5              243       233          0.0064    38055           1.90     298
//! cyclic-5            120        70          0.0255     4710           0.20       8
//! ```
//!
//! Not like for like: on cyclic-5 `phc` takes a polyhedral start and follows 70 paths, where ours
//! follows 120 by total degree.

use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{PlanOptions, plan};
use cognate_systems::formats::{self, FileSettings, Format};
use cognate_systems::named::{cyclic, eco, katsura, noon};
use std::path::Path;
use std::process::Command;

/// CPU seconds of this thread so far; `None` where the system does not tell.
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// CPU seconds of `phc -b` on this file, or why there are none.
fn phc(input: &Path, folder: &Path) -> Result<f64, String> {
    let copy = folder.join("phc_input"); // phc writes into its input
    std::fs::copy(input, &copy).map_err(|error| error.to_string())?;
    let output = Command::new("bash")
        .arg("-c")
        .arg("TIMEFORMAT='%U %S'; time phc -b -0 \"$1\" \"$2\" >/dev/null 2>/dev/null")
        .args([
            "bash",
            &copy.to_string_lossy(),
            &folder.join("phc_output").to_string_lossy(),
        ])
        .output()
        .map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err("phc is not installed or failed".into());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    let times: Vec<f64> = text
        .split_whitespace()
        .filter_map(|t| t.parse().ok())
        .collect();
    match times[..] {
        [user, system] => Ok(user + system),
        _ => Err(format!("no times in {text:?}")),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = tempfile::tempdir()?;
    println!("system            paths  distinct  tracking CPU s  paths/s   phc -b CPU s   ratio");
    let file = "tests/systems/stewart_gough_dietmaier/system.bertini";
    let platform = formats::read(file, &std::fs::read(root.join(file))?)?.system;
    let file = "tests/systems/six_revolute_manseur_doty_tm8/system.bertini";
    let arm = formats::read(file, &std::fs::read(root.join(file))?)?.system;
    let only: Option<String> = std::env::args().nth(1).filter(|a| !a.starts_with('-'));
    for (name, system) in [
        ("katsura-10", katsura(10).system),
        ("Stewart-Gough", platform),
        ("6R", arm),
        ("noon-5", noon(5).system),
        ("cyclic-5", cyclic(5).system),
        ("cyclic-7", cyclic(7).system),
        ("eco-8", eco(8).system),
    ] {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        // One PHCpack file, which both read.
        let text = formats::write(Format::Phcpack, &system, &FileSettings::default())?;
        let input = folder.path().join("input.phc");
        std::fs::write(&input, &text)?;
        let system = formats::read("input.phc", text.as_bytes())?.system;
        let mut best = f64::INFINITY;
        let mut counts = (0, 0, 0);
        for seed in 1..=3 {
            let options = PlanOptions {
                seed,
                ..PlanOptions::default()
            };
            let mut plan = plan(&system, &options)?;
            let before = cpu_seconds().ok_or("no /proc/thread-self/schedstat here")?;
            let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 16)?;
            let after = cpu_seconds().ok_or("no /proc/thread-self/schedstat here")?;
            best = best.min(after - before);
            let paths = &sets[0].paths;
            counts = (paths.total, sets[0].counts.distinct, paths.failed);
        }
        let (paths, distinct, failed) = counts;
        let rate = paths as f64 / best;
        print!("{name:16} {paths:6} {distinct:9} {best:15.4} {rate:8.0}");
        match phc(&input, folder.path()) {
            Ok(seconds) => println!(" {seconds:14.2} {:7.0}", seconds / best),
            Err(why) => println!("   {why}"),
        }
        if failed > 0 {
            println!("  {failed} paths failed");
        }
    }
    Ok(())
}
