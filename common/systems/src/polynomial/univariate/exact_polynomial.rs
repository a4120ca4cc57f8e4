//! ExactPolynomial: a polynomial in one unknown with Gaussian integers as coefficients, up to a constant factor.

use super::gaussian::GaussianInteger;
use cognate_numeric::rational::{ComplexRational, Rational};
use rug::Integer;

/// Coefficients from that of 1 to the leading one, which is not 0; none of the zero polynomial. No integer but 1 divides
/// all of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ExactPolynomial {
    pub coefficients: Vec<GaussianInteger>,
}

impl ExactPolynomial {
    /// The polynomial with these coefficients times a positive rational number.
    pub fn from_rationals(coefficients: &[ComplexRational]) -> Self {
        let mut denominator = Integer::from(1);
        for c in coefficients {
            denominator.lcm_mut(c.re.denom());
            denominator.lcm_mut(c.im.denom());
        }
        let whole = |part: &Rational| {
            let factor = Integer::from(&denominator / part.denom());
            factor * part.numer()
        };
        let coefficients = coefficients.iter().map(|c| GaussianInteger {
            re: whole(&c.re),
            im: whole(&c.im),
        });
        Self::primitive(coefficients.collect())
    }

    /// The polynomial with these coefficients without the largest integer that divides them.
    pub fn primitive(mut coefficients: Vec<GaussianInteger>) -> Self {
        while coefficients.last().is_some_and(GaussianInteger::is_zero) {
            coefficients.pop();
        }
        let mut content = Integer::new();
        for c in &coefficients {
            content.gcd_mut(&c.re);
            content.gcd_mut(&c.im);
            if content == 1 {
                return Self { coefficients };
            }
        }
        for c in &mut coefficients {
            c.re.div_exact_mut(&content);
            c.im.div_exact_mut(&content);
        }
        Self { coefficients }
    }

    /// The degree; 0 of the zero polynomial, too.
    pub fn degree(&self) -> usize {
        self.coefficients.len().saturating_sub(1)
    }

    pub fn is_zero(&self) -> bool {
        self.coefficients.is_empty()
    }

    pub fn is_real(&self) -> bool {
        self.coefficients.iter().all(|c| c.im == 0)
    }

    /// The leading coefficient.
    ///
    /// # Panics
    /// Where the polynomial is 0.
    pub fn leading(&self) -> &GaussianInteger {
        let leading = self.coefficients.last();
        leading.expect("a polynomial that is not 0 has a leading coefficient")
    }

    /// Multiplicity of the root 0, and the polynomial without it.
    pub fn without_zero_root(&self) -> (u32, Self) {
        let zeros = self.coefficients.iter().take_while(|c| c.is_zero()).count();
        let coefficients = self.coefficients[zeros..].to_vec();
        (zeros as u32, Self { coefficients })
    }

    pub fn derivative(&self) -> Self {
        let each = self.coefficients.iter().zip(0..).skip(1);
        Self::primitive(each.map(|(c, k)| c.times_integer(k)).collect())
    }

    /// The polynomial whose roots are the conjugates of these.
    pub fn conjugate(&self) -> Self {
        let each = self.coefficients.iter().map(GaussianInteger::conjugate);
        Self {
            coefficients: each.collect(),
        }
    }

    /// The polynomial whose roots are the mirror images of these in the imaginary axis: -z̄ for each root z.
    pub fn mirrored(&self) -> Self {
        let each = self.coefficients.iter().zip(0..);
        let coefficients = each.map(|(c, k): (_, usize)| match k.is_multiple_of(2) {
            true => c.conjugate(),
            false => c.conjugate().negate(),
        });
        Self {
            coefficients: coefficients.collect(),
        }
    }

    /// Multiplies the polynomial by a Gaussian integer that makes the leading coefficient positive.
    pub fn with_positive_leading(&self) -> Self {
        if self.is_zero() {
            return self.clone();
        }
        let factor = self.leading().conjugate();
        let each = self.coefficients.iter().map(|c| c.times(&factor));
        Self::primitive(each.collect())
    }

    /// The quotient by a divisor, up to a constant factor; `None` where the division leaves a remainder.
    ///
    /// # Panics
    /// Where the divisor is 0.
    pub fn divided_by(&self, divisor: &Self) -> Option<Self> {
        match self.is_real() && divisor.is_real() {
            true => self.divided_by_real(divisor),
            false => self.divided_by_complex(divisor),
        }
    }

    /// A primitive divisor of an integer polynomial has an integer quotient (the lemma of Gauss).
    fn divided_by_real(&self, divisor: &Self) -> Option<Self> {
        let leading = &divisor.leading().re;
        let degree = divisor.degree();
        let mut rest: Vec<Integer> = self.coefficients.iter().map(|c| c.re.clone()).collect();
        let mut quotient = Vec::new();
        while rest.len() > degree {
            let top = rest.pop().expect("longer than the divisor");
            if !top.is_divisible(leading) {
                return None;
            }
            let factor = top.div_exact(leading);
            let place = rest.len() - degree;
            for (k, c) in divisor.coefficients[..degree].iter().enumerate() {
                rest[place + k] -= Integer::from(&factor * &c.re);
            }
            quotient.push(GaussianInteger {
                re: factor,
                im: Integer::new(),
            });
        }
        quotient.reverse();
        let is_exact = rest.iter().all(|c| *c == 0);
        is_exact.then(|| Self::primitive(quotient))
    }

    fn divided_by_complex(&self, divisor: &Self) -> Option<Self> {
        let rational = |p: &Self| -> Vec<ComplexRational> {
            let each = p.coefficients.iter();
            each.map(GaussianInteger::to_rational).collect()
        };
        let divisor = rational(divisor);
        let (leading, lower) = divisor.split_last()?;
        let inverse = ComplexRational::real(1).divide(leading)?;
        let mut rest = rational(self);
        let mut quotient = Vec::new();
        while rest.len() > lower.len() {
            let factor = rest.pop()?.multiply(&inverse);
            let place = rest.len() - lower.len();
            for (k, c) in lower.iter().enumerate() {
                rest[place + k] = rest[place + k].subtract(&factor.multiply(c));
            }
            quotient.push(factor);
        }
        quotient.reverse();
        let is_exact = rest.iter().all(ComplexRational::is_zero);
        is_exact.then(|| Self::from_rationals(&quotient))
    }
}
