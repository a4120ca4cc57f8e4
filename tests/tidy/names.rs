//! Names of local variables: each says what the thing is. Pronouns, participles and prepositions do not.

use super::{File, check, code, sources};

/// Words that say nothing of a variable a screen later.
const EMPTY_NAMES: [&str; 6] = ["found", "known", "own", "all", "again", "of"];

/// Texts after which a name begins that a line of code declares.
const BEFORE: [&str; 9] = [
    "let ", "let mut ", "for ", "Some(", "Ok(", "Err(", "|", "|&", "|mut ",
];

/// Whether a line of code declares a local variable of this name.
fn declares(line: &str, name: &str) -> bool {
    let ends = |rest: &str| {
        let next = rest.strip_prefix(name).and_then(|rest| rest.chars().next());
        next.is_some_and(|c| !c.is_alphanumeric() && !"_(.!?".contains(c))
    };
    BEFORE.iter().any(|before| {
        line.match_indices(before).any(|(place, _)| {
            let first = line[..place].chars().next_back();
            let is_word = before.starts_with(char::is_alphabetic);
            let begins = !is_word || !first.is_some_and(|c| c.is_alphanumeric() || c == '_');
            begins && ends(&line[place + before.len()..])
        })
    })
}

/// Lines that declare a variable with an empty name, as `path:line: name`.
fn empty_names(file: &File) -> Vec<String> {
    let mut offences = Vec::new();
    for (number, line) in file.text.lines().enumerate() {
        let code = code(line);
        let names = EMPTY_NAMES.iter().filter(|name| declares(&code, name));
        offences.extend(names.map(|name| format!("{}:{}: {name}", file.path, number + 1)));
    }
    offences
}

#[test]
fn locals_are_named_after_what_they_are() {
    check(sources().iter().flat_map(empty_names).collect());
}

#[test]
fn declarations_are_told_from_other_uses() {
    let declaring = [
        "let found = 1;",
        "let mut all: Vec<u8> = v;",
        "if let Some(known) = x {",
        "v.map(|own| own + 1)",
        "for of in list {",
        "Err(again) => {}",
    ];
    let others = [
        "v.iter().all(|x| x)",
        "let founded = 1;",
        "let all_roots = 1;",
        "Some(found.len())",
        "a || all(b)",
        "outlet found",
    ];
    let declares_one = |line: &str| EMPTY_NAMES.iter().any(|name| declares(line, name));
    for line in declaring {
        assert!(declares_one(line), "{line}");
    }
    for line in others {
        assert!(!declares_one(line), "{line}");
    }
}
