//! A function is a page: none has more than 100 lines.

use super::{File, check, sources};

/// Lines of the longest function.
const PAGE: usize = 100;

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
fn no_function_is_longer_than_a_page() {
    let mut offences = Vec::new();
    for file in sources() {
        for (name, line, lines) in functions(&file) {
            if lines > PAGE {
                offences.push(format!("{}:{line}: {name} has {lines} lines", file.path));
            }
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
