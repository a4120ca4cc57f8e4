//! Cusps of the critical values of an arm: where the direction in which the point stands still is along the singular curve
//! (H. Whitney 1955).
//!
//! Equations: J k = 0 and grad D . k = 0 for the matrix J of the map, its determinant D and a direction k. They are solved by paths
//! in this process. Where both joints turn, a search of their torus by bounds counts the real solutions without a gap, also where
//! paths end on sets of complex solutions; where every path is accounted for, they must not have more. A regular solution is a simple cusp: at a degenerate
//! one these equations are singular.

use super::contracted_lines::ContractedLines;
use super::equations::{joints, of_joints, real_solutions};
use super::joint_polynomial::JointPolynomial;
use super::plane_map::PlaneMap;
use super::torus_roots::{Bounded, torus_roots};
use cognate_kinematics::mechanism::exact::Angle;
use num_complex::Complex64;

/// The directions k = `BASE` + t `ACROSS`: all but one, which is that of no arm but by chance.
const BASE: [f64; 2] = [0.8253127, 0.5646787];
const ACROSS: [f64; 2] = [-0.5646787, 0.8253127];
/// Values of the determinant below this part of its coefficients are 0 at a cusp.
const SINGULAR: f64 = 1e-8;
/// Values of the determinant below this part of its coefficients are 0 at a crossing.
const CROSSING: f64 = 1e-12;
/// Squares of distances from the first axis below this part of the arm's size are 0.
const ON_FIRST_AXIS: f64 = 1e-10;
/// Distance from a place in doubt within which its crossing must be, in radians.
const NEAR: f64 = 3e-2;
/// Second derivatives have a determinant above this part of the coefficients' square at a simple crossing.
const SIMPLE: f64 = 1e-6;
/// Steps of Newton's method at most.
const STEPS: usize = 30;

/// A simple cusp.
#[derive(Clone, Debug, PartialEq)]
pub struct Cusp {
    /// Cosines and sines of the second and third joint; 0 and the value of a shift.
    pub joints: [f64; 4],
    /// Distance from the first axis and height along it; where the first joint shifts, the coordinates across it.
    pub place: [f64; 2],
}

/// The cusps of an arm.
#[derive(Debug, Default)]
pub struct Cusps {
    /// The simple ones.
    pub cusps: Vec<Cusp>,
    /// Places where the singular curve crosses itself, or where a point of it is alone: there is no cusp.
    pub crossings: u64,
    /// Doubts about the cusps.
    pub doubts: Vec<String>,
}

/// The cusps of an arm.
pub fn cusps(map: &PlaneMap, lines: &ContractedLines, seed: u64) -> Result<Cusps, String> {
    let by_paths = by_paths(map, lines, seed);
    if map.turns != [true, true] {
        return by_paths;
    }
    let mut answer = on_torus(map, lines)?;
    let number = |cusps: &Cusps| cusps.cusps.len();
    if let Ok(by_paths) = &by_paths
        && by_paths.doubts.is_empty()
        && number(by_paths) > number(&answer)
    {
        answer.doubts.push(format!(
            "the paths have {} real cusps, the search of the torus {}",
            number(by_paths),
            number(&answer)
        ));
    }
    Ok(answer)
}

/// The cusps by a search of the torus.
fn on_torus(map: &PlaneMap, lines: &ContractedLines) -> Result<Cusps, String> {
    let rest = &lines.rest;
    let gradient = [rest.derivative(0), rest.derivative(1)];
    // grad D . k with k across the gradient of a coordinate.
    let tangent = map.jacobian.each_ref().map(|[a, b]| {
        let along = gradient[1].times(a).minus(&gradient[0].times(b));
        Bounded::of(&along)
    });
    let choice = |at: &[f64; 4]| {
        let [first, second] = map.jacobian.each_ref().map(|row| {
            let [a, b] = row.each_ref().map(|f| f.value(at));
            a * a + b * b
        });
        usize::from(second > first)
    };
    let roots = torus_roots(&Bounded::of(rest), &tangent, &choice);
    let Some(roots) = roots else {
        return Err("the conditions of a cusp hold along a curve".into());
    };
    let mut answer = Cusps::default();
    for values in roots.simple {
        answer.take_simple(map, map.place(values));
    }
    for values in roots.doubtful {
        answer.take_doubtful(map, rest, map.place(values));
    }
    Ok(answer)
}

