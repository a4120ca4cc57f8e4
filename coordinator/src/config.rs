//! Config: addresses, places, deadlines, limits of a coordinator; each with its default.

use crate::chunks::leasing::Policy;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// The address that a coordinator listens on unless told otherwise.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:7654";

/// What a coordinator is told when it starts.
#[derive(Clone, Debug)]
pub struct Config {
    /// Where it listens.
    pub listen: Vec<ListenAddress>,
    /// Serve addresses beyond this machine without asking anybody who they are.
    pub insecure: bool,
    /// What remembers.
    pub ledger: LedgerPlace,
    /// The folder of the results and all other objects; `None`: in memory.
    pub results: Option<PathBuf>,
    /// Deadlines and limits.
    pub rules: Rules,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            listen: vec![ListenAddress::Tcp(DEFAULT_ADDRESS.to_owned())],
            insecure: false,
            ledger: LedgerPlace::Sqlite("cognate-data/ledger.db".into()),
            results: Some("cognate-data/results".into()),
            rules: Rules::default(),
        }
    }
}

/// Deadlines and limits of the service.
#[derive(Clone, Debug)]
pub struct Rules {
    /// How chunks are leased, renewed and taken back.
    pub policy: Policy,
    /// How long a worker's call may wait for work. Default 25 s: below the 60 s after which
    /// proxies cut silent calls.
    pub long_poll: Duration,
    /// After this time without a call a worker is not listed any more. Default 10 minutes.
    pub worker_memory: Duration,
    /// How long calls may go on after the service was told to stop. Default 5 s.
    pub shutdown_grace: Duration,
    /// Silent connections are asked whether they live so often, and given as long to answer.
    /// Default 20 s.
    pub keep_alive: Duration,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            policy: Policy::default(),
            long_poll: Duration::from_secs(25),
            worker_memory: Duration::from_secs(600),
            shutdown_grace: Duration::from_secs(5),
            keep_alive: Duration::from_secs(20),
        }
    }
}

/// What a person wrote that means nothing here.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// No address.
    #[error("`{0}` is no address to listen on; expected HOST:PORT or unix:PATH")]
    Address(String),
    /// No ledger.
    #[error("`{0}` is no ledger; expected sqlite:PATH or memory")]
    Ledger(String),
    /// A later version's.
    #[error("not in this version: {0}")]
    NotInThisVersion(String),
}

/// A place to listen on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ListenAddress {
    /// gRPC over TCP: host and port; port 0 takes a free one.
    Tcp(String),
    /// gRPC over a Unix socket.
    Unix(PathBuf),
}

impl FromStr for ListenAddress {
    type Err = ConfigError;

    fn from_str(text: &str) -> Result<Self, ConfigError> {
        let bad = || ConfigError::Address(text.to_owned());
        if text.starts_with("https://") {
            return Err(ConfigError::NotInThisVersion(format!(
                "TLS, which `{text}` asks for"
            )));
        }
        if let Some(path) = text.strip_prefix("unix:") {
            let path = path.strip_prefix("//").unwrap_or(path);
            return if path.is_empty() {
                Err(bad())
            } else {
                Ok(Self::Unix(path.into()))
            };
        }
        let authority = text.strip_prefix("http://").unwrap_or(text);
        let authority = authority.strip_suffix('/').unwrap_or(authority);
        let (host, port) = authority.rsplit_once(':').ok_or_else(bad)?;
        if host.is_empty() || host.contains('/') || port.parse::<u16>().is_err() {
            return Err(bad());
        }
        Ok(Self::Tcp(authority.to_owned()))
    }
}

impl fmt::Display for ListenAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(authority) => write!(f, "http://{authority}"),
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
        }
    }
}

/// What remembers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LedgerPlace {
    /// A file.
    Sqlite(PathBuf),
    /// Nothing outlives the process: for tests and the embedded solve.
    Memory,
}

impl FromStr for LedgerPlace {
    type Err = ConfigError;

    fn from_str(text: &str) -> Result<Self, ConfigError> {
        if text == "memory" {
            return Ok(Self::Memory);
        }
        if text.starts_with("postgres:") || text.starts_with("postgresql:") {
            return Err(ConfigError::NotInThisVersion(format!(
                "PostgreSQL, which `{text}` asks for"
            )));
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
        let error = "https://a:1".parse::<ListenAddress>().unwrap_err();
        assert!(error.to_string().starts_with("not in this version"));
    }

    #[test]
    fn ledgers_are_read_or_refused() {
        let place = LedgerPlace::Sqlite("a/b.db".into());
        assert_eq!("sqlite:a/b.db".parse(), Ok(place));
        assert_eq!("memory".parse(), Ok(LedgerPlace::Memory));
        for text in ["", "sqlite:", "redis:x", "a.db"] {
            assert!(text.parse::<LedgerPlace>().is_err(), "{text}");
        }
        let error = "postgres://h/d".parse::<LedgerPlace>().unwrap_err();
        assert!(error.to_string().starts_with("not in this version"));
    }
}
