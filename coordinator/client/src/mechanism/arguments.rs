//! What people type after `cognate mechanism`.

use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `cognate mechanism`.
#[derive(Clone, Debug, Subcommand)]
pub enum MechanismCommand {
    /// Links, joints, loops, freedoms, and which equations it has; solves nothing
    Info(MechanismInfo),
    /// The equations that are solved, to be checked elsewhere
    Equations(MechanismEquations),
    /// The mechanism in another notation
    Convert(MechanismConvert),
    /// Every posture for given poses of the output
    Inverse(MechanismInverse),
    /// Every position for given inputs
    Forward(MechanismForward),
}

/// How answers about mechanisms are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MechanismFormat {
    /// A table for people
    #[default]
    Table,
    /// One JSON object on standard output, nothing else there
    Json,
}

/// Unit of angles that are typed, in files of targets, and shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AngleUnit {
    /// Degrees
    Deg,
    /// Radians
    Rad,
}

/// Which mechanism, and how its file is read.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Mechanism")]
pub struct MechanismFile {
    /// A mechanism: JSON, TOML, URDF, or a table of Denavit-Hartenberg rows in CSV; - is standard input
    pub file: PathBuf,
    /// Take rounded right angles, such as 1.5708, as they are written
    #[arg(long)]
    pub no_snap: bool,
    /// The link of a URDF that stands still [default: the root]
    #[arg(long, value_name = "LINK")]
    pub base: Option<String>,
    /// The link of a URDF whose pose is meant [default: tool0, or the only tip]
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,
    /// Hold a joint at a value: JOINT=VALUE
    #[arg(long, value_name = "JOINT=VALUE")]
    pub lock: Vec<String>,
    /// Unit of angles that are typed or shown [default: that of the file]
    #[arg(long, value_enum)]
    pub angles: Option<AngleUnit>,
}

/// How targets are answered and shown.
#[derive(Clone, Debug, Args)]
pub struct MechanismAnswer {
    /// Show only positions within limits
    #[arg(long)]
    pub within_limits: bool,
    /// Also show complex positions (JSON)
    #[arg(long)]
    pub complex: bool,
    /// Proofs of the solutions of the equations
    #[arg(long)]
    pub certify: bool,
    /// Seed of everything random; the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: MechanismFormat,
}

/// `cognate mechanism info`.
#[derive(Clone, Debug, Args)]
pub struct MechanismInfo {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: MechanismFormat,
}

/// Which equations are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProblemName {
    /// Inputs are given
    Forward,
    /// The output's pose is given
    Inverse,
    /// Nothing is given
    Motion,
}

/// The notation of equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EquationsFormat {
    /// Our JSON, with groups, parameters, conjugates and degenerate sets
    #[default]
    Json,
    /// Bertini-classic
    Bertini,
    /// PHCpack, for systems without parameters
    Phcpack,
}

/// `cognate mechanism equations`.
#[derive(Clone, Debug, Args)]
pub struct MechanismEquations {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// What is given
    #[arg(long, value_enum)]
    pub problem: ProblemName,
    /// The joints that drive it, instead of the file's
    #[arg(long, value_name = "JOINT")]
    pub input: Vec<String>,
    /// The notation
    #[arg(long, value_enum, default_value_t)]
    pub to: EquationsFormat,
}

/// What a mechanism is converted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Notation {
    /// Our JSON
    #[value(name = "mechanism.json")]
    Json,
    /// A table of Denavit-Hartenberg rows
    #[value(name = "dh.csv")]
    Table,
}

/// `cognate mechanism convert`.
#[derive(Clone, Debug, Args)]
pub struct MechanismConvert {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// The notation wanted
    #[arg(long, value_enum)]
    pub to: Notation,
}

/// `cognate mechanism inverse`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate mechanism inverse arm.urdf --poses poses.json
  cognate mechanism inverse arm.json --pose \"0.4 0.1 0.5 1 0 0 0\" --format json
  cognate mechanism inverse iiwa.urdf --poses poses.json --lock joint_3=0.3")]
pub struct MechanismInverse {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Poses: JSON, or CSV with a header x,y,z,qw,qx,qy,qz; - is standard input
    #[arg(
        long,
        value_name = "FILE",
        required_unless_present = "pose",
        conflicts_with = "pose"
    )]
    pub poses: Option<PathBuf>,
    /// One pose: "x y z qw qx qy qz", in the plane "x y angle"
    #[arg(long, value_name = "POSE", allow_hyphen_values = true)]
    pub pose: Option<String>,
    /// How it is solved, and where the answer goes.
    #[command(flatten)]
    pub answer: MechanismAnswer,
}

/// `cognate mechanism forward`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate mechanism forward platform.json --inputs inputs.json
  cognate mechanism forward stephenson.json --input D0 --set D0=0.1
  cognate mechanism forward framework.json")]
pub struct MechanismForward {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Values of the inputs: JSON, or CSV with their names as header; - is standard input
    #[arg(long, value_name = "FILE", conflicts_with = "set")]
    pub inputs: Option<PathBuf>,
    /// The value of one input: JOINT=VALUE
    #[arg(long, value_name = "JOINT=VALUE", allow_hyphen_values = true)]
    pub set: Vec<String>,
    /// The joints that drive it, instead of the file's
    #[arg(long, value_name = "JOINT")]
    pub input: Vec<String>,
    /// How it is solved, and where the answer goes.
    #[command(flatten)]
    pub answer: MechanismAnswer,
}
