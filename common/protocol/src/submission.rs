//! Submission: what a client asks for, after the checks at the door.

use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::tracker::settings::{Preset, Settings};
use cognate_solutions::closing_options::ClosingOptions;
use cognate_solutions::witness::{KnownComponents, Method, Question, WitnessSet};
use cognate_systems::system::System;
use num_complex::Complex64;

/// A problem and the options of its solve.
#[derive(Clone, Debug, PartialEq)]
pub struct Submission {
    /// Problem to be solved.
    pub source: Source,
    /// Start, settings and closings of the solve.
    pub options: Options,
}

/// Source of the system.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A checked system.
    System(Box<System>),
    /// A file that has still to be read.
    Text {
        /// The file's name, for messages.
        name: String,
        /// Bytes of the file.
        content: Vec<u8>,
    },
}

/// Options of a solve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The start system that the client asked for; `Auto` lets the plan choose.
    pub start: StartKind,
    /// Variable groups by name, which replace the groups of the system.
    pub groups: Option<Vec<Vec<String>>>,
    /// Pairs of conjugate variables by name, which replace the pairs of the system; if empty, the system's pairs stay.
    pub conjugates: Vec<(String, String)>,
    /// Seed of everything random; `None`: from the problem's digest.
    pub seed: Option<u64>,
    /// Preset of the tracker, and the numbers that replace its own.
    pub settings: SettingsChoice,
    /// The arithmetic asked for.
    pub precision: PrecisionChoice,
    /// Parameters at which the start solutions solve the system; empty if there are none.
    pub start_parameters: Vec<Complex64>,
    /// Parameters at which solutions are wanted; each set has a value for each parameter.
    pub target_parameters: Vec<Vec<Complex64>>,
    /// Start points of the paths, for [`StartKind::Given`].
    pub start_solutions: Option<StartSolutions>,
    /// A name for people; may be empty.
    pub name: String,
    /// For [`StartKind::Monodromy`]: loops in a row without anything new after which the solve ends.
    pub idle_loops: Option<u32>,
    /// For [`StartKind::Monodromy`]: number of solutions, if it is known.
    pub expected_solutions: Option<u64>,
    /// Work that follows once the solutions are found.
    pub closings: ClosingOptions,
    /// For [`StartKind::Monodromy`]: whether a trace test decides that all solutions are found.
    pub trace_test: bool,
    /// For [`StartKind::Monodromy`]: probability, between 0 and 1, with which no solution should be missing if loops
    /// permute at random; `None`: idle loops end the solve.
    pub confidence: Option<f64>,
    /// Statements of the files that the client read and did not follow; kept with the job.
    pub warnings: Vec<String>,
    /// For [`StartKind::LinearProduct`]: the variables of each factor of each equation.
    pub sets: Option<Vec<Vec<Vec<u32>>>>,
    /// All irreducible components are wanted instead of isolated solutions.
    pub decompose: Option<Decompose>,
    /// Question about known components, asked instead of isolated solutions.
    pub question: Option<Asked>,
}

/// Question of a client about known components.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// The components, each of the submitted system.
    pub components: Vec<WitnessSet>,
    /// Question asked about all the components.
    pub question: Question,
}

/// Components that a client asks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decompose {
    /// Lowest and highest dimension; `None`: all.
    pub dimensions: Option<[u32; 2]>,
    /// Loops in a row that bring no witness points together before these stay apart.
    pub idle_loops: Option<u32>,
    /// Method for the witness points; `None`: the coordinator chooses.
    pub method: Option<Method>,
    /// Whether a second way is compared with the first.
    pub verify: bool,
    /// Whether the points of each dimension stay one set.
    pub without_split: bool,
    /// All components of the first equations, where they are known.
    pub known: Option<KnownComponents>,
}

