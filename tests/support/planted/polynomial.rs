//! Polynomials with exact rational coefficients, as far as planted systems need them: products,
//! linear substitutions, and text that every reader takes.

use cognate_numeric::rational::{ComplexRational, Rational};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A polynomial in a fixed number of variables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Polynomial {
    variables: usize,
    /// Coefficient by exponents; none is 0.
    terms: BTreeMap<Vec<u32>, Rational>,
}

impl Polynomial {
    /// A constant.
    pub fn constant(variables: usize, value: Rational) -> Self {
        let mut terms = BTreeMap::new();
        if value != 0 {
            terms.insert(vec![0; variables], value);
        }
        Self { variables, terms }
    }

    /// The variable with this index.
    pub fn variable(variables: usize, index: usize) -> Self {
        let mut exponents = vec![0; variables];
        exponents[index] = 1;
        Self {
            variables,
            terms: BTreeMap::from([(exponents, Rational::from(1))]),
        }
    }

    /// The linear form with these coefficients of the variables and this constant.
    pub fn linear(coefficients: &[Rational], constant: Rational) -> Self {
        let n = coefficients.len();
        let mut sum = Self::constant(n, constant);
        for (index, c) in coefficients.iter().enumerate() {
            sum = sum.plus(&Self::variable(n, index).times(&Self::constant(n, c.clone())));
        }
        sum
    }

    /// The sum of both.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        for (exponents, c) in &other.terms {
            let term = sum.terms.entry(exponents.clone()).or_default();
            *term += c;
            if *term == 0 {
                sum.terms.remove(exponents);
            }
        }
        sum
    }

    /// The difference of both.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.times(&Self::constant(self.variables, Rational::from(-1))))
    }

    /// The product of both.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::constant(self.variables, Rational::new());
        for (a, c) in &self.terms {
            for (b, d) in &other.terms {
                let exponents: Vec<u32> = a.iter().zip(b).map(|(a, b)| a + b).collect();
                let term = product.terms.entry(exponents).or_default();
                *term += Rational::from(c * d);
            }
        }
        product.terms.retain(|_, c| *c != 0);
        product
    }

    /// A power of it.
    #[must_use]
    pub fn power(&self, exponent: u32) -> Self {
        let one = Self::constant(self.variables, Rational::from(1));
        (0..exponent).fold(one, |product, _| product.times(self))
    }

    /// With each variable replaced by a polynomial, all of them in equally many variables.
    #[must_use]
    pub fn substituted(&self, values: &[Self]) -> Self {
        let n = values[0].variables;
        let mut sum = Self::constant(n, Rational::new());
        for (exponents, c) in &self.terms {
            let mut product = Self::constant(n, c.clone());
            for (value, &e) in values.iter().zip(exponents) {
                product = product.times(&value.power(e));
            }
            sum = sum.plus(&product);
        }
        sum
    }

    /// Value of the polynomial at a point.
    pub fn at(&self, point: &[ComplexRational]) -> ComplexRational {
        let terms = self.terms.iter().map(|(exponents, c)| {
            let powers = point.iter().zip(exponents);
            powers.fold(ComplexRational::real(c.clone()), |product, (x, &e)| {
                product.multiply(&x.power(e))
            })
        });
        terms.fold(ComplexRational::default(), |sum, term| sum.add(&term))
    }

    /// The largest sum of exponents of a term.
    pub fn degree(&self) -> u32 {
        let degrees = self.terms.keys().map(|exponents| exponents.iter().sum());
        degrees.max().unwrap_or(0)
    }

    /// All its terms, as text.
    pub fn text(&self, names: &[String]) -> String {
        let mut text = String::new();
        for (exponents, c) in self.terms.iter().rev() {
            let sign = if *c < 0 { "-" } else { "+" };
            let size = c.clone().abs();
            if !(text.is_empty() && sign == "+") {
                text.push_str(sign);
            }
            match size.denom() == &1 {
                true => write!(text, "{}", size.numer()),
                false => write!(text, "{}/{}", size.numer(), size.denom()),
            }
            .expect("text takes all");
            for (name, &e) in names.iter().zip(exponents) {
                match e {
                    0 => Ok(()),
                    1 => write!(text, "*{name}"),
                    e => write!(text, "*{name}^{e}"),
                }
                .expect("text takes all");
            }
        }
        if text.is_empty() { "0".into() } else { text }
    }
}
