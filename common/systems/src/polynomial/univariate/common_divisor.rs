//! The greatest common divisor of two exact polynomials, from its images modulo primes.
//!
//! An image has at least the degree of the divisor, so that one of degree 0 proves that there is none. Otherwise images of
//! the least degree are put together by the Chinese remainder theorem until the polynomial divides both, which proves it
//! (W. S. Brown, On Euclid's algorithm and the computation of polynomial greatest common divisors, 1971).

use super::exact_polynomial::ExactPolynomial;
use super::gaussian::GaussianInteger;
use crate::polynomial::modular::Field;
use rug::Integer;

/// Primes begin below this: a product of two residues has 122 bits.
const BELOW: u64 = 1 << 61;

/// The greatest common divisor; 1 where there is none, and the other polynomial where one is 0.
pub(super) fn common_divisor(a: &ExactPolynomial, b: &ExactPolynomial) -> ExactPolynomial {
    if a.is_zero() || b.is_zero() {
        return if a.is_zero() { b } else { a }.clone();
    }
    let leading = leading_multiple(a, b);
    let mut lifted = Lifted::default();
    for field in PrimeFields::default() {
        let Some(image) = Image::of(field, [a, b], &leading) else {
            continue; // the prime divides a leading coefficient
        };
        if image.degree() == 0 {
            break;
        }
        let is_stable = lifted.take(&image);
        if is_stable && let Some(divisor) = lifted.divisor_of(a, b) {
            return divisor;
        }
    }
    ExactPolynomial::primitive(vec![GaussianInteger {
        re: Integer::from(1),
        im: Integer::new(),
    }])
}

/// A multiple of the divisor's leading coefficient.
fn leading_multiple(a: &ExactPolynomial, b: &ExactPolynomial) -> GaussianInteger {
    let (x, y) = (a.leading(), b.leading());
    if a.is_real() && b.is_real() {
        let re = Integer::from(x.re.gcd_ref(&y.re));
        let im = Integer::new();
        return GaussianInteger { re, im };
    }
    if x.bits() <= y.bits() { x } else { y }.clone()
}

/// Prime fields with a square root of -1, the largest primes below 2^61 first.
#[derive(Default)]
struct PrimeFields {
    /// Numbers 1 modulo 4 that were looked at.
    seen: u64,
}

impl Iterator for PrimeFields {
    type Item = Field;

    fn next(&mut self) -> Option<Field> {
        loop {
            self.seen += 1;
            let number = BELOW + 1 - 4 * self.seen;
            if Integer::from(number).is_probably_prime(30) != rug::integer::IsPrime::No
                && let Some(field) = with_root_of_minus_one(number)
            {
                return Some(field);
            }
        }
    }
}

/// The power (p - 1)/4 of a number that is no square is a root of -1.
fn with_root_of_minus_one(prime: u64) -> Option<Field> {
    let field = Field { prime, i: 0 };
    let roots = (2..200).map(|n| field.power(n, (prime - 1) / 4));
    let i = roots.into_iter().find(|&r| field.mul(r, r) == prime - 1)?;
    Some(Field { prime, i })
}

/// The divisor times the leading multiple, modulo a prime: both parts of each coefficient.
struct Image {
    field: Field,
    parts: Vec<[u64; 2]>,
}

