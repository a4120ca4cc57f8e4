//! The command line of `cognate mechanism`.

use crate::common_arguments::{AnswerFormat, Format, OwnOrRunning, PresetName, ProgressArguments};
use clap::{Args, Subcommand, ValueEnum};
use cognate_kinematics::mechanism::task::Task;
use cognate_mechanism_solver::approximate::path_points::STARTS;
use std::path::PathBuf;

/// `cognate mechanism`.
#[derive(Clone, Debug, Subcommand)]
pub enum MechanismCommand {
    /// Links, joints, loops, freedoms, and which equations it has; solves nothing
    #[command(after_help = "Examples:\n  cognate mechanism info arm.urdf")]
    Info(MechanismInfo),
    /// The equations that are solved, to be checked elsewhere
    #[command(
        after_help = "Examples:\n  cognate mechanism equations platform.json --problem forward\n  cognate mechanism equations arm.json --problem inverse --to bertini"
    )]
    Equations(MechanismEquations),
    /// The mechanism in another notation
    #[command(
        after_help = "Examples:\n  cognate mechanism convert arm.urdf --to mechanism.json\n  cognate mechanism convert arm.urdf --to dh.csv"
    )]
    Convert(MechanismConvert),
    /// Every posture for given poses of the output
    Inverse(MechanismInverse),
    /// Every position for given inputs
    Forward(MechanismForward),
    /// Branches of positions along a path of poses or inputs: where they fold, where joints meet their limits
    Follow(MechanismFollow),
    /// All ways in which it moves: the modes of its motion, with dimension and degree, and where they meet
    Motion(MechanismMotion),
    /// For which values of numbers that the file leaves open more moves than in general
    Exceptional(MechanismExceptional),
    /// Freedoms at configurations, to the first order and in earnest
    Mobility(MechanismMobility),
    /// All singular positions, for the inputs that drive it or for its output, or whether some are singular
    Singularities(MechanismSingularities),
    /// Where the output can be, in how many postures, and what bounds that
    Workspace(MechanismWorkspace),
    /// Planar four-bars that miss many poses, points or pairs of angles least
    Synthesize(MechanismSynthesize),
    /// A line of JSON for each pose or set of inputs that comes as a line, until the end of the input
    Serve(MechanismServe),
    /// The families that are solved already
    #[command(after_help = "Examples:\n  cognate mechanism families")]
    Families(MechanismFamilies),
    /// The JSON schema of a mechanism's file, for editors and other programs
    #[command(after_help = "Examples:\n  cognate mechanism schema > mechanism.schema.json")]
    Schema,
}

/// How answers about mechanisms are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MechanismFormat {
    /// A table for people
    #[default]
    Table,
    /// One JSON object on standard output, nothing else there
    Json,
    /// A JSON object on a line for each target with its positions, or for each position of a path, nothing else
    Jsonl,
    /// A row for each position, with the names of columns in the first line
    Csv,
}

/// Unit of angles that are typed, in files of targets, and shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AngleUnit {
    /// Degrees
    Deg,
    /// Radians
    Rad,
}

/// Which part of a pose is given.
#[derive(Clone, Debug, Args)]
pub struct TaskArgument {
    /// The part of a pose that is given, for a chain with fewer joints than a pose has freedoms: position (x y z),
    /// pointing (x y z and the direction dx dy dz of the tool's z axis), xyz-yaw (x y z yaw), planar (x y angle)
    #[arg(long, value_name = "TASK", value_parser = task_of, default_value = "pose", hide_default_value = true)]
    pub task: Task,
}

fn task_of(text: &str) -> Result<Task, String> {
    Task::of_name(text)
        .ok_or_else(|| "expected pose, position, pointing, xyz-yaw or planar".to_owned())
}

/// Which mechanism, and how its file is read.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Mechanism")]
pub struct MechanismFile {
    /// A mechanism: JSON, TOML, URDF, or a table of Denavit-Hartenberg rows in CSV; - is standard input
    #[arg(help_heading = None)]
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
    /// How it is solved.
    #[command(flatten)]
    pub solving: MechanismSolving,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: MechanismFormat,
    /// Write summary.json, solutions.csv and configurations.jsonl into this folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub output: Option<PathBuf>,
}

/// How targets are solved, and where prepared mechanisms are kept.
#[derive(Clone, Debug, Args)]
pub struct MechanismSolving {
    /// Proofs of the solutions of the equations
    #[arg(long)]
    pub certify: bool,
    /// Follow paths to every target, also where the arm has a closed form
    #[arg(long)]
    pub paths_only: bool,
    /// Seed of everything random; the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Threads side by side; the answer is the same [default: the cores]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub threads: usize,
    /// Where prepared mechanisms are kept [default: below the user's cache folder]
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    pub cache: Option<PathBuf>,
    /// Keep nothing, and use nothing that was kept
    #[arg(long)]
    pub no_cache: bool,
}

