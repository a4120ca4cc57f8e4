//! Arguments of the commands that ask components.

use crate::common_arguments::{
    AnswerFormat, OutputArguments, OwnOrRunning, PresetName, ProgressArguments, Shown, shown,
};
use crate::system_source::SystemSource;
use clap::Args;
use cognate_solutions::witness::ComponentId;
use std::path::PathBuf;

/// The components that are asked, by whom, and how the answer is shown.
#[derive(Clone, Debug, Args)]
pub struct SetArguments {
    /// Components: the folder of `decompose --output`, its decomposition.json, a folder with Bertini's input and
    /// witness_data, or the id of a job of --coordinator
    #[arg(value_name = "SET", help_heading = None)]
    pub set: PathBuf,
    /// Only these components, such as 1.2; may be given several times [default: all]
    #[arg(long = "component", value_name = "ID", value_parser = id)]
    pub components: Vec<ComponentId>,
    /// How cautiously paths are followed
    #[arg(long, value_enum, default_value_t)]
    pub preset: PresetName,
    /// A coordinator of the command's own, or one that runs.
    #[command(flatten)]
    pub service: OwnOrRunning,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: AnswerFormat,
    /// How many rows a table lists [default: 20]
    #[arg(long, value_name = "N|all", value_parser = shown, help_heading = "Output")]
    pub show: Option<Shown>,
    /// Also write summary.json here, points as samples.csv, real curves as curve.json, .svg, .dxf and .html, real
    /// surfaces as surface.json, .obj, .stl, .svg and .html, components as a SET
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub output: Option<PathBuf>,
    /// How progress is shown until the answer is there.
    #[command(flatten)]
    pub progress: ProgressArguments,
}

fn id(text: &str) -> Result<ComponentId, String> {
    text.parse()
}

impl SetArguments {
    /// Files and format of the answer.
    pub fn output(&self) -> OutputArguments {
        OutputArguments {
            format: self.format,
            output: self.output.clone(),
            show: self.show,
            axes: Vec::new(),
        }
    }
}

/// `cognate member`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate member here --points points.csv
  cognate decompose system.bertini --output here \\
      && cognate member here --points points.csv
  printf 'x,y,z\\n3/5,4/5,0\\n' | cognate member here --points -")]
pub struct Member {
    /// Components.
    #[command(flatten)]
    pub set: SetArguments,
    /// Points: CSV with a header of variables, JSON, or solutions.jsonl; fractions are exact
    #[arg(long, value_name = "FILE")]
    pub points: PathBuf,
    /// The error of each point relative to its size [default: as their digits say]
    #[arg(long, value_name = "E", value_parser = accuracy)]
    pub accuracy: Option<f64>,
}

/// `cognate sample`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate sample here --component 1.1 --count 1000 --output points
  cognate sample here --component 1.1 --count 20 --real --box '0..1,-1..1,-1..1'
  cognate sample here --component 1.1 --count 20 --near point.csv")]
pub struct Sample {
    /// Components.
    #[command(flatten)]
    pub set: SetArguments,
    /// Points of each component
    #[arg(long, value_name = "K")]
    pub count: u64,
    /// Near this point: a file with one point
    #[arg(long, value_name = "FILE", conflicts_with = "within")]
    pub near: Option<PathBuf>,
    /// Only real points
    #[arg(long)]
    pub real: bool,
    /// Only real points with each variable between two numbers: "0..1,-1..1", or a range for all of them
    #[arg(long = "box", value_name = "LOW..HIGH,...", value_parser = ranges, allow_hyphen_values = true)]
    pub within: Option<Ranges>,
}

/// Ranges of variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranges(pub Vec<[f64; 2]>);

/// `cognate project`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate project here --onto x,y")]
pub struct Project {
    /// Components.
    #[command(flatten)]
    pub set: SetArguments,
    /// Variables of the image: \"x,y\"
    #[arg(long, value_name = "VARIABLES", value_delimiter = ',')]
    pub onto: Vec<String>,
}

/// `cognate intersect`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate intersect here plane.bertini --output curve      by further equations
  cognate intersect here there --output points             by components
  cognate intersect here here --component 2.1 --other 1.2  two of the same")]
pub struct Intersect {
    /// Components.
    #[command(flatten)]
    pub set: SetArguments,
    /// Other components, in any of the forms of SET, or a file with equations in the same variables
    #[arg(value_name = "SET|FILE", help_heading = None)]
    pub second: PathBuf,
    /// Of other components only these, such as 1.2; may be given several times [default: all]
    #[arg(long = "other", value_name = "ID", value_parser = id)]
    pub others: Vec<ComponentId>,
}

