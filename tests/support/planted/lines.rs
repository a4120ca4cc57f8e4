//! Planted products of lines, disguised by a unimodular change of variables: systems whose solutions are known digit by
//! digit.
//!
//! Each equation is a product of linear forms with whole coefficients, multiplied out, some of them in conjugate pairs;
//! so each solution solves linear equations in rationals. All coordinates are in one unit between 1e-6 and 1e6.

use super::linear::{Flat, solve};
use super::polynomial::Polynomial;
use super::{Planted, Root};
use crate::dice::Dice;
use cognate_numeric::rational::{ComplexRational, Rational};

/// The zeros of a linear form, or of it and its conjugate.
#[derive(Clone)]
struct Form {
    coefficients: Vec<Rational>,
    constant: Rational,
    /// The imaginary part of the constant; both signs where it is not 0.
    imaginary: Rational,
}

fn between(dice: &mut Dice, low: i64, high: i64) -> i64 {
    low + dice.below((high - low + 1) as u64) as i64
}

/// One of -`most` .. `most`, but not 0.
fn not_zero(dice: &mut Dice, most: i64) -> i64 {
    let size = between(dice, 1, most);
    if dice.below(2) == 0 { size } else { -size }
}

impl Form {
    /// A form in which variable `k` occurs, and of the others all or at most one.
    fn new(dice: &mut Dice, n: usize, k: usize, dense: bool) -> Self {
        let other = dice.below(n as u64) as usize;
        let coefficients = (0..n).map(|j| match (j == k, dense || j == other) {
            (true, _) => Rational::from(not_zero(dice, 3)),
            (false, true) => Rational::from(between(dice, -4, 4)),
            (false, false) => Rational::new(),
        });
        let coefficients = coefficients.collect();
        let pair = dice.below(4) == 0;
        Self {
            coefficients,
            constant: Rational::from(between(dice, -9, 9)),
            imaginary: match pair {
                true => Rational::from(between(dice, 1, 5)),
                false => Rational::new(),
            },
        }
    }

    fn degree(&self) -> u64 {
        if self.imaginary == 0 { 1 } else { 2 }
    }

    /// The form in the unknowns of which these rows give the old ones, in this unit.
    fn changed(&self, rows: &[Vec<i64>], unit: &Rational) -> Self {
        let n = rows.len();
        let coefficients = (0..n).map(|j| {
            let terms = self.coefficients.iter().zip(rows);
            terms.fold(Rational::new(), |sum, (c, row)| {
                sum + c * Rational::from(row[j])
            })
        });
        Self {
            coefficients: coefficients.collect(),
            constant: Rational::from(&self.constant * unit),
            imaginary: Rational::from(&self.imaginary * unit),
        }
    }

    fn polynomial(&self) -> Polynomial {
        let form = Polynomial::linear(&self.coefficients, self.constant.clone());
        if self.imaginary == 0 {
            return form;
        }
        let square = Rational::from(&self.imaginary * &self.imaginary);
        let n = self.coefficients.len();
        form.power(2).plus(&Polynomial::constant(n, square))
    }

    /// The imaginary parts of its constant.
    fn signs(&self) -> Vec<Rational> {
        match self.imaginary == 0 {
            true => vec![Rational::new()],
            false => vec![self.imaginary.clone(), Rational::from(-&self.imaginary)],
        }
    }
}

/// A matrix of whole numbers with determinant 1: rows are added to others `times` times.
fn unimodular(dice: &mut Dice, n: usize, times: u64) -> Vec<Vec<i64>> {
    let mut rows: Vec<Vec<i64>> = (0..n)
        .map(|i| (0..n).map(|j| i64::from(i == j)).collect())
        .collect();
    for _ in 0..times {
        let from = dice.below(n as u64) as usize;
        let to = (from + 1 + dice.below(n as u64 - 1) as usize) % n;
        let factor = not_zero(dice, 2);
        let row = rows[from].clone();
        for (entry, other) in rows[to].iter_mut().zip(row) {
            *entry += factor * other;
        }
    }
    rows
}

/// The points where a form of each equation is 0; `None` where some coincide or are not isolated.
fn points(equations: &[Vec<Form>]) -> Option<Vec<Vec<ComplexRational>>> {
    let mut choices: Vec<Vec<(&Form, Rational)>> = vec![Vec::new()];
    for forms in equations {
        let zeros = forms
            .iter()
            .flat_map(|form| form.signs().into_iter().map(move |sign| (form, sign)));
        let zeros: Vec<_> = zeros.collect();
        choices = choices
            .iter()
            .flat_map(|chosen| {
                zeros.iter().map(|zero| {
                    let mut longer = chosen.clone();
                    longer.push(zero.clone());
                    longer
                })
            })
            .collect();
    }
    let mut points: Vec<Vec<ComplexRational>> = Vec::new();
    for chosen in choices {
        let rows = |constant: fn(&(&Form, Rational)) -> Rational| {
            let rows = chosen.iter().map(|zero| {
                let mut row = zero.0.coefficients.clone();
                row.push(constant(zero));
                row
            });
            solve(&rows.collect::<Vec<_>>())
        };
        let real = rows(|(form, _)| form.constant.clone());
        let imaginary = rows(|(_, sign)| sign.clone());
        let (Flat::Point(re), Flat::Point(im)) = (real, imaginary) else {
            return None;
        };
        let parts = re.into_iter().zip(im);
        let point: Vec<_> = parts.map(|(re, im)| ComplexRational::new(re, im)).collect();
        if points.contains(&point) {
            return None;
        }
        points.push(point);
    }
    Some(points)
}

/// 10 to this power.
fn power_of_ten(exponent: i64) -> Rational {
    let power = (0..exponent.abs()).fold(Rational::from(1), |power, _| power * 10);
    match exponent < 0 {
        true => power.recip(),
        false => power,
    }
}

/// The products of lines with this number of a series.
pub fn lines(seed: u64, number: u64) -> Planted {
    let mut dice =
        Dice(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ number.wrapping_mul(0x9e37_79b9));
    dice.below(2);
    loop {
        let n = [2, 2, 3][dice.below(3) as usize];
        let dense = dice.below(2) == 0;
        let unit = power_of_ten(between(&mut dice, -6, 6));
        let change = unimodular(&mut dice, n, if dense { 4 } else { 1 });
        let degree = if n == 2 { between(&mut dice, 2, 4) } else { 2 } as u64;
        let equations: Vec<Vec<Form>> = (0..n)
            .map(|k| {
                let mut forms = Vec::new();
                while forms.iter().map(Form::degree).sum::<u64>() < degree {
                    forms.push(Form::new(&mut dice, n, k, dense).changed(&change, &unit));
                }
                forms
            })
            .collect();
        let Some(points) = points(&equations) else {
            continue;
        };
        let variables: Vec<String> = (1..=n).map(|k| format!("x{k}")).collect();
        let one = Polynomial::constant(n, Rational::from(1));
        let product = |forms: &Vec<Form>| {
            let forms = forms.iter();
            forms.fold(one.clone(), |product, form| {
                product.times(&form.polynomial())
            })
        };
        let texts = equations.iter().map(product);
        let roots = points.into_iter().map(|point| Root {
            point,
            multiplicity: 1,
        });
        return Planted {
            kind: if dense {
                "lines, dense"
            } else {
                "lines, sparse"
            },
            equations: texts.map(|equation| equation.text(&variables)).collect(),
            variables,
            roots: roots.collect(),
            on_a_set: false,
            square: true,
        };
    }
}
