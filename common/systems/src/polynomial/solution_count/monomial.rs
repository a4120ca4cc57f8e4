//! Monomial: exponents in one word, in graded reverse lexicographic order.

/// Most variables of a monomial.
pub(in crate::polynomial) const MOST_VARIABLES: usize = 16;
/// Highest degree of a monomial.
pub(super) const MOST_DEGREE: u32 = 127;

const BYTE: u32 = 8;
const HIGH_BITS: u128 = u128::from_ne_bytes([0x80; 16]);

/// A monomial of degree 127 at most: from the highest byte downwards the degree in all variables, in all but the last,
/// and so on to the degree in the first. So comparing words is the graded reverse lexicographic order, and adding
/// them multiplies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(in crate::polynomial) struct Monomial(u128);

impl Monomial {
    /// From the exponents; `None` where there are too many or they are too large.
    pub fn new(exponents: &[u32]) -> Option<Self> {
        let mut word = 0u128;
        let mut sum = 0u32;
        if exponents.len() > MOST_VARIABLES {
            return None;
        }
        for (k, &exponent) in exponents.iter().enumerate() {
            sum = sum
                .checked_add(exponent)
                .filter(|&sum| sum <= MOST_DEGREE)?;
            word |= u128::from(sum) << Self::place(exponents.len(), k);
        }
        Some(Self(word))
    }

    /// One of `count` variables.
    pub fn variable(count: usize, k: usize) -> Self {
        let sums = (k..count).map(|j| 1u128 << Self::place(count, j));
        Self(sums.sum())
    }

    fn place(count: usize, k: usize) -> u32 {
        BYTE * (MOST_VARIABLES - count + k) as u32
    }

    /// The degree in all variables.
    pub fn degree(self) -> u32 {
        (self.0 >> (BYTE * (MOST_VARIABLES as u32 - 1))) as u32
    }

    /// One byte for each exponent.
    fn exponents(self) -> u128 {
        self.0.wrapping_sub(self.0 << BYTE)
    }

    /// The exponent of one of `count` variables.
    pub fn exponent(self, count: usize, k: usize) -> u32 {
        (self.exponents() >> Self::place(count, k)) as u32 & 0xff
    }

    pub fn divides(self, other: Self) -> bool {
        ((other.exponents() | HIGH_BITS).wrapping_sub(self.exponents())) & HIGH_BITS == HIGH_BITS
    }

    pub fn is_coprime_to(self, other: Self) -> bool {
        let (a, b) = (
            self.exponents().to_ne_bytes(),
            other.exponents().to_ne_bytes(),
        );
        a.iter().zip(&b).all(|(&a, &b)| a == 0 || b == 0)
    }

    /// The product; its degree must not exceed the highest.
    pub fn times(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }

    /// The quotient by a divisor.
    pub fn over(self, divisor: Self) -> Self {
        Self(self.0 - divisor.0)
    }

    /// The least common multiple; `None` where its degree is too high.
    pub fn common_multiple(self, other: Self) -> Option<Self> {
        let (a, b) = (
            self.exponents().to_le_bytes(),
            other.exponents().to_le_bytes(),
        );
        let mut sums = [0u8; MOST_VARIABLES];
        let mut sum = 0u32;
        for (place, (&a, &b)) in sums.iter_mut().zip(a.iter().zip(&b)) {
            sum += u32::from(a.max(b));
            *place = u8::try_from(sum)
                .ok()
                .filter(|&sum| u32::from(sum) <= MOST_DEGREE)?;
        }
        Some(Self(u128::from_le_bytes(sums)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(exponents: [u32; 3]) -> Monomial {
        Monomial::new(&exponents).unwrap()
    }

    #[test]
    fn the_order_is_graded_reverse_lexicographic() {
        // x > y > z; x z < y^2.
        assert!(of([1, 0, 0]) > of([0, 1, 0]) && of([0, 1, 0]) > of([0, 0, 1]));
        assert!(of([1, 0, 1]) < of([0, 2, 0]) && of([0, 0, 2]) > of([1, 0, 0]));
        assert_eq!(Monomial::variable(3, 1), of([0, 1, 0]));
        assert_eq!(Monomial::new(&[100, 28]), None);
    }

    #[test]
    fn products_quotients_and_common_multiples() {
        let (a, b) = (of([2, 0, 1]), of([1, 3, 0]));
        assert_eq!(a.times(b), of([3, 3, 1]));
        assert_eq!(a.common_multiple(b), Some(of([2, 3, 1])));
        assert_eq!(of([2, 3, 1]).over(b), of([1, 0, 1]));
        assert!(a.divides(of([2, 5, 1])) && !a.divides(of([1, 9, 9])) && !a.divides(b));
        assert!(of([2, 0, 0]).is_coprime_to(of([0, 1, 7])) && !a.is_coprime_to(b));
        assert_eq!([0, 1, 2].map(|k| a.exponent(3, k)), [2, 0, 1]);
        assert_eq!((a.degree(), Monomial::default().degree()), (3, 0));
    }
}
