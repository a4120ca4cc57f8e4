//! MovedParameters: the equations at the end of paths, with values of parameters that differ by as much as rounding to
//! doubles can make them differ.
//!
//! Values of parameters are doubles, so a coefficient such as 10 p - 1 is 5.6e-17 instead of 0 at p = 0.1. What such a
//! change makes of a solution tells whether its place is known.

use crate::chart::Chart;
use crate::homotopies::prepare::StartSystem;
use crate::homotopies::{Homotopy, HomotopyKind};
use crate::tracker::settings::ROUNDED_TO_DOUBLES;
use crate::work::Stage;
use cognate_systems::evaluation::Interpreter;
use cognate_systems::polynomial::{Degrees, has_exact_constants};
use cognate_systems::system::System;
use std::borrow::Cow;
use std::sync::OnceLock;

/// The equations of a stage whose constants are exact and whose parameters have values that are doubles.
#[derive(Debug)]
pub(crate) struct MovedParameters {
    /// The homotopy with moved values, where these are compiled into it.
    fixed_values: Option<FixedValues>,
}

/// System, kind and charts from which a homotopy with numbers in place of parameters is made.
#[derive(Debug)]
struct FixedValues {
    system: System,
    degrees: Degrees,
    /// The kind of the stage with moved values.
    kind: HomotopyKind,
    start_system: Option<StartSystem>,
    first_chart: Chart,
    chart: Chart,
    seed: u64,
    compiled: OnceLock<Homotopy>,
}

/// Equations with moved values of parameters: those of the homotopy at the end of paths to this target.
pub(crate) struct MovedEnd<'a> {
    pub homotopy: Cow<'a, Homotopy>,
    pub target: u64,
}

impl MovedParameters {
    /// Prepares the equations of a stage; nothing is compiled. `None` where no parameter has a value, where constants
    /// of `asked` may be rounded, where the settings say that numbers are less accurate than doubles or exact, and where paths end at another
    /// system. `asked`: the system of the stage; `tracked`: combinations of its equations, or itself.
    pub(crate) fn new(
        asked: &System,
        tracked: &System,
        degrees: &Degrees,
        start_system: Option<&StartSystem>,
        first_chart: &Chart,
        stage: &Stage,
    ) -> Option<Self> {
        let settings = &stage.settings;
        let accuracy_is_given = settings.exact_data || settings.data_accuracy > ROUNDED_TO_DOUBLES;
        let has_values = !asked.parameters.is_empty() && stage.homotopy.ends_at_the_system();
        let is_exact = || has_exact_constants(&asked.expressions);
        if accuracy_is_given || !has_values || !is_exact() {
            return None;
        }
        let kind = stage.homotopy.with_moved_values();
        let fixed_values = kind.map(|kind| FixedValues {
            system: tracked.clone(),
            degrees: degrees.clone(),
            kind,
            start_system: start_system.cloned(),
            first_chart: first_chart.clone(),
            chart: Chart::new(tracked, stage.seed, stage.attempt),
            seed: stage.seed,
            compiled: OnceLock::new(),
        });
        Some(Self { fixed_values })
    }

    /// The equations at the end of paths of this homotopy to this target.
    pub(crate) fn at_end<'a>(&'a self, homotopy: &Homotopy, target: u64) -> MovedEnd<'a> {
        match &self.fixed_values {
            Some(fixed) => MovedEnd {
                homotopy: Cow::Borrowed(fixed.homotopy()),
                target,
            },
            None => MovedEnd {
                homotopy: Cow::Owned(homotopy.with_moved_target(target)),
                target: 0,
            },
        }
    }
}

impl FixedValues {
    fn homotopy(&self) -> &Homotopy {
        self.compiled.get_or_init(|| {
            Homotopy::new(
                &self.system,
                &self.degrees,
                &self.kind,
                self.start_system.as_ref(),
                self.chart.clone(),
                &self.first_chart,
                &[],
                self.seed,
                Interpreter::compile_in_one_way,
            )
        })
    }
}
