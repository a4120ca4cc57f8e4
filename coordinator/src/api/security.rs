//! Security: who may call what. Tokens by role, compared in constant time; TLS.

use cognate_worker::transport::connect::{CredentialError, Role, read_tokens};
use futures::future::BoxFuture;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};
use std::task::{Context, Poll};
use std::time::Duration;
use tonic::body::Body;
use tonic::transport::server::{TcpConnectInfo, TlsConnectInfo};
use tonic::transport::{Certificate, Identity, ServerTlsConfig};
use tonic::{Status, body};
use tower::{Layer, Service};

/// What a coordinator asks of whoever calls from a network.
#[derive(Clone, Debug, Default)]
pub struct Security {
    /// The tokens that open something; `None`: nobody is asked.
    pub tokens: Option<Tokens>,
    /// The own certificate, and whose certificates are wanted.
    pub tls: Option<Tls>,
}

impl Security {
    /// Whether callers are known: by a token or by a certificate.
    pub fn knows_callers(&self) -> bool {
        self.tokens.is_some()
            || self
                .tls
                .as_ref()
                .is_some_and(|tls| tls.asks_for_certificates)
    }
}

/// A certificate, and whose certificates are wanted.
#[derive(Clone, Debug)]
pub struct Tls {
    config: ServerTlsConfig,
    asks_for_certificates: bool,
}

impl Tls {
    /// From files (PEM): certificate chain, private key, and the authority of callers, if they must
    /// have certificates.
    pub fn read(
        certificate: &Path,
        key: &Path,
        client_ca: Option<&Path>,
    ) -> Result<Self, CredentialError> {
        let pem = |file: &Path| {
            std::fs::read(file).map_err(|error| CredentialError {
                file: file.display().to_string(),
                what: error.to_string(),
            })
        };
        let identity = Identity::from_pem(pem(certificate)?, pem(key)?);
        let mut config = ServerTlsConfig::new().identity(identity);
        if let Some(authority) = client_ca {
            config = config.client_ca_root(Certificate::from_pem(pem(authority)?));
        }
        Ok(Self {
            config,
            asks_for_certificates: client_ca.is_some(),
        })
    }

    /// As the server wants it.
    pub fn config(&self) -> ServerTlsConfig {
        self.config.clone()
    }
}

/// Tokens, as their hashes: whose comparison takes the same time whatever is compared. Clones hold the
/// same, also when they are read again.
#[derive(Clone)]
pub struct Tokens {
    held: Arc<RwLock<Vec<HashedToken>>>,
    file: PathBuf,
}

/// What a token opens (`None`: everything), and its hash.
type HashedToken = (Option<Role>, blake3::Hash);

impl std::fmt::Debug for Tokens {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} tokens", self.held().len())
    }
}

impl Tokens {
    /// From a file: see [`read_tokens`].
    pub fn read(file: &Path) -> Result<Self, CredentialError> {
        warn_of_readers(file);
        Ok(Self {
            held: Arc::new(RwLock::new(hashed(file)?)),
            file: file.to_owned(),
        })
    }

    /// Reads the file again. What is held stays where the file is not well formed.
    pub fn read_again(&self) -> Result<(), CredentialError> {
        let fresh = hashed(&self.file)?;
        *self.held.write().unwrap_or_else(PoisonError::into_inner) = fresh;
        warn_of_readers(&self.file);
        Ok(())
    }

    fn held(&self) -> RwLockReadGuard<'_, Vec<HashedToken>> {
        self.held.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a token opens what needs this role (`None`: any).
    fn open(&self, token: &str, wanted: Option<Role>) -> bool {
        let shown = blake3::hash(token.as_bytes());
        let mut opens = false;
        // All of them are compared, so that the time says nothing about which one fits.
        for (role, hash) in self.held().iter() {
            let fits = match (role, wanted) {
                (Some(role), Some(wanted)) => *role == wanted,
                _ => true,
            };
            opens |= fits & (*hash == shown);
        }
        opens
    }

    /// Why a call is refused; `None`: it is not.
    fn refusal(&self, path: &str, headers: &http::HeaderMap) -> Option<Status> {
        let wanted = match path.split('/').nth(1).unwrap_or_default() {
            // Probes have no tokens, and learn only that it is alive.
            "grpc.health.v1.Health" => return None,
            "cognate.v1.WorkerApi" => Some(Role::Worker),
            "cognate.v1.ClientApi" => Some(Role::Client),
            _ => None,
        };
        let header = headers.get(http::header::AUTHORIZATION);
        let Some(token) = header
            .and_then(|value| value.to_str().ok())
            .and_then(|value| value.strip_prefix("Bearer "))
        else {
            return Some(Status::unauthenticated(
                "this coordinator asks for a token (--token-file)",
            ));
        };
        if self.open(token, wanted) {
            None
        } else if self.open(token, None) {
            let role = wanted.map_or("caller", Role::name);
            Some(Status::permission_denied(format!(
                "the token is not a {role}'s"
            )))
        } else {
            Some(Status::unauthenticated(
                "the token is none of this coordinator's",
            ))
        }
    }
}

fn hashed(file: &Path) -> Result<Vec<HashedToken>, CredentialError> {
    let tokens = read_tokens(file)?.into_iter();
    Ok(tokens
        .map(|(role, token)| (role, blake3::hash(token.as_bytes())))
        .collect())
}

