//! Accounting: calls counted by method and outcome, with the time that they took, and bounded by caller.
//!
//! A layer behind the guard that says who calls. A call lasts until its last message is taken, or nobody wants it
//! any more.

use super::audit_log::{AuditLog, Entry};
use super::caller::Caller;
use super::error::code_name;
use super::methods;
use super::middleware::{Answer, Inner, Middleware};
use super::quota::{CallPermit, Quota};
use crate::histogram::Histogram;
use bytes::Bytes;
use http_body::{Frame, SizeHint};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Instant;
use tonic::body::Body;
use tonic::{Code, Status};

/// All methods that are not counted by name, so that no caller makes new ones.
const OTHER: &str = "other";

/// Times of all calls, by method and outcome.
#[derive(Debug, Default)]
pub struct CallMeasures(Mutex<BTreeMap<(&'static str, &'static str), Arc<Histogram>>>);

impl CallMeasures {
    fn observe(&self, method: &'static str, code: Code, since: Instant) {
        let histogram = {
            let mut histograms = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(histograms.entry((method, code_name(code))).or_default())
        };
        histogram.observe(since.elapsed());
    }

    /// As Prometheus reads them.
    pub fn write(&self, text: &mut String) {
        let name = "cognate_call_seconds";
        let help = "Calls that have ended, by method and gRPC code, and how long they took.";
        // Writing to a text does not fail.
        let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} histogram");
        let histograms = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for ((method, code), histogram) in histograms.iter() {
            histogram.write(text, name, &format!("method=\"{method}\",code=\"{code}\""));
        }
    }
}

/// Counts and bounds the calls of all listeners.
#[derive(Clone, Debug, Default)]
pub struct Accounting {
    /// Times of the calls.
    pub measures: Arc<CallMeasures>,
    /// Use of the service by each credential.
    pub quota: Quota,
    /// Log of refused calls.
    pub audit: AuditLog,
}

impl Middleware for Accounting {
    fn answer<S: Inner>(&self, request: http::Request<Body>, mut inner: S) -> Answer {
        let method = methods::called(request.uri().path()).unwrap_or(OTHER);
        let permit = match request.extensions().get::<Caller>() {
            None => Ok(None),
            Some(caller) => self.quota.call(caller).inspect_err(|status| {
                let entry = Entry {
                    call: method,
                    job: None,
                    code: status.code(),
                    why: Some(status.message()),
                };
                self.audit.record(caller, entry);
            }),
        };
        let mut running = RunningCall {
            measures: Arc::clone(&self.measures),
            method,
            since: Instant::now(),
            // The call counts as cancelled by its caller unless it ends otherwise.
            code: Code::Cancelled,
            permit: None,
        };
        match permit {
            Err(status) => {
                running.code = status.code();
                Box::pin(std::future::ready(Ok(status.into_http())))
            }
            Ok(permit) => {
                running.permit = permit;
                let answer = inner.call(request);
                Box::pin(async move {
                    let response = answer.await?;
                    if let Some(code) = code_of(response.headers()) {
                        running.code = code;
                    }
                    let followed = |inner| Body::new(FollowedBody { inner, running });
                    Ok(response.map(followed))
                })
            }
        }
    }
}

fn code_of(headers: &http::HeaderMap) -> Option<Code> {
    Status::from_header_map(headers).map(|status| status.code())
}

/// A call that goes on; counted when it is dropped.
struct RunningCall {
    measures: Arc<CallMeasures>,
    method: &'static str,
    since: Instant,
    code: Code,
    permit: Option<CallPermit>,
}

impl Drop for RunningCall {
    fn drop(&mut self) {
        self.measures.observe(self.method, self.code, self.since);
        self.permit = None;
    }
}

/// An answer's body, whose end says how the call ended.
struct FollowedBody {
    inner: Body,
    running: RunningCall,
}

impl http_body::Body for FollowedBody {
    type Data = Bytes;
    type Error = Status;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Status>>> {
        let frame = Pin::new(&mut self.inner).poll_frame(cx);
        match &frame {
            Poll::Ready(Some(Ok(frame))) => {
                if let Some(code) = frame.trailers_ref().and_then(code_of) {
                    self.running.code = code;
                }
            }
            Poll::Ready(Some(Err(status))) => self.running.code = status.code(),
            Poll::Ready(None) | Poll::Pending => {}
        }
        frame
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::middleware::{Before, Behind};
    use cognate_worker::transport::tokens::Limits;
    use http_body_util::BodyExt;
    use std::convert::Infallible;
    use tower::{Layer, ServiceExt};

    async fn ask(
        service: &Behind<Accounting, impl Inner>,
        caller: &Caller,
    ) -> http::Response<Body> {
        let mut request = http::Request::new(Body::empty());
        *request.uri_mut() = "/cognate.v1.ClientApi/Explain".parse().unwrap();
        request.extensions_mut().insert(caller.clone());
        service.clone().oneshot(request).await.unwrap()
    }

    #[tokio::test]
    async fn calls_are_counted_by_how_they_end_and_bounded() {
        let accounting = Accounting::default();
        let refuse = tower::service_fn(|_: http::Request<Body>| async {
            // The body of the answer ends only when the caller has taken it.
            let refused = Status::not_found("no").into_http::<Body>();
            let body = http_body_util::Full::new(Bytes::from_static(b"x"));
            Ok::<_, Infallible>(refused.map(|_| Body::new(body)))
        });
        let service = Before(accounting.clone()).layer(refuse);
        let caller = Caller {
            limits: Limits {
                calls: Some(1),
                ..Limits::default()
            },
            ..Caller::untold("a", "here")
        };
        let first = ask(&service, &caller).await;
        let second = ask(&service, &caller).await;
        assert_eq!(code_of(second.headers()), Some(Code::ResourceExhausted));
        drop(second);
        // The first one's body is held: the call goes on.
        let _ = first.into_body().collect().await;
        let third = ask(&service, &caller).await;
        assert_eq!(code_of(third.headers()), Some(Code::NotFound));
        drop(third);
        let mut text = String::new();
        accounting.measures.write(&mut text);
        for line in [
            "cognate_call_seconds_count{method=\"Explain\",code=\"NOT_FOUND\"} 2",
            "cognate_call_seconds_count{method=\"Explain\",code=\"RESOURCE_EXHAUSTED\"} 1",
        ] {
            assert!(text.contains(line), "{line} in {text}");
        }
    }
}
