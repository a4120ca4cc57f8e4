//! A coordinator in this process, behind real sockets in a folder of its own; clients and workers.
#![allow(dead_code)]

use cognate_coordinator::config::{Config, LedgerPlace, ListenAddress, Rules};
use cognate_coordinator::server::{RunningServer, Server};
use cognate_protocol::v1;
use cognate_protocol::v1::client_api_client::ClientApiClient;
use cognate_protocol::v1::worker_api_client::WorkerApiClient;
use cognate_worker::config::TransportChoice;
use cognate_worker::machine::Machine;
use cognate_worker::transport::Announcement;
use cognate_worker::transport::address::Address;
use cognate_worker::transport::connect::Bearer;
use cognate_worker::transport::grpc::Grpc;
use cognate_worker::transport::route::Route;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;
use tonic::transport::{Channel, Endpoint, Uri};

/// x^2 + y^2 = 5 and x y = 2 meet in (1,2), (2,1) and their negatives.
pub const FOUR_POINTS: &str = "INPUT variable_group x, y; function f, g; \
     f = x^2 + y^2 - 5; g = x*y - 2; END;";

/// Time that a worker waits for work, far longer than any machine takes to wake it.
pub const LONG_WAIT: Duration = Duration::from_secs(600);
/// Time within which a waiting worker must be woken, even on a busy machine: less than [`LONG_WAIT`].
pub const WOKEN: Duration = Duration::from_secs(120);

/// 64 paths: enough for several chunks.
pub const MANY_PATHS: &str = "INPUT variable_group x, y; function f, g; \
     f = x^8 + y^2 - 3; g = y^8 - x*y + 1; END;";

/// A coordinator on a ledger and results in this folder.
pub fn durable_config(folder: &std::path::Path) -> Config {
    let at = |name: &str| folder.join(name);
    Config {
        listen: vec![
            ListenAddress::Unix(at("c.sock")),
            ListenAddress::Tcp("127.0.0.1:0".to_owned()),
        ],
        ledger: LedgerPlace::Sqlite(at("data/ledger.db")),
        results: Some(at("data/results").into()),
        // Tests run where little is free, too.
        shared_memory: Some(16 << 20),
        ..Config::default()
    }
}

/// A coordinator and its folder.
pub struct House {
    pub server: RunningServer,
    pub folder: tempfile::TempDir,
}

impl House {
    /// With everything in memory.
    pub async fn new() -> Self {
        Self::with(Rules::default(), tempfile::tempdir().unwrap(), false).await
    }

    /// A coordinator whose workers may wait for work as long as they like: who is not woken waits on.
    pub async fn of_long_waits() -> Self {
        let rules = Rules {
            long_poll: LONG_WAIT,
            ..Rules::default()
        };
        Self::with(rules, tempfile::tempdir().unwrap(), false).await
    }

    /// On a ledger and results in this folder, which may be there already.
    pub async fn durable(folder: tempfile::TempDir) -> Self {
        Self::with(Rules::default(), folder, true).await
    }

    pub async fn with(rules: Rules, folder: tempfile::TempDir, durable: bool) -> Self {
        let mut config = Config {
            rules,
            ..durable_config(folder.path())
        };
        if !durable {
            config.ledger = LedgerPlace::Memory;
            config.results = None;
        }
        let server = Server::start(config).await.expect("a coordinator starts");
        Self { server, folder }
    }

    pub fn socket(&self) -> PathBuf {
        self.folder.path().join("c.sock")
    }

    pub async fn channel(&self) -> Channel {
        let path = self.socket();
        let connector = tower::service_fn(move |_: Uri| {
            let path = path.clone();
            async move {
                let stream = tokio::net::UnixStream::connect(path).await?;
                Ok::<_, std::io::Error>(hyper_util::rt::TokioIo::new(stream))
            }
        });
        let endpoint = Endpoint::from_static("http://localhost");
        endpoint.connect_with_connector(connector).await.unwrap()
    }

