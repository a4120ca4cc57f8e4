//! Tidy: the house's rules that a compiler does not keep.
//!
//! The map of crates and the drawing of `common/README.md` agree with the tree and with the manifests;
//! what is forbidden somewhere (unsafe, protobuf, clocks, stubs) is not there.

mod circles;
mod comments;
mod functions;
mod names;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A file of the repository: its path from the root, and its text.
struct File {
    path: String,
    text: String,
}

fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = manifest.parent().expect("tests/ stands in the repository");
    root.to_owned()
}

/// All files whose names end so, sorted; what git ignores is not among them.
fn files(ending: &str) -> Vec<File> {
    fn walk(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
        let entries = std::fs::read_dir(folder).expect("the repository can be read");
        for entry in entries {
            let path = entry.expect("the repository can be read").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if path.is_dir() {
                if !matches!(&*name, "target" | ".git") {
                    walk(&path, ending, found);
                }
            } else if name.ends_with(ending) {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    for folder in [
        "common",
        "worker",
        "coordinator",
        "tests",
        "deploy",
        "proto",
    ] {
        walk(&root().join(folder), ending, &mut found);
    }
    found.sort();
    let files = found.into_iter().map(|path| File {
        text: std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display())),
        path: path
            .strip_prefix(root())
            .expect("the walk began at the root")
            .to_string_lossy()
            .into_owned(),
    });
    let files: Vec<File> = files.collect();
    assert!(
        !files.is_empty(),
        "the walk found no file that ends with {ending}"
    );
    files
}

/// Source files; this folder names what it forbids, so it is left out.
fn sources() -> Vec<File> {
    let mut files = files(".rs");
    files.retain(|file| !file.path.starts_with("tests/tidy/"));
    assert!(
        files.len() > 100,
        "the walk found only {} files",
        files.len()
    );
    files
}

/// Fails with every offence named, one a line.
fn check(offences: Vec<String>) {
    assert!(offences.is_empty(), "\n{}", offences.join("\n"));
}

/// A line without its comment and without what stands in quotes.
fn code(line: &str) -> String {
    let mut code = String::new();
    let mut quoted = false;
    let mut before = ' ';
    for c in line.chars() {
        if c == '"' && before != '\\' {
            quoted = !quoted;
        }
        if !quoted {
            code.push(c);
            if code.ends_with("//") {
                return code;
            }
        }
        before = c;
    }
    code
}

/// Lines of code that name one of these, as `path:line: name`.
fn uses(file: &File, names: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for (number, line) in file.text.lines().enumerate() {
        let code = code(line);
        for name in names.iter().filter(|name| code.contains(**name)) {
            found.push(format!("{}:{}: {name}", file.path, number + 1));
        }
    }
    found
}

#[test]
fn every_source_file_says_what_stands_in_it() {
    let without = sources()
        .into_iter()
        .filter(|file| !file.text.starts_with("//! "));
    check(
        without
            .map(|file| format!("{} does not begin with `//! `", file.path))
            .collect(),
    );
}

#[test]
fn no_file_grows_beyond_900_lines() {
    let long = sources().into_iter().filter_map(|file| {
        let lines = file.text.lines().count();
        (lines > 900).then(|| {
            format!(
                "{} has {lines} lines: has a second noun moved in?",
                file.path
            )
        })
    });
    check(long.collect());
}

#[test]
fn unsafe_code_stands_in_four_files_alone() {
    let allowed = [
        "common/numeric/src/lanes/dispatch.rs",
        "common/machine_code/src/executable.rs",
        // It is called from C.
        "deploy/c/src/lib.rs",
        // Of no program that is shipped.
        "tests/support/coverage.rs",
    ];
    let mut offences = Vec::new();
    for file in sources() {
        if allowed.contains(&file.path.as_str()) {
            let lines: Vec<&str> = file.text.lines().collect();
            for (number, line) in lines.iter().enumerate() {
                let code = code(line);
                if !code.contains("unsafe") || code.contains("#[unsafe(no_mangle)]") {
                    continue;
                }
                // A function says what its callers answer for, a block why it may do what it does.
                let is_function = code.contains("unsafe fn") || code.contains("unsafe extern");
                let reason = if is_function {
                    "/// # Safety"
                } else {
                    "// SAFETY:"
                };
                let above = lines[number.saturating_sub(5)..number].join("\n");
                if !above.contains(reason) {
                    offences.push(format!("{}:{}: no `{reason}`", file.path, number + 1));
                }
            }
            continue;
        }
        for use_of in uses(&file, &["unsafe "]) {
            offences.push(use_of);
        }
        let begins_a_crate =
            file.path.ends_with("src/lib.rs") || file.path.ends_with("src/main.rs");
        if begins_a_crate
            && !allowed
                .iter()
                .any(|allowed| allowed.split('/').take(2).eq(file.path.split('/').take(2)))
            && !file.text.contains("#![forbid(unsafe_code)]")
        {
            offences.push(format!("{} does not forbid unsafe code", file.path));
        }
    }
    check(offences);
}

#[test]
fn only_the_edges_know_protobuf() {
    let edges = [
        "common/protocol/",
        "coordinator/src/api/",
        "coordinator/client/",
        "coordinator/src/intake.rs",
        "coordinator/src/page/",
        "coordinator/src/server.rs",
        "coordinator/src/transport/",
        "coordinator/tests/",
        "tests/",
        "worker/src/transport/",
    ];
    let mut offences = Vec::new();
    for file in sources() {
        if !edges.iter().any(|edge| file.path.starts_with(edge)) {
            let names = [
                "tonic::",
                "prost::",
                "cognate_protocol::v1",
                "use tonic",
                "use prost",
            ];
            offences.extend(uses(&file, &names));
        }
    }
    check(offences);
}

#[test]
fn the_client_knows_the_server_only_where_it_starts_one() {
    // Or where it reads what one has written.
    let starts = [
        "coordinator/client/src/commands/backup.rs",
        "coordinator/client/src/commands/coordinator.rs",
        "coordinator/client/src/commands/fsck.rs",
        // What it brings to the page of one.
        "coordinator/client/src/commands/mechanism/page.rs",
        "coordinator/client/src/commands/path.rs",
        "coordinator/client/src/config_file.rs",
        "coordinator/client/src/embedded.rs",
    ];
    let mut offences = Vec::new();
    for file in sources() {
        let is_client = file.path.starts_with("coordinator/client/");
        if is_client && !starts.contains(&file.path.as_str()) {
            offences.extend(uses(&file, &["cognate_coordinator"]));
        }
    }
    check(offences);
}

#[test]
fn mathematics_knows_no_clock_no_file_no_thread() {
    let mut offences = Vec::new();
    for file in sources() {
        // The solver of mechanisms stands above the mathematics: it keeps start positions in a folder that it is given, and
        // answers targets on several threads.
        let is_above = file.path.starts_with("common/mechanism_solver/");
        let is_common = file.path.starts_with("common/") && file.path.contains("/src/");
        if is_common && !is_above {
            // What stands below `mod tests` is not the mathematics.
            let text = file
                .text
                .split("#[cfg(test)]\nmod ")
                .next()
                .unwrap_or_default();
            let file = File {
                path: file.path,
                text: text.to_owned(),
            };
            let names = [
                "Instant::now",
                "SystemTime",
                "std::fs",
                "File::open",
                "std::net",
                "thread::",
                "println!",
                "eprintln!",
                "tracing::",
                "rayon::",
                "tokio::",
                "use rand::",
            ];
            offences.extend(uses(&file, &names));
        }
    }
    check(offences);
}

#[test]
fn nothing_is_a_stub() {
    let names = ["todo!(", "unimplemented!(", "dbg!("];
    check(
        sources()
            .iter()
            .flat_map(|file| uses(file, &names))
            .collect(),
    );
}

/// A test that is ignored runs nowhere, whatever reason is given. A measurement asserts nothing, and
/// is started by hand.
#[test]
fn no_test_is_ignored() {
    let mut offences = Vec::new();
    for file in sources() {
        for (number, line) in file.text.lines().enumerate() {
            let line = line.trim();
            if line.starts_with("#[") && line.contains("ignore") && line != MEASUREMENT {
                offences.push(format!("{}:{}: {line}", file.path, number + 1));
            }
        }
    }
    check(offences);
}

/// The one form that is allowed.
const MEASUREMENT: &str = r#"#[ignore = "a measurement"]"#;

/// The crates of the workspace by folder, each with the crates of the house that it depends on.
fn crates() -> BTreeMap<String, BTreeSet<String>> {
    let manifests = files("Cargo.toml").into_iter();
    let crates: BTreeMap<_, _> = manifests
        .map(|file| {
            let folder = file.path.trim_end_matches("/Cargo.toml").to_owned();
            let mut section = String::new();
            let mut dependencies = BTreeSet::new();
            for line in file.text.lines() {
                if line.starts_with('[') {
                    section = line.trim().to_owned();
                } else if section == "[dependencies]"
                    && let Some(rest) = line.strip_prefix("cognate-")
                {
                    let name = rest.split(['.', ' ', '=']).next().unwrap_or_default();
                    dependencies.insert(name.to_owned());
                }
            }
            (folder, dependencies)
        })
        .collect();
    assert!(crates.len() >= 8, "{:?}", crates.keys());
    crates
}

fn short_name(folder: &str) -> &str {
    folder.rsplit('/').next().unwrap_or(folder)
}

/// The front page, for users.
fn readme() -> String {
    std::fs::read_to_string(root().join("README.md")).expect("there is a README.md")
}

/// The page for developers, with the code map and the drawing of dependencies.
const DEVELOPERS: &str = "common/README.md";

fn developers_page() -> String {
    std::fs::read_to_string(root().join(DEVELOPERS)).expect("there is a page for developers")
}

/// The text under a heading, up to the next heading of the same or a higher level.
fn section<'a>(page: &'a str, heading: &str) -> &'a str {
    let start = page.find(&format!("\n{heading}\n"));
    let start = start.unwrap_or_else(|| panic!("{DEVELOPERS} has no `{heading}`")) + 1;
    let text = &page[start + heading.len()..];
    let level = heading.chars().take_while(|c| *c == '#').count();
    let mut end = text.len();
    for next in 1..=level {
        if let Some(found) = text.find(&format!("\n{} ", "#".repeat(next))) {
            end = end.min(found);
        }
    }
    &text[..end]
}

