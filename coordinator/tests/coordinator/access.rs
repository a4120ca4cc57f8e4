//! Tenants, limits, the audit log, and what an operator's programs hear.

use crate::support::{FOUR_POINTS, MANY_PATHS, text};
use cognate_coordinator::api::security::{Security, Tokens};
use cognate_coordinator::config::{Config, LedgerPlace, ListenAddress};
use cognate_coordinator::server::{RunningServer, Server};
use cognate_protocol::v1;
use cognate_protocol::v1::client_api_client::ClientApiClient;
use cognate_worker::transport::address::Address;
use cognate_worker::transport::connect::{Bearer, CredentialFiles, Credentials, Role};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use tonic::service::interceptor::InterceptedService;
use tonic::transport::Channel;
use tonic::{Code, Status};

type Client = ClientApiClient<InterceptedService<Channel, Bearer>>;

const TOKENS: &str = "\
client ada-of-the-gears-1 name=ada tenant=gears jobs=2 paths=100 bytes=100000
client bob-of-the-arms-22 name=bob tenant=arms calls=1
client operator-of-it-all
worker worker-0123456789a name=rack
";

struct Service {
    server: RunningServer,
    address: Address,
    folder: tempfile::TempDir,
    metrics: String,
}

impl Service {
    async fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let tokens = folder.path().join("tokens");
        std::fs::write(&tokens, TOKENS).unwrap();
        let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let metrics = free.local_addr().unwrap().to_string();
        drop(free);
        let config = Config {
            listen: vec![ListenAddress::Tcp("127.0.0.1:0".to_owned())],
            security: Security {
                tokens: Some(Tokens::read(&tokens).unwrap()),
                ..Security::default()
            },
            ledger: LedgerPlace::Sqlite(folder.path().join("ledger.db")),
            results: Some(folder.path().join("results").into()),
            audit_log: Some(folder.path().join("audit.jsonl")),
            metrics: Some(metrics.clone()),
            shared_memory: None,
            ..Config::default()
        };
        let server = Server::start(config).await.expect("it starts");
        let ListenAddress::Tcp(authority) = &server.addresses[0] else {
            unreachable!("it listens on TCP")
        };
        Self {
            address: Address::Tcp(authority.clone()),
            server,
            folder,
            metrics,
        }
    }

    fn client(&self, token: &str) -> Client {
        let file = self.folder.path().join(format!("token-{token}"));
        std::fs::write(&file, token).unwrap();
        let files = CredentialFiles {
            token_file: Some(file),
            ..CredentialFiles::default()
        };
        let credentials = Credentials::read(&files, Role::Client).unwrap();
        let channel = credentials.channel(&self.address).unwrap();
        ClientApiClient::with_interceptor(channel, credentials.bearer())
    }

    fn audit(&self) -> Vec<serde_json::Value> {
        let path: PathBuf = self.folder.path().join("audit.jsonl");
        let text = std::fs::read_to_string(Path::new(&path)).unwrap();
        let read = |line| serde_json::from_str(line).expect("each line is an object");
        text.lines().map(read).collect()
    }

    /// Asks `/ready` until it answers so.
    async fn ready_says(&self, begin: &str) -> String {
        for _ in 0..200 {
            let answer = self.ask("/ready").await;
            if answer.starts_with(begin) {
                return answer;
            }
            tokio::time::sleep(std::time::Duration::from_millis(100)).await;
        }
        panic!("it does not say {begin}");
    }

    /// The answer of the monitor.
    async fn ask(&self, path: &str) -> String {
        let (address, path) = (self.metrics.clone(), path.to_owned());
        let asked = tokio::task::spawn_blocking(move || {
            let mut stream = std::net::TcpStream::connect(address).unwrap();
            write!(stream, "GET {path} HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
            let mut answer = String::new();
            stream.read_to_string(&mut answer).unwrap();
            answer
        });
        asked.await.unwrap()
    }
}

async fn submit(
    client: &mut Client,
    request: &str,
    tenant: &str,
    problem: &str,
) -> Result<String, Status> {
    let request = v1::SubmitRequest {
        request_id: request.to_owned(),
        problem: Some(text(problem)),
        tenant: tenant.to_owned(),
    };
    Ok(client.submit(request).await?.into_inner().job)
}

async fn jobs(client: &mut Client) -> Vec<String> {
    let listed = client.list_jobs(v1::ListJobsRequest::default()).await;
    let jobs = listed.unwrap().into_inner().jobs;
    jobs.into_iter().map(|job| job.job).collect()
}

