//! PHCpack: counts, the order of the unknowns, complex coefficients.

use crate::support::{rational, read, refused, values};
use cognate_numeric::rational::ComplexRational;
use cognate_systems::formats::Format;

#[test]
fn the_order_of_the_unknowns_is_that_of_their_appearance() {
    let text = "2\n y - y + x*y - (1.5E+00 + 2.0E+00*i)*x^2;\n 2*x - y;\n\nTITLE : two conics\n";
    let problem = read(text);
    assert_eq!(problem.format, Format::Phcpack);
    assert_eq!(problem.system.variables, ["y", "x"]);
    assert!(problem.warnings.is_empty());
    let at = values(&problem.system, &[rational(3, 1), rational(2, 1)], &[]);
    assert_eq!(at, [ComplexRational::new(0, -8), rational(1, 1)]);
}

#[test]
fn counts_must_agree_with_the_polynomials() {
    let message = |text| refused(text).lines().next().unwrap_or_default().to_string();
    assert_eq!(
        message("2\n x*y - 1;\n x + z;\n"),
        "test:3:6: expected 2 unknowns, as the first line says, found another one, `z`"
    );
    assert_eq!(
        message("2 3\n x*y - 1;\n x + y;\n"),
        "test:1:1: expected the number of unknowns that occur, 2, found 3"
    );
    assert_eq!(
        message("3\n x*y - 1;\n x + z;\n"),
        "test:4:1: expected polynomial 3 of 3, found the end of the text"
    );
    let problem = read("1 2\n x*y - 1;\n x + y;\n");
    let warning = problem.warnings[0].to_string();
    assert_eq!(warning, "test:3: what follows the 1 polynomials is ignored");
    assert_eq!(read("2 3*x + y;\n x - y - 1;").system.equation_count(), 2);
}

#[test]
fn names_that_begin_with_e_are_names() {
    let system = read("2 3\nE1*e2 + 2e1*e;\n e2**2 - E1*I;").system;
    assert_eq!(system.variables, ["E1", "e2", "e"]);
    let point = [rational(2, 1), rational(3, 1), rational(5, 1)];
    assert_eq!(
        values(&system, &point, &[]),
        [rational(106, 1), ComplexRational::new(9, -2)]
    );
}
