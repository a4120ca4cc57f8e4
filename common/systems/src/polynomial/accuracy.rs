//! What the data of a system can carry: whether a point solves exactly a system whose coefficients
//! are within the accuracy of those that are given.
//!
//! The componentwise backward error of Oettli and Prager (Numer. Math. 6, 1964) and of Rigal and
//! Gaches (J. ACM 14, 1967), for polynomials (Higham, Accuracy and Stability, section 7.2): there
//! are coefficients c_j' with |c_j' - c_j| <= delta_j for which the equation holds at y if and only
//! if |sum c_j y^(a_j)| <= sum delta_j |y^(a_j)|. Each equation is asked by itself, so that data
//! which several equations share may be changed in each alone.

use super::Polynomial;
use cognate_numeric::rational::{ComplexRational, Rational};
use num_complex::Complex64;
use rug::{Complex, Float};

/// Bits in which a value is compared with its bound: data of 60 digits is judged by its own
/// accuracy, not by that of doubles.
const BITS: u32 = 256;

/// One term: exponents of the variables, coefficient, and by how much it may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Exponents of the variables, in order.
    pub exponents: Vec<u32>,
    /// c_j.
    pub coefficient: ComplexRational,
    /// delta_j, 0 for exact data.
    pub half_unit: Rational,
}

/// Which terms of an equation count at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part<'a> {
    /// All: the point is one of the affine space.
    Whole,
    /// Those of the highest degree in these variables, which are what is left of an equation where
    /// the homogenising coordinate of their group is 0.
    AtInfinity(&'a [usize]),
}

/// Half a unit of the last digit of a decimal literal (`1.5e-3`: 5e-5); 0 for an integer without
/// point and exponent, which is exact. `None` for what is no decimal literal.
pub fn half_unit(literal: &str) -> Option<Rational> {
    let (mantissa, exponent) = match literal.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (literal, 0),
    };
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    if !digits(whole) || !digits(fraction) || whole.len() + fraction.len() == 0 {
        return None;
    }
    if !literal.contains(['.', 'e', 'E']) {
        return Some(Rational::new());
    }
    let last = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
    let ten = |power: u32| Rational::from(rug::Integer::from(rug::Integer::u_pow_u(10, power)));
    let unit = match last < 0 {
        true => ten(last.unsigned_abs()).recip(),
        false => ten(last.unsigned_abs()),
    };
    Some(unit / 2u32)
}

/// The terms of a polynomial without parameters, each coefficient as accurate as `accuracy` says.
pub fn terms(
    polynomial: &Polynomial,
    accuracy: impl Fn(&[u32], &ComplexRational) -> Rational,
) -> Vec<Term> {
    let each = polynomial.terms.iter();
    each.map(|(exponents, coefficient)| Term {
        exponents: exponents[..polynomial.variables].to_vec(),
        half_unit: accuracy(exponents, coefficient),
        coefficient: coefficient.clone(),
    })
    .collect()
}

/// Whether an equation holds at a point for some coefficients within their accuracy.
///
/// `point` has a value for each variable. Exact data leave no room: then only a point with the
/// value 0, to [`BITS`] bits, passes.
pub fn holds_within(terms: &[Term], part: Part<'_>, point: &[Complex64]) -> bool {
    let degree = |term: &Term| match part {
        Part::Whole => 0,
        Part::AtInfinity(group) => group.iter().map(|&v| term.exponents[v]).sum::<u32>(),
    };
    let top = terms.iter().map(degree).max().unwrap_or(0);
    let mut value = Complex::new(BITS);
    let mut bound = Float::new(BITS);
    for term in terms.iter().filter(|term| degree(term) == top) {
        let mut monomial = Complex::with_val(BITS, 1);
        for (z, &exponent) in point.iter().zip(&term.exponents) {
            let z = Complex::with_val(BITS, (z.re, z.im));
            for _ in 0..exponent {
                monomial *= &z;
            }
        }
        let size = Float::with_val(BITS, monomial.abs_ref());
        let (re, im) = (&term.coefficient.re, &term.coefficient.im);
        let re = Float::with_val(BITS, re);
        let im = Float::with_val(BITS, im);
        value += monomial * Complex::with_val(BITS, (re, im));
        bound += size * &term.half_unit;
    }
    let size = Float::with_val(BITS, value.abs_ref());
    size.is_finite() && size <= bound
}

