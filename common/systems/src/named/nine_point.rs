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
    let (n, nn) = (e.multiply(a, xx), e.multiply(aa, x));
    let (m, mm) = (e.multiply(b, yy), e.multiply(bb, y));
    let [xa, xxaa, yb, yybb] = [(x, a), (xx, aa), (y, b), (yy, bb)].map(|(p, q)| e.subtract(p, q));
    let mut equations = Vec::new();
    let mut degenerate = std::collections::BTreeMap::new();
    for j in 0..8 {
        let (d, dd) = (e.parameter(2 * j), e.parameter(2 * j + 1));
        let ddd = e.multiply(d, dd);
        let mut dyad = |x: NodeId, xx: NodeId, n: NodeId, nn: NodeId, u: NodeId, uu: NodeId| {
            let p = e.multiply(dd, x);
            let alpha = e.subtract(p, nn);
            let p = e.multiply(d, xx);
            let beta = e.subtract(p, n);
            let (p, q) = (e.multiply(dd, u), e.multiply(d, uu));
            let p = e.add(p, q);
            let kappa = e.add(p, ddd);
            Dyad { alpha, beta, kappa }
        };
        let one = dyad(x, xx, n, nn, xa, xxaa);
        let two = dyad(y, yy, m, mm, yb, yybb);
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
