//! Points: the unknowns at the roots of the polynomials that represent them.

use super::exact_point::{ExactPoint, PointClass};
use super::rational_equations::RationalEquations;
use crate::polynomial::solution_count::groebner::Budget;
use crate::polynomial::univariate::{SquareFreePolynomial, isolated_roots_of};
use cognate_numeric::rational::ComplexRational;
use num_complex::Complex64;
use rug::{Complex, Float};

/// Bits of the first round; each further one has twice as many.
const FIRST_BITS: u32 = 128;
/// Most bits to which points are computed.
const MOST_BITS: u32 = 1 << 16;
/// Bits beyond which a double is rounded the right way, but for numbers within 2^-10 of a unit beside the middle of two.
const BITS_OF_DOUBLES: u32 = 64;
/// Bits beyond those of the decimal digits that are asked for.
const MORE_BITS: u32 = 12;

/// The points of all classes, ascending by coordinates; `None` where that takes more than the budget.
pub(super) fn points(
    classes: &[PointClass],
    equations: &RationalEquations,
    digits: u32,
    budget: &mut Budget,
) -> Option<Vec<ExactPoint>> {
    // A decimal digit has less than 10/3 bits.
    let wanted = BITS_OF_DOUBLES.max(digits * 10 / 3 + MORE_BITS);
    let mut points = Vec::new();
    for class in classes {
        let count = points.len() + class.polynomial.len() - 1;
        for factor in factors_by_zeros(class) {
            points.extend(factor.points(class, equations, wanted, budget)?);
        }
        assert_eq!(points.len(), count, "as many points as the class has");
    }
    sort(&mut points);
    Some(points)
}

