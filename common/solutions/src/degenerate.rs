//! Whether a solution lies in a named set of endpoints that are no answers.
//!
//! An expression counts as 0 where its value is within the error that the
//! solution's own error can make in it: each value is computed together with a
//! bound on its error, when every variable may be off as far as its group's
//! largest (running error analysis; Higham, Accuracy and Stability, section 3.3).

use crate::classification::{Decision, Tolerances, Verdict, error_bound};
use crate::field::{Field, ManyBits, evaluate, extract, of_node};
use crate::point_shape::{PointShape, largest};
use cognate_continuation::path_result::PathResult;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::{Function, Node, NodeId};
use cognate_systems::scaling::{Scaling, times_power_of_two};
use cognate_systems::system::{DegenerateSet, System, VariableGroup};
use cognate_systems::transform::clear_denominators::ZERO_DENOMINATOR;
use num_complex::Complex64;
use rug::Complex;
use serde::{Deserialize, Serialize};

/// Values with a bound on the error beside each.
pub(crate) struct Bounded(pub(crate) ManyBits);

type Value = (Complex, f64);

/// |z| as a double, without libm.
fn size(z: &Complex) -> f64 {
    let (re, im) = (z.real().to_f64(), z.imag().to_f64());
    (re * re + im * im).sqrt()
}

/// Whether 0 is within the error.
fn vanishes((value, error): &Value) -> bool {
    error.is_finite() && size(value) <= *error
}

impl Bounded {
    /// A number that is exactly known.
    fn known(value: Complex) -> Value {
        (value, 0.0)
    }

    fn double(&self, z: Complex64) -> Complex {
        Complex::with_val(self.0.0, (z.re, z.im))
    }

    /// Each may be off as far as its group's largest, in the units of the unknowns that are tracked.
    fn variables(
        &self,
        groups: &[VariableGroup],
        scaling: &Scaling,
        values: &[Complex64],
        accuracy: f64,
        tolerances: &Tolerances,
    ) -> Vec<Value> {
        let error = error_bound(
            accuracy,
            tolerances.degenerate_factor,
            tolerances.degenerate_floor,
        );
        let coordinates = values.iter().map(|&z| Self::known(self.double(z)));
        let mut variables: Vec<Value> = coordinates.collect();
        for group in groups {
            let members = group.variables.iter();
            let members: Vec<Complex64> =
                members.map(|&v| scaling.to_unknown(v, values[v])).collect();
            // The homogenising coordinate of an affine group is 1 here.
            let scale = largest(&members).max(if group.homogeneous { 0.0 } else { 1.0 });
            for &v in &group.variables {
                variables[v].1 = times_power_of_two(error * scale, scaling.exponent(v));
            }
        }
        variables
    }

    pub(crate) fn parameters(&self, values: &[Complex64]) -> Vec<Value> {
        let to_value = |&p: &Complex64| Self::known(self.double(p));
        values.iter().map(to_value).collect()
    }
}

impl Field for Bounded {
    type Value = Value;

    fn constant(&self, value: &ComplexRational) -> Option<Value> {
        self.0.constant(value).map(Self::known)
    }
    fn add(&self, a: &Value, b: &Value) -> Value {
        (self.0.add(&a.0, &b.0), a.1 + b.1)
    }
    fn negate(&self, a: &Value) -> Value {
        (self.0.negate(&a.0), a.1)
    }
    fn multiply(&self, a: &Value, b: &Value) -> Value {
        let error = size(&a.0) * b.1 + a.1 * (size(&b.0) + b.1);
        (self.0.multiply(&a.0, &b.0), error)
    }
    fn divide(&self, a: &Value, b: &Value) -> Option<Value> {
        let quotient = self.0.divide(&a.0, &b.0)?;
        // Only radicands have denominators with variables.
        let least = (size(&b.0) - b.1).max(0.0);
        let error = (a.1 + size(&quotient) * b.1) / least;
        Some((quotient, error))
    }
    fn root(&self, a: &Value, exponent: &Rational) -> Option<Value> {
        self.0.root(&a.0, exponent).map(Self::known)
    }
    fn function(&self, function: Function, a: &Value) -> Option<Value> {
        self.0.function(function, &a.0).map(Self::known)
    }
}

/// The question for one set; sets are asked one solution at a time.
pub fn lies_in(
    set: &DegenerateSet,
    system: &System,
    parameters: &[Complex64],
    values: &[Complex64],
    accuracy: f64,
    tolerances: &Tolerances,
) -> bool {
    let roots = set.nodes();
    let field = Bounded(ManyBits(128));
    let groups = &system.groups;
    let variables = field.variables(groups, &system.scaling, values, accuracy, tolerances);
    let parameters = field.parameters(parameters);
    let residuals = evaluate(&field, &system.expressions, roots, &variables, &parameters);
    residuals.is_some_and(|values| values.iter().all(vanishes))
}

/// The named sets that are given by equations, apart from their system: where an endpoint lies on
/// one, it is known what kind of end it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DeclaredSets {
    /// The expressions of all sets, and no other.
    nodes: Vec<Node>,
    /// Names, and what vanishes.
    sets: Vec<(String, Vec<NodeId>)>,
    groups: Vec<VariableGroup>,
    scaling: Scaling,
}

/// Number of endpoints of each declared set for which it is tested whether they are isolated; the result holds for the
/// other endpoints of the set.
pub const ASKED: usize = 5;

