//! The dual space of some power series, order by order, by integration.
//!
//! A functional of order k + 1 vanishes on the ideal exactly if the products of each variable with it
//! lie in the dual space of order k and it vanishes on the equations themselves. So it is sought among the
//! integrals of what is known already: as many unknowns as variables times the dimension so far, instead of one
//! for every monomial (Mourrain: Isolated points, duality and residues, J. Pure Appl. Algebra
//! 117-118, 1997; Zeng: The closedness subspace method for computing the multiplicity structure of a
//! polynomial system, Contemp. Math. 496, 2009).

use super::null_space::null_space;
use super::series::{Monomials, Series};
use super::split::{CUT, rank};
use cognate_numeric::linear_algebra::svd::Svd;
use num_complex::Complex64;

/// Most multiplications in one sweep of a singular value decomposition: more would take a second. Beyond it, columns
/// are made orthogonal once instead.
const MOST_WORK: usize = 40_000_000;
/// Most multiplications to make columns orthogonal once: more would take seconds.
const MOST_WORK_ONCE: usize = 600_000_000;

/// Singular values that count as 0 are below this at most: those of the equations by which functionals are symmetric are
/// about 1.
const LARGEST_CUT: f64 = 0.1;

/// Leading coefficients below this, squared, are rounding errors.
const LEADING: f64 = 1e-12;

/// Functionals of order 0 to k that vanish on the ideal, of equations that begin with order 2.
pub(super) struct DualSpace {
    variables: usize,
    /// For each functional, the coefficients of the derivatives, divided by factorials, by monomials.
    basis: Vec<Series>,
    /// For each functional and each variable, their product in terms of the functionals before it.
    products: Vec<Vec<Vec<Complex64>>>,
}

/// Reason why no more functionals are known.
pub(super) enum Stop {
    /// There are no more functionals: the space is whole.
    Whole,
    /// Finding them would take too long.
    TooLarge,
    /// Errors hide even that products with two variables are the same in either order.
    Noise,
}

impl DualSpace {
    /// The space of order 0 and 1: the value and all first derivatives.
    pub(super) fn new(variables: usize) -> Self {
        let one = Complex64::new(1.0, 0.0);
        let mut basis = vec![vec![one]];
        let mut products = vec![vec![Vec::new(); variables]];
        for v in 0..variables {
            let mut derivative = vec![Complex64::default(); 2 + v];
            derivative[1 + v] = one;
            basis.push(derivative);
            let product = |w: usize| if v == w { vec![one] } else { Vec::new() };
            products.push((0..variables).map(product).collect());
        }
        Self {
            variables,
            basis,
            products,
        }
    }

    /// Dimension of the dual space.
    pub(super) fn dimension(&self) -> usize {
        self.basis.len()
    }

    /// Adds the functionals of one order more. `noise`: how far the equations' coefficients may be off.
    pub(super) fn extend(
        &mut self,
        monomials: &Monomials,
        equations: &[Series],
        noise: f64,
        margin: &mut f64,
    ) -> Result<(), Stop> {
        let (s, mu) = (self.variables, self.basis.len());
        let pairs = s * (s - 1) / 2;
        let rows = pairs * mu + equations.len() + mu;
        // Unknown (v, j): how much of functional j the product of variable v with the new one has.
        let unknowns = s * mu;
        let work = unknowns * unknowns * rows;
        if work > MOST_WORK_ONCE {
            return Err(Stop::TooLarge);
        }
        if CUT * noise > LARGEST_CUT {
            return Err(Stop::Noise);
        }
        let mut columns = vec![vec![Complex64::default(); rows]; unknowns];
        // Products with two variables are the same in either order.
        let mut row = 0;
        for v in 0..s {
            for w in v + 1..s {
                for j in 0..mu {
                    for (l, value) in self.products[j][w].iter().enumerate() {
                        columns[v * mu + j][row + l] += value;
                    }
                    for (l, value) in self.products[j][v].iter().enumerate() {
                        columns[w * mu + j][row + l] -= value;
                    }
                }
                row += mu;
            }
        }
        // These rows exclude the functionals that earlier orders found.
        for (j, products) in self.products.iter().enumerate().skip(1) {
            for (v, product) in products.iter().enumerate() {
                for (l, value) in product.iter().enumerate() {
                    columns[v * mu + l][row + j] = value.conj();
                }
            }
        }
        row += mu;
        // The equations are annihilated.
        let shares = shares(monomials, s);
        for equation in equations {
            for v in 0..s {
                for (j, functional) in self.basis.iter().enumerate() {
                    let terms = functional.iter().zip(&shares[v]);
                    let value: Complex64 = terms
                        .map(|(c, &(place, share))| c * equation[place] * share)
                        .sum();
                    columns[v * mu + j][row] = value;
                }
            }
            row += 1;
        }
        let integrands = if work > MOST_WORK {
            let (basis, clear) = null_space(columns, CUT * noise);
            *margin = margin.min(clear);
            basis
        } else {
            let mut svd = Svd::of(columns);
            let rank = rank(&svd.values, noise, margin);
            svd.domain.split_off(rank)
        };
        if integrands.is_empty() {
            return Err(Stop::Whole);
        }
        for integrand in &integrands {
            self.append(monomials, &shares, integrand, mu);
        }
        Ok(())
    }

