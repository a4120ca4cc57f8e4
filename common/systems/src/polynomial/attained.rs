//! Whether an expression takes its least value on the real solutions of a system: they are bounded, or it grows towards
//! infinity in all directions that are left.
//!
//! A polynomial bounds the variables of which it has a pure power that grows, an even one or one of a variable that is
//! bounded on one side, where every other term grows more slowly, by the inequality of the weighted arithmetic and geometric means, or the fastest ones together are
//! a definite form.

use super::Polynomial;
use super::quotient::Terms;
use crate::expression::differentiate::below;
use crate::expression::{Expressions, Node, NodeId};
use cognate_numeric::linear_algebra::symmetric_eigenvalues::symmetric_eigenvalues;
use num_complex::Complex64;
use std::collections::{BTreeMap, HashMap};

/// Reason why the least value is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attained {
    /// The equations have finitely many solutions.
    Finite,
    /// The equations bound all variables.
    Bounded,
    /// The expression grows without bound in all directions that the equations leave.
    Grows,
    /// On all spheres beyond some radius the values are worse than the one that is taken.
    GrowsOutwards,
    /// No value of the expression, a sum of even powers, is below the one that is taken.
    LowerBound,
    /// The points with values that are no worse than the one that is taken are a bounded set.
    BoundedSublevelSet,
}

/// The real points of which extreme values are asked.
#[derive(Clone, Copy, Debug)]
pub struct Region<'a> {
    /// Polynomials that are 0.
    pub equations: &'a [Polynomial],
    /// Polynomials that are at least 0.
    pub inequalities: &'a [Polynomial],
    /// Values of the parameters.
    pub parameters: &'a [Complex64],
}

/// On which sides a variable is bounded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sides {
    lower: bool,
    upper: bool,
}

impl Sides {
    pub(super) const BOTH: Self = Self {
        lower: true,
        upper: true,
    };

    /// Whether a variable is bounded below.
    pub(super) fn above(lower: bool) -> Self {
        Self {
            lower,
            upper: false,
        }
    }

    /// Whether a positive multiple of the variable, or a negative one, is bounded below.
    pub(super) fn is_bounded_below(self, is_positive: bool) -> bool {
        if is_positive { self.lower } else { self.upper }
    }

    /// A positive multiple of the variable, or a negative one, is bounded above.
    pub(super) fn bound(&mut self, is_positive: bool) {
        self.upper |= is_positive;
        self.lower |= !is_positive;
    }

    /// Whether a polynomial in the variable is bounded above, by its leading term.
    fn bound_above(self, power: u32, coefficient: f64) -> bool {
        match (power.is_multiple_of(2), coefficient > 0.0) {
            (true, is_positive) => !is_positive,
            (false, true) => self.upper,
            (false, false) => self.lower,
        }
    }

    /// The sign of the values that the variable takes towards infinity: `None` where it takes both, or none.
    fn sign_far_out(self) -> Option<f64> {
        match (self.lower, self.upper) {
            (true, false) => Some(1.0),
            (false, true) => Some(-1.0),
            _ => None,
        }
    }

    /// The sides that are bounded where a polynomial with this leading term is bounded below.
    fn where_bounded_below(power: u32, coefficient: f64) -> Self {
        let is_even = power.is_multiple_of(2);
        let is_positive = coefficient > 0.0;
        Self {
            lower: is_even != is_positive,
            upper: !is_positive,
        }
    }
}

/// Finds the reason why `objective` takes its least value in a region (`sign` 1), or its largest (`sign` -1), if the
/// region has a point. `None` where that is not known.
pub fn attained(objective: &Polynomial, region: &Region<'_>, sign: f64) -> Option<Attained> {
    let n = objective.variables;
    // Each is at least 0 in the region.
    let mut limits: Vec<Terms> = Vec::new();
    for (polynomials, signs) in [
        (region.equations, &[1.0, -1.0][..]),
        (region.inequalities, &[1.0]),
    ] {
        for polynomial in polynomials {
            let read = |sign: &f64| terms(polynomial, region.parameters, *sign);
            limits.extend(signs.iter().filter_map(read));
        }
    }
    let mut sides = vec![Sides::default(); n];
    bound_by_all(&limits, &mut sides);
    if sides.iter().all(|side| *side == Sides::BOTH) {
        return Some(Attained::Bounded);
    }
    let mut rest = terms(objective, region.parameters, sign)?;
    for v in 0..n {
        if sides[v] != Sides::BOTH && grows_on_its_side(&rest, v, sides[v]) {
            rest.retain(|key, _| key[v] == 0);
            sides[v] = Sides::BOTH;
        }
    }
    for variable in bounds(&rest, &sides).into_iter().flatten() {
        sides[variable] = Sides::BOTH;
    }
    // Where the expression stays below a bound, so does what holds no other variable, and the limits bound further ones.
    let is_bounded = |key: &Vec<u32>| {
        let mut present = key.iter().zip(&sides).filter(|(e, _)| **e > 0);
        present.all(|(_, side)| *side == Sides::BOTH)
    };
    if rest.keys().all(is_bounded) {
        bound_by_all(&limits, &mut sides);
    }
    let is_bounded = |side: &Sides| *side == Sides::BOTH;
    sides.iter().all(is_bounded).then_some(Attained::Grows)
}

