//! Fields in which the conditions of a mechanism are evaluated: residues modulo a prime, and complex doubles.

use cognate_kinematics::mechanism::exact::{Number, Surd};
use cognate_numeric::rational::Rational;
use num_complex::Complex64;
use std::collections::BTreeSet;

/// Largest trial divisor of radicands: the rest of a radicand above its square must be a square.
const MOST_DIVISOR: u64 = 100_000;
/// Residues are modulo a prime below this power of 2.
const PRIME_BITS: u32 = 61;
/// Primes that are tried, one after the other, until all roots exist; each has one chance in 2 for every root.
const MOST_PRIMES: usize = 100_000;

/// A number of a file or a configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// The nearest double.
    pub double: f64,
    /// The number itself, where it is known.
    pub exact: Option<Surd>,
}

impl Constant {
    /// A rational number.
    pub fn rational(value: Rational) -> Self {
        let number = Number::rational(value);
        Self::of(&number)
    }

    /// A small integer.
    pub fn integer(n: i64) -> Self {
        Self::rational(Rational::from(n))
    }

    /// A double near to the number that is meant.
    pub fn rounded(double: f64) -> Self {
        Self {
            double,
            exact: None,
        }
    }

    /// A number as it was read.
    pub fn of(number: &Number) -> Self {
        let root = |surd: &Surd| {
            let number = Number::rational(surd.radicand.clone());
            Number::rational(surd.coefficient.clone()).to_f64() * number.to_f64().sqrt()
        };
        Self {
            double: number.surd.as_deref().map_or_else(|| number.to_f64(), root),
            exact: number.surd.as_deref().cloned(),
        }
    }

    /// The square of the number.
    pub fn square(&self) -> Self {
        match &self.exact {
            Some(surd) => Self::rational(surd.square()),
            None => Self::rounded(self.double * self.double),
        }
    }

    /// The root of a sum of squares.
    pub fn length(vector: &[Self]) -> Self {
        let double = vector.iter().map(|x| x.double * x.double).sum::<f64>();
        let mut square = Some(Rational::new());
        for x in vector {
            let more = x.exact.as_ref().map(Surd::square);
            square = square.zip(more).map(|(sum, more)| sum + more);
        }
        Self {
            double: double.sqrt(),
            exact: square.as_ref().and_then(Surd::root),
        }
    }
}

/// Arithmetic of one field.
pub trait Field {
    /// An element of the field.
    type Element: Copy + PartialEq + std::fmt::Debug;
    /// 0.
    fn zero(&self) -> Self::Element;
    /// 1.
    fn one(&self) -> Self::Element;
    /// a + b.
    fn add(&self, a: Self::Element, b: Self::Element) -> Self::Element;
    /// a - b.
    fn subtract(&self, a: Self::Element, b: Self::Element) -> Self::Element;
    /// a b.
    fn multiply(&self, a: Self::Element, b: Self::Element) -> Self::Element;
    /// 1/a, of an element that is not 0.
    fn inverse(&self, a: Self::Element) -> Self::Element;
    /// A number of the file in this field.
    fn constant(&self, constant: &Constant) -> Self::Element;
}

/// Complex doubles.
#[derive(Clone, Copy, Debug)]
pub struct Doubles;

impl Field for Doubles {
    type Element = Complex64;

    fn zero(&self) -> Complex64 {
        Complex64::default()
    }

    fn one(&self) -> Complex64 {
        Complex64::new(1.0, 0.0)
    }

    fn add(&self, a: Complex64, b: Complex64) -> Complex64 {
        a + b
    }

    fn subtract(&self, a: Complex64, b: Complex64) -> Complex64 {
        a - b
    }

    fn multiply(&self, a: Complex64, b: Complex64) -> Complex64 {
        a * b
    }

    fn inverse(&self, a: Complex64) -> Complex64 {
        1.0 / a
    }

    fn constant(&self, constant: &Constant) -> Complex64 {
        constant.double.into()
    }
}

/// Residues modulo a prime in which the roots of all constants exist. A number with a residue that is not 0 is not 0; a
/// number with the residue 0 is 0 but for odds of about 2^-60.
#[derive(Clone, Debug)]
pub struct Residues {
    prime: u64,
    /// Primes that occur below roots, each with a root of it.
    roots: Vec<(u64, u64)>,
}

