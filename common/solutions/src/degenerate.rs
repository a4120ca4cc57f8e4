//! Whether a solution lies in a named set of endpoints that are no answers.
//!
//! An expression counts as 0 where its value is within the error that the
//! solution's own error can make in it: each value is computed together with a
//! bound on its error, when every variable may be off as far as its group's
//! largest (running error analysis; Higham, Accuracy and Stability, section 3.3).

use crate::classification::{Tolerances, error_bound};
use crate::field::{Field, ManyBits, evaluate};
use crate::point_shape::{PointShape, largest};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::{Function, NodeId};
use cognate_systems::system::{DegenerateSet, System};
use num_complex::Complex64;
use rug::Complex;

/// Values with a bound on the error beside each.
struct Bounded(ManyBits);

type Value = (Complex, f64);

/// |z| as a double, without libm.
fn size(z: &Complex) -> f64 {
    let (re, im) = (z.real().to_f64(), z.imag().to_f64());
    (re * re + im * im).sqrt()
}

impl Bounded {
    /// A number that is exactly known.
    fn known(value: Complex) -> Value {
        (value, 0.0)
    }

    fn double(&self, z: Complex64) -> Complex {
        Complex::with_val(self.0.0, (z.re, z.im))
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
        // Denominators contain no variable.
        Some((self.0.divide(&a.0, &b.0)?, a.1 / size(&b.0)))
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
    let roots: &[NodeId] = match set {
        DegenerateSet::Nonzero(node) => std::slice::from_ref(node),
        DegenerateSet::Equations(nodes) => nodes,
    };
    let field = Bounded(ManyBits(128));
    let error = error_bound(
        accuracy,
        tolerances.degenerate_factor,
        tolerances.degenerate_floor,
    );
    let mut variables: Vec<Value> = values
        .iter()
        .map(|&z| Bounded::known(field.double(z)))
        .collect();
    for group in &system.groups {
        let members: Vec<Complex64> = group.variables.iter().map(|&v| values[v]).collect();
        // The homogenising coordinate of an affine group is 1 here.
        let scale = largest(&members).max(if group.homogeneous { 0.0 } else { 1.0 });
        for &v in &group.variables {
            variables[v].1 = error * scale;
        }
    }
    let parameters: Vec<Value> = parameters
        .iter()
        .map(|&p| Bounded::known(field.double(p)))
        .collect();
    let Some(results) = evaluate(&field, &system.expressions, roots, &variables, &parameters)
    else {
        return false;
    };
    results
        .iter()
        .all(|(value, error)| error.is_finite() && size(value) <= *error)
}

/// How many of some solutions, given with their errors, lie in each named set.
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
