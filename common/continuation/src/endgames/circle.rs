//! Circle: the regular polygon around t = 0 at whose vertices the endgame samples a path.

use cognate_numeric::scalar::{Complex, DoubleDouble, Real};
use std::sync::LazyLock;

/// Samples per turn.
pub const VERTICES: u32 = 16;

/// The vertices for radius 1.
static UNIT_CIRCLE: LazyLock<[Complex<DoubleDouble<f64>>; VERTICES as usize]> =
    LazyLock::new(unit_circle);

/// Vertex number `vertex` of the regular polygon of [`VERTICES`] sides, with the digits of double-doubles.
pub(super) fn exact_vertex(radius: f64, vertex: u32) -> Complex<DoubleDouble<f64>> {
    let radius = DoubleDouble::from_f64((), radius);
    let mut place = UNIT_CIRCLE[(vertex % VERTICES) as usize];
    place.re.mul(&radius);
    place.im.mul(&radius);
    place
}

fn unit_circle() -> [Complex<DoubleDouble<f64>>; VERTICES as usize] {
    // Halving the angle pi/4 once: 2 cos^2 = 1 + cos.
    let number = |value: f64| DoubleDouble::from_f64((), value);
    let mut half_root = number(0.5);
    half_root.sqrt();
    let halved = |sign: f64| {
        let mut square = half_root;
        square.mul(&number(sign));
        square.add(&number(1.0));
        square.mul(&number(0.5));
        square.sqrt();
        square
    };
    let (re, im) = (halved(1.0), halved(-1.0));
    let first = Complex { re, im };
    let mut place = Complex::from_f64((), 1.0, 0.0);
    std::array::from_fn(|_| {
        let here = place;
        place.mul(&first);
        here
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::roots_of_unity::roots_of_unity;

    #[test]
    fn vertices_are_those_of_the_circle() {
        for (vertex, z) in (0..VERTICES).zip(roots_of_unity(VERTICES)) {
            let exact = exact_vertex(1.0, vertex).lane(0);
            assert!((exact - z).norm_sqr() < 1e-31, "{vertex}: {exact} {z}");
        }
    }
}