/// Marks what polynomials that are at least 0 bound together.
pub(super) fn bound_by_all(limits: &[Terms], sides: &mut [Sides]) {
    loop {
        let before = sides.to_vec();
        for limit in limits {
            bound_by(limit, sides);
        }
        if sides == before {
            break;
        }
    }
}

/// Marks what a polynomial that is at least 0 bounds.
fn bound_by(limit: &Terms, sides: &mut [Sides]) {
    let bounded: Vec<bool> = sides.iter().map(|side| *side == Sides::BOTH).collect();
    let negative = limit.iter().map(|(key, c)| (key.clone(), -c)).collect();
    for variable in bounds(&negative, sides).into_iter().flatten() {
        sides[variable] = Sides::BOTH;
    }
    // A sum of polynomials in one variable each and of what is bounded: what bounds all others above bounds the last
    // one below.
    let mut highest: BTreeMap<usize, (u32, f64)> = BTreeMap::new();
    for (key, coefficient) in limit {
        let mut present = (0..key.len()).filter(|&v| key[v] > 0);
        match (present.clone().find(|&v| !bounded[v]), present.next()) {
            (None, _) => {}
            // Keys ascend, and so do the powers of a variable.
            (Some(v), Some(first)) if first == v && present.next().is_none() => {
                highest.insert(v, (key[v], *coefficient));
            }
            _ => return,
        }
    }
    for (&v, &(power, coefficient)) in &highest {
        let mut others = highest.iter().filter(|(u, _)| **u != v);
        if others.all(|(&u, &(power, c))| sides[u].bound_above(power, c)) {
            let bounded = Sides::where_bounded_below(power, coefficient);
            sides[v].lower |= bounded.lower;
            sides[v].upper |= bounded.upper;
        }
    }
}

/// Whether a polynomial holds this variable in pure powers only, which grow on the side where it is not bounded.
fn grows_on_its_side(terms: &Terms, v: usize, sides: Sides) -> bool {
    let is_pure = |key: &[u32]| key.iter().enumerate().all(|(u, &e)| e == 0 || u == v);
    let with = terms.iter().filter(|(key, _)| key[v] > 0);
    if sides.lower == sides.upper || !with.clone().all(|(key, _)| is_pure(key)) {
        return false;
    }
    let Some((key, coefficient)) = with.max_by_key(|(key, _)| key[v]) else {
        return false;
    };
    let is_negative = sides.upper && !key[v].is_multiple_of(2);
    (*coefficient > 0.0) != is_negative
}

/// A number that no real value of an expression is below, by its form as a sum of even powers and products of such sums: 3
/// of x^2 + 2*(y - x)^4 + 3.
/// The variables of `nonnegative` are at least 0.
pub fn lower_bound(expressions: &Expressions, root: NodeId, nonnegative: &[usize]) -> Option<f64> {
    let mut bounds: HashMap<NodeId, Option<f64>> = HashMap::new();
    for id in below(expressions, &[root]) {
        let constant = |id: NodeId| match expressions.node(id) {
            Node::Constant(c) if c.is_real() => Some(c.re.to_f64()),
            _ => None,
        };
        let not_negative = |id: &NodeId| bounds[id].filter(|bound| *bound >= 0.0);
        let bound = match expressions.node(id) {
            Node::Variable(v) if nonnegative.contains(&(*v as usize)) => Some(0.0),
            Node::Power(_, exponent) if exponent.is_multiple_of(2) => Some(0.0),
            Node::Add(a, b) => bounds[a].zip(bounds[b]).map(|(a, b)| a + b),
            Node::Subtract(a, b) => bounds[a].zip(constant(*b)).map(|(a, b)| a - b),
            Node::Multiply(a, b) if a == b => Some(0.0),
            Node::Multiply(a, b) => not_negative(a).zip(not_negative(b)).map(|(a, b)| a * b),
            Node::Divide(a, b) => not_negative(a).zip(not_negative(b)).map(|_| 0.0),
            _ => constant(id),
        };
        bounds.insert(id, bound);
    }
    bounds[&root]
}

