//! Digits of singular solutions: a solution with rational coordinates is given as these, rounded; any other is known no
//! better than the endpoints of its paths agree.

use crate::classification::Tolerances;
use crate::path_crossing::singular_radius;
use crate::solution::Solution;
use cognate_numeric::rational::ComplexRational;
use cognate_numeric::scalar::Complex;
use cognate_systems::exact_point::exact_point;
use cognate_systems::system::System;
use num_complex::Complex64;

/// Replaces the coordinates of a singular solution by the rational solution of the equations within the radius in which
/// endpoints count as one point, where there is one; its error is that of rounding.
pub(super) fn write_exact(
    solution: &mut Solution,
    system: &System,
    parameters: &[Complex64],
    tolerances: &Tolerances,
) {
    let radius = singular_radius(solution.accuracy, solution.precision_bits, tolerances);
    let values: Vec<Complex64> = solution.variables.values().collect();
    let parameters = parameters.iter().map(|z| ComplexRational::from_doubles(*z));
    let Some(parameters) = parameters.collect::<Option<Vec<_>>>() else {
        return;
    };
    let Some(exact) = exact_point(system, &parameters, &values, radius) else {
        return;
    };
    for (variable, exact) in solution.variables.0.iter_mut().zip(&exact) {
        let rounded = Complex::<f64>::from_rational((), exact);
        variable.value = Complex64::new(rounded.re, rounded.im);
    }
    solution.accuracy = f64::EPSILON;
}
