//! Whether the points of a region at which a quotient of polynomials is at most a given value form a bounded set, away from
//! the zeros of its denominator: then the quotient takes its least value there, if it has values so small.

use super::attained::{Region, Sides, bound_by_all, terms};
use super::quotient::{Quotient, Terms, scaled, sum};

/// The set of values up to this part more than the given one is looked at, so that rounding leaves none out.
const MARGIN: f64 = 1e-9;

/// Whether a quotient takes its least value in a region (`sign` 1), or its largest (`sign` -1), where it has this value.
pub fn takes_its_extreme(objective: &Quotient, region: &Region<'_>, sign: f64, value: f64) -> bool {
    let variables = objective.variables();
    let read = |polynomial| terms(polynomial, region.parameters, 1.0);
    let equations: Option<Vec<Terms>> = region.equations.iter().map(read).collect();
    let inequalities: Option<Vec<Terms>> = region.inequalities.iter().map(read).collect();
    let (Some(equations), Some(inequalities)) = (equations, inequalities) else {
        return false;
    };
    let mut least = vec![None; variables];
    inequalities
        .iter()
        .for_each(|limit| raise(&mut least, limit));
    for _ in 0..variables {
        equations
            .iter()
            .for_each(|equation| raise_by_monomial(&mut least, equation));
    }
    let objective = objective.scaled(sign);
    let Some(objective) = with_positive_denominator(objective, &least) else {
        return false;
    };
    let value = sign * value;
    let value = value + MARGIN * (1.0 + value.abs());
    let Quotient {
        numerator,
        denominator,
    } = &objective;
    // Near the zeros of the denominator the quotient grows.
    let is_apart = bound_below(denominator, &least).is_some_and(|bound| bound > 0.0)
        || bound_below(numerator, &least).is_some_and(|bound| bound > 0.0);
    let below = sum(&scaled(denominator, value), numerator, -1.0);
    let negative = equations.iter().map(|equation| scaled(equation, -1.0));
    let mut limits: Vec<Terms> = [below].into_iter().chain(inequalities).collect();
    let eliminated = limits
        .iter()
        .flat_map(|limit| without_linear_variables(limit, &equations));
    let eliminated: Vec<Terms> = eliminated.collect();
    limits.extend(eliminated.into_iter().chain(negative));
    limits.extend(equations.iter().cloned());
    let mut sides: Vec<Sides> = least
        .iter()
        .map(|bound| Sides::above(bound.is_some()))
        .collect();
    bound_by_all(&limits, &mut sides);
    is_apart && sides.iter().all(|side| *side == Sides::BOTH)
        || is_bounded_in_logarithms(&objective, &equations, &least)
}

/// A limit with what an equation says of a variable, where both have it in one term, as a multiple.
fn without_linear_variables<'a>(
    limit: &'a Terms,
    equations: &'a [Terms],
) -> impl Iterator<Item = Terms> + 'a {
    equations.iter().flat_map(move |equation| {
        let variables = 0..limit.keys().next().map_or(0, Vec::len);
        let factors = variables.filter_map(move |v| {
            Some(linear_coefficient(limit, v)? / linear_coefficient(equation, v)?)
        });
        factors.map(move |factor| sum(limit, equation, -factor))
    })
}

/// The coefficient of a variable that stands in one term, as a multiple.
fn linear_coefficient(terms: &Terms, v: usize) -> Option<f64> {
    let mut with = terms.iter().filter(|(key, _)| key[v] > 0);
    match (with.next(), with.next()) {
        (Some((key, coefficient)), None) => (key.iter().sum::<u32>() == 1).then_some(*coefficient),
        _ => None,
    }
}

/// Raises the lower bound of a variable by a limit a x + b >= 0 with a > 0.
fn raise(least: &mut [Option<f64>], limit: &Terms) {
    let mut with_variables = limit.iter().filter(|(key, _)| key.iter().any(|e| *e > 0));
    let (Some((key, factor)), None) = (with_variables.next(), with_variables.next()) else {
        return;
    };
    if key.iter().sum::<u32>() != 1 || *factor <= 0.0 {
        return;
    }
    let constant = limit.iter().find(|(key, _)| key.iter().all(|e| *e == 0));
    let bound = -constant.map_or(0.0, |(_, c)| *c) / factor;
    for (v, _) in key.iter().enumerate().filter(|(_, e)| **e == 1) {
        least[v] = Some(least[v].map_or(bound, |other: f64| other.max(bound)));
    }
}

