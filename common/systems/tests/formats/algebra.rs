//! The notations of computer algebra: what is read, what is refused and where.

use crate::support::{rational, read, refused, values};
use cognate_systems::formats::{self, FileSettings, Format};

/// The first line of a message.
#[track_caller]
fn check(text: &str, expected: &str) {
    let message = refused(text);
    assert_eq!(message.lines().next().unwrap_or_default(), expected);
}

/// x^2 - y and x y - 2/3 in each notation.
const SAME: [(Format, &str); 4] = [
    (
        Format::Macaulay2,
        "-- conics\nR = QQ[x, y, MonomialOrder => Lex]\nI = ideal(x^2 - y, -* second *- x*y - 2/3);\n",
    ),
    (
        Format::Maple,
        "vars := [x, y]: # in this order\nsys := {x^2 = y, x*y - 2/3}:\n",
    ),
    (
        Format::Singular,
        "LIB \"solve.lib\";\nring r = 0, (x, y), dp; // graded\nideal i = x^2 - y,\n  x*y - 2/3;\n",
    ),
    (Format::Msolve, "x, y\n0\nx^2-y,\nx*y-2/3\n"),
];

#[test]
fn one_system_in_all_notations() {
    let point = [rational(3, 1), rational(5, 1)];
    for (format, text) in SAME {
        let problem = read(text);
        assert_eq!(problem.format, format);
        assert_eq!(problem.warnings, []);
        let system = problem.system;
        assert_eq!(system.variables, ["x", "y"]);
        assert_eq!(
            values(&system, &point, &[]),
            [rational(4, 1), rational(43, 3)]
        );
        let written = formats::write(format, &system, &FileSettings::default()).unwrap();
        let reread_problem = read(&written);
        assert_eq!(reread_problem.format, format, "{written}");
        assert_eq!(
            values(&reread_problem.system, &point, &[]),
            values(&system, &point, &[])
        );
    }
}

#[test]
fn parameters_ranges_and_complex_numbers() {
    let rings = read("R = QQ[a][x_1..x_3]\nideal {x_1 - a, x_2^2 - x_3, x_3*x_1}").system;
    assert_eq!(rings.variables, ["x_1", "x_2", "x_3"]);
    assert_eq!(rings.parameters, ["a"]);
    assert_eq!(
        read("S = CC[a..d]; I = ideal(a-ii, b, c, d)")
            .system
            .variables
            .len(),
        4
    );
    let singular = read("ring r = (0, a), (x), lp; ideal i = x^2 - a;").system;
    assert_eq!(
        (singular.variables, singular.parameters),
        (vec!["x".into()], vec!["a".into()])
    );
    let unit = read("ring r = (0,i),(x),dp; minpoly = i^2 + 1; ideal j = x - i;").system;
    assert!(unit.parameters.is_empty());
    let maple = read("vars := [y, x]; s := [x^2 - p, y[1]*x + y];").system;
    assert_eq!(maple.variables, ["y", "x"]);
    assert_eq!(maple.parameters, ["p", "y[1]"]);
    let order = read("s := [b - a^2, a + b - 1]").system;
    assert_eq!(order.variables, ["b", "a"]);
}

#[test]
fn what_is_wrong_has_its_place() {
    check(
        "R = QQ[x, y]\nI = ideal(x^2 - y, x*z)\n",
        "test:2:22: expected a declared name, found the unknown name `z`",
    );
    check(
        "R = ZZ/101[x, y]\nI = ideal(x, y)",
        "test:1:5: expected a ring over QQ, RR or CC: over a finite field nothing is followed, found `ZZ/101`",
    );
    check(
        "R = QQ[x, y]\nI = ideal(x^2 - y",
        "test:2:18: expected `)`, found the end of the text",
    );
    check(
        "R = QQ[x, y]\nf = 3",
        "test:2:6: expected an ideal such as ideal(x^2 - y), found none",
    );
    check(
        "R = QQ[x_1..y_3]\nI = ideal(x_1)",
        "test:1:8: expected a range such as x_1..x_4 or a..d, found `x_1..y_3`",
    );
    check(
        "ring r = 32003, (x, y), dp;\nideal i = x, y;",
        "test:1:10: expected 0 or QQ: over a finite field nothing is followed, found `32003`",
    );
    check(
        "ring r = 0, (x, y), dp;\nideal i = x2 - y;",
        "test:2:11: expected `x^2`: Singular's short form is not read, found `x2`",
    );
    check(
        "ring r = 0, (x, y), dp;\npoly f = x;",
        "test:2:12: expected an ideal such as `ideal i = x^2 - y;`, found none",
    );
    check(
        "ring r = 0, x, dp; ideal i = x;",
        "test:1:13: expected the variables in brackets, as (x, y), found `x`",
    );
    check(
        "sys := [x^2 - , y]",
        "test:1:15: expected a number, a name or `(`, found `,`",
    );
    check(
        "a := [x - 1]; b := [y^2 - 2];",
        "test:1:21: expected one list of polynomials, and one of variables, found another list",
    );
    check(
        "sys := [x - 1]; y := 3;",
        "test:1:19: expected a list after `:=`, such as [x^2 - y, x*y = 1], found something else",
    );
    check(
        "x,y\n65521\nx+y,x\n",
        "test:2:1: expected the characteristic 0: over a finite field nothing is followed, found `65521`",
    );
    check(
        "x,x\n0\nx+1\n",
        "test:1:3: expected a new name, found `x`, which is declared already",
    );
    check(
        "x,y\n0\nx+y,\n",
        "test:4:1: expected a number, a name or `(`, found the end of the text",
    );
}

#[test]
fn what_a_notation_cannot_say_is_refused() {
    let write = |format, text| {
        let written = formats::write(format, &read(text).system, &FileSettings::default());
        written.map_err(|e| e.to_string())
    };
    let family = "variable x; parameter p; function f; f = x^2 - p; END;";
    let none = Err("msolve notation has no parameters".to_owned());
    assert_eq!(write(Format::Msolve, family), none);
    let complex = "variable x; function f; f = x^2 - I; END;";
    let none = Err("msolve notation has no numbers that are not real".to_owned());
    assert_eq!(write(Format::Msolve, complex), none);
    let no_variable = "msolve notation has no equations in which all variables cancel";
    for text in [
        "variable x; function f; f = x - 1 - x; END;",
        "variable x; function f; f = (x + 1)^2 - x^2 - 2*x - 1; END;",
    ] {
        assert_eq!(write(Format::Msolve, text).unwrap_err(), no_variable);
    }
    assert!(
        write(Format::Macaulay2, complex)
            .unwrap()
            .starts_with("R = CC[x]")
    );
    let root = "variable x; function f; f = x^2 - sqrt(2); END;";
    for format in [Format::Macaulay2, Format::Singular, Format::Msolve] {
        let refused = write(format, root).unwrap_err();
        assert!(refused.contains("has no"), "{refused}");
    }
    assert!(write(Format::Maple, root).unwrap().contains("sqrt(2)"));
    let product = "variable x, y; function f; f = (x - y)*(x + y) - 1/3; END;";
    let written = write(Format::Msolve, product).unwrap();
    assert_eq!(written, "x,y\n0\n-1/3-y^2+x^2\n");
}
