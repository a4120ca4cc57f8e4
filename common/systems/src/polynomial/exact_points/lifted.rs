//! Lifted: polynomials with rational coefficients, put together from their images modulo primes.

use super::image::{ClassImage, Image};
use super::rational_equations::residue;
use crate::polynomial::solution_count::groebner::Budget;
use crate::polynomial::solution_count::prime_field::PrimeField;
use cognate_numeric::rational::Rational;
use rug::Integer;
use rug::ops::RemRounding;

/// Coefficients are read after the first primes, and again after this many times as many.
const MORE_PRIMES: f64 = 1.3;
/// A fraction is believed where numerator and denominator together have this many bits less than the primes.
const SPARE_BITS: u32 = 16;

/// The solutions of one multiplicity.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LiftedClass {
    pub multiplicity: u64,
    /// Polynomial whose roots are the values of the linear form, without the leading coefficient, which is 1.
    pub polynomial: Vec<Rational>,
    /// For each unknown, a polynomial: divided by the derivative of `polynomial`, it is the value of the unknown at
    /// each root.
    pub numerators: Vec<Vec<Rational>>,
}

/// Images put together.
pub(super) struct Lifted {
    /// Multiplicities and degrees of the first image.
    shape: Vec<(u64, usize)>,
    unknowns: usize,
    /// Product of the primes.
    modulus: Integer,
    /// All coefficients in the order of [`coefficients_of`].
    coefficients: Vec<Integer>,
    primes: usize,
    /// Number of primes after which the coefficients are read next.
    read_at: usize,
    classes: Option<Vec<LiftedClass>>,
}

fn shape_of(image: &Image) -> Vec<(u64, usize)> {
    let classes = image.classes.iter();
    classes
        .map(|class| (class.multiplicity, class.polynomial.len() - 1))
        .collect()
}

/// For each class, the polynomial without its leading coefficient, then the numerators.
fn coefficients_of(class: &ClassImage) -> impl Iterator<Item = u64> + '_ {
    let degree = class.polynomial.len() - 1;
    let polynomial = class.polynomial[..degree].iter();
    polynomial.chain(class.numerators.iter().flatten()).copied()
}

impl Lifted {
    pub fn new(image: Image) -> Self {
        let unknowns = image
            .classes
            .first()
            .map_or(0, |class| class.numerators.len());
        let coefficients = image.classes.iter().flat_map(coefficients_of);
        Self {
            shape: shape_of(&image),
            unknowns,
            modulus: Integer::from(image.field.prime()),
            coefficients: coefficients.map(Integer::from).collect(),
            primes: 1,
            read_at: 2,
            classes: image.classes.is_empty().then(Vec::new),
        }
    }

    /// Whether an image has as many solutions of each multiplicity.
    pub fn fits(&self, image: &Image) -> bool {
        self.shape == shape_of(image)
    }

    /// All solutions.
    ///
    /// # Panics
    /// Before [`Self::take`] said that they are there.
    pub fn classes(&self) -> &[LiftedClass] {
        self.classes
            .as_deref()
            .expect("an image confirmed the coefficients")
    }

    /// Takes one more image; whether it confirms what was read from the others. `None` where the budget is spent.
    pub fn take(&mut self, image: &Image, budget: &mut Budget) -> Option<bool> {
        let field = image.field;
        if self
            .classes
            .as_ref()
            .is_some_and(|classes| are_those_of(classes, image))
        {
            return Some(true);
        }
        self.classes = None;
        let words = self.primes.div_ceil(2);
        budget.take(8 * words * self.coefficients.len())?;
        let residue = |number: &Integer| u64::from(number.mod_u(field.prime() as u32));
        let inverse = field.inverse(residue(&self.modulus))?;
        let of_image = image.classes.iter().flat_map(coefficients_of);
        for (number, next) in self.coefficients.iter_mut().zip(of_image) {
            let difference = field.subtract(next, residue(number));
            let step = field.multiply(difference, inverse);
            *number += Integer::from(&self.modulus * step);
        }
        self.modulus *= field.prime();
        self.primes += 1;
        if self.primes >= self.read_at {
            self.read_at = (self.primes as f64 * MORE_PRIMES) as usize + 1;
            self.classes = self.read(budget)?;
        }
        Some(false)
    }

