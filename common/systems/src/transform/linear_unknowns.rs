//! A system without the unknowns that its linear equations give.

use crate::expression::differentiate::below;
use crate::expression::{Expressions, Imported, Node, NodeId};
use crate::polynomial::Polynomial;
use crate::system::{DegenerateSet, System, VariableGroup};
use cognate_numeric::rational::ComplexRational;
use foldhash::HashMapExt;
use std::collections::BTreeMap;

/// A system in fewer unknowns with as many solutions, each with its multiplicity: what linear equations with rational
/// coefficients say of unknowns stands in the place of these, and the equations are left out. It has the equations,
/// denominators and parameters of the given one; symmetry, helper unknowns and units are left out.
///
/// `None` where no equation is linear, where linear equations contradict or repeat each other, and where a group is
/// homogeneous.
pub fn without_linear_unknowns(system: &System) -> Option<System> {
    if system.groups.iter().any(|group| group.homogeneous) || system.path_variable.is_some() {
        return None;
    }
    let (linear, others) = linear_equations(system);
    if linear.is_empty() || others.is_empty() {
        return None;
    }
    let order = unknowns_by_occurrence(system, &others);
    let solved = solved(linear, &order)?;
    Some(substituted(system, &others, &solved))
}

/// A linear form in the unknowns: coefficients by their numbers, and the constant.
#[derive(Clone, Debug, Default)]
struct Linear {
    coefficients: BTreeMap<usize, ComplexRational>,
    constant: ComplexRational,
}

impl Linear {
    /// Takes a multiple of another form away.
    fn reduce(&mut self, factor: &ComplexRational, other: &Self) {
        for (&unknown, c) in &other.coefficients {
            let entry = self.coefficients.entry(unknown).or_default();
            *entry = entry.subtract(&factor.multiply(c));
            if entry.is_zero() {
                self.coefficients.remove(&unknown);
            }
        }
        self.constant = self.constant.subtract(&factor.multiply(&other.constant));
    }
}

/// The equations that are linear with rational coefficients, and the others.
fn linear_equations(system: &System) -> (Vec<Linear>, Vec<NodeId>) {
    let mut linear = Vec::new();
    let mut others = Vec::new();
    let degrees = system.expressions.degree_bounds();
    for &equation in &system.equations {
        // An equation that is written with a higher degree is not worth multiplying out.
        let is_linear = degrees[equation.0 as usize] <= 1;
        match is_linear.then(|| linear_form(system, equation)).flatten() {
            Some(form) => linear.push(form),
            None => others.push(equation),
        }
    }
    (linear, others)
}

fn linear_form(system: &System, equation: NodeId) -> Option<Linear> {
    let (unknowns, parameters) = (system.variable_count(), system.parameters.len());
    let expanded = Polynomial::expand(&system.expressions, equation, unknowns, parameters)?;
    let mut form = Linear::default();
    for (exponents, c) in &expanded.terms {
        match exponents.iter().sum() {
            0u32 => form.constant = c.clone(),
            1 => {
                let place = exponents.iter().position(|e| *e == 1)?;
                if place >= unknowns {
                    return None;
                }
                form.coefficients.insert(place, c.clone());
            }
            _ => return None,
        }
    }
    (!form.coefficients.is_empty()).then_some(form)
}

/// The unknowns, those first that occur in the fewest equations.
fn unknowns_by_occurrence(system: &System, equations: &[NodeId]) -> Vec<usize> {
    let mut occurrences = vec![0usize; system.variable_count()];
    for &equation in equations {
        for id in below(&system.expressions, &[equation]) {
            if let Node::Variable(v) = system.expressions.node(id) {
                occurrences[*v as usize] += 1;
            }
        }
    }
    let mut order: Vec<usize> = (0..occurrences.len()).collect();
    order.sort_by_key(|&unknown| occurrences[unknown]);
    order
}

/// Linear equations solved for as many unknowns: each is minus the form that stands with it, in the unknowns that are left.
fn solved(equations: Vec<Linear>, order: &[usize]) -> Option<BTreeMap<usize, Linear>> {
    let mut solved: BTreeMap<usize, Linear> = BTreeMap::new();
    for mut form in equations {
        for (unknown, other) in &solved {
            if let Some(factor) = form.coefficients.get(unknown).cloned() {
                form.reduce(&factor, other);
            }
        }
        let mut by_occurrence = order.iter();
        let unknown = by_occurrence.find(|unknown| form.coefficients.contains_key(unknown))?;
        let scale = form.coefficients[unknown].clone();
        for c in form.coefficients.values_mut() {
            *c = c.divide(&scale)?;
        }
        form.constant = form.constant.divide(&scale)?;
        for other in solved.values_mut() {
            if let Some(factor) = other.coefficients.get(unknown).cloned() {
                other.reduce(&factor, &form);
            }
        }
        solved.insert(*unknown, form);
    }
    for (unknown, form) in &mut solved {
        form.coefficients.remove(unknown);
    }
    Some(solved)
}

