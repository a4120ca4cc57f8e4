//! MonomialChange: equations of few terms and high degree as equations of low degree in monomials of the unknowns.
//!
//! Where no unknown is 0 at a solution, an equation may be divided by one of its terms, and depends only on the monomials
//! whose exponents are the differences of its own. These span a lattice. Monomials z by a basis of it are new unknowns, in
//! which the equations are as few terms of lower degree; each solution in z is that of as many in x as the index of the
//! lattice, with the same multiplicity, since the map from x to z has no critical point where no x is 0 (B. Sturmfels,
//! Solving systems of polynomial equations, 2002, section 3.2).

use super::exact_point::ExactPoint;
use super::in_all_unknowns::exact_points_in_all_unknowns;
use super::lattice::{InBasis, Row, coordinates, echelon_form, with_unit_rows};
use super::points::{exact_point, sort};
use super::rational_equations::{RationalEquations, RationalTerm, power};
use crate::polynomial::solution_count::NotCounted;
use crate::polynomial::solution_count::groebner::Budget;
use crate::polynomial::solution_count::monomial::Monomial;
use cognate_numeric::rational::ComplexRational;
use rug::float::Constant;
use rug::{Complex, Float};

/// A change is made where it makes the product of the degrees smaller by this factor.
const LEAST_GAIN: u64 = 4;
/// Unknowns of which every choice that are 0 is looked at.
const MOST_UNKNOWNS: usize = 10;
/// Largest number of solutions in x that are made.
const MOST_SOLUTIONS: u128 = 20_000;
/// Operations of one power in some hundreds of bits: some tens of complex products.
const OPERATIONS_OF_POWER: usize = 1000;
/// Bits of the unknowns at least, beyond which a part that is smaller than half of them is 0.
const BITS: u32 = 128;
/// Bits that operations on some tens of numbers may lose.
const SPARE_BITS: u32 = 16;
/// Decimal digits of one bit, rounded up.
const DIGITS_OF_BIT: f64 = 0.3011;

/// New unknowns that are monomials of the given ones.
#[derive(Debug)]
pub(super) struct MonomialChange {
    /// Exponents of the unknowns in each new one.
    exponents: Vec<Row>,
    /// For each polynomial, the equations first, the exponents of its terms in the new unknowns.
    terms: Vec<Vec<Vec<u32>>>,
}

impl MonomialChange {
    /// The change that makes degrees small; `None` where an unknown may be 0, where the exponents span no lattice of full
    /// rank, and where no change makes the degrees smaller by much.
    pub fn of(equations: &RationalEquations) -> Option<Self> {
        let size = equations.unknowns;
        if size > MOST_UNKNOWNS || may_be_zero(equations) {
            return None;
        }
        let polynomials = || equations.equations.iter().chain(&equations.denominators);
        let differences: Vec<Vec<Row>> = polynomials().map(|terms| differences(terms)).collect();
        let rows: Vec<Row> = differences.concat();
        let mut basis = echelon_form(rows, size)?;
        basis.truncate(size);
        let has_full_rank = basis.len() == size && (0..size).all(|k| basis[k][k] != 0);
        if !has_full_rank {
            return None;
        }
        let in_basis = differences.iter().flatten();
        let in_basis: Option<Vec<Row>> =
            in_basis.map(|vector| coordinates(&basis, vector)).collect();
        let in_basis = InBasis {
            coordinates: in_basis?,
            basis,
        };
        let sizes: Vec<usize> = differences.iter().map(Vec::len).collect();
        let changes = [
            Self::with_small_exponents(in_basis.clone(), &sizes),
            Self::with_triangular_binomials(in_basis, &sizes),
        ];
        let costs = changes.into_iter().flatten().map(|change| {
            let cost = change.changed(equations).product_of_degrees();
            (cost, change)
        });
        let (cost, change) = costs.min_by_key(|&(cost, _)| cost)?;
        let is_lower = cost.saturating_mul(LEAST_GAIN) <= equations.product_of_degrees();
        (is_lower && change.index()? <= MOST_SOLUTIONS).then_some(change)
    }