    /// The tangent of the only branch of a curve that the functionals of the highest order differentiate
    /// along: where one was added its leading coefficients are the monomials of that direction. `None` where
    /// more than one was added. `order`: the highest.
    pub(super) fn tangent(&self, monomials: &Monomials, order: u32) -> Option<Vec<Complex64>> {
        let [.., before, last] = self.basis.as_slice() else {
            return None;
        };
        let highest = monomials.of_degree(order).start;
        let leads = |functional: &Series| {
            let leading = functional.get(highest..).unwrap_or(&[]);
            leading.iter().any(|c| c.norm_sqr() > LEADING)
        };
        if leads(before) || !leads(last) {
            return None;
        }
        let coefficient = |place: Option<usize>| place.and_then(|m| last.get(m).copied());
        let pure = |v: usize| -> Option<usize> {
            (1..order - 1).try_fold(monomials.variable(v), |place, _| {
                monomials.product(monomials.variable(v), place)
            })
        };
        let times = |w: usize, place: usize| monomials.product(monomials.variable(w), place);
        let leading = |v: usize| {
            let power = pure(v)?;
            let values: Option<Vec<Complex64>> = (0..self.variables)
                .map(|w| Some(coefficient(times(w, power)).unwrap_or_default()))
                .collect();
            values
        };
        let candidates = (0..self.variables).filter_map(|v| Some((v, leading(v)?)));
        let size = |(v, values): &(usize, Vec<Complex64>)| values[*v].norm_sqr();
        let best = candidates.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        (size(&best) > 0.0).then_some(best.1)
    }

    /// Adds the integral of what is given by its coefficients for each variable and functional.
    fn append(
        &mut self,
        monomials: &Monomials,
        shares: &[Vec<(usize, f64)>],
        integrand: &[Complex64],
        mu: usize,
    ) {
        let mut coefficients = vec![Complex64::default(); monomials.len()];
        for (v, weights) in integrand.chunks(mu).enumerate() {
            for (weight, functional) in weights.iter().zip(&self.basis) {
                for (c, &(place, share)) in functional.iter().zip(&shares[v]) {
                    coefficients[place] += weight * c * share;
                }
            }
        }
        while coefficients.last().is_some_and(|c| c.norm_sqr() == 0.0) {
            coefficients.pop();
        }
        self.basis.push(coefficients);
        let products = integrand.chunks(mu).map(<[Complex64]>::to_vec);
        self.products.push(products.collect());
    }
}

/// For each variable and monomial below the highest degree: the product's place, and its share where the
/// integrals for all variables that occur in the product are averaged.
fn shares(monomials: &Monomials, variables: usize) -> Vec<Vec<(usize, f64)>> {
    let top = monomials.degree(monomials.len() - 1);
    let below = monomials.of_degree(top).start;
    let mut occurring = vec![0u32; monomials.len()];
    let products: Vec<Vec<usize>> = (0..variables)
        .map(|v| {
            let place = |m| monomials.product(monomials.variable(v), m);
            (0..below).map_while(place).collect()
        })
        .collect();
    for &place in products.iter().flatten() {
        occurring[place] += 1;
    }
    let share = |place: usize| (place, 1.0 / f64::from(occurring[place]));
    products
        .into_iter()
        .map(|places| places.into_iter().map(share).collect())
        .collect()
}
