//! Admission: the limits that a call passes before its message is decoded.
//!
//! A message is taken as bytes, weighed without decoding it, and goes on once there is memory for what it
//! will take: so no call, and not all of them together, can take more than is set aside for calls. What
//! is malformed is refused here by its place.

use super::middleware::{Answer, Inner, Middleware};
use bytes::{Bytes, BytesMut};
use cognate_protocol::decoded_size::decoded_size;
use cognate_protocol::limits::{MESSAGE_BYTES, PIECE_BYTES};
use http_body::Frame;
use http_body_util::{BodyExt, Full, StreamBody};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;
use tonic::body::Body;
use tonic::{Code, Status};

/// Limits of the messages of all calls. The memory of a decoded message is an estimate from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CallLimits {
    /// Bytes of a message of most calls. Default 1 MiB: these messages hold only names and numbers.
    pub message_bytes: usize,
    /// Bytes of messages of all calls that have arrived. Default 256 MiB: four of the largest.
    pub arrived_bytes: usize,
    /// Memory of one decoded message, in bytes. Default 512 MiB: the largest system that the limits allow takes a
    /// third of it.
    pub decoded_bytes: usize,
    /// Memory of the decoded messages of all calls, in bytes. Default 1 GiB.
    pub all_decoded_bytes: usize,
    /// Time that a message may take to arrive, and again to wait for memory. Default 60 s.
    pub patience: Duration,
}

impl Default for CallLimits {
    fn default() -> Self {
        Self {
            message_bytes: 1 << 20,
            arrived_bytes: 256 << 20,
            decoded_bytes: 512 << 20,
            all_decoded_bytes: 1 << 30,
            patience: Duration::from_secs(60),
        }
    }
}

/// Messages of less are never waited for: what asks for work passes by what is large.
const SMALL: usize = 64 << 10;
/// Memory is counted in these, in bytes.
const UNIT: usize = 1 << 10;
/// Compression flag and length before a message.
const HEAD: usize = 5;
/// Bytes of one message of many: a piece of an object, and what Protocol Buffers put around it.
const LONGEST_PIECE: usize = PIECE_BYTES.value as usize + 64;

/// Stands before all services of all listeners.
#[derive(Clone, Debug)]
pub struct Admission {
    limits: CallLimits,
    arrived: Arc<Semaphore>,
    decoded: Arc<Semaphore>,
}

impl Admission {
    /// Nothing is in hand yet.
    pub fn new(limits: CallLimits) -> Self {
        let budget = |bytes: usize| Arc::new(Semaphore::new((bytes / UNIT).max(1)));
        Self {
            limits,
            arrived: budget(limits.arrived_bytes),
            decoded: budget(limits.all_decoded_bytes),
        }
    }

    /// The message of a call and the most bytes that it may have; `None` where calls are of many
    /// messages, which are admitted one by one.
    fn of_path(&self, path: &str) -> Option<(String, usize)> {
        let (service, method) = path.strip_prefix("/cognate.v1.")?.split_once('/')?;
        let large = usize::try_from(MESSAGE_BYTES.value).unwrap_or(usize::MAX);
        let bytes = match (service, method) {
            ("ClientApi", "Upload") => return None,
            ("ClientApi", "Submit") | ("WorkerApi", "Report") => large,
            // As many leases as a call may name.
            ("WorkerApi", "Renew" | "GiveBack") => 4 * self.limits.message_bytes,
            _ => self.limits.message_bytes,
        };
        Some((format!("cognate.v1.{method}Request"), bytes))
    }

    async fn budget(
        &self,
        semaphore: &Arc<Semaphore>,
        bytes: usize,
        total_bytes: usize,
    ) -> Result<Option<OwnedSemaphorePermit>, Status> {
        if bytes <= SMALL {
            return Ok(None);
        }
        let units = u32::try_from(bytes.min(total_bytes) / UNIT).unwrap_or(u32::MAX);
        match timeout(
            self.limits.patience,
            Arc::clone(semaphore).acquire_many_owned(units),
        )
        .await
        {
            Ok(permit) => Ok(permit.ok()),
            Err(_) => Err(Status::unavailable(
                "this coordinator has no memory for a message of this size now: send it again later",
            )),
        }
    }

