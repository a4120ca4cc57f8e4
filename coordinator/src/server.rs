//! Server: the shell of a coordinator. Clock, sockets, tasks, signals.
//!
//! Everything that decides stands in `coordinator`; here it is given a ledger, a
//! store and a clock, and listeners by which calls come in.

use crate::api::Context;
use crate::api::accounting::Accounting;
use crate::api::admission::Admission;
use crate::api::audit_log::AuditLog;
use crate::api::client_service::ClientService;
use crate::api::middleware::Before;
use crate::api::security::{Guard, Security, Tokens};
use crate::api::traces::{Traces, TracesError};
use crate::api::worker_service::WorkerService;
use crate::config::{Config, LedgerPlace, ListenAddress, Rules};
use crate::coordinator::Coordinator;
use crate::ledger::clock::SystemClock;
use crate::ledger::identity::CoordinatorId;
use crate::ledger::memory::MemoryLedger;
use crate::ledger::sql::SqlLedger;
use crate::ledger::{Ledger, LedgerError};
use crate::measures::StorageMeasures;
use crate::monitor::Monitor;
use crate::page::PageListener;
use crate::results::place::ResultsPlace;
use crate::results::store::{Store, StoreError};
use crate::transport::introduction::{Connections, raise_open_files};
use crate::transport::shared_memory::SharedMemoryListener;
use crate::transport::{self, ListenError, Listener};
use cognate_protocol::DESCRIPTORS;
use cognate_protocol::limits::MESSAGE_BYTES;
use cognate_protocol::v1::client_api_server::ClientApiServer;
use cognate_protocol::v1::worker_api_server::WorkerApiServer;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio_util::sync::CancellationToken;
use tonic::service::Routes;
use tonic_health::ServingStatus;
use tonic_health::server::HealthReporter;
use tower::Layer;

