//! Plain equations: what is read and how, what is refused and where, and what is said of what may be meant in another way.

use crate::support::{rational, read, refused, values};
use cognate_numeric::rational::ComplexRational;
use cognate_systems::formats::{self, FileSettings, Format, Problem};

/// The first line of a message.
#[track_caller]
fn check(text: &str, expected: &str) {
    let message = refused(text);
    assert_eq!(message.lines().next().unwrap_or_default(), expected);
}

/// x^2 + y^2 - 1 and x - y at (2, 5), in the ways in which people type them.
#[test]
fn equations_are_read_as_people_type_them() {
    for text in [
        "x^2 + y^2 = 1\nx = y",
        "x^2 + y^2 = 1;\nx = y;\n",
        "x**2 + y**2 == 1, x == y",
        "x^2 + y^2 - 1; x - y",
        "# a circle and a line\n\nx^2 +\n  y^2 = 1   # the circle\nx - y\n",
        "(x^2\n + y^2) - 1 = 0,\nx =\n y",
        "1*x^2 + y^2 = 1\nx = y",
        "-1 + x^2 + y^2\nx = y",
        "unknowns: x, y\nx^2 + y^2 = 1\nx = y",
        "variables: x y\nsquares := x^2 + y^2\nsquares = 1\nx = y",
    ] {
        let problem = read(text);
        assert_eq!(problem.format, Format::Plain, "{text}");
        assert_eq!(problem.system.variables, ["x", "y"], "{text}");
        let at = values(&problem.system, &[rational(2, 1), rational(5, 1)], &[]);
        assert_eq!(at, [rational(28, 1), rational(-3, 1)], "{text}");
    }
}

#[test]
fn parameters_groups_and_definitions_have_their_lines() {
    let text =
        "parameters: r, k\nunknowns: y, x\ngroups: x | y\nd := (x - y)/k\nd^2 = r\nx*y = sqrt(2)\n";
    let system = read(text).system;
    assert_eq!(
        (&system.variables[..], &system.parameters[..]),
        (&["y".into(), "x".into()][..], &["r".into(), "k".into()][..])
    );
    let groups: Vec<_> = system.groups.iter().map(|g| g.variables.clone()).collect();
    assert_eq!(groups, [[1], [0]]);
    let written = formats::write(Format::Plain, &system, &FileSettings::default()).unwrap();
    let back = read(&written);
    assert_eq!(back.format, Format::Plain, "{written}");
    assert_eq!(back.system.variables, system.variables);
    assert_eq!(back.system.parameters, system.parameters);
    assert_eq!(back.system.groups, system.groups);
}

/// Without a line of unknowns these are the names that are nothing else, as they occur.
#[test]
fn unknowns_are_the_names_that_are_nothing_else() {
    let system = read("a := 3\nparameters: p\nz*b = a\nz + x[1] = p*Pi\nb = I*x[1]").system;
    assert_eq!(system.variables, ["z", "b", "x[1]"]);
}

