//! Exact points of systems whose solutions are known by construction, or from the literature.

use super::*;

const OPERATIONS: u64 = 2_000_000_000;

fn points_of(text: &str) -> Option<Vec<ExactPoint>> {
    let system = crate::formats::read("test", text.as_bytes()).expect("equations of this test");
    exact_points(&system.system, &[], 15, OPERATIONS).expect("exact equations")
}

fn rounded(points: &[ExactPoint]) -> Vec<Vec<[f64; 2]>> {
    let parts = |value: &Complex64| [value.re, value.im];
    let point = |point: &ExactPoint| point.rounded.iter().map(parts).collect();
    points.iter().map(point).collect()
}

#[test]
fn simple_points_are_rounded_to_the_last_bit() {
    let points = points_of("x^2 + y^2 = 5\nx*y = 2").expect("four points");
    let real = |x: f64, y: f64| vec![[x, 0.0], [y, 0.0]];
    let expected = [
        real(-2.0, -1.0),
        real(-1.0, -2.0),
        real(1.0, 2.0),
        real(2.0, 1.0),
    ];
    assert_eq!(rounded(&points), expected);
    assert!(
        points
            .iter()
            .all(|point| point.is_real && point.multiplicity == 1)
    );
    let points = points_of("x^2 + 1 = 0\ny - x^3 - 1/3").expect("two points");
    assert_eq!(
        rounded(&points),
        [
            vec![[0.0, -1.0], [1.0 / 3.0, 1.0]],
            vec![[0.0, 1.0], [1.0 / 3.0, -1.0]]
        ]
    );
    assert!(!points[0].is_real);
}

/// Clusters, large and small coordinates: each has the digits of a double.
#[test]
fn near_points_are_told_apart() {
    let points = points_of("(x - 1)*(x - 1 - 1e-30)\ny^2 = 1e20*x").expect("four points");
    assert_eq!(points.len(), 4);
    let first = &points[0];
    assert_eq!(first.rounded[0], points[3].rounded[0]);
    assert_ne!(first.values[0], points[3].values[0]);
    let points = points_of("1e-18*y^3 - x^2 + 2\n(x - y)^2 = 2").expect("points");
    assert_eq!(points.len(), 6);
}

/// Fat points of known multiplicities (B. Dayton, Z. Zeng, 2005), also where powers of one unknown do not reach the end of
/// the local ring.
#[test]
fn multiple_points_have_the_multiplicity_of_the_ideal() {
    let points = points_of("x^2 + y^2\nx^3").expect("a point");
    assert_eq!((points.len(), points[0].multiplicity), (1, 6));
    let points = points_of("(x - 1)^2*(x + 2)\n(y - 3)^3\nx*z = 6").expect("two points");
    let each: Vec<(f64, f64, f64, u64)> = points
        .iter()
        .map(|p| {
            (
                p.rounded[0].re,
                p.rounded[1].re,
                p.rounded[2].re,
                p.multiplicity,
            )
        })
        .collect();
    assert_eq!(each, [(-2.0, 3.0, -3.0, 3), (1.0, 3.0, 6.0, 6)]);
    let points = points_of("(x^2 - 2)^2\n(y^2 - x)^2\nx*y*(y^2 - x)").expect("points");
    assert_eq!(points.iter().map(|p| p.multiplicity).sum::<u64>(), 8);
}

#[test]
fn points_where_a_denominator_is_0_are_none() {
    let points = points_of("x/y + y/x = 5/2\n1/x + 1/y = 3/2").expect("two points");
    assert_eq!(points.len(), 2);
    assert_eq!(points_of("1/x - 1/y = 1\nx = y"), Some(Vec::new()));
    assert_eq!(points_of("x*y - 1\nx*y - 2"), Some(Vec::new()));
}

#[test]
fn sets_and_constants_that_are_not_rational_are_left_to_others() {
    assert_eq!(points_of("x*y\nx*(y - 1)*(x + 1)*x"), None);
    let system = crate::formats::read("test", b"x^2 - Pi\ny - x").expect("equations");
    assert!(exact_points(&system.system, &[], 15, OPERATIONS).is_err());
}

/// S. Katsura, 1986; G. Bj\u{f6}rck, 1985.
#[test]
fn known_systems_have_their_points() {
    let katsura = "x + 2*y + 2*z + 2*w = 1\nx^2 + 2*y^2 + 2*z^2 + 2*w^2 = x\n2*x*y + 2*y*z + 2*z*w = y\n\
                   y^2 + 2*x*z + 2*y*w = z";
    assert_eq!(points_of(katsura).map(|points| points.len()), Some(8));
    let cyclic = "a + b + c + d + e\na*b + b*c + c*d + d*e + e*a\na*b*c + b*c*d + c*d*e + d*e*a + e*a*b\n\
                  a*b*c*d + b*c*d*e + c*d*e*a + d*e*a*b + e*a*b*c\na*b*c*d*e = 1";
    let points = points_of(cyclic).expect("70 points");
    assert_eq!(points.len(), 70);
    assert_eq!(points.iter().filter(|point| point.is_real).count(), 10);
}

