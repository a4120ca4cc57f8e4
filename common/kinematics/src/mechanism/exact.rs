//! Numbers and angles of a mechanism as they are written: decimals, fractions, roots and multiples of pi.
//!
//! `Number` keeps the exact rational where there is one; `Angle` keeps cosine, sine and half-tangent, exact for
//! multiples of 90 degrees, also for those that a file rounds.

use crate::plane;
use cognate_numeric::rational::Rational;
use cognate_numeric::scalar::Real;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Names of pi in a file.
const PI_NAMES: [&str; 4] = ["pi", "Pi", "PI", "π"];
/// pi to 40 digits, for the comparison with rounded multiples.
const PI_DIGITS: &str = "3.141592653589793238462643383279502884197";
/// The sign of typeset numbers, U+2212.
const MINUS: char = '−';
/// Most characters of one number.
const MOST_CHARACTERS: usize = 2000;
/// Most nested brackets of one number.
const MOST_NESTING: usize = 20;
/// Largest power of ten in a number.
const MOST_EXPONENT: u32 = 300;

/// A real number: exact where it was written so, else the double that is nearest.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// The value that is computed with.
    pub value: Rational,
    /// Whether that is the number meant, and not a double near to an irrational one.
    pub exact: bool,
    /// The number as a multiple of a square root, where it was written so; also where it is rational.
    pub surd: Option<Box<Surd>>,
    /// The number as it was written, where that is exact and no multiple of one root: `(1+sqrt(5))`.
    pub in_roots: Option<Box<str>>,
}

/// A rational times the square root of a positive rational, exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Surd {
    /// The factor before the root.
    pub coefficient: Rational,
    /// The number under the root.
    pub radicand: Rational,
}

impl Surd {
    /// A rational number.
    pub fn rational(value: Rational) -> Self {
        Self {
            coefficient: value,
            radicand: Rational::from(1),
        }
    }

    /// The root of a rational; `None` where that is negative.
    pub fn root(value: &Rational) -> Option<Self> {
        if *value == 0 {
            return Some(Self::rational(Rational::new()));
        }
        (*value > 0).then(|| Self {
            coefficient: Rational::from(1),
            radicand: value.clone(),
        })
    }

    /// The number in an expression, exactly.
    pub fn expression(&self) -> String {
        let coefficient = expression(&self.coefficient);
        match self.radicand == 1 || self.coefficient == 0 {
            true => coefficient,
            false => format!("({coefficient}*sqrt({}))", self.radicand),
        }
    }

    /// The square of the number.
    pub fn square(&self) -> Rational {
        Rational::from(&self.coefficient * &self.coefficient) * &self.radicand
    }

    fn times(&self, other: &Self) -> Self {
        Self {
            coefficient: Rational::from(&self.coefficient * &other.coefficient),
            radicand: Rational::from(&self.radicand * &other.radicand),
        }
    }

    /// `None` for 0.
    fn inverse(&self) -> Option<Self> {
        let over = Rational::from(&self.coefficient * &self.radicand);
        (over != 0).then(|| Self {
            coefficient: over.recip(),
            radicand: self.radicand.clone(),
        })
    }

    /// `None` where the sum is no multiple of one root.
    fn plus(&self, other: &Self, sign: i32) -> Option<Self> {
        if other.coefficient == 0 || self.radicand == other.radicand {
            let more = Rational::from(&other.coefficient * sign);
            return Some(Self {
                coefficient: Rational::from(&self.coefficient + &more),
                radicand: self.radicand.clone(),
            });
        }
        (self.coefficient == 0).then(|| Self {
            coefficient: Rational::from(&other.coefficient * sign),
            radicand: other.radicand.clone(),
        })
    }
}

impl Number {
    /// An integer.
    pub fn integer(n: i64) -> Self {
        Self::rational(Rational::from(n))
    }

    /// The number of this double, exactly; 0 if it is infinite or not a number.
    pub fn of_double(x: f64) -> Self {
        Self::rational(Rational::from_f64(x).unwrap_or_default())
    }

