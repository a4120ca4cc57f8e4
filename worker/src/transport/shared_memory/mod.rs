//! Shared memory (iceoryx2) between a worker and a coordinator of one user on one host.
//!
//! Calls and their bytes are the same as over a connection. A failure here closes the shared memory but fails no
//! call: the call is made again by gRPC.

pub mod frame;
pub mod place;

use bytes::Bytes;
use cognate_protocol::v1;
use frame::{Request, Response};
use iceoryx2::pending_response::PendingResponse;
use iceoryx2::port::client::Client;
use iceoryx2::port::listener::{Listener, ListenerWaitError};
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::port_name::PortName;
use iceoryx2::prelude::{BackpressureStrategy, Node};
use place::{CALLS, FIRST_SLICE, Ipc, Place, Unusable, failed};
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};
use std::time::Duration;
use tokio::sync::{Semaphore, oneshot};

/// Interval at which the coordinator's presence is checked. Default 300 ms: a killed coordinator is noticed long
/// before a lease ends; answers ring the bell at once.
const LOOK: Duration = Duration::from_millis(300);

/// Why a call has no answer by this way.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CallError {
    /// This call goes another way; the next may go by this one.
    #[error("{0}")]
    Declined(String),
    /// This way is no more.
    #[error("{0}")]
    Broken(String),
}

type Pending = PendingResponse<Ipc, [u8], (), [u8], ()>;

/// A call that waits for its answer.
struct PendingCall {
    pending: Pending,
    answer: oneshot::Sender<Result<Response, CallError>>,
}

/// A worker's end of the shared memory.
pub struct SharedMemory {
    inner: Arc<Inner>,
}

// In the order of dropping: ports before their node, the node before the place.
struct Inner {
    waiting: Mutex<Table>,
    client: Client<Ipc, [u8], (), [u8], ()>,
    bell: Notifier<Ipc>,
    listener: String,
    calls: Semaphore,
    broken: OnceLock<String>,
    _node: Node<Ipc>,
    place: Place,
}

#[derive(Default)]
struct Table {
    next: u64,
    calls: HashMap<u64, PendingCall>,
}

impl SharedMemory {
    /// Connects to the place that a coordinator named. Takes milliseconds, and blocks.
    pub fn connect(named: &v1::SharedMemory) -> Result<Self, Unusable> {
        // The library ends itself with a panic where it finds its own files in disorder.
        catch_unwind(AssertUnwindSafe(|| Self::connect_or_panic(named)))
            .unwrap_or_else(|_| Err(Unusable("it panicked".to_owned())))
    }

    fn connect_or_panic(named: &v1::SharedMemory) -> Result<Self, Unusable> {
        let place = Place::open(named)?;
        let node = place.node()?;
        let (calls, requests, responses) = (
            place.calls(&node)?,
            place.requests(&node)?,
            place.responses(&node)?,
        );
        let listener_name = uuid::Uuid::new_v4().simple().to_string();
        let name = PortName::new(&listener_name).map_err(failed("a name"))?;
        let listener = responses.listener_builder().name(&name).create();
        let listener = listener.map_err(failed("no listener"))?;
        let bell = requests.notifier_builder().create();
        let client = calls
            .client_builder()
            .initial_max_slice_len(FIRST_SLICE)
            .allocation_strategy(Place::growth())
            // A full queue is an error to handle, not a reason to spin.
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create();
        let inner = Arc::new(Inner {
            waiting: Mutex::default(),
            client: client.map_err(failed("no client"))?,
            bell: bell.map_err(failed("no bell"))?,
            listener: listener_name,
            calls: Semaphore::new(CALLS),
            broken: OnceLock::new(),
            _node: node,
            place,
        });
        let watched = Arc::downgrade(&inner);
        std::thread::Builder::new()
            .name("worker-shm".to_owned())
            .spawn(move || watch(&watched, &listener))
            .map_err(failed("no thread"))?;
        Ok(Self { inner })
    }

    /// Why this way is no more; `None` while it is.
    pub fn broken(&self) -> Option<&str> {
        self.inner.broken.get().map(String::as_str)
    }

    /// Makes one call: a path and gRPC-framed messages. Dropping the future cancels the call.
    pub async fn call(&self, path: &str, body: Bytes) -> Result<Response, CallError> {
        let inner = &self.inner;
        let request = Request {
            bell: inner.listener.clone(),
            path: path.to_owned(),
            body,
        };
        let bytes = request.encode();
        let bytes = bytes.ok_or_else(|| CallError::Declined("a name is too long".to_owned()))?;
        let _permit = inner.calls.acquire().await.map_err(|_| closed(inner))?;
        if inner.broken.get().is_some() {
            return Err(closed(inner));
        }
        let sent = catch_unwind(AssertUnwindSafe(|| inner.send(&bytes)));
        let (number, answer) = sent.unwrap_or_else(|_| {
            inner.give_up("it panicked");
            Err(closed(inner))
        })?;
        let _called_off = CalledOff { inner, number };
        answer.await.unwrap_or_else(|_| Err(closed(inner)))
    }
}

