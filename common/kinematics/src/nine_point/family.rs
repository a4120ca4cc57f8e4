//! The solved generic member of the family, carried in the program: one solution of each class.

use super::Point;
use cognate_systems::formats::points::read_parameters;
use cognate_systems::named::nine_point;
use num_complex::Complex64;

/// Classes of solutions for generic points: coupler curves, each of three cognate linkages,
/// each written down in two ways.
pub const CLASSES: usize = 1442;

/// One solution of each class, with every bit: 184,592 bytes, made from all of them by
/// `tests/known_answers/nine_point.rs` (see `deploy/families/README.md`).
const REPRESENTATIVES: &[u8] =
    include_bytes!("../../../../deploy/families/nine_point/representatives.points");

/// The parameters that they belong to.
const PARAMETERS: &[u8] = include_bytes!("../../../../deploy/families/nine_point/parameters.json");

/// Magic and number of coordinates come first.
const HEAD: usize = 16;

/// The solutions, class after class.
pub fn representatives() -> Vec<Point> {
    let mut numbers = REPRESENTATIVES[HEAD..]
        .chunks_exact(8)
        .map(|bytes| f64::from_le_bytes(bytes.try_into().expect("a chunk has eight bytes")));
    let mut next = || numbers.next().expect("the family in this program is whole");
    let points: Vec<Point> = (0..CLASSES)
        .map(|_| std::array::from_fn(|_| Complex64::new(next(), next())))
        .collect();
    assert_eq!(
        REPRESENTATIVES.len(),
        HEAD + CLASSES * 8 * 16,
        "the family in this program has one solution of each class"
    );
    points
}

/// d_1, D_1, ..., d_8, D_8 of the generic member.
pub fn parameters() -> Vec<Complex64> {
    let names = nine_point().system.parameters;
    let sets = read_parameters("parameters.json", PARAMETERS, &names);
    sets.expect("the family in this program has parameters")
        .swap_remove(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nine_point::cognates::Newton;

    #[test]
    fn every_representative_is_a_solution() {
        let mut newton = Newton::new();
        let parameters = parameters();
        for (class, point) in representatives().iter().enumerate() {
            let step = newton.step(point, &parameters);
            let size = step.map_or(f64::NAN, |(_, size)| size);
            assert!(size < 1e-9, "class {class}: {size:e}");
        }
    }
}
