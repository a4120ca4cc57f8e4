//! Problems as texts: conditions, objectives and functions of unknowns are kept where the notation has words for them, and
//! named where it has none.

use cognate_systems::formats::written::{Written, write_problem};
use cognate_systems::formats::{Format, Problem, plain, read};

fn typed(text: &str) -> Problem {
    plain::typed("test", text).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn written(format: Format, problem: &Problem) -> Written {
    write_problem(format, problem).unwrap_or_else(|e| panic!("{format}: {e}"))
}

/// The problems that are read from the texts in the two notations that have words for all of a problem.
fn rereadings(problem: &Problem) -> [Problem; 2] {
    [Format::Plain, Format::Json].map(|format| {
        let Written { text, warnings } = written(format, problem);
        assert_eq!(warnings, [""; 0], "{text}");
        read("test", text.as_bytes()).unwrap_or_else(|e| panic!("{text}: {e}"))
    })
}

#[test]
fn conditions_and_objectives_are_written() {
    for (text, condition, objective) in [
        ("x^2 + y^2 = 1\nminimize: x + y", "", "x + y"),
        (
            "r := x - 1/2\nx*y = 2; x + y = a\nparameters: a\nwhere: r > 0, y != 1 or not (x <= a)",
            "x - 1/2 > 0 and (y - 1 != 0 or (not (x - a <= 0)))",
            "",
        ),
        (
            "maximize: sqrt(x + 1) - x\nwhere: 0 <= x < 2",
            "-x <= 0 and x - 2 < 0",
            "sqrt(x + 1) - x",
        ),
        ("critical: x^3 - x*y + y^2", "", "x^3 - x*y + y^2"),
        (
            "sqrt(x) + y = 3; x*y = 2\nwhere: sqrt(x) > 1",
            "sqrt(x) - 1 > 0",
            "",
        ),
    ] {
        let problem = typed(text);
        for reread in rereadings(&problem) {
            let read_objective = reread.objective.as_ref();
            assert_eq!(read_objective.map_or("", |one| &one.text), objective);
            let goal = |problem: &Problem| problem.objective.as_ref().map(|o| (o.goal, o.is_free));
            assert_eq!(goal(&reread), goal(&problem), "{text}");
            assert_eq!(
                reread.conditions.conditions.len(),
                problem.conditions.conditions.len()
            );
            assert_eq!(reread.system.variables, problem.system.variables, "{text}");
            assert_eq!(
                reread.system.equation_count(),
                problem.system.equation_count()
            );
            if !condition.is_empty() {
                assert_eq!(reread.conditions.text(), condition, "{text}");
            }
        }
    }
}

/// A root keeps its branch: sqrt(x) = -2 has no solution, x = root_1^2 beside root_1 = -2 has one.
#[test]
fn functions_of_unknowns_are_written_as_they_were_typed() {
    for text in [
        "sqrt(x) = -2",
        "abs(x) + y = 1; x*y = 2",
        "cbrt(x)^2 + 2*x^(2/5) = 3",
        "sqrt(1 + sqrt(x)) = 1/x",
        "sin(a/2) + cos(a) = 1/3",
        "cos(a) + cos(a + b) = 1; sin(a) + sin(a + b) = 1",
        "sin(pi*x/180) = 1/2; y = cos(pi*x/90)",
        "unknowns: x, y\ngroups: x | y\nsqrt(x)*y = 1; x + y = 3",
    ] {
        let problem = typed(text);
        let meanings = |problem: &Problem| {
            let mut functions: Vec<String> = problem
                .system
                .helper_meanings()
                .into_iter()
                .map(|m| m.is)
                .collect();
            functions.sort();
            functions
        };
        for format in [Format::Plain, Format::Json] {
            let Written { text: out, .. } = written(format, &problem);
            let reread = read("test", out.as_bytes()).unwrap_or_else(|e| panic!("{out}: {e}"));
            assert!(!out.contains("root_") && !out.contains("cos_"), "{out}");
            assert_eq!(meanings(&reread), meanings(&problem), "{out}");
            let groups = |problem: &Problem| problem.system.groups.len();
            assert_eq!(groups(&reread), groups(&problem), "{out}");
        }
    }
    let problem = typed("sqrt(x) = -2");
    let plain_text = written(Format::Plain, &problem).text;
    assert_eq!(plain_text, "unknowns: x\nsqrt(x) + 2 = 0\n");
}

#[test]
fn a_notation_without_words_for_a_part_names_it() {
    let problem = typed("sqrt(x) + y = 3; x^2 + y^2 = 1\nwhere: x > 0\nminimize: x + y");
    for format in [
        Format::Bertini,
        Format::Phcpack,
        Format::Singular,
        Format::Maple,
    ] {
        let said = written(format, &problem).warnings.join("\n");
        for part in [
            "the condition x > 0 is left out",
            "minimize: x + y is left out",
            "root_1 for sqrt(x); the solutions on other branches of the roots are added",
        ] {
            assert!(said.contains(part), "{format}: {said}");
        }
    }
    let free = typed("minimize: x^2 + y^2 - x*y");
    let refused = write_problem(Format::Bertini, &free)
        .unwrap_err()
        .to_string();
    assert!(refused.contains("has no objectives"), "{refused}");
    let groups = typed("unknowns: x, y\ngroups: x | y\nx*y = 1; x + y = 3");
    let [plain_problem, json_problem] = rereadings(&groups);
    assert_eq!(plain_problem.system.groups, groups.system.groups);
    assert_eq!(json_problem.system.groups, groups.system.groups);
    let said = written(Format::Phcpack, &groups).warnings;
    assert_eq!(
        said,
        ["variable groups are left out, for which this notation has no words"]
    );
}
