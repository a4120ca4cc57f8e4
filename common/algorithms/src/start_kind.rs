//! StartKind: how the paths of a plan begin.

use serde::{Deserialize, Serialize};

/// Start of the paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StartKind {
    /// Total degree: as many paths as the product of the degrees.
    TotalDegree,
    /// As many as the multihomogeneous Bezout number of the variable groups.
    Multihomogeneous,
    /// Given start solutions.
    Given,
    /// Loops in the space of parameters.
    Monodromy,
    /// Twice as many as the mixed volume: from mixed cells to a generic system, and on.
    Polyhedral,
    /// As many as products of linear forms, each in a set of variables, have regular solutions.
    LinearProduct,
    /// Equation by equation: numbers are known when they are found.
    Regeneration,
    /// Equation by equation, for components of all dimensions.
    Cascade,
    /// No paths: the roots of equations in one unknown, each as often as it counts.
    OneUnknown,
    /// No paths: the solutions of equations of few terms and high degree, each as often as it counts.
    FewTerms,
}

impl StartKind {
    /// Whether there are no paths: all solutions are computed while the solve is planned.
    pub fn is_without_paths(self) -> bool {
        matches!(self, Self::OneUnknown | Self::FewTerms)
    }
}

impl std::fmt::Display for StartKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::TotalDegree => "total-degree",
            Self::Multihomogeneous => "multihomogeneous",
            Self::Given => "given",
            Self::Monodromy => "monodromy",
            Self::Polyhedral => "polyhedral",
            Self::LinearProduct => "linear-product",
            Self::Regeneration => "regeneration",
            Self::Cascade => "cascade",
            Self::OneUnknown => "one-unknown",
            Self::FewTerms => "few-terms",
        })
    }
}
