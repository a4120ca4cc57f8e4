//! Access over a network: the tokens and certificates that give it, and the callers that are refused.

use cognate_coordinator::api::security::{Security, Tls, Tokens};
use cognate_coordinator::config::{Config, LedgerPlace, ListenAddress};
use cognate_coordinator::server::{RunningServer, Server, ServerError};
use cognate_coordinator::transport::ListenError;
use cognate_protocol::v1;
use cognate_protocol::v1::client_api_client::ClientApiClient;
use cognate_protocol::v1::worker_api_client::WorkerApiClient;
use cognate_worker::transport::address::Address;
use cognate_worker::transport::connect::{CredentialFiles, Credentials, Role};
use rcgen::{BasicConstraints, CertificateParams, IsCa, Issuer, KeyPair};
use std::path::{Path, PathBuf};
use tonic::{Code, Status};

const TOKENS: &str = "client client-0123456789\nworker worker-0123456789\n";

fn write(folder: &Path, name: &str, content: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// An authority, and certificates of it for localhost: `NAME-ca.pem`, `NAME.pem`, `NAME.key`.
fn certificates(folder: &Path, name: &str) {
    let authority_key = KeyPair::generate().unwrap();
    let mut authority = CertificateParams::new(Vec::new()).unwrap();
    authority.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
    let certificate = authority.self_signed(&authority_key).unwrap();
    write(folder, &format!("{name}-ca.pem"), &certificate.pem());
    let issuer = Issuer::new(authority, authority_key);
    let key = KeyPair::generate().unwrap();
    let parameters = CertificateParams::new(vec!["localhost".to_owned()]).unwrap();
    let server_certificate = parameters.signed_by(&key, &issuer).unwrap();
    write(folder, &format!("{name}.pem"), &server_certificate.pem());
    write(folder, &format!("{name}.key"), &key.serialize_pem());
}

async fn start(security: Security) -> (RunningServer, Address) {
    let config = Config {
        listen: vec![ListenAddress::Tcp("localhost:0".to_owned())],
        security,
        ledger: LedgerPlace::Memory,
        results: None,
        shared_memory: None,
        ..Config::default()
    };
    let server = Server::start(config).await.expect("it starts");
    let port = |authority: &str| authority.rsplit(':').next().unwrap_or_default().to_owned();
    let address = match &server.addresses[0] {
        ListenAddress::Tcp(authority) => Address::Tcp(format!("localhost:{}", port(authority))),
        ListenAddress::Tls(authority) => Address::Tls(format!("localhost:{}", port(authority))),
        ListenAddress::Unix(_) => unreachable!("it listens on TCP"),
    };
    (server, address)
}

/// Whether clients' and workers' calls are answered with these files.
async fn calls(address: &Address, files: &CredentialFiles, role: Role) -> [Result<(), Status>; 2] {
    let credentials = Credentials::read(files, role).unwrap();
    let channel = credentials.channel(address).unwrap();
    let bearer = || credentials.bearer();
    let mut client = ClientApiClient::with_interceptor(channel.clone(), bearer());
    let mut worker = WorkerApiClient::with_interceptor(channel, bearer());
    let jobs = client.list_jobs(v1::ListJobsRequest::default()).await;
    let memory = worker
        .get_shared_memory(v1::GetSharedMemoryRequest {})
        .await;
    [jobs.map(|_| ()), memory.map(|_| ())]
}

fn codes(answers: [Result<(), Status>; 2]) -> [Code; 2] {
    answers.map(|answer| answer.map_or_else(|status| status.code(), |()| Code::Ok))
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn tokens_open_what_their_role_may() {
    let folder = tempfile::tempdir().unwrap();
    let tokens = write(folder.path(), "tokens", TOKENS);
    let security = Security {
        tokens: Some(Tokens::read(&tokens).unwrap()),
        ..Security::default()
    };
    let (server, address) = start(security).await;
    let with = |file: &PathBuf| CredentialFiles {
        token_file: Some(file.clone()),
        ..CredentialFiles::default()
    };
    let (ok, no, not_so) = (Code::Ok, Code::Unauthenticated, Code::PermissionDenied);
    let answers = calls(&address, &with(&tokens), Role::Client).await;
    assert_eq!(codes(answers), [ok, not_so]);
    let answers = calls(&address, &with(&tokens), Role::Worker).await;
    assert_eq!(codes(answers), [not_so, ok]);
    let wrong = write(folder.path(), "wrong", "worker-0123456788");
    let answers = calls(&address, &with(&wrong), Role::Worker).await;
    assert_eq!(codes(answers), [no, no]);
    let answers = calls(&address, &CredentialFiles::default(), Role::Worker).await;
    assert_eq!(codes(answers), [no, no]);
    server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn certificates_are_checked_on_both_sides() {
    let folder = tempfile::tempdir().unwrap();
    certificates(folder.path(), "ours");
    certificates(folder.path(), "others");
    let at = |name: &str| folder.path().join(name);
    let tls = Tls::read(&at("ours.pem"), &at("ours.key"), Some(&at("ours-ca.pem"))).unwrap();
    let security = Security {
        tls: Some(tls),
        ..Security::default()
    };
    let (server, address) = start(security).await;
    assert!(
        matches!(address, Address::Tls(_)),
        "every TCP listener speaks TLS"
    );
    let with = |authority: &str, certificate_name: Option<&str>| CredentialFiles {
        tls_ca: Some(at(authority)),
        tls_certificate: certificate_name.map(|name| at(&format!("{name}.pem"))),
        tls_key: certificate_name.map(|name| at(&format!("{name}.key"))),
        ..CredentialFiles::default()
    };
    let our_calls = calls(&address, &with("ours-ca.pem", Some("ours")), Role::Client).await;
    assert_eq!(codes(our_calls), [Code::Ok, Code::Ok]);
    for (authority, certificate_name) in [
        ("ours-ca.pem", None),
        ("ours-ca.pem", Some("others")),
        ("others-ca.pem", Some("ours")),
    ] {
        let refused = calls(&address, &with(authority, certificate_name), Role::Client).await;
        assert!(
            refused.iter().all(Result::is_err),
            "{authority} {certificate_name:?}"
        );
    }
    // In the clear nobody is answered, and without an authority nobody is trusted.
    let Address::Tls(authority) = &address else {
        unreachable!("seen above")
    };
    let clear = Address::Tcp(authority.clone());
    let refused = calls(&clear, &CredentialFiles::default(), Role::Client).await;
    assert!(refused.iter().all(Result::is_err));
    let none = Credentials::default().channel(&address).unwrap_err();
    assert!(none.to_string().contains("--tls-ca"), "{none}");
    server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn beyond_loopback_callers_must_be_known() {
    let folder = tempfile::tempdir().unwrap();
    certificates(folder.path(), "ours");
    let at = |name: &str| folder.path().join(name);
    let tokens = write(folder.path(), "tokens", TOKENS);
    let tls = |authority: Option<PathBuf>| {
        Some(Tls::read(&at("ours.pem"), &at("ours.key"), authority.as_deref()).unwrap())
    };
    let start = |security: Security, address: &str| {
        Server::start(Config {
            listen: vec![address.parse().unwrap()],
            security,
            ledger: LedgerPlace::Memory,
            results: None,
            shared_memory: None,
            ..Config::default()
        })
    };
    // A certificate of its own says who it is, not who calls.
    let anybody = Security {
        tls: tls(None),
        ..Security::default()
    };
    let refused = start(anybody, "0.0.0.0:0").await.err().unwrap();
    let beyond = matches!(
        &refused,
        ServerError::Listener(ListenError::BeyondLoopback { .. })
    );
    assert!(
        beyond && refused.to_string().contains("--token-file"),
        "{refused}"
    );
    let refused = start(Security::default(), "https://127.0.0.1:0").await;
    let refused = refused.err().unwrap().to_string();
    assert!(refused.contains("--tls-certificate"), "{refused}");
    for security in [
        Security {
            tls: tls(Some(at("ours-ca.pem"))),
            ..Security::default()
        },
        Security {
            tokens: Some(Tokens::read(&tokens).unwrap()),
            tls: tls(None),
            ..Security::default()
        },
    ] {
        let server = start(security, "0.0.0.0:0").await.unwrap();
        assert!(matches!(server.addresses[0], ListenAddress::Tls(_)));
        server.shutdown().await;
    }
}
