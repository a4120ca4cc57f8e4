//! Degrees of equations that have some, also where the work is interrupted.

use cognate_systems::polynomial::{Degrees, PolynomialError, degrees, degrees_by_form};
use cognate_systems::system::System;

/// The degrees of equations that are polynomials and do not vanish. Where the work is interrupted, and its answer of no
/// use, the bounds that the form of the expressions gives.
///
/// # Errors
/// As [`degrees`], except for an interruption.
pub(crate) fn degrees_or_bounds(system: &System) -> Result<Degrees, PolynomialError> {
    match degrees(system) {
        Err(PolynomialError::Interrupted(_)) => {}
        measured => return measured,
    }
    let bound = |equation, variables: &[usize]| {
        degrees_by_form(&system.expressions, equation, variables)[&equation]
    };
    let variables_of_system: Vec<usize> = (0..system.variable_count()).collect();
    let bounds = system.equations.iter().map(|&equation| {
        let groups = system.groups.iter();
        let by_group = groups.map(|group| bound(equation, &group.variables));
        (by_group.collect(), bound(equation, &variables_of_system))
    });
    let (by_group, total) = bounds.unzip();
    Ok(Degrees { by_group, total })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::declared;
    use cognate_numeric::interruption::Interruption;

    #[test]
    fn interrupted_degrees_are_bounds() {
        let system = declared(
            "variable_group x; variable_group y; function f, g; f = ((x + 1)^5 - x^5)*y^3; g = x - y;",
        );
        let sign = Interruption::default();
        sign.interrupt();
        let (measured, bounds) = sign.run(|| (degrees(&system), degrees_or_bounds(&system)));
        assert!(matches!(measured, Err(PolynomialError::Interrupted(_))));
        let bounds = bounds.expect("bounds are at hand");
        assert_eq!(bounds.by_group, [[5, 3], [1, 1]]);
        assert_eq!(bounds.total, [8, 1]);
        let measured = degrees_or_bounds(&system).expect("polynomials");
        assert_eq!(measured.total, [7, 1]);
    }
}
