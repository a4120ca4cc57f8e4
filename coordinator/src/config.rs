//! Config: addresses, places, deadlines, limits of a coordinator; each with its default.

use crate::api::admission::CallLimits;
use crate::api::held_stream::StreamLimits;
use crate::api::security::Security;
use crate::api::upload_places::UploadLimits;
use crate::chunks::leasing::Policy;
use crate::page::mechanisms::Mechanisms;
use crate::results::place::ResultsPlace;
use crate::transport::introduction::ConnectionLimits;
use cognate_protocol::DEFAULT_ADDRESS;
use cognate_worker::transport::shared_memory::place::LEAST_FREE;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

/// Settings with which a coordinator starts.
#[derive(Clone, Debug)]
pub struct Config {
    /// Addresses at which the coordinator listens.
    pub listen: Vec<ListenAddress>,
    /// Serve addresses beyond this machine without asking anybody who they are.
    pub insecure: bool,
    /// Credentials that are required of callers from a network.
    pub security: Security,
    /// Where metrics are read by HTTP: host and port; `None`: nowhere.
    pub metrics: Option<String>,
    /// Collector of traces (OTLP by gRPC): `http://HOST:PORT`; `None`: there are none.
    pub traces: Option<String>,
    /// Log file of submissions, cancellations, deletions and refusals; `None`: these are only in the general log.
    pub audit_log: Option<PathBuf>,
    /// Where the page for browsers is: host and port; `None`: nowhere.
    pub page: Option<String>,
    /// Service that answers the page's questions about mechanisms; `None`: the page takes systems only.
    pub mechanisms: Option<Arc<dyn Mechanisms>>,
    /// Database or file of the ledger.
    pub ledger: LedgerPlace,
    /// Where the results and all other objects are; `None`: in memory.
    pub results: Option<ResultsPlace>,
    /// Bytes that must be free in /dev/shm so that workers of the same user on this host may use shared memory;
    /// `None`: never.
    pub shared_memory: Option<u64>,
    /// Deadlines and limits.
    pub rules: Rules,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            listen: vec![ListenAddress::Tcp(DEFAULT_ADDRESS.to_owned())],
            insecure: false,
            security: Security::default(),
            metrics: None,
            traces: None,
            audit_log: None,
            page: None,
            mechanisms: None,
            ledger: LedgerPlace::Sqlite("cognate-data/ledger.db".into()),
            results: Some(PathBuf::from("cognate-data/results").into()),
            shared_memory: Some(LEAST_FREE),
            rules: Rules::default(),
        }
    }
}

/// Deadlines and limits of the service.
#[derive(Clone, Debug)]
pub struct Rules {
    /// Rules by which chunks are leased, renewed and taken back.
    pub policy: Policy,
    /// How long a worker's call may wait for work. Default 25 s: below the 60 s after which
    /// proxies cut silent calls.
    pub long_poll: Duration,
    /// After this time without a call a worker is not listed any more. Default 10 minutes.
    pub worker_memory: Duration,
    /// How long calls may go on after the service was told to stop. Default 5 s.
    pub shutdown_grace: Duration,
    /// Time of silence after which a connection is pinged, and time within which it must answer. Default 20 s.
    pub keep_alive: Duration,
    /// How many connections there may be.
    pub connections: ConnectionLimits,
    /// Limits on the memory of calls.
    pub calls: CallLimits,
    /// Limits on the streams of results.
    pub streams: StreamLimits,
    /// How many uploads there may be.
    pub uploads: UploadLimits,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            policy: Policy::default(),
            long_poll: Duration::from_secs(25),
            worker_memory: Duration::from_secs(600),
            shutdown_grace: Duration::from_secs(5),
            keep_alive: Duration::from_secs(20),
            connections: ConnectionLimits::default(),
            calls: CallLimits::default(),
            streams: StreamLimits::default(),
            uploads: UploadLimits::default(),
        }
    }
}

/// A setting that cannot be understood.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// No address.
    #[error("`{0}` is no address to listen on; expected HOST:PORT or unix:PATH")]
    Address(String),
    /// No ledger.
    #[error("`{0}` is no ledger; expected sqlite:PATH, postgres://USER@HOST/DATABASE or memory")]
    Ledger(String),
}

