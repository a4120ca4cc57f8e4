//! Connect: a channel to a coordinator, with what it asks for: a token, a certificate.
//!
//! Workers and clients share it.

use super::address::Address;
pub use super::tokens::{CredentialError, Role};
use super::tokens::{TokenLine, read_tokens};
use std::path::PathBuf;
use std::time::Duration;
use tonic::metadata::{Ascii, MetadataValue};
use tonic::service::Interceptor;
use tonic::transport::{Certificate, Channel, ClientTlsConfig, Endpoint, Identity, Uri};
use tonic::{Request, Status};

/// Time that a coordinator may take to accept a connection.
const CONNECT: Duration = Duration::from_secs(5);
/// Time of silence after which a connection is pinged, also while idle.
const KEEP_ALIVE: Duration = Duration::from_secs(10);
/// Time without an answer to a ping after which a connection is given up.
const KEEP_ALIVE_ANSWER: Duration = Duration::from_secs(10);

/// The files that a caller names.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct CredentialFiles {
    /// A file with the token that the coordinator asks for
    #[arg(long, value_name = "FILE", env = "COGNATE_TOKEN_FILE")]
    pub token_file: Option<PathBuf>,
    /// A file with the authority (PEM) that the coordinator's certificate is checked by
    #[arg(long, value_name = "FILE", env = "COGNATE_TLS_CA")]
    pub tls_ca: Option<PathBuf>,
    /// A file with the own certificate chain (PEM), where the coordinator asks for one
    #[arg(
        long,
        value_name = "FILE",
        env = "COGNATE_TLS_CERTIFICATE",
        requires = "tls_key"
    )]
    pub tls_certificate: Option<PathBuf>,
    /// A file with the own private key (PEM)
    #[arg(
        long,
        value_name = "FILE",
        env = "COGNATE_TLS_KEY",
        requires = "tls_certificate"
    )]
    pub tls_key: Option<PathBuf>,
}

/// Credentials of a caller: its bearer token and its TLS settings.
#[derive(Clone, Debug, Default)]
pub struct Credentials {
    bearer: Option<MetadataValue<Ascii>>,
    tls: Option<ClientTlsConfig>,
}

impl Credentials {
    /// Reads the files that are named.
    pub fn read(files: &CredentialFiles, role: Role) -> Result<Self, CredentialError> {
        let pem =
            |file: &PathBuf| std::fs::read(file).map_err(|error| CredentialError::of(file, error));
        let bearer = match &files.token_file {
            None => None,
            Some(file) => {
                let tokens = read_tokens(file)?;
                let fits =
                    |line: &&TokenLine| line.role.is_none_or(|token_role| token_role == role);
                // A client that may only look calls what it may.
                let looks =
                    |line: &&TokenLine| role == Role::Client && line.role == Some(Role::Viewer);
                let token_line = tokens.iter().find(fits).or(tokens.iter().find(looks));
                let Some(TokenLine { token, .. }) = token_line else {
                    return Err(CredentialError::of(
                        file,
                        format!("it holds no token of a {}", role.name()),
                    ));
                };
                let header = format!("Bearer {token}");
                let mut header: MetadataValue<Ascii> = header
                    .parse()
                    .map_err(|error| CredentialError::of(file, error))?;
                header.set_sensitive(true);
                Some(header)
            }
        };
        let tls = match &files.tls_ca {
            None => None,
            Some(file) => {
                let authority = Certificate::from_pem(pem(file)?);
                let config = ClientTlsConfig::new().ca_certificate(authority);
                Some(match (&files.tls_certificate, &files.tls_key) {
                    (Some(certificate), Some(key)) => {
                        config.identity(Identity::from_pem(pem(certificate)?, pem(key)?))
                    }
                    _ => config,
                })
            }
        };
        Ok(Self { bearer, tls })
    }

