//! SolveOptions: everything that decides how a system is solved, besides the system.

use crate::given_start::GivenStart;
use crate::limits::PLANNING_OPERATIONS;
use crate::monodromy::LoopLimits;
use crate::retried_stage::MAX_RETRIES;
use cognate_continuation::start_systems::linear_product::SetStructure;
use cognate_continuation::tracker::settings::Settings;
use cognate_solutions::classification::Tolerances;
pub use cognate_solutions::closing_options::ClosingOptions;
use num_complex::Complex64;

/// Options of a solve; the seed decides everything random.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveOptions {
    /// Start of the paths, with the options of this start.
    pub method: SolveMethod,
    /// Values of the parameters where solutions are wanted. With a start system one set of them; monodromy takes
    /// its start parameters where there is none.
    pub target_parameters: Vec<Vec<Complex64>>,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether the numbers of the equations are exact, however many digits they have: a file that has no rounded
    /// decimal says so, or its user. Else numbers with many digits count as rounded.
    pub numbers_are_exact: bool,
    /// Settings of the path tracker and the tolerances of the verdicts.
    pub tracking: TrackingOptions,
    /// Work that follows once the solutions are found.
    pub closings: ClosingOptions,
    /// Most operations that planning a polyhedral start spends on counting mixed cells, about one for
    /// each multiplication; what takes more is counted by workers.
    pub counting_operations: u64,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self {
            method: SolveMethod::Auto,
            target_parameters: Vec::new(),
            seed: 0,
            numbers_are_exact: false,
            tracking: TrackingOptions::default(),
            closings: ClosingOptions::default(),
            counting_operations: PLANNING_OPERATIONS,
        }
    }
}

/// Start of the paths, each with its own options: the `oneof method` of `proto/problem.proto`, as far as it finds
/// isolated solutions.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum SolveMethod {
    /// The start system with the fewest paths; equation by equation where it has very many, and most of a sample
    /// are wasted.
    #[default]
    Auto,
    /// All affine groups as one.
    TotalDegree,
    /// Start by the groups of the system, or by the best groups if it has one.
    Multihomogeneous,
    /// Start by products of linear forms in these sets of variables, for each equation as many as its degree; `None`:
    /// the sets are guessed.
    LinearProduct(Option<SetStructure>),
    /// Start from mixed cells.
    Polyhedral,
    /// Equation by equation.
    Regeneration,
    /// Start from known solutions, by a parameter homotopy or a homotopy of the user's own.
    Given(KnownSolutions),
    /// Loops in the space of parameters.
    Monodromy(MonodromyOptions),
}

impl SolveMethod {
    /// Start by products of linear forms in sets that are guessed.
    pub const LINEAR_PRODUCT: Self = Self::LinearProduct(None);
    /// Loops from a solution that is found, with default limits.
    pub const MONODROMY: Self = Self::Monodromy(MonodromyOptions {
        known: KnownSolutions {
            points: None,
            parameters: None,
        },
        limits: LoopLimits::DEFAULT,
    });

    /// Name of the start, as it is typed and written: `linear-product`, for instance.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::TotalDegree => "total-degree",
            Self::Multihomogeneous => "multihomogeneous",
            Self::LinearProduct(_) => "linear-product",
            Self::Polyhedral => "polyhedral",
            Self::Regeneration => "regeneration",
            Self::Given(_) => "given",
            Self::Monodromy(_) => "monodromy",
        }
    }

    /// Solutions from which paths begin, if this start begins from known solutions.
    pub fn known_solutions(&self) -> Option<&KnownSolutions> {
        match self {
            Self::Given(solutions) => Some(solutions),
            Self::Monodromy(options) => Some(&options.known),
            Self::Auto
            | Self::TotalDegree
            | Self::Multihomogeneous
            | Self::LinearProduct(_)
            | Self::Polyhedral
            | Self::Regeneration => None,
        }
    }

    /// This start from the given points; a start that uses no points is replaced by a parameter homotopy from them.
    #[must_use]
    pub fn with_points(self, points: GivenStart) -> Self {
        let points = Some(points);
        match self {
            Self::Monodromy(options) => Self::Monodromy(MonodromyOptions {
                known: KnownSolutions {
                    points,
                    ..options.known
                },
                ..options
            }),
            Self::Given(solutions) => Self::Given(KnownSolutions {
                points,
                ..solutions
            }),
            _ => Self::Given(KnownSolutions {
                points,
                parameters: None,
            }),
        }
    }
}

/// Solutions of some member of a family of systems.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnownSolutions {
    /// The solutions.
    pub points: Option<GivenStart>,
    /// Values of the parameters at which the points are solutions.
    pub parameters: Option<Vec<Complex64>>,
}

/// A monodromy solve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MonodromyOptions {
    /// Solutions where loops begin; without points one is found.
    pub known: KnownSolutions,
    /// When loops end.
    pub limits: LoopLimits,
}

/// Settings of the path tracker and the tolerances of the verdicts.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackingOptions {
    /// Settings of the tracker.
    pub settings: Settings,
    /// Tolerances of the verdicts about endpoints.
    pub tolerances: Tolerances,
    /// Most repetitions of a path.
    pub max_retries: u16,
}

impl Default for TrackingOptions {
    fn default() -> Self {
        Self {
            settings: Settings::default(),
            tolerances: Tolerances::default(),
            max_retries: MAX_RETRIES,
        }
    }
}
