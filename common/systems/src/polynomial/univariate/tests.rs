//! Known answers in one unknown.

use super::{UnivariateRoots, univariate_roots};
use crate::formats::read;

const OPERATIONS: u64 = 1 << 36;

fn solve(equations: &[&str]) -> UnivariateRoots {
    let text = equations.join("\n");
    let system = read("test", text.as_bytes()).expect("equations").system;
    univariate_roots(&system, &[], 16, OPERATIONS).expect("roots")
}

/// Real and imaginary part and multiplicity of each root that is not removed.
fn list(roots: &UnivariateRoots) -> Vec<(f64, f64, u32)> {
    let kept = roots.roots.iter().filter(|root| !root.is_removed);
    kept.map(|r| (r.rounded.re, r.rounded.im, r.multiplicity)).collect()
}

#[test]
fn multiplicities_are_exact() {
    assert_eq!(list(&solve(&["x^3 - 3*x + 2"])), [(-2.0, 0.0, 1), (1.0, 0.0, 2)]);
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

/// Seconds, for a look.
fn timed(name: &str, equation: &str) -> UnivariateRoots {
    let begin = std::time::Instant::now();
    let roots = solve(&[equation]);
    let bits = roots.roots.iter().map(|r| r.precision_bits).max().unwrap();
    println!("{name}: degree {} distinct {} bits {bits} {:?}", roots.degree, roots.roots.len(), begin.elapsed());
    roots
}

#[test]
fn look() {
    timed("mignotte 20", "x^20 - 2*(1000*x-1)^2");
    timed("mignotte 100", "x^100 - 2*(1000*x-1)^2");
    timed("x^200-1", "x^200 - 1");
    let dense = |n: u32| (0..=n).map(|k| format!("{}*x^{k}", (k * 7919 + 13) % 101 + 1)).collect::<Vec<_>>().join("+");
    timed("dense 50", &dense(50));
    timed("dense 200", &dense(200));
    timed("sparse 1000", "x^1000 + 3*x^517 - 7*x^31 + 2");
    timed("power", "(x^2+x+1)^60*(x-3)");
    timed("cluster", "(x-1)*(x-1-1/10^30)*(x-1+1/10^30)*(x^2+1+1/10^30)*(x^2+1)");
}
