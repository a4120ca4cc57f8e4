//! Planted fractions: systems of rational equations whose numerators and denominators have common zeros.
//!
//! In coordinates u, a unimodular image of the unknowns, the k-th equation is a polynomial in u_k alone, times powers of
//! factors and over powers of them, and perhaps times a factor that all equations have and that is no denominator. So
//! the solutions are the points of a grid at which no denominator is 0, and the zeros of the common factor.

use super::{Planted, Root};
use crate::dice::Dice;
use cognate_numeric::rational::ComplexRational;
use std::fmt::Write;

/// A point with whole real and imaginary parts.
type Whole = (i64, i64);

/// A polynomial that may be a denominator.
enum Factor {
    /// Coefficients of u, and a constant.
    Linear(Vec<i64>, i64),
    /// (u_k - c)^2 + d^2.
    Pair(usize, i64, i64),
}

/// A root of the polynomial in one coordinate, with its multiplicity.
type CoordinateRoot = (Whole, u64);

/// Parts of a planted system of fractions.
struct Plan {
    /// Each coordinate in the unknowns before it and its own, and a constant.
    coordinates: Vec<(Vec<i64>, i64)>,
    roots: Vec<Vec<CoordinateRoot>>,
    denominators: Vec<Factor>,
    /// A factor of all equations.
    set: Option<Factor>,
}

fn between(dice: &mut Dice, low: i64, high: i64) -> i64 {
    low + dice.below((high - low + 1) as u64) as i64
}

