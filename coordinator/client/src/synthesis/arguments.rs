//! The command line of `cognate synthesize`.

use crate::common_arguments::{OwnOrRunning, PresetName};
use crate::problem_arguments::precision;
use clap::{Args, Subcommand, ValueEnum};
use cognate_protocol::submission::PrecisionChoice;
use std::path::PathBuf;

/// `cognate synthesize`.
#[derive(Clone, Debug, Subcommand)]
pub enum Synthesize {
    /// Every four-bar linkage whose coupler point passes nine given points
    NinePoint(NinePoint),
    /// Every four-bar linkage that takes a body through five given poses
    BodyGuidance(BodyGuidance),
    /// Every four-bar linkage with chosen pivots that takes a body through three given poses at given angles of its crank
    BodyGuidanceTiming(BodyGuidanceTiming),
    /// Every four-bar linkage whose coupler point passes five given points at given angles of its crank
    PathTiming(PathTiming),
    /// Every four-bar linkage whose two sides turn together through five given pairs of angles
    FunctionGeneration(FunctionGeneration),
    /// Every four-bar linkage that takes a body through 2, 3 or 4 poses, and a point of it through 6, 4 or
    /// 2 places
    PosesAndPoints(PosesAndPoints),
    /// Every chain of two or three joints that takes a body in space through given poses, and the spherical four-bar linkages of
    /// hinges
    SpatialDyads(SpatialDyads),
}

impl Synthesize {
    /// The options that all have.
    pub fn common(&self) -> &SynthesisArguments {
        match self {
            Self::NinePoint(a) => &a.common,
            Self::BodyGuidance(a) => &a.common,
            Self::BodyGuidanceTiming(a) => &a.common,
            Self::PathTiming(a) => &a.common,
            Self::FunctionGeneration(a) => &a.common,
            Self::PosesAndPoints(a) => &a.common,
            Self::SpatialDyads(a) => &a.common,
        }
    }
}

/// How linkages are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SynthesisFormat {
    /// A table for people
    #[default]
    Table,
    /// One JSON object on standard output, nothing else there
    Json,
    /// A row for each linkage
    Csv,
}

/// `cognate synthesize nine-point`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate synthesize nine-point points.csv
  cognate synthesize nine-point points.csv --certify --output linkages
  cognate synthesize nine-point points.csv --format json \\
      | jq '.curves[0].linkages[0]'
  cognate synthesize nine-point --targets many.csv --format json > many.jsonl

points.csv has a header x,y and nine rows; any units. JSON: {\"points\": [[x, y], ...]}.")]
pub struct NinePoint {
    /// Nine points: CSV with a header x,y or JSON; - is standard input; with --targets the first of many sets
    #[arg(required_unless_present = "targets")]
    pub file: Option<PathBuf>,
    /// Many sets of nine points: CSV with a header x1,y1,...,x9,y9 (name before it, if wanted), or a
    /// line of JSON for each; every set is answered on a line as soon as it is settled
    #[arg(long, value_name = "FILE", conflicts_with = "output")]
    pub targets: Option<PathBuf>,
    /// Service, form of the answer, and progress.
    #[command(flatten)]
    pub common: SynthesisArguments,
}

/// `cognate synthesize body-guidance`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate synthesize body-guidance poses.csv
  cognate synthesize body-guidance poses.csv --output linkages

poses.csv has a header x,y,angle and five rows, angles in degrees. JSON: {\"poses\": [[x, y, angle], ...]}.")]
pub struct BodyGuidance {
    /// Five poses: CSV with a header x,y,angle (degrees) or JSON; - is standard input
    pub file: PathBuf,
    /// Service, form of the answer, and progress.
    #[command(flatten)]
    pub common: SynthesisArguments,
}

/// `cognate synthesize body-guidance-timing`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate synthesize body-guidance-timing poses.csv
  cognate synthesize body-guidance-timing poses.csv --pivot 4,0 --pivot 5,-1

poses.csv has a header x,y,angle,crank and three rows, angles in degrees, of the crank only their differences matter. \
JSON: {\"poses\": [[x, y, angle, crank], ...]}. The poses and angles determine the crank; each pivot has one driven link.")]
pub struct BodyGuidanceTiming {
    /// Three poses with angles: CSV with a header x,y,angle,crank (degrees) or JSON; - is standard input
    pub file: PathBuf,
    /// Pivot of the driven link; may be given several times
    #[arg(long, value_name = "X,Y", value_parser = point_in_the_plane, allow_hyphen_values = true)]
    pub pivot: Vec<[f64; 2]>,
    /// Service, form of the answer, and progress.
    #[command(flatten)]
    pub common: SynthesisArguments,
}

fn point_in_the_plane(text: &str) -> Result<[f64; 2], String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|word| word.trim().parse().ok().filter(|x: &f64| x.is_finite()))
        .collect();
    let point = numbers.and_then(|numbers| numbers.try_into().ok());
    point.ok_or_else(|| "expected two numbers, as in 4,-1.5".into())
}

