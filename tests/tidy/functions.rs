//! A function is a page: those of more than 100 lines are named, each with the reason why it stays.

use super::{File, check, sources};

/// Lines of the longest function that needs no reason.
const PAGE: usize = 100;

/// Functions that are longer: file, name, reason. One that has become shorter must leave the list.
const LONGER: [(&str, &str, &str); 8] = [
    (
        "common/machine_code/src/encoder.rs",
        "evex_is_what_an_assembler_makes_of_it",
        "a table of instructions and bytes",
    ),
    (
        "common/protocol/src/from_proto/problem.rs",
        "system",
        "one message, field by field, each error by its name",
    ),
    (
        "common/protocol/src/from_proto/problem.rs",
        "push",
        "one arm for each kind of node",
    ),
    (
        "common/systems/src/formats/json.rs",
        "system",
        "one object, key by key, each error by its name",
    ),
    (
        "common/systems/src/formats/json.rs",
        "write",
        "the same object written, key by key",
    ),
    (
        "coordinator/src/ledger/state_machine.rs",
        "carry_out",
        "one arm for each transition of the oracle",
    ),
    (
        "tests/benches/from_scratch.rs",
        "main",
        "one script, from arguments to the table",
    ),
    (
        "worker/src/session/tests.rs",
        "live",
        "one arm for each thing that may happen to a worker",
    ),
];

/// Functions as rustfmt writes them: name, line, number of lines.
fn functions(file: &File) -> Vec<(String, usize, usize)> {
    let lines: Vec<&str> = file.text.lines().collect();
    let mut found = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let indent = &line[..line.len() - line.trim_start().len()];
        let Some(name) = function_name(line.trim_start()) else {
            continue;
        };
        let closing = format!("{indent}}}");
        let end = lines[number..].iter().position(|line| {
            // A declaration without a body ends in a semicolon.
            let declared =
                line.ends_with(';') && line.len() - line.trim_start().len() == indent.len();
            *line == closing || declared
        });
        if let Some(end) = end {
            found.push((name, number + 1, end + 1));
        }
    }
    found
}

/// The name that a line declares as a function.
fn function_name(line: &str) -> Option<String> {
    let mut words = line.split_whitespace();
    loop {
        match words.next()? {
            "fn" => break,
            "const" | "async" | "unsafe" => {}
            word if word.starts_with("pub") => {}
            // `pub(in some::path)`.
            word if word.ends_with(')') => {}
            _ => return None,
        }
    }
    let name = words.next()?;
    let name = name.split(['(', '<']).next()?;
    Some(name.to_owned())
}

#[test]
fn no_function_is_longer_than_a_page_without_a_reason() {
    let mut listed = LONGER.map(|(path, name, _)| (path, name, false));
    let mut offences = Vec::new();
    for file in sources() {
        for (name, line, lines) in functions(&file) {
            if lines <= PAGE {
                continue;
            }
            let known = listed
                .iter_mut()
                .find(|known| (known.0, known.1) == (&file.path, &name));
            match known {
                Some(known) => known.2 = true,
                None => offences.push(format!("{}:{line}: {name} has {lines} lines", file.path)),
            }
        }
    }
    for (path, name, seen) in listed {
        if !seen {
            offences.push(format!(
                "{path}: {name} is a page now: take it off the list"
            ));
        }
    }
    check(offences);
}

#[test]
fn functions_are_measured() {
    let file = File {
        path: String::new(),
        text: "impl A {\n    pub(crate) async fn a<T>(\n        &self,\n    ) -> T {\n        if b {\n        }\n    }\n    fn c(&self);\n}\n\
               // fn no() {\nfn d() {\n}\n"
            .to_owned(),
    };
    let found = functions(&file);
    let found: Vec<_> = found
        .iter()
        .map(|(name, line, lines)| (name.as_str(), *line, *lines))
        .collect();
    assert_eq!(found, [("a", 2, 6), ("c", 8, 1), ("d", 11, 2)]);
}