/// `cognate mechanism info`.
#[derive(Clone, Debug, Args)]
pub struct MechanismInfo {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
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
    /// The problem: which values are given
    #[arg(long, value_enum)]
    pub problem: ProblemName,
    /// The joints that drive it, instead of the file's
    #[arg(long, value_name = "JOINT")]
    pub input: Vec<String>,
    /// The notation
    #[arg(long, value_enum, default_value_t)]
    pub to: EquationsFormat,
}

/// Notation to which a mechanism is converted.
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
  cognate mechanism inverse iiwa.urdf --poses poses.json --lock joint_3=0.3
  cognate mechanism inverse leg.csv --task position --pose \"0.2 0.1 -0.3\"")]
pub struct MechanismInverse {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Poses: JSON, CSV with a header x,y,z,qw,qx,qy,qz or the numbers of the task, or numbers as --pose has them; - is
    /// standard input
    #[arg(
        long,
        value_name = "FILE",
        required_unless_present = "pose",
        conflicts_with = "pose"
    )]
    pub poses: Option<PathBuf>,
    /// One pose: "x y z qw qx qy qz", "x y z roll pitch yaw", or a matrix by rows; in the plane "x y angle"
    #[arg(long, value_name = "POSE", allow_hyphen_values = true)]
    pub pose: Option<String>,
    /// The part of a pose that is given.
    #[command(flatten)]
    pub task: TaskArgument,
    /// Of a chain with a joint too many: hold this joint at values along its limits, or once around; an answer for each
    #[arg(long, value_name = "JOINT")]
    pub sweep: Option<String>,
    /// At how many values
    #[arg(long, value_name = "N", default_value_t = 36, requires = "sweep")]
    pub samples: usize,
    /// The postures nearest to these joint values come first, in the file's order
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true)]
    pub near: Option<String>,
    /// How it is solved, and where the answer goes.
    #[command(flatten)]
    pub answer: MechanismAnswer,
}

/// `cognate mechanism forward`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate mechanism forward platform.json --inputs inputs.json
  cognate mechanism forward arm.csv --inputs \"0 -90 90 0 45 0\"
  cognate mechanism forward stephenson.json --input D0 --set D0=0.1
  cognate mechanism forward framework.json")]
pub struct MechanismForward {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Values of the inputs: a file (JSON, CSV with their names as header, or a line of numbers for all of them; - is standard
    /// input), or the numbers themselves: "0 -90 90 0 45 0"
    #[arg(
        long,
        value_name = "FILE|VALUES",
        conflicts_with = "set",
        allow_hyphen_values = true
    )]
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

/// `cognate mechanism follow`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate mechanism follow arm.urdf --poses path.csv --format csv
  cognate mechanism follow platform.json --inputs path.csv --samples 200
  cognate mechanism follow arm.urdf --poses path.csv \\
      --seed-angles \"0 30 -60 0 45 0\"")]
pub struct MechanismFollow {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Poses along the path: JSON, CSV with a header x,y,z,qw,qx,qy,qz, or numbers as `inverse --pose` has them; - is standard
    /// input
    #[arg(
        long,
        value_name = "FILE",
        required_unless_present = "inputs",
        conflicts_with = "inputs"
    )]
    pub poses: Option<PathBuf>,
    /// Values of the inputs along the path: JSON, CSV with their names as header, or a line of numbers for all of them
    #[arg(long, value_name = "FILE")]
    pub inputs: Option<PathBuf>,
    /// The joints that drive it, instead of the file's
    #[arg(long, value_name = "JOINT", requires = "inputs")]
    pub input: Vec<String>,
    /// Samples in all, at least [default: neighbours within 0.1 radians and a hundredth of the size]
    #[arg(long, value_name = "N")]
    pub samples: Option<usize>,
    /// Only the branch that passes nearest to these joint values at the first sample, in the file's order
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true)]
    pub seed_angles: Option<String>,
    /// Show only branches that stay within limits
    #[arg(long)]
    pub within_limits: bool,
    /// How it is solved.
    #[command(flatten)]
    pub solving: MechanismSolving,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: MechanismFormat,
    /// Write summary.json and trajectory.csv into this folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub output: Option<PathBuf>,
}

/// `cognate mechanism motion`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Degrees are counted in the coordinates that degree_in names: links and joints are cosines and sines of turns, and \
displacements; points are those of a framework; study are the coordinates of a platform in P^7.

Examples:
  cognate mechanism motion parallelogram.json
  cognate mechanism motion four_bar.json --real --path output
  cognate mechanism motion stephenson.json --path \"coupler 2 7/2\" --format json
  cognate mechanism motion family.json --sweep values.json")]