    /// All exponents are small together; `sizes`: numbers of terms of the polynomials.
    fn with_small_exponents(mut in_basis: InBasis, sizes: &[usize]) -> Option<Self> {
        in_basis.make_small(0)?;
        Self::new(in_basis, sizes)
    }

    /// Equations of two terms are a triangle, in which each new unknown after another is a root of a number; the exponents
    /// are as small as that allows.
    fn with_triangular_binomials(mut in_basis: InBasis, sizes: &[usize]) -> Option<Self> {
        let mut first = 0;
        let mut of_binomials = Vec::new();
        for &size in sizes {
            if size == 2 {
                of_binomials.push(in_basis.coordinates[first + 1].clone());
            }
            first += size;
        }
        if of_binomials.is_empty() {
            return None;
        }
        let rank = in_basis.make_triangular(&of_binomials)?;
        in_basis.make_small(rank)?;
        Self::new(in_basis, sizes)
    }

    fn new(in_basis: InBasis, sizes: &[usize]) -> Option<Self> {
        let InBasis { coordinates, basis } = in_basis;
        let mut rows = coordinates.iter();
        let terms = sizes.iter().map(|&size| {
            let rows: Vec<&Row> = rows.by_ref().take(size).collect();
            without_common_monomial(&rows, basis.len())
        });
        let terms: Vec<Vec<Vec<u32>>> = terms.collect::<Option<_>>()?;
        Some(Self {
            exponents: basis,
            terms,
        })
    }

    /// Number of solutions in the given unknowns for each in the new ones; `None` where it is past 128 bits.
    pub fn index(&self) -> Option<u128> {
        let form = echelon_form(self.exponents.clone(), self.exponents.len())?;
        let mut pivots = form
            .iter()
            .enumerate()
            .map(|(k, row)| row[k].unsigned_abs());
        pivots.try_fold(1u128, u128::checked_mul)
    }

    /// The equations in the new unknowns, none of which is 0.
    pub fn changed(&self, equations: &RationalEquations) -> RationalEquations {
        let of_each = |polynomials: &[Vec<RationalTerm>], terms: &[Vec<Vec<u32>>]| {
            let pairs = polynomials.iter().zip(terms);
            let polynomials = pairs.map(|(polynomial, terms)| {
                let coefficients = polynomial.iter().map(|(_, coefficient)| coefficient);
                let terms = terms.iter().cloned();
                terms.zip(coefficients.cloned()).collect::<Vec<_>>()
            });
            polynomials.collect::<Vec<_>>()
        };
        let (first, others) = self.terms.split_at(equations.equations.len());
        let mut changed = RationalEquations {
            unknowns: equations.unknowns,
            square_roots: equations.unknowns..equations.unknowns,
            equations: of_each(&equations.equations, first),
            denominators: of_each(&equations.denominators, others),
        };
        if may_be_zero(&changed) {
            let product = vec![1; changed.unknowns];
            let product = vec![(product, ComplexRational::real(1))];
            changed.denominators.push(product);
        }
        changed
    }

    /// Computes all solutions of the equations of which the change was made, each with at least the wanted number of
    /// decimal digits; `None` inside where they are infinitely many.
    pub fn points(
        &self,
        equations: &RationalEquations,
        digits: u32,
        budget: &mut Budget,
    ) -> Result<Option<Vec<ExactPoint>>, NotCounted> {
        let inverse = InverseChange::of(&self.exponents).ok_or(NotCounted::Operations)?;
        let bits = BITS.max((f64::from(digits) / DIGITS_OF_BIT) as u32 + SPARE_BITS);
        let in_new = (f64::from(bits + inverse.lost_bits) * DIGITS_OF_BIT) as u32 + 1;
        let changed = self.changed(equations);
        let Some(points) = exact_points_in_all_unknowns(&changed, in_new, budget)? else {
            return Ok(None);
        };
        let index = self.index().unwrap_or(u128::MAX);
        let count = index.saturating_mul(points.len() as u128);
        let operations = OPERATIONS_OF_POWER.saturating_mul(powers_of_solution(equations));
        let operations =
            usize::try_from(count).map_or(usize::MAX, |n| n.saturating_mul(operations));
        if count > MOST_SOLUTIONS || budget.take(operations).is_none() {
            return Err(NotCounted::Operations);
        }
        let mut solutions = Vec::new();
        for point in &points {
            for values in inverse.solutions(&point.values, bits) {
                let solution = solution(equations, point, &values, bits);
                if !equations.hold_at(&solution) {
                    return Err(NotCounted::NotSeparated);
                }
                solutions.push(solution);
            }
        }
        sort(&mut solutions);
        Ok(Some(solutions))
    }
}

