//! Planar four-bars for more poses, pairs of angles or points than a linkage can meet: those that miss them least.
//!
//! [`dyads`] and [`angle_pairs`] solve for every stationary point of the summed squares, complex ones too, so that the
//! least one is known among all of them. [`path_points`] improves random linkages until they are local minima: how many
//! there are is not known, and a better one may exist.

pub mod angle_pairs;
mod coupler_sextic;
pub mod dyads;
mod least_squares;
pub mod path_points;
#[cfg(test)]
mod tests;

use crate::start_positions::{in_order, solve};
use cognate_algorithms::SolveOptions;
use cognate_kinematics::mechanism::exact::Number;
use cognate_kinematics::plane::{modulus, scale};
use cognate_solutions::critical::Kind;
use cognate_systems::formats;
use num_complex::Complex64;

/// How many stationary points there are, up to what gives the same linkage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stationary {
    /// Complex and real ones.
    pub complex: u64,
    /// The real ones.
    pub real: u64,
}

/// Stationary points of summed squares.
struct StationaryPoints {
    /// The real ones: values of the unknowns, in their order in the text.
    real: Vec<Vec<f64>>,
    /// Number of complex and real ones.
    complex: u64,
    /// Why the answer is not settled.
    doubts: Vec<String>,
}

/// Solves equations in the plain format, whose first line names the unknowns.
fn stationary_points(text: &str, seed: u64) -> Result<StationaryPoints, String> {
    let problem = formats::read("stationary points", text.as_bytes()).map_err(|e| e.to_string())?;
    let options = SolveOptions {
        seed,
        ..SolveOptions::default()
    };
    let sets = solve(&problem.system, &options, None)?;
    let set = sets.first().ok_or("no answer was made")?;
    let mut doubts = Vec::new();
    if !set.settled() {
        doubts.push("the number of stationary points is not settled".into());
        doubts.extend(set.warnings.iter().cloned());
    }
    if !set.on_positive_dimensional_sets.is_empty() {
        doubts.push(
            "stationary points form a curve: what is given is met in infinitely many ways".into(),
        );
    }
    let mut real = Vec::new();
    for solution in &set.solutions {
        match solution.real {
            Some(true) => {
                let values = in_order(solution, &problem.system);
                real.push(values.iter().map(|z| z.re).collect());
            }
            Some(false) => {}
            None => doubts.push("whether a stationary point is real is not known".into()),
        }
    }
    Ok(StationaryPoints {
        real,
        complex: set.counts.distinct,
        doubts,
    })
}

/// A double as an exact expression.
fn exact(x: f64) -> String {
    Number::of_double(x).expression()
}

/// Cosine and sine of a direction as exact expressions whose squares add up to 1: by the tangent of half the angle.
fn exact_direction(direction: Complex64) -> [String; 2] {
    // With the tangent or, beyond a quarter turn, the cotangent, which is not large either.
    let (near, far) = (1.0 + direction.re, 1.0 - direction.re);
    let is_near = near >= far;
    let t = exact(direction.im / if is_near { near } else { far });
    let sign = if is_near { "" } else { "-" };
    [
        format!("({sign}(1 - {t}^2)/(1 + {t}^2))"),
        format!("(2*{t}/(1 + {t}^2))"),
    ]
}

/// Lines that say that each of these sums of terms is 0.
fn vanishing_sums(sums: &[Vec<String>]) -> String {
    let line = |terms: &Vec<String>| format!("{} = 0\n", terms.join(" + "));
    sums.iter().map(line).collect()
}

/// Kind of a stationary point by the second derivatives there.
fn kind_of<const N: usize>(second_derivatives: &[[f64; N]; N]) -> Kind {
    let rows: Vec<Vec<f64>> = second_derivatives.iter().map(|row| row.to_vec()).collect();
    Kind::of_second_derivatives(&rows)
}

/// Minima first, each kind by its error.
fn sort_minima_first<T>(list: &mut [T], kind_and_error: impl Fn(&T) -> (Kind, f64)) {
    list.sort_by(|a, b| {
        let [(first, one), (second, other)] = [kind_and_error(a), kind_and_error(b)];
        let is_no_minimum = |kind: Kind| kind != Kind::Minimum;
        let order = is_no_minimum(first).cmp(&is_no_minimum(second));
        order.then(one.total_cmp(&other))
    });
}

/// Coordinates in which given points are about 0 and not far from it.
#[derive(Clone, Copy, Debug)]
struct Frame {
    center: Complex64,
    /// A power of 2.
    unit: f64,
}

impl Frame {
    /// About the mean of the points; `None` where they are one, or their distances are out of range.
    fn of(points: &[Complex64]) -> Option<Self> {
        let center = points.iter().sum::<Complex64>() / points.len() as f64;
        let distances = points.iter().map(|point| modulus(point - center));
        let unit = scale(distances.fold(0.0, f64::max))?;
        Some(Self { center, unit })
    }

    fn inside(&self, place: Complex64) -> Complex64 {
        (place - self.center) / self.unit
    }

    fn outside(&self, place: Complex64) -> Complex64 {
        place * self.unit + self.center
    }
}
