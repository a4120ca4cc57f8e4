//! Removal: components on which a denominator of the given equations is 0 everywhere are none of theirs.
//!
//! A component is a closure: where it only meets the zeros of a denominator it stays. Its witness points are general
//! points of it, and so a denominator that is 0 at them is 0 everywhere on it.

use cognate_numeric::rational::ComplexRational;
use cognate_solutions::classification::Tolerances;
use cognate_solutions::denominators::{AskedPoint, Denominator, Denominators};
use cognate_solutions::witness::{Decomposition, Doubt, RemovedComponent, WitnessSet};
use cognate_systems::expression::NodeId;
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::ZERO_DENOMINATOR;
use num_complex::Complex64;

/// Most witness points of a component that are brought to more digits where a denominator is near 0.
const MOST_SHARPENED: usize = 3;
/// Error of a witness point, relative to its largest coordinate, beside which its condition number counts.
const LEAST_ERROR: f64 = 1e-13;

/// Takes away the components of a system without parameters on which a denominator is 0, and notes where that is in
/// doubt.
pub(crate) fn remove_zero_denominators(
    decomposition: &mut Decomposition,
    system: &System,
    seed: u64,
) {
    let tolerances = Tolerances::default();
    let Some(denominators) = Denominators::of(system, &[], &tolerances, seed) else {
        return;
    };
    let asking = Asking {
        system,
        tolerances: &tolerances,
        denominators,
        seed,
    };
    let components = std::mem::take(&mut decomposition.components);
    for mut set in components {
        match asking.of_component(&set) {
            Denominator::Nonzero => {}
            Denominator::Zero => {
                let paths = set.degree * set.multiplicity.tracked;
                let mut dimensions = decomposition.dimensions.iter_mut();
                if let Some(d) = dimensions.find(|d| d.number == set.dimension()) {
                    d.removed += paths;
                }
                decomposition.removed.push(RemovedComponent {
                    reason: ZERO_DENOMINATOR.into(),
                    dimension: set.dimension(),
                    degree: set.degree,
                });
                continue;
            }
            Denominator::Doubtful => {
                let points = set.points.len() as u64;
                set.evidence.doubts.push(Doubt::Denominator { points });
            }
        }
        decomposition.components.push(set);
    }
    let largest_first = |c: &RemovedComponent| std::cmp::Reverse((c.dimension, c.degree));
    decomposition.removed.sort_by_key(largest_first);
}

struct Asking<'a> {
    system: &'a System,
    tolerances: &'a Tolerances,
    denominators: Denominators<'a>,
    seed: u64,
}

impl Asking<'_> {
    /// Whether a denominator is 0 at all witness points of a set, or at none; else that is in doubt.
    fn of_component(&self, set: &WitnessSet) -> Denominator {
        let asked = |values, isolated| AskedPoint {
            values,
            accuracy: (set.evidence.worst_condition * f64::EPSILON).clamp(LEAST_ERROR, 1e-4),
            singular: !set.deflation.is_empty(),
            isolated,
        };
        // On the slice a witness point is an isolated solution.
        let mut sliced = None;
        let mut digits = MOST_SHARPENED;
        let mut decisions = Vec::with_capacity(set.points.len());
        for values in &set.points {
            let decision = match self.denominators.at(asked(values, false)) {
                Denominator::Nonzero => Denominator::Nonzero,
                by_doubles if digits == 0 => by_doubles,
                by_doubles => {
                    digits -= 1;
                    let sliced = sliced.get_or_insert_with(|| with_slice(self.system, set));
                    let sliced_denominators = sliced.as_ref().and_then(|sliced| {
                        Denominators::of(sliced, &[], self.tolerances, self.seed)
                    });
                    sliced_denominators.map_or(by_doubles, |sliced_denominators| {
                        sliced_denominators.at(asked(values, true))
                    })
                }
            };
            decisions.push(decision);
        }
        let first = decisions.first().copied().unwrap_or(Denominator::Nonzero);
        match decisions.iter().all(|&decision| decision == first) {
            true => first,
            false => Denominator::Doubtful,
        }
    }
}

/// The equations and the slice of a set; `None` where a group is homogeneous, in which points are scaled.
fn with_slice(system: &System, set: &WitnessSet) -> Option<System> {
    if system.groups.iter().any(|group| group.homogeneous) {
        return None;
    }
    let mut sliced = system.clone();
    for row in set.slice.iter() {
        let sum = linear_form(&mut sliced, row)?;
        sliced.equations.push(sum);
    }
    Some(sliced)
}

/// c_0 + c_1 x_1 + ...
fn linear_form(system: &mut System, row: &[Complex64]) -> Option<NodeId> {
    let e = &mut system.expressions;
    let (first, coefficients) = row.split_first()?;
    let constant = ComplexRational::from_doubles(*first)?;
    let mut sum = e.constant(constant);
    for (v, c) in (0u32..).zip(coefficients) {
        let c = ComplexRational::from_doubles(*c)?;
        let (c, x) = (e.constant(c), e.variable(v));
        let term = e.multiply(c, x);
        sum = e.add(sum, term);
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::super::{DecompositionOptions, DecompositionSolve, run_locally};
    use cognate_solutions::witness::Method;

    /// Dimension and degree of each component.
    type Listed = Vec<(u32, u64)>;

    /// Dimension and degree of the components, and of the removed components.
    fn decomposed(equations: &str, method: Option<Method>) -> (Listed, Listed) {
        let text =
            format!("{{\"variables\": [\"x\", \"y\", \"z\"], \"equations\": [{equations}]}}");
        let read = cognate_systems::formats::read("test", text.as_bytes());
        let system = read.expect("a problem of this test").system;
        let options = DecompositionOptions {
            method,
            ..DecompositionOptions::default()
        };
        let solve = DecompositionSolve::new(&system, &options).unwrap();
        let decomposition = run_locally(solve, 8).unwrap();
        assert!(
            decomposition.settled() && decomposition.adds_up(),
            "{equations}: {decomposition:?}"
        );
        let components = decomposition.components.iter();
        let removed = decomposition
            .removed
            .iter()
            .map(|c| (c.dimension, c.degree));
        (
            components
                .map(|set| (set.dimension(), set.degree))
                .collect(),
            removed.collect(),
        )
    }

    #[test]
    fn components_on_the_zeros_of_a_denominator_are_removed() {
        for method in [None, Some(Method::Cascade), Some(Method::Slices)] {
            // The plane x = y doubly, the sphere, which meets it, and the point on x = 3.
            let surface = "\"(x - y)^2*(x^2 + y^2 + z^2 - 1)/(x - y)\"";
            assert_eq!(decomposed(surface, method), (vec![(2, 2)], vec![(2, 1)]));
            // The line x = y = z, and x = y = 1, where the denominator y - 1 is 0.
            let lines = "\"x/y - 1\", \"(z - x)*(x - 1)/(y - 1)\"";
            assert_eq!(decomposed(lines, method), (vec![(1, 1)], vec![(1, 1)]));
            let points = "\"1/x - 1/y - 1\", \"x - y\", \"z - 1\"";
            assert_eq!(decomposed(points, method), (vec![], vec![(0, 1)]));
        }
    }
}
