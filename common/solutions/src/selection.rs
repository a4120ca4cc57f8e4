//! Selection: which solutions meet the conditions that are asked, decided within the digits that a solution has.
//!
//! A coordinate is an interval as wide as the solution's accuracy, or the box of its certificate; a comparison holds
//! where it holds for all of the interval. Where it does not, the coordinates that are rational by the equations are
//! compared exactly. What is left lies on the border.

use crate::point_shape::largest;
use crate::solution::Solution;
use cognate_continuation::sharpening::search::sharpen;
use cognate_numeric::exact_text::read_exact;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::{Complex, Interval, Real};
use cognate_systems::condition::{Condition, Conditions, Relation};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch, enclosed};
use cognate_systems::exact_point::{exact_coordinates, exact_point};
use cognate_systems::expression::differentiate::below;
use cognate_systems::expression::{Node, exact};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::denominator_factors;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// Decimal digits of solutions that doubles leave on the border: a coordinate may be the part 10^-200 of the largest one.
const DIGITS: u32 = 100;
/// Seed of the random choices that more digits take.
const SEED: u64 = 1;
/// Solutions that get more digits, at most: each takes some milliseconds.
const MOST_REFINED: u32 = 1000;

/// Whether a solution is selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The solution is real and meets the conditions.
    Selected,
    /// The solution is real, and within its accuracy meets the conditions with equality somewhere.
    OnBorder,
    /// It is not known whether the solution is real, or isolated, or an expression has no value there.
    Undecided,
    /// The solution is not real, or does not meet the conditions.
    Rejected,
}

/// The solutions that are selected, counted.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SelectedCounts {
    /// The conditions, in one text.
    pub condition: String,
    /// Real solutions that meet them.
    pub count: u64,
    /// Real solutions that meet them with equality within their accuracy; not in `count`.
    pub on_border: u64,
    /// Solutions of which it is not known whether they meet them.
    pub undecided: u64,
}

impl SelectedCounts {
    /// No solutions yet, of these conditions.
    pub fn of(condition: String) -> Self {
        Self {
            condition,
            ..Self::default()
        }
    }

    /// Counts one more verdict.
    pub fn add(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Selected => self.count += 1,
            Verdict::OnBorder => self.on_border += 1,
            Verdict::Undecided => self.undecided += 1,
            Verdict::Rejected => {}
        }
    }
}

/// Truth within the digits of a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Truth {
    False,
    /// The value of an expression is not known.
    Unknown,
    /// The digits do not tell on which side of an equality the solution lies.
    Border,
    True,
}

impl Truth {
    fn not(self) -> Self {
        match self {
            Self::False => Self::True,
            Self::True => Self::False,
            open => open,
        }
    }
}

/// Sign of a difference, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    /// The difference is real and compares so with 0.
    Sure(Ordering),
    /// The difference is 0 within the digits.
    Near,
    /// The difference is not real.
    NotReal,
    /// The value of the difference is not known, if it has one.
    Unknown,
}

impl Sign {
    fn meets(self, relation: Relation) -> Truth {
        let holds = match self {
            Self::Near => return Truth::Border,
            Self::Unknown => return Truth::Unknown,
            Self::NotReal => relation == Relation::NotEqual,
            Self::Sure(order) => match relation {
                Relation::Less => order.is_lt(),
                Relation::AtMost => order.is_le(),
                Relation::Greater => order.is_gt(),
                Relation::AtLeast => order.is_ge(),
                Relation::Equal => order.is_eq(),
                Relation::NotEqual => order.is_ne(),
            },
        };
        match holds {
            true => Truth::True,
            false => Truth::False,
        }
    }
}

/// A complex number within bounds for its real and its imaginary part.
pub(crate) type Box64 = Complex<Interval<f64>>;

/// The differences as a program.
#[derive(Debug)]
struct Program {
    interpreter: Interpreter,
    scratch: Scratch<Interval<f64>>,
}

/// Decides the conditions at solutions of one system, one after the other.
#[derive(Debug)]
pub struct Selector {
    conditions: Conditions,
    /// The program of the differences; `None` where they have functions of unknowns, which no program has.
    program: Option<Program>,
    /// The variables in each difference.
    variables: Vec<Vec<usize>>,
    /// The equations, where they are at hand: they say which coordinates are rational.
    system: Option<System>,
    /// Solutions that got more digits so far.
    refined: u32,
}

