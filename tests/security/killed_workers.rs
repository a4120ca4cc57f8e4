//! Workers of a solve that are killed, as by a system without memory, are started again: so often, and with a word each
//! time (third attack, T).

use crate::long_system::long_system;
use cognate_tests::processes::{PATIENCE, Process, until};
use std::path::Path;
use std::process::Command;

/// A solve of 2^n paths by `workers` worker processes, in a folder that is also the folder for temporary files.
fn solve(folder: &Path, n: usize, workers: &str) -> Process {
    std::fs::write(folder.join("long.bertini"), long_system(n)).unwrap();
    let environment = [("TMPDIR".to_owned(), folder.display().to_string())];
    let arguments = [
        "solve",
        "long.bertini",
        "--format",
        "json",
        "--workers",
        workers,
    ];
    let arguments = arguments.map(str::to_owned);
    Process::start_within(&[], &environment, folder, "solve", &arguments)
}

/// Processes that a process started and that have not ended.
fn children(process: u32) -> Vec<u32> {
    let numbers = std::fs::read_dir("/proc").expect("Linux says which processes there are");
    let numbers = numbers.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    numbers
        .filter(|number: &u32| {
            let stat = std::fs::read_to_string(format!("/proc/{number}/stat")).unwrap_or_default();
            // Behind the name, which may hold spaces: the state, and the parent.
            let fields = stat.rsplit(')').next().unwrap_or_default();
            let mut fields = fields.split_whitespace();
            let is_running = fields.next().is_some_and(|state| state != "Z");
            is_running && fields.next() == Some(process.to_string().as_str())
        })
        .collect()
}

/// `kill -9`; false where the process has ended already.
fn kill(process: u32) -> bool {
    let command = format!("kill -KILL {process}");
    let status = Command::new("sh").args(["-c", &command]).status();
    status.is_ok_and(|status| status.success())
}

/// Whether a worker of the solve in this folder has begun to track paths.
fn is_tracking(folder: &Path) -> bool {
    let entries = |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten();
    let folders = entries(folder).filter(|entry| entry.path().is_dir());
    let mut logs = folders.flat_map(|folder| entries(&folder.path()).collect::<Vec<_>>());
    logs.any(|log| {
        let says = std::fs::read_to_string(log.path()).unwrap_or_default();
        says.contains("tracking")
    })
}

#[test]
fn a_killed_worker_is_started_again_and_the_answer_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let mut solve = solve(folder.path(), 13, "1");
    until("the worker tracks paths", || {
        is_tracking(folder.path()).then_some(())
    });
    let worker = children(solve.id());
    assert!(worker.len() == 1 && kill(worker[0]), "{worker:?}");
    let status = solve.wait(PATIENCE);
    let log = solve.log();
    assert_eq!(status.code(), Some(0), "{log}");
    let said = "warning: worker 1 was killed (signal: 9 (SIGKILL)); another one is started in its place (1 of at most";
    assert!(log.contains(said), "{log}");
    assert!(log.contains("\"distinct\": 8192"), "{log}");
}

#[test]
fn a_solve_whose_workers_are_killed_again_and_again_ends_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let mut solve = solve(folder.path(), 16, "1");
    let mut killed = 0;
    while solve.is_alive() {
        killed += children(solve.id())
            .into_iter()
            .filter(|&worker| kill(worker))
            .count();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let status = solve.wait(PATIENCE);
    let log = solve.log();
    assert_eq!(status.code(), Some(3), "{log}");
    let said = "all workers have ended (signal: 9 (SIGKILL)); 12 were started again";
    assert!(log.contains(said), "{log}");
    assert_eq!(
        log.matches("another one is started in its place").count(),
        12
    );
    assert!(killed >= 13, "{killed}");
}
