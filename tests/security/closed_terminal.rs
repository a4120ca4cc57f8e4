//! A closed terminal ends a solve as an interruption does, and leaves nothing (third attack, T and U).

use crate::long_system::long_system;
use cognate_tests::processes::{PATIENCE, Process, until};
use std::fs::{read_dir, set_permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.unwrap().path());
    entries.collect()
}

fn mode(path: &Path) -> u32 {
    let about = std::fs::symlink_metadata(path).expect("it is there");
    about.permissions().mode() & 0o777
}

#[test]
fn a_solve_whose_terminal_is_closed_tidies_up() {
    let folder = tempfile::tempdir().unwrap();
    set_permissions(folder.path(), PermissionsExt::from_mode(0o755)).unwrap();
    let temporary = folder.path().join("temporary");
    std::fs::create_dir(&temporary).unwrap();
    std::fs::write(folder.path().join("long.bertini"), long_system(16)).unwrap();
    let environment = [("TMPDIR".to_owned(), temporary.display().to_string())];
    let arguments = ["solve", "long.bertini", "--workers", "1"].map(str::to_owned);
    let mut solve = Process::start_within(&[], &environment, folder.path(), "solve", &arguments);
    let (solve_folder, log) = until("a worker tracks paths", || {
        let solve_folder = entries(&temporary).pop()?;
        let log = entries(&solve_folder)
            .into_iter()
            .find(|path| path.extension().is_some_and(|extension| extension == "log"))?;
        let says = std::fs::read_to_string(&log).unwrap_or_default();
        says.contains("tracking").then_some((solve_folder, log))
    });
    assert_eq!((mode(&solve_folder), mode(&log)), (0o700, 0o600));
    solve.hang_up();
    let status = solve.wait(PATIENCE);
    assert_eq!(status.code(), Some(130), "{}", solve.log());
    assert_eq!(entries(&temporary), Vec::<PathBuf>::new());
}
