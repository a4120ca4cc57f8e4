//! Typed unknowns of a system: which of its variables were typed, which are helpers, and what they stand for.

use crate::expression::display::{Display, Style};
use crate::helper_unknown::{AngleUnknowns, Branch, Helper, MOST_PI_POWER, RootUnknown};
use crate::system::{System, SystemError};
use std::collections::HashMap;

/// Source of the coordinate of a typed unknown: a variable or an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TypedUnknown<'a> {
    /// The variable with this index.
    Variable(usize),
    /// An angle.
    Angle(&'a AngleUnknowns),
}

/// Meaning of a helper unknown, as shown to the user.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct HelperMeaning {
    /// Name of the helper unknown.
    pub name: String,
    /// The function that it stands for: `sqrt(x + 3)`.
    pub is: String,
}

impl System {
    /// The helper unknowns that are roots.
    pub fn root_unknowns(&self) -> impl Iterator<Item = &RootUnknown> {
        self.helpers.iter().filter_map(|helper| match helper {
            Helper::Root(root) => Some(root),
            Helper::Angle(_) => None,
        })
    }

    /// The angles among the typed unknowns.
    pub fn angle_unknowns(&self) -> impl Iterator<Item = &AngleUnknowns> {
        self.helpers.iter().filter_map(|helper| match helper {
            Helper::Root(_) => None,
            Helper::Angle(angle) => Some(angle),
        })
    }

