//! Set structures of linear-product starts: guessed from the monomials or given, checked and counted.

use crate::monomials::not_multiplied_out;
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::start_systems::linear_product::{
    LinearProductError, SOLVING_STEPS, SetStructure, check_covered, count, guess,
};
use cognate_systems::polynomial::supports;
use cognate_systems::system::{System, VariableGroup};

/// The system as it is tracked, its start points, and how many there are.
pub(crate) type LinearProductStart = (System, StartPoints, u64);

/// Most steps of one count of the choices of a linear-product start: a fraction of a second.
const CHOICE_STEPS: u64 = 5_000_000;

/// Largest degree for which sets are guessed: the time grows with its cube.
const MOST_FACTORS: u32 = 100;

/// Sets of variables that are guessed from the monomials; `groups` are tried too.
pub(crate) fn guessed(
    system: &System,
    groups: &[VariableGroup],
) -> Result<LinearProductStart, String> {
    let supports = supports_of(system)?;
    let groups: Vec<Vec<usize>> = groups.iter().map(|g| g.variables.clone()).collect();
    let variables = system.variables.len();
    let (sets, count) = guess(&supports, variables, &groups, CHOICE_STEPS)
        .ok_or("counting the choices of factors takes too long")?;
    Ok(start(system, sets, count))
}

/// The sets that are given: for each equation as many as its degree, whose product has all of
/// its monomials.
pub(crate) fn given(system: &System, sets: &SetStructure) -> Result<LinearProductStart, String> {
    let supports = supports_of(system)?;
    let variables = system.variables.len();
    if sets.len() != supports.len() {
        return Err(format!(
            "there are sets for {} equations; the system has {}",
            sets.len(),
            supports.len()
        ));
    }
    let mut sorted = sets.clone();
    for (i, (factors, support)) in sorted.iter_mut().zip(&supports).enumerate() {
        let degree = support.iter().map(|m| m.iter().sum::<u32>()).max();
        if degree.is_none_or(|degree| degree as usize != factors.len()) {
            return Err(format!(
                "{} has {} sets; expected as many as its degree, {}",
                equation_name(system, i),
                factors.len(),
                degree.unwrap_or(0)
            ));
        }
        for set in factors.iter_mut() {
            set.sort_unstable();
        }
        factors.sort();
    }
    check_covered(&sorted, &supports, variables).map_err(|error| match error {
        LinearProductError::NotCovered(equation) => format!(
            "{} has the monomial {}, which the product of its sets {} does not have",
            equation_name(system, equation),
            not_covered(&sorted, &supports, equation)
                .map_or("".into(), |monomial| { monomial_name(system, monomial) }),
            sets_of_equation(system, &sorted[equation]),
        ),
        other => other.to_string(),
    })?;
    match count(&sorted, variables, SOLVING_STEPS) {
        None => Err("counting the choices of factors takes too long".into()),
        Some(0) => Err(
            "no choice of one set for each equation has a solution: there is none that is \
             isolated, or the sets are not meant"
                .into(),
        ),
        Some(count) => Ok(start(system, sorted, count)),
    }
}

/// The first monomial of an equation that its product does not have.
fn not_covered<'a>(
    sets: &SetStructure,
    supports: &'a [Vec<Vec<u32>>],
    equation: usize,
) -> Option<&'a Vec<u32>> {
    let mut alone = vec![Vec::new(); supports.len()];
    supports[equation].iter().find(|&monomial| {
        alone[equation] = vec![monomial.clone()];
        check_covered(sets, &alone, monomial.len()).is_err()
    })
}

/// In one affine group, as these starts are followed.
fn start(system: &System, sets: SetStructure, count: u64) -> LinearProductStart {
    let mut tracked = system.clone();
    tracked.groups = vec![VariableGroup {
        variables: (0..system.variables.len()).collect(),
        homogeneous: false,
    }];
    (tracked, StartPoints::LinearProduct { sets, count }, count)
}

/// The monomials, where a linear-product start can be.
fn supports_of(system: &System) -> Result<Vec<Vec<Vec<u32>>>, String> {
    if system.groups.iter().any(|group| group.homogeneous) {
        return Err("not counted for homogeneous groups".into());
    }
    if system.equation_count() > system.dimension() {
        return Err("not counted for combinations of equations".into());
    }
    let supports = supports(system).ok_or_else(|| not_multiplied_out(system))?;
    let mut monomials = supports.iter().flatten();
    if monomials.any(|m| m.iter().sum::<u32>() > MOST_FACTORS) {
        return Err(format!("not tried for degrees above {MOST_FACTORS}"));
    }
    Ok(supports)
}

