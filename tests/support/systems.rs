//! The systems of `tests/systems`, by name.

use cognate_systems::formats;
use cognate_systems::system::System;
use std::path::Path;

/// The system in `tests/systems/NAME/FILE`.
///
/// # Panics
/// When it is not there or cannot be read.
pub fn from_file(name: &str, file: &str) -> System {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("systems")
        .join(name);
    let path = folder.join(file);
    let content = match std::fs::read(&path) {
        Ok(content) => content,
        Err(error) => panic!("{}: {error}", path.display()),
    };
    match formats::read(file, &content) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}

/// The system in `tests/systems/NAME/system.bertini`.
pub fn shared(name: &str) -> System {
    from_file(name, "system.bertini")
}

/// The same with pairs of conjugate variables.
pub fn with_conjugates(mut system: System, pairs: &str) -> System {
    if let Err(error) = formats::options::conjugates(pairs, &mut system) {
        panic!("{error}");
    }
    system
}

/// A system written down in a test, in the notation of Bertini-classic.
pub fn written(input: &str) -> System {
    let text = format!("CONFIG\nEND;\nINPUT\n{input}\nEND;\n");
    match formats::read("written", text.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}
