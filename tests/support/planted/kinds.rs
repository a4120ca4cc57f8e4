//! Kinds of planted systems, each built from its solutions.
//!
//! Multiplicities are exact by the additivity of intersection numbers over factors.

use super::linear::{Flat, solve};
use super::polynomial::Polynomial;
use super::{Planted, Root};
use crate::dice::Dice;
use cognate_numeric::rational::{ComplexRational, Rational};
use std::collections::BTreeMap;

/// Builds a system of one kind.
type Builder = fn(&mut Dice) -> Planted;

/// All kinds, by name.
pub const KINDS: &[(&str, Builder)] = &[
    ("one unknown", one_unknown),
    ("triangular", |dice| triangular(dice, Style::Plain)),
    ("triangular, multiple", |dice| {
        triangular(dice, Style::Multiple)
    }),
    ("triangular, scales", |dice| triangular(dice, Style::Scales)),
    ("triangular, near", |dice| triangular(dice, Style::Near)),
    ("forms", |dice| forms(dice, Planting::Nothing)),
    ("forms, repeated", |dice| forms(dice, Planting::Repeated)),
    ("forms, near", |dice| forms(dice, Planting::Near)),
    ("forms, parallel", |dice| forms(dice, Planting::Parallel)),
    ("forms, shared", |dice| forms(dice, Planting::Shared)),
    ("squares", squares),
    ("monomial map", monomial_map),
    ("escaping", escaping),
    ("tangents", tangents),
    ("common factor", common_factor),
    ("overdetermined", overdetermined),
    ("units", units),
];

/// The system with this number of a series.
pub fn planted(seed: u64, number: u64) -> Planted {
    let (kind, build) = KINDS[(number % KINDS.len() as u64) as usize];
    // Numbers of a series share no throws: the golden ratio of 2^64 keeps them apart.
    let mut dice =
        Dice(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ number.wrapping_mul(0x9e37_79b9));
    dice.below(2);
    Planted {
        kind,
        ..build(&mut dice)
    }
}

/// Which roots factors have.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Style {
    /// Small fractions.
    Plain,
    /// Small fractions, factors to powers.
    Multiple,
    /// From 1e-12 to 1e12.
    Scales,
    /// Some 1e-4 to 1e-12 beside others.
    Near,
}

/// Kind of form that is planted in products of linear forms.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Planting {
    Nothing,
    /// A form to a power.
    Repeated,
    /// A form, and the same with a constant 1e-4 to 1e-12 off.
    Near,
    /// A form, and the same with another constant in another equation.
    Parallel,
    /// A form in two equations.
    Shared,
}

/// One of a range, both ends included.
fn between(dice: &mut Dice, low: i64, high: i64) -> i64 {
    low + dice.below((high - low + 1) as u64) as i64
}

fn chance(dice: &mut Dice, percent: u64) -> bool {
    dice.below(100) < percent
}

fn fraction(dice: &mut Dice) -> Rational {
    let denominator = [1, 1, 1, 2, 3, 5][dice.below(6) as usize];
    Rational::from((between(dice, -9, 9), denominator))
}

fn nonzero(dice: &mut Dice, size: i64) -> Rational {
    let value = between(dice, 1, size);
    Rational::from(if chance(dice, 50) { -value } else { value })
}

/// 10 to this power.
fn ten(power: i64) -> Rational {
    let size = (0..power.unsigned_abs()).fold(Rational::from(1), |p, _| p * 10);
    if power < 0 { size.recip() } else { size }
}

/// 2 to this power.
fn two(power: i64) -> Rational {
    let size = (0..power.unsigned_abs()).fold(Rational::from(1), |p, _| p * 2);
    if power < 0 { size.recip() } else { size }
}

/// (x - a)^2 + b^2, to a power; linear where b is 0.
#[derive(Clone)]
struct Factor {
    a: Rational,
    b: Rational,
    power: u32,
}

