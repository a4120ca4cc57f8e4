//! `cognate top`: jobs, workers and rates of a coordinator, as they change; without a terminal, once.

use crate::arguments::Top;
use crate::commands::{jobs, workers};
use crate::connection::Connection;
use crate::error::{ClientError, Exit};
use crate::output;
use crate::output::rates::Rates;
use crate::output::screen::Screen;
use crate::output::text::{Columns, Look, count, counted, cut, rate, seconds};
use cognate_protocol::v1::{JobOverview, JobState, WorkerOverview};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// How often the keyboard is looked at.
const TICK: Duration = Duration::from_millis(100);
/// Columns of a bar.
const BAR: u64 = 16;

/// Data of one refresh of the display.
struct Standing {
    address: String,
    jobs: Vec<JobOverview>,
    workers: Vec<WorkerOverview>,
    /// Why the data is older than this refresh; empty if it is current.
    trouble: String,
}

/// Shows until `q` is typed or somebody interrupts it; once where standard output is no terminal.
pub async fn run(a: &Top) -> Result<Exit, ClientError> {
    let target = a.service.target()?;
    let mut connection = Connection::open(&target).await?;
    let mut standing = Standing {
        address: target.name().to_owned(),
        jobs: connection.jobs().await?,
        workers: connection.workers().await?,
        trouble: String::new(),
    };
    let mut rates = Rates::default();
    let screen = match a.once {
        true => None,
        false => Screen::open(),
    };
    let Some(mut screen) = screen else {
        let look = Look::of_standard_output();
        output::print(&frame(&standing, &mut rates, look, usize::MAX, now()))?;
        return Ok(Exit::Solved);
    };
    let every = Duration::from_secs_f64(a.every);
    loop {
        let (rows, look) = screen.size();
        screen.show(&frame(&standing, &mut rates, look, rows, now()));
        let until = Instant::now() + every;
        while Instant::now() < until {
            if screen
                .key()
                .is_some_and(|key| matches!(key, b'q' | b'Q' | 27))
            {
                return Ok(Exit::Solved);
            }
            tokio::time::sleep(TICK.min(every)).await;
        }
        let looked = async {
            let jobs = connection.jobs().await?;
            Ok::<_, ClientError>((jobs, connection.workers().await?))
        };
        match looked.await {
            Ok((jobs, workers)) => {
                standing = Standing {
                    jobs,
                    workers,
                    trouble: String::new(),
                    ..standing
                };
            }
            Err(lost @ ClientError::Unreachable { .. }) => {
                standing.trouble = lost.to_string();
                if let Ok(reopened_connection) = Connection::open_at_once(&target).await {
                    connection = reopened_connection;
                }
            }
            Err(other) => return Err(other),
        }
    }
}

/// Seconds since 1970.
fn now() -> f64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    now.unwrap_or_default().as_secs_f64()
}

/// The display, in at most `rows` lines; `now` in seconds since 1970.
fn frame(standing: &Standing, rates: &mut Rates, look: Look, rows: usize, now: f64) -> String {
    let in_state = |state| standing.jobs.iter().filter(|j| j.state() == state).count() as u64;
    let (running, queued) = (in_state(JobState::Running), in_state(JobState::Queued));
    let threads: u64 = standing.workers.iter().map(|w| u64::from(w.threads)).sum();
    for worker in &standing.workers {
        rates.saw(&worker.worker, worker.accepted_paths, now);
    }
    for job in &standing.jobs {
        rates.saw(&job.job, job.items_accepted, now);
    }
    let total_rate: Option<f64> = standing.workers.iter().map(|w| rates.of(&w.worker)).sum();
    let head = format!(
        "{}  {} running, {} waiting; {} of {}; {} paths/s",
        standing.address,
        counted(running, "job"),
        count(queued),
        counted(standing.workers.len() as u64, "worker"),
        counted(threads, "thread"),
        total_rate.map_or_else(|| "?".to_owned(), rate),
    );
    let mut lines = vec![look.bold(&cut(&head, look.width))];
    if !standing.trouble.is_empty() {
        lines.push(look.bad(&cut(&standing.trouble, look.width)));
    }
    lines.push(String::new());
    let jobs = job_table(standing, rates, look, now);
    let workers = worker_table(standing, rates, look);
    // Both have room, and what one does not need is the other's.
    let room = rows.saturating_sub(lines.len() + 2);
    let for_workers = workers
        .len()
        .min((room / 2).max(room.saturating_sub(jobs.len())));
    let for_jobs = jobs.len().min(room.saturating_sub(for_workers));
    lines.extend(shortened(jobs, for_jobs, look));
    lines.push(String::new());
    lines.extend(shortened(workers, for_workers, look));
    lines.join("\n") + "\n"
}

/// The first lines, the last of which says how many are missing.
fn shortened(mut lines: Vec<String>, room: usize, look: Look) -> Vec<String> {
    if lines.len() > room {
        let missing = lines.len() - room.saturating_sub(1);
        lines.truncate(room.saturating_sub(1));
        lines.push(look.dim(&format!("and {} more", count(missing as u64))));
    }
    lines
}