impl Image {
    /// `None` where the degree of a polynomial falls, or the two roots of -1 give other degrees.
    fn of(
        field: Field,
        polynomials: [&ExactPolynomial; 2],
        leading: &GaussianInteger,
    ) -> Option<Self> {
        let image = |field: Field| -> Option<Vec<u64>> {
            let of_one = |p: &ExactPolynomial| {
                let residues: Option<Vec<u64>> = p
                    .coefficients
                    .iter()
                    .map(|c| field.complex(&c.to_rational()))
                    .collect();
                residues.filter(|residues| residues.last() != Some(&0))
            };
            let divisor = euclid(field, of_one(polynomials[0])?, of_one(polynomials[1])?)?;
            let leading = field.complex(&leading.to_rational())?;
            (leading != 0).then(|| divisor.iter().map(|&c| field.mul(c, leading)).collect())
        };
        let first = image(field)?;
        if polynomials.iter().all(|p| p.is_real()) {
            let parts = first.into_iter().map(|c| [c, 0]).collect();
            return Some(Self { field, parts });
        }
        let conjugate = Field {
            i: field.prime - field.i,
            ..field
        };
        let second = image(conjugate)?;
        if second.len() != first.len() {
            return None;
        }
        let half = field.inverse(2)?;
        let half_of_i = field.mul(half, field.inverse(field.i)?);
        let parts = first.iter().zip(&second).map(|(&a, &b)| {
            let re = field.mul(field.add(a, b), half);
            [re, field.mul(field.sub(a, b), half_of_i)]
        });
        Some(Self {
            field,
            parts: parts.collect(),
        })
    }

    fn degree(&self) -> usize {
        self.parts.len() - 1
    }
}

/// The monic greatest common divisor modulo a prime.
fn euclid(field: Field, mut a: Vec<u64>, mut b: Vec<u64>) -> Option<Vec<u64>> {
    while let Some(&leading) = b.last() {
        let inverse = field.inverse(leading)?;
        while a.len() >= b.len() {
            let top = *a.last()?;
            let factor = field.mul(top, inverse);
            let place = a.len() - b.len();
            for (x, &y) in a[place..].iter_mut().zip(&b) {
                *x = field.sub(*x, field.mul(factor, y));
            }
            while a.last() == Some(&0) {
                a.pop();
            }
        }
        std::mem::swap(&mut a, &mut b);
    }
    let inverse = field.inverse(*a.last()?)?;
    Some(a.iter().map(|&c| field.mul(c, inverse)).collect())
}

/// Images of one degree put together.
#[derive(Default)]
struct Lifted {
    modulus: Integer,
    parts: Vec<[Integer; 2]>,
}

impl Lifted {
    /// Takes one more image; whether it changed nothing. Images of a larger degree than others are of unlucky primes.
    fn take(&mut self, image: &Image) -> bool {
        let field = image.field;
        if self.parts.is_empty() || image.parts.len() < self.parts.len() {
            let number = |&[re, im]: &[u64; 2]| [re, im].map(Integer::from);
            self.parts = image.parts.iter().map(number).collect();
            self.modulus = Integer::from(field.prime);
            self.centre();
            return false;
        }
        if image.parts.len() > self.parts.len() {
            return false;
        }
        let residue = |n: &Integer| {
            let n = GaussianInteger {
                re: n.clone(),
                im: Integer::new(),
            };
            field.complex(&n.to_rational())
        };
        let Some(inverse) = residue(&self.modulus).and_then(|m| field.inverse(m)) else {
            return false;
        };
        let mut is_stable = true;
        for (parts, images) in self.parts.iter_mut().zip(&image.parts) {
            for (part, &image) in parts.iter_mut().zip(images) {
                let present = residue(part).unwrap_or_default();
                let step = field.mul(field.sub(image, present), inverse);
                if step != 0 {
                    is_stable = false;
                    *part += Integer::from(&self.modulus * step);
                }
            }
        }
        self.modulus *= field.prime;
        self.centre();
        is_stable
    }

    /// Takes the residues of least size.
    fn centre(&mut self) {
        let half = Integer::from(&self.modulus >> 1);
        for part in self.parts.iter_mut().flatten() {
            if *part > half {
                *part -= &self.modulus;
            }
        }
    }

    /// The polynomial without its content, where it divides both.
    fn divisor_of(&self, a: &ExactPolynomial, b: &ExactPolynomial) -> Option<ExactPolynomial> {
        let coefficients = self.parts.iter().map(|[re, im]| GaussianInteger {
            re: re.clone(),
            im: im.clone(),
        });
        let divisor = ExactPolynomial::primitive(coefficients.collect());
        a.divided_by(&divisor)?;
        b.divided_by(&divisor)?;
        Some(divisor)
    }
}
