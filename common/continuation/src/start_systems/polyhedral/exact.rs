//! Exact: the integers of the tropical homotopy, machine words while they fit.
//!
//! A type says of every number that it is about to keep whether it still
//! leaves room for all that is computed from it; where it does not, the whole
//! enumeration is done again with the next wider type.

use rug::Integer;
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// An integer type that knows its own limits.
pub(super) trait Exact:
    Clone
    + Ord
    + From<i64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
{
    /// A divisor in the form that makes repeated divisions fast.
    type Divisor;

    /// Prepares many divisions by a positive number.
    fn divisor(&self) -> Self::Divisor;

    /// The quotient of a division that leaves no rest.
    fn divide(self, by: &Self::Divisor) -> Self;

    /// Whether the number may be an entry of a table: products of two entries, and their differences, fit.
    fn is_entry(&self) -> bool;

    /// Whether the product of the number with `factor`, several times over, fits.
    fn leaves_room_for(&self, factor: i64) -> bool;

    /// Compares the fractions `a/b` and `c/d` with positive b and d.
    fn compare_fractions(a: &Self, b: &Self, c: &Self, d: &Self) -> Ordering;

    /// The number, where it fits.
    fn to_i128(&self) -> Option<i128>;
}

impl Exact for i64 {
    /// Powers of two that divide it, and the inverse of the rest modulo 2^64.
    type Divisor = (u32, i64);

    fn divisor(&self) -> Self::Divisor {
        let shift = self.trailing_zeros();
        let odd = self >> shift;
        // Newton's iteration doubles the right bits, from three.
        let mut inverse = odd;
        for _ in 0..5 {
            inverse = inverse.wrapping_mul(2i64.wrapping_sub(odd.wrapping_mul(inverse)));
        }
        (shift, inverse)
    }

    fn divide(self, &(shift, inverse): &Self::Divisor) -> Self {
        (self >> shift).wrapping_mul(inverse)
    }

    fn is_entry(&self) -> bool {
        self.unsigned_abs() < 1 << 30
    }

    fn leaves_room_for(&self, factor: i64) -> bool {
        self.unsigned_abs()
            .checked_mul(factor.unsigned_abs())
            .is_some_and(|product| product < 1 << 60)
    }

    fn compare_fractions(a: &Self, b: &Self, c: &Self, d: &Self) -> Ordering {
        (i128::from(*a) * i128::from(*d)).cmp(&(i128::from(*c) * i128::from(*b)))
    }

    fn to_i128(&self) -> Option<i128> {
        Some(i128::from(*self))
    }
}

impl Exact for i128 {
    type Divisor = i128;

    fn divisor(&self) -> Self::Divisor {
        *self
    }

    fn divide(self, by: &Self::Divisor) -> Self {
        self / by
    }

    fn is_entry(&self) -> bool {
        self.unsigned_abs() < 1 << 62
    }

    fn leaves_room_for(&self, factor: i64) -> bool {
        self.unsigned_abs()
            .checked_mul(u128::from(factor.unsigned_abs()))
            .is_some_and(|product| product < 1 << 124)
    }

    fn compare_fractions(a: &Self, b: &Self, c: &Self, d: &Self) -> Ordering {
        Integer::compare_fractions(
            &Integer::from(*a),
            &Integer::from(*b),
            &Integer::from(*c),
            &Integer::from(*d),
        )
    }

    fn to_i128(&self) -> Option<i128> {
        Some(*self)
    }
}

impl Exact for Integer {
    type Divisor = Integer;

    fn divisor(&self) -> Self::Divisor {
        self.clone()
    }

    fn divide(self, by: &Self::Divisor) -> Self {
        self.div_exact(by)
    }

    fn is_entry(&self) -> bool {
        true
    }

    fn leaves_room_for(&self, _: i64) -> bool {
        true
    }

    fn compare_fractions(a: &Self, b: &Self, c: &Self, d: &Self) -> Ordering {
        Integer::from(a * d).cmp(&Integer::from(c * b))
    }

    fn to_i128(&self) -> Option<i128> {
        Integer::to_i128(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divisions_without_rest_are_exact() {
        for divisor in [1i64, 2, 3, 12, 1 << 20, 6_700_417, (1 << 30) - 35] {
            let prepared = divisor.divisor();
            for quotient in [0i64, 1, -1, 7, -(1 << 29), 123_456_789] {
                assert_eq!((quotient * divisor).divide(&prepared), quotient);
            }
        }
    }
}