impl Factor {
    /// With `x` put in.
    fn of(&self, x: &Polynomial, n: usize) -> Polynomial {
        let linear = x.minus(&Polynomial::constant(n, self.a.clone()));
        let factor = match self.b == 0 {
            true => linear,
            false => {
                let square = Rational::from(&self.b * &self.b);
                linear.times(&linear).plus(&Polynomial::constant(n, square))
            }
        };
        factor.power(self.power)
    }

    fn roots(&self) -> Vec<ComplexRational> {
        let one = ComplexRational::new(self.a.clone(), self.b.clone());
        match self.b == 0 {
            true => vec![one],
            false => vec![one.conjugate(), one],
        }
    }

    fn degree(&self) -> u32 {
        self.power * if self.b == 0 { 1 } else { 2 }
    }
}

/// Factors whose degrees add up to `degree` at most, at least one.
fn factors(dice: &mut Dice, style: Style, degree: u32) -> Vec<Factor> {
    let mut factors = Vec::<Factor>::new();
    let mut left = degree;
    while left > 0 && (factors.is_empty() || chance(dice, 75)) {
        let mut a = fraction(dice);
        let power = match style {
            Style::Multiple if chance(dice, 60) => {
                between(dice, 2, i64::from(left.clamp(2, 5))) as u32
            }
            _ => 1,
        };
        if style == Style::Scales && chance(dice, 60) {
            a *= ten(between(dice, -12, 12));
        }
        let mut b = Rational::new();
        let pair = chance(dice, 25) && 2 * power <= left;
        if pair {
            b = nonzero(dice, 5);
            if style == Style::Scales {
                b *= ten(between(dice, -8, 8));
            }
        }
        if style == Style::Near
            && let Some(beside) = factors.last()
            && chance(dice, 70)
        {
            a = &beside.a + ten(-between(dice, 4, 12));
            b = beside.b.clone();
        }
        let factor = Factor { a, b, power };
        if factor.degree() > left {
            break;
        }
        left -= factor.degree();
        factors.push(factor);
    }
    if factors.is_empty() {
        factors.push(Factor {
            a: fraction(dice),
            b: Rational::new(),
            power: 1,
        });
    }
    factors
}

fn product(factors: &[Factor], x: &Polynomial, n: usize) -> Polynomial {
    let one = Polynomial::constant(n, Rational::from(1));
    factors
        .iter()
        .fold(one, |p, factor| p.times(&factor.of(x, n)))
}

/// Points with multiplicities that add up where points are the same.
#[derive(Default)]
struct Points(Vec<Root>);

impl Points {
    fn add(&mut self, point: Vec<ComplexRational>, multiplicity: u64) {
        match self.0.iter_mut().find(|root| root.point == point) {
            Some(root) => root.multiplicity += multiplicity,
            None => self.0.push(Root {
                point,
                multiplicity,
            }),
        }
    }
}

fn names(n: usize) -> Vec<String> {
    ["x", "y", "z", "w"][..n]
        .iter()
        .map(|&name| name.into())
        .collect()
}

fn finish(equations: &[Polynomial], roots: Points, on_a_set: bool) -> Planted {
    let n = names(4);
    let count = roots.0.first().map_or(0, |root| root.point.len());
    let variables = if count > 0 {
        count
    } else {
        equations.len().min(4)
    };
    Planted {
        kind: "",
        equations: equations.iter().map(|p| p.text(&n[..variables])).collect(),
        variables: names(variables),
        roots: roots.0,
        on_a_set,
        square: equations.len() == variables,
    }
}

fn one_unknown(dice: &mut Dice) -> Planted {
    let style = [Style::Plain, Style::Multiple, Style::Scales, Style::Near];
    let style = style[dice.below(4) as usize];
    let factors = factors(dice, style, 9);
    let mut points = Points::default();
    for factor in &factors {
        for root in factor.roots() {
            points.add(vec![root], u64::from(factor.power));
        }
    }
    let f = product(&factors, &Polynomial::variable(1, 0), 1);
    finish(&[f], points, false)
}