fn equation_name(system: &System, equation: usize) -> String {
    match system.equation_names.get(equation) {
        Some(name) if !name.is_empty() => format!("the equation {name}"),
        _ => format!("equation {}", equation + 1),
    }
}

/// A monomial as it is written: `x^2*y`.
fn monomial_name(system: &System, exponents: &[u32]) -> String {
    let powers = system.variables.iter().zip(exponents);
    let powers: Vec<String> = powers
        .filter(|&(_, &e)| e > 0)
        .map(|(name, &e)| match e {
            1 => name.clone(),
            _ => format!("{name}^{e}"),
        })
        .collect();
    match powers.is_empty() {
        true => "1".into(),
        false => powers.join("*"),
    }
}

/// The sets of a linear-product start in words, equations of the same sets together:
/// `{x} {y, z}^2 | ...`; without end where they are many.
pub(crate) fn set_names(system: &System, start: &StartPoints) -> String {
    const MOST: usize = 3;
    let StartPoints::LinearProduct { sets, .. } = start else {
        return String::new();
    };
    let equations: Vec<String> = sets
        .iter()
        .map(|factors| sets_of_equation(system, factors))
        .collect();
    let runs: Vec<String> = equations
        .chunk_by(|a, b| a == b)
        .map(|run| match run.len() {
            1 => run[0].clone(),
            n => format!("{n} times {}", run[0]),
        })
        .collect();
    let more = match runs.len().saturating_sub(MOST) {
        0 => String::new(),
        n => format!(" | and {n} more"),
    };
    format!(
        "the sets {}{more}",
        runs[..runs.len().min(MOST)].join(" | ")
    )
}

/// The sets of one equation: `{x} {y, z}^2`.
fn sets_of_equation(system: &System, factors: &[Vec<u32>]) -> String {
    let variable_count = system.variables.len();
    let one = |set: &[u32]| match set.len() {
        0 => "{}".to_string(),
        n if n == variable_count && n > 2 => "{all}".to_string(),
        _ => {
            let names: Vec<&str> = set
                .iter()
                .map(|&v| system.variables[v as usize].as_str())
                .collect();
            format!("{{{}}}", names.join(", "))
        }
    };
    let runs = factors.chunk_by(|a, b| a == b);
    let runs: Vec<String> = runs
        .map(|run| match run.len() {
            1 => one(&run[0]),
            n => format!("{}^{n}", one(&run[0])),
        })
        .collect();
    runs.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x*y - 1 = x^2 + x*y + y = 0: {x} {y} and {x, y} {x}.
    fn system() -> System {
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y;\nfunction f, g;\n\
                    f = x*y - 1;\ng = x^2 + x*y + y;\nEND;\n";
        match cognate_systems::formats::read("test", text.as_bytes()) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn given_sets_are_counted_in_any_order() {
        let system = system();
        let sets = vec![vec![vec![1], vec![0]], vec![vec![1, 0], vec![0]]];
        let (_, start, count) = given(&system, &sets).expect("they fit");
        assert_eq!(count, 3, "{{x}} with {{x}} has no solution");
        let words = "the sets {x} {y} | {x} {x, y}";
        assert_eq!(set_names(&system, &start), words);
    }

    #[test]
    fn what_does_not_serve_is_named() {
        let system = system();
        let said = |f: Vec<Vec<u32>>, g: Vec<Vec<u32>>| {
            let error = given(&system, &vec![f, g]);
            error.err().unwrap_or_default()
        };
        let (f, g) = (vec![vec![0], vec![1]], vec![vec![0, 1], vec![0]]);
        assert_eq!(said(f.clone(), g.clone()), "");
        assert_eq!(
            said(f.clone(), vec![vec![0], vec![1]]),
            "the equation g has the monomial x^2, which the product of its sets {x} {y} does not have"
        );
        assert_eq!(
            said(f.clone(), vec![vec![0, 1]]),
            "the equation g has 1 sets; expected as many as its degree, 2"
        );
        let twice = said(f.clone(), vec![vec![0, 1], vec![0, 0]]);
        assert!(twice.starts_with("the sets do not fit"), "{twice}");
        let outside = said(f, vec![vec![0, 1], vec![2]]);
        assert!(outside.starts_with("the sets do not fit"), "{outside}");
        let one = given(&system, &vec![g]).err().unwrap_or_default();
        assert_eq!(one, "there are sets for 1 equations; the system has 2");
    }
}