    /// A double near to the number that is meant; 0 if it is infinite or not a number.
    pub fn rounded(x: f64) -> Self {
        Self {
            exact: false,
            surd: None,
            ..Self::of_double(x)
        }
    }

    /// A rational number.
    pub fn rational(value: Rational) -> Self {
        Self {
            surd: Some(Box::new(Surd::rational(value.clone()))),
            value,
            exact: true,
            in_roots: None,
        }
    }

    /// A number as written: `0.25`, `1e-3`, `384/145`, `sqrt(3)/2`; `None` for anything else.
    pub fn read(text: &str) -> Option<Self> {
        let value = Value::read(text)?;
        if value.turns == 0 {
            let surd = value.surd().map(Box::new);
            let in_roots = surd.is_none() && !PI_NAMES.iter().any(|name| text.contains(name));
            return Some(Self {
                surd,
                value: value.plain,
                exact: value.exact,
                in_roots: in_roots.then(|| format!("({})", text.trim()).into()),
            });
        }
        Some(Self {
            value: Rational::from_f64(value.to_f64())?,
            exact: false,
            surd: None,
            in_roots: None,
        })
    }

    /// The nearest double.
    pub fn to_f64(&self) -> f64 {
        nearest(&self.value)
    }

    /// The number in an expression: `0`, `3`, `(-3/5)`.
    pub fn expression(&self) -> String {
        expression(&self.value)
    }

    /// The number in an expression, without rounding where it is written in roots: `((1/2)*sqrt(3))`.
    pub fn exact_expression(&self) -> String {
        match (self.surd.as_deref(), self.in_roots.as_deref()) {
            (Some(surd), _) if !self.exact => surd.expression(),
            (None, Some(text)) => text.into(),
            _ => self.expression(),
        }
    }

    /// The square of the number in an expression; of a multiple of a root the rational that it is.
    pub fn square_expression(&self) -> String {
        match self.surd.as_deref() {
            Some(surd) => expression(&surd.square()),
            None => format!("{}^2", self.exact_expression()),
        }
    }

    /// Whether [`Self::exact_expression`] is the number that was meant.
    pub fn is_exact_in_expressions(&self) -> bool {
        self.exact || self.surd.is_some() || self.in_roots.is_some()
    }

    /// The number as JSON: a decimal where that is exact and short, else a string.
    pub fn json(&self) -> String {
        let double = self.to_f64();
        let text = format!("{double:?}");
        match Number::read(&text) {
            Some(back) if back.value == self.value || !self.exact => text,
            _ => format!("\"{}\"", self.value),
        }
    }
}

/// The double nearest to a rational.
fn nearest(value: &Rational) -> f64 {
    f64::from_rational((), value)
}

/// A rational in an expression.
pub fn expression(value: &Rational) -> String {
    if *value.denom() == 1 && *value >= 0 {
        value.to_string()
    } else {
        format!("({value})")
    }
}

/// A double in an expression, every bit of it.
pub fn double_expression(x: f64) -> String {
    expression(&Rational::from_f64(x).unwrap_or_default())
}

/// An angle: cosine and sine, the direction of half of it, and its value in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle {
    /// Cosine and sine.
    pub direction: [f64; 2],
    /// A multiple of the cosine and sine of half the angle: (w, t) with tan(angle/2) = t/w; small
    /// integers at multiples of 90 degrees.
    pub half: [f64; 2],
    /// The angle in radians, as given.
    pub radians: f64,
}

impl Angle {
    /// 0.
    pub const ZERO: Self = Self {
        direction: [1.0, 0.0],
        half: [1.0, 0.0],
        radians: 0.0,
    };