/// Why a coordinator does not start.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// A listener does not open.
    #[error(transparent)]
    Listener(#[from] ListenError),
    /// The ledger does not open.
    #[error("cannot open the ledger: {0}")]
    Ledger(#[from] LedgerError),
    /// The result store does not open.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The folder of the ledger cannot be made.
    #[error("cannot make the folder {folder}: {source}")]
    Folder {
        /// Path of the folder.
        folder: String,
        /// The operating system's error.
        source: io::Error,
    },
    /// The audit log does not open.
    #[error("cannot open the audit log {file}: {source}")]
    AuditLog {
        /// Path of the file.
        file: String,
        /// The operating system's error.
        source: io::Error,
    },
    /// Traces cannot be handed in where it was asked for.
    #[error(transparent)]
    Traces(#[from] TracesError),
    /// Signals cannot be listened to.
    #[error("cannot listen to signals: {0}")]
    Signals(io::Error),
}

/// A coordinator that runs.
pub struct RunningServer {
    /// Where it listens, with the ports that were free where port 0 was asked for.
    pub addresses: Vec<ListenAddress>,
    /// Address of the page for browsers, where there is one.
    pub page: Option<String>,
    context: Arc<Context>,
    routes: Routes,
    security: Security,
    admission: Admission,
    connections: Connections,
    memory: CancellationToken,
    tasks: JoinSet<()>,
    database: Option<Arc<SqlLedger>>,
}

/// How often the health of the services is told again.
const HEALTH_EVERY: Duration = Duration::from_millis(500);
/// Name by which probes ask whether calls can be answered.
const READY: &str = "ready";
const CLIENT_API: &str = "cognate.v1.ClientApi";
const WORKER_API: &str = "cognate.v1.WorkerApi";

/// Starts coordinators.
pub struct Server;

impl Server {
    /// Starts one as configured: opens the ledger and the store, binds all listeners.
    pub async fn start(config: Config) -> Result<RunningServer, ServerError> {
        match config.listen.is_empty() {
            true => Err(ListenError::NoAddress.into()),
            false => Self::start_in_process(config).await,
        }
    }

    /// Starts a coordinator as configured; without an address, calls come only from within the process.
    pub async fn start_in_process(config: Config) -> Result<RunningServer, ServerError> {
        raise_open_files();
        // Listeners first: a caller that is refused here has touched nothing.
        let mut listeners = Vec::new();
        for address in &config.listen {
            listeners.push(Listener::open(address, &config.security, config.insecure).await?);
        }
        let page = match &config.page {
            None => None,
            Some(address) => {
                let page = PageListener::open(address, &config.security, config.insecure).await?;
                Some(page.with_mechanisms(config.mechanisms))
            }
        };
        let mut security = config.security;
        if let Some(path) = &config.audit_log {
            let opened = AuditLog::to_file(path);
            security.audit = opened.map_err(|source| ServerError::AuditLog {
                file: path.display().to_string(),
                source,
            })?;
        }
        let metrics = match &config.metrics {
            None => None,
            Some(address) => {
                let bound = tokio::net::TcpListener::bind(address).await;
                let bound = bound.map_err(|source| ListenError::Bind {
                    address: ListenAddress::Tcp(address.clone()),
                    source,
                })?;
                if !bound.local_addr().is_ok_and(|at| at.ip().is_loopback()) {
                    tracing::warn!(%address, "everybody who reaches the metrics may read them: they ask nobody who \
                        he is, and name workers and tenants");
                }
                Some(bound)
            }
        };
        let clock = Arc::new(SystemClock::default());
        let mut database = None;
        let ledger: Arc<dyn Ledger> = match &config.ledger {
            LedgerPlace::Memory => Arc::new(MemoryLedger::new(clock)),
            LedgerPlace::Sqlite(path) => {
                make_folder(path)?;
                let ledger = Arc::new(SqlLedger::sqlite(path, clock).await?);
                database = Some(ledger.clone());
                ledger
            }
            LedgerPlace::Postgres(url) => {
                let ledger = Arc::new(SqlLedger::postgres(url, None).await?);
                database = Some(ledger.clone());
                ledger
            }
        };
        let store = match &config.results {
            Some(place) => open_results(place, &*ledger).await?,
            None => Store::in_memory(),
        };
        let who = CoordinatorId::new(format!("coordinator-{}", uuid::Uuid::new_v4()))
            .expect("a UUID is a name");
        let measures = Arc::new(StorageMeasures::default());
        if let Some(database) = &database {
            database.measure(Arc::clone(&measures));
        }
        let store = store.measured(Arc::clone(&measures));
        let (traces, collector) = match &config.traces {
            None => (Traces::default(), None),
            Some(address) => {
                let (traces, collector) = Traces::to(address, who.as_str())?;
                (traces, Some(collector))
            }
        };
        let mut running =
            Self::serve(page, security, ledger, store, who, config.rules, traces).await;
        if let Some(collector) = collector {
            let stopping = running.stopping();
            running.tasks.spawn(collector.collect(stopping));
        }
        for listener in listeners {
            running.listen(listener);
        }
        if let Some(least_free) = config.shared_memory {
            running.offer_shared_memory(least_free);
        }
        running.database = database;
        if let Some(listener) = metrics {
            let monitor = Monitor::new(
                Arc::clone(running.coordinator()),
                Arc::clone(&running.context.accounting.measures),
                measures,
            );
            let stopping = running.stopping();
            running.tasks.spawn(monitor.serve(listener, stopping));
        }
        Ok(running)
    }

    /// Starts one on parts that are there already; nobody can call it from without yet.
    async fn serve(
        page: Option<PageListener>,
        security: Security,
        ledger: Arc<dyn Ledger>,
        store: Store,
        who: CoordinatorId,
        rules: Rules,
        traces: Traces,
    ) -> RunningServer {
        let coordinator = Coordinator::new(ledger, store, who, rules.policy.clone());
        let accounting = Accounting {
            audit: security.audit.clone(),
            ..Accounting::default()
        };
        let admission = Admission::new(rules.calls);
        let connections = Connections::new(rules.connections);
        let stopping = CancellationToken::new();
        let context = Context::new(
            coordinator.clone(),
            rules,
            stopping.clone(),
            accounting,
            traces,
        );
        let context = Arc::new(context);
        let (routes, health) = routes(&context).await;
        let mut tasks = JoinSet::new();
        let page_url = page.as_ref().map(PageListener::url);
        if let Some(page) = page {
            tasks.spawn(page.serve(
                security.clone(),
                admission.clone(),
                routes.clone(),
                stopping.clone(),
            ));
        }
        tasks.spawn(report_health(health, Arc::clone(&context)));
        tasks.spawn(coordinator.run(stopping.clone()));
        RunningServer {
            addresses: Vec::new(),
            page: page_url,
            context,
            routes,
            security,
            admission,
            connections,
            memory: stopping.child_token(),
            tasks,
            database: None,
        }
    }
}

impl RunningServer {
    /// The coordinator behind the listeners.
    pub fn coordinator(&self) -> &Arc<Coordinator> {
        &self.context.coordinator
    }

    /// The services, for calls from within the process.
    pub fn services(&self) -> Routes {
        self.routes.clone()
    }

    /// Takes calls at this address from now on, too.
    pub async fn listen_at(&mut self, address: &ListenAddress) -> Result<(), ListenError> {
        let listener = Listener::open(address, &self.security, false).await?;
        self.listen(listener);
        Ok(())
    }

    /// Takes calls from this listener, too.
    fn listen(&mut self, listener: Listener) {
        let address = listener.address();
        tracing::info!(%address, "listening");
        self.addresses.push(address);
        self.tasks.spawn(listen(
            listener,
            self.security.clone(),
            self.admission.clone(),
            self.connections.clone(),
            with_reflection(self.routes.clone()),
            self.context.clone(),
        ));
    }

    /// Offers shared memory to workers from now on, unless less than `least_free` bytes of /dev/shm are free or it
    /// was offered before.
    pub fn offer_shared_memory(&mut self, least_free: u64) {
        let memory = match SharedMemoryListener::open(least_free) {
            Ok(memory) => memory,
            Err(error) => {
                tracing::info!(%error, "no shared memory; workers use gRPC");
                return;
            }
        };
        if self.context.shared_memory.set(memory.named()).is_ok() {
            let accounting = Before(self.context.accounting.clone());
            let services =
                accounting.layer(Before(self.admission.clone()).layer(self.routes.clone()));
            self.tasks
                .spawn(memory.serve(services, self.memory.clone()));
        }
    }

    /// Cancelled when the server begins to stop.
    pub fn stopping(&self) -> CancellationToken {
        self.context.stopping.clone()
    }

    /// Closes the listener in shared memory: its workers go on by gRPC.
    pub fn close_shared_memory(&self) {
        self.memory.cancel();
    }

    /// Stops: waiting calls return at once, others have the grace period; then the ledger closes.
    pub async fn shutdown(mut self) {
        tracing::info!("stopping");
        self.context.stopping.cancel();
        let grace = self.context.rules.shutdown_grace;
        let joined_tasks = async { while self.tasks.join_next().await.is_some() {} };
        if tokio::time::timeout(grace, joined_tasks).await.is_err() {
            tracing::warn!("some calls were cut off");
            self.tasks.shutdown().await;
        }
        if let Some(ledger) = self.database.take() {
            ledger.close().await;
        }
        tracing::info!("stopped");
    }
}

impl Drop for RunningServer {
    fn drop(&mut self) {
        // The thread of shared memory would go on without it.
        self.context.stopping.cancel();
    }
}

/// Runs a coordinator until SIGTERM or SIGINT; SIGHUP reads the tokens again. `started` hears where it listens.
pub async fn run(config: Config, started: impl FnOnce(&RunningServer)) -> Result<(), ServerError> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = signal(SignalKind::terminate()).map_err(ServerError::Signals)?;
    let mut interrupt = signal(SignalKind::interrupt()).map_err(ServerError::Signals)?;
    let mut hangup = signal(SignalKind::hangup()).map_err(ServerError::Signals)?;
    let tokens = config.security.tokens.clone();
    let server = Server::start(config).await?;
    started(&server);
    loop {
        tokio::select! {
            _ = terminate.recv() => break,
            _ = interrupt.recv() => break,
            _ = hangup.recv() => {
                read_tokens_again(tokens.as_ref());
                server.context.accounting.audit.reopen();
            }
        }
    }
    server.shutdown().await;
    Ok(())
}

/// Reads the tokens again, as SIGHUP demands.
fn read_tokens_again(tokens: Option<&Tokens>) {
    match tokens.map(Tokens::read_again) {
        None => tracing::info!("there are no tokens to be read again"),
        Some(Ok(())) => tracing::info!("the tokens are read again"),
        Some(Err(error)) => tracing::error!(%error, "the tokens stay as they were"),
    }
}

/// Opens the results in a folder or bucket. If the ledger knows of jobs and this place has no results, one of the two
/// is the wrong one.
async fn open_results(place: &ResultsPlace, ledger: &dyn Ledger) -> Result<Store, ServerError> {
    let is_new = ledger.jobs(1).await?.is_empty();
    let store = Store::open(place, is_new).await?;
    if is_new && store.has_results().await? {
        tracing::warn!(%place, "the ledger knows of no job, and there are results: \
            is it the right ledger, and whole?");
    }
    Ok(store)
}

fn make_folder(path: &Path) -> Result<(), ServerError> {
    match path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        None => Ok(()),
        Some(folder) => std::fs::create_dir_all(folder).map_err(|source| ServerError::Folder {
            folder: folder.display().to_string(),
            source,
        }),
    }
}

