//! Shared memory: the listener for workers of the same user on the same host (iceoryx2).
//!
//! Behind it are the same services as behind the sockets. A thread sleeps until a
//! worker rings; each call is a task, called off when its worker no longer waits.

use crate::api::accounting::Accounting;
use crate::api::admission::Admission;
use crate::api::middleware::Behind;
use bytes::Bytes;
use cognate_protocol::v1;
use cognate_worker::transport::shared_memory::frame::{Request, Response};
use cognate_worker::transport::shared_memory::place::{
    FIRST_SLICE, Ipc, LARGEST_MESSAGE, Place, Unusable, failed,
};
use http_body_util::{BodyExt, Full, Limited};
use iceoryx2::active_request::ActiveRequest;
use iceoryx2::node::NodeView;
use iceoryx2::port::ReceiveError;
use iceoryx2::port::listener::{Listener, ListenerWaitError};
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::server::Server;
use iceoryx2::prelude::{BackpressureStrategy, CallbackProgression, Node, NodeState};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio_util::sync::CancellationToken;
use tonic::body::Body;
use tonic::service::Routes;

use tower::ServiceExt;

/// Interval at which waiting calls and the order to stop are looked at where no bell rings. Default 200 ms.
const LOOK: Duration = Duration::from_millis(200);
/// Pause before the next call is taken from a worker that has too many calls open.
const FULL: Duration = Duration::from_millis(1);
/// Interval at which the remains of killed workers are removed. Default 2 s: until then their waiting calls may still
/// be given chunks, which come back only with the end of their leases.
const CLEAN: Duration = Duration::from_secs(2);
/// Time that workers have to leave when the service stops. Default 1 s: each notices within 300 ms that the lock is
/// free.
const LEAVE: Duration = Duration::from_secs(1);
/// Responses that exist at a time: memory is reserved for this number of responses of the largest size.
const RESPONSES: usize = 64;

/// Services that answer calls, behind the limits of calls and their accounting.
type Services = Behind<Accounting, Behind<Admission, Routes>>;
type Active = ActiveRequest<Ipc, [u8], (), [u8], ()>;

/// A listener in shared memory that is open.
// In the order of dropping: ports before their node, the node before the place.
pub struct SharedMemoryListener {
    server: Server<Ipc, [u8], (), [u8], ()>,
    listener: Listener<Ipc>,
    /// Wakes `listener`.
    waker: Arc<Notifier<Ipc>>,
    bell: Arc<Notifier<Ipc>>,
    node: Node<Ipc>,
    place: Arc<Place>,
}

impl SharedMemoryListener {
    /// Opens one, unless less than `least_free` bytes are free in /dev/shm or the library refuses.
    pub fn open(least_free: u64) -> Result<Self, Unusable> {
        // The library ends itself with a panic where it finds its own files in disorder.
        catch_unwind(AssertUnwindSafe(|| Self::open_or_panic(least_free)))
            .unwrap_or_else(|_| Err(Unusable("it panicked".to_owned())))
    }

    fn open_or_panic(least_free: u64) -> Result<Self, Unusable> {
        let place = Place::create(least_free)?;
        let node = place.node()?;
        let (calls, requests, responses) = (
            place.calls(&node)?,
            place.requests(&node)?,
            place.responses(&node)?,
        );
        let server = calls
            .server_builder()
            .initial_max_slice_len(FIRST_SLICE)
            .allocation_strategy(Place::growth())
            .override_response_preallocation(|response_count| response_count.min(RESPONSES))
            // A full queue is an error to handle, not a reason to spin.
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create();
        let listener = requests.listener_builder().create();
        let waker = requests.notifier_builder().create();
        let bell = responses.notifier_builder().create();
        Ok(Self {
            server: server.map_err(failed("no server"))?,
            listener: listener.map_err(failed("no listener"))?,
            waker: Arc::new(waker.map_err(failed("no waker"))?),
            bell: Arc::new(bell.map_err(failed("no bell"))?),
            node,
            place: Arc::new(place),
        })
    }