/// The order of the house: the line of the drawing that begins with `numeric`, then what stands below it:
/// kinematics and its solver, summaries, the coordinator, its client, the library for C and the tests.
fn drawn_order(page: &str) -> Vec<String> {
    let line = page
        .lines()
        .find(|line| line.trim_start().starts_with("numeric ◄"))
        .expect("the page for developers has the drawing, a line `numeric ◄ systems ◄ ...`");
    let mut order: Vec<String> = line.split('◄').map(|name| name.trim().to_owned()).collect();
    let below = [
        "kinematics",
        "mechanism_solver",
        "summary",
        "coordinator",
        "client",
        "c",
        "tests",
    ];
    order.extend(below.map(str::to_owned));
    order
}

#[test]
fn the_drawing_is_the_order_of_dependencies() {
    let order = drawn_order(&developers_page());
    let place = |name: &str| order.iter().position(|drawn| drawn == name);
    let mut offences = Vec::new();
    for (folder, dependencies) in crates() {
        let name = short_name(&folder);
        let Some(own) = place(name) else {
            offences.push(format!("{name} is not in the drawing"));
            continue;
        };
        for dependency in dependencies {
            // A crate `cognate-machine-code` stands in a folder `machine_code`.
            let dependency = dependency.replace('-', "_");
            if place(&dependency).is_none_or(|other| other >= own) {
                offences.push(format!(
                    "{name} depends on {dependency}, which the drawing puts after it"
                ));
            }
        }
    }
    check(offences);
}

