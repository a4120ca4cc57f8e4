//! GaussianInteger: a + b i with integers a and b, the coefficients of exact polynomials.

use cognate_numeric::rational::ComplexRational;
use rug::Integer;

/// `re + i*im`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct GaussianInteger {
    pub re: Integer,
    pub im: Integer,
}

impl GaussianInteger {
    pub fn is_zero(&self) -> bool {
        self.re == 0 && self.im == 0
    }

    pub fn conjugate(&self) -> Self {
        Self {
            re: self.re.clone(),
            im: Integer::from(-&self.im),
        }
    }

    pub fn negate(&self) -> Self {
        Self {
            re: Integer::from(-&self.re),
            im: Integer::from(-&self.im),
        }
    }

    pub fn times(&self, other: &Self) -> Self {
        let re = Integer::from(&self.re * &other.re) - Integer::from(&self.im * &other.im);
        let im = Integer::from(&self.re * &other.im) + Integer::from(&self.im * &other.re);
        Self { re, im }
    }

    pub fn times_integer(&self, factor: u32) -> Self {
        Self {
            re: Integer::from(&self.re * factor),
            im: Integer::from(&self.im * factor),
        }
    }

    pub fn to_rational(&self) -> ComplexRational {
        ComplexRational::new(self.re.clone(), self.im.clone())
    }

    /// Bits of the larger part.
    pub fn bits(&self) -> u32 {
        self.re.significant_bits().max(self.im.significant_bits())
    }
}
