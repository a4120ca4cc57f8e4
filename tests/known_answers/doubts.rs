//! Answers that paths leave in doubt: equations with exact coefficients and few solutions settle them.

use crate::check::solve;
use cognate_algorithms::plan::{SolveMethod, SolveOptions};
use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::formats;
use cognate_tests::planted::verdict::as_submitted;
use cognate_tests::systems::written;
use num_complex::Complex64;

fn answer(text: &str, options: &SolveOptions) -> SolutionSet {
    let set = solve(&written(text), options, &|_| None).1.remove(0);
    assert_eq!(set.paths.sum(), set.paths.total, "{text}");
    set
}

/// Distinct solutions, with multiplicity, and real ones, settled with three seeds.
fn always_settled(text: &str, expected: [u64; 3]) {
    for seed in 1..=3 {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let set = answer(text, &options);
        let counts = &set.counts;
        let numbers = [
            counts.distinct,
            counts.with_multiplicity,
            counts.real.unwrap_or(0),
        ];
        assert_eq!(numbers, expected, "seed {seed}: {text}");
        let is_complete = counts.complete == Completeness::Yes;
        assert!(
            set.settled() && is_complete,
            "seed {seed}: {:?}",
            set.warnings
        );
    }
}

/// One point of multiplicity 8, along a curve; a double point of products of planes; two quadrics after a change of
/// coordinates of degree 6.
#[test]
fn multiple_points_and_curved_coordinates() {
    always_settled(
        "variable_group x, y, z; function f, g, h; \
         f = 4*x^2 - 8*x*y - 8*x*z + 4*y^2 + 8*y*z + 4*z^2 - 2*x + y - z - 3; \
         g = 4*x^2 - 4*x*y + 4*x*z + y^2 - 2*y*z + z^2 + 14*x - 4*y + 6*z + 10; \
         h = 4*x^2 + 8*x*y + 4*y^2 + 4*x + 4*y + 1;",
        [1, 8, 1],
    );
    always_settled(
        "variable_group x, y, z; function f, g, h; \
         f = (6*x - 8*y + 4*z - 4)*(-3*x - 7*z + 5); \
         g = (-3*x - 9*y + 9*z - 4)*(9*x - 9*y + 5*z + 1)*(x - 7*y + 7)*(-3*x + 7*y - 2*z + 4); \
         h = x - 4*y + 9;",
        [7, 8, 7],
    );
    always_settled(
        "variable_group x, y; function f, g; \
         f = Pi*(-20*x^12 + 12*x^7 + 20*x^6*y - 10*x^6 + 8*x^2 - 6*x*y - 5*y^2 + 5*x + 5*y - 1); \
         g = -4*x^12 - 10*x^7 + 4*x^6*y + 12*x^6 - 8*x^2 + 5*x*y - y^2 + 8*x - 6*y + 8;",
        [4, 4, 4],
    );
}

/// Two solutions nearer to each other than doubles tell, behind a constant that is not rational; coefficients from 1 to
/// 1e100 (Macaulay2, NumericalAlgebraicGeometry, luke-NID-e100).
#[test]
fn near_solutions_and_large_coefficients() {
    always_settled(
        "variable_group x, y; function f, g; \
         f = Pi*((x - 1)^2 - 1/10^18); g = y^2 - 3*x - 1;",
        [4, 4, 4],
    );
    always_settled(
        "variable_group x, y, z; function f, g, h; \
         f = Pi*((1e100*y^2 + x^2 + z^2 - 1)*x); g = (y^2 + x^2 + z^2 - 1)*y; h = x + 2*y - 3*z - 1;",
        [5, 9, 5],
    );
}

