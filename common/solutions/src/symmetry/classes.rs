//! Classes: the solutions of a set by orbits of its system's symmetry group.

use super::SymmetryGroup;
use crate::classification::{Tolerances, error_bound};
use crate::point_shape::PointShape;
use crate::solution::Solution;
use crate::summary::ClassCounts;
use cognate_systems::system::System;
use num_complex::Complex64;

/// Gives each of these solutions its class, and counts them; a reason in words where that cannot be done.
/// A system without generators has no classes.
pub fn assign(
    solutions: &mut [&mut Solution],
    system: &System,
    parameters: &[Complex64],
    tolerances: &Tolerances,
    seed: u64,
) -> Result<ClassCounts, String> {
    if system.symmetry.is_empty() || solutions.is_empty() {
        return Ok(ClassCounts::default());
    }
    let shape = PointShape::of(system);
    let values: Vec<Vec<Complex64>> = solutions
        .iter()
        .map(|s| s.variables.values().collect())
        .collect();
    let radius = |s: &Solution| {
        let (factor, floor) = match s.singular {
            true => (
                tolerances.singular_coincidence_factor,
                tolerances.singular_coincidence_floor,
            ),
            false => (tolerances.coincidence_factor, tolerances.coincidence_floor),
        };
        error_bound(s.accuracy, factor, floor)
    };
    let points: Vec<(&[Complex64], f64)> = values
        .iter()
        .zip(&*solutions)
        .map(|(values, s)| (values.as_slice(), radius(s)))
        .collect();
    let words = |error: super::SymmetryError| format!("there are no classes: {error}");
    let group = SymmetryGroup::of(system).map_err(words)?;
    let regular: Vec<(&[Complex64], f64)> = points
        .iter()
        .zip(&*solutions)
        .filter(|(_, solution)| !solution.singular)
        .map(|(point, _)| *point)
        .collect();
    if let Some(doubt) = group.doubt(&regular, system, parameters, &shape) {
        return Ok(ClassCounts {
            doubt: Some(doubt),
            ..ClassCounts::default()
        });
    }
    let group = group.acting(&points, &shape).map_err(words)?;
    let orbits = group.orbits(&points, &shape, seed);
    let whole = orbits.iter().filter(|orbit| {
        let (values, _) = points[orbit[0]];
        group.orbit(values, &shape).len() == orbit.len()
    });
    let counts = ClassCounts {
        count: Some(orbits.len() as u64),
        group_order: Some(group.order() as u64),
        complete: Some(whole.count() as u64),
        doubt: None,
    };
    for (class, orbit) in orbits.iter().enumerate() {
        for &member in orbit {
            solutions[member].class = Some(class as u64);
        }
    }
    Ok(counts)
}