#[test]
fn what_may_be_meant_in_another_way_is_said() {
    let said = |text: &str| -> Vec<String> {
        read(text)
            .warnings
            .iter()
            .map(ToString::to_string)
            .collect()
    };
    assert_eq!(said("x^2 + y^2 - 1\nx - y"), Vec::<String>::new());
    assert_eq!(said("x^2 = 2"), Vec::<String>::new());
    assert_eq!(said("y = x^2; x^2 = 3"), Vec::<String>::new());
    let product = said("7x - 8y = 24\nxy^2 = 1");
    let message = "test:2: `xy` is one name; a product is `x*y`";
    assert_eq!(product, [message], "{product:?}");
    for (text, product) in [
        (
            "x*y + xy = 1\nx = y\nxy = 2*x",
            "`xy` is one name; a product is `x*y`",
        ),
        (
            "ab = 2\na = 1\nb = 3",
            "`ab` is one name; a product is `a*b`",
        ),
        (
            "x1y1 = 2\nx1 = 1\ny1 = 3",
            "`x1y1` is one name; a product is `x1*y1`",
        ),
        (
            "½gt² = 10\ng = 9.81",
            "`gt` is one name; a product is `g*t`",
        ),
        ("pix = 10", "`pix` is one name; a product is `pi*x`"),
        ("Piz^2 = 10", "`Piz` is one name; a product is `Pi*z`"),
        ("unknowns: xy, x, y\nx*y + xy = 1\nx = y\nxy = 2*x", ""),
        ("pitch = 2\npi_1 = 3\np = 1", ""),
        ("theta = t\nt = 2*theta - 1", ""),
    ] {
        let warnings = said(text);
        let is_said = |warning: &String| warning.contains(product);
        let number = usize::from(!product.is_empty());
        assert!(
            warnings.len() == number && warnings.iter().all(is_said),
            "{text}: {warnings:?}"
        );
    }
    let mixed = said("x^2\n- y^2 = 1\nx = y");
    assert!(
        mixed.len() == 1 && mixed[0].starts_with("test:1: there is no `=`"),
        "{mixed:?}"
    );
    let named = said("f = x^2 + y^2 - 1\ng = x - y");
    assert!(
        named.len() == 2 && named[0].contains("`f` occurs only here"),
        "{named:?}"
    );
    let case = said("x^2 + y^2 = 5\nx*Y = 2");
    assert_eq!(case, ["test:2: `Y` is another unknown than `y`"]);
    let slip = said("theta^2 + thta = 4; minimize: theta + phi");
    assert_eq!(slip, ["test:1: `thta` is another unknown than `theta`"]);
    for text in ["R = 2*r\nr = 1", "c12 + s12 = c11", "unknowns: r, R\nr = R"] {
        assert_eq!(said(text), Vec::<String>::new(), "{text}");
    }
}

#[test]
fn factors_that_touch_are_multiplied() {
    for (typed, meant) in [
        ("2x = 1", "2*x = 1"),
        ("-3x^2y + x = 1\ny = 1", ""),
        (
            "(x^2 + 3x + 1)^2 - 3x + 30 = 0",
            "(x^2 + 3*x + 1)^2 - 3*x + 30 = 0",
        ),
        (
            "(x - 2)(y - 3)(x + y) = 0\nx = y",
            "(x - 2)*(y - 3)*(x + y) = 0\nx = y",
        ),
        ("a/3(x + 1) = 2\na = 1", ""),
        ("πr² = 10", "π*r² = 10"),
        ("2πr = 10", "2*π*r = 10"),
        ("4πr^2 + π(r + 1) = 1", "4*π*r^2 + π*(r + 1) = 1"),
        ("r = x/2πy\nx = y", ""),
        ("r = x/π y\nx = y", ""),
        ("rπ = 1", ""),
        ("2(x + 1)x - 1.5e-3x = 1", "2*(x + 1)*x - 1.5e-3*x = 1"),
        ("2sin(x)cos(x) = 1/2", "2*sin(x)*cos(x) = 1/2"),
        ("y*3x/2 = 1\nx = y", "y*3*x/2 = 1\nx = y"),
        ("3I*x = 2I", "3*I*x = 2*I"),
        ("x^(2)y = 1\nx = y", ""),
        ("1/-2x = 3", ""),
        ("0x10 = y\nx = y", ""),
        ("x (x + 1) = 2", ""),
    ] {
        match (formats::plain::typed("test", typed), meant) {
            (Err(_), "") => {}
            (Ok(read), meant) if !meant.is_empty() => {
                let meant = formats::plain::typed("test", meant).expect("equations");
                assert_eq!(read.system, meant.system, "{typed}");
            }
            (read, _) => panic!("{typed}: {read:?}"),
        }
    }
}

#[test]
fn a_file_may_begin_with_a_coefficient() {
    for (text, format) in [
        ("384x^5 - 960x^4 - 36.6926x^2 + 98925.7 = 0", Format::Plain),
        ("3(x + 1)^2 = 5", Format::Plain),
        ("2x + y\nx - 3", Format::Plain),
        ("2 x + y = 1\nx - 3 = 0", Format::Plain),
        ("2\n x + y - 1;\n x - y;", Format::Phcpack),
        ("2 x + y - 1;\n x - y;", Format::Phcpack),
    ] {
        match formats::read("test", text.as_bytes()) {
            Ok(problem) => assert_eq!(problem.format, format, "{text}"),
            // `2 x` is no product.
            Err(error) => assert!(error.to_string().contains("`*x`"), "{text}: {error}"),
        }
    }
}

