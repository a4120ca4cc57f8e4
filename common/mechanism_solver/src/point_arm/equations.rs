//! Small systems in the cosines, sines and shifts of an arm's joints, solved in this process: real solutions, and
//! doubts.

use super::joint_polynomial::{Turns, unknowns};
use crate::start_positions::{in_order, solve};
use cognate_algorithms::SolveOptions;
use cognate_kinematics::compile::text::Equations;
use cognate_solutions::solution::Solution;

/// Imaginary parts below this are none at a singular solution, which has fewer digits than a regular one.
const REAL_IF_SINGULAR: f64 = 1e-5;

/// Condition numbers above this are those of a singular solution that rounding of the coefficients takes apart.
const SINGULAR: f64 = 1e8;

/// A real solution.
pub struct RealSolution {
    /// Values of the unknowns, in the order of the equations.
    pub values: Vec<f64>,
    /// Whether the equations are singular there.
    pub is_singular: bool,
}

/// Real solutions of a system.
pub struct RealSolutions {
    /// The real solutions.
    pub solutions: Vec<RealSolution>,
    /// Why more or others may be there; `None` where every path is accounted for.
    pub doubt: Option<String>,
}

/// Equations with the circles of the joints that turn, a group of unknowns each.
pub fn of_joints(turns: Turns, equations: Vec<String>) -> Equations {
    let circle = |joint: usize| turns[joint].then(|| format!("c{0}^2+s{0}^2-1", joint + 2));
    let circles = (0..2).filter_map(circle);
    Equations {
        groups: vec![unknowns(turns, 0), unknowns(turns, 1)],
        equations: circles.chain(equations).collect(),
        ..Equations::default()
    }
}

/// All real solutions; `name` names the system in doubts.
pub fn real_solutions(
    equations: &Equations,
    name: &str,
    seed: u64,
) -> Result<RealSolutions, String> {
    let system = equations.system(name).map_err(|e| e.to_string())?;
    let options = SolveOptions {
        seed,
        ..SolveOptions::default()
    };
    let sets = solve(&system, &options, None)?;
    let set = sets.first().ok_or("a system was not solved")?;
    let on_sets = set.paths.positive_dimensional.unwrap_or(0);
    let doubt = if !set.settled() {
        Some(format!("{name}: not every path is accounted for"))
    } else if on_sets > 0 {
        Some(format!("{name}: solutions form a curve"))
    } else {
        None
    };
    let real = set.solutions.iter().filter_map(|solution: &Solution| {
        let values = in_order(solution, &system);
        let imaginary = values.iter().map(|z| z.im.abs()).fold(0.0, f64::max);
        let is_singular =
            solution.singular || solution.condition.is_nan() || solution.condition > SINGULAR;
        let is_real = match is_singular {
            true => imaginary < REAL_IF_SINGULAR,
            false => solution.real == Some(true),
        };
        is_real.then(|| RealSolution {
            values: values.iter().map(|z| z.re).collect(),
            is_singular,
        })
    });
    Ok(RealSolutions {
        solutions: real.collect(),
        doubt,
    })
}

/// Cosines and sines of both joints from the first values of a solution.
pub fn joints(turns: Turns, values: &[f64]) -> [f64; 4] {
    let mut values = values.iter().copied();
    let mut joint = |turns: bool| {
        let cosine = if turns { values.next() } else { Some(0.0) };
        [
            cosine.unwrap_or_default(),
            values.next().unwrap_or_default(),
        ]
    };
    let [a, b] = [joint(turns[0]), joint(turns[1])];
    [a[0], a[1], b[0], b[1]]
}
