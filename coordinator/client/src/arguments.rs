//! The command line: every command and option of `cognate`, with its help.
//!
//! A command or option that this version does not have is refused here by name, so that nothing is ignored silently.

pub use super::common_arguments::{
    AnswerFormat, Format, OutputArguments, OwnOrRunning, PresetName, ProgressArguments,
    ProgressForm, ServiceArguments, Shown,
};
pub use super::fleet::arguments::{Fleet, FleetSlurm};
use super::mechanism::arguments::MechanismCommand;
use super::notation::Notation;
use super::objective::ObjectiveArguments;
pub use super::problem_arguments::ProblemArguments;
use super::problem_arguments::{MACHINES, precision};
use super::selection::SelectionArguments;
use super::sets::arguments as sets;
pub use super::shell_arguments::{Completions, Manual, Top};
use super::synthesis::arguments::Synthesize;
use super::system_source::SystemSource;
use clap::builder::Styles;
use clap::builder::styling::{AnsiColor, Effects};
use clap::{Args, Parser, Subcommand, ValueEnum};
use cognate_protocol::submission::PrecisionChoice;
use cognate_solutions::witness::Method;
use std::path::PathBuf;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().effects(Effects::BOLD))
    .usage(AnsiColor::Green.on_default().effects(Effects::BOLD))
    .literal(AnsiColor::Cyan.on_default().effects(Effects::BOLD))
    .placeholder(AnsiColor::Cyan.on_default());

/// Finds all solutions of a system of polynomial equations, on as many machines as there are.
#[derive(Debug, Parser)]
#[command(
    name = "cognate",
    version,
    styles = STYLES,
    propagate_version = true,
    max_term_width = 100,
    after_help = "\
Examples:
  cognate solve system.bertini                solve here, with two local workers
  cognate coordinator --ledger sqlite:jobs.db start the service
  cognate worker --coordinator http://head:7654
  cognate submit system.bertini | xargs cognate watch

Exit codes: 0 solved, 1 solved but something is not settled, 2 bad input,
            3 the service could not be reached or gave up, 4 cancelled,
            130 interrupted"
)]
pub struct Arguments {
    /// The subcommand.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve a system here: a coordinator and workers for this one problem
    Solve(Solve),
    /// Solve systems that come as lines of JSON, until the end of the input; for programs
    #[command(after_help = "\
A line is an object with the arguments of `cognate solve`, and an id that the answer repeats:
  {\"arguments\": [\"-e\", \"x^2 = 2\", \"--certify\"], \"id\": 1}
Its answer is a line with `exit_code`, and `summary` and `solutions`, or `error`.

Examples:
  cognate serve < systems.jsonl > answers.jsonl")]
    Serve,
    /// The contents of a file and the cost of each start; solves nothing
    Info(Info),
    /// A system in another notation
    Convert(Convert),
    /// Every irreducible component of every dimension, with its degree and multiplicity
    Decompose(Decompose),
    /// On which components points lie
    Member(sets::Member),
    /// Points of components
    Sample(sets::Sample),
    /// Dimension and degree of the images of components
    Project(sets::Project),
    /// Degrees of components by groups of variables
    #[command(after_help = "Examples:\n  cognate multidegree here --component 2.1")]
    Multidegree(sets::Plain),
    /// In how many directions points can be moved
    Mobility(sets::Mobility),
    /// Which witness points of components are proved
    #[command(after_help = "Examples:\n  cognate certify here --format json")]
    Certify(sets::Plain),
    /// Loops, arcs and singular points of real curves
    RealCurve(sets::RealCurve),
    /// At least one point on every connected part of the real points of components
    #[command(after_help = "Examples:\n  cognate real-points here --output points")]
    RealPoints(sets::Plain),
    /// The real part of components of dimension 2 in space: triangles, Euler characteristic, pictures
    RealSurface(sets::RealSurface),
    /// The intersection of components with other components, or with the solutions of further equations
    Intersect(sets::Intersect),
    /// Where the equations lose rank on components
    #[command(after_help = "Examples:\n  cognate singular-locus here --output there")]
    SingularLocus(sets::Plain),
    /// Values of a family's parameters over which its solutions have a higher dimension, by fibre products
    Exceptional(sets::Exceptional),
    /// One path again, step by step
    Path(TracePath),
    /// Run the service that plans jobs and hands out their paths
    Coordinator(Coordinator),
    /// Whether all that a service remembers is there and whole, and what is there that nothing names
    Fsck(Fsck),
    /// Copy what a service remembers, also while it runs
    Backup(Backup),
    /// Run a worker that tracks paths for a coordinator
    Worker(Worker),
    /// Hand a system to a coordinator; prints the job's id
    Submit(Submit),
    /// Follow a job until it ends
    #[command(after_help = "Examples:\n  cognate watch JOB")]
    Watch(Watch),
    /// The results of a job
    Results(Results),
    /// How a job's numbers came about: stages, retries, reasons of failure
    #[command(after_help = "Examples:\n  cognate explain JOB")]
    Explain(OneJob),
    /// Stop a job
    #[command(after_help = "Examples:\n  cognate cancel JOB")]
    Cancel(OneJob),
    /// Remove jobs that have ended, with all that only they need
    #[command(after_help = "Examples:\n  cognate delete JOB\n  cognate delete JOB --cancel-first")]
    Delete(Delete),
    /// All jobs of a coordinator
    #[command(
        after_help = "Examples:\n  cognate jobs\n  cognate jobs --coordinator http://head:7654 --format json"
    )]
    Jobs(Listing),
    /// All workers of a coordinator
    #[command(after_help = "Examples:\n  cognate workers")]
    Workers(Listing),
    /// Jobs, workers and rates of a coordinator as they change; q ends it
    Top(Top),
    /// The script with which a shell completes commands and options
    Completions(Completions),
    /// The manual page, or those of all commands
    Man(Manual),
    /// From points to all linkages that pass them
    #[command(subcommand)]
    Synthesize(Synthesize),
    /// Arms, platforms and linkages: from links and joints to all positions
    #[command(subcommand)]
    Mechanism(MechanismCommand),
    /// As many workers in a batch system as the backlog asks for
    #[command(subcommand)]
    Fleet(Fleet),
}

