//! Places: random parameters where loops meet.
//!
//! Loops that stay where a few parameters are much larger than the others go around the branch
//! points at infinity only: of the six-revolute arms, met at a hand 60 arm's lengths away, they
//! connected 4 or 10 of 16 solutions and no more. So places differ in the sizes of their parameters.

use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// Sizes of the parameters of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sizes {
    /// Each as large as where the solve began.
    Own,
    /// All as large as the one in the middle, or all 2, 4 or 8 times smaller.
    Even,
    /// Each by chance as large as where the solve began or as the one in the middle, or smaller.
    Either,
}

impl Sizes {
    /// The sizes at a place, by how many there are before it: the first two as the start has them.
    pub fn of_place(before: usize) -> Self {
        match (before, before % 3) {
            (0 | 1, _) | (_, 1) => Self::Own,
            (_, 2) => Self::Even,
            _ => Self::Either,
        }
    }
}

fn size(z: &Complex64) -> f64 {
    z.norm_sqr().sqrt()
}

/// Random parameters for one vertex, in discs half as large again as `sizes` says of the given ones.
pub(super) fn generic_parameters(
    like: &[Complex64],
    seed: u64,
    vertex: usize,
    sizes: Sizes,
) -> Vec<Complex64> {
    let mut random = RandomStream::new(seed, Purpose::Loop, (1 << 32) + vertex as u64);
    let mut ascending: Vec<f64> = like.iter().map(size).filter(|&s| s > 0.0).collect();
    ascending.sort_by(f64::total_cmp);
    let largest = ascending.last().copied().unwrap_or(1.0);
    let middle = ascending.get(ascending.len() / 2).copied().unwrap_or(1.0);
    let smaller = [1.0, 0.5, 0.25, 0.125];
    let shared_factor = match sizes {
        Sizes::Own => 1.0,
        Sizes::Even | Sizes::Either => smaller[random.below(4) as usize],
    };
    like.iter()
        .map(|z| {
            // A parameter that is 0 where it begins is as large as the others.
            let parameter_size = if size(z) > 0.0 { size(z) } else { largest };
            let scale = match sizes {
                Sizes::Own => parameter_size,
                Sizes::Even => middle,
                Sizes::Either if random.bits() & 1 == 0 => parameter_size / shared_factor,
                Sizes::Either => middle,
            };
            random.disc() * (1.5 * scale * shared_factor)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One parameter of four is 1000 times larger: at the third place none is.
    #[test]
    fn sizes_differ_from_place_to_place() {
        let like = [1.0, 2.0, 1000.0, 0.0].map(|x| Complex64::new(x, 0.0));
        let largest = |before: usize| -> f64 {
            let sizes = Sizes::of_place(before);
            let places = (0..20).map(|seed| generic_parameters(&like, seed, 7, sizes));
            let sizes = places.flatten().map(|z| size(&z));
            sizes.fold(0.0, f64::max)
        };
        assert!(largest(0) > 500.0 && largest(1) > 500.0 && largest(3) > 500.0);
        assert!(largest(2) <= 3.0, "{}", largest(2));
    }
}