    pub async fn client(&self) -> Client {
        Client(ClientApiClient::new(self.channel().await))
    }

    pub async fn worker_api(&self, name: &str) -> FakeWorker {
        self.worker_api_by(name, TransportChoice::Grpc).await
    }

    /// A worker by shared memory, or not.
    pub async fn worker_api_by(&self, name: &str, choice: TransportChoice) -> FakeWorker {
        let address = Address::Unix(self.socket());
        let route = Route::new(self.channel().await, Bearer::default(), address, choice);
        route.look_for_shared_memory().await;
        FakeWorker {
            api: WorkerApiClient::new(route.clone()),
            route,
            name: name.to_owned(),
            session: format!("{name}-session"),
            sequence: 0,
        }
    }

    /// A real worker in this process.
    pub fn worker(&self, name: &str) -> RealWorker {
        let address = Address::Unix(self.socket());
        let mut config = cognate_worker::config::Config::new(vec![address]);
        config.threads = 1;
        let announcement = Announcement {
            worker: name.to_owned(),
            session: name.to_owned(),
            machine: Machine::detect(),
            threads: 1,
            lane_width: 8,
        };
        let transport = Arc::new(Grpc::new(&config, &announcement).unwrap());
        let stop = CancellationToken::new();
        let task = tokio::spawn(cognate_worker::shell::run_over(
            config,
            announcement,
            transport,
            stop.clone(),
        ));
        RealWorker { task, stop }
    }
}

/// A worker that tracks.
pub struct RealWorker {
    task: JoinHandle<Result<cognate_worker::session::Ending, cognate_worker::shell::WorkerError>>,
    stop: CancellationToken,
}

impl RealWorker {
    pub async fn stop(self) {
        self.stop.cancel();
        self.task.await.unwrap().unwrap();
    }

    /// As if it were killed.
    pub fn kill(self) {
        self.task.abort();
    }
}

/// A problem as a text.
pub fn text(content: &str) -> v1::Problem {
    v1::Problem {
        source: Some(v1::problem::Source::Text(v1::Text {
            name: "test.bertini".to_owned(),
            content: content.as_bytes().to_vec().into(),
        })),
        options: None,
    }
}

/// A client that expects answers.
pub struct Client(pub ClientApiClient<Channel>);

impl Client {
    pub async fn submit(
        &mut self,
        request_id: &str,
        problem: v1::Problem,
    ) -> Result<String, tonic::Status> {
        let request = v1::SubmitRequest {
            request_id: request_id.to_owned(),
            problem: Some(problem),
            tenant: String::new(),
        };
        Ok(self.0.submit(request).await?.into_inner().job)
    }

    /// Why a worker gets no chunks; empty where it does.
    pub async fn refusal(&mut self, worker: &str) -> String {
        let request = v1::ListWorkersRequest {};
        let workers = self.0.list_workers(request).await.unwrap().into_inner();
        let mut listed_workers = workers.workers.into_iter();
        listed_workers.find(|w| w.worker == worker).unwrap().refused
    }

    /// Watches until the job ends; everything that was told.
    pub async fn watch(&mut self, job: &str) -> Vec<v1::JobProgress> {
        let request = v1::WatchRequest {
            job: job.to_owned(),
        };
        let mut stream = self.0.watch(request).await.unwrap().into_inner();
        let mut told = Vec::new();
        let whole_stream = async {
            while let Some(progress) = stream.message().await.unwrap() {
                for stage in &progress.stages {
                    let sum = stage.ready + stage.leased + stage.accepted + stage.failed;
                    assert_eq!(sum, stage.total, "every item is in exactly one place");
                }
                told.push(progress);
            }
        };
        tokio::time::timeout(Duration::from_secs(120), whole_stream)
            .await
            .expect("the job ends");
        told
    }