    /// The angle of `n` quarter turns, exactly.
    pub fn quarters(n: i64) -> Self {
        let k = n.rem_euclid(4) as usize;
        Self {
            direction: [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][k],
            half: [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, -1.0]][k],
            radians: n as f64 * (PI / 2.0),
        }
    }

    /// An angle in radians.
    pub fn of_radians(radians: f64) -> Self {
        if radians == 0.0 {
            return Self::ZERO;
        }
        Self {
            radians,
            ..Self::of_direction(plane::direction(radians * (180.0 / PI)))
        }
    }

    /// An angle in degrees; multiples of 90 are exact.
    pub fn of_degrees(degrees: f64) -> Self {
        let quarters = degrees / 90.0;
        if quarters == quarters.round() && quarters.abs() < 1e6 {
            return Self::quarters(quarters as i64);
        }
        Self {
            radians: degrees * (PI / 180.0),
            ..Self::of_direction(plane::direction(degrees))
        }
    }

    /// The sum of two angles; exact where it is a multiple of 90 degrees to the digits of a double.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        if other.radians == 0.0 {
            return *self;
        }
        if self.radians == 0.0 {
            return *other;
        }
        let radians = self.radians + other.radians;
        let quarters = (radians / (PI / 2.0)).round();
        let rounding = f64::EPSILON * (self.radians.abs() + other.radians.abs());
        match (radians - quarters * (PI / 2.0)).abs() <= rounding {
            true => Self::quarters(quarters as i64),
            false => Self::of_radians(radians),
        }
    }

    /// The angle of a vector; 0 for the vector 0.
    pub fn of_direction(z: Complex64) -> Self {
        let z = plane::unit(z);
        let half = plane::half(z);
        Self {
            direction: [z.re, z.im],
            half: [half.re, half.im],
            radians: radians(z),
        }
    }
}

/// The angle of a vector in radians, in (-pi, pi].
pub fn radians(z: Complex64) -> f64 {
    plane::degrees(z) * (PI / 180.0)
}

/// An angle that was read, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadAngle {
    /// The angle.
    pub angle: Angle,
    /// The digits that were taken for a right angle, where they were rounded.
    pub snapped: Option<String>,
}

/// Reads an angle as written in degrees or radians; `"90 deg"`, `"pi/2"` say their unit themselves.
/// With `snap` a multiple of pi/2 that is rounded to the digits given, at least three, is exact.
pub fn read_angle(text: &str, degrees: bool, snap: bool) -> Option<ReadAngle> {
    let trimmed = text.trim();
    let in_degrees = trimmed
        .strip_suffix("deg")
        .or_else(|| trimmed.strip_suffix('°'));
    let (body, degrees) = if let Some(body) = in_degrees {
        (body, true)
    } else if let Some(body) = trimmed.strip_suffix("rad") {
        (body, false)
    } else {
        (trimmed, degrees)
    };
    let value = Value::read(body)?;
    let plain = |angle| ReadAngle {
        angle,
        snapped: None,
    };
    if value.turns != 0 {
        // A multiple of pi is an angle in radians whatever the unit of the file.
        let quarters = Rational::from(&value.turns * 2u32);
        if value.plain == 0 && *quarters.denom() == 1 {
            return Some(plain(Angle::quarters(quarters.numer().to_i64()?)));
        }
        return Some(plain(Angle::of_radians(value.to_f64())));
    }
    if degrees {
        return Some(plain(Angle::of_degrees(nearest(&value.plain))));
    }
    if snap && let Some(quarters) = rounded_quarters(body.trim(), &value.plain) {
        return Some(ReadAngle {
            angle: Angle::quarters(quarters),
            snapped: Some(body.trim().to_owned()),
        });
    }
    Some(plain(Angle::of_radians(nearest(&value.plain))))
}

/// Whether a number without a unit is a right angle, a half turn or a whole one in radians, to 0.005, which no file means in
/// degrees.
pub fn looks_like_radians(text: &str) -> bool {
    let Some(value) = Value::read(text).filter(|value| value.turns == 0) else {
        return false;
    };
    let radians = value.to_f64().abs();
    let quarters = (radians / (PI / 2.0)).round();
    (1.0..=4.0).contains(&quarters) && (radians - quarters * (PI / 2.0)).abs() < 5e-3
}

