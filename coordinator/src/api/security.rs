//! Security: who may call what. Tokens by role, compared in constant time; TLS.

use cognate_worker::transport::connect::{CredentialError, Role, read_tokens};
use std::path::Path;
use std::sync::Arc;
use std::task::{Context, Poll};
use tonic::body::Body;
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

/// Tokens, as their hashes: whose comparison takes the same time whatever is compared.
#[derive(Clone)]
pub struct Tokens(Arc<Vec<(Option<Role>, blake3::Hash)>>);

impl std::fmt::Debug for Tokens {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} tokens", self.0.len())
    }
}

impl Tokens {
    /// From a file: see [`read_tokens`].
    pub fn read(file: &Path) -> Result<Self, CredentialError> {
        let tokens = read_tokens(file)?.into_iter();
        let hashed = tokens.map(|(role, token)| (role, blake3::hash(token.as_bytes())));
        Ok(Self(Arc::new(hashed.collect())))
    }

    /// Whether a token opens what needs this role (`None`: any).
    fn open(&self, token: &str, wanted: Option<Role>) -> bool {
        let shown = blake3::hash(token.as_bytes());
        let mut opens = false;
        // All of them are compared, so that the time says nothing about which one fits.
        for (role, hash) in self.0.iter() {
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
{
    type Response = S::Response;
    type Error = S::Error;
    type Future =
        futures::future::Either<std::future::Ready<Result<S::Response, S::Error>>, S::Future>;

    fn poll_ready(&mut self, cx: &mut Context<'_>) -> Poll<Result<(), S::Error>> {
        self.inner.poll_ready(cx)
    }

    fn call(&mut self, request: http::Request<B>) -> Self::Future {
        let tokens = self.tokens.as_ref();
        match tokens.and_then(|t| t.refusal(request.uri().path(), request.headers())) {
            Some(status) => {
                let response = status.into_http::<Body>();
                futures::future::Either::Left(std::future::ready(Ok(response)))
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
        Tokens(Arc::new(vec![
            hash(Some(Role::Client), "client-0123456789"),
            hash(Some(Role::Worker), "worker-0123456789"),
            hash(None, "both-0123456789abc"),
        ]))
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