#[test]
fn printed_notation_is_read() {
    let equations = |text: &str| match formats::read("test", text.as_bytes()) {
        Ok(problem) => formats::plain::write(&problem.system),
        Err(error) => panic!("{text}: {error}"),
    };
    for (printed, typed) in [
        ("x = y = 2", "x = y\ny = 2"),
        ("x == y == 2, z = 1", "x = y\ny = 2\nz = 1"),
        ("x⁻¹ = 2", "x^(-1) = 2"),
        ("x = 1⁄2", "x = 1/2"),
        ("sec[1] = 2", "sec[1] = 1 + 1"),
        ("½x + y = ⅔\nx = 2∗y", "1/2*x + y = 2/3\nx = 2*y"),
    ] {
        assert_eq!(equations(printed), equations(typed), "{printed}");
    }
}

#[test]
fn notation_with_two_meanings_is_refused_with_both() {
    for (text, expected) in [
        (
            "x = 0.(3)",
            "`1/3` for a repeating decimal, or `*(` for a product",
        ),
        (
            "x = 1.2(45)",
            "`137/110` for a repeating decimal, or `*(` for a product",
        ),
        (
            "2/3x = 1",
            "`/(3*x)` or `/3*x`, which are the two meanings of `/3x`",
        ),
        ("1/2(x + (1)) = y", "`/(2*(x + (1)))` or `/2*(x + (1))`"),
        ("1/2sin(x) = 1", "`/(2*sin(x))` or `/2*sin(x)`"),
        ("2½ = x", "`(2+1/2)` for a mixed number"),
        ("x = 3½y\ny = 1", "`(3+1/2)` for a mixed number"),
        ("x = 3 1/2", "`(3+1/2)` for a mixed number"),
        ("x = 12 345", "`12345` for one number"),
        (
            "Sin[x] == 1/2",
            "expected `sin(x)`, found the name `Sin[x]`",
        ),
        ("Sqrt[x] == 2", "expected `sqrt(x)`"),
        ("Log[2] = x", "expected `log(2)`"),
        ("Abs[x] == 2", "expected `abs(x)`"),
        ("sin x^2 = 1", "`sin(x^2)` or `sin(x)^2`"),
        ("cos x² = 1", "`cos(x²)` or `cos(x)²`"),
        ("x^2 = 4 (2)", "the number of an equation is left out"),
        ("(2) x^2 = 4", "the number of an equation is left out"),
        ("√2x = 2", "`sqrt(2*x)` or `sqrt(2)*x`"),
        ("√x² = 2", "`sqrt(x²)` or `sqrt(x)²`"),
        ("x = ２", "the character `２`, which is written `2`"),
    ] {
        let error = formats::plain::typed("test", text).expect_err(text);
        assert!(error.to_string().contains(expected), "{text}: {error}");
    }
}

#[test]
fn mistakes_are_named_at_their_place() {
    check(
        "x + y = 1\nx = y ) 2",
        "test:2:7: expected an operator or the end of the line, found `)`",
    );
    check(
        "x + 2 y = 1",
        "test:1:7: expected an operator (such as `*y`) or the end of the line, found the name `y`",
    );
    check(
        "x + y = 1\nx = (y",
        "test:2:7: expected an operator or `)`, found the end of the text",
    );
    check(
        "unknowns: x\nx + y = 1",
        "test:2:5: expected a declared name, found the unknown name `y`",
    );
    check(
        "unknowns: x, x\nx = 1",
        "test:1:14: expected a new name, found `x`, which is an unknown already",
    );
    check(
        "x + i = 1",
        "test:1:5: expected `I` for the imaginary unit, or a line `unknowns:` with this name, found `i`",
    );
    check(
        "constraints: x\nx = 1",
        "test:1:1: expected a Bertini-classic input (`CONFIG`, `INPUT` or a declaration such as \
        `variable_group`), a PHCpack system (the number of equations), a JSON problem (`{`) or equations, one a line, found the name `constraints`",
    );
    check(
        "x = 1\nconstraints: x",
        "test:2:1: expected `unknowns:`, `parameters:`, `groups:`, `where:`, `minimize:`, or `name := expression`, found \
         `constraints:`",
    );
    check(
        "groups: x | z\nx = 1",
        "test:1:13: expected a declared name, found the unknown name `z`",
    );
    check(
        "a := b\nb := a\nx = a",
        "test:2:6: expected definitions that do not depend on themselves, found the cycle a -> b -> a",
    );
    check(
        "x^2\n + y^2 - 1\nx - y",
        "test:2:2: expected an equation; a sum goes on where the line before ends with `+`, found `+`",
    );
    check(
        "{x^2 + y^2 - 5, x*y - 2}",
        "test:1:1: expected a number, a name or `(`, found the character `{`",
    );
    check(
        "x = √2y",
        "test:1:5: expected `sqrt(2*y)` or `sqrt(2)*y`, found the character `√`, which is \
         written `sqrt(...)`",
    );
}