/// The real coefficients times a sign; `None` where some are not real.
pub(super) fn terms(polynomial: &Polynomial, parameters: &[Complex64], sign: f64) -> Option<Terms> {
    let coefficients = polynomial.coefficients_at(parameters).into_iter();
    coefficients
        .map(|(key, c)| (c.im == 0.0).then_some((key, sign * c.re)))
        .collect()
}

/// The variables, beyond those that are bounded on both sides, without which the polynomial cannot stay below a bound. All
/// that are in it and not bounded must be among them, else `None`.
fn bounds(terms: &Terms, sides: &[Sides]) -> Option<Vec<usize>> {
    let bounded: Vec<bool> = sides.iter().map(|side| *side == Sides::BOTH).collect();
    let variables: Vec<usize> = (0..bounded.len())
        .filter(|&v| !bounded[v] && terms.keys().any(|key| key[v] > 0))
        .collect();
    if variables.is_empty() {
        return None;
    }
    // A product of powers and this coefficient is, far out, at least 0 or as small as the other terms.
    let is_at_least_0 = |key: &[u32], coefficient: f64| {
        let odd = key.iter().zip(sides).filter(|(e, _)| !e.is_multiple_of(2));
        let signs = odd.map(|(_, side)| side.sign_far_out());
        signs
            .product::<Option<f64>>()
            .is_some_and(|sign| sign * coefficient > 0.0)
    };
    // The highest pure power of each variable, with a constant coefficient, which grows.
    let mut highest = vec![0u32; bounded.len()];
    for &v in &variables {
        let is_pure = |key: &Vec<u32>| key.iter().enumerate().all(|(u, &e)| e == 0 || u == v);
        let pure = terms.iter().filter(|(key, _)| is_pure(key) && key[v] > 0);
        let (key, coefficient) = pure.max_by_key(|(key, _)| key[v])?;
        if !is_at_least_0(key, *coefficient) {
            return None;
        }
        highest[v] = key[v];
    }
    let mut fastest = Vec::new();
    for (key, coefficient) in terms {
        // Two sums of fractions with powers as denominators are farther apart than this, or equal.
        let weight: f64 = variables
            .iter()
            .map(|&v| f64::from(key[v]) / f64::from(highest[v]))
            .sum();
        if weight > 1.0 + 1e-9 {
            return None;
        }
        if weight > 1.0 - 1e-9 {
            fastest.push((key, *coefficient));
        }
    }
    let is_growing = |(key, coefficient): &(&Vec<u32>, f64)| {
        is_at_least_0(key, *coefficient) && key.iter().zip(&bounded).all(|(&e, b)| e == 0 || !b)
    };
    let is_definite = fastest.iter().all(is_growing)
        || variables.iter().all(|&v| highest[v] == 2)
            && is_positive_form(&fastest, &variables, &bounded);
    is_definite.then_some(variables)
}

