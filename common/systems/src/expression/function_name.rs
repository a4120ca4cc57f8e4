//! Function names: the functions that expressions may call, and what is said of those that they may not.

/// Functions that may be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FunctionName {
    /// Square root, principal branch.
    SquareRoot,
    /// Cube root: real of a real number, else the principal branch.
    CubeRoot,
    /// Exponential.
    Exponential,
    /// Natural logarithm, principal branch.
    Logarithm,
    /// Sine.
    Sine,
    /// Cosine.
    Cosine,
    /// Tangent.
    Tangent,
    /// Cotangent.
    Cotangent,
    /// Secant.
    Secant,
    /// Cosecant.
    Cosecant,
    /// Absolute value of what is real: the principal square root of the square.
    Absolute,
}

impl FunctionName {
    const ALL: [Self; 11] = [
        Self::SquareRoot,
        Self::CubeRoot,
        Self::Exponential,
        Self::Logarithm,
        Self::Sine,
        Self::Cosine,
        Self::Tangent,
        Self::Cotangent,
        Self::Secant,
        Self::Cosecant,
        Self::Absolute,
    ];

    /// The function as it is written.
    pub fn text(self) -> &'static str {
        match self {
            Self::SquareRoot => "sqrt",
            Self::CubeRoot => "cbrt",
            Self::Exponential => "exp",
            Self::Logarithm => "log",
            Self::Sine => "sin",
            Self::Cosine => "cos",
            Self::Tangent => "tan",
            Self::Cotangent => "cot",
            Self::Secant => "sec",
            Self::Cosecant => "csc",
            Self::Absolute => "abs",
        }
    }

    /// The function that is written so.
    pub fn of(name: &str) -> Option<Self> {
        let mut functions = Self::ALL.into_iter();
        functions.find(|function| function.text() == name)
    }

    /// The function that a name before a bracket calls: by its name, or `ln`.
    pub fn called(name: &str) -> Option<Self> {
        match name {
            "ln" => Some(Self::Logarithm),
            _ => Self::of(name),
        }
    }

    /// Whether nothing else may have this name. The others are functions only before a bracket: older files may have
    /// unknowns of these names.
    pub fn is_reserved(self) -> bool {
        !matches!(
            self,
            Self::CubeRoot | Self::Cotangent | Self::Secant | Self::Cosecant | Self::Absolute
        )
    }
}

/// Functions of other programs of which no equation with polynomials can speak.
const WITHOUT_POLYNOMIALS: [&str; 18] = [
    "sinh",
    "cosh",
    "tanh",
    "max",
    "min",
    "floor",
    "ceil",
    "round",
    "sign",
    "sgn",
    "mod",
    "erf",
    "gamma",
    "log10",
    "log2",
    "factorial",
    "conj",
    "arg",
];
/// Inverse functions, and what an equation says in their place.
const INVERSE_FUNCTIONS: [(&str, &str); 6] = [
    ("asin", "sin(a) = x"),
    ("arcsin", "sin(a) = x"),
    ("acos", "cos(a) = x"),
    ("arccos", "cos(a) = x"),
    ("atan", "tan(a) = x"),
    ("arctan", "tan(a) = x"),
];

/// Functions of angles in degrees, and the functions of angles that they are.
const OF_DEGREES: [(&str, &str); 3] = [("sind", "sin"), ("cosd", "cos"), ("tand", "tan")];

/// The function that a function of an angle in degrees is; `None` for every other name.
pub fn of_degrees(name: &str) -> Option<&'static str> {
    let function = OF_DEGREES.iter().find(|(other, _)| *other == name);
    function.map(|(_, function)| *function)
}

/// Returns a hint for a function of other programs: the equation to write in its place, or that it has no polynomial
/// form. `None` for every other name.
pub fn instead_of_function(name: &str) -> Option<String> {
    let inverse = INVERSE_FUNCTIONS.iter().find(|(other, _)| *other == name);
    if let Some((_, instead)) = inverse {
        return Some(format!("`{instead}` in the place of `a = {name}(x)`"));
    }
    if let Some(function) = of_degrees(name) {
        return Some(format!(
            "`{function}(x*pi/180)` in the place of `{name}(x)`"
        ));
    }
    let is_refused = WITHOUT_POLYNOMIALS.contains(&name);
    is_refused.then(|| format!("no `{name}` (it has no polynomial form)"))
}
