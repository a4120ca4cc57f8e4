//! OptionMisfit: options that do not go with each other, said once for clients and coordinator.

use crate::submission::{Options, StartKind};

/// The first option that does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OptionMisfit {
    /// An option of other starts.
    #[error("options.{field}: only goes with start kind {}", any_of(.starts))]
    OnlyWith {
        /// The option, as `proto/problem.proto` names it.
        field: &'static str,
        /// The starts that have it.
        starts: &'static [StartKind],
    },
    /// Two options of which one is meant.
    #[error("options.{field}: does not go with options.{other}")]
    NotWith {
        /// The option.
        field: &'static str,
        /// The one that excludes it.
        other: &'static str,
    },
    /// An option for one set of parameters beside several.
    #[error("options.{field}: goes with one set of target_parameters")]
    SeveralTargets {
        /// The option.
        field: &'static str,
    },
    /// The start kind `given` without points.
    #[error("options.start_solutions: start kind given needs start solutions")]
    NoStartSolutions,
}

impl OptionMisfit {
    /// The option, as `proto/problem.proto` names it.
    pub fn field(&self) -> &'static str {
        match self {
            Self::OnlyWith { field, .. }
            | Self::NotWith { field, .. }
            | Self::SeveralTargets { field } => field,
            Self::NoStartSolutions => "start_solutions",
        }
    }
}

/// Names as they are typed: "given, monodromy or auto".
pub fn any_of(starts: &[StartKind]) -> String {
    let names: Vec<&str> = starts.iter().map(|start| start.name()).collect();
    match names.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [before @ .., last] => format!("{} or {last}", before.join(", ")),
    }
}

impl StartKind {
    /// Every start, in the order in which they are told.
    pub const ALL: [Self; 8] = [
        Self::Auto,
        Self::TotalDegree,
        Self::Multihomogeneous,
        Self::LinearProduct,
        Self::Polyhedral,
        Self::Regeneration,
        Self::Monodromy,
        Self::Given,
    ];

    /// Name of the start, as the user types it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::TotalDegree => "total-degree",
            Self::Multihomogeneous => "multihomogeneous",
            Self::Given => "given",
            Self::Monodromy => "monodromy",
            Self::Polyhedral => "polyhedral",
            Self::LinearProduct => "linear-product",
            Self::Regeneration => "regeneration",
        }
    }
}

/// Options of some starts only: field, whether it is given, the starts.
fn of_starts(options: &Options) -> [(&'static str, bool, &'static [StartKind]); 6] {
    const LOOPS: &[StartKind] = &[StartKind::Monodromy];
    const POINTS: &[StartKind] = &[StartKind::Given, StartKind::Monodromy, StartKind::Auto];
    const SETS: &[StartKind] = &[StartKind::LinearProduct, StartKind::Auto];
    [
        ("idle_loops", options.idle_loops.is_some(), LOOPS),
        (
            "expected_solutions",
            options.expected_solutions.is_some(),
            LOOPS,
        ),
        ("trace_test", options.trace_test, LOOPS),
        ("confidence", options.confidence.is_some(), LOOPS),
        ("sets", options.sets.is_some(), SETS),
        ("start_solutions", options.start_solutions.is_some(), POINTS),
    ]
}

impl Options {
    /// Whether the options go with each other; what the system says to them is the planner's business.
    pub fn check(&self) -> Result<(), OptionMisfit> {
        if self.decompose.is_some() || self.question.is_some() {
            return self.check_decomposition();
        }
        for (field, given, starts) in of_starts(self) {
            if given && !starts.contains(&self.start) {
                return Err(OptionMisfit::OnlyWith { field, starts });
            }
        }
        if self.idle_loops.is_some() && self.confidence.is_some() {
            // Two rules for when loops end.
            return Err(OptionMisfit::NotWith {
                field: "idle_loops",
                other: "confidence",
            });
        }
        if self.closings.approximate && self.target_parameters.len() > 1 {
            let field = "approximate";
            return Err(OptionMisfit::SeveralTargets { field });
        }
        match (self.start, &self.start_solutions) {
            (StartKind::Given, None) => Err(OptionMisfit::NoStartSolutions),
            _ => Ok(()),
        }
    }

    /// A decomposition, or a question to components, has starts of its own, and no isolated solutions to do something
    /// with.
    fn check_decomposition(&self) -> Result<(), OptionMisfit> {
        let other = match &self.question {
            Some(_) => "question",
            None => "decompose",
        };
        if self.decompose.is_some() && self.question.is_some() {
            let field = "decompose";
            return Err(OptionMisfit::NotWith { field, other });
        }
        let others = [
            ("start", self.start != StartKind::Auto),
            ("start_parameters", !self.start_parameters.is_empty()),
            ("certify", self.closings.certify && self.question.is_some()),
            ("digits", self.closings.digits.is_some()),
            ("deflate", self.closings.deflate),
            ("approximate", self.closings.approximate),
        ];
        let of_starts = of_starts(self).map(|(field, given, _)| (field, given));
        match others.iter().chain(&of_starts).find(|(_, given)| *given) {
            Some((field, _)) => Err(OptionMisfit::NotWith { field, other }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::submission::Decompose;
    use cognate_solutions::closing_options::ClosingOptions;

    #[test]
    fn what_does_not_fit_is_named() {
        let said = |options: Options| options.check().map_err(|misfit| misfit.to_string());
        assert_eq!(said(Options::default()), Ok(()));
        let loops = Options {
            idle_loops: Some(3),
            ..Options::default()
        };
        assert_eq!(
            said(loops.clone()),
            Err("options.idle_loops: only goes with start kind monodromy".to_owned())
        );
        let both = Options {
            start: StartKind::Monodromy,
            confidence: Some(0.9),
            ..loops.clone()
        };
        assert_eq!(
            said(both),
            Err("options.idle_loops: does not go with options.confidence".to_owned())
        );
        let sets = Options {
            start: StartKind::Polyhedral,
            sets: Some(Vec::new()),
            ..Options::default()
        };
        assert_eq!(
            said(sets),
            Err("options.sets: only goes with start kind linear-product or auto".to_owned())
        );
        let components = Options {
            decompose: Some(Decompose::default()),
            ..loops
        };
        assert_eq!(
            said(components),
            Err("options.idle_loops: does not go with options.decompose".to_owned())
        );
        let proved = Options {
            decompose: Some(Decompose::default()),
            closings: ClosingOptions {
                certify: true,
                ..ClosingOptions::default()
            },
            ..Options::default()
        };
        assert_eq!(said(proved.clone()), Ok(()));
        let sharpened = Options {
            closings: ClosingOptions {
                digits: Some(30),
                ..proved.closings
            },
            ..proved
        };
        assert_eq!(
            said(sharpened),
            Err("options.digits: does not go with options.decompose".to_owned())
        );
        let approximate = Options {
            target_parameters: vec![Vec::new(); 2],
            closings: ClosingOptions {
                approximate: true,
                ..ClosingOptions::default()
            },
            ..Options::default()
        };
        assert_eq!(
            said(approximate),
            Err("options.approximate: goes with one set of target_parameters".to_owned())
        );
        let given = Options {
            start: StartKind::Given,
            ..Options::default()
        };
        assert_eq!(given.check(), Err(OptionMisfit::NoStartSolutions));
    }
}