/// A place to listen on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ListenAddress {
    /// gRPC over TCP: host and port; port 0 takes a free one.
    Tcp(String),
    /// gRPC over TCP and TLS, likewise.
    Tls(String),
    /// gRPC over a Unix socket.
    Unix(PathBuf),
}

impl FromStr for ListenAddress {
    type Err = ConfigError;

    fn from_str(text: &str) -> Result<Self, ConfigError> {
        let bad = || ConfigError::Address(text.to_owned());
        if let Some(path) = text.strip_prefix("unix:") {
            let path = path.strip_prefix("//").unwrap_or(path);
            return if path.is_empty() {
                Err(bad())
            } else {
                Ok(Self::Unix(path.into()))
            };
        }
        let secret = text.strip_prefix("https://");
        let authority = secret.unwrap_or_else(|| text.strip_prefix("http://").unwrap_or(text));
        let authority = authority.strip_suffix('/').unwrap_or(authority);
        let (host, port) = authority.rsplit_once(':').ok_or_else(bad)?;
        if host.is_empty() || host.contains('/') || port.parse::<u16>().is_err() {
            return Err(bad());
        }
        let authority = authority.to_owned();
        Ok(if secret.is_some() {
            Self::Tls(authority)
        } else {
            Self::Tcp(authority)
        })
    }
}

impl fmt::Display for ListenAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(authority) => write!(f, "http://{authority}"),
            Self::Tls(authority) => write!(f, "https://{authority}"),
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
        }
    }
}

/// Place of the ledger: memory, a file of SQLite or a server of PostgreSQL.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LedgerPlace {
    /// A file.
    Sqlite(PathBuf),
    /// A PostgreSQL database, which several coordinators may share, by its URL.
    Postgres(String),
    /// Nothing outlives the process: for tests and the embedded solve.
    Memory,
}

impl FromStr for LedgerPlace {
    type Err = ConfigError;

    fn from_str(text: &str) -> Result<Self, ConfigError> {
        if text == "memory" {
            return Ok(Self::Memory);
        }
        if text.starts_with("postgres://") || text.starts_with("postgresql://") {
            return Ok(Self::Postgres(text.to_owned()));
        }
        let path = text.strip_prefix("sqlite:");
        let path = path.map(|p| p.strip_prefix("//").unwrap_or(p));
        match path {
            Some(path) if !path.is_empty() => Ok(Self::Sqlite(path.into())),
            _ => Err(ConfigError::Ledger(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_or_refused() {
        let tcp = |s: &str| ListenAddress::Tcp(s.to_owned());
        for (text, expected) in [
            ("127.0.0.1:7654", tcp("127.0.0.1:7654")),
            ("http://[::1]:0/", tcp("[::1]:0")),
            (
                "unix:/run/c.sock",
                ListenAddress::Unix("/run/c.sock".into()),
            ),
            (
                "unix:///run/c.sock",
                ListenAddress::Unix("/run/c.sock".into()),
            ),
        ] {
            assert_eq!(text.parse::<ListenAddress>().unwrap(), expected);
        }
        for text in [
            "",
            "7654",
            "host",
            "host:",
            ":1",
            "host:99999",
            "unix:",
            "a/b:1",
        ] {
            assert!(text.parse::<ListenAddress>().is_err(), "{text}");
        }
        let tls = "https://a:1".parse::<ListenAddress>();
        assert_eq!(tls.unwrap(), ListenAddress::Tls("a:1".into()));
    }

    #[test]
    fn ledgers_are_read_or_refused() {
        let place = LedgerPlace::Sqlite("a/b.db".into());
        assert_eq!("sqlite:a/b.db".parse(), Ok(place));
        assert_eq!("memory".parse(), Ok(LedgerPlace::Memory));
        for text in ["", "sqlite:", "redis:x", "a.db"] {
            assert!(text.parse::<LedgerPlace>().is_err(), "{text}");
        }
        let url = "postgres://h/d";
        assert_eq!(url.parse(), Ok(LedgerPlace::Postgres(url.into())));
    }
}