pub struct MechanismMotion {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Also count the circuits: connected pieces of the real positions
    #[arg(long)]
    pub real: bool,
    /// Also the degree of the path of a point: output, or \"LINK x y [z]\" in the coordinates of the link
    #[arg(long, value_name = "output|POINT", allow_hyphen_values = true)]
    pub path: Option<String>,
    /// Values of the numbers that the file leaves open with \"?\": a list of {\"b\": 3, \"c\": \"5/2\"}; an answer for each
    #[arg(long, value_name = "FILE", conflicts_with_all = ["real", "path"])]
    pub sweep: Option<PathBuf>,
    /// Seed of everything random; the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// How cautiously paths are followed
    #[arg(long, value_enum, default_value_t)]
    pub preset: PresetName,
    /// A coordinator of the command's own, or one that runs.
    #[command(flatten)]
    pub service: OwnOrRunning,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: AnswerFormat,
    /// How progress is shown until the answer is there.
    #[command(flatten)]
    pub progress: ProgressArguments,
}

/// `cognate mechanism exceptional`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Numbers that the file leaves open with \"?\" become unknowns beside those of the motion. A component of the solutions over \
a smaller set of values than all, on which more moves than for general values, is exceptional.

Examples:
  cognate mechanism exceptional closed_4r.json
  cognate mechanism exceptional framework.json --format json")]
pub struct MechanismExceptional {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Seed of everything random; the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// How cautiously paths are followed
    #[arg(long, value_enum, default_value_t)]
    pub preset: PresetName,
    /// A coordinator of the command's own, or one that runs.
    #[command(flatten)]
    pub service: OwnOrRunning,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: AnswerFormat,
    /// How progress is shown until the answer is there.
    #[command(flatten)]
    pub progress: ProgressArguments,
}

/// `cognate mechanism mobility`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
A configuration is {\"joints\": {\"A0\": 0.3, ..}} with the value of every joint, also as [cos, sin]; of a framework \
{\"points\": {\"A\": [0, 0], ..}}; of a platform {\"pose\": {..}}. Where file and configuration are exact, so is the answer.

With --why it is said of each number of the file whether the mechanism keeps its freedoms near the configuration where that \
number is changed a little and no other: a length or twist q2.a, q2.alpha of a row, a coordinate B.point.0 of a joint, the \
length of a bar.

Examples:
  cognate mechanism mobility linkage.json --at home
  cognate mechanism mobility linkage.json --at home --why
  cognate mechanism mobility framework.json --at at.json --format json")]
pub struct MechanismMobility {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Configurations in JSON, one or a list; home is the position of the mechanism's file
    #[arg(long, value_name = "home|FILE")]
    pub at: PathBuf,
    /// Also says which numbers of the file take a freedom away there where they are changed
    #[arg(long)]
    pub why: bool,
    /// Seed of everything random; the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: AnswerFormat,
}

/// `cognate mechanism singularities`.
#[derive(Clone, Debug, Args)]
#[command(group = clap::ArgGroup::new("kind").required(true).args(["inputs", "outputs"]))]
#[command(after_help = "\
Without --at all singular positions are given: those that are alone, with the values of the joints, and components with \
dimension and degree. This is for planar linkages, and for planar platforms on three driven legs; of an arm of three joints \
that places a point, cusps are counted, and it is said whether a posture changes without a singularity. With --at it is said of \
each configuration whether it is singular. Configurations are written as for cognate mechanism mobility.

Examples:
  cognate mechanism singularities four_bar.json --inputs
  cognate mechanism singularities five_bar.json --outputs --format json
  cognate mechanism singularities planar_platform.json --inputs \\
      --orientation 0.35
  cognate mechanism singularities arm.json --outputs --at at.json --angles rad")]
pub struct MechanismSingularities {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Where something moves while all inputs are held
    #[arg(long)]
    pub inputs: bool,
    /// Where the output has lost a direction of motion
    #[arg(long)]
    pub outputs: bool,
    /// Only these configurations, in JSON, one or a list; home is the position of the mechanism's file
    #[arg(long, value_name = "home|FILE")]
    pub at: Option<PathBuf>,
    /// The joints that drive it, instead of the file's
    #[arg(long, value_name = "JOINT", requires = "inputs")]
    pub input: Vec<String>,
    /// Of a planar platform: the angle at which it is held
    #[arg(
        long,
        value_name = "ANGLE",
        allow_hyphen_values = true,
        conflicts_with = "at"
    )]
    pub orientation: Option<String>,
    /// Seed of everything random; the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// How cautiously paths are followed
    #[arg(long, value_enum, default_value_t)]
    pub preset: PresetName,
    /// A coordinator of the command's own, or one that runs.
    #[command(flatten)]
    pub service: OwnOrRunning,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: AnswerFormat,
    /// How progress is shown until the answer is there.
    #[command(flatten)]
    pub progress: ProgressArguments,
}

