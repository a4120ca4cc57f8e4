//! Files of a crate that use each other in a circle are named; the drawing of crates is checked elsewhere.
//!
//! An arrow goes from a file to the file whose things it names, by `use` or by a path, found through
//! re-exports. What only tests use is no arrow; nor is `mod`.

use super::{code, crates, root, sources};
use std::collections::{BTreeMap, BTreeSet};

/// Circles that are there: crate, files, reason. A circle that is gone or has become smaller must leave the list
/// or change its line.
const CIRCLES: [(&str, &[&str], &str); 1] = [(
    "common/algorithms",
    &[
        "questions",
        "questions/centred",
        "questions/real_curve",
        "questions/real_curve/assembled",
        "questions/real_curve/finer",
        "questions/real_curve/traced",
        "questions/real_surface",
        "questions/real_surface/plan",
    ],
    "a real surface asks questions about the curves on it",
)];

/// A module by its path below `src`, without `mod`: `[]` is `lib.rs`.
type Module = Vec<String>;

/// What one file of a crate names.
#[derive(Default)]
struct Names {
    /// Paths that it uses, as they are written.
    used: Vec<String>,
    /// Of these, what it re-exports.
    exported: Vec<String>,
}

/// Every path of a tree like `a::{b, c::{d, e as f}}`.
fn branches(prefix: &str, tree: &str, found: &mut Vec<String>) {
    let tree = tree.trim();
    let Some(open) = tree.find('{') else {
        let path = tree.split(" as ").next().unwrap_or(tree);
        if !path.is_empty() {
            found.push(format!("{prefix}{path}"));
        }
        return;
    };
    let head = format!("{prefix}{}", &tree[..open]);
    let inner = &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())];
    let (mut depth, mut begin) = (0, 0);
    for (at, c) in inner.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                branches(&head, &inner[begin..at], found);
                begin = at + 1;
            }
            _ => {}
        }
    }
    branches(&head, &inner[begin..], found);
}

/// Paths in code that begin with `crate`, `super` or `self`.
fn paths(code: &str, found: &mut Vec<String>) {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    for start in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(start) {
            let before = code[..at].chars().next_back();
            if before.is_some_and(|c| is_word(c) || c == ':') {
                continue;
            }
            let rest = &code[at..];
            let end = rest.find(|c| !is_word(c) && c != ':').unwrap_or(rest.len());
            found.push(rest[..end].trim_end_matches(':').to_owned());
        }
    }
}

/// A file without its module of tests, which is the last thing in it, and without declarations of such modules.
fn without_tests(text: &str) -> String {
    let mut parts = text.split("#[cfg(test)]\nmod ");
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find([';', '{']).unwrap_or(part.len());
        if part[end..].starts_with('{') {
            break;
        }
        kept += part[end..].trim_start_matches(';');
    }
    kept
}

fn names(text: &str) -> Names {
    let text = without_tests(text);
    let lines: Vec<String> = text
        .lines()
        .map(|line| code(line).replace("//", ""))
        .collect();
    let text = lines.join("\n");
    let mut names = Names::default();
    let mut rest = String::new();
    for statement in text.split_inclusive(';') {
        let begin = statement.rfind("use ").filter(|&at| {
            let line = statement[..at].rsplit('\n').next().unwrap_or_default();
            // `use` is a word of its own, and no end of one such as `Cause`.
            let is_word = line
                .chars()
                .next_back()
                .is_none_or(|c| !c.is_alphanumeric());
            let line = line.trim();
            is_word && (line.is_empty() || line.starts_with("pub"))
        });
        let Some(begin) = begin else {
            rest += statement;
            continue;
        };
        let known = names.used.len();
        let tree = statement[begin + 4..]
            .trim_end_matches(';')
            .replace('\n', " ");
        branches("", &tree, &mut names.used);
        let line = statement[..begin].rsplit('\n').next().unwrap_or_default();
        if line.trim().starts_with("pub") {
            names.exported.extend_from_slice(&names.used[known..]);
        }
        rest += &statement[..begin];
    }
    paths(&rest, &mut names.used);
    names
}

/// The module that a path names from within another, with what stands below it; `None` outside the crate.
fn absolute(from: &[String], path: &str, files: &BTreeMap<Module, Names>) -> Option<Module> {
    let mut words: Vec<String> = path
        .split("::")
        .map(|word| word.trim().to_owned())
        .collect();
    let mut base = match words[0].as_str() {
        "crate" => Vec::new(),
        "self" | "super" => from.to_vec(),
        first => {
            let child = [from, &[first.to_owned()]].concat();
            return files.contains_key(&child).then(|| [from, &words].concat());
        }
    };
    while words.first().is_some_and(|word| word == "super") {
        base.pop();
        words.remove(0);
    }
    if words
        .first()
        .is_some_and(|word| word == "self" || word == "crate")
    {
        words.remove(0);
    }
    base.extend(words);
    Some(base)
}