/// Attack R of the third attack on the service (2026-11): a tenant could take another one's request ids.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn request_ids_belong_to_their_tenant() {
    let service = Service::start().await;
    let mut ada = service.client("ada-of-the-gears-1");
    let mut bob = service.client("bob-of-the-arms-22");
    let bobs = submit(&mut bob, "nightly", "", MANY_PATHS).await.unwrap();
    let adas = submit(&mut ada, "nightly", "", FOUR_POINTS).await.unwrap();
    assert_ne!(adas, bobs);
    let repeated = submit(&mut ada, "nightly", "", FOUR_POINTS).await.unwrap();
    assert_eq!(adas, repeated, "asking twice is asking once");
    let reused = submit(&mut ada, "nightly", "", MANY_PATHS)
        .await
        .unwrap_err();
    assert_eq!(reused.code(), Code::AlreadyExists);
    assert!(reused.message().contains("`nightly`"), "{reused}");
    service.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_tenant_sees_and_touches_its_own_jobs_only() {
    let service = Service::start().await;
    let mut ada = service.client("ada-of-the-gears-1");
    let mut bob = service.client("bob-of-the-arms-22");
    let mut operator = service.client("operator-of-it-all");
    let ada_job = submit(&mut ada, "a", "", FOUR_POINTS).await.unwrap();
    let arms = submit(&mut bob, "b", "arms", FOUR_POINTS).await.unwrap();
    let other = submit(&mut bob, "c", "gears", FOUR_POINTS).await;
    let other = other.unwrap_err();
    assert_eq!(other.code(), Code::PermissionDenied, "{other}");
    assert_eq!(jobs(&mut ada).await, std::slice::from_ref(&ada_job));
    assert_eq!(jobs(&mut bob).await, std::slice::from_ref(&arms));
    assert_eq!(jobs(&mut operator).await, [arms.clone(), ada_job.clone()]);
    // Of another tenant's job one hears as of one that never was.
    let job = ada_job.clone();
    let refused = bob.cancel(v1::CancelRequest { job: job.clone() }).await;
    let refused = refused.unwrap_err();
    assert_eq!(refused.message(), format!("there is no job {job}"));
    let explained = bob.explain(v1::ExplainRequest { job: job.clone() }).await;
    let watched = bob.watch(v1::WatchRequest { job: job.clone() }).await;
    let summary = bob
        .get_summary(v1::GetSummaryRequest { job: job.clone() })
        .await;
    let solutions = v1::StreamSolutionsRequest {
        job: job.clone(),
        skip: 0,
    };
    let solutions = bob.stream_solutions(solutions).await;
    let paths = bob
        .stream_paths(v1::StreamPathsRequest { job: job.clone() })
        .await;
    let request = v1::GetDecompositionRequest { job: job.clone() };
    let decomposition = bob.get_decomposition(request).await;
    let gone = v1::DeleteRequest {
        job: job.clone(),
        cancel_first: true,
    };
    let deleted = bob.delete(gone).await;
    for code in [
        explained.unwrap_err().code(),
        watched.err().unwrap().code(),
        summary.unwrap_err().code(),
        solutions.err().unwrap().code(),
        paths.err().unwrap().code(),
        decomposition.err().unwrap().code(),
        deleted.unwrap_err().code(),
    ] {
        assert_eq!(code, Code::NotFound);
    }
    // Nothing has happened to it; the operator may do all.
    assert_eq!(jobs(&mut ada).await, [ada_job]);
    operator.cancel(v1::CancelRequest { job }).await.unwrap();
    service.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn limits_are_named_with_what_is_in_use() {
    let service = Service::start().await;
    let mut ada = service.client("ada-of-the-gears-1");
    // 64 of 100 paths; 64 more are too many, 4 are not.
    submit(&mut ada, "one", "", MANY_PATHS).await.unwrap();
    let refused = submit(&mut ada, "two", "", MANY_PATHS).await.unwrap_err();
    assert_eq!(refused.code(), Code::ResourceExhausted);
    let said =
        "tenant gears may have 100 paths of unfinished jobs: it has 64, and this asks for 64 more";
    assert_eq!(refused.message(), said);
    submit(&mut ada, "three", "", FOUR_POINTS).await.unwrap();
    let refused = submit(&mut ada, "four", "", FOUR_POINTS).await.unwrap_err();
    assert!(
        refused.message().contains("2 unfinished jobs: it has 2"),
        "{refused}"
    );
    // A repeated request for a job that exists asks for nothing more.
    submit(&mut ada, "three", "", FOUR_POINTS).await.unwrap();
    // A job that has ended counts no more.
    let job = jobs(&mut ada).await.remove(0);
    ada.cancel(v1::CancelRequest { job }).await.unwrap();
    submit(&mut ada, "five", "", FOUR_POINTS).await.unwrap();
    // Bytes of uploads.
    let piece = |bytes| v1::ObjectPiece {
        data: vec![0; bytes].into(),
    };
    let kept = ada.upload(tokio_stream::iter([piece(50_000)])).await;
    kept.unwrap();
    let refused = ada.upload(tokio_stream::iter([piece(60_000)])).await;
    let refused = refused.unwrap_err();
    assert!(
        refused.message().contains("100000 bytes in an hour"),
        "{refused}"
    );
    // Calls at once: a watch is one as long as it lasts.
    let mut bob = service.client("bob-of-the-arms-22");
    let job = submit(&mut bob, "b", "", FOUR_POINTS).await.unwrap();
    let watch = bob.watch(v1::WatchRequest { job }).await.unwrap();
    let refused = bob.list_jobs(v1::ListJobsRequest::default()).await;
    let refused = refused.unwrap_err();
    assert!(refused.message().contains("1 calls at once"), "{refused}");
    drop(watch);
    let mut tries = 0;
    while bob.list_jobs(v1::ListJobsRequest::default()).await.is_err() {
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
        tries += 1;
        assert!(tries < 200, "the watch is over");
    }
    service.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn who_did_what_is_written_down() {
    let service = Service::start().await;
    let mut ada = service.client("ada-of-the-gears-1");
    let job = submit(&mut ada, "a", "", FOUR_POINTS).await.unwrap();
    let mut bob = service.client("bob-of-the-arms-22");
    let asked = v1::CancelRequest { job: job.clone() };
    bob.cancel(asked.clone()).await.unwrap_err();
    ada.cancel(asked).await.unwrap();
    let mut thief = service.client("nobody-s-own-token");
    thief
        .list_jobs(v1::ListJobsRequest::default())
        .await
        .unwrap_err();
    let entries = service.audit();
    let said: Vec<[&str; 4]> = entries
        .iter()
        .map(|entry| ["who", "call", "job", "outcome"].map(|key| entry[key].as_str().unwrap_or("")))
        .collect();
    assert_eq!(
        said,
        [
            ["ada", "Submit", job.as_str(), "OK"],
            ["bob", "Cancel", job.as_str(), "NOT_FOUND"],
            ["ada", "Cancel", job.as_str(), "OK"],
            [
                "unknown",
                "/cognate.v1.ClientApi/ListJobs",
                "",
                "UNAUTHENTICATED"
            ],
        ]
    );
    assert_eq!(entries[0]["tenant"], "gears");
    assert!(
        entries[0]["peer"]
            .as_str()
            .unwrap()
            .starts_with("127.0.0.1:")
    );
    let text = format!("{entries:?}");
    assert!(!text.contains("of-the-gears"), "no token stands there");
    service.server.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_operator_sees_calls_storage_and_whether_it_serves() {
    let service = Service::start().await;
    let mut ada = service.client("ada-of-the-gears-1");
    submit(&mut ada, "a", "", FOUR_POINTS).await.unwrap();
    ada.explain(v1::ExplainRequest::default())
        .await
        .unwrap_err();
    let answer = service.ask("/metrics").await;
    assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
    for begin in [
        "cognate_call_seconds_count{method=\"Submit\",code=\"OK\"} 1",
        "cognate_call_seconds_count{method=\"Explain\",code=\"INVALID_ARGUMENT\"} 1",
        "cognate_storage_seconds_count{operation=\"object_write\"} ",
        "cognate_storage_seconds_count{operation=\"ledger_commit\"} ",
        "cognate_storage_failures_total{operation=\"ledger_commit\"} 0",
        "cognate_chunk_events_total{event=\"leased\"} 0",
        "cognate_waiting_seconds 0",
        "cognate_backlog_seconds ",
        "process_resident_memory_bytes ",
        "# TYPE cognate_chunks gauge",
    ] {
        assert!(
            answer.lines().any(|line| line.starts_with(begin)),
            "{begin} in {answer}"
        );
    }
    // All metrics that the shipped dashboard and alerts use are there.
    let deploy = Path::new(env!("CARGO_MANIFEST_DIR")).join("../deploy");
    let mut asked = 0;
    for file in [
        "monitoring/grafana.json",
        "monitoring/alerts.yaml",
        "kubernetes/autoscaler.yaml",
    ] {
        let text = std::fs::read_to_string(deploy.join(file)).unwrap();
        let is_name = |c: char| c.is_ascii_lowercase() || c == '_';
        for name in text.split(|c| !is_name(c)) {
            if !(name.starts_with("cognate_") || name.starts_with("process_")) {
                continue;
            }
            let family = name.trim_end_matches("_bucket").trim_end_matches("_count");
            assert!(
                answer.contains(&format!("# TYPE {family} ")),
                "{file}: {name}"
            );
            asked += 1;
        }
    }
    assert!(asked > 20, "{asked}");
    assert!(service.ask("/").await.starts_with("HTTP/1.1 404"));
    assert!(service.ask("/live").await.starts_with("HTTP/1.1 200"));
    service.ready_says("HTTP/1.1 200").await;
    // The results go away, as a file system does that is not mounted; and come back.
    let (here, away) = (
        service.folder.path().join("results"),
        service.folder.path().join("away"),
    );
    std::fs::rename(&here, &away).unwrap();
    let answer = service.ready_says("HTTP/1.1 503").await;
    assert!(answer.contains("is it mounted?"), "{answer}");
    assert!(service.ask("/live").await.starts_with("HTTP/1.1 200"));
    // A write that had begun may have made the folder anew.
    let _ = std::fs::remove_dir_all(&here);
    std::fs::rename(&away, &here).unwrap();
    service.ready_says("HTTP/1.1 200").await;
    service.server.shutdown().await;
}
