//! Bad input: one clear message each, with file, line, column and the line itself.

use crate::support::refused;
use cognate_systems::formats::{self, limits};

/// The message without the excerpt.
fn message(text: &str) -> String {
    refused(text).lines().next().unwrap_or_default().to_string()
}

#[track_caller]
fn check(text: &str, expected: &str) {
    assert_eq!(message(text), expected);
}

/// A Bertini file about x and y with these lines; they begin in line 2.
fn bertini(lines: &str) -> String {
    format!("variable_group x, y; function f;\n{lines}\nEND;\n")
}

const FORMATS: &str = "expected a Bertini-classic input (`CONFIG`, `INPUT` or a declaration such \
     as `variable_group`), a PHCpack system (the number of equations), a JSON problem (`{`) or \
     equations, one a line, found";

#[test]
fn the_message_shows_the_line() {
    assert_eq!(
        refused(&bertini("f = x^2 + 3*(y - 1;")),
        "test:2:19: expected an operator or `)`, found `;`\n   |\n 2 | f = x^2 + 3*(y - 1;\n   \
         |                   ^"
    );
}

#[test]
fn a_long_line_is_shown_around_the_place() {
    let text = bertini(&format!(
        "f = {}zz + {}x;",
        "x + ".repeat(1000),
        "y + ".repeat(1000)
    ));
    let message = refused(&text);
    assert!(
        message.lines().all(|line| line.chars().count() < 120),
        "{message}"
    );
    let lines: Vec<&str> = message.lines().collect();
    let mark = lines[3].find("^^").expect("two marks");
    assert_eq!(&lines[2][mark..mark + 2], "zz");
}

#[test]
fn what_is_no_problem_at_all() {
    check("", &format!("test:1:1: {FORMATS} an empty file"));
    check(
        "  \n% only a comment\n",
        &format!("test:3:1: {FORMATS} an empty file"),
    );
    check(
        "hello world",
        &format!("test:1:1: {FORMATS} the name `hello`"),
    );
    check("@#!", &format!("test:1:1: {FORMATS} the character `@`"));
    check(
        "{",
        "test:1:2: expected a field's name in quotes, found the end of the text",
    );
    check(
        "{}",
        "test:1:2: expected the field \"variables\", found the end of the problem",
    );
    check("[1]", &format!("test:1:1: {FORMATS} the character `[`"));
    check(
        "\u{1}\u{2}",
        &format!("test:1:1: {FORMATS} the control character U+0001"),
    );
    let bytes = |content: &[u8]| {
        let error = formats::read("junk", content).expect_err("no text");
        error
            .to_string()
            .lines()
            .next()
            .unwrap_or_default()
            .to_string()
    };
    assert_eq!(
        bytes(b"\x7fELF\x02\x00"),
        "junk:1:6: expected text in UTF-8, found the byte 0x00"
    );
    assert_eq!(
        bytes(b"ab\n\xff\xfe"),
        "junk:2:1: expected text in UTF-8, found the byte 0xff"
    );
    let large = vec![b' '; limits::FILE_BYTES.value as usize + 1];
    assert_eq!(
        bytes(&large),
        "junk:1:1: expected at most 16777216 bytes in a file, found 16777217 \
         (not in this version: limit FILE_BYTES)"
    );
}

/// Sums and products of 10^6 terms took up to 10 s and 366 MiB until they were refused (third attack, V): they are by the
/// number of their operations, before a graph is made.
#[test]
fn an_endless_expression_is_refused_while_it_is_read() {
    for operator in ['+', '*', '-', '/', '^'] {
        let terms = format!("{operator}x").repeat(999_999);
        let read = formats::read("long", format!("y = x{terms}\n").as_bytes());
        let refused = read.expect_err("it is too long").to_string();
        let expected = "(not in this version: limit EXPRESSION_OPERATIONS)";
        let nesting = "(not in this version: limit NESTING)";
        let is_refused = refused.contains(expected) || operator == '^' && refused.contains(nesting);
        assert!(is_refused, "{operator}: {refused}");
    }
}

