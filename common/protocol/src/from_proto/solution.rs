//! Solution message to Solution, for clients that go on computing with it.

use super::finite;
use crate::error::{ProtocolError, within_limit};
use crate::v1;
use cognate_solutions::solution::{NamedValue, NamedValues, Solution};
use cognate_systems::formats::limits as sizes;
use num_complex::Complex64;

/// One solution.
pub fn solution(m: &v1::Solution) -> Result<Solution, ProtocolError> {
    within_limit("variables", m.variables.len(), sizes::VARIABLES)?;
    let values: Vec<Complex64> = m
        .variables
        .iter()
        .map(|v| Complex64::new(v.re, v.im))
        .collect();
    finite("variables", &values)?;
    if m.multiplicity == 0 {
        return Err(ProtocolError::invalid("multiplicity", 0, "at least 1"));
    }
    for (field, value) in [
        ("residual", m.residual),
        ("condition", m.condition),
        ("accuracy", m.accuracy),
    ] {
        if value.is_nan() {
            return Err(ProtocolError::invalid(field, value, "a number"));
        }
    }
    let named = |(v, value): (&v1::VariableValue, Complex64)| NamedValue {
        name: v.name.clone(),
        value,
        digits: v.re_digits.clone().zip(v.im_digits.clone()).map(Into::into),
    };
    Ok(Solution {
        variables: NamedValues(m.variables.iter().zip(values).map(named).collect()),
        multiplicity: m.multiplicity,
        cycles: m.cycles.clone(),
        real: m.real,
        singular: m.singular,
        residual: m.residual,
        condition: m.condition,
        accuracy: m.accuracy,
        precision_bits: m.precision_bits,
        class: m.class,
        paths: m.paths.clone(),
        certificate: m
            .certificate
            .as_deref()
            .map(serde_json::from_str)
            .transpose()
            .map_err(|e| ProtocolError::invalid("certificate", e, "a certificate as JSON"))?,
        deflations: m.deflations,
        undecided: m.undecided,
    })
}
