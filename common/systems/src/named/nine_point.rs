//! Nine-point path synthesis: four-bar linkages whose coupler point passes nine given points.

use super::Named;
use crate::expression::{Expressions, NodeId};
use crate::system::{DegenerateSet, SymmetryGenerator, System, VariableGroup};
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// Solutions in the variables of [`nine_point`] for generic points: 1442 coupler curves, each of
/// three cognate linkages (Roberts), each written down in two ways.
pub const NINE_POINT_SOLUTIONS: u64 = 8652;

/// Kappa and the other coefficients of one dyad in alpha gamma + beta Gamma + kappa = 0.
struct Dyad {
    alpha: NodeId,
    beta: NodeId,
    kappa: NodeId,
}

/// The dyad (x, a) moved by (d, D): n = a X, N = A x, u = x - a, U = X - A.
#[derive(Clone, Copy)]
struct Arm {
    x: NodeId,
    xx: NodeId,
    n: NodeId,
    nn: NodeId,
    u: NodeId,
    uu: NodeId,
}

impl Arm {
    fn new(e: &mut Expressions, x: NodeId, xx: NodeId, a: NodeId, aa: NodeId) -> Self {
        Self {
            x,
            xx,
            n: e.multiply(a, xx),
            nn: e.multiply(aa, x),
            u: e.subtract(x, a),
            uu: e.subtract(xx, aa),
        }
    }

    fn dyad(self, e: &mut Expressions, d: NodeId, dd: NodeId) -> Dyad {
        let p = e.multiply(dd, self.x);
        let alpha = e.subtract(p, self.nn);
        let p = e.multiply(d, self.xx);
        let beta = e.subtract(p, self.n);
        let (p, q) = (e.multiply(dd, self.u), e.multiply(d, self.uu));
        let (p, ddd) = (e.add(p, q), e.multiply(d, dd));
        let kappa = e.add(p, ddd);
        Dyad { alpha, beta, kappa }
    }
}

/// The problem in isotropic coordinates, with the first point at the origin: 8 equations of
/// degree 7 in x, X, a, A, y, Y, b, B; parameters d_j, D_j, the other eight points.
///
/// a and b are the fixed pivots, x and y the vectors from the coupler point to the moving joints
/// in the first position; capitals are the conjugates of a real linkage. The group has 6
/// elements: the two dyads exchanged, and Roberts' cognates. Solutions with some `K` equal to 0
/// are no linkages. Roth and Freudenstein 1963; Wampler, Morgan, Sommese, Complete solution of
/// the nine-point path synthesis problem for four-bar linkages, 1992.
pub fn nine_point() -> Named {
    let mut e = Expressions::new();
    let v: Vec<NodeId> = (0..8).map(|i| e.variable(i)).collect();
    let [x, xx, a, aa, y, yy, b, bb] = v[..] else {
        unreachable!("eight variables")
    };
    let one = Arm::new(&mut e, x, xx, a, aa);
    let two = Arm::new(&mut e, y, yy, b, bb);
    let mut equations = Vec::new();
    let mut degenerate = std::collections::BTreeMap::new();
    for j in 0..8 {
        let (d, dd) = (e.parameter(2 * j), e.parameter(2 * j + 1));
        let (one, two) = (one.dyad(&mut e, d, dd), two.dyad(&mut e, d, dd));
        let mut determinant = |p: NodeId, q: NodeId, r: NodeId, s: NodeId| {
            let (pq, rs) = (e.multiply(p, q), e.multiply(r, s));
            e.subtract(pq, rs)
        };
        let g = determinant(one.beta, two.kappa, two.beta, one.kappa);
        let h = determinant(two.alpha, one.kappa, one.alpha, two.kappa);
        let k = determinant(one.alpha, two.beta, two.alpha, one.beta);
        let (gh, sum) = (e.multiply(g, h), e.add(g, h));
        let rest = e.multiply(sum, k);
        equations.push(e.add(gh, rest));
        degenerate.insert(format!("K{}", j + 1), DegenerateSet::Nonzero(k));
    }
    // Roberts: C1 = [(a, a - x), (c, y (x - a)/(x - y))] with c = (b x - a y)/(x - y).
    let mut cognate = |x: NodeId, a: NodeId, y: NodeId, b: NodeId| {
        let (xy, ax, xa) = (e.subtract(x, y), e.subtract(a, x), e.subtract(x, a));
        let (bx, ay, yxa) = (e.multiply(b, x), e.multiply(a, y), e.multiply(y, xa));
        let bxay = e.subtract(bx, ay);
        [ax, a, e.divide(yxa, xy), e.divide(bxay, xy)]
    };
    let [p, q, r, s] = cognate(x, a, y, b);
    let [pp, qq, rr, ss] = cognate(xx, aa, yy, bb);
    let names = |letters: &[&str]| letters.iter().map(|&s| s.to_string()).collect();
    let system = System {
        expressions: e,
        variables: names(&["x", "X", "a", "A", "y", "Y", "b", "B"]),
        parameters: (1..=8)
            .flat_map(|j| [format!("d{j}"), format!("D{j}")])
            .collect(),
        groups: vec![VariableGroup {
            variables: (0..8).collect(),
            homogeneous: false,
        }],
        equations,
        equation_names: (1..=8).map(|j| format!("f{j}")).collect(),
        conjugates: vec![(0, 1), (2, 3), (4, 5), (6, 7)],
        degenerate,
        symmetry: vec![
            SymmetryGenerator::Permutation(vec![4, 5, 6, 7, 0, 1, 2, 3]),
            SymmetryGenerator::Map(vec![p, pp, q, qq, r, rr, s, ss]),
        ],
        ..System::default()
    };
    if let Err(error) = system.check() {
        panic!("a named system is a system: {error}");
    }
    Named {
        system,
        finite_solutions: None,
        with_multiplicity: None,
        source: "Roth, Freudenstein 1963; Wampler, Morgan, Sommese 1992",
    }
}