/// `cognate multidegree`, `certify`, `singular-locus` and `real-points`.
#[derive(Clone, Debug, Args)]
pub struct Plain {
    /// Components.
    #[command(flatten)]
    pub set: SetArguments,
}

/// `cognate real-curve`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate real-curve here --component 1.1 --output curve && open curve/curve.svg
  cognate real-curve here --box=-2..2 --certify   inside a box, with proofs")]
pub struct RealCurve {
    /// Components.
    #[command(flatten)]
    pub set: SetArguments,
    /// Points of each arc on either side of its middle
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub samples: u32,
    /// Take more points until arcs are not farther than this from the lines between them, in the units of the variables
    #[arg(long, value_name = "E", value_parser = positive)]
    pub tolerance: Option<f64>,
    /// The two variables that curve.svg shows [default: the first two]; of a pair of conjugates real and imaginary part
    #[arg(long, value_name = "X,Y", value_delimiter = ',')]
    pub axes: Vec<String>,
    /// The variable whose values divide the curve; of a pair of conjugates its real part [default: a random real form]
    #[arg(long, value_name = "X")]
    pub projection: Option<String>,
    /// Only what lies between two numbers for each variable: "0..1,-1..1", or a range for all of them; of a pair of
    /// conjugates the first range is for the real part, the second for the imaginary part
    #[arg(long = "box", value_name = "LOW..HIGH,...", value_parser = ranges, allow_hyphen_values = true)]
    pub within: Option<Ranges>,
    /// Prove how many real branches there are over each slab between two critical values
    #[arg(long)]
    pub certify: bool,
}

/// `cognate real-surface`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate real-surface here --component 2.1 --output surface \\
      && open surface/surface.html")]
pub struct RealSurface {
    /// Components.
    #[command(flatten)]
    pub set: SetArguments,
    /// Sections between two levels on either side of a middle, and points of each strip of a section
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=50))]
    pub samples: u32,
}

/// `cognate mobility`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate mobility here --at points.csv")]
pub struct Mobility {
    /// Components.
    #[command(flatten)]
    pub set: SetArguments,
    /// Points: CSV with a header of variables, JSON, or solutions.jsonl; fractions are exact
    #[arg(long = "at", value_name = "FILE")]
    pub points: PathBuf,
    /// The error of each point relative to its size [default: as their digits say]
    #[arg(long, value_name = "E", value_parser = accuracy)]
    pub accuracy: Option<f64>,
    /// Highest order of motions that is asked
    #[arg(long, value_name = "K", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=20))]
    pub depth: u32,
}

/// `cognate exceptional`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate exceptional lines_on_a_quadric.json --fibre-dimension 1
  cognate exceptional -e \"parameters: p\" -e \"p*x = 0\" --fibre-dimension 1
  cognate exceptional family.json --fibre-dimension 1 --copies 4 --output here

Products with 1, 2, ... copies of the variables are decomposed. A component whose image in the parameters has too high \
a dimension to be cut out by so many general linear spaces is of an exceptional set; when all are, no other is missing.
Of sets inside others, over which the dimension is higher still, some may be listed, too; a higher H finds all of them.")]
pub struct Exceptional {
    /// The family: a system with parameters, in any notation that has them.
    #[command(flatten)]
    pub system: SystemSource,
    /// Sets of parameters are wanted over which the solutions have at least this dimension
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub fibre_dimension: u32,
    /// Copies of the variables in the first product that is decomposed
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub copies: u32,
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
    /// Also write exceptional.json here, and the components of each product as a SET
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub output: Option<PathBuf>,
    /// How progress is shown until the answer is there.
    #[command(flatten)]
    pub progress: ProgressArguments,
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    match value.is_finite() && value > 0.0 {
        true => Ok(value),
        false => Err("expected a positive number".into()),
    }
}

fn accuracy(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    match (0.0..0.5).contains(&value) {
        true => Ok(value),
        false => Err("expected a number from 0 to 0.5".into()),
    }
}

fn ranges(text: &str) -> Result<Ranges, String> {
    let range = |part: &str| {
        let expected = || format!("`{part}`: expected two numbers, such as -1..1");
        let (low, high) = part.split_once("..").ok_or_else(expected)?;
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| expected());
        let (low, high) = (number(low)?, number(high)?);
        match low < high && low.is_finite() && high.is_finite() {
            true => Ok([low, high]),
            false => Err(expected()),
        }
    };
    let each = text.split(',').map(range).collect::<Result<_, String>>();
    each.map(Ranges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read() {
        let coordinate_ranges = ranges("0..1,-2.5..-1e-3").unwrap();
        assert_eq!(coordinate_ranges, Ranges(vec![[0.0, 1.0], [-2.5, -1e-3]]));
        assert!(ranges("1..0").is_err() && ranges("0..inf").is_err() && ranges("3").is_err());
    }
}