/// `cognate synthesize path-timing`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate synthesize path-timing points.csv
  cognate synthesize path-timing points.csv --output linkages

points.csv has a header x,y,angle and five rows: the point, and the crank's angle in degrees there, of which \
only the differences matter. JSON: {\"points\": [[x, y, angle], ...]}.")]
pub struct PathTiming {
    /// Five points with angles: CSV with a header x,y,angle (degrees) or JSON; - is standard input
    pub file: PathBuf,
    /// Service, form of the answer, and progress.
    #[command(flatten)]
    pub common: SynthesisArguments,
}

/// `cognate synthesize function-generation`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate synthesize function-generation angles.csv
  cognate synthesize function-generation angles.csv --output linkages

angles.csv has a header input,output and five rows, angles in degrees, of which only the differences matter.
JSON: {\"angles\": [[input, output], ...]}. Lengths are in units of the ground link.")]
pub struct FunctionGeneration {
    /// Five pairs of angles: CSV with a header input,output (degrees) or JSON; - is standard input
    pub file: PathBuf,
    /// Service, form of the answer, and progress.
    #[command(flatten)]
    pub common: SynthesisArguments,
}

/// `cognate synthesize poses-and-points`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate synthesize poses-and-points positions.csv
  cognate synthesize poses-and-points positions.csv --output linkages

positions.csv has a header x,y,angle; the angle, in degrees, is left empty where the body's turn is free.
4 poses with 2 points, 3 with 4, or 2 with 6, in any order. JSON: {\"positions\": [[x, y, angle], [x, y], ...]}.")]
pub struct PosesAndPoints {
    /// Poses and points: CSV with a header x,y,angle (degrees, empty at points) or JSON; - is standard input
    pub file: PathBuf,
    /// Service, form of the answer, and progress.
    #[command(flatten)]
    pub common: SynthesisArguments,
}

/// `cognate synthesize spatial-dyads`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate synthesize spatial-dyads poses.csv --chain SS
  cognate synthesize spatial-dyads poses.csv --chain spherical-RR

SS needs seven poses, PPS six, CC and spherical-RR five, CS eight, RPS ten. poses.csv has a header x,y,z,roll,pitch,yaw (degrees) or \
x,y,z,qw,qx,qy,qz, or no header. The first joint of the chain is on the ground.")]
pub struct SpatialDyads {
    /// Poses: CSV, JSON, or numbers as `mechanism inverse` takes them; - is standard input
    pub file: PathBuf,
    /// Kind of the chain, by its joints from the ground
    #[arg(long, value_enum)]
    pub chain: SpatialChain,
    /// Service, form of the answer, and progress.
    #[command(flatten)]
    pub common: SynthesisArguments,
}

/// Kinds of chains in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SpatialChain {
    /// Two balls: a point of the body on a sphere; seven poses
    #[value(name = "SS", aliases = ["ss", "TS", "ts"])]
    BallBall,
    /// A plane and a ball: a point of the body in a plane; six poses
    #[value(name = "PPS", alias = "pps")]
    PlaneBall,
    /// Two cylinder joints; five poses
    #[value(name = "CC", alias = "cc")]
    Cylinders,
    /// A cylinder joint and a ball: a point of the body on a circular cylinder; eight poses
    #[value(name = "CS", alias = "cs")]
    CylinderBall,
    /// A hinge, a slider and a ball: a point of the body on a hyperboloid of revolution; ten poses
    #[value(name = "RPS", alias = "rps")]
    HingeSliderBall,
    /// Two hinges with axes through one point; five poses, of which only the rotations count
    #[value(name = "spherical-RR", aliases = ["spherical-rr", "RR", "rr"])]
    SphericalHinges,
}

/// The options of every synthesis.
#[derive(Clone, Debug, Args)]
pub struct SynthesisArguments {
    /// Seed of everything random; the same seed gives the same bits
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// How cautiously paths are followed
    #[arg(long, value_enum, default_value_t)]
    pub preset: PresetName,
    /// Arithmetic of the paths: double-doubles for paths that need them, doubles only, or at least this number of bits
    #[arg(long, value_name = "adaptive|double|BITS", default_value = "adaptive", value_parser = precision)]
    pub precision: PrecisionChoice,
    /// Proofs that the linkages are there, that they differ, that they are real
    #[arg(long)]
    pub certify: bool,
    /// A coordinator of the command's own, or one that runs.
    #[command(flatten)]
    pub service: OwnOrRunning,
    /// How the linkages are shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: SynthesisFormat,
    /// Also write summary.json, solutions.jsonl (of nine points), linkages.csv, linkages.html and a DXF drawing of each linkage
    /// here; of spatial dyads summary.json and dyads.csv
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub output: Option<PathBuf>,
}