/// Says that others than the owner can read the tokens.
fn warn_of_readers(file: &Path) {
    let mode = std::fs::metadata(file).map(|found| found.permissions().mode());
    if let Ok(mode) = mode
        && mode & 0o077 != 0
    {
        tracing::warn!(file = %file.display(), mode = format!("{:o}", mode & 0o777),
            "others can read the tokens: chmod 600");
    }
}

/// Who a call came from, where that is known.
fn peer<B>(request: &http::Request<B>) -> String {
    let info = request.extensions();
    let plain = info
        .get::<TcpConnectInfo>()
        .and_then(TcpConnectInfo::remote_addr);
    let secret = info.get::<TlsConnectInfo<TcpConnectInfo>>();
    let secret = secret.and_then(|info| info.get_ref().remote_addr());
    let address = plain.or(secret);
    address.map_or_else(|| "unknown".to_owned(), |address| address.to_string())
}

/// Whoever shows a wrong token waits so long for the answer: guessing takes time, and mistakes do not.
const WRONG_TOKEN: Duration = Duration::from_millis(500);

/// Stands before all services of a listener.
#[derive(Clone, Debug)]
pub struct Guard(pub Option<Tokens>);

impl<S> Layer<S> for Guard {
    type Service = Guarded<S>;

    fn layer(&self, inner: S) -> Guarded<S> {
        Guarded {
            tokens: self.0.clone(),
            inner,
        }
    }
}

/// Services behind a guard.
#[derive(Clone, Debug)]
pub struct Guarded<S> {
    tokens: Option<Tokens>,
    inner: S,
}

impl<S, B> Service<http::Request<B>> for Guarded<S>
where
    S: Service<http::Request<B>, Response = http::Response<body::Body>>,
    S::Response: Send,
{
    type Response = S::Response;
    type Error = S::Error;
    type Future =
        futures::future::Either<BoxFuture<'static, Result<S::Response, S::Error>>, S::Future>;

    fn poll_ready(&mut self, cx: &mut Context<'_>) -> Poll<Result<(), S::Error>> {
        self.inner.poll_ready(cx)
    }

    fn call(&mut self, request: http::Request<B>) -> Self::Future {
        let tokens = self.tokens.as_ref();
        match tokens.and_then(|t| t.refusal(request.uri().path(), request.headers())) {
            Some(status) => {
                let path = request.uri().path();
                tracing::warn!(
                    peer = peer(&request),
                    path,
                    why = status.message(),
                    "a call is refused"
                );
                let refusal = async move {
                    tokio::time::sleep(WRONG_TOKEN).await;
                    Ok(status.into_http::<Body>())
                };
                futures::future::Either::Left(Box::pin(refusal))
            }
            None => futures::future::Either::Right(self.inner.call(request)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tonic::Code;

    fn tokens() -> Tokens {
        let hash = |role, token: &str| (role, blake3::hash(token.as_bytes()));
        let held = vec![
            hash(Some(Role::Client), "client-0123456789"),
            hash(Some(Role::Worker), "worker-0123456789"),
            hash(None, "both-0123456789abc"),
        ];
        Tokens {
            held: Arc::new(RwLock::new(held)),
            file: PathBuf::new(),
        }
    }

    #[test]
    fn tokens_are_read_again_and_stay_where_the_file_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("tokens");
        std::fs::write(&file, "client client-0123456789\n").unwrap();
        let tokens = Tokens::read(&file).unwrap();
        let guard = tokens.clone();
        let opens = |token: &str| guard.open(token, Some(Role::Client));
        assert!(opens("client-0123456789") && !opens("client-9876543210"));
        std::fs::write(&file, "client client-9876543210\n").unwrap();
        tokens.read_again().unwrap();
        assert!(!opens("client-0123456789") && opens("client-9876543210"));
        std::fs::write(&file, "").unwrap();
        assert!(tokens.read_again().is_err());
        assert!(opens("client-9876543210"));
    }

    #[test]
    fn each_service_has_its_role() {
        let check = |path: &str, header: Option<&str>, expected: Option<Code>| {
            let mut headers = http::HeaderMap::new();
            if let Some(header) = header {
                headers.insert("authorization", header.parse().unwrap());
            }
            let refusal = tokens().refusal(path, &headers).map(|status| status.code());
            assert_eq!(refusal, expected, "{path} {header:?}");
        };
        let (client, worker) = ("/cognate.v1.ClientApi/Submit", "/cognate.v1.WorkerApi/Pull");
        check(client, Some("Bearer client-0123456789"), None);
        check(worker, Some("Bearer worker-0123456789"), None);
        for path in [client, worker] {
            check(path, Some("Bearer both-0123456789abc"), None);
            check(path, None, Some(Code::Unauthenticated));
            check(
                path,
                Some("Bearer client-012345678"),
                Some(Code::Unauthenticated),
            );
            check(path, Some("Bearer "), Some(Code::Unauthenticated));
            check(path, Some("client-0123456789"), Some(Code::Unauthenticated));
        }
        check(
            client,
            Some("Bearer worker-0123456789"),
            Some(Code::PermissionDenied),
        );
        check(
            worker,
            Some("Bearer client-0123456789"),
            Some(Code::PermissionDenied),
        );
        check("/grpc.health.v1.Health/Check", None, None);
        let reflection = "/grpc.reflection.v1.ServerReflection/ServerReflectionInfo";
        check(reflection, None, Some(Code::Unauthenticated));
        check(reflection, Some("Bearer worker-0123456789"), None);
    }
}