    /// The unknowns as they were typed, in their order.
    pub fn typed_unknowns(&self) -> Vec<TypedUnknown<'_>> {
        let variables = 0..self.variables.len();
        let typed = variables.filter_map(|v| {
            let is_helper = |helper: &Helper| match helper {
                Helper::Root(root) => root.variable == v,
                Helper::Angle(angle) => angle.sine == v,
            };
            if self.helpers.iter().any(is_helper) {
                return None;
            }
            let angle = self.angle_unknowns().find(|angle| angle.cosine == v);
            Some(angle.map_or(TypedUnknown::Variable(v), TypedUnknown::Angle))
        });
        typed.collect()
    }

    /// A system without equations in the typed unknowns and the parameters: what conditions on solutions are read in.
    pub fn typed_system(&self) -> Self {
        let name = |unknown: TypedUnknown<'_>| match unknown {
            TypedUnknown::Variable(v) => self.variables[v].clone(),
            TypedUnknown::Angle(angle) => angle.name.clone(),
        };
        Self {
            variables: self.typed_unknowns().into_iter().map(name).collect(),
            parameters: self.parameters.clone(),
            ..Self::default()
        }
    }

    /// Every helper with the function that it stands for.
    pub fn helper_meanings(&self) -> Vec<HelperMeaning> {
        let shared = HashMap::new();
        let display = Display {
            expressions: &self.expressions,
            variables: &self.variables,
            parameters: &self.parameters,
            shared: &shared,
            style: Style::BERTINI,
        };
        let mut meanings = Vec::new();
        let mut push = |variable: usize, is: String| {
            let name = self.variables[variable].clone();
            meanings.push(HelperMeaning { name, is });
        };
        for helper in &self.helpers {
            match helper {
                Helper::Root(root) => {
                    let radicand = display.text(root.radicand);
                    push(root.variable, root.function(&radicand));
                }
                Helper::Angle(angle) => {
                    let argument = angle.unit.times(&angle.name);
                    push(angle.cosine, format!("cos({argument})"));
                    push(angle.sine, format!("sin({argument})"));
                }
            }
        }
        meanings
    }

    /// Helpers refer to variables and nodes that exist, each variable to one helper.
    pub(crate) fn check_helpers(&self) -> Result<(), SystemError> {
        let mut taken = vec![false; self.variables.len()];
        for helper in &self.helpers {
            let variables = match helper {
                Helper::Root(root) => {
                    if root.radicand.0 as usize >= self.expressions.nodes().len() {
                        return Err(SystemError::DanglingReference("a radicand".into()));
                    }
                    if root.degree < 2 || (root.branch == Branch::Real && root.degree != 3) {
                        return Err(SystemError::Misfit("the degree of a root".into()));
                    }
                    vec![root.variable]
                }
                Helper::Angle(angle) => {
                    let unit = angle.unit;
                    if unit.denominator == 0 || unit.pi_power.unsigned_abs() > MOST_PI_POWER {
                        return Err(SystemError::Misfit("the unit of an angle".into()));
                    }
                    vec![angle.cosine, angle.sine]
                }
            };
            for v in variables {
                let missing = || SystemError::DanglingReference("a helper unknown".into());
                if std::mem::replace(taken.get_mut(v).ok_or_else(missing)?, true) {
                    return Err(SystemError::Misfit("a helper unknown".into()));
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial::degrees;

    fn read(equations: &str) -> Result<System, String> {
        let problem = crate::formats::plain::typed("test", equations);
        problem.map(|p| p.system).map_err(|e| e.to_string())
    }

    fn meanings(system: &System) -> Vec<String> {
        let meanings = system.helper_meanings();
        meanings
            .iter()
            .map(|m| format!("{}: {}", m.name, m.is))
            .collect()
    }

    #[track_caller]
    fn check(equations: &str, helpers: &[&str], expected_degrees: &[u32]) {
        let system = read(equations).unwrap();
        assert_eq!(system.check(), Ok(()));
        assert_eq!(meanings(&system), helpers);
        assert_eq!(degrees(&system).unwrap().total, expected_degrees);
    }

    #[test]
    fn each_function_has_one_helper() {
        check("sqrt(x+3) = x-3", &["root_1: sqrt(x + 3)"], &[1, 2]);
        check(
            "sqrt(x)*y = 1; (x)^(1/2) = x^(3/2) + cbrt(y)",
            &["root_1: sqrt(x)", "root_2: cbrt(y)"],
            &[2, 3, 2, 3],
        );
        check(
            "sqrt(1 + sqrt(x)) = 1/x",
            &["root_1: sqrt(x)", "root_2: sqrt(1 + root_1)"],
            &[2, 2, 2],
        );
        check("x^(-2/3) = 4", &["root_1: (x)^(1/3)"], &[2, 3]);
        check("8^(1/3)*x = cbrt(-8)", &[], &[1]);
        check("abs(x - 1) = 2", &["root_1: sqrt((x - 1)^2)"], &[1, 2]);
        check("abs(-3)*x = abs(3 + 4*I)", &[], &[1]);
    }

    #[test]
    fn angles_are_points_of_the_circle() {
        let arm = "cos(a) + cos(a + b) = 1; sin(a) + sin(a + b) = 1";
        let helpers = [
            "cos_a: cos(a)",
            "sin_a: sin(a)",
            "cos_b: cos(b)",
            "sin_b: sin(b)",
        ];
        check(arm, &helpers, &[2, 2, 2, 2]);
        let system = read(arm).unwrap();
        let typed = system.typed_unknowns();
        let names = typed.iter().map(|unknown| match unknown {
            TypedUnknown::Angle(angle) => angle.name.as_str(),
            TypedUnknown::Variable(_) => "no angle",
        });
        assert_eq!(names.collect::<Vec<_>>(), ["a", "b"]);
        check("sin(3*a - Pi/2) = x; x = tan(a)", &helpers[..2], &[3, 2, 2]);
        check("exp(2*I*a) = I", &helpers[..2], &[2, 2]);
        check("sec(a) = 2", &helpers[..2], &[1, 2]);
    }

    #[test]
    fn angles_have_the_unit_that_all_multiples_have_in_common() {
        let pair = |argument: &str| {
            [
                format!("cos_x: cos({argument})"),
                format!("sin_x: sin({argument})"),
            ]
        };
        let check_unit = |equation: &str, argument: &str, degrees: &[u32]| {
            check(
                equation,
                &pair(argument).each_ref().map(String::as_str),
                degrees,
            );
        };
        check_unit("sin(x/2) = cos(x)", "x/2", &[2, 2]);
        check_unit("cos(x) = sin(x/2)", "x/2", &[2, 2]);
        check_unit("cos(1.5*x) = sin(x)", "x/2", &[3, 2]);
        check_unit("cos(x/2) = sin(x/3)", "x/6", &[3, 2]);
        check_unit("sin(x*pi/180) = 1/2", "x*pi/180", &[1, 2]);
        check_unit("sin(pi*(x + 90)/180) = cos(x*pi/90)", "x*pi/180", &[2, 2]);
        check_unit("sin(2*x*pi/180) = 1/2", "x*pi/180", &[2, 2]);
        check_unit("cos(pi/180*(3*x)) = 1/2", "x*pi/180", &[3, 2]);
        check_unit("sin(2*pi*x/360) = 1/2", "x*pi/180", &[1, 2]);
        check_unit("sin(2*pi*x/12) = 1/2", "x*pi/6", &[1, 2]);
        check_unit("tan(x/pi) = 1", "x/pi", &[1, 2]);
        check_unit("exp(I*x/2) = I", "x/2", &[1, 2]);
    }

    /// Constants of any length are read without a stack of their depth.
    #[test]
    fn long_constants_beside_angles_are_no_recursion() {
        let long = vec!["pi"; 50_000].join("*");
        let message = read(&format!("sin(x*{long}) = 1/2")).unwrap_err();
        assert!(
            message.contains("multiples of an unknown angle"),
            "{message}"
        );
        read(&format!("sin(x + {long}) = 1/2")).expect("a constant");
        let one = "pi/pi*".repeat(200);
        let message = read(&format!("sin(x*({one}1)) = 1/2")).unwrap_err();
        assert!(
            message.contains("multiples of an unknown angle"),
            "{message}"
        );
    }

    #[test]
    fn what_no_polynomial_can_say_is_refused_with_the_reason() {
        for (equations, part) in [
            (
                "log(x) = 1",
                "logarithms of unknowns have no polynomial form",
            ),
            ("x = sin(x)", "the angle `x` only inside"),
            ("sqrt(x) = sin(x)", "the angle `x` only inside"),
            ("sin(sqrt(2)*x) = 1", "multiples of an unknown angle"),
            ("sin(Pi*x) = sin(x)", "multiples of an unknown angle"),
            ("sin(Pi*x + x) = 1", "multiples of an unknown angle"),
            ("sin(Pi^20*x) = 1", "multiples of an unknown angle"),
            ("sin(x/99999) = sin(x/99998)", "EXPONENT"),
            ("exp(x) = 2", "write y for exp(x)"),
            ("sin(x^2) = 1/2", "a sum of multiples of unknown angles"),
            ("2^x = 8", "a rational number as exponent"),
            (
                "ln(x) = 1",
                "logarithms of unknowns have no polynomial form",
            ),
            ("sinh(x) = 1", "no `sinh` (it has no polynomial form)"),
            ("asin(x) = y", "`sin(a) = x` in the place of `a = asin(x)`"),
            (
                "x(x - 1) = 2",
                "an operator (such as `*(`, since `x` is no function)",
            ),
            ("(2 (x + 1)) = 4", "an operator (such as `*(`) or `)`"),
            ("1/2x = 4", "`/(2*x)` or `/2*x`"),
            ("x^2y = 4", "an operator (such as `*y`)"),
            ("sin x = 1", "`(` after the function `sin`"),
            (
                "abs(sqrt(2))*x = 1",
                "a rational number as argument of `abs`",
            ),
            ("x > 2", "an equation beside the conditions"),
            ("parameters: p\nsin(x + p) = 1", "a parameter"),
            ("groups: x | a\nsin(a) + x", ""),
        ] {
            match read(equations) {
                Err(message) => assert!(!part.is_empty() && message.contains(part), "{message}"),
                Ok(_) => assert!(part.is_empty(), "{equations}"),
            }
        }
        let json = r#"{"variables": ["x", "a"], "equations": ["x = 1", "a = cos(a)"]}"#;
        let message = crate::formats::read("test", json.as_bytes())
            .unwrap_err()
            .to_string();
        assert!(message.contains("equations[1]"), "{message}");
    }
}