impl Selector {
    /// A selector for conditions in `variables` unknowns and `parameters` parameters. Without conditions every real
    /// solution is selected.
    pub fn new(
        conditions: Conditions,
        variables: usize,
        parameters: usize,
        system: Option<System>,
    ) -> Self {
        let graph = &conditions.expressions;
        let program = (!conditions.have_functions()).then(|| {
            let wanted = &conditions.differences;
            let interpreter = Interpreter::compile(graph, wanted, variables, parameters);
            Program {
                scratch: Evaluate::<Interval<f64>>::scratch(&interpreter, ()),
                interpreter,
            }
        });
        let in_difference = |root| {
            let nodes = below(graph, &[root]).into_iter();
            let variables = nodes.filter_map(|id| match graph.node(id) {
                Node::Variable(variable) => Some(*variable as usize),
                _ => None,
            });
            variables.collect()
        };
        Self {
            variables: conditions
                .differences
                .iter()
                .map(|d| in_difference(*d))
                .collect(),
            program,
            conditions,
            system,
            refined: 0,
        }
    }

    /// The conditions, in one text.
    pub fn text(&self) -> String {
        match self.conditions.is_empty() {
            true => "real".into(),
            false => self.conditions.text(),
        }
    }

    /// Whether a solution at these values of the parameters is selected.
    pub fn verdict(&mut self, solution: &Solution, parameters: &[Complex64]) -> Verdict {
        self.verdict_with_zeros(solution, parameters, &[])
    }

    /// Decides as [`Self::verdict`], where the differences that `zeros` marks by their index are 0.
    pub fn verdict_with_zeros(
        &mut self,
        solution: &Solution,
        parameters: &[Complex64],
        zeros: &[bool],
    ) -> Verdict {
        if solution.real == Some(false) {
            return Verdict::Rejected;
        }
        let point = boxes(solution);
        let is_near_real = point.iter().all(|z| z.im.may_be_zero());
        if solution.real.is_none() && !is_near_real {
            return Verdict::Rejected;
        }
        let truth = self.truth(solution, point, parameters, zeros);
        let is_sure = solution.real == Some(true) && !solution.undecided;
        match truth {
            Truth::False => Verdict::Rejected,
            Truth::Unknown => Verdict::Undecided,
            Truth::Border | Truth::True if !is_sure => Verdict::Undecided,
            Truth::Border => Verdict::OnBorder,
            Truth::True => Verdict::Selected,
        }
    }

    fn truth(
        &mut self,
        solution: &Solution,
        point: Vec<Box64>,
        parameters: &[Complex64],
        zeros: &[bool],
    ) -> Truth {
        if self.conditions.is_empty() {
            return Truth::True;
        }
        let mut signs = self.signs(&point, parameters);
        for (sign, _) in signs.iter_mut().zip(zeros).filter(|(_, is_zero)| **is_zero) {
            *sign = Sign::Sure(Ordering::Equal);
        }
        let mut truth = every(&self.conditions.conditions, &signs);
        let is_near = point.iter().all(Box64::is_valid);
        if truth == Truth::Border || truth == Truth::Unknown && is_near {
            self.sharpen(&mut signs, solution, point, parameters);
            truth = every(&self.conditions.conditions, &signs);
        }
        truth
    }

    /// The signs of all differences at a box.
    fn signs(&mut self, point: &[Box64], parameters: &[Complex64]) -> Vec<Sign> {
        let exactly = |z: &Complex64| Complex {
            re: Interval::point(&z.re),
            im: Interval::point(&z.im),
        };
        let parameters: Vec<Box64> = parameters.iter().map(exactly).collect();
        let differences = &self.conditions.differences;
        let Some(program) = &mut self.program else {
            let graph = &self.conditions.expressions;
            let sides = differences
                .iter()
                .map(|d| enclosed(graph, *d, point, &parameters));
            return sides.map(|side| sign(&side)).collect();
        };
        let mut values = vec![Box64::zero(()); differences.len()];
        let Program {
            interpreter,
            scratch,
        } = program;
        interpreter.value(point, &parameters, &mut values, scratch);
        values.iter().map(sign).collect()
    }