/// The multiple of pi/2 that a decimal is, rounded to the digits that it has; at least three of them.
fn rounded_quarters(text: &str, value: &Rational) -> Option<i64> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let digits = mantissa.trim_start_matches(['+', '-', MINUS, '0', '.']);
    let significant = digits.chars().filter(char::is_ascii_digit).count();
    if significant < 3 || text.contains(['/', '(', '*']) {
        return None;
    }
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len()) as i32 - exponent;
    let quarter = Value::decimal(PI_DIGITS)? / 2u32;
    let quarters = Rational::from(value / &quarter).round();
    let quarters = quarters.numer().to_i64()?;
    if quarters == 0 {
        return None;
    }
    let error = (value - quarter * quarters).abs();
    // Half a unit of the last digit; a hair more where a double was printed.
    let unit = power_of_ten(-decimals)?;
    let slack = if significant >= 15 {
        Rational::from((3, 1))
    } else {
        Rational::from((501, 1000))
    };
    (error <= unit * slack).then_some(quarters)
}

fn power_of_ten(exponent: i32) -> Option<Rational> {
    if exponent.unsigned_abs() > MOST_EXPONENT {
        return None;
    }
    let mut power = Rational::from(1);
    for _ in 0..exponent.unsigned_abs() {
        power *= 10u32;
    }
    Some(if exponent < 0 { power.recip() } else { power })
}

/// Value of an expression in a file: the sum of a rational and a multiple of pi.
#[derive(Clone, Debug)]
struct Value {
    plain: Rational,
    /// Multiples of pi.
    turns: Rational,
    exact: bool,
    /// The value as a multiple of a root, where it is one and not rational.
    irrational: Option<Surd>,
}

impl Value {
    /// The value as a multiple of a root, where that is exact.
    fn surd(&self) -> Option<Surd> {
        match (self.turns == 0, self.exact) {
            (true, true) => Some(Surd::rational(self.plain.clone())),
            (true, false) => self.irrational.clone(),
            (false, _) => None,
        }
    }

    fn to_f64(&self) -> f64 {
        nearest(&self.plain) + nearest(&self.turns) * PI
    }

    fn rounded(x: f64) -> Option<Self> {
        Some(Self {
            plain: Rational::from_f64(x)?,
            turns: Rational::new(),
            exact: false,
            irrational: None,
        })
    }

    fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        if text.is_empty() || text.len() > MOST_CHARACTERS {
            return None;
        }
        let mut reader = Reader { rest: text };
        let value = reader.sum(0)?;
        reader.rest.trim().is_empty().then_some(value)
    }

    fn decimal(text: &str) -> Option<Rational> {
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (whole, decimals) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = format!("{whole}{decimals}");
        if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
            return None;
        }
        let number: Rational = digits.parse().ok()?;
        Some(number * power_of_ten(exponent - decimals.len() as i32)?)
    }
}

struct Reader<'a> {
    rest: &'a str,
}