#[test]
fn the_mathematics_builds_without_wire_and_runtime() {
    let mut offences = Vec::new();
    for file in files("Cargo.toml") {
        let is_mathematics = file.path.starts_with("common/") && !file.path.contains("protocol");
        for name in ["tonic", "prost", "tokio", "rayon", "tracing", "sqlx"] {
            let has = file.text.lines().any(|line| line.starts_with(name));
            if is_mathematics && has {
                offences.push(format!("{} names {name}", file.path));
            }
        }
        let mut section = "";
        for line in file.text.lines() {
            if line.starts_with('[') {
                section = line;
            } else if section.ends_with("dependencies]")
                && line.contains('=')
                && !line.contains("workspace = true")
            {
                let path = &file.path;
                offences.push(format!(
                    "{path}: `{line}` has a version of its own; the list is in Cargo.toml"
                ));
            }
        }
    }
    check(offences);
}

/// What the code map names: the first word of every line of its code blocks.
fn mapped(page: &str) -> BTreeSet<String> {
    let map = section(page, "## Code map");
    let mut paths = BTreeSet::new();
    let mut in_block = false;
    for line in map.lines() {
        if line.starts_with("```") {
            in_block = !in_block;
        } else if in_block && !line.trim().is_empty() {
            let path = line.split_whitespace().next().unwrap_or_default();
            paths.insert(path.trim_end_matches('/').to_owned());
        }
    }
    assert!(!paths.is_empty(), "the code map names nothing");
    paths
}

