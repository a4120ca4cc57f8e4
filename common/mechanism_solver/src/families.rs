//! A general member of a family, solved anew from a start system, and how it compares with the published number.

use super::start_positions::{draw, in_order, solve};
use cognate_algorithms::SolveOptions;
use cognate_kinematics::compile::families::SolvedFamily;
use num_complex::Complex64;

/// A general member with its positions.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedMember {
    /// Names and values of its parameters.
    pub parameters: Vec<(String, Complex64)>,
    /// The variables, in the order of the points.
    pub variables: Vec<String>,
    /// Positions of the member.
    pub positions: Vec<Vec<Complex64>>,
    /// Paths of the solve.
    pub paths: u64,
    /// Solutions that are no positions.
    pub others: u64,
    /// Whether every path is accounted for, and the number is the published one.
    pub settled: bool,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Solves a random complex member.
pub fn solve_member(family: &SolvedFamily, seed: u64) -> Result<SolvedMember, String> {
    let equations = (family.equations)();
    let system = equations.system(family.name).map_err(|e| e.to_string())?;
    let mut next = draw(seed, 0);
    let values: Vec<Complex64> = equations.parameters.iter().map(|_| next()).collect();
    let options = SolveOptions {
        seed,
        target_parameters: vec![values.clone()],
        ..SolveOptions::default()
    };
    let sets = solve(&system, &options, None)?;
    let set = sets.first().ok_or("the member was not solved")?;
    let points = set.solutions.iter().filter(|s| !s.singular);
    let points = points.map(|solution| in_order(solution, &system));
    let (positions, others): (Vec<_>, Vec<_>) =
        points.partition(|point| (family.is_position)(&values, point));
    let mut warnings = set.warnings.clone();
    let is_published = positions.len() as u64 == family.number;
    if !is_published {
        warnings.push(format!(
            "{} positions were found, not {} ({})",
            positions.len(),
            family.number,
            family.source
        ));
    }
    Ok(SolvedMember {
        parameters: equations.parameters.iter().cloned().zip(values).collect(),
        variables: system.variables.clone(),
        positions,
        paths: set.paths.total,
        others: others.len() as u64,
        settled: set.settled() && is_published,
        warnings,
    })
}