#[test]
fn names() {
    check(
        &bertini("f = x + z;"),
        "test:2:9: expected a declared name, found the unknown name `z`",
    );
    check(
        &bertini("variable_group u, x;\nf = x;"),
        "test:2:19: expected a new name, found `x`, which is declared as a variable in line 1",
    );
    check(
        &bertini("f = x;\nf = y;"),
        "test:3:1: expected a new name, found `f`, which is defined in line 2 already",
    );
    check(
        &bertini("x = 3;\nf = x;"),
        "test:2:1: expected a new name, found `x`, which is declared as a variable",
    );
    check(
        &bertini("constant I;\nf = x;"),
        "test:2:10: expected a name without a meaning of its own, found `I`, which is the \
         imaginary unit",
    );
    check(
        &bertini("sin = x;\nf = x;"),
        "test:2:1: expected a name without a meaning of its own, found `sin`, which is an \
         elementary function",
    );
    check(
        &bertini("variable z;\nf = x;"),
        "test:2:10: expected variables either in groups or in `variable` lists, found `z` after \
         the other kind",
    );
    check(
        r#"{"variables": ["x", "x"], "equations": ["x"]}"#,
        "test:1:21: variables[1]: expected a new name, found `x`, which is a variable already",
    );
    check(
        r#"{"variables": ["x y"], "equations": ["x"]}"#,
        "test:1:16: variables[0]: expected a name: a letter or `_`, then letters, digits, `_` \
         and indices such as `[1]`, found \"x y\"",
    );
}

#[test]
fn declarations_and_definitions() {
    check(
        "variable_group x; function f, g;\nf = x;\nEND;",
        "test:1:31: expected a definition `g = ...`, found none for `g`",
    );
    check(
        &bertini("f = a*x; a = b + 1;\nb = c;\nc = 2*a;"),
        "test:4:7: expected definitions that do not depend on themselves, found the cycle \
         a -> b -> c -> a",
    );
    check(
        &bertini("f = f + x;"),
        "test:2:5: expected definitions that do not depend on themselves, found the cycle f -> f",
    );
    check(
        &bertini("constant c; c = 2*x; f = x;"),
        "test:2:13: expected a constant without variables and parameters, found `c`, which \
         contains some",
    );
    check(
        &bertini("parameter p; p = x; f = x;"),
        "test:2:14: expected a parameter without variables, found `p`, which contains some",
    );
    check(
        &bertini("pathvariable t; pathvariable s; f = x;"),
        "test:2:30: expected one path variable, found a second one, `s`",
    );
    check(
        &bertini("random r; r = 2; f = r*x;"),
        "test:2:11: expected a new name, found `r`, which is declared as a random \
         constant",
    );
    check(
        "variable_group x\nfunction f; f = x; END;",
        "test:2:1: expected `,` or `;`, found the name `function`",
    );
    check(
        "INPUT\nvariable_group ;",
        "test:2:16: expected a name, found `;`",
    );
    check(
        "INPUT\nvariable_group x; function f; f = x",
        "test:2:36: expected an operator or `;`, found the end of the text",
    );
    check(
        &bertini("f x;"),
        "test:2:3: expected `=` or a declaration, found the name `x` after `f`",
    );
    check(
        "CONFIG\nMPType: 3;\nEND;\nINPUT",
        "test:2:9: expected one of 0, 1, 2, found the number `3`",
    );
    check(
        "CONFIG\nTrackTyp: 1;\nEND;\nINPUT",
        "test:2:1: expected a setting of Bertini's, perhaps `tracktype`, found the name `TrackTyp`",
    );
    check(
        "CONFIG\nFinalTol: -1;\nEND;",
        "test:2:12: expected a positive number, found a minus \
         before the number `1`",
    );
    check(
        "CONFIG\nEND;\nvariable_group x;",
        "test:3:1: expected `INPUT`, found the name \
         `variable_group`",
    );
    check(
        "CONFIG\nMPType: 0\nEND;",
        "test:3:1: expected `;`, found the name `END`",
    );
}

#[test]
fn systems_that_are_none() {
    check(
        "variable_group x; END;",
        "test:1:19: expected at least one equation, found none",
    );
    check(
        "constant c; c = 1; function f; f = c; END;",
        "test:1:39: expected at least one variable, found none",
    );
    check(
        &bertini("f = x - x + 2;"),
        "test:2:1: expected an equation that contains a variable, found `f`, which contains none",
    );
    check(
        "1/x = 0\n",
        "test:1:1: expected an equation that has a solution, found `f1`, whose numerator is a constant: no values of its \
         variables make it 0",
    );
    check(
        "0\n",
        "test:1:1: expected at least one equation, found none",
    );
    check(
        "1\n 5;",
        "test:1:1: expected the number of unknowns that occur, 0, found 1",
    );
    check(
        "1\n x - x + 5;",
        "test:2:2: expected an equation that contains a variable, found `f1`, which contains none",
    );
    check(
        r#"{"variables": ["x"], "equations": []}"#,
        "test:1:35: equations: expected at least one equation, found none",
    );
    check(
        r#"{"variables": [], "equations": ["1"]}"#,
        "test:1:15: variables: expected at least one variable, found none",
    );
    check(
        r#"{"variables": ["x"], "equations": ["x", "2 - 1"]}"#,
        "test:1:42: equations[1]: expected an equation that contains a variable, found `f2`, \
         which contains none",
    );
}

