//! Wide: a nonnegative number with 53 bits and an exponent without practical limit, for sizes and radii.

use rug::{Complex, Float};
use std::cmp::Ordering;

/// `mantissa * 2^exponent`, the mantissa 0 or at least 1 and below 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wide {
    mantissa: f64,
    exponent: i64,
}

/// Numbers farther apart than this many powers of two do not change each other's sum.
const NEGLIGIBLE: i64 = 120;

/// 2^exponent for an exponent of a double.
pub(super) fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

impl Wide {
    pub const ZERO: Self = Self {
        mantissa: 0.0,
        exponent: 0,
    };

    /// `value * 2^exponent` for a positive normal double, or 0.
    pub fn new(value: f64, exponent: i64) -> Self {
        if value == 0.0 {
            return Self::ZERO;
        }
        let exponent_of_value = ((value.to_bits() >> 52) & 0x7ff) as i64 - 1023;
        Self {
            mantissa: value * power_of_two(-exponent_of_value),
            exponent: exponent + exponent_of_value,
        }
    }

    pub fn power_of_two(exponent: i64) -> Self {
        Self {
            mantissa: 1.0,
            exponent,
        }
    }

    /// The absolute value, to 53 bits.
    pub fn of_float(value: &Float) -> Self {
        let (mantissa, exponent) = value.to_f64_exp();
        Self::new(mantissa.abs(), i64::from(exponent))
    }

    /// The absolute value, to 50 bits at least.
    pub fn of_complex(value: &Complex) -> Self {
        Self::of_parts(value.real(), value.imag())
    }

    /// The absolute value of `re + i*im`, to 50 bits at least.
    pub fn of_parts(re: &Float, im: &Float) -> Self {
        let (a, b) = (Self::of_float(re), Self::of_float(im));
        let (large, small) = if a < b { (b, a) } else { (a, b) };
        if small.mantissa == 0.0 || large.exponent - small.exponent > NEGLIGIBLE {
            return large;
        }
        let ratio = small.mantissa * power_of_two(small.exponent - large.exponent);
        let square = large.mantissa * large.mantissa + ratio * ratio;
        Self::new(square.sqrt(), large.exponent)
    }

    pub fn times(self, other: Self) -> Self {
        Self::new(
            self.mantissa * other.mantissa,
            self.exponent + other.exponent,
        )
    }

    /// # Panics
    /// Where the divisor is 0.
    pub fn over(self, divisor: Self) -> Self {
        assert!(divisor.mantissa > 0.0, "a size is divided by 0");
        Self::new(
            self.mantissa / divisor.mantissa,
            self.exponent - divisor.exponent,
        )
    }

    pub fn plus(self, other: Self) -> Self {
        let (large, small) = if self < other {
            (other, self)
        } else {
            (self, other)
        };
        if small.mantissa == 0.0 || large.exponent - small.exponent > NEGLIGIBLE {
            return large;
        }
        let scaled = small.mantissa * power_of_two(small.exponent - large.exponent);
        Self::new(large.mantissa + scaled, large.exponent)
    }

    pub fn is_zero(self) -> bool {
        self.mantissa == 0.0
    }

    /// The exponent of the power of two at or below the number.
    pub fn exponent(self) -> i64 {
        self.exponent
    }

    /// The nearest double; infinite or 0 where it is out of their range.
    pub fn to_f64(self) -> f64 {
        match self.exponent {
            _ if self.mantissa == 0.0 => 0.0,
            1024.. => f64::INFINITY,
            -1022..=1023 => self.mantissa * power_of_two(self.exponent),
            _ => 0.0,
        }
    }
}

impl PartialOrd for Wide {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let zeros = (self.mantissa == 0.0, other.mantissa == 0.0);
        match zeros {
            (true, true) => Some(Ordering::Equal),
            (true, false) => Some(Ordering::Less),
            (false, true) => Some(Ordering::Greater),
            (false, false) => {
                let by_exponent = self.exponent.cmp(&other.exponent);
                match by_exponent {
                    Ordering::Equal => self.mantissa.partial_cmp(&other.mantissa),
                    other => Some(other),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_no_overflow() {
        let large = Wide::power_of_two(5000);
        let three = Wide::new(3.0, 0);
        assert_eq!(large.times(three).over(large).to_f64(), 3.0);
        assert_eq!(three.plus(Wide::new(0.5, 1)).to_f64(), 4.0);
        assert_eq!(large.plus(three), large);
        assert!(Wide::ZERO < three && three < large);
        let value = Complex::with_val(100, (3, -4));
        assert_eq!(Wide::of_complex(&value).to_f64(), 5.0);
        assert_eq!((large.to_f64(), Wide::ZERO.to_f64()), (f64::INFINITY, 0.0));
    }
}