impl Residues {
    /// A field for these constants; `None` where one of them is not exact. `skip` primes are passed over.
    pub fn of<'a>(constants: impl IntoIterator<Item = &'a Constant>, skip: usize) -> Option<Self> {
        let mut primes = BTreeSet::new();
        for constant in constants {
            let surd = constant.exact.as_ref()?;
            if surd.radicand != 1 {
                let (numerator, denominator) = (surd.radicand.numer(), surd.radicand.denom());
                let product = numerator.clone() * denominator;
                primes.extend(factors(&product)?.1);
            }
        }
        let below = 1u64 << PRIME_BITS;
        let candidates = (0..).map(|k| below - 1 - 4 * k).filter(|p| is_prime(*p));
        let roots_in = |prime: u64| {
            let field = Self {
                prime,
                roots: Vec::new(),
            };
            let root = |q: &u64| {
                // The square root modulo a prime that is 3 modulo 4.
                let root = field.power(*q, prime.div_ceil(4));
                (field.multiply(root, root) == *q).then_some((*q, root))
            };
            primes.iter().map(root).collect::<Option<Vec<_>>>()
        };
        let mut fields = candidates
            .take(MOST_PRIMES)
            .filter_map(|prime| roots_in(prime).map(|roots| Self { prime, roots }));
        fields.nth(skip)
    }

    fn power(&self, mut base: u64, mut exponent: u64) -> u64 {
        let mut result = 1;
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.multiply(result, base);
            }
            base = self.multiply(base, base);
            exponent >>= 1;
        }
        result
    }

    fn rational(&self, value: &Rational) -> u64 {
        let residue = |n: &_| {
            let n = Rational::from(n).numer().clone();
            let mut rest = n % self.prime;
            if rest < 0 {
                rest += self.prime;
            }
            rest.to_u64().unwrap_or_default()
        };
        let over = residue(value.denom());
        self.multiply(residue(value.numer()), self.inverse(over))
    }
}

impl Field for Residues {
    type Element = u64;

    fn zero(&self) -> u64 {
        0
    }

    fn one(&self) -> u64 {
        1
    }

    fn add(&self, a: u64, b: u64) -> u64 {
        (a + b) % self.prime
    }

    fn subtract(&self, a: u64, b: u64) -> u64 {
        (a + self.prime - b) % self.prime
    }

    fn multiply(&self, a: u64, b: u64) -> u64 {
        (u128::from(a) * u128::from(b) % u128::from(self.prime)) as u64
    }

    fn inverse(&self, a: u64) -> u64 {
        self.power(a, self.prime - 2)
    }

    fn constant(&self, constant: &Constant) -> u64 {
        let Some(surd) = &constant.exact else {
            return 0;
        };
        let mut value = self.rational(&surd.coefficient);
        if surd.radicand != 1 {
            // sqrt(p/q) = sqrt(p q)/q.
            let (numerator, denominator) = (surd.radicand.numer(), surd.radicand.denom());
            let product = numerator.clone() * denominator;
            if let Some((square, primes)) = factors(&product) {
                let over = self.inverse(self.rational(&Rational::from(denominator)));
                value = self.multiply(value, self.multiply(square % self.prime, over));
                for prime in primes {
                    let root = self.roots.iter().find(|(q, _)| *q == prime);
                    value = self.multiply(value, root.map_or(0, |(_, root)| *root));
                }
            }
        }
        value
    }
}

/// A positive integer as a square and different primes: the root of the square, and the primes; `None` where that takes more than
/// [`MOST_DIVISOR`].
fn factors(n: &impl ToString) -> Option<(u64, Vec<u64>)> {
    let mut rest: u128 = n.to_string().parse().ok()?;
    let (mut square, mut primes) = (1u64, Vec::new());
    let mut divisor = 2u128;
    while divisor * divisor <= rest {
        if divisor > u128::from(MOST_DIVISOR) {
            let root = rest.isqrt();
            if root * root == rest {
                return Some((square.checked_mul(root as u64)?, primes));
            }
            return None;
        }
        while rest.is_multiple_of(divisor * divisor) {
            rest /= divisor * divisor;
            square = square.checked_mul(divisor as u64)?;
        }
        if rest.is_multiple_of(divisor) {
            rest /= divisor;
            primes.push(divisor as u64);
        }
        divisor += 1;
    }
    if rest > 1 {
        primes.push(u64::try_from(rest).ok().filter(|q| *q < 1 << 60)?);
    }
    Some((square, primes))
}

/// Miller and Rabin's test with the first twelve primes, which settles it below 2^64 (Sorenson and Webster, Math. Comp. 86, 2017).
fn is_prime(n: u64) -> bool {
    const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    if BASES.iter().any(|b| n.is_multiple_of(*b)) {
        return BASES.contains(&n);
    }
    let field = Residues {
        prime: n,
        roots: Vec::new(),
    };
    let twos = (n - 1).trailing_zeros();
    BASES.iter().all(|base| {
        let mut x = field.power(*base, (n - 1) >> twos);
        if x == 1 || x == n - 1 {
            return true;
        }
        (1..twos).any(|_| {
            x = field.multiply(x, x);
            x == n - 1
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_fit_together() {
        let constants = ["sqrt(2)", "sqrt(3)/2", "sqrt(6)", "sqrt(16/5)", "-3/7"];
        let read = |text: &str| Constant::of(&Number::read(text).expect("a number"));
        let constants = constants.map(read);
        let field = Residues::of(&constants, 0).expect("a field");
        let [two, three, six, _, fraction] = constants.each_ref().map(|c| field.constant(c));
        let twice = field.add(three, three);
        assert_eq!(field.multiply(two, twice), six);
        assert_eq!(field.add(field.multiply(fraction, 7), 3), 0);
        let square = field.constant(&constants[3]);
        assert_eq!(field.multiply(5, field.multiply(square, square)), 16);
        assert!(Residues::of(&[Constant::rounded(0.5)], 0).is_none());
        assert!((constants[1].double - 0.75f64.sqrt()).abs() < 1e-16);
    }
}
