//! Traces: what became of a job, from its submission through every lease to the report, as spans of OpenTelemetry.
//!
//! The number of a trace is computed from the job's id, the numbers of spans from lease and worker. So any
//! coordinator that answers a call uses the right trace without having been told it, and a reader of a log line can
//! look the trace up. Spans that cannot be handed in are dropped: no call waits for them.

mod otlp;

use crate::ledger::identity::{JobId, LeaseId, WorkerId};
use crate::ledger::rows::Lease;
use otlp::{
    EXPORT, ExportRequest, ExportResponse, KeyValue, Resource, ResourceSpans, SERVER, ScopeSpans,
    Span,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use tokio::sync::mpsc;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tonic::transport::{Channel, Endpoint};
use tonic_prost::ProstCodec;

/// Spans that wait to be handed in; more are dropped.
const WAITING: usize = 8192;
/// Most spans of one call.
const AT_ONCE: usize = 512;
/// So long spans are gathered.
const GATHERED: Duration = Duration::from_secs(1);
/// A collector that takes longer has not taken them.
const PATIENCE: Duration = Duration::from_secs(5);

/// Why spans cannot be handed in there.
#[derive(Debug, thiserror::Error)]
#[error("`{address}` is no collector of traces: {what}; expected http://HOST:PORT")]
pub struct TracesError {
    address: String,
    what: String,
}

/// Takes note of spans; of none where nobody wants them.
#[derive(Clone, Debug, Default)]
pub struct Traces(Option<Arc<Waiting>>);

#[derive(Debug)]
struct Waiting {
    spans: mpsc::Sender<Span>,
    dropped: AtomicU64,
}

/// Hands spans to a collector.
#[derive(Debug)]
pub struct Collector {
    spans: mpsc::Receiver<Span>,
    waiting: Arc<Waiting>,
    channel: Channel,
    /// Name of this coordinator.
    instance: String,
}

fn number<const BYTES: usize>(event: &str) -> Vec<u8> {
    blake3::hash(event.as_bytes()).as_bytes()[..BYTES].to_vec()
}

/// The number of a job's trace.
pub fn trace_of(job: JobId) -> Vec<u8> {
    number::<16>(&format!("trace {job}"))
}

fn submission_of(job: JobId) -> Vec<u8> {
    number::<8>(&format!("submit {job}"))
}

fn span_of(lease: LeaseId) -> Vec<u8> {
    number::<8>(&format!("lease {lease}"))
}

fn nanoseconds(time: SystemTime) -> u64 {
    let since = time.duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

impl Traces {
    /// Spans for the collector at this address, as this coordinator.
    pub fn to(address: &str, instance: &str) -> Result<(Self, Collector), TracesError> {
        let wrong = |what: String| TracesError {
            address: address.to_owned(),
            what,
        };
        if !address.starts_with("http://") {
            return Err(wrong("it is not reached by http".to_owned()));
        }
        let endpoint = Endpoint::from_shared(address.to_owned());
        let endpoint = endpoint.map_err(|error| wrong(error.to_string()))?;
        let (sender, spans) = mpsc::channel(WAITING);
        let waiting = Arc::new(Waiting {
            spans: sender,
            dropped: AtomicU64::new(0),
        });
        let collector = Collector {
            spans,
            waiting: Arc::clone(&waiting),
            channel: endpoint.connect_timeout(PATIENCE).connect_lazy(),
            instance: instance.to_owned(),
        };
        Ok((Self(Some(waiting)), collector))
    }

    /// Whether anybody wants spans.
    pub fn are_wanted(&self) -> bool {
        self.0.is_some()
    }

    fn note(&self, span: impl FnOnce() -> Span) {
        let Some(waiting) = &self.0 else {
            return;
        };
        if waiting.spans.try_send(span()).is_err() {
            waiting.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// A job was submitted by a call that began then. The root of its trace.
    pub fn submitted(&self, job: JobId, since: SystemTime) {
        self.note(|| Span {
            trace_id: trace_of(job),
            span_id: submission_of(job),
            attributes: vec![KeyValue::text("job", job)],
            ..span("submit", since)
        });
    }

    /// A chunk was given to a worker by a call that had one for it since then.
    pub fn leased(&self, lease: &Lease, worker: &WorkerId, since: SystemTime) {
        self.note(|| {
            let (id, items) = (lease.lease, lease.items);
            Span {
                trace_id: trace_of(id.chunk.job),
                span_id: span_of(id),
                parent_span_id: submission_of(id.chunk.job),
                attributes: vec![
                    KeyValue::text("job", id.chunk.job),
                    KeyValue::text("lease", id),
                    KeyValue::text("worker", worker),
                    KeyValue::number("stage", id.chunk.stage.0.into()),
                    KeyValue::number("items", items.len()),
                ],
                ..span("lease", since)
            }
        });
    }

    /// A worker reported a chunk by a call that began then, with this verdict.
    pub fn reported(&self, lease: LeaseId, worker: &WorkerId, verdict: &str, since: SystemTime) {
        self.note(|| Span {
            trace_id: trace_of(lease.chunk.job),
            span_id: number::<8>(&format!("report {lease} {worker}")),
            parent_span_id: span_of(lease),
            attributes: vec![
                KeyValue::text("job", lease.chunk.job),
                KeyValue::text("lease", lease),
                KeyValue::text("worker", worker),
                KeyValue::text("verdict", verdict),
            ],
            ..span("report", since)
        });
    }
}

/// A span that ends now.
fn span(name: &str, since: SystemTime) -> Span {
    Span {
        name: name.to_owned(),
        kind: SERVER,
        start_time_unix_nano: nanoseconds(since),
        end_time_unix_nano: nanoseconds(SystemTime::now()),
        ..Span::default()
    }
}

impl Collector {
    /// Hands spans in until the service stops; then the last ones.
    pub async fn collect(mut self, stopping: CancellationToken) {
        let mut spans = Vec::new();
        let mut was_reached = true;
        while !stopping.is_cancelled() {
            tokio::select! {
                () = stopping.cancelled() => {}
                _ = self.spans.recv_many(&mut spans, AT_ONCE) => {
                    // Spans of the next second go along in the same call.
                    let gathered = tokio::time::sleep(GATHERED);
                    tokio::select! {
                        () = stopping.cancelled() => {}
                        () = gathered => {}
                    }
                }
            }
            loop {
                while spans.len() < AT_ONCE
                    && let Ok(span) = self.spans.try_recv()
                {
                    spans.push(span);
                }
                if spans.is_empty() {
                    break;
                }
                let failed = self.hand_in(std::mem::take(&mut spans)).await.err();
                if failed.is_some() && was_reached {
                    let why = failed.as_deref().unwrap_or_default();
                    tracing::warn!(why, "traces are not taken; those of now are dropped");
                }
                was_reached = failed.is_none();
            }
        }
    }

    async fn hand_in(&mut self, spans: Vec<Span>) -> Result<(), String> {
        let dropped = self.waiting.dropped.swap(0, Ordering::Relaxed);
        if dropped > 0 {
            tracing::warn!(dropped, "spans came faster than they were taken");
        }
        let attributes = vec![
            KeyValue::text("service.name", "cognate-coordinator"),
            KeyValue::text("service.version", env!("CARGO_PKG_VERSION")),
            KeyValue::text("service.instance.id", &self.instance),
        ];
        let request = ExportRequest {
            resource_spans: vec![ResourceSpans {
                resource: Some(Resource { attributes }),
                scope_spans: vec![ScopeSpans { spans }],
            }],
        };
        let mut client = tonic::client::Grpc::new(self.channel.clone());
        let call = async {
            client.ready().await.map_err(|error| error.to_string())?;
            let codec: ProstCodec<ExportRequest, ExportResponse> = ProstCodec::default();
            let path = http::uri::PathAndQuery::from_static(EXPORT);
            let answer = client.unary(tonic::Request::new(request), path, codec);
            answer.await.map_err(|status| status.to_string())
        };
        match timeout(PATIENCE, call).await {
            Ok(taken) => taken.map(drop),
            Err(_) => Err(format!("no answer within {PATIENCE:?}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_of_the_job_and_of_nothing_else() {
        let (one, two) = (trace_of(JobId(1)), trace_of(JobId(2)));
        assert_eq!((one.len(), submission_of(JobId(1)).len()), (16, 8));
        assert_eq!(one, trace_of(JobId(1)));
        assert_ne!(one, two);
    }

    #[test]
    fn only_collectors_without_encryption_are_spoken_to() {
        for address in ["", "127.0.0.1:4317", "https://collector:4317", "http://a b"] {
            assert!(Traces::to(address, "me").is_err(), "{address}");
        }
    }
}