/// The equations with what is said of some unknowns in their place.
fn substituted(system: &System, equations: &[NodeId], solved: &BTreeMap<usize, Linear>) -> System {
    let left: Vec<usize> = (0..system.variable_count())
        .filter(|unknown| !solved.contains_key(unknown))
        .collect();
    let mut out = Expressions::new();
    let mut values: BTreeMap<usize, NodeId> = BTreeMap::new();
    for (place, &unknown) in (0u32..).zip(&left) {
        values.insert(unknown, out.variable(place));
    }
    for (&unknown, form) in solved {
        let mut sum = out.constant(form.constant.clone());
        for (other, c) in &form.coefficients {
            let c = out.constant(c.clone());
            let term = out.multiply(c, values[other]);
            sum = out.add(sum, term);
        }
        let value = out.negate(sum);
        values.insert(unknown, value);
    }
    let mut copies = Imported::new();
    let mut copy = |root: NodeId| {
        out.import(
            &system.expressions,
            root,
            &mut copies,
            &mut |e, leaf| match leaf {
                Node::Variable(v) => values[&(*v as usize)],
                Node::Parameter(p) => e.parameter(*p),
                _ => unreachable!("other nodes are no leaves"),
            },
        )
    };
    let equations: Vec<NodeId> = equations.iter().map(|&root| copy(root)).collect();
    let mut degenerate = system.degenerate.clone();
    for node in degenerate.values_mut().flat_map(DegenerateSet::nodes_mut) {
        *node = copy(*node);
    }
    let names = left
        .iter()
        .map(|&unknown| system.variables[unknown].clone());
    System {
        variables: names.collect(),
        parameters: system.parameters.clone(),
        groups: vec![VariableGroup {
            variables: (0..left.len()).collect(),
            homogeneous: false,
        }],
        equation_names: (1..=equations.len()).map(|k| format!("f{k}")).collect(),
        equations,
        degenerate,
        expressions: out,
        ..System::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::plain;
    use crate::polynomial::{SolutionCount, solution_count};

    fn system(text: &str) -> System {
        plain::typed("-e", text).expect("plain equations").system
    }

    fn count(system: &System) -> SolutionCount {
        let counted = solution_count(system, &[], 100_000_000);
        counted.expect("few solutions").count
    }

    #[test]
    fn as_many_solutions_in_fewer_unknowns() {
        for (text, unknowns) in [
            ("x^2 + y^2 = 5\nx + y - z = 0\nz*x = 1", 2),
            // A line that touches a circle: one double point.
            ("x^2 + y^2 = 1\nx = 1 + u\nu = 0", 1),
            (
                "2*a + 3*b = c\na - b = 1/3\na*b*c = 1\nd^2 = a\nd + e = 7",
                2,
            ),
            // The conic holds a whole line.
            ("x = y\nx*z = y*z\nz^2 = x", 2),
            ("1/(x - y) = x\nx + y = 3\nz = x\nw^2 = z*x", 2),
        ] {
            let given = system(text);
            let fewer = without_linear_unknowns(&given).expect("a linear equation");
            assert_eq!(fewer.variable_count(), unknowns, "{text}");
            assert_eq!(count(&fewer), count(&given), "{text}");
        }
    }

    #[test]
    fn other_systems_stay() {
        for text in [
            "x^2 = 2\ny^2 = x",
            "x + y = 1\nx - y = 2",
            "x + y = 1\nx + y = 2\nx*y*z = 1",
            "x + y = 1\n2*x + 2*y = 2\nx*y = 1",
            "unknowns: x, y\nparameters: p\np*x + y = 1\nx^2 = y^3",
        ] {
            assert!(without_linear_unknowns(&system(text)).is_none(), "{text}");
        }
    }

    /// Twenty unknowns, of which eighteen are sums of others: too many to be counted as they stand.
    #[test]
    fn many_unknowns_are_counted() {
        let mut text = "x1^2 + x2^2 = 5\nx1*x20 = 1\n".to_owned();
        for k in 3..=20 {
            text += &format!("x{k} = x{} + 2*x{} - {k}\n", k - 1, k - 2);
        }
        let four = SolutionCount::Finite {
            with_multiplicity: 4,
            distinct: Some(4),
        };
        assert_eq!(count(&system(&text)), four);
    }
}
