//! Equations in the making: names, expressions as text, and what belongs to a system besides.

use crate::mechanism::exact::double_expression;
use crate::mechanism::pose::Pose;
use crate::mechanism::{MechanismError, Vector};
use cognate_systems::formats;
use cognate_systems::system::System;
use std::fmt::Write as _;

/// A system as it is written down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Equations {
    /// Variables, by group.
    pub groups: Vec<Vec<String>>,
    /// Whether the groups are homogeneous.
    pub homogeneous: bool,
    /// Parameters: the target.
    pub parameters: Vec<String>,
    /// Names for expressions.
    pub definitions: Vec<(String, String)>,
    /// Expressions that are 0 at a solution.
    pub equations: Vec<String>,
    /// Variables that are conjugates at a real solution.
    pub conjugates: Vec<(String, String)>,
    /// Expressions that vanish where a solution is no position, by name.
    pub degenerate: Vec<(&'static str, String)>,
    /// Linear maps of the variables that take solutions to solutions: those that change, and into what.
    pub symmetry: Vec<Vec<(String, String)>>,
}

impl Equations {
    /// Names an expression, unless it is short.
    pub fn define(&mut self, name: String, expression: String) -> String {
        if is_short(&expression) {
            return expression;
        }
        self.definitions.push((name.clone(), expression));
        name
    }

    /// How many unknowns there are, lines through the origin counted as points.
    pub fn unknowns(&self) -> usize {
        let variables: usize = self.groups.iter().map(Vec::len).sum();
        if self.homogeneous {
            variables - self.groups.len()
        } else {
            variables
        }
    }

    /// The equations with numbers in the place of the first parameters, exactly these doubles.
    #[must_use]
    pub fn with_first_parameters(&self, values: &[f64]) -> Self {
        let count = values.len().min(self.parameters.len());
        let (fixed, free) = self.parameters.split_at(count);
        let numbers = fixed.iter().cloned();
        let numbers = numbers.zip(values.iter().map(|x| double_expression(*x)));
        Self {
            parameters: free.to_vec(),
            definitions: numbers.chain(self.definitions.iter().cloned()).collect(),
            ..self.clone()
        }
    }

    /// The variables in the order of the system.
    pub fn variables(&self) -> Vec<String> {
        self.groups.iter().flatten().cloned().collect()
    }

    /// The problem in our JSON.
    pub fn json(&self) -> String {
        let list = |names: &[String]| {
            let quoted: Vec<String> = names.iter().map(|n| format!("\"{n}\"")).collect();
            format!("[{}]", quoted.join(", "))
        };
        let pairs = |pairs: &[(String, String)]| {
            let quoted: Vec<String> = pairs
                .iter()
                .map(|(a, b)| format!("    \"{a}\": \"{b}\""))
                .collect();
            quoted.join(",\n")
        };
        let mut text = format!("{{\n  \"variables\": {},\n", list(&self.variables()));
        if self.groups.len() > 1 {
            let groups: Vec<String> = self.groups.iter().map(|g| list(g)).collect();
            let _ = writeln!(text, "  \"groups\": [{}],", groups.join(", "));
        }
        if self.homogeneous {
            text.push_str("  \"homogeneous\": true,\n");
        }
        if !self.parameters.is_empty() {
            let _ = writeln!(text, "  \"parameters\": {},", list(&self.parameters));
        }
        if !self.definitions.is_empty() {
            let _ = writeln!(
                text,
                "  \"definitions\": {{\n{}\n  }},",
                pairs(&self.definitions)
            );
        }
        if !self.conjugates.is_empty() {
            let list: Vec<String> = self
                .conjugates
                .iter()
                .map(|(a, b)| format!("[\"{a}\", \"{b}\"]"))
                .collect();
            let _ = writeln!(text, "  \"conjugates\": [{}],", list.join(", "));
        }
        if !self.degenerate.is_empty() {
            let sets: Vec<String> = self
                .degenerate
                .iter()
                .map(|(name, zero)| format!("\"{name}\": {{\"nonzero\": \"{zero}\"}}"))
                .collect();
            let _ = writeln!(text, "  \"degenerate\": {{{}}},", sets.join(", "));
        }
        if !self.symmetry.is_empty() {
            let maps: Vec<String> = self
                .symmetry
                .iter()
                .map(|map| format!("{{\"map\": {{\n{}\n  }}}}", pairs(map)))
                .collect();
            let _ = writeln!(text, "  \"symmetry\": [{}],", maps.join(", "));
        }
        let equations: Vec<String> = self
            .equations
            .iter()
            .map(|e| format!("    \"{e}\""))
            .collect();
        let _ = write!(
            text,
            "  \"equations\": [\n{}\n  ]\n}}\n",
            equations.join(",\n")
        );
        text
    }

    /// The system that is solved.
    pub fn system(&self, file: &str) -> Result<System, MechanismError> {
        let text = self.json();
        let problem = formats::read(file, text.as_bytes()).map_err(|e| {
            MechanismError::of_file(file, format!("its equations are no system: {e}"))
        })?;
        Ok(problem.system)
    }
}

