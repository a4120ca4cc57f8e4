//! The services: decode, one call inwards, encode.

pub mod accounting;
pub mod admission;
pub mod audit_log;
pub mod caller;
pub mod client_service;
pub mod error;
pub mod held_stream;
pub mod methods;
pub mod middleware;
pub mod quota;
pub mod security;
pub mod traces;
pub mod upload_places;
pub mod visible;
pub mod worker_service;

use crate::config::Rules;
use crate::coordinator::{Coordinator, CoordinatorError};
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::{ChunkId, Epoch, LeaseId, WorkerId};
use accounting::Accounting;
use bytes::Bytes;
use cognate_continuation::work::StageId;
use cognate_protocol::error::ProtocolError;
use cognate_protocol::limits::PIECE_BYTES;
use cognate_protocol::v1;
use error::ApiError;
use held_stream::HeldStreams;
use serde::Serialize;
use std::collections::HashMap;
use std::io::{self, BufWriter, Write};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tokio_util::sync::CancellationToken;
use tokio_util::task::AbortOnDropHandle;
use tonic::Status;
use traces::Traces;
use upload_places::UploadPlaces;

/// Workers whose refusal is remembered.
const REFUSALS: usize = 1000;

/// The coordinator, its limits and its rules of access, which both services use.
pub struct Context {
    /// The coordinator.
    pub coordinator: Arc<Coordinator>,
    /// Deadlines and limits.
    pub rules: Rules,
    /// Cancelled when the service is to stop: waiting calls return at once.
    pub stopping: CancellationToken,
    /// The listener in shared memory, once there is one.
    pub shared_memory: OnceLock<v1::SharedMemory>,
    /// Streams of results that are open.
    pub streams: HeldStreams,
    /// Places of uploads.
    pub uploads: UploadPlaces,
    /// Use of each caller, and the log of calls.
    pub accounting: Accounting,
    /// Spans for the collector of traces.
    pub traces: Traces,
    /// Workers that get no work, and why.
    refused: Mutex<HashMap<WorkerId, String>>,
}

impl Context {
    /// In front of this coordinator.
    pub fn new(
        coordinator: Arc<Coordinator>,
        rules: Rules,
        stopping: CancellationToken,
        accounting: Accounting,
        traces: Traces,
    ) -> Self {
        Self {
            coordinator,
            streams: HeldStreams::new(rules.streams),
            uploads: UploadPlaces::new(rules.uploads),
            rules,
            stopping,
            shared_memory: OnceLock::new(),
            accounting,
            traces,
            refused: Mutex::default(),
        }
    }

    fn refuse(&self, worker: WorkerId, why: &str) {
        let mut refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        if refused.len() >= REFUSALS {
            refused.clear();
        }
        refused.insert(worker, why.to_owned());
    }

    fn refusal(&self, worker: &WorkerId) -> Option<String> {
        let refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        refused.get(worker).cloned()
    }

    /// The ledger's clock.
    async fn now(&self) -> Result<LedgerTime, ApiError> {
        let now = self.coordinator.ledger().now().await;
        Ok(now.map_err(CoordinatorError::from)?)
    }
}

/// A task of its own, so that a panic at one request ends neither the connection nor the service.
/// It ends when nobody waits for it any more: a caller that is gone leases nothing.
async fn guarded<T: Send + 'static>(
    work: impl Future<Output = Result<T, ApiError>> + Send + 'static,
) -> Result<T, ApiError> {
    match AbortOnDropHandle::new(tokio::spawn(work)).await {
        Ok(done) => done,
        Err(error) => Err(ApiError::Panic(error.to_string())),
    }
}

/// A stream of answers.
pub type Answers<T> = futures::stream::BoxStream<'static, Result<T, Status>>;

/// A lease's name.
fn lease_id(field: &str, m: Option<&v1::LeaseId>) -> Result<LeaseId, ApiError> {
    let m = m.ok_or_else(|| ProtocolError::missing(field))?;
    Ok(LeaseId {
        chunk: ChunkId {
            job: m.job.parse()?,
            stage: StageId(m.stage),
            first: m.chunk,
        },
        epoch: Epoch(m.epoch),
    })
}

/// Milliseconds from one moment to a later one.
fn duration_ms(from: LedgerTime, until: LedgerTime) -> u32 {
    u32::try_from(until.since_ms(from)).unwrap_or(u32::MAX)
}

/// An object in pieces.
fn pieces(bytes: Bytes) -> Answers<v1::ObjectPiece> {
    let size = usize::try_from(PIECE_BYTES.value).unwrap_or(usize::MAX);
    let starts = (0..bytes.len().max(1)).step_by(size);
    let pieces = starts.map(move |at| {
        Ok(v1::ObjectPiece {
            data: bytes.slice(at..bytes.len().min(at + size)),
        })
    });
    Box::pin(futures::stream::iter(pieces))
}

/// An object as JSON in pieces that are written as they are read: a text may be larger than what it says.
fn json_pieces(object: impl Serialize + Send + 'static) -> Answers<v1::ObjectPiece> {
    let (sender, receiver) = mpsc::channel(2);
    tokio::task::spawn_blocking(move || {
        let size = usize::try_from(PIECE_BYTES.value).unwrap_or(usize::MAX);
        let sent = PieceWriter { sender, size };
        let mut text = BufWriter::with_capacity(size, sent);
        let written = serde_json::to_writer(&mut text, &object).map_err(io::Error::from);
        if let Err(error) = written.and_then(|()| text.flush()) {
            tracing::debug!(%error, "an object was not read to its end");
        }
    });
    Box::pin(ReceiverStream::new(receiver))
}

/// Sends what is written, in pieces of at most a size.
struct PieceWriter {
    sender: mpsc::Sender<Result<v1::ObjectPiece, Status>>,
    size: usize,
}

impl Write for PieceWriter {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        let data = Bytes::copy_from_slice(&text[..text.len().min(self.size)]);
        let length = data.len();
        let sent = self.sender.blocking_send(Ok(v1::ObjectPiece { data }));
        let nobody_reads = |_| io::Error::from(io::ErrorKind::BrokenPipe);
        sent.map(|()| length).map_err(nobody_reads)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures::StreamExt;

    #[tokio::test]
    async fn json_comes_in_pieces() {
        let size = usize::try_from(PIECE_BYTES.value).unwrap();
        let object = vec!["a".repeat(2 * size + 5), "b".repeat(7)];
        let pieces: Vec<_> = json_pieces(object.clone()).collect().await;
        let data = || pieces.iter().map(|piece| &piece.as_ref().unwrap().data);
        assert!(data().all(|data| data.len() <= size));
        let whole: Vec<u8> = data().flatten().copied().collect();
        assert_eq!(whole, serde_json::to_vec(&object).unwrap());
        // Nobody reads it to its end: the writer stops.
        let mut unread = json_pieces(vec![object; 100]);
        assert!(unread.next().await.is_some());
    }

    #[tokio::test]
    async fn pieces_make_up_the_object() {
        let size = usize::try_from(PIECE_BYTES.value).unwrap();
        for length in [0, 1, size, size + 1, 2 * size + 7] {
            let object: Vec<u8> = (0..length).map(|i| (i % 251) as u8).collect();
            let pieces: Vec<_> = pieces(object.clone().into()).collect().await;
            assert!(
                pieces
                    .iter()
                    .all(|p| p.as_ref().unwrap().data.len() <= size)
            );
            let whole: Vec<u8> = pieces.into_iter().flat_map(|p| p.unwrap().data).collect();
            assert_eq!(whole, object);
        }
    }
}