    /// A channel to this address; connected when it is first used. Must be called within a tokio
    /// runtime.
    pub fn channel(&self, address: &Address) -> Result<Channel, UnusableAddress> {
        let unusable = |why: String| UnusableAddress {
            address: address.clone(),
            why,
        };
        let uri = match address {
            Address::Tcp(authority) => format!("http://{authority}"),
            Address::Tls(authority) => format!("https://{authority}"),
            // The host is never looked up: the connector below goes to the socket.
            Address::Unix(_) => "http://localhost".to_owned(),
        };
        let mut endpoint = Endpoint::from_shared(uri)
            .map_err(|error| unusable(error.to_string()))?
            .connect_timeout(CONNECT)
            .http2_keep_alive_interval(KEEP_ALIVE)
            .keep_alive_timeout(KEEP_ALIVE_ANSWER)
            .keep_alive_while_idle(true)
            .tcp_nodelay(true);
        if let Address::Tls(_) = address {
            let Some(tls) = &self.tls else {
                return Err(unusable(
                    "--tls-ca names no authority to check it by".into(),
                ));
            };
            endpoint = endpoint
                .tls_config(tls.clone())
                .map_err(|error| unusable(innermost(&error)))?;
        }
        Ok(match address {
            Address::Tcp(_) | Address::Tls(_) => endpoint.connect_lazy(),
            Address::Unix(path) => {
                let path = path.clone();
                endpoint.connect_with_connector_lazy(tower::service_fn(move |_: Uri| {
                    let path = path.clone();
                    async move {
                        let stream = tokio::net::UnixStream::connect(path).await?;
                        Ok::<_, std::io::Error>(hyper_util::rt::TokioIo::new(stream))
                    }
                }))
            }
        })
    }

    /// Interceptor that adds the token to each call.
    pub fn bearer(&self) -> Bearer {
        Bearer(self.bearer.clone())
    }
}

/// Puts a token into each call.
#[derive(Clone, Debug, Default)]
pub struct Bearer(Option<MetadataValue<Ascii>>);

impl Bearer {
    /// Into the headers of a call that is not made through an interceptor.
    pub fn mark(&self, headers: &mut http::HeaderMap) {
        if let Some(token) = &self.0
            && let Ok(mut value) = http::HeaderValue::from_bytes(token.as_encoded_bytes())
        {
            value.set_sensitive(true);
            headers.insert(http::header::AUTHORIZATION, value);
        }
    }
}

impl Interceptor for Bearer {
    fn call(&mut self, mut request: Request<()>) -> Result<Request<()>, Status> {
        if let Some(token) = &self.0 {
            request
                .metadata_mut()
                .insert("authorization", token.clone());
        }
        Ok(request)
    }
}

/// Why an address cannot be used at all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{address} cannot be used: {why}")]
pub struct UnusableAddress {
    /// The address that cannot be used.
    pub address: Address,
    /// Why the address cannot be used.
    pub why: String,
}

/// The cause that a person can act on ("connection refused").
pub fn innermost(error: &dyn std::error::Error) -> String {
    let mut error = error;
    while let Some(cause) = error.source() {
        error = cause;
    }
    error.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tokens");
        std::fs::write(&path, text).unwrap();
        (folder, path)
    }

    #[test]
    fn tokens_have_roles() {
        let (_folder, path) =
            file("# of the laboratory\nclient 0123456789abcdef\nworker fedcba9876543210 # new\n\n");
        let tokens = read_tokens(&path).unwrap();
        assert_eq!(tokens[0].token, "0123456789abcdef");
        assert_eq!(tokens[1].role, Some(Role::Worker));
        let files = CredentialFiles {
            token_file: Some(path),
            ..CredentialFiles::default()
        };
        let worker = Credentials::read(&files, Role::Worker).unwrap();
        let mut headers = http::HeaderMap::new();
        worker.bearer().mark(&mut headers);
        assert_eq!(headers["authorization"], "Bearer fedcba9876543210");
        assert!(
            !format!("{worker:?}").contains("fedcba"),
            "logs keep it secret"
        );
    }

    #[test]
    fn files_without_a_good_token_are_refused_by_name() {
        let check = |text: &str, expected: &str| {
            let (_folder, path) = file(text);
            let files = CredentialFiles {
                token_file: Some(path),
                ..CredentialFiles::default()
            };
            let error = Credentials::read(&files, Role::Worker).unwrap_err();
            let error = error.to_string();
            assert!(
                error.contains("tokens: ") && error.contains(expected),
                "{error}"
            );
        };
        check("", "holds no token");
        check("worker short", "line 1: a token has at least 16");
        check(
            "\nmaster 0123456789abcdef",
            "line 2: expected `client TOKEN`",
        );
        check("client 0123456789abcdef", "no token of a worker");
    }
}
