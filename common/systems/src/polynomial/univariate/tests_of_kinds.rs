//! Random equations of ten kinds, with their answers by construction or by Sturm's count of real roots.
//!
//! The measurement takes many of each kind:
//! `cargo test --release -p cognate-systems --lib tests_of_kinds -- --ignored --nocapture`; `COGNATE_EQUATIONS` says how
//! many (10,000).

use super::{UnivariateRoots, univariate_roots};
use crate::formats::read;
use crate::polynomial::univariate::exact_polynomial::ExactPolynomial;
use crate::polynomial::univariate::expand::expand;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use num_complex::Complex64;
use rug::Integer;
use std::collections::BTreeMap;

const OPERATIONS: u64 = 1 << 36;
const KINDS: usize = 10;

/// A root by construction.
type Root = (Rational, Rational);

/// An equation, and its roots with their multiplicities where they were chosen.
struct Planted {
    text: String,
    roots: Option<BTreeMap<Root, u32>>,
}

struct Generator {
    stream: RandomStream,
    /// The largest degree, about.
    degree: u64,
}

impl Generator {
    fn below(&mut self, bound: u64) -> u64 {
        self.stream.below(bound)
    }

    fn between(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as u64) as i64
    }

    /// A positive integer of `digits` decimal digits, or up to 19 less.
    fn long(&mut self, digits: u64) -> String {
        let count = digits - self.below(20);
        let each = (0..count).map(|k| self.between(i64::from(k == 0), 9).to_string());
        each.collect::<Vec<_>>().concat()
    }

    fn planted(&mut self, kind: usize) -> Planted {
        match kind {
            0 => self.integers(),
            1 => self.multiple(),
            2 => self.cluster(),
            3 => self.scales(),
            4 => self.laurent(),
            5 => self.chebyshev(),
            6 => self.mignotte(),
            7 => self.few_terms(),
            8 => self.long_coefficients(),
            _ => self.dense(),
        }
    }

    /// Wilkinson's kind: consecutive integers.
    fn integers(&mut self) -> Planted {
        let count = 2 + self.below(self.degree.min(40));
        let first = self.between(-20, 20);
        let roots = (0..count as i64).map(|k| (Rational::from(first + k), Rational::new()));
        product(roots.map(|root| (root, 1)).collect(), "")
    }

    fn multiple(&mut self) -> Planted {
        let mut roots = BTreeMap::new();
        for _ in 0..1 + self.below(5) {
            let re = Rational::from((self.between(-9, 9), self.between(1, 5)));
            let im = Rational::from((self.between(-3, 3), self.between(1, 3)));
            roots.insert(
                (re, im),
                1 + self.below((self.degree / 8).clamp(2, 9)) as u32,
            );
        }
        product(roots, "")
    }

    /// Roots 10^-10 to 10^-40 apart.
    fn cluster(&mut self) -> Planted {
        let power = Integer::from(Integer::u_pow_u(10, self.between(10, 40) as u32));
        let centre = Rational::from((self.between(-9, 9), self.between(1, 9)));
        let mut roots = BTreeMap::new();
        for k in 0..2 + self.between(0, 2) {
            let step = Rational::from((Integer::from(k), power.clone()));
            roots.insert((Rational::from(&centre + &step), Rational::new()), 1);
        }
        for k in 0..self.between(0, 5) {
            roots.insert(
                (Rational::from(20 + k), Rational::new()),
                1 + (k as u32) % 2,
            );
        }
        product(roots, "")
    }

    /// Roots of very different sizes.
    fn scales(&mut self) -> Planted {
        let mut roots = BTreeMap::new();
        for _ in 0..2 + self.below(10) {
            let power = Integer::from(Integer::u_pow_u(10, self.below(100) as u32));
            let factor = Integer::from(self.between(1, 9) * (2 * self.between(0, 1) - 1));
            let root = match self.below(2) {
                0 => Rational::from((factor, power)),
                _ => Rational::from(factor * power),
            };
            roots.insert((root, Rational::new()), 1 + (self.below(5) == 0) as u32);
        }
        product(roots, "")
    }

    /// A product divided by a power of the unknown.
    fn laurent(&mut self) -> Planted {
        let Planted { text, roots } = self.multiple();
        let mut roots = roots.expect("a product has planted roots");
        roots.remove(&(Rational::new(), Rational::new()));
        let exponent = 1 + self.below(30);
        let text = format!("({text})/x^{exponent} = 0");
        Planted {
            text,
            roots: Some(roots),
        }
    }

    fn chebyshev(&mut self) -> Planted {
        let n = 3 + self.below(self.degree.min(120));
        let shift = self.between(-3, 3);
        let mut text = format!("y := x - {shift}\nT0 := 1\nT1 := y\n").replace("- -", "+ ");
        for k in 2..=n {
            text += &format!("T{k} := 2*y*T{} - T{}\n", k - 1, k - 2);
        }
        let text = format!("{text}T{n}");
        Planted { text, roots: None }
    }

    fn mignotte(&mut self) -> Planted {
        let n = 3 + self.below(self.degree.min(60));
        let a = 10 + self.below(5000);
        let text = format!("x^{n} - 2*({a}*x - 1)^2");
        Planted { text, roots: None }
    }

    fn few_terms(&mut self) -> Planted {
        let n = 3 + self.below(self.degree);
        let text = format!(
            "x^{n} + {}*x^{} - {}*x^{} + {}",
            self.between(1, 99),
            n / 2,
            self.between(1, 99),
            1 + self.below(n / 2),
            self.between(1, 99),
        );
        Planted { text, roots: None }
    }

    fn long_coefficients(&mut self) -> Planted {
        let terms = (0..=3 + self.below(10)).map(|k| format!("{}*x^{k}", self.long(1000)));
        let text = terms.collect::<Vec<_>>().join(" - ");
        Planted { text, roots: None }
    }

    fn dense(&mut self) -> Planted {
        let i = if self.below(4) == 0 { "*(2 + I)" } else { "" };
        let terms = (0..=2 + self.below(self.degree)).map(|k| {
            let c = self.between(1, 999);
            let i = if k % 3 == 1 { i } else { "" };
            format!("{c}{i}*x^{k}")
        });
        let terms: Vec<String> = terms.collect();
        let text = terms.join([" + ", " - "][self.below(2) as usize]);
        Planted { text, roots: None }
    }
}