    /// Decides what is near 0 by the coordinates that are rational.
    fn sharpen(
        &mut self,
        signs: &mut [Sign],
        solution: &Solution,
        mut point: Vec<Box64>,
        parameters: &[Complex64],
    ) {
        let Some(system) = self.system.as_ref() else {
            return;
        };
        let values: Vec<Complex64> = solution.variables.values().collect();
        let rational = parameters.iter().map(|z| ComplexRational::from_doubles(*z));
        let Some(rational) = rational.collect::<Option<Vec<ComplexRational>>>() else {
            return;
        };
        let error = solution.relative_error();
        let exact = if solution.singular {
            // A multiple solution that has rational coordinates in part may have neighbours within its error.
            let exact = exact_point(system, &rational, &values, error);
            exact.map_or(vec![None; values.len()], |point| {
                point.into_iter().map(Some).collect()
            })
        } else {
            exact_coordinates(system, &rational, &values, error)
        };
        for (side, exact) in point.iter_mut().zip(&exact) {
            if let Some(exact) = exact {
                *side = Complex {
                    re: Interval::from_rational((), &exact.re),
                    im: Interval::from_rational((), &exact.im),
                };
            }
        }
        if exact.iter().any(Option::is_none) {
            self.take_digits(&mut point, solution, parameters, &exact);
        }
        let sharper = self.signs(&point, parameters);
        let zero = ComplexRational::real(Rational::new());
        let filled: Vec<ComplexRational> = exact
            .iter()
            .map(|value| value.clone().unwrap_or_else(|| zero.clone()))
            .collect();
        for (place, sign) in signs
            .iter_mut()
            .enumerate()
            .filter(|(_, sign)| matches!(sign, Sign::Near | Sign::Unknown))
        {
            *sign = sharper[place];
            if *sign == Sign::Near && self.variables[place].iter().all(|v| exact[*v].is_some()) {
                let graph = &self.conditions.expressions;
                let difference = self.conditions.differences[place];
                let value = exact::value(graph, difference, &filled, &rational);
                if let Some(value) = value.filter(ComplexRational::is_real) {
                    *sign = Sign::Sure(value.re.cmp0());
                }
            }
        }
    }
}

impl Selector {
    /// Gives coordinates other than 0, of a real regular solution, their own digits: those of doubles are digits of the largest
    /// coordinate, so that a small one may be 0 within them.
    fn take_digits(
        &mut self,
        point: &mut [Box64],
        solution: &Solution,
        parameters: &[Complex64],
        exact: &[Option<ComplexRational>],
    ) {
        let Some(system) = &self.system else { return };
        let is_regular = !solution.singular && solution.real == Some(true);
        let is_polynomial = denominator_factors(system).is_empty();
        if !is_regular || !is_polynomial || self.refined == MOST_REFINED {
            return;
        }
        self.refined += 1;
        let values: Vec<Complex64> = solution.variables.values().collect();
        let Ok(sharpened) = sharpen(system, parameters, &values, DIGITS, SEED) else {
            return;
        };
        let coordinates = point.iter_mut().zip(&sharpened.values).zip(exact);
        for ((side, value), _) in coordinates.filter(|(_, exact)| exact.is_none()) {
            // One that is smaller than the digits of the largest may be 0.
            if value.re != 0 {
                let re = Interval::<f64>::from_rational((), &value.re);
                *side = Complex {
                    re: Interval::new(re.lower().next_down(), re.upper().next_up()),
                    im: Interval::point(&0.0),
                };
            }
        }
    }
}

