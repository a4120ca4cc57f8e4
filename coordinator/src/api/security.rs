//! Security: who may call what. Tokens by role, compared in constant time; TLS.

use super::audit_log::{AuditLog, Entry};
use super::caller::Caller;
use super::methods;
use super::middleware::{Answer, Inner, Middleware};
use super::visible::visible;
use crate::ledger::identity::{Credential, Tenant};
use cognate_worker::transport::tokens::{CredentialError, Limits, Role, read_tokens};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};
use std::time::Duration;
use tonic::Status;
use tonic::body::Body;
use tonic::transport::server::{TcpConnectInfo, TlsConnectInfo};
use tonic::transport::{Certificate, Identity, ServerTlsConfig};

/// Credentials that a coordinator requires of callers from a network.
#[derive(Clone, Debug, Default)]
pub struct Security {
    /// Tokens of callers; `None`: no token is required.
    pub tokens: Option<Tokens>,
    /// Certificate of this coordinator, and whether callers must have certificates.
    pub tls: Option<Tls>,
    /// Log of calls and callers.
    pub audit: AuditLog,
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

/// Certificate of this coordinator, and whether callers must have certificates.
#[derive(Clone, Debug)]
pub struct Tls {
    config: ServerTlsConfig,
    asks_for_certificates: bool,
}

impl Tls {
    /// Reads the files (PEM): certificate chain, private key, and the authority of callers, if they must have
    /// certificates.
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

    /// Settings of TLS for the server.
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

/// A token, without the token.
struct HashedToken {
    /// Role that the token gives; `None`: all roles.
    role: Option<Role>,
    hash: blake3::Hash,
    name: Option<String>,
    tenant: Option<Tenant>,
    limits: Limits,
}

impl HashedToken {
    /// Holder of the token, calling from this address.
    fn holder(&self, peer: String) -> Caller {
        // Some digits of a hash of the hash: it tells tokens apart, and nothing about them.
        let digits = blake3::hash(self.hash.as_bytes()).to_hex();
        let credential = format!("token-{}", &digits[..16]);
        Caller {
            name: self.name.clone().unwrap_or_else(|| credential.clone()),
            credential: Credential(credential),
            tenant: self.tenant.clone(),
            limits: self.limits,
            peer,
            reads_only: self.role == Some(Role::Viewer),
        }
    }
}

impl std::fmt::Debug for Tokens {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} tokens", self.held().len())
    }
}

impl Tokens {
    /// Reads the tokens of a file (see [`read_tokens`]).
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

    /// Holder of a token that gives this role (`None`: any role); `None` where the token does not.
    fn open(&self, token: &str, wanted: Option<Role>, peer: &str) -> Option<Caller> {
        let shown = blake3::hash(token.as_bytes());
        let mut holder = None;
        // All of them are compared, so that the time says nothing about which one fits.
        for held in self.held().iter() {
            let fits = match (held.role, wanted) {
                (Some(role), Some(wanted)) => role.covers(wanted),
                _ => true,
            };
            if fits & (held.hash == shown) {
                holder = Some(held.holder(peer.to_owned()));
            }
        }
        holder
    }

    /// Caller at this address, or the status with which the call is refused.
    fn caller(&self, path: &str, headers: &http::HeaderMap, peer: &str) -> Result<Caller, Status> {
        let mut words = path.split('/').skip(1);
        let (service, method) = (words.next(), words.next().unwrap_or_default());
        let wanted = match service.unwrap_or_default() {
            // Probes have no tokens, and learn only that it is alive.
            "grpc.health.v1.Health" => return Ok(Caller::untold("nobody", peer)),
            "cognate.v1.WorkerApi" => Some(Role::Worker),
            "cognate.v1.ClientApi" if methods::reads_only(method) => Some(Role::Viewer),
            "cognate.v1.ClientApi" => Some(Role::Client),
            _ => None,
        };
        let header = headers.get(http::header::AUTHORIZATION);
        let Some(token) = header
            .and_then(|value| value.to_str().ok())
            .and_then(|value| value.strip_prefix("Bearer "))
        else {
            return Err(Status::unauthenticated(
                "this coordinator asks for a token (--token-file)",
            ));
        };
        if let Some(caller) = self.open(token, wanted, peer) {
            return Ok(caller);
        }
        Err(match self.open(token, None, peer) {
            Some(_) => {
                let role = wanted.map_or("caller", Role::name);
                Status::permission_denied(format!("the token is not a {role}'s"))
            }
            None => Status::unauthenticated("the token is none of this coordinator's"),
        })
    }
}

fn hashed(file: &Path) -> Result<Vec<HashedToken>, CredentialError> {
    let lines = read_tokens(file)?.into_iter();
    let hashed = lines.map(|line| {
        let tenant = line.tenant.map(Tenant::new).transpose();
        Ok(HashedToken {
            role: line.role,
            hash: blake3::hash(line.token.as_bytes()),
            name: line.name,
            tenant: tenant.map_err(|error| CredentialError::of(file, error))?,
            limits: line.limits,
        })
    });
    hashed.collect()
}