/// `cognate solve`.
#[derive(Clone, Debug, Args)]
// An objective alone is a problem, too: its critical points.
#[command(mut_group("SystemSource", |source| source.required(false)))]
#[group(required = true, multiple = true, args = ["file", "equation", "minimize", "maximize", "critical"])]
#[command(after_help = "\
Examples:
  cognate solve system.bertini
  cognate solve -e \"x^2 + y^2 = 5\" -e \"x*y = 2\"
  cognate solve system.txt --where \"x > 0 and y < 2*x\" --format csv
  cognate solve -e \"x^2 + 3*y^2 = 1\" --minimize \"(x - 2)^2 + y^2\"
  cognate solve --minimize \"(x^2 - 1)^2 + y^2 - x*y\"
  cognate solve system.phc --workers 4 --format json > summary.json
  cognate solve three_rpr.bertini --conjugates \"p~P,t1~T1,t2~T2,t3~T3,g~G\"
  cognate solve family.json --targets \"omega=linspace(0.5, 2, 100)\" \\
      --output here
  cognate solve family.bertini --start-solutions solutions.jsonl \\
                --start-parameters start.json --targets wanted.json")]
pub struct Solve {
    /// The file, its format, and what of the answer is known.
    #[command(flatten)]
    pub problem: ProblemArguments,
    /// Local worker processes [default: none for a tenth of a second, then 2]
    #[arg(help_heading = MACHINES, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=256))]
    pub workers: Option<u32>,
    /// Threads of each worker [default: cores / workers]
    #[arg(help_heading = MACHINES, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// A page for browsers that shows this solve; the command then stays until it is interrupted
    #[arg(help_heading = MACHINES, long, value_name = "ADDR", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:0")]
    pub page: Option<String>,
    /// The objective on the solutions.
    #[command(flatten)]
    pub objective: ObjectiveArguments,
    /// The solutions that are wanted.
    #[command(flatten)]
    pub selection: SelectionArguments,
    /// Files and format of the answer.
    #[command(flatten)]
    pub output: OutputArguments,
    /// How progress is shown until the answer is there.
    #[command(flatten)]
    pub progress: ProgressArguments,
}

