//! Another user of the machine can do nothing to a coordinator on loopback that has no tokens.

use cognate_tests::processes::{Process, cognate, until};
use cognate_tests::skip::skip;
use std::os::unix::process::CommandExt;
use std::process::{Command, Output};

/// Nobody's number on most systems; any that is not the test's will do.
const OTHER: u32 = 65_534;

fn start(folder: &std::path::Path, more: &str) -> (Process, String) {
    let words = |line: &str| {
        line.split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let place = folder.display();
    let line = format!(
        "coordinator --listen 127.0.0.1:0 --ledger sqlite:{place}/ledger.db --results {place}/results {more}"
    );
    let coordinator = Process::start(folder, "coordinator", &words(&line));
    let address = until("the coordinator says where it listens", || {
        let log = coordinator.log();
        let rest = log.split("listening on http://").nth(1)?;
        let (address, _) = rest.split_once(char::is_whitespace)?;
        Some(format!("http://{address}"))
    });
    (coordinator, address)
}

#[test]
fn another_user_can_do_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // A copy that the other user may run, wherever the program was built.
    let program = std::env::temp_dir().join(format!("cognate-other-{}", std::process::id()));
    std::fs::copy(cognate(), &program).expect("there is room for a copy");
    let run = |user: Option<u32>, address: &str, arguments: &[&str]| -> std::io::Result<Output> {
        let mut command = Command::new(&program);
        command.args(arguments).env("COGNATE_COORDINATOR", address);
        command.current_dir("/");
        if let Some(user) = user {
            command.uid(user).gid(user);
        }
        command.output()
    };
    let (mut coordinator, address) = start(folder.path(), "");
    let owner_jobs = run(None, &address, &["jobs"]).expect("it starts");
    assert_eq!(owner_jobs.status.code(), Some(0), "{owner_jobs:?}");
    if run(Some(OTHER), &address, &["--version"]).is_err() {
        skip("only root can become another user");
        let _ = std::fs::remove_file(&program);
        return;
    }
    for arguments in [
        &["jobs"][..],
        &["workers"],
        &["cancel", "0123456789abcdef"],
        &["delete", "0123456789abcdef"],
    ] {
        let refused = run(Some(OTHER), &address, arguments).expect("it starts");
        assert_eq!(refused.status.code(), Some(3), "{arguments:?}: {refused:?}");
    }
    let log = coordinator.log();
    assert!(
        log.contains("another user is refused") && log.contains("65534"),
        "{log}"
    );
    let owner_jobs = run(None, &address, &["jobs"]).expect("it starts");
    assert_eq!(owner_jobs.status.code(), Some(0), "{owner_jobs:?}");
    coordinator.kill();
    // A coordinator that serves all users is started with `--insecure`.
    let open = folder.path().join("open");
    std::fs::create_dir(&open).expect("there is room");
    let (_coordinator, address) = start(&open, "--insecure");
    let taken = run(Some(OTHER), &address, &["jobs"]).expect("it starts");
    assert_eq!(taken.status.code(), Some(0), "{taken:?}");
    let _ = std::fs::remove_file(&program);
}
