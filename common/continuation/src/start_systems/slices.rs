//! Slices of a regeneration: random linear forms in all variables, by level and number.
//!
//! Level k of a regeneration holds the regular solutions of the first k
//! equations on the slices k, k+1, ... For the next equation, of degree d, they
//! are moved to the d forms of its level; the product of the forms is then
//! deformed into the equation (Hauenstein, Sommese, Wampler: Regeneration
//! homotopies for solving systems of polynomials, 2011). The first form of each level
//! is the slice itself.

use crate::start_systems::linear_product::common_zero;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// `c_0, c_1, ..., c_n` of the form `c_0 y_0 + c_1 y_1 + ... + c_n y_n` with this number on a
/// level, in the order of the system's variables; number 0 is the slice.
pub fn form(seed: u64, level: u32, number: u32, variables: usize) -> Vec<Complex64> {
    let index = u64::from(level) << 32 | u64::from(number);
    let mut stream = RandomStream::new(seed, Purpose::StartSystem, index);
    (0..=variables).map(|_| stream.unit()).collect()
}

/// The one point on all slices: where a regeneration begins. `None` where they do not meet in
/// one point, which has probability 0.
pub fn common_point(seed: u64, variables: usize) -> Option<Vec<Complex64>> {
    let forms: Vec<_> = (0..variables as u32)
        .map(|level| form(seed, level, 0, variables))
        .collect();
    let forms: Vec<&[Complex64]> = forms.iter().map(Vec::as_slice).collect();
    common_zero(&forms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_point_lies_on_all_slices_and_on_no_other_form() {
        let point = common_point(9, 5).expect("random slices meet");
        let value = |form: &[Complex64]| -> Complex64 {
            form[0]
                + form[1..]
                    .iter()
                    .zip(&point)
                    .map(|(c, x)| c * x)
                    .sum::<Complex64>()
        };
        for level in 0..5 {
            assert!(value(&form(9, level, 0, 5)).norm_sqr() < 1e-24);
            assert!(value(&form(9, level, 1, 5)).norm_sqr() > 1e-6);
        }
    }
}