    /// As it is named to workers.
    pub fn named(&self) -> v1::SharedMemory {
        self.place.named()
    }

    /// Answers calls on a thread of its own until the service stops. Must be called within a tokio
    /// runtime; what is returned ends with the thread.
    pub fn serve(
        self,
        routes: Services,
        stopping: CancellationToken,
    ) -> impl Future<Output = ()> + Send + 'static {
        let runtime = Handle::current();
        // The thread that it wakes owns it.
        let (stops, waker) = (stopping.clone(), Arc::downgrade(&self.waker));
        runtime.spawn(async move {
            stops.cancelled().await;
            if let Some(Err(error)) = waker.upgrade().map(|waker| waker.notify()) {
                tracing::debug!(?error, "it looks by itself within a fraction of a second");
            }
        });
        tokio::task::spawn_blocking(move || {
            let served = catch_unwind(AssertUnwindSafe(|| {
                self.answer_until(&routes, &stopping, &runtime)
            }));
            match served {
                Ok(Ok(())) => {}
                // Workers see the lock free and go on by gRPC.
                Ok(Err(Unusable(why))) => tracing::error!(why, "shared memory ended"),
                Err(_) => tracing::error!("shared memory ended: it panicked"),
            }
            if catch_unwind(AssertUnwindSafe(|| self.close())).is_err() {
                tracing::warn!("shared memory was not cleared away");
            }
        })
        .map_end()
    }

    fn answer_until(
        &self,
        routes: &Services,
        stopping: &CancellationToken,
        runtime: &Handle,
    ) -> Result<(), Unusable> {
        let mut open: Vec<OpenCall> = Vec::new();
        let mut cleaned = Instant::now();
        let mut wait = LOOK;
        loop {
            match self.listener.timed_wait(|_| {}, wait) {
                // A process that was stopped and goes on wakes up, too.
                Ok(_) | Err(ListenerWaitError::InterruptSignal) => {}
                Err(error) => return Err(failed("the bell is broken")(error)),
            }
            // Before the next are taken: a worker's calls that have ended make room for its others.
            open.retain(OpenCall::is_wanted);
            wait = loop {
                match self.server.receive() {
                    Ok(Some(request)) => open.push(self.take(request, routes, runtime)),
                    Ok(None) => break LOOK,
                    // An answered call is held a moment longer than its worker waits for it.
                    Err(ReceiveError::ExceedsMaxBorrows) => break FULL,
                    Err(error) => return Err(failed("not received")(error)),
                }
            };
            if stopping.is_cancelled() && open.is_empty() {
                return Ok(());
            }
            if cleaned.elapsed() >= CLEAN {
                cleaned = Instant::now();
                let state = self.node.try_cleanup_dead_nodes();
                tracing::trace!(?state, "dead nodes");
            }
        }
    }

    fn take(&self, request: Active, routes: &Services, runtime: &Handle) -> OpenCall {
        let asked = Request::decode(request.payload());
        let request = Arc::new(Mutex::new(request));
        let called_off = CancellationToken::new();
        let call = OpenCall {
            request: Arc::downgrade(&request),
            called_off: called_off.clone(),
        };
        match asked {
            Ok(asked) => {
                let (routes, bell) = (routes.clone(), Arc::clone(&self.bell));
                let place = Arc::clone(&self.place);
                runtime.spawn(async move {
                    let worker = asked.bell.clone();
                    let response = tokio::select! {
                        response = answer(asked, routes) => response,
                        () = called_off.cancelled() => return,
                    };
                    let replied = catch_unwind(AssertUnwindSafe(|| {
                        reply(&place, &request, &response)?;
                        // The worker sees an answer before it sees the end of the call.
                        drop(request);
                        ring(&bell, &worker);
                        Ok(())
                    }));
                    match replied {
                        Ok(Ok(())) => {}
                        // The request ends without an answer: the worker asks by gRPC.
                        Ok(Err(Unusable(why))) => {
                            tracing::debug!(why, "a call in shared memory is declined");
                            ring(&bell, &worker);
                        }
                        Err(_) => tracing::error!("a reply in shared memory panicked"),
                    }
                });
            }
            Err(error) => tracing::warn!(%error, "a worker's call is dropped"),
        }
        call
    }

    /// Lets workers leave, then clears everything away.
    fn close(self) {
        let Self {
            server,
            listener,
            waker,
            bell,
            node,
            place,
        } = self;
        drop((server, listener, waker, bell));
        let Some(place) = Arc::into_inner(place) else {
            // A call is still answered; the next coordinator sweeps.
            return;
        };
        let place = place.unlocked();
        let begin = Instant::now();
        while others_live(&node) && begin.elapsed() < LEAVE {
            std::thread::sleep(Duration::from_millis(20));
        }
        drop(node);
        place.remove();
    }
}

