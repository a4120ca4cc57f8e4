//! Costs: how many paths each way to a decomposition follows at most, before any is followed.

use super::options::DecompositionOptions;
use super::problem::{Problem, ProblemError};
use cognate_solutions::witness::Method;
use cognate_systems::system::System;
use serde::Serialize;
use std::collections::BTreeMap;

/// What each way would cost.
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
    /// Why.
    pub why: String,
}

impl DecompositionCosts {
    /// Those of a system; nothing is followed.
    pub fn of(system: &System, options: &DecompositionOptions) -> Result<Self, ProblemError> {
        let problem = Problem::of_options(system, options)?;
        let bounds = Method::ALL.map(|method| (method.name(), bound(&problem, method)));
        Ok(Self {
            variables: system.variable_count() as u64,
            equations: system.equation_count() as u64,
            dimensions: [*problem.asked.start(), *problem.asked.end()],
            paths: bounds.into_iter().collect(),
            choice: Method::Equations.name(),
            why: "the sets that the equations so far have in common are cut by the next; the cascade follows where \
                  that leaves something in doubt"
                .into(),
        })
    }
}

/// Most paths of a way: as many points as the degrees so far have for a product (Bezout), each cut anew.
fn bound(problem: &Problem, method: Method) -> Option<u64> {
    let mut paths = 0u64;
    let mut points = 1u64;
    let mut cut = |degree: u64, forms: u64| {
        let each = match method {
            Method::Slices => degree,
            Method::Cascade | Method::Equations => forms,
        };
        paths = paths.checked_add(points.checked_mul(each)?)?;
        points = points.checked_mul(degree)?;
        Some(())
    };
    match method {
        Method::Cascade | Method::Slices => {
            for &degree in &problem.row_degrees[..problem.asked_levels] {
                let degree = u64::from(degree);
                cut(degree, 2 * degree - 1)?;
            }
        }
        Method::Equations => {
            for count in 1..=problem.order.len() {
                let factors = problem.prefix(count).ok()?.last_factors().ok()?;
                let once = factors.iter().map(|[degree, _]| u64::from(2 * degree - 1));
                let degrees = factors.iter().map(|[degree, _]| u64::from(*degree));
                cut(degrees.sum(), once.sum())?;
            }
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
