//! The command line of `cognate fleet`.

use crate::common_arguments::ServiceArguments;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// `cognate fleet`.
#[derive(Clone, Debug, Subcommand)]
pub enum Fleet {
    /// In Slurm
    Slurm(FleetSlurm),
}

/// `cognate fleet slurm`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Examples:
  cognate fleet slurm --max 20 --coordinator https://head:7654 \\
      --token-file tokens
  cognate fleet slurm --min 1 --max 200 --time 8:00:00 -- --partition=long \\
      --account=physics

It submits arrays of workers and takes back those that have not begun and need not; workers that run \
end by themselves. It may be stopped and started again: what stands, Slurm knows.")]
pub struct FleetSlurm {
    /// Number of workers that stay even when there is nothing to do
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    pub min: u32,
    /// Largest number of workers
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub max: u32,
    /// Seconds in which the backlog is to be done
    #[arg(long, value_name = "SECONDS", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub finish_within: u64,
    /// Seconds between two looks
    #[arg(long, value_name = "SECONDS", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=3600))]
    pub every: u64,
    /// One look, and what follows from it, and end: for cron
    #[arg(long)]
    pub once: bool,
    /// How long a worker may run, as `sbatch --time` takes it; it stops pulling in time
    #[arg(long, value_name = "TIME", default_value = "04:00:00")]
    pub time: String,
    /// Seconds without work after which a worker ends
    #[arg(long, value_name = "SECONDS", default_value_t = 120, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub idle_timeout: u64,
    /// Name of the fleet's jobs in Slurm; two fleets of one user need two
    #[arg(long, value_name = "NAME", default_value = "cognate-fleet")]
    pub name: String,
    /// Folder for the workers' logs, as the nodes see it
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub logs: PathBuf,
    /// The program, as the nodes see it [default: this one]
    #[arg(long, value_name = "FILE")]
    pub program: Option<PathBuf>,
    /// The coordinator that is asked.
    #[command(flatten)]
    pub service: ServiceArguments,
    /// The coordinator's address, as the nodes see it [default: the same]
    #[arg(long, value_name = "URL")]
    pub for_workers: Option<String>,
    /// The workers' token, as the nodes see it [default: the same file]
    #[arg(long, value_name = "FILE")]
    pub worker_token_file: Option<PathBuf>,
    /// More arguments of `sbatch`, after `--`: partition, account, memory
    #[arg(last = true, value_name = "SBATCH")]
    pub sbatch: Vec<String>,
}