/// Whether nodes of living processes are there besides this one.
fn others_live(node: &Node<Ipc>) -> bool {
    let mut others = false;
    let listed = Node::<Ipc>::list(node.config(), |state| {
        others |= matches!(&state, NodeState::Alive(view) if view.id() != node.id());
        CallbackProgression::Continue
    });
    listed.is_ok() && others
}

/// A future of nothing from a thread that may have panicked; that was logged.
trait MapEnd {
    fn map_end(self) -> impl Future<Output = ()> + Send + 'static;
}

impl MapEnd for tokio::task::JoinHandle<()> {
    async fn map_end(self) {
        if let Err(error) = self.await {
            tracing::error!(%error, "the thread of shared memory ended");
        }
    }
}

/// A call that is being answered, and the means to call it off.
struct OpenCall {
    request: Weak<Mutex<Active>>,
    called_off: CancellationToken,
}

impl OpenCall {
    /// Whether it is neither answered nor called off; one whose worker is gone is called off here.
    fn is_wanted(&self) -> bool {
        let Some(request) = self.request.upgrade() else {
            return false;
        };
        let connected = lock(&request).is_connected();
        if !connected {
            self.called_off.cancel();
        }
        connected
    }
}

fn lock(request: &Mutex<Active>) -> std::sync::MutexGuard<'_, Active> {
    request.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Asks the services.
async fn answer(asked: Request, routes: Services) -> Response {
    let request = http::Request::builder()
        .method(http::Method::POST)
        .uri(asked.path)
        .header(http::header::CONTENT_TYPE, "application/grpc")
        .header(http::header::TE, "trailers")
        .body(Body::new(Full::new(asked.body)));
    let request = match request {
        Ok(request) => request,
        Err(error) => return Response::Declined(error.to_string()),
    };
    let Ok(response) = routes.oneshot(request).await;
    let (head, body) = response.into_parts();
    // Room for the headers; what does not fit is streamed over a connection.
    match Limited::new(body, LARGEST_MESSAGE - 4096).collect().await {
        Ok(collected) => {
            let mut headers = head.headers;
            headers.remove(http::header::CONTENT_TYPE);
            if let Some(trailers) = collected.trailers() {
                headers.extend(trailers.clone());
            }
            let body: Bytes = collected.to_bytes();
            Response::Answered { headers, body }
        }
        Err(error) => Response::Declined(error.to_string()),
    }
}

fn reply(place: &Place, request: &Mutex<Active>, response: &Response) -> Result<(), Unusable> {
    let bytes = response.encode();
    place.has_room(bytes.len())?;
    let request = lock(request);
    let loan = request.loan_slice_uninit(bytes.len());
    let loan = loan.map_err(failed("no memory"))?;
    loan.write_from_slice(&bytes)
        .send()
        .map_err(failed("not sent"))
}

/// Wakes one worker, by the name of its listener.
fn ring(bell: &Notifier<Ipc>, worker: &str) {
    bell.for_each_listener(|listener, details| {
        if details.listener_name.as_str() != worker {
            return CallbackProgression::Continue;
        }
        if let Err(error) = listener.notify() {
            // It looks by itself within a fraction of a second.
            tracing::debug!(?error, "a worker was not woken");
        }
        CallbackProgression::Stop
    });
}
