//! Wanted: what a run is to be like.

use cognate_tests::arguments::{number, options as arguments};
use std::time::Duration;

/// Settings of the program.
pub struct Wanted {
    /// Time during which jobs begin, in seconds.
    pub seconds: u64,
    /// Seed of all chance.
    pub seed: u64,
    /// Whether the ledger is a PostgreSQL database.
    pub postgres: bool,
    /// Whether the results are in a bucket of S3, not in a folder.
    pub bucket: bool,
    /// Number of coordinators: one, or two over one database.
    pub coordinators: usize,
    /// Number of jobs after which the run ends.
    pub jobs: u64,
    /// Number n of Katsura's system, which has 2^n paths.
    pub katsura: usize,
    /// Precision of the tracking; None: as much as each path needs.
    pub bits: Option<u32>,
    /// Least and greatest pause between two faults, in milliseconds.
    pub pause_ms: (u64, u64),
    /// Length of a lease.
    pub lease: Duration,
    /// Whether results are damaged and lost.
    pub storage_faults: bool,
    /// Whether one worker of each evil kind takes part.
    pub evil_workers: bool,
}

/// Reads the settings from the arguments.
pub fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        seconds: 30,
        seed: 1,
        postgres: false,
        bucket: false,
        coordinators: 1,
        jobs: u64::MAX,
        katsura: 11,
        bits: None,
        pause_ms: (500, 2000),
        lease: Duration::from_secs(2),
        storage_faults: false,
        evil_workers: false,
    };
    for (word, value) in arguments()? {
        match word.as_str() {
            "--seconds" => wanted.seconds = number(&word, &value)?,
            "--seed" => wanted.seed = number(&word, &value)?,
            "--ledger" if value == "sqlite" => wanted.postgres = false,
            "--ledger" if value == "postgres" => wanted.postgres = true,
            "--results" if value == "folder" => wanted.bucket = false,
            "--results" if value == "s3" => wanted.bucket = true,
            "--coordinators" => wanted.coordinators = number(&word, &value)?,
            "--jobs" => wanted.jobs = number(&word, &value)?,
            "--katsura" => wanted.katsura = number(&word, &value)?,
            "--bits" => wanted.bits = Some(number(&word, &value)?),
            "--lease-ms" => wanted.lease = Duration::from_millis(number(&word, &value)?),
            "--pause-ms" => wanted.pause_ms = range(&value)?,
            "--storage-faults" => wanted.storage_faults = yes(&word, &value)?,
            "--evil-workers" => wanted.evil_workers = yes(&word, &value)?,
            _ => {
                return Err(format!(
                    "{word} {value}: expected --seconds N, --seed N, --ledger sqlite|postgres, \
                     --results folder|s3, \
                     --coordinators N, --jobs N, --katsura N, --bits N, --pause-ms LEAST-GREATEST, \
                     --lease-ms N, --storage-faults yes|no or --evil-workers yes|no"
                ));
            }
        }
    }
    match (wanted.coordinators, wanted.postgres) {
        (1, _) | (2, true) => Ok(wanted),
        (2, false) => Err("--coordinators 2: two of them need --ledger postgres".to_owned()),
        _ => Err("--coordinators: expected 1 or 2".to_owned()),
    }
}

fn yes(word: &str, value: &str) -> Result<bool, String> {
    match value {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err(format!("{word} {value}: expected yes or no")),
    }
}

/// `LEAST-GREATEST`.
fn range(text: &str) -> Result<(u64, u64), String> {
    let parsed = text.split_once('-').and_then(|(least, greatest)| {
        let range = (least.parse().ok()?, greatest.parse().ok()?);
        (range.0 < range.1).then_some(range)
    });
    parsed.ok_or_else(|| format!("--pause-ms {text}: expected two numbers, for instance 500-2000"))
}
