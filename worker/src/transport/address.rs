//! Address: where a coordinator listens, as people write it.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// Where a coordinator listens.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Address {
    /// gRPC over TCP: `http://host:port`, or `host:port`.
    Tcp(String),
    /// gRPC over TCP and TLS: `https://host:port`.
    Tls(String),
    /// gRPC over a Unix socket on this host: `unix:/path`.
    Unix(PathBuf),
}

/// A text that is no address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// The text has none of the forms of an address.
    #[error(
        "`{0}` is no address; expected http://host:port, https://host:port, host:port or unix:/path"
    )]
    Malformed(String),
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let malformed = || AddressError::Malformed(text.to_owned());
        if let Some(path) = text.strip_prefix("unix:") {
            let path = path.strip_prefix("//").unwrap_or(path);
            return if path.is_empty() {
                Err(malformed())
            } else {
                Ok(Self::Unix(path.into()))
            };
        }
        let secret = text.strip_prefix("https://");
        let authority = secret.unwrap_or_else(|| text.strip_prefix("http://").unwrap_or(text));
        let authority = authority.strip_suffix('/').unwrap_or(authority);
        let (host, port) = authority.rsplit_once(':').ok_or_else(malformed)?;
        let bracketed = host.starts_with('[') && host.ends_with(']');
        let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_');
        let host_fits = !host.is_empty() && (bracketed || host.chars().all(plain));
        match port.parse::<u16>() {
            Ok(1..) if host_fits && secret.is_some() => Ok(Self::Tls(authority.to_owned())),
            Ok(1..) if host_fits => Ok(Self::Tcp(authority.to_owned())),
            _ => Err(malformed()),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(authority) => write!(f, "http://{authority}"),
            Self::Tls(authority) => write!(f, "https://{authority}"),
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_told_apart() {
        let check = |text: &str, shown: Option<&str>| {
            let read = text.parse::<Address>().map(|address| address.to_string());
            assert_eq!(read.ok().as_deref(), shown, "{text}");
        };
        check("http://127.0.0.1:7420", Some("http://127.0.0.1:7420"));
        check(
            "http://node-1.cluster:80/",
            Some("http://node-1.cluster:80"),
        );
        check("localhost:1", Some("http://localhost:1"));
        check("[::1]:7420", Some("http://[::1]:7420"));
        check("unix:/run/c.sock", Some("unix:/run/c.sock"));
        check("unix:///run/c.sock", Some("unix:/run/c.sock"));
        for bad in [
            "",
            "localhost",
            "unix:",
            "host:0",
            "host:99999",
            ":80",
            "a b:80",
        ] {
            check(bad, None);
        }
        check("https://host:443/", Some("https://host:443"));
    }
}