/// A product of variables that is a positive number has a positive last factor where all others are positive.
fn raise_by_monomial(least: &mut [Option<f64>], equation: &Terms) {
    let Some((key, _)) = positive_monomial(equation) else {
        return;
    };
    let is_open = |&(v, e): &(usize, &u32)| e % 2 == 1 && least[v].is_none_or(|bound| bound < 0.0);
    let mut open = key.iter().enumerate().filter(is_open);
    if let (Some((v, _)), None) = (open.next(), open.next()) {
        least[v] = Some(0.0);
    }
}

/// The exponents of a product of variables that an equation says to be a positive number.
fn positive_monomial(equation: &Terms) -> Option<(&Vec<u32>, f64)> {
    let mut ascending = equation.iter();
    match (ascending.next(), ascending.next(), ascending.next()) {
        (Some((constant, b)), Some((key, a)), None) => {
            let is_positive = constant.iter().all(|e| *e == 0) && a * b < 0.0;
            is_positive.then_some((key, -b / a))
        }
        _ => None,
    }
}

/// A number that no value of a polynomial is below, where variables are not below `least`.
fn bound_below(terms: &Terms, least: &[Option<f64>]) -> Option<f64> {
    let bound = |(key, coefficient): (&Vec<u32>, &f64)| {
        let mut bound = *coefficient;
        for (v, &e) in key.iter().enumerate().filter(|(_, e)| **e > 0) {
            bound *= match least[v] {
                Some(least) if least >= 0.0 => (0..e).map(|_| least).product(),
                _ if e % 2 == 0 => 0.0,
                _ => return None,
            };
        }
        let is_constant = key.iter().all(|e| *e == 0);
        (is_constant || *coefficient > 0.0).then_some(bound)
    };
    terms.iter().map(bound).sum()
}

/// The quotient with a denominator that is nowhere negative; `None` where its sign is not known.
fn with_positive_denominator(quotient: Quotient, least: &[Option<f64>]) -> Option<Quotient> {
    let flipped = Quotient {
        numerator: scaled(&quotient.numerator, -1.0),
        denominator: scaled(&quotient.denominator, -1.0),
    };
    let is_positive = |quotient: &Quotient| {
        bound_below(&quotient.denominator, least).is_some_and(|bound| bound >= 0.0)
    };
    [quotient, flipped].into_iter().find(is_positive)
}

