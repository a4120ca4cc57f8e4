//! Config: where the worker finds its coordinator and how much of the machine it uses.
//!
//! `Arguments` is what people type (`cognate worker` and `cognate-worker` share
//! it); `Config` is the same, checked. Every number with unit, default and reason.

use crate::log::LogFormat;
use crate::machine::Machine;
use crate::transport::address::Address;
use crate::transport::connect::{CredentialError, CredentialFiles, Credentials, Role};
use std::str::FromStr;
use std::time::Duration;

/// How many paths one core follows at once. Results are the same at every width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaneWidth {
    /// One: for tests that compare widths.
    One,
    /// Eight: for systems whose program and matrix are large.
    Eight,
    /// Sixteen: fastest where program and matrix fit in about 64 KB.
    Sixteen,
}

impl LaneWidth {
    /// The number of lanes.
    pub fn lanes(self) -> usize {
        match self {
            Self::One => 1,
            Self::Eight => 8,
            Self::Sixteen => 16,
        }
    }
}

impl FromStr for LaneWidth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "1" => Ok(Self::One),
            "8" => Ok(Self::Eight),
            "16" => Ok(Self::Sixteen),
            _ => Err(format!("`{text}` is no lane width; expected 1, 8 or 16")),
        }
    }
}

/// By which way chunks and results travel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum TransportChoice {
    /// Shared memory where coordinator and worker have host, user and /dev/shm in common, else gRPC.
    #[default]
    Auto,
    /// gRPC over TCP or a Unix socket.
    Grpc,
    /// Shared memory on one host. Where it cannot be used, the log says why, and gRPC is used.
    SharedMemory,
}

/// Command-line arguments of `cognate worker`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Where the coordinator listens: http://host:port, host:port or unix:/path; several are tried in turn
    #[arg(long, value_name = "URL", env = "COGNATE_COORDINATOR", value_delimiter = ',', required = true, num_args = 1..)]
    pub coordinator: Vec<Address>,
    /// Way by which chunks and results travel
    #[arg(long, value_enum, default_value_t)]
    pub transport: TransportChoice,
    /// Token and certificates.
    #[command(flatten)]
    pub credentials: CredentialFiles,
    /// Threads that track paths [default: all cores]
    #[arg(long, value_name = "N")]
    pub threads: Option<std::num::NonZeroUsize>,
    /// Paths that one thread follows at once: 1, 8 or 16; results do not depend on it [default: chosen for each system]
    #[arg(long, value_name = "W")]
    pub lane_width: Option<LaneWidth>,
    /// Seconds after which the worker must have ended (its time limit in a batch system)
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub wall_time: Option<Duration>,
    /// End after so many seconds without work [default: never]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub idle_timeout: Option<Duration>,
    /// End after so many seconds without reaching a coordinator [default: never]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub give_up_after: Option<Duration>,
    /// How the log is written to standard error
    #[arg(long, value_enum, default_value_t)]
    pub log_format: LogFormat,
}

/// A time in seconds, as people type it.
fn seconds(text: &str) -> Result<Duration, String> {
    text.parse::<f64>()
        .ok()
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| format!("`{text}` is no number of seconds"))
}

/// Arguments that contradict this version or this machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// A worker without a coordinator has nothing to do.
    #[error("no coordinator is named; use --coordinator URL")]
    NoCoordinator,
    /// A token or a certificate that cannot be read.
    #[error(transparent)]
    Credentials(#[from] CredentialError),
}

