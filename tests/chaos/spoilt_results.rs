//! Damage to the stored results of a running job: a bit of a chunk's results turned round, or the file lost.

use cognate_tests::dice::Dice;
use std::path::{Path, PathBuf};

/// Damages or removes the results of one chunk of the job below this folder. Says what it did; the name of the
/// file where something was done.
pub fn spoil(results: &Path, job: &str, dice: &mut Dice) -> (String, Option<String>) {
    let mut files: Vec<PathBuf> = std::fs::read_dir(results.join("jobs").join(job))
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.is_file())
        .collect();
    files.sort();
    if files.is_empty() {
        return ("nothing is stored yet".to_owned(), None);
    }
    let file = &files[dice.below(files.len() as u64) as usize];
    let name = file.file_name().unwrap_or_default();
    let name = name.to_string_lossy().into_owned();
    let lost = dice.below(2) == 0;
    // It may have gone meanwhile, with its job.
    let done = if lost {
        std::fs::remove_file(file)
    } else {
        std::fs::read(file).and_then(|mut bytes| {
            let place = dice.below(bytes.len().max(1) as u64) as usize;
            if let Some(byte) = bytes.get_mut(place) {
                *byte ^= 1 << dice.below(8);
            }
            std::fs::write(file, bytes)
        })
    };
    match done {
        Ok(()) if lost => (format!("{name} is lost"), Some(name)),
        Ok(()) => (format!("{name} has another bit"), Some(name)),
        Err(error) => (format!("{name}: {error}"), None),
    }
}
