//! The ladder itself: what a rung is. When to change rung is `continuation`'s business.

/// Bits of hardware doubles, the first rung.
pub const DOUBLE: u32 = 53;
/// Bits of double-doubles, the second.
pub const DOUBLE_DOUBLE: u32 = 106;

/// Unit roundoff 2^-bits; 0 where that is below all doubles.
pub fn unit_roundoff(bits: u32) -> f64 {
    // Exact: powers of two down to 2^-1074, never from libm.
    (0..bits.min(1100)).fold(1.0, |u, _| u * 0.5)
}

/// Bits of the rungs from `lowest` to `highest`: doubles, double-doubles, then MPFR with twice the
/// bits each time. At least one; the first has at least `lowest` bits.
pub fn rungs(lowest: u32, highest: u32) -> impl Iterator<Item = u32> {
    let first = if lowest <= DOUBLE {
        DOUBLE
    } else {
        lowest.max(DOUBLE_DOUBLE)
    };
    std::iter::successors(Some(first), move |&bits| {
        let next = match bits {
            DOUBLE => DOUBLE_DOUBLE,
            // A rung that is hardly higher than the one below is not worth its steps.
            more => match more.saturating_mul(2) {
                double if double > highest && highest >= more + more / 4 => highest,
                double => double,
            },
        };
        (next > bits && next <= highest).then_some(next)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_roundoff_of_doubles_is_half_an_epsilon() {
        assert_eq!(unit_roundoff(DOUBLE), f64::EPSILON / 2.0);
        assert_eq!(unit_roundoff(u32::MAX), 0.0);
    }

    #[test]
    fn rungs_double_up_to_the_limit() {
        let list = |low, high| rungs(low, high).collect::<Vec<u32>>();
        assert_eq!(list(53, 53), [53]);
        assert_eq!(list(53, 106), [53, 106]);
        assert_eq!(list(53, 1024), [53, 106, 212, 424, 848]);
        assert_eq!(list(53, 512), [53, 106, 212, 424]);
        assert_eq!(list(64, 64), [106]);
        assert_eq!(list(150, 400), [150, 300, 400]);
        assert_eq!(list(u32::MAX, u32::MAX), [u32::MAX]);
    }
}