/// Steady states of two coupled oscillators (HomotopyContinuation.jl, issue 492) at a frequency: 9 of the 81 paths end at
/// solutions, of norms from 1e-5 to 2e10; also at a complex frequency, where a family begins.
#[test]
fn steady_states_of_two_oscillators() {
    let equations = "parameter a; variable_group x, y, u, v; function f, g, h, k; \
        f = 4.5*x - 9/2*x*a^2 + 1.5*x*u^2 + 1.5*x*v^2 + 0.00015*y*a + 19.5*y^2*x + 0.00375*y^3*a \
            + 0.15*v^2*u + 0.00375*y*x^2*a + 19.5*x^3 - 0.05*u^3; \
        g = 4.5*y - 0.00015*x*a - 0.00375*x^3*a - 9/2*y*a^2 + 19.5*y*x^2 + 1.5*y*u^2 + 1.5*y*v^2 \
            - 0.15*v*u^2 - 0.00375*y^2*x*a + 19.5*y^3 + 0.05*v^3; \
        h = -1.5e-05 + 1/2*u - 0.15*x*u^2 + 0.15*x*v^2 + 1.5*x^2*u + 1.5*y^2*u - 1/2*u*a^2 + 1e-05*v*a \
            + 3/8*v^2*u + 2.5e-05*v^3*a - 0.3*y*v*u + 2.5e-05*v*u^2*a + 3/8*u^3; \
        k = 1/2*v + 1.5*x^2*v - 0.15*y*u^2 + 0.15*y*v^2 + 1.5*y^2*v - 1e-05*u*a - 2.5e-05*u^3*a \
            - 1/2*v*a^2 + 3/8*v*u^2 + 0.3*x*v*u - 2.5e-05*v^2*u*a + 3/8*v^3;";
    let frequencies = [(1.0, 0.0), (1.014737, 0.0), (1.5, 0.0), (1.25, 0.375)];
    for (re, im) in frequencies {
        let options = SolveOptions {
            target_parameters: vec![vec![Complex64::new(re, im)]],
            ..SolveOptions::default()
        };
        let set = answer(equations, &options);
        let counts = &set.counts;
        let numbers = [
            counts.distinct,
            counts.nonsingular,
            counts.with_multiplicity,
        ];
        assert_eq!(
            (numbers, set.settled()),
            ([9; 3], true),
            "{re}, {im}: {counts:?}"
        );
    }
}

/// Pairs of solutions 1e-9 apart, where paths close like those to double points: singular ends that the equations decide.
#[test]
fn singular_ends_that_are_near_pairs() {
    always_settled(
        "variable_group x, y; function f, g; \
         f = -6000000000*x^3 + 4000000000*x^2*y - 48000000003*x^2 + 24000000002*x*y - 126000000015*x + 36000000006*y - 108000000018; \
         g = 6*x^2 + 30*x*y + 36*y^2 + 9*x + 12*y - 15;",
        [6, 6, 6],
    );
}

/// Two binomials of degrees 118 and 148: as many solutions as the determinant of the exponents, 46; paths fail.
#[test]
fn binomials_of_high_degree() {
    let text =
        "variable_group x, y; function f, g; f = -78 + 20*x^26*y^92; g = -2 - 84*x^33*y^115;";
    let set = answer(text, &SolveOptions::default());
    assert_eq!(
        (set.counts.distinct, set.counts.with_multiplicity),
        (46, 46)
    );
    assert!(set.settled(), "{:?}", set.warnings);
}

