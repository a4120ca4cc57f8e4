//! Power series in a few variables, truncated above an order.

use super::field::Field;
use std::collections::HashMap;

/// Series over a field: monomials up to an order, and what their products are.
pub struct SeriesSpace<'a, F: Field> {
    /// The field of the coefficients.
    pub field: &'a F,
    /// Number of variables.
    pub variables: usize,
    /// Highest degree that is kept.
    pub order: usize,
    /// Exponents of the monomials, by degree.
    pub monomials: Vec<Vec<u8>>,
    /// Number of monomials up to each degree.
    pub up_to: Vec<usize>,
    /// Number of the product of every two monomials; `u32::MAX` if the product is not kept.
    products: Vec<u32>,
}

/// Coefficients of the monomials of a space.
pub type Series<E> = Vec<E>;

impl<'a, F: Field> SeriesSpace<'a, F> {
    /// Series in `variables` variables up to an order.
    pub fn new(field: &'a F, variables: usize, order: usize) -> Self {
        let mut monomials: Vec<Vec<u8>> = vec![vec![0; variables]];
        let mut up_to = vec![1];
        let mut first = 0;
        for _ in 0..order {
            let end = monomials.len();
            for k in first..end {
                // Each monomial once: by its last variable.
                let last = monomials[k].iter().rposition(|e| *e > 0).unwrap_or(0);
                for v in last..variables {
                    let mut next = monomials[k].clone();
                    next[v] += 1;
                    monomials.push(next);
                }
            }
            first = end;
            up_to.push(monomials.len());
        }
        let place: HashMap<&Vec<u8>, u32> = monomials.iter().zip(0u32..).collect();
        let mut products = Vec::with_capacity(monomials.len() * monomials.len());
        for a in &monomials {
            for b in &monomials {
                let product: Vec<u8> = a.iter().zip(b).map(|(x, y)| x + y).collect();
                products.push(place.get(&product).copied().unwrap_or(u32::MAX));
            }
        }
        Self {
            field,
            variables,
            order,
            monomials,
            up_to,
            products,
        }
    }

    /// The number of the product of two monomials, where it is kept.
    pub fn product(&self, a: usize, b: usize) -> Option<usize> {
        let product = self.products[a * self.monomials.len() + b];
        (product != u32::MAX).then_some(product as usize)
    }

    /// The series of a number.
    pub fn constant(&self, value: F::Element) -> Series<F::Element> {
        let mut series = vec![self.field.zero(); self.monomials.len()];
        series[0] = value;
        series
    }

    /// The series of a variable.
    pub fn variable(&self, v: usize) -> Series<F::Element> {
        let mut series = self.constant(self.field.zero());
        if let Some(one) = series.get_mut(1 + v) {
            *one = self.field.one();
        }
        series
    }

    /// a + b.
    pub fn add(&self, a: &[F::Element], b: &[F::Element]) -> Series<F::Element> {
        let both = a.iter().zip(b);
        both.map(|(x, y)| self.field.add(*x, *y)).collect()
    }

    /// a - b.
    pub fn subtract(&self, a: &[F::Element], b: &[F::Element]) -> Series<F::Element> {
        let both = a.iter().zip(b);
        both.map(|(x, y)| self.field.subtract(*x, *y)).collect()
    }

    /// a times a number.
    pub fn scale(&self, a: &[F::Element], factor: F::Element) -> Series<F::Element> {
        let terms = a.iter();
        terms.map(|x| self.field.multiply(*x, factor)).collect()
    }

    /// a b.
    pub fn multiply(&self, a: &[F::Element], b: &[F::Element]) -> Series<F::Element> {
        let zero = self.field.zero();
        let mut product = vec![zero; self.monomials.len()];
        for (i, x) in a.iter().enumerate().filter(|(_, x)| **x != zero) {
            for (j, y) in b.iter().enumerate().filter(|(_, y)| **y != zero) {
                if let Some(k) = self.product(i, j) {
                    let term = self.field.multiply(*x, *y);
                    product[k] = self.field.add(product[k], term);
                }
            }
        }
        product
    }

    /// 1/a, where a is not 0 at the origin: 1/(c (1 + r)) as a geometric series.
    pub fn inverse(&self, a: &[F::Element]) -> Series<F::Element> {
        let over = self.field.inverse(a[0]);
        let one = self.constant(self.field.one());
        let rest = self.subtract(&one, &self.scale(a, over));
        let mut sum = one.clone();
        for _ in 0..self.order {
            sum = self.add(&one, &self.multiply(&rest, &sum));
        }
        self.scale(&sum, over)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::field::Residues;

    #[test]
    fn inverses_are_inverses() {
        let field = Residues::of(&[], 0).expect("a field");
        let space = SeriesSpace::new(&field, 3, 5);
        assert_eq!(space.up_to, vec![1, 4, 10, 20, 35, 56]);
        let mut a = space.constant(7);
        for v in 0..3 {
            let x = space.variable(v);
            a = space.add(&a, &space.multiply(&a, &x));
        }
        let product = space.multiply(&a, &space.inverse(&a));
        assert_eq!(product, space.constant(1));
    }
}