/// Powers that a solution takes: of each unknown in each monomial, and of each in each term of the equations, at which
/// residual and condition are computed and the equations checked.
fn powers_of_solution(equations: &RationalEquations) -> usize {
    let terms: usize = equations.equations.iter().map(Vec::len).sum();
    (equations.unknowns + 3 * terms) * equations.unknowns
}

/// Whether some unknowns can be 0 as far as the terms say: no equation then has exactly one term that is not 0, and no
/// denominator has none.
fn may_be_zero(equations: &RationalEquations) -> bool {
    let size = equations.unknowns;
    let left = |polynomial: &[RationalTerm], zeros: u32| {
        let is_left = |(exponents, _): &&RationalTerm| {
            let mut present = (0..size).filter(|&k| exponents[k] > 0);
            !present.any(|k| zeros & (1 << k) != 0)
        };
        polynomial.iter().filter(is_left).count()
    };
    (1..1u32 << size).any(|zeros| {
        let is_contradiction = equations.equations.iter().any(|p| left(p, zeros) == 1)
            || equations.denominators.iter().any(|p| left(p, zeros) == 0);
        !is_contradiction
    })
}

/// The exponents of all terms less those of the first.
fn differences(terms: &[RationalTerm]) -> Vec<Row> {
    let Some((first, _)) = terms.first() else {
        return Vec::new();
    };
    let difference = |exponents: &[u32]| {
        let pairs = exponents.iter().zip(first);
        pairs
            .map(|(&a, &b)| i128::from(a) - i128::from(b))
            .collect()
    };
    terms
        .iter()
        .map(|(exponents, _)| difference(exponents))
        .collect()
}

/// Exponents of which the least of each unknown is 0; `None` where one is too large for a monomial.
fn without_common_monomial(rows: &[&Row], size: usize) -> Option<Vec<Vec<u32>>> {
    let least: Vec<i128> = (0..size)
        .map(|k| rows.iter().map(|row| row[k]).min().unwrap_or_default())
        .collect();
    let shifted = rows.iter().map(|row| {
        let pairs = row.iter().zip(&least);
        let exponents: Option<Vec<u32>> = pairs
            .map(|(entry, least)| u32::try_from(entry.checked_sub(*least)?).ok())
            .collect();
        exponents.filter(|exponents| Monomial::new(exponents).is_some())
    });
    shifted.collect()
}

/// The unknowns from the monomials: one after another, from the last on, each by a root.
struct InverseChange {
    /// Hermite's normal form of the exponents: the monomial of each row begins with the unknown of its number.
    form: Vec<Row>,
    /// Exponents of the new unknowns in the monomial of each row of the form.
    combinations: Vec<Row>,
    /// Bits by which the relative error of a new unknown is larger in an unknown, at most.
    lost_bits: u32,
}

impl InverseChange {
    fn of(exponents: &[Row]) -> Option<Self> {
        let size = exponents.len();
        let rows = echelon_form(with_unit_rows(exponents), size)?;
        let form: Vec<Row> = rows.iter().map(|row| row[..size].to_vec()).collect();
        let combinations: Vec<Row> = rows.iter().map(|row| row[size..].to_vec()).collect();
        let mut errors = vec![0.0; size];
        for i in (0..size).rev() {
            let of_monomial: f64 = combinations[i].iter().map(|&k| (k as f64).abs()).sum();
            let of_others: f64 = (i + 1..size)
                .map(|k| (form[i][k] as f64).abs() * errors[k])
                .sum();
            errors[i] = (of_monomial + of_others + 1.0) / form[i][i] as f64 + 1.0;
        }
        let largest = errors.iter().copied().fold(1.0, f64::max);
        Some(Self {
            form,
            combinations,
            lost_bits: binary_digits(largest)? + SPARE_BITS,
        })
    }