/// Our services and their health.
async fn routes(context: &Arc<Context>) -> (Routes, HealthReporter) {
    let limit = usize::try_from(MESSAGE_BYTES.value).unwrap_or(usize::MAX);
    let clients = ClientApiServer::new(ClientService::new(context.clone()))
        .max_decoding_message_size(limit)
        .max_encoding_message_size(limit);
    let workers = WorkerApiServer::new(WorkerService::new(context.clone()))
        .max_decoding_message_size(limit)
        .max_encoding_message_size(limit);
    let (health, health_service) = tonic_health::server::health_reporter();
    let routes = Routes::new(clients)
        .add_service(workers)
        .add_service(health_service);
    (routes, health)
}

/// The services and what they are, for programs that ask.
fn with_reflection(routes: Routes) -> Routes {
    let reflection = || {
        tonic_reflection::server::Builder::configure()
            .register_encoded_file_descriptor_set(DESCRIPTORS)
            .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
    };
    // Clients of other languages ask by the older name of the service or by the newer.
    let (newer, older) = (reflection().build_v1(), reflection().build_v1alpha());
    let sound = "the descriptors were made by the compiler of the messages";
    routes
        .add_service(newer.expect(sound))
        .add_service(older.expect(sound))
}

/// Says whether each service can do what it is for; the process lives whatever they say, which is the
/// health of the service without a name.
async fn report_health(health: HealthReporter, context: Arc<Context>) {
    while !context.stopping.is_cancelled() {
        let status = match context.coordinator.health().is_troubled() {
            true => ServingStatus::NotServing,
            false => ServingStatus::Serving,
        };
        for service in [CLIENT_API, WORKER_API, READY] {
            health.set_service_status(service, status).await;
        }
        tokio::select! {
            () = context.stopping.cancelled() => {}
            () = tokio::time::sleep(HEALTH_EVERY) => {}
        }
    }
    for service in [CLIENT_API, WORKER_API, READY] {
        health
            .set_service_status(service, ServingStatus::NotServing)
            .await;
    }
}