/// f_1(x_1) and f_k(x_k - c x_1): the polynomials, and the solutions.
fn triangle(dice: &mut Dice, style: Style, n: usize) -> (Vec<Polynomial>, Points) {
    let mut points = vec![(Vec::<ComplexRational>::new(), 1u64)];
    let mut equations = Vec::new();
    let degree = if n == 2 { 4 } else { 3 };
    for k in 0..n {
        let c = match k {
            0 => Rational::new(),
            _ => Rational::from(between(dice, -2, 2)),
        };
        let factors = factors(dice, style, degree);
        let mut x = Polynomial::variable(n, k);
        if k > 0 {
            let bent = Polynomial::variable(n, 0).times(&Polynomial::constant(n, c.clone()));
            x = x.minus(&bent);
        }
        equations.push(product(&factors, &x, n));
        let mut longer = Vec::new();
        for (point, multiplicity) in &points {
            for factor in &factors {
                for root in factor.roots() {
                    let mut point = point.clone();
                    let shift = match point.first() {
                        Some(first) => first.multiply(&ComplexRational::real(c.clone())),
                        None => ComplexRational::default(),
                    };
                    point.push(root.add(&shift));
                    longer.push((point, multiplicity * u64::from(factor.power)));
                }
            }
        }
        points = longer;
    }
    let mut all_points = Points::default();
    points
        .into_iter()
        .for_each(|(point, m)| all_points.add(point, m));
    (equations, all_points)
}

/// An integer matrix of determinant 1 and its inverse.
fn unimodular(dice: &mut Dice, n: usize) -> [Vec<Vec<Rational>>; 2] {
    let unit = |n: usize| -> Vec<Vec<Rational>> {
        let row = |i: usize| (0..n).map(|j| Rational::from(u8::from(i == j))).collect();
        (0..n).map(row).collect()
    };
    let (mut a, mut inverse) = (unit(n), unit(n));
    for _ in 0..n {
        let i = dice.below(n as u64) as usize;
        let j = (i + 1 + dice.below(n as u64 - 1) as usize) % n;
        let c = nonzero(dice, 2);
        // Row i of the matrix takes c times row j, column j of the inverse loses c times column i.
        let row = a[j].clone();
        for (entry, other) in a[i].iter_mut().zip(&row) {
            *entry += Rational::from(&c * other);
        }
        for row in &mut inverse {
            let other = row[i].clone();
            row[j] -= Rational::from(&c * &other);
        }
    }
    [a, inverse]
}

/// The system in other coordinates y, where x = A y.
fn turned(dice: &mut Dice, equations: &[Polynomial], points: Points) -> (Vec<Polynomial>, Points) {
    let n = points.0[0].point.len();
    if n < 2 {
        return (equations.to_vec(), points);
    }
    let [a, inverse] = unimodular(dice, n);
    let forms: Vec<Polynomial> = a
        .iter()
        .map(|row| Polynomial::linear(row, Rational::new()))
        .collect();
    let equations = equations.iter().map(|f| f.substituted(&forms)).collect();
    let mut moved = Points::default();
    for root in points.0 {
        let point = inverse.iter().map(|row| {
            let terms = row.iter().zip(&root.point);
            terms.fold(ComplexRational::default(), |sum, (c, x)| {
                sum.add(&x.multiply(&ComplexRational::real(c.clone())))
            })
        });
        moved.add(point.collect(), root.multiplicity);
    }
    (equations, moved)
}

fn triangular(dice: &mut Dice, style: Style) -> Planted {
    let n = 2 + usize::from(chance(dice, 30));
    let (mut equations, mut points) = triangle(dice, style, n);
    if chance(dice, 60) {
        (equations, points) = turned(dice, &equations, points);
    }
    finish(&equations, points, false)
}

