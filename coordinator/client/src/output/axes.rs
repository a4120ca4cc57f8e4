//! Axes of a drawing of curves: the two coordinates that it shows.

use super::text::counted;
use cognate_systems::system::System;

/// A coordinate that is shown: of which variable, and whether its imaginary part.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisOf {
    /// Place of the variable.
    pub variable: usize,
    /// Whether its imaginary part is shown.
    pub imaginary: bool,
    /// Name of the coordinate.
    pub name: String,
}

/// The two coordinates that are shown: of these variables, or of the first two. Of a variable that has another as its
/// conjugate both parts are shown.
pub fn axes(system: &System, names: &[String]) -> Result<Vec<AxisOf>, String> {
    let variables = &system.variables;
    let axis = |variable: usize, imaginary: bool| AxisOf {
        variable,
        imaginary,
        name: match imaginary {
            true => format!("Im {}", variables[variable]),
            false => variables[variable].clone(),
        },
    };
    let paired = |v: usize| {
        let mut pairs = system.conjugates.iter();
        pairs.any(|&(a, b)| a != b && (a == v || b == v))
    };
    let place = |name: &String| {
        let place = variables.iter().position(|v| v == name.trim());
        place.ok_or_else(|| format!("`{name}`; expected some of {}", variables.join(", ")))
    };
    let chosen = names.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    match chosen.as_slice() {
        [] if paired(0) => Ok(vec![axis(0, false), axis(0, true)]),
        [] => Ok(vec![
            axis(0, false),
            axis(1.min(variables.len() - 1), false),
        ]),
        [one, other] if paired(*one) && paired(*other) => {
            Ok(vec![axis(*one, false), axis(*one, true)])
        }
        [one] if paired(*one) => Ok(vec![axis(*one, false), axis(*one, true)]),
        [one, other] => Ok(vec![axis(*one, false), axis(*other, false)]),
        several => Err(format!(
            "{}; expected two",
            counted(several.len() as u64, "variable")
        )),
    }
}
