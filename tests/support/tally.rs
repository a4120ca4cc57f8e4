//! Tally: verdicts on several seeds of one problem with a known answer, as a line of a table.

use crate::measures::cpu_seconds;
use std::ops::Range;

/// Verdict on one seed.
pub enum Verdict {
    /// The known answer.
    Right,
    /// A doubt that is named.
    Unsettled,
    /// Another answer, without a doubt.
    Wrong,
    /// No answer in time, or none at all.
    Unfinished,
}

/// Counts of verdicts, CPU seconds of each seed, and notes.
#[derive(Default)]
pub struct Tally {
    right: u64,
    unsettled: u64,
    wrong: u64,
    unfinished: u64,
    seconds: Vec<f64>,
    notes: Vec<String>,
}

impl Tally {
    /// The head of the table; `what` is the heading of the first column.
    pub fn head(what: &str) -> String {
        format!(
            "| {what} | right | unsettled | wrong | not done | least CPU s | median | most |\n\
             |---|---|---|---|---|---|---|---|"
        )
    }

    /// Runs `ask` with each seed; it returns a verdict and a note.
    ///
    /// # Errors
    /// When the system does not tell CPU seconds.
    pub fn of(
        seeds: Range<u64>,
        mut ask: impl FnMut(u64) -> (Verdict, Option<String>),
    ) -> Result<Self, String> {
        let mut tally = Self::default();
        for seed in seeds {
            let began = cpu_seconds().map_err(|e| e.to_string())?;
            let (verdict, note) = ask(seed);
            let now = cpu_seconds().map_err(|e| e.to_string())?;
            tally.seconds.push(now - began);
            let notes = note.map(|note| format!("seed {seed}: {note}"));
            tally.notes.extend(notes);
            *match verdict {
                Verdict::Right => &mut tally.right,
                Verdict::Unsettled => &mut tally.unsettled,
                Verdict::Wrong => &mut tally.wrong,
                Verdict::Unfinished => &mut tally.unfinished,
            } += 1;
        }
        tally.seconds.sort_by(f64::total_cmp);
        Ok(tally)
    }

    /// The line of the table for this problem.
    pub fn line(&self, name: &str) -> String {
        let second = |place: usize| self.seconds.get(place).copied().unwrap_or(0.0);
        let most = self.seconds.len().saturating_sub(1);
        format!(
            "| {name} | {} | {} | {} | {} | {:.2} | {:.2} | {:.2} |",
            self.right,
            self.unsettled,
            self.wrong,
            self.unfinished,
            second(0),
            second(most / 2),
            second(most)
        )
    }

    /// Notes on the seeds, one for each seed that needs one.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// How many answers were wrong.
    pub fn wrong(&self) -> u64 {
        self.wrong
    }
}