/// Carbonate and phosphate in water (github bjodah/chempy#161, without HCl and acetate): equilibrium constants are powers of
/// ten that are not rational. The mixed volume is 22; the one solution with positive concentrations by bisection for H in
/// the balance of charges, Python, double precision.
#[test]
fn powers_of_ten_are_constants_as_others_are() {
    let text = "variable_group CO2, H2CO3, HCO3, CO3, HPO4, H2PO4, Na2HPO4, KH2PO4, Na, K, H, OH; \
        function f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12; \
        f1 = CO2 + H2CO3 + HCO3 + CO3 - 3; f2 = HPO4 + H2PO4 + Na2HPO4 + KH2PO4 - 0.1; \
        f3 = 2*Na2HPO4 + Na - 0.1156; f4 = K + KH2PO4 - 0.0422; f5 = H2CO3 - 1.7e-3*CO2; \
        f6 = H*HCO3 - 10^(-6.3)*H2CO3; f7 = H*CO3 - 10^(-10.3)*HCO3; f8 = H2PO4*OH - 10^(-6.79)*HPO4; \
        f9 = Na^2*HPO4 - 10^5*Na2HPO4; f10 = K*H2PO4 - 10^5*KH2PO4; f11 = H*OH - 10^(-14); \
        f12 = H + Na + K - HCO3 - 2*CO3 - 2*HPO4 - H2PO4 - OH;";
    let set = answer(text, &SolveOptions::default());
    assert!(set.settled(), "{:?}", set.warnings);
    assert_eq!((set.counts.distinct, set.counts.nonsingular), (22, 22));
    let concentrations: [f64; 12] = [
        2.9724921176819326,
        0.005053236600059285,
        0.022444676592332326,
        9.969125675383563e-6,
        0.03533540460451222,
        0.0646645633850631,
        4.721996549501028e-09,
        2.728842810255374e-08,
        0.1155999905104079,
        0.042199972711571894,
        1.1283823413668629e-7,
        8.862244323928827e-8,
    ];
    let values = set
        .solutions
        .iter()
        .map(|solution| solution.variables.values());
    let values = values.map(|values| values.map(|z| z.re).collect::<Vec<f64>>());
    let positive: Vec<Vec<f64>> = values.filter(|v| v.iter().all(|x| *x > 0.0)).collect();
    assert_eq!(positive.len(), 1, "{positive:?}");
    for (value, expected) in std::iter::zip(&positive[0], concentrations) {
        assert!(
            (value - expected).abs() < 1e-7 * expected,
            "{value} for {expected}"
        );
    }
}

/// Three constants that are not rational leave the mixed cells as they are: 31 paths where the total degree has 140.
#[test]
fn irrational_constants_do_not_hide_the_monomials() {
    let text = "variable_group x, y; function f, g; f = x*y^3 - 2*x + cbrt(5); g = x*y^34 - cbrt(2)*y - Pi;";
    let set = answer(text, &SolveOptions::default());
    assert!(set.settled(), "{:?}", set.warnings);
    assert!(set.paths.total < 140, "{:?}", set.paths);
}

/// Registration of two sets of points (github janverschelde/PHCpack#72), as its author writes it down: 18 unknowns, of which
/// 3 are given by linear equations. The quadratic terms are constant on rotations and reflections, and a linear function
/// has 2^3 critical points there, all real (one for each choice of signs of three singular values).
#[test]
fn more_unknowns_than_the_exact_count_takes() {
    let quadratic = [[2, 0, 0], [0, 2, 1], [0, 1, 8]];
    let constant = [[2, 0, 0], [0, 2, 1], [0, 1, 2]];
    let multipliers = [
        ["2*a1", "a4", "a5"],
        ["a4", "2*a2", "a6"],
        ["a5", "a6", "2*a3"],
    ];
    let shifts = ["x", "y", "z"];
    let mut equations = vec![
        "6*m13 - 5*x".into(),
        "6*m23 - 5*y".into(),
        "6*m33 - 5*z - 1".into(),
    ];
    for i in 0..3 {
        for j in 0..3 {
            let mut terms: Vec<String> = Vec::new();
            for k in 0..3 {
                terms.push(format!("{}*m{}{}", quadratic[j][k], i + 1, k + 1));
                terms.push(format!("{}*m{}{}", multipliers[i][k], k + 1, j + 1));
            }
            let shift = if j == 2 { shifts[i] } else { "0" };
            equations.push(format!(
                "{} - 6*{shift} - {}",
                terms.join(" + "),
                constant[i][j]
            ));
            if j >= i {
                let product = (1..=3).map(|k| format!("m{}{k}*m{}{k}", i + 1, j + 1));
                let product: Vec<String> = product.collect();
                let unit = i32::from(i == j);
                equations.push(format!("{} - {unit}", product.join(" + ")));
            }
        }
    }
    let names: Vec<String> = (1..=equations.len()).map(|k| format!("f{k}")).collect();
    let definitions = names.iter().zip(&equations);
    let definitions: Vec<String> = definitions.map(|(f, e)| format!("{f} = {e};")).collect();
    let text = format!(
        "variable_group m11, m12, m13, m21, m22, m23, m31, m32, m33, x, y, z, a1, a2, a3, a4, a5, a6; function {}; {}",
        names.join(", "),
        definitions.join(" ")
    );
    let set = answer(&text, &SolveOptions::default());
    assert!(set.settled(), "{:?}", set.warnings);
    assert_eq!((set.counts.nonsingular, set.counts.distinct), (8, 8));
    assert_eq!(set.counts.real, Some(8));
}