#[test]
fn complex_coefficients_are_exact_too() {
    let points = points_of("x^2 = I\ny - I*x").expect("two points");
    let half = 0.5f64.sqrt();
    let expected = [-half, half].map(|half| vec![[half, half], [-half, half]]);
    assert_eq!(rounded(&points), expected);
    let points = points_of("(x - I)^2*(x + 2)\ny^2 = x + 2").expect("three points");
    let each: Vec<(u64, bool)> = points.iter().map(|p| (p.multiplicity, p.is_real)).collect();
    assert_eq!(each, [(2, true), (2, false), (2, false)]);
}

#[test]
fn square_roots_of_numbers_are_the_positive_ones() {
    let points = points_of("x - y = sqrt(2)\n1e-18*y^3 - x^2 + 2").expect("three points");
    assert_eq!(points.len(), 3);
    assert!(
        points
            .iter()
            .all(|point| point.is_real && point.rounded.len() == 2)
    );
    assert!(points[2].rounded[0].re > 9e17, "{points:?}");
    let points = points_of("(x^2 - 2*sqrt(2)*x + 2)*Pi\ny - x/sqrt(3)").expect("a point");
    assert_eq!((points.len(), points[0].multiplicity), (1, 2));
    assert_eq!(points[0].rounded[0].re, 2f64.sqrt());
}

#[test]
fn numbers_with_many_digits_count_as_exact_but_for_more_equations_than_unknowns() {
    let system = |text: &str| {
        let problem = crate::formats::read("test", text.as_bytes()).expect("equations");
        assert!(has_rounded_numbers(&problem.system), "{text}");
        problem.system
    };
    let square = system("x^2 - 0.33333333333\ny - x");
    let points = exact_points(&square, &[], 15, OPERATIONS).expect("as they stand");
    assert_eq!(points.map(|points| points.len()), Some(2));
    for text in [
        "x - 0.333333333333\n3*x - 1",
        "(x - 33333333333333/100000000000000)^2\n(y - x)^2\n3*x - 1",
    ] {
        assert_eq!(
            exact_points(&system(text), &[], 15, OPERATIONS),
            Err(NotCounted::NotExact)
        );
    }
}

/// Two binomials, of which the determinant of the exponents is -46.
#[test]
fn high_degrees_are_no_obstacle() {
    let points = points_of("20*x^26*y^92 = 78\n84*x^33*y^115 = -2").expect("points");
    assert_eq!(points.len(), 46);
    assert!(points.iter().all(|point| point.multiplicity == 1));
}

/// Few terms with exponents near one line: the mixed volume of their Newton polygons is 154.
#[test]
fn few_terms_of_high_degree_are_solved_in_monomials() {
    let points = points_of("-8 - 90*x^62*y^45 + 8*x^74*y^55 - 20*x^18*y^14\n10 + 36*x^12*y^11");
    let points = points.expect("points");
    assert_eq!(points.len(), 154);
    assert!(points.iter().all(|point| point.residual < 1e-13));
    // A determinant of 700; a real solution for each choice of signs.
    let points = points_of("(x^40*y^30 - 2)^2\nx^30*y^40 = 3").expect("points");
    assert_eq!(points.len(), 700);
    assert!(points.iter().all(|point| point.multiplicity == 2));
    assert_eq!(points.iter().filter(|point| point.is_real).count(), 4);
    let points = points_of("x^30 = 1\ny^30 = x").expect("points");
    let real = points.iter().filter(|point| point.is_real);
    let real: Vec<ExactPoint> = real.cloned().collect();
    let one = |y: f64| vec![[1.0, 0.0], [y, 0.0]];
    assert_eq!(points.len(), 900);
    assert_eq!(rounded(&real), [one(-1.0), one(1.0)]);
}

/// A square root of a number is the positive one, and a denominator is nowhere 0.
#[test]
fn monomials_keep_square_roots_and_denominators() {
    let points = points_of("x^60*y^61 = sqrt(2)\nx^61*y^60 = 3").expect("points");
    assert_eq!(points.len(), 121);
    assert_eq!(points.iter().filter(|point| point.is_real).count(), 1);
    let points = points_of("(x^60*y^60 - 1)*(x^60*y^60 - 2)/(x^60*y^60 - 1)\nx^61*y^60 = 3");
    assert_eq!(points.expect("points").len(), 60);
}
