//! Monomial: exponents in two words, in graded reverse lexicographic order.

/// Most variables of a monomial.
pub(in crate::polynomial) const MOST_VARIABLES: usize = 16;
/// Highest degree of a monomial: one bit of a lane is for comparisons of all lanes at once.
pub(super) const MOST_DEGREE: u32 = 0x7fff;

/// Bits of a lane.
const LANE: u32 = 16;
/// Lanes of a word.
const LANES: usize = 8;
const ONES: u128 = 0x0001_0001_0001_0001_0001_0001_0001_0001;
const HIGH_BITS: u128 = 0x8000_8000_8000_8000_8000_8000_8000_8000;

/// A monomial of sixteen lanes of 16 bits: from the highest lane downwards the degree in all variables, in all but the
/// last, and so on to the degree in the first. So comparing words is the graded reverse lexicographic order, and adding
/// them multiplies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(in crate::polynomial) struct Monomial {
    high: u128,
    low: u128,
}

impl Monomial {
    /// The monomial with these exponents; `None` where there are too many or they are too large.
    pub fn new(exponents: &[u32]) -> Option<Self> {
        if exponents.len() > MOST_VARIABLES {
            return None;
        }
        let mut sums = [0; MOST_VARIABLES];
        let mut sum = 0u32;
        for (k, &exponent) in exponents.iter().enumerate() {
            sum = sum
                .checked_add(exponent)
                .filter(|&sum| sum <= MOST_DEGREE)?;
            sums[Self::lane(exponents.len(), k)] = sum as u16;
        }
        Some(Self::from_lanes(sums))
    }

    /// The monomial of one of `count` variables.
    pub fn variable(count: usize, k: usize) -> Self {
        let mut sums = [0; MOST_VARIABLES];
        sums[Self::lane(count, k)..].fill(1);
        Self::from_lanes(sums)
    }

    /// The lane of one of `count` variables.
    fn lane(count: usize, k: usize) -> usize {
        MOST_VARIABLES - count + k
    }

    /// The monomial with these lanes, from the lowest upwards.
    fn from_lanes(lanes: [u16; MOST_VARIABLES]) -> Self {
        let word = |lanes: &[u16]| {
            let upwards = lanes.iter().rev();
            upwards.fold(0, |word, &lane| word << LANE | u128::from(lane))
        };
        Self {
            high: word(&lanes[LANES..]),
            low: word(&lanes[..LANES]),
        }
    }

    /// The degree in all variables.
    pub fn degree(self) -> u32 {
        (self.high >> (LANE * (LANES as u32 - 1))) as u32
    }

    /// The exponents, one in each lane.
    fn exponents(self) -> Self {
        // Degrees grow from lane to lane, so that no lane borrows from the next.
        let carried = self.low >> (LANE * (LANES as u32 - 1));
        Self {
            high: self.high - (self.high << LANE | carried),
            low: self.low - (self.low << LANE),
        }
    }

    /// The exponent of one of `count` variables.
    pub fn exponent(self, count: usize, k: usize) -> u32 {
        let (exponents, lane) = (self.exponents(), Self::lane(count, k));
        let (word, lane) = match lane.checked_sub(LANES) {
            Some(lane) => (exponents.high, lane),
            None => (exponents.low, lane),
        };
        (word >> (LANE * lane as u32)) as u32 & 0xffff
    }

    pub fn divides(self, other: Self) -> bool {
        let (a, b) = (self.exponents(), other.exponents());
        let is_less = |a: u128, b: u128| ((b | HIGH_BITS) - a) & HIGH_BITS == HIGH_BITS;
        is_less(a.high, b.high) && is_less(a.low, b.low)
    }

    pub fn is_coprime_to(self, other: Self) -> bool {
        let (a, b) = (self.exponents(), other.exponents());
        // The high bit of each lane that is not 0.
        let occurring = |exponents: u128| (exponents + (HIGH_BITS - ONES)) & HIGH_BITS;
        occurring(a.high) & occurring(b.high) == 0 && occurring(a.low) & occurring(b.low) == 0
    }

    /// The product; its degree must not exceed the highest.
    pub fn times(self, other: Self) -> Self {
        Self {
            high: self.high + other.high,
            low: self.low + other.low,
        }
    }

    /// The quotient by a divisor.
    pub fn over(self, divisor: Self) -> Self {
        Self {
            high: self.high - divisor.high,
            low: self.low - divisor.low,
        }
    }

    /// The least common multiple; `None` where its degree is too high.
    pub fn common_multiple(self, other: Self) -> Option<Self> {
        let (a, b) = (self.exponents(), other.exponents());
        let mut sums = [0u16; MOST_VARIABLES];
        let mut sum = 0u32;
        for (lane, degrees) in sums.iter_mut().enumerate() {
            let exponent = |exponents: Self| {
                let word = if lane < LANES {
                    exponents.low
                } else {
                    exponents.high
                };
                (word >> (LANE * (lane % LANES) as u32)) as u32 & 0xffff
            };
            sum += exponent(a).max(exponent(b));
            *degrees = u16::try_from(sum)
                .ok()
                .filter(|&sum| u32::from(sum) <= MOST_DEGREE)?;
        }
        Some(Self::from_lanes(sums))
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
        assert_eq!(Monomial::new(&[32_000, 768]), None);
        assert_eq!(Monomial::new(&[200, 150]).map(Monomial::degree), Some(350));
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
        // Nine variables and more are in both words.
        let sixteen = |k: u32| {
            let exponents: Vec<u32> = (0..16).map(|j| (j * 37 + k) % 5 * 100).collect();
            (Monomial::new(&exponents).unwrap(), exponents)
        };
        let ((a16, a_exponents), (b16, b_exponents)) = (sixteen(0), sixteen(1));
        let both = a16.times(b16);
        let multiple = a16.common_multiple(b16).unwrap();
        for k in 0..16 {
            assert_eq!(both.exponent(16, k), a_exponents[k] + b_exponents[k]);
            assert_eq!(multiple.exponent(16, k), a_exponents[k].max(b_exponents[k]));
        }
        assert_eq!(both.over(b16), a16);
        assert!(a16.divides(multiple) && b16.divides(multiple) && !a16.divides(b16));
        assert!(!a16.is_coprime_to(b16));
        assert!(Monomial::variable(16, 3).is_coprime_to(Monomial::variable(16, 12)));
        assert_eq!((a.degree(), Monomial::default().degree()), (3, 0));
    }
}
