//! Primes, the largest first.

use rug::Integer;
use rug::integer::IsPrime;

/// Rounds of the test that tells primes from others: it errs with odds below 4^-30.
const ROUNDS: u32 = 30;

/// The primes below an even number, descending.
pub(super) struct PrimesBelow {
    /// An odd number above all that are left.
    before: u64,
}

impl PrimesBelow {
    pub fn new(even: u64) -> Self {
        Self { before: even + 1 }
    }
}

impl Iterator for PrimesBelow {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        while self.before > 3 {
            self.before -= 2;
            if Integer::from(self.before).is_probably_prime(ROUNDS) != IsPrime::No {
                return Some(self.before);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn primes_descend() {
        let primes: Vec<u64> = PrimesBelow::new(20).collect();
        assert_eq!(primes, [19, 17, 13, 11, 7, 5, 3]);
        let first: Vec<u64> = PrimesBelow::new(1 << 31).take(2).collect();
        assert_eq!(first, [2_147_483_647, 2_147_483_629]);
    }
}
