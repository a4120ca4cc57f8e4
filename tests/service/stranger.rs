//! A client that is not ours: `tests/stranger/stranger.py`, over TCP, by reflection alone.

use cognate_tests::processes::{PATIENCE, Process, until};
use cognate_tests::skip::skip;
use std::path::Path;
use std::process::Command;

#[test]
fn a_stranger_solves_by_reflection() {
    let Some(python) = std::env::var_os("COGNATE_STRANGER_PYTHON") else {
        skip(
            "tests/run.sh installs grpcio and sets COGNATE_STRANGER_PYTHON to the Python that has it",
        );
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let words = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let place = folder.path().display();
    let line = format!(
        "coordinator --listen 127.0.0.1:0 --ledger sqlite:{place}/ledger.db --results {place}/results"
    );
    let coordinator = Process::start(folder.path(), "coordinator", &words(&line));
    let address = until("the coordinator says where it listens", || {
        let log = coordinator.log();
        let rest = log.split("listening on http://").nth(1)?;
        let (address, _) = rest.split_once(char::is_whitespace)?;
        Some(address.to_owned())
    });
    let line = format!("worker --coordinator http://{address} --threads 1");
    let mut worker = Process::start(folder.path(), "worker", &words(&line));
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("stranger/stranger.py");
    let output = Command::new(python)
        .arg(script)
        .arg(&address)
        .output()
        .expect("Python can be started");
    let (out, errors) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(output.status.success(), "{out}{errors}");
    assert!(out.contains("1.414"), "{out}");
    worker.terminate();
    assert_eq!(worker.wait(PATIENCE).code(), Some(0));
}
