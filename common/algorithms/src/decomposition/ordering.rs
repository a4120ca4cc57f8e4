//! The order of a decomposition: components are sorted and named, dimensions get their degrees, and the counts are
//! checked.

use cognate_solutions::completeness::Completeness;
use cognate_solutions::witness::{ComponentId, Decomposition, Doubt, WitnessSet};
use std::collections::BTreeMap;

/// The decomposition with its components in order and named, its dimensions with their degrees, and whether their
/// counts add up.
pub(crate) fn ordered(mut decomposition: Decomposition) -> Decomposition {
    let key = |set: &WitnessSet| {
        let mut points: Vec<Vec<i64>> = set.points.iter().map(|p| grid(p)).collect();
        points.sort();
        points
    };
    decomposition.components.sort_by_cached_key(|set| {
        let by = std::cmp::Reverse((set.dimension(), set.degree, set.multiplicity.scheme));
        (by, key(set))
    });
    for dimension in &mut decomposition.dimensions {
        dimension.degree = 0;
        let witness_sets = decomposition.components.iter_mut();
        let witness_sets = witness_sets.filter(|set| set.dimension() == dimension.number);
        for (number, set) in (1..).zip(witness_sets) {
            set.id = ComponentId {
                dimension: dimension.number,
                number,
            };
            dimension.degree += set.degree;
        }
        number_orbits(&mut decomposition.components, dimension.number);
        let missing = dimension.doubts.contains(&Doubt::PointsMissing);
        dimension.complete = match dimension.doubts.is_empty() {
            true => Completeness::Yes,
            false if missing => Completeness::No,
            false => Completeness::NotKnown,
        };
    }
    decomposition.check_counts();
    decomposition
}

/// Numbers the orbits of the components of a dimension in the order of their first components.
fn number_orbits(components: &mut [WitnessSet], dimension: u32) {
    let mut numbers = BTreeMap::new();
    for set in components
        .iter_mut()
        .filter(|set| set.dimension() == dimension)
    {
        let next = numbers.len() as u32 + 1;
        set.orbit = set.orbit.map(|orbit| *numbers.entry(orbit).or_insert(next));
    }
}

/// Coordinates on a grid of 10^-6: an order of points that rounding errors do not change, unless on a border.
fn grid(point: &[num_complex::Complex64]) -> Vec<i64> {
    let place = |x: f64| (x * 1e6).round() as i64;
    point
        .iter()
        .flat_map(|z| [place(z.re), place(z.im)])
        .collect()
}