fn forms(dice: &mut Dice, planting: Planting) -> Planted {
    let n = 2 + usize::from(chance(dice, 40));
    let most = if n == 2 { 4 } else { 3 };
    let mut equation_forms = Vec::<Vec<Vec<Rational>>>::new();
    for _ in 0..n {
        let count = between(dice, 1, most) as usize;
        let mut of_equation = Vec::<Vec<Rational>>::new();
        for _ in 0..count {
            let mut form: Vec<Rational> = (0..n).map(|_| between(dice, -4, 4).into()).collect();
            if form.iter().all(|c| *c == 0) {
                form[0] = Rational::from(1);
            }
            form.push(fraction(dice));
            let before = of_equation.last().cloned();
            let others: Vec<&Vec<Rational>> = equation_forms.iter().flatten().collect();
            let elsewhere = match others.is_empty() {
                true => None,
                false => Some(others[dice.below(others.len() as u64) as usize].clone()),
            };
            let is_planted = chance(dice, 60);
            form = match (planting, before, elsewhere) {
                (Planting::Repeated, Some(same), _) if is_planted => same,
                (Planting::Near, Some(mut same), _) if is_planted => {
                    same[n] += ten(-between(dice, 4, 12));
                    same
                }
                (Planting::Parallel, _, Some(mut other)) if is_planted => {
                    other[n] += nonzero(dice, 5);
                    other
                }
                (Planting::Shared, _, Some(other)) if is_planted => other,
                _ => form,
            };
            of_equation.push(form);
        }
        equation_forms.push(of_equation);
    }
    let equations: Vec<Polynomial> = equation_forms
        .iter()
        .map(|forms| product_of_forms(forms, n))
        .collect();
    let (points, on_a_set) = meetings(&equation_forms);
    let mut planted = finish(&equations, points, on_a_set);
    planted.variables = names(n);
    planted.equations = equations
        .iter()
        .map(|p| p.text(&planted.variables))
        .collect();
    planted.square = true;
    planted
}

fn product_of_forms(forms: &[Vec<Rational>], n: usize) -> Polynomial {
    let one = Polynomial::constant(n, Rational::from(1));
    forms.iter().fold(one, |p, form| {
        p.times(&Polynomial::linear(&form[..n], form[n].clone()))
    })
}

/// Where one form of each equation vanishes: isolated points, and whether there is more.
fn meetings(equation_forms: &[Vec<Vec<Rational>>]) -> (Points, bool) {
    let mut choices = vec![Vec::<Vec<Rational>>::new()];
    for forms in equation_forms {
        let longer = choices.iter().flat_map(|choice| {
            forms.iter().map(|form| {
                let mut choice = choice.clone();
                choice.push(form.clone());
                choice
            })
        });
        choices = longer.collect();
    }
    let mut meeting_points = BTreeMap::<Vec<Rational>, u64>::new();
    let mut sets = Vec::new();
    for choice in choices {
        match solve(&choice) {
            Flat::Empty => {}
            Flat::Point(point) => *meeting_points.entry(point).or_default() += 1,
            Flat::Set => sets.push(choice),
        }
    }
    let on = |point: &[Rational], form: &[Rational]| {
        let mut sum = form[point.len()].clone();
        for (x, c) in point.iter().zip(form) {
            sum += Rational::from(x * c);
        }
        sum == 0
    };
    meeting_points.retain(|point, _| {
        !sets
            .iter()
            .any(|set| set.iter().all(|form| on(point, form)))
    });
    let mut points = Points::default();
    for (point, multiplicity) in meeting_points {
        let point = point.into_iter().map(ComplexRational::real).collect();
        points.add(point, multiplicity);
    }
    (points, !sets.is_empty())
}