/// A range of dimensions, as typed: `1`, or `0..2` with both ends.
fn dimensions(text: &str) -> Result<Dimensions, String> {
    let read = |part: &str| part.parse::<u32>().ok();
    let range = match text.split_once("..") {
        Some((lowest, highest)) => read(lowest).zip(read(highest)),
        None => read(text).map(|only| (only, only)),
    };
    let range = range.filter(|(lowest, highest)| lowest <= highest);
    let (lowest, highest) = range
        .ok_or_else(|| "expected a dimension such as 1, or a range such as 0..2".to_owned())?;
    Ok(Dimensions { lowest, highest })
}

/// Dimensions of components, from the lowest to the highest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimensions {
    /// The lowest.
    pub lowest: u32,
    /// The highest.
    pub highest: u32,
}

/// Which components are wanted.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Components")]
pub struct ComponentArguments {
    /// Dimensions of the components that are wanted: D or D..E [default: all]
    #[arg(long, value_name = "D|D..E", value_parser = dimensions)]
    pub dimension: Option<Dimensions>,
    /// Loops in a row that bring no witness points together before these stay apart [default: 12]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=200))]
    pub loops: Option<u32>,
    /// How witness points are found: equation by equation, by a cascade of combinations, or dimension by
    /// dimension on slices; auto takes the equations, and the cascade where these leave doubts
    #[arg(long, value_enum, default_value_t)]
    pub method: MethodName,
    /// Find the components a second way, too, and compare: what differs is not settled
    #[arg(long)]
    pub verify: bool,
    /// Leave the witness points of each dimension together; it is still said whether some are missing
    #[arg(long)]
    pub no_split: bool,
}

impl ComponentArguments {
    /// Whether any of them was typed.
    pub fn are_given(&self) -> bool {
        self.dimension.is_some()
            || self.loops.is_some()
            || self.method != MethodName::Auto
            || self.verify
            || self.no_split
    }
}

/// How witness points are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// By the equations, and by the cascade where these leave doubts
    #[default]
    Auto,
    /// Each dimension by itself, on its slices
    Slices,
    /// General combinations of the equations, one after the other
    Cascade,
    /// The equations themselves, one after the other
    Equations,
}

impl MethodName {
    /// The way that is asked for; `None`: the coordinator chooses.
    pub fn method(self) -> Option<Method> {
        match self {
            Self::Auto => None,
            Self::Slices => Some(Method::Slices),
            Self::Cascade => Some(Method::Cascade),
            Self::Equations => Some(Method::Equations),
        }
    }
}

/// `cognate decompose`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate decompose twisted_cubic.bertini
  cognate decompose system.bertini --verify
  cognate decompose system.bertini --dimension 1..2 --format json \\
      | jq .decomposition.components
  cognate decompose system.bertini --output here \\
      && jq -c .variables here/witness_points.jsonl
  cognate decompose --resume here --add more.bertini --output there")]
