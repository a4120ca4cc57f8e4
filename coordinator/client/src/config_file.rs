//! The coordinator's settings as a file (TOML): every field may be absent, unknown ones are refused.

use super::error::ClientError;
use super::problem;
use cognate_coordinator::chunks::leasing::Policy;
use cognate_coordinator::chunks::sizing::Sizing;
use cognate_coordinator::chunks::speculation::Speculation;
use cognate_coordinator::config::{Config, Rules};
use cognate_coordinator::results::retention::Retention;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

const HOUR: Duration = Duration::from_secs(3600);
/// Unit of `retain_days`.
pub const DAY: Duration = Duration::from_secs(24 * 3600);

/// Contents of a configuration file; an absent field keeps its default.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ConfigFile {
    /// Addresses to listen on.
    pub listen: Option<Vec<String>>,
    /// Address of the ledger: a file of SQLite, or a PostgreSQL database.
    pub ledger: Option<String>,
    /// Folder or bucket of the results.
    pub results: Option<String>,
    /// Serve addresses beyond this machine without asking anybody who they are.
    pub insecure: Option<bool>,
    /// The tokens that callers over TCP must have.
    pub token_file: Option<PathBuf>,
    /// The own certificate chain.
    pub tls_certificate: Option<PathBuf>,
    /// File of the private key that belongs to the certificate.
    pub tls_key: Option<PathBuf>,
    /// File of the authorities that sign the certificates of callers.
    pub tls_client_ca: Option<PathBuf>,
    /// Address at which metrics are served.
    pub metrics: Option<String>,
    /// Collector of traces.
    pub traces: Option<String>,
    /// File of who submitted, cancelled, deleted and was refused.
    pub audit_log: Option<PathBuf>,
    /// Address of the page for browsers.
    pub page: Option<String>,
    /// Workers on this host may use shared memory.
    pub shared_memory: Option<bool>,
    /// Free memory in /dev/shm below which shared memory is not used, in MiB.
    pub shared_memory_least_free_mib: Option<u64>,
    /// Times and limits.
    rules: RulesTable,
    /// Sizes of chunks.
    chunks: ChunksTable,
}