/// The nine-point problem before the rotations g_j = gamma_j, G_j of the coupler are eliminated: 24 equations of which
/// each has few unknowns, the first eight of them those of [`nine_point`].
pub fn nine_point_with_rotations() -> Named {
    let mut e = Expressions::new();
    let v: Vec<NodeId> = (0..24).map(|i| e.variable(i)).collect();
    let one = Arm::new(&mut e, v[0], v[1], v[2], v[3]);
    let two = Arm::new(&mut e, v[4], v[5], v[6], v[7]);
    let (mut equations, mut equation_names) = (Vec::new(), Vec::new());
    let mut variables: Vec<String> = ["x", "X", "a", "A", "y", "Y", "b", "B"]
        .map(String::from)
        .into();
    let mut parameters = Vec::new();
    for j in 0..8u32 {
        let (d, dd) = (e.parameter(2 * j), e.parameter(2 * j + 1));
        let (g, gg) = (v[8 + 2 * j as usize], v[9 + 2 * j as usize]);
        for arm in [one, two] {
            let dyad = arm.dyad(&mut e, d, dd);
            let (p, q) = (e.multiply(dyad.alpha, g), e.multiply(dyad.beta, gg));
            let sum = e.add(p, q);
            equations.push(e.add(sum, dyad.kappa));
        }
        // (1 + gamma)(1 + Gamma) = 1.
        let (p, q) = (e.multiply(g, gg), e.add(g, gg));
        equations.push(e.add(p, q));
        let j = j + 1;
        equation_names.extend([format!("one{j}"), format!("two{j}"), format!("turn{j}")]);
        variables.extend([format!("g{j}"), format!("G{j}")]);
        parameters.extend([format!("d{j}"), format!("D{j}")]);
    }
    let system = System {
        expressions: e,
        variables,
        parameters,
        groups: vec![VariableGroup {
            variables: (0..24).collect(),
            homogeneous: false,
        }],
        equations,
        equation_names,
        ..System::default()
    };
    if let Err(error) = system.check() {
        panic!("a named system is a system: {error}");
    }
    Named {
        system,
        finite_solutions: None,
        with_multiplicity: None,
        source: "Wampler, Morgan, Sommese 1992",
    }
}

/// The rotations gamma_1, Gamma_1, ... that belong to a solution of [`nine_point`].
pub fn rotations(variables: &[Complex64], parameters: &[Complex64]) -> Vec<Complex64> {
    let dyad = |v: &[Complex64], d: Complex64, dd: Complex64| {
        let (alpha, beta) = (dd * v[0] - v[3] * v[0], d * v[1] - v[2] * v[1]);
        (alpha, beta, dd * (v[0] - v[2]) + d * (v[1] - v[3]) + d * dd)
    };
    parameters
        .chunks_exact(2)
        .flat_map(|d| {
            let (alpha, beta, kappa) = dyad(&variables[..4], d[0], d[1]);
            let (alpha2, beta2, kappa2) = dyad(&variables[4..8], d[0], d[1]);
            let k = alpha * beta2 - alpha2 * beta;
            [
                (beta * kappa2 - beta2 * kappa) / k,
                (alpha2 * kappa - alpha * kappa2) / k,
            ]
        })
        .collect()
}