/// Takes calls at one listener until the service stops.
async fn listen(
    listener: Listener,
    security: Security,
    admission: Admission,
    connections: Connections,
    routes: Routes,
    context: Arc<Context>,
) {
    let address = listener.address();
    let stopping = context.stopping.clone();
    let keep_alive = context.rules.keep_alive;
    let server = tonic::transport::Server::builder()
        .http2_keepalive_interval(Some(keep_alive))
        .http2_keepalive_timeout(Some(keep_alive))
        .tcp_keepalive(Some(keep_alive));
    let guard = Guard {
        // Only this user can open the file of a socket, and this user could read the tokens, too.
        tokens: security
            .tokens
            .filter(|_| !matches!(listener, Listener::Unix(_))),
        audit: security.audit,
    };
    let layers = tower::ServiceBuilder::new()
        .layer(Before(guard))
        .layer(Before(context.accounting.clone()))
        .layer(Before(admission));
    let served = match listener {
        Listener::Tcp(listener, callers) => {
            let incoming = transport::tcp_connections(listener, callers, connections);
            server
                .layer(layers)
                .add_routes(routes)
                .serve_with_incoming_shutdown(incoming, stopping.cancelled_owned())
                .await
        }
        Listener::Tls(listener, callers) => {
            let tls = security.tls.map(|tls| tls.config()).unwrap_or_default();
            let incoming = transport::tcp_connections(listener, callers, connections);
            match server.tls_config(tls) {
                Ok(server) => {
                    server
                        .layer(layers)
                        .add_routes(routes)
                        .serve_with_incoming_shutdown(incoming, stopping.cancelled_owned())
                        .await
                }
                Err(error) => Err(error),
            }
        }
        Listener::Unix(socket) => {
            let incoming = transport::unix_connections(socket, connections);
            server
                .layer(layers)
                .add_routes(routes)
                .serve_with_incoming_shutdown(incoming, stopping.cancelled_owned())
                .await
        }
    };
    if let Err(error) = served {
        tracing::error!(%address, %error, "a listener has closed");
    }
}