/// Whether all equations do.
pub fn all_hold_within(equations: &[Vec<Term>], part: Part<'_>, point: &[Complex64]) -> bool {
    let mut each = equations.iter();
    each.all(|terms| holds_within(terms, part, point))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn term(exponents: &[u32], literal: &str) -> Term {
        let negative = literal.starts_with('-');
        let digits = literal.trim_start_matches('-');
        let delta = half_unit(digits).unwrap();
        let value: f64 = digits.parse().unwrap();
        // The literal itself, exactly: these have few digits.
        let exact = Rational::from(((value * 1e12).round() as i64, 1_000_000_000_000i64));
        Term {
            exponents: exponents.to_vec(),
            coefficient: ComplexRational::real(if negative { -exact } else { exact }),
            half_unit: delta,
        }
    }

    fn real(values: &[f64]) -> Vec<Complex64> {
        values.iter().map(|&v| Complex64::new(v, 0.0)).collect()
    }

    #[test]
    fn a_decimal_is_known_to_half_a_unit_of_its_last_digit() {
        let of = |literal: &str| half_unit(literal);
        assert_eq!(of("17"), Some(Rational::new()));
        assert_eq!(of("1.5e-3"), Some(Rational::from((1, 20_000))));
        assert_eq!(of("2.00"), Some(Rational::from((1, 200))));
        assert_eq!(of(".5"), Some(Rational::from((1, 20))));
        assert_eq!(of("3e2"), Some(Rational::from(50)));
        assert_eq!(of("2."), Some(Rational::from((1, 2))));
        assert_eq!(
            [of(""), of("."), of("x"), of("-1.0")],
            [None, None, None, None]
        );
    }

    /// x^2 - 2.000 at 1.4142: 2.000 stands for all numbers between 1.9995 and 2.0005.
    #[test]
    fn a_root_is_one_within_the_accuracy_of_the_data() {
        let f = [term(&[2], "1"), term(&[0], "-2.000")];
        let holds = |x: f64| holds_within(&f, Part::Whole, &real(&[x]));
        assert!(holds(1.4141) && holds(1.4143) && !holds(1.4145) && !holds(1.4139));
        // Exact data carry the root alone, and doubles do not hold it.
        let exact = [term(&[2], "1"), term(&[0], "-2")];
        assert!(!holds_within(&exact, Part::Whole, &real(&[f64::sqrt(2.0)])));
        let square = [term(&[2], "1"), term(&[0], "-4")];
        assert!(holds_within(&square, Part::Whole, &real(&[-2.0])));
    }

    /// Two lines that are parallel within the accuracy of their slopes: x + y = -1 and
    /// 1.0001 x + y = 1 meet at (20000, -20001), and at infinity in nearly this direction.
    #[test]
    fn a_far_solution_is_infinity_within_the_accuracy_of_the_data() {
        let line = |slope: &str, other: &str, constant: &str| {
            let constant = term(&[0, 0], constant);
            vec![term(&[1, 0], slope), term(&[0, 1], other), constant]
        };
        let direction = real(&[20_000.0, -20_001.0]);
        let infinity = Part::AtInfinity(&[0, 1]);
        let rough = [
            line("1.0000", "1.0000", "1"),
            line("1.0001", "1.0000", "-1"),
        ];
        assert!(all_hold_within(&rough, infinity, &direction));
        assert!(all_hold_within(&rough, Part::Whole, &direction));
        assert!(!all_hold_within(&rough, infinity, &real(&[1.0, -1.001])));
        let fine = [
            line("1.0000000", "1.0000000", "1"),
            line("1.0001000", "1.0000000", "-1"),
        ];
        assert!(!all_hold_within(&fine, infinity, &direction));
        assert!(all_hold_within(&fine, Part::Whole, &direction));
        let exact = [line("1", "1", "1"), line("1.0001", "1", "-1")];
        assert!(!all_hold_within(&exact, infinity, &direction));
    }
}