/// The coordinates of a solution, each as a box that holds it.
pub(crate) fn boxes(solution: &Solution) -> Vec<Box64> {
    let certificate = solution
        .certificate
        .as_ref()
        .filter(|proved| proved.certified);
    let coordinates = certificate.map_or(&[][..], |proved| &proved.coordinates);
    let values: Vec<Complex64> = solution.variables.values().collect();
    let error = solution.relative_error();
    let radius = if solution.singular {
        // An endpoint in homogeneous coordinates has this error beside 1, too.
        error * largest(&values).max(1.0)
    } else {
        error * largest(&values)
    };
    let around = |value: f64| match radius.is_finite() {
        true => Interval::new((value - radius).next_down(), (value + radius).next_up()),
        false => Interval::invalid(()),
    };
    let by_digits = |(z, name): (&Complex64, &str)| {
        let proved = coordinates.iter().find(|side| side.variable == name);
        if let Some(side) = proved.and_then(certified) {
            return side;
        }
        // A number that is decided real is one.
        let is_real = solution.real == Some(true) && z.im == 0.0;
        Complex {
            re: around(z.re),
            im: match is_real {
                true => Interval::point(&0.0),
                false => around(z.im),
            },
        }
    };
    let names = solution
        .variables
        .0
        .iter()
        .map(|variable| variable.name.as_str());
    values.iter().zip(names).map(by_digits).collect()
}

/// The side of a certificate's box.
fn certified(side: &crate::certificates::CertifiedCoordinate) -> Option<Box64> {
    let error = read_exact(&side.error)?;
    let around = |centre: &str| {
        let centre = read_exact(centre)?;
        let lower = Rational::from(&centre - &error);
        let upper = Rational::from(&centre + &error);
        Some(Interval::between((), &lower, &upper))
    };
    Some(Complex {
        re: around(&side.re)?,
        im: around(&side.im)?,
    })
}

/// Sign of a value in this box.
fn sign(value: &Box64) -> Sign {
    let Complex { re, im } = value;
    if !re.is_valid() || !im.is_valid() {
        return Sign::Unknown;
    }
    if !im.may_be_zero() {
        return Sign::NotReal;
    }
    if *re.lower() > 0.0 {
        Sign::Sure(Ordering::Greater)
    } else if *re.upper() < 0.0 {
        Sign::Sure(Ordering::Less)
    } else if *re.lower() == 0.0 && *re.upper() == 0.0 {
        Sign::Sure(Ordering::Equal)
    } else {
        Sign::Near
    }
}

fn every(conditions: &[Condition], signs: &[Sign]) -> Truth {
    let truths = conditions.iter().map(|condition| truth(condition, signs));
    // In the order of the type: what is false decides, then what is not known.
    truths
        .min_by_key(|truth| *truth as u8)
        .unwrap_or(Truth::True)
}

fn truth(condition: &Condition, signs: &[Sign]) -> Truth {
    match condition {
        Condition::Comparison {
            difference,
            relation,
        } => signs[*difference].meets(*relation),
        Condition::Every(conditions) => every(conditions, signs),
        Condition::Any(conditions) => {
            let none = conditions
                .iter()
                .map(|condition| truth(condition, signs).not());
            none.min_by_key(|truth| *truth as u8)
                .unwrap_or(Truth::True)
                .not()
        }
        Condition::Not(condition) => truth(condition, signs).not(),
        Condition::Complementary { differences } => complementary(differences.map(|d| signs[d])),
    }
}