/// Puts points into the order of their coordinates, one after another, real parts first.
pub(super) fn sort(points: &mut [ExactPoint]) {
    points.sort_by(|a, b| {
        let mut orders = a.values.iter().zip(&b.values).map(|(a, b)| {
            let by_real_part = a.re.cmp(&b.re);
            by_real_part.then_with(|| a.im.cmp(&b.im))
        });
        orders
            .find(|order| order.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    });
}

/// A factor of the polynomial of a class, at whose roots the same unknowns are 0.
struct Factor {
    polynomial: SquareFreePolynomial,
    is_zero: Vec<bool>,
}

/// Splits a class by the unknowns that are 0, which common divisors decide exactly.
fn factors_by_zeros(class: &PointClass) -> Vec<Factor> {
    let mut factors = vec![Factor {
        polynomial: SquareFreePolynomial::new(&class.polynomial),
        is_zero: Vec::new(),
    }];
    for numerator in &class.numerators {
        let numerator = SquareFreePolynomial::new(numerator);
        let mut split = Vec::new();
        for factor in factors {
            let (common, rest) = factor.polynomial.split_by(&numerator);
            for (polynomial, zero) in [(common, true), (rest, false)] {
                if polynomial.degree() > 0 {
                    let mut is_zero = factor.is_zero.clone();
                    is_zero.push(zero);
                    split.push(Factor {
                        polynomial,
                        is_zero,
                    });
                }
            }
        }
        factors = split;
    }
    factors
}

impl Factor {
    /// The points at the roots, each unknown to the wanted number of bits: the precision grows until the values in some
    /// bits and in twice as many agree to this number.
    fn points(
        &self,
        class: &PointClass,
        equations: &RationalEquations,
        wanted: u32,
        budget: &mut Budget,
    ) -> Option<Vec<ExactPoint>> {
        let mut bits = FIRST_BITS.max(wanted.next_power_of_two());
        let is_real = equations.is_real();
        let mut before = self.values(class, bits, budget)?;
        loop {
            bits *= 2;
            if bits > MOST_BITS {
                return None;
            }
            let present = self.values(class, bits, budget)?;
            let pairs = before.iter().zip(&present);
            let agreed = pairs.map(|(before, present)| present.agreed_with(before, wanted));
            let agreed: Option<Vec<Vec<Complex>>> = agreed.collect();
            if let Some(agreed) = agreed {
                let pairs = present.iter().zip(agreed);
                let points = pairs.map(|(root, values)| {
                    let is_real = match is_real {
                        true => root.is_real_root,
                        false => values.iter().all(|value| value.imag().is_zero()),
                    };
                    exact_point(equations, &values, class.multiplicity, is_real, bits)
                });
                return Some(points.collect());
            }
            before = present;
        }
    }

    /// The unknowns at the roots in some bits, the roots in the order of the isolation.
    fn values(
        &self,
        class: &PointClass,
        bits: u32,
        budget: &mut Budget,
    ) -> Option<Vec<ValuesAtRoot>> {
        let roots = isolated_roots_of(&self.polynomial, bits, &mut budget.0)?;
        let terms = class.polynomial.len() * (class.numerators.len() + 1);
        let limbs = u64::from(bits.div_ceil(64));
        let operations = (limbs * limbs.min(32) + 8) as usize * terms * roots.len();
        budget.take(operations)?;
        let rounded = |c: &ComplexRational| Complex::with_val(bits, (&c.re, &c.im));
        let each = class.polynomial.iter().zip(0u32..).skip(1);
        let slope: Vec<Complex> = each.map(|(c, k)| rounded(c) * k).collect();
        let numerators = class.numerators.iter();
        let numerators: Vec<Vec<Complex>> = numerators
            .map(|numerator| numerator.iter().map(rounded).collect())
            .collect();
        let at_root = |root: Complex| {
            let root = Complex::with_val(bits, root);
            let slope = value_at(&slope, &root);
            let unknowns = numerators.iter().zip(&self.is_zero);
            let values = unknowns.map(|(numerator, &is_zero)| match is_zero {
                true => Complex::new(bits),
                false => value_at(numerator, &root) / &slope,
            });
            ValuesAtRoot {
                values: values.collect(),
                is_real_root: root.imag().is_zero(),
            }
        };
        let mut values: Vec<(Complex, ValuesAtRoot)> = roots
            .into_iter()
            .map(|root| (root.clone(), at_root(root)))
            .collect();
        let part = |a: &Float, b: &Float| a.partial_cmp(b).expect("roots are numbers");
        values.sort_by(|(a, _), (b, _)| {
            part(a.real(), b.real()).then_with(|| part(a.imag(), b.imag()))
        });
        Some(values.into_iter().map(|(_, values)| values).collect())
    }
}

/// The unknowns at one root.
struct ValuesAtRoot {
    values: Vec<Complex>,
    is_real_root: bool,
}

impl ValuesAtRoot {
    /// The values, if those in half of the bits agree with them to `wanted` bits; a part that neither tells from 0
    /// beside the other part is 0.
    fn agreed_with(&self, half: &Self, wanted: u32) -> Option<Vec<Complex>> {
        if self.is_real_root != half.is_real_root {
            return None;
        }
        let pairs = self.values.iter().zip(&half.values);
        pairs
            .map(|(value, half)| agreed(value, half, wanted))
            .collect()
    }
}

fn agreed(value: &Complex, half: &Complex, wanted: u32) -> Option<Complex> {
    let bits = value.prec().0;
    let size = Float::with_val(bits, value.abs_ref());
    // Below this, beside the number, half of the bits say nothing.
    let negligible = Float::with_val(bits, &size >> (bits / 4));
    let part = |value: &Float, half: &Float| {
        let difference = Float::with_val(bits, value - half).abs();
        if difference <= Float::with_val(bits, value.abs_ref()) >> wanted {
            return Some(value.clone());
        }
        let is_negligible = *value.as_abs() < negligible && *half.as_abs() < negligible;
        is_negligible.then(|| Float::new(bits))
    };
    let re = part(value.real(), half.real())?;
    let im = part(value.imag(), half.imag())?;
    Some(Complex::with_val(bits, (re, im)))
}

/// By Horner's rule.
fn value_at(polynomial: &[Complex], z: &Complex) -> Complex {
    let mut value = Complex::new(z.prec());
    for c in polynomial.iter().rev() {
        value *= z;
        value += c;
    }
    value
}

/// A solution with these unknowns.
pub(super) fn exact_point(
    equations: &RationalEquations,
    values: &[Complex],
    multiplicity: u64,
    is_real: bool,
    precision_bits: u32,
) -> ExactPoint {
    let rounded: Vec<Complex64> = values.iter().map(rounded).collect();
    let values: Vec<ComplexRational> = values.iter().map(exact).collect();
    ExactPoint {
        residual: equations.residual(&rounded),
        condition: match multiplicity {
            1 => equations.condition(&values),
            _ => f64::INFINITY,
        },
        values,
        rounded,
        multiplicity,
        is_real,
        precision_bits,
    }
}

fn exact(value: &Complex) -> ComplexRational {
    let part = |part: &Float| part.to_rational().unwrap_or_default();
    ComplexRational::new(part(value.real()), part(value.imag()))
}

fn rounded(value: &Complex) -> Complex64 {
    Complex64::new(value.real().to_f64(), value.imag().to_f64())
}
