//! Known answers in one unknown.

use super::{NotSolved, UnivariateRoots, univariate_roots};
use crate::formats::read;
use cognate_numeric::decimal_text::complex_text;
use rug::float::Constant;
use rug::{Float, Integer};

const OPERATIONS: u64 = 1 << 36;

fn solve(equations: &[&str]) -> UnivariateRoots {
    let text = equations.join("\n");
    let system = read("test", text.as_bytes()).expect("equations").system;
    univariate_roots(&system, &[], 16, OPERATIONS).expect("roots")
}

/// Real and imaginary part and multiplicity of each root that is not removed.
fn list(roots: &UnivariateRoots) -> Vec<(f64, f64, u32)> {
    let kept = roots.roots.iter().filter(|root| !root.is_removed);
    kept.map(|r| (r.rounded.re, r.rounded.im, r.multiplicity))
        .collect()
}

#[test]
fn multiplicities_are_exact() {
    assert_eq!(
        list(&solve(&["x^3 - 3*x + 2"])),
        [(-2.0, 0.0, 1), (1.0, 0.0, 2)]
    );
    let roots = solve(&["(x-1)^7*(x+2)^3*(x^2+1)^2"]);
    let expected = [(-2.0, 0.0, 3), (0.0, -1.0, 2), (0.0, 1.0, 2), (1.0, 0.0, 7)];
    assert_eq!((roots.degree, list(&roots)), (14, expected.to_vec()));
    let roots = solve(&["x^5*(x - I)^2*(x - 3)*(2*x - 1 - I)"]);
    let expected = [(0.0, 0.0, 5), (0.0, 1.0, 2), (0.5, 0.5, 1), (3.0, 0.0, 1)];
    assert_eq!(list(&roots), expected);
}

#[test]
fn wilkinsons_roots_are_integers() {
    let product: Vec<String> = (1..=20).map(|k| format!("(x-{k})")).collect();
    let expected: Vec<_> = (1..=20).map(|k| (f64::from(k), 0.0, 1)).collect();
    assert_eq!(list(&solve(&[&product.join("*")])), expected);
}

/// Of Mignotte's polynomials two roots are nearer to each other than doubles tell (M. Mignotte, Some useful bounds, 1982).
#[test]
fn mignottes_roots_come_apart() {
    let roots = solve(&["x^20 - 2*(1000*x - 1)^2"]);
    assert_eq!((roots.degree, roots.roots.len()), (20, 20));
    let real: Vec<_> = roots.roots.iter().filter(|root| root.is_real()).collect();
    assert_eq!(real.len(), 4, "one is negative, three are positive");
    assert_eq!((real[1].rounded.re, real[2].rounded.re), (0.001, 0.001));
    let apart = real[2].value.re.clone() - &real[1].value.re;
    // (1/1000)^10 / (1000 sqrt 2) to either side.
    let ratio = apart * Integer::from(Integer::u_pow_u(10, 33));
    assert!((ratio.to_f64() - 2.0f64.sqrt()).abs() < 1e-12);
}

/// The roots of T_n are cos((2 k - 1) pi / (2 n)).
#[test]
fn chebyshevs_roots_are_cosines() {
    let n: u32 = 60;
    let (mut last, mut present) = ("1".to_string(), "x".to_string());
    let mut text = format!("T0 := {last}\nT1 := {present}\n");
    for k in 2..=n {
        (last, present) = (format!("T{}", k - 2), format!("T{}", k - 1));
        text += &format!("T{k} := 2*x*{present} - {last}\n");
    }
    text += &format!("T{n}");
    let roots = solve(&[&text]);
    assert_eq!(roots.roots.len(), n as usize);
    let pi = Float::with_val(200, Constant::Pi);
    for (root, k) in roots.roots.iter().zip((1..=n).rev()) {
        let angle = Float::with_val(200, &pi * (2 * k - 1)) / (2 * n);
        assert_eq!(root.rounded.re, angle.cos().to_f64());
        assert!(root.is_real() && root.error < 1e-18 && root.condition >= 1.0);
    }
}

#[test]
fn where_a_denominator_is_0_a_root_is_removed() {
    assert_eq!(
        list(&solve(&["x + 1/x = 5/2"])),
        [(0.5, 0.0, 1), (2.0, 0.0, 1)]
    );
    let roots = solve(&["(x^2 - 1)^2/(x - 1) = 0"]);
    assert_eq!((roots.degree, list(&roots)), (4, vec![(-1.0, 0.0, 2)]));
    let roots = solve(&["x^3*(x - 3)/x^2 = 0"]);
    assert_eq!(list(&roots), [(3.0, 0.0, 1)]);
}

#[test]
fn several_equations_have_the_roots_of_their_divisor() {
    let roots = solve(&["(x-1)^2*(x-2)", "(x-1)^3*(x+5)", "(x-1)^2*(x^2+7)"]);
    assert_eq!(list(&roots), [(1.0, 0.0, 2)]);
    assert_eq!(solve(&["x^2 - 2", "x^2 - 3"]).degree, 0);
}

#[test]
fn clusters_and_long_coefficients_are_told_apart() {
    let near = format!("1{}1", "0".repeat(29));
    let text = format!(
        "(10^30*x - {near})*(x - 1)*(10^30*x - {near} + 2)*(x^2 + 1)*(10^60*x^2 + {near}^2)"
    );
    let roots = solve(&[&text]);
    let real: Vec<_> = roots.roots.iter().filter(|root| root.is_real()).collect();
    assert_eq!((roots.roots.len(), real.len()), (7, 3));
    let imaginary = roots.roots.iter().filter(|root| root.rounded.re == 0.0);
    assert_eq!(imaginary.count(), 4, "real parts are exactly 0");
    let long = "7".repeat(1000);
    let roots = solve(&[&format!("({long}*x - 1)*(x - {long})*(x^2 - 2)")]);
    assert_eq!(roots.roots.len(), 4);
    assert!(roots.roots.iter().all(|root| root.is_real()));
}

#[test]
fn what_is_not_rational_or_too_long_is_refused() {
    let system = read("test", b"x^2 - sqrt(2)").expect("an equation").system;
    let refused = univariate_roots(&system, &[], 16, OPERATIONS);
    assert_eq!(refused.err(), Some(NotSolved::Coefficients));
    let system = read("test", b"x^50 - 3*x + 1").expect("an equation").system;
    let refused = univariate_roots(&system, &[], 16, 1000);
    assert_eq!(refused.err(), Some(NotSolved::TooLong));
}

#[test]
fn digits_are_those_that_are_asked_for() {
    let system = read("test", b"x^2 - 2").expect("an equation").system;
    let roots = univariate_roots(&system, &[], 60, OPERATIONS).expect("roots");
    let [_, im] = complex_text(&roots.roots[1].value, 60);
    let [re, _] = complex_text(&roots.roots[1].value, 60);
    // OEIS A002193.
    let expected = "1.41421356237309504880168872420969807856967187537694807317668";
    assert_eq!((re.as_str(), im.as_str()), (expected, "0"));
}