pub struct Decompose {
    /// A system: equations, one a line, Bertini-classic input, PHCpack format or JSON, told apart by content; - is standard input
    #[arg(help_heading = None, required_unless_present_any = ["resume", "equation"])]
    pub file: Option<PathBuf>,
    /// An equation, instead of a file; once for each: -e "x^2 + y^2 = 1" -e "x = y"
    #[arg(short = 'e', long = "equation", value_name = "EQUATION", allow_hyphen_values = true, help_heading = "Problem",
        conflicts_with_all = ["file", "resume"])]
    pub equation: Vec<String>,
    /// Components that were found before, of which --add cuts: the folder of --output, or the id of a job of
    /// --coordinator
    #[arg(long, value_name = "SET", requires = "add", help_heading = "Problem",
        conflicts_with_all = ["file", "target_parameters", "groups", "seed", "exact", "precision"])]
    pub resume: Option<PathBuf>,
    /// Equations in the same variables: all components of the system of --resume with these
    #[arg(
        long,
        value_name = "FILE",
        requires = "resume",
        conflicts_with = "file",
        help_heading = "Problem"
    )]
    pub add: Option<PathBuf>,
    /// The components of a decomposition that are meant.
    #[command(flatten)]
    pub components: ComponentArguments,
    /// Prove every witness point by a box, and which unions of them are no components
    #[arg(long, help_heading = "Components")]
    pub certify: bool,
    /// Generators of a symmetry group (JSON): components are told by orbits, and one of each orbit is split
    #[arg(
        long,
        value_name = "FILE",
        help_heading = "Problem",
        conflicts_with = "resume"
    )]
    pub symmetry: Option<PathBuf>,
    /// Values of the parameters, as `cognate solve` takes them. Of several sets each is decomposed, from components at
    /// general values, and it is said where the list of components changes, which split and which join
    #[arg(
        long = "targets",
        alias = "target-parameters",
        value_name = "FILE|NAME=VALUES",
        help_heading = "Problem"
    )]
    pub target_parameters: Vec<PathBuf>,
    /// Variable groups instead of those in the file: "x,y;z,w"
    #[arg(long, value_name = "GROUPS", help_heading = "Problem")]
    pub groups: Option<String>,
    /// Seed of everything random; the same seed gives the same bits [default: made from the problem]
    #[arg(long, value_name = "N", help_heading = "Problem")]
    pub seed: Option<u64>,
    /// How cautiously paths are followed
    #[arg(long, value_enum, default_value_t, help_heading = "Problem")]
    pub preset: PresetName,
    /// Arithmetic of the paths: double-doubles for paths that need them, doubles only, or at least this number of bits
    #[arg(long, value_name = "adaptive|double|BITS", default_value = "adaptive", value_parser = precision, help_heading = "Problem")]
    pub precision: PrecisionChoice,
    /// Decimals of 8 and more significant digits are exact, not rounded to half a unit of the last digit
    #[arg(long, help_heading = "Problem")]
    pub exact: bool,
    /// Let the paths alone decide, without counts of solutions by elimination over a prime field
    #[arg(long, help_heading = "Problem")]
    pub no_exact_count: bool,
    /// A coordinator of the command's own, or one that runs.
    #[command(flatten)]
    pub service: OwnOrRunning,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: AnswerFormat,
    /// Also write the files that `cognate member` and others read, and Bertini's input, witness_data and main_data,
    /// here
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub output: Option<PathBuf>,
    /// How progress is shown until the answer is there.
    #[command(flatten)]
    pub progress: ProgressArguments,
}

impl Decompose {
    /// The system with its options, as those of a solve.
    pub fn problem(&self) -> ProblemArguments {
        ProblemArguments {
            system: SystemSource {
                file: self.file.clone(),
                equation: self.equation.clone(),
                content: None,
            },
            target_parameters: self.target_parameters.clone(),
            groups: self.groups.clone(),
            symmetry: self.symmetry.clone(),
            seed: self.seed,
            certify: self.certify,
            preset: self.preset,
            precision: self.precision,
            exact: self.exact,
            no_exact_count: self.no_exact_count,
            ..ProblemArguments::default()
        }
    }

    /// Files and format of the answer.
    pub fn output(&self) -> OutputArguments {
        OutputArguments {
            format: self.format,
            output: self.output.clone(),
            show: None,
            axes: Vec::new(),
        }
    }
}

/// `cognate info`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate info system.bertini
  cognate info system.bertini --decompose
  cognate info system.bertini --groups \"x,y;z,w\" --format json")]
pub struct Info {
    /// The system.
    #[command(flatten)]
    pub system: SystemSource,
    /// Variable groups instead of those in the file: "x,y;z,w"
    #[arg(long, value_name = "GROUPS")]
    pub groups: Option<String>,
    /// Sets of variables for the linear-product start instead of those that are found (JSON)
    #[arg(long, value_name = "FILE")]
    pub sets: Option<PathBuf>,
    /// The cost of each method that finds all irreducible components, instead of each start
    #[arg(long)]
    pub decompose: bool,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// `cognate convert`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate convert system.bertini --to json
  cognate convert system.phc --to bertini > system.bertini

What a notation has no words for is refused, or named in a warning where it is only left out.
Numbers are written as exact fractions.")]
pub struct Convert {
    /// A system: equations, one a line, Bertini-classic input, PHCpack format, JSON, Macaulay2, Maple, Singular or msolve, told
    /// apart by content; - is standard input
    #[arg(required_unless_present_any = ["schema", "equation"])]
    pub file: Option<PathBuf>,
    /// An equation, instead of a file; once for each
    #[arg(
        short = 'e',
        long = "equation",
        value_name = "EQUATION",
        allow_hyphen_values = true,
        conflicts_with = "file"
    )]
    pub equation: Vec<String>,
    /// The notation that is written to standard output
    #[arg(
        long,
        value_enum,
        value_name = "NOTATION",
        required_unless_present = "schema"
    )]
    pub to: Option<Notation>,
    /// Print the JSON Schema of our JSON instead
    #[arg(long, conflicts_with_all = ["file", "equation", "to"])]
    pub schema: bool,
}