fn is_short(expression: &str) -> bool {
    expression.len() <= 2
        || expression
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

/// A product, with 0 and 1 left out.
pub fn times(a: &str, b: &str) -> String {
    match (a, b) {
        ("0", _) | (_, "0") => "0".into(),
        ("1", x) | (x, "1") => x.into(),
        ("(-1)", x) | (x, "(-1)") => format!("(-{x})"),
        _ => format!("{a}*{b}"),
    }
}

/// A sum in brackets, with 0 left out.
pub fn sum(terms: &[String]) -> String {
    let terms: Vec<&str> = terms
        .iter()
        .map(String::as_str)
        .filter(|t| *t != "0")
        .collect();
    match terms[..] {
        [] => "0".into(),
        [one] => one.into(),
        _ => format!("({})", terms.join("+")),
    }
}

/// a - b.
pub fn minus(a: &str, b: &str) -> String {
    match (a, b) {
        (a, "0") => a.into(),
        ("0", b) => format!("(-{b})"),
        _ => format!("({a}-{b})"),
    }
}

/// A scalar product.
pub fn dot(a: &[String; 3], b: &[String; 3]) -> String {
    sum(&[
        times(&a[0], &b[0]),
        times(&a[1], &b[1]),
        times(&a[2], &b[2]),
    ])
}

/// A vector of exact numbers.
pub fn vector(v: &Vector) -> [String; 3] {
    [v[0].expression(), v[1].expression(), v[2].expression()]
}

/// A vector of exact numbers, multiples of roots among them.
pub fn exact_vector(v: &Vector) -> [String; 3] {
    v.each_ref().map(|number| number.exact_expression())
}

/// A vector of doubles.
pub fn doubles(v: [f64; 3]) -> [String; 3] {
    v.map(double_expression)
}

/// A complex number of exact parts, or its conjugate.
pub fn complex(x: &str, y: &str, conjugate: bool) -> String {
    match (x, y) {
        (x, "0") => x.into(),
        (x, y) => format!("({x}{}{y}*I)", if conjugate { "-" } else { "+" }),
    }
}

/// A pose of expressions.
#[derive(Clone, Debug, PartialEq)]
pub struct TextPose {
    /// The rotation by rows.
    pub rotation: [[String; 3]; 3],
    /// The position.
    pub position: [String; 3],
}

impl TextPose {
    /// A pose of real numbers.
    pub fn constant(pose: &Pose) -> Self {
        Self {
            rotation: pose.rotation.map(|row| doubles(row.map(|c| c.re))),
            position: doubles(pose.position.map(|c| c.re)),
        }
    }

    /// The turn about z.
    pub fn about_z(c: &str, s: &str) -> Self {
        let rows = [
            [c.to_owned(), format!("(-{s})"), "0".into()],
            [s.to_owned(), c.to_owned(), "0".into()],
            ["0", "0", "1"].map(String::from),
        ];
        Self {
            rotation: rows,
            position: ["0", "0", "0"].map(String::from),
        }
    }

    /// A shift.
    pub fn shift(position: [String; 3]) -> Self {
        Self {
            position,
            ..Self::constant(&Pose::IDENTITY)
        }
    }

    /// The pose of the parameters q0, q1, q2, q3, a quaternion the square of whose length is `square`, and px, py, pz.
    pub fn of_parameters(square: &str) -> Self {
        let rows = [
            ["q0^2+q1^2-q2^2-q3^2", "2*(q1*q2-q0*q3)", "2*(q1*q3+q0*q2)"],
            ["2*(q1*q2+q0*q3)", "q0^2-q1^2+q2^2-q3^2", "2*(q2*q3-q0*q1)"],
            ["2*(q1*q3-q0*q2)", "2*(q2*q3+q0*q1)", "q0^2-q1^2-q2^2+q3^2"],
        ];
        Self {
            rotation: rows.map(|row| row.map(|e| format!("(({e})/{square})"))),
            position: ["px", "py", "pz"].map(String::from),
        }
    }

    /// This pose, then the other in its frame; entries get names.
    pub fn then(&self, other: &Self, name: &str, equations: &mut Equations) -> Self {
        let entry = |i: usize, j: usize| {
            let column: [String; 3] = std::array::from_fn(|k| other.rotation[k][j].clone());
            dot(&self.rotation[i], &column)
        };
        let rotation = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                equations.define(format!("{name}r{}{}", i + 1, j + 1), entry(i, j))
            })
        });
        let position = self.point(&other.position);
        let mut index = 0;
        let position = position.map(|c| {
            index += 1;
            equations.define(format!("{name}p{index}"), c)
        });
        Self { rotation, position }
    }

    /// Image of a point.
    pub fn point(&self, p: &[String; 3]) -> [String; 3] {
        let turned = self.direction(p);
        std::array::from_fn(|i| sum(&[turned[i].clone(), self.position[i].clone()]))
    }

    /// Image of a direction.
    pub fn direction(&self, d: &[String; 3]) -> [String; 3] {
        std::array::from_fn(|i| dot(&self.rotation[i], d))
    }

    /// A column of the rotation.
    pub fn column(&self, j: usize) -> [String; 3] {
        std::array::from_fn(|i| self.rotation[i][j].clone())
    }
}

/// Names of the parameters of a pose: a quaternion of any length, and a position.
pub fn pose_parameters() -> Vec<String> {
    let names = ["q0", "q1", "q2", "q3", "px", "py", "pz"];
    names.map(String::from).to_vec()
}

/// The square of the length of the quaternion among them.
pub const QUATERNION_SQUARE: &str = "q0^2+q1^2+q2^2+q3^2";

/// Names cosine and sine of an angle that is given by two parameters, half-tangent t/w.
pub fn turn(equations: &mut Equations, name: &str) -> (String, String) {
    let (t, w) = (format!("t_{name}"), format!("w_{name}"));
    equations.parameters.extend([t.clone(), w.clone()]);
    let c = equations.define(format!("c_{name}"), format!("({w}^2-{t}^2)/({w}^2+{t}^2)"));
    let s = equations.define(format!("s_{name}"), format!("2*{t}*{w}/({w}^2+{t}^2)"));
    (c, s)
}
