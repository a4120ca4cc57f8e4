//! ProblemArguments: the problem and how it is solved, as the user types it; the options of every command that takes a
//! system.

use super::common_arguments::PresetName;
use super::system_source::SystemSource;
use clap::Args;
use cognate_continuation::sharpening::MOST_DIGITS;
use cognate_protocol::file_settings::MOST_BITS;
use cognate_protocol::option_misfit::any_of;
use cognate_protocol::submission::{PrecisionChoice, StartKind};
use std::path::PathBuf;

/// Heading of the options that choose the start system.
const STARTS: &str = "Where paths begin";
/// Heading of the options for the tracker.
const PATHS: &str = "How paths are followed";
/// Heading of the options for digits and certificates.
const TRUST: &str = "Digits and proofs";
/// Heading of the options for workers.
pub const MACHINES: &str = "Machines";

/// The problem and how it is solved: the options of every command that takes a system.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Problem")]
pub struct ProblemArguments {
    /// The system.
    #[command(flatten)]
    pub system: SystemSource,
    /// Variable groups instead of those in the file: "x,y;z,w"
    #[arg(long, value_name = "GROUPS")]
    pub groups: Option<String>,
    /// Pairs of variables that are conjugates at a real solution: "p~P,t1~T1"
    #[arg(long, value_name = "PAIRS")]
    pub conjugates: Option<String>,
    /// Named sets of endpoints that are no answers (JSON)
    #[arg(long, value_name = "FILE")]
    pub degenerate: Option<PathBuf>,
    /// Generators of a symmetry group of the solutions (JSON): classes are counted, and
    /// --start monodromy tracks one solution of each
    #[arg(long, value_name = "FILE")]
    pub symmetry: Option<PathBuf>,
    /// The start system: auto, total-degree, multihomogeneous, linear-product, polyhedral, regeneration, monodromy or given
    #[arg(
        help_heading = STARTS,
        long,
        value_parser = start,
        default_value = StartKind::Auto.name(),
        value_name = "START"
    )]
    pub start: StartKind,
    /// Known solutions to start from: our solutions.jsonl, Bertini's start format or PHCpack's list
    #[arg(help_heading = STARTS, long, value_name = "FILE")]
    pub start_solutions: Option<PathBuf>,
    /// The parameters that the start solutions belong to: Bertini's format, JSON, or a text such as "a=5, b=2"
    #[arg(help_heading = STARTS, long, value_name = "FILE|NAME=VALUE")]
    pub start_parameters: Option<PathBuf>,
    /// The parameters wanted, one set or many: Bertini's format, JSON, CSV with a header of names, or a text such as
    /// "omega=linspace(0.5, 2, 100)", "omega=0.5,1,2" or "omega=1, d=sqrt(2)"; of several --targets all combinations.
    /// In JSON a list of two numbers is one complex value, {"p": [re, im]}; longer lists are values that run together
    #[arg(
        help_heading = STARTS,
        long = "targets",
        alias = "target-parameters",
        value_name = "FILE|NAME=VALUES"
    )]
    pub target_parameters: Vec<PathBuf>,
    /// Sets of variables for --start linear-product (JSON): a list for each equation, with as
    /// many sets as its degree, whose product of linear forms has all of its monomials, as in
    /// [[["x"], ["x", "y"]], [["x", "y"]]]
    #[arg(help_heading = STARTS, long, value_name = "FILE")]
    pub sets: Option<PathBuf>,
    /// Seed of everything random; the same seed gives the same bits [default: made from the problem]
    #[arg(help_heading = STARTS, long, value_name = "N")]
    pub seed: Option<u64>,
    /// Loops in a row without anything new after which --start monodromy ends [default: 5]
    #[arg(help_heading = STARTS, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub idle_loops: Option<u32>,
    /// Instead of idle loops: --start monodromy ends when, if loops permute the solutions at random, none
    /// is missing with this probability, such as 0.999
    #[arg(help_heading = STARTS, long, value_name = "PROBABILITY", value_parser = probability, conflicts_with = "idle_loops")]
    pub confidence: Option<f64>,
    /// How many solutions there are at generic parameters, where --start monodromy should know
    #[arg(help_heading = STARTS, long, value_name = "N")]
    pub expect: Option<u64>,
    /// Let a trace test decide when --start monodromy has all solutions that loops connect: it is a
    /// proof but for rounding, where loops without anything new are only evidence
    #[arg(help_heading = STARTS, long)]
    pub trace_test: bool,
    /// How cautiously paths are followed
    #[arg(help_heading = PATHS, long, value_enum, default_value_t)]
    pub preset: PresetName,
    /// Arithmetic of the paths: double-doubles for paths that need them, doubles only, or at least this number of bits
    #[arg(help_heading = PATHS, long, value_name = "adaptive|double|BITS", default_value = "adaptive", value_parser = precision)]
    pub precision: PrecisionChoice,
    /// Proofs that there is exactly one solution in each box, that they differ, that they are real
    #[arg(help_heading = TRUST, long)]
    pub certify: bool,
    /// Decimal digits of the solutions, found by Newton's method at their ends
    /// [default: those of the paths' arithmetic]
    #[arg(help_heading = TRUST, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_DIGITS)))]
    pub digits: Option<u32>,
    /// Also isolated singular solutions get their digits, by deflation
    #[arg(help_heading = TRUST, long)]
    pub deflate: bool,
    /// Decimals of 8 and more significant digits are exact, not rounded to half a unit of the last digit:
    /// also solutions that rounding makes, near infinity, are followed to their ends
    #[arg(help_heading = TRUST, long)]
    pub exact: bool,
    /// Let the paths alone decide: without the count of the solutions by elimination over a prime field, which
    /// says whether paths were taken for what they are not
    #[arg(help_heading = TRUST, long)]
    pub no_exact_count: bool,
    /// Where more equations than unknowns have no common solution: the real points of least residual near the ends of
    /// excess paths
    #[arg(help_heading = TRUST, long)]
    pub approximate: bool,
}

/// A start, as typed.
fn start(text: &str) -> Result<StartKind, String> {
    let starts = StartKind::ALL.into_iter();
    let mut matching_starts = starts.filter(|start| start.name() == text);
    matching_starts
        .next()
        .ok_or_else(|| format!("expected {}", any_of(&StartKind::ALL)))
}

/// A probability that is neither 0 nor 1.
fn probability(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(p) if p > 0.0 && p < 1.0 => Ok(p),
        _ => Err("expected a probability between 0 and 1, such as 0.999".to_owned()),
    }
}

/// An arithmetic, as typed.
pub fn precision(text: &str) -> Result<PrecisionChoice, String> {
    match text {
        "adaptive" => Ok(PrecisionChoice::Adaptive),
        "double" => Ok(PrecisionChoice::Double),
        bits => match bits.parse::<u32>() {
            Ok(bits) if bits > MOST_BITS => {
                Err(format!("not in this version: at most {MOST_BITS} bits"))
            }
            Ok(bits) if bits > 0 => Ok(PrecisionChoice::Bits(bits)),
            _ => Err("expected adaptive, double or a number of bits".into()),
        },
    }
}