/// The file that holds what is named, through re-exports.
fn resolve(named: &[String], files: &BTreeMap<Module, Names>, depth: usize) -> Option<Module> {
    let length = (0..=named.len())
        .rev()
        .find(|&n| files.contains_key(&named[..n]))?;
    let module = &named[..length];
    if let Some(name) = named.get(length).filter(|_| depth < 5) {
        for path in &files[module].exported {
            let Some(target) = absolute(module, path, files) else {
                continue;
            };
            if target.last() == Some(name) {
                return resolve(
                    &[&target[..], &named[length + 1..]].concat(),
                    files,
                    depth + 1,
                );
            }
        }
    }
    Some(module.to_vec())
}

/// Which files of a crate use which.
fn arrows(files: &BTreeMap<Module, Names>) -> BTreeMap<Module, BTreeSet<Module>> {
    let mut arrows = BTreeMap::new();
    for (module, names) in files {
        let used = names
            .used
            .iter()
            .filter(|path| !names.exported.contains(path));
        let targets = used
            .filter_map(|path| absolute(module, path, files))
            .filter_map(|named| resolve(&named, files, 0))
            .filter(|target| target != module);
        arrows.insert(module.clone(), targets.collect());
    }
    arrows
}

/// All that can be reached from a module.
fn reach(from: &Module, arrows: &BTreeMap<Module, BTreeSet<Module>>) -> BTreeSet<Module> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from.clone()];
    while let Some(module) = open.pop() {
        for next in &arrows[&module] {
            if reached.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    reached
}

/// Groups of files in which each reaches each.
fn circles(files: &BTreeMap<Module, Names>) -> BTreeSet<Vec<String>> {
    let arrows = arrows(files);
    let reached: BTreeMap<&Module, _> = arrows.keys().map(|m| (m, reach(m, &arrows))).collect();
    let name = |module: &Module| match module.is_empty() {
        true => "lib".to_owned(),
        false => module.join("/"),
    };
    let in_circle = reached
        .iter()
        .filter(|(module, there)| there.contains(**module));
    in_circle
        .map(|(module, there)| {
            let mutual = there
                .iter()
                .filter(|other| reached[other].contains(*module));
            mutual.map(name).collect()
        })
        .collect()
}

/// The files of a crate that are not tests.
fn files_of(folder: &str) -> BTreeMap<Module, Names> {
    let prefix = format!("{folder}/src/");
    let mut files = BTreeMap::new();
    let mut only_tests: Vec<Module> = Vec::new();
    for file in sources() {
        let Some(inside) = file.path.strip_prefix(&prefix) else {
            continue;
        };
        let mut module: Module = inside
            .trim_end_matches(".rs")
            .split('/')
            .map(str::to_owned)
            .collect();
        if module[0] == "bin" || module == ["main"] {
            continue;
        }
        if module.last().is_some_and(|last| last == "mod") || module == ["lib"] {
            module.pop();
        }
        let lines: Vec<&str> = file.text.lines().map(str::trim).collect();
        for pair in lines.windows(2) {
            if pair[0].starts_with("#[cfg(") && pair[0].contains("test") {
                let declared = pair[1]
                    .split("mod ")
                    .nth(1)
                    .and_then(|rest| rest.strip_suffix(';'));
                only_tests.extend(declared.map(|name| [&module[..], &[name.to_owned()]].concat()));
            }
        }
        files.insert(module, names(&file.text));
    }
    files.retain(|module, _| !only_tests.iter().any(|tests| module.starts_with(tests)));
    files
}

#[test]
fn files_of_a_crate_use_each_other_in_no_circle_but_these() {
    let mut offences = Vec::new();
    for folder in crates()
        .keys()
        .filter(|folder| root().join(folder).join("src").is_dir())
    {
        let found = circles(&files_of(folder));
        let listed = CIRCLES.iter().filter(|(of, _, _)| of == folder);
        let listed: BTreeSet<Vec<String>> = listed
            .map(|(_, files, _)| files.iter().map(|f| (*f).to_owned()).collect())
            .collect();
        let news = found.difference(&listed);
        offences.extend(news.map(|files| format!("{folder}: a circle of {}", files.join(", "))));
        let gone = listed.difference(&found);
        offences.extend(
            gone.map(|files| format!("{folder}: no circle of exactly {}", files.join(", "))),
        );
    }
    super::check(offences);
}

#[test]
fn circles_are_found() {
    let file = |name: &str, text: &str| {
        let module: Module = name
            .split('/')
            .filter(|s| !s.is_empty())
            .map(str::to_owned)
            .collect();
        (module, names(text))
    };
    let files = BTreeMap::from([
        file("", "pub mod a;\npub use a::A;\n"),
        file("a", "use crate::b::{B, c::C};\nfn f() {}\n"),
        // By the re-export of `A`, below a declaration of tests, and by a path within a function.
        file("b", "mod c;\n#[cfg(test)]\nmod tests;\n\nuse crate::A;\n"),
        file("b/c", "fn f() { super::super::d::g(); }\n// crate::a\n"),
        file("d", "#[cfg(test)]\nmod tests {\n    use crate::a::A;\n}\n"),
    ]);
    assert_eq!(
        circles(&files),
        BTreeSet::from([vec!["a".to_owned(), "b".to_owned()]])
    );
}