/// Two pairs of solutions 1e-12 apart, by construction: (2x - y + 2)(2x - y + 2 + 1e-12) and (y - x^2)(line through x =
/// -2 and x = -2 + 1e-12). Typed as fractions their numbers are exact, and the pairs are pairs. If these numbers are
/// typed as decimals, or as the fraction that a program prints for a double, they are rounded: a pair is then no answer
/// that is settled.
#[test]
fn fractions_are_exact_and_long_decimals_are_rounded() {
    let settled = |text: &str| {
        let problem = formats::read("typed", text.as_bytes()).expect("two equations");
        let options = as_submitted(&problem, &SolveOptions::default());
        let set = solve(&problem.system, &options, &|_| None).1.remove(0);
        let counts = &set.counts;
        set.settled().then_some([
            counts.distinct,
            counts.nonsingular,
            counts.real.unwrap_or(0),
        ])
    };
    let lines = "x = -5\n4*x^2 - 4*x*y + y^2 + A*x - B*y + C = 0\n";
    let with = |[a, b, c]: [&str; 3]| lines.replace('A', a).replace('B', b).replace('C', c);
    let fractions = with([
        "4000000000001/500000000000",
        "4000000000001/1000000000000",
        "2000000000001/500000000000",
    ]);
    assert_eq!(settled(&fractions), Some([2, 2, 2]));
    let decimals = with(["8.000000000002", "4.000000000001", "4.000000000002"]);
    assert_eq!(settled(&decimals), None);
    let parabola = "y = x^2\ny + 3999999999999/1000000000000*x + 1999999999999/500000000000 = 0\n";
    assert_eq!(settled(parabola), Some([2, 2, 2]));
    // x^2 = 1/10 and x^2 = 0.1 as a double, beside each other.
    let doubles = "y = 1\n(x^2 - y/10)*(x^2 - 3602879701896397/36028797018963968) = 0\n";
    assert_eq!(settled(doubles), None);
    // More equations than unknowns: exactly there is no solution, and a double one within the digits.
    let more = "(x - 33333333333333/100000000000000)^2 = 0\n(y - x)^2 = 0\n3*x - 1 = 0\n";
    assert_eq!(settled(more), None);
}

/// (x - 1)^2, (2x - y + 3/2)^2 (2x - y + 5/3) (2x - y + 9) and (x - y + 5/2) (x - y + 8/3) hold at (1, 7/2), twice, and at
/// (1, 11/3), once. Of combinations both points are multiple; an exact count settles what paths leave undecided there.
#[test]
fn points_that_an_exact_count_settles_are_real_where_they_are() {
    let equations = "function f, g, h; f = (x - 1)^2; g = (2*x - y + 3/2)^2*(2*x - y + 5/3)*(2*x - y + 9); \
                     h = (x - y + 5/2)*(x - y + 8/3);";
    let system = format!("variable_group x, y; {equations}");
    for seed in (1..=5).chain([3_795_481_119]) {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            seed,
            ..SolveOptions::default()
        };
        let set = answer(&system, &options);
        let counts = &set.counts;
        let numbers = (counts.distinct, counts.with_multiplicity, counts.real);
        assert_eq!(numbers, (2, 3, Some(2)), "seed {seed}");
        assert!(set.settled(), "seed {seed}: {:?}", set.warnings);
    }
}
