//! Exchange: a symmetry that takes whole groups of variables to each other, and equations to equations.
//!
//! A start system that has it too makes pairs of start points whose paths are
//! each other's images, so that one of each two is followed (Wampler, Morgan,
//! Sommese, Complete solution of the nine-point path synthesis problem, 1992).

use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::evaluation::values;
use cognate_systems::system::{SymmetryGenerator, System, VariableGroup};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Largest relative difference of two values of one polynomial, by two ways of rounding.
const ROUNDING: f64 = 1e-9;

/// An involution of the variables that exchanges groups, each as a whole, or leaves them alone variable by variable;
/// and its effect on the equations.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Exchange {
    /// Variable `i` takes the value of variable `variables[i]`.
    pub variables: Vec<usize>,
    /// Equation `i` becomes equation `equations[i]`.
    pub equations: Vec<usize>,
    /// Group `k` goes to group `groups[k]`.
    pub groups: Vec<usize>,
}

/// Whether this takes every number below its length to another and back, or leaves it.
fn is_involution(permutation: &[usize]) -> bool {
    let there_and_back = |(i, &j): (usize, &usize)| permutation.get(j) == Some(&i);
    permutation.iter().enumerate().all(there_and_back)
}

impl Exchange {
    /// The first generator of the system's symmetry that is one and that some equation gives a
    /// half to (see [`Self::halving`]); `degrees[equation][group]`.
    pub fn of(system: &System, degrees: &[Vec<u32>]) -> Option<Self> {
        system.symmetry.iter().find_map(|generator| {
            let SymmetryGenerator::Permutation(variables) = generator else {
                return None;
            };
            let exchange = Self {
                variables: variables.clone(),
                equations: equations(system, variables)?,
                groups: groups(system, variables)?,
            };
            let serves = is_involution(&exchange.equations);
            (serves && exchange.halving(degrees).is_some()).then_some(exchange)
        })
    }

    /// Whether the numbers of the exchange fit the groups of the system; its equations are not tested.
    pub fn fits(&self, system: &System) -> bool {
        self.equations.len() == system.equation_count()
            && is_involution(&self.equations)
            && groups(system, &self.variables).as_ref() == Some(&self.groups)
    }

    /// The equation that decides which of two start points is followed: the involution takes it to itself, and
    /// exchanges the group of its factor. The start point that is followed takes this factor from the first of the two
    /// groups. `None` where there is no equation of this kind.
    pub fn halving(&self, degrees: &[Vec<u32>]) -> Option<usize> {
        degrees.iter().enumerate().position(|(i, row)| {
            let mut moved = row.iter().zip(self.groups.iter().enumerate());
            self.equations.get(i) == Some(&i) && moved.all(|(&d, (k, &to))| d == 0 || to != k)
        })
    }
}

/// Image of each group; `None` where this is no involution that exchanges groups.
fn groups(system: &System, variables: &[usize]) -> Option<Vec<usize>> {
    if variables.len() != system.variable_count() || !is_involution(variables) {
        return None;
    }
    let mut home = vec![0; variables.len()];
    for (k, group) in system.groups.iter().enumerate() {
        group.variables.iter().for_each(|&v| home[v] = k);
    }
    let goes = |(k, group): (usize, &VariableGroup)| {
        let to = home[variables[*group.variables.first()?]];
        let other = &system.groups[to];
        let whole = group.variables.iter().all(|&v| home[variables[v]] == to)
            && group.variables.len() == other.variables.len()
            && group.homogeneous == other.homogeneous;
        let alone = group.variables.iter().all(|&v| variables[v] == v);
        (whole && (to != k || alone)).then_some(to)
    };
    system.groups.iter().enumerate().map(goes).collect()
}

/// Image of each equation when variable `i` takes the value of `variables[i]`; `None` where the equations do not become
/// each other for all parameters. Polynomials are told apart by their values at random points.
fn equations(system: &System, variables: &[usize]) -> Option<Vec<usize>> {
    if variables.len() != system.variable_count() || !is_involution(variables) {
        return None;
    }
    const POINTS: u64 = 2;
    let system = &*system.in_unknowns();
    let mut there = vec![Vec::new(); system.equation_count()];
    let mut here = there.clone();
    for k in 0..POINTS {
        let mut stream = RandomStream::new(k, Purpose::Probe, 2);
        let point: Vec<Complex64> = variables.iter().map(|_| stream.unit()).collect();
        let image: Vec<Complex64> = variables.iter().map(|&v| point[v]).collect();
        let parameters: Vec<Complex64> = system.parameters.iter().map(|_| stream.unit()).collect();
        let at = |x: &[Complex64]| values(&system.expressions, &system.equations, x, &parameters);
        for (i, (z, w)) in at(&point).into_iter().zip(at(&image)).enumerate() {
            here[i].push(z);
            there[i].push(w);
        }
    }
    let same = |a: &[Complex64], b: &[Complex64]| {
        a.iter().zip(b).all(|(z, w)| {
            (z - w).norm_sqr() <= ROUNDING * ROUNDING * z.norm_sqr().max(w.norm_sqr())
        })
    };
    let becomes = |i: usize| (0..here.len()).find(|&j| same(&there[i], &here[j]));
    (0..here.len()).map(becomes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::formats;

    fn system(equations: &str, symmetry: &str) -> System {
        let text = format!(
            r#"{{"variables": ["x", "u", "y", "v"], "groups": [["x", "u"], ["y", "v"]],
                "equations": {equations}, "symmetry": [{symmetry}]}}"#
        );
        let problem = formats::read("test", text.as_bytes());
        problem.expect("a problem of this test").system
    }

    const SWAP: &str = r#"{"permutation": {"x": "y", "y": "x", "u": "v", "v": "u"}}"#;

    #[test]
    fn groups_and_equations_are_followed() {
        let equations = r#"["x^2 - u", "x*y - 3", "y^2 - v", "u + v + x + y - 1"]"#;
        let system = system(equations, SWAP);
        let degrees = vec![vec![2, 0], vec![1, 1], vec![0, 2], vec![1, 1]];
        let exchange = Exchange::of(&system, &degrees).expect("an exchange");
        assert_eq!(exchange.equations, [2, 1, 0, 3]);
        assert_eq!(exchange.groups, [1, 0]);
        assert_eq!(exchange.halving(&degrees), Some(1));
        assert!(exchange.fits(&system));
    }

    #[test]
    fn what_is_no_exchange_of_the_system_is_none() {
        let degrees = vec![vec![2, 0], vec![1, 1], vec![0, 2], vec![1, 1]];
        let none = |equations, symmetry| {
            assert_eq!(Exchange::of(&system(equations, symmetry), &degrees), None);
        };
        // The third equation is not the first of the other group.
        none(
            r#"["x^2 - u", "x*y - 3", "y^2 - 2*v", "u + v + x + y - 1"]"#,
            SWAP,
        );
        // Inside the groups.
        none(
            r#"["x^2 + u^2", "x*u - 3", "y^2 + v^2", "u + v + x + y - 1"]"#,
            r#"{"permutation": {"x": "u", "u": "x", "y": "v", "v": "y"}}"#,
        );
        // No equation is left alone: nothing says which of two is followed.
        let text = r#"["x^2 - u", "u^2 - 3*x", "y^2 - v", "v^2 - 3*y"]"#;
        let alone = system(text, SWAP);
        let degrees = vec![vec![2, 0], vec![2, 0], vec![0, 2], vec![0, 2]];
        assert_eq!(Exchange::of(&alone, &degrees), None);
    }
}