impl Reader<'_> {
    fn takes(&mut self, symbol: char) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(symbol) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn sum(&mut self, depth: usize) -> Option<Value> {
        let mut total = self.product(depth)?;
        loop {
            let sign = if self.takes('+') {
                1
            } else if self.takes('-') || self.takes(MINUS) {
                -1
            } else {
                return Some(total);
            };
            let more = self.product(depth)?;
            let surds = total.surd().zip(more.surd());
            total = Value {
                irrational: surds.and_then(|(a, b)| a.plus(&b, sign)),
                plain: total.plain + more.plain * sign,
                turns: total.turns + more.turns * sign,
                exact: total.exact && more.exact,
            };
        }
    }

    fn product(&mut self, depth: usize) -> Option<Value> {
        let mut total = self.factor(depth)?;
        loop {
            if self.takes('*') {
                total = times(&total, &self.factor(depth)?)?;
            } else if self.takes('/') {
                let by = self.factor(depth)?;
                let surds = total.surd().zip(by.surd());
                let quotient = surds.and_then(|(a, b)| Some(a.times(&b.inverse()?)));
                total = match (by.turns == 0, by.plain == 0) {
                    (true, true) => return None,
                    (true, false) => Value {
                        plain: total.plain / &by.plain,
                        turns: total.turns / &by.plain,
                        exact: total.exact && by.exact,
                        irrational: quotient,
                    },
                    (false, _) => Value::rounded(total.to_f64() / by.to_f64())?,
                };
            } else {
                return Some(total);
            }
        }
    }

    fn factor(&mut self, depth: usize) -> Option<Value> {
        if depth > MOST_NESTING {
            return None;
        }
        if self.takes('-') || self.takes(MINUS) {
            let value = self.factor(depth + 1)?;
            return Some(Value {
                plain: -value.plain,
                irrational: value.irrational.map(|surd| Surd {
                    coefficient: -surd.coefficient,
                    ..surd
                }),
                turns: -value.turns,
                exact: value.exact,
            });
        }
        if self.takes('+') {
            return self.factor(depth + 1);
        }
        if self.takes('(') {
            let value = self.sum(depth + 1)?;
            return self.takes(')').then_some(value);
        }
        if let Some(rest) = self.rest.strip_prefix("sqrt") {
            self.rest = rest;
            if !self.takes('(') {
                return None;
            }
            let value = self.sum(depth + 1)?;
            return if self.takes(')') { root(&value) } else { None };
        }
        let after = |name: &&str| self.rest.strip_prefix(*name);
        if let Some(rest) = PI_NAMES.iter().find_map(after) {
            self.rest = rest;
            return Some(Value {
                plain: Rational::new(),
                turns: Rational::from(1),
                exact: true,
                irrational: None,
            });
        }
        self.decimal()
    }

    fn decimal(&mut self) -> Option<Value> {
        let bytes = self.rest.as_bytes();
        let mut end = 0;
        while let Some(&byte) = bytes.get(end) {
            let after_exponent = end > 0 && matches!(bytes[end - 1], b'e' | b'E');
            let part = byte.is_ascii_digit()
                || byte == b'.'
                || (matches!(byte, b'e' | b'E') && end > 0)
                || (matches!(byte, b'+' | b'-') && after_exponent);
            if !part {
                break;
            }
            end += 1;
        }
        let (number, rest) = self.rest.split_at(end);
        self.rest = rest;
        Some(Value {
            plain: Value::decimal(number)?,
            turns: Rational::new(),
            exact: true,
            irrational: None,
        })
    }
}

fn times(a: &Value, b: &Value) -> Option<Value> {
    if a.turns != 0 && b.turns != 0 {
        return Value::rounded(a.to_f64() * b.to_f64());
    }
    let turns = Rational::from(&a.turns * &b.plain) + Rational::from(&b.turns * &a.plain);
    let surds = a.surd().zip(b.surd());
    Some(Value {
        irrational: surds.map(|(a, b)| a.times(&b)),
        plain: Rational::from(&a.plain * &b.plain),
        turns,
        exact: a.exact && b.exact,
    })
}