/// `cognate mechanism synthesize`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
The file says the type of the mechanism: a planar four-bar with four turning joints. Its numbers are not used.

Poses (more than five): dyads, all stationary points of the sum of (|p + R b - a|^2 - l^2)^2.
Pairs of angles (more than five): all stationary points of the summed squares of Freudenstein's equation.
Points (more than nine): local minima of the summed squared distances from the coupler curve, from random linkages; \
a better one may exist.

Examples:
  cognate mechanism synthesize four_bar.json --poses poses.json --approximate
  cognate mechanism synthesize four_bar.json --pairs pairs.csv --approximate \\
      --angles deg
  cognate mechanism synthesize four_bar.json --points points.csv \\
      --approximate --format json")]
pub struct MechanismSynthesize {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Task of the linkage.
    #[command(flatten)]
    pub task: SynthesisTask,
    /// The linkages that miss it least, for more than can be met
    #[arg(long)]
    pub approximate: bool,
    /// Random linkages that are improved, with --points
    #[arg(long, value_name = "N", default_value_t = STARTS, requires = "points")]
    pub starts: usize,
    /// Seed of everything random; the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Threads side by side; the answer is the same [default: the cores]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub threads: usize,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: AnswerFormat,
}

/// Task of a linkage; one of these.
#[derive(Clone, Debug, Args)]
#[group(required = true, multiple = false)]
pub struct SynthesisTask {
    /// Poses of the coupler, as for inverse
    #[arg(long, value_name = "FILE")]
    pub poses: Option<PathBuf>,
    /// Points of the path of a coupler point: JSON, or CSV with the header x,y
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// Angles of crank and rocker: JSON, or CSV with the header crank,rocker
    #[arg(long, value_name = "FILE")]
    pub pairs: Option<PathBuf>,
}

/// `cognate mechanism workspace`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Points are a list of {\"position\": [x, y, z]}, in the plane of [x, y]. Circles that bound what is reached, its area and the
largest number of postures are given for chains of turns in the plane, for five-bars whose output is the joint between the rods,
and for planar platforms that are held at an angle.

Examples:
  cognate mechanism workspace five_bar.json
  cognate mechanism workspace five_bar.json --points points.json
  cognate mechanism workspace delta.json --points points.json \\
      --within-limits --format json")]
pub struct MechanismWorkspace {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Points in JSON; without them only the boundary is given
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// Of a planar platform: the angle at which it is held
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub orientation: Option<String>,
    /// A point is reachable only where one of its postures is within all limits
    #[arg(long)]
    pub within_limits: bool,
    /// How it is solved.
    #[command(flatten)]
    pub solving: MechanismSolving,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: AnswerFormat,
}

/// `cognate mechanism serve`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
A line is a pose, {\"position\": [x, y, z], \"quaternion\": [w, x, y, z]}, or with --forward values of the inputs by \
name. An \"id\" beside them comes back with the answer. A line that cannot be read is answered by \
{\"error\": ..., \"line\": N, \"field\": ...}, and the next line is read.

Examples:
  cognate mechanism serve arm.urdf < poses.jsonl > postures.jsonl
  cognate mechanism serve platform.json --forward")]
pub struct MechanismServe {
    /// The mechanism's file, and how it is read.
    #[command(flatten)]
    pub mechanism: MechanismFile,
    /// Lines are values of the inputs, not poses of the output
    #[arg(long)]
    pub forward: bool,
    /// The joints that drive it, instead of the file's
    #[arg(long, value_name = "JOINT", requires = "forward")]
    pub input: Vec<String>,
    /// The part of a pose that is given.
    #[command(flatten)]
    pub task: TaskArgument,
    /// The positions nearest to these joint values come first, in the file's order
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true)]
    pub near: Option<String>,
    /// Answer only with positions within limits
    #[arg(long)]
    pub within_limits: bool,
    /// Also answer with complex positions
    #[arg(long)]
    pub complex: bool,
    /// How it is solved.
    #[command(flatten)]
    pub solving: MechanismSolving,
}

/// `cognate mechanism families`.
#[derive(Clone, Debug, Args)]
pub struct MechanismFamilies {
    /// The action on a family; without one the families are listed.
    #[command(subcommand)]
    pub action: Option<FamilyAction>,
    /// How the list is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// An action on a family.
#[derive(Clone, Debug, Subcommand)]
pub enum FamilyAction {
    /// Solve its general member anew from a start system, and compare the number with the published one
    #[command(
        after_help = "Examples:\n  cognate mechanism families prepare six_revolute --output here"
    )]
    Prepare {
        /// The family's name
        name: String,
        /// Seed of everything random; the same seed gives the same bits
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u64,
        /// Write parameters.json and solutions.jsonl into this folder
        #[arg(long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
}