/// A linkage with nine points on its coupler curve: a solution of [`nine_point`] and its
/// parameters, in the system's orders.
#[derive(Clone, Debug, PartialEq)]
pub struct FourBar {
    /// x, X, a, A, y, Y, b, B.
    pub variables: Vec<Complex64>,
    /// d_1, D_1, ..., d_8, D_8.
    pub parameters: Vec<Complex64>,
}

/// A square root, without libm.
fn square_root(z: Complex64) -> Complex64 {
    let size = z.norm_sqr().sqrt();
    let large = ((size + z.re.abs()) / 2.0).sqrt();
    if large == 0.0 {
        return Complex64::new(0.0, 0.0);
    }
    let small = z.im.abs() / (2.0 * large);
    let (re, im) = if z.re >= 0.0 {
        (large, small)
    } else {
        (small, large)
    };
    Complex64::new(re, if z.im < 0.0 { -im } else { im })
}

/// A random complex linkage with nine of its positions: a generic start pair for monodromy.
///
/// The coupler turned by theta, the bars turn by lambda and mu with
/// `p + x theta = a + (x - a) lambda` and `p + y theta = b + (y - b) mu`, and the same with
/// capitals and the inverse rotations: two equations for lambda and mu, quadratic in lambda.
pub fn random_four_bar(seed: u64) -> FourBar {
    let mut random = RandomStream::new(seed, Purpose::StartSystem, 9);
    let variables: Vec<Complex64> = (0..8).map(|_| random.disc() * 1.5).collect();
    let [x, xx, a, aa, y, yy, b, bb] = variables[..] else {
        unreachable!("eight variables")
    };
    let mut parameters = Vec::with_capacity(16);
    while parameters.len() < 16 {
        let theta = random.unit() * (0.5 + random.uniform());
        let other = random.bits() & 1 == 1;
        let (u, uu, w, ww) = (x - a, xx - aa, y - b, yy - bb);
        // w mu = p + u lambda; ww/mu = q + uu/lambda.
        let p = a - b + (y - x) * theta;
        let q = aa - bb + (yy - xx) / theta;
        // (p + u lambda)(q lambda + uu) = w ww lambda.
        let (second, first, zeroth) = (u * q, p * q + u * uu - w * ww, p * uu);
        let root = square_root(first * first - second * zeroth * 4.0);
        let root = if other { -root } else { root };
        let lambda = (root - first) / (second * 2.0);
        let (d, dd) = (a + u * lambda - x * theta, aa + uu / lambda - xx / theta);
        // Positions far out are on the curve too, but make a badly scaled start.
        if [d, dd].iter().all(|z| z.norm_sqr() < 25.0) {
            parameters.extend([d, dd]);
        }
    }
    FourBar {
        variables,
        parameters,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::{Evaluate, Interpreter};
    use cognate_numeric::scalar::Complex;

    fn native(values: &[Complex64]) -> Vec<Complex<f64>> {
        let values = values.iter();
        values.map(|z| Complex { re: z.re, im: z.im }).collect()
    }

    /// Values of some nodes of the system.
    fn values(roots: &[NodeId], system: &System, four_bar: &FourBar) -> Vec<f64> {
        let program = Interpreter::compile(&system.expressions, roots, 8, 16);
        let mut scratch = Evaluate::<f64>::scratch(&program, ());
        let mut out = vec![Complex { re: 0.0, im: 0.0 }; roots.len()];
        let (x, p) = (native(&four_bar.variables), native(&four_bar.parameters));
        program.value(&x, &p, &mut out, &mut scratch);
        out.iter().map(|z| z.norm_sqr().sqrt()).collect()
    }

    #[test]
    fn a_linkage_solves_its_nine_points_and_not_others() {
        let Named { system, .. } = nine_point();
        for seed in 0..20 {
            let four_bar = random_four_bar(seed);
            let there = values(&system.equations, &system, &four_bar);
            let mut moved = four_bar.clone();
            moved.parameters[0] += 0.1;
            let elsewhere = values(&system.equations, &system, &moved);
            assert!(there.iter().all(|&f| f < 1e-8), "seed {seed}: {there:?}");
            assert!(there[0] < 1e-6 * elsewhere[0], "seed {seed}: {elsewhere:?}");
        }
    }

    #[test]
    fn square_roots_are_principal() {
        for (re, im) in [
            (4.0, 0.0),
            (-4.0, 1e-3),
            (-1.0, -2.0),
            (0.0, 3.0),
            (0.0, 0.0),
        ] {
            let z = Complex64::new(re, im);
            let root = square_root(z);
            assert!((root * root - z).norm_sqr() < 1e-28, "{z} {root}");
            assert!(root.re >= 0.0);
        }
    }
}
