//! Decisions by the sizes of a system's coefficients before it is solved: the units in which it is tracked, and how far
//! out its solutions may lie.

use cognate_continuation::tracker::settings::Settings;
use cognate_systems::expression::Node;
use cognate_systems::polynomial::is_chosen;
use cognate_systems::system::System;
use cognate_systems::units::{Fit, fit};
use num_complex::Complex64;
use std::borrow::Cow;

/// Ratio of the coefficients of one equation, in powers of two, from which on its solutions may lie further out than
/// those of ordinary systems, if the coefficients are chosen. Of 238 published systems eight have larger ratios, 2^30
/// the largest.
const WIDE_RANGE: f64 = 20.0;
/// Ratio of the coefficients, in powers of two, from which on solutions may lie far out, if the coefficients may be
/// rounded.
const WIDE_RANGE_OF_ROUNDED: f64 = 40.0;
/// Ranges are told apart up to here: a double holds its inverse.
const WIDEST_RANGE: f64 = 900.0;

/// Sizes of the coefficients at the values of the parameters where the paths begin and end.
pub(crate) struct Coefficients {
    fit: Fit,
    /// Whether they are integers and fractions that somebody chose.
    chosen: bool,
}

impl Coefficients {
    /// A family's at these parameters, of its start and of its first target; a homotopy's own at both its ends.
    pub fn of<'a>(system: &System, ends: impl Iterator<Item = &'a Vec<Complex64>>) -> Self {
        let mut parameters: Vec<Vec<Complex64>> = ends.cloned().collect();
        parameters.retain(|set| set.len() == system.parameters.len());
        if let Some(t) = system.path_variable {
            let given = parameters.pop();
            let given =
                given.unwrap_or_else(|| vec![Complex64::default(); system.parameters.len()]);
            parameters = [1.0, 0.0]
                .map(|at| {
                    let mut set = given.clone();
                    set[t] = Complex64::new(at, 0.0);
                    set
                })
                .into();
        }
        Self {
            fit: fit(system, &parameters),
            chosen: system.parameters.is_empty()
                && system.expressions.nodes().iter().all(is_no_rounded_number),
        }
    }

    /// The system with the units in which it is tracked.
    pub fn in_units<'a>(&self, system: &'a System) -> Cow<'a, System> {
        match self.fit.scaling == system.scaling {
            true => Cow::Borrowed(system),
            false => Cow::Owned(System {
                scaling: self.fit.scaling.clone(),
                ..system.clone()
            }),
        }
    }

    /// Other settings, where coefficients are exact. Where they differ by many orders of magnitude, too, with the least
    /// detail that they have in the system's units: solutions so far out are found, or doubted, that count as infinite
    /// otherwise.
    pub fn resolved(&self, settings: &Settings) -> Option<Settings> {
        let range = self.fit.coefficient_range.min(WIDEST_RANGE);
        let exact = settings.data_accuracy == 0.0;
        let chosen = self.chosen || settings.exact_data;
        let wide = match chosen {
            true => range > WIDE_RANGE,
            false => range > WIDE_RANGE_OF_ROUNDED,
        };
        let data_accuracy = match wide {
            true => f64::from_bits((1023 - range as u64) << 52),
            false => 0.0,
        };
        (exact && (chosen || wide)).then(|| Settings {
            exact_data: true,
            data_accuracy,
            ..settings.clone()
        })
    }
}

/// Whether a node is no number that was rounded.
fn is_no_rounded_number(node: &Node) -> bool {
    match node {
        Node::Constant(number) => is_chosen(number),
        _ => true,
    }
}