fn times(a: Whole, b: Whole) -> Whole {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

impl Factor {
    fn value(&self, u: &[Whole]) -> Whole {
        match self {
            Self::Linear(coefficients, constant) => {
                let terms = coefficients.iter().zip(u);
                terms.fold((*constant, 0), |sum, (&c, z)| {
                    (sum.0 + c * z.0, sum.1 + c * z.1)
                })
            }
            Self::Pair(k, c, d) => {
                let z = (u[*k].0 - c, u[*k].1);
                let square = times(z, z);
                (square.0 + d * d, square.1)
            }
        }
    }

    fn text(&self, names: &[String]) -> String {
        match self {
            Self::Linear(coefficients, constant) => {
                let mut text = constant.to_string();
                for (c, name) in coefficients.iter().zip(names) {
                    if *c != 0 {
                        write!(text, " + ({c})*{name}").expect("text");
                    }
                }
                format!("({text})")
            }
            Self::Pair(k, c, d) => format!("(({} - ({c}))^2 + {})", names[*k], d * d),
        }
    }
}

impl Plan {
    fn new(dice: &mut Dice) -> Self {
        let n = [1, 2, 2, 2, 3][dice.below(5) as usize];
        let coordinates = (0..n)
            .map(|k| {
                let mut row: Vec<i64> = (0..k).map(|_| between(dice, -1, 1)).collect();
                row.push(1);
                (row, between(dice, -2, 2))
            })
            .collect();
        let most = if n == 3 { 2 } else { 3 };
        let roots: Vec<Vec<CoordinateRoot>> = (0..n).map(|_| roots(dice, most)).collect();
        let count = if n == 3 { 1 } else { 1 + dice.below(2) };
        let denominators: Vec<Factor> = (0..count).map(|_| factor(dice, &roots)).collect();
        let set = (n > 1 && dice.below(4) == 0).then(|| {
            // No multiple of a denominator: their coefficients are smaller.
            let coefficients = (0..n).map(|k| if k == 0 { 7 } else { between(dice, 1, 3) });
            Factor::Linear(coefficients.collect(), between(dice, -3, 3))
        });
        Self {
            coordinates,
            roots,
            denominators,
            set,
        }
    }

    /// The points of the grid at which no factor is 0, with multiplicities, in u.
    fn points(&self) -> Vec<(Vec<Whole>, u64)> {
        let mut points: Vec<(Vec<Whole>, u64)> = vec![(Vec::new(), 1)];
        for roots in &self.roots {
            let longer = points.iter().flat_map(|(point, multiplicity)| {
                roots.iter().map(move |(root, m)| {
                    let mut point = point.clone();
                    point.push(*root);
                    (point, multiplicity * m)
                })
            });
            points = longer.collect();
        }
        let factors = || self.denominators.iter().chain(&self.set);
        points.retain(|(u, _)| factors().all(|factor| factor.value(u) != (0, 0)));
        points
    }

    /// The unknowns at a point.
    fn unknowns(&self, u: &[Whole]) -> Vec<ComplexRational> {
        let mut x: Vec<Whole> = Vec::new();
        for ((row, constant), z) in self.coordinates.iter().zip(u) {
            let mut value = (z.0 - constant, z.1);
            for (c, x) in row.iter().zip(&x) {
                value = (value.0 - c * x.0, value.1 - c * x.1);
            }
            x.push(value);
        }
        let exact = x.iter().map(|z| ComplexRational::new(z.0, z.1));
        exact.collect()
    }

    fn equations(&self, dice: &mut Dice, variables: &[String]) -> Vec<String> {
        let n = variables.len();
        let names: Vec<String> = self
            .coordinates
            .iter()
            .map(|(row, constant)| {
                let linear = Factor::Linear(row.clone(), *constant);
                linear.text(variables)
            })
            .collect();
        let most = if n == 3 { 2 } else { 3 };
        let mut powers: Vec<Vec<[u64; 2]>> = (0..n)
            .map(|_| {
                let each = self.denominators.iter();
                each.map(|_| [dice.below(most), dice.below(most)]).collect()
            })
            .collect();
        for (f, _) in self.denominators.iter().enumerate() {
            if powers.iter().all(|factor_powers| factor_powers[f][1] == 0) {
                let k = dice.below(n as u64) as usize;
                powers[k][f][1] = 1;
            }
        }
        let fractions: Vec<String> = (0..n)
            .map(|k| {
                let mut text = polynomial(&self.roots[k], &names[k]);
                if let Some(set) = &self.set {
                    write!(text, "*{}", set.text(&names)).expect("text");
                }
                for (factor, &[above, below]) in self.denominators.iter().zip(&powers[k]) {
                    let factor = factor.text(&names);
                    if above > 0 {
                        write!(text, "*{factor}^{above}").expect("text");
                    }
                    match (below, dice.below(2)) {
                        (0, _) => {}
                        (1, 0) => write!(text, "/{factor}").expect("text"),
                        (_, 0) => write!(text, "*{factor}^(-{below})").expect("text"),
                        _ => write!(text, "/({factor}^{below})").expect("text"),
                    }
                }
                text
            })
            .collect();
        (0..n)
            .map(|i| {
                let mut text = fractions[i].clone();
                for other in &fractions[..i] {
                    let c = [0, 0, 1, -2][dice.below(4) as usize];
                    if c != 0 && n < 3 {
                        write!(text, " + ({c})*{other}").expect("text");
                    }
                }
                text
            })
            .collect()
    }
}

/// Roots of a real polynomial in one coordinate.
fn roots(dice: &mut Dice, most: u64) -> Vec<CoordinateRoot> {
    let mut roots: Vec<CoordinateRoot> = Vec::new();
    if most > 2 && dice.below(4) == 0 {
        let (c, d) = (between(dice, -2, 2), between(dice, 1, 2));
        roots.extend([((c, d), 1), ((c, -d), 1)]);
    }
    for _ in 0..1 + dice.below(most - 1) {
        let root = (between(dice, -4, 4), 0);
        if roots.iter().all(|(other, _)| *other != root) {
            let multiplicity = if dice.below(5) == 0 { 2 } else { 1 };
            roots.push((root, multiplicity));
        }
    }
    roots
}

/// A denominator: 0 where one coordinate has a root, or at one point of the grid and elsewhere, or at none.
fn factor(dice: &mut Dice, roots: &[Vec<CoordinateRoot>]) -> Factor {
    let k = dice.below(roots.len() as u64) as usize;
    let (root, _) = roots[k][dice.below(roots[k].len() as u64) as usize];
    let through = dice.below(3);
    if root.1 != 0 {
        return Factor::Pair(k, root.0, root.1);
    }
    let mut coefficients = vec![0; roots.len()];
    coefficients[k] = 1;
    if through == 0 {
        return Factor::Linear(coefficients, -root.0);
    }
    let mut sum = 0;
    for (j, coordinate_roots) in roots.iter().enumerate() {
        coefficients[j] = [-2, -1, 1, 2][dice.below(4) as usize];
        let real = coordinate_roots.iter().find(|(root, _)| root.1 == 0);
        sum += coefficients[j] * real.map_or(1, |(root, _)| root.0);
    }
    let beside = if through == 1 { 0 } else { between(dice, 0, 1) };
    Factor::Linear(coefficients, beside - sum)
}

fn polynomial(roots: &[CoordinateRoot], name: &str) -> String {
    let factors = roots
        .iter()
        .filter(|((_, im), _)| *im >= 0)
        .map(|&((re, im), m)| match (im, m) {
            (0, 1) => format!("({name} - ({re}))"),
            (0, m) => format!("({name} - ({re}))^{m}"),
            (d, _) => format!("(({name} - ({re}))^2 + {})", d * d),
        });
    factors.collect::<Vec<_>>().join("*")
}

/// The system with this number among those of a seed.
pub fn fractions(seed: u64, number: u64) -> Planted {
    let dice = &mut Dice(seed ^ number.rotate_left(20) ^ 0xf2ac);
    let plan = Plan::new(dice);
    let variables: Vec<String> = ["x", "y", "z"][..plan.coordinates.len()]
        .iter()
        .map(|name| (*name).to_string())
        .collect();
    let roots = plan.points().into_iter().map(|(u, multiplicity)| Root {
        point: plan.unknowns(&u),
        multiplicity,
    });
    Planted {
        kind: "fractions",
        equations: plan.equations(dice, &variables),
        roots: roots.collect(),
        on_a_set: plan.set.is_some(),
        square: true,
        variables,
    }
}