/// `cognate path`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate path system.bertini --index 17            how path 17 ends
  cognate path system.bertini --index 17 --trace    every step, and path_17.svg")]
pub struct TracePath {
    /// The file, its format, and what of the answer is known.
    #[command(flatten)]
    pub problem: ProblemArguments,
    /// The path's number, as results show it
    #[arg(long, value_name = "N")]
    pub index: u64,
    /// Every step as a table, and a drawing
    #[arg(long)]
    pub trace: bool,
    /// Where the drawing goes [default: path_N.svg]
    #[arg(long, value_name = "FILE", requires = "trace")]
    pub svg: Option<PathBuf>,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// `cognate coordinator`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate coordinator
  cognate coordinator --listen unix:/run/cognate.sock --listen 127.0.0.1:7654 \\
      --ledger sqlite:/var/lib/cognate/ledger.db \\
      --results /var/lib/cognate/results

It can be killed at any moment and started again on the same ledger: jobs go on.")]
pub struct Coordinator {
    /// Addresses to listen on: HOST:PORT or unix:PATH, one or several [default: 127.0.0.1:7654]
    #[arg(long, value_name = "ADDR", num_args = 1..)]
    pub listen: Vec<String>,
    /// Place of the ledger: sqlite:PATH or postgres://USER@HOST/DATABASE [default: sqlite:cognate-data/ledger.db]
    #[arg(long, value_name = "URL")]
    pub ledger: Option<String>,
    /// Where results are kept: a folder, or s3://BUCKET/PREFIX with keys in the environment [default:
    /// cognate-data/results]
    #[arg(long, value_name = "PLACE")]
    pub results: Option<String>,
    /// Settings as a file; options on the command line win
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Serve addresses beyond this machine without asking anybody who they are
    #[arg(long)]
    pub insecure: bool,
    /// Where Prometheus reads metrics, and probes ask /live and /ready, by plain HTTP: HOST:PORT [default: nowhere]
    #[arg(long, value_name = "ADDR")]
    pub metrics: Option<String>,
    /// A collector of OpenTelemetry that traces of jobs are handed to: http://HOST:PORT [default: none]
    #[arg(long, value_name = "URL")]
    pub traces: Option<String>,
    /// How the log is written to standard error
    #[arg(long, value_enum, default_value_t)]
    pub log_format: cognate_worker::log::LogFormat,
    /// A file to which is added, as lines of JSON, who submitted, cancelled, deleted and was refused [default: none]
    #[arg(long, value_name = "FILE")]
    pub audit_log: Option<PathBuf>,
    /// A page for browsers, with jobs, workers and results: HOST:PORT, such as 127.0.0.1:7655 [default: nowhere]
    #[arg(long, value_name = "ADDR")]
    pub page: Option<String>,
    /// A file with the own certificate chain (PEM): all TCP addresses then speak TLS
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    pub tls_certificate: Option<PathBuf>,
    /// A file with the private key (PEM)
    #[arg(long, value_name = "FILE", requires = "tls_certificate")]
    pub tls_key: Option<PathBuf>,
    /// A file with the authority (PEM) whose certificates callers must have
    #[arg(long, value_name = "FILE", requires = "tls_certificate")]
    pub tls_client_ca: Option<PathBuf>,
    /// A file with the tokens that TCP callers must have: lines of `client TOKEN` or `worker TOKEN`, to which may be added name=, tenant= and limits (deploy/README.md)
    #[arg(long, value_name = "FILE")]
    pub token_file: Option<PathBuf>,
    /// Delete jobs that ended more than this number of days ago [default: 0, never]
    #[arg(long, value_name = "N")]
    pub retain_days: Option<f64>,
}

/// `cognate worker`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate worker --coordinator http://head:7654 --threads 16

Workers join and leave at any moment; Ctrl-C gives back what is unfinished.")]
pub struct Worker {
    /// Arguments that the worker itself reads.
    #[command(flatten)]
    pub worker: cognate_worker::config::Arguments,
}

/// `cognate submit`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate submit system.bertini
  job=$(cognate submit system.bertini) && cognate watch $job \\
      && cognate results $job")]
pub struct Submit {
    /// The file, its format, and what of the answer is known.
    #[command(flatten)]
    pub problem: ProblemArguments,
    /// All irreducible components instead of isolated solutions, as `cognate decompose` finds them
    #[arg(long, help_heading = "Components")]
    pub decompose: bool,
    /// The components of a decomposition that are meant.
    #[command(flatten)]
    pub components: ComponentArguments,
    /// The coordinator that is asked.
    #[command(flatten)]
    pub service: ServiceArguments,
    /// Chosen by the caller: the same id sent twice is one job
    #[arg(long, value_name = "ID", help_heading = "Service")]
    pub request_id: Option<String>,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: Format,
}

/// `cognate watch`.
#[derive(Clone, Debug, Args)]
pub struct Watch {
    /// The job that is meant.
    #[command(flatten)]
    pub job: OneJob,
    /// How progress is shown until the answer is there.
    #[command(flatten)]
    pub progress: ProgressArguments,
}

/// `cognate watch`, `explain`, `cancel`.
#[derive(Clone, Debug, Args)]
pub struct OneJob {
    /// The job's id, as `submit` printed it
    pub job: String,
    /// The coordinator that is asked.
    #[command(flatten)]
    pub service: ServiceArguments,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: Format,
}

/// `cognate delete`.
#[derive(Clone, Debug, Args)]
pub struct Delete {
    /// Ids of the jobs
    #[arg(required = true, value_name = "JOB")]
    pub jobs: Vec<String>,
    /// Stop a job that goes on; without, it is refused
    #[arg(long)]
    pub cancel_first: bool,
    /// The coordinator that is asked.
    #[command(flatten)]
    pub service: ServiceArguments,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: Format,
}

/// Places where a coordinator on this machine keeps its ledger and results.
#[derive(Clone, Debug, Args)]
pub struct DataArguments {
    /// Place of the ledger: sqlite:PATH or postgres://USER@HOST/DATABASE
    #[arg(
        long,
        value_name = "URL",
        default_value = "sqlite:cognate-data/ledger.db"
    )]
    pub ledger: String,
    /// Where results are kept: a folder, or s3://BUCKET/PREFIX
    #[arg(long, value_name = "PLACE", default_value = "cognate-data/results")]
    pub results: String,
}