#[test]
fn the_code_map_names_what_is_there() {
    let missing = mapped(&developers_page())
        .into_iter()
        .filter(|path| !root().join(path).exists());
    check(
        missing
            .map(|path| format!("the code map names {path}, which is not there"))
            .collect(),
    );
}

#[test]
fn what_is_there_is_in_the_code_map() {
    let mapped = mapped(&developers_page());
    let crates = crates();
    let mut offences = Vec::new();
    for folder in crates.keys().filter(|folder| !mapped.contains(*folder)) {
        offences.push(format!("the crate {folder} is not in the code map"));
    }
    for entry in std::fs::read_dir(root()).expect("the repository can be read") {
        let entry = entry.expect("the repository can be read");
        let name = entry.file_name().to_string_lossy().into_owned();
        // Folders that git ignores, or that belong to git, are no part of the house.
        let is_ours = entry.path().is_dir() && !name.starts_with('.') && name != "target";
        let below = format!("{name}/");
        let is_mapped = |path: &String| *path == name || path.starts_with(&below);
        if is_ours && !mapped.iter().any(is_mapped) {
            offences.push(format!("{name} is not in the code map"));
        }
    }
    check(offences);
}

/// The front page is read in five minutes; what does not fit has a page of its own.
#[test]
fn the_front_page_is_short() {
    const MOST_BYTES: usize = 8 * 1024;
    let bytes = readme().len();
    assert!(
        bytes <= MOST_BYTES,
        "README.md has {bytes} bytes, at most {MOST_BYTES}"
    );
}

/// Links to pages of the repository lead somewhere.
#[test]
fn links_lead_somewhere() {
    let mut offences = Vec::new();
    let mut pages = files(".md");
    pages.push(File {
        path: "README.md".to_owned(),
        text: readme(),
    });
    for page in pages {
        let folder = root().join(&page.path);
        let folder = folder.parent().expect("a page stands in a folder");
        for (at, _) in page.text.match_indices("](") {
            let link = page.text[at + 2..].split(')').next().unwrap_or_default();
            let target = link.split('#').next().unwrap_or_default();
            if !target.is_empty() && !target.contains("://") && !folder.join(target).exists() {
                offences.push(format!("{}: a link to {target}", page.path));
            }
        }
    }
    check(offences);
}

#[test]
fn code_is_told_from_comments_and_quotes() {
    assert_eq!(code("let a = 1; // todo!()"), "let a = 1; //");
    assert!(!code(r#"panic!("no unsafe here: \" unsafe");"#).contains("unsafe"));
    assert!(code("unsafe { x() }").contains("unsafe "));
}
