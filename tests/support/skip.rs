//! Skip: a test that cannot be run on this machine says so where it is counted.

use std::io::Write;

/// Says that a test is skipped and why, and adds a line to the file that `COGNATE_SKIPS` names, which
/// `tests/run.sh` counts at its end. The caller returns.
///
/// # Panics
/// With `CI=true` in the environment: there everything must run.
pub fn skip(why: &str) {
    println!("skipped: {why}");
    if let Some(path) = std::env::var_os("COGNATE_SKIPS") {
        let file = std::fs::File::options()
            .append(true)
            .create(true)
            .open(path);
        let test = std::thread::current().name().unwrap_or("a test").to_owned();
        let why = why.replace('\n', " ");
        // One write, so that lines of tests that run at once stay whole.
        let written =
            file.and_then(|mut file| file.write_all(format!("{test}: {why}\n").as_bytes()));
        written.expect("the file of skips can be written");
    }
    let in_ci = std::env::var_os("CI").is_some_and(|value| value == "true");
    assert!(!in_ci, "skipped, and CI=true: {why}");
}