/// Says that others than this coordinator can read the tokens. A file of another owner, as a Kubernetes secret is
/// root's, can be read by a group only.
fn warn_of_readers(file: &Path) {
    let Ok(metadata) = std::fs::metadata(file) else {
        return;
    };
    let (mode, is_own) = (
        metadata.permissions().mode(),
        metadata.uid() == rustix::process::geteuid().as_raw(),
    );
    let others = if is_own { 0o077 } else { 0o037 };
    if mode & others != 0 {
        let wanted = if is_own { "600" } else { "440" };
        tracing::warn!(file = %file.display(), mode = format!("{:o}", mode & 0o777),
            "others can read the tokens: chmod {wanted}");
    }
}

/// Address of the caller, or "this host".
fn peer<B>(request: &http::Request<B>) -> String {
    let info = request.extensions();
    let plain = info
        .get::<TcpConnectInfo>()
        .and_then(TcpConnectInfo::remote_addr);
    let secret = info.get::<TlsConnectInfo<TcpConnectInfo>>();
    let secret = secret.and_then(|info| info.get_ref().remote_addr());
    let address = plain.or(secret);
    address.map_or_else(|| "this host".to_owned(), |address| address.to_string())
}

/// Caller without a token, known by its certificate, or as a caller from this machine.
fn untold<B>(request: &http::Request<B>, peer: &str) -> Caller {
    let info = request.extensions().get::<TlsConnectInfo<TcpConnectInfo>>();
    let certificates = info.and_then(TlsConnectInfo::peer_certs);
    match certificates.as_ref().and_then(|chain| chain.first()) {
        Some(certificate) => {
            let digits = blake3::hash(certificate).to_hex();
            Caller::untold(&format!("certificate-{}", &digits[..16]), peer)
        }
        None => Caller::untold("local", peer),
    }
}

/// Delay of the answer to a wrong token. It slows down guessing, and hardly disturbs a caller with a typing mistake.
const WRONG_TOKEN: Duration = Duration::from_millis(500);

/// Stands before all services of a listener.
#[derive(Clone, Debug)]
pub struct Guard {
    /// Tokens of callers; `None`: no token is required.
    pub tokens: Option<Tokens>,
    /// Log of refused calls.
    pub audit: AuditLog,
}

impl Middleware for Guard {
    fn answer<S: Inner>(&self, mut request: http::Request<Body>, mut inner: S) -> Answer {
        let peer = peer(&request);
        let caller = match &self.tokens {
            Some(tokens) => tokens.caller(request.uri().path(), request.headers(), &peer),
            None => Ok(untold(&request, &peer)),
        };
        match caller {
            Err(status) => {
                let path = visible(request.uri().path());
                let why = status.message();
                tracing::warn!(peer, path, why, "a call is refused");
                let entry = Entry {
                    call: &path,
                    job: None,
                    code: status.code(),
                    why: Some(why),
                };
                let stranger = Caller::untold("unknown", peer);
                self.audit.record(&stranger, entry);
                Box::pin(async move {
                    tokio::time::sleep(WRONG_TOKEN).await;
                    Ok(status.into_http())
                })
            }
            Ok(caller) => {
                request.extensions_mut().insert(caller);
                Box::pin(inner.call(request))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tonic::Code;

    fn tokens() -> Tokens {
        let hash = |role, token: &str| HashedToken {
            role,
            hash: blake3::hash(token.as_bytes()),
            name: None,
            tenant: None,
            limits: Limits::default(),
        };
        let held = vec![
            hash(Some(Role::Client), "client-0123456789"),
            hash(Some(Role::Worker), "worker-0123456789"),
            hash(Some(Role::Viewer), "viewer-0123456789"),
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
        let opens = |token: &str| guard.open(token, Some(Role::Client), "here").is_some();
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
            let caller = tokens().caller(path, &headers, "here");
            let refusal = caller.err().map(|status| status.code());
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
        // A viewer can read, but can neither change anything nor act as a worker.
        let viewer = Some("Bearer viewer-0123456789");
        let reading = methods::OF_CLIENTS
            .iter()
            .filter(|method| method.reads_only);
        for method in reading.map(|method| method.name) {
            let path = format!("/cognate.v1.ClientApi/{method}");
            check(&path, viewer, None);
            check(&path, Some("Bearer client-0123456789"), None);
            check(
                &path,
                Some("Bearer worker-0123456789"),
                Some(Code::PermissionDenied),
            );
        }
        for method in ["Submit", "Cancel", "Delete", "Upload", "AnyOther"] {
            let path = format!("/cognate.v1.ClientApi/{method}");
            check(&path, viewer, Some(Code::PermissionDenied));
        }
        check(worker, viewer, Some(Code::PermissionDenied));
        check("/grpc.health.v1.Health/Check", None, None);
        let reflection = "/grpc.reflection.v1.ServerReflection/ServerReflectionInfo";
        check(reflection, None, Some(Code::Unauthenticated));
        check(reflection, Some("Bearer worker-0123456789"), None);
    }
}