/// x_i^2 = c_i with |c_i| from 1e-24 to 1e24, perhaps in other coordinates.
fn squares(dice: &mut Dice) -> Planted {
    let n = between(dice, 1, 3) as usize;
    let mut points = vec![Vec::<ComplexRational>::new()];
    let mut equations = Vec::new();
    for k in 0..n {
        let size = nonzero(dice, 9) * ten(between(dice, -12, 12));
        let imaginary = chance(dice, 30);
        let root = match imaginary {
            true => ComplexRational::new(0, size.clone()),
            false => ComplexRational::real(size.clone()),
        };
        let square = root.multiply(&root).re;
        let x = Polynomial::variable(n, k);
        equations.push(x.times(&x).minus(&Polynomial::constant(n, square)));
        points = points
            .iter()
            .flat_map(|point| [root.clone(), root.negate()].map(|x| [&point[..], &[x]].concat()))
            .collect();
    }
    let mut square_points = Points::default();
    points
        .into_iter()
        .for_each(|point| square_points.add(point, 1));
    if n > 1 && chance(dice, 30) {
        (equations, square_points) = turned(dice, &equations, square_points);
    }
    finish(&equations, square_points, false)
}

/// f_1(x y^a) and f_2(y), with all roots of f_2 different from 0.
fn monomial_map(dice: &mut Dice) -> Planted {
    let style = [Style::Plain, Style::Multiple, Style::Scales][dice.below(3) as usize];
    let a = between(dice, 1, 3) as u32;
    let (x, y) = (Polynomial::variable(2, 0), Polynomial::variable(2, 1));
    let of_u = factors(dice, style, 3);
    let mut of_y = factors(dice, style, 3);
    for factor in &mut of_y {
        if factor.a == 0 {
            factor.a = Rational::from(1);
        }
    }
    let mut points = Points::default();
    for second in &of_y {
        for root in second.roots() {
            for first in &of_u {
                for u in first.roots() {
                    let x = u.divide(&root.power(a)).expect("it is not 0");
                    points.add(vec![x, root.clone()], u64::from(first.power * second.power));
                }
            }
        }
    }
    let f = product(&of_u, &x.times(&y.power(a)), 2);
    finish(&[f, product(&of_y, &y, 2)], points, false)
}

/// f(x) and (x - r) (y - a) + c: the solution over the root r of f is at infinity.
fn escaping(dice: &mut Dice) -> Planted {
    let style = [Style::Plain, Style::Multiple, Style::Near][dice.below(3) as usize];
    let factors = factors(dice, style, 5);
    let far = factors[0].a.clone();
    let (a, c) = (fraction(dice), nonzero(dice, 9) * ten(between(dice, -6, 6)));
    let (x, y) = (Polynomial::variable(2, 0), Polynomial::variable(2, 1));
    let away = x.minus(&Polynomial::constant(2, far.clone()));
    let g = away
        .times(&y.minus(&Polynomial::constant(2, a.clone())))
        .plus(&Polynomial::constant(2, c.clone()));
    let mut points = Points::default();
    for factor in &factors {
        for root in factor.roots() {
            let distance = root.subtract(&ComplexRational::real(far.clone()));
            let Some(step) = ComplexRational::real(c.clone()).divide(&distance) else {
                continue;
            };
            let y = ComplexRational::real(a.clone()).subtract(&step);
            points.add(vec![root, y], u64::from(factor.power));
        }
    }
    let mut planted = finish(&[product(&factors, &x, 2), g], points, false);
    planted.variables = names(2);
    planted
}

/// A parabola with tangents and chords, perhaps in other coordinates.
fn tangents(dice: &mut Dice) -> Planted {
    let (x, y) = (Polynomial::variable(2, 0), Polynomial::variable(2, 1));
    let mut lines = Polynomial::constant(2, Rational::from(1));
    let mut points = Points::default();
    for _ in 0..between(dice, 1, 3) {
        let a = fraction(dice);
        let b = match dice.below(3) {
            0 => a.clone(),
            1 => &a + ten(-between(dice, 4, 12)),
            _ => fraction(dice),
        };
        // y = (a + b) x - a b meets y = x^2 at x = a and x = b.
        let slope = Polynomial::constant(2, Rational::from(&a + &b));
        let line = y.minus(&slope.times(&x));
        let constant = Polynomial::constant(2, Rational::from(&a * &b));
        lines = lines.times(&line.plus(&constant));
        for root in [a, b] {
            let square = Rational::from(&root * &root);
            points.add([root, square].map(ComplexRational::real).to_vec(), 1);
        }
    }
    let mut equations = vec![y.minus(&x.times(&x)), lines];
    if chance(dice, 40) {
        (equations, points) = turned(dice, &equations, points);
    }
    finish(&equations, points, false)
}