/// The cusps by paths.
fn by_paths(map: &PlaneMap, lines: &ContractedLines, seed: u64) -> Result<Cusps, String> {
    let rest = &lines.rest;
    let gradient = [rest.derivative(0), rest.derivative(1)];
    let [first, second] = [0, 1].map(|k| format!("({}+({})*t)", BASE[k], ACROSS[k]));
    let along = |row: &[JointPolynomial; 2]| {
        format!(
            "{}*{first}+{}*{second}",
            row[0].expression(),
            row[1].expression()
        )
    };
    let rows = map.jacobian.iter().chain([&gradient]).map(along);
    let mut equations = of_joints(map.turns, rows.collect());
    equations.groups.push(vec!["t".into()]);
    let real = real_solutions(&equations, "the cusps", seed)?;
    let mut answer = Cusps::default();
    answer.doubts.extend(real.doubt);
    let size = rest.bound();
    for solution in &real.solutions {
        let at = joints(map.turns, &solution.values);
        if solution.is_singular {
            answer.take_doubtful(map, rest, at);
        } else if rest.value(&at).abs() < SINGULAR * size {
            answer.take_simple(map, at);
        }
    }
    Ok(answer)
}

impl Cusps {
    fn take_simple(&mut self, map: &PlaneMap, joints: [f64; 4]) {
        let value = map.value(&joints);
        if map.first_turns && value[0] - value[1] * value[1] < ON_FIRST_AXIS {
            self.doubts.push("a cusp lies on the first axis".into());
            return;
        }
        let place = map.shown(value);
        self.cusps.push(Cusp { joints, place });
    }

    /// A place that is no simple cusp: a crossing, or a doubt.
    fn take_doubtful(&mut self, map: &PlaneMap, rest: &JointPolynomial, joints: [f64; 4]) {
        match is_crossing(map, rest, joints) {
            true => self.crossings += 1,
            false => self.doubts.push(
                "a place of the singular curve is degenerate: whether cusps meet there is not clear".into(),
            ),
        }
    }
}

/// Whether the curve of a polynomial's zeros crosses itself simply, or has a point that is alone, next to a place.
fn is_crossing(map: &PlaneMap, f: &JointPolynomial, joints: [f64; 4]) -> bool {
    let gradient = [f.derivative(0), f.derivative(1)];
    let second: [[JointPolynomial; 2]; 2] = gradient
        .each_ref()
        .map(|g| [g.derivative(0), g.derivative(1)]);
    let value = |k: usize| match map.turns[k] {
        true => Angle::of_direction(Complex64::new(joints[2 * k], joints[2 * k + 1])).radians,
        false => joints[2 * k + 1],
    };
    let begin = [value(0), value(1)];
    let mut values = begin;
    let mut determinant = 0.0;
    for _ in 0..STEPS {
        let at = map.place(values);
        let [a, b] = gradient.each_ref().map(|g| g.value(&at));
        let [[aa, ab], [_, bb]] = second
            .each_ref()
            .map(|row| row.each_ref().map(|h| h.value(&at)));
        determinant = aa * bb - ab * ab;
        if determinant == 0.0 {
            return false;
        }
        values[0] -= (a * bb - b * ab) / determinant;
        values[1] -= (b * aa - a * ab) / determinant;
    }
    let size = f.bound();
    let is_near = (0..2).all(|k| (values[k] - begin[k]).abs() < NEAR);
    is_near
        && f.value(&map.place(values)).abs() < CROSSING * size
        && determinant.abs() > SIMPLE * size * size
}
