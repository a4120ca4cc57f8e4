//! Rules that every ledger, in memory or in a database, computes alike.

use super::LedgerError;
use super::identity::{ItemRange, WorkerId};
use super::rows::StageRow;

/// Time since a worker's last call up to which it counts for the sizes of chunks, in milliseconds.
pub const PRESENT_MS: u64 = 60_000;
/// Time since a worker's last call up to which an audit waits for it, in milliseconds. A worker that waits or works
/// calls every 5 s, and a killed one holds a job up no longer than its lease and this.
pub const HEARD_MS: u64 = 15_000;
/// Largest charge of a chunk, in microseconds of CPU: a hundred days. Sums stay far from overflow.
pub const MOST_MICROS: u64 = 8_640_000_000_000;
/// Assumed cost of an item while nothing is measured, in microseconds of CPU.
pub const UNMEASURED_MICROS: u64 = 1000;
/// Distance in virtual time at which a new job begins behind its tenant's least served job, in microseconds of CPU.
/// Without it a job whose first chunk is done would wait for as long as new jobs arrive (Linux's scheduler puts a new
/// task a slice behind for this reason, too). About the time of a small job.
pub const NEW_JOB_MICROS: i64 = 10_000;

/// Estimated cost of `items` items of a stage, in microseconds of CPU.
pub fn estimate(items: u64, counts: &StageRow) -> i64 {
    let each = match counts.accepted.items {
        0 => UNMEASURED_MICROS,
        done => counts.cpu_micros / done,
    };
    items.saturating_mul(each).min(MOST_MICROS) as i64
}

/// Virtual time at which a job begins: behind the least served of its tenant's jobs, and not before those that still
/// wait for their first lease. The least virtual time goes back when the charge of a chunk proves too high, and
/// waiting jobs would then be overtaken by all later ones.
pub fn first_virtual_time(least: Option<i64>, waiting: Option<i64>) -> i64 {
    let behind = least.map_or(0, |least| least + NEW_JOB_MICROS);
    waiting.map_or(behind, |waiting| waiting.max(behind))
}

/// Refuses numbers that a ledger on a database could not hold.
pub fn check_size(what: &'static str, number: u64) -> Result<i64, LedgerError> {
    i64::try_from(number)
        .ok()
        .filter(|&n| n <= i64::MAX / 4)
        .ok_or(LedgerError::TooLarge(what))
}

/// True when the ranges make up `whole`, in order, each with at least one item.
pub fn make_up(ranges: impl IntoIterator<Item = ItemRange>, whole: ItemRange) -> bool {
    let mut next = whole.first;
    for range in ranges {
        if range.first != next || range.is_empty() {
            return false;
        }
        next = range.last;
    }
    next == whole.last
}

/// Why a job ends that has used results of a worker that was outvoted later.
pub fn tainted(worker: &WorkerId) -> String {
    format!(
        "worker {worker} computed wrongly, which an audit has shown, and results of it were used \
         before that: submit the job again"
    )
}