    /// The whole body, which is one message, and what it holds of the budgets.
    async fn take(
        &self,
        message: &str,
        most: usize,
        mut body: Body,
    ) -> Result<(Bytes, Vec<OwnedSemaphorePermit>), Status> {
        let mut held = Vec::new();
        let mut taken = BytesMut::new();
        let mut length = None;
        while let Some(frame) = body.frame().await {
            let frame = frame.map_err(|error| Status::cancelled(error.to_string()))?;
            let Ok(data) = frame.into_data() else {
                continue;
            };
            taken.extend_from_slice(&data);
            if length.is_none()
                && let Some(head) = taken.first_chunk::<HEAD>()
            {
                let [_, length_bytes @ ..] = *head;
                let bytes = u32::from_be_bytes(length_bytes) as usize;
                if bytes > most {
                    return Err(Status::out_of_range(format!(
                        "the message has {bytes} bytes; this call takes {most} at most"
                    )));
                }
                length = Some(bytes);
                let arrived = self.budget(&self.arrived, bytes, self.limits.arrived_bytes);
                held.extend(arrived.await?);
            }
            if taken.len() > length.map_or(HEAD, |length| HEAD + length) {
                return Err(Status::invalid_argument(
                    "more follows the message; this call takes one",
                ));
            }
        }
        let Some(length) = length.filter(|length| taken.len() == HEAD + length) else {
            return Err(Status::invalid_argument("the message is cut off"));
        };
        if taken[0] != 0 {
            return Err(Status::unimplemented("compressed messages are not taken"));
        }
        let size = decoded_size(message, &taken[HEAD..])
            .map_err(|error| Status::invalid_argument(error.to_string()))?;
        if size > self.limits.decoded_bytes {
            return Err(Status::resource_exhausted(format!(
                "the message of {length} bytes would take {size} bytes of memory; {} are the most",
                self.limits.decoded_bytes
            )));
        }
        let decoded = self.budget(&self.decoded, size, self.limits.all_decoded_bytes);
        held.extend(decoded.await?);
        Ok((taken.freeze(), held))
    }
}

/// A body of many messages, each of which is bounded.
fn in_pieces(body: Body) -> Body {
    let pieces = Pieces {
        body,
        head: Vec::with_capacity(HEAD),
        left: 0,
    };
    let frames = futures::stream::try_unfold(pieces, |mut pieces| async move {
        let frame = pieces.next().await?;
        Ok::<_, Status>(frame.map(|frame| (frame, pieces)))
    });
    Body::new(StreamBody::new(frames))
}

/// A body of many messages that is handed on, none of which is longer than it may be.
struct Pieces {
    body: Body,
    /// Flag and length of the message that comes next, as far as they have arrived.
    head: Vec<u8>,
    /// Bytes of the present message that have not arrived.
    left: usize,
}

impl Pieces {
    /// The next frame; `None` at the end.
    async fn next(&mut self) -> Result<Option<Frame<Bytes>>, Status> {
        let Some(frame) = self.body.frame().await else {
            return Ok(None);
        };
        let frame = frame.map_err(|error| Status::cancelled(error.to_string()))?;
        if let Some(data) = frame.data_ref() {
            self.follow(data)?;
        }
        Ok(Some(frame))
    }

    /// Goes over the beginnings of the messages in these bytes.
    fn follow(&mut self, mut data: &[u8]) -> Result<(), Status> {
        while !data.is_empty() {
            if self.left > 0 {
                let taken = self.left.min(data.len());
                self.left -= taken;
                data = &data[taken..];
                continue;
            }
            let taken = (HEAD - self.head.len()).min(data.len());
            self.head.extend_from_slice(&data[..taken]);
            data = &data[taken..];
            if let Some(&[_, length_bytes @ ..]) = self.head.first_chunk::<HEAD>() {
                self.head.clear();
                self.left = u32::from_be_bytes(length_bytes) as usize;
                if self.left > LONGEST_PIECE {
                    return Err(Status::out_of_range(format!(
                        "a message of {} bytes within a stream; {LONGEST_PIECE} at most are taken",
                        self.left
                    )));
                }
            }
        }
        Ok(())
    }
}

impl Middleware for Admission {
    fn answer<S: Inner>(&self, request: http::Request<Body>, mut inner: S) -> Answer {
        let admission = self.clone();
        Box::pin(async move {
            let (parts, body) = request.into_parts();
            let Some((message, most)) = admission.of_path(parts.uri.path()) else {
                let body = in_pieces(body);
                return inner.call(http::Request::from_parts(parts, body)).await;
            };
            let taken = admission.take(&message, most, body);
            let taken = match timeout(2 * admission.limits.patience, taken).await {
                Ok(taken) => taken,
                Err(_) => Err(Status::deadline_exceeded(
                    "the message did not arrive in time",
                )),
            };
            match taken {
                Ok((bytes, held)) => {
                    let body = Body::new(Full::new(bytes));
                    let answered = inner.call(http::Request::from_parts(parts, body)).await;
                    drop(held);
                    answered.map(malformed_is_the_callers)
                }
                Err(status) => {
                    tracing::debug!(path = parts.uri.path(), %status, "a call was refused");
                    Ok(status.into_http())
                }
            }
        })
    }
}

