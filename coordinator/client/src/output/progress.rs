//! Progress while a job runs: a bar on a terminal, a line every few seconds elsewhere, nothing when asked for JSON.
//! For programs that show a display of their own: JSON lines.

use super::text::{count, counted, rate, seconds};
use crate::arguments::ProgressForm;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write as _;
use std::time::{Duration, Instant};

/// Time between two plain lines: long enough for a log file, short enough to see life.
const PLAIN_INTERVAL: Duration = Duration::from_secs(5);

/// Where a job stands, in the words of the display.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Standing {
    /// Present work, like "tracking" or "stage 2: tracking again".
    pub phase: String,
    /// Paths (items of the open stages) that have ended.
    pub done: u64,
    /// Paths that are known to be asked for so far.
    pub total: u64,
    /// Paths in chunks that failed so far.
    pub failed: u64,
    /// Unit of the counts, like "path".
    pub unit: &'static str,
}

/// How progress is shown.
enum Display {
    Bar(ProgressBar),
    Plain {
        last: Option<Instant>,
        shown: Option<Standing>,
    },
    Lines {
        shown: Option<Standing>,
        take: Box<dyn Fn(&serde_json::Value)>,
    },
    Silent,
}

/// Progress of one job on standard error.
pub struct Progress {
    display: Display,
    began: Instant,
}

impl Progress {
    /// No display at all, not even on a terminal.
    pub fn silent() -> Self {
        Self {
            display: Display::Silent,
            began: Instant::now(),
        }
    }

    /// Objects of JSON, which this function takes.
    pub fn told(take: impl Fn(&serde_json::Value) + 'static) -> Self {
        Self {
            display: Display::Lines {
                shown: None,
                take: Box::new(take),
            },
            began: Instant::now(),
        }
    }

    /// The display that was asked for; `quiet`: see `new`.
    pub fn of(form: ProgressForm, quiet: bool, now: Instant) -> Self {
        match form {
            ProgressForm::Auto => Self::new(quiet, now),
            ProgressForm::Json => Self {
                began: now,
                ..Self::told(write_line)
            },
            ProgressForm::None => Self::silent(),
        }
    }

    /// The display that fits: `quiet` (JSON was asked for) shows a bar on a terminal and nothing elsewhere.
    pub fn new(quiet: bool, now: Instant) -> Self {
        let term = console::Term::stderr();
        let display = if term.is_term() {
            let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::term(term, 12));
            bar.set_style(style());
            bar.enable_steady_tick(Duration::from_millis(120));
            Display::Bar(bar)
        } else if quiet {
            Display::Silent
        } else {
            Display::Plain {
                last: None,
                shown: None,
            }
        };
        Self {
            display,
            began: now,
        }
    }

    /// Shows where the job stands.
    pub fn show(&mut self, standing: &Standing, now: Instant) {
        let began = self.began;
        match &mut self.display {
            Display::Bar(bar) => {
                bar.set_length(standing.total);
                bar.set_position(standing.done);
                bar.set_prefix(standing.phase.clone());
                bar.set_message(match standing.failed {
                    0 => String::new(),
                    _ => format!("{} ", notes(standing)),
                });
            }
            Display::Plain { last, shown } => {
                // The first line waits too: a job that takes a second needs none.
                let since = last.unwrap_or(began);
                if now.duration_since(since) >= PLAIN_INTERVAL && shown.as_ref() != Some(standing) {
                    eprintln!("{}", plain_line(standing, now.duration_since(began)));
                    *last = Some(now);
                    *shown = Some(standing.clone());
                }
            }
            Display::Lines { shown, take } => {
                if shown.as_ref() != Some(standing) {
                    take(&json_line(standing, now.duration_since(began)));
                    *shown = Some(standing.clone());
                }
            }
            Display::Silent => {}
        }
    }

    /// A line above the bar, or simply a line.
    pub fn say(&self, line: &str) {
        match &self.display {
            Display::Bar(bar) => bar.suspend(|| eprintln!("{line}")),
            Display::Plain { .. } => eprintln!("{line}"),
            Display::Lines { take, .. } => take(&serde_json::json!({ "message": line })),
            Display::Silent => {}
        }
    }

    /// Takes the bar away.
    pub fn finish(self) {
        if let Display::Bar(bar) = self.display {
            bar.finish_and_clear();
        }
    }
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template(
        "{spinner:.cyan} {prefix} {wide_bar:.cyan/dim} {human_pos}/{human_len} {msg}{elapsed} ",
    )
    .expect("the template is constant and well formed")
    .progress_chars("━╸─")
}

fn notes(standing: &Standing) -> String {
    format!("{} failed", count(standing.failed))
}

fn plain_line(standing: &Standing, elapsed: Duration) -> String {
    let elapsed = elapsed.as_secs_f64();
    let mut line = format!(
        "{}: {} of {}",
        standing.phase,
        count(standing.done),
        counted(standing.total, standing.unit)
    );
    if standing.done > 0 && elapsed > 0.0 {
        line.push_str(&format!(
            ", {} {}s/s",
            rate(standing.done as f64 / elapsed),
            standing.unit
        ));
    }
    if standing.failed > 0 {
        line.push_str(&format!(", {}", notes(standing)));
    }
    line.push_str(&format!(", {}", seconds(elapsed)));
    line
}

/// A standing as programs read it; `seconds` since the display began.
fn json_line(standing: &Standing, elapsed: Duration) -> serde_json::Value {
    serde_json::json!({
        "phase": standing.phase,
        "done": standing.done,
        "total": standing.total,
        "failed": standing.failed,
        "unit": standing.unit,
        "seconds": elapsed.as_secs_f64(),
    })
}

/// Writes a line to standard error. That nobody reads there any more is no reason to stop solving.
fn write_line(value: &serde_json::Value) {
    let _ = writeln!(std::io::stderr(), "{value}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plain_line_says_where_the_job_stands() {
        let standing = Standing {
            phase: "tracking".into(),
            done: 12_000,
            total: 143_360,
            failed: 3,
            unit: "path",
        };
        assert_eq!(
            plain_line(&standing, Duration::from_secs(60)),
            "tracking: 12,000 of 143,360 paths, 200 paths/s, 3 failed, 1 min 00 s"
        );
        let counting = Standing {
            phase: "counting mixed cells, 7 cells so far".into(),
            done: 12,
            total: 1024,
            failed: 0,
            unit: "part",
        };
        assert_eq!(
            plain_line(&counting, Duration::from_secs(12)),
            "counting mixed cells, 7 cells so far: 12 of 1,024 parts, 1.0 parts/s, 12.0 s"
        );
    }

    #[test]
    fn a_json_line_says_the_same_to_programs() {
        let standing = Standing {
            phase: "tracking".into(),
            done: 12,
            total: 40,
            failed: 3,
            unit: "path",
        };
        let line = json_line(&standing, Duration::from_millis(1500));
        assert_eq!(
            line.to_string(),
            r#"{"done":12,"failed":3,"phase":"tracking","seconds":1.5,"total":40,"unit":"path"}"#
        );
    }

    #[test]
    fn the_template_is_well_formed() {
        style();
    }
}
