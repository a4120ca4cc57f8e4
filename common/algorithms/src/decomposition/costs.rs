//! Costs: how many paths each way to a decomposition follows at most, before any is followed.

use super::dimension_start::DimensionStart;
use super::options::DecompositionOptions;
use super::problem::{Problem, ProblemError};
use cognate_solutions::witness::Method;
use cognate_systems::system::System;
use cognate_systems::transform::slice;
use serde::Serialize;
use std::collections::BTreeMap;

/// Number of paths up to which the equations are cheap whatever another method costs, so that nothing is counted.
const FEW_PATHS: u64 = 20_000;
/// The slices are taken where they have fewer paths than the equations by this factor: paths from mixed cells have two
/// legs, and the bound of the equations is seldom reached.
const CLEARLY_FEWER: u64 = 4;

/// Costs of each method of a decomposition.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DecompositionCosts {
    /// Number of variables.
    pub variables: u64,
    /// Number of equations.
    pub equations: u64,
    /// Lowest and highest dimension that a component can have: by the rank of the Jacobian at a random point, and
    /// because some equation holds nowhere else. Those of `asked` within them, where some are asked.
    pub dimensions: [u32; 2],
    /// Most paths to witness points, by the name of the way; `null` above 2^64. Paths that tell junk, and loops, come
    /// on top.
    pub paths: BTreeMap<&'static str, Option<u64>>,
    /// The way that is taken without a choice.
    pub choice: &'static str,
    /// Reason why this method is taken.
    pub why: String,
}

impl DecompositionCosts {
    /// The costs of decomposing a system; no path is followed.
    pub fn of(system: &System, options: &DecompositionOptions) -> Result<Self, ProblemError> {
        let problem = Problem::of_options(system, options)?;
        let bounds = Method::ALL.map(|method| (method.name(), bound(&problem, method)));
        let (choice, why) = choose(&problem);
        Ok(Self {
            variables: system.variable_count() as u64,
            equations: system.equation_count() as u64,
            dimensions: [*problem.asked.start(), *problem.asked.end()],
            paths: bounds.into_iter().collect(),
            choice: choice.name(),
            why: why.into(),
        })
    }
}

/// The way that is taken without a choice, and why.
pub(super) fn choose(problem: &Problem) -> (Method, &'static str) {
    let many = |paths: &u64| *paths > FEW_PATHS;
    let equations = bound(problem, Method::Equations);
    if equations.as_ref().is_none_or(many)
        && let Some(slices) = bound_of_slices(problem, equations)
        && equations.is_none_or(|paths| slices < paths / CLEARLY_FEWER)
    {
        let why = "each dimension by itself has far fewer paths than cutting by one equation after the other";
        return (Method::Slices, why);
    }
    let why = "the sets that the equations so far have in common are cut by the next; the cascade follows where \
               that leaves something in doubt";
    (Method::Equations, why)
}

/// Most paths of a way.
fn bound(problem: &Problem, method: Method) -> Option<u64> {
    match method {
        Method::Slices => bound_of_slices(problem, None),
        Method::Cascade => {
            let degrees = problem.row_degrees[..problem.asked_levels].iter();
            bound_of_cuts(degrees.map(|&degree| {
                let degree = u64::from(degree);
                [degree, 2 * degree - 1]
            }))
        }
        Method::Equations => {
            let mut cuts = Vec::new();
            for count in 1..=problem.order.len() {
                let factors = problem.prefix(count).ok()?.last_factors().ok()?;
                let once = factors.iter().map(|[degree, _]| u64::from(2 * degree - 1));
                let degrees = factors.iter().map(|[degree, _]| u64::from(*degree));
                cuts.push([degrees.sum(), once.sum()]);
            }
            bound_of_cuts(cuts.into_iter())
        }
    }
}

/// As many points as the degrees so far have for a product (Bezout), each cut anew. A cut: its degree, and the paths
/// from each point.
fn bound_of_cuts(cuts: impl Iterator<Item = [u64; 2]>) -> Option<u64> {
    let (mut paths, mut points) = (0u64, 1u64);
    for [degree, each] in cuts {
        paths = paths.checked_add(points.checked_mul(each)?)?;
        points = points.checked_mul(degree)?;
    }
    Some(paths)
}

/// The starts of all dimensions; `None` where workers count some, or where they are more than `most` together.
fn bound_of_slices(problem: &Problem, most: Option<u64>) -> Option<u64> {
    let mut paths = 0u64;
    for rows in 1..=problem.asked_levels {
        let dimension = problem.variables() - rows;
        let start = |keep: bool| {
            let rows = problem.combined(dimension, problem.seed(), keep);
            let sliced = slice(&rows, dimension, problem.variables());
            DimensionStart::of(&sliced, problem.seed())
        };
        let start = match start(false) {
            DimensionStart::TotalDegree { .. } => start(true),
            cells => cells,
        };
        paths = paths.checked_add(start.paths()?)?;
        if most.is_some_and(|most| paths > most) {
            return None;
        }
    }
    Some(paths)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::formats;

    #[test]
    fn products_are_cheap_for_the_equations() {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y, z; function f, g;\
                     f = (x - 1)*(x - 2)*(y - 3); g = x*y - z;\nEND;\n";
        let system = formats::read("test", text).unwrap().system;
        let costs = DecompositionCosts::of(&system, &DecompositionOptions::default()).unwrap();
        assert_eq!(costs.dimensions, [1, 2]);
        // Cascade: 3 paths to 2 points of the quadric, each of these with 5; equations: as many, each with 3.
        assert_eq!(costs.paths["cascade"], Some(3 + 2 * 5));
        assert_eq!(costs.paths["equations"], Some(3 + 2 * 3));
        assert_eq!(costs.paths["slices"], Some(2 + 2 * 3));
    }
}
