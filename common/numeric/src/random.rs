//! Seeded random numbers; the only source of randomness.
//!
//! Counter-based: the k-th number of a stream is a pure function of the job's
//! seed, what the stream is for, and k. Our own, since other generators change
//! their streams between versions.

use crate::scalar::Real;
use num_complex::Complex64;

/// Purpose of a random stream. Two purposes never share numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u64)]
pub enum Purpose {
    /// The constant gamma of a homotopy.
    Gamma = 1,
    /// Random projective patches.
    Patch = 2,
    /// Coefficients of start systems.
    StartSystem = 3,
    /// Detours in parameter space.
    Detour = 4,
    /// Probe points: preferred row orders, projections, invariance checks.
    Probe = 5,
    /// Tests and benches.
    Test = 6,
    /// Loops in parameter space.
    Loop = 7,
    /// Combinations of the equations of an overdetermined system.
    Randomization = 12,
    /// Multipliers of deflated systems.
    Deflation = 13,
    /// Constants that a file declares to be random.
    DeclaredConstant = 14,
    /// Liftings of supports.
    Lifting = 20,
    /// Slices and projections of questions to components.
    Question = 21,
}

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct RandomStream {
    key: u64,
    counter: u64,
}

/// The finalizer of SplitMix64 (Steele, Lea, Flood: Fast splittable
/// pseudorandom number generators, OOPSLA 2014), a bijection of 64-bit words.
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl RandomStream {
    /// The stream of this seed, purpose and index (a stage, a path, a group).
    pub fn new(seed: u64, purpose: Purpose, index: u64) -> Self {
        let key = mix(mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)) ^ mix(purpose as u64))
            .wrapping_add(mix(index.wrapping_add(0xd1b5_4a32_d192_ed03)));
        Self { key, counter: 0 }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.counter += 1;
        mix(self.key ^ mix(self.counter.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in 0..n.
    ///
    /// # Panics
    /// For n = 0.
    pub fn below(&mut self, n: u64) -> u64 {
        assert!(n > 0, "there is no number below 0");
        ((u128::from(self.bits()) * u128::from(n)) >> 64) as u64
    }

    /// Uniform on the unit circle, by rejection from the square: no sine, no cosine.
    pub fn unit(&mut self) -> Complex64 {
        loop {
            let (x, y) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let norm = x * x + y * y;
            if (0.01..=1.0).contains(&norm) {
                let mut length = norm;
                Real::sqrt(&mut length);
                return Complex64::new(x / length, y / length);
            }
        }
    }

    /// Uniform in the unit disc: bounded, and as generic as a Gaussian.
    pub fn disc(&mut self) -> Complex64 {
        loop {
            let (x, y) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            if x * x + y * y <= 1.0 {
                return Complex64::new(x, y);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_pure_and_differ() {
        let draw = |seed, purpose, index| RandomStream::new(seed, purpose, index).bits();
        assert_eq!(draw(1, Purpose::Gamma, 0), draw(1, Purpose::Gamma, 0));
        let mut draws: Vec<u64> = (0..50)
            .flat_map(|s| {
                [
                    draw(s, Purpose::Gamma, 0),
                    draw(s, Purpose::Patch, 0),
                    draw(0, Purpose::Test, s),
                ]
            })
            .collect();
        draws.sort_unstable();
        draws.dedup();
        assert_eq!(draws.len(), 150);
    }

    #[test]
    fn uniform_numbers_have_the_right_moments() {
        let mut stream = RandomStream::new(7, Purpose::Test, 0);
        let n = 100_000;
        let (mut mean, mut square, mut unit) = (0.0, 0.0, Complex64::new(0.0, 0.0));
        for _ in 0..n {
            let u = stream.uniform();
            mean += u / f64::from(n);
            square += u * u / f64::from(n);
            unit += stream.unit() / f64::from(n);
        }
        assert!((mean - 0.5).abs() < 5e-3 && (square - 1.0 / 3.0).abs() < 5e-3);
        assert!(unit.norm_sqr() < 1e-4);
    }
}
