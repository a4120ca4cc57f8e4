//! The ladder itself: what a rung is. When to change rung is `continuation`'s business.

use serde::{Deserialize, Serialize};

/// A rung of the precision ladder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Precision {
    /// Hardware doubles, 53 bits.
    Double,
    /// Double-doubles, 106 bits.
    DoubleDouble,
    /// MPFR with this many bits.
    Bits(u32),
}

impl Precision {
    /// Bits of the significand.
    pub fn bits(self) -> u32 {
        match self {
            Self::Double => 53,
            Self::DoubleDouble => 106,
            Self::Bits(bits) => bits,
        }
    }

    /// Unit roundoff 2^-bits.
    pub fn unit_roundoff(self) -> f64 {
        // Exact: powers of two down to 2^-1074, 0 below, never from libm.
        let bits = self.bits().min(1100);
        let mut u = 1.0;
        for _ in 0..bits {
            u *= 0.5;
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_roundoff_of_doubles_is_half_an_epsilon() {
        assert_eq!(Precision::Double.unit_roundoff(), f64::EPSILON / 2.0);
        assert_eq!(Precision::Bits(1).unit_roundoff(), 0.5);
    }
}