/// Whether a sum of positive multiples of products of powers, of positive variables, grows in all directions of their
/// logarithms: each product stays below a bound, products that equations say to be numbers stay, and that bounds the
/// logarithms.
fn is_bounded_in_logarithms(
    objective: &Quotient,
    equations: &[Terms],
    least: &[Option<f64>],
) -> bool {
    let mut divisors = objective.denominator.iter();
    let (Some((under, divisor)), None) = (divisors.next(), divisors.next()) else {
        return false;
    };
    let is_positive = |coefficient: &f64| coefficient * divisor > 0.0;
    let are_nonnegative = least
        .iter()
        .all(|bound| bound.is_some_and(|bound| bound >= 0.0));
    if !are_nonnegative || !objective.numerator.values().all(is_positive) {
        return false;
    }
    let difference = |key: &Vec<u32>| -> Vec<i64> {
        let exponents = key.iter().zip(under);
        exponents
            .map(|(a, b)| i64::from(*a) - i64::from(*b))
            .collect()
    };
    // Sums of multiples of the logarithms that are bounded above.
    let mut bounded: Vec<Vec<i64>> = objective.numerator.keys().map(difference).collect();
    for (key, _) in equations.iter().filter_map(positive_monomial) {
        let multiples: Vec<i64> = key.iter().map(|e| i64::from(*e)).collect();
        bounded.push(multiples.iter().map(|e| -e).collect());
        bounded.push(multiples);
    }
    let mut sides = vec![Sides::default(); least.len()];
    loop {
        let before = sides.clone();
        for multiples in &bounded {
            let present = multiples
                .iter()
                .enumerate()
                .filter(|(_, multiple)| **multiple != 0);
            for (v, multiple) in present.clone() {
                let mut others = present.clone().filter(|(u, _)| *u != v);
                let is_bounded_below =
                    |(u, multiple): (usize, &i64)| sides[u].is_bounded_below(*multiple > 0);
                if others.all(is_bounded_below) {
                    sides[v].bound(*multiple > 0);
                }
            }
        }
        if sides == before {
            return sides.iter().all(|side| *side == Sides::BOTH);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats;
    use crate::polynomial::Polynomial;

    /// Whether an expression has its least value (`sign` 1) or its largest (`sign` -1) where its value is `value`, on the
    /// points where all of `equations` are 0 and all of `inequalities` at least 0; both between semicolons.
    fn takes(equations: &str, inequalities: &str, objective: &str, sign: f64, value: f64) -> bool {
        let problem = |lines: &str| {
            let lines: Vec<&str> = lines.split(';').filter(|line| !line.is_empty()).collect();
            // The first equation makes an unknown of each name.
            let text = format!(
                "unknowns: x, y\nx*y = 7\n{}\nminimize: {objective}",
                lines.join("\n")
            );
            formats::plain::typed("test", &text).expect("equations")
        };
        let polynomials = |lines: &str| -> Vec<Polynomial> {
            let system = problem(&lines.replace(';', " = 0;")).system;
            let expand = |root: &_| {
                Polynomial::expand(&system.expressions, *root, 2, 0).expect("a polynomial")
            };
            system.equations[1..].iter().map(expand).collect()
        };
        let problem = problem("");
        let node = problem.objective.expect("an objective").node;
        let objective =
            Quotient::of(&problem.system.expressions, node, 2, &[]).expect("a quotient");
        let region = Region {
            equations: &polynomials(equations),
            inequalities: &polynomials(inequalities),
            parameters: &[],
        };
        takes_its_extreme(&objective, &region, sign, value)
    }

    #[test]
    fn quotients_take_their_extremes() {
        assert!(takes("y;", "", "1/(x^2 + 1)", -1.0, 1.0));
        assert!(!takes("y;", "", "1/(x^2 + 1)", 1.0, 1.0));
        assert!(takes("y;", "", "x/(x^2 + 1)", 1.0, -0.5));
        assert!(takes(
            "",
            "",
            "(x + y)/(x^2 + y^2 + 1)",
            -1.0,
            0.5f64.sqrt()
        ));
        assert!(!takes("y;", "", "(x^2 - 1)/(x^2 + 1)", -1.0, 0.5));
        assert!(takes("y;", "x;", "x + 1/x", 1.0, 2.0));
        assert!(!takes("y;", "", "x + 1/x", 1.0, 2.0));
        assert!(takes("y;", "x - 1;2 - x;", "1/x", 1.0, 0.5));
        assert!(takes("y;", "x - 1;2 - x;", "1/x", -1.0, 1.0));
        assert!(!takes("y;", "x;2 - x;", "1/x", -1.0, 0.5));
        assert!(takes("y;", "x + 1;1 - x;", "1/x^2", 1.0, 1.0));
    }

    #[test]
    fn a_variable_is_eliminated() {
        assert!(takes("y - x^2;", "", "y - x", 1.0, -0.25));
        assert!(!takes("y - x^2;", "", "y - x", -1.0, 0.25));
        assert!(!takes("y - x^3;", "", "y - x", 1.0, 0.25));
    }

    #[test]
    fn sums_of_products_of_positive_variables_take_their_least_value() {
        assert!(takes("", "x;y;", "x + y + 1/(x*y)", 1.0, 3.0));
        assert!(!takes("", "x;y;", "x + 1/(x*y)", 1.0, 3.0));
        assert!(takes("x*y - 1;", "x;", "x + y", 1.0, 2.0));
        assert!(!takes("x*y - 1;", "", "x + y", 1.0, 2.0));
        assert!(!takes("", "x;", "x + y + 1/(x*y)", 1.0, 3.0));
    }
}
