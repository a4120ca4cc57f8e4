//! Sets of variables for a linear-product start: those of the factors of each equation.

use super::json_value::{self, Value};
use super::scope::{FieldFault, at, variable};
use super::{FormatError, Source, decode, limits};
use crate::expression::fault::{Fault, Problem};
use crate::system::System;

/// Reads a file of sets, `[[["x"], ["y", "z"]], ...]`: for each equation of the system a list of
/// sets, each of which is a list of variables. A set that stands twice makes two factors.
///
/// Variables are given back by index, those of a set ascending.
pub fn read(
    name: &str,
    content: &[u8],
    system: &System,
) -> Result<Vec<Vec<Vec<u32>>>, FormatError> {
    let text = decode(name, content, limits::FILE_BYTES)?;
    let source = Source { name, text };
    let value = json_value::parse(text, 0, text.len()).map_err(|fault| source.error(fault))?;
    sets(&value, system).map_err(|fault| fault.into_error(&source))
}

fn sets(value: &Value<'_>, system: &System) -> Result<Vec<Vec<Vec<u32>>>, FieldFault> {
    let count = system.equation_count();
    let equations = value
        .array("a list with the sets of each equation")
        .map_err(at(""))?;
    if equations.len() != count {
        let expected = match count {
            1 => "a list with the sets of the one equation".to_owned(),
            _ => format!("a list of sets for each of the {count} equations"),
        };
        let fault = Fault::expected(value.span, expected, format!("{}", equations.len()));
        return Err(FieldFault::new("", fault));
    }
    let equations = equations.iter().enumerate();
    equations
        .map(|(i, factors)| {
            let field = format!("[{i}]");
            let factors = factors
                .array("the list of sets of an equation")
                .map_err(at(&field))?;
            let factors = factors.iter().enumerate();
            factors
                .map(|(k, set)| one_set(set, system).map_err(at(&format!("{field}[{k}]"))))
                .collect()
        })
        .collect()
}

fn one_set(value: &Value<'_>, system: &System) -> Result<Vec<u32>, Fault> {
    let names = value.array("a set of variables")?;
    let mut set = Vec::new();
    for name in names {
        let index = variable(name, &system.variables)? as u32;
        if set.contains(&index) {
            let problem = Problem::DuplicateName {
                name: system.variables[index as usize].clone(),
                first: "is in this set already".into(),
            };
            return Err(Fault::new(name.span, problem));
        }
        set.push(index);
    }
    if set.is_empty() {
        return Err(Fault::expected(value.span, "at least one variable", "none"));
    }
    set.sort_unstable();
    Ok(set)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system() -> System {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y;\nfunction f, g;\n\
                     f = x*y - 1;\ng = x - y;\nEND;\n";
        match crate::formats::read("test", text) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn sets_are_lists_of_names() {
        let text = br#"[[["y", "x"], ["x"]], [["x", "y"]]]"#;
        let sets = read("sets.json", text, &system()).expect("they are sets");
        assert_eq!(sets, [vec![vec![0, 1], vec![0]], vec![vec![0, 1]]]);
    }

    #[test]
    fn mistakes_are_named_with_their_place() {
        let said = |text: &str| {
            let error = read("sets.json", text.as_bytes(), &system());
            let error = error.expect_err("these are no sets").to_string();
            error.lines().next().unwrap_or_default().to_string()
        };
        let words = [
            (
                r#"[[["x"]]]"#,
                "expected a list of sets for each of the 2 equations",
            ),
            (r#"[[["x"]], [["z"]]]"#, "expected the name of a variable"),
            (r#"[[["x", "x"]], [["y"]]]"#, "is in this set already"),
            (r#"[[["x"]], [[]]]"#, "expected at least one variable"),
            (
                r#"[[["x"]], "y"]"#,
                "expected the list of sets of an equation",
            ),
            (
                r#"{"f": []}"#,
                "expected a list with the sets of each equation",
            ),
        ];
        for (text, expected) in words {
            let said = said(text);
            assert!(said.starts_with("sets.json:1:"), "{said}");
            assert!(said.contains(expected), "{said}");
        }
    }
}