/// A triangular system times a line or circle: what does not lie there stays isolated.
fn common_factor(dice: &mut Dice) -> Planted {
    let style = if chance(dice, 50) {
        Style::Plain
    } else {
        Style::Multiple
    };
    let (equations, points) = triangle(dice, style, 2);
    let (x, y) = (Polynomial::variable(2, 0), Polynomial::variable(2, 1));
    let constant = Polynomial::constant(2, fraction(dice));
    let common = match dice.below(3) {
        0 => x.plus(&y).minus(&constant),
        1 => x.times(&x).plus(&y.times(&y)).minus(&constant),
        _ => x.times(&y).minus(&constant),
    };
    let equations: Vec<Polynomial> = equations.iter().map(|f| f.times(&common)).collect();
    let mut apart = Points::default();
    for root in points.0 {
        let values = root.point.iter();
        let there = common.at(&values.cloned().collect::<Vec<_>>());
        if !there.is_zero() {
            apart.add(root.point, root.multiplicity);
        }
    }
    let mut planted = finish(&equations, apart, true);
    planted.variables = names(2);
    planted
}

/// A triangular system with one equation more, which holds at some of its solutions.
fn overdetermined(dice: &mut Dice) -> Planted {
    let (mut equations, points) = triangle(dice, Style::Plain, 2);
    let (x, y) = (Polynomial::variable(2, 0), Polynomial::variable(2, 1));
    let mut more = Polynomial::constant(2, Rational::from(1));
    let slope = Polynomial::constant(2, nonzero(dice, 7));
    for root in points.0.iter().filter(|root| root.is_real()).take(2) {
        let [a, b] = [0, 1].map(|k| Polynomial::constant(2, root.point[k].re.clone()));
        more = more.times(&x.minus(&a).plus(&slope.times(&y.minus(&b))));
    }
    if more.degree() == 0 {
        more = x.minus(&Polynomial::constant(2, Rational::from(1000)));
    }
    let mut kept = Points::default();
    for root in points.0 {
        if more.at(&root.point).is_zero() {
            kept.add(root.point, root.multiplicity);
        }
    }
    equations.push(more);
    let mut planted = finish(&equations, kept, false);
    planted.variables = names(2);
    planted.square = false;
    planted
}

/// A plain system, in units of 2^-40 to 2^40 for each variable and 2^-200 to 2^200 for each equation.
fn units(dice: &mut Dice) -> Planted {
    let (mut equations, points) = triangle(dice, Style::Plain, 2);
    let (mut equations_turned, points) = turned(dice, &equations, points);
    equations.clear();
    let scales: Vec<Rational> = (0..2).map(|_| two(between(dice, -40, 40))).collect();
    let scaled: Vec<Polynomial> = (0..2)
        .map(|k| Polynomial::variable(2, k).times(&Polynomial::constant(2, scales[k].clone())))
        .collect();
    for f in equations_turned.drain(..) {
        let unit = Polynomial::constant(2, two(between(dice, -200, 200)));
        equations.push(f.substituted(&scaled).times(&unit));
    }
    let mut moved = Points::default();
    for root in points.0 {
        let point = root.point.iter().zip(&scales);
        let point = point.map(|(x, s)| {
            let s = ComplexRational::real(s.clone());
            x.divide(&s).expect("a power of 2")
        });
        moved.add(point.collect(), root.multiplicity);
    }
    finish(&equations, moved, false)
}