/// Whether terms of degree 2 are a positive definite form in these variables, with constant coefficients.
fn is_positive_form(fastest: &[(&Vec<u32>, f64)], variables: &[usize], bounded: &[bool]) -> bool {
    let mut rows = vec![vec![0.0; variables.len()]; variables.len()];
    for (key, coefficient) in fastest {
        if key
            .iter()
            .zip(bounded)
            .any(|(&e, &is_bounded)| is_bounded && e > 0)
        {
            return false;
        }
        let places: Vec<usize> = (0..variables.len())
            .filter(|&p| key[variables[p]] > 0)
            .collect();
        match places[..] {
            [p] => rows[p][p] += coefficient,
            [p, q] => {
                rows[p][q] += coefficient / 2.0;
                rows[q][p] += coefficient / 2.0;
            }
            _ => return false,
        }
    }
    let values = symmetric_eigenvalues(&rows);
    let largest = values
        .iter()
        .fold(0.0f64, |largest, value| largest.max(value.abs()));
    values.first().is_some_and(|least| *least > 1e-12 * largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats;

    /// The polynomials of a text, of which the last is the objective.
    fn read(text: &str) -> (Vec<Polynomial>, Polynomial) {
        let system = formats::plain::typed("test", text).unwrap().system;
        let n = system.variables.len();
        let mut polynomials: Vec<Polynomial> = system
            .equations
            .iter()
            .map(|equation| Polynomial::expand(&system.expressions, *equation, n, 0).unwrap())
            .collect();
        let objective = polynomials.pop().unwrap();
        (polynomials, objective)
    }

    /// Where the others are 0.
    fn of(text: &str, sign: f64) -> Option<Attained> {
        let (polynomials, objective) = read(text);
        let region = Region {
            equations: &polynomials,
            inequalities: &[],
            parameters: &[],
        };
        attained(&objective, &region, sign)
    }

    /// Where the others are at least 0.
    fn above(text: &str) -> Option<Attained> {
        let (polynomials, objective) = read(text);
        let region = Region {
            equations: &[],
            inequalities: &polynomials,
            parameters: &[],
        };
        attained(&objective, &region, 1.0)
    }

    #[test]
    fn inequalities_bound_on_one_side_or_both() {
        use Attained::{Bounded, Grows};
        for (text, expected) in [
            ("x; 1 - x; x^3", Some(Bounded)),
            ("x; y; 1 - x - y; x*y", Some(Bounded)),
            ("x; y; x*y", None),
            ("x; y; x + y", Some(Grows)),
            ("x; y; x - y", None),
            ("x; y; x^3 - 5*x^2 + y^2", Some(Grows)),
            ("x - y; y - 1; 2 - x; x^2*y", Some(Bounded)),
            ("1 - x^2 - y^2; x", Some(Bounded)),
            ("x^2 + y^2 - 1; x", None),
            ("x^2 + y^2 - 1; x^2 + 3*y^2", Some(Grows)),
            ("-x; -x^3 + 1", Some(Grows)),
            ("-x; x^3 + 1", None),
            // The objective does not hold x, which is bounded where y is.
            ("x; y - x^2; y", Some(Grows)),
            ("x; y - x^2; y - x", None),
            ("x; y + x^2; y", None),
            ("x; y; 2 - x - y^2; x*y", Some(Bounded)),
            ("x; 3 - x^2 - y; y; x*y", Some(Bounded)),
            ("x; 2 - x + y^2; x + y^2", Some(Grows)),
            ("y - x^2; y + x^2", Some(Grows)),
            ("-x - y^3; y; x^3", None),
            ("1 + x^3 + y^4; -x; x", None),
            ("2 - x^2 - y^4 + z^2; x", None),
            // Odd powers of variables that are bounded on one side.
            ("x; y; x^3 + y^3 - 3*x*y", Some(Grows)),
            ("x; y; x^3 + y^3 - 3*x^2*y", None),
            ("x; -y; x^3 - y^3 + x*y", Some(Grows)),
            ("x; -y; x^3 + y^3", None),
            ("x + 5; y; x^3 + x*y^2 + y^3 - 9*x*y", Some(Grows)),
            ("x; x^3 + y^4 - 7*x*y^2", Some(Grows)),
            ("x; y; 9 + x*y - x^3 - y^3; -x", Some(Bounded)),
            ("x; 9 + x*y - x^3 - y^3; -x", None),
        ] {
            assert_eq!(above(text), expected, "{text}");
        }
    }

    #[test]
    fn sums_of_even_powers_have_lower_bounds() {
        for (text, bound) in [
            ("(1 - x)^2 + 100*(y - x^2)^2", Some(0.0)),
            ("x*x + 2*y^4 + 3", Some(3.0)),
            ("x^2 - 1/2 + 0*y", Some(-0.5)),
            ("x^2 - y^2", None),
            ("x^3 + y", None),
            ("-2*x^2 + y", None),
            ("2*(x^2 - 1) + y^2", None),
        ] {
            let system = formats::plain::typed("test", text).unwrap().system;
            assert_eq!(
                lower_bound(&system.expressions, system.equations[0], &[]),
                bound,
                "{text}"
            );
        }
    }

    #[test]
    fn bounded_sets_and_growing_expressions() {
        use Attained::{Bounded, Grows};
        for (text, least, largest) in [
            ("x^2 + y^2 = 1; x + y", Some(Bounded), Some(Bounded)),
            ("x^2 + x*y + y^2 = 1; x", Some(Bounded), Some(Bounded)),
            ("x^2 + 2*x*y + y^2 = 1; x", None, None),
            ("x*y = 1; x^2 + y^2 - 3*x", Some(Grows), None),
            ("x*y = 1; x + y", None, None),
            ("x + y = 1; x^4 - 5*x^3*y^0 + y^2", Some(Grows), None),
            ("x + y = 1; x^4 - 5*x^3*y + y^2", None, None),
            ("x^2 = 4; -(y - x)^2 + 3*y", None, Some(Grows)),
            (
                "x^2 + y^2 = 1; z = x*y; z^2 + x",
                Some(Bounded),
                Some(Bounded),
            ),
            (
                "x^2 + y^2 = 1; z^2 = x + 2; z",
                Some(Bounded),
                Some(Bounded),
            ),
            ("(x - 1)^4 + y^6 = 7*x*y; x", Some(Bounded), Some(Bounded)),
            (
                "x^2*y^2 + x^4 + y^4 + x*y; x + y = 0",
                Some(Bounded),
                Some(Bounded),
            ),
            ("x - y = 0; x^2*y^2 + x^4 + y^4 + x*y", Some(Grows), None),
        ] {
            assert_eq!(of(text, 1.0), least, "{text}");
            assert_eq!(of(text, -1.0), largest, "{text}");
        }
    }
}