/// `cognate fsck`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate fsck
  cognate fsck --ledger sqlite:jobs.db --results results --repair

The coordinator may run or not. Exit code 1: an object that is needed is missing or damaged, and was not made again.")]
pub struct Fsck {
    /// Ledger and results.
    #[command(flatten)]
    pub data: DataArguments,
    /// Track chunks again whose results are lost and whose job has ended, and remove what no row names, if it is
    /// not younger than a running coordinator's work
    #[arg(long)]
    pub repair: bool,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: Format,
}

/// `cognate backup`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate backup copy --ledger sqlite:jobs.db --results results

A coordinator goes on from the copy: --ledger sqlite:DIR/ledger.db --results DIR/results.
Exit code 1: an object that is needed is missing or damaged in the copy.")]
pub struct Backup {
    /// A folder that is made for the copy
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Ledger and results.
    #[command(flatten)]
    pub data: DataArguments,
}

/// `cognate results`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate results JOB
  cognate results JOB --format json | jq .paths
  cognate results JOB --where \"x > 0\" --format csv
  cognate results JOB --output here && jq -c .variables here/solutions.jsonl")]
pub struct Results {
    /// The job's id, as `submit` printed it
    pub job: String,
    /// The coordinator that is asked.
    #[command(flatten)]
    pub service: ServiceArguments,
    /// The solutions that are wanted.
    #[command(flatten)]
    pub selection: SelectionArguments,
    /// Files and format of the answer.
    #[command(flatten)]
    pub output: OutputArguments,
}

/// `cognate jobs`, `cognate workers`.
#[derive(Clone, Debug, Args)]
pub struct Listing {
    /// The coordinator that is asked.
    #[command(flatten)]
    pub service: ServiceArguments,
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t, help_heading = "Output")]
    pub format: Format,
}