/// The equation with these roots.
fn product(roots: BTreeMap<Root, u32>, more: &str) -> Planted {
    let factors = roots.iter().map(|((re, im), multiplicity)| {
        let denominator = Integer::from(re.denom().lcm_ref(im.denom()));
        let scaled = |part: &Rational| Rational::from(part * &denominator);
        format!(
            "({denominator}*x - ({}) - ({})*I)^{multiplicity}",
            scaled(re),
            scaled(im)
        )
    });
    let text = factors.collect::<Vec<_>>().join("*") + more;
    Planted {
        text,
        roots: Some(roots),
    }
}

/// Lists the faults of the answer to an equation; empty where there are none.
fn faults(planted: &Planted) -> Vec<String> {
    let system = read("test", planted.text.as_bytes())
        .expect("an equation")
        .system;
    let polynomial = expand(&system.expressions, system.equations[0], &[]).expect("rational");
    let roots = match univariate_roots(&system, &[], 16, OPERATIONS) {
        Ok(roots) => roots,
        Err(reason) => return vec![format!("{reason:?}")],
    };
    let mut faults = Vec::new();
    if roots.degree as usize != polynomial.degree() {
        faults.push(format!(
            "degree {} of {}",
            roots.degree,
            polynomial.degree()
        ));
    }
    match &planted.roots {
        Some(expected) => compare(&roots, expected, &mut faults),
        None => count_real(&roots, &polynomial, &mut faults),
    }
    check_sum(&roots, &polynomial, &mut faults);
    faults
}

fn compare(roots: &UnivariateRoots, expected: &BTreeMap<Root, u32>, faults: &mut Vec<String>) {
    let kept: Vec<_> = roots.roots.iter().filter(|root| !root.is_removed).collect();
    if kept.len() != expected.len() {
        faults.push(format!("{} roots, not {}", kept.len(), expected.len()));
        return;
    }
    for (root, ((re, im), multiplicity)) in kept.iter().zip(expected) {
        let expected = ComplexRational::new(re.clone(), im.clone());
        let difference = root.value.subtract(&expected);
        let square =
            |c: &ComplexRational| Rational::from(&c.re * &c.re) + Rational::from(&c.im * &c.im);
        let bound = Rational::from_f64(root.error * 1.000001).unwrap_or_default();
        let is_near = square(&difference) <= square(&root.value) * (bound.clone() * &bound);
        let is_zero = (root.value.re == 0, root.value.im == 0) == (*re == 0, *im == 0);
        if !is_near || !is_zero || root.multiplicity != *multiplicity {
            faults.push(format!("{:?} times {}", root.rounded, root.multiplicity));
        }
        // Exactly rational roots may be half-way between doubles.
        let to_double = Complex64::new(re.to_f64(), im.to_f64());
        let off = (to_double - root.rounded).norm_sqr();
        if off > to_double.norm_sqr() * f64::EPSILON * f64::EPSILON {
            faults.push(format!("{:?} is not {to_double:?}", root.rounded));
        }
    }
}