    /// All values of the unknowns at which the monomials have these values, to `bits` bits.
    fn solutions(&self, monomials: &[ComplexRational], bits: u32) -> Vec<Vec<Complex>> {
        let size = self.form.len();
        let work_bits = bits + self.lost_bits;
        let rounded = |z: &ComplexRational| Complex::with_val(work_bits, (&z.re, &z.im));
        let monomials: Vec<Complex> = monomials.iter().map(rounded).collect();
        // Values of the unknowns from the number of the row on.
        let mut solutions: Vec<Vec<Complex>> = vec![Vec::new()];
        for i in (0..size).rev() {
            let power = product_of_powers(&monomials, &self.combinations[i], work_bits);
            let form = &self.form[i];
            let next = solutions.iter().flat_map(|after| {
                let others = product_of_powers(after, &form[i + 1..], work_bits);
                let power = Complex::with_val(work_bits, &power / others);
                let roots = roots(&power, form[i]);
                let longer = roots.into_iter().map(|root| {
                    let mut values = vec![root];
                    values.extend(after.iter().cloned());
                    values
                });
                longer.collect::<Vec<_>>()
            });
            solutions = next.collect();
        }
        solutions
    }
}

/// Number of binary digits of the whole part of a number, which is at least 1; `None` for an infinity.
fn binary_digits(number: f64) -> Option<u32> {
    let digits = Float::with_val(f64::MANTISSA_DIGITS, number).get_exp()?;
    u32::try_from(digits).ok()
}

fn product_of_powers(values: &[Complex], exponents: &[i128], bits: u32) -> Complex {
    let mut product = Complex::with_val(bits, 1);
    for (value, &exponent) in values.iter().zip(exponents) {
        match exponent {
            0 => {}
            1.. => product *= power(value, exponent.unsigned_abs()),
            _ => product /= power(value, exponent.unsigned_abs()),
        }
    }
    product
}

/// All roots of this degree of a number that is not 0, from the one of least argument on.
fn roots(number: &Complex, degree: i128) -> Vec<Complex> {
    let bits = number.prec().0;
    let size = Float::with_val(bits, number.abs_ref());
    let size = (size.ln() / rug::Integer::from(degree)).exp();
    let angle = Float::with_val(bits, number.arg_ref());
    let turn = Float::with_val(bits, Constant::Pi) * 2u32;
    let root = |k: i128| {
        let turns = Float::with_val(bits, &turn * rug::Integer::from(k));
        let angle = Float::with_val(bits, &angle + turns) / rug::Integer::from(degree);
        let (sine, cosine) = angle.sin_cos(Float::new(bits));
        Complex::with_val(bits, (cosine * &size, sine * &size))
    };
    (0..degree).map(root).collect()
}

/// Sets a part of a number of `bits` bits to 0 where it is smaller than half of the bits show.
fn without_negligible_part(value: &Complex, bits: u32) -> Complex {
    let least = Float::with_val(bits, value.abs_ref()) >> (bits / 2);
    let part = |part: &Float| match *part.as_abs() < least {
        true => Float::new(bits),
        false => Float::with_val(bits, part),
    };
    Complex::with_val(bits, (part(value.real()), part(value.imag())))
}

/// The solution of the equations at which the monomials are those of a point.
///
/// Where the monomials are real, the conjugate of a solution is one, too, and differs from it, where it does, by a root of
/// unity in some unknown: an imaginary part that is smaller than half of the bits show is 0.
fn solution(
    equations: &RationalEquations,
    point: &ExactPoint,
    values: &[Complex],
    bits: u32,
) -> ExactPoint {
    let values: Vec<Complex> = values
        .iter()
        .map(|value| without_negligible_part(value, bits))
        .collect();
    let is_real = values.iter().all(|value| value.imag().is_zero())
        && (point.is_real || !equations.is_real());
    let precision_bits = bits.max(point.precision_bits);
    exact_point(
        equations,
        &values,
        point.multiplicity,
        is_real,
        precision_bits,
    )
}