    /// The rational coefficients, where there are primes enough.
    fn read(&self, budget: &mut Budget) -> Option<Option<Vec<LiftedClass>>> {
        let words = self.primes.div_ceil(2);
        let mut reader = Reader::new(&self.modulus);
        let mut numbers = self.coefficients.iter();
        let mut classes = Vec::new();
        for &(multiplicity, degree) in &self.shape {
            let mut read = |count: usize, budget: &mut Budget| -> Option<Option<Vec<Rational>>> {
                let mut rationals = Vec::with_capacity(count);
                for number in numbers.by_ref().take(count) {
                    budget.take(64 + 8 * words * words)?;
                    match reader.rational(number) {
                        Some(rational) => rationals.push(rational),
                        None => return Some(None),
                    }
                }
                Some(Some(rationals))
            };
            let Some(polynomial) = read(degree, budget)? else {
                return Some(None);
            };
            let mut numerators = Vec::new();
            for _ in 0..self.unknowns {
                match read(degree, budget)? {
                    Some(numerator) => numerators.push(numerator),
                    None => return Some(None),
                }
            }
            classes.push(LiftedClass {
                multiplicity,
                polynomial,
                numerators,
            });
        }
        Some(Some(classes))
    }
}

/// Whether an image is that of these polynomials.
fn are_those_of(classes: &[LiftedClass], image: &Image) -> bool {
    let field: PrimeField = image.field;
    let is_image = |rationals: &[Rational], residues: &[u64]| {
        let pairs = rationals.iter().zip(residues);
        rationals.len() <= residues.len()
            && pairs
                .into_iter()
                .all(|(rational, &r)| residue(field, rational) == Some(r))
    };
    let mut pairs = classes.iter().zip(&image.classes);
    pairs.all(|(class, image)| {
        let mut numerators = class.numerators.iter().zip(&image.numerators);
        is_image(&class.polynomial, &image.polynomial)
            && numerators.all(|(rationals, residues)| is_image(rationals, residues))
    })
}

/// Reads fractions from residues, most of which have a denominator in common with those before.
struct Reader<'a> {
    modulus: &'a Integer,
    /// Least number of no interest: half of the bits of the modulus.
    bound: Integer,
    /// Common denominator of the fractions so far.
    denominator: Integer,
}

impl<'a> Reader<'a> {
    fn new(modulus: &'a Integer) -> Self {
        Self {
            modulus,
            bound: Integer::from(modulus >> SPARE_BITS).sqrt(),
            denominator: Integer::from(1),
        }
    }

    /// The fraction with this residue whose numerator and denominator are small (P. Wang, M. Guy, J. Davenport, p-adic
    /// reconstruction of rational numbers, 1982).
    fn rational(&mut self, residue: &Integer) -> Option<Rational> {
        let multiple = Integer::from(residue * &self.denominator).rem_euc(self.modulus);
        let negative = Integer::from(self.modulus - &multiple);
        for (size, sign) in [(&multiple, 1), (&negative, -1)] {
            if *size < self.bound {
                let numerator = Integer::from(size * sign);
                return Some(Rational::from((numerator, self.denominator.clone())));
            }
        }
        let (mut larger, mut smaller) = (self.modulus.clone(), multiple);
        let (mut of_larger, mut of_smaller) = (Integer::new(), Integer::from(1));
        while smaller >= self.bound {
            let (quotient, rest) = larger.div_rem_ref(&smaller).into();
            let quotient: Integer = quotient;
            let factor = of_larger - Integer::from(&quotient * &of_smaller);
            (of_larger, of_smaller) = (of_smaller, factor);
            (larger, smaller) = (smaller, rest);
        }
        if of_smaller == 0 || *of_smaller.as_abs() >= self.bound {
            return None;
        }
        self.denominator *= of_smaller.clone().abs();
        if self.denominator >= self.bound {
            return None;
        }
        let numerator = if of_smaller < 0 { -smaller } else { smaller };
        Some(Rational::from((numerator, self.denominator.clone())))
    }
}
