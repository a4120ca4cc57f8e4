//! Places on the torus of two turns where several polynomials in their cosines and sines are 0, without a gap: squares are left out
//! where bounds of a polynomial keep it from 0, and hold one place where Newton's method surely converges
//! (L. V. Kantorovich 1948).

use super::joint_polynomial::{JointPolynomial, place};
use std::f64::consts::TAU;

/// Halvings of the torus's sides before the first look at a square.
const COARSE: u32 = 5;
/// Halvings at most: squares of side 6e-6 radians are left in doubt.
const FINE: u32 = 20;
/// Squares at most, beyond which places form a curve.
const MOST_SQUARES: usize = 400_000;
/// Places nearer to each other than this are one, in radians.
const SAME: f64 = 1e-6;
/// Squares in doubt that are nearer to each other than this belong together, in radians.
const TOGETHER: f64 = 2e-2;
/// How far beyond a square Newton's method is asked, in sides.
const WIDER: f64 = 1.0;

/// A polynomial with its derivatives and a bound of the second ones.
pub struct Bounded {
    value: JointPolynomial,
    gradient: [JointPolynomial; 2],
    bend: f64,
    rounding: f64,
}

impl Bounded {
    /// The polynomial with its bounds.
    pub fn of(value: &JointPolynomial) -> Self {
        Self {
            gradient: [value.derivative(0), value.derivative(1)],
            bend: value.second_derivative_bound(),
            rounding: 1e-13 * value.bound(),
            value: value.clone(),
        }
    }

    /// Whether it is surely not 0 within this distance in either turn.
    fn is_not_zero(&self, at: &[f64; 4], half: f64) -> bool {
        let slope: f64 = self.gradient.iter().map(|g| g.value(at).abs()).sum();
        // The square of the distance to a corner is 2 half^2.
        let change = slope * half + self.bend * half * half;
        self.value.value(at).abs() > change + self.rounding
    }
}

/// Common zeros of polynomials on the torus of two turns.
pub struct TorusRoots {
    /// Places at which they are 0 together, each once, with regular derivatives; in radians.
    pub simple: Vec<[f64; 2]>,
    /// Places next to which it is in doubt.
    pub doubtful: Vec<[f64; 2]>,
}

/// Places where the first and one of the others are 0; all others must be, too. At each place of the two others that pair counts
/// which `choice` names. `None` where there are too many squares in doubt: the places form a curve.
pub fn torus_roots(
    first: &Bounded,
    others: &[Bounded; 2],
    choice: &dyn Fn(&[f64; 4]) -> usize,
) -> Option<TorusRoots> {
    let mut roots = TorusRoots {
        simple: Vec::new(),
        doubtful: Vec::new(),
    };
    let count = 1u32 << COARSE;
    let mut open: Vec<[u32; 3]> = Vec::new();
    for row in 0..count {
        open.extend((0..count).map(|column| [COARSE, column, row]));
    }
    let mut looked = 0;
    while let Some([level, column, row]) = open.pop() {
        looked += 1;
        if looked > MOST_SQUARES {
            return None;
        }
        let side = TAU / f64::from(1u32 << level);
        let centre = [column, row].map(|k| side * (f64::from(k) + 0.5));
        let at = place([true, true], centre);
        let half = 0.5 * side;
        if [first, &others[0], &others[1]]
            .iter()
            .any(|f| f.is_not_zero(&at, half))
        {
            continue;
        }
        match newton(first, &others[choice(&at)], centre, half) {
            Newton::One(root) => add(&mut roots.simple, root, SAME),
            Newton::None => {}
            Newton::Unclear if level < FINE => {
                let parts = [[0, 0], [1, 0], [0, 1], [1, 1]];
                open.extend(parts.map(|[a, b]| [level + 1, 2 * column + a, 2 * row + b]));
            }
            Newton::Unclear => add(&mut roots.doubtful, centre, TOGETHER),
        }
    }
    Some(roots)
}

/// Adds a place that none of the others is near to.
fn add(places: &mut Vec<[f64; 2]>, place: [f64; 2], near: f64) {
    let place = place.map(|x| x.rem_euclid(TAU));
    let is_near = |other: &[f64; 2]| {
        (0..2).all(|k| {
            let apart = (place[k] - other[k]).abs();
            apart.min(TAU - apart) < near
        })
    };
    if !places.iter().any(is_near) {
        places.push(place);
    }
}

/// Result of Newton's method for a square.
enum Newton {
    /// One place lies in the square or next to it.
    One([f64; 2]),
    /// No place lies in the square.
    None,
    /// Newton's method decides neither.
    Unclear,
}

fn newton(f: &Bounded, g: &Bounded, centre: [f64; 2], half: f64) -> Newton {
    let step = |values: [f64; 2]| {
        let at = place([true, true], values);
        let [a, b] = f.gradient.each_ref().map(|h| h.value(&at));
        let [c, d] = g.gradient.each_ref().map(|h| h.value(&at));
        let determinant = a * d - b * c;
        let (x, y) = (f.value.value(&at), g.value.value(&at));
        let inverse = [
            [d / determinant, -b / determinant],
            [-c / determinant, a / determinant],
        ];
        let step = inverse.map(|row| row[0] * x + row[1] * y);
        (inverse, step)
    };
    let (inverse, first) = step(centre);
    let radius = half * (1.0 + 2.0 * WIDER);
    // Derivatives change by at most bend * distance, in each of two directions; the distance is at most sqrt(2) radius.
    let changes = [f.bend, g.bend].map(|bend| bend * 2.0 * 2f64.sqrt() * radius);
    let contraction = inverse
        .map(|row| row[0].abs() * changes[0] + row[1].abs() * changes[1])
        .into_iter()
        .fold(0.0, f64::max);
    if !contraction.is_finite() || contraction > 0.5 {
        return Newton::Unclear;
    }
    let length = first[0].abs().max(first[1].abs());
    if length > (1.0 + contraction) * half * (1.0 + 1e-9) {
        return Newton::None;
    }
    if length + contraction * radius > radius {
        return Newton::Unclear;
    }
    let mut root = centre;
    for _ in 0..20 {
        let (_, by) = step(root);
        root = [root[0] - by[0], root[1] - by[1]];
    }
    Newton::One(root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::point_arm::joint_polynomial::Turns;

    const TURNS: Turns = [true, true];

    /// cos x = 1/2 and sin y = cos x have four places: x = 60 or 300 degrees, y = 30 or 150.
    #[test]
    fn common_zeros_are_counted_once() {
        let number = |x: f64| JointPolynomial::constant(TURNS, x);
        let c = JointPolynomial::cosine(TURNS, 0);
        let s = JointPolynomial::sine(TURNS, 1);
        let first = Bounded::of(&c.minus(&number(0.5)));
        let others = [0, 1].map(|_| Bounded::of(&s.minus(&c)));
        let roots = torus_roots(&first, &others, &|_| 0).expect("isolated places");
        assert!(roots.doubtful.is_empty());
        assert_eq!(roots.simple.len(), 4, "{:?}", roots.simple);
        // A double zero is in doubt: cos x = 1.
        let double = Bounded::of(&c.minus(&number(1.0)));
        let others = [0, 1].map(|_| Bounded::of(&s));
        let roots = torus_roots(&double, &others, &|_| 0).expect("isolated places");
        assert!(roots.simple.is_empty() && roots.doubtful.len() == 2);
        // One polynomial twice has a curve.
        let same = [0, 1].map(|_| Bounded::of(&c));
        assert!(torus_roots(&Bounded::of(&c), &same, &|_| 0).is_none());
    }
}