    /// The solutions, each as its coordinates and the rest.
    pub async fn solutions(&mut self, job: &str) -> Vec<v1::Solution> {
        let request = v1::StreamSolutionsRequest {
            job: job.to_owned(),
            skip: 0,
        };
        let mut stream = self.0.stream_solutions(request).await.unwrap().into_inner();
        let mut solutions = Vec::new();
        while let Some(solution) = stream.message().await.unwrap() {
            solutions.push(solution);
        }
        solutions
    }

    pub async fn paths(&mut self, job: &str) -> Vec<v1::ClassifiedPath> {
        let request = v1::StreamPathsRequest {
            job: job.to_owned(),
        };
        let mut stream = self.0.stream_paths(request).await.unwrap().into_inner();
        let mut paths = Vec::new();
        while let Some(path) = stream.message().await.unwrap() {
            paths.push(path);
        }
        paths
    }
}

/// A worker that says what the test wants.
pub struct FakeWorker {
    pub api: WorkerApiClient<Route>,
    pub route: Route,
    pub name: String,
    pub session: String,
    pub sequence: u64,
}

impl FakeWorker {
    pub fn identity(&self) -> Option<v1::WorkerIdentity> {
        Some(v1::WorkerIdentity {
            worker: self.name.clone(),
            session: self.session.clone(),
        })
    }

    pub fn machine(&self) -> v1::Machine {
        v1::Machine {
            version: "test".to_owned(),
            protocol_version: cognate_protocol::PROTOCOL_VERSION,
            numerics_revision: cognate_numeric::NUMERICS_REVISION,
            instruction_set: "none".to_owned(),
            lane_width: 1,
            threads: 1,
            host: "here".to_owned(),
            transport: "grpc".to_owned(),
        }
    }

    pub fn question(&mut self, slots: u32, wait_ms: u32) -> v1::PullRequest {
        self.sequence += 1;
        v1::PullRequest {
            identity: self.identity(),
            sequence: self.sequence,
            free_slots: slots,
            wait_ms,
            machine: Some(self.machine()),
        }
    }

    pub async fn pull(&mut self, slots: u32, wait_ms: u32) -> v1::PullResponse {
        let question = self.question(slots, wait_ms);
        self.api.pull(question).await.unwrap().into_inner()
    }

    /// Made-up results of a chunk: every path ends at its own finite point.
    pub fn results(lease: &v1::Lease) -> Vec<v1::PathResult> {
        let result = |item: u64| v1::PathResult {
            origin: item,
            // An end at infinity is held against no equations.
            outcome: v1::PathOutcome::Diverging.into(),
            endpoint: vec![1.0, 0.0, 0.5, 0.25 * item as f64, 0.125, 0.0],
            t: Some(v1::Complex::default()),
            residual: 1e-16,
            condition: 10.0,
            accuracy: 1e-15,
            precision_bits: 53,
            counts: Some(v1::Counts::default()),
            ..v1::PathResult::default()
        };
        (lease.first..lease.first + lease.count)
            .map(result)
            .collect()
    }

    pub async fn give_back(&mut self, lease: &v1::Lease, why: &str) {
        let request = v1::GiveBackRequest {
            identity: self.identity(),
            leases: lease.id.clone().into_iter().collect(),
            reason: v1::GiveBackReason::Failed.into(),
            message: why.to_owned(),
            leaving: false,
        };
        self.api.give_back(request).await.unwrap();
    }

    pub async fn report(
        &mut self,
        lease: &v1::Lease,
        results: Vec<v1::PathResult>,
    ) -> v1::ReportVerdict {
        let request = v1::ReportRequest {
            identity: self.identity(),
            chunks: vec![v1::ChunkReport {
                lease: lease.id.clone(),
                results,
                cpu_nanoseconds: 1_000_000,
                wall_nanoseconds: 1_000_000,
            }],
        };
        let answer = self.api.report(request).await.unwrap().into_inner();
        assert_eq!(answer.verdicts.len(), 1);
        answer.verdicts[0].clone()
    }
}