#[test]
fn constants_are_what_nothing_declares() {
    for text in [
        "x = 2*pi",
        "x = 2*PI",
        "x = 2*π",
        "x = 2*%pi",
        "p := pi; x = 2*p",
    ] {
        let written = |text: &str| {
            let system = read(text).system;
            formats::write(Format::Plain, &system, &FileSettings::default()).unwrap()
        };
        assert_eq!(written(text), written("x = 2*Pi"), "{text}");
    }
    let declared = read("unknowns: pi\npi^2 = 2");
    assert!(declared.warnings.is_empty());
    assert_eq!(declared.system.variables, ["pi"]);
    let i = ComplexRational::i();
    for text in ["x = 2i", "x = 2*%i", "x = 2*1i"] {
        let at = values(&read(text).system, &[rational(0, 1)], &[]);
        let expected = i.multiply(&rational(-2, 1));
        assert_eq!(at, [expected], "{text}");
    }
    // `2i` could be a product.
    check(
        "unknowns: i\n2i = 4",
        "test:2:2: expected a declared name, found the unknown name `1i`",
    );
}

#[test]
fn printed_mathematics_has_one_meaning() {
    for (printed, typed) in [
        ("x² − 3·x¹⁰ = 2 × y³ ÷ 4", "x^2 - 3*x^10 = 2*y^3/4"),
        ("-x² + y = 0", "-(x^2) + y = 0"),
        ("(x + y)²*2³ = y", "((x + y)^2)*8 = y"),
        ("y^x⁰ = x²^3", "y^(x^0) = x^6"),
    ] {
        let at = [rational(3, 1), rational(5, 7)];
        let value = |text: &str| values(&read(text).system, &at, &[]);
        assert_eq!(value(printed), value(typed), "{printed}");
    }
}

#[test]
fn root_signs_are_read_where_they_have_one_meaning() {
    for (printed, typed) in [
        ("√x = 2", "sqrt(x) = 2"),
        ("√2*x = √(x + 1)", "sqrt(2)*x = sqrt(x + 1)"),
        ("x + √x/2 = ∛x", "x + sqrt(x)/2 = cbrt(x)"),
    ] {
        assert_eq!(read(printed).system, read(typed).system, "{printed}");
    }
    for (text, expected) in [
        ("√x^2 = 4", "test:1:1: expected `sqrt(x^2)` or `sqrt(x)^2`"),
        ("y = √2x", "test:1:5: expected `sqrt(2*x)` or `sqrt(2)*x`"),
        (
            "y = 3√x",
            "test:1:6: expected `3*sqrt(...)` for a product, or `cbrt(...)`",
        ),
        ("y = 1, 5√x", "test:1:9: expected `5*sqrt(...)`"),
    ] {
        let said = formats::plain::typed("test", text).map(drop);
        let said = said.expect_err(text).to_string();
        assert!(said.starts_with(expected), "{text}: {said}");
    }
}

#[test]
fn signs_of_other_notations_are_named() {
    for (text, expected) in [
        ("x -> 2", "test:1:3: expected `=`, found `->`"),
        (
            "x! = 6",
            "test:1:2: expected an operator or the end of the line, found the character `!` (a factorial",
        ),
        ("x = 1,5", "test:1:6: expected a point, as in `1.5`"),
        (
            "x^ = 5",
            "test:1:4: expected an exponent: a number, a name or `(`, found `=`",
        ),
        (
            "sin^2(x) = 1",
            "test:1:6: expected `sin(...)^` for a power of `sin`, found `(`",
        ),
        (
            "sin²(x) = 1",
            "test:1:5: expected `sin(...)^` for a power of `sin`",
        ),
        (
            "x = 60deg",
            "test:1:7: expected an operator (such as `*pi/180` for degrees)",
        ),
    ] {
        let said = formats::plain::typed("test", text).map(drop);
        let said = said.expect_err(text).to_string();
        assert!(said.starts_with(expected), "{text}: {said}");
    }
    // A comma with a blank, or before an equation, stands between equations; `!=` is a condition.
    for text in ["x=1,2*y=3", "x != 6, x^2 = 4"] {
        formats::plain::typed("test", text).expect(text);
    }
}