/// Sturm's count of distinct real roots, of polynomials with real coefficients.
fn count_real(roots: &UnivariateRoots, polynomial: &ExactPolynomial, faults: &mut Vec<String>) {
    let real = roots.roots.iter().filter(|root| root.is_real()).count();
    if polynomial.is_real() {
        let expected = sturm_count(polynomial);
        if real != expected {
            faults.push(format!("{real} real roots, not {expected}"));
        }
        for root in &roots.roots {
            let image = root.rounded.conj();
            if !roots.roots.iter().any(|other| other.rounded == image) {
                faults.push(format!("no conjugate of {:?}", root.rounded));
            }
        }
    }
    for root in &roots.roots {
        if root.error > 1e-18 || root.residual > 1e-13 {
            faults.push(format!("{root:?}"));
        }
    }
}

/// Distinct real roots: sign changes of the chain at minus infinity less those at infinity.
fn sturm_count(polynomial: &ExactPolynomial) -> usize {
    let integers = |p: &ExactPolynomial| -> Vec<Integer> {
        p.coefficients.iter().map(|c| c.re.clone()).collect()
    };
    let mut chain = vec![integers(polynomial), integers(&polynomial.derivative())];
    while let [.., a, b] = &chain[..]
        && b.len() > 1
    {
        let next = negative_remainder(a.clone(), b);
        if next.is_empty() {
            break;
        }
        chain.push(next);
    }
    let changes = |sign: &dyn Fn(&Vec<Integer>) -> bool| {
        let signs: Vec<bool> = chain.iter().map(sign).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    let at_infinity = |p: &Vec<Integer>| p[p.len() - 1] > 0;
    let at_minus = |p: &Vec<Integer>| (p[p.len() - 1] > 0) == (p.len() % 2 == 1);
    changes(&|p| at_minus(p)) - changes(&at_infinity)
}

/// A positive multiple of -(a mod b).
fn negative_remainder(mut a: Vec<Integer>, b: &[Integer]) -> Vec<Integer> {
    let leading = &b[b.len() - 1];
    let size = Integer::from(leading.abs_ref());
    while a.len() >= b.len() {
        let top = a[a.len() - 1].clone();
        let place = a.len() - b.len();
        let sign = if *leading > 0 { 1 } else { -1 };
        for c in &mut a {
            *c *= &size;
        }
        for (k, c) in b.iter().enumerate() {
            a[place + k] -= Integer::from(&top * c) * sign;
        }
        while a.last().is_some_and(|c| *c == 0) {
            a.pop();
        }
    }
    let mut content = Integer::new();
    for c in &a {
        content.gcd_mut(c);
    }
    for c in &mut a {
        c.div_exact_mut(&content);
        *c *= -1;
    }
    a
}

/// The sum of all roots is that of the second coefficient over the leading one (Vieta).
fn check_sum(roots: &UnivariateRoots, polynomial: &ExactPolynomial, faults: &mut Vec<String>) {
    let degree = polynomial.degree();
    let below = polynomial.coefficients[degree - 1].to_rational();
    let sum = below.divide(&polynomial.leading().to_rational());
    let mut rest = sum.expect("a leading coefficient is not 0");
    let mut size = Rational::new();
    for root in &roots.roots {
        let times = ComplexRational::real(root.multiplicity);
        rest = rest.add(&root.value.multiply(&times));
        let parts = [&root.value.re, &root.value.im].map(|part| part.clone().abs());
        size += parts[0].clone() + &parts[1];
    }
    let left = rest.re.abs() + rest.im.abs();
    let bound = size * Rational::from((degree as u64, 1_000_000_000_000_000u64));
    if left > bound {
        faults.push(format!("the sum of the roots is off by {}", left.to_f64()));
    }
}

/// Panics with the faults of all answers to `equations` random equations.
fn check_many(equations: u64, degree: u64, seed: u64) {
    let mut wrong = Vec::new();
    for index in 0..equations {
        let stream = RandomStream::new(seed, Purpose::Probe, index);
        let kind = index as usize % KINDS;
        let planted = Generator { stream, degree }.planted(kind);
        let faults = faults(&planted);
        if !faults.is_empty() {
            let text = &planted.text;
            wrong.push(format!("kind {kind}, number {index}: {faults:?}\n{text}"));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {equations}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn random_equations_of_ten_kinds_are_answered() {
    check_many(200, 20, 1);
}

#[test]
#[ignore = "a measurement"]
fn many_random_equations_of_ten_kinds() {
    let count = std::env::var("COGNATE_EQUATIONS").ok();
    let count = count.and_then(|text| text.parse().ok());
    check_many(count.unwrap_or(10_000), 200, 2);
}