#[test]
fn expressions() {
    check(
        &bertini("f = x +* y;"),
        "test:2:8: expected a number, a name or `(`, found `*`",
    );
    check(
        &bertini("f = 2x;"),
        "test:2:6: expected an operator (such as `*x`) or `;`, found the name `x`",
    );
    check(
        &bertini("f = x y;"),
        "test:2:7: expected an operator or `;`, found the name `y`",
    );
    check(
        &bertini("f = x(y);"),
        "test:2:6: expected an operator (such as `*(`, since `x` is no function) or `;`, found `(`",
    );
    check(
        &bertini("f = (x));"),
        "test:2:8: expected an operator or `;`, found `)`",
    );
    check(
        &bertini("f = ;"),
        "test:2:5: expected a number, a name or `(`, found `;`",
    );
    check(
        &bertini("f = ();"),
        "test:2:6: expected a number, a name or `(`, found `)`",
    );
    check(
        &bertini("f = x = y;"),
        "test:2:7: expected an operator or `;`, found `=`",
    );
    check(
        &bertini("f = x & y;"),
        "test:2:7: expected an operator or `;`, found the character `&`",
    );
    check(
        &bertini("f = x/(2 - 4/2);"),
        "test:2:8: expected a denominator that is not 0, found 0",
    );
    check(
        &bertini("f = x*0^-1;"),
        "test:2:7: expected a denominator that is not 0, found 0",
    );
    check(
        &bertini("f = x + sin(x);"),
        "test:2:1: expected the angle `x` only inside sin, cos, tan, cot, sec, csc and exp(I*..): an unknown together \
         with its sine has no polynomial equation, found `x` outside of them, too",
    );
    check(
        &bertini("f = x^y;"),
        "test:2:7: expected a rational number as exponent, found an expression with variables",
    );
    check(
        &bertini("f = x^I;"),
        "test:2:7: expected a rational number as exponent, found a complex number",
    );
    check(
        &bertini("f = x*2^Pi;"),
        "test:2:9: expected a rational number as exponent, found a number that is not rational",
    );
    check(
        &bertini("f = log(x);"),
        "test:2:9: expected a constant as argument of `log`: equations with logarithms of unknowns have no polynomial \
         form, found an expression with unknowns or parameters",
    );
    check(
        &bertini("f = x + log(0);"),
        "test:2:13: expected a number that is not 0 as argument of `log`, found 0",
    );
    check(
        "1\n x*(2 - y;",
        "test:2:10: expected an operator or `)`, found `;`",
    );
    check(
        "1\n x*2",
        "test:2:5: expected an operator or `;`, found the end of the text",
    );
    check(
        r#"{"variables": ["x"], "equations": ["x +"]}"#,
        "test:1:40: equations[0], column 4: expected a number, a name or `(`, found the end of \
         the text",
    );
    check(
        r#"{"variables": ["x"], "equations": ["x; x"]}"#,
        "test:1:38: equations[0], column 2: expected an operator or the end of the expression, \
         found `;`",
    );
}

#[test]
fn fields_of_json() {
    check(
        r#"{"variables": ["x"], "equation": ["x"]}"#,
        "test:1:23: expected one of the fields variables, groups, homogeneous, parameters, \
         path_variable, definitions, equations, conjugates, degenerate, symmetry, where, complementary, minimize, maximize, \
         critical; perhaps equations, found \"equation\"",
    );
    check(
        r#"{"variables": "x", "equations": ["x"]}"#,
        "test:1:15: variables: expected an array, found the string \"x\"",
    );
    check(
        r#"{"variables": ["x"], "equations": [true]}"#,
        "test:1:36: equations[0]: expected an expression in quotes, found true",
    );
    check(
        r#"{"variables": ["x"], "equations": ["x"], "equations": ["x"]}"#,
        "test:1:42: expected a new name, found `equations`, which is a field of this object already",
    );
    check(
        r#"{"variables": ["x"], "groups": [[]], "equations": ["x"]}"#,
        "test:1:33: groups[0]: expected at least one variable, found none",
    );
    check(
        r#"{"variables": ["x", "y"], "groups": [["x"]], "equations": ["x"]}"#,
        "test:1:37: groups: expected every variable in a group, found `y` in none",
    );
    check(
        r#"{"variables": ["x"], "equations": ["x"], "conjugates": [["x", "x"]]}"#,
        "test:1:63: conjugates[0]: expected a new name, found `x`, which has a conjugate already",
    );
    check(
        r#"{"variables": ["x"], "equations": ["x"], "conjugates": [["x", 1]]}"#,
        "test:1:63: conjugates[0]: expected the name of a variable, found the number 1",
    );
    check(
        r#"{"variables": ["x"], "equations": ["a"], "definitions": {"a": "b", "b": "2*a"}}"#,
        "test:1:76: definitions.b, column 3: expected definitions that do not depend on \
         themselves, found the cycle a -> b -> a",
    );
    check(
        r#"{"variables": ["x"], "equations": ["x"], "homogeneous": 1}"#,
        "test:1:57: homogeneous: expected true, false or a list of them, found the number 1",
    );
    check(
        "{\"variables\": [\"x\"]",
        "test:1:20: expected `,` or `}`, found the end of the text",
    );
    check(
        "{\"variables\": [\"x]}",
        "test:1:16: expected a closing quote, found the end of the \
         text in a string",
    );
}