impl DeclaredSets {
    /// The sets that a checked system declares.
    pub fn of(system: &System) -> Self {
        let of_equations = |(name, set): (&String, &DegenerateSet)| match set {
            DegenerateSet::Equations(roots) => Some((name.clone(), roots.clone())),
            DegenerateSet::Nonzero(_) => None,
        };
        let mut sets: Vec<_> = system.degenerate.iter().filter_map(of_equations).collect();
        let equations: Vec<NodeId> = sets.iter().flat_map(|(_, roots)| roots.clone()).collect();
        let (nodes, roots) = extract(&system.expressions, &equations);
        let places = sets.iter_mut().flat_map(|(_, of_set)| of_set);
        places.zip(roots).for_each(|(old, new)| *old = new);
        Self {
            nodes,
            sets,
            groups: system.groups.clone(),
            scaling: system.scaling.clone(),
        }
    }

    /// The names of the sets, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.sets.iter().map(|(name, _)| name.as_str())
    }

    /// Finds the sets that an endpoint with these values of the variables lies in.
    fn holding(
        &self,
        parameters: &[Complex64],
        values: &[Complex64],
        accuracy: f64,
        tolerances: &Tolerances,
    ) -> Vec<bool> {
        let field = Bounded(ManyBits(128));
        let variables = field.variables(&self.groups, &self.scaling, values, accuracy, tolerances);
        let parameters = field.parameters(parameters);
        let mut node_values: Vec<Option<Value>> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let value = of_node(&field, node, &node_values, &variables, &parameters);
            node_values.push(value);
        }
        let zero = |root: &NodeId| node_values[root.0 as usize].as_ref().is_some_and(vanishes);
        let sets = self.sets.iter();
        sets.map(|(_, roots)| roots.iter().all(zero)).collect()
    }

    /// The singular finite endpoints in each set, by their places among the results; one that lies
    /// in several counts in the first. `parameters`: those of the system at the endpoints.
    pub fn members(
        &self,
        parameters: &[Complex64],
        results: &[PathResult],
        decisions: &[Decision],
        shape: &PointShape,
        tolerances: &Tolerances,
    ) -> Vec<Vec<usize>> {
        let mut members = vec![Vec::new(); self.sets.len()];
        if self.sets.is_empty() {
            return members;
        }
        for (place, (result, decision)) in results.iter().zip(decisions).enumerate() {
            if !matches!(
                decision.verdict,
                Verdict::Singular | Verdict::Undecided | Verdict::PositiveDimensional
            ) {
                continue;
            }
            let values = shape.to_variables(result.endpoint.to_double());
            let holding = self.holding(parameters, &values, result.accuracy, tolerances);
            if let Some(set) = holding.iter().position(|&inside| inside) {
                members[set].push(place);
            }
        }
        members
    }
}

/// Counts how many of some solutions, given with their errors, lie in each named set that answers may hold points of.
pub fn count(
    system: &System,
    parameters: &[Complex64],
    shape: &PointShape,
    solutions: &[(&[Complex64], f64)],
    tolerances: &Tolerances,
) -> std::collections::BTreeMap<String, u64> {
    system
        .degenerate
        .iter()
        .filter(|(name, _)| *name != ZERO_DENOMINATOR)
        .map(|(name, set)| {
            let inside = solutions.iter().filter(|(point, accuracy)| {
                let values = shape.to_variables(point);
                lies_in(set, system, parameters, &values, *accuracy, tolerances)
            });
            (name.clone(), inside.count() as u64)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::system::VariableGroup;

    /// x^2 + y^2 must not vanish.
    fn norm(homogeneous: bool) -> System {
        let mut system = System {
            variables: vec!["x".into(), "y".into(), "z".into()],
            groups: vec![VariableGroup {
                variables: vec![0, 1, 2],
                homogeneous,
            }],
            ..System::default()
        };
        let e = &mut system.expressions;
        let (x, y) = (e.variable(0), e.variable(1));
        let (a, b) = (e.power(x, 2), e.power(y, 2));
        let sum = e.add(a, b);
        system
            .degenerate
            .insert("no pose".into(), DegenerateSet::Nonzero(sum));
        system
    }

    fn inside(system: &System, point: [(f64, f64); 3], accuracy: f64) -> bool {
        let values = point.map(|(re, im)| Complex64::new(re, im));
        let set = &system.degenerate["no pose"];
        lies_in(set, system, &[], &values, accuracy, &Tolerances::default())
    }

    #[test]
    fn small_variables_and_cancellation_are_both_seen() {
        let system = norm(true);
        assert!(inside(
            &system,
            [(1e-14, 0.0), (0.0, 2e-14), (1.0, 0.0)],
            1e-14
        ));
        assert!(inside(
            &system,
            [(0.6, 0.0), (1e-15, 0.6), (1.0, 0.0)],
            1e-15
        ));
        assert!(!inside(
            &system,
            [(1e-3, 0.0), (1e-4, 0.0), (1.0, 0.0)],
            1e-15
        ));
        assert!(!inside(
            &system,
            [(0.6, 0.0), (0.6, 0.0), (1.0, 0.0)],
            f64::INFINITY
        ));
    }

    #[test]
    fn large_solutions_are_not_taken_for_degenerate() {
        let system = norm(false);
        assert!(!inside(
            &system,
            [(1e6, 0.0), (2e6, 0.0), (1.0, 0.0)],
            1e-14
        ));
        assert!(inside(&system, [(1e6, 0.0), (0.0, 1e6), (1.0, 0.0)], 1e-14));
        // Beside a variable that is far larger, too: here x^2 + y^2 = 5e-8, known to 1e-9 or so.
        assert!(!inside(
            &system,
            [(1e-4, 0.0), (2e-4, 0.0), (1e4, 0.0)],
            1e-14
        ));
    }
}