/// Changes the status of a message that the decoder refuses from an internal error to an invalid argument.
fn malformed_is_the_callers(mut response: http::Response<Body>) -> http::Response<Body> {
    let headers = response.headers_mut();
    let is = |name: &str, begin: &str| {
        let value = headers.get(name).and_then(|value| value.to_str().ok());
        value.is_some_and(|value| value.starts_with(begin))
    };
    if is("grpc-status", "13") && is("grpc-message", "failed%20to%20decode%20Protobuf") {
        let code = http::HeaderValue::from(Code::InvalidArgument as i32);
        headers.insert("grpc-status", code);
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_protocol::v1;
    use prost::Message;

    fn framed(message: &impl Message) -> Bytes {
        let bytes = message.encode_to_vec();
        let mut framed = vec![0];
        framed.extend_from_slice(&(bytes.len() as u32).to_be_bytes());
        framed.extend_from_slice(&bytes);
        framed.into()
    }

    fn body(bytes: &Bytes) -> Body {
        Body::new(Full::new(bytes.clone()))
    }

    async fn taken(admission: &Admission, path: &str, bytes: Bytes) -> Result<usize, Code> {
        let (message, most) = admission.of_path(path).unwrap();
        let taken = admission
            .take(&message, most, Body::new(Full::new(bytes)))
            .await;
        taken.map(|(bytes, _)| bytes.len()).map_err(|s| s.code())
    }

    #[tokio::test]
    async fn what_would_take_much_memory_is_refused_before_it_is_made() {
        let admission = Admission::new(CallLimits::default());
        let report = |results: usize| v1::ReportRequest {
            chunks: vec![v1::ChunkReport {
                results: vec![v1::PathResult::default(); results],
                ..v1::ChunkReport::default()
            }],
            ..v1::ReportRequest::default()
        };
        let path = "/cognate.v1.WorkerApi/Report";
        let small = framed(&report(100));
        assert_eq!(
            taken(&admission, path, small.clone()).await,
            Ok(small.len())
        );
        // Two million in 4 MiB.
        let large = framed(&report(2_000_000));
        assert_eq!(
            taken(&admission, path, large).await,
            Err(Code::ResourceExhausted)
        );
        let permits = admission.decoded.available_permits();
        assert_eq!(permits * UNIT, CallLimits::default().all_decoded_bytes);
    }

    #[tokio::test]
    async fn each_call_has_its_limit_and_malformed_is_the_callers_fault() {
        let admission = Admission::new(CallLimits::default());
        let cancel = |bytes: usize| {
            framed(&v1::CancelRequest {
                job: "j".repeat(bytes),
            })
        };
        let path = "/cognate.v1.ClientApi/Cancel";
        assert!(taken(&admission, path, cancel(100)).await.is_ok());
        let much = cancel(2 << 20);
        assert_eq!(taken(&admission, path, much).await, Err(Code::OutOfRange));
        let mut cut = cancel(100).to_vec();
        cut.pop();
        assert_eq!(
            taken(&admission, path, cut.into()).await,
            Err(Code::InvalidArgument)
        );
        let mut garbage = cancel(100).to_vec();
        garbage[HEAD] = 0xff;
        let garbage = taken(&admission, path, garbage.into()).await;
        assert_eq!(garbage, Err(Code::InvalidArgument));
        assert!(admission.of_path("/cognate.v1.ClientApi/Upload").is_none());
        assert!(admission.of_path("/grpc.health.v1.Health/Check").is_none());
    }

    /// Attack E of the third attack on the service (2026-11): uploads were outside all budgets.
    #[tokio::test]
    async fn messages_of_a_stream_are_bounded_one_by_one() {
        let stream_of = |sizes: &[usize]| {
            let pieces = sizes.iter().flat_map(|bytes| {
                framed(&v1::ObjectPiece {
                    data: vec![7; *bytes].into(),
                })
            });
            let whole: Vec<u8> = pieces.collect();
            // Cut where nothing ends, so that some beginnings come in two frames.
            let cut: Vec<Bytes> = whole.chunks(3).map(Bytes::copy_from_slice).collect();
            let frames = cut.into_iter();
            let frames = frames.map(|data| Ok::<_, Status>(Frame::data(data)));
            let body = Body::new(StreamBody::new(futures::stream::iter(frames)));
            (in_pieces(body), whole)
        };
        let largest = PIECE_BYTES.value as usize;
        let (body, whole) = stream_of(&[0, largest, 3, largest]);
        assert_eq!(body.collect().await.unwrap().to_bytes(), whole);
        let (body, _) = stream_of(&[5, largest + 100, 5]);
        let refused = Status::from_error(body.collect().await.unwrap_err().into());
        assert_eq!(refused.code(), Code::OutOfRange, "{refused}");
    }

    #[tokio::test]
    async fn all_calls_share_a_budget() {
        let admission = Admission::new(CallLimits {
            arrived_bytes: 1 << 20,
            patience: Duration::from_millis(50),
            ..CallLimits::default()
        });
        let (message, most) = admission.of_path("/cognate.v1.ClientApi/Submit").unwrap();
        let large = framed(&v1::SubmitRequest {
            request_id: "r".repeat(900 << 10),
            ..v1::SubmitRequest::default()
        });
        let first = admission.take(&message, most, body(&large)).await;
        let second = admission.take(&message, most, body(&large)).await;
        assert_eq!(
            second.map(drop).map_err(|s| s.code()),
            Err(Code::Unavailable)
        );
        drop(first);
        assert!(admission.take(&message, most, body(&large)).await.is_ok());
    }
}