fn root(value: &Value) -> Option<Value> {
    if value.turns == 0 && value.plain >= 0 {
        let (p, q) = (value.plain.numer(), value.plain.denom());
        if p.is_perfect_square() && q.is_perfect_square() {
            return Some(Value {
                plain: Rational::from((p.clone().sqrt(), q.clone().sqrt())),
                turns: Rational::new(),
                exact: value.exact,
                irrational: None,
            });
        }
    }
    let double = value.to_f64();
    if double < 0.0 {
        return None;
    }
    let mut rounded = Value::rounded(double.sqrt())?;
    if value.turns == 0 && value.exact {
        rounded.irrational = Surd::root(&value.plain);
    }
    Some(rounded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_what_is_written() {
        for (text, numerator, denominator) in [
            ("0.806", 403, 500),
            ("384/145", 384, 145),
            ("-1e-3", -1, 1000),
            ("2*(1/3 - 1)", -4, 3),
            ("sqrt(9/4)", 3, 2),
        ] {
            let number = Number::read(text).unwrap();
            assert_eq!(number.value, Rational::from((numerator, denominator)));
            assert!(number.exact, "{text}");
        }
        let root = Number::read("sqrt(3)/2").unwrap();
        let square = root.surd.as_ref().map(|surd| surd.square());
        assert_eq!(square, Some(Rational::from((3, 4))));
        for (text, square) in [
            ("-2*sqrt(2)/3 + sqrt(2)", Some((2, 9))),
            ("1/sqrt(5)", Some((1, 5))),
            ("sqrt(2) + sqrt(3)", None),
            ("sqrt(2) + 1", None),
        ] {
            let surd = Number::read(text).unwrap().surd;
            assert_eq!(
                surd.map(|s| s.square()),
                square.map(Rational::from),
                "{text}"
            );
        }
        assert!(!root.exact && (root.to_f64() - 0.75f64.sqrt()).abs() < 1e-16);
        for (text, written) in [
            (" sqrt(5) + 1", Some("(sqrt(5) + 1)")),
            ("sqrt(1+sqrt(2))", Some("(sqrt(1+sqrt(2)))")),
            ("2*sqrt(5)", Some("(2*sqrt(5))")),
            ("sqrt(5)/pi", None),
        ] {
            let number = Number::read(text).unwrap();
            assert_eq!(number.is_exact_in_expressions(), written.is_some());
            assert!(
                written.is_none_or(|w| w == number.exact_expression()),
                "{text}"
            );
        }
        for bad in [
            "",
            "x",
            "1/0",
            "1..2",
            "sqrt(-1)",
            "(1",
            "1e999999999",
            "nan",
        ] {
            assert_eq!(Number::read(bad), None, "{bad}");
        }
        assert_eq!(Number::read("0.806").unwrap().json(), "0.806");
        assert_eq!(Number::read("1/3").unwrap().json(), "\"1/3\"");
    }

    #[test]
    fn rounded_right_angles_are_exact_and_others_are_not_touched() {
        let snapped = |text: &str| {
            let read = read_angle(text, false, true).unwrap();
            read.snapped.is_some().then_some(read.angle.direction)
        };
        for text in ["1.57", "1.5708", "1.570796327", "1.5707963267948966"] {
            assert_eq!(snapped(text), Some([0.0, 1.0]), "{text}");
        }
        assert_eq!(snapped("-3.14159"), Some([-1.0, 0.0]));
        assert_eq!(snapped("-1.5707963267948966"), Some([0.0, -1.0]));
        for text in ["1.6", "1.571215929", "1.5707", "0.0009", "0"] {
            assert_eq!(snapped(text), None, "{text}");
        }
        assert_eq!(read_angle("1.5708", false, false).unwrap().snapped, None);
        let right = read_angle("90 deg", false, true).unwrap();
        assert_eq!((right.angle.half, right.snapped), ([1.0, 1.0], None));
        for text in ["-pi/2", "-Pi/2", "-PI/2", "-π/2"] {
            let read = read_angle(text, true, true).expect(text);
            assert_eq!(read.angle.half, [1.0, -1.0]);
        }
    }

    #[test]
    fn angles_come_back() {
        for k in -20..20 {
            let angle = Angle::of_radians(0.15 * f64::from(k));
            let [c, s] = angle.direction;
            assert!((radians(Complex64::new(c, s)) - angle.radians).abs() < 1e-14);
            let [w, t] = angle.half;
            let over = w * w + t * t;
            assert!(((w * w - t * t) / over - c).abs() < 1e-15);
            assert!((2.0 * w * t / over - s).abs() < 1e-15);
        }
    }
}