/// The start system that a client asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartKind {
    /// The coordinator chooses.
    #[default]
    Auto,
    /// x_i^(d_i) = 1.
    TotalDegree,
    /// Products of linear forms, group by group.
    Multihomogeneous,
    /// Start solutions are given.
    Given,
    /// Loops in the space of parameters.
    Monodromy,
    /// Mixed cells.
    Polyhedral,
    /// Products of linear forms in sets of variables.
    LinearProduct,
    /// Equation by equation.
    Regeneration,
}

/// The arithmetic asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PrecisionChoice {
    /// Precision as each path needs it.
    #[default]
    Adaptive,
    /// Hardware doubles only.
    Double,
    /// A fixed precision for every path, in bits.
    Bits(u32),
}

/// Start solutions, coordinates in the order of the system's variables.
#[derive(Clone, Debug, PartialEq)]
pub enum StartSolutions {
    /// Sent along.
    Points(StoredPoints),
    /// Uploaded before.
    Object(Digest),
}

macro_rules! settings_choice {
    ($($field:ident: $type:ty, $from:literal ..= $to:literal;)*) => {
        /// A preset, and what is to be different from it.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct SettingsChoice {
            /// Source of the absent fields; `None`: the default, or the settings of the file.
            pub preset: Option<Preset>,
            $(
                #[doc = concat!("[`Settings::", stringify!($field), "`], if it is to be different.")]
                pub $field: Option<$type>,
            )*
        }

        impl SettingsChoice {
            /// `base` with everything that this choice names.
            pub fn over(&self, base: Settings) -> Settings {
                Settings { $($field: self.$field.unwrap_or(base.$field),)* }
            }

            /// A choice that names every field.
            pub fn all(settings: &Settings) -> Self {
                let Settings { $($field,)* } = settings.clone();
                Self { preset: None, $($field: Some($field),)* }
            }

            pub(crate) fn from_message(
                m: &crate::v1::Settings,
                preset: Option<Preset>,
            ) -> Result<Self, crate::error::ProtocolError> {
                $(
                    // A range does not contain NaN.
                    if let Some(value) = m.$field && !($from..=$to).contains(&value) {
                        return Err(crate::error::ProtocolError::invalid(
                            stringify!($field),
                            value,
                            concat!("a number from ", stringify!($from), " to ", stringify!($to)),
                        ));
                    }
                )*
                Ok(Self { preset, $($field: m.$field,)* })
            }

            pub(crate) fn to_message(&self, preset: crate::v1::Preset) -> crate::v1::Settings {
                crate::v1::Settings { preset: preset.into(), $($field: self.$field,)* }
            }

            /// The settings, if every field is named; else the first that is not.
            pub fn complete(&self) -> Result<Settings, &'static str> {
                Ok(Settings { $($field: self.$field.ok_or(stringify!($field))?,)* })
            }
        }
    };
}

// The ranges keep out what makes no sense; they do not say what is wise.
settings_choice! {
    tolerance: f64, 1e-300..=1e-2;
    predictor_tolerance: f64, 1e-300..=1.0;
    max_step: f64, 1e-12..=1.0;
    reach: f64, 0.0..=1.0;
    min_step: f64, 1e-300..=1e-2;
    max_steps: u32, 1..=1_000_000_000;
    endgame_boundary: f64, 1e-300..=1.0;
    endgame_radius: f64, 1e-300..=1.0;
    endgame_min_radius: f64, 1e-300..=1.0;
    max_winding_number: u32, 1..=100_000;
    singular_condition: f64, 1.0..=1e300;
    endgame_tolerance: f64, 1e-300..=1.0;
    data_accuracy: f64, 0.0..=1.0;
    exact_data: bool, false..=true;
    max_endgame_bits: u32, 0..=0xffff_ffff;
    precision_bits: u32, 53..=65_536;
    max_precision_bits: u32, 53..=65_536;
}

impl SettingsChoice {
    /// The settings where no file has a say.
    pub fn resolve(&self) -> Settings {
        self.over(self.preset.unwrap_or_default().settings())
    }
}