/// A list of polynomials may begin with a variable (an ideal of Oscar.jl#2531); words alone are no equations.
#[test]
fn a_list_of_polynomials_may_begin_with_a_variable() {
    let system = read("w\nz\ny^3 + 2*y\nx^3 + x\n").system;
    assert_eq!((system.equation_count(), system.variable_count()), (4, 4));
    assert!(formats::read("test", b"hello\nworld\n").is_err());
}

/// Equations that a program writes may hold for all values; one that holds for none is refused.
#[test]
fn equations_that_always_hold_are_left_out_with_a_warning() {
    let problem = read("(1 + a*0^2) - 1*(1 + b*0^2) = 0\na + b = 3\na*b = 2\n");
    assert_eq!(problem.system.equation_count(), 2);
    let message = "`(1 + a*0^2) - 1*(1 + b*0^2) = 0` holds for all values, and is left out";
    let said: Vec<&str> = problem
        .warnings
        .iter()
        .map(|w| w.message.as_str())
        .collect();
    assert_eq!(said, [message]);
    // Quotients and powers that cancel hold for all values, where no denominator is 0.
    for (equation, has_denominators) in [
        ("x/(x - 1) - 1/(x - 1) = 1", true),
        ("(x - 1)/(x - 1) = 1", true),
        ("x/x = 1", true),
        ("1/x = 1/x", true),
        ("(x + 1)^2 = x^2 + 2*x + 1", false),
        ("(p*x + 1)*x = p*x^2 + x", false),
    ] {
        let Problem {
            system, warnings, ..
        } = read(&format!("parameters: p\n{equation}\nx^2 = 4*p\n"));
        assert_eq!(
            (system.equation_count(), &system.equation_names[0][..]),
            (1, "f2")
        );
        assert_eq!(
            !system.degenerate.is_empty(),
            has_denominators,
            "{equation}"
        );
        let said = format!("`{equation}` holds for all values, and is left out");
        assert_eq!(warnings[0].message, said);
        let json_text = format!(
            r#"{{"variables": ["x"], "parameters": ["p"], "equations": ["x^2 = 4*p", "{equation}"]}}"#
        );
        let problem = read(&json_text);
        assert_eq!(problem.system.equation_count(), 1);
        assert_eq!(problem.warnings[0].message, said);
        let alone = refused(&format!("parameters: p\n{equation}\n"));
        let expected = "every value of the unknowns solves";
        assert!(alone.contains(expected), "{alone}");
    }
    // An equation of another notation is refused, with the reason.
    let bertini = "variable_group x; function f, g; f = x/x - 1; g = x^2 - 4; END;";
    assert!(refused(bertini).contains("`f`, whose numerator is 0: it holds for all values"));
    assert!(refused("a + b = 3\n1 = 2\n").contains("contains none"));
    assert!(refused("0 = 0\n").contains("at least one"));
}

#[test]
fn other_notations_are_not_taken_for_equations() {
    for (text, format) in [
        ("2\n x**2 + y; x - y;\n", Format::Phcpack),
        ("2 2\n x**2 + y;\n x - y;\n", Format::Phcpack),
        (
            "variable_group x; function f; f = x^2 - 1;",
            Format::Bertini,
        ),
        ("x, y\n0\nx^2-y,\nx*y-2\n", Format::Msolve),
        ("vars := [x]: sys := [x^2 = 2]:", Format::Maple),
        (
            "{\"variables\": [\"x\"], \"equations\": [\"x^2 = 2\"]}",
            Format::Json,
        ),
    ] {
        assert_eq!(read(text).format, format, "{text}");
    }
    let json = r#"{"variables": ["x"], "equations": ["2*x^2 == 3*x + 2"]}"#;
    let at = values(&read(json).system, &[rational(5, 1)], &[]);
    assert_eq!(at, [rational(33, 1)]);
}