/// The jobs, those that go on first.
fn job_table(standing: &Standing, rates: &Rates, look: Look, now: f64) -> Vec<String> {
    if standing.jobs.is_empty() {
        return vec!["no jobs yet; `cognate submit FILE` makes one".to_owned()];
    }
    let mut columns = Columns::new(&[
        "NAME", "STATE", "PROGRESS", ">PATHS", ">OF", ">PATHS/S", ">LEFT", ">AGE", "JOB",
    ]);
    let order = |job: &&JobOverview| match job.state() {
        JobState::Running => 0,
        JobState::Queued => 1,
        _ => 2,
    };
    let mut jobs: Vec<&JobOverview> = standing.jobs.iter().collect();
    jobs.sort_by_key(order);
    for job in jobs {
        let goes_on = job.state() == JobState::Running;
        let speed = rates.of(&job.job).filter(|_| goes_on);
        let left = job.items_total.saturating_sub(job.items_accepted);
        let left = speed.filter(|s| *s > 0.0).map(|s| left as f64 / s);
        columns.row(vec![
            cut(&job.name, 28),
            output::json::state_name(job.state()).to_owned(),
            bar(job.items_accepted, job.items_total),
            count(job.items_accepted),
            count(job.items_total),
            speed.map(rate).unwrap_or_default(),
            left.map(seconds).unwrap_or_default(),
            jobs::age(now - job.submitted_unix_ms as f64 / 1e3),
            job.job.clone(),
        ]);
    }
    columns.cut_lines(look)
}

/// The workers, those that track first.
fn worker_table(standing: &Standing, rates: &Rates, look: Look) -> Vec<String> {
    if standing.workers.is_empty() {
        return vec!["no workers; `cognate worker --coordinator URL` starts one".to_owned()];
    }
    let mut columns = Columns::new(&[
        "WORKER", "HOST", ">THREADS", "VIA", ">CHUNKS", ">PATHS", ">PATHS/S", "STATE",
    ]);
    let mut workers: Vec<&WorkerOverview> = standing.workers.iter().collect();
    workers.sort_by_key(|worker| worker.leased_chunks == 0);
    for worker in workers {
        columns.row(vec![
            cut(&worker.worker, 24),
            cut(&worker.host, 20),
            count(worker.threads.into()),
            worker.transport.clone(),
            count(worker.accepted_chunks),
            count(worker.accepted_paths),
            rates.of(&worker.worker).map(rate).unwrap_or_default(),
            workers::state(worker),
        ]);
    }
    columns.cut_lines(look)
}

/// A share as a bar; full only where nothing is left.
fn bar(done: u64, total: u64) -> String {
    let filled = match total {
        0 => 0,
        total => u64::try_from(u128::from(done.min(total)) * u128::from(BAR) / u128::from(total))
            .unwrap_or(BAR),
    };
    let empty = BAR - filled;
    "█".repeat(filled as usize) + &"░".repeat(empty as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standing(jobs: u32) -> Standing {
        let job = |k: u32| JobOverview {
            job: format!("job-{k}"),
            name: format!("file{k}.bertini"),
            state: match k {
                1 => JobState::Running.into(),
                _ => JobState::Solved.into(),
            },
            items_total: 200,
            items_accepted: if k == 1 { 50 } else { 200 },
            ..JobOverview::default()
        };
        Standing {
            address: "http://head:7654".to_owned(),
            jobs: (0..jobs).map(job).collect(),
            workers: vec![WorkerOverview {
                worker: "w".to_owned(),
                threads: 4,
                leased_chunks: 1,
                accepted_paths: 50,
                ..WorkerOverview::default()
            }],
            trouble: String::new(),
        }
    }

    const LOOK: Look = Look {
        width: 120,
        color: false,
    };

    #[test]
    fn jobs_that_go_on_stand_first_with_their_rate() {
        let (mut first, mut rates) = (standing(3), Rates::default());
        frame(&first, &mut rates, LOOK, usize::MAX, 0.0);
        first.jobs[1].items_accepted = 100;
        first.workers[0].accepted_paths = 100;
        let shown = frame(&first, &mut rates, LOOK, usize::MAX, 2.0);
        let lines: Vec<&str> = shown.lines().collect();
        assert_eq!(
            lines[0],
            "http://head:7654  1 job running, 0 waiting; 1 worker of 4 threads; 25.0 paths/s"
        );
        assert!(
            lines[3].starts_with(
                "file1.bertini  running  ████████░░░░░░░░    100  200     25.0  4.00 s"
            )
        );
        assert!(lines[4].starts_with("file0.bertini  solved   ████████████████    200  200"));
        assert!(lines.last().unwrap().ends_with("tracking"));
    }

    #[test]
    fn a_small_terminal_is_told_what_it_does_not_show() {
        let mut rates = Rates::default();
        let shown = frame(&standing(40), &mut rates, LOOK, 12, 0.0);
        assert!(shown.lines().count() <= 12, "{shown}");
        assert!(shown.contains("and 36 more"), "{shown}");
        let none = Standing {
            jobs: vec![],
            workers: vec![],
            trouble: "gone".to_owned(),
            ..standing(0)
        };
        let shown = frame(&none, &mut rates, LOOK, 12, 0.0);
        assert!(
            shown.contains("gone") && shown.contains("no jobs yet"),
            "{shown}"
        );
    }

    #[test]
    fn only_what_is_done_fills_a_bar() {
        assert_eq!(bar(199, 200).matches('█').count(), 15);
        assert_eq!(bar(200, 200).matches('█').count(), 16);
        assert_eq!(bar(0, 0).matches('░').count(), 16);
    }
}
