//! Known multiplicities and dimensions, at exact points and at points that are a little off.

use super::*;
use crate::chart::Chart;
use crate::homotopies::HomotopyKind;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::polynomial::degrees;
use cognate_systems::system::System;

fn read(text: &str) -> System {
    let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
    match cognate_systems::formats::read("test", text.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}

/// Dimensions of the dual spaces at a point given by real values, moved by about `error`.
fn tower(system: &System, at: &[f64], bound: u64, error: f64, seed: u64) -> LocalDimension {
    let values: Vec<Complex64> = at.iter().map(|&x| Complex64::new(x, 0.0)).collect();
    tower_at(system, &values, bound, error, seed)
}

/// Dimensions of the dual spaces at a point given by complex values, moved by about `error`.
fn tower_at(
    system: &System,
    values: &[Complex64],
    bound: u64,
    error: f64,
    seed: u64,
) -> LocalDimension {
    let chart = Chart::new(system, seed, 0);
    let mut point = chart.from_variables(values).expect("a patch that meets it");
    let mut random = RandomStream::new(seed, Purpose::Test, 3);
    for z in &mut point {
        *z += random.disc() * error;
    }
    let kind = HomotopyKind::StraightLine {
        parameters: Vec::new(),
    };
    let degrees_of_equations = degrees(system).expect("polynomials");
    let asked = AskedSystem::new(system, &degrees_of_equations, &kind, chart, seed);
    let question = Question {
        accuracy: error.max(LEAST_ERROR),
        bound,
        depth: 30,
    };
    local_dimension(&asked, 0, &point, question, 0.0)
}

fn check(what: &str, system: &System, at: &[f64], bound: u64, expected: &[u32]) {
    for (seed, error) in [(1, 0.0), (2, 1e-12), (3, 1e-10), (4, 1e-9), (5, 1e-8)] {
        let dual_spaces = tower(system, at, bound, error, seed);
        assert_eq!(
            dual_spaces.dual_dimensions, expected,
            "{what} off by {error}: {dual_spaces:?}"
        );
        assert!(
            dual_spaces.margin > 3.0,
            "{what} off by {error}: {dual_spaces:?}"
        );
    }
}

#[test]
fn multiple_points_stop_at_their_multiplicity() {
    let power = read("variable_group x; function f; f = (x - 10)^6;");
    check("(x - 10)^6", &power, &[10.0], 6, &[1, 2, 3, 4, 5, 6, 6]);
    let griewank = read("variable_group x, y; function f, g; f = 29/16*x^3 - 2*x*y; g = y - x^2;");
    check("Griewank-Osborne", &griewank, &[0.0, 0.0], 3, &[1, 2, 3, 3]);
    // ojika-1 (Ojika 1987): a triple root at (1, 2), and a simple one at (-3, -6).
    let ojika = read("variable_group x, y; function f, g; f = x^2 + y - 3; g = x + y^2/8 - 3/2;");
    check("ojika-1", &ojika, &[1.0, 2.0], 3, &[1, 2, 3, 3]);
    // Four quadrics that begin with order 2: Hilbert function 1, 4, 6, 4, 1.
    let kss = read(
        "variable_group a, b, c, d, e; function f1, f2, f3, f4, f5; S = a + b + c + d + e; \
         f1 = a^2 + S - 2*a - 4; f2 = b^2 + S - 2*b - 4; f3 = c^2 + S - 2*c - 4; \
         f4 = d^2 + S - 2*d - 4; f5 = e^2 + S - 2*e - 4;",
    );
    let expected = [1, 5, 11, 15, 16, 16];
    check("kss-5", &kss, &[1.0; 5], 16, &expected);
    let regular = read("variable_group x, y; function f, g; f = x^2 - y; g = x*y - 1;");
    check("regular", &regular, &[1.0, 1.0], 1, &[1, 1]);
}

#[test]
fn on_curves_and_surfaces_the_dimension_outgrows_every_bound() {
    // The curve x = 0, y z = 1.
    let curve = read("variable_group x, y, z; function f, g, h; f = x*y; g = x*z; h = y*z - 1;");
    check("a curve", &curve, &[0.0, 2.0, 0.5], 1, &[1, 2, 3, 4]);
    // A double plane: x^2 twice, in three variables.
    let plane =
        read("variable_group x, y, z; function f, g, h; f = x^2; g = x^2*y; h = x^2 + x^3;");
    check(
        "a double plane",
        &plane,
        &[0.0, 0.3, -0.7],
        2,
        &[1, 4, 9, 16],
    );
    // Cyclic 4 on its curve (a, b, -a, -b) with a^2 b^2 = 1.
    let cyclic = cognate_systems::named::cyclic(4).system;
    check(
        "cyclic-4",
        &cyclic,
        &[2.0, 0.5, -2.0, -0.5],
        1,
        &[1, 2, 3, 4],
    );
    // Four of the curves' points are multiple in the scheme: (1, 1, -1, -1).
    let dual_spaces = tower(&cyclic, &[1.0, 1.0, -1.0, -1.0], 2, 1e-10, 3);
    assert!(
        dual_spaces.dual_dimensions.windows(2).all(|w| w[0] < w[1]),
        "{dual_spaces:?}"
    );
}

/// Two simple roots at distance 1e-7 are a double one to an accuracy of 1e-8, and two at distance 1e-15 to
/// doubles; Newton's method in double-doubles tells them apart.
#[test]
fn near_roots_are_told_apart() {
    let near = read("variable_group x; function f; f = x*(x - 1/10000000);");
    for error in [3e-9, 1e-13] {
        let dual_spaces = tower(&near, &[0.0], 1, error, 1);
        assert_eq!(dual_spaces.dual_dimensions, [1, 1], "off by {error}");
        assert!(dual_spaces.margin > 3.0, "{dual_spaces:?}");
    }
    let nearer = read("variable_group x; function f; f = (x - 1)*(x - 1 - 1/1000000000000000);");
    let dual_spaces = tower(&nearer, &[1.0], 2, 1e-13, 1);
    assert_eq!(dual_spaces.dual_dimensions, [1, 1], "{dual_spaces:?}");
}

/// The least residual on each slice, nearest last.
fn slices(system: &System, at: &[f64], error: f64, seed: u64) -> Vec<f64> {
    let dual_spaces = tower(system, at, u64::MAX, error, seed);
    dual_spaces
        .moved_slices
        .iter()
        .map(|slice| slice.residual)
        .collect()
}

/// Curves, a cusp, a double line and a double plane meet every slice; multiple points meet none, and the
/// residual falls with the distance to their order.
#[test]
fn moved_slices_meet_sets_and_no_isolated_point() {
    let curve = read("variable_group x, y, z; function f, g, h; f = x*y; g = x*z; h = y*z - 1;");
    let cusp = read("variable_group x, y; function f, g; f = y^2 - x^3; g = x*(y^2 - x^3);");
    let double =
        read("variable_group x, y; function f, g; f = (x + y - 1)^2; g = (x + y - 1)^2*(x - 3);");
    let triple = read("variable_group x, y; function f, g; f = (x + y - 1)^3; g = (x + y - 1)^4;");
    let crossing = read("variable_group x, y, z; function f, g, h; f = x*y; g = x*z; h = y*z;");
    let plane =
        read("variable_group x, y, z; function f, g, h; f = x^2; g = x^2*y; h = x^2 + x^3;");
    let cyclic = cognate_systems::named::cyclic(4).system;
    for (what, system, at) in [
        ("a curve", &curve, vec![0.0, 2.0, 0.5]),
        ("a cusp", &cusp, vec![0.0, 0.0]),
        ("a double line", &double, vec![0.3, 0.7]),
        ("a triple line", &triple, vec![0.3, 0.7]),
        ("three lines", &crossing, vec![0.0, 0.0, 0.0]),
        ("a double plane", &plane, vec![0.0, 0.3, -0.7]),
        ("cyclic-4", &cyclic, vec![2.0, 0.5, -2.0, -0.5]),
        (
            "cyclic-4, an embedded point",
            &cyclic,
            vec![1.0, 1.0, -1.0, -1.0],
        ),
    ] {
        for (seed, error) in [(1, 0.0), (2, 1e-10), (3, 1e-6)] {
            let residuals = slices(system, &at, error, seed);
            assert!(
                residuals.len() > 2 && residuals[1..].iter().all(|&r| r < 1e-20),
                "{what}: {residuals:?}"
            );
        }
    }
    let power = read("variable_group x; function f; f = (x - 10)^6;");
    let kss = read(
        "variable_group a, b, c, d, e; function f1, f2, f3, f4, f5; S = a + b + c + d + e; \
         f1 = a^2 + S - 2*a - 4; f2 = b^2 + S - 2*b - 4; f3 = c^2 + S - 2*c - 4; \
         f4 = d^2 + S - 2*d - 4; f5 = e^2 + S - 2*e - 4;",
    );
    let griewank = read("variable_group x, y; function f, g; f = 29/16*x^3 - 2*x*y; g = y - x^2;");
    for (what, system, at) in [
        ("(x - 10)^6", &power, vec![10.0]),
        ("Griewank-Osborne", &griewank, vec![0.0, 0.0]),
        ("kss-5", &kss, vec![1.0; 5]),
    ] {
        for (seed, error) in [(1, 0.0), (2, 1e-10), (3, 1e-6)] {
            let residuals = slices(system, &at, error, seed);
            assert!(
                residuals.len() > 1 && residuals[..2].iter().all(|&r| r > 1e-20),
                "{what}: {residuals:?}"
            );
            assert!(
                residuals.windows(2).all(|w| w[1] < 0.1 * w[0]),
                "{what}: {residuals:?}"
            );
        }
    }
}

/// Planes that touch a curve of degree 6 at x, y and z (`tritangents` of the tests of HomotopyContinuation.jl, other
/// coefficients): a quadric and a cubic through each point, and a plane that contains the tangent there.
fn tritangents() -> System {
    let mut exponents = Vec::new();
    for i in 0..4u32 {
        for j in 0..4 - i {
            exponents.extend((0..4 - i - j).map(|k| [i, j, k]));
        }
    }
    let term = |factor: i32, exponents: [u32; 3], name: char| {
        let powers = (1..).zip(exponents).map(|(k, e)| format!("{name}{k}^{e}"));
        let powers: Vec<String> = powers.collect();
        format!("({factor})*{}", powers.join("*"))
    };
    let cubic = |name: char| {
        let terms = CUBIC
            .iter()
            .zip(&exponents)
            .map(|(c, e)| term(*c, *e, name));
        terms.collect::<Vec<_>>().join("+")
    };
    let derivative = |name: char, v: usize| {
        let moving = CUBIC.iter().zip(&exponents).filter(|(_, e)| e[v] > 0);
        let terms = moving.map(|(c, e)| {
            let mut lower = *e;
            lower[v] -= 1;
            term(c * e[v] as i32, lower, name)
        });
        format!("({})", terms.collect::<Vec<_>>().join("+"))
    };
    let at_point = |(k, p): (usize, char)| {
        let [a, b, c] = [0, 1, 2].map(|v| derivative(p, v));
        format!(
            "f{k}1 = h1*{p}1 + h2*{p}2 + h3*{p}3 - 1; f{k}2 = {p}3 - {p}1*{p}2; f{k}3 = {cubic}; \
             f{k}4 = h1*(-{p}1*{c} - {b}) - h2*(-{p}2*{c} - {a}) + h3*(-{p}2*{b} + {p}1*{a});",
            cubic = cubic(p)
        )
    };
    let equations: Vec<String> = "xyz".chars().enumerate().map(at_point).collect();
    read(&format!(
        "variable_group h1, h2, h3, x1, x2, x3, y1, y2, y3, z1, z2, z3; \
         function f01, f02, f03, f04, f11, f12, f13, f14, f21, f22, f23, f24; {}",
        equations.concat()
    ))
}

/// The cubic's coefficients, by exponents in ascending order.
const CUBIC: [i32; 20] = [
    -535, -241, 971, -231, -741, -604, 444, -910, -825, -719, -493, 662, 38, -571, -179, 315, -937,
    -59, -1, -71,
];

/// Ends of three paths each on the curve of planes that touch twice, where those that touch in three points branch off
/// tangent to its null space: two directions on slices with one normal lead to that branch, where no solution is.
const ENDS: [[(f64, f64); 12]; 4] = [
    [
        (-0.08005914005143615, -7.750007627745088e-05),
        (1.9849153297053796, 0.002760795271637679),
        (0.04201753078849977, 0.0005746930882848425),
        (-7.519367303337622, -3.2138089506172944),
        (0.249311250103353, -0.13395985089767157),
        (-2.3051842302196834, 0.20605459572819626),
        (-7.484807260780728, 2.1310271132428515),
        (0.244690195123126, 0.08896216797403342),
        (-2.0210397411049645, -0.14442324063477244),
        (-7.484807260780729, 2.131027113242852),
        (0.24469019512312612, 0.08896216797403339),
        (-2.0210397411049645, -0.14442324063477224),
    ],
    [
        (-0.09418924432842048, -0.023143664249464485),
        (-0.31730352287768376, 0.5500367751146675),
        (-0.04503590738266887, -0.050046925551702266),
        (-1.1383413888855098, -1.1008104895425743),
        (-0.7117870105690721, -1.050409797676335),
        (-0.34604550939854567, 1.9792675555404071),
        (-12.043256900322795, 5.022548714889052),
        (0.05590435705730489, 0.29919005138723775),
        (-2.1759671419910425, -3.322440294182417),
        (-1.138341388885536, -1.100810489542595),
        (-0.7117870105690708, -1.0504097976763294),
        (-0.34604550939854467, 1.9792675555404415),
    ],
    [
        (-0.2268777415020159, -0.21527331611417264),
        (-0.2311884329930082, 1.1584396605600658),
        (0.37734721234964225, -0.13880816358215864),
        (-55.47925463627889, 7.657607727636071),
        (0.26959263722869975, 0.6652328423073209),
        (-20.050890722806542, -34.84218758862617),
        (0.4795266018462683, -0.21210779207254493),
        (-0.03516993199199464, -1.138177548134963),
        (-0.2582812446967317, -0.5383265953326982),
        (0.4795266018462688, -0.21210779207254263),
        (-0.03516993199199311, -1.138177548134962),
        (-0.2582812446967278, -0.5383265953326991),
    ],
    [
        (-0.1687851351940809, -0.04340324356386729),
        (-0.21122965404432856, 1.1550559666293416),
        (0.49425366996916587, -0.1939546400004405),
        (1.6575435603237916, -2.3355784436083806),
        (2.501011371968406, 3.0967249714468386),
        (11.378179382997804, -0.7083517130732332),
        (0.3296483997431365, -0.15717611719696503),
        (-0.09299839740685781, -1.0411477993111122),
        (-0.1943003414077321, -0.32859557892904573),
        (0.3296483997431363, -0.1571761171969619),
        (-0.09299839740685642, -1.04114779931111),
        (-0.194300341407728, -0.32859557892904573),
    ],
];

#[test]
fn a_curve_is_met_where_another_branch_leaves_it() {
    let system = tritangents();
    for end in ENDS {
        let values: Vec<Complex64> = end.iter().map(|&(re, im)| Complex64::new(re, im)).collect();
        let dual_spaces = tower_at(&system, &values, 3, 1e-13, 1);
        assert!(
            moved_slice::meets(&dual_spaces.moved_slices),
            "{dual_spaces:?}"
        );
    }
}

/// An end of [`tritangents`] where the errors of coefficients of order 3 are as large as the coefficients.
const NOISY_END: [(f64, f64); 12] = [
    (-0.11274460112189666, -0.1183110517011072),
    (0.6471802058524725, 1.4979145553977704),
    (-0.22207900537736738, -0.2397302024124468),
    (-16.390750024340008, -53.03589627441434),
    (-0.49579188984728967, -0.07257498623581672),
    (4.277321488462364, 27.484325701047673),
    (1.5395307388298554, 1.7473875229657665),
    (0.9141213805378159, -0.41151802630754003),
    (2.126399429004836, 0.9637796437449457),
    (1.5395307388299526, 1.7473875229657352),
    (0.9141213805378556, -0.4115180263075657),
    (2.126399429005017, 0.9637796437449074),
];

/// Not more functionals are told than there are derivatives in the two variables of the null space.
#[test]
fn what_errors_hide_is_not_told() {
    let values = NOISY_END.map(|(re, im)| Complex64::new(re, im));
    let dual_spaces = tower_at(&tritangents(), &values, 3, 1e-13, 1);
    assert!(dual_spaces.dual_dimensions.len() > 2, "{dual_spaces:?}");
    for (order, &dimension) in (0..).zip(&dual_spaces.dual_dimensions) {
        let most = Monomials::count_of(2, order) as u32;
        assert!(dimension <= most, "{dual_spaces:?}");
    }
}

/// kss-6 has a point of multiplicity 42 (Dayton and Zeng 2005): more functionals than a matrix of all
/// monomials could find in a second. Its tower was computed modulo 2^31 - 1.
#[test]
fn a_point_of_multiplicity_42() {
    let kss = cognate_systems::named::kss(6).system;
    for (seed, error) in [(1, 0.0), (2, 1e-10), (3, 1e-8)] {
        let dual_spaces = tower(&kss, &[1.0; 6], 42, error, seed);
        let expected = [1, 6, 16, 26, 36, 41, 42, 42];
        // Next to the point noise may hide a rank; then the margin says that it is not clear.
        let unclear = error > 0.0 && dual_spaces.margin < 3.0;
        assert!(
            unclear || (dual_spaces.dual_dimensions == expected && dual_spaces.margin > 3.0),
            "off by {error}: {dual_spaces:?}"
        );
    }
}
