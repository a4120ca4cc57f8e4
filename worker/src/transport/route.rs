//! Route: how one coordinator is called: within the process, by shared memory while it works, else by a connection.
//!
//! It stands below the generated client, so that every call is written once, whatever
//! carries it.

use super::address::Address;
use super::connect::Bearer;
use super::shared_memory::frame::Response;
use super::shared_memory::place::Unusable;
use super::shared_memory::{CallError, SharedMemory};
use crate::config::TransportChoice;
use bytes::Bytes;
use cognate_protocol::v1::GetSharedMemoryRequest;
use cognate_protocol::v1::worker_api_client::WorkerApiClient;
use http_body_util::{BodyExt, Full};
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};
use tonic::body::Body;
use tonic::transport::Channel;
use tower::util::BoxCloneSyncService;
use tower::{BoxError, Service, ServiceExt};

/// How long a coordinator may take to say whether it offers shared memory.
const ANSWER: Duration = Duration::from_secs(2);
/// After a refusal it is asked again after this, then after twice as long, and so on.
const PAUSE: Duration = Duration::from_secs(2);
/// At the latest after this: somebody may have made room.
const LONGEST_PAUSE: Duration = Duration::from_secs(300);

/// The services of a coordinator.
pub type Services = tonic::service::Routes;

/// Service that carries the calls that do not go through shared memory.
type Carrier = BoxCloneSyncService<http::Request<Body>, http::Response<Body>, BoxError>;

/// The ways to one coordinator.
#[derive(Clone, Debug)]
pub struct Route {
    carrier: Carrier,
    name: &'static str,
    bearer: Bearer,
    /// Shared memory, where it may be used.
    shared: Option<Arc<Shared>>,
}

struct Shared {
    choice: TransportChoice,
    address: Address,
    state: Mutex<State>,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "shared memory with {}", self.address)
    }
}

#[derive(Default)]
struct State {
    memory: Option<Arc<SharedMemory>>,
    refusals: u32,
    next: Option<Instant>,
}

impl Route {
    /// Over this channel, and by shared memory where the choice allows it.
    pub fn new(
        channel: Channel,
        bearer: Bearer,
        address: Address,
        choice: TransportChoice,
    ) -> Self {
        let shared = (choice != TransportChoice::Grpc).then(|| {
            Arc::new(Shared {
                choice,
                address,
                state: Mutex::default(),
            })
        });
        Self {
            carrier: Carrier::new(channel.map_err(BoxError::from)),
            name: "grpc",
            bearer,
            shared,
        }
    }

    /// To a coordinator of this process: nothing lies between.
    pub fn in_process(services: Services) -> Self {
        Self {
            carrier: Carrier::new(ServiceExt::<http::Request<Body>>::map_err(
                services,
                BoxError::from,
            )),
            name: "in-process",
            bearer: Bearer::default(),
            shared: None,
        }
    }

    /// Name of the transport that carries calls now, as it is written in reports.
    pub fn transport(&self) -> &'static str {
        match self.memory() {
            Some(_) => "shared-memory",
            None => self.name,
        }
    }

    /// The shared memory, while it works.
    fn memory(&self) -> Option<Arc<SharedMemory>> {
        self.shared.as_deref().and_then(Shared::memory)
    }

    /// Looks for shared memory, where it is wanted, not there, and not refused a moment ago.
    pub async fn look_for_shared_memory(&self) {
        if let Some(shared) = &self.shared {
            let without = Self {
                shared: None,
                ..self.clone()
            };
            shared.look(without).await;
        }
    }
}

impl Shared {
    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn memory(&self) -> Option<Arc<SharedMemory>> {
        let mut state = self.state();
        let memory = state.memory.clone()?;
        match memory.broken() {
            None => Some(memory),
            Some(why) => {
                tracing::warn!(coordinator = %self.address, why, "shared memory ended; on by gRPC");
                state.memory = None;
                state.refusals = 0;
                state.next = Some(Instant::now() + PAUSE);
                None
            }
        }
    }

    async fn look(&self, without: Route) {
        if self.memory().is_some() {
            return;
        }
        if self.state().next.is_some_and(|next| Instant::now() < next) {
            return;
        }
        let address = &self.address;
        match connect(without).await {
            Ok(memory) => {
                tracing::info!(coordinator = %address, "by shared memory");
                let mut state = self.state();
                state.memory = Some(Arc::new(memory));
                state.next = None;
            }
            Err(Unusable(why)) => {
                let refusals = {
                    let mut state = self.state();
                    let pause = PAUSE.saturating_mul(1 << state.refusals.min(16));
                    state.next = Some(Instant::now() + pause.min(LONGEST_PAUSE));
                    state.refusals = state.refusals.saturating_add(1);
                    state.refusals
                };
                if self.choice == TransportChoice::SharedMemory && refusals == 1 {
                    tracing::warn!(coordinator = %address, why, "no shared memory; by gRPC");
                } else {
                    tracing::debug!(coordinator = %address, why, "no shared memory; by gRPC");
                }
            }
        }
    }
}

/// Asks the coordinator for its shared memory, by a route without any.
async fn connect(route: Route) -> Result<SharedMemory, Unusable> {
    let mut client = WorkerApiClient::new(route);
    let asked = client.get_shared_memory(GetSharedMemoryRequest {});
    let named = match tokio::time::timeout(ANSWER, asked).await {
        Ok(Ok(named)) => named.into_inner(),
        Ok(Err(status)) => return Err(Unusable(status.message().to_owned())),
        Err(_) => return Err(Unusable("the coordinator does not answer".to_owned())),
    };
    let connected = tokio::task::spawn_blocking(move || SharedMemory::connect(&named)).await;
    connected.unwrap_or_else(|error| Err(Unusable(error.to_string())))
}

impl Service<http::Request<Body>> for Route {
    type Response = http::Response<Body>;
    type Error = BoxError;
    type Future = Pin<Box<dyn Future<Output = Result<Self::Response, BoxError>> + Send>>;

    fn poll_ready(&mut self, _: &mut Context<'_>) -> Poll<Result<(), BoxError>> {
        // Each way has its own queue, asked when it is chosen.
        Poll::Ready(Ok(()))
    }

    fn call(&mut self, mut request: http::Request<Body>) -> Self::Future {
        self.bearer.mark(request.headers_mut());
        let carrier = self.carrier.clone();
        let Some(memory) = self.memory() else {
            return Box::pin(carrier.oneshot(request));
        };
        Box::pin(async move {
            let (head, body) = request.into_parts();
            let body = body.collect().await?.to_bytes();
            match memory.call(head.uri.path(), body.clone()).await {
                Ok(Response::Answered { headers, body }) => Ok(response(headers, body)),
                Ok(Response::Declined(why))
                | Err(CallError::Declined(why) | CallError::Broken(why)) => {
                    tracing::debug!(path = head.uri.path(), why, "this call by gRPC");
                    // Every call may be made again, so it does not matter how far it had come.
                    let repeated_request =
                        http::Request::from_parts(head, Body::new(Full::new(body)));
                    carrier.oneshot(repeated_request).await
                }
            }
        })
    }
}

/// As it would have come over a connection: the status in the trailers.
fn response(headers: http::HeaderMap, body: Bytes) -> http::Response<Body> {
    let body = Full::new(body).with_trailers(std::future::ready(Some(Ok(headers))));
    let mut response = http::Response::new(Body::new(body));
    let kind = http::HeaderValue::from_static("application/grpc");
    response
        .headers_mut()
        .insert(http::header::CONTENT_TYPE, kind);
    response
}
