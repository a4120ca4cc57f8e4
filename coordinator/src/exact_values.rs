//! Exact values: parameters with short values become numbers in the equations, so that 1/3 and 0.1 are what they say and
//! not the doubles beside them.

use cognate_numeric::rational::ComplexRational;
use cognate_protocol::submission::{Options, StartKind};
use cognate_systems::expression::Node;
use cognate_systems::polynomial::has_exact_constants;
use cognate_systems::system::System;
use cognate_systems::transform::fix_parameters;

/// Puts the values of the only target into the equations, where each stands for a short number and no solutions are
/// given at other values. Equations that become numbers keep their parameters: what these mean, the solve says.
pub(crate) fn put_into(system: &mut System, options: &mut Options) {
    let Some(fixed) = with_values(system, options) else {
        return;
    };
    *system = fixed;
    options.target_parameters.clear();
    let accuracy = options.settings.data_accuracy.unwrap_or_default();
    if accuracy == 0.0 && has_exact_constants(&system.expressions) {
        options.settings.exact_data = Some(true);
    }
}

fn with_values(system: &System, options: &Options) -> Option<System> {
    let [values] = &options.target_parameters[..] else {
        return None;
    };
    let begins_at_others = match options.start {
        StartKind::Given | StartKind::Monodromy => true,
        StartKind::Auto
        | StartKind::TotalDegree
        | StartKind::Multihomogeneous
        | StartKind::LinearProduct
        | StartKind::Polyhedral
        | StartKind::Regeneration => !options.start_parameters.is_empty(),
    };
    let known_components = |options: &Options| {
        let decompose = options.decompose.as_ref();
        decompose.is_some_and(|decompose| decompose.known.is_some())
    };
    if values.is_empty()
        || begins_at_others
        || known_components(options)
        || options.question.is_some()
        || system.path_variable.is_some()
    {
        return None;
    }
    let numbers: Option<Vec<ComplexRational>> = values
        .iter()
        .map(|z| ComplexRational::from_short(*z))
        .collect();
    let fixed = fix_parameters(system, &numbers?).ok()?;
    let is_number = |equation| matches!(fixed.expressions.node(equation), Node::Constant(_));
    let has_unknowns = !fixed.equations.iter().any(|&equation| is_number(equation));
    (has_unknowns && fixed.check().is_ok()).then_some(fixed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::evaluation::values;
    use cognate_systems::formats::plain::typed;
    use num_complex::Complex64;

    fn after(numbers: &[f64], start: StartKind) -> (System, Options) {
        let text = "parameters: p, q\nx^2 - p*x + q = 0";
        let mut system = typed("-e", text).expect("it can be read").system;
        let real = |value: &f64| Complex64::new(*value, 0.0);
        let mut options = Options {
            start,
            target_parameters: vec![numbers.iter().map(real).collect()],
            ..Options::default()
        };
        put_into(&mut system, &mut options);
        (system, options)
    }

    #[test]
    fn short_values_become_numbers() {
        let (system, options) = after(&[0.1, 1.0 / 3.0], StartKind::Auto);
        assert!(system.parameters.is_empty() && options.target_parameters.is_empty());
        assert_eq!(options.settings.exact_data, Some(true));
        let two = Complex64::new(2.0, 0.0);
        let [value] = values(&system.expressions, &system.equations, &[two], &[])[..] else {
            panic!("one equation");
        };
        assert!((value - (4.0 - 0.2 + 1.0 / 3.0)).norm_sqr() < 1e-30);
        assert!(has_exact_constants(&system.expressions));
    }

    #[test]
    fn other_values_stay() {
        for (numbers, start) in [
            ([0.1, 2.0f64.sqrt()], StartKind::Auto),
            ([0.1, 0.2], StartKind::Given),
            ([0.1, 0.2], StartKind::Monodromy),
        ] {
            let (system, options) = after(&numbers, start);
            assert_eq!(system.parameters.len(), 2);
            assert_eq!(options.target_parameters.len(), 1);
            assert_eq!(options.settings.exact_data, None);
        }
    }
}