/// How the worker runs.
#[derive(Clone, Debug)]
pub struct Config {
    /// Coordinators, tried in turn: any of them may answer.
    pub coordinators: Vec<Address>,
    /// By which way chunks and results travel. Default: shared memory where it can be used.
    pub transport: TransportChoice,
    /// Credentials that the worker shows to coordinators. Default: none.
    pub credentials: Credentials,
    /// Threads that track paths. Default: all cores.
    pub threads: usize,
    /// Paths that one thread follows at once. Default `None`: chosen for each system by
    /// `PreparedStage`, 16 where program and matrix fit in the cache, else 8.
    pub lane_width: Option<LaneWidth>,
    /// When the process must have ended, counted from its start. Default: never.
    pub wall_time: Option<Duration>,
    /// How long before the wall time no chunk is pulled any more. Default 30 s: chunks aim
    /// at 2 to 10 s of work, so that those already held can end.
    pub wind_up: Duration,
    /// Ends the worker after so long without work. Default: never.
    pub idle_timeout: Option<Duration>,
    /// Ends the worker after so long without reaching a coordinator. Default: never, since a
    /// coordinator may be restarted at any time.
    pub give_up_after: Option<Duration>,
    /// How long a draining worker tries to give back and report what it holds. Default 5 s:
    /// well within the grace that Slurm (30 s) and Kubernetes (30 s) leave after SIGTERM.
    pub drain_patience: Duration,
    /// Chunks held at once: one that is tracked and one that waits for its threads, so that
    /// no core idles during a pull. Default 2; more would starve other workers at the tail.
    pub chunks_at_once: usize,
    /// Finished chunks that may wait for their acknowledgement before pulling stops.
    /// Default 16: bounds memory while no coordinator answers.
    pub unacknowledged: usize,
    /// Prepared stages kept. Default 8: a job has a few open stages; each takes milliseconds
    /// to seconds to compile again.
    pub prepared_stages: usize,
    /// How long a pull may wait at the coordinator for work. Default 20 s: below the idle
    /// limits of common proxies (60 s), long enough not to be a load.
    pub poll: Duration,
    /// Largest message accepted, in bytes. Default 256 MiB: objects of start points are the
    /// largest; the library's own default of 4 MiB would refuse them.
    pub message_bytes: usize,
}

impl Config {
    /// The defaults, for one coordinator or several.
    pub fn new(coordinators: Vec<Address>) -> Self {
        Self {
            coordinators,
            transport: TransportChoice::Auto,
            credentials: Credentials::default(),
            threads: Machine::detect().cores,
            lane_width: None,
            wall_time: None,
            wind_up: Duration::from_secs(30),
            idle_timeout: None,
            give_up_after: None,
            drain_patience: Duration::from_secs(5),
            chunks_at_once: 2,
            unacknowledged: 16,
            prepared_stages: 8,
            poll: Duration::from_secs(20),
            message_bytes: 256 << 20,
        }
    }
}

impl TryFrom<Arguments> for Config {
    type Error = ConfigError;

    fn try_from(arguments: Arguments) -> Result<Self, ConfigError> {
        if arguments.coordinator.is_empty() {
            return Err(ConfigError::NoCoordinator);
        }
        let default = Self::new(arguments.coordinator);
        Ok(Self {
            transport: arguments.transport,
            credentials: Credentials::read(&arguments.credentials, Role::Worker)?,
            threads: arguments.threads.map_or(default.threads, usize::from),
            lane_width: arguments.lane_width,
            wall_time: arguments.wall_time,
            idle_timeout: arguments.idle_timeout,
            give_up_after: arguments.give_up_after,
            ..default
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(clap::Parser)]
    struct Command {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn read(line: &[&str]) -> Result<Config, String> {
        let words = std::iter::once("worker").chain(line.iter().copied());
        let command = Command::try_parse_from(words).map_err(|error| error.to_string())?;
        Config::try_from(command.arguments).map_err(|error| error.to_string())
    }

    #[test]
    fn arguments_become_a_config() {
        let config = read(&[
            "--coordinator",
            "unix:/a,h:2",
            "--threads",
            "3",
            "--lane-width",
            "8",
            "--wall-time",
            "1.5",
        ])
        .unwrap();
        assert_eq!(config.coordinators.len(), 2);
        assert_eq!(config.threads, 3);
        assert_eq!(config.lane_width, Some(LaneWidth::Eight));
        assert_eq!(config.wall_time, Some(Duration::from_millis(1500)));
        assert!(read(&["--coordinator", "h:2"]).unwrap().threads >= 1);
    }

    #[test]
    fn wrong_arguments_are_named() {
        let check = |line: &[&str], expected: &str| {
            let message = read(line).unwrap_err();
            assert!(message.contains(expected), "{message}");
        };
        check(&["--coordinator", "nowhere"], "expected http://host:port");
        check(
            &["--coordinator", "h:2", "--lane-width", "4"],
            "expected 1, 8 or 16",
        );
        check(
            &["--coordinator", "h:2", "--wall-time=-1"],
            "no number of seconds",
        );
        check(&["--coordinator", "h:2", "--threads", "0"], "--threads");
        check(
            &["--coordinator", "h:2", "--transport", "pigeon"],
            "shared-memory",
        );
    }
}