macro_rules! tables {
    ($(#[$meta:meta] $table:ident { $($field:ident: $kind:ty,)* })*) => {
        $(
            #[$meta]
            #[derive(Clone, Copy, Debug, Default, Deserialize)]
            #[serde(default, deny_unknown_fields)]
            struct $table {
                $($field: Option<$kind>,)*
            }
        )*
    };
}

tables! {
    /// The fields of `Rules` and `Policy`; times in seconds.
    RulesTable {
        lease_seconds: f64,
        steward_seconds: f64,
        expiry_interval_seconds: f64,
        long_poll_seconds: f64,
        worker_memory_seconds: f64,
        shutdown_grace_seconds: f64,
        keep_alive_seconds: f64,
        suspicion_limit: u32,
        split_into: u64,
        in_flight_limit: u32,
        audit_percent: u32,
        unchecked_audit_percent: u32,
        rework_percent: u32,
        speculation_times: u32,
        speculation_least_seconds: f64,
        held_paths: u64,
        counting_operations: u64,
        retain_days: f64,
        garbage_grace_hours: f64,
        garbage_interval_hours: f64,
    }
    /// The fields of `Sizing`.
    ChunksTable {
        longest_ms: u64,
        shared_ms: u64,
        shortest_ms: u64,
        first_items: u64,
        tail: u64,
        most_items: u64,
    }
}

impl ConfigFile {
    /// Reads a file; messages name the place.
    pub fn read(path: &Path) -> Result<Self, ClientError> {
        let (name, content) = problem::read_file(path)?;
        let wrong = |message: String| ClientError::Input {
            origin: name.clone(),
            message,
        };
        let text = String::from_utf8(content).map_err(|e| wrong(e.to_string()))?;
        toml::from_str(&text).map_err(|e| wrong(e.to_string().trim_end().to_string()))
    }

    /// Memory that must be free for shared memory, in bytes; `None` if shared memory is off.
    pub fn shared_memory_least_free(&self) -> Option<u64> {
        if self.shared_memory == Some(false) {
            return None;
        }
        match self.shared_memory_least_free_mib {
            Some(mib) => Some(mib.saturating_mul(1 << 20)),
            None => Config::default().shared_memory,
        }
    }

    fn retention(&self, default: Retention) -> Result<Retention, String> {
        let r = &self.rules;
        let ms = |name, asked: Option<f64>, unit, default| match asked {
            Some(asked) => age_ms(name, asked, unit),
            None => Ok(default),
        };
        let every = r
            .garbage_interval_hours
            .map(|hours| hours * HOUR.as_secs_f64());
        Ok(Retention {
            keep_ms: ms("retain_days", r.retain_days, DAY, default.keep_ms)?,
            grace_ms: ms(
                "garbage_grace_hours",
                r.garbage_grace_hours,
                HOUR,
                default.grace_ms,
            )?,
            every: time("garbage_interval_hours", every, default.every)?,
        })
    }

    /// The deadlines and limits, or which of them makes no sense.
    pub fn rules(&self) -> Result<Rules, String> {
        let (r, c) = (&self.rules, &self.chunks);
        let Rules {
            policy,
            long_poll,
            worker_memory,
            shutdown_grace,
            keep_alive,
            connections,
            calls,
            streams,
            uploads,
        } = Rules::default();
        let ms = Duration::from_millis;
        let in_ms = |name, asked, default| -> Result<u64, String> {
            let milliseconds = time(name, asked, ms(default))?.as_millis();
            Ok(u64::try_from(milliseconds).unwrap_or(u64::MAX))
        };
        let sizing = policy.sizing;
        Ok(Rules {
            policy: Policy {
                lease_ms: in_ms("lease_seconds", r.lease_seconds, policy.lease_ms)?,
                steward_ms: in_ms("steward_seconds", r.steward_seconds, policy.steward_ms)?,
                expiry_ms: in_ms(
                    "expiry_interval_seconds",
                    r.expiry_interval_seconds,
                    policy.expiry_ms,
                )?,
                suspicion_limit: number(
                    "suspicion_limit",
                    r.suspicion_limit,
                    policy.suspicion_limit,
                )?,
                split_into: number("split_into", r.split_into, policy.split_into)?,
                in_flight_limit: number(
                    "in_flight_limit",
                    r.in_flight_limit,
                    policy.in_flight_limit,
                )?,
                audit_percent: r.audit_percent.unwrap_or(policy.audit_percent).min(100),
                unchecked_audit_percent: r
                    .unchecked_audit_percent
                    .unwrap_or(policy.unchecked_audit_percent)
                    .min(100),
                check_results: policy.check_results,
                rework_percent: r.rework_percent.unwrap_or(policy.rework_percent).min(100),
                held_paths: r.held_paths.unwrap_or(policy.held_paths),
                counting_operations: r.counting_operations.unwrap_or(policy.counting_operations),
                planning: policy.planning,
                conduct: policy.conduct,
                retention: self.retention(policy.retention)?,
                speculation: Speculation {
                    times: r.speculation_times.unwrap_or(policy.speculation.times),
                    least_ms: in_ms(
                        "speculation_least_seconds",
                        r.speculation_least_seconds,
                        policy.speculation.least_ms,
                    )?,
                },
                sizing: Sizing {
                    longest_ms: number("longest_ms", c.longest_ms, sizing.longest_ms)?,
                    shared_ms: number("shared_ms", c.shared_ms, sizing.shared_ms)?,
                    shortest_ms: number("shortest_ms", c.shortest_ms, sizing.shortest_ms)?,
                    first_items: number("first_items", c.first_items, sizing.first_items)?,
                    tail: number("tail", c.tail, sizing.tail)?,
                    most_items: number("most_items", c.most_items, sizing.most_items)?,
                },
            },
            long_poll: time("long_poll_seconds", r.long_poll_seconds, long_poll)?,
            worker_memory: time(
                "worker_memory_seconds",
                r.worker_memory_seconds,
                worker_memory,
            )?,
            shutdown_grace: time(
                "shutdown_grace_seconds",
                r.shutdown_grace_seconds,
                shutdown_grace,
            )?,
            keep_alive: time("keep_alive_seconds", r.keep_alive_seconds, keep_alive)?,
            connections,
            calls,
            streams,
            uploads,
        })
    }
}

/// A time in these units, which may be 0, in milliseconds.
pub fn age_ms(name: &str, asked: f64, unit: Duration) -> Result<u64, String> {
    let time = Duration::try_from_secs_f64(asked * unit.as_secs_f64());
    let ms = time
        .ok()
        .and_then(|time| u64::try_from(time.as_millis()).ok());
    ms.ok_or_else(|| format!("{name} = {asked}; expected 0 or more"))
}

/// A time that is long enough to be one.
fn time(name: &str, asked: Option<f64>, default: Duration) -> Result<Duration, String> {
    let Some(seconds) = asked else {
        return Ok(default);
    };
    Duration::try_from_secs_f64(seconds)
        .ok()
        .filter(|time| *time >= Duration::from_millis(1))
        .ok_or_else(|| format!("{name} = {seconds}; expected at least 0.001"))
}

/// A number of which there must be one.
fn number<N: Copy + PartialEq + From<u8>>(
    name: &str,
    asked: Option<N>,
    default: N,
) -> Result<N, String> {
    match asked {
        Some(zero) if zero == N::from(0) => Err(format!("{name} = 0; expected at least 1")),
        Some(number) => Ok(number),
        None => Ok(default),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_that_is_shipped_says_the_defaults_and_all_of_them() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../deploy/config/cognate.toml");
        let file = ConfigFile::read(&path).expect("the shipped file is well formed");
        // Every field with a default stands there, so none is None.
        let without = [
            "token_file",
            "tls_certificate",
            "tls_key",
            "tls_client_ca",
            "metrics",
            "traces",
            "audit_log",
            "page",
        ];
        let mut said = format!("{file:?}");
        let text = std::fs::read_to_string(&path).expect("it was read before");
        for field in without {
            assert!(text.contains(&format!("# {field} = ")), "{field} is shown");
            said = said.replace(&format!("{field}: None"), "");
        }
        assert!(!said.contains("None"), "{said}");
        let default = Config::default();
        let listen: Vec<String> = default
            .listen
            .iter()
            .map(|a| a.to_string().trim_start_matches("http://").to_string())
            .collect();
        assert_eq!(file.listen, Some(listen));
        assert_eq!(file.insecure, Some(default.insecure));
        assert_eq!(
            file.ledger.as_deref().map(str::parse),
            Some(Ok(default.ledger))
        );
        let results = file.results.as_deref().and_then(|place| place.parse().ok());
        assert_eq!(results, default.results);
        assert_eq!(file.shared_memory_least_free(), default.shared_memory);
        let rules = file.rules().expect("the shipped rules make sense");
        assert_eq!(format!("{rules:?}"), format!("{:?}", Rules::default()));
    }

    #[test]
    fn what_makes_no_sense_is_named() {
        let read = |text: &str| toml::from_str::<ConfigFile>(text).map_err(|e| e.to_string());
        assert!(
            read("[rules]\nlaese_seconds = 1")
                .unwrap_err()
                .contains("laese_seconds")
        );
        let message = |text: &str| read(text).expect("well formed").rules().unwrap_err();
        assert!(message("[rules]\nlease_seconds = -1.0").contains("lease_seconds"));
        assert!(message("[rules]\nsplit_into = 0").contains("split_into"));
        let rules = read("[rules]\nlease_seconds = 5.0")
            .unwrap()
            .rules()
            .unwrap();
        assert_eq!(rules.policy.lease_ms, 5000);
    }
}