/// Decides for two numbers with product 0 whether one is 0 and the other is positive: both are 0 on the border.
fn complementary(signs: [Sign; 2]) -> Truth {
    let is_zero = |sign: Sign| matches!(sign, Sign::Near | Sign::Sure(Ordering::Equal));
    match signs {
        [Sign::Unknown | Sign::NotReal, _] | [_, Sign::Unknown | Sign::NotReal] => Truth::Unknown,
        [a, b] if is_zero(a) && is_zero(b) => Truth::Border,
        [a, b] if is_zero(a) => b.meets(Relation::Greater),
        [a, b] if is_zero(b) => a.meets(Relation::Greater),
        // The product of the two is 0, so that one of them is.
        _ => Truth::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solution::NamedValues;
    use cognate_systems::formats;

    fn solution(names: &[String], values: &[f64], accuracy: f64) -> Solution {
        let values = values.iter().map(|x| Complex64::new(*x, 0.0));
        Solution {
            variables: names.iter().cloned().zip(values).collect::<NamedValues>(),
            multiplicity: 1,
            cycles: vec![1],
            real: Some(true),
            condition: 1.0,
            accuracy,
            precision_bits: 53,
            paths: vec![0],
            ..Solution::default()
        }
    }

    /// The verdict on a point of a system, with this accuracy.
    fn verdict(equations: &str, condition: &str, values: &[f64], accuracy: f64) -> Verdict {
        let text = format!("{equations}\nwhere: {condition}");
        let problem = formats::plain::typed("test", &text).unwrap();
        let names = problem.system.variables.clone();
        let mut selector = Selector::new(problem.conditions, names.len(), 0, Some(problem.system));
        selector.verdict(&solution(&names, values, accuracy), &[])
    }

    #[test]
    fn a_comparison_holds_where_the_digits_say_so() {
        use Verdict::{OnBorder, Rejected, Selected};
        let circle = "x^2 + y^2 = 3\nx*y = 1";
        let verdict_on_circle =
            |condition: &str| verdict(circle, condition, &[1.618_033_988_7, 0.618_033_988_7], 1e-9);
        for (condition, expected) in [
            ("x > 0", Selected),
            ("0 < y < x <= 2", Selected),
            ("y > x", Rejected),
            ("not y > x", Selected),
            ("y > x or x^2 > 2", Selected),
            ("(y > x or x < 1) and y > 0", Rejected),
            ("x - y >= 1", OnBorder),
            ("x - y >= 1 and y < 0", Rejected),
            ("x - y >= 1 or y > 0", Selected),
            ("(x - 1)*(x - 2) < 0", Selected),
            ("x != y", Selected),
            ("x = y", Rejected),
            ("x - y = 1", OnBorder),
            ("x - y != 1", OnBorder),
        ] {
            assert_eq!(verdict_on_circle(condition), expected, "{condition}");
        }
    }

    #[test]
    fn rational_coordinates_are_compared_exactly() {
        use Verdict::{OnBorder, Rejected, Selected};
        // x is 0 by the first equation, y is not rational.
        let product = "x*(y - 3) = 0\ny^2 + x = 2";
        let point = [0.0, 2.0f64.sqrt()];
        let on = |condition: &str| verdict(product, condition, &point, 2.3e-16);
        assert_eq!(on("x >= 0"), Selected);
        assert_eq!(on("x > 0"), Rejected);
        assert_eq!(on("x = 0 and y > 1"), Selected);
        assert_eq!(on("y^2 >= 2"), OnBorder);
        // Both are.
        let lines = "3*x = 1\nx + y = 1";
        let on = |condition: &str| verdict(lines, condition, &[1.0 / 3.0, 2.0 / 3.0], 2.3e-16);
        assert_eq!(on("y = 2*x"), Selected);
        assert_eq!(on("y >= 2/3 and 3*y <= 2"), Selected);
        assert_eq!(on("y != 2*x"), Rejected);
    }

    #[test]
    fn functions_of_unknowns_are_enclosed() {
        use Verdict::{OnBorder, Rejected, Selected, Undecided};
        let on = |condition: &str| {
            verdict(
                "x^2 = 2\ny*(y - 3) = 0",
                condition,
                &[-2.0f64.sqrt(), 0.0],
                2.3e-16,
            )
        };
        for (condition, expected) in [
            ("abs(x) > 1", Selected),
            ("abs(x) < sqrt(3) and abs(y) < 1", Selected),
            ("abs(x) = sqrt(2)", OnBorder),
            ("sqrt(x) > 1", Rejected),
            ("not sqrt(x) > 1", Selected),
            ("sqrt(y) >= 0 and sqrt(-x)^2 > 1", Selected),
            ("x^(1/3) > 1 or log(x) < 1", Rejected),
            ("cbrt(x) < -1 and (x^2)^(3/2) > 2", Selected),
            ("sin(x*pi/180) < 0 and cos(x) > 0 and tan(x) < -6", Selected),
            ("cot(x) < 0 and exp(x) < 1/4", Selected),
            ("exp(y) > 1", Rejected),
            ("log(y + 1) > 1 or log(1 + x^2) > 1", Selected),
            ("log(y) > 0", Undecided),
        ] {
            assert_eq!(on(condition), expected, "{condition}");
        }
    }

    /// The digits of doubles are those of the largest coordinate.
    #[test]
    fn small_coordinates_have_digits_of_their_own() {
        use Verdict::{OnBorder, Rejected, Selected};
        let equilibrium = "a^2 = 2e-14\ns = 5e-4*a^3*b\nb^2 = 2";
        let root = 2.0_f64.sqrt();
        let point = [1e-7 * root, 0.0, root];
        let on = |condition: &str| verdict(equilibrium, condition, &point, 2.3e-16);
        assert_eq!(on("s > 0"), Selected);
        assert_eq!(on("s <= 0"), Rejected);
        assert_eq!(on("b^2 >= 2"), OnBorder);
    }

    /// The accuracy of a multiple solution is an estimate, which may be too small by far.
    #[test]
    fn conditions_at_multiple_solutions_are_decided_exactly_or_lie_on_the_border() {
        use Verdict::{OnBorder, Rejected, Selected};
        let check = |equations: &str, values: [f64; 2], condition: &str, expected: Verdict| {
            let text = format!("{equations}\nwhere: {condition}");
            let problem = formats::plain::typed("test", &text).unwrap();
            let names = problem.system.variables.clone();
            let multiple = Solution {
                singular: true,
                multiplicity: 3,
                ..solution(&names, &values, 2.3e-16)
            };
            let mut selector = Selector::new(problem.conditions, 2, 0, Some(problem.system));
            assert_eq!(selector.verdict(&multiple, &[]), expected, "{condition}");
        };
        let origin = ("y^2 = x\nx*y = 0", [6.2e-19, -1e-13]);
        check(origin.0, origin.1, "x > 0", Rejected);
        check(origin.0, origin.1, "x >= 0 and y >= 0", Selected);
        let double = ("(x - 1)^2*(x - 3) = 0\ny^2 = x", [1.0 - 3e-9, -1.0]);
        check(double.0, double.1, "x >= 1", Selected);
        check(double.0, double.1, "x < 1", Rejected);
        let irrational = ("(x^2 - 2)^2 = 0\ny = x", [1.414_213_563, 1.414_213_563]);
        check(irrational.0, irrational.1, "x^2 >= 2", OnBorder);
        check(irrational.0, irrational.1, "x >= 1", Selected);
    }

    #[test]
    fn pairs_with_product_0_are_alternatives() {
        let text = r#"{"variables": ["x", "y"], "equations": ["x + y^2 - 3*y + 2"], "complementary": [["x", "y"]]}"#;
        let problem = formats::read("test", text.as_bytes()).unwrap();
        assert_eq!(problem.system.equations.len(), 2);
        let names = problem.system.variables.clone();
        let mut selector = Selector::new(problem.conditions, 2, 0, Some(problem.system));
        assert_eq!(selector.text(), "x >= 0 and y >= 0");
        let mut verdict =
            |x: f64, y: f64| selector.verdict(&solution(&names, &[x, y], 2.3e-16), &[]);
        assert_eq!(verdict(0.0, 1.0), Verdict::Selected);
        assert_eq!(verdict(1e-17, 2.0), Verdict::Selected);
        assert_eq!(verdict(-2.0, 0.0), Verdict::Rejected);
        assert_eq!(verdict(0.0, 0.0), Verdict::OnBorder);
    }

    #[test]
    fn only_what_is_real_is_selected_and_doubt_is_counted_apart() {
        let names = ["x".to_owned()];
        let conditions = formats::plain::typed("test", "x^2 = 2\nx > 1")
            .unwrap()
            .conditions;
        let mut selector = Selector::new(conditions, 1, 0, None);
        let real = solution(&names, &[1.5], 1e-15);
        let mut verdict = |change: &dyn Fn(&mut Solution)| {
            let mut changed = real.clone();
            change(&mut changed);
            selector.verdict(&changed, &[])
        };
        assert_eq!(verdict(&|_| ()), Verdict::Selected);
        assert_eq!(verdict(&|s| s.real = Some(false)), Verdict::Rejected);
        assert_eq!(verdict(&|s| s.real = None), Verdict::Undecided);
        assert_eq!(verdict(&|s| s.undecided = true), Verdict::Undecided);
        assert_eq!(verdict(&|s| s.accuracy = f64::INFINITY), Verdict::Undecided);
        assert_eq!(verdict(&|s| s.accuracy = 1.0), Verdict::OnBorder);
    }
}