#[test]
fn limits_are_named() {
    let limit = |text: &str, name: &str| {
        let message = message(text);
        let end = format!("(not in this version: limit {name})");
        assert!(message.ends_with(&end), "{message}");
    };
    limit(&bertini("f = x*1e999999999;"), "NUMBER_EXPONENT");
    limit(
        &bertini("f = x*1e-99999999999999999999999;"),
        "NUMBER_EXPONENT",
    );
    limit(
        &bertini(&format!("f = x*{};", "1".repeat(20_000))),
        "NUMBER_DIGITS",
    );
    limit(&bertini("f = x^100001;"), "EXPONENT");
    limit(&bertini("f = x*2^(1/100001);"), "EXPONENT");
    limit(&bertini("f = (x^1000)^1000;"), "DEGREE");
    limit(&bertini("f = x*10^100000;"), "CONSTANT_BITS");
    limit(&bertini("f = x*((10^10000)^10000)^10000;"), "CONSTANT_BITS");
    limit(
        &bertini("f = x*(1e9999*1e9999*1e9999*1e9999);"),
        "CONSTANT_BITS",
    );
    limit(
        &bertini(&format!("f = {}x;", "-".repeat(20_000))),
        "NESTING",
    );
    limit(
        &bertini(&format!("f = {}x;", "2^".repeat(20_000))),
        "NESTING",
    );
    limit(
        &format!("{{\"variables\": {}", "[".repeat(100)),
        "JSON_NESTING",
    );
    limit("2000\n x;", "EQUATIONS");
    limit("1 2000\n x;", "VARIABLES");
    limit("99999999999999999999999999\n x;", "EQUATIONS");
    let names: Vec<String> = (0..1001).map(|i| format!("x{i}")).collect();
    limit(
        &format!(
            "variable_group {}; function f; f = x1; END;",
            names.join(", ")
        ),
        "VARIABLES",
    );
    let declared = |word: &str| {
        let names: Vec<String> = (0..1001).map(|i| format!("{word}{i}")).collect();
        bertini(&format!("{word} {}; f = x;", names.join(", ")))
    };
    limit(&declared("function"), "EQUATIONS");
    let json = |variables: &[String], equations: &[String]| {
        format!("{{\"variables\": {variables:?}, \"equations\": {equations:?}}}")
    };
    limit(&json(&names, &names), "VARIABLES");
    limit(&json(&names[..1], &names), "EQUATIONS");
    // Squaring again and again doubles the digits each time.
    let mut text = String::from("a0 = 3*x/3 - x + 10^20; ");
    for i in 0..40 {
        text += &format!("a{} = a{i}*a{i}; ", i + 1);
    }
    let text = text.replace("3*x/3 - x + ", "");
    limit(&bertini(&format!("{text} f = a40*x;")), "CONSTANT_BITS");
}

#[test]
fn exact_arithmetic_that_cancels_is_limited_too() {
    // Each product is 1 and costs the division of two numbers of 30000 digits.
    let big = "1".repeat(9_000);
    let odd = "7".repeat(9_001);
    let sum = "c*d + ".repeat(200_000);
    let text = format!("c = {big}/{odd}; d = {odd}/{big}; f = {sum}x;");
    let start = std::time::Instant::now();
    let message = message(&bertini(&text));
    assert!(message.ends_with("limit TOTAL_CONSTANT_BITS)"), "{message}");
    let seconds = start.elapsed().as_secs();
    assert!(seconds < 300, "{seconds} s");
}

#[test]
fn many_warnings_are_not_slow() {
    let text = format!(
        "CONFIG\n{}END;\n{}",
        "MaxNorm: 1;\n".repeat(1_000_000),
        "INPUT "
    );
    let text = text + &bertini("f = x;");
    let start = std::time::Instant::now();
    let problem = formats::read("test", text.as_bytes()).expect("only warnings");
    // A setting is named once, however often it stands there.
    assert_eq!(problem.warnings.len(), 1);
    assert!(problem.warnings[0].message.len() < 100);
    assert!(start.elapsed().as_secs() < 300);
}