fn closed(inner: &Inner) -> CallError {
    CallError::Broken(inner.broken.get().cloned().unwrap_or_default())
}

/// Where a call is no longer waited for, the coordinator is told so.
struct CalledOff<'a> {
    inner: &'a Inner,
    number: u64,
}

impl Drop for CalledOff<'_> {
    fn drop(&mut self) {
        if let Some(waiting) = self.inner.table().calls.remove(&self.number) {
            let ended = catch_unwind(AssertUnwindSafe(|| {
                drop(waiting);
                self.inner.bell.notify()
            }));
            if !matches!(ended, Ok(Ok(_))) {
                self.inner.give_up("a call could not be called off");
            }
        }
    }
}

impl Inner {
    fn table(&self) -> std::sync::MutexGuard<'_, Table> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends a request; what is answered comes out of the receiver.
    #[allow(clippy::type_complexity)]
    fn send(
        &self,
        bytes: &[u8],
    ) -> Result<(u64, oneshot::Receiver<Result<Response, CallError>>), CallError> {
        let declined = |Unusable(why)| CallError::Declined(why);
        self.place.has_room(bytes.len()).map_err(declined)?;
        let loan = self.client.loan_slice_uninit(bytes.len());
        let loan = loan.map_err(failed("no memory")).map_err(declined)?;
        let (sender, receiver) = oneshot::channel();
        let number = {
            // Held until the call is in the table: its answer may come at once.
            let mut table = self.table();
            let pending = loan.write_from_slice(bytes).send();
            let pending = pending.map_err(failed("not sent")).map_err(declined)?;
            if pending.number_of_server_connections() == 0 {
                return Err(CallError::Declined(
                    "the coordinator's queue is full".into(),
                ));
            }
            let number = table.next;
            table.next += 1;
            let waiting = PendingCall {
                pending,
                answer: sender,
            };
            table.calls.insert(number, waiting);
            number
        };
        if let Err(error) = self.bell.notify() {
            self.give_up(&format!("the coordinator cannot be woken: {error:?}"));
        }
        Ok((number, receiver))
    }

    /// Hands out the answers that are there.
    fn receive(&self) {
        let mut table = self.table();
        let answered = table.calls.extract_if(|_, waiting| {
            // Asked first: an answer that came before the end is still there after it.
            let connected = waiting.pending.is_connected();
            let result = match waiting.pending.receive() {
                Ok(Some(response)) => Response::decode(response.payload())
                    .map_err(|error| CallError::Declined(error.to_string())),
                Ok(None) if connected => return false,
                Ok(None) => Err(CallError::Declined("the call was dropped".to_owned())),
                Err(error) => Err(CallError::Declined(format!("not received: {error:?}"))),
            };
            let (nobody, _) = oneshot::channel();
            let answer = std::mem::replace(&mut waiting.answer, nobody);
            // The receiver may be gone.
            let _ = answer.send(result);
            true
        });
        answered.for_each(drop);
    }

    /// Closes the shared memory: each waiting call fails with this reason.
    fn give_up(&self, why: &str) {
        let _ = self.broken.set(why.to_owned());
        self.calls.close();
        for (_, waiting) in self.table().calls.drain() {
            let _ = waiting.answer.send(Err(CallError::Broken(why.to_owned())));
        }
    }
}

/// Sleeps until something rings; ends with the last user of this way, or when it breaks.
fn watch(inner: &Weak<Inner>, listener: &Listener<Ipc>) {
    loop {
        let rung = catch_unwind(AssertUnwindSafe(|| {
            match listener.timed_wait(|_| {}, LOOK) {
                // A process that was stopped and goes on wakes up, too.
                Err(ListenerWaitError::InterruptSignal) => Ok(0),
                rung => rung,
            }
        }));
        let Some(inner) = inner.upgrade() else { return };
        if inner.broken.get().is_some() {
            return;
        }
        let why = match rung {
            Ok(Ok(0)) if !inner.place.coordinator_lives() => "the coordinator is gone".to_owned(),
            Ok(Ok(_)) => match catch_unwind(AssertUnwindSafe(|| inner.receive())) {
                Ok(()) => continue,
                Err(_) => "it panicked".to_owned(),
            },
            Ok(Err(error)) => format!("the bell is broken: {error:?}"),
            Err(_) => "it panicked".to_owned(),
        };
        inner.give_up(&why);
        return;
    }
}
